"""Refusals of the analyses that help to design: one line with key, value and remedy."""

from __future__ import annotations

import pytest

import trunnion as tn

LINE = tn.catalogue("two-shaft-cardan")
BENT = LINE.replace("HookeJoint 1", angle=0.2)
ANGLE = "HookeJoint 1.angle"


def tips_of(line):
    return tn.tongues(line, ("Shaft 1.stiffness", 0.9, 1.0), ("HookeJoint 1.angle", 0.05, 0.06), speed=1.0, rows=3)


REFUSED = [
    (lambda: tn.sensitivity(LINE, of="orders"), "of = 'orders': is nothing to differentiate", "frequencies, growth"),
    (lambda: tn.sensitivity(LINE, 0.0), "speed = 0: must be positive", "tn.rpm(1500)"),
    (lambda: tn.sensitivity(LINE, []), "speeds = []: must be a number or several", "tn.rpm(1500)"),
    (lambda: tn.sensitivity(LINE, 1.0, ["Shaft 9.stiffness"]), "Shaft 9.stiffness: is not a parameter", "did you mean"),
    (lambda: tn.sensitivity(LINE, 1.0, "speed"), "parameters = 'speed': is not a parameter", "leave it out"),
    (lambda: tn.sensitivity(LINE, 1.0, []), "parameters: names no parameter", "Shaft 1.stiffness"),
    (lambda: tn.sensitivity(LINE, 1.0, checks=["U"]), "checks = 'U': is not a check", "there are"),
    (lambda: tn.sensitivity(LINE, 1.0, load_case="hill"), "load_case = 'hill'", ""),
    (lambda: tn.sensitivity(LINE, 1.0, of="growth").ranked("growth"), "is not a quantity of", "growth rate"),
    (lambda: tn.sensitivity(LINE, 1.0, tips=tips_of(LINE)), "tips: must have the speed along one axis", "tn.tongues"),
    (lambda: tn.compare(LINE, "truck.toml"), "b = 'str': is not a driveline", "tn.load"),
    (lambda: tn.compare(LINE, LINE, (2.0, 1.0)), "speeds = (2.0, 1.0): must be a lowest and a highest", "tn.rpm"),
    (lambda: tn.compare(LINE, LINE, (1.0, 2.0), load_case="hill"), "load_case = 'hill'", ""),
    (lambda: tn.compare(LINE, LINE).plot(), "comparison: has nothing to draw", "change a value"),
    (lambda: tn.compare(LINE, BENT).plot(), "comparison: has nothing to draw", "name speeds"),
    (lambda: tn.optimise(LINE, {}, "irregularity"), "free: must name one parameter or more", "Shaft 1.stiffness"),
    (lambda: tn.optimise(LINE, {"speed": (1, 2)}, "irregularity"), "speed: is not a parameter", "give speeds"),
    (lambda: tn.optimise(LINE, {"Shaft 9.damping": (0, 1)}, "irregularity"), "is not a parameter", "did you mean"),
    (lambda: tn.optimise(LINE, {ANGLE: 0.3}, "irregularity"), "= 0.3: must be a low and a high bound", "free="),
    (lambda: tn.optimise(LINE, {ANGLE: (0.3, 0.2)}, "irregularity"), "must be rising bounds", "free="),
    (lambda: tn.optimise(LINE, {ANGLE: (0, float("inf"))}, "irregularity"), "must be finite numbers", "free="),
    (lambda: tn.optimise(LINE, {ANGLE: ("1 m", "2 m")}, "irregularity"), f"{ANGLE} = '1 m': ", ""),
    (lambda: tn.optimise(LINE, {ANGLE: (0, 2)}, "irregularity"), "would reach 2, which no line", "move the bound"),
    (
        lambda: tn.optimise(LINE, {ANGLE: (0, 1), "factor of HookeJoint *.angle": (0, 1)}, "irregularity"),
        "factor of HookeJoint *.angle: moves HookeJoint 1.angle, as HookeJoint 1.angle does", "free once",
    ),
    (lambda: tn.optimise(LINE, {ANGLE: (0, 1)}, "evenness"), "aims = 'evenness': is not an aim", "irregularity"),
    (lambda: tn.optimise(LINE, {ANGLE: (0, 1)}, []), "aims = 0: must be one aim or two", "irregularity"),
    (lambda: tn.optimise(LINE, {ANGLE: (0, 1)}, ["irregularity"] * 2), "names one aim twice", "leave one out"),
    (lambda: tn.optimise(LINE, {ANGLE: (0, 1)}, "growth rate"), "is needed for the aim growth rate", "speeds=("),
    (
        lambda: tn.optimise(LINE, {ANGLE: (0, 1)}, "irregularity", (1.0, 1.1), checks=["U"]),
        "checks = 'U': is not a check of this line", "uniformity",
    ),
    (lambda: tn.optimise(LINE, {ANGLE: (0, 1)}, "irregularity", checks=3), "checks = 3: must be True, False", "names"),
    (lambda: tn.optimise(LINE, {ANGLE: (0, 1)}, "irregularity", checks="U"), "are judged over a range", "give speeds"),
    (lambda: tn.optimise(LINE, {ANGLE: (0, 1)}, "irregularity", designs=3), "designs = 3: must be a whole number", ""),
    (lambda: tn.optimise(LINE, {ANGLE: (0, 1)}, "irregularity", seed=-1), "seed = -1: must be a whole number", ""),
    (
        lambda: tn.sensitivity(tn.catalogue("three-shaft-cardan"), 1.0, of=[], tips=tips_of(LINE)),
        "tips: are not of this line", "of the same line",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("call", "begins", "says"), REFUSED, ids=[begins for _, begins, _ in REFUSED])
def test_refused_in_one_line(call, begins, says):
    with pytest.raises(tn.InputError) as caught:
        call()
    text = str(caught.value)
    assert begins in text and says in text and "\n" not in text


def test_what_cannot_be_computed_is_said():
    with pytest.raises(tn.ComputationError, match="no design within the bounds can be computed"):
        tn.optimise(LINE, {ANGLE: (0.1, 0.2)}, lambda line: float("nan"), designs=20)


def test_what_follows_nothing_is_not_drawn():
    with pytest.raises(tn.InputError, match="has nothing to draw: two multipliers are equally large"):
        undamped = LINE.replace_all({"Shaft 1": {"damping": 0.0}, "Shaft 2": {"damping": 0.0}})
        tn.sensitivity(undamped, 1.2, of="growth").plot("growth rate at 1.2 rad/s")
