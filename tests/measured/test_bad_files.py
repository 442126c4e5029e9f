"""What users get wrong about measured data, at the command line: one line, exit code 2, and every file as it was."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from edges import write_edges
from scipy.io import savemat, wavfile
from typer.testing import CliRunner

import trunnion as tn
from trunnion.cli.program import app

TIME = np.arange(0, 2, 1e-3)
ROTATION = 100 * TIME + 20 * TIME**2
PULSES = (np.sin(12 * ROTATION) > 0).astype(float)
TORQUE = 30 + 5 * np.sin(2 * ROTATION)
WHEEL = '[[channel]]\ncolumn = "p"\nname = "input"\nkind = "pulses"\npulses_per_turn = 12\nat = "input"\n'
GAUGE = '[[channel]]\ncolumn = "g"\nname = "gauge"\nkind = "torque"\nunit = "N*m"\nat = "tube"\n'
DESCRIBED = f'time = "t"\n{WHEEL}{GAUGE}'
STIFFNESS = "tube.stiffness:10 kN*m/rad:40 kN*m/rad"


def bench() -> tn.Driveline:
    return tn.Driveline(
        [
            tn.ConstantSpeed(name="input"),
            tn.HookeJoint(angle="12 deg", name="joint"),
            tn.Shaft(stiffness=2e4, damping=25, name="tube"),
            tn.Disk(inertia=0.5, name="hub"),
        ],
        operation=tn.Operation(speed="1500 rpm"),
    )


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a line, a run-up of edges, and one of sampled signals with its description."""
    folder = tmp_path_factory.mktemp("recorded")
    tn.dump(bench(), folder / "line.toml")
    run = tn.measure(bench(), ("900 rpm", "1800 rpm"), 3.0, {"input": 30, "hub": 30}, jitter=1e-7, pitch_error=0.0)
    write_edges(run, folder / "run.csv")
    sampled(folder)
    return folder


def sampled(folder: Path, described: str = DESCRIBED, **columns: np.ndarray) -> None:
    """``volts.csv`` with some columns in place of the sound ones; a column of None is left out."""
    every = {"t": TIME, "p": PULSES, "g": TORQUE} | columns
    every = {key: values for key, values in every.items() if values is not None}
    rows = np.column_stack(list(every.values()))
    np.savetxt(folder / "volts.csv", rows, delimiter=",", header=",".join(every), comments="", fmt="%.9g")
    (folder / "volts.channels.toml").write_text(described, encoding="utf-8")


def with_one(values: np.ndarray, at: int, one: float) -> np.ndarray:
    found = values.copy()
    found[at] = one
    return found


def written(name: str, content: bytes) -> Callable[[Path], None]:
    def spoil(folder: Path) -> None:
        (folder / name).write_bytes(content)
        (folder / name).with_suffix(".channels.toml").write_text(f"rate = 1000\n{WHEEL}{GAUGE}", encoding="utf-8")

    return spoil


def cut_off(name: str, bytes_left: int) -> Callable[[Path], None]:
    """A sound file of the kind, of which so much is there."""

    def spoil(folder: Path) -> None:
        whole = folder / f"whole{Path(name).suffix}"
        if name.endswith(".mat"):
            savemat(whole, {"p": PULSES, "g": TORQUE})
        elif name.endswith(".wav"):
            wavfile.write(whole, 1000, (1000 * PULSES).astype(np.int16))
        else:
            with h5py.File(whole, "w") as stream:
                stream["p"], stream["g"] = PULSES, TORQUE
        written(name, whole.read_bytes()[:bytes_left])(folder)
        whole.unlink()

    return spoil


def described(*changes: tuple[str, str]) -> Callable[[Path], None]:
    """The description with words of it exchanged."""

    def spoil(folder: Path) -> None:
        text = DESCRIBED
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        sampled(folder, text)

    return spoil


def steps_that_change(folder: Path) -> None:
    sampled(folder, t=TIME + 1e-5 * TIME**2 / 1e-3)


def cut_in_a_row(folder: Path) -> None:
    table = folder / "volts.csv"
    table.write_text(table.read_text().rpartition(",")[0])


def without_rows(folder: Path) -> None:
    (folder / "volts.csv").write_text("t,p,g\n")


def latin(folder: Path) -> None:
    (folder / "volts.csv").write_bytes((folder / "volts.csv").read_bytes().replace(b"t,p,g", b"t,p,g\xfc"))


