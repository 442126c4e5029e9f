"""Derivatives against closed forms and against central differences of the public analyses."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from oracles.sampling import quick_only

import trunnion as tn
from trunnion.design.sensitivity.differences import slope
from trunnion.results.files import read_dataset, save_dataset


def chain(**changes):
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=900.0, damping=0.4, fork_offset=0.3, name="front"),
            tn.Disk(inertia=0.02, viscous_load=0.01, name="hub"),
            tn.HookeJoint(angle=0.3, name="joint 1"),
            tn.Shaft(
                outer_diameter=0.03, inner_diameter=0.024, length=1.5, shear_modulus=79e9, density=7850.0,
                loss_factor=0.02, loss_factor_frequency=200.0, fork_offset=0.7, name="tube",
            ),
            tn.Disk(inertia=0.015, name="middle"),
            tn.HookeJoint(angle=0.2, plane=0.4, name="joint 2"),
            tn.Shaft(stiffness=3e3, damping=0.3, name="rear"),
            tn.Disk(inertia=0.4, load_torque=15.0, name="load"),
        ]
    )  # fmt: skip
    return line.replace_all(changes) if changes else line


def geared():
    """Free, straight, with varying mesh stiffness: two multipliers are set aside."""
    return tn.Driveline(
        [
            tn.Disk(inertia=0.05, load_torque=-30.0, name="motor"),
            tn.Shaft(stiffness=5e3, damping=0.8, name="shaft"),
            tn.Disk(inertia=0.01, name="pinion side"),
            tn.GearPair(
                teeth_in=20, teeth_out=20, module=0.003, mesh_stiffness=2e7, mesh_damping=400.0,
                stiffness_variation=[{"order": 1, "share": 0.2, "phase": 0.3}], name="mesh",
            ),
            tn.Disk(inertia=0.02, load_torque=30.0, name="wheel"),
        ]
    )  # fmt: skip


def common():
    """One damping ratio that holds at the lowest elastic mode, wherever that lies."""
    parts = [
        tn.ConstantSpeed(), tn.Shaft(stiffness=1.0), tn.Disk(inertia=1.0), tn.HookeJoint(angle=0.3),
        tn.Shaft(stiffness=1.3), tn.Disk(inertia=2.0),
    ]  # fmt: skip
    return tn.Driveline(parts, damping_ratio=0.02)


def tripod():
    parts = [
        tn.ConstantSpeed(), tn.Shaft(stiffness=1.0, damping=0.01), tn.Disk(inertia=1.0),
        tn.TripodJoint(angle=0.5, radius=0.05, length=0.25), tn.Shaft(stiffness=1.3, damping=0.02),
        tn.Disk(inertia=2.0),
    ]  # fmt: skip
    return tn.Driveline(parts)


LINES = {"chain": (chain, 170.0), "geared": (geared, 90.0), "common damping": (common, 1.1), "tripod": (tripod, 0.9)}


def central(values, line, path, value, step):
    """Central difference of fourth order of ``values(line)`` by one number."""
    packed = tn.driveline.parameters.pack(line)
    columns = packed.resolve(path)

    def at(shift):
        numbers = packed.values.copy()
        columns.put(numbers, value + shift)
        return np.asarray(values(packed.line_at(numbers)))

    far, near = at(2 * step) - at(-2 * step), at(step) - at(-step)
    return (8 * near - far) / (12 * step)


@pytest.mark.parametrize("name", LINES)
def test_growth_and_modes_follow_every_parameter_as_differences_do(name):
    make, speed = LINES[name]
    line = make()
    found = tn.sensitivity(line, speed, of=["frequencies", "growth"])
    assert {q.method for q in found.quantities} == {"exact"} and not any(q.refused for q in found.quantities)

    def values(changed):
        modes, stable = tn.natural_frequencies(changed), tn.stability(changed, speed, tolerance=1e-12)
        first = int(modes.rigid_body)
        return [*modes.frequency[first:], *modes.damping_ratio[first:], stable.growth_rate, stable.spectral_radius]

    expected = values(line)
    order = [q.value for q in found.quantities]
    assert order == pytest.approx(expected, rel=1e-9)
    tried = 0
    for p, path in enumerate(found.parameters):
        value = float(found.parameter_value[p])
        if path.endswith("load_torque") and name == "geared":
            continue  # torques would not balance
        step = 2e-4 * (abs(value) if found.parameter_unit[p] != "rad" else 1.0)
        if not value and found.parameter_unit[p] != "rad":
            continue
        slopes = central(values, line, path, value, step)
        size = np.abs(expected) / (step / 2e-4)
        assert np.all(np.abs(found.derivative[:, p] - slopes) <= 1e-6 * np.maximum(np.abs(slopes), size * 1e-2)), path
        assert np.all(found.error[:, p] <= 1e-6 * np.maximum(np.abs(slopes), size)), path
        tried += 1
    assert tried >= 6


def test_two_disks_by_hand():
    k, j1, j2 = 1e4, 0.2, 0.8
    line = tn.Driveline(
        [
            tn.Disk(inertia=j1, excitation=[{"order": 2, "amplitude": 100.0}], name="engine"),
            tn.Shaft(stiffness=k, damping=2.0, name="shaft"),
            tn.Disk(inertia=j2, name="mass"),
        ]
    )
    found = tn.sensitivity(line, 100.0, of=["frequencies", "torques"])
    assert found.parameters == (
        "engine.inertia", "engine.excitation 1 amplitude", "engine.excitation 1 phase", "shaft.stiffness",
        "shaft.damping", "shaft.fork_offset", "mass.inertia",
    )  # fmt: skip
    logarithmic = dict(zip(found.parameters, found.logarithmic[0], strict=True))
    reduced = j1 * j2 / (j1 + j2)
    elastic, lost = k / reduced, (2.0 / (2 * reduced)) ** 2
    damped = elastic - lost  # ω_d² = k/μ − (c/2μ)²
    assert logarithmic["shaft.stiffness"] == pytest.approx(elastic / (2 * damped), rel=1e-10)
    assert logarithmic["shaft.damping"] == pytest.approx(-lost / damped, rel=1e-8)
    by_mass = (2 * lost - elastic) / (2 * damped)
    assert logarithmic["engine.inertia"] == pytest.approx(by_mass * j2 / (j1 + j2), rel=1e-10)
    assert logarithmic["mass.inertia"] == pytest.approx(by_mass * j1 / (j1 + j2), rel=1e-10)

    def torque(k, c, j1, j2, amplitude):
        w, pull = 200.0, k + 200j * c
        x = np.linalg.solve([[pull - j1 * w * w, -pull], [-pull, pull - j2 * w * w]], [amplitude, 0.0])
        return abs(pull * (x[1] - x[0]))

    at = {"shaft.stiffness": 0, "shaft.damping": 1, "engine.inertia": 2, "mass.inertia": 3}
    here = [k, 2.0, j1, j2, 100.0]
    slopes = found.derivatives("peak torque of shaft at 100 rad/s")
    for path, place in at.items():
        h = 1e-5 * here[place]
        ends = [here.copy(), here.copy()]
        ends[0][place] -= h
        ends[1][place] += h
        by_hand = (torque(*ends[1]) - torque(*ends[0])) / (2 * h)
        assert slopes[path] == pytest.approx(by_hand, rel=1e-6), path
    assert slopes["engine.excitation 1 amplitude"] == pytest.approx(torque(*here) / 100.0, rel=1e-9)
    assert slopes["engine.excitation 1 phase"] == pytest.approx(0.0, abs=1e-9)


def shaken(line):
    """The line with two orders on its last disk, one of which shares its harmonics with the joints."""
    last = line.names[-1]
    orders = [{"order": 2, "amplitude": 20.0, "phase": 0.4}, {"order": 3, "amplitude": 11.0}]
    return line.replace(last, excitation=orders)


@pytest.mark.parametrize("name", quick_only(["common damping", "tripod"], LINES))
def test_torques_follow_every_parameter_as_differences_do(name):
    make, speed = LINES[name]
    line = shaken(make())
    found = tn.sensitivity(line, speed, of=["torques"])
    assert {q.method for q in found.quantities} == {"exact"}

    def values(changed):
        answer = tn.order_response(changed, speed)
        return np.stack([answer.peak_torque[0], answer.vibratory_torque[0]]).ravel()

    expected = values(line)
    assert [q.value for q in found.quantities] == pytest.approx(expected, rel=1e-12)
    tried = 0
    for p, path in enumerate(found.parameters):
        value = float(found.parameter_value[p])
        if (path.endswith("load_torque") and name == "geared") or np.isnan(found.derivative[:, p]).any():
            continue  # torques would not balance; a kink
        size = 1.0 if found.parameter_unit[p] == "rad" else abs(value)
        if not size:
            continue
        slopes = central(values, line, path, value, 2e-5 * size)
        scale = np.maximum(np.abs(slopes), 1e-3 * np.abs(expected) / size)
        assert np.all(np.abs(found.derivative[:, p] - slopes) <= 1e-6 * scale), path
        assert np.all(found.error[:, p] <= 1e-6 * scale), path
        tried += 1
    assert tried >= 8


@pytest.mark.parametrize(
    "damping, beside", [(2.0, 3e-6), (1e-2, 3e-6), (1e-3, 3e-6), (5e-3, -5e-4), (2e-4, 2e-4), (1e-3, -2.5e-4)]
)
def test_slopes_at_a_sharp_resonance_by_hand(damping, beside):
    """|T| = F |p| J₂/|J₁J₂ω² − p(J₁ + J₂)|, p = k + iωc, beside its peak: at 3e-6 steps that follow it are tiny;
    further out damping turns the response rather than changing its size, and rounding is a larger part of its slope.
    """
    k, j1, j2, force = 1e4, 0.2, 0.8, 100.0
    speed = np.sqrt(k * (1 / j1 + 1 / j2)) / 2 * (1 + beside)
    engine = tn.Disk(inertia=j1, excitation=[{"order": 2, "amplitude": force}], name="engine")
    shaft = tn.Shaft(stiffness=k, damping=damping, name="shaft")
    line = tn.Driveline(
        [engine, shaft, tn.Disk(inertia=j2, name="mass")], limits=[tn.Limit(of="shaft", vibratory_torque=1e3)]
    )
    w = 2 * speed
    p = k + 1j * w * damping
    under = j1 * j2 * w**2 - p * (j1 + j2)
    torque = force * p * j2 / under
    by_p = force * j2 * j1 * j2 * w**2 / under**2
    by_first, by_second = -torque * (j2 * w**2 - p) / under, torque / j2 - torque * (j1 * w**2 - p) / under
    expected = {
        "shaft.stiffness": by_p, "shaft.damping": 1j * w * by_p, "engine.inertia": by_first, "mass.inertia": by_second,
    }  # fmt: skip
    check = "vibratory torque of shaft"
    found = tn.sensitivity(line, speed, of=["torques", "checks"], checks=[check])
    of_check, of_torque = (found.derivatives(name) for name in (check, found.quantities[0].name))
    assert found.quantity(check).method == "exact" and found.quantity(check).kind == "check"
    for path, change in expected.items():
        exact = float((torque.conjugate() * change).real / abs(torque))
        assert of_torque[path] == pytest.approx(exact, rel=2e-8), path
        assert of_check[path] == pytest.approx(exact, rel=2e-8), path
        place = found.parameters.index(path)
        for q in [i for i, one in enumerate(found.quantities) if "torque" in one.kind or one.name == check]:
            off, error = abs(found.derivative[q, place] - exact), found.error[q, place]
            assert off <= error + 1e-12 * abs(exact) and error <= 1e-6 * abs(exact), (path, q)


def test_a_peak_on_both_sides_of_zero_has_a_kink():
    """A torque that swings as far down as up: any mean torque raises its larger side."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=2.0, name="shaft"),
            tn.Disk(inertia=0.8, excitation=[{"order": 1, "amplitude": 5.0}], load_torque=0.0, name="mass"),
        ]
    )  # fmt: skip
    found = tn.sensitivity(line, 60.0, ["mass.load_torque", "mass.inertia"], of="torques")
    peak, vibratory = (q.name for q in found.quantities)
    assert found.kinks(peak) == ("mass.load_torque",) and not found.kinks(vibratory)
    assert found.error[0, 0] == pytest.approx(1.0, rel=1e-6) and found.derivatives(vibratory)["mass.load_torque"] == 0
    assert np.isfinite(found.derivative[0, 1])


