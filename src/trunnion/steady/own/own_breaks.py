"""Where over the speed the own motion of a bent line that starts free breaks off.

Joints shake such a line by themselves. Near a resonance of that it swings so far that its frequency changes with the
swing, and the curve of its motions over the mean speed leans over: coming from slow speeds one motion goes on as far
as a fold, coming from fast ones another as far as a second fold. Between the two folds several motions have one mean
speed, and which of them runs depends on how one got there; where the first fold is the lower one, none was found.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from trunnion.arrays import Array
from trunnion.numerics import harmonics as fourier
from trunnion.steady.own.own_motions import ALIKE, LEAP, Break, MotionsBySpeed, apart

SEVERAL = "the free line's own motion folds back there, and several have one mean speed"
NONE = "no own motion of the free line was found there"


def breaks(solved: MotionsBySpeed, speeds: Array) -> tuple[Break, ...]:
    """Those between the lowest and the highest of ``speeds`` (speed,) [rad/s], looked for between all of them."""
    speeds = np.unique(speeds)
    solved.at_all(speeds)
    usable = [speed for speed in speeds.tolist() if solved.known[speed].settled]
    low, high = float(speeds[0]), float(speeds[-1])
    if not usable:
        return (Break(low, high, NONE),)
    walk = _Walk(solved, low, high)
    found = _merged([*walk.outside(usable[0], low), *walk.between(usable), *walk.outside(usable[-1], high)])
    return tuple(walk.with_outer_motions(one, usable) for one in found)


def _merged(found: Iterable[Break]) -> Iterator[Break]:
    """Those that overlap as one."""
    left = sorted(found, key=lambda one: one.low)
    while left:
        one = left.pop(0)
        while left and left[0].low <= one.high:
            other = left.pop(0)
            one = Break(one.low, max(one.high, other.high), max(one.why, other.why))
        yield one


@dataclass(frozen=True)
class _Walk:
    """From motion to motion between two speeds [rad/s]."""

    solved: MotionsBySpeed
    low: float
    high: float

    def outside(self, speed: float, end: float) -> Iterator[Break]:
        """What lies between the outermost motion found and the end of the range."""
        last = self._carried(speed, end)
        if last != end:
            yield Break(min(last, end), max(last, end), NONE)

    def between(self, speeds: list[float]) -> Iterator[Break]:
        """What lies between neighbours of which neither leads to the other."""
        pairs = list(pairwise(speeds))
        for (a, b), same in zip(pairs, self._lead_over(pairs), strict=True):
            up = b if same else self._carried(a, b)
            down = a if up == b else self._carried(b, a)
            if up != b and down != a:
                yield Break(min(up, down), max(up, down), SEVERAL if up > down else NONE)

    def with_outer_motions(self, found: Break, speeds: list[float]) -> Break:
        """The same break; of several motions that are known at a fold, the one that goes on outside, up to where the
        line is judged by it."""
        below = max((speed for speed in speeds if speed < found.low), default=found.low)
        above = min((speed for speed in speeds if speed > found.high), default=found.high)
        for begin, fold in ((below, found.low), (above, found.high)):
            reached, motion = self.solved.carried(self.solved.known[begin], begin, fold)
            if reached == fold:
                self.solved.known[fold] = motion
        return found

    def _lead_over(self, pairs: list[tuple[float, float]]) -> list[bool]:
        """Of pairs of speeds whether the motion at the first leads to that at the second in one small step."""
        known, found = self.solved.known, [False] * len(pairs)
        orders = [max(known[a].h, known[b].h) for a, b in pairs]
        near = [apart(known[a].rows, known[b].rows) <= LEAP * known[a].swing for a, b in pairs]
        for h in sorted(set(orders)):
            which = [i for i, one in enumerate(orders) if one == h and near[i]]
            if not which:
                continue
            start, goal = (np.stack([fourier.resized(known[pairs[i][k]].rows, h) for i in which]) for k in (0, 1))
            reached = self.solved.balance.solve(np.array([pairs[i][1] for i in which]), h, start)
            same = reached.found & (np.abs(reached.rows - goal).max(axis=(1, 2)) < ALIKE)
            for i, good in zip(which, same, strict=True):
                found[i] = bool(good)
        return found

    def _carried(self, begin: float, aim: float) -> float:
        """How far the motion at ``begin`` goes on: ``aim`` where it leads to the one known there, else as far as it
        goes, past that speed too where the one known there is another."""
        known = self.solved.known
        at, motion = self.solved.carried(known[begin], begin, aim)
        goal = known.get(aim)
        if at == aim and goal is not None and goal.settled and apart(motion.rows, goal.rows) > ALIKE:
            at, motion = self.solved.carried(motion, aim, self.high if aim > begin else self.low)
        if at not in known or not known[at].settled:
            known[at] = motion
        return at
