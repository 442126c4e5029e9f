"""Steady motions step by step, as a bench finds them: of one mass over frequency, of a line over speed or frequency."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from trunnion.analyses.orbits.jumps import jumps
from trunnion.analyses.orbits.spring_contacts import SpringContact
from trunnion.arrays import Array, Flags, Integers
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.staged_line import StagedLine
from trunnion.errors import InputError
from trunnion.results.declared import Described, Held, Result, axis, ending, fields_over, over, remark
from trunnion.results.drawing import Axes, drawing
from trunnion.results.outcome import Outcome
from trunnion.results.speeds import frequency_unit, speed_factor
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator


@dataclass(frozen=True, repr=False)
class Sweep(Result):
    """Steady motion over frequency, in the order it was swept.

    frequency (points,); lowest, highest, mean of x (points,); contact (points,) of none, one-sided, two-sided;
    impacts, impact_energy Σ m v²/2 and impact_impulse Σ m |v| per period (points,); settled (points,): whether the
    motion repeats every period; periods (points,): run until then; state (points, 2) at phase zero.
    """

    oscillator: PiecewiseOscillator
    frequency: Array
    lowest: Array
    highest: Array
    mean: Array
    contact: tuple[str, ...]
    impacts: Array
    impact_energy: Array
    impact_impulse: Array
    settled: Flags
    periods: Integers
    state: Array
    outcome: Outcome

    @property
    def peak_to_peak(self) -> Array:
        """Highest minus lowest (points,)."""
        return self.highest - self.lowest

    @property
    def up(self) -> bool:
        """Whether the frequency was raised."""
        return bool(self.frequency[-1] >= self.frequency[0])

    @property
    def jumps(self) -> tuple[tuple[float, float], ...]:
        """Pairs of neighbouring frequencies between which the swing changes abruptly, in the order swept."""
        return jumps(self.frequency, self.peak_to_peak)

    def declared(self) -> Iterator[Held]:
        """Extremes, impacts and contact over frequency."""
        yield axis("frequency", self.frequency, "rad/s")
        yield from fields_over("frequency", self, lowest="", highest="", mean="", peak_to_peak="")
        yield from fields_over("frequency", self, impacts="", impact_energy="", impact_impulse="", settled="")
        yield over("frequency", "contact", np.array(self.contact, dtype=str))
        yield over("frequency", "periods", self.periods)
        yield remark("oscillator", self.oscillator.name)
        yield remark("direction", "up" if self.up else "down")
        yield from ending(self.outcome)

    def plot(self, axes: Axes | None = None, *, length: str = "", unit: str | None = None) -> Axes:
        """Half peak-to-peak over frequency; see ``trunnion.plots.frequency_response``."""
        return drawing(self, "plot")(self, axes, length=length, unit=unit)

    @property
    def unit(self) -> str:
        """What its frequencies read in: Hz, or rad/s for equations of one's own."""
        return frequency_unit(self.oscillator.speed_unit)

    def __str__(self) -> str:
        best, factor = int(np.nanargmax(self.peak_to_peak)), speed_factor(self.unit)
        low, high, largest = (self.frequency[i] * factor for i in (0, -1, best))
        rough = int((~self.settled).sum())
        kinds = ", ".join(f"{self.contact.count(k)} {k}" for k in ("none", "one-sided", "two-sided"))
        return (
            f"sweep {'up' if self.up else 'down'} of {self.oscillator.name}, {len(self.frequency)} frequencies from "
            f"{low:.6g} to {high:.6g} {self.unit}, {rough} without a motion of one period\n"
            f"  largest half peak-to-peak {self.peak_to_peak[best] / 2:.6g} at {largest:.6g}; "
            f"jumps: {_in_words(self.jumps, self.unit)}\n"
            f"  contact: {kinds}; {self.outcome}"
        )


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
        return bool(self.value[-1] >= self.value[0])

    @property
    def jumps(self) -> tuple[tuple[float, float], ...]:
        """Pairs of neighbouring values between which the torque of any spring changes abruptly, in the order swept."""
        return jumps(self.value, *self.torque_peak_to_peak.T)

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
        yield axis(clock, self.value, "rad/s")
        yield axis("spring", self.springs)
        yield axis("staged_spring", staged)
        yield from fields_over(f"{clock} spring", self, torque_low="N*m", torque_high="N*m")
        for name, unit, kind in (("impacts", "", None), ("impact_energy", "J", None), ("contact", "", str)):
            values = np.array([[getattr(contact, name) for contact in row] for row in self.contacts], dtype=kind)
            yield over(f"{clock} staged_spring", name, values.reshape(len(self.value), len(staged)), unit)
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
        return "\n".join(
            [
                f"sweep {'up' if self.up else 'down'} of {self.line.name}, {len(value)} steps from "
                f"{value[0]:.6g} to {value[-1]:.6g} {unit}, {rough} without a motion of one period",
                *rows,
                f"  jumps: {_in_words(self.jumps, unit)}; {self.outcome}",
            ]
        )


def _in_words(jumps: Sequence[tuple[float, float]], unit: str) -> str:
    factor = speed_factor(unit)
    return ", ".join(f"{a * factor:.6g} → {b * factor:.6g}" for a, b in jumps) or "none"
