"""Charts of straight free lines: what `stability` sets aside is set aside, the speed judged where it counts."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.numerics.chain.characteristic import radii, without_ones
from trunnion.results.verdict import Verdict


def free_line(inertias: int, viscous: float = 0.0, quadratic: float = 0.0) -> tn.Driveline:
    """Straight, its first disk drives what the loads of the last one take."""
    elements: list[object] = [tn.Disk(inertia=1.0, drive_share=1.0 if viscous or quadratic else 0.0)]
    for i in range(1, inertias):
        last = i == inertias - 1
        elements += [
            tn.Shaft(stiffness=1.0 + 0.3 * i, damping=0.01),
            tn.Disk(
                inertia=0.5 + 0.2 * i, viscous_load=viscous if last else 0.0, quadratic_load=quadratic if last else 0.0
            ),
        ]
    return tn.Driveline(elements)


LOADS = {"none": (0.0, 0.0), "braking": (0.02, 0.0), "fan": (0.0, 0.01), "pushing": (-0.02, 0.0), "weak": (1e-5, 0.0)}


@pytest.mark.parametrize("load", list(LOADS))
@pytest.mark.parametrize("inertias", [2, 3, 4])
def test_the_same_as_stability(inertias: int, load: str) -> None:
    line = free_line(inertias, *LOADS[load])
    chart = tn.stability_chart(line, ("speed", 0.4, 3.0, 9), ("Shaft 1.stiffness", 1.0, 2.0, 7))
    for i, j in ((0, 0), (3, 4), (6, 8), (2, 7)):
        x, y = float(chart.x[j]), float(chart.y[i])
        true = tn.stability(line.replace("Shaft 1", stiffness=y), x)
        assert true.set_aside == (2 if load == "none" else 1)
        off = abs(true.spectral_radius - chart.spectral_radius[i, j])
        assert off <= true.error_estimate + chart.error_estimate[i, j]
        # From four inertias on matrices are interpolated, in which the pair at 1 is chosen among roots that meet.
        allowed = {true.verdict, Verdict.UNDECIDED} if inertias > 3 else {true.verdict}
        assert Verdict(int(chart.verdict[i, j])) in allowed
        every = chart.at(x, y).multipliers
        # A pair at 1 that is not divided out is known to the root of its matrix's error.
        assert np.count_nonzero(np.abs(every - 1) < (1e-4 if inertias > 3 else 1e-12)) >= true.set_aside
        assert np.abs(every) == pytest.approx(np.abs(true.multipliers), abs=1e-4 if inertias > 3 else 1e-5)


def test_a_load_that_falls_with_speed_makes_the_speed_run_away() -> None:
    """The whole line as one inertia: m dω/dt = −c ω, a multiplier exp(−cT/m) beyond 1 for c < 0."""
    c, total = -1e-3, 1.0 + 0.7
    line = free_line(2, c)
    chart = tn.stability_chart(line, ("speed", 0.5, 3.0, 5), ("Shaft 1.stiffness", 1.0, 2.0, 5))
    assert chart.count(Verdict.UNSTABLE) == chart.verdict.size
    assert chart.spectral_radius == pytest.approx(
        np.tile(np.exp(-c / total * chart.period / chart.x), (5, 1)), rel=1e-5
    )


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("size", [2, 4, 6])
def test_ones_are_divided_out(size: int, count: int) -> None:
    rest = np.array([0.95, -0.8, 0.5, 0.3, -0.2])[: size - count]
    polynomial = np.poly(np.concatenate([np.ones(count), rest]))
    e = (polynomial[1:] * (-1.0) ** np.arange(1, size + 1))[:, None]
    left, bounds = without_ones(e, np.full_like(e, 1e-14), count)
    if not len(left):
        return
    radius, error, critical = radii(left, bounds)
    assert abs(radius[0] - np.abs(rest).max(initial=0.0)) <= max(error[0], 1e-13)
    assert error[0] < 1e-9 and len(left) % 2 == 0
