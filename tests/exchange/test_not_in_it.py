"""What a file for another program leaves out is named, and no file that a line is read from is written over."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

import trunnion as tn
from trunnion.cli.program import app
from trunnion.driveline.features import RATINGS
from trunnion.driveline.operation import Operation

EXAMPLES = Path(__file__).parents[2] / "examples"
TARGETS = {"csv": "line.csv", "modelica": "line.mo", "matlab": "line.mat", "c": "line.c"}


def line(**operation: object) -> tn.Driveline:
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Coupling(stiffness=2e4, damping=3.0, maximum_torque="2 kN*m", name="coupling"),
            tn.Disk(inertia=0.5),
        ],
        operation=tn.Operation(speed="1500 rpm", **operation),
    )


def plain(**operation: object) -> tn.Driveline:
    spring, disk = tn.Shaft(stiffness=2e4), tn.Disk(inertia=0.5)
    return tn.Driveline([tn.ConstantSpeed(), spring, disk], operation=tn.Operation(speed=150.0, **operation))


@pytest.mark.parametrize(("to", "name"), TARGETS.items())
def test_ratings_duty_passages_and_the_speed_range_are_named(tmp_path: Path, to: str, name: str) -> None:
    duty = [tn.Duty(share=1.0, speed="1500 rpm")]
    up = tn.SpeedPassage(name="start", first="600 rpm", last="1500 rpm", acceleration="20 rad/s^2", per_hour=2)
    whole = line(speed_range=("600 rpm", "1800 rpm"), life="1000 h", duty=duty, passages=[up])
    assert tn.export_line(whole, tmp_path / name, to) == (
        "ratings", "the speed range", "the operating time", "duty", "passages",
    )  # fmt: skip
    assert tn.export_line(plain(), tmp_path / name, to) == ()


def test_every_field_beside_the_equations_is_written_or_named(tmp_path: Path) -> None:
    """Of the operation all but the speed and its unit; of elements each rating."""
    said = {
        "speed_range": ("the speed range", ("600 rpm", "1800 rpm")),
        "angle_range": ("the angle range", ("0 deg", "10 deg")),
        "application": ("the application", "industrial"),
        "switched_off": ("rules switched off", [{"rule": "equal-angles", "reason": "no joints"}]),
        "misfiring": ("cylinders out of work", True),
        "cut_out": ("cylinders out of work", True),
        "load_cases": ("load cases", [{"name": "idle", "loads": {"Disk 1": 1.0}}]),
        "life": ("the operating time", "1000 h"),
        "duty": ("duty", [{"share": 1.0, "speed": "1500 rpm"}]),
        "passages": (
            "passages",
            [{"name": "up", "first": "600 rpm", "last": "900 rpm", "acceleration": 2.0, "per_hour": 1}],
        ),
    }
    # A schedule is refused: a file holds one line.
    assert set(said) == set(Operation.model_fields) - {"speed", "speed_unit", "schedules"}
    for key, (words, value) in said.items():
        assert tn.export_line(plain(**{key: value}), tmp_path / "line.csv", "csv") == (words,), key
    rated = {
        "Shaft": tn.Shaft(stiffness=2e4, tensile_strength="700 MPa"),
        "Coupling": tn.Coupling(stiffness=2e4, damping=3.0, highest_temperature="90 degC"),
    }
    for kind, element in rated.items():
        assert any(one.startswith(f"{kind}.") for one in RATINGS)
        made = tn.Driveline([tn.ConstantSpeed(), element, tn.Disk(inertia=0.5)], operation=tn.Operation(speed=150.0))
        assert tn.export_line(made, tmp_path / "line.csv", "csv") == ("ratings",)


def test_the_command_names_what_is_not_in_the_file(tmp_path: Path) -> None:
    tn.dump(line(speed_range=("600 rpm", "1800 rpm")), tmp_path / "line.toml")
    done = CliRunner().invoke(
        app, ["export", str(tmp_path / "line.toml"), "--to", "csv", "-o", str(tmp_path / "a.csv")]
    )
    assert done.exit_code == 0 and done.output.splitlines()[-1] == "Not in it: ratings, the speed range."


@pytest.mark.parametrize("command", ["export", "order-response"])
def test_a_table_that_the_line_names_is_not_written_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("six-cylinder-ship.toml", "six-cylinder-ship.csv"):
        shutil.copy(EXAMPLES / name, tmp_path)
    table = tmp_path / "six-cylinder-ship.csv"
    before = table.read_bytes()
    to = ["--to", "csv"] if command == "export" else []
    done = CliRunner().invoke(app, [command, "six-cylinder-ship.toml", *to, "-o", table.name])
    assert done.exit_code == 2 and table.read_bytes() == before
    assert " ".join(done.output.split()) == (
        "error: --output = 'six-cylinder-ship.csv': is a file that six-cylinder-ship.toml reads; write to another file"
    )


def test_tables_of_sheets_are_found_too(tmp_path: Path) -> None:
    """A sheet in the folder of components that names a table of its own, and names that go around."""
    from trunnion.cli.files import check_not_read

    (tmp_path / "line.toml").write_text('sheet = "sheet.toml"\n[[element]]\nkind = "Disk"\n', encoding="utf-8")
    (tmp_path / "sheet.toml").write_text('back = "line.toml"\n[x]\ntable = ["deep.csv"]\n', encoding="utf-8")
    for name in ("deep.csv", "other.csv"):
        (tmp_path / name).write_text("1\n", encoding="utf-8")
    check_not_read([tmp_path / "other.csv"], [str(tmp_path / "line.toml")])
    with pytest.raises(tn.InputError, match=r"is a file that line\.toml reads; write to another file"):
        check_not_read([tmp_path / "deep.csv"], [str(tmp_path / "line.toml")])
