"""What dry friction and clutches bear together, of groups at rest and clutches without slip.

Each unknown rotation has an inertia J and the acceleration a₀ that it would have without what is asked for here. A
bond holds one motion s = A a − d at nothing, the rotation of a group that stands or the slip of a clutch that sticks,
by a torque of at most its limit:

    a = a₀ − J⁻¹ Aᵀ λ,   |λ| ≤ limit,   s = 0, or λ at its limit against s.

That is the optimum of ½ λᵀ A J⁻¹ Aᵀ λ − λᵀ (A a₀ − d), whose accelerations are the only ones (Gauss's principle of
least constraint); where bonds share a torque in more than one way, any of them. A bond that lets go resists with what
it does in motion, and the others are asked again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import lsq_linear

from trunnion.arrays import Array
from trunnion.equations.line_regimes import line_kernel
from trunnion.equations.line_system import LineSystem

CLEAR = 1e-11
"""Share of all that acts on it beyond which a bond moves."""


@dataclass(frozen=True)
class Bonds:
    """Inertias and free accelerations (n,), what the bonds hold (bond, n) and d (bond,), limits at rest and in motion
    (bond,) [N m]."""

    inertia: Array
    free: Array
    holds: Array
    drift: Array
    rest: Array
    moving: Array

    def judged(self) -> tuple[Array, Array]:
        """The sense in which every bond lets go (bond,), 0 where it holds, and its torque (bond,) [N m]."""
        count = len(self.rest)
        way, torque = np.zeros(count), np.zeros(count)
        size = np.abs(self.holds) @ (np.abs(self.free) + (np.abs(self.holds.T) @ self.rest) / self.inertia)
        for _ in range(count):
            torque = self._shared(way)
            accelerated = self.holds @ (self.free - (self.holds.T @ torque) / self.inertia) - self.drift
            goes = np.where(np.abs(accelerated) > CLEAR * size, np.sign(accelerated), 0.0)
            if not np.any(new := (way == 0.0) & (goes != 0.0)):
                break
            way[new] = goes[new]
        return way, torque

    def _shared(self, way: Array) -> Array:
        """The torque of every bond, those that have let go resisting in motion."""
        torque = way * self.moving
        holding = np.flatnonzero((way == 0.0) & (self.rest > 0.0))
        if not len(holding):
            return torque
        root = np.sqrt(self.inertia)
        free = self.free - (self.holds.T @ torque) / self.inertia
        spread = (self.holds[holding] / root).T
        beside = np.linalg.lstsq(spread.T, self.drift[holding], rcond=None)[0]
        limit = self.rest[holding]
        # In units of the limits, so that all bounds are alike.
        found = lsq_linear(spread * limit, root * free - beside, (-1.0, 1.0), method="bvls", tol=1e-15)
        torque[holding] = limit * found.x
        return torque


def bonds_of(
    line: LineSystem, numbers: Array, standing: Sequence[int], sticking: Sequence[int], rest: Array, moving: Array
) -> Bonds:
    """The bonds of groups at rest, by their first stations, and behind them of clutches that stick, with their limits;
    ``numbers`` as the right-hand side has left them where none of these groups stands."""
    core, topo, n = line_kernel(), line.assembly.topology, line.assembly.topology.size
    compliance, _, _, scratch = map(int, core.places(numbers))
    v, r, r1, _, room = (scratch + k * len(topo.stations) for k in range(1, 6))
    inertia, free = numbers[room : room + n].copy(), numbers[room + 6 * n : room + 7 * n].copy()
    stands = np.zeros((len(standing), n))
    stands[np.arange(len(standing)), [int(topo.unknown_of[first]) for first in standing]] = 1.0
    slips, drift = np.zeros((len(line.clutches), n)), np.zeros(len(line.clutches))
    for c, clutch in enumerate(line.clutches):
        at = compliance + clutch.compliance * core.PER_COMPLIANCE
        near, i, j = (int(numbers[at + k]) for k in (core.NEAR, core.NEAR_COORDINATE, core.FAR_COORDINATE))
        slips[c, j] = 1.0
        if i >= 0:
            slips[c, i] -= numbers[r + near]
            reference = int(numbers[core.HEAD + near * core.PER_STATION + core.REFERENCE])
            drift[c] = numbers[r1 + near] * numbers[v + reference] ** 2
        if c not in sticking:
            free -= slips[c] * numbers[room + 7 * n + clutch.compliance] / inertia
    held = np.array(sticking, dtype=np.int64)
    return Bonds(
        inertia, free, np.concatenate([stands, slips[held]]), np.append(np.zeros(len(standing)), drift[held]), rest,
        moving,
    )  # fmt: skip
