"""``periodic_response``: the true periodic motion of a line, its torques and its stability.

The linear charts judge a line about the motion of rigid shafts. Here the line's own periodic motion is found by
shooting and judged by its own variational equations, so that loads, resonance and large angles are right; what
the two linearisations say is stated beside it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Complex
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import operating_speed, speed_unit
from trunnion.equations.clutch_capacity import carries_static_torque, refuse_overload
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_system import LineMotion, LineSystem, line_system
from trunnion.equations.loads import given_shares
from trunnion.equations.steady_base import imbalance, refuse_dragged, require_balance, torques_in_words
from trunnion.errors import ComputationError, InputError
from trunnion.motion.orbits.linear_comparison import LinearComparison, compared
from trunnion.motion.orbits.rubbing_clutches import continuum_of, slipping_on
from trunnion.motion.orbits.spring_contacts import SpringContact, spring_contacts
from trunnion.motion.orbits.stuck_clutches import StuckClutch
from trunnion.motion.simulation.simulation import simulate_system
from trunnion.numerics.curves import Extremes, extremes, fourier
from trunnion.results.declared import Held, Judged, axis, ending, fields_over, over, remark, remarks
from trunnion.results.drawing import Axes, drawing
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.results.outcome import Outcome
from trunnion.results.speeds import show_speed
from trunnion.results.units import with_error
from trunnion.results.verdict import MEANING, Verdict
from trunnion.steady.shooting.free_orbit import (
    kept_speed_orbit,
    loaded_by_speed,
    require_closing,
    torque_driven_orbit,
)
from trunnion.steady.shooting.periodic_orbit import TOLERANCE, PeriodicOrbit, periodic_orbit, speed_in_words
from trunnion.systems.system import System

FEWEST_SAMPLES = 2048
"""Of the torque over a period, as it is shown; with more than half as many steps it has more."""
ORDERS = 12


@dataclass(frozen=True, repr=False)
class PeriodicResponse(Judged):
    """The periodic motion of a line at one speed.

    torque and twist (points, shaft) over one period at ``time`` (points,); torque_peak_to_peak and torque_mean
    (shaft,) [N m]; multipliers, spectral_radius, growth_rate and verdict of this motion itself; comparison with
    the linearisations (None where the linear equations do not have what the line has, see ``no_comparison``).
    """

    line: LineSystem
    speed: float
    orbit: PeriodicOrbit
    comparison: LinearComparison | None
    no_comparison: str

    @property
    def unit(self) -> str:  # type: ignore[override]
        """Unit that speeds are printed in: that of the line's description."""
        return speed_unit(self.line.assembly.line)

    @property
    def outcome(self) -> Outcome:
        """Whether a periodic motion was found, in a sentence."""
        return self.orbit.outcome

    @property
    def shafts(self) -> tuple[str, ...]:
        """Names of the shafts; massless shafts in series count as one."""
        return self.line.shafts

    @property
    def period(self) -> float:
        """Period [s]."""
        return self.orbit.period

    @property
    def turns(self) -> float:
        """Period in turns of the input."""
        return self.period * self.speed / (2 * np.pi)

    @property
    def multipliers(self) -> Complex:
        """Multipliers (2n,) of the motion over its period, by falling modulus."""
        return self.orbit.multipliers

    @property
    def spectral_radius(self) -> float:
        """Largest modulus of a multiplier."""
        return self.orbit.spectral_radius

    @property
    def error_estimate(self) -> float:
        """Bound on the error of the spectral radius."""
        return self.orbit.error_estimate

    @property
    def growth_rate(self) -> float:
        """Growth of the fastest disturbance [1/s]."""
        return self.orbit.growth_rate

    @property
    def verdict(self) -> Verdict:
        """Stable, unstable, marginal or undecided."""
        return self.orbit.verdict

    @cached_property
    def time(self) -> Array:
        """Times (points,) over one period, its end left out [s]: enough to show every swing."""
        count = max(FEWEST_SAMPLES, 1 << int(np.ceil(np.log2(2 * max(self.orbit.trajectory.steps, 1)))))
        return self.orbit.time[0] + self.period * np.arange(count) / count

    @cached_property
    def motion(self) -> LineMotion:
        """Twists, torques and rotations at ``time``."""
        return self._at(self.time)

    def _at(self, times: Array) -> LineMotion:
        return self.line.observe(self.orbit.system, times, self.orbit.trajectory.at(times))

    @property
    def twist(self) -> Array:
        """Twist [rad] of every shaft (points, shaft)."""
        return self.motion.twist

    @property
    def torque(self) -> Array:
        """Torque [N m] of every shaft (points, shaft), positive with the twist."""
        return self.motion.torque

    @cached_property
    def _torque_extremes(self) -> Extremes:
        return extremes(lambda times: self._at(times).torque, self.orbit.trajectory.time_of_state)

    @property
    def torque_peak_to_peak(self) -> Array:
        """Largest minus smallest torque of every shaft [N m], found on the dense output to its own error (about ten
        times the tolerance); NaN where no motion was found."""
        return self._torque_extremes.span if self.outcome.ok else np.full(len(self.shafts), np.nan)

    @property
    def peak_torque(self) -> Array:
        """Largest |torque| of every shaft [N m] over the period; NaN where no motion was found."""
        return self._torque_extremes.largest if self.outcome.ok else np.full(len(self.shafts), np.nan)

    @property
    def torque_amplitude(self) -> Array:
        """Half of the peak-to-peak torque [N m]."""
        return self.torque_peak_to_peak / 2

    @cached_property
    def torque_mean(self) -> Array:
        """Mean torque of every shaft [N m]; negative when power flows from input to output."""
        return np.asarray(self.order_torque(0)[1][0].real)

    @property
    def stuck(self) -> tuple[str, ...]:
        """Names of the sliders that never slip."""
        return self.orbit.stuck

    @cached_property
    def continuum(self) -> tuple[StuckClutch, ...]:
        """The clutches with sliders that never slip, which make the motion one of a continuum, and its range."""
        return continuum_of(self.line, self.orbit)

    @cached_property
    def contacts(self) -> tuple[SpringContact, ...]:
        """What gear meshes with backlash and shafts with stages do: sides touched, time in the play, impacts."""
        return spring_contacts(self.line, self.orbit)

    def order_torque(self, highest: float = ORDERS) -> tuple[Array, Complex]:
        """Orders (k,) in cycles per turn of the input, and complex torques (k, shaft) [N m]; order 0 is the mean.

        A torque is Re[Y e^{i·order·Ωt}], its phase that of a cosine at zero rotation of the input, as in
        ``order_response``; of a line that starts free, where the input is without vibration. Fourier integrals over
        the dense output, so that what is above ``highest`` does not appear below it; their error is that of the
        motion. NaN where no motion was found.
        """
        count = int(np.floor(highest * self.turns + 1e-9)) + 1
        orders = np.arange(count) / self.turns
        if not self.outcome.ok:
            return orders, np.full((count, len(self.shafts)), np.nan, dtype=complex)
        times = self.orbit.trajectory.time_of_state
        found = fourier(lambda times: self._at(times).torque, times, count - 1)
        begun = self.speed * times[0]
        if self.line.assembly.topology.free:  # a shift of time is no change there: count from where the input turns
            begun += float(fourier(lambda times: self._at(times).rotation[:, :1], times, 0)[0, 0].real)
        return orders, np.asarray(found * np.exp(-1j * orders * begun)[:, None])

    def order_spectrum(self, highest: float = ORDERS) -> tuple[Array, Array]:
        """Orders (k,) in cycles per turn of the input, and torque amplitudes (k, shaft) [N m]: the sizes of
        ``order_torque``."""
        orders, torque = self.order_torque(highest)
        return orders, np.abs(torque)

    def findings_in(self, unit: str) -> tuple[Finding, ...]:
        """What to read first, speeds in ``unit``."""
        return by_gravity(_findings(self, unit))

    def declared(self) -> Iterator[Held]:
        """Twist and torque over one period, their orders, and the multipliers."""
        orders, amplitude = self.order_spectrum()
        yield axis("time", self.time, "s")
        yield axis("shaft", self.shafts)
        yield axis("order", orders, "1", "cycles per turn of the input")
        yield from fields_over("time shaft", self, twist="rad", torque="N*m")
        yield from fields_over("shaft", self, torque_peak_to_peak="N*m", peak_torque="N*m", torque_mean="N*m")
        yield over("order shaft", "order_amplitude", amplitude, "N*m")
        yield over("multiplier_number", "multiplier", self.multipliers, "1")
        yield over("multiplier_number", "multiplier_error", self.orbit.multiplier_error, "1")
        yield from fields_over("", self, spectral_radius="1", growth_rate="1/s", period="s", speed="rad/s")
        yield from remarks(driveline=self.orbit.system.name, verdict=str(self.verdict))
        yield from ending(self.outcome)
        yield from remarks(continuum="; ".join(map(str, self.continuum)))
        yield remark("comparison", str(self.comparison or self.no_comparison))

    def plot(self, axes: Axes | None = None, *, unit: str = "") -> Axes:
        """Torque of every shaft over one period; see ``trunnion.plots.motion``."""
        return drawing(self, "plot")(self, axes, unit=unit)

    def plot_orders(self, axes: Axes | None = None, *, highest: float = 12.0) -> Axes:
        """Torque amplitude of every order; see ``trunnion.plots.motion``."""
        return drawing(self, "plot_orders")(self, axes, highest=highest)

    def describe(self, unit: str | None = None) -> str:
        """The result in a few lines, speeds in ``unit``, by default that of the line's description."""
        at = show_speed(self.speed, unit or self.unit)
        if not self.outcome.ok:
            return f"no periodic motion found at {at}: {self.outcome}"
        rows = [
            f"  {name}: torque {mean:.6g} N m, {peak:.6g} N m peak to peak"
            for name, mean, peak in zip(self.shafts, self.torque_mean, self.torque_peak_to_peak, strict=True)
        ]
        against = f"linear theory: {self.comparison or self.no_comparison}"
        return "\n".join(
            [
                f"{self.verdict} periodic motion at {at}, period {self.turns:.6g} turns: {MEANING[self.verdict]}",
                f"  spectral radius {with_error(self.spectral_radius, self.error_estimate, beside=1.0)}, growth rate "
                f"{self.growth_rate:+.6g} 1/s",
                *rows,
                *(f"  {contact}" for contact in self.contacts),
                *(f"  {clutch}" for clutch in self.continuum),
                *([f"  {speed_in_words(self.orbit)}"] if np.isfinite(self.orbit.speed_multiplier) else []),
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
    line : a driveline, or a ``System``.
    speed : input speed [rad/s]; default the operating speed of the file. Of a line that starts free, its mean speed,
        kept by the disks with a drive_share; where none has one, a guess of the speed that its torques lead to.
    start : a state near the motion (2n,); by default that of rigid shafts.
    period : of an autonomous ``System``, a guess [s].
    periods : of the excitation in one period of the motion (a subharmonic of that order).
    settle : integrate some hundred periods where shooting fails from ``start``.
    compare : also linearise, and say how far off that is.

    Returns
    -------
    A result whose ``outcome`` says whether a periodic motion was found.

    Raises
    ------
    InputError : no speed; a line whose excitations have no common period, or, where it starts free, act in time; a
        clutch that carries more than its friction holds and no spring takes; a start beyond what its friction holds.
    """
    if isinstance(line, System):
        if speed is not None:
            raise InputError("belongs to a driveline", key="speed", value=speed, remedy="leave it out")
        return periodic_orbit(line, start=start, period=period, periods=periods, tolerance=tolerance, settle=settle)
    description = line.line if isinstance(line, Assembly) else line
    prepared = line_system(line, operating_speed(description, speed))
    refuse_dragged(prepared.assembly)
    if prepared.assembly.topology.free:
        return _free(prepared, start, tolerance, settle)
    require_forced(prepared)
    if carries_static_torque(prepared.assembly):
        refuse_overload(prepared.assembly, prepared.speed)
    orbit = _forced(prepared, start, periods, tolerance, settle)
    if not orbit.outcome.ok and prepared.sliders:
        refuse_overload(prepared.assembly, prepared.speed)
        orbit = replace(orbit, outcome=slipping_on(prepared, periods) or orbit.outcome)
    response = PeriodicResponse(prepared, prepared.speed, orbit, None, "not asked for")
    if not compare or not orbit.outcome.ok:
        return response
    try:
        comparison = compared(
            response.speed, description, response.growth_rate, response.torque_peak_to_peak, response.shafts
        )
    except (InputError, ComputationError) as error:
        return replace(response, no_comparison=f"does not apply ({error})")
    return replace(response, comparison=comparison, no_comparison="")


def _forced(
    prepared: LineSystem, start: ArrayLike | None, periods: int, tolerance: float, settle: bool
) -> PeriodicOrbit:
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
        found = kept_speed_orbit(prepared, start, tolerance=tolerance, settle=settle)
        if not found.orbit.outcome.ok:
            refuse_overload(assembly, prepared.speed)
        words = (
            "does not apply (the line starts free; beyond the balance of its loads its drives give "
            f"{found.extra_torque:.4g} N m at the input)"
        )
        return PeriodicResponse(prepared, prepared.speed, found.orbit, None, words)
    return _torque_driven(prepared, start, tolerance, settle)


def _torque_driven(prepared: LineSystem, start: ArrayLike | None, tolerance: float, settle: bool) -> PeriodicResponse:
    """A free line without shares: its mean speed is found with the motion, from the speed given as a guess."""
    require_closing(prepared)
    row = prepared.assembly.table(1, prepared.speed)
    left = float(imbalance(prepared.assembly, row)[0])
    if left > 0 and not loaded_by_speed(prepared.assembly):
        require_balance(prepared.assembly, row)  # nothing but dampers could drive it
    speed = prepared.speed
    first = prepared.twisted() if start is None else prepared.system.checked_start(start)
    orbit, found = torque_driven_orbit(prepared, speed, first, tolerance=tolerance)
    if not orbit.outcome.ok and settle:
        run = simulate_system(prepared.system, periods=400, start=first, tolerance=1e-8, dense=False)
        n = prepared.assembly.topology.size
        speed += float(run.final[n])
        if run.outcome.ok and speed > 0:
            twisted = line_system(prepared.assembly, speed).twisted()
            orbit, found = torque_driven_orbit(prepared, speed, twisted, tolerance=tolerance)
    if not orbit.outcome.ok and left:
        words = f"{orbit.outcome.sentence}; {torques_in_words(prepared.assembly, row[0])}"
        orbit = replace(orbit, outcome=Outcome(False, orbit.outcome.kind, words))
    return PeriodicResponse(
        prepared, found, orbit, None, "does not apply (the line starts free: its speed is a result, not given)"
    )


def require_forced(line: LineSystem) -> None:
    """Refuse a line whose motion has no period given from outside."""
    if line.assembly.topology.free:
        raise InputError(
            "starts free: its speed follows from its torques and is not periodic in time",
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


def _findings(result: PeriodicResponse, unit: str) -> list[Finding]:
    at = show_speed(result.speed, unit)
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
