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


QUESTIONS = {
    "resonance_speeds": lambda line: tn.resonance_speeds(line, 1),
    "speed_sweep": lambda line: tn.speed_sweep(line, [100.0, tn.rpm(1500)]),
    "stable_limit": lambda line: tn.stable_limit(line, "HookeJoint 1.angle", [150.0, tn.rpm(1500)], scan=8, high=0.5),
    "periodic_response": lambda line: tn.periodic_response(line, tn.rpm(1500), compare=False),
    "linearity_check": lambda line: tn.linearity_check(line, tn.rpm(1500)),
    "run_up": lambda line: tn.run_up(line, tn.rpm(1400), tn.rpm(1500), acceleration=200, steady=0),
}


@pytest.mark.parametrize("question", QUESTIONS)
def test_speeds_of_every_result_are_in_that_unit(question):
    """And in no other, whatever the result prints; a unit that is asked for goes before it."""
    for unit in ("rpm", "Hz", "rad/s"):
        line = tn.Driveline(LINE, operation=tn.Operation(speed="1500 rpm", speed_unit=unit))
        result = QUESTIONS[question](line)
        others = {"rpm", "Hz", "rad/s"} - {unit}
        assert f" {unit}" in str(result) and not any(f" {other}" in str(result) for other in others)
        asked = others.pop()
        assert f" {asked}" in result.describe(asked) and f" {unit}" not in result.describe(asked)
