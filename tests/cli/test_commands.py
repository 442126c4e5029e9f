"""Every command says what it should, as text and as JSON, and writes what it names."""

from __future__ import annotations

import json

import numpy as np
import pytest

import trunnion as tn

SMALL = ("--points", "12x6")


def parsed(result):
    assert result.exit_code == 0, result.stderr
    return json.loads(result.stdout)


def test_without_a_command_it_shows_the_help(run):
    result = run()
    assert result.exit_code == 0
    assert "stability-chart" in result.stdout
    assert run("--version").stdout == f"trunnion {tn.__version__}\n"


def test_natural_frequencies(run):
    modes = tn.natural_frequencies(tn.load("line.toml"))
    result = run("natural-frequencies", "line.toml")
    assert result.exit_code == 0
    assert "frequency [Hz]" in result.stdout
    assert f"{modes.hertz[0]:.6g}" in result.stdout
    data = parsed(run("natural-frequencies", "line.toml", "--json"))
    assert data["frequency_unit"] == "Hz"
    assert [m["frequency"] for m in data["modes"]] == pytest.approx(modes.hertz)
    assert set(data["modes"][0]["shape"]) == {"Disk 1", "Disk 2"}
    nondimensional = parsed(run("natural-frequencies", "two-shaft-cardan", "--json"))
    assert nondimensional["frequency_unit"] == "rad/s"
    assert nondimensional["modes"][1]["undamped_frequency"] == pytest.approx((1 + 5**0.5) / 2)


def test_resonance_speeds(run):
    result = run("resonance-speeds", "line.toml")
    assert result.exit_code == 0
    assert "speed [rpm]" in result.stdout and "ω₂/2" in result.stdout
    some = parsed(run("resonance-speeds", "line.toml", "--json"))["resonances"]
    every = parsed(run("resonance-speeds", "line.toml", "--json", "--all", "--unit", "Hz"))
    assert all(600 <= r["speed"] <= 2400 for r in some)
    assert len(every["resonances"]) == 12 > len(some)
    assert every["speed_unit"] == "Hz"


def test_stability(run):
    expected = tn.stability(tn.load("line.toml"), tn.rpm(1000))
    data = parsed(run("stability", "line.toml", "--speed", "1000 rpm", "--json"))
    assert data["verdict"] == str(expected.verdict)
    assert data["spectral_radius"] == pytest.approx(expected.spectral_radius, rel=1e-12)
    assert len(data["multipliers"]) == 4 and set(data["multipliers"][0]) == {"real", "imag"}
    result = run("stability", "line.toml", "--speed", "1000 rpm")
    assert result.exit_code == 0
    assert "at 1000 rpm" in result.stdout and "Findings" in result.stdout
    assert "rad/s" not in result.stdout


@pytest.mark.parametrize(
    ("speed", "unit"),
    [("1500 rpm", "rpm"), ("25 Hz", "rpm"), ("25", "Hz"), ("1500", "rpm"), (f"{50 * np.pi} rad/s", "rad/s")],
)
def test_a_speed_reads_the_same_in_every_unit(run, speed, unit):
    data = parsed(run("stability", "line.toml", "--speed", speed, "--unit", unit, "--json"))
    assert data["speed"] == pytest.approx({"rpm": 1500, "Hz": 25, "rad/s": 50 * np.pi}[unit])


def test_a_load_case_changes_the_mean_torque(run):
    data = parsed(run("stability", "line.toml", "--load-case", "climb", "--json"))
    assert [round(s["torque_mean"]) for s in data["forced_response"]] == [-250, -250]


@pytest.mark.slow
def test_chart_in_every_format(run, here):
    names = ["c.png", "c.pdf", "c.svg", "c.nc", "c.csv"]
    options = [part for name in names for part in ("-o", name)]
    result = run("stability-chart", "line.toml", *SMALL, *options)
    assert result.exit_code == 0, result.stderr
    assert all((here / name).stat().st_size > 500 for name in names)
    chart = tn.load_chart("c.nc")
    assert (chart.x_label, chart.y_label) == ("speed", "HookeJoint *.angle")
    assert chart.x[[0, -1]] == pytest.approx(tn.rpm(np.array([600, 2400])))
    assert "input speed from 600 rpm to 2400 rpm, 12 points" in result.stdout


def test_chart_axes_as_written(run):
    data = parsed(
        run(
            *("stability-chart", "line.toml", "--json", "-o", "c.nc", "--unit", "Hz"),
            *("--x", "factor of Shaft *.damping:0.1:10:5:log", "--y", "speed:15:40 Hz:4"),
        )
    )
    assert data["x"] == {
        "parameter": "factor of Shaft *.damping", "unit": "1", "low": pytest.approx(0.1),
        "high": pytest.approx(10), "points": 5,
    }  # fmt: skip
    assert data["y"]["low"] == pytest.approx(15) and data["y"]["unit"] == "Hz"
    assert sum(data["counts"].values()) == 20
    assert tn.load_chart("c.nc").x == pytest.approx(np.geomspace(0.1, 10, 5))


