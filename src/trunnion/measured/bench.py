"""A synthetic test bench: the signals that pickups and gauges would record of a line, with everything that spoils them.

The line moves as ``order_response`` says at every speed of the run: quasi-steadily, which holds while the speed stays
for several decay times within the width of a resonance; where it does not, that is said.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from trunnion.arrays import Array, Complex
from trunnion.driveline.arguments import one_number, rising_range, speeds_of, whole_number
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.refusals import nearest
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.errors import ComputationError, InputError
from trunnion.features import left_out
from trunnion.measured.signals.measurement import TURN, Channel, Measurement, PulseTrain, SampledSignal
from trunnion.measured.tracking.places import even_places, speed_ratios
from trunnion.modes.natural_frequencies import natural_frequencies
from trunnion.response.orders.response import response_about, steady_states_of
from trunnion.response.orders.result import OrderResponse
from trunnion.results.units import figures

FIRST_GRID, LAST_GRID = 65, 16385
"""Speeds at which the response is computed, doubled until it is smooth between them."""
BETWEEN = 2e-5
"""Largest error between speeds, relative to the largest amplitude of a channel."""
ROUNDS = 60
DWELL = 3.0
"""Decay times that a run-up has to stay within the width of a resonance."""


@dataclass(frozen=True)
class _Course:
    """Rotation of the input, φ = first·t + acceleration·t²/2, over ``duration`` [s]."""

    first: float
    acceleration: float
    duration: float

    def angle(self, time: Array) -> Array:
        return np.asarray(self.first * time + self.acceleration * time**2 / 2)

    def speed(self, time: Array) -> Array:
        return np.asarray(self.first + self.acceleration * time)

    def time(self, angle: Array) -> Array:
        if self.acceleration == 0:
            return np.asarray(angle / self.first)
        root = np.sqrt(self.first**2 + 2 * self.acceleration * angle)
        return np.asarray(2 * angle / (self.first + root))


@dataclass(frozen=True)
class _OrderMotion:
    """Re Σ Y_k(Ω) e^{i(kφ + νt)} of one quantity, and its mean."""

    order: Array
    frequency: Array
    spline: CubicSpline | None
    steady: Complex
    mean: float

    def at(self, time: Array, angle: Array, speed: Array) -> tuple[Array, Array]:
        """Values (m,), and their slope over the angle."""
        amplitude = self.steady[None, :] if self.spline is None else self.spline(speed)
        waves = amplitude * np.exp(
            1j * (np.multiply.outer(angle, self.order) + np.multiply.outer(time, self.frequency))
        )
        turned = 1j * (self.order + np.multiply.outer(1.0 / speed, self.frequency))
        return np.asarray(waves.real.sum(axis=1)), np.asarray((turned * waves).real.sum(axis=1))

    def accelerating(self, time: Array, angle: Array, speed: Array) -> Array:
        """Its second derivative by the time (m,), amplitude and speed as they stand at each instant."""
        amplitude = self.steady[None, :] if self.spline is None else self.spline(speed)
        waves = amplitude * np.exp(
            1j * (np.multiply.outer(angle, self.order) + np.multiply.outer(time, self.frequency))
        )
        rates = np.multiply.outer(speed, self.order) + self.frequency
        return np.asarray(-(rates**2 * waves).real.sum(axis=1))


def measure(
    line: Driveline | Assembly,
    speeds: tuple[float | str, float | str] | float | str,
    duration: float,
    pickups: Mapping[str, int],
    *,
    gauges: Sequence[str] = (),
    accelerometers: Sequence[str] = (),
    jitter: float = 0.0,
    pitch_error: float = 0.0,
    wheels: int = 0,
    missing: float = 0.0,
    double: float = 0.0,
    clock_drift: Mapping[str, float] | None = None,
    gauge_noise: float = 0.0,
    accelerometer_noise: float = 0.0,
    gauge_rate: float = 5000.0,
    start_angle: float = 0.0,
    load_case: str | None = None,
    seed: int = 0,
) -> Measurement:
    """Signals of a synthetic test bench: pulses of wheels on the disks of a line, torques of its springs,
    angular accelerations of its disks.

    Parameters
    ----------
    line : the driveline.
    speeds : first and last speed of a run-up or run-down of constant acceleration, or the one of a steady run [rad/s].
    duration : of the recording [s].
    pickups : pulses per turn of the wheel at each disk named.
    gauges : springs whose torque is recorded.
    accelerometers : disks whose angular acceleration is recorded.
    jitter : standard deviation of the time of an edge [s], white.
    pitch_error : standard deviation of the position of a tooth as a share of the pitch [-].
    wheels : seed of the pitch errors: runs with the same wheels have the same.
    missing, double : shares of pulses that are lost, and that come twice [-].
    clock_drift : by pickup, the relative error of the clock that its times are taken by, which is another recorder's
        then.
    gauge_noise : standard deviation of a torque sample [N m], white.
    accelerometer_noise : standard deviation of an acceleration sample [rad/s²], white.
    gauge_rate : samples per second of gauges and accelerometers [Hz].
    start_angle : rotation of the input when the recording begins [rad].
    load_case : as of ``order_response``.
    seed : of noise and of pulses lost.

    Raises
    ------
    InputError : a place that is not there; numbers that cannot be; as of ``order_response``.

    Examples
    --------
    >>> import trunnion as tn
    >>> spring = tn.Shaft(stiffness=2e4, damping=20, name="tube")
    >>> line = tn.Driveline(
    ...     [tn.ConstantSpeed(), tn.HookeJoint(angle="10 deg"), spring, tn.Disk(inertia=0.5, name="hub")]
    ... )
    >>> print(tn.measure(line, 100.0, 1.0, {"hub": 60}, jitter=1e-6))
    measurement of 1 channel
      hub: 955 pulses, 60 a turn, 15.9 turns in 0.9989 s
      note: Nothing excites this line but its joints.
    """
    assembly = assemble(line, load_case)
    course = _course(speeds, duration)
    spoilt = {"jitter": jitter, "pitch_error": pitch_error, "gauge_noise": gauge_noise}
    for key, value in (spoilt | {"accelerometer_noise": accelerometer_noise}).items():
        if not (one_number(value, key) >= 0 and np.isfinite(value)):
            raise InputError("must not be negative", key=key, value=value, remedy="0 for none")
    for key, value in {"missing": missing, "double": double}.items():
        if not 0 <= one_number(value, key) < 0.2:
            raise InputError("must be a share below 0.2", key=key, value=value, remedy="0.001, say")
    response = _responses(assembly, course)
    teeth = {name: whole_number(count, f"pickups.{name}", 2) for name, count in pickups.items()}
    ratios, even = speed_ratios(assembly), even_places(assembly)
    disks = (*even, *response[0].inertias)
    known = {"pickups": disks, "gauges": response[0].springs, "accelerometers": disks}
    for key, names in {"pickups": teeth, "gauges": gauges, "accelerometers": accelerometers}.items():
        for name in names:
            if name not in known[key]:
                what = "is not a spring of the line" if key == "gauges" else "is not a disk of the line"
                raise InputError(what, key=key, value=name, remedy=nearest(name, known[key]))
    channels: list[Channel] = []
    drifts = dict(clock_drift or {})
    for place, (name, count) in enumerate(teeth.items()):
        error = np.random.default_rng([wheels, place]).normal(size=count)
        pattern = pitch_error * TURN / count * (error - error.mean())
        wheel = _Wheel(name, count, pattern, abs(ratios[name]))
        noise = np.random.default_rng([seed, place])
        times = wheel.edges(course, _motion(response, course, name, "rotation"), start_angle)
        times = _spoiled(times, noise, jitter, missing, double)
        if name in drifts:
            times = times * (1 + drifts[name])
        clock = "drifting" if name in drifts else ""
        channels.append(PulseTrain(times, count, name, name, pitch_error=pitch_error, clock=clock))
    for place, name in enumerate(gauges):
        noise = np.random.default_rng([seed, len(teeth) + place])
        time = np.arange(int(duration * gauge_rate)) / gauge_rate
        motion = _motion(response, course, name, "torque")
        torque = motion.mean + motion.at(time, start_angle + course.angle(time), course.speed(time))[0]
        values = torque + gauge_noise * noise.normal(size=len(time))
        label = f"torque of {name}" if name in teeth else name
        channels.append(SampledSignal(values, gauge_rate, label, "torque", name))
    for place, name in enumerate(accelerometers):
        noise = np.random.default_rng([seed, len(teeth) + len(gauges) + place])
        time = np.arange(int(duration * gauge_rate)) / gauge_rate
        motion = _motion(response, course, name, "rotation")
        swing = motion.accelerating(time, start_angle + course.angle(time), course.speed(time))
        values = abs(ratios[name]) * course.acceleration + swing + accelerometer_noise * noise.normal(size=len(time))
        channels.append(SampledSignal(values, gauge_rate, f"acceleration of {name}", "acceleration", name))
    return Measurement(channels, "synthetic bench", _remarks(assembly, course, response))


def _course(speeds: object, duration: float) -> _Course:
    if not (one_number(duration, "duration") > 0 and np.isfinite(duration)):
        raise InputError("must be positive", key="duration", value=duration, remedy="in seconds")
    if isinstance(speeds, tuple | list):
        first, last = speeds_of(list(speeds)).tolist() if len(speeds) == 2 else (0.0, 0.0)
        low, high = rising_range(sorted((first, last))) if first != last else (first, last)
        return _Course(first, (last - first) / duration, duration) if low < high else _course(first, duration)
    speed = float(speeds_of(speeds)[0])  # type: ignore[arg-type]
    if not (speed > 0 and np.isfinite(speed)):
        raise InputError("must be positive", key="speeds", value=speed, remedy="tn.rpm(1500), say")
    return _Course(speed, 0.0, duration)


def _responses(assembly: Assembly, course: _Course) -> tuple[OrderResponse, float]:
    """The response at speeds so near that it is smooth between them, and how far a spline is off there."""
    motions = steady_states_of(assembly)
    low, high = sorted((course.first, course.first + course.acceleration * course.duration))
    if course.acceleration == 0:
        return response_about(assembly, np.array([course.first]), motions), 0.0
    count = FIRST_GRID
    found = response_about(assembly, np.linspace(low, high, count), motions)
    while True:
        error = max(_between(found, values) for values in (found.rotation, found.torque))
        if error <= BETWEEN:
            return found, error
        count = 2 * count - 1
        if count > LAST_GRID:
            raise ComputationError(
                f"the response is not smooth over {LAST_GRID} speeds (error {error:.2g}): a resonance without damping; "
                "give the line damping, or ask for a smaller range"
            )
        found = response_about(assembly, np.linspace(low, high, count), motions)


def _between(found: OrderResponse, values: Complex) -> float:
    """Error in the middles of a spline through every other speed, relative to the largest amplitude of a place."""
    if not values.size:
        return 0.0
    whole = CubicSpline(found.speed[::2], values[::2])(found.speed[1::2])
    scale = np.abs(values).max(axis=(0, 1))
    # A spline's error falls with the fourth power of the step: half the step has a sixteenth.
    off = np.abs(whole - values[1::2]).max(axis=(0, 1)) / 16
    return float(np.max(off / np.where(scale > 0, scale, 1.0), initial=0.0))


def _motion(response: tuple[OrderResponse, float], course: _Course, name: str, kind: str) -> _OrderMotion:
    found = response[0]
    if kind == "rotation" and name not in found.inertias:  # held at the driven end
        return _OrderMotion(np.zeros(0), np.zeros(0), None, np.zeros(0, dtype=complex), 0.0)
    names, values = (found.inertias, found.rotation) if kind == "rotation" else (found.springs, found.torque)
    own = values[:, :, names.index(name)]
    mean = 0.0 if kind == "rotation" else float(found.mean_torque[:, names.index(name)].mean())
    spline = CubicSpline(found.speed, own) if len(found.speed) > 1 else None
    return _OrderMotion(found.order, found.frequency, spline, own[0], mean)


@dataclass(frozen=True)
class _Wheel:
    """A toothed wheel at a disk that makes ``ratio`` turns for one of the input; pattern (tooth,) [rad]."""

    name: str
    teeth: int
    pattern: Array
    ratio: float

    def edges(self, course: _Course, motion: _OrderMotion, start_angle: float) -> Array:
        """Times [s] at which the rotation of the disk, ratio·φ and its deviation, passes each tooth."""
        whole = float(course.angle(np.array(course.duration))) * self.ratio
        number = np.arange(int(whole / TURN * self.teeth) + 1)
        target = TURN * number / self.teeth + self.pattern[number % self.teeth]
        angle = target / self.ratio
        for _ in range(ROUNDS):
            time = course.time(np.maximum(angle, 0.0))
            swing, slope = motion.at(time, start_angle + angle, course.speed(time))
            step = (self.ratio * angle + swing - target) / (self.ratio + slope)
            angle = angle - step
            if np.abs(step).max() < 1e-13 * max(whole, 1.0):
                break
        else:
            raise ComputationError(
                f"the disk {self.name} turns back within a swing: its pulses have no order; ask for a speed away from "
                "resonance, or give the line damping"
            )
        time = course.time(np.maximum(angle, 0.0))
        return np.asarray(time[(angle >= 0) & (time <= course.duration)])


def _spoiled(times: Array, noise: np.random.Generator, jitter: float, missing: float, double: float) -> Array:
    times = np.sort(times + jitter * noise.normal(size=len(times)))
    gap = float(np.diff(times).min())
    lost, twice = noise.random(len(times)) < missing, noise.random(len(times)) < double
    again = times[twice & ~lost] + gap * (0.05 + 0.2 * noise.random(int((twice & ~lost).sum())))
    return np.sort(np.concatenate([times[~lost], again]))


def _remarks(assembly: Assembly, course: _Course, response: tuple[OrderResponse, float]) -> tuple[str, ...]:
    left = [one.sentence for one in left_out("measure", assembly.line)]
    found = list(dict.fromkeys([*left, *(one.sentence for one in response[0].remarks)]))
    if course.acceleration:
        found += _too_fast(assembly, course, response[0])
    return tuple(found)


def _too_fast(assembly: Assembly, course: _Course, response: OrderResponse) -> list[str]:
    """Resonances that a run-up passes faster than they settle."""
    modes = natural_frequencies(assembly)
    speeds = sorted((course.first, course.first + course.acceleration * course.duration))
    worst = (np.inf, "")
    for frequency, ratio in zip(modes.elastic.tolist(), modes.damping_ratio[modes.still :].tolist(), strict=True):
        for order in response.order[response.frequency == 0].tolist():
            if speeds[0] <= frequency / order <= speeds[1]:
                width, decay = 2 * ratio * frequency / order, 1 / max(ratio * frequency, 1e-300)
                stays = width / abs(course.acceleration) / decay
                worst = min(worst, (stays, f"order {order:g} at {figures(frequency / TURN, 4)} Hz"))
    if worst[0] >= DWELL:
        return []
    return [
        f"The run-up stays {figures(worst[0], 2)} decay times within the resonance of {worst[1]}: signals are those of "
        "the steady response at each speed; run_up has the true passage."
    ]
