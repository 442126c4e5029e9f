"""Bearings as the user lists them: which shaft, at which positions, and whether they can carry a couple."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trunnion.driveline.quantities import LENGTH, parse
from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError
from trunnion.response.kinetostatics.chain import KinematicChain

Bearings = Sequence[Sequence[object]]


def place_bearings(chain: KinematicChain, bearings: Bearings) -> dict[int, tuple[float, ...]]:
    """Bearing positions by member, checked."""
    remedy = 'write supports=[("Shaft 1", -0.3, -0.1), ("Shaft 3", 0.1, 0.4)]'
    placed: dict[int, tuple[float, ...]] = {}
    known = {name: m for m, member in enumerate(chain.members) for name in member.shafts}
    for entry in bearings:
        if isinstance(entry, str) or not isinstance(entry, Sequence) or not 2 <= len(entry) <= 3:
            raise InputError(
                "is not a shaft with one or two bearing positions", key="supports", value=entry, remedy=remedy
            )
        name = str(entry[0])
        if name not in known:
            raise InputError(
                "is not a Shaft of this driveline", key="supports", value=name, remedy=nearest(name, known)
            )
        try:
            positions = tuple(parse(x, LENGTH) for x in entry[1:])
        except InputError as error:
            raise error.but(element=name, key="supports", remedy=remedy) from None
        m = known[name]
        placed[m] = placed.get(m, ()) + positions
        if len(placed[m]) > 2:
            raise InputError(
                "has more than two bearings, which is statically indeterminate",
                element=name,
                key="supports",
                remedy="give the two that carry it",
            )
        if len(placed[m]) == 2 and placed[m][0] == placed[m][1]:
            raise InputError(
                "has both bearings at one place, where they cannot carry a couple",
                element=name,
                key="supports",
                value=placed[m][0],
                remedy="give two different positions",
            )
        _within(chain, m, name, positions)
    if not placed:
        raise InputError("names no bearing", key="supports", remedy=remedy)
    return placed


def _within(chain: KinematicChain, m: int, name: str, positions: tuple[float, ...]) -> None:
    member = chain.members[m]
    last = any(chain.steps[i].parent >= 0 and chain.steps[chain.steps[i].parent].member == m for i in chain.joints)
    low = -np.inf if member.joint < 0 else 0.0
    high = np.inf if not last else (0.0 if member.joint < 0 else member.length)
    for x in positions:
        if x < low or x > high:  # a length that is not known (NaN) refuses nothing
            raise InputError(
                "lies beyond the joint at the shaft's end",
                element=name,
                key="supports",
                value=x,
                remedy="positions count from the joint in front of the shaft, away from the drive; on the "
                "first shaft from the joint behind it, so that they are negative",
            )
