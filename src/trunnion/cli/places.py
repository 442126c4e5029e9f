"""Where results are written: refused before the computation, whole afterwards, and named at the end."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from trunnion.cli import output
from trunnion.cli.study import DEFAULT_FOLDER
from trunnion.errors import InputError

PICTURES_AND_DATA = (".png", ".pdf", ".svg", ".nc")
"""Endings of commands whose results are no tables."""
RUNS_ALONG = {"time": "s", "turn": "", "speed": "rad/s", "point": "", "quantity": ""}
"""Axes that are the rows of a table, with their units; where a result has none, those of its first variable are."""


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
    from trunnion.writing import written_whole

    ending = path.suffix.removeprefix(".").lower()
    if ending == "nc":
        save_dataset(data, path)
    elif ending == "csv":
        with written_whole(path) as temporary:
            _write_table(temporary, data if table is None else table)
    else:
        save(draw().figure.figure, path)
    return path


def _write_table(path: Path, data: Any) -> None:
    """What runs along the first dimension of a dataset, a column per element, order or state."""
    import csv

    axis = next((d for d in RUNS_ALONG if d in data.sizes), None) or next(v.dims[0] for v in data.values() if v.dims)
    there = axis in data.coords
    unit = data[axis].attrs.get("units", RUNS_ALONG.get(axis, "")) if there else ""
    columns = {f"{axis} [{unit}]" if unit else axis: data[axis].values if there else range(data.sizes[axis])}
    for name, part in data.data_vars.items():
        if part.dims and part.dims[0] == axis:
            unit = part.attrs.get("units", "1")
            columns |= dict(_columns(data, part, str(name) if unit == "1" else f"{name} [{unit}]"))
    with path.open("w", encoding="utf-8", newline="") as stream:
        rows = csv.writer(stream, lineterminator="\n")
        rows.writerow(columns)
        rows.writerows(zip(*columns.values(), strict=True))


def _columns(data: Any, part: Any, head: str) -> Iterator[tuple[str, Any]]:
    """Columns of a variable by name, its last dimension outermost: ``mesh: order 2: torque``."""
    if part.ndim == 1:
        yield head, part.values
        return
    last = part.dims[-1]
    for k, label in enumerate(data[last].values):
        for name, values in _columns(data, part.isel({last: k}), head):
            yield f"{label}: {name}", values


def print_result(text: str, written: list[Path]) -> None:
    """A result in words and where it was written."""
    from trunnion.cli.report import print_written

    out = output.console()
    out.print(text, soft_wrap=True)
    print_written(out, written)
