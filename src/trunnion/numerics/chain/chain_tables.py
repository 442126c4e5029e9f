"""Time-dependent coefficients of jointed chains, for sixteen lanes at a time.

Joints have one of two forms: a cross, or a row of harmonics (see ``laws``). Of crosses, one sine and cosine per
time serve all lanes and joints: with C = cos 2χ, S = sin 2χ at a joint's input and D = 1 − sin²β (1 + C)/2, its
output has

    η = cos β / D,   cos 2ψ = (cos²β (1 + C) − (1 − C)) / 2D,   sin 2ψ = cos β S / D,

and fork phases turn (C, S) by a constant. Only a ratio other than ±1 between two joints needs ψ itself.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.numerics.batch import BATCH
from trunnion.numerics.jit import njit


class ChainProgram(NamedTuple):
    """What all lanes share: who hangs on whom, and which joint's law acts where. Sources are −1 for "none".

    parent (n,): parent unknown, a smaller one, or −1 at a prescribed or missing root.
    joint_speed_source, joint_rate (joints,): the joint whose output drives this one (−1: the input itself),
        and the speed ratio in between.
    joint_ratio_source, joint_ratio (joints,): the same within the joint's group, for r = da/da_ref.
    near_source, near_ratio (n,): r of the near end of unknown i's shaft, within the parent's group.
    near_speed_source, near_speed (n,): joint and factor giving the speed of the parent group's reference.
    member_unknown, member_source, member_ratio (members,): inertias of groups that contain joints.
    member_speed_source, member_speed (members,): speed of that group's reference.
    wave_unknown, wave_cycles (waves,): harmonics of the stiffness in front of an unknown, in cycles per turn.
    ripple_first (joints + 1,): joint j has the harmonics ripple_first[j] … ripple_first[j + 1] − 1, and the law
        ψ = χ + Σ A sin(mχ + φ) where that is any; ripple_order m and ripple_cycles (ripples,): cycles per turn of the
        joint and of the input.
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
    wave_unknown: Integers
    wave_cycles: Array
    ripple_first: Integers
    ripple_order: Array
    ripple_cycles: Array


class ChainBatch(NamedTuple):
    """Numbers per lane, lanes last; unknowns are scaled by √J and time is the input angle.

    cosine, phase (joints, lanes): cos β, and the constant part of χ since the source [rad].
    stiffness κ = k/(JΩ²), damping d = c/(JΩ), scale √(J_i/J_parent), torque T̄/(J_parent Ω²): (n, lanes).
    member_inertia J/J_i, member_load M₀/(J_i Ω²), member_viscous c₁/(J_i Ω) and member_quadratic c₂/J_i of the outer
        torque M₀ + c₁v + c₂v|v|: (members, lanes).
    wave_share, wave_phase (waves, lanes): amplitude over the mean stiffness, and its phase [rad].
    ripple, ripple_phase (ripples, lanes): A and φ of harmonics of joints [rad]; cos β of such a joint is 1.
    frequency ν (lanes,): unit of the rates.
    """

    cosine: Array
    phase: Array
    stiffness: Array
    damping: Array
    scale: Array
    torque: Array
    member_inertia: Array
    member_load: Array
    member_viscous: Array
    member_quadratic: Array
    wave_share: Array
    wave_phase: Array
    ripple: Array
    ripple_phase: Array
    frequency: Array


# A block of lanes lives in three flat arrays, each a stack of rows of LANES numbers: per joint (constant rows,
# then the moving rows of every stage), per unknown, and a table of rows per unknown and stage. One base address
# and constant offsets are what lets the compiler vectorise, and all stages of a step are filled in one call:
# separate arrays, or slices taken per stage, cost a factor of 3 to 15 (measured).
STAGES = 12
COSINE, TURN_COS, TURN_SIN, PHASE = 0, 1, 2, 3
MOVING = 4
COS2, SIN2, SPEED, ACCELERATION, RATIO, RATIO1, RATIO2, ANGLE = 0, 1, 2, 3, 4, 5, 6, 7
MOVING_ROWS = 8
STIFFNESS, DAMPING, NEAR_SCALE, SLOPE_SCALE, TORQUE, FREQUENCY = 0, 1, 2, 3, 4, 5
NEAR, NEAR_SLOPE, EXTRA_DAMPING, EXTRA_STIFFNESS, OVER_MASS, WAVE = 0, 1, 2, 3, 4, 5
TABLE_ROWS = 6
PER_STAGE, PER_JOINT = MOVING_ROWS * BATCH, (MOVING + MOVING_ROWS * STAGES) * BATCH
PER_UNKNOWN, PER_ROW = 6 * BATCH, TABLE_ROWS * BATCH
PER_TABLE = PER_ROW * STAGES


