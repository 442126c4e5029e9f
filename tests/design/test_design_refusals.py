"""Refusals of the analyses that help to design: one line with key, value and remedy."""

from __future__ import annotations

import pytest

import trunnion as tn

LINE = tn.catalogue("two-shaft-cardan")


def tips_of(line):
    return tn.tongues(line, ("Shaft 1.stiffness", 0.9, 1.0), ("HookeJoint 1.angle", 0.05, 0.06), speed=1.0, rows=3)


REFUSED = [
    (lambda: tn.sensitivity(LINE, of="orders"), "of = 'orders': is nothing to differentiate", "frequencies, growth"),
    (lambda: tn.sensitivity(LINE, 0.0), "speed = 0: must be positive", "tn.rpm(1500)"),
    (lambda: tn.sensitivity(LINE, []), "speeds = []: must be a speed or several", "tn.rpm(1500)"),
    (lambda: tn.sensitivity(LINE, 1.0, ["Shaft 9.stiffness"]), "Shaft 9.stiffness: is not a parameter", "did you mean"),
    (lambda: tn.sensitivity(LINE, 1.0, "speed"), "parameters = 'speed': is no parameter of the line", "leave it out"),
    (lambda: tn.sensitivity(LINE, 1.0, []), "parameters: names no parameter", "Shaft 1.stiffness"),
    (lambda: tn.sensitivity(LINE, 1.0, checks=["U"]), "checks = 'U': is not a check", "there are"),
    (lambda: tn.sensitivity(LINE, 1.0, load_case="hill"), "load_case = 'hill'", ""),
    (lambda: tn.sensitivity(LINE, 1.0, of="growth").ranked("growth"), "is not a quantity of", "growth rate"),
    (lambda: tn.sensitivity(LINE, 1.0, tips=tips_of(LINE)), "tips: must have the speed along one axis", "tn.tongues"),
    (lambda: tn.compare(LINE, "truck.toml"), "b = 'str': is not a driveline", "tn.load"),
    (lambda: tn.compare(LINE, LINE, (2.0, 1.0)), "speeds = (2.0, 1.0): must be a lowest and a highest", "tn.rpm"),
    (lambda: tn.compare(LINE, LINE, (1.0, 2.0), load_case="hill"), "load_case = 'hill'", ""),
    (lambda: tn.compare(LINE, LINE).plot(), "comparison: has nothing to draw", "change a value"),
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


def test_what_follows_nothing_is_not_drawn():
    with pytest.raises(tn.InputError, match="has nothing to draw: two multipliers are equally large"):
        undamped = LINE.replace_all({"Shaft 1": {"damping": 0.0}, "Shaft 2": {"damping": 0.0}})
        tn.sensitivity(undamped, 1.2, of="growth").plot("growth rate at 1.2 rad/s")
