"""The period behind ratios: the shortest that the coefficients have, found here by trial."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from oracles.comparisons import set_distance

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.equations.linear import line_matrices, periodic_linear_system
from trunnion.numerics.chain import dense_monodromy
from trunnion.numerics.chain.dense_monodromy import propagate


def line(*middle: Any, first: float = 0.4, last: float = 0.5) -> tn.Driveline:
    """Joint, shaft, disk, ``middle``, joint, shaft, disk; angle 0 leaves a joint out."""
    front = [tn.HookeJoint(angle=first)] if first else []
    back = [tn.HookeJoint(angle=last)] if last else []
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1.0, damping=0.02, fork_offset=0.3),
            tn.Disk(inertia=1.0),
            *front,
            tn.Shaft(stiffness=0.8, damping=0.02, fork_offset=0.6),
            tn.Disk(inertia=0.7),
            *middle,
            *back,
            tn.Shaft(stiffness=1.2, damping=0.02),
            tn.Disk(inertia=0.5),
        ]
    )


def tried_period(case: tn.Driveline) -> Fraction:
    """Shortest period in half-turns, among all fractions up to 120 with denominators up to 41."""
    assembly = assemble(case)
    coefficients = assembly.coefficients(assembly.table(1, 1.0))
    tau = np.array([0.123, 1.7, 4.0, 9.1])

    def matrices(at: np.ndarray) -> np.ndarray:
        found = line_matrices(assembly.topology, coefficients, at)
        parts = [found.mass, found.damping, found.stiffness, found.forcing[..., None]]
        return np.concatenate([p[0].reshape(len(at), -1) for p in parts], axis=1)

    here = matrices(tau)
    candidates = sorted({Fraction(p, q) for q in (1, 2, 3, 4, 5, 10, 20, 31, 41) for p in range(1, 121)})
    for candidate in candidates:
        if np.abs(matrices(tau + np.pi * float(candidate)) - here).max() < 1e-11:
            return candidate
    raise AssertionError("no period found")


CASES = {
    "no ratio": (line(), 1),
    "41:10 between joints": (line(tn.Ratio(teeth_in=10, teeth_out=41)), 41),
    "41:10, joint in front only": (line(tn.Ratio(teeth_in=10, teeth_out=41), last=0.0), 1),
    "41:10, joint behind only": (line(tn.Ratio(teeth_in=10, teeth_out=41), first=0.0), Fraction(41, 10)),
    "reversing 3:2": (line(tn.Ratio(ratio=-1.5)), 3),
    "speeding up 2:5": (line(tn.Ratio(teeth_in=5, teeth_out=2)), 2),
    "two ratios that cancel": (
        line(tn.Ratio(teeth_in=7, teeth_out=9), tn.Disk(inertia=0.1), tn.Ratio(teeth_in=9, teeth_out=7)),
        1,
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_period(name: str) -> None:
    case, half_turns = CASES[name]
    assert tried_period(case) == half_turns
    assert 2 * assemble(case).topology.period_turns() == half_turns


@pytest.mark.parametrize("name", CASES)
def test_multipliers_over_the_tried_period(name: str) -> None:
    """``stability`` integrates over that very period; over two of them multipliers are squared."""
    case, half_turns = CASES[name]
    result = tn.stability(case, 0.9)
    assert result.period == pytest.approx(np.pi * float(half_turns), rel=1e-14)
    assembly = assemble(case)
    system = periodic_linear_system(assembly, assembly.table(1, 0.9))

    def arrays(tau: np.ndarray) -> tuple[np.ndarray, ...]:
        m = system.coefficients(tau)
        return m.mass, m.damping, m.stiffness, m.forcing

    twice = propagate(arrays, 2 * result.period, system.size, 1e-10, 64)  # type: ignore[arg-type]
    squared = np.linalg.eigvals(twice.scaled_monodromy)
    assert set_distance(squared, result.multipliers**2) < 1e-8


def test_growth_rates_compare_across_periods() -> None:
    """A straight joint behind a 41:10 ratio lengthens the period 41 times and changes no growth rate."""
    short = tn.stability(line(tn.Ratio(teeth_in=10, teeth_out=41), last=0.0), 0.9)
    long = tn.stability(line(tn.Ratio(teeth_in=10, teeth_out=41), last=1e-9), 0.9)
    assert long.period == pytest.approx(41 * short.period)
    assert long.growth_rate == pytest.approx(short.growth_rate, rel=1e-7)


@pytest.mark.parametrize("teeth", [(2, 1), (2, 3), (3, 2), (10, 41)])
def test_resonance_keeps_its_name_over_longer_periods(teeth: tuple[int, int]) -> None:
    """S1 in its ω₂-subharmonic tongue, with a negligible tail behind a ratio and a hardly angled joint.

    The tail changes the period, hence the sign of the critical multiplier, but not the resonance.
    """
    tail: list[Any] = [
        tn.Ratio(teeth_in=teeth[0], teeth_out=teeth[1]),
        tn.HookeJoint(angle=1e-6),
        tn.Shaft(stiffness=2.0, damping=0.1),
        tn.Disk(inertia=0.1),
    ]
    body = tn.catalogue("two-shaft-cardan", angle=0.5, inertia_of_disk_2=100.0)
    result = tn.stability(tn.Driveline([*body.elements, *tail]), 1.41)
    assert result.verdict.name == "UNSTABLE" and result.resonance is not None
    assert result.resonance.kind == "subharmonic" and result.resonance.modes == (2,)
    assert result.resonance.speed == pytest.approx(1.415985, rel=2e-3)


@pytest.mark.parametrize("gear", [(1, 2), (2, 3)])
def test_joint_behind_two_joints_and_a_ratio(gear: tuple[int, int]) -> None:
    """The compiled kernel needs the unwrapped angle behind every joint in front of a ratio."""
    from oracles.package_kernels import chain_radius

    case = tn.Driveline(
        [
            *tn.catalogue("three-shaft-cardan", angle_1=0.5, angle_2=0.6).elements,
            tn.Ratio(teeth_in=gear[0], teeth_out=gear[1]),
            tn.HookeJoint(angle=0.7),
            tn.Shaft(stiffness=1.0, damping=0.01),
            tn.Disk(inertia=0.4),
        ]
    )
    speeds = np.array([0.4, 0.9, 1.7])
    found, _ = chain_radius(case, speeds)
    dense = [tn.stability(case, float(s)).spectral_radius for s in speeds]
    assert found == pytest.approx(dense, abs=1e-9)


@pytest.mark.parametrize("angle", [0.0, 0.2])
def test_what_dies_out_belongs_to_no_resonance(angle: float) -> None:
    """Beside a sum resonance, a stable line's slowest decay is a mode's own."""
    line = tn.Driveline(
        [tn.ConstantSpeed(), tn.Shaft(stiffness=1, damping=0.1), tn.Disk(inertia=1), tn.HookeJoint(angle=angle),
         tn.Shaft(stiffness=1, damping=0.1), tn.Disk(inertia=1)]
    )  # fmt: skip
    first, second = tn.natural_frequencies(line).undamped_frequency
    found = tn.stability(line, speed=float(first + second) / 2 * 1.02)
    assert found.verdict.name == "STABLE" and found.resonance is None and "belongs" not in str(found)


def test_a_motion_too_fast_for_any_step_is_refused_before_it_fills_the_memory() -> None:
    line = tn.Driveline(
        [tn.ConstantSpeed(), tn.Shaft(stiffness=1e18, damping=0.1), tn.Disk(inertia=1), tn.HookeJoint(angle=0.2),
         tn.Shaft(stiffness=1, damping=0.1), tn.Disk(inertia=1)]
    )  # fmt: skip
    with pytest.raises(tn.ComputationError, match="a stiffness is very large or an inertia very small"):
        tn.stability(line, speed=1.0)


def test_naming_a_resonance_evaluates_the_equations_no_more_often(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a propagator holds of the period serves its motions and their adjoint, kept or evaluated anew, alike."""
    line = tn.catalogue("two-shaft-cardan").replace("HookeJoint 1", angle=0.7)
    assembly = assemble(line)
    system = periodic_linear_system(assembly, assembly.table(1, 0.5375))
    asked: list[int] = []

    def counted(tau: Any) -> Any:
        asked.append(len(tau))
        return system.coefficients(tau)

    found = tn.stability(replace(system, coefficients=counted))
    assert found.verdict.name == "UNSTABLE"
    assert len(asked) < 12
    times = sum(asked)
    asked.clear()
    monkeypatch.setattr(dense_monodromy, "KEPT", 0)
    anew = tn.stability(replace(system, coefficients=counted))
    assert len(asked) < 12 and sum(asked) > times
    assert str(anew.resonance) == str(found.resonance) != "None"
    np.testing.assert_array_equal(anew.multipliers, found.multipliers)
