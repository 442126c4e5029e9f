"""A driveline as a ``System``: its numbers in the order the compiled right-hand side reads them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, cached_property
from pathlib import Path
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Disk
from trunnion.driveline.excitation import Excitation
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.parameters import SPEED, Parameter
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.harmonic_torques import harmonic_torque
from trunnion.equations.kinematics import base_motion
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.line_regimes import line_regimes, slider_strides, staged_springs
from trunnion.equations.loads import accelerating_loads, drive_places, drive_torques, given_shares
from trunnion.equations.sliders import PlacedSlider, sliders
from trunnion.equations.stage_laws import has_stages, stage_law
from trunnion.equations.topology import LONGEST_PERIOD, Link, common_rate
from trunnion.errors import InputError
from trunnion.laws.fourier import FourierLaw
from trunnion.laws.hooke import CrossLaw
from trunnion.laws.joint import JointLaw
from trunnion.numerics.compiled import kernel_file
from trunnion.systems.system import System
from trunnion.systems.user_functions import CFunction

Array = NDArray[np.float64]
ANGLE_SCALE = 0.01
"""The deviation [rad] that counts as one in error control."""


@cache
def kernel() -> ModuleType:
    """The compiled right-hand side of lines and what observes their motion."""
    return kernel_file(str(Path(__file__).with_name("line_kernel.py")))


@dataclass(frozen=True)
class Course:
    """Input speed Ω(t) = speed + acceleration (t − since), the input's angle being ``angle`` at t = since."""

    speed: float
    acceleration: float = 0.0
    since: float = 0.0
    angle: float = 0.0


@dataclass(frozen=True)
class LineMotion:
    """Twist [rad] and torque [N m] of every shaft, (time, shaft), positive with the twist; and the deviation of
    every station from its uniform rotation [rad], (time, station)."""

    twist: Array
    torque: Array
    rotation: Array


