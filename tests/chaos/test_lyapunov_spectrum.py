"""Exponents with known answers, the sum rule, intervals, starts, endings, bad input."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracles.sampling import quick_only

import trunnion as tn
from trunnion.numerics.averages import average
from trunnion.systems.reference import (
    dead_zone_oscillator,
    driven_pendulum,
    duffing,
    linear_oscillator,
    lorenz,
    mathieu_oscillator,
    ueda,
)
from trunnion.systems.system import System

CHAOTIC = {
    # exponent and its uncertainty from long runs; the sum is −(damping) or −(σ + 1 + β)
    "lorenz": (lorenz, 0.906, 0.002, -41 / 3),
    "ueda": (ueda, 0.1034, 0.001, -0.05),
    "driven pendulum": (driven_pendulum, 0.160, 0.001, -0.1),
}


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] if n in ("ueda", "driven pendulum") else []) for n in CHAOTIC]
)
def test_chaotic_systems_at_the_default_effort(name: str) -> None:
    make, exponent, uncertainty, total = CHAOTIC[name]
    found = tn.lyapunov_spectrum(make())
    assert found.outcome.kind == "converged", str(found)
    assert found.positive
    assert abs(found.largest - exponent) <= 1.6 * found.half_width[0] + uncertainty
    assert 2 * found.half_width[0] < 0.02 * found.largest
    assert found.sum == pytest.approx(total, abs=1e-8)
    assert found.sum_error < 1e-8


def test_lorenz_is_complete() -> None:
    found = tn.lyapunov_spectrum(lorenz(), duration=2000.0)
    assert abs(found.exponents[1]) <= 2 * found.half_width[1] + 1e-3
    assert found.exponents[2] == pytest.approx(-14.572, abs=0.02)
    assert found.dimension == pytest.approx(2.062, abs=0.002)


@pytest.mark.parametrize("damping", quick_only((0.5, 3.0), (0.1, 0.5, 3.0)))
def test_linear_system(damping: float) -> None:
    """Real parts of the roots of s² + cs + 1."""
    found = tn.lyapunov_spectrum(linear_oscillator(damping=damping, frequency=0.8))
    roots = np.sort(np.roots([1.0, damping, 1.0]).real)[::-1]
    assert found.exponents == pytest.approx(roots, abs=1e-6)
    assert np.all(np.abs(found.exponents - roots) <= found.half_width + 1e-9)


@pytest.mark.slow
def test_three_different_rates_of_a_linear_system() -> None:
    matrix = np.array([[-0.3, 1.0, 0.2], [0.0, -0.7, 0.5], [0.1, 0.0, -2.0]])
    rows = tuple(map(tuple, matrix))

    def linear(t, x, p):  # type: ignore[no-untyped-def]
        return [rows[i][0] * x[0] + rows[i][1] * x[1] + rows[i][2] * x[2] for i in range(3)]

    system = System.from_function(linear, 3, start=[1.0, 1.0, 1.0], name="linear", compiled=False)
    found = tn.lyapunov_spectrum(system, duration=100.0, transient=40, starts=1, tolerance=1e-8)
    assert found.exponents == pytest.approx(np.sort(np.linalg.eigvals(matrix).real)[::-1], abs=1e-6)
    assert found.sum_error < 1e-6  # its tangents are differenced


@pytest.mark.parametrize("ratio", quick_only((0.0, 0.03), (0.0, 1e-6, 1e-3, 0.03, 0.3, 1.0, 4.0)))
def test_a_decaying_oscillator_is_never_positive(ratio: float) -> None:
    found = tn.lyapunov_spectrum(linear_oscillator(damping=2 * ratio, force=0.0), start=[1.0, 0.0], periods=1500)
    assert not found.positive
    assert found.largest <= 1e-9
    assert found.sum == pytest.approx(-2 * ratio, abs=1e-8)


def test_mathieu_inside_its_tongue() -> None:
    """± the growth rate of the multipliers (stability of the same oscillator), until it is out of range."""
    found = tn.lyapunov_spectrum(mathieu_oscillator(a=1.0, q=0.2), start=[1e-80, 0.0], periods=1000)
    from trunnion.systems.reference import mathieu

    rate = tn.stability(mathieu(1.0, 0.2)).growth_rate
    assert found.exponents == pytest.approx([rate, -rate], abs=1e-7)


@pytest.mark.slow
def test_traced_divergence_is_the_sum() -> None:
    """A system without a formula for its divergence: ∫ tr ∂f/∂x dt along the motion."""

    def van_der_pol(t, x, p):  # type: ignore[no-untyped-def]
        return x[1], p.mu * (1 - x[0] * x[0]) * x[1] - x[0]

    def slopes(t, x, p):  # type: ignore[no-untyped-def]
        return np.array([[0.0, 1.0], [-2 * p.mu * x[0] * x[1] - 1.0, p.mu * (1 - x[0] * x[0])]])

    system = System.from_function(
        van_der_pol, ["x", "v"], parameters={"mu": 1.0}, start=[0.5, 0.0], jacobian=slopes, name="van-der-pol"
    )
    found = tn.lyapunov_spectrum(system, duration=2000.0)
    assert found.sum_error < 1e-8
    # mean of 1 − x² over its period 6.6632868593, by another integrator: −1.0593770
    assert found.exponents == pytest.approx([0.0, -1.0593770], abs=1e-4)


def test_tangents_across_regimes() -> None:
    """A dead-zone oscillator: damping acts in every regime, so the sum is −c whatever it strikes."""
    found = tn.lyapunov_spectrum(dead_zone_oscillator(), periods=2000)
    assert found.sum == pytest.approx(-0.1, abs=1e-8)
    # multipliers 0.14600 ± 0.57411i over 2π/0.6 s
    rate = np.log(abs(0.14600 + 0.57411j)) * 0.6 / (2 * np.pi)
    assert found.exponents == pytest.approx([rate, rate], abs=1e-5)


def test_starts_on_two_attractors_are_told() -> None:
    found = tn.lyapunov_spectrum(duffing(frequency=1.2), start=[[0.0, 0.0], [2.5, 0.0]], periods=500, transient=300)
    assert found.by_start.shape == (2, 2)
    assert found.agree  # both foci damp at c/2
    far = tn.lyapunov_spectrum(ueda(force=5.5), start=[[0.0, 0.0], [3.0, 4.0]], periods=2000)
    assert far.agree == (np.ptp(far.by_start[:, 0]) < 3 * far.by_start_half_width[:, 0].max())


def test_fewer_exponents_are_the_first() -> None:
    found = tn.lyapunov_spectrum(lorenz(), duration=2000.0, exponents=1)
    assert found.exponents.shape == (1,)
    assert found.largest == pytest.approx(0.906, abs=0.03)
    assert np.isnan(found.divergence)


@pytest.mark.slow
def test_intervals_cover_as_often_as_they_say() -> None:
    """Of 95 % intervals from 30 short runs of Ueda's oscillator, at least 80 % hold the long-run value."""
    short = tn.lyapunov_spectrum(ueda(), periods=400, starts=30, tolerance=1e-8)
    covered = np.abs(short.by_start[:, 0] - 0.1034) <= short.by_start_half_width[:, 0]
    assert covered.mean() > 0.8
    assert short.by_start_half_width[:, 0].mean() < 0.02


