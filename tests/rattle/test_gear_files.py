"""Gear meshes and shafts with stages in files: every key read, written, in the schema; two ways to state one pair."""

from __future__ import annotations

import tomllib
from typing import Any

import jsonschema
import numpy as np
import pytest
from known_motions import BACKLASH

import trunnion as tn
from trunnion.driveline import json_schema
from trunnion.equations.line_system import line_system
from trunnion.errors import InputRemark
from trunnion.motion.simulation.simulate import simulate_system

SCHEMA = jsonschema.Draft202012Validator(json_schema())

TEETH = """
teeth_in = 20
teeth_out = 31
module = "4 mm"
pressure_angle = "22.5 deg"
"""
RADII = """
base_radius_in = "36.9552 mm"
base_radius_out = "57.2805 mm"
"""
COMMON = """
name = "gears"
after = "pinion"
mesh_stiffness = "2e8 N/m"
mesh_damping = "900 N*s/m"
impact_damping = "2e7 N*s/m^2"
damping_law = "in contact"
stiffness_ratio = 0.05
"""
PHASED = """
[[element.transmission_error]]
amplitude = "4 um"
phase = "30 deg"

[[element.transmission_error]]
amplitude = "1 um"
order = 2

[[element.stiffness_variation]]
share = 0.1
order = 2
phase = "-15 deg"
"""
RUBS = """
friction_coefficient = 0.05
drag_torque = "2 N*m"
heat_rating = "400 W"
"""
STAGED = """
name = "clutch"
breakpoints = ["-12 deg", "-4 deg", "4 deg", "10 deg"]
stiffnesses = ["2 kN*m/rad", "300 N*m/rad", 0, "300 N*m/rad", "2.5 kN*m/rad"]
damping = "0.3 N*m*s/rad"
damping_law = "in contact"
fork_offset = "90 deg"
"""


def document(mesh: str) -> str:
    disk = '[[element]]\ntype = "Disk"\ninertia = 0.1\n'
    return (
        f'format = 1\n{disk}name = "pinion"\n[[element]]\ntype = "GearPair"\n{mesh}\n{disk}'
        f'[[element]]\ntype = "PiecewiseShaft"\n{STAGED}\n{disk}'
    )


MESHES = {
    "teeth, linear backlash": TEETH + COMMON + 'backlash = "0.1 mm"\n' + RUBS + PHASED,
    "radii, angular backlash": RADII + COMMON + 'angular_backlash = "0.2 deg"\nefficiency = 0.98\n',
}


@pytest.mark.parametrize("mesh", MESHES.values(), ids=list(MESHES))
def test_every_key_is_read_written_and_in_the_schema(mesh: str) -> None:
    text = document(mesh)
    line = tn.loads(text)
    again = tn.dumps(line)
    assert tn.loads(again) == line and tn.dumps(tn.loads(again)) == again
    # What was stated stands in what was written, in the units it was stated in where they read back exactly.
    assert tomllib.loads(again)["element"][1].keys() == tomllib.loads(text)["element"][1].keys()
    for words in (text, again):
        SCHEMA.validate(tomllib.loads(words))


def test_the_two_documents_hold_every_key() -> None:
    tables = [tomllib.loads(document(mesh))["element"] for mesh in MESHES.values()]
    assert set().union(*(elements[1] for elements in tables)) - {"type"} == set(tn.GearPair.model_fields) - {"sheet"}
    assert set(tables[0][3]) - {"type"} == set(tn.PiecewiseShaft.model_fields) - {"after", "sheet"}


