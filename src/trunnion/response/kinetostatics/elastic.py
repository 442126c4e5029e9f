"""Twist of the shafts, consistent with motion and torque at every angle (S2's algorithm, without ξ ≈ const).

A shaft twists by ξ = T/c under the torque T it passes on (one with stages by what its law gives for T at that
angle); the twist shifts the phase of every joint behind
it, which changes the torques in front of those joints, and so on: a fixed point, found for all angles (and
for the rates of ξ, as jets) at once. One round changes the twist by its last change times ∂T/∂φ /c, which is
the twist itself times η′: a few hundredths for steel shafts, so that some ten rounds reach rounding.

Inertia torques are those of the rigid line: quasi-static, right as long as the excitation, twice the shaft
speed, stays well below the lowest elastic natural frequency ω₁ (they are too small by about 1 − (2Ω/ω₁)²).
Loads that grow with the speed take that of the rigid line too: the twist changes it by its own rate only.
Damping in the shafts is left out. Where a shaft passes from one stage to the next its twist is continuous and its
rate is not; the rates given are those beside the step.
"""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.kinematics import Rotations
from trunnion.errors import ComputationError
from trunnion.numerics import jets
from trunnion.response.kinetostatics.chain import ChainStep, KinematicChain
from trunnion.response.kinetostatics.motion import Drive, walk
from trunnion.response.kinetostatics.torques import Torques, rates_needed, torques

ROUNDS = 300
MOTION_ORDER = 2


def solve(chain: KinematicChain, drive: Drive, *, rigid: bool) -> tuple[Rotations, Torques, dict[int, Array]]:
    """Motion, torques and twists (jets by Shaft step [rad], far end minus near end; none if rigid)."""
    if rigid:
        motion = walk(chain, drive.jet(MOTION_ORDER))
        return motion, torques(chain, drive, motion, 0, motion), {}
    untwisted = walk(chain, drive.jet(MOTION_ORDER + rates_needed(chain, drive)))
    motion, twist, change = untwisted, dict[int, Array](), np.inf
    for _ in range(ROUNDS):
        found = torques(chain, drive, motion, MOTION_ORDER, untwisted)
        new = {i: _yielding(chain.steps[i], found.out[i]) for i in chain.shafts}
        before, change = change, _change(new, twist, drive.speed)
        twist = new
        if change < 1e-15 or (change < 1e-11 and change >= before):  # rounding
            return motion, found, twist
        motion = walk(chain, drive.jet(MOTION_ORDER), twist)
    worst = max(twist, key=lambda i: float(np.nanmax(np.abs(twist[i][0]))))
    raise ComputationError(
        f"twist does not settle in {ROUNDS} rounds (last change {change:.1e} rad): {chain.steps[worst].name} "
        "yields more than its joints' torque allows; make it stiffer or lower the torque"
    )


def constant_twist(chain: KinematicChain, drive: Drive, twist: dict[int, Array]) -> Rotations:
    """S2's approximation: the motion with every twist held at its mean over the turn."""
    mean = {i: jets.constant(float(np.mean(xi[0])), xi) for i, xi in twist.items()}
    return walk(chain, drive.jet(MOTION_ORDER), mean)


def _yielding(step: ChainStep, passed: Array) -> Array:
    """Jet of the twist [rad] of a shaft that passes the torque with the jet ``passed`` [N m].

    Raises
    ------
    InputError : the outermost stage has no stiffness and the torque goes beyond it.
    """
    if step.stages is None:
        return -passed / step.stiffness
    torque = -passed[0]
    twist, slope, _ = step.stages.under(torque, free=True)
    if np.any((slope == 0) & (torque != 0)):
        step.stages.under(torque[torque != 0])
    rates = np.divide(-passed, slope, out=np.zeros_like(passed), where=slope > 0)
    return np.concatenate([twist[None], rates[1:]])


def _change(new: dict[int, Array], old: dict[int, Array], speed: float) -> float:
    """Largest change [rad] of a twist, or of its rates per radian and radian² of input angle."""
    if not old:
        return np.inf if new else 0.0
    return max(float(np.max(np.abs(xi[k] - old[i][k]))) / speed**k for i, xi in new.items() for k in range(len(xi)))
