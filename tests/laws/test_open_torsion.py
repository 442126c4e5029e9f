"""A free chain with engine orders in openTorsion."""

from __future__ import annotations

import numpy as np
import opentorsion as ot
import pytest

import trunnion as tn


def test_the_same_chain_in_open_torsion() -> None:
    rng = np.random.default_rng(1)
    inertia, k, c = rng.uniform(0.05, 0.3, 9), rng.uniform(1e5, 1e6, 8), rng.uniform(5, 30, 8)
    orders = np.arange(1, 13) / 2
    size, phase = rng.uniform(10, 100, (3, 12)), rng.uniform(-3, 3, (3, 12))
    shaken = [
        [{"order": o, "amplitude": a, "phase": p} for o, a, p in zip(orders, size[i], phase[i], strict=True)]
        for i in range(3)
    ] + [[] for _ in range(6)]
    elements: list[tn.Disk | tn.Shaft] = [tn.Disk(inertia=inertia[0], excitation=shaken[0])]
    for i in range(8):
        elements += [tn.Shaft(stiffness=k[i], damping=c[i]), tn.Disk(inertia=inertia[i + 1], excitation=shaken[i + 1])]
    found = tn.order_response(tn.Driveline(elements), [40.0, 130.0])
    other = ot.Assembly(
        [ot.Shaft(i, i + 1, k=k[i], c=c[i]) for i in range(8)],
        disk_elements=[ot.Disk(i, I=value) for i, value in enumerate(inertia)],
    )
    for s, speed in enumerate(found.speed):
        v = orders * speed
        forces = ot.PeriodicExcitation(9, v)
        for i in range(3):
            forces.add_sines(i, v, size[i], phase[i])
        q = np.diff(other.ss_response(forces.U, v)[0], axis=0)
        torque = ((k[:, None] + 1j * c[:, None] * v) * q).T
        assert found.torque[s] == pytest.approx(torque, rel=1e-9, abs=1e-9 * np.abs(torque).max())
