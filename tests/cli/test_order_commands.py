"""order-response, speed-sweep and stable-limit: text, JSON, pictures and tables; refusals before computing."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
import xarray as xr

import trunnion as tn

SHAKEN = """\
format = 1

[operation]
speed = "1500 rpm"
speed_range = ["600 rpm", "2400 rpm"]

[[element]]
type = "Disk"
name = "engine"
inertia = "0.2 kg*m^2"
excitation = [{ order = 2, amplitude = "100 N*m", phase = 0.7 }, { order = 4, amplitude = "10 N*m" }]

[[element]]
type = "Shaft"
name = "coupling"
stiffness = "10 kN*m/rad"
damping = "3 N*m*s/rad"

[[element]]
type = "Disk"
name = "propeller"
inertia = "0.8 kg*m^2"
"""


@pytest.fixture
def shaken(here):
    (here / "shaken.toml").write_text(SHAKEN, encoding="utf-8")
    return tn.load("shaken.toml")


def parsed(result):
    assert result.exit_code == 0, result.stderr
    return json.loads(result.stdout)


@pytest.mark.slow
def test_order_response_says_what_the_analysis_says(run, shaken):
    call = ("order-response", "shaken.toml", "--speed", "600:2400:91")
    expected = tn.order_response(shaken, tn.rpm(np.linspace(600, 2400, 91)))
    data = parsed(run(*call, "--json", "-o", "r.nc"))
    (spring,) = data["springs"]
    assert spring["spring"] == "coupling" and spring["order"] == "order 2"
    assert spring["peak_torque"] == pytest.approx(expected.peak_torque.max(), rel=1e-12)
    assert spring["speed"] == pytest.approx(expected.peak("coupling")[1] * 30 / np.pi)
    assert data["speeds"] == {"low": pytest.approx(600), "high": pytest.approx(2400), "points": 91}
    with xr.open_dataset("r.nc") as written:
        assert np.allclose(written.vibratory_torque, expected.vibratory_torque, rtol=1e-12)
    shown = run(*call, "-o", "r.png")
    assert shown.exit_code == 0, shown.stderr
    assert f"{expected.peak_torque.max():.6g}" in shown.stdout and "at [rpm]" in shown.stdout
    assert "Findings" in shown.stdout and "rad/s" not in shown.stdout


def test_the_table_has_amplitude_and_phase_of_every_order(run, shaken, here):
    assert run("order-response", "shaken.toml", "--speed", "10Hz:30Hz:3", "-u", "Hz", "-o", "r.csv").exit_code == 0
    r = tn.order_response(shaken, 2 * np.pi * np.array([10.0, 20.0, 30.0]))
    with open("r.csv", encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [float(row["speed [Hz]"]) for row in rows] == pytest.approx([10, 20, 30])
    for k, order in enumerate((2, 4)):
        amplitude = [float(row[f"coupling: order {order}: torque_amplitude [N*m]"]) for row in rows]
        phase = [float(row[f"coupling: order {order}: torque_phase [rad]"]) for row in rows]
        assert amplitude * np.exp(1j * np.array(phase)) == pytest.approx(r.torque[:, k, 0], rel=1e-12)
    column = [float(row["engine: speed_fluctuation [rad/s]"]) for row in rows]
    assert column == pytest.approx(r.speed_fluctuation[:, 0], rel=1e-12)


def test_orders_and_single_speeds_and_the_range_of_the_file(run, shaken):
    one = parsed(run("order-response", "shaken.toml", "--speed", "1500", "--orders", "2,3", "--json", "-o", "r.png"))
    assert one["speeds"]["points"] == 1 and [o["order"] for o in one["orders"]] == [2, 3]
    assert any(f["sentence"] == "Nothing excites order 3." for f in one["findings"])
    whole = parsed(run("order-response", "shaken.toml", "--json", "-o", "r.nc"))
    assert whole["speeds"]["low"] == pytest.approx(600) and whole["speeds"]["points"] > 241


def test_a_load_case_moves_the_mean_and_progress_is_told(run, monkeypatch):
    monkeypatch.setattr("trunnion.cli.output.LONG", 0.0)
    result = run("order-response", "line.toml", "--load-case", "climb", "--json", "-o", "r.nc")
    assert parsed(result)["springs"][0]["peak_torque"] > 250
    assert "order response: 100 %" in result.stderr
    with xr.open_dataset("r.nc") as data:
        assert np.allclose(data.mean_torque.sel(spring="Shaft 2"), -250, rtol=1e-12)


def test_speed_sweep(run, here):
    expected = tn.speed_sweep(tn.load("line.toml"), tn.rpm(np.linspace(600, 2400, 31)))
    data = parsed(run("speed-sweep", "line.toml", "--speed", "600:2400:31", "--json", "-o", "s.csv", "-o", "s.png"))
    assert [s["torque_amplitude"] for s in data["shafts"]] == pytest.approx(expected.torque_amplitude.max(axis=0))
    header, first = (here / "s.csv").read_text(encoding="utf-8").splitlines()[:2]
    assert header.startswith("speed [rpm],Shaft 1: twist_amplitude [rad]") and float(first.split(",")[0]) == 600
    assert "rpm" in (shown := run("speed-sweep", "line.toml", "-o", "s.png").stdout) and "rad/s" not in shown


def test_stable_limit(run, here):
    call = ("stable-limit", "two-shaft-cardan", "-p", "HookeJoint 1.angle:0deg:40deg:20", "--speed", "1.5:1.7:5")
    result = tn.stable_limit(
        tn.catalogue("two-shaft-cardan"), "HookeJoint 1.angle", np.linspace(1.5, 1.7, 5), high=tn.deg(40), scan=19
    )
    data = parsed(run(*call, "--json", "-o", "l.nc"))
    assert data["limit"] == pytest.approx(result.limit, rel=1e-12) and data["unit"] == "rad"
    assert data["smallest"] == pytest.approx(result.smallest) and "crossing" in data["kind"]
    shown = run(*call, "-o", "l.png")
    assert shown.exit_code == 0 and f"{np.rad2deg(result.smallest):.6g}°" in shown.stdout
    one = parsed(run(*call[:-1], "1.6", "--json", "-o", "one.svg"))
    assert one["speed"] == [1.6] and one["limit"] == pytest.approx([result.limit[2]], rel=1e-9)


REFUSED = [
    (("order-response", "line.toml", "--speed", "2400:600"), "--speed = '2400:600': is not a rising range"),
    (("order-response", "line.toml", "--speed", "600:2400:1"), "must end in a whole number of speeds"),
    (("order-response", "line.toml", "--speed", "1:2:3:4"), "is not a range"),
    (("speed-sweep", "line.toml", "--speed", "0:2400"), "--speed = '0': must be positive"),
    (("order-response", "line.toml", "--speed", "600:fast"), "--speed = 'fast': "),
    (("order-response", "line.toml", "--orders", "1,-2"), "--orders = '1,-2': is not a list of orders"),
    (("order-response", "line.toml", "--orders", "two"), "is not a list of orders"),
    (("order-response", "line.toml", "--spring", "Shaft 3"), "is not a shaft or mesh of the line; did you mean"),
    (("order-response", "line.toml", "-o", "r.xls"), "has no ending that names a format"),
    (("stable-limit", "line.toml", "--speed", "1500:1400"), "is not a rising range"),
    (("stable-limit", "line.toml", "-p", "Shaft 1.stiffness"), "needs a range"),
    (("stable-limit", "line.toml", "-p", "Shaft 1.stiffness:1000:2000:20:log"), "is searched evenly; leave out :log"),
    (("speed-sweep", "duffing"), "is neither a file nor a name of the catalogue"),
]


@pytest.mark.parametrize(("call", "words"), REFUSED, ids=[" ".join(call) for call, _ in REFUSED])
def test_one_line_exit_code_2_and_nothing_written(run, here, call, words):
    result = run(*call)
    assert result.exit_code == 2, result.output
    assert result.stdout == "" and words in result.stderr
    assert result.stderr.startswith("error: ") and result.stderr.count("\n") == 1
    assert not (here / "trunnion-out").exists()


def test_a_line_that_nothing_excites_has_no_largest_order(run, here):
    shaft = '[[element]]\ntype = "Shaft"\nname = "shaft"\nstiffness = 1e3\n'
    text = '[[element]]\ntype = "ConstantSpeed"\n' + shaft + '[[element]]\ntype = "Disk"\ninertia = 1\n'
    text = 'format = 1\n[operation]\nspeed = "900 rpm"\nspeed_range = ["600 rpm", "1200 rpm"]\n' + text
    (here / "still.toml").write_text(text, encoding="utf-8")
    result = run("order-response", "still.toml")
    assert result.exit_code == 0 and "nan" not in result.stdout
    (spring,) = json.loads(run("order-response", "still.toml", "--json").stdout)["springs"]
    assert [value for value in spring.values() if value is None] == [None, None]
