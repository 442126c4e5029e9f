"""The cubic through points that has no maximum or minimum of its own; scipy's, which is loaded when one is drawn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from trunnion.arrays import Array

if TYPE_CHECKING:
    from scipy.interpolate import PchipInterpolator


def monotone_cubic(x: Sequence[float] | Array, y: Sequence[float] | Array) -> PchipInterpolator:
    """Through y (points,) or (points, …) over rising x (points,); NaN beyond both ends."""
    from scipy.interpolate import PchipInterpolator

    return PchipInterpolator(np.asarray(x), np.asarray(y), extrapolate=False)
