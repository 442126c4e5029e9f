"""``assess`` says *proved* of parametric stability where a certificate of the same line and range is one."""

from __future__ import annotations

import pytest
from oracles.loaded_pair import Pair

import trunnion as tn


def check(line: tn.Driveline, speeds: tuple[float, float]) -> str:
    return next(c.because for c in tn.assess(line, speeds).checks if c.name == "parametric stability")


@pytest.mark.parametrize(("angle", "damping", "proved"), [(0.2, 0.02, True), (0.2, 0.0005, False)])
def test_proved_beside_satisfied(angle: float, damping: float, proved: bool) -> None:
    """Beside the tongue of the second mode too, where six boxes do not reach far enough, it stays satisfied."""
    line, speeds = tn.catalogue("two-shaft-cardan", angle=angle, damping_ratio=damping), (0.7, 1.5)
    said = check(line, speeds)
    assert ("proved for every speed of the range" in said) is proved
    assert not proved or tn.certify_stability(line, {}, speeds).verdict == "proved stable"


def test_a_line_that_swings_is_proved_about_the_motion_that_it_makes() -> None:
    """Where few boxes are enough; a line that grows about it is not, whatever holds about the static twist."""
    swings = Pair(c_1=3.0, c_2=3.0, load=150.0, angle_1=0.1, angle_2=0.1).line
    assert check(swings, (60.0, 80.0)).endswith(
        "; proved for every speed of the range about the motion that the line makes"
    )
    grows = tn.assess(Pair().line, (77.24, 77.26)).check("parametric stability")
    assert str(grows.status) == "exceeded" and "proved" not in grows.because
