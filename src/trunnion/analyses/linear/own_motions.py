"""The periodic motions of a bent line that starts free, at many mean speeds, by harmonic balance.

The balance of ``orbits.harmonic_equations``, its parameter the torque that drives beyond the balance of the loads. The
mean deviation has no part of a turn of the whole line, which fixes the phase. Excitations of disks and transmission
errors are left out, as in ``own_motion``, which finds one motion by shooting.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.orbits.balancing import with_enough
from trunnion.analyses.orbits.free_orbit import loaded_by_speed, torque_scale
from trunnion.analyses.orbits.harmonic_equations import HarmonicEquations
from trunnion.driveline.driveline import Driveline
from trunnion.equations.aligned import aligned_matrices, rigid_rotation
from trunnion.equations.coefficients import Assembly, LineCoefficients, assemble
from trunnion.equations.exciters import quiet
from trunnion.equations.kinematics import base_motion, ratio_values
from trunnion.equations.line_system import LineSystem, line_system
from trunnion.equations.linear_clutches import mean_by_load, with_mean_clutches
from trunnion.equations.topology import require_period
from trunnion.numerics import harmonics as fourier
from trunnion.numerics.continuation.arclength import correct
from trunnion.numerics.integration.sampled_rates import sampled_rates
from trunnion.numerics.spectrum import along, without
from trunnion.systems.system import System

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
FEWEST, MOST = 6, 48
"""Harmonics of the period kept."""
CLOSED = 1e-7
"""Correction, in units of the states' scales, at which a motion is found."""
NEGLIGIBLE = 1e-10
"""Size of the outermost harmonics [rad] that is small enough."""


@dataclass(frozen=True)
class OwnMotions:
    """Slopes along the motions, and what is no disturbance of them.

    found (speed,); period [rad of input angle]; slopes: Fourier coefficients (speed, harmonic, 2n, 2n) of A in
    x′ = A(τ)x, states in energy-like units; shift, drift (speed, 2n): the disturbances that shift the phase, and that
    change the speed where no torque depends on it (else None).
    """

    found: NDArray[np.bool_]
    period: float
    slopes: Complex
    shift: Array
    drift: Array | None
    undamped: NDArray[np.bool_]

    def rates(self, which: NDArray[np.intp], tau: Array) -> Array:
        """A (case, time, 2n, 2n) at input angles ``tau``."""
        slopes = self.slopes[which]
        h = np.fft.fftfreq(slopes.shape[1], 1 / slopes.shape[1])
        wave = np.exp(1j * np.outer(tau, h) * (2 * np.pi / self.period))
        flat = slopes.reshape(*slopes.shape[:2], -1)
        return np.asarray((wave @ flat).real.reshape(len(which), len(tau), *slopes.shape[2:]))

    def beside_neutral(self, which: NDArray[np.intp], matrix: Array) -> Array:
        """Matrices (case, 2n − 1, 2n − 1) without the shift of the phase; 0 for the multiplier of the speed."""
        kept = []
        for case, z in zip(which, matrix, strict=True):
            if not np.isfinite(z).all():
                kept.append(np.full((z.shape[0] - 1, z.shape[0] - 1), np.nan))
                continue
            rest, basis = without(z, self.shift[case][:, None])
            kept.append(rest if self.drift is None else _deflated(rest, self.drift[case] @ basis))
        return np.stack(kept)


def _deflated(matrix: Array, direction: Array) -> Array:
    """``matrix`` with 0 in place of the eigenvalue whose eigenvector is nearest to ``direction``."""
    values, vectors = np.linalg.eig(matrix)
    place = along(matrix, direction)
    right, left = vectors[:, place], np.linalg.inv(vectors)[place]
    return np.asarray((matrix - values[place] * np.outer(right, left)).real)


def own_motions(line: Driveline, speeds: Array, solved: MotionsBySpeed | None = None) -> OwnMotions | None:
    """Motions at all ``speeds`` [rad/s]; None for a line whose springs have stages or play.

    ``solved`` : what is known of them already. ``found`` is False where the harmonics did not settle.
    """
    solved = solved or MotionsBySpeed(line)
    if solved.hindered:
        return None
    balance, motions = solved.balance, solved.at_all(speeds)
    times = max(motion.times for motion in motions)
    slopes, shift, drift = (np.stack(parts) for parts in zip(*(balance.about(m, times) for m in motions), strict=True))
    n = balance.assembly.topology.size
    damping = np.trace(slopes[:, 0, n:, n:], axis1=1, axis2=2).real
    return OwnMotions(
        np.array([m.found and m.resolved for m in motions]),
        balance.period,
        slopes,
        shift,
        None if loaded_by_speed(balance.assembly) else drift,
        np.abs(damping) * balance.period < 1e-12 * n,
    )