def test_a_windowed_mean_is_exact_on_a_torus() -> None:
    t = np.arange(4096.0)
    series = 0.3 + np.cos(np.sqrt(2) * t)[:, None] * np.array([1.0, -2.0])
    found = average(series)
    assert found.windowed
    assert found.mean == pytest.approx([0.3, 0.3], abs=1e-8)
    noise = average(np.random.default_rng(3).normal(size=(4096, 1)))
    assert not noise.windowed
    assert abs(noise.mean[0]) < 2 * noise.half_width[0]


def test_result_prints_and_is_a_dataset() -> None:
    found = tn.lyapunov_spectrum(ueda(), periods=300)
    text = str(found)
    assert "L1 = +0." in text and "sum -0.05" in text and "ueda" in text
    data = found.data
    assert data["exponent"].attrs["units"] == "1/s"
    assert data["running_mean"].dims == ("start", "time", "order")
    assert data["running_mean"].values[:, -1].mean(axis=0) == pytest.approx(found.exponents, abs=2e-3)
    assert data.attrs["outcome"] == found.outcome.kind


def test_endings() -> None:
    short = tn.lyapunov_spectrum(ueda(), periods=20)
    assert (short.outcome.ok, short.outcome.kind) == (False, "too short")
    assert "80 periods" in str(short.outcome)
    blown = tn.lyapunov_spectrum(mathieu_oscillator(), periods=2000)
    assert (blown.outcome.ok, blown.outcome.kind) == (False, "blow-up")
    assert 0 < blown.samples < 2000
    assert blown.exponents[0] == pytest.approx(0.0995364, abs=1e-6)


