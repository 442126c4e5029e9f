"""``assess`` against calculations by hand, and what it says where it cannot judge."""

from __future__ import annotations

import contextlib
import io
import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import trunnion as tn
from trunnion.cli import app
from trunnion.design.assessment import assessment_input
from trunnion.design.assessment.check import Status
from trunnion.design.assessment.joint_angles import allowed_angle
from trunnion.design.assessment.measures import permissible_stress
from trunnion.design.assessment.ship_shafts import barred_range
from trunnion.reporting.binding import binding_picture
from trunnion.reporting.overview import overview
from trunnion.reporting.tables import with_signs
from trunnion.response.orders.result import frequency_factor
from trunnion.steady.orders.spectrum import order_spectrum

J1, J2, K, C, T = 0.2, 0.8, 1e4, 2.0, 100.0


def two_mass(*limits, load=0.0, spring=None, order=2):
    """A free line of two inertias, shaken by one order of 100 N m; mode 2 at 250 rad/s."""
    return tn.Driveline(
        [
            tn.Disk(inertia=J1, name="engine", drive_share=1.0, excitation=[{"order": order, "amplitude": T}]),
            spring or tn.Shaft(stiffness=K, damping=C, name="shaft"),
            tn.Disk(inertia=J2, name="load", load_torque=load),
        ],
        limits=limits,
    )


def torque(frequency):
    """Amplitude by hand: the twist q of J₁J₂/(J₁ + J₂) q″ + cq′ + kq = T J₂/(J₁ + J₂), times |k + iνc|."""
    reduced, share = J1 * J2 / (J1 + J2), J2 / (J1 + J2)
    spring = K + 1j * frequency * C
    return abs(T * share * spring / (spring - reduced * frequency**2))


def test_the_torque_of_two_masses_by_hand():
    one = tn.assess(two_mass(tn.Limit(of="shaft", vibratory_torque=400.0)), (100.0, 100.0))
    check = one.check("vibratory torque of shaft")
    assert check.value == pytest.approx(torque(200.0), rel=1e-9)
    assert check.margin == pytest.approx(1 - torque(200.0) / 400.0, rel=1e-9)
    assert check.status is Status.SATISFIED
    assert "order 2, 20 % below mode 2 (39.78 Hz)" in check.because  # 39.79 Hz · √(1 − 0.025²)
    peak = tn.assess(two_mass(tn.Limit(of="shaft", max_torque=400.0), load=50.0), (100.0, 100.0))
    assert peak.check("max torque of shaft").value == pytest.approx(torque(200.0) + 50.0, rel=1e-9)


def test_a_loss_factor_at_all_frequencies_leaves_all_but_stability_judged():
    """A coupling as its maker lists it beside an angled joint: torques by frequency, no equations in time."""
    parts = [
        tn.ConstantSpeed(), tn.Shaft(stiffness=K, damping=1.0, name="shaft"), tn.Disk(inertia=0.5),
        tn.HookeJoint(angle=0.1), tn.Coupling(stiffness=K, relative_damping=0.8, name="coupling"), tn.Disk(inertia=0.5),
    ]  # fmt: skip
    line = tn.Driveline(parts, limits=[tn.Limit(of="shaft", max_torque=500.0)])
    found = tn.assess(line, (60.0, 70.0))
    check = found.check("max torque of shaft")
    assert check.value == pytest.approx(tn.order_response(line, [check.speed]).peak_torque[0, 0], rel=1e-9)
    stability = found.check("parametric stability")
    assert stability.status is Status.NOT_JUDGED and "write loss_factor_frequency" in stability.because
    compared = tn.compare(line, line.replace("shaft", stiffness=2 * K), (60.0, 70.0))
    assert "peak torque of shaft" in str(compared)


def test_motion_of_a_disk_by_hand():
    """Rotation of the load: J₂φ₂″ = −torque of the shaft, so its acceleration is torque/J₂."""
    limits = [tn.Limit(of="load", max_acceleration=1000.0, max_speed_fluctuation=10.0)]
    found = tn.assess(two_mass(*limits), (100.0, 100.0))
    assert found.check("max acceleration of load").value == pytest.approx(torque(200.0) / J2, rel=1e-9)
    assert found.check("max speed fluctuation of load").value == pytest.approx(torque(200.0) / J2 / 200.0, rel=1e-9)


