"""Measured orders on a Campbell diagram, a run-up and a report, and accelerometers, against closed forms."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.passing_order import states_on_run

import trunnion as tn
from trunnion.errors import InputError
from trunnion.pictures.measured import on_campbell, on_run_up

STIFFNESS, DAMPING, INERTIA, TORQUE = 2e4, 25.0, 0.5, 30.0
RATE = (260.0 - 120.0) / 14.0


def line(**tube: Any) -> tn.Driveline:
    """A disk behind a shaft and a straight joint, shaken once a turn."""
    hub = tn.Disk(inertia=INERTIA, name="hub", excitation=[{"order": 1, "amplitude": TORQUE}])
    shaft = tn.Shaft(**{"stiffness": STIFFNESS, "damping": DAMPING, "name": "tube", **tube})
    return tn.Driveline([tn.ConstantSpeed(), shaft, hub], operation=tn.Operation(speed="1500 rpm"))


def swing(speed: np.ndarray) -> np.ndarray:
    """Amplitude of the hub by hand."""
    return TORQUE / np.abs(STIFFNESS - INERTIA * speed**2 + 1j * DAMPING * speed)


def on_run(speed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Amplitudes of the hub's acceleration and of the torque that vibrates in the tube, on the run of ``data``."""
    matrix = np.array([[0.0, 1.0], [-STIFFNESS / INERTIA, -DAMPING / INERTIA]])
    states = states_on_run(matrix, np.array([0.0, TORQUE / INERTIA]), np.zeros(2), 1.0, speed, RATE)
    torque = states @ [STIFFNESS, DAMPING]
    return np.abs(TORQUE - torque) / INERTIA, np.abs(torque)


@pytest.fixture(scope="module")
def data() -> tn.MeasuredOrders:
    bench = {"gauges": ["tube"], "accelerometers": ["hub"], "accelerometer_noise": 1.0, "pitch_error": 0.0}
    run = tn.measure(line(), (120.0, 260.0), 14.0, {"input": 36, "hub": 36}, **bench)
    return tn.track_orders(run, [1, 2], line=line(), reference="input")


def test_an_accelerometer_shows_the_second_derivative(data: tn.MeasuredOrders) -> None:
    """Of the hub on the run, by hand, within 95 % intervals and a thousandth of the largest."""
    cut = data.cut(1, "acceleration of hub")
    known = on_run(cut.speed)[0]
    assert np.abs(known - swing(cut.speed) * cut.speed**2).max() > 0.005 * known.max()  # it lags
    off = np.abs(np.abs(cut.amplitude) - known)
    assert np.all(off < np.maximum(cut.high - np.abs(cut.amplitude), 1e-3 * known.max()) * 1.5)
    assert np.median(off) < 2e-3 * known.max() and known.max() > 100.0
    found = tn.compare_measured(line(), data)
    column = found.channels.index("acceleration of hub")
    assert found.off[0, column] < 0.01
    extreme = data.extreme[:, data.column("acceleration of hub")]
    assert np.abs(extreme - RATE - known).max() < 0.03 * known.max()
    assert np.isnan(data.extreme[:, data.column("hub")]).all()


def test_identify_by_an_accelerometer_alone(data: tn.MeasuredOrders) -> None:
    """Pickup of the input for the rotation, the accelerometer for the line."""
    run = tn.measure(line(), (120.0, 260.0), 14.0, {"input": 36}, accelerometers=["hub"], accelerometer_noise=1.0)
    orders = tn.track_orders(run, [1], line=line(), reference="input")
    found = tn.identify(line(stiffness=1.7e4), orders, {"tube.stiffness": (1e4, 4e4)})
    assert found.low[0] < STIFFNESS < found.high[0] and abs(found.value[0] / STIFFNESS - 1) < 0.01


def test_marks_stand_on_the_order_lines(data: tn.MeasuredOrders) -> None:
    """At speed and order times speed, areas as amplitudes; the cross at the closed form's peak."""
    found = tn.compare_measured(line(stiffness=1.8e4), data)
    panel = on_campbell(found, channel="hub").panel
    marks = next(one for one in panel.items if getattr(one, "role", "") == "measured")
    speed = np.asarray(marks.x) * 2 * np.pi / 60
    assert np.asarray(marks.y) * 2 * np.pi == pytest.approx(speed, rel=1e-9)  # order 1 alone stands out
    known = swing(speed)
    assert np.asarray(marks.sizes) ** 2 == pytest.approx(13.0**2 * known / known.max(), rel=0.03)
    peak = next(one for one in panel.items if getattr(one, "role", "") == "measured peak")
    square = STIFFNESS / INERTIA - (DAMPING / INERTIA) ** 2 / 2
    assert peak.x[0] * 2 * np.pi / 60 == pytest.approx(np.sqrt(square), rel=0.01)
    damped = np.sqrt(1.8e4 / INERTIA - (DAMPING / INERTIA / 2) ** 2)  # of the line as it is thought to be
    modes = [one for one in panel.items if getattr(one, "role", "") == "mode"]
    assert np.median(modes[0].y) == pytest.approx(damped / (2 * np.pi), rel=1e-9)
    assert found.plot_campbell(channel="tube").get_xlabel() == "input speed [rpm]"


