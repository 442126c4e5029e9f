"""The rolls of a mill that the strip couples: how a difference of the loads is shared round the loop."""

from __future__ import annotations

from pathlib import Path

import pytest

import trunnion as tn

MILL = Path(__file__).parents[2] / "examples" / "rolling-mill-strip.toml"


@pytest.mark.parametrize(("case", "upper", "lower"), [("rolling", 62e3, 62e3), ("dry lower side", 50e3, 80e3)])
def test_the_strip_takes_a_part_of_the_difference_across(case, upper, lower):
    """Both ways to a roll have 1/k = 1/9 + 1/22: T_strip/60 = (T_lower − T_upper)/k.

    By less than 1e-5 the joints at 2° shift the mean, as what twists them over a turn is not even.
    """
    way = 1 / (1 / 9e6 + 1 / 22e6)
    across = (lower - upper) / (2 + way / 60e6)
    found = tn.order_response(tn.load(MILL), [tn.rpm(300)], load_case=case)
    torque = {name: abs(float(found.mean_torque[0, i])) for i, name in enumerate(found.springs)}
    assert torque["strip"] == pytest.approx(across, rel=1e-5, abs=1.0)
    assert torque["upper spindle"] == pytest.approx(upper + across, rel=1e-5)
    assert torque["lower spindle"] == pytest.approx(lower - across, rel=1e-5)
    assert torque["motor shaft"] == pytest.approx(upper + lower, rel=1e-5)
