"""A driveline with stages on the bench: speed, or frequency of the excitation, raised or lowered step by step."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from trunnion.analyses.motion.exact_motion import start_state
from trunnion.analyses.orbits.exact_map import LineMap
from trunnion.analyses.orbits.exact_orbit import contacts_of
from trunnion.analyses.orbits.piecewise_branch import line_over
from trunnion.analyses.orbits.spring_contacts import SpringContact
from trunnion.analyses.orbits.sweeping import jumps, stepped, upwards
from trunnion.arrays import Array, Flags, Integers
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.coefficients import Assembly
from trunnion.equations.staged_line import StagedLine
from trunnion.errors import InputError
from trunnion.numerics.piecewise_linear.staged_flow import StagedPassage, kernel
from trunnion.results.declared import Described, Held, axis, ending, fields_over, over, remark
from trunnion.results.drawing import Axes, drawing
from trunnion.results.outcome import Outcome
from trunnion.results.speeds import frequency_unit, speed_factor


@dataclass(frozen=True, repr=False)
class LineSweep(Described):
    """Steady motions of a line, in the order it was swept.

    value (points,) [rad/s]: speed, or common frequency of excitation in time; torque_low, torque_high (points, spring)
    [N m]; contacts (points of spring contacts), per period of the excitation where settled, else over the periods
    measured; settled (points,): whether the motion repeats every period; periods (points,): run until then; state
    (points, 2m).
    """

    line: StagedLine
    value: Array
    torque_low: Array
    torque_high: Array
    contacts: tuple[tuple[SpringContact, ...], ...] = field(repr=False)
    settled: Flags
    periods: Integers
    state: Array
    outcome: Outcome

    @property
    def springs(self) -> tuple[str, ...]:
        """Names of the springs."""
        return self.line.springs

    @property
    def torque_peak_to_peak(self) -> Array:
        """Highest minus lowest torque (points, spring) [N m]."""
        return self.torque_high - self.torque_low

    @property
    def up(self) -> bool:
        """Whether the value was raised."""
        return upwards(self.value)

    @property
    def jumps(self) -> tuple[tuple[float, float], ...]:
        """Pairs of neighbouring values between which the torque of any spring changes abruptly, in the order swept."""
        return jumps(self.value, self.torque_peak_to_peak)

    def swing_of(self, spring: str) -> Array:
        """Peak-to-peak torque of one spring (points,) [N m].

        Raises
        ------
        InputError : no such spring.
        """
        return self.torque_peak_to_peak[:, self._place(spring)]

    def contact_of(self, spring: str) -> tuple[str, ...]:
        """none, one-sided or two-sided (points,); of a spring without stages two-sided."""
        staged = [self.springs[e] for e in self.line.staged]
        if self.springs[self._place(spring)] not in staged:
            return ("two-sided",) * len(self.value)
        return tuple(row[staged.index(spring)].contact for row in self.contacts)

    def _place(self, spring: str) -> int:
        if spring not in self.springs:
            raise InputError(
                "is no spring of the line", element=self.line.name, key="spring", value=spring,
                remedy=f"name one of {', '.join(self.springs)}",
            )  # fmt: skip
        return self.springs.index(spring)

    def declared(self) -> Iterator[Held]:
        """Extremes of every spring's torque, impacts and contact of those with stages, over speed or frequency."""
        clock = "speed" if self.line.clock == "speed" else "frequency"
        staged = [self.springs[e] for e in self.line.staged]
        shape = (len(self.value), len(staged))
        impacts = np.array([[c.impacts for c in row] for row in self.contacts]).reshape(shape)
        energy = np.array([[c.impact_energy for c in row] for row in self.contacts]).reshape(shape)
        sides = np.array([[c.contact for c in row] for row in self.contacts], dtype=str).reshape(shape)
        yield axis(clock, self.value, "rad/s")
        yield axis("spring", self.springs)
        yield axis("staged_spring", staged)
        yield from fields_over(f"{clock} spring", self, torque_low="N*m", torque_high="N*m")
        yield over(f"{clock} staged_spring", "impacts", impacts)
        yield over(f"{clock} staged_spring", "impact_energy", energy, "J")
        yield over(f"{clock} staged_spring", "contact", sides)
        yield from fields_over(clock, self, settled="", periods="")
        yield remark("driveline", self.line.name)
        yield remark("direction", "up" if self.up else "down")
        yield from ending(self.outcome)

    def plot(self, axes: Axes | None = None, *, spring: str = "", unit: str | None = None) -> Axes:
        """Torque of one spring over speed; see ``trunnion.plots.frequency_response.draw_line_sweeps``."""
        return drawing(self, "plot")(self, axes, spring=spring, unit=unit)

    @property
    def unit(self) -> str:
        """What its speeds, or frequencies, read in: the unit of the description."""
        of_line = speed_unit(self.line.assembly.line)
        return of_line if self.line.clock == "speed" else frequency_unit(of_line)

    def describe(self, unit: str | None = None) -> str:
        """What was found, speeds in ``unit``, by default that of the description."""
        unit = unit or self.unit
        rough, value = int((~self.settled).sum()), self.value * speed_factor(unit)
        rows = []
        for e, name in enumerate(self.springs):
            swing = self.torque_peak_to_peak[:, e]
            best = int(np.nanargmax(swing)) if np.isfinite(swing).any() else 0
            rows.append(f"  {name}: largest torque {swing[best]:.6g} N m peak to peak at {value[best]:.6g} {unit}")
        for row in zip(*self.contacts, strict=True):
            kinds = [contact.contact for contact in row]
            told = ", ".join(f"{kinds.count(k)} {k}" for k in ("none", "one-sided", "two-sided") if k in kinds)
            worst = int(np.nanargmax([np.nan_to_num(c.impact_energy) for c in row]))
            impact = f"; impacts up to {row[worst].impact_energy:.4g} J a period at {value[worst]:.6g} {unit}"
            rows.append(f"  contact of {row[0].spring}: {told}{impact if row[worst].impacts else ''}")
        factor = speed_factor(unit)
        jumps = ", ".join(f"{a * factor:.6g} → {b * factor:.6g}" for a, b in self.jumps) or "none"
        return "\n".join(
            [
                f"sweep {'up' if self.up else 'down'} of {self.line.name}, {len(value)} steps from "
                f"{value[0]:.6g} to {value[-1]:.6g} {unit}, {rough} without a motion of one period",
                *rows,
                f"  jumps: {jumps}; {self.outcome}",
            ]
        )


