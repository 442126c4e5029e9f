"""What a task is: some blocks of a store, computed and written where they belong; it holds nothing else."""

from __future__ import annotations

import os
from functools import lru_cache
from pathlib import Path
from time import perf_counter

import numpy as np

from trunnion.errors import InputError
from trunnion.studies.parts import StudyPart
from trunnion.studies.points import FAILED, Evaluated, StudyQuestion
from trunnion.studies.store import Store, joined

DIED = "the process that computed this point alone died, twice: out of memory, or a crash of compiled code"
Done = tuple[int, int, int, float]
"""Of a block: its number, points, how many failed, seconds."""


def run_blocks(path: str, identity: str, part: int, blocks: tuple[int, ...]) -> list[Done]:
    """Compute blocks of a part and write them; those that are there by now are left.

    Raises
    ------
    InputError : the store is another study's, or other versions'.
    ComputationError : the disk is full or fails.
    """
    store, this = _opened(path, identity, part)
    found: list[Done] = []
    for block in blocks:
        begun = perf_counter()
        values = this.values(block)
        made = store.question.evaluated(this.design.paths, values)
        seconds = perf_counter() - begun
        store.put(this, block, values, made, seconds)
        found.append((block, len(values), int(np.count_nonzero(made.status == FAILED)), seconds))
    return found


def run_alone(path: str, identity: str, part: int, block: int, dead: tuple[int, ...], trace: str) -> Evaluated:
    """What comes of a block, point by point, those that are known to be ``dead`` left out; nothing is written but to
    ``trace``: a line for every beginning, then one for each point before it is computed."""
    store, this = _opened(path, identity, part)
    values, found = this.values(block), []
    _note(trace, "begin")
    for row in range(len(values)):
        if row in dead:
            found.append(died(store.question))
            continue
        _note(trace, str(row))
        found.append(store.question.evaluated(this.design.paths, values[row : row + 1]))
    return joined(found)


def _note(trace: str, line: str) -> None:
    with open(trace, "a", encoding="ascii") as file:
        file.write(f"{line}\n")


def rows_of_deaths(trace: Path) -> list[int]:
    """The point that each beginning came to last; −1 where it came to none."""
    if not trace.is_file():
        return []
    found: list[int] = []
    for line in trace.read_text(encoding="ascii").split("\n")[:-1]:
        if line == "begin":
            found.append(-1)
        else:
            found[-1] = int(line)
    return found


def died(question: StudyQuestion) -> Evaluated:
    """What is kept of one point whose process died."""
    values = {one.path: one.empty(1) for one in question.quantities}
    return Evaluated(np.array([FAILED], dtype=np.uint8), values, {0: DIED})


def where_it_runs(path: str) -> tuple[bool, int]:
    """Whether a worker sees the store, and its process."""
    return (Path(path) / "study.json").is_file(), os.getpid()


def _opened(path: str, identity: str, part: int) -> tuple[Store, StudyPart]:
    store = _store(path, identity, part)
    return store, store.parts[part]


@lru_cache(maxsize=4)
def _store(path: str, identity: str, part: int) -> Store:
    store = Store.open(Path(path))
    if store.identity != identity or len(store.parts) <= part:
        raise InputError("is another study's by now", key="store", value=path, remedy="give another store")
    store.require_version()
    return store
