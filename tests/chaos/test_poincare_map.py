"""Stroboscopic maps, sections, the 0–1 test, bifurcation diagrams, bad input."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.motion.chaos.poincare_map import PoincareMap
from trunnion.systems.reference import duffing, linear_oscillator, lorenz, mathieu_oscillator, rossler, ueda


def test_fixed_point_of_a_linear_oscillator() -> None:
    """x(2πk/ω) = Re X, v = −ω Im X, X = B/(k − ω² + icω)."""
    found = tn.poincare_map(linear_oscillator(damping=0.2, frequency=0.8), 100)
    response = 1.0 / (1 - 0.64 + 0.16j)
    assert found.repeat == 1
    assert found.points[-1] == pytest.approx([response.real, -0.8 * response.imag], abs=1e-9)


def test_phase_of_the_strobe() -> None:
    system = linear_oscillator(damping=0.2, frequency=0.8)
    found = tn.poincare_map(system, 50, phase=1.3)
    response = 1.0 / (1 - 0.64 + 0.16j) * np.exp(0.8j * 1.3)
    assert found.points[-1] == pytest.approx([response.real, -0.8 * response.imag], abs=1e-9)


def test_points_of_a_duffing_orbit_are_those_of_the_simulation() -> None:
    found = tn.poincare_map(duffing(), 5, transient=0)
    motion = tn.simulate(duffing(), periods=5, tolerance=1e-12)
    assert found.points == pytest.approx(motion.at(2 * np.pi / 1.2 * np.arange(1, 6)), abs=1e-8)


@pytest.mark.parametrize(("c", "repeat"), [(2.5, 1), (3.5, 2), (4.0, 4), (5.7, 0)])
def test_period_doubling_of_rossler(c: float, repeat: int) -> None:
    found = tn.poincare_map(rossler(c=c), 600, section=tn.Event("y", 0.0, direction=1))
    assert found.repeat == repeat
    assert np.abs(found.points[:, 1]).max() < 1e-10
    assert np.all(np.diff(found.time) > 4)


def test_every_time_of_an_autonomous_system() -> None:
    found = tn.poincare_map(lorenz(), 20, every=0.25, transient=0)
    motion = tn.simulate(lorenz(), 5.0, tolerance=1e-13)
    assert found.points[:8] == pytest.approx(motion.at(0.25 * np.arange(1, 9)), rel=1e-5, abs=1e-5)


def test_undamped_motion_is_a_closed_curve() -> None:
    found = tn.poincare_map(mathieu_oscillator(a=2.0, q=0.2), 3000)
    assert found.repeat == 0
    radius = np.hypot(*(found.points / found.points.std(axis=0)).T)
    angle = np.arctan2(*(found.points / found.points.std(axis=0)).T[::-1])
    order = np.argsort(angle)
    assert np.abs(np.diff(radius[order])).max() < 0.05  # a curve, not a cloud
    assert tn.zero_one_test(found.points[:, 0]).says == "regular"


@pytest.mark.parametrize(
    ("series", "says"),
    [
        ("logistic 4", "chaotic"), ("logistic 3.55", "regular"), ("torus", "regular"), ("constant", "regular"),
        ("ueda", "chaotic"), ("period 3", "regular"),
    ],
)  # fmt: skip
def test_zero_one(series: str, says: str) -> None:
    def logistic(r: float) -> np.ndarray:
        x = np.empty(2500)
        x[0] = 0.3
        for i in range(1, len(x)):
            x[i] = r * x[i - 1] * (1 - x[i - 1])
        return x[500:]

    made = {
        "logistic 4": lambda: logistic(3.9999),
        "logistic 3.55": lambda: logistic(3.55),
        "torus": lambda: np.cos(np.sqrt(2) * np.arange(2000)) + 0.5 * np.sin(np.sqrt(7) * np.arange(2000)),
        "constant": lambda: np.full(500, 3.0) + 1e-12 * np.random.default_rng(0).normal(size=500),
        "ueda": lambda: tn.poincare_map(ueda(), 2000).points[:, 0],
        "period 3": lambda: np.tile([1.0, 2.0, 5.0], 400),
    }
    assert tn.zero_one_test(made[series]()).says == says


def test_bifurcations_of_a_fold() -> None:
    """Between its folds at 1.1157 and 1.2696 Duffing's oscillator has two motions: up and down differ there."""
    found = tn.bifurcation_diagram(duffing(), "frequency", (1.0, 1.4, 17), points=12, transient=200)
    assert found.outcome.ok and np.all(found.repeat == 1)
    up, down = found.points[:, :, -1]
    apart = np.abs(up - down).max(axis=1) > 1e-3
    inside = (found.values > 1.12) & (found.values < 1.265)
    assert np.array_equal(apart, inside)
    assert found.data["x"].dims == ("direction", "value", "point")


