"""Harmonics sorted by the carrier they share in a line that repeats with b cycles per turn of the input.

An order K = κ + mb, 0 ≤ κ < b, gives orders κ + hb only, so that orders of one κ share their matrix. Far-away orders of
one κ are solved apart, each with the harmonics about itself.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import numpy as np

from trunnion.arrays import Array, Flags, Integers
from trunnion.equations.harmonics import LineHarmonic
from trunnion.laws.harmonic import turning


@dataclass(frozen=True)
class CarrierGroup:
    """Excitations about one carrier.

    carrier κ [cycles per turn of the input] and the ``frequency`` ν [rad/s] that all have; ``members`` as (harmonic,
    its m); ``own``: the forcing of the line's own joints, with carrier 0.
    """

    carrier: Fraction
    frequency: float
    members: tuple[tuple[LineHarmonic, int], ...]
    own: bool = False

    def carrier_at(self, speed: Array) -> Array:
        """Its frequency κΩ + ν [rad/s] at input speeds."""
        return turning(float(self.carrier), self.frequency, speed)

    def harmonics(self, layers: dict[int, int], reach: int) -> tuple[Integers, Flags]:
        """Harmonics h (h,) about the members and which of them are the outermost (h,); ``layers`` as of ``offsets``."""
        centres = {m for _, m in self.members} or {0}
        depth: dict[int, int] = {}
        for centre in centres:
            for offset, layer in layers.items():
                depth[centre + offset] = min(layer, depth.get(centre + offset, layer))
        h = np.array(sorted(depth), dtype=np.int64)
        return h, np.array([depth[int(j)] == reach for j in h])


@dataclass(frozen=True)
class SideOrders:
    """Harmonics about each member of a group: ``layers`` of each offset, the ``outermost`` of which tells what leaving
    out the rest costs."""

    layers: dict[int, int]
    outermost: int

    @property
    def width(self) -> int:
        """The largest offset."""
        return max(self.layers)

    def of(self, group: CarrierGroup) -> tuple[Integers, Flags]:
        """Harmonics h (h,) about the members and which of them are the outermost (h,)."""
        return group.harmonics(self.layers, self.outermost)


def offsets(rates: set[int], reach: int) -> dict[int, int]:
    """Sums Σ m_j rate_j with Σ |m_j| ≤ reach, each with the least Σ |m_j| it takes."""
    found = {0: 0}
    for layer in range(1, reach + 1):
        last = [offset for offset, depth in found.items() if depth == layer - 1]
        for offset in last:
            for rate in rates:
                found.setdefault(offset + rate, layer)
                found.setdefault(offset - rate, layer)
    return found


OWN = CarrierGroup(Fraction(0), 0.0, (), own=True)


def groups_of(harmonics: Iterable[LineHarmonic], base: Fraction | None, width: int) -> list[CarrierGroup]:
    """Groups of the harmonics, whose orders share a carrier where they differ by whole ``base`` (None: where they are
    equal); those with more than 2·``width`` harmonics between them are apart."""
    together: dict[tuple[Fraction, float], list[tuple[LineHarmonic, int]]] = {}
    for one in harmonics:
        m, carrier = divmod(one.order, base) if base else (0, one.order)
        together.setdefault((carrier, one.frequency), []).append((one, int(m)))
    found = []
    for (carrier, frequency), members in together.items():
        members.sort(key=lambda member: member[1])
        apart = [i for i, (one, next_to) in enumerate(pairwise(members), 1) if next_to[1] - one[1] > 2 * width]
        for begin, end in pairwise([0, *apart, len(members)]):
            found.append(CarrierGroup(carrier, frequency, tuple(members[begin:end])))
    return found
