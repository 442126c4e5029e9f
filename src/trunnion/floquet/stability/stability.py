"""Floquet stability of a line, or of any periodic linear system, at one speed.

The propagator Z over one period maps a disturbance to itself one period later; the motion is stable if all
its multipliers (eigenvalues) lie inside the unit circle. Z is integrated until two step sizes agree, and
that agreement becomes the error of every multiplier (see ``numerics.spectrum``). Liouville's identity
ln det Z = −∫tr(M⁻¹C) dτ is checked each time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from fractions import Fraction
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.driveline.arguments import one_number
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import operating_speed, speed_unit
from trunnion.equations.aligned import aligned_matrices, frequencies, rigid_rotation
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.linear import periodic_linear_system, require_rigid_base, rigid_motions
from trunnion.equations.steady_base import (
    carried_at_input,
    has_periodic_base,
    require_no_steady_state,
    require_own_motion,
)
from trunnion.equations.topology import Topology, require_period
from trunnion.errors import ComputationError, InputError
from trunnion.features import left_out
from trunnion.floquet.propagation.cost_model import by_modes_of, by_shooting, require_time
from trunnion.floquet.propagation.floquet_modes import floquet_mode, judged_multipliers, propagated
from trunnion.floquet.propagation.tree_mode_motion import mode_motion
from trunnion.floquet.propagation.tree_modes import FloquetModes, floquet_modes
from trunnion.floquet.stability.lagging import lagging_multipliers, lags_count
from trunnion.floquet.stability.own_speed import RUNS_AWAY, is_of_speed
from trunnion.floquet.stability.shaken_stages import shaken_stages
from trunnion.modes.mode_content import FARTHEST, ModeMotion, mode_content, named_resonance
from trunnion.modes.natural_frequencies import natural_frequencies
from trunnion.modes.resonance_speeds import Resonance, Source, sources
from trunnion.numerics.spectrum import multipliers, spectral_radius
from trunnion.results.fields import attribute, computed, internal, labelled, variable
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.results.result import Result
from trunnion.results.units import with_error
from trunnion.results.variables import Attribute, Variable, attributes
from trunnion.results.verdict import MEANING, Verdict, verdicts
from trunnion.steady.orders.forced_response import LINEAR_RANGE, LinearResponse, linear_response
from trunnion.systems.periodic_linear import PeriodicLinearSystem

if TYPE_CHECKING:
    from trunnion.numerics.chain.dense_monodromy import Propagation

LONG = 16
"""Unknowns from which on modes by Hill's blocks cost less than the propagator of all states."""
ROUNDING = 1e-11
"""Error of a propagator, for each unknown, that is rounding whatever tolerance is asked."""
NEAR = 0.1
"""As FARTHEST, on a stability boundary."""
OWN = 0.1
"""Tolerance of the motion that a free line is judged about, over that of its multipliers."""
EXTRA = "what the drives of a free–free line with joint angles give beyond the balance of the loads; None elsewhere"
NO_EXTRA = 1e-6
"""Share of the torques that a line carries below which what its drives give beyond their balance is not said."""
SET_ASIDE = {
    1: "the multiplier at 1 of a turn of the whole line is set aside",
    2: "the rigid-body pair of multipliers at 1 is set aside",
}
PHASE_HELD = "a mesh that varies holds the phase of the motion: the multiplier of a turn of the whole line counts"


