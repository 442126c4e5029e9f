"""Which parameters of a sampled study a quantity follows: Sobol indices of a Saltelli design, with intervals.

First-order indices are the share of the variance that a parameter explains alone, total ones what would be left if all
others were known. Of other sampled points (Sobol, Latin) first-order shares come from classes of each parameter, less
what chance alone would make.
"""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
from scipy.stats import sobol_indices

from trunnion.arrays import Array
from trunnion.driveline.arguments import one_number
from trunnion.errors import ComputationError, InputError
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, coordinate, internal, labelled, variable
from trunnion.results.result import Result
from trunnion.studies.points import DONE
from trunnion.studies.result import Study

RESAMPLES = 999
"""Of the bootstrap."""
FEWEST = 64
"""Points below which shares by classes say nothing."""
A_CLASS = 16
"""Points in a class, at least."""
MOST_CLASSES = 32


@labelled
class SobolIndices(Result):
    """Shares of the variance of a quantity by parameter; intervals by bootstrap, NaN where there are none."""

    parameter: tuple[str, ...] = coordinate("parameter")
    first: Array = variable("parameter", "1", "explained alone", name="first_order")
    total: Array = variable("parameter", "1", "left when all others are known; NaN without a Saltelli design")
    first_interval: Array = internal("low and high", axes="parameter end")
    total_interval: Array = internal("low and high", axes="parameter end")
    quantity: str = attribute("whose variance is shared")
    points: int = attribute("that it rests on")
    confidence: float = attribute("of the intervals")
    variance: float = internal("of the quantity")

    def plot(self, axes: Axes | None = None) -> Axes:
        """Shares by parameter, with intervals; see ``pictures.studies.shares``."""
        return drawing(self, "plot")(self, axes)

    def _lines(self) -> Iterator[str]:
        yield f"variance of {self.quantity} by parameter, from {self.points} points"
        score = np.where(np.isfinite(self.total), self.total, self.first)
        for k in np.argsort(-score, kind="stable").tolist():
            alone = _with_interval(self.first[k], self.first_interval[k])
            text = f"  {self.parameter[k]}: {alone} alone"
            if np.isfinite(self.total[k]):
                text += f", {_with_interval(self.total[k], self.total_interval[k])} with all others"
            yield text


