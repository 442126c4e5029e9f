"""The gear pair of the rattle paper and the dead-zone oscillator."""

from __future__ import annotations

from math import pi

from trunnion.systems.piecewise_oscillator import PiecewiseOscillator

HALF_GAP = pi / 18


def gear_pair(mean_force: float = 0.05, frequency: float = 0.8) -> PiecewiseOscillator:
    return PiecewiseOscillator.gap(
        HALF_GAP, inside=0.25, damping=0.05, mean_force=mean_force, force=0.03, frequency=frequency
    )


def dead_zone(frequency: float = 0.6) -> PiecewiseOscillator:
    return PiecewiseOscillator.gap(1.0, damping=0.1, mean_force=0.1, force=0.05, frequency=frequency)