@labelled
class Stability(Result):
    """Floquet stability at one speed.

    Spectral radius and error estimate leave out the ``set_aside`` multipliers, exactly 1: of a free–free line a
    turn of the whole line, and its speed where no torque depends on it; of a damper without a spring a turn of its
    ring.
    """

    multipliers: Complex = variable("multiplier_number", "1", "by falling modulus", name="multiplier")
    multiplier_error: Array = variable("multiplier_number", "1", "bound")
    floquet_modes: Complex = internal(
        "states (x, dx/dτ) at τ = 0 that each multiplier carries on", axes="state multiplier"
    )
    spectral_radius: float = variable("", "1")
    error_estimate: float = variable("", "1", "of the spectral radius")
    verdict: Verdict = attribute()
    period: float = variable("", "rad", "period in input angle")
    speed: float = variable("", "rad/s", "of the input; dτ/dt for a system of your own")
    resonance: Resonance | None = internal("that the critical multiplier names")
    forced: Callable[[], LinearResponse] | None = internal("computes the response")
    liouville_defect: float = attribute("|ln det Z + ∫tr(M⁻¹C)dτ|, an independent check")
    names: tuple[str, ...] = internal("of the rotations")
    set_aside: int = internal("how many multipliers are")
    left_out: tuple[Finding, ...] = internal("what the line has and this does not count", default=())
    unit: str = internal("of speeds in print", default="rad/s")
    extra_torque: float | None = internal(EXTRA, "N m at the input", default=None)
    carried: float = internal("mean torques of all disks together, at the input", "N m", default=0.0)
    about_steady_state: bool = attribute("whether about the line's own periodic motion", default=False)
    dragged: int = internal("how many of those set aside belong to dampers without a spring", default=0)
    speed_sentence: str = internal(
        "of a free–free line, what becomes of a change of its speed where that is told", default=""
    )

    @property
    def response(self) -> LinearResponse | None:
        """The linear forced response, computed when it is first asked for; None for a system of your own, and where
        ``no_response`` says why there is none."""
        return self._asked[0]

    @property
    def no_response(self) -> str:
        """Why the forced response of a line cannot be computed; empty where it can."""
        return self._asked[1]

    @cached_property
    def _asked(self) -> tuple[LinearResponse | None, str]:
        try:
            return self.forced and self.forced(), ""
        except (InputError, ComputationError) as error:  # the verdict stands without it
            return None, str(error)

    @property
    def exponents(self) -> Complex:
        """Characteristic exponents ln σ / period, in 1/s (imaginary part modulo the excitation)."""
        with np.errstate(divide="ignore"):
            return np.asarray(np.log(self.multipliers) * (self.speed / self.period), dtype=complex)

    @property
    @computed(variable("", "1/s"), after="error_estimate")
    def growth_rate(self) -> float:
        """Growth of the fastest disturbance [1/s]; negative when it decays."""
        return float(np.log(self.spectral_radius) * self.speed / self.period)

    @property
    def phase_is_held(self) -> bool:
        """Whether the motion of a free–free line has no free phase, as a mesh varies with its gears' mean rotation."""
        return self.about_steady_state and self.extra_torque is not None and not self.set_aside

    @property
    def growth_rate_error(self) -> float:
        """Error estimate of the growth rate [1/s]."""
        return float(self.error_estimate / self.spectral_radius * self.speed / self.period)

    def disturbance(self, size: float = 1e-3) -> Array:
        """A small disturbance of the kind that grows fastest, or decays slowest.

        Parameters
        ----------
        size : its largest rotation [rad] at the start.

        Returns
        -------
        State (2n,): rotations [rad], then their rates [rad/s], to be added to a ``start`` of ``simulate``. Of two such
        motions, with it and without, the difference is multiplied by the critical multiplier in every period.
        """
        n = len(self.names)
        critical = int(np.abs(np.abs(self.multipliers) - self.spectral_radius).argmin())
        mode = self.floquet_modes[:, critical]
        largest = mode[np.abs(mode[:n]).argmax()]
        state = np.real(mode * (size / largest))
        return np.concatenate([state[:n], state[n:] * self.speed])

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What to read first, gravest first."""
        return by_gravity([*_findings(self), *self.left_out])

    def declared(self) -> Iterator[Variable | Attribute]:
        """Multipliers, growth and verdict, and what the forced response holds."""
        yield from super().declared()
        yield from attributes(resonance=str(self.resonance or ""))
        if self.response is not None:
            yield from (one for one in self.response.declared() if isinstance(one, Variable))

    @property
    def _printed(self) -> tuple[Finding, ...]:
        return self.left_out

    def _lines(self) -> Iterator[str]:
        yield f"{self.verdict} at {self.words.speed(self.speed)}: {MEANING[self.verdict]}"
        yield (
            f"  spectral radius {with_error(self.spectral_radius, self.error_estimate, beside=1.0)} per period of "
            f"{'' if self.period == np.pi else f'{self.period / np.pi:g}'}π rad of input angle"
        )
        yield f"  growth rate {with_error(self.growth_rate, self.growth_rate_error, 4, sign='+')} 1/s"
        if self.resonance is not None:
            at = f" (at {self.words.speed(self.resonance.speed)})" if np.isfinite(self.resonance.speed) else ""
            yield f"  the critical multiplier belongs to the {self.resonance.in_words}{at}"
        if self.set_aside > self.dragged:
            many = self.set_aside - self.dragged
            yield f"  {SET_ASIDE.get(many, f'the {many} multipliers at 1 of rigid rotations are set aside')}"
        elif self.phase_is_held:
            yield f"  {PHASE_HELD}"
        if self.about_steady_state:
            extra, beyond = self.extra_torque, ""
            if extra is not None and abs(extra) > NO_EXTRA * self.carried:
                beyond = f", for which the drives give {extra:.4g} N m beyond the balance of the loads"
            yield f"  judged about the line's own periodic motion{beyond}"
        if self.speed_sentence:
            yield f"  {self.speed_sentence}"
        if self.response is not None:
            yield "  " + str(self.response).replace("\n", "\n  ")
        if self.no_response:
            yield f"  without the forced response: {self.no_response}"


def stability(
    line: Driveline | Assembly | PeriodicLinearSystem,
    speed: float | str | None = None,
    *,
    tolerance: float = 1e-10,
    statically_twisted: bool = True,
    about_steady_state: bool = False,
) -> Stability:
    """Floquet stability of ``line`` at input ``speed`` [rad/s], with the linear forced response.

    Parameters
    ----------
    line : a driveline, or any ``PeriodicLinearSystem`` (which carries its own rate; leave ``speed`` out).
    speed : mean input speed [rad/s]; default the operating speed of the file.
    tolerance : error asked of Z in energy-like units.
    statically_twisted : linearise about the line twisted by its load torques (joint phases and η′T̄);
        False takes zero twist, as S1 and S3 do. A free–free line with joint angles is judged about its own periodic
        motion, twist and all, whatever this says.
    about_steady_state : about the periodic motion that the line really makes, under its loads and joints and without
        its excitations, instead of the motion of rigid shafts: the one that shooting finds from the line twisted by
        its loads. A free–free line with joint angles is always judged about it.

    Raises
    ------
    InputError : no speed; a line without inertia, period or steady base motion; straight joints with
        ``about_steady_state``.
    ComputationError : the integration did not settle, or no periodic motion was found.

    Examples
    --------
    >>> import trunnion as tn
    >>> shaft = tn.Shaft(stiffness=1e4, damping=2.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=0.1), shaft, tn.Disk(inertia=0.8)])
    >>> tn.stability(line, 56.0)
    <Stability: stable at 56 rad/s: every disturbance dies out>
    """
    if not 0 < one_number(tolerance, "tolerance", "1e-10, say") < 1:
        raise InputError("must lie between 0 and 1", key="tolerance", value=tolerance, remedy="1e-10, say")
    if isinstance(line, PeriodicLinearSystem):
        if speed is not None:
            raise InputError("belongs to a driveline; this system carries its own rate", key="speed", value=speed)
        require_no_steady_state(about_steady_state)
        scaled, nothing = np.array(line.frequencies) * line.period / np.pi, np.zeros((2 * line.size, 0))
        run = propagated(line, tolerance)
        return _judge(line, run, (Source(Fraction(1)),), Fraction(1, 2), scaled, None, nothing)
    assembly = assemble(line)
    table = assembly.table(1, operating_speed(assembly.line, speed))
    assembly = assembly.at(float(table[0, 0]))
    if about_steady_state:
        require_own_motion(assembly, table)
    if about_steady_state or has_periodic_base(assembly):
        found = _about_steady_state(assembly, float(table[0, 0]), tolerance)
    else:
        found = _about_rigid_shafts(assembly, table, tolerance, statically_twisted)
        coefficients = assembly.coefficients(table, statically_twisted=statically_twisted)
        if lags_count(assembly, coefficients):
            found = _with_lags(found, assembly, coefficients)
    if found.verdict in (Verdict.UNSTABLE, Verdict.UNDECIDED):
        found = _speed_told(found, assembly.topology, assembly.coefficients(table))
    return replace(
        found, left_out=(*left_out("stability", assembly.line), *shaken_stages(assembly)),
        unit=speed_unit(assembly.line), dragged=len(assembly.topology.dragged),
    )  # fmt: skip


def _with_lags(found: Stability, assembly: Assembly, coefficients: LineCoefficients) -> Stability:
    """Of a straight line some of whose torques lag, for which ``found`` takes their slopes as quasi-static."""
    own = lagging_multipliers(assembly, coefficients, found.period, found.set_aside)
    return replace(
        found, multipliers=own.value, multiplier_error=own.error, floquet_modes=own.states, verdict=own.verdict,
        spectral_radius=own.radius, error_estimate=own.radius_error, resonance=None,
    )  # fmt: skip


def _speed_told(found: Stability, topo: Topology, coefficients: LineCoefficients) -> Stability:
    """In place of a resonance, where the critical multiplier is that of a free line's speed or held phase."""
    counted = np.argsort(np.abs(found.multipliers - 1))[found.set_aside :]
    if not len(counted):
        return found
    one = counted[np.abs(found.multipliers[counted]).argmax()]
    if not is_of_speed(topo, coefficients, complex(found.multipliers[one]), found.floquet_modes[: topo.size, one]):
        return found
    return replace(found, resonance=None, speed_sentence="" if found.phase_is_held else RUNS_AWAY)


