"""A driveline as a ``System``: its numbers in the order the compiled right-hand side reads them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, partial
from types import ModuleType
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Integers
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.parameters import SPEED, Parameter
from trunnion.equations.aligned import rigid_rotation
from trunnion.equations.coefficients import Assembly
from trunnion.equations.converters import PlacedConverter, placed_converters
from trunnion.equations.coupling_tables import refuse_torque_tables
from trunnion.equations.harmonics import DiskTorque, disk_torques, line_harmonics
from trunnion.equations.kinematics import base_motion
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.line_regimes import line_kernel as kernel
from trunnion.equations.line_regimes import line_regimes, released_kernel, slider_strides, staged_springs
from trunnion.equations.loads import accelerating_loads, drive_places, drive_torques, given_shares, refuse_curves
from trunnion.equations.prepared_line import ANGLE_SCALE, prepared
from trunnion.equations.released import PlacedPendulum, placed_pendulums, released_numbers
from trunnion.equations.sliders import PlacedSlider, sliders
from trunnion.equations.slip_clutches import PlacedClutch, placed_clutches
from trunnion.laws.fourier import FourierLaw
from trunnion.laws.harmonic import LONGEST_PERIOD, ROUNDING, common_rate, periods_in_common, turning
from trunnion.laws.hooke import CrossLaw
from trunnion.laws.joint import JointLaw
from trunnion.portable import Portable
from trunnion.systems.system import System
from trunnion.systems.user_functions import CFunction, from_kernel


@dataclass(frozen=True)
class SpeedRamp:
    """Input speed Ω(t) = speed + acceleration (t − since), the input's angle being ``angle`` at t = since."""

    speed: float
    acceleration: float = 0.0
    since: float = 0.0
    angle: float = 0.0


class LineMotion(NamedTuple):
    """Twist [rad] and torque [N m] of every shaft, (time, shaft), positive with the twist; and the deviation of
    every station from its uniform rotation [rad], (time, station)."""

    twist: Array
    torque: Array
    rotation: Array


