"""Where results are written: refused before the computation, whole afterwards, and named in the answer."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from trunnion.cli import output
from trunnion.cli.options import file_stem
from trunnion.errors import InputError

DEFAULT_FOLDER = Path("trunnion-out")
PICTURES_AND_DATA = (".png", ".pdf", ".svg", ".nc")
"""Endings of commands whose results are no tables."""


def check_places(to: list[Path] | None, endings: tuple[str, ...] = ()) -> None:
    """Refuse what cannot be written, before anything is computed; ``endings`` of a command that writes no tables."""
    from trunnion.cli.files import check_folder, check_outputs

    for path in to or []:
        if endings and path.suffix.lower() not in endings and not path.is_dir():
            remedy = f"end it in one of {', '.join(endings)}"
            raise InputError("is nothing this command writes", key="--output", value=str(path), remedy=remedy)
    if to:
        check_outputs(to)
    else:
        check_folder(DEFAULT_FOLDER)


def write_result(path: Path, found: Any, draw: Callable[[], Any], table: Any = None) -> Path:
    """Numbers or picture by the ending of ``path``; ``table`` as of ``write_numbers``."""
    from trunnion.plots.formats import FORMATS

    if path.suffix.removeprefix(".").lower() in FORMATS:
        from trunnion.plots.style import save

        save(draw().figure.figure, path)
    else:
        from trunnion.results.written import write_numbers

        write_numbers(found, path, table)
    return path


def write_results(
    to: list[Path] | None, file: str, what: str, found: Any, draw: Callable[[], Any], table: Any = None
) -> list[Path]:
    """The files asked for, or a picture and the numbers of ``file`` in the default folder."""
    from trunnion.writing import folder_written_whole

    if to:
        return [write_result(path, found, draw, table) for path in to]
    with folder_written_whole(DEFAULT_FOLDER) as temporary:
        names = [temporary / f"{file_stem(file)}-{what}.{ending}" for ending in ("png", "nc")]
        for name in names:
            write_result(name, found, draw)
    return [DEFAULT_FOLDER / name.name for name in names]


def deliver(
    command: str,
    file: str,
    found: Any,
    to: list[Path] | None,
    as_json: bool,
    *,
    what: str = "",
    draw: Callable[[], Any] | None = None,
    table: Any = None,
    content: Callable[[], Mapping[str, Any]] | None = None,
    text: Callable[[], str] | None = None,
    more: Callable[[], None] | None = None,
    wrap: bool = False,
) -> list[Path]:
    """What a command found: written, then said, see ``answer``; without other words the result has its own.

    what : its part in the names of files; default ``command``. draw : its picture. table : as of ``write_numbers``.
    """
    written = write_results(to, file, what or command, found, draw or found.plot, table)
    answer(command, written, as_json, content or found.to_dict, text or found.__str__, more, wrap)
    return written


def answer(
    command: str,
    written: Sequence[Path] | None,
    as_json: bool,
    content: Callable[[], Mapping[str, Any]],
    text: Callable[[], str],
    more: Callable[[], None] | None = None,
    wrap: bool = False,
) -> None:
    """A result as one JSON object, or in words with ``more`` below them, and where it was written.

    written : None of a command that writes nothing. wrap : whether the words are broken at the width of the tables.
    """
    if as_json:
        places = {} if written is None else {"written": [str(path) for path in written]}
        output.write_json(command, {**content(), **places})
        return
    output.say(text(), wrap=wrap)
    if more is not None:
        more()
    output.written(written or ())