def test_patterns_are_their_members_and_factors_the_sums_of_them():
    line = chain()
    members = ["joint 1.angle", "joint 2.angle"]
    found = tn.sensitivity(line, 170.0, ["joint *.angle", "factor of Shaft *.damping"], of="growth")
    assert found.parameters == (*members, "factor of Shaft *.damping")
    assert tn.sensitivity(line, 170.0, ["HookeJoint *.angle"], of="growth").parameters == tuple(members)
    factor = found.derivative[0, 2]
    parts = tn.sensitivity(line, 170.0, ["front.damping", "rear.damping"], of="growth").derivative[0]
    assert factor == pytest.approx(parts @ [0.4, 0.3], rel=1e-9)


def test_a_bent_line_that_starts_free_follows_its_own_motion():
    line = tn.Driveline(
        [
            tn.Disk(inertia=0.5, drive_share=1.0, name="motor"),
            tn.Shaft(stiffness=2e4, damping=8.0, name="front"),
            tn.Disk(inertia=0.05, name="yoke"),
            tn.HookeJoint(angle=0.3, name="joint"),
            tn.Shaft(stiffness=1e4, damping=4.0, name="rear"),
            tn.Disk(inertia=0.3, viscous_load=0.5, name="load"),
        ]
    )
    found = tn.sensitivity(line, 60.0, ["load.viscous_load", "load.inertia"], of="growth")
    assert {q.method for q in found.quantities} == {"differences"}
    for p, path in enumerate(found.parameters):
        value = float(found.parameter_value[p])
        slope = central(lambda one: tn.stability(one, 60.0).growth_rate, line, path, value, 0.01 * value)
        assert found.derivative[0, p] == pytest.approx(float(slope), rel=1e-4), path


