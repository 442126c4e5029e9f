"""Lines as ANSI C: compiled without a warning, the function gives our rates at random states and times."""

from __future__ import annotations

import ctypes
import subprocess
import sys
from pathlib import Path
from typing import Any

import feature_lines
import numpy as np
import pytest

import trunnion as tn
from trunnion.equations.line_system import line_system
from trunnion.errors import InputError
from trunnion.exchange.c_source import NOT_IN_C

pytestmark = [
    pytest.mark.filterwarnings("ignore::trunnion.InputRemark"),
    pytest.mark.skipif(sys.platform == "win32", reason="compiles with cc"),
]
SPEED = 140.0
STATES = 20
Rate = Any


def stated(line: tn.Driveline) -> tn.Driveline:
    """The same with an operating speed."""
    operation = line.operation or tn.Operation()
    return line.but(operation=operation.but(speed=SPEED))


def compiled(source: Path) -> Rate:
    """The function of a file, under a compiler that takes ANSI C alone and no warnings."""
    library = source.with_suffix(".so")
    flags = ["-std=c90", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "-ffp-contract=off", "-shared", "-fPIC"]
    subprocess.run(["cc", *flags, "-o", str(library), str(source), "-lm"], check=True, capture_output=True, text=True)
    rate = ctypes.CDLL(str(library)).line_rate
    array = np.ctypeslib.ndpointer(dtype=float, flags="C_CONTIGUOUS")
    rate.argtypes, rate.restype = [ctypes.c_double, array, array], ctypes.c_int
    return rate


def agrees(line: tn.Driveline, folder: Path, seed: int = 0, speed: float = SPEED) -> int:
    """Rates at random states, of sizes from a thousandth of a degree to some degrees, within 1e-13 of the largest term
    of each; returns how many stages were met."""
    path = folder / "line.c"
    tn.export_line(line, path, "c")
    rate, system = compiled(path), line_system(line, speed, leaves=True).system
    rng, met = np.random.default_rng(seed), set()
    n, size = system.size, system.size // 2
    assert n == 2 * size
    for k in range(STATES):
        reach = 10.0 ** rng.uniform(-4.0, -1.0)
        state = np.concatenate([reach * rng.normal(size=size), 0.3 * reach * speed * rng.normal(size=size)])
        time = float(rng.uniform(0.0, 1.0))
        regime = system.regimes.at(time, state, system.parameters, system.numbers) if system.regimes else 0
        met.add(regime)
        own, found = system.rate_at(time, state, regime), np.full(n, np.nan)
        assert rate(time, state, found) == 0
        # Rounding of a sum is that of its terms: the stiffest springs give the size of each row.
        terms = np.abs(own).max() + np.abs(system.jacobian(time, state, regime)) @ np.abs(state)
        assert np.all(np.abs(found - own) <= 1e-13 * terms), (k, np.abs(found - own) / terms)
        assert np.any(own[size:] != 0)
    return len(met)


@pytest.mark.parametrize("key", feature_lines.CHANGES)
def test_every_feature(key: str, tmp_path: Path) -> None:
    """Of a line with two Hooke's joints; what is refused is so by name."""
    line = stated(feature_lines.CHANGES[key][1](feature_lines.bent()))
    try:
        agrees(line, tmp_path)
    except InputError as refused:
        assert not (tmp_path / "line.c").exists()
        assert key in NOT_IN_C or key in REFUSED, str(refused)
        assert "; " in str(refused)
        return
    assert key not in NOT_IN_C and key not in REFUSED


REFUSED = (
    "closed loop", "shafts tied to two others", "elastic teeth of planets", "prescribed far end",
)  # fmt: skip
"""What the nonlinear equations refuse of themselves: see ``test_features``."""


def test_backlash_in_all_its_stages(tmp_path: Path) -> None:
    """Teeth in contact on either side, and in the gap; the error and the stiffness of the mesh vary."""
    pair = tn.GearPair(
        teeth_in=25, teeth_out=40, module="3 mm", mesh_stiffness="2e8 N/m", mesh_damping=300.0, backlash="0.3 mm",
        transmission_error=[{"order": 1, "amplitude": "8 um"}],
    )  # fmt: skip
    gear, pinion = tn.Disk(inertia=0.3, load_torque=30.0), tn.Disk(inertia=0.1, name="pinion")
    line = tn.Driveline(
        [tn.ConstantSpeed(), tn.HookeJoint(angle="20 deg"), tn.Shaft(stiffness=2e4, damping=3.0), pinion, pair, gear],
        operation=tn.Operation(speed=SPEED),
    )
    assert agrees(line, tmp_path) == 3


