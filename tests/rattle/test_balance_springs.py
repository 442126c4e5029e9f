"""Harmonic balance of second-order systems: known folds, the exact piecewise motion, two masses against integration."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from gears import dead_zone, gear_pair
from known_motions import (
    DEAD_ZONE_FOLDS,
    DEAD_ZONE_GRAZING,
    DEAD_ZONE_INNER,
    DEAD_ZONE_PEAK_TO_PEAK,
    DUFFING_FOLDS,
    DUFFING_LOWER,
    DUFFING_UPPER,
)
from scipy.integrate import solve_ivp

import trunnion as tn
from trunnion.errors import InputError
from trunnion.motion.orbits.exact_orbit import piecewise_orbit
from trunnion.motion.orbits.harmonic_balance_springs import SpringBalance, balance_springs
from trunnion.motion.orbits.periodic_branch import piecewise_branch
from trunnion.numerics import harmonics as fourier
from trunnion.results.verdict import Verdict
from trunnion.systems.second_order import SecondOrder, backlash_spring, cubic_spring


def duffing(cubic: float = 0.1, force: float = 0.18, damping: float = 0.05) -> SecondOrder:
    return SecondOrder([[1.0]], [[damping]], [[1.0]], (cubic_spring([1.0], cubic),), [0.0], ((1, [force], [0.0]),))


def at(oscillator: tn.PiecewiseOscillator, start: Any, harmonics: int) -> SpringBalance:
    """The balance beside an exact orbit."""
    orbit = piecewise_orbit(oscillator, start)
    rows = fourier.rows_of(orbit.motion(1024)[1][:, 0][None, :], 40)
    omega = oscillator.frequency
    return balance_springs(
        SecondOrder.of_piecewise(oscillator), omega, omega + 1e-3, start=rows, harmonics=harmonics, longest_step=1.0
    )


@pytest.mark.slow
def test_duffing() -> None:
    found = balance_springs(duffing(), 0.8, 1.6)
    for fold, (frequency, amplitude) in zip(found.branch.folds, DUFFING_FOLDS, strict=True):
        assert fold.parameter == pytest.approx(frequency, abs=6e-8)
        assert fold.amplitude[0] == pytest.approx(amplitude, abs=2e-7)
    whole = balance_springs(duffing(), 1.2, 1.6, begin=1.2)
    up = balance_springs(duffing(), 0.8, 1.2)
    assert whole.branch.amplitude[0, 0] == pytest.approx(DUFFING_LOWER, abs=6e-8)
    assert up.branch.amplitude[-1, 0] == pytest.approx(DUFFING_UPPER, abs=6e-8)
    verdicts = [verdict for _, verdict in found.branch.at(1.2)]
    assert verdicts == [Verdict.STABLE, Verdict.UNSTABLE, Verdict.STABLE]


@pytest.mark.slow
def test_dead_zone() -> None:
    found = balance_springs(SecondOrder.of_piecewise(dead_zone()), 0.4, 1.3, begin=1.3, harmonics=60)
    assert sorted(f.parameter for f in found.branch.folds) == pytest.approx(DEAD_ZONE_FOLDS, abs=6e-6)
    grazing = sorted(p.parameter for p in found.branch.special if p.kind == "grazing")
    assert grazing[-1] == pytest.approx(DEAD_ZONE_GRAZING[1], abs=1e-7)
    inner = at(dead_zone(), DEAD_ZONE_INNER, 100)
    assert inner.branch.peak_to_peak[0, 0] == pytest.approx(DEAD_ZONE_PEAK_TO_PEAK[1], abs=1e-6)
    assert inner.branch.start[0] == pytest.approx(DEAD_ZONE_INNER, abs=2e-6)


@pytest.mark.parametrize("mean_force", [0.0, 0.05])
def test_gear_pair_against_its_exact_branch(mean_force: float) -> None:
    exact = piecewise_branch(gear_pair(mean_force), 0.5, 1.3)
    found = tn.frequency_response(gear_pair(mean_force), 0.5, 1.3, method="harmonic balance")
    folds = sorted(f.parameter for f in exact.folds)
    assert sorted(found.folds()) == pytest.approx(folds, abs=1e-7)
    for start, verdict in exact.at(0.8):
        orbit = piecewise_orbit(gear_pair(mean_force), start)
        point = at(gear_pair(mean_force), orbit.start, 40)
        assert point.branch.verdict[0] == verdict
        assert point.branch.multipliers[0] == pytest.approx(orbit.multipliers, abs=2e-5)
        assert point.branch.peak_to_peak[0, 0] == pytest.approx(orbit.peak_to_peak, abs=2e-5)


def test_rate_of_convergence() -> None:
    """Coefficients of x fall like k⁻⁴, its error like H⁻³; nothing folds back, so the coefficients kept do better."""
    orbit, errors, kept = piecewise_orbit(dead_zone(), DEAD_ZONE_INNER), [], []
    exact = orbit.motion(512)[1][:, 0]
    coefficient = orbit.harmonics(1)[1]
    orders = (10, 20, 40, 100)
    for h in orders:
        found = at(dead_zone(), DEAD_ZONE_INNER, h)
        errors.append(float(np.abs(found.motion(0)[0] - exact).max()))
        row = found.rows[0, 0]
        kept.append(abs(row[1] - 1j * row[h + 1] - coefficient))
    slope = -np.polyfit(np.log(orders), np.log(errors), 1)[0]
    assert 2.6 < slope < 3.5 and errors[-1] < 1e-6
    assert kept[-1] < 1e-8 and kept[-1] < errors[-1] / 10


def two_masses(kind: str) -> SecondOrder:
    spring = cubic_spring([1.0, -1.0], 0.8) if kind == "cubic" else backlash_spring([1.0, -1.0], 0.3, 2.0, 0.25)
    return SecondOrder(
        np.diag([1.0, 0.6]), [[0.06, -0.02], [-0.02, 0.05]], [[1.4, -0.4], [-0.4, 0.9]], (spring,), [0.1, 0.0],
        ((1, [0.3, 0.0], [0.0, 0.1]), (2, [0.0, 0.1], [0.0, 0.0])), names=("left", "right"),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("kind", "harmonics", "near"), [("cubic", 24, 1e-7), pytest.param("backlash", 100, 2e-5, marks=pytest.mark.slow)]
)
def test_two_masses_close_and_have_the_multipliers_of_their_motion(kind: str, harmonics: int, near: float) -> None:
    s = two_masses(kind)
    found = balance_springs(s, 0.7, 0.9, harmonics=harmonics, longest_step=0.1)
    assert found.outcome.ok and found.branch.curves == ("left", "right")
    i = len(found.rows) // 2
    omega, d = float(found.branch.parameter[i]), np.array(s.springs[0].direction)

    def rate(t: float, y: Any) -> Any:
        x, v = y[:2], y[2:]
        force = s.mean + sum(p * np.cos(k * omega * t) + q * np.sin(k * omega * t) for k, p, q in s.harmonics)
        push = d * s.springs[0].force(np.array(d @ x))
        return np.concatenate([v, np.linalg.solve(s.mass, force - s.damping @ v - s.stiffness @ x - push)])

    def turn(y: Any) -> Any:
        return solve_ivp(rate, (0, 2 * np.pi / omega), y, method="DOP853", rtol=1e-10, atol=1e-12, max_step=0.1).y[
            :, -1
        ]

    start = found.branch.start[i]
    assert turn(start) == pytest.approx(start, abs=near)
    h = 1e-5
    phi = np.stack([(turn(start + h * e) - turn(start - h * e)) / (2 * h) for e in np.eye(4)], axis=1)
    expected = np.sort_complex(np.linalg.eigvals(phi))
    assert np.sort_complex(found.branch.multipliers[i]) == pytest.approx(expected, abs=2e-4)
    trace = -float(np.trace(np.linalg.solve(s.mass, s.damping))) * 2 * np.pi / omega
    assert np.prod(found.branch.multipliers[i]).real == pytest.approx(np.exp(trace), rel=1e-9)


def test_subharmonic_branch() -> None:
    """Duffing driven at three times its own frequency, followed from a motion settled in time."""
    system = tn.reference_system("duffing", damping=0.01, force=2.0, frequency=3.6)
    orbit = tn.periodic_response(system, periods=3, start=[2.5, 0.0], settle=False)
    times = orbit.period * np.arange(256) / 256
    rows = fourier.rows_of(orbit.trajectory.at(times)[:, 0][None, :], 12)
    found = balance_springs(
        duffing(force=2.0, damping=0.01), 3.55, 3.65, begin=3.6, start=rows, periods=3, longest_step=0.05
    )
    row, h = found.rows[len(found.rows) // 2, 0], found.harmonics
    assert found.outcome.ok and np.hypot(row[1], row[h + 1]) > np.hypot(row[3], row[h + 3])
    assert found.branch.period[0] == pytest.approx(3 * 2 * np.pi / found.branch.parameter[0])


@pytest.mark.slow
def test_harmonics_by_the_tail() -> None:
    one = balance_springs(duffing(), 0.8, 1.0, tail=1e-2)
    ten = balance_springs(SecondOrder.of_piecewise(gear_pair()), 0.7, 0.9, tail=1e-4, longest_step=0.05)
    assert one.harmonics == 10 and ten.harmonics == 20 and ten.tail.max() < 1e-4
    assert "20 harmonics" in str(ten)


def test_no_motion_is_said() -> None:
    """Undamped, linear, on resonance: unbounded."""
    found = balance_springs(duffing(cubic=0.0, damping=0.0), 1.0, 1.2, harmonics=3)
    assert not found.outcome.ok and "give a start" in found.outcome.sentence
    assert str(found).endswith(str(found.outcome))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (
            lambda: SecondOrder(np.eye(2), np.eye(2), np.eye(3), (), [0.0, 0.0], ((1, 1.0, 0.0),)),
            "must be 2 × 2 finite",
        ),
        (lambda: SecondOrder([[0.0]], [[1.0]], [[1.0]], (), [0.0], ((1, [1.0], [0.0]),)), "mass: is singular"),
        (lambda: SecondOrder([[1.0]], [[1.0]], [[1.0]], (), [0.0], ()), "must name a harmonic"),
        (
            lambda: SecondOrder(
                [[1.0]], [[1.0]], [[1.0]], (cubic_spring([1.0, 0.0], 1.0),), [0.0], ((1, [1.0], [0.0]),)
            ),
            "must be 1 numbers",
        ),
        (lambda: backlash_spring([1.0], -1.0, 1.0), "must not be negative"),
        (lambda: balance_springs(duffing(), 1.0, 1.2, begin=3.0), "lies outside the range"),
        (lambda: balance_springs(duffing(), 1.0, 1.2, start=np.zeros((2, 3))), "must be series of 1 unknowns"),
    ],
)
def test_refusals(make: Any, words: str) -> None:
    with pytest.raises(InputError) as caught:
        make()
    assert words in str(caught.value)