class Block(NamedTuple):
    """One block of lanes: flat rows (see above); κ, slopes and extra stiffness in units of ν.

    wave_cosine, wave_sine (waves, LANES): harmonics of the stiffness over its mean, c cos − s sin.
    ripple, ripple_phase (ripples, LANES): A and φ of harmonics of joints.
    ``alike``: all lanes have the same joint angles and phases, so one of them speaks for all.
    """

    joint: Array
    unknown: Array
    member_inertia: Array
    member_load: Array
    member_viscous: Array
    member_quadratic: Array
    wave_cosine: Array
    wave_sine: Array
    ripple: Array
    ripple_phase: Array
    alike: bool


@njit(nogil=True, inner=True)
def gather(program, batch, picked):  # type: ignore[no-untyped-def]
    """The lanes ``picked`` (LANES,) of the given ones as a block."""
    joints, n = batch.cosine.shape[0], len(program.parent)
    joint = np.zeros(max(1, joints) * PER_JOINT)
    unknown = np.zeros(n * PER_UNKNOWN)
    waves = len(program.wave_unknown)
    wave_cosine, wave_sine = np.zeros((waves, BATCH)), np.zeros((waves, BATCH))
    alike = len(program.ripple_order) == 0
    for lane in range(BATCH):
        at, first = picked[lane], picked[0]
        nu = batch.frequency[at]
        for j in range(joints):
            o = j * PER_JOINT + lane
            same = batch.cosine[j, at] == batch.cosine[j, first] and batch.phase[j, at] == batch.phase[j, first]
            alike = alike and same
            joint[o + COSINE * BATCH] = batch.cosine[j, at]
            joint[o + PHASE * BATCH] = batch.phase[j, at]
            if same and lane > 0:
                joint[o + TURN_COS * BATCH] = joint[o + TURN_COS * BATCH - lane]
                joint[o + TURN_SIN * BATCH] = joint[o + TURN_SIN * BATCH - lane]
            else:
                joint[o + TURN_COS * BATCH] = math.cos(2 * batch.phase[j, at])
                joint[o + TURN_SIN * BATCH] = math.sin(2 * batch.phase[j, at])
        for i in range(n):
            o = i * PER_UNKNOWN + lane
            scale = batch.scale[i, at] * program.near_ratio[i]
            unknown[o + STIFFNESS * BATCH] = batch.stiffness[i, at] / nu
            unknown[o + DAMPING * BATCH] = batch.damping[i, at]
            unknown[o + NEAR_SCALE * BATCH] = scale
            unknown[o + SLOPE_SCALE * BATCH] = scale * program.near_speed[i] / nu
            unknown[o + TORQUE * BATCH] = batch.torque[i, at] * program.near_ratio[i] / nu
            unknown[o + FREQUENCY * BATCH] = nu
        for k in range(waves):
            wave_cosine[k, lane] = batch.wave_share[k, at] * math.cos(batch.wave_phase[k, at])
            wave_sine[k, lane] = batch.wave_share[k, at] * math.sin(batch.wave_phase[k, at])
    return Block(
        joint, unknown,
        _picked(batch.member_inertia, picked), _picked(batch.member_load, picked),
        _picked(batch.member_viscous, picked), _picked(batch.member_quadratic, picked),
        wave_cosine, wave_sine, _picked(batch.ripple, picked), _picked(batch.ripple_phase, picked), alike,
    )  # fmt: skip


@njit(nogil=True, inner=True)
def _picked(rows, picked):  # type: ignore[no-untyped-def]
    """Rows of the lanes ``picked``."""
    out = np.empty((len(rows), BATCH))
    for k in range(len(rows)):
        for lane in range(BATCH):
            out[k, lane] = rows[k, picked[lane]]
    return out


