"""Linearised equations of a line about its base motion, in absolute rotations (small δ per group).

With q_e = δ_far − r δ_near the elongation of compliance e, r the ratio from the near group's first station
to the shaft's near end, and T̄ the static torque (positive with the twist),

    J δ″ + J′wδ′ + (J′w′ + ½J″w²) δ + Σ_e (∂q_e/∂δ)(c q̇_e + k q_e) − r₁ T̄ δ + r₁ M δ + r M′ (r δ′ + r₁ w δ)
        = −J w′ − ½J′w² − Σ_e (∂q_e/∂δ) T̄_e − r M,

(untwisted, T̄ and the mean of M leave the left side: no torque acts in that base state),
where J(a) = Σ J_s r_s² is the inertia of a group (it depends on the angle when a joint lies inside the
group), J′ and J″ its derivatives by the angle of the group, M = M₀ + c₁v + c₂v|v| the load torques at the
station's own speed v = rw, behind an angled joint a periodic one, M′ = c₁ + 2c₂|v| their slope, and q̇_e the
full derivative with ṙ. Each group inherits w, w′ from ``kinematics``.

The stiffness of a gear mesh varies with its phase: with w(τ) its factor over the mean, k stands for wk and T̄ for wT̄,
which is what the mesh carries in its static twist. A line without joints moves exactly so while each mesh keeps its
stage. Behind an angled joint the vibration that this base leaves out moves multipliers at least as much as another T̄
would.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from trunnion.arrays import Array, Flags, Integers
from trunnion.equations.aligned import aligned_matrices, frequencies, loaded_matrices
from trunnion.equations.coefficients import Assembly
from trunnion.equations.given_rotation import GivenRotation
from trunnion.equations.graph_matrices import ends_of, graph_matrices
from trunnion.equations.kinematics import BaseMotion, base_motion, even_angles
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.steady_base import refuse_periodic_base, require_steady_base
from trunnion.equations.topology import Topology, require_period
from trunnion.systems.periodic_linear import Matrices, PeriodicLinearSystem


@dataclass(frozen=True)
class LineMatrices:
    """Matrices in time (not divided by Ω), shapes (case, time, n, n) and (case, time, n).

    ``ratio`` (case, time, compliance) is r of each compliance's near end, ``wave`` its stiffness over the mean.
    Of a line that is not a tree and varies: ``elongations`` (case, time, compliance, n), twist of every compliance per
    rotation of every unknown; ``base_twist`` (case, time, compliance), of those that close loops by the base motion.
    """

    mass: Array
    damping: Array
    stiffness: Array
    forcing: Array
    ratio: Array
    wave: Array
    elongations: Array | None = None
    base_twist: Array | None = None


def stiffness_waves(topo: Topology, coefficients: LineCoefficients, tau: Array) -> Array:
    """Stiffness of every compliance over its mean at input angles ``tau`` [rad]; shape (case, time, compliance)."""
    wave = np.ones((len(coefficients.speed), len(tau), len(topo.compliances)))
    for mesh in coefficients.waves:
        wave[..., mesh.compliance] = mesh.at(tau)
    return wave


def line_matrices(
    topo: Topology, coefficients: LineCoefficients, tau: Array, given: GivenRotation | None = None
) -> LineMatrices:
    """Linearised M, C, K and forcing in physical time at input angles ``tau`` [rad]; of a tree about a motion that is
    ``given``, by default that of rigid shafts."""
    if topo.graph:
        return _graph_matrices(topo, coefficients, tau)
    cases, times, n = len(coefficients.speed), len(tau), topo.size
    # Each entry lies in one piece over time, which is how it is filled.
    mass, damping, stiffness = (np.zeros((n, n, cases, times)) for _ in range(3))
    forcing = np.zeros((cases, times, n))
    ratio, wave = put_entries(topo, coefficients, tau, mass, damping, stiffness, forcing, given)
    mass, damping, stiffness = (part.transpose(2, 3, 0, 1) for part in (mass, damping, stiffness))
    return LineMatrices(mass, damping, stiffness, forcing, ratio, wave)


Place = int | Integers
AT_ONCE = 512
"""Cases times times up to which one step for many springs is cheaper than one each: their entries are copied for it."""


class Entries(Protocol):
    """Entries of a matrix by row and column, each (case, time), that numbers are added to in place; of several at once
    (entry, case, time)."""

    def __getitem__(self, place: tuple[Place, Place]) -> Array: ...

    def __setitem__(self, place: tuple[Place, Place], values: Array) -> None: ...


def put_entries(
    topo: Topology,
    coefficients: LineCoefficients,
    tau: Array,
    mass: Entries,
    damping: Entries,
    stiffness: Entries,
    forcing: Array,
    given: GivenRotation | None = None,
) -> tuple[Array, Array]:
    """Add the equations at input angles ``tau`` [rad] to matrices and ``forcing`` (case, time, n), which are zero.

    Returns ratio and wave as of ``LineMatrices``. ``given`` : the motion that they are linearised about; forcing is
    then what it leaves unbalanced.
    """
    motion = base_motion(topo, coefficients, tau, given=given)
    cases, times = motion.angle.shape[:2]
    speed = coefficients.speed[:, None]
    ratio_seen, wave = np.zeros((cases, times, len(topo.compliances))), stiffness_waves(topo, coefficients, tau)
    torques = coefficients.torque[:, None] * wave if coefficients.waves else coefficients.torque[:, None]
    not_carried = coefficients.not_carried
    if given:
        coefficients = replace(coefficients, load=coefficients.load + given.load)
        torques, not_carried = _torques_of(topo, coefficients, tau, motion, wave), np.zeros_like(not_carried)
    acting = (coefficients.inertia, coefficients.load, coefficients.viscous, coefficients.quadratic)
    loaded = np.any([part.any(axis=0) for part in acting[1:]], axis=0)
    inert, springs = (NONE, NONE)
    if cases * times <= AT_ONCE and not coefficients.waves:
        inert, springs = alike(topo, loaded)
    if len(inert):
        at, moment = topo.unknown_of[inert], coefficients.inertia[:, None, inert]
        mass[at, at] += np.moveaxis(moment, 2, 0)
        forcing[..., at] -= moment * (motion.acceleration[..., inert] * speed[..., None] ** 2)
    for s in _but(acting[0].any(axis=0) | loaded, inert):
        group = topo.group_of(s)
        i, ref = topo.coordinate[group], topo.reference[group]
        if i < 0:
            continue
        r, r1, r2 = motion.relative[..., s], motion.relative_slope[..., s], motion.relative_curvature[..., s]
        w, w1 = motion.speed[..., ref] * speed, motion.acceleration[..., ref] * speed**2
        inertia = coefficients.inertia[:, s, None]
        if s == ref and not loaded[s]:  # r = 1
            mass[i, i] += inertia
            forcing[..., i] -= inertia * w1
            continue
        load = coefficients.load[:, s, None]
        viscous, quadratic = coefficients.viscous[:, s, None], coefficients.quadratic[:, s, None]
        v = r * w
        growth = viscous + 2 * quadratic * np.abs(v)
        # A constant load resists the mean sense of rotation of its own station, the others the rotation itself.
        sense = np.sign(float(topo.speed_ratio[s]))
        load = load * sense + (viscous + quadratic * np.abs(v)) * v
        carried = load - not_carried[:, s, None] * sense
        j, j1, j2 = inertia * r**2, 2 * inertia * r * r1, 2 * inertia * (r1**2 + r * r2)
        mass[i, i] += j
        damping[i, i] += j1 * w + r**2 * growth
        stiffness[i, i] += j1 * w1 + j2 * w**2 / 2 + r1 * carried + r * growth * r1 * w
        forcing[..., i] -= j * w1 + j1 * w**2 / 2 + r * load
    if len(springs):
        _put_springs(topo, coefficients, torques, springs, damping, stiffness, forcing)
        ratio_seen[..., springs] = 1.0
    for e in _but(np.ones(len(topo.compliances), dtype=bool), springs):
        compliance, (far, near) = topo.compliances[e], topo.ends[e]
        ref = topo.reference[topo.group_of(compliance.near)]
        k, c, torque = coefficients.stiffness[:, e, None], coefficients.damping[:, e, None], torques[..., e]
        if coefficients.waves:
            k = k * wave[..., e]
        r, r1, r_dot = np.ones(1), np.zeros(1), np.zeros(1)
        if compliance.near != ref:
            r, r1 = motion.relative[..., compliance.near], motion.relative_slope[..., compliance.near]
            r_dot = r1 * motion.speed[..., ref] * speed
        ratio_seen[..., e] = r
        if far >= 0:
            damping[far, far] += c
            stiffness[far, far] += k
            forcing[..., far] -= torque
        if near >= 0:
            damping[near, near] += c * r**2
            stiffness[near, near] += k * r**2 + c * r * r_dot - r1 * torque
            forcing[..., near] += r * torque
        if far >= 0 and near >= 0:
            damping[far, near] -= c * r
            damping[near, far] -= c * r
            stiffness[far, near] -= k * r + c * r_dot
            stiffness[near, far] -= k * r
    return ratio_seen, wave


def _torques_of(topo: Topology, co: LineCoefficients, tau: Array, motion: BaseMotion, wave: Array) -> Array:
    """Torques of the springs (case, time, compliance) [N m] in a ``motion`` that twists them."""
    far, near = ends_of(topo)
    turned, speed = motion.angle - even_angles(topo, co, tau), motion.speed - topo.mean_speeds
    twist, rate = turned[..., far] - turned[..., near], speed[..., far] - speed[..., near]
    return np.asarray(co.stiffness[:, None] * wave * twist + (co.damping * co.speed[:, None])[:, None] * rate)


NONE = np.zeros(0, dtype=np.intp)


def _but(which: Flags, put: Integers) -> list[int]:
    """Places of ``which`` that were not put yet."""
    which[put] = False
    return np.flatnonzero(which).tolist()


def alike(topo: Topology, loaded: Flags) -> tuple[Integers, Integers]:
    """Stations whose inertia alone counts and is the first of its group, and springs between the first stations of two
    groups that share no unknown in front: entries that are put at once.

    ``loaded`` (station,): where outer torques act.
    """
    reference = np.array(topo.reference)
    inert = [s for s in reference[np.array(topo.coordinate) >= 0].tolist() if not loaded[s]]
    ends = np.array(topo.ends, dtype=np.intp).reshape(-1, 2)
    onward = np.bincount(ends[ends[:, 1] >= 0, 1], minlength=topo.size)
    springs = [
        e
        for e, (far, near) in enumerate(topo.ends)
        if far >= 0 and near >= 0 and onward[near] == 1
        and topo.compliances[e].near == reference[topo.group_of(topo.compliances[e].near)]
    ]  # fmt: skip
    return np.array(inert, dtype=np.intp), np.array(springs, dtype=np.intp)


def _put_springs(
    topo: Topology,
    coefficients: LineCoefficients,
    torques: Array,
    springs: Integers,
    damping: Entries,
    stiffness: Entries,
    forcing: Array,
) -> None:
    """Add those that ``alike`` names, between stations that turn as the unknowns do."""
    far, near = np.array(topo.ends, dtype=np.intp)[springs].T
    for matrix, part in ((damping, coefficients.damping), (stiffness, coefficients.stiffness)):
        values = part.T[springs, :, None]
        matrix[far, far] += values
        matrix[near, near] += values
        matrix[far, near] -= values
        matrix[near, far] -= values
    torque = torques[..., springs]
    forcing[..., far] -= torque
    forcing[..., near] += torque


def varies(coefficients: LineCoefficients) -> bool:
    """Whether a joint is bent or a mesh varies."""
    return any(law.nonuniform for law in coefficients.joints) or bool(coefficients.waves)


def _graph_matrices(topo: Topology, coefficients: LineCoefficients, tau: Array) -> LineMatrices:
    """The same of a line whose shafts are tied to several others or close loops: M couples what they share."""
    cases, times = len(coefficients.speed), len(tau)
    wave, ratio = stiffness_waves(topo, coefficients, tau), np.ones((cases, times, len(topo.compliances)))
    if varies(coefficients):
        found = graph_matrices(topo, coefficients, tau, wave)
        elongations = found.turning.elongations(topo, found.turning.value)
        return LineMatrices(
            found.mass, found.damping, found.stiffness, found.forcing, ratio, wave, elongations, found.base_twist
        )  # fmt: skip
    same = loaded_matrices(topo, coefficients, coefficients.speed)

    def lasting(part: Array) -> Array:
        return np.broadcast_to(part[:, None], (cases, times, *part.shape[1:]))

    still = np.zeros((cases, topo.size))
    mass, damping, stiffness, forcing = map(lasting, (same.inertia, same.damping, same.stiffness, still))
    return LineMatrices(mass, damping, stiffness, forcing, ratio, wave)


def over_mass(matrices: LineMatrices, part: Array) -> Array:
    """M⁻¹ times a matrix (case, time, n, n)."""
    own = np.einsum("ctii->cti", matrices.mass)
    if np.count_nonzero(matrices.mass) > np.count_nonzero(own):
        return np.asarray(np.linalg.solve(matrices.mass, part))
    return np.asarray(part * (1 / own)[..., None])


def require_rigid_base(assembly: Assembly, table: Array) -> None:
    """Refuse a line that no steady motion of rigid shafts stands for."""
    require_steady_base(assembly, table)
    refuse_periodic_base(assembly, "put a ConstantSpeed in front")


def periodic_linear_system(
    assembly: Assembly, table: Array, *, statically_twisted: bool = True
) -> PeriodicLinearSystem:
    """The linearised line at one row of packed numbers, in the input angle τ = Ωt.

    Raises
    ------
    InputError : a line without a usable period, or one whose base motion is not steady (see
        ``require_steady_base``).
    """
    topo = assembly.topology
    require_rigid_base(assembly, table)
    coefficients = assembly.coefficients(table, statically_twisted=statically_twisted)
    speed = float(coefficients.speed[0])
    period = 2 * np.pi * float(require_period(assembly.line, topo))

    def at(tau: Array) -> Matrices:
        m = line_matrices(topo, coefficients, np.asarray(tau, dtype=float))
        return Matrices(m.mass[0], m.damping[0] / speed, m.stiffness[0] / speed**2, m.forcing[0] / speed**2)

    aligned = frequencies(aligned_matrices(topo, coefficients), still=topo.still)[0]
    names, over_speed = topo.names, tuple(map(float, aligned / speed))
    fastest = float(max(topo.rates, default=0))
    return PeriodicLinearSystem(period, at, topo.size, speed, names, over_speed, fastest)


def rigid_motions(topo: Topology, coefficients: LineCoefficients) -> Array:
    """States (x, dx/dτ) as columns (2n, k) that a line keeps for ever: multipliers exactly 1.

    A turn of a free line as a whole always, and of the legs of a differential against each other; a change of such a
    speed where no load depends on the speed: without angled joints only. And a turn of what only oil drags along,
    joints bent or not. k is 0 for a driven line without any of these.
    """
    n, constant = topo.size, not (coefficients.viscous.any() or coefficients.quadratic.any())
    turns, speeds = topo.loose, topo.rigid if constant else topo.rigid[:, :0]
    kept = np.zeros((2 * n, topo.still + speeds.shape[1]))
    kept[:n, : topo.still], kept[n:, topo.still :] = turns, speeds
    return kept
