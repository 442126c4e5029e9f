"""A piecewise linear oscillator, or a driveline, on the bench: a value raised or lowered step by step.

Each step goes on from where the last one ended, settles and is then measured. Also the rattle index, what the impacts
of a period amount to, over frequency.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Generic, NamedTuple, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike

from trunnion.analyses.motion.exact_motion import start_state
from trunnion.analyses.orbits.closing import refuse_speed
from trunnion.analyses.orbits.exact_map import LineMap, OscillatorMap
from trunnion.analyses.orbits.piecewise_branch import line_over
from trunnion.analyses.orbits.piecewise_orbit import CONTACT, contacts_of, refuse_unbounded
from trunnion.analyses.orbits.spring_contacts import SpringContact, contact_state
from trunnion.analyses.orbits.sweep_result import LineSweep, Sweep
from trunnion.arrays import Array, Flags, Integers
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError
from trunnion.numerics.memory import require_memory
from trunnion.numerics.piecewise_linear.piecewise import COLUMNS
from trunnion.numerics.piecewise_linear.staged_flow import kernel
from trunnion.results.outcome import Outcome
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator

if TYPE_CHECKING:
    import xarray as xr

Place = TypeVar("Place", OscillatorMap, LineMap)
Seen = TypeVar("Seen")
Torques = tuple[Array, Array, Array, tuple[SpringContact, ...]]
"""Lowest and highest torque of every spring, the state that they follow from, and the contacts."""
LEAST, MOST, SAME, MEASURED = 20, 2000, 1e-11, 64
"""Periods of a step at least and at most; change per period that counts as settled; periods measured otherwise."""
BYTES_A_STEP = 128.0
"""What one frequency holds for each number of the state."""


@overload
def sweep(
    oscillator: PiecewiseOscillator,
    frequencies: ArrayLike,
    *,
    start: ArrayLike | None = None,
    least: int = LEAST,
    most: int = MOST,
    same: float = SAME,
) -> Sweep: ...
@overload
def sweep(
    oscillator: Driveline | Assembly,
    frequencies: ArrayLike,
    *,
    start: ArrayLike | None = None,
    speed: float | None = None,
    least: int = LEAST,
    most: int = MOST,
    same: float = SAME,
) -> LineSweep: ...


def sweep(
    oscillator: PiecewiseOscillator | Driveline | Assembly,
    frequencies: ArrayLike,
    *,
    start: ArrayLike | None = None,
    speed: float | None = None,
    least: int = LEAST,
    most: int = MOST,
    same: float = SAME,
) -> Sweep | LineSweep:
    """Steady motions over ``frequencies`` in the order given: rising for an up-sweep, falling for a down-sweep.

    Parameters
    ----------
    oscillator : or a driveline that ``exact_motion`` takes, which is swept over its speed, or over the common
        frequency of its excitations where those are in time.
    frequencies : (points,) [rad/s]; of a driveline speeds, where its excitation turns with it.
    start : state at the first: x and x′, by default rest at the static equilibrium; of a driveline as in
        ``exact_motion``.
    speed : of a driveline excited in time, where a viscous load depends on it.
    least, most : periods of every step.
    same : relative change of the state per period below which, three times running, a motion counts as settled.

    Returns
    -------
    Sweep; of a driveline LineSweep with the torques of its springs.

    Raises
    ------
    InputError : frequencies that are not positive, an undamped linear resonance among them; a driveline without exact
        motion, or excited both by its rotation and in time.
    """
    omegas = np.ascontiguousarray(np.atleast_1d(np.asarray(frequencies, dtype=float)))
    if not (omegas.ndim == 1 and len(omegas) and np.isfinite(omegas).all() and (omegas > 0).all()):
        raise InputError("must be positive numbers", key="frequencies", value=np.asarray(frequencies).tolist())
    if not 1 <= least <= most:
        raise InputError("must be from 1, and no less than least", key="least, most", value=[least, most])
    line = oscillator.line if isinstance(oscillator, Assembly) else oscillator
    states = 2 * len(line.elements) if isinstance(line, Driveline) else 2
    needed = BYTES_A_STEP * states * len(omegas)
    require_memory(needed, key="frequencies", value=len(omegas), remedy="ask for fewer frequencies")
    if isinstance(oscillator, Driveline | Assembly):
        return _of_line(oscillator, omegas, start, speed, least, most, same)
    refuse_speed(oscillator.name, speed)
    for omega in omegas:
        refuse_unbounded(oscillator.but(frequency=float(omega)))
    first = np.array([oscillator.equilibrium(), 0.0] if start is None else start, dtype=float)
    maps = [OscillatorMap(float(omega), 1, oscillator) for omega in omegas]
    lost = "the motion at ω = {:g} crosses too often in a period; raise damping"
    steps = _stepped(maps, first, least, most, same, _measured, lost)
    rows = np.full((len(omegas), len(COLUMNS)), np.nan)
    for row, seen in zip(rows, steps.seen, strict=False):
        row[:] = list(seen.values())
    column = dict(zip(COLUMNS, rows.T, strict=True))
    sides = [CONTACT[int(c)] if np.isfinite(c) else "none" for c in column["contact"]]
    return Sweep(
        oscillator=oscillator,
        frequency=omegas,
        lowest=column["low"],
        highest=column["high"],
        mean=column["mean"],
        contact=tuple(contact_state(s) for s in sides),
        impacts=column["impacts"],
        impact_energy=oscillator.inertia * column["energy"],
        impact_impulse=oscillator.inertia * column["impulse"],
        settled=steps.settled,
        periods=steps.periods,
        state=np.stack([column["x"], column["v"]], axis=1),
        outcome=steps.outcome,
    )


def _measured(place: OscillatorMap, state: Array) -> tuple[dict[str, float], Array] | None:
    row = place.measure(state)
    return (row, np.array([row["x"], row["v"]])) if row else None


def _of_line(
    line: Driveline | Assembly,
    values: Array,
    start: ArrayLike | None,
    speed: float | None,
    least: int,
    most: int,
    same: float,
) -> LineSweep:
    prepared = line_over(line, float(values[0]), speed)
    maps = [LineMap(float(value), 1, prepared) for value in values]
    first = start_state(prepared, start)[maps[0].kept]
    lost = "the motion at {:g} rad/s changes its stages too often in a period; raise damping"
    steps = _stepped(maps, first, least, most, same, _watched, lost)
    count, springs = len(values), len(prepared.springs)
    low, high = np.full((2, count, springs), np.nan)
    states = np.full((count, 2 * prepared.size), np.nan)
    names = [prepared.springs[e] for e in prepared.staged]
    nothing = tuple(SpringContact(name, np.zeros(0), np.nan, "none", np.zeros(0), np.nan) for name in names)
    contacts = [nothing] * count
    for i, seen in enumerate(steps.seen):
        low[i], high[i], states[i], contacts[i] = seen
    return LineSweep(prepared, values, low, high, tuple(contacts), steps.settled, steps.periods, states, steps.outcome)


def _watched(
    place: LineMap, state: Array
) -> tuple[tuple[Array, Array, Array, tuple[SpringContact, ...]], Array] | None:
    run, start, k = place.watched(state), place.whole(state), kernel()
    if not run.done:
        return None
    seen = run.seen[: len(place.line.springs)]
    contacts = contacts_of(place, start, run)
    return (seen[:, k.TORQUE_LOW], seen[:, k.TORQUE_HIGH], start, contacts), run.state[place.kept]


class _Steps(NamedTuple, Generic[Seen]):
    """Whether each step settled and after how many periods, both (points,), and what was seen of those run."""

    settled: Flags
    periods: Integers
    seen: list[Seen]
    outcome: Outcome


def _stepped(
    maps: Sequence[Place],
    start: Array,
    least: int,
    most: int,
    same: float,
    measure: Callable[[Place, Array], tuple[Seen, Array] | None],
    lost: str,
) -> _Steps[Seen]:
    """Every map from where the one before it ended, measured over one period where the motion repeats, else over many.

    measure : (map, state at phase zero) → what is seen over its periods, and the state after them; None where it cannot
    be followed, of which ``lost`` is said with the value.
    """
    steps = _Steps[Seen](
        np.zeros(len(maps), dtype=bool), np.zeros(len(maps), dtype=np.int64), [],
        Outcome(True, "swept", "every step was run"),
    )  # fmt: skip
    state = start
    for i, place in enumerate(maps):
        found = place.steady(state, least, most, same)
        steps.settled[i], steps.periods[i] = found.repeats, found.periods
        over = replace(place, periods=1 if found.repeats else MEASURED)
        measured = measure(over, found.state) if found.done else None
        if measured is None:
            return steps._replace(outcome=Outcome(False, "chatter", lost.format(place.value)))
        steps.seen.append(measured[0])
        state = measured[1]
    return steps


def rattle_index(
    oscillator: PiecewiseOscillator,
    frequencies: ArrayLike,
    *,
    start: ArrayLike | None = None,
    least: int = LEAST,
    most: int = MOST,
    same: float = SAME,
) -> xr.Dataset:
    """Impulse and energy of the impacts per period over ``frequencies`` [rad/s], swept up and down as ``sweep`` does.

    Dataset with impact_energy [m v²] and impact_impulse [m v], dimensions (direction, frequency); 0 without impacts.
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
