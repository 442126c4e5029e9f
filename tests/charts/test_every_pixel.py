"""Every pixel of a chart against the direct kernel, whatever the axes; and what a chart does at its limits."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import mathieu_a, mathieu_b

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.floquet.charts import chart_families
from trunnion.floquet.charts.axes import axis
from trunnion.floquet.charts.chart_families import LineFamily, quantities
from trunnion.floquet.charts.chart_pixels import Pixels, judge
from trunnion.numerics.chain import chain_monodromy
from trunnion.numerics.patches import patches
from trunnion.results.chart import StabilityChart
from trunnion.results.verdict import Verdict

Array = NDArray[np.float64]
S1 = {"x": ("speed", 0.02, 2.0), "y": ("HookeJoint 1.angle", 0.0, 1.5)}


def equal_chain(disks: int) -> tn.Driveline:
    """Disks of inertia 1 on shafts of stiffness 1, with a joint between neighbours."""
    elements: list[Any] = [tn.ConstantSpeed()]
    for i in range(disks):
        elements += [tn.Shaft(stiffness=1.0, damping=0.004), tn.Disk(inertia=1.0 + 0.1 * i)]
        if i < disks - 1:
            elements.append(tn.HookeJoint(angle=0.2))
    return tn.Driveline(elements)


def directly(chart: StabilityChart, rows: Any, columns: Any) -> Pixels:
    """Pixels of a chart by the chain kernel at 1e-12, without patches or slabs."""
    assert chart.line is not None
    assembly = assemble(chart.line)
    (across, _), (up, _) = (
        axis(assembly, (name, float(v.min()), float(v.max()), 2 if len(v) > 1 else 1), key)
        for name, v, key in ((chart.x_parameter, chart.x, "x"), (chart.y_parameter, chart.y, "y"))
    )
    speed = float("nan") if chart.speed is None else chart.speed
    family = LineFamily(assembly, across, up, speed, chart.statically_twisted)
    values, bounds = quantities(*family.matrices(chart.x[columns], chart.y[rows], 1e-12, 2))
    return judge(values.T.copy(), bounds.T.copy(), family.size, family.set_aside)


def check(chart: StabilityChart, sample: int | None = None) -> None:
    """Every pixel, or a random sample: the error within its estimate and no verdict wrong."""
    if sample is None:
        rows, columns = (part.ravel() for part in np.indices(chart.verdict.shape))
    else:
        rng = np.random.default_rng(sample)
        rows, columns = rng.integers(len(chart.y), size=sample), rng.integers(len(chart.x), size=sample)
    true = directly(chart, rows, columns)
    radius, error = chart.spectral_radius[rows, columns], chart.error_estimate[rows, columns]
    assert np.isfinite(radius).all()
    # The direct kernel's own error is known too, and is far smaller where the two can be told apart.
    short = np.abs(radius - true.radius) > error + true.error
    assert not short.any(), f"{short.sum()} of {len(rows)} pixels"
    assert np.median(true.error) < np.median(error)
    sure, codes = (true.verdict == Verdict.STABLE) | (true.verdict == Verdict.UNSTABLE), chart.verdict[rows, columns]
    said = (codes == Verdict.STABLE) | (codes == Verdict.UNSTABLE)
    assert np.array_equal(codes[sure & said], true.verdict[sure & said])
    assert np.mean(codes == Verdict.UNDECIDED) < 0.02


@pytest.fixture(scope="module")
def s1_chart() -> StabilityChart:
    """300 × 300 pixels of S1's box."""
    line = tn.catalogue("two-shaft-cardan", damping_ratio=0.001)
    return tn.stability_chart(line, (*S1["x"], 300), (*S1["y"], 300))


def test_every_pixel_of_s1(s1_chart: StabilityChart) -> None:
    assert len(s1_chart.function.patches) > 3
    check(s1_chart)


def test_no_part_of_s1_is_nearly_all_undecided(s1_chart: StabilityChart) -> None:
    assert s1_chart.count(Verdict.UNDECIDED) < 0.005 * s1_chart.verdict.size
    assert s1_chart.count(Verdict.FAILED) == s1_chart.count(Verdict.MARGINAL) == 0
    assert s1_chart.spot_check is not None and s1_chart.spot_check.worst_ratio <= 1


