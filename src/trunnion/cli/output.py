"""What goes to the terminal: text and tables on stdout, progress and notes on stderr, JSON alone."""

from __future__ import annotations

import _thread
import json
import os
import signal
import sys
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager, suppress
from contextvars import copy_context
from enum import Enum
from functools import cache
from importlib.abc import MetaPathFinder
from math import isnan
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Protocol

from trunnion._version import __version__
from trunnion.cli.ending import EndedBy
from trunnion.errors import ComputationError
from trunnion.results.plain import plain
from trunnion.waiting import OutOfTime, TimeLimit, seconds_left, time_limit, uncounted

if TYPE_CHECKING:
    from collections.abc import Callable

    from rich.console import Console

    from trunnion.results.finding import Finding
    from trunnion.results.outcome import Outcome
    from trunnion.results.words import Words

LONG = 10.0
"""Seconds between lines of progress where stderr is not a terminal."""
SILENCE = 10.0
"""Seconds after which something is said there though the work tells nothing of how far it is."""
LEAST_SHARE, LEAST_WORK, ALIKE = 0.05, 2.0, 1.5
"""Share done and seconds of work from which the time left is shown; factor by which the pace may have changed."""
PIPED_WIDTH = 110
_COLOUR = {"danger": "bold red", "caution": "yellow", "note": "green"}


def _console() -> Console:
    """stdout; wide enough for tables when it is piped into a file."""
    from rich.console import Console

    piped = not sys.stdout.isatty() and "COLUMNS" not in os.environ
    return Console(width=PIPED_WIDTH if piped else None, highlight=False, markup=False)


def say(text: str, style: str | None = None, *, wrap: bool = False) -> None:
    """Text on stdout, its lines left to the terminal or wrapped at the width of the tables."""
    _console().print(text, style=style, soft_wrap=not wrap)


def heading(text: str) -> None:
    """A line that opens a section."""
    say("")
    say(text, style="bold", wrap=True)


def table(rows: Sequence[Mapping[str, object]], title: str = "") -> None:
    """Rows with common keys; numbers right-aligned with six figures, nothing for None; no table without rows."""
    from rich import box
    from rich.table import Table

    if not rows:
        return
    if title:
        heading(title)
    drawn = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for key, value in rows[0].items():
        side: Literal["left", "right"] = "right" if value is None or isinstance(value, int | float) else "left"
        drawn.add_column(key, justify=side, min_width=max(map(len, key.split())))  # no word of a head is cut
    for row in rows:
        drawn.add_row(*map(_cell, row.values()))
    _console().print(drawn)


def _cell(value: object) -> str:
    """Six figures; a dash for a number that there is none of."""
    if isinstance(value, float):
        return "–" if isnan(value) else f"{value:.6g}"
    return "" if value is None else str(value)


def findings(found: Sequence[Finding], title: str = "Findings") -> None:
    """One paragraph each, the gravest first, in the colour of its gravity; nothing where there is none."""
    if not found:
        return
    from rich.table import Table
    from rich.text import Text

    heading(title)
    grid = Table.grid(padding=(0, 1))
    grid.add_column(no_wrap=True)
    grid.add_column()
    for finding in found:
        word = str(finding.gravity)
        grid.add_row(Text(f"  {word}", style=_COLOUR[word]), Text(finding.sentence))
    _console().print(grid)


def record(one: Any, names: str, words: Words | None = None) -> dict[str, Any]:
    """What ``one`` has under some names (with blanks between, dots to what it has); with ``words`` what its labels give
    in rad/s is in their unit."""
    from trunnion.results.fields import labels  # which loads numpy

    found: dict[str, Any] = {}
    known = labels(type(one))
    for path in names.split():
        value = attrgetter(path)(one)
        if words is not None and value is not None and path in known and known[path].unit == "rad/s":
            value = _times(value, words.factor)
        found[path.rpartition(".")[2]] = str(value) if isinstance(value, Enum) else value
    return found


def _times(value: Any, factor: float) -> Any:
    return [_times(one, factor) for one in value] if isinstance(value, tuple | list) else value * factor


def findings_json(found: Sequence[Finding]) -> list[dict[str, str]]:
    """Gravity and sentence of each."""
    return [record(one, "gravity sentence") for one in found]


def written(paths: Sequence[Path]) -> None:
    """The files that were written, one a line, never broken."""
    if paths:
        heading("Written")
    for path in paths:
        say(f"  {path}")


def write_json(command: str, content: Mapping[str, Any]) -> None:
    """One JSON object on stdout; NaN and infinity become null."""
    whole = {"command": command, "trunnion": __version__, **content}
    print(json.dumps(plain(whole), indent=2, allow_nan=False))


