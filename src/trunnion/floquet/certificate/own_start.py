"""A periodic motion of a line over the angle of its input, found in floating point: where a proof begins.

The balance of harmonics over time is read off at even angles; Newton's steps on the waves of ``own_equations`` then
make it a solution to rounding, to the order in torque and tolerances that its waves have.
Nothing here proves anything.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from trunnion.arrays import Array, Complex
from trunnion.equations.aligned import rigid_rotation
from trunnion.floquet.certificate.own_equations import MotionEquations, MotionWaves, Rates, motion_of, residuals
from trunnion.floquet.certificate.waves import Wave
from trunnion.numerics import harmonics as fourier
from trunnion.steady.free.free_balance import SteadyStates

STEPS = 10
"""Newton's steps at most."""
MOST = 1e3
"""What may be left over the motion itself."""
NEAR = 1e-6
"""The same of the middle's motion, about which slopes are taken."""
CLOSED = 1e-13
"""What is left over the motion itself at which it is enough."""
ROUGHLY = 1e-6
"""At which it is a motion at all."""
ENOUGH = 0.25
"""The same over what the waves leave out, which no step mends."""
TURNS = 30
"""Steps in which an angle is inverted."""


@dataclass(frozen=True)
class Slowness:
    """Mean of 1/w₀ over a turn, asked for: [s/rad] (rows,)."""

    asked: Array

    @property
    def middle(self) -> Slowness:
        """That of the middle alone."""
        return Slowness(self.asked[:1])


def begun(own: MotionEquations, motions: SteadyStates) -> MotionWaves:
    """The first of ``motions`` over the angle of its input."""
    topo, last, speed = own.assembly.topology, own.last, float(motions.speed[0])
    times = 4 * last + 4
    turn = 2 * np.pi / own.rate
    angle = turn * np.arange(times) / times
    rows = fourier.resized(motions.rows[0], max(motions.h, last))
    twists = fourier.rows_of(motions.twists[0].T, motions.h)
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
    parts = np.zeros((own.size, own.rows, 2 * last + 1), dtype=complex)
    parts[:, 0] = kept
    drive = np.zeros(own.rows)
    drive[0] = float(motions.torque[0]) if topo.free else 0.0
    return motion_of(own, list(parts), drive)


def _waves(angle: Array, h: int) -> Array:
    """Values of a mean, cosines and sines (time, 2h + 1)."""
    order = np.arange(1, h + 1)
    turned = np.outer(angle, order)
    return np.concatenate([np.ones((len(angle), 1)), np.cos(turned), np.sin(turned)], axis=1)


def solved(own: MotionEquations, motion: MotionWaves, slowness: Slowness | None) -> MotionWaves | None:
    """The motion near ``motion``, of a free–free line at the ``slowness`` asked for; None where there is none.

    The middle's motion is found first, then order by order what parameters add, with the slopes of the middle.
    """
    middle, asked = own.middle, None if slowness is None else slowness.middle
    begins = motion.each(lambda one: one.middle)
    for _ in range(STEPS):
        found = middle.rates(begins)
        slopes = _Slopes.of(middle, begins, found, free=slowness is not None)
        left = residuals(middle, begins, found)
        missing = _missing(middle, begins, left, asked)
        if not missing < MOST:
            return None
        if missing < NEAR:
            break
        begins = slopes.stepped(middle, begins, left, asked)
    motion = _put(motion, [0], begins)
    for terms in (*own.ladder[:-1], *own.ladder[-2:-1]):  # the last but one twice: a step takes a tenth of what is left
        lower, rows = own.cut(terms), own.terms.rows(terms)
        asked = None if slowness is None else Slowness(slowness.asked[rows])
        there = motion.cut(terms)
        left = residuals(lower, there, lower.rates(there, slopes=False))
        if not _missing(lower, there, left, asked) < MOST:
            return None
        motion = _put(motion, rows, slopes.stepped(lower, there, left, asked))
    return _settled(own, motion, slopes, slowness)


