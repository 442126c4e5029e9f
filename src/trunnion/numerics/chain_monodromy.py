"""Monodromy matrices of many jointed chains (or trees) at once.

Sixteen *lanes*, neighbouring points of a chart, are integrated together by the order-8 pair of Dormand and
Prince with common, error-controlled steps. Every lane has its own stiffness, damping, inertia, joint angles
and phases. One sine and cosine per time serve all lanes and joints: with C = cos 2χ, S = sin 2χ at a
joint's input and D = 1 − sin²β (1 + C)/2, its output has

    η = cos β / D,   cos 2ψ = (cos²β (1 + C) − (1 − C)) / 2D,   sin 2ψ = cos β S / D,

and fork phases turn (C, S) by a constant. Coordinates are absolute rotations scaled by √J and velocities by
a typical frequency ν, so entries of Z are comparable and one number measures their error.

In these units, for unknown i with parent p (η-like factor e_i of the shaft's near end, f_i its slope),

    T_i = κ_i (x_i − e_i x_p) + d_i (v_i − e_i v_p − f_i x_p)
    m_i v_i′ = −T_i + Σ_children e T − g_i v_i − h_i x_i,     x_i′ = v_i.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from trunnion.numerics.runge_kutta import A, B, C, E3, E5

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

LANES = 16
MOST_STEPS = 200_000


class ChainProgram(NamedTuple):
    """What all lanes share: who hangs on whom, and which joint's law acts where. Sources are −1 for "none".

    parent (n,): parent unknown, −1 at a prescribed or missing root.
    joint_speed_source, joint_rate (joints,): the joint whose output drives this one (−1: the input itself),
        and the speed ratio in between.
    joint_ratio_source, joint_ratio (joints,): the same within the joint's group, for r = da/da_ref.
    near_source, near_ratio (n,): r of the near end of unknown i's shaft, within the parent's group.
    near_speed_source, near_speed (n,): mean and joint giving the speed of the parent group's reference.
    member_unknown, member_source, member_ratio (members,): inertias of groups that contain joints.
    member_speed_source, member_speed (members,): speed of that group's reference.
    """

    parent: Integers
    joint_speed_source: Integers
    joint_rate: Array
    joint_ratio_source: Integers
    joint_ratio: Array
    near_source: Integers
    near_ratio: Array
    near_speed_source: Integers
    near_speed: Array
    member_unknown: Integers
    member_source: Integers
    member_ratio: Array
    member_speed_source: Integers
    member_speed: Array


class ChainLanes(NamedTuple):
    """Numbers per lane, lanes last.

    cosine, phase (joints, lanes): cos β, and the constant part of χ since the source [rad].
    stiffness κ, damping d, scale √(J_i/J_p), torque T̄/(J_p Ω²) (n, lanes).
    member_inertia J/J_i and member_load M/(J_i Ω²) (members, lanes).
    frequency ν (lanes,).
    """

    cosine: Array
    phase: Array
    stiffness: Array
    damping: Array
    scale: Array
    torque: Array
    member_inertia: Array
    member_load: Array
    frequency: Array


class _Tables(NamedTuple):
    """Time-dependent coefficients at the stages of one step; (stages, n, lanes)."""

    near: Array
    near_slope: Array
    extra_damping: Array
    extra_stiffness: Array
    over_mass: Array


def chain_monodromy(
    program: ChainProgram, lanes: ChainLanes, period: float, tolerance: float
) -> tuple[Array, Array, Array]:
    """Z (lanes, 2n, 2n) in scaled units, its error estimate (lanes,) and ∫ tr(M⁻¹C) dτ (lanes,).

    A lane whose integration fails has NaN. Releases the GIL: call it from several threads.
    """
    n, count = lanes.stiffness.shape
    matrix = np.empty((count, 2 * n, 2 * n))
    error, trace = np.empty(count), np.empty(count)
    for start in range(0, count, LANES):
        stop = min(start + LANES, count)
        block = ChainLanes(*(_padded(part, start, stop) for part in lanes))
        z, e, t = _integrate(program, block, period, tolerance, A, B, C, E3, E5)
        matrix[start:stop] = np.moveaxis(z, 2, 0)[: stop - start]
        error[start:stop], trace[start:stop] = e[: stop - start], t[: stop - start]
    return matrix, error, trace


def _padded(part: Array, start: int, stop: int) -> Array:
    """Lanes start…stop, filled up to LANES with copies of the last."""
    index = np.minimum(np.arange(start, start + LANES), stop - 1)
    return np.ascontiguousarray(part[..., index])


@njit(cache=True, nogil=True)
def _integrate(program, lanes, period, tolerance, a, b, c, e3, e5):  # type: ignore[no-untyped-def]
    n = lanes.stiffness.shape[0]
    wide = 2 * n * 2 * n * LANES
    state = np.zeros(wide)
    for i in range(2 * n):
        for lane in range(LANES):
            state[(i * 2 * n + i) * LANES + lane] = 1.0
    slopes, here, trial = np.empty((12, wide)), np.empty(wide), np.empty(wide)
    shape = (12, n, LANES)
    near, near_slope, extra_damping = np.zeros(shape), np.zeros(shape), np.zeros(shape)
    tables = _Tables(near, near_slope, extra_damping, np.zeros(shape), np.ones(shape))
    local, error, trace = np.empty(LANES), np.zeros(LANES), np.zeros(LANES)
    joints = lanes.cosine.shape[0]
    turn_c, turn_s = np.cos(2 * lanes.phase), np.sin(2 * lanes.phase)
    work = np.empty((8, max(1, joints), LANES))
    tau, step = 0.0, min(period / 16, 0.5 / lanes.frequency.max())
    for _ in range(MOST_STEPS):
        if tau >= period:
            break
        if tau + step > period * (1 - 1e-12):
            step = period - tau
        elif tau + 1.9 * step > period:
            step = (period - tau) / 2
        for m in range(12):
            _fill(program, lanes, turn_c, turn_s, tau + c[m] * step, m, tables, work)
        _try_step(program.parent, lanes, tables, step, state, slopes, here, trial, a, b)
        _estimate(slopes, step, e3, e5, local, 2 * n * 2 * n)
        worst = local.max() / (tolerance * step / period)
        if worst <= 1.0:
            state, trial = trial, state
            error += local
            _accumulate_trace(program.parent, lanes, tables, step, b, trace)
            tau = period if tau + step > period * (1 - 1e-12) else tau + step
        elif not worst < np.inf:
            if step < 1e-6 * period:
                break
            worst = 1e8
        step *= min(3.0, max(0.1, 0.9 * (worst + 1e-30) ** (-1 / 7.0)))
    matrix = state.reshape(2 * n, 2 * n, LANES).copy()
    if tau < period:
        matrix[:] = np.nan
        error[:] = np.nan
    for lane in range(LANES):
        norm = np.sqrt(np.sum(matrix[:, :, lane] ** 2) / (2 * n))
        error[lane] = (error[lane] + 4e-16 * n) * max(1.0, norm)
    return matrix, error, trace


@njit(cache=True, nogil=True, fastmath=True)
def _fill(program, lanes, turn_c, turn_s, tau, m, tables, work):  # type: ignore[no-untyped-def]
    """Coefficients of all unknowns at time ``tau`` into row m of the tables."""
    c2, s2, speed, acceleration, ratio, ratio1, ratio2, psi = (
        work[0], work[1], work[2], work[3], work[4], work[5], work[6], work[7],
    )  # fmt: skip
    curved = len(program.member_unknown) > 0
    for j in range(lanes.cosine.shape[0]):
        source, rate = program.joint_speed_source[j], program.joint_rate[j]
        within, factor = program.joint_ratio_source[j], program.joint_ratio[j]
        plain_c, plain_s = np.cos(2 * rate * tau), np.sin(2 * rate * tau)
        for lane in range(LANES):
            if source < 0:
                in_c, in_s, w, w1 = plain_c, plain_s, rate, 0.0
            elif rate == 1.0 or rate == -1.0:
                in_c, in_s = c2[source, lane], rate * s2[source, lane]
                w, w1 = rate * speed[source, lane], rate * acceleration[source, lane]
            else:
                in_c, in_s = np.cos(2 * rate * psi[source, lane]), np.sin(2 * rate * psi[source, lane])
                w, w1 = rate * speed[source, lane], rate * acceleration[source, lane]
            cos2 = in_c * turn_c[j, lane] - in_s * turn_s[j, lane]
            sin2 = in_s * turn_c[j, lane] + in_c * turn_s[j, lane]
            cb = lanes.cosine[j, lane]
            sb2 = 1.0 - cb * cb
            over = 1.0 / (1.0 - 0.5 * sb2 * (1.0 + cos2))
            eta = cb * over
            slope = -cb * sb2 * sin2 * over * over
            speed[j, lane] = eta * w
            acceleration[j, lane] = slope * w * w + eta * w1
            c2[j, lane] = 0.5 * (cb * cb * (1.0 + cos2) - (1.0 - cos2)) * over
            s2[j, lane] = cb * sin2 * over
            r, r1, r2 = factor, 0.0, 0.0
            if within >= 0:
                r, r1 = factor * ratio[within, lane], factor * ratio1[within, lane]
                r2 = factor * ratio2[within, lane]
            ratio[j, lane] = eta * r
            ratio1[j, lane] = eta * r1 + slope * r * r
            if curved:
                curvature = -2 * cb * sb2 * over * over * (cos2 - sb2 * sin2 * sin2 * over)
                ratio2[j, lane] = eta * r2 + 3 * slope * r * r1 + curvature * r * r * r
        if _drives_ratio(program, j):
            _unwrapped(program, lanes, tau, j, psi)
    for i in range(lanes.stiffness.shape[0]):
        source, factor = program.near_source[i], program.near_ratio[i]
        speed_source, mean = program.near_speed_source[i], program.near_speed[i]
        for lane in range(LANES):
            mu = lanes.scale[i, lane]
            r, r1 = factor, 0.0
            if source >= 0:
                r, r1 = factor * ratio[source, lane], factor * ratio1[source, lane]
            w = mean
            if speed_source >= 0:
                w = mean * speed[speed_source, lane]
            tables.near[m, i, lane] = mu * r
            tables.near_slope[m, i, lane] = mu * r1 * w
            tables.extra_damping[m, i, lane] = 0.0
            tables.extra_stiffness[m, i, lane] = 0.0
            p = program.parent[i]
            if p >= 0 and source >= 0:
                tables.extra_stiffness[m, p, lane] -= r1 * lanes.torque[i, lane]
    if curved:
        _fill_members(program, lanes, m, tables, speed, acceleration, ratio, ratio1, ratio2)


@njit(cache=True, nogil=True)
def _fill_members(program, lanes, m, tables, speed, acceleration, ratio, ratio1, ratio2):  # type: ignore[no-untyped-def]
    """Inertia that depends on the angle: members behind a joint of their own group."""
    for k in range(len(program.member_unknown)):
        tables.over_mass[m, program.member_unknown[k]] = 0.0
    for k in range(len(program.member_unknown)):
        i, source, factor = program.member_unknown[k], program.member_source[k], program.member_ratio[k]
        speed_source, mean = program.member_speed_source[k], program.member_speed[k]
        for lane in range(LANES):
            r, r1, r2 = factor, 0.0, 0.0
            if source >= 0:
                r, r1 = factor * ratio[source, lane], factor * ratio1[source, lane]
                r2 = factor * ratio2[source, lane]
            w, w1 = mean, 0.0
            if speed_source >= 0:
                w, w1 = mean * speed[speed_source, lane], mean * acceleration[speed_source, lane]
            inertia = lanes.member_inertia[k, lane]
            tables.over_mass[m, i, lane] += inertia * r * r
            tables.extra_damping[m, i, lane] += 2 * inertia * r * r1 * w
            tables.extra_stiffness[m, i, lane] += (
                inertia * (2 * r * r1 * w1 + (r1 * r1 + r * r2) * w * w) + r1 * lanes.member_load[k, lane]
            )
    done = -1
    for k in range(len(program.member_unknown)):
        i = program.member_unknown[k]
        if i != done:
            for lane in range(LANES):
                tables.over_mass[m, i, lane] = 1.0 / tables.over_mass[m, i, lane]
        done = i


@njit(cache=True, nogil=True)
def _drives_ratio(program, j):  # type: ignore[no-untyped-def]
    for other in range(j + 1, len(program.joint_speed_source)):
        if program.joint_speed_source[other] == j and abs(program.joint_rate[other]) != 1.0:
            return True
    return False


@njit(cache=True, nogil=True)
def _unwrapped(program, lanes, tau, j, psi):  # type: ignore[no-untyped-def]
    """ψ itself, which a ratio behind a joint needs: multiples of 2ψ do not suffice there."""
    source, rate = program.joint_speed_source[j], program.joint_rate[j]
    for lane in range(LANES):
        before = tau if source < 0 else psi[source, lane]
        chi = rate * before + lanes.phase[j, lane]
        cb = lanes.cosine[j, lane]
        t = (1.0 - cb) / (1.0 + cb)
        psi[j, lane] = chi + np.arctan2(t * np.sin(2 * chi), 1.0 - t * np.cos(2 * chi))


@njit(cache=True, nogil=True, fastmath=True)
def _try_step(parent, lanes, tables, step, state, slopes, here, trial, a, b):  # type: ignore[no-untyped-def]
    wide = len(state)
    for m in range(12):
        here[:] = state
        for p in range(m):
            weight = step * a[m, p]
            if weight != 0.0:
                row = slopes[p]
                for q in range(wide):
                    here[q] += weight * row[q]
        _slope(parent, lanes, tables, m, here, slopes[m])
    trial[:] = state
    for m in range(12):
        weight = step * b[m]
        if weight != 0.0:
            row = slopes[m]
            for q in range(wide):
                trial[q] += weight * row[q]


@njit(cache=True, nogil=True, fastmath=True)
def _slope(parent, lanes, tables, m, x, out):  # type: ignore[no-untyped-def]
    n = len(parent)
    columns, half = 2 * n, n * 2 * n * LANES
    torque = np.empty(LANES)
    for i in range(n):
        damping, stiffness = tables.extra_damping[m, i], tables.extra_stiffness[m, i]
        for col in range(columns):
            at = (i * columns + col) * LANES
            for lane in range(LANES):
                nu = lanes.frequency[lane]
                out[at + lane] = nu * x[half + at + lane]
                out[half + at + lane] = -(
                    damping[lane] * x[half + at + lane] + stiffness[lane] / nu * x[at + lane]
                )
    for i in range(n):
        p = parent[i]
        kappa, d = lanes.stiffness[i], lanes.damping[i]
        e, f = tables.near[m, i], tables.near_slope[m, i]
        for col in range(columns):
            at = (i * columns + col) * LANES
            up = (p * columns + col) * LANES
            if p < 0:
                for lane in range(LANES):
                    nu = lanes.frequency[lane]
                    out[half + at + lane] -= kappa[lane] / nu * x[at + lane] + d[lane] * x[half + at + lane]
            else:
                for lane in range(LANES):
                    nu = lanes.frequency[lane]
                    torque[lane] = kappa[lane] / nu * (x[at + lane] - e[lane] * x[up + lane]) + d[lane] * (
                        x[half + at + lane] - e[lane] * x[half + up + lane] - f[lane] / nu * x[up + lane]
                    )
                    out[half + at + lane] -= torque[lane]
                    out[half + up + lane] += e[lane] * torque[lane]
    for i in range(n):
        over = tables.over_mass[m, i]
        for col in range(columns):
            at = half + (i * columns + col) * LANES
            for lane in range(LANES):
                out[at + lane] *= over[lane]


@njit(cache=True, nogil=True, fastmath=True)
def _estimate(slopes, step, e3, e5, local, entries):  # type: ignore[no-untyped-def]
    """Local error per lane (Frobenius norm over Z's entries), as in DOP853."""
    for lane in range(LANES):
        local[lane] = 0.0
    high, low = np.zeros(LANES), np.zeros(LANES)
    five, three = np.empty(LANES), np.empty(LANES)
    for q in range(entries):
        for lane in range(LANES):
            five[lane] = 0.0
            three[lane] = 0.0
        for m in range(12):
            if e5[m] != 0.0 or e3[m] != 0.0:
                for lane in range(LANES):
                    k = slopes[m, q * LANES + lane]
                    five[lane] += e5[m] * k
                    three[lane] += e3[m] * k
        for lane in range(LANES):
            high[lane] += five[lane] * five[lane]
            low[lane] += three[lane] * three[lane]
    for lane in range(LANES):
        local[lane] = step * high[lane] / np.sqrt(high[lane] + 0.01 * low[lane] + 1e-300)


@njit(cache=True, nogil=True)
def _accumulate_trace(parent, lanes, tables, step, b, trace):  # type: ignore[no-untyped-def]
    for m in range(12):
        for i in range(len(parent)):
            for lane in range(LANES):
                own = lanes.damping[i, lane] + tables.extra_damping[m, i, lane]
                trace[lane] += step * b[m] * own * tables.over_mass[m, i, lane]
                p = parent[i]
                if p >= 0:
                    e = tables.near[m, i, lane]
                    trace[lane] += step * b[m] * e * e * lanes.damping[i, lane] * tables.over_mass[m, p, lane]
