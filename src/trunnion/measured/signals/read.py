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
from trunnion.measured.signals.thinning import HALF_TAPS, thinned_chunks
from trunnion.numerics.memory import require_memory
from trunnion.results.counts import counted
from trunnion.results.units import figures


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
        times = even_times(np.concatenate([np.zeros(0), *source.chunks(column)]), column)
    remarks: list[str] = []
    found = [_channel(source, one, description, times, remarks) for one in description.columns]
    return Measurement(found, file.name, tuple(remarks))


def _channel(
    source: SignalSource,
    one: ColumnDescription,
    stated: FileDescription,
    times: tuple[float, float] | None,
    remarks: list[str],
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
    factor = int(rate // one.keep_rate) if one.keep_rate else 1
    chunks = source.chunks(column)
    if factor > 1:
        chunks = thinned_chunks(_sound(chunks, source.chunks(column), rate, one, remarks), factor)
        start, rate = start + HALF_TAPS * factor / rate, rate / factor
    values = (_whole(chunks, one) * one.scale + one.offset) * one.unit_size
    return SampledSignal(
        values, rate, one.label, one.kind, one.at, start=start, clock=one.clock, gravity=one.once_a_turn
    )


def _train(edges: Array, one: ColumnDescription) -> PulseTrain:
    return PulseTrain(
        edges, one.pulses_per_turn, one.label, one.at, pitch_error=one.pitch_error, reversed=one.reversed,
        clock=one.clock,
    )  # fmt: skip


def _sound(
    chunks: Iterator[Array], again: Iterator[Array], rate: float, one: ColumnDescription, remarks: list[str]
) -> Iterator[Array]:
    """The chunks; what a filter would hide of them is refused or said: samples that are no numbers, clipped ones.

    again : the same chunks, looked at before, for the largest and smallest value.
    """
    ends = np.array([[part.min(), part.max()] for part in again if len(part)])
    low, high = (float(ends[:, 0].min()), float(ends[:, 1].max())) if len(ends) else (0.0, 0.0)
    done, flat, row = 0, 0, np.zeros(2, dtype=bool)
    for part in chunks:
        bad = ~np.isfinite(part)
        if bad.any():
            at = (done + int(np.argmax(bad))) / rate
            raise InputError(
                f"has samples that are not numbers, the first at {at:.6g} s", element=one.label, key="column",
                remedy="cut the gap out, or read the parts on either side",
            )  # fmt: skip
        row = np.append(row[-2:], (part == low) | (part == high)) if high > low else np.zeros(2, dtype=bool)
        flat += int((row[:-2] & row[1:-1] & row[2:]).sum())
        done += len(part)
        yield np.asarray(part, dtype=float)
    if flat:
        share = figures(100 * flat / done, 2)
        remarks.append(
            f"{one.label} is clipped: {counted(flat, 'sample')} ({share} %) stand at its largest or smallest value; "
            "its orders are too small and have false harmonics."
        )


def _whole(chunks: Iterator[Array], one: ColumnDescription) -> Array:
    parts: list[Array] = []
    for part in chain(chunks):
        parts.append(np.asarray(part, dtype=float))
        held = 16.0 * sum(map(len, parts))
        require_memory(
            held, element=one.label, key="column", value=one.column, remedy='keep fewer samples: keep_rate = "5 kHz"'
        )
    if not sum(map(len, parts)):
        raise InputError("holds no samples", element=one.label, key="column", value=one.column, remedy="record again")
    return np.concatenate(parts)
