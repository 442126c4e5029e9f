"""A straight line as what every torsional program knows: flanges, and inertias, springs and gears between them.

A flange is a place that turns: what sits on one turns together. Elements say by their ``parts`` what they are made of
(``trunnion.driveline.parts``); one walk along the line numbers the flanges.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Element, Rotor
from trunnion.driveline.gears import GearPair
from trunnion.driveline.parts import Geared, Heavy, Jointed, Prescribed, Sprung
from trunnion.driveline.record import LONGEST_NAME
from trunnion.driveline.shafts import Elastic
from trunnion.errors import InputError


@dataclass(frozen=True)
class FlangeDrive:
    """A rotation that is given at a flange; ``speed`` is that of this flange [rad/s], None where none is stated."""

    name: str
    at: int
    speed: float | None = None


@dataclass(frozen=True)
class FlangeInertia:
    """A moment of inertia [kg m²] at a flange, with a constant torque [N m] and one per speed [N m s/rad] that resist
    its rotation."""

    name: str
    at: int
    inertia: float
    load_torque: float = 0.0
    viscous_load: float = 0.0


@dataclass(frozen=True)
class FlangeSpring:
    """Stiffness [N m/rad] and damping [N m s/rad] between two flanges."""

    name: str
    near: int
    far: int
    stiffness: float
    damping: float


@dataclass(frozen=True)
class FlangeGear:
    """A rigid gear: flange ``near`` turns ``ratio`` times as fast as ``far``."""

    name: str
    near: int
    far: int
    ratio: Fraction


_RATIO = re.compile(r"-?\d{1,30}(?:/\d{1,30}|(?:\.\d{0,30})?(?:[eE][+-]?\d{1,2})?)")


def read_ratio(text: str) -> Fraction:
    """41/10 or 4.1, exactly; ValueError of what is none, zero or too long to compute with."""
    found = Fraction(text) if _RATIO.fullmatch(text) and not text.endswith("/0") else Fraction(0)
    if not found:
        raise ValueError(text)
    return found


Item = FlangeDrive | FlangeInertia | FlangeSpring | FlangeGear


@dataclass
class Network:
    """What a line is made of, each in the order of the line.

    ``speed`` is the input speed [rad/s], None where none is stated, and ``turning`` the mean speed of every flange
    over it.
    """

    name: str
    speed: float | None = None
    items: list[Item] = field(default_factory=list)
    turning: list[float] = field(default_factory=list)

    def new_flange(self, turning: float) -> int:
        """The number of a flange that did not exist."""
        self.turning.append(turning)
        return len(self.turning) - 1

    def of(self, kind: type[Any]) -> list[Any]:
        """Its items of a kind."""
        return [one for one in self.items if isinstance(one, kind)]


def network_of(line: Driveline) -> Network:
    """The flanges of a line whose joints are straight, and what is between them.

    Raises
    ------
    InputError : a part that is none of these.
    """
    speed = line.operation.speed if line.operation else None
    found = Network(line.name or "", speed)
    flanges: list[list[int]] = []
    for i, (name, element) in enumerate(line.parts):
        parent = line.parents[i]
        own = [found.new_flange(1.0) if parent is None else flanges[parent][line.hangs_on[i]]]
        flanges.append(own)
        _add(
            found,
            name,
            element,
            own,
            speed,
            lambda end: flanges[line.index(end)][line.elements[line.index(end)].onward],
        )
    found.items = _told_apart(found.items)
    return found


def _told_apart(items: list[Item]) -> list[Item]:
    """The same with names that differ and are names (``record.is_name``)."""
    taken: set[str] = set()
    named = []
    for one in items:
        usual, name, number = one.name[:LONGEST_NAME].strip(), one.name[:LONGEST_NAME].strip(), 1
        while name in taken:
            number += 1
            name = f"{usual[: LONGEST_NAME - 5].strip()} {number}"
        taken.add(name)
        named.append(replace(one, name=name))
    return named


def _add(
    found: Network, name: str, element: Element, own: list[int], speed: float | None, behind: Callable[[str], int]
) -> None:
    """Add the parts of an element, whose flanges are numbered on in ``own``."""
    parts, links, gears = element.parts(), iter(_links(element)), 0
    inertias = iter(element.inertia_values if any(isinstance(part, Heavy) for part in parts) else ())
    for part in parts:
        match part:
            case Prescribed():
                turning = found.turning[own[0]]
                found.items.append(FlangeDrive(name, own[0], None if speed is None else speed * turning))
            case Heavy(at, of, loaded):
                constant, viscous = _loads(element) if loaded else (0.0, 0.0)
                label = f"{of} {name}".strip() if of else name
                if of == "end of":
                    label = f"end {at + 1} of {name}"
                found.items.append(FlangeInertia(label, own[at], next(inertias), constant, viscous))
            case Geared(ratio, to):
                gears += 1
                far = found.new_flange(found.turning[own[to]] / float(ratio))
                label = f"gears of {name}" if isinstance(element, Elastic | GearPair) else name
                found.items.append(
                    FlangeGear(label if gears == 1 else f"{label} {gears}", own[to], far, Fraction(ratio))
                )
                own.append(far)
            case Jointed(orders, to) if not orders or not getattr(element, "angle", 0.0):
                own.append(own[to])
            case Sprung(to, closes, None):
                far = found.new_flange(found.turning[own[to]]) if closes is None else behind(closes)
                found.items.append(FlangeSpring(name, own[to], far, *next(links)))
                own.append(far)
            case _:
                remedy = "leave it out, or describe it by disks, shafts and ratios"
                raise InputError(
                    f"is a {element.kind}, which files of other programs do not hold", element=name, remedy=remedy
                )


def _links(element: Element) -> tuple[tuple[float, float], ...]:
    """Stiffness and damping of every spring of an element."""
    if isinstance(element, GearPair):
        arm = element.radii[1] ** 2
        return ((element.mesh_stiffness * arm, element.mesh_damping * arm),)
    if not isinstance(element, Elastic):
        return ()
    links = element.links(lambda key: getattr(element, key))
    if len(links) == 1:
        return ((element.torsional_stiffness, element.damping_coefficient),)
    return tuple((float(k), float(c)) for k, c in links)


def _loads(element: Element) -> tuple[float, float]:
    """Constant and viscous torque that resist."""
    assert isinstance(element, Rotor)
    load = element.load
    return float(getattr(load, "constant", 0.0)), float(getattr(load, "viscous", 0.0))


def loop_closed(network: Network) -> str | None:
    """The name of the first spring or gear that joins what is joined already; None of a tree."""
    group = list(range(len(network.turning)))
    for one in network.items:
        if isinstance(one, FlangeSpring | FlangeGear):
            near, far = group[one.near], group[one.far]
            if near == far:
                return one.name
            group = [near if g == far else g for g in group]
    return None


def bare_flange(network: Network) -> str | None:
    """The name of a spring or gear at whose end nothing is heavy, nor by gears behind it; None where all is heavy."""
    group = list(range(len(network.turning)))
    for gear in network.of(FlangeGear):
        near, far = group[gear.near], group[gear.far]
        group = [near if g == far else g for g in group]
    heavy = {group[one.at] for one in network.items if isinstance(one, FlangeDrive | FlangeInertia)}
    ends = (
        (one.name, end)
        for one in network.items
        if isinstance(one, FlangeSpring | FlangeGear)
        for end in (one.near, one.far)
    )
    return next((name for name, end in ends if group[end] not in heavy), None)


def refuse_viscous_at_no_speed(network: Network) -> None:
    """Refuse a viscous load on a driven line whose speed, and so the load's mean torque, is not stated.

    Raises
    ------
    InputError : so.
    """
    if network.speed is not None or not network.of(FlangeDrive):
        return
    for one in network.of(FlangeInertia):
        if one.viscous_load:
            raise InputError(
                "acts by a speed that is not stated", element=one.name, key="viscous_load", value=one.viscous_load,
                remedy="write speed in [operation]",
            )  # fmt: skip
