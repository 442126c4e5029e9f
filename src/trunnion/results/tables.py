"""A dataset as a table: what runs along one axis, a column per element, order or state."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from typing import IO, Any

RUNS_ALONG = {"time": "s", "turn": "", "speed": "rad/s", "point": "", "quantity": ""}
"""Axes that are the rows of a table, with their units; where a result has none, those of its first variable are."""


def write_table(stream: IO[str], data: Any) -> None:
    """Every variable of a dataset along the axis of its rows; those that have it not stand in no table."""
    axis = next((d for d in RUNS_ALONG if d in data.sizes), None) or next(v.dims[0] for v in data.values() if v.dims)
    there = axis in data.coords
    unit = data[axis].attrs.get("units", RUNS_ALONG.get(axis, "")) if there else ""
    columns = {f"{axis} [{unit}]" if unit else axis: data[axis].values if there else range(data.sizes[axis])}
    for name, part in data.data_vars.items():
        if axis in part.dims:
            unit = part.attrs.get("units", "1")
            head = str(name) if unit == "1" else f"{name} [{unit}]"
            columns |= dict(_columns(data, part.transpose(axis, ...), head))
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
