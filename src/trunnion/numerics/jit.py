"""numba's ``njit`` with the machine code kept in the package's cache folder, or for this process alone.

numba keeps it beside the source, which an installation by somebody else does not allow, and refuses to
compile where it finds no place at all. It also looks only at a function's own file, not at those of the functions
that it calls: machine code is therefore kept in a folder named after all sources it may come from. A folder that
cannot be written and a disk that is full stop nothing here: they cost the time to compile, and a remark.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any, Literal

import numba
from numba.core.dispatcher import Dispatcher

from trunnion.numerics import shipped
from trunnion.numerics.cache_folder import cache_folder, without_a_cache
from trunnion.numerics.compile_lock import CompileLock
from trunnion.numerics.sources import SOURCES, digest_of


def njit(
    *,
    cache: bool = True,
    nogil: bool = False,
    fastmath: bool | set[str] = False,
    error_model: Literal["python", "numpy"] = "python",
    inner: bool = False,
) -> Callable[[Callable[..., Any]], Any]:
    """As numba's decorator of that name; ``cache`` is a wish.

    ``inner``: only compiled code calls it; the entrance for Python takes half the time to compile of a small function.
    """

    def decorate(function: Callable[..., Any]) -> Any:
        folder = cache_folder(f"package-{digest_of(SOURCES)}") if cache else None
        options: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True} if inner else {}
        made: Any = numba.njit(nogil=nogil, fastmath=fastmath, error_model=error_model, **options)(function)
        if folder is not None:
            _keep_in(str(folder), made)
        if cache:
            keep_if_possible(made)
        return made

    return decorate


def _keep_in(folder: str, function: Any) -> None:
    config: Any = numba.config
    before, config.CACHE_DIR = config.CACHE_DIR, folder
    try:
        function.enable_caching()
    except RuntimeError:  # the folder went away since it was tried, or the source is no file
        return
    finally:
        config.CACHE_DIR = before


def keep_if_possible(function: Any) -> None:
    """Let ``function`` use machine code that came along, one process compile it while others wait, and a failure to
    keep what it compiled end in a remark, not in an error."""
    kept: Any = getattr(function, "_cache", None)
    save, load = getattr(kept, "save_overload", None), getattr(kept, "load_overload", None)
    if save is None or load is None:
        return
    name = f"{function.py_func.__module__}.{function.py_func.__qualname__}.lock"
    lock = CompileLock(None if kept.cache_path is None else Path(kept.cache_path) / name)

    def load_overload(signature: Any, context: Any) -> Any:
        found = load(signature, context)
        if found is None:
            found = shipped.load(function, signature, context)
        if found is None:
            lock.take()
            found = load(signature, context)  # whoever held it may have kept it meanwhile
            if found is not None:
                lock.release()
        return found

    def save_overload(signature: Any, data: Any) -> None:
        shipped.keep(function, signature, data)
        try:
            save(signature, data)
        except OSError as error:
            without_a_cache(error)
        finally:
            lock.release()

    kept.load_overload, kept.save_overload = load_overload, save_overload


def keep_module_if_possible(module: ModuleType) -> None:
    """The same for all compiled functions of a module."""
    for value in vars(module).values():
        if isinstance(value, Dispatcher):
            keep_if_possible(value)
