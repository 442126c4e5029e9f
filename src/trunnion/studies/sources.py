"""A word for the code that computes: two of them never write into one store."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

import trunnion


@cache
def package_digest() -> str:
    """Of every module of the package."""
    root, hashed = Path(trunnion.__file__).parent, hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        hashed.update(path.relative_to(root).as_posix().encode())
        hashed.update(path.read_bytes())
    return hashed.hexdigest()[:16]
