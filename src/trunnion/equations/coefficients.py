"""From the numbers a user gives (tube diameters, loss factors, …) to those the equations need.

Every function takes a table of packed parameters, one row per case, and returns one row per case: a chart
evaluates a whole row of points at once.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import groupby
from operator import itemgetter
from typing import Any, Literal

import numpy as np

from trunnion.arrays import Array, Flags
from trunnion.driveline.converter_balance import LOCK, input_speed, open_converter, running_line
from trunnion.driveline.couplings import Coupling
from trunnion.driveline.dampers import ViscousDamper
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.joints import Joint
from trunnion.driveline.mean_balance import is_left_free, own_speed
from trunnion.driveline.oil import UNSTATED
from trunnion.driveline.parameters import PackedLine, pack
from trunnion.driveline.pendulums import CentrifugalPendulum, Swinging
from trunnion.driveline.quantities import SPEED, shown
from trunnion.driveline.shafts import Elastic, SpringElement
from trunnion.driveline.torque_converters import TorqueConverter
from trunnion.driveline.vehicle import Tyre
from trunnion.equations.aligned import AlignedMatrices, aligned_matrices, frequencies
from trunnion.equations.converters import placed_converters, require_even
from trunnion.equations.coupling_tables import table_stiffness
from trunnion.equations.line_coefficients import LineCoefficients, MeshWave, OilLink
from trunnion.equations.loads import exciting_load, load_at_input, mean_load, mean_loads, static_torque, station_loads
from trunnion.equations.mean_clutch import mean_clutch, states_a_motion
from trunnion.equations.plain_springs import PlainSprings, plain_springs
from trunnion.equations.sliders import refuse_friction
from trunnion.equations.slip_capacity import refuse_slipping
from trunnion.equations.stage_laws import has_stages, impact_damping, spring_damping, stage_law
from trunnion.equations.topology import Compliance, Mesh, Topology, topology
from trunnion.errors import InputError
from trunnion.laws.harmonic import Harmonic
from trunnion.laws.joint import JointLaw

SAME_SPEED = 1e-12
"""Relative difference of speeds that rounding makes."""
AT_INPUT = -1
"""Where loads kept by the place of their element have that at the input."""
MOST_KNOWN = 8
"""Rows whose coefficients are kept."""


@dataclass(frozen=True)
class Assembly:
    """A line with its topology and packed numbers: what every analysis starts from.

    Of a line with a torque converter that is not locked, ``line`` has it as it runs at the input speed ``runs_at``
    [rad/s]; ``stated`` is the line as described, None without one.
    """

    line: Driveline
    packed: PackedLine
    topology: Topology
    stated: Driveline | None = None
    runs_at: float = float("nan")

    def at(self, speed: float) -> Assembly:
        """The same where it runs at an input ``speed`` [rad/s]: of a line with a torque converter, as that runs then.

        Raises
        ------
        InputError : a speed at which it does not run.
        """
        if self.stated is None or not np.isfinite(speed) or not self._otherwise(np.array([speed])).any():
            return self
        return _assembled_at(self.stated, float(speed))

    def each(self, speeds: Array) -> list[Assembly] | None:
        """The same at every input speed (speed,) [rad/s]; None where one stands for all."""
        if self.stated is None or not self._otherwise(speeds).any():
            return None
        return [self.at(float(one)) for one in speeds]

    def each_of(self, table: Array) -> list[Assembly] | None:
        """The same at the input speed of every row of packed numbers (case, column).

        Raises
        ------
        InputError : rows that change more than the speed, with which a torque converter may run otherwise.
        """
        if self.stated is None:
            return None
        if np.any(table[:, 1:] != self.packed.values[1:]):
            place = open_converter(self.line)
            assert place is not None
            raise InputError(
                "runs at a ratio of speeds that follows from numbers that change here", element=self.line.names[place],
                key="locked", remedy=LOCK,
            )  # fmt: skip
        return self.each(table[:, 0])

    def _otherwise(self, speeds: Array) -> Flags:
        """Which speeds are others than that at which it runs."""
        return np.isfinite(speeds) & ~(np.abs(speeds - self.runs_at) <= SAME_SPEED * np.abs(speeds))

    def require_one_speed(self, speeds: Array) -> None:
        """Refuse speeds at which its torque converter runs otherwise.

        Raises
        ------
        InputError : so.
        """
        place = None if self.stated is None else open_converter(self.line)
        if place is None:
            return
        if not np.isfinite(self.runs_at):
            remedy = 'write [operation] speed = "1500 rpm", say, or locked = true'
            raise InputError(
                "runs at a ratio of speeds that follows from the speed, which is neither asked of here nor stated",
                element=self.line.names[place], key="curves", remedy=remedy,
            )  # fmt: skip
        others = speeds[self._otherwise(speeds)]
        if len(others):
            here, there = (shown(float(one), SPEED, "rpm", 5) for one in (self.runs_at, others[0]))
            raise InputError(
                f"is linearised about how it runs at {here} of the input, and {there} is asked of",
                element=self.line.names[place], key="locked", remedy=LOCK,
            )  # fmt: skip

    def table(self, rows: int, speed: float | Array | None = None) -> Array:
        """``rows`` copies of the packed numbers, optionally at one ``speed`` [rad/s] or each at its own (rows,)."""
        table = self.packed.table(rows)
        if speed is not None:
            table[:, 0] = speed
        return table

    def coefficients(
        self,
        table: Array,
        *,
        statically_twisted: bool = True,
        damped: bool = True,
        free_play: bool = False,
        any_frequency: bool = False,
    ) -> LineCoefficients:
        """Evaluate the line's coefficients for each row of ``table`` (cases, columns).

        ``statically_twisted`` shifts joint phases by the twist under the transmitted torque; without it the line is
        taken at zero twist and zero torque. ``damped=False`` leaves all damping out. ``free_play=True`` leaves a
        spring in its free play without stiffness, and dry friction out, which are otherwise refused, but for a clutch
        that states the motion at which it is taken.
        ``any_frequency=True`` is for equations by frequency, which have ``loss``; for all others a shaft that has
        it is refused.

        Raises
        ------
        InputError : a loss factor without a frequency, for equations in time; a spring in its free play or with dry
            friction, both unless ``free_play``.
        """
        self.require_one_speed(np.atleast_2d(table)[:, 0])
        if damped and not any_frequency:
            _refuse_any_frequency(self.line)
        if not free_play:
            refuse_friction(self.line, but=states_a_motion)
        asked = np.atleast_2d(table)
        if len(asked) > 1:
            return _coefficients(self, asked, statically_twisted, damped, free_play)
        key = (asked.tobytes(), statically_twisted, damped, free_play)
        found = self._known.get(key)
        if found is None:
            if len(self._known) >= MOST_KNOWN:
                self._known.clear()
            # Of a copy, as laws keep parts of the table.
            found = _coefficients(self, asked.copy(), statically_twisted, damped, free_play)
            self._known[key] = found
        return found

    def untwisted(self, table: Array) -> LineCoefficients:
        """Coefficients about zero twist: what the nonlinear equations stand on."""
        return self.coefficients(table, statically_twisted=False, free_play=True)

    @cached_property
    def _known(self) -> dict[tuple[bytes, bool, bool, bool], LineCoefficients]:
        """Coefficients of single rows: parts of one analysis ask for the same."""
        return {}

    def derived(self, make: Callable[[Assembly], Any]) -> Any:
        """What ``make`` makes of the line as described, made once."""
        if make not in self._derived:
            self._derived[make] = make(self)
        return self._derived[make]

    @cached_property
    def _derived(self) -> dict[Callable[[Assembly], Any], Any]:
        return {}

    def exciting_load(self, place: int, table: Array) -> Array:
        """Mean torque (case,) [N m] that the excitation of the element at a place goes by; the last is kept, as every
        harmonic of an element may ask for it."""
        content = table.tobytes()
        known = self._last_loads.get(place)  # one value, as threads may ask at once
        if known is None or known[0] != content:
            known = (
                content,
                exciting_load(
                    self.topology, self.packed.column, table, place, lambda: self._load_at_input(content, table)
                ),
            )
            self._last_loads[place] = known
        return known[1]

    def _load_at_input(self, content: bytes, table: Array) -> Array:
        """Of the last table that was asked for, the same for all its drives."""
        known = self._last_loads.get(AT_INPUT)
        if known is None or known[0] != content:
            known = content, load_at_input(self.topology, self.packed.column, table)
            self._last_loads[AT_INPUT] = known
        return known[1]

    @cached_property
    def _last_loads(self) -> dict[int, tuple[bytes, Array]]:
        return {}

    def static_torque(self, table: Array) -> Array:
        """Torque [N m] that every compliance carries under the mean loads (case, compliance)."""
        if every := self.each(table[:, 0]):
            return np.concatenate([one.static_torque(row[None]) for one, row in zip(every, table, strict=True)])
        return _static_torque(self, table, mean_loads(self.topology, self.packed.column, table))

    def wind_up(self, table: Array) -> Array:
        """Torque [N m] of every compliance (case, compliance) that ratios of a loop which do not come out force on it
        whatever the loads, as something slips; zeros of all other lines."""
        topo = self.topology
        if not (topo.graph and topo.apart.any()):
            return np.zeros((len(table), len(topo.compliances)))
        return static_torque(topo, np.zeros((len(table), len(topo.stations))), *_sharing(self, table), table[:, 0])

    def common_damping(self, table: Array, stiffness: Array) -> Array:
        """Damping (case,) of a spring under the line's one damping ratio: 2ζk/ω."""
        column = self.packed.column
        given = column(-1, "damping_ratio_frequency")
        reference = table[:, given] if given >= 0 else self.damping_reference
        return np.asarray(2 * table[:, column(-1, "damping_ratio")] * stiffness / reference)

    @cached_property
    def aligned(self) -> AlignedMatrices:
        """The line with all joint angles zero, at the first row of its numbers, without a speed."""
        return aligned_matrices(self.topology, self.coefficients(self.table(1), any_frequency=True))

    @cached_property
    def damping_reference(self) -> float:
        """Frequency [rad/s] at which a common damping ratio holds: as given, else the lowest elastic mode."""
        if self.line.damping_ratio_frequency is not None:
            return float(self.line.damping_ratio_frequency)
        return _lowest_elastic_frequency(self)


