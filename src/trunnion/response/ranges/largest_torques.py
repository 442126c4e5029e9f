"""The largest vibratory torque of every spring over a range of speeds."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from trunnion.equations.coefficients import Assembly
from trunnion.floquet.ranges.resonances import resonances, varies
from trunnion.floquet.ranges.span import Span
from trunnion.response.orders.response import response_about, steady_states_of
from trunnion.response.orders.result import OrderResponse
from trunnion.response.ranges.largest import Largest, SearchedQuantity, first_speeds, search, thinned

FEW = 33
"""Speeds of the even grid beside the tops that a rough look shows."""
ROUGHLY = 0.01
"""Share of the largest torque that a rough look may miss."""


@dataclass(frozen=True)
class LargestTorques:
    """What was found, a quantity per spring, and the rough look ``around`` before it, of a line that takes long."""

    largest: Largest
    around: OrderResponse | None


def largest_torques(assembly: Assembly, low: float, high: float) -> LargestTorques:
    """Search input speeds from ``low`` to ``high`` [rad/s]; where coefficients vary, about the tops that a rough look
    shows.

    Raises
    ------
    InputError, ComputationError : as of ``order_response``.
    """
    span = Span(assembly, low, high)
    for gap in span.gaps:  # refused as any response there is
        response_about(assembly, np.array([(gap.low + gap.high) / 2]))
    first = first_speeds(span.pieces, resonances(span))
    torques = [_vibratory_torque(c) for c in range(len(assembly.topology.compliances))]
    if not varies(assembly):
        return LargestTorques(search(assembly, partial(response_about, assembly), first, torques), None)
    rough = partial(response_about, assembly, rough=True)
    around = search(assembly, rough, first, torques, tolerance=ROUGHLY, passed=np.inf).response
    closely = partial(response_about, assembly, motions=steady_states_of(assembly))
    first = thinned(around, span.pieces, torques, FEW)
    return LargestTorques(search(assembly, closely, first, torques), around)


def _vibratory_torque(spring: int) -> SearchedQuantity:
    return SearchedQuantity(lambda found: found.vibratory_torque[:, spring], lambda found: found.torque[:, :, spring])