@dataclass(frozen=True)
class LineSystem:
    """A line prepared for nonlinear analyses.

    ``system`` has the states "rotation of …" (deviations from uniform rotation at the mean speed, forks
    subtracted), "rate of …" and, of clutches with dry friction, "deflection of … slider …"; its parameters are the
    line's numbers by their paths, and the speed.
    """

    assembly: Assembly
    speed: float

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the unknown rotations."""
        return self.assembly.topology.names

    @property
    def shafts(self) -> tuple[str, ...]:
        """Names of the compliances; massless shafts in series count as one."""
        names = self.assembly.line.names
        return tuple(" + ".join(names[i] for i in c.shafts) for c in self.assembly.topology.compliances)

    @cached_property
    def period_turns(self) -> Fraction | None:
        """Period of everything that depends on the input's rotation, in turns; None where there is none."""
        topo = self.assembly.topology
        rates = [*topo.rates, *(rate for mesh in topo.meshes for rate in mesh.rates)]
        stations = {element: s for s, element in topo.disks}
        for i, element in enumerate(self.assembly.line.elements):
            for harmonic in element.excitation if isinstance(element, Disk) else ():
                if harmonic.order is not None:
                    rates.append(Fraction(str(harmonic.order)) * abs(topo.speed_ratio[stations[i]]))
        turns = 1 / common_rate(rates) if any(rates) else Fraction(1, 2)
        return turns if turns <= LONGEST_PERIOD else None

    @cached_property
    def sliders(self) -> tuple[PlacedSlider, ...]:
        """The sliders of its clutches, whose deflections are its last states."""
        return sliders(self.assembly.packed, self.assembly.topology, self.assembly.table(1)[0])

    @cached_property
    def system(self) -> System:
        """The line as a system, its parameters being those of the description."""
        packed = self.assembly.packed
        values = dict(zip(packed.labels, map(float, packed.values), strict=True)) | {SPEED: self.speed}
        n, rubbing = self.assembly.topology.size, self.sliders
        compiled = kernel().line
        reach = [slider.reach for slider in rubbing]
        return System(
            name=self.assembly.line.name or "driveline",
            states=(
                *(f"rotation of {name}" for name in self.names),
                *(f"rate of {name}" for name in self.names),
                *(f"deflection of {slider.name}" for slider in rubbing),
            ),
            units=("rad",) * n + ("rad/s",) * n + ("rad",) * len(rubbing),
            rate=CFunction(compiled.address, compiled),
            parameters=values,
            parameter_units=dict(zip(packed.labels, packed.units, strict=True)),
            period=self._period,
            start=np.zeros(2 * n + len(rubbing)),
            scale=np.concatenate([np.repeat([ANGLE_SCALE, ANGLE_SCALE * self.speed], n), reach]),
            numbers_of=self._numbers,
            regimes=line_regimes(self.assembly, kernel()),
            speed_unit=speed_unit(self.assembly.line),
        )

    def _period(self, values: Mapping[str, float]) -> float | None:
        """The period of everything [s]; None where the excitations have none of usable length in common."""
        if self.period_turns is None:
            return None
        period = 2 * np.pi * float(self.period_turns) / values[SPEED]
        in_time = [2 * np.pi / values[key] for key in self.time_harmonics]
        if in_time and not self._turning:
            period = in_time[0]  # nothing depends on the rotation
        for other in in_time:
            ratio = Fraction(period / other).limit_denominator(LONGEST_PERIOD)
            if not ratio or abs(float(ratio) * other / period - 1) > 1e-12:
                return None
            period *= ratio.denominator
        return period

    @cached_property
    def time_harmonics(self) -> tuple[str, ...]:
        """Parameters that are frequencies of torques harmonic in time."""
        names, elements = self.assembly.line.names, self.assembly.line.elements
        return tuple(
            f"{name}.excitation {h} frequency"
            for name, element in zip(names, elements, strict=True)
            for h, harmonic in enumerate(element.excitation if isinstance(element, Disk) else (), start=1)
            if harmonic.frequency is not None
        )

    @property
    def _turning(self) -> bool:
        """Whether anything depends on the input's rotation."""
        topo = self.assembly.topology
        disks = [e for e in self.assembly.line.elements if isinstance(e, Disk)]
        shaken = any(h.order is not None for d in disks for h in d.excitation)
        return bool(topo.joints or topo.meshes) or shaken

    def _numbers(self, values: Mapping[str, float]) -> Array:
        return self.numbers(np.array([values[label] for label in self.assembly.packed.labels]))

    @property
    def excited(self) -> bool:
        """Whether any disk carries a harmonic torque."""
        return any(isinstance(e, Disk) and e.excitation for e in self.assembly.line.elements)

    def with_drive(self, torque: float) -> System:
        """The system with ``torque`` [N m at the input] more from its drives than balances the loads."""

        def numbers(values: Mapping[str, float]) -> Array:
            row = np.array([values[label] for label in self.assembly.packed.labels])
            return self.numbers(row, drive=torque)

        return replace(self.system, numbers_of=numbers)

    def untwisted(self, table: Array) -> LineCoefficients:
        """Coefficients about zero twist: what the nonlinear equations stand on."""
        return self.assembly.coefficients(table, statically_twisted=False, free_play=True)

    def numbers(
        self,
        row: Array,
        course: Course | None = None,
        drive: float = 0.0,
        known: LineCoefficients | None = None,
        case: int = 0,
    ) -> Array:
        """What the compiled right-hand side reads, from one row of packed numbers and the input's course.

        ``drive`` [N m] at the input is given by a free line's drives beyond the balance of its loads. On a course of
        their own, drives with a share follow its speed and acceleration. ``known`` : ``untwisted`` of rows, this being
        number ``case``, where they are at hand.
        """
        assembly, topo = self.assembly, self.assembly.topology
        table = row[None]
        co = known or self.untwisted(table)
        ratios, mean = topo.ratio_values.tolist(), topo.mean_speeds
        load, by_speed, by_square = co.load[case], np.zeros(len(topo.stations)), np.zeros(len(topo.stations))
        if course is not None and topo.free and given_shares(topo, assembly.packed.column, table).any():
            load, by_speed, by_square = accelerating_loads(
                topo, assembly.packed.column, row, co.inertia[case], course.acceleration
            )
        course, core = course or Course(float(row[0])), kernel()
        if drive:
            share = drive_places(topo, assembly.packed.column, table)
            load = load + drive_torques(topo, share, np.array([drive]))[0]
        stations = self._stations.copy()
        stations[:, core.INERTIA], sense_of = co.inertia[case], np.sign(mean)
        for place, part in ((core.LOAD, load), (core.BY_SPEED, by_speed), (core.BY_SQUARE, by_square)):
            stations[:, place] = part * sense_of
        stations[:, core.VISCOUS], stations[:, core.QUADRATIC] = co.viscous[case], co.quadratic[case]
        phase, joints = [0.0] * len(topo.stations), dict(zip(topo.joints, co.joints, strict=True))
        shifts, column = co.shift[case].tolist(), assembly.packed.column
        for s, station in enumerate(topo.stations):
            before = phase[station.before] if station.before >= 0 else 0.0
            if station.link is Link.SHAFT:
                phase[s] = before + shifts[s]
            elif station.link is Link.RATIO:
                phase[s] = before / ratios[s]
            elif station.link is Link.JOINT:
                chi = before + shifts[s]
                stations[s, core.PHASE], phase[s] = chi, chi + joints[s].turned
        harmonics = []
        for s, i in topo.disks:
            element = assembly.line.elements[i]
            for h, harmonic in enumerate(element.excitation if isinstance(element, Disk) else (), start=1):
                torque = harmonic_torque(
                    assembly.packed, topo, s, i, h, _at(course, row, harmonic, assembly.line.names[i])
                )
                amplitude, angle = float(np.abs(torque[0])), float(np.angle(torque[0]))
                place = column(i, f"excitation {h} frequency")
                frequency = row[place] if place >= 0 else 0.0
                sense = float(np.sign(mean[s]))
                order = sense * (harmonic.order or 0.0)
                harmonics.append([s, sense * amplitude, order, frequency, angle])
        laws = staged_springs(assembly, row)
        begin = core.HEAD + stations.size + len(topo.compliances) * core.PER_COMPLIANCE
        begin += len(harmonics) * core.PER_HARMONIC + len(self.sliders) * core.PER_SLIDER
        compliances = []
        for e, c in enumerate(topo.compliances):
            ends = [c.near, topo.reference[c.far_group]]
            ends += [topo.coordinate[topo.group_of(c.near)], topo.coordinate[c.far_group]]
            law = [0.0] * 5
            if e in laws:
                law = [begin, laws[e].stride, laws[e].stages, len(laws[e].error), len(laws[e].wave)]
                begin += laws[e].numbers.size
            compliances.append([*ends, co.stiffness[case, e], co.damping[case, e], *law])
        law_numbers = np.concatenate([law.numbers for law in laws.values()] or [np.zeros(0)])
        for s, joint in joints.items():
            ripple = _put_joint(core, joint, case, stations[s], begin)
            law_numbers, begin = np.append(law_numbers, ripple), begin + ripple.size
        head = [topo.size, len(stations), len(compliances), len(harmonics), float(not topo.free)]
        rubbing = sliders(assembly.packed, assembly.topology, row)
        strides = slider_strides(laws, len(rubbing))
        friction = [[s.compliance, s.stiffness, s.reach, step] for s, step in zip(rubbing, strides, strict=True)]
        head += [course.angle, course.speed, course.acceleration, course.since, law_numbers.size, len(rubbing)]
        scratch = np.zeros(5 * len(stations) + 7 * topo.size + 3 * len(compliances))
        parts = [np.array(head), stations.ravel(), np.ravel(compliances), np.ravel(harmonics)]
        parts += [np.ravel(friction), law_numbers, scratch]
        return np.concatenate([np.asarray(part, dtype=float) for part in parts])

    @cached_property
    def _stations(self) -> Array:
        """What the compiled right-hand side reads of every station, without what depends on the line's numbers."""
        topo, core = self.assembly.topology, kernel()
        stations = np.zeros((len(topo.stations), core.PER_STATION))
        for s, (station, ratio) in enumerate(zip(topo.stations, topo.ratio_values, strict=True)):
            out, group = stations[s], station.group
            out[core.BEFORE], out[core.LINK] = station.before, getattr(core, station.link.name, core.ROOT)
            out[core.COORDINATE], out[core.REFERENCE] = topo.coordinate[group], topo.reference[group]
            out[core.MEAN], out[core.OVER] = topo.mean_speeds[s], 1 / ratio
        return stations

    def observe(self, system: System, time: ArrayLike, state: ArrayLike) -> LineMotion:
        """Twists, torques and rotations along a motion of ``system`` (this line's, or with other parameters)."""
        t, x = np.atleast_1d(np.asarray(time, dtype=float)), np.atleast_2d(np.asarray(state, dtype=float))
        return self.observed(t, x, system.numbers)

    def observed(self, t: Array, x: Array, numbers: Array) -> LineMotion:
        """The same of states x (time, state) at times t (time,), under ``numbers`` as of ``numbers``."""
        topo = self.assembly.topology
        twist, torque = np.empty((len(t), len(topo.compliances))), np.empty((len(t), len(topo.compliances)))
        rotation = np.empty((len(t), len(topo.stations)))
        stages = np.zeros(twist.shape, dtype=np.int64)
        kernel().observe(t, np.ascontiguousarray(x), numbers, twist, torque, rotation, stages)
        return LineMotion(twist, torque, rotation)

    def energy(self, system: System, time: ArrayLike, state: ArrayLike) -> tuple[Array, Array]:
        """Kinetic and elastic energy [J] along a motion, (time,) each."""
        t, x = np.atleast_1d(np.asarray(time, dtype=float)), np.atleast_2d(np.asarray(state, dtype=float))
        kinetic, potential = np.empty(len(t)), np.empty(len(t))
        kernel().energy(t, np.ascontiguousarray(x), system.numbers, kinetic, potential)
        packed, line = self.assembly.packed, self.assembly.line
        table = np.array([[system.parameters[label] for label in packed.labels]])
        for e, compliance in enumerate(self.assembly.topology.compliances):
            if has_stages(line.elements[compliance.shafts[0]]):
                law = stage_law(line, compliance.shafts[0], packed.column, table)
                potential += law.first.energy(self.observe(system, t, x).twist[:, e])
        return kinetic, potential

    def varied(self, parameter: str | Parameter) -> Callable[..., System]:
        """The system as a function of one parameter of the line ("speed", "HookeJoint 1.angle", a group), and of the
        torque of ``with_drive``."""
        columns, labels = self.assembly.packed.resolve(parameter), self.assembly.packed.labels

        def at(value: float, drive: float = 0.0) -> System:
            changes = {
                labels[i]: float(offset + slope * value)
                for i, slope, offset in zip(columns.index, columns.slope, columns.offset, strict=True)
            }
            return (self.with_drive(drive) if drive else self.system).with_parameters(changes)

        return at

    def rest(self) -> Array:
        """The state without twist: every disk where rigid shafts would hold it at t = 0."""
        return self.rigid(0.0)

    def rigid(self, theta: float) -> Array:
        """State of the line with rigid shafts, the input standing at ``theta`` [rad]."""
        topo = self.assembly.topology
        co = self.assembly.coefficients(self.assembly.table(1, self.speed), statically_twisted=False, free_play=True)
        base = base_motion(topo, co, np.array([theta]))
        plain = base_motion(topo, co.straight, np.array([theta]))
        d = (base.angle - plain.angle)[0, 0, topo.firsts]
        v = (base.speed - plain.speed)[0, 0, topo.firsts] * self.speed
        return np.concatenate([d, v, np.zeros(len(self.sliders))])

    def twisted(self) -> Array:
        """State of the line with rigid shafts, each twisted by the torque it carries on average; sliders at rest."""
        topo, table = self.assembly.topology, self.assembly.table(1, self.speed)
        plain = self.assembly.coefficients(table, statically_twisted=False, free_play=True)
        held = self.assembly.coefficients(table, free_play=True)
        motions = [base_motion(topo, co, np.zeros(1)) for co in (held, plain.straight)]
        d, v = ((motions[0].angle - motions[1].angle)[0, 0], (motions[0].speed - motions[1].speed)[0, 0])
        return np.concatenate([d[topo.firsts], v[topo.firsts] * self.speed, np.zeros(len(self.sliders))])