VOLTS = ["track-orders", "volts.csv", "--line", "line.toml", "--orders", "2"]
FILES: dict[str, tuple[Callable[[Path], None], str, str]] = {
    "samples that are not numbers": (lambda f: sampled(f, g=with_one(TORQUE, 500, np.nan)), "", "gauge.values: has no"),
    "a gap": (lambda f: sampled(f, t=TIME + 0.3 * (TIME > 1)), "", "t = 1: has steps that are not equal"),
    "steps that change": (steps_that_change, "", "t: has steps that change: equal ones are"),
    "a missing column": (lambda f: sampled(f, g=None), "", "gauge.column = 'g': is not a column of the file; known"),
    "no pulses": (lambda f: sampled(f, p=0 * PULSES), "", "input.column: does not move: there are no pulses"),
    "a wrong unit": (described(('"N*m"', '"kN"')), "", "channel 2.unit = '1 kN': kN is not the unit of a torque"),
    "no teeth": (described(("= 12", "= 0")), "", "channel 1.pulses_per_turn = 0: must be a whole number, 1 or more"),
    "half a tooth": (described(("= 12", "= 2.5")), "", "channel 1.pulses_per_turn = 2.5: must be a whole number"),
    "a place that is not there": (described(('at = "input"', 'at = "inptu"')), "", 'mean "input"?'),
    "a name twice": (described(('"gauge"', '"input"')), "", "measurement.name = 'input': is the name of two channels"),
    "an unknown key": (described(("kind = \"torque\"", "knd = \"torque\"")), "", 'did you mean "kind"?'),
    "a description cut off": (described((GAUGE, '[[channel]]\ncolumn = "')), "", "channels = 'volts"),
    "no description": (lambda f: (f / "volts.channels.toml").unlink(), "", "write volts.channels.toml beside it"),
    "letters that are not UTF-8": (latin, "", "data = 'volts.csv': cannot be read (it is not text)"),
    "a table without rows": (without_rows, "", "t: holds no samples; record again"),
    "an empty table": (lambda f: (f / "volts.csv").write_text(""), "", "cannot be read (it is empty)"),
    "a row cut off": (cut_in_a_row, "", "volts.csv line 2001.g = '': is not a number"),
    "a folder": (lambda f: (f / "run").mkdir(), "run", "data = 'run': is not a file of signals"),
    "a folder called as a table": (lambda f: (f / "a.csv").mkdir(), "a.csv", "data = 'a.csv': is a folder"),
    "no file": (lambda f: None, "none.wav", "data = 'none.wav': is not there"),
    "a MAT file cut off": (cut_off("a.mat", 9000), "a.mat", "data = 'a.mat': cannot be read ("),
    "the head of a MAT file": (cut_off("a.mat", 100), "a.mat", "data = 'a.mat': cannot be read ("),
    "an HDF5 file cut off": (cut_off("a.h5", 9000), "a.h5", "data = 'a.h5': cannot be read ("),
    "a WAV file cut off": (cut_off("a.wav", 2000), "a.wav", "data = 'a.wav': cannot be read ("),
    "the head of a WAV file": (cut_off("a.wav", 20), "a.wav", "data = 'a.wav': cannot be read ("),
    **{
        f"{what} {ending} file": (written(f"a.{ending}", content), f"a.{ending}", f"'a.{ending}': cannot be read (")
        for ending in ("wav", "mat", "h5", "tdms", "uff")
        for what, content in (("an empty", b""), ("no", b"hello, these are no signals " * 9))
    },
}  # fmt: skip
"""How the files are spoilt, the file asked about where it is another, and what is said."""
RUN = ["run.csv", "--line", "line.toml", "--orders", "2"]
TRACK, IDENTIFY = ["track-orders", *RUN], ["identify", *RUN, "--free", STIFFNESS]
OPTIONS: tuple[tuple[list[str], str], ...] = (
    ([*TRACK, "--orders", "0"], "orders = [0.0]: must be positive"),
    ([*TRACK, "--orders", "nan"], "orders = [nan]: must be positive"),
    ([*TRACK, "--orders", "99"], "orders = 99: is not seen by input: 30 pulses a turn show orders below 15"),
    ([*TRACK, "--between", "3:1"], "between = [3.0, 1.0]: is outside the recording"),
    ([*TRACK, "--between", "50:60"], "between = [50.0, 60.0]: is outside the recording"),
    ([*TRACK, "--window", "0"], "'--window'"),
    ([*TRACK, "--window", "999"], "input.window = 999: has no window of 999 turns that tells 1 order apart"),
    ([*TRACK, "--calibration", "none.csv"], "data = 'none.csv': is not there"),
    ([*TRACK, "--calibration", "volts.csv"], "input.pulses_per_turn = 30: is not the 12 of the reference run"),
    ([*TRACK, "--channels", "line.toml"], "line.toml.format = 1: unknown key"),
    ([*TRACK, "--line", "none.toml"], "none.toml: file not found"),
    ([*TRACK, "-o", "run.csv"], "--output = 'run.csv': is a file that this command reads; write to another file"),
    (
        [*TRACK, "--calibration", "volts.csv", "-o", "./volts.csv"],
        "--output = 'volts.csv': is a file that this command reads",
    ),
    ([*TRACK, "-o", "none/a.png"], "--output = 'none/a.png': lies in no folder"),
    ([*TRACK, "-o", "line.toml"], "--output = 'line.toml': has no ending that names a format"),
    ([*IDENTIFY, "-o", "../recorded/run.csv"], "run.csv': is a file that this command reads"),
    ([*IDENTIFY, "--write", "run.csv"], "--write = 'run.csv': does not end in .toml; write run.toml"),
    ([*IDENTIFY, "--write", "run.channels.toml"], "--write = 'run.channels.toml': is a file that this command reads"),
    ([*IDENTIFY, "--write", "none/a.toml"], "--write = 'none/a.toml': lies in no folder"),
    ([*IDENTIFY, "--free", STIFFNESS], "--free = 'tube.stiffness': is named twice"),
    ([*IDENTIFY, "--free", "tube.damping:9 N*m*s/rad:3 N*m*s/rad"], "must be rising bounds"),
    ([*IDENTIFY, "--free", "tube.damping:9 N*m:30 N*m"], "N*m is not the unit of a damping"),
    ([*IDENTIFY, "--free", "tube.dampng:9:30"], 'did you mean "tube.damping"?'),
    ([*IDENTIFY, "--draws", "-1"], "'--draws'"),
    ([*IDENTIFY, "--tongue-at", "0"], "--tongue-at = '0': must be positive"),
    ([*IDENTIFY, "--tongue-at", "fast"], "--tongue-at = 'fast'"),
    (["compare-measured", *RUN, "--report", "a.pdf"], "--report = 'a.pdf': does not end in .html; write a.html"),
    (["compare-measured", *RUN, "--over", "x"], "--over = 'x': is not a picture; known: response, campbell, run-up"),
    (["export", "none.toml", "--to", "c", "-o", "a.c"], "none.toml: file not found"),
    (["export", "run.csv", "--to", "c", "-o", "a.c"], "run.csv"),
    (["export", "line.toml", "--to", "c", "-o", "none/a.c"], "output = 'none/a.c': cannot be written"),
    (["export", "line.toml", "--to", "csv", "-o", "a.csv"], "joint.angle = 0.20944: is bent"),
    (["export", "line.toml", "--to", "simulink", "-o", "a.mdl"], "to = 'simulink': is not a target"),
    (["import", "run.csv"], "run.csv: does not begin with the columns of a line"),
    (["import", "line.toml"], "line.toml: cannot be imported"),
    (["import", "none.mo"], "none.mo: file not found"),
)


