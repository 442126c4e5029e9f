"""Periodic motions of a piecewise linear oscillator by shooting with its exact motion.

P(x, x′) over one or several forcing periods and its derivative are exact to rounding (``numerics/piecewise``), so
Newton's method closes the orbit to rounding and the multipliers are those of the motion itself. An orbit that
touches a breakpoint (grazing) has no derivative there; ``clearance`` says how near it is.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import overload

import numpy as np
from numpy.typing import ArrayLike

from trunnion.analyses.orbits.closing import by_modulus, checked_periods, close, refuse_speed
from trunnion.analyses.orbits.exact_map import OscillatorMap
from trunnion.analyses.orbits.exact_orbit import ExactOrbit, exact_orbit
from trunnion.analyses.orbits.judging import ExactClosing, exact_verdict
from trunnion.analyses.orbits.spring_contacts import contact_state
from trunnion.arrays import Array, Complex
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError
from trunnion.numerics.curves import fourier
from trunnion.numerics.piecewise_linear.piecewise import Passage, move, states
from trunnion.results.declared import Held, Result, axis, ending, over, remark
from trunnion.results.outcome import Outcome
from trunnion.results.speeds import frequency_unit, show_speed
from trunnion.results.verdict import MEANING, Verdict
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator

NUMBERS = ("lowest", "highest", "mean", "peak_to_peak", "impacts", "impact_energy", "impact_impulse", "clearance")
CONTACT = ("none", "upper", "lower", "both")
"""Sides touched, by the code of the measurement."""


@dataclass(frozen=True, repr=False)
class PiecewiseOrbit(Result):
    """A periodic motion and what it does in a forcing period.

    start (2,): x and x′ at phase zero; periods: forcing periods until it closes; multipliers (2,) by falling modulus;
    crossings (count, 4): time, x, x′ and regime begun; lowest, highest, mean of x; sides touched; impacts: entries
    into contact, per forcing period, with Σ m v²/2 (impact_energy) and Σ m |v| (impact_impulse) of them; clearance:
    least distance of an extremum from a breakpoint; iterations of the shooting.
    """

    oscillator: PiecewiseOscillator
    start: Array
    periods: int
    multipliers: Complex
    monodromy: Array
    crossings: Array
    lowest: float
    highest: float
    mean: float
    sides: str
    impacts: float
    impact_energy: float
    impact_impulse: float
    clearance: float
    iterations: int
    outcome: Outcome

    @property
    def peak_to_peak(self) -> float:
        """Highest minus lowest x."""
        return self.highest - self.lowest

    @property
    def contact(self) -> str:
        """none, one-sided or two-sided."""
        return contact_state(self.sides)

    @property
    def verdict(self) -> Verdict:
        """Stable, unstable, or not told apart."""
        return exact_verdict(self.multipliers)

    def motion(self, count: int = 512) -> tuple[Array, Array]:
        """Times (count,) over the orbit's period, its end left out, and states (count, 2)."""
        o = self.oscillator
        times = self.periods * o.period * np.arange(count) / count
        return times, states(o.regimes, o.coefficients, o.frequency, self.start, times)

    def harmonics(self, highest: int) -> Complex:
        """Fourier coefficients (highest + 1,) of x: x = Re Σ c_k e^{2πikt/T}, integrated between its crossings."""
        o = self.oscillator

        def x(times: Array) -> Array:
            found = states(o.regimes, o.coefficients, o.frequency, self.start, np.concatenate([[0.0], times]))
            return found[1:, :1]

        cuts = np.unique(np.concatenate([[0.0], self.crossings[:, 0], [self.periods * o.period]]))
        return fourier(x, cuts, highest)[:, 0]

    def declared(self) -> Iterator[Held]:
        """The motion over its period, its crossings and multipliers, and the numbers read off it."""
        times, motion = self.motion() if self.outcome.ok else (np.zeros(0), np.zeros((0, 2)))
        yield axis("time", times, "s")
        yield over("time", "x", motion[:, 0])
        yield over("time", "v", motion[:, 1])
        yield over("crossing", "crossing_time", self.crossings[:, 0], "s")
        yield over("multiplier_number", "multiplier", self.multipliers, "1")
        for name in NUMBERS:
            yield over("", name, getattr(self, name))
        yield remark("oscillator", self.oscillator.name)
        yield remark("verdict", str(self.verdict))
        yield remark("contact", self.contact)
        yield remark("periods", self.periods)
        yield from ending(self.outcome)

    def __str__(self) -> str:
        if not self.outcome.ok:
            return f"no periodic motion of {self.oscillator.name}: {self.outcome}"
        at = show_speed(self.oscillator.frequency, frequency_unit(self.oscillator.speed_unit))
        return (
            f"{self.verdict} periodic motion of {self.oscillator.name} at ω = {at} "
            f"over {self.periods} forcing period{'s' if self.periods > 1 else ''}: {MEANING[self.verdict]}\n"
            f"  x = {self.mean:.6g} with {self.peak_to_peak:.6g} peak to peak; contact {self.contact}, "
            f"{self.impacts:g} impacts per period; {self.clearance:.2g} from grazing\n"
            f"  multipliers {self.multipliers[0]:.8g}, {self.multipliers[1]:.8g}; {self.outcome}"
        )


