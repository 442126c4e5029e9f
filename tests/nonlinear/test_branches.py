"""Branches of periodic motions: known folds and grazings, doublings, tori, broken symmetry, both ways round."""

from __future__ import annotations

import numpy as np
import pytest
from jointed_lines import two_shafts
from known_motions import DEAD_ZONE_FOLDS, DEAD_ZONE_GRAZING, DUFFING_FOLDS, DUFFING_LOWER, DUFFING_UPPER

import trunnion as tn
from trunnion.results.verdict import Verdict


def test_duffings_folds_and_branches() -> None:
    branch = tn.periodic_branch(tn.reference_system("duffing"), "frequency", 0.8, 1.6)
    assert branch.outcome.ok and len(branch.folds) == len(branch.special) == 2
    for fold, (frequency, amplitude) in zip(branch.folds, DUFFING_FOLDS, strict=True):
        assert fold.parameter == pytest.approx(frequency, abs=6e-8)
        assert fold.amplitude[0] == pytest.approx(amplitude, abs=2e-7)
        assert np.abs(fold.multipliers - 1).min() < 1e-4
    # At ω = 1.2 three motions, the middle one unstable; each corrected to its value.
    found = branch.at(1.2)
    assert [v for _, v in found] == [Verdict.STABLE, Verdict.UNSTABLE, Verdict.STABLE]
    system = tn.reference_system("duffing")
    amplitudes = [abs(tn.periodic_response(system, start=x, settle=False).harmonics(1)[1, 0]) for x, _ in found]
    assert amplitudes[0] == pytest.approx(DUFFING_UPPER, abs=6e-8)
    assert amplitudes[2] == pytest.approx(DUFFING_LOWER, abs=6e-8)
    assert amplitudes[2] < amplitudes[1] < amplitudes[0]
    between = (branch.parameter > 1.1157) & (branch.parameter < 1.2696)
    assert (branch.verdict[between] == Verdict.UNSTABLE).any()
    assert "fold at 1.26960196" in str(branch)


@pytest.mark.slow
def test_dead_zone_grazings_and_folds() -> None:
    """Grazing to eight digits, the smooth folds of the motion across the gap to those known."""
    system = tn.reference_system("dead-zone-oscillator")
    branch = tn.periodic_branch(system, "frequency", 0.4, 1.6, begin=1.5, start=[1.1, 0.0])
    kinds = [p.kind for p in branch.special]
    assert sorted(kinds) == ["fold", "fold", "grazing", "grazing"]
    grazing = sorted(p.parameter for p in branch.special if p.kind == "grazing")
    np.testing.assert_allclose(grazing, DEAD_ZONE_GRAZING, atol=6e-9)
    np.testing.assert_allclose(sorted(p.parameter for p in branch.folds), DEAD_ZONE_FOLDS, atol=6e-6)


@pytest.mark.slow
def test_a_branch_is_the_same_both_ways() -> None:
    system = tn.reference_system("dead-zone-oscillator")
    shares: list[float] = []
    one = tn.periodic_branch(
        system, "frequency", 0.42, 0.8, begin=0.6, start=[0.396, 0.19], longest_step=0.03, progress=shares.append
    )
    # From inside the range the branch goes both ways, through folds; what is told of it only rises.
    assert len(shares) > len(one.parameter) and shares == sorted(shares) and shares[0] >= 0 and shares[-1] == 1
    other = tn.periodic_branch(
        system, "frequency", 0.42, 0.8, start=one.start[np.argmin(one.parameter)], longest_step=0.03
    )
    a = sorted((p.kind, round(p.parameter, 7)) for p in one.special)
    b = sorted((p.kind, round(p.parameter, 7)) for p in other.special)
    assert a == b and len(a) == 3


def van_der_pol() -> tn.System:
    return tn.System.from_function(
        lambda t, x, p: (x[1], p.mu * (1 - x[0] ** 2) * x[1] - x[0] + p.force * np.cos(p.frequency * t)),
        ["x", "v"],
        parameters={"mu": 0.05, "force": 0.2, "frequency": 1.0},
        period=lambda p: 2 * np.pi / p["frequency"],
        jacobian=lambda t, x, p: np.array([[0.0, 1.0], [-2 * p.mu * x[0] * x[1] - 1, p.mu * (1 - x[0] ** 2)]]),
    )


@pytest.mark.slow
def test_tori_of_the_forced_van_der_pol_oscillator() -> None:
    """Entrainment is lost where the averaged equations have trace zero: amplitude √2, half the free one's square."""
    branch = tn.periodic_branch(van_der_pol(), "frequency", 0.8, 1.2, begin=1.0, start=[0.0, 2.0])
    assert [p.kind for p in branch.special] == ["Neimark–Sacker", "Neimark–Sacker"]
    for point in branch.special:
        assert point.amplitude[0] == pytest.approx(np.sqrt(2), abs=1e-4)
        assert np.abs(np.abs(point.multipliers) - 1).max() < 1e-8
        assert np.abs(point.multipliers.imag).min() > 0.1
    inside = (branch.parameter > branch.special[0].parameter + 1e-6) & (
        branch.parameter < branch.special[1].parameter - 1e-6
    )
    assert branch.stable[inside].all() and not branch.stable[branch.parameter < 0.92].any()


