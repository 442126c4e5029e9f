"""Torques applied to disks from outside, piece by piece: between two knots of its tables each is a ratio of polynomials
of one or two of time, speed and angle, which the compiled right-hand side reads.

A motion is integrated from knot to knot: where a table bends or jumps the integration ends and begins again, at times
that are known beforehand and where a speed or an angle comes to a knot, which is located. Within a piece nothing jumps.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.applied_torque import AppliedTorque, FrictionTorque, TorqueFunction
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_regimes import line_kernel
from trunnion.errors import InputError
from trunnion.laws.formula import Formula, formula
from trunnion.laws.monotone_cubic import monotone_cubic
from trunnion.laws.torque_curve import KlossCurve

POWERS = 4
"""Powers of each variable, of which the kernel knows as many."""


class TorquePiece(NamedTuple):
    """One piece: where its two variables are counted from, the powers u^i v^j above, and those of v below."""

    first: float
    second: float
    above: Array
    below: Array


@dataclass(frozen=True)
class TorqueAxis:
    """One variable of a torque: "time", "speed" or "angle", its knots (m,), and whether it goes on beyond them, or
    below the first alone."""

    variable: str
    knots: Array
    hold: bool
    hold_below: bool = False

    def piece(self, value: float) -> int:
        """The piece that holds ``value``, at a knot the one above: −1 below the first knot, m − 1 above the last."""
        return int(np.searchsorted(self.knots, value, side="right")) - 1

    def inner(self, piece: int) -> int:
        """The nearest piece between two knots."""
        return int(np.clip(piece, 0, max(len(self.knots) - 2, 0)))

    def ends(self, piece: int) -> tuple[float, float]:
        """Lower and upper end of a piece."""
        low = self.knots[piece] if piece >= 0 else -np.inf
        return float(low), float(self.knots[piece + 1]) if piece + 1 < len(self.knots) else np.inf

    def powers(self, piece: int) -> Array:
        """Constant and slope (2, 2) of what goes straight between the two ends of a piece, of its values there."""
        if piece < 0:
            return np.array([[1.0, 0.0], [0.0, 0.0]])
        if piece >= len(self.knots) - 1:
            return np.array([[0.0, 1.0], [0.0, 0.0]])
        slope = 1 / (self.knots[piece + 1] - self.knots[piece])
        return np.array([[1.0, 0.0], [-slope, slope]])

    def beyond(self, piece: int) -> bool:
        """Whether a piece lies where the torque says nothing."""
        return not self.hold and not (0 <= piece < len(self.knots) - 1 or (piece < 0 and self.hold_below))


@dataclass(frozen=True)
class PlacedTorque:
    """A torque at a station of a line, in whose ``sense`` it and its disk's speed and angle count; ``lagged``: its
    number among those that lag."""

    stated: AppliedTorque
    station: int
    sense: float
    axes: tuple[TorqueAxis, ...]
    lagged: int = 0

    @cached_property
    def formula(self) -> Formula | None:
        """What is stated as a formula."""
        return None if self.stated.formula is None else formula(self.stated.formula)

    @cached_property
    def _through(self) -> Array:
        """Powers (4, piece) of the monotone cubic between its knots."""
        return np.asarray(monotone_cubic(self.axes[0].knots, self.stated.torque).c[::-1])

    @cached_property
    def called(self) -> CalledFunction | None:
        """What is stated as a function in Python."""
        return CalledFunction(self.stated.function) if isinstance(self.stated, TorqueFunction) else None

    @cached_property
    def program(self) -> Array:
        """What the kernel reads of a formula; the side of every kink is as it is."""
        if self.formula is None:
            return np.zeros(0)
        core, said = line_kernel(), self.formula
        head = [len(said.instructions), said.kinks, *[0.0] * said.kinks]
        steps = [number for one in said.instructions for number in (getattr(core, one.code), one.number)]
        return np.array([*head, *steps, *[0.0] * said.depth], dtype=float)

    def acts(self, pieces: Sequence[int]) -> bool:
        """Whether a formula or a function acts, between since and until."""
        if not self.axes:
            return True
        since, until = self.stated.since, self.stated.until
        return (since is None or pieces[0] >= 0) and (until is None or pieces[0] < len(self.axes[0].knots) - 1)

    @cached_property
    def _rows(self) -> dict[tuple[int, ...], Array]:
        """Rows of pieces that were asked for."""
        return {}

    @cached_property
    def _cells(self) -> dict[tuple[int, ...], TorquePiece]:
        """Pieces that were asked for."""
        return {}

    def cell(self, pieces: Sequence[int]) -> TorquePiece:
        """The polynomials of a piece of every axis; of what is a formula or a function, where it does not act."""
        known = tuple(pieces)
        if known not in self._cells:
            self._cells[known] = self._cell(known)
        return self._cells[known]

    def _cell(self, pieces: Sequence[int]) -> TorquePiece:
        if self.stated.by_program:
            return TorquePiece(0.0, 0.0, np.zeros((POWERS, POWERS)), _one())
        if self.stated.is_motor:
            return self._motor(pieces)
        if self.stated.power is not None:
            return self._power(pieces[0])
        if self.stated.table:
            return self._bilinear(pieces)
        return self._curve(pieces[0])

    def _curve(self, piece: int) -> TorquePiece:
        axis, torque, above = self.axes[0], np.array(self.stated.torque), np.zeros((POWERS, POWERS))
        below, knots = _one(), axis.knots
        if self.stated.between == "steps":
            above[0, 0] = torque[piece] if piece >= 0 else 0.0
            return TorquePiece(0.0, 0.0, above, below)
        if not 0 <= piece < len(knots) - 1:
            above[0, 0] = torque[0 if piece < 0 else -1]
            return TorquePiece(0.0, 0.0, above, below)
        low, high = knots[piece], knots[piece + 1]
        if self.stated.between == "cubic":
            above[:, 0] = self._through[:, piece]
        else:
            above[:2, 0] = torque[piece], (torque[piece + 1] - torque[piece]) / (high - low)
        return TorquePiece(float(low), 0.0, above, below)

    def _bilinear(self, pieces: Sequence[int]) -> TorquePiece:
        above, inner = np.zeros((POWERS, POWERS)), [a.inner(piece) for a, piece in zip(self.axes, pieces, strict=True)]
        corners = np.array(self.stated.table)[inner[0] : inner[0] + 2, inner[1] : inner[1] + 2]
        one, other = (axis.powers(piece) for axis, piece in zip(self.axes, pieces, strict=True))
        above[:2, :2] = one @ corners @ other.T
        first, second = (float(axis.knots[place]) for axis, place in zip(self.axes, inner, strict=True))
        return TorquePiece(first, second, above, _one())

    def _motor(self, pieces: Sequence[int]) -> TorquePiece:
        one = self.stated
        curve = KlossCurve(one.breakdown_torque, one.breakdown_slip, one.synchronous_speed)
        torque, under = (poly.coef for poly in curve.ratio(0.0))
        above, below = np.zeros((POWERS, POWERS)), np.zeros(POWERS)
        below[: len(under)] = under
        share, since = np.array([1.0, 0.0]), 0.0
        if one.factor:
            axis, factor, piece = self.axes[0], np.array(one.factor), pieces[0]
            if one.between == "steps":
                share[0] = factor[piece] if piece >= 0 else 0.0
            elif 0 <= piece < len(axis.knots) - 1:
                since = float(axis.knots[piece])
                share = np.array([factor[piece], (factor[piece + 1] - factor[piece]) / (axis.knots[piece + 1] - since)])
            else:
                share[0] = factor[0 if piece < 0 else -1]
        above[:2, : len(torque)] = np.outer(share, torque)
        return TorquePiece(since, 0.0, above, below)

    def _power(self, piece: int) -> TorquePiece:
        """P/ω between its two speeds; beyond them what it is there."""
        power, (low, high) = float(self.stated.power or 0.0), self.stated.speed
        above, below = np.zeros((POWERS, POWERS)), np.zeros(POWERS)
        if piece == 0:
            above[0, 0], below[1] = power, 1.0
            return TorquePiece(0.0, 0.0, above, below)
        above[0, 0] = power / (low if piece < 0 else high)
        return TorquePiece(0.0, 0.0, above, _one())

    def value(self, time: float, speed: float, angle: float) -> float:
        """The torque [N m] at a time, where its disk has this speed and angle, both in its own sense."""
        given = {"time": time, "speed": speed, "angle": angle, "": 0.0}
        if self.stated.by_program and self.acts([axis.piece(time) for axis in self.axes]):
            if self.called is not None:
                return self.called.value(time, speed, angle)
            return float(line_kernel().formula(self.program, 0, time, speed, angle, -1)[0])
        pieces = tuple(axis.piece(given[axis.variable]) for axis in self.axes)
        if pieces not in self._rows:
            self._rows[pieces] = self.row(pieces)
        return float(line_kernel().applied(self._rows[pieces], 0, time, angle, speed)[0])

    @property
    def first(self) -> str:
        """Its first variable; "" where there is none."""
        plain = self.stated.power is None and not self.stated.by_program
        return self.axes[0].variable if self.axes and plain else ""

    @property
    def second(self) -> str:
        """Its second variable: of a motor and of constant power its speed, else that of the second axis; "" where there
        is none."""
        if self.stated.is_motor or self.stated.power is not None:
            return "speed"
        return self.axes[1].variable if len(self.axes) > 1 else ""

    @property
    def lags(self) -> bool:
        """Whether it follows its own statement with a lag, so that its value is a state."""
        return self.stated.corner_frequency is not None

    def begun(self, time: float, speed: float, angle: float) -> float:
        """The torque [N m] that one that lags begins with: what it says before any step at that very time. What goes
        with the speed is switched on at standstill, and begins with none."""
        if speed == 0.0 and "speed" in self.stated.depends:
            return 0.0
        steps = self.stated.between == "steps" or self.stated.by_program
        jumps = steps and any(axis.variable == "time" and time in axis.knots for axis in self.axes)
        return self.value(float(np.nextafter(time, -np.inf)) if jumps else time, speed, angle)

    def row(self, pieces: Sequence[int], program: int = 0) -> Array:
        """What the kernel reads of a piece; ``program``: where that of a formula stands among the numbers."""
        core, cell = line_kernel(), self.cell(pieces)
        if self.stated.by_program and self.acts(pieces):
            code, place = (core.FORMULA, program) if self.called is None else (core.FUNCTION, self.called.address)
            head = [self.station, self.sense, self.sense, code, place, core.NONE, 0.0]
            return np.concatenate([head, cell.above.ravel(), cell.below, self._lag])
        codes = {"": core.NONE, "time": core.TIME, "speed": core.SPEED, "angle": core.TURNED}
        head = [self.station, self.sense, self.sense, codes[self.first], cell.first, codes[self.second], cell.second]
        return np.concatenate([head, cell.above.ravel(), cell.below, self._lag])

    @property
    def _lag(self) -> list[float]:
        """What the kernel reads of its lag."""
        return [float(self.stated.corner_frequency or 0.0), float(self.lagged)]


class CalledFunction:
    """A function in Python that the kernels call back; its error is kept, and a torque of NaN ends the run."""

    def __init__(self, function: Callable[[float, float, float], float]) -> None:
        self.function, self.error = function, None
        self._back = ctypes.CFUNCTYPE(ctypes.c_double, *[ctypes.c_double] * 3)(self._caught)
        self.address = ctypes.cast(self._back, ctypes.c_void_p).value or 0

    error: BaseException | None

    def value(self, time: float, speed: float, angle: float) -> float:
        """The torque [N m].

        Raises
        ------
        InputError : what the function gives is not a number. Anything that the function raises.
        """
        found = self.function(time, speed, angle)
        try:
            return float(found)
        except (TypeError, ValueError):
            raise InputError(
                "gives no number", element="torque", key="function", value=type(found).__name__,
                remedy="let it return the torque in N m",
            ) from None  # fmt: skip

    def _caught(self, time: float, speed: float, angle: float) -> float:
        if self.error is not None:
            return float("nan")
        try:
            return self.value(time, speed, angle)
        except BaseException as error:
            self.error = error
            return float("nan")


@dataclass(frozen=True)
class PlacedFriction:
    """Dry friction at a station, on the unknown rotation ``unknown``; ``turning`` is the sense of the station's speed
    over that of the first of its group."""

    stated: FrictionTorque
    station: int
    unknown: int
    first: int
    turning: float

    @property
    def knots(self) -> tuple[float, ...]:
        """Times at which it bends."""
        one = self.stated
        return tuple(t for t in (one.since, one.since + one.rise) if t > 0)

    def share(self, time: float) -> tuple[float, float]:
        """Share of its full size at and behind a time, and the share's slope [1/s] until the next knot."""
        one = self.stated
        if time < one.since:
            return 0.0, 0.0
        if one.rise and time < one.since + one.rise:
            return (time - one.since) / one.rise, 1 / one.rise
        return 1.0, 0.0

    def row(self, time: float, sense: float) -> Array:
        """What the kernel reads from ``time`` on while the first of the group turns in ``sense`` (0: stands)."""
        core = line_kernel()
        share, slope = self.share(time)
        above = np.zeros((POWERS, POWERS))
        above[:2, 0] = self.stated.torque * share, self.stated.torque * slope
        head = [self.station, -sense * self.turning, 1.0, core.TIME, time, core.NONE, 0.0]
        return np.concatenate([head, above.ravel(), _one(), [0.0, 0.0]])


