"""Machine code that came with the installation, for where the user's cache has none yet.

A wheel may carry what compiled functions become on a processor that nearly all have (``hatch_build.py`` makes such a
wheel). It is used where sources, Python, numba, platform and processor fit; where anything does not, or nothing came
along, functions are compiled as ever. Nothing is written to it but while a wheel is built.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import platform
from functools import cache
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
import numpy as np
from numba.core import compiler, serialize
from numba.core.dispatcher import Dispatcher

from trunnion.numerics.kept_code import unpacked, write
from trunnion.numerics.sources import SOURCES, digest_of

# Neither numba nor llvmlite states the types of these.
COMPILED: Any = compiler.CompileResult
DUMPS: Any = serialize.dumps

CAME_ALONG = SOURCES.parent / "kernels"
"""Where an installation has the machine code of its wheel."""
BUILD = "TRUNNION_SHIP_KERNELS"
"""Environment variable: the folder in which machine code is gathered while a wheel is built."""
PLAIN = {"x86_64": "x86-64-v3", "AMD64": "x86-64-v3"}.get(platform.machine(), "generic")
"""The processor, as LLVM names it, that a wheel's machine code is compiled for."""
NEEDED = {"x86-64-v3": ("avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe")}.get(PLAIN, ())
CONSTANTS = (bool, int, float, complex, str, bytes, type(None), np.ndarray, np.generic)


@cache
def shipped_folder() -> Path | None:
    """The folder of machine code that fits this process; None where there is none, or the processor can do less."""
    building = os.environ.get(BUILD)
    folder = (Path(building) if building else CAME_ALONG) / f"{PLAIN}-{digest_of(SOURCES)}"
    if building:
        folder.mkdir(parents=True, exist_ok=True)
    host = llvm.get_host_cpu_features() if folder.is_dir() else {}
    return folder if folder.is_dir() and all(host.get(feature) for feature in NEEDED) else None


def in_use() -> bool:
    """Whether machine code came along and fits this process."""
    return not os.environ.get(BUILD) and shipped_folder() is not None


def load(function: Any, signature: Any, context: Any) -> Any:
    """The machine code that came along of a compiled function for a signature, or None."""
    folder = shipped_folder()
    if folder is None or not in_use():
        return None
    name = _name(function, signature)
    if name is None:
        return None
    try:
        code = unpacked((folder / name).read_bytes())
        context.refresh()  # what the code is bound to is known only then
        return None if code is None else COMPILED._rebuild(context, *pickle.loads(code.content))
    except Exception:  # it is not there, or does not come back: it is compiled
        return None


def keep(function: Any, signature: Any, compiled: Any) -> None:
    """Add machine code to the wheel that is being built, if one is."""
    folder = shipped_folder() if os.environ.get(BUILD) else None
    name = _name(function, signature) if folder is not None else None
    if folder is None or name is None or compiled.library.has_dynamic_globals or compiled.lifted:
        return
    write(folder / name, f"{function.__module__}.{function.__qualname__}", PLAIN, DUMPS(compiled._reduce()))


def _name(function: Any, signature: Any) -> str | None:
    """The file of a function's machine code for a signature; None where it closes over more than constants and
    functions."""
    known = _identity(function)
    return None if known is None else hashlib.sha256(f"{known} {signature}".encode()).hexdigest()[:32] + ".kernel"


def _identity(plain: Any) -> str | None:
    """A function and what it closes over, the same wherever it is installed."""
    words = [plain.__module__, plain.__qualname__, plain.__code__.co_firstlineno]
    words.append(hashlib.sha256(plain.__code__.co_code).hexdigest())
    for cell in plain.__closure__ or ():
        value = cell.cell_contents
        if isinstance(value, Dispatcher):
            words.append(_identity(value.py_func))
        elif isinstance(value, CONSTANTS):
            words.append(hashlib.sha256(pickle.dumps(value, 4)).hexdigest())
        else:
            words.append(None)
    return None if None in words else "(" + " ".join(map(str, words)) + ")"