def refuse_unbounded(oscillator: PiecewiseOscillator) -> None:
    """Refuse a linear oscillator driven, undamped, at its own frequency.

    Raises
    ------
    InputError : its motion grows without bound.
    """
    c, s, _ = oscillator.regimes.pieces[0]
    force = oscillator.coefficients
    for k in range(1, len(force)) if len(oscillator.slopes) == 1 and c == 0 else ():
        if force[k] != 0 and abs(s - (k * oscillator.frequency) ** 2) < 1e-7 * s:
            raise InputError(
                "makes the undamped resonant motion grow without bound: there is no periodic motion",
                element=oscillator.name, key="damping", value=0.0, remedy="give some damping or another frequency",
            )  # fmt: skip


@overload
def piecewise_orbit(
    oscillator: PiecewiseOscillator, start: ArrayLike | None = None, *, periods: int = 1, settle: bool = True
) -> PiecewiseOrbit: ...
@overload
def piecewise_orbit(
    oscillator: Driveline | Assembly,
    start: ArrayLike | None = None,
    *,
    speed: float | None = None,
    periods: int = 1,
    settle: bool = True,
) -> ExactOrbit: ...


def piecewise_orbit(
    oscillator: PiecewiseOscillator | Driveline | Assembly,
    start: ArrayLike | None = None,
    *,
    speed: float | None = None,
    periods: int = 1,
    settle: bool = True,
) -> PiecewiseOrbit | ExactOrbit:
    """The periodic motion near ``start``, stable or not.

    Parameters
    ----------
    oscillator : or a driveline that ``exact_motion`` takes.
    start : x and x′ near it at phase zero, by default rest at the static equilibrium; of a driveline twists and rates
        (2m,) as in ``exact_motion``.
    speed : of a driveline as in ``exact_motion``.
    periods : forcing periods in one period of the motion.
    settle : where shooting fails, let 50 and then 500 periods pass and shoot again.

    Returns
    -------
    An orbit whose ``outcome`` says whether it was found; otherwise its numbers are NaN. Of a driveline an
    ``ExactOrbit``.

    Raises
    ------
    InputError : a start that is not two finite numbers; an undamped linear resonance; a driveline that has no exact
        motion, no excitation or none with a common period.
    """
    periods = checked_periods(periods)
    if isinstance(oscillator, Driveline | Assembly):
        return exact_orbit(oscillator, start, speed=speed, periods=periods, settle=settle)
    refuse_speed(oscillator.name, speed)
    first = np.array([oscillator.equilibrium(), 0.0] if start is None else start, dtype=float)
    if first.shape != (2,) or not np.isfinite(first).all():
        raise InputError("must be x and x′, two finite numbers", element=oscillator.name, key="start", value=start)
    refuse_unbounded(oscillator)
    over_period = OscillatorMap.of(oscillator, periods)
    closing, root = close(first, lambda guess: ExactClosing(over_period, over_period.scale(first)), settle=settle)
    if root.converged:
        return orbit_at(oscillator, root.x, periods, root.iterations)
    words = (
        f"shooting did not converge (residual {root.size:.1e}); start closer, for example from the end of a sweep, or "
        "give more periods if the motion is a subharmonic"
    )
    return _missing(oscillator, root.x, periods, root.iterations, words)


def orbit_at(oscillator: PiecewiseOscillator, start: Array, periods: int, iterations: int = 0) -> PiecewiseOrbit:
    """The orbit through a state known to lie on it."""
    over_period = OscillatorMap.of(oscillator, periods)
    passage, found = over_period(start), over_period.measure(start)
    closes = float(np.abs(passage.state - start).max())
    return PiecewiseOrbit(
        oscillator=oscillator,
        start=start,
        periods=periods,
        multipliers=by_modulus(passage.tangents),
        monodromy=passage.tangents,
        crossings=passage.run.crossings,
        lowest=found["low"],
        highest=found["high"],
        mean=found["mean"],
        sides=CONTACT[int(found["contact"])],
        impacts=found["impacts"],
        impact_energy=oscillator.inertia * found["energy"],
        impact_impulse=oscillator.inertia * found["impulse"],
        clearance=_clearance(oscillator, start, periods),
        iterations=iterations,
        outcome=Outcome(True, "found", f"closes to {closes:.1e} after {iterations} iterations"),
    )


def _clearance(oscillator: PiecewiseOscillator, start: Array, periods: int) -> float:
    if not oscillator.breakpoints:
        return float("inf")
    end = periods * oscillator.period
    run: Passage = move(
        oscillator.regimes, oscillator.coefficients, oscillator.frequency, start, 0.0, end, tangents=False, extrema=True
    )
    extrema = run.events[run.events[:, 3] < 0, 1]
    if not len(extrema):
        return float("inf")
    return float(np.abs(extrema[:, None] - np.array(oscillator.breakpoints)).min())


def _missing(
    oscillator: PiecewiseOscillator, start: Array, periods: int, iterations: int, words: str
) -> PiecewiseOrbit:
    nan = float("nan")
    return PiecewiseOrbit(
        oscillator, start, periods, np.full(2, nan, dtype=complex), np.full((2, 2), nan), np.zeros((0, 4)),
        nan, nan, nan, "none", nan, nan, nan, nan, iterations, Outcome(False, "not converged", words),
    )  # fmt: skip
