"""Campbell diagram: the modes of the loaded line over speed, what excites them, and where the two meet.

Modes are those of the aligned line with the slopes of its speed-dependent loads and the stages that its loads hold
springs in at each speed, followed by their shape. Orders are those of the disks' excitations (but for orders that the
firing of cylinders cancels), of transmission errors and varying meshes, and 2R and 4R of every angled joint, R the
speed of its input over the line's. A crossing has the amplification 1/(2ζ) of its mode; where a spring changes its
stage a mode jumps, and an order in the gap meets it nowhere.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Complex, Integers, Places
from trunnion.driveline.arguments import one_number, speeds_of
from trunnion.driveline.composite import owners
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.aligned import aligned_matrices
from trunnion.equations.coefficients import Assembly, assemble, joint_laws
from trunnion.equations.harmonics import DiskTorque, line_harmonics
from trunnion.equations.steady_base import has_joint_angles
from trunnion.errors import InputError
from trunnion.features import left_out
from trunnion.laws.harmonic import forward, turning
from trunnion.modes.loaded_modes import loaded_modes
from trunnion.numerics.bracketing import bracketed
from trunnion.results.counts import counted
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, computed, coordinate, internal, labelled, members, variable
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.results.result import Result
from trunnion.results.speeds import order_name
from trunnion.results.units import amplification_words
from trunnion.steady.orders.forced_response import shaft_names

if TYPE_CHECKING:
    from trunnion.driveline.operation import Operation

MULTIPLES = (1, 2)
"""Of a joint's own orders; the second is weaker by the square of the angle."""
MARGIN = 0.10
CANCELLED = 1e-9
"""What all cylinders give together, over one of them, below which an order is cancelled by their firing."""
CLOSE = 1e-9
"""Share of the speed within which a crossing of a mode that moves is found."""


@labelled
class ExcitationLine:
    """Frequency = |order · Ω + frequency|, and what excites with it.

    torque: NaN where none acts (joints, meshes, transmission errors) or a table does not reach all speeds.
    """

    order: float = variable("", "1")
    frequency: float = variable("", "rad/s", name="fixed_frequency")
    causes: tuple[str, ...] = internal("elements that excite")
    torque: float = variable("", "N*m", "of disks, the largest", default=np.nan)
    owners: tuple[str, ...] = internal(
        "elements of the file that excite: of an engine's throws, the engine", default=()
    )

    @property
    @computed(variable("", "1", "elements that excite"))
    def sources(self) -> int:
        """How many elements excite."""
        return len(self.causes)

    @property
    def name(self) -> str:
        """ "order 2", "77.7 Hz" of an excitation fixed in time, "77.7 Hz -2 per turn" of one by both."""
        return order_name(self.order, self.frequency)

    def at(self, speed: ArrayLike) -> Array:
        """Its frequency [rad/s] at input speeds [rad/s]."""
        return np.abs(turning(self.order, self.frequency, np.asarray(speed)))

    @property
    def standstill(self) -> float:
        """Input speed [rad/s] at which it turns back up from zero; infinite where no speed moves it."""
        return -self.frequency / self.order if self.order else np.inf

    def __str__(self) -> str:
        return self.name


@labelled
class Crossing:
    """Where an excitation line meets a mode."""

    speed: float = variable("", "rad/s", name="crossing_speed")
    frequency: float = variable("", "rad/s", name="crossing_frequency")
    mode: int = variable(name="crossing_mode")
    line: ExcitationLine = variable(name="crossing_line")
    damping_ratio: float = internal("ζ", "1")

    @property
    @computed(variable("", "1", "1/(2ζ)"))
    def amplification(self) -> float:
        """1/(2ζ); infinite without damping."""
        return 1 / (2 * self.damping_ratio) if self.damping_ratio > 0 else np.inf


