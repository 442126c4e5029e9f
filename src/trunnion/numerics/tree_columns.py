"""What joins no harmonics of a tree's A = K + sC + s²M, compiled: every case and harmonic is a tree of scalars.

A column is one case and harmonic. Some columns go through the tree together, so that what they need stays near the
processor.
"""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
from __future__ import annotations

import numpy as np

from trunnion.numerics.jit import njit

TOGETHER = 32
"""Columns that go through the tree together."""


@njit(nogil=True, error_model="numpy")
def multiply_columns(parent, own, coupling, slope, s, x, out):
    """``out`` (n, column) = Ax of x (n, column) at s (column,), or A′x where the ``slope`` is asked for; ``own`` and
    ``coupling`` (3, n, 1) or (3, n, case) of K, C and M."""
    n, wide = x.shape
    sets = own.shape[2]
    each = wide // sets
    for one in range(sets):
        for begin in range(one * each, (one + 1) * each, TOGETHER):
            end = min(begin + TOGETHER, (one + 1) * each)
            for i in range(n):
                k, c, m = own[0, i, one], own[1, i, one], own[2, i, one]
                for j in range(begin, end):
                    out[i, j] = _value(k, c, m, slope, s[j]) * x[i, j]
                p = parent[i]
                if p < 0:
                    continue
                k, c, m = coupling[0, i, one], coupling[1, i, one], coupling[2, i, one]
                for j in range(begin, end):
                    value = _value(k, c, m, slope, s[j])
                    out[i, j] += value * x[p, j]
                    out[p, j] += value * x[i, j]


@njit(nogil=True, error_model="numpy")
def condense_columns(steps, left, edges, own, coupling, s, right, shares, pivots, joined):
    """Take out the places of ``steps`` (step, 6): place, two neighbours and where their couplings stand, where the
    neighbours' own goes, −1 for none. ``right`` (n, column) becomes what is left of it; ``shares`` (step, 2, column)
    of neighbours; ``pivots`` (m, column) of the places ``left`` (m,), and the couplings ``joined`` (edge, column) that
    stand at ``edges`` (edge,)."""
    n, wide = right.shape
    sets = own.shape[2]
    each = wide // sets
    pivot = np.empty((n, TOGETHER), np.complex128)
    made = np.empty((max(1, len(steps)), TOGETHER), np.complex128)
    parts = np.empty((2, TOGETHER), np.complex128)
    over = np.empty(TOGETHER, np.complex128)
    for one in range(sets):
        for begin in range(one * each, (one + 1) * each, TOGETHER):
            count = min(TOGETHER, (one + 1) * each - begin)
            for i in range(n):
                k, c, m = own[0, i, one], own[1, i, one], own[2, i, one]
                for l in range(count):
                    pivot[i, l] = _value(k, c, m, False, s[begin + l])
            for at in range(len(steps)):
                i = steps[at, 0]
                for l in range(count):
                    over[l] = _inverse(pivot[i, l])
                for side in range(2):
                    a, e = steps[at, 1 + side], steps[at, 3 + side]
                    if a < 0:
                        continue
                    _coupling(coupling, one, made, e, n, s, begin, count, parts[side])
                    for l in range(count):
                        j = begin + l
                        share = parts[side, l] * over[l]
                        pivot[a, l] -= share * parts[side, l]
                        right[a, j] -= share * right[i, j]
                        shares[at, side, j] = share
                if steps[at, 5] >= 0:
                    new = steps[at, 5] - n
                    for l in range(count):
                        made[new, l] = -(shares[at, 0, begin + l] * parts[1, l])
                for l in range(count):
                    right[i, begin + l] *= over[l]
            for k in range(len(left)):
                for l in range(count):
                    pivots[k, begin + l] = pivot[left[k], l]
            for k in range(len(edges)):
                _coupling(coupling, one, made, edges[k], n, s, begin, count, parts[0])
                for l in range(count):
                    joined[k, begin + l] = parts[0, l]


@njit(nogil=True, error_model="numpy")
def expand_columns(steps, shares, right):
    """Solutions of the places taken out, from those of the places left, in ``right`` (n, column)."""
    wide = right.shape[1]
    for begin in range(0, wide, TOGETHER):
        end = min(begin + TOGETHER, wide)
        for at in range(len(steps) - 1, -1, -1):
            i = steps[at, 0]
            for side in range(2):
                a = steps[at, 1 + side]
                if a < 0:
                    continue
                for j in range(begin, end):
                    right[i, j] -= shares[at, side, j] * right[a, j]


@njit(nogil=True, error_model="numpy", inner=True)
def _coupling(coupling, one, made, edge, n, s, begin, count, part):
    """The coupling that stands at an ``edge``: of the tree, or made by taking a place out."""
    if edge >= n:
        for l in range(count):
            part[l] = made[edge - n, l]
        return
    k, c, m = coupling[0, edge, one], coupling[1, edge, one], coupling[2, edge, one]
    for l in range(count):
        part[l] = _value(k, c, m, False, s[begin + l])


@njit(nogil=True, error_model="numpy", inner=True)
def _value(k, c, m, slope, s):
    """k + sc + s²m, or its slope."""
    if slope:
        return complex(c + 2 * m * s.real, 2 * m * s.imag)
    x, y = c + m * s.real, m * s.imag
    return complex(k + s.real * x - s.imag * y, s.real * y + s.imag * x)


@njit(nogil=True, error_model="numpy", inner=True)
def _inverse(z):
    size = z.real * z.real + z.imag * z.imag
    return complex(z.real / size, -z.imag / size)
