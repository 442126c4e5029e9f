"""Periodic motions of driven and free trees of disks, shafts, ratios and Hooke's joints, and their multipliers, by
equations and an integration written here alone.

Disk i stands at a_i; of a driven tree disk 0 is the drive, which turns evenly. A spring leads from disk n to disk f.
Its near end stands at w n(a_n), behind a joint tan ψ = tan χ/cos β with χ = a_n − plane, a quarter turn on, and a ratio
w:

    J_i ä_i = Σ_near w n′ f − Σ_far f − loads,    f = k (a_f − w n(a_n) − fork) + c d/dt(a_f − w n(a_n)).

Steps of equal length of Dormand and Prince's method of order 8 carry the motion and its derivatives by the start and by
the torque that drives disk 0 of a free tree; Newton's steps close a(T) = a(0) + mean turn, ȧ(T) = ȧ(0).
"""

from __future__ import annotations

from dataclasses import dataclass
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


@dataclass(frozen=True)
class Swung:
    """radius: largest multiplier over the period, that of a shift in time left out; start (2n,); torque of disk 0."""

    radius: float
    start: Array
    torque: float


class SwungTree:
    """``line`` of disks behind springs, each with at most one joint and ratios behind it; ``turn`` [rad]: period."""

    def __init__(self, line: tn.Driveline, turn: float = np.pi) -> None:
        self.line, self.turn = line, turn
        self.inertia, self.load, self.mean, self.level = list[float](), list[tuple[float, ...]](), [1.0], [0.0]
        self.springs: list[tuple[float, ...]] = []
        ends: list[tuple[Any, ...]] = []  # of every element: disk, joint angle, plane, whether there is one, ratio
        waiting: dict[int, tuple[float, ...]] = {}
        driven = False
        for i, (element, parent) in enumerate(zip(line.elements, line.parents, strict=True)):
            kind: Any = element
            end = ends[parent] if parent is not None else (0, 0.0, 0.0, 0.0, 1.0)
            if kind.kind == "ConstantSpeed":
                driven = True
                self.inertia.append(1.0)
                self.load.append((0.0, 0.0, 0.0))
            elif kind.kind == "HookeJoint":
                assert end[3:] == (0.0, 1.0), "a joint stands behind a disk"
                end = (end[0], kind.angle, kind.plane, 1.0, 1.0)
            elif kind.kind == "Ratio":
                end = (*end[:4], end[4] / float(kind.speed_ratio))
            elif kind.kind == "Shaft":
                waiting[i] = (*end, kind.stiffness, kind.damping or 0.0, kind.fork_offset or 0.0)
            elif kind.kind == "Disk":
                if parent is not None:
                    self._join(waiting[parent], len(self.inertia))
                end = (len(self.inertia), 0.0, 0.0, 0.0, 1.0)
                self.inertia.append(kind.inertia)
                self.load.append((kind.load_torque or 0.0, kind.viscous_load or 0.0, kind.quadratic_load or 0.0))
            ends.append(end)
        self.driven, self.n = driven, len(self.inertia)
        self.numbers = tuple(
            np.ascontiguousarray(part, dtype=float) for part in (self.inertia, self.load, self.springs, self.mean)
        )

    def _join(self, behind: tuple[float, ...], far: int) -> None:
        near, angle, plane, bent, over, k, c, fork = behind
        self.springs.append((near, far, angle, plane, bent, over, k, c, fork))
        self.mean.append(self.mean[int(near)] * over)
        self.level.append(over * (self.level[int(near)] + bent * (np.pi / 2 - plane)) + fork)

    def rigid(self, speed: float) -> tuple[Array, float]:
        """Shafts without vibration, twisted by their mean loads; and the torque of disk 0 that balances these."""
        mean = self.numbers[3]
        torque = [c * np.sign(m) + v * m * speed + q * (m * speed) ** 2 * np.sign(m)
                  for (c, v, q), m in zip(self.load, mean.tolist(), strict=True)]  # fmt: skip
        a, v = np.zeros(self.n), np.full(self.n, speed)
        carried = np.array(torque)
        for near, far, *_, over, _, _, _ in reversed(self.springs):
            carried[int(near)] += over * carried[int(far)]
        for near, far, angle, plane, bent, over, k, _, fork in self.springs:
            i, j = int(near), int(far)
            n, slope, _ = _passed(a[i], angle, plane, bent)
            a[j], v[j] = over * n + fork - carried[j] / k, over * slope * v[i]
        return np.concatenate([a, v]), float(carried[0])

    def modes(self) -> Array:
        """Frequencies [rad/s] of the straight line, rising, without turning as a whole."""
        stiffness, own = np.zeros((self.n, self.n)), slice(int(self.driven), None)
        for near, far, *_, over, k, _, _ in self.springs:
            twist = np.zeros(self.n)
            twist[int(far)], twist[int(near)] = 1.0, -over
            stiffness += k * np.outer(twist, twist)
        root = np.sqrt(self.numbers[0][own])
        square = np.linalg.eigvalsh(stiffness[own, own] / root[:, None] / root)
        return np.sqrt(np.maximum(square[0 if self.driven else 1 :], 0.0))

    def steps(self, speed: float) -> int:
        """Of a period."""
        joined = np.zeros(self.n)
        for near, far, angle, _, _, over, k, _, _ in self.springs:
            joined[int(far)] += k
            joined[int(near)] += k * (over / np.cos(angle)) ** 2
        fastest = np.sqrt(2 * (joined / self.numbers[0]).max()) / speed
        return int(np.ceil(max(PER_RADIAN * fastest * self.turn, LEAST * self.turn / np.pi)))

    def motion(self, speed: float, start: Array | None = None, torque: float = 0.0, *, finer: int = 1) -> Swung | None:
        """At a mean ``speed`` [rad/s], from rigid shafts or from the motion given; None where none is found."""
        x, drive = self.rigid(speed)
        if start is not None:
            x, drive = start.copy(), torque
        n, size = self.n, 2 * self.n
        unit = np.repeat([1.0, speed], n)
        ahead = np.concatenate([self.numbers[3] * self.turn, np.zeros(n)])
        own = np.array([i for i in range(size) if not (self.driven and i % n == 0)])
        unknown = own if self.driven else own[1:]
        stiff = float(self.numbers[2][:, 6].max())
        steps = finer * self.steps(speed)
        for _ in range(ROUNDS):
            h = self.turn / speed / steps
            end = _carrier()(x, drive, h, steps, self.driven, *self.numbers[:3], STAGES, WEIGHTS)
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

    def _largest(self, matrix: Array, x: Array, drive: float, unit: Array) -> float:
        if not self.driven:
            shift = _rate_of()(x, drive, *self.numbers[:3]) / unit
            rest = np.linalg.qr(shift[:, None], mode="complete")[0][:, 1:]
            matrix = rest.T @ matrix @ rest
        return float(np.abs(np.linalg.eigvals(matrix)).max())

    def radius(self, speed: float) -> float:
        """Of ``motion``; NaN where none is found."""
        found = self.motion(speed)
        return np.nan if found is None else found.radius


