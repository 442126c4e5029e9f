"""Vehicles and tyres: resistance by hand, and a car on two tyres against equations written out."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.tied_lines import Model

import trunnion as tn

MASS, RADIUS, ROLLING, AREA, GRADE = 1600.0, 0.31, 0.012, 0.65, 0.05
J_CRANK, J_BODY, J_GEAR, J_WHEEL, J_BELT = 0.14, 0.05, 0.004, 0.9, 0.4
K_IN, C_IN, K_LEFT, K_RIGHT, K_TYRE, C_TYRE = 900.0, 2.0, 9e3, 8e3, 1.5e4, 200.0
SLIP, TRAVEL, RATIO, TORQUE = 6e4, 20.0, 7.0, 80.0


def car(slips: bool, **vehicle: float) -> tn.Driveline:
    """An engine, a differential and two tyres that move one vehicle."""
    slip = {"slip_stiffness": SLIP, "radius": RADIUS, "travel_speed": TRAVEL, "inertia": J_BELT} if slips else {}
    tyre = {"stiffness": K_TYRE, "damping": C_TYRE} | slip
    return tn.Driveline(
        [
            tn.Disk(inertia=J_CRANK, drive_share=1, name="crank", excitation=[{"order": 2, "amplitude": TORQUE}]),
            tn.Shaft(stiffness=K_IN, damping=C_IN, name="input"),
            tn.Disk(inertia=J_BODY, name="pinion"),
            tn.Differential(ratio=RATIO, name="axle"),
            tn.Disk(inertia=J_GEAR, name="left gear"),
            tn.Shaft(stiffness=K_LEFT, name="left shaft"),
            tn.Disk(inertia=J_WHEEL, name="left wheel"),
            tn.Tyre(name="left tyre", **tyre),
            tn.Vehicle(mass=MASS, wheel_radius=RADIUS, wheel_inertia=1.8, name="car", **vehicle),
            tn.Disk(inertia=J_GEAR, name="right gear", after="axle.right"),
            tn.Shaft(stiffness=K_RIGHT, name="right shaft"),
            tn.Disk(inertia=J_WHEEL, name="right wheel"),
            tn.Tyre(name="right tyre", to="car", **tyre),
        ]
    )


def written_out(slips: bool) -> tuple[Model, list[str]]:
    """The same with a coordinate for every shaft, and the names of its springs in their order."""
    model, names = Model(), ["input"]
    crank, pinion, case = model.shaft(J_CRANK), model.shaft(J_BODY), model.shaft()
    vehicle = model.shaft(MASS * RADIUS**2 + 1.8)
    model.springs.append((crank, pinion, K_IN, C_IN))
    model.ties.append({pinion: 1.0, case: -RATIO})
    gears = []
    for side, k in (("left", K_LEFT), ("right", K_RIGHT)):
        gear, wheel = model.shaft(J_GEAR), model.shaft(J_WHEEL)
        gears.append(gear)
        model.springs.append((gear, wheel, k, 0.0))
        names += [f"{side} shaft", f"{side} tyre"]
        if slips:
            belt = model.shaft(J_BELT)
            model.springs += [(wheel, belt, K_TYRE, C_TYRE), (belt, vehicle, 0.0, SLIP * RADIUS**2 / TRAVEL)]
            names.append(f"slip of {side} tyre")
        else:
            model.springs.append((wheel, vehicle, K_TYRE, C_TYRE))
    model.ties.append({case: 2.0, gears[0]: -1.0, gears[1]: -1.0})
    return model, names


@pytest.mark.parametrize("slips", [False, True])
def test_a_car_against_equations_with_multipliers(slips: bool) -> None:
    """Frequencies, eigenvalues and torques; no mode of one half of the vehicle against the other."""
    line, (model, names) = car(slips), written_out(slips)
    modes, expected = tn.natural_frequencies(line), model.frequencies()
    np.testing.assert_allclose(modes.undamped_frequency, expected, rtol=1e-9, atol=1e-6 * expected.max())
    assert modes.still == (3 if slips else 1) and modes.rigid_motions == 1
    found = np.sort_complex(modes.eigenvalue.ravel())
    np.testing.assert_allclose(found, np.sort_complex(model.eigenvalues()), rtol=1e-7, atol=1e-4)
    speeds = np.array([60.0, 150.0])
    response = tn.order_response(line, speeds)
    assert set(response.springs) == set(names)
    for row, speed in enumerate(speeds):
        twists = model.twists(0, TORQUE, 2 * speed)
        one = np.abs(response.twist[row]).max(axis=0)
        np.testing.assert_allclose([one[response.springs.index(name)] for name in names], twists, rtol=1e-9)
    judged = tn.stability(line, 150.0)
    assert judged.set_aside == (4 if slips else 2) and str(judged.verdict) == "stable"


def test_resistance_by_hand() -> None:
    """0.012 of the weight, and its part along a road of 5 %; air at 25 m/s: ½ · 1.2 · 0.65 · 25² = 243.75 N."""
    resists = {"rolling_resistance": ROLLING, "drag_area": AREA, "grade": GRADE}
    line, alpha, wheels = car(False, **resists), np.arctan(GRADE), 25.0 / RADIUS
    weight = MASS * 9.80665
    along = (ROLLING * np.cos(alpha) + np.sin(alpha)) * weight
    response = tn.order_response(line, [wheels * RATIO])
    each = response.springs.index("left tyre"), response.springs.index("right shaft")
    np.testing.assert_allclose(response.mean_torque[0, each], -(along + 243.75) * RADIUS / 2, rtol=1e-12)
    # The slope of the air's torque damps, as a quadratic load of the same size does.
    plain = car(False, load_torque=along * RADIUS, quadratic_load=1.2 * AREA * RADIUS**3 / 2)
    for ask in (
        lambda one: tn.stability(one, 150.0).multipliers,
        lambda one: tn.order_response(one, [60.0, 150.0]).torque,
        lambda one: tn.campbell_diagram(one, [100.0, 200.0]).frequency,
    ):
        np.testing.assert_allclose(ask(line), ask(plain), rtol=1e-9, atol=1e-9)


def test_a_vehicle_in_motion() -> None:
    """Nonlinear equations in time take a vehicle as the disk and the loads that it is; and its slip as a damper."""
    front = [tn.ConstantSpeed(), tn.Shaft(stiffness=2e3, damping=4.0), tn.Disk(inertia=0.8), tn.HookeJoint(angle=0.3)]
    sides = tn.Tyre(stiffness=9e3, damping=30.0, slip_stiffness=SLIP, radius=RADIUS, travel_speed=TRAVEL, inertia=0.4)
    rolls = tn.Vehicle(mass=60.0, wheel_radius=RADIUS, rolling_resistance=0.1, drag_area=3.0)
    disk = tn.Disk(
        inertia=60 * RADIUS**2, load_torque=0.1 * 60 * 9.80665 * RADIUS, quadratic_load=1.2 * 3.0 * RADIUS**3 / 2
    )
    belt, slip = tn.Disk(inertia=0.4), tn.Shaft(stiffness=1e-6, damping=SLIP * RADIUS**2 / TRAVEL)
    one = tn.Driveline([*front, sides, rolls])
    other = tn.Driveline([*front, tn.Shaft(stiffness=9e3, damping=30.0), belt, slip, disk])
    runs = [tn.simulate(this, speed=50.0, turns=3) for this in (one, other)]
    torque = [np.asarray(run.torque)[:, :2] for run in runs]
    np.testing.assert_allclose(*torque, rtol=1e-5, atol=1e-5 * np.abs(torque[0]).max())
    none = dict.fromkeys(("slip_stiffness", "radius", "travel_speed", "inertia"))
    turn = tn.kinetostatics(tn.Driveline([*front, sides.but(**none), rolls]), 50.0)
    load = tn.kinetostatics(tn.Driveline([*front, tn.Shaft(stiffness=9e3, damping=30.0), disk]), 50.0)
    np.testing.assert_allclose(turn.data.torque, load.data.torque, rtol=1e-9)


def test_what_slip_needs_is_said() -> None:
    line = tn.Driveline([tn.ConstantSpeed(), *car(True).elements[5:9]])
    with pytest.raises(tn.InputError, match=r"left tyre\.slip_stiffness: has no spring, so that its vehicle may stand"):
        tn.periodic_response(line, 50.0)
    assert "slip of left tyre has no spring that holds it" in str(tn.stability(line, 50.0))
    assert "(slip alone drags it along" in str(tn.natural_frequencies(line))


def test_a_wheel_of_another_size_is_a_ratio_and_winds_the_line_up():
    """Stated as a radius it is said to do nothing of the kind; as a ratio the two slips pull against each other."""
    first, second, stiffness, travel, pulls = 0.3, 0.297, 9e3, 25.0, 6e4
    ring = {"stiffness": stiffness, "damping": 30.0, "slip_stiffness": pulls, "travel_speed": travel, "inertia": 0.4}
    car = tn.Vehicle(name="car", mass=1200.0, wheel_radius=first)

    def driven(*smaller: object) -> tn.Driveline:
        return tn.Driveline(
            [
                tn.ConstantSpeed(), tn.Shaft(stiffness=2e4, damping=5.0), tn.Disk(inertia=0.1, name="hub"),
                tn.Shaft(stiffness=8e3, damping=1.0, name="front axle"), tn.Disk(inertia=1.0),
                tn.Tyre(**ring, radius=first, name="front"), car,
                tn.Shaft(stiffness=8e3, damping=1.0, name="rear axle", after="hub"), tn.Disk(inertia=1.0), *smaller,
            ]
        )  # fmt: skip

    said = r"rear.radius: is 297 mm beside a wheel_radius of 300 mm.*Ratio\(ratio=1.0101"
    with pytest.warns(tn.InputRemark, match=said):
        driven(tn.Tyre(**ring, radius=second, name="rear", to="car"))
    ratio = tn.Ratio(ratio=first / second)
    line = driven(ratio, tn.Tyre(**ring, radius=first, name="rear", to="car"))
    found = tn.order_response(line, [travel / first])
    torque = {name: found.mean_torque[0, i] for i, name in enumerate(found.springs)}
    # Both wheels turn alike; the car goes at the speed at which the two slips pull against each other.
    # F_1 = C (ω r_1 − v)/v_ref, F_2 = C (ω r_2 − v)/v_ref and F_1 + F_2 = 0: v = ω (r_1 + r_2)/2.
    omega = travel / first
    force = pulls * (omega * first - omega * (first + second) / 2) / travel
    assert abs(torque["front axle"]) == pytest.approx(force * first, rel=0.02)
    assert abs(torque["rear axle"]) == pytest.approx(force * second, rel=0.02)
    assert np.sign(torque["front axle"]) != np.sign(torque["rear axle"])
    assert any("winds the line up" in one.sentence for one in found.findings)
