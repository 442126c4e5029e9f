"""What machine code is made from: sources of kernels and the versions that compile them."""

from __future__ import annotations

import hashlib
import platform
import sys
from functools import cache
from pathlib import Path

import llvmlite
import numba
import numpy as np

SOURCES = Path(__file__).parent
"""The folder below which all functions stand that the package's ``njit`` decorates."""
VERSIONS = (
    f"numba {numba.__version__}, llvmlite {llvmlite.__version__}, numpy {np.__version__}, "
    f"{sys.implementation.cache_tag}, {sys.platform} {platform.machine()}"
)


@cache
def digest_of(folder: Path) -> str:
    """A word for the sources below ``folder`` and for the versions that compile them."""
    hashed = hashlib.sha256(VERSIONS.encode())
    for path in sorted(folder.rglob("*.py")):
        hashed.update(path.relative_to(folder).as_posix().encode())
        hashed.update(path.read_bytes())
    return hashed.hexdigest()[:16]
