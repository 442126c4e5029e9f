"""Exact motion of piecewise linear oscillators: closed forms, known orbits, derivatives, an independent integrator."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
import pytest
from gears import dead_zone, gear_pair
from known_motions import (
    BACKLASH,
    DEAD_ZONE_FOLDS,
    DEAD_ZONE_GRAZING,
    DEAD_ZONE_INNER,
    DEAD_ZONE_MULTIPLIER,
    DEAD_ZONE_OUTER,
    DEAD_ZONE_PEAK_TO_PEAK,
)
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import trunnion as tn
from trunnion.errors import InputError
from trunnion.motion.orbits.exact_orbit import piecewise_orbit
from trunnion.motion.orbits.periodic_branch import piecewise_branch
from trunnion.numerics.piecewise_linear.piecewise import TooManyEventsError, kernel, move, period
from trunnion.results.verdict import Verdict
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator


@pytest.mark.parametrize(
    ("c", "s"),
    [
        (0.0, 0.0), (0.3, 0.0), (40.0, 0.0), (0.1, 1.0), (2.0, 1.0), (2.0 + 1e-9, 1.0), (60.0, 1.0), (0.0, 4.0),
        (0.2, 1e-9), (1e-9, 1e-9),
    ],
)  # fmt: skip
@pytest.mark.parametrize("t", [1e-6, 0.3, 1.0, 7.0])
def test_one_piece_is_its_matrix_exponential(c: float, s: float, t: float) -> None:
    matrix = np.array([[0.0, 1.0, 0.0], [-s, -c, 1.0], [0.0, 0.0, 0.0]])
    exact = expm(matrix * t)
    found = kernel().homogeneous(c, s, t)
    np.testing.assert_allclose(found[:4], exact[:2, :2].ravel(), rtol=1e-12, atol=1e-13)
    assert found[4] == pytest.approx(exact[0, 2], rel=3e-8 if s == 1e-9 else 1e-12)


def test_contact_that_never_pulls() -> None:
    """The trajectory of Modelica's ElastoBacklash in closed form, to the seven digits it is given with."""
    gear = PiecewiseOscillator.gap(pi / 8, stiffness=20e3, damping=50.0, inertia=5.0, damping_law="never pulling")
    for time, angle in BACKLASH:
        found = move(gear.regimes, gear.coefficients, 1.0, [pi / 2, 0.0], 0.0, time)
        assert found.state[0] == pytest.approx(angle, abs=5.1e-8)


def test_against_the_integrator_of_systems() -> None:
    """Twenty periods of the dead-zone oscillator; the integrator's regimes are written independently."""
    system = tn.reference_system("dead-zone-oscillator", mean_force=0.02, force=0.4, damping=0.02, frequency=0.7)
    oscillator = PiecewiseOscillator.gap(1.0, damping=0.02, mean_force=0.02, force=0.4, frequency=0.7)
    end = 20 * oscillator.period
    run = tn.simulate(system, end, start=[1.5, 0.2], tolerance=1e-13)
    exact = move(oscillator.regimes, oscillator.coefficients, 0.7, [1.5, 0.2], 0.0, end)
    assert len(exact.crossings) > 30
    np.testing.assert_allclose(exact.state, run.final, atol=2e-9)


def test_damping_in_contact_only_against_scipy() -> None:
    """The force jumps at the ends of the gap; scipy restarts there."""
    o = PiecewiseOscillator.gap(1.0, damping=0.4, force=0.5, mean_force=0.1, frequency=0.7, damping_law="in contact")

    def rate(t: float, y: Any, side: float) -> list[float]:
        force = 0.1 + 0.5 * np.cos(0.7 * t)
        return [y[1], force - (side != 0) * (0.4 * y[1] + y[0] - side)]

    t, y, side = 0.0, np.array([0.0, 0.5]), 0.0
    end, crossed = 30.0, 0
    while t < end:
        ends = [1.0, -1.0] if side == 0 else [side]
        events = []
        for b in ends:

            def event(t: float, y: Any, side: float, b: float = b) -> float:
                return y[0] - b

            event.terminal = True  # type: ignore[attr-defined]
            event.direction = np.sign(b) if side == 0 else -side  # type: ignore[attr-defined]
            events.append(event)
        run = solve_ivp(rate, (t, end), y, args=(side,), events=events, rtol=1e-12, atol=1e-13, method="DOP853")
        t, y = float(run.t[-1]), run.y[:, -1]
        if run.status == 1:
            crossed += 1
            side = 0.0 if side != 0 else float(np.sign(y[0]))
    found = move(o.regimes, o.coefficients, 0.7, [0.0, 0.5], 0.0, end)
    assert len(found.crossings) == crossed > 10
    np.testing.assert_allclose(found.state, y, atol=1e-8)


