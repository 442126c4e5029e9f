"""The periodic motion of a free–free line with joint angles, and its multipliers, by integration of the equations of
motion.

    J_i ä_i = −M_i + Σ_near r f − Σ_far f,   f = k x + c ẋ,   x = a_f − n_e(a_n) − fork

as of ``line_equations``, nothing linearised and no harmonics: steps of a Runge-Kutta method of order 8, and derivatives
by the start, the driving torque and the speed from its imaginary parts (complex steps, exact to rounding). Newton's
steps close a(T) = a(0) + RΩT, ȧ(T) = ȧ(0) with the first mass held at its angle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate._ivp import dop853_coefficients as coefficients

from oracles.free_orbits import kept, moved
from oracles.line_equations import Steady

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
STAGES, WEIGHTS = coefficients.A[:12, :12], coefficients.B
IMAGINARY = 1e-30
PER_CYCLE, ROUGHLY, LEAST = 30, 14, 64
"""Steps per cycle of what swings fastest, as few to follow a motion only, and per period."""
NEWTON, ENOUGH, CLOSED = 30, 1e-8, 1e-8
CLOSELY = 64
"""Samples of a joint's cycle of the motions by collocation that one begins with."""
LARGEST = 0.3
"""Largest correction [rad] of one of Newton's steps."""
WALK, LEAST_STEP, LEAP = 4, 1e-2, 0.05
"""Steps at least between two speeds, their least length as a share of the way, and by how much [rad] a motion may
change in one."""
ASIDE = 0.0, 0.003, 0.01, 0.03, 0.1
"""Shares of a speed by which one begins aside where a motion is not found at once."""
SAME = 1e-4
"""Share by which the driving torques of two motions that are the same may differ."""


@dataclass(frozen=True)
class Shot:
    """Motions at ``speed`` (case,): found (case,); start (case, 2n); extra (case,) [N m] that the first mass drives
    with beyond the balance; matrix (case, 2n, 2n): of a disturbance over a period, rates over the speed; shift (case,
    2n): the one that shifts the phase; rise (case,): of the driving torque by the speed [N m s]; mean_torque (case,
    spring)."""

    speed: Array
    found: NDArray[np.bool_]
    start: Array
    extra: Array
    matrix: Array
    shift: Array
    rise: Array
    mean_torque: Array

    @property
    def multipliers(self) -> Complex:
        """Without that of a shift of the phase, which is 1 (case, 2n − 1)."""
        rest = np.linalg.qr(self.shift[:, :, None], mode="complete")[0][:, :, 1:]
        return np.linalg.eigvals(rest.transpose(0, 2, 1) @ self.matrix @ rest).astype(complex)