def study_sensitivities(study: Study, quantity: str, *, confidence: float = 0.95, seed: int = 0) -> SobolIndices:
    """Which parameters of a sampled study a quantity follows: Sobol indices, or shares by classes.

    A Saltelli design (``method = "saltelli"``) gives first-order and total indices with intervals by bootstrap; other
    samples the share that each parameter explains alone.

    Parameters
    ----------
    study : whose points were sampled; axes beside the sampling plan are refused.
    quantity : a number that it kept.
    confidence : of the intervals by bootstrap.
    seed : of the bootstrap.

    Raises
    ------
    InputError : nothing was sampled; a quantity that is not a number.
    ComputationError : points are missing or failed, so that the design is not whole; too few of them; no variance.

    Examples
    --------
    >>> import trunnion as tn
    >>> from pathlib import Path
    >>> from tempfile import mkdtemp
    >>> asked = {"line": "two-shaft-cardan", "analysis": "natural_frequencies", "quantities": "frequency[0]"}
    >>> asked["store"] = str(Path(mkdtemp()) / "springs.zarr")
    >>> asked["sampling"] = {"method": "saltelli", "points": 64}
    >>> asked["parameter"] = [{"path": f"Shaft {k}.stiffness", "tolerance": "10 %"} for k in (1, 2)]
    >>> found = tn.study_sensitivities(tn.study(asked, workers=0), "frequency[0]")
    >>> found.parameter
    ('Shaft 1.stiffness', 'Shaft 2.stiffness')
    """
    plan = study.design.sampling
    if plan is None or study.design.axes:
        raise InputError("is not sampled alone", key="study", value=study.store,
                         remedy='leave out points and values of its parameters; method = "saltelli"')  # fmt: skip
    if not 0 < one_number(confidence, "confidence", "0.95, say") < 1:
        raise InputError("must lie between 0 and 1", key="confidence", value=confidence, remedy="0.95, say")
    if study.refinement is not None:
        raise InputError("has its points about a boundary, not where they were sampled", key="study", value=study.store,
                         remedy="leave out [boundary], in another store")  # fmt: skip
    values = study.quantity(quantity)
    if values.dtype.kind not in "fiu":
        raise InputError("is not a number", key="quantity", value=quantity, remedy="take another")
    names = tuple(one.path for one in plan.scattering)
    known = (study.status == DONE) & np.isfinite(values)
    if plan.method != "saltelli":
        return _by_classes(study, quantity, values, known, names, confidence)
    if not known.all():
        missing = int((~known).sum())
        raise ComputationError(f"{missing} of {len(known)} points have no {quantity}, and the design needs all of them")
    rows = values.reshape(plan.points, len(names) + 2)
    whole = {"f_A": rows[:, 0][None], "f_B": rows[:, 1][None], "f_AB": np.moveaxis(rows[:, 2:], 1, 0)[:, None, :]}
    variance = float(np.var(rows[:, :2]))
    if not variance > 0:
        raise ComputationError(f"{quantity} is the same at all points")
    found = sobol_indices(func=whole, n=plan.points)
    chance = _seeded(found, seed).bootstrap(confidence_level=confidence, n_resamples=RESAMPLES)
    return SobolIndices(
        parameter=names, first=_flat(found.first_order), total=_flat(found.total_order),
        first_interval=_ends(chance.first_order), total_interval=_ends(chance.total_order), quantity=quantity,
        points=len(values), confidence=confidence, variance=variance,
    )  # fmt: skip


def _seeded(found: Any, seed: int) -> Any:
    """The bootstrap draws from NumPy's global state, which is put back afterwards."""

    def bootstrap(**settings: Any) -> Any:
        before = np.random.get_state()
        np.random.seed(seed)
        try:
            return found.bootstrap(**settings)
        finally:
            np.random.set_state(before)

    return SimpleNamespace(bootstrap=bootstrap)


def _flat(values: Any) -> Array:
    return np.asarray(values, dtype=float).reshape(-1)


def _ends(found: Any) -> Array:
    interval = found.confidence_interval
    return np.stack([_flat(interval.low), _flat(interval.high)], axis=1)


def _by_classes(
    study: Study, quantity: str, values: Array, known: Any, names: tuple[str, ...], confidence: float
) -> SobolIndices:
    values, count = values[known], int(known.sum())
    total = float(values.var()) if count else 0.0
    if count < FEWEST:
        raise ComputationError(f"{count} points have {quantity}, and shares need {FEWEST} or more")
    if not total > 0:
        raise ComputationError(f"{quantity} is the same at all points")
    classes = int(min(MOST_CLASSES, count // A_CLASS))
    shares = []
    for name in names:
        rank = np.argsort(np.argsort(study.parameter(name)[known], kind="stable"), kind="stable")
        member = rank * classes // count
        number = np.bincount(member, minlength=classes)
        mean = np.bincount(member, values, classes) / number
        between = float((number * (mean - values.mean()) ** 2).sum() / count)
        chance = (classes - 1) / (count - classes) * (total - between)
        shares.append(float(np.clip((between - chance) / total, 0.0, 1.0)))
    none = np.full((len(names), 2), np.nan)
    return SobolIndices(
        parameter=names, first=np.array(shares), total=np.full(len(names), np.nan), first_interval=none,
        total_interval=none, quantity=quantity, points=count, confidence=confidence, variance=total,
    )  # fmt: skip


def _with_interval(value: float, ends: Array) -> str:
    if not np.isfinite(ends).all():
        return f"{100 * value:.3g} %"
    return f"{100 * value:.3g} % [{100 * ends[0]:.3g}, {100 * ends[1]:.3g}]"
