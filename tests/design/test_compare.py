"""What changed between two lines, and what it did, against the analyses that it stands on."""

from __future__ import annotations

import json

import numpy as np
import pytest

import trunnion as tn
from trunnion.driveline.changes import changes
from trunnion.results.files import read_dataset, save_dataset


def line(**changed):
    made = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=1e3, damping=0.5, name="front"), tn.Disk(inertia=0.05, name="hub"),
            tn.HookeJoint(angle=0.25, name="joint"), tn.Shaft(stiffness=2e3, damping=0.6, name="rear"),
            tn.Disk(inertia=0.1, load_torque=10.0, name="load"),
        ],
        operation=tn.Operation(speed_range=(20.0, 60.0), load_cases=[tn.LoadCase(name="hill", loads={"load": 30.0})]),
        limits=[tn.Limit(of="rear", max_torque=80.0), tn.Limit(of="front", max_torque=5000.0)],
    )  # fmt: skip
    return made.replace_all(changed) if changed else made


def test_what_changed_is_named_with_units():
    a = line()
    b = tn.Driveline(
        [
            *a.elements[:2], tn.Disk(inertia=0.06, name="hub"), *a.elements[3:5],
            tn.Disk(inertia=0.1, load_torque=10.0, excitation=[{"order": 1, "amplitude": 2.0}], name="load"),
            tn.Shaft(stiffness="3 kN*m/rad", name="more"), tn.Disk(inertia=0.01, name="end"),
        ],
        operation=tn.Operation(speed_range=(20.0, 70.0)), limits=[tn.Limit(of="rear", max_torque=90.0)],
    )  # fmt: skip
    assert [str(one) for one in changes(a, b)] == [
        "hub, inertia: 0.05 kg m² → 0.06 kg m²",
        "load, excitation: none → [{ amplitude = 2.0, order = 1.0 }]",
        "operation, speed range: [20.0, 60.0] rad/s → [20.0, 70.0] rad/s",
        'operation, load case: [{ name = "hill", loads = { load = 30.0 } }] → none',
        "limit of rear, max torque: 80.0 N m → 90.0 N m",
        "limit of front removed",
        "more added: Shaft with stiffness 3 kN m/rad",
        "end added: Disk with inertia 0.01 kg m²",
    ]  # fmt: skip
    back = {(one.place, one.before, one.after) for one in changes(b, a)}
    assert {(one.place, one.after, one.before) for one in changes(a, b)} == back
    assert changes(a, a) == ()
    turned = tn.Driveline([*a.elements[:1], *a.elements[4:], *a.elements[1:4]])
    assert changes(tn.Driveline(a.elements), turned)[-1].key == "order of elements"


def test_what_it_did_is_what_the_analyses_say():
    a, b = line(), line(rear={"stiffness": 2.6e3}, joint={"angle": 0.3})
    found = tn.compare(a, b)
    assert [one.place for one in found.changes] == ["joint, angle", "rear, stiffness"]
    for side, one in (("before", a), ("after", b)):
        modes, judged = tn.natural_frequencies(one), tn.assess(one)
        got = [getattr(d, side) for d in found.of_kind("frequency")]
        assert got == pytest.approx(modes.frequency, rel=1e-12)
        assert [getattr(d, side) for d in found.of_kind("damping ratio")] == pytest.approx(modes.damping_ratio)
        binding = found.binding[side == "after"]
        assert binding.name == judged.binding.name
        check = judged.check("max torque of rear")
        margin = getattr(found.difference("margin of max torque of rear"), side)
        for each in (binding.margin, margin):  # compare looks for torques of all springs: other speeds, the same peak
            assert each == pytest.approx(check.margin, abs=1e-6) and check.error < 1e-4 * check.value
        peak = found.difference("peak torque of rear")
        at = getattr(peak, f"speed_{side}")
        hill = tn.order_response(one, at, load_case="hill")
        assert getattr(peak, side) == pytest.approx(hill.peak_torque[0, hill.springs.index("rear")], rel=1e-9)
        growth = found.difference("largest growth rate")
        at = getattr(growth, f"speed_{side}")
        loads = (one, one.with_load("hill"))  # about the motions that they make, as the joint swings
        exact = max(tn.stability(each, at, about_steady_state=True).growth_rate for each in loads)
        assert getattr(growth, side) == pytest.approx(exact, rel=1e-4)
        assert getattr(growth, side) == judged.check("parametric stability").value


