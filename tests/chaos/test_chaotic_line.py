"""Chaos in a shaft driven through a Hooke's joint: by the package's line, and by its equation written down anew.

Asokanthan and Meehan (J. Sound Vib. 233, 2000, 297–310) report chaos of this system.
"""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.systems.system import System

SPEED = 0.65
ANGLE, DAMPING, LOAD = np.pi / 4, 0.004, 1.0


def line(angle: float = ANGLE, quadratic: float = 0.0, load: float = LOAD) -> tn.Driveline:
    """Constant speed, shaft with k = 1, joint, disk with J = 1."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1.0, damping=DAMPING),
            tn.HookeJoint(angle=angle),
            tn.Disk(inertia=1.0, load_torque=load, quadratic_load=quadratic),
        ]
    )


def equation() -> System:
    """a is the rotation at the joint less Ωt; J η² ä + J η η′ (Ω + ȧ)² = −ka − cȧ − ηT, η = cos β/(1 − sin²β cos²φ)."""

    def rate(t, x, p):  # type: ignore[no-untyped-def]
        a, v = x
        phi = p.speed * t + a
        s2 = np.sin(p.angle) ** 2
        below = 1 - s2 * np.cos(phi) ** 2
        eta = np.cos(p.angle) / below
        slope = -np.cos(p.angle) * s2 * np.sin(2 * phi) / below**2
        torque = -a - p.damping * v - eta * p.load - eta * slope * (p.speed + v) ** 2
        return v, torque / eta**2

    values = {"speed": SPEED, "angle": ANGLE, "damping": DAMPING, "load": LOAD}
    return System.from_function(
        rate, ["a", "v"], parameters=values, period=lambda p: np.pi / p["speed"], start=[0.0, 0.0], name="hooke"
    )


@pytest.mark.slow
def test_a_loaded_hooke_driven_line_is_chaotic() -> None:
    found = tn.certify_chaos(line(), 3000, speed=SPEED, sweep=False)
    assert found.verdict == "chaotic", str(found)
    assert found.spectrum.largest > 0.05
    assert found.zero_one is not None and found.zero_one.k > 0.9
    assert np.abs(found.map.points).max() < 5  # type: ignore[union-attr]


@pytest.mark.slow
def test_its_exponent_does_not_depend_on_who_writes_the_equation() -> None:
    one = tn.lyapunov_spectrum(line(), 2000, speed=SPEED)
    two = tn.lyapunov_spectrum(equation(), 2000, tolerance=1e-9)
    apart = np.abs(one.exponents - two.exponents)
    assert np.all(apart <= 2 * (one.half_width + two.half_width))
    assert two.positive and one.sum_error < 1e-8


@pytest.mark.slow
def test_neighbours_do_part_at_that_rate() -> None:
    """The plainest evidence: two motions 1e-9 apart, no tangents; the mean logarithm of their distance."""
    step = tn.StroboscopicMap(equation(), tolerance=1e-12)
    rng = np.random.default_rng(5)
    x = np.zeros(2)
    for _ in range(100):
        x = step(x)
    growth, count = [], 25
    for _ in range(24):
        y = x + 1e-9 * rng.normal(size=2)
        first = np.linalg.norm(y - x)
        for _ in range(count):
            x, y = step(x), step(y)
        growth.append(np.log(np.linalg.norm(y - x) / first))
    rate = np.mean(growth) / (count * np.pi / SPEED)
    assert rate == pytest.approx(0.0622, abs=0.02)


@pytest.mark.parametrize(
    ("angle", "speed"),
    [
        (0.3, 0.65),
        pytest.param(np.pi / 4, 0.2, marks=pytest.mark.slow),
        pytest.param(0.0, 0.65, marks=pytest.mark.slow),
    ],
)
def test_the_same_line_elsewhere_is_regular(angle: float, speed: float) -> None:
    found = tn.certify_chaos(line(angle), 3000, speed=speed, transient=2000, sweep=False)
    assert (found.verdict, found.kind) == ("regular", "periodic"), str(found)


@pytest.mark.slow
def test_quadratic_damping_and_load() -> None:
    found = tn.certify_chaos(line(0.9, 0.01, 0.5), 3000, speed=0.7127, sweep=False)
    assert found.verdict == "chaotic" and found.spectrum.largest > 0.05
