"""Studies that several tests run, and what a store holds as bytes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import trunnion as tn

BATCH = ["growth_rate", "verdict"]
"""Quantities that the compiled batch gives."""
CALLS = ["growth_rate", "verdict", "liouville_defect"]
"""With one that it does not, so that every point is a call."""


def line(**second: Any) -> tn.Driveline:
    """Two shafts with a joint between, unstable in places."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1.0, damping=0.01),
            tn.Disk(inertia=1.0),
            tn.HookeJoint(angle=0.2),
            tn.Shaft(stiffness=1.0, damping=0.01),
            tn.Disk(inertia=1.0, **second),
        ]
    )


def grid(angles: int = 5, speeds: int = 8) -> list[dict[str, Any]]:
    """A grid of joint angle and speed."""
    return [
        {"path": "HookeJoint 1.angle", "low": "2 deg", "high": "40 deg", "points": angles},
        {"path": "speed", "low": 0.4, "high": 2.0, "points": speeds},
    ]


def stated(store: Path, quantities: list[str] = BATCH, **more: Any) -> dict[str, Any]:
    """A study of that line."""
    study = {"line": "", "analysis": "stability", "quantities": quantities, "store": str(store), "parameter": grid()}
    return {**study, **more}


def data_of(store: Path) -> dict[str, bytes]:
    """The arrays of a store, file by file, and what its notes say but the time that was taken."""
    found = {}
    for path in sorted(store.rglob("*")):
        name = path.relative_to(store).as_posix()
        if path.is_file() and "/c/" in name:
            found[name] = path.read_bytes()
        elif path.is_file() and "/shards/" in name:
            note = json.loads(path.read_text())
            found[name] = json.dumps({key: value for key, value in note.items() if key != "seconds"}).encode()
    return found
