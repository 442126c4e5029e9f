"""Edges of a sampled pulse signal, chunk by chunk: hysteresis against noise, times between samples."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from trunnion.arrays import Array, Flags, Places
from trunnion.errors import InputError

HYSTERESIS = 0.15
"""Share of the swing on either side of the level that an edge has to pass."""
KEPT = 256
"""Samples of the chunk before in which the level may have been crossed."""


def levels(first: Array, level: float | None, name: str) -> tuple[float, float, float]:
    """Level of the edges, and the values on either side that arm and fire: from the first chunk (sample,).

    Raises
    ------
    InputError : the signal does not move, or never crosses the level.
    """
    low, high = (float(one) for one in np.percentile(first, (1, 99)))
    if not high > low:
        low, high = float(first.min()), float(first.max())
    if not high > low:
        raise InputError("does not move: there are no pulses", element=name, key="column", remedy="name another column")
    middle = (low + high) / 2 if level is None else level
    if not low < middle < high:
        raise InputError(
            f"is outside the signal, which lies between {low:.4g} and {high:.4g}", element=name, key="level",
            value=level, remedy="leave it out: the middle is taken",
        )  # fmt: skip
    reach = HYSTERESIS * (high - low)
    return middle, middle - min(reach, (middle - low) / 2), middle + min(reach, (high - middle) / 2)


def rising_edges(chunks: Iterable[Array], rate: float, level: float | None, name: str, *, falling: bool) -> Array:
    """Times [s] of rising edges, or ``falling`` ones, from the first sample on.

    chunks : of a signal (sample,), one after another.

    Raises
    ------
    InputError : no number among the samples; as of ``levels``.
    """
    sign = -1.0 if falling else 1.0
    found: list[Array] = []
    known: tuple[float, float, float] | None = None
    tail, done, armed = np.zeros(0), 0, False
    for chunk in chunks:
        samples = sign * np.asarray(chunk, dtype=float) if falling else np.asarray(chunk)
        if not np.isfinite(samples[:: max(1, len(samples) // 4096)]).all() or not np.isfinite(samples.sum()):
            at = (done + int(np.argmax(~np.isfinite(samples)))) / rate
            raise InputError(
                f"has samples that are not numbers, the first at {at:.6g} s", element=name, key="column",
                remedy="cut the gap out, or read the parts on either side",
            )  # fmt: skip
        if known is None:
            known = levels(samples, None if level is None else sign * level, name)
        whole = np.concatenate([tail, samples]) if len(tail) else samples
        times, armed = _of_chunk(whole, known, len(tail), armed)
        found.append((times + done - len(tail)) / rate)
        tail, done = whole[-KEPT:], done + len(samples)
    return np.concatenate(found) if found else np.zeros(0)


def _of_chunk(x: Array, known: tuple[float, float, float], old: int, armed: bool) -> tuple[Array, bool]:
    """Places of edges among samples ``x``, ``old`` of them looked at before, and whether the next one is armed."""
    level, low, high = known
    begin = max(old - 1, 0)
    above, below = x[begin:] > high, x[begin:] < low
    up = np.flatnonzero(above[1:] & ~above[:-1]) + begin + 1
    down = np.flatnonzero(below[1:] & ~below[:-1]) + begin + 1
    if not old and below[0]:
        armed = True
    fires = _fires(up, down, armed)
    events = max((int(up[-1]) if len(up) else -1, 0), (int(down[-1]) if len(down) else -1, 1))
    if events[0] >= 0:
        armed = bool(events[1])
    at = up[fires] - 1
    while len(at):  # back to the sample before the level was crossed
        still = (at > 0) & (x[at] > level)
        if not still.any():
            break
        at = at - still
    return at + _crossing(x, at, level), armed


def _crossing(x: Array, at: Places, level: float) -> Array:
    """How far behind the samples ``at`` a signal comes to ``level``, from 0 to 1: by cubics through four samples."""
    near = np.clip(at[:, None] + np.arange(-1, 3), 0, len(x) - 1)
    a, b, c, d = (x[near] - level).astype(float).T
    straight = np.clip(-b / np.where(c > b, c - b, np.inf), 0.0, 1.0)
    cubic, square = (d - 3 * c + 3 * b - a) / 6, (a - 2 * b + c) / 2
    slope, share = c - a / 3 - b / 2 - d / 6, straight
    for _ in range(4):
        value, rise = (
            b + share * (slope + share * (square + share * cubic)),
            slope + share * (2 * square + share * 3 * cubic),
        )
        share = share - np.divide(value, rise, out=np.zeros(len(at)), where=rise > 0)
    sound = np.isfinite(share) & (share >= 0) & (share <= 1) & (at > 0) & (at + 2 < len(x))
    return np.where(sound, share, straight)


def _fires(up: Places, down: Places, armed: bool) -> Flags:
    """Which of the events ``up`` come first after one of ``down``."""
    before = np.searchsorted(down, up)
    fresh = np.diff(before, prepend=0) > 0
    if len(up) and before[0] == 0:
        fresh[0] = armed
    return fresh