def test_torques_stand_on_the_run_up(data: tn.MeasuredOrders) -> None:
    """The largest torque of each window, which for the true line is that of its own run-up."""
    found = tn.compare_measured(line(), data)
    panel = on_run_up(found).panel
    marks = next(one for one in panel.items if getattr(one, "role", "") == "measured")
    turns = next(one for one in panel.items if getattr(one, "role", "") == "turns")
    there = np.interp(marks.x, turns.x, turns.y)
    inside = (marks.x > turns.x[0] + 100) & (marks.x < turns.x[-1] - 10)  # where the acceleration has set in
    assert np.abs(np.asarray(marks.y) - there)[inside].max() < 0.04 * max(turns.y)
    by_hand = on_run(found.speed)[1] + INERTIA * RATE  # what accelerates the hub
    assert np.abs(np.asarray(marks.y) - by_hand)[inside].max() < 0.02 * by_hand.max()
    assert found.plot_run_up().get_ylabel().startswith("largest torque of tube")


def test_what_no_run_up_compares_with(data: tn.MeasuredOrders) -> None:
    found = tn.compare_measured(line(), data)
    with pytest.raises(InputError, match="channel = 'hub': measures no torque; there are tube"):
        found.plot_run_up(channel="hub")
    steady = tn.measure(line(), 180.0, 4.0, {"input": 36, "hub": 36}, gauges=["tube"])
    still = tn.compare_measured(line(), tn.track_orders(steady, [1], line=line(), reference="input"))
    with pytest.raises(InputError, match="data: is of a steady speed"):
        still.plot_run_up()
    still.plot_campbell()
    bare = tn.measure(line(), (120.0, 260.0), 5.0, {"input": 36, "hub": 36})
    with pytest.raises(InputError, match="data: has no torque channel"):
        tn.compare_measured(line(), tn.track_orders(bare, [1], line=line(), reference="input")).plot_run_up()


def written(folder: Path, extra: str, signal: np.ndarray, rate: float, turns: np.ndarray) -> Path:
    """A table with the pulses of a wheel of 8 and one accelerometer."""
    path = folder / "run.csv"
    pulses = (np.mod(8 * turns, 1.0) < 0.5).astype(float)
    np.savetxt(path, np.column_stack([pulses, signal]), delimiter=",", header="wheel,sensor", comments="")
    text = f"""rate = {rate}

[[channel]]
column = "wheel"
kind = "pulses"
pulses_per_turn = 8
at = "hub"

[[channel]]
column = "sensor"
kind = "acceleration"
at = "hub"
{extra}
"""
    path.with_suffix(".channels.toml").write_text(text, encoding="utf-8")
    return path


def tangential(gravity: float) -> tuple[np.ndarray, float, np.ndarray]:
    """What a sensor at 80 mm shows [g] of a hub that swings by 2 mrad at order 3, and of gravity."""
    rate, speed = 8000.0, 20 * np.pi
    angle = speed * np.arange(int(4 * rate)) / rate
    own = -(2e-3 * (3 * speed) ** 2) * np.sin(3 * angle) * 0.08
    return (own + gravity * np.sin(angle)) / 9.80665, rate, angle / (2 * np.pi)


def test_a_tangential_accelerometer_and_gravity(tmp_path: Path) -> None:
    """In g at a radius; a single one has gravity once a turn, which is said and counted as unknown."""
    path = written(tmp_path, 'unit = "g"\nradius = "80 mm"', *tangential(9.80665))
    found = tn.track_orders(tn.read_measurement(path), [1, 3])
    size = np.abs(found.amplitude[:, :, 1])
    assert size[:, 1] == pytest.approx(2e-3 * (60 * np.pi) ** 2, rel=2e-3)
    assert size[:, 0] == pytest.approx(9.80665 / 0.08, rel=2e-3)
    assert found.hidden[:, 1].tolist() == [True, False]
    assert found.half_width[:, 0, 1].min() > 9.80665 / 0.08
    assert "order 1 holds gravity, 123 rad/s² at a single accelerometer" in str(found)
    pair = written(tmp_path, 'unit = "m/s^2"\nscale = 9.80665\nradius = "80 mm"\ngravity = false', *tangential(0.0))
    again = tn.track_orders(tn.read_measurement(pair), [1, 3])
    assert not again.hidden[:, 1].any() and "gravity" not in str(again)
    assert np.abs(again.amplitude[:, 1, 1]) == pytest.approx(2e-3 * (60 * np.pi) ** 2, rel=2e-3)


