"""A driveline whose springs are linear stage by stage as a flow that is exact within every stage.

Without angled joints the inertias M are constant, and the twists q = E y + e(t) of the springs, y the deviations of the
inertias from uniform rotation and e the transmission errors of the meshes, follow from each other alone:

    q″ = −E M⁻¹ Eᵀ f(q, q′) − E M⁻¹ V E⁻¹ (q′ − e′) + E M⁻¹ T(t) + e″,

V the viscous loads and T the outer torques. In a free–free line the rotation of the first inertia does not
matter to the twists unless a viscous load resists it; then it is one more unknown, a spring without torque.

A slider of a clutch is one more row between the two, on the twist of its clutch: the deflection of its spring.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np

from trunnion.arrays import Array, Complex, Integers
from trunnion.driveline.arguments import one_speed
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Rotor
from trunnion.driveline.gears import GearPair
from trunnion.equations.aligned import aligned_matrices
from trunnion.equations.coefficients import Assembly, assemble, joint_laws
from trunnion.equations.coupling_tables import refuse_torque_tables
from trunnion.equations.harmonics import DiskTorque, LineHarmonic, MeshError, line_harmonics
from trunnion.equations.line_regimes import staged_springs
from trunnion.equations.prepared_line import refuse_second_speed
from trunnion.equations.released import refuse_pendulums
from trunnion.equations.sliders import PlacedSlider, sliders
from trunnion.equations.slip_clutches import refuse_slip_clutches
from trunnion.equations.steady_base import imbalance, refuse_dragged, require_tree, torques_in_words
from trunnion.equations.topology import Topology
from trunnion.errors import InputError
from trunnion.laws.harmonic import LONGEST_PERIOD, ROUNDING, periods_in_common, turning
from trunnion.laws.stages import HELD, Stages
from trunnion.numerics.piecewise_linear.staged_flow import StagedFlow

IndependentVariable = Literal["speed", "frequency", "both", "none"]
MOST_ORDER = 200
"""Highest harmonic of the common frequency of all torques and errors."""
CLOSE = 1e-9
"""Share of a frequency within which it is a multiple of the common one."""


@dataclass(frozen=True)
class StagedLine:
    """A line ready for exact motion at one speed or frequency.

    springs: names of the compliances, massless shafts in series as one; ``sliders``: names of the rows behind them, dry
    friction, and ``source`` (m,) on which row's twist each stands; ``turns`` with one more unknown at the end, the
    rotation of the first inertia. speed [rad/s] of the input, None where nothing depends on it. harmonics: of all that
    excites the line by turns of the input, each with its complex amplitude in q″ and that of the transmission errors
    among the twists, ``force`` and ``error`` (harmonic, m). pieces, guards, then, counts, moves as in ``StagedFlow``;
    sides (m, stages): −1 below the softest stage, +1 above, 0 in it; staged (m,): whether a spring has more than one
    stage; knots: largest breakpoint of every spring (m,) [rad], 0 of linear ones.
    """

    assembly: Assembly
    springs: tuple[str, ...]
    sliders: tuple[str, ...]
    source: Integers
    turns: bool
    speed: float | None
    inverse: Array
    drag: Array
    constant: Array
    constant_by_speed: Array
    harmonics: tuple[LineHarmonic, ...]
    force: Complex
    error: Complex
    pieces: Array
    guards: Array
    then: Integers
    counts: Integers
    sides: Integers
    moves: Array

    @property
    def name(self) -> str:
        """Of the line."""
        return self.assembly.line.name or "driveline"

    @property
    def size(self) -> int:
        """Number m of unknown twists and deflections, the rotation of the first inertia included where it counts."""
        return len(self.inverse)

    @property
    def rows(self) -> tuple[str, ...]:
        """Names of the springs and of the sliders."""
        return self.springs + self.sliders

    @property
    def kept(self) -> Integers:
        """Places of a state (2m,) that determine the motion and come back in a periodic one: not the rotation of the
        first inertia, nor the rates of sliders, which are those of their springs."""
        m = self.size
        idle = {m + int(e) for e in np.flatnonzero(self.source != np.arange(m))} | ({m - 1} if self.turns else set())
        return np.array([i for i in range(2 * m) if i not in idle])

    @property
    def slider_rows(self) -> range:
        """Rows of the sliders."""
        return range(len(self.springs), len(self.springs) + len(self.sliders))

    @cached_property
    def placed(self) -> tuple[PlacedSlider, ...]:
        """The sliders, in the order of their rows."""
        return sliders(self.assembly.packed, self.assembly.topology, self.assembly.table(1)[0])

    def speed_at(self, value: float) -> float:
        """Mean input speed [rad/s] at a value of the clock; NaN where nothing depends on it."""
        return value if self.independent_variable == "speed" else np.nan if self.speed is None else self.speed

    def within_limits(self, state: Array) -> Array:
        """A state (2m,), deflections of sliders beyond what they hold brought back to it."""
        found = state.copy()
        for row in self.slider_rows:
            found[row] = np.clip(state[row], -self.knots[row], self.knots[row])
        return found

    def holding(self, stuck: Sequence[int], value: float) -> StagedFlow:
        """The flow at a value of the clock with the sliders in the rows ``stuck`` kept from slipping."""
        flow, guards = self.flow(value), self.guards.copy()
        guards[list(stuck), :, :, 2] *= HELD
        return replace(flow, guards=guards)

    @property
    def staged(self) -> Integers:
        """Places of the springs with several stages."""
        return np.flatnonzero(self.counts[: len(self.springs)] > 1)

    @cached_property
    def knots(self) -> Array:
        """Largest breakpoint of every spring (m,) [rad], 0 where it has none."""
        watched = self.then >= 0
        by_twist = np.where(self.guards[..., 0] == 0, 1.0, np.abs(self.guards[..., 0]))
        return np.asarray(np.where(watched, np.abs(self.guards[..., 2]) / by_twist, 0.0).max(axis=(1, 2)))

    @cached_property
    def independent_variable(self) -> IndependentVariable:
        """What turns the excitation: the speed of the line, frequencies in time, both or nothing."""
        if not self.harmonics:
            return "none"
        if not any(one.order for one in self.harmonics):
            return "frequency"
        first = self.harmonics[0].standstill
        return "speed" if np.allclose([one.standstill for one in self.harmonics], first, ROUNDING, 0.0) else "both"

    @cached_property
    def base(self) -> float:
        """The frequency [rad/s] that all harmonics are multiples of, at the line's own speed.

        Raises
        ------
        InputError : nothing excites the line, or there is none of usable size.
        """
        swinging = {float(abs(w)) for w in self._frequencies(self.speed or 0.0) if w}
        if not swinging:
            still = "stands still" if self.harmonics else "is excited by nothing"
            raise InputError(
                f"{still}, so its motion has no period", element="driveline", key="excitation",
                remedy="give a disk an excitation or a mesh a transmission_error; tn.exact_motion takes it as it is",
            )  # fmt: skip
        return common_frequency(sorted(swinging))

    @property
    def value(self) -> float:
        """The clock's own value: the speed, or the common frequency [rad/s]."""
        return float(self.speed or 0.0) if self.independent_variable == "speed" else self.base

    def period(self, value: float | None = None) -> float:
        """Common period [s] of all excitation, at another value of the clock perhaps.

        Raises
        ------
        InputError : it all but stands still there.
        """
        period = 2 * np.pi / self.base
        if value is None:
            return period
        still = self.standstill
        if still and abs(value - still) * LONGEST_PERIOD < abs(value):
            raise InputError(
                "all but stands still there, so that its motion has no period of usable length", element="driveline",
                key="excitation", remedy=f"stay away from {still * 30 / np.pi:.5g} rpm, or use tn.exact_motion",
            )  # fmt: skip
        return abs(period * (self.value - still) / (value - still))

    @property
    def standstill(self) -> float:
        """Value of the clock at which all excitation that goes with it stands still; 0 but for orders that have a
        frequency beside them."""
        return self.harmonics[0].standstill if self.independent_variable == "speed" else 0.0

    def period_slope(self, value: float) -> float:
        """Derivative of the period by the value of the clock, over the period."""
        return -1 / (value - self.standstill) if self.independent_variable in ("speed", "frequency") else 0.0

    def _frequencies(self, speed: float) -> Array:
        """Of all harmonics [rad/s], of either sign."""
        return np.array([float(one.turning(speed)) for one in self.harmonics])

    def flow(self, value: float | None = None) -> StagedFlow:
        """The flow, at another value of the clock perhaps, with its derivative by that value."""
        m, speed, stretch, by_speed = self.size, self.speed or 0.0, 1.0, self.independent_variable == "speed"
        if value is not None:
            speed, stretch = (value, 1.0) if by_speed else (speed, value / self.value)
        orders = np.array([float(one.order) for one in self.harmonics])
        in_time = np.array([one.frequency for one in self.harmonics])
        omega = turning(orders, in_time * stretch, speed)
        rate = orders if by_speed or self.independent_variable in ("both", "none") else in_time / self.value
        error, dragged, w = self.error, self.error @ self.drag.T, omega[:, None]
        return StagedFlow(
            inverse=self.inverse,
            drag=self.drag,
            constant=self.constant + self.constant_by_speed * speed,
            frequencies=omega,
            force=self.force - w**2 * error + 1j * w * dragged,
            constant_slope=self.constant_by_speed if by_speed else np.zeros(m),
            frequency_slope=np.asarray(rate),
            force_slope=(-2 * w * error + 1j * dragged) * np.reshape(rate, (-1, 1)),
            pieces=self.pieces,
            guards=self.guards,
            then=self.then,
            counts=self.counts,
            moves=self.moves,
            source=self.source,
        )

    def errors(self, time: float) -> tuple[Array, Array]:
        """Transmission errors as angles of the output gears (m,) [rad], and their rates."""
        turns = 1j * self._frequencies(self.speed or 0.0)[:, None]
        turned = self.error * np.exp(turns * time)
        return turned.real.sum(axis=0), (turns * turned).real.sum(axis=0)

    def rest(self) -> Array:
        """The state (2m,) at t = 0 in which the line turns uniformly: the start of ``simulate``."""
        return np.concatenate(self.errors(0.0))

    def from_rotations(self, state: Array, time: float = 0.0) -> Array:
        """The state (2m,), twists and their rates, of deviations from uniform rotation and rates (2n,)."""
        e, rate = self.errors(time)
        n = len(state) // 2
        twisting = twisting_of(self.assembly.topology, self.turns)
        own = self.source == np.arange(self.size)
        twists = np.concatenate([twisting @ state[:n] + e[own], twisting @ state[n:] + rate[own]])
        return self.from_twists(twists)

    def from_twists(self, state: Array) -> Array:
        """The state (2m,) from twists and rates of the springs and the first inertia's rotation, as if all sliders had
        last been at rest without twist."""
        own = np.flatnonzero(self.source == np.arange(self.size))
        place = np.searchsorted(own, self.source)
        q, v = state[: len(own)][place], state[len(own) :][place]
        reach = np.where(self.source == np.arange(self.size), np.inf, self.knots)
        return np.concatenate([np.clip(q, -reach, reach), v])


