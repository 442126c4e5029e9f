"""Torque amplitudes over speed: the linear forced response of a line at many speeds at once.

The periodic solution is sought as x(τ) = Σ X_h e^{ihbτ}, b = 2π/period, so that M ẍ + C ẋ + K x = F becomes
one linear system per speed (Hill's infinite system, cut off):

    Σ_h [−(hbΩ)² M_{m−h} + i hbΩ C_{m−h} + K_{m−h}] X_h = F_m,

with M_k … the Fourier coefficients over the input angle. Of a line that starts free the mean drive torque is one
more unknown, and its mean deviation has no part of a rigid turn. A second solution with fewer harmonics tells how
far the series has converged. ``stability(...).response`` finds the same by integration, at one speed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trunnion.analyses.features import left_out
from trunnion.analyses.linear.forced_response import LINEAR_RANGE, joint_rotation, shaft_motion, shaft_names
from trunnion.analyses.linear.natural_frequencies import natural_frequencies
from trunnion.analyses.orders.response import order_response, without_excitation
from trunnion.analyses.orders.where_unstable import where_unstable
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.aligned import relative_ratio, rigid_rotation
from trunnion.equations.coefficients import Assembly, LineCoefficients, assemble, joint_laws
from trunnion.equations.exciters import exciters
from trunnion.equations.linear import LineMatrices, line_matrices
from trunnion.equations.loads import drive_places, drive_torques
from trunnion.equations.steady_base import bent, require_steady_base
from trunnion.equations.topology import Topology, require_period
from trunnion.errors import InputError
from trunnion.numerics import harmonics as fourier
from trunnion.numerics.memory import require_memory
from trunnion.results.counts import counted
from trunnion.results.declared import Held, Result, axis, over, remark
from trunnion.results.drawing import drawing
from trunnion.results.finding import Finding, by_gravity
from trunnion.results.speeds import show_speed
from trunnion.results.verdict import Verdict

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from trunnion.driveline.operation import Operation

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

FINE = 4096
"""Times in a period at which extremes are looked for: good to 3e-7 h² of the harmonic h."""
FEWEST, MOST = 6, 14
"""Harmonics of the joint excitation kept, by the largest joint angle: they fall off as tan^2h(β/2)."""
MESH_HARMONICS = (5, 4, 3, 2)
"""Multiples kept of the fastest harmonic of a mesh's stiffness: as many of these as there is room for."""
SMALL_ENOUGH = 1e-9
MOST_UNKNOWNS = 3000
BATCH = 40
"""Speeds solved together: bounded memory, and steps of progress."""
CLUSTER = np.array([-6.0, -3.0, -1.5, -0.75, -0.3, 0.0, 0.3, 0.75, 1.5, 3.0, 6.0])
"""Extra speeds about each resonance of the forced response, in half-widths of its peak."""