def _at(course: Course, row: Array, harmonic: Excitation, name: str) -> Array:
    """The packed numbers at the speed that a harmonic has its amplitude at."""
    if not harmonic.varies:
        return row[None]
    if course.acceleration:
        raise InputError(
            "has an amplitude that depends on the speed, which changes here",
            element=name,
            key="excitation",
            remedy="give it an amplitude, or use tn.order_response",
        )
    table = row[None].copy()
    table[:, 0] = course.speed
    return table


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


def line_system(line: Driveline | Assembly, speed: float) -> LineSystem:
    """Prepare ``line`` at input ``speed`` [rad/s] (of a free line: the mean speed it is observed from).

    Raises
    ------
    InputError : a second prescribed speed; no spring; what ``assemble`` refuses.
    """
    assembly = assemble(line)
    refuse_second_speed(assembly)
    if not assembly.topology.compliances:
        raise InputError("has no spring, so that nothing twists", element="driveline", remedy="add a Shaft")
    return LineSystem(assembly, float(speed))


def refuse_second_speed(assembly: Assembly) -> None:
    """Refuse a line whose two ends are both prescribed.

    Raises
    ------
    InputError : so.
    """
    if sum(assembly.topology.prescribed) > 1:
        raise InputError(
            "a second prescribed speed has no place in the nonlinear equations",
            element="driveline",
            key="ConstantSpeed",
            remedy="end the line with a Disk",
        )