@dataclass(frozen=True)
class LineSystem(Portable):
    """A line prepared for nonlinear analyses.

    ``system`` has the states "rotation of …" (deviations from uniform rotation at the mean speed, forks
    subtracted), "rate of …" and, of clutches with dry friction, "deflection of … slider …"; its parameters are the
    line's numbers by their paths, and the speed.

    Meshes run with the input where it is prescribed, and with the mean speed given where the line is free–free: that is
    the speed of a periodic motion. ``leaves``: the line may leave that speed, as in a motion in time, and its meshes
    run with the mean rotation that it has.
    """

    assembly: Assembly
    speed: float
    leaves: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the unknown rotations."""
        return self.assembly.topology.names

    @property
    def shafts(self) -> tuple[str, ...]:
        """Names of the compliances; massless shafts in series count as one."""
        line = self.assembly.line
        return tuple(line.spring_name(c.shafts, c.number) for c in self.assembly.topology.compliances)

    @cached_property
    def torques(self) -> tuple[DiskTorque, ...]:
        """The harmonic torques of all disks."""
        return disk_torques(self.assembly)

    @cached_property
    def period_turns(self) -> Fraction | None:
        """Period of everything that depends on the input's rotation alone, in turns; None where there is none."""
        turning = [one.order for one in line_harmonics(self.assembly) if not one.frequency]
        rates = [*self.assembly.topology.rates, *turning]
        turns = 1 / common_rate(rates) if rates else Fraction(1, 2)
        return turns if turns <= LONGEST_PERIOD else None

    @cached_property
    def sliders(self) -> tuple[PlacedSlider, ...]:
        """The sliders of its clutches, whose deflections are its last states."""
        return sliders(self.assembly.packed, self.assembly.topology, self.assembly.table(1)[0])

    @cached_property
    def clutches(self) -> tuple[PlacedClutch, ...]:
        """Its slip clutches that may slip."""
        return placed_clutches(self.assembly, self.assembly.table(1)[0])

    @cached_property
    def converters(self) -> tuple[PlacedConverter, ...]:
        """Its torque converters that are not locked."""
        return placed_converters(self.assembly.line, self.assembly.topology)

    @cached_property
    def pendulums(self) -> tuple[PlacedPendulum, ...]:
        """Its centrifugal pendulums that swing along their paths."""
        return placed_pendulums(self.assembly, self.assembly.table(1)[0])

    @property
    def _rate(self) -> CFunction:
        released = self.clutches or self.pendulums
        return from_kernel(released_kernel, "released_line") if released else from_kernel(kernel, "line")

    @cached_property
    def system(self) -> System:
        """The line as a system, its parameters being those of the description."""
        packed = self.assembly.packed
        values = dict(zip(packed.labels, map(float, packed.values), strict=True)) | {SPEED: self.speed}
        n, friction_sliders = self.assembly.topology.size, self.sliders
        reach = [slider.reach for slider in friction_sliders]
        return System(
            name=self.assembly.line.name or "driveline",
            states=(
                *(f"rotation of {name}" for name in self.names),
                *(f"rate of {name}" for name in self.names),
                *(f"deflection of {slider.name}" for slider in friction_sliders),
            ),
            units=("rad",) * n + ("rad/s",) * n + ("rad",) * len(friction_sliders),
            rate=self._rate,
            parameters=values,
            parameter_units=dict(zip(packed.labels, packed.units, strict=True)),
            period=self._period,
            start=np.zeros(2 * n + len(friction_sliders)),
            scale=np.concatenate([np.repeat([ANGLE_SCALE, ANGLE_SCALE * (self.speed or 1.0)], n), reach]),
            numbers_of=self._numbers,
            regimes=line_regimes(self.assembly),
            speed_unit=speed_unit(self.assembly.line),
        )

    def _period(self, values: Mapping[str, float]) -> float | None:
        """The period of everything [s]; None where the excitations have none of usable length in common."""
        if self.period_turns is None or not values[SPEED]:
            return None
        speed, labels, topo = values[SPEED], self.assembly.packed.labels, self.assembly.topology
        turn = 2 * np.pi / speed
        timed = [abs(float(turning(float(one.order), values[labels[one.columns[2]]], speed))) for one in self.timed]
        if any(0 < w < speed / LONGEST_PERIOD for w, one in zip(timed, self.timed, strict=True) if one.order):
            return None
        # What stands still is a constant. Without anything that turns the first of the others gives the period.
        periods = [2 * np.pi / w for w in timed if w]
        if topo.joints or topo.meshes or len(self.timed) < len(self.torques) or not periods:
            periods.insert(0, turn * float(self.period_turns))
        count = periods_in_common([1 / period for period in periods], LONGEST_PERIOD, ROUNDING)
        return count * periods[0] if count else None

    @property
    def timed(self) -> list[DiskTorque]:
        """The torques whose frequency does not go with the speed alone."""
        return [one for one in self.torques if one.columns[2] >= 0]

    def _numbers(self, values: Mapping[str, float], drive: float = 0.0) -> Array:
        return self.numbers(np.array([values[label] for label in self.assembly.packed.labels]), drive=drive)

    def with_drive(self, torque: float) -> System:
        """The system with ``torque`` [N m at the input] more from its drives than balances the loads."""
        return self.system.with_fields(numbers_of=partial(self._numbers, drive=torque))

    def drive_numbers(self, table: Array) -> Array:
        """What one N m of the drives at the input changes of the numbers (case, number): constant loads of stations."""
        topo, core = self.assembly.topology, kernel()
        torques = drive_torques(topo, drive_places(topo, self.assembly.packed.column, table), np.ones(len(table)))
        found = np.zeros((len(table), self._many))
        stations = core.HEAD + core.PER_STATION * np.arange(len(topo.stations)) + core.LOAD
        found[:, stations] = torques * np.sign(topo.mean_speeds)
        return found

    @cached_property
    def _many(self) -> int:
        """Numbers of a line."""
        return len(self.numbers(self.assembly.table(1)[0]))

    def untwisted(self, table: Array) -> LineCoefficients:
        """As of ``Assembly.untwisted``."""
        return self.assembly.untwisted(table)

    def numbers(
        self,
        row: Array,
        course: SpeedRamp | None = None,
        drive: float = 0.0,
        known: LineCoefficients | None = None,
        case: int = 0,
        applied: Array | None = None,
        programs: Array | None = None,
        lags: int = 0,
        amplitudes: Mapping[int, Array] | None = None,
    ) -> Array:
        """What the compiled right-hand side reads, from one row of packed numbers and the input's course.

        ``drive`` [N m] at the input is given by a free line's drives beyond the balance of its loads. On a course of
        their own, drives with a share follow its speed and acceleration. ``known`` : ``untwisted`` of rows, this being
        number ``case``, where they are at hand. ``applied`` : torques from outside as the kernel reads them, one a row;
        ``programs`` : of their formulas, which stand behind them. ``lags`` : how many of them lag. ``amplitudes`` : of
        harmonic torques by their place, as of ``amplitudes_by_speed``; those of others are of the course's speed.
        """
        topo, core = self.assembly.topology, kernel()
        co, on = known or self.untwisted(row[None]), course or SpeedRamp(float(row[0]))
        sense, friction_sliders, laws = (
            np.sign(topo.mean_speeds),
            sliders(self.assembly.packed, topo, row),
            staged_springs(self.assembly, row),
        )
        stations, compliances = self._stations.copy(), self._compliances.copy()
        stations[:, core.INERTIA] = co.inertia[case]
        stations[:, core.VISCOUS], stations[:, core.QUADRATIC] = co.viscous[case], co.quadratic[case]
        if self.leaves and topo.free:
            stations[topo.firsts, core.SHARE] = self.shares(co.inertia[case])
        if on.acceleration:
            self.refuse_change()
            assert amplitudes is not None or not any(one.law.varies for one in self.torques)
        loads = self._loads(row, course, drive, co.load[case], co.inertia[case])
        for place, part in zip((core.LOAD, core.BY_SPEED, core.BY_SQUARE), loads, strict=True):
            stations[:, place] = part * sense
        for station, lost in topo.lost:
            stations[station, core.LOAD] -= lost * sense[station]
        given = amplitudes or {}
        harmonics = [self._harmonic(one, None if h in given else on, row) for h, one in enumerate(self.torques)]
        clutches = placed_clutches(self.assembly, row)
        strides = slider_strides(laws, len(friction_sliders) + len(clutches))
        friction = [
            [s.compliance, s.stiffness, s.reach, step] for s, step in zip(friction_sliders, strides, strict=False)
        ]
        # Behind them the laws of springs with stages and of joints that are Fourier series.
        begin = core.HEAD + stations.size + compliances.size
        begin += len(harmonics) * core.PER_HARMONIC + len(friction_sliders) * core.PER_SLIDER
        behind = []
        compliances[:, core.STIFFNESS], compliances[:, core.DAMPING] = co.stiffness[case], co.damping[case]
        compliances[list(topo.converting), core.DAMPING] = 0.0
        for e, law in laws.items():
            compliances[e, core.LAW :] = begin, law.stride, law.stages, len(law.error), len(law.wave)
            behind.append(law.numbers)
            begin += law.numbers.size
        added = co.shift[case].copy()
        for s, joint in zip(topo.joints, co.joints, strict=True):
            stations[s, core.PHASE] = self.carried[s] @ added
            added[s] += joint.turned
            behind.append(_put_joint(core, joint, case, stations[s], begin))
            begin += behind[-1].size
        for h, pieces in given.items():
            harmonics[h][core.CURVE :] = begin, len(pieces)
            behind.append(pieces.ravel())
            begin += pieces.size
        if applied is not None:
            behind.append(applied.ravel())
        if programs is not None:
            behind.append(programs)
        converters = [one.numbers for one in self.converters]
        at_converters = begin + sum(part.size for part in (applied, programs) if part is not None)
        behind += converters
        pendulums = placed_pendulums(self.assembly, row)
        behind.append(released_numbers(clutches, strides[len(friction_sliders) :], pendulums))
        head = [topo.size, len(stations), len(compliances), len(harmonics), not topo.free, on.angle, on.speed]
        head += [on.acceleration, on.since, sum(part.size for part in behind), len(friction_sliders)]
        head += [0, 0, 0] if applied is None else [len(applied), begin, lags]
        head += [len(converters), at_converters]
        scratch = np.zeros(5 * len(stations) + 7 * topo.size + 5 * len(compliances))
        parts = [head, stations.ravel(), compliances.ravel(), np.ravel(harmonics), np.ravel(friction), *behind, scratch]
        return np.concatenate([np.asarray(part, dtype=float) for part in parts])

    def shares(self, inertia: Array) -> Array:
        """Share of every unknown's deviation (n,) in that of the mean rotation of a line with ``inertia`` (station,),
        Jρ/Σ Jρ²."""
        felt, turning = self.assembly.topology.on_unknowns(inertia), rigid_rotation(self.assembly.topology)
        return np.asarray(felt * turning / (felt @ turning**2))

    def _loads(
        self, row: Array, course: SpeedRamp | None, drive: float, load: Array, inertia: Array
    ) -> tuple[Array | float, ...]:
        """Loads (station,) against the mean sense of rotation: constant, and by the input's speed and its square."""
        topo, column = self.assembly.topology, self.assembly.packed.column
        by_speed: Array | float = 0.0
        by_square: Array | float = 0.0
        if course is not None and topo.free and given_shares(topo, column, row[None]).any():
            load, by_speed, by_square = accelerating_loads(topo, column, row, inertia, course.acceleration)
        if drive:
            load = load + drive_torques(topo, drive_places(topo, column, row[None]), np.array([drive]))[0]
        return load, by_speed, by_square

    def refuse_change(self) -> None:
        """Refuse what the equations of motion take at one speed, where the speed changes.

        Raises
        ------
        InputError : so.
        """
        elsewhere = "use tn.order_response at several speeds, or tn.simulate at one"
        refuse_curves(self.assembly.topology, elsewhere)
        refuse_torque_tables(self.assembly.line, elsewhere)

    def _harmonic(self, one: DiskTorque, course: SpeedRamp | None, row: Array) -> list[float]:
        """What the right-hand side reads of one harmonic torque: its amplitude is that at the speed of the course, or,
        without one, stands in pieces elsewhere."""
        sense, torque = float(np.sign(self.assembly.topology.mean_speeds[one.station])), 0j
        if course is not None:
            at = np.concatenate([[course.speed], row[1:]])[None] if one.law.varies else row[None]
            torque = complex(one.size(self.assembly, at)[0])
        frequency = float(row[one.columns[2]]) if one.columns[2] >= 0 else 0.0
        phase = float(np.angle(torque))
        numbers = [one.station, sense * float(np.abs(torque)), sense * one.own_order, frequency, phase]
        return [*numbers, float(np.cos(phase)), float(np.sin(phase)), 0, 0]

    @cached_property
    def _stations(self) -> Array:
        """What the compiled right-hand side reads of every station, without what depends on the line's numbers."""
        topo, core = self.assembly.topology, kernel()
        stations = np.zeros((len(topo.stations), core.PER_STATION))
        for s, station in enumerate(topo.stations):
            stations[s, core.BEFORE], stations[s, core.LINK] = (
                station.before,
                getattr(core, station.link.name, core.ROOT),
            )
            stations[s, core.REFERENCE] = topo.reference[station.group]
        stations[:, core.COORDINATE], stations[:, core.MEAN] = topo.unknown_of, topo.mean_speeds
        stations[:, core.OVER] = 1 / topo.ratio_values
        return stations

    @cached_property
    def _compliances(self) -> Array:
        """The same of every compliance."""
        topo, core = self.assembly.topology, kernel()
        compliances = np.zeros((len(topo.compliances), core.PER_COMPLIANCE))
        for e, c in enumerate(topo.compliances):
            compliances[e, core.NEAR], compliances[e, core.FAR] = c.near, topo.reference[c.far_group]
            compliances[e, core.NEAR_COORDINATE] = topo.unknown_of[c.near]
            compliances[e, core.FAR_COORDINATE] = topo.coordinate[c.far_group]
        return compliances

    @cached_property
    def carried(self) -> Array:
        """By how much every station turns on with what is added to the rotation of another (station, station)."""
        topo = self.assembly.topology
        carried = np.eye(len(topo.stations))
        for s, station in enumerate(topo.stations):
            if station.before >= 0:
                carried[s] += carried[station.before] * (topo.mean_speeds[s] / topo.mean_speeds[station.before])
        return carried

    def observe(self, system: System, time: ArrayLike, state: ArrayLike, regime: Integers | None = None) -> LineMotion:
        """Twists, torques and rotations along a motion of ``system`` (this line's, or with other parameters), which was
        in ``regime`` (time,); by default in those that its states tell."""
        t, x = np.atleast_1d(np.asarray(time, dtype=float)), np.atleast_2d(np.asarray(state, dtype=float))
        return self.observed(t, x, system.numbers, regime)

    def observed(self, t: Array, x: Array, numbers: Array, regime: Integers | None = None) -> LineMotion:
        """The same of states x (time, state) at times t (time,), under ``numbers`` as of ``numbers``."""
        return self._observed(t, x, numbers, regime)[0]

    def moving(self, t: Array, x: Array, numbers: Array, regime: Integers | None = None) -> tuple[LineMotion, Array]:
        """The same, and the speed [rad/s] of every station (time, station)."""
        motion, _, speed = self._observed(t, x, numbers, regime)
        return motion, speed

    def slip(self, t: Array, x: Array, numbers: Array, regime: Integers | None = None) -> tuple[Array, Array]:
        """Slip speed [rad/s] and torque [N m] of every slip clutch (time, clutch), likewise."""
        motion, slip, _ = self._observed(t, x, numbers, regime)
        return slip, motion.torque[:, [clutch.compliance for clutch in self.clutches]]

    def _observed(self, t: Array, x: Array, numbers: Array, regime: Integers | None) -> tuple[LineMotion, Array, Array]:
        topo, states = self.assembly.topology, np.ascontiguousarray(x)
        twist, torque = np.empty((len(t), len(topo.compliances))), np.empty((len(t), len(topo.compliances)))
        rotation, speed = np.empty((2, len(t), len(topo.stations)))
        stages, slip = np.zeros(twist.shape, dtype=np.int64), np.empty((len(t), len(self.clutches)))
        kernel().observe(t, states, numbers, twist, torque, rotation, speed, stages)
        if self.clutches or self.pendulums:
            core, known = released_kernel(), np.full(len(t), -1) if regime is None else regime
            rate = core.released_line.address
            core.observe_released(rate, t, states, numbers.copy(), known, stages, torque, slip)
        return LineMotion(twist, torque, rotation), slip, speed

    def varied(self, parameter: str | Parameter) -> Callable[..., System]:
        """The system as a function of one parameter of the line ("speed", "HookeJoint 1.angle", a group), and of the
        torque of ``with_drive``."""
        columns, labels = self.assembly.packed.resolve_axis(parameter), self.assembly.packed.labels

        def at(value: float, drive: float = 0.0) -> System:
            changes = {
                labels[i]: float(offset + slope * value)
                for i, slope, offset in zip(columns.index, columns.slope, columns.offset, strict=True)
            }
            return (self.with_drive(drive) if drive else self.system).with_parameters(changes)

        return at

    def rest(self, angle: float = 0.0) -> Array:
        """The state without twist: every disk where rigid shafts would hold it, the input at ``angle`` [rad]."""
        return self._static_state(self.untwisted(self.assembly.table(1, self.speed)), angle)

    def twisted(self, angle: float = 0.0) -> Array:
        """State of the line with rigid shafts, each twisted by the torque it carries on average; sliders at rest."""
        table = self.assembly.table(1, self.speed)
        return self._static_state(self.assembly.coefficients(table, free_play=True), angle)

    def _static_state(self, coefficients: LineCoefficients, angle: float) -> Array:
        """State of the line with rigid shafts, the input at ``angle``, twisted as the coefficients say."""
        topo = self.assembly.topology
        plain = self.untwisted(self.assembly.table(1, self.speed)).straight
        loaded, straight = (base_motion(topo, co, np.full(1, angle)) for co in (coefficients, plain))
        d, v = (loaded.angle - straight.angle)[0, 0, topo.firsts], (loaded.speed - straight.speed)[0, 0, topo.firsts]
        return np.concatenate([d, v * self.speed, np.zeros(len(self.sliders))])