OMEGA = (5**0.5 - 1) / 2
"""Lowest natural frequency of two equal shafts and disks."""


def test_coalescing_and_equal_multipliers_are_refused():
    line = tn.catalogue("two-shaft-cardan", damping_ratio=0.01)
    low, high = 0.01, 0.3  # on the axis of a tongue two multipliers meet on the real axis, below its tip

    def real(angle):
        found = tn.stability(line.replace("HookeJoint 1", angle=angle), OMEGA, tolerance=1e-12)
        return abs(found.multipliers[0].imag) < 1e-12

    assert not real(low) and real(high)
    for _ in range(48):
        middle = (low + high) / 2
        low, high = (low, middle) if real(middle) else (middle, high)
    met = tn.sensitivity(line.replace("HookeJoint 1", angle=low), OMEGA, of="growth")
    assert "coalesce" in met.quantities[0].refused and np.isnan(met.derivative).all()
    assert "no derivative, two multipliers coalesce" in str(met)
    undamped = line.replace_all({"Shaft 1": {"damping": 0.0}, "Shaft 2": {"damping": 0.0}})
    equal = tn.sensitivity(undamped, 1.2, of="growth")
    assert "equally large" in equal.quantities[0].refused


def test_modes_of_one_frequency_are_refused():
    arm = [tn.Shaft(stiffness=1.0, damping=0.01), tn.Disk(inertia=1.0)]
    parts = [
        tn.ConstantSpeed(), tn.Shaft(stiffness=1.0, damping=0.01), tn.Disk(inertia=1.0, name="hub"), *arm,
        tn.Shaft(stiffness=1.0, damping=0.01, after="hub"), tn.Disk(inertia=1.0),
        tn.Shaft(stiffness=1.0, damping=0.01, after="hub"), tn.Disk(inertia=1.0),
    ]  # fmt: skip
    found = tn.sensitivity(tn.Driveline(parts), of="frequencies")
    said = {q.name: q.refused for q in found.quantities if q.kind == "frequency"}
    assert said["natural frequency of mode 2"] == "modes 2 and 3 have one frequency"
    assert not said["natural frequency of mode 1"] and np.isfinite(found.derivative[0]).all()


