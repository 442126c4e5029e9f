"""Frames of motions against closed forms, dense matrices and equations written here, and against space itself: the arms
of a cross are at right angles at every moment, which leaves a joint's output no other angle."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigh

import trunnion as tn
from trunnion.animation.movement import Movement
from trunnion.animation.scenery import DrawnPart


def only(animation) -> tuple[tuple[DrawnPart, ...], Movement]:
    shown = animation.motions[0]
    return shown.parts, shown.movements[0]


def part(parts: tuple[DrawnPart, ...], name: str) -> DrawnPart:
    return next(one for one in parts if one.name == name and one.shape != "tie")


def arms(cross: DrawnPart, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Directions of both arms of a cross in space (frame, 3), of the angles of all stations as they are."""
    found = []
    for k, frame in enumerate((cross.frame, cross.back)):
        own = angle[:, cross.stations[k]] - cross.turned[k]
        found.append(np.cos(own)[:, None] * frame[1] + np.sin(own)[:, None] * frame[2])
    return found[0], found[1]


def jointed(**more) -> tn.Driveline:
    joints = {"plane": "25 deg"} | more
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.HookeJoint(angle="18 deg", name="first"),
            tn.Shaft(stiffness=1200.0, fork_offset="12 deg", name="tube"),
            tn.Disk(inertia=0.05),
            tn.HookeJoint(angle="24 deg", name="second", **joints),
            tn.Shaft(stiffness=900.0, damping=0.8, name="rear"),
            tn.Disk(inertia=0.4, load_torque=20.0, name="load"),
        ]
    )


def test_crosses_close_at_every_moment_of_a_turn() -> None:
    parts, turning = only(tn.animate(jointed(), "turning", speed=40.0))
    for name, bend in (("first", 18.0), ("second", 24.0)):
        cross = part(parts, name)
        one, other = arms(cross, turning.angle)
        assert np.abs((one * other).sum(axis=1)).max() < 1e-12
        assert np.degrees(np.arccos(cross.frame[0] @ cross.back[0])) == pytest.approx(bend)
    assert turning.rigid[-1, 0] - turning.rigid[0, 0] == pytest.approx(2 * np.pi)
    # The second shaft ends where one turn leaves it, however unevenly it got there.
    assert np.ptp(turning.rigid[-1] - turning.rigid[0]) < 1e-9
    assert np.ptp(np.diff(turning.rigid[:, -1])) > 1e-3


def test_crosses_close_with_a_joint_of_constant_velocity_between() -> None:
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.HookeJoint(angle="15 deg", name="first"),
            tn.Shaft(stiffness=1e3),
            tn.Disk(inertia=0.1),
            tn.IdealJoint(angle="20 deg", plane="40 deg"),
            tn.Shaft(stiffness=1e3),
            tn.Disk(inertia=0.1),
            tn.HookeJoint(angle="21 deg", plane="-30 deg", name="second"),
            tn.Disk(inertia=0.3),
        ]
    )
    parts, turning = only(tn.animate(line, "turning", speed=40.0))
    for name in ("first", "second"):
        one, other = arms(part(parts, name), turning.angle)
        assert np.abs((one * other).sum(axis=1)).max() < 1e-12


def test_a_mode_is_that_of_dense_matrices() -> None:
    inertia, stiffness = np.array([0.3, 0.05, 1.1, 0.2]), np.array([900.0, 2500.0, 400.0])
    elements = [tn.Disk(inertia=inertia[0], name="d0", drive_share=1.0)]
    for k, one in enumerate(stiffness):
        elements += [tn.Shaft(stiffness=one, name=f"s{k}"), tn.Disk(inertia=inertia[k + 1], name=f"d{k + 1}")]
    twist = np.diff(np.eye(4), axis=0)
    squares, shapes = eigh(twist.T @ np.diag(stiffness) @ twist, np.diag(inertia))
    for number in (1, 2, 3):
        parts, mode = only(tn.animate(tn.Driveline(elements), "mode", mode=number))
        shape = shapes[:, number] / shapes[np.abs(shapes[:, number]).argmax(), number]
        frequency = np.sqrt(squares[number])
        assert mode.time[-1] == pytest.approx(2 * np.pi / frequency, rel=1e-9)
        swing = np.cos(frequency * mode.time)
        for k in range(4):
            drawn = mode.deviation[:, part(parts, f"d{k}").stations[0]]
            assert np.allclose(drawn, swing * shape[k], atol=1e-9)
        for k in range(3):
            spring = part(parts, f"s{k}").spring
            assert np.allclose(mode.torque[:, spring], swing * stiffness[k] * (shape[k + 1] - shape[k]), atol=1e-6)