def _about_rigid_shafts(assembly: Assembly, table: Array, tolerance: float, statically_twisted: bool) -> Stability:
    topo, speed = assembly.topology, float(table[0, 0])
    require_time(assembly, speed, partial(by_modes_of, assembly), "stability")
    require_rigid_base(assembly, table)
    forced = partial(linear_response, assembly, speed, statically_twisted=statically_twisted)
    turns = require_period(assembly.line, topo)
    coefficients = assembly.coefficients(table, statically_twisted=statically_twisted)
    aside = rigid_motions(topo, coefficients)
    if topo.size >= LONG:
        modes = floquet_modes(topo, coefficients, turns)
        found = modes and _of_modes(topo, modes, aside, turns, speed, forced, tolerance)
        if modes and found:
            if found.verdict not in (Verdict.UNSTABLE, Verdict.UNDECIDED):
                return found
            # Only what grows belongs to a resonance.
            motion = mode_motion(topo, coefficients, turns, complex(modes.exponent[0]))
            frequency = frequencies(aligned_matrices(topo, coefficients), still=topo.still)[0] / speed
            named = _named(motion, found.verdict, speed, frequency, sources(assembly), turns)
            return replace(found, resonance=named)
    system = periodic_linear_system(assembly, table, statically_twisted=statically_twisted)
    frequency, run = np.array(system.frequencies), propagated(system, tolerance)
    return _judge(system, run, sources(assembly), turns, frequency, forced, aside)


