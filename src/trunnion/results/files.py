"""Datasets as netCDF-4 files that know whether they are whole.

A file is made in memory, because HDF5 does not survive a disk that fills, and ends in a line with the SHA-256 of
all bytes before it. Readers of netCDF and HDF5 pass over that line. It is checked before HDF5 sees the file:
damaged structures can crash it.
"""

from __future__ import annotations

import hashlib
import io
import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from trunnion._version import __version__
from trunnion.errors import InputError, short
from trunnion.numerics.memory import MOST, size_text
from trunnion.reading import regular_bytes
from trunnion.results.variables import Attribute, Variable
from trunnion.writing import written_whole

if TYPE_CHECKING:
    import xarray as xr

FORMAT_VERSION = 1
"""Of what all files have in common; the attribute ``format`` tells kinds of results apart."""
LARGEST = MOST
"""Bytes of a file that is read, and of the arrays in it."""
_LABEL = b"\ntrunnion sha256 "
_TAIL = len(_LABEL) + 64 + 1


def save_dataset(data: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write ``data`` as netCDF-4; an existing file is replaced only when all is written.

    Raises
    ------
    InputError : the place cannot be written.
    ComputationError : the disk is full or fails.
    """
    content = dataset_bytes(data)
    with written_whole(path) as temporary:
        temporary.write_bytes(content)


def dataset_bytes(data: xr.Dataset) -> bytes:
    """What ``save_dataset`` writes."""
    import h5netcdf
    from xarray.backends import H5NetCDFStore

    whole = data.assign_attrs(format_version=FORMAT_VERSION, trunnion=__version__)
    stream = io.BytesIO()
    with h5netcdf.File(stream, "w") as file:
        whole.dump_to_store(H5NetCDFStore(file))
    return _signed(stream.getvalue())


def save_numbers(declared: Iterable[Variable | Attribute], path: str | os.PathLike[str]) -> None:
    """Write arrays of numbers and attributes as ``save_dataset`` would write their dataset; errors as there.

    It does without xarray, whose import takes longer than most charts.
    """
    import h5netcdf

    stream = io.BytesIO()
    with h5netcdf.File(stream, "w") as file:
        for one in declared:
            if isinstance(one, Attribute):
                if one.values is not None:
                    file.attrs[one.name] = _attribute(one.values)
                continue
            values = np.asarray(one.values)
            for axis, length in zip(one.dims, values.shape, strict=True):
                if axis not in file.dimensions:
                    file.dimensions[axis] = length
            filled = np.nan if values.dtype.kind == "f" else None
            variable = file.create_variable(one.name, one.dims, values.dtype, fillvalue=filled)
            variable[...] = values
            for name, value in one.attributes.items():
                variable.attrs[name] = _attribute(value)
        file.attrs["format_version"], file.attrs["trunnion"] = _attribute(FORMAT_VERSION), __version__
    content = _signed(stream.getvalue())
    with written_whole(path) as temporary:
        temporary.write_bytes(content)


def _attribute(value: Any) -> Any:
    return value if isinstance(value, str) else np.atleast_1d(value)


def _signed(content: bytes) -> bytes:
    return content + _LABEL + hashlib.sha256(content).hexdigest().encode() + b"\n"


def read_dataset(path: str | os.PathLike[str], kind: str) -> xr.Dataset:
    """Read a dataset whose attribute ``format`` is ``kind``.

    Raises
    ------
    InputError : there is no such file, it is damaged, from elsewhere, of another kind or of a later version.
    """
    content = _whole(path)
    import xarray as xr

    _require_plain(path, content)
    try:
        data = xr.load_dataset(io.BytesIO(content), engine="h5netcdf", phony_dims="access")
    except Exception:  # the bytes are those that were written, so they are not a dataset: xarray has many errors for it
        raise _refusal(path, "is not a netCDF file") from None
    if data.attrs.get("format_version") != FORMAT_VERSION:
        raise _refusal(path, "is of another version of the format", data.attrs.get("format_version"))
    if data.attrs.get("format") != kind:
        _refuse_kind(path, kind, data)
    return data


def _refuse_kind(path: str | os.PathLike[str], kind: str, data: xr.Dataset) -> NoReturn:
    """Say of a file of another kind, or of another version of this kind, which it is."""
    found = str(data.attrs.get("format"))
    (what, _, number), (its, _, other) = kind.rpartition(" "), found.rpartition(" ")
    if its != what or not other.isdecimal() or len(other) > 4:
        raise _refusal(path, f'is not a "{kind}"', data.attrs.get("format"))
    older = int(other) < int(number)
    writer = short(str(data.attrs.get("trunnion", "unknown")), 20)
    remedy = f"compute it again, or read it with Trunnion {writer}, which wrote it" if older else "use a newer Trunnion"
    problem = f"is of {'an older' if older else 'a later'} format, {its} {other}; this Trunnion reads {number}"
    raise InputError(problem, key=str(path), remedy=remedy)


def _require_plain(path: str | os.PathLike[str], content: bytes) -> None:
    """Refuse what unpacks to more than memory is given to, and what takes its numbers from other files.

    Raises
    ------
    InputError : so, or these bytes are not an HDF5 file.
    """
    import h5py

    try:
        with h5py.File(io.BytesIO(content), "r") as file:
            links = [file.get(name, getlink=True) for name in file]
            alone = all(isinstance(link, h5py.HardLink) for link in links)
            arrays = [file[name] for name in file] if alone else []
            alone = alone and not any(a.external or a.is_virtual for a in arrays if isinstance(a, h5py.Dataset))
            size = sum(float(a.size or 0) * a.dtype.itemsize for a in arrays if isinstance(a, h5py.Dataset))
            groups = any(not isinstance(a, h5py.Dataset) for a in arrays)
    except Exception:  # damaged structures have many errors
        raise _refusal(path, "is not a netCDF file") from None
    if not alone or groups:
        raise _refusal(path, "has parts that this program does not write")
    if size > LARGEST:
        raise _refusal(path, f"unpacks to {size_text(size)}, at most {size_text(LARGEST)} is read")


def _whole(path: str | os.PathLike[str]) -> bytes:
    """The bytes before the checksum, once it holds."""
    try:
        content = regular_bytes(path, LARGEST, what="a result this program saved")
    except InputError:
        raise
    except FileNotFoundError:
        raise InputError("does not exist", key=str(path), remedy="check the path") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "no name of a file"
        raise InputError(f"cannot be read ({reason})", key=str(path), remedy="check the path") from None
    body, tail = content[:-_TAIL], content[-_TAIL:]
    if not tail.startswith(_LABEL):
        raise _refusal(path, "is not a whole file of this program: it does not end in a checksum")
    if tail[len(_LABEL) : -1] != hashlib.sha256(body).hexdigest().encode():
        raise _refusal(path, "is damaged: its content does not fit its checksum")
    return body


def _refusal(path: str | os.PathLike[str], problem: str, found: object = None) -> InputError:
    said = "" if found is None else f" (it says {str(found)[:60]!r})"
    return InputError(f"{problem}{said}", key=str(path), remedy="give a file this program saved, or compute it again")
