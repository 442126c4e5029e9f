"""Taylor coefficients in time of the speed ratios of a chain's joints, for sixteen lanes at a time.

With θ the input angle since ``begin`` in units of ``unit`` and C = cos 2χ, S = sin 2χ at a joint's input,

    C′ = −2χ′S,   S′ = 2χ′C,   D = 1 − sin²β (1 + C)/2,   ηD = cos β,   ψ′ = ηχ′,

each of which gives the next coefficient from those before it by one product of series (Moore 1966). Only
the values at ``begin`` need a sine and a cosine. Where all lanes have the same joints, one of them speaks for all:
``like`` is then a number instead of a row (see ``rows``).
"""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
from __future__ import annotations

import math

import numpy as np

from trunnion.numerics.batch import BATCH
from trunnion.numerics.chain.chain_tables import COSINE, NEAR_SCALE, PER_JOINT, PER_UNKNOWN, PHASE, TURN_COS, TURN_SIN
from trunnion.numerics.jit import njit
from trunnion.numerics.rows import load, spread, store

ORDER = 16
"""Order of the series: a step is then some 1.6 rad of the fastest motion at 1e-10, and cost per radian is flat."""
ROWS = (ORDER + 1) * BATCH
COS_IN, SIN_IN, SPEED_IN, OWN_RATIO, GROUP_RATIO = 0, ROWS, 2 * ROWS, 3 * ROWS, 4 * ROWS
PER_SERIES = 5 * ROWS
COS_OUT, SIN_OUT, ANGLE_OUT = 0, BATCH, 2 * BATCH
PER_START = 3 * BATCH


@njit(nogil=True, inner=True)
def empty_series(program):
    """Room for the coefficients of all joints, and for what leaves each of them at ``begin``."""
    joints = max(1, len(program.joint_rate))
    return np.zeros(joints * PER_SERIES), np.zeros(joints * PER_START)


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def joint_series(program, block, used, begin, unit, series, start, like):
    """Fill ``series`` and ``start`` of all joints at the input angle ``begin``; ``like`` stands for ``used`` lanes."""
    wound = False
    for j in range(len(program.joint_rate)):
        wound = wound or (program.joint_speed_source[j] >= 0 and abs(program.joint_rate[j]) != 1.0)
    for j in range(len(program.joint_rate)):
        own, leaves, joint = j * PER_SERIES, j * PER_START, j * PER_JOINT
        source, rate = program.joint_speed_source[j], program.joint_rate[j]
        if source < 0:
            _begin_on_drive(block.joint, joint, used, begin, rate, series, own, start, leaves)
            _at_constant_speed(series, own, rate * unit, like)
        else:
            _begin_on_joint(block.joint, joint, start, source * PER_START, used, rate, series, own, leaves)
            before = source * PER_SERIES
            _product(series, before + OWN_RATIO, before + SPEED_IN, rate, own + SPEED_IN, like)
            _at_varying_speed(series, own, like)
        _ratio(block.joint, joint, series, own, like)
        _output(block.joint, joint, used, wound, series, own, start, leaves)
        group, factor = program.joint_ratio_source[j], program.joint_ratio[j]
        if group < 0:
            for at in range(own, own + ROWS, BATCH):
                store(series, at + GROUP_RATIO, factor * load(series, at + OWN_RATIO, like))
        else:
            above = group * PER_SERIES
            _product(series, own + OWN_RATIO, above + GROUP_RATIO, factor, own + GROUP_RATIO, like)


