"""What ``order_response`` gives: amplitudes by order, their sums over the cycle, and what to read in them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from trunnion.arrays import Array, Codes, Complex, Flags
from trunnion.floquet.stability.where_unstable import where_unstable
from trunnion.laws.harmonic import LONGEST_PERIOD, turning
from trunnion.results.counts import counted
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, computed, coordinate, internal, labelled, variable
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.results.result import Result
from trunnion.results.speeds import order_name
from trunnion.results.stretches import largest_over, stretches_above
from trunnion.results.variables import Attribute, Variable, attributes
from trunnion.results.verdict import Verdict
from trunnion.results.words import Words
from trunnion.steady.orders.amplitudes import OrderSpectrum, Range
from trunnion.steady.orders.forced_response import LINEAR_RANGE

if TYPE_CHECKING:
    from trunnion.driveline.operation import Operation

FREE_FREQUENCY = 10.0
"""Frequency [Hz] up to which S_f is 1."""
WAVE_POINTS = 64
"""Points of a wave form per cycle of its highest order."""
WORTH_SHOWING = 1e-6
"""Share of the largest torque below which an order is counted in the sums, but not listed by itself."""


@dataclass(frozen=True)
class OrderWave:
    """Wave form at one speed over one period (ten turns where there is none), its end included.

    time (point,) [s] from zero rotation of the input; torque (point, spring) [N m]; twist (point, spring) [rad];
    rotation (point, inertia) [rad] from uniform rotation.
    """

    speed: float
    time: Array
    torque: Array
    twist: Array
    rotation: Array
    springs: tuple[str, ...]
    inertias: tuple[str, ...]


@labelled
class OrderResponse(Result):
    """Linear steady response by order and speed.

    A column turns with order · speed + frequency: an excitation fixed in time has order 0 (its sidebands multiples of
    the joints' order) and its frequency beside it. Torque, twist and rotation are one-sided complex amplitudes:
    Re[Y e^{i(order · Ωt + frequency · t)}], the phase that of a cosine at zero rotation of the input. Torque is
    positive with the twist; rotation is the deviation of every disk, where it is, from its uniform rotation, what a
    joint in front of it adds included; ends of tubes stand for places without a disk.

    The sums (peak_torque, vibratory_torque, …) hold everything, also orders not listed. NaN where no steady state
    exists: an undamped resonance.
    """

    speed: Array = coordinate("speed", "rad/s")
    order: Array = coordinate("order_number", "1", "cycles per turn of the input", name="order")
    frequency: Array = coordinate("order_number", "rad/s", "beside the order", name="frequency")
    springs: tuple[str, ...] = coordinate("spring")
    inertias: tuple[str, ...] = coordinate("inertia")
    torque: Complex = variable("speed order_number spring", "N*m")
    twist: Complex = variable("speed order_number spring", "rad")
    rotation: Complex = variable("speed order_number inertia", "rad")
    mean_torque: Array = variable("speed spring", "N*m")
    mean_twist: Array = internal("static", "rad", "speed spring")
    joints: tuple[str, ...] = internal("names")
    stress_factor: Array = internal("shear stress over torque; NaN without a diameter", "1/m^3", "spring")
    spectrum: OrderSpectrum = internal("what the sums are made of")
    judged: Callable[[], Codes] = internal("computes the verdict")
    remarks: tuple[Finding, ...] = internal("what excites the line and what was left out")
    unit: str = internal("of speeds in print")
    limits: Mapping[str, Mapping[str, float]] = internal(
        "of torque by spring and name, as the description states them", "N m"
    )
    rated: tuple[bool, ...] = internal("which springs hold a coupling with a rating T_KW", axes="spring")

    @property
    def sum_is_bound(self) -> bool:
        """True where excitations repeat together only after more than 60 turns of the input, or periods of the slowest
        of them, or never: sums over the cycle are sums of amplitudes."""
        return not self.spectrum.adds_exactly

    @property
    def known_ranges(self) -> dict[str, Range]:
        """Ranges over the cycle that are computed already, by name."""
        return {name: vars(self)[name] for name in ("torque_range", "twist_range") if name in vars(self)}

    def knowing(self, ranges: Mapping[str, Range]) -> OrderResponse:
        """The same, whose ``known_ranges`` are these."""
        found = replace(self)
        vars(found).update(ranges)
        return found

    @cached_property
    def torque_range(self) -> Range:
        """Lowest and highest torque (speed, spring) [N m] over the cycle, mean included."""
        return self.spectrum.extremes_at(self.spectrum.channels.torque)

    @property
    @computed(variable("speed spring", "N*m"))
    def peak_torque(self) -> Array:
        """Largest |mean + vibratory torque| (speed, spring) [N m] over the cycle."""
        return self.torque_range.largest

    @property
    @computed(variable("speed spring", "N*m"))
    def vibratory_torque(self) -> Array:
        """Half of the peak-to-peak torque (speed, spring) [N m]."""
        return self.torque_range.swing

    @cached_property
    @computed(variable("speed spring", "N*m"))
    def rated_torque(self) -> Array:
        """Σ S_f(f_k) |T_k| over all orders (speed, spring) [N m], S_f = √(f/10 Hz), at least 1.

        What DIN 740-2 compares with a coupling's T_KW/S_t: an upper bound, for amplitudes are added up without their
        phases. ``vibratory_torque`` has no S_f in it.
        """
        spectrum = self.spectrum
        size = np.abs(spectrum.amplitude[..., spectrum.channels.torque])
        return np.asarray((frequency_factor(spectrum.angular_frequency)[..., None] * size).sum(axis=1))

    @cached_property
    def twist_range(self) -> Range:
        """Lowest and highest twist (speed, spring) [rad] over the cycle, mean included."""
        return self.spectrum.extremes_at(self.spectrum.channels.twist)

    @property
    @computed(variable("speed spring", "rad"))
    def vibratory_twist(self) -> Array:
        """Half of the peak-to-peak twist (speed, spring) [rad]."""
        return self.twist_range.swing

    @property
    @computed(variable("speed spring", "Pa"))
    def vibratory_stress(self) -> Array:
        """Amplitude of the shear stress at the outside, τ = T r_o / J_p (speed, spring) [Pa]; NaN without a diameter.

        Of shafts in series the most stressed one; notches are not counted.
        """
        return np.asarray(self.vibratory_torque * self.stress_factor)

    @property
    @computed(variable("speed spring", "Pa"))
    def peak_stress(self) -> Array:
        """Largest shear stress at the outside (speed, spring) [Pa]; NaN without a diameter."""
        return np.asarray(self.peak_torque * self.stress_factor)

    @cached_property
    @computed(variable("speed spring", "W"))
    def heat(self) -> Array:
        """Mean power (speed, spring) [W] that becomes heat: ½ c ν² |q|² and ½ ηk |ν| |q|² over all orders."""
        spectrum = self.spectrum
        v = np.abs(spectrum.angular_frequency)[..., None]
        q = np.abs(spectrum.amplitude[..., spectrum.channels.twist]) ** 2
        damping, loss = spectrum.damping[:, None], spectrum.loss[:, None]
        lossy = damping * v**2 + loss * v
        if spectrum.oils:
            lossy = np.broadcast_to(lossy, q.shape).copy()
        for oil in spectrum.oils:
            lossy[..., oil.compliance] += v[..., 0] * oil.added(v[..., 0].T).T.imag
        return np.asarray((lossy * q).sum(axis=1) / 2)

    def heat_parts(self, spring: int) -> Array:
        """Of one spring by order (speed, order) [W^½]: what ``heat`` is the sum of the squares of, orders listed."""
        spectrum = self.spectrum
        v = np.abs(self.angular_frequency)
        damping, loss = spectrum.damping[:, None, spring], spectrum.loss[:, None, spring]
        lossy = damping * v**2 + loss * v
        for oil in spectrum.oils:
            if oil.compliance == spring:
                lossy = lossy + v * oil.added(v.T).T.imag
        return np.asarray(np.sqrt(lossy / 2) * self.twist[:, :, spring])

    @property
    def frequency_factor(self) -> Array:
        """S_f of every order listed (speed, order) [-]; see ``rated_torque``."""
        return frequency_factor(self.angular_frequency)

    @property
    def angular_frequency(self) -> Array:
        """Of every order listed (speed, order) [rad/s], of either sign."""
        return turning(self.order, self.frequency, self.speed[:, None])

    @cached_property
    @computed(variable("speed inertia", "rad"))
    def rotation_amplitude(self) -> Array:
        """Half of the peak-to-peak rotation (speed, inertia) [rad]."""
        return self._swing(0)

    @cached_property
    @computed(variable("speed inertia", "rad/s"))
    def speed_fluctuation(self) -> Array:
        """Half of the peak-to-peak angular speed (speed, inertia) [rad/s]."""
        return self._swing(1)

    @cached_property
    @computed(variable("speed inertia", "rad/s^2"))
    def acceleration(self) -> Array:
        """Half of the peak-to-peak angular acceleration (speed, inertia) [rad/s²]."""
        return self._swing(2)

    def _swing(self, rates: int) -> Array:
        spectrum = self.spectrum
        whole = spectrum.amplitude[..., spectrum.channels.point] + spectrum.base
        turned = whole * (1j * spectrum.angular_frequency[..., None]) ** rates
        return spectrum.extremes(turned, np.zeros((len(self.speed), len(self.inertias)))).swing

    @cached_property
    @computed(variable("speed", "rad"))
    def joint_rotation(self) -> Array:
        """Largest deviation at any joint's input (speed,) [rad]: the measure of the linear range; 0 without joints."""
        return np.asarray(self.joint_rotations.max(axis=1, initial=0.0))

    @cached_property
    def joint_rotations(self) -> Array:
        """The same for every joint (speed, joint)."""
        return self.spectrum.joint_rotations

    @property
    @computed(variable("speed"))
    def linear(self) -> Flags:
        """Where the amplitudes can be trusted (speed,): joints' inputs stay within ``linear_range``."""
        return np.asarray(self.joint_rotation <= LINEAR_RANGE)

    @cached_property
    def verdict(self) -> Codes:
        """Stability of the motion (speed,), codes of ``Verdict``; FAILED where it cannot be judged."""
        return self.judged()

    @property
    def unstable(self) -> Flags:
        """Where a small disturbance grows (speed,), so that the steady motion is not reached."""
        return np.asarray(self.verdict == Verdict.UNSTABLE)

    @property
    @computed(variable("speed", "1"))
    def cut_off(self) -> Array:
        """Size of the outermost harmonics kept, relative to the largest torque (speed,); 0 on straight lines."""
        return self.spectrum.cut_off

    @property
    @computed(attribute())
    def side_orders(self) -> int:
        """Side orders that are solved for on either side of every excitation, which joint angles and varying meshes
        make of it; 0 on straight lines and about a free line's own motion."""
        return self.spectrum.side_orders

    def peak(self, spring: str) -> tuple[float, float]:
        """Largest |torque| of a spring [N m] over all speeds, and the speed it stands at [rad/s]; NaN without a steady
        state at any of them."""
        return self.largest(self.peak_torque[:, self.springs.index(spring)])

    def leading(self, spring: str) -> tuple[str, float, float]:
        """Name, speed [rad/s] and amplitude [N m] of a spring's largest torque by one order, by turns or in time;
        "none" where none vibrates, NaN without a steady state at any speed."""
        size = np.abs(self.torque[:, :, self.springs.index(spring)])
        if not np.any(np.isfinite(size)):
            return "none", float("nan"), float("nan")
        at, k = np.unravel_index(int(np.nanargmax(size)), size.shape)
        speed, amplitude = float(self.speed[at]), float(size[at, k])
        return order_name(float(self.order[k]), float(self.frequency[k])) if amplitude > 0 else "none", speed, amplitude

    def wave(self, speed: float | None = None) -> OrderWave:
        """Wave form at the speed of the result that is nearest to ``speed`` [rad/s], by default the first."""
        spectrum = self.spectrum
        at = 0 if speed is None else int(np.abs(self.speed - speed).argmin())
        length = spectrum.period(at) or 2 * np.pi * 10 / self.speed[at]
        cycles = np.abs(spectrum.angular_frequency[at]).max(initial=self.speed[at]) * length / (2 * np.pi)
        time = np.linspace(0.0, length, int(np.ceil(WAVE_POINTS * cycles)) + 1)
        places = spectrum.channels
        parts = spectrum.amplitude[at], spectrum.mean[at]
        seen = spectrum.wave(at, *parts, time)
        whole = spectrum.amplitude[at][:, places.point] + spectrum.base[at]
        rotation = spectrum.wave(at, whole, spectrum.mean[at, places.point], time)
        return OrderWave(
            float(self.speed[at]), time, seen[:, places.torque], seen[:, places.twist], rotation,
            self.springs, self.inertias,
        )  # fmt: skip

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What to read first, gravest first."""
        return by_gravity([*_findings(self), *self.remarks])

    def declared(self) -> Iterator[Variable | Attribute]:
        """Amplitudes over (speed, order, element) and their sums over the cycle over (speed, element)."""
        yield from super().declared()
        yield from attributes(linear_range=LINEAR_RANGE, sum_is_bound=self.sum_is_bound)

    def plot(
        self,
        axes: Axes | None = None,
        *,
        spring: str | None = None,
        unit: str | None = None,
        operating: Operation | None = None,
        limit: float | None = None,
        limits: Mapping[str, float] | None = None,
    ) -> Axes:
        """Torque by order over speed of the most loaded spring; see ``pictures.orders.order_response``."""
        return drawing(self, "plot")(
            self, axes, spring=spring, unit=unit, operating=operating, limit=limit, limits=limits
        )

    @property
    def headline(self) -> str:
        """What was computed."""
        return f"linear steady response at {counted(len(self.speed), 'speed')} to {counted(len(self.order), 'order')}"

    def table(self, unit: str | None = None) -> list[dict[str, object]]:
        """One row per spring: its largest torques [N m] and its largest order, each at its speed in ``unit``."""
        words = self.in_unit(unit).words
        rows: list[dict[str, object]] = []
        for s, spring in enumerate(self.springs):
            name, speed, size = self.leading(spring)
            vibrates = name != "none"
            rated = self._largest("rated torque", self.rated_torque[:, s], words, "  ") if any(self.rated) else {}
            rows.append(
                {
                    "spring": spring,
                    **self._largest("peak torque", self.peak_torque[:, s], words, ""),
                    **self._largest("vibratory torque", self.vibratory_torque[:, s], words, " "),
                    **rated,
                    "largest order": name.removeprefix("order "),
                    "its torque [N m]": size if vibrates else None,
                    f"at [{words.unit}]   ": speed * words.factor if vibrates else None,
                }
            )
        return rows

    def _largest(self, name: str, column: Array, words: Words, apart: str) -> dict[str, object]:
        """Largest of a column over the speeds, and where: heads of tables differ by blanks behind them."""
        value, speed = self.largest(column)
        return {f"{name} [N m]": value, f"at [{words.unit}]{apart}": speed * words.factor}

    def largest(self, column: Array) -> tuple[float, float]:
        """Largest of values (speed,) and the speed [rad/s] where it is; NaN where none is known."""
        return largest_over(self.speed, column)

    def _lines(self) -> Iterator[str]:
        yield self.headline
        for s, spring in enumerate(self.springs):
            column = self.peak_torque[:, s]
            if not np.any(np.isfinite(column)):
                yield f"  {spring}: no steady state"
                continue
            said = [f"torque up to {self._at_most(column)}"]
            said.append(f"vibratory torque up to {self._at_most(self.vibratory_torque[:, s])}")
            if self.rated[s]:
                said.append(f"rated torque, Σ S_f|T|, up to {self._at_most(self.rated_torque[:, s])}")
            yield f"  {spring}: {'; '.join(said)}{self._led_by(spring)}"

    def _at_most(self, column: Array) -> str:
        value, speed = self.largest(column)
        return f"{value:.4g} N m at {self.words.speed(speed)}"

    def _led_by(self, spring: str) -> str:
        name, at, size = self.leading(spring)
        return "" if name == "none" else f"; most by one order: {size:.4g} N m of {name} at {self.words.speed(at)}"


def frequency_factor(frequency: Array) -> Array:
    """S_f of frequencies [rad/s], after DIN 740-2."""
    return np.sqrt(np.maximum(np.abs(frequency) / (2 * np.pi), FREE_FREQUENCY) / FREE_FREQUENCY)


def _findings(result: OrderResponse) -> Iterable[Finding]:
    words, spectrum = result.words, result.spectrum
    lost = ~np.all(np.isfinite(result.mean_torque), axis=1) | ~np.all(np.isfinite(result.torque), axis=(1, 2))
    for speed in result.speed[lost][:3]:
        k = np.flatnonzero(~np.all(np.isfinite(result.torque[result.speed == speed][0]), axis=1))
        which = order_name(result.order[k[0]], result.frequency[k[0]]) if len(k) else "an excitation"
        said = f"No steady state exists at {words.speed(speed)}: {which} meets a natural frequency without damping."
        yield Finding(Gravity.DANGER, said)
    for i, k in np.argwhere((spectrum.angular_frequency == 0) & ~lost[:, None])[:3]:
        name = order_name(spectrum.order_numbers[k], spectrum.frequency[k])
        away = np.isnan(spectrum.amplitude[i, k, spectrum.channels.deviation]).any()
        drives = ", which drives the line away from that speed" if away else ""
        said = f"{name} stands still at {words.speed(result.speed[i])}: it is a constant torque there{drives}."
        yield Finding(Gravity.CAUTION if away else Gravity.NOTE, said)
    lossy = bool(spectrum.loss.any())
    yield from where_unstable(result.speed, result.verdict, words, lossy=lossy)
    if result.sum_is_bound:
        yield Finding(
            Gravity.NOTE,
            f"The excitations repeat together only after more than {LONGEST_PERIOD} turns of the input, or periods "
            "of the slowest of them, or never: peak and vibratory torque are bounds, amplitudes added up.",
        )
    if not np.all(result.linear[~lost]):
        beyond = stretches_above(result.speed[~lost], result.joint_rotation[~lost], LINEAR_RANGE)
        where = words.ranges(beyond, digits=3)
        yield Finding(
            Gravity.CAUTION,
            f"A joint's input swings by up to {words.angle(np.nanmax(result.joint_rotation))}, beyond the linear range "
            f"of {words.angle(LINEAR_RANGE)}, at {where}: read it as resonance, not as an amplitude; "
            "tn.periodic_response gives the true motion.",
        )
