"""Envelopes: the worst over load cases and schedules is what assess says at the worst place."""

from __future__ import annotations

import json

import numpy as np
import pytest

import trunnion as tn

TRAVEL = tn.Schedule(name="axle", travel=[-0.05, 0.0, 0.1], angles={"joint": ["1 deg", "4 deg", "14 deg"]})
PULL = tn.Schedule(name="pull", speed=[40.0, 60.0, 90.0], loads={"load": [20.0, 80.0, 10.0]})


def line(schedules: list[tn.Schedule], cases: tuple[tn.LoadCase, ...] = ()) -> tn.Driveline:
    parts = [
        tn.ConstantSpeed(),
        tn.Shaft(stiffness=2e3, damping=2.0, name="front"),
        tn.Disk(inertia=0.1, name="hub"),
        tn.HookeJoint(angle="4 deg", name="joint"),
        tn.Shaft(stiffness=1e3, damping=1.0, name="rear"),
        tn.Disk(inertia=0.2, load_torque=30.0, name="load"),
    ]
    operation = tn.Operation(
        speed_range=(40.0, 60.0), speed_unit="rad/s", application="road", load_cases=cases, schedules=schedules
    )
    limits = [tn.Limit(of="rear", max_torque=200.0, vibratory_torque=60.0)]
    return tn.Driveline(parts, operation=operation, limits=limits)


def test_a_line_at_a_point_of_a_schedule() -> None:
    one = line([TRAVEL, PULL])
    assert one.at_schedule("axle", 0.05).elements[3].angle == pytest.approx(np.radians(9))
    left = one.at_schedule("axle", 0.05).operation
    assert left is not None and "axle" not in [schedule.name for schedule in left.schedules]
    assert one.at_schedule("pull", 50.0).elements[5].load_torque == pytest.approx(50.0)
    with pytest.raises(tn.InputError, match="lies beyond the schedule, which goes from -0.05 to 0.1 m"):
        one.at_schedule("axle", 0.2)
    with pytest.raises(tn.InputError, match="did you mean"):
        one.at_schedule("axel", 0.0)


@pytest.mark.slow
def test_the_worst_is_what_assess_says_there() -> None:
    """Angles over travel, crossed with load cases: by hand, every place and case apart."""
    cases = (tn.LoadCase(name="hill", loads={"load": 90.0}),)
    one = line([TRAVEL], cases)
    found = tn.envelope(one, points=4)
    assert [round(p.value, 4) for p in found.places[1:]] == [-0.05, 0.0, 0.05, 0.1]
    for name in ("max torque of rear", "vibratory torque of rear", "parametric stability"):
        k = next(i for i, c in enumerate(found.checks) if c.name == name)
        margins = []
        for value in (-0.05, 0.0, 0.05, 0.1):
            there = one.replace("joint", angle=np.interp(value, [-0.05, 0.0, 0.1], np.radians([1, 4, 14])))
            margins.append(tn.assess(there, load_case="hill").check(name).margin)
        assert found.checks[k].margin <= min(margins) + 1e-12
        assert found.checks[k].margin == np.nanmin(found.margin[:, k])
        assert found.places[found.where[k]].schedule in ("axle", "")
    torque = next(i for i, c in enumerate(found.checks) if c.name == "max torque of rear")
    assert found.checks[torque].load_case == "hill" and found.places[found.where[torque]].value == 0.1
    assert found.verdict is tn.design.assessment.check.Status.EXCEEDED and "at axle 100 mm" in str(found)
    assert "between them nothing is looked at" in str(found)


def test_torques_over_speed_are_judged_at_their_own_speeds() -> None:
    found = tn.envelope(line([PULL]), points=2)
    assert [p.value for p in found.places[1:-1]] == [40.0, 60.0]  # 90 rad/s lies outside the range
    assert found.places[-1].label == "along pull, 40 rad/s to 60 rad/s"
    k = next(i for i, c in enumerate(found.checks) if c.name == "max torque of rear")
    direct = tn.assess(line([]).replace("load", load_torque=80.0), (60.0, 60.0)).check("max torque of rear")
    assert found.margin[2, k] == pytest.approx(direct.margin, rel=1e-12)
    assert found.checks[k].speed == 60.0


@pytest.mark.slow
def test_the_stable_limit_of_every_place() -> None:
    found = tn.envelope(line([PULL]), (55.0, 60.0), points=2, parameter="joint.angle", high=1.2)
    assert found.limit.shape == (len(found.places),) and found.parameter_unit == "rad"
    direct = tn.stable_limit(line([]), "joint.angle", np.linspace(55.0, 60.0, 240), high=1.2, between=False).limit
    assert found.limit[0] <= np.min(direct) and found.limit[0] == pytest.approx(np.min(direct), rel=1e-3)
    there = line([]).replace("joint", angle=found.limit[0] * (1 - 1e-6))
    assert tn.stability(there, np.linspace(55.0, 60.0, 40)[7]).spectral_radius <= 1 + 1e-9
    assert f"angle of joint: stable up to {np.degrees(found.limit.min()):.6g}°, least" in str(found)