@njit(nogil=True, inner=True)
def empty_table(program, block):  # type: ignore[no-untyped-def]
    """A table with everything filled in that does not depend on time."""
    n = len(program.parent)
    table = np.zeros(n * PER_TABLE)
    for i in range(n):
        for m in range(STAGES):
            o = i * PER_TABLE + m * PER_ROW
            for lane in range(BATCH):
                table[o + OVER_MASS * BATCH + lane] = 1.0
                table[o + WAVE * BATCH + lane] = 1.0
                if program.near_source[i] < 0:
                    table[o + NEAR * BATCH + lane] = block.unknown[i * PER_UNKNOWN + NEAR_SCALE * BATCH + lane]
    return table


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def fill(program, block, begin, step, nodes, table):  # type: ignore[no-untyped-def]
    """Coefficients at input angles ``begin + nodes · step`` into the stages of ``table``."""
    w, unknown, parent, count = block.joint, block.unknown, program.parent, len(nodes)
    speed_source, rates = program.joint_speed_source, program.joint_rate
    ratio_source, ratios = program.joint_ratio_source, program.joint_ratio
    near_source, near_speed_source = program.near_source, program.near_speed_source
    curved = len(program.member_unknown) > 0
    used = 1 if block.alike and not curved else BATCH
    unwrapped = len(program.ripple_order) > 0
    for j in range(len(rates)):
        unwrapped = unwrapped or (speed_source[j] >= 0 and abs(rates[j]) != 1.0)
    for j in range(len(rates)):
        own = w[j * PER_JOINT : (j + 1) * PER_JOINT]
        driven = speed_source[j] < 0
        source, within = max(speed_source[j], 0) * PER_JOINT, max(ratio_source[j], 0) * PER_JOINT
        before = w[source : source + PER_JOINT]
        if driven:
            _input_from_drive(own, used, begin, step, nodes, rates[j])
        else:
            _input_from_joint(own, before, used, count, rates[j])
        if unwrapped:
            _unwrap(own, before, used, begin, step, nodes, driven, rates[j])
        _ratio_in_front(own, w[within : within + PER_JOINT], used, count, ratio_source[j] < 0, ratios[j])
        first, last = program.ripple_first[j], program.ripple_first[j + 1]
        if last > first:
            _pass_ripple(own, before, begin, step, nodes, driven, rates[j], program, block, first, last)
        else:
            _pass_joint(own, used, count)
    for i in range(len(parent)):
        for m in range(count):
            for lane in range(BATCH):
                table[i * PER_TABLE + m * PER_ROW + EXTRA_STIFFNESS * BATCH + lane] = 0.0
    if len(program.wave_unknown) > 0:
        _waves(program, block, begin, step, nodes, table)
    for i in range(len(parent)):
        if near_source[i] >= 0 and parent[i] >= 0:
            shaft = unknown[i * PER_UNKNOWN : (i + 1) * PER_UNKNOWN]
            joint = w[near_source[i] * PER_JOINT : (near_source[i] + 1) * PER_JOINT]
            driven = near_speed_source[i] < 0
            driver = joint if driven else w[near_speed_source[i] * PER_JOINT : (near_speed_source[i] + 1) * PER_JOINT]
            rows = table[i * PER_TABLE : (i + 1) * PER_TABLE]
            above = table[parent[i] * PER_TABLE : (parent[i] + 1) * PER_TABLE]
            _shaft_behind_joint(joint, driver, driven, shaft, used == 1, count, rows, above)
    if curved:
        _members(program, block, count, table)


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _input_from_drive(own, used, begin, step, nodes, rate):  # type: ignore[no-untyped-def]
    """cos 2χ, sin 2χ, speed and acceleration at a joint's input, left where its output will stand."""
    for m in range(len(nodes)):
        angle = 2 * rate * (begin + nodes[m] * step)
        c, s = math.cos(angle), math.sin(angle)
        o = MOVING * BATCH + m * PER_STAGE
        for lane in range(used):
            turn_c, turn_s = own[TURN_COS * BATCH + lane], own[TURN_SIN * BATCH + lane]
            own[o + COS2 * BATCH + lane] = c * turn_c - s * turn_s
            own[o + SIN2 * BATCH + lane] = s * turn_c + c * turn_s
            own[o + SPEED * BATCH + lane] = rate
            own[o + ACCELERATION * BATCH + lane] = 0.0


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _input_from_joint(own, before, used, count, rate):  # type: ignore[no-untyped-def]
    for m in range(count):
        o = MOVING * BATCH + m * PER_STAGE
        if rate == 1.0 or rate == -1.0:
            for lane in range(used):
                turn_c, turn_s = own[TURN_COS * BATCH + lane], own[TURN_SIN * BATCH + lane]
                c, s = before[o + COS2 * BATCH + lane], rate * before[o + SIN2 * BATCH + lane]
                own[o + COS2 * BATCH + lane] = c * turn_c - s * turn_s
                own[o + SIN2 * BATCH + lane] = s * turn_c + c * turn_s
        else:
            # Behind such a ratio multiples of 2ψ do not suffice; ψ itself was kept.
            for lane in range(used):
                chi2 = 2 * (rate * before[o + ANGLE * BATCH + lane] + own[PHASE * BATCH + lane])
                own[o + COS2 * BATCH + lane] = math.cos(chi2)
                own[o + SIN2 * BATCH + lane] = math.sin(chi2)
        for lane in range(used):
            own[o + SPEED * BATCH + lane] = rate * before[o + SPEED * BATCH + lane]
            own[o + ACCELERATION * BATCH + lane] = rate * before[o + ACCELERATION * BATCH + lane]


