"""A piecewise linear oscillator, or a driveline, on the bench: settled motion over frequency, up or down.

Also the rattle index, what the impacts of a period amount to, over frequency.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, overload

import numpy as np
from numpy.typing import ArrayLike

from trunnion.analyses.orbits.closing import refuse_speed
from trunnion.analyses.orbits.exact_map import OscillatorMap
from trunnion.analyses.orbits.exact_sweep import LineSweep, exact_sweep
from trunnion.analyses.orbits.piecewise_orbit import CONTACT, refuse_unbounded
from trunnion.analyses.orbits.spring_contacts import contact_state
from trunnion.analyses.orbits.sweeping import LEAST, MOST, SAME, jumps, stepped, upwards
from trunnion.arrays import Array, Flags, Integers
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError
from trunnion.numerics.memory import require_memory
from trunnion.numerics.piecewise_linear.piecewise import COLUMNS
from trunnion.results.declared import Held, Result, axis, ending, over, remark
from trunnion.results.drawing import Axes, drawing
from trunnion.results.outcome import Outcome
from trunnion.results.speeds import frequency_unit, speed_factor
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator

if TYPE_CHECKING:
    import xarray as xr

BYTES_A_STEP = 128.0
"""What one frequency holds for each number of the state."""


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
        return upwards(self.frequency)

    @property
    def jumps(self) -> tuple[tuple[float, float], ...]:
        """Pairs of neighbouring frequencies between which the swing changes abruptly, in the order swept."""
        return jumps(self.frequency, self.peak_to_peak[:, None])

    def declared(self) -> Iterator[Held]:
        """Extremes, impacts and contact over frequency."""
        names = ("lowest", "highest", "mean", "peak_to_peak", "impacts", "impact_energy", "impact_impulse", "settled")
        yield axis("frequency", self.frequency, "rad/s")
        for name in names:
            yield over("frequency", name, np.asarray(getattr(self, name)))
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
        jumps = ", ".join(f"{a * factor:.6g} → {b * factor:.6g}" for a, b in self.jumps) or "none"
        low, high, largest = (self.frequency[i] * factor for i in (0, -1, best))
        rough = int((~self.settled).sum())
        kinds = ", ".join(f"{self.contact.count(k)} {k}" for k in ("none", "one-sided", "two-sided"))
        return (
            f"sweep {'up' if self.up else 'down'} of {self.oscillator.name}, {len(self.frequency)} frequencies from "
            f"{low:.6g} to {high:.6g} {self.unit}, {rough} without a motion of one period\n"
            f"  largest half peak-to-peak {self.peak_to_peak[best] / 2:.6g} at {largest:.6g}; "
            f"jumps: {jumps}\n"
            f"  contact: {kinds}; {self.outcome}"
        )


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
        return exact_sweep(oscillator, omegas, start=start, speed=speed, least=least, most=most, same=same)
    refuse_speed(oscillator.name, speed)
    for omega in omegas:
        refuse_unbounded(oscillator.but(frequency=float(omega)))
    first = np.array([oscillator.equilibrium(), 0.0] if start is None else start, dtype=float)
    maps = [OscillatorMap(float(omega), 1, oscillator) for omega in omegas]
    rows, settled = np.full((len(omegas), len(COLUMNS)), np.nan), np.zeros(len(omegas), dtype=bool)
    periods, outcome = np.zeros(len(omegas), dtype=np.int64), Outcome(True, "swept", "every step was run")
    for i, (found, row) in enumerate(stepped(maps, first, least, most, same, _measured)):
        settled[i], periods[i] = found.repeats, found.periods
        if row is None:
            words = f"the motion at ω = {omegas[i]:g} crosses too often in a period; raise damping"
            outcome = Outcome(False, "chatter", words)
            break
        rows[i] = list(row.values())
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
        settled=settled,
        periods=periods,
        state=np.stack([column["x"], column["v"]], axis=1),
        outcome=outcome,
    )


def _measured(place: OscillatorMap, state: Array) -> tuple[dict[str, float] | None, Array]:
    row = place.measure(state)
    return row or None, np.array([row.get("x", np.nan), row.get("v", np.nan)])


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
