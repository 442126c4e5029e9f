"""Torque amplitudes over speed: all that ``order_response`` finds, taken together, without the orders."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Codes, Flags
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.errors import ComputationError, InputError
from trunnion.floquet.ranges.resonances import resonances
from trunnion.floquet.ranges.span import Span
from trunnion.floquet.stability.where_unstable import where_unstable
from trunnion.numerics.memory import require_memory
from trunnion.response.orders.response import has_rating, order_response, response_about
from trunnion.response.ranges.largest import Quantity, first_speeds, search
from trunnion.results.counts import counted
from trunnion.results.declared import Described, Held, axis, fields_over, over, remark
from trunnion.results.drawing import Axes, drawing
from trunnion.results.finding import Finding, by_gravity
from trunnion.results.speeds import show_speed
from trunnion.results.units import angle_words
from trunnion.steady.orders.forced_response import LINEAR_RANGE

if TYPE_CHECKING:
    from trunnion.driveline.operation import Operation

CLUSTER = np.array([-6.0, -3.0, -1.5, -0.75, -0.3, 0.0, 0.3, 0.75, 1.5, 3.0, 6.0])
"""Extra speeds about each resonance of the forced response, in half-widths of its peak: what draws it."""
FEW = 65
"""Speeds of the even grid from which the largest torques are looked for."""


@dataclass(frozen=True, repr=False)
class SpeedSweep(Described):
    """Linear forced response over speed.

    speed (speed,) of the input [rad/s]; twist_amplitude (speed, shaft) [rad] and torque_amplitude (speed,
    shaft) [N m], half peak to peak; torque_mean (speed, shaft) [N m], negative where power flows from input
    to output; joint_rotation (speed,): largest deviation at any joint's input [rad], and ``linear`` whether it
    stays within the range in which the linear response can be trusted; cut_off (speed,): size of the
    outermost harmonics kept, of the largest torque; ``findings`` say what of the line is left out.
    ``judged`` gives the stability of the motion at every speed.
    """

    speed: Array
    twist_amplitude: Array
    torque_amplitude: Array
    torque_mean: Array
    joint_rotation: Array
    cut_off: Array
    shafts: tuple[str, ...]
    findings: tuple[Finding, ...]
    unit: str
    judged: Callable[[], Codes]
    lossy: bool

    @cached_property
    def verdict(self) -> Codes:
        """Stability of the motion (speed,), codes of ``Verdict``; FAILED where it is not judged."""
        return self.judged()

    @property
    def linear(self) -> Flags:
        """Where the amplitudes can be trusted (speed,)."""
        return np.asarray(self.joint_rotation <= LINEAR_RANGE)

    def peak(self, shaft: str) -> tuple[float, float]:
        """Largest torque amplitude of a shaft [N m] and the speed it stands at [rad/s]; NaN without a steady state."""
        column = self.torque_amplitude[:, self.shafts.index(shaft)]
        if not np.any(np.isfinite(column)):
            return np.nan, np.nan
        at = int(np.nanargmax(column))
        return float(column[at]), float(self.speed[at])

    def declared(self) -> Iterator[Held]:
        """Amplitudes over (speed, shaft)."""
        yield axis("speed", self.speed, "rad/s")
        yield axis("shaft", list(self.shafts))
        yield from fields_over("speed shaft", self, twist_amplitude="rad", torque_amplitude="N*m", torque_mean="N*m")
        yield over("speed", "joint_rotation", self.joint_rotation, "rad")
        yield over("speed", "linear", self.linear.astype(np.int8))
        yield over("speed", "cut_off", self.cut_off, "1")
        yield remark("linear_range", LINEAR_RANGE)

    def plot(self, axes: Axes | None = None, *, unit: str = "", operating: Operation | None = None) -> Axes:
        """Torque amplitude of every shaft over speed; see ``plots.torque_over_speed.draw``."""
        return drawing(self, "plot")(self, axes, unit=unit, operating=operating)

    def findings_in(self, unit: str) -> tuple[Finding, ...]:
        """What to read first, gravest first, speeds in ``unit``: where the motion is unstable, what is left out."""
        return by_gravity([*where_unstable(self.speed, self.verdict, unit, lossy=self.lossy), *self.findings])

    def describe(self, unit: str | None = None) -> str:
        """The result in a few lines, speeds in ``unit``, by default that of the line's description."""
        unit = unit or self.unit
        rows = [f"linear forced response at {counted(len(self.speed), 'speed')}"]
        for shaft in self.shafts:
            torque, at = self.peak(shaft)
            if np.isnan(torque):
                rows.append(f"  {shaft}: no steady state at any speed")
                continue
            rows.append(f"  {shaft}: torque amplitude up to {torque:.4g} N m at {show_speed(at, unit)}")
        beyond = int(np.count_nonzero(~self.linear))
        if beyond:
            rows.append(
                f"  at {counted(beyond, 'speed')} a joint's input deviates by more than {angle_words(LINEAR_RANGE)}: "
                "indication only"
            )
        return "\n".join([*rows, *(f"  {finding}" for finding in self.findings_in(unit))])