@pytest.mark.slow
def test_between_the_points_of_a_schedule_over_speed_the_largest_torque_is_found() -> None:
    """A resonance of order 2 at 27.4 rad/s lies between two points, where the joint is bent most of all."""
    bends = tn.Schedule(name="bend", speed=[20.0, 27.0, 40.0], angles={"joint": ["2 deg", "20 deg", "2 deg"]})
    one = line([bends])
    found = tn.envelope(one, (20.0, 40.0), points=3)
    k = next(i for i, c in enumerate(found.checks) if c.name == "vibratory torque of rear")
    dense = max(
        tn.order_response(line([]).replace("joint", angle=float(angle)), [speed]).vibratory_torque[0, 1]
        for speed, angle in (
            (speed, np.interp(speed, [20.0, 27.0, 40.0], np.radians([2, 20, 2]))) for speed in np.linspace(26, 30, 401)
        )
    )
    assert dense * (1 - 1e-6) <= found.checks[k].value <= dense * (1 + 1e-3)
    assert found.places[found.where[k]].along == (20.0, 40.0)
    assert found.checks[k].margin < np.nanmin(found.margin[:-1, k]) - 0.05
    assert "between them nothing" not in str(found)


def test_torques_over_speed_are_judged_at_the_ends_of_the_range() -> None:
    """The schedule states points far outside the range; between them the torque rises with the speed."""
    wide = tn.Schedule(name="pull", speed=[5.0, 55.0], loads={"load": [0.0, 110.0]})
    found = tn.envelope(line([wide]), (40.0, 60.0), points=2)
    assert [place.value for place in found.places[1:-1]] == [40.0, 55.0]
    there = tn.assess(line([]).replace("load", load_torque=110.0), (55.0, 55.0)).check("max torque of rear")
    k = next(i for i, c in enumerate(found.checks) if c.name == "max torque of rear")
    assert found.margin[2, k] == pytest.approx(there.margin, rel=1e-9)
    assert found.margin[2, k] == min(found.margin[:, k])
    assert "Schedule pull goes from 5 rad/s to 55 rad/s: at speeds beyond, the line is judged as stated" in str(found)
    assert "at speeds beyond" not in str(tn.envelope(line([wide]), (20.0, 30.0), points=2))
    assert len(tn.envelope(line([wide]), (60.0, 70.0)).places) == 1


def test_a_limit_that_is_unknown_at_one_speed_is_unknown(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is no smaller value than the others, which alone would be printed as the limit."""
    from dataclasses import replace

    from trunnion.design import envelope as module

    def untold(*args, **options):  # type: ignore[no-untyped-def]
        found = tn.stable_limit(*args, **options)
        found.limit[3] = np.nan
        return replace(found)

    monkeypatch.setattr(module, "stable_limit", untold)
    found = tn.envelope(line([]), (55.0, 60.0), points=2, parameter="joint.angle", high=1.2)
    assert np.isnan(found.limit).all()
    assert "is not known as stated" in str(found) and "stable up to" not in str(found)


def test_without_anything_to_go_over_it_is_assess() -> None:
    one = line([])
    found, direct = tn.envelope(one), tn.assess(one)
    assert [c.margin for c in found.checks] == pytest.approx([c.margin for c in direct.checks], nan_ok=True)
    assert "no load cases and no schedules" in str(found)
    with pytest.raises(tn.InputError, match="no schedule is judged"):
        found.plot()


def test_file_data_and_picture() -> None:
    one = line([TRAVEL, PULL])
    assert tn.loads(tn.dumps(one)) == one
    found = tn.envelope(one, points=3)
    assert found.data.margin.dims == ("place", "check")
    assert json.loads(found.to_json())["verdict"] == str(found.verdict)
    assert "travel [mm]" in found.plot(schedule="axle").get_xlabel()
    assert "rad/s" in found.plot(schedule="pull").get_xlabel()
    with pytest.raises(tn.InputError, match="points = 1"):
        tn.envelope(one, points=1)


def test_factors_on_a_machine_over_speed() -> None:
    """A fan that is opened as it runs faster: torques of its shaft by hand; written and read again."""
    opened = tn.Schedule(name="opening", speed=[50.0, 100.0], factors={"fan": [0.2, 1.0]})
    shaft = tn.Shaft(stiffness=1e4, damping=5.0, name="shaft")
    line = tn.Driveline(
        [tn.ConstantSpeed(), shaft, tn.Fan(inertia=0.5, quadratic_load=0.02, name="fan")],
        operation=tn.Operation(speed=80.0, speed_range=(50.0, 100.0), schedules=[opened]),
        limits=[tn.Limit(of="shaft", max_torque=150.0)],
    )
    assert tn.loads(tn.dumps(line)) == line
    assert line.at_schedule("opening", 75.0).elements[-1].quadratic_load == pytest.approx(0.6 * 0.02)
    found = tn.envelope(line, points=3)
    (column,) = [k for k, check in enumerate(found.checks) if check.name == "max torque of shaft"]
    margins = {place.value: found.margin[k, column] for k, place in enumerate(found.places) if place.over == "speed"}
    assert set(margins) == {50.0, 75.0, 100.0}
    for speed, margin in margins.items():
        torque = (0.2 + 0.8 * (speed - 50) / 50) * 0.02 * speed**2
        assert margin == pytest.approx(1 - torque / 150.0, rel=1e-9)