@pytest.mark.parametrize(
    "element",
    [
        {"type": "GearPair", "mesh_stiffness": 1e8},
        {"type": "GearPair", "teeth_in": 20, "teeth_out": 30, "module": 0.004},
        {"type": "GearPair", "teeth_in": 20, "teeth_out": 30, "mesh_stiffness": 1e8},
        {"type": "GearPair", "base_radius_in": 0.1, "base_radius_out": 0.1, "mesh_stiffness": 1e8, "backlsh": 0},
        {
            "type": "GearPair", "base_radius_in": 0.1, "base_radius_out": 0.1, "mesh_stiffness": 1e8,
            "damping_law": "sometimes",
        },
        {"type": "PiecewiseShaft", "breakpoints": [0.1]},
        {"type": "PiecewiseShaft", "breakpoints": 0.1, "stiffnesses": [1.0, 2.0]},
        {"type": "PiecewiseShaft", "breakpoints": [0.1], "stiffnesses": [1.0, 2.0], "damping_law": "never pulling"},
    ],
    ids=str,
)  # fmt: skip
def test_schema_refuses(element: dict[str, Any]) -> None:
    with pytest.raises(jsonschema.ValidationError):
        SCHEMA.validate({"format": 1, "element": [element]})


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: tn.GearPair(teeth_in=20, teeth_out=30, module=4, mesh_stiffness=1e8), "module.*in metres"),
        (
            lambda: tn.GearPair(teeth_in=20, teeth_out=30, module=0.004, mesh_stiffness=1e8, backlash=0.1),
            "backlash.*wide",
        ),
        (
            lambda: tn.GearPair(base_radius_in=0.1, base_radius_out=0.1, mesh_stiffness=1e8, angular_backlash=0.2),
            "angular_backlash.*as wide as teeth",
        ),
        (lambda: tn.PiecewiseShaft(breakpoints=[-4, 4], stiffnesses=[2e3, 0, 2e3]), "breakpoints.*in radians"),
        (
            lambda: tn.GearPair(base_radius_in=0.1, base_radius_out=0.1, mesh_stiffness=1e8, stiffness_ratio=0.1),
            "stiffness_ratio.*no backlash to act in",
        ),
    ],
)
def test_a_unit_left_out_is_a_remark(make: Any, words: str) -> None:
    with pytest.warns(InputRemark, match=words) as told:
        make()
    assert len(told) == 1 and "\n" not in str(told[0].message)


def two_gears(excitation: float = 8.0, **mesh: Any) -> tn.Driveline:
    numbers = {"mesh_stiffness": 2e6, "mesh_damping": 60.0, "stiffness_ratio": 0.1, **mesh}
    disk = tn.Disk(inertia=2e-3, load_torque=-1.0, excitation=[{"amplitude": excitation, "frequency": 900.0}])
    return tn.Driveline([disk, tn.GearPair(**numbers), tn.Disk(inertia=5e-3, load_torque=1.5)])


def test_teeth_and_radii_and_both_kinds_of_backlash_are_one_pair() -> None:
    teeth = {"teeth_in": 18, "teeth_out": 27, "module": 0.005}
    r1, r2 = tn.GearPair(**teeth, mesh_stiffness=1.0).radii
    radii = {"base_radius_in": r1, "base_radius_out": r2}
    pairs = [
        tn.exact_oscillator(two_gears(**size, **play))
        for size in (teeth, radii)
        for play in ({"backlash": 4e-5}, {"angular_backlash": 4e-5 / r2})
    ]
    orbits = [tn.piecewise_orbit(pair, [3e-5, 0.0]) for pair in pairs]
    assert orbits[0].impacts > 0
    for orbit in orbits[1:]:
        assert orbit.start == pytest.approx(orbits[0].start, rel=1e-9)
        assert orbit.peak_to_peak == pytest.approx(orbits[0].peak_to_peak, rel=1e-12)


def geared(pair: tn.GearPair | tn.Ratio) -> tn.Driveline:
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=3e3, damping=2.0),
            tn.Disk(inertia=0.05),
            pair,
            tn.Disk(inertia=0.04),
            tn.HookeJoint(angle=0.3),
            tn.Shaft(stiffness=2e3, damping=1.0),
            tn.Disk(inertia=0.1, load_torque=15.0),
        ]
    )


def test_a_stiff_mesh_moves_as_a_ratio_does() -> None:
    """The periodic motion's torques tend to those behind a Ratio, with an error that falls as 1/k."""
    rigid = tn.periodic_response(geared(tn.Ratio(teeth_in=20, teeth_out=30)), 70.0)
    errors = []
    for k in (3e7, 3e8, 3e9):
        mesh = tn.GearPair(teeth_in=20, teeth_out=30, module="4 mm", mesh_stiffness=k, mesh_damping=k / 1e4)
        found = tn.periodic_response(geared(mesh), 70.0)
        names = found.line.shafts
        kept = [names.index(name) for name in ("Shaft 1", "Shaft 2")]
        errors.append(np.abs(found.torque_peak_to_peak[kept] / rigid.torque_peak_to_peak - 1).max())
    assert errors[0] / errors[1] == pytest.approx(10, rel=0.1) and errors[1] / errors[2] == pytest.approx(10, rel=0.1)
    assert errors[2] < 1e-3


