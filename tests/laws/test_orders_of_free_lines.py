"""Orders of free–free lines with joint angles, about their own motion: against the nonlinear periodic motion."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.response.orders.response import response_about

ENGINE = ((3.0, 20.0, 0.3), (2.0, 30.0, 0.0), (0.5, 5.0, 1.0))


def chain(scale, bend=1.0, viscous=0.2):
    excitation = [{"order": k, "amplitude": a * scale, "phase": p} for k, a, p in ENGINE]
    return tn.Driveline(
        [
            tn.Disk(inertia=0.35, name="engine", drive_share=1, excitation=excitation),
            tn.Shaft(stiffness=6e3, damping=6, name="clutch"),
            tn.Disk(inertia=0.05, name="flange"),
            tn.HookeJoint(angle=0.2 * bend, name="joint 1"),
            tn.Shaft(stiffness=2e4, damping=4, name="tube", fork_offset=0.4),
            tn.HookeJoint(angle=0.15 * bend, name="joint 2"),
            tn.Disk(inertia=0.04, name="pinion"),
            tn.Shaft(stiffness=8e3, damping=9, name="half shaft"),
            tn.Disk(inertia=1.3, name="wheel", load_torque=40.0, viscous_load=viscous),
        ]
    )


def branched(scale, bend=1.0):
    excitation = [{"order": 1.5, "amplitude": 12.0 * scale}, {"order": 4, "amplitude": 9.0 * scale, "phase": 0.5}]
    return tn.Driveline(
        [
            tn.Disk(inertia=0.3, name="engine", drive_share=1, excitation=excitation),
            tn.Shaft(stiffness=9e3, damping=6, name="front"),
            tn.Disk(inertia=0.06, name="case"),
            tn.HookeJoint(angle=0.18 * bend),
            tn.Shaft(stiffness=1.5e4, damping=4, name="rear shaft"),
            tn.Disk(inertia=0.05, name="pinion"),
            tn.Ratio(ratio=-2),
            tn.Shaft(stiffness=9e3, damping=9, name="axle"),
            tn.Disk(inertia=1.1, name="wheel", load_torque=40.0, quadratic_load=0.02),
            tn.Shaft(stiffness=5e3, damping=3, name="side", after="case"),
            tn.Disk(inertia=0.2, name="pump", viscous_load=0.1),
        ]
    )


def difference(line, speed):
    """Largest difference of any order of any spring's torque from that of the nonlinear motion [N m]."""
    linear = tn.order_response(line, [speed])
    order, amplitude = tn.periodic_response(line, speed, tolerance=1e-11).order_spectrum(8.0)
    worst = 0.0
    for k, row in zip(order[1:], amplitude[1:], strict=True):
        at = np.flatnonzero(np.isclose(linear.spectrum.order_numbers, k, atol=1e-9))
        torque = linear.spectrum.amplitude[0][:, linear.spectrum.channels.torque]
        ours = np.abs(torque[at[0]]) if len(at) else np.zeros(len(row))
        worst = max(worst, float(np.abs(ours - row).max()))
    return worst


@pytest.mark.parametrize("make", [chain, branched])
def test_the_difference_falls_with_the_square_of_the_excitation_at_full_angles(make):
    """Linear about the own motion: at angles of 11°, what is left out is of second order in the excitation alone."""
    large, small = (difference(make(scale), 100.0) for scale in (0.1, 0.01))
    assert small < 1e-4
    assert 1.95 < np.log10(large / small) < 2.2


def test_without_excitation_it_is_the_own_motion_itself():
    line = chain(0.0)
    found = tn.order_response(line, [100.0])
    motion = tn.periodic_response(line, 100.0, tolerance=1e-11)
    assert found.vibratory_torque[0] == pytest.approx(np.asarray(motion.torque_peak_to_peak) / 2, rel=1e-7)
    assert any("Nothing excites this line but its joints" in str(f) for f in found.findings)


