"""What is read from a steady response: twist and torque of every spring, deviation of every inertia and joint input.

One solution belongs to frequencies ω₀ + hbΩ about one carrier ω₀. All of it stands on one axis of *channels*:
springs' elastic twist, springs' torque, unknowns' deviation from the base motion, deviation at the joints' inputs, and
that of the points whose motion is shown: disks, each where it is, behind its joint if there is one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise

import numpy as np

from trunnion.arrays import Array, Complex, Integers, Places
from trunnion.equations.topology import Topology


@dataclass(frozen=True)
class Channels:
    """Where each kind of quantity stands on the axis of channels.

    twist [rad] and torque [N m] of every spring; deviation [rad] from the base motion of every unknown, the first
    station of its group, of every joint_input, and of every point of ``Topology.points``.
    """

    twist: slice
    torque: slice
    deviation: slice
    joint_input: slice
    point: slice

    @property
    def points(self) -> int:
        """How many points there are."""
        return int(self.point.stop - self.point.start)

    @property
    def count(self) -> int:
        """How many channels there are."""
        return int(self.point.stop)


def channels_of(topo: Topology) -> Channels:
    """The channels of a line."""
    springs = len(topo.compliances)
    ends = list(accumulate([springs, springs, topo.size, len(topo.joints), len(topo.points)], initial=0))
    return Channels(*(slice(start, end) for start, end in pairwise(ends)))


def motion_channels(topo: Topology, x: Complex, ratio: Array, relative: Array) -> Complex:
    """Channels (case, time, channel) without torque, of unknowns x (case, time, n).

    ratio (case, time, compliance) as of ``LineMatrices``; relative (case, time, station) as of ``BaseMotion``.
    """
    places = channels_of(topo)
    seen = np.zeros((*x.shape[:2], places.count), dtype=complex)
    at = _seen_stations(topo)
    if topo.graph:
        seen[..., places.twist], seen[..., places.deviation] = x @ topo.elongations.T, x
        seen[..., places.joint_input.start :] = x @ topo.turning[at].T
        return seen
    for e, (far, near) in enumerate(topo.ends):
        if far >= 0:
            seen[..., e] += x[..., far]
        if near >= 0:
            seen[..., e] -= ratio[..., e] * x[..., near]
    seen[..., places.deviation] = x
    for k, station in enumerate(at, start=places.joint_input.start):
        if (i := topo.unknown_of[station]) >= 0:
            seen[..., k] = relative[..., station] * x[..., i]
    return seen


def graph_channels_of_harmonics(
    topo: Topology, x: Complex, h: Integers, times: int, elongations: Array, turning: Array
) -> Complex:
    """The same as ``channels_of_harmonics`` of a line that is not a tree: elongations (case, time, compliance, n) and
    turning (case, time, station, n) of its equations."""
    places, at = channels_of(topo), _seen_stations(topo)
    spectrum = np.zeros((len(x), times, topo.size), dtype=complex)
    middle = int(h[len(h) // 2])
    spectrum[:, (h - middle) % times] = x
    grid = np.fft.ifft(spectrum, axis=1)[..., None]
    rows = np.concatenate([elongations, turning[:, :, at]], axis=2)
    read = np.fft.fft((rows @ grid)[..., 0], axis=1)[:, (h - middle) % times]
    seen = np.zeros((*x.shape[:2], places.count), dtype=complex)
    springs = elongations.shape[2]
    seen[..., places.twist], seen[..., places.deviation] = read[..., :springs], x
    seen[..., places.joint_input.start :] = read[..., springs:]
    return seen


def _seen_stations(topo: Topology) -> list[int]:
    """Stations in front of joints, and those of the points."""
    return [topo.stations[joint].before for joint in topo.joints] + [station for station, _ in topo.points]


def channels_of_harmonics(
    topo: Topology, x: Complex, h: Integers, times: int, ratio: Array, relative: Array
) -> Complex:
    """Channels (case, h, channel) without torque, of the harmonics x (case, h, n) of the unknowns at ``h`` (h,).

    ratio and relative as of ``motion_channels``, at ``times`` samples of the period.
    """
    places, middle = channels_of(topo), int(h[len(h) // 2])
    at = np.array(_seen_stations(topo), dtype=np.intp)
    near = [near for _, near in topo.ends]
    seen = np.zeros((*x.shape[:2], places.count), dtype=complex)
    seen[..., places.twist] = _passed(x, h - middle, near, ratio, times)
    seen[..., places.twist] *= -1
    far = np.array([far for far, _ in topo.ends], dtype=np.intp)
    moves = np.flatnonzero(far >= 0)
    seen[..., moves] += x[..., far[moves]]
    seen[..., places.deviation] = x
    stop = places.joint_input.start + len(at)
    seen[..., places.joint_input.start : stop] = _passed(x, h - middle, topo.unknown_of[at], relative[..., at], times)
    return seen


def _passed(x: Complex, h: Integers, of: Sequence[int] | Places, factor: Array, times: int) -> Complex:
    """Harmonics (case, h, m) of x (case, h, n) ``of`` m unknowns, 0 of −1, times a ``factor`` (case, time, m)."""
    of = np.asarray(of, dtype=np.intp)
    found = np.zeros((*x.shape[:2], len(of)), dtype=complex)
    moves = of >= 0
    varies = moves & np.any(np.ptp(factor, axis=1) > 0, axis=0)
    same = np.flatnonzero(moves & ~varies)
    found[..., same] = factor[:, :1, same] * x[..., of[same]]
    nonuniform = np.flatnonzero(varies)
    if len(nonuniform):
        spectrum = np.zeros((len(x), times, len(nonuniform)), dtype=complex)
        spectrum[:, h % times] = x[..., of[nonuniform]]
        grid = np.fft.ifft(spectrum, axis=1) * factor[..., nonuniform]
        found[..., nonuniform] = np.fft.fft(grid, axis=1)[:, h % times]
    return found