def test_tips_follow_as_tongues_found_anew():
    line = tn.catalogue("two-shaft-cardan", damping_ratio=0.01)

    def tips(one):
        return tn.tongues(one, ("speed", 1.5, 1.75), ("HookeJoint 1.angle", 0.05, 0.6), rows=5)

    found = tn.sensitivity(line, 1.2, of=[], tips=tips(line))
    assert [q.method for q in found.quantities] == ["implicit"] * 2
    slopes = central(lambda one: tips(one)[0].tip, line, "Disk 2.inertia", 1.0, 1e-3)
    p = found.parameters.index("Disk 2.inertia")
    assert found.derivative[:, p] == pytest.approx(slopes, rel=3e-6, abs=3e-7)
    own = found.parameters.index("HookeJoint 1.angle")
    assert found.derivative[:, own] == pytest.approx(
        [0, 0], abs=1e-9
    )  # the tip is found along it, whatever the line has


def test_checks_at_the_speed_where_they_bind():
    line = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=1e3, damping=0.5, name="front"), tn.Disk(inertia=0.05, name="hub"),
            tn.HookeJoint(angle=0.25, name="joint"), tn.Shaft(stiffness=2e3, damping=0.6, name="rear"),
            tn.Disk(inertia=0.1, load_torque=10.0, name="load"),
        ],
        operation=tn.Operation(speed_range=(20.0, 60.0), load_cases=[tn.LoadCase(name="hill", loads={"load": 30.0})]),
        limits=[tn.Limit(of="rear", max_torque=80.0)],
    )  # fmt: skip
    name = "max torque of rear"
    judged = tn.assess(line).check(name)
    found = tn.sensitivity(line, of="checks", checks=[name, "parametric stability"])
    one = found.quantity(name)
    assert one.value == pytest.approx(judged.value, rel=1e-3) and one.speed == pytest.approx(judged.speed, rel=0.02)
    slopes = found.derivatives(name)
    for path, value in (("rear.stiffness", 2e3), ("joint.angle", 0.25), ("front.damping", 0.5)):
        slope = central(
            lambda c: tn.assess(c, (one.speed, one.speed)).check(name).value, line, path, value, 1e-3 * value
        )
        assert slopes[path] == pytest.approx(float(slope), rel=1e-6), path
    assert slopes["load.load_torque"] == 0.0  # the load case that binds states its own
    margin = found.derivatives(f"margin of {name}")
    assert margin["rear.stiffness"] == pytest.approx(-slopes["rear.stiffness"] / 80.0, rel=1e-9)
    grows = found.quantity("parametric stability")
    assert grows.method == "exact" and not grows.refused


