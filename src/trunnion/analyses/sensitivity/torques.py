"""How torques by all orders, and the growth rate of bent lines that start free, follow parameters: by differences.

The torque of a spring is the largest over the cycle, at a speed that is kept. A bent line that starts free is judged
about its own periodic motion, which follows every parameter too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.linear.along import stability_along
from trunnion.analyses.orders.response import order_response
from trunnion.analyses.sensitivity.differences import slope
from trunnion.analyses.sensitivity.directions import Direction, Neighbours
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import assemble
from trunnion.errors import ComputationError, InputError

Array = NDArray[np.float64]
Values = Callable[[Driveline], Array]


def torques(speeds: Array, line: Driveline) -> Array:
    """Peak and vibratory torque (2, speed, spring) [N m]."""
    found = order_response(line, speeds)
    return np.stack([found.peak_torque, found.vibratory_torque])


def own_growth(speeds: Array, line: Driveline) -> Array:
    """Growth rate and spectral radius (2, speed) of a bent line that starts free."""
    found = stability_along(assemble(line), speeds)
    return np.stack([found.growth_rate, found.radius])


def slopes(
    values: Values, near: Neighbours, directions: Sequence[Direction], progress: Callable[[float], None] | None = None
) -> tuple[Array, Array]:
    """Derivatives (…, direction) of ``values(line)`` and their errors; NaN where lines beside it are refused."""
    here = values(near.assembly.line)
    found, errors = np.full((*here.shape, len(directions)), np.nan), np.full((*here.shape, len(directions)), np.nan)
    for d, one in enumerate(directions):
        both = slope(partial(_beside, values, near, here, one))
        if both is not None:
            found[..., d], errors[..., d] = both[0] / one.size, both[1] / one.size
        if progress:
            progress((d + 1) / len(directions))
    return found, errors


def _beside(values: Values, near: Neighbours, here: Array, one: Direction, share: float) -> Array | None:
    if not share:
        return here
    line = near.line(one, share)
    try:
        return None if line is None else values(line)
    except (InputError, ComputationError):
        return None
