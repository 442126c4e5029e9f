"""Versions and processor that numbers depend on: what unlike ones computed is never mixed."""

from __future__ import annotations

import hashlib
import platform
from functools import cache
from importlib.metadata import version
from pathlib import Path

import trunnion
from trunnion._version import __version__

OTHERS = ("numpy", "scipy", "numba")


def computed_by() -> dict[str, str]:
    """The package with a word for its sources, what it stands on, and the type of processor."""
    others = {name: version(name) for name in OTHERS}
    return {"trunnion": __version__, "sources": package_digest(), **others, "machine": platform.machine()}


@cache
def package_digest() -> str:
    """A word for every module of the package."""
    root, hashed = Path(trunnion.__file__).parent, hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        hashed.update(path.relative_to(root).as_posix().encode())
        hashed.update(path.read_bytes())
    return hashed.hexdigest()[:16]


def differing(theirs: dict[str, str]) -> str:
    """In what others differ from here, "" where in nothing."""
    ours = computed_by()
    return "; ".join(f"{k} {theirs.get(k)}, here {ours[k]}" for k in ours if theirs.get(k) != ours[k])