def test_a_free_line_with_everything(tmp_path: Path) -> None:
    """Branched behind a joint, geared down and back, loads of all kinds, excitations by order and in time."""
    line = tn.Driveline(
        [
            tn.Disk(inertia=2.0, name="engine", excitation=[{"order": 2, "amplitude": 90.0}], drive_share=1.0),
            tn.Shaft(stiffness=4e4, damping=8.0),
            tn.Disk(inertia=0.2, name="fork", excitation=[{"frequency": "40 Hz", "amplitude": 12.0, "phase": 0.3}]),
            tn.TripodJoint(angle="12 deg", radius="25 mm", length="0.3 m"),
            tn.Shaft(stiffness=2e4, damping=5.0),
            tn.Ratio(ratio=-2.5),
            tn.Disk(inertia=1.2, load_torque=80.0, viscous_load=0.2, name="pump"),
            tn.HookeJoint(angle="25 deg", plane="30 deg", after="fork"),
            tn.Shaft(stiffness=1e4, damping=2.0),
            tn.Disk(inertia=0.4, quadratic_load=1e-3),
        ],
        operation=tn.Operation(speed=SPEED),
    )
    agrees(line, tmp_path)


def test_a_motion_of_the_compiled_function(tmp_path: Path) -> None:
    """Integrated by SciPy it follows ``simulate`` of the line, another integrator on other code."""
    from scipy.integrate import solve_ivp

    line = stated(feature_lines.bent())
    path = tmp_path / "line.c"
    tn.export_line(line, path, "c")
    rate = compiled(path)

    def slope(t: float, x: np.ndarray) -> np.ndarray:
        out = np.empty_like(x)
        rate(t, np.ascontiguousarray(x), out)
        return out

    system = line_system(line, SPEED, leaves=True)
    start = system.rest()
    span = 0.2
    found = solve_ivp(slope, (0.0, span), start, method="DOP853", rtol=1e-12, atol=1e-13)
    own = tn.simulate(system.system, span, start=start, tolerance=1e-12)
    assert np.abs(found.y[:, -1] - own.at(np.array([span]))[0])[: len(start) // 2].max() < 1e-9


EXAMPLES = (
    "electric-drive",
    "gear-stage",
    "harbour-tug",
    "rolling-mill-spindle",
    "six-cylinder-ship",
    "steering-column",
)


@pytest.mark.slow
@pytest.mark.parametrize("name", EXAMPLES)
def test_examples(name: str, tmp_path: Path) -> None:
    line = tn.load(Path(__file__).parents[2] / "examples" / f"{name}.toml")
    agrees(line, tmp_path, speed=float(line.operation.speed))  # type: ignore[union-attr]


def test_names_cannot_leave_their_comment(tmp_path: Path) -> None:
    names = ("a\\", "??/", 'µ "x"', "/ %s")
    disks = [
        one for k, name in enumerate(names) for one in (tn.Shaft(stiffness=1e4 + k), tn.Disk(inertia=1.0, name=name))
    ]
    line = tn.Driveline([tn.ConstantSpeed(), *disks], name="??/ \\", operation=tn.Operation(speed=SPEED))
    agrees(line, tmp_path)


def test_without_a_speed_it_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="operation.speed: is missing"):
        tn.export_line(feature_lines.bent(), tmp_path / "line.c", "c")
    with pytest.raises(InputError, match="a function in C does not say what it is made of"):
        tn.import_line(tmp_path / "line.c")


def test_a_schedule_is_no_single_line(tmp_path: Path) -> None:
    """Its angles move with the travel: the numbers as they stand would be written without a word."""
    schedule = tn.Schedule(name="travel", travel=[0.0, 0.1], angles={"joint 2": [0.1, 0.4]})
    line = feature_lines.bent().but(operation=tn.Operation(speed=SPEED, schedules=[schedule]))
    with pytest.raises(
        InputError,
        match="schedule.travel: cannot be written to such a file; write the angles of one travel at the joints",
    ):
        tn.export_line(line, tmp_path / "line.c", "c")
