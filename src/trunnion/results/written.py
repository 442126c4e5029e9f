"""A result as a file of numbers: written by itself where it knows how, else from its dataset."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from trunnion.results.files import save_dataset
from trunnion.results.tables import write_table
from trunnion.writing import written_whole


def write_numbers(result: Any, path: str | os.PathLike[str], table: Any = None) -> None:
    """Write a result as netCDF-4 or CSV; an existing file is replaced only when all is written.

    Parameters
    ----------
    result : has a dataset ``data``, and where it writes files of its own ``save`` or ``to_csv``.
    path : ends in .csv; with any other ending it becomes netCDF-4.
    table : a dataset that stands in the CSV in place of all that the result holds.

    Raises
    ------
    InputError : the place cannot be written.
    ComputationError : the disk is full or fails.
    """
    if Path(path).suffix.lower() != ".csv":
        if hasattr(result, "save"):
            result.save(path)
        else:
            save_dataset(result.data, path)
    elif table is None and hasattr(result, "to_csv"):
        result.to_csv(path)
    else:
        with written_whole(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as stream:
            write_table(stream, result.data if table is None else table)
