"""Lyapunov exponents as a result: prints itself, is a dataset, draws its convergence."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.numerics.averages import CONFIDENCE
from trunnion.numerics.integration.integration import End
from trunnion.results.declared import Held, Result, about, axis, over
from trunnion.results.drawing import Axes, drawing
from trunnion.results.outcome import Outcome
from trunnion.systems.system import System

HISTORY = 400
"""Points of a history of convergence."""


def shear_bound(samples: int, interval: float) -> float:
    """Twice ln N / T [1/s], N samples in time T: neighbours of a regular motion part in proportion to time where their
    frequencies differ, so that for so long they seem to part at the rate ln t / t."""
    return 2 * float(np.log(max(samples, 2))) / (max(samples, 1) * interval)


@dataclass(frozen=True)
class Run:
    """One motion: growth (samples, k) of its frame, ∫ tr ∂f/∂x dt (samples,) where it was needed, states
    (1 + samples, n) before, between and after the samples, how it ended, samples wanted."""

    growth: Array
    divergence: Array
    states: Array
    end: End
    wanted: int


@dataclass(frozen=True, repr=False)
class LyapunovSpectrum(Result):
    """Exponents of a system's motion, the largest first.

    exponents, half_width (k,) [1/s]: means over all starts and half of their intervals of confidence (95 %), never
    less than the error of the sum, nor than ``shear`` where exponents lie together at 0. by_start,
    by_start_half_width (starts, k). divergence [1/s]: what the sum must be, NaN where not all exponents were asked for
    or the motion jumps. interval [s] of a sample; windowed: averaged with a smooth window (see ``numerics.averages``).
    """

    system: System
    exponents: Array
    half_width: Array
    starts: Array
    by_start: Array
    by_start_half_width: Array
    divergence: float
    interval: float
    transient: int
    runs: tuple[Run, ...]
    tolerance: float
    windowed: bool
    outcome: Outcome

    @property
    def largest(self) -> float:
        """The largest exponent [1/s]."""
        return float(self.exponents[0])

    @property
    def sum(self) -> float:
        """Sum of the exponents [1/s]."""
        return float(self.exponents.sum())

    @property
    def sum_error(self) -> float:
        """How far the sum is from the mean divergence [1/s]; NaN where that is not known."""
        return abs(self.sum - self.divergence)

    @property
    def samples(self) -> int:
        """Samples of the shortest run."""
        return min(len(run.growth) for run in self.runs)

    @property
    def positive(self) -> bool:
        """Whether the largest exponent is above 0 by more than its interval, and above what shear alone may show."""
        return bool(self.exponents[0] > max(self.half_width[0], self.shear))

    @property
    def shear(self) -> float:
        """What the largest exponent of a regular motion may seem to be [1/s] after so long; see ``shear_bound``."""
        return shear_bound(self.samples, self.interval)

    @property
    def agree(self) -> bool:
        """Whether every start gives the same exponents, to three times their intervals.

        A difference below 1e-4 of the largest exponent in size is none.
        """
        low = float(np.nanmax(np.abs(self.exponents), initial=0.0)) * 1e-4
        apart = np.abs(self.by_start - np.nanmean(self.by_start, axis=0)) if len(self.by_start) > 1 else np.zeros(1)
        allowed = 3 * self.by_start_half_width + low if len(self.by_start) > 1 else np.ones(1)
        return not bool(np.any(apart > allowed))

    @property
    def dimension(self) -> float:
        """Kaplan–Yorke dimension of the attractor, a forced system's phase not counted; NaN if not all exponents
        were asked for, or volumes do not shrink."""
        if len(self.exponents) < self.system.size:
            return float("nan")
        total = np.cumsum(self.exponents)
        if total[-1] >= 0:
            return float(self.system.size) if total[-1] <= self.half_width.sum() else float("nan")
        k = int(np.argmax(total < 0))
        return float(k + (total[k - 1] if k else 0.0) / -self.exponents[k])

    @property
    def histories(self) -> tuple[Array, Array]:
        """Times (points,) [s] and running means (starts, points, k) of the exponents up to each."""
        samples = self.samples
        if samples == 0:
            return np.empty(0), np.empty((len(self.runs), 0, len(self.exponents)))
        places = np.unique(np.geomspace(1, samples, HISTORY).astype(int))
        means = [
            np.cumsum(r.growth[:samples], axis=0)[places - 1] / (places[:, None] * self.interval) for r in self.runs
        ]
        return places * self.interval, np.array(means)

    def declared(self) -> Iterator[Held]:
        """Exponents [1/s] with half-widths, of each start too, their running means over time, and the sum rule."""
        time, history = self.histories
        yield axis("order", np.arange(1, len(self.exponents) + 1))
        yield axis("time", time, "s")
        yield axis("state", self.system.states)
        yield over("order", "exponent", self.exponents, "1/s")
        yield over("order", "half_width", self.half_width, "1/s")
        yield over("start order", "exponent_of_start", self.by_start, "1/s")
        yield over("start order", "half_width_of_start", self.by_start_half_width, "1/s")
        yield over("start time order", "running_mean", history, "1/s")
        yield over("start state", "start_state", self.starts)
        rule = {} if np.isnan(self.divergence) else {"divergence": self.divergence, "sum_error": self.sum_error}
        yield from about(
            self.system, self.outcome, sum=self.sum, **rule, confidence=CONFIDENCE, interval=self.interval,
            samples=self.samples, transient=self.transient, tolerance=self.tolerance,
            averaging="windowed" if self.windowed else "plain",
        )  # fmt: skip

    def plot(self, axes: Axes | None = None) -> Axes:
        """Running means of the exponents over time."""
        return drawing(self, "plot")(self, axes)

    def __str__(self) -> str:
        unit = "forcing period" if self.system.forcing_period is not None else "sample"
        head = (
            f"Lyapunov exponents of {self.system.name}, natural logarithm, {len(self.runs)} × {self.samples} "
            f"{unit}s of {self.interval:.6g} s after {self.transient}"
        )
        rows = [
            f"  L{i} = {value:+.6g} ± {width:.2g} 1/s"
            for i, (value, width) in enumerate(zip(self.exponents, self.half_width, strict=True), start=1)
        ]
        rule = "not checked" if np.isnan(self.divergence) else f"{self.divergence:.10g}, off by {self.sum_error:.1e}"
        rows.append(f"  sum {self.sum:.10g} 1/s (mean divergence: {rule})")
        if np.isfinite(self.dimension) and self.outcome.ok:
            rows.append(f"  Kaplan–Yorke dimension {self.dimension:.4g}")
        return "\n".join([head, *rows, f"  {self.outcome}"])
