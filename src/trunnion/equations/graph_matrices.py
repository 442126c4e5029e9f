"""The linearised equations of a line whose shafts are tied to several others or close loops, joints angled or straight.

Station s turns by a_s(τ) + R_s δ + ½ δᵀH_sδ with the unknowns δ: R and H pass through a joint, in front of which
stands b, by its law, η = dψ/dχ and its slopes, as

    R_s = η R_b,   R_s′ = η_χ w_b R_b + η R_b′,   H_s = η H_b + η_χ R_bᵀR_b,

are divided by a ratio, and add up where shafts are tied. With the elongations E_e = R_far − R_near of the compliances
Lagrange's equations are, to first order in δ, those of ``linear`` with

    M = Σ J RᵀR,   C = Σ RᵀR (load slope) + 2 Σ J RᵀṘ + Σ c EᵀE,
    K = Σ RᵀR̈ J + Σ RᵀṘ (load slope) + Σ k EᵀE + Σ c EᵀĖ + Σ F_s H_s,

F_s all torques of the base motion on s. Round a loop with angled joints the base motion, that of a tree of rigid
shafts, does not close: what a closing spring is twisted by, k q̃ + c q̃′, is among its torques. Its mean is that of the
loads.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Places
from trunnion.equations.graph_entries import Products, WholeProducts
from trunnion.equations.kinematics import BaseMotion, base_motion
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.topology import LinkKind, Topology
from trunnion.errors import InputError
from trunnion.laws.joint import JointLaw

SAMPLES = 64
"""Samples of every cycle of a coefficient, for the means of what repeats with it."""
TOUCHED = 1e-9
"""Share of a rotation that counts as none."""


@dataclass(frozen=True)
class GraphKinematics:
    """Rotations of the stations per rotation of the unknowns, R, R′ and R″ by the input angle (case, time, station, n),
    with the base ``motion`` and the slope η_χ of every joint by its station (case, time)."""

    motion: BaseMotion
    value: Array
    slope: Array
    curvature: Array
    bend: dict[int, Array]
    eta: dict[int, Array]

    def elongations(self, topo: Topology, part: Array) -> Array:
        """Twists of the compliances (case, time, compliance, n) of one of these."""
        far, near = ends_of(topo)
        return np.asarray(part[:, :, far] - part[:, :, near])


def ends_of(topo: Topology) -> tuple[list[int], list[int]]:
    """Far and near station of every compliance."""
    far = [topo.reference[c.far_group] if c.far is None else c.far for c in topo.compliances]
    return far, [c.near for c in topo.compliances]


def turning_of(
    topo: Topology, coefficients: LineCoefficients, tau: Array, columns: Places | None = None
) -> GraphKinematics:
    """At input angles ``tau`` (time,) [rad]; ``columns`` (n,) of the unknowns where they have not one each."""
    motion = base_motion(topo, coefficients, tau)
    columns = np.arange(topo.size) if columns is None else columns
    shape = (*motion.angle.shape, int(columns.max()) + 1)
    r, r1, r2 = (np.zeros(shape) for _ in range(3))
    laws, bend, eta = dict(zip(topo.joints, coefficients.joints, strict=True)), {}, {}
    for s, station in enumerate(topo.stations):
        b, place = station.before, topo.coordinate[station.group]
        if station.link is LinkKind.SUM:
            for part in (r, r1, r2):
                part[:, :, s] = sum(float(share) * part[:, :, one] for one, share in station.of)
        elif station.link is LinkKind.JOINT:
            chi = motion.angle[..., b] + coefficients.shift[:, s, None]
            _, first, second, third = laws[s].at(chi)[:4]
            eta[s], bend[s] = np.broadcast_to(first, chi.shape), np.broadcast_to(second, chi.shape)
            w, w1 = motion.speed[..., b], motion.acceleration[..., b]
            by_turn, by_turn_twice = (second * w)[..., None], (third * w**2 + second * w1)[..., None]
            r[:, :, s] = eta[s][..., None] * r[:, :, b]
            r1[:, :, s] = by_turn * r[:, :, b] + eta[s][..., None] * r1[:, :, b]
            r2[:, :, s] = by_turn_twice * r[:, :, b] + 2 * by_turn * r1[:, :, b] + eta[s][..., None] * r2[:, :, b]
        elif station.link is LinkKind.RATIO:
            for part in (r, r1, r2):
                part[:, :, s] = part[:, :, b] / topo.ratio_values[s]
        elif place >= 0:
            r[:, :, s, columns[place]] = 1.0
    return GraphKinematics(motion, r, r1, r2, bend, eta)


def require_fixed_speeds(topo: Topology, laws: Iterable[JointLaw], names: tuple[str, ...]) -> None:
    """Refuse angled joints whose shafts may stand in any phase to each other, as legs of a differential whose wheels
    roll freely: no base motion is the one.

    Raises
    ------
    InputError : so.
    """
    others = topo.loose[:, int(topo.free) :]
    for s, law in zip(topo.joints, laws, strict=True):
        moved = np.abs(topo.turning[topo.stations[s].before] @ others)
        if law.nonuniform and moved.max(initial=0.0) > TOUCHED * np.abs(others).max(initial=0.0):
            raise InputError(
                "is angled behind legs or shafts that may turn against each other, so that its phase is not fixed",
                element=names[topo.stations[s].element],
                remedy="put it in front of the differential, take it straight, or close both legs onto one Vehicle by "
                "tyres that do not slip",
            )  # fmt: skip


@dataclass(frozen=True)
class GraphMatrices:
    """M, C, K (case, time, n, n), or their entries (case, time, entry), and the forcing (case, time, column) in
    physical time, the ``turning`` behind them, and how the base motion twists compliances that close loops, about its
    mean (case, time, compliance)."""

    mass: Array
    damping: Array
    stiffness: Array
    forcing: Array
    turning: GraphKinematics
    base_twist: Array


def graph_matrices(
    topo: Topology, coefficients: LineCoefficients, tau: Array, wave: Array, products: Products | None = None
) -> GraphMatrices:
    """The equations at input angles ``tau`` (time,) [rad]; ``wave`` (case, time, compliance) as of ``LineMatrices``.

    ``products`` : as what matrices are kept, whole by default.
    """
    products = products or WholeProducts(topo.size)
    co, turning = coefficients, turning_of(topo, coefficients, tau, products.columns)
    motion, speed = turning.motion, coefficients.speed[:, None, None]
    r, rate, rate2 = turning.value, turning.slope * speed[..., None], turning.curvature * speed[..., None] ** 2
    v = motion.speed * speed
    inertia = np.broadcast_to(co.inertia[:, None], v.shape)
    growth = co.viscous[:, None] + 2 * co.quadratic[:, None] * np.abs(v)
    sense = np.sign(topo.mean_speeds)
    load = co.load[:, None] * sense + (co.viscous[:, None] + co.quadratic[:, None] * np.abs(v)) * v
    inertial = inertia * motion.acceleration * speed**2
    e, e1 = turning.elongations(topo, r), turning.elongations(topo, rate)
    k, c = co.stiffness[:, None] * wave, np.broadcast_to(co.damping[:, None], wave.shape)
    twist, slip = _of_loops(topo, co, motion, tau)
    torque = co.torque[:, None] * wave + k * twist + c * slip
    bend = _of_bends(topo, turning, inertial + load - co.not_carried[:, None] * sense, torque)
    at, between = products.of_stations, products.of_springs
    mass = at(r, inertia, r)
    damping = at(r, growth, r) + 2 * at(r, inertia, rate) + between(e, c, e)
    stiffness = at(r, inertia, rate2) + at(r, growth, rate) + at(r, bend, r) + between(e, k, e) + between(e, c, e1)
    for one in co.across:
        on, by = one.slope[:, None, None] * r[:, :, one.on], one.by
        damping = damping + products.of_pair(one.on, on, by, r[:, :, by])
        stiffness = stiffness + products.of_pair(one.on, on, by, rate[:, :, by])
    forcing = -np.einsum("cts,ctsi->cti", inertial + load, r) - np.einsum("cte,ctei->cti", torque, e)
    return GraphMatrices(mass, damping, stiffness, forcing, turning, twist)


def _of_bends(topo: Topology, turning: GraphKinematics, acting: Array, torque: Array) -> Array:
    """w of Σ_s F_s H_s = Σ_b w_b R_bᵀR_b (case, time, station): torques on all stations are carried back through ties
    and joints, each of which bends the rotation in front of it."""
    weight = np.zeros_like(acting)
    if not turning.bend:
        return weight
    held = acting.copy()
    for e, (far, near) in enumerate(zip(*ends_of(topo), strict=True)):
        held[..., far] += torque[..., e]
        held[..., near] -= torque[..., e]
    for s in range(len(topo.stations) - 1, 0, -1):
        station, b = topo.stations[s], topo.stations[s].before
        if station.link is LinkKind.SUM:
            for one, share in station.of:
                held[..., one] += float(share) * held[..., s]
        elif station.link is LinkKind.RATIO:
            held[..., b] += held[..., s] / topo.ratio_values[s]
        elif station.link is LinkKind.JOINT:
            weight[..., b] += held[..., s] * turning.bend[s]
            held[..., b] += turning.eta[s] * held[..., s]
    return weight


def _of_loops(topo: Topology, co: LineCoefficients, motion: BaseMotion, tau: Array) -> tuple[Array, Array]:
    """By how much the base motion twists compliances that close loops about its mean, and how fast in time beyond what
    slips for ever (case, time, compliance)."""
    twist, slip = np.zeros((2, *motion.angle.shape[:2], len(topo.compliances)))
    closing = [e for e, one in enumerate(topo.compliances) if one.far is not None]
    if not closing or not any(law.nonuniform for law in co.joints):
        return twist, slip
    far, near = (np.array(part)[closing] for part in ends_of(topo))
    turns = float(topo.period_turns())
    cycles = max((float(rate) for rate in topo.rates), default=1.0) * turns
    grid = 2 * np.pi * turns * np.arange(times := SAMPLES * int(np.ceil(max(cycles, 1.0)))) / times
    apart = topo.apart[closing]

    def between(angle: Array, at: Array) -> Array:
        return np.asarray(angle[..., far] - angle[..., near] - apart * at[:, None])

    whole = between(base_motion(topo, co, grid).angle, grid).mean(axis=1, keepdims=True)
    twist[..., closing] = between(motion.angle, tau) - whole
    slip[..., closing] = (motion.speed[..., far] - motion.speed[..., near] - apart) * co.speed[:, None, None]
    return twist, slip
