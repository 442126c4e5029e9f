"""What is judged of a long line about its own periodic motion: its Floquet modes along the tree, without what is no
disturbance of it.

Of a free–free line a shift of the phase comes back exactly and is set aside by its state. Where no torque depends on
the speed, a change of that is left out too: of multipliers that are real and positive the one whose mode is nearest to
it, and that grows if the motion takes the less torque the faster it is.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex, Flags
from trunnion.equations.aligned import rigid_rotation
from trunnion.equations.topology import require_period
from trunnion.floquet.propagation.hill_line import PeriodicMotionGiven
from trunnion.floquet.propagation.tree_mode_motion import mode_motion
from trunnion.floquet.propagation.tree_modes import FloquetModes, floquet_modes
from trunnion.modes.mode_content import ModeMotion
from trunnion.numerics.spectrum import real_positive, spectral_radius
from trunnion.results.verdict import Verdict, verdicts
from trunnion.steady.free.long_steady_state import LongSteadyState, refined
from trunnion.steady.free.periodic_steady_states import SteadyStateCurve
from trunnion.waiting import keep_time

UNDAMPED = 1e-13
"""Damping over the period, for each unknown, that counts as none."""


@dataclass(frozen=True)
class PeriodicMotionModes:
    """All ``modes`` about a ``motion`` but the shift of its phase; ``counted`` (m,) those that are judged; radius and
    its error; ``speed_multiplier``: of the one left out, NaN without."""

    motion: LongSteadyState
    modes: FloquetModes
    counted: Flags
    radius: float
    error: float
    verdict: Verdict
    speed_multiplier: float

    @property
    def critical(self) -> int:
        """Which of the modes is the largest that counts."""
        return int(np.flatnonzero(self.counted)[0])

    def critical_motion(self) -> ModeMotion | None:
        """How that mode moves over the period; None for a double multiplier."""
        motion, topo = self.motion, self.motion.assembly.topology
        turns, exponent = require_period(motion.assembly.line, topo), complex(self.modes.exponent[self.critical])
        return mode_motion(topo, motion.coefficients, turns, exponent, _about(motion))


def periodic_motion_modes(motion: LongSteadyState, tolerance: float) -> PeriodicMotionModes | None:
    """None where they are known less well than ``tolerance``."""
    topo, co = motion.assembly.topology, motion.coefficients
    modes = floquet_modes(topo, co, require_period(motion.assembly.line, topo), _about(motion))
    if modes is None or modes.off > tolerance:
        return None
    counted, speed = np.ones(len(modes.multiplier), dtype=bool), np.nan
    if topo.free and not motion.curve.by_speed(motion.table)[0]:
        place = _of_speed(motion, modes)
        counted[place], speed = False, float(modes.multiplier[place].real)
    radius, error = (float(part) for part in spectral_radius(modes.multiplier[counted], modes.error[counted]))
    verdict = Verdict(int(verdicts(radius, error, abs(modes.trace) < UNDAMPED * topo.size)))
    return PeriodicMotionModes(motion, modes, counted, radius, error, verdict, speed)


def periodic_motion_modes_along(
    curve: SteadyStateCurve, values: Array, tolerance: float
) -> list[PeriodicMotionModes | None]:
    """About the motions at all ``values`` of a curve, one by one; None where there is none, or it is known less well
    than ``tolerance``."""
    return [None if motion is None else periodic_motion_modes(motion, tolerance) for motion in _motions(curve, values)]


def _motions(curve: SteadyStateCurve, values: Array) -> Iterator[LongSteadyState | None]:
    motions = curve.at_all(values)
    for i in range(len(values)):
        keep_time()
        there = motions.found[i] and motions.resolved[i]
        yield refined(curve, motions.part(slice(i, i + 1))) if there else None


def _about(motion: LongSteadyState) -> PeriodicMotionGiven:
    return PeriodicMotionGiven(motion.given, motion.rough, motion.swing)


def _of_speed(motion: LongSteadyState, modes: FloquetModes) -> int:
    """Which mode is a change of the speed."""
    turn = rigid_rotation(motion.assembly.topology)
    faster = _beside(np.concatenate([0j * turn, turn])[:, None], motion.given.shift(turn)[0])
    states = _beside(modes.states, motion.given.shift(turn)[0])
    near = np.abs(faster[:, 0] @ states) / np.linalg.norm(states, axis=0)
    steady = real_positive(modes.multiplier)
    if steady.sum() > 1 and (rise := motion.curve.torque_rise(motion.value)):
        right = steady & ((modes.multiplier.real > 1) == (rise < 0))
        steady = right if right.any() else steady
    return int(np.argmax(np.where(steady | ~steady.any(), near, -1.0)))


def _beside(states: Complex, shift: Array) -> Complex:
    """States (2n, m) without their part along the shift of the phase (2n,)."""
    one = shift / np.linalg.norm(shift)
    return np.asarray(states - one[:, None] * (one @ states), dtype=complex)