@dataclass(frozen=True, repr=False)
class SpeedSweep(Result):
    """Linear forced response over speed.

    speed (speed,) of the input [rad/s]; twist_amplitude (speed, shaft) [rad] and torque_amplitude (speed,
    shaft) [N m], half peak to peak; torque_mean (speed, shaft) [N m], negative where power flows from input
    to output; joint_rotation (speed,): largest deviation at any joint's input [rad], and ``linear`` whether it
    stays within the range in which the linear response can be trusted; cut_off (speed,): relative change of
    the amplitudes when a third of the harmonics is left out; ``findings`` say what of the line is left out.
    ``judged`` gives the stability of the motion at every speed, None where it is not judged.
    """

    speed: Array
    twist_amplitude: Array
    torque_amplitude: Array
    torque_mean: Array
    joint_rotation: Array
    cut_off: Array
    shafts: tuple[str, ...]
    findings: tuple[Finding, ...] = ()
    unit: str = "rad/s"
    judged: Callable[[], NDArray[np.int8]] | None = None
    lossy: bool = False

    @cached_property
    def verdict(self) -> NDArray[np.int8]:
        """Stability of the motion (speed,), codes of ``Verdict``; FAILED where it is not judged."""
        return np.full(len(self.speed), Verdict.FAILED, dtype=np.int8) if self.judged is None else self.judged()

    @property
    def linear(self) -> NDArray[np.bool_]:
        """Where the amplitudes can be trusted (speed,)."""
        return np.asarray(self.joint_rotation <= LINEAR_RANGE)

    def peak(self, shaft: str) -> tuple[float, float]:
        """Largest torque amplitude of a shaft [N m] and the speed it stands at [rad/s]."""
        column = self.torque_amplitude[:, self.shafts.index(shaft)]
        at = int(np.nanargmax(column))
        return float(column[at]), float(self.speed[at])

    def declared(self) -> Iterator[Held]:
        """Amplitudes over (speed, shaft)."""
        yield axis("speed", self.speed, "rad/s")
        yield axis("shaft", list(self.shafts))
        yield over("speed shaft", "twist_amplitude", self.twist_amplitude, "rad")
        yield over("speed shaft", "torque_amplitude", self.torque_amplitude, "N*m")
        yield over("speed shaft", "torque_mean", self.torque_mean, "N*m")
        yield over("speed", "joint_rotation", self.joint_rotation, "rad")
        yield over("speed", "linear", self.linear.astype(np.int8))
        yield over("speed", "cut_off", self.cut_off, "1")
        yield remark("linear_range", LINEAR_RANGE)

    def plot(self, axes: Axes | None = None, *, unit: str = "", operating: Operation | None = None) -> Axes:
        """Torque amplitude of every shaft over speed; see ``plots.torque_over_speed.draw``."""
        return drawing(self, "plot")(self, axes, unit=unit, operating=operating)

    def findings_in(self, unit: str) -> tuple[Finding, ...]:
        """What to read first, gravest first, speeds in ``unit``: where the motion is unstable, what is left out."""
        return by_gravity([*where_unstable(self.speed, self.verdict, unit, lossy=self.lossy), *self.findings])

    def describe(self, unit: str | None = None) -> str:
        """The result in a few lines, speeds in ``unit``, by default that of the line's description."""
        unit = unit or self.unit
        rows = [f"linear forced response at {counted(len(self.speed), 'speed')}"]
        for shaft in self.shafts:
            torque, at = self.peak(shaft)
            rows.append(f"  {shaft}: torque amplitude up to {torque:.4g} N m at {show_speed(at, unit)}")
        beyond = int(np.count_nonzero(~self.linear))
        if beyond:
            rows.append(
                f"  at {counted(beyond, 'speed')} a joint's input deviates by more than {LINEAR_RANGE} rad: indication "
                "only"
            )
        return "\n".join([*rows, *(f"  {finding}" for finding in self.findings_in(unit))])

    def __str__(self) -> str:
        return self.describe()


