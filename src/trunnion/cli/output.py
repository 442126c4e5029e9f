"""What goes to the terminal: text and tables on stdout, progress and notes on stderr, JSON alone."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager, suppress
from functools import cache
from importlib.abc import MetaPathFinder
from pathlib import Path
from typing import TYPE_CHECKING, Any

from trunnion._version import __version__
from trunnion.errors import ComputationError
from trunnion.results.plain import plain

if TYPE_CHECKING:
    from collections.abc import Callable

    from rich.console import Console

    from trunnion.results.finding import Finding
    from trunnion.results.outcome import Outcome

LONG = 10.0
"""Seconds between lines of progress where stderr is not a terminal."""
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
        drawn.add_column(key, justify="right" if value is None or isinstance(value, int | float) else "left")
    for row in rows:
        drawn.add_row(*("" if v is None else f"{v:.6g}" if isinstance(v, float) else str(v) for v in row.values()))
    _console().print(drawn)


def findings(found: Sequence[Finding], title: str = "Findings") -> None:
    """One paragraph each, the gravest first, in the colour of its gravity."""
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


def findings_json(found: Sequence[Finding]) -> list[dict[str, str]]:
    """Gravity and sentence of each."""
    return [{"gravity": str(f.gravity), "sentence": f.sentence} for f in found]


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


def finish(outcome: Outcome, paths: Sequence[Path]) -> None:
    """Exit code 1 with the sentence of a failed outcome, once what was computed is written and printed."""
    if not outcome.ok:
        kept = f"; what was computed is in {', '.join(map(str, paths))}" if paths else ""
        raise ComputationError(f"{outcome}{kept}")


def note(text: str) -> None:
    """A remark beside the result, on stderr."""
    print(text, file=sys.stderr, flush=True)


@contextmanager
def progress(what: str) -> Iterator[Callable[[float], None]]:
    """A callback for the share done: a bar with the time left on a terminal, else a line now and then.

    Time spent on compiling, which happens once, is not taken for the pace of the work.
    """
    with compile_notice() as clock:
        if not sys.stderr.isatty():
            yield _Lines(what, clock)
            return
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn

        columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.percentage:3.0f} %"))
        left = TextColumn("{task.fields[left]}")
        with Progress(*columns, left, console=Console(stderr=True), transient=True) as bar:
            task = bar.add_task(what, total=None, left="")
            yield lambda share: bar.update(task, completed=share, total=1.0, left=clock.left(share))


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
        """Time left of the work."""
        if share <= 0:
            return ""
        worked = time.monotonic() - self.start - self.seconds()
        return f"about {max(worked, 0.0) * (1 - share) / share:.0f} s left"


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
            waiting = _Before(COMPILER, listen)
            sys.meta_path.insert(0, waiting)
            stack.callback(waiting.leave)
        yield clock


COMPILER = "trunnion.numerics.jit"
"""The module through which everything is compiled."""


class _Before(MetaPathFinder):
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

        def on_end(self, event: Any) -> None:
            clock.end()

    listening: AbstractContextManager[Any] = event.install_listener("numba:compile", Notice())
    return listening


class _Lines:
    """Progress for logs: silent while it is quick."""

    def __init__(self, what: str, clock: _Clock) -> None:
        self.what, self.clock = what, clock
        self.last = clock.start

    def __call__(self, share: float) -> None:
        now = time.monotonic()
        if now - self.last >= LONG and share > 0:
            self.last = now
            print(f"{self.what}: {100 * share:.0f} %, {self.clock.left(share)}", file=sys.stderr, flush=True)
