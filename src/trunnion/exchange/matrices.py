"""Mass, damping and stiffness of a network: absolute rotations of what turns as one, a drive's left out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.errors import InputError
from trunnion.exchange.network import FlangeDrive, FlangeGear, FlangeInertia, FlangeSpring, Network


@dataclass(frozen=True)
class NetworkMatrices:
    """M q″ + C q′ + K q = P u: q (n,) the rotations called ``rotations`` [rad], u (m,) torques on the ``inertias``
    [N m], positive in the sense in which rotations count.

    ``load`` (m,) is the mean torque on each, by which loads resist at the stated speed. ``springs`` are the names of
    the rows of ``twist`` (s, n), the elongation of each over q; ``stiffness_of`` and ``damping_of`` (s,) are theirs.
    """

    rotations: tuple[str, ...]
    inertias: tuple[str, ...]
    springs: tuple[str, ...]
    mass: Array
    damping: Array
    stiffness: Array
    input: Array
    load: Array
    twist: Array
    stiffness_of: Array
    damping_of: Array


def matrices_of(network: Network) -> NetworkMatrices:
    """The matrices of a network; every group that gears join is measured at its first inertia.

    Raises
    ------
    InputError : gears that close a loop, or nothing that can move.
    """
    share = _shares(network)
    names = {
        int(np.flatnonzero(share[one.at])[0]): one.name
        for one in reversed(network.of(FlangeInertia))
        if share[one.at].any()
    }
    kept = sorted(names)
    if not kept:
        remedy = "give it an inertia behind a shaft"
        raise InputError("has nothing that can vibrate", element=network.name or "line", remedy=remedy)
    share = share[:, kept]
    for column, key in enumerate(kept):
        first = next(one for one in network.of(FlangeInertia) if one.name == names[key])
        share[:, column] /= share[first.at, column]
    inertias, springs = network.of(FlangeInertia), network.of(FlangeSpring)
    on = np.array([share[one.at] for one in inertias])
    twist = np.array([share[one.far] - share[one.near] for one in springs]).reshape(len(springs), len(kept))
    moments, viscous = (np.array([getattr(one, key) for one in inertias]) for key in ("inertia", "viscous_load"))
    k, c = (np.array([getattr(one, key) for one in springs]) for key in ("stiffness", "damping"))
    turning = np.array([network.turning[one.at] for one in inertias])
    constant = np.array([one.load_torque for one in inertias])
    return NetworkMatrices(
        rotations=tuple(names[key] for key in kept),
        inertias=tuple(one.name for one in inertias),
        springs=tuple(one.name for one in springs),
        mass=on.T * moments @ on,
        damping=twist.T * c @ twist + on.T * viscous @ on,
        stiffness=twist.T * k @ twist,
        input=on.T,
        load=-np.sign(turning) * constant - viscous * turning * (network.speed or 0.0),
        twist=twist,
        stiffness_of=k,
        damping_of=c,
    )


def _shares(network: Network) -> Array:
    """How every flange turns with each group that gears join (flange, group); with none where a drive holds it."""
    count = len(network.turning)
    group, ratio = np.arange(count), np.ones(count)
    for gear in network.of(FlangeGear):
        near, far = group[gear.near], group[gear.far]
        if near == far:
            raise InputError("closes a loop of gears", element=gear.name, remedy="leave it out")
        moved = group == far
        # θ_near = i θ_far: what turned with the far group now turns with the near one
        ratio[moved] *= ratio[gear.near] / (float(gear.ratio) * ratio[gear.far])
        group[moved] = near
    share = np.zeros((count, count))
    share[np.arange(count), group] = ratio
    for drive in network.of(FlangeDrive):
        share[:, group[drive.at]] = 0.0
    return share
