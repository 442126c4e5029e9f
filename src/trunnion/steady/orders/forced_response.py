"""The steady motion of a line at one speed, to first order in the twist: everything that excites it.

Joints, excitations of disks and transmission errors together, as ``order_response`` finds them, over the period they
have in common. The linear response says nothing about stability, and beyond small rotation at the joints' inputs it
is only an indication: joint phases then move with the motion.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.coefficients import Assembly
from trunnion.errors import ComputationError
from trunnion.results.fields import coordinate, internal, labelled, variable
from trunnion.results.result import Result
from trunnion.results.units import angle_words
from trunnion.results.variables import Attribute, Variable, attributes
from trunnion.steady.orders.spectrum import order_spectrum

LINEAR_RANGE = 0.1
"""Rotation [rad] at a joint's input up to which the linear response is trusted: 0.1 rad shifts the 2χ of the
joint's law by 0.2 rad, an error of the order of 20 % in the excitation."""
TIMES, PER_CYCLE = 128, 16
"""Points of the wave form: at least, and per cycle of the highest order."""
MOST_NUMBERS = 20_000_000
"""Of all channels over the period: 160 MB an array."""
TURNS = 10
"""Length of the wave form where nothing is common."""
NOTHING = 1e-12
"""Share of its amplitude below which a mean is rounding."""


@labelled
class LinearResponse(Result):
    """Linear steady response of a line over one period of everything (ten turns where there is none).

    Static parts are included; amplitudes are half peak to peak, without a common period a bound. NaN where no steady
    state exists: an undamped resonance.
    """

    tau: Array = coordinate("input_angle", "rad")
    twist: Array = variable("input_angle shaft", "rad")
    torque: Array = variable("input_angle shaft", "N*m", "positive with the twist")
    rotation: Array = variable("input_angle coordinate", "rad", "deviation from the base motion")
    joint_rotation: Array = variable("joint", "rad", "largest deviation at the joint's input")
    twist_amplitude: Array = internal("of every shaft", "rad", "shaft")
    torque_amplitude: Array = internal("of every shaft", "N*m", "shaft")
    torque_mean: Array = internal("negative when power flows from input to output", "N*m", "shaft")
    shafts: tuple[str, ...] = coordinate("shaft")
    joints: tuple[str, ...] = coordinate("joint")
    names: tuple[str, ...] = coordinate("coordinate")

    @property
    def largest_joint_rotation(self) -> float:
        """The largest deviation at any joint's input [rad]; 0 without joints."""
        return float(np.max(self.joint_rotation, initial=0.0))

    @property
    def linear(self) -> bool:
        """Whether the deviations stay within ``LINEAR_RANGE``, so that the amplitudes can be trusted."""
        return bool(self.largest_joint_rotation <= LINEAR_RANGE)

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, and whether that is within the linear range."""
        yield from super().declared()
        yield from attributes(linear_range=LINEAR_RANGE, within_linear_range=self.linear)

    def __str__(self) -> str:
        rows = [
            f"  {name}: twist ±{angle_words(t, 4)}, torque ±{f:.4g} N m "
            f"about {m if abs(m) > NOTHING * f else 0.0:.4g} N m"
            for name, t, f, m in zip(
                self.shafts, self.twist_amplitude, self.torque_amplitude, self.torque_mean, strict=True
            )
        ]
        trust = (
            f"largest rotation at a joint's input {angle_words(self.largest_joint_rotation)}"
            f" ({'within' if self.linear else 'BEYOND'} the linear range of {angle_words(LINEAR_RANGE)})"
        )
        return "\n".join(["linear forced response over one period", *rows, f"  {trust}"])


def linear_response(assembly: Assembly, speed: float, *, statically_twisted: bool = True) -> LinearResponse:
    """The steady response at input ``speed`` [rad/s].

    Raises
    ------
    ComputationError : its period holds more cycles of the fastest excitation than fit into memory.
    """
    topo = assembly.topology
    spectrum = order_spectrum(assembly, np.array([speed]), statically_twisted=statically_twisted)
    places = spectrum.channels
    between = spectrum.extremes(spectrum.amplitude, spectrum.mean)
    swing = between.swing[0]
    turns = float(spectrum.common_turns or (TURNS if spectrum.order else 1))
    cycles = max(np.abs(spectrum.angular_frequency).max(initial=speed) / speed * turns, 1.0)
    times = np.ceil(max(TIMES, PER_CYCLE * cycles))
    if times * spectrum.mean.shape[1] > MOST_NUMBERS:
        raise ComputationError(
            f"the forced response needs {times:.3g} points over {turns:g} turns: the highest frequency of an "
            f"excitation is {np.abs(spectrum.angular_frequency).max() / speed:.3g} "
            "times the speed; raise the speed or lower it"
        )
    tau = np.linspace(0.0, 2 * np.pi * turns, int(times) + 1)
    seen = spectrum.wave(0, spectrum.amplitude[0], spectrum.mean[0], tau / speed)
    return LinearResponse(
        tau=tau,
        twist=seen[:, places.twist],
        torque=seen[:, places.torque],
        rotation=seen[:, places.deviation],
        joint_rotation=between.largest[0, places.joint_input],
        twist_amplitude=swing[places.twist],
        torque_amplitude=swing[places.torque],
        torque_mean=spectrum.mean[0, places.torque],
        shafts=shaft_names(assembly),
        joints=tuple(assembly.line.names[topo.stations[j].element] for j in topo.joints),
        names=topo.names,
    )


def shaft_names(assembly: Assembly) -> tuple[str, ...]:
    """Names of the compliances; massless shafts in series count as one."""
    return tuple(assembly.line.spring_name(c.shafts, c.number) for c in assembly.topology.compliances)