def test_a_motion_that_blows_up_keeps_its_points() -> None:
    found = tn.poincare_map(mathieu_oscillator(), 5000, transient=10)
    assert not found.outcome.ok and found.outcome.kind == "blow-up"
    assert 0 < len(found.points) < 5000


def test_a_section_never_met() -> None:
    found = tn.poincare_map(lorenz(), 10, section=tn.Event("z", 270.0, direction=1), longest=50.0)
    assert (found.outcome.kind, len(found.points)) == ("never crossed", 0)
    assert "direction" in str(found.outcome)


BAD = {
    "no period": (lambda: tn.poincare_map(lorenz()), "section"),
    "no direction": (lambda: tn.poincare_map(lorenz(), section=tn.Event("z", 27.0)), "direction"),
    "no state": (lambda: tn.poincare_map(lorenz(), section=tn.Event("w", 27.0, direction=1)), "states are"),
    "two ways": (lambda: tn.poincare_map(lorenz(), section=tn.Event("z", 27.0, direction=1), every=1.0), "every"),
    "no time": (lambda: tn.poincare_map(lorenz(), every=-1.0), "every"),
    "no points": (lambda: tn.poincare_map(ueda(), 0), "points"),
    "short series": (lambda: tn.zero_one_test(np.zeros(10)), "200"),
    "direction": (lambda: tn.bifurcation_diagram(ueda(), "force", (1, 2, 3), directions=["left"]), "up"),
    "parameter": (lambda: tn.bifurcation_diagram(ueda(), "mass", (1, 2, 3)), "parameters are"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input(case: str) -> None:
    call, word = BAD[case]
    with pytest.raises(tn.InputError, match=word):
        call()


def test_prints_and_draws(tmp_path) -> None:  # type: ignore[no-untyped-def]
    found: PoincareMap = tn.poincare_map(ueda(), 500)
    assert "does not repeat" in str(found)
    axes = found.plot()
    assert axes.get_xlabel() == "x" and len(axes.lines[0].get_xdata()) == 500


@pytest.mark.slow
def test_a_coordinate_that_acts_off_phase_only_is_no_angle() -> None:
    """sin² t is 0 at t = 0, where the equations do not contain x at all."""

    def rate(t, x, p):  # type: ignore[no-untyped-def]
        return x[1], -0.1 * x[1] - np.sin(t) ** 2 * (x[0] - 10.0) + np.cos(t)

    system = tn.System.from_function(rate, ["x", "v"], period=2 * np.pi, start=[6.0, 0.0])
    found = tn.poincare_map(system, 20)
    assert len(found.turns) == 0 and found.repeat == 1
    assert found.wrapped[-1, 0] == pytest.approx(8.76118, abs=1e-5)


def test_no_map_of_a_free_line() -> None:
    line = tn.Driveline(
        [
            tn.Disk(inertia=0.5, load_torque=-50.0),
            tn.HookeJoint(angle="20 deg"),
            tn.Shaft(stiffness=1e4, damping=2),
            tn.Disk(inertia=1.0, viscous_load=0.3),
        ]
    )
    for analysis in (tn.poincare_map, tn.certify_chaos):
        with pytest.raises(tn.InputError, match="is free–free") as caught:
            analysis(line, 50, speed=100.0)
        assert "\n" not in str(caught.value)
