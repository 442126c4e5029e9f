"""A block as one file that never changes: written whole, on the disk before it counts, checked when it is read.

The file is a ZIP of arrays (``numpy.load`` reads it), whose members carry checksums. It says whose block it is.
"""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from trunnion.arrays import Array
from trunnion.studies.points import Evaluated
from trunnion.studies.quantities import StudyQuantity
from trunnion.writing import write_durably

VALUES = "value {}"
"""Name of the array of the quantity with this number."""


class DamagedBlock(Exception):
    """A file of a block that is not whole, or of another study."""


def address(identity: str, paths: tuple[str, ...], values: Array) -> str:
    """A word for what a block asks: line, analysis and version by their ``identity``, and the values of its points."""
    hashed = hashlib.sha256(identity.encode())
    hashed.update(json.dumps(paths).encode())
    hashed.update(np.ascontiguousarray(values, dtype="<f8").tobytes())
    return hashed.hexdigest()


def write_block(
    path: Path, asked: str, quantities: tuple[StudyQuantity, ...], found: Evaluated, seconds: float
) -> None:
    """Write what came of a block; ``asked`` is its address, ``seconds`` what it took."""
    about = {"address": asked, "seconds": seconds, "sentences": {str(k): v for k, v in sorted(found.sentences.items())}}
    arrays = {VALUES.format(k): found.values[one.path] for k, one in enumerate(quantities)}
    content = io.BytesIO()
    np.savez(content, about=np.frombuffer(json.dumps(about).encode(), dtype=np.uint8), status=found.status, **arrays)
    write_durably(path, content.getvalue())


def read_block(path: Path, asked: str, quantities: tuple[StudyQuantity, ...]) -> tuple[Evaluated, float]:
    """What came of a block, and the seconds it took.

    Raises
    ------
    FileNotFoundError : it is not there.
    DamagedBlock : it is not whole, or another's.
    """
    try:
        with np.load(path, allow_pickle=False) as content:
            about: dict[str, Any] = json.loads(content["about"].tobytes())
            if about["address"] != asked:
                raise DamagedBlock(f"{path.name} belongs to another study")
            values = {one.path: content[VALUES.format(k)] for k, one in enumerate(quantities)}
            sentences = {int(k): v for k, v in about["sentences"].items()}
            return Evaluated(content["status"], values, sentences), float(about["seconds"])
    except FileNotFoundError:
        raise
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise DamagedBlock(f"{path.name} is damaged ({error})") from None