_RECENT: deque[Assembly] = deque(maxlen=8)


def assemble(line: Driveline | Assembly, load_case: str | None = None) -> Assembly:
    """Pack ``line``, under a load case of that name, and sort it into stations and compliances.

    Lines do not change, so the last few are kept: what is asked of a line is mostly asked of it again.
    """
    if load_case is not None:
        line = (line.line if isinstance(line, Assembly) else line).with_load(load_case)
    if isinstance(line, Assembly):
        return line
    if not isinstance(line, Driveline):
        raise InputError("is not a driveline", key="line", value=line, remedy='tn.load("line.toml"), say')
    for known in tuple(_RECENT):
        if known.line is line or known.stated is line:
            return known
    place = open_converter(line)
    converter = None if place is None else line.elements[place]
    if isinstance(converter, TorqueConverter):
        assert place is not None
        if converter.run is None:
            return _as_it_operates_itself(line)
        plain = type(converter)(**converter.stated)
        elements = (*line.elements[:place], plain, *line.elements[place + 1 :])
        return _assembled_at(line.model_copy(update={"elements": elements}), input_speed(line, place), line)
    made = Assembly(line, pack(line), topology(line))
    _RECENT.append(made)
    return made


_RUNNING: dict[tuple[int, float], Assembly] = {}
"""Lines with a torque converter by the description and input speed, or by how it runs and input speed, oldest first."""
MOST_RUNNING = 1024


