"""The kernels behind charts of stiff and of long lines, each against another method."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.floquet.charts import chart_pixels
from trunnion.floquet.charts.axes import axis
from trunnion.floquet.charts.chart_families import LineFamily
from trunnion.numerics.batch import BATCH
from trunnion.numerics.chain.eigenvalues_in_rows import conditions, eigenvalues_in_rows

KINDS = ("random", "orthogonal", "graded", "blocks", "repeated", "companion", "zero")


def some_matrices(kind: str, m: int, count: int) -> np.ndarray:
    rng = np.random.default_rng(m)
    a = rng.standard_normal((count, m, m)) / np.sqrt(m)
    if kind == "orthogonal":
        a = np.linalg.qr(a)[0]
    elif kind == "graded":
        units = 10.0 ** rng.uniform(-2, 2, m)
        a *= units[:, None] / units[None, :]
    elif kind == "blocks":  # parts in the middle from the start
        a[:, m // 2 :, : m // 2] = 0
    elif kind == "repeated":
        turn = np.linalg.qr(a)[0]
        a = turn @ np.diag(np.repeat(np.arange(1.0, m / 2 + 1), 2)) @ turn.transpose(0, 2, 1)
    elif kind == "companion":  # x^m = 1: Francis's first shifts lead nowhere
        a = np.broadcast_to(np.roll(np.eye(m), 1, axis=0), a.shape)
    elif kind == "zero":
        a = np.zeros_like(a)
    return np.ascontiguousarray(a)


def found_in_rows(a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    count, m = a.shape[:2]
    values, hessenberg = np.empty((m, count, 2)), np.empty_like(a)
    eigenvalues_in_rows(np.ascontiguousarray(a.reshape(count, -1).T), m, values, hessenberg)
    return (values[..., 0] + 1j * values[..., 1]).T, hessenberg


@pytest.mark.parametrize("m", [4, 8, 16, 24])
@pytest.mark.parametrize("kind", KINDS)
def test_eigenvalues_are_those_of_a_matrix_this_near(kind: str, m: int) -> None:
    """Each makes A − λ singular to rounding, and their sums and products are trace and determinant."""
    a = some_matrices(kind, m, BATCH + 5)
    values, hessenberg = found_in_rows(a)
    norm = np.linalg.norm(a, axis=(1, 2)) + 1e-300
    least = np.linalg.svd(a[:, None] - values[..., None, None] * np.eye(m), compute_uv=False)[..., -1]
    assert np.all(least <= 1e-14 * norm[:, None])
    assert np.all(np.abs(values.sum(axis=1) - np.trace(a, axis1=1, axis2=2)) <= 1e-13 * norm)
    scale = np.maximum(norm**m, 1e-300)
    assert np.all(np.abs(values.prod(axis=1) - np.linalg.det(a)) <= 1e-13 * scale)
    assert np.all(np.tril(hessenberg, -2) == 0)


def test_how_sensitive_an_eigenvalue_is() -> None:
    a = some_matrices("graded", 8, 40)
    values, hessenberg = found_in_rows(a)
    chosen = np.take_along_axis(values, np.abs(values).argmax(axis=1)[:, None], axis=1)[:, 0]
    out = np.empty(len(a))
    conditions(hessenberg, chosen, out)
    for matrix, value, condition in zip(a, chosen, out, strict=True):
        every, right = np.linalg.eig(matrix)
        which = np.abs(every - value).argmin()
        left = np.linalg.inv(right)[which]
        assert condition == pytest.approx(np.linalg.norm(left) * np.linalg.norm(right[:, which]), rel=1e-3)


def test_not_numbers_are_given_back() -> None:
    a = some_matrices("random", 8, 3)
    a[1, 2, 3] = np.nan
    values, _ = found_in_rows(a)
    assert np.isnan(values[1]).all() and np.isfinite(values[[0, 2]]).all()


def test_many_pixels_are_judged_as_few_are(monkeypatch: pytest.MonkeyPatch) -> None:
    """By the kernel or by the library: the same radius within the errors stated, of free lines too."""
    a = some_matrices("graded", 8, 60)
    rows = np.concatenate([a.reshape(60, -1).T, np.ones((1, 60))])
    bounds = np.full_like(rows, 1e-12)
    for set_aside in (0, 2):
        by_library = chart_pixels.judge(rows, bounds, 4, set_aside)
        monkeypatch.setattr(chart_pixels, "FEW", 0)
        by_kernel = chart_pixels.judge(rows, bounds, 4, set_aside)
        monkeypatch.undo()
        assert np.all(np.abs(by_kernel.radius - by_library.radius) <= by_library.error)
        assert by_kernel.error == pytest.approx(by_library.error, rel=1e-3)


def _gears(damping: float) -> tn.Driveline:
    """Two joints in a row with a ratio between, a load by speed, a mesh that varies, an inertia between joints."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=400.0, damping=damping, fork_offset=0.4),
            tn.HookeJoint(angle=0.3, plane=0.2),
            tn.Disk(inertia=0.5),
            tn.Shaft(stiffness=9e4, damping=damping),
            tn.Disk(inertia=0.02, load_torque=5.0),
            tn.GearPair(teeth_in=3, teeth_out=6, module=0.01, mesh_stiffness=4e7, stiffness_variation=[{"share": 0.2}]),
            tn.Disk(inertia=0.03),
            tn.HookeJoint(angle=0.25),
            tn.Shaft(stiffness=2e3, damping=damping),
            tn.Disk(inertia=1.0, load_torque=12.0),
            tn.TripodJoint(angle=0.2, radius=0.03, length=0.4),
            tn.Shaft(stiffness=3e3, damping=damping),
            tn.Disk(inertia=0.7, load_torque=30.0),
        ]
    )


