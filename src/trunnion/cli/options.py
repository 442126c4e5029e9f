"""The options that commands share, and how their text is read."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from trunnion.errors import InputError

if TYPE_CHECKING:
    from trunnion.driveline.driveline import Driveline
    from trunnion.driveline.parameters import Columns
    from trunnion.equations.coefficients import Assembly

File = Annotated[str, typer.Argument(metavar="FILE", help="Driveline file (TOML) or a name of the catalogue.")]
Json = Annotated[bool, typer.Option("--json", help="Print JSON on stdout and nothing else.")]
Unit = Annotated[
    str | None,
    typer.Option("--unit", "-u", metavar="rpm|Hz|rad/s", help="Unit of speeds; default: the file's."),
]
Output = Annotated[
    list[Path] | None,
    typer.Option(
        "--output", "-o", metavar="PATH", help="File ending in .png, .pdf, .svg, .nc or .csv; repeat it for more."
    ),
]
OutputNoTable = Annotated[
    list[Path] | None,
    typer.Option("--output", "-o", metavar="PATH", help="File ending in .png, .pdf, .svg or .nc; repeat it for more."),
]
Speed = Annotated[
    str | None,
    typer.Option(
        "--speed",
        "-s",
        help='Input speed: "1500 rpm", "25 Hz", "157 rad/s", or a number in --unit; default: the file\'s.',
    ),
]
LoadCase = Annotated[str | None, typer.Option("--load-case", help="Torques of this load case of the file.")]
Points = Annotated[str, typer.Option("--points", metavar="NXxNY", help="Points along x and y where not said there.")]

AXIS_EXAMPLE = 'write "speed:300rpm:2400rpm:400" or "HookeJoint 1.angle:0deg:30deg:300"'


def read_line(file: str, load_case: str | None = None, besides: Sequence[str] = ()) -> Driveline:
    """The driveline in a file, or of the catalogue where no such file exists; ``besides`` are also names to tell."""
    line = _file_or_catalogue(file, besides)
    return line if load_case is None else line.with_load(load_case)


def reference_systems() -> Sequence[str]:
    """Names that stand for equations of motion, not for drivelines."""
    from trunnion.systems.reference import SYSTEMS

    return tuple(SYSTEMS)


def _file_or_catalogue(file: str, besides: Sequence[str]) -> Driveline:
    from trunnion.driveline.driveline import Driveline
    from trunnion.driveline.files import load

    path = Path(file)
    if path.exists() or path.suffix or len(path.parts) != 1:
        return load(path)
    # The studies load much that a file does not need.
    from trunnion.driveline.refusals import nearest
    from trunnion.studies.entries import catalogue, entries

    names = [e.name for e in entries()]
    if file in names:
        line = catalogue(file)
        if not isinstance(line, Driveline):
            rattle, chaos = "frequency-response, sweep", "lyapunov-spectrum, poincare-map, certify-chaos"
            remedy = f"use it with {rattle if file == 'gear-rattle' else chaos} or reproduce {file}"
            raise InputError("is no driveline but equations of motion", key="FILE", value=file, remedy=remedy)
        return line
    problem = "is neither a file nor a name of the catalogue" + (" or of a reference system" if besides else "")
    raise InputError(problem, key="FILE", value=file, remedy=nearest(file, [*names, *besides]))


def file_stem(file: str) -> str:
    """What to call outputs: ``truck`` for ``examples/truck.toml``."""
    return Path(file).stem


def read_unit(line: Driveline, unit: str | None) -> str:
    """The unit asked for, or the one of the description."""
    from trunnion.driveline.operating_speed import speed_unit
    from trunnion.results.speeds import speed_factor

    if unit is None:
        return speed_unit(line)
    speed_factor(unit)
    return unit


def read_speed(text: str | None, unit: str, key: str = "--speed") -> float | None:
    """``"1500 rpm"``, or a bare number in ``unit``, as a positive speed in rad/s."""
    if text is None:
        return None
    from trunnion.driveline.quantities import SPEED

    speed = _quantity(text, SPEED.name, unit, key=key)
    if not speed > 0:
        raise InputError("must be positive", key=key, value=text, remedy='write "1500 rpm", say')
    return speed


def read_speed_ends(text: str | None, unit: str) -> tuple[float, float] | None:
    """``LOW:HIGH`` in rad/s; None where nothing is written."""
    if text is None:
        return None
    read = [read_speed(end, unit) for end in text.split(":")]
    if len(read) != 2 or read[0] is None or read[1] is None or not read[0] < read[1]:
        raise InputError("is no rising range", key="--speed", value=text, remedy='write "300rpm:2400rpm", say')
    return read[0], read[1]


def read_time(text: str | None, key: str) -> float | None:
    """``"20 ms"``, or a bare number of seconds, as a positive time in seconds."""
    if text is None:
        return None
    from trunnion.driveline.quantities import Kind, parse

    try:
        time = float(text) if is_number(text) else parse(text, Kind("time", "s", "2.5 s"))
    except InputError as error:
        raise InputError(error.problem, key=key, value=text, remedy=error.remedy) from None
    if not (math.isfinite(time) and time > 0):
        raise InputError("must be a positive time", key=key, value=text, remedy='write "2.5 s", say')
    return time


def is_number(text: str) -> bool:
    """Whether a text is a bare number, without a unit."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def read_axis(text: str, assembly: Assembly, unit: str, points: int, key: str) -> tuple[object, ...]:
    """``PARAMETER:LOW:HIGH:POINTS[:log]``, or PARAMETER alone for the range of the file, as an axis request.

    Read from the right, so that names with colons remain possible.
    """
    from trunnion.reporting.ranges import angle_range, speed_range

    parts = text.split(":")
    scale = "log" if len(parts) > 4 and parts[-1].strip() == "log" else "linear"
    if scale == "log":
        parts.pop()
    if len(parts) < 4:
        columns = assembly.packed.resolve(text.strip()) if len(parts) == 1 else None
        if columns is None or not (columns.label == "speed" or columns.label.endswith(".angle")):
            raise InputError("needs a range", key=key, value=text, remedy=AXIS_EXAMPLE)
        low, high = speed_range(assembly) if columns.label == "speed" else angle_range(assembly.line)
        return (columns.label, low, high, points)
    *name, low_text, high_text, count = parts
    columns = assembly.packed.resolve(":".join(name).strip())
    low, high = (_quantity(end, _kind(columns), unit, key=key) for end in (low_text, high_text))
    if low == high:
        raise InputError("is a range of zero size", key=key, value=text, remedy="give low < high")
    if low > high:
        raise InputError("is a reversed range", key=key, value=text, remedy="give the lower end first")
    return (columns.label, low, high, _count(count, key), scale)


