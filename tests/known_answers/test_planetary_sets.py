"""Planetary sets against Willis's equation and independent equations of motion."""

from __future__ import annotations

from fractions import Fraction
from itertools import permutations

import numpy as np
import pytest
from scipy.linalg import eigh, null_space

import trunnion as tn

SUN, RING, PLANET = 24, 66, 21
MASS, SPIN, DISTANCE, COUNT = 0.7, 4e-4, 0.09, 3
# Input speed over output speed of the six arrangements, by hand from the tables of gear books: i₀ = z_r/z_s = 2.75.
STANDARD = {
    ("sun", "carrier"): 1 + 2.75,
    ("carrier", "sun"): 1 / 3.75,
    ("sun", "ring"): -2.75,
    ("ring", "sun"): -1 / 2.75,
    ("ring", "carrier"): 1 + 1 / 2.75,
    ("carrier", "ring"): 2.75 / 3.75,
}


def planetary(drives: str, driven: str, **more: object) -> tn.Planetary:
    held = next(one for one in ("sun", "carrier", "ring") if one not in (drives, driven))
    return tn.Planetary(teeth_sun=SUN, teeth_ring=RING, input=drives, held=held, name="gears", **more)


def heavy(drives: str, driven: str) -> tn.Planetary:
    return planetary(drives, driven, planet_inertia=SPIN, planet_mass=MASS, centre_distance=DISTANCE, planets=COUNT)


@pytest.mark.parametrize(("drives", "driven"), list(permutations(("sun", "carrier", "ring"), 2)))
def test_ratios_of_all_arrangements(drives: str, driven: str) -> None:
    one = planetary(drives, driven)
    assert one.driven == driven
    np.testing.assert_allclose(one.speed_ratio, STANDARD[drives, driven], rtol=1e-15)
    speed = one.speeds
    assert SUN * speed["sun"] + RING * speed["ring"] == (SUN + RING) * speed["carrier"]
    # The planet rolls on the sun and in the ring: equal speeds of the pitch circles, r_s + r_p = r_c.
    for gear, sign in (("sun", 1), ("ring", -1)):
        teeth = SUN if gear == "sun" else RING
        assert teeth * (speed[gear] - speed["carrier"]) == -sign * PLANET * (speed["planets"] - speed["carrier"])
    assert one.speeds[driven] == Fraction(1) / Fraction(one.speeds[drives] / one.speeds[driven])


def constrained(inertia: dict[str, float], stiffness: tuple[float, float], drives: str, driven: str) -> np.ndarray:
    """Frequencies [rad/s] of drive, spring, planetary set, spring, load; every gear a coordinate of its own and every
    contact of teeth a constraint."""
    names = ["drive", "sun", "ring", "carrier", "planets", "load"]
    place = {name: i for i, name in enumerate(names)}
    mass = np.diag([inertia[name] for name in names])
    spring = np.zeros((6, 6))
    for k, one, other in ((stiffness[0], "drive", drives), (stiffness[1], driven, "load")):
        row = np.zeros(6)
        row[place[one]], row[place[other]] = 1.0, -1.0
        spring += k * np.outer(row, row)
    held = next(one for one in ("sun", "carrier", "ring") if one not in (drives, driven))
    rules = np.zeros((3, 6))
    # Pitch radii go with teeth: sun and planet roll outside on each other, planet and ring inside.
    rules[0, [place["sun"], place["planets"], place["carrier"]]] = SUN, PLANET, -(SUN + PLANET)
    rules[1, [place["ring"], place["planets"], place["carrier"]]] = RING, -PLANET, -(RING - PLANET)
    rules[2, place[held]] = 1.0
    free = null_space(rules)
    squares = eigh(free.T @ spring @ free, free.T @ mass @ free, eigvals_only=True)
    return np.sqrt(np.maximum(squares, 0.0))


@pytest.mark.parametrize(("drives", "driven"), list(permutations(("sun", "carrier", "ring"), 2)))
def test_modes_with_heavy_planets(drives: str, driven: str) -> None:
    gears = {"sun": 2e-3, "ring": 0.03, "carrier": 0.01}
    held = next(one for one in gears if one not in (drives, driven))
    line = tn.Driveline(
        [
            tn.Disk(inertia=0.05, drive_share=1.0, name="drive"),
            tn.Shaft(stiffness=2e4),
            tn.Disk(inertia=gears[drives], name=drives),
            heavy(drives, driven),
            tn.Disk(inertia=gears[driven], name=driven),
            tn.Shaft(stiffness=5e4),
            tn.Disk(inertia=0.4, name="load"),
        ]
    )
    moments = gears | {
        "drive": 0.05, "load": 0.4, "planets": COUNT * SPIN, "carrier": gears["carrier"] + COUNT * MASS * DISTANCE**2
    }  # fmt: skip
    expected = constrained(moments, (2e4, 5e4), drives, driven)
    assert held not in (drives, driven)
    found = tn.natural_frequencies(line).undamped_frequency
    np.testing.assert_allclose(found[1:], expected[1:], rtol=1e-9)