def test_one_sided_where_a_number_cannot_be_negative():
    line = chain(front={"damping": 0.0})
    found = tn.sensitivity(line, 170.0, ["load.drive_share", "front.damping"], of="torques")
    assert np.isnan(found.derivative[:, 0]).all()  # beside a ConstantSpeed nothing shares the drive
    slope = found.derivatives("peak torque of rear at 170 rad/s")["front.damping"]
    ends = [tn.order_response(chain(front={"damping": d}), 170.0).peak_torque[0, 2] for d in (0.0, 1e-3)]
    assert slope == pytest.approx((ends[1] - ends[0]) / 1e-3, rel=1e-2)


def test_it_introduces_itself(tmp_path):
    found = tn.sensitivity(common(), 1.1)
    assert str(found).startswith("sensitivity of ") and "\n" not in repr(found)
    ranked = found.ranked("growth rate at 1.1 rad/s")
    assert [abs(one.change) for one in ranked] == sorted((abs(one.change) for one in ranked), reverse=True)
    assert {one.step_words for one in ranked} <= {"+1 %", "+1 deg", "+10 deg"}
    assert found.table("growth rate at 1.1 rad/s")[0]["parameter"] == ranked[0].parameter
    save_dataset(found.data.assign_attrs(format="s"), tmp_path / "s.nc")
    again = read_dataset(tmp_path / "s.nc", "s")
    assert again["derivative"].shape == found.derivative.shape
    assert json.loads(found.to_json())["kind"][0] in ("frequency", "check")
    axes = found.plot("growth rate at 1.1 rad/s")
    assert ranked[0].parameter in axes.get_yticklabels()[0].get_text()


