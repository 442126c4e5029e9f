"""Torque of the gas on the crank of one cylinder, exactly.

The piston of a slider crank stands at x = r (cos θ + √(1 − λ² sin² θ)/λ), λ = r/l, zero rotation at the top dead
centre; a pressure p above that behind the piston drives its crank with

    T(θ) = p A r (sin θ + λ sin θ cos θ / √(1 − λ² sin² θ))

which is −p A dx/dθ (Den Hartog, Mechanical Vibrations, ch. 5). A curve p(θ) is linear between its points; its harmonics
are Gauss quadratures over pieces so short that each is exact to rounding.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from trunnion.arrays import Array, Complex

POINTS = 8
"""Of the Gauss rule on a piece."""
LONGEST = np.pi / 45
"""Piece [rad], 4°: the phase of order 50 turns 3.5 rad in it, and the rule is exact to degree 15."""


def crank_lever(angle: Array, share: float) -> Array:
    """−dx/dθ over r, λ = ``share``: what a force on the piston is multiplied by."""
    sine = np.sin(angle)
    return np.asarray(sine * (1 + share * np.cos(angle) / np.sqrt(1 - (share * sine) ** 2)))


def piston_depth(angle: Array, share: float) -> Array:
    """Way of the piston from its top dead centre, over r."""
    return np.asarray(1 - np.cos(angle) + (1 - np.sqrt(1 - (share * np.sin(angle)) ** 2)) / share)


def gas_harmonics(angles: Array, pressures: Array, share: float, orders: Array) -> tuple[float, Complex]:
    """Mean T₀ and c_k (orders,) of T/(A r) = T₀ + Re Σ c_k e^{ikθ} for pressures [Pa] above those behind the piston.

    angles : of the curve [rad], rising over one cycle, first and last point a cycle apart.
    orders : per turn, with a whole number of periods in the cycle.
    """
    return harmonics_between(angles, lambda at: np.interp(at, angles, pressures), share, orders)


def harmonics_between(
    knots: Array, pressure: Callable[[Array], Array], share: float, orders: Array
) -> tuple[float, Complex]:
    """The same for a pressure that is smooth between ``knots`` [rad], rising over one cycle."""
    cycle = knots[-1] - knots[0]
    pieces = np.maximum(np.ceil(np.diff(knots) / LONGEST), 1).astype(int)
    begin = np.repeat(knots[:-1], pieces)
    size = np.repeat(np.diff(knots) / pieces, pieces)
    begin = begin + size * (np.arange(len(begin)) - np.repeat(np.cumsum(pieces) - pieces, pieces))
    points, weights = np.polynomial.legendre.leggauss(POINTS)
    at = (begin[:, None] + size[:, None] * (points + 1) / 2).ravel()
    torque = pressure(at) * crank_lever(at, share)
    parts = torque * (size[:, None] * weights / 2).ravel()
    return float(parts.sum() / cycle), np.asarray(2 / cycle * (np.exp(-1j * np.outer(orders, at)) @ parts))