def test_other_ranges_and_no_range():
    plain = tn.Driveline(line().elements)
    apart = tn.compare(plain, plain.replace("hub", inertia=0.06))
    assert apart.verdicts == (None, None) and {d.kind for d in apart.differences} == {"frequency", "damping ratio"}
    assert "no speeds are stated" in apart.sentence
    lent = tn.compare(line(), plain)  # a line without speeds is judged at those of the other one
    assert None not in lent.verdicts
    asked = tn.compare(plain, plain, (20.0, 30.0))
    assert asked.assessments[0].high == 30.0 and str(asked).endswith("the two descriptions are alike")


def test_a_line_that_nothing_varies_has_its_slowest_decay():
    parts = [tn.ConstantSpeed(), tn.Shaft(stiffness=100.0, damping=0.2), tn.Disk(inertia=1.0)]
    found = tn.compare(tn.Driveline(parts), tn.Driveline(parts).replace("Shaft 1", damping=0.4), (1.0, 2.0))
    growth = found.difference("largest growth rate")
    assert (growth.before, growth.after) == pytest.approx((-0.1, -0.2)) and np.isnan(growth.speed_before)


def test_it_introduces_itself(tmp_path):
    found = tn.compare(line(), line(rear={"stiffness": 2.6e3}))
    text = str(found)
    assert text.startswith("before → after: 1 change: ") and "\n" not in repr(found)
    assert "rear, stiffness: 2 kN m/rad → 2.6 kN m/rad" in text and "natural frequency of mode 1: " in text
    assert found.table()[0].keys() == {"quantity", "before", "after", "change"}
    save_dataset(found.data.assign_attrs(format="c"), tmp_path / "c.nc")
    assert read_dataset(tmp_path / "c.nc", "c").sizes["quantity"] == len(found.differences)
    assert json.loads(found.to_json())["change"] == ["rear, stiffness"]
    assert found.plot().get_xlabel().startswith("margin [%]")
    plain = tn.Driveline(line().elements)
    assert "change from" in tn.compare(plain, plain.replace("hub", inertia=0.06)).plot().get_xlabel()


def test_torques_at_narrow_peaks_are_those_of_the_peaks():
    """Between the speeds of a grid little damping's peak may seem lower than that of more damping."""
    before, after = (line(front={"damping": c}, rear={"damping": c}) for c in (0.004, 0.008))
    found = tn.compare(before, after, (60.0, 120.0)).difference("vibratory torque of front")
    assert found.after < 0.7 * found.before
    for one, most, speed in ((before, found.before, found.speed_before), (after, found.after, found.speed_after)):
        speeds = speed * np.linspace(1 - 2e-3, 1 + 2e-3, 401)
        near = [tn.order_response(one, speeds, load_case=case).vibratory_torque[:, 0] for case in (None, "hill")]
        assert most == pytest.approx(np.max(near), rel=1e-4)


def test_what_has_no_bound_is_not_called_missing():
    undamped = line(front={"damping": 0.0}, rear={"damping": 0.0}, joint={"angle": 0.4})
    speed = float(tn.natural_frequencies(undamped).frequency[0])
    found = tn.compare(undamped, line(joint={"angle": 0.4}), (0.98 * speed, 1.02 * speed))
    assert "margin of parametric stability: without bound → " in str(found)


def test_a_number_that_is_left_out_stands_at_its_default() -> None:
    """A fork offset and a damping that are taken away are zero; an excitation is none."""
    a = line(front={"fork_offset": "90 deg"}, rear={"damping": 3.0})
    b = line(front={"fork_offset": "0 deg"}, rear={"damping": 0.0})
    said = [str(one) for one in changes(a, b)]
    assert said == ["front, fork offset: 90 deg → 0 deg", "rear, damping: 3.0 N m s/rad → 0 N m s/rad"]
