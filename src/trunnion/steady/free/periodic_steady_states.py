"""The periodic motions of a line with joint angles, at many mean speeds or along a parameter, and its equations
linearised about them.

Each is solved once by ``free_balance``, whoever asks: the orders and the stability along a range. Excitations of disks
and transmission errors are left out, as in ``periodic_steady_state``, which finds one motion by shooting.

Joints shake such a line by themselves. Near a resonance of that it swings so far that its frequency changes with the
swing, and the curve of its motions over the mean speed leans over: coming from slow speeds one motion goes on as far
as a fold, coming from fast ones another as far as a second fold. Between the two folds several motions have one mean
speed, and which of them runs depends on how one got there; where the first fold is the lower one, none was found.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from trunnion.arrays import Array, Complex, Flags, Places
from trunnion.driveline.driveline import Driveline
from trunnion.equations.aligned import aligned_matrices
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.harmonics import unexcited
from trunnion.equations.linear_clutches import mean_by_load, with_mean_clutches
from trunnion.equations.prepared_line import prepared, with_stages
from trunnion.equations.steady_base import loaded_by_speed
from trunnion.equations.topology import require_period
from trunnion.numerics import harmonics as fourier
from trunnion.numerics.harmonics import doubled
from trunnion.numerics.spectrum import along, real_positive
from trunnion.steady.free.free_balance import MOST, MOST_NUMBERS, FreeBalance, SteadyStates

ALIKE = 1e-6
"""Difference [rad] of two motions that are the same."""
LEAP = 0.1
"""Share of its swing by which a motion may change in one step: by more it fell into another one."""
FAR_LEAP = 4.0
"""The same where the motion leads back as well: swings past a resonance have the other sense."""
AWAY = np.array([0.9, 1.1, 0.75, 1.3])
"""Shares of a speed at which one begins to follow a motion to it that is not found otherwise."""
BESIDE = 1e-6
"""Step of differences by the speed, over it."""
CLOSE = 1e-6
"""How closely one locates where a motion ends, as a share of the speed."""
SEVERAL = "the line's periodic steady state folds back there, and several have one mean speed"
NONE = "no periodic steady state of the line was found there"


@dataclass(frozen=True)
class Break:
    """Speeds [rad/s] between which there is no motion that goes on from either side, and why."""

    low: float
    high: float
    why: str


@dataclass(frozen=True)
class SteadyStateSlopes:
    """Slopes along the motions, and what is not a disturbance of them.

    solved, value: what knows the motions, and where; found (value,); period [rad of input angle]; slopes: Fourier
    coefficients (value, harmonic ≥ 0, 2n, 2n) of A in x′ = A(τ)x, states in energy-like units; shift, drift (value,
    2n): the disturbances that shift the phase of a free–free line, and that change its speed; by_speed (value,):
    whether a torque depends on that, so that it counts.
    """

    solved: SteadyStateCurve
    value: Array
    found: Flags
    period: float
    slopes: Complex
    shift: Array
    drift: Array
    by_speed: Flags
    undamped: Flags

    def rates(self, which: Places, tau: Array) -> Array:
        """A (case, time, 2n, 2n) at input angles ``tau``."""
        slopes = self.slopes[which]
        # Of a real A the coefficients at −h are conjugates: the sum is that of cosines and sines.
        h = np.arange(slopes.shape[1])
        angle = np.outer(tau, h) * (2 * np.pi / self.period)
        twice = np.where(h > 0, 2.0, 1.0)
        wave = np.concatenate([np.cos(angle) * twice, -np.sin(angle) * twice], axis=1)
        flat = slopes.reshape(len(which), len(h), -1)
        flat = np.concatenate([flat.real, flat.imag], axis=1)
        return np.asarray((wave @ flat).reshape(len(which), len(tau), *slopes.shape[2:]))

    def beside_neutral(self, which: Places, matrix: Array) -> Array:
        """Matrices (case, 2n − 1, 2n − 1) without the shift of the phase; 0 for the multiplier of the speed. Those of
        a line whose speed is prescribed as they are."""
        if not self.solved.balance.free:
            return matrix
        finite = np.isfinite(matrix).all(axis=(1, 2))
        left = np.full((len(matrix), matrix.shape[1] - 1, matrix.shape[2] - 1), np.nan)
        rest = np.linalg.qr(self.shift[which][finite][:, :, None], mode="complete")[0][:, :, 1:]
        left[finite] = rest.transpose(0, 2, 1) @ matrix[finite] @ rest
        neutral = ~self.by_speed[which[finite]]
        if neutral.any():
            own, cases = np.flatnonzero(finite)[neutral], which[finite][neutral]
            direction = (self.drift[cases][:, None] @ rest[neutral])[:, 0]
            several = real_positive(np.linalg.eigvals(left[own]).astype(complex)).sum(axis=1) > 1
            grows = [self.speed_grows(i) if one else None for i, one in zip(cases, several, strict=True)]
            parts = zip(left[own], direction, grows, strict=True)
            left[own] = np.array([_deflated(*part) for part in parts]).reshape(left[own].shape)
        return left

    def speed_grows(self, i: int) -> bool | None:
        """Whether a change of the speed does, where the torque of the drives stays the same: the motion takes the less
        of it the faster it is. None where that cannot be computed."""
        rise = self.solved.torque_rise(float(self.value[i]))
        return rise < 0 if rise else None


def _deflated(matrix: Array, direction: Array, grows: bool | None) -> Array:
    """``matrix`` (m, m), 0 in place of the eigenvalue of what changes ``along`` a direction (m,)."""
    values, vectors = np.linalg.eig(matrix)
    place = along(matrix, direction, grows)
    left = np.linalg.solve(vectors.T, np.eye(len(matrix))[place])
    return np.asarray((matrix - values[place] * np.outer(vectors[:, place], left)).real)


def steady_state_slopes(
    line: Driveline, speeds: Array, solved: SteadyStatesBySpeed | None = None
) -> SteadyStateSlopes | None:
    """Motions at all ``speeds`` [rad/s]; None for a line whose springs have stages or play.

    ``solved`` : what is known of them already. ``found`` is False where the harmonics did not settle.
    """
    solved = solved or SteadyStatesBySpeed(line)
    return None if solved.obstacle else slopes_along(solved, speeds)


def slopes_along(solved: SteadyStateCurve, values: Array) -> SteadyStateSlopes:
    """Motions at all ``values`` of a curve."""
    motions = solved.at_all(values)
    n, balance = len(motions.balance.turn), motions.balance
    batch_size = max(1, MOST_NUMBERS // (motions.times * (2 * n) ** 2))
    parts = [_about(motions.part(slice(i, i + batch_size))) for i in range(0, len(values), batch_size)]
    slopes, shift, drift = (np.concatenate(each) for each in zip(*parts, strict=True))
    damping = np.trace(slopes[:, 0, n:, n:], axis1=1, axis2=2).real
    return SteadyStateSlopes(
        solved,
        values,
        found=motions.found & motions.resolved,
        period=balance.period,
        slopes=slopes,
        shift=shift,
        drift=drift,
        by_speed=solved.by_speed(motions.table),
        undamped=np.abs(damping) * balance.period < 1e-12 * n,
    )


def _about(motions: SteadyStates) -> tuple[Complex, Array, Array]:
    """A's Fourier coefficients (case, harmonic ≥ 0, 2n, 2n), the shift of the phase and the change of the speed
    (case, 2n), in energy-like units."""
    balance, speed = motions.balance, motions.speed
    n = len(balance.turn)
    felt, slopes = motions.sampled()
    spectrum = np.fft.rfft(slopes, axis=1)[:, :-1] / motions.times
    root = np.sqrt(aligned_matrices(balance.assembly.topology, motions.coefficients).mass)
    ratio = root[:, :, None] / root[:, None, :]
    stiffness = -spectrum[:, 0, :, :n].real * ratio / (speed**2)[:, None, None]
    unit = np.sqrt(np.maximum(np.abs(np.einsum("cii->ci", stiffness)).mean(axis=1), 1e-300))
    a = np.zeros((*spectrum.shape[:2], 2 * n, 2 * n), dtype=complex)
    a[:, 0, :n, n:] = np.eye(n) * unit[:, None, None]
    a[..., n:, :n] = spectrum[..., :n] * (ratio / (speed**2 * unit)[:, None, None])[:, None]
    a[..., n:, n:] = spectrum[..., n:] * (ratio / speed[:, None, None])[:, None]
    scale = np.concatenate([root, root / unit[:, None]], axis=1)
    over = speed[:, None]
    shift = np.concatenate([motions.states[:, 0, n:] / over + balance.turn, felt[:, 0] / over**2], axis=1) * scale
    drift = np.concatenate([np.zeros(n), balance.turn]) * scale
    return a, shift, drift


@dataclass(frozen=True)
class KnownSteadyState:
    """One motion that is known: see ``SteadyStates``."""

    found: bool
    resolved: bool
    rows: Array
    torque: float

    @classmethod
    def of(cls, motions: SteadyStates, i: int | np.signedinteger) -> KnownSteadyState:
        """One of several."""
        found, resolved = bool(motions.found[i]), bool(motions.resolved[i])
        return cls(found, resolved, motions.rows[i], float(motions.torque[i]))

    @property
    def h(self) -> int:
        """Harmonics kept."""
        return fourier.order(self.rows)

    @property
    def settled(self) -> bool:
        """Whether it was found, with harmonics enough."""
        return self.found and self.resolved

    @property
    def swing(self) -> float:
        """Largest amplitude of any harmonic [rad]."""
        return float(np.abs(self.rows[:, 1:]).max())


def _faster(table: Array) -> Array:
    """Packed numbers at speeds greater by ``BESIDE``."""
    table = table.copy()
    table[:, 0] *= 1 + BESIDE
    return table


def apart(one: Array, other: Array) -> float:
    """Largest difference [rad] of any harmonic but the mean of two motions, (n, 2h + 1) each."""
    h = max(fourier.order(one), fourier.order(other))
    return float(np.abs(fourier.resized(one, h) - fourier.resized(other, h))[:, 1:].max())


@dataclass
class FollowedMotion:
    """A motion on its way along a curve: where it is and leads (``end``), the next step, and by how much its rows
    (n, 2h + 1) change over that."""

    motion: KnownSteadyState
    at: float
    end: float

    def __post_init__(self) -> None:
        self._step, self._slope = self.end - self.at, np.zeros_like(self.motion.rows)
        self.over = self.at == self.end

    @property
    def to(self) -> float:
        """Where the next step leads."""
        return self.end if abs(self.end - self.at) <= abs(self._step) else self.at + self._step

    @property
    def expected(self) -> Array:
        """The motion there as the last two lead to it."""
        return np.asarray(self.motion.rows + self._slope * (self.to - self.at))

    def go(self, motion: KnownSteadyState) -> None:
        """Take the step, which leads to ``motion``; the next one is twice as long."""
        to, taken = self.to, self.to - self.at
        self._slope = (motion.rows - fourier.resized(self.motion.rows, motion.h)) / taken
        self.at, self.motion, self._step = to, motion, 2 * taken
        self.over = to == self.end

    def shorten(self, finest: float) -> None:
        """Halve the next step: the walk is over where it becomes less than ``finest``."""
        self._step = (self.to - self.at) / 2
        self.over = abs(self._step) < finest


class SteadyStateCurve:
    """The motions along one parameter, each value solved once. Phases count from zero rotation of the input."""

    def __init__(self, balance: FreeBalance, ends: tuple[float, float]) -> None:
        """``ends`` : lowest and highest value."""
        self._balance, self.ends = balance, ends
        self.known: dict[float, KnownSteadyState] = {}
        self.broken: tuple[Break, ...] = ()

    @property
    def balance(self) -> FreeBalance:
        """What solves them."""
        return self._balance

    def by_speed(self, table: Array) -> Flags:
        """Whether any torque depends on the speed at rows of packed numbers (case,)."""
        co = self.balance.assembly.untwisted(table)
        return np.asarray(co.viscous.any(axis=1) | co.quadratic.any(axis=1))

    def at_all(self, speeds: Array) -> SteadyStates:
        """The motions at all ``speeds`` [rad/s], with as many harmonics as the one that needs most."""
        self._solve(np.array([speed for speed in dict.fromkeys(speeds.tolist()) if speed not in self.known]))
        known = [self._at(speed) for speed in speeds.tolist()]
        h = max(fourier.order(one.rows) for one in known)
        return SteadyStates(
            self.balance,
            speeds,
            np.array([one.found for one in known]),
            np.stack([fourier.resized(one.rows, h) for one in known]),
            np.array([one.torque for one in known]),
        )

    def _at(self, speed: float) -> KnownSteadyState:
        """What is known at a speed: nothing where the motion breaks off, whatever was found there."""
        one = self.known[speed]
        return replace(one, found=False) if any(b.low < speed < b.high for b in self.broken) else one

    def torque_rise(self, speed: float) -> float:
        """How much more torque [N m] the drives give at a speed greater by ``BESIDE``; 0 where that is unknown."""
        one = self.known[speed]
        faster = self.balance.along(lambda value: _faster(self.balance.rows(value)))
        further = faster.solve(np.array([speed]), one.h, one.rows[None])
        return float(further.torque[0] - one.torque) if further.found[0] else 0.0

    def continued(self, walks: Sequence[FollowedMotion], leap: float = LEAP) -> list[tuple[float, KnownSteadyState]]:
        """How far motions go on towards where each of ``walks`` leads, and what they are there: every step starts where
        the last two lead to, and ends near that, within the share ``leap`` of the motion's swing. All take their steps
        together."""
        left = [walk for walk in walks if not walk.over]
        while left:
            further = self._led_to(left, leap)
            for walk, motion in zip(left, further, strict=True):
                if motion is None:
                    walk.shorten(self._finest(walk.at))
                else:
                    walk.go(motion)
            left = [walk for walk in left if not walk.over]
        return [(walk.at, walk.motion) for walk in walks]

    def _led_to(self, walks: list[FollowedMotion], leap: float) -> list[KnownSteadyState | None]:
        """The motions that Newton's steps from where walks are expected next lead to, with as many harmonics as each
        needs; None where they lead nowhere, or so far that it is another."""
        expected = [walk.expected for walk in walks]
        guess, found = dict(enumerate(expected)), dict[int, KnownSteadyState]()
        for h in doubled(self.balance.fewest, MOST):
            which = [i for i in guess if walks[i].motion.h <= h]
            if not which:
                continue
            start = np.stack([fourier.resized(guess[i], h) for i in which])
            reached = self.balance.solve(np.array([walks[i].to for i in which]), h, start)
            for k, i in enumerate(which):
                if reached.found[k] and not reached.resolved[k]:
                    guess[i] = reached.rows[k]
                    continue
                del guess[i]
                near = leap * max(walks[i].motion.swing, ALIKE)
                if reached.found[k] and apart(reached.rows[k], expected[i]) <= near:
                    found[i] = KnownSteadyState.of(reached, k)
        return [found.get(i) for i in range(len(walks))]

    def _solve(self, speeds: Array) -> None:
        """From rigid shafts, where that leads nowhere from the nearest motion found; harmonics doubled until they are
        enough."""
        asked, guess, orders = speeds, None, doubled(self.balance.fewest, MOST)
        for h in orders:
            if not len(speeds):
                break
            guess = None if guess is None else fourier.resized(guess, h)
            motions = self._from_neighbours(self.balance.solve(speeds, h, guess))
            enough = motions.resolved | ~motions.found | (h == orders[-1])
            for i in np.flatnonzero(enough):
                self.known[float(speeds[i])] = KnownSteadyState.of(motions, i)
            speeds, guess = speeds[~enough], motions.rows[~enough]
        for speed in asked.tolist():
            if not self.known[speed].settled:
                self._follow_to(speed)

    def _follow_to(self, speed: float) -> None:
        """Look for a motion by steps from the nearest ones known on both sides, then from farther away, where none
        breaks off between."""
        if any(one.low < speed < one.high for one in self.broken):
            return
        for begin, start in self._about(speed):
            reached, motion = self.continued([FollowedMotion(start, begin, speed)])[0]
            if reached == speed:
                self.known[speed] = motion
                return

    def _about(self, speed: float) -> Iterator[tuple[float, KnownSteadyState]]:
        """Motions beside a speed, and where."""
        there = np.array([one for one, motion in self.known.items() if motion.settled])
        for side in (there[there < speed].max(initial=-np.inf), there[there > speed].min(initial=np.inf)):
            if np.isfinite(side):
                yield float(side), self.known[float(side)]
        away = self.balance.solve(self._aside(speed), self.balance.fewest)
        for i in np.flatnonzero(away.found & away.resolved):
            yield float(away.value[i]), KnownSteadyState.of(away, i)

    def _aside(self, value: float) -> Array:
        """Values at which one begins to follow a motion to ``value`` that is not found otherwise."""
        low, high = self.ends
        return np.clip(value + (high - low) * (AWAY - 1), low, high)

    def _finest(self, value: float) -> float:
        """How closely one locates where a motion ends."""
        return CLOSE * (self.ends[1] - self.ends[0])

    def _from_neighbours(self, motions: SteadyStates) -> SteadyStates:
        """With those that were not found looked for again from the nearest that were, outwards."""
        found, rows, torque = motions.found.copy(), motions.rows.copy(), motions.torque.copy()
        lost = np.flatnonzero(~found)
        while len(lost) and found.any():
            there = np.flatnonzero(found)
            apart = np.abs(motions.value[lost][:, None] - motions.value[there])
            next_to = np.argsort(apart.min(axis=1))[0]
            i, near = lost[next_to], there[apart[next_to].argmin()]
            one = self.balance.solve(motions.value[[i]], motions.h, rows[[near]])
            found[i], rows[i], torque[i] = one.found[0], one.rows[0], one.torque[0]
            lost = np.delete(lost, next_to)
        return SteadyStates(self.balance, motions.value, found, rows, torque)


class SteadyStatesBySpeed(SteadyStateCurve):
    """The motions of one line over its speed [rad/s]: the orders and the stability along a range ask for the same."""

    def __init__(self, line: Driveline, *, compiled: bool = True) -> None:
        """``compiled`` : as of ``FreeBalance``."""
        self.line, self.compiled = line, compiled
        self.known, self.broken = {}, ()

    @cached_property
    def obstacle(self) -> str:
        """Why there is no balance of smooth equations for all speeds; empty where there is."""
        if mean_by_load(self.line) and loaded_by_speed(assemble(unexcited(self.line))):
            return "the mean of its clutch changes with the speed besides"
        if with_stages(prepared(self.unexcited, 1.0, linearised=True)):
            return "it has stages or play besides"
        return ""

    @cached_property
    def unexcited(self) -> Assembly:
        """The line without excitation, clutches that state a motion as their mean."""
        return assemble(with_mean_clutches(assemble(unexcited(self.line)), 1.0))

    @cached_property
    def balance(self) -> FreeBalance:
        """What solves them."""
        period = 2 * np.pi * float(require_period(self.unexcited.line, self.unexcited.topology))
        return FreeBalance(self.unexcited, period, compiled=self.compiled)

    def by_speed(self, table: Array) -> Flags:
        """Whether any torque depends on the speed (case,)."""
        return np.full(len(table), loaded_by_speed(self.unexcited))

    def _aside(self, value: float) -> Array:
        return value * AWAY

    def _finest(self, value: float) -> float:
        return CLOSE * abs(value)


def breaks(solved: SteadyStateCurve, speeds: Array, *, between: bool = True) -> tuple[Break, ...]:
    """Those between the lowest and the highest of ``speeds`` (speed,) [rad/s], looked for between all of them.

    ``between`` : False where what happens between two neighbours matters to neither: they belong together where each
    leads to the other in one step, be it a large one.
    """
    speeds = np.unique(speeds)
    solved.at_all(speeds)
    usable = [speed for speed in speeds.tolist() if solved.known[speed].settled]
    low, high = float(speeds[0]), float(speeds[-1])
    if not usable:
        return (Break(low, high, NONE),)
    walk = BranchWalk(solved, low, high)
    pairs = walk.apart(list(pairwise(usable)), closely=between)
    found = merged([*walk.outside(usable[0], low), *walk.between(pairs), *walk.outside(usable[-1], high)])
    return tuple(walk.with_outer_motions(one, usable) for one in found)


def merged(found: Iterable[Break]) -> Iterator[Break]:
    """Those that overlap as one."""
    left = sorted(found, key=lambda one: one.low)
    while left:
        one = left.pop(0)
        while left and left[0].low <= one.high:
            other = left.pop(0)
            one = Break(one.low, max(one.high, other.high), max(one.why, other.why))
        yield one


@dataclass(frozen=True)
class BranchWalk:
    """From motion to motion between two speeds [rad/s]."""

    solved: SteadyStateCurve
    low: float
    high: float
    leap: float = LEAP

    def outside(self, speed: float, end: float) -> Iterator[Break]:
        """What lies between the outermost motion found and the end of the range."""
        last = self._continued([(speed, end)])[0]
        if last != end:
            yield Break(min(last, end), max(last, end), NONE)

    def apart(self, pairs: list[tuple[float, float]], *, closely: bool) -> list[tuple[float, float]]:
        """Pairs of neighbours that do not lead to each other in one step, not in a large one either unless
        ``closely``."""
        together = self._lead_over(pairs, LEAP)
        if not closely:
            back = self._lead_over([(b, a) for a, b in pairs], FAR_LEAP)
            over = self._lead_over(pairs, FAR_LEAP)
            together = [one or (up and down) for one, up, down in zip(together, over, back, strict=True)]
        return [pair for pair, same in zip(pairs, together, strict=True) if not same]

    def between(self, pairs: list[tuple[float, float]]) -> Iterator[Break]:
        """What lies between neighbours of which neither leads to the other."""
        reached = zip(pairs, self._continued(pairs), strict=True)
        lost = [(pair, up) for pair, up in reached if up != pair[1]]
        back = self._continued([(b, a) for (a, b), _ in lost])
        for ((a, _), up), down in zip(lost, back, strict=True):
            if down != a:
                yield Break(min(up, down), max(up, down), SEVERAL if up > down else NONE)

    def with_outer_motions(self, found: Break, speeds: list[float]) -> Break:
        """The same break; of several motions that are known at a fold, the one that goes on outside, up to where the
        line is judged by it."""
        below = max((speed for speed in speeds if speed < found.low), default=found.low)
        above = min((speed for speed in speeds if speed > found.high), default=found.high)
        for begin, fold in ((below, found.low), (above, found.high)):
            reached, motion = self.solved.continued([FollowedMotion(self.solved.known[begin], begin, fold)])[0]
            if reached == fold:
                self.solved.known[fold] = motion
        return found

    def _lead_over(self, pairs: list[tuple[float, float]], leap: float) -> list[bool]:
        """Of pairs of speeds whether the motion at the first leads to that at the second in one step, of no more than
        the share ``leap`` of its swing."""
        known, found = self.solved.known, [False] * len(pairs)
        orders = [max(known[a].h, known[b].h) for a, b in pairs]
        near = [apart(known[a].rows, known[b].rows) <= leap * known[a].swing for a, b in pairs]
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

    def _continued(self, ways: list[tuple[float, float]]) -> list[float]:
        """How far the motions at the first of each pair of speeds go on towards the second: that where it leads to the
        one known there, else as far as it goes, past that speed too where the one known there is another."""
        known = self.solved.known
        walks = [FollowedMotion(known[begin], begin, aim) for begin, aim in ways]
        found = self.solved.continued(walks, self.leap)
        others = [i for i, way in enumerate(ways) if self._meets_another(*found[i], way[1])]
        past = [
            FollowedMotion(found[i][1], ways[i][1], self.high if ways[i][1] > ways[i][0] else self.low) for i in others
        ]
        for i, one in zip(others, self.solved.continued(past, self.leap), strict=True):
            found[i] = one
        for at, motion in found:
            if at not in known or not known[at].settled:
                known[at] = motion
        return [at for at, _ in found]

    def _meets_another(self, at: float, motion: KnownSteadyState, aim: float) -> bool:
        """Whether a motion that leads as far as ``aim`` is another one than that known there."""
        goal = self.solved.known.get(aim)
        return at == aim and goal is not None and goal.settled and apart(motion.rows, goal.rows) > ALIKE
