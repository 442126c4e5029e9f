"""A motion as plain data: bodies in space, and frames of what turns and colours them. The player reads nothing else."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from trunnion.animation.movement import Movement
from trunnion.animation.movements import GROWN
from trunnion.animation.scenery import DrawnPart
from trunnion.arrays import Array, Complex

FORMAT = 1
"""Of the scene."""
FIGURES = 7
"""Of the largest value of a series, and decimals of lengths."""
LONGEST_WATCH = 60.0
"""Seconds that a disturbance takes at most to watch."""


@dataclass(frozen=True)
class ShownMotion:
    """One of an animation's motions: the bodies, and one movement of them or two below each other."""

    title: str
    parts: tuple[DrawnPart, ...]
    movements: tuple[Movement, ...]


def choice(title: str, parts: Sequence[DrawnPart], movements: Sequence[Movement]) -> dict[str, Any]:
    """One motion, or two below each other that share their time, of the bodies ``parts``."""
    span = _span(movements)
    return {
        "title": title,
        "parts": [_part(one) for one in parts],
        "movements": [_movement(m, span) for m in movements],
    }


def _span(movements: Sequence[Movement]) -> float | None:
    """How long disturbances are followed [s]: until the fastest has grown, or decayed, by ``GROWN``."""
    rates = [abs(one.growth.real) for one in movements if one.growth is not None and one.growth.real]
    return float(np.log(GROWN) / max(rates)) if rates else None


def _part(part: DrawnPart) -> dict[str, Any]:
    found: dict[str, Any] = {
        "element": part.element, "name": part.name, "shape": part.shape, "at": _numbers(part.at),
        "axes": _axes(part.frame), "stations": list(part.stations), "turned": _numbers(np.array(part.turned)),
        "spring": part.spring, "size": {key: round(float(value), FIGURES) for key, value in part.size.items()},
    }  # fmt: skip
    if part.stress:
        found["stress"] = float(f"{part.stress:.6g}")
    if part.far is not None:
        found["far"] = _numbers(part.far)
    if part.back is not None:
        found["back"] = _axes(part.back)
    return found


def _axes(frame: Array) -> dict[str, Any]:
    """Axis, direction that angle 0 points to, and the sense of rotation about the axis."""
    e, u, v = frame
    return {"e": _numbers(e), "u": _numbers(u), "sense": 1 if np.linalg.det(np.stack([e, u, v])) > 0 else -1}


def _movement(one: Movement, span: float | None) -> dict[str, Any]:
    length = float(one.time[-1] - one.time[0])
    slow = one.slow
    followed = length
    if one.growth is not None and span is not None:
        followed = span
        slow = min(slow, LONGEST_WATCH / span)
    elif one.growth is not None:
        followed = 10 * length
    return {
        "title": one.title, "said": one.said, "short": one.said.split(": ")[0].split(". ")[0], "notes": list(one.notes),
        "start": float(one.time[0]), "end": float(one.time[-1]), "frames": len(one.time), "repeats": one.repeats,
        "growth": None if one.growth is None else [one.growth.real, one.growth.imag], "span": followed,
        "arbitrary": one.arbitrary, "factor": one.factor, "slow": float(slow), "springs": one.torque.shape[1],
        "most": float(f"{np.abs(one.torque).max(initial=0.0):.3g}"), "unit": "N m a rad" if one.arbitrary else "N m",
        "rigid": _series(one.rigid), "deviation": _moving(one.deviation), "torque": _moving(one.torque),
    }  # fmt: skip


def _moving(part: Array | Complex) -> Any:
    if np.iscomplexobj(part):
        return {"re": _series(part.real), "im": _series(part.imag)}
    return _series(part.real)


def _series(columns: Array) -> list[Any]:
    """Of every column its values over time, or one number where it stays; no more digits than are seen."""
    found: list[Any] = []
    for column in columns.T:
        size = float(np.abs(column).max(initial=0.0))
        figures = FIGURES if size == 0 else FIGURES - 1 - int(np.floor(np.log10(size)))
        rounded = np.round(column, min(max(figures, 0), 15))
        found.append(float(rounded[0]) if np.all(rounded == rounded[0]) else rounded.tolist())
    return found


def _numbers(values: Array) -> list[float]:
    return [float(one) + 0.0 for one in np.round(np.asarray(values, dtype=float), FIGURES)]
