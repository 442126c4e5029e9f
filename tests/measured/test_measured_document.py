"""docs/measured.md: its description is read, its examples run in order, its command answers."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pages
from edges import write_edges
from typer.testing import CliRunner

import trunnion as tn
from trunnion.cli.program import app
from trunnion.measured.signals.channel_file import description_of


def test_the_description_of_the_page() -> None:
    (text,) = pages.blocks("measured", "toml")
    found = description_of(tomllib.loads(text), "page")
    assert abs(found.rate - 200e3) < 1e-6 and [one.label for one in found.columns] == [
        "input",
        "hub",
        "gauge",
        "sensor",
    ]
    assert found.columns[2].unit_size == 1000.0 and found.columns[1].pitch_error == 0.01


def test_examples_run_in_order() -> None:
    text, names = pages.run_page("measured")
    assert "measurement of 3 channels" in text and "pitch errors of 2 wheels" in text
    fitted = names["fitted"]
    assert np.all((fitted.low < [2e4, np.deg2rad(12)]) & (fitted.high > [2e4, np.deg2rad(12)]))
    assert "its peak comes" in text and "tube, stiffness: 17 kN m/rad →" in text
    found, line = names["found"], names["line"]
    truth, on_run = tn.order_response(line, found.speed), tn.compare_measured(line, found)
    orders, hub = np.round(truth.order, 9).tolist(), found.column("hub")
    for k in (1, 2):
        steady = np.abs(truth.rotation[:, orders.index(k), truth.inertias.index("hub")])
        true = np.abs(on_run.predicted[:, found.row(k), on_run.channels.index("hub")])
        got = np.abs(found.amplitude[:, found.row(k), hub])
        assert np.abs(got - true).max() < 5e-3 * true.max() and np.abs(got - steady).max() < 0.02 * steady.max()
        assert np.mean(np.abs(got - true) < found.half_width[:, found.row(k), hub]) > 0.9


def test_the_command(tmp_path: Path) -> None:
    line = tn.Driveline(
        [tn.ConstantSpeed(), tn.HookeJoint(angle="12 deg"), tn.Shaft(stiffness=2e4, damping=25),
         tn.Disk(inertia=0.5, name="hub")], operation=tn.Operation(speed="1500 rpm"),
    )  # fmt: skip
    tn.dump(line, tmp_path / "line.toml")
    wheels = {"input": 30, "hub": 30}
    bench = {"jitter": 1e-7, "pitch_error": 0.02, "wheels": 1}
    write_edges(tn.measure(line, ("700 rpm", "1800 rpm"), 12.0, wheels, **bench), tmp_path / "run.csv")
    straight = line.replace_all({"HookeJoint 1": {"angle": 0.0}})
    write_edges(tn.measure(straight, 100.0, 10.0, wheels, seed=3, **bench), tmp_path / "straight.csv")
    words = ["track-orders", str(tmp_path / "run.csv"), "--line", str(tmp_path / "line.toml"), "--orders", "2,4"]
    words += ["--calibration", str(tmp_path / "straight.csv"), "--channel", "hub", "--reference", "input"]
    done = CliRunner().invoke(app, [*words, "--json", "-o", str(tmp_path / "a.png"), "-o", str(tmp_path / "a.nc")])
    assert done.exit_code == 0, done.output
    content = json.loads(done.stdout)
    assert content["order"] == [2, 4] and content["calibrated"] and content["channel"] == ["input", "hub"]
    assert (tmp_path / "a.png").stat().st_size > 10_000 and (tmp_path / "a.nc").stat().st_size > 1000
    text = CliRunner().invoke(app, [*words, "-u", "rpm", "-o", str(tmp_path / "a.csv")]).stdout
    assert "2 orders of 2 channels" in text and "Largest of each order" in text
    for wrong, said in (
        (["--orders", "2,x"], "--orders = '2,x': is not a list of orders"),
        (["--between", "3"], "--between = '3': is not a pair of times"),
        (["--channel", "none"], "channel = 'none': is not a channel"),
        (["--reference", "none"], "channel = 'none': is not a channel"),
    ):
        refused = CliRunner().invoke(app, [*words, *wrong, "-o", str(tmp_path / "b.png")])
        assert refused.exit_code == 2 and said in refused.output, refused.output
    data = [str(tmp_path / "run.csv"), "--calibration", str(tmp_path / "straight.csv"), "--reference", "input"]
    data += ["--orders", "2"]
    tn.dump(line.replace("Shaft 1", stiffness=1.7e4), tmp_path / "thought.toml")
    data += ["--line", str(tmp_path / "thought.toml")]
    over = CliRunner().invoke(app, ["compare-measured", *data, "-o", str(tmp_path / "over.png")])
    assert over.exit_code == 0 and "its peak comes 8.3 % later, 7.7 % larger" in over.stdout, over.output
    free = ["--free", "Shaft 1.stiffness:10000:40 kN*m/rad"]
    better = tmp_path / "better.toml"
    asked = ["identify", *data, *free, "--json", "--write", str(better), "-o", str(tmp_path / "fit.png")]
    fit = CliRunner().invoke(app, asked)
    assert fit.exit_code == 0, fit.output
    (low,), (high,) = (json.loads(fit.stdout)[key] for key in ("low", "high"))
    assert low - 3 * (high - low) < 2e4 < high + 3 * (high - low)
    assert abs(tn.load(better).elements[2].torsional_stiffness - 2e4) < 100
    for words, said in ((["--free", "x:1"], "is not a parameter with bounds"), ([], "--free: is missing")):
        refused = CliRunner().invoke(app, ["identify", *data, *words])
        assert refused.exit_code == 2 and said in refused.output, refused.output
    alone = CliRunner().invoke(app, ["compare-measured", data[0], "-o", str(tmp_path / "c.png")])
    assert alone.exit_code == 2 and "--line: is missing" in alone.output
    missing = CliRunner().invoke(app, ["track-orders", str(tmp_path / "none.wav")])
    assert missing.exit_code == 2 and "is not there" in missing.output
