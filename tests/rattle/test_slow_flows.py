"""Perturbation of the gear pair: two derivations that agree, known peaks, and what they miss."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from gears import HALF_GAP, gear_pair
from oracles.sampling import quick_every
from scipy.integrate import quad

from trunnion.errors import InputError
from trunnion.motion.orbits.exact_orbit import piecewise_orbit
from trunnion.motion.perturbation.averaging import averaging
from trunnion.motion.perturbation.cubic_fit import cubic_fit
from trunnion.motion.perturbation.describing_function import DescribingFunction, describing_function
from trunnion.motion.perturbation.multiple_scales import MultipleScales, multiple_scales
from trunnion.numerics.piecewise_linear.piecewise import states
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator


def weak(frequency: float = 1.0) -> PiecewiseOscillator:
    """A slight stiffening beyond the gap, small damping and force: where first order must be right."""
    return PiecewiseOscillator.gap(
        0.5, stiffness=1.02, inside=1 / 1.02, damping=0.004, force=0.005, frequency=frequency
    )


def printed_rates(found: MultipleScales, amplitude: float, phase: float, frequency: float) -> tuple[float, float]:
    """Of amplitude and phase, from (42) and (43)."""
    sigma = (frequency * found.T - 1) / found.epsilon
    a, slow = amplitude / found.U, found.epsilon / found.T
    faster = -found.mu * a + 0.5 * found.B_1 * np.sin(phase)
    turning = sigma - found.softening * 0.375 * a**2 + 0.5 * found.B_1 * np.cos(phase) / a
    return faster * found.U * slow, turning * slow


@pytest.mark.parametrize("gaps", quick_every(4, [2.0, 1.5, 3.0, 5.0]))
@pytest.mark.slow
def test_two_derivations_one_slow_flow(gaps: float) -> None:
    one = multiple_scales(gear_pair(), fit_range=gaps * HALF_GAP)
    two = averaging(gear_pair(), fit_range=gaps * HALF_GAP)
    rng = np.random.default_rng(1)
    for amplitude, phase, frequency in rng.uniform([0.05, 0.0, 0.3], [0.9, 2 * np.pi, 1.5], size=(20, 3)):
        rates = one.rates(amplitude, phase, frequency)
        assert rates == pytest.approx(printed_rates(one, amplitude, phase, frequency), rel=1e-12, abs=1e-15)
        assert rates == pytest.approx(two.rates(amplitude, phase, frequency), rel=1e-12, abs=1e-15)
    a, b = one.response(0.4, 1.2), two.response(0.4, 1.2)
    assert a.peak == pytest.approx(b.peak, rel=1e-8)


def test_epsilon_does_not_matter() -> None:
    peaks = [multiple_scales(gear_pair(), epsilon=e).response(0.3, 2.0).peak for e in (1e-4, 0.01, 0.3, 2.0)]
    np.testing.assert_allclose(peaks, np.broadcast_to(peaks[0], (4, 2)), rtol=1e-9)


def test_the_range_of_the_fit_decides() -> None:
    """Twice the gap: 1.32 at 5.9 rad/s; five times: 0.78 at 0.89; the truth is 0.69 at 0.87."""
    at, size = multiple_scales(gear_pair(), fit_range=2 * HALF_GAP).response(0.1, 8.0).peak
    assert (at, size) == (pytest.approx(5.9, abs=0.05), pytest.approx(1.32, abs=0.005))
    at, size = multiple_scales(gear_pair(), fit_range=5 * HALF_GAP).response(0.1, 8.0).peak
    assert (at, size) == (pytest.approx(0.89, abs=0.005), pytest.approx(0.78, abs=0.005))


def test_peak_by_energy_balance() -> None:
    """B₁ = cω₀A at the peak of the first order; B₁² = c²A²(ω² + c²/4) of the describing function (N = ω² + c²/2)."""
    flow = multiple_scales(gear_pair(), fit_range=4 * HALF_GAP)
    assert flow.response(0.1, 8.0).peak[1] == pytest.approx(0.03 / (0.05 * np.sqrt(flow.fit.linear)), rel=1e-9)
    at, size = DescribingFunction(gear_pair(0.0)).response(0.3, 1.3).peak
    assert size == pytest.approx(0.688, abs=5e-4) and at == pytest.approx(0.872, abs=1e-3)
    assert size == pytest.approx(0.03 / (0.05 * np.hypot(at, 0.025)), rel=1e-6)


def test_least_squares() -> None:
    """Against quadrature and a dense least-squares problem; a cubic is not altered by an odd force's even part."""
    fit = cubic_fit(gear_pair(), 0.6)
    u = np.linspace(-0.6, 0.6, 200_001)
    rows = np.stack([u, u**3], axis=1)
    found = np.linalg.lstsq(rows, gear_pair().restoring(u), rcond=None)[0]
    assert (fit.linear, fit.cubic) == pytest.approx(tuple(found), rel=1e-4)
    assert fit.misfit == pytest.approx(np.abs(gear_pair().restoring(u) - rows @ found).max(), rel=1e-3)


