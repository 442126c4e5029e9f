"""Transients, passings and fatigue in the application: their pictures, and the motion played."""

from __future__ import annotations

import pytest
from served import Look
from test_live_view import FOUND, plays

import trunnion as tn

TEXT = """
format = 1

[operation]
speed_range = ["15 rad/s", "40 rad/s"]
speed_unit = "rad/s"
life = "1000 h"

[[sn_curve]]
of = "shaft"
torque_amplitude = 40.0
cycles = 1e6
slope = 5

[[element]]
type = "Motor"
name = "motor"
inertia = 1.0
curve = [{ speed = 0, torque = 2.5 }, { speed = 100, torque = 2.5 }]

[[element]]
type = "HookeJoint"
angle = "15 deg"

[[element]]
type = "Shaft"
name = "shaft"
stiffness = 2e3
damping = 1.0

[[element]]
type = "Disk"
name = "load"
inertia = 4.0

[[scenario]]
name = "bite"
duration = "3 s"
speed = "18 rad/s"
per_hour = 2

[[scenario.disturbance]]
on = "load"
case = "bite and tail-out"
since = "1 s"
torque = 20
rise = "20 ms"
until = "1.5 s"
fall = "20 ms"
"""


def opened(look: Look) -> None:
    look.at()
    field = look.page.get_by_label("Open a TOML file")
    field.set_input_files({"name": "weak.toml", "mimeType": "text/plain", "buffer": TEXT.encode()})
    look.page.wait_for_function("() => document.location.search.length > 0", timeout=180_000)
    look.settled_anew()


def test_pictures_and_words_of_all_three(look: Look) -> None:
    opened(look)
    look.view("Motion")
    choice = look.page.get_by_label("Motion", exact=True)
    for label, words in (
        ("transient", "bite of driveline over 3 s"),
        ("passed or captured", "captured at 24."),
        ("fatigue", "rainflow cycles and Miner's sum"),
    ):
        choice.select_option(label=label)
        look.page.get_by_text(words).first.wait_for()
        look.settled_anew()
    assert not look.errors


@pytest.mark.slow
def test_a_passing_is_played(look: Look) -> None:
    opened(look)
    look.view("Live")
    look.page.get_by_label("Motion", exact=True).select_option(label="passed or captured")
    plays(look, "passing")
    assert look.page.evaluate(f"{FOUND}.whole") > 10


def test_a_passing_moves_as_it_is_computed() -> None:
    """Without the browser: the last frame turns as the run does."""
    line = tn.loads(TEXT)
    (shown,) = tn.animate(line, "passing").motions
    (one,) = shown.movements
    found = tn.passing(line, (15.0, 40.0))
    assert "captured at 24." in one.said
    begin, end = one.time[[0, -1]]
    turned = one.rigid[-1, 0] - one.rigid[0, 0]
    mean = found.run.whole.angle([begin, end])[1] - found.run.whole.angle([begin, end])[0]
    assert turned == pytest.approx(mean, rel=1e-2)