class MotionsBySpeed:
    """The motions of one line, each speed solved once: the orders and the stability along a range ask for the same.

    Phases count from zero rotation of the input.
    """

    def __init__(self, line: Driveline) -> None:
        self.line = line
        self.known: dict[float, FreeMotion] = {}

    @cached_property
    def hindered(self) -> str:
        """Why there is no balance of smooth equations for all speeds; empty where there is."""
        if mean_by_load(self.line) and loaded_by_speed(assemble(quiet(self.line))):
            return "the mean of its clutch changes with the speed besides"
        if line_system(self.quiet, 1.0).system.regimes is not None:
            return "it has stages or play besides"
        return ""

    @cached_property
    def quiet(self) -> Assembly:
        """The line without excitation, clutches that state a motion as their mean."""
        return assemble(with_mean_clutches(assemble(quiet(self.line)), 1.0))

    @cached_property
    def balance(self) -> FreeBalance:
        """What solves them."""
        topo = self.quiet.topology
        phase = np.eye(topo.size)[topo.coordinate[topo.group_of(0)]]
        return FreeBalance(self.quiet, 2 * np.pi * float(require_period(self.quiet.line, topo)), phase)

    def at_all(self, speeds: Array) -> list[FreeMotion]:
        """The motions at all ``speeds`` [rad/s]."""
        return [self.at(float(speed)) for speed in speeds]

    def at(self, speed: float) -> FreeMotion:
        """The motion at ``speed`` [rad/s], from that at the nearest known and with as many harmonics at least."""
        if speed not in self.known:
            found = [other for other, motion in self.known.items() if motion.found]
            near = self.known[min(found, key=lambda other: abs(other - speed))] if found else None

            def attempt(h: int, last: bool) -> FreeMotion | None:
                motion = self.balance.solve(speed, h, None if near is None else near.rows)
                return motion if last or motion.resolved or not motion.found else None

            self.known[speed] = with_enough(attempt, self.balance.fewest if near is None else near.h, MOST)
        return self.known[speed]


