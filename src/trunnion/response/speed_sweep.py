"""Torque amplitudes over speed: all that ``order_response`` finds, taken together, without the orders."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Codes, Flags
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.steady_base import has_periodic_base
from trunnion.errors import ComputationError, InputError, InputRemark
from trunnion.floquet.ranges.resonances import resonances
from trunnion.floquet.ranges.span import SmoothRange, Span
from trunnion.floquet.stability.where_unstable import where_unstable
from trunnion.numerics.memory import require_estimate, require_memory
from trunnion.response.orders.response import (
    completed_response,
    has_rating,
    one_motion_each,
    order_response,
    response_about,
    steady_states_of,
)
from trunnion.response.orders.result import OrderResponse
from trunnion.response.ranges.largest import SearchedQuantity, first_speeds, search, thinned
from trunnion.results.counts import counted
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import computed, coordinate, internal, labelled, variable
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.results.result import Result
from trunnion.results.stretches import largest_over, stretches_above
from trunnion.results.variables import Attribute, Variable, attributes
from trunnion.steady.orders.forced_response import LINEAR_RANGE
from trunnion.steady.orders.spectrum import SearchCost, search_cost

if TYPE_CHECKING:
    from trunnion.driveline.operation import Operation
    from trunnion.steady.free.periodic_steady_states import SteadyStatesBySpeed

CLUSTER = np.array([-6.0, -3.0, -1.5, -0.75, -0.3, 0.0, 0.3, 0.75, 1.5, 3.0, 6.0])
"""Extra speeds about each resonance of the forced response, in half-widths of its peak: what draws it."""
FEW = 65
"""Speeds of the even grid from which the largest torques are looked for."""

LONG = 16
"""Unknowns from which on what a search costs is estimated before it begins."""
MOST_SEARCHED = 600.0
"""Processor time [s] beyond which a range is not searched, as a number of speeds can be asked for in its place."""
TRIED = 12
"""Speeds that tell about how many harmonics all of them take."""
SEARCHED = 1.1
"""Speeds that a search looks at, of each that it begins with."""

STATE_SPEEDS = "ask for a number of speeds, such as --speed 600rpm:3000rpm:41, or state smaller joint angles"


@labelled
class SpeedSweep(Result):
    """Linear forced response over speed; mean torque is negative where power flows from input to output."""

    speed: Array = coordinate("speed", "rad/s")
    shafts: tuple[str, ...] = coordinate("shaft")
    twist_amplitude: Array = variable("speed shaft", "rad", "half peak to peak")
    torque_amplitude: Array = variable("speed shaft", "N*m", "half peak to peak")
    torque_mean: Array = variable("speed shaft", "N*m")
    joint_rotation: Array = variable("speed", "rad", "largest deviation at any joint's input")
    cut_off: Array = variable("speed", "1", "size of the outermost harmonics kept, of the largest torque")
    remarks: tuple[Finding, ...] = internal("what of the line is left out")
    unit: str = internal("of speeds in print")
    judged: Callable[[], Codes] = internal("computes the verdict")
    lossy: bool = internal("whether a loss factor holds at all frequencies")

    @cached_property
    def verdict(self) -> Codes:
        """Stability of the motion (speed,), codes of ``Verdict``; FAILED where it is not judged."""
        return self.judged()

    @property
    @computed(variable("speed"), after="joint_rotation")
    def linear(self) -> Flags:
        """Where the amplitudes can be trusted (speed,)."""
        return np.asarray(self.joint_rotation <= LINEAR_RANGE)

    def peak(self, shaft: str) -> tuple[float, float]:
        """Largest torque amplitude of a shaft [N m] and the speed it stands at [rad/s]; NaN without a steady state."""
        return largest_over(self.speed, self.torque_amplitude[:, self.shafts.index(shaft)])

    def declared(self) -> Iterator[Variable | Attribute]:
        """Amplitudes over (speed, shaft)."""
        yield from super().declared()
        yield from attributes(linear_range=LINEAR_RANGE)

    def plot(self, axes: Axes | None = None, *, unit: str = "", operating: Operation | None = None) -> Axes:
        """Torque amplitude of every shaft over speed; see ``pictures.orders.speed_sweep``."""
        return drawing(self, "plot")(self, axes, unit=unit, operating=operating)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What to read first, gravest first: where there is no motion or an unstable one, what is left out."""
        unstable = where_unstable(self.speed, self.verdict, self.words, lossy=self.lossy)
        return by_gravity([*self._without_motion(), *unstable, *self.remarks])

    def _without_motion(self) -> Iterator[Finding]:
        order = np.argsort(self.speed)
        lost = ~np.all(np.isfinite(self.torque_amplitude[order]), axis=1)
        if lost.any():
            where = self.words.ranges(stretches_above(self.speed[order], lost.astype(float), 0.5, between=False))
            yield Finding(
                Gravity.DANGER,
                f"No steady state exists at {where}: an excitation meets a free motion that nothing damps, as without "
                "damping or on the edge of an instability; amplitudes there are NaN, next to it without bound.",
            )

    def _lines(self) -> Iterator[str]:
        yield f"linear forced response at {counted(len(self.speed), 'speed')}"
        for shaft in self.shafts:
            torque, at = self.peak(shaft)
            known = f"torque amplitude up to {torque:.4g} N m at {self.words.speed(at)}"
            yield f"  {shaft}: {'no steady state at any speed' if np.isnan(torque) else known}"
        beyond = int(np.count_nonzero(~self.linear))
        if beyond:
            where, by = f"at {counted(beyond, 'speed')}", self.words.angle(LINEAR_RANGE)
            yield f"  {where} a joint's input deviates by more than {by}: indication only"