@labelled
class CampbellDiagram(Result):
    """Modes over speed and what crosses them; the first is mode 2 where the line can turn as a whole."""

    speed: Array = coordinate("speed", "rad/s")
    mode: Integers = coordinate("mode")
    frequency: Array = variable("speed mode", "rad/s", "damped")
    damping_ratio: Array = variable("speed mode", "1", "NaN where a mode does not oscillate")
    rotations: tuple[str, ...] = coordinate("rotation")
    springs: tuple[str, ...] = coordinate("spring")
    kinetic: Array = variable("rotation mode", "1", "share of the kinetic energy, at the middle speed")
    potential: Array = variable("spring mode", "1", "share of the elastic energy, at the middle speed")
    lines: tuple[ExcitationLine, ...] = members(
        ExcitationLine, "excitation_line", name="name", only="order torque sources frequency"
    )
    crossings: tuple[Crossing, ...] = members(Crossing, "crossing", "by speed")
    margin: float = attribute("half width of the band about the modes")
    jumps: tuple[tuple[float, int, ExcitationLine], ...] = internal("speed [rad/s], mode and excitation it jumps over")
    bent: bool = internal("whether modes are those of joints made straight")
    remarks: tuple[Finding, ...] = internal("what is left out")
    unit: str = internal("of speeds in print")

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What to read first, gravest first."""
        jumps = [
            Finding(
                Gravity.NOTE,
                f"Mode {mode} jumps over {line.name} at {self.words.speed(float(f'{speed:.5g}'))}, where a spring "
                "changes its stage: on either side of that speed the order is not at resonance.",
            )
            for speed, mode, line in self.jumps
        ]
        return by_gravity([*jumps, *self.remarks])

    def named(self, mode: int) -> str:
        """What moves in a mode and which spring holds most of its energy."""
        m = int(np.flatnonzero(self.mode == mode)[0])
        moves, bends = int(self.kinetic[:, m].argmax()), int(self.potential[:, m].argmax())
        return (
            f"{self.rotations[moves]} ({100 * self.kinetic[moves, m]:.0f} % of the motion) on "
            f"{self.springs[bends]} ({100 * self.potential[bends, m]:.0f} % of the twist)"
        )

    def near(self, speed: float) -> tuple[tuple[float, int, ExcitationLine], ...]:
        """(distance, mode, line) of everything within ``margin`` at an input ``speed`` [rad/s], nearest first.

        Distance is excitation over natural frequency less one.
        """
        found = []
        for m, number in enumerate(self.mode):
            here = float(np.interp(speed, self.speed, self.frequency[:, m]))
            for line in self.lines:
                off = float(line.at(speed)) / here - 1
                if abs(off) <= self.margin:
                    found.append((off, int(number), line))
        return tuple(sorted(found, key=lambda one: abs(one[0])))

    def _lines(self) -> Iterator[str]:
        straight = ", joints made straight" if self.bent else ""
        modes, times = counted(len(self.mode), "mode"), counted(len(self.crossings), "time")
        yield f"{modes} from {self.words.ends(self.speed[0], self.speed[-1])}{straight}, crossed {times}"
        for m, number in enumerate(self.mode):
            hertz = self.frequency[:, m] / (2 * np.pi)
            low, high = np.nanmin(hertz, initial=np.inf), np.nanmax(hertz, initial=-np.inf)
            if not low <= high:
                yield f"  mode {number}: overdamped, does not oscillate"
                continue
            size = f"{low:.4g} Hz" if high - low <= 5e-4 * high else f"{low:.4g} to {high:.4g} Hz"
            yield f"  mode {number}: {size}, {self.named(int(number))}"
        for c in self.crossings:
            yield (
                f"  {self.words.speed(float(f'{c.speed:.5g}'))}: {c.line.name} ({', '.join(c.line.owners)}) on mode "
                f"{c.mode} ({c.frequency / (2 * np.pi):.4g} Hz), amplification {amplification_words(c.amplification)}"
            )
        if not self.lines:
            yield "  Nothing excites this line."

    def plot(
        self,
        axes: Axes | None = None,
        *,
        unit: str | None = None,
        frequency_unit: str = "Hz",
        operating: Operation | None = None,
    ) -> Axes:
        """Modes with their margin over speed, excitation lines, crossings; see ``pictures.campbell_diagram``."""
        return drawing(self, "plot")(self, axes, unit=unit, frequency_unit=frequency_unit, operating=operating)


def campbell_diagram(
    line: Driveline | Assembly,
    speeds: ArrayLike,
    *,
    load_case: str | None = None,
    margin: float = MARGIN,
) -> CampbellDiagram:
    """Modes of ``line`` over input ``speeds`` [rad/s], ascending, and every crossing with an excitation.

    Parameters
    ----------
    line : the driveline.
    speeds : at which modes are computed; crossings are interpolated between them.
    load_case : name of one of the line's load cases.
    margin : half width of the band about the modes, as a share of their frequency.

    Raises
    ------
    InputError : fewer than two speeds, or none in ascending order; a margin that is not a share.

    Examples
    --------
    >>> import trunnion as tn
    >>> engine = tn.Disk(inertia=0.2, excitation=[{"order": 2, "amplitude": 100.0}])
    >>> line = tn.Driveline([engine, tn.Shaft(stiffness=1e4, damping=2.0), tn.Disk(inertia=0.8)])
    >>> (crossing,) = tn.campbell_diagram(line, [100.0, 150.0]).crossings
    >>> print(crossing.line.name, crossing.mode, round(crossing.speed, 2), round(crossing.amplification, 1))
    order 2 2 124.96 20.0
    """
    assembly = assemble(line, load_case)
    remedy = "np.linspace(tn.rpm(300), tn.rpm(3000), 101)"
    speed = speeds_of(speeds, remedy)
    if len(speed) < 2 or not np.all(np.isfinite(speed)) or not np.all(np.diff(speed) > 0):
        raise InputError("must be two or more, ascending", key="speeds", remedy=remedy)
    if not speed[0] >= 0:
        raise InputError("must not be negative", key="speeds", value=speed[0], remedy="start at 0 or above")
    if not 0 < one_number(margin, "margin", "0.1 for ten per cent") < 1:
        raise InputError("must lie between 0 and 1", key="margin", value=margin, remedy="0.1 for ten per cent")
    values, shapes = loaded_modes(assembly, speed)
    frequency = values.imag
    ratio = -values.real / np.abs(values)
    mode = np.arange(frequency.shape[1]) + 1 + assembly.topology.still
    lines = excitation_lines(assembly, speed)
    kinetic, potential = _energies(assembly, float(speed[len(speed) // 2]), shapes[len(speed) // 2])
    met, jumps = [], []
    for one, m in product(lines, range(len(mode))):
        # Where it turns forward, and where it turns the other way beyond its standstill.
        ways = [one, replace(one, order=-one.order, frequency=-one.frequency)]
        for way in ways if 0 < one.standstill < speed[-1] else ways[:1]:
            for at, here, zeta in _crossings(assembly, speed, frequency[:, m], ratio[:, m], way):
                if zeta is None:
                    jumps.append((at, int(mode[m]), one))
                else:
                    met.append(Crossing(at, here, int(mode[m]), one, zeta))
    return CampbellDiagram(
        speed=speed, mode=mode, frequency=frequency, damping_ratio=ratio, rotations=assembly.topology.names,
        springs=shaft_names(assembly), kinetic=kinetic, potential=potential, lines=lines,
        crossings=tuple(sorted(met, key=lambda c: c.speed)), margin=margin,
        jumps=tuple(sorted(jumps, key=lambda jump: jump[0])), bent=has_joint_angles(assembly),
        remarks=left_out("campbell_diagram", assembly.line), unit=speed_unit(assembly.line),
    )  # fmt: skip


def excitation_lines(assembly: Assembly, speeds: Array) -> tuple[ExcitationLine, ...]:
    """Everything that excites at ``speeds`` [rad/s], equal lines together, ascending."""
    topo, names = assembly.topology, assembly.line.names
    named = tuple(zip(names, assembly.line.elements, strict=True))
    found: dict[tuple[float, float], dict[str, None]] = {}
    torques: dict[tuple[float, float], float] = {}
    for one in line_harmonics(assembly):
        largest = _largest(assembly, one, speeds) if isinstance(one, DiskTorque) else np.nan
        if not one.acts or largest == 0:
            continue
        sense = forward(one.order, one.frequency)
        key = float(sense * one.order), sense * one.frequency
        found.setdefault(key, {})[one.name] = None
        if isinstance(one, DiskTorque):
            torques[key] = torques.get(key, 0.0) + largest
    for j, law in zip(topo.joints, joint_laws(assembly, assembly.table(1)), strict=True):
        if law.nonuniform:
            for cycles in (m * float(rate) for rate in topo.joint_rates(j) for m in MULTIPLES):
                found.setdefault((cycles, 0.0), {})[names[topo.stations[j].element]] = None
    for mesh in topo.meshes:
        for rate in mesh.stiffness_rates:
            found.setdefault((float(rate), 0.0), {})["mesh stiffness"] = None
    return tuple(
        ExcitationLine(k, f, tuple(causes), torques.get((k, f), np.nan), owners(named, causes))
        for (k, f), causes in sorted(found.items())
    )


def _largest(assembly: Assembly, torque: DiskTorque, speeds: Array) -> float:
    """Largest of a harmonic torque over the speeds [N m]: 0 where its cylinders cancel it, NaN where a table does not
    reach."""
    if abs(torque.cylinders) <= CANCELLED:
        return 0.0
    try:
        return float(np.abs(torque.size(assembly, assembly.table(len(speeds), speeds))).max())
    except InputError:
        return np.nan


def _energies(assembly: Assembly, speed: float, shape: Complex) -> tuple[Array, Array]:
    """Shares of kinetic (rotation, mode) and elastic energy (spring, mode) at a speed."""
    assembly = assembly.at(speed)
    coefficients = assembly.coefficients(assembly.table(1, speed), any_frequency=True)
    kinetic = (shape.conj() * (aligned_matrices(assembly.topology, coefficients).inertia[0] @ shape)).real
    potential = coefficients.stiffness[0][:, None] * np.abs(assembly.topology.elongations @ shape) ** 2
    return kinetic / kinetic.sum(axis=0), potential / potential.sum(axis=0)


def _crossings(
    assembly: Assembly, speed: Array, mode: Array, ratio: Array, line: ExcitationLine
) -> Iterator[tuple[float, float, float | None]]:
    """Speed, frequency and damping ratio where a line that turns forward meets a mode; without a ratio where the mode
    jumps over it."""
    off = line.order * speed + line.frequency - mode
    for i in range(len(speed)):
        if off[i] == 0:
            yield float(speed[i]), float(mode[i]), float(ratio[i])
        if i + 1 == len(speed) or not off[i] * off[i + 1] < 0:
            continue
        if mode[i] == mode[i + 1]:
            at = float(speed[i] + off[i] / (off[i] - off[i + 1]) * (speed[i + 1] - speed[i]))
            yield at, line.order * at + line.frequency, float(ratio[i])
            continue
        yield closed_in(assembly, (float(speed[i]), float(speed[i + 1])), float(mode[i]), line)


def closed_in(
    assembly: Assembly, between: tuple[float, float], first: float, line: ExcitationLine
) -> tuple[float, float, float | None]:
    """Speed, frequency and damping ratio where a line that turns forward meets a mode between two speeds; without a
    ratio where the mode jumps over it, just behind the jump. ``first``: frequency of the mode at the lower speed
    [rad/s]."""

    def here(at: float) -> tuple[float, float, float]:
        values, _ = loaded_modes(assembly, np.array([between[0], at]))
        m = int(np.nanargmin(np.abs(values[0].imag - first)))
        found = values[1, m]
        return line.order * at + line.frequency - found.imag, found.imag, -found.real / abs(found)

    def off_at(points: Array, which: Places) -> Array:
        return np.array([here(float(at))[0] for at in points])

    low, high = between
    ends = np.array([line.order * low + line.frequency - first]), off_at(np.array([high]), np.arange(1))
    (at,) = bracketed(off_at, np.array([low]), np.array([high]), CLOSE * high, known=ends).tolist()
    off, frequency, ratio = here(at)
    if abs(off) <= 10 * CLOSE * abs(frequency) * max(abs(line.order), 1.0):
        return at, frequency, ratio
    behind = min(at + CLOSE * high, high)
    return behind, here(behind)[1], None