@njit(nogil=True, inner=True)
def _unwrap(own, before, used, begin, step, nodes, driven, rate):  # type: ignore[no-untyped-def]
    """ψ, continuous over the period."""
    for m in range(len(nodes)):
        o = MOVING * BATCH + m * PER_STAGE
        for lane in range(used):
            angle = begin + nodes[m] * step if driven else before[o + ANGLE * BATCH + lane]
            chi = rate * angle + own[PHASE * BATCH + lane]
            cosine = own[COSINE * BATCH + lane]
            t = (1.0 - cosine) / (1.0 + cosine)
            own[o + ANGLE * BATCH + lane] = chi + math.atan2(t * math.sin(2 * chi), 1.0 - t * math.cos(2 * chi))


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _ratio_in_front(own, before, used, count, first, factor):  # type: ignore[no-untyped-def]
    """r and its derivatives in front of a joint: that of the joint before it in the group, if there is one."""
    for m in range(count):
        o = MOVING * BATCH + m * PER_STAGE
        for lane in range(used):
            r, r1, r2 = 1.0, 0.0, 0.0
            if not first:
                r, r1 = before[o + RATIO * BATCH + lane], before[o + RATIO1 * BATCH + lane]
                r2 = before[o + RATIO2 * BATCH + lane]
            own[o + RATIO * BATCH + lane] = factor * r
            own[o + RATIO1 * BATCH + lane] = factor * r1
            own[o + RATIO2 * BATCH + lane] = factor * r2


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _pass_joint(own, used, count):  # type: ignore[no-untyped-def]
    """A cross: from speed, acceleration and r in front of it to those behind, cos 2ψ and sin 2ψ."""
    for m in range(count):
        o = MOVING * BATCH + m * PER_STAGE
        for lane in range(used):
            cb, c, s = own[COSINE * BATCH + lane], own[o + COS2 * BATCH + lane], own[o + SIN2 * BATCH + lane]
            speed, r = own[o + SPEED * BATCH + lane], own[o + RATIO * BATCH + lane]
            acceleration, r1 = own[o + ACCELERATION * BATCH + lane], own[o + RATIO1 * BATCH + lane]
            cb2 = cb * cb
            sb2 = 1.0 - cb2
            over = 1.0 / (1.0 - 0.5 * sb2 * (1.0 + c))
            eta = cb * over
            slope = -eta * sb2 * s * over
            curvature = -2.0 * eta * sb2 * over * (c - sb2 * s * s * over)
            own[o + RATIO2 * BATCH + lane] = (
                eta * own[o + RATIO2 * BATCH + lane] + 3.0 * slope * r * r1 + curvature * r * r * r
            )
            own[o + ACCELERATION * BATCH + lane] = slope * speed * speed + eta * acceleration
            own[o + SPEED * BATCH + lane] = eta * speed
            own[o + RATIO1 * BATCH + lane] = eta * r1 + slope * r * r
            own[o + RATIO * BATCH + lane] = eta * r
            own[o + COS2 * BATCH + lane] = 0.5 * (cb2 * (1.0 + c) - (1.0 - c)) * over
            own[o + SIN2 * BATCH + lane] = eta * s


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _pass_ripple(own, before, begin, step, nodes, driven, rate, program, block, first, last):  # type: ignore[no-untyped-def]
    """A joint with harmonics: from speed, acceleration and r in front of it to those behind, and its ψ."""
    for m in range(len(nodes)):
        o = MOVING * BATCH + m * PER_STAGE
        for lane in range(BATCH):
            angle = begin + nodes[m] * step if driven else before[o + ANGLE * BATCH + lane]
            chi = rate * angle + own[PHASE * BATCH + lane]
            psi, eta, slope, curvature = chi, 1.0, 0.0, 0.0
            for k in range(first, last):
                order, phase = program.ripple_order[k], block.ripple_phase[k, lane]
                c = block.ripple[k, lane] * math.cos(order * chi + phase)
                s = block.ripple[k, lane] * math.sin(order * chi + phase)
                psi, eta = psi + s, eta + order * c
                slope, curvature = slope - order * order * s, curvature - order * order * order * c
            speed, r = own[o + SPEED * BATCH + lane], own[o + RATIO * BATCH + lane]
            acceleration, r1 = own[o + ACCELERATION * BATCH + lane], own[o + RATIO1 * BATCH + lane]
            r2 = own[o + RATIO2 * BATCH + lane]
            own[o + ACCELERATION * BATCH + lane] = slope * speed * speed + eta * acceleration
            own[o + SPEED * BATCH + lane] = eta * speed
            own[o + RATIO2 * BATCH + lane] = eta * r2 + 3 * slope * r * r1 + curvature * r * r * r
            own[o + RATIO1 * BATCH + lane] = eta * r1 + slope * r * r
            own[o + RATIO * BATCH + lane] = eta * r
            own[o + COS2 * BATCH + lane] = math.cos(2 * psi)
            own[o + SIN2 * BATCH + lane] = math.sin(2 * psi)
            own[o + ANGLE * BATCH + lane] = psi


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _shaft_behind_joint(joint, driver, driven, shaft, alike, count, own, above):  # type: ignore[no-untyped-def]
    """Coupling of a shaft to its joint, and −r₁T̄ of its static torque on the unknown in front of the joint.

    driver: the joint whose speed the group's reference has, unless that is ``driven`` by the input itself.
    """
    for m in range(count):
        o, t = MOVING * BATCH + m * PER_STAGE, m * PER_ROW
        for lane in range(BATCH):
            from_lane = 0 if alike else lane
            r, r1 = joint[o + RATIO * BATCH + from_lane], joint[o + RATIO1 * BATCH + from_lane]
            speed = 1.0 if driven else driver[o + SPEED * BATCH + from_lane]
            own[t + NEAR * BATCH + lane] = shaft[NEAR_SCALE * BATCH + lane] * r
            own[t + NEAR_SLOPE * BATCH + lane] = shaft[SLOPE_SCALE * BATCH + lane] * r1 * speed
            torque = shaft[TORQUE * BATCH + lane] * own[t + WAVE * BATCH + lane]
            above[t + EXTRA_STIFFNESS * BATCH + lane] -= r1 * torque


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _members(program, block, count, table):  # type: ignore[no-untyped-def]
    """Inertia that depends on the angle and loads that depend on the speed, in groups that have such members."""
    w, owner = block.joint, program.member_unknown
    for m in range(count):
        for k in range(len(owner)):
            t = owner[k] * PER_TABLE + m * PER_ROW
            for lane in range(BATCH):
                table[t + OVER_MASS * BATCH + lane] = 0.0
                table[t + EXTRA_DAMPING * BATCH + lane] = 0.0
        for k in range(len(owner)):
            t, o = owner[k] * PER_TABLE + m * PER_ROW, MOVING * BATCH + m * PER_STAGE
            b, v = program.member_source[k] * PER_JOINT + o, program.member_speed_source[k] * PER_JOINT + o
            factor, mean = program.member_ratio[k], program.member_speed[k]
            for lane in range(BATCH):
                r, r1, r2, speed, acceleration = factor, 0.0, 0.0, mean, 0.0
                if program.member_source[k] >= 0:
                    r, r1 = factor * w[b + RATIO * BATCH + lane], factor * w[b + RATIO1 * BATCH + lane]
                    r2 = factor * w[b + RATIO2 * BATCH + lane]
                if program.member_speed_source[k] >= 0:
                    speed = mean * w[v + SPEED * BATCH + lane]
                    acceleration = mean * w[v + ACCELERATION * BATCH + lane]
                inertia, nu = block.member_inertia[k, lane], block.unknown[FREQUENCY * BATCH + lane]
                table[t + OVER_MASS * BATCH + lane] += inertia * r * r
                table[t + EXTRA_DAMPING * BATCH + lane] += 2 * inertia * r * r1 * speed
                curved = 2 * r * r1 * acceleration + (r1 * r1 + r * r2) * speed * speed
                turning, drag = r * speed, block.member_quadratic[k, lane]
                growth = block.member_viscous[k, lane] + 2 * drag * abs(turning)
                load = block.member_load[k, lane] + (growth - drag * abs(turning)) * turning
                table[t + EXTRA_DAMPING * BATCH + lane] += r * r * growth
                pull = inertia * curved + r1 * load + r * growth * r1 * speed
                table[t + EXTRA_STIFFNESS * BATCH + lane] += pull / nu
        done = -1
        for k in range(len(owner)):
            if owner[k] != done:
                t = owner[k] * PER_TABLE + m * PER_ROW
                for lane in range(BATCH):
                    table[t + OVER_MASS * BATCH + lane] = 1.0 / table[t + OVER_MASS * BATCH + lane]
            done = owner[k]


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _waves(program, block, begin, step, nodes, table):  # type: ignore[no-untyped-def]
    """Stiffness that varies over its mean: gear meshes."""
    for i in program.wave_unknown:
        for m in range(len(nodes)):
            for lane in range(BATCH):
                table[i * PER_TABLE + m * PER_ROW + WAVE * BATCH + lane] = 1.0
    for k in range(len(program.wave_unknown)):
        for m in range(len(nodes)):
            angle = program.wave_cycles[k] * (begin + nodes[m] * step)
            c, s = math.cos(angle), math.sin(angle)
            o = program.wave_unknown[k] * PER_TABLE + m * PER_ROW + WAVE * BATCH
            for lane in range(BATCH):
                table[o + lane] += c * block.wave_cosine[k, lane] - s * block.wave_sine[k, lane]


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def add_damping_trace(parent, unknown, table, weights, step, trace):  # type: ignore[no-untyped-def]
    """∫ tr(M⁻¹C) dτ over one step, by the weights of its stages, added to ``trace`` per lane."""
    for i in range(len(parent)):
        shaft = unknown[i * PER_UNKNOWN : (i + 1) * PER_UNKNOWN]
        rows = table[i * PER_TABLE : (i + 1) * PER_TABLE]
        above = table[max(parent[i], 0) * PER_TABLE : (max(parent[i], 0) + 1) * PER_TABLE]
        for m in range(STAGES):
            weight, t = step * weights[m], m * PER_ROW
            if weight == 0.0:
                continue
            for lane in range(BATCH):
                own = shaft[DAMPING * BATCH + lane] + rows[t + EXTRA_DAMPING * BATCH + lane]
                trace[lane] += weight * own * rows[t + OVER_MASS * BATCH + lane]
            if parent[i] >= 0:
                for lane in range(BATCH):
                    e, over = rows[t + NEAR * BATCH + lane], above[t + OVER_MASS * BATCH + lane]
                    trace[lane] += weight * e * e * shaft[DAMPING * BATCH + lane] * over
