"""Largest stable values by roots, the stable ranges above them, and the limits beside stability."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import two_shafts

import trunnion as tn
from trunnion.design.limits.result import LimitKind
from trunnion.design.limits.stable_limit import limit_of_chart
from trunnion.floquet.tongues.region import unpatched
from trunnion.floquet.tongues.tongues import task_of
from trunnion.results.verdict import Verdict

LINE = tn.catalogue("two-shaft-cardan")
ANGLE = "HookeJoint 1.angle"


def unstable_at(found: tn.design.limits.result.StableLimit, i: int, value: float) -> bool:
    return any(a < value < b for a, b in found.unstable[i])


PUBLISHED = [
    (100.0, 0.3, "1.400251 1.432358"),
    (100.0, 0.5, "1.372337 1.464882 0.37045 0.37365"),
    (1.0, 0.3, "1.601913 1.634565 0.61204 0.62460 1.11078 1.12580"),
    (1.0, 0.5, "1.572483 1.666968"),
]
"""S1 derived, α = μ = 1, ζ = 0.001: γ, β, and speeds at which a tongue ends there."""


@pytest.mark.parametrize(("gamma", "beta", "edges"), PUBLISHED)
def test_edges_of_the_published_tongues(gamma: float, beta: float, edges: str) -> None:
    """To the digits given, carried over to angles by the steepest slope of these edges, 60 rad per unit of speed."""
    line = tn.catalogue("two-shaft-cardan", inertia_of_disk_2=gamma)
    for text in edges.split():
        found = tn.stable_limit(line, ANGLE, float(text), high=0.7)
        half_a_digit = 0.5 * 10.0 ** -len(text.partition(".")[2])
        assert np.abs(found.unstable[0] - beta).min() < 60 * half_a_digit, text


@pytest.mark.slow
def test_every_edge_has_radius_one() -> None:
    """By an integration of the equations in twists, which shares nothing with the package."""
    found = tn.stable_limit(LINE, ANGLE, [0.31, 0.56, 0.65, 1.1, 1.58], high=1.3)
    edges = [(s, b) for s, ranges in zip(found.speed, found.unstable, strict=True) for b in ranges.ravel() if b < 1.3]
    assert len(edges) >= 6
    for speed, beta in edges:
        assert two_shafts.radius(speed, beta) == pytest.approx(1.0, abs=1e-9)


def dense(speeds: np.ndarray, values: np.ndarray) -> None:
    found = tn.stable_limit(LINE, ANGLE, speeds, high=1.4)
    assert found.complete and "every zero" in found.search
    for i, speed in enumerate(found.speed.tolist()):
        edges = found.unstable[i].ravel()
        for value in values.tolist():
            direct = tn.stability(tn.catalogue("two-shaft-cardan", angle=value), speed)
            near = len(edges) and np.abs(edges - value).min() < 1e-7
            if not near and direct.verdict in (Verdict.STABLE, Verdict.UNSTABLE):
                assert unstable_at(found, i, value) == (direct.verdict is Verdict.UNSTABLE), (speed, value)


def test_against_a_scan_with_stability() -> None:
    dense(np.array([0.538, 0.62]), np.linspace(0.05, 1.35, 13))


@pytest.mark.slow
def test_against_a_dense_scan_with_stability() -> None:
    dense(np.linspace(0.22, 2.0, 23), np.linspace(0.005, 1.395, 90))


def test_narrow_ranges_above_the_limit() -> None:
    """Where a leaning tongue turns back, its range of angles shrinks to nothing: ranges of a thousandth are found."""
    found = tn.stable_limit(LINE, ANGLE, np.linspace(0.59, 0.595, 401), high=1.3)
    thin = [(r[1] - r[0], s, r) for s, ranges in zip(found.speed, found.unstable, strict=True) for r in ranges[:-1]]
    width, speed, (low, high) = min(thin, key=lambda t: t[0])
    assert width < 0.02
    assert two_shafts.radius(speed, (low + high) / 2) > 1
    assert two_shafts.radius(speed, low - 1e-4) < 1 and two_shafts.radius(speed, high + 1e-4) < 1


def test_windows_above_the_limit() -> None:
    found = tn.stable_limit(LINE, ANGLE, [0.538], high=1.3)
    below, above = found.windows[0]
    assert below[0] == 0 and below[1] == found.limit[0] and above[0] > below[1]
    assert two_shafts.radius(0.538, above.mean()) < 1
    assert f"stable again from {np.rad2deg(above[0]):.6g}° to {np.rad2deg(above[1]):.6g}°" in found.sentence
    assert "unstable once more" in str(found)


def test_a_tip_bounds_the_limit_of_every_speed() -> None:
    tongue = next(t for t in tn.tongues(LINE, ("speed", 0.7, 0.9), (ANGLE, 0.5, 1.4), rows=17) if t.tip is not None)
    speed, tip = tongue.tip
    found = tn.stable_limit(LINE, ANGLE, [speed - 1e-4, speed, speed + 1e-4], high=1.3)
    assert found.limit[1] == pytest.approx(tip, abs=1e-6) and np.all(found.limit >= tip - 1e-9)


def test_undamped_lines_are_marginal_below_the_limit() -> None:
    def line(angle: float) -> tn.Driveline:
        return tn.catalogue("two-shaft-cardan", damping_ratio=0.0, angle=angle)

    found = tn.stable_limit(line(0.0), ANGLE, [0.62, 1.12, 1.58], high=0.8)
    assert list(found.kind) == [LimitKind.CROSSING] * 3
    for speed, value in zip(found.speed.tolist(), found.limit.tolist(), strict=True):
        assert tn.stability(line(value - 1e-4), speed).verdict is Verdict.MARGINAL
        assert tn.stability(line(value + 1e-4), speed).verdict is Verdict.UNSTABLE


@pytest.mark.slow
def test_three_shafts() -> None:
    def line(angle: float) -> tn.Driveline:
        names = {n: {"angle": angle} for n, e in zip(base.names, base.elements, strict=True) if e.kind == "HookeJoint"}
        return base.replace_all(names)

    base = tn.catalogue("three-shaft-cardan")
    found = tn.stable_limit(base, "HookeJoint *.angle", [0.52, 0.98, 1.03, 1.7], high=0.6)
    assert found.complete and LimitKind.CROSSING in found.kind
    for speed, value, kind in zip(found.speed.tolist(), found.limit.tolist(), found.kind, strict=True):
        if kind == LimitKind.CROSSING:
            assert tn.stability(line(value - 1e-5), speed).verdict is Verdict.STABLE
            assert tn.stability(line(value + 1e-5), speed).verdict is Verdict.UNSTABLE


@pytest.mark.slow
def test_a_chart_gives_the_same() -> None:
    """Its patches turned about, whether they were few or many."""
    speeds = np.array([0.35, 0.62, 1.12, 1.6])
    own = tn.stable_limit(LINE, ANGLE, speeds, high=0.9)
    for points in (20, 70):
        chart = tn.stability_chart(LINE, ("speed", 0.3, 1.8, points), (ANGLE, 0.0, 0.9, 60))
        found = limit_of_chart(chart, speeds)
        assert found.limit == pytest.approx(own.limit, abs=1e-10)
        assert list(found.intervals) == list(own.intervals)


def test_one_speed_and_a_range_with_margin() -> None:
    found = tn.stable_limit(LINE, ANGLE, [0.75, 0.9], high=0.9, margin=0.05)
    assert found.whole is not None and found.whole.margin == 0.05
    assert found.whole.largest < found.smallest  # the tip lies between the speeds
    assert found.sentence.startswith(found.whole.sentence) and found.whole.search in str(found)
    one = tn.stable_limit(LINE, ANGLE, 1.6, high=0.9)
    assert len(one.speed) == 1 and one.sentence.startswith("Stable at 1.6 rad/s up to angle of HookeJoint 1 18.")
    assert found.sentence_at(0.9).startswith("Stable at 0.9 rad/s")


DISK = tn.Disk(inertia=0.5, name="disk", excitation=[{"order": 2, "amplitude": 10.0}])


def oscillator(limits: list[tn.Limit], damping: float = 2.0, stiffness: float = 1e4) -> tn.Driveline:
    parts = [tn.ConstantSpeed(), tn.Shaft(stiffness=stiffness, damping=damping, name="shaft"), DISK]
    return tn.Driveline(parts, limits=limits)


def amplitude(stiffness: np.ndarray, damping: float, nu: float) -> np.ndarray:
    held = stiffness + 1j * nu * damping
    return 10.0 * np.abs(held / (held - 0.5 * nu**2))


@pytest.mark.parametrize(("damping", "allowed"), [(2.0, 60.0), (0.5, 300.0), (0.05, 1500.0)])
def test_other_limits_against_a_closed_form(damping: float, allowed: float) -> None:
    """One shaft over its resonance at k = Jν²: however sharp, its flank is where the limit is reached first."""
    line = oscillator([tn.Limit(of="shaft", vibratory_torque=allowed)], damping)
    speeds = np.array([60.0, 80.0, 100.0])
    found = tn.stable_limit(line, "shaft.stiffness", speeds, low=1e3, high=4e4)
    (other,) = found.others
    assert other.name == "vibratory torque of shaft" and other.allowed == allowed
    for speed, reached in zip(speeds.tolist(), other.reached.tolist(), strict=True):
        grid = np.linspace(1e3, 4e4, 400_001)
        first = grid[np.argmax(amplitude(grid, damping, 2 * speed) >= allowed)]
        assert reached == pytest.approx(first, abs=0.2)
        assert amplitude(np.array(reached), damping, 2 * speed) == pytest.approx(allowed, rel=1e-6)
    assert found.binding == ("vibratory torque of shaft",) * 3
    assert np.array_equal(found.usable, other.reached)
    assert "the vibratory torque of shaft binds" in found.sentence


def test_margins_are_taken_off_and_what_is_not_reached_is_said() -> None:
    limits = [
        tn.Limit(of="shaft", vibratory_torque=60.0, margin=0.25),
        tn.Limit(of="disk", max_speed_fluctuation=1e3),
        tn.Limit(of="disk", max_acceleration=1e-6),
    ]
    found = tn.stable_limit(oscillator(limits), "shaft.stiffness", [60.0], low=1e3, high=4e4)
    torque, fluctuation, acceleration = found.others
    assert torque.allowed == 45.0 and amplitude(torque.reached, 2.0, 120.0) == pytest.approx(45.0, rel=1e-6)
    assert np.isinf(fluctuation.reached[0]) and "max speed fluctuation of disk: not reached" in str(found)
    assert acceleration.reached[0] == 1e3 and "exceeded at the start of the range" in found.sentence
    assert np.isnan(found.data["reached"].sel(other_limit=fluctuation.name)).all()


@pytest.mark.parametrize("parameter", ["tube.outer_diameter:0.02:0.04", "tube.inner_diameter:0:0.027"])
def test_other_limits_of_a_bent_line_are_those_of_assess(parameter: str) -> None:
    """Stress of a tube whose diameter itself is varied, twist of one of two shafts in series, a coupling's rating."""
    parts = [
        tn.ConstantSpeed(), tn.Coupling(stiffness=4e3, relative_damping=0.8, loss_factor_frequency=200.0,
                                        vibratory_torque=80.0, name="coupling"),
        tn.Disk(inertia=0.1, name="hub"), tn.HookeJoint(angle=0.2, name="joint"),
        tn.Shaft(outer_diameter=0.03, inner_diameter=0.005, length=0.5, shear_modulus=79e9, loss_factor=0.02,
                 loss_factor_frequency=200.0, name="tube"),
        tn.Shaft(stiffness=3e4, loss_factor=0.02, loss_factor_frequency=200.0, name="stub"),
        tn.Disk(inertia=0.2, load_torque=20.0, name="load"),
    ]  # fmt: skip
    limits = [
        tn.Limit(of="tube", max_stress=1.2e7),
        tn.Limit(of="stub", max_twist=9.6e-4, margin=0.01),
        tn.Limit(of="coupling", temperature_factor=1.2),
    ]
    line = tn.Driveline(parts, limits=limits)
    path, low, high = parameter.split(":")
    found = tn.stable_limit(line, path, [90.0, 120.0], low=float(low), high=float(high))
    names = ["max stress of tube", "max twist of stub", "rated torque of coupling"]
    assert [o.name for o in found.others] == names
    checked = 0
    for other in found.others:
        for i, speed in enumerate(found.speed.tolist()):
            if not found.low < other.reached[i] <= found.high:
                continue
            there = line.replace("tube", **{path.partition(".")[2]: float(other.reached[i])})
            checks = tn.assess(there, (speed, speed)).checks
            check = next(c for c in checks if c.name == other.name)
            assert check.margin == pytest.approx(check.required_margin, abs=1e-6)
            checked += 1
    assert checked >= 2


