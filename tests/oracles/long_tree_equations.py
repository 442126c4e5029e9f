"""Equations of driven long trees and rings, written here alone, and their motion over a period by an explicit method.

Disk i turns by a_i + δ_i, where a_i is its angle while shafts are rigid. Spring e leads from disk n (or the drive) to
disk f: its near end stands at n_e(a_n), behind a Hooke's joint tan ψ = tan χ/cos β with χ = a_n − plane and a quarter
turn more, over the ratio of the gears; a_f = n_e(a_n). With r = dn_e/da_n along that rotation,

    J_i (ä_i + δ̈_i) = Σ_near r f − Σ_far f + torques,    f = k w (δ_f − r δ_n) + c d/dt(δ_f − r δ_n).

A shaft that closes a ring stands without a joint, so that what the base motion twists it by is a torque on its disks
alone: it changes no multiplier, and is left out of the forced motion.

All columns of the propagator, and the motions that joints and torques force, are carried by Dormand and Prince's pair
of order 8 in steps of equal length, once more in half as many for its error.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import lcm
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate._ivp import dop853_coefficients as pair
from scipy.sparse import csr_array

import trunnion as tn

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
STAGES = 12
A, B, C = pair.A[:STAGES, :STAGES], pair.B, pair.C[:STAGES]
PER_STEP = 0.5
"""Radians of the fastest motion."""
LOOKS = 8
"""Moments of a period at which forced motions are looked at."""


@dataclass(frozen=True)
class Spring:
    """From disk ``near`` (−1: the drive) behind a joint of ``angle`` (0: none) and the ratio ``over`` to disk ``far``;
    teeth: cycles of its stiffness per turn of the input, ``share`` and ``phase`` of these."""

    near: int
    far: int
    over: Fraction
    angle: float
    plane: float
    stiffness: float
    damping: float
    teeth: Fraction = Fraction(0)
    share: float = 0.0
    phase: float = 0.0
    closes: bool = False


@dataclass(frozen=True)
class Motion:
    """Z (2n, 2n) in units of energy and its error; deviations (moment, n) [rad] of the steady motion and the moments τ;
    trace: ∫ tr(M⁻¹C) dτ."""

    propagator: Array
    error: float
    deviation: Array
    moment: Array
    trace: float


class LongTree:
    """A driven line of disks, shafts, meshes, ratios and Hooke's joints, each joint behind a disk; then shafts that
    close rings."""

    def __init__(self, line: tn.Driveline) -> None:
        self.springs: list[Spring] = []
        self.inertia: list[float] = []
        self.mean: list[Fraction] = []
        self.shaken: list[tuple[int, float, float, float]] = []
        self.at = 0.0
        ends: list[tuple[int, Fraction, float, float]] = []  # of every element: disk, ratio, angle, plane
        begun: Spring | None = None
        for element, parent in zip(line.elements, line.parents, strict=True):
            end = ends[parent] if parent is not None else (-1, Fraction(1), 0.0, 0.0)
            kind = element.kind
            if kind == "HookeJoint":
                assert end[1:] == (1, 0.0, 0.0), "a joint stands behind a disk"
                end = (end[0], Fraction(1), element.angle, element.plane)
            elif kind == "Ratio":
                end = (end[0], end[1] / Fraction(element.speed_ratio), *end[2:])
            elif kind == "Shaft" and element.to is not None:
                self.springs.append(self._closing(element, end, ends[line.index(element.to)]))
            elif kind in ("Shaft", "GearPair"):
                begun = self._spring(element, end)
            elif kind == "Disk":
                assert begun is not None
                self._disk(element, begun)
                end = (begun.far, Fraction(1), 0.0, 0.0)
            ends.append(end)

    def _spring(self, element: Any, end: tuple[int, Fraction, float, float]) -> Spring:
        near, over, angle, plane = end
        far = len(self.inertia)
        if element.kind == "Shaft":
            return Spring(near, far, over, angle, plane, element.stiffness, element.damping or 0.0)
        over = over / Fraction(element.speed_ratio)
        radius = element.module * element.teeth_out / 2 * np.cos(element.pressure_angle)
        (wave,) = element.stiffness_variation
        teeth = abs(self._mean(near) * over) * element.teeth_out * Fraction(wave.order)
        k, c = element.mesh_stiffness * radius**2, element.mesh_damping * radius**2
        return Spring(near, far, over, angle, plane, k, c, teeth, wave.share, wave.phase)

    def _closing(self, element: Any, end: tuple[Any, ...], far: tuple[Any, ...]) -> Spring:
        assert end[1:] == far[1:] == (1, 0.0, 0.0), "a ring is closed from disk to disk"
        return Spring(end[0], far[0], end[1], 0.0, 0.0, element.stiffness, element.damping or 0.0, closes=True)

    def _mean(self, disk: int) -> Fraction:
        return self.mean[disk] if disk >= 0 else Fraction(1)

    def _disk(self, element: Any, begun: Spring) -> None:
        self.springs.append(begun)
        self.inertia.append(element.inertia)
        self.mean.append(self._mean(begun.near) * begun.over)
        for torque in element.excitation:
            own = self.mean[-1]
            rate = torque.order * abs(float(own))
            self.shaken.append((begun.far, rate, np.sign(float(own)) * torque.amplitude, torque.phase))

    @cached_property
    def turns(self) -> Fraction:
        """Of the input, after which the coefficients repeat."""
        rates = [2 * abs(self._mean(s.near)) for s in self.springs if s.angle]
        rates += [s.teeth for s in self.springs if s.share]
        periods = [1 / rate for rate in rates]
        shared = lcm(*(p.denominator for p in periods))
        return Fraction(lcm(*(int(p * shared) for p in periods)), shared)

    def motion(self, speed: float) -> Motion:
        """Over one period at an input speed [rad/s]."""
        n, period = len(self.inertia), 2 * np.pi * float(self.turns)
        mass = np.array(self.inertia)
        joined = np.zeros(n)
        for s in self.springs:
            joined[s.far] += s.stiffness * (1 + s.share)
            if s.near >= 0:
                joined[s.near] += s.stiffness * (1 + s.share) * (float(s.over) / np.cos(s.angle)) ** 2
        fastest = float(np.sqrt(2 * joined / mass).max()) / speed
        steps = LOOKS * int(np.ceil(period * fastest / PER_STEP / LOOKS / 2)) * 2
        self.at = speed
        unit = np.sqrt(np.median(joined / mass)) / speed
        fine, shown = self._carried(period, steps, unit)
        coarse, _ = self._carried(period, steps // 2, unit)
        error = float(np.linalg.norm(fine[:, : 2 * n] - coarse[:, : 2 * n])) / 100
        root, propagator = np.sqrt(mass), fine[:, : 2 * n]
        start = np.linalg.solve(np.eye(2 * n) - propagator, fine[:, 2 * n])
        joints = [(one[:, : 2 * n] @ start + one[:, 2 * n])[:n] for one in shown]
        moment = period * np.arange(LOOKS) / LOOKS
        deviation = np.array(joints)
        for k, (_, rate, _, _) in enumerate(self.shaken):
            forced = [one[:, 2 * n + 1 + 2 * k] + 1j * one[:, 2 * n + 2 + 2 * k] for one in shown]
            whole = fine[:, 2 * n + 1 + 2 * k] + 1j * fine[:, 2 * n + 2 + 2 * k]
            begin = np.linalg.solve(np.exp(1j * rate * period) * np.eye(2 * n) - propagator, whole)
            every = [(one[:, : 2 * n] @ begin + part)[:n] for one, part in zip(shown, forced, strict=True)]
            deviation = deviation + np.array(every).real
        return Motion(propagator, error, deviation / root / unit, moment, self._trace(period, mass) * period / speed)

    def _trace(self, period: float, mass: Array) -> float:
        """Mean of tr(M⁻¹C) over the period."""
        r = self._rigid(period * np.arange(4096) / 4096)[0]
        square = (r**2).mean(axis=1)
        return sum(
            s.damping * (1 / mass[s.far] + (square[e] / mass[s.near] if s.near >= 0 else 0.0))
            for e, s in enumerate(self.springs)
        )

    def _carried(self, period: float, steps: int, unit: float) -> tuple[Array, list[Array]]:
        """Columns of the propagator and of what is forced after a period, and at ``LOOKS`` moments of it, of states
        √J·(δ unit, dδ/dτ)."""
        n, h = len(self.inertia), period / steps
        y = np.concatenate([np.eye(2 * n), np.zeros((2 * n, 1 + 2 * len(self.shaken)))], axis=1)
        shown, stage, some = list[Array](), np.empty((STAGES, *y.shape)), steps // LOOKS
        for k in range(steps):
            if k % some == 0:
                shown.append(y.copy())
                rates = self._rates((h * (k + np.arange(some)[:, None] + C)).ravel(), unit)
            for i in range(STAGES):
                state = y + h * np.tensordot(A[i, :i], stage[:i], 1) if i else y
                matrix, acting = rates(STAGES * (k % some) + i)
                stage[i, :n] = unit * state[n:]
                stage[i, n:] = matrix @ state
                stage[i, n:, 2 * n :] += acting
            y = y + h * np.tensordot(B, stage, 1)
        return y, shown

    def _rigid(self, tau: Array) -> tuple[Array, Array, Array]:
        """r and dr/dτ (spring, time) of all springs and ä_i/Ω² (disk, time), at input angles (time,)."""
        angle, w, w1 = (np.empty((len(self.inertia), len(tau))) for _ in range(3))
        r, slope = np.zeros((2, len(self.springs), len(tau)))
        for e, s in enumerate(self.springs):
            a, v, v1 = (angle[s.near], w[s.near], w1[s.near]) if s.near >= 0 else (tau, 1 + 0 * tau, 0 * tau)
            over = float(s.over)
            r[e] = over
            if s.closes:
                continue
            if s.angle:
                chi, c, s2 = a - s.plane, np.cos(s.angle), np.sin(s.angle) ** 2
                below = 1 - s2 * np.cos(chi) ** 2
                a = chi + np.arctan2(np.sin(chi) * np.cos(chi) * (1 - c), c * np.cos(chi) ** 2 + np.sin(chi) ** 2)
                a = a + np.pi / 2
                bend = -c * s2 * np.sin(2 * chi) / below**2
                r[e], slope[e] = over * c / below, over * bend * v
                v, v1 = c / below * v, c / below * v1 + bend * v**2
            angle[s.far], w[s.far], w1[s.far] = over * a, over * v, over * v1
        return r, slope, w1

    @cached_property
    def _places(self) -> tuple[Any, ...]:
        near, far = (np.array([getattr(s, key) for s in self.springs]) for key in ("near", "far"))
        held = near >= 0
        rows = np.concatenate([far, near[held], far[held], near[held]])
        columns = np.concatenate([far, near[held], near[held], far[held]])
        keys = ("stiffness", "damping", "teeth", "share", "phase")
        return held, rows, columns, *(np.array([float(getattr(s, key)) for s in self.springs]) for key in keys)

    def _rates(self, tau: Array, unit: float) -> Callable[[int], tuple[csr_array, Array]]:
        """Number of a moment of ``tau`` (time,) → the lower half of the states' rates (n, 2n), and what acts on them
        (n, forces), per unit of input angle."""
        held, rows, columns, stiffness, damping, teeth, share, phase = self._places
        n, root = len(self.inertia), np.sqrt(np.array(self.inertia))
        every_r, every_slope, base = self._rigid(tau)
        weight = 1 / (root[rows] * root[columns])
        places = np.tile(rows, 2), np.concatenate([columns, columns + n])
        c = damping / self.at
        c_ = c[held]

        def at(t: int) -> tuple[csr_array, Array]:
            # f = k w (δ_f − r δ_n) + c Ω (δ_f′ − r δ_n′ − r′ δ_n), per Ω²
            k = stiffness * (1 + share * np.cos(teeth * tau[t] + phase)) / self.at**2
            r, slope, k_ = every_r[held, t], every_slope[held, t], k[held]
            place = np.concatenate([-k, -r * (k_ * r + c_ * slope), k_ * r + c_ * slope, r * k_])
            speed = np.concatenate([-c, -(r**2) * c_, c_ * r, r * c_])
            both = np.concatenate([place * weight / unit, speed * weight])
            matrix = csr_array((both, places), shape=(n, 2 * n))
            acting = np.zeros((n, 1 + 2 * len(self.shaken)))
            acting[:, 0] = -root * base[:, t]
            for i, (disk, turning, amplitude, begin) in enumerate(self.shaken):
                size = amplitude / self.at**2 / root[disk]
                acting[disk, 1 + 2 * i] = size * np.cos(turning * tau[t] + begin)
                acting[disk, 2 + 2 * i] = size * np.sin(turning * tau[t] + begin)
            return matrix, acting

        return at