@pytest.mark.parametrize("viscous", [0.0, 0.2])
def test_straight_joints_give_the_straight_line(viscous):
    """The singular mean orders, bordered, go over into the rigid turning of a straight free line."""
    bent = tn.order_response(chain(1.0, 1e-5, viscous), [80.0, 130.0], orders=[0.5, 2.0, 3.0])
    straight = tn.order_response(chain(1.0, 0.0, viscous), [80.0, 130.0], orders=[0.5, 2.0, 3.0])
    assert bent.torque == pytest.approx(straight.torque, rel=1e-7)
    assert bent.rotation == pytest.approx(straight.rotation, rel=1e-6, abs=1e-9)


def test_a_torque_fixed_in_time_is_that_of_a_straight_line_where_joints_are():
    shaken = [{"frequency": 333.0, "amplitude": 20.0}]
    bent, straight = (
        tn.order_response(chain(0.0, bend).replace("engine", excitation=shaken), [100.0]) for bend in (1e-5, 0.0)
    )
    at = [int(np.flatnonzero((r.order == 0) & (r.frequency > 0))[0]) for r in (bent, straight)]
    assert bent.torque[:, at[0]] == pytest.approx(straight.torque[:, at[1]], rel=1e-7)


def test_a_line_with_stages_is_refused_with_a_way_out():
    line = chain(1.0)
    parts = list(line.elements)
    parts[1] = tn.PiecewiseShaft.symmetric([(4e3, 0.02), (9e3, None)], damping=5, name="clutch")
    with pytest.raises(tn.InputError, match="is free–free and has joint angles.*tn.periodic_response"):
        tn.order_response(tn.Driveline(parts), [100.0])


def test_a_bent_free_line_is_judged():
    line = tn.Driveline(chain(1.0).elements, limits=[tn.Limit(of="tube", max_torque=100.0)])
    check = tn.assess(line, (100.0, 100.0)).check("max torque of tube")
    assert check.value == pytest.approx(tn.order_response(line, [100.0]).peak_torque[0, 1], rel=1e-9)
    assert np.isfinite(check.margin)


def geared(error: float, teeth: tuple[int, int], angle: float) -> tn.Driveline:
    """Free: motor, gear stage with a transmission error, joint, load."""
    return tn.Driveline(
        [
            tn.Disk(inertia=1.0, drive_share=1, name="motor", excitation=[{"order": 2, "amplitude": 5.0}]),
            tn.Shaft(stiffness=2e4, damping=5.0, name="a"),
            tn.Disk(inertia=0.1, name="pinion"),
            tn.GearPair(
                name="mesh", teeth_in=teeth[0], teeth_out=teeth[1], module=0.004, mesh_stiffness=5e8,
                mesh_damping=2000.0, transmission_error=[{"order": 1, "amplitude": error}],
            ),
            tn.Disk(inertia=0.3, name="wheel"),
            tn.HookeJoint(angle=angle, name="joint"),
            tn.Shaft(stiffness=1e4, damping=5.0, name="b"),
            tn.Disk(inertia=0.8, load_torque=100.0, name="load"),
        ]
    )  # fmt: skip


@pytest.mark.parametrize("angle", [0.05, 0.5])
def test_a_transmission_error_counts_once(angle: float) -> None:
    """Its order and its neighbours, of a line whose own motion may have so many harmonics itself."""
    line = geared(1e-5, (12, 24), angle)
    linear = tn.order_response(line, [60.0])
    order, amplitude = tn.periodic_response(line, 60.0, compare=False).order_spectrum(14)
    for k in (2, 10, 11, 12, 13, 14):
        (true,) = amplitude[np.isclose(order, k), 1]
        found = np.abs(linear.torque[0, np.isclose(linear.order, k), 1])
        assert found.sum() == pytest.approx(true, rel=2e-3, abs=1e-4)


