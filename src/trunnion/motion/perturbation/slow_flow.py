"""What the slow amplitude and phase of a nearly harmonic motion do, whichever method gave their rates.

u = x̄ + A cos(ωt − β): A and β change slowly, steady where their rates vanish, and such a state is stable if the
eigenvalues of the rates' derivative there have negative real parts.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import solve_ivp

from trunnion.arrays import Array, Flags
from trunnion.errors import InputError
from trunnion.numerics.curves import at_place, places_at
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, internal, labelled, variable
from trunnion.results.of_systems import ending
from trunnion.results.outcome import Outcome
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Variable
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator

POINTS = 1500
CEILING = 20.0
"""Largest amplitude looked at, over the largest that damping allows anywhere in the range."""


@dataclass(frozen=True)
class SteadyState:
    """amplitude A, phase lag β [rad], mean x̄, and whether it is stable."""

    amplitude: float
    phase: float
    mean: float
    stable: bool


class ResponseCurves:
    """Half peak-to-peak over frequency, by one method or several."""

    def plot(
        self,
        axes: Axes | None = None,
        *,
        length: str = "",
        unit: str | None = None,
        marks: bool = True,
        jumps: bool = True,
        top: float | None = None,
    ) -> Axes:
        """Half peak-to-peak over frequency; see ``pictures.frequency_response``."""
        return drawing(self, "plot")(self, axes, length=length, unit=unit, marks=marks, jumps=jumps, top=top)


@labelled
class ApproximateResponse(ResponseCurves, Result):
    """A frequency response in order along its curve.

    A point of NaN parts stretches between which the curve is outside the range.
    """

    method: str = attribute("by which it was found")
    frequency: Array = variable("point", "rad/s", "of the excitation")
    amplitude: Array = variable("point", "", "half peak-to-peak")
    mean: Array = variable("point")
    stable: Flags = internal("where the motion is stable", axes="point")
    note: str = attribute("what the method leaves out")
    outcome: Outcome = internal("how it ended")

    @property
    def half_peak_to_peak(self) -> Array:
        """The amplitude: there are no other harmonics."""
        return self.amplitude

    @property
    def peak(self) -> tuple[float, float]:
        """Frequency and amplitude of the largest stable motion; NaN where there is none."""
        return largest_stable(self.frequency, self.amplitude, self.stable)

    @property
    def folds(self) -> tuple[tuple[float, float], ...]:
        """(frequency, amplitude) where the curve turns back."""
        turns = np.flatnonzero(np.diff(self.frequency)[:-1] * np.diff(self.frequency)[1:] < 0) + 1
        return tuple((float(self.frequency[i]), float(self.amplitude[i])) for i in turns)

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, stability and the ending."""
        yield from super().declared()
        yield Variable("stable", self.stable, "point")
        yield from ending(self.outcome)

    def __str__(self) -> str:
        at, size = self.peak
        return (
            f"frequency response by {self.method}: {int(np.isfinite(self.frequency).sum())} points, "
            f"{int(self.stable.sum())} stable; largest stable half peak-to-peak {size:.6g} at {at:.6g} rad/s\n"
            f"  {self.note}\n  {self.outcome}"
        )


