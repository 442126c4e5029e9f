"""How far a run whose speed changes is off the steady response, which is what a measurement is compared with.

An order n of the speed Ω(t), Ω′ = α, has the frequency ν = nΩ. Of a response h(s) to a force F e^{iψ}, ψ′ = ν, the
phase of the past is ψ(t − s) = ψ − νs + nα s²/2, and so, F changing slowly, to first order in α

    Y = ∫ h(s) e^{−iνs + inαs²/2} ds F = G − iα/(2n) d²G/dΩ² + …,        G = H(nΩ) F.

At the top of a mode of decay d (half width of its resonance in ν) that is nα/d² of G: a run has to stay in a resonance
for several times that its motion takes to die out.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.arrays import Array
from trunnion.measured.predicted import PredictedChannels
from trunnion.results.finding import Finding, Gravity
from trunnion.results.units import figures

STEP = 1e-4
"""Of the speed, between the points of the second derivative: a tenth of a resonance of damping 0.1 %."""
TELLS = 0.02
"""Share of an amplitude from which the difference is said."""


def share_of_lag(channels: PredictedChannels, peak_speed: Array, row: Array) -> Array:
    """|Y − G| over |G| (order, channel) of a line by its packed numbers ``row`` (column,), where G is largest between
    the lowest and the highest speed: at ``peak_speed`` (order, channel) [rad/s]."""
    data, low, high = channels.data, float(channels.data.speed.min()), float(channels.data.speed.max())
    if data.acceleration == 0 or low == high:
        return np.zeros(peak_speed.shape)
    speed, place = np.unique(peak_speed, return_inverse=True)
    step = np.minimum(STEP * speed, (high - low) / 4)
    # Not beyond the speeds of the run: what is stated over the speed may end there.
    middle = np.clip(speed, low + step, high - step)
    table = np.tile(row, (3 * len(speed), 1))
    table[:, 0] = np.concatenate([middle - step, middle, middle + step])
    before, here, behind = np.split(channels.at(table), 3)
    bend = (behind - 2 * here + before) / (step**2)[:, None, None]
    at = (place.reshape(peak_speed.shape), *np.indices(peak_speed.shape))
    turns = data.order != 0
    half = np.where(turns, 0.5 / np.where(turns, np.abs(data.order), 1.0), 0.0)[:, None]
    size = np.abs(here[at])
    # Where nothing is damped its top has no height, and nothing to be off.
    known = (size > 0) & np.isfinite(size) & np.isfinite(bend[at])
    off = np.abs(data.acceleration * np.where(known, bend[at], 0.0)) * half
    return np.asarray(np.divide(off, size, out=np.zeros(peak_speed.shape), where=known))


def swept_too_fast(channels: PredictedChannels, share: Array) -> Iterator[Finding]:
    """What to know of a run that passes a resonance faster than its motion settles; ``share`` (order, channel)."""
    if share.max(initial=0.0) < TELLS:
        return
    o, c = np.unravel_index(int(share.argmax()), share.shape)
    worst, name = float(share[o, c]), channels.data.channels[channels.columns[c]]
    yield Finding(
        Gravity.CAUTION,
        f"At this acceleration a line does not settle: order {channels.data.order[o]:g} of {name} is off the steady "
        f"response, which is what is compared, by about {figures(100 * worst, 2)} % at its peak, and resonances seem "
        f"to come later; run up {figures(worst / TELLS, 2)} times as slowly for {100 * TELLS:g} %.",
    )
