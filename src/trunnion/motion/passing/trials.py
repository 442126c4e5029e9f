"""The same line run up again and again: with its drive scaled, with a number changed, from several starting phases."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.driveline.applied_torque import AppliedTorque, scaled_torque
from trunnion.driveline.arguments import numbers, whole_number
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.machines import Motor
from trunnion.driveline.parameters import pack
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError
from trunnion.motion.passing.even_acceleration import accelerating
from trunnion.motion.passing.passing import passing_kinds
from trunnion.motion.passing.rigid import rigid_time
from trunnion.motion.passing.start import begun_line
from trunnion.motion.transients.engines import throws_of
from trunnion.motion.transients.excited import Shaking
from trunnion.motion.transients.prepare import Actions
from trunnion.results.counts import few

FACTOR = "factor"
"""Name of the parameter that scales the drive torque."""
ACCELERATION = "acceleration"
"""Name of the parameter by which the drive accelerates the rigid line evenly."""
MOST_PHASES = 10_000


@dataclass(frozen=True)
class Trials:
    """What is the same in all of them: torques and friction ``asked``; ``drive``: name of the disk whose torques are
    scaled; first and last speed [rad/s]; ``phases`` (phase,) [rad]; error allowed per step."""

    line: Driveline
    asked: Actions
    drive: str
    first: float
    last: float
    phases: Array
    tolerance: float

    def kinds(self, values: Mapping[str, float]) -> list[str]:
        """How the line with those values of its parameters ends, from every starting phase.

        Raises
        ------
        InputError : a value that the line refuses.
        """
        packed = pack(self.line)
        table = packed.table(1)
        for path, value in values.items():
            if path not in (FACTOR, ACCELERATION):
                packed.resolve_axis(path).put(table, value)
        factor = values.get(FACTOR, 1.0)
        stated = tuple(scaled_torque(one, factor) if one.on == self.drive else one for one in self.asked[0])
        prepared, acting = begun_line(packed.line_at(table[0]), (stated, *self.asked[1:]), self.first)
        asked = acting
        if ACCELERATION in values:
            drives = throws_of(self.drive, self.line.parts) or [self.drive]
            others = tuple(one for one in acting[0] if one.on not in drives or isinstance(one, Shaking))
            rest = (others, *acting[1:])
            even = accelerating(prepared, rest, drives[0], values[ACCELERATION], self.first, self.last)
            parts = [scaled_torque(even, 1 / len(drives)).but(on=name) for name in drives]
            asked = ((*others, *parts), *acting[1:])
        elif all(one.on != self.drive for one in self.asked[0]):
            asked = (tuple(self._scaled(one, factor) for one in acting[0]), *acting[1:])
        rigid = rigid_time(prepared, asked, self.first, self.last)
        return passing_kinds(prepared, asked, self.first, self.last, self.phases, rigid, self.tolerance)

    def _scaled(self, one: AppliedTorque, factor: float) -> AppliedTorque:
        """What a machine of the line drives with by itself is scaled, and not what shakes it."""
        return scaled_torque(one, factor) if one.on == self.drive and not isinstance(one, Shaking) else one


def trials_of(
    line: Driveline | Assembly, ends: tuple[float, float], asked: Actions, drive: str | None,
    phases: int | ArrayLike, tolerance: float,
) -> Trials:  # fmt: skip
    """Trials with what is left out chosen, and what is wrong refused."""
    description = line.line if isinstance(line, Assembly) else line
    acting = begun_line(description, asked, ends[0])[1][0]
    known = list(dict.fromkeys(one.on for one in acting))
    motors = [name for name, e in description.parts if isinstance(e, Motor) and name in known]
    driven = list(dict.fromkeys(one.on for one in asked[0])) or motors or known
    if drive is None and len(driven) > 1:
        raise InputError("is missing, for torques act on several disks", key="drive", remedy=f"name {few(driven, 3)}")
    if drive is not None and not set(throws_of(drive, description.parts) or [drive]) <= set(known):
        raise InputError("is given no torque", key="drive", value=drive, remedy=f"torques act on {few(known, 3)}")
    return Trials(description, asked, drive or driven[0], *ends, _phases(phases), tolerance)


def _phases(asked: int | ArrayLike) -> Array:
    """Starting phases (phase,) [rad]. So many are even over half a turn, which is what a Hooke's joint repeats in, and
    every other one is half a turn further on."""
    if isinstance(asked, int | np.integer) and not isinstance(asked, bool):
        count = whole_number(asked, "phases", 1)
        if count > MOST_PHASES:
            raise InputError("are too many", key="phases", value=count, remedy=f"at most {MOST_PHASES}; 8, say")
        k = np.arange(count)
        return np.asarray(np.pi * (k / count + k % 2))
    found = numbers(asked, "phases", "a number of them, 8, say, or angles [rad]")
    if not np.all(np.isfinite(found)):
        raise InputError("must be finite", key="phases", value=list(found), remedy="angles [rad]")
    return found


def passes(kinds: Sequence[str]) -> int:
    """How many of them came to the last speed."""
    return sum(kind in ("passed", "dwelt") for kind in kinds)
