"""A folder with the cells of a map of captures, written in pieces while they are computed, and read again to go on.

``map.json`` says of which map they are. A piece holds ``PIECE`` cells that follow each other in the map's order, as
counts by kind, −1 of those that were not computed. Each is written to a temporary name and renamed, so that a piece is
there as a whole or not at all; what a killed process loses is the piece it was at.
"""

from __future__ import annotations

import hashlib
import json
import re
from pathlib import Path
from typing import Any

import numpy as np

from trunnion import __version__
from trunnion.arrays import Integers
from trunnion.driveline.applied_torque import TorqueFunction
from trunnion.errors import InputError
from trunnion.motion.passing.map_cells import KINDS, UNKNOWN, MapRequest
from trunnion.writing import written_whole

PIECE = 128
"""Cells of a piece."""
OF_MAP = "map.json"


class MapStore:
    """The folder of one map."""

    def __init__(self, folder: str | Path, asked: MapRequest) -> None:
        """Begin it, or go on with it.

        Raises
        ------
        InputError : it holds another map, or is no such folder; a torque that is a function.
        """
        self.folder, self.cells = Path(folder), asked.cells
        self.order = asked.order()
        self.piece_of = np.empty(self.cells, dtype=np.int64)
        self.piece_of[self.order] = np.arange(self.cells) // PIECE
        self.left = np.bincount(self.piece_of)
        self.changed: set[int] = set()
        says = _says(asked)
        head = self.folder / OF_MAP
        if self.folder.exists() and not self.folder.is_dir():
            raise InputError("is not a folder", key="store", value=str(folder), remedy="name a new folder")
        if self.folder.is_dir() and not head.exists() and any(self.folder.iterdir()):
            raise InputError("holds something else", key="store", value=str(folder), remedy="name a new folder")
        self.folder.mkdir(parents=True, exist_ok=True)
        if not head.exists():
            with written_whole(head) as path:
                path.write_text(json.dumps(says, indent=1), encoding="utf-8")
        elif (known := _read(head)) != says:
            differ = [key for key in says if known.get(key) != says[key]] or ["format"]
            raise InputError(
                f"holds another map: it differs in {', '.join(differ)}", key="store", value=str(folder),
                remedy="name a new folder, or ask for that map",
            )  # fmt: skip

    def counts(self) -> Integers:
        """Counts (cell, kind) as far as they are there.

        Raises
        ------
        InputError : a piece that is damaged.
        """
        found = np.full((self.cells, len(KINDS)), UNKNOWN, dtype=np.int64)
        for file in sorted(self.folder.glob("piece-*.npy")):
            number = re.fullmatch(r"piece-(\d+)\.npy", file.name)
            if number is None or int(number[1]) >= len(self.left):
                continue
            cells = self._cells(int(number[1]))
            try:
                held = np.load(file, allow_pickle=False)
            except (OSError, ValueError, EOFError):
                held = None
            if held is None or held.shape != (len(cells), len(KINDS)) or held.dtype != np.int64:
                raise InputError(
                    "is damaged", key="store", value=str(file), remedy="remove this file; it is made again"
                )
            found[cells] = held
        self.left -= np.bincount(self.piece_of[found[:, 0] != UNKNOWN], minlength=len(self.left))
        return found

    def note(self, cell: int, counts: Integers) -> None:
        """A cell was computed: its piece is written where it is whole."""
        piece = int(self.piece_of[cell])
        self.left[piece] -= 1
        self.changed.add(piece)
        if self.left[piece] == 0:
            self._write(piece, counts)

    def write(self, counts: Integers) -> None:
        """Write what is not written yet."""
        for piece in sorted(self.changed):
            self._write(piece, counts)

    def _write(self, piece: int, counts: Integers) -> None:
        with written_whole(self.folder / f"piece-{piece:07d}.npy") as path:
            np.save(path, counts[self._cells(piece)])
        self.changed.discard(piece)

    def _cells(self, piece: int) -> Integers:
        return self.order[piece * PIECE : (piece + 1) * PIECE]


def _says(asked: MapRequest) -> dict[str, Any]:
    """What the counts of a map follow from."""
    trials = asked.trials
    for one in trials.asked[0]:
        if isinstance(one, TorqueFunction):
            raise InputError(
                "is a function, of which a store cannot say whether it is the same", element=f"torque on {one.on}",
                key="store", remedy="write a formula, or leave out store",
            )  # fmt: skip
    packed = hashlib.sha256(repr(trials.line.model_dump(mode="json")).encode()).hexdigest()
    return {
        "format": 1,
        "trunnion": __version__,
        "line": packed,
        "speeds": [trials.first, trials.last],
        "torque": [one.model_dump(mode="json") for one in trials.asked[0]],
        "friction": [one.model_dump(mode="json") for one in trials.asked[1]],
        "drive": trials.drive,
        "parameters": list(asked.parameters),
        "x": [float(asked.x[0]), float(asked.x[-1]), len(asked.x)],
        "y": [float(asked.y[0]), float(asked.y[-1]), len(asked.y)],
        "phases": trials.phases.tolist(),
        "tolerance": trials.tolerance,
    }


def _read(head: Path) -> dict[str, Any]:
    try:
        found = json.loads(head.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        found = None
    if not isinstance(found, dict):
        raise InputError("is damaged", key="store", value=str(head), remedy="name a new folder")
    return found