def files_of(folder: Path) -> dict[str, bytes | None]:
    every = (one for one in folder.rglob("*") if one.name != "trunnion-out")
    return {str(one.relative_to(folder)): one.read_bytes() if one.is_file() else None for one in every}


def refused(words: list[str], said: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    before = files_of(folder)
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 2 and not done.stdout, done.output
    (line,) = done.stderr.splitlines()
    assert line.startswith("error: ") and said in line, line
    assert files_of(folder) == before


@pytest.mark.parametrize("what", FILES)
def test_files_that_are_not_as_they_should_be(
    what: str, recorded: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    spoil, data, said = FILES[what]
    folder = tmp_path / "recorded"
    shutil.copytree(recorded, folder)
    spoil(folder)
    words = [VOLTS[0], data, *VOLTS[2:]] if data else VOLTS
    refused(words, said, folder, monkeypatch)


@pytest.mark.parametrize(("words", "said"), OPTIONS, ids=[" ".join(words[-2:]) for words, _ in OPTIONS])
def test_options_that_cannot_be(
    words: list[str], said: str, recorded: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "recorded"
    shutil.copytree(recorded, folder)
    refused(words, said, folder, monkeypatch)


def test_draws_at_the_command_line(recorded: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A sign that rotations do not show is drawn both ways."""
    folder = tmp_path / "recorded"
    shutil.copytree(recorded, folder)
    monkeypatch.chdir(folder)
    words = ["identify", *RUN, "--window", "24", "--free", "joint.angle:-20 deg:20 deg", "-o", "fit.csv"]
    done = CliRunner().invoke(app, [*words, "--draws", "3", "--json"])
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    assert found["independent"] > 1 and found["drawn_low"][0] < 0 < found["drawn_high"][0]
    size = abs(found["value"][0])
    width = found["high"][0] - found["low"][0]
    assert abs(found["drawn_low"][0] + size) < 3 * width and abs(found["drawn_high"][0] - size) < 3 * width
    assert any("fit as well as the best" in one["sentence"] for one in found["findings"])
