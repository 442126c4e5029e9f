"""Campbell diagram: the modes of the loaded line over speed, what excites them, and where the two meet.

Modes are those of the aligned line with the slopes of its speed-dependent loads, followed by their shape. Orders are
those of the disks' excitations, of transmission errors and varying meshes, and 2R and 4R of every bent joint, R the
speed of its input over the line's. A crossing has the amplification 1/(2ζ) of its mode.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trunnion.analyses.linear.forced_response import shaft_names
from trunnion.analyses.linear.loaded_modes import loaded_modes
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.aligned import aligned_matrices, elongation
from trunnion.equations.coefficients import Assembly, assemble, joint_laws
from trunnion.equations.exciters import exciters
from trunnion.errors import InputError
from trunnion.results.declared import Held, Result, axis, over, remark
from trunnion.results.drawing import drawing
from trunnion.results.speeds import show_speed

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
MULTIPLES = (1, 2)
"""Of a joint's own orders; the second is weaker by the square of the angle."""
MARGIN = 0.10


@dataclass(frozen=True)
class ExcitationLine:
    """Frequency = order · Ω + frequency [rad/s], and what excites with it."""

    order: float
    frequency: float
    causes: tuple[str, ...]

    @property
    def name(self) -> str:
        """ "order 2", or the frequency of an excitation fixed in time."""
        return show_speed(self.frequency, "Hz") if self.frequency else f"order {self.order:.4g}"


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
class CampbellDiagram(Result):
    """Modes over speed and what crosses them.

    speed (speed,) [rad/s]; mode (mode,) numbers, 2 first where the line can turn as a whole; frequency (speed, mode)
    damped [rad/s] and damping_ratio (speed, mode) [1], NaN where a mode does not oscillate; kinetic (rotation, mode)
    and potential (spring, mode): shares of the energy at the middle speed; lines: excitations; crossings: by speed;
    margin: half width of the band about the modes [1].
    """

    speed: Array
    mode: NDArray[np.int64]
    frequency: Array
    damping_ratio: Array
    kinetic: Array
    potential: Array
    rotations: tuple[str, ...]
    springs: tuple[str, ...]
    lines: tuple[ExcitationLine, ...]
    crossings: tuple[Crossing, ...]
    margin: float
    unit: str

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
                off = (line.order * speed + line.frequency) / here - 1
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
        rows = [f"{len(self.mode)} modes from {span}, crossed {len(self.crossings)} times"]
        for m, number in enumerate(self.mode):
            hertz = self.frequency[:, m] / (2 * np.pi)
            low, high = np.nanmin(hertz, initial=np.inf), np.nanmax(hertz, initial=-np.inf)
            if not low <= high:
                rows.append(f"  mode {number}: does not oscillate")
                continue
            size = f"{low:.4g} Hz" if high - low <= 5e-4 * high else f"{low:.4g} to {high:.4g} Hz"
            rows.append(f"  mode {number}: {size}, {self.named(int(number))}")
        for c in self.crossings:
            rows.append(
                f"  {show_speed(float(f'{c.speed:.5g}'), unit)}: {c.line.name} ({', '.join(c.line.causes)}) on mode "
                f"{c.mode} ({c.frequency / (2 * np.pi):.4g} Hz), amplification {c.amplification:.3g}"
            )
        if not self.lines:
            rows.append("  Nothing excites this line.")
        return "\n".join(rows)

    def plot(self, axes: Axes | None = None, **options: Any) -> Axes:
        """Modes with their margin over speed, excitation lines, crossings; see ``plots.campbell_diagram.draw``."""
        return drawing(self, "plot")(self, axes, **options)

    def __str__(self) -> str:
        return self.describe()


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
    if load_case is not None:
        line = (line.line if isinstance(line, Assembly) else line).with_load(load_case)
    assembly = line if isinstance(line, Assembly) else assemble(line)
    speed = np.atleast_1d(np.asarray(speeds, dtype=float))
    if speed.ndim != 1 or len(speed) < 2 or not np.all(np.isfinite(speed)) or not np.all(np.diff(speed) > 0):
        remedy = "np.linspace(tn.rpm(300), tn.rpm(3000), 101)"
        raise InputError("must be two or more, ascending", key="speeds", remedy=remedy)
    if not speed[0] >= 0:
        raise InputError("must not be negative", key="speeds", value=speed[0], remedy="start at 0 or above")
    if not 0 < margin < 1:
        raise InputError("must lie between 0 and 1", key="margin", value=margin, remedy="0.1 for ten per cent")
    values, shapes = loaded_modes(assembly, speed)
    frequency = values.imag
    ratio = -values.real / np.abs(values)
    mode = np.arange(frequency.shape[1]) + (2 if assembly.topology.free else 1)
    lines = excitation_lines(assembly)
    kinetic, potential = _energies(assembly, shapes[len(speed) // 2])
    met = [
        crossing
        for one in lines
        for m in range(len(mode))
        for crossing in _crossings(speed, frequency[:, m], ratio[:, m], int(mode[m]), one)
    ]
    return CampbellDiagram(
        speed, mode, frequency, ratio, kinetic, potential, assembly.topology.names, shaft_names(assembly), lines,
        tuple(sorted(met, key=lambda c: c.speed)), margin, speed_unit(assembly.line),
    )  # fmt: skip


def excitation_lines(assembly: Assembly) -> tuple[ExcitationLine, ...]:
    """Everything that excites, equal lines together, ascending."""
    topo, row, names = assembly.topology, assembly.packed.values, assembly.line.names
    found: dict[tuple[float, float], dict[str, None]] = {}
    for e in exciters(assembly):
        if not e.held and row[e.amplitude]:
            fixed = float(row[e.frequency]) if e.in_time else 0.0
            found.setdefault((0.0 if e.in_time else float(e.order), fixed), {})[e.element] = None
    for j, law in zip(topo.joints, joint_laws(assembly, assembly.table(1)), strict=True):
        if law.uneven:
            for cycles in (m * float(rate) for rate in topo.joint_rates(j) for m in MULTIPLES):
                found.setdefault((cycles, 0.0), {})[names[topo.stations[j].element]] = None
    for mesh in topo.meshes:
        for rate in mesh.stiffness_rates:
            found.setdefault((float(rate), 0.0), {})["mesh stiffness"] = None
    return tuple(ExcitationLine(k, f, tuple(causes)) for (k, f), causes in sorted(found.items()))


def _energies(assembly: Assembly, shape: Complex) -> tuple[Array, Array]:
    """Shares of kinetic (rotation, mode) and elastic energy (spring, mode)."""
    topo = assembly.topology
    coefficients = assembly.coefficients(assembly.table(1), any_frequency=True)
    mass = aligned_matrices(topo, coefficients).mass[0]
    kinetic = mass[:, None] * np.abs(shape) ** 2
    twist = np.array([elongation(topo, e) @ shape for e in range(len(topo.compliances))])
    potential = coefficients.stiffness[0][:, None] * np.abs(twist) ** 2
    return kinetic / kinetic.sum(axis=0), potential / potential.sum(axis=0)


def _crossings(speed: Array, mode: Array, ratio: Array, number: int, line: ExcitationLine) -> Iterator[Crossing]:
    off = line.order * speed + line.frequency - mode
    for i in range(len(speed) - 1):
        a, b = off[i], off[i + 1]
        if a == 0 or a * b < 0:
            share = 0.0 if a == 0 else a / (a - b)
            at = float(speed[i] + share * (speed[i + 1] - speed[i]))
            zeta = float(ratio[i] + share * (ratio[i + 1] - ratio[i]))
            yield Crossing(at, line.order * at + line.frequency, number, line, zeta)
