"""Damping that goes with the depth of contact: D_MI of Rezaee and Farshidianfar (1), after Hunt and Crossley (1975).

The mesh pushes with k δ + c u′ + d δ u′ at depth δ behind its backlash. Against equations written out here with an
integrator of scipy, against the closed form of a free impact, and against the balance of energy.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import trunnion as tn
from trunnion.errors import InputError

R1, R2, K, HALF = 0.04, 0.06, 2e6, 5e-5
J1, J2 = 0.02, 0.05
SHAFT, LOSS, LOAD, PUSH = 3e3, 0.5, 6.0, 20.0
SPEED = 80.0


def mesh(impact: float, **more: Any) -> tn.GearPair:
    gears: dict[str, Any] = {"base_radius_in": R1, "base_radius_out": R2, "mesh_stiffness": K, "backlash": 2 * HALF}
    return tn.GearPair(name="mesh", impact_damping=impact, **gears | more)


def line(impact: float, *, push: float = PUSH, load: float = LOAD, **more: Any) -> tn.Driveline:
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=SHAFT, damping=LOSS),
            tn.Disk(inertia=J1, excitation=[{"order": 2, "amplitude": push}]),
            mesh(impact, **more),
            tn.Disk(inertia=J2, load_torque=load),
        ]
    )


def force(u: float, rate: float, impact: float, damping: float) -> float:
    """Along the line of action, damping in contact only."""
    depth = max(abs(u) - HALF, 0.0)
    return float(np.sign(u) * K * depth + (damping * (depth > 0) + impact * depth) * rate)


def written_out(times: np.ndarray, start: np.ndarray, impact: float, damping: float) -> np.ndarray:
    """φ₁, φ₂ and their rates (time, 4), as deviations from uniform rotation."""

    def rates(t: float, y: np.ndarray) -> list[float]:
        a, b, va, vb = y
        pushed = force(R1 * a - R2 * b, R1 * va - R2 * vb, impact, damping)
        torque = PUSH * np.cos(2 * (SPEED * t + a))
        return [va, vb, (torque - SHAFT * a - LOSS * va - R1 * pushed) / J1, (R2 * pushed - LOAD) / J2]

    ends = (0.0, float(times[-1]))
    return solve_ivp(rates, ends, start, t_eval=times, method="DOP853", rtol=1e-11, atol=1e-14, max_step=2e-5).y.T


@pytest.mark.parametrize(("impact", "damping"), [(4e7, 0.0), (4e8, 300.0), (2e9, 0.0)])
def test_motion_is_that_of_the_equations(impact: float, damping: float) -> None:
    times = np.linspace(0.0, 0.1, 101)
    run = tn.simulate(
        line(impact, mesh_damping=damping, damping_law="in contact"), times=times, speed=SPEED, tolerance=1e-11
    )
    truth = written_out(times, np.zeros(4), impact, damping)
    assert run.outcome.ok and len(run.event_time) >= 4
    spring = 1
    twist = truth[:, 1] - truth[:, 0] * R1 / R2
    assert run.twist[:, spring] == pytest.approx(twist, abs=2e-7 * np.ptp(twist))
    u, rate = truth[:, 0] * R1 - truth[:, 1] * R2, truth[:, 2] * R1 - truth[:, 3] * R2
    torque = np.array([-R2 * force(*pair, impact, damping) for pair in zip(u, rate, strict=True)])
    assert run.torque[:, spring] == pytest.approx(torque, abs=2e-5 * np.ptp(torque))
    plain = tn.simulate(line(0.0, mesh_damping=damping, damping_law="in contact"), times=times, speed=SPEED)
    assert np.abs(plain.twist[:, spring] - twist).max() > 1e-3 * np.ptp(twist)  # it matters here


@pytest.mark.parametrize(("impact", "speed"), [(1e8, 0.05), (2e8, 0.2), (1e9, 0.05)])
def test_a_free_impact_gives_back_what_the_closed_form_says(impact: float, speed: float) -> None:
    """m δ″ = −kδ − dδδ′ has the integral v/d − (k/d²) ln(k + dv) + δ²/2m, so the speed of parting is known; it is
    below k/d, where teeth would pull. What is lost is ∫ d δ v² dt."""
    mass = J1 * J2 / (J1 * R2**2 + J2 * R1**2)

    def carried(v: float) -> float:
        return v / impact - K / impact**2 * np.log1p(impact * v / K)

    parting = -brentq(lambda v: carried(-v) - carried(speed), 1e-9, min(K / impact * (1 - 1e-12), speed), xtol=1e-15)
    subject = tn.Driveline([tn.Disk(inertia=J1), mesh(impact), tn.Disk(inertia=J2)])
    # Relative motion alone: u′ = R1 v₁ − R2 v₂ with no momentum along J₁v₁/R1 + J₂v₂/R2.
    first, second = mass * speed * R1 / J1, -mass * speed * R2 / J2
    free = HALF / speed
    contact = np.pi * np.sqrt(mass / K)
    begin: dict[str, Any] = {"speed": 10.0, "start": [0.0, 0.0, first, second], "tolerance": 1e-11}
    landed, parted = tn.simulate(subject, free + 3 * contact, **begin).event_time[:2]
    assert landed == pytest.approx(free, rel=1e-9)
    times = np.linspace(0.0, parted + HALF / speed, 40_001)  # before the other flank
    run = tn.simulate(subject, times=times, **begin)
    u = -R2 * run.twist[:, 0]
    rate = np.gradient(u, times)
    apart = times > parted + 1e-5
    assert apart.any() and rate[apart] == pytest.approx(parting, rel=1e-6)
    assert abs(parting) < K / impact
    depth = np.maximum(np.abs(u) - HALF, 0.0)
    lost = np.trapezoid(impact * depth * rate**2, times)
    assert lost == pytest.approx(mass * (speed**2 - parting**2) / 2, rel=1e-4)
    elastic = K * depth * np.sign(u) + impact * depth * rate
    assert elastic.min() > -1e-6 * elastic.max()  # never pulls


def test_a_periodic_motion_closes_in_the_equations() -> None:
    impact = 4e8
    found = tn.periodic_response(line(impact, mesh_damping=400.0, damping_law="in contact"), SPEED, compare=False)
    assert found.outcome.ok and found.contacts[0].rattles
    start = found.orbit.start
    after = written_out(np.array([0.0, np.pi / SPEED]), start, impact, 400.0)[-1]
    assert after == pytest.approx(start, abs=1e-6 * np.abs(start).max())


@pytest.mark.parametrize("load", [6.0, -6.0])
def test_linear_equations_take_the_depth_under_load(load: float) -> None:
    """Damping d δ₀ along the line of action, δ₀ = |load|/(R2 k), whichever flank carries."""
    impact = 4e6
    damping = impact * abs(load) / (R2 * K)
    same = tn.natural_frequencies(line(0.0, load=load, mesh_damping=damping))
    found = tn.natural_frequencies(line(impact, load=load))
    assert found.damping_ratio == pytest.approx(same.damping_ratio, rel=1e-9)
    assert tn.natural_frequencies(line(0.0, load=load)).damping_ratio[-1] < 0.5 * found.damping_ratio[-1]
    radius = [tn.stability(one, SPEED).spectral_radius for one in (line(impact, load=load), line(0.0, load=load,
        mesh_damping=damping))]  # fmt: skip
    assert radius[0] == pytest.approx(radius[1], rel=1e-12)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: mesh(-1.0), "must not be negative"),
        (lambda: mesh(1e8, backlash=0.0), "needs a backlash"),
        (lambda: mesh(1e8, damping_law="never pulling"), "does not go with"),
    ],
)
def test_refused(make, words: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError, match=words) as caught:
        make()
    assert caught.value.key == "impact_damping" and caught.value.remedy


def test_exact_motions_are_refused_and_files_keep_it() -> None:
    subject = line(4e8)
    for analysis in (tn.exact_motion, tn.piecewise_orbit):
        with pytest.raises(InputError, match="depth of contact"):
            analysis(subject, speed=SPEED) if analysis is tn.piecewise_orbit else analysis(subject, 0.1, speed=SPEED)
    assert tn.loads(tn.dumps(subject)) == subject and "impact_damping = " in tn.dumps(subject)
    packed = tn.pack(subject)
    assert packed.units[packed.labels.index("mesh.impact_damping")] == "N*s/m^2"
