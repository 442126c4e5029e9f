"""Rules of practice and of makers against calculations with pen and paper, every step of them written out."""

from __future__ import annotations

import math

import numpy as np
import pytest

import trunnion as tn
from trunnion.design.assessment.check import Status
from trunnion.design.assessment.joint_angles import allowed_angle
from trunnion.design.assessment.measures import permissible_stress
from trunnion.design.assessment.ship_shafts import barred_range
from trunnion.driveline.limits import SHIP_SHAFTS
from trunnion.response.orders.result import frequency_factor


def pumped(**ratings):
    """An engine of 1.2 kg m² with 400 N m at order 3, a coupling of 40 kN m/rad and ψ = 0.8, a pump of 2 kg m²."""
    return tn.Driveline(
        [
            tn.Disk(name="engine", inertia=1.2, drive_share=1, excitation=[{"order": 3, "amplitude": 400.0}]),
            tn.Coupling(name="coupling", stiffness=40e3, relative_damping=0.8, **ratings),
            tn.Disk(name="pump", inertia=2.0, load_torque=200.0),
        ],
        limits=[tn.Limit(of="coupling", temperature_factor=1.2, starting_factor=1.5)],
    )


def test_coupling_at_1500_rpm():
    """Ω = 157.080 rad/s, order 3 at ν = 471.239 rad/s = 75 Hz, S_f = √7.5 = 2.73861.

    η = ψ/2π = 0.127324, ηk = 5092.96, |k(1 + iη)| = 40 000 · 1.008073 = 40 322.9 N m/rad.
    Reduced inertia 1.2 · 2/3.2 = 0.75, share of the far side 2/3.2 = 0.625.
    k − mν² = 40 000 − 0.75 · 222 066 = −126 549.5; with ηk: |.| = 126 652.0.
    T_W = 400 · 0.625 · 40 322.9/126 652.0 = 79.594 N m; twist 79.594/40 322.9 = 1.97391e-3 rad.
    Heat: ½ · 5092.96 · 471.239 · 1.97391e-3² = 4.6756 W.
    """
    line = pumped(nominal_torque=400.0, maximum_torque=900.0, vibratory_torque=250.0, heat_rating=50.0)
    found = tn.assess(line, (tn.rpm(1500), tn.rpm(1500)))
    by_hand = {
        "nominal torque rating": (200.0 * 1.2, 400.0),
        "maximum torque rating": ((200.0 + 79.594) * 1.2 * 1.5, 900.0),
        "rated torque": (79.594 * 2.73861, 250.0 / 1.2),
        "heat rating": (4.6756 * 1.2, 50.0),
    }
    for name, (value, rating) in by_hand.items():
        check = found.check(f"{name} of coupling")
        assert check.value == pytest.approx(value, rel=2e-5), name
        assert check.margin == pytest.approx(1 - value / rating, abs=2e-5), name
        assert check.status is (Status.SATISFIED if value <= rating else Status.EXCEEDED), name
    assert found.check("rated torque of coupling").status is Status.EXCEEDED  # 218.0 against 208.3 N m
    assert "S_t = 1.2, S_f = 2.739" in found.check("rated torque of coupling").inputs


def test_frequency_factor_of_a_coupling():
    """1 up to 10 Hz, √(f/10 Hz) above: 14.4 Hz → 1.2, 40 Hz → 2, 90 Hz → 3."""
    assert frequency_factor(tn.hz(np.array([0.0, 9.9, 10.0]))).tolist() == [1.0, 1.0, 1.0]
    assert frequency_factor(tn.hz(np.array([14.4, 40.0, -90.0]))) == pytest.approx([1.2, 2.0, 3.0])


def test_ratings_that_are_not_stated_are_named():
    found = tn.assess(pumped(nominal_torque=400.0), (150.0, 150.0))
    check = found.check("heat rating of coupling")
    assert check.status is Status.NOT_APPLICABLE and check.because == "coupling states no heat_rating"


def test_a_coupling_without_ratings_is_said_once():
    (check,) = [one for one in tn.assess(pumped(), (150.0, 150.0)).checks if "rating" in one.name]
    assert check.name == "ratings of coupling" and check.status is Status.NOT_APPLICABLE
    assert check.because == "coupling states no nominal_torque, maximum_torque, vibratory_torque or heat_rating"


@pytest.mark.parametrize(
    ("rpm", "degrees"),
    [
        (3500, 5.0), (3750, 4.6), (4000, 4.2), (4250, 3.95), (4500, 3.7), (4750, 3.45), (5000, 3.2), (5200, 3.0),
    ],
)  # fmt: skip
def test_largest_joint_angle_by_speed(rpm, degrees):
    """The table of the makers, straight between its points; 3° beyond it."""
    assert allowed_angle(tn.rpm(rpm)) == pytest.approx(tn.deg(degrees), rel=1e-12)