def speed_sweep(
    line: Driveline | Assembly,
    speeds: ArrayLike,
    *,
    statically_twisted: bool = True,
    progress: Callable[[float], None] | None = None,
) -> SpeedSweep:
    """Torque and twist amplitudes of every shaft at each of ``speeds`` [rad/s]; see ``sweep_speeds`` for a grid.

    Parameters
    ----------
    line : a ``Driveline`` or its ``Assembly``.
    speeds : (speed,) input speeds [rad/s].
    statically_twisted : as in ``stability``.
    progress : called as progress(share done).

    Raises
    ------
    InputError : speeds that are not positive; a line without steady base motion or with too long a period.
    ComputationError : a free–free line with joint angles has no periodic motion at a speed, or several.

    Examples
    --------
    >>> import trunnion as tn
    >>> shaft = tn.Shaft(stiffness=1e4, damping=2.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=0.1), shaft, tn.Disk(inertia=0.8)])
    >>> found = tn.speed_sweep(line, [40.0, 56.0, 70.0])
    >>> found.torque_amplitude.round(1)
    array([[  26.3],
           [1108.5],
           [  69.1]])
    """
    return sweep_of(order_response(line, speeds, statically_twisted=statically_twisted, progress=progress))


def sweep_of(found: OrderResponse) -> SpeedSweep:
    """A response without its orders."""
    return SpeedSweep(
        speed=found.speed, shafts=found.springs, twist_amplitude=found.vibratory_twist,
        torque_amplitude=found.vibratory_torque, torque_mean=found.mean_torque, joint_rotation=found.joint_rotation,
        cut_off=found.cut_off, remarks=found.remarks, unit=found.unit, judged=found.judged,
        lossy=bool(found.spectrum.loss.any()),
    )  # fmt: skip


