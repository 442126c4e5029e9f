"""Linear systems whose matrix has the pattern of a tree, many at once: A x = b by elimination from the leaves.

No pivots are exchanged, so a part of the tree in resonance by itself may cost figures; the caller gets the residual
and solves those few again.
"""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Complex, Integers


def tree_solve(diagonal: Complex, coupling: Complex, parent: Integers, right: Complex) -> tuple[Complex, Complex]:
    """x and the residual b − A x, both (n, case), of symmetric A with A[i, i] = diagonal[i] and
    A[i, parent[i]] = A[parent[i], i] = coupling[i].

    ``parent[i]`` < i, or −1 at a root; diagonal, coupling and right are (n, case).
    """
    n = len(parent)
    pivot, reduced, x = diagonal.copy(), right.astype(complex), np.empty_like(diagonal)
    factor = np.zeros_like(coupling)
    with np.errstate(all="ignore"):
        for i in range(n - 1, -1, -1):
            p = parent[i]
            if p >= 0:
                factor[i] = coupling[i] / pivot[i]
                pivot[p] -= factor[i] * coupling[i]
                reduced[p] -= factor[i] * reduced[i]
        for i in range(n):
            x[i] = reduced[i] / pivot[i]
            if parent[i] >= 0:
                x[i] -= factor[i] * x[parent[i]]
        residual = right - diagonal * x
        for i in range(n):
            p = parent[i]
            if p >= 0:
                residual[i] -= coupling[i] * x[p]
                residual[p] -= coupling[i] * x[i]
    return x, residual
