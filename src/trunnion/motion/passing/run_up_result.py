"""What a run-up shows: torque turn by turn, what of it vibrates, and how it ended."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from trunnion.arrays import Array, Codes
from trunnion.motion.passing.run_up_ending import RunUpEnding
from trunnion.motion.passing.schedule import Schedule
from trunnion.motion.simulation.simulation import LineSimulation
from trunnion.results.counts import counted
from trunnion.results.declared import Described, Held, axis, ending, fields_over, over, remarks
from trunnion.results.drawing import Axes, drawing
from trunnion.results.outcome import Outcome
from trunnion.results.speeds import about_speed, rounded_speed, show_acceleration, show_speed


@dataclass(frozen=True)
class SteadyResponse:
    """Steady torque over speed: speed (points,) [rad/s]; largest (points, shaft), the largest |torque| [N m] of the
    periodic motion; swing (points, shaft): half of its peak-to-peak; verdict (points,) codes. In order along the
    branch, which may fold back."""

    speed: Array
    largest: Array
    swing: Array
    verdict: Codes


@dataclass(frozen=True, repr=False)
class RunUp(Described):
    """A passage at constant acceleration.

    speed (turns,) [rad/s]: mean speed in each turn of the input, or in the little more that leaves none over, and time
    (turns,) [s] of its middle; where the line starts free, of the whole line, whose vibration does not count; upper and
    lower (turns, shaft): the largest and smallest torque [N m] within it, found on the dense output; vibration (turns,
    shaft): the largest distance of the torque from the quasi-static one, which loads and inertia ask for at the speed
    and acceleration that the line has; lag (turns,) [rad/s]: by how much it turned slower than asked, which only a line
    that starts free can; inertia_torque (shaft,) [N m]: what accelerates the inertia behind each shaft at the full
    acceleration, were it rigid and its joints straight; steady: the steady response in the same range (None if not
    asked for); ending: how a line that starts free came to the last speed, None where the speed is prescribed; ended:
    what a time limit left out, as a clause, "" where nothing.
    """

    simulation: LineSimulation
    schedule: Schedule
    time: Array
    speed: Array
    upper: Array
    lower: Array
    vibration: Array
    lag: Array
    inertia_torque: Array
    steady: SteadyResponse | None
    ending: RunUpEnding | None
    ended: str = ""

    @property
    def acceleration(self) -> float:
        """Magnitude asked for [rad/s²]."""
        return self.schedule.acceleration

    @property
    def ramp(self) -> float:
        """Time over which it sets in [s]."""
        return self.schedule.ramp

    @property
    def unit(self) -> str:
        """Unit that speeds are printed in: that of the line's description."""
        return self.simulation.unit

    @property
    def outcome(self) -> Outcome:
        """How the run ended, speeds in the unit of the line's description: ``kind`` is "reached", "slipped" where a
        clutch let go, or for a line that starts free "captured", "short of torque", "stalled" or "undecided"; see
        ``RunUpEnding``."""
        return self.outcome_in(self.unit)

    def outcome_in(self, unit: str) -> Outcome:
        """The same, speeds in ``unit``."""
        failed = self.simulation.outcome
        return failed if self.ending is None else self.ending.outcome(failed, unit)

    @property
    def shafts(self) -> tuple[str, ...]:
        """Names of the shafts."""
        return self.simulation.shafts

    @property
    def largest(self) -> Array:
        """Largest |torque| in each turn (turns, shaft) [N m]."""
        return np.maximum(np.abs(self.upper), np.abs(self.lower))

    @property
    def peak_torque(self) -> Array:
        """Largest |torque| of every shaft over the whole passage [N m]."""
        return np.asarray(self.largest.max(axis=0))

    @property
    def peak_speed(self) -> Array:
        """Mean input speed [rad/s] of the turn in which each shaft has it."""
        return self.speed[self.largest.argmax(axis=0)]

    @cached_property
    def steady_peak(self) -> Array:
        """Largest |torque| of every shaft among the steady motions found [N m]; NaN without them."""
        if self.steady is None or not np.isfinite(self.steady.largest).any():
            return np.full(len(self.shafts), np.nan)
        return np.asarray(np.nanmax(self.steady.largest, axis=0))

    @property
    def peak_vibration(self) -> Array:
        """Largest distance of every shaft's torque (shaft,) [N m] from the quasi-static one."""
        return np.asarray(self.vibration.max(axis=0))

    @property
    def vibration_speed(self) -> Array:
        """Mean input speed [rad/s] of the turn in which each shaft has it."""
        return self.speed[self.vibration.argmax(axis=0)]

    @cached_property
    def steady_vibration(self) -> Array:
        """Half of the largest peak-to-peak torque of every shaft among the steady motions found [N m]; NaN without."""
        if self.steady is None or not np.isfinite(self.steady.swing).any():
            return np.full(len(self.shafts), np.nan)
        return np.asarray(np.nanmax(self.steady.swing, axis=0))

    def declared(self) -> Iterator[Held]:
        """Extremes and vibration of every torque turn by turn and in all, and the steady response."""
        yield axis("shaft", self.shafts)
        yield over("turn shaft", "torque_upper", self.upper, "N*m")
        yield over("turn shaft", "torque_lower", self.lower, "N*m")
        yield from fields_over("turn", self, time="s", speed="rad/s")
        yield from fields_over("shaft", self, peak_torque="N*m", peak_speed="rad/s", inertia_torque="N*m")
        yield over("turn shaft", "vibration", self.vibration, "N*m")
        yield from fields_over("shaft", self, peak_vibration="N*m", vibration_speed="rad/s")
        yield over("turn", "lag", self.lag, "rad/s")
        if self.steady is not None:
            yield axis("steady_speed", self.steady.speed, "rad/s")
            yield over("steady_speed shaft", "steady_torque", self.steady.largest, "N*m")
            yield over("steady_speed shaft", "steady_swing", self.steady.swing, "N*m")
            yield over("steady_speed", "steady_verdict", self.steady.verdict)
        yield from remarks(acceleration=self.acceleration, ramp=self.ramp)
        if self.ending is not None:
            yield from self.ending.declared()
        yield from ending(self.outcome)
        yield from remarks(ended=self.ended)

    def plot(self, axes: Axes | None = None, *, shaft: str = "", unit: str = "") -> Axes:
        """Envelope against the steady response; see ``trunnion.plots.run_up``."""
        return drawing(self, "plot")(self, axes, shaft=shaft, unit=unit)

    def describe(self, unit: str | None = None) -> str:
        """The result in a few lines, speeds in ``unit``, by default that of the line's description."""
        unit = unit or self.unit
        rows = []
        for i, name in enumerate(self.shafts):
            against = self._against(i)
            rows.append(
                f"  {name}: at most {self.peak_torque[i]:.5g} N m, at {rounded_speed(self.peak_speed[i], unit)}; "
                f"{self.inertia_torque[i]:.5g} N m accelerate what is behind it, ± {self.peak_vibration[i]:.5g} N m "
                f"vibrate at {rounded_speed(self.vibration_speed[i], unit)}{against}"
            )
        asked = self.schedule
        made = f"{counted(len(self.speed), 'turn')} in {self.simulation.end:.5g} s"
        head = (
            f"run from {show_speed(asked.first, unit)} to {show_speed(asked.last, unit)} at "
            f"{show_acceleration(asked.acceleration, unit)}, set in over {asked.ramp:.3g} s: {made}"
        )
        if self.simulation.starts_free:
            worst = int(np.argmax(np.abs(self.lag)))
            sense = "slower" if self.lag[worst] >= 0 else "faster"
            rows.append(
                f"  the drives carry the loads and accelerate the inertia; the line turned up to "
                f"{about_speed(abs(self.lag[worst]), unit)} {sense} than asked, at "
                f"{rounded_speed(self.speed[worst], unit)}"
            )
        if self.simulation.line.sliders:
            rows.append("  no steady response beside it: clutches rub, which no branch follows; ask periodic_response")
        if self.ended:
            rows.append(f"  {self.ended}")
        return "\n".join([head, *rows, f"  {self.outcome_in(unit)}"])

    def _against(self, i: int) -> str:
        """When the vibration of a shaft is largest, where that tells, and the steady one beside it."""
        setting_in = self.time[int(self.vibration[:, i].argmax())] < self.ramp
        words = " while the acceleration sets in" if setting_in else ""
        if not np.isfinite(self.steady_vibration[i]):
            return words
        share = self.peak_vibration[i] / max(self.steady_vibration[i], 1e-300)
        times = "against" if setting_in else f"{share:.3g} times"
        return f"{words}, {times} the largest steady vibration found, ± {self.steady_vibration[i]:.5g} N m"
