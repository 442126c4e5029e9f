"""Files of kernels that import nothing of the package: copied into a cache folder, compiled once, loaded ever after.

The folder's name is a hash of every source that goes into a kernel and of the versions that compile it, so
an edit or an upgrade starts a new folder and nothing stale is ever run. ``TRUNNION_CACHE`` moves it. Where it
cannot be written, the same text is compiled for this process alone.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import sys
import tempfile
from functools import cache
from pathlib import Path
from types import ModuleType

import scipy

from trunnion.numerics.cache_folder import cache_folder, without_a_cache
from trunnion.numerics.jit import Kept, NotKept, caches_of
from trunnion.numerics.linked import link_inner_ones
from trunnion.numerics.sources import VERSIONS


@cache
def kernel_file(source: str, *used: str) -> ModuleType:
    """The file of kernels ``source``, which imports nothing of the package, compiled from a cached copy.

    Copied rather than imported, so that the folder's name tells which sources the machine code belongs to.
    It may build on other such files: those in ``used`` are there for it as ``trunnion_kernels.NAME``.
    """
    text = Path(source).read_text(encoding="utf-8")
    whole = text
    for other in used:
        stem = Path(other).stem
        sys.modules.setdefault("trunnion_kernels", ModuleType("trunnion_kernels"))
        sys.modules[f"trunnion_kernels.{stem}"] = kernel_file(other)
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
        except OSError as error:
            without_a_cache(error)
    module = ModuleType(full)
    sys.modules[full] = module
    with caches_of(NotKept):
        exec(compile(source, f"<{name}>", "exec"), vars(module))
    link_inner_ones(module)
    return module


def _kept(path: Path, source: str, full: str) -> ModuleType:
    if not path.exists() or path.read_text(encoding="utf-8") != source:
        _write(path, source)
    spec = importlib.util.spec_from_file_location(full, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[full] = module
    with caches_of(Kept):
        spec.loader.exec_module(module)
    link_inner_ones(module)
    return module


def _write(path: Path, source: str) -> None:
    handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".tmp")
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as stream:
            stream.write(source)
        os.replace(temporary, path)
    except OSError:
        os.unlink(temporary)
        raise