def read_points(text: str) -> tuple[int, int]:
    """``200x150``."""
    from trunnion.results.chart import require_pixels

    parts = text.lower().replace("×", "x").split("x")
    if len(parts) != 2:
        raise InputError("is not a size", key="--points", value=text, remedy="write 200x150")
    across, up = _count(parts[0], "--points"), _count(parts[1], "--points")
    require_pixels(across, up)
    return across, up


def _count(text: str, key: str) -> int:
    try:
        count = int(text)
    except ValueError:
        count = 0
    if count < 2:
        problem = "must be a whole number of points, 2 or more"
        raise InputError(problem, key=key, value=text, remedy="write 200, say")
    return count


def _kind(columns: Columns) -> str:
    from trunnion.driveline.quantities import KINDS

    if columns.label == "speed":
        return "speed"
    return next(k.name for k in KINDS if k.unit == columns.unit and k.name != "speed")


def _quantity(text: str, kind_name: str, unit: str, *, key: str) -> float:
    """A number with a unit, or a bare one: in ``unit`` for speeds, in SI otherwise."""
    from trunnion.driveline.quantities import KINDS, parse
    from trunnion.results.speeds import speed_factor

    kind = next(k for k in KINDS if k.name == kind_name)
    try:
        number = float(text)
    except ValueError:
        try:
            return parse(text, kind)
        except InputError as error:
            raise InputError(error.problem, key=key, value=text, remedy=error.remedy) from None
    if not math.isfinite(number):
        raise InputError("must be finite", key=key, value=text, remedy=f'write "{kind.example}", say')
    try:
        return parse(number / speed_factor(unit) if kind_name == "speed" else number, kind)
    except InputError as error:
        raise InputError(error.problem, key=key, value=text, remedy=error.remedy) from None


def read_set(texts: Sequence[str] | None) -> dict[str, float]:
    """The parameters that ``--set NAME=VALUE`` gives a reference system."""
    values = {}
    for text in texts or ():
        key, _, value = text.partition("=")
        if not is_number(value):
            raise InputError("is not NAME=VALUE", key="--set", value=text, remedy="write frequency=1.2, say")
        values[key.strip()] = float(value)
    return values