def test_a_long_line_is_sampled_and_says_so() -> None:
    truck = tn.load("examples/truck.toml").with_load("climb")
    line = tn.Driveline(
        truck.elements, operation=truck.operation, limits=[tn.Limit(of="front tube", vibratory_torque=300.0)]
    )
    found = tn.stable_limit(line, "HookeJoint *.angle", [tn.rpm(2000)], high=0.3, scan=8)
    assert not found.complete and "sampled" in found.search and list(found.kind) == [LimitKind.BEYOND]
    (other,) = found.others
    names = {n: {"angle": float(other.reached[0])} for n in ("joint 1", "joint 2", "joint 3")}
    there = tn.order_response(line.replace_all(names), [tn.rpm(2000)])
    assert there.vibratory_torque[0, there.springs.index("front tube")] == pytest.approx(300.0, rel=1e-6)


BAD = [
    (lambda: tn.stable_limit(LINE, ANGLE, []), "speeds = []: must be a number or several"),
    (lambda: tn.stable_limit(LINE, ANGLE, [1.0, 0.0]), "speeds: must be positive numbers"),
    (lambda: tn.stable_limit(LINE, ANGLE, [1.0], scan=1), "scan = 1: must be a whole number of steps"),
    (lambda: tn.stable_limit(LINE, "speed", [1.0, 2.0]), "speed: is moved by both axes"),
]


