"""A motion in time: of a system, or of a driveline with its twists, its torques and how its input turned."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Integers
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.amplitudes_by_speed import table_left
from trunnion.equations.line_regimes import LineRegimes
from trunnion.equations.line_system import LineMotion, LineSystem
from trunnion.equations.speed_profile import SpeedProfile
from trunnion.equations.steady_base import imbalance
from trunnion.errors import InputError
from trunnion.motion.simulation.input_rotation import TURN, InputRotation
from trunnion.numerics.curves import Extremes, extremes_in
from trunnion.numerics.integration.integration import Trajectory, joined
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, computed, coordinate, internal, labelled, variable
from trunnion.results.of_systems import about, ending, states
from trunnion.results.outcome import Outcome
from trunnion.results.quantity_axes import state_axes
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Coordinate, Variable
from trunnion.systems.system import System

GAUSS, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(8)


@labelled
class Simulation:
    """A motion in time; ``at`` gives the state anywhere between."""

    system: System = internal("that was integrated", repr=False)
    trajectory: Trajectory = internal("the steps taken", repr=False)
    outcome: Outcome = internal("how it ended")
    tolerance: float = attribute("error allowed per step")
    guards: tuple[str, ...] = internal("names of the events, own guards first")
    times: Array | None = internal("those asked for, None for every step", "s")

    @cached_property
    @computed(coordinate("time", "s"))
    def time(self) -> Array:
        """Times (points,) [s] where asked for; by default at every step."""
        run, wanted = self.trajectory, self.times
        return run.time_of_state if wanted is None else wanted[wanted <= run.time]

    @cached_property
    def state(self) -> Array:
        """States (points, n) at ``time``."""
        return self.trajectory.state if self.times is None else self.at(self.time)

    @property
    def event_time(self) -> Array:
        """Times of all events (events,) [s]."""
        return self.trajectory.event_time

    @property
    def final(self) -> Array:
        """The last state (n,)."""
        return self.trajectory.final[0]

    @property
    def end(self) -> float:
        """The last time [s]."""
        return self.trajectory.time

    @property
    @computed(attribute())
    def steps(self) -> int:
        """Steps taken."""
        return self.trajectory.steps

    @property
    def cuts(self) -> Array:
        """Times (steps + 1,) [s] between which the motion is smooth."""
        return self.trajectory.time_of_state

    @property
    def time_range(self) -> tuple[float, float]:
        """First and last time [s]."""
        return float(self.cuts[0]), self.end

    @property
    def is_dense(self) -> bool:
        """Whether states between steps are known."""
        return len(self.trajectory.coefficients) > 0 or not self.steps

    def at(self, time: ArrayLike) -> Array:
        """States at any times of the run, (..., n), to about ten times the tolerance; NaN outside it.

        Raises
        ------
        InputError : the run was made with ``dense=False``.
        """
        if not self.is_dense:
            raise InputError("was left out", element="simulation", key="dense", value=False, remedy="set dense=True")
        times, (first, last) = np.asarray(time, dtype=float), self.time_range
        inside = (times >= first) & (times <= last)
        found = self.trajectory.at(np.where(inside, times, first))
        return np.asarray(np.where(inside[..., None], found, np.nan))

    def regime_at(self, time: Array) -> Integers:
        """Number of the regime (m,) at times (m,) of the run."""
        run = self.trajectory
        if not run.steps:
            return np.full(len(time), run.final_regime, dtype=np.int64)
        return run.regime[np.searchsorted(run.start[1:], time, side="right")]

    def without_dense_output(self) -> Self:
        """The same without what ``at`` needs."""
        return replace(self, trajectory=replace(self.trajectory, coefficients=self.trajectory.coefficients[:0]))


@labelled
class SystemSimulation(Result, Simulation):
    """A motion of a system, its states (points, n) over time."""

    @property
    @computed(variable("time"))
    def regime(self) -> Integers:
        """Number of the regime (points,)."""
        return self.regime_at(self.time)

    @property
    def event_name(self) -> tuple[str, ...]:
        """Names of the events (events,)."""
        return tuple(self.guards[int(i)] for i in self.trajectory.event_which)

    @property
    @computed(variable("event state", name="state_before"))
    def event_before(self) -> Array:
        """States (events, n) before each event."""
        return self.trajectory.event_before

    @property
    @computed(variable("event state", name="state_after"))
    def event_after(self) -> Array:
        """States (events, n) behind each event."""
        return self.trajectory.event_after

    @cached_property
    def range(self) -> tuple[Array, Array]:
        """Smallest and largest value (n,) of every state from the first to the last of ``time``: found on the dense
        output; among the steps without it, or where a right-hand side that fails left it without numbers."""
        run = self.trajectory
        dense = len(run.coefficients) > 0 and bool(np.isfinite(run.coefficients).all())
        if not dense or len(self.time) < 2:
            return self.state.min(axis=0), self.state.max(axis=0)
        found = extremes_in(run.at, run.time_of_state, self.time[[0, -1]]).of(0)
        return found.low, found.high

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, every state by its name, the located events, and the system."""
        yield from states(self.system, "time", self.state)
        yield from super().declared()
        yield Coordinate("state", self.system.states, "state")
        yield Variable("event_time", self.event_time, "event", "s")
        yield Variable("event_name", np.array(self.event_name, dtype=str), "event")
        yield Attribute("tangents", "exact" if self.system.exact_tangents else "differenced")
        yield from about(self.system, self.outcome)

    def plot(self, axes: Axes | None = None, *, states: tuple[str, ...] = ()) -> Axes:
        """Time histories; see ``pictures.motion``."""
        return drawing(self, "plot")(self, axes, states=states)

    def plot_portrait(self, axes: Axes | None = None, *, x: str = "", y: str = "", from_time: float = 0.0) -> Axes:
        """One state over another; see ``pictures.motion``."""
        return drawing(self, "plot_portrait")(self, axes, x=x, y=y, from_time=from_time)

    def __str__(self) -> str:
        low, high = self.time_range
        least, most = self.range
        axes = state_axes(self.system)
        rows = [
            f"  {name}: {least[i] * axis.factor:.6g} … {axis.number(float(most[i]))}, at the end "
            f"{self.final[i] * axis.factor:.10g}"
            for i, (name, axis) in enumerate(zip(self.system.states, axes, strict=True))
        ]
        events = f", {len(self.event_time)} events" if self.event_name else ""
        head = (
            f"motion of {self.system.name} from t = {low:g} to {high:.6g} s: {self.steps} steps at "
            f"tolerance {self.tolerance:g}{events}"
        )
        return "\n".join([head, *rows, f"  {self.outcome}"])


