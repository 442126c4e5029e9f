"""A periodic motion of a line over the angle of its input, found in floating point: where a proof begins.

The balance of harmonics over time is read off at even angles; Newton's steps on the waves of ``own_equations`` then
make it a solution to rounding, to first order in tolerances, and in the torque to the order that its waves have.
Nothing here proves anything.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.equations.aligned import rigid_rotation
from trunnion.floquet.certificate.own_equations import MotionEquations, MotionWaves, Rates, motion_of, residuals
from trunnion.numerics import harmonics as fourier
from trunnion.steady.free.free_balance import SteadyStates

STEPS = 8
"""Newton's steps at most."""
CLOSED = 1e-13
"""What is left over the motion itself at which it is enough."""
ENOUGH = 0.01
"""The same over what the waves leave out, which no step mends."""
TURNS = 30
"""Steps in which an angle is inverted."""


@dataclass(frozen=True)
class Slowness:
    """Mean of 1/w₀ over a turn, asked for: [s/rad] (1 + parameters,)."""

    asked: Array


def begun(own: MotionEquations, motions: SteadyStates) -> MotionWaves:
    """The first of ``motions`` over the angle of its input."""
    topo, last, speed = own.assembly.topology, own.last, float(motions.speed[0])
    times = 4 * last + 4
    turn = 2 * np.pi / own.rate
    angle = turn * np.arange(times) / times
    rows = fourier.resized(motions.rows[0], max(motions.h, last))
    twists = fourier.rows_of(motions.observed().twist[0].T, motions.h)
    twists[:, 0] -= own.twisted
    rates = fourier.rate(rows, 1.0) * float(motions.rate[0])
    place = topo.coordinate[topo.group_of(0)] if topo.free else -1
    tau = angle.copy()
    if place >= 0:
        for _ in range(TURNS):
            waves = _waves(own.rate * tau, fourier.order(rows))
            off = tau + waves @ rows[place] - angle
            tau = tau - off / (1 + waves @ rates[place] / speed)
    waves = _waves(own.rate * tau, fourier.order(rows))
    speeds = speed * rigid_rotation(topo) + waves @ rates.T
    twist = _waves(own.rate * tau, motions.h) @ twists.T
    samples = np.concatenate([twist, speeds], axis=1)
    spectrum = np.fft.fft(samples, axis=0) / times
    kept = np.concatenate([spectrum[times - last :], spectrum[: last + 1]]).T
    parts = np.zeros((own.size, 1 + own.parameters, 2 * last + 1), dtype=complex)
    parts[:, 0] = kept
    drive = np.zeros(1 + own.parameters)
    drive[0] = float(motions.torque[0]) if topo.free else 0.0
    return motion_of(own, list(parts), drive)


def _waves(angle: Array, h: int) -> Array:
    """Values of a mean, cosines and sines (time, 2h + 1)."""
    order = np.arange(1, h + 1)
    turned = np.outer(angle, order)
    return np.concatenate([np.ones((len(angle), 1)), np.cos(turned), np.sin(turned)], axis=1)


def solved(own: MotionEquations, motion: MotionWaves, slowness: Slowness | None) -> MotionWaves | None:
    """The motion near ``motion``, of a free–free line at the ``slowness`` asked for; None where there is none."""
    found, best = own.rates(motion), np.inf
    beside = np.append(np.abs(own.twisted), np.zeros(len(motion.speed)))  # what twists count from
    for _ in range(STEPS):
        missed = residuals(own, motion, found)
        left, cut_off = np.array([one.parts for one in missed]), np.array([one.rest for one in missed])
        size = np.array([float(np.abs(one.parts).sum()) for one in motion.states])
        size = np.maximum(size + beside, 1e-9)
        missing = float((np.abs(left).sum(axis=(1, 2)) / size).max())
        if slowness is not None:
            off = slowness.asked - own.input_speed(motion).inverse().parts[:, own.last]
            missing = max(missing, float(np.abs(off).max() / slowness.asked[0]))
        if not np.isfinite(missing) or missing > 1e3:
            return None
        if missing < CLOSED or (missing < 1e-9 and missing > 0.3 * best):
            break
        if missing < 1e-6 and np.all(np.abs(left).sum(axis=(1, 2)) < ENOUGH * cut_off):
            break
        best = missing
        motion = _stepped(own, motion, found, left, slowness)
        found = own.rates(motion)
    return motion if missing < 1e-6 else None


def _stepped(
    own: MotionEquations, motion: MotionWaves, found: Rates, left: Complex, slowness: Slowness | None
) -> MotionWaves:
    size, wide = own.size, 2 * own.last + 1
    border = 0 if slowness is None else 1
    matrix = np.zeros((size * wide + border, size * wide + border), dtype=complex)
    order = 1j * own.rate * np.arange(-own.last, own.last + 1)
    blocks = matrix[: size * wide, : size * wide].reshape(size, wide, size, wide)
    for (i, j), one in found.slopes.items():
        blocks[i, :, j, :] -= _toeplitz(one.parts[0])
    for i in range(size):
        blocks[i, np.arange(wide), i, np.arange(wide)] += order
    right = np.zeros((size * wide + border, 1 + own.parameters), dtype=complex)
    right[: size * wide] = left.transpose(0, 2, 1).reshape(size * wide, -1)
    if slowness is not None:
        over = own.input_speed(motion).inverse()
        place = own.assembly.topology.coordinate[own.assembly.topology.group_of(0)] + len(motion.twist)
        square = (over * over).parts[0]
        matrix[-1, place * wide : (place + 1) * wide] = -square[::-1]
        matrix[:-1, -1] = -np.array([one.parts[0] for one in found.by_drive]).ravel()
        right[-1] = slowness.asked - over.parts[:, own.last]
        scale = np.abs(matrix[:-1, -1]).max()
        row = np.abs(matrix[-1]).max()
        matrix[:, -1] /= scale
        matrix[-1] /= row
        right[-1] /= row
    step = np.linalg.solve(matrix, right)
    states = step[: size * wide].reshape(size, wide, -1).transpose(0, 2, 1)
    parts = [one.parts + more for one, more in zip(motion.states, states, strict=True)]
    parts = [(one + one[:, ::-1].conj()) / 2 for one in parts]
    drive = motion.drive.parts[:, own.last].real.copy()
    if slowness is not None:
        drive += step[-1].real / scale
    return motion_of(own, parts, drive)


def _toeplitz(parts: Complex) -> Complex:
    """Products with a wave, by harmonics."""
    last = len(parts) // 2
    wide = len(parts)
    apart = np.arange(wide)[:, None] - np.arange(wide)[None, :]
    found = np.zeros((wide, wide), dtype=complex)
    inside = np.abs(apart) <= last
    found[inside] = parts[apart[inside] + last]
    return found
