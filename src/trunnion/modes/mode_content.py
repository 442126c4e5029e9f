"""Which modes take part in the growth of a Floquet mode, and the resonance that they name.

A growing disturbance r(τ) and its adjoint l(τ), right and left vector of one multiplier carried over the period, keep
l·r = 1. Written in the places and rates of the modes of the mean M and K, every mode takes part in the growth by the
mean of its own l·r over the period: the parts add up to 1, and are how far the growth falls where that mode alone is
damped. What is merely shaken beside its own frequency has none. With

    r = e^{μτ} Σ_h R_h e^{ihbτ},   l = e^{−μτ} Σ_h L_h e^{−ihbτ},   part = Σ_h L_h R_h

each part falls to the frequencies f_h = Im μ + hb. In a parametric resonance ω_i + ω_j = νΩ mode i takes part at a
frequency f > 0 and mode j at one f′ < 0, half each without damping, and f − f′ = ν is the exciting frequency exactly,
whatever the angles of the joints have made of ω_i and ω_j. What takes part at f = 0 is pushed aside without
oscillating: a divergence.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from scipy.linalg import eig, eigh

from trunnion.arrays import Array, Complex
from trunnion.modes.resonance_speeds import Resonance, Source

LEAST = 0.02
"""Part that the lesser of two modes must take for a name. Damping can make a line unstable far beside a sum where one
of the two modes takes nearly all part."""
HIGHEST_ORDER, HIGHEST_MIXED = 16, 4
"""Multiples of one excitation, and of several together, that a name may hold."""
FARTHEST = 0.75
"""Logarithm of a resonance's speed over the line's beyond which it names no growth: at 45° tongues are that wide."""


@dataclass(frozen=True)
class ModeMotion:
    """One Floquet mode and its adjoint over a period, and what they are judged by.

    right, left (samples, 2n): states x and dx/dτ and the rows that go with them, at equal distances of the input's
    angle from 0 on, the end left out; ``exponent`` is ln σ over ``period`` [rad]; mass and stiffness (n, n) are the
    means M and K over the period, in any common unit.
    """

    right: Complex
    left: Complex
    exponent: complex
    period: float
    mass: Array
    stiffness: Array


@dataclass(frozen=True)
class ModeContent:
    """Parts that the modes take in a growth, as shares of the sum of all absolute values.

    forward, backward, still (mode,): at frequencies above, below and at 0; whole (mode,): over all frequencies, where
    what a mode gains at one it may lose at another; excitation: f − f′ of the leading ones, the exciting frequency per
    turn of the input.
    """

    forward: Array
    backward: Array
    still: Array
    whole: Array
    excitation: Fraction

    @property
    def pair(self) -> tuple[int, int] | None:
        """The two modes of a resonance, numbered from 0 and ascending; None where the content is mixed."""
        i, j = int(self.forward.argmax()), int(self.backward.argmax())
        taken = (self.forward[i], self.backward[j])
        clear = min(taken) >= LEAST and self.excitation > 0 and self._leads(i, j)
        return (min(i, j), max(i, j)) if clear else None

    @property
    def diverging(self) -> int | None:
        """The mode, numbered from 0, that is pushed aside without oscillating; None where that is not what grows."""
        i, j, k = int(self.forward.argmax()), int(self.backward.argmax()), int(self.still.argmax())
        taken = (self.forward[i], self.backward[j])
        oscillating = sum(taken) if i == j else 2 * min(taken)  # two modes swing together by as much as the lesser
        return k if self.still[k] > oscillating and self._leads(k, k) else None

    def _leads(self, i: int, j: int) -> bool:
        """Whether no other mode takes more part."""
        return bool(min(self.whole[i], self.whole[j]) >= np.delete(self.whole, [i, j]).max(initial=0.0))


def floquet_pair(monodromy: Array, multiplier: complex) -> tuple[Complex, Complex] | None:
    """Right vector at the start and left vector at the end of the period of the multiplier nearest to ``multiplier``,
    so that l·r = 1 all along; None where the multiplier is double and both are orthogonal."""
    values, lefts, rights = eig(monodromy, left=True, right=True)
    place = int(np.argmin(np.abs(values - multiplier)))
    right, left = rights[:, place], lefts[:, place].conj()
    product = complex(left @ right)
    return None if abs(product) < 1e-12 else (right.astype(complex), left / (product * values[place]))


def mode_content(motion: ModeMotion, turns: Fraction) -> ModeContent:
    """Content of a Floquet mode of period ``turns`` of the input; modes are those of the mean M and K."""
    mass, stiffness = motion.mass, motion.stiffness
    shapes = eigh((stiffness + stiffness.T) / 2, (mass + mass.T) / 2)[1]
    count, n = len(motion.right), len(mass)
    tau = motion.period * np.arange(count) / count
    growth = np.exp(motion.exponent * tau)[:, None]
    right, left = motion.right / growth, motion.left * growth
    parts = sum(
        np.fft.ifft(left[:, of] @ shapes, axis=0) * np.fft.fft(right[:, of] @ mass @ shapes, axis=0) / count
        for of in (slice(0, n), slice(n, None))
    )
    harmonic = np.round(np.fft.fftfreq(count) * count).astype(int)
    frequency = motion.exponent.imag + harmonic * 2 * np.pi / motion.period
    size = np.abs(parts) / np.abs(parts).sum()
    ahead, back = (np.where(side * frequency[:, None] > 0, size, 0.0) for side in (1, -1))
    forward, backward = ahead.sum(0), back.sum(0)
    first, second = ahead[:, forward.argmax()].argmax(), back[:, backward.argmax()].argmax()
    whole = np.abs(np.asarray(parts).sum(0).real)
    return ModeContent(
        forward,
        backward,
        size.sum(0) - forward - backward,
        whole / whole.sum(),
        int(harmonic[first] - harmonic[second]) / turns,
    )


def named_resonance(
    content: ModeContent, frequency: Array, sources: tuple[Source, ...], turns: Fraction, farthest: float
) -> Resonance | None:
    """The resonance of a content, or None where it is mixed or no excitation of low order has its frequency.

    ``frequency`` are those of the straight line over the input speed, so that speed 1 is where the line runs; a name
    farther than ``farthest`` in the logarithm of the speed is none. A divergence has no speed of its own (nan).
    """
    aside = content.diverging
    if aside is not None:
        return Resonance(float("nan"), "divergence", (aside + 1,), 0)
    pair = content.pair
    if pair is None:
        return None
    i, j = pair
    nu = content.excitation
    multiple, source = excited(nu, sources)
    if source is None or not min(frequency[i], frequency[j]) > 0:
        return None
    speed = float(frequency[i] + frequency[j]) / float(nu)
    if abs(np.log(speed)) > farthest:
        return None
    if i != j:
        return Resonance(speed, "sum", (i + 1, j + 1), multiple, source.rate, source.mesh)
    kind = "subharmonic" if multiple % 2 else "harmonic"
    return Resonance(speed, kind, (i + 1,), (multiple + 1) // 2, source.rate, source.mesh)


def excited(nu: Fraction, sources: tuple[Source, ...]) -> tuple[int, Source | None]:
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
