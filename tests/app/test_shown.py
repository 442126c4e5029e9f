"""What is sent to the page, without one."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.app.shown import assessment
from trunnion.driveline.starter import starter


def test_what_binds_is_drawn_whatever_it_is() -> None:
    """The motion of a disk in rpm, with its limit and the orders that make it."""
    line = tn.loads(starter("two-shaft"))
    disk = next(e.name for e in reversed(line.elements) if e.kind == "Disk")
    limit = tn.Limit(of=disk, max_speed_fluctuation="0.01 rpm")
    found = tn.assess(tn.Driveline(line.elements, limits=[limit], operation=line.operation))
    course = assessment(found)["course"]
    assert (course["quantity"], course["unit"]) == (f"speed fluctuation of {disk}", "rpm")
    assert course["values"][-1] == pytest.approx(np.full(len(course["speed"]), 0.01))
    assert tn.rpm(course["values"][0].max()) == pytest.approx(found.binding.value)
    assert course["names"][0].startswith("all together") and "order 2" in course["names"]
