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
    return CHECKED + along_tree(topo, harmonics, cases) < by_whole_matrices(topo, harmonics, cases)


def along_tree(topo: Topology, harmonics: Sequence[int], cases: int) -> float:
    """Elimination along the tree, without the check in time."""
    n, left = topo.size, places_left(topo)
    return sum(0.6 + 0.02 * n + cases * (8e-5 * left * h**2 * (1 + h / 100) + 3.3e-4 * n * h) for h in harmonics)


def by_whole_matrices(topo: Topology, harmonics: Sequence[int], cases: int) -> float:
    """Matrices of all harmonics of all unknowns."""
    n = topo.size
    return sum(1.2 + cases * 3.5e-5 * (n * h) ** 2 * (1 + n * h / 400) for h in harmonics)


def looking_through(amplitudes: int) -> float:
    """What a search makes of so many amplitudes by speed, order and channel: sums over the cycle, tops, poles."""
    return 4.2e-4 * amplitudes


def places_left(topo: Topology) -> int:
    """Unknowns beside joints and varying meshes, at most: those whose harmonics are solved together."""
    return min(topo.size, 2 * (len(topo.joints) + len(topo.meshes)))