def staged_line(line: Driveline | Assembly, speed: float | str | None = None) -> StagedLine:
    """The line as an exact flow.

    Parameters
    ----------
    speed : mean input speed [rad/s], by which mesh phases and orders turn into frequencies and viscous loads have a
        mean; by default that of the line's operation. Asked for only where it matters.

    Raises
    ------
    InputError : a bent Hooke's or tripod joint, a mesh stiffness that varies, impact damping, a quadratic load, two
        prescribed speeds, no speed where one is needed.
    """
    if not isinstance(line, Driveline | Assembly):
        raise InputError(
            f"is a {type(line).__name__}, which has no exact motion by stages", key="line", remedy="give a Driveline"
        )
    assembly = assemble(line)
    refuse_second_speed(assembly)
    require_tree(assembly, "exact motions do")
    _refuse_inexact(assembly)
    own = assembly.line.operation.speed if assembly.line.operation else None
    return _Builder(assembly, own if speed is None else one_speed(speed, "speed")).build()


def refuse_lost_speed(line: StagedLine) -> None:
    """Refuse a free line whose excitation would turn with a speed that its torques do not keep.

    Raises
    ------
    InputError : so.
    """
    assembly = line.assembly
    if line.speed is None or line.independent_variable not in ("speed", "both"):
        return
    table = assembly.table(1, line.speed)
    if imbalance(assembly, table)[0]:
        raise InputError(
            "is free–free and its torques do not balance, so that it leaves the speed that its excitation turns with: "
            f"{torques_in_words(assembly, table[0])}",
            element="driveline", key="load_torque",
            remedy="give the driving disk drive_share = 1, or use tn.simulate, which lets the line turn by itself",
        )  # fmt: skip


