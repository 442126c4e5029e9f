"""A file of signals, with its description, as a ``Measurement``."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import closing
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from trunnion.arrays import Array
from trunnion.errors import InputError
from trunnion.measured.signals.channel_file import (
    ColumnDescription,
    FileDescription,
    beside,
    description_of,
    read_description,
)
from trunnion.measured.signals.edges import rising_edges
from trunnion.measured.signals.measurement import Channel, Measurement, PulseTrain, SampledSignal, even_times
from trunnion.measured.signals.sources import SignalSource, column_of, opened
from trunnion.numerics.memory import require_memory


def read_measurement(
    path: str | os.PathLike[str], channels: str | os.PathLike[str] | Mapping[str, Any] | None = None
) -> Measurement:
    """Signals of a file: CSV, MAT (5 and 7.3), HDF5, WAV; MDF 4, TDMS and UFF 58 with the extra ``data``.

    Pulses are found chunk by chunk: a file may be larger than the memory.

    Parameters
    ----------
    path : of the file.
    channels : its description, a TOML file or what stands in one; default: the file of the same name that ends in
        ``.channels.toml``.

    Raises
    ------
    InputError : a file or description that cannot be read; a column that is not there; a rate that nobody says; gaps
        and samples that are not numbers.

    Examples
    --------
    >>> import trunnion as tn
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> wheel = {"column": "edge", "name": "flywheel", "kind": "edges", "pulses_per_turn": 2}
    >>> with TemporaryDirectory() as folder:
    ...     table = Path(folder, "bench.csv")
    ...     _ = table.write_text("edge\\n" + "\\n".join(f"{0.1 * k:.3f}" for k in range(20)))
    ...     print(tn.read_measurement(table, {"channel": [wheel]}))
    measurement of 1 channel
      flywheel: 20 pulses, 2 a turn, 9.5 turns in 1.9 s
    """
    file = Path(path)
    with closing(opened(file)) as source:
        description = _description(file, channels, source)
        return _measurement(file, source, description)


def _description(
    file: Path, channels: str | os.PathLike[str] | Mapping[str, Any] | None, source: SignalSource
) -> FileDescription:
    if isinstance(channels, Mapping):
        return description_of(channels, "channels")
    place = beside(file) if channels is None else Path(channels)
    if not place.is_file():
        raise InputError(
            "has no description of its channels", key="data", value=file.name,
            remedy=f"write {place.name} beside it: [[channel]] with column, name, kind; "
            f"its columns are {', '.join(source.columns[:8])}",
        )  # fmt: skip
    return read_description(place)


def _measurement(file: Path, source: SignalSource, description: FileDescription) -> Measurement:
    times = None
    if description.time is not None:
        column = column_of(source, description.time, "time")
        times = even_times(np.concatenate(list(source.chunks(column))), column)
    found = [_channel(source, one, description, times) for one in description.columns]
    return Measurement(found, file.name)


def _channel(
    source: SignalSource, one: ColumnDescription, stated: FileDescription, times: tuple[float, float] | None
) -> Channel:
    column = column_of(source, one.column, one.label)
    if one.kind == "edges":
        edges = _whole(source.chunks(column), one)
        # Counters of unlike numbers of edges leave NaN or zeros at the end of the shorter columns.
        last = len(edges)
        while last and (not np.isfinite(edges[last - 1]) or (last > 1 and edges[last - 1] == 0.0)):
            last -= 1
        return _train(edges[:last] * one.scale + one.offset, one)
    start, rate = times or (0.0, stated.rate or source.rate(column) or 0.0)
    if not rate > 0:
        raise InputError(
            "is missing", element=one.label, key="rate", remedy='write rate = "50 kHz" or time = "t" at the top'
        )
    if one.kind == "pulses":
        edges = rising_edges(source.chunks(column), rate, one.level, one.label, falling=one.edge == "falling")
        return _train(edges + start, one)
    values = (_whole(source.chunks(column), one) * one.scale + one.offset) * one.unit_size
    return SampledSignal(
        values, rate, one.label, one.kind, one.at, start=start, clock=one.clock, gravity=one.once_a_turn
    )


def _train(edges: Array, one: ColumnDescription) -> PulseTrain:
    return PulseTrain(
        edges, one.pulses_per_turn, one.label, one.at, pitch_error=one.pitch_error, reversed=one.reversed,
        clock=one.clock,
    )  # fmt: skip


def _whole(chunks: Iterator[Array], one: ColumnDescription) -> Array:
    parts: list[Array] = []
    for part in chain(chunks):
        parts.append(np.asarray(part, dtype=float))
        held = 16.0 * sum(map(len, parts))
        require_memory(held, element=one.label, key="column", value=one.column, remedy="record it at a lower rate")
    if not sum(map(len, parts)):
        raise InputError("holds no samples", element=one.label, key="column", value=one.column, remedy="record again")
    return np.concatenate(parts)
