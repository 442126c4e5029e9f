"""Torques that follow what is stated with a first-order lag: each is a state of the motion, Ṫ = ν_c (T₀ − T)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.applied_torques import PlacedTorque
from trunnion.equations.line_regimes import line_kernel
from trunnion.motion.transients.place import Place


def with_lags(
    place: Place, lagging: Sequence[PlacedTorque], of_station: Callable[[Place, int], tuple[float, float]]
) -> Place:
    """The same place with a state for every torque that lags: as it was for one on the same disk before, else what it
    begins with. ``of_station``: angle [rad] and speed [rad/s] of a station there."""
    state, values = np.split(place.state, [len(place.state) - len(place.lagging)])
    known, found = list(zip(place.lagging, values.tolist(), strict=True)), list[float]()
    for one in lagging:
        same = next((k for k, (name, _) in enumerate(known) if name == one.stated.on), None)
        if same is not None:
            found.append(known.pop(same)[1])
            continue
        angle, speed = (one.sense * value for value in of_station(place, one.station))
        found.append(one.begun(place.time, speed, angle))
    return replace(place, state=np.concatenate([state, found]), lagging=tuple(one.stated.on for one in lagging))


def held_lags(numbers: Array, torques: Sequence[PlacedTorque], values: Array) -> Array:
    """The numbers of a line with its lagging torques at ``values`` (lagging,) [N m] as constants, which are no
    states."""
    core, held = line_kernel(), numbers.copy()
    at = int(held[core.APPLIED_AT])
    held[core.LAGS] = 0.0
    for one in torques:
        if one.lags:
            row = held[at : at + core.PER_APPLIED]
            row[core.FIRST : core.CORNER + 1] = 0.0
            row[core.NUMERATOR], row[core.DENOMINATOR] = values[one.lagged], 1.0
        at += core.PER_APPLIED
    return held
