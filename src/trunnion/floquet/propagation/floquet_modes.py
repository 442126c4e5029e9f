"""A periodic linear system over one period: its propagator, what is judged of its multipliers, its Floquet modes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.modes.mode_content import ModeMotion, floquet_pair
from trunnion.numerics.spectrum import multipliers, without
from trunnion.systems.periodic_linear import PeriodicLinearSystem

if TYPE_CHECKING:
    from trunnion.numerics.chain.dense_monodromy import Propagation

STEPS_PER_CYCLE = 4
FEWEST = 32
"""Steps of a period to begin with."""
MEANS = 64
"""Times over which the coefficients are averaged."""
SAMPLES, SAMPLES_PER_CYCLE = 128, 6
"""Of a Floquet mode over the period, at least; per cycle of the highest mode."""


def judged_multipliers(run: Propagation, aside: Array) -> tuple[Complex, Array]:
    """Multipliers and bounds on their errors, without those of the states ``aside`` (2n, k), kept for ever."""
    matrix, error = run.scaled_monodromy, np.array(run.error)
    if aside.shape[1]:
        matrix = without(matrix, aside / run.scale[:, None])[0]
    return multipliers(matrix, error)


def propagated(system: PeriodicLinearSystem, tolerance: float) -> Propagation:
    """The propagator, its error in energy-like units below ``tolerance``."""
    # Loaded here: it brings the compiler with it, and judging a line along its range does without.
    from trunnion.numerics.chain.dense_monodromy import propagate

    def arrays(tau: Array) -> tuple[Array, Array, Array, Array]:
        m = system.coefficients(tau)
        return m.mass, m.damping, m.stiffness, m.forcing

    # A step that leaps over cycles of the coefficients could agree with its half by accident.
    cycles = system.fastest * system.period / (2 * np.pi)
    least = 1 << int(np.ceil(np.log2(max(STEPS_PER_CYCLE * cycles, FEWEST))))
    return propagate(arrays, system.period, system.size, tolerance, least)


def floquet_mode(system: PeriodicLinearSystem, run: Propagation, multiplier: complex) -> ModeMotion | None:
    """How the Floquet mode of a multiplier and its adjoint move over the period; None for a double multiplier."""
    pair = floquet_pair(run.scaled_monodromy, multiplier)
    if pair is None:
        return None
    start, last = pair[0] * run.scale, pair[1] / run.scale
    at_rest = run.states(np.zeros(2 * system.size), SAMPLES)
    parts = [run.states(np.ascontiguousarray(part), SAMPLES) - at_rest for part in (start.real, start.imag)]
    states = (parts[0] + 1j * parts[1])[:-1]
    mean = system.coefficients(system.period * np.arange(MEANS) / MEANS)
    # Enough for the highest mode: steps are a power of two, at least as many.
    cycles = max((*system.frequencies, system.fastest)) * system.period / (2 * np.pi)
    count = min(len(states), max(SAMPLES, 1 << int(np.ceil(np.log2(max(SAMPLES_PER_CYCLE * cycles, 1))))))
    return ModeMotion(
        states[:: len(states) // count],
        run.adjoint(last, count)[:-1],
        np.log(complex(multiplier)) / system.period,
        system.period,
        mean.mass.mean(0),
        mean.stiffness.mean(0),
    )
