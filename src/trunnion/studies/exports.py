"""Points of a store as netCDF, CSV or Parquet; the last two a stretch at a time, so that size does not matter."""

from __future__ import annotations

import csv
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from trunnion.errors import InputError
from trunnion.studies.design import StudyDesign
from trunnion.studies.extra import scale
from trunnion.studies.parts import StudyPart
from trunnion.studies.result import read
from trunnion.studies.rounds import asked_of
from trunnion.studies.shards import array_names
from trunnion.studies.store import Store
from trunnion.writing import written_whole

ENDINGS = (".nc", ".csv", ".parquet")
WORDS = np.array(["missing", "done", "failed"])


def export(store: str | os.PathLike[str], path: str | os.PathLike[str], *, missing: bool = False) -> Path:
    """Write the points that the last part of a store asks for, by the ending of ``path``.

    ``missing``: rows of points that are not computed too; netCDF has them always.

    Raises
    ------
    InputError : there is no store, or the ending is not known.
    ComputationError : a file is damaged, or the disk is full.
    """
    opened, to = Store.open(Path(store)), Path(path)
    ending = to.suffix.lower()
    if ending == ".nc":
        from trunnion.results.files import save_dataset

        save_dataset(read(opened).data, to)
    elif ending == ".csv":
        _to_csv(opened, to, missing)
    elif ending == ".parquet":
        _to_parquet(opened, to, missing)
    else:
        raise InputError("is nothing a study is exported as", key="--output", value=str(to),
                         remedy=f"end it in one of {', '.join(ENDINGS)}")  # fmt: skip
    return to


def rows(store: Store, design: StudyDesign, missing: bool) -> Iterator[dict[str, Any]]:
    """Columns by name of a stretch of points at a time, in the order in which the store has them."""
    names = array_names([*design.paths, *(one.path for one in store.question.quantities)])
    for part in store.parts:
        for first, last, found in store.stretches(part):
            if found is None and not missing:
                continue
            values, here = _values(part, design, first, last)
            if found is not None and not missing:
                here &= found.status > 0
            if not here.any():
                continue
            columns: dict[str, Any] = dict(zip(names, values[here].T, strict=False))
            for name, one in zip(names[len(design.paths) :], store.question.quantities, strict=True):
                kept = one.empty(last - first) if found is None else found.values[one.path]
                columns[name] = one.shown(kept[here])
            status = np.zeros(last - first, dtype=np.uint8) if found is None else found.status
            columns["status"] = WORDS[status[here]]
            why = {} if found is None else found.sentences
            columns["why"] = np.array([why.get(int(row), "") for row in np.flatnonzero(here)], dtype=str)
            yield columns


def _values(part: StudyPart, design: StudyDesign, first: int, last: int) -> tuple[Any, Any]:
    """Values (points, parameters of ``design``) of rows of a part, and which of them ``design`` asks for."""
    numbers = part.numbers(first, last)
    if part.design.key == design.key:
        return design.values(numbers), np.ones(len(numbers), dtype=bool)
    places = design.places(part.design, numbers)
    here = places >= 0
    values = np.full((len(numbers), len(design.paths)), np.nan)
    if here.any():
        order = np.argsort(places[here], kind="stable")
        some = np.flatnonzero(here)[order]
        values[some] = design.values(places[some])
    return values, here


def _to_csv(store: Store, to: Path, missing: bool) -> None:
    with written_whole(to) as temporary, temporary.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        for k, columns in enumerate(rows(store, asked_of(store)[0], missing)):
            if not k:
                writer.writerow(columns)
            writer.writerows(zip(*(_plain(column) for column in columns.values()), strict=True))


def _plain(column: Any) -> list[Any]:
    """Numbers in full, nothing for NaN; texts that a spreadsheet would take for a formula in quotes."""
    if column.dtype.kind in "US":
        return [f"'{text}" if text[:1] in ("=", "+", "-", "@") else text for text in column.tolist()]
    return ["" if value != value else value for value in column.tolist()]


def _to_parquet(store: Store, to: Path, missing: bool) -> None:
    arrow, parquet = scale("pyarrow"), scale("pyarrow.parquet")
    design = asked_of(store)[0]
    with written_whole(to) as temporary:
        writer = None
        try:
            for columns in rows(store, design, missing):
                table = arrow.table({name: column.tolist() for name, column in columns.items()})
                writer = writer or parquet.ParquetWriter(temporary, table.schema)
                writer.write_table(table.cast(writer.schema))
        finally:
            if writer is not None:
                writer.close()
        if writer is None:
            raise InputError("has no point that is done", key="store", value=str(store.path),
                             remedy="run the study first")  # fmt: skip