def _settled(
    own: MotionEquations, motion: MotionWaves, slopes: _Slopes, slowness: Slowness | None
) -> MotionWaves | None:
    """The motion to the order of its waves; None where there is none."""
    best = missing = np.inf
    for _ in range(STEPS):
        left = residuals(own, motion, own.rates(motion, slopes=False))
        missing = _missing(own, motion, left, slowness)
        if not missing < MOST:
            return None
        cut_off = np.array([one.rest for one in left])
        sizes = np.array([float(np.abs(one.parts).sum()) for one in left])
        if missing < CLOSED or (missing < 1e-9 and missing > 0.3 * best):
            break
        if missing < ROUGHLY and np.all(sizes < ENOUGH * cut_off):
            break
        best = missing
        motion = slopes.stepped(own, motion, left, slowness)
    return motion if missing < ROUGHLY else None


def _put(motion: MotionWaves, rows: list[int], other: MotionWaves) -> MotionWaves:
    """With these rows of another."""
    made = []
    for one, two in zip((*motion.states, motion.drive), (*other.states, other.drive), strict=True):
        parts = one.parts.copy()
        parts[rows] = two.parts
        made.append(Wave(parts, 0.0, one.terms))
    many = len(motion.twist)
    return MotionWaves(tuple(made[:many]), tuple(made[many:-1]), made[-1])


def _missing(own: MotionEquations, motion: MotionWaves, left: list[Wave], slowness: Slowness | None) -> float:
    """What is ``left`` by what is kept, over the motion itself."""
    beside = np.append(np.abs(own.twisted), np.zeros(len(motion.speed)))  # what twists count from
    size = np.array([float(np.abs(one.parts).sum()) for one in motion.states])
    size = np.maximum(size + beside, 1e-9)
    missing = float((np.array([float(np.abs(one.parts).sum()) for one in left]) / size).max())
    if slowness is not None:
        off = slowness.asked - own.input_speed(motion).inverse().parts[:, own.last]
        missing = max(missing, float(np.abs(off).max() / slowness.asked[0]))
    return missing


@dataclass(frozen=True)
class _Slopes:
    """Of what is left, by harmonics of the states and where free the torque that drives, decomposed; ``scale`` of that
    torque, and ``row`` of the slowness."""

    factors: tuple[Complex, Array]
    scale: float = 1.0
    row: float = 1.0

    @classmethod
    def of(cls, own: MotionEquations, motion: MotionWaves, found: Rates, *, free: bool) -> _Slopes:
        """Along ``motion``."""
        size, wide = own.size, 2 * own.last + 1
        many = size * wide
        matrix = np.zeros((many + free, many + free), dtype=complex)
        order = 1j * own.rate * np.arange(-own.last, own.last + 1)
        blocks = matrix[:many, :many].reshape(size, wide, size, wide)
        for (i, j), one in found.slopes.items():
            blocks[i, :, j, :] -= _toeplitz(one.parts[0])
        for i in range(size):
            blocks[i, np.arange(wide), i, np.arange(wide)] += order
        if not free:
            return cls(scipy.linalg.lu_factor(matrix))
        over = own.input_speed(motion).inverse()
        place = own.assembly.topology.coordinate[own.assembly.topology.group_of(0)] + len(motion.twist)
        matrix[-1, place * wide : (place + 1) * wide] = -(over * over).parts[0][::-1]
        matrix[:-1, -1] = -np.array([one.parts[0] for one in found.by_drive]).ravel()
        scale, row = float(np.abs(matrix[:-1, -1]).max()), float(np.abs(matrix[-1]).max())
        matrix[:, -1] /= scale
        matrix[-1] /= row
        return cls(scipy.linalg.lu_factor(matrix), scale, row)

    def stepped(
        self, own: MotionEquations, motion: MotionWaves, left: list[Wave], slowness: Slowness | None
    ) -> MotionWaves:
        """One of Newton's steps with these slopes, for all rows."""
        size, wide = own.size, 2 * own.last + 1
        right = np.zeros((size * wide + (slowness is not None), own.rows), dtype=complex)
        right[: size * wide] = np.array([one.parts for one in left]).transpose(0, 2, 1).reshape(size * wide, -1)
        if slowness is not None:
            right[-1] = (slowness.asked - own.input_speed(motion).inverse().parts[:, own.last]) / self.row
        step = scipy.linalg.lu_solve(self.factors, right)
        states = step[: size * wide].reshape(size, wide, -1).transpose(0, 2, 1)
        parts = [one.parts + more for one, more in zip(motion.states, states, strict=True)]
        parts = [(one + one[:, ::-1].conj()) / 2 for one in parts]
        drive = motion.drive.parts[:, own.last].real.copy()
        if slowness is not None:
            drive += step[-1].real / self.scale
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