@pytest.mark.slow
def test_differenced_tangents_of_a_motion_that_runs_away() -> None:
    """x′ = x and a linear saddle, whose states outgrow any fixed step of differences long before the end."""

    def alone(t, x, p):  # type: ignore[no-untyped-def]
        return (x[0] * p.r,)

    def saddle(t, x, p):  # type: ignore[no-untyped-def]
        return x[1], 0.5 * x[0] - 0.02 * x[1]

    growing = System.from_function(alone, ["x"], parameters={"r": 1.0}, start=[1.0])
    found = tn.lyapunov_spectrum(growing)
    assert found.exponents == pytest.approx([1.0], abs=1e-6)
    assert found.outcome.kind == "blow-up" and found.transient == 0
    assert tn.lyapunov_spectrum(growing, duration=100.0, transient=0, starts=1).largest == pytest.approx(1.0, abs=1e-6)
    told = tn.certify_chaos(growing, sweep=False, starts=1)
    assert told.verdict == "unbounded"
    assert not told.criteria[1].holds and "grow at 1 1/s" in told.criteria[2].why
    found = tn.lyapunov_spectrum(System.from_function(saddle, ["x", "v"], start=[0.1, 0.0]), starts=1)
    assert found.exponents == pytest.approx(np.sort(np.roots([1.0, 0.02, -0.5]))[::-1], abs=1e-6)


def test_a_sum_that_is_not_the_divergence_has_not_converged() -> None:
    found = tn.lyapunov_spectrum(replace(linear_oscillator(), divergence=-2.0), 200)
    assert (found.outcome.ok, found.outcome.kind) == (False, "not converged")
    assert "jacobian" in str(found.outcome)


BAD = {
    "no exponents": (lambda: tn.lyapunov_spectrum(ueda(), exponents=0), "exponents"),
    "too many exponents": (lambda: tn.lyapunov_spectrum(ueda(), exponents=3), "2 or less"),
    "two lengths": (lambda: tn.lyapunov_spectrum(ueda(), 10, duration=5.0), "periods"),
    "periods of lorenz": (lambda: tn.lyapunov_spectrum(lorenz(), 10), "autonomous"),
    "too many samples": (lambda: tn.lyapunov_spectrum(lorenz(), duration=1e12), "samples"),
    "no time": (lambda: tn.lyapunov_spectrum(lorenz(), duration=0.0), "duration"),
    "half a period": (lambda: tn.lyapunov_spectrum(ueda(), 0.5), "periods"),  # type: ignore[arg-type]
    "a start too long": (lambda: tn.lyapunov_spectrum(ueda(), start=[1.0, 2.0, 3.0]), "start"),
    "a start without a number": (lambda: tn.lyapunov_spectrum(ueda(), start=[np.nan, 2.0]), "finite"),
    "a speed of a system": (lambda: tn.lyapunov_spectrum(ueda(), speed=3.0), "drivelines"),
    "no system": (lambda: tn.lyapunov_spectrum("ueda"), "System"),  # type: ignore[arg-type]
    "no precision": (lambda: tn.lyapunov_spectrum(ueda(), precision=0.0), "precision"),
    "no tolerance": (lambda: tn.lyapunov_spectrum(ueda(), tolerance=1.0), "tolerance"),
    "transient": (lambda: tn.lyapunov_spectrum(ueda(), transient=-1), "transient"),
    "an unknown parameter": (lambda: tn.lyapunov_sweep(ueda(), "speed", (1.0, 2.0, 3)), "force"),
    "falling values": (lambda: tn.lyapunov_sweep(ueda(), "force", (2.0, 1.0, 3)), "rising"),
    "no threads": (lambda: tn.lyapunov_map(ueda(), ("force", 1, 2, 2), ("damping", 0, 1, 2), threads=0), "threads"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input(case: str) -> None:
    call, word = BAD[case]
    with pytest.raises(tn.InputError, match=word) as caught:
        call()
    assert "\n" not in str(caught.value)


def test_sweep_and_map() -> None:
    sweep = tn.lyapunov_sweep(ueda(), "force", (7.0, 7.5, 3), periods=500)
    assert sweep.exponents.sum(axis=1) == pytest.approx(-0.05, abs=1e-8)
    assert sweep.positive[-1] and sweep.outcome.ok
    one = tn.lyapunov_map(
        ueda(), ("force", 7.0, 7.5, 3), ("damping", 0.05, 0.3, 2), periods=500, transient=300, threads=1
    )
    two = tn.lyapunov_map(
        ueda(), ("force", 7.0, 7.5, 3), ("damping", 0.05, 0.3, 2), periods=500, transient=300, threads=2
    )
    assert np.array_equal(one.exponent, two.exponent)
    assert one.exponent[0, 2] == pytest.approx(sweep.exponents[2, 0], abs=0.03)
    assert one.data["exponent"].dims == ("y", "x")


def test_a_point_that_fails_keeps_its_place() -> None:
    found = tn.lyapunov_map(
        mathieu_oscillator(), ("a", 1.0, 2.0, 2), ("q", 0.2, 0.3, 2), periods=900, transient=100, threads=1
    )
    assert np.isnan(found.exponent[:, 0]).all() and np.isfinite(found.exponent[:, 1]).all()
    assert not found.outcome.ok and "2 of 4" in str(found.outcome)
