"""Trunnion: parametric stability and torsional vibration of jointed drivelines.

    import trunnion as tn
    line = tn.load("truck.toml")
    print(tn.stability(line, speed=tn.rpm(1500)))

Names are imported when first used, so that ``trunnion --help`` and ``import trunnion`` stay light. Their one list is
``__init__.pyi`` beside this file, which type checkers read too.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

from trunnion._version import __version__ as __version__

_LIST = Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")
_HOME = {line.split()[3]: line.split()[1] for line in _LIST.splitlines() if line.startswith("from ")}
"""Public name → the module that it is imported from, by lines "from module import name as name"."""
__all__ = ["__version__", *_HOME]


def __getattr__(name: str) -> Any:
    try:
        home = _HOME[name]
    except KeyError:
        raise AttributeError(f"trunnion has no {name!r}") from None
    value = getattr(import_module(home), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
