"""A piecewise linear oscillator, or a driveline, on the bench: a value raised or lowered step by step.

Each step goes on from where the last one ended, settles and is then measured. Also the rattle index, what the impacts
of a period amount to, over frequency; and jumps: changes between neighbours that those beside them do not announce.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Flags, Integers
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.clutch_capacity import refuse_overload
from trunnion.equations.coefficients import Assembly
from trunnion.equations.staged_line import StagedLine
from trunnion.errors import InputError
from trunnion.motion.orbits.exact_map import ExactMap, LineMap, OscillatorMap
from trunnion.motion.orbits.exact_orbit import NUMBERS, Displacement, TorqueRange, fields_of, refuse_unbounded
from trunnion.motion.orbits.periodic_branch import line_over
from trunnion.motion.orbits.spring_contacts import SpringContact
from trunnion.motion.simulation.exact_motion import start_state
from trunnion.numerics.memory import require_memory
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import computed, coordinate, internal, labelled, variable
from trunnion.results.of_systems import ending
from trunnion.results.outcome import Outcome
from trunnion.results.result import Result
from trunnion.results.speeds import frequency_unit, speed_factor
from trunnion.results.variables import Attribute, Coordinate, Variable, attributes
from trunnion.steady.shooting.shooting_problem import refuse_speed
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator

if TYPE_CHECKING:
    import xarray as xr

LEAST, MOST, SAME, MEASURED = 20, 2000, 1e-11, 64
"""Periods of a step at least and at most; change per period that counts as settled; periods measured otherwise."""
BYTES_A_STEP = 128.0
"""What one frequency holds for each number of the state."""
CONTACTS = ("none", "one-sided", "two-sided")
JUMP, ABRUPT = 0.25, 2.0
"""A change between neighbours is a jump if it is this share of the larger swing and that many times those beside."""
STEEPENING = 4.0
"""How many times steeper the flank of a resonance may get from step to step of a coarse grid."""


@labelled
class Sweep(ABC):
    """Steady motions over a value, in the order it was swept."""

    value: Array = internal("that was swept", "rad/s", "point")
    settled: Flags = internal("whether the motion repeats every period", axes="point")
    periods: Integers = internal("run until then", axes="point")
    state: Array = internal("at phase zero", axes="point state")
    outcome: Outcome = internal("how it ended")
    unit: str = internal("of speeds or frequencies in print")

    @property
    @abstractmethod
    def swings(self) -> Array:
        """Peak-to-peak (points, curves) of what is looked at."""

    @property
    def up(self) -> bool:
        """Whether the value was raised."""
        return bool(self.value[-1] >= self.value[0])

    @property
    def jumps(self) -> tuple[tuple[float, float], ...]:
        """Pairs of neighbouring values between which any swing changes abruptly, in the order swept."""
        found = sorted({i for swing in self.swings.T for i in abrupt_changes(swing)})
        return tuple((float(self.value[i]), float(self.value[i + 1])) for i in found)

    @property
    def _direction(self) -> str:
        return "up" if self.up else "down"

    def _head(self, name: str, what: str) -> str:
        low, high = self.value[[0, -1]] * self._factor
        return (
            f"sweep {self._direction} of {name}, {len(self.value)} {what} from {low:.6g} to {high:.6g} {self.unit}, "
            f"{int((~self.settled).sum())} without a motion of one period"
        )

    @property
    def _factor(self) -> float:
        """What values are multiplied with to read in the unit."""
        return speed_factor(self.unit)

    @property
    def _jumps(self) -> str:
        pairs = (f"{low * self._factor:.6g} → {high * self._factor:.6g}" for low, high in self.jumps)
        return f"jumps: {', '.join(pairs) or 'none'}"


@labelled
class OscillatorSweep(Result, Displacement[Array], Sweep):
    """Steady motion of an oscillator over frequency; states are x and x′."""

    periods: Integers = variable("frequency", "", "run until the motion repeats")
    oscillator: PiecewiseOscillator = internal("that moves")
    contact: tuple[str, ...] = variable("frequency", "", "none, one-sided or two-sided")

    @property
    @computed(coordinate("frequency", "rad/s"))
    def frequency(self) -> Array:
        """Frequencies (points,) [rad/s]."""
        return self.value

    @property
    def swings(self) -> Array:
        """Peak-to-peak of x (points, 1)."""
        return self.peak_to_peak[:, None]

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, extremes and impacts, and the ending."""
        yield from super().declared()
        yield from (Variable(name, getattr(self, name), "frequency") for name in (*NUMBERS, "settled"))
        yield from attributes(oscillator=self.oscillator.name, direction=self._direction)
        yield from ending(self.outcome)

    def plot(self, axes: Axes | None = None, *, length: str = "", unit: str | None = None) -> Axes:
        """Half peak-to-peak over frequency; see ``pictures.frequency_response``."""
        return drawing(self, "plot")(self, axes, length=length, unit=unit)

    def _lines(self) -> Iterator[str]:
        best = int(np.nanargmax(self.peak_to_peak))
        yield self._head(self.oscillator.name, "frequencies")
        largest, at = self.peak_to_peak[best] / 2, self.frequency[best] * self._factor
        yield f"  largest half peak-to-peak {largest:.6g} at {at:.6g}; {self._jumps}"
        yield f"  contact: {', '.join(f'{self.contact.count(k)} {k}' for k in CONTACTS)}; {self.outcome}"