def test_stress_and_twist_of_a_tube_by_hand():
    tube = tn.Shaft(outer_diameter="60 mm", inner_diameter="40 mm", length="0.5 m", material="steel", name="shaft")
    line = two_mass(tn.Limit(of="shaft", max_stress="50 MPa", max_twist="1 deg"), spring=tube)
    found = tn.assess(line, (50.0, 50.0))
    largest = tn.order_response(line, [50.0]).peak_torque[0, 0]
    second_moment = math.pi / 32 * (0.06**4 - 0.04**4)
    assert found.check("max stress of shaft").value == pytest.approx(largest * 0.03 / second_moment, rel=1e-9)
    assert found.check("max twist of shaft").value == pytest.approx(largest * 0.5 / (79.3e9 * second_moment), rel=1e-9)


def test_without_limits_nothing_is_satisfied():
    found = tn.assess(two_mass(), (60.0, 140.0))
    assert found.verdict is Status.NOT_JUDGED
    assert found.check("torque without limit").status is Status.NOT_JUDGED
    assert found.check("separation of mode 2").status is Status.EXCEEDED  # which decides nothing here
    assert found.check("separation of mode 2").margin_word == "met in the range"
    assert found.sentence.startswith("not judged")


def test_limits_judge_what_separation_asks_for():
    found = tn.assess(two_mass(tn.Limit(of="shaft", max_torque=1e4)), (60.0, 140.0))
    assert "is judged by the limits of torque or stress that are stated" in found.check("separation of mode 2").because
    assert found.verdict is Status.SATISFIED
    assert found.binding is found.checks[0]
    peak = found.check("max torque of shaft")
    fine = max(torque(2 * speed) for speed in np.linspace(120.0, 130.0, 4001))
    assert peak.value == pytest.approx(fine, rel=2e-5), "closed in on between the speeds of the grid"
    between = tn.assess(two_mass(tn.Limit(of="shaft", max_torque=1e4), spring=tn.Coupling(
        stiffness=K, relative_damping=0.6, name="shaft", vibratory_torque=1e4)), (60.0, 140.0))  # fmt: skip
    lossy = K * (1 + 0.6j / (2 * math.pi))
    fine = max(abs(T * 0.8 * lossy / (lossy - 0.16 * (2 * x) ** 2)) for x in np.linspace(120.0, 130.0, 4001))
    assert between.check("max torque of shaft").value == pytest.approx(fine, rel=2e-5)


def test_separation_by_hand():
    """Order 2 at 100 rad/s stands 20 % below 250 rad/s: twice the separation asked for."""
    check = tn.assess(two_mass(), (50.0, 100.0)).check("separation of modes")
    damped = 250.0 * math.sqrt(1 - (C / (2 * math.sqrt(K * 0.16))) ** 2)
    assert check.value == pytest.approx(1 - 200.0 / damped, rel=1e-9)
    assert check.margin == pytest.approx(check.value / 0.1 - 1)


def test_a_required_margin():
    value = torque(200.0)
    kept = tn.Limit(of="shaft", vibratory_torque=value / 0.85, margin="10 %")
    short = tn.Limit(of="shaft", vibratory_torque=value / 0.95, margin="10 %")
    name = "vibratory torque of shaft"
    assert tn.assess(two_mass(kept), (100.0, 100.0)).check(name).status is Status.SATISFIED
    assert tn.assess(two_mass(short), (100.0, 100.0)).check(name).status is Status.EXCEEDED


def test_a_limit_of_the_element_goes_before_that_of_its_kind():
    limits = [tn.Limit(of="shaft", max_torque=300.0), tn.Limit(of="Shaft *", max_torque=1.0, max_twist=1.0)]
    line = two_mass(*limits)
    assert {(one.key, one.value) for one in line.limits_by_element} == {("max_torque", 300.0), ("max_twist", 1.0)}
    assert line.replace("shaft", damping=3.0).limits == line.limits


