"""How the text of an option is read: given what the command is about, the text, and the option at which it stands."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from contextvars import ContextVar
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import trunnion as tn
from trunnion.cli.command_input import CommandInput, Texts
from trunnion.errors import InputError
from trunnion.results.speeds import speed_factor

if TYPE_CHECKING:
    from trunnion.driveline.parameters import PackedLine
    from trunnion.driveline.quantities import QuantityKind

TABLES_ANYWHERE = ContextVar("TABLES_ANYWHERE", default=False)
"""Whether a driveline file may name tables outside its folder: an option before the command."""
ROWS = 65
"""Rows of a search of a box."""
AXIS_EXAMPLE = 'write "speed:300rpm:2400rpm:400" or "HookeJoint 1.angle:0deg:30deg:300"'


def line_of_file(file: str, texts: Texts, besides: Collection[str] = ()) -> CommandInput:
    """The driveline under its own torques, and the unit asked for or else that of the file; ``besides`` as of
    ``read_line``."""
    from trunnion.driveline.operating_speed import speed_unit

    line, unit = read_line(file, besides), texts["unit"]
    speed_factor(unit or "rad/s")
    return CommandInput(line, file, unit or speed_unit(line), texts)


def loaded_line(file: str, texts: Texts, besides: Collection[str] = ()) -> CommandInput:
    """The same under the torques of ``--load-case``, where one is asked for."""
    asked, case = line_of_file(file, texts, besides), texts["load_case"]
    return asked if case is None else replace(asked, subject=asked.line.with_load(case))


def read_line(file: str, besides: Collection[str] = ()) -> tn.Driveline:
    """The driveline in a file, or of the catalogue where no such file exists; ``besides`` are also names to tell."""
    path = Path(file)
    if path.exists() or path.suffix or len(path.parts) != 1:
        return tn.load(path, tables_anywhere=TABLES_ANYWHERE.get())
    # The studies load much that a file does not need.
    from trunnion.driveline.refusals import nearest
    from trunnion.papers.entries import entries

    names = [e.name for e in entries()]
    if file in names:
        line = tn.catalogue(file)
        if not isinstance(line, tn.Driveline):
            rattle, chaos = "frequency-response, sweep", "lyapunov-spectrum, poincare-map, certify-chaos"
            remedy = f"use it with {rattle if file == 'gear-rattle' else chaos} or reproduce {file}"
            raise InputError("is not a driveline but equations of motion", key="FILE", value=file, remedy=remedy)
        return line
    problem = "is neither a file nor a name of the catalogue" + (" or of a reference system" if besides else "")
    raise InputError(problem, key="FILE", value=file, remedy=nearest(file, [*names, *besides]))


def read_quantity(text: str, kind: QuantityKind, key: str, remedy: str = "", per: float = 1.0) -> float:
    """A number with a unit, or a bare one, ``per`` of which are the SI unit of ``kind``."""
    from trunnion.driveline.quantities import parse

    try:
        return parse(float(text) / per if is_number(text) else text, kind)
    except InputError as error:
        raise InputError(error.problem, key=key, value=text, remedy=remedy or error.remedy) from None


def read_speed(asked: CommandInput, text: str, key: str) -> float:
    """``"1500 rpm"``, or a bare number in the unit asked for, as a positive speed in rad/s."""
    from trunnion.driveline.quantities import SPEED

    speed = _read_end(text, SPEED, asked.unit, key)
    if not speed > 0:
        raise InputError("must be positive", key=key, value=text, remedy='write "1500 rpm", say')
    return speed


def read_start(asked: CommandInput, text: str, key: str) -> float:
    """The same, or 0 for standstill."""
    from trunnion.driveline.quantities import SPEED

    return 0.0 if _read_end(text, SPEED, asked.unit, key) == 0 else read_speed(asked, text, key)


def read_speed_ends(asked: CommandInput, text: str, key: str) -> tuple[float, float]:
    """``LOW:HIGH`` in rad/s."""
    read = [read_speed(asked, end, key) for end in text.split(":")]
    if len(read) != 2 or not read[0] < read[1]:
        raise InputError("is not a rising range", key=key, value=text, remedy='write "300rpm:2400rpm", say')
    return read[0], read[1]


def range_of(asked: CommandInput) -> tuple[float, float]:
    """The speed range of the file, in rad/s."""
    from trunnion.reporting.ranges import speed_range

    return speed_range(asked.line)


def read_time(text: str, key: str) -> float:
    """``"20 ms"``, or a bare number of seconds, as a positive time in seconds."""
    from trunnion.driveline.quantities import QuantityKind

    time = float(text) if is_number(text) else read_quantity(text, QuantityKind("time", "s", "2.5 s"), key)
    if not (math.isfinite(time) and time > 0):
        raise InputError("must be a positive time", key=key, value=text, remedy='write "2.5 s", say')
    return time


def read_state(asked: CommandInput, text: str, key: str) -> list[float]:
    """``0.1,0`` as a state to start from."""
    parts = text.split(",")
    if not all(is_number(part) for part in parts):
        raise InputError("is not a list of numbers", key=key, value=text, remedy='write "0.1,0"')
    return [float(part) for part in parts]


def is_number(text: str) -> bool:
    """Whether a text is a bare number, without a unit."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def read_axis(asked: CommandInput, text: str, key: str, points: int) -> tuple[str, float, float, int, str]:
    """``PARAMETER[:LOW:HIGH[:POINTS]][:log]`` as an axis request, of every command that varies something.

    PARAMETER alone takes the range of the file, and without POINTS there are ``points``. Ends that are multiples,
    ``Shaft *.stiffness:0.5x:2x``, are of the factor of what each element states. Read from the right, so that names
    with colons remain possible.
    """
    from trunnion.driveline.quantities import KINDS, SPEED

    packed, parts = tn.pack(asked.line), [part.strip() for part in text.split(":")]
    scale = "log" if len(parts) > 1 and parts[-1] == "log" else "linear"
    if scale == "log":
        parts.pop()
    if len(parts) < 3:
        return _whole_axis(":".join(parts), text, asked.line, points, key, scale)
    uncounted = len(parts) == 3 or not parts[-1].isdecimal() and _is_parameter(packed, ":".join(parts[:-2]))
    count = points if uncounted else _count(parts.pop(), key)
    *name, low_text, high_text = parts
    path = ":".join(name)
    if low_text.endswith("x") and high_text.endswith("x"):
        path, low_text, high_text = f"factor of {path}", low_text[:-1], high_text[:-1]
    columns = packed.resolve_axis(path)
    kind = SPEED
    if columns.label != SPEED.name:
        kind = next(k for k in KINDS if k.unit == columns.unit and k is not SPEED)
    low, high = (_read_end(end, kind, asked.unit, key) for end in (low_text, high_text))
    if low == high:
        raise InputError("is a range of zero size", key=key, value=text, remedy="give low < high")
    if low > high:
        raise InputError("is a reversed range", key=key, value=text, remedy="give the lower end first")
    return columns.label, low, high, count, scale


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


def read_even_axis(asked: CommandInput, text: str, key: str, points: int) -> tuple[str, float, float, int]:
    """The same where steps are even: a box that is searched, a parameter that is raised."""
    label, low, high, count, scale = read_axis(asked, text, key, points)
    if scale == "log":
        raise InputError("is searched evenly", key=key, value=text, remedy="leave out :log")
    return label, low, high, count


def read_box_range(asked: CommandInput, text: str, key: str) -> tuple[tuple[str, float, float], int]:
    """``PARAMETER:LOW:HIGH[:ROWS]`` as a range and a number of rows."""
    label, low, high, rows = read_even_axis(asked, text, key, ROWS)
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


def _read_end(text: str, kind: QuantityKind, unit: str, key: str) -> float:
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


def file_of_line(given: str) -> Path | None:
    """The file that a line was read from; None for one of the catalogue."""
    return Path(given) if Path(given).is_file() else None


def place_of_line(asked: CommandInput, text: str, key: str) -> Path:
    """Where a line is to be written."""
    best = Path(text)
    if best.suffix.lower() != ".toml" or not best.parent.is_dir() or best.is_dir():
        raise InputError("is not a place for a driveline file", key=key, value=text, remedy="best.toml, say")
    return best