@pytest.mark.parametrize("law", ["always", "in contact", "never pulling"])
def test_tangents_are_derivatives(law: Any) -> None:
    """By the start and by the frequency, over crossings where the force jumps too."""
    o = PiecewiseOscillator.gap(1.0, stiffness=2.0, damping=0.3, force=0.8, frequency=0.7, damping_law=law)
    start, h = np.array([0.3, 0.4]), 1e-6
    found = period(o.regimes, o.coefficients, 0.7, start, 2)
    assert len(found.crossings) >= 4
    for j, (dx, dw) in enumerate((([h, 0.0], 0.0), ([0.0, h], 0.0), ([0.0, 0.0], h))):
        plus, minus = (
            period(o.regimes, o.coefficients, 0.7 + s * dw, start + s * np.array(dx), 2).state for s in (1.0, -1.0)
        )
        np.testing.assert_allclose(found.tangents[:, j], (plus - minus) / (2 * h), atol=2e-8, rtol=1e-7)


def test_area_shrinks_as_the_damping_says() -> None:
    """det Φ = exp(−∫c dt), the damping always on."""
    o = gear_pair()
    found = period(o.regimes, o.coefficients, o.frequency, np.array([0.4, 0.1]), 3)
    assert np.linalg.det(found.tangents[:, :2]) == pytest.approx(np.exp(-0.05 * 3 * o.period), rel=1e-12)


def test_mirrored_force_gives_mirrored_motion() -> None:
    here, there = gear_pair(0.05), gear_pair(-0.05).but(force=-0.03)
    a, b = (move(o.regimes, o.coefficients, 0.8, [s * 0.3, s * 0.1], 0.0, 40.0) for o, s in ((here, 1), (there, -1)))
    np.testing.assert_allclose(a.state, -b.state, atol=1e-13)


def test_energy_without_damping_and_force() -> None:
    o = PiecewiseOscillator((-0.5, 0.2, 1.0), (3.0, 0.0, 1.0, 5.0))
    end = move(o.regimes, o.coefficients, 1.0, [2.0, 0.0], 0.0, 200.0)
    assert len(end.crossings) > 100

    def energy(x: float, v: float) -> float:
        grid = np.unique([0.0, x, *(k for k in o.breakpoints if min(0, x) < k < max(0, x))])
        return v * v / 2 + abs(float(np.trapezoid(o.restoring(grid), grid)))

    assert energy(*end.state) == pytest.approx(energy(2.0, 0.0), rel=1e-11)


def test_dead_zone_orbits() -> None:
    for start, peak, changes in zip((DEAD_ZONE_OUTER, DEAD_ZONE_INNER), DEAD_ZONE_PEAK_TO_PEAK, (0, 1), strict=True):
        orbit = piecewise_orbit(dead_zone(), np.round(start, 1))
        np.testing.assert_allclose(orbit.start, start, atol=5e-11)
        assert orbit.peak_to_peak == pytest.approx(peak, abs=6e-8)
        assert orbit.impacts == changes and orbit.contact == "one-sided" and orbit.verdict is Verdict.STABLE
        assert orbit.mean == pytest.approx(orbit.harmonics(0)[0].real, abs=1e-9)
    assert orbit.multipliers[0] == pytest.approx(DEAD_ZONE_MULTIPLIER, abs=6e-6) or orbit.multipliers[
        1
    ] == pytest.approx(DEAD_ZONE_MULTIPLIER, abs=6e-6)
    assert "one-sided" in str(orbit)


def test_dead_zone_branch_folds_and_grazing() -> None:
    branch = piecewise_branch(dead_zone(), 0.3, 1.4)
    assert sorted(f.parameter for f in branch.folds) == pytest.approx(DEAD_ZONE_FOLDS, abs=6e-6)
    grazing = [p.parameter for p in branch.special if p.kind == "grazing"]
    assert grazing == pytest.approx(DEAD_ZONE_GRAZING, abs=6e-9)
    assert branch.outcome.ok
    point = int(np.argmin(np.abs(branch.parameter - 0.65)))
    there = piecewise_orbit(dead_zone(float(branch.parameter[point])), branch.start[point])
    assert branch.amplitude[point, 0] == pytest.approx(abs(there.harmonics(1)[1]), abs=1e-9)
    unstable = branch.at(0.6)[1]
    assert unstable[1] is Verdict.UNSTABLE


def test_grazing_is_met_where_the_linear_amplitude_says() -> None:
    """Where 1.1 − 0.05/|1 − ω² + 0.1iω| = 1; just beside it the clearance is small."""
    orbit = piecewise_orbit(dead_zone(DEAD_ZONE_GRAZING[1] + 1e-6))
    assert orbit.impacts == 0 and 0 < orbit.clearance < 1e-5