@pytest.mark.parametrize(
    ("disks", "speed", "angle", "shape", "sample"),
    [
        (3, (0.1, 2.0), 1.2, (200, 180), 4000),
        pytest.param(5, (0.3, 2.0), 0.8, (160, 130), 2000, marks=pytest.mark.slow),
        pytest.param(8, (0.3, 2.0), 0.5, (160, 130), 1000, marks=pytest.mark.slow),
    ],
)
def test_speed_and_all_angles(
    disks: int, speed: tuple[float, float], angle: float, shape: tuple[int, int], sample: int
) -> None:
    assert shape[0] * shape[1] >= chart_families.FEWEST_PIXELS
    chart = tn.stability_chart(
        equal_chain(disks), ("speed", *speed, shape[0]), ("HookeJoint *.angle", 0.0, angle, shape[1])
    )
    assert chart.function.patches
    check(chart, sample)


def loaded(disks: int = 3) -> tn.Driveline:
    """A chain with loads at some disks."""
    elements = list(equal_chain(disks).elements)
    heavy = [tn.Disk(inertia=e.inertia, load_torque=0.02) if e.kind == "Disk" else e for e in elements]
    return tn.Driveline(heavy)


@pytest.mark.parametrize(
    ("line", "x", "y", "speed"),
    [
        (
            tn.catalogue("three-shaft-cardan"),
            ("HookeJoint 1.angle", 0.0, 1.2),
            ("HookeJoint 2.angle", 0.0, 1.2),
            1.03,
        ),
        (tn.catalogue("two-shaft-cardan", angle=0.8), ("Shaft 2.stiffness", 0.2, 5.0), ("speed", 0.2, 2.0), None),
        (loaded(), ("Disk 3.load_torque", -0.1, 0.2), ("HookeJoint 2.angle", 0.0, 0.9), 1.1),
        (loaded(4), ("Disk 2.inertia", 0.4, 3.0), ("Shaft 2.fork_offset", -1.5, 1.5), 0.9),
    ],
    ids=["angle × angle", "stiffness × speed", "load × angle", "inertia × fork"],
)
def test_other_axes(line: tn.Driveline, x: tuple[Any, ...], y: tuple[Any, ...], speed: float | None) -> None:
    chart = tn.stability_chart(line, (*x, 70), (*y, 60), speed=speed)
    assert chart.function.patches
    check(chart)


def test_logarithmic_axes() -> None:
    chart = tn.stability_chart(
        tn.catalogue("two-shaft-cardan", angle=0.7),
        ("speed", 0.1, 3.0, 70, "log"),
        ("factor of Shaft *.damping", 0.1, 30.0, 60, "log"),
    )
    assert np.diff(np.log(chart.x)) == pytest.approx(np.log(30) / 69)
    assert chart.function.patches
    check(chart)


