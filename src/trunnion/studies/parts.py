"""The parts of a store: the first study, and what each extension of it adds; every part in blocks of its own.

A part holds the points of its design that no earlier part has, in the order of the design. Which points a block holds
follows from the designs alone, never from what is done or when.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from trunnion.arrays import Array, Places
from trunnion.studies.design import StudyDesign, missing_from
from trunnion.studies.refinement import Refinement

AT_ONCE = 1 << 18
"""Points of a design that are looked up together."""


@dataclass(frozen=True)
class StudyPart:
    """Number ``number`` of a store: a design less what the ``earlier`` ones have, in blocks and shards of points.

    block : points of a block. shard : of a shard, a whole number of blocks.
    refinement : the boundary that a part is there to find, and ``first`` the points that its first grid has along each
        axis.
    """

    number: int
    design: StudyDesign
    earlier: tuple[StudyDesign, ...]
    block: int
    shard: int
    refinement: Refinement | None = None
    first: tuple[int, ...] = ()

    @property
    def content(self) -> dict[str, Any]:
        """As JSON keeps it; the earlier designs stand in their own parts."""
        boundary = {"boundary": self.refinement.content, "first": list(self.first)} if self.refinement else {}
        return {
            "number": self.number, "design": self.design.content, "block": self.block, "shard": self.shard,
            "points": self.points, **boundary,
        }  # fmt: skip

    @classmethod
    def of_content(cls, content: Mapping[str, Any], earlier: tuple[StudyDesign, ...]) -> StudyPart:
        """What ``content`` says."""
        refinement = Refinement.of_content(content["boundary"]) if "boundary" in content else None
        return cls(
            content["number"], StudyDesign.of_content(content["design"]), earlier, content["block"], content["shard"],
            refinement, tuple(content.get("first", ())),
        )  # fmt: skip

    @cached_property
    def _before(self) -> Array | None:
        """New points before each stretch of ``AT_ONCE`` of the design, and in all; None where all are new."""
        if not self.earlier or self.design.chosen is not None:  # these were chosen because nobody has them
            return None
        counts = [int(missing_from(self.design, self.earlier, some).sum()) for some in _stretches(self.design.size)]
        return np.concatenate([[0], np.cumsum(counts)]).astype(np.intp)

    @cached_property
    def points(self) -> int:
        """New points in all."""
        return self.design.size if self._before is None else int(self._before[-1])

    @property
    def blocks(self) -> int:
        """How many there are."""
        return -(-self.points // self.block)

    @property
    def shards(self) -> int:
        """How many there are."""
        return -(-self.points // self.shard)

    @property
    def blocks_a_shard(self) -> int:
        """Of every shard but the last, which may have fewer."""
        return self.shard // self.block

    def rows(self, block: int) -> tuple[int, int]:
        """First row of a block, and the one after its last."""
        return block * self.block, min((block + 1) * self.block, self.points)

    def shard_rows(self, shard: int) -> tuple[int, int]:
        """The same of a shard."""
        return shard * self.shard, min((shard + 1) * self.shard, self.points)

    def blocks_of(self, shard: int) -> range:
        """Blocks of a shard."""
        return range(shard * self.blocks_a_shard, min((shard + 1) * self.blocks_a_shard, self.blocks))

    def numbers(self, first: int, last: int) -> Places:
        """Numbers in the design of the rows ``first`` to ``last``."""
        if self._before is None:
            return np.arange(first, last, dtype=np.intp)
        begin = int(np.searchsorted(self._before, first, side="right")) - 1
        found: list[Places] = []
        have = int(self._before[begin])
        for some in _stretches(self.design.size, begin):
            new = some[missing_from(self.design, self.earlier, some)]
            found.append(new)
            have += len(new)
            if have >= last:
                break
        start = first - int(self._before[begin])
        return np.concatenate(found)[start : start + last - first]

    def values(self, block: int) -> Array:
        """Values (points, parameters) of a block."""
        return self.design.values(self.numbers(*self.rows(block)))


def _stretches(size: int, first: int = 0) -> Iterator[Places]:
    for begin in range(first * AT_ONCE, size, AT_ONCE):
        yield np.arange(begin, min(begin + AT_ONCE, size), dtype=np.intp)
