"""What the columns of a recorded file are: a small TOML beside it.

::

    # run-up.channels.toml, beside run-up.wav
    rate = "200 kHz"                  # where the file does not say it
    time = "t"                        # or the column with the times [s]

    [[channel]]
    column = "CH1"                    # of the file; a number counts from 1
    name = "flywheel"
    kind = "pulses"                   # a voltage with a pulse a tooth; "edges": times of edges [s]
    pulses_per_turn = 60
    at = "flywheel"                   # disk of the line
    level = 2.5                       # of an edge; default the middle of the signal
    edge = "falling"                  # default "rising"
    pitch_error = "1 %"               # standard deviation of an edge's position, of the pitch
    reversed = false
    clock = "B"                       # of a second recorder

    [[channel]]
    column = "CH3"
    name = "gauge"
    kind = "torque"                   # or "acceleration", "speed", "other"
    unit = "kN*m"                     # of the values after scale and offset
    scale = 0.25                      # value = scale * column + offset
    offset = 0.0
    keep_rate = "5 kHz"               # of the file's samples so many are kept, filtered; default all of them
    at = "front tube"

    [[channel]]
    column = "CH4"
    kind = "acceleration"
    unit = "m/s^2"                    # or "g", of a tangential accelerometer; "rad/s^2" where no radius is given
    radius = "80 mm"                  # that it sits at
    gravity = false                   # two opposite each other, summed, or an upright shaft; default true
    at = "hub"
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from trunnion.driveline.quantities import ACCELERATION, FREQUENCY, LENGTH, RATIO, SPEED, TORQUE, QuantityKind, parse
from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError
from trunnion.measured.signals.measurement import SAMPLED, USUAL_PITCH_ERROR
from trunnion.reading import regular_bytes

TURN = 6.283185307179586
LARGEST = 1_000_000
"""Bytes of a description of channels."""
KINDS = ("pulses", "edges", *SAMPLED)
GRAVITY = 9.80665
"""Of the earth [m/s²] (ISO 80000-3)."""
TANGENTIAL = QuantityKind("acceleration", "m/s^2", "30 m/s^2")
UNITS: Mapping[str, QuantityKind] = {"torque": TORQUE, "acceleration": ACCELERATION, "speed": SPEED}
TYPES: Mapping[str, tuple[type, ...]] = {
    "column": (str, int), "name": (str,), "kind": (str,), "at": (str,), "unit": (str,), "edge": (str,),
    "clock": (str,), "scale": (int, float), "offset": (int, float), "level": (int, float), "reversed": (bool,),
    "pulses_per_turn": (int,), "pitch_error": (int, float, str), "radius": (int, float, str), "gravity": (bool,),
    "keep_rate": (int, float, str),
}  # fmt: skip


@dataclass(frozen=True)
class ColumnDescription:
    """One column of a file; see the module's lines."""

    column: str | int
    name: str = ""
    kind: str = "other"
    at: str = ""
    unit: str = ""
    scale: float = 1.0
    offset: float = 0.0
    pulses_per_turn: int = 0
    level: float | None = None
    edge: str = "rising"
    pitch_error: float = USUAL_PITCH_ERROR
    reversed: bool = False
    clock: str = ""
    radius: float = 0.0
    gravity: bool = True
    keep_rate: float = 0.0

    @property
    def label(self) -> str:
        """Its name, or that of the column."""
        return self.name or str(self.column)

    @property
    def unit_size(self) -> float:
        """Its unit in SI, of a tangential acceleration over the radius."""
        if self.radius and self.unit == "g":  # of an accelerometer, not grams
            return GRAVITY / self.radius
        if self.radius:
            return float(parse(f"1 {self.unit}", TANGENTIAL)) / self.radius
        return parse(f"1 {self.unit}", UNITS[self.kind]) if self.unit and self.kind in UNITS else 1.0

    @property
    def once_a_turn(self) -> float:
        """What gravity adds to it once a turn of its shaft [rad/s²]."""
        return GRAVITY / self.radius if self.radius and self.gravity else 0.0


@dataclass(frozen=True)
class FileDescription:
    """All columns of a file; rate [Hz] and time, the column with the times, where they are given."""

    columns: tuple[ColumnDescription, ...]
    rate: float | None = None
    time: str | int | None = None


def beside(path: Path) -> Path:
    """Where the description of a file stands: "run.wav" has "run.channels.toml"."""
    return path.with_suffix(".channels.toml")


