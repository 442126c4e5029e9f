"""What arrays and numbers of a chart must be, whoever wrote its file: shapes, ranges, and that they fit together."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from trunnion.arrays import Array
from trunnion.results.verdict import Verdict

LARGEST_RADIUS = 1e100
"""Beyond it the squares of monodromy matrices would be no numbers."""
LONGEST_TEXT = 2000
SAME = 1e-6
"""Share by which the modulus of the critical multiplier may differ from the spectral radius."""


def what_is_wrong(chart: Any) -> str:
    """The first thing of a ``StabilityChart`` that no computation gives, as half a sentence; "" where all is well."""
    return next(_faults(chart), "")


def _faults(chart: Any) -> Iterator[str]:
    for name, axis in (("x", chart.x), ("y", chart.y)):
        if axis.ndim != 1 or not len(axis) or not _numbers(axis) or not (np.diff(axis) > 0).all():
            yield f"{name} does not rise"
            return
    shape = (len(chart.y), len(chart.x))
    arrays = {
        "spectral_radius": chart.spectral_radius,
        "error_estimate": chart.error_estimate,
        "critical_multiplier": chart.critical_multiplier,
        "verdict": chart.verdict,
    }
    for name, array in arrays.items():
        if array.shape != shape or array.dtype.kind not in "fci":
            yield f"{name} is not {shape[0]} × {shape[1]} numbers"
            return
    yield from _faults_of_pixels(chart)
    yield from _faults_of_patches(chart)
    settings = {"period": chart.period, "tolerance": chart.tolerance, "speed": chart.speed or 1.0}
    for key, value in settings.items():
        if not (np.isfinite(value) and value > 0):
            yield f"its {key} is not positive"
    texts = (chart.x_unit, chart.y_unit, chart.x_label, chart.y_label, *chart.remarks)
    if not all(isinstance(text, str) and len(text) <= LONGEST_TEXT for text in texts):
        yield "its texts are none"
    check = chart.spot_check
    if check is not None and not (check.points >= 0 and check.worst_ratio >= 0 and check.worst_difference >= 0):
        yield "its check of itself is negative"


def _faults_of_pixels(chart: Any) -> Iterator[str]:
    radius, error, verdict = chart.spectral_radius, chart.error_estimate, chart.verdict
    known = ~np.isnan(radius)
    if not np.isin(verdict, [int(one) for one in Verdict]).all():
        yield "verdict is none of the known ones"
    if not ((radius[known] >= 0) & (radius[known] <= LARGEST_RADIUS)).all():
        yield f"spectral_radius lies outside 0 to {LARGEST_RADIUS:g}"
    if (error[~np.isnan(error)] < 0).any() or np.isnan(error[known]).any():
        yield "error_estimate is negative or missing"
    if (known == (verdict == Verdict.FAILED)).any():
        yield "failed points have a spectral radius, or others have none"
    modulus, sure = np.abs(chart.critical_multiplier[known]), radius[known]
    if not (np.abs(modulus - sure) <= SAME * np.maximum(sure, 1.0) + error[known]).all():
        yield "critical_multiplier and spectral_radius differ"
    over = radius - error > 1
    under = radius + error < 1
    if ((verdict == Verdict.STABLE) & over).any() or ((verdict == Verdict.UNSTABLE) & under).any():
        yield "verdict contradicts spectral_radius"


def _faults_of_patches(chart: Any) -> Iterator[str]:
    function = chart.function
    for box in (*(patch.box for patch in function.patches), *function.direct):
        if not (_numbers(np.array([box.u0, box.u1, box.v0, box.v1])) and box.u0 <= box.u1 and box.v0 <= box.v1):
            yield "a patch has no extent"
    for patch in function.patches:
        if patch.coefficients.ndim != 3 or patch.error.ndim != 3 or len(patch.error) != len(patch.coefficients):
            yield "a patch is misshapen"
        elif not _numbers(patch.coefficients) or not (patch.error >= 0).all():
            yield "a patch is not made of numbers with errors"


def _numbers(values: Array) -> bool:
    return values.dtype.kind in "fi" and bool(np.isfinite(values).all())
