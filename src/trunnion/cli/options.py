"""The options that commands share, and how their text is read."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import trunnion as tn
from trunnion.errors import InputError
from trunnion.results.speeds import speed_factor

if TYPE_CHECKING:
    from trunnion.driveline.parameters import PackedLine
    from trunnion.driveline.quantities import Kind

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
SpeedRange = Annotated[str | None, typer.Option("--speed", metavar="LOW:HIGH", help="Default the file's range.")]
LoadCase = Annotated[str | None, typer.Option("--load-case", help="Torques of this load case of the file.")]
Within = Annotated[
    str | None,
    typer.Option("--within", metavar="TIME", help='End within this time, "30 s" say, with what is known by then.'),
]
Points = Annotated[str, typer.Option("--points", metavar="NXxNY", help="Points along x and y where not said there.")]

TABLES_ANYWHERE = ContextVar("TABLES_ANYWHERE", default=False)
"""Whether a driveline file may name tables outside its folder: an option before the command."""
ROWS = 65
"""Rows of a search of a box."""
AXIS_EXAMPLE = 'write "speed:300rpm:2400rpm:400" or "HookeJoint 1.angle:0deg:30deg:300"'


def read_case(
    file: str, unit: str | None, load_case: str | None = None, besides: Collection[str] = ()
) -> tuple[tn.Driveline, str]:
    """The driveline under its own torques or those of a load case, and the unit asked for or else that of the file."""
    from trunnion.driveline.operating_speed import speed_unit

    line = read_line(file, besides)
    if load_case is not None:
        line = line.with_load(load_case)
    if unit is None:
        return line, speed_unit(line)
    speed_factor(unit)
    return line, unit


def read_line(file: str, besides: Collection[str] = ()) -> tn.Driveline:
    """The driveline in a file, or of the catalogue where no such file exists; ``besides`` are also names to tell."""
    path = Path(file)
    if path.exists() or path.suffix or len(path.parts) != 1:
        return tn.load(path, tables_anywhere=TABLES_ANYWHERE.get())
    # The studies load much that a file does not need.
    from trunnion.driveline.refusals import nearest
    from trunnion.studies.entries import entries

    names = [e.name for e in entries()]
    if file in names:
        line = tn.catalogue(file)
        if not isinstance(line, tn.Driveline):
            rattle, chaos = "frequency-response, sweep", "lyapunov-spectrum, poincare-map, certify-chaos"
            remedy = f"use it with {rattle if file == 'gear-rattle' else chaos} or reproduce {file}"
            raise InputError("is no driveline but equations of motion", key="FILE", value=file, remedy=remedy)
        return line
    problem = "is neither a file nor a name of the catalogue" + (" or of a reference system" if besides else "")
    raise InputError(problem, key="FILE", value=file, remedy=nearest(file, [*names, *besides]))


def file_stem(file: str) -> str:
    """What to call outputs: ``truck`` for ``examples/truck.toml``."""
    return Path(file).stem


def read_quantity(text: str, kind: Kind, key: str, remedy: str = "", per: float = 1.0) -> float:
    """A number with a unit, or a bare one, ``per`` of which are the SI unit of ``kind``."""
    from trunnion.driveline.quantities import parse

    try:
        return parse(float(text) / per if is_number(text) else text, kind)
    except InputError as error:
        raise InputError(error.problem, key=key, value=text, remedy=remedy or error.remedy) from None


def read_speed(text: str | None, unit: str, key: str = "--speed") -> float | None:
    """``"1500 rpm"``, or a bare number in ``unit``, as a positive speed in rad/s."""
    return None if text is None else read_stated_speed(text, unit, key)


def read_stated_speed(text: str, unit: str, key: str = "--speed") -> float:
    """The same of a text that is there."""
    from trunnion.driveline.quantities import SPEED

    speed = _read_end(text, SPEED, unit, key)
    if not speed > 0:
        raise InputError("must be positive", key=key, value=text, remedy='write "1500 rpm", say')
    return speed


def read_speed_ends(text: str | None, unit: str) -> tuple[float, float] | None:
    """``LOW:HIGH`` in rad/s; None where nothing is written."""
    if text is None:
        return None
    read = [read_stated_speed(end, unit) for end in text.split(":")]
    if len(read) != 2 or not read[0] < read[1]:
        raise InputError("is no rising range", key="--speed", value=text, remedy='write "300rpm:2400rpm", say')
    return read[0], read[1]


def read_speed_range(text: str | None, line: tn.Driveline, unit: str) -> tuple[float, float]:
    """``LOW:HIGH`` in rad/s, or the file's range."""
    from trunnion.reporting.ranges import speed_range

    return read_speed_ends(text, unit) or speed_range(line)


def read_time(text: str | None, key: str) -> float | None:
    """``"20 ms"``, or a bare number of seconds, as a positive time in seconds."""
    if text is None:
        return None
    from trunnion.driveline.quantities import Kind

    time = float(text) if is_number(text) else read_quantity(text, Kind("time", "s", "2.5 s"), key)
    if not (math.isfinite(time) and time > 0):
        raise InputError("must be a positive time", key=key, value=text, remedy='write "2.5 s", say')
    return time


