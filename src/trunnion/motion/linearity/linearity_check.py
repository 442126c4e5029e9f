"""``linearity_check``: the linear steady response beside the nonlinear periodic motion, order by order.

``order_response`` is linear in the excitations; ``periodic_response`` is the motion itself. With phases both are
amplitudes of the same orders, so that their difference tells how far linear theory holds at a speed. It falls with the
square where excitations and joint angles shrink together; where play opens, stages change or clutches slip it does not.

Linear equations have no dry friction. A clutch is there the Shaft that ``Clutch.linear`` makes of it at the amplitude,
the leading frequency and the mean torque of the nonlinear motion: the best that a linear line can do,
knowing the answer.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Complex
from trunnion.driveline.arguments import one_number
from trunnion.driveline.clutches import Clutch
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Rotor
from trunnion.driveline.operating_speed import operating_speed
from trunnion.errors import InputError
from trunnion.motion.orbits.periodic_response import ORDERS, PeriodicResponse, periodic_response
from trunnion.motion.passing.capture import RunUpEnding
from trunnion.motion.passing.run_up import run_up
from trunnion.numerics.curves import extremes, fourier
from trunnion.response.orders.response import order_response
from trunnion.response.orders.result import WORTH_SHOWING, OrderResponse
from trunnion.response.speed_sweep import sweep_speeds
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, computed, coordinate, internal, labelled, variable
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.results.of_systems import ending
from trunnion.results.result import Result
from trunnion.results.speeds import show_acceleration, show_speed
from trunnion.results.units import angle_words, order_words
from trunnion.results.variables import Attribute, Coordinate, Variable, attributes
from trunnion.results.verdict import Verdict
from trunnion.steady.orders.forced_response import LINEAR_RANGE
from trunnion.steady.shooting.periodic_orbit import TOLERANCE

SMALL = 0.01
"""A spring whose largest order is below this share of the largest of all is measured against that share."""
FLUCTUATION = 0.1
"""Speed fluctuation over mean speed from which a load with the square of the speed is no longer its tangent."""
WIDTH = 0.2
"""A passage runs from this share of the speed below it to as much above."""
PASSED = 161
"""Speeds of the linear response over a passage, and those about the peaks besides."""
STUCK = 1e-9
"""Twist [rad] that a clutch which does not move is linearised at: its sliders stick."""


@dataclass(frozen=True)
class LinearShaft:
    """What stands for a clutch in the linear equations.

    swing [rad]: half of the peak-to-peak twist of the nonlinear motion; frequency [rad/s]: of its largest order; torque
    [N m]: its mean;
    stiffness [N m/rad] and damping [N m s/rad] of the Shaft at those; slipping: how many of its sliders slip.
    """

    clutch: str
    swing: float
    frequency: float
    torque: float
    stiffness: float
    damping: float
    slipping: int


@dataclass(frozen=True)
class ResonancePassage:
    """A run from speed ``low`` to ``high`` [rad/s] at ``acceleration`` [rad/s²].

    vibration (spring,) [N m]: largest distance of the torque from the quasi-static one, at ``vibration_speed``
    [rad/s]; linear (spring,) [N m]: largest linear vibratory torque in that range, at ``linear_speed`` [rad/s]; ending:
    how a free–free line came through, None where the speed is prescribed.
    """

    springs: tuple[str, ...]
    low: float
    high: float
    acceleration: float
    vibration: Array
    vibration_speed: Array
    linear: Array
    linear_speed: Array
    ending: RunUpEnding | None = None

    @property
    def kind(self) -> str:
        """How it ended, as the outcome of ``run_up`` has it."""
        return "reached" if self.ending is None else self.ending.kind


@labelled
class LinearityCheck(Result):
    """Linear and nonlinear response of a line at one speed; NaN where no nonlinear motion was found.

    Phases of torques count from zero rotation of the input; an order of a fixed frequency is that over the speed.
    """

    linear: OrderResponse | None = internal("None where no nonlinear motion tells how a clutch is to be linearised")
    nonlinear: PeriodicResponse = internal("the periodic motion")
    order: Array = coordinate("order", "1", "cycles per turn of the input")
    linear_torque: Complex = variable("order spring", "N*m", "by linear theory")
    nonlinear_torque: Complex = variable("order spring", "N*m", "of the periodic motion")
    stand_ins: tuple[LinearShaft, ...] = internal("shafts that stand for clutches")
    allowed: float = attribute("largest relative difference with which linear theory holds")
    passage: ResonancePassage | None = internal("what ``acceleration`` asked for")

    @property
    @computed(coordinate("spring"))
    def springs(self) -> tuple[str, ...]:
        """Names of shafts, meshes and couplings; massless shafts in series count as one."""
        return self.nonlinear.shafts

    @property
    @computed(variable("", "rad/s"))
    def speed(self) -> float:
        """Input speed [rad/s]."""
        return self.nonlinear.speed

    @property
    def unit(self) -> str:
        """Unit that speeds are printed in: that of the line's description."""
        return self.nonlinear.unit

    @property
    @computed(variable("order spring", "N*m"))
    def difference(self) -> Array:
        """|linear − nonlinear| (order, spring) [N m], phases counted."""
        return np.abs(self.linear_torque - self.nonlinear_torque)

    @cached_property
    def largest(self) -> Array:
        """Largest order (spring,) [N m] of either response."""
        size = np.fmax(np.abs(self.linear_torque), np.abs(self.nonlinear_torque))
        return np.asarray(size.max(axis=0, initial=0.0))

    @cached_property
    @computed(variable("spring", "1"))
    def relative_difference(self) -> Array:
        """Largest difference over the largest order, spring by spring (spring,).

        A spring that vibrates less than a hundredth as much as the most loaded one is measured against that hundredth;
        0 where nothing vibrates.
        """
        against = np.maximum(self.largest, SMALL * self.largest.max(initial=0.0))
        if not self.nonlinear.outcome.ok or self.linear is None:
            return np.full(len(self.springs), np.nan)
        return np.asarray(self.difference.max(axis=0, initial=0.0) / np.where(against > 0, against, 1.0))

    @property
    @computed(variable("", "1"))
    def departure(self) -> float:
        """The largest relative difference of any spring; NaN where one of the two responses does not exist."""
        return float(np.max(self.relative_difference, initial=0.0))

    @property
    @computed(attribute())
    def holds(self) -> bool:
        """Whether linear theory holds: the motion exists, is not unstable, and departs by ``allowed`` at most."""
        return bool(self.departure <= self.allowed and self.nonlinear.verdict is not Verdict.UNSTABLE)

    @property
    @computed(variable("response spring", "N*m"))
    def peak_torque(self) -> Array:
        """Largest |torque| (2, spring) [N m] over the cycle: linear, nonlinear."""
        linear = self.linear.peak_torque[0] if self.linear is not None else np.full(len(self.springs), np.nan)
        return np.stack([linear, self.nonlinear.peak_torque])

    @property
    @computed(variable("response spring", "N*m"))
    def vibratory_torque(self) -> Array:
        """Half of the peak-to-peak torque (2, spring) [N m]: linear, nonlinear."""
        linear = self.linear.vibratory_torque[0] if self.linear is not None else np.full(len(self.springs), np.nan)
        return np.stack([linear, self.nonlinear.torque_amplitude])

    @cached_property
    def because(self) -> tuple[str, ...]:
        """What the line does there that linear equations do not have, gravest first; () where nothing stands out."""
        return tuple(_causes(self))

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What to read first, gravest first."""
        return self.findings_in(self.unit)

    def findings_in(self, unit: str) -> tuple[Finding, ...]:
        """What to read first, gravest first, speeds in ``unit``."""
        said = self.linear.remarks if self.linear is not None else ()
        return by_gravity([*_findings(self, unit), *said])

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, the passage and the ending."""
        yield from super().declared()
        yield Coordinate("response", ("linear", "nonlinear"), "response")
        if self.passage is not None:
            yield Variable("passing_vibration", self.passage.vibration, "spring", "N*m")
            yield Variable("passing_speed", self.passage.vibration_speed, "spring", "rad/s")
            yield Variable("passing_linear", self.passage.linear, "spring", "N*m")
            yield Attribute("passing_outcome", self.passage.kind)
        yield from attributes(because="; ".join(self.because))
        yield from ending(self.nonlinear.outcome)

    def plot(self, axes: Axes | None = None, *, spring: str | None = None, unit: str | None = None) -> Axes:
        """Both amplitudes of every order of one spring; see ``pictures.motion.linearity``."""
        return drawing(self, "plot")(self, axes, spring=spring, unit=unit)

    def describe(self, unit: str | None = None) -> str:
        """The result in a few lines, speeds in ``unit``, by default that of the line's description."""
        unit = unit or self.unit
        rows = [f"linear and nonlinear response at {show_speed(self.speed, unit)}"]
        if self.nonlinear.outcome.ok:
            rows += [self._of_spring(s) for s in range(len(self.springs))]
        rows += [f"  {finding}" for finding in self.findings_in(unit)]
        return "\n".join(rows)

    def _of_spring(self, s: int) -> str:
        (linear, true), name = self.vibratory_torque[:, s], self.springs[s]
        if not len(self.order) or self.largest[s] <= WORTH_SHOWING * self.largest.max():
            return f"  {name}: does not vibrate"
        k = int(np.argmax(self.difference[:, s]))
        return (
            f"  {name}: vibratory ±{linear:.4g} N m by linear theory, ±{true:.4g} N m nonlinear; order "
            f"{self.order[k]:.6g} differs most, {abs(self.linear_torque[k, s]):.4g} for "
            f"{abs(self.nonlinear_torque[k, s]):.4g} N m, apart by {100 * self.relative_difference[s]:.2g} % of the "
            "largest order"
        )

    def __str__(self) -> str:
        return self.describe()