def test_a_range_that_is_passed_quickly_is_barred():
    limit = tn.Limit(of="shaft", vibratory_torque=500.0, transient_vibratory_torque=5000.0)
    line = two_mass(limit)
    found = tn.assess(line, (60.0, 180.0))
    assert found.check("vibratory torque of shaft").status is Status.EXCEEDED
    assert found.verdict is Status.SATISFIED
    assert "barred" in found.sentence
    ((low, high),) = found.barred
    assert torque(2 * low) == pytest.approx(500.0, rel=0.02)
    assert torque(2 * high) == pytest.approx(500.0, rel=0.02)
    there = tn.Driveline(line.elements, limits=line.limits, operation=tn.Operation(speed=125.0))
    assert tn.assess(there, (60.0, 180.0)).verdict is Status.EXCEEDED  # it runs in the barred range
    hard = two_mass(tn.Limit(of="shaft", vibratory_torque=500.0, transient_vibratory_torque=600.0))
    assert tn.assess(hard, (60.0, 180.0)).verdict is Status.EXCEEDED


def test_ranges_barred_by_any_load_case_are_barred():
    """Order 2 shakes the unloaded line at 125 rad/s, order 4 the loaded one at 62.5 rad/s and far more."""
    tables = [
        {"order": 2, "torques": [0.0, 1000.0], "amplitudes": [100.0, 0.0]},
        {"order": 4, "torques": [0.0, 1000.0], "amplitudes": [0.0, 300.0]},
    ]
    limit = tn.Limit(of="shaft", vibratory_torque=500.0, transient_vibratory_torque=1e5)
    line = two_mass(limit).replace("engine", excitation=tables)

    def at(speed):
        cases = (tn.LoadCase(name="full", loads={"load": 1000.0}),)
        return tn.assess(tn.Driveline(
            line.elements, limits=line.limits,
            operation=tn.Operation(speed=speed, speed_range=(40.0, 180.0), load_cases=cases),
        ))  # fmt: skip

    found = at(90.0)
    assert found.verdict is Status.SATISFIED and found.check("vibratory torque of shaft").load_case == "full"
    assert [low < 62.5 < high or low < 125.0 < high for low, high in found.barred] == [True, True]
    (_, slow), (start, end) = found.barred
    assert torque(4 * slow) * 3 == pytest.approx(500.0, rel=0.02)
    assert [torque(2 * speed) for speed in (start, end)] == pytest.approx([500.0, 500.0], rel=0.02)
    there = at(125.0)  # where only the unloaded line is beyond its limit
    assert there.verdict is Status.EXCEEDED and "; it runs at 1193.66 rpm, within" in there.sentence


def test_coupling_ratings_by_hand():
    """At 120 rad/s order 2 shakes at 240/2π = 38.2 Hz: S_f = √3.82."""
    coupling = tn.Coupling(
        stiffness=K, damping=C, name="coupling", nominal_torque=100.0, maximum_torque=1000.0, vibratory_torque=900.0,
        heat_rating=5000.0,
    )  # fmt: skip
    factors = tn.Limit(of="coupling", temperature_factor=1.4, starting_factor=1.3)
    found = tn.assess(two_mass(factors, spring=coupling, load=60.0), (120.0, 120.0))
    amplitude = torque(240.0)
    expected = {
        "nominal torque rating": 60.0 * 1.4,
        "maximum torque rating": (60.0 + amplitude) * 1.4 * 1.3,
        "rated torque": amplitude * math.sqrt(240.0 / (2 * math.pi) / 10),  # S_t lowers the rating
        "heat rating": 0.5 * C * 240.0**2 * (amplitude / abs(K + 240j * C)) ** 2 * 1.4,
    }
    for key, value in expected.items():
        assert found.check(f"{key} of coupling").value == pytest.approx(value, rel=1e-9), key
    assert frequency_factor(tn.hz(4.0)) == 1.0
    assert frequency_factor(tn.hz(22.5)) == pytest.approx(1.5)


def test_joint_angles_by_hand():
    """Halfway between 4000 (4.2°) and 4500 rpm (3.7°) lies 3.95°; beyond the table 3°."""
    assert allowed_angle(tn.rpm(4250)) == pytest.approx(tn.deg(3.95))
    assert allowed_angle(tn.rpm(6000)) == pytest.approx(tn.deg(3.0))


