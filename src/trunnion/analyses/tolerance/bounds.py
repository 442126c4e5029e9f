"""Bounds on how a line's coefficients differ over a box, and how fast they vary over the turn.

In τ (input angle) and absolute rotations the state equation is x′ = A(τ) x with A = [[0, I], [−K, −C]] and, for every
compliance e from near group p to far group i with ratio b_e(τ) of its near end (q = δ_i − b δ_p),

    K = Σ_e g (k_e s² u uᵀ + c_e s u u̇ᵀ),   C = Σ_e g c_e s u uᵀ,   u = (… −b …, 1),   g = diag(1/J),   s = 1/Ω.

So A is linear in every k_e, c_e and 1/J_i, quadratic in s, and only b depends on joint angles. Relative changes κ of
k and c, y of 1/J and z of s make, entry by entry, first-order terms and a remainder of at most
(1 + |κ|)(1 + |y|)(1 + |z|)² − 1 − |κ| − |y| − 2|z| of the term.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from trunnion.equations.aligned import relative_ratio
from trunnion.equations.coefficients import Assembly, LineCoefficients
from trunnion.equations.kinematics import base_motion, ratio_values
from trunnion.equations.topology import Link

Array = NDArray[np.float64]
ROUNDED = 1e-13
"""Relative widening of what is computed from a description, far above its rounding."""


@dataclass(frozen=True)
class Coefficients:
    """k, c (boxes, compliances), 1/J (boxes, unknowns), s = 1/Ω (boxes,) at the middle of boxes, and relative
    half-widths of each; ``angle`` (boxes, joints) and ``turned`` (boxes, joints), the half-widths of angles [rad]."""

    k: Array
    c: Array
    g: Array
    s: Array
    dk: Array
    dc: Array
    dg: Array
    ds: Array
    angle: Array
    turned: Array


def over_boxes(assembly: Assembly, low: Array, high: Array) -> Coefficients:
    """From tables of numbers (boxes, columns) at the low and the high ends; both ends of each number bound the rest.

    Stiffness, damping and inertia rise with every number that may scatter here, so two tables bound each of them.
    """
    ends = [assembly.coefficients(t, statically_twisted=False) for t in (low, high)]
    k, dk = _middle(ends[0].stiffness, ends[1].stiffness)
    c, dc = _middle(ends[0].damping, ends[1].damping)
    inertia = [_inertia(assembly, e) for e in ends]
    g, dg = _middle(1 / inertia[1], 1 / inertia[0])
    s, ds = _middle(1 / ends[1].speed, 1 / ends[0].speed)
    places = [assembly.packed.column(assembly.topology.stations[j].element, "angle") for j in assembly.topology.joints]
    angle = (low[:, places] + high[:, places]) / 2
    turned = np.abs(high[:, places] - low[:, places]) / 2 * (1 + ROUNDED)
    return Coefficients(k, c, g, s, dk, dc, dg, ds, angle, turned)


def _middle(low: Array, high: Array) -> tuple[Array, Array]:
    """Middle and relative half-width of intervals of positive numbers, rounded outward; zeros stay zeros."""
    middle = (low + high) / 2
    half = np.abs(high - low) / 2 / np.where(middle > 0, middle, 1.0)
    return middle, np.where(middle > 0, half * (1 + ROUNDED) + ROUNDED, 0.0)


def _inertia(assembly: Assembly, co: LineCoefficients) -> Array:
    topo = assembly.topology
    inertia = np.zeros((len(co.speed), topo.size))
    for station in range(len(topo.stations)):
        i = topo.coordinate[topo.group_of(station)]
        if i >= 0:
            inertia[:, i] += co.inertia[:, station] * relative_ratio(topo, station) ** 2
    return inertia


@dataclass(frozen=True)
class Ratios:
    """b and db/dτ (boxes, times, compliances) at the middle, bounds (boxes, compliances) on |b|, |b′|, |b″|
    everywhere in the box, and on how far b and b′ move with the angles of the box."""

    b: Array
    slope: Array
    most: Array
    most_slope: Array
    most_bend: Array
    moved: Array
    slope_moved: Array


def ratios(assembly: Assembly, middle: Array, co: Coefficients, tau: Array) -> Ratios:
    """Ratios of near ends over the turn, for tables at the middles (boxes, columns); at most one joint in a group.

    Bounds, with D = 1 − sin²β cos²χ ≥ cos²β: η ≤ 1/c, |η_χ| ≤ s²/c³, |η_χχ| ≤ 2s²/c³ + 2s⁴/c⁵; by the angle,
    |∂η/∂β| ≤ 3s/c² and |∂η_χ/∂β| ≤ (s³ + 2sc²)/c⁴ + 4s³/c⁴. Angles may differ within a box only where there is one
    joint, so what they do to joints behind is not needed.
    """
    topo = assembly.topology
    coefficients = assembly.coefficients(middle, statically_twisted=False)
    motion = base_motion(topo, coefficients, tau, ratio_values(topo))
    near = [c.near for c in topo.compliances]
    shape = (len(middle), len(topo.stations))
    steep = np.abs(co.angle) + co.turned
    sine, cosine = np.sin(steep), np.cos(steep)
    most, slope, bend = np.ones(shape), np.zeros(shape), np.zeros(shape)
    speed, gain, moved, slope_moved = np.ones(shape), np.zeros(shape), np.zeros(shape), np.zeros(shape)
    joint = 0
    for s, station in enumerate(topo.stations):
        b = station.before
        if station.link is Link.SHAFT:
            speed[:, s], gain[:, s] = speed[:, b], gain[:, b]
        elif station.link is Link.JOINT:
            sj, cj, r = sine[:, joint], cosine[:, joint], co.turned[:, joint]
            joint += 1
            eta, eta1, eta2 = 1 / cj, sj**2 / cj**3, 2 * sj**2 / cj**3 + 2 * sj**4 / cj**5
            most[:, s], slope[:, s] = eta, eta1 * speed[:, b]
            bend[:, s] = eta2 * speed[:, b] ** 2 + eta1 * gain[:, b]
            moved[:, s] = 3 * sj / cj**2 * r
            slope_moved[:, s] = (sj**3 + 2 * sj * cj**2 + 4 * sj**3) / cj**4 * r
            speed[:, s] = eta * speed[:, b]
            gain[:, s] = eta1 * speed[:, b] ** 2 + eta * gain[:, b]
    reference = [topo.reference[topo.group_of(n)] for n in near]
    turning = motion.relative_slope[:, :, near] * motion.speed[:, :, reference]
    bounds = (part[:, near] for part in (most, slope, bend, moved, slope_moved))
    return Ratios(motion.relative[:, :, near], turning, *bounds)
