"""What the checks look at: the line under each of its load cases, over the speeds that it runs at."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from math import isclose
from typing import TYPE_CHECKING

import numpy as np

from trunnion.arrays import Array, Codes, Complex
from trunnion.design.assessment.cause import Cause
from trunnion.design.assessment.driven_motions import SWINGS, lost_motions, ranges_about_motions
from trunnion.design.assessment.measures import Measure, measures, torque_measures, torque_name
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.mean_balance import SAME, mean_speeds, own_speed
from trunnion.driveline.operating_speed import runs_by_itself
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.steady_base import has_joint_angles, has_periodic_base, refuse_dragged
from trunnion.errors import ComputationError, InputError
from trunnion.floquet.ranges.resonances import resonances, varies
from trunnion.floquet.ranges.span import Gap, SmoothRange, Span
from trunnion.floquet.ranges.straight import straight_ranges
from trunnion.floquet.ranges.unstable import UnstableRanges, unstable_ranges
from trunnion.floquet.stability.stability_over_speed import StabilityOverSpeed, stability_along
from trunnion.laws.harmonic import turning
from trunnion.modes.loaded_modes import loaded_modes
from trunnion.response.orders.response import response_of_spectrum, steady_states_of
from trunnion.response.orders.result import OrderResponse
from trunnion.response.ranges.largest import PASSED, Largest, first_speeds, search, sharpened, thinned
from trunnion.results.verdict import Verdict
from trunnion.results.words import Words
from trunnion.steady.orders.amplitudes import joined
from trunnion.steady.orders.spectrum import order_spectrum
from trunnion.waiting import OutOfTime

if TYPE_CHECKING:
    from trunnion.design.fatigue.result import FatigueLife
    from trunnion.steady.free.periodic_steady_states import SteadyStatesBySpeed

NO_RESPONSE = "no linear response: "
"""How checks that need the response begin to say why there is none."""
UNSTABLE = "the line is unstable there"
AT_END, ASIDE, RISE = 1e-6, 1e-5, 3.0
"""Shares of a speed within which a largest value stands at the end of a range, and how far inside one looks again: a
value that is larger by more than this factor at the end has no bound there."""


@dataclass(frozen=True)
class SearchEffort:
    """How closely a range is searched: speeds of the even grid, and the share of a largest value that may be missing;
    for lines of which every speed takes a motion of its own, ``costly`` speeds of the even grid; the share of a speed
    at which a limit is ``passed`` that may be missing; whether the mode that leads is ``named``."""

    points: int
    tolerance: float
    costly: int
    passed: float = PASSED
    named: bool = True


WHOLE = SearchEffort(65, 1e-6, 33)
QUICK = SearchEffort(25, 1e-4, 9)
"""To look around."""
TRIAL = SearchEffort(25, 1e-4, 9, 1e-3, named=False)
"""To look around among many lines, of which few are looked at again."""
OF_OWN_MOTIONS = 3e-6
"""Share of a value that may be missing because an periodic steady state, about which it is computed, is known no more
closely."""


@dataclass(frozen=True)
class AssessmentInput:
    """The line, its running range [rad/s], its operating speed [rad/s] or None, the unit of speeds, its cases.

    naming: whether what grows is named, which takes far longer than to find that it grows.
    """

    line: Driveline
    low: float
    high: float
    speed: float | None
    unit: str
    cases: tuple[LoadCaseResponse, ...]
    naming: bool = True

    def shown(self, speed: float) -> str:
        """A speed in the unit of the description."""
        return Words(self.unit).speed(speed, 5)

    def ranges(self, ends: Iterable[tuple[float, float]]) -> str:
        """ "300 rpm to 400 rpm and 500 rpm"."""
        words = [(self.shown(a), self.shown(b)) for a, b in ends]
        return " and ".join(f"{a} to {b}" if a != b else a for a, b in words)

    @cached_property
    def fatigue(self) -> FatigueLife | str:
        """Damage and life over what the description says that the line does, or why there is none."""
        # Loaded where needed: it brings the compiler with it.
        from trunnion.design.fatigue.fatigue import fatigue

        try:
            return fatigue(self.line)
        except (InputError, ComputationError) as error:
            return str(error).splitlines()[0]
        except OutOfTime as error:
            if not self.cases[0].partly:
                raise
            return f"not counted: {error.why}"

    def required(self, element: str) -> float:
        """Largest margin that the description requires of an element."""
        return max((one.margin for one in self.line.limits_by_element if one.element == element), default=0.0)


@dataclass(frozen=True)
class LargestShare:
    """The largest share of a limit: at which of the speeds, value and limit there, values and limits (speed,), and what
    the value may be low by; ``end``: what ends at that speed, where values grow without bound towards it."""

    at: int
    value: float
    limit: float
    error: float
    values: Array
    limits: Array
    end: str = ""


@dataclass(frozen=True)
class LoadCaseResponse:
    """The line under one load case ("" as stated), over a range of speeds.

    ``given``: speeds to judge it at instead of searching; ``known``: its response there, where that is known already;
    ``rough``: to look around, see ``order_spectrum``; ``partly``: where a time limit ends a search, go on with what
    there is, ``ended_by`` saying so, instead of passing it on; ``torques``: springs of which torques are looked for
    beside what the checks look at, as of ``torque_measures``; ``follows``: what changes with the speed besides, see
    ``Span``; ``alike``: the same with other excitations, see ``other_excitations``.
    """

    name: str
    assembly: Assembly
    low: float
    high: float
    effort: SearchEffort = WHOLE
    given: tuple[float, ...] = ()
    known: OrderResponse | None = None
    rough: bool = False
    partly: bool = False
    torques: tuple[tuple[str, int], ...] = ()
    follows: Span | None = field(default=None, repr=False)
    alike: LoadCaseResponse | None = field(default=None, repr=False)

    @cached_property
    def span(self) -> Span:
        """The range, and where the line itself changes within it."""
        if self.alike is not None:
            return replace(self.alike.span, assembly=self.assembly)
        cuts = {cut for one in self.measures for cut in one.cuts}
        if self.follows is not None:
            points = tuple(sorted({*self.follows.points, *cuts}))
            return replace(self.follows, low=self.low, high=self.high, points=points)
        span = Span(self.assembly, self.low, self.high, points=tuple(sorted(cuts)))
        if not self._searches_motions:
            return span
        assert self.motions is not None
        return replace(span, lost=lost_motions(span, self.motions, self.effort.costly))

    @property
    def _searches_motions(self) -> bool:
        """Whether the periodic steady state of every speed is taken, over a range."""
        if self.given or self.rough or self.known is not None or not self.low < self.high or not self.costly:
            return False
        if lossy(self.assembly) or self.assembly.topology.dragged or self.motions is None:  # the checks say so
            return False
        return not self.motions.obstacle

    @cached_property
    def measures(self) -> tuple[Measure, ...]:
        """What is looked for."""
        return (*measures(self.assembly), *torque_measures(self.assembly, self.torques))

    @cached_property
    def speeds(self) -> Array:
        """Speeds [rad/s] that were looked at, rising."""
        if self.known is not None:
            return self.known.speed
        if self.given:
            return np.array(self.given)
        return self.response.speed if self.response is not None else np.array([self.high])

    @cached_property
    def answer(self) -> OrderResponse | str:
        """The linear response by order, or why there is none."""
        if self.known is not None:
            return self.known
        try:
            if self.given:
                spectrum = self.respond(np.array(self.given)).spectrum
                return self._judged(response_of_spectrum(self.assembly, spectrum))
            found = self.searched
            if found.ended:
                self.end(OutOfTime(found.ended))
            return self._judged(found.response)
        except (InputError, ComputationError) as error:
            return str(error).splitlines()[0]
        except OutOfTime as error:
            self.end(error)
            return error.why

    @cached_property
    def ended_by(self) -> list[str]:
        """What ended searches before they were done, a time limit; none where all were."""
        return []

    def end(self, error: OutOfTime) -> None:
        """Keep what ended a search and go on with what there is, where that is wanted; otherwise pass it on."""
        if not self.partly:
            raise error
        self.ended_by.append(error.why)

    @cached_property
    def searched(self) -> Largest:
        """The largest shares of all limits, over all that is stable.

        Raises
        ------
        InputError, ComputationError : there is no response.
        """
        pieces = self.stable_pieces
        if not pieces:
            raise ComputationError(self.gaps[0].why if self.gaps else UNSTABLE)
        quantities = [one.quantity for one in self.measures]
        first = self._first_speeds
        if self.costly and not self.rough:
            first = thinned(self.around, pieces, quantities, self.effort.costly)
        return search(
            self.assembly, self.respond, first, quantities,
            tolerance=self.effort.tolerance, passed=self.effort.passed, known=self._known_at(np.concatenate(first)),
        )  # fmt: skip

    @cached_property
    def around(self) -> OrderResponse:
        """What a rough look at the whole range shows, of a line that takes long at every speed.

        Raises
        ------
        InputError, ComputationError : there is no response.
        """
        rough, quantities = replace(self, rough=True), [one.quantity for one in self.measures]
        return search(
            self.assembly, rough.respond, self._first_speeds, quantities, tolerance=0.01, passed=np.inf
        ).response

    @cached_property
    def _first_speeds(self) -> list[Array]:
        if self.alike is not None:
            return self.alike._first_speeds
        return self._speeds_of(self.stable_pieces)

    @cached_property
    def first_look(self) -> OrderResponse | None:
        """The response at the speeds at which the search begins, without remarks: no value is smaller than there. None
        where there is none, or every speed takes a motion of its own."""
        if self.given or self.known is not None or self.costly or not self.stable_pieces:
            return None
        if "_everywhere" in self.__dict__ and self.stable_pieces == self.span.pieces:
            return self._everywhere
        try:
            return self.respond(np.concatenate(self._first_speeds))
        except (InputError, ComputationError):  # as the search then says
            return None

    def _known_at(self, speeds: Array) -> OrderResponse | None:
        """The response at rising ``speeds`` where parts of it are known already, the others solved; None where nothing
        is."""
        if "first_look" in self.__dict__:
            return self.first_look
        before = self.__dict__.get("_everywhere")
        if before is None or np.any(np.diff(speeds) <= 0) or not (shared := np.isin(before.speed, speeds)).any():
            return None
        parts, missing = [before.spectrum.take(np.flatnonzero(shared))], np.setdiff1d(speeds, before.speed)
        if len(missing):
            parts.append(self.respond(missing).spectrum)
        return response_of_spectrum(self.assembly, joined(parts)[0], remarked=False)

    def surely_exceeds(self, name: str) -> bool:
        """Whether the first look shows already that the check called ``name`` is exceeded."""
        measure = next((one for one in self.measures if one.name == name), None)
        if measure is None or (seen := self.first_look) is None:
            return False
        return bool(np.any(measure.shares(seen) > 1))

    def respond(self, speeds: Array) -> OrderResponse:
        """The response at ``speeds`` [rad/s], its verdicts not judged, without remarks."""
        table = self.span.table(speeds) if self.span.put else None
        spectrum = order_spectrum(
            self.assembly, speeds, table=table, rough=self.rough, motions=None if self.rough else self.motions
        )
        return response_of_spectrum(self.assembly, spectrum, remarked=False)

    def largest(self, measure: Measure) -> LargestShare:
        """Where a measure comes nearest to its limit, or goes farthest beyond it."""
        response = self.answered
        values, limits = measure.values(response), measure.limit(response)
        shares = measure.shares(response)
        at = int(np.argmax(shares))
        limit = float(limits[at]) if np.isfinite(limits[at]) else _nearest(response.speed, limits, at)
        error = self._error(measure) * limit if not self.given and self.known is None else np.nan
        value = float(values[at]) if np.isfinite(values[at]) else np.inf
        end = self._unbounded(measure, float(response.speed[at]), float(shares[at]))
        return LargestShare(at, np.inf if end else value, limit, float(error), values, limits, end)

    def _unbounded(self, measure: Measure, speed: float, share: float) -> str:
        """What ends at a ``speed`` towards which a share of a limit grows without bound; empty where it does not.

        At the end of an unstable range a mode does not decay; where an periodic steady state folds, a little torque
        changes it much.
        """
        for gap in self.gaps:
            for end, away in ((gap.low, -ASIDE), (gap.high, ASIDE)):
                beside = end * (1 + away)
                if abs(speed / end - 1) > AT_END or not any(p.low <= beside <= p.high for p in self.stable_pieces):
                    continue
                if beside not in self._beside:
                    self._beside[beside] = self.respond(np.array([beside]))
                if not share <= RISE * measure.shares(self._beside[beside])[0]:
                    return "stable speeds" if gap.why == UNSTABLE else "the speeds of one periodic steady state"
        return ""

    @cached_property
    def _beside(self) -> dict[float, OrderResponse]:
        """The response next to ends of gaps, by speed, which many measures ask for."""
        return {}

    def _error(self, measure: Measure) -> float:
        place = next((i for i, one in enumerate(self.measures) if one.name == measure.name), -1)
        if place < 0:
            return np.nan
        own = OF_OWN_MOTIONS * self.searched.value[place] if self.costly and not self.rough else 0.0
        return float(self.searched.error[place] + own)

    def largest_torque(self, word: str, spring: int) -> tuple[float, float]:
        """Largest "peak" or "vibratory" torque [N m] of a spring that is among ``torques``, infinite where there is no
        steady state, and its speed [rad/s]."""
        name = torque_name(word, spring)
        found = self.largest(next(one for one in self.measures if one.name == name))
        return found.value, float(self.speeds[found.at])

    def largest_growth(self) -> tuple[float, float] | None:
        """Largest growth rate [1/s] over the range and its speed, NaN where it is the same everywhere; of a line that
        nothing varies, its slowest decay. None where it cannot be told."""
        try:
            along = self.along
        except (InputError, ComputationError):
            return None
        rates = along.growth_rate
        if not np.any(np.isfinite(rates)):
            return None
        at = int(np.nanargmax(rates))
        everywhere = not self.parametric and np.nanmax(rates) - np.nanmin(rates) <= 1e-9 * abs(rates[at])
        return float(rates[at]), np.nan if everywhere else float(along.speed[at])

    def peak(self, name: str, speed: float) -> float:
        """The speed of the top that the measure called ``name`` has about ``speed``, located to differentiate there;
        ``speed`` where it is not a top."""
        measure = next((one for one in self.measures if one.name == name), None)
        grid, at = self.speeds, int(np.searchsorted(self.speeds, speed))
        if measure is None or self.given or not 0 < at < len(grid) - 1 or grid[at] != speed:
            return speed
        ends = float(grid[at - 1]), float(grid[at + 1])
        inside = any(piece.low <= ends[0] and ends[1] <= piece.high for piece in self.stable_pieces)
        return sharpened(self.respond, measure.quantity, (ends[0], speed, ends[1])) if inside else speed

    def prepare(self) -> None:
        """Compute what the checks look at, so that cases can do it side by side."""
        _ = self.answer
        with suppress(InputError, ComputationError):  # said where it is looked at
            _ = self.modes, self.unstable

    def respond_all(self) -> None:
        """Compute the response, so that cases can do it side by side."""
        _ = self.answer

    @property
    def costly(self) -> bool:
        """Whether every speed takes a motion of its own."""
        return has_periodic_base(self.assembly)

    @property
    def parametric(self) -> bool:
        """Whether a joint or a mesh makes the line's coefficients vary."""
        return varies(self.assembly)

    @cached_property
    def motions(self) -> SteadyStatesBySpeed | None:
        """The periodic steady states that response and stability are taken about, of a free–free line with joint
        angles."""
        return steady_states_of(self.assembly) if self.alike is None else self.alike.motions

    @property
    def unstable(self) -> UnstableRanges:
        """Stability over the range, and the speeds at which a disturbance grows.

        Raises
        ------
        InputError : there are no equations in time, or no motion that all speeds share (NoSharedMotion).
        """
        if self.alike is not None:
            return self.alike.unstable
        found = self._stability_over_range
        if isinstance(found, Exception):
            raise found
        return found

    @cached_property
    def _stability_over_range(self) -> UnstableRanges | InputError | ComputationError:
        """That, or why there is none: many ask, and each would look at the range again."""
        try:
            return self._unstable_ranges()
        except (InputError, ComputationError) as error:
            return error

    def _unstable_ranges(self) -> UnstableRanges:
        if self.costly:
            refuse_dragged(self.assembly)  # before anything is solved
        if not self.parametric:
            return straight_ranges(self.span)
        points = self.effort.costly if self.costly else self.effort.points
        if self.swing >= SWINGS:
            given = np.array(self.given)
            return ranges_about_motions(self.span, self.swing, points, given, partial(self._about_static_twist, points))
        return self._about_static_twist(points)

    def _about_static_twist(self, points: int) -> UnstableRanges:
        """Of a driven line; of others about the motions that they make."""
        if self.given:
            return UnstableRanges(self._stability(np.unique(self.given)), (), 0.0, ())
        return unstable_ranges(self.span, self._stability, points=points)

    def _stability(self, speeds: Array) -> StabilityOverSpeed:
        table = self.span.table(speeds) if self.span.put else None
        return stability_along(self.assembly, speeds, motions=self.motions, table=table)

    @cached_property
    def swing(self) -> float:
        """How far the inputs of joints swing [rad] at most, all over the range and at resonances, by linear theory, of
        a driven line with joint angles; 0 of others, and where there is no response."""
        if self.assembly.topology.free or not has_joint_angles(self.assembly):
            return 0.0
        found = self._everywhere
        return (
            0.0 if found is None else float(np.nan_to_num(found.joint_rotation, nan=1.0, posinf=1.0).max(initial=0.0))
        )

    @cached_property
    def _everywhere(self) -> OrderResponse | None:
        """The response of a driven line at speeds all over the range and at resonances, stable or not; None where there
        is none."""
        speeds = np.unique(self.given) if self.given else np.concatenate(self._speeds_of(self.span.pieces))
        try:
            return self.respond(speeds)
        except (InputError, ComputationError):  # as the search then says
            return None

    def _speeds_of(self, pieces: tuple[SmoothRange, ...]) -> list[Array]:
        return first_speeds(pieces, resonances(self.span), self.effort.points)

    @property
    def along(self) -> StabilityOverSpeed:
        """Stability at the speeds at which it was looked at."""
        return self.unstable.along

    @cached_property
    def stable_pieces(self) -> tuple[SmoothRange, ...]:
        """Pieces of the range in which torques mean something."""
        if self.alike is not None:
            return self.alike.stable_pieces
        if self.rough:  # to look around, the motion counts whether it is reached or not
            return self.span.pieces
        try:
            return tuple(self.unstable.stable_part(self.span.pieces))
        except (InputError, ComputationError):  # it cannot be told; the check of stability says so
            return self.span.pieces
        except OutOfTime as error:
            self.end(error)
            return self.span.pieces

    @cached_property
    def gaps(self) -> tuple[Gap, ...]:
        """Speeds at which no torque is judged, and why."""
        if self.given or self.known is not None:
            return ()
        if self.alike is not None:
            return self.alike.gaps
        ranges: tuple[tuple[float, float], ...] = ()
        try:
            ranges = () if self.rough else self.unstable.ranges
        except OutOfTime as error:
            self.end(error)
        except (InputError, ComputationError):
            pass
        return (*self.span.gaps, *(Gap(low, high, UNSTABLE) for low, high in ranges))

    def _judged(self, found: OrderResponse) -> OrderResponse:
        """With its verdicts: those of the nearest speeds at which stability was looked at."""

        def verdicts() -> Codes:
            try:
                along = self.along
            except (InputError, ComputationError):
                return np.full(len(found.speed), Verdict.FAILED, dtype=np.int8)
            inside = np.any([(found.speed > a) & (found.speed < b) for a, b in self.unstable.ranges], axis=0)
            undecided = self.unstable.undecided[np.abs(found.speed[:, None] - along.speed).argmin(axis=1)]
            code = np.where(undecided & ~inside, Verdict.UNDECIDED, np.where(inside, Verdict.UNSTABLE, Verdict.STABLE))
            return np.broadcast_to(code, found.speed.shape).astype(np.int8)

        return found if self.rough else replace(found, judged=verdicts).knowing(found.known_ranges)

    @property
    def response(self) -> OrderResponse | None:
        """The linear response by order; None where there is none."""
        return self.answer if isinstance(self.answer, OrderResponse) else None

    @property
    def answered(self) -> OrderResponse:
        """The linear response by order, where one knows that there is one."""
        assert isinstance(self.answer, OrderResponse)
        return self.answer

    @cached_property
    def modes(self) -> Complex:
        """Eigenvalues (speed, mode) [1/s] of the loaded line, joints straight, at ``speeds``."""
        return loaded_modes(self.assembly, self.speeds, self.span.table(self.speeds))[0]

    @property
    def first(self) -> int:
        """Number of the first elastic mode: 2 where the line can turn as a whole, say."""
        return 1 + self.assembly.topology.still

    @property
    def suffix(self) -> str:
        """How sentences name the case."""
        return f", load case {self.name}" if self.name else ""