def one_joint(degrees, ratio=1.0):
    front = [] if ratio == 1.0 else [tn.Ratio(ratio=ratio), tn.Disk(inertia=0.01)]
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1e5, damping=20.0),
            tn.Disk(inertia=0.02),
            *front,
            tn.HookeJoint(angle=tn.deg(degrees), name="joint"),
            tn.Shaft(stiffness=1e5, damping=20.0),
            tn.Disk(inertia=0.1),
        ]
    )


def test_one_joint_of_ten_degrees():
    """U = sin 10° tan 10° = 0.173648 · 0.176327 = 0.030619, 11.34 times 0.0027.

    Largest acceleration 0.030626 Ω² (its cube law differs from U by 2e-4): 306.26 rad/s² at 100 rad/s, of 300 allowed.
    """
    found = tn.assess(one_joint(10.0), (100.0, 100.0))
    even = found.check("uniformity")
    assert even.value == pytest.approx(0.030619, rel=2e-5) and even.margin == pytest.approx(1 - 11.340, rel=1e-3)
    shake = found.check("acceleration behind the joints")
    assert shake.value == pytest.approx(306.26, rel=2e-5) and shake.margin == pytest.approx(-0.02087, rel=1e-3)
    assert found.check("smallest angle of joint").margin == pytest.approx(10 / 0.5 - 1)
    assert found.check("equal joint angles").status is Status.NOT_APPLICABLE


def test_a_joint_is_judged_at_the_speed_of_its_own_shaft():
    """4.5° behind a step-up of 2.5 at 1600 rpm: 4000 rpm of its shaft, 4.2° allowed; the acceleration is that of it.

    The largest acceleration is β²ω² to leading order: 0.0061685 · 418.88² = 1082.3 rad/s².
    """
    found = tn.assess(one_joint(4.5, 0.4), (tn.rpm(1600), tn.rpm(1600)), unit="rpm")
    check = found.check("angle of joint")
    assert check.margin == pytest.approx(1 - 4.5 / 4.2) and "at 4000 rpm of its shaft" in check.because
    assert found.check("acceleration behind the joints").value == pytest.approx(1082.3, rel=5e-3)


def test_permissible_stress_of_a_shaft_of_300_mm():
    """σ_B = 500 N/mm², d = 300 mm: 300^0.2 = 3.12913, C_D = 0.35 + 0.93/3.12913 = 0.647207; 660/18 = 36.6667.

    λ = 0.6: 3 − 0.72 = 2.28, ±54.106 N/mm²; λ = 0.9 and more: · 1.38, ±32.749 N/mm². A tapered keyway 0.60 of it.
    """
    assert permissible_stress(500.0, 300.0, 1.0, 0.6) == pytest.approx(54.106, rel=2e-5)
    assert permissible_stress(500.0, 300.0, 1.0, 0.0) == pytest.approx(36.6667 * 0.647207 * 3, rel=2e-5)
    assert [permissible_stress(500.0, 300.0, 1.0, x) for x in (0.9, 1.0, 1.05)] == pytest.approx([32.749] * 3, rel=2e-5)
    assert permissible_stress(500.0, 300.0, 0.60, 0.6) == pytest.approx(32.464, rel=2e-5)
    assert permissible_stress(500.0, 300.0, 1.0, 0.8999) == pytest.approx(36.6667 * 0.647207 * 1.38036, rel=2e-5)


def test_barred_range_about_90_rpm():
    """λ_c = 0.6: 16 · 90/17.4 = 82.7586 to 17.4 · 90/16 = 97.875 rpm."""
    assert barred_range(90.0, 0.6) == (pytest.approx(82.7586, rel=1e-6), pytest.approx(97.875))


J1, J2, LENGTH, DIAMETER, DAMPING, QUADRATIC = 800.0, 600.0, 6.0, 0.2, 2000.0, 50.0


def ship(amplitude, feature="flange", **shaft):
    tube = {"outer_diameter": DIAMETER, "length": LENGTH, "damping": DAMPING, "name": "shaft"}
    material = shaft or {"shear_modulus": 79.3e9, "tensile_strength": 700e6}
    return tn.Driveline(
        [
            tn.Disk(inertia=J1, drive_share=1.0, excitation=[{"order": 6, "amplitude": amplitude}]),
            tn.Shaft(**tube, **material),
            tn.Disk(inertia=J2, quadratic_load=QUADRATIC),
        ],
        limits=[tn.Limit(of="shaft", ship_shaft=feature)],
        operation=tn.Operation(speed=tn.rpm(200), speed_range=[tn.rpm(40), tn.rpm(205)]),
    )


