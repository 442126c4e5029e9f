"""The command ``warm-up``: compile ahead of time what the first chart and the first report would compile."""

from __future__ import annotations

import os
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.errors import ComputationError, InputError

POLL = 0.1
"""Seconds between looks at the processes."""


def warm_up(
    processes: Annotated[
        int | None, typer.Option("--processes", min=1, help="How many compile side by side; default: one per core.")
    ] = None,
    check: Annotated[
        bool,
        typer.Option("--check", help="Compile nothing: say what is kept; exit code 2 if damaged or none."),
    ] = False,
    part: Annotated[str | None, typer.Option("--part", hidden=True)] = None,
) -> None:
    """Compile ahead of time, so that no first chart or report waits for it; what is there already is kept."""
    if check:
        from trunnion.cli.kept import say_what_is_kept

        say_what_is_kept()
        return
    if part is not None:
        from trunnion.floquet.charts.cost_model import compile_at_once

        compile_at_once()
        PARTS[part]()
        return
    folder = _folder()
    begin = time.monotonic()
    output.note(f"compiling into {folder}")
    _side_by_side(list(PARTS), processes or os.cpu_count() or 1)
    output.say(f"ready after {time.monotonic() - begin:.0f} s: {folder}")


def _folder() -> Path:
    """Where machine code is kept.

    Raises
    ------
    InputError : it cannot be written.
    """
    from trunnion.numerics.cache_folder import cache_folder
    from trunnion.numerics.sources import SOURCES, digest_of

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the error says it
        folder = cache_folder(f"package-{digest_of(SOURCES)}")
    if folder is None:
        problem = "cannot be written, so that nothing compiled would be kept"
        raise InputError(problem, element="cache folder", remedy="set TRUNNION_CACHE to a folder of yours")
    return folder.parent


def _side_by_side(names: list[str], processes: int) -> None:
    """Each part in a process of its own; on Ctrl-C all are ended, and what they have written stays whole.

    Raises
    ------
    ComputationError : a part fails.
    """
    waiting, running, done = names[::-1], dict[str, subprocess.Popen[str]](), 0
    try:
        while waiting or running:
            while waiting and len(running) < processes:
                name = waiting.pop()
                command = [sys.executable, "-m", "trunnion", "warm-up", "--part", name]
                running[name] = subprocess.Popen(
                    command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, encoding="utf-8"
                )
            for name in [n for n, process in running.items() if process.poll() is not None]:
                process = running.pop(name)
                said = process.communicate()[1].strip().splitlines()
                if process.returncode:
                    raise ComputationError(f"compiling {name} failed: {said[-1] if said else process.returncode}")
                done += 1
                output.note(f"  {done} of {len(names)}: {name}")
            time.sleep(POLL)
    finally:
        for process in running.values():
            process.terminate()
        for process in running.values():
            process.communicate()


def _charts_of_plain_lines() -> None:
    line = tn.catalogue("two-shaft-cardan")
    tn.stability_chart(line, ("speed", 0.02, 2.0, 200), ("HookeJoint 1.angle", 0.0, 1.2, 120), tolerance=1e-8)


def _charts_of_loaded_lines() -> None:
    elements: list[Any] = [tn.ConstantSpeed()]
    for i in range(4):
        elements += [tn.HookeJoint(angle=0.2)] if i else []
        elements += [tn.Shaft(stiffness=1.0, damping=0.01), tn.Disk(inertia=1.0, load_torque=0.01)]
    tn.stability_chart(tn.Driveline(elements), ("speed", 0.5, 2.0, 24), ("HookeJoint *.angle", 0.0, 0.3, 16))


def _reports() -> None:
    from trunnion.driveline.starter import starter

    tn.report(tn.loads(starter("two-shaft")))


def _long_lines() -> None:
    elements: list[Any] = [tn.ConstantSpeed()]
    for i in range(40):
        elements += [tn.HookeJoint(angle=0.2)] if i == 20 else []
        elements += [tn.Shaft(stiffness=1.0, damping=0.01), tn.Disk(inertia=1.0)]
    tn.stability(tn.Driveline(elements), 0.5)


def _motions_with_stages() -> None:
    elements = [
        tn.ConstantSpeed(), tn.Shaft(stiffness=1.0, damping=0.1), tn.Disk(inertia=1.0), tn.HookeJoint(angle=0.2),
        tn.PiecewiseShaft(breakpoints=(-0.01, 0.01), stiffnesses=(1.0, 0.1, 1.0), damping=0.1), tn.Disk(inertia=1.0),
    ]  # fmt: skip
    tn.simulate(tn.Driveline(elements), turns=1, speed=1.0)


def _transients() -> None:
    """With what is watched, with formulas, and with clutches that slip; a passage; a pendulum that swings."""
    clutch = tn.SlipClutch(name="clutch", torque=5.0)
    ends = tn.Disk(name="motor", inertia=1.0), tn.Disk(name="load", inertia=1.0)
    shaft = tn.Shaft(stiffness=100.0, damping=0.1)
    push = tn.AppliedTorque(on="motor", formula="2*max(t, 0.01)")
    level = tn.LevelCrossing(of="motor", speed=1e3)
    for elements in ([ends[0], shaft, ends[1]], [ends[0], clutch, tn.Disk(inertia=1.0), shaft, ends[1]]):
        tn.transient(tn.Driveline(elements), 0.02, torque=[push], crossing=[level], speed=1.0)
    even = tn.AppliedTorque(on="motor", time=[0], torque=[5.0], between="steps")
    plain, over = tn.Driveline([ends[0], shaft, ends[1]]), ("load.inertia", 1.0, 1.1, 2)
    tn.capture_map(plain, (10.0, 11.0), over, ("factor", 1.0, 1.1, 2), torque=[even], phases=1)
    pendulum = tn.CentrifugalPendulum(mass=0.1, radius=0.1, order=2.0)
    tn.simulate(tn.Driveline([tn.ConstantSpeed(), shaft, ends[0], pendulum]), turns=1, speed=1.0)


PARTS: dict[str, Callable[[], None]] = {
    "charts of plain lines": _charts_of_plain_lines,
    "charts of loaded lines": _charts_of_loaded_lines,
    "reports and motions": _reports,
    "long lines": _long_lines,
    "motions with stages": _motions_with_stages,
    "transients": _transients,
}
"""What is compiled, each in a process of its own."""