def _causes(result: LinearityCheck) -> Iterator[str]:
    if result.linear is None or not result.nonlinear.outcome.ok:
        return
    for contact in result.nonlinear.contacts:
        if np.count_nonzero(contact.stage_shares > 0) > 1:
            if contact.rattles and _has_play(result, contact.spring):
                yield f"contact is lost, {contact}"
            else:
                yield f"{contact.spring} passes through more than one of its stages, of which linear theory has one"
    for one in result.stand_ins:
        if one.slipping:
            yield (
                f"{one.clutch} slips: linear theory has it at the stiffness and loss of this one swing, "
                f"±{angle_words(one.swing)}, which it does not find by itself"
            )
    for name, swing in zip(result.linear.joints, result.linear.joint_rotations[0], strict=True):
        if swing > LINEAR_RANGE:
            yield (
                f"the input of {name} swings by {angle_words(swing)}, beyond the linear range of "
                f"{angle_words(LINEAR_RANGE)}: its speed ratio moves with the vibration"
            )
    yield from _loads_by_speed(result)


def _has_play(result: LinearityCheck, spring: str) -> bool:
    """Whether the softest stage of a spring carries nothing."""
    line = result.nonlinear.line.assembly.line
    element = line.elements[line.index(spring)]
    slopes = getattr(element, "stiffnesses", ()) or (getattr(element, "stiffness_ratio", 0.0),)
    return min(slopes) == 0


