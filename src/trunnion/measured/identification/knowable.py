"""What measured orders can tell of a line's numbers, before any of it is fitted: Fisher's information."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import qmc

from trunnion.arrays import Array, Flags
from trunnion.design.optimisation.space import Space
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.measured.identification.fitting import shares_of, values_at
from trunnion.measured.identification.misfit import Misfit, misfit_of
from trunnion.measured.identification.profile import covariance_of
from trunnion.measured.tracking.result import MeasuredOrders
from trunnion.results.counts import counted
from trunnion.results.fields import coordinate, internal, labelled, variable
from trunnion.results.finding import Finding, Gravity
from trunnion.results.result import Result
from trunnion.results.units import figures, in_words

UNIFORM = 1 / np.sqrt(12)
"""Standard deviation, as a share of its range, of what nothing is known of."""
UNKNOWABLE = 0.5 * UNIFORM
"""Standard deviation from which the data tell next to nothing."""
TIED = 0.98
"""Correlation from which only a combination is known."""
SPEEDS = 65
"""At which orders and natural frequencies that follow the speed are compared."""
FAR_BETTER = 100.0
"""Times from which it does not tell how much better a pickup would know a number."""
POINTS = 8
"""Points within the bounds that are looked at besides the line as it stands."""


@labelled
class Knowable(Result):
    """How well numbers of a line can be known from a measurement, as far as the response is linear in them.

    Deviations are those of the line as it stands, or, where the data tell nothing of it there, of the point within the
    bounds that they tell most of; a number counts as unknowable where it is known at none of these points.
    """

    parameters: tuple[str, ...] = coordinate("parameter")
    units: tuple[str, ...] = variable("parameter", "", "SI unit", name="parameter_unit")
    deviation: Array = variable("parameter", "", "standard deviation by Fisher's information, in SI units")
    share: Array = variable("parameter", "1", "the least at any point looked at, over the range of the bounds")
    correlation: Array = variable("parameter other", "1", "of the line as it stands")
    pickups: tuple[str, ...] = coordinate("pickup", words="places that are not measured")
    gain: Array = variable("pickup parameter", "1", "factor by which a pickup there would shrink the deviation")
    findings: tuple[Finding, ...] = internal("what cannot be known, and where the next pickup helps")
    unit: str = internal("of speeds in print")

    @property
    def unknowable(self) -> Flags:
        """Which parameters (parameter,) cannot be known."""
        return np.asarray(self.share > UNKNOWABLE)

    def _lines(self) -> Iterator[str]:
        yield f"what {counted(len(self.parameters), 'parameter')} can be known to, by Fisher's information"
        for k, name in enumerate(self.parameters):
            if self.unknowable[k]:
                yield f"  {name}: not from these data"
            else:
                yield f"  {name}: ± {shown_value(1.96 * self.deviation[k], self.units[k])} (95 %)"


def shown_value(value: float, unit: str, digits: int = 4) -> str:
    """A value in SI as it reads."""
    return figures(float(value), digits) if unit in ("", "1") else in_words(float(value), unit, digits)


def identifiability(
    line: Driveline | Assembly,
    data: MeasuredOrders,
    free: Mapping[str, Sequence[object]],
    *,
    begin: float | None = None,
) -> Knowable:
    """How well numbers of a line could be known from measured orders, and where the next pickup would help.

    Parameters
    ----------
    line : the driveline.
    data : of ``track_orders``, whose channels name places of the line.
    free : parameters by path, each with a low and a high bound.
    begin : rotation of the input [rad] at the first pulse of the reference; None where it is not known.

    Raises
    ------
    InputError : a parameter or bound that cannot be; places that the line does not have.

    Examples
    --------
    >>> import trunnion as tn
    >>> joint = tn.HookeJoint(angle="12 deg", name="joint")
    >>> tube, hub = tn.Shaft(stiffness=2e4, damping=25, name="tube"), tn.Disk(inertia=0.5, name="hub")
    >>> line = tn.Driveline([tn.ConstantSpeed(), joint, tube, hub])
    >>> run = tn.measure(line, (60.0, 200.0), 8.0, {"input": 30, "hub": 30}, jitter=1e-6)
    >>> data = tn.track_orders(run, [2], line=line)
    >>> found = tn.identifiability(line, data, {"tube.stiffness": (1e4, 4e4), "joint.plane": (-1.0, 1.0)})
    >>> found.unknowable
    array([False,  True])
    """
    assembly = assemble(line)
    space = Space(assembly, free)
    return knowable(misfit_of(assembly, data, space.free, begin))


def knowable(misfit: Misfit, seed: int = 0, *, around: bool = True) -> Knowable:
    """Fisher's information at the line as it stands and at points within the bounds.

    around : look at those points in any case, and not only where the line as it stands leaves something unknown.
    """
    free, assembly = misfit.free, misfit.channels.assembly
    start = shares_of(misfit, np.array([one.nominal for one in free]))
    shares, every = start[None], [_covariance(misfit, start)]
    if around or np.any(np.sqrt(np.diag(every[0])[: len(free)]) > UNKNOWABLE):
        shares = np.concatenate([shares, 0.02 + 0.96 * qmc.Sobol(len(free), seed=seed).random(POINTS)])
        every += [_covariance(misfit, one) for one in shares[1:]]
    spread = np.array([np.sqrt(np.diag(one)[: len(free)]) for one in every])
    best = spread.min(axis=0)
    width = np.array([one.high - one.low for one in free])
    own = np.where(np.all(spread[0] < UNIFORM), 0, int(spread.max(axis=1).argmin()))
    matrix = every[int(own)][: len(free), : len(free)]
    scale = np.sqrt(np.diag(matrix))
    correlation = matrix / np.outer(scale, scale)
    places, gain = _next_pickups(misfit, shares[int(own)], scale)
    unit = speed_unit(assembly.line)
    return Knowable(
        parameters=tuple(one.label for one in free), units=tuple(one.unit for one in free),
        deviation=spread[own] * width, share=best, correlation=correlation, pickups=places, gain=gain,
        findings=tuple(_findings(misfit, best, correlation, places, gain)), unit=unit,
    )  # fmt: skip


def _covariance(misfit: Misfit, share: Array) -> Array:
    values = values_at(misfit, share)
    predicted = misfit.predicted(values[None])[0]
    return covariance_of(misfit.linear(values, misfit.angle(predicted))[1])


def _next_pickups(misfit: Misfit, share: Array, scale: Array) -> tuple[tuple[str, ...], Array]:
    """Places not yet measured, and by which factor a pickup there, as good as the others, would shrink deviations."""
    data, assembly = misfit.data, misfit.channels.assembly
    taken = {place for place, kind in zip(data.places, data.kinds, strict=True) if kind == "rotation"}
    left = [name for _, name in assembly.topology.points if name not in taken]
    rotations = [c for c in misfit.channels.columns if data.kinds[c] == "rotation"]
    if not left or not rotations:
        return (), np.zeros((0, len(misfit.free)))
    model = rotations[-1]
    gains = []
    for name in left:
        more = replace(
            data,
            channels=(*data.channels, f"pickup on {name}"),
            places=(*data.places, name),
            kinds=(*data.kinds, "rotation"),
            ratios=(*data.ratios, 1.0),
            amplitude=np.concatenate([data.amplitude, data.amplitude[:, :, [model]]], axis=2),
            deviation=np.concatenate([data.deviation, data.deviation[:, :, [model]]], axis=2),
            curvature=np.concatenate([data.curvature, data.curvature[:, :, [model]]], axis=2),
            hidden=np.concatenate([data.hidden, data.hidden[:, [model]]], axis=1),
            floor=np.concatenate([data.floor, data.floor[:, [model]]], axis=1),
            residual=np.concatenate([data.residual, data.residual[:, [model]]], axis=1),
            extreme=np.concatenate([data.extreme, data.extreme[:, [model]]], axis=1),
        )
        wider = misfit_of(assembly, more, misfit.free, misfit.begin, misfit.rows)
        # Only slopes are asked for: what the pickup would show does not matter.
        values = values_at(misfit, share)
        angle = misfit.angle(misfit.predicted(values[None])[0])
        spread = np.sqrt(np.diag(covariance_of(wider.linear(values, angle)[1]))[: len(misfit.free)])
        gains.append(scale / spread)
    return tuple(left), np.array(gains)


def _findings(
    misfit: Misfit, share: Array, correlation: Array, places: tuple[str, ...], gain: Array
) -> Iterator[Finding]:
    names = [one.label for one in misfit.free]
    lost = [name for name, one in zip(names, share, strict=True) if one > UNKNOWABLE]
    for name in lost:
        yield Finding(
            Gravity.CAUTION,
            f"{name} cannot be known from these pickups and orders: within its bounds they look all but the same.",
        )
    for j in range(len(names)):
        for k in range(j):
            if abs(correlation[j, k]) > TIED and names[j] not in lost and names[k] not in lost:
                how = "as a sum" if correlation[j, k] < 0 else "as a difference"
                yield Finding(
                    Gravity.CAUTION,
                    f"{names[k]} and {names[j]} are known {how} far better than each by itself (correlation "
                    f"{correlation[j, k]:.3f}).",
                )
    reached, data = misfit.data.speed, misfit.data
    modes = _crossed(misfit)
    if not modes:
        orders = ", ".join(f"{one:g}" for one in data.order)
        low, high = float(reached.min()), float(reached.max())
        yield Finding(
            Gravity.CAUTION,
            f"No order of {orders} crosses a natural frequency between {figures(low)} and {figures(high)} rad/s: "
            "damping, and stiffness apart from inertia, can hardly be known from this range.",
        )
    if len(places):
        worst = int(share.argmax())
        at = int(gain[:, worst].argmax())
        if gain[at, worst] > 1.1:
            factor = float(gain[at, worst])
            times = figures(factor, 2) if factor < FAR_BETTER else f"more than {FAR_BETTER:.0f}"
            yield Finding(Gravity.NOTE, f"A pickup on {places[at]} would know {names[worst]} {times} times as well.")


def _crossed(misfit: Misfit) -> list[float]:
    """Natural frequencies [rad/s] that an order crosses within the speeds."""
    from trunnion.driveline.pendulums import CentrifugalPendulum
    from trunnion.modes.natural_frequencies import natural_frequencies
    from trunnion.response.campbell_diagram import campbell_diagram

    low, high, assembly = float(misfit.data.speed.min()), float(misfit.data.speed.max()), misfit.channels.assembly
    orders = misfit.data.order.tolist()
    if any(isinstance(element, CentrifugalPendulum) for element in assembly.line.elements):
        # What is held by the square of the speed has other frequencies at each.
        speeds = np.linspace(low, high, SPEEDS) if high > low else np.array([low, 1.001 * low])
        found = campbell_diagram(assembly, speeds).frequency
        off = found[None] - np.multiply.outer(orders, speeds)[:, :, None]
        crossed = np.any(np.diff(np.sign(off), axis=1) != 0, axis=(0, 1))
        return [float(one) for one in found[:, crossed].mean(axis=0)]
    frequencies = natural_frequencies(assembly).elastic.tolist()
    return [one for one in frequencies if any(low <= one / k <= high for k in orders)]
