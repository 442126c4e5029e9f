"""Maps of capture and the least drive torque, against equations of a reader's own."""

from __future__ import annotations

import dataclasses
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
    found = tn.least_drive(
        bent(0.16), ENDS, torque=weak(2.5), factors=(0.8, 6.0), points=3, accuracy=0.1, around=3, phases=[0.5]
    )
    assert found.outcome.kind == "found" and 1 < found.least / found.below <= 1.1
    for one in found.trials:
        known = np.mean([not by_hand(0.16, one.factor, phase) for phase in found.phases])
        assert one.share == known, one.factor
    assert found.nature is not None and found.nature.kind == "one edge" and len(found.band) == 3
    assert "the boundary is one edge" in str(found) and found.data.attrs["boundary"] == "one edge"
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
    dry = CliRunner().invoke(app, [*asked, *angles, "--dry-run"])
    assert dry.exit_code == 0 and json.loads(dry.stdout)["cells"] == 4, dry.output
    none = CliRunner().invoke(app, [*asked, *angles, "--dry-run", "-o", str(tmp_path / "map.png")])
    assert none.exit_code == 2 and "computes no map" in none.output
    wrong = CliRunner().invoke(app, [*asked, "--y", "factor:1"])
    assert wrong.exit_code == 2 and "is not a range of factors" in wrong.output


def _small(store: Path, **more: object) -> CaptureMap:
    asked: dict[str, object] = {"torque": weak(2.5), "phases": 1, "store": store, **more}
    return tn.capture_map(bent(), ENDS, (*ANGLES[:3], 4), ("factor", 1.0, 3.0, 3), **asked)  # type: ignore[arg-type]


def test_a_stopped_map_goes_on_from_its_store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from trunnion.motion.passing import map_store
    from trunnion.motion.passing.trials import Trials

    monkeypatch.setattr(map_store, "PIECE", 5)
    folder, asked = tmp_path / "map", []
    kinds = Trials.kinds
    monkeypatch.setattr(Trials, "kinds", lambda self, point: (asked.append(dict(point)), kinds(self, point))[1])
    with tn.time_limit() as limit:
        part = _small(folder, progress=lambda share: limit.stop() if share > 0.5 else None)
    assert part.computed.sum() == 7 and len(list(folder.glob("piece-*.npy"))) == 2
    whole = _small(folder)
    assert whole.computed.all() and len(asked) <= 12 + 1 and not [*folder.glob(".*")]
    once = _small(tmp_path / "once")
    assert np.array_equal(whole.share, once.share)
    count = len(asked)
    assert np.array_equal(_small(folder).share, once.share) and len(asked) == count  # nothing is computed again
    (folder / "piece-0000001.npy").write_bytes(b"rubbish")
    with pytest.raises(tn.InputError, match="is damaged; remove this file"):
        _small(folder)
    with pytest.raises(tn.InputError, match="holds another map: it differs in torque"):
        _small(folder, torque=weak(2.6))
    with pytest.raises(tn.InputError, match="holds something else"):
        _small(tmp_path)


def test_a_million_cells_are_planned() -> None:
    million = ("HookeJoint 1.angle", 0.05, 0.2, 1000), ("factor", 2.0, 9.0, 1000)
    cost = tn.capture_map_cost(bent(), ENDS, *million, torque=weak(2.5), phases=1, sample=3, processes=2)
    assert cost.cells == cost.run_ups == 1_000_000 and cost.timed == 3
    assert cost.elapsed == cost.seconds / 2 and cost.seconds > 1e3 and cost.memory < 1e9
    assert "1 000 000 cells, 1 000 000 run-ups" in str(cost) and "in 2 processes" in str(cost)


def test_a_map_says_how_its_boundary_lies() -> None:
    share = np.array([[0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0], [0.0, 0.25, np.nan, 1.0]])
    one = tn.capture_map(bent(), ENDS, (*ANGLES[:3], 2), ("factor", 5.0, 8.0, 2), torque=weak(2.5), phases=2)
    x, y = np.linspace(0.1, 0.2, 4), np.linspace(1, 3, 3)
    made = dataclasses.replace(
        one, x=x, y=y, share=share, undecided=np.zeros((3, 4)), short=share > 2, computed=np.isfinite(share)
    )
    assert made.changes[0].tolist() == [3, 1, 1] and made.changes[1].tolist() == [0, 1, 1, 0]
    assert "more than once in 1 of 3 rows along angle of HookeJoint 1" in str(made)
    assert "the phase decides in 1 cell" in str(made)
