"""Any row of Hooke's joints is one Hooke's joint: the exact form of the phasor rule.

A joint turns the direction (cos χ, sin χ) into (cos ψ, sin ψ) ∝ diag(√cos β, 1/√cos β) (cos χ, sin χ), and
fork offsets and planes are rotations R. A line of joints is therefore a product M of such matrices, det M =
1, and

    dψ/dχ = 1/|M (cos χ, sin χ)|²  from 1/q to q,   q = σ_max²(M) = 1/cos β_eq,   U = q − 1/q:

rotation · one joint of angle β_eq · rotation (its singular value decomposition). With M = [[a, b], [c, d]],
U = √{[(a−d)² + (b+c)²][(a+d)² + (b−c)²]}, which keeps its figures down to U = 0.

What a joint does is thus measured by its rapidity ln sec β ≈ β²/2. Rapidities add like vectors, at angles
of 2χ (on a hyperbolic plane: exactly along a line, for small angles as the phasors β² e^{2jχ} everywhere).
No phasing brings β_eq below  ln sec β_eq = max(0, largest rapidity − sum of the others).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.topology import LinkKind
from trunnion.response.kinetostatics.chain import KinematicChain

Changes = Mapping[int, Array]


def is_one_joint(chain: KinematicChain) -> bool:
    """Whether the way to the output has Hooke's and ideal joints only, all of them in front of any ratio but 1, that
    of a locked converter say."""
    geared = False
    for i in chain.way:
        step = chain.steps[i]
        if step.orders and (geared or not step.cross):
            return False
        geared = geared or (step.link is LinkKind.RATIO and step.ratio != 1)
    return True


def matrices(
    chain: KinematicChain, cases: int, *, angle: Changes | None = None, plane: Changes | None = None,
    fork_offset: Changes | None = None,
) -> Array:  # fmt: skip
    """M of the line for many variants, shape (case, 2, 2); changed numbers are arrays (case,) by step."""
    angle, plane, fork_offset = angle or {}, plane or {}, fork_offset or {}
    product = np.broadcast_to(np.eye(2), (cases, 2, 2))
    for i in chain.way:
        step = chain.steps[i]
        if step.link is LinkKind.SHAFT:
            product = _rotation(fork_offset.get(i, step.fork_offset), cases) @ product
        elif step.law is not None:
            product = _rotation(-np.asarray(plane.get(i, step.plane)), cases) @ product
        if step.cross:
            root = np.sqrt(np.cos(angle.get(i, step.angle)))
            stretch = np.zeros((cases, 2, 2))
            stretch[:, 0, 0], stretch[:, 1, 1] = root, 1 / root
            product = stretch @ product
        if step.law is not None:
            product = _rotation(step.law.turned, cases) @ product
    return product


def departure(product: Array) -> Array:
    """(a − d, b + c) of M, shape (case, 2): zero where the output runs evenly."""
    return np.stack([product[..., 0, 0] - product[..., 1, 1], product[..., 0, 1] + product[..., 1, 0]], axis=-1)


def irregularity(product: Array) -> Array:
    """U of M [-]."""
    a, b, c, d = product[..., 0, 0], product[..., 0, 1], product[..., 1, 0], product[..., 1, 1]
    return np.hypot(a - d, b + c) * np.hypot(a + d, b - c)


def least_irregularity(chain: KinematicChain) -> float:
    """What the best phasing of the forks can reach [-]."""
    rapidities = [-np.log(np.cos(chain.steps[i].angle)) for i in chain.way if chain.steps[i].cross]
    rest = max(0.0, 2 * max(rapidities, default=0.0) - sum(rapidities))
    return float(2 * np.sinh(rest))


def phasors(chain: KinematicChain) -> tuple[Array, Array]:
    """Angles β_i and input angles χ_i [rad] of the joints on the way to the output, for small angles."""
    a, angles, phases = 0.0, [], []
    for i in chain.way:
        step = chain.steps[i]
        if step.link is LinkKind.SHAFT:
            a += step.fork_offset
        elif step.link is LinkKind.RATIO:
            a /= step.ratio
        elif step.law is not None:
            a -= step.plane
            if step.cross:
                angles.append(step.angle)
                phases.append(a)
            a += step.law.turned
    return np.array(angles), np.array(phases)


def _rotation(by: Array | float, cases: int) -> Array:
    by = np.broadcast_to(by, (cases,))
    c, s = np.cos(by), np.sin(by)
    return np.moveaxis(np.array([[c, -s], [s, c]]), -1, 0)