def _put_joint(core: ModuleType, law: JointLaw, case: int, out: Array, place: int) -> Array:
    """Put a law's ``case`` into its station's numbers; what of it stands at ``place`` among all numbers."""

    def number(part: Array) -> float:
        every = np.reshape(part, -1)  # one for each case, or for all
        return float(every[min(case, len(every) - 1)])

    if isinstance(law, CrossLaw):
        t, cosine = number(law.t), number(law.cosine)
        out[core.LINK], out[core.SIZE], out[core.COSINE], out[core.SQUARE] = core.CROSS, t, cosine, 4 * t / (1 + t) ** 2
        return np.zeros(0)
    assert isinstance(law, FourierLaw)
    out[core.LINK], out[core.SIZE], out[core.COSINE] = core.FOURIER, place, len(law.orders)
    parts = [number(part) for part in (*law.amplitude, *law.phase)]
    return np.stack([np.array(law.orders, dtype=float), *np.reshape(parts, (2, -1))], axis=1).ravel()


def line_system(
    line: Driveline | Assembly,
    speed: float,
    *,
    leaves: bool = False,
    slips: bool = False,
    swing: bool = False,
    linearised: bool = False,
) -> LineSystem:
    """Prepare ``line`` at input ``speed`` [rad/s]; see ``prepared``, which refuses what has no nonlinear equations."""
    assembly = prepared(line, speed, leaves=leaves, slips=slips, swing=swing, linearised=linearised)
    return LineSystem(assembly, float(speed), leaves)