class FailedAnswer(ComputationError):
    """A computation failed, and what it found is printed, with the sentence of its outcome."""


def finish(outcome: Outcome, paths: Sequence[Path]) -> None:
    """Exit code 1 with the sentence of a failed outcome, once what was computed is written and printed."""
    if not outcome.ok:
        kept = f"; what was computed is in {', '.join(map(str, paths))}" if paths else ""
        raise FailedAnswer(f"{outcome}{kept}")


def note(text: str) -> None:
    """A remark beside the result, on stderr."""
    print(text, file=sys.stderr, flush=True)


class Advance(Protocol):
    """Called with the share done; ``at`` says what the work is at."""

    def __call__(self, share: float) -> None: ...

    def at(self, step: str) -> None: ...


@contextmanager
def progress(what: str, within: float | None = None) -> Iterator[Advance]:
    """A callback for the share done: a bar with the time left on a terminal, else a line now and then.

    Time spent on compiling, which happens once, is not taken for the pace of the work. What is computed inside ends
    ``within`` its time [s] and on Ctrl-C with what it has, see ``stoppable``.
    """
    with stoppable(within), compile_notice() as clock:
        if not sys.stderr.isatty():
            with _ProgressLines(what, clock) as lines:
                yield lines
            return
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn

        columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.percentage:3.0f} %"))
        left = TextColumn("{task.fields[left]}")
        with Progress(*columns, left, console=Console(stderr=True), transient=True) as bar:
            yield _ProgressBar(what, bar, clock)


COMPILING = "compiling once, a few seconds (up to half a minute on a slow machine)"


@cache
def _say_compiling() -> None:
    """Once in a command, however many parts of it compile."""
    print(COMPILING, file=sys.stderr, flush=True)


class _Clock:
    """Time at work since the start, what is spent on compiling set aside, and what is left by the share done."""

    def __init__(self) -> None:
        self.start = time.monotonic()
        self.spent, self.depth, self.since = 0.0, 0, 0.0
        self.shares: list[tuple[float, float]] = []

    def begin(self) -> None:
        """Something is being compiled."""
        _say_compiling()
        if not self.depth:
            self.since = time.monotonic()
        self.depth += 1

    def end(self) -> None:
        """It is compiled."""
        self.depth = max(0, self.depth - 1)
        if not self.depth:
            self.spent += time.monotonic() - self.since

    def seconds(self) -> float:
        """Spent on compiling so far, what is being compiled included."""
        return self.spent + (time.monotonic() - self.since if self.depth else 0.0)

    def left(self, share: float) -> str:
        """Time left of the work; "" where nothing is known of it yet: where little is done, or where the pace of the
        first half of the time would have given another answer."""
        worked = max(time.monotonic() - self.start - self.seconds(), 0.0)
        if share > (self.shares[-1][1] if self.shares else 0.0):
            self.shares.append((worked, share))
        early = [one for one in self.shares if one[0] <= worked / 2]
        if not early or not LEAST_SHARE <= share <= 1 or worked < LEAST_WORK:
            return ""
        whole, before = worked / share, early[-1][0] / early[-1][1]
        if max(whole, before) > ALIKE * min(whole, before):
            return ""
        return f"about {min(whole - worked, seconds_left()):.0f} s left"


class _CompiledHere(threading.local):
    """Processor time that a thread spends on compiling, which limits of processor time do not count."""

    depth, since = 0, 0.0

    def begin(self) -> None:
        if not self.depth:
            self.since = time.thread_time()
        self.depth += 1

    def end(self) -> None:
        self.depth = max(0, self.depth - 1)
        if not self.depth:
            uncounted(time.thread_time() - self.since)


_COMPILED = _CompiledHere()


@contextmanager
def compile_notice() -> Iterator[_Clock]:
    """Says so once if something has to be compiled, which otherwise looks like a hang, and how long it took.

    The compiler is loaded by what needs it, not here.
    """
    clock = _Clock()
    with ExitStack() as stack:

        def listen() -> None:
            with suppress(ImportError):  # only the notice depends on this corner of numba
                stack.enter_context(_listening(clock))

        if COMPILER in sys.modules:
            listen()
        else:
            waiting = _ImportHook(COMPILER, listen)
            sys.meta_path.insert(0, waiting)
            stack.callback(waiting.leave)
        yield clock


COMPILER = "trunnion.numerics.jit"
"""The module through which everything is compiled."""


