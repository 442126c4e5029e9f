"""What a steady response leaves unbalanced in time: a check that shares neither harmonics nor elimination with it.

All orders are added up to rotations, speeds and accelerations at some instants; with the equations written out at those
instants, and every excitation as it acts there, what is left over tells how far the response is from a motion.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from trunnion.arrays import Array, Complex, Places
from trunnion.equations.aligned import rigid_rotation
from trunnion.equations.coefficients import Assembly
from trunnion.equations.harmonics import base_of_excitation, line_harmonics
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.topology import Topology
from trunnion.equations.tree_matrices import TreeEntries, TreeMatrices, tree_matrices
from trunnion.steady.orders.amplitudes import OrderSpectrum

INSTANTS = 24
LEFT, BEYOND_CUT = 1e-9, 100.0
"""What a response may leave: at least, and over the share of the side orders that are left out."""
GOLDEN = (np.sqrt(5) - 1) / 2
"""Instants lie apart by this share of a turn, which no order repeats after."""


def balanced(assembly: Assembly, spectrum: OrderSpectrum, numbers: Array, twisted: bool, *, first: bool) -> bool:
    """Whether a ``spectrum`` of rows of packed ``numbers`` (speed, column) leaves no more than what was left out of it:
    tried at both ends and where it is largest, of those responses that exist, or at the ``first`` row alone."""
    torque = np.abs(spectrum.amplitude[..., spectrum.channels.torque]).max(axis=(1, 2), initial=0.0)
    there = np.flatnonzero(np.isfinite(torque))
    if not len(there):
        return True
    at = np.unique([there[0], there[-1], there[torque[there].argmax()]])[: 1 if first else None]
    left = unbalanced(assembly, spectrum, numbers, at, twisted=twisted)
    return bool(np.all(left <= np.maximum(LEFT, BEYOND_CUT * spectrum.cut_off[at])))


def unbalanced(
    assembly: Assembly, spectrum: OrderSpectrum, numbers: Array, at: Places, *, twisted: bool = True
) -> Array:
    """Largest torque left over at any rotation, over what acts there, (at,), at the rows ``at`` of a ``spectrum`` of
    packed ``numbers`` (speed, column). NaN where there is no response."""
    topo, speed, table = assembly.topology, spectrum.speed[at], numbers[at]
    tau = 2 * np.pi * GOLDEN * np.arange(INSTANTS)
    co = assembly.coefficients(table, statically_twisted=twisted, any_frequency=True)
    matrices = tree_matrices(topo, co, tau)
    nu = spectrum.angular_frequency[at]
    turning = np.exp(1j * nu[:, None] * (tau / speed[:, None])[..., None])  # (case, time, order)
    y = spectrum.amplitude[at][..., spectrum.channels.deviation]
    still = spectrum.mean[at][:, None, spectrum.channels.deviation]
    moving = [(turning @ ((1j * nu[..., None]) ** p * y)).real for p in range(3)]
    moving[0] = moving[0] + still
    parts = [
        product
        for entries, motion in zip((matrices.stiffness, matrices.damping, matrices.mass), moving, strict=True)
        for product in _products(entries, motion)
    ]
    parts += [-matrices.forcing, -_excited(assembly, table, co, matrices, tau, twisted)]
    if co.loss.any():
        parts.append(_lost(topo, co, matrices, turning, nu, spectrum.amplitude[at][..., spectrum.channels.twist]))
    left = np.sum(parts, axis=0)
    if topo.free:  # a mean torque that turns the whole line is taken to be balanced
        turn = rigid_rotation(topo)
        left -= (left @ turn).mean(axis=1)[:, None, None] * turn / (turn @ turn)
    rest, acting = np.abs(left).max(axis=1), np.sum([np.abs(part) for part in parts], axis=0).max(axis=1)
    return np.asarray(np.divide(rest, acting, out=np.zeros_like(rest), where=~(acting == 0)).max(axis=1))


def _products(entries: TreeEntries, x: Array) -> list[Array]:
    """What the diagonal and what the rotations in front and behind give of A x (case, time, n)."""
    own, beside = np.moveaxis(entries.own, 0, -1) * x, np.zeros_like(x)
    tied = np.flatnonzero(entries.parent >= 0)
    front = entries.parent[tied]
    beside[..., tied] += np.moveaxis(entries.down[tied], 0, -1) * x[..., front]
    for i, p in zip(tied.tolist(), front.tolist(), strict=True):
        beside[..., p] += entries.up[i] * x[..., i]
    return [own, beside]


def _excited(
    assembly: Assembly, table: Array, co: LineCoefficients, matrices: TreeMatrices, tau: Array, twisted: bool
) -> Array:
    """Torques of all excitations (case, time, n)."""
    topo, speed = assembly.topology, table[:, 0]
    plain = assembly.coefficients(table, statically_twisted=False, any_frequency=True)
    base = base_of_excitation(topo, co, plain, tau)
    found = np.zeros((len(table), len(tau), topo.size))
    largest = table[np.abs(table).argmax(axis=0), np.arange(table.shape[1])]
    for one in (one for one in line_harmonics(assembly, largest) if one.acts):
        nu = float(one.order) * speed + one.frequency

        def spring(e: int, nu: Array = nu) -> Complex:
            return np.asarray(co.stiffness[:, e, None] * matrices.wave[..., e] + 1j * (nu * co.damping[:, e])[:, None])

        turned = np.exp(1j * np.outer(nu / speed, tau))
        acted, g = one.forcing(topo, one.size(assembly, table), base, spring)
        found[..., acted] += (g * turned[..., None]).real
    return found


def _lost(
    topo: Topology, co: LineCoefficients, matrices: TreeMatrices, turning: Complex, nu: Array, twist: NDArray[Any]
) -> Array:
    """Torques (case, time, n) of damping whatever the frequency, of twists (case, order, spring)."""
    found = np.zeros((*turning.shape[:2], topo.size))
    torque = (turning @ (1j * np.sign(nu)[..., None] * twist)).real * co.loss[:, None]
    for e, (far, near) in enumerate(topo.ends):
        if far >= 0:
            found[..., far] += torque[..., e]
        if near >= 0:
            found[..., near] -= matrices.ratio[..., e] * torque[..., e]
    return found
