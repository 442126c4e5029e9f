"""Limits and ratings of a line that compare a bounded peak, each by the quantities that it compares."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.geometry import tube_stress
from trunnion.driveline.limits import OneLimit
from trunnion.driveline.pendulums import CentrifugalPendulum
from trunnion.equations.coefficients import Assembly
from trunnion.response.peaks.quantities import (
    ACCELERATION,
    FURTHEST,
    HEAT,
    LARGEST,
    RATED,
    SPEED,
    SWING,
    place_of,
    quantities_of,
)

OF_SPRINGS = {
    "max_torque": LARGEST, "vibratory_torque": SWING, "transient_vibratory_torque": SWING, "max_stress": LARGEST,
    "max_twist": FURTHEST,
}  # fmt: skip
OF_INERTIAS = {"max_speed_fluctuation": SPEED, "max_acceleration": ACCELERATION}
OF_RATINGS = {
    "maximum_torque": LARGEST, "vibratory_torque": RATED, "heat_rating": HEAT, "largest_travel": FURTHEST,
}  # fmt: skip
"""Measures by the keys of what they are compared with."""
PASSING = "transient_vibratory_torque"


@dataclass(frozen=True)
class PeakLimit:
    """``per`` times each of some quantities, by their ``places`` among ``quantities_of``, should not exceed ``value``,
    of which ``margin`` must stay free. ``rating``: of a part, not of a ``[[limit]]``."""

    element: str
    key: str
    places: tuple[int, ...]
    per: float
    value: float
    margin: float
    rating: bool = False

    @property
    def most(self) -> float:
        """What each of the quantities may be at most."""
        return self.value * (1 - self.margin) / self.per


def peak_limits(assembly: Assembly) -> Iterator[PeakLimit]:
    """All that are stated."""
    for limit in assembly.line.limits_by_element:
        if limit.key in OF_SPRINGS or limit.key in OF_INERTIAS:
            yield from _of_limit(assembly, limit)
    for name, element in assembly.line.parts:
        for key in element.ratings:
            if key in OF_RATINGS and getattr(element, key) is not None and springs_of(assembly, name):
                yield _of_rating(assembly, name, key, getattr(element, key))


def largest_allowed(assembly: Assembly) -> Array:
    """What the description allows of every quantity in service (quantity,); infinite where it states nothing."""
    found = np.full(len(quantities_of(assembly)), np.inf)
    for one in peak_limits(assembly):
        if one.key != PASSING:
            for place in one.places:
                found[place] = min(found[place], one.most)
    return found


def springs_of(assembly: Assembly, element: str) -> tuple[int, ...]:
    """The springs that an element has or is part of."""
    place = assembly.line.index(element)
    return tuple(c for c, ends in enumerate(assembly.topology.compliances) if place in ends.shafts)


def service_factors(assembly: Assembly, name: str) -> tuple[float, float]:
    """S_t and S_z of a coupling."""
    factor = {one.key: one.value for one in assembly.line.limits_by_element if one.element == name}
    return factor.get("temperature_factor", 1.0), factor.get("starting_factor", 1.0)


def required_of(assembly: Assembly, element: str) -> float:
    """Largest margin that the description requires of an element."""
    return max((one.margin for one in assembly.line.limits_by_element if one.element == element), default=0.0)


def _of_limit(assembly: Assembly, limit: OneLimit) -> Iterator[PeakLimit]:
    if limit.key in OF_INERTIAS:
        points = [own for _, own in assembly.topology.points]
        if limit.element in points:
            place = place_of(assembly, OF_INERTIAS[limit.key], points.index(limit.element))
            yield PeakLimit(limit.element, limit.key, (place,), 1.0, limit.value, limit.margin)
        return
    springs, per = springs_of(assembly, limit.element), 1.0
    if limit.key == "max_twist" and len(assembly.topology.compliances[springs[0]].shafts) > 1:
        return  # shafts in series share their twist as their stiffnesses are
    if limit.key == "max_stress":
        shaft = assembly.line.elements[assembly.line.index(limit.element)]
        per = float(tube_stress(shaft.outer_diameter, shaft.inner_diameter or 0.0))  # type: ignore[attr-defined]
    if limit.key in ("max_stress", "max_twist"):
        springs = springs[:1]
    places = tuple(place_of(assembly, OF_SPRINGS[limit.key], c) for c in springs)
    yield PeakLimit(limit.element, limit.key, places, per, limit.value, limit.margin)


def _of_rating(assembly: Assembly, name: str, key: str, rating: float) -> PeakLimit:
    temperature, starting = service_factors(assembly, name)
    element = assembly.line.elements[assembly.line.index(name)]
    arm = element.arm if isinstance(element, CentrifugalPendulum) else 1.0
    per = {"maximum_torque": temperature * starting, "heat_rating": temperature, "largest_travel": arm}.get(key, 1.0)
    value = rating / temperature if key == "vibratory_torque" else rating
    place = place_of(assembly, OF_RATINGS[key], springs_of(assembly, name)[0])
    return PeakLimit(name, key, (place,), per, value, required_of(assembly, name), rating=True)
