"""What a task is: some blocks of a store, computed and written where they belong; it holds nothing else."""

from __future__ import annotations

import os
from functools import lru_cache
from pathlib import Path
from time import perf_counter

import numpy as np

from trunnion.errors import InputError
from trunnion.studies.parts import Part
from trunnion.studies.points import FAILED, Evaluated
from trunnion.studies.store import Store

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


def run_rows(path: str, identity: str, part: int, block: int, first: int, last: int) -> Evaluated:
    """What comes of some rows of a block, which is not written."""
    store, this = _opened(path, identity, part)
    return store.question.evaluated(this.design.paths, this.values(block)[first:last])


def where_it_runs(path: str) -> tuple[bool, int]:
    """Whether a worker sees the store, and its process."""
    return (Path(path) / "study.json").is_file(), os.getpid()


def _opened(path: str, identity: str, part: int) -> tuple[Store, Part]:
    store = _store(path, identity, part)
    return store, store.parts[part]


@lru_cache(maxsize=4)
def _store(path: str, identity: str, part: int) -> Store:
    store = Store.open(Path(path))
    if store.identity != identity or len(store.parts) <= part:
        raise InputError("is another study's by now", key="store", value=path, remedy="give another store")
    store.require_version()
    return store