def test_a_stiff_mesh_simulates_as_a_ratio_does() -> None:
    rigid = tn.simulate(geared(tn.Ratio(teeth_in=20, teeth_out=30)), speed=70.0, turns=5)
    mesh = tn.GearPair(teeth_in=20, teeth_out=30, module="4 mm", mesh_stiffness=1e9, mesh_damping=2e5)
    found = tn.simulate(geared(mesh), speed=70.0, turns=5)
    times = np.linspace(0.01, 0.4, 60)
    ends = [run.motion_at(times).torque for run in (rigid, found)]
    assert ends[0].shape[1] == 2 and ends[1].shape[1] == 3
    np.testing.assert_allclose(ends[1][:, [0, 2]], ends[0], atol=2e-3 * np.abs(ends[0]).max())


def test_the_geared_chain_with_a_branch_behind_an_elastic_mesh() -> None:
    """Friswell and co-authors: 0, 425.4, 634.1, 3247.2 Hz; the second gear drives two shafts."""
    line = tn.Driveline(
        [
            tn.Disk(inertia=400e-6),
            tn.Shaft(stiffness=10e3),
            tn.Disk(inertia=25e-6),
            tn.GearPair(teeth_in=20, teeth_out=20, module="2 mm", mesh_stiffness=1e13),
            tn.Disk(inertia=25e-6, name="second gear"),
            tn.Shaft(stiffness=5e3),
            tn.Disk(inertia=700e-6),
            tn.Shaft(stiffness=5e3, after="second gear"),
            tn.Disk(inertia=700e-6),
        ]
    )
    assert tn.natural_frequencies(line).hertz[:4] == pytest.approx([0.0, 425.4, 634.1, 3247.2], abs=0.051)


def test_one_pinion_drives_two_gears() -> None:
    """Two equal meshes on one shaft: both rattle alike; in phase they are one mesh of twice the size."""

    def wheel(inertia: float, k: float, c: float, after: str | None = None) -> list[tn.Element]:
        mesh = tn.GearPair(
            teeth_in=20, teeth_out=40, module="3 mm", mesh_stiffness=k, mesh_damping=c, backlash="0.1 mm",
            stiffness_ratio=0.05, after=after,
        )  # fmt: skip
        return [mesh, tn.Disk(inertia=inertia, load_torque=4.0 * inertia / 0.02)]

    front = [
        tn.ConstantSpeed(),
        tn.Shaft(stiffness=5e3, damping=5.0),
        tn.Disk(inertia=0.01, name="pinion", excitation=[{"amplitude": 12.0, "order": 5}]),
    ]
    two = tn.Driveline([*front, *wheel(0.02, 1e7, 3e3), *wheel(0.02, 1e7, 3e3, after="pinion")])
    one = tn.Driveline([*front, *wheel(0.04, 2e7, 6e3)])
    own, whole = (tn.natural_frequencies(line).frequency for line in (one, two))
    assert np.abs(whole[:, None] - own).min(axis=0) == pytest.approx(0, abs=1e-6 * own[-1])
    both, single = tn.periodic_response(two, 80.0), tn.periodic_response(one, 80.0)
    assert both.outcome.ok and single.outcome.ok and len(both.contacts) == 2
    assert {c.contact for c in both.contacts} == {single.contacts[0].contact}
    assert both.contacts[0].impacts == both.contacts[1].impacts == single.contacts[0].impacts > 0
    assert both.torque_peak_to_peak[1:] == pytest.approx(single.torque_peak_to_peak[1] / 2, rel=1e-6)


def test_a_mesh_that_never_pulls_moves_as_modelica_has_it() -> None:
    """The published trajectory of ElastoBacklash, 45° of play in all, from the element on base radii of 1 m."""
    sizes = {"base_radius_in": 1.0, "base_radius_out": 1.0, "mesh_stiffness": 20e3, "mesh_damping": 50.0}
    with pytest.warns(InputRemark, match="as wide as teeth"):
        mesh = tn.GearPair(**sizes, backlash=np.pi / 4, damping_law="never pulling")
    disk = tn.Disk(inertia=5.0, excitation=[{"amplitude": 1e-300, "frequency": 1.0}])
    line = tn.Driveline([tn.ConstantSpeed(), mesh, disk])
    times, angles = np.array(BACKLASH).T
    run = simulate_system(line_system(line, 1.0).system, 0.1, start=[np.pi / 2, 0.0], tolerance=1e-12).at(times)
    assert run[:, 0] == pytest.approx(angles, abs=5.1e-8)