@labelled
class LineSweep(Result, TorqueRange, Sweep):
    """Steady motions of a line over its speed, or the common frequency of excitation in time."""

    line: StagedLine = internal("that moves")
    contacts: tuple[tuple[SpringContact, ...], ...] = internal(
        "of springs with stages, per period of the excitation where settled, else over the periods measured",
        axes="point staged_spring", repr=False,
    )  # fmt: skip

    @property
    @computed(coordinate("spring"))
    def springs(self) -> tuple[str, ...]:
        """Names of the springs."""
        return self.line.springs

    @property
    def swings(self) -> Array:
        """Peak-to-peak torques (points, spring) [N m]."""
        return self.torque_peak_to_peak

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
                "is not a spring of the line", element=self.line.name, key="spring", value=spring,
                remedy=f"name one of {', '.join(self.springs)}",
            )  # fmt: skip
        return self.springs.index(spring)

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, torques, impacts and contact over speed or frequency, and the ending."""
        independent_variable = "speed" if self.line.independent_variable == "speed" else "frequency"
        staged = [self.springs[e] for e in self.line.staged]
        yield Coordinate(independent_variable, self.value, independent_variable, "rad/s")
        yield from super().declared()
        yield Coordinate("staged_spring", staged, "staged_spring")
        for name in ("torque_low", "torque_high"):
            yield Variable(name, getattr(self, name), f"{independent_variable} spring", "N*m")
        for name, unit, kind in (("impacts", "", None), ("impact_energy", "J", None), ("contact", "", str)):
            values = np.array([[getattr(contact, name) for contact in row] for row in self.contacts], dtype=kind)
            values = values.reshape(len(self.value), len(staged))
            yield Variable(name, values, f"{independent_variable} staged_spring", unit)
        for name in ("settled", "periods"):
            yield Variable(name, getattr(self, name), independent_variable)
        yield from attributes(driveline=self.line.name, direction=self._direction)
        yield from ending(self.outcome)

    def plot(self, axes: Axes | None = None, *, spring: str = "", unit: str | None = None) -> Axes:
        """Torque of one spring over speed; see ``pictures.frequency_response.line_sweep``."""
        return drawing(self, "plot")(self, axes, spring=spring, unit=unit)

    def _lines(self) -> Iterator[str]:
        value, unit = self.value * self._factor, self.unit
        yield self._head(self.line.name, "steps")
        for e, name in enumerate(self.springs):
            swing = self.torque_peak_to_peak[:, e]
            best = int(np.nanargmax(swing)) if np.isfinite(swing).any() else 0
            yield f"  {name}: largest torque {swing[best]:.6g} N m peak to peak at {value[best]:.6g} {unit}"
        for row in zip(*self.contacts, strict=True):
            kinds = [contact.contact for contact in row]
            counts = ", ".join(f"{kinds.count(k)} {k}" for k in CONTACTS if k in kinds)
            worst = int(np.nanargmax([np.nan_to_num(c.impact_energy) for c in row]))
            impact = f"; impacts up to {row[worst].impact_energy:.4g} J a period at {value[worst]:.6g} {unit}"
            yield f"  contact of {row[0].spring}: {counts}{impact if row[worst].impacts else ''}"
        yield f"  {self._jumps}; {self.outcome}"


def abrupt_changes(swing: Array) -> list[int]:
    """Places i where a response (points,) changes abruptly from i to i + 1."""
    change = np.abs(np.diff(swing))
    if len(change) < 3:
        return []
    # At an end both neighbours stand on one side, so that a flank which goes on beyond it looks like a jump.
    left = np.concatenate([change[2:3], change[:-2], STEEPENING * change[-2:-1]])
    right = np.concatenate([STEEPENING * change[1:2], change[2:], change[-3:-2]])
    usual = np.maximum(left, right)
    abrupt = (change > JUMP * np.maximum(swing[:-1], swing[1:])) & (change > ABRUPT * usual)
    return [int(i) for i in np.flatnonzero(abrupt)]


@overload
def sweep(
    oscillator: PiecewiseOscillator,
    frequencies: ArrayLike,
    *,
    start: ArrayLike | None = None,
    least: int = LEAST,
    most: int = MOST,
    same: float = SAME,
) -> OscillatorSweep: ...
@overload
def sweep(
    oscillator: Driveline | Assembly,
    frequencies: ArrayLike,
    *,
    start: ArrayLike | None = None,
    speed: float | str | None = None,
    least: int = LEAST,
    most: int = MOST,
    same: float = SAME,
) -> LineSweep: ...


def sweep(
    oscillator: PiecewiseOscillator | Driveline | Assembly,
    frequencies: ArrayLike,
    *,
    start: ArrayLike | None = None,
    speed: float | str | None = None,
    least: int = LEAST,
    most: int = MOST,
    same: float = SAME,
) -> OscillatorSweep | LineSweep:
    """Steady motions over ``frequencies`` in the order given: rising for an up-sweep, falling for a down-sweep.

    Each step begins with the motion in which the last one ended, as on a test bench, and so stays on a branch until it
    jumps.

    Parameters
    ----------
    oscillator : a ``PiecewiseOscillator``, or a driveline that ``exact_motion`` takes, which is swept over its speed,
        or over the common frequency of its excitations where those are in time.
    frequencies : (points,) [rad/s]; of a driveline speeds, where its excitation turns with it.
    start : state at the first: x and x′, by default rest at the static equilibrium; of a driveline as in
        ``exact_motion``.
    speed : of a driveline excited in time [rad/s], where a viscous load depends on it.
    least : periods of every step, at least.
    most : periods of every step, at most.
    same : relative change of the state per period below which, three times running, a motion counts as settled.

    Returns
    -------
    OscillatorSweep of an oscillator's x, or LineSweep of the torques [N m] of a driveline's springs.

    Raises
    ------
    InputError : frequencies that are not positive, an undamped linear resonance among them; a driveline without exact
        motion, excited both by its rotation and in time, or with a clutch that carries more than it holds.

    Examples
    --------
    >>> import trunnion as tn
    >>> gap = tn.PiecewiseOscillator.gap(half_gap=1.0, damping=0.05, mean_force=0.2, force=0.4, frequency=0.7)
    >>> up = tn.sweep(gap, [0.6, 0.7, 0.8])
    >>> up.peak_to_peak.round(3), up.contact
    (array([5.291, 6.565, 9.123]), ('two-sided', 'two-sided', 'two-sided'))
    """
    omegas = np.ascontiguousarray(np.atleast_1d(np.asarray(frequencies, dtype=float)))
    if not (omegas.ndim == 1 and len(omegas) and np.isfinite(omegas).all() and (omegas > 0).all()):
        raise InputError("must be positive numbers", key="frequencies", value=np.asarray(frequencies).tolist())
    if not 1 <= least <= most:
        raise InputError("must be 1 or more, and not less than least", key="least, most", value=[least, most])
    line = oscillator.line if isinstance(oscillator, Assembly) else oscillator
    states = 2 * len(line.elements) if isinstance(line, Driveline) else 2
    needed = BYTES_A_STEP * states * len(omegas)
    require_memory(needed, key="frequencies", value=len(omegas), remedy="ask for fewer frequencies")
    if isinstance(oscillator, Driveline | Assembly):
        maps, state, lost, result = _line(oscillator, omegas, start, speed)
    else:
        maps, state, lost, result = _oscillator(oscillator, omegas, start, speed)
    settled, periods = np.zeros(len(omegas), dtype=bool), np.zeros(len(omegas), dtype=np.int64)
    rows, outcome = list[dict[str, Any]](), Outcome(True, "swept", "every step was run")
    for i, place in enumerate(maps):
        found = place.steady(state, least, most, same)
        settled[i], periods[i] = found.repeats, found.periods
        # Over one period where the motion repeats, else over many.
        measured = (
            replace(place, periods=1 if found.repeats else MEASURED).measured(found.state) if found.done else None
        )
        if measured is None:
            outcome = Outcome(False, "chatter", lost.format(place.value))
            break
        rows.append(measured[0])
        state = measured[1]
    rows += [maps[0].unmeasured] * (len(omegas) - len(rows))
    columns = {name: [row[name] for row in rows] for name in fields_of(result.func, rows[0])}
    seen = {name: tuple(c) if isinstance(c[0], str | tuple) else np.array(c) for name, c in columns.items()}
    return result(value=omegas, settled=settled, periods=periods, outcome=outcome, **seen)


Bench = tuple[Sequence[ExactMap], Array, str, partial[Any]]
"""Maps by value, the state to begin with, what is said where a motion cannot be followed, and the result to be."""


def _oscillator(o: PiecewiseOscillator, values: Array, start: ArrayLike | None, speed: float | str | None) -> Bench:
    refuse_speed(o.name, speed)
    for omega in values:
        refuse_unbounded(o.but(frequency=float(omega)))
    first = np.array([o.equilibrium(), 0.0] if start is None else start, dtype=float)
    lost = "the motion at ω = {:g} crosses too often in a period; raise damping"
    result = partial(OscillatorSweep, oscillator=o, unit=frequency_unit(o.speed_unit))
    return [OscillatorMap(float(omega), 1, o) for omega in values], first, lost, result


def _line(line: Driveline | Assembly, values: Array, start: ArrayLike | None, speed: float | str | None) -> Bench:
    prepared = line_over(line, float(values[0]), speed)
    for value in values if prepared.sliders and not prepared.turns else ():
        refuse_overload(prepared.assembly, prepared.speed_at(float(value)))
    maps = [LineMap(float(value), 1, prepared) for value in values]
    lost = "the motion at {:g} rad/s changes its stages too often in a period; raise damping"
    unit = speed_unit(prepared.assembly.line)
    unit = unit if prepared.independent_variable == "speed" else frequency_unit(unit)
    return maps, start_state(prepared, start)[maps[0].kept], lost, partial(LineSweep, line=prepared, unit=unit)


def rattle_index(
    oscillator: PiecewiseOscillator,
    frequencies: ArrayLike,
    *,
    start: ArrayLike | None = None,
    least: int = LEAST,
    most: int = MOST,
    same: float = SAME,
) -> xr.Dataset:
    """Impulse and energy of the impacts in a forcing period over frequency, swept up and down as ``sweep`` does.

    Parameters
    ----------
    oscillator : a ``PiecewiseOscillator`` of inertia m.
    frequencies : (points,) [rad/s]; sorted here.
    start : x and x′ at the first of each sweep, by default rest at the static equilibrium.
    least : periods of every step, at least.
    most : periods of every step, at most.
    same : relative change of the state per period below which, three times running, a motion counts as settled.

    Returns
    -------
    xarray.Dataset with impact_energy [m v²], impact_impulse [m v] and the number of impacts, dimensions (direction,
    frequency); 0 without impacts.

    Raises
    ------
    InputError : what ``sweep`` refuses.

    Examples
    --------
    >>> import trunnion as tn
    >>> gap = tn.PiecewiseOscillator.gap(half_gap=1.0, damping=0.05, mean_force=0.2, force=0.4, frequency=0.7)
    >>> index = tn.rattle_index(gap, [0.6, 0.7])
    >>> index.impact_energy.sel(direction="up").values.round(3)
    array([1.768, 4.01 ])
    """
    import xarray as xr

    omegas = np.sort(np.asarray(frequencies, dtype=float))
    up, down = (
        sweep(oscillator, order, start=start, least=least, most=most, same=same) for order in (omegas, omegas[::-1])
    )
    both = {
        name: (("direction", "frequency"), np.stack([getattr(up, name), getattr(down, name)[::-1]]))
        for name in ("impact_energy", "impact_impulse", "impacts")
    }
    return xr.Dataset(both, coords={"direction": ["up", "down"], "frequency": omegas})
