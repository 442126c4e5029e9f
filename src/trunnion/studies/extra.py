"""The extra ``scale``: what studies need beyond the package, and the line that says how to install it."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from trunnion.errors import InputError

INSTALL = 'install it with: python -m pip install "trunnion[scale]"'


def scale(module: str) -> Any:
    """A module of the extra.

    Raises
    ------
    InputError : it is not installed.
    """
    try:
        return import_module(module)
    except ImportError as error:
        name = (error.name or module).partition(".")[0]
        raise InputError(f"studies need {name}, which is not installed", key="scale", remedy=INSTALL) from None


def zarr() -> Any:
    """Zarr, a version that replaces a shard in one step."""
    found = scale("zarr")
    version = tuple(int(part) for part in found.__version__.split(".")[:3] if part.isdigit())
    if version < (3, 1, 3):
        raise InputError(f"is {found.__version__}, which may leave half a shard", key="zarr",
                         remedy='python -m pip install "zarr>=3.1.3"')  # fmt: skip
    return found


def require_all() -> None:
    """Refuse to begin without the extra.

    Raises
    ------
    InputError : it is not installed.
    """
    for module in ("dask", "distributed", "pyarrow"):
        scale(module)
    zarr()
