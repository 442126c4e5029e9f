"""A load whose torque falls with the speed over a narrow stretch alone: every search over a range of speeds sees it.

One inertia on a shaft from a held input, I θ̈ + (c + T′(Ω)) θ̇ + k θ = 0, grows where T′ < −c; T by scipy's
interpolator through the same points.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

import trunnion as tn

INERTIA, STIFFNESS, DAMPING = 0.5, 1e4, 0.2
LOW, HIGH = 60.0, 180.0
SPEEDS = ("speed", LOW, HIGH)
STRETCHES = [(102.03, 102.4), (140.2, 140.3)]


def line(begin: float, end: float) -> tn.Driveline:
    points = [(0.0, 50.0), (begin, 100.0), (end, 90.0), (200.0, 150.0)]
    fan = tn.Fan(name="fan", inertia=INERTIA, curve=[{"speed": v, "torque": t} for v, t in points])
    return tn.Driveline([tn.ConstantSpeed(), tn.Shaft(name="shaft", stiffness=STIFFNESS, damping=DAMPING), fan])


def slope(begin: float, end: float, speed: float | np.ndarray) -> np.ndarray:
    through = PchipInterpolator([0.0, begin, end, 200.0], [50.0, 100.0, 90.0, 150.0])
    return np.asarray(through.derivative()(speed))


def growth(begin: float, end: float, speed: float, damping: float = DAMPING, stiffness: float = STIFFNESS) -> float:
    roots = np.roots([INERTIA, damping + float(slope(begin, end, speed)), stiffness])
    return float(roots.real.max())


def ends(begin: float, end: float) -> tuple[float, float]:
    middle = (begin + end) / 2

    def excess(speed: float) -> float:
        return growth(begin, end, speed)

    return brentq(excess, begin - 5, middle, xtol=1e-10), brentq(excess, middle, end + 5, xtol=1e-10)


@pytest.mark.parametrize(("begin", "end"), STRETCHES)
def test_assess_bars_the_stretch(begin: float, end: float) -> None:
    check = tn.assess(line(begin, end), (LOW, HIGH)).check("parametric stability")
    assert check.status.name == "EXCEEDED"
    ((low, high),) = check.barred
    np.testing.assert_allclose((low, high), ends(begin, end), rtol=1e-6)


@pytest.mark.parametrize(("begin", "end"), STRETCHES)
def test_regions_have_the_stretch(begin: float, end: float) -> None:
    """At every stiffness between the ends; edges by bisection, growth by the largest of many speeds."""
    found = tn.tongues(line(begin, end), SPEEDS, ("shaft.stiffness", 0.5 * STIFFNESS, 2 * STIFFNESS))
    assert len(found) == 1
    inside = np.linspace(begin, end, 2001)
    most = max(growth(begin, end, v, stiffness=k * STIFFNESS) for v in inside for k in (0.5, 2.0))
    assert found[0].growth_rate == pytest.approx(most, rel=2e-2)
    assert not tn.stable_windows(
        line(begin, end), "shaft.stiffness", 0.5 * STIFFNESS, 2 * STIFFNESS, (LOW, HIGH)
    ).windows.size


@pytest.mark.parametrize(("begin", "end"), STRETCHES)
def test_no_damping_that_is_too_small_is_called_enough(begin: float, end: float) -> None:
    """The least factor of the shaft's damping is that of the steepest fall."""
    least = -float(slope(begin, end, np.linspace(begin, end, 100_001)).min()) / DAMPING
    found = tn.minimum_damping(line(begin, end), (LOW, HIGH), maximum=2 * least)
    ((low, high),) = found.windows
    assert low == pytest.approx(least, rel=1e-3) and high == pytest.approx(2 * least)
    assert not tn.minimum_damping(line(begin, end), (LOW, HIGH), maximum=0.9 * least).windows.size