def jointed(first, second, offset="0 deg", **rest):
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1e5, damping=20.0, fork_offset=0.0),
            tn.Disk(inertia=0.02),
            tn.HookeJoint(angle=first, name="front"),
            tn.Shaft(stiffness=4e4, damping=5.0, fork_offset=offset, name="tube"),
            tn.Disk(inertia=0.02),
            tn.HookeJoint(angle=second, name="rear"),
            tn.Shaft(stiffness=1e5, damping=20.0),
            tn.Disk(inertia=0.1),
        ],
        **rest,
    )


def test_joint_rules_on_a_line():
    found = tn.assess(jointed("4 deg", "2 deg"), (tn.rpm(1000), tn.rpm(4250)))
    assert found.check("angle of front").margin == pytest.approx(1 - 4 / 3.95)
    assert found.check("equal joint angles").status is Status.EXCEEDED
    one = found.check("uniformity")
    b1, b2 = math.radians(4), math.radians(2)
    small = b1**2 - b2**2  # forks in line: the joints subtract
    assert one.value == pytest.approx(small, rel=5e-3)
    speed = tn.rpm(4250)
    assert found.check("acceleration behind the joints").value == pytest.approx(speed**2 * small, rel=5e-3)
    assert found.check("acceleration between the joints, tube").value == pytest.approx(speed**2 * b1**2, rel=5e-3)
    slow = tn.assess(jointed("4 deg", "4 deg"), (tn.rpm(500), tn.rpm(1500)))
    assert slow.check("angle of front").margin == pytest.approx(1 - 4 / 11.5)
    assert slow.check("uniformity").status is Status.SATISFIED
    none = tn.assess(jointed("0.2 deg", "0.2 deg"), (tn.rpm(500), tn.rpm(1500)))
    assert none.check("smallest angle of rear").margin == pytest.approx(0.2 / 0.5 - 1)


def test_ship_shafts_by_hand():
    """σ_B = 600, d = 200: C_D = 0.35 + 0.93 · 200^−0.2 = 0.67231; 760/18 · 0.67231 = 28.387; · 2.5 and · 1.38."""
    assert permissible_stress(600.0, 200.0, 1.0, 0.5) == pytest.approx(70.966, rel=1e-4)
    assert permissible_stress(600.0, 200.0, 1.0, 1.0) == pytest.approx(39.173, rel=1e-4)
    assert permissible_stress(600.0, 200.0, 0.45, 0.5) == pytest.approx(0.45 * 70.966, rel=1e-4)
    assert barred_range(100.0, 0.5) == (pytest.approx(91.4286, rel=1e-5), pytest.approx(109.375))


def ship(amplitude):
    shaft = tn.Shaft(
        outer_diameter="200 mm", length="6 m", shear_modulus="79.3 GPa", tensile_strength="700 MPa", damping=2000.0,
        name="intermediate shaft",
    )  # fmt: skip
    engine = tn.Disk(inertia=800.0, drive_share=1.0, excitation=[{"order": 6, "amplitude": amplitude}])
    limits = [tn.Limit(of="intermediate shaft", ship_shaft="flange")]
    propeller = tn.Disk(inertia=600.0, quadratic_load=50.0)
    operation = tn.Operation(speed="200 rpm", speed_range=["40 rpm", "205 rpm"])
    return tn.Driveline([engine, shaft, propeller], limits=limits, operation=operation)


def test_a_ship_shaft_with_a_barred_range():
    found = tn.assess(ship(24000.0))
    check = found.check("IACS UR M68 of intermediate shaft")
    response = tn.order_response(ship(24000.0), [check.speed])
    stress = response.vibratory_torque[0, 0] * 16 / (math.pi * 0.2**3)
    assert check.value == pytest.approx(stress, rel=1e-9)
    ratio = check.speed / tn.rpm(200)
    assert check.limit == pytest.approx(760 / 18 * 0.67231 * (3 - 2 * ratio**2) * 1e6, rel=1e-4)  # σ_B counts to 600
    assert check.status is Status.EXCEEDED
    ((low, high),) = check.barred
    assert low <= 16 * check.speed / (18 - ratio) * (1 + 1e-9)
    assert high >= (18 - ratio) * check.speed / 16 * (1 - 1e-9)
    passing = found.check("IACS UR M68 of intermediate shaft, passing")
    assert passing.limit == pytest.approx(1.7 * check.limit, rel=1e-3)
    assert tn.assess(ship(100.0)).check("IACS UR M68 of intermediate shaft").status is Status.SATISFIED