def _assembled_at(line: Driveline, speed: float, runs: Driveline | None = None) -> Assembly:
    """A line with a torque converter at an input ``speed`` [rad/s]; ``runs`` where it is known how it runs there."""
    known = _RUNNING.get((id(line if runs is None else runs), speed))
    if known is not None and (known.stated is line or (runs is not None and known.line is runs)):
        return known
    runs = running_line(line, speed) if runs is None else runs
    made = Assembly(runs, pack(runs), topology(runs), line, speed)
    laws = zip(made.topology.joints, joint_laws(made, made.table(1)), strict=True)
    require_even(runs, made.topology, [s for s, law in laws if law.nonuniform])
    for same in (line, runs):
        _RUNNING[id(same), speed] = made
    for oldest in list(_RUNNING)[:-MOST_RUNNING]:
        _RUNNING.pop(oldest, None)
    return made


def _as_it_operates_itself(line: Driveline) -> Assembly:
    """A line with a torque converter at its own speed; without one as it is described, for analyses that ask of some.

    Raises
    ------
    InputError : it does not run at its own speed.
    """
    speed = None if line.operation is None else line.operation.speed
    if speed is None and is_left_free(line):
        speed = own_speed(line)
    made = Assembly(line, pack(line), topology(line), line) if speed is None else _assembled_at(line, float(speed))
    _RECENT.append(made)
    return made


