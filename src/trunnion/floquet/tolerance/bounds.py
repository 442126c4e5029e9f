"""Bounds on how a line's coefficients differ over a box, and how fast they vary over the turn.

In τ (input angle) and absolute rotations the state equation is x′ = A(τ) x with A = [[0, I], [−K, −C]] and, for every
compliance e from near group p to far group i with ratio b_e(τ) of its near end (q = δ_i − b δ_p),

    K = Σ_e g (k_e s² u uᵀ + c_e s u u̇ᵀ),   C = Σ_e g c_e s u uᵀ,   u = (… −b …, 1),   g = diag(1/J),   s = 1/Ω.

So every term is a product of powers of k_e, c_e, 1/J_i and s, whose logarithms vary over a box about those of its
middle, and only b depends on joint angles.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.coefficients import Assembly
from trunnion.equations.kinematics import base_motion
from trunnion.equations.topology import LinkKind

ROUNDED = 1e-13
"""Relative widening of what is computed from a description, far above its rounding."""


@dataclass(frozen=True)
class Coefficients:
    """k, c (boxes, compliances), 1/J (boxes, unknowns), s = 1/Ω (boxes,) at the geometric middle of boxes, and
    half-widths of their logarithms; ``angle`` (boxes, joints) and ``turned`` (boxes, joints), the half-widths of angles
    [rad]."""

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


def half_widths(co: Coefficients) -> Array:
    """Of ln k, ln c, ln 1/J, ln s and angles (boxes, variables)."""
    return np.concatenate([co.dk, co.dc, co.dg, co.ds[:, None], co.turned], axis=1)


def over_boxes(assembly: Assembly, low: Array, high: Array) -> Coefficients:
    """From tables of numbers (boxes, columns) at the low and the high ends; both ends of each number bound the rest.

    Stiffness, damping and inertia rise with every number that may scatter here, so two tables bound each of them.
    """
    ends = [assembly.coefficients(t, statically_twisted=False) for t in (low, high)]
    k, dk = _middle(ends[0].stiffness, ends[1].stiffness)
    c, dc = _middle(ends[0].damping, ends[1].damping)
    inertia = [assembly.topology.on_unknowns(e.inertia) for e in ends]
    g, dg = _middle(1 / inertia[1], 1 / inertia[0])
    s, ds = _middle(1 / ends[1].speed, 1 / ends[0].speed)
    places = [assembly.packed.column(assembly.topology.stations[j].element, "angle") for j in assembly.topology.joints]
    angle = (low[:, places] + high[:, places]) / 2
    turned = np.abs(high[:, places] - low[:, places]) / 2 * (1 + ROUNDED)
    return Coefficients(k=k, c=c, g=g, s=s, dk=dk, dc=dc, dg=dg, ds=ds, angle=angle, turned=turned)


def _middle(low: Array, high: Array) -> tuple[Array, Array]:
    """Geometric middle and half-width of the logarithm of intervals of numbers of one sign, rounded outward; zeros stay
    zeros."""
    there = low * high > 0
    safe = np.where(there, low, 1.0), np.where(there, high, 1.0)
    half = np.abs(np.log(safe[1] / safe[0])) / 2
    middle = np.sign(low) * np.sqrt(safe[0] * safe[1])
    return np.where(there, middle, 0.0), np.where(there, half * (1 + ROUNDED) + ROUNDED, 0.0)


@dataclass(frozen=True)
class Ratios:
    """b and db/dτ and their derivatives by the angle of a line's only joint (boxes, times, compliances) at the middle;
    bounds (boxes, compliances) on |b|, |b′|, |b″| everywhere in the box, on how far each moves with the angles of the
    box, and on what the first order in the angle leaves out of b and b′."""

    b: Array
    slope: Array
    by_angle: Array
    slope_by_angle: Array
    most: Array
    most_slope: Array
    most_bend: Array
    moved: Array
    slope_moved: Array
    bend_moved: Array
    moved_twice: Array
    slope_moved_twice: Array

    def every_other(self) -> Ratios:
        """At every second time."""
        times = {key: getattr(self, key)[:, ::2] for key in ("b", "slope", "by_angle", "slope_by_angle")}
        return replace(self, **times)


def ratios(assembly: Assembly, middle: Array, co: Coefficients, tau: Array) -> Ratios:
    """Ratios of near ends over the turn, for tables at the middles (boxes, columns); at most one joint in a group.

    Bounds, with D = 1 − sin²β cos²χ ≥ cos²β: η ≤ 1/c, |η_χ| ≤ s²/c³, |η_χχ| ≤ 2s²/c³ + 2s⁴/c⁵; by the angle,
    |η_β| ≤ 3s/c², |η_χβ| ≤ (s³ + 2sc²)/c⁴ + 4s³/c⁴, |η_χχβ| ≤ (4s + 8s³)/c⁴ + (8s³ + 12s⁵)/c⁶, and twice by the angle,
    |η_ββ| ≤ 3/c³ + 12s²/c⁵, |η_χββ| ≤ 7/c³ + (20s² + 24s⁴)/c⁵. Angles may differ within a box only where there is one
    joint, so what they do to joints behind is not needed.
    """
    topo = assembly.topology
    coefficients = assembly.coefficients(middle, statically_twisted=False)
    motion = base_motion(topo, coefficients, tau)
    near = [c.near for c in topo.compliances]
    shape = (len(middle), len(topo.stations))
    steep = np.abs(co.angle) + co.turned
    sine, cosine = np.sin(steep), np.cos(steep)
    most, slope, bend = np.ones(shape), np.zeros(shape), np.zeros(shape)
    speed, gain = np.ones(shape), np.zeros(shape)
    moved, slope_moved, bend_moved, moved_twice, slope_moved_twice = (np.zeros(shape) for _ in range(5))
    by_angle, slope_by_angle = (np.zeros((*motion.angle.shape[:2], len(topo.stations))) for _ in range(2))
    joint = 0
    for s, station in enumerate(topo.stations):
        b = station.before
        if station.link is LinkKind.SHAFT:
            speed[:, s], gain[:, s] = speed[:, b], gain[:, b]
        elif station.link is LinkKind.JOINT:
            sj, cj, r = sine[:, joint], cosine[:, joint], co.turned[:, joint]
            chi = motion.angle[:, :, b] + coefficients.shift[:, s, None]
            by_angle[:, :, s], slope_by_angle[:, :, s] = _by_angle(co.angle[:, joint, None], chi)
            joint += 1
            eta, eta1, eta2 = 1 / cj, sj**2 / cj**3, 2 * sj**2 / cj**3 + 2 * sj**4 / cj**5
            most[:, s], slope[:, s] = eta, eta1 * speed[:, b]
            bend[:, s] = eta2 * speed[:, b] ** 2 + eta1 * gain[:, b]
            moved[:, s] = 3 * sj / cj**2 * r
            slope_moved[:, s] = (sj**3 + 2 * sj * cj**2 + 4 * sj**3) / cj**4 * r
            bend_moved[:, s] = ((4 * sj + 8 * sj**3) / cj**4 + (8 * sj**3 + 12 * sj**5) / cj**6) * r
            moved_twice[:, s] = (3 / cj**3 + 12 * sj**2 / cj**5) * r**2 / 2
            slope_moved_twice[:, s] = (7 / cj**3 + (20 * sj**2 + 24 * sj**4) / cj**5) * r**2 / 2
            speed[:, s] = eta * speed[:, b]
            gain[:, s] = eta1 * speed[:, b] ** 2 + eta * gain[:, b]
    reference = [topo.reference[topo.group_of(n)] for n in near]
    turning = motion.relative_slope[:, :, near] * motion.speed[:, :, reference]
    derivatives = (by_angle[:, :, near], slope_by_angle[:, :, near])
    kept = (most, slope, bend, moved, slope_moved, bend_moved, moved_twice, slope_moved_twice)
    return Ratios(motion.relative[:, :, near], turning, *derivatives, *(part[:, near] for part in kept))


def _by_angle(beta: Array, chi: Array) -> tuple[Array, Array]:
    """∂η/∂β and ∂η_χ/∂β of a Hooke's joint."""
    s, c, x = np.sin(beta), np.cos(beta), np.cos(chi) ** 2
    d = 1 - s**2 * x
    eta = (2 * s * c**2 * x - s * d) / d**2
    slope = -np.sin(2 * chi) * ((2 * s * c**2 - s**3) / d**2 + 4 * s**3 * c**2 * x / d**3)
    return eta, slope
