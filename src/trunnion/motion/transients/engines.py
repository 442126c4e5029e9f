"""What acts on an Engine as a whole, as its throws have it: each the same part."""

from __future__ import annotations

from collections.abc import Sequence

from trunnion.driveline.applied_torque import AppliedTorque, FrictionTorque, scaled_torque
from trunnion.driveline.elements import Element, Rotor

Parts = Sequence[tuple[str, Element]]


def throws_of(name: str, parts: Parts) -> list[str]:
    """The disks of the Engine called ``name``; none where it is not an Engine."""
    return [n for n, one in parts if isinstance(one, Rotor) and one.part_of is not None and one.part_of[0] == name]


def on_throws(
    torque: Sequence[AppliedTorque], friction: Sequence[FrictionTorque], parts: Parts
) -> tuple[tuple[AppliedTorque, ...], tuple[FrictionTorque, ...]]:
    """Torques and friction of which those on an Engine act on its throws, each an equal part."""
    torques, frictions = list[AppliedTorque](), list[FrictionTorque]()
    for one in torque:
        throws = throws_of(one.on, parts)
        torques += [scaled_torque(one, 1 / len(throws)).but(on=throw) for throw in throws] or [one]
    for rubs in friction:
        throws = throws_of(rubs.on, parts)
        share = 1 / max(len(throws), 1)
        static = None if rubs.static is None else share * rubs.static
        frictions += [rubs.but(on=throw, torque=share * rubs.torque, static=static) for throw in throws] or [rubs]
    return tuple(torques), tuple(frictions)