def speed_sweep(
    line: Driveline | Assembly,
    speeds: ArrayLike,
    *,
    statically_twisted: bool = True,
    progress: Callable[[float], None] | None = None,
) -> SpeedSweep:
    """Torque and twist amplitudes of every shaft at each of ``speeds`` [rad/s]; see ``sweep_speeds`` for a grid.

    Raises
    ------
    InputError : speeds that are not positive; a line without steady base motion or with too long a period.
    """
    assembly = line if isinstance(line, Assembly) else assemble(line)
    if not (assembly.topology.free and bent(assembly)):
        found = order_response(assembly, speeds, statically_twisted=statically_twisted, progress=progress)
        return SpeedSweep(
            found.speed,
            found.vibratory_twist,
            found.vibratory_torque,
            found.mean_torque,
            found.joint_rotation,
            found.cut_off,
            found.springs,
            found.remarks,
            found.unit,
            found.judged,
            bool(found.spectrum.loss.any()),
        )
    speed = np.atleast_1d(np.asarray(speeds, dtype=float))
    if speed.ndim != 1 or not len(speed) or not (np.all(np.isfinite(speed)) and np.all(speed > 0)):
        raise InputError(
            "must be positive and finite", key="speeds", remedy="np.linspace(tn.rpm(300), tn.rpm(3000), 301)"
        )
    every = assembly.table(len(speed))
    every[:, 0] = speed
    require_steady_base(assembly, every)
    topo = assembly.topology
    half_turns = 2 * require_period(assembly.line, topo)
    # In half turns of the fastest joint: behind a reduction, fewer in the period than of one at input speed.
    turning = float(max((rate for j in topo.joints for rate in topo.joint_rates(j)), default=2.0)) / 2
    joints, mesh = _harmonics(assembly) * turning * float(half_turns), topo.fastest * float(half_turns) / 2
    tried = (int(np.ceil(joints) + np.ceil(kept * mesh)) for kept in (MESH_HARMONICS if mesh else (0,)))
    harmonics = next((count for count in tried if (2 * count + 1) * topo.size <= MOST_UNKNOWNS), None)
    if harmonics is None:
        raise InputError(
            "repeats only after too many turns for a sweep over speed",
            element="driveline",
            remedy="use stability at single speeds",
        )
    period = np.pi * float(half_turns)
    parts = []
    for start in range(0, len(speed), BATCH):
        table = assembly.table(len(speed[start : start + BATCH]))
        table[:, 0] = speed[start : start + BATCH]
        coefficients = assembly.coefficients(table, statically_twisted=statically_twisted)
        parts.append(_amplitudes(topo, coefficients, period, harmonics, _border(assembly)))
        if progress:
            progress(min(1.0, (start + BATCH) / len(speed)))
    twist, torque, mean, rotation, cut_off = (np.concatenate(p) for p in zip(*parts, strict=True))
    said = (*left_out("speed_sweep", assembly.line), *without_excitation(assembly))
    unit = speed_unit(assembly.line)
    return SpeedSweep(speed, twist, torque, mean, rotation, cut_off, shaft_names(assembly), said, unit)


def sweep_speeds(line: Driveline | Assembly, low: float, high: float, points: int = 241) -> Array:
    """Speeds [rad/s] from ``low`` to ``high``, closer together about the peaks ω_i/(2m|R|) and ω_i/K of the response.

    An even grid alone would step over the peaks of lightly damped modes.
    """
    assembly = line if isinstance(line, Assembly) else assemble(line)
    require_memory(64.0 * points, key="points", value=points, remedy="ask for fewer speeds")
    modes = natural_frequencies(assembly)
    topo = assembly.topology
    orders = {m * float(rate) for j in topo.joints for rate in topo.joint_rates(j) for m in (1, 2, 3)}
    orders |= {float(e.order) for e in exciters(assembly) if not e.in_time and not e.held}
    found = [np.linspace(low, high, points)]
    for frequency, damping in zip(modes.frequency, modes.damping_ratio, strict=True):
        width = max(float(abs(damping)), 1e-4)
        for order in sorted(orders):
            found.append(frequency / order * (1 + width * CLUSTER))
    every = np.unique(np.concatenate(found))
    return every[(every >= low) & (every <= high)]


def _harmonics(assembly: Assembly) -> int:
    """As many as the largest bend asks for."""
    share = max((law.spread for law in joint_laws(assembly, assembly.table(1))), default=0.0)
    return int(np.clip(np.ceil(np.log(SMALL_ENOUGH) / np.log(max(share, 1e-12))), FEWEST, MOST))


