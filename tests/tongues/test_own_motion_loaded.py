"""Tolerances and slopes of a driven line that its load twists far, about the motion that it really makes, against its
equations written out in ``oracles.loaded_pair``."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np
import pytest
from oracles.loaded_pair import PATHS, Pair
from typer.testing import CliRunner

import trunnion as tn
from trunnion.cli import app

SPEED = 77.25
GIVEN = {
    "Shaft 2.stiffness": ("range", 2950.0, 3050.0),
    "Disk 2.inertia": ("range", 0.88, 0.92),
    "HookeJoint 2.angle": ("range", 0.40, 0.44),
}


def test_the_worst_line_is_that_of_the_true_motion() -> None:
    """About the twisted line the line is stable and the worst one grows half as fast. The worst line grows as its
    equations say, no corner grows faster, and the share of stable lines is that of lines drawn by lot."""
    pair, rng = Pair(), np.random.default_rng(5)
    study = tn.tolerance_study(pair.line, GIVEN, [SPEED], samples=512, about_steady_state=True)
    about_twist = tn.tolerance_study(pair.line, GIVEN, [SPEED], samples=512)
    assert study.about_steady_state and not about_twist.about_steady_state
    worst = pair.at(study.worst.values).growth(SPEED)
    assert study.worst.growth_rate == pytest.approx(worst, rel=1e-6)
    assert worst > 1.3 * about_twist.worst.growth_rate
    corners = product(*(one[1:] for one in GIVEN.values()))
    every = [pair.at(dict(zip(GIVEN, corner, strict=True))).growth(SPEED) for corner in corners]
    drawn = [
        pair.at({path: rng.uniform(low, high) for path, (_, low, high) in GIVEN.items()}).growth(SPEED)
        for _ in range(24)
    ]
    assert max(every + drawn) < worst * (1 + 1e-6)
    share = np.mean(np.array(drawn) < 0)
    assert study.interval[0] - 0.3 < share < study.interval[1] + 0.3
    assert "each line is judged about its own periodic motion" in str(study)
    assert "own periodic motion" not in str(about_twist)


@pytest.mark.parametrize(
    "pair",
    [pytest.param(Pair(), id="shafts"), pytest.param(Pair(stage=0.6), id="through stages", marks=pytest.mark.slow)],
)
def test_slopes_are_those_of_the_true_motion(pair: Pair) -> None:
    """Against differences of the equations written out; about the twisted line some are quite different."""
    own = list(PATHS if np.isinf(pair.stage) else ("HookeJoint 2.angle", "Disk 2.inertia", "Disk 2.load_torque"))
    found = tn.sensitivity(pair.line, [SPEED], own, of=["growth"], about_steady_state=True)
    about_twist = tn.sensitivity(pair.line, [SPEED], own, of=["growth"])
    name = found.quantities[0].name
    assert found.quantity(name).value == pytest.approx(pair.growth(SPEED), rel=1e-7)
    assert any("own periodic motion" in finding.sentence for finding in found.findings)
    far = 0
    for path, slope in found.derivatives(name).items():
        value = getattr(pair, PATHS[path])
        step = 1e-3 * (1.0 if path.endswith("angle") else value)
        near, wide = (
            (pair.at({path: value + s * step}).growth(SPEED) - pair.at({path: value - s * step}).growth(SPEED))
            / (2 * s * step)
            for s in (1, 2)
        )
        mine, off = (4 * near - wide) / 3, abs(wide - near) / 3
        stated = float(found.error[0, list(found.parameters).index(path)])
        assert abs(slope - mine) < 2 * stated + 0.1 * off + 1e-7 / step, path
        far += abs(about_twist.derivatives(name)[path] - mine) > 0.3 * abs(mine)
    assert far >= len(own) / 2


def test_both_commands_take_the_option(tmp_path: Path) -> None:
    file = tmp_path / "line.toml"
    tn.dump(Pair().line, file)
    asked = ["--speed", f"{SPEED}rad/s", "--about-steady-state"]
    study = CliRunner().invoke(
        app, ["tolerance-study", str(file), "-t", "Shaft 2.stiffness=1%", "--samples", "256", *asked]
    )
    assert study.exit_code == 0 and "about its own periodic motion" in study.output
    slopes = CliRunner().invoke(app, ["sensitivity", str(file), "-p", "Shaft 2.stiffness", "--of", "growth", *asked])
    true = tn.stability(Pair().line, SPEED, about_steady_state=True).growth_rate
    assert slopes.exit_code == 0 and f"{true:.4g}" in slopes.output