def _named(
    motion: ModeMotion | None,
    verdict: Verdict,
    rate: float,
    frequency: Array,
    excited: tuple[Source, ...],
    turns: Fraction,
) -> Resonance | None:
    """The resonance that a critical mode belongs to; frequencies over the ``rate`` [rad/s]."""
    if motion is None:
        return None
    # Tongues are wide at large angles: named from far away.
    farthest = FARTHEST if verdict is Verdict.UNSTABLE else NEAR
    named = named_resonance(mode_content(motion, turns), frequency, excited, turns, farthest)
    return named and replace(named, speed=named.speed * rate)


def _about_steady_state(assembly: Assembly, speed: float, tolerance: float) -> Stability:
    """Of a line with angled joints; no motion of rigid shafts stands for one that is free–free."""
    topo = assembly.topology
    turns = require_period(assembly.line, topo)
    from trunnion.steady.free.periodic_steady_state import periodic_steady_state
    from trunnion.steady.shooting.periodic_orbit import speed_in_words

    if (long := _about_long_motion(assembly, speed, tolerance)) is not None:
        return long
    require_time(assembly, speed, by_shooting, "stability about its own periodic motion")
    motion = periodic_steady_state(assembly.line, speed, tolerance=OWN * tolerance)
    orbit = motion.orbit
    scale = np.repeat([1.0, 1 / speed], topo.size)
    values, vectors = np.linalg.eig(orbit.monodromy)
    by_modulus = np.argsort(-np.abs(values))
    critical = np.argmin(np.abs(np.abs(values) - orbit.spectral_radius))
    named = None
    if orbit.verdict in (Verdict.UNSTABLE, Verdict.UNDECIDED):
        moving = motion.mode_motion(complex(values[critical]))
        frequency = natural_frequencies(assembly).undamped_frequency / speed
        named = _named(moving, orbit.verdict, speed, frequency, sources(assembly), turns)
    shapes = vectors[:, by_modulus] * scale[:, None]
    return Stability(
        multipliers=orbit.multipliers,
        multiplier_error=orbit.multiplier_error,
        floquet_modes=shapes / np.abs(shapes).max(0),
        spectral_radius=orbit.spectral_radius,
        error_estimate=orbit.error_estimate,
        verdict=orbit.verdict,
        period=2 * np.pi * float(turns),
        speed=speed,
        resonance=named,
        forced=partial(linear_response, assembly, speed),
        liouville_defect=orbit.liouville_defect,
        names=topo.names,
        set_aside=orbit.set_aside,
        about_steady_state=True,
        extra_torque=orbit.values[-1] if topo.free else None,
        carried=carried_at_input(assembly, assembly.table(1, speed)[0]),
        speed_sentence=speed_in_words(orbit) if np.isfinite(orbit.speed_multiplier) else "",
    )