def test_orders_of_teeth_without_a_common_divisor_are_those_of_the_mesh_and_the_joints() -> None:
    """26/29 of the input behind the gear: orders m·26/29, and about 2 and the 13th of the mesh."""
    line = geared(1e-5, (13, 29), 0.05)
    found = tn.order_response(line, [60.0])
    real = np.abs(found.torque[0, :, 1]) > 1e-6
    for k in found.order[real]:
        away = (k - np.array([0.0, 2.0, 13.0])) / (26 / 29)
        assert np.abs(away - np.round(away)).min() < 1e-9 and abs(k) < 20
    assert found.order[np.abs(found.torque[0, :, 1]).argmax()] == 13


@pytest.mark.slow
def test_a_transmission_error_makes_no_line_unstable() -> None:
    """It is not part of the equations of disturbances, but of the amplitudes."""
    for teeth in ((12, 24), (13, 29)):
        for angle in (0.05, 0.5):
            quiet, loud = (tn.stability(geared(e, teeth, angle), 60.0) for e in (0.0, 1e-5))
            assert loud.verdict is quiet.verdict
            assert loud.spectral_radius == pytest.approx(quiet.spectral_radius, abs=1e-7)
            with_error = tn.order_response(geared(1e-5, teeth, angle), [60.0]).vibratory_torque[0]
            assert loud.response.torque_amplitude == pytest.approx(with_error, rel=1e-6)
            assert np.any(with_error > 1.01 * quiet.response.torque_amplitude)


def lossy(angle: float, scale: float = 1.0, eta: float = 0.1) -> tn.Driveline:
    """Two masses, a joint on the first, a shaft whose loss factor holds at all frequencies."""
    shaken = [{"order": 1.5, "amplitude": 25.0 * scale, "phase": 0.6}]
    return tn.Driveline(
        [
            tn.Disk(inertia=0.3, name="motor", drive_share=1, excitation=shaken),
            tn.HookeJoint(angle=angle),
            tn.Shaft(stiffness=5e3, loss_factor=eta, name="shaft"),
            tn.Disk(inertia=0.4, name="load"),
        ]
    )


@pytest.mark.parametrize("speed", [18.0, 55.0, 90.0])
def test_a_loss_factor_of_a_bent_free_line_by_hills_matrix_entry_by_entry(speed: float) -> None:
    """k(1 + iη sgn ν) at every harmonic of the twist q = x₂ − ηx₁ about rigid shafts, without load."""
    beta, order, eta, reach, cycle = 0.35, 1.5, 0.1, 10, np.arange(256) * np.pi / 256
    ratio = np.cos(beta) / (1 - np.sin(beta) ** 2 * np.cos(cycle) ** 2)
    e = np.fft.fft(ratio) / 256
    m = np.arange(-reach, reach + 1)
    nu, size = (order + 2 * m) * speed, len(m)
    transfer = np.array([[e[i - j] for j in range(size)] for i in range(size)])
    stiff = np.diag(5e3 * (1 + 1j * eta * np.sign(nu)))
    a = np.zeros((2 * size, 2 * size), dtype=complex)
    a[:size, :size] = transfer.T.conj() @ stiff @ transfer - np.diag(nu**2 * 0.3)
    a[:size, size:], a[size:, :size] = -transfer.T.conj() @ stiff, -stiff @ transfer
    a[size:, size:] = stiff - np.diag(nu**2 * 0.4)
    right = np.zeros(2 * size, dtype=complex)
    right[reach] = 25.0 * np.exp(0.6j)
    x = np.linalg.solve(a, right)
    torque = stiff @ (x[size:] - transfer @ x[:size])
    folded: dict[float, complex] = {}
    for k, value in zip(order + 2 * m, torque, strict=True):
        folded[abs(k)] = folded.get(abs(k), 0) + (value if k > 0 else np.conj(value))
    wanted = [0.5, 1.5, 2.5, 3.5]
    found = tn.order_response(lossy(beta), [speed], orders=wanted)
    expected = np.array([folded[k] for k in wanted])
    assert found.torque[0, :, 0] == pytest.approx(expected, rel=1e-9, abs=1e-9 * np.abs(expected).max())
    assert any("motion of its rigid shafts" in str(f) for f in found.findings)


