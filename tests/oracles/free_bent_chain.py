"""A free chain of disks, shafts and Hooke's joints by equations written here alone, integrated by SciPy.

Disk i stands at a_i, and a spring between it and the next one, whose near end is behind a joint of angle β where there
is one: n(a) = χ + arctan(sin χ cos χ (1 − c)/(c cos² χ + sin² χ)) + π/2, χ = a − plane, c = cos β.

    J_i ä_i = −f_{i−1} + n′(a_i) f_i − d_i ȧ_i (+ T of the first),    f = k (a_{i+1} − n(a_i)) + c (ȧ_{i+1} − n′ ȧ_i)

The period is half a turn. Newton's steps close a(T) = a(0) + π, ȧ(T) = ȧ(0) by the start, the first angle held at 0,
and by the torque T of the first disk; derivatives are carried with the motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import trunnion as tn

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Closed:
    """start (2n,) [rad, rad/s], the torque of the first disk [N m], and what a disturbance becomes in a period (2n,
    2n), rates over the speed."""

    start: Array
    torque: float
    matrix: Array


class FreeBentChain:
    """``line`` in disks and springs, each joint right behind a disk."""

    def __init__(self, line: tn.Driveline) -> None:
        inertia, stiffness, damping, viscous, bends = list[float](), list[float](), list[float](), list[float](), {}
        for element in line.elements:
            kind: Any = element
            if kind.kind == "Disk":
                inertia.append(kind.inertia)
                viscous.append(kind.viscous_load or 0.0)
            elif kind.kind == "Shaft":
                stiffness.append(kind.stiffness)
                damping.append(kind.damping or 0.0)
            else:
                bends[len(inertia) - 1] = kind.angle, kind.plane
        self.j, self.k, self.c, self.d = (np.array(part) for part in (inertia, stiffness, damping, viscous))
        self.n = len(inertia)
        count = self.n - 1
        self.bent = np.array([i in bends for i in range(count)])
        self.angle, self.plane = (np.array([bends.get(i, (0.0, 0.0))[k] for i in range(count)]) for k in (0, 1))
        self.fork = np.concatenate([[0.0], np.cumsum(self.bent * np.pi / 2 - self.plane)])
        """What joints add to the mean angle of each disk."""

    def passed(self, a: Array) -> tuple[Array, Array, Array]:
        """n, n′ and n″ at angles (spring, …) of the near disks."""
        shape = (-1,) + (1,) * (a.ndim - 1)
        beta, bent = self.angle.reshape(shape), self.bent.reshape(shape)
        chi, c, s2 = a - self.plane.reshape(shape), np.cos(beta), np.sin(beta) ** 2
        lead = np.arctan(np.sin(chi) * np.cos(chi) * (1 - c) / (c * np.cos(chi) ** 2 + np.sin(chi) ** 2))
        below = 1 - s2 * np.cos(chi) ** 2
        n = np.where(bent, a + lead + np.pi / 2 - self.plane.reshape(shape), a)
        return n, np.where(bent, c / below, 1.0), np.where(bent, -c * s2 * np.sin(2 * chi) / below**2, 0.0)

    def base(self, speed: float) -> Array:
        """Rigid shafts, the first disk at 0."""
        a, v = np.zeros(self.n), np.full(self.n, speed)
        for i in range(self.n - 1):
            n, slope, _ = self.passed(a[:-1])
            a[i + 1], v[i + 1] = n[i], slope[i] * v[i]
        return np.concatenate([a, v])

    def forces(self, a: Array, v: Array) -> tuple[Array, Array, Array, Array]:
        """f, n′, n″ (spring, …) and the rate of the twists."""
        n, r, r1 = self.passed(a[:-1])
        shape = (-1,) + (1,) * (a.ndim - 1)
        rate = v[1:] - r * v[:-1]
        return self.k.reshape(shape) * (a[1:] - n) + self.c.reshape(shape) * rate, r, r1, rate

    def energy(self, a: Array, v: Array) -> Array:
        """Of motions (n, time) without dampers."""
        n = self.passed(a[:-1])[0]
        return (self.j[:, None] * v**2).sum(axis=0) / 2 + (self.k[:, None] * (a[1:] - n) ** 2).sum(axis=0) / 2

    def lost(self, a: Array, v: Array) -> Array:
        """Power (time,) that dampers take."""
        return (self.c[:, None] * self.forces(a, v)[3] ** 2).sum(axis=0) + (self.d[:, None] * v**2).sum(axis=0)

    def rates(self, torque: float, y: Array) -> Array:
        """Of the state and the columns beside it (2n, 1 + column): derivatives by start and torque."""
        n, (a, v), (da, dv) = self.n, np.split(y[:, 0], 2), np.split(y[:, 1:], 2)
        f, r, r1, _ = self.forces(a, v)
        acting = -self.d * v
        acting[0] += torque
        acting[1:] -= f
        acting[:-1] += r * f
        df = self.k[:, None] * (da[1:] - r[:, None] * da[:-1])
        df += self.c[:, None] * (dv[1:] - r[:, None] * dv[:-1] - (r1 * v[:-1])[:, None] * da[:-1])
        slope = -self.d[:, None] * dv
        slope[0, -1] += 1.0
        slope[1:] -= df
        slope[:-1] += r[:, None] * df + (r1 * f)[:, None] * da[:-1]
        out = np.empty_like(y)
        out[:n, 0], out[:n, 1:] = v, dv
        out[n:, 0], out[n:, 1:] = acting / self.j, slope / self.j[:, None]
        return out

    def carried(self, start: Array, torque: float, speed: float, tolerance: float) -> tuple[Array, Array]:
        """The end (2n,) and its derivatives by start and torque (2n, 2n + 1), of a period."""
        size = 2 * self.n
        y = np.concatenate([start[:, None], np.eye(size), np.zeros((size, 1))], axis=1)
        made = solve_ivp(
            lambda t, flat: self.rates(torque, flat.reshape(y.shape)).ravel(), (0.0, np.pi / speed), y.ravel(),
            method="DOP853", rtol=tolerance, atol=tolerance * np.repeat([1.0, speed], self.n * y.shape[1]),
        )  # fmt: skip
        end = made.y[:, -1].reshape(y.shape)
        return end[:, 0], end[:, 1:]

    def closed(self, speed: float, torque: float, tolerance: float = 1e-11) -> Closed:
        """The motion of a mean ``speed`` [rad/s], from rigid shafts twisted by the first disk's ``torque`` [N m], which
        balances the loads."""
        n, x, unit = self.n, self.base(speed), np.repeat([1.0, speed], self.n)
        held = torque - self.d[0] * speed - np.concatenate([[0.0], np.cumsum(self.d[1:] * speed)])
        x[1:n] -= np.cumsum(held[:-1] / self.k)
        ahead = np.concatenate([np.full(n, np.pi), np.zeros(n)])
        for _ in range(30):
            end, slope = self.carried(x, torque, speed, tolerance)
            whole, left = np.zeros((2 * n + 1, 2 * n + 1)), np.zeros(2 * n + 1)
            whole[:-1, :-1] = slope[:, :-1] * unit / unit[:, None] - np.eye(2 * n)
            whole[:-1, -1], whole[-1, 0] = slope[:, -1] * self.k.max() / unit, 1.0
            left[:-1] = (end - x - ahead) / unit
            step = np.linalg.solve(whole, -left)
            if np.abs(step[:-1]).max() < 1e-10:
                return Closed(x, torque, slope[:, :-1] * unit / unit[:, None])
            x, torque = x + step[:-1] * unit, torque + step[-1] * self.k.max()
        raise ArithmeticError("no motion closes")
