"""What the two ways of solving Hill's blocks cost, in milliseconds of one core: which of them a response takes.

Measured on one machine (``benchmarks/long_lines.py`` shows both); a choice of the dearer way costs time, never
accuracy.
"""

from __future__ import annotations

from collections.abc import Sequence

from trunnion.equations.topology import Topology

CHECKED = 3.0
"""What checking a response in time takes, which only that along the tree needs."""


def tree_pays(topo: Topology, harmonics: Sequence[int], cases: int) -> bool:
    """Whether elimination along the tree is cheaper than whole matrices, of groups with so many ``harmonics`` each."""
    n, left = topo.size, places_left(topo)
    tree = sum(0.6 + 0.02 * n + cases * (8e-5 * left * h**2 * (1 + h / 100) + 1e-4 * n * h) for h in harmonics)
    whole = sum(1.2 + cases * 3.5e-5 * (n * h) ** 2 * (1 + n * h / 400) for h in harmonics)
    return CHECKED + tree < whole


def places_left(topo: Topology) -> int:
    """Unknowns beside joints and varying meshes, at most: those whose harmonics are solved together."""
    return min(topo.size, 2 * (len(topo.joints) + len(topo.meshes)))
