"""A synthetic test bench: the signals that pickups and gauges would record of a line, with everything that spoils them.

The line moves as ``order_response`` says at a steady speed, and in a run lags behind that as ``run_response`` says.
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
from trunnion.equations.inertia_torque import accelerating, inertia_torque
from trunnion.errors import ComputationError, InputError
from trunnion.features import left_out
from trunnion.measured.run_response import FIRST_GRID, run_response
from trunnion.measured.signals.measurement import TURN, Channel, Measurement, PulseTrain, SampledSignal
from trunnion.measured.tracking.places import even_places, speed_ratios
from trunnion.response.orders.response import response_about, steady_states_of
from trunnion.response.orders.result import OrderResponse
from trunnion.steady.orders.forced_response import shaft_names

ROUNDS = 60


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
    """Re Σ Y_k(Ω) e^{i(kφ + νt)} of one quantity; amplitudes (order,) where the speed stays, else over the speed."""

    order: Array
    frequency: Array
    amplitude: CubicSpline | Complex

    def at(self, time: Array, angle: Array, speed: Array) -> tuple[Array, Array]:
        """Values (m,), and their slope over the angle."""
        amplitude = self.amplitude(speed) if isinstance(self.amplitude, CubicSpline) else self.amplitude[None, :]
        waves = amplitude * np.exp(
            1j * (np.multiply.outer(angle, self.order) + np.multiply.outer(time, self.frequency))
        )
        turned = 1j * (self.order + np.multiply.outer(1.0 / speed, self.frequency))
        return np.asarray(waves.real.sum(axis=1)), np.asarray((turned * waves).real.sum(axis=1))


@dataclass(frozen=True)
class _BenchResponse:
    """What each disk and spring of a line does on the bench.

    listed: the response at a few speeds, which lists its orders. amplitude: of rotations of the disks, their
    accelerations and torques of the springs, one after another (order, quantity) where the speed stays, else a spline
    of these over the speed; the last order, 0, is the mean torque. senses (disk,): −1 of disks that turn against the
    input, whose motion shows in their own sense.
    """

    listed: OrderResponse
    amplitude: CubicSpline | Complex
    senses: Array

    def motion(self, name: str, kind: str) -> _OrderMotion:
        """Of a disk (its "rotation" or "acceleration") or a spring ("torque")."""
        disks = self.listed.inertias
        if kind != "torque" and name not in disks:  # held at the driven end
            return _OrderMotion(np.zeros(0), np.zeros(0), np.zeros(0, dtype=complex))
        own = {"rotation": 0, "acceleration": len(disks), "torque": 2 * len(disks)}[kind]
        own += self.listed.springs.index(name) if kind == "torque" else disks.index(name)
        sense = 1.0 if kind == "torque" else self.senses[disks.index(name)]
        if isinstance(self.amplitude, CubicSpline):
            values = sense * self.amplitude(self.amplitude.x)[:, :, own]
            part: CubicSpline | Complex = CubicSpline(self.amplitude.x, values)
        else:
            part = sense * self.amplitude[:, own]
        return _OrderMotion(np.append(self.listed.order, 0.0), np.append(self.listed.frequency, 0.0), part)


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
    response = _bench_response(assembly, course)
    teeth = {name: whole_number(count, f"pickups.{name}", 2) for name, count in pickups.items()}
    ratios, even = speed_ratios(assembly), even_places(assembly)
    disks = (*even, *response.listed.inertias)
    known = {"pickups": disks, "gauges": response.listed.springs, "accelerometers": disks}
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
        times = wheel.edges(course, response.motion(name, "rotation"), start_angle)
        times = _spoiled(times, noise, jitter, missing, double)
        if name in drifts:
            times = times * (1 + drifts[name])
        clock = "drifting" if name in drifts else ""
        channels.append(PulseTrain(times, count, name, name, pitch_error=pitch_error, clock=clock))
    for place, name in enumerate(gauges):
        noise = np.random.default_rng([seed, len(teeth) + place])
        time = np.arange(int(duration * gauge_rate)) / gauge_rate
        motion = response.motion(name, "torque")
        torque = motion.at(time, start_angle + course.angle(time), course.speed(time))[0]
        values = torque + gauge_noise * noise.normal(size=len(time))
        label = f"torque of {name}" if name in teeth else name
        channels.append(SampledSignal(values, gauge_rate, label, "torque", name))
    for place, name in enumerate(accelerometers):
        noise = np.random.default_rng([seed, len(teeth) + len(gauges) + place])
        time = np.arange(int(duration * gauge_rate)) / gauge_rate
        motion = response.motion(name, "acceleration")
        swing = motion.at(time, start_angle + course.angle(time), course.speed(time))[0]
        values = abs(ratios[name]) * course.acceleration + swing + accelerometer_noise * noise.normal(size=len(time))
        channels.append(SampledSignal(values, gauge_rate, f"acceleration of {name}", "acceleration", name))
    return Measurement(channels, "synthetic bench", _remarks(assembly, response.listed))


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


def _bench_response(assembly: Assembly, course: _Course) -> _BenchResponse:
    low, high = sorted((course.first, course.first + course.acceleration * course.duration))
    speeds = np.linspace(low, high, FIRST_GRID) if course.acceleration else np.array([course.first])
    row, ratios = assembly.table(1, low), speed_ratios(assembly)
    under = accelerating(assembly, row, course.acceleration)
    carrying = under is not row
    try:
        runs = assemble(assembly.packed.line_at(under[0])) if carrying else assembly
        motions = steady_states_of(runs)
        listed = response_about(runs, speeds, motions)
    except InputError:
        if not carrying:
            raise
        # What it cannot carry at a steady speed, with a spring in its free play, say.
        runs, carrying, motions = assembly, False, steady_states_of(assembly)
        listed = response_about(runs, speeds, motions)
    inertia = dict(zip(shaft_names(assembly), inertia_torque(assembly).tolist(), strict=True))
    behind = np.array([0.0 if carrying else inertia.get(name, 0.0) for name in listed.springs])
    senses = np.array([np.sign(ratios[name]) or 1.0 for name in listed.inertias])

    def respond(speed: Array) -> Complex:
        found = listed if speed is speeds else response_about(runs, speed, motions)
        mean = np.zeros((len(speed), 1, 2 * len(listed.inertias) + len(listed.springs)), dtype=complex)
        mean[:, 0, 2 * len(listed.inertias) :] = found.mean_torque + course.acceleration * behind
        return np.concatenate([_quantities(found, listed), mean], axis=1)

    if not course.acceleration:
        return _BenchResponse(listed, respond(speeds)[0], senses)
    found = run_response(respond, low, high, course.acceleration, np.append(listed.order, 0.0))
    return _BenchResponse(listed, CubicSpline(found.speed, found.passing), senses)


def _quantities(found: OrderResponse, listed: OrderResponse) -> Complex:
    """Rotations, accelerations and torques (speed, order, quantity) of the orders that are listed."""
    known = [(round(k, 9), round(nu, 9)) for k, nu in zip(found.order.tolist(), found.frequency.tolist(), strict=True)]
    made = np.zeros(
        (len(found.speed), len(listed.order), 2 * len(listed.inertias) + len(listed.springs)), dtype=complex
    )
    for k, (order, frequency) in enumerate(zip(listed.order.tolist(), listed.frequency.tolist(), strict=True)):
        if (round(order, 9), round(frequency, 9)) not in known:
            continue
        column = known.index((round(order, 9), round(frequency, 9)))
        rate = (order * found.speed + frequency)[:, None]
        rotation = found.rotation[:, column]
        made[:, k] = np.concatenate([rotation, -(rate**2) * rotation, found.torque[:, column]], axis=1)
    return made


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


def _remarks(assembly: Assembly, response: OrderResponse) -> tuple[str, ...]:
    left = [one.sentence for one in left_out("measure", assembly.line)]
    return tuple(dict.fromkeys([*left, *(one.sentence for one in response.remarks)]))
