"""One rule for verdicts: rest is not an orbit, branches and orbits agree, a branch is as exact between its points."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.sampling import quick_only

import trunnion as tn
from trunnion.motion.orbits.harmonic_balance_springs import balance_springs
from trunnion.numerics.continuation.arclength import CurvePoint
from trunnion.results.verdict import Verdict
from trunnion.systems.second_order import SecondOrder, cubic_spring


def double_well(t, x, p):  # type: ignore[no-untyped-def]
    return x[1], x[0] - x[0] ** 3 - 0.2 * x[1]


def test_an_equilibrium_is_judged_by_all_its_multipliers() -> None:
    system = tn.System.from_function(double_well, ("x", "v"), start=(1e-4, 0.0), compiled=False)
    growth = -0.1 + np.sqrt(1.01)  # λ² + 0.2 λ − 1 = 0 at the saddle
    for period in (0.1, 1.0):
        found = tn.periodic_response(system, period=period)
        assert str(found.verdict) == "unstable" and found.outcome.kind == "at rest"
        assert found.growth_rate == pytest.approx(growth, rel=1e-6)
        assert "equilibrium" in str(found).splitlines()[0]
    below = tn.periodic_response(system, start=(0.999, 0.001), period=0.3)
    assert str(below.verdict) == "stable" and below.growth_rate == pytest.approx(-0.1, rel=1e-6)


def van_der_pol(t, x, p):  # type: ignore[no-untyped-def]
    return x[1], (1 - x[0] ** 2) * x[1] - x[0]


@pytest.mark.slow
def test_a_limit_cycle_keeps_its_phase_aside() -> None:
    system = tn.System.from_function(van_der_pol, ("x", "v"), start=(2.0, 0.0), compiled=False)
    cycle = tn.periodic_response(system, period=6.66)
    assert str(cycle.verdict) == "stable" and cycle.outcome.kind == "found"


def test_an_orbit_and_its_branch_have_one_verdict_near_the_circle() -> None:
    """Damped by so little that the multipliers lie 2e-7 and less inside the unit circle, and not at all."""
    for damping, verdict in ((2e-8, "stable"), (5e-11, "undecided"), (0.0, "marginal")):
        o = tn.PiecewiseOscillator.gap(half_gap=1.0, damping=damping, mean_force=0.3, force=0.01, frequency=0.3)
        orbit = tn.piecewise_orbit(o, [1.3, 0.0])
        branch = tn.piecewise_branch(o, 0.29, 0.31, begin=0.3, start=orbit.start)
        place = int(np.argmin(np.abs(branch.parameter - 0.3)))
        assert branch.parameter[place] == 0.3
        assert str(orbit.verdict) == verdict == str(Verdict(int(branch.verdict[place])))


@pytest.mark.parametrize(("damping", "verdict"), [(0.0, "marginal"), (1e-7, "stable")])
def test_without_damping_orbits_branches_and_series_say_so_alike(damping: float, verdict: str) -> None:
    duffing = tn.reference_system("duffing", damping=damping)
    orbit = tn.periodic_response(duffing, start=[0.05, 0.0], settle=False)
    frequency = duffing.parameters["frequency"]
    branch = tn.periodic_branch(duffing, "frequency", 0.998 * frequency, 1.002 * frequency, begin=frequency)
    series = tn.harmonic_balance(duffing, "frequency", 0.998 * frequency, 1.002 * frequency, harmonics=9)
    found = {str(Verdict(int(v))) for v in (*branch.verdict, *series.branch.verdict)} | {str(orbit.verdict)}
    assert found == {verdict}


def test_a_branch_is_exact_between_its_points() -> None:
    o = tn.PiecewiseOscillator.gap(half_gap=0.1, damping=0.1, mean_force=0.3, force=0.2, frequency=0.7)
    branch = tn.piecewise_branch(o, 0.6, 0.9, longest_step=0.1)
    ((start, verdict),) = branch.at(0.8)
    orbit = tn.piecewise_orbit(o.but(frequency=0.8), start)
    np.testing.assert_allclose(start, orbit.start, rtol=1e-9)
    assert verdict == orbit.verdict
    duffing = tn.reference_system("duffing")
    smooth = tn.periodic_branch(duffing, "frequency", 1.5, 1.6, longest_step=0.2)
    ((start, _),) = smooth.at(1.55)
    again = tn.periodic_response(duffing.but(frequency=1.55), start=start)
    np.testing.assert_allclose(start, again.start, rtol=1e-8, atol=1e-9)


def test_a_jacobian_by_regime_is_called_with_the_regime() -> None:
    def rate(t, x, p, regime):  # type: ignore[no-untyped-def]
        return x[1], -(1.0 if regime == 0 else 9.0) * x[0] - 0.2 * x[1] + np.cos(t)

    def slopes(t, x, p, regime):  # type: ignore[no-untyped-def]
        return np.array([[0.0, 1.0], [-(1.0 if regime == 0 else 9.0), -0.2]])

    wall = tn.Regimes(
        names=("free", "hit"), guards=("x = 0.1",), guard=lambda t, x, p: (x[0] - 0.1,),
        switches=(tn.Switch("free", "x = 0.1", +1, "hit"), tn.Switch("hit", "x = 0.1", -1, "free")),
        locate=lambda t, x, p: int(x[0] > 0.1),
    )  # fmt: skip
    found = []
    for jacobian in (slopes, None):
        system = tn.System.from_function(
            rate, 2, period=2 * np.pi, start=(0.0, 0.0), jacobian=jacobian, regimes=wall, compiled=False
        )
        found.append(system.jacobian(0.3, (0.5, 0.2), 1))
    np.testing.assert_allclose(found[0], found[1], rtol=1e-9)


def test_a_wrong_jacobian_is_refused_with_its_entry() -> None:
    def slopes(t, x, p):  # type: ignore[no-untyped-def]
        return np.array([[0.0, 1.0], [1 - 2 * x[0] ** 2, -0.2]])

    with pytest.raises(tn.InputError, match=r"∂\(v'\)/∂x = .* where differences give .*row 2, column 1"):
        tn.System.from_function(double_well, ("x", "v"), jacobian=slopes, start=(0.5, 0.0), compiled=False)


def test_states_far_below_their_scale_point_to_the_scale() -> None:
    def tiny(t, x, p):  # type: ignore[no-untyped-def]
        return x[1], -x[0] + 1e-9 * np.sign(np.cos(50 * t))

    system = tn.System.from_function(tiny, ("x", "v"), start=(1e-9, 0.0), compiled=False)
    run = tn.simulate(system, 100.0, tolerance=1e-14, most_steps=40)
    assert not run.outcome.ok and "give scale = (" in str(run.outcome)
    usual = tn.simulate(system, 100.0, start=(1.0, 0.0), most_steps=3)
    assert not usual.outcome.ok and "scale" not in str(usual.outcome)


def test_a_response_is_computed_where_it_is_asked_for() -> None:
    o = tn.PiecewiseOscillator.gap(half_gap=0.1, damping=0.1, mean_force=0.3, force=0.2, frequency=0.7)
    coarse, fine = (tn.frequency_response(o, 0.6, 0.9, longest_step=step) for step in (0.1, 0.01))
    np.testing.assert_allclose(coarse.at(0.8), fine.at(0.8), rtol=1e-9)
    orbit = tn.piecewise_orbit(o.but(frequency=0.8), coarse.detail.at(0.8)[0][0])
    assert coarse.at(0.8)[0] == (pytest.approx(orbit.peak_to_peak / 2, rel=1e-9), True)


SERIES = [(method, harmonics) for method in ("states", "springs") for harmonics in (3, 5, 12)]


@pytest.mark.parametrize(("method", "harmonics"), quick_only([("springs", 3)], SERIES))
@pytest.mark.slow
def test_a_series_knows_what_its_radius_is_off_by(method: str, harmonics: int) -> None:
    """Radii of a Duffing oscillator's series near 1 against those of the motions that shooting finds there."""
    system = tn.reference_system("duffing")
    if method == "states":
        start = (0.3, 0.0)
        found = tn.harmonic_balance(system, "frequency", 1.1, 1.28, start=start, begin=1.15, harmonics=harmonics)
        branch = found.branch
    else:
        spring = SecondOrder(
            [[1.0]], [[0.05]], [[1.0]], (cubic_spring([1.0], 0.1),), [0.0], ((1, [0.18], [0.0]),)
        )  # fmt: skip
        branch = balance_springs(spring, 1.1, 1.28, harmonics=harmonics).branch
    compared = 0
    for z, value, multipliers, verdict in zip(
        branch.unknowns, branch.parameter, branch.multipliers, branch.verdict, strict=True
    ):
        radius, point = float(np.abs(multipliers).max()), CurvePoint(z, np.zeros_like(z), 0)
        begun = branch.problem.start(point)
        orbit = tn.periodic_response(system.but(frequency=float(value)), start=begun, settle=False)
        # Beside a fold shooting may arrive at the motion on its other side.
        if abs(radius - 1) > 0.1 or not orbit.outcome.ok or np.abs(orbit.start - begun).max() > 0.02:
            continue
        error, far = branch.problem.radius_error(point, radius), abs(radius - 1)
        assert error < far if verdict != Verdict.UNDECIDED else error >= far
        if far > 1e-4:  # nearer, the fold is between the two motions that are compared
            off = abs(orbit.spectral_radius - radius) - orbit.error_estimate
            assert off < error or max(off, error) < far
        compared += 1
    assert compared >= 4
