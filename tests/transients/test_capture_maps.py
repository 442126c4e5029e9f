"""Maps of capture and the least drive torque, against equations of a reader's own."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import trunnion as tn
from tests.transients.test_passing import comes_there, line, weak
from trunnion.cli.program import app
from trunnion.motion.passing.capture_map import CaptureMap

ENDS, RIGID = (15.0, 40.0), 50.0
"""Speeds, and the time of the rigid line at factor 1."""
ANGLES = ("HookeJoint 1.angle", 0.10, 0.22, 3)


def by_hand(angle: float, factor: float, phase: float) -> bool:
    """Whether the line with a mode at 50 rad/s is captured, in absolute angles."""
    until, step = 6 * RIGID / factor, 0.1 / 50.0
    return bool(np.isinf(comes_there(1.0, 4.0, angle, 2e3, 1.0, 2.5 * factor, *ENDS, phase, until, step)))


def bent(angle: float = 0.15) -> tn.Driveline:
    return line(1.0, 4.0, angle, 2e3, 1.0)


def compared(found: CaptureMap) -> None:
    assert not found.undecided.any() and not found.short.any() and found.computed.all()
    for j, factor in enumerate(found.y):
        for i, angle in enumerate(found.x):
            known = np.mean([by_hand(angle, factor, phase) for phase in found.phases])
            assert found.share[j, i] == known, (angle, factor)


def test_cells_against_a_readers_own_equations() -> None:
    shares: list[float] = []
    found = tn.capture_map(
        bent(), ENDS, ANGLES, ("factor", 1.0, 3.0, 2), torque=weak(2.5), phases=2, progress=shares.append
    )
    compared(found)
    assert 0 < found.share.mean() < 1 and shares[-1] == 1.0 and np.all(np.diff(shares) > 0)
    assert len(found.boundary) and found.cell == pytest.approx((0.06, 2.0))
    for (x0, y0), (x1, y1) in found.boundary:  # between a cell of one kind and a cell of the other
        apart = (0.03, 0.0) if x0 == x1 else (0.0, 1.0)
        middle = (x0 + x1) / 2, (y0 + y1) / 2
        sides = [
            found.data.captured.sel(x=middle[0] + s * apart[0], y=middle[1] + s * apart[1], method="nearest")
            for s in (-1, 1)
        ]
        assert (sides[0] >= 0.5) != (sides[1] >= 0.5)
    assert "captured from half of the phases or more" in str(found) and "known to a cell, 3.44° by 2" in str(found)
    assert found.data.captured.dims == ("y", "x")


@pytest.mark.slow
def test_more_cells_and_processes() -> None:
    asked = bent(), ENDS, (*ANGLES[:3], 6), ("factor", 0.8, 3.2, 4)
    one = tn.capture_map(*asked, torque=weak(2.5), phases=4)
    compared(one)
    two = tn.capture_map(*asked, torque=weak(2.5), phases=4, processes=2)
    assert np.array_equal(one.share, two.share)


def test_what_was_computed_is_kept() -> None:
    with tn.time_limit() as limit:
        found = tn.capture_map(
            bent(), ENDS, ANGLES, ("factor", 2.0, 3.0, 2), torque=weak(2.5), phases=1,
            progress=lambda share: limit.stop() if share > 0.3 else None,
        )  # fmt: skip
    assert found.computed.sum() == 2 and np.isfinite(found.share[found.computed]).all()
    assert np.isnan(found.share[~found.computed]).all()
    assert found.outcome.kind == "ended early" and "2 of 6 cells were computed" in str(found)


def test_the_least_torque_against_a_readers_own_equations() -> None:
    found = tn.least_drive(bent(0.16), ENDS, torque=weak(2.5), factors=(0.8, 6.0), points=3, accuracy=0.1, phases=[0.5])
    assert found.outcome.kind == "found" and 1 < found.least / found.below <= 1.1
    for one in found.trials:
        known = np.mean([not by_hand(0.16, one.factor, phase) for phase in found.phases])
        assert one.share == known, one.factor
    assert "passes from 1 starting phase" in str(found) and "nothing was run between" in str(found)


def test_a_motor_short_of_torque_is_no_capture() -> None:
    loaded = bent(0.02).replace("load", quadratic_load=0.01)
    found = tn.capture_map(
        loaded, (15.0, 30.0), ("load.inertia", 3.0, 4.0, 2), ("factor", 1.0, 6.0, 2), torque=weak(4.0), phases=1
    )
    assert found.short.tolist() == [[True, True], [False, False]] and np.isnan(found.share[0]).all()
    assert (found.share[1] == 0).all() and "short of torque without any resonance in 2 cells" in str(found)


def test_the_command(tmp_path: Path) -> None:
    scenario = tn.Scenario(name="start", duration=1.0, speed=15.0, torque=weak(2.5))
    file = tmp_path / "line.toml"
    file.write_text(tn.dumps(bent().but(scenarios=[scenario])), encoding="utf-8")
    asked = ["capture-map", str(file), "--from", "15rad/s", "--to", "40rad/s", "--phases", "1", "--json"]
    angles = ["--x", "HookeJoint 1.angle:5deg:15deg:2", "--y", "factor:1:3:2"]
    done = CliRunner().invoke(app, [*asked, *angles, "-o", str(tmp_path / "map.png")])
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)["captured"] == [[0.0, 1.0], [0.0, 1.0]]
    assert (tmp_path / "map.png").stat().st_size > 10_000
    wrong = CliRunner().invoke(app, [*asked, "--y", "factor:1"])
    assert wrong.exit_code == 2 and "is no range of factors" in wrong.output
