"""Results of a line print speeds in the unit of its description."""

import pytest

import trunnion as tn

LINE = [
    tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=5), tn.Disk(inertia=0.1), tn.HookeJoint(angle=0.2),
    tn.Shaft(stiffness=1e4, damping=5), tn.Disk(inertia=0.2, load_torque=20),
]  # fmt: skip


@pytest.mark.parametrize(("unit", "text"), [("rpm", "1500 rpm"), ("Hz", "25 Hz"), ("rad/s", "157.08 rad/s")])
@pytest.mark.parametrize("analysis", [tn.stability, tn.kinetostatics])
def test_unit_of_the_description(analysis, unit, text):
    line = tn.Driveline(LINE, operation=tn.Operation(speed="1500 rpm", speed_unit=unit))
    result = analysis(line, tn.rpm(1500))
    assert f"at {text}" in str(result)
    other = "rpm" if unit != "rpm" else "Hz"
    assert f" {other}" not in "\n".join([str(result), *map(str, result.findings)])
    assert f" {other}" in result.describe(other)
