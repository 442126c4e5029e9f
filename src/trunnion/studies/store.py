"""A store of a study: a folder that several may write to, on network disks too, with no locks.

::

    truck.zarr/study.json             whose points these are: line, analysis, quantities, versions; where they come from
    truck.zarr/part-0/part.json       the points of a part, in blocks and shards
    truck.zarr/part-0/blocks/         a file of every block that is done, until its shard is whole
    truck.zarr/part-0/shards/         a note of every shard that is whole
    truck.zarr/part-0/<name>/         arrays of Zarr v3 over ``point``: parameters, quantities, status

Every file is made under another name and renamed once it is on the disk, and none is changed afterwards. Who computes
a block twice writes the same file twice.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import sys
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from trunnion.errors import ComputationError, InputError
from trunnion.numerics.versions import computed_by
from trunnion.studies.block_files import DamagedBlock, address, read_block, write_block
from trunnion.studies.design import StudyDesign, refuse_latin
from trunnion.studies.extra import zarr
from trunnion.studies.parts import StudyPart
from trunnion.studies.points import FAILED, Evaluated, StudyQuestion
from trunnion.studies.refinement import Refinement
from trunnion.studies.shards import (
    DamagedShard,
    array_names,
    check_shard,
    make_arrays,
    note_of,
    read_note,
    read_shard,
    write_shard,
)
from trunnion.writing import folder_made_durably, folder_to_disk, sweep

FORMAT = 1
SHARD = 1 << 16
"""Points of a shard, where blocks are smaller than that."""
KEEP_NAME = "give another store"


@dataclass
class PartState:
    """What is there of a part: shards that are whole, and blocks outside of them that are done."""

    shards: set[int] = field(default_factory=set)
    blocks: set[int] = field(default_factory=set)

    def has(self, part: StudyPart, block: int) -> bool:
        """Whether a block is done."""
        return block in self.blocks or block // part.blocks_a_shard in self.shards


@dataclass
class Store:
    """A store that is open, by its path; ``question`` and ``parts`` are what it says of itself."""

    path: Path
    question: StudyQuestion
    about: Mapping[str, Any]
    parts: tuple[StudyPart, ...]

    @classmethod
    def create(
        cls, path: Path, question: StudyQuestion, design: StudyDesign, block: int, came_from: str,
        refinement: Refinement | None = None,
    ) -> Store:  # fmt: skip
        """Make the store, or open the one that somebody else made meanwhile.

        Raises
        ------
        InputError : the folder cannot be made, or is not a store, or another study's.
        """
        if path.exists() and not (path / "study.json").is_file() and (not path.is_dir() or any(path.iterdir())):
            raise InputError("exists, and is not a store of a study", key="store", value=str(path), remedy=KEEP_NAME)
        if not path.parent.is_dir():
            raise InputError("cannot be made, its folder does not exist", key="store", value=str(path),
                             remedy=f"create the folder {path.parent}")  # fmt: skip
        if not (path / "study.json").is_file():
            part = part_of(0, design, (), block, refinement, design.shape)
            if path.is_dir():
                path.rmdir()  # empty: somebody made it for us
            with folder_made_durably(path) as made:
                about = {
                    "format": FORMAT, "identity": question.identity, "question": question.content,
                    "computed_by": computed_by(), "provenance": _provenance(came_from),
                }  # fmt: skip
                group = {"study": question.analysis, "identity": question.identity, **computed_by()}
                zarr().open_group(str(made), mode="w", zarr_format=3, attributes=group)
                (made / "study.json").write_text(_sealed(about))
                _fill_part(made / "part-0", part, question)
        return cls.open(path).require(question)

    @classmethod
    def open(cls, path: Path) -> Store:
        """The store at ``path``.

        Raises
        ------
        InputError : there is none; it is damaged, or of another format.
        """
        if not (path / "study.json").is_file():
            raise InputError("is not a store of a study", key="store", value=str(path),
                             remedy="name the folder that a study wrote, truck.zarr say")  # fmt: skip
        about = _unsealed(path / "study.json")
        if about["format"] != FORMAT:
            raise InputError(f"is of format {about['format']}, and this version reads {FORMAT}", key="store",
                             value=str(path), remedy="use the version of Trunnion that wrote it")  # fmt: skip
        parts: list[StudyPart] = []
        while (path / f"part-{len(parts)}" / "part.json").is_file():
            content = _unsealed(path / f"part-{len(parts)}" / "part.json")
            parts.append(StudyPart.of_content(content, tuple(part.design for part in parts)))
        return cls(path, StudyQuestion.of_content(about["question"]), about, tuple(parts))

    @property
    def identity(self) -> str:
        """Whose points these are, as it was written."""
        return str(self.about["identity"])

    def require(self, question: StudyQuestion) -> Store:
        """Itself, if it is the store of this question, by this version.

        Raises
        ------
        InputError : it is another study's, or another version's.
        """
        self.require_version()
        if question.identity == self.identity:
            return self
        theirs, ours = self.question.content, question.content
        differ = [key for key in theirs if theirs[key] != ours[key]]
        problem = f"holds another study: it differs in its {' and '.join(differ)}"
        raise InputError(problem, key="store", value=str(self.path), remedy=KEEP_NAME)

    def require_version(self) -> None:
        """Refuse to add to what another version computed.

        Raises
        ------
        InputError : what computed it is not at hand.
        """
        theirs, ours = self.about["computed_by"], computed_by()
        if theirs != ours:
            differ = [f"{key} {theirs.get(key)}, here {ours[key]}" for key in ours if theirs.get(key) != ours[key]]
            raise InputError(f"was computed by other versions ({'; '.join(differ)}), which are never mixed",
                             key="store", value=str(self.path),
                             remedy="use the same versions, or give another store")  # fmt: skip

    def extended(
        self, design: StudyDesign, block: int, refinement: Refinement | None = None, first: tuple[int, ...] = ()
    ) -> Store:
        """The store with a part that has what ``design`` asks for and no part has yet; itself where there is nothing.

        Raises
        ------
        InputError : a Latin hypercube of another size.
        """
        refuse_latin([part.design for part in self.parts], design)
        while True:
            if any(part.design.key == design.key for part in self.parts):
                return self
            earlier = tuple(part.design for part in self.parts)
            part = part_of(len(self.parts), design, earlier, block, refinement, first)
            if part.points == 0:
                return self
            folder = self.folder(part)
            with folder_made_durably(folder) as made:
                _fill_part(made, part, self.question)
            again = Store.open(self.path)
            if again.parts[part.number].design.key == design.key:
                return again
            self = again  # somebody else added another part first

    def folder(self, part: StudyPart) -> Path:
        """Where a part stands."""
        return self.path / f"part-{part.number}"

    def state(self, part: StudyPart) -> PartState:
        """What is there."""
        folder = self.folder(part)
        shards = {int(name[:-5]) for name in _names(folder / "shards", ".json")}
        blocks = {int(name[:-4]) for name in _names(folder / "blocks", ".npz")}
        return PartState(shards, {block for block in blocks if block // part.blocks_a_shard not in shards})

    def block_path(self, part: StudyPart, block: int) -> Path:
        """The file of a block."""
        return self.folder(part) / "blocks" / f"{block:010}.npz"

    def put(self, part: StudyPart, block: int, values: Any, found: Evaluated, seconds: float) -> None:
        """Write a block.

        Raises
        ------
        ComputationError : the disk is full or fails.
        """
        asked = address(self.identity, part.design.paths, values)
        write_block(self.block_path(part, block), asked, self.question.quantities, found, seconds)

    def block(self, part: StudyPart, block: int) -> tuple[Evaluated, float]:
        """What came of a block that stands in a file of its own, and the seconds it took.

        Raises
        ------
        FileNotFoundError, DamagedBlock : it is not there, or not whole.
        """
        asked = address(self.identity, part.design.paths, part.values(block))
        return read_block(self.block_path(part, block), asked, self.question.quantities)

    def compact(self, part: StudyPart, shard: int) -> list[int]:
        """Make a shard of its blocks, all of which are done, and remove their files; blocks that turn out damaged
        are removed and given back, to be computed again.

        Raises
        ------
        ComputationError : the disk is full or fails, or a shard does not read back.
        """
        folder = self.folder(part)
        if note_of(folder, shard).is_file():
            self._remove_blocks(part, shard)
            return []
        found, damaged, seconds = [], [], 0.0
        for block in part.blocks_of(shard):
            try:
                one, took = self.block(part, block)
            except FileNotFoundError:
                if note_of(folder, shard).is_file():  # somebody else made it meanwhile
                    return []
                damaged.append(block)
                continue
            except DamagedBlock:
                self.block_path(part, block).unlink(missing_ok=True)
                damaged.append(block)
                continue
            found.append(one)
            seconds += took
        if damaged:
            return damaged
        values = np.concatenate([part.values(block) for block in part.blocks_of(shard)])
        try:
            write_shard(folder, part, shard, self.question.quantities, values, joined(found), seconds)
        except DamagedShard as error:
            raise ComputationError(f"{error}: check the disk, then resume") from None
        except OSError as error:
            raise ComputationError(
                f"{folder}: cannot be written ({error.strerror}); resume when there is room"
            ) from None
        self._remove_blocks(part, shard)
        return []

    def _remove_blocks(self, part: StudyPart, shard: int) -> None:
        for block in part.blocks_of(shard):
            with suppress(OSError):
                self.block_path(part, block).unlink(missing_ok=True)

    def tidy(self) -> None:
        """Remove what runs that were killed left, and files of blocks whose shard is whole."""
        for part in self.parts:
            folder = self.folder(part)
            for where in (folder, folder / "blocks", folder / "shards"):
                sweep(where)
            for left in folder.glob("alone-*.txt"):
                left.unlink(missing_ok=True)
            shards = self.state(part).shards
            for name in _names(folder / "blocks", ".npz"):
                if int(name[:-4]) // part.blocks_a_shard in shards:
                    with suppress(OSError):
                        (folder / "blocks" / name).unlink(missing_ok=True)

    def verify(self) -> list[str]:
        """Read every shard and block back; what is damaged is taken out, so that it counts as missing, and named."""
        found: list[str] = []
        for part in self.parts:
            folder, state = self.folder(part), self.state(part)
            for shard in sorted(state.shards):
                try:
                    check_shard(folder, shard)
                    read_shard(folder, part, shard, self.question.quantities)
                except DamagedShard as error:
                    found.append(str(error))
                    note_of(folder, shard).unlink(missing_ok=True)
                    folder_to_disk(folder / "shards")
            for block in sorted(state.blocks):
                try:
                    self.block(part, block)
                except (DamagedBlock, FileNotFoundError) as error:
                    found.append(str(error))
                    self.block_path(part, block).unlink(missing_ok=True)
        return found

    def stretches(self, part: StudyPart) -> Iterator[tuple[int, int, Evaluated | None]]:
        """Rows of a part from first to last, a shard or a block at a time, and what came of them; None: missing.

        Raises
        ------
        ComputationError : a shard or a block is damaged.
        """
        state, folder = self.state(part), self.folder(part)
        for shard in range(part.shards):
            if shard in state.shards:
                yield *part.shard_rows(shard), self._shard(part, shard)
                continue
            for block in part.blocks_of(shard):
                if block not in state.blocks:
                    yield *part.rows(block), None
                    continue
                try:
                    yield *part.rows(block), self.block(part, block)[0]
                except FileNotFoundError:  # its shard has been made since
                    if not note_of(folder, shard).is_file():
                        yield *part.rows(block), None
                        continue
                    first, last = part.rows(block)
                    begin = part.shard_rows(shard)[0]
                    yield first, last, piece(self._shard(part, shard), first - begin, last - begin)
                except DamagedBlock as error:
                    raise ComputationError(f"{error}: trunnion study resume {self.path} --verify") from None

    def _shard(self, part: StudyPart, shard: int) -> Evaluated:
        try:
            return read_shard(self.folder(part), part, shard, self.question.quantities)
        except DamagedShard as error:
            raise ComputationError(f"{error}: trunnion study resume {self.path} --verify computes it again") from None

    def counts(self) -> Counts:
        """Points, and how many are done and failed; why they failed, in groups, and what they took in all [s]."""
        points = done = failed = 0
        seconds, reasons = 0.0, dict[str, int]()
        for part in self.parts:
            state, folder = self.state(part), self.folder(part)
            points += part.points
            for shard in state.shards:
                try:
                    about = read_note(folder, shard)
                except DamagedShard as error:
                    raise ComputationError(f"{error}: trunnion study resume {self.path} --verify") from None
                done += about["points"] - about["failed"]
                failed += about["failed"]
                seconds += about["seconds"]
                for sentence, rows in about["sentences"].items():
                    reasons[sentence] = reasons.get(sentence, 0) + len(rows)
            for block in state.blocks:
                with suppress(FileNotFoundError, DamagedBlock):
                    found, took = self.block(part, block)
                    failing = int((found.status == FAILED).sum())
                    done, failed, seconds = done + len(found.status) - failing, failed + failing, seconds + took
                    for sentence in found.sentences.values():
                        reasons[sentence] = reasons.get(sentence, 0) + 1
        return Counts(points, done, failed, seconds, tuple(sorted(reasons.items(), key=lambda one: -one[1])))


@dataclass(frozen=True)
class Counts:
    """Points of a store; done, failed, seconds of computing, and sentences of what failed by how often, most first."""

    points: int
    done: int
    failed: int
    seconds: float
    reasons: tuple[tuple[str, int], ...]

    @property
    def missing(self) -> int:
        """Points that are still to be computed."""
        return self.points - self.done - self.failed


def part_of(
    number: int, design: StudyDesign, earlier: tuple[StudyDesign, ...], block: int,
    refinement: Refinement | None = None, first: tuple[int, ...] = (),
) -> StudyPart:  # fmt: skip
    """A part whose shards are whole blocks, of ``SHARD`` points or a block."""
    shard = block * max(1, SHARD // block)
    return StudyPart(number, design, earlier, block, shard, refinement, first if refinement else ())


def joined(found: list[Evaluated]) -> Evaluated:
    """Several blocks one after another."""
    sentences: dict[int, str] = {}
    first = 0
    for one in found:
        sentences |= {first + row: sentence for row, sentence in one.sentences.items()}
        first += len(one.status)
    values = {path: np.concatenate([one.values[path] for one in found]) for path in found[0].values}
    return Evaluated(np.concatenate([one.status for one in found]), values, sentences)


def piece(found: Evaluated, first: int, last: int) -> Evaluated:
    """Some rows."""
    sentences = {row - first: s for row, s in found.sentences.items() if first <= row < last}
    values = {path: one[first:last] for path, one in found.values.items()}
    return Evaluated(found.status[first:last], values, sentences)


def _fill_part(folder: Path, part: StudyPart, question: StudyQuestion) -> None:
    attributes = {"part": part.number, "parameters": list(part.design.paths)}
    folder.mkdir(exist_ok=True)
    make_arrays(folder, part, question.quantities, attributes)
    for name in ("blocks", "shards"):
        (folder / name).mkdir()
    names = array_names([*part.design.paths, *(q.path for q in question.quantities)])
    for name in (*names, "status"):
        (folder / name / "c").mkdir(exist_ok=True)
    (folder / "part.json").write_text(_sealed(part.content))


def _provenance(came_from: str) -> dict[str, str]:
    return {
        "study": came_from, "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "python": platform.python_version(), "platform": f"{sys.platform} {platform.machine()}",
    }  # fmt: skip


def _names(folder: Path, ending: str) -> list[str]:
    return [name for name in os.listdir(folder) if name.endswith(ending) and not name.startswith(".")]


def _sealed(content: Mapping[str, Any]) -> str:
    """JSON with a checksum of itself."""
    return json.dumps({"sha256": _checksum(content), "content": content}, indent=1)


def _checksum(content: object) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _unsealed(path: Path) -> dict[str, Any]:
    try:
        whole = json.loads(path.read_text())
        content: dict[str, Any] = whole["content"]
        if whole["sha256"] == _checksum(content):
            return content
        why = "its checksum does not agree"
    except (OSError, ValueError, KeyError, TypeError) as error:
        why = str(error)
    raise InputError(f"is damaged ({why})", key="store", value=str(path), remedy="take it from a backup")
