"""The periodic motion of one long line at one speed, by Newton's steps along its tree, and how well it is known.

Steps with more harmonics follow until one changes the motion by no more than rounding: what the one before the last
misses is no less than what is left. All balance entries of the tree; that these are the line's equations is checked by
the compiled ones along the motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly
from trunnion.equations.given_rotation import GivenRotation
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.prepared_line import ANGLE_SCALE
from trunnion.equations.steady_base import require_balance
from trunnion.errors import ComputationError
from trunnion.numerics import harmonics as fourier
from trunnion.numerics.integration.integration import Equations
from trunnion.numerics.integration.sampled_rates import sampled_rates
from trunnion.steady.free.free_balance import SteadyStates
from trunnion.steady.free.periodic_steady_states import SteadyStateCurve, SteadyStatesBySpeed
from trunnion.steady.free.several_motions import leads_elsewhere, require_one_motion
from trunnion.steady.free.tree_newton import TreeMotions

CHECKS = 24
"""Times of the period at which the compiled equations are asked."""
SETTLED, MOST_STEPS = 1e-14, 3
"""Change of a harmonic [rad] by a step that is rounding; steps, each with as many harmonics more as the motion has."""
AGREES = 1e-7
"""Acceleration that they may leave, over the largest of the motion."""


@dataclass(frozen=True)
class LongSteadyState:
    """At a ``value`` of ``curve``, where the packed numbers are ``table`` (1, column), the motion ``given`` of the line
    without excitations, one that is known less well, ``rough``, and the ``torque`` [N m at the input] of its drives
    beyond the balance."""

    curve: SteadyStateCurve
    value: float
    table: Array
    given: GivenRotation
    rough: GivenRotation
    torque: float

    @property
    def assembly(self) -> Assembly:
        """The line without excitations."""
        return self.curve.balance.assembly

    @property
    def speed(self) -> float:
        """Mean speed of the input [rad/s]."""
        return float(self.table[0, 0])

    @property
    def coefficients(self) -> LineCoefficients:
        """The numbers of the line, untwisted."""
        return self.assembly.untwisted(self.table)

    @property
    def swing(self) -> float:
        """Largest amplitude of any harmonic [rad]."""
        return float(np.abs(self.given.rows[..., 1:]).max())


def long_steady_state(line: Driveline, speed: float, least: int) -> LongSteadyState | None:
    """The motion at (mean) input ``speed`` [rad/s], without exciters, of a line of ``least`` unknowns or more; None of
    one whose equations are not those of a tree without stages and play.

    Raises
    ------
    InputError : torques that do not balance.
    ComputationError : no motion found, or several at this speed.
    """
    curve = SteadyStatesBySpeed(line)
    if curve.unexcited.topology.size < least or curve.obstacle or not curve.balance.of_tree:
        return None
    balance, at = curve.balance, np.array([speed])
    balance.along_tree = True
    require_balance(balance.assembly, balance.assembly.table(1, speed))
    motions = curve.at_all(at)
    if leads_elsewhere(balance, motions):
        require_one_motion(curve, line, speed)
        motions = curve.at_all(at)
    if not (motions.found[0] and motions.resolved[0]):
        raise ComputationError(
            f"no periodic motion of the line was found to judge in {motions.h} harmonics; ask for another speed, or "
            "give it more damping"
        )
    return refined(curve, motions)


def refined(curve: SteadyStateCurve, motions: SteadyStates) -> LongSteadyState | None:
    """The one motion of ``motions`` as well as it can be known; None where the compiled equations have another."""
    balance = curve.balance
    newton, unit = balance.newton(motions.table), balance.torque_unit(motions.coefficients)
    better = TreeMotions(motions.rows, motions.torque, np.zeros(1))
    for k in range(2, 2 + MOST_STEPS):
        once = TreeMotions(fourier.resized(better.rows, k * motions.h), better.torque, better.size)
        better = newton.corrected(once, unit, ANGLE_SCALE)
        if np.abs(better.rows - once.rows).max() <= SETTLED:
            break
    found = LongSteadyState(
        curve, float(motions.value[0]), motions.table, newton.given(better), newton.given(once), float(better.torque[0])
    )
    left, size = unbalanced(found, motions.driven(found.torque - motions.torque[0])[0])
    return found if np.all(left <= AGREES * size) else None


def unbalanced(motion: LongSteadyState, numbers: Array) -> tuple[Array, float]:
    """By how much accelerations along the motion differ from those of the compiled equations, which read ``numbers``,
    (time, n) [rad/s²], and what counts as one; NaN where these have none."""
    balance, speed = motion.curve.balance, motion.speed
    tau = balance.period * (np.arange(CHECKS) + 0.5) / CHECKS
    x, rate, bend = (part[0] for part in motion.given.at(tau))
    states, n = np.concatenate([x, rate * speed], axis=1), x.shape[1]
    known = sampled_rates(Equations(balance.address, 2 * n, numbers, balance.weight), tau / speed, states, 0)
    felt = np.full(x.shape, np.nan) if known is None else known[0][:, n:]
    return np.abs(felt - bend * speed**2), max(ANGLE_SCALE, float(np.abs(bend).max())) * speed**2
