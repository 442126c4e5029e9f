"""Files that hold signals, each as columns that are read chunk by chunk.

A source knows its columns by name and gives one as chunks (sample,) of numbers, and the rate where the file says it.
What its library needs to load is loaded when a file of its kind is read.
"""

from __future__ import annotations

import csv
import warnings
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any, NoReturn, Protocol

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError

CHUNK = 1 << 20
"""Samples that are held at a time."""
ROWS = 200_000
"""Rows of a text file that are held at a time."""


class SignalSource(Protocol):
    """Columns of a file."""

    @property
    def columns(self) -> tuple[str, ...]:
        """Their names."""
        ...

    def rate(self, column: str) -> float | None:
        """Samples per second [Hz] of a column, where the file says it."""
        ...

    def chunks(self, column: str) -> Iterator[Array]:
        """Its values, one chunk (sample,) after another."""
        ...

    def close(self) -> None:
        """Let the file go."""
        ...


class Arrays:
    """Columns that are in memory, or in something that gives slices of itself."""

    def __init__(self, columns: dict[str, Any], rates: dict[str, float] | None = None, stream: Any = None) -> None:
        self.held, self.rates, self.stream = columns, rates or {}, stream

    @property
    def columns(self) -> tuple[str, ...]:
        """Their names."""
        return tuple(self.held)

    def rate(self, column: str) -> float | None:
        """As the file says it."""
        return self.rates.get(column)

    def chunks(self, column: str) -> Iterator[Array]:
        """Slices."""
        values = self.held[column]
        for begin in range(0, len(values), CHUNK):
            yield np.asarray(values[begin : begin + CHUNK])

    def close(self) -> None:
        """The file behind them, if it is still open."""
        if self.stream is not None:
            self.stream.close()


class TextColumns:
    """A CSV file: the first line names the columns; they stand apart by commas, semicolons, tabs or blanks."""

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            with path.open(encoding="utf-8-sig", newline="") as stream:
                head = stream.read(20_000)
        except UnicodeDecodeError:
            _unreadable(path, "it is not text")
        if not head.strip():
            _unreadable(path, "it is empty")
        first = head.splitlines()[0]
        self.between = next((one for one in (";", "\t", ",") if one in first), None)
        names = next(csv.reader([first], delimiter=self.between)) if self.between else first.split()
        self.names = tuple(name.strip() for name in names)
        body = head.splitlines()[1:2]
        self.comma = bool(body) and self.between in (";", "\t") and "," in body[0]
        numbers = [name.replace(",", ".") for name in self.names]
        self.headless = all(_is_number(name) for name in numbers)
        if self.headless:
            self.names = tuple(str(place) for place in range(1, len(self.names) + 1))

    @property
    def columns(self) -> tuple[str, ...]:
        """As the first line names them, or numbers from 1."""
        return self.names

    def rate(self, column: str) -> float | None:
        """A text file does not say it."""
        return None

    def chunks(self, column: str) -> Iterator[Array]:
        """Rows at a time."""
        place, done = self.names.index(column), 1 - int(self.headless)
        with self.path.open(encoding="utf-8-sig", newline="") as stream:
            if not self.headless:
                next(stream)
            while lines := [line for _, line in zip(range(ROWS), stream, strict=False)]:
                yield self._numbers(lines, place, column, done)
                done += len(lines)

    def close(self) -> None:
        """It is open only while it is read."""

    def _numbers(self, lines: list[str], place: int, column: str, done: int) -> Array:
        if self.comma:
            lines = [line.replace(",", ".") for line in lines]
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of blank lines
                return np.loadtxt(lines, delimiter=self.between, usecols=place, ndmin=1)
        except (ValueError, IndexError):
            pass
        for k, line in enumerate(lines, start=done + 1):
            cells = line.split(self.between) if self.between else line.split()
            if line.strip() and not (len(cells) > place and _is_number(cells[place])):
                where = f"{self.path.name} line {k}"
                raise InputError(
                    "is not a number", element=where, key=column,
                    value=cells[place].strip() if len(cells) > place else "",
                    remedy="write numbers alone, and no line that is cut off",
                ) from None  # fmt: skip
        return np.zeros(0)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _wave(path: Path) -> SignalSource:
    from scipy.io import wavfile

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of chunks that hold no sound
        rate, data = wavfile.read(path, mmap=True)
    data = data[:, None] if data.ndim == 1 else data
    columns = {str(k + 1): data[:, k] for k in range(data.shape[1])}
    return Arrays(columns, dict.fromkeys(columns, float(rate)))


