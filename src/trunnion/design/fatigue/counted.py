"""One element under one history: its cycles and their damage."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.design.fatigue.cycles import Cycles, rainflow_cycles
from trunnion.design.fatigue.damage import damage, reversed_amplitude
from trunnion.design.fatigue.load_history import TorqueHistory
from trunnion.design.fatigue.result import CycleSpectrum
from trunnion.driveline.sn_curves import SNCurve


@dataclass(frozen=True)
class CountedHistory:
    """number: of the history; cycles in SI of the curve; rate: how often it comes [1/s]; damage (cycles,) [1/s]; error
    [1/s]: what that may be low by in all; peak: the largest value."""

    number: int
    cycles: Cycles
    rate: float
    damage: Array
    error: float
    peak: float


def counted(
    curve: SNCurve, factor: float, number: int, history: TorqueHistory, names: tuple[str, str]
) -> CountedHistory:
    """Of the element with ``names``, its own and that of its spring; ``factor``: value of the curve over torque."""
    points, left = history.of(*names), history.more.get(names[1], 0.0)
    cycles = rainflow_cycles(points.value, repeats=history.repeats).scaled(factor)
    own = damage(curve, cycles) * history.rate
    most = damage(curve, cycles, factor * (points.error + left)).sum() * history.rate
    error = float(most - own.sum()) if np.isfinite(own.sum()) else 0.0
    return CountedHistory(number, cycles, history.rate, own, error, factor * float(np.abs(points.value).max()))


def spectrum(curve: SNCurve, parts: Sequence[CountedHistory]) -> CycleSpectrum:
    """All cycles of one element."""

    def joined(columns: Sequence[Array]) -> Array:
        return np.concatenate(columns) if columns else np.zeros(0)

    amplitude, mean = (joined([getattr(one.cycles, key) for one in parts]) for key in ("amplitude", "mean"))
    return CycleSpectrum(
        amplitude=amplitude, mean=mean, reversed=reversed_amplitude(curve, amplitude, mean),
        rate=joined([one.cycles.count * one.rate for one in parts]),
        history=np.repeat([one.number for one in parts], [len(one.damage) for one in parts]).astype(np.int64),
        damage=joined([one.damage for one in parts]), curve=curve,
    )  # fmt: skip