def geared(load, cases=()):
    return tn.Driveline(
        [
            tn.Disk(inertia=0.1, drive_share=1.0, excitation=[{"order": 1, "amplitude": 50.0}]),
            tn.Shaft(stiffness=2e4, damping=5.0),
            tn.Disk(inertia=0.01),
            tn.GearPair(name="gears", teeth_in=20, teeth_out=40, module="3 mm", mesh_stiffness=2e8, mesh_damping=500.0),
            tn.Disk(inertia=0.4, name="wheel", load_torque=load),
        ],
        operation=tn.Operation(speed=80.0, load_cases=cases),
    )


def test_gear_hammer_goes_by_the_mean_torque():
    name = "gear hammer in gears"
    assert tn.assess(geared(0.0)).check(name).status is Status.NOT_JUDGED
    heavy, light = (tn.assess(geared(load)).check(name) for load in (400.0, 10.0))
    assert (heavy.status, light.status) == (Status.SATISFIED, Status.EXCEEDED)
    assert heavy.limit == pytest.approx(400.0)
    cases = (tn.LoadCase(name="idle", loads={"wheel": 10.0}), tn.LoadCase(name="none", loads={}))
    worst = tn.assess(geared(400.0, cases)).check(name)
    assert (worst.load_case, worst.margin) == ("idle", pytest.approx(light.margin))
    assert tn.assess(two_mass(), (90.0, 90.0)).check("gear hammer").status is Status.NOT_APPLICABLE


def test_a_mesh_that_carries_nothing_without_a_load_case_is_judged_under_it():
    """A mill runs idle between two slabs: what losses leave of a mean torque there is none."""
    name, rolling = "gear hammer in gears", (tn.LoadCase(name="rolling", loads={"wheel": 400.0}),)
    loaded = tn.assess(geared(400.0)).check(name)
    for idle in (0.0, 1e-9):
        found = tn.assess(geared(idle, rolling)).check(name)
        assert (found.status, found.load_case) == (Status.SATISFIED, "rolling")
        assert found.margin == pytest.approx(loaded.margin, rel=1e-9)
        assert tn.assess(geared(idle)).check(name).status is Status.NOT_JUDGED


def test_the_motion_of_a_disk_behind_a_joint_is_judged():
    """A roll on a joint without a shaft between turns otherwise than the fork in front of it."""
    line = tn.Driveline(
        [
            tn.Disk(name="motor", inertia=0.4, drive_share=1),
            tn.Shaft(name="spindle", stiffness=1e4, damping=5.0),
            tn.Disk(name="fork", inertia=0.02),
            tn.HookeJoint(angle="4 deg"),
            tn.Disk(name="roll", inertia=0.3, load_torque=20.0),
        ],
        limits=[tn.Limit(of="Disk *", max_speed_fluctuation=0.05), tn.Limit(of="spindle", max_torque=1e4)],
    )
    found = tn.assess(line, (30.0, 40.0))
    for name, status in (("roll", Status.EXCEEDED), ("fork", Status.SATISFIED)):
        check = found.check(f"max speed fluctuation of {name}")
        response = tn.order_response(line, [check.speed])
        assert check.status is status
        assert check.value == pytest.approx(response.speed_fluctuation[0, response.inertias.index(name)], rel=1e-6)


def test_parametric_stability_as_stability_finds_it():
    line = tn.catalogue("two-shaft-cardan")
    unstable = line.replace("HookeJoint 1", angle="35 deg")
    frequency = float(tn.natural_frequencies(unstable).elastic[0])
    found = tn.assess(unstable, (0.8 * frequency, 1.2 * frequency))
    check = found.check("parametric stability")
    there = tn.stability(unstable, check.speed, about_steady_state=True)  # its joint swings by a degree
    assert (check.status, str(there.verdict)) == (Status.EXCEEDED, "unstable")
    assert check.margin < 0 and "subharmonic" in check.because
    assert check.value == pytest.approx(there.growth_rate, rel=1e-4, abs=1e-6)
    assert tn.assess(two_mass(), (90.0, 90.0)).check("parametric stability").status is Status.NOT_APPLICABLE


