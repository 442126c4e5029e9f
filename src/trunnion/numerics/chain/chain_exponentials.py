"""Monodromy matrices of chosen lanes by a chosen number of exponential steps: what stiff lines are charted from."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from trunnion.arrays import Array, Places
from trunnion.numerics.chain.chain_tables import ChainBatch, ChainProgram
from trunnion.numerics.chain.exponential_batch import TOGETHER, integrate_exponentials


@dataclass(frozen=True)
class ChainExponentials:
    """Lines as lanes over one ``period`` of input angle; ``steps``: as many as see their fastest coefficient."""

    program: ChainProgram
    batch: ChainBatch
    period: float
    steps: int

    def __post_init__(self) -> None:
        assert self.steps % TOGETHER == 0

    @property
    def count(self) -> int:
        """Number of lanes."""
        return int(self.batch.stiffness.shape[1])

    @property
    def states(self) -> int:
        """Size of the matrices."""
        return 2 * int(self.batch.stiffness.shape[0])

    def monodromies(self, which: Places, steps: int) -> tuple[Array, Array]:
        """Z (lane, m, m) in scaled units and ∫ tr(M⁻¹C) dτ (lane,) of the lanes ``which``, by so many steps."""
        matrix, trace = np.empty((len(which), self.states, self.states)), np.empty(len(which))
        integrate_exponentials(self.program, self.batch, which, self.period, steps, matrix, trace)
        return matrix, trace

    def and_also(self, other: ChainExponentials) -> ChainExponentials:
        """These lanes and then those of ``other``, of the same program."""
        pairs = zip(self.batch, other.batch, strict=True)
        return replace(self, batch=ChainBatch(*(np.concatenate(pair, axis=-1) for pair in pairs)))
