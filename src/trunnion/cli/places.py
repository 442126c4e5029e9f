"""What a command hands over: files, refused before the computation and whole afterwards, then words or JSON."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from trunnion.cli import output
from trunnion.errors import InputError, NothingToDraw

if TYPE_CHECKING:
    from trunnion.results.outcome import Outcome

DEFAULT_FOLDER = Path("trunnion-out")
PICTURES_AND_DATA = (".png", ".pdf", ".svg", ".nc")
"""Endings of commands whose results are not tables."""
TABLES = (*PICTURES_AND_DATA, ".csv")
PAGES = (".html", ".gif", ".json")
"""Endings of what moves."""
NOTHING = ()


def check_places(to: list[Path] | None, endings: tuple[str, ...] = TABLES) -> None:
    """Refuse what cannot be written, before anything is computed; ``endings`` of files that the command writes."""
    from trunnion.cli.files import check_file, check_folder, check_outputs

    for path in to or []:
        if endings != TABLES and path.suffix.lower() not in endings and not path.is_dir():
            remedy = f"end it in one of {', '.join(endings)}"
            raise InputError("is nothing this command writes", key="--output", value=str(path), remedy=remedy)
    if to and endings == PAGES:
        for path in to:
            check_file(path, "motion.html")
    elif to:
        check_outputs(to)
    else:
        check_folder(DEFAULT_FOLDER)


def write_result(path: Path, found: Any, draw: Callable[[], Any], table: Any = None) -> Path:
    """Numbers or picture by the ending of ``path``; ``table`` as of ``write_numbers``."""
    from trunnion.pictures.formats import FORMATS

    if path.suffix.removeprefix(".").lower() in FORMATS:
        from trunnion.pictures.draw_matplotlib import save

        save(draw().figure.figure, path)
    else:
        from trunnion.results.written import write_numbers

        write_numbers(found, path, table)
    return path


@dataclass(frozen=True)
class CommandOutput:
    """What a command found, and what it shows of it where that is not the result's own.

    draw : its picture. table : as of ``write_numbers``. files : writes what stands in the default folder, given the
    start of the names, where that is not a picture and the numbers. save : writes a file asked for, where that is
    neither a picture nor numbers. written : files that were written already.
    content : for JSON. text : in words, lines left to the terminal or, with ``wrap``, wrapped at the width of the
    tables, in a ``style`` of its own. more : prints what stands below them. outcome : one that failed is said after all
    else, with ``alone`` in place of the words, and the exit code is 1.
    """

    found: Any
    draw: Callable[[], Any] | None = None
    table: Any = None
    files: Callable[[Path], list[Path]] | None = None
    save: Callable[[Path], Path] | None = None
    written: Sequence[Path] = ()
    content: Callable[[], Mapping[str, Any]] | None = None
    text: Callable[[], str] | None = None
    style: str | None = None
    more: Callable[[], None] | None = None
    wrap: bool = False
    outcome: Outcome | None = None
    alone: bool = False

    def say(self, unit: str) -> None:
        """Print it, speeds in ``unit`` where the result has words for them."""
        own = partial(self.found.describe, unit or None) if hasattr(self.found, "describe") else self.found.__str__
        output.say((self.text or own)(), self.style, wrap=self.wrap)
        if self.more is not None:
            self.more()

    def write(self, to: Sequence[Path] | None, stem: str, unit: str) -> list[Path]:
        """The files asked for, or those that are called ``stem`` in the default folder."""
        from trunnion.writing import folder_written_whole

        if to:
            return [self._write(path, unit) for path in to]
        with folder_written_whole(DEFAULT_FOLDER) as temporary:
            if self.files is not None:
                found = self.files(temporary / stem)
            else:
                found = [self._write(temporary / f"{stem}.nc", unit)]
                with suppress(NothingToDraw):  # none was asked for
                    found.insert(0, self._write(temporary / f"{stem}.png", unit))
        return [DEFAULT_FOLDER / path.name for path in found]

    def _write(self, path: Path, unit: str) -> Path:
        if self.save is not None:
            return self.save(path)
        plot = self.draw or self.found.plot
        known = {"unit": unit} if "unit" in inspect.signature(plot).parameters else {}
        return write_result(path, self.found, partial(plot, **known), self.table)


def answer(command: str, written: Sequence[Path] | None, as_json: bool, shown: CommandOutput, unit: str = "") -> None:
    """A result as one JSON object, or in words, and where it was written: None of a command that writes nothing."""
    if as_json:
        places = {} if written is None else {"written": [str(path) for path in written]}
        output.write_json(command, {**(shown.content or shown.found.to_dict)(), **places})
    elif not shown.alone or shown.outcome is None or shown.outcome.ok:
        shown.say(unit)
        output.written(written or ())
    if shown.outcome is not None:
        output.finish(shown.outcome, written or ())
