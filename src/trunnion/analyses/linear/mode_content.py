"""Which modes a growing Floquet mode consists of, and the resonance that they name.

A Floquet mode x = e^{μτ} Σ_h X_h e^{ihbτ} oscillates at the frequencies f_h = Im μ + hb. In a parametric resonance
ω_i + ω_j = νΩ it holds mode i at a frequency f > 0 and mode j at one f′ < 0, and f − f′ = ν is the exciting frequency
exactly, whatever the angles of the joints have made of ω_i and ω_j. How much of a mode there is at a frequency is
measured by its action f |φᵀMX|², the energy over the frequency: the two modes of a sum resonance hold equal actions of
opposite sign (their Krein signatures), while their energies are as ω_i to ω_j.

At large angles a mode may also be pushed aside slowly, or shaken far from its own frequency, and grow by that; action
by frequency hardly sees it. So no name is given to modes that do not lead in the mean of energy over ω_i as well.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from trunnion.analyses.linear.resonance_speeds import Resonance, Source

Array = NDArray[np.float64]
MAIN, ALONE = 0.4, 0.55
"""Share of the positive and of the negative action that each of two modes must hold for a name, and one alone."""
CLEAR = 1.25
"""Energy over ω of the lesser of two excited modes over that of any other, at least."""
RIGID = 1e-9
"""Square of a frequency over the highest one's below which a mode is a turn of the whole line."""
HIGHEST_ORDER, HIGHEST_MIXED = 16, 4
"""Multiples of one excitation, and of several together, that a name may hold."""


@dataclass(frozen=True)
class ModeContent:
    """Shares of the positive and the negative action by mode (mode,), ν, the exciting frequency per turn, and by mode
    the share of the energy over ω, mean of the period."""

    forward: Array
    backward: Array
    excitation: Fraction
    held: Array

    @property
    def pair(self) -> tuple[int, int] | None:
        """The two modes, numbered from 0 and ascending; None where the content is mixed."""
        i, j = int(self.forward.argmax()), int(self.backward.argmax())
        most = MAIN if i != j else ALONE
        clear = min(self.forward[i], self.backward[j]) >= most and self.excitation > 0
        lead = CLEAR if i != j else 1.0
        leads = min(self.held[i], self.held[j]) >= lead * np.delete(self.held, [i, j]).max(initial=0.0)
        return (min(i, j), max(i, j)) if clear and leads else None


@dataclass(frozen=True)
class ModeMotion:
    """The states (samples, 2n), x and dx/dτ, of one growing Floquet mode over a period, and what they are judged by.

    Samples stand at equal distances of the input's angle from 0 on, the end left out; ``exponent`` is ln σ over
    ``period`` [rad]; mass and stiffness (n, n) are the means M and K over the period, in any common unit.
    """

    states: NDArray[np.complex128]
    exponent: complex
    period: float
    mass: Array
    stiffness: Array


def mode_content(motion: ModeMotion, turns: Fraction) -> ModeContent | None:
    """Content of a Floquet mode of period ``turns`` of the input; modes are those of the mean M and K.

    None where the mode does not oscillate both ways, or no mode of the mean M and K oscillates at all.
    """
    mass, stiffness = motion.mass, motion.stiffness
    squares, shapes = eigh((stiffness + stiffness.T) / 2, (mass + mass.T) / 2)
    count, n = len(motion.states), len(mass)
    tau = motion.period * np.arange(count) / count
    periodic = motion.states * np.exp(-motion.exponent * tau)[:, None]
    harmonic = np.round(np.fft.fftfreq(count) * count).astype(int)
    frequency = motion.exponent.imag + harmonic * 2 * np.pi / motion.period
    place, rate = periodic[:, :n] @ mass @ shapes, periodic[:, n:] @ mass @ shapes
    modal = np.fft.fft(place, axis=0) / count
    action = frequency[:, None] * np.abs(modal) ** 2
    ahead, back = np.maximum(action, 0), np.maximum(-action, 0)
    forward, backward = ahead.sum(0), back.sum(0)
    if not (forward.sum() > 0 and backward.sum() > 0):
        return None
    held = _over_frequency(squares, (np.abs(rate) ** 2).mean(0) + squares * (np.abs(place) ** 2).mean(0))
    if not held.sum() > 0:
        return None
    first, second = ahead[:, forward.argmax()].argmax(), back[:, backward.argmax()].argmax()
    excitation = int(harmonic[first] - harmonic[second]) / turns
    return ModeContent(forward / forward.sum(), backward / backward.sum(), excitation, held / held.sum())


def _over_frequency(squares: Array, energy: Array) -> Array:
    """Energies over ω; 0 for a turn of the whole line, which has no frequency."""
    elastic = squares > RIGID * squares.max()
    return np.where(elastic, energy / np.sqrt(np.where(elastic, squares, 1.0)), 0.0)


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