class SlowFlow(ABC):
    """Rates of A and β of one oscillator, by one method."""

    method: str
    note: str

    def __init__(self, oscillator: PiecewiseOscillator) -> None:
        if oscillator.damping_law != "always":
            raise InputError(
                "is averaged only where damping always acts", element=oscillator.name, key="damping_law",
                value=oscillator.damping_law, remedy="use the exact motion or harmonic balance",
            )  # fmt: skip
        if oscillator.harmonics:
            raise InputError(
                "are not averaged: one harmonic of force is", element=oscillator.name, key="harmonics",
                value=oscillator.harmonics, remedy="use the exact motion",
            )  # fmt: skip
        if oscillator.force == 0:
            raise InputError(
                "is zero: nothing moves", element=oscillator.name, key="force", value=0.0, remedy="give an amplitude"
            )
        self.oscillator = oscillator

    @abstractmethod
    def rates(self, amplitude: float, phase: float, frequency: float) -> tuple[float, float]:
        """dA/dt and dβ/dt."""

    @abstractmethod
    def frequencies(self, amplitude: float) -> tuple[float, float] | None:
        """The lower and the upper frequency at which A is steady; None where no frequency holds it. The first is
        NaN where only the upper one is positive."""

    def mean(self, amplitude: float) -> float:
        """x̄ at an amplitude; 0 where a method knows none."""
        return 0.0

    def steady_phase(self, amplitude: float, frequency: float) -> float:
        """β in (0, π) at which the amplitude holds: dA/dt has its drive in sin β, dβ/dt in cos β."""
        quarter = self.rates(amplitude, np.pi / 2, frequency)
        half = self.rates(amplitude, np.pi, frequency)
        nought = self.rates(amplitude, 0.0, frequency)
        # dA/dt = d + s sin β, dβ/dt = e + r cos β.
        sine = -nought[0] / (quarter[0] - nought[0])
        drive = (nought[1] - half[1]) / 2
        cosine = -quarter[1] / drive
        return float(np.arctan2(sine, cosine))

    def is_stable(self, amplitude: float, phase: float, frequency: float) -> bool:
        """Eigenvalues of the rates' derivative left of the imaginary axis."""
        matrix = self._slope(amplitude, phase, frequency)
        return bool(np.trace(matrix) < 0 and np.linalg.det(matrix) > 0)

    def _slope(self, amplitude: float, phase: float, frequency: float) -> Array:
        """The rates' derivative (2, 2) by A and β, by central differences."""
        h, k = 1e-6 * amplitude, 1e-6
        by_a = np.subtract(self.rates(amplitude + h, phase, frequency), self.rates(amplitude - h, phase, frequency))
        by_b = np.subtract(self.rates(amplitude, phase + k, frequency), self.rates(amplitude, phase - k, frequency))
        return np.stack([by_a / (2 * h), by_b / (2 * k)], axis=1)

    def steady(self, frequency: float) -> tuple[SteadyState, ...]:
        """All steady states at one frequency, by rising amplitude."""
        curve = self.response(0.98 * frequency, 1.02 * frequency)
        found = []
        for place in places_at(curve.frequency, frequency):
            size = self._polished(at_place(curve.amplitude, place), frequency)
            phase = self.steady_phase(size, frequency)
            found.append(SteadyState(size, phase, self.mean(size), self.is_stable(size, phase, frequency)))
        return tuple(sorted(found, key=lambda s: s.amplitude))

    def _polished(self, amplitude: float, frequency: float) -> float:
        """Newton's method on the two rates, from the interpolated amplitude."""
        y = np.array([amplitude, self.steady_phase(amplitude, frequency)])
        for _ in range(8):
            y = y - np.linalg.solve(self._slope(y[0], y[1], frequency), self.rates(y[0], y[1], frequency))
        near = bool(np.isfinite(y[0])) and abs(y[0] - amplitude) < 0.05 * amplitude
        return float(y[0]) if near else amplitude

    def response(self, low: float, high: float, points: int = POINTS) -> ApproximateResponse:
        """The curve between two frequencies: for every amplitude the one or two frequencies that hold it.

        Raises
        ------
        InputError : a range that does not rise; no damping, which leaves the resonance unbounded.
        """
        if not (np.isfinite(low) and np.isfinite(high) and 0 < low < high):
            raise InputError("must be a rising range of positive frequencies", key="low, high", value=[low, high])
        o = self.oscillator
        if o.damping == 0:
            raise InputError(
                "leaves the resonant motion unbounded", element=o.name, key="damping", value=0.0,
                remedy="give some damping",
            )  # fmt: skip
        top = abs(o.force) / (o.damping * low)
        sizes = np.geomspace(1e-6 * top, CEILING * top, points)
        pairs = [self.frequencies(float(a)) for a in sizes]
        reached = [i for i, pair in enumerate(pairs) if pair is not None]
        if not reached:
            return ApproximateResponse(
                self.method, np.zeros(0), np.zeros(0), np.zeros(0), np.zeros(0, dtype=bool), self.note,
                Outcome(False, "nothing", "no amplitude is held by any frequency of the range; widen it"),
            )  # fmt: skip
        # The tip, where both frequencies meet, belongs to the curve.
        last = reached[-1]
        if last + 1 < len(sizes):
            inside, outside = float(sizes[last]), float(sizes[last + 1])
            for _ in range(60):
                middle = 0.5 * (inside + outside)
                inside, outside = (middle, outside) if self.frequencies(middle) is not None else (inside, middle)
            near = inside * (1 - np.geomspace(0.05, 1e-12, 60))
            sizes = np.append(sizes[reached], near[near > sizes[last]])
        else:
            sizes = sizes[reached]
        both = np.array([self.frequencies(float(a)) or (np.nan, np.nan) for a in sizes])
        curve = np.stack([np.append(both[:, 0], both[::-1, 1]), np.append(sizes, sizes[::-1])], axis=1)
        kept = _parted(curve[np.isfinite(curve[:, 0])], low, high)
        stable = [bool(np.isfinite(f)) and self.is_stable(a, self.steady_phase(a, f), f) for f, a in kept]
        return ApproximateResponse(
            self.method, kept[:, 0], kept[:, 1], np.array([self.mean(a) if a == a else a for a in kept[:, 1]]),
            np.array(stable, dtype=bool), self.note, Outcome(True, "computed", f"from {low:g} to {high:g} rad/s"),
        )  # fmt: skip

    def transient(self, frequency: float, amplitude: float, phase: float, times: ArrayLike) -> tuple[Array, Array]:
        """A and β at rising ``times`` from an amplitude and phase at the first of them.

        Integrated as A cos β and A sin β, which have no trouble where A passes zero.
        """
        t = np.asarray(times, dtype=float)

        def rate(_: float, y: Array) -> list[float]:
            a, b = max(float(np.hypot(*y)), 1e-12), float(np.arctan2(y[1], y[0]))
            da, db = self.rates(a, b, frequency)
            return [da * np.cos(b) - a * db * np.sin(b), da * np.sin(b) + a * db * np.cos(b)]

        first = [amplitude * np.cos(phase), amplitude * np.sin(phase)]
        run = solve_ivp(rate, (t[0], t[-1]), first, t_eval=t, rtol=1e-9, atol=1e-12)
        return np.hypot(run.y[0], run.y[1]), np.unwrap(np.arctan2(run.y[1], run.y[0]))


def _parted(curve: Array, low: float, high: float) -> Array:
    """The points (frequency, amplitude) inside the range, with one of NaN where others lay between them."""
    inside = (curve[:, 0] >= low) & (curve[:, 0] <= high)
    starts = np.flatnonzero(inside & ~np.concatenate([[True], inside[:-1]]))
    nothing = np.full((1, 2), np.nan)
    pieces = [piece[keep] for piece, keep in zip(np.split(curve, starts), np.split(inside, starts), strict=True)]
    pieces = [piece for piece in pieces if len(piece)]
    if not pieces:
        return np.zeros((0, 2))
    return np.vstack([pieces[0], *(np.vstack([nothing, piece]) for piece in pieces[1:])])


def largest_stable(frequency: Array, size: Array, stable: Flags) -> tuple[float, float]:
    """Frequency and size of the largest of the stable points, all (points,); NaN where there is none."""
    known = stable & np.isfinite(size)
    if not known.any():
        return float("nan"), float("nan")
    best = int(np.argmax(np.where(known, size, -np.inf)))
    return float(frequency[best]), float(size[best])