class OfShafts(ABC):
    """What a motion of a line shows of its shafts."""

    line: LineSystem

    @property
    @abstractmethod
    def time(self) -> Array:
        """Times (points,) [s] that are shown."""

    @abstractmethod
    def motion_at(self, time: ArrayLike) -> LineMotion:
        """Twists, torques and rotations at times (m,) of the motion."""

    @cached_property
    def motion(self) -> LineMotion:
        """Twists, torques and rotations at ``time``."""
        return self.motion_at(self.time)

    @property
    @computed(variable("time shaft", "rad"))
    def twist(self) -> Array:
        """Twist [rad] of every shaft, (points, shaft)."""
        return self.motion.twist

    @property
    @computed(variable("time shaft", "N*m"))
    def torque(self) -> Array:
        """Torque [N m] of every shaft (points, shaft), positive with the twist."""
        return self.motion.torque

    @property
    @computed(coordinate("shaft"))
    def shafts(self) -> tuple[str, ...]:
        """Names of the shafts; massless shafts in series count as one."""
        return self.line.shafts


@labelled
class LineSimulation(Result, Simulation, OfShafts):
    """A motion of a line.

    rotation (points, coordinate): deviation [rad] from the uniform rotation of ``profile``, and rate [rad/s]; twist
    [rad] and torque [N m] of every shaft (points, shaft), positive with the twist.

    ``rotation`` of the input, its ``input_speed`` and the ``turns`` it made are those of the profile where a
    ConstantSpeed prescribes them, and those of its own rotation where the line is free–free.
    """

    line: LineSystem = internal("that moved")
    profile: SpeedProfile = internal("of the input speed")
    pieces: tuple[Simulation, ...] = internal("one motion per straight piece of the speed profile")
    unit: str = internal("of speeds in print")

    @classmethod
    def of(cls, line: LineSystem, profile: SpeedProfile, pieces: Sequence[Simulation]) -> Self:
        """Pieces that follow each other, at the end of the last."""
        one, last = pieces[0].trajectory, pieces[-1]
        run = one if len(pieces) == 1 else joined([piece.trajectory for piece in pieces])
        shared: dict[str, Any] = {name: getattr(last, name) for name in Simulation.__dataclass_fields__}
        shared |= {"trajectory": run, "times": np.array([last.end])}
        unit = speed_unit(line.assembly.line)
        return cls(**shared, line=line, profile=profile, pieces=tuple(pieces), unit=unit)

    def motion_at(self, time: ArrayLike) -> LineMotion:
        """Twists, torques and rotations at times (m,) of the run."""
        return LineMotion(*self._observed(time, LineMotion._fields))

    def torque_at(self, time: ArrayLike) -> Array:
        """Torque (m, shaft) [N m] of every shaft at times (m,) of the run."""
        return self._observed(time, ("torque",))[0]

    def _observed(self, time: ArrayLike, names: tuple[str, ...]) -> list[Array]:
        def observe(piece: Simulation, times: Array, states: Array) -> tuple[Array, ...]:
            motion = self.line.observe(piece.system, times, states, piece.regime_at(times))
            return tuple(getattr(motion, name) for name in names)

        return self._of_pieces(time, observe)

    def _of_pieces(
        self, time: ArrayLike, observe: Callable[[Simulation, Array, Array], tuple[Array, ...]]
    ) -> list[Array]:
        """What is observed of each piece at the times (m,) in it; NaN outside the run."""
        times = np.atleast_1d(np.asarray(time, dtype=float))
        order = np.argsort(times, kind="stable")
        states, times = self.at(times[order]), times[order]
        ends = np.searchsorted(times, [*(piece.time_range[0] for piece in self.pieces), np.nextafter(self.end, np.inf)])
        parts = [
            observe(piece, times[i:j], states[i:j]) for piece, i, j in zip(self.pieces, ends, ends[1:], strict=False)
        ]
        whole = []
        for columns in zip(*parts, strict=True):
            found = np.full((len(times), columns[0].shape[1]), np.nan)
            found[order[ends[0] : ends[-1]]] = np.concatenate(columns)
            whole.append(found)
        return whole

    @property
    def clutches(self) -> tuple[str, ...]:
        """Names of the slip clutches."""
        return tuple(clutch.name for clutch in self.line.clutches)

    def slip_at(self, time: ArrayLike) -> tuple[Array, Array]:
        """Slip speed [rad/s] and torque [N m] of every slip clutch (m, clutch) at times (m,) of the run."""

        def observe(piece: Simulation, times: Array, states: Array) -> tuple[Array, ...]:
            return self.line.slip(times, states, piece.system.numbers, piece.regime_at(times))

        slip, torque = self._of_pieces(time, observe)
        return slip, torque

    @property
    def slip(self) -> Array:
        """Slip speed [rad/s] of every slip clutch (points, clutch), positive where its output leads."""
        return self.slip_at(self.time)[0]

    @cached_property
    def slip_heat(self) -> Array:
        """Heat ∫|T v| dt [J] of every slip clutch (clutch,), and the angle ∫|v| dt [rad] by which it slipped, over the
        whole run: (2, clutch). Gauss's rule in every step."""
        begin, length = self.cuts[:-1, None], np.diff(self.cuts)[:, None]
        times = begin + length * (1 + GAUSS) / 2
        slip, torque = self.slip_at(times.ravel())
        weights = (length * GAUSS_WEIGHTS / 2).ravel()
        slips = np.logical_not(self._sticks(times.ravel()))
        return np.array([weights @ (np.abs(torque * slip) * slips), weights @ (np.abs(slip) * slips)])

    def _sticks(self, times: Array) -> Array:
        """Whether each slip clutch sticks (m, clutch)."""
        regimes = self.pieces[0].system.regimes
        assert isinstance(regimes, LineRegimes)
        return regimes.clutches_stick(np.asarray(self.regime_at(times)))

    @property
    def starts_free(self) -> bool:
        """Whether nothing prescribes how the line turns."""
        return self.line.assembly.topology.free

    @cached_property
    def input(self) -> InputRotation:
        """How the input turned."""
        return InputRotation(self.profile, self.end, self.cuts, self._deviation if self.starts_free else None)

    def _deviation(self, times: Array) -> tuple[Array, Array]:
        """Deviation of the input [rad] from the profile and its rate [rad/s]."""
        states, place = self.at(times), self._place
        return states[:, place], states[:, len(self.line.names) + place]

    @cached_property
    def whole(self) -> InputRotation:
        """How the whole line turned, Σ Jρφ/Σ Jρ² over the input's mean speed: as the input, but for its vibration."""
        return InputRotation(self.profile, self.end, self.cuts, self._mean_deviation if self.starts_free else None)

    def _mean_deviation(self, times: Array) -> tuple[Array, Array]:
        """Deviation of the mean rotation [rad] from the profile and its rate [rad/s]."""
        states, n = self.at(times), len(self.line.names)
        return states[:, :n] @ self._share, states[:, n : 2 * n] @ self._share

    @cached_property
    def _share(self) -> Array:
        line = self.line
        return line.shares(line.untwisted(line.assembly.table(1, self.profile.speed[0])).inertia[0])

    @property
    def _place(self) -> int:
        """Of the input among the unknown rotations of a free–free line."""
        return int(self.line.assembly.topology.unknown_of[0])

    @property
    @computed(variable("time", "rad/s"))
    def input_speed(self) -> Array:
        """Input speed [rad/s] at ``time``."""
        return self.input.speed(self.time)

    @cached_property
    def beyond_table(self) -> str:
        """That a free–free line turned at speeds beyond the table of an excitation, whose amplitude is held there, as a
        clause; "" where it did not."""
        row = self.line.assembly.table(1, self.profile.speed[0])
        leaves = len(self.profile.time) > 1 or imbalance(self.line.assembly, row)[0]
        speed = self.whole.turns[1] if self.starts_free and leaves else np.zeros(0)
        if not len(speed):
            return ""
        left = table_left(self.line, row[0], min(self.profile.speed), max(self.profile.speed), speed)
        if left is None:
            return ""
        at = self.words.rounded(left[1])
        return f"at {at} the line left the table of {left[0]}, whose amplitude is held beyond its ends"

    @property
    def turns(self) -> float:
        """Turns that the input made."""
        angle = float(self.profile.angle(self.end))
        if self.starts_free:
            angle += float(self.final[self._place] - self.trajectory.state[0, self._place])
        return angle / TURN

    @property
    def torque_peak_to_peak(self) -> Array:
        """Largest minus smallest torque of every shaft [N m] from the first to the last of ``time``."""
        return self.torque_extremes.span

    @cached_property
    def torque_extremes(self) -> Extremes:
        """Lowest and highest torque of every shaft [N m] from the first to the last of ``time``, and when; found on the
        dense output, whose error is about ten times the tolerance."""
        return extremes_in(self.torque_at, self.cuts, self.time[[0, -1]]).of(0)

    def declared(self) -> Iterator[Variable | Attribute]:
        """Deviations and rates of every inertia, what the fields hold, the input's rotation and the ending."""
        n = len(self.line.names)
        yield Coordinate("coordinate", self.line.names, "coordinate")
        yield Variable("rotation", self.state[:, :n], "time coordinate", "rad")
        yield Variable("rate", self.state[:, n : 2 * n], "time coordinate", "rad/s")
        if self.line.sliders:
            yield Coordinate("slider", [slider.name for slider in self.line.sliders], "slider")
            yield Variable("deflection", self.state[:, 2 * n :], "time slider", "rad")
        yield from super().declared()
        if self.clutches:
            yield Coordinate("clutch", self.clutches, "clutch")
            yield Variable("slip", self.slip, "time clutch", "rad/s", "positive where the output leads")
            if self.is_dense:
                heat, angle = self.slip_heat
                yield Variable("slip_heat", heat, "clutch", "J", "of the whole run")
                yield Variable("slip_angle", angle, "clutch", "rad", "by which it slipped, either way")
        yield Variable("input_angle", self.input.angle(self.time), "time", "rad")
        if self.starts_free:
            words = "that rotations deviate from"
            yield Variable("reference_speed", self.profile.at(self.time), "time", "rad/s", words)
        yield Attribute("driveline", self.system.name)
        if self.beyond_table:
            yield Attribute("beyond_table", self.beyond_table)
        yield from ending(self.outcome)

    def plot(self, axes: Axes | None = None, *, shafts: tuple[str, ...] = (), unit: str = "") -> Axes:
        """Torques over time; see ``pictures.motion``."""
        return drawing(self, "plot")(self, axes, shafts=shafts, unit=unit)

    def plot_order_map(
        self, axes: Axes | None = None, *, shaft: str = "", window: int = 8, highest: float = 12.0, unit: str = ""
    ) -> Axes:
        """Torque spectrum over time or speed; see ``pictures.motion.map_of_orders``."""
        return drawing(self, "plot_order_map")(self, axes, shaft=shaft, window=window, highest=highest, unit=unit)

    def _lines(self) -> Iterator[str]:
        yield f"motion of {self.system.name} over {self.end:.6g} s ({self.turns:.6g} turns): {self.steps} steps"
        if self.starts_free:
            yield f"  {self._turning}"
            if self.beyond_table:
                yield f"  {self.beyond_table}"
        extremes = self.torque_extremes
        for name, low, high in zip(self.shafts, extremes.low, extremes.high, strict=True):
            yield f"  {name}: torque {low:.6g} … {high:.6g} N m"
        yield from self._slips()
        yield f"  {self.outcome}"

    def _slips(self) -> Iterator[str]:
        """How far every slip clutch slipped, and what heat that was."""
        if self.clutches and self.is_dense:
            for name, heat, angle in zip(self.clutches, *self.slip_heat, strict=True):
                slips = f"slips by {np.rad2deg(angle):.4g} deg, {heat:.4g} J of heat"
                yield f"  {name}: {slips if angle else 'sticks'}"

    @property
    def _turning(self) -> str:
        """How fast a free–free line turned."""
        speed, last = self.whole.turns[1], self.whole.last_turn()[1]
        if not len(speed):
            made = f"it made {self.whole.furthest / (2 * np.pi):.3g} of a turn"
            return f"the line is free–free: {made}, at {self.words.rounded(last)} on average"
        back = self.whole.turned_back
        if back is not None:
            return f"the line is free–free: it turns back at t = {back:.4g} s"
        return (
            f"the line is free–free: it turns at {self.words.rounded(float(speed[0]))} in its first turn and at "
            f"{self.words.rounded(last)} in its last"
        )