def sweep_speeds(line: Driveline | Assembly, low: float, high: float, points: int = 241) -> Array:
    """Speeds [rad/s] from ``low`` to ``high``: ``points`` evenly, closer together about every resonance, and those at
    which a torque of any spring is largest.

    An even grid alone would step over the peaks of lightly damped modes. The largest torques over the range are those
    at these speeds, to 0.1 % (``response.ranges.largest``). Where they cannot be looked for, the even grid is all there
    is, which an ``InputRemark`` says, with the reason.

    Parameters
    ----------
    line : a ``Driveline`` or its ``Assembly``.
    low : lowest input speed [rad/s].
    high : highest input speed [rad/s].
    points : of the even grid.

    Raises
    ------
    InputError : as of ``order_response``; a long line whose search would take too long, with an estimate.
    ComputationError : as of ``response_over``.

    Examples
    --------
    >>> import trunnion as tn
    >>> shaft = tn.Shaft(stiffness=1e4, damping=2.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=0.1), shaft, tn.Disk(inertia=0.8)])
    >>> speeds = tn.sweep_speeds(line, 40.0, 70.0, 21)
    >>> print(len(speeds) > 21, speeds[[0, -1]])
    True [40. 70.]
    """
    assembly, even = assemble(line), _even(low, high, points)
    motions = steady_states_of(assembly)
    try:
        first = begun_with(assembly, even)
        too_long = _too_long(assembly, even, first)
        found = None if too_long else _searched(assembly, first, motions)
    except (InputError, ComputationError) as error:
        order_response(assembly, even[[0, -1]])  # what has no response at any speed is refused
        one_motion_each(assembly, even, motions, between=True)
        warnings.warn(InputRemark(_evenly(even, error)), stacklevel=2)
        return even
    if found is None:
        assert too_long is not None
        raise too_long
    speeds = _with(even, found.speed)
    one_motion_each(assembly, speeds, motions, between=True)
    return speeds


def response_over(
    line: Driveline | Assembly,
    low: float,
    high: float,
    orders: Iterable[float] | None = None,
    *,
    points: int = 241,
    known: OrderResponse | None = None,
    around: OrderResponse | None = None,
    motions: SteadyStatesBySpeed | None = None,
    progress: Callable[[float], None] | None = None,
) -> OrderResponse:
    """``order_response`` at the speeds of ``sweep_speeds``, each of them solved once; ``known``: the response where it
    was searched over this range already, and the ``motions`` that it is about; ``around``: what a rough look at the
    range showed before, of a line that takes long at every speed: then tops alone are looked at besides.

    Raises
    ------
    InputError : as of ``order_response``; a long line whose search would take too long, with an estimate.
    ComputationError : the motions of a free–free line with joint angles fold back within the range, so that several
        have one speed, be it between two of those looked at; or it has none at any.
    """
    assembly, even = assemble(line), _even(low, high, points)
    motions = motions or steady_states_of(assembly)
    try:
        first = begun_with(assembly, even)
        too_long = _too_long(assembly, even, first) if known is None else None
        found = None if too_long else _searched(assembly, first, motions, known, around)
    except (InputError, ComputationError) as error:  # refused by the response too, where it holds of any speed
        response = order_response(assembly, even, orders, progress=progress)
        one_motion_each(assembly, even, motions, between=True)
        remark = Finding(Gravity.CAUTION, _evenly(even, error))
        return replace(response, remarks=(remark, *response.remarks))
    if found is None:
        assert too_long is not None
        raise too_long
    speeds, solved = _with(even, found.speed), found.spectrum
    del found, known
    one_motion_each(assembly, speeds, motions, between=True)
    return completed_response(assembly, solved, speeds, orders, motions=motions, progress=progress)


def _even(low: float, high: float, points: int) -> Array:
    require_memory(64.0 * points, key="points", value=points, remedy="ask for fewer speeds")
    return np.linspace(low, high, points)


def _with(even: Array, found: Array) -> Array:
    every = np.union1d(even, found)
    return every[(every >= even[0]) & (every <= even[-1])]


def begun_with(assembly: Assembly, even: Array) -> list[Array]:
    """Speeds to begin with, by piece of the range.

    Raises
    ------
    InputError : the line is not known at any speed of the range.
    """
    span = Span(assembly, float(even[0]), float(even[-1]))
    if not span.pieces:
        raise InputError(f"is not known at these speeds: {span.gaps[0].why}", element="driveline")
    met = resonances(span)
    about = (met.speed[:, None] + np.maximum(met.width, 1e-9 * met.speed)[:, None] * CLUSTER).ravel()
    return [np.union1d(part, _between(about, part)) for part in first_speeds(span.pieces, met, FEW)]