class Shooting:
    """One line that moves by itself."""

    def __init__(self, steady: Steady, per_cycle: int = PER_CYCLE) -> None:
        self.steady, self.n, self.per_cycle = steady, steady.n, per_cycle
        masses = steady.line.masses
        self.k, self.c, _ = steady.springs()
        self.inertia, self.viscous, self.quadratic = (
            np.array([getattr(m, key) for m in masses])[:, None] for key in ("inertia", "viscous", "quadratic")
        )
        self.turn = 2 * np.pi / float(steady.step)
        """Turn [rad] of the input in a period."""
        self.fastest = float(np.sqrt(2 * self.k.max() / self.inertia.min()))

    def motions(self, speed: Array, start: Array | None = None, extra: Array | None = None) -> Shot:
        """At every ``speed`` (case,) [rad/s], from motions known nearby, or else from those by collocation where these
        are found from rigid shafts, or from rigid shafts."""
        if start is None:
            line, turned = Steady(self.steady.line, CLOSELY), 2 * np.pi / float(self.steady.step)
            turned = turned * np.arange(line.samples) / line.samples
            kept(line, speed, turned)
            begin = [
                moved(line, np.array([one]), turned, line.orbits[one][None])
                if one in line.orbits
                else line.rigid(np.array([one]), turned)
                for one in speed.tolist()
            ]
            start = np.array([np.concatenate([one.angle[0, 0], one.rate[0, 0]]) for one in begin])
        x, torque = start.copy(), np.zeros(len(speed)) if extra is None else extra.copy()
        n, cases = self.n, len(speed)
        unit = np.concatenate([np.ones((cases, n)), np.repeat(speed[:, None], n, axis=1)], axis=1)
        ahead = np.concatenate([np.array([float(r) for r in self.steady.mean_ratio]) * self.turn, np.zeros(n)])
        drive = float(self.k.max())
        size = np.full(cases, np.inf)
        for _ in range(NEWTON):
            end, slope, _ = self._over_period(speed, x, torque)
            left = np.concatenate([(end - x - ahead) / unit, np.zeros((cases, 1))], axis=1)
            matrix = self._bordered(slope, unit, drive)
            good = np.isfinite(matrix).all(axis=(1, 2)) & np.isfinite(left).all(axis=1)
            step = np.full(left.shape, np.nan)
            step[good] = -np.linalg.solve(matrix[good], left[good][..., None])[..., 0]
            size = np.abs(step[:, :-1]).max(axis=1)
            with np.errstate(invalid="ignore"):
                step *= np.minimum(1.0, LARGEST / np.maximum(size, 1e-300))[:, None]
            x, torque = x + step[:, :-1] * unit, torque + step[:, -1] * drive
            if not (size > ENOUGH).any():
                break
        end, slope, mean = self._over_period(speed, x, torque)
        with np.errstate(invalid="ignore"):
            found = np.abs((end - x - ahead) / unit).max(axis=1) <= CLOSED
        by_speed = np.concatenate([slope[..., -1] / unit, np.zeros((cases, 1))], axis=1)
        rise = np.full(cases, np.nan)
        rise[found] = -np.linalg.solve(self._bordered(slope, unit, drive)[found], by_speed[found][..., None])[:, -1, 0]
        matrix = slope[..., : 2 * n] * unit[:, None, :] / unit[:, :, None]
        load = self.steady.constant_loads(speed)[:, :, None].astype(complex)
        load[:, 0, 0] -= torque
        shift = np.where(found[:, None], self._rates(x[:, :, None].astype(complex), load)[..., 0].real / unit, 1.0)
        matrix = np.where(found[:, None, None], matrix, 0.0)
        return Shot(speed, found, x, torque, matrix, shift, rise * drive, mean)

    def _bordered(self, slope: Array, unit: Array, drive: float) -> Array:
        """Of Newton's steps: the start in its units, the torque in ``drive``; the first angle held."""
        cases, size = unit.shape
        matrix = np.zeros((cases, size + 1, size + 1))
        matrix[:, :size, :size] = slope[..., :size] * unit[:, None, :] / unit[:, :, None] - np.eye(size)
        matrix[:, :size, size] = slope[..., size] * drive / unit
        matrix[:, size, 0] = 1.0
        return matrix

    def _over_period(self, speed: Array, x: Array, torque: Array) -> tuple[Array, Array, Array]:
        """The end (case, 2n), its derivatives by start, torque and speed (case, 2n, 2n + 2), and mean torques."""
        size = 2 * self.n
        columns = size + 3
        state = np.repeat(x[:, :, None], columns, axis=2).astype(complex)
        state[:, np.arange(size), np.arange(1, size + 1)] += 1j * IMAGINARY
        drive, at = (np.repeat(part[:, None], columns, axis=1).astype(complex) for part in (torque, speed))
        drive[:, size + 1] += 1j * IMAGINARY
        at[:, size + 2] += 1j * IMAGINARY
        count = int(np.ceil(max(self.per_cycle * self.fastest * self.turn / speed.min() / (2 * np.pi), LEAST)))
        load = np.repeat(self.steady.constant_loads(speed)[:, :, None], columns, axis=2).astype(complex)
        load[:, 0] -= drive
        h, mean = (self.turn / at / count)[:, None], np.zeros((len(x), len(self.k)))
        with np.errstate(over="ignore", invalid="ignore"):
            for _ in range(count):
                mean += np.stack([force[:, 0].real for force, _ in self._forces(state)], axis=1) / count
                rates: list[Complex] = []
                for i in range(12):
                    inner = [STAGES[i, j] * rates[j] for j in range(i) if STAGES[i, j]]
                    rates.append(self._rates(state + h * sum(inner) if inner else state, load))
                state = state + h * sum(WEIGHTS[i] * rates[i] for i in range(12) if WEIGHTS[i])
        return state[..., 0].real, state[..., 1:].imag / IMAGINARY, mean

    def _rates(self, state: Complex, load: Complex) -> Complex:
        v = state[:, self.n :]
        torque = -load - (self.viscous + self.quadratic * v * np.sign(v.real)) * v
        for (far, link), (force, ratio) in zip(self.steady.links, self._forces(state), strict=True):
            torque[:, far] -= force
            torque[:, link.near] += ratio * force
        return np.concatenate([v, torque / self.inertia], axis=1)

    def _forces(self, state: Complex) -> list[tuple[Complex, Complex | float]]:
        """Torque of every spring and r of its near end (case, column)."""
        a, v, found = state[:, : self.n], state[:, self.n :], []
        for e, (far, link) in enumerate(self.steady.links):
            over, near = float(self.steady.over[e]), a[:, link.near]
            through, ratio = near * over, over
            if link.angle:
                chi, c = near - link.plane, np.cos(link.angle)
                lead = np.arctan(np.sin(chi) * np.cos(chi) * (1 - c) / (c * np.cos(chi) ** 2 + np.sin(chi) ** 2))
                through = (chi + lead + np.pi / 2) * over
                ratio = c / (1 - np.sin(link.angle) ** 2 * np.cos(chi) ** 2) * over
            twist = a[:, far] - through - link.fork
            found.append((self.k[e] * twist + self.c[e] * (v[:, far] - ratio * v[:, link.near]), ratio))
        return found