def test_the_motion_of_rigid_shafts_serves_as_well_to_first_order() -> None:
    """Against the same line about its own motion: what is left out falls with the square as all causes shrink."""

    def apart(scale: float) -> float:
        line = chain(scale, np.sqrt(scale))
        own = tn.order_response(line, [100.0])
        rigid = response_about(assemble(line), np.array([100.0]), rough=True)
        return float(np.abs(own.vibratory_torque - rigid.vibratory_torque).max())

    large, small = apart(0.1), apart(0.001)
    assert 1.9 < np.log(large / small) / np.log(100)


def test_a_lossy_bent_free_line_is_straight_where_its_joint_is() -> None:
    bent, straight = (tn.order_response(lossy(angle), [20.0, 80.0], orders=[1.5]) for angle in (1e-5, 0.0))
    assert bent.torque == pytest.approx(straight.torque, rel=1e-8)


@pytest.mark.slow
def test_own_equations_integrated_to_the_periodic_state():
    """Three inertias, a joint of 14° and order 3, by scipy: all orders but 6, which is quadratic in the excitation."""
    bend, inertia, cv, nominal = 0.25, (0.4, 0.05, 0.3), 0.5, 80.0
    (k1, c1), (k2, c2) = (8e3, 30.0), (5e3, 20.0)
    half = np.tan(bend / 2) ** 2

    def torques(t, y):
        a1, a2, a3 = (nominal * t + y[i] for i in range(3))
        w1, w2, w3 = (nominal + y[i] for i in range(3, 6))
        ratio = np.cos(bend) / (1 - np.sin(bend) ** 2 * np.cos(a2) ** 2)
        output = a2 + np.arctan2(half * np.sin(2 * a2), 1 - half * np.cos(2 * a2))
        return k1 * (a2 - a1) + c1 * (w2 - w1), k2 * (a3 - output) + c2 * (w3 - ratio * w2), ratio

    def rate(t, y):
        first, second, ratio = torques(t, y)
        turned = 2.0 * np.cos(3 * (nominal * t + y[0]))
        driven = (cv * nominal + turned + first) / inertia[0]
        return [*y[3:], driven, (ratio * second - first) / inertia[1], (-second - cv * (nominal + y[5])) / inertia[2]]

    turn = 2 * np.pi / nominal
    settled = solve_ivp(rate, (0, 400 * turn), np.zeros(6), rtol=1e-10, atol=1e-12, method="DOP853").y[:, -1]
    span = (400 * turn, 440 * turn)
    motion = solve_ivp(rate, span, settled, rtol=1e-11, atol=1e-13, method="DOP853", dense_output=True).sol
    begin = 400.3 * turn

    def turned_by(t):
        return nominal * (t - begin) + motion(t)[1] - motion(begin)[1]

    end = brentq(lambda t: turned_by(t) - 32 * np.pi, begin + 14 * turn, begin + 20 * turn, xtol=1e-13)
    times = begin + np.arange(4096) * (end - begin) / 4096
    found = np.abs([2 * np.fft.rfft(torque)[16:81:16] / 4096 for torque in torques(times, motion(times))[:2]])
    line = tn.Driveline(
        [
            tn.Disk(inertia=inertia[0], drive_share=1, excitation=[{"order": 3, "amplitude": 2.0}]),
            tn.Shaft(stiffness=k1, damping=c1),
            tn.Disk(inertia=inertia[1]),
            tn.HookeJoint(angle=bend),
            tn.Shaft(stiffness=k2, damping=c2),
            tn.Disk(inertia=inertia[2], viscous_load=cv),
        ]
    )
    linear = np.abs(tn.order_response(line, [32 * np.pi / (end - begin)], orders=[1, 2, 3, 4, 5]).torque[0]).T
    np.testing.assert_allclose(found, linear, rtol=2e-6, atol=2e-8 * linear.max())