def _evenly(even: Array, error: InputError | ComputationError) -> str:
    """That no peaks were looked for, and why."""
    return (
        f"speeds are an even grid of {len(even)} from {even[0]:.5g} rad/s to {even[-1]:.5g} rad/s, between which peaks "
        f"may lie: resonances and largest torques could not be looked for, as {error}"
    )


def cost_of_range(assembly: Assembly, even: Array, first: list[Array]) -> tuple[int, SearchCost]:
    """How many speeds a response over a range is solved at, about, on an ``even`` grid and by a search that begins with
    the speeds ``first``, by piece; and what that takes."""
    every = np.concatenate(first)
    some, speeds = np.append(every[:: -(-len(every) // TRIED)], every[-1]), len(even) + int(SEARCHED * len(every))
    return speeds, search_cost(assembly, some, speeds)


def _too_long(assembly: Assembly, even: Array, first: list[Array]) -> InputError | None:
    """What refuses to search a range of a long line, as ``cost_of_range``, where that would not end or fill the
    memory."""
    size = assembly.topology.size
    if size < LONG or has_periodic_base(assembly):  # whose motions are refused where they are solved
        return None
    speeds, cost = cost_of_range(assembly, even, first)
    what = f"its response over a range, at some {speeds} speeds with {cost.side_orders} side orders on either side,"
    try:
        require_estimate(size, what, cost.seconds, cost.memory, most=MOST_SEARCHED, remedy=STATE_SPEEDS)
    except InputError as error:
        return error
    return None


def _searched(
    assembly: Assembly,
    first: list[Array],
    motions: SteadyStatesBySpeed | None = None,
    known: OrderResponse | None = None,
    around: OrderResponse | None = None,
) -> OrderResponse:
    """The response at all speeds at which the search for the largest torques looked, from those on at which it is
    ``known``, and tops that ``around`` shows."""
    respond = partial(response_about, assembly, motions=motions)
    torques, parts = _torques(assembly), None if known is None else _by_piece(known.speed, first)
    if known is None or parts is None:
        return search(assembly, respond, first, torques).response
    if around is None:
        found = search(assembly, respond, parts, torques, known=known).response
        every = np.union1d(found.speed, np.concatenate(first))
        return completed_response(assembly, found.spectrum, every, motions=motions)
    pieces = [SmoothRange(part[0], part[-1]) for part in first]
    tops = np.concatenate([known.speed, *thinned(around, pieces, torques, FEW)])
    known = completed_response(assembly, known.spectrum, np.unique(tops), motions=motions)
    parts = _by_piece(known.speed, first)
    assert parts is not None  # more speeds of the same pieces
    return search(assembly, respond, parts, torques, known=known).response


def _by_piece(speeds: Array, first: list[Array]) -> list[Array] | None:
    """Rising ``speeds`` by the pieces that ``first`` are of, ends among them; None where these are others."""
    parts = [speeds[(speeds >= part[0]) & (speeds <= part[-1])] for part in first]
    whole = all(
        len(one) and one[[0, -1]].tolist() == part[[0, -1]].tolist() for one, part in zip(parts, first, strict=True)
    )
    return parts if whole and np.array_equal(np.concatenate(parts), np.unique(speeds)) else None


def _between(speeds: Array, part: Array) -> Array:
    return speeds[(speeds > part[0]) & (speeds < part[-1])]


def _torques(assembly: Assembly) -> list[SearchedQuantity]:
    """What is largest somewhere: torques of all springs, with their means and without."""

    def of(c: int, word: str) -> SearchedQuantity:
        return SearchedQuantity(lambda found: getattr(found, word)[:, c], lambda found: found.torque[:, :, c])

    def rated(c: int) -> SearchedQuantity:
        return SearchedQuantity(
            lambda found: found.rated_torque[:, c], lambda found: found.torque[:, :, c] * found.frequency_factor
        )

    springs = range(len(assembly.topology.compliances))
    every = [of(c, word) for c in springs for word in ("peak_torque", "vibratory_torque")]
    return [*every, *(rated(c) for c in springs if has_rating(assembly, c))]
