"""How torques by all orders, and the growth rate of bent lines that start free, follow parameters.

The torque of a spring is the largest over the cycle, at a speed that is kept. A bent line that starts free is judged
about its own periodic motion, which follows every parameter too: lines beside it are computed and compared.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from trunnion.analyses.linear.along import stability_along
from trunnion.analyses.orders.amplitudes import OrderSpectrum
from trunnion.analyses.orders.response import order_response
from trunnion.analyses.orders.totals import extremes_at
from trunnion.analyses.sensitivity.differences import slope
from trunnion.analyses.sensitivity.directions import Direction, Neighbourhood, Neighbours
from trunnion.analyses.sensitivity.responses import spectrum_slope
from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.errors import ComputationError, InputError

Values = Callable[[Driveline], Array]


def exact_torque_slopes(
    near: Neighbourhood,
    lines: Neighbours,
    speeds: Array,
    directions: Sequence[Direction],
    progress: Callable[[float], None] | None = None,
) -> tuple[Array, Array, Array]:
    """Peak and vibratory torque (2, speed, spring) [N m], their derivatives (…, direction) and errors, through the
    equations of the response; NaN where no line lies beside."""
    springs = len(near.assembly.topology.compliances)
    here = np.full((2, len(speeds), springs), np.nan)
    found, errors = np.full((*here.shape, len(directions)), np.nan), np.full((*here.shape, len(directions)), np.nan)
    for v, speed in enumerate(speeds.tolist()):
        here[:, v] = torques(np.array([speed]), near.assembly)[:, 0]
        every = [spectrum_slope(near, speed, one) for one in directions]
        pace = max((around.pace for around in every if around is not None), default=0.0)
        for d, (one, around) in enumerate(zip(directions, every, strict=True)):
            beside = around is None or all(lines.line(one, side * around.step) is None for side in (1, -1))
            if around is None or beside:
                both = slope(partial(_beside, partial(torques, np.array([speed])), lines, here[:, [v]], one))
                both = both and (both[0][:, 0], both[1][:, 0])
            else:
                both = around.slope(lambda share, around=around: _extremes(around.moved(share)), pace)  # type: ignore[misc]
            if both is not None:
                found[:, v, :, d], errors[:, v, :, d] = both[0] / one.size, both[1] / one.size
            if progress:
                progress((v + (d + 1) / len(directions)) / len(speeds))
    return here, found, errors


def _extremes(spectrum: OrderSpectrum) -> Array:
    """Peak and vibratory torque (2, spring) [N m] at the one speed of a spectrum."""
    found = extremes_at(spectrum, spectrum.channels.torque)
    return np.stack([found.largest[0], found.swing[0]])


def torques(speeds: Array, line: Driveline | Assembly) -> Array:
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