class Counted:
    """A function with the number of its calls and of the lanes they were given."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function, self.calls = function, 0

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        self.calls += 1
        return self.function(*arguments, **named)


def test_zoom_equals_a_fresh_chart_and_integrates_nothing(
    s1_chart: StabilityChart, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert not s1_chart.function.direct, "all of S1's box is patched"
    counted = Counted(chain_monodromy.chain_propagator)
    monkeypatch.setattr(chain_monodromy, "chain_propagator", counted)
    monkeypatch.setattr(chart_families, "chain_propagator", counted)
    zoomed = s1_chart.zoom((0.7, 1.1, 150), (0.4, 1.0, 120))
    assert counted.calls == 0
    assert s1_chart.line is not None
    fresh = tn.stability_chart(s1_chart.line, ("speed", 0.7, 1.1, 150), ("HookeJoint 1.angle", 0.4, 1.0, 120))
    assert counted.calls > 0
    assert np.array_equal(zoomed.x, fresh.x) and np.array_equal(zoomed.y, fresh.y)
    apart = np.abs(zoomed.spectral_radius - fresh.spectral_radius)
    assert (apart <= zoomed.error_estimate + fresh.error_estimate).all()
    check(zoomed)


def test_the_critical_multiplier_is_the_one_above_the_axis(s1_chart: StabilityChart) -> None:
    found = s1_chart.critical_multiplier
    assert (found.imag >= 0).all() and (found.imag > 0).any() and (found.real < 0).any()
    np.testing.assert_allclose(np.abs(found), s1_chart.spectral_radius, rtol=1e-12)


def test_zoom_on_the_same_pixels_is_the_identity(s1_chart: StabilityChart) -> None:
    again = s1_chart.zoom((s1_chart.x[0], s1_chart.x[-1], 300), (s1_chart.y[0], s1_chart.y[-1], 300))
    assert np.array_equal(again.spectral_radius, s1_chart.spectral_radius)
    assert np.array_equal(again.verdict, s1_chart.verdict)


@pytest.mark.parametrize("box", [((0.01, 1.0, 5), (0.1, 0.2, 5)), ((0.5, 1.0, 5), (0.1, 1.6, 5))])
def test_zoom_outside_is_refused(s1_chart: StabilityChart, box: tuple[Any, Any]) -> None:
    with pytest.raises(tn.InputError, match="inside the chart"):
        s1_chart.zoom(*box)


def test_save_and_reload_keeps_the_patches(s1_chart: StabilityChart, tmp_path: Path) -> None:
    s1_chart.save(tmp_path / "chart.nc")
    again = tn.load_chart(tmp_path / "chart.nc")
    for name in ("x", "y", "spectral_radius", "error_estimate", "critical_multiplier", "verdict"):
        assert np.array_equal(getattr(again, name), getattr(s1_chart, name)), name
    assert len(again.function.patches) == len(s1_chart.function.patches)
    rng = np.random.default_rng(3)
    for x, y in zip(rng.uniform(0.03, 2.0, 40), rng.uniform(0.0, 1.5, 40), strict=True):
        before, after = s1_chart.at(x, y), again.at(x, y)
        assert before.interpolated and after.interpolated
        assert before.error_estimate == pytest.approx(after.error_estimate, rel=1e-6)
        assert before.verdict == after.verdict
        assert abs(before.spectral_radius - after.spectral_radius) <= 1e-3 * before.error_estimate
    zoomed = again.zoom((0.7, 1.1, 30), (0.4, 1.0, 20))
    before = s1_chart.zoom((0.7, 1.1, 30), (0.4, 1.0, 20))
    assert (np.abs(zoomed.spectral_radius - before.spectral_radius) <= 1e-3 * before.error_estimate).all()


@pytest.mark.parametrize(("x", "y"), [(0.01, 0.5), (2.1, 0.5), (1.0, -0.1), (1.0, 1.51), (np.nan, 0.5)])
def test_no_answer_outside(s1_chart: StabilityChart, x: float, y: float) -> None:
    with pytest.raises(tn.InputError, match="outside the chart"):
        s1_chart.at(x, y)


def mathieu(tau: Array, a: Array, q: Array) -> tuple[Array, Array, Array]:
    """x″ + (a − 2q cos 2τ) x = 0."""
    return np.eye(1), np.zeros((1, 1)), (a - 2 * q * np.cos(2 * tau))[..., None, None]


@pytest.mark.slow
def test_mathieus_chart() -> None:
    """Verdicts between the characteristic values a_r, b_r of the tables; marginal elsewhere."""
    family = tn.PeriodicLinearFamily(np.pi, mathieu, 1, {"a": 1.0, "q": 0.5})
    chart = tn.stability_chart(family, x=("a", -1.0, 6.0, 60), y=("q", 0.1, 1.5, 50))
    assert chart.function.patches
    edges = np.array([[mathieu_a(0, q), *sum(((mathieu_b(r, q), mathieu_a(r, q)) for r in range(1, 5)), ())]
                      for q in chart.y])  # fmt: skip
    inside = np.sum(chart.x[None, :, None] > edges[:, None, :], axis=2) % 2 == 0
    near = np.abs(chart.x[None, :, None] - edges[:, None, :]).min(axis=2) < 1e-6
    unstable = chart.verdict == Verdict.UNSTABLE
    # Where a tongue is narrower than the chart can resolve, it may call it marginal, never the reverse.
    assert not (unstable & ~inside & ~near).any()
    missed = inside & ~unstable & ~near
    assert missed.mean() < 0.005
    assert set(np.unique(chart.verdict)) <= {Verdict.UNSTABLE, Verdict.MARGINAL}
    rng = np.random.default_rng(2)
    for _ in range(10):
        a, q = float(rng.uniform(-1, 6)), float(rng.uniform(0.1, 1.5))
        point, true = chart.at(a, q), tn.stability(family.system(a=a, q=q))
        assert abs(point.spectral_radius - true.spectral_radius) <= point.error_estimate + true.error_estimate


@pytest.mark.parametrize(
    ("elements", "idle"),
    [
        ([tn.HookeJoint(angle=0.0), tn.Shaft(stiffness=1.0, damping=0.01), tn.Disk(inertia=1.0)], "HookeJoint 1.plane"),
        ([tn.IdealJoint(), tn.Shaft(stiffness=1.0, damping=0.01), tn.Disk(inertia=1.0)], "Shaft 2.fork_offset"),
    ],
    ids=["the plane of a straight joint", "a fork where no joint is"],
)
def test_idle_parameters_that_enter_the_numbers_are_said(elements, idle) -> None:
    line = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1.0, damping=0.01), tn.Disk(inertia=1.0), *elements])
    chart = tn.stability_chart(line, ("speed", 0.5, 1.0, 5), (idle, 0.0, 1.0, 4))
    assert [r for r in chart.remarks if "changes nothing" in r] == [f"{idle} changes nothing in this line"]


def test_a_parameter_that_changes_nothing_is_said() -> None:
    line = tn.catalogue("two-shaft-cardan")
    axes = ("speed", 0.5, 1.0, 5), ("Disk 2.load_torque", 0.0, 1.0, 4)
    straight = tn.stability_chart(line, *axes, statically_twisted=False)
    assert any("Disk 2.load_torque changes nothing" in r for r in straight.remarks)
    assert np.ptp(straight.spectral_radius, axis=0).max() < 1e-9
    twisted = tn.stability_chart(line, *axes)
    assert not any("changes nothing" in r for r in twisted.remarks)
    assert np.ptp(twisted.spectral_radius, axis=0).max() > 1e-6


def test_axis_of_one_point() -> None:
    line = tn.catalogue("two-shaft-cardan")
    row = tn.stability_chart(line, ("speed", 0.2, 2.0, 40), ("HookeJoint 1.angle", 0.7, 0.7, 1))
    assert row.verdict.shape == (1, 40)
    check(row)
    single = tn.stability_chart(line, ("speed", 0.9, 0.9, 1), ("HookeJoint 1.angle", 0.7, 0.7, 1))
    here = tn.stability(tn.catalogue("two-shaft-cardan", angle=0.7), 0.9)
    assert single.spectral_radius[0, 0] == pytest.approx(here.spectral_radius, abs=1e-8)
    assert row.at(0.77, 0.7).error_estimate < 1e-5


def test_right_angle_is_clipped_and_said() -> None:
    chart = tn.stability_chart(
        tn.catalogue("two-shaft-cardan"), ("speed", 0.5, 2.0, 20), ("HookeJoint 1.angle", 0.5, np.pi / 2, 20)
    )
    assert chart.y[-1] == pytest.approx(np.deg2rad(89.0))
    assert any("ends at 89° instead of 90°" in r for r in chart.remarks)
    assert np.isfinite(chart.spectral_radius).all()
    check(chart)


def test_without_a_period_refused() -> None:
    with pytest.raises(tn.InputError, match="period"):
        tn.PeriodicLinearFamily(0.0, mathieu, 1, {"a": 1.0, "q": 0.5})
    with pytest.raises(tn.InputError, match="period"):
        tn.PeriodicLinearFamily(np.inf, mathieu, 1, {"a": 1.0, "q": 0.5})


def test_patches_that_do_not_converge_fall_back(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(patches, "MOST_EVALUATIONS", 3000)
    chart = tn.stability_chart(
        tn.catalogue("two-shaft-cardan"), ("speed", 0.05, 2.0, 120), ("HookeJoint 1.angle", 0.0, 1.4, 100)
    )
    assert chart.function.unconverged > 0 and chart.function.direct
    assert any("did not converge" in r for r in chart.remarks)
    check(chart)


def test_slabs_that_do_not_converge_fall_back(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(patches, "MOST_EVALUATIONS", 1000)
    chart = tn.stability_chart(
        tn.catalogue("two-shaft-cardan"), ("speed", 0.02, 2.0, 160), ("HookeJoint 1.angle", 0.0, 1.5, 130)
    )
    assert chart.function.unconverged > 0
    check(chart, 2000)
