"""A line from flanges and what is between them: the way back."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import MOST_TEETH, ConstantSpeed, Disk, Element, Ratio
from trunnion.driveline.operation import Operation
from trunnion.driveline.shafts import Shaft
from trunnion.errors import InputError
from trunnion.exchange.network import FlangeDrive, FlangeGear, FlangeInertia, FlangeSpring, Item, Network

SAME_SPEED = 1e-9
"""Share by which speeds that must be one may miss each other."""


def line_of(network: Network) -> Driveline:
    """The line that a network is; elements keep their names.

    Raises
    ------
    InputError : it is not a line: parts that nothing joins, gears that close a loop, a loop that would wind up, drives
        that contradict each other.
    """
    return _Rebuilt(network).line()


class _Rebuilt:
    """Elements as they are found, from a drive or a disk onward; ``seat`` is the element that others hang on at a
    flange, ``turning`` how often it turns per turn of the input."""

    def __init__(self, network: Network) -> None:
        self.network = network
        self.left: list[Item] = list(network.items)
        self.elements: list[Element] = []
        self.seat: dict[int, Element] = {}
        self.turning: dict[int, float] = {}
        self.closing = _closing(network)

    def line(self) -> Driveline:
        first = next((one for kind in (FlangeDrive, FlangeInertia) for one in self.network.of(kind)), None)
        if first is None:
            raise InputError("has neither a drive nor an inertia", key="line", remedy="write what its shafts turn")
        self.turning[first.at] = 1.0
        waiting = [first.at]
        while waiting:  # the newest flange first, so that what follows a shaft stands behind it
            flange = waiting.pop()
            self._sit(flange)
            joined = next((one for one in self.left if _touches(one, flange) and not self._waits(one, flange)), None)
            if joined is None:
                continue
            waiting.append(flange)
            waiting += self._join(joined, flange)
        if self.left:
            remedy = "join it to the rest of the line by a spring or a gear"
            raise InputError("hangs on nothing", element=self.left[0].name, remedy=remedy)
        speed = self._speed()
        operation = None if speed is None else Operation(speed=speed)
        return Driveline(self.elements, name=self.network.name or None, operation=operation)

    def _waits(self, one: Item, flange: int) -> bool:
        """Whether a spring that closes a loop has its other end still to be reached."""
        return id(one) in self.closing and _far(one, flange) not in self.turning

    def _sit(self, flange: int) -> None:
        """Put every inertia and drive of a flange there."""
        for one in [one for one in self.left if isinstance(one, FlangeDrive | FlangeInertia) and one.at == flange]:
            self.left.remove(one)
            if isinstance(one, FlangeDrive):
                made = _made(ConstantSpeed, name=one.name, **self._behind(flange))
            else:
                loads = {"load_torque": one.load_torque, "viscous_load": one.viscous_load}
                made = _made(
                    Disk,
                    name=one.name,
                    inertia=one.inertia,
                    **{k: v for k, v in loads.items() if v},
                    **self._behind(flange),
                )
            self._put(made, flange)

    def _join(self, one: Item, flange: int) -> list[int]:
        """Put a spring or gear that leads on from a flange; the new flange behind it, if it is one."""
        self.left.remove(one)
        assert isinstance(one, FlangeSpring | FlangeGear)
        far = _far(one, flange)
        if isinstance(one, FlangeSpring):
            closes = far in self.turning
            loss = {"damping": one.damping} if one.damping else {}
            end = {"to": self.seat[far].name} if closes else {}
            made = _made(Shaft, name=one.name, stiffness=one.stiffness, **loss, **end, **self._behind(flange))
            if closes:
                self._must_turn_alike(one, flange, far)
                self.elements.append(made)
                return []
            self.turning[far] = self.turning[flange]
        else:
            ratio = one.ratio if one.near == flange else 1 / one.ratio
            made = _made(Ratio, name=one.name, **_ratio(ratio), **self._behind(flange))
            self.turning[far] = self.turning[flange] / float(ratio)
        self._put(made, far)
        return [far]

    def _must_turn_alike(self, spring: FlangeSpring, flange: int, far: int) -> None:
        speeds = self.turning[flange], self.turning[far]
        if abs(speeds[0] - speeds[1]) > SAME_SPEED * abs(speeds[0]):
            problem = f"closes a loop whose ends turn {speeds[0]:g} and {speeds[1]:g} times a turn of the input"
            raise InputError(problem, element=spring.name, remedy="check the gears of the loop, or leave it out")

    def _put(self, made: Element, flange: int) -> None:
        self.elements.append(made)
        self.seat[flange] = made

    def _behind(self, flange: int) -> dict[str, str]:
        """``after``, where what sits there is not the element before."""
        there = self.seat.get(flange)
        if there is None or there is self.elements[-1]:
            return {}
        if isinstance(there, Shaft):
            remedy = "put an inertia there"
            raise InputError("is where the line branches, without an inertia", element=str(there.name), remedy=remedy)
        return {"after": str(there.name)}

    def _speed(self) -> float | None:
        """The input speed [rad/s] that the drives state together."""
        stated = [one for one in self.network.of(FlangeDrive) if one.speed is not None]
        if not stated:
            return self.network.speed
        speeds = [one.speed / self.turning[one.at] for one in stated]
        for one, speed in zip(stated, speeds, strict=True):
            if abs(speed - speeds[0]) > SAME_SPEED * abs(speeds[0]):
                remedy = f"turn it as {stated[0].name} does, by the gears between them"
                raise InputError("contradicts the other drive", element=one.name, value=one.speed, remedy=remedy)
        return float(speeds[0])


def _made(kind: type[Element], **data: Any) -> Element:
    return kind(**data)


def _closing(network: Network) -> set[int]:
    """Identities of the springs that close a loop: a gear never does.

    Raises
    ------
    InputError : a gear has to.
    """
    part: dict[int, int] = {}

    def root(flange: int) -> int:
        while (above := part.setdefault(flange, flange)) != flange:
            flange = above
        return flange

    found: set[int] = set()
    for one in (*network.of(FlangeGear), *network.of(FlangeSpring)):
        near, far = root(one.near), root(one.far)
        if near == far and isinstance(one, FlangeGear):
            remedy = "leave it out; a rigid gear that closes a loop holds or contradicts the others"
            raise InputError("closes a loop", element=one.name, remedy=remedy)
        if near == far:
            found.add(id(one))
        part[far] = near
    return found


def _far(one: Item, flange: int) -> int:
    assert isinstance(one, FlangeSpring | FlangeGear)
    return one.far if one.near == flange else one.near


def _touches(one: Item, flange: int) -> bool:
    return isinstance(one, FlangeSpring | FlangeGear) and flange in (one.near, one.far)


def _ratio(ratio: Fraction) -> dict[str, float | int]:
    """As tooth numbers where they are some."""
    if 0 < ratio.numerator <= MOST_TEETH and ratio.denominator <= MOST_TEETH:
        return {"teeth_in": ratio.denominator, "teeth_out": ratio.numerator}
    return {"ratio": float(ratio)}
