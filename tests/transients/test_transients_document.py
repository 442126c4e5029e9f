"""docs/transients.md: its file runs as a command, its examples run in order."""

from __future__ import annotations

import json
from pathlib import Path

import pages
import pytest
from typer.testing import CliRunner

import trunnion as tn
from trunnion.cli.program import app


def test_the_file_of_the_page(tmp_path: Path) -> None:
    text, fault = pages.blocks("transients", "toml")
    file = tmp_path / "mill.toml"
    file.write_text(text, encoding="utf-8")
    line = tn.load(file)
    assert tn.loads(tn.dumps(line)) == line
    done = CliRunner().invoke(app, ["transient", str(file), "--json", "-o", str(tmp_path / "start.png")])
    assert done.exit_code == 0, done.output
    content = json.loads(done.stdout)
    assert content["scenario"] == "start and bite" and content["outcome"] == "reached"
    assert len(content["crossings"]) == 1 and content["energy_error"] < 1e-8
    assert (tmp_path / "start.png").stat().st_size > 10_000
    more = text + "\n" + fault.replace('"generator"', '"motor"')  # belongs to the last scenario
    (stated,) = tn.loads(more).scenarios[0].disturbance
    assert stated.case == "two-phase short circuit" and stated.torques[0].until is None
    wrong = CliRunner().invoke(app, ["transient", str(file), "--scenario", "stat"])
    assert wrong.exit_code == 2 and "is not a scenario of this driveline" in wrong.output
    none = CliRunner().invoke(app, ["transient", "two-shaft-cardan"])
    assert none.exit_code == 2 and "write [[scenario]] in the file" in none.output


def test_examples_run_in_order() -> None:
    text, names = pages.run_page("transients")
    assert "the speed of mill comes to 1000 rpm" in text
    stop = names["stop"]
    assert stop.outcome.kind == "reached" and stop.energy.error < 1e-8
    assert abs(stop.speed[-1, 1]) < 1e-9


def test_a_table_in_a_file_of_its_own(tmp_path: Path) -> None:
    (tmp_path / "torque.csv").write_text("time [ms];torque [kN*m]\n0;0\n500;0.06\n", encoding="utf-8")
    text = 'format = 1\n[[scenario]]\nname = "a"\nduration = "0.5 s"\nspeed = "0 rpm"\n[[scenario.torque]]\non = "a"\n'
    disks = '[[element]]\ntype = "Disk"\nname = "{}"\ninertia = 1.0\n'
    shaft = '[[element]]\ntype = "Shaft"\nstiffness = 1000.0\n'
    file = tmp_path / "line.toml"
    file.write_text(f'{text}file = "torque.csv"\n{disks.format("a")}{shaft}{disks.format("b")}', encoding="utf-8")
    run = tn.transient(tn.load(file), "a")
    assert run.speed[-1].sum() == pytest.approx(15.0, rel=1e-9)
    for content, words in (
        ("time [s],torque\n0,0\n", "torque: has no unit"),
        ("time [s],torque [rpm]\n0,0\n", "has no unit of a torque"),
        ("time [s],torque [N*m]\n0,0\n1,\n", "row 3.torque: is missing"),
        ("time [s],torque [N*m]\n0,0\n2,1\n1,1\n", "does not rise at point 3"),
        ("torque [N*m]\n0\n", "goes over one of time, speed and angle"),
        ("time [s],torque [N*m]\n", "has no rows"),
    ):
        (tmp_path / "torque.csv").write_text(content, encoding="utf-8")
        with pytest.raises(tn.InputError) as refused:
            tn.load(file)
        assert words in str(refused.value)