@pytest.mark.parametrize(("run", "message"), BAD)
def test_refusals(run, message: str) -> None:
    with pytest.raises(tn.InputError) as caught:
        run()
    assert str(caught.value).startswith(message) and "\n" not in str(caught.value)


def hardly_damped_truck() -> tn.Driveline:
    """Modes that die within the period beside one that hardly does: its matrix hides what grows slowly."""
    line = tn.load(Path(__file__).parents[2] / "examples/truck.toml")
    changes = {}
    for name, element in zip(line.names, line.elements, strict=True):
        for key, share in (("damping", 0.02), ("loss_factor", 0.05)):
            if value := getattr(element, key, None):
                changes[name] = {key: share * value}
    return line.replace_all(changes)


def at_angle(line: tn.Driveline, angle: float) -> tn.Driveline:
    return line.replace_all({name: {"angle": angle} for name in line.names if "joint" in name})


def test_slow_growth_beside_fast_modes_is_told() -> None:
    """Each point is judged as ``stability`` judges it: the matrix's error of 1e-5 left all of these open."""
    line, speed, angles = hardly_damped_truck(), tn.rpm(336), np.array([0.33, 0.34])
    axes = ("HookeJoint *.angle", 0.3, 0.36), ("speed", 0.999 * speed, 1.001 * speed)
    task = task_of(line, *axes, None, True, "stable_limit")
    region = unpatched(task.family, task.x.values, task.y.values, 1)
    found = region.judged(task.family.to_patch(angles, True), np.repeat(task.family.to_patch([speed], False), 2))
    assert found.verdict.tolist() == [Verdict.STABLE, Verdict.UNSTABLE]
    for radius, error, angle in zip(found.radius, found.error, angles, strict=True):
        expected = tn.stability(at_angle(line, angle), speed)
        assert abs(radius - expected.spectral_radius) <= error + expected.error_estimate < 1e-7


@pytest.mark.slow
def test_slow_growth_beside_fast_modes_bounds_the_limit() -> None:
    line, speed = hardly_damped_truck(), tn.rpm(336)
    found = tn.stable_limit(line, "HookeJoint *.angle", [speed], low=0.3, high=0.36)
    verdicts = [tn.stability(at_angle(line, found.limit[0] + aside), speed).verdict for aside in (-2e-4, 2e-4)]
    assert verdicts == [Verdict.STABLE, Verdict.UNSTABLE]