def test_speeds_that_are_no_range():
    for speeds in ((100.0, 50.0), (0.0, 0.0), (50.0, math.inf), (1.0, 2.0, 3.0)):
        with pytest.raises(tn.InputError, match="must be a lowest and a highest speed"):
            tn.assess(two_mass(), speeds)
    with pytest.raises(tn.InputError, match=r"operation\.speed: is not given"):
        tn.assess(two_mass())


def test_the_result_shows_itself():
    found = tn.assess(two_mass(tn.Limit(of="shaft", max_torque=100.0)), (60.0, 140.0))
    assert found.sentence.startswith("exceeded: max torque of shaft")
    assert str(found).splitlines()[0].endswith(found.sentence)
    assert list(found.data["status"].values) == [str(c.status) for c in found.checks]
    assert [row["check"] for row in found.table("rpm")] == [c.name for c in found.checks]
    order = [c.spare for c in found.checks if c.status is Status.SATISFIED]
    assert order == sorted(order)


def limited():
    """A line with every kind of limit whose value runs over the speeds."""
    tube = tn.Shaft(
        name="tube", outer_diameter="60 mm", length="0.5 m", material="steel", damping=C, tensile_strength="600 MPa"
    )
    soft = tn.Coupling(
        stiffness=K, damping=C, name="coupling", nominal_torque=100.0, maximum_torque=1000.0, vibratory_torque=900.0,
        heat_rating=5000.0,
    )  # fmt: skip
    teeth = tn.GearPair(name="gears", teeth_in=20, teeth_out=40, module="3 mm", mesh_stiffness=2e8, mesh_damping=500.0)
    parts = [
        tn.Disk(name="engine", inertia=J1, drive_share=1.0, excitation=[{"order": 2, "amplitude": T}]), tube,
        tn.Disk(name="pinion", inertia=0.01), teeth, tn.Disk(name="wheel", inertia=J2), soft,
        tn.Disk(name="load", inertia=J2, load_torque=60.0),
    ]  # fmt: skip
    limits = [
        tn.Limit(
            of="tube", max_torque=900.0, vibratory_torque=400.0, transient_vibratory_torque=800.0, max_stress="50 MPa",
            max_twist="1 deg", ship_shaft="flange",
        ),
        tn.Limit(of="load", max_acceleration=1000.0, max_speed_fluctuation="20 rpm"),
    ]  # fmt: skip
    return tn.Driveline(parts, limits=limits, operation=tn.Operation(speed=100.0, speed_range=[60.0, 105.0]))


def test_the_course_of_a_check_passes_through_what_it_says():
    checks = [check for check in tn.assess(limited()).checks if check.course is not None]
    assert len(checks) == 13
    for check in checks:
        course = check.course
        limit, at = next(iter(course.limits.values())), int(np.argmin(np.abs(course.speed - check.speed)))
        assert course.speed[at] == check.speed, check.name
        assert (course.value[at], limit[at]) == (pytest.approx(check.value), pytest.approx(check.limit)), check.name
        assert np.all(1 - course.value / limit >= check.margin - 1e-12), check.name
        if "max" not in check.name and course.by_order.size:  # one order alone shakes this line
            factor = check.value / course.by_order[at].max()
            assert factor == pytest.approx(1.0, rel=1e-3) or "rating" in check.name, check.name


@pytest.mark.parametrize(
    ("of", "limit", "label"),
    [
        ("load", {"max_speed_fluctuation": "1 rpm"}, "speed fluctuation [rpm]"),
        ("load", {"max_acceleration": 1.0}, "acceleration [rad/s²]"),
        ("tube", {"max_stress": "1 MPa"}, "stress [MPa]"),
    ],
)
def test_the_report_draws_what_binds(of, limit, label):
    """With its limit: not the torque of some shaft where motion or stress is limited."""
    line = tn.Driveline(
        limited().elements,
        limits=[tn.Limit(of=of, **limit)],
        operation=tn.Operation(speed=100.0, speed_range=[90.0, 105.0]),
    )
    seen = overview(line)
    shown = binding_picture(seen)
    drawn = shown.figure.axes[0]
    assert drawn.get_ylabel() == label and drawn.get_title(loc="left").endswith(f"of {of}")
    assert next(iter(limit)).replace("_", " ") in " ".join(one.get_label() for one in drawn.lines)
    assert shown.caption.startswith(label.partition(" [")[0].capitalize())