def _lowest_elastic_frequency(assembly: Assembly) -> float:
    """Lowest non-zero natural frequency [rad/s] of the line as described, damping left out.

    Raises
    ------
    InputError : springs so unlike that it is lost in rounding.
    """
    topo = assembly.topology
    matrices = aligned_matrices(topo, assembly.coefficients(assembly.table(1), damped=False))
    found = frequencies(matrices, still=topo.still)[0]
    lowest = float(found[topo.still])
    # Eigenvalues, the squares, are right to their rounding beside the largest.
    if not lowest**2 > len(found) * np.finfo(float).eps * float(found[-1]) ** 2:
        raise InputError(
            f"holds at the lowest elastic mode, which is lost in rounding beside {found[-1]:.3g} rad/s",
            element="driveline", key="damping_ratio",
            remedy='write damping_ratio_frequency = "50 Hz", say, or check the stiffnesses',
        )  # fmt: skip
    return lowest


def joint_laws(assembly: Assembly, table: Array) -> tuple[JointLaw, ...]:
    """The law of every joint of the topology at the rows of ``table``; its numbers (case, 1)."""
    return tuple(_joint_law(assembly, table, assembly.topology.stations[j].element) for j in assembly.topology.joints)


def _joint_law(assembly: Assembly, table: Array, place: int) -> JointLaw:
    element = assembly.line.elements[place]
    assert isinstance(element, Joint)
    return element.law(lambda key: table[:, assembly.packed.column(place, key), None])


def shaft_stiffness(
    assembly: Assembly, table: Array, element: int, number: int = 0, torque: Array | None = None
) -> Array:
    """Torsional stiffness [N m/rad] of one spring, by its ``number`` in the element; with stages, of its stiffest.

    ``torque`` : mean one that it carries (case,) [N m], which the stiffness of a coupling may follow.
    """
    shaft = assembly.line.elements[element]
    if isinstance(shaft, Coupling):
        carried = np.zeros(len(table)) if torque is None else torque
        if shaft.torques and np.isnan(carried).any():
            carried = _as_it_operates(assembly, table, element)
        return table_stiffness(
            shaft, assembly.line.names[element], lambda key: table[:, assembly.packed.column(element, key)], carried
        )
    if has_stages(shaft):
        return stage_law(assembly.line, element, assembly.packed.column, table).slopes.max(axis=1)
    return _link(assembly, table, element, number)[0]


def _as_it_operates(assembly: Assembly, table: Array, element: int) -> Array:
    """Mean torque (case,) [N m] of the spring of an element, as the line operates where no speed is asked of: at its
    speed, or the highest of its range."""
    operation, speeds = assembly.line.operation, table.copy()
    stated = None if operation is None else operation.speed or (operation.speed_range or (None, None))[1]
    if stated is not None:
        speeds[:, 0] = np.where(np.isfinite(table[:, 0]), table[:, 0], stated)
    own = next(e for e, one in enumerate(assembly.topology.compliances) if element in one.shafts)
    return np.asarray(assembly.static_torque(speeds)[:, own])


def _link(assembly: Assembly, table: Array, element: int, number: int) -> tuple[Array, Array]:
    """Stiffness and damping (case,) of one of the springs and dampers of an element."""
    one, column = assembly.line.elements[element], assembly.packed.column
    assert isinstance(one, Elastic)
    stiffness, damping = one.links(lambda key: table[:, column(element, key)])[number]
    if isinstance(one, CentrifugalPendulum) and not isinstance(one, Swinging):
        stiffness = stiffness * _host_speed(assembly, table, element) ** 2
    return np.broadcast_to(stiffness, len(table)), np.broadcast_to(damping, len(table))