def twisting_of(topo: Topology, turns: bool) -> Array:
    """E (m, n): twist of every spring per rotation of every unknown; a last row for the first inertia's rotation."""
    rows = [*topo.elongations]
    if turns:
        rows.append(np.eye(topo.size)[topo.coordinate[0]])
    return np.array(rows)


def _refuse_inexact(assembly: Assembly) -> None:
    elsewhere = "use tn.simulate, tn.periodic_response or tn.periodic_branch, which locate changes of stage"
    line, topo = assembly.line, assembly.topology
    laws = zip(topo.joints, joint_laws(assembly, assembly.table(1)), strict=True)
    nonuniform = {line.names[topo.stations[j].element] for j, law in laws if law.nonuniform}
    refuse_dragged(assembly)
    refuse_slip_clutches(line)
    refuse_pendulums(line)
    refuse_torque_tables(line, elsewhere)
    for element, name in zip(line.elements, line.names, strict=True):
        found: tuple[str, str] | None = None
        if name in nonuniform:
            found = "angle", "bends the line, so that no stage is linear with constant coefficients"
        elif isinstance(element, GearPair) and element.stiffness_variation:
            found = "stiffness_variation", "makes the stages vary in time, so that no motion is exact"
        elif isinstance(element, GearPair) and element.impact_damping:
            found = "impact_damping", "goes with the depth of contact, so that no stage is linear"
        elif isinstance(element, Rotor) and any(one.varies for one in element.excitation):
            found = "excitation", "has an amplitude that depends on the speed or the load"
        elif isinstance(element, Rotor) and element.tangent:
            found = "curve", "goes with the speed, so that no stage is linear with constant coefficients"
        elif isinstance(element, Rotor) and element.loaded_by_square:
            found = (
                "drag_area" if getattr(element, "drag_area", 0.0) else "quadratic_load",
                "is not linear in the speed, so that no motion is exact",
            )
        if found:
            key, problem = found
            value = getattr(element, key)
            raise InputError(
                problem, element=name, key=key, value=value if isinstance(value, float) else None, remedy=elsewhere
            )


