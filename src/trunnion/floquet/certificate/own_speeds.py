"""Periodic motions of a driven line over a whole box of speeds, found in floating point: where a proof begins.

Those of all tolerances are solved at each of Chebyshev's points of the speeds, Ω = middle + p₁ half, and so are their
waves: interpolated, they are motions to a polynomial of p₁, however far the line's response goes from a straight one
between. From the middle alone no steps lead to the ends of a box that reaches across the flank of a resonance.
Nothing here proves anything.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from trunnion.arrays import Array
from trunnion.floquet.certificate.own_equations import MotionEquations, MotionWaves, motion_of
from trunnion.floquet.certificate.own_start import begun, solved
from trunnion.floquet.certificate.waves import Terms, Wave
from trunnion.steady.free.free_balance import SteadyStates


def chebyshev_points(degree: int) -> Array:
    """Values from −1 to 1 of the first parameter, as many as it has polynomials up to a ``degree``."""
    return np.asarray(np.cos(np.pi * (np.arange(1 + degree) + 0.5) / (1 + degree)))


def motions_over_speeds(
    own: MotionEquations, motions: SteadyStates
) -> tuple[MotionWaves, list[tuple[MotionEquations, MotionWaves]]] | None:
    """Nearly the motions of a box, and the equations and the motions at each of the ``chebyshev_points`` of its speeds,
    as the ``motions`` known there lead to them; None where one is not found."""
    points, each = chebyshev_points(max(one[0] for one in own.terms.exponents)), []
    for k, at in enumerate(points.tolist()):
        single = equations_at(own, at)
        found = solved(single, begun(single, motions.part(slice(k, k + 1))), None)
        if found is None:
            return None
        each.append((single, found))
    there = np.array([[one.parts for one in motion.states] for _, motion in each])
    parts = np.zeros((own.size, own.rows, 2 * own.last + 1), dtype=complex)
    others = _beside_first(own.terms).row
    for (degree, *rest), row in own.terms.row.items():
        share = np.cos(degree * np.arccos(points)) * ((1 if degree == 0 else 2) / len(points))
        parts[:, row] = np.einsum("k,ksm->sm", share, there[:, :, others[0, *rest]])
    return motion_of(own, list(parts), np.zeros(own.rows)), each


def equations_at(own: MotionEquations, first: float) -> MotionEquations:
    """Those at one value of the first parameter."""
    ladder = tuple(dict.fromkeys(_beside_first(terms) for terms in own.ladder))
    angle, terms = np.arccos(first), ladder[-1]

    def at(wave: Wave) -> Wave:
        parts = np.zeros((len(terms), wave.parts.shape[1]), dtype=complex)
        for (degree, *rest), row in own.terms.row.items():
            if wave.filled[row]:
                parts[terms.row[0, *rest]] += np.cos(degree * angle) * wave.parts[row]
        return Wave(parts, wave.rest, terms)

    return replace(own, co=own.co.each(at), ladder=ladder)


@lru_cache(maxsize=64)
def _beside_first(terms: Terms) -> Terms:
    """Those of all parameters but the first."""
    return _known(tuple(one for one in terms.exponents if not one[0]))


@lru_cache(maxsize=64)
def _known(exponents: tuple[tuple[int, ...], ...]) -> Terms:
    return Terms(exponents)