def _host_speed(assembly: Assembly, table: Array, element: int) -> Array:
    """Mean speed [rad/s] of what a pendulum hangs on, by the square of which it is held; where no speed is asked of, as
    the line operates.

    Raises
    ------
    InputError : no speed; a host that turns unevenly behind an angled joint.
    """
    topo, name, operation = assembly.topology, assembly.line.names[element], assembly.line.operation
    speeds = table[:, 0]
    if operation is not None and operation.speed is not None:
        speeds = np.where(np.isfinite(speeds), speeds, operation.speed)
    if not np.isfinite(speeds).all():
        raise InputError(
            "is held by the square of the speed, which is neither asked of here nor stated", element=name, key="order",
            remedy='write [operation] speed = "1500 rpm", say, or use tn.campbell_diagram or tn.order_response',
        )  # fmt: skip
    host = topo.stations[topo.behind[element, 0]].before
    nonuniform = {s for s, law in zip(topo.joints, joint_laws(assembly, table), strict=True) if law.nonuniform}
    at = host
    while at >= 0 and at not in nonuniform:
        at = topo.stations[at].before
    if at >= 0 or (nonuniform and topo.free):
        raise InputError(
            "turns unevenly with an angled joint, and is held by the square of a speed that varies then", element=name,
            key="order", remedy="take the joints at angle 0; tn.simulate and tn.periodic_response follow it",
        )  # fmt: skip
    return np.asarray(speeds * topo.mean_speeds[host])


def _damping_and_loss(
    assembly: Assembly, table: Array, element: int, stiffness: Array, number: int
) -> tuple[Array, Array]:
    """Damping [N m s/rad] of one shaft or mesh, and ηk [N m/rad] of a loss factor that holds at all frequencies."""
    column, none, one = assembly.packed.column, np.zeros(len(table)), assembly.line.elements[element]
    heated = one.damping_factor(lambda key: table[:, column(element, key)]) if isinstance(one, Coupling) else 1.0
    if isinstance(one, Elastic) and not isinstance(one, SpringElement):
        return _link(assembly, table, element, number)[1], none
    if assembly.line.damping_ratio is not None:
        return assembly.common_damping(table, stiffness), none
    if (stated := column(element, "loss_factor")) >= 0:
        lost = table[:, stated] * stiffness
    elif (stated := column(element, "relative_damping")) >= 0:
        lost = table[:, stated] / (2 * np.pi) * stiffness
    else:
        return spring_damping(assembly.line.elements[element], element, column, table) * heated, none
    lost = lost * heated
    frequency = column(element, "loss_factor_frequency")
    return (lost / table[:, frequency], none) if frequency >= 0 else (none, lost)


def _refuse_any_frequency(line: Driveline) -> None:
    for element, name in zip(line.elements, line.names, strict=True):
        if isinstance(element, SpringElement) and element.loss and element.loss_factor_frequency is None:
            raise InputError(
                "holds at all frequencies, which equations in time do not have",
                element=name,
                key="loss_factor" if element.loss_factor is not None else "relative_damping",
                value=element.loss_factor if element.loss_factor is not None else element.loss * 2 * np.pi,
                remedy='write loss_factor_frequency = "50 Hz", where it is to hold (only tn.order_response needs none)',
            )


def _series(stiffness: list[Array], damping: list[Array]) -> Array:
    """Damping of massless shafts in series as one.

    Exact where all have the same c/k, otherwise right to first order in cω/k: each shaft twists in proportion to 1/k,
    so c = k² Σ c_i/k_i².
    """
    if len(stiffness) == 1:
        return damping[0]
    parts = [c / k**2 for c, k in zip(damping, stiffness, strict=True)]
    return np.asarray(_stiffness(stiffness) ** 2 * np.sum(parts, axis=0))


def _stiffness(stiffness: list[Array]) -> Array:
    """Stiffness of massless shafts in series as one."""
    return stiffness[0] if len(stiffness) == 1 else np.asarray(1 / np.sum([1 / k for k in stiffness], axis=0))