def growth_of_own(steady: Steady, speed: Array) -> Array:
    """ln of the largest multiplier over its period (case,) [1/s]; NaN where no motion is found.

    Where no load depends on the speed, the multiplier of the mean speed is stated by itself: where the motion takes the
    less torque the faster it is, it is one that is real and beyond 1, else one within 1.
    """
    shooting = Shooting(steady)
    shot = shooting.motions(speed)
    values = shot.multipliers
    loaded = any(m.viscous or m.quadratic for m in steady.line.masses)
    beyond = (np.abs(values.imag) < 1e-9) & (values.real > 1)
    runs_away = (shot.rise < 0) & (not loaded) & beyond.any(axis=1)
    place = np.argmax(np.where(beyond, values.real, 0.0), axis=1)
    values[np.flatnonzero(runs_away), place[runs_away]] = 0.0
    with np.errstate(divide="ignore"):
        return np.where(shot.found, np.log(np.abs(values).max(axis=1)) * speed / shooting.turn, np.nan)


def leads_over(steady: Steady, low: float, high: float) -> bool:
    """Whether one motion goes on from the speed ``low`` to ``high`` [rad/s], in small steps, to that found there."""
    shooting = Shooting(steady, ROUGHLY)
    reached = _walked(shooting, _beside(shooting, low, -1), high)
    if reached is None:
        return False
    above = _beside(shooting, high, 1)
    return bool(abs(reached.extra[0] - above.extra[0]) <= SAME * abs(above.extra[0]))


def _beside(shooting: Shooting, speed: float, side: int) -> Shot:
    """The motion at a speed, from one farther to a ``side`` where it takes that."""
    for share in ASIDE:
        begin = shooting.motions(np.array([speed * (1 + side * share)]))
        found = _walked(shooting, begin, speed) if begin.found[0] else None
        if found is not None:
            return found
    raise ArithmeticError(f"no motion at {speed} rad/s")


def _walked(shooting: Shooting, begin: Shot, end: float) -> Shot | None:
    """Where a motion leads to at the speed ``end`` [rad/s]; None where it breaks off before."""
    at, way = float(begin.speed[0]), end - float(begin.speed[0])
    step = way / WALK
    while at != end:
        to = end if abs(end - at) <= abs(step) else at + step
        shot = shooting.motions(np.array([to]), begin.start, begin.extra)
        if shot.found[0] and np.abs(shot.start - begin.start)[0, : shooting.n].max() < LEAP:
            at, begin, step = to, shot, 2 * (to - at)
        elif abs(to - at) < LEAST_STEP * abs(way):
            return None
        else:
            step = (to - at) / 2
    return begin