@njit(nogil=True, inner=True)
def couplings(program, block, used, bent, begin, unit, series, start, near, like):
    """Series ``near`` of e, the scaled speed ratio at the near end of every shaft behind a joint (``bent``)."""
    joint_series(program, block, used, begin, unit, series, start, like)
    for i in range(len(bent)):
        if bent[i]:
            factor = load(block.unknown, i * PER_UNKNOWN + NEAR_SCALE * BATCH, spread(0.0))
            ratio = program.near_source[i] * PER_SERIES + GROUP_RATIO
            for k in range(0, ROWS, BATCH):
                store(near, i * ROWS + k, factor * load(series, ratio + k, like))


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _begin_on_drive(block, joint, used, begin, rate, series, own, start, leaves):
    angle = 2 * rate * begin
    c, s = math.cos(angle), math.sin(angle)
    for lane in range(used):
        turn_c, turn_s = block[joint + TURN_COS * BATCH + lane], block[joint + TURN_SIN * BATCH + lane]
        series[own + COS_IN + lane] = c * turn_c - s * turn_s
        series[own + SIN_IN + lane] = s * turn_c + c * turn_s
        start[leaves + ANGLE_OUT + lane] = rate * begin + block[joint + PHASE * BATCH + lane]


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _begin_on_joint(block, joint, start, before, used, rate, series, own, leaves):
    for lane in range(used):
        chi = rate * start[before + ANGLE_OUT + lane] + block[joint + PHASE * BATCH + lane]
        start[leaves + ANGLE_OUT + lane] = chi
        if rate == 1.0 or rate == -1.0:
            turn_c, turn_s = block[joint + TURN_COS * BATCH + lane], block[joint + TURN_SIN * BATCH + lane]
            c, s = start[before + COS_OUT + lane], rate * start[before + SIN_OUT + lane]
            series[own + COS_IN + lane] = c * turn_c - s * turn_s
            series[own + SIN_IN + lane] = s * turn_c + c * turn_s
        else:
            # Behind such a ratio multiples of 2ψ do not suffice; ψ itself was kept.
            series[own + COS_IN + lane], series[own + SIN_IN + lane] = math.cos(2 * chi), math.sin(2 * chi)


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _output(block, joint, used, wound, series, own, start, leaves):
    """cos 2ψ and sin 2ψ behind the joint, and ψ itself where it is needed."""
    for lane in range(used):
        cb = block[joint + COSINE * BATCH + lane]
        c, s = series[own + COS_IN + lane], series[own + SIN_IN + lane]
        over = series[own + OWN_RATIO + lane] / cb
        start[leaves + COS_OUT + lane] = 0.5 * (cb * cb * (1.0 + c) - (1.0 - c)) * over
        start[leaves + SIN_OUT + lane] = cb * s * over
        if wound:
            t = (1.0 - cb) / (1.0 + cb)
            start[leaves + ANGLE_OUT + lane] += math.atan2(t * s, 1.0 - t * c)


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _at_constant_speed(w, own, speed, like):
    store(w, own + SPEED_IN, like + speed)
    c, s = load(w, own + COS_IN, like), load(w, own + SIN_IN, like)
    for k in range(1, ORDER + 1):
        turned = 2.0 * speed / k
        c, s = -turned * s, turned * c
        store(w, own + COS_IN + k * BATCH, c)
        store(w, own + SIN_IN + k * BATCH, s)
        store(w, own + SPEED_IN + k * BATCH, like)


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _at_varying_speed(w, own, like):
    """Cosine and sine from the speed, whose own series stands already."""
    for k in range(ORDER):
        c, s = like, like
        for m in range(k + 1):
            speed = load(w, own + SPEED_IN + (k - m) * BATCH, like)
            c = c + speed * load(w, own + SIN_IN + m * BATCH, like)
            s = s + speed * load(w, own + COS_IN + m * BATCH, like)
        factor = 2.0 / (k + 1)
        store(w, own + COS_IN + (k + 1) * BATCH, -factor * c)
        store(w, own + SIN_IN + (k + 1) * BATCH, factor * s)


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _ratio(block, joint, w, own, like):
    """η from ηD = cos β, where D_k = −½ sin²β C_k from the first order on."""
    cb = load(block, joint + COSINE * BATCH, like)
    bend = 0.5 * (1.0 - cb * cb)
    eta = cb / (1.0 - bend * (1.0 + load(w, own + COS_IN, like)))
    factor = bend / cb * eta
    store(w, own + OWN_RATIO, eta)
    for k in range(1, ORDER + 1):
        total, other = load(w, own + COS_IN + k * BATCH, like) * eta, like
        for m in range(1, k - 1, 2):
            at, of = own + COS_IN + m * BATCH, own + OWN_RATIO + (k - m) * BATCH
            total = total + load(w, at, like) * load(w, of, like)
            other = other + load(w, at + BATCH, like) * load(w, of - BATCH, like)
        if k % 2 == 0:
            at, of = own + COS_IN + (k - 1) * BATCH, own + OWN_RATIO + BATCH
            other = other + load(w, at, like) * load(w, of, like)
        store(w, own + OWN_RATIO + k * BATCH, factor * (total + other))


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _product(w, a, b, factor, out, like):
    """The series at ``out``: ``factor`` times the product of those at ``a`` and ``b``."""
    for k in range(ORDER + 1):
        total = like
        for m in range(k + 1):
            total = total + load(w, a + m * BATCH, like) * load(w, b + (k - m) * BATCH, like)
        store(w, out + k * BATCH, factor * total)
