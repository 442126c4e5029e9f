"""How the steady response by order follows parameters, exact through its own equations.

With A(p) X = G(p) the slope is X′ = A⁻¹(G′ − A′X). The function X₀ + A₀⁻¹(G(p) − A(p) X₀) has it, and is as smooth as
A and G are, low polynomials and sines of the description's numbers: its differences of fourth order hold to rounding,
however sharp the resonance. What is read from a response (extremes over the cycle, stresses, speeds' fluctuation) is
then taken of X₀ + X′s, for steps s so small that X changes by ``LINEAR`` of itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from trunnion.arrays import Array
from trunnion.design.sensitivity.differences import CENTRAL, SMOOTH_STEP, STEP, Values, central, slope
from trunnion.design.sensitivity.directions import Direction, Neighbourhood
from trunnion.equations.coefficients import Assembly
from trunnion.equations.steady_base import has_periodic_base
from trunnion.errors import InputError
from trunnion.floquet.stability.stability import LONG
from trunnion.response.orders.response import response_of_spectrum
from trunnion.response.orders.result import OrderResponse
from trunnion.steady.orders.amplitudes import OrderSpectrum
from trunnion.steady.orders.spectrum import order_spectrum
from trunnion.waiting import keep_time

PARTS = ("amplitude", "base", "mean", "damping", "loss")
LINEAR = 1e-4
"""Share of a response by which the largest of the steps changes it."""
FAINT = 1e-6
"""Share of the largest amplitude of its kind below which a channel's own change does not shorten the steps."""

UNSURE = 1e-8
"""Error of a slope, over itself and the value per step's unit, from which finer steps are tried."""
ROUNDING = 1e-15
"""Relative error of numbers and of what is computed from them."""
FINER = (1 / 50, 1 / 2500)
LINEAR_KEYS = ("damping", "mesh_damping", "impact_damping", "relative_damping", "loss_factor", "damping_ratio")
"""Numbers in which the equations are linear, so that any step gives their slope; a wide one keeps what little damping
does to a stiff spring's equations above rounding."""
WIDE_STEP = 0.25
MOST_NUMBERS = 1_500
"""Unknowns of the directions that are solved for together: bounded memory."""
FOURTH = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
"""Fourth difference: nothing of smooth parts is left in it, so it shows what rounding does to a slope."""


@dataclass(frozen=True)
class SpectrumSlope:
    """The response at one speed, and how every part of it changes along one direction, per share of its size.

    noise: what rounding may change of ``change``, as a share of the response.
    """

    here: OrderSpectrum
    change: dict[str, NDArray[Any]]
    noise: float

    def moved(self, shares: Array | Sequence[float]) -> OrderSpectrum:
        """The response after steps of so many ``shares`` (step,), to first order: a row for each, as of a speed."""
        steps, one = np.asarray(shares), np.zeros(len(shares), dtype=np.intp)
        parts = {key: getattr(self.here, key) + np.multiply.outer(steps, self.change[key][0]) for key in PARTS}
        return replace(self.here.take(one), **parts)

    def response(self, assembly: Assembly, share: float) -> OrderResponse:
        """The same as the response of ``assembly``, the line there."""
        return response_of_spectrum(assembly, self.moved([share]), remarked=False)

    @cached_property
    def pace(self) -> float:
        """How fast the response changes, as shares of itself per share of the direction's size."""
        return _share(self.here, self.change["amplitude"], self.change["mean"])

    @property
    def step(self) -> float:
        """Share of the direction's size that changes the response by ``LINEAR``."""
        return min(STEP, LINEAR / self.pace) if self.pace else STEP

    @property
    def shares(self) -> Array:
        """The shares at which ``slope`` looks, unless these turn out to be too far apart."""
        return self.step * np.array([0.0, *CENTRAL])

    def slope(self, values: Values, pace: float) -> tuple[Array, Array] | None:
        """Derivatives and errors of ``values(share)``, read from what is ``moved`` by the share.

        Where another peak becomes the largest within the steps, finer ones settle on which side of that kink the line
        is. Rounding of the numbers themselves moves the response, and its change with it, by the largest ``pace``:
        where a derivative is small because the change is at right angles to the response, that is more than its share.
        """
        here, found = values(0.0), slope(values, self.step)
        if here is None or found is None:
            return None
        for finer in FINER:
            with np.errstate(invalid="ignore"):
                unsure = found[1] > UNSURE * np.maximum(np.abs(found[0]), np.abs(here))
            if not np.any(unsure):
                break
            closer = slope(values, self.step * finer)
            if closer is not None:
                better = closer[1] < 0.1 * found[1]
                found = np.where(better, closer[0], found[0]), np.where(better, closer[1], found[1])
        rounding = ROUNDING * pace * np.maximum(np.abs(np.nan_to_num(found[0])), self.pace * np.abs(here))
        return found[0], found[1] + rounding + self.noise * np.abs(here)


