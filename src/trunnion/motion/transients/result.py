"""A transient: torques, twists and speeds over time, what the line went through and where its energy went."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.driveline.elements import Rotor
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.quantities import TORQUE, against
from trunnion.equations.line_system import LineSystem
from trunnion.equations.speed_profile import SpeedProfile
from trunnion.errors import InputError
from trunnion.features import left_out
from trunnion.motion.simulation.input_rotation import InputRotation
from trunnion.motion.simulation.simulate import positive_time
from trunnion.motion.transients.energy import EnergyBalance, applied_torques, energy_balance, station_angles
from trunnion.motion.transients.engines import on_throws
from trunnion.motion.transients.place import LOCATED, Found, Piece, Place
from trunnion.motion.transients.prepare import Actions, follow, prepared_line
from trunnion.numerics.curves import Extremes, extremes_in
from trunnion.numerics.integration.integration import MOST_STEPS
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import internal, labelled
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.results.outcome import Outcome
from trunnion.results.result import Result
from trunnion.results.speeds import rounded_speed
from trunnion.results.variables import Attribute, Coordinate, Variable

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from trunnion.driveline.applied_torque import AppliedTorque, FrictionTorque
    from trunnion.driveline.driveline import Driveline
    from trunnion.driveline.scenarios import LevelCrossing

BACKWARDS = 0.02
"""Share of the largest speed beyond which a line that turns against its sense does more than swing."""
PER_STEP, FEWEST, MOST = 3, 400, 50_000
"""Samples a step, and of a whole run, at which it is shown."""


class Moving(NamedTuple):
    """Of times (m,): twist [rad] and torque [N m] of every spring (m, spring), positive with the twist; angle [rad] and
    speed [rad/s] of every station (m, station), and what is applied to it by torques and friction [N m]."""

    twist: Array
    torque: Array
    angle: Array
    speed: Array
    applied: Array


@labelled
class Transient(Result):
    """A motion of a line under torques over time, speed and angle.

    ``time`` (points,) [s]; ``torque`` [N m] and ``twist`` [rad] of every spring (points, spring), positive with the
    twist; ``speed`` [rad/s] and ``angle`` [rad] of every disk (points, disk) in its own sense of rotation; ``applied``
    (points, disk) [N m], what torques and friction put on it, positive where it drives. Peaks are found on the dense
    output. ``then`` goes on from the end.
    """

    line: LineSystem = internal("with the numbers that it ends with")
    pieces: tuple[Piece, ...] = internal("between switches")
    place: Place = internal("where it ends")
    outcome: Outcome = internal("how it ended")
    crossings: tuple[tuple[float, str], ...] = internal("times [s] and what was crossed there")
    tolerance: float = internal("allowed per step")
    start_time: float = internal("", "s")
    name: str = internal("of the scenario")
    description: Any = internal("of the line as it was given")
    asked: Actions = internal("torques, frictions and crossings")
    unit: str = internal("that speeds are printed in")

    @property
    def end(self) -> float:
        """The last time [s]."""
        return self.place.time

    @property
    def steps(self) -> int:
        """Steps taken."""
        return sum(piece.trajectory.steps for piece in self.pieces)

    @property
    def shafts(self) -> tuple[str, ...]:
        """Names of the springs; massless shafts in series count as one."""
        return self.line.shafts

    @cached_property
    def disks(self) -> tuple[str, ...]:
        """Names of the disks."""
        names = self.line.assembly.line
        return tuple(n for n, e in names.parts if isinstance(e, Rotor))

    @cached_property
    def _stations(self) -> list[int]:
        topo, names = self.line.assembly.topology, self.line.assembly.line.names
        by_name = {names[i]: s for s, i in topo.disks}
        return [by_name[name] for name in self.disks]

    @cached_property
    def _senses(self) -> Array:
        return np.sign(self.line.assembly.topology.mean_speeds[self._stations])

    @cached_property
    def cuts(self) -> Array:
        """Times (steps + 1,) [s] between which the motion is smooth."""
        every = [piece.trajectory.time_of_state[:-1] for piece in self.pieces]
        return np.concatenate([*every, [self.end]])

    @cached_property
    def time(self) -> Array:
        """Times (points,) [s], even."""
        if self.end == self.start_time:
            return np.array([self.end])
        return np.linspace(self.start_time, self.end, int(np.clip(PER_STEP * self.steps, FEWEST, MOST)) + 1)

    def at(self, time: ArrayLike, *, applied: bool = True) -> Moving:
        """Twists, torques, angles and speeds at times (m,) of the run, to about ten times the tolerance; with what is
        ``applied`` to disks, or zeros in its place."""
        times = np.atleast_1d(np.asarray(time, dtype=float))
        order = np.argsort(times, kind="stable")
        rising = times[order]
        begins = np.array([piece.trajectory.start[0] for piece in self.pieces])
        places = np.searchsorted(rising, np.append(begins[1:], np.inf))
        parts, low = [], 0
        for piece, high in zip(self.pieces, places, strict=True):
            if high > low:
                parts.append(_moving(piece, rising[low:high], applied))
            low = high
        whole = [np.concatenate(columns) for columns in zip(*parts, strict=True)]
        back = np.argsort(order, kind="stable")
        return Moving(*(columns[back] for columns in whole))

    motion_at = at
    """As ``LineSimulation`` calls it."""

    def torque_at(self, time: ArrayLike) -> Array:
        """Torque (m, spring) [N m] at times (m,) of the run."""
        return self.at(time, applied=False).torque

    @cached_property
    def moving(self) -> Moving:
        """All of it at ``time``."""
        return self.at(self.time)

    @property
    def twist(self) -> Array:
        """Twist [rad] of every spring (points, spring)."""
        return self.moving.twist

    @property
    def torque(self) -> Array:
        """Torque [N m] of every spring (points, spring), positive with the twist."""
        return self.moving.torque

    @property
    def speed(self) -> Array:
        """Speed [rad/s] of every disk (points, disk), in its own sense of rotation."""
        return self.moving.speed[:, self._stations] * self._senses

    @property
    def angle(self) -> Array:
        """Angle [rad] of every disk (points, disk), in its own sense of rotation."""
        return self.moving.angle[:, self._stations] * self._senses

    @property
    def applied(self) -> Array:
        """What torques and friction put on every disk (points, disk) [N m], positive where it drives."""
        return self.moving.applied[:, self._stations] * self._senses

    @cached_property
    def torque_extremes(self) -> Extremes:
        """Lowest and highest torque of every spring [N m], and when."""
        return extremes_in(self.torque_at, self.cuts, np.array([self.start_time, self.end])).of(0)

    @property
    def peak_torque(self) -> Array:
        """Largest |torque| of every spring (spring,) [N m]."""
        return self.torque_extremes.largest

    @property
    def peak_time(self) -> Array:
        """When that was (spring,) [s]."""
        found = self.torque_extremes
        return np.where(np.abs(found.low) > np.abs(found.high), found.low_at, found.high_at)

    @cached_property
    def energy(self) -> EnergyBalance:
        """Where the energy came from and went."""
        return energy_balance(self.pieces)

    # What an order map needs.

    @property
    def starts_free(self) -> bool:
        """Whether nothing prescribes how the line turns."""
        return self.line.assembly.topology.free

    @property
    def profile(self) -> SpeedProfile:
        """The speed that rotations are compared with."""
        return SpeedProfile([0.0], [max(abs(self.line.speed), 1.0)])

    @cached_property
    def whole(self) -> InputRotation:
        """How the whole line turned, Σ Jρφ/Σ Jρ² over the input's mean speed."""
        return InputRotation(self.profile, self.end, self.cuts, self._mean_deviation)

    def _mean_deviation(self, times: Array) -> tuple[Array, Array]:
        topo, found = self.line.assembly.topology, self.at(times, applied=False)
        if topo.free:
            share = self.line.shares(self.line.untwisted(self.line.assembly.table(1, self.line.speed)).inertia[0])
            angle, speed = found.angle[:, topo.firsts] @ share, found.speed[:, topo.firsts] @ share
        else:
            angle, speed = found.angle[:, 0], found.speed[:, 0]
        return angle - self.profile.angle(times), speed - self.profile.at(times)

    # Words, data and pictures.

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """What to read first: limits exceeded, standstill, turning back, an energy balance that is not close."""
        own = left_out("transient", self.description)
        return by_gravity([*own, *self._judged(), *self._moved(), *self._balanced()])

    def _judged(self) -> Iterator[Finding]:
        peaks = dict(zip(self.shafts, self.peak_torque, strict=True))
        for limit in self.line.assembly.line.limits_by_element:
            names = [name for name in self.shafts if limit.element in name.split(" + ")]
            if limit.key != "max_torque" or not names:
                continue
            peak, most = float(peaks[names[0]]), limit.value * (1 - limit.margin)
            said = f"{limit.element} comes to {against(peak, most, TORQUE)}"
            spare = f" less its margin of {limit.margin:.0%}" if limit.margin else ""
            if peak > most:
                yield Finding(Gravity.DANGER, f"{said} of max_torque{spare}, which it exceeds by {peak / most - 1:.1%}")
            else:
                yield Finding(Gravity.NOTE, f"{said} of max_torque{spare}, {peak / most:.0%} of it")

    def _moved(self) -> Iterator[Finding]:
        speed, least = self.speed, 1e-9 * max(self.line.speed, 1.0)
        standing = [one.on for one in self.asked[1] if self.place.senses.get(self._first(one.on), 1.0) == 0.0]
        if not np.abs(speed).max(initial=0.0) > least:
            held = f"static friction on {' and '.join(standing)} holds it" if standing else "nothing moves it"
            yield Finding(Gravity.CAUTION, f"the line never moves: {held}; raise the torque, or lower the friction")
            return
        if self.starts_free:
            mean = self._mean_deviation(self.time)[1] + self.profile.at(self.time)
            back = np.flatnonzero(mean < -BACKWARDS * np.abs(mean).max())
            if len(back) and mean[0] >= -least:
                words = f"the line turns backwards from t = {self.time[back[0]]:.4g} s on"
                yield Finding(Gravity.CAUTION, f"{words}: its torques drive it against its sense of rotation")

    def _first(self, name: str) -> int:
        topo = self.line.assembly.topology
        return topo.reference[topo.group_of(self._stations[self.disks.index(name)])]

    def _balanced(self) -> Iterator[Finding]:
        if self.energy.error > 1e-6:
            words = f"the energy balance lacks {self.energy.error:.1g} of what is turned over; lower the tolerance"
            yield Finding(Gravity.CAUTION, words)

    def declared(self) -> Iterator[Variable | Attribute]:
        """Torques and twists of springs, speeds and angles of disks, over time; crossings and the energy balance."""
        yield Coordinate("time", self.time, "time", "s")
        yield Coordinate("shaft", np.array(self.shafts), "shaft")
        yield Coordinate("disk", np.array(self.disks), "disk")
        yield Variable("torque", self.torque, "time shaft", "N*m", "positive with the twist")
        yield Variable("twist", self.twist, "time shaft", "rad")
        yield Variable("speed", self.speed, "time disk", "rad/s", "in its own sense of rotation")
        yield Variable("angle", self.angle, "time disk", "rad", "in its own sense of rotation")
        yield Variable("applied", self.applied, "time disk", "N*m", "torques and friction, positive where they drive")
        yield Variable("peak_torque", self.peak_torque, "shaft", "N*m", "largest size")
        yield Variable("peak_time", self.peak_time, "shaft", "s")
        yield Variable("crossing_time", np.array([t for t, _ in self.crossings]), "crossing", "s")
        yield Variable("crossing_name", np.array([name for _, name in self.crossings], dtype=str), "crossing")
        yield Attribute("driveline", self.line.system.name)
        if self.name:
            yield Attribute("scenario", self.name)
        yield Attribute("outcome", self.outcome.kind)
        yield Attribute("says", self.outcome.sentence)
        for key in ("kinetic", "elastic", "applied", "excitation", "input", "loads", "friction", "losses"):
            yield Attribute(f"energy_{key}", getattr(self.energy, key))
        yield Attribute("energy_error", self.energy.error)
        yield Attribute("tolerance", self.tolerance)
        yield Attribute("steps", self.steps)

    def _lines(self) -> Iterator[str]:
        first, last = self.speed[0], self.speed[-1]
        what = f"{self.name} of {self.line.system.name}" if self.name else f"transient of {self.line.system.name}"
        yield f"{what} over {self.end - self.start_time:.6g} s: {self.outcome}"
        for name, begin, end in zip(self.disks, first, last, strict=True):
            yield f"  {name}: from {rounded_speed(float(begin), self.unit)} to {rounded_speed(float(end), self.unit)}"
        for name, peak, at in zip(self.shafts, self.peak_torque, self.peak_time, strict=True):
            yield f"  {name}: largest torque {peak:.6g} N m at t = {at:.4g} s"
        for at, name in self.crossings:
            yield f"  t = {at:.6g} s: {name}"
        yield f"  energy balance closes to {self.energy.error:.1g} of {self.energy.turned_over:.4g} J turned over"

    def plot(self, axes: Axes | None = None, *, shafts: tuple[str, ...] = (), unit: str = "") -> Axes:
        """Torques and speeds over time; see ``pictures.transients``."""
        return drawing(self, "plot")(self, axes, shafts=shafts, unit=unit)

    def plot_plane(self, axes: Axes | None = None, *, disk: str = "", unit: str = "") -> Axes:
        """Torque applied to a disk over its speed; see ``pictures.transients``."""
        return drawing(self, "plot_plane")(self, axes, disk=disk, unit=unit)

    def plot_order_map(
        self, axes: Axes | None = None, *, shaft: str = "", window: int = 8, highest: float = 12.0, unit: str = ""
    ) -> Axes:
        """Torque spectrum over time by the line's true rotation; see ``pictures.transients``."""
        return drawing(self, "plot_order_map")(self, axes, shaft=shaft, window=window, highest=highest, unit=unit)

    def then(
        self,
        duration: float,
        *,
        torque: Sequence[AppliedTorque] | None = None,
        friction: Sequence[FrictionTorque] | None = None,
        crossing: Sequence[LevelCrossing] | None = None,
        line: Driveline | None = None,
        tolerance: float | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> Transient:
        """The run, gone on with for another ``duration`` [s]: angles, twists and the clock go on.

        Parameters
        ----------
        torque, friction, crossing : instead of those before; times are those of the whole run.
        line : another line from here on, of the same disks and springs.
        progress : called as progress(share of the further run done).

        Raises
        ------
        InputError : a line of other disks or springs; what ``transient`` refuses.
        """
        given = (torque, friction, crossing)
        asked: Any = tuple(old if new is None else tuple(new) for old, new in zip(self.asked, given, strict=True))
        description = self.description if line is None else line
        asked = (*on_throws(asked[0], asked[1], description.parts), asked[2])
        prepared, acting = prepared_line(description, asked, self.line.speed)
        same = prepared.names == self.line.names and prepared.shafts == self.line.shafts
        if not same or len(prepared.sliders) != len(self.line.sliders):
            remedy = "change numbers of the same line alone"
            raise InputError("has other disks or springs than the run", key="line", remedy=remedy)
        place = self.place
        if line is not None:
            own, lags = np.split(place.state, [len(place.state) - len(place.lagging)])
            place = replace(place, state=np.concatenate([prepared.system.within_limits(own), lags]), regime=LOCATED)
        tolerance = self.tolerance if tolerance is None else tolerance
        length = positive_time(duration, "give seconds")
        found = follow(prepared, place, length, acting, tolerance, MOST_STEPS, progress=progress)
        return self.joined(Transient.of(prepared, found, asked, tolerance, place.time, self.name, description))

    @classmethod
    def of(
        cls, line: LineSystem, found: Found, asked: Actions, tolerance: float, since: float, name: str,
        description: Driveline,
    ) -> Self:  # fmt: skip
        """What was found of a line from ``since`` [s] on."""
        return cls(
            line=line, pieces=tuple(found.pieces), place=found.place, outcome=found.outcome,
            crossings=tuple(found.crossed), tolerance=tolerance, start_time=since, name=name, description=description,
            asked=asked, unit=speed_unit(line.assembly.line),
        )  # fmt: skip

    def joined(self, later: Transient) -> Self:
        """This run and what comes behind it, as one."""
        return replace(
            self,
            line=later.line,
            pieces=self.pieces + later.pieces,
            place=later.place,
            outcome=later.outcome,
            crossings=self.crossings + later.crossings,
            asked=later.asked,
            description=later.description,
            tolerance=max(self.tolerance, later.tolerance),
        )


def _moving(piece: Piece, times: Array, acting: bool) -> Moving:
    states = piece.trajectory.at(times)
    motion, speed = piece.line.moving(times, states, piece.numbers, piece.regime_at(times))
    angle = station_angles(piece, times, motion.rotation)
    applied, places = np.zeros(speed.shape), [one.station for one in piece.acting]
    if acting:
        np.add.at(applied.T, places, applied_torques(piece, times, states, angle, speed).T)
    return Moving(motion.twist, motion.torque, angle, speed, applied)
