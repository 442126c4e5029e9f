"""The commands about limits: tongues, stable windows, minimum damping, tolerances and proofs."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Any

import trunnion as tn
from trunnion.cli.command_input import CommandInput, InputAttribute, NumberBounds, OptionReader
from trunnion.cli.options import AboutSteadyState, Line, Progress, Speed, SpeedRange, SpeedUnit
from trunnion.cli.places import PICTURES_AND_DATA, CommandOutput
from trunnion.cli.readers import file_of_line, place_of_line, read_box_range, read_speed
from trunnion.cli.typed import Command
from trunnion.errors import InputError

TOLERANCE_EXAMPLE = '--tolerance "Shaft 1.stiffness=10%", or "=normal 3%"'
Box = tuple[tuple[str, float, float], int]
"""A range of a parameter, and rows of the search over it."""


def _damping(asked: CommandInput, text: str, key: str) -> str:
    tn.pack(asked.line).resolve(text)
    return text


def _tolerance(asked: CommandInput, text: str, key: str) -> tuple[str, object]:
    """``PARAMETER=10%``, ``PARAMETER=10 %``, ``PARAMETER=0.1`` or ``PARAMETER=normal 3%``."""
    path, equals, given = text.rpartition("=")
    given = re.sub(r"\s+%", "%", given.strip())  # files write "10 %"
    kind, _, number = given.rpartition(" ")
    try:
        share = float(number.removesuffix("%")) / (100 if number.endswith("%") else 1)
    except ValueError:
        share = 0.0
    if not equals or not path or kind not in ("", "normal") or not 0 < share < 1:
        raise InputError("is not a tolerance", key=key, value=text, remedy=TOLERANCE_EXAMPLE)
    return path.strip(), ("normal", share) if kind else share


def _operating(asked: CommandInput, text: str | None = None, key: str = "") -> float:
    """A speed at which the line can run [rad/s], by default that of the file."""
    from trunnion.driveline.operating_speed import operating_speed

    return operating_speed(asked.line, None if text is None else read_speed(asked, text, key))


Tolerances = Annotated[list[Any] | None, OptionReader(_tolerance, several=True)]


@Command("tongues")
def tongues(
    line: Line,
    *,
    x: Annotated[Box, OptionReader(read_box_range, "speed")],
    y: Annotated[Box, OptionReader(read_box_range, "HookeJoint *.angle")],
    speed: Speed,
    about_steady_state: AboutSteadyState = False,
    unit: SpeedUnit,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion tongues two-shaft-cardan --x speed:0.2rad/s:2rad/s --y "HookeJoint 1.angle:0deg:60deg"

    --x PARAMETER:LOW:HIGH  What varies along x; PARAMETER alone takes the file's range.
    --y PARAMETER:LOW:HIGH[:ROWS]  What varies along y; a joint angle alone takes the file's range.
    """
    found = tn.tongues(
        line, x[0], y[0], speed=speed, rows=y[1], about_steady_state=about_steady_state, progress=progress
    ).in_unit(unit)
    boundaries = found.data[["of_tongue", "boundary_x", "boundary_y"]]
    return CommandOutput(found, table=boundaries)


