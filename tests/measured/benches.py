"""Random lines on a synthetic bench, and what is free of them."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

import trunnion as tn


def random_line(rng: np.random.Generator) -> tn.Driveline:
    """A joint, two shafts and two disks, one of them excited by order; resonances of orders 1 and 2 within the run."""
    inertia = rng.uniform(0.2, 0.6)
    first = rng.uniform(180.0, 260.0)  # frequency of the front shaft and disk alone [rad/s]
    stiffness = inertia * first**2
    rear = rng.uniform(1.0, 2.5) * stiffness
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.HookeJoint(angle=float(np.deg2rad(rng.uniform(4.0, 14.0))), name="joint"),
            tn.Shaft(stiffness=stiffness, damping=rng.uniform(0.03, 0.08) * 2 * stiffness / first, name="tube"),
            tn.Disk(inertia=inertia, name="hub", excitation=[{"order": 1, "amplitude": rng.uniform(20.0, 60.0)}]),
            tn.Shaft(stiffness=rear, damping=0.06 * 2 * rear / 400.0, name="rear"),
            tn.Disk(inertia=rng.uniform(0.05, 0.15), name="out"),
        ]
    )


def guess(rng: np.random.Generator, line: tn.Driveline) -> tuple[tn.Driveline, dict[str, tuple[float, float]]]:
    """The line as it may be thought to be, off by a fifth and more, and bounds of what is free."""
    tube, joint = part(line, "tube"), part(line, "joint")
    stiffness, damping = tube.torsional_stiffness * rng.uniform(0.8, 1.25), tube.damping * rng.uniform(0.5, 2.0)
    angle = float(np.clip(joint.angle * rng.uniform(0.6, 1.5), 0.02, 0.34))
    free = {
        "joint.angle": (0.005, 0.35),
        "tube.stiffness": (tube.torsional_stiffness / 1.7, tube.torsional_stiffness * 1.7),
        "tube.damping": (tube.damping / 5, tube.damping * 5),
    }
    return line.replace_all({"tube": {"stiffness": stiffness, "damping": damping}, "joint": {"angle": angle}}), free


def recorded(line: tn.Driveline, seed: int, *, jitter: float = 2e-6, calibrated: bool = True) -> object:
    """Orders 1 and 2 of a run-up at three wheels with 2 % of pitch error, and a reference run where it is asked for."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        wheels = {"input": 36, "hub": 36, "out": 36}
        bench = {"jitter": jitter, "pitch_error": 0.02, "wheels": seed}
        run = tn.measure(line, (70.0, 300.0), 20.0, wheels, seed=2 * seed, **bench)
        if not calibrated:
            return tn.track_orders(run, [1, 2], line=line, reference="input", window=4)
        straight = line.replace_all({"joint": {"angle": 0.0}, "hub": {"excitation": []}})
        still = tn.measure(straight, 120.0, 10.0, wheels, seed=2 * seed + 1, **bench)
        return tn.track_orders(run, [1, 2], line=line, reference="input", calibration=tn.pitch_errors(still), window=4)


def part(line: tn.Driveline, name: str) -> Any:
    """The element of a name."""
    return line.elements[line.names.index(name)]