def _station_inertia(assembly: Assembly, table: Array) -> Array:
    topo, column = assembly.topology, assembly.packed.column
    inertia = np.zeros((len(table), len(topo.stations)))
    for element, own in groupby(topo.inertias, itemgetter(1)):
        moments = assembly.line.elements[element].inertias(lambda key, i=element: table[:, column(i, key)])
        for station, _, number in own:
            inertia[:, station] += moments[number]
    return inertia


def _plain_springs(assembly: Assembly) -> PlainSprings:
    return plain_springs(assembly.packed, assembly.topology)


def _coefficients(assembly: Assembly, table: Array, twisted: bool, damped: bool, free: bool) -> LineCoefficients:
    topo, column = assembly.topology, assembly.packed.column
    loads = station_loads(topo, column, table)
    mean = mean_load(topo, loads, table[:, 0])
    refuse_slipping(assembly.packed, topo, table, mean)
    static = _static_torque(assembly, table, mean)
    torque = static if twisted else np.zeros_like(static)
    stiffness, damping, twist, loss = (np.zeros_like(static) for _ in range(4))
    shift = np.zeros((len(table), len(topo.stations)))
    plain = assembly.derived(_plain_springs)
    stiffness[:, plain.compliance] = table[:, plain.stiffness]
    if damped:
        damping[:, plain.compliance] = table[:, plain.damping]
    np.divide(torque, stiffness, out=twist, where=stiffness > 0)
    plain.put_shift(shift, table, twist)
    for e in plain.others:
        compliance = topo.compliances[e]
        shafts = compliance.shafts
        each = [shaft_stiffness(assembly, table, i, compliance.number, static[:, e]) for i in shafts]
        stiffness[:, e] = _stiffness(each)
        if damped:
            parts = [
                _damping_and_loss(assembly, table, i, k, compliance.number) for i, k in zip(shafts, each, strict=True)
            ]
            damping[:, e], loss[:, e] = (_series(each, list(part)) for part in zip(*parts, strict=True))
        if has_stages(assembly.line.elements[shafts[0]]):
            if states_a_motion(assembly.line.elements[shafts[0]]) and not free:
                mean_there = mean_clutch(assembly.packed, table, shafts[0], static[:, e], damping[:, e])
                at_rest, stiffness[:, e], rubs = mean_there
                damping[:, e] = rubs if damped else 0.0
            else:
                law = stage_law(assembly.line, shafts[0], column, table)
                at_rest, stiffness[:, e], damped_there = law.under(static[:, e], free=free)
                damping[:, e] *= damped_there
                impact = impact_damping(assembly.line.elements[shafts[0]], shafts[0], column, table)
                if damped and impact.any():
                    damping[:, e] += impact * law.depth(at_rest)
            twist[:, e] = at_rest if twisted else 0.0
            own = [twist[:, e]]
        else:
            np.divide(torque[:, e], stiffness[:, e], out=twist[:, e], where=stiffness[:, e] > 0)
            own = [twist[:, e]] if len(each) == 1 else [torque[:, e] / k for k in each]
        for i, turned in zip(shafts, own, strict=True):
            forks = column(i, "fork_offset")
            if (i, compliance.number) in topo.behind:
                shift[:, topo.behind[i, compliance.number]] = turned + (table[:, forks] if forks >= 0 else 0.0)
    for s in topo.joints:
        station = topo.stations[s]
        shift[:, s] = -table[:, column(station.element, "plane")]
        for i, ratio in station.planes:
            shift[:, s] -= table[:, column(i, "plane")] / ratio
    return LineCoefficients(
        speed=table[:, 0],
        stiffness=stiffness,
        damping=damping,
        torque=torque,
        twist=twist,
        inertia=_station_inertia(assembly, table),
        load=loads.constant,
        viscous=loads.viscous,
        quadratic=loads.quadratic,
        lags=tuple(loads.lags),
        across=tuple(
            across for one in placed_converters(assembly.line, topo) for across in one.across(len(table)) if damped
        ),
        oils=tuple(_oils(assembly, table, stiffness, damping)) if damped else (),
        not_carried=np.zeros_like(mean) if twisted else mean,
        joints=joint_laws(assembly, table),
        shift=shift,
        loss=loss,
        waves=tuple(
            MeshWave(mesh.compliance, mesh_harmonics(assembly.packed, mesh, "stiffness_variation", table))
            for mesh in topo.meshes
            if mesh.stiffness
        ),
    )


