"""Charts of lines too long for groups of multipliers, against their modes and against every pixel by itself."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles.long_trees import random_tree

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.floquet.charts.axes import axis
from trunnion.floquet.charts.chart_families import LineFamily
from trunnion.floquet.charts.chart_pixels import judge_matrices
from trunnion.floquet.charts.matrix_interpolation import matrix_patches
from trunnion.numerics.chain import chain_monodromy
from trunnion.numerics.patches.patches import Box

ANGLES = "factor of HookeJoint *.angle"


def uniform(inertias: int, damping: float = 0.05) -> tn.Driveline:
    """Shafts and disks alike, two joints of 1 rad times the factor; hardly damped, so that it has tongues."""
    elements: list[Any] = [tn.ConstantSpeed()]
    for i in range(inertias):
        elements += [tn.Shaft(stiffness=2e5, damping=damping), tn.Disk(inertia=0.1)]
        if i in (2, inertias // 2):
            elements.append(tn.HookeJoint(angle=1.0))
    return tn.Driveline(elements)


def charted(line: tn.Driveline, speeds: tuple[float, float], angles: tuple[float, float], size: Any) -> Any:
    return tn.stability_chart(line, ("speed", *speeds, size[0]), (ANGLES, *angles, size[1]), threads=1)


def test_a_random_tree_between_pixels_against_its_modes() -> None:
    """Branches, gears and joints; modes by Hill's blocks share neither integration nor interpolation."""
    line = random_tree(4, 20, 21, driven=True)
    chart = charted(line, (150.0, 158.0), (0.3, 1.2), (40, 20))
    assert chart.function.patches and not chart.function.direct and chart.way == "patches"
    bends = {name: e.angle for name, e in zip(line.names, line.elements, strict=True) if e.kind == "HookeJoint"}
    rng = np.random.default_rng(7)
    for _ in range(6):
        speed, factor = float(rng.uniform(150.0, 158.0)), float(rng.uniform(0.3, 1.2))
        bent = line
        for name, angle in bends.items():
            bent = bent.replace(name, angle=factor * angle)
        point, true = chart.at(speed, factor), tn.stability(bent, speed)
        assert abs(point.spectral_radius - true.spectral_radius) <= point.error_estimate + true.error_estimate
        assert point.error_estimate < 1e-6 and point.verdict == true.verdict and point.interpolated


def test_every_pixel_against_integration() -> None:
    """Tongues narrower than the distance of nodes among them."""
    line, size = uniform(14), (90, 10)
    chart = charted(line, (250.0, 330.0), (0.1, 0.45), size)
    assert chart.function.patches and not chart.function.direct
    assembly = assemble(line)
    across, up = (axis(assembly, (p, v[0], v[-1], 2), "x")[0] for p, v in (("speed", chart.x), (ANGLES, chart.y)))
    family = LineFamily(assembly, across, up, float("nan"), True, half_windows=False)
    found = judge_matrices(*family.matrices(np.tile(chart.x, size[1]), np.repeat(chart.y, size[0]), 1e-12, 1))
    off = np.abs(found.radius - chart.spectral_radius.ravel())
    assert np.all(off <= chart.error_estimate.ravel() + found.error)
    unstable = chart.spectral_radius > 1
    assert 0.02 < unstable.mean() < 0.9 and np.array_equal(unstable, (found.radius > 1).reshape(unstable.shape))


# the second with a mesh whose stiffness varies
@pytest.mark.parametrize("seed", [13, pytest.param(30, marks=pytest.mark.slow)])
def test_errors_of_coarse_charts_hold_and_are_of_use(seed: int) -> None:
    """Every pixel integrated by itself, at random against modes by Hill's blocks; the kernel's own bounds say a hundred
    times as much and more."""
    line = random_tree(seed, 20, 22, driven=True)
    assert (seed == 30) == any(e.kind == "GearPair" for e in line.elements)
    chart = charted(line, (150.0, 300.0), (0.3, 1.2), (8, 6))
    assert chart.function.direct and np.median(chart.error_estimate) < 2e-8 and chart.error_estimate.max() < 1e-7
    bends = {name: e.angle for name, e in zip(line.names, line.elements, strict=True) if e.kind == "HookeJoint"}
    rng = np.random.default_rng(seed)
    for row, column in zip(rng.integers(0, 6, 5), rng.integers(0, 8, 5), strict=True):
        bent = line.replace_all({name: {"angle": chart.y[row] * angle} for name, angle in bends.items()})
        true = tn.stability(bent, float(chart.x[column]))
        off = abs(chart.spectral_radius[row, column] - true.spectral_radius)
        assert off <= chart.error_estimate[row, column] + true.error_estimate