def lossy(assembly: Assembly) -> bool:
    """Whether anything damps all frequencies alike, which has no equations in time."""
    return bool(assembly.coefficients(assembly.table(1), any_frequency=True).loss.any())


def cases_of(
    line: Driveline, low: float, high: float, effort: SearchEffort = WHOLE, *, partly: bool = False
) -> tuple[LoadCaseResponse, ...]:
    """The line as stated and under each of its load cases, where it asks for it with every cylinder out of work.

    A line that runs by itself, asked where it does, settles at another speed under other loads.
    """
    settled = low == high and runs_by_itself(line) and _settles_at(line, low)
    found = []
    for name in ("", *line.cases):
        loaded = line.with_load(name) if name else line
        own = _own_speed(loaded) if name and settled else None
        ends = (low, high) if own is None else (own, own)
        found.append(LoadCaseResponse(name, assemble(loaded), *ends, effort, partly=partly))
    return tuple(found)


def _settles_at(line: Driveline, speed: float) -> bool:
    return any(isclose(one.speed, speed, rel_tol=SAME) for one in mean_speeds(line))


def _own_speed(line: Driveline) -> float | None:
    """None where there is none, or several: the response then says so."""
    try:
        return own_speed(line)
    except InputError:
        return None


def with_torques(cases: Iterable[LoadCaseResponse], asked: tuple[tuple[str, int], ...]) -> Iterator[LoadCaseResponse]:
    """Cases that look for torques besides; see ``LoadCaseResponse``."""
    return (replace(case, torques=asked) for case in cases)


