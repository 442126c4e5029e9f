"""Random long lines, and their forced motion from the matrices of a whole period."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

import trunnion as tn
from trunnion.equations.coefficients import Assembly
from trunnion.equations.linear import line_matrices
from trunnion.numerics.chain.dense_monodromy import propagate

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
STEEPEST = 0.6
"""Angle of a joint [rad], at most."""
ORDER = 2
"""Of the torque that shakes each line: whole orders close with the joints."""


def random_tree(seed: int, least: int = 20, most: int = 120, *, driven: bool = False) -> tn.Driveline:
    """A line, ``driven`` or else either driven or free, of ``least`` to ``most`` inertias on up to four branches, with
    gears, a mesh that varies, angled joints, and damping of 0.1 % to 5 %; one disk is shaken.

    A free one has loss factors in place of dampers, as its response has a motion of rigid shafts for a base then.
    """
    rng = np.random.default_rng(seed)
    count, free = int(rng.integers(least, most + 1)), bool(rng.random() < 0.3) and not driven
    ratio = 10 ** float(rng.uniform(-3, np.log10(0.05)))
    unit = float(rng.uniform(5e4, 5e5))
    bends = set(rng.choice(np.arange(2, count - 1), size=int(rng.integers(1, 4)), replace=False).tolist())
    gears = set(rng.choice(np.arange(1, count - 1), size=int(rng.integers(0, 3)), replace=False).tolist())
    mesh = int(rng.integers(1, count - 1)) if rng.random() < 0.4 else -1
    elements: list[Any] = [] if free else [tn.ConstantSpeed(name="drive")]
    shaken = int(rng.integers(1, min(bends) + 1))  # in front of all joints, where rotation is even
    branches = set(rng.choice(np.arange(4, count), size=int(rng.integers(0, 4)), replace=False).tolist())

    def stretch(after: str | None) -> Any:
        k = unit * 10 ** float(rng.uniform(-0.5, 0.5))
        if free:
            return tn.Shaft(stiffness=k, loss_factor=2 * ratio, after=after)
        return tn.Shaft(stiffness=k, damping=2 * ratio * k / np.sqrt(k / 0.1), after=after)

    for i in range(count):
        after = f"disk {int(rng.integers(0, i - 1))}" if i in branches else None
        if i == mesh and not after:
            teeth = {"teeth_in": 3, "teeth_out": 3, "module": 0.03}
            wave = [{"share": float(rng.uniform(0.05, 0.3)), "order": 1, "phase": float(rng.uniform(-3, 3))}]
            elements.append(tn.GearPair(**teeth, mesh_stiffness=5e7, mesh_damping=20.0, stiffness_variation=wave))
        elif i or not free:
            elements.append(stretch(after))
        torque = [{"order": ORDER, "amplitude": 40.0, "phase": 0.3}] if i == shaken else []
        elements.append(tn.Disk(inertia=0.1 * 10 ** float(rng.uniform(-0.4, 0.4)), excitation=torque, name=f"disk {i}"))
        if i in bends and i + 1 < count and i + 1 not in branches:
            elements.append(tn.HookeJoint(angle=float(rng.uniform(0.1, STEEPEST)), plane=float(rng.uniform(-3, 3))))
        if i in gears and i + 1 < count and i + 1 not in branches:
            elements.append(tn.Ratio(ratio=[2.0, -1.0, 0.5, -2.0][int(rng.integers(4))]))
    return tn.Driveline(elements)


def with_rings(line: tn.Driveline, mean: Sequence[Any], seed: int, least: int = 5) -> tn.Driveline:
    """A driven ``line`` with one to three shafts more, between disks of the same ``mean`` speed (disk,) at least so
    many apart."""
    rng, elements = np.random.default_rng(seed), list(line.elements)
    pairs = [(i, j) for j in range(len(mean)) for i in range(j - least) if mean[i] == mean[j]]
    for i, j in rng.permutation(pairs)[: int(rng.integers(1, 4))].tolist():
        k = 2e5 * 10 ** float(rng.uniform(-1, 0.5))
        elements.append(tn.Shaft(stiffness=k, damping=1e-4 * k, after=f"disk {i}", to=f"disk {j}"))
    return tn.Driveline(elements)


def forced_motion(
    assembly: Assembly, speed: float, turns: float, rate: float, force: Complex, tolerance: float = 1e-11
) -> tuple[Array, Array, float]:
    """Deviations x (time, n) [rad] of the steady motion over ``turns`` and their input angles (time,) [rad]: equations
    of ``line_matrices`` and torques ``force`` (n,) e^{i rate τ} carried over the whole period; and how far the
    propagator may be off, over the nearest multiplier's distance from 1."""
    topo = assembly.topology
    co = assembly.coefficients(assembly.table(1, speed), any_frequency=True)

    def parts(tau: Array) -> tuple[Array, Array, Array, Array]:
        m = line_matrices(topo, co, tau)
        acting = m.forcing[0] + (np.exp(1j * rate * tau)[:, None] * force).real
        return m.mass[0], m.damping[0] / speed, m.stiffness[0] / speed**2, acting / speed**2

    period = 2 * np.pi * turns
    run = propagate(parts, period, topo.size, tolerance, 64)
    start = np.linalg.solve(np.eye(2 * topo.size) - run.monodromy, run.particular)
    states = run.states(start, run.steps)
    near = np.abs(1 - np.linalg.eigvals(run.monodromy)).min()
    return states[:, : topo.size], period * np.arange(len(states)) / (len(states) - 1), float(run.error / near)
