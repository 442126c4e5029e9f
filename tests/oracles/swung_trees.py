"""Periodic motions of driven and free trees of disks, tubes, gears and Hooke's joints, and their multipliers, by
equations and an integration written here alone.

Unknown i turns by a_i; of a driven tree the first is the drive, which turns evenly. What stands rigidly behind it
turns by g(a_i) = w n(a_i), behind a joint tan ψ = tan χ/cos β with χ = a_i − plane, a quarter turn on, and a ratio w. A
spring leads from there to another unknown f; the inertia of a tube stands half at either end.

    Σ J (g′ d²g/dt²) = Σ_near g′ F − Σ_far F − loads,    F = k (a_f − g(a_i) − fork) + c d/dt(a_f − g(a_i)).

Steps of equal length of Dormand and Prince's method of order 8 carry the motion and its derivatives by the start and by
the torque that drives the first disk of a free tree; Newton's steps close a(T) = a(0) + mean turn, ȧ(T) = ȧ(0).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray
from scipy.integrate._ivp import dop853_coefficients as pair

import trunnion as tn

Array = NDArray[np.float64]
STAGES, WEIGHTS = np.ascontiguousarray(pair.A[:12, :12]), np.ascontiguousarray(pair.B)
PER_RADIAN, LEAST = 1.0, 40
"""Steps per radian of what swings fastest, and per half turn of the input."""
ROUNDS, CLOSED, LARGEST = 40, 1e-11, 0.15
"""Newton's steps, and the largest of them [rad] where a motion is found and that is taken at once."""


LOADS = "load_torque", "viscous_load", "quadratic_load"


@dataclass(frozen=True)
class Behind:
    """What stands rigidly behind unknown ``owner``: a joint where ``bent`` is 1, the ratio ``over``, an inertia."""

    owner: int
    angle: float = 0.0
    plane: float = 0.0
    bent: float = 0.0
    over: float = 1.0
    inertia: float = 0.0

    @property
    def plain(self) -> bool:
        """Whether it is the unknown itself."""
        return not self.bent and self.over == 1.0


@dataclass(frozen=True)
class Swung:
    """radius: largest multiplier over the period, that of a shift in time left out; start (2n,); torque of disk 0."""

    radius: float
    start: Array
    torque: float


