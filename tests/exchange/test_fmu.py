"""Lines as FMUs: FMPy validates them and simulates the motion that ``simulate`` has, contacts by event indicators."""

from __future__ import annotations

import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import fromstring

import feature_lines
import fmpy
import numpy as np
import pytest

import trunnion as tn
from trunnion.equations.line_system import line_system
from trunnion.errors import ComputationError, InputError

pytestmark = [
    pytest.mark.filterwarnings("ignore::trunnion.InputRemark"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.skipif(sys.platform == "win32", reason="compiles with cc"),
]
AGREES = 1e-6
"""Of the largest deviation of each coordinate, over the stated time."""
POINTS = 400
KINDS = ("ModelExchange", "CoSimulation")


def rattling(load: float = 3.0, **mesh: Any) -> tn.Driveline:
    """Teeth that leave each other behind a bent joint."""
    pair = tn.GearPair(
        teeth_in=25, teeth_out=40, module="3 mm", backlash="0.3 mm",
        **{"mesh_stiffness": "2e8 N/m", "mesh_damping": 300.0, **mesh},
    )  # fmt: skip
    wheel, pinion = tn.Disk(inertia=0.3, load_torque=load, name="wheel"), tn.Disk(inertia=0.1, name="pinion")
    before = [tn.ConstantSpeed(), tn.HookeJoint(angle="20 deg"), tn.Shaft(stiffness=2e4, damping=3.0)]
    return tn.Driveline([*before, pinion, pair, wheel], operation=tn.Operation(speed=140.0))


def two_gaps() -> tn.Driveline:
    """Two pairs with backlash in a row."""
    pair = {"module": "3 mm", "mesh_stiffness": "1e8 N/m", "mesh_damping": 500.0}
    return tn.Driveline(
        [
            tn.ConstantSpeed(), tn.HookeJoint(angle="18 deg"), tn.Shaft(stiffness=1.5e4, damping=4.0),
            tn.Disk(inertia=0.08), tn.GearPair(teeth_in=30, teeth_out=45, backlash="0.2 mm", **pair),
            tn.Disk(inertia=0.2), tn.Shaft(stiffness=4e4, damping=3.0), tn.Disk(inertia=0.05),
            tn.GearPair(teeth_in=20, teeth_out=50, backlash="0.1 mm", damping_law="in contact", **pair),
            tn.Disk(inertia=0.4, load_torque=4.0, viscous_load=0.05),
        ],
        operation=tn.Operation(speed=110.0),
    )  # fmt: skip


def clutch() -> tn.Driveline:
    """A clutch disc in stages, of which the softest does not damp."""
    stages = tn.PiecewiseShaft.symmetric([(20.0, "4 deg"), (800.0, None)], damping=2.0, damping_law="in contact")
    engine = tn.Disk(inertia=0.3, name="engine", excitation=[{"order": 2, "amplitude": 60.0}], drive_share=1.0)
    return tn.Driveline(
        [engine, stages, tn.Disk(inertia=0.05, load_torque=12.0, name="gearbox")],
        operation=tn.Operation(speed=100.0),
    )


def everything() -> tn.Driveline:
    """Free, branched, geared down and back, a tripod, loads of all kinds, torques by order and in time."""
    return tn.Driveline(
        [
            tn.Disk(inertia=2.0, name="engine", excitation=[{"order": 2, "amplitude": 90.0}], drive_share=1.0),
            tn.Shaft(stiffness=4e4, damping=8.0),
            tn.Disk(inertia=0.2, name="fork", excitation=[{"frequency": "40 Hz", "amplitude": 12.0, "phase": 0.3}]),
            tn.TripodJoint(angle="12 deg", radius="25 mm", length="0.3 m"),
            tn.Shaft(stiffness=2e4, damping=5.0), tn.Ratio(ratio=-2.5),
            tn.Disk(inertia=1.2, load_torque=80.0, viscous_load=0.2, name="pump"),
            tn.HookeJoint(angle="25 deg", plane="30 deg", after="fork"),
            tn.Shaft(stiffness=1e4, damping=2.0), tn.Disk(inertia=0.4, quadratic_load=1e-3),
        ],
        operation=tn.Operation(speed=140.0),
    )  # fmt: skip


LINES: dict[str, tuple[Callable[[], tn.Driveline], float]] = {
    "two Hooke's joints": (lambda: feature_lines.bent().but(operation=tn.Operation(speed=140.0)), 0.5),
    "backlash": (rattling, 0.3),
    "backlash and a transmission error": (
        lambda: rattling(transmission_error=[{"order": 1, "amplitude": "8 um"}], mesh_stiffness="1e8 N/m"), 0.2,
    ),
    "teeth that never pull": (lambda: rattling(damping_law="never pulling", mesh_damping=900.0), 0.15),
    "damping by depth": (lambda: rattling(mesh_damping=0.0, impact_damping=4e8), 0.15),
    "two gaps": (two_gaps, 0.1),
    "a clutch in stages": (clutch, 0.5),
    "free with everything": (everything, 0.5),
}  # fmt: skip
"""Lines, and how long [s] each moves: longer than impacts take to show, shorter than errors of 1e-10 grow to 1e-6."""
QUICK = ("backlash", "free with everything")
PARTING = (
    "backlash", "backlash and a transmission error", "teeth that never pull", "damping by depth", "a clutch in stages",
)  # fmt: skip
"""Lines that must pass from stage to stage within their time, so that event indicators are tried."""


def exported(line: tn.Driveline, folder: Path, fmi: int) -> Path:
    path = folder / f"line-{fmi}.fmu"
    assert tn.export_line(line, path, "fmu", fmi=fmi) == ()
    return path


def agrees(line: tn.Driveline, fmu: Path, duration: float, kinds: tuple[str, ...] = KINDS) -> int:
    """Deviations and torques of the FMU against ``simulate``; returns how many regimes it met."""
    made = line_system(line, float(line.operation.speed), leaves=True)  # type: ignore[union-attr]
    own = tn.simulate(made.system, duration, start=made.rest(), tolerance=1e-12)
    states = [name for name in made.system.states if name.startswith("rotation")]
    shafts = [f"torque of {name}" for name in made.shafts]
    for kind in kinds:
        step = {"step_size": duration / POINTS} if kind == "CoSimulation" else {}
        found = fmpy.simulate_fmu(
            fmu, stop_time=duration, relative_tolerance=1e-11, output_interval=duration / POINTS, fmi_type=kind,
            output=[*states, *shafts], **step,
        )  # fmt: skip
        time = np.minimum(found["time"], duration)
        assert time[-1] == pytest.approx(duration, rel=1e-9) and len(time) > POINTS
        known = own.at(time)
        for k, name in enumerate(states):
            miss = np.abs(found[name] - known[:, k]).max() / np.abs(known[:, k]).max()
            assert miss < AGREES, (kind, name, miss)
        torque = made.observe(made.system, time, known, own.regime_at(time)).torque
        for k, name in enumerate(shafts):  # a torque may jump where a contact begins: the instants before and after
            miss = np.sort(np.abs(found[name] - torque[:, k]))[: -len(time) // 20]
            assert miss[-1] < 1e-4 * np.abs(torque[:, k]).max(), (kind, name, miss[-1])
    return len(np.unique(own.regime_at(own.time)))


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("name", QUICK)
def test_the_motion_of_an_fmu_is_the_native_one(name: str, fmi: int, tmp_path: Path) -> None:
    make, duration = LINES[name]
    met = agrees(make(), exported(make(), tmp_path, fmi), duration / 3)
    assert met == (3 if name == "backlash" else 1)


@pytest.mark.slow
@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("name", LINES)
def test_eight_lines(name: str, fmi: int, tmp_path: Path) -> None:
    """Valid, the same motion in both kinds; and so when FMPy has built it from its sources."""
    from fmpy.build import build_platform_binary
    from fmpy.validation import validate_fmu

    make, duration = LINES[name]
    path = exported(make(), tmp_path, fmi)
    assert validate_fmu(path) == []
    met = agrees(make(), path, duration)
    assert met > 1 or name not in PARTING
    bare = tmp_path / "bare"
    with zipfile.ZipFile(path) as archive:
        archive.extractall(bare)
    shutil.rmtree(bare / "binaries")
    build_platform_binary(bare)
    assert validate_fmu(bare) == []
    agrees(make(), bare, duration)


@pytest.mark.parametrize("fmi", [2, 3])
def test_it_is_valid_and_builds_from_its_sources(fmi: int, tmp_path: Path) -> None:
    """FMPy finds nothing wrong; its sources compile without a warning, in C90 where headers of FMI let them."""
    from fmpy.validation import validate_fmu

    path = exported(rattling(transmission_error=[{"order": 1, "amplitude": "8 um"}]), tmp_path, fmi)
    assert validate_fmu(path) == []
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
        archive.extractall(tmp_path)
    assert any(name.startswith("binaries/") for name in names)
    standard = {2: "-std=c90", 3: "-std=c99"}[fmi]
    flags = [standard, "-pedantic", "-Wall", "-Wextra", "-Werror", "-fsyntax-only"]
    subprocess.run(["cc", *flags, "fmu.c"], cwd=tmp_path / "sources", check=True, capture_output=True, text=True)


def test_a_torque_from_outside(tmp_path: Path) -> None:
    """An input acts as a load of that size with the other sign does."""
    line = feature_lines.bent().but(operation=tn.Operation(speed=140.0))
    path = exported(line, tmp_path, 2)
    found = fmpy.simulate_fmu(
        path, stop_time=0.2, relative_tolerance=1e-10, output_interval=0.002, fmi_type="ModelExchange",
        input=np.array([(0.0, 7.0), (1.0, 7.0)], dtype=[("time", float), ("torque on load", float)]),
        output=["deviation of load", "speed of load"],
    )  # fmt: skip
    other = line.replace("load", load_torque=13.0)
    made = line_system(other, 140.0, leaves=True)
    own = tn.simulate(made.system, 0.2, start=made.rest(), tolerance=1e-12)
    place = made.system.states.index("rotation of load")
    assert np.abs(found["deviation of load"] - own.at(np.minimum(found["time"], 0.2))[:, place]).max() < 1e-8
    assert found["speed of load"].mean() == pytest.approx(140.0, rel=1e-3)


def test_a_state_is_kept_and_brought_back(tmp_path: Path) -> None:
    """Two runs from one kept state are one, contacts with it; and its bytes are such a state."""
    from fmpy.fmi2 import FMU2Slave

    path = exported(rattling(), tmp_path, 2)
    read = fmpy.read_model_description(path)
    place = fmpy.extract(path, tmp_path / "out")
    made = FMU2Slave(
        guid=read.guid, unzipDirectory=place, modelIdentifier=read.coSimulation.modelIdentifier, instanceName="one"
    )
    made.instantiate()
    made.setupExperiment(tolerance=1e-10, startTime=0.0)
    made.enterInitializationMode()
    made.exitInitializationMode()
    references = [one.valueReference for one in read.modelVariables if one.name.startswith("rotation")]

    def run(start: float) -> np.ndarray:
        rows = []
        for k in range(40):
            made.doStep(start + k * 1e-3, 1e-3)
            rows.append(made.getReal(references))
        return np.array(rows)

    run(0.0)
    kept = made.getFMUstate()
    first = run(0.04)
    made.setFMUstate(made.deSerializeFMUstate(made.serializeFMUstate(kept)))
    assert np.array_equal(run(0.04), first) and np.ptp(first) > 1e-4
    with pytest.raises(Exception, match="fmi2DoStep"):
        made.doStep(0.5, 1e-3)  # another time than the step before it ended
    with pytest.raises(Exception, match="fmi2GetReal"):
        made.getReal([10_000])
    with pytest.raises(Exception, match="fmi2SetReal"):
        made.setReal(references, [0.0] * len(references))  # a state, while it moves
    made.terminate()
    made.freeInstance()


def test_names_are_xml_and_unique(tmp_path: Path) -> None:
    names = ('a<b> & "c"', "a<b> & 'c'", "µ ]]>", "torque")
    disks = [
        one for k, name in enumerate(names) for one in (tn.Shaft(stiffness=1e4 + k), tn.Disk(inertia=1.0, name=name))
    ]
    line = tn.Driveline([tn.ConstantSpeed(), *disks], name="<7 & ünder>", operation=tn.Operation(speed=100.0))
    with zipfile.ZipFile(exported(line, tmp_path, 3)) as archive:
        root = fromstring(archive.read("modelDescription.xml"))
    variables = [one.get("name") for one in root.iter("Float64")]
    assert len(set(variables)) == len(variables) and 'torque on a<b> & "c"' in variables
    assert root.find("CoSimulation").get("modelIdentifier") == "line_7_nder"  # type: ignore[union-attr]


def test_a_line_gives_the_same_bytes_twice(tmp_path: Path) -> None:
    first = exported(rattling(), tmp_path, 2).read_bytes()
    assert exported(rattling(), tmp_path, 2).read_bytes() == first
    other = exported(rattling(load=4.0), tmp_path, 2)
    tokens = set()
    for path in (other, exported(rattling(), tmp_path, 3)):
        tokens.add(getattr(fmpy.read_model_description(path), "guid", None) or path)
    assert len(tokens) == 2


def test_without_a_compiler_the_sources_are_said_to_be_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    path = tmp_path / "line.fmu"
    lacks = tn.export_line(rattling(), path, "fmu")
    assert len(lacks) == 1 and "no C compiler was found" in lacks[0]
    with zipfile.ZipFile(path) as archive:
        assert {"modelDescription.xml", "sources/fmu.c", "sources/fmi2Functions.h"} <= set(archive.namelist())
        assert "2-Clause BSD" in archive.read("documentation/licenses/license.txt").decode() or (
            "Redistribution and use" in archive.read("documentation/licenses/license.txt").decode()
        )
        assert not [name for name in archive.namelist() if name.startswith("binaries")]


def test_a_compiler_that_fails_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    broken = tmp_path / "broken-cc"
    broken.write_text("#!/bin/sh\necho 'error: no licence' >&2\nexit 3\n")
    broken.chmod(0o755)
    monkeypatch.setenv("CC", str(broken))
    with pytest.raises(ComputationError, match="broken-cc does not compile the sources.*no licence.*in CC"):
        tn.export_line(rattling(), tmp_path / "line.fmu", "fmu")
    assert [one.name for one in tmp_path.iterdir()] == ["broken-cc"]


def friction() -> tn.Driveline:
    return tn.Driveline(
        [tn.ConstantSpeed(), tn.Clutch(stiffnesses=[800.0], friction=[{"torque": 40.0, "stiffness": 3e3}], name="disc"),
         tn.Disk(inertia=0.1)],
        operation=tn.Operation(speed=50.0),
    )  # fmt: skip


REFUSED = [
    (friction, {}, r"disc.*is not written as an FMU \(dry friction"),
    (feature_lines.bent, {}, "operation.speed: is missing"),
    (rattling, {"fmi": 1}, "fmi = 1: is not a version of FMI that is written; write 2 or 3"),
    (
        lambda: rattling().but(
            operation=tn.Operation(
                speed=140.0,
                schedules=[tn.Schedule(name="way", travel=[0.0, 0.1], angles={"HookeJoint 1": [0.0, 0.1]})],
            )
        ),
        {}, "schedule.way: cannot be written to such a file",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("make", "given", "words"), REFUSED, ids=[row[2] for row in REFUSED])
def test_what_an_fmu_does_not_hold(make: Any, given: dict[str, Any], words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words) as caught:
        tn.export_line(make(), tmp_path / "line.fmu", "fmu", **given)
    assert "; " in str(caught.value) and list(tmp_path.iterdir()) == []


def test_a_version_belongs_to_an_fmu(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="fmi = 2: belongs to an FMU; leave it out of an export to csv"):
        tn.export_line(feature_lines.bent(), tmp_path / "line.csv", "csv", fmi=2)
    with pytest.raises(InputError, match="an FMU does not say what it is made of"):
        tn.import_line(tmp_path / "line.fmu")


def example(name: str) -> tn.Driveline:
    """One that is shipped; with a schedule at its second travel, as the refusal of it says."""
    line = tn.load(Path(__file__).parents[2] / "examples" / f"{name}.toml")
    for schedule in line.operation.schedules if line.operation else ():
        line = line.at_schedule(schedule.name, schedule.travel[1])
    return line


HELD = (
    "electric-drive", "gear-stage", "harbour-tug", "pto-shaft", "rolling-mill-spindle", "six-cylinder-ship",
    "steering-column", "truck", "two-stroke-ship",
)  # fmt: skip
NOT_HELD = {
    "dumper": "converter.curves: is not written as an FMU",
    "four-wheel-drive": "front tyres: closes a loop",
    "passenger-car": "axle drive: ties one shaft to two others",
    "rolling-mill-strip": "strip: closes a loop",
    "tractor-and-baler": "overload clutch: is not written as an FMU",
}


def test_every_example_is_written_or_refused() -> None:
    shipped = {path.stem for path in (Path(__file__).parents[2] / "examples").glob("*.toml")}
    assert shipped == {*HELD, *NOT_HELD}


@pytest.mark.slow
@pytest.mark.parametrize("name", HELD)
def test_examples_move_as_they_do_here(name: str, tmp_path: Path) -> None:
    """Over a turn of the input."""
    line, path = example(name), tmp_path / "line.fmu"
    tn.export_line(line, path, "fmu")
    agrees(line, path, 2 * np.pi / float(line.operation.speed), ("ModelExchange",))  # type: ignore[union-attr]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "words"), NOT_HELD.items())
def test_examples_that_an_fmu_does_not_hold(name: str, words: str, tmp_path: Path) -> None:
    with pytest.raises((InputError, ComputationError)) as caught:
        tn.export_line(example(name), tmp_path / "line.fmu", "fmu")
    assert str(caught.value).startswith(words), str(caught.value)