def cause(case: LoadCaseResponse, at: int, size: Array) -> Cause | None:
    """Which order leads at speed number ``at``, of amplitudes ``size`` (order,), and the mode that it is nearest to; no
    such question where one only looks around."""
    response = case.response
    if case.rough or not case.effort.named or response is None or not len(size) or not np.nanmax(size, initial=0.0) > 0:
        return None
    k = int(np.nanargmax(size))
    order, extra = float(response.order[k]), float(response.frequency[k])
    frequency = float(turning(order, extra, case.speeds[at]))
    if frequency < 0:
        order, extra, frequency = -order, -extra, -frequency
    modes = case.modes[at].imag
    if not np.any(np.isfinite(modes)) or not frequency:
        return Cause(order, extra)
    m = int(np.nanargmin(np.abs(np.log(modes / frequency))))
    return Cause(order, extra, m + case.first, float(modes[m]), float(frequency / modes[m] - 1))


def _nearest(speed: Array, values: Array, at: int) -> float:
    """The finite one of ``values`` (speed,) nearest to a place, NaN without one: where a response has no bound, its
    mean, which a limit may rest on, is not known either."""
    known = np.flatnonzero(np.isfinite(values))
    return float(values[known[np.argmin(np.abs(speed[known] - speed[at]))]]) if len(known) else np.nan