@pytest.mark.slow
def test_doubling_of_a_line_at_its_subharmonic_resonance() -> None:
    """The true motion of a lightly damped line turns unstable where a multiplier passes −1."""
    line = two_shafts(angle=20.0, load=100.0)
    branch = tn.periodic_branch(line, "speed", 65.0, 85.0)
    assert [p.kind for p in branch.special] == ["period doubling", "period doubling"]
    low, high = (p.parameter for p in branch.special)
    assert all(np.abs(p.multipliers + 1).min() < 1e-8 for p in branch.special)
    assert tn.periodic_response(line, (low + high) / 2).verdict is Verdict.UNSTABLE
    for speed in (low - 0.2, high + 0.2):
        assert tn.periodic_response(line, speed).verdict is Verdict.STABLE
    # Inside, the motion of twice the period exists, is stable, and is what a simulation finds.
    middle = (low + high) / 2
    run = tn.simulate(line, speed=middle, turns=2000, start=branch.special[0].start + 1e-4, dense=False)
    doubled = tn.periodic_response(line, middle, start=run.final, periods=2)
    single = tn.periodic_response(line, middle)
    assert doubled.outcome.ok and doubled.verdict is Verdict.STABLE
    assert doubled.turns == pytest.approx(1.0)
    assert np.abs(doubled.orbit.start - single.orbit.start).max() > 1e-3
    orders, amplitude = doubled.order_spectrum(3)
    assert amplitude[np.isclose(orders, 1)].max() > 10.0


def test_broken_symmetry_is_named() -> None:
    system = tn.reference_system("duffing", cubic=1.0, force=3.0, damping=0.1)
    branch = tn.periodic_branch(system, "frequency", 0.8, 1.2, begin=1.2, start=[2.0, 0.0])
    kinds = [p.kind for p in branch.special]
    assert "branch point" in kinds
    for point in branch.special:
        if point.kind == "branch point":
            assert np.abs(point.multipliers - 1).min() < 1e-3  # two curves cross there, Newton comes no closer


@pytest.mark.slow
def test_over_any_parameter_of_a_line() -> None:
    """Over a joint's angle, the torque grows as its square at first; the ends are exactly those asked for."""
    branch = tn.periodic_branch(two_shafts(), "HookeJoint 1.angle", 0.01, 0.3, speed=60.0)
    assert branch.parameter[[0, -1]] == pytest.approx([0.01, 0.3], abs=1e-12)
    assert branch.unit == "rad" and branch.curves == ("Shaft 1", "Shaft 2")
    share = branch.peak_to_peak[:, 1] / branch.parameter**2
    near = branch.parameter < 0.08
    assert np.ptp(share[near]) < 0.01 * share[0]
    single = tn.periodic_response(two_shafts(angle=np.rad2deg(0.3)), 60.0)
    assert branch.peak_to_peak[-1] == pytest.approx(single.torque_peak_to_peak, rel=1e-6)
    assert branch.data.sizes["point"] == len(branch.parameter)


def test_endings() -> None:
    system = tn.reference_system("duffing")
    short = tn.periodic_branch(system, "frequency", 0.8, 1.6, most_points=5)
    assert not short.outcome.ok and "raise most_points" in short.outcome.sentence and len(short.parameter) == 5
    drifting = tn.System.from_function(
        lambda t, x, p: (x[1], p.mean + np.cos(t)),
        ["x", "v"],
        parameters={"mean": 1.0},
        period=2 * np.pi,
        compiled=False,
    )
    none = tn.periodic_branch(drifting, "mean", 1.0, 2.0, start=[0.0, 0.0])
    assert not none.outcome.ok and len(none.parameter) == 0 and "no branch over mean" in str(none)


REFUSED = [
    (lambda: tn.periodic_branch(tn.reference_system("duffing"), "frequency", 2.0, 1.0), "rising range"),
    (lambda: tn.periodic_branch(tn.reference_system("duffing"), "frequency", 1.0, 2.0, begin=3.0), "outside"),
    (lambda: tn.periodic_branch(tn.reference_system("duffing"), "speed", 1.0, 2.0), "not a parameter"),
    (lambda: tn.periodic_branch(tn.reference_system("lorenz"), "rho", 1.0, 2.0), "autonomous"),
    (lambda: tn.periodic_branch(two_shafts(), "angle", 1.0, 2.0, speed=50.0), "not a parameter"),
    (lambda: tn.periodic_branch(two_shafts(), "HookeJoint 1.angle", 0.1, 0.2), "speed"),
]


@pytest.mark.parametrize(("call", "words"), REFUSED, ids=[w for _, w in REFUSED])
def test_refusals(call, words) -> None:
    with pytest.raises(tn.InputError, match=words):
        call()
