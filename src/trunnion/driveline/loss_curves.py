"""What gears lose, as torques over the speed: beside those of disks and machines, with which they balance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.chain import ElementChain
from trunnion.driveline.elements import Element, Rotor
from trunnion.driveline.gear_losses import power_shares
from trunnion.driveline.planetary import Planetary
from trunnion.driveline.speed_ratios import coordinate_speeds
from trunnion.errors import InputError
from trunnion.laws.balance import balances
from trunnion.laws.torque_curve import TorqueCurve


@dataclass(frozen=True)
class LossCurve:
    """Torque at the input shaft of gears that takes what they lose of the power of all ``behind`` them.

    ``behind`` : curves that resist, each with the speed of its shaft over that of the input shaft. ``forward`` and
    ``back`` are shares of that power, where it flows to them and where it comes from them; ``drag`` [N m].
    """

    behind: tuple[tuple[float, TorqueCurve], ...]
    forward: float
    back: float
    drag: float

    @cached_property
    def range(self) -> tuple[float, float]:
        """Where all curves behind it say something."""
        ends = [(curve.range[0] / ratio, curve.range[1] / ratio) for ratio, curve in self.behind]
        return max((low for low, _ in ends), default=-np.inf), min((high for _, high in ends), default=np.inf)

    @cached_property
    def knots(self) -> tuple[float, ...]:
        """Those of all behind it, and the speeds at which the power turns round."""
        found = {knot / ratio for ratio, curve in self.behind for knot in curve.knots}
        if self.behind:
            found |= {one.speed for one in balances(self.behind, 0.0, min(self.range[1], FASTEST))}
        return tuple(sorted(found))

    def _flow(self, speed: Any) -> Array:
        return sum((ratio * curve.value(ratio * speed) for ratio, curve in self.behind), np.zeros(np.shape(speed)))

    def value(self, speed: Any) -> Array:
        """Torque [N m]."""
        flow = self._flow(speed)
        return np.asarray(np.where(flow > 0, self.forward * flow, -self.back * flow) + self.drag)

    def slope(self, speed: Any) -> Array:
        """Its derivative by the speed [N m s/rad]."""
        zero = np.zeros(np.shape(speed))
        rise = sum((ratio**2 * curve.slope(ratio * speed) for ratio, curve in self.behind), zero)
        return np.asarray(np.where(self._flow(speed) > 0, self.forward * rise, -self.back * rise))


FASTEST = 1e9
"""Speed [rad/s] up to which the power of curves without an end is looked at."""


def loses(element: Element) -> bool:
    """Whether gears of it lose power."""
    return bool(element.losses or getattr(element, "drag_torque", None))


def with_losses(line: ElementChain, places: Sequence[int]) -> list[tuple[int, TorqueCurve]]:
    """Curves that resist at the shaft in front of some elements of a line: of disks and machines, and of what gears
    lose of the power of those behind them.

    Raises
    ------
    InputError : a planetary set that loses power and none of whose shafts is held.
    """
    found: dict[int, TorqueCurve] = {}
    speeds = coordinate_speeds(line)
    chosen = set(places)
    for i in sorted(chosen, reverse=True):
        element = line.elements[i]
        if isinstance(element, Rotor):
            found[i] = element.load
        elif loses(element):
            inside = behind(line, i)
            own = abs(float(speeds[i][0]))
            driven = tuple(
                (abs(float(speeds[k][0])) / own, curve) for k, curve in found.items() if k in inside and speeds[k][0]
            )
            turning = [float(one) for one in speeds[i]]
            found[i] = LossCurve(driven, *lost_shares(element, line.names[i], turning), _drag(element))
    return sorted(found.items())


def lost_shares(element: Element, name: str, turning: Sequence[float]) -> tuple[float, float]:
    """Shares of the power that flows to what an element of a name drives, and of that which comes back, that its meshes
    lose, by the mean speeds of its coordinates.

    Raises
    ------
    InputError : a planetary set of which none is held.
    """
    if not element.losses:
        return 0.0, 0.0
    key = element.losses[0].key
    if isinstance(element, Planetary) and element.held is None:
        raise InputError(
            "loses by a torque that its free shaft shares, and the speed of the line is to follow from it",
            element=name, key=key, value=getattr(element, key),
            remedy="give a motor drive_share = 1, or hold a shaft",
        )  # fmt: skip
    return power_shares(element.losses, turning, lambda key: getattr(element, key))


def _drag(element: Element) -> float:
    return float(getattr(element, "drag_torque", None) or 0.0)


def behind(line: ElementChain, place: int) -> set[int]:
    """Places of elements that hang on one, on those and so on; not on the shaft in front of it."""
    found = {place}
    for i in range(place + 1, len(line.elements)):
        parent = line.parents[i]
        if parent in found and (parent != place or line.hangs_on[i]):
            found.add(i)
    return found - {place}
