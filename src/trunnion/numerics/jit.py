"""numba's ``njit`` with the machine code kept in the package's cache folder, or for this process alone.

numba keeps it beside the source, which an installation by somebody else does not allow, and refuses to
compile where it finds no place at all. It also looks only at a function's own file, not at those of the functions
that it calls: machine code is therefore kept in a folder named after all sources it may come from. And it runs whatever
its files hold: here a file says by its checksum whether it is whole, and one that is not is compiled anew. A folder
that cannot be written and a disk that is full stop nothing here: they cost the time to compile, and a remark.
"""

from __future__ import annotations

import hashlib
import pickle
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, Literal

import numba
from numba.core import caching, ccallback, compiler, dispatcher, event, serialize

from trunnion.numerics import kept_code, shipped
from trunnion.numerics.cache_folder import cache_folder, without_a_cache
from trunnion.numerics.compile_lock import CompileLock, release_all
from trunnion.numerics.linked import INNER, link_only
from trunnion.numerics.sources import SOURCES, digest_of

# numba states no types of these.
DECORATORS: tuple[Any, ...] = (dispatcher, ccallback)
"""Where numba's decorators find the cache that they give a function."""
C_FUNCTION: Any = ccallback.CFunc
NO_CACHE: Any = caching.NullCache
COMPILED: Any = compiler.CompileResult
DUMPS: Any = serialize.dumps


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


def is_compiled(*functions: Any) -> bool:
    """Whether there is machine code of all these functions already, in memory, kept or come along."""
    return all(function.overloads or function._cache.filled() for function in functions)


def _kept_in(folder: Path | None, function: Callable[..., Any]) -> Any:
    """The cache of a function: in ``folder``, or for this process alone."""
    return NoCodeCache(function) if folder is None or _source(function) is None else CodeCache(function, folder)


class NoCodeCache(NO_CACHE):
    """No cache of one function but what came with the installation."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._function = function

    def load_overload(self, signature: Any, context: Any) -> Any:
        """The machine code for a signature, or None."""
        return shipped.load(self._function, signature, context)

    def filled(self) -> bool:
        """Whether anything came along."""
        return shipped.in_use()


class CodeCache(NoCodeCache):
    """The machine code of one function, a file a signature in ``folder``, by default that of the function's source.

    It looks also at what came with the installation, lets one process compile while others wait, and makes of a failure
    to keep what it compiled a remark, not an error.
    """

    def __init__(self, function: Callable[..., Any], folder: Path | None = None) -> None:
        super().__init__(function)
        self._folder = folder or Path(function.__code__.co_filename).parent
        self._name = f"{function.__module__}.{function.__qualname__}"
        line = function.__code__.co_firstlineno
        self._stem = f"{re.sub(r'[^0-9A-Za-z_.]', '', self._name)[-80:]}-{line}"
        self._lock = CompileLock(self._folder / f"{self._stem}.lock")

    @property
    def cache_path(self) -> str:
        """Where it is kept."""
        return str(self._folder)

    def load_overload(self, signature: Any, context: Any) -> Any:
        """The machine code for a signature, or None: then the lock is held until it is saved."""
        found = self._read(signature, context)
        if found is None:
            found = super().load_overload(signature, context)
        if found is None:
            self._lock.take()
            found = self._read(signature, context)  # whoever held it may have kept it meanwhile
            if found is not None:
                self._lock.release()
        return found

    def filled(self) -> bool:
        """Whether anything is kept, or came along."""
        return any(self._folder.glob(f"{self._stem}.*{kept_code.ENDING}")) or super().filled()

    def save_overload(self, signature: Any, compiled: Any) -> None:
        """Keep what was compiled, if there is room and it means the same in another process."""
        shipped.keep(self._function, signature, compiled)
        try:
            if _lasts(signature) and not compiled.library.has_dynamic_globals and not compiled.lifted:
                key = self._key(signature, compiled.codegen)
                processor = str(compiled.codegen.magic_tuple()[1])
                kept_code.write(self._path(key), self._name, processor, DUMPS((key, compiled._reduce())))
        except OSError as error:
            without_a_cache(error)
        finally:
            self._lock.release()

    def flush(self) -> None:
        """Forget what is kept."""
        for path in self._folder.glob(f"{self._stem}.*{kept_code.ENDING}"):
            kept_code.remove(path)

    def _read(self, signature: Any, context: Any) -> Any:
        """What is kept for a signature; what does not come back is deleted."""
        context.refresh()  # what the code is bound to is known only then
        key = self._key(signature, context.codegen())
        path = self._path(key)
        content = kept_code.read(path) if _lasts(signature) else None
        if content is None:
            return None
        try:
            of, reduced = pickle.loads(content)
            return COMPILED._rebuild(context, *reduced) if of == key else None
        except Exception:  # of whatever kind: it is written anew
            kept_code.remove(path)
            return None

    def _key(self, signature: Any, codegen: Any) -> tuple[Any, ...]:
        """What the machine code depends on: types, processor, source, and what the function closes over."""
        code, cells = self._function.__code__.co_code, self._function.__closure__ or ()
        enclosed = DUMPS(tuple(cell.cell_contents for cell in cells)) if cells else b""
        parts = (_source(self._function), *(hashlib.sha256(part).hexdigest() for part in (code, enclosed)))
        return signature, codegen.magic_tuple(), parts

    def _path(self, key: tuple[Any, ...]) -> Path:
        word = hashlib.sha256(repr(key).encode()).hexdigest()[:16]
        return self._folder / f"{self._stem}.{word}{kept_code.ENDING}"


def _source(function: Callable[..., Any]) -> str | None:
    """A word for the file of a function; None where there is none."""
    return _word_of(function.__code__.co_filename)


@cache
def _word_of(path: str) -> str | None:
    try:
        return hashlib.sha256(Path(path).read_bytes()).hexdigest()
    except OSError:
        return None


def _lasts(signature: Any) -> bool:
    """Whether types mean the same in another process: those of functions hold their address."""
    return " at 0x" not in str(signature)


class _FailedCompilations(event.Listener):  # type: ignore[misc]
    """What is not compiled is not saved either, which would let the next process in: without this it would wait for
    the end of a process whose user's function no compiler takes, or that was interrupted."""

    def on_start(self, event: Any) -> None:
        """Nothing to do."""

    def on_end(self, event: Any) -> None:
        """Hold nothing back after a failure, which numba's own ``is_failed`` does not tell."""
        if sys.exc_info()[0] is not None:
            release_all()


event.register("numba:compile", _FailedCompilations())  # type: ignore[no-untyped-call]


@contextmanager
def caches_of(kind: type[CodeCache] | type[NoCodeCache]) -> Iterator[None]:
    """Within it numba's own decorators with ``cache=True`` give their functions caches of this kind, and those of C
    functions tell that they compile, as all others do: whoever counts the time, or releases locks, hears of it."""
    before, silent = [module.FunctionCache for module in DECORATORS], C_FUNCTION._compile_uncached
    for module in DECORATORS:
        module.FunctionCache = kind

    def compile_heard(function: Any) -> Any:
        with event.trigger_event("numba:compile"):  # type: ignore[no-untyped-call]
            return silent(function)

    C_FUNCTION._compile_uncached = compile_heard
    try:
        yield
    finally:
        C_FUNCTION._compile_uncached = silent
        for module, one in zip(DECORATORS, before, strict=True):
            module.FunctionCache = one
