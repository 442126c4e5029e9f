"""Figure 2a: S1's chart by its equations in twists, mended, and a fixed-step Runge–Kutta of its own.

It shares neither equations nor integrator with the charts of this program, so their agreement is a check of both.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from trunnion.arrays import Array
from trunnion.papers.two_shaft_cardan.printed_matrices import matrices
from trunnion.results.chart import StabilityChart
from trunnion.results.verdict import verdicts

TOP = 1.2
"""Largest joint angle [rad]: beyond, the ratio turns so sharply that fixed steps would be many."""
PIXELS = (100, 60)
SLOWEST = 0.1
"""Lowest speed computed; steps grow with its inverse."""
STEP = 0.2
"""Largest phase of the fastest vibration in one step [rad]: the spectral radius then errs by 1e-5 or less."""
ERROR = 3e-5
"""Radii within this of 1 are drawn as undecided."""


def chart_in_twists(of: StabilityChart, gamma: float, damping_ratio: float = 0.001) -> StabilityChart:
    """The chart ``of`` (speed × joint angle) on fewer pixels, its verdicts from the equations in twists."""
    x = np.linspace(max(float(of.x[0]), SLOWEST), float(of.x[-1]), PIXELS[0])
    y = np.linspace(0.0, TOP, PIXELS[1])
    radius = spectral_radii(x, y, gamma, damping_ratio)
    error = np.full_like(radius, ERROR)
    found = replace(of.on(x, y), spectral_radius=radius, error_estimate=error)
    return replace(found, verdict=verdicts(radius, error, np.zeros(radius.shape, dtype=bool)))


def spectral_radii(speed: Array, angle: Array, gamma: float, damping_ratio: float) -> Array:
    """Spectral radii (angle, speed) of the derived equations over half a turn, α = μ = 1."""
    fastest = np.sqrt(1 / gamma + 1 + 1 / np.cos(angle.max()) ** 2) / speed.min()
    count = int(np.ceil(np.pi * fastest / STEP))
    h = np.pi / count
    state = np.zeros((len(angle), len(speed), 4, 4))  # twists and their rates, by column of the monodromy matrix
    state[..., :, :] = np.eye(4)

    def slope(tau: float, z: Array) -> Array:
        e, p = matrices("derived", np.asarray(tau), speed, angle[:, None], damping_ratio, 1.0, 1.0, gamma)
        return np.concatenate([z[..., 2:, :], -(p @ z[..., :2, :] + e @ z[..., 2:, :])], axis=-2)

    for i in range(count):
        a = slope(i * h, state)
        b = slope((i + 0.5) * h, state + h / 2 * a)
        c = slope((i + 0.5) * h, state + h / 2 * b)
        d = slope((i + 1) * h, state + h * c)
        state = state + h / 6 * (a + 2 * b + 2 * c + d)
    return np.asarray(np.abs(np.linalg.eigvals(state)).max(axis=-1))


def agreement(found: tuple[StabilityChart, ...], other: tuple[StabilityChart, ...]) -> str:
    """How far two pairs of charts differ, on the pixels of the first."""
    again = [b.on(a.x, a.y) for a, b in zip(found, other, strict=True)]
    pairs = list(zip(found, again, strict=True))
    differ = sum(int(np.sum((a.verdict != b.verdict) & (np.abs(b.spectral_radius - 1) > ERROR))) for a, b in pairs)
    off = max(float(np.nanmax(np.abs(a.spectral_radius - b.spectral_radius))) for a, b in pairs)
    return (
        f"{differ} of {sum(a.verdict.size for a in found)} pixels have another verdict than 2b; spectral radii differ "
        f"by up to {off:.0e}."
    )