@Command("minimum damping", within=True)
def minimum_damping(
    line: Line,
    *,
    damping: Annotated[str | None, OptionReader(_damping)],
    maximum: float = 100.0,
    speeds: SpeedRange,
    margin: float = 0.0,
    about_steady_state: AboutSteadyState = False,
    unit: SpeedUnit,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion minimum-damping two-shaft-cardan --speed 1.4:1.8 --maximum 40

    --damping PARAMETER  Damping to vary; default: one factor for all damping of the line.
    --maximum  Largest damping tried [N m s/rad], or largest factor.
    --margin  Share by which the speeds are widened, 0.1 for 10 %.
    """
    found = tn.minimum_damping(
        line, speeds, damping=damping, maximum=maximum, margin=margin, about_steady_state=about_steady_state,
        progress=progress,
    )  # fmt: skip
    return CommandOutput(found.in_unit(unit))


@Command("stable windows", within=True)
def stable_windows(
    line: Line,
    *,
    parameter: Annotated[Box, OptionReader(read_box_range, "HookeJoint *.angle")],
    speeds: SpeedRange,
    margin: float = 0.0,
    about_steady_state: AboutSteadyState = False,
    unit: SpeedUnit,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion stable-windows two-shaft-cardan -p "HookeJoint 1.angle:0deg:60deg" --speed 1.4:1.8

    --parameter, -p PARAMETER:LOW:HIGH[:ROWS]  What varies; a joint angle alone takes the file's range.
    --margin  Share by which the speeds are widened, 0.1 for 10 %.
    """
    ends, rows = parameter
    found = tn.stable_windows(
        line, *ends, speeds, margin=margin, rows=rows, about_steady_state=about_steady_state, progress=progress
    )
    return CommandOutput(found.in_unit(unit))


@Command("tolerance study", within=True)
def tolerance_study(
    line: Line,
    *,
    tolerance: Tolerances,
    speed: Annotated[list[float], OptionReader(_operating, several=True, missing=lambda asked: [_operating(asked)])],
    checks: int = 0,
    samples: int = 1 << 14,
    seed: Annotated[int, NumberBounds(0)] = 0,
    about_steady_state: AboutSteadyState = False,
    unit: SpeedUnit,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion tolerance-study truck.toml -t "Shaft *.stiffness=10%" -t "HookeJoint 1.angle=5%" --speed 25Hz

    --tolerance, -t PARAMETER=SHARE  What scatters: "Shaft 1.stiffness=10%" or "…=normal 3%"; default: the file's.
    --speed SPEED  Input speed; repeat it for more; default: the file's.
    --checks  How many lines every check judges too; -1 for as many as half a minute allows.
    --samples  Number of lines drawn.
    --seed  Seed of the random numbers; the same seed draws the same lines.
    """  # fmt: skip
    found = tn.tolerance_study(
        line, dict(tolerance) if tolerance else None, speed,
        checks=True if checks < 0 else checks, samples=samples, seed=seed,
        about_steady_state=about_steady_state, progress=progress,
    )  # fmt: skip
    return CommandOutput(found.in_unit(unit))


@Command("certificate", writes=PICTURES_AND_DATA, part="certificate", within=True)
def certify_stability(
    line: Line,
    *,
    tolerance: Tolerances,
    speeds: SpeedRange,
    boxes: int = 20_000,
    about_steady_state: AboutSteadyState = False,
    write: Annotated[Path | None, OptionReader(place_of_line)],
    file: Annotated[str, InputAttribute("file")],
    unit: SpeedUnit,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion certify-stability two-shaft-cardan -t "Shaft 1.stiffness=1%" --speed 1.2:1.4

    --tolerance, -t PARAMETER=SHARE  What scatters: "Shaft 1.stiffness=1%"; default: the file's, or nothing.
    --boxes  Most ranges of speed and tolerances judged one by one; the rest is left undecided.
    --write PATH  Write the line of a counterexample as a driveline file.
    """
    given = dict(tolerance) if tolerance else None
    found = tn.certify_stability(
        line, given, speeds, most_boxes=boxes, about_steady_state=about_steady_state, progress=progress
    )
    if write is None or found.unstable_line is None:
        return CommandOutput(found.in_unit(unit))
    tn.dump(found.unstable_line, write, comments_of=file_of_line(file))
    return CommandOutput(found.in_unit(unit), written=[write])


@Command("peak certificate", writes=PICTURES_AND_DATA, part="peaks", within=True)
def certify_peaks(
    line: Line,
    *,
    tolerance: Tolerances,
    speeds: SpeedRange,
    gap: Annotated[float, NumberBounds(1e-6)] = 0.05,
    boxes: int = 20_000,
    write: Annotated[Path | None, OptionReader(place_of_line)],
    file: Annotated[str, InputAttribute("file")],
    unit: SpeedUnit,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion certify-peaks truck.toml -t "front tube.stiffness=5%" --speed 300rpm:600rpm

    --tolerance, -t PARAMETER=SHARE  What scatters: "Shaft 1.stiffness=1%"; default: the file's, or nothing.
    --gap  Share by which a bound may stand above what was computed, 0.05 for 5 %.
    --boxes  Most ranges of speed and tolerances judged one by one; with fewer, bounds hold but are wider.
    --write PATH  Write the line of a counterexample as a driveline file.
    """
    given = dict(tolerance) if tolerance else None
    found = tn.certify_peaks(line, given, speeds, gap=gap, most_boxes=boxes, progress=progress)
    if write is None or found.line is None:
        return CommandOutput(found.in_unit(unit))
    tn.dump(found.line, write, comments_of=file_of_line(file))
    return CommandOutput(found.in_unit(unit), written=[write])