PAGE = Path(__file__).parents[2] / "docs" / "assess.md"


@pytest.mark.slow
def test_the_page_shows_what_happens():
    page = PAGE.read_text(encoding="utf-8")
    pattern, flags = r"^```{}\n(.*?)^```", re.DOTALL | re.MULTILINE
    blocks, texts = (re.findall(pattern.format(lang), page, flags) for lang in ("python", "text"))
    names: dict[str, object] = {}
    for code, shown in zip(blocks, texts, strict=True):
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(code, names)
        assert printed.getvalue() == shown


def test_the_command(tmp_path):
    limit = tn.Limit(of="shaft", max_torque=100.0)
    line = tn.Driveline(
        two_mass(limit).elements, limits=[limit], operation=tn.Operation(speed_range=[60.0, 140.0], speed_unit="Hz")
    )
    tn.dump(line, tmp_path / "line.toml")
    found = CliRunner().invoke(app, ["assess", str(tmp_path / "line.toml"), "--json"])
    assert found.exit_code == 0, found.output
    content = json.loads(found.stdout)
    assert (content["verdict"], content["speed_unit"]) == ("exceeded", "Hz")
    assert content["checks"][0]["name"] == "max torque of shaft"
    assert content["checks"][0]["speed"] == pytest.approx(125.0 / (2 * math.pi), rel=0.01)
    text = CliRunner().invoke(app, ["assess", str(tmp_path / "line.toml")]).stdout
    assert text.startswith("exceeded: max torque of shaft") and "Hz" in text


def test_findings_of_an_overview_rank_by_margin_and_look_beyond_the_range():
    limits = [tn.Limit(of="shaft", max_torque=1000.0, vibratory_torque=100.0)]
    operation = tn.Operation(speed=90.0, speed_range=[80.0, 115.0])
    seen = overview(tn.Driveline(two_mass(*limits).elements, limits=limits, operation=operation))
    first, second = (str(f) for f in seen.findings[:2])
    assert first.startswith("danger: Vibratory torque of shaft is exceeded: ")
    assert second.startswith("caution: Just above the range (up to 20 %) max torque of shaft would be exceeded: ")
    assert seen.assessment.binding.name == "vibratory torque of shaft"
    free = overview(two_mass(), speed=125.0).findings
    assert not any("exceeded" in str(f) for f in free)
    assert any("torque without limit" in str(f).lower() for f in free)


def test_beyond_the_range_every_load_case_is_looked_at_and_what_no_table_covers_is_said():
    """Resonance at 125 rad/s, the range ends at 115 rad/s, the table at 130 rad/s or already at 120 rad/s."""
    limits = [tn.Limit(of="shaft", max_torque=1000.0)]
    cases = (tn.LoadCase(name="full", loads={"load": 800.0}),)
    operation = tn.Operation(speed=90.0, speed_range=[80.0, 115.0], load_cases=cases)
    shaken = {"order": 2, "torques": [0.0, 800.0], "amplitudes": [1.0, 40.0]}
    parts = two_mass(*limits).replace("engine", excitation=[shaken]).elements
    said = [str(f) for f in overview(tn.Driveline(parts, limits=limits, operation=operation)).findings]
    (just,) = [one for one in said if "Just above" in one]
    assert "max torque of shaft would be exceeded" in just and just.endswith("load case full.")
    short = {"order": 2, "speeds": [60.0, 120.0], "amplitudes": [40.0, 40.0]}
    parts = two_mass(*limits).replace("engine", excitation=[short]).elements
    said = [str(f) for f in overview(tn.Driveline(parts, limits=limits, operation=operation)).findings]
    beyond, uncovered = [one for one in said if "Just above" in one]
    assert "max torque of shaft would be exceeded" in beyond  # up to 120 rad/s it can be told
    ends = "1145.9 rpm to 1317.8 rpm, the table of engine covers 572.958 rpm to 1145.92 rpm; extend it"
    assert f"no torque is judged: {ends}" in uncovered
    assert not any("Just below" in one for one in said if "no torque" not in one)


