"""Extremes and spectra against closed forms, the exact motion within stages, and fine samples."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import trunnion as tn
from trunnion.numerics.curves import extremes, extremes_in, fourier

Array = NDArray[np.float64]
MESH_ORDERS = Path(__file__).parents[1] / "data" / "mesh_orders.toml"
"""Fixed numbers of samples read order 1.4237 with 5.775 N m in its mesh torque, where there is nothing."""


def test_extremes_between_samples_and_on_both_sides_of_a_jump() -> None:
    def curves(t: Array) -> Array:
        swings = np.sin(14 * np.pi * t) + 0.3 * np.cos(62 * np.pi * t + 0.2)
        return np.stack([swings, t * (1 - t), np.ones_like(t), np.where(t < 0.3, -t, 1 - t)], axis=1)

    cuts = np.sort(np.append(np.linspace(0, 1, 198), 0.3))
    found = extremes(curves, cuts)
    fine = np.linspace(0, 1, 400_001)
    swings = curves(fine)[:, 0]
    np.testing.assert_allclose(found.low, [swings.min(), 0, 1, -0.3], rtol=0, atol=1e-8)
    np.testing.assert_allclose(found.high, [swings.max(), 0.25, 1, 0.7], rtol=0, atol=1e-8)
    assert abs(found.high_at[1] - 0.5) < 1e-4 and abs(found.high_at[3] - 0.3) < 1e-6
    assert np.all(found.error < 1e-8)
    edges = np.array([0.0, 0.21, 0.5, 1.0])
    inside = extremes_in(curves, cuts, edges)
    for i in range(3):
        kept = swings[(fine >= edges[i]) & (fine <= edges[i + 1])]
        np.testing.assert_allclose([inside.low[i, 0], inside.high[i, 0]], [kept.min(), kept.max()], rtol=0, atol=1e-8)


@pytest.mark.parametrize("highest", [0, 3, 60, 700])
def test_fourier_coefficients_of_a_series_and_of_a_step(highest: int) -> None:
    rng = np.random.default_rng(highest)
    truth = rng.normal(size=61) + 1j * rng.normal(size=61)
    truth[0] = truth[0].real
    cuts = np.sort(np.concatenate([[2.0, 5.0], 2 + 3 * rng.random(300)]))

    def curves(t: Array) -> Array:
        turns = np.exp(2j * np.pi * np.outer((t - 2) / 3, np.arange(61)))
        return np.stack([(turns @ truth).real, t < 2.9], axis=1)

    found = fourier(curves, np.sort(np.append(cuts, 2.9)), highest)
    wanted = np.zeros(max(highest + 1, 61), dtype=complex)
    wanted[:61] = truth
    np.testing.assert_allclose(found[:, 0], wanted[: highest + 1], rtol=0, atol=1e-11)
    k = np.arange(1, highest + 1)
    step = 2 * (1 - np.exp(-0.6j * np.pi * k)) / (2j * np.pi * k)
    np.testing.assert_allclose(found[:, 1], [0.3, *step], rtol=0, atol=1e-12)


def mesh_orders(**parts: object) -> tn.Driveline:
    """The line of the file, or one without its joints, or with other teeth."""
    line = tn.load(MESH_ORDERS)
    elements = list(line.elements)
    if parts.pop("straight", False):
        elements = [e for e in elements if not isinstance(e, tn.HookeJoint)]
    elements = [e.model_copy(update=parts) if isinstance(e, tn.GearPair) else e for e in elements]
    return tn.Driveline(elements)


def closed_form(order: float, amplitude: float, speed: float = 12.0) -> Array:
    """Torque amplitudes of the straight line under one harmonic of its transmission error: (K + iωC − ω²J) φ = forces.

    Rotations of the four disks; the mesh u = r₁φ₂ − r₂φ₃ − e pushes with (k + iωc) u along the line of action.
    """
    omega, base = order * speed, 3e-3 * np.cos(np.deg2rad(20)) / 2
    first, second, third = 8e3 + 4j * omega, 8e3 + 4j * omega, 5e3 + 2j * omega
    mesh, r = 2e7 + 900j * omega, np.array([0, 34 * base, -59 * base, 0])
    matrix = -(omega**2) * np.diag([0.05, 0.05, 0.05, 0.2]) + mesh * np.outer(r, r)
    for k, pair in ((first, [1, 0, 0, 0]), (second, [-1, 1, 0, 0]), (third, [0, 0, -1, 1])):
        matrix = matrix + k * np.outer(pair, pair)
    phi = np.linalg.solve(matrix, mesh * amplitude * r)
    push = mesh * (r @ phi - amplitude)
    return np.abs([first * phi[0], second * (phi[1] - phi[0]), push * 59 * base, third * (phi[3] - phi[2])])


def test_mesh_orders_of_a_straight_line_are_those_of_the_closed_form() -> None:
    response = tn.periodic_response(mesh_orders(straight=True), 12.0, compare=False)
    orders, amplitude = response.order_spectrum(140)
    np.testing.assert_allclose(orders, [0, 34, 68, 102, 136], rtol=1e-12)
    np.testing.assert_allclose(amplitude[1], closed_form(34, 3e-6), rtol=1e-9)
    np.testing.assert_allclose(amplitude[2], closed_form(68, 2e-5), rtol=1e-9)
    assert np.all(amplitude[3:] < 1e-9)
    np.testing.assert_allclose(response.torque_mean, [-50 * 34 / 59] * 2 + [-50.0] * 2, rtol=1e-9)


def elsewhere(turns: int, tooth: int, count: int, teeth: tuple[int, int]) -> NDArray[np.bool_]:
    """Orders, in steps of one cycle a period, that no mesh order makes with up to eight cycles of each joint."""
    free = np.ones(count, dtype=bool)
    first, second, mesh = 2 * turns, 2 * turns * teeth[0] // teeth[1], turns * teeth[0]
    for a in range(-8, 9):
        for b in range(-8, 9):
            for m in range(-4, 5) if abs(a) + abs(b) <= 8 else ():
                k = abs(a * first + b * second + m * mesh) // tooth
                if k < count:
                    free[k] = False
    return free


@pytest.mark.parametrize("teeth", [(20, 30), pytest.param((34, 59), marks=pytest.mark.slow)], ids=["20:30", "34:59"])
def test_nothing_folds_back_on_the_orders_of_a_long_period(teeth: tuple[int, int]) -> None:
    response = tn.periodic_response(mesh_orders(teeth_in=teeth[0], teeth_out=teeth[1]), 12.0, compare=False)
    orders, amplitude = response.order_spectrum(2 * teeth[0] + 2)
    if teeth == (34, 59):
        assert response.turns == pytest.approx(29.5)
        free = elsewhere(teeth[1], 2, len(orders), teeth)
        assert free.sum() > len(orders) / 2
        assert amplitude[free].max() < 1e-9
        # Bent joints of 0.1 rad move the order by their second order.
        np.testing.assert_allclose(amplitude[round(68 * 29.5)], closed_form(68, 2e-5), rtol=1e-4)
    # Against plain sums over far more samples than the highest order has.
    orbit, count = response.orbit, 1 << 17
    times = orbit.period * np.arange(count) / count
    torque = response.line.observe(orbit.system, times, orbit.trajectory.at(times)).torque
    sampled = 2 * np.abs(np.fft.rfft(torque, axis=0)[1 : len(orders)]) / count
    np.testing.assert_allclose(amplitude[1:], sampled, rtol=1e-6, atol=1e-9)
    # Of a cycle of the highest order they hit the top to (π/samples)²/2.
    coarse = (np.pi * 2 * teeth[0] * response.turns / count) ** 2 / 2
    np.testing.assert_allclose(response.torque_peak_to_peak, np.ptp(torque, axis=0), rtol=max(1e-4, coarse))
    assert np.all(response.torque_peak_to_peak >= np.ptp(torque, axis=0) - 1e-9)


def gear_line(seed: int) -> tuple[tn.Driveline, float]:
    """A line with a mesh of imperfect teeth, with or without backlash, and a speed."""
    rng = np.random.default_rng(seed)

    def between(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    def shaft() -> tn.Shaft:
        return tn.Shaft(stiffness=between(3e3, 3e4), damping=between(1, 10))

    law, gap = str(rng.choice(["always", "in contact", "never pulling"])), float(rng.choice([0.0, 2e-5]))
    mesh = tn.GearPair(
        teeth_in=int(rng.integers(17, 40)), teeth_out=int(rng.integers(17, 60)), module=3e-3,
        mesh_stiffness=between(1e7, 1e8), mesh_damping=between(300, 3000),
        damping_law=law if gap else "always", backlash=gap,
        transmission_error=[
            {"amplitude": between(1e-6, 2e-5), "order": order, "phase": float(rng.uniform(0, 6))} for order in (1, 2, 3)
        ],
    )  # fmt: skip
    loads = [tn.Disk(inertia=between(0.02, 0.2), load_torque=between(5, 100)) for _ in range(2)]
    line = [tn.ConstantSpeed(), shaft(), tn.Disk(inertia=between(0.01, 0.1)), mesh, loads[0], shaft(), loads[1]]
    return tn.Driveline(line), between(10, 100)


@pytest.mark.parametrize("seed", [*range(4), *(pytest.param(s, marks=pytest.mark.slow) for s in range(4, 50))])
def test_extremes_of_random_gear_lines_are_those_of_the_exact_motion(seed: int) -> None:
    line, speed = gear_line(seed)
    exact = tn.exact_motion(line, np.pi / speed, speed=speed)
    run = tn.simulate(line, np.pi / speed, speed=speed)
    span = exact.torque_high - exact.torque_low
    np.testing.assert_allclose(run.torque_extremes.low, exact.torque_low, rtol=0, atol=1e-6 * span.min())
    np.testing.assert_allclose(run.torque_extremes.high, exact.torque_high, rtol=0, atol=1e-6 * span.min())
    assert str(exact.springs[0]) in str(exact) and f"{exact.torque_low[0]:.6g}" in str(run)


def test_a_simulation_tells_the_extremes_of_the_times_asked_for() -> None:
    def ringing(t, x, p):  # type: ignore[no-untyped-def]
        return x[1], -x[0] - 0.2 * x[1]

    system = tn.System.from_function(ringing, 2, start=(1.0, 0.0), compiled=False)
    late = tn.simulate(system, times=np.array([11.0, 11.5, 20.0]))
    peaks = np.exp(-0.1 * np.pi * np.arange(8) / np.sqrt(0.99))
    at = np.pi * np.arange(8) / np.sqrt(0.99)
    inside = peaks[(at > 11) & (at < 20)]
    assert max(abs(late.range[0][0]), late.range[1][0]) == pytest.approx(inside.max(), rel=1e-8)


def test_orders_of_a_long_period_have_bars_that_can_be_seen() -> None:
    """A period of 26 turns has 313 orders up to 12, most of them empty: the others leave room for wide bars."""
    from types import SimpleNamespace

    from trunnion.pictures.draw_matplotlib import draw
    from trunnion.pictures.motion import orders as described

    orders = np.arange(313) / 26
    amplitude = np.zeros((313, 2))
    amplitude[[26, 42, 78]] = [[3.0, 1.0], [200.0, 90.0], [20.0, 1e-3]]
    axes = draw(described(SimpleNamespace(shafts=("a", "b"), order_spectrum=lambda highest: (orders, amplitude))))
    widths = [bar.get_width() for bar in axes.patches]
    assert len(widths) == 6 and min(widths) > 12 / 200
    assert axes.get_xlim()[0] == 0 and axes.get_xlim()[1] >= 12