def speed_sweep(
    line: Driveline | Assembly,
    speeds: ArrayLike,
    *,
    statically_twisted: bool = True,
    progress: Callable[[float], None] | None = None,
) -> SpeedSweep:
    """Torque and twist amplitudes of every shaft at each of ``speeds`` [rad/s]; see ``sweep_speeds`` for a grid.

    Raises
    ------
    InputError : speeds that are not positive; a line without steady base motion or with too long a period.
    """
    found = order_response(line, speeds, statically_twisted=statically_twisted, progress=progress)
    return SpeedSweep(
        found.speed,
        found.vibratory_twist,
        found.vibratory_torque,
        found.mean_torque,
        found.joint_rotation,
        found.cut_off,
        found.springs,
        found.remarks,
        found.unit,
        found.judged,
        bool(found.spectrum.loss.any()),
    )


def sweep_speeds(line: Driveline | Assembly, low: float, high: float, points: int = 241) -> Array:
    """Speeds [rad/s] from ``low`` to ``high``: ``points`` evenly, closer together about every resonance, and those at
    which a torque of any spring is largest.

    An even grid alone would step over the peaks of lightly damped modes. The largest torques over the range are those
    at these speeds, to 0.1 % (``range_search.largest``).
    """
    assembly = assemble(line)
    require_memory(64.0 * points, key="points", value=points, remedy="ask for fewer speeds")
    even = np.linspace(low, high, points)
    span = Span(assembly, low, high)
    try:
        met = resonances(span)
        about = (met.speed[:, None] + np.maximum(met.width, 1e-9 * met.speed)[:, None] * CLUSTER).ravel()
        first = [np.union1d(part, _between(about, part)) for part in first_speeds(span.pieces, met, FEW)]
        found = search(assembly, partial(response_about, assembly), first, _torques(assembly)).response.speed
    except (InputError, ComputationError):  # said where the response is asked for
        found = np.zeros(0)
    every = np.union1d(even, found)
    return every[(every >= low) & (every <= high)]


def _between(speeds: Array, part: Array) -> Array:
    return speeds[(speeds > part[0]) & (speeds < part[-1])]


def _torques(assembly: Assembly) -> list[Quantity]:
    """What is largest somewhere: torques of all springs, with their means and without."""

    def of(c: int, word: str) -> Quantity:
        return Quantity(lambda found: getattr(found, word)[:, c], lambda found: found.torque[:, :, c])

    def rated(c: int) -> Quantity:
        return Quantity(
            lambda found: found.rated_torque[:, c], lambda found: found.torque[:, :, c] * found.frequency_factor
        )

    springs = range(len(assembly.topology.compliances))
    every = [of(c, word) for c in springs for word in ("peak_torque", "vibratory_torque")]
    return [*every, *(rated(c) for c in springs if has_rating(assembly, c))]
