"""Turning points of dense output, amplification of a step in closed form, and separations counted on a grid."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.numerics.turning_points import reversals, turning_points


def test_turning_points_are_where_a_derivative_is_zero() -> None:
    """Of sums of harmonics, by the roots of the polynomial that their derivative is in e^{it}."""
    draw, order = np.random.default_rng(11), np.arange(1, 7)
    for _ in range(20):
        size, phase = draw.normal(size=6), draw.uniform(0, 2 * np.pi, 6)
        parts = size * order * np.exp(1j * phase) * 1j / 2
        roots = np.roots([*parts[::-1], 0.0, *np.conj(parts)])
        at = np.sort(np.angle(roots[np.abs(np.abs(roots) - 1) < 1e-6]) % (2 * np.pi))

        def values(times: np.ndarray, size: np.ndarray = size, phase: np.ndarray = phase) -> np.ndarray:
            return (size * np.cos(np.multiply.outer(times, order) + phase)).sum(axis=1, keepdims=True)

        (found,) = turning_points(values, np.linspace(0.0, 2 * np.pi, 13))
        assert len(found.time) == len(at) + 2
        np.testing.assert_allclose(found.value[1:-1], values(at)[:, 0], atol=1e-9)
        np.testing.assert_allclose(found.time[1:-1], at, atol=1e-3)
        assert found.error < 1e-6


def test_a_jump_at_a_cut_stays_as_high_as_it_is() -> None:
    (found,) = turning_points(lambda t: np.where(t < 3.0, t, 5.0 - t)[:, None], np.array([0.0, 1.0, 3.0, 4.0, 10.0]))
    np.testing.assert_allclose(found.value, [0.0, 3.0, -5.0], atol=1e-8)
    assert reversals(np.array([1.0, 1.0, 2.0, 2.0, 1.0, 1.0])).tolist() == [0, 3, 5]


def test_a_load_that_sets_in_at_once_in_closed_form() -> None:
    """T of J φ̈ + c φ̇ + k φ = T₀ from rest, T = kφ + cφ̇: 1 + e^{−ζω t}(…), by its own extremum."""
    stiffness, damping, inertia, load = 1e3, 2.0, 0.4, 100.0
    shaft = tn.Shaft(stiffness=stiffness, damping=damping, name="shaft")
    line = tn.Driveline([tn.ConstantSpeed(), shaft, tn.Disk(inertia=inertia, load_torque=load)])
    found = tn.torque_amplification(tn.simulate(line, speed=20.0, turns=3))
    rate = np.sqrt(stiffness / inertia)
    zeta = damping / (2 * np.sqrt(stiffness * inertia))
    ringing = rate * np.sqrt(1 - zeta**2)
    times = np.linspace(0.0, 2 * np.pi / ringing, 2_000_001)
    step = 1 - np.exp(-zeta * rate * times) * (
        np.cos(ringing * times) - zeta * rate / ringing * np.sin(ringing * times)
    )
    np.testing.assert_allclose(found.factor, step.max(), rtol=1e-7)
    np.testing.assert_allclose(found.nominal, -load, rtol=1e-12)
    np.testing.assert_allclose(found.peak_time, times[step.argmax()], rtol=1e-4)
    assert found.separations.tolist() == [-1] and np.isnan(found.impact_torque[0])
    twice = tn.torque_amplification(tn.simulate(line, speed=20.0, turns=3), {"shaft": 50.0})
    np.testing.assert_allclose(twice.factor, 2 * found.factor, rtol=1e-12)
    idle = line.replace("Disk 1", load_torque=0.0, excitation=[{"order": 1, "amplitude": 5.0}])
    assert np.isnan(tn.torque_amplification(tn.simulate(idle, speed=20.0, turns=3)).factor[0])


def test_separations_of_a_mesh_against_a_fine_grid() -> None:
    mesh = tn.GearPair(
        name="mesh", teeth_in=20, teeth_out=31, module=0.003, mesh_stiffness=1e7, mesh_damping=500.0, backlash=1e-4
    )
    pinion = tn.Disk(inertia=0.1, excitation=[{"order": 1, "amplitude": 20.0}])
    line = tn.Driveline(
        [tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=5), pinion, mesh, tn.Disk(inertia=0.2, load_torque=2.0)]
    )
    run = tn.simulate(line, speed=tn.rpm(1500), turns=10)
    found = tn.torque_amplification(run)
    times = np.linspace(0.0, run.end, 200_001)
    twist = run.motion_at(times).twist[:, 1]
    # Contact where the twist leaves the play of 1e-4 m at the base radius of the driven gear, to either side.
    radius = 0.5 * 0.003 * 31 * np.cos(np.deg2rad(20))
    touching = np.abs(twist) > 0.5e-4 / radius
    landed = np.flatnonzero(touching[1:] & ~touching[:-1]) + 1
    assert found.separations[1] == len(landed) > 3
    torque = run.torque_at(times)[:, 1]
    ends = [*np.flatnonzero(~touching[1:] & touching[:-1]).tolist(), len(times) - 1]
    tops = []
    for i in landed:
        part = np.abs(torque[i : next(end for end in ends if end >= i) + 1])
        falling = np.flatnonzero(np.diff(part) < 0)
        tops.append(part[falling[0]] if len(falling) else part[-1])
    np.testing.assert_allclose(abs(found.impact_torque[1]), max(tops), rtol=1e-3)


def test_refusals() -> None:
    line = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e3, name="shaft"), tn.Disk(inertia=0.4)])
    run = tn.simulate(line, speed=20.0, turns=1)
    with pytest.raises(tn.InputError, match="nominal = 'shft': is not a shaft of this motion"):
        tn.torque_amplification(run, {"shft": 1.0})
    with pytest.raises(tn.InputError, match="must be finite"):
        tn.torque_amplification(run, {"shaft": float("nan")})
    with pytest.raises(tn.InputError, match="is a Driveline, not a motion of a line"):
        tn.torque_amplification(line)
