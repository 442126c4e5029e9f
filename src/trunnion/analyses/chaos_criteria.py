"""The criteria (37)–(39) of the THA–LEA–PM method, and which of them can tell one motion from another.

Bugaru and Vasile, Appl. Sci. 12 (2022) 6182, section 5, certify chaos where

    (37) the largest exponent is positive,  (38) one exponent is near 0,  (39) the sum is negative.

(38) holds for every forced system, whose phase is a state with exponent 0, and for every autonomous motion that is
not at rest, whose tangent has exponent 0. (39) holds for every motion of a system that shrinks volumes
everywhere, so for every damped one. Where they hold of themselves they say nothing about the motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.lyapunov_result import LyapunovSpectrum
from trunnion.systems.system import System

Array = NDArray[np.float64]


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


def criteria(system: System, spectrum: LyapunovSpectrum, *, clock: bool, at_rest: bool) -> tuple[Criterion, ...]:
    """The three criteria for one motion; ``clock``: one of the states is a phase that runs evenly."""
    exponents, width = spectrum.exponents, spectrum.half_width
    forced = system.forcing_period is not None
    first = Criterion(
        "(37) largest exponent positive", spectrum.largest, spectrum.positive, True,
        "a motion may part from its neighbours or not",
    )  # fmt: skip
    automatic = forced or clock or not at_rest
    near = 0.0 if forced else float(exponents[np.argmin(np.abs(exponents))])
    if forced:
        why = "every forced system has an exponent 0, that of its phase"
    elif clock:
        why = "one state is a phase that runs evenly and has exponent 0, whatever the motion does"
    elif not at_rest:
        why = "every autonomous motion that is not at rest has an exponent 0, that of its own direction"
    else:
        why = "the motion has come to rest"
    holds = automatic or bool(np.any(np.abs(exponents) <= width))
    second = Criterion("(38) an exponent near 0", near, holds, not automatic, why)
    return first, second, _third(system, spectrum)


def _third(system: System, spectrum: LyapunovSpectrum) -> Criterion:
    name, total = "(39) sum of the exponents negative", spectrum.sum
    if system.divergence is not None:
        kind = "shrink" if total < 0 else "keep their size" if abs(total) <= spectrum.half_width.sum() else "grow"
        why = f"volumes {kind} at {spectrum.divergence:.6g} 1/s along every motion of this system"
        return Criterion(name, total, bool(spectrum.divergence < 0), False, why)
    worst = _largest_divergence(system, spectrum)
    if worst < 0:
        return Criterion(
            name, total, True, False, f"volumes shrink at {-worst:.4g} 1/s or more everywhere on the motion"
        )
    return Criterion(name, total, bool(total < 0), True, "volumes shrink in places and grow in others")


def _largest_divergence(system: System, spectrum: LyapunovSpectrum) -> float:
    """Of the places where the motion was sampled; the phase of the forcing is taken all around."""
    states = np.concatenate([run.states[:: max(len(run.states) // 50, 1)] for run in spectrum.runs])
    period = system.forcing_period or 1.0
    found = [
        np.trace(system.jacobian(period * k / 7, x, system.regime_at(period * k / 7, x)))
        for x in states
        for k in range(7 if system.forcing_period else 1)
    ]
    return float(np.max(found))
