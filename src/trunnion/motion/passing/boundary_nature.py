"""What the outcomes along one parameter tell of the boundary between passing a resonance and being captured by it.

A smooth boundary is crossed once from every starting phase. A folded or fractal one leaves strips, slivers, in which
the line passes between values at which it does not, or the other way round. How the number of pairs of values with
different outcomes grows with their distance ε, as ε^α, is the uncertainty exponent: 1 of a smooth boundary, less of a
fractal one
(C. Grebogi, S. W. McDonald, E. Ott, J. A. Yorke, Phys. Lett. A 99 (1983) 415).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.results.counts import counted

ENOUGH = 12
"""Changes of the outcome in the even band, from which an exponent is taken."""
SHARE = 4
"""Of the band, to which pairs of values reach."""


@dataclass(frozen=True)
class BoundaryNature:
    """Of the values tried, rising: how many, the ``low``est and ``high``est, by how much neighbours are apart in the
    even band about the boundary, relative (``apart``), and between which values that band goes (``band``).

    changes (phase,): of the outcome along the values, undecided ones left out; ``narrowest``: upper bound of the width
    of the narrowest strip, relative, NaN without one; ``edges`` (phase, 2): between which values each phase changes for
    the last time, NaN where it does not; ``exponent`` and its standard ``error``, NaN where there are too few changes.
    """

    tried: int
    low: float
    high: float
    band: tuple[float, float]
    apart: float
    changes: Integers
    edges: Array
    narrowest: float
    exponent: float
    error: float

    @property
    def kind(self) -> str:
        """ "one edge" where no phase changes more than once, "slivers" where some does, "none" without a change."""
        if not self.changes.any():
            return "none"
        return "slivers" if (self.changes > 1).any() else "one edge"

    def sentences(self, what: str, number: str = "{:.4g}") -> Iterator[str]:
        """In words; ``what`` is tried, in the plural, each printed by ``number``."""
        low, high = (number.format(one) for one in self.band)
        looked = (
            f"looked for slivers at {what} {100 * self.apart:.2g} % apart from {low} to {high}; narrower ones, and "
            "those elsewhere between what was tried, are not excluded"
        )
        if self.kind == "none":
            return
        if self.kind == "one edge":
            first, last = np.nanmin(self.edges[:, 1]), np.nanmax(self.edges[:, 1])
            same = last <= first * (1 + 2 * self.apart)
            where = (
                "at the same place" if same else f"from {number.format(first)} to {number.format(last)}, by the phase"
            )
            yield (
                f"the boundary is one edge at every starting phase, {where}"
                if len(self.changes) > 1
                else ("the boundary is one edge")
            )
        else:
            several = int((self.changes > 1).sum())
            yield (
                f"the boundary has slivers: from {counted(several, 'starting phase')} of {len(self.changes)} the "
                f"outcome changes up to {int(self.changes.max())} times; the narrowest strip seen is at most "
                f"{100 * self.narrowest:.2g} % wide"
            )
            if np.isfinite(self.exponent):
                yield f"uncertainty exponent {self.exponent:.2f} ± {self.error:.2g} (1: smooth; less: fractal)"
        yield looked


def boundary_nature(values: Array, passed: Array, band: Array) -> BoundaryNature:
    """The nature of a boundary.

    Parameters
    ----------
    values : (m,), rising.
    passed : (m, phase), 1 where the line passes, 0 where not, NaN where that is not decided.
    band : those of the values (k,) that are even in the logarithm about the boundary; empty where there is none.
    """
    phases = passed.shape[1]
    changes, edges, narrowest = np.zeros(phases, dtype=np.int64), np.full((phases, 2), np.nan), np.nan
    for p in range(phases):
        known = np.isfinite(passed[:, p])
        at, outcome = values[known], passed[known, p]
        turns = np.flatnonzero(outcome[1:] != outcome[:-1])
        changes[p] = len(turns)
        if len(turns):
            edges[p] = at[turns[-1]], at[turns[-1] + 1]
        for one, other in zip(turns, turns[1:], strict=False):  # a strip from at[one + 1] to at[other]
            narrowest = float(np.nanmin([narrowest, at[other + 1] / at[one] - 1]))
    inside = np.isin(values, band)
    exponent, error = uncertainty_exponent(passed[inside])
    steps = band[1:] / band[:-1] if len(band) > 1 else values[1:] / values[:-1]
    ends = (float(band[0]), float(band[-1])) if len(band) else (float(values[0]), float(values[-1]))
    apart = float(steps.max()) - 1 if len(steps) else np.nan
    return BoundaryNature(
        tried=len(values), low=float(values[0]), high=float(values[-1]), band=ends, apart=apart, changes=changes,
        edges=edges, narrowest=narrowest, exponent=exponent, error=error,
    )  # fmt: skip


def uncertainty_exponent(passed: Array) -> tuple[float, float]:
    """Exponent of the number of pairs with different outcomes over their distance, and its standard error, of outcomes
    (m, phase) at even values; NaN where the outcome changes too seldom."""
    count = len(passed)
    lags = [1]
    while 2 * lags[-1] <= count // SHARE:
        lags.append(2 * lags[-1])
    if len(lags) < 3:
        return np.nan, np.nan
    most = lags[-1]
    pairs = []
    for lag in lags:  # the same number of pairs at every distance, about the same middle
        first = (most - lag) // 2
        one, other = passed[first : first + count - most], passed[first + lag : first + lag + count - most]
        pairs.append(int(((one != other) & np.isfinite(one) & np.isfinite(other)).sum()))
    if min(pairs) < ENOUGH:
        return np.nan, np.nan
    x, y = np.log(lags), np.log(pairs)
    slope, cut = np.polyfit(x, y, 1)
    spread = np.sqrt(((y - slope * x - cut) ** 2).sum() / (len(x) - 2) / ((x - x.mean()) ** 2).sum())
    return float(slope), float(spread)
