"""``periodic_response``: the true periodic motion of a line, its torques and its stability.

The linear charts judge a line about the motion of rigid shafts. Here the line's own periodic motion is found by
shooting and judged by its own variational equations, so that loads, resonance and large angles are right; what
the two linearisations say is stated beside it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Complex
from trunnion.driveline.clutches import Clutch
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import operating_speed, speed_unit
from trunnion.driveline.slip_clutches import SlipClutch
from trunnion.equations.clutch_capacity import carries_static_torque, refuse_overload
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_system import LineMotion, LineSystem, line_system
from trunnion.equations.loads import given_shares
from trunnion.equations.steady_base import (
    has_joint_angles,
    imbalance,
    loaded_by_speed,
    refuse_dragged,
    require_balance,
    torques_in_words,
)
from trunnion.errors import ComputationError, InputError
from trunnion.floquet.stability.stability import Stability, stability
from trunnion.motion.orbits.clutches import StuckClutch, Watched, continuum, slipping_on
from trunnion.motion.orbits.spring_contacts import SpringContact, spring_contacts
from trunnion.motion.simulation.held_clutches import held_torques, require_held
from trunnion.motion.simulation.simulate import simulate_system
from trunnion.motion.simulation.simulation import OfShafts
from trunnion.numerics.curves import Extremes, extremes, fourier
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import computed, coordinate, internal, labelled, variable
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.results.of_systems import ending
from trunnion.results.outcome import Outcome
from trunnion.results.result import Result
from trunnion.results.units import mean_and_swing
from trunnion.results.variables import Attribute, Coordinate, Variable, attributes
from trunnion.results.verdict import MEANING, Verdict
from trunnion.steady.shooting.free_orbit import (
    kept_speed_orbit,
    require_periodic,
    torque_driven_orbit,
)
from trunnion.steady.shooting.periodic_orbit import (
    TOLERANCE,
    IntegratedOrbit,
    PeriodicOrbit,
    periodic_orbit,
    shooting_problem,
    speed_in_words,
)
from trunnion.systems.maps import SETTLED, IntegratedMap
from trunnion.systems.system import System

FEWEST_SAMPLES = 2048
"""Of the torque over a period, as it is shown; with more than half as many steps it has more."""
ORDERS = 12


@dataclass(frozen=True)
class LinearComparison:
    """The same line linearised: about zero twist and about the twist of its static load.

    growth_rate [1/s] of the true motion and of the two linearisations; torque_peak_to_peak (shaft,) [N m] of the
    true motion and of the linear steady response about static twist.
    """

    growth_rate: float
    zero_twist: Stability
    static_twist: Stability
    torque_peak_to_peak: Array
    linear_torque_peak_to_peak: Array
    shafts: tuple[str, ...]

    @property
    def agree(self) -> bool:
        """Whether all three say the same about stability."""
        signs = {np.sign(round(v, 9)) for v in (self.growth_rate, self.zero_twist.growth_rate)}
        return len(signs | {np.sign(round(self.static_twist.growth_rate, 9))}) == 1

    def __str__(self) -> str:
        worst = int(np.argmax(self.torque_peak_to_peak))
        return (
            f"growth rate {self.growth_rate:+.6g} 1/s here, {self.zero_twist.growth_rate:+.6g} linearised about zero "
            f"twist, {self.static_twist.growth_rate:+.6g} about the static twist; torque of {self.shafts[worst]} "
            f"{self.torque_peak_to_peak[worst]:.5g} N m peak to peak here, "
            f"{self.linear_torque_peak_to_peak[worst]:.5g} by linear theory"
        )


def compared(
    speed: float, line: Driveline, growth_rate: float, peak_to_peak: Array, shafts: tuple[str, ...]
) -> LinearComparison:
    """The comparison of a motion at ``speed`` [rad/s], with its growth rate and torques (shaft,) [N m] peak to peak.

    Raises
    ------
    InputError : the linear equations do not have what the line has.
    """
    static = stability(line, speed)
    if static.response is None:
        raise ComputationError(f"no linear response: {static.no_response}")
    return LinearComparison(
        growth_rate,
        stability(line, speed, statically_twisted=False),
        static,
        peak_to_peak,
        2 * static.response.torque_amplitude,
        shafts,
    )


@labelled
class PeriodicResponse(Result, OfShafts, IntegratedOrbit):
    """The periodic motion of a line at one speed; stability is that of this motion itself."""

    residual: float = internal("of the period, in units of the states' scale")
    line: LineSystem = internal("that moves")
    speed: float = variable("", "rad/s")
    unit: str = internal("of speeds in print")
    comparison: LinearComparison | None = internal("with the linearisations, None where there is none", default=None)
    no_comparison: str = internal("why there is none", default="not asked for")

    @classmethod
    def of_line(cls, orbit: IntegratedOrbit, line: LineSystem, speed: float, **more: Any) -> PeriodicResponse:
        """The orbit of a line as its response."""
        return cls.of(orbit, line=line, speed=speed, unit=speed_unit(line.assembly.line), **more)

    @property
    def orbit(self) -> PeriodicOrbit:
        """The same as the orbit of a system, its states in place of torques."""
        return PeriodicOrbit.of(self)

    @property
    def turns(self) -> float:
        """Period in turns of the input."""
        return self.period * self.speed / (2 * np.pi)

    @cached_property
    @computed(coordinate("time", "s"))
    def time(self) -> Array:
        """Times (points,) over one period, its end left out [s]: enough to show every swing."""
        count = max(FEWEST_SAMPLES, 1 << int(np.ceil(np.log2(2 * max(self.trajectory.steps, 1)))))
        return np.asarray(self.trajectory.time_of_state[0] + self.period * np.arange(count) / count)

    def motion_at(self, time: ArrayLike) -> LineMotion:
        """Twists, torques and rotations at times (m,) of the motion; NaN where none was found."""
        times = np.atleast_1d(np.asarray(time, dtype=float))
        states = self.trajectory.at(times) if self.outcome.ok else np.full((len(times), self.system.size), np.nan)
        return self.line.observe(self.system, times, states)

    @cached_property
    def _torque_extremes(self) -> Extremes:
        return extremes(lambda times: self.motion_at(times).torque, self.trajectory.time_of_state)

    @property
    @computed(variable("shaft", "N*m"))
    def torque_peak_to_peak(self) -> Array:
        """Largest minus smallest torque of every shaft [N m], found on the dense output to its own error (about ten
        times the tolerance); NaN where no motion was found."""
        return self._torque_extremes.span if self.outcome.ok else np.full(len(self.shafts), np.nan)

    @property
    @computed(variable("shaft", "N*m"))
    def peak_torque(self) -> Array:
        """Largest |torque| of every shaft [N m] over the period; NaN where no motion was found."""
        return self._torque_extremes.largest if self.outcome.ok else np.full(len(self.shafts), np.nan)

    @property
    def torque_amplitude(self) -> Array:
        """Half of the peak-to-peak torque [N m]."""
        return self.torque_peak_to_peak / 2

    @cached_property
    @computed(variable("shaft", "N*m"))
    def torque_mean(self) -> Array:
        """Mean torque of every shaft [N m]; negative when power flows from input to output."""
        return np.asarray(self.order_torque(0)[1][0].real)

    @cached_property
    def continuum(self) -> tuple[StuckClutch, ...]:
        """The clutches with sliders that never slip, which make the motion one of a continuum, and its range."""
        return _continuum(self.line, self) if self.stuck else ()

    @cached_property
    def contacts(self) -> tuple[SpringContact, ...]:
        """What gear meshes with backlash and shafts with stages do: sides touched, time in the play, impacts."""
        return spring_contacts(self.line, self)

    def order_torque(self, highest: float = ORDERS) -> tuple[Array, Complex]:
        """Orders (k,) in cycles per turn of the input, and complex torques (k, shaft) [N m]; order 0 is the mean.

        A torque is Re[Y e^{i·order·Ωt}], its phase that of a cosine at zero rotation of the input, as in
        ``order_response``; of a free–free line, where the input is without vibration. Fourier integrals over
        the dense output, so that what is above ``highest`` does not appear below it; their error is that of the
        motion. NaN where no motion was found.
        """
        count = int(np.floor(highest * self.turns + 1e-9)) + 1
        orders = np.arange(count) / self.turns
        if not self.outcome.ok:
            return orders, np.full((count, len(self.shafts)), np.nan, dtype=complex)
        times = self.trajectory.time_of_state
        found = fourier(lambda times: self.motion_at(times).torque, times, count - 1)
        begun = self.speed * times[0]
        if self.line.assembly.topology.free:  # a shift of time is not a change there: count from where the input turns
            begun += float(fourier(lambda times: self.motion_at(times).rotation[:, :1], times, 0)[0, 0].real)
        return orders, np.asarray(found * np.exp(-1j * orders * begun)[:, None])

    def order_spectrum(self, highest: float = ORDERS) -> tuple[Array, Array]:
        """Orders (k,) in cycles per turn of the input, and torque amplitudes (k, shaft) [N m]: the sizes of
        ``order_torque``."""
        orders, torque = self.order_torque(highest)
        return orders, np.abs(torque)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What to read first, gravest first."""
        return by_gravity(_findings(self))

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, the orders of torques and the ending."""
        yield from super().declared()
        orders, amplitude = self.order_spectrum()
        yield Coordinate("order", orders, "order", "1", "cycles per turn of the input")
        yield Variable("order_amplitude", amplitude, "order shaft", "N*m")
        yield from attributes(driveline=self.system.name, continuum="; ".join(map(str, self.continuum)))
        yield from attributes(comparison=str(self.comparison or self.no_comparison))
        yield from ending(self.outcome)

    def plot(self, axes: Axes | None = None, *, unit: str = "") -> Axes:
        """Torque of every shaft over one period; see ``pictures.motion``."""
        return drawing(self, "plot")(self, axes, unit=unit)

    def plot_orders(self, axes: Axes | None = None, *, highest: float = 12.0) -> Axes:
        """Torque amplitude of every order; see ``pictures.motion``."""
        return drawing(self, "plot_orders")(self, axes, highest=highest)

    def __str__(self) -> str:
        at = self.words.speed(self.speed)
        if not self.outcome.ok:
            return f"no periodic motion found at {at}: {self.outcome}"
        rows = [
            f"  {name}: torque {mean_and_swing(mean, peak, 'N m')}"
            for name, mean, peak in zip(self.shafts, self.torque_mean, self.torque_peak_to_peak, strict=True)
        ]
        against = f"linear theory: {self.comparison or self.no_comparison}"
        return "\n".join(
            [
                f"{self.verdict} periodic motion at {at}, period {self.turns:.6g} turns: {MEANING[self.verdict]}",
                f"  {self.radius_in_words}, growth rate {self.growth_rate:+.6g} 1/s",
                *rows,
                *(f"  {contact}" for contact in self.contacts),
                *(f"  {clutch}" for clutch in self.continuum),
                *([f"  {speed_in_words(self)}"] if np.isfinite(self.speed_multiplier) else []),
                f"  {against}",
                f"  {self.outcome}",
            ]
        )


def periodic_response(
    line: Driveline | Assembly | System,
    speed: float | str | None = None,
    *,
    start: ArrayLike | None = None,
    period: float | None = None,
    periods: int = 1,
    tolerance: float = TOLERANCE,
    settle: bool = True,
    compare: bool = True,
) -> PeriodicResponse | PeriodicOrbit:
    """The periodic motion of a line (or of any system) and its stability.

    Parameters
    ----------
    line : a ``Driveline`` (or its ``Assembly``), or a ``System``.
    speed : input speed [rad/s]; default the operating speed of the file. Of a free–free line, its mean speed,
        kept by the disks with a drive_share; where none has one, a guess of the speed that its torques lead to.
    start : a state near the motion (2n,): deviations from uniform rotation [rad], then their rates [rad/s]; by default
        that of rigid shafts.
    period : of an autonomous ``System``, a guess [s].
    periods : of the excitation in one period of the motion (a subharmonic of that order).
    tolerance : error allowed per step of the integration.
    settle : integrate some hundred periods where shooting fails from ``start``.
    compare : also linearise, and say how far off that is.

    Returns
    -------
    PeriodicResponse, of a ``System`` PeriodicOrbit; its ``outcome`` says whether a periodic motion was found.

    Raises
    ------
    InputError : no speed; a line whose excitations have no common period, or, where it is free–free, act in time; a
        clutch that carries more than its friction holds and no spring takes; a start beyond what its friction holds.

    Examples
    --------
    >>> import trunnion as tn
    >>> shaft = tn.Shaft(stiffness=1e3, damping=2.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=0.2), shaft, tn.Disk(inertia=0.4)])
    >>> found = tn.periodic_response(line, 20.0)
    >>> str(found.verdict), found.torque_peak_to_peak.round(2)
    ('stable', array([35.06]))
    """
    if isinstance(line, System):
        if speed is not None:
            raise InputError("belongs to a driveline", key="speed", value=speed, remedy="leave it out")
        return periodic_orbit(line, start=start, period=period, periods=periods, tolerance=tolerance, settle=settle)
    description = line.line if isinstance(line, Assembly) else line
    prepared = line_system(line, operating_speed(description, speed), swing=True)
    refuse_dragged(prepared.assembly)
    if prepared.assembly.topology.free:
        response = _free(prepared, start, tolerance, settle)
        _require_held(response)
        return response
    require_forced(prepared)
    if carries_static_torque(prepared.assembly):
        refuse_overload(prepared.assembly, prepared.speed)
    orbit = _forced(prepared, start, periods, tolerance, settle)
    if not orbit.outcome.ok and prepared.sliders:
        refuse_overload(prepared.assembly, prepared.speed)
        orbit = replace(orbit, outcome=_slipping_on(prepared, periods) or orbit.outcome)
    response = PeriodicResponse.of_line(orbit, prepared, prepared.speed)
    _require_held(response)
    if not compare or not orbit.outcome.ok:
        return response
    try:
        comparison = compared(
            response.speed, description, response.growth_rate, response.torque_peak_to_peak, response.shafts
        )
    except (InputError, ComputationError) as error:
        return replace(response, no_comparison=f"does not apply ({error})")
    return replace(response, comparison=comparison, no_comparison="")


def _require_held(found: PeriodicResponse) -> None:
    """Refuse a motion in which a slip clutch does not stick."""
    if found.outcome.ok and any(isinstance(one, SlipClutch) for one in found.line.assembly.line.elements):
        cuts, at = found.trajectory.time_of_state, found.trajectory.at
        require_held(
            found.line, lambda times: held_torques(found.line, found.system, times, at(times)), cuts,
            "the periodic motion in which it sticks",
        )  # fmt: skip


def _forced(
    prepared: LineSystem, start: ArrayLike | None, periods: int, tolerance: float, settle: bool
) -> IntegratedOrbit:
    """The motion of a driven line; soft lines under load lie far from rest, but near their static twist."""
    first = prepared.rest() if start is None else prepared.system.checked_start(start)
    carries = start is None and bool(np.any(prepared.twisted() != first))
    orbit = periodic_orbit(
        prepared.system, start=first, periods=periods, tolerance=tolerance, settle=settle and not carries
    )
    if orbit.outcome.ok or not carries:
        return orbit
    return periodic_orbit(
        prepared.system, start=prepared.twisted(), periods=periods, tolerance=tolerance, settle=settle
    )


def _free(prepared: LineSystem, start: ArrayLike | None, tolerance: float, settle: bool) -> PeriodicResponse:
    """A free line: its drives keep the mean speed, or where none has a share its torques lead to one."""
    assembly = prepared.assembly
    row = assembly.table(1, prepared.speed)
    shares = given_shares(assembly.topology, assembly.packed.column, row).any()
    # Constant torques that balance lead to no speed of their own.
    if shares or not (loaded_by_speed(assembly) or imbalance(assembly, row)[0]):
        orbit = kept_speed_orbit(prepared, start, tolerance=tolerance, settle=settle)
        if not orbit.outcome.ok:
            refuse_overload(assembly, prepared.speed)
        words = (
            "does not apply (the line is free–free; beyond the balance of its loads its drives give "
            f"{orbit.values[-1]:.4g} N m at the input)"
        )
        return PeriodicResponse.of_line(orbit, prepared, prepared.speed, no_comparison=words)
    return _torque_driven(prepared, start, tolerance, settle)


def _torque_driven(prepared: LineSystem, start: ArrayLike | None, tolerance: float, settle: bool) -> PeriodicResponse:
    """A free line without shares: its mean speed is found with the motion, from the speed given as a guess."""
    require_periodic(prepared)
    row = prepared.assembly.table(1, prepared.speed)
    left = float(imbalance(prepared.assembly, row)[0])
    if left > 0 and not loaded_by_speed(prepared.assembly):
        require_balance(prepared.assembly, row)  # nothing but dampers could drive it
    speed = prepared.speed
    first = prepared.twisted() if start is None else prepared.system.checked_start(start)
    orbit = torque_driven_orbit(prepared, speed, first, tolerance=tolerance)
    if not orbit.outcome.ok and settle:
        run = simulate_system(prepared.system, periods=400, start=first, tolerance=1e-8, dense=False)
        n = prepared.assembly.topology.size
        speed += float(run.final[n])
        if run.outcome.ok and speed > 0:
            twisted = line_system(prepared.assembly, speed).twisted()
            orbit = torque_driven_orbit(prepared, speed, twisted, tolerance=tolerance)
    if not orbit.outcome.ok and left:
        words = f"{orbit.outcome.sentence}; {torques_in_words(prepared.assembly, row[0])}"
        orbit = replace(orbit, outcome=Outcome(False, orbit.outcome.kind, words))
    words = "does not apply (the line is free–free: its speed is a result, not given)"
    return PeriodicResponse.of_line(orbit, prepared, orbit.values[-1], no_comparison=words)


def _continuum(line: LineSystem, orbit: IntegratedOrbit) -> tuple[StuckClutch, ...]:
    """The clutches with sliders that never slip in a motion of the line."""
    system = orbit.system
    assert system.forcing_period is not None
    place = IntegratedMap.of(system, periods=round(orbit.period / system.forcing_period), tolerance=TOLERANCE)
    problem = shooting_problem(place.holding(tuple(map(system.sliders.index, orbit.stuck))))

    def watch(place: IntegratedMap, start: Array) -> Watched:
        run = place(start, tangents=False, dense=True).run
        seen = extremes(lambda times: run.at(times)[:, -place.sliders :], run.time_of_state)
        mean = fourier(lambda times: line.observe(system, times, run.at(times)).twist, run.time_of_state, 0)
        return Watched(seen.low, seen.high, mean[0].real)

    return continuum(line.assembly, line.sliders, problem, orbit.start, watch, _shifts_alike(line, problem.map.fixed))


def _shifts_alike(line: LineSystem, stuck: tuple[int, ...]) -> bool:
    """Whether the motion only shifts with the mean twist of the clutches that these sliders are of: the joints are
    straight, the springs have one stage, and no torque by order acts where their twist has turned it. Without a spring
    the clutch may be turned as a whole, as its start is anyway."""
    topo, elements = line.assembly.topology, line.assembly.line.elements
    clutches = [elements[topo.compliances[line.sliders[i].compliance].shafts[0]] for i in stuck]
    springs = [clutch.stiffnesses for clutch in clutches if isinstance(clutch, Clutch)]
    by_order = any(one.order for one in line.torques)
    if has_joint_angles(line.assembly) or any(len(stiffnesses) > 1 for stiffnesses in springs):
        return False
    return not by_order or not any(map(any, springs))


def _slipping_on(line: LineSystem, periods: int) -> Outcome | None:
    """What to say of a line where no motion was found because a clutch slips on with every period; None elsewhere."""
    place = IntegratedMap.of(line.system, periods=periods, tolerance=SETTLED)

    def twists(states: Array) -> Array:
        return line.observe(line.system, np.zeros(len(states)), states).twist

    return slipping_on(line.assembly, line.speed, line.sliders, place, line.rest(), twists)


def require_forced(line: LineSystem) -> None:
    """Refuse a line whose motion has no period given from outside."""
    if line.assembly.topology.free:
        raise InputError(
            "is free–free: its speed follows from its torques and is not periodic in time",
            element="driveline",
            remedy="put a ConstantSpeed in front, or simulate it",
        )
    if line.period_turns is None or line.system.forcing_period is None:
        raise InputError(
            "has excitations without a common period of usable length",
            element="driveline",
            key="excitation",
            remedy="give orders, or a frequency in a simple ratio to the speed; or simulate it",
        )


def _findings(result: PeriodicResponse) -> list[Finding]:
    at = result.words.speed(result.speed)
    if not result.outcome.ok:
        return [Finding(Gravity.CAUTION, f"No periodic motion was found at {at}: {result.outcome}.")]
    found = []
    worst = int(np.argmax(result.torque_peak_to_peak))
    torque = (
        f"the torque of {result.shafts[worst]} swings by {result.torque_peak_to_peak[worst]:.4g} N m peak to peak "
        f"about {result.torque_mean[worst]:.4g} N m"
    )
    if result.verdict is Verdict.UNSTABLE:
        doubling = np.log(2) / result.growth_rate
        found.append(
            Finding(
                Gravity.DANGER,
                f"The periodic motion at {at} is unstable: a disturbance doubles every {doubling:.3g} s.",
            )
        )
    else:
        found.append(Finding(Gravity.NOTE, f"The periodic motion at {at} is {result.verdict}; {torque}."))
    rattling = [contact for contact in result.contacts if contact.rattles]
    found += [Finding(Gravity.NOTE, f"At {at} {clutch}.") for clutch in result.continuum]
    found += [Finding(Gravity.CAUTION, f"At {at} contact is lost: {contact}.") for contact in rattling]
    comparison = result.comparison
    if comparison is not None and not comparison.agree:
        found.append(
            Finding(
                Gravity.CAUTION,
                f"Linear theory misjudges the motion at {at}: {comparison}.",
            )
        )
    return found
