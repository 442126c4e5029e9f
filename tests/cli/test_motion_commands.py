"""The commands simulate, periodic-response and run-up: text, JSON, files and refusals."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import xarray

import trunnion as tn


def test_simulate_a_line(run, here):
    result = run("simulate", "line.toml", "--turns", 3, "--speed", "900 rpm")
    assert result.exit_code == 0, result.stderr
    assert "motion of test line over 0.2 s (3 turns)" in result.stdout and "Shaft 2: torque" in result.stdout
    names = {path.name for path in (here / "trunnion-out").iterdir()}
    assert names == {"line-motion.png", "line-motion.nc"}
    with xarray.open_dataset(here / "trunnion-out" / "line-motion.nc") as data:
        expected = tn.simulate(tn.load("line.toml"), speed=tn.rpm(900), turns=3)
        np.testing.assert_allclose(data["torque"].values, expected.torque, atol=1e-9)


def test_simulate_with_rising_speed(run, here):
    call = ("simulate", "line.toml", "--to-speed", "1800 rpm", "--duration", 0.5)
    result = run(*call, "-o", "a.csv", "-o", "b.svg", "--json")
    assert result.exit_code == 0, result.stderr
    data = json.loads(result.stdout)
    assert data["outcome"] == "reached" and data["end"] == 0.5 and data["written"] == ["a.csv", "b.svg"]
    header, *rows = (here / "a.csv").read_text(encoding="utf-8").splitlines()
    assert header.startswith("time [s],Disk 1: rotation [rad]") and "Shaft 2: torque [N*m]" in header
    assert header.count(",") == rows[-1].count(",") and float(rows[-1].split(",")[0]) == 0.5


def test_reference_systems(run, here):
    result = run("simulate", "lorenz", "--set", "rho=20", "--duration", 5, "--start", "1,1,1", "--json")
    expected = tn.simulate(tn.reference_system("lorenz", rho=20.0), 5.0, start=[1, 1, 1])
    assert json.loads(result.stdout)["final_state"] == pytest.approx(list(expected.final), rel=1e-12)
    result = run("periodic-response", "duffing", "--start", "2.5,0", "--json")
    data = json.loads(result.stdout)
    assert data["verdict"] == "stable" and data["spectral_radius"] == pytest.approx(0.8773057691, abs=1e-9)
    assert run("periodic-response", "duffing").stdout.startswith("stable periodic motion of duffing")


def test_periodic_response(run, here):
    result = run("periodic-response", "line.toml", "--load-case", "climb")
    assert result.exit_code == 0, result.stderr
    assert "stable periodic motion at 1500 rpm, period 0.5 turns" in result.stdout
    assert "linear theory: growth rate" in result.stdout and "Orders" in result.stdout
    data = json.loads(run("periodic-response", "line.toml", "--load-case", "climb", "--json").stdout)
    expected = tn.periodic_response(tn.load("line.toml").with_load("climb"))
    assert data["shafts"][1]["torque_peak_to_peak"] == pytest.approx(expected.torque_peak_to_peak[1], rel=1e-9)
    assert data["shafts"][1]["mean_torque"] == pytest.approx(-250.0, abs=1e-6)
    assert data["orders"][1] == 2.0
    names = {path.name for path in (here / "trunnion-out").iterdir()}
    assert names == {"line-periodic-response.png", "line-periodic-response.nc"}


def test_linearity_check(run, here):
    call = ("linearity-check", "line.toml", "--load-case", "climb", "--speed", "900 rpm", "--acceleration", 40)
    result = run(*call, "-o", "a.png", "-o", "a.csv")
    assert result.exit_code == 0, result.stderr
    assert result.stdout.startswith("linear and nonlinear response at 900 rpm")
    assert "Linear theory holds at 900 rpm" in result.stdout and "Passed at 382 rpm/s from 720 rpm" in result.stdout
    assert (here / "a.png").is_file() and "linear_torque" in (here / "a.csv").read_text(encoding="utf-8")
    data = json.loads(run(*call[:6], "--json").stdout)
    expected = tn.linearity_check(tn.load("line.toml"), tn.rpm(900), "climb")
    assert data["holds"] == 1 and data["relative_difference"] == pytest.approx(expected.relative_difference.tolist())
    refused = run("linearity-check", "line.toml", "--allowed", 2)
    assert refused.exit_code == 2 and refused.stderr.count("\n") == 1 and "between 0 and 1" in refused.stderr


@pytest.mark.slow
def test_run_up(run, here):
    call = ("run-up", "line.toml", "--from", "500 rpm", "--to", "600 rpm", "--acceleration", "400 rpm")
    result = run(*call, "--limit", "700 N*m")
    assert result.exit_code == 0, result.stderr
    assert "run from 500 rpm to 600 rpm at 400 rpm/s" in result.stdout and "steady vibration found" in result.stdout
    assert "limit" in result.stdout
    data = json.loads(run(*call, "-o", "a.csv", "-o", "b.png", "-o", "c.nc", "--json").stdout)
    expected = tn.run_up(tn.load("line.toml"), tn.rpm(500), tn.rpm(600), acceleration=tn.rpm(400))
    assert [s["peak_torque"] for s in data["shafts"]] == pytest.approx(expected.peak_torque.tolist(), rel=1e-12)
    assert all((here / name).stat().st_size > 500 for name in ("a.csv", "b.png", "c.nc"))


@pytest.mark.slow
def test_run_up_of_an_engine(run, here):
    """With pressures over the load, oscillating masses, and a ring that oil alone drags along."""
    example = Path(__file__).parents[2] / "examples" / "six-cylinder-ship.toml"
    ends = ("--from", "400rpm", "--to", "700rpm", "--acceleration", "50rpm")
    result = run("run-up", example, *ends, "-o", "a.png", "-o", "b.nc")
    assert result.exit_code == 0, result.stderr
    assert "reached 700 rpm" in result.stdout and "the steady response is linear: the swing of" in result.stdout
    assert (here / "a.png").stat().st_size > 500
    line = tn.load(example)
    with xarray.open_dataset(here / "b.nc") as data:
        ends = data["steady_speed"].values[[0, -1]]
        steady = tn.order_response(line, ends)
        np.testing.assert_allclose(data["steady_swing"].values[[0, -1]], steady.vibratory_torque)
        assert ends == pytest.approx([tn.rpm(400), tn.rpm(700)]) and data.attrs["period"] == 2
        # At the end of a brisk passage, away from resonances, each shaft of the crank swings nearly as at rest.
        crank = [str(name).startswith("engine.crank") for name in data["shaft"].values]
        last = data["swing"].values[-3]
        np.testing.assert_allclose(last[crank], steady.vibratory_torque[-1][crank], rtol=0.05)


FAILED = [
    ("poincare-map", "mathieu"),
    ("lyapunov-spectrum", "ueda", "--periods", "1"),
    ("simulate", "mathieu", "--duration", "3000"),
]


@pytest.mark.parametrize("call", FAILED, ids=" ".join)
def test_what_a_failed_motion_left_is_kept(run, here, call):
    result = run(*call, "-o", "a.png", "--json")
    data = json.loads(result.stdout)
    assert result.exit_code == 1 and data["written"] == ["a.png"] and (here / "a.png").exists()
    assert f"error: {data['says']}" in result.stderr and "UserWarning" not in result.stderr


def test_a_period_to_guess_and_no_unit_1(run, here):
    result = run("periodic-response", "rossler", "--period", "5.9 s")
    assert result.exit_code == 0 and "period 5.881" in result.stdout and "± 8.33608\n" in result.stdout


REFUSALS = [
    (("simulate", "lorenzz"), 2, "neither a file nor a name"),
    (("simulate", "Lorenz"), 2, 'did you mean "lorenz"?'),
    (("certify-chaos", "dead-zone"), 2, 'did you mean "dead-zone-oscillator"?'),
    (("simulate", "duffing", "--turns", "5"), 2, "--turns"),
    (("periodic-response", "rossler", "--period", "5 kg"), 2, "not the unit of a time"),
    (("periodic-response", "line.toml", "--period", "1"), 2, "belongs to reference systems"),
    (("run-up", "line.toml", "--from", "0 rpm"), 2, "--from = '0 rpm'"),
    (("lyapunov-spectrum", "ueda", "-o", "q.csv"), 2, ".png, .pdf, .svg, .nc"),
    (("simulate", "duffing", "--set", "x"), 2, "NAME=VALUE"),
    (("simulate", "duffing", "--set", "speed=1"), 2, "parameters are: damping"),
    (("simulate", "duffing", "--speed", "3"), 2, "belongs to drivelines"),
    (("simulate", "line.toml", "--set", "a=1"), 2, "belongs to reference systems"),
    (("simulate", "duffing", "--start", "a,b"), 2, "list of numbers"),
    (("simulate", "duffing", "--start", "1"), 2, "2 finite numbers"),
    (("simulate", "line.toml", "--to-speed", "900 rpm"), 2, "--duration"),
    (("simulate", "line.toml", "--turns", "-1"), 2, "positive time"),
    (("simulate", "line.toml", "-o", "a.txt"), 2, "no ending that names a format"),
    (("periodic-response", "lorenz"), 2, "guessed"),
    (("run-up", "line.toml", "--acceleration", "0 rpm"), 2, "positive"),
    (("run-up", "line.toml", "--limit", "5 deg"), 2, "not the unit of a torque"),
    (("run-up", "line.toml", "--limit", "-5"), 2, "--limit = '-5': must be a positive torque"),
    (("run-up", "line.toml", "--from", "900 rpm", "--to", "900 rpm"), 2, "also the last speed"),
    (("run-up", "line.toml", "--acceleration", "0.001 rpm"), 2, "more than 20000 turns"),
]


@pytest.mark.parametrize(("call", "code", "words"), REFUSALS, ids=[" ".join(c) for c, _, _ in REFUSALS])
def test_refusals(run, here, call, code, words):
    result = run(*call)
    assert result.exit_code == code
    assert words in result.stderr and result.stderr.startswith("error: ") and result.stderr.count("\n") == 1
    assert not (here / "trunnion-out").exists()


FREE = [
    tn.Disk(inertia=0.4, drive_share=1.0, excitation=[{"order": 2, "amplitude": 40.0}]),
    tn.Shaft(stiffness=6e3, damping=1.5),
    tn.Disk(inertia=0.2),
    tn.HookeJoint(angle=0.35),
    tn.Shaft(stiffness=4e3, damping=1.0),
    tn.Disk(inertia=1.5, quadratic_load=0.003),
]


@pytest.mark.slow
def test_a_captured_run_up_is_a_result(run, here):
    """Exit code 0: what was asked for was found out."""
    tn.dump(tn.Driveline(FREE, operation=tn.Operation(speed="400 rpm")), "free.toml")
    call = ("run-up", "free.toml", "--from", "200 rpm", "--to", "600 rpm", "--acceleration", "100 rpm")
    result = run(*call, "-o", "a.png", "--json")
    assert result.exit_code == 0 and (here / "a.png").is_file(), result.stderr
    data = json.loads(result.stdout)
    assert data["outcome"] == "captured" and "captured at 39" in data["says"]
    assert "rpm, short of 600 rpm: order 2" in data["says"] and "accelerate faster, damp Shaft 2 more" in data["says"]
    assert data["end_speed"] == pytest.approx(tn.rpm(391), rel=0.02) and data["hung"]["speed"] < tn.rpm(400)
    assert data["hung"]["until"] == data["end"] > 4 + data["hung"]["since"]
