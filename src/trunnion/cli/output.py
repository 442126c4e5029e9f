"""What goes to the terminal: text and tables on stdout, progress and notes on stderr, JSON alone."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
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


def console() -> Console:
    """stdout; wide enough for tables when it is piped into a file."""
    from rich.console import Console

    piped = not sys.stdout.isatty() and "COLUMNS" not in os.environ
    return Console(width=PIPED_WIDTH if piped else None, highlight=False, markup=False)


def heading(out: Console, text: str) -> None:
    """A line that opens a section."""
    out.print()
    out.print(text, style="bold")


def table(out: Console, rows: Sequence[Mapping[str, object]]) -> None:
    """Rows with common keys; numbers right-aligned with six figures."""
    from rich import box
    from rich.table import Table

    drawn = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for key, value in rows[0].items():
        drawn.add_column(key, justify="right" if isinstance(value, int | float) else "left")
    for row in rows:
        drawn.add_row(*(f"{v:.6g}" if isinstance(v, float) else str(v) for v in row.values()))
    out.print(drawn)


def findings(out: Console, found: Sequence[Finding]) -> None:
    """One paragraph each, the gravest first, in the colour of its gravity."""
    from rich.table import Table
    from rich.text import Text

    grid = Table.grid(padding=(0, 1))
    grid.add_column(no_wrap=True)
    grid.add_column()
    for finding in found:
        word = str(finding.gravity)
        grid.add_row(Text(f"  {word}", style=_COLOUR[word]), Text(finding.sentence))
    out.print(grid)


def write_json(command: str, content: Mapping[str, Any]) -> None:
    """One JSON object on stdout; NaN and infinity become null."""
    whole = {"command": command, "trunnion": __version__, **content}
    print(json.dumps(plain(whole), indent=2, allow_nan=False))


def finish(outcome: Outcome, written: Sequence[Path] = ()) -> None:
    """Exit code 1 with the sentence of a failed outcome, once what was computed is written and printed."""
    if not outcome.ok:
        kept = f"; what was computed is in {', '.join(map(str, written))}" if written else ""
        raise ComputationError(f"{outcome}{kept}")


def note(text: str) -> None:
    """A remark beside the result, on stderr."""
    print(text, file=sys.stderr, flush=True)


@contextmanager
def progress(what: str) -> Iterator[Callable[[float], None]]:
    """A callback for the share done: a bar with the time left on a terminal, else a line now and then."""
    with compile_notice():
        if not sys.stderr.isatty():
            yield _Lines(what)
            return
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

        columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.percentage:3.0f} %"))
        with Progress(*columns, TimeRemainingColumn(), console=Console(stderr=True), transient=True) as bar:
            task = bar.add_task(what, total=None)
            yield lambda share: bar.update(task, completed=share, total=1.0)


COMPILING = "compiling once, a few seconds (up to half a minute on a slow machine)"


@contextmanager
def compile_notice() -> Iterator[None]:
    """Says so once if something has to be compiled, which otherwise looks like a hang."""
    try:
        from numba.core import event
    except ImportError:  # only the notice depends on this corner of numba
        yield
        return

    class Notice(event.Listener):  # type: ignore[misc]
        said = False

        def on_start(self, event: Any) -> None:
            if not self.said:
                self.said = True
                print(COMPILING, file=sys.stderr, flush=True)

        def on_end(self, event: Any) -> None:
            pass

    with event.install_listener("numba:compile", Notice()):
        yield


class _Lines:
    """Progress for logs: silent while it is quick."""

    def __init__(self, what: str) -> None:
        self.what, self.start = what, time.monotonic()
        self.last = self.start

    def __call__(self, share: float) -> None:
        now = time.monotonic()
        if now - self.last >= LONG and share > 0:
            self.last = now
            left = (now - self.start) * (1 - share) / share
            line = f"{self.what}: {100 * share:.0f} %, about {left:.0f} s left"
            print(line, file=sys.stderr, flush=True)