class _ImportHook(MetaPathFinder):
    """Calls ``then`` when the module ``name`` is about to be loaded."""

    def __init__(self, name: str, then: Callable[[], None]) -> None:
        self.name, self.then = name, then

    def find_spec(self, fullname: str, path: object, target: object = None) -> None:
        if fullname == self.name:
            self.leave()
            self.then()

    def leave(self) -> None:
        with suppress(ValueError):
            sys.meta_path.remove(self)


def _listening(clock: _Clock) -> AbstractContextManager[Any]:
    from numba.core import event

    class Notice(event.Listener):  # type: ignore[misc]
        def on_start(self, event: Any) -> None:
            clock.begin()
            _COMPILED.begin()

        def on_end(self, event: Any) -> None:
            clock.end()
            _COMPILED.end()

    listening: AbstractContextManager[Any] = event.install_listener("numba:compile", Notice())
    return listening


class _ProgressBar:
    """Progress on a terminal."""

    def __init__(self, what: str, bar: Any, clock: _Clock) -> None:
        self.what, self.bar, self.clock = what, bar, clock
        self.task = bar.add_task(what, total=None, left="")

    def __call__(self, share: float) -> None:
        self.bar.update(self.task, completed=share, total=1.0, left=self.clock.left(share))

    def at(self, step: str) -> None:
        self.bar.update(self.task, description=f"{self.what}: {step}")


class _ProgressLines:
    """Progress for logs: silent while it is quick, then a line now and then, whether the work tells a share or not."""

    def __init__(self, what: str, clock: _Clock) -> None:
        self.what, self.step, self.clock = what, "", clock
        self.last = clock.start
        self.done = threading.Event()

    def __enter__(self) -> _ProgressLines:
        # A thread of its own, as many a computation has nothing to tell before it is done.
        threading.Thread(target=copy_context().run, args=(self._tell,), daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        self.done.set()

    def at(self, step: str) -> None:
        self.step = f", {step}"

    def __call__(self, share: float) -> None:
        left = self.clock.left(share)
        if share > 0 and time.monotonic() - self.last >= LONG:
            self._say(f"{self.what}{self.step}: {100 * share:.0f} %{f', {left}' if left else ''}")

    def _tell(self) -> None:
        while not self.done.wait(SILENCE):
            if time.monotonic() - self.last >= SILENCE:
                self._say(f"still at work after {time.monotonic() - self.clock.start:.0f} s: {self.what}{self.step}")

    def _say(self, sentence: str) -> None:
        self.last = time.monotonic()
        note(sentence)


STOPPING = "stopping with what is known by now; Ctrl-C again leaves at once"
PATIENCE = 5.0
"""Seconds that a computation has to stop with what it has, before Ctrl-C ends it as it stands."""
AGAIN = 1.0
"""Seconds until it is tried again."""
_stopped = False


def stopped() -> bool:
    """Whether a Ctrl-C ended what this command computed, so that its answer is one of what was known by then."""
    return _stopped


@contextmanager
def stoppable(
    seconds: float | None = None, *, of_processor: bool = False, stated: float | None = None
) -> Iterator[TimeLimit]:
    """What is computed inside ends within its time, see ``time_limit``, and on Ctrl-C, with what it has.

    A second Ctrl-C, or one that nothing has answered after some seconds, ends the command at once.

    Raises
    ------
    KeyboardInterrupt : it was stopped before anything was known.
    """
    global _stopped
    if EndedBy.raised:  # into something that swallowed it
        raise KeyboardInterrupt
    with time_limit(seconds, of_processor=of_processor, stated=stated) as limit, _first_ctrl_c(limit):
        try:
            yield limit
        except OutOfTime:
            if limit.stopped:
                raise KeyboardInterrupt from None
            raise
        _stopped = _stopped or (limit.stopped and limit.noticed)


@contextmanager
def _first_ctrl_c(limit: TimeLimit) -> Iterator[None]:
    """The first Ctrl-C inside asks ``limit`` for an end."""
    here = threading.current_thread() is threading.main_thread()
    before = signal.getsignal(signal.SIGINT)
    if not here or before not in (signal.default_int_handler, EndedBy.on_ctrl_c):
        yield
        return
    over = threading.Event()

    def hurry() -> None:
        # Again and again: an interruption that falls into a callback or a finaliser is swallowed there.
        patience = PATIENCE
        while not over.wait(patience) and not limit.noticed:
            _thread.interrupt_main()
            patience = AGAIN

    def ask(*_: object) -> None:
        if limit.stopped:
            raise KeyboardInterrupt
        EndedBy.asked = before is EndedBy.on_ctrl_c
        limit.stop()
        note(STOPPING)
        threading.Thread(target=hurry, daemon=True).start()

    signal.signal(signal.SIGINT, ask)
    try:
        yield
    finally:
        over.set()
        signal.signal(signal.SIGINT, before)