BAD = [
    ('unit = "m/s^2"', "channel 2.unit", "angular acceleration"),
    ('unit = "rad/s^2"\nradius = "80 mm"', "channel 2.unit", "acceleration"),
    ('unit = "m/s^2"\nradius = 0.0', "channel 2.radius = 0: must be positive", "80 mm"),
    ('radius = "80 mm"', "channel 2.unit: is missing", 'unit = "m/s^2"'),
    ('unit = "m/s^2"\nradius = "80 kg"', "radius", "length"),
]


@pytest.mark.parametrize(("extra", "where", "words"), BAD, ids=[row[0] for row in BAD])
def test_descriptions_of_accelerometers_that_are_wrong(extra: str, where: str, words: str, tmp_path: Path) -> None:
    path = written(tmp_path, extra, *tangential(0.0))
    with pytest.raises(InputError) as caught:
        tn.read_measurement(path)
    assert where in str(caught.value) and words in str(caught.value) and "\n" not in str(caught.value)


def test_a_radius_belongs_to_an_acceleration(tmp_path: Path) -> None:
    path = written(tmp_path, 'unit = "N*m"\nradius = "80 mm"', *tangential(0.0))
    place = path.with_suffix(".channels.toml")
    place.write_text(place.read_text().replace('kind = "acceleration"', 'kind = "torque"'))
    with pytest.raises(InputError, match='channel 2.radius = .*belongs to kind = "acceleration"'):
        tn.read_measurement(path)


def test_places_of_accelerometers_are_checked() -> None:
    with pytest.raises(InputError, match="accelerometers = 'tube': is not a disk of the line"):
        tn.measure(line(), 180.0, 1.0, {"hub": 36}, accelerometers=["tube"])
    with pytest.raises(InputError, match="accelerometer_noise = -1: must not be negative"):
        tn.measure(line(), 180.0, 1.0, {"hub": 36}, accelerometer_noise=-1.0)


@pytest.mark.slow
def test_a_report_shows_what_was_measured(data: tn.MeasuredOrders) -> None:
    """One picture of each kind of channel, the Campbell diagram and the run-up, and a sentence an order."""
    other = line(stiffness=1.8e4)
    bare = tn.report(other, points=(6, 4))
    assert 'id="measured"' not in bare.html and not [name for name in bare.pictures if "measured" in name]
    page = tn.report(other, points=(6, 4), measured=data)
    shown = [name for name in page.pictures if name.startswith("measured")]
    assert shown == [
        "measured hub", "measured tube", "measured acceleration of hub", "measured on Campbell", "measured on run-up",
    ]  # fmt: skip
    section = page.html.partition('id="measured"')[2].partition("</section>")[0]
    assert section.count("<img") == 5 and "Order 1 of hub: " in section and "its peak comes" in section
    assert all(page.pictures[name].address in section for name in shown)


def test_the_command_writes_the_picture_asked_for(tmp_path: Path) -> None:
    from typer.testing import CliRunner

    from trunnion.cli.program import app

    path = written(tmp_path, 'unit = "g"\nradius = "80 mm"', *tangential(0.0))
    file = tmp_path / "line.toml"
    tn.dump(line(), file)
    asked = ["compare-measured", str(path), "--line", str(file), "--orders", "1,3"]
    run = CliRunner().invoke(app, [*asked, "--over", "chart"])
    assert run.exit_code == 2 and "--over = 'chart': is not a picture" in run.output
    run = CliRunner().invoke(app, [*asked, "--report", str(tmp_path / "page.pdf")])
    assert run.exit_code == 2 and "does not end in .html" in run.output
    picture = tmp_path / "campbell.svg"
    run = CliRunner().invoke(app, [*asked, "--over", "campbell", "-o", str(picture)])
    assert run.exit_code == 0, run.output
    assert picture.stat().st_size > 10_000


@pytest.mark.slow
def test_the_command_writes_the_report(tmp_path: Path) -> None:
    from typer.testing import CliRunner

    from trunnion.cli.program import app

    path, page = written(tmp_path, 'unit = "g"\nradius = "80 mm"', *tangential(0.0)), tmp_path / "page.html"
    tn.dump(line(), tmp_path / "line.toml")
    asked = ["compare-measured", str(path), "--line", str(tmp_path / "line.toml"), "--orders", "1,3"]
    run = CliRunner().invoke(app, [*asked, "--report", str(page), "-o", str(tmp_path / "a.png")])
    assert run.exit_code == 0, run.output
    assert 'id="measured"' in page.read_text(encoding="utf-8")