def test_held_torque_goes_into_the_housing() -> None:
    """Power without loss: the torque behind is that in front times the ratio."""
    load = 80.0
    line = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, name="front"), tn.Disk(inertia=0.01), heavy("sun", "carrier"),
            tn.Shaft(stiffness=1e5, name="behind"), tn.Disk(inertia=0.5, load_torque=load),
        ]
    )  # fmt: skip
    found = tn.order_response(line, [100.0])
    np.testing.assert_allclose(found.mean_torque[0], [-load / STANDARD["sun", "carrier"], -load], rtol=1e-12)


def test_planets_behind_a_bent_joint_are_those_of_gears_and_disks() -> None:
    """All analyses take planets and carrier as the disks behind ratios that they are."""
    joint, shaft = tn.HookeJoint(angle=0.4), tn.Shaft(stiffness=3e3, damping=0.4)
    set_of_gears, speed = heavy("sun", "carrier"), heavy("sun", "carrier").speeds
    carried = COUNT * MASS * DISTANCE**2
    front = [tn.ConstantSpeed(), shaft, tn.Disk(inertia=0.02, name="pinion"), joint]
    behind = [tn.Shaft(stiffness=2e4, damping=1.0), tn.Disk(inertia=0.3, load_torque=30.0)]
    gears = tn.Driveline([*front, set_of_gears, *behind])
    # The same inertias where they are felt at the sun, which the joint drives.
    felt = COUNT * SPIN * float(speed["planets"]) ** 2 + carried * float(speed["carrier"]) ** 2
    plain = tn.Driveline([*front, tn.Disk(inertia=felt), tn.Ratio(teeth_in=SUN, teeth_out=SUN + RING), *behind])
    for ask in (
        lambda one: tn.stability(one, 80.0).multipliers,
        lambda one: tn.order_response(one, [30.0, 60.0]).torque,
        lambda one: tn.periodic_response(one, 80.0).torque,
        lambda one: tn.natural_frequencies(one).undamped_frequency,
    ):
        np.testing.assert_allclose(ask(gears), ask(plain), rtol=1e-7, atol=1e-8)


@pytest.mark.parametrize(("drives", "driven"), list(permutations(("sun", "carrier", "ring"), 2)))
def test_elastic_meshes(drives: str, driven: str) -> None:
    """Modes with the deflection of each mesh along its line of action, base radii m z cos α/2; with very stiff teeth
    those of rigid ones."""
    gears, module, angle = {"sun": 2e-3, "ring": 0.03, "carrier": 0.01}, 0.003, np.pi / 9
    meshes = {"sun_mesh_stiffness": 1e8, "ring_mesh_stiffness": 1.4e8, "module": module}

    def line(**more: float) -> tn.Driveline:
        return tn.Driveline(
            [
                tn.Disk(inertia=0.05, drive_share=1.0), tn.Shaft(stiffness=2e4), tn.Disk(inertia=gears[drives]),
                heavy(drives, driven).but(**more), tn.Disk(inertia=gears[driven]), tn.Shaft(stiffness=5e4),
                tn.Disk(inertia=0.4, load_torque=70.0),
            ]
        )  # fmt: skip

    place = {name: i for i, name in enumerate(["drive", "sun", "ring", "carrier", "planets", "load"])}
    carried = gears["carrier"] + COUNT * MASS * DISTANCE**2
    mass, k = np.diag([0.05, gears["sun"], gears["ring"], carried, COUNT * SPIN, 0.4]), np.zeros((6, 6))
    half = module * np.cos(angle) / 2
    rows = [
        (2e4, {"drive": 1, drives: -1}), (5e4, {driven: 1, "load": -1}),
        (COUNT * 1e8, {"sun": half * SUN, "planets": half * PLANET, "carrier": -half * (SUN + PLANET)}),
        (COUNT * 1.4e8, {"ring": half * RING, "planets": -half * PLANET, "carrier": -half * (RING - PLANET)}),
    ]  # fmt: skip
    for stiffness, row in rows:
        q = np.zeros(6)
        q[[place[name] for name in row]] = list(row.values())
        k += stiffness * np.outer(q, q)
    held = next(one for one in gears if one not in (drives, driven))
    kept = [i for name, i in place.items() if name != held]
    squares = eigh(k[np.ix_(kept, kept)], mass[np.ix_(kept, kept)], eigvals_only=True)
    found = tn.natural_frequencies(line(**meshes))
    np.testing.assert_allclose(found.undamped_frequency[1:], np.sqrt(squares[1:]), rtol=1e-9)
    rigid = tn.natural_frequencies(line()).undamped_frequency
    stiff = {"sun_mesh_stiffness": 1e15, "ring_mesh_stiffness": 1e15, "module": module}
    np.testing.assert_allclose(tn.natural_frequencies(line(**stiff)).undamped_frequency[1:3], rigid[1:], rtol=1e-5)
    # Both meshes pass the torque on: of the planets, none is left over.
    response = tn.order_response(line(**meshes), [50.0])
    torque = dict(zip(response.springs, response.mean_torque[0], strict=True))
    assert torque["sun mesh of gears"] == pytest.approx(-torque["ring mesh of gears"], rel=1e-9)
    assert abs(torque["Shaft 1"]) == pytest.approx(70 / abs(STANDARD[drives, driven]), rel=1e-9)