def _oils(assembly: Assembly, table: Array, stiffness: Array, damping: Array) -> Iterator[OilLink]:
    for e, compliance in enumerate(assembly.topology.compliances):
        place = compliance.shafts[0]
        damper = assembly.line.elements[place]
        if isinstance(damper, ViscousDamper) and damper.oil:
            stated = assembly.packed.column(place, "oil_temperature")
            temperature = table[:, stated] if stated >= 0 else np.full(len(table), UNSTATED)
            yield OilLink(e, damper, temperature, stiffness[:, e], damping[:, e])


def _static_torque(assembly: Assembly, table: Array, mean: Array) -> Array:
    topo = assembly.topology
    if not topo.graph or not (mean.any() or topo.apart.any()):
        return static_torque(topo, mean)
    return static_torque(topo, mean, *_sharing(assembly, table), table[:, 0])


def _sharing(assembly: Assembly, table: Array) -> tuple[Array, Array]:
    """Stiffness of every compliance and damping of the dragged ones (case, compliance), by which those of a loop share
    torques.

    Raises
    ------
    InputError : a spring with stages in a loop, whose stiffness would follow from that share.
    """
    topo = assembly.topology
    stiffness, damping = np.zeros((2, len(table), len(topo.compliances)))
    for e, compliance in enumerate(topo.compliances):
        element = assembly.line.elements[compliance.shafts[0]]
        if topo.in_loops[e]:
            _refuse_tables_in_loops(assembly, compliance)
        linear = len(getattr(element, "stiffnesses", ())) <= 1 and not getattr(element, "total_backlash", 0.0)
        if has_stages(element) and not linear and topo.in_loops[e]:
            raise InputError(
                "has stages and lies in a loop, whose springs share torque by their stiffness",
                element=assembly.line.names[compliance.shafts[0]], remedy="write a Shaft of its stiffness under load",
            )  # fmt: skip
        stiffness[:, e] = _stiffness(
            [shaft_stiffness(assembly, table, i, compliance.number) for i in compliance.shafts]
        )
        if compliance.drags:
            damping[:, e] = _link(assembly, table, compliance.shafts[0], compliance.number)[1]
            if isinstance(element, Tyre):
                damping[:, e] *= _travels(assembly, table, compliance)
    return stiffness, damping


def _refuse_tables_in_loops(assembly: Assembly, compliance: Compliance) -> None:
    for i in compliance.shafts:
        if isinstance(one := assembly.line.elements[i], Coupling) and one.torques:
            raise InputError(
                "follow the mean torque, and it lies in a loop, whose springs share torque by their stiffness",
                element=assembly.line.names[i], key="stiffnesses", remedy="write stiffness, at the torque it runs at",
            )  # fmt: skip


def _travels(assembly: Assembly, table: Array, compliance: Compliance) -> Array:
    """The travel speed (case,) at which the slip of a tyre is stated over that of its wheel's mean speed: a steady slip
    pulls by its share, whatever the speed. 1 without a speed."""
    number = partial(assembly.packed.column, compliance.shafts[0])
    turning = np.abs(assembly.topology.mean_speeds[compliance.near] * table[:, 0])
    stated = table[:, number("travel_speed")] / table[:, number("radius")]
    return np.where(turning > 0, stated / np.where(turning > 0, turning, 1.0), 1.0)


def mesh_harmonics(
    packed: PackedLine, mesh: Mesh, what: Literal["transmission_error", "stiffness_variation"], table: Array
) -> tuple[Harmonic, ...]:
    """Harmonics of a mesh by turns of the input, at rows of packed numbers (column,) or (case, column): of its error
    along the line of action [m], or of its stiffness over the mean [-]."""
    orders, size = (mesh.error, "amplitude") if what == "transmission_error" else (mesh.stiffness, "share")

    def number(i: int, key: str) -> Array:
        return np.asarray(table[..., packed.column(mesh.element, f"{what} {i} {key}")])

    return tuple(
        Harmonic(order * mesh.teeth, 0.0, number(i, size), number(i, "phase"))
        for i, order in enumerate(orders, start=1)
    )
