"""The motion of a line in time, and how its input turns: as prescribed, or by itself where the line starts free."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.line_system import LineMotion, LineSystem
from trunnion.equations.speed_profile import SpeedProfile
from trunnion.motion.simulation.input_rotation import TURN, InputRotation
from trunnion.motion.simulation.simulation import Simulation
from trunnion.numerics.curves import Extremes, extremes_in
from trunnion.numerics.integration.integration import joined
from trunnion.results.declared import Described, Held, axis, ending, fields_over, over, remark, remarks
from trunnion.results.drawing import Axes, drawing
from trunnion.results.outcome import Outcome
from trunnion.results.speeds import rounded_speed


@dataclass(frozen=True, repr=False)
class LineSimulation(Described):
    """A motion of a line.

    time (points,) [s]; rotation (points, coordinate): deviation [rad] from the uniform rotation of ``profile``, and
    rate [rad/s]; twist [rad] and torque [N m] of every shaft (points, shaft), positive with the twist; pieces: one
    simulation per straight piece of the speed profile; outcome: how it ended.

    ``rotation`` of the input, its ``input_speed`` and the ``turns`` it made are those of the profile where a
    ConstantSpeed prescribes them, and those of its own rotation where the line starts free.
    """

    line: LineSystem
    profile: SpeedProfile
    pieces: tuple[Simulation, ...]
    time: Array

    @property
    def outcome(self) -> Outcome:
        """How it ended."""
        return self.pieces[-1].outcome

    @cached_property
    def _run(self) -> Simulation:
        """All pieces as one, but for its system: that of the last."""
        return replace(self.pieces[-1], trajectory=joined([piece.trajectory for piece in self.pieces]))

    @property
    def end(self) -> float:
        """The last time [s]."""
        return self.pieces[-1].end

    @property
    def final(self) -> Array:
        """The last state (2n,)."""
        return self.pieces[-1].final

    @property
    def shafts(self) -> tuple[str, ...]:
        """Names of the shafts."""
        return self.line.shafts

    @property
    def steps(self) -> int:
        """Steps taken."""
        return self._run.trajectory.steps

    @property
    def event_time(self) -> Array:
        """Times of all events (events,) [s]."""
        return self._run.trajectory.event_time

    @property
    def cuts(self) -> Array:
        """Times (steps + 1,) [s] between which the motion is smooth."""
        return self._run.trajectory.time_of_state

    def at(self, time: ArrayLike) -> Array:
        """States (…, 2n) at any times of the run; NaN outside it."""
        return self._run.at(time)

    def motion_at(self, time: ArrayLike) -> LineMotion:
        """Twists, torques and rotations at times (m,) of the run."""
        return LineMotion(*self._observed(time, LineMotion._fields))

    def torque_at(self, time: ArrayLike) -> Array:
        """Torque (m, shaft) [N m] of every shaft at times (m,) of the run."""
        return self._observed(time, ("torque",))[0]

    def _observed(self, time: ArrayLike, names: tuple[str, ...]) -> list[Array]:
        times = np.atleast_1d(np.asarray(time, dtype=float))
        order = np.argsort(times, kind="stable")
        states, times = self.at(times[order]), times[order]
        ends = np.searchsorted(times, [*(piece.time_range[0] for piece in self.pieces), np.nextafter(self.end, np.inf)])
        parts = [
            self.line.observe(piece.system, times[i:j], states[i:j])
            for piece, i, j in zip(self.pieces, ends, ends[1:], strict=False)
        ]
        whole = []
        for columns in ([getattr(part, name) for part in parts] for name in names):
            found = np.full((len(times), columns[0].shape[1]), np.nan)
            found[order[ends[0] : ends[-1]]] = np.concatenate(columns)
            whole.append(found)
        return whole

    @cached_property
    def _motion(self) -> LineMotion:
        return self.motion_at(self.time)

    @cached_property
    def state(self) -> Array:
        """States (points, 2n) at ``time``."""
        return self.at(self.time)

    @property
    def twist(self) -> Array:
        """Twist [rad] of every shaft, (points, shaft)."""
        return self._motion.twist

    @property
    def torque(self) -> Array:
        """Torque [N m] of every shaft, (points, shaft)."""
        return self._motion.torque

    @property
    def unit(self) -> str:
        """Unit that speeds are printed in: that of the line's description."""
        return speed_unit(self.line.assembly.line)

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
        """Of the input among the unknown rotations of a line that starts free."""
        return int(self.line.assembly.topology.unknown_of[0])

    @property
    def input_speed(self) -> Array:
        """Input speed [rad/s] at ``time``."""
        return self.input.speed(self.time)

    @property
    def turns(self) -> float:
        """Turns that the input made."""
        angle = float(self.profile.angle(self.end))
        if self.starts_free:
            angle += float(self.final[self._place] - self.pieces[0].trajectory.state[0, self._place])
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

    def declared(self) -> Iterator[Held]:
        """Deviations and rates of every inertia, twist and torque of every shaft, the input's course, over time."""
        n = len(self.line.names)
        yield axis("time", self.time, "s")
        yield axis("coordinate", self.line.names)
        yield axis("shaft", self.shafts)
        yield over("time coordinate", "rotation", self.state[:, :n], "rad")
        yield over("time coordinate", "rate", self.state[:, n : 2 * n], "rad/s")
        if self.line.sliders:
            yield axis("slider", [slider.name for slider in self.line.sliders])
            yield over("time slider", "deflection", self.state[:, 2 * n :], "rad")
        yield from fields_over("time shaft", self, twist="rad", torque="N*m")
        yield over("time", "input_speed", self.input_speed, "rad/s")
        yield over("time", "input_angle", self.input.angle(self.time), "rad")
        if self.starts_free:
            yield over("time", "reference_speed", self.profile.at(self.time), "rad/s", "that rotations deviate from")
        yield remark("driveline", self.pieces[0].system.name)
        yield from ending(self.outcome)
        yield from remarks(tolerance=self.pieces[0].tolerance, steps=self.steps)

    def plot(self, axes: Axes | None = None, *, shafts: tuple[str, ...] = (), unit: str = "") -> Axes:
        """Torques over time; see ``pictures.motion``."""
        return drawing(self, "plot")(self, axes, shafts=shafts, unit=unit)

    def plot_order_map(
        self, axes: Axes | None = None, *, shaft: str = "", window: int = 8, highest: float = 12.0, unit: str = ""
    ) -> Axes:
        """Torque spectrum over time or speed; see ``pictures.motion.map_of_orders``."""
        return drawing(self, "plot_order_map")(self, axes, shaft=shaft, window=window, highest=highest, unit=unit)

    def describe(self, unit: str | None = None) -> str:
        """The result in a few lines, speeds in ``unit``, by default that of the line's description."""
        rows = [
            f"  {name}: torque {low:.6g} … {high:.6g} N m"
            for name, low, high in zip(self.shafts, self.torque_extremes.low, self.torque_extremes.high, strict=True)
        ]
        head = f"motion of {self.pieces[0].system.name} over {self.end:.6g} s ({self.turns:.6g} turns): "
        own = [f"  {self._turning(unit or self.unit)}"] if self.starts_free else []
        return "\n".join([f"{head}{self.steps} steps", *own, *rows, f"  {self.outcome}"])

    def _turning(self, unit: str) -> str:
        """How fast a line that starts free turned."""
        speed, last = self.whole.turns[1], self.whole.last_turn()[1]
        if not len(speed):
            return "the line starts free: it made no turn"
        back = self.whole.turned_back
        if back is not None:
            return f"the line starts free: it turns back at t = {back:.4g} s"
        return (
            f"the line starts free: it turns at {rounded_speed(float(speed[0]), unit)} in its first turn and at "
            f"{rounded_speed(last, unit)} in its last"
        )