def test_frequencies_alone_where_no_speed_is_known():
    found = tn.sensitivity(chain())
    assert {q.kind for q in found.quantities} == {"frequency", "damping ratio"}


def pair(second="17.2 deg"):
    """Two joints whose irregularities cancel where both bend alike."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(), tn.HookeJoint(angle="17.2 deg"), tn.Shaft(stiffness=1e4, damping=1.0),
            tn.Disk(inertia=0.5), tn.HookeJoint(angle=second), tn.Shaft(stiffness=1e4, damping=1.0),
            tn.Disk(inertia=0.5),
        ],
        operation=tn.Operation(speed=50.0),
    )  # fmt: skip


def test_a_cancelled_irregularity_has_a_kink_and_no_derivative():
    """U ≈ |β₁² − β₂²| grows either way: what central differences give is not a derivative."""
    found = tn.sensitivity(pair(), of=["checks"], checks=["uniformity"])
    angles = ("HookeJoint 1.angle", "HookeJoint 2.angle")
    assert set(angles) <= set(found.kinks("uniformity"))
    row = found.quantities.index(found.quantity("uniformity"))
    for path in angles:
        place = found.parameters.index(path)
        assert np.isnan(found.derivative[row, place])
        assert found.error[row, place] == pytest.approx(2 * math.tan(0.3002), rel=0.02)  # half of both sides' slopes
    assert "no derivative by HookeJoint 1.angle" in str(found) and "where it has a kink" in str(found)
    aside = tn.sensitivity(pair("12 deg"), of=["checks"], checks=["uniformity"])
    assert not aside.kinks("uniformity") and aside.derivatives("uniformity")["HookeJoint 1.angle"] > 0.5


def test_what_is_rounding_is_not_printed():
    """A joint that stands straight forces nothing, and follows nothing to first order."""
    parts = [
        tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.Disk(inertia=1.0), tn.HookeJoint(angle=0.0),
        tn.Shaft(stiffness=1e4), tn.Disk(inertia=1.0),
    ]  # fmt: skip
    found = tn.sensitivity(tn.Driveline(parts), 50.0, of=["torques"])
    assert all(found.sentence(q).endswith("follows none of these parameters") for q in found.quantities)


def test_a_line_that_can_only_turn_as_a_whole_has_no_growth_rate():
    found = tn.sensitivity(tn.Driveline([tn.Disk(inertia=1.0), tn.Disk(inertia=2.0)]), 50.0, of=["growth"])
    assert {q.refused for q in found.quantities} == {"the line can only turn as a whole"}


@pytest.mark.parametrize(
    ("values", "expected", "kink"),
    [
        (lambda x: np.array([abs(x), 2 + abs(x) + 3 * x]), [0.0, 3.0], True),
        (lambda x: np.array([math.sin(3 * x), x * x]), [3.0, 0.0], False),
        (lambda x: np.array([math.exp(x), abs(x) ** 3]), [1.0, 0.0], False),
    ],
)
def test_kinks_are_told_from_curves(values, expected, kink):
    found, error = slope(values)
    if kink:
        assert np.all(np.isnan(found)) and error == pytest.approx(np.ones(2), rel=1e-9)
    else:
        assert found == pytest.approx(np.array(expected), abs=1e-7) and np.all(error < 1e-6)


def test_a_long_line_against_differences_of_what_it_does():
    """Modes by Hill's blocks and responses solved together, against lines moved by hand and single analyses of them."""
    elements = [tn.ConstantSpeed()]
    for i in range(18):
        k = 1e5 * (2 + math.sin(1.3 * i * i))
        elements += [tn.Shaft(stiffness=k, damping=2e-5 * k), tn.Disk(inertia=0.1 + 0.01 * i)]
        if i in (5, 11):
            elements.append(tn.HookeJoint(angle=0.3))
    elements[-1] = tn.Disk(inertia=0.1, excitation=[{"order": 1.5, "amplitude": 20.0}])
    line, speed = tn.Driveline(elements), 150.0
    moved = {"Shaft 3.stiffness": 1e-4, "HookeJoint 2.angle": 1e-4, "Disk 7.inertia": 1e-4, "Shaft 9.damping": 1e-3}
    found = tn.sensitivity(line, speed, list(moved), of=["growth", "torques"])
    grows, spring = "growth rate at 150 rad/s", "peak torque of Shaft 4 at 150 rad/s"
    for path, share in moved.items():
        name, key = path.split(".")
        value = getattr(line.elements[line.names.index(name)], key)
        growth = central(lambda c: tn.stability(c, speed).growth_rate, line, path, value, share * value)
        assert found.derivatives(grows)[path] == pytest.approx(float(growth), rel=1e-4), path
        torque = central(
            lambda c: float(tn.order_response(c, [speed]).peak_torque[0, 3]), line, path, value, share * value
        )
        assert found.derivatives(spring)[path] == pytest.approx(float(torque), rel=1e-5), path