def test_the_response_is_that_of_dense_matrices() -> None:
    speed, order, amplitude = 37.0, 3, 12.0
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=2000.0, damping=1.5, name="front"),
            tn.Disk(inertia=0.2, name="near", excitation=[{"order": order, "amplitude": amplitude, "phase": 0.7}]),
            tn.Shaft(stiffness=800.0, damping=0.4, name="back"),
            tn.Disk(inertia=0.5, name="far", load_torque=15.0),
        ]
    )
    mass, k1, k2, c1, c2 = np.diag([0.2, 0.5]), 2000.0, 800.0, 1.5, 0.4
    stiff, damp = (np.array([[a + b, -b], [-b, b]]) for a, b in ((k1, k2), (c1, c2)))
    nu = order * speed
    static = np.linalg.solve(stiff, np.array([0.0, -15.0]))
    torque = amplitude * np.exp(1j * (0.7 + order * static[0]))  # its angle is the disk's, twisted as that is
    dynamic = np.linalg.solve(stiff + 1j * nu * damp - nu**2 * mass, np.array([torque, 0.0]))
    parts, response = only(tn.animate(line, "response", speed=speed))
    wave = np.exp(1j * nu * response.time)
    for k, name in enumerate(("near", "far")):
        drawn = response.deviation[:, part(parts, name).stations[0]]
        assert np.allclose(drawn, static[k] + (dynamic[k] * wave).real, atol=1e-9)
    spring = part(parts, "front").spring
    torque = k1 * static[0] + ((k1 + 1j * nu * c1) * dynamic[0] * wave).real
    assert np.allclose(response.torque[:, spring], torque, atol=1e-7)


def test_true_motions_keep_their_crosses_closed_and_their_springs_honest() -> None:
    line = jointed()
    for what, more in (("motion", {"speed": 40.0}), ("run-up", {"speeds": (20.0, 60.0), "acceleration": 40.0})):
        parts, motion = only(tn.animate(line, what, **more))
        for name in ("first", "second"):
            one, other = arms(part(parts, name), motion.angle)
            assert np.abs((one * other).sum(axis=1)).max() < 1e-7, what
        tube = part(parts, "tube")  # without a damper: its torque is its stiffness times its twist
        ends = [motion.angle[:, s] - off for s, off in zip(tube.stations, tube.turned, strict=True)]
        assert np.allclose(motion.torque[:, tube.spring], 1200.0 * (ends[1] - ends[0]), atol=1e-5), what


def test_the_true_motion_is_the_linear_one_where_that_holds() -> None:
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.HookeJoint(angle="3 deg"),
            tn.Shaft(stiffness=900.0, damping=2.0),
            tn.Disk(inertia=0.1, load_torque=5.0),
        ]
    )
    true, linear = (only(tn.animate(line, what, speed=30.0))[1] for what in ("motion", "response"))
    for k in range(true.angle.shape[1]):
        between = np.interp(true.time, linear.time, linear.deviation[:, k])
        assert np.abs(true.deviation[:, k] - between).max() < 2e-5


def test_a_disturbance_obeys_the_equations_written_out() -> None:
    """J₁q̈₁ + c₁q̇₁ + k₁q₁ = ηT, J₂q̈₂ = −T, T = k₂u + c₂u̇ with the twist u = q₂ − ηq₁; q = Re[p e^{λt}], so that
    every derivative is λp + ṗ."""
    j1, k1, c1, j2, k2, c2, bend = 1.0, 1.0, 0.002, 1.0, 1.0, 0.002, 0.5
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=k1, damping=c1),
            tn.Disk(inertia=j1, name="one"),
            tn.HookeJoint(angle=bend),
            tn.Shaft(stiffness=k2, damping=c2, name="rear"),
            tn.Disk(inertia=j2, name="two"),
        ]
    )
    speeds = np.linspace(0.5, 1.8, 53)
    growth = [tn.stability(line, float(v)).growth_rate for v in speeds]
    at = float(speeds[int(np.argmax(growth))])
    animation = tn.animate(line, "disturbance", speed=at)
    shown = animation.motions[0].movements
    assert [one.title for one in shown] == ["grows", "decays"]
    assert shown[0].growth.real == pytest.approx(max(growth), rel=1e-6)
    parts = animation.motions[0].parts
    places = [part(parts, name).stations[0] for name in ("one", "two")]
    for one, speed in zip(shown, (at, None), strict=True):
        period, count = one.time[-1], len(one.time) - 1
        speed = speed or np.pi / period  # half a turn of the joint
        rate = 2j * np.pi * np.fft.fftfreq(count, 1 / count) / period

        def slope(p: np.ndarray, by: complex = one.growth, rate: np.ndarray = rate) -> np.ndarray:
            return by * p + np.fft.ifft(rate * np.fft.fft(p))

        q1, q2 = (one.deviation[:-1, place] for place in places)
        chi = speed * one.time[:-1]
        eta = np.cos(bend) / (1 - np.sin(bend) ** 2 * np.cos(chi) ** 2)
        twist = q2 - eta * q1
        torque = k2 * twist + c2 * slope(twist)
        first = j1 * slope(slope(q1)) + c1 * slope(q1) + k1 * q1 - eta * torque
        second = j2 * slope(slope(q2)) + torque
        assert np.abs(first).max() < 1e-6 * np.abs(q1).max()
        assert np.abs(second).max() < 1e-6 * np.abs(q2).max()
        assert np.allclose(one.torque[:-1, part(parts, "rear").spring], k2 * twist, atol=1e-9)
        assert one.deviation[0, places].real.max() > 0.1