def test_sentences_of_the_report_have_the_signs_of_units():
    said = with_signs("12.5 deg, 3 N*m*s/rad, 2 kg*m^2 and 300 rad/s^2 of Shaft *.damping, 5 degrees")
    assert said == "12.5°, 3 N m s/rad, 2 kg m² and 300 rad/s² of Shaft *.damping, 5 degrees"


def test_a_driven_line_with_unstable_ranges_has_its_response_solved_once_at_every_speed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """How far it swings was looked at over the whole range; the search takes what of that is stable as it is."""
    looked: list[float] = []

    def counted(assembly: Any, speed: Any, **more: Any) -> Any:
        looked.extend(speed.tolist())
        return order_spectrum(assembly, speed, **more)

    parts: list[Any] = [tn.ConstantSpeed()]
    for angle in (0.3, 0.0):
        parts += [tn.Shaft(stiffness=1.0, damping=0.002), tn.Disk(inertia=1.0), tn.HookeJoint(angle=angle)]
    line = tn.Driveline(parts[:-1], limits=[tn.Limit(of="Shaft 1", max_torque=1e3)])
    monkeypatch.setattr(assessment_input, "order_spectrum", counted)
    check = tn.assess(line, (0.5, 1.8)).check("parametric stability")
    assert len(check.barred) == 3
    assert len(looked) == len(set(looked)) > 100


@pytest.mark.parametrize(("speed", "outside"), [(90.0, False), (110.0, False), (89.9, True), (500.0, True)])
def test_an_operating_speed_beyond_the_range_is_said(speed, outside):
    """No check looks where the line runs, which a verdict of the range would hide."""
    parts = [
        tn.Disk(inertia=0.2, excitation=[{"order": 2, "amplitude": 100.0}]),
        tn.Shaft(stiffness=1e4, damping=2.0, name="shaft"),
        tn.Disk(inertia=0.8),
    ]
    running = tn.Operation(speed=speed, speed_range=(90.0, 110.0), speed_unit="rad/s")
    line = tn.Driveline(parts, limits=[tn.Limit(of="shaft", max_torque=400.0)], operation=running)
    said = [one for one in tn.assess(line).findings if "outside its speed_range" in one.sentence]
    assert bool(said) == outside
    assert not outside or f"It runs at {speed:g} rad/s, outside its speed_range, 90 rad/s to 110 rad/s" in str(said[0])
    judged_there = tn.assess(line, (80.0, 600.0)).findings
    assert not any("outside its speed_range" in one.sentence for one in judged_there)


def test_what_load_cases_say_alike_is_said_once_with_the_largest_share():
    """Orders of a fan that swings are taken at its mean angle, in every load case by another share."""

    def line(load, *cases):
        fan = tn.Fan(name="fan", inertia=0.8, quadratic_load=load, excitation=[{"order": 5, "share": 0.3}])
        running = tn.Operation(speed=100.0, speed_range=(90.0, 110.0), speed_unit="rad/s", load_cases=cases)
        parts = [tn.ConstantSpeed(), tn.Shaft(stiffness=2e5, damping=2.0, name="shaft"), fan]
        return tn.Driveline(parts, operation=running)

    def said(of):
        return [one.sentence for one in tn.assess(of).findings if "can shift up to" in one.sentence]

    def share(sentence):
        return float(re.search(r"up to ([\d.]+) %", sentence)[1])

    factors = {"low": 0.5, "high": 3.0, "middle": 2.0}
    alone = [share(*said(line(0.1 * factor))) for factor in (1.0, *factors.values())]
    together = said(line(0.1, *(tn.LoadCase(name=name, factors={"fan": one}) for name, one in factors.items())))
    assert len(set(alone)) > 2
    assert [share(one) for one in together] == [max(alone)]
    assert together[0].startswith("Torque is applied")