def _about_long_motion(assembly: Assembly, speed: float, tolerance: float) -> Stability | None:
    """Of a long line, by modes along its tree; None of one that is short or no tree, and where they are known less well
    than asked."""
    from trunnion.floquet.propagation.periodic_motion_modes import periodic_motion_modes
    from trunnion.steady.free.long_steady_state import long_steady_state
    from trunnion.steady.shooting.periodic_orbit import change_of_speed_in_words

    topo = assembly.topology
    motion = long_steady_state(assembly.line, speed, LONG)
    found = None if motion is None else periodic_motion_modes(motion, max(tolerance, ROUNDING * topo.size))
    if motion is None or found is None:
        return None
    turns, modes, named = require_period(assembly.line, topo), found.modes, None
    if found.verdict in (Verdict.UNSTABLE, Verdict.UNDECIDED):
        frequency = natural_frequencies(assembly).undamped_frequency / speed
        named = _named(found.critical_motion(), found.verdict, speed, frequency, sources(assembly), turns)
    shift = motion.given.shift(rigid_rotation(topo)).T[:, : int(topo.free)]
    value = np.concatenate([modes.multiplier, np.ones(shift.shape[1])])
    order = np.argsort(-np.abs(value), kind="stable")
    is_known = np.isfinite(found.speed_multiplier)
    period = 2 * np.pi * float(turns)
    return Stability(
        multipliers=value[order],
        multiplier_error=np.concatenate([modes.error, np.zeros(shift.shape[1])])[order],
        floquet_modes=np.concatenate([modes.states, shift / np.abs(shift).max(axis=0, initial=0.0)], axis=1)[:, order],
        spectral_radius=found.radius,
        error_estimate=found.error,
        verdict=found.verdict,
        period=period,
        speed=speed,
        resonance=named,
        forced=partial(linear_response, assembly, speed),
        liouville_defect=modes.liouville_defect,
        names=topo.names,
        set_aside=int(topo.free),
        about_steady_state=True,
        extra_torque=motion.torque if topo.free else None,
        carried=carried_at_input(assembly, assembly.table(1, speed)[0]),
        speed_sentence=change_of_speed_in_words(found.speed_multiplier, period / speed) if is_known else "",
    )


def _judge(
    system: PeriodicLinearSystem,
    run: Propagation,
    excited: tuple[Source, ...],
    turns: Fraction,
    frequency: Array,
    forced: Callable[[], LinearResponse] | None,
    aside: Array,
) -> Stability:
    matrix = run.scaled_monodromy
    values, bound = multipliers(matrix, np.array(run.error))
    order = np.argsort(-np.abs(values))
    values, bound = values[order], bound[order]
    modes = np.linalg.eig(matrix)[1][:, order] * run.scale[:, None]
    judged, off = judged_multipliers(run, aside) if aside.shape[1] else (values, bound)
    # A line of one inertia that turns freely has nothing left to judge: it neither grows nor decays.
    radius, error = spectral_radius(judged, off) if len(judged) else (np.array(1.0), np.array(0.0))
    undamped = abs(run.damping_trace) < 1e-13 * system.size
    verdict = Verdict(int(verdicts(radius, error, undamped)))
    named = None
    if len(judged) and verdict in (Verdict.UNSTABLE, Verdict.UNDECIDED):
        # Only what grows belongs to a resonance.
        critical = np.argmin(np.abs(values - judged[np.abs(judged).argmax()]))
        motion = floquet_mode(system, run, complex(values[critical]))
        named = _named(motion, verdict, system.rate, frequency, excited, turns)
    sign, log_det = np.linalg.slogdet(matrix)
    return Stability(
        multipliers=values,
        multiplier_error=bound,
        floquet_modes=modes / np.abs(modes).max(0),
        spectral_radius=float(radius),
        error_estimate=float(error),
        verdict=verdict,
        period=system.period,
        speed=system.rate,
        resonance=named,
        forced=forced,
        liouville_defect=float(abs(log_det + run.damping_trace)) if sign > 0 else float("inf"),
        names=system.names,
        set_aside=aside.shape[1],
    )