@dataclass(frozen=True)
class FreeMotion:
    """One motion: its states as series (2n, 2H + 1) [rad, rad/s]; torque [N m at the input] that drives beyond the
    balance; ``rate``: torque → system; the line's coefficients at its speed, about zero twist."""

    found: bool
    speed: float
    rows: Array
    torque: float
    rate: Callable[[float], System]
    coefficients: LineCoefficients

    @property
    def h(self) -> int:
        return fourier.order(self.rows)

    @property
    def times(self) -> int:
        """Samples of the period that hold the motion and its slopes."""
        return 4 * self.h + 4

    @property
    def resolved(self) -> bool:
        """Whether the outermost harmonics of all rotations are negligible."""
        rotations = self.rows[: len(self.rows) // 2]
        return bool(np.hypot(rotations[:, self.h], rotations[:, -1]).max() <= 2 * NEGLIGIBLE)

    @property
    def states(self) -> Array:
        """States (time, 2n)."""
        return np.ascontiguousarray(fourier.samples(self.rows, self.times).T)

    def sampled(self, more: float = 0.0) -> tuple[Array, Array]:
        """Rates (time, 2n) and their slopes (time, 2n, 2n) by the states, under ``more`` torque; NaN if none."""
        system, count = self.rate(self.torque + more), len(self.rows)
        assert system.forcing_period is not None
        times = system.forcing_period * np.arange(self.times) / self.times
        found = sampled_rates(system.equations, times, self.states, 0)
        missing = np.full((self.times, count), np.nan), np.full((self.times, count, count), np.nan)
        return missing if found is None else found[:2]


@dataclass(frozen=True)
class Torques:
    """The systems of a free line by the torque [N m] of its drives; scale (2n + 1,) of states and torque."""

    at: Callable[[float], System]
    scale: Array


class FreeBalance:
    """Motions of a free line of ``period`` [rad of input angle] by the balance of their harmonics; the mean deviation
    has no part along ``phase`` (n,), by default a turn of the whole line."""

    def __init__(self, assembly: Assembly, period: float, phase: Array | None = None) -> None:
        topo = assembly.topology
        self.assembly, self.period, self.turn = assembly, period, rigid_rotation(topo)
        self.phase = self.turn if phase is None else phase
        fastest = max(float(rate) for rate in topo.rates) * period / (2 * np.pi)
        self.fewest = max(FEWEST, int(np.ceil(3 * fastest)))

    def solve(self, speed: float, h: int, guess: Array | None) -> FreeMotion:
        """The motion of ``h`` harmonics at ``speed`` [rad/s] from a guess, or from rigid shafts."""
        line = LineSystem(self.assembly, speed)
        co = line.untwisted(self.row(speed)[None])
        torques = self._torques(line, co)
        n, wide = len(self.turn), 2 * h + 1
        across = np.zeros(2 * n * wide + 1)
        across[: n * wide : wide] = self.phase / np.linalg.norm(self.phase)
        equations = HarmonicEquations(over=torques, periods=1, h=h)
        for known in (None,) if guess is None else (guess, None):
            start = self._rigid(line, h, co) if known is None else fourier.resized(known, h)
            point = correct(
                equations.equations, np.append(start.ravel(), 0.0), across, scale=equations.scale, tolerance=CLOSED,
                to_rounding=True,
            )  # fmt: skip
            if point is not None:
                return FreeMotion(True, speed, equations.rows(point), point.parameter, torques.at, co)
        return FreeMotion(False, speed, start, 0.0, torques.at, co)

    def _torques(self, line: LineSystem, co: LineCoefficients) -> Torques:
        row = self.row(line.speed)
        numbers = line.numbers(row, known=co)
        drive = line.numbers(row, drive=1.0, known=co) - numbers
        system = replace(line.system, period=self.period / line.speed)

        def at(torque: float) -> System:
            return replace(system, numbers_of=lambda _: numbers + torque * drive)

        return Torques(at, np.append(np.asarray(system.scale), torque_scale(line, co)))

    def row(self, speed: float) -> Array:
        """The line's numbers at ``speed``."""
        return self.assembly.table(1, speed)[0]

    def _rigid(self, line: LineSystem, h: int, co: LineCoefficients) -> Array:
        """Rigid shafts, each twisted by the torque that it carries on average, as series (2n, 2h + 1)."""
        topo, count = self.assembly.topology, 4 * h + 4
        theta = self.period * np.arange(count) / count
        base, plain = (base_motion(topo, case, theta, ratio_values(topo)).angle[0] for case in (co, co.straight))
        held = (line.twisted() - line.rigid(0.0))[: topo.size]
        rows = fourier.rows_of((base - plain)[:, topo.firsts].T + held[:, None], h)
        rows[:, 0] -= self.phase * (self.phase @ rows[:, 0]) / (self.phase @ self.phase)
        return np.concatenate([rows, fourier.rate(rows, 2 * np.pi * line.speed / self.period)])

    def about(self, motion: FreeMotion, times: int) -> tuple[Complex, Array, Array]:
        """A's Fourier coefficients, ``times`` of them, the shift of the phase and the change of the speed, in
        energy-like units."""
        n, speed = len(self.turn), motion.speed
        rates, slopes = motion.sampled()
        spectrum = np.fft.fft(slopes[:, n:], axis=0) / motion.times
        root = np.sqrt(aligned_matrices(self.assembly.topology, motion.coefficients).mass[0])
        ratio = root[:, None] / root[None, :]
        stiffness = -spectrum[0, :, :n].real * ratio / speed**2
        unit = float(np.sqrt(max(np.abs(np.diag(stiffness)).mean(), 1e-300)))
        a = np.zeros((times, 2 * n, 2 * n), dtype=complex)
        a[0, :n, n:] = np.eye(n) * unit
        at = np.fft.fftfreq(motion.times, 1 / motion.times).astype(int)  # from the end where negative
        a[at, n:, :n] = spectrum[:, :, :n] * (ratio / (speed**2 * unit))
        a[at, n:, n:] = spectrum[:, :, n:] * (ratio / speed)
        scale = np.concatenate([root, root / unit])
        shift = np.concatenate([rates[0, :n] / speed + self.turn, rates[0, n:] / speed**2]) * scale
        return a, shift, np.concatenate([np.zeros(n), self.turn]) * scale