def read_description(path: Path) -> FileDescription:
    """The description in a TOML file.

    Raises
    ------
    InputError : it cannot be read; a key that is unknown, missing, or of another kind.
    """
    try:
        content = tomllib.loads(regular_bytes(path, LARGEST, what="the description of channels").decode("utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"is not TOML ({error})", key="channels", value=path.name) from None
    return description_of(content, path.name)


def description_of(content: Mapping[str, Any], source: str) -> FileDescription:
    """The description in a mapping as TOML gives it; ``source`` is named in messages.

    Raises
    ------
    InputError : as of ``read_description``.
    """
    _known(content, ("rate", "time", "channel"), source)
    stated = content.get("channel", [])
    if not isinstance(stated, list) or not stated or not all(isinstance(one, Mapping) for one in stated):
        raise InputError("has no channel", element=source, key="channel", remedy="write [[channel]] for each")
    rate = content.get("rate")
    if rate is not None:
        rate = float(rate) if isinstance(rate, int | float) else parse(rate, FREQUENCY) / TURN
        if not rate > 0:
            raise InputError("must be positive", element=source, key="rate", value=content["rate"], remedy="in Hz")
    columns = tuple(_column(one, f"{source} channel {place}") for place, one in enumerate(stated, start=1))
    return FileDescription(columns, rate, content.get("time"))


def _known(given: Mapping[str, Any], keys: tuple[str, ...], where: str) -> None:
    for key in given:
        if key not in keys:
            raise InputError("unknown key", element=where, key=key, value=given[key], remedy=nearest(key, keys))


def _column(given: Mapping[str, Any], where: str) -> ColumnDescription:
    _known(given, tuple(one.name for one in fields(ColumnDescription)), where)
    for key, value in given.items():
        if not isinstance(value, TYPES[key]) or (isinstance(value, bool) and bool not in TYPES[key]):
            words = " or ".join({str: "a text", int: "a whole number", float: "a number", bool: "true or false"}[t]
                                for t in TYPES[key])  # fmt: skip
            raise InputError(f"must be {words}", element=where, key=key, value=value)
    if "column" not in given:
        raise InputError("is missing", element=where, key="column", remedy='write column = "CH1"')
    found = dict(given)
    for key, kind in (("pitch_error", RATIO), ("radius", LENGTH)):
        if key in found:
            try:
                found[key] = parse(found[key], kind)
            except InputError as error:
                raise error.but(element=where, key=key) from None
    if "radius" in found:
        if not found["radius"] > 0:
            raise InputError(
                "must be positive", element=where, key="radius", value=given["radius"], remedy='write "80 mm", say'
            )
    if "keep_rate" in found:
        stated = found["keep_rate"]
        try:
            found["keep_rate"] = parse(stated, FREQUENCY) / TURN if isinstance(stated, str) else float(stated)
        except InputError as error:
            raise error.but(element=where, key="keep_rate") from None
        if not found["keep_rate"] > 0:
            raise InputError("must be positive", element=where, key="keep_rate", value=stated, remedy="in Hz")
    made = ColumnDescription(**found)
    if made.keep_rate and made.kind in ("pulses", "edges"):
        raise InputError(
            "belongs to a sampled signal", element=where, key="keep_rate", value=given["keep_rate"],
            remedy="leave it out: of pulses only their edges are kept",
        )  # fmt: skip
    if made.kind != "acceleration":
        for key in ("radius", "gravity"):
            if key in given:
                raise InputError('belongs to kind = "acceleration"', element=where, key=key, value=given[key])
    for key, value, known in (("kind", made.kind, KINDS), ("edge", made.edge, ("rising", "falling"))):
        if value not in known:
            raise InputError("is not known", element=where, key=key, value=value, remedy=nearest(value, known))
    if made.kind in ("pulses", "edges"):
        if made.pulses_per_turn < 1:
            raise InputError(
                "must be a whole number, 1 or more", element=where, key="pulses_per_turn",
                value=given.get("pulses_per_turn"), remedy="count the teeth of the wheel",
            )  # fmt: skip
    elif made.kind in UNITS and not made.unit:
        example = TANGENTIAL.unit if made.radius else UNITS[made.kind].unit
        raise InputError("is missing", element=where, key="unit", remedy=f'write unit = "{example}"')
    try:
        _ = made.unit_size  # a unit of another quantity is refused here
    except InputError as error:
        raise error.but(element=where, key="unit") from None
    return made