def _passed(a: float, angle: float, plane: float, bent: float) -> tuple[float, float, float]:
    """Angle behind a joint and its first two derivatives by that before it."""
    if not bent:
        return a, 1.0, 0.0
    chi, c, s2 = a - plane, np.cos(angle), np.sin(angle) ** 2
    cos, sin = np.cos(chi), np.sin(chi)
    below = 1 - s2 * cos * cos
    ahead = np.arctan2(sin * cos * (1 - c), c * cos * cos + sin * sin)
    return chi + ahead + np.pi / 2, c / below, -2 * c * s2 * sin * cos / below**2


@cache
def _compiled() -> tuple[Any, Any]:
    """(start, torque, step, steps, driven, numbers…) → end and derivatives (2n, 1 + 2n + 1), and (start, torque,
    numbers…) → rates (2n,)."""
    passed = numba.njit(_passed)

    @numba.njit
    def rates(y, torque, driven, inertia, load, springs, out):  # type: ignore[no-untyped-def]
        n, columns = len(inertia), y.shape[1]
        for i in range(n):
            v = y[n + i, 0]
            sense = 1.0 if v > 0 else -1.0
            slope = load[i, 1] + 2 * load[i, 2] * v * sense
            for j in range(columns):
                out[i, j], out[n + i, j] = y[n + i, j], -slope * y[n + i, j]
            out[n + i, 0] = -load[i, 0] * sense - load[i, 1] * v - load[i, 2] * v * v * sense
        out[n, 0] += torque
        out[n, columns - 1] += 1.0
        for e in range(len(springs)):
            p, q, over = int(springs[e, 0]), int(springs[e, 1]), springs[e, 5]
            k, c = springs[e, 6], springs[e, 7]
            a, r, r1 = passed(y[p, 0], springs[e, 2], springs[e, 3], springs[e, 4])
            a, r, r1 = over * a, over * r, over * r1
            f = k * (y[q, 0] - a - springs[e, 8]) + c * (y[n + q, 0] - r * y[n + p, 0])
            out[n + q, 0] -= f
            out[n + p, 0] += r * f
            for j in range(1, columns):
                df = k * (y[q, j] - r * y[p, j]) + c * (y[n + q, j] - r * y[n + p, j] - r1 * y[n + p, 0] * y[p, j])
                out[n + q, j] -= df
                out[n + p, j] += r * df + r1 * f * y[p, j]
        for i in range(n):
            for j in range(columns):
                out[n + i, j] = 0.0 if driven and i == 0 else out[n + i, j] / inertia[i]

    @numba.njit
    def add(y, by, other):  # type: ignore[no-untyped-def]
        for i in range(y.shape[0]):
            for j in range(y.shape[1]):
                y[i, j] += by * other[i, j]

    @numba.njit
    def carry(start, torque, h, steps, driven, inertia, load, springs, table, weights):  # type: ignore[no-untyped-def]
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
                rates(state, torque, driven, inertia, load, springs, stages[i])
            for i in range(12):
                if weights[i] != 0.0:
                    add(y, h * weights[i], stages[i])
        return y

    @numba.njit
    def rate_of(start, torque, inertia, load, springs):  # type: ignore[no-untyped-def]
        y = np.zeros((len(start), 2))
        for i in range(len(start)):
            y[i, 0] = start[i]
        out = np.zeros_like(y)
        rates(y, torque, False, inertia, load, springs, out)
        return out[:, 0].copy()

    return carry, rate_of


def _carrier() -> Any:
    return _compiled()[0]


def _rate_of() -> Any:
    return _compiled()[1]
