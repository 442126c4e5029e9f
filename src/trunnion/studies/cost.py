"""What a study will cost, from a few points that are timed: processor time, bytes and files."""

from __future__ import annotations

from collections.abc import Iterator
from time import process_time

import numpy as np

from trunnion.numerics.memory import size_text
from trunnion.results.counts import counted
from trunnion.results.durations import time_text
from trunnion.results.fields import attribute, internal, labelled
from trunnion.results.result import Result
from trunnion.studies.description import StudyPlan
from trunnion.studies.design import in_axes
from trunnion.studies.quantities import LETTERS
from trunnion.studies.refinement import Lattice
from trunnion.studies.store import part_of

ENOUGH = 0.5
"""Seconds of timing after which no further point is tried."""
MOST = 8
"""Points that are tried one by one."""
OF_BATCH = 4096
"""Points of the batch that is timed."""
POINTS_A_CORNER = 1.25
"""New points of a cell that is halved, by its corners: 4 of 4 corners of a flat boundary, 10 of 8 were counted."""
OVERHEAD = 0.03
"""Share of engine and store: an estimate for tasks of a second."""


@labelled
class StudyCost(Result):
    """What a study will take: of points that were timed, and the least where they differ much."""

    points: int = attribute("in all")
    blocks: int = attribute("that is files until shards are made of them")
    shards: int = attribute("files of every array in the end")
    seconds_a_point: float = attribute("processor time", "s")
    least: float = attribute("of a point that was timed", "s")
    most: float = attribute("of a point that was timed", "s")
    timed: int = attribute("points that were")
    batched: bool = attribute("whether the compiled batch answers")
    bytes: int = attribute("in the store at most, before compression")
    workers: int = attribute("that share it")
    at_boundary: int = attribute("further points, where the boundary crosses the grids once: an estimate", default=0)
    shape: tuple[int, ...] = internal("points of the sampling plan and along the axes", default=())

    @property
    def seconds(self) -> float:
        """Processor time of all points [s]."""
        return (self.points + self.at_boundary) * self.seconds_a_point

    @property
    def elapsed(self) -> float:
        """Time on the workers, each of which has a processor [s]."""
        return self.seconds * (1 + OVERHEAD) / self.workers

    def _lines(self) -> Iterator[str]:
        where = f"{counted(self.blocks, 'block')}, {counted(self.shards, 'shard')}"
        yield f"{counted(self.points, 'point')}{in_axes(self.shape)} in {where}"
        if self.at_boundary:
            yield f"  and about {self.at_boundary} at a boundary that crosses the grids once"
        how = (
            "by the compiled batch"
            if self.batched
            else f"{time_text(self.least)} to {time_text(self.most)}, one by one"
        )
        yield f"  {time_text(self.seconds_a_point)} a point ({how}; {self.timed} timed)"
        on = counted(self.workers, "worker")
        yield f"  {time_text(self.seconds)} of processor time, about {time_text(self.elapsed)} on {on}"
        yield f"  at most {size_text(self.bytes)} in the store"


def cost_of(plan: StudyPlan, workers: int) -> StudyCost:
    """Time a few points of a plan, all over it, and multiply."""
    question, design = plan.question, plan.design
    part = part_of(0, design, (), plan.block)
    taken: list[float] = []
    if question.batched:
        count = min(OF_BATCH, design.size)
        values = design.values(np.arange(count))
        question.evaluated(design.paths, values[:64])  # whatever compiles, compiles
        begun = process_time()
        question.evaluated(design.paths, values)
        taken = [(process_time() - begun) / count]
        timed = count
    else:
        numbers = np.random.default_rng(0).permutation(min(design.size, 1 << 20))[: MOST + 1]
        numbers = (numbers * (design.size / min(design.size, 1 << 20))).astype(np.intp)
        question.evaluated(design.paths, design.values(numbers[:1]))
        for number in numbers[1:] if len(numbers) > 1 else numbers:
            begun = process_time()
            question.evaluated(design.paths, design.values(np.array([number])))
            taken.append(process_time() - begun)
            if sum(taken) > ENOUGH:
                break
        timed = len(taken)
    each = sum(LETTERS if q.kind == "word" else 8 for q in question.quantities) + 8 * len(design.paths) + 1
    further = 0 if plan.refinement is None else at_boundary(Lattice(design, plan.refinement.halvings))
    return StudyCost(
        points=design.size, blocks=part.blocks, shards=part.shards, seconds_a_point=float(np.mean(taken)),
        least=min(taken), most=max(taken), timed=timed, batched=question.batched,
        bytes=(design.size + further) * each, workers=workers, at_boundary=further, shape=design.shape,
    )  # fmt: skip


def at_boundary(lattice: Lattice) -> int:
    """Points that a flat boundary asks for which crosses the grids once, the way on which it meets most cells."""
    cells = lattice.cells(0).astype(float)
    size = int(lattice.refined.sum())
    crossed = np.prod(cells) / cells[lattice.refined].min()
    halved = sum(crossed * 2.0 ** (level * (size - 1)) for level in range(lattice.depth))
    return int(POINTS_A_CORNER * 2**size * halved)