def _of_modes(
    topo: Topology,
    modes: FloquetModes,
    aside: Array,
    turns: Fraction,
    speed: float,
    forced: Callable[[], LinearResponse],
    tolerance: float,
) -> Stability | None:
    """Of the modes of a long line; None where they are known less well than asked."""
    radius, error = spectral_radius(modes.multiplier, modes.error)
    undamped = abs(modes.trace) < 1e-13 * topo.size
    verdict = Verdict(int(verdicts(radius, error, undamped)))
    if modes.off > max(tolerance, ROUNDING * topo.size):
        return None
    value, off, states = modes.multiplier, modes.error, modes.states
    if still := aside.shape[1]:
        value, off = np.concatenate([value, np.ones(still)]), np.concatenate([off, np.zeros(still)])
        order = np.argsort(-np.abs(value), kind="stable")
        states = np.concatenate([states, aside / np.abs(aside).max(axis=0)], axis=1)[:, order]
        value, off = value[order], off[order]
    return Stability(
        multipliers=value,
        multiplier_error=off,
        floquet_modes=states,
        spectral_radius=float(radius),
        error_estimate=float(error),
        verdict=verdict,
        period=2 * np.pi * float(turns),
        speed=speed,
        resonance=None,
        forced=forced,
        liouville_defect=modes.liouville_defect,
        names=topo.names,
        set_aside=aside.shape[1],
    )


def _findings(result: Stability) -> Iterable[Finding]:
    words, at = result.words, result.words.speed(result.speed)
    if result.verdict is Verdict.UNSTABLE:
        doubling = np.log(2) / result.growth_rate
        where = f"; it belongs to the {result.resonance.in_words}" if result.resonance else ""
        yield Finding(
            Gravity.DANGER,
            f"The line is unstable at {at}: a small torsional disturbance doubles every {doubling:.3g} s{where}.",
        )
    elif result.verdict is Verdict.UNDECIDED:
        yield Finding(
            Gravity.CAUTION,
            f"The line stands on a stability boundary at {at}: |multiplier| is 1 to within "
            f"{result.error_estimate:.1e}; give damping its true value or ask for a smaller tolerance.",
        )
    elif result.verdict is Verdict.MARGINAL:
        yield Finding(
            Gravity.NOTE,
            f"Without damping the line is marginal at {at}: disturbances neither grow nor die out.",
        )
    else:
        yield Finding(Gravity.NOTE, f"The line is stable at {at}: disturbances decay at {-result.growth_rate:.3g} 1/s.")
    response = result.response
    if result.no_response:
        yield Finding(Gravity.CAUTION, f"Without the forced response: {result.no_response}.")
    if response is not None and not np.all(np.isfinite(response.torque_amplitude)):
        yield Finding(
            Gravity.DANGER,
            f"No steady forced motion exists at {at}: an excitation meets a natural frequency without damping.",
        )
    elif response is not None and not response.linear:
        worst = int(response.joint_rotation.argmax())
        shaft = int(response.twist_amplitude.argmax())
        steady = "Stable does not mean quiet: its" if result.verdict is Verdict.STABLE else "Its"
        yield Finding(
            Gravity.DANGER,
            f"{steady} excitation forces a rotation of {words.angle(response.joint_rotation[worst])} at the input of "
            f"{response.joints[worst]} at {at} (twist of {response.shafts[shaft]} "
            f"±{words.angle(response.twist_amplitude[shaft])} by linear theory), beyond the linear range of "
            f"{words.angle(LINEAR_RANGE)}: read it as resonance, not as an amplitude; the verdict holds for small "
            "twist only.",
        )
