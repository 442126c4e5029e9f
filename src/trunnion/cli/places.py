"""Where results are written: refused before the computation, whole afterwards, and named at the end."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from trunnion.cli import output
from trunnion.cli.study import DEFAULT_FOLDER
from trunnion.errors import InputError

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


def write_results(
    to: list[Path] | None, stem: str, what: str, data: Any, draw: Callable[[], Any], table: Any = None
) -> list[Path]:
    """The files asked for, or a picture and the data in the default folder; ``table`` as of ``write_result``."""
    from trunnion.writing import folder_written_whole

    if to:
        return [write_result(path, data, draw, table) for path in to]
    with folder_written_whole(DEFAULT_FOLDER) as temporary:
        names = [temporary / f"{stem}-{what}.{ending}" for ending in ("png", "nc")]
        for name in names:
            write_result(name, data, draw)
    return [DEFAULT_FOLDER / name.name for name in names]


def write_result(path: Path, data: Any, draw: Callable[[], Any], table: Any = None) -> Path:
    """Data, table or picture by the ending of ``path``; a table may stand on another dataset than the data."""
    from trunnion.plots.style import save
    from trunnion.results.files import save_dataset
    from trunnion.results.tables import write_table
    from trunnion.writing import written_whole

    ending = path.suffix.removeprefix(".").lower()
    if ending == "nc":
        save_dataset(data, path)
    elif ending == "csv":
        with written_whole(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as stream:
            write_table(stream, data if table is None else table)
    else:
        save(draw().figure.figure, path)
    return path


def print_result(text: str, written: list[Path]) -> None:
    """A result in words and where it was written."""
    from trunnion.cli.report import print_written

    out = output.console()
    out.print(text, soft_wrap=True)
    print_written(out, written)


def answer(
    command: str,
    content: Callable[[], Mapping[str, Any]],
    text: Callable[[], str],
    written: Sequence[Path],
    as_json: bool,
) -> None:
    """A result as one JSON object, or in words, and where it was written."""
    if as_json:
        output.write_json(command, {**content(), "written": [str(path) for path in written]})
    else:
        print_result(text(), list(written))
