"""The gear pair reduced to one equation, against its two; its commands and its reproduction."""

from __future__ import annotations

import json
from math import cos, pi, radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from typer.testing import CliRunner

import trunnion as tn
from trunnion.cli.program import app
from trunnion.errors import InputError
from trunnion.numerics.piecewise_linear.piecewise import move

PAIR = {"radii": (0.04, 0.06), "inertias": (2e-3, 5e-3), "stiffness": 2e6}


@pytest.mark.slow
def test_one_equation_is_the_two() -> None:
    """u = r₁φ₁ − r₂φ₂ − e of the two gears, integrated as they are, over a few mesh periods with loss of contact."""
    (r1, r2), (i1, i2), k = PAIR["radii"], PAIR["inertias"], PAIR["stiffness"]
    c, b, w = 60.0, 2e-5, 900.0
    torques, swing, error = (1.0, 1.5), (6.0, 0.0), ((1, 3e-6, 1e-6), (2, 0.0, 2e-6))
    o = tn.gear_pair(
        **PAIR, half_backlash=b, damping=c, torques=torques, torque_amplitudes=swing, transmission_error=error,
        frequency=w,
    )  # fmt: skip

    def e(t: float, order: int) -> float:
        parts = [(k_ * w, p, q) for k_, p, q in error]
        if order == 0:
            return sum(p * np.cos(f * t) + q * np.sin(f * t) for f, p, q in parts)
        return sum(f * (q * np.cos(f * t) - p * np.sin(f * t)) for f, p, q in parts)

    def rate(t: float, y: Any) -> list[float]:
        u, du = r1 * y[0] - r2 * y[1] - e(t, 0), r1 * y[2] - r2 * y[3] - e(t, 1)
        mesh = k * float(np.sign(u) * max(abs(u) - b, 0.0)) + c * du
        return [
            y[2], y[3], (torques[0] + swing[0] * np.cos(w * t) - r1 * mesh) / i1, (-torques[1] + r2 * mesh) / i2
        ]  # fmt: skip

    end = 4 * 2 * pi / w
    phi = [(e(0.0, 0) + 3e-5) / r1, 0.0, e(0.0, 1) / r1, 0.0]
    run = solve_ivp(rate, (0, end), phi, rtol=1e-12, atol=1e-15, method="DOP853", max_step=2e-6)
    u = r1 * run.y[0, -1] - r2 * run.y[1, -1] - e(end, 0)
    found = move(o.regimes, o.coefficients, w, [3e-5, 0.0], 0.0, end)
    assert len(found.crossings) >= 4
    assert found.state[0] == pytest.approx(u, abs=1e-9)
    assert o.inertia == pytest.approx(i1 * i2 / (i1 * r2**2 + i2 * r1**2))


def test_the_papers_pair() -> None:
    """Unit radii and inertias of two give I = 1 and the paper's equation; no backlash is the linear pair."""
    pair = tn.gear_pair(
        radii=(1.0, 1.0), inertias=(2.0, 2.0), stiffness=1.0, backlash_angle=pi / 9, inside=0.25, damping=0.05,
        torques=(0.05, 0.05), torque_amplitudes=(0.03, 0.03), frequency=0.8,
    )  # fmt: skip
    paper = tn.catalogue("gear-rattle")
    assert pair.but(name=paper.name) == paper
    assert tn.gear_pair(**PAIR, half_backlash=0.0).slopes == (2e6,)
    assert tn.base_radius(30, 0.004) == pytest.approx(0.06 * cos(radians(20)))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"half_backlash": -1e-5}, "must not be negative"),
        ({}, "must be given in one way"),
        ({"half_backlash": 0.0, "backlash_angle": 0.1}, "must be given in one way"),
        ({"half_backlash": 0.0, "radii": (0.0, 1.0)}, "radii"),
        ({"half_backlash": 1e-5, "inside": -0.1}, "must lie between 0 and 1"),
    ],
)
def test_refusals(change: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        tn.gear_pair(**{**PAIR, **change})


def invoke(*arguments: str) -> Any:
    return CliRunner().invoke(app, list(arguments))


@pytest.mark.slow
def test_frequency_response_command(tmp_path: Path) -> None:
    files = [tmp_path / "r.png", tmp_path / "r.nc"]
    result = invoke(
        "frequency-response", "gear-rattle", "--method", "exact", "--method", "describing function", "--from", "0.5",
        "-o", str(files[0]), "-o", str(files[1]),
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    assert "0.874373" in result.output and all(f.stat().st_size > 1000 for f in files)
    told = json.loads(invoke("frequency-response", "gear-rattle", "--json", "-o", str(files[0])).stdout)
    assert told["methods"][0]["peak"]["half_peak_to_peak"] == pytest.approx(0.694, abs=1e-3)
    assert {m["kind"] for m in told["methods"][0]["marks"]} >= {"fold", "period doubling", "grazing"}


def test_sweep_command(tmp_path: Path) -> None:
    file = tmp_path / "s.nc"
    arguments = ("sweep", "gear-rattle", "--set", "mean_force=0", "-o", str(file))
    told = json.loads(invoke(*arguments, "--json").stdout)
    up, down = told["sweeps"]
    assert [0.87, 0.88] in [pytest.approx(j) for j in up["jumps"]]
    assert [0.65, 0.64] in [pytest.approx(j) for j in down["jumps"]]
    shown = invoke(*arguments, "--direction", "down")
    assert shown.exit_code == 0 and "sweep down" in shown.output and "sweep up" not in shown.output
    dead = invoke("sweep", "dead-zone-oscillator", "--points", "20", "-o", str(tmp_path / "d.png"))
    assert dead.exit_code == 0 and "one-sided" in dead.output


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("sweep", "gear-ratle"), "did you mean"),
        (("sweep", "duffing"), "has no gap to be swept over"),
        (("sweep", "gear-rattle", "--direction", "sideways"), "write up, down or both"),
        (("sweep", "gear-rattle", "--from", "2", "--to", "1"), "must be a rising range"),
        (("sweep", "gear-rattle", "--set", "half_gap"), "is not NAME=VALUE"),
        (("sweep", "gear-rattle", "--set", "half_gap=-1"), "must not be negative"),
        (("frequency-response", "gear-rattle", "--set", "gap=1"), "gap"),
        (("frequency-response", "gear-rattle", "--method", "magic"), "is not a method"),
        (("frequency-response", "gear-rattle", "-o", "x.txt"), "is nothing this command writes"),
        (("simulate", "gear-rattle"), "use it with frequency-response"),
    ],
)
def test_commands_refuse(arguments: tuple[str, ...], words: str) -> None:
    result = invoke(*arguments)
    assert isinstance(result.exception, InputError) or result.exit_code != 0
    assert words in f"{result.output} {result.exception}"


@pytest.mark.slow
def test_reproduction(tmp_path: Path) -> None:
    found = tn.reproduce("gear-rattle", points=100)
    methods = found.tables[0]
    assert [row.place for row in methods.rows][:2] == ["exact", "harmonic balance"]
    assert "height -0.89 %" in methods.rows[2].remark
    assert len({row.computed for row in found.tables[3].rows}) == 1
    smaller = found.conclusions[1]
    assert "0.347" in smaller.evidence and smaller.holds == "confirmed"
    assert [row.place for row in found.errata.rows][0] == "(13)"
    written = found.save(tmp_path / "rattle")
    assert len(written) == 6 and all(path.stat().st_size > 10_000 for path in written)
