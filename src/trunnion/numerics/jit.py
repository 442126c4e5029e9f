"""numba's ``njit`` with the machine code kept in the package's cache folder, or for this process alone.

numba keeps it beside the source, which an installation by somebody else does not allow, and refuses to
compile where it finds no place at all. It also looks only at a function's own file, not at those of the functions
that it calls: machine code is therefore kept in a folder named after all sources it may come from. A folder that
cannot be written and a disk that is full stop nothing here: they cost the time to compile, and a remark.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

import numba
from numba.core import caching, ccallback, dispatcher, event

from trunnion.numerics import shipped
from trunnion.numerics.cache_folder import cache_folder, without_a_cache
from trunnion.numerics.compile_lock import CompileLock, release_all
from trunnion.numerics.linked import INNER, link_only
from trunnion.numerics.sources import SOURCES, digest_of

# numba states no types of these.
DECORATORS: tuple[Any, ...] = (dispatcher, ccallback)
"""Where numba's decorators find the cache that they give a function."""
CACHE: Any = caching.FunctionCache
NO_CACHE: Any = caching.NullCache


def njit(
    *,
    cache: bool = True,
    nogil: bool = False,
    fastmath: bool | set[str] = False,
    error_model: Literal["python", "numpy"] = "python",
    inner: bool = False,
) -> Callable[[Callable[..., Any]], Any]:
    """As numba's decorator of that name; ``cache`` is a wish.

    ``inner``: only compiled code calls it; see ``linked``.
    """

    def decorate(function: Callable[..., Any]) -> Any:
        options: dict[str, Any] = INNER if inner else {}
        made: Any = numba.njit(nogil=nogil, fastmath=fastmath, error_model=error_model, **options)(function)
        if inner:
            link_only(made)
        elif cache:
            made._cache = _kept_in(cache_folder(f"package-{digest_of(SOURCES)}"), function)
        return made

    return decorate


def at_hand(*functions: Any) -> bool:
    """Whether there is machine code of all these functions already, in memory, kept or come along."""
    return all(function.overloads or function._cache.filled() for function in functions)


def _kept_in(folder: Path | None, function: Callable[..., Any]) -> Any:
    """The cache of a function: below ``folder``, or for this process alone."""
    if folder is None:
        return NotKept(function)
    config: Any = numba.config
    before, config.CACHE_DIR = config.CACHE_DIR, str(folder)
    try:
        return Kept(function)
    except RuntimeError:  # the folder went away since it was tried, or the source is no file
        return NotKept(function)
    finally:
        config.CACHE_DIR = before


class Kept(CACHE):
    """numba's cache of one function, which looks also at what came with the installation, lets one process compile
    while others wait, and makes of a failure to keep what it compiled a remark, not an error."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        self._lock = CompileLock(Path(self.cache_path) / f"{function.__module__}.{function.__qualname__}.lock")

    def load_overload(self, signature: Any, context: Any) -> Any:
        """The machine code for a signature, or None: then the lock is held until it is saved."""
        found = super().load_overload(signature, context)
        if found is None:
            found = shipped.load(self._py_func, signature, context)
        if found is None:
            self._lock.take()
            found = super().load_overload(signature, context)  # whoever held it may have kept it meanwhile
            if found is not None:
                self._lock.release()
        return found

    def filled(self) -> bool:
        """Whether anything is kept, or came along."""
        return bool(self._cache_file._load_index()) or shipped.in_use()

    def save_overload(self, signature: Any, compiled: Any) -> None:
        """Keep what was compiled, if there is room."""
        shipped.keep(self._py_func, signature, compiled)
        try:
            super().save_overload(signature, compiled)
        except OSError as error:
            without_a_cache(error)
        finally:
            self._lock.release()


class _Failures(event.Listener):  # type: ignore[misc]
    """What is not compiled is not saved either, which would let the next process in: without this it would wait for
    the end of a process whose user's function no compiler takes, or that was interrupted."""

    def on_start(self, event: Any) -> None:
        """Nothing to do."""

    def on_end(self, event: Any) -> None:
        """Hold nothing back after a failure, which numba's own ``is_failed`` does not tell."""
        if sys.exc_info()[0] is not None:
            release_all()


event.register("numba:compile", _Failures())  # type: ignore[no-untyped-call]


class NotKept(NO_CACHE):
    """No cache of one function but what came with the installation."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._function = function

    def load_overload(self, signature: Any, context: Any) -> Any:
        """The machine code for a signature, or None."""
        return shipped.load(self._function, signature, context)

    def filled(self) -> bool:
        """Whether anything came along."""
        return shipped.in_use()


@contextmanager
def caches_of(kind: type[Kept] | type[NotKept]) -> Iterator[None]:
    """Within it numba's own decorators with ``cache=True`` give their functions caches of this kind."""
    before = [module.FunctionCache for module in DECORATORS]
    for module in DECORATORS:
        module.FunctionCache = kind
    try:
        yield
    finally:
        for module, one in zip(DECORATORS, before, strict=True):
            module.FunctionCache = one