@pytest.mark.parametrize(("amplitude", "mean"), [(0.1, 0.0), (0.1, 0.12), (0.5, 0.1), (2.0, -0.4), (0.05, 0.9)])
def test_describing_function_is_its_integral(amplitude: float, mean: float) -> None:
    o = PiecewiseOscillator((-0.3, 0.1, 0.2), (2.0, 0.5, 0.0, 3.0), inertia=2.0)

    def force(theta: float) -> float:
        return float(o.restoring(mean + amplitude * np.cos(theta))) / 2.0

    kinks = [np.arccos((b - mean) / amplitude) for b in o.breakpoints if abs(b - mean) < amplitude]
    constant = quad(force, 0, np.pi, points=kinks or None, epsabs=1e-13)[0] / np.pi
    stiffness = quad(lambda t: force(t) * np.cos(t), 0, np.pi, points=kinks or None, epsabs=1e-13)[0] * 2 / np.pi
    assert describing_function(o, amplitude, mean) == pytest.approx((constant, stiffness / amplitude), abs=1e-11)


def test_stable_branches_are_the_outer_two() -> None:
    for flow in (DescribingFunction(gear_pair(0.0)), multiple_scales(gear_pair(), fit_range=5 * HALF_GAP)):
        states_ = flow.steady(0.86)
        assert [s.stable for s in states_] == [True, False, True]
        for s in states_:
            assert np.abs(flow.rates(s.amplitude, s.phase, 0.86)).max() < 1e-10
    near = DescribingFunction(gear_pair(0.05)).steady(0.8)
    starts = [[s.mean + s.amplitude * np.cos(s.phase), 0.8 * s.amplitude * np.sin(s.phase)] for s in near]
    exact = [piecewise_orbit(gear_pair(0.05), start) for start in starts]
    for s, orbit in zip(near, exact, strict=True):
        assert s.stable == (abs(orbit.multipliers[0]) < 1)
        assert s.amplitude == pytest.approx(orbit.peak_to_peak / 2, rel=0.05)
        assert s.mean == pytest.approx(orbit.mean, abs=0.006)


def test_transient_of_the_slow_flow_is_the_envelope() -> None:
    """A weakly nonlinear gap: amplitude and phase follow the exact motion to the order of what is neglected."""
    o, times = weak(1.004), np.linspace(0, 400, 41)
    exact = states(o.regimes, o.coefficients, 1.004, [0.9, 0.0], times)
    wrong = {}
    for flow in (DescribingFunction(o), averaging(o, fit_range=0.9), multiple_scales(o, fit_range=0.9)):
        amplitude, phase = flow.transient(1.004, 0.9, 0.0, times)
        wrong[flow.method] = float(np.abs(amplitude * np.cos(1.004 * times - phase) - exact[:, 0]).max())
    assert wrong["describing function"] < 0.005
    assert wrong["averaging"] == pytest.approx(wrong["multiple scales"], rel=1e-6)
    assert wrong["averaging"] < 0.1
    frozen = np.abs(0.9 * np.cos(1.004 * times) - exact[:, 0]).max()
    assert frozen > 0.5


def test_transient_settles_on_a_steady_state() -> None:
    flow = DescribingFunction(gear_pair(0.0))
    small, _, large = flow.steady(0.8)
    for start, end in ((0.2, small), (0.6, large)):
        amplitude, _ = flow.transient(0.8, start, end.phase, [0.0, 800.0])
        assert amplitude[-1] == pytest.approx(end.amplitude, abs=1e-6)


def test_curve_that_leaves_the_range_is_parted() -> None:
    found = multiple_scales(gear_pair(), fit_range=3 * HALF_GAP).response(0.3, 1.2)
    assert np.isnan(found.frequency).sum() == 1 and len(found.folds) == 1
    assert found.frequency[np.isfinite(found.frequency)].max() <= 1.2
    assert "another range gives another answer" in str(found)
    nothing = multiple_scales(gear_pair(), fit_range=3 * HALF_GAP).response(9.0, 9.1)
    assert (nothing.amplitude < 1e-2).all()


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: multiple_scales(gear_pair(), fit_range=HALF_GAP), "does not reach beyond the gap"),
        (lambda: averaging(gear_pair(), epsilon=0.0), "epsilon = 0: must be positive"),
        (lambda: multiple_scales(gear_pair(), epsilon=-1.0), "epsilon = -1: must be positive"),
        (lambda: multiple_scales(PiecewiseOscillator((), (1.0,), 0.1, 0.0, 1.0)), "has no gap"),
        (lambda: multiple_scales(gear_pair().but(damping=0.0)).response(0.5, 1.0), "leaves the resonant motion"),
        (lambda: DescribingFunction(gear_pair().but(force=0.0)), "is zero: nothing moves"),
        (lambda: DescribingFunction(gear_pair().but(damping_law="in contact")), "only where damping always acts"),
        (lambda: DescribingFunction(gear_pair().but(harmonics=((2, 0.1, 0.0),))), "are not averaged"),
        (lambda: DescribingFunction(gear_pair()).response(1.0, 0.5), "must be a rising range"),
    ],
)  # fmt: skip
def test_refusals(make: Any, words: str) -> None:
    with pytest.raises(InputError) as caught:
        make()
    assert words in str(caught.value)
