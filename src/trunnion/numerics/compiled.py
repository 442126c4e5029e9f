"""Files of kernels that import nothing of the package: copied into a cache folder, compiled once, loaded ever after.

The folder's name is a hash of every source that goes into a kernel and of the versions that compile it, so
an edit or an upgrade starts a new folder and nothing stale is ever run. ``TRUNNION_CACHE`` moves it. Where it
cannot be written, the same text is compiled for this process alone.
"""

from __future__ import annotations

import hashlib
import sys
from functools import cache
from pathlib import Path
from types import ModuleType

import scipy

from trunnion.errors import TrunnionError
from trunnion.numerics.cache_folder import cache_folder, without_a_cache
from trunnion.numerics.jit import CodeCache, NoCodeCache, caches_of
from trunnion.numerics.kept_code import remove
from trunnion.numerics.linked import link_inner_ones
from trunnion.numerics.sources import VERSIONS
from trunnion.writing import written_whole


@cache
def kernel_file(source: str, *used: str) -> ModuleType:
    """The file of kernels ``source``, which imports nothing of the package, compiled from a cached copy.

    Copied rather than imported, so that the folder's name tells which sources the machine code belongs to.
    It may build on other such files: those in ``used`` are there for it as ``trunnion_kernels.NAME``, each of which may
    build on those before it.
    """
    text = Path(source).read_text(encoding="utf-8")
    whole = text
    for place, other in enumerate(used):
        stem = Path(other).stem
        sys.modules.setdefault("trunnion_kernels", ModuleType("trunnion_kernels"))
        sys.modules[f"trunnion_kernels.{stem}"] = kernel_file(other, *used[:place])
        whole += Path(other).read_text(encoding="utf-8")
    digest = hashlib.sha256(f"{whole}{VERSIONS} {scipy.__version__}".encode()).hexdigest()[:16]
    return _module(Path(source).stem, text, digest)


def _module(name: str, source: str, digest: str) -> ModuleType:
    """``source`` as a module, its machine code in the cache; without a cache for this process alone."""
    full = f"trunnion_kernels.{digest}.{name}"
    folder = cache_folder(digest)
    if folder is not None:
        try:
            return _kept(folder / f"{name}.py", source, full)
        except (OSError, TrunnionError) as error:
            without_a_cache(error)
    module = ModuleType(full)
    sys.modules[full] = module
    with caches_of(NoCodeCache):
        exec(compile(source, f"<{name}>", "exec"), vars(module))
    link_inner_ones(module)
    return module


def _kept(path: Path, source: str, full: str) -> ModuleType:
    """The module, run from its text: Python would keep it beside the copy, in a file that is never checked."""
    if not _holds(path, source):
        remove(path)
        with written_whole(path) as temporary:
            temporary.write_text(source, encoding="utf-8", newline="")
    module = ModuleType(full)
    module.__file__ = str(path)
    sys.modules[full] = module
    with caches_of(CodeCache):
        exec(compile(source, str(path), "exec"), vars(module))
    link_inner_ones(module)
    return module


def _holds(path: Path, source: str) -> bool:
    try:
        return path.read_bytes() == source.encode()
    except OSError:
        return False
