"""What equations of motion in time let move by itself: the sides of slip clutches, and pendulums along their paths."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Element
from trunnion.driveline.pendulums import CentrifugalPendulum, Swinging
from trunnion.driveline.slip_clutches import SlipClutch, Slipping
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.slip_clutches import PlacedClutch
from trunnion.errors import InputError

MOST_CLUTCHES = 4


@dataclass(frozen=True)
class PlacedPendulum:
    """A pendulum that swings along its path: its compliance, m [kg], R and r [m], whether the path is an epicycloid,
    and c of its damper by the speed along the path [N s/m]."""

    name: str
    compliance: int
    mass: float
    radius: float
    curvature: float
    epicycloid: bool
    drag: float

    @property
    def arm(self) -> float:
        """R + r [m]: travel along the path over the twist of the ring."""
        return self.radius + self.curvature

    @property
    def numbers(self) -> list[float]:
        """As ``released_kernel`` reads them."""
        return [self.compliance, self.mass, self.radius, self.curvature, self.epicycloid, self.drag]


def released(assembly: Assembly, *, slips: bool, swing: bool) -> Assembly:
    """The line with a rotation of its own behind every slip clutch where it ``slips``, and with pendulums along their
    paths, where they ``swing``, instead of rings on springs.

    Raises
    ------
    InputError : more clutches than are followed; no inertia on a side of one.
    """
    kinds = ((SlipClutch,) if slips else ()) + ((CentrifugalPendulum,) if swing else ())
    if not any(isinstance(element, kinds) for element in assembly.line.elements):
        return assembly
    made: Assembly = assembly.derived(_RELEASED[slips, swing])
    return made


NO_PATH = "swings along a path, which this analysis does not follow"
NOT_ALIKE = "is held by the square of the speed, which this analysis does not count"
AT_ONE_SPEED = (
    "tn.simulate and tn.periodic_response follow it; at one speed a TunedDamper of m(R + r)² stands for small motions"
)


def refuse_pendulums(line: Driveline, why: str = NO_PATH, remedy: str = AT_ONE_SPEED) -> None:
    """Refuse a line with a centrifugal pendulum, for analyses that follow no path, or for another reason ``why``.

    Raises
    ------
    InputError : names the pendulum.
    """
    for name, element in line.parts:
        if isinstance(element, CentrifugalPendulum):
            raise InputError(why, element=name, key="path", value=element.path, remedy=remedy)


def _released(slips: bool, swing: bool, assembly: Assembly) -> Assembly:
    line = assembly.line

    def moving(element: Element) -> Element:
        if slips and isinstance(element, SlipClutch):
            return Slipping(**element.stated)
        if swing and isinstance(element, CentrifugalPendulum):
            return Swinging(**element.stated)
        return element

    names = [name for name, element in line.parts if isinstance(element, SlipClutch)]
    if slips and len(names) > MOST_CLUTCHES:
        raise InputError(
            f"are {len(names)} slip clutches, more than the {MOST_CLUTCHES} that are followed",
            element=", ".join(names), remedy="write a Ratio of 1 for those that stick",
        )  # fmt: skip
    found = assemble(line.model_copy(update={"elements": tuple(map(moving, line.elements))}))
    if line.damping_ratio is not None:  # it holds at the lowest mode of the line as described
        found.__dict__["damping_reference"] = assembly.damping_reference
    return found


_RELEASED = {(slips, swing): partial(_released, slips, swing) for slips in (False, True) for swing in (False, True)}


def placed_pendulums(assembly: Assembly, row: Array) -> tuple[PlacedPendulum, ...]:
    """The pendulums that swing along their paths, at one row of packed numbers.

    Raises
    ------
    InputError : a number that is not positive, where parameters were varied.
    """
    found, column = [], assembly.packed.column
    for e, compliance in enumerate(assembly.topology.compliances):
        place = compliance.shafts[0]
        element, name = assembly.line.elements[place], assembly.line.names[place]
        if not isinstance(element, Swinging):
            continue
        stated = {
            key: float(row[column(place, key)])
            for key in ("mass", "radius", "length", "order", "damping")
            if column(place, key) >= 0
        }
        for key, value in stated.items():
            if not (value > 0 or (key == "damping" and value == 0)):
                raise InputError("must be positive", element=name, key=key, value=value)
        radius = stated["radius"]
        curvature = stated["length"] if "length" in stated else radius / stated["order"] ** 2
        drag, epicycloid = stated["damping"] / (radius + curvature) ** 2, element.path == "epicycloid"
        found.append(PlacedPendulum(name, e, stated["mass"], radius, curvature, epicycloid, drag))
    return tuple(found)


def released_numbers(
    clutches: tuple[PlacedClutch, ...], strides: list[int], pendulums: tuple[PlacedPendulum, ...]
) -> Array:
    """All numbers of clutches and pendulums as ``released_kernel`` reads them, none for none."""
    if not (clutches or pendulums):
        return np.zeros(0)
    at, head = sum(len(clutch.numbers(0, 0)) for clutch in clutches), list[float]()
    for clutch, stride in zip(clutches, strides, strict=True):
        head += clutch.numbers(stride, at)
        at += clutch.table.size
    parts = [head, *(clutch.table.ravel() for clutch in clutches), *(pendulum.numbers for pendulum in pendulums)]
    numbers = np.concatenate([np.asarray(part, dtype=float) for part in parts])
    return np.append(numbers, [len(pendulums), len(clutches), len(numbers) + 3])