def stress_by_hand(amplitude, speed):
    """Stress [N/mm²]: two equations for the rotations, the slope 2cΩ of the propeller's load on the second.

    k = Gπd⁴/32L = 79.3e9 · 1.5708e-4/6 = 2.07607e6 N m/rad, W = πd³/16 = 1.5708e-3 m³.
    """
    k, section = 79.3e9 * math.pi * DIAMETER**4 / 32 / LENGTH, math.pi * DIAMETER**3 / 16
    nu = 6 * np.asarray(speed)
    z = k + 1j * nu * DAMPING
    a, b = z - J1 * nu**2, z - J2 * nu**2 + 1j * nu * 2 * QUADRATIC * np.asarray(speed)
    twist = amplitude * (z - b) / (a * b - z**2)
    return np.abs(z * twist) / section / 1e6


def test_a_ship_shaft_over_its_range():
    """Resonance at √(k (1/800 + 1/600))/6 = 12.97 rad/s = 123.8 rpm, λ = 0.619 of 200 rpm; σ_B counts to 600 N/mm²."""
    speeds = np.linspace(tn.rpm(40), tn.rpm(205), 200_001)
    ratio = speeds / tn.rpm(200)
    allowed = 760 / 18 * 0.67231 * np.where(ratio < 0.9, 3 - 2 * ratio**2, 1.38)
    share = stress_by_hand(24e3, speeds) / allowed
    worst = int(share.argmax())
    found = tn.assess(ship(24e3))
    check = found.check("IACS UR M68 of shaft")
    assert check.status is Status.EXCEEDED
    assert 1 - check.margin == pytest.approx(share[worst], rel=1e-3)  # the peak between its speeds
    assert check.speed == pytest.approx(speeds[worst], rel=3e-3)  # where the largest of its speeds lies
    # The barred range: the rule's about the worst speed, or that in which the limit is exceeded where it is wider.
    over = speeds[share > 1]
    low, high = barred_range(float(speeds[worst]), float(ratio[worst]))
    ((from_speed, to_speed),) = check.barred
    assert from_speed == pytest.approx(min(low, over[0]), rel=3e-3)
    assert to_speed == pytest.approx(max(high, over[-1]), rel=3e-3)
    passing = found.check("IACS UR M68 of shaft, passing")
    assert passing.margin == pytest.approx(1 - share[worst] / 1.7, rel=5e-3)  # C_K = 1
    kept = ship(24e3).model_copy(update={"limits": (tn.Limit(of="shaft", ship_shaft="flange", margin=0.9),)})
    assert tn.assess(kept).check("IACS UR M68 of shaft, passing").status is Status.EXCEEDED  # what must stay free


@pytest.mark.parametrize("feature", SHIP_SHAFTS)
def test_every_design_feature_takes_its_share(feature):
    """±τ_C goes with C_K, ±τ_T = 1.7 τ_C/√C_K with its root."""
    factor = {
        "flange": 1.0, "shrink fit": 1.0, "keyway tapered": 0.60, "keyway cylindrical": 0.45, "radial hole": 0.50,
        "slot": 0.30, "propeller shaft": 0.55, "propeller shaft forward": 0.80,
    }[feature]  # fmt: skip
    found = tn.assess(ship(60e3, feature))
    check, passing = found.check("IACS UR M68 of shaft"), found.check("IACS UR M68 of shaft, passing")
    ratio = check.speed / tn.rpm(200)
    steady = 760 / 18 * 0.67231 * factor * (3 - 2 * ratio**2 if ratio < 0.9 else 1.38)
    assert check.limit / 1e6 == pytest.approx(steady, rel=1e-4)
    assert passing.limit / 1e6 == pytest.approx(1.7 * steady / math.sqrt(factor), rel=5e-3)


def test_alloyed_steel_counts_to_800_in_intermediate_shafts_only():
    """42CrMo4 of 1000 N/mm²: (800 + 160)/(600 + 160) = 1.26316 times the limit; a propeller shaft has none of it."""
    steel = {"material": "42CrMo4", "tensile_strength": 1000e6}
    one, plain = (tn.assess(ship(1e3, **kind)).check("IACS UR M68 of shaft") for kind in (steel, {}))
    at = [760 / 18 * 0.67231 * (3 - 2 * (c.speed / tn.rpm(200)) ** 2) * 1e6 for c in (one, plain)]
    assert one.limit == pytest.approx(960 / 760 * at[0], rel=1e-4)
    assert plain.limit == pytest.approx(at[1], rel=1e-4)
    propeller = tn.assess(ship(1e3, "propeller shaft", **steel)).check("IACS UR M68 of shaft")
    assert "σ_B = 600 MPa" in propeller.inputs


