"""Campbell diagram: the modes of the loaded line over speed, what excites them, and where the two meet.

Modes are those of the aligned line with the slopes of its speed-dependent loads and the stages that its loads hold
springs in at each speed, followed by their shape. Orders are those of the disks' excitations (but for orders that the
firing of cylinders cancels), of transmission errors and varying meshes, and 2R and 4R of every bent joint, R the speed
of its input over the line's. A crossing has the amplification 1/(2ζ) of its mode; where a spring changes its stage a
mode jumps, and an order in the gap meets it nowhere.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Complex, Integers
from trunnion.driveline.arguments import one_number, speeds_of
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.coefficients import Assembly, assemble, joint_laws
from trunnion.equations.harmonics import DiskTorque, line_harmonics
from trunnion.equations.steady_base import bent
from trunnion.errors import InputError
from trunnion.features import left_out
from trunnion.laws.harmonic import forward, turning
from trunnion.modes.loaded_modes import loaded_modes
from trunnion.results.counts import counted
from trunnion.results.declared import Held, Judged, axis, over, remark
from trunnion.results.drawing import Axes, drawing
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.results.speeds import order_name, show_speed
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


@dataclass(frozen=True)
class ExcitationLine:
    """Frequency = |order · Ω + frequency| [rad/s], and what excites with it.

    torque [N m]: largest amplitude, over the speeds, of the disks' torques of that order, added up; NaN where none acts
    (joints, meshes, transmission errors) or a table does not reach all speeds.
    """

    order: float
    frequency: float
    causes: tuple[str, ...]
    torque: float = np.nan

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


@dataclass(frozen=True)
class Crossing:
    """Where an excitation line meets a mode: input speed and frequency [rad/s], mode by its number, ζ, 1/(2ζ)."""

    speed: float
    frequency: float
    mode: int
    line: ExcitationLine
    damping_ratio: float

    @property
    def amplification(self) -> float:
        """1/(2ζ); infinite without damping."""
        return 1 / (2 * self.damping_ratio) if self.damping_ratio > 0 else np.inf


@dataclass(frozen=True, repr=False)
class CampbellDiagram(Judged):
    """Modes over speed and what crosses them.

    speed (speed,) [rad/s]; mode (mode,) numbers, 2 first where the line can turn as a whole; frequency (speed, mode)
    damped [rad/s] and damping_ratio (speed, mode) [1], NaN where a mode does not oscillate; kinetic (rotation, mode)
    and potential (spring, mode): shares of the energy at the middle speed; lines: excitations; crossings: by speed;
    margin: half width of the band about the modes [1]; jumps: speeds [rad/s] at which a mode jumps over an excitation,
    with its number and that excitation; bent: whether modes are those of joints made straight; remarks: what is left
    out.
    """

    speed: Array
    mode: Integers
    frequency: Array
    damping_ratio: Array
    kinetic: Array
    potential: Array
    rotations: tuple[str, ...]
    springs: tuple[str, ...]
    lines: tuple[ExcitationLine, ...]
    crossings: tuple[Crossing, ...]
    margin: float
    jumps: tuple[tuple[float, int, ExcitationLine], ...]
    bent: bool
    remarks: tuple[Finding, ...]
    unit: str

    def findings_in(self, unit: str) -> tuple[Finding, ...]:
        """What to read first, gravest first, speeds in ``unit``."""
        jumps = [
            Finding(
                Gravity.NOTE,
                f"Mode {mode} jumps over {line.name} at {show_speed(float(f'{speed:.5g}'), unit)}, where a spring "
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

    def declared(self) -> Iterator[Held]:
        """Modes over speed, shares of energy, crossings."""
        yield axis("speed", self.speed, "rad/s")
        yield axis("mode", self.mode)
        yield axis("rotation", self.rotations)
        yield axis("spring", self.springs)
        yield axis("excitation_line", [line.name for line in self.lines])
        yield over("speed mode", "frequency", self.frequency, "rad/s", "damped")
        yield over("speed mode", "damping_ratio", self.damping_ratio, "1")
        yield over("rotation mode", "kinetic", self.kinetic, "1", "share of the kinetic energy")
        yield over("spring mode", "potential", self.potential, "1", "share of the elastic energy")
        yield over("excitation_line", "order", [line.order for line in self.lines], "1")
        yield over("excitation_line", "torque", [line.torque for line in self.lines], "N*m", "of disks, the largest")
        yield over("excitation_line", "sources", [len(line.causes) for line in self.lines], "1", "elements that excite")
        yield over("excitation_line", "fixed_frequency", [line.frequency for line in self.lines], "rad/s")
        yield over("crossing", "crossing_speed", [c.speed for c in self.crossings], "rad/s")
        yield over("crossing", "crossing_frequency", [c.frequency for c in self.crossings], "rad/s")
        yield over("crossing", "crossing_mode", [c.mode for c in self.crossings])
        yield over("crossing", "crossing_line", [c.line.name for c in self.crossings])
        yield over("crossing", "amplification", [c.amplification for c in self.crossings], "1", "1/(2ζ)")
        yield remark("margin", self.margin)

    def describe(self, unit: str | None = None) -> str:
        """The modes by what moves, and the crossings, speeds in ``unit``."""
        unit = unit or self.unit
        span = f"{show_speed(self.speed[0], unit)} to {show_speed(self.speed[-1], unit)}"
        straight = ", joints made straight" if self.bent else ""
        modes, times = counted(len(self.mode), "mode"), counted(len(self.crossings), "time")
        rows = [f"{modes} from {span}{straight}, crossed {times}"]
        for m, number in enumerate(self.mode):
            hertz = self.frequency[:, m] / (2 * np.pi)
            low, high = np.nanmin(hertz, initial=np.inf), np.nanmax(hertz, initial=-np.inf)
            if not low <= high:
                rows.append(f"  mode {number}: overdamped, does not oscillate")
                continue
            size = f"{low:.4g} Hz" if high - low <= 5e-4 * high else f"{low:.4g} to {high:.4g} Hz"
            rows.append(f"  mode {number}: {size}, {self.named(int(number))}")
        for c in self.crossings:
            rows.append(
                f"  {show_speed(float(f'{c.speed:.5g}'), unit)}: {c.line.name} ({', '.join(c.line.causes)}) on mode "
                f"{c.mode} ({c.frequency / (2 * np.pi):.4g} Hz), amplification {amplification_words(c.amplification)}"
            )
        if not self.lines:
            rows.append("  Nothing excites this line.")
        rows += [f"  {finding}" for finding in self.findings_in(unit)]
        return "\n".join(rows)

    def plot(
        self,
        axes: Axes | None = None,
        *,
        unit: str | None = None,
        frequency_unit: str = "Hz",
        operating: Operation | None = None,
    ) -> Axes:
        """Modes with their margin over speed, excitation lines, crossings; see ``plots.campbell_diagram.draw``."""
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
    InputError : fewer than two speeds, or none in ascending order; a margin that is no share.

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
    mode = np.arange(frequency.shape[1]) + (2 if assembly.topology.free else 1)
    lines = excitation_lines(assembly, speed)
    kinetic, potential = _energies(assembly, shapes[len(speed) // 2])
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
        speed, mode, frequency, ratio, kinetic, potential, assembly.topology.names, shaft_names(assembly), lines,
        tuple(sorted(met, key=lambda c: c.speed)), margin, tuple(sorted(jumps, key=lambda jump: jump[0])),
        bent(assembly), left_out("campbell_diagram", assembly.line), speed_unit(assembly.line),
    )  # fmt: skip


def excitation_lines(assembly: Assembly, speeds: Array) -> tuple[ExcitationLine, ...]:
    """Everything that excites at ``speeds`` [rad/s], equal lines together, ascending."""
    topo, names = assembly.topology, assembly.line.names
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
        if law.uneven:
            for cycles in (m * float(rate) for rate in topo.joint_rates(j) for m in MULTIPLES):
                found.setdefault((cycles, 0.0), {})[names[topo.stations[j].element]] = None
    for mesh in topo.meshes:
        for rate in mesh.stiffness_rates:
            found.setdefault((float(rate), 0.0), {})["mesh stiffness"] = None
    return tuple(
        ExcitationLine(k, f, tuple(causes), torques.get((k, f), np.nan)) for (k, f), causes in sorted(found.items())
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


def _energies(assembly: Assembly, shape: Complex) -> tuple[Array, Array]:
    """Shares of kinetic (rotation, mode) and elastic energy (spring, mode)."""
    coefficients = assembly.coefficients(assembly.table(1), any_frequency=True)
    kinetic = assembly.aligned.mass[0][:, None] * np.abs(shape) ** 2
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
        yield _closed_in(assembly, (float(speed[i]), float(speed[i + 1])), float(mode[i]), line)


def _closed_in(
    assembly: Assembly, between: tuple[float, float], first: float, line: ExcitationLine
) -> tuple[float, float, float | None]:
    """The same between two speeds, by halving; ``first``: frequency of the mode at the lower one [rad/s]."""

    def here(at: float) -> tuple[float, float, float]:
        values, _ = loaded_modes(assembly, np.array([between[0], at]))
        m = int(np.nanargmin(np.abs(values[0].imag - first)))
        found = values[1, m]
        return line.order * at + line.frequency - found.imag, found.imag, -found.real / abs(found)

    low, high = between
    below = line.order * low + line.frequency < first
    while high - low > CLOSE * high:
        middle = (low + high) / 2
        off, frequency, ratio = here(middle)
        low, high = (middle, high) if (off < 0) == below else (low, middle)
    off, frequency, ratio = here(high)
    return high, frequency, ratio if abs(off) <= 10 * CLOSE * abs(frequency) * max(abs(line.order), 1.0) else None