def _loads_by_speed(result: LinearityCheck) -> Iterator[str]:
    """Disks with a load by the square of the speed that fluctuates too much for a tangent."""
    linear = result.linear
    assert linear is not None
    line, topo = result.nonlinear.line.assembly.line, result.nonlinear.line.assembly.topology
    for station, place in topo.disks:
        name = line.names[place]
        element = line.elements[place]
        assert isinstance(element, Rotor)
        if not element.loaded_by_square or name not in linear.inertias:
            continue
        fluctuation = float(linear.speed_fluctuation[0, linear.inertias.index(name)])
        share = fluctuation / (abs(float(topo.speed_ratio[station])) * result.speed)
        if share > FLUCTUATION:
            yield (
                f"the speed of {name} fluctuates by {100 * share:.0f} %, so that its load by "
                "the square of the speed is not its tangent"
            )


def _findings(result: LinearityCheck, unit: str) -> Iterator[Finding]:
    at = show_speed(result.speed, unit)
    if not result.nonlinear.outcome.ok:
        yield Finding(
            Gravity.CAUTION,
            f"No periodic motion was found at {at} ({result.nonlinear.outcome}), so that linear theory is not checked.",
        )
        return
    if not np.isfinite(result.departure):
        yield Finding(Gravity.DANGER, f"Linear theory has no steady state at {at}: undamped resonance.")
        return
    if result.nonlinear.verdict is Verdict.UNSTABLE:
        yield Finding(
            Gravity.DANGER,
            f"Both responses are of a motion at {at} that is unstable: a disturbance grows by "
            f"{result.nonlinear.growth_rate:.3g} 1/s, and neither is reached; ask tn.periodic_branch where it goes.",
        )
    yield _sentence(result, at)
    for one in result.stand_ins:
        doing = "sticks" if not one.slipping else f"slips ({one.slipping} of its sliders)"
        yield Finding(
            Gravity.NOTE,
            f"{one.clutch} {doing} and stands in the linear line as a shaft of {one.stiffness:.4g} N m/rad and "
            f"{one.damping:.4g} N m s/rad, its mean at ±{angle_words(one.swing)} and "
            f"{one.frequency / (2 * np.pi):.4g} Hz.",
        )
    if result.passage is not None:
        yield _passing(result.passage, unit)


