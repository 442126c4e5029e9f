"""Chains that are free–free and are run up by their first disk, in absolute angles, with scipy's integrators.

Disks φ_0 … φ_n in a row, a shaft between each two, some behind a Hooke's joint with tan ψ(χ) = tan χ / cos β:

    J_i φ_i″ = −f_i + ψ_{i+1}′ f_{i+1} + A_i cos(o_i φ_i + p_i) − (c0 + c1 φ_i′ + c2 |φ_i′| φ_i′) [i = n]
    f_i = k_i q_i + d_i q_i′,   q_i = φ_i − ψ_i(φ_{i−1})

The first disk drives with T(t) = load at Ω(t) + J Ω′(t) + extra, Ω rising by a constant acceleration that sets in as
½A(1 − cos πt/R), and holds its last torque behind the end. No frame that turns, no dense output of the package.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numba
import numpy as np
from scipy.integrate import odeint, solve_ivp

import trunnion as tn

QUARTER = np.pi / 2


@dataclass(frozen=True)
class Chain:
    """inertia (n + 1,), excitation (n + 1, 3): amplitude, order, phase of every disk; stiffness, damping, angle (n,) of
    every shaft and of the joint in front of it (0: none); load (3,): constant, by speed, by its square, of the last
    disk; first, last, rate, ramp: of the schedule."""

    inertia: np.ndarray
    excitation: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    angle: np.ndarray
    load: np.ndarray
    first: float
    last: float
    rate: float
    ramp: float

    @property
    def line(self) -> tn.Driveline:
        """The same as a description."""
        elements: list = []
        for i, inertia in enumerate(self.inertia):
            if i and self.angle[i - 1]:
                elements.append(tn.HookeJoint(angle=float(self.angle[i - 1])))
            if i:
                elements.append(tn.Shaft(stiffness=float(self.stiffness[i - 1]), damping=float(self.damping[i - 1])))
            size, order, phase = map(float, self.excitation[i])
            more: dict = {"excitation": [{"order": order, "amplitude": size, "phase": phase}]} if size else {}
            if i == 0:
                more["drive_share"] = 1.0
            if i == len(self.inertia) - 1:
                keys = ("load_torque", "viscous_load", "quadratic_load")
                more |= {key: float(value) for key, value in zip(keys, self.load, strict=True)}
            elements.append(tn.Disk(inertia=float(inertia), **more))
        return tn.Driveline(elements)

    @property
    def forks(self) -> np.ndarray:
        """Angle (n,) of the input fork of every joint from its plane at no rotation: a joint turns the forks behind it
        by a quarter turn."""
        return np.maximum(np.cumsum(self.angle > 0) - 1, 0) * QUARTER

    @property
    def sense(self) -> float:
        """+1 upwards."""
        return 1.0 if self.last > self.first else -1.0

    @property
    def duration(self) -> float:
        """Of the schedule [s]."""
        return abs(self.last - self.first) / self.rate + self.ramp / 2

    def asked(self, time: np.ndarray) -> np.ndarray:
        """Speed asked for (times,) [rad/s]."""
        t, ramp = np.asarray(time), self.ramp
        rising = t / 2 - ramp / (2 * np.pi) * np.sin(np.pi * t / ramp) if ramp else t
        gained = self.rate * np.where(t < ramp, rising, t - ramp / 2)
        return np.where(t < self.duration, self.first + self.sense * gained, self.last)

    @property
    def numbers(self) -> np.ndarray:
        """All of it in a row."""
        head = [len(self.inertia), self.first, self.last, self.sense * self.rate, self.ramp, self.duration]
        parts = [head, self.load, self.inertia, self.excitation.ravel(), self.stiffness, self.damping, self.angle]
        return np.concatenate([np.asarray(part, dtype=float) for part in [*parts, self.forks]])


@cache
def _rate():
    """The right-hand side, compiled when it is first asked for."""

    @numba.njit
    def asked(t, p):
        first, last, rate, ramp, end = p[1], p[2], p[3], p[4], p[5]
        if t >= end:
            return last, rate
        if t < ramp:
            return first + rate * (t / 2 - ramp / (2 * np.pi) * np.sin(np.pi * t / ramp)), rate * (
                1 - np.cos(np.pi * t / ramp)
            ) / 2
        return first + rate * (t - ramp / 2), rate

    @numba.njit
    def rhs(t, y, p, extra):
        n = int(p[0])
        load, inertia = p[6:9], p[9 : 9 + n]
        pushes = p[9 + n : 9 + 4 * n]
        at = 9 + 4 * n
        k, d, beta, fork = (
            p[at : at + n - 1],
            p[at + n - 1 : at + 2 * n - 2],
            p[at + 2 * n - 2 : at + 3 * n - 3],
            p[at + 3 * n - 3 :],
        )
        out = np.empty(2 * n)
        torque = np.zeros(n)
        omega, alpha = asked(t, p)
        torque[0] = load[0] + (load[1] + load[2] * omega) * omega + inertia.sum() * alpha + extra
        speed = y[2 * n - 1]
        torque[n - 1] -= load[0] + (load[1] + load[2] * abs(speed)) * speed
        for i in range(n):
            torque[i] += pushes[3 * i] * np.cos(pushes[3 * i + 1] * y[i] + pushes[3 * i + 2])
        for i in range(n - 1):
            psi, eta = y[i], 1.0
            if beta[i] > 0:
                chi, c = y[i] + fork[i], np.cos(beta[i])
                # Unwrapped: ψ − χ lies within a quarter turn.
                psi = y[i] + np.arctan2(np.sin(chi) * np.cos(chi) * (1 - c), c * np.cos(chi) ** 2 + np.sin(chi) ** 2)
                eta = c / (1 - np.sin(beta[i]) ** 2 * np.cos(chi) ** 2)
            f = k[i] * (y[i + 1] - psi) + d[i] * (y[n + i + 1] - eta * y[n + i])
            torque[i + 1] -= f
            torque[i] += eta * f
        for i in range(n):
            out[i], out[n + i] = y[n + i], torque[i] / inertia[i]
        return out

    return rhs


def run(chain: Chain, start: np.ndarray, extra: float, until: float, *, method: str, tolerance: float):
    """Times, and the rotation of the whole chain, Σ Jφ/Σ J, from absolute rotations and speeds ``start`` (2n,)."""
    rhs, p, n = _rate(), chain.numbers, len(chain.inertia)
    fastest = max(chain.first, chain.last)
    grid = np.linspace(0.0, until, max(int(until * fastest / (2 * np.pi) * 24), 100) + 1)
    absolute = tolerance * np.concatenate([np.full(n, 1e-2), np.full(n, 1e-2 * chain.first)])
    longest, share = 2 * np.pi / fastest, chain.inertia / chain.inertia.sum()
    if method == "LSODA":
        found = odeint(
            rhs, start, grid, (p, extra), rtol=tolerance, atol=absolute, hmax=longest, mxstep=10**6, tfirst=True
        )
        return grid, (found[:, :n] - found[0, :n]) @ share
    found = solve_ivp(
        rhs, (0.0, until), start, args=(p, extra), method=method, rtol=tolerance, atol=absolute, t_eval=grid,
        max_step=longest,
    )  # fmt: skip
    assert found.success, found.message
    return found.t, share @ (found.y[:n] - found.y[:n, :1])


def mean_speed(time: np.ndarray, turned: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Times, and the mean speed over the turn before each."""
    back = np.interp(turned - 2 * np.pi, np.maximum.accumulate(turned), time, left=np.nan)
    whole = np.isfinite(back)
    return time[whole], 2 * np.pi / (time[whole] - back[whole])