def _one() -> Array:
    below = np.zeros(POWERS)
    below[0] = 1.0
    return below


def placed_torques(assembly: Assembly, torques: Sequence[AppliedTorque]) -> tuple[PlacedTorque, ...]:
    """The torques at their stations.

    Raises
    ------
    InputError : on a disk that a ConstantSpeed turns.
    """
    lagging = np.cumsum([one.corner_frequency is not None for one in torques]) - 1
    return tuple(_placed(assembly, one, max(int(k), 0)) for one, k in zip(torques, lagging, strict=True))


def _placed(assembly: Assembly, one: AppliedTorque, lagged: int) -> PlacedTorque:
    station = disk_station(assembly, one.on, "torque")
    hold = one.hold or one.between == "steps"
    if one.by_program:
        knots = [point for point in (one.since, one.until) if point is not None]
        own = (TorqueAxis("time", np.array(knots), hold=True),) if knots else ()
        return PlacedTorque(one, station, float(np.sign(assembly.topology.mean_speeds[station])), own, lagged)
    axes = tuple(TorqueAxis(key, np.array(getattr(one, key), dtype=float), hold, one.below) for key in one.variables)
    return PlacedTorque(one, station, float(np.sign(assembly.topology.mean_speeds[station])), axes, lagged)


def placed_frictions(assembly: Assembly, frictions: Sequence[FrictionTorque]) -> tuple[PlacedFriction, ...]:
    """The frictions at their stations.

    Raises
    ------
    InputError : on a disk that a ConstantSpeed turns.
    """
    topo, found = assembly.topology, []
    for one in frictions:
        station = disk_station(assembly, one.on, "friction")
        first = topo.reference[topo.group_of(station)]
        turning = float(np.sign(topo.mean_speeds[station] / topo.mean_speeds[first]))
        found.append(PlacedFriction(one, station, int(topo.unknown_of[station]), first, turning))
    return tuple(found)


def disk_station(assembly: Assembly, name: str, what: str) -> int:
    """The station of a disk that can move by itself.

    Raises
    ------
    InputError : a ConstantSpeed prescribes how it turns.
    """
    topo, names = assembly.topology, assembly.line.names
    station = next(s for s, i in topo.disks if names[i] == name)
    if topo.unknown_of[station] < 0:
        raise InputError(
            "moves nothing, for a ConstantSpeed prescribes how its disk turns", element=what, key="on", value=name,
            remedy="leave out the ConstantSpeed, or name a disk behind a spring",
        )  # fmt: skip
    return station


def time_knots(torques: Sequence[PlacedTorque], frictions: Sequence[PlacedFriction]) -> Array:
    """Times (m,) [s], rising, at which something bends or jumps."""
    every: Iterator[Array] = (axis.knots for one in torques for axis in one.axes if axis.variable == "time")
    return np.unique(np.concatenate([*every, *(np.array(one.knots) for one in frictions), np.zeros(0)]))
