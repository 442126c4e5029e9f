"""Which side orders a response takes: those that the joints' and meshes' spread leaves above a share.

What varies at a rate of h cycles makes of one harmonic others h away, each smaller than the one before by the spread
of the joint: tan²(β/2) of a Hooke's joint at β. Of several rates together the shares multiply.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from heapq import heappop, heappush

import numpy as np

from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.topology import Topology

LEAST_SPREAD, LARGEST_SPREAD = 1e-12, 0.95
DECADES = 16.0
"""Side orders are taken until their shares fall below 10^−16, to begin with: resonances raise them by decades, and to
solve once with some more is cheaper than to solve twice."""
MOST_DECADES = 40.0
MOST = 2000
"""Side orders of one excitation, at most."""
OUTERMOST = 1
"""The layer of those that the share leaves out first; the others have layer 0."""


def spreads(topo: Topology, coefficients: LineCoefficients, turns: Fraction) -> dict[int, float]:
    """Decades by which each rate, in cycles per period of ``turns``, lets harmonics fall."""
    share: dict[int, float] = {}
    for station, law in zip(topo.joints, coefficients.joints, strict=True):
        for rate in topo.joint_rates(station):
            share[int(rate * turns)] = max(share.get(int(rate * turns), 0.0), law.spread)
    for one in (one for wave in coefficients.waves for one in wave.harmonics):
        cycles = abs(int(one.order * turns))
        share[cycles] = max(share.get(cycles, 0.0), float(np.max(np.abs(one.amplitude))) / 2)
    bounded = {rate: min(max(one, LEAST_SPREAD), LARGEST_SPREAD) for rate, one in share.items() if rate}
    return {rate: -float(np.log10(one)) for rate, one in bounded.items()}


def side_orders(fall: Mapping[int, float], decades: float) -> dict[int, int]:
    """Harmonics about an excitation that lie within so many ``decades``, layer 0, and the next ones of each rate beside
    them, ``OUTERMOST``."""
    found: dict[int, int] = {}
    waiting = [(0.0, 0)]
    while waiting and len(found) < MOST:
        lost, offset = heappop(waiting)
        if offset in found:
            continue
        found[offset] = 0 if lost <= decades else OUTERMOST
        if lost <= decades:
            for rate, decade in fall.items():
                for step in (rate, -rate):
                    if offset + step not in found:
                        heappush(waiting, (lost + decade, offset + step))
    if OUTERMOST not in found.values():  # so many that the last one stands for the rest
        found[offset] = OUTERMOST
    return found
