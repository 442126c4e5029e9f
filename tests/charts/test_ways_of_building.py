"""Every way of building a chart is forced once, by breaking the one before, and its pixels are compared."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.floquet.charts import building, chart_families
from trunnion.floquet.charts.axes import axis
from trunnion.floquet.charts.chart_families import LineFamily
from trunnion.floquet.charts.chart_pixels import judge_matrices
from trunnion.numerics.patches import patches
from trunnion.results.chart import StabilityChart
from trunnion.results.verdict import Verdict

Array = NDArray[np.float64]
X, Y = ("speed", 0.2, 1.4), ("Shaft 2.fork_offset", 0.0, np.pi / 2)


def line() -> tn.Driveline:
    """Two joints between three inertias; symmetric where the fork offset is a multiple of a quarter turn."""
    shaft, bend = tn.Shaft(stiffness=1.0, damping=0.004), tn.HookeJoint(angle=0.5)
    disk = tn.Disk(inertia=1.0)
    return tn.Driveline([tn.ConstantSpeed(), shaft, disk, bend, shaft, disk, bend, shaft, disk])


def truth(chart: StabilityChart) -> tuple[Array, Array]:
    """Spectral radius and error of every pixel by direct integration over whole periods."""
    assembly = assemble(line())
    (across, _), (up, _) = (axis(assembly, (*ends, 2), key) for ends, key in ((X, "x"), (Y, "y")))
    family = LineFamily(assembly, across, up, float("nan"), True, half_windows=False)
    x, y = np.tile(chart.x, len(chart.y)), np.repeat(chart.y, len(chart.x))
    found = judge_matrices(*family.matrices(x, y, 1e-12, 2))
    return found.radius.reshape(chart.verdict.shape), found.error.reshape(chart.verdict.shape)


def check(chart: StabilityChart) -> None:
    """Every pixel within its estimate, and few left open."""
    radius, error = truth(chart)
    assert (np.abs(chart.spectral_radius - radius) <= chart.error_estimate + error).all()
    assert chart.count(Verdict.UNDECIDED) <= 0.02 * chart.verdict.size
    assert chart.count(Verdict.FAILED) == 0


def corners_only(box: patches.Box, count: int = 0) -> tuple[Array, Array]:
    """A box seen from its corners, where this line is symmetric."""
    return np.array([box.u0, box.u0, box.u1, box.u1]), np.array([box.v0, box.v1] * 2)


def tails_unseen(transform: Callable[..., Any]) -> Callable[..., Any]:
    """Patches that take themselves for exact after a few coefficients."""

    def blind(values: Array, type: int, axis: int) -> Array:
        coefficients = transform(values, type=type, axis=axis)
        np.moveaxis(coefficients, axis, 0)[5:] = 0.0
        return coefficients

    return blind


def corrupt(monkeypatch: pytest.MonkeyPatch, way: str) -> None:
    """Break every way before this one."""
    monkeypatch.setattr(chart_families, "FEWEST_PIXELS", 0)
    monkeypatch.setattr(chart_families, "FEWEST_SLABS", 1)
    if way == "smaller patches":
        monkeypatch.setattr(chart_families, "spread", corners_only)
    if way == "whole periods":
        monkeypatch.setattr(chart_families, "symmetry_phase", lambda program, batch, period: 0.0)
    if way == "pixel by pixel":
        monkeypatch.setattr(patches, "dct", tails_unseen(patches.dct))


@pytest.mark.parametrize("way", [way.name for way in building.FALLBACKS])
@pytest.mark.slow
def test_each_way_holds_where_those_before_fail(way: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    with monkeypatch.context() as broken:
        corrupt(broken, way)
        chart = tn.stability_chart(line(), (*X, 100), (*Y, 100))
        assert chart.way == way
        assert chart.spot_check is not None and chart.spot_check.worst_ratio <= 1
        first_try = way == building.FALLBACKS[0].name
        assert any("built anew" in remark for remark in chart.remarks) is not first_try
        assert ("built anew" in str(chart)) is not first_try
        chart.save(tmp_path / "c.nc")
        # What answers between the pixels and after a file knows the way too: the faults are still in force.
        saved = tn.load_chart(tmp_path / "c.nc")
        points = [(chart, chart.at(0.7, 0.8)), (saved, saved.at(0.7, 0.8))]
        zoomed = chart.zoom((0.5, 0.9, 30), (0.4, 1.2, 30))
    check(chart)
    check(zoomed)
    true = tn.stability(tn.Driveline([
        type(e)(**{**e.stated, "fork_offset": 0.8}) if n == "Shaft 2" else e
        for n, e in zip(line().names, line().elements, strict=True)
    ]), 0.7)  # fmt: skip
    for one, point in points:
        assert one.way == way
        assert abs(point.spectral_radius - true.spectral_radius) <= point.error_estimate + true.error_estimate


def test_a_chart_that_fails_in_every_way_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """An integration whose answer depends on its tolerance by far more than it says."""
    honest = chart_families.chain_monodromy

    def careless(program: Any, batch: Any, window: Any, tolerance: float, threads: int) -> Any:
        matrix, error, trace = honest(program, batch, window, tolerance, threads)
        return matrix * (1 + 1e3 * tolerance), error, trace

    monkeypatch.setattr(chart_families, "chain_monodromy", careless)
    with pytest.raises(tn.ComputationError, match="failed its own check in each of 4 ways") as caught:
        tn.stability_chart(line(), (*X, 30), (*Y, 30), tolerance=1e-8)
    assert "\n" not in str(caught.value)


def test_a_way_that_is_none_is_refused() -> None:
    with pytest.raises(tn.InputError, match="is not a way of building charts"):
        building.strategy_named("by guesswork")
