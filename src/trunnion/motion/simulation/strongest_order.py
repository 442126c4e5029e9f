"""What vibrates most in a stretch of a run: the order, its spring, the mode that it meets, and what excites it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from trunnion.equations.coefficients import joint_laws
from trunnion.equations.harmonics import line_harmonics
from trunnion.equations.line_system import LineSystem
from trunnion.errors import InputError
from trunnion.modes.natural_frequencies import natural_frequencies
from trunnion.motion.simulation.input_rotation import TURN, InputRotation

MOST_TURNS, PER_TURN = 16, 128
"""Turns that are looked at, the last ones of the stretch, and samples of each."""
LEAKED = 3
"""Lowest orders of a window, which its shape fills with what the mean does."""
NEAR = 0.15
"""Distance of a frequency from a mode, relative, within which it may be called that mode's: a large swing of the
rotation shifts what resonates."""


@dataclass(frozen=True)
class StrongestOrder:
    """order [cycles per turn of the input] of ``spring``, whose torque it swings by ± ``torque`` [N m], at
    ``frequency`` [rad/s]; sources: what excites it; mode and mode_frequency [rad/s]: the number of the mode near it and
    its own frequency, 0 where there is none."""

    order: float
    spring: str
    torque: float
    frequency: float
    sources: tuple[str, ...]
    mode: int = 0
    mode_frequency: float = 0.0


class ShakenRun(Protocol):
    """What is read of a run: ``LineSimulation`` or ``Transient``."""

    @property
    def line(self) -> LineSystem:
        """The line that moved."""
        ...

    @property
    def whole(self) -> InputRotation:
        """How the whole line turned."""
        ...

    @property
    def shafts(self) -> tuple[str, ...]:
        """Names of the springs."""
        ...

    def motion_at(self, time: Any) -> Any:
        """Twists and torques (m, spring) at times (m,)."""
        ...


def strongest_order(run: ShakenRun, since: float, until: float) -> StrongestOrder | None:
    """The order that has the largest share in what springs store and give back in a stretch of a run, by its true
    rotation; None where the stretch has less than two turns."""
    low, high = (float(a) for a in run.whole.angle([since, until]))
    turns = min(int((high - low) / TURN), MOST_TURNS)
    if turns < 2:
        return None
    count = turns * PER_TURN
    times = run.whole.times_at(high - TURN * turns + TURN * np.arange(count) / PER_TURN)
    motion, shape = run.motion_at(times), np.hanning(count + 1)[:-1, None]

    def amplitudes(values: np.ndarray) -> np.ndarray:
        return np.asarray(2 * np.abs(np.fft.rfft((values - values.mean(axis=0)) * shape, axis=0)) / shape.sum())

    torque, twist = amplitudes(motion.torque), amplitudes(motion.twist)
    energy = torque * twist
    energy[: min(LEAKED, turns)] = 0.0
    place, spring = np.unravel_index(int(np.argmax(energy)), energy.shape)
    if not energy[place, spring] > 0:
        return None
    order = int(place) / turns
    begun, ended = (float(a) for a in run.whole.angle([times[0], until]))
    speed = (ended - begun) / (until - float(times[0]))
    exciting = [(rate, name) for rate, name in _exciting(run.line, speed) if abs(rate - order) * turns < 1.5]
    if exciting:
        order = min(exciting, key=lambda one: abs(one[0] - place / turns))[0]
    sources = tuple(dict.fromkeys(name for rate, name in exciting if rate == order))
    frequency = order * speed
    name = run.shafts[int(spring)]
    return StrongestOrder(order, name, float(torque[place, spring]), frequency, sources, *_mode(run.line, frequency))


def _exciting(line: LineSystem, speed: float) -> Iterator[tuple[float, str]]:
    """Orders of everything that excites, in cycles per turn of the input at its ``speed`` [rad/s], and its name."""
    assembly, topo = line.assembly, line.assembly.topology
    names = assembly.line.names
    for joint, law in zip(topo.joints, joint_laws(assembly, assembly.table(1)), strict=True):
        if law.nonuniform:
            yield from ((float(rate), names[topo.stations[joint].element]) for rate in topo.joint_rates(joint))
    for mesh in topo.meshes:
        yield from ((float(rate), names[mesh.element]) for rate in mesh.stiffness_rates)
    for one in line_harmonics(assembly):
        yield abs(float(one.order) + one.frequency / speed), one.name


def _mode(line: LineSystem, frequency: float) -> tuple[int, float]:
    """Number and frequency of the mode nearest to a frequency; zeros where none is near, or where the line has none."""
    try:
        modes = natural_frequencies(line.assembly).frequency
    except InputError:  # dry friction, or play that no load closes: no linear line
        return 0, 0.0
    apart = np.array([abs(frequency / w - 1) if w > 0 else np.inf for w in modes])
    best = int(np.argmin(apart))
    return (best + 1, float(modes[best])) if apart[best] < NEAR else (0, 0.0)