def test_massless_shafts_share_their_twist() -> None:
    with pytest.warns(tn.errors.InputRemark):
        line = tn.Driveline(
            [
                tn.ConstantSpeed(),
                tn.Shaft(stiffness=1000.0, name="soft", damping=1.0),
                tn.Shaft(stiffness=3000.0, name="stiff", damping=1.0),
                tn.Disk(inertia=0.4, name="load", load_torque=30.0),
            ]
        )
    parts, response = only(tn.animate(line, "response", speed=20.0))
    ends = part(parts, "soft").stations
    assert response.deviation[:, ends[1]] == pytest.approx(
        0.75 * response.deviation[:, part(parts, "load").stations[0]]
    )


def test_what_slips_is_drawn_as_it_is() -> None:
    """Behind a clutch that slips, the rigid part follows what slips: a large rotation is not exaggerated."""
    line = tn.Driveline(
        [
            tn.Disk(inertia=1.0, drive_share=1.0, name="motor"),
            tn.Shaft(stiffness=2000.0, damping=2.0),
            tn.Disk(inertia=0.2),
            tn.SlipClutch(torque=20.0, name="clutch"),
            tn.Disk(inertia=2.0, name="load"),
        ],
        scenarios=[
            tn.Scenario(
                name="blow",
                duration=0.4,
                speed=50.0,
                torque=[tn.AppliedTorque(on="load", torque=[0.0, -200.0], time=[0.0, 0.05], hold=True)],
            )
        ],
    )
    parts, motion = only(tn.animate(line, "transient", scenario="blow"))
    clutch = part(parts, "clutch").stations
    slip = motion.angle[:, clutch[1]] - motion.angle[:, clutch[0]]
    assert abs(slip[-1] - slip[0]) > 0.5
    assert np.abs(motion.deviation).max() < 0.1


def test_both_legs_of_a_differential_turn_one_way_in_space() -> None:
    line = tn.load("examples/passenger-car.toml")
    parts, turning = only(tn.animate(line, "turning"))
    legs = [part(parts, name) for name in ("half shaft left", "half shaft right")]
    axes = []
    for leg in legs:
        e, u, v = leg.frame
        rate = turning.rigid[1, leg.stations[0]] - turning.rigid[0, leg.stations[0]]
        axes.append(np.sign(rate) * np.linalg.det(leg.frame) * e)
    assert axes[0] @ axes[1] == pytest.approx(1.0)
    assert legs[0].frame[0] @ legs[1].frame[0] == pytest.approx(-1.0)


def test_frames_of_members_are_those_of_kinetostatics() -> None:
    from trunnion.response.kinetostatics.chain import chain
    from trunnion.response.kinetostatics.frames import member_frames

    line = jointed()
    parts, _ = only(tn.animate(line, "turning", speed=40.0))
    frames = member_frames(chain(line))
    assert np.allclose(part(parts, "tube").frame, frames[1])
    assert np.allclose(part(parts, "rear").frame, frames[2])


@pytest.mark.parametrize("name", ["truck", "six-cylinder-ship", "passenger-car", "four-wheel-drive", "gear-stage"])
def test_every_element_is_drawn_and_every_number_is_one(name: str) -> None:
    line = tn.load(f"examples/{name}.toml")
    animation = tn.animate(line, "response")
    parts, response = only(animation)
    assert {one.element for one in parts} == set(range(len(line.elements)))
    assert np.isfinite(response.angle).all()
    assert np.isfinite(response.torque).all()
    assert all(np.isfinite(one.at).all() and np.allclose(one.frame @ one.frame.T, np.eye(3)) for one in parts)
    assert all(s < response.angle.shape[1] for one in parts for s in one.stations)
    assert animation.scene["choices"][0]["movements"][0]["frames"] == len(response.time)
