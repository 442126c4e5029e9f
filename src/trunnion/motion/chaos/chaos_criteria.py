"""The criteria (37)–(39) of the THA–LEA–PM method, and which of them can tell one motion from another.

Bugaru and Vasile, Appl. Sci. 12 (2022) 6182, section 5, certify chaos where

    (37) the largest exponent is positive,  (38) one exponent is near 0,  (39) the sum is negative.

(38) holds for every forced system, whose phase is a state with exponent 0, and for every bounded autonomous motion
that is not at rest, whose tangent has exponent 0. (39) holds for every motion of a system that shrinks volumes
everywhere, so for every damped one, and for none of a system that preserves them. Where the answer is known
beforehand they say nothing about the motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.motion.chaos.chaos_subject import phases
from trunnion.motion.chaos.lyapunov_result import LyapunovSpectrum
from trunnion.systems.system import System
from trunnion.systems.user_functions import REACH, STEP

EXACT, DIFFERENCED = 1e-14, 1e-11
"""Divergence over the size of ∂f/∂x (differenced: times that of the state, too) that rounding may give."""


@dataclass(frozen=True)
class Criterion:
    """name, value [1/s], whether it holds, whether it could have failed for this system, and why."""

    name: str
    value: float
    holds: bool
    discriminates: bool
    why: str

    def __str__(self) -> str:
        use = "discriminates" if self.discriminates else "cannot discriminate"
        return f"{self.name}: {self.value:+.4g} 1/s, {'holds' if self.holds else 'fails'}; {use}: {self.why}"


def criteria(
    system: System, spectrum: LyapunovSpectrum, *, clock: bool, at_rest: bool, bounded: bool = True
) -> tuple[Criterion, ...]:
    """The three criteria for one motion; ``clock``: one of the states is a phase that runs evenly."""
    exponents, width = spectrum.exponents, spectrum.half_width
    forced = system.forcing_period is not None
    first = Criterion(
        "(37) largest exponent positive", spectrum.largest, spectrum.positive, True,
        "a motion may part from its neighbours or not",
    )  # fmt: skip
    automatic = forced or clock or (bounded and not at_rest)
    near = 0.0 if forced else float(exponents[np.argmin(np.abs(exponents))])
    if forced:
        why = "every forced system has an exponent 0, that of its phase"
    elif clock:
        why = "one state is a phase that runs evenly and has exponent 0, whatever the motion does"
    elif not bounded:
        why = "the motion is not bounded, so the exponent of its own direction may be any"
    elif not at_rest:
        why = "every bounded autonomous motion that is not at rest has an exponent 0, that of its own direction"
    elif spectrum.largest < 0:
        why = "the motion has come to rest"
    else:
        why = "the motion is at rest on an unstable equilibrium"
    holds = automatic or bool(np.any(np.abs(exponents) <= width))
    second = Criterion("(38) an exponent near 0", near, holds, not automatic, why)
    return first, second, _third(system, spectrum)


def _third(system: System, spectrum: LyapunovSpectrum) -> Criterion:
    name, total = "(39) sum of the exponents negative", spectrum.sum
    if system.regimes is not None and system.equations.jump:
        return Criterion(name, total, bool(total < 0), True, "the jumps of the motion change volumes, too")
    low, high, rounding = _divergences(system, spectrum)
    if max(-low, high) <= rounding:
        why = "volumes are preserved, so the sum is 0 but for rounding, whatever the motion does"
        return Criterion(name, total, False, False, why)
    if low > 0 or high < 0:
        kind, rate = ("shrink", -high) if high < 0 else ("grow", low)
        told = f"{rate:.6g} 1/s along every motion of this system"
        if system.divergence is None:
            told = f"{rate:.4g} 1/s or more everywhere on the motion"
        return Criterion(name, total, high < 0, False, f"volumes {kind} at {told}")
    return Criterion(name, total, bool(total < 0), True, "volumes shrink in places and grow in others")


def _divergences(system: System, spectrum: LyapunovSpectrum) -> tuple[float, float, float]:
    """Smallest and largest divergence where the motion was sampled, all around the forcing, and its rounding."""
    states = np.concatenate([run.states[:: max(len(run.states) // 50, 1)] for run in spectrum.runs])
    matrices = np.array([system.jacobian(t, x, system.regime_at(t, x)) for x in states for t in phases(system)])
    size = float(np.max(np.abs(matrices)))
    if system.divergence is not None:
        return spectrum.divergence, spectrum.divergence, EXACT * size
    furthest = 1 + min(float(np.max(np.abs(states) / np.asarray(system.scale))), STEP / REACH)
    rounding = EXACT * size if system.exact_tangents else DIFFERENCED * size * furthest
    traces = np.trace(matrices, axis1=1, axis2=2)
    return float(traces.min()), float(traces.max()), rounding
