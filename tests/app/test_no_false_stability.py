"""A region of instability between the points of a picture is told: what looks stable must be."""

from __future__ import annotations

import pytest
from served import Look

import trunnion as tn
from trunnion.driveline.starter import starter


@pytest.mark.slow
def test_the_stable_limit_is_that_of_every_speed_and_not_of_some(look: Look) -> None:
    """The two-shaft starter is unstable at 17° and 708 rpm, between the five speeds that are asked for."""
    look.at("?view=limits&limits.speeds=5")
    line = tn.loads(starter("two-shaft"))
    windows = tn.stable_windows(line, "HookeJoint 1.angle", 0.0, tn.deg(45), (tn.rpm(300), tn.rpm(3000)))
    assert windows.largest == pytest.approx(tn.deg(16.98), abs=tn.deg(0.01))
    shown = look.page.locator("pre", has_text="Every speed from 300 rpm to 3000 rpm").inner_text()
    assert " ".join(shown.split()).startswith(windows.sentence)
    assert "the 5 speeds that were asked for" in " ".join(shown.split())


def test_a_chart_names_the_regions_that_its_points_miss(look: Look) -> None:
    look.at("?view=stability&stability.across=20&stability.up=16")
    assert look.page.get_by_text("320 stable").count() == 1
    assert look.page.get_by_text("One region of instability found: subharmonic ω₁ from 16.98 deg on").count() == 1
