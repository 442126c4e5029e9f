"""What is passed to an analysis and is of another kind altogether: one line that names the argument."""

from __future__ import annotations

from typing import Any

import pytest

import trunnion as tn

NAN, INF = float("nan"), float("inf")
NO_NUMBER: tuple[Any, ...] = ("12 deg", True, 1j, [[1.0], [2.0, 3.0]], {})
NO_LIST: tuple[Any, ...] = (3.0, True, 1j)


def line() -> tn.Driveline:
    parts = [
        tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=0.8), tn.Disk(inertia=0.5), tn.HookeJoint(angle=0.3),
        tn.Shaft(stiffness=1.2e4, damping=0.8), tn.Disk(inertia=0.4),
    ]  # fmt: skip
    return tn.Driveline(parts, operation=tn.Operation(speed=50.0, speed_range=(40.0, 60.0)))


ANGLE, STIFF = "HookeJoint 1.angle", {"Shaft 1.stiffness": 0.1}
SPEEDS = {
    "sensitivity": lambda v: tn.sensitivity(line(), v, of=["growth"]),
    "order_response": lambda v: tn.order_response(line(), v),
    "stable_limit": lambda v: tn.stable_limit(line(), ANGLE, v, high=0.3),
    "tolerance_study": lambda v: tn.tolerance_study(line(), STIFF, v, samples=256),
    "campbell_diagram": lambda v: tn.campbell_diagram(line(), v),
    "assess": lambda v: tn.assess(line(), v),
    "compare": lambda v: tn.compare(line(), line().replace("Disk 1", inertia=0.6), v),
}
NUMBERS = {
    "orders": lambda v: tn.order_response(line(), [50.0], orders=v),
    "tolerance": lambda v: tn.stability(line(), 50.0, tolerance=v),
    "margin": lambda v: tn.stable_windows(line(), ANGLE, 0.0, 0.3, (40.0, 60.0), margin=v),
    "maximum": lambda v: tn.minimum_damping(line(), (40.0, 60.0), maximum=v),
    "confidence": lambda v: tn.tolerance_study(line(), STIFF, 50.0, samples=256, confidence=v),
    "seed": lambda v: tn.tolerance_study(line(), STIFF, 50.0, samples=256, seed=v),
    "allowed": lambda v: tn.linearity_check(line(), 50.0, allowed=v),
    "near": lambda v: tn.remedies(line(), near=v),
    "first": lambda v: tn.run_up(line(), v, 60.0, acceleration=50.0),
    "steady": lambda v: tn.run_up(line(), 50.0, 60.0, acceleration=50.0, steady=v),
}
LISTS = {
    "of": lambda v: tn.sensitivity(line(), 50.0, of=v),
    "parameters": lambda v: tn.sensitivity(line(), 50.0, v, of=["frequencies"]),
    "tips": lambda v: tn.sensitivity(line(), 50.0, of=["frequencies"], tips=v),
}
NAMES = {
    "load_case": lambda v: tn.assess(line(), load_case=v),
    "branch": lambda v: tn.kinetostatics(line(), 50.0, branch=v),
}
LINES = {
    "natural_frequencies": tn.natural_frequencies,
    "resonance_speeds": tn.resonance_speeds,
    "stability": tn.stability,
    "order_response": lambda v: tn.order_response(v, [50.0]),
}


def refusal(call: Any, value: Any) -> str:
    with pytest.raises(tn.InputError) as caught:
        call(value)
    said = str(caught.value)
    assert "\n" not in said and len(said) < 500
    return said


@pytest.mark.parametrize("call", SPEEDS.values(), ids=SPEEDS)
def test_speeds(call: Any) -> None:
    for value in (*NO_NUMBER, [], NAN, INF, -1.0, [50.0, NAN]):
        assert "speed" in refusal(call, value), value


TEXTS = {
    **{name: SPEEDS[name] for name in ("sensitivity", "order_response", "campbell_diagram", "assess", "compare")},
    "stable_limit": lambda v: tn.stable_limit(line(), ANGLE, v, high=0.3, between=False),
    "windows": lambda v: tn.stable_windows(line(), ANGLE, 0.0, 0.3, v),
    "speed_sweep": lambda v: tn.speed_sweep(line(), v),
    "envelope": lambda v: tn.envelope(line(), speeds=v),
    "chart": lambda v: tn.stability_chart(line(), ("speed", *v, 3), (ANGLE, 0.0, 0.3, 3)),
    "tongues": lambda v: tn.tongues(line(), ("speed", *v), (ANGLE, 0.0, 0.3)),
    "run_up": lambda v: tn.run_up(line(), *v, acceleration=500.0, steady=0),
    "stability": lambda v: tn.stability(line(), v[0]),
    "periodic_response": lambda v: tn.periodic_response(line(), v[0]),
    "kinetostatics": lambda v: tn.kinetostatics(line(), v[0]),
    "simulate": lambda v: tn.simulate(line(), speed=v[0], turns=2),
    "linearity_check": lambda v: tn.linearity_check(line(), v[0]),
}
ANGLES = lambda v: tn.stability_chart(line(), ("speed", 40.0, 60.0, 3), (ANGLE, *v, 3))  # noqa: E731


@pytest.mark.parametrize("name", TEXTS)
def test_speeds_may_be_texts(name: str) -> None:
    low, high = tn.rpm(400), tn.rpm(600)
    assert str(TEXTS[name](("400 rpm", "10 Hz"))) == str(TEXTS[name]((low, high)))


def test_ends_of_other_axes_may_be_texts() -> None:
    assert str(ANGLES(("0 deg", "17 deg"))) == str(ANGLES((0.0, tn.deg(17))))
    with pytest.raises(tn.InputError, match="rpm is not the unit of an angle"):
        ANGLES((0.0, "17 rpm"))


@pytest.mark.parametrize("key", NUMBERS)
def test_numbers(key: str) -> None:
    for value in (*NO_NUMBER, NAN, INF, -1.0):
        assert key in refusal(NUMBERS[key], value), value


@pytest.mark.parametrize("key", LISTS)
def test_lists(key: str) -> None:
    for value in NO_LIST:
        assert key in refusal(LISTS[key], value), value


@pytest.mark.parametrize("key", NAMES)
def test_names(key: str) -> None:
    for value in (*NO_LIST, "nobody"):
        assert key in refusal(NAMES[key], value)


@pytest.mark.parametrize("name", LINES)
def test_no_line(name: str) -> None:
    for value in (None, 1.0, "truck.toml"):
        assert "is not a driveline" in refusal(LINES[name], value)