def test_subharmonic_after_the_flip() -> None:
    """Past the period doubling a motion of twice the period is stable and the simple one is not."""
    o = gear_pair(0.05, 0.43)
    simple, double = piecewise_orbit(o, settle=True), piecewise_orbit(o, periods=2)
    branch = piecewise_branch(o, 0.3, 1.3)
    flips = [p.parameter for p in branch.special if p.kind == "period doubling"]
    assert flips[0] < 0.43 < flips[1]
    assert double.outcome.ok and double.verdict is Verdict.STABLE
    assert np.abs(move(o.regimes, o.coefficients, 0.43, double.start, 0.0, o.period).state - double.start).max() > 1e-3
    if simple.outcome.ok:
        assert simple.verdict is Verdict.UNSTABLE and abs(simple.multipliers[0] + 1) < 0.9


def test_a_closed_branch_is_walked_once() -> None:
    double = piecewise_orbit(gear_pair(0.05, 0.43), periods=2)
    loop = piecewise_branch(gear_pair(0.05), 0.38, 0.49, begin=0.43, start=double.start, periods=2)
    assert str(loop.outcome) == "the branch closes on itself"
    turns = [p.parameter for p in loop.special if p.kind == "fold"]
    assert min(turns) == pytest.approx(0.408230137, abs=1e-6) and max(turns) < 0.4633


def test_no_gap_is_the_linear_oscillator() -> None:
    o = PiecewiseOscillator.gap(0.0, stiffness=2.0, damping=0.1, mean_force=0.4, force=0.3, frequency=0.9)
    orbit = piecewise_orbit(o)
    assert orbit.peak_to_peak / 2 == pytest.approx(0.3 / abs(2 - 0.81 + 0.09j), rel=1e-9)
    assert orbit.mean == pytest.approx(0.2, abs=1e-9)
    assert PiecewiseOscillator.gap(0.3, stiffness=2.0, inside=1.0).slopes == (2.0,)


def test_two_harmonics_of_force_superpose_in_one_piece() -> None:
    o = PiecewiseOscillator((), (2.0,), 0.1, 0.0, 0.3, 0.9, harmonics=((2, 0.0, 0.2),))
    found = piecewise_orbit(o).harmonics(2)
    assert found[1] == pytest.approx(0.3 / (2 - 0.81 + 0.09j), abs=1e-12)
    assert found[2] == pytest.approx(-0.2j / (2 - 1.8**2 + 0.18j), abs=1e-12)


def test_chatter_is_said() -> None:
    fast = PiecewiseOscillator.gap(1e-4, stiffness=1e8, force=1.0, mean_force=1.0)
    with pytest.raises(TooManyEventsError, match="raise damping"):
        move(fast.regimes, fast.coefficients, 1.0, [1.0, 0.0], 0.0, 1e4)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: PiecewiseOscillator.gap(-0.1), "half_gap = -0.1: must not be negative"),
        (lambda: PiecewiseOscillator.gap(0.1, inside=1.2), "inside = 1.2: must lie between 0 and 1"),
        (lambda: PiecewiseOscillator.gap(0.1, damping=-1.0), "damping = -1: must not be negative"),
        (lambda: PiecewiseOscillator.gap(0.1, frequency=0.0), "frequency = 0: must be positive"),
        (lambda: PiecewiseOscillator.gap(0.1, inertia=-2.0), "inertia = -2: must be positive"),
        (lambda: PiecewiseOscillator.gap(0.1, force=float("nan")), "force = nan: must be a finite"),
        (lambda: PiecewiseOscillator((0.1, 0.0), (1.0, 0.0, 1.0)), "must rise"),
        (lambda: PiecewiseOscillator((0.1,), (1.0, 0.0, 1.0)), "must be 2 numbers"),
        (lambda: PiecewiseOscillator((0.1,), (1.0, -1.0)), "must not be negative"),
        (lambda: PiecewiseOscillator.gap(0.1, inside=0.5, damping_law="never pulling"), "needs a free gap"),
        (lambda: PiecewiseOscillator.gap(0.1, damping_law="sometimes"), "is unknown; write one of always"),  # type: ignore[arg-type]
        (lambda: gear_pair().but(mass=2.0), "mass: is not a field"),
        (lambda: PiecewiseOscillator((0.0,), (1.0, 0.0), 0.1, 2.0).equilibrium(), "is carried by no spring"),
        (lambda: piecewise_orbit(gear_pair(), [0.0]), "must be x and x′"),
        (lambda: piecewise_orbit(gear_pair(), periods=0), "must be a whole number from 1"),
        (lambda: piecewise_branch(gear_pair(), 1.0, 0.5), "must be a rising range"),
        (lambda: piecewise_branch(gear_pair(), 0.5, 1.0, begin=2.0), "lies outside the range"),
        (
            lambda: piecewise_orbit(PiecewiseOscillator((), (4.0,), 0.0, 0.0, 1.0, 2.0)),
            "grow without bound",
        ),
    ],
)  # fmt: skip
def test_refusals(make: Any, words: str) -> None:
    with pytest.raises(InputError) as caught:
        make()
    assert words in str(caught.value)
