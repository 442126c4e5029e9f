"""What the view *Stability* subtracts: the motion with a disturbance less the one without, at the same times."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("panel")

from test_exported_code import view_of

import trunnion as tn
from trunnion.app import shown
from trunnion.app.views.stability import DISTURBANCE


@pytest.mark.parametrize("name", ["harbour-tug", "pto-shaft"])  # free, and driven
def test_both_motions_are_of_the_same_times(name: str) -> None:
    line = tn.load(f"examples/{name}.toml")
    view = view_of(tn.dumps(line), "stability", {"look": "True"})
    steps = {step.name: step for step in view.steps(view.session.document.line)}
    both = [steps[one].call.evaluate(steps[one].line or line) for one in ("undisturbed", "motion")]
    assert np.array_equal(both[0].time, both[1].time)
    speed = steps["motion"].options["speed"]
    without, beside = (shown.motion(one, speed) for one in both)
    assert np.array_equal(without["turns"], beside["turns"]) and without["turns"][-1] == pytest.approx(30, rel=1e-3)
    change = np.array(beside["twist"]) - np.array(without["twist"])
    assert 0 < np.abs(change[:, 0]).max() < 10 * DISTURBANCE
    # A stable line: what is left of the disturbance at the end is less, not what the forced vibration is off in time.
    assert np.abs(change[:, -20:]).max() < np.abs(change[:, :200]).max()
