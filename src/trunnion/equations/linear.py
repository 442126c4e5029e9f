"""Linearised equations of a line about its base motion, in absolute rotations (small δ per group).

With q_e = δ_far − r δ_near the elongation of compliance e, r the ratio from the near group's first station
to the shaft's near end, and T̄ the static torque (positive with the twist),

    J δ″ + J′wδ′ + (J′w′ + ½J″w²) δ + Σ_e (∂q_e/∂δ)(c q̇_e + k q_e) − r₁ T̄ δ + r₁ M δ
        = −J w′ − ½J′w² − Σ_e (∂q_e/∂δ) T̄_e − r M,

where J(a) = Σ J_s r_s² is the inertia of a group (it depends on the angle when a joint lies inside the
group), J′ and J″ its derivatives by the angle of the group, M the load torques, and q̇_e the full
derivative with ṙ. Each group inherits w, w′ from ``kinematics``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from trunnion.equations.aligned import aligned_matrices, frequencies
from trunnion.equations.coefficients import Assembly, LineCoefficients
from trunnion.equations.kinematics import base_motion, ratio_values
from trunnion.equations.topology import Topology, require_period
from trunnion.errors import InputError
from trunnion.systems.periodic_linear import Matrices, PeriodicLinearSystem

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LineMatrices:
    """Matrices in time (not divided by Ω), shapes (case, time, n, n) and (case, time, n).

    ``ratio`` and ``ratio_slope`` (case, time, compliance) are r and dr/dτ of each compliance's near end.
    """

    mass: Array
    damping: Array
    stiffness: Array
    forcing: Array
    ratio: Array
    ratio_slope: Array


def line_matrices(topo: Topology, coefficients: LineCoefficients, tau: Array) -> LineMatrices:
    """Linearised M, C, K and forcing in physical time at input angles ``tau`` [rad]."""
    motion = base_motion(topo, coefficients, tau, ratio_values(topo))
    cases, times, n = (*motion.angle.shape[:2], topo.size)
    speed = coefficients.speed[:, None]
    mass, damping, stiffness = (np.zeros((cases, times, n, n)) for _ in range(3))
    forcing = np.zeros((cases, times, n))
    slope_seen = np.zeros((cases, times, len(topo.compliances)))
    ratio_seen = np.zeros_like(slope_seen)
    for s in range(len(topo.stations)):
        group = topo.group_of(s)
        i, ref = topo.coordinate[group], topo.reference[group]
        if i < 0:
            continue
        r, r1, r2 = motion.relative[..., s], motion.relative_slope[..., s], motion.relative_curvature[..., s]
        w, w1 = motion.speed[..., ref] * speed, motion.acceleration[..., ref] * speed**2
        inertia, load = coefficients.inertia[:, s, None], coefficients.load[:, s, None]
        # A load resists the mean sense of rotation of its own station.
        load = load * np.sign(float(topo.speed_ratio[s]))
        j, j1, j2 = inertia * r**2, 2 * inertia * r * r1, 2 * inertia * (r1**2 + r * r2)
        mass[..., i, i] += j
        damping[..., i, i] += j1 * w
        stiffness[..., i, i] += j1 * w1 + j2 * w**2 / 2 + r1 * load
        forcing[..., i] -= j * w1 + j1 * w**2 / 2 + r * load
    for e, compliance in enumerate(topo.compliances):
        near_group = topo.group_of(compliance.near)
        far, near = topo.coordinate[compliance.far_group], topo.coordinate[near_group]
        r, r1 = motion.relative[..., compliance.near], motion.relative_slope[..., compliance.near]
        r_dot = r1 * motion.speed[..., topo.reference[near_group]] * speed
        k, c = coefficients.stiffness[:, e, None], coefficients.damping[:, e, None]
        torque = coefficients.torque[:, e, None]
        ratio_seen[..., e], slope_seen[..., e] = r, r_dot / speed
        if far >= 0:
            damping[..., far, far] += c
            stiffness[..., far, far] += k
            forcing[..., far] -= torque
        if near >= 0:
            damping[..., near, near] += c * r**2
            stiffness[..., near, near] += k * r**2 + c * r * r_dot - r1 * torque
            forcing[..., near] += r * torque
        if far >= 0 and near >= 0:
            damping[..., far, near] -= c * r
            damping[..., near, far] -= c * r
            stiffness[..., far, near] -= k * r + c * r_dot
            stiffness[..., near, far] -= k * r
    return LineMatrices(mass, damping, stiffness, forcing, ratio_seen, slope_seen)


def periodic_linear_system(
    assembly: Assembly, table: Array, *, statically_twisted: bool = True
) -> PeriodicLinearSystem:
    """The linearised line at one row of packed numbers, in the input angle τ = Ωt.

    Raises
    ------
    InputError : no speed, a line without a usable period, or one whose base motion is not steady (see
        ``require_steady_base``).
    """
    topo = assembly.topology
    require_steady_base(assembly)
    coefficients = assembly.coefficients(table, statically_twisted=statically_twisted)
    speed = float(coefficients.speed[0])
    if not (np.isfinite(speed) and speed > 0):
        raise InputError("must be a positive speed", key="speed", value=speed, remedy="give rad/s, or tn.rpm(1500)")
    period = 2 * np.pi * float(require_period(assembly.line, topo))

    def at(tau: Array) -> Matrices:
        m = line_matrices(topo, coefficients, np.asarray(tau, dtype=float))
        return Matrices(m.mass[0], m.damping[0] / speed, m.stiffness[0] / speed**2, m.forcing[0] / speed**2)

    aligned = frequencies(aligned_matrices(topo, coefficients), free=topo.free)[0]
    return PeriodicLinearSystem(period, at, topo.size, speed, topo.names, tuple(map(float, aligned / speed)))


def require_steady_base(assembly: Assembly) -> None:
    """Refuse lines whose zero-twist motion at constant input speed is not a motion to linearise about.

    A free line with bent joints does not turn at constant speed, and a far end held at constant speed
    fights the joints in front of it: both need their own periodic motion as the base.
    """
    topo = assembly.topology
    for part, name in zip(assembly.line.elements, assembly.line.names, strict=True):
        for key in ("viscous_load", "quadratic_load"):
            if getattr(part, key, 0.0):
                raise InputError(
                    "depends on the speed, which the linear equations do not have",
                    element=name,
                    key=key,
                    value=getattr(part, key),
                    remedy="use tn.periodic_response, or write its mean as load_torque",
                )
    if topo.free and topo.joints:
        raise InputError(
            "starts free, so it does not turn steadily through bent joints and has no base for stability",
            element="driveline",
            remedy="put a ConstantSpeed in front; natural frequencies are available as it is",
        )
    if sum(topo.prescribed) > 1:
        end = [g for g, fixed in enumerate(topo.prescribed) if fixed][-1]
        element = assembly.line.names[topo.stations[topo.reference[end]].element]
        raise InputError(
            "a second prescribed speed leads nowhere in a stability analysis",
            element=f"ConstantSpeed behind {element}",
            remedy="end the line with a Disk; natural frequencies are available as it is",
        )
    if topo.free:
        load = assembly.coefficients(assembly.table(1)).load[0]
        ratio = np.abs(np.array([float(q) for q in topo.speed_ratio]))
        if abs(load @ ratio) > 1e-9 * max(np.abs(load).max(), 1e-300):
            raise InputError(
                "is free and its load torques do not balance, so it does not turn steadily",
                element="driveline",
                key="load_torque",
                value=float(load @ ratio),
                remedy="drive it with a ConstantSpeed, or give the driving disk a negative load_torque",
            )
