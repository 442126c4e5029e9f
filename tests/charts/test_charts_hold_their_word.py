"""What a chart says of itself holds wherever it is asked: free lines, failed checks, idle axes, own families."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import trunnion as tn
from trunnion.results.verdict import Verdict


def _mathieu(tau, a, q):
    return np.eye(1), np.zeros((1, 1)), (a - 2 * q * np.cos(2 * tau))[..., None, None]


MATHIEU = tn.PeriodicLinearFamily(np.pi, _mathieu, 1, {"a": 1.0, "q": 0.5})


def _uneven_pair() -> tn.Driveline:
    shaft = tn.Shaft(stiffness=1, damping=0.002)
    return tn.Driveline(
        [tn.ConstantSpeed(), shaft, tn.Disk(inertia=1), tn.HookeJoint(angle=0.3), shaft, tn.Disk(inertia=100)]
    )


@pytest.mark.parametrize(("first", "second", "damping"), [(1.0, 2.0, 1e-4), (1.0, 1.0, 1e-2), (1.0, 2.0, 1e-3)])
def test_free_line_of_two_inertias_in_closed_form(first: float, second: float, damping: float) -> None:
    """|σ| = exp(−c/m · T/2) with the reduced inertia m; near a whole number of cycles four multipliers meet at 1."""
    line = tn.Driveline([tn.Disk(inertia=first), tn.Shaft(stiffness=1, damping=damping), tn.Disk(inertia=second)])
    chart = tn.stability_chart(line, ("speed", 0.1, 3, 120), ("Shaft 1.stiffness", 1, 2, 120))
    exact = np.exp(-damping * (1 / first + 1 / second) * chart.period / chart.x / 2)
    off = np.abs(chart.spectral_radius - exact)
    assert off.max() < 1e-12 and np.all(off <= chart.error_estimate)
    at = chart.at(0.4114093959731544, 1.8053691275167785)
    assert np.count_nonzero(at.multipliers == 1) == 2 and at.verdict is Verdict.STABLE


def test_one_free_inertia_neither_grows_nor_decays() -> None:
    chart = tn.stability_chart(tn.Driveline([tn.Disk(inertia=1)]), ("speed", 0.1, 3, 6), ("Disk 1.inertia", 1, 2, 5))
    assert np.all(chart.spectral_radius == 1) and chart.count(Verdict.MARGINAL) == 30
    assert chart.at(1, 1.5).multipliers.tolist() == [1, 1]


def test_free_line_of_three_inertias_as_stability_sees_it() -> None:
    def line(k: float) -> tn.Driveline:
        soft, stiff = tn.Shaft(stiffness=k, damping=1e-3), tn.Shaft(stiffness=3, damping=1e-3)
        return tn.Driveline([tn.Disk(inertia=1), soft, tn.Disk(inertia=2), stiff, tn.Disk(inertia=0.5)])

    chart = tn.stability_chart(line(1), ("speed", 0.1, 3, 40), ("Shaft 1.stiffness", 1, 2, 40))
    for i, j in ((3, 9), (20, 20), (39, 13)):
        one = tn.stability(line(float(chart.y[i])), speed=float(chart.x[j]))
        off = abs(one.spectral_radius - chart.spectral_radius[i, j])
        assert off <= one.error_estimate + chart.error_estimate[i, j]


@pytest.mark.slow
def test_a_failed_check_builds_the_chart_anew(tmp_path: Path) -> None:
    """Coefficients that vanish at every node of a patch: the check finds out, and smaller patches have other nodes."""

    def hidden(tau, a, q):
        wave = 0.3 * np.cos(48 * np.arccos(np.clip((2 * a - 5) / 7, -1, 1)))
        return np.eye(1), np.full((1, 1), 0.02), (1 + wave - 2 * q * np.cos(2 * tau))[..., None, None]

    family = tn.PeriodicLinearFamily(np.pi, hidden, 1, {"a": 1.0, "q": 0.5})
    chart = tn.stability_chart(family, ("a", -1.0, 6.0, 44), ("q", 0.0, 3.0, 44))
    assert chart.way == "smaller patches" and any("built anew from smaller patches" in r for r in chart.remarks)
    chart.save(tmp_path / "c.nc")
    for one in (chart, tn.load_chart(tmp_path / "c.nc", family=family)):
        for a, q in ((0.31, 0.7), (2.07, 1.3), (4.4, 2.9)):
            point, true = one.at(a, q), tn.stability(family.system(a=a, q=q))
            assert abs(point.spectral_radius - true.spectral_radius) <= point.error_estimate + true.error_estimate


@pytest.mark.slow
def test_a_family_read_from_a_file_answers_from_its_patches(tmp_path: Path) -> None:
    chart = tn.stability_chart(MATHIEU, ("a", 0, 4, 60), ("q", 0, 3, 50))
    chart.save(tmp_path / "m.nc")
    again = tn.load_chart(tmp_path / "m.nc")
    assert again.at(1.0, 0.5).spectral_radius == chart.at(1.0, 0.5).spectral_radius
    assert np.array_equal(again.zoom((1, 2, 5), (0, 1, 4)).verdict, chart.zoom((1, 2, 5), (0, 1, 4)).verdict)
    assert tn.load_chart(tmp_path / "m.nc", family=MATHIEU).at(3.3, 0.1).interpolated


def test_a_chart_without_patches_needs_its_family(tmp_path: Path) -> None:
    chart = tn.stability_chart(MATHIEU, ("a", 0, 4, 12), ("q", 0, 3, 9))
    chart.save(tmp_path / "m.nc")
    with pytest.raises(tn.InputError, match="read without its family"):
        tn.load_chart(tmp_path / "m.nc").at(1.03, 0.5)
    whole = tn.load_chart(tmp_path / "m.nc", family=MATHIEU)
    assert whole.at(1.03, 0.5).spectral_radius == chart.at(1.03, 0.5).spectral_radius


@pytest.mark.parametrize(
    ("parameter", "low", "high", "idle"),
    [
        ("Shaft 2.fork_offset", 0.0, 2 * np.pi, False),  # repeats every half turn
        ("HookeJoint 2.plane", -np.pi, np.pi, False),
        ("Shaft 1.fork_offset", 0.0, 2 * np.pi, True),  # turns the whole line
    ],
)
def test_only_what_changes_nothing_is_said_to(parameter: str, low: float, high: float, idle: bool) -> None:
    line = tn.catalogue("three-shaft-cardan")
    for x in (("speed", 0.5, 2, 21), ("HookeJoint 1.angle", -0.6, 0.6, 41)):
        chart = tn.stability_chart(line, x, (parameter, low, high, 21), speed=None if x[0] == "speed" else 1.0)
        assert (f"{parameter} changes nothing in this line" in chart.remarks) is idle


def test_an_idle_parameter_of_a_family_is_said() -> None:
    def plain(tau, a, b):
        return np.eye(1), np.full((1, 1), 0.1), (a + 0 * tau)[..., None, None]

    family = tn.PeriodicLinearFamily(np.pi, plain, 1, {"a": 1.0, "b": 1.0})
    chart = tn.stability_chart(family, ("a", 0.5, 2, 20), ("b", 0, 1, 10))
    assert chart.remarks == ("b changes nothing in this family",)


def test_points_of_a_family_that_fail_leave_the_others() -> None:
    def half(tau, a, b):
        with np.errstate(invalid="ignore"):
            return np.eye(1), np.full((1, 1), 0.1), (np.sqrt(a) + b * np.cos(2 * tau))[..., None, None]

    family = tn.PeriodicLinearFamily(np.pi, half, 1, {"a": 1.0, "b": 1.0})
    chart = tn.stability_chart(family, ("a", -1, 2, 30), ("b", 0, 1, 20))
    assert np.array_equal(chart.verdict == Verdict.FAILED, np.broadcast_to(chart.x < 0, chart.verdict.shape))
    assert "200 points failed; at a = -1, b = 0: the coefficients are not finite" in chart.remarks[-1]


@pytest.mark.parametrize("points", [40, pytest.param(300, marks=pytest.mark.slow)])
def test_stiff_beside_soft_is_decided(points: int) -> None:
    """Coefficients of 1e4 times the stiffness hide what the matrix shows; their roots alone left 9 % undecided."""
    y = ("Shaft 2.stiffness", 1e-4, 1e4, points, "log")
    chart = tn.stability_chart(_uneven_pair(), ("speed", 1, 2, points), y)
    assert chart.count(Verdict.UNDECIDED) < 0.02 * chart.verdict.size
    assert chart.at(1.5, 3e3).verdict is Verdict.STABLE


def test_zoom_keeps_the_spacing_unless_told() -> None:
    damping = ("factor of Shaft *.damping", 0.01, 100, 50, "log")
    chart = tn.stability_chart(_uneven_pair(), ("speed", 0.5, 2, 60), damping)
    assert chart.zoom((0.6, 1, 5), (0.1, 10, 5)).y == pytest.approx(np.geomspace(0.1, 10, 5))
    assert chart.zoom((0.6, 1, 5), (0.1, 10, 5, "linear")).y == pytest.approx(np.linspace(0.1, 10, 5))
    narrow = tn.stability_chart(_uneven_pair(), ("speed", 1.4, 1.4, 1), ("HookeJoint 1.angle", 0, 1, 20))
    assert narrow.zoom((1.4, 1.4, 1), (0, 1, 5)).verdict.shape == (5, 1)


REFUSED = [
    (lambda c: c.at(np.array([1, 2]), 1), "a = array([1, 2]): must be one number"),
    (lambda c: c.at("1", 1), "must be one number"),
    (lambda c: c.zoom(("a", 1.0, 5), (0, 1, 3)), "must be (low, high, points)"),
    (lambda c: c.zoom((1, float("nan"), 5), (0, 1, 3)), "must be (low, high, points)"),
    (lambda c: c.zoom((1, 1.5, 5.7), (0, 1, 3)), "a = 5.7: must be a whole number of points"),
    (lambda c: c.zoom((0, 1.5, 5, "log"), (0, 1, 3)), "cannot start at or below zero"),
    (lambda c: tn.stability_chart(MATHIEU, ("a", 0, 1, 5), ("q", 0, 1, 5), speed=5), "belongs to drivelines"),
    (
        lambda c: tn.stability_chart(
            tn.PeriodicLinearFamily(1.0, _mathieu, 1, {"a": 1, "q": 1}), ("a", 0, 1, 5), ("q", 0, 1, 5)
        ),
        "family.period = 1: is not a period of K",
    ),
    (
        lambda c: tn.stability_chart(
            tn.PeriodicLinearFamily(np.pi, _mathieu, 1, {"a": 1, "q": 1, "z": 2}), ("a", 0, 1, 5), ("q", 0, 1, 5)
        ),
        "it is called as coefficients(tau, a, q, z)",
    ),
    (
        lambda c: tn.stability_chart(_uneven_pair(), ("speed", 1, 2, 5), ("factor of HookeJoint 1.angle", 1, 5.5, 5)),
        "would bend HookeJoint 1 by 94.538°",
    ),
    (
        lambda c: tn.stability_chart(_uneven_pair(), ("speed", 1, 2, 5), ("HookeJoint 1.angle", 0, 30, 5)),
        'numbers are radians: write "30 deg"',
    ),
    (
        lambda c: tn.stability_chart(_uneven_pair(), ("speed", -2, 2, 5), ("HookeJoint 1.angle", 0, 0.1, 5)),
        "speed.range = -2: cannot be negative",
    ),
]


@pytest.mark.parametrize(("call", "words"), REFUSED, ids=[words for _, words in REFUSED])
def test_refused_in_one_line(call, words: str) -> None:
    chart = tn.stability_chart(MATHIEU, ("a", 0, 4, 12), ("q", 0, 3, 9))
    with pytest.raises(tn.InputError) as caught:
        call(chart)
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_an_angle_axis_is_clipped_at_both_ends() -> None:
    chart = tn.stability_chart(_uneven_pair(), ("speed", 1, 2, 5), ("HookeJoint 1.angle", -np.pi / 2, np.pi / 2, 7))
    assert chart.remarks[0].startswith("the HookeJoint 1.angle axis starts at -89° instead of -90° and ends at 89°")
