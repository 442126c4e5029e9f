"""Whether a few boxes prove that peaks of a line as it is stay below limits over a range of speeds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from trunnion.arrays import Array, Flags
from trunnion.equations.coefficients import Assembly
from trunnion.equations.steady_base import require_steady_base
from trunnion.floquet.certificate.box_coefficients import NumberRange
from trunnion.floquet.certificate.box_space import BoxSpace, halved
from trunnion.floquet.certificate.certify import require_provable
from trunnion.floquet.certificate.requirements import require_linear
from trunnion.response.peaks.box_peaks import BoxPeaks, box_peaks
from trunnion.response.peaks.forced_box import require_forcing
from trunnion.response.peaks.quantities import quantities_of
from trunnion.response.peaks.stages_left import stages_left
from trunnion.waiting import time_is_up, to_the_end


@dataclass(frozen=True)
class AskedPeak:
    """A quantity (by its place among ``quantities_of``) that should stay below ``limit``; ``easy``: to be tried first,
    as its searched value lies far below."""

    quantity: int
    limit: float
    easy: bool = True


@dataclass(frozen=True)
class PeakBounds:
    """Bounds of what was asked (asked,), infinite where there is none, after ``boxes``; what ended them, as a
    clause."""

    upper: Array
    boxes: int
    ended: str = ""


def require_enclosed(assembly: Assembly, speeds: tuple[float, float], ranges: Sequence[NumberRange] = ()) -> None:
    """Refuse lines whose equations or excitations are not enclosed over all values of ``ranges``.

    Raises
    ------
    InputError : so.
    """
    require_provable(assembly)
    require_steady_base(assembly, assembly.table(4, np.linspace(*speeds, 4)))
    require_linear(assembly, speeds, ranges)
    require_forcing(assembly, speeds, ranges)


def peaks_below(
    assembly: Assembly, speeds: tuple[float, float], asked: tuple[AskedPeak, ...], most_boxes: int
) -> PeakBounds:
    """Bounds at all ``speeds`` [rad/s] by as many boxes at most; what is easy is proved first.

    Raises
    ------
    InputError : the line's equations are not enclosed.
    """
    require_enclosed(assembly, speeds)
    found = _Halving(BoxSpace(assembly, (), speeds), np.array([one.quantity for one in asked]), most_boxes)
    limit, easy = np.array([one.limit for one in asked]), np.array([one.easy for one in asked])
    found.run(limit, easy)
    found.run(limit, np.ones(len(asked), dtype=bool))
    upper = np.max([np.full(len(quantities_of(assembly)), -np.inf), *(peaks.upper for _, peaks in found.boxes)], axis=0)
    if found.boxes and (left := list(stages_left(assembly, speeds, (), upper))):
        return PeakBounds(np.full(len(asked), np.inf), found.judged, left[0].split(":")[0])
    return PeakBounds(found.upper, found.judged, found.ended)


@dataclass
class _Halving:
    """Boxes that cover the range, each with its peaks."""

    space: BoxSpace
    quantity: Array
    most: int
    boxes: list[tuple[Array, BoxPeaks]] = field(default_factory=list)
    judged: int = 0
    ended: str = ""

    @property
    def upper(self) -> Array:
        """Over all boxes (asked,)."""
        if not self.boxes:
            return np.full(len(self.quantity), np.inf)
        return np.asarray(np.max([peaks.upper[self.quantity] for _, peaks in self.boxes], axis=0))

    def run(self, limit: Array, tried: Flags) -> None:
        """Halve the box that stands furthest above a limit of those ``tried``, until none does or boxes are used up."""
        if not self.boxes and not self._judge(np.array([np.zeros(1), np.ones(1)])):
            return
        while True:
            over = np.array([self._above(peaks, limit, tried) for _, peaks in self.boxes])
            worst = int(over.argmax())
            if not over[worst] > 1 or self.judged + 2 > self.most:
                return
            box, peaks = self.boxes.pop(worst)
            halves = halved(box, np.ones(1))
            if not halves or not all(self._judge(half) for half in halves):
                self.boxes = [one for one in self.boxes if not _inside(one[0], box)] + [(box, peaks)]
                return

    def _above(self, peaks: BoxPeaks, limit: Array, tried: Flags) -> float:
        """By what factor a box stands above a limit at most."""
        if not tried.any():
            return 0.0
        share = peaks.upper[self.quantity[tried]] / limit[tried]
        return float(np.nan_to_num(share, nan=np.inf, posinf=1e300).max())

    def _judge(self, box: Array) -> bool:
        if ended := time_is_up():
            self.ended = ended
            return False
        with to_the_end():
            peaks = box_peaks(self.space.assembly, self.space.span(box), self.space.ranges(box))
        self.judged += 1
        self.boxes.append((box, peaks))
        return True


def _inside(box: Array, other: Array) -> bool:
    return bool(np.all(box[0] >= other[0]) and np.all(box[1] <= other[1]))
