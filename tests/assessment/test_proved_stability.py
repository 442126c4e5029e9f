"""``assess`` says *proved* of parametric stability where a certificate of the same line and range is one."""

from __future__ import annotations

import pytest

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
