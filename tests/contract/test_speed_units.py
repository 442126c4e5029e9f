"""Results of a line print speeds in the unit of its description, or in the one asked for; ``Words`` alone does it."""

import ast
from pathlib import Path

import numpy as np
import pytest

import trunnion as tn
from trunnion.results.words import HERTZ, Words

ROOT = Path(tn.__file__).parent
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
    "stability": lambda line: tn.stability(line, tn.rpm(1500)),
    "order_response": lambda line: tn.order_response(line, [100.0, tn.rpm(1500)]),
    "tongues": lambda line: tn.tongues(line, ("speed", 140.0, 170.0), ("HookeJoint 1.angle", 0.0, 0.6), rows=5),
    "stable_windows": lambda line: tn.stable_windows(line, "HookeJoint 1.angle", 0.0, 0.3, (150.0, 160.0)),
    "tolerance_study": lambda line: tn.tolerance_study(line, {"Shaft 1.stiffness": 0.1}, tn.rpm(1500), samples=256),
    "speed_sweep": lambda line: tn.speed_sweep(line, [100.0, tn.rpm(1500)]),
    "stable_limit": lambda line: tn.stable_limit(line, "HookeJoint 1.angle", [150.0, tn.rpm(1500)], scan=8, high=0.5),
    "periodic_response": lambda line: tn.periodic_response(line, tn.rpm(1500), compare=False),
    "linearity_check": lambda line: tn.linearity_check(line, tn.rpm(1500)),
    "run_up": lambda line: tn.run_up(line, tn.rpm(1400), tn.rpm(1500), acceleration=200, steady=0),
}


@pytest.mark.parametrize("question", QUESTIONS)
def test_speeds_of_every_result_are_in_that_unit(question):
    """And in no other, whatever the result prints; a unit that is asked for goes before it."""
    for unit in ("rpm", "rad/s"):
        line = tn.Driveline(LINE, operation=tn.Operation(speed="1500 rpm", speed_unit=unit))
        result = QUESTIONS[question](line)
        others = {"rpm", "Hz", "rad/s"} - {unit}
        assert f" {unit}" in str(result) and not any(f" {other}" in str(result) for other in others)
        asked = others.pop()
        assert f" {asked}" in result.describe(asked) and f" {unit}" not in result.describe(asked)


BARE = {"show_speed", "rounded_speed", "about_speed", "about_span", "show_acceleration", "acceleration_span"}
BARE |= {"rounded_span", "ranges_in_words", "quantity_axis", "parameter_axis"}
"""What ``Words`` stands on: to be called with a unit, so that every caller would have to know it."""
METHODS = {"describe", "findings_in", "sentence_in", "said_in"}
WORDS = BARE | {f"def {name}(" for name in METHODS}
LATER = ("results/", "motion/", "steady/", "papers/")
"""Their home, and rooms some of whose functions take a unit yet."""


def test_speeds_reach_text_in_one_way() -> None:
    """Neither functions that take a unit, nor methods of results beside those of their base."""
    for path in sorted(ROOT.rglob("*.py")):
        name = path.relative_to(ROOT).as_posix()
        text = path.read_text(encoding="utf-8")
        if not any(word in text for word in WORDS):  # to parse all of them takes seconds
            continue
        tree = ast.parse(text)
        imported = {a.name for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) for a in node.names}
        made = {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
        if not name.startswith(LATER):
            assert not imported & BARE, name
        if name != "results/result.py":
            assert not made & METHODS, name


RESTING = (tn.rpm(600), tn.rpm(600))
# what is asked, in rpm and in Hz
SAID = [
    (lambda words: words.speed(tn.rpm(1234.5678)), "1234.57 rpm", "20.5761 Hz"),
    (lambda words: words.speed(tn.rpm(1234.5678), 5), "1234.6 rpm", "20.576 Hz"),
    (lambda words: words.rounded(tn.rpm(1234.5678)), "1235 rpm", "20.58 Hz"),
    (lambda words: words.rounded(tn.rpm(123456.0)), "123500 rpm", "2058 Hz"),
    (lambda words: words.about(tn.rpm(1234.0)), "1230 rpm", "20.6 Hz"),
    (lambda words: words.about(tn.rpm(1234.0), tn.rpm(1254.0)), "1230 to 1250 rpm", "20.6 to 20.9 Hz"),
    (lambda words: words.ends(tn.rpm(300), tn.rpm(2400)), "300 rpm to 2400 rpm", "5 Hz to 40 Hz"),
    (lambda words: words.span(tn.rpm(300), tn.rpm(2400), "and"), "300 and 2400 rpm", "5 and 40 Hz"),
    (lambda words: words.acceleration(tn.rpm(60)), "60 rpm/s", "1 Hz/s"),
    (lambda words: words.acceleration(tn.rpm(60), tn.rpm(120)), "60 to 120 rpm/s", "1 to 2 Hz/s"),
    (lambda words: words.ranges([(tn.rpm(300), tn.rpm(360)), RESTING]), "300 to 360 rpm, 600 rpm", "5 to 6 Hz, 10 Hz"),
    (lambda words: words.parameter("speed", "rad/s").value(tn.rpm(60)), "input speed 60 rpm", "input speed 1 Hz"),
    (lambda words: words.parameter("a.angle", "rad").value(np.pi / 6), "angle of a 30°", "angle of a 30°"),
    (lambda words: words.of_frequencies.speed(tn.hz(25)), "25 Hz", "25 Hz"),
]  # fmt: skip


@pytest.mark.parametrize(("ask", "in_rpm", "in_hertz"), SAID, ids=[said for _, said, _ in SAID])
def test_words(ask, in_rpm, in_hertz):
    assert ask(Words("rpm")) == in_rpm and ask(Words("Hz")) == in_hertz


def test_numbers_of_equations_read_as_they_are():
    own = Words(None)
    assert own.parameter("speed", "rad/s").value(60.0) == "speed 60 rad/s" and own.of_frequencies.of_speeds == "rad/s"
    assert HERTZ.speed(tn.hz(25)) == "25 Hz"
    with pytest.raises(tn.InputError, match="use one of rad/s, rpm, Hz"):
        Words("mph").speed(1.0)
