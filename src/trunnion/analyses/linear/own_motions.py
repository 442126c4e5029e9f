"""The periodic motions of a bent line that starts free, at many mean speeds, by harmonic balance.

    a(t, x, ẋ; torque) = ẍ,   x = Σ_h x_h e^{ihωt}

Newton's method on the harmonics and the torque that drives beyond the balance of the loads, its slopes those of the
compiled equations at samples of the motion. The mean deviation has no part of a turn of the whole line, which fixes the
phase. Excitations of disks and transmission errors are left out, as in ``own_motion``, which finds one motion by
shooting.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.orbits.free_orbit import loaded_by_speed
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import assemble
from trunnion.equations.exciters import quiet
from trunnion.equations.kinematics import base_motion, ratio_values
from trunnion.equations.line_system import LineSystem, line_system
from trunnion.equations.linear_clutches import mean_by_load, with_mean_clutches
from trunnion.equations.topology import require_period
from trunnion.numerics.integration.integration import kernel
from trunnion.numerics.spectrum import along, without

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
FEWEST, MOST = 6, 48
"""Harmonics of the period kept."""
CLOSED = 1e-8
"""Correction [rad] at which a motion is found."""
NEGLIGIBLE = 1e-10
"""Size of the outermost harmonics [rad] that is small enough."""
ITERATIONS = 12


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


def own_motions(line: Driveline, speeds: Array) -> OwnMotions | None:
    """Motions at all ``speeds`` [rad/s]; None for a line whose springs have stages or play.

    ``found`` is False where the harmonics did not settle.
    """
    described = assemble(quiet(line))
    if mean_by_load(line) and loaded_by_speed(described):
        return None
    assembly = assemble(with_mean_clutches(described, float(speeds[0])))
    prepared = line_system(assembly, float(speeds[0]))
    if prepared.system.regimes is not None:
        return None
    period = 2 * np.pi * float(require_period(assembly.line, assembly.topology))
    rate = max(float(r) for r in assembly.topology.rates) * period / (2 * np.pi)
    n = assembly.topology.size
    harmonics, before = max(FEWEST, int(np.ceil(3 * rate))), None
    while True:
        motions, guess = [], before
        for speed in speeds:
            problem = Balance(LineSystem(assembly, float(speed)), period, harmonics)
            motion = problem.solve(guess)
            guess = motion.deviation if motion.found else None
            motions.append(motion)
            if motion.found and motion.outermost > NEGLIGIBLE and harmonics < MOST:
                break
        else:
            break
        harmonics = min(2 * harmonics, MOST)
    slopes = np.stack([m.slopes for m in motions])
    damping = np.array([float(np.trace(m.slopes[0][n:, n:]).real) for m in motions])
    return OwnMotions(
        np.array([m.found and m.outermost <= NEGLIGIBLE for m in motions]),
        period,
        slopes,
        np.stack([m.shift for m in motions]),
        None if loaded_by_speed(assembly) else np.stack([m.drift for m in motions]),
        np.abs(damping) * period < 1e-12 * n,
    )


@dataclass(frozen=True)
class FreeMotion:
    """One motion: deviation (harmonic, n) [rad], harmonics −H … H; torque [N m at the input] that drives beyond the
    balance; outermost [rad]: size of the last harmonics; slopes (harmonic, 2n, 2n), and the rest as ``OwnMotions``."""

    found: bool
    deviation: Complex
    torque: float
    outermost: float
    slopes: Complex
    shift: Array
    drift: Array


class Balance:
    """The equations of the harmonics at one speed; the mean deviation has no part along ``phase`` (n,), by default a
    turn of the whole line."""

    def __init__(self, line: LineSystem, period: float, harmonics: int, phase: Array | None = None) -> None:
        self.line, self.count = line, harmonics
        topo = line.assembly.topology
        self.n, self.speed = topo.size, line.speed
        self.times = 4 * harmonics + 4
        self.rate = 2 * np.pi * line.speed / period
        self.period = period
        places = [topo.reference[g] for g, c in enumerate(topo.coordinate) if c >= 0]
        self.turn = np.array([float(topo.speed_ratio[s]) for s in places])
        self.phase = self.turn if phase is None else phase
        row = line.assembly.packed.values.copy()
        row[0] = line.speed
        self.row = row
        self.numbers = line.numbers(row)
        self.drive = line.numbers(row, drive=1.0) - self.numbers

    def start(self) -> Complex:
        """Rigid shafts, each twisted by the torque that it carries on average; (harmonic, n)."""
        topo, assembly = self.line.assembly.topology, self.line.assembly
        theta = self.period * np.arange(self.times) / self.times
        co = assembly.coefficients(self.row[None], statically_twisted=False, free_play=True)
        base, plain = (base_motion(topo, case, theta, ratio_values(topo)).angle[0] for case in (co, co.straight))
        places = [topo.reference[g] for g, c in enumerate(topo.coordinate) if c >= 0]
        states = (base - plain)[:, places]
        held = self.line.twisted()[: self.n] - self.line.rigid(0.0)[: self.n]
        return self._kept(np.fft.fft(states + held, axis=0) / self.times)

    def solve(self, guess: Complex | None) -> FreeMotion:
        """Newton's method from ``guess`` (harmonic, n), or from rigid shafts."""
        x = self.start() if guess is None or len(guess) != 2 * self.count + 1 else guess.copy()
        torque, found, slopes = 0.0, False, np.zeros((self.times, self.n, 2 * self.n))
        for _ in range(ITERATIONS):
            acceleration, slopes, drive = self.sampled(x, torque)
            step, more = self._step(x, acceleration, slopes, drive)
            if not np.all(np.isfinite(step)):
                break
            # Rounding would part the two halves of the spectrum from iteration to iteration.
            x, torque = x + (step + step[::-1].conj()) / 2, torque + more
            if np.abs(step).sum(axis=0).max() <= CLOSED:
                found = True
                break
        if not found and guess is not None:
            return self.solve(None)
        size = np.abs(x).max(axis=1)
        return FreeMotion(found, x, torque, float(max(size[0], size[-1])), *self._neutral(x, slopes))

    def _kept(self, spectrum: Complex) -> Complex:
        """Harmonics −H … H of a spectrum in NumPy's order."""
        return np.asarray(spectrum[np.arange(-self.count, self.count + 1) % self.times])

    def states(self, x: Complex) -> Array:
        """States (time, 2n) of harmonics."""
        h = np.arange(-self.count, self.count + 1)
        full = np.zeros((2, self.times, self.n), dtype=complex)
        full[0, h % self.times], full[1, h % self.times] = x, 1j * self.rate * h[:, None] * x
        # Each row goes to compiled code, so it must lie in one piece; how NumPy lays out strided parts joined varies.
        return np.ascontiguousarray(np.concatenate(list((np.fft.ifft(full, axis=1) * self.times).real), axis=1))

    def sampled(self, x: Complex, torque: float) -> tuple[Array, Array, Array]:
        """Accelerations (time, n), their slopes by the states (time, n, 2n) and by the torque (time, n)."""
        n, m = self.n, 2 * self.n
        states, numbers = self.states(x), self.numbers + torque * self.drive
        with_more = numbers + self.drive
        out = np.empty((self.times, m + 1, m))
        drive = np.empty((self.times, m))
        call, address = kernel().call_rate, self.line.system.rate.address
        block = np.concatenate([np.zeros((1, m)), np.eye(m)])
        length = self.period / self.speed
        for i, state in enumerate(states):
            time = length * i / self.times
            block[0] = state
            refused = call(address, time, block.ravel(), numbers, m, 0, out[i].reshape(-1))
            refused = refused or call(address, time, state, with_more, 0, 0, drive[i])
            if refused:
                out[i], drive[i] = np.nan, np.nan
        return out[:, 0, n:], out[:, 1:, n:].transpose(0, 2, 1), drive[:, n:] - out[:, 0, n:]

    def _step(self, x: Complex, acceleration: Array, slopes: Array, drive: Array) -> tuple[Complex, float]:
        """Newton's correction of the harmonics and of the torque."""
        n, h = self.n, np.arange(-self.count, self.count + 1)
        s = 1j * self.rate * h
        by_state = np.fft.fft(slopes, axis=0) / self.times
        place = (h[:, None] - h[None, :]) % self.times
        blocks = -by_state[place][..., :n] - by_state[place][..., n:] * s[None, :, None, None]
        blocks[np.arange(len(h)), np.arange(len(h))] += (s**2)[:, None, None] * np.eye(n)
        size = len(h) * n
        matrix = np.zeros((size + 1, size + 1), dtype=complex)
        matrix[:size, :size] = blocks.transpose(0, 2, 1, 3).reshape(size, size)
        matrix[:size, size] = -self._kept(np.fft.fft(drive, axis=0) / self.times).reshape(-1)
        unit = float(np.abs(matrix[:size, :size]).max())
        scale = unit / max(float(np.abs(matrix[:size, size]).max()), 1e-300)
        matrix[:size, size] *= scale
        matrix[size, self.count * n : self.count * n + n] = unit * self.phase / np.linalg.norm(self.phase)
        left = self._kept(np.fft.fft(acceleration, axis=0) / self.times) - (s**2)[:, None] * x
        right = np.append(left.reshape(-1), -unit * (self.phase @ x[self.count]) / np.linalg.norm(self.phase))
        try:
            found = np.linalg.solve(matrix, right)
        except np.linalg.LinAlgError:
            return np.full_like(x, np.nan), np.nan
        return found[:size].reshape(len(h), n), float(found[size].real * scale)

    def _neutral(self, x: Complex, slopes: Array) -> tuple[Complex, Array, Array]:
        """A's Fourier coefficients, the shift of the phase and the change of the speed, in energy-like units."""
        n, h = self.n, np.arange(-self.count, self.count + 1)
        spectrum = np.fft.fft(slopes, axis=0) / self.times
        co = self.line.assembly.coefficients(self.row[None], statically_twisted=False, free_play=True)
        root = np.sqrt(_inertia(self.line, co.inertia[0]))
        ratio = root[:, None] / root[None, :]
        stiffness = -spectrum[0, :, :n].real * ratio / self.speed**2
        unit = float(np.sqrt(max(np.abs(np.diag(stiffness)).mean(), 1e-300)))
        a = np.zeros((self.times, 2 * n, 2 * n), dtype=complex)
        a[0, :n, n:] = np.eye(n) * unit
        a[:, n:, :n] = spectrum[:, :, :n] * (ratio / (self.speed**2 * unit))
        a[:, n:, n:] = spectrum[:, :, n:] * (ratio / self.speed)
        scale = np.concatenate([root, root / unit])
        rate = (1j * h[:, None] * x).sum(axis=0).real * (self.rate / self.speed)
        acceleration = -((h[:, None] ** 2) * x).sum(axis=0).real * (self.rate / self.speed) ** 2
        shift = np.concatenate([rate + self.turn, acceleration]) * scale
        return a, shift, np.concatenate([np.zeros(n), self.turn]) * scale


def _inertia(line: LineSystem, by_station: Array) -> Array:
    """Inertia (n,) of the unknowns, each group's as its first station feels it on average."""
    topo = line.assembly.topology
    inertia = np.zeros(topo.size)
    for s, ratio in enumerate(topo.speed_ratio):
        i = topo.coordinate[topo.group_of(s)]
        if i >= 0:
            inertia[i] += by_station[s] * float(ratio / topo.speed_ratio[topo.reference[topo.group_of(s)]]) ** 2
    return inertia
