"""Writes docs/data/beside.json: other programs and this one on the same lines, one after the other on one machine.

Programs whose requirements clash stand in an environment of their own, whose Python is given:
    python3 -m venv others && others/bin/pip install ross-rotordynamics "plotly<6" exudyn heyoka opentorsion
    PYTHONPATH=src python docs/data/beside.py others/bin/python
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

import trunnion as tn

HERE = Path(__file__).parent
DATA = HERE / "beside.json"
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}


def theirs(python: str, program: str, case: dict[str, Any]) -> dict[str, Any]:
    """What a program in ``programs`` prints."""
    command = [python, str(HERE / "programs" / f"{program}.py"), json.dumps(case)]
    done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, **ONE_THREAD}, check=False)
    if done.returncode:
        raise SystemExit(f"{program} failed:\n{done.stderr[-2000:]}")
    found: dict[str, Any] = json.loads(done.stdout.strip().splitlines()[-1])
    return found


def timed(compute: Callable[[], Any]) -> tuple[Any, float]:
    """The second of two runs."""
    compute()
    begin = time.perf_counter()
    found = compute()
    return found, time.perf_counter() - begin


def chain_case() -> dict[str, Any]:
    """Nine disks between steel bars."""
    rng = np.random.default_rng(7)
    return {
        "inertias": rng.uniform(0.05, 0.5, 9).tolist(),
        "lengths": rng.uniform(0.2, 1.5, 8).tolist(),
        "diameters": rng.uniform(0.04, 0.1, 8).tolist(),
        "shear_modulus": 79.3e9,
    }


def chain(case: dict[str, Any]) -> np.ndarray:
    """Its natural frequencies here [Hz]."""
    elements: list[Any] = [tn.Disk(inertia=case["inertias"][0])]
    for length, diameter, inertia in zip(case["lengths"], case["diameters"], case["inertias"][1:], strict=True):
        bar = tn.Shaft(outer_diameter=diameter, length=length, shear_modulus=case["shear_modulus"])
        elements += [bar, tn.Disk(inertia=inertia)]
    return tn.natural_frequencies(tn.Driveline(elements)).hertz[1:]


def joint(case: dict[str, Any]) -> np.ndarray:
    """Output over input speed over a turn, the fork in the joint plane at the start."""
    line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=case["angle"]), tn.Disk(inertia=1.0)])
    speed = tn.kinetostatics(line, speed=1.0).output_speed
    at = np.linspace(0.0, 2 * np.pi, case["steps"] + 1)
    return np.interp(at, np.linspace(0, 2 * np.pi, len(speed) + 1), np.append(speed, speed[0]))


def line_case() -> dict[str, Any]:
    """The two-shaft line at 30° near its sum resonance."""
    return {
        "stiffness": [1.0, 1.0], "damping": [0.002, 0.002], "inertia": [1.0, 1.0], "speed": 1.1,
        "angle": float(np.radians(30)), "duration": 200.0, "points": 401,
    }  # fmt: skip


def motion(case: dict[str, Any]) -> np.ndarray:
    """Deviations of both disks from uniform rotation."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=case["stiffness"][0], damping=case["damping"][0], fork_offset="90 deg"),
            tn.Disk(inertia=case["inertia"][0]),
            tn.HookeJoint(angle=case["angle"]),
            tn.Shaft(stiffness=case["stiffness"][1], damping=case["damping"][1]),
            tn.Disk(inertia=case["inertia"][1]),
        ]
    )
    times = np.linspace(0.0, case["duration"], case["points"])
    run = tn.simulate(line, speed=case["speed"], times=times, start=np.zeros(4), tolerance=1e-12)
    return np.asarray(run.state)[:, :2]


def main(python: str) -> None:
    """Every case with every program."""
    versions = {"Trunnion": tn.__version__}
    cases = []

    def add(
        question: str, program: str, name: str, case: dict[str, Any], ours: Callable[[Any], Any], relative: bool
    ) -> None:
        other = theirs(python, name, case)
        found, seconds = timed(lambda: ours(case))
        off = np.abs(np.asarray(other["values"]) - found)
        largest = float((off / np.abs(found)).max() if relative else off.max())
        versions[program] = other["version"]
        cases.append(
            {
                "question": question, "program": program, "case": name, "value": largest,
                "difference": f"{largest:.1e}" + (" of each" if relative else ""),
                "their_seconds": other["seconds"], "our_seconds": seconds,
            }
        )  # fmt: skip

    frequencies = "natural frequencies of nine disks on steel bars"
    add(frequencies, "openTorsion", "chain_in_opentorsion", chain_case(), chain, True)
    add(frequencies, "ROSS", "chain_in_ross", chain_case(), chain, True)
    bent = {"angle": float(np.radians(30)), "steps": 3600}
    add(
        "speed ratio of a Hooke's joint of 30° over a turn, bodies in space",
        "Exudyn",
        "joint_in_exudyn",
        bent,
        joint,
        False,
    )
    add(
        "rotations [rad] of two shafts and a joint over 200 units of time",
        "heyoka",
        "line_in_heyoka",
        line_case(),
        motion,
        False,
    )
    found = {"on": datetime.now(UTC).date().isoformat(), "versions": versions, "cases": cases}
    part = DATA.with_name(DATA.name + ".part")
    part.write_text(json.dumps(found, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    part.replace(DATA)


if __name__ == "__main__":
    main(sys.argv[1])