def test_no_range_is_barred_near_the_rated_speed():
    """Rated 150 rpm puts the resonance at λ = 0.826: only the continuous limit counts there."""
    line = ship(24e3)
    near = line.model_copy(update={"operation": tn.Operation(speed=tn.rpm(150), speed_range=[tn.rpm(40), tn.rpm(155)])})
    passing = tn.assess(near).check("IACS UR M68 of shaft, passing")
    assert passing.status is Status.EXCEEDED and "no barred range at λ ≥ 0.8" in passing.because
    ratio = passing.speed / tn.rpm(150)
    assert ratio >= 0.8 and passing.limit == pytest.approx(760 / 18 * 0.67231 * (3 - 2 * ratio**2) * 1e6, rel=1e-4)


def test_a_limit_that_jumps_leaves_no_doubt_of_the_value_there():
    """The stress just at λ = 0.8, where the limit of passing falls to that of steady operation, is known closely."""
    line = ship(24e3, "propeller shaft")
    operation = tn.Operation(speed=tn.rpm(170), speed_range=[tn.rpm(40), tn.rpm(173)])
    passing = tn.assess(line.model_copy(update={"operation": operation})).check("IACS UR M68 of shaft, passing")
    at = 0.8 * tn.rpm(170)
    assert passing.speed == pytest.approx(at, rel=1e-9)
    assert passing.value / 1e6 == pytest.approx(float(stress_by_hand(24e3, at)), rel=1e-6)
    assert passing.limit / 1e6 == pytest.approx(760 / 18 * 0.55 * 0.67231 * (3 - 2 * 0.64), rel=1e-4)
    assert passing.error < 1e-5 * passing.value and "may be" not in passing.because


def test_numbers_stand_beside_each_other_in_one_unit():
    tube = tn.Shaft(outer_diameter="60 mm", length="0.5 m", material="steel", loss_factor=0.02, name="shaft")
    parts = [
        tn.Disk(inertia=0.2, drive_share=1.0, excitation=[{"order": 2, "amplitude": 100.0}]),
        tube,
        tn.Disk(inertia=0.8, load_torque=500.0),
    ]
    line = tn.Driveline(parts, limits=[tn.Limit(of="shaft", max_stress="120 MPa", max_torque="20 kN*m")])
    found = tn.assess(line, (50.0, 50.0))
    assert "MPa against 120 MPa at" in found.check("max stress of shaft").because
    assert "N m against 20000 N m at" in found.check("max torque of shaft").because.replace("2e+04", "20000")
    assert "times the least" in str(found.table("rpm"))  # of separation, which must be reached


def test_joints_that_cancel_leave_nothing():
    """Rounding of two equal joints is not shown as a tenth of a nanoradian."""
    parts = [
        tn.ConstantSpeed(), tn.Shaft(stiffness=1e5, damping=20.0), tn.Disk(inertia=0.02), tn.HookeJoint(angle="5 deg"),
        tn.Shaft(stiffness=1e5, damping=20.0), tn.Disk(inertia=0.02), tn.HookeJoint(angle="5 deg"),
        tn.Shaft(stiffness=1e5, damping=20.0), tn.Disk(inertia=0.1),
    ]  # fmt: skip
    found = tn.assess(tn.Driveline(parts), (100.0, 100.0))
    assert found.check("uniformity").because.startswith("U = 0 against 0.0027, as one joint of 0 deg")
    assert found.check("acceleration behind the joints").because.startswith("0 rad/s² against 300 rad/s²")


def test_the_mean_twist_of_a_soft_coupling_is_no_swing_of_a_joint():
    """A free line linear about its own motion: a coupling twisted by 0.25 rad on average in front of a joint."""
    parts = [
        tn.Disk(inertia=0.3, drive_share=1.0, excitation=[{"order": 2, "amplitude": 1.0}]),
        tn.Shaft(stiffness=1e3, damping=5.0),
        tn.Disk(inertia=0.05),
        tn.HookeJoint(angle="2 deg"),
        tn.Shaft(stiffness=2e4, damping=5.0),
        tn.Disk(inertia=1.0, load_torque=250.0),
    ]
    found = tn.order_response(tn.Driveline(parts), [150.0])
    assert abs(found.mean_twist[0, 0]) == pytest.approx(0.25, rel=0.02)
    assert found.joint_rotation[0] < 0.01 and bool(found.linear[0])


def test_findings_of_one_load_case_carry_its_name():
    parts = [
        tn.Disk(
            inertia=0.2, drive_share=1.0, excitation=[{"order": 2, "torques": [0.0, 900.0], "amplitudes": [5.0, 500.0]}]
        ),
        tn.Shaft(stiffness=1e4, damping=2.0, name="shaft"),
        tn.Disk(inertia=0.8, name="load", load_torque=10.0),
    ]
    operation = tn.Operation(speed=125.0, load_cases=(tn.LoadCase(name="full", loads={"load": 800.0}),))
    found = tn.assess(tn.Driveline(parts, operation=operation))
    assert any("Load case full: Torque is applied at the mean angle of" in str(f) for f in found.findings)