def read_state(text: str | None) -> list[float] | None:
    """``0.1,0`` as a state to start from."""
    if text is None:
        return None
    parts = text.split(",")
    if not all(is_number(part) for part in parts):
        raise InputError("is not a list of numbers", key="--start", value=text, remedy='write "0.1,0"')
    return [float(part) for part in parts]


def is_number(text: str) -> bool:
    """Whether a text is a bare number, without a unit."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def read_axis(text: str, line: tn.Driveline, unit: str, points: int, key: str) -> tuple[str, float, float, int, str]:
    """``PARAMETER[:LOW:HIGH[:POINTS]][:log]`` as an axis request, of every command that varies something.

    PARAMETER alone takes the range of the file, and without POINTS there are ``points``. Ends that are multiples,
    ``Shaft *.stiffness:0.5x:2x``, are of the factor of what each element states. Read from the right, so that names
    with colons remain possible.
    """
    from trunnion.driveline.quantities import KINDS, SPEED

    packed, parts = tn.pack(line), [part.strip() for part in text.split(":")]
    scale = "log" if len(parts) > 1 and parts[-1] == "log" else "linear"
    if scale == "log":
        parts.pop()
    if len(parts) < 3:
        return _whole_axis(":".join(parts), text, line, points, key, scale)
    if len(parts) == 3 or not parts[-1].isdecimal() and _is_parameter(packed, ":".join(parts[:-2])):
        parts.append(str(points))
    *name, low_text, high_text, count = parts
    path = ":".join(name)
    if low_text.endswith("x") and high_text.endswith("x"):
        path, low_text, high_text = f"factor of {path}", low_text[:-1], high_text[:-1]
    columns = packed.resolve_axis(path)
    kind = SPEED
    if columns.label != SPEED.name:
        kind = next(k for k in KINDS if k.unit == columns.unit and k is not SPEED)
    low, high = (_read_end(end, kind, unit, key) for end in (low_text, high_text))
    if low == high:
        raise InputError("is a range of zero size", key=key, value=text, remedy="give low < high")
    if low > high:
        raise InputError("is a reversed range", key=key, value=text, remedy="give the lower end first")
    return columns.label, low, high, _count(count, key), scale


def _whole_axis(
    path: str, text: str, line: tn.Driveline, points: int, key: str, scale: str
) -> tuple[str, float, float, int, str]:
    """A parameter that has a range in the file: the speed, joint angles."""
    from trunnion.reporting.ranges import angle_range, speed_range

    columns = tn.pack(line).resolve(path) if ":" not in path else None
    if columns is None or not (columns.label == "speed" or columns.label.endswith(".angle")):
        raise InputError("needs a range", key=key, value=text, remedy=AXIS_EXAMPLE)
    low, high = speed_range(line) if columns.label == "speed" else angle_range(line)
    return columns.label, low, high, points, scale


def _is_parameter(packed: PackedLine, path: str) -> bool:
    try:
        return bool(len(packed.resolve(path).index))
    except InputError:
        return False


def read_even_axis(text: str, line: tn.Driveline, unit: str, points: int, key: str) -> tuple[str, float, float, int]:
    """The same where steps are even: a box that is searched, a parameter that is raised."""
    label, low, high, count, scale = read_axis(text, line, unit, points, key)
    if scale == "log":
        raise InputError("is searched evenly", key=key, value=text, remedy="leave out :log")
    return label, low, high, count


def read_box_range(text: str, line: tn.Driveline, unit: str, key: str) -> tuple[tuple[str, float, float], int]:
    """``PARAMETER:LOW:HIGH[:ROWS]`` as a range and a number of rows."""
    label, low, high, rows = read_even_axis(text, line, unit, ROWS, key)
    return (label, low, high), rows


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


def _read_end(text: str, kind: Kind, unit: str, key: str) -> float:
    """As ``read_quantity``, but a bare speed is in ``unit``."""
    if is_number(text) and not math.isfinite(float(text)):
        raise InputError("must be finite", key=key, value=text, remedy=f'write "{kind.example}", say')
    return read_quantity(text, kind, key, per=speed_factor(unit) if kind.name == "speed" else 1.0)


def only_for_lines(remedy: str, given: Mapping[str, object]) -> None:
    """Refuse options that a system of equations has no use for."""
    for key, value in given.items():
        if value is not None:
            raise InputError("belongs to drivelines", key=key, value=value, remedy=remedy)


def read_set(texts: Sequence[str] | None) -> dict[str, float]:
    """The parameters that ``--set NAME=VALUE`` gives a reference system."""
    values = {}
    for text in texts or ():
        key, _, value = text.partition("=")
        if not is_number(value):
            raise InputError("is not NAME=VALUE", key="--set", value=text, remedy="write frequency=1.2, say")
        values[key.strip()] = float(value)
    return values
