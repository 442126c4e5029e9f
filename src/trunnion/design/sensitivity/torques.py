"""How torques by all orders, and the growth rate of lines about their own motion, follow parameters.

The torque of a spring is the largest over the cycle, at a speed that is kept. The periodic motion of a line follows
every parameter too: lines beside it are computed and compared.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from trunnion.arrays import Array
from trunnion.design.sensitivity.differences import STEP, Values, slope
from trunnion.design.sensitivity.directions import Direction, Neighbourhood, Neighbours, along_each
from trunnion.design.sensitivity.responses import SpectrumSlope, spectrum_slopes
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.errors import ComputationError, InputError
from trunnion.floquet.stability.stability import stability
from trunnion.floquet.stability.stability_over_speed import stability_along
from trunnion.response.orders.response import order_response
from trunnion.steady.free.periodic_steady_states import KnownSteadyState, SteadyStatesBySpeed
from trunnion.steady.orders.amplitudes import OrderSpectrum

LineValues = Callable[[Driveline], Array]


def exact_torque_slopes(
    near: Neighbourhood,
    lines: Neighbours,
    speeds: Array,
    directions: Sequence[Direction],
    progress: Callable[[float], None] | None = None,
) -> tuple[Array, Array, Array]:
    """Peak and vibratory torque (2, speed, spring) [N m], their derivatives (…, direction) and errors, through the
    equations of the response; NaN where no line lies beside."""
    here = np.full((2, len(speeds), len(near.assembly.topology.compliances)), np.nan)
    found, errors = np.full((2, *here.shape, len(directions)), np.nan)
    for v, speed in enumerate(speeds.tolist()):
        values = partial(torques, speeds[[v]])
        here[:, v] = values(near.assembly)[:, 0]
        labels = [one.label for one in directions]
        every = dict(zip(labels, spectrum_slopes(near, speed, directions), strict=True))
        pace = max((around.pace for around in every.values() if around is not None), default=0.0)

        def look(one: Direction, v=v, values=values, every=every, pace=pace) -> tuple[Array, Array] | None:  # type: ignore[no-untyped-def]
            around = every[one.label]
            if around is None or all(lines.line(one, side * STEP) is None for side in (1, -1)):
                both = slope(partial(_beside, values, lines, here[:, [v]], one))
                return both and (both[0][:, 0], both[1][:, 0])
            return around.slope(_torques_beside(around), pace)

        report_progress = progress and (lambda share, v=v: progress((v + share) / len(speeds)))  # type: ignore[misc]
        found[:, v], errors[:, v] = along_each(directions, look, (2, here.shape[2]), report_progress)
    return here, found, errors


def _torques_beside(around: SpectrumSlope) -> Values:
    """Peak and vibratory torque (2, spring) [N m] by the share of a step, those that a slope needs found together."""
    shares = around.shares
    known = dict(zip(shares.tolist(), _extremes(around.moved(shares)), strict=True))
    return lambda share: known[share] if share in known else _extremes(around.moved([share]))[0]


def _extremes(spectrum: OrderSpectrum) -> Array:
    """Peak and vibratory torque (row, 2, spring) [N m] of every row of a spectrum."""
    found = spectrum.extremes_at(spectrum.channels.torque)
    return np.stack([found.largest, found.swing], axis=1)


def torques(speeds: Array, line: Driveline | Assembly) -> Array:
    """Peak and vibratory torque (2, speed, spring) [N m]."""
    found = order_response(line, speeds)
    return np.stack([found.peak_torque, found.vibratory_torque])


def own_motion_growth(like: SteadyStatesBySpeed, speeds: Array, line: Driveline) -> Array:
    """Growth rate and spectral radius (2, speed) of a line about its own periodic motion; of several that it has the
    one that goes on from the motion of the line ``like`` it."""
    solved = SteadyStatesBySpeed(line)
    if solved.obstacle:
        each = [stability(line, speed, about_steady_state=True) for speed in speeds.tolist()]
        return np.array([[one.growth_rate for one in each], [one.spectral_radius for one in each]])
    for speed, known in like.known.items():
        if known.settled:
            beside = solved.balance.solve(np.array([speed]), known.h, known.rows[None])
            if beside.found[0] and beside.resolved[0]:
                solved.known[speed] = KnownSteadyState.of(beside, 0)
    found = stability_along(assemble(line), speeds, about_steady_state=True, motions=solved, closely=True)
    if line is like.line:
        like.known.update(solved.known)
    return np.stack([found.growth_rate, found.radius])


def slopes(
    values: LineValues,
    near: Neighbours,
    directions: Sequence[Direction],
    progress: Callable[[float], None] | None = None,
) -> tuple[Array, Array]:
    """Derivatives (…, direction) of ``values(line)`` and their errors; NaN where lines beside it are refused."""
    here = values(near.assembly.line)
    return along_each(directions, lambda one: slope(partial(_beside, values, near, here, one)), here.shape, progress)


def _beside(values: LineValues, near: Neighbours, here: Array, one: Direction, share: float) -> Array | None:
    if not share:
        return here
    line = near.line(one, share)
    try:
        return None if line is None else values(line)
    except (InputError, ComputationError):
        return None
