"""Planes x_i = level as one C function of a guard's signature; numbers: m, n, then per plane n weights and level.

This file imports nothing of the package: it is compiled from a copy in the cache folder.
"""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
from __future__ import annotations

from numba import carray, cfunc, types

_POINTER = types.CPointer(types.float64)
_GUARD = types.int64(types.float64, _POINTER, _POINTER, types.int64, types.int64, _POINTER, _POINTER)


@cfunc(_GUARD, cache=True)
def planes(t, x_, p_, regime, sloped, g_, slope_):
    """g_j = w_j·x − level_j."""
    head = carray(p_, (2,))
    m, n = int(head[0]), int(head[1])
    p, x, g = carray(p_, (2 + m * (n + 1),)), carray(x_, (n,)), carray(g_, (m,))
    for j in range(m):
        row = 2 + j * (n + 1)
        g[j] = -p[row + n]
        for i in range(n):
            g[j] += p[row + i] * x[i]
    if sloped:
        slope = carray(slope_, (m * (n + 1),))
        for j in range(m):
            for i in range(n):
                slope[j * (n + 1) + i] = p[2 + j * (n + 1) + i]
            slope[j * (n + 1) + n] = 0.0
    return 0
