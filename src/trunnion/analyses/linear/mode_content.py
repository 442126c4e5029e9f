"""Which modes a growing Floquet mode consists of, and the resonance that they name.

A Floquet mode x = e^{μτ} Σ_h X_h e^{ihbτ} oscillates at the frequencies f_h = Im μ + hb. In a parametric resonance
ω_i + ω_j = νΩ it holds mode i at a frequency f > 0 and mode j at one f′ < 0, and f − f′ = ν is the exciting frequency
exactly, whatever the angles of the joints have made of ω_i and ω_j. How much of a mode there is at a frequency is
measured by its action f |φᵀMX|², the energy over the frequency: the two modes of a sum resonance hold equal actions of
opposite sign (their Krein signatures), while their energies are as ω_i to ω_j.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from trunnion.analyses.linear.resonance_speeds import Resonance, Source
from trunnion.numerics.chain.dense_monodromy import Propagation
from trunnion.systems.periodic_linear import PeriodicLinearSystem

Array = NDArray[np.float64]
MAIN = 0.5
"""Share of the positive and of the negative action that a mode must hold to give its name."""
HIGHEST_ORDER, HIGHEST_MIXED = 16, 4
"""Multiples of one excitation, and of several together, that a name may hold."""


@dataclass(frozen=True)
class ModeContent:
    """Shares of the positive and the negative action by mode (mode,), and ν, the exciting frequency per turn."""

    forward: Array
    backward: Array
    excitation: Fraction

    @property
    def pair(self) -> tuple[int, int] | None:
        """The two modes, numbered from 0 and ascending; None where the content is mixed."""
        i, j = int(self.forward.argmax()), int(self.backward.argmax())
        clear = min(self.forward[i], self.backward[j]) >= MAIN and self.excitation > 0
        return (min(i, j), max(i, j)) if clear else None


def mode_content(
    system: PeriodicLinearSystem, run: Propagation, turns: Fraction, multiplier: complex, start: NDArray[np.complex128]
) -> ModeContent | None:
    """Content of the Floquet mode that is ``start`` (2n,), x and dx/dτ, at τ = 0; modes are those of the mean M and K.

    None where the mode does not oscillate both ways.
    """
    n, tau = system.size, run.tau[:-1]
    mean = system.coefficients(tau[:: max(1, len(tau) // 64)])
    mass, stiffness = mean.mass.mean(0), mean.stiffness.mean(0)
    shapes = eigh((stiffness + stiffness.T) / 2, (mass + mass.T) / 2)[1]
    exponent = np.log(complex(multiplier)) / system.period
    periodic = (run.matrix[:-1, :n] @ start) * np.exp(-exponent * tau)[:, None]
    harmonic = np.round(np.fft.fftfreq(len(tau)) * len(tau)).astype(int)
    frequency = exponent.imag + harmonic * 2 * np.pi / system.period
    modal = np.fft.fft(periodic, axis=0) / len(tau) @ mass @ shapes
    action = frequency[:, None] * np.abs(modal) ** 2
    ahead, back = np.maximum(action, 0), np.maximum(-action, 0)
    forward, backward = ahead.sum(0), back.sum(0)
    if not (forward.sum() > 0 and backward.sum() > 0):
        return None
    first, second = ahead[:, forward.argmax()].argmax(), back[:, backward.argmax()].argmax()
    excitation = int(harmonic[first] - harmonic[second]) / turns
    return ModeContent(forward / forward.sum(), backward / backward.sum(), excitation)


def named_resonance(
    content: ModeContent | None, frequency: Array, sources: tuple[Source, ...], turns: Fraction, farthest: float
) -> Resonance | None:
    """The resonance of a content, or None where it is mixed or no excitation of low order has its frequency.

    ``frequency`` are those of the straight line over the input speed, so that speed 1 is where the line runs; a name
    farther than ``farthest`` in the logarithm of the speed is none.
    """
    pair = content.pair if content is not None else None
    if content is None or pair is None:
        return None
    i, j = pair
    nu = content.excitation
    multiple, source = _excited(nu, sources)
    if source is None:
        return None
    speed = float(frequency[i] + frequency[j]) / float(nu)
    if not speed > 0 or abs(np.log(speed)) > farthest:
        return None
    if i != j:
        return Resonance(speed, "sum", (i + 1, j + 1), multiple, source.rate, source.mesh)
    kind = "subharmonic" if multiple % 2 else "harmonic"
    return Resonance(speed, kind, (i + 1,), (multiple + 1) // 2, source.rate, source.mesh)


def _excited(nu: Fraction, sources: tuple[Source, ...]) -> tuple[int, Source | None]:
    """ν as a multiple of one source, the lowest; else of two of them together as a source of its own."""
    alone = [(int(nu / (2 * s.rate)), s) for s in sources if (nu / (2 * s.rate)).denominator == 1]
    alone = [(m, s) for m, s in alone if m <= HIGHEST_ORDER]
    if alone:
        return min(alone, key=lambda found: found[0])
    reach = range(-HIGHEST_MIXED + 1, HIGHEST_MIXED)
    for a, one in enumerate(sources):
        for other in sources[a + 1 :]:
            for m in reach:
                rest = (nu - 2 * m * one.rate) / (2 * other.rate)
                if rest.denominator == 1 and 0 < abs(m) + abs(rest) <= HIGHEST_MIXED:
                    return 1, Source(nu / 2, one.mesh or other.mesh)
    return 0, None
