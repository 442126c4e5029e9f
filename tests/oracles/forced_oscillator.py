"""One oscillator with most of the usual laws, and what its motion is, by an integrator of its own (Runge–Kutta, fixed
steps): x″ + d x′ + (a + q cos ωt) x + b x³ + s max(|x| − 1, 0) sign x + g sin x = c + F cos ωt.

The package's own equations of it (``oscillator``) are written apart from these.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numba import njit

import trunnion as tn

NAMES = ("d", "a", "q", "b", "s", "g", "c", "force", "frequency")
STEPS = 384
"""Of a forcing period: relative errors of 1e-9 in a period."""


def oscillator(start: tuple[float, float] = (0.1, 0.0), **values: float) -> tn.System:
    """The oscillator as a system of the package; what is not given is 0, the frequency 1."""
    full = dict.fromkeys(NAMES, 0.0) | {"frequency": 1.0} | values
    return _system().with_parameters(full).with_fields(start=np.array(start))


@cache
def _system() -> tn.System:
    def rate(t, x, p):  # type: ignore[no-untyped-def]
        beyond = max(abs(x[0]) - 1.0, 0.0) * np.sign(x[0])
        wave = np.cos(p.frequency * t)
        spring = (p.a + p.q * wave) * x[0] + p.b * x[0] ** 3 + p.s * beyond + p.g * np.sin(x[0])
        return x[1], p.c + p.force * wave - p.d * x[1] - spring

    return tn.System.from_function(
        rate, ["x", "v"], parameters=dict.fromkeys(NAMES, 1.0), period=lambda p: 2 * np.pi / p["frequency"],
        start=[0.1, 0.0], name="oscillator",
    )  # fmt: skip


@njit  # type: ignore[untyped-decorator]
def _rates(phase, y, n, out):  # type: ignore[no-untyped-def]
    d, a, q, b, s, g, c, force, frequency = n
    x, v, dx, dv = y
    wall = 0.0
    slope = 0.0
    if x > 1.0:
        wall, slope = x - 1.0, s
    elif x < -1.0:
        wall, slope = x + 1.0, s
    hold = a + q * np.cos(phase)
    out[0] = v
    out[1] = c + force * np.cos(phase) - d * v - hold * x - b * x * x * x - s * wall - g * np.sin(x)
    out[2] = dv
    out[3] = -d * dv - (hold + 3 * b * x * x + slope + g * np.cos(x)) * dx


@njit  # type: ignore[untyped-decorator]
def _strobed(state, numbers, periods, steps, points):  # type: ignore[no-untyped-def]
    """Points once per period into ``points`` (periods, 2); returns the growth of a tangent vector over all."""
    h = 2 * np.pi / numbers[8] / steps
    y = np.array([state[0], state[1], 0.6, 0.8])
    k = np.zeros((4, 4))
    growth = 0.0
    for i in range(periods):
        for j in range(steps):
            at = 2 * np.pi * j / steps
            _rates(at, y, numbers, k[0])
            _rates(at + np.pi / steps, y + 0.5 * h * k[0], numbers, k[1])
            _rates(at + np.pi / steps, y + 0.5 * h * k[1], numbers, k[2])
            _rates(at + 2 * np.pi / steps, y + h * k[2], numbers, k[3])
            y += h / 6 * (k[0] + 2 * k[1] + 2 * k[2] + k[3])
        size = np.hypot(y[2], y[3])
        growth += np.log(size)
        y[2:] /= size
        points[i] = y[:2]
        if abs(y[0]) + abs(y[1]) > 1e6:
            return np.inf
    return growth


def what_it_is(system: tn.System, state: np.ndarray, periods: int = 6000) -> tuple[str, int]:
    """("periodic", k), ("chaotic", 0), ("unbounded", 0) or ("other", 0): the motion that goes on from ``state``."""
    numbers = tuple(float(system.parameters[name]) for name in NAMES)
    points = np.empty((periods, 2))
    growth = _strobed(np.asarray(state, dtype=float), numbers, periods, STEPS, points)
    if not np.isfinite(growth):
        return "unbounded", 0
    late = points[-256:]
    turns = numbers[1] == numbers[2] == numbers[3] == numbers[4] == 0.0
    for k in range(1, 65):
        apart = late[k:] - late[:-k]
        if turns:
            apart[:, 0] = np.angle(np.exp(1j * apart[:, 0]))
        if np.abs(apart).max() < 1e-8 * (1 + np.abs(late).max()):
            return "periodic", k
    rate = growth / periods / (2 * np.pi / numbers[8])
    return ("chaotic", 0) if rate > 0.01 else ("other", 0)
