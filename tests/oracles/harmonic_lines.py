"""Straight lines shaken by one harmonic torque, and what it makes of them in closed form.

The harmonic goes by turns, in time, or by both; its amplitude is constant, by the square of the speed, or from a table;
its disk stands behind the shaft, behind a gear that reverses it, or in front of the shaft of a free–free line.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import trunnion as tn

STIFFNESS, DAMPING = 2e4, 30.0
NEAR, FAR = 0.2, 0.1
"""Inertias [kg m²]."""
REVERSED = -2.0
"""Speed of the disk behind the gear over that of the input."""
PHASE, DRIVES = 0.4, 5.0
ANGLES = {
    "by turns": {"order": 1.5},
    "in time": {"frequency": 170.0},
    "by both": {"order": 1.0, "frequency": 90.0},
    "by both, against each other": {"order": -2.0, "frequency": 500.0},
}
STRUCTURES = ("driven", "geared", "free")
TABLE: dict[str, Any] = {"amplitudes": (0.03, 0.05, 0.02), "phases": (0.0, 0.9, -0.5)}


def tabled(points: tuple[float, ...], at: Any) -> Any:
    """A e^{iφ} of ``TABLE``, linear between its points."""
    values = np.array(TABLE["amplitudes"]) * np.exp(1j * np.array(TABLE["phases"]))
    return np.interp(at, points, values.real) + 1j * np.interp(at, points, values.imag)


AMPLITUDES: dict[str, tuple[dict[str, Any], Callable[[Any, float], Any]]] = {
    "constant": ({"amplitude": 0.05}, lambda speed, drives: 0.05 + 0j * speed),
    "by the square of the speed": ({"quadratic_amplitude": 4e-6}, lambda speed, drives: 4e-6 * speed**2 + 0j),
    "by the share of the mean torque": (
        {"share": 0.01},
        lambda speed, drives: 0.01 * np.full(np.shape(speed), drives) + 0j,
    ),
    "over the speed": (
        {"speeds": (10.0, 120.0, 700.0), **TABLE},
        lambda speed, drives: tabled((10.0, 120.0, 700.0), speed),
    ),
    "over the torque": (
        {"torques": (0.0, 4.0, 20.0), **TABLE},
        lambda speed, drives: tabled((0.0, 4.0, 20.0), np.full(np.shape(speed), drives)),
    ),
}
"""How a description states an amplitude, and what it is by the disk's speed [rad/s] and the mean torque that it drives
with [N m]."""


BY_TORQUE = ("over the torque", "by the share of the mean torque")


@dataclass(frozen=True)
class Shaken:
    """One line and its harmonic, by the keys of the tables above."""

    by: str = "by both"
    structure: str = "driven"
    law: str = "constant"
    cylinders: tuple[float, ...] = ()
    damping: float = DAMPING
    inertia: float = NEAR
    frequency: float = 0.0
    """In place of that of ``by`` [rad/s], where it is not 0."""

    @property
    def order(self) -> float:
        """Cycles per turn of the disk."""
        return ANGLES[self.by].get("order", 0.0)

    @property
    def in_time(self) -> float:
        """Frequency beside them [rad/s]."""
        return self.frequency or ANGLES[self.by].get("frequency", 0.0)

    @property
    def excitation(self) -> dict[str, Any]:
        """As a description states it."""
        angle = {key: value for key, value in (("order", self.order), ("frequency", self.in_time)) if value}
        return {**angle, **AMPLITUDES[self.law][0], "phase": PHASE}

    def line(self, **more: Any) -> tn.Driveline:
        """With a shaft "shaft" and a disk "shaken"."""
        disk: dict[str, Any] = {"name": "shaken", "excitation": [self.excitation]}
        disk |= {"firing_angles": self.cylinders} if self.cylinders else {}
        disk |= {"load_torque": -self.drives} if self.drives else {}
        shaft = tn.Shaft(stiffness=STIFFNESS, damping=self.damping, name="shaft")
        elements = {
            "driven": [tn.ConstantSpeed(), shaft, tn.Disk(inertia=self.inertia, **disk)],
            "geared": [
                tn.ConstantSpeed(), shaft, tn.Disk(inertia=self.inertia, name="gear"), tn.Ratio(ratio=1 / REVERSED),
                tn.Disk(inertia=FAR, **disk),
            ],
            "free": [tn.Disk(inertia=self.inertia, drive_share=1.0, **disk), shaft, tn.Disk(inertia=FAR)],
        }  # fmt: skip
        return tn.Driveline(elements[self.structure], **more)

    @property
    def ratio(self) -> float:
        """Speed of the disk over the input's."""
        return REVERSED if self.structure == "geared" else 1.0

    def turning(self, speed: Any) -> Any:
        """k|R|Ω + ν [rad/s]."""
        return self.order * abs(self.ratio) * np.asarray(speed) + self.in_time

    def amplitude(self, speed: Any) -> Any:
        """Complex amplitude of the torque [N m] at input speeds, in the sense of the disk's rotation."""
        size = AMPLITUDES[self.law][1](abs(self.ratio) * np.asarray(speed, dtype=float), self.drives)
        fired = sum(np.exp(-1j * self.order * a) for a in self.cylinders) if self.cylinders else 1.0
        return size * np.exp(1j * PHASE) * fired

    @property
    def drives(self) -> float:
        """Mean torque [N m] that the disk drives with."""
        return DRIVES if self.law in BY_TORQUE else 0.0

    @property
    def ahead(self) -> float:
        """Mean twist of the shaft [rad], by which the disk is ahead of where rigid shafts would hold it."""
        return abs(self.ratio) * self.drives / STIFFNESS

    @property
    def moved(self) -> float:
        """Inertia [kg m²] on the shaft's far end, the near one held."""
        return self.inertia + (FAR * REVERSED**2 if self.structure == "geared" else 0.0)

    def twist(self, speed: Any) -> Any:
        """Complex amplitude of the shaft's twist [rad] at input speeds, of Re[… e^{i turning() t}]."""
        w, push = self.turning(speed), self.amplitude(speed) * abs(self.ratio)
        push = push * np.exp(1j * self.order * abs(self.ratio) * self.ahead)
        spring = STIFFNESS + 1j * w * self.damping
        if self.structure != "free":
            return push / (spring - w**2 * self.moved)
        # Of the two equations −w²J₁y₁ − f = T and −w²J₂y₂ + f = 0 with f = spring (y₂ − y₁).
        return -push / self.inertia / (spring * (1 / self.inertia + 1 / FAR) - w**2)

    def torque(self, speed: Any) -> Any:
        """Complex amplitude of the shaft's torque [N m]."""
        return (STIFFNESS + 1j * self.turning(speed) * self.damping) * self.twist(speed)

    def start(self, speed: float) -> Any:
        """Rotations [rad] and rates of the disks of a free line at t = 0, at which it swings steadily."""
        w = self.turning(speed)
        far = self.torque(speed) / (w**2 * FAR)
        rotations = np.array([far - self.twist(speed), far])
        return np.concatenate([rotations.real, (1j * w * rotations).real])

    def swing(self, speed: Any) -> Any:
        """Half of the peak-to-peak torque [N m]."""
        return np.abs(self.torque(speed))

    @property
    def mode(self) -> complex:
        """Eigenvalue λ [1/s] of the line, Im λ > 0."""
        over = 1 / self.inertia + 1 / FAR if self.structure == "free" else 1 / self.moved
        half = self.damping * over / 2
        return complex(-half, np.sqrt(STIFFNESS * over - half**2))

    def meetings(self, low: float, high: float) -> list[float]:
        """Input speeds within a range at which |k|R|Ω + ν| is the damped frequency of the mode."""
        if not self.order:
            return []
        found = ((sign * self.mode.imag - self.in_time) / (self.order * abs(self.ratio)) for sign in (1, -1))
        return sorted(speed for speed in found if low < speed < high)

    def motion(self, time: Any, angle: Any, speed: Any, acceleration: float, start: Any) -> Any:
        """Rotation of the unknown of a driven or geared line [rad] and its rate (2, time) along a course of the input,
        by equations of its own: the torque follows the deviation of its disk."""

        def rate(t: float, x: Any) -> list[float]:
            size = complex(self.amplitude(speed(t)))
            turned = self.order * abs(self.ratio) * (angle(t) + x[0]) + self.in_time * t
            push = abs(self.ratio) * ((size * np.exp(1j * turned)).real + self.drives)
            driven = self.moved * acceleration
            return [x[1], (push - STIFFNESS * x[0] - self.damping * x[1] - driven) / self.moved]

        found = solve_ivp(rate, (time[0], time[-1]), start, t_eval=time, rtol=1e-11, atol=1e-14, method="DOP853")
        return found.y
