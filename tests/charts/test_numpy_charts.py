"""Charts in plain NumPy, as reports show them before kernels are compiled, against the compiled ones."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from oracles.sampling import quick_only

import trunnion as tn
from trunnion.design.limits.result import LimitKind
from trunnion.design.limits.stable_limit import limit_of_chart
from trunnion.equations.coefficients import assemble
from trunnion.floquet.charts import chart_families, cost_model
from trunnion.floquet.charts import stability_chart as stability_chart_module
from trunnion.floquet.charts.building import build
from trunnion.floquet.charts.chart_families import LineFamily
from trunnion.floquet.charts.numpy_chart import build_with_numpy
from trunnion.floquet.charts.numpy_pixels import numpy_radii
from trunnion.floquet.charts.stability_chart import chart_task, stability_chart
from trunnion.numerics.chain.characteristic import radii
from trunnion.papers.entries import catalogue
from trunnion.results.verdict import Verdict

EXAMPLES = Path(__file__).parents[2] / "examples"
ANGLES = "HookeJoint *.angle"


@pytest.fixture
def nothing_compiled(monkeypatch):
    monkeypatch.setattr(chart_families, "is_compiled", lambda *functions: False)


def family(line, low, high, top, points) -> LineFamily:
    axes = ("speed", low, high, points[0]), (ANGLES, 0.0, top, points[1])
    found = chart_task(assemble(line), *axes, None, True).family
    assert isinstance(found, LineFamily)
    return found


LINES = {
    # name: line, speeds, largest angle, points, way
    "truck": (lambda: tn.load(EXAMPLES / "truck.toml"), (31.4, 251.3), 0.26, (40, 24), "patches"),
    "two shafts, tongues": (lambda: catalogue("two-shaft-cardan"), (0.5, 2.0), 0.5, (60, 40), "patches"),
    "two shafts, slow": (lambda: catalogue("two-shaft-cardan"), (0.03, 2.0), 0.5, (40, 20), "pixel by pixel"),
    "three shafts": (lambda: catalogue("three-shaft-cardan"), (0.3, 2.0), 0.4, (40, 30), None),
}


@pytest.mark.parametrize("name", quick_only([name for name in LINES if name != "truck"], LINES))
def test_both_ways_agree(nothing_compiled, name):
    make, speeds, top, points, way = LINES[name]
    chart = family(make(), *speeds, top, points)
    x, y = chart.x.values, chart.y.values
    plain = build_with_numpy(chart, x, y, 1e-7, lambda share: None)
    compiled = build(chart, x, y, 1e-9, 1, lambda share: None).pixels
    assert plain is not None
    assert way in (None, plain.strategy.name)
    assert plain.check.worst_ratio <= 1
    off = np.abs(plain.pixels.radius - compiled.radius)
    assert np.all(off <= plain.pixels.error + compiled.error)
    sure = (plain.pixels.verdict != Verdict.UNDECIDED) & (compiled.verdict != Verdict.UNDECIDED)
    assert np.mean(sure) > 0.99
    assert np.array_equal(plain.pixels.verdict[sure], compiled.verdict[sure])


@pytest.mark.parametrize("m", (2, 4, 6))
def test_radii_of_coefficients_as_the_kernel_finds_them(m):
    rng = np.random.default_rng(m)
    roots = rng.uniform(0.05, 1.1, (200, m // 2)) * np.exp(1j * rng.uniform(0, np.pi, (200, m // 2)))
    roots[:50, 0] = roots[:50, 0].real + 0j  # double real roots, nearly
    every = np.concatenate([roots, roots.conj()], axis=1)
    signs = (-1.0) ** np.arange(1, m + 1)
    values = np.array([signs * np.poly(row).real[1:] for row in every]).T.copy()
    bounds = 10.0 ** rng.uniform(-12, -6, (m, 200))
    values[0, 7] = np.nan
    plain, kernel = numpy_radii(values, bounds), radii(values, bounds)
    there = np.arange(200) != 7
    assert np.isnan(plain[0][7]) and np.isnan(plain[1][7])
    assert np.all(np.abs(plain[0] - kernel[0])[there] <= (plain[1] + kernel[1])[there])
    # The bound holds for coefficients anywhere within theirs, and is not far above the kernel's.
    for _ in range(20):
        moved = numpy_radii(values + bounds * rng.choice([-1.0, 1.0], bounds.shape), np.zeros_like(bounds))[0]
        assert np.all(np.abs(moved - plain[0])[there] <= plain[1][there] + 1e-7 * (np.arange(200) < 50)[there])
    assert np.all(plain[1][there] <= 4 * kernel[1][there] + 1e-12)


@pytest.mark.parametrize(
    ("name", "low", "high", "angle"),
    [("two-shaft-cardan", 1.2, 1.7, 0.5), pytest.param("three-shaft-cardan", 0.6, 2.0, 1.1, marks=pytest.mark.slow)],
)
def test_limits_without_a_compiler_are_those_of_the_kernels(name, low, high, angle, monkeypatch):
    """Edges are solved for by steps in NumPy, as closely as those settle."""
    speeds = np.linspace(low, high, 7)[1:-1]
    axes = ("speed", low, high, 60), (ANGLES, 0.0, angle, 40)
    chart = stability_chart(catalogue(name), *axes, tolerance=1e-9)
    by_kernels = limit_of_chart(chart, speeds)
    monkeypatch.setattr(chart_families, "is_compiled", lambda *functions: False)
    monkeypatch.setattr(chart_families, "compiling_pays", lambda: False)
    monkeypatch.delattr(LineFamily, "matrices")
    plainly = limit_of_chart(chart, speeds)
    assert np.array_equal(plainly.kind, by_kernels.kind) and np.any(plainly.kind == LimitKind.CROSSING)
    assert np.allclose(plainly.limit, by_kernels.limit, rtol=0, atol=1e-7)


def test_what_numpy_has_cost_is_counted_until_compiling_pays(monkeypatch):
    chart = family(catalogue("two-shaft-cardan"), 0.5, 2.0, 0.5, (8, 6))
    x, y = np.array([1.0]), np.array([0.3])
    monkeypatch.setattr(chart_families, "is_compiled", lambda *functions: False)
    monkeypatch.setattr(cost_model, "spent_in_numpy", 0.0)
    monkeypatch.setattr(cost_model, "COMPILING", 10.0)
    assert chart.in_numpy(x, y) is not None and cost_model.spent_in_numpy > 0
    monkeypatch.setattr(cost_model, "COMPILING", 0.0)
    assert chart.in_numpy(x, y) is None


def test_the_first_charts_of_an_installation_take_numpy_and_later_ones_the_kernels(monkeypatch):
    axes = ("speed", 0.8, 2.0, 30), (ANGLES, 0.0, 0.3, 20)
    built = []
    monkeypatch.setattr(
        stability_chart_module, "build_with_numpy", lambda *of: built.append(build_with_numpy(*of)) or built[-1]
    )
    by_kernels = stability_chart(catalogue("two-shaft-cardan"), *axes)
    assert not built  # see conftest: compiling pays in tests
    monkeypatch.setattr(chart_families, "is_compiled", lambda *functions: False)
    monkeypatch.setattr(cost_model, "spent_in_numpy", 0.0)
    monkeypatch.setattr(cost_model, "COMPILING", 10.0)
    first = stability_chart(catalogue("two-shaft-cardan"), *axes)
    assert built[0] is not None and cost_model.spent_in_numpy > 0
    assert np.all(
        np.abs(first.spectral_radius - by_kernels.spectral_radius) <= first.error_estimate + by_kernels.error_estimate
    )
    assert np.array_equal(first.verdict, by_kernels.verdict)
    cost_model.compile_at_once()
    stability_chart(catalogue("two-shaft-cardan"), *axes)
    assert len(built) == 1


def test_what_is_compiled_already_is_used(monkeypatch):
    """And a free–free line is left to the kernels."""
    chart = family(catalogue("two-shaft-cardan"), 0.5, 2.0, 0.5, (8, 6))
    monkeypatch.setattr(chart_families, "is_compiled", lambda *functions: True)
    assert not chart.uncompiled
    assert build_with_numpy(chart, chart.x.values, chart.y.values, 1e-7, lambda share: None) is None


@pytest.mark.slow
def test_the_chart_of_a_report_and_its_limit_compile_no_kernel_of_charts(tmp_path):
    """Only what integrates single points, for its check of itself."""
    script = """
import sys
import trunnion as tn
from numba.core import event
from trunnion.floquet.charts.stability_chart import chart_of_report
from trunnion.design.limits.stable_limit import limit_of_chart
from trunnion.equations.coefficients import assemble

class Heard(event.Listener):
    names = []
    def on_start(self, event):
        Heard.names.append(event.data["dispatcher"].py_func.__module__)
    def on_end(self, event):
        pass

with event.install_listener("numba:compile", Heard()):
    axes = ("speed", 31.4, 251.3, 20), ("HookeJoint *.angle", 0.0, 0.26, 12)
    chart = chart_of_report(assemble(tn.load(sys.argv[1])), *axes, 1e-7)
    limit = limit_of_chart(chart, own=True)
own = sorted({name for name in Heard.names if name.startswith("trunnion")})
print(chart.way, float(limit.smallest) == chart.y[-1], own)
"""
    environment = os.environ | {"TRUNNION_CACHE": str(tmp_path)}
    call = [sys.executable, "-c", script, str(EXAMPLES / "truck.toml")]
    run = subprocess.run(call, env=environment, capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stderr
    assert run.stdout.strip() == "patches True ['trunnion.numerics.chain.dense_monodromy']"