def spectrum_slopes(
    near: Neighbourhood, speed: float, directions: Sequence[Direction]
) -> Iterator[SpectrumSlope | None]:
    """How the response at ``speed`` [rad/s] changes along each direction; None where the lines beside it have none:
    their torques do not balance, or a frequency of excitation moves.
    """
    assert not has_periodic_base(near.assembly)
    size = near.assembly.topology.size
    together = max(1, MOST_NUMBERS // size) if size >= LONG else 1
    for begin in range(0, len(directions), together):
        keep_time()
        some = directions[begin : begin + together]
        try:
            yield from _solved_together(near, speed, some)
        except InputError:
            yield from (_alone(near, speed, one) for one in some)


def _alone(near: Neighbourhood, speed: float, one: Direction) -> SpectrumSlope | None:
    try:
        return next(_solved_together(near, speed, [one]))
    except InputError:
        return None


def _solved_together(near: Neighbourhood, speed: float, directions: Sequence[Direction]) -> Iterator[SpectrumSlope]:
    """About one response, whose matrices serve all of them."""
    row, steps = near.row(speed), [_step(near, one) for one in directions]
    beside = [near.rows(row, one, step * CENTRAL) for one, step in zip(directions, steps, strict=True)]
    table = np.concatenate([row, *beside])
    table[:, 0] = speed
    found = order_spectrum(near.assembly, table[:, 0], table=table, linearised=True)
    parts = {key: getattr(found, key) for key in PARTS}
    whole = {key: np.broadcast_to(part, (len(table), *part.shape[1:])) for key, part in parts.items()}
    first: dict[str, Any] = {key: part[:1] for key, part in whole.items()}
    here = replace(found, speed=found.speed[:1], cut_off=found.cut_off[:1], **first)
    for d, step in enumerate(steps):
        rows = 1 + len(CENTRAL) * d + np.arange(len(CENTRAL))
        own = np.insert(rows, 2, 0)  # in the order of their steps
        moves = np.any(beside[d] != row)  # a load case may state what the direction would move
        change = {key: moves * central(part[rows], step)[None] for key, part in whole.items()}
        rough = {key: np.tensordot(FOURTH, whole[key][own], 1)[None] / step for key in ("amplitude", "mean")}
        around = SpectrumSlope(here, change, _share(here, rough["amplitude"], rough["mean"]))
        # Where the equations are not linear in a number, the fourth difference holds more than rounding.
        yield around if step == WIDE_STEP else replace(around, noise=min(around.noise, ROUNDING * around.pace / step))


def _step(near: Neighbourhood, one: Direction) -> float:
    keys = {near.assembly.packed.labels[i].rpartition(".")[2] for i in one.columns.index}
    return WIDE_STEP if keys <= set(LINEAR_KEYS) else SMOOTH_STEP


def _share(here: OrderSpectrum, amplitude: NDArray[Any], mean: Array) -> float:
    """The largest share of their own kind's size by which changes of amplitudes and means change a channel."""
    places, largest = here.channels, 0.0
    for kind in (places.twist, places.torque, places.deviation):
        size = np.abs(here.amplitude[..., kind]).sum(axis=1) + np.abs(here.mean[:, kind])
        change = np.abs(amplitude[..., kind]).sum(axis=1) + np.abs(mean[:, kind])
        floor = FAINT * size.max(initial=0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            shares = change / np.maximum(size, floor)
        largest = max(largest, float(np.nan_to_num(shares, posinf=0.0).max(initial=0.0)))
    return largest
