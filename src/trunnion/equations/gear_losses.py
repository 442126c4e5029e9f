"""Power that gears lose in steady running: the torques that resist by it, and where torques flow.

From the ends of a line forward every station hands on the torque that it asks for. At a mesh that loses power it is
known then, and so is the friction, whichever way power flows (``trunnion.driveline.gear_losses``). Where drives stand
behind a mesh, theirs follows from the losses and these from it: it is found by repetition, which comes closer by the
share that is lost each time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.gear_losses import lost_shares
from trunnion.equations.lossy_gears import Rub
from trunnion.equations.topology import LinkKind, Topology
from trunnion.errors import InputError

Column = Callable[[int, str], int]
MOST, SAME = 400, 1e-14
"""Repetitions; share of the largest torque within which two of them are one."""


@dataclass(frozen=True)
class LostTorques:
    """By how much gears resist beyond what they pass on.

    ``resists`` : at every station, against its mean rotation (case, station) [N m]. ``friction`` : of every mesh that
    loses power, in the order of ``Topology.rubs`` (case, rub) [N m]; ``drag`` : of the ``drags`` (case, drag) [N m].
    """

    resists: Array
    friction: Array
    drag: Array


def sliding(topo: Topology, rub: Rub) -> float:
    """How fast a gear turns against what it rubs against, over the speed of the input."""
    against = 0.0 if rub.against < 0 else float(topo.mean_speeds[rub.against])
    return float(topo.mean_speeds[rub.at]) - against


def lost_torques(topo: Topology, column: Column, table: Array, carried: Callable[[Array], Array]) -> LostTorques:
    """What gears lose at every row of packed numbers (case, column).

    ``carried`` gives the mean torques that resist at all stations (case, station) [N m], those of drives among them,
    where gears resist by as much as they are asked with.

    Raises
    ------
    InputError : losses that do not settle.
    """
    found = LostTorques(np.zeros((len(table), len(topo.stations))), *np.zeros((2, len(table), 0)))
    for _ in range(MOST):
        felt = carried(found.resists)
        again = _swept(topo, column, table, felt - found.resists)
        change = np.abs(again.resists - found.resists).max(initial=0.0)
        found = again
        if not change > SAME * np.abs(felt).max(initial=0.0):
            return found
    raise InputError(
        "loses so much that its power flows to no balance with the drives behind it", element=topo.rubs[0].name,
        key=topo.rubs[0].loss.key, remedy="put the drive in front, or check the efficiencies",
    )  # fmt: skip


def _swept(topo: Topology, column: Column, table: Array, felt: Array) -> LostTorques:
    """Losses under torques that resist (case, station), from the ends of the line forward."""
    sense = np.sign(topo.mean_speeds)
    asked, lost = felt * sense, np.zeros_like(felt)
    friction, drag = np.zeros((len(table), len(topo.rubs))), np.zeros((len(table), len(topo.drags)))
    for k, (front, place) in enumerate(topo.drags):
        drag[:, k] = table[:, column(place, "drag_torque")]
        lost[:, front] += drag[:, k] * sense[front]
        asked[:, front] += drag[:, k] * sense[front]
    for s in range(len(topo.stations) - 1, -1, -1):
        for k, amount in _friction(topo, column, table, asked[:, s], s):
            rub = topo.rubs[k]
            friction[:, k] = amount
            signed = amount * np.sign(sliding(topo, rub))
            for one, part in ((rub.at, signed), (rub.against, -signed)):
                if one >= 0:
                    lost[:, one] += part
                    asked[:, one] += part
        station = topo.stations[s]
        if station.link is LinkKind.SUM:
            for of, share in station.of:
                asked[:, of] += float(share) * asked[:, s]
        elif station.link is LinkKind.RATIO:
            asked[:, station.before] += asked[:, s] / topo.ratio_values[s]
        elif station.link in (LinkKind.SHAFT, LinkKind.JOINT):
            asked[:, station.before] += asked[:, s]
    return LostTorques(lost * sense, friction, drag)


def _friction(topo: Topology, column: Column, table: Array, asked: Array, station: int) -> list[tuple[int, Array]]:
    """Friction (case,) of the meshes that pass torque to a station, which asks for some (case,) without it."""
    own = [k for k, rub in enumerate(topo.rubs) if rub.driven == station]
    takes, held, shares = np.where(asked >= 0, 1.0, -1.0), np.zeros_like(asked), []
    for rub in (topo.rubs[k] for k in own):
        stated = table[:, column(rub.element, rub.loss.key)]
        entering, leaving = lost_shares(rub.loss.efficiency(stated))
        sense = np.sign(sliding(topo, rub))
        share = abs(rub.loss.weight) * np.where(takes * rub.loss.weight * sense > 0, leaving, entering)
        if station in (rub.at, rub.against):
            held = held + takes * share * sense * (1.0 if station == rub.at else -1.0)
        shares.append(share)
    return [(k, np.abs(asked) / (1 - held) * share) for k, share in zip(own, shares, strict=True)]


def lost_power(topo: Topology, lost: LostTorques, speed: Array) -> dict[int, Array]:
    """Power (case,) [W] that gears of each element lose, by its place, at speeds (case,) of the input [rad/s]."""
    found: dict[int, Array] = {}
    for k, rub in enumerate(topo.rubs):
        found[rub.element] = found.get(rub.element, 0.0) + lost.friction[:, k] * abs(sliding(topo, rub)) * speed
    for k, (station, place) in enumerate(topo.drags):
        found[place] = found.get(place, 0.0) + lost.drag[:, k] * abs(float(topo.mean_speeds[station])) * speed
    return found