class SwungTree:
    """``line`` of the elements named above and loads on disks behind springs; ``turn`` [rad]: period."""

    def __init__(self, line: tn.Driveline, turn: float = np.pi) -> None:
        self.turn, self.driven = turn, False
        self.inertia, self.mean = list[float](), list[float]()
        self.load, self.springs, self.behind = list[tuple[float, ...]](), list[tuple[float, ...]](), list[Behind]()
        ends: list[Behind] = []  # of every element
        for element, parent in zip(line.elements, line.parents, strict=True):
            kind: Any = element
            end = ends[parent] if parent is not None else self._begun(kind)
            if kind.kind == "HookeJoint":
                assert not end.bent, "one joint between two springs"
                end = replace(end, angle=kind.angle, plane=kind.plane, bent=1.0)
            elif kind.kind == "Ratio":
                end = replace(end, over=end.over / float(kind.speed_ratio))
            elif kind.kind in ("Shaft", "GearPair", "Coupling"):
                end = self._sprung(kind, end)
            elif kind.kind in ("Disk", "Propeller"):
                self._weighed(end, kind.inertia)
                load = tuple(float(getattr(kind, key, None) or 0.0) for key in LOADS)
                assert end.plain or not any(load), "loads stand behind springs"
                self.load[end.owner] = tuple(np.add(self.load[end.owner], load))
            ends.append(end)
        self.n = len(self.inertia)
        rigid = [(one.owner, one.angle, one.plane, one.bent, one.over, one.inertia) for one in self.behind]
        parts = (self.inertia, self.load, self.springs, self.mean, np.reshape(rigid, (-1, 6)))
        self.numbers = tuple(np.ascontiguousarray(part, dtype=float) for part in parts)

    def _begun(self, first: Any) -> Behind:
        self.driven = first.kind == "ConstantSpeed"
        return self._added(1.0 if self.driven else 0.0, 1.0)

    def _added(self, inertia: float, mean: float) -> Behind:
        self.inertia.append(inertia)
        self.mean.append(mean)
        self.load.append((0.0, 0.0, 0.0))
        return Behind(len(self.inertia) - 1)

    def _weighed(self, end: Behind, inertia: float) -> None:
        if end.plain:
            self.inertia[end.owner] += inertia
        elif inertia:
            self.behind.append(replace(end, inertia=inertia))

    def _sprung(self, kind: Any, end: Behind) -> Behind:
        half = fork = 0.0
        if kind.kind == "GearPair":
            end = replace(end, over=end.over / float(kind.speed_ratio))
            radius = kind.module * kind.teeth_out / 2 * np.cos(kind.pressure_angle)
            k, c = kind.mesh_stiffness * radius**2, (kind.mesh_damping or 0.0) * radius**2
        elif kind.kind == "Coupling":
            # Relative damping 2πωc/k at a frequency.
            k = kind.stiffness
            c = kind.relative_damping * k / (2 * np.pi * kind.loss_factor_frequency)
        else:
            k, c, fork = kind.torsional_stiffness, kind.damping_coefficient, kind.fork_offset or 0.0
            half = kind.moment_of_inertia / 2 if kind.density else 0.0
        self._weighed(end, half)
        far = self._added(half, self.mean[end.owner] * end.over)
        self.springs.append((end.owner, far.owner, end.angle, end.plane, end.bent, end.over, k, c, fork))
        return far

    def rigid(self, speed: float) -> tuple[Array, float]:
        """Shafts without vibration, twisted by their mean loads; and what the first disk drives with."""
        carried = np.array([
            c * np.sign(m) + v * m * speed + q * (m * speed) ** 2 * np.sign(m)
            for (c, v, q), m in zip(self.load, self.mean, strict=True)
        ])  # fmt: skip
        a, v = np.zeros(self.n), np.full(self.n, speed)
        for near, far, *_, over, _, _, _ in reversed(self.springs):
            carried[int(near)] += over * carried[int(far)]
        for near, far, angle, plane, bent, over, k, _, fork in self.springs:
            i, j = int(near), int(far)
            n, slope, _, _ = _passed(a[i], angle, plane, bent)
            a[j], v[j] = over * n + fork - carried[j] / k, over * slope * v[i]
        return np.concatenate([a, v]), float(carried[0])

    def _weights(self) -> Array:
        """Inertia of every unknown with what stands behind it, joints straight."""
        whole = np.array(self.inertia)
        for one in self.behind:
            whole[one.owner] += one.over**2 * one.inertia
        return whole

    def modes(self) -> Array:
        """Frequencies [rad/s] of the straight line, rising, without turning as a whole."""
        stiffness, own = np.zeros((self.n, self.n)), slice(int(self.driven), None)
        for near, far, *_, over, k, _, _ in self.springs:
            twist = np.zeros(self.n)
            twist[int(far)], twist[int(near)] = 1.0, -over
            stiffness += k * np.outer(twist, twist)
        root = np.sqrt(self._weights()[own])
        square = np.linalg.eigvalsh(stiffness[own, own] / root[:, None] / root)
        return np.sqrt(np.maximum(square[0 if self.driven else 1 :], 0.0))

    def steps(self, speed: float) -> int:
        """Of a period."""
        joined = np.zeros(self.n)
        for near, far, angle, _, _, over, k, _, _ in self.springs:
            joined[int(far)] += k
            joined[int(near)] += k * (over / np.cos(angle)) ** 2
        fastest = np.sqrt(2 * (joined / self._weights()).max()) / speed
        return int(np.ceil(max(PER_RADIAN * fastest * self.turn, LEAST * self.turn / np.pi)))

    def motion(self, speed: float, start: Array | None = None, torque: float = 0.0, *, finer: int = 1) -> Swung | None:
        """At a mean ``speed`` [rad/s], from rigid shafts or from the motion given; None where none is found."""
        x, drive = self.rigid(speed)
        if start is not None:
            x, drive = start.copy(), torque
        if self.driven:
            x[self.n] = speed
        n, size = self.n, 2 * self.n
        unit = np.repeat([1.0, speed], n)
        ahead = np.concatenate([self.numbers[3] * self.turn, np.zeros(n)])
        own = np.array([i for i in range(size) if not (self.driven and i % n == 0)])
        unknown = own if self.driven else own[1:]
        stiff = float(self.numbers[2][:, 6].max())
        steps = finer * self.steps(speed)
        for _ in range(ROUNDS):
            h = self.turn / speed / steps
            end = _carrier()(x, drive, h, steps, self.driven, *self._given, STAGES, WEIGHTS)
            if not np.isfinite(end).all():
                return None
            matrix = end[:, 1:-1] * unit / unit[:, None]
            left = ((end[:, 0] - x - ahead) / unit)[own]
            whole = (matrix - np.eye(size))[np.ix_(own, unknown)]
            if not self.driven:
                whole = np.column_stack([whole, (end[:, -1] * stiff / unit)[own]])
            try:
                change = np.linalg.solve(whole, -left)
            except np.linalg.LinAlgError:
                return None
            largest = float(np.abs(change[: len(unknown)]).max())
            share = min(1.0, LARGEST / largest) if largest else 1.0
            x[unknown] += share * change[: len(unknown)] * unit[unknown]
            drive += 0.0 if self.driven else share * float(change[-1]) * stiff
            if largest < CLOSED:
                return Swung(self._largest(matrix[np.ix_(own, own)], x, drive, unit), x, drive)
        return None

    @property
    def _given(self) -> tuple[Array, ...]:
        inertia, load, springs, _, rigid = self.numbers
        return inertia, load, springs, rigid

    def _largest(self, matrix: Array, x: Array, drive: float, unit: Array) -> float:
        if not self.driven:
            shift = _rate_of()(x, drive, *self._given) / unit
            rest = np.linalg.qr(shift[:, None], mode="complete")[0][:, 1:]
            matrix = rest.T @ matrix @ rest
        return float(np.abs(np.linalg.eigvals(matrix)).max())

    def radius(self, speed: float) -> float:
        """Of ``motion``; NaN where none is found."""
        found = self.motion(speed)
        return np.nan if found is None else found.radius


