"""Torques that shake a disk: harmonic in its own rotation (engine orders), in time, or in both together (motors)."""

from __future__ import annotations

from cmath import phase
from collections.abc import Callable
from functools import cached_property
from itertools import pairwise
from math import prod
from typing import Annotated, ClassVar, Self

from pydantic import BeforeValidator, model_validator

from trunnion.driveline.csv_table import refuse_name
from trunnion.driveline.quantities import (
    SPEED,
    TORQUE,
    Angle,
    Dimensionless,
    Frequency,
    Maybe,
    QuadraticLoad,
    Several,
    Speed,
    TableList,
    Torque,
    optional,
    shown,
)
from trunnion.driveline.record import Record, as_tuple, listed
from trunnion.errors import InputError

AMPLITUDES = ("amplitude", "quadratic_amplitude", "share", "amplitudes")
"""Keys that each state an amplitude; ``equations.amplitudes`` has the law of each."""
_LISTS = as_tuple("quantities", 'write speeds = ["600 rpm", "1800 rpm"], amplitudes = ["40 N*m", "90 N*m"], say')


class Excitation(Record):
    """One harmonic torque on a disk, A cos(order · rotation + frequency · time + phase), positive with the rotation.

    Give ``order``, ``frequency`` or both; what is left out is 0. Alone each is positive, for a sign would only turn the
    phase. Together each has either sign, as the torque of a motor whose field turns in time and whose rotor with the
    disk: order = -2 and frequency = "100 Hz" is at 100 Hz at rest and at nothing at 50 turns a second. The rotation
    counts in the disk's own sense, also behind a gear that reverses it.

    Several orders together are an engine-order table. A is stated in one of four ways: as one
    ``amplitude``; by the square of the disk's speed; as a ``share`` of the mean torque there, as of blades and motors;
    or as a table over the disk's speed, the mean torque it drives with, or both. Between the points of a table
    A e^{i phase} is linear, over both bilinear. Speeds and torques beyond its ends are refused.

    Parameters
    ----------
    amplitude : A [N m].
    order : cycles per turn of the disk, 0.5 for a four-stroke cylinder.
    frequency : in time [rad/s].
    phase : at zero rotation and time [rad].
    quadratic_amplitude : A over the square of the disk's mean speed [N m s²/rad²], as of oscillating masses.
    share : A over the size of the mean torque on its disk or machine, drive or load.
    speeds : of the disk [rad/s], rising: where the table has its points; or else, or besides
    torques : mean torque that the disk drives with [N m], rising.
    amplitudes : A at these points [N m]; over both, all speeds at the first torque, then all at the next.
    phases : at these points [rad], added to ``phase``; 0 by default.

    >>> firing = Excitation(order=2, amplitude="60 N*m", phase="90 deg")
    >>> round(firing.phase, 4)
    1.5708
    """

    what: ClassVar[str] = "excitation"
    example: ClassVar[str] = 'order = 2 and amplitude = "40 N*m"'

    amplitude: Maybe[Torque] = optional(default=None, description="of the torque; positive drives")
    order: Maybe[Dimensionless] = optional(default=None, description="cycles per turn of the disk")
    frequency: Maybe[Frequency] = optional(default=None, description="in time, instead of an order or beside it")
    phase: Angle = optional(default=0.0, description="at zero rotation and time")
    quadratic_amplitude: Maybe[QuadraticLoad] = optional(
        default=None, description="amplitude over the square of the disk's speed, instead"
    )
    share: Maybe[Dimensionless] = optional(default=None, description="amplitude over the mean torque there, instead")
    speeds: Annotated[Several[Speed], BeforeValidator(_LISTS)] = optional(
        default=(), description="of the disk, where a table of amplitudes has its points"
    )
    torques: Annotated[Several[Torque], BeforeValidator(_LISTS)] = optional(
        default=(), description="mean torques that the disk drives with, instead of speeds or besides"
    )
    amplitudes: Annotated[Several[Torque], BeforeValidator(_LISTS)] = optional(
        default=(), description="at the points of the table"
    )
    phases: Annotated[Several[Angle], BeforeValidator(_LISTS)] = optional(
        default=(), description="at the points of the table"
    )

    @model_validator(mode="after")
    def _one_angle(self) -> Self:
        given = [key for key in ("order", "frequency") if getattr(self, key) is not None]
        if not given:
            remedy = 'give order = 2, say, or frequency = "50 Hz", or both'
            raise InputError("is needed with amplitude", key="order", remedy=remedy)
        for key in given:
            value = getattr(self, key)
            if not (value > 0 or (len(given) == 2 and value < 0)):
                problem, remedy = "must be positive", "a constant is a load_torque"
                if len(given) == 2:
                    problem, remedy = "must not be zero", "leave it out"
                raise InputError(problem, key=key, value=value, remedy=remedy)
        return self

    @model_validator(mode="after")
    def _one_amplitude(self) -> Self:
        given = [key for key in AMPLITUDES if getattr(self, key) not in (None, ())]
        if not given:
            raise InputError("is missing", key="amplitude", remedy='write order = 2 and amplitude = "40 N*m"')
        if len(given) > 1:
            raise InputError(f"conflicts with {given[0]}", key=given[1], remedy="leave one of the two out")
        if self.order is None and given != ["amplitude"]:
            remedy = "write amplitude, or order instead of frequency"
            raise InputError("belongs to an order of the rotation", key=given[0], remedy=remedy)
        self._check_table()
        return self

    def _check_table(self) -> None:
        if not self.amplitudes:
            lone = next((key for key in ("speeds", "torques", "phases") if getattr(self, key)), None)
            if lone:
                raise InputError("has no amplitudes beside it", key=lone, remedy='write amplitudes = ["40 N*m", ...]')
            return
        if not self.axes:
            remedy = 'give speeds = ["600 rpm", "1800 rpm"], say, or torques'
            raise InputError("is needed with amplitudes", key="speeds", remedy=remedy)
        for over, points in self.axes:
            if len(points) < 2:
                remedy = "write amplitude for what is constant"
                raise InputError("must have two points at least", key=over, value=list(points), remedy=remedy)
        counts = [len(points) for _, points in self.axes]
        for key in ("amplitudes", "phases"):
            values = getattr(self, key)
            if values and len(values) != prod(counts):
                each = f"each of {self.axes[0][0]}"
                if len(counts) == 2:
                    each = f"each of {counts[0]} speeds at each of {counts[1]} torques"
                raise InputError(f"must be {prod(counts)} quantities, one for {each}", key=key, value=list(values))
        for over, points in self.axes:
            if any(b <= a for a, b in pairwise(points)):
                raise InputError("must rise", key=over, value=list(points), remedy="sort them; each once")
        if self.speeds and self.speeds[0] < 0:
            raise InputError("must not be negative", key="speeds", value=self.speeds[0], remedy="turning counts as is")

    @cached_property
    def axes(self) -> tuple[tuple[str, tuple[float, ...]], ...]:
        """What its table goes over, "speeds" or "torques", and the points [rad/s], [N m]; none without a table."""
        stated = (("speeds", self.speeds), ("torques", self.torques))
        return tuple((over, points) for over, points in stated if points)

    def at_torque(self, torque: float) -> Self:
        """Of a table over both the one over speeds at a mean torque [N m] within it."""
        import numpy as np

        phases = np.array(self.phases) if self.phases else np.zeros(len(self.amplitudes))
        rows = (np.array(self.amplitudes) * np.exp(1j * phases)).reshape(len(self.torques), -1)
        found = [
            np.interp(torque, self.torques, row.real) + 1j * np.interp(torque, self.torques, row.imag) for row in rows.T
        ]
        return self.but(torques=None, amplitudes=tuple(map(abs, found)), phases=tuple(map(phase, found)))

    @property
    def stated_as(self) -> str:
        """The key that states its amplitude, of ``AMPLITUDES``."""
        return next(key for key in AMPLITUDES if getattr(self, key) not in (None, ()))

    @cached_property
    def largest(self) -> float:
        """The number that its amplitude follows from; of a table the largest |A| [N m]."""
        stated = getattr(self, self.stated_as)
        return max(abs(a) for a in stated) if isinstance(stated, tuple) else float(stated)

    @property
    def varies(self) -> bool:
        """Whether its amplitude depends on the speed or the load."""
        return self.amplitude is None

    @property
    def covers(self) -> str:
        """The range of its table in words, with four figures: mean torques follow from pressures."""
        return " and ".join(f"{_end(over, at[0])} to {_end(over, at[-1])}" for over, at in self.axes)

    def does_not_cover(self, over: str, value: float) -> str:
        """That its table ends before a ``value`` of "speeds" [rad/s] or "torques" [N m], as a problem."""
        of_disk = " of its disk" if over == "speeds" else ""
        return f"is a table from {self.covers}, which does not cover {_shown(over, value, 5)}{of_disk}"


def _end(over: str, value: float) -> str:
    return str(shown(value, SPEED, "rpm")) if over == "speeds" else _shown(over, value, 4)


def _shown(over: str, value: float, figures: int) -> str:
    value = float(f"{value:.{figures}g}") if over == "torques" else value
    return str(shown(value, TORQUE) if over == "torques" else shown(value, SPEED, "rpm", figures))


def harmonics(key: str, none: bool) -> Callable[[object], tuple[Excitation, ...]]:
    """Reads the harmonic torques that ``key`` states; ``none``: whether there may be none of them."""
    read = listed(Excitation, "harmonic torque", key=key, none=none)

    def tables(value: object) -> tuple[Excitation, ...]:
        refuse_name(value, key, "read_excitation")
        return read(value)

    return tables


Excitations = Annotated[TableList[Excitation], BeforeValidator(harmonics("excitation", none=True))]
