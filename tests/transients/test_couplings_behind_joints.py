"""A coupling behind a bent joint, a gear that reverses or not, a lagging motor and a load that friction keeps at rest:
against equations written by hand in absolute angles."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import trunnion as tn

UNTIL, SYNCHRONOUS, SLIP, SQUARE = 0.4, 120.0, 0.2, 1e-3


@pytest.mark.parametrize(("seed", "ratio"), [(1, -2.0), (2, 3.0), (3, 1.7)])
def test_a_start_through_a_joint_a_coupling_and_a_gear(seed: int, ratio: float) -> None:
    rng = np.random.default_rng(seed)
    inertia, stiffness, damping = rng.uniform(0.3, 2, 3), rng.uniform(3e3, 2e4, 2), rng.uniform(2, 15, 2)
    angle, corner, breakdown, rubs = (float(rng.uniform(*one)) for one in ((0.1, 0.5), (10, 200), (100, 300), (1, 6)))
    line = tn.Driveline(
        [
            tn.Disk(name="motor", inertia=float(inertia[0])),
            tn.HookeJoint(angle=angle),
            tn.Coupling(stiffness=float(stiffness[0]), damping=float(damping[0])),
            tn.Disk(name="middle", inertia=float(inertia[1])),
            tn.Ratio(ratio=ratio),
            tn.Shaft(stiffness=float(stiffness[1]), damping=float(damping[1])),
            tn.Disk(name="end", inertia=float(inertia[2]), quadratic_load=SQUARE),
        ]
    )
    motor = tn.AppliedTorque(
        on="motor", breakdown_torque=breakdown, breakdown_slip=SLIP, synchronous_speed=SYNCHRONOUS,
        corner_frequency=corner,
    )  # fmt: skip
    friction = [tn.FrictionTorque(on="end", torque=rubs)]
    run = tn.transient(line, UNTIL, torque=[motor], friction=friction, speed=0.0, tolerance=1e-11)
    cosine, square = np.cos(angle), np.sin(angle) ** 2

    def far(x: np.ndarray) -> float:
        return float(stiffness[1] * (x[2] - x[1] / ratio) + damping[1] * (x[5] - x[4] / ratio))

    def rates(t: float, x: np.ndarray, sense: float) -> list[float]:
        s, c = np.sin(x[0]), np.cos(x[0])
        behind = x[0] + np.arctan2(s * c * (1 - cosine), cosine * c * c + s * s)
        passes = cosine / (1 - square * c * c)
        near = stiffness[0] * (x[1] - behind) + damping[0] * (x[4] - passes * x[3])
        slip, last = 1 - x[3] / SYNCHRONOUS, -far(x) - sense * rubs - SQUARE * abs(x[5]) * x[5]
        kloss = 2 * breakdown * slip * SLIP / (slip**2 + SLIP**2)
        gained = [(x[6] + passes * near) / inertia[0], (far(x) / ratio - near) / inertia[1]]
        return [x[3], x[4], x[5], *gained, last / inertia[2] if sense else 0.0, corner * (kloss - x[6])]

    parts: list[tuple[float, Any]] = []
    x, t, sense = np.zeros(7), 0.0, 0.0
    while t < UNTIL:
        begun = t

        def switches(now: float, y: np.ndarray, sense: float, begun: float = begun) -> float:
            return y[5] * sense + (1e-13 if now == begun else 0.0) if sense else rubs - abs(far(y))

        switches.terminal, switches.direction = True, -1  # type: ignore[attr-defined]
        part = solve_ivp(
            rates, (t, UNTIL), x, "DOP853", rtol=1e-12, atol=1e-12, args=(sense,), events=switches, dense_output=True,
            max_step=1e-3,
        )  # fmt: skip
        parts.append((t, part))
        t, x = part.t[-1], part.y[:, -1].copy()
        if part.status == 1 and sense:
            x[5] = 0.0
            sense = 0.0 if abs(far(x)) <= rubs else -np.sign(far(x))
        elif part.status == 1:
            sense = -np.sign(far(x))
    times = np.linspace(0.02, UNTIL, 12)
    known = np.array([[part for begun, part in parts if begun <= t][-1].sol(t) for t in times])
    found = run.at(times)
    assert run.outcome.kind == "reached" and run.energy.error < 1e-9
    np.testing.assert_allclose(found.speed[:, run._stations], known[:, 3:6], atol=1e-8)
    np.testing.assert_allclose(found.applied[:, run._stations[0]], known[:, 6], atol=1e-6)