def _passed(a: float, angle: float, plane: float, bent: float) -> tuple[float, float, float, float]:
    """Angle behind a joint and its first three derivatives by that before it."""
    if not bent:
        return a, 1.0, 0.0, 0.0
    chi, c, s2 = a - plane, np.cos(angle), np.sin(angle) ** 2
    cos, sin = np.cos(chi), np.sin(chi)
    below, slope, bend = 1 - s2 * cos * cos, 2 * s2 * sin * cos, 2 * s2 * (cos * cos - sin * sin)
    ahead = np.arctan2(sin * cos * (1 - c), c * cos * cos + sin * sin)
    third = -c * bend / below**2 + 2 * c * slope**2 / below**3
    return chi + ahead + np.pi / 2, c / below, -c * slope / below**2, third


@cache
def _compiled() -> tuple[Any, Any]:
    """(start, torque, step, steps, driven, numbers…) → end and derivatives (2n, 1 + 2n + 1), and (start, torque,
    numbers…) → rates (2n,)."""
    passed = numba.njit(_passed)

    @numba.njit
    def rates(y, torque, driven, inertia, load, springs, rigid, out):  # type: ignore[no-untyped-def]
        n, columns = len(inertia), y.shape[1]
        for i in range(n):
            v = y[n + i, 0]
            sense = 1.0 if v > 0 else -1.0
            slope = load[i, 1] + 2 * load[i, 2] * v * sense
            for j in range(columns):
                out[i, j], out[n + i, j] = v if j == 0 else y[n + i, j], -slope * y[n + i, j]
            out[n + i, 0] = -load[i, 0] * sense - load[i, 1] * v - load[i, 2] * v * v * sense
        out[n, 0] += torque
        out[n, columns - 1] += 1.0
        for e in range(len(springs)):
            p, q, over = int(springs[e, 0]), int(springs[e, 1]), springs[e, 5]
            k, c = springs[e, 6], springs[e, 7]
            a, r, r1, _ = passed(y[p, 0], springs[e, 2], springs[e, 3], springs[e, 4])
            a, r, r1 = over * a, over * r, over * r1
            f = k * (y[q, 0] - a - springs[e, 8]) + c * (y[n + q, 0] - r * y[n + p, 0])
            out[n + q, 0] -= f
            out[n + p, 0] += r * f
            for j in range(1, columns):
                df = k * (y[q, j] - r * y[p, j]) + c * (y[n + q, j] - r * y[n + p, j] - r1 * y[n + p, 0] * y[p, j])
                out[n + q, j] -= df
                out[n + p, j] += r * df + r1 * f * y[p, j]
        mass, change = inertia.copy(), np.zeros(n)  # and what it changes by with the angle
        for e in range(len(rigid)):
            i, over, weight = int(rigid[e, 0]), rigid[e, 4], rigid[e, 5]
            _, r, r1, r2 = passed(y[i, 0], rigid[e, 1], rigid[e, 2], rigid[e, 3])
            weight, v = weight * over * over, y[n + i, 0]
            mass[i] += weight * r * r
            change[i] += 2 * weight * r * r1
            out[n + i, 0] -= weight * r * r1 * v * v
            for j in range(1, columns):
                out[n + i, j] -= weight * ((r1 * r1 + r * r2) * v * v * y[i, j] + 2 * r * r1 * v * y[n + i, j])
        for i in range(n):
            out[n + i, 0] = 0.0 if driven and i == 0 else out[n + i, 0] / mass[i]
            for j in range(1, columns):
                out[n + i, j] -= change[i] * out[n + i, 0] * y[i, j]
                out[n + i, j] = 0.0 if driven and i == 0 else out[n + i, j] / mass[i]

    @numba.njit
    def add(y, by, other):  # type: ignore[no-untyped-def]
        for i in range(y.shape[0]):
            for j in range(y.shape[1]):
                y[i, j] += by * other[i, j]

    @numba.njit
    def carry(start, torque, h, steps, driven, inertia, load, springs, rigid, table, weights):  # type: ignore[no-untyped-def]
        size = len(start)
        y = np.zeros((size, size + 2))
        for i in range(size):
            y[i, 0], y[i, 1 + i] = start[i], 1.0
        stages, state = np.zeros((12, size, size + 2)), np.zeros((size, size + 2))
        for _ in range(steps):
            for i in range(12):
                for p in range(size):
                    for q in range(size + 2):
                        state[p, q] = y[p, q]
                for j in range(i):
                    if table[i, j] != 0.0:
                        add(state, h * table[i, j], stages[j])
                rates(state, torque, driven, inertia, load, springs, rigid, stages[i])
            for i in range(12):
                if weights[i] != 0.0:
                    add(y, h * weights[i], stages[i])
        return y

    @numba.njit
    def rate_of(start, torque, inertia, load, springs, rigid):  # type: ignore[no-untyped-def]
        y = np.zeros((len(start), 2))
        for i in range(len(start)):
            y[i, 0] = start[i]
        out = np.zeros_like(y)
        rates(y, torque, False, inertia, load, springs, rigid, out)
        return out[:, 0].copy()

    return carry, rate_of


def _carrier() -> Any:
    return _compiled()[0]


def _rate_of() -> Any:
    return _compiled()[1]
