"""Whether slip clutches hold the mean load: linear equations take them as sticking."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array, Places
from trunnion.driveline.parameters import PackedLine
from trunnion.driveline.slip_clutches import SlipClutch, Slipping
from trunnion.equations.topology import Topology
from trunnion.errors import InputError

ROUNDING = 1e-9
"""Share of its capacity by which a load may exceed it by rounding."""


def sticking_clutches(packed: PackedLine, topo: Topology) -> tuple[tuple[int, int], ...]:
    """Station behind each slip clutch that sticks, and its place in the line."""
    elements = packed.line.elements
    return tuple(
        (s, station.element)
        for s, station in enumerate(topo.stations)
        if isinstance(elements[station.element], SlipClutch)
        and not isinstance(elements[station.element], Slipping)
        and station.before >= 0
    )


def stations_beyond(topo: Topology, station: int) -> Places:
    """The station and all that hang on it."""
    beyond = [station]
    for s in range(station + 1, len(topo.stations)):
        if topo.stations[s].before in beyond:
            beyond.append(s)
    return np.array(beyond, dtype=np.intp)


def carried_on_average(topo: Topology, station: int, mean: Array) -> Array:
    """Mean torque (case,) [N m] that passes the rigid link in front of a station of a tree, positive where it drives
    what lies beyond; ``mean`` (case, station) are the loads."""
    beyond = stations_beyond(topo, station)
    return np.asarray(mean[:, beyond] @ (np.abs(topo.mean_speeds[beyond]) / topo.mean_speeds[station]))


def refuse_slipping(packed: PackedLine, topo: Topology, table: Array, mean: Array) -> None:
    """Refuse a line in which the mean load of a slip clutch lies beyond its capacity, at any row of ``table``.

    Raises
    ------
    InputError : names the clutch, its load and its capacity; a clutch beside a differential or a loop, where its load
        does not follow from what lies beyond.
    """
    for station, place in sticking_clutches(packed, topo):
        name, clutch = packed.line.names[place], packed.line.elements[place]
        assert isinstance(clutch, SlipClutch)
        if topo.graph:
            raise InputError(
                f"conflicts with {packed.line.names[topo.knot]}, where its load does not follow from what is behind it",
                element=name, key="torque", value=clutch.torque, remedy="write a Ratio of 1 in its place",
            )  # fmt: skip
        holds = table[:, packed.column(place, "torque")] * clutch.last_share
        load = np.abs(carried_on_average(topo, station, mean))
        beyond = (load > (1 + ROUNDING) * holds) | ~(holds > 0)
        if beyond.any():
            worst = int(np.flatnonzero(beyond)[0])
            # So many figures that the two differ.
            digits = next((d for d in (6, 9, 12) if f"{load[worst]:.{d}g}" != f"{holds[worst]:.{d}g}"), 15)
            raise InputError(
                f"carries a load of {load[worst]:.{digits}g} N m, beyond its capacity of {holds[worst]:.{digits}g} "
                "N m: it slips on, and equations of a steady motion take it as sticking",
                element=name, key="torque",
                remedy="raise its torque, or lower the load; tn.simulate follows it as it slips",
            )  # fmt: skip
