"""A motion followed sample by sample, with a frame of tangents whose growth is measured."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.numerics.compiled import kernel_file
from trunnion.numerics.integration.integration import TOLERANCE, Equations, IntegrationEnd

CHUNK = 512
"""Samples between two looks of the interpreter."""
MOST_STEPS = 1_000_000
"""Of the integrator in one sample."""


@cache
def kernel() -> ModuleType:
    """The compiled loop."""
    here = Path(__file__)
    return kernel_file(str(here.with_name("tangent_kernel.py")), str(here.with_name("integration_kernel.py")))


@dataclass(frozen=True)
class Samples:
    """growth (samples, k): logarithmic growth of each vector of the frame over each sample; states (samples, n)
    at the end of each; divergence (samples,): ∫ tr ∂f/∂x dt, zero unless asked for; end: how it ended. What was
    computed before a failure is there."""

    growth: Array
    states: Array
    divergence: Array
    end: IntegrationEnd

    @property
    def finished(self) -> int:
        """Number of samples."""
        return len(self.states)


@dataclass
class Motion:
    """A motion and a frame of tangents on their way; ``run`` carries both on.

    Parameters
    ----------
    state : where it is (n,), at ``time`` [s]. frame (k, n) : rows to carry along, none for (0, n).
    interval : of a sample [s].
    wrap : the forcing period, so that time stays small: it is kept below this, exactly where ``interval`` is a
        multiple of it. 0 for an autonomous system, whose time is put back to 0 at each sample.
    """

    equations: Equations
    state: Array
    frame: Array
    interval: float
    wrap: float = 0.0
    time: float = 0.0
    regime: int = 0
    tolerance: float = TOLERANCE
    most_steps: int = MOST_STEPS
    _clock: Array = field(init=False, repr=False)
    _whole: Integers = field(init=False, repr=False)
    _block: Array = field(init=False, repr=False)
    _numbers: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        self._clock = np.array([self.time, 0.0, -np.inf, 0.0])
        self._whole = np.array([self.regime, 0, 0, 0, 0, 0, 1], dtype=np.int64)
        # A right-hand side may keep its scratch space behind its numbers, so threads must not share them.
        self._numbers = self.equations.numbers.copy()
        self._block = np.concatenate([np.ravel(self.state), np.ravel(self.frame)]).astype(float)
        count, n = len(self.frame), self.equations.size
        kernel().orthonormalise(self._block[n:].reshape(count, n), self.equations.weight, np.zeros(count))

    def run(self, samples: int, *, traced: bool = False) -> Samples:
        """Carry on over ``samples`` samples, or until it fails; ``traced`` integrates the divergence too."""
        e, n, count = self.equations, self.equations.size, len(self.frame)
        functions = np.array([e.rate, e.guard, e.jump, 0], dtype=np.int64)
        growth, states, divergence = np.empty((samples, count)), np.empty((samples, n)), np.empty(samples)
        end, done = IntegrationEnd.REACHED, 0
        while done < samples and end is IntegrationEnd.REACHED:
            part = slice(done, min(done + CHUNK, samples))
            before = self._block[:n].copy()
            code, finished = kernel().follow(
                functions, self._numbers, self._block, n, count, e.transitions, e.directions, e.weight, self._clock,
                self._whole, float(self.interval), float(self.wrap), float(self.tolerance), int(self.most_steps),
                traced, growth[part], states[part], divergence[part],
            )  # fmt: skip
            end, done = IntegrationEnd(code), done + finished
            self.state = states[done - 1].copy() if finished else before
        self.frame = self._block[n:].reshape(count, n).copy()
        self.time, self.regime = float(self._clock[0]), int(self._whole[0])
        return Samples(growth[:done], states[:done], divergence[:done], end)
