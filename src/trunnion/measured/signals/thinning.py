"""Sampled signals at fewer samples: what would fold back is filtered away first."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np
from scipy.signal import firwin, kaiser_beta, upfirdn

from trunnion.arrays import Array
from trunnion.measured.signals.measurement import SampledSignal

HALF_TAPS, STOPPED = 9, 125.0
"""Half the length of the filter before samples are left out, in samples that stay, and its damping [dB]."""


def _filter(factor: int) -> Array:
    return np.asarray(firwin(2 * HALF_TAPS * factor + 1, 1.0 / factor, window=("kaiser", kaiser_beta(STOPPED))))


def thinned(signal: SampledSignal, rate: float) -> SampledSignal:
    """The same at fewer samples, ``rate`` a second at least [Hz], what would fold back filtered away.

    Up to a quarter of the new rate it passes to 1e-6; what folds back onto that is damped as far. The ends, which the
    filter does not see whole, are cut.
    """
    factor = int(signal.rate // rate)
    if factor < 2 or len(signal.values) < 4 * HALF_TAPS * factor:
        return signal
    values = np.concatenate(list(thinned_chunks([np.asarray(signal.values, dtype=float)], factor)))
    start = signal.start + HALF_TAPS * factor / signal.rate
    return replace(signal, values=values, rate=signal.rate / factor, start=start)


def thinned_chunks(chunks: Iterable[Array], factor: int) -> Iterator[Array]:
    """Every ``factor``-th sample of a signal that comes in chunks (sample,), filtered; of little memory.

    The first of them is of the moment ``HALF_TAPS * factor`` samples behind the first that came.
    """
    taps, held = _filter(factor), np.zeros(0)
    for chunk in chunks:
        held = np.concatenate([held, chunk]) if len(held) else chunk
        count = (len(held) - 1) // factor + 1
        if count <= 2 * HALF_TAPS:
            continue
        yield np.asarray(upfirdn(taps, held, 1, factor)[2 * HALF_TAPS : count])
        held = held[(count - 2 * HALF_TAPS) * factor :]
