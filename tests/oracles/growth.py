"""Whether a disturbance of a ``ScannedLine`` grows: multipliers over one period, by Magnus steps of fourth order."""

from __future__ import annotations

from fractions import Fraction
from math import ceil

import numpy as np
from numpy.typing import NDArray

from oracles.line_equations import Steady, common
from oracles.steady_orders import Solved

Array = NDArray[np.float64]
COARSE, FINE = 1.5, 6.0
"""Steps per radian of the fastest mode: to look around, and where growth is nearly none."""
NEARLY = 0.1
"""Growth [1/s] below the size of which it is computed with fine steps."""
MOST_STEPS = 4000
TERMS = 10
"""Of the series of an exponential."""


def growth(line: Steady, speed: Array, *, of_speed: bool) -> Array:
    """ln of the largest multiplier over its period (speed,) [1/s], a shift of the phase of a free line left out; NaN
    where a period takes too many steps.

    Where no torque depends on the speed, that of the mean speed is stated by itself: real and positive, but near a
    resonance no one can say which of several it is. Without ``of_speed`` all such multipliers are left out.
    """
    found = np.full(len(speed), np.nan)
    for per_radian in (COARSE, FINE):
        which = np.arange(len(speed)) if per_radian == COARSE else np.flatnonzero(np.abs(found) < NEARLY)
        for start in range(0, len(which), 64):
            part = which[start : start + 64]
            found[part] = _growth(line, speed[part], per_radian, of_speed)
    return found


def _growth(line: Steady, speed: Array, per_radian: float, of_speed: bool) -> Array:
    n = line.n
    rates = [*line.joint_rates, *(line.teeth[e] * o for e, (_, one) in enumerate(line.links) for _, o, _ in one.waves)]
    span = 2 * max(1, ceil(max(line.joint_rates, default=Fraction(0)) / line.step) * 8)
    solved = Solved(line, speed, [m * line.step for m in range(-span // 2, span // 2 + 1)])
    period = 2 * np.pi / (float(common(rates)) * speed)
    fastest = np.sqrt(2 * np.abs(np.einsum("sii->si", solved.stiffness[Fraction(0)])) / solved.inertia).max(axis=1)
    turning = max(abs(float(o)) for o in (*solved.stiffness, *solved.damping)) * speed
    steps = np.ceil(per_radian * np.maximum(fastest, turning / 4) * period)
    good = steps <= MOST_STEPS
    found = np.full(len(speed), np.nan)
    if not good.any():
        return found
    count = int(steps[good].max())
    h = period[good] / count
    product = np.broadcast_to(np.eye(2 * n), (int(good.sum()), 2 * n, 2 * n)).copy()
    off = np.sqrt(3) / 6
    for j in range(count):
        first, last = (_rates(solved, good, speed[good], (j + 0.5 + shift) * h) for shift in (-off, off))
        both = h[:, None, None] / 2 * (first + last)
        both += np.sqrt(3) / 12 * (h**2)[:, None, None] * (last @ first - first @ last)
        product = _exponential(both) @ product
    finite = np.isfinite(product).all(axis=(1, 2))
    values = np.linalg.eigvals(np.where(finite[:, None, None], product, 0.0))
    if line.line.free:
        values = np.take_along_axis(values, np.argsort(np.abs(values - 1), axis=1)[:, 1:], axis=1)
        if not of_speed and not any(m.viscous or m.quadratic for m in line.line.masses):
            values = np.where((np.abs(values.imag) < 1e-9) & (values.real > 0), 0.0, values)
    with np.errstate(divide="ignore"):
        found[good] = np.where(finite, np.log(np.abs(values).max(axis=1)) / period[good], np.nan)
    return found


def _rates(solved: Solved, good: Array, speed: Array, time: Array) -> Array:
    """A (speed, 2n, 2n) of x′ = Ax, x = (δ, δ̇), at a ``time`` (speed,) [s]."""
    n = solved.n
    parts = []
    for series in (solved.stiffness, solved.damping):
        total = np.zeros((len(speed), n, n))
        for order, part in series.items():
            if order >= 0:  # of a real matrix the coefficients at −h are conjugates
                turn = np.exp(1j * float(order) * speed * time)[:, None, None]
                total += (2.0 if order else 1.0) * (part[good] * turn).real
        parts.append(total / solved.inertia[:, None])
    a = np.zeros((len(speed), 2 * n, 2 * n))
    a[:, :n, n:] = np.eye(n)
    a[:, n:, :n], a[:, n:, n:] = -parts[0], -parts[1]
    return a


def _exponential(a: Array) -> Array:
    """Of small matrices, their entries of one size first: rotations times 100, as frequencies are some hundred."""
    unit = np.ones(a.shape[1])
    unit[: len(unit) // 2] = 100.0
    scaled = a * unit[:, None] / unit
    total = np.broadcast_to(np.eye(a.shape[1]), a.shape).copy()
    for k in range(TERMS, 0, -1):
        total = np.eye(a.shape[1]) + scaled @ total / k
    return total / unit[:, None] * unit