def test_modes_of_a_long_line_as_the_matrices_of_the_period_give_them(monkeypatch):
    """Growth rates of lines whose largest multiplier belongs to one mode, or to two that meet."""
    from trunnion.design.sensitivity import growth
    from trunnion.design.sensitivity.directions import Neighbourhood, directions_of
    from trunnion.equations.coefficients import assemble

    elements = [tn.ConstantSpeed()]
    for i in range(16):
        elements += [tn.Shaft(stiffness=2e5, damping=1e-3), tn.Disk(inertia=0.1)]
        if i in (2, 8):
            elements.append(tn.HookeJoint(angle=0.4))
    assembly = assemble(tn.Driveline(elements))
    first = 2 * math.sqrt(2e5 / 0.1) * math.sin(math.pi / 66)
    near, paths = Neighbourhood(assembly), ["Shaft 2.stiffness", "HookeJoint *.angle", "Disk 3.inertia"]
    directions = directions_of(assembly, paths)
    row = near.row(2 * first)
    one = growth.radius_slope(near, row, directions)
    monkeypatch.setattr(growth, "_by_modes", lambda *asked: None)
    other = growth.radius_slope(near, row, directions)
    assert one.radius > 1.05 and not one.refused
    assert one.radius == pytest.approx(other.radius, rel=1e-10)
    assert np.all(np.abs(one.slope - other.slope) <= one.error + other.error + 1e-8 * np.abs(one.slope))