def common_frequency(frequencies: Sequence[float]) -> float:
    """The frequency [rad/s] that all, rising, are multiples of.

    Raises
    ------
    InputError : none of usable size.
    """
    count = periods_in_common(frequencies, MOST_ORDER, CLOSE)
    if not count or frequencies[-1] * count / frequencies[0] > MOST_ORDER:
        raise InputError(
            "have no common period of usable length", element="driveline", key="excitation",
            value=list(frequencies), remedy="round the frequencies to a common step",
        )  # fmt: skip
    return frequencies[0] / count


class _Builder:
    """The parts of a ``StagedLine``, each by its own rule."""

    def __init__(self, assembly: Assembly, speed: float | None) -> None:
        self.assembly, self.topo, self.speed = assembly, assembly.topology, speed
        self.row = assembly.table(1)[0]
        self.coefficients = assembly.coefficients(self.row[None], statically_twisted=False, free_play=True)
        self.laws = staged_springs(assembly, self.row)
        self.viscous = self.topo.on_unknowns(self.coefficients.viscous)[0]
        """V (n,)."""
        self.turns = self.topo.free and bool(self.viscous.any())
        self.sliders = sliders(assembly.packed, assembly.topology, self.row)
        own = twisting_of(self.topo, self.turns)
        count = len(self.topo.compliances)
        places = [*range(count), *(slider.compliance for slider in self.sliders), *range(count, len(own))]
        self.own = np.array([i for i in range(len(places)) if not count <= i < count + len(self.sliders)])
        self.source = self.own[places]
        self.twisting = own[places]
        mass = aligned_matrices(self.topo, self.coefficients).mass[0]
        self.accelerated = self.twisting / mass
        """E M⁻¹, (m, n)."""
        unknown = self.topo.unknown_of
        self.push = np.where(unknown >= 0, self.accelerated[:, unknown] * self.topo.relative_ratios, 0.0)
        """q″ by a unit torque at every station (m, station)."""

    def build(self) -> StagedLine:
        line, topo = self.assembly.line, self.topo
        drag = np.zeros((len(self.twisting),) * 2)
        if self.viscous.any():
            drag[:, self.own] = (self.accelerated * self.viscous) @ np.linalg.inv(self.twisting[self.own])
        constant = -self.push @ (self.coefficients.load[0] * np.sign(topo.mean_speeds))
        by_speed = -self.push @ (self.coefficients.viscous[0] * topo.mean_speeds)
        every = line_harmonics(self.assembly, self.row)
        harmonics = [one for one in every if one.acts and np.any(self._amplitudes(one))]
        amplitudes = np.reshape([self._amplitudes(one) for one in harmonics], (len(harmonics), 2, len(self.twisting)))
        force, error = amplitudes.astype(complex).swapaxes(0, 1)
        needed = any(one.order for one in harmonics) or bool(by_speed.any() and not topo.free)
        speed = self.speed
        if needed and not (speed and 0 < speed < np.inf):
            raise InputError(
                "is needed by what turns with the line", key="speed", value=speed,
                remedy="give speed=tn.rpm(1500), say",
            )  # fmt: skip
        parts = self._parts()
        springs = tuple(line.spring_name(c.shafts, c.number) for c in topo.compliances)
        inverse, names = self.accelerated @ self.twisting.T, tuple(s.name for s in self.sliders)
        return StagedLine(
            assembly=self.assembly, springs=springs, sliders=names, source=self.source, turns=self.turns, speed=speed,
            inverse=inverse, drag=drag, constant=constant, constant_by_speed=by_speed,
            harmonics=tuple(harmonics), force=force, error=error,
            pieces=_padded([part.pieces for part in parts], 0.0), guards=_padded([part.guards for part in parts], 0.0),
            then=_padded([part.then for part in parts], -1), counts=np.array([len(part.pieces) for part in parts]),
            sides=_padded([part.side for part in parts], 0), moves=_padded([part.moves for part in parts], 1.0),
        )  # fmt: skip

    def _amplitudes(self, one: LineHarmonic) -> Complex:
        """What a harmonic does to the twists (2, m): in q″, and as an error. A torque by order acts at the mean
        rotation: it does not follow the deviation of its own disk."""
        found = np.zeros((2, len(self.twisting)), dtype=complex)
        size = one.size(self.assembly, self.row[None])[0]
        if isinstance(one, DiskTorque):
            found[0] = self.push[:, one.station] * float(np.sign(self.topo.mean_speeds[one.station])) * size
        elif isinstance(one, MeshError):
            found[1, one.mesh.compliance] = size
        return found

    def _parts(self) -> list[Stages]:
        """The stages of every row: springs, sliders, and the rotation of the first inertia, which carries nothing."""
        damping, stiffness = self.coefficients.damping[0], self.coefficients.stiffness[0]
        found = [Stages.apart([[c, k, 0.0]]) for c, k in zip(damping, stiffness, strict=True)]
        for e, spring in self.laws.items():
            found[e] = spring.law
        found += [slider.stages for slider in self.sliders]
        return found + [Stages.apart([[0.0, 0.0, 0.0]])] * (len(self.twisting) - len(found))


def _padded(rows: list[Any], fill: float) -> Any:
    """Arrays of unlike length, one below the other."""
    out = np.full((len(rows), max(map(len, rows)), *rows[0].shape[1:]), fill, dtype=rows[0].dtype)
    for place, row in zip(out, rows, strict=True):
        place[: len(row)] = row
    return out
