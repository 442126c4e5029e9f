"""Shards of Zarr v3, each a whole one of several blocks: what readers of other programs open, with checksums inside.

Zarr waits for no disk, and reads what is there before it writes the last, shorter shard. So a shard is made in a folder
of its own, read back, and moved to its place once it is on the disk; it counts when a note beside says so, and until
then its blocks stay.
"""

from __future__ import annotations

import json
import re
import shutil
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from trunnion.arrays import Array
from trunnion.studies.extra import zarr
from trunnion.studies.parts import StudyPart
from trunnion.studies.points import FAILED, Evaluated
from trunnion.studies.quantities import LETTERS, StudyQuantity
from trunnion.writing import move_durably, scratch_folder, write_durably

STATUS = "status"
CHUNK = 1 << 14
"""Most points of a chunk, which is read whole."""
MEANINGS = "missing done failed"


class DamagedShard(Exception):
    """A shard that does not read back."""


def array_names(paths: Sequence[str]) -> tuple[str, ...]:
    """Names of arrays for parameters and quantities, without what file systems refuse."""
    found: list[str] = []
    for path in paths:
        plain = re.sub(r"[^\w.]+", "_", path)[:100].strip("._") or "value"
        found.append(plain if plain not in (*found, STATUS) else f"{plain}_{len(found) + 1}")
    return tuple(found)


def make_arrays(folder: Path, part: StudyPart, quantities: Sequence[StudyQuantity], attributes: dict[str, Any]) -> None:
    """A Zarr group with an array of every parameter and quantity and of the status, nothing in them."""
    library = zarr()
    group = library.open_group(str(folder), mode="w", zarr_format=3, attributes=attributes)
    shards, chunk = part.shard, _chunk(part)
    codec = library.codecs.ZstdCodec(level=3, checksum=True)

    def make(name: str, dtype: str, fill: Any, about: dict[str, Any], letters: int = 0) -> None:
        more = (letters,) if letters else ()
        group.create_array(
            name, shape=(part.points, *more), chunks=(chunk, *more), shards=(shards, *more), dtype=dtype,
            compressors=codec, fill_value=fill, attributes=about, config={"write_empty_chunks": True},
            dimension_names=("point", "letter") if letters else ("point",),
        )  # fmt: skip

    make(STATUS, "uint8", 0, {"flag_values": [0, 1, 2], "flag_meanings": MEANINGS})
    names = array_names([*part.design.paths, *(q.path for q in quantities)])
    for name, path, unit in zip(names, part.design.paths, part.design.units, strict=False):
        make(name, "float64", float("nan"), {"parameter": path, "units": unit})
    for name, one in zip(names[len(part.design.paths) :], quantities, strict=True):
        about: dict[str, Any] = {"quantity": one.path, "units": one.unit}
        if one.codes:
            about |= {
                "flag_values": list(one.codes),
                "flag_meanings": " ".join(m.replace(" ", "_") for m in one.meanings),
            }
        if one.kind == "word":
            make(name, "uint8", 0, {**about, "encoding": "utf-8"}, LETTERS)
        else:
            make(name, "float64", float("nan"), about)


def _chunk(part: StudyPart) -> int:
    """Points of a chunk, a whole number of which make a shard."""
    chunk = part.shard
    while chunk > CHUNK and chunk % 2 == 0:
        chunk //= 2
    return chunk