def _matlab(path: Path) -> SignalSource:
    from scipy.io import loadmat

    try:
        found = loadmat(path, squeeze_me=True)
    except NotImplementedError:  # version 7.3 is HDF5
        return _hdf5(path)
    numbers = {
        key: np.atleast_1d(value) for key, value in found.items()
        if not key.startswith("__") and np.issubdtype(np.asarray(value).dtype, np.number)
    }  # fmt: skip
    columns: dict[str, Any] = {}
    for key, value in numbers.items():
        if value.ndim == 1:
            columns[key] = value
        elif value.ndim == 2:
            columns |= {f"{key}:{k + 1}": value[:, k] for k in range(value.shape[1])}
    return Arrays(columns)


class _Rows:
    """One row or column of a stored matrix, read slice by slice."""

    def __init__(self, data: Any, place: int | None, along: int) -> None:
        self.data, self.place, self.along = data, place, along

    def __len__(self) -> int:
        return int(self.data.shape[self.along])

    def __getitem__(self, part: slice) -> Array:
        if self.place is None:
            return np.asarray(self.data[part])
        return np.asarray(self.data[part, self.place] if self.along == 0 else self.data[self.place, part])


def _hdf5(path: Path) -> SignalSource:
    import h5py

    stream = h5py.File(path, "r")
    columns: dict[str, Any] = {}
    rates: dict[str, float] = {}

    def visit(name: str, data: Any) -> None:
        if not isinstance(data, h5py.Dataset) or not np.issubdtype(data.dtype, np.number) or data.ndim not in (1, 2):
            return
        own = {name: _Rows(data, None, 0)}
        if data.ndim == 2:  # the longer way is time, as of files of MATLAB, whose matrices stand transposed
            along = int(np.argmax(data.shape))
            several = data.shape[1 - along]
            own = {name if several == 1 else f"{name}:{k + 1}": _Rows(data, k, along) for k in range(several)}
        columns.update(own)
        for key in ("rate", "sample_rate", "fs"):
            if key in data.attrs:
                rates.update(dict.fromkeys(own, float(np.ravel(data.attrs[key])[0])))

    stream.visititems(visit)
    return Arrays(columns, rates, stream)


def _mdf(path: Path) -> SignalSource:
    from asammdf import MDF

    with path.open("rb") as raw:  # what is no such file leaves the library with halves of itself
        if not raw.read(168).ljust(168, b"\0").startswith(b"MDF  ") or path.stat().st_size < 300:
            raise ValueError("it is not MDF, or is cut off")
    columns: dict[str, Any] = {}
    rates: dict[str, float] = {}
    with closing(MDF(path)) as stream:
        for group, content in enumerate(stream.groups):
            for index, channel in enumerate(content.channels):
                signal = stream.get(group=group, index=index, raw=False)
                if not np.issubdtype(signal.samples.dtype, np.number):
                    continue
                name = channel.name if channel.name not in columns else f"{group}:{channel.name}"
                columns[name] = np.asarray(signal.samples)
                steps = np.diff(signal.timestamps)
                if len(steps) and steps.min() > 0 and np.ptp(steps) < 1e-3 * steps.mean():
                    rates[name] = float(len(steps) / (signal.timestamps[-1] - signal.timestamps[0]))
    return Arrays(columns, rates)