def _sentence(result: LinearityCheck, at: str) -> Finding:
    share = 100 * result.departure
    if not result.largest.max(initial=0.0):
        return Finding(Gravity.NOTE, f"Nothing vibrates at {at}: there is nothing to compare.")
    if result.departure <= result.allowed:
        return Finding(Gravity.NOTE, f"Linear theory holds at {at}: no order is off by more than {share:.2g} %.")
    s = int(np.argmax(result.relative_difference))
    k = int(np.argmax(result.difference[:, s]))
    reason = "; ".join(result.because) or (
        "no single part stands out: what is left out is of second order in excitations and joint angles, which "
        "resonance magnifies"
    )
    return Finding(
        Gravity.CAUTION,
        f"Linear theory misleads at {at}: {order_words(result.order[k])} of {result.springs[s]} is "
        f"{abs(result.linear_torque[k, s]):.4g} N m by it and {abs(result.nonlinear_torque[k, s]):.4g} N m truly, "
        f"{share:.2g} % of the largest order apart, phases counted; {reason}.",
    )


def _passing(passage: ResonancePassage, unit: str) -> Finding:
    share = np.where(passage.linear > 0, passage.vibration / np.where(passage.linear > 0, passage.linear, 1.0), 0.0)
    s, rate = int(np.argmax(passage.vibration)), show_acceleration(passage.acceleration, unit)
    way = f"from {show_speed(passage.low, unit)} to {show_speed(passage.high, unit)}"
    passed = passage.ending is None or passage.kind == "reached"
    begin = f"Passed at {rate} {way}"
    if passage.ending is not None and not passed:
        begin = f"Run at {rate} {way} the line does not pass ({passage.ending.sentence(unit)}); until then"
    return Finding(
        Gravity.NOTE if passed else Gravity.CAUTION,
        f"{begin}, {passage.springs[s]} vibrates by {passage.vibration[s]:.4g} N m, at "
        f"{show_speed(float(passage.vibration_speed[s]), unit)}: {share[s]:.3g} times the {passage.linear[s]:.4g} N m "
        f"that linear theory gives where it is largest, at {show_speed(float(passage.linear_speed[s]), unit)}.",
    )


def linearity_check(
    line: Driveline,
    speed: float | str | None = None,
    load_case: str | None = None,
    *,
    allowed: float = 0.05,
    acceleration: float | None = None,
    start: ArrayLike | None = None,
    tolerance: float = TOLERANCE,
) -> LinearityCheck:
    """How far the linear response by order holds at a speed, and what misleads it.

    Parameters
    ----------
    line : the driveline.
    speed : input speed [rad/s]; default the operating speed of the file.
    load_case : name of one of the line's load cases.
    allowed : difference, relative to the largest order, up to which linear theory is said to hold.
    acceleration : [rad/s²]; the line is also run through the speed, from 20 % below to 20 % above, and what it
        reaches in passing stands beside the largest linear response in that range.
    start : a state (2n,) near the motion, where a line has several; by default as in ``periodic_response``.
    tolerance : error allowed per step of the nonlinear motion.

    Raises
    ------
    InputError : a line that one of the two analyses refuses; ``allowed`` not between 0 and 1.

    Examples
    --------
    >>> import trunnion as tn
    >>> engine = tn.Disk(inertia=0.2, excitation=[{"order": 2, "amplitude": 100.0}])
    >>> shaft = tn.Shaft(name="shaft", stiffness=1e4, damping=2.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=0.1), tn.Shaft(stiffness=2e4), engine, shaft,
    ...     tn.Disk(inertia=0.8)])
    >>> check = tn.linearity_check(line, 60.0)
    >>> check.holds, round(check.departure, 4)
    (True, 0.0047)
    """
    if not 0 < one_number(allowed, "allowed", "0.05 is 5 %") < 1:
        raise InputError("must be between 0 and 1", key="allowed", value=float(allowed), remedy="0.05 is 5 %")
    loaded = line if load_case is None else line.with_load(load_case)
    clutches = [name for name, one in loaded.parts if isinstance(one, Clutch) and one.friction]
    if not clutches:  # what linear equations refuse is refused before the motion is looked for
        order_response(loaded, [operating_speed(loaded, speed)])
    true = periodic_response(loaded, speed, start=start, tolerance=tolerance, compare=False)
    assert isinstance(true, PeriodicResponse)
    stand_ins = tuple(_linear_shaft(true, loaded, name) for name in clutches) if true.outcome.ok else ()
    linear_line = _without_friction(loaded, stand_ins) if true.outcome.ok else loaded
    linear = order_response(linear_line, [true.speed]) if true.outcome.ok or not clutches else None
    order, found, actual = _by_order(linear, true)
    return LinearityCheck(
        linear=linear,
        nonlinear=true,
        order=order,
        linear_torque=found,
        nonlinear_torque=actual,
        stand_ins=stand_ins,
        allowed=float(allowed),
        passage=None if acceleration is None else _passed(loaded, linear_line, true.speed, acceleration),
    )


