"""200 random driven long trees against equations of motion of the tests' own, carried over a period in time."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles.long_tree_equations import LongTree
from oracles.long_trees import random_tree
from oracles.multipliers import matched, multipliers

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.equations.topology import require_period
from trunnion.floquet.propagation import tree_modes
from trunnion.steady.orders.spectrum import order_spectrum

SPEED = 150.0
QUICK = (108, 34)
TREES = 200
CLOSE = (15, 18, 47, 66, 67, 76, 82, 99, 106)
"""Trees some of whose modes nearly coincide."""


def seeds() -> list[Any]:
    """Of every ten one is slow, and those that are close, the others a study."""
    slow = pytest.mark.slow
    marks = [slow if s % 10 == 0 or s in CLOSE else (slow, pytest.mark.study) for s in range(TREES)]
    return [s if s in QUICK else pytest.param(s, marks=marks[s]) for s in range(TREES)]


@pytest.mark.parametrize("seed", seeds())
def test_multipliers_and_responses(seed: int) -> None:
    """The radius and every multiplier within both errors, none missed and none too many; deviations of all disks."""
    line = random_tree(seed, driven=True)
    assembly, own = assemble(line), LongTree(line)
    assert own.turns == require_period(line, assembly.topology)
    motion = own.motion(SPEED)
    found, (true, error) = tn.stability(line, SPEED), multipliers(motion)
    if np.abs(true).min() > 1e-6:  # less is rounding in the matrix
        assert abs(np.linalg.slogdet(motion.propagator)[1] + motion.trace) < 1e-6
    critical = int(np.abs(true).argmax())
    assert abs(np.abs(true[critical]) - found.spectral_radius) <= found.error_estimate + error[critical]
    assert found.error_estimate < 1e-6 and str(found.verdict) == ("stable" if abs(true[critical]) < 1 else "unstable")
    matched(true, error, found.multipliers, found.multiplier_error)
    spectrum = order_spectrum(assembly, np.array([SPEED]))
    wave = spectrum.wave(0, spectrum.amplitude[0], spectrum.mean[0], motion.moment / SPEED)
    ours = wave[:, spectrum.channels.deviation]
    near = np.abs(1 - true).min()
    off = (1e-10 + 10 * motion.error / near) * np.abs(motion.deviation).max()
    assert np.abs(ours - motion.deviation).max() < off


@pytest.mark.parametrize("degrees", [60.0, pytest.param(80.0, marks=pytest.mark.slow)])
def test_a_steep_joint_has_its_states_carried_in_time(degrees: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where blocks of the harmonics that it makes would cost more."""
    elements: list[Any] = [tn.ConstantSpeed()]
    for i in range(18):
        elements += [tn.Shaft(stiffness=1e5 * (2 + np.sin(1.3 * i * i)), damping=4.0), tn.Disk(inertia=0.1)]
        if i == 9:
            elements.append(tn.HookeJoint(angle=np.deg2rad(degrees)))
    line = tn.Driveline(elements)
    monkeypatch.setattr(tree_modes.HillLine, "followed", None)
    found, (true, error) = tn.stability(line, SPEED), multipliers(LongTree(line).motion(SPEED))
    assert abs(np.abs(true).max() - found.spectral_radius) <= found.error_estimate + error[np.abs(true).argmax()]