def _tdms(path: Path) -> SignalSource:
    from nptdms import TdmsFile

    stream = TdmsFile.open(path)
    columns: dict[str, Any] = {}
    rates: dict[str, float] = {}
    for group in stream.groups():
        for channel in group.channels():
            if not np.issubdtype(channel.dtype, np.number):
                continue
            name = channel.name if channel.name not in columns else f"{group.name}/{channel.name}"
            columns[name] = channel
            if "wf_increment" in channel.properties:
                rates[name] = 1.0 / float(channel.properties["wf_increment"])
    return Arrays(columns, rates, stream)


def _universal(path: Path) -> SignalSource:
    import pyuff

    sets = pyuff.UFF(str(path)).read_sets()
    columns: dict[str, Any] = {}
    rates: dict[str, float] = {}
    for place, one in enumerate(sets if isinstance(sets, list) else [sets], start=1):
        if one.get("type") != 58 or np.iscomplexobj(one["data"]):
            continue
        name = str(one.get("id1", "")).strip()
        name = name if name and name not in columns and name.upper() != "NONE" else str(place)
        columns[name] = np.asarray(one["data"], dtype=float)
        steps = np.diff(one["x"])
        if len(steps) and steps.min() > 0 and np.ptp(steps) < 1e-3 * steps.mean():
            rates[name] = float(1 / steps.mean())
    return Arrays(columns, rates)


OPENED: dict[str, tuple[Callable[[Path], SignalSource], str]] = {
    ".csv": (TextColumns, ""), ".txt": (TextColumns, ""), ".dat": (TextColumns, ""), ".asc": (TextColumns, ""),
    ".wav": (_wave, ""), ".mat": (_matlab, ""), ".h5": (_hdf5, ""), ".hdf5": (_hdf5, ""), ".hdf": (_hdf5, ""),
    ".mf4": (_mdf, "asammdf"), ".mdf": (_mdf, "asammdf"), ".tdms": (_tdms, "nptdms"),
    ".uff": (_universal, "pyuff"), ".unv": (_universal, "pyuff"),
}  # fmt: skip
"""By ending: what opens a file, and the library of the extra ``data`` that it takes."""


def opened(path: Path) -> SignalSource:
    """The source of a file.

    Raises
    ------
    InputError : an ending that is not known, a library that is missing, a file that is damaged or holds no numbers.
    """
    ending = path.suffix.lower()
    if ending not in OPENED:
        remedy = f"files end in {', '.join(OPENED)}"
        raise InputError("is not a file of signals", key="data", value=path.name, remedy=remedy)
    if path.is_dir():
        raise InputError("is a folder", key="data", value=str(path), remedy="name a file in it")
    if not path.is_file():
        raise InputError("is not there", key="data", value=str(path), remedy="correct the path")
    maker, library = OPENED[ending]
    try:
        found = maker(path)
    except InputError:
        raise
    except ImportError:
        remedy = 'pip install "trunnion[data]"'
        raise InputError(f"needs the library {library}", key="data", value=path.name, remedy=remedy) from None
    except Exception as error:  # what libraries raise of damaged files has no common base
        _unreadable(path, str(error))
    if not found.columns:
        _unreadable(path, "it holds no column of numbers")
    return found


def _unreadable(path: Path, why: str) -> NoReturn:
    remedy = "record or export it again"
    raise InputError(f"cannot be read ({why})", key="data", value=path.name, remedy=remedy) from None


def column_of(source: SignalSource, column: str | int, where: str) -> str:
    """The name of a column that a description names, or numbers from 1.

    Raises
    ------
    InputError : there is none.
    """
    names = source.columns
    if isinstance(column, int):
        if not 1 <= column <= len(names):
            remedy = f"there are {len(names)}: {', '.join(names[:8])}"
            raise InputError("is not a column of the file", element=where, key="column", value=column, remedy=remedy)
        return names[column - 1]
    if column in names:
        return column
    raise InputError(
        "is not a column of the file", element=where, key="column", value=column, remedy=nearest(column, names)
    )