def _by_order(linear: OrderResponse | None, true: PeriodicResponse) -> tuple[Array, Complex, Complex]:
    """Orders (order,) and torques (order, spring) [N m] of both; those that either shows."""
    springs = len(true.shafts)
    highest = float(ORDERS)
    if linear is not None and len(linear.order):
        highest = max(highest, float(np.abs(linear.order + linear.frequency / true.speed).max()))
    orders, actual = true.order_torque(highest)
    found = np.zeros((len(orders), springs), dtype=complex)
    if linear is None:
        found[:] = np.nan
    else:
        spectrum = linear.spectrum
        for k, frequency in enumerate(spectrum.angular_frequency[0]):
            place = round(abs(frequency) * true.period / (2 * np.pi))
            if place < len(orders):
                torque = spectrum.amplitude[0, k, spectrum.channels.torque]
                found[place] += torque if frequency >= 0 else np.conj(torque)
    size = np.fmax(np.abs(found), np.abs(actual))[1:]
    largest = np.nanmax(size, initial=0.0) if np.isfinite(size).any() else 0.0
    with np.errstate(invalid="ignore"):
        shown = 1 + np.flatnonzero(np.any(size > WORTH_SHOWING * largest, axis=1))
    return orders[shown], found[shown], actual[shown]


def _linear_shaft(true: PeriodicResponse, line: Driveline, name: str) -> LinearShaft:
    """What stands for a clutch: its mean stiffness and loss at the swing and leading frequency that it has."""
    clutch = line.elements[line.index(name)]
    assert isinstance(clutch, Clutch)
    place = next(e for e, c in enumerate(true.line.assembly.topology.compliances) if line.index(name) in c.shafts)
    run = true.trajectory

    def twist(times: Array) -> Array:
        return true.line.observe(true.system, times, run.at(times)).twist[:, place : place + 1]

    swing = float(extremes(twist, run.time_of_state).span[0]) / 2
    cycles = np.abs(fourier(twist, run.time_of_state, max(int(ORDERS * true.turns), 1))[1:, 0])
    frequency = 2 * np.pi * (1 + int(np.argmax(cycles))) / true.period
    torque = float(true.torque_mean[place])
    stiffness, damping, _ = clutch.mean(max(swing, STUCK), frequency, torque)
    slips = tuple(s.torque for s in clutch.friction if swing > s.torque / s.stiffness)
    return LinearShaft(name, swing, frequency, torque, float(stiffness), float(damping), len(slips))


def _without_friction(line: Driveline, stand_ins: tuple[LinearShaft, ...]) -> Driveline:
    """The line with a Shaft in the place of every clutch."""
    elements = list(line.elements)
    for one in stand_ins:
        clutch = line.elements[line.index(one.clutch)]
        assert isinstance(clutch, Clutch)
        stand_in = clutch.linear(max(one.swing, STUCK), one.frequency, one.torque)
        elements[line.index(one.clutch)] = stand_in.model_copy(update={"name": one.clutch})
    return line.model_copy(update={"elements": tuple(elements)})


def _passed(line: Driveline, linear_line: Driveline, speed: float, acceleration: float) -> ResonancePassage:
    """A run through the speed, and the largest linear response on its way."""
    low, high = speed * (1 - WIDTH), speed * (1 + WIDTH)
    run = run_up(line, low, high, acceleration=acceleration, steady=0)
    run.outcome.require()
    speeds = sweep_speeds(linear_line, low, high, PASSED)
    steady = order_response(linear_line, speeds).vibratory_torque
    return ResonancePassage(
        run.shafts, low, high, run.acceleration, run.peak_vibration, run.vibration_speed,
        np.nanmax(steady, axis=0), speeds[np.nanargmax(steady, axis=0)], run.ending,
    )  # fmt: skip