def write_shard(
    folder: Path,
    part: StudyPart,
    shard: int,
    quantities: Sequence[StudyQuantity],
    values: Array,
    found: Evaluated,
    seconds: float,
) -> None:
    """Write the shard of a part whose values (points, parameters) and results are at hand, then the note about it.

    Raises
    ------
    DamagedShard : it does not read back as it was written.
    ComputationError : the disk is full or fails.
    """
    first, last = part.shard_rows(shard)
    files = {}
    with scratch_folder(folder) as beside:
        for name, content in _contents(part, quantities, values, found):
            (beside / name).mkdir()
            shutil.copyfile(folder / name / "zarr.json", beside / name / "zarr.json")
            # Which is not part of the description, nor read from it: else a shard of nothing but NaN has no file.
            with zarr().config.set({"array.write_empty_chunks": True}):
                array = zarr().open_array(str(beside / name), mode="r+")
            array[first:last] = content
            if np.asarray(array[first:last]).tobytes() != np.ascontiguousarray(content).tobytes():
                raise DamagedShard(f"shard {shard} of {folder / name} does not read back as it was written")
            made, path = (file_of(where, name, shard, content.ndim) for where in (beside, folder))
            files[name] = [made.stat().st_size, zlib.crc32(made.read_bytes())]
            path.parent.mkdir(exist_ok=True)
            move_durably(made, path)
    by_sentence: dict[str, list[int]] = {}
    for row, sentence in sorted(found.sentences.items()):
        by_sentence.setdefault(sentence, []).append(row)
    about = {
        "points": last - first, "failed": int((found.status == FAILED).sum()), "seconds": seconds,
        "sentences": by_sentence, "files": files,
    }  # fmt: skip
    write_durably(note_of(folder, shard), json.dumps(about).encode())


def _contents(
    part: StudyPart, quantities: Sequence[StudyQuantity], values: Array, found: Evaluated
) -> Iterator[tuple[str, Any]]:
    names = array_names([*part.design.paths, *(q.path for q in quantities)])
    size = len(part.design.paths)
    yield from zip(names[:size], values.T, strict=True)
    for name, one in zip(names[size:], quantities, strict=True):
        yield name, found.values[one.path]
    yield STATUS, found.status


def file_of(folder: Path, name: str, shard: int, dimensions: int) -> Path:
    """The file of a shard of an array."""
    path = folder / name / "c" / str(shard)
    return path / "0" if dimensions > 1 else path


def note_of(folder: Path, shard: int) -> Path:
    """The note that a shard is whole."""
    return folder / "shards" / f"{shard:08}.json"


def read_note(folder: Path, shard: int) -> dict[str, Any]:
    """What the note about a shard says.

    Raises
    ------
    DamagedShard : it cannot be read.
    """
    try:
        found: dict[str, Any] = json.loads(note_of(folder, shard).read_text())
        return found
    except (OSError, ValueError) as error:
        raise DamagedShard(f"{note_of(folder, shard)} cannot be read ({error})") from None


def read_shard(folder: Path, part: StudyPart, shard: int, quantities: Sequence[StudyQuantity]) -> Evaluated:
    """Results of a shard; its checksums are compared.

    Raises
    ------
    DamagedShard : they do not agree.
    """
    first, last = part.shard_rows(shard)
    names = array_names([*part.design.paths, *(q.path for q in quantities)])[len(part.design.paths) :]
    about = read_note(folder, shard)
    try:
        group = zarr().open_group(str(folder), mode="r")
        values = {q.path: np.asarray(group[name][first:last]) for q, name in zip(quantities, names, strict=True)}
        status = np.asarray(group[STATUS][first:last])
    except Exception as error:  # of its codecs, each in its own words
        raise DamagedShard(f"shard {shard} of {folder} does not read ({error})") from None
    for name, (size, _) in about["files"].items():
        path = file_of(folder, name, shard, 2 if (folder / name / "c" / str(shard)).is_dir() else 1)
        if not path.is_file() or path.stat().st_size != size:  # a shard that is not there reads as empty
            raise DamagedShard(f"{path} is not as long as it was")
    sentences = {row: sentence for sentence, rows in about["sentences"].items() for row in rows}
    return Evaluated(status, values, sentences)


def check_shard(folder: Path, shard: int) -> None:
    """Compare the files of a shard with what was written.

    Raises
    ------
    DamagedShard : they differ.
    """
    for name, (size, checksum) in read_note(folder, shard)["files"].items():
        path = file_of(folder, name, shard, 2 if (folder / name / "c" / str(shard)).is_dir() else 1)
        content = path.read_bytes() if path.is_file() else b""
        if len(content) != size or zlib.crc32(content) != checksum:
            raise DamagedShard(f"{path} is not as it was written")