def test_a_chart_that_touches_zero_speed_is_clipped_and_says_so(run):
    axes = ("--x", "speed:0:2400:6", "--y", "HookeJoint 1.angle:0:0.2:3")
    result = run("stability-chart", "line.toml", *axes)
    assert result.exit_code == 0, result.stderr
    assert "the speed axis starts at" in result.stdout
    assert tn.load_chart("trunnion-out/line-stability-chart.nc").x[0] > 0


@pytest.fixture
def mild(here):
    """A line that exceeds nothing, so that nothing need be sought that helps."""
    text = (here / "line.toml").read_text(encoding="utf-8")
    (here / "line.toml").write_text(text.replace('angle = "12 deg"', 'angle = "1 deg"'), encoding="utf-8")


def test_analyze_prints_and_writes(run, here, mild):
    result = run("analyze", "line.toml", *SMALL)
    assert result.exit_code == 0, result.stderr
    sections = ("Natural frequencies", "Stability at 1500 rpm", "Stability chart", "Findings", "trunnion-out")
    others = ("test line", "Resonance speeds from 600 rpm to 2400 rpm", "One turn of the joints")
    for part in (*others, *sections):
        assert part in result.stdout
    assert "rad/s" not in result.stdout.replace("rad/s²", "")  # accelerations are in no unit of speed
    written = sorted(p.name for p in (here / "trunnion-out").iterdir())
    assert written == ["line-report.html", "line-stability-chart.nc", "line-stability-chart.png"]
    page = (here / "trunnion-out" / "line-report.html").read_text(encoding="utf-8")
    assert "Stability chart over speed" in page and "was interrupted" not in page
    order = [
        result.stdout.index(part) for part in ("test line: ", "Checks from", "Findings", "Natural freq", "Written")
    ]
    assert order == sorted(order)


@pytest.mark.slow
def test_analyze_writes_one_file_where_one_is_named(run, here):
    """In a process of its own that is seen in ``test_process.py``, interrupted."""
    result = run("analyze", "line.toml", *SMALL, "-o", "page.html")
    assert result.exit_code == 0, result.stderr
    assert sorted(p.name for p in here.iterdir()) == ["line.toml", "page.html"]


@pytest.mark.slow
def test_analyze_json_and_folder(run, here, mild):
    data = parsed(run("analyze", "line.toml", *SMALL, "--json", "--output", "deep/er"))
    assert data["stability"]["speed"] == pytest.approx(1500)
    assert data["stability_chart"]["x"]["points"] == 12
    assert {f["gravity"] for f in data["findings"]} <= {"danger", "caution", "note"}
    assert len(list((here / "deep" / "er").iterdir())) == len(data["written"]) == 3


@pytest.mark.slow
def test_analyze_names_the_unstable_band_of_the_catalogue(run):
    result = run("analyze", "two-shaft-cardan", *SMALL)
    assert result.exit_code == 0, result.stderr
    assert "(subharmonic resonance ω₂)" in result.stdout
    assert "No operating speed is given" in result.stdout


def test_catalogue(run, here):
    assert "two-shaft-cardan" in run("catalogue").stdout
    assert len(parsed(run("catalogue", "--json"))["entries"]) >= 2
    text = run("catalogue", "two-shaft-cardan").stdout
    assert tn.loads(text) == tn.catalogue("two-shaft-cardan")
    assert parsed(run("catalogue", "two-shaft-cardan", "--json"))["toml"] in text
    assert "wrote kept.toml" in run("catalogue", "two-shaft-cardan", "-o", "kept.toml").stdout
    assert (here / "kept.toml").read_text(encoding="utf-8") == text


def test_new_writes_a_file_that_analyses(run, here):
    assert "two-shaft" in run("new").stdout
    assert run("new", "two-shaft").exit_code == 0
    assert parsed(run("new", "truck", "-o", "my.toml", "--json"))["written"] == "my.toml"
    assert run("natural-frequencies", "my.toml").exit_code == 0
    (here / "my.toml").write_text("old")
    assert run("new", "truck", "-o", "my.toml", "--force").exit_code == 0
    assert tn.load("my.toml").name == "light truck, one-piece propeller shaft"


def test_schema(run):
    assert parsed(run("schema"))["title"] == "Trunnion driveline"


def test_remarks_are_one_line_each_on_stderr(run, here):
    text = (here / "line.toml").read_text().replace('damping = "3 N*m*s/rad"', 'damping = "-3 N*m*s/rad"')
    (here / "line.toml").write_text(text.replace('angle = "12 deg"', 'angle = "50 deg"'))
    result = run("natural-frequencies", "line.toml", "--json")
    parsed(result)
    lines = result.stderr.splitlines()
    assert len(lines) == 3 and all(line.startswith("remark: line.toml: ") for line in lines)
