"""``trunnion study``: from a file to a store, and what is asked of it; exports beside the data they were made of."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest
import tomli_w
import xarray as xr
from studies.asked import line, stated

import trunnion as tn
from trunnion.studies import extra


@pytest.fixture
def study(run, here: Path):
    """``trunnion study …`` where study.toml and line.toml lie."""
    tn.dump(line(), here / "line.toml")
    (here / "study.toml").write_text(tomli_w.dumps(stated(Path("s.zarr"), line="line.toml", block=8)))
    return lambda *args: run("study", *args)


def test_from_file_to_exports(study, here: Path) -> None:
    cost = study("study.toml", "--dry-run")
    assert cost.exit_code == 0 and "40 points (5 × 8) in 5 blocks" in cost.stdout and not (here / "s.zarr").exists()
    made = study("study.toml", "--workers", "0")
    assert made.exit_code == 0 and "stability at 40 points (5 × 8): 40 done, 0 failed" in made.stdout
    assert "40 points, 40 done, 0 failed, 0 missing" in study("status", "s.zarr").stdout
    assert "in s.zarr: 40 points, 40 done" in study("status", "study.toml").stdout, "the file names its store"
    assert json.loads(study("show", "s.zarr", "--json").stdout)["done"] == 40
    assert study("resume", "s.zarr", "--verify").exit_code == 0
    assert study("export", "s.zarr", "-o", "s.nc", "-o", "s.csv", "-o", "s.parquet").exit_code == 0
    found = tn.study("study.toml", workers=0)
    growth, speed = found.quantity("growth_rate"), found.parameter("speed")
    with xr.open_dataset(here / "s.nc", engine="h5netcdf") as data:
        assert np.array_equal(data["growth_rate"], growth) and np.array_equal(data["speed"], speed)
        assert data["speed"].attrs["units"] == "rad/s"
    with (here / "s.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert [float(row["growth_rate"]) for row in rows] == growth.tolist()
    assert {row["verdict"] for row in rows} == {"stable", "unstable"} and {row["status"] for row in rows} == {"done"}
    table = pyarrow.parquet.read_table(here / "s.parquet").to_pydict()
    assert table["growth_rate"] == growth.tolist() and table["speed"] == speed.tolist()
    with xr.open_zarr(here / "s.zarr", group="part-0", consolidated=False) as opened:
        assert np.array_equal(opened["growth_rate"], growth) and opened["growth_rate"].dims == ("point",)


def test_what_is_missing_is_said(study, here: Path) -> None:
    """A time limit ends it with what it has and exit code 1; a store that grows is shown and exported."""
    ended = study("study.toml", "--workers", "0", "--within", "1 ms")
    assert ended.exit_code == 1 and "40 of 40 points are missing" in ended.stderr
    assert "40 missing" in study("status", "s.zarr").stdout
    empty = study("export", "s.zarr", "-o", "s.parquet")
    assert empty.exit_code == 2 and "has no point that is done; run the study first" in empty.stderr


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        (("stauts", "s.zarr"), 'is nothing that is asked of a store; did you mean "status"?'),
        (("status",), "STORE: is missing; write: trunnion study status truck.zarr"),
        (("status", "s.zarr", "-o", "s.csv"), "--output = 's.csv': is nothing that it writes"),
        (("show", "nothing.zarr"), "is not a store of a study; name the folder that a study wrote"),
        (("study.tml",), 'study.tml: file not found; did you mean "study.toml"?'),
        (("export", "s.zarr"), "--output: is missing; give a file ending in one of .nc, .csv, .parquet"),
    ],
)
def test_refusals(asked, message, study) -> None:
    answer = study(*asked)
    assert answer.exit_code == 2 and message in answer.stderr and answer.stderr.count("\n") == 1


def test_without_the_extra(study, monkeypatch) -> None:
    """One line says how to install it; what all would cost is known without."""

    def missing(name: str) -> None:
        raise ModuleNotFoundError(f"No module named {name!r}", name=name)

    monkeypatch.setattr(extra, "import_module", missing)
    answer = study("study.toml")
    said = 'error: scale: studies need dask, which is not installed; install it with: python -m pip install "trunnion['
    assert answer.exit_code == 2 and answer.stderr.startswith(said) and answer.stderr.count("\n") == 1
    assert study("study.toml", "--dry-run").exit_code == 0


@pytest.mark.slow
def test_show_says_what_sampled_numbers_follow(study, here: Path) -> None:
    sampled = {"parameter": [{"path": "Shaft 1.damping", "tolerance": "20 %"}], "sampling": {"points": 64}}
    asked = stated(Path("s.zarr"), line="line.toml", arguments={"speed": 1.0}, **{**sampled})
    (here / "study.toml").write_text(tomli_w.dumps(asked))
    assert study("study.toml", "--workers", "0").exit_code == 0
    shown = study("show", "s.zarr").stdout
    assert "variance of growth_rate by parameter, from 64 points\n  Shaft 1.damping: 9" in shown


def test_show_draws(study, here: Path) -> None:
    """Into files, what is asked for; another ending, and shares of what was not sampled, are refused."""
    study("study.toml", "--workers", "0")
    drawn = study("show", "s.zarr", "-o", "a.png", "-o", "a.svg", "--of", "verdict", "--kind", "slices", "--x", "speed")
    assert drawn.exit_code == 0 and "a.png" in drawn.stdout
    assert (here / "a.png").stat().st_size > 5000 and b"unstable" in (here / "a.svg").read_bytes()
    ending = study("show", "s.zarr", "-o", "a.doc")
    assert ending.exit_code == 2 and "end it in .png, .pdf or .svg" in ending.stderr
    assert study("show", "s.zarr", "-o", "a.png", "--kind", "shares").exit_code == 2


def test_a_line_of_the_catalogue(study, here: Path) -> None:
    text = (here / "study.toml").read_text()
    (here / "study.toml").write_text(text.replace("line.toml", "two-shaft-cardan"))
    assert "HookeJoint 1.angle" in study("study.toml", "--workers", "0").stdout
    (here / "study.toml").write_text(text.replace("line.toml", "two-shaft-carden"))
    wrong = study("study.toml")
    said = 'is neither a file nor a name of the catalogue; did you mean "two-shaft-cardan"?'
    assert wrong.exit_code == 2 and said in wrong.stderr
    (here / "study.toml").write_text(text.replace("line.toml", "gear-rattle"))
    assert "is not a driveline but equations of motion" in study("study.toml").stderr


def test_a_boundary(study, here: Path) -> None:
    """It is looked for, told along a parameter, drawn, and asked of a store that has none."""
    asked = stated(Path("b.zarr"), ["verdict"], line="line.toml")
    asked["parameter"] = [
        {"path": "HookeJoint 1.angle", "low": "0 deg", "high": "40 deg", "points": 5},
        {"path": "speed", "low": 1.2, "high": 2.0, "points": 17},
    ]
    (here / "edge.toml").write_text(
        tomli_w.dumps({**asked, "boundary": {"quantity": "verdict", "value": "unstable", "halvings": 2}})
    )
    made = study("edge.toml", "--workers", "0")
    assert made.exit_code == 0 and "boundary of verdict = unstable over HookeJoint 1.angle, speed" in made.stdout
    assert "points; the same everywhere takes 1105" in study("boundary", "b.zarr").stdout
    told = study("boundary", "b.zarr", "--along", "speed", "--at", "HookeJoint 1.angle=35 deg", "--json")
    crossings = json.loads(told.stdout)["crossings"]
    assert len(crossings) == 2 and all(one["low"] <= one["estimate"] <= one["high"] for one in crossings)
    shown = study("boundary", "b.zarr", "--along", "speed", "--at", "HookeJoint 1.angle=35 deg").stdout.splitlines()
    assert "2 crossings along speed" in shown[0] and f"{crossings[0]['low']:.6g} rad/s" in shown[1]
    drawn = study("show", "b.zarr", "-o", "b.png", "--x", "speed", "--y", "HookeJoint 1.angle")
    assert drawn.exit_code == 0 and (here / "b.png").stat().st_size > 5000
    study("study.toml", "--workers", "0")
    for ask, message in (
        (("boundary", "s.zarr"), "looked for no boundary; write [boundary]"),
        (("boundary", "b.zarr", "--at", "speed=1.5"), "--along: is missing"),
        (("boundary", "b.zarr", "--along", "sped"), 'did you mean "speed"?'),
        (("boundary", "b.zarr", "--along", "speed", "--at", "5 deg"), "is not PARAMETER=VALUE"),
        (("boundary", "b.zarr", "--along", "speed", "--at", "HookeJoint 1.angle=5 mm"), "at"),
        (("show", "b.zarr", "-o", "c.png", "--kind", "chart"), 'stand about a boundary; take "boundary"'),
    ):
        answer = study(*ask)
        assert answer.exit_code == 2 and message in answer.stderr and answer.stderr.count("\n") == 1


def test_where_another_parameter_stands_in_a_picture(study, here: Path) -> None:
    """By its text with a unit: the title says at which point."""
    study("study.toml", "--workers", "0")
    at = ("--kind", "slices", "--x", "speed", "--at", "HookeJoint 1.angle=39 deg")
    drawn = study("show", "s.zarr", "-o", "s.svg", *at)
    assert drawn.exit_code == 2 and "is not a parameter that stands still here" in drawn.stderr
    asked = stated(Path("three.zarr"), ["growth_rate"], line="line.toml")
    asked["parameter"].append({"path": "Shaft 1.damping", "values": [0.01, 0.02]})
    (here / "three.toml").write_text(tomli_w.dumps(asked))
    study("three.toml", "--workers", "0")
    drawn = study("show", "three.zarr", "-o", "t.svg", "--at", "Shaft 1.damping=0.019 N*m*s/rad")
    assert drawn.exit_code == 0 and "0.02" in (here / "t.svg").read_text(encoding="utf-8")