def _amplitudes(
    topo: Topology, coefficients: LineCoefficients, period: float, harmonics: int, border: Border | None
) -> tuple[Array, Array, Array, Array, Array]:
    times = max(64, 8 * harmonics)
    tau = period * np.arange(times) / times
    matrices = line_matrices(topo, coefficients, tau)
    x, rate = _periodic(matrices, coefficients.speed, period, harmonics, border)
    twist, torque = shaft_motion(topo, coefficients, tau, x, rate)
    coarse = shaft_motion(
        topo, coefficients, tau, *_periodic(matrices, coefficients.speed, period, max(1, 2 * harmonics // 3), border)
    )[1]
    amplitude = _span(torque) / 2
    largest = np.maximum(amplitude.max(axis=1), 1e-300)
    cut_off = np.abs(_span(coarse) / 2 - amplitude).max(axis=1) / largest
    rotation = joint_rotation(topo, coefficients, tau, x).max(axis=1, initial=0.0)
    return _span(twist) / 2, amplitude, torque.mean(axis=1), rotation, cut_off


def _span(curves: Array) -> Array:
    """Largest minus smallest value of periodic ``curves`` (case, time, curve), between their samples too: as Fourier
    series they are evaluated at FINE times at least."""
    times = curves.shape[1]
    fine = times * int(np.ceil(FINE / times))
    spectrum = np.fft.rfft(curves, axis=1) * (fine / times)
    return np.asarray(np.ptp(np.fft.irfft(spectrum, fine, axis=1), axis=1))


@dataclass(frozen=True)
class Border:
    """What determines the mean rotation of a free line: generalised forces (n,) of a unit torque of its drives, which
    is an unknown beside the motion, and the rigid rotation (n,) that the mean deviation has no part of."""

    drive: Array
    turn: Array


def _border(assembly: Assembly) -> Border | None:
    topo = assembly.topology
    if not topo.free:
        return None
    share = drive_places(topo, assembly.packed.column, assembly.table(1))
    torque = -drive_torques(topo, share, np.ones(1))[0]
    drive = np.zeros(topo.size)
    for s, ratio in enumerate(topo.speed_ratio):
        i = topo.coordinate[topo.group_of(s)]
        drive[i] += torque[s] * relative_ratio(topo, s) * np.sign(float(ratio))
    return Border(drive, rigid_rotation(topo))


def _periodic(
    matrices: LineMatrices, speed: Array, period: float, harmonics: int, border: Border | None
) -> tuple[Array, Array]:
    """x and dx/dt (case, time, n) of the periodic solution."""
    mass, damping, stiffness, forcing = (
        np.fft.fft(part, axis=1) / part.shape[1]
        for part in (matrices.mass, matrices.damping, matrices.stiffness, matrices.forcing)
    )
    cases, times, n = forcing.shape
    h = np.arange(-harmonics, harmonics + 1)
    x, rate = np.zeros((2, cases, times, n), dtype=complex)
    for case in range(cases):
        s = 1j * h * (2 * np.pi / period) * speed[case]
        parts = [part[[case]] for part in (stiffness, damping, mass)]
        matrix = fourier.hill_blocks(s[None], h, parts).reshape(len(h) * n, len(h) * n)
        right = forcing[case, h % times].reshape(-1)
        if border is not None:
            matrix, right = _bordered(matrix, right, border, harmonics * n)
        found = np.linalg.solve(matrix, right)[: len(h) * n]
        found = found.reshape(len(h), n)
        x[case, h % times], rate[case, h % times] = found, found * s[:, None]
    return tuple((np.fft.ifft(part, axis=1) * times).real for part in (x, rate))  # type: ignore[return-value]


def _bordered(matrix: Complex, right: Complex, border: Border, place: int) -> tuple[Complex, Complex]:
    """The equations with an unknown torque and a condition more, both at the mean: its block begins at ``place``."""
    n, size = len(border.turn), len(right)
    wide = np.zeros((size + 1, size + 1), dtype=complex)
    wide[:size, :size] = matrix
    # In the units of the mean block, so that the condition of the whole stays that of its parts.
    unit = float(np.abs(matrix[place : place + n, place : place + n]).max()) or 1.0
    wide[place : place + n, size] = -unit * border.drive / np.linalg.norm(border.drive)
    wide[size, place : place + n] = unit * border.turn / np.linalg.norm(border.turn)
    return wide, np.append(right, 0.0)