def reaches(chain: Chain, time: np.ndarray, turned: np.ndarray) -> bool:
    """Whether the mean speed over a turn is within 1 % of the range of what is asked over the same turn at the end of
    the schedule, or of the last speed later."""
    at, mean = mean_speed(time, turned)
    slack = 0.01 * abs(chain.last - chain.first)
    on_time = int(np.searchsorted(at, chain.duration)) - 1
    since = np.linspace(at[on_time] - 2 * np.pi / mean[on_time], at[on_time], 200)
    if chain.sense * (chain.asked(since).mean() - mean[on_time]) <= slack:
        return True
    late = at >= chain.duration
    return bool((chain.sense * (mean[late] - chain.last) >= -slack).any())


def keeps(chain: Chain, extra: float, hangs: float, *, tolerance: float) -> bool:
    """Whether the last torque, put on the chain at the last speed, keeps it nearer to that than to where it hangs."""
    n, until = len(chain.inertia), 2 * chain.duration + 60 * np.pi / min(chain.first, chain.last)
    there = replace(chain, first=chain.last * (1 - 1e-9 * chain.sense), ramp=0.0)
    start = np.concatenate([np.zeros(n), np.full(n, chain.last)])
    _, mean = mean_speed(*run(there, start, extra, until, method="LSODA", tolerance=tolerance))
    return bool(chain.sense * (mean[-1] - (chain.last + hangs) / 2) > 0)


def random_chain(seed: int) -> Chain:
    """A driving disk and one to four behind it, with a resonance of an order on the way; one in six runs down."""
    rng = np.random.default_rng(seed)
    n = 1 + seed % 4
    inertia = 10 ** rng.uniform(-1.0, 0.3, n + 1)
    stiffness = 10 ** rng.uniform(3.2, 4.3, n)
    damping = 2 * 10 ** rng.uniform(-2.6, -1.3) * stiffness / 80.0
    angle = np.where(rng.random(n) < 0.6, rng.uniform(0.1, 0.5, n), 0.0)
    excitation = np.zeros((n + 1, 3))
    for i in np.flatnonzero(rng.random(n + 1) < 0.5):
        excitation[i] = 10 ** rng.uniform(0.3, 1.8), rng.choice([0.5, 1.0, 2.0, 3.0]), rng.uniform(-3, 3)
    if not angle.any() and not excitation[:, 0].any():
        angle[0] = 0.4
    kind = int(rng.integers(4))
    load = np.array([rng.uniform(0, 30), 0.0, 0.0])
    load[1:] = np.where(np.array([kind == 1, kind == 2]), [rng.uniform(0.05, 0.4), rng.uniform(5e-4, 4e-3)], 0.0)
    # The lowest elastic mode, met by order 2 in the middle of the range or near it.
    mass, matrix = np.diag(inertia), np.zeros((n + 1, n + 1))
    for i, k in enumerate(stiffness):
        matrix[i : i + 2, i : i + 2] += k * np.array([[1, -1], [-1, 1]])
    mode = np.sqrt(np.sort(np.linalg.eigvals(np.linalg.inv(mass) @ matrix).real)[1])
    first = mode / 2 * rng.uniform(0.4, 0.8)
    last = mode / 2 * rng.uniform(1.3, 3.0)
    rate = (last - first) / 10 ** rng.uniform(0.0, 1.5)
    if rng.random() < 1 / 6:
        first, last = last, first
    return Chain(
        inertia, excitation, stiffness, damping, angle, load, first, last, rate, 0.2 * abs(last - first) / rate
    )