def exact_sweep(
    line: Driveline | Assembly,
    values: Array,
    *,
    start: ArrayLike | None,
    speed: float | None,
    least: int,
    most: int,
    same: float,
) -> LineSweep:
    """See ``sweep``, which has checked the values."""
    prepared = line_over(line, float(values[0]), speed)
    maps = [LineMap(float(value), 1, prepared) for value in values]
    shape, size, k = (len(values), len(prepared.springs)), len(values), kernel()
    low, high, states = np.full(shape, np.nan), np.full(shape, np.nan), np.full((size, 2 * prepared.size), np.nan)
    settled, periods = np.zeros(size, dtype=bool), np.zeros(size, dtype=np.int64)
    nothing = tuple(SpringContact(prepared.springs[e], np.zeros(0), np.nan, "none", np.zeros(0), np.nan)
                    for e in prepared.staged)  # fmt: skip
    contacts: list[tuple[SpringContact, ...]] = [nothing] * size
    outcome = Outcome(True, "swept", "every step was run")
    first = start_state(prepared, start)[maps[0].kept]
    for i, (found, seen) in enumerate(stepped(maps, first, least, most, same, _watched)):
        periods[i], settled[i] = found.periods, found.repeats
        if seen is None:
            words = f"the motion at {values[i]:g} rad/s changes its stages too often in a period; raise damping"
            outcome = Outcome(False, "chatter", words)
            break
        run, length = seen
        states[i] = maps[i].whole(found.state)
        low[i], high[i] = run.seen[: shape[1], k.TORQUE_LOW], run.seen[: shape[1], k.TORQUE_HIGH]
        contacts[i] = contacts_of(prepared, states[i], run, length)
    return LineSweep(prepared, values, low, high, tuple(contacts), settled, periods, states, outcome)


def _watched(place: LineMap, state: Array) -> tuple[tuple[StagedPassage, float] | None, Array]:
    run = place.watched(state)
    return ((run, place.length) if run.done else None), run.state[place.kept]
