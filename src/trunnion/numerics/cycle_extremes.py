"""Smallest and largest value of sums of harmonics over their common period.

f(x) = Re Σ_k a_k e^{ikx} is sampled SAMPLES times per cycle of its highest harmonic. Between two samples f cannot rise
above the higher of them by more than ½ (h/2)² Σ k²|a_k|, h their distance. Samples that are at least their neighbours
and within that of the highest are candidates; a parabola through each and its neighbours, good to 2e-4 of the highest
harmonics' amplitudes, ranks them, and the STARTS best are followed to their peaks by Newton's method on f′.
"""

from __future__ import annotations

from math import ceil, log2, sqrt

import numpy as np

from trunnion.arrays import Array, Complex, Integers, Places

SAMPLES = 16
NEWTON_STEPS, SETTLED = 12, 1e-6
"""Steps at most, as a flat top takes many, and the share of the samples' distance by which a settled one moves."""
PARABOLA = 4e-4
"""More than twice the error of a parabola's top, over the sum of amplitudes."""
MOST_SAMPLES = 1 << 16
"""Held at a time, as many as a processor keeps near."""
SHARE = 1e-14
"""Harmonics of less than this share of a row's sum of amplitudes are rounding and set no sampling rate."""


def cycle_extremes(index: Integers, amplitude: Complex) -> tuple[Array, Array]:
    """Lowest and highest value (row,) of each row of ``amplitude`` (row, k) with distinct harmonics ``index`` (k,) ≥ 0.

    Accurate to rounding; NaN rows stay NaN.
    """
    good = np.all(np.isfinite(amplitude), axis=1)
    low, high = np.where(good, 0.0, np.nan), np.where(good, 0.0, np.nan)
    sizes = np.abs(amplitude[good])
    kept = np.any(sizes > SHARE * sizes.sum(axis=1, keepdims=True), axis=0)
    index, parts = index[kept], amplitude[good][:, kept]
    if not len(index):
        return low, high
    index = index // max(1, int(np.gcd.reduce(index)))  # one of the equal cycles
    rows = max(1, MOST_SAMPLES // (SAMPLES * max(1, int(index.max()))))
    found = [_both(index, parts[i : i + rows]) for i in range(0, len(parts), rows)]
    low[good] = np.concatenate([pair[0] for pair in found])
    high[good] = np.concatenate([pair[1] for pair in found])
    return low, high


def _both(index: Integers, amplitude: Complex) -> tuple[Array, Array]:
    top = int(index.max())
    if top == 0:
        level = amplitude.real.sum(axis=1)
        return level, level
    count = _fast_length(SAMPLES * top)
    spectrum = np.zeros((len(amplitude), count // 2 + 1), dtype=complex)
    spectrum[:, index] = amplitude
    spectrum[:, 1:] /= 2
    spectrum[:, 0] = spectrum[:, 0].real
    f = np.fft.irfft(spectrum, count, norm="forward")
    return -_highest(index, -amplitude, -f), _highest(index, amplitude, f)


def _fast_length(least: int) -> int:
    """The smallest even number with no other factors than 2, 3 and 5 that is not below ``least``."""
    powers = (2 * 3**b * 5**c for b in range(7) for c in range(5))
    return min(odd << max(0, ceil(log2(least / odd))) for odd in powers)


def _highest(index: Integers, amplitude: Complex, f: Array) -> Array:
    """Largest value (row,) of sums sampled as ``f`` (row, sample)."""
    step = 2 * np.pi / f.shape[1]
    sizes = np.abs(amplitude)
    highest = f.max(axis=1)
    above = (step / 2) ** 2 / 2 * (index**2 * sizes).sum(axis=1)
    least = np.where(above > 0, highest - above, np.inf)
    row, place = np.divmod(np.flatnonzero(f >= least[:, None]), f.shape[1])
    here, before, behind = f[row, place], f[row, place - 1], f[row, (place + 1) % f.shape[1]]
    peak = (here >= before) & (here >= behind)
    row, place, here, before, behind = (part[peak] for part in (row, place, here, before, behind))
    bend = before - 2 * here + behind
    slope = behind - before
    curved = bend < 0
    rise = np.divide(slope**2, -8 * bend, out=np.zeros_like(bend), where=curved)
    shift = np.divide(-slope, 2 * bend, out=np.zeros_like(bend), where=curved)
    chosen = _best(row, here + rise, PARABOLA * sizes.sum(axis=1))
    row, x = row[chosen], (place + shift)[chosen] * step
    a = amplitude[row]
    first, second = -index.astype(float), -(index.astype(float) ** 2)
    moving = np.arange(len(x))
    for _ in range(NEWTON_STEPS):
        wave = a[moving] * _waves(index, x[moving])
        rate, curve = wave.imag @ first, wave.real @ second
        # Between two tops that stand closer than samples: up to one of them first.
        move = np.divide(-rate, curve, out=np.copysign(step / 4, rate), where=curve < 0)
        x[moving] += np.clip(move, -step, step)
        moving = moving[np.abs(move) > SETTLED * step]
        if not len(moving):
            break
    np.maximum.at(highest, row, (a * _waves(index, x)).real.sum(axis=1))
    return np.asarray(highest)


def _waves(index: Integers, x: Array) -> Complex:
    """e^{ikx} (x, k), each the product of one of the first √K and one of every √K-th."""
    wide = ceil(sqrt(int(index.max()) + 1))
    begun = np.exp(1j * np.arange(wide) * x[:, None])
    leaps = np.exp(1j * wide * np.arange(int(index.max()) // wide + 1) * x[:, None])
    return np.asarray(begun[:, index % wide] * leaps[:, index // wide])


def _best(row: Places, value: Array, within: Array) -> Places:
    """Places of the values that are ``within`` (row,) of the highest of their row."""
    highest = np.full(len(within), -np.inf)
    np.maximum.at(highest, row, value)
    return np.flatnonzero(value >= highest[row] - within[row])