@pytest.mark.parametrize("damping", [0.0, 0.8])
def test_exponentials_are_what_runge_and_kutta_integrate(damping: float) -> None:
    assembly = assemble(_gears(damping))
    x, _ = axis(assembly, ("speed", 60.0, 120.0, 2), "x")
    y, _ = axis(assembly, ("HookeJoint 1.angle", 0.0, 0.3, 2), "y")
    family = LineFamily(assembly, x, y, float("nan"), True, half_windows=False)
    at = np.linspace(60.0, 120.0, BATCH + 3), np.linspace(0.0, 0.3, BATCH + 3)
    z, _, trace = family.matrices(*at, 1e-12, 1)
    found, own = family.exponentials(*at).monodromies(np.arange(len(z)), 1024)
    norm = np.linalg.norm(z, axis=(1, 2))
    assert np.all(np.linalg.norm(found - z, axis=(1, 2)) <= 1e-7 * norm)
    assert own == pytest.approx(trace, abs=1e-8)
    halved, _ = family.exponentials(*at).monodromies(np.arange(len(z))[::-1].copy(), 512)
    change = np.linalg.norm(halved[::-1] - z, axis=(1, 2))
    assert np.all(np.linalg.norm(found - z, axis=(1, 2)) <= np.maximum(change / 20, 1e-10 * norm))  # order 6


def test_steps_that_are_far_too_long_are_not_numbers() -> None:
    line = tn.Driveline(
        [tn.ConstantSpeed(), tn.Shaft(stiffness=1e30), tn.HookeJoint(angle=0.3), tn.Disk(inertia=1e-3)]
        + [tn.Shaft(stiffness=1.0), tn.Disk(inertia=1.0)]
    )
    assembly = assemble(line)
    x, _ = axis(assembly, ("HookeJoint 1.angle", 0.1, 0.3, 2), "x")
    y, _ = axis(assembly, ("Shaft 2.stiffness", 1.0, 2.0, 2), "y")
    z, _ = (
        LineFamily(assembly, x, y, 1.0, True)
        .exponentials(np.array([0.2]), np.array([1.0]))
        .monodromies(np.arange(1), 8)
    )
    assert not np.isfinite(z).any()