@pytest.mark.parametrize("half", [True, False])
def test_one_column_at_a_time_as_all_of_them(half: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both kernels of plain chains, of slow and fast points beside each other."""
    assembly = assemble(uniform(14))
    across, up = axis(assembly, ("speed", 50.0, 900.0, 2), "x")[0], axis(assembly, (ANGLES, 0.1, 0.9, 2), "y")[0]
    family = LineFamily(assembly, across, up, float("nan"), True, half_windows=half)
    batch = family.batch(np.geomspace(50.0, 900.0, 20), np.linspace(0.1, 0.9, 20))
    found, error, trace = family._integrated(batch, 1e-10, 1)
    monkeypatch.setattr(chain_monodromy, "SHORT", 1000)
    other, bound, damping = family._integrated(batch, 1e-10, 1)
    assert not np.array_equal(found, other)
    assert (np.linalg.norm(found - other, axis=(1, 2)) <= error + bound).all() and error.max() < 2 * bound.max()
    assert trace == pytest.approx(damping, rel=1e-12)


def test_columns_of_a_tree_as_all_of_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """Branches and gears, joints behind each other."""
    assembly = assemble(random_tree(4, 20, 21, driven=True))
    across, up = axis(assembly, ("speed", 60.0, 300.0, 2), "x")[0], axis(assembly, (ANGLES, 0.1, 1.2, 2), "y")[0]
    family = LineFamily(assembly, across, up, float("nan"), True, half_windows=False)
    assert np.any(np.diff(family.program.parent) != 1) and not family.needs_stages
    batch = family.batch(np.geomspace(60.0, 300.0, 18), np.linspace(0.1, 1.2, 18))
    found, error, trace = family._integrated(batch, 1e-11, 1)
    monkeypatch.setattr(chain_monodromy, "SHORT", 1000)
    other, bound, damping = family._integrated(batch, 1e-11, 1)
    assert (np.linalg.norm(found - other, axis=(1, 2)) <= np.minimum(error + bound, 1e-10)).all()
    assert trace == pytest.approx(damping, rel=1e-12)


def test_nodes_are_as_well_known_as_they_say_where_less_is_asked_of_the_kernel() -> None:
    """Matrices by half periods at points by chance, against whole periods as sharp as the kernel goes; fast modes are
    damped, so that the kernel's bounds are far too large."""
    assembly, tolerance = assemble(uniform(20, 10.0)), 2.5e-10
    across, up = axis(assembly, ("speed", 60.0, 330.0, 2), "x")[0], axis(assembly, (ANGLES, 0.1, 0.45, 2), "y")[0]
    family = LineFamily(assembly, across, up, float("nan"), True)
    asked = family.sampled_to(tolerance)
    assert asked > 10 * tolerance
    rng = np.random.default_rng(5)
    x, y = rng.uniform(60.0, 330.0, 40), rng.uniform(0.1, 0.45, 40)
    found, error, _ = family.matrices(x, y, asked, 1)
    sharp, _, _ = family.over_whole_periods()._integrated(family.batch(x, y), 1e-14, 1)
    off = np.linalg.norm(found - sharp, axis=(1, 2))
    assert np.all(off <= error) and error.max() < tolerance


def turning(rate: float) -> Any:
    """Matrices with a known wave, and what else ``matrix_patches`` samples."""

    def sample(u: Any, v: Any) -> Any:
        c, s = np.exp(v) * np.cos(rate * u), np.exp(v) * np.sin(rate * u)
        return np.stack([np.stack([c, s], 1), np.stack([-s, c], 1)], 1), np.zeros(len(u)), 1 + 0 * u

    return sample


@pytest.mark.parametrize("rate, patches", [(30.0, 1), (600.0, 4)])
def test_a_wave_is_known_to_the_error_stated(rate: float, patches: int) -> None:
    """Between nodes too; waves too short for one grid are divided along their direction alone."""
    box, sample, shares = Box(0.0, 1.0, -0.5, 0.5), turning(rate), list[float]()
    function = matrix_patches(sample, box, 2, 1e-10, np.inf, np.inf, shares.append)
    assert function is not None and len(function.patches) == patches
    assert shares == sorted(shares) and shares[-1] == pytest.approx(1.0)
    rng = np.random.default_rng(0)
    u, v = rng.random(50), rng.random(50) - 0.5
    true = sample(u, v)[0].reshape(50, -1)
    for at, value in zip(zip(u, v, strict=True), true, strict=True):
        patch = function.find(*at)
        assert patch is not None
        here = tuple(np.array([one]) for one in at)
        off = np.linalg.norm(patch.grid(*here)[:4, 0, 0] - value)
        assert off <= np.linalg.norm(patch.error_grid(*here)[:4, 0, 0]) < 1e-8


def test_a_grid_that_costs_too_much_is_not_taken() -> None:
    """By number of matrices, and by memory."""
    box = Box(0.0, 1.0, -0.5, 0.5)
    assert matrix_patches(turning(30.0), box, 2, 1e-10, 100, np.inf, lambda share: None) is None
    assert matrix_patches(turning(30.0), box, 2, 1e-10, np.inf, 1e4, lambda share: None) is None
