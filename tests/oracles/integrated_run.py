"""Trees of disks, shafts, gears and Hooke's joints on a run, by equations written here alone and Runge–Kutta steps.

Disk i turns by a_i. Its shaft begins at n_i(a_p), p the disk in front: behind a joint of angle β, whose input fork
stands at χ = a_p + offset from the joint's plane, the output turns by a_p + arctan(sin χ cos χ (1 − c)/(c cos² χ +
sin² χ)), c = cos β, and behind a ratio by so many times less. With r = n_i′ and f = k (a_i − n_i) + c (ȧ_i − r ȧ_p)

    J_i ä_i = −f_i + Σ_behind r f − load_i + A cos(m a_i + phase) (+ what drives, on disk 0).

A driven line has a_0 = ωt + αt²/2. A free one is driven by its mean loads and α Σ J R²: resonances take some of that,
so its torque is corrected, turn by turn, until its mean speed rises evenly.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from math import atan2, cos, sin
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ROUNDS, CELL, WIDTH = 12, 0.02, 0.1
"""Rounds of an even run, and steps and widths [s] of the correction of its torque."""


@dataclass
class IntegratedRun:
    """Motion at even times (time,): angles, speeds and accelerations of disks (time, disk), torques of their shafts."""

    time: Array
    angle: Array
    rate: Array
    acceleration: Array
    torque: Array


@dataclass
class Tree:
    """Disks one behind another; of each the disk in front, its shaft, and the joint and ratio before that."""

    driven: bool = False
    names: list[str] = field(default_factory=list)
    shafts: list[str] = field(default_factory=list)
    numbers: list[tuple[float, ...]] = field(default_factory=list)
    shaken: list[tuple[float, ...]] = field(default_factory=list)

    def disk(
        self, name: str, inertia: float, front: int = -1, shaft: str = "", stiffness: float = 0.0, damping: float = 0.0,
        angle: float = 0.0, offset: float = 0.0, ratio: float = 1.0, load: float = 0.0,
        excitation: tuple[tuple[float, float, float], ...] = (),
    ) -> int:  # fmt: skip
        """offset: of the input fork, from the joint's plane. excitation: order, amplitude and phase, by the disk's own
        rotation."""
        self.names.append(name)
        self.shafts.append(shaft)
        self.numbers.append((float(front), inertia, stiffness, damping, angle, offset, ratio, load))
        self.shaken += [(len(self.names) - 1, *one) for one in excitation]
        return len(self.names) - 1

    def ratios(self) -> Array:
        found = np.ones(len(self.names))
        for i, one in enumerate(self.numbers[1:], 1):
            found[i] = found[int(one[0])] / one[6]
        return found

    def run(
        self, speed: float, acceleration: float, duration: float, step: float, every: int, *, even: bool = False,
        compiled: bool = False,
    ) -> IntegratedRun:  # fmt: skip
        """From ``speed`` [rad/s] on, as rigid shafts turn under their mean torques, kept after ``every`` steps.

        even : correct the torque that drives a free line. compiled : by Numba, for long runs.
        """
        numbers, ratios = np.array(self.numbers), self.ratios()
        inertia, sense = numbers[:, 1], np.sign(ratios)
        load = numbers[:, 7] * sense
        drive = float((load + acceleration * inertia * ratios) @ ratios)
        behind = load + acceleration * inertia * ratios
        for i in range(len(ratios) - 1, 0, -1):
            behind[int(numbers[i, 0])] += behind[i] / numbers[i, 6]
        twist = -behind / np.where(numbers[:, 2] > 0, numbers[:, 2], np.inf)
        start = np.zeros((2, len(ratios)))
        start[1, 0] = speed
        for i in range(1, len(ratios)):
            p = int(numbers[i, 0])
            n, r = near_end(start[0, p], numbers[i, 4], numbers[i, 5], numbers[i, 6])
            start[:, i] = n + twist[i], r * start[1, p]
        shaken = np.array([
            (i, m * sense[int(i)], a * sense[int(i)], phase) for i, m, a, phase in self.shaken or [(0, 1.0, 0.0, 0.0)]
        ])  # fmt: skip
        more = np.zeros(int(duration / CELL) + 3)
        whole = float(inertia @ ratios**2)
        follow = compiled_steps() if compiled else steps
        count = int(duration / step)
        for _ in range(ROUNDS if even and not self.driven else 1):
            time, *found = follow(
                count, step, every, start, acceleration, self.driven, numbers, load, shaken, twist, drive + more
            )
            if even:
                more = more - whole * self._slowed(time, found[0][:, 0], acceleration, len(more))
        return IntegratedRun(time, *found)

    @staticmethod
    def _slowed(time: Array, angle: Array, acceleration: float, cells: int) -> Array:
        """By how much the mean speed of the first disk rises too fast (cell,) [rad/s²]."""
        marks = np.interp(np.arange(angle[0], angle[-1], 2 * np.pi), angle, time)
        middle, off = (marks[1:] + marks[:-1]) / 2, 2 * np.pi / np.diff(marks)
        off -= acceleration * middle
        near = np.exp(-0.5 * ((middle[:, None] - middle) / WIDTH) ** 2)
        smooth = [
            np.polynomial.polynomial.polyfit(middle - at, off, 1, w=np.sqrt(weight))[0]
            for at, weight in zip(middle, near, strict=True)
        ]
        return np.gradient(np.interp(CELL * np.arange(cells), middle, smooth), CELL)


def near_end(a: float, beta: float, offset: float, ratio: float) -> tuple[float, float]:
    """Where the shaft behind a joint and a ratio begins, and its speed over that of the disk in front."""
    if beta == 0.0:
        return a / ratio, 1.0 / ratio
    chi, c = a + offset, cos(beta)
    s = sin(beta)
    lead = atan2(sin(chi) * cos(chi) * (1 - c), c * cos(chi) ** 2 + sin(chi) ** 2)
    return (a + lead) / ratio, c / (1 - s * s * cos(chi) ** 2) / ratio


def steps(
    count: int, step: float, every: int, start: Array, acceleration: float, driven: bool, numbers: Array, load: Array,
    shaken: Array, twist: Array, drive: Array,
) -> Any:  # fmt: skip
    """Time, angles, rates, accelerations and torques; excitations of a driven line at the angle without vibration."""
    n, kept = len(numbers), count // every + 1
    time = np.zeros(kept)
    angles, rates, accelerations, torques = (
        np.zeros((kept, n)), np.zeros((kept, n)), np.zeros((kept, n)), np.zeros((kept, n))
    )  # fmt: skip
    a, v, b, w = start[0].copy(), start[1].copy(), np.zeros(n), np.zeros(n)
    slope_a, slope_v = np.zeros((4, n)), np.zeros((4, n))
    torque, even = np.zeros(n), np.zeros(n)
    for k in range(count + 1):
        for stage in range(4):
            part = 0.0 if stage == 0 else (1.0 if stage == 3 else 0.5)
            t = (k + part) * step
            for i in range(n):
                b[i] = a[i] + (part * step * slope_a[stage - 1, i] if stage else 0.0)
                w[i] = v[i] + (part * step * slope_v[stage - 1, i] if stage else 0.0)
            if driven:
                b[0], w[0] = start[0, 0] + start[1, 0] * t + acceleration * t * t / 2, start[1, 0] + acceleration * t
            for i in range(n):
                slope_v[stage, i] = -load[i]
                even[i] = b[i]
            cell = min(int(t / 0.02), len(drive) - 2)
            beyond = t / 0.02 - cell
            slope_v[stage, 0] += drive[cell] * (1 - beyond) + drive[cell + 1] * beyond
            for i in range(1, n):
                p = int(numbers[i, 0])
                q, r = near_end(b[p], numbers[i, 4], numbers[i, 5], numbers[i, 6])
                f = numbers[i, 2] * (b[i] - q) + numbers[i, 3] * (w[i] - r * w[p])
                slope_v[stage, i] -= f
                slope_v[stage, p] += r * f
                if driven:
                    even[i] = near_end(even[p], numbers[i, 4], numbers[i, 5], numbers[i, 6])[0] + twist[i]
                if stage == 0:
                    torque[i] = f
            for e in range(len(shaken)):
                i = int(shaken[e, 0])
                slope_v[stage, i] += shaken[e, 2] * cos(shaken[e, 1] * even[i] + shaken[e, 3])
            for i in range(n):
                slope_a[stage, i], slope_v[stage, i] = w[i], slope_v[stage, i] / numbers[i, 1]
            if driven:
                slope_v[stage, 0] = acceleration
            if stage == 0 and k % every == 0:
                row = k // every
                time[row] = t
                for i in range(n):
                    angles[row, i], rates[row, i], torques[row, i] = b[i], w[i], torque[i]
                    accelerations[row, i] = slope_v[0, i]
        for i in range(n):
            a[i] += step / 6 * (slope_a[0, i] + 2 * slope_a[1, i] + 2 * slope_a[2, i] + slope_a[3, i])
            v[i] += step / 6 * (slope_v[0, i] + 2 * slope_v[1, i] + 2 * slope_v[2, i] + slope_v[3, i])
    return time, angles, rates, accelerations, torques


@cache
def compiled_steps() -> Callable[..., Any]:
    """``steps`` by Numba."""
    import numba

    scope = dict(globals())
    scope["near_end"] = numba.njit(near_end)
    made = type(steps)(steps.__code__, scope, "steps")
    return numba.njit(made)  # type: ignore[no-any-return]
