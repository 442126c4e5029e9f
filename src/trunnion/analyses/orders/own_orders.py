"""Orders of a bent line that starts free, about its own periodic motion.

    ẍ = a(t, x, ẋ) + M⁻¹ g,     δẍ = a_x(t) δx + a_ẋ(t) δẋ + M⁻¹ g

about the motion that joints force by themselves, found by harmonic balance at every speed; a_x and a_ẋ are the slopes
of the compiled nonlinear equations along it. A disturbance at order K = κ + mb has the harmonics κ + hb, b cycles per
turn. At κ = 0 a shift of the phase solves the equations without forcing: the torque of the drives is one more unknown
there, and the mean deviation of the input is none.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.linear.own_motions import MotionsBySpeed
from trunnion.analyses.orders.channels import channels_of, channels_of_harmonics
from trunnion.equations.coefficients import Assembly, LineCoefficients
from trunnion.equations.exciters import BaseOfExcitation
from trunnion.equations.kinematics import base_motion, ratio_values
from trunnion.equations.line_system import LineSystem
from trunnion.equations.linear import stiffness_waves
from trunnion.equations.steady_base import refuse_own_motion
from trunnion.equations.topology import Link, Topology
from trunnion.errors import ComputationError

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class OwnBase:
    """The own motion at one speed, at ``tau`` (time,) over the period, and the equations linearised about it.

    relative (time, station): r of each station from its group's first; ratio (time, spring) of the near ends; mass
    (time, n); base: what excitations need; seen (time, channel): the motion itself; by_state (harmonic, n, 2n) and
    by_drive (harmonic, n): Fourier coefficients of the slopes of accelerations, by states and by the drives' torque;
    phase (n,): the input among the unknowns; rate b Ω [rad/s]; count: harmonics kept on each side.
    """

    tau: Array
    relative: Array
    ratio: Array
    mass: Array
    base: BaseOfExcitation
    wave: Array
    seen: Array
    by_state: Complex
    by_drive: Complex
    coefficients: LineCoefficients
    phase: Array
    rate: float
    count: int


class OwnOrders:
    """Own motions of one line, speed after speed."""

    def __init__(self, assembly: Assembly, solved: MotionsBySpeed | None = None) -> None:
        self.solved = solved or MotionsBySpeed(assembly.line)
        if self.solved.hindered:
            refuse_own_motion(assembly, f"{self.solved.hindered}: use tn.periodic_response")
        self.quiet, self.balance = self.solved.quiet, self.solved.balance
        self.topo, self.period, self.phase = self.quiet.topology, self.balance.period, self.balance.phase

    def at(self, speed: float) -> OwnBase:
        """The motion at mean input ``speed`` [rad/s].

        Raises
        ------
        ComputationError : no motion found.
        """
        motion = self.solved.at(speed)
        if not motion.found:
            raise ComputationError(f"no own motion of the free line was found at {speed * 30 / np.pi:.5g} rpm")
        topo, co = self.topo, motion.coefficients
        ratios = ratio_values(topo)
        tau = self.period * np.arange(motion.times) / motion.times
        rates, slopes = motion.sampled()
        drive = motion.sampled(more=1.0)[0] - rates
        observed = LineSystem(self.quiet, speed).observe(motion.rate(motion.torque), tau / speed, motion.states)
        uniform = base_motion(topo, co.straight, tau, ratios).angle[0]
        rigid = base_motion(topo, co, tau, ratios).angle[0] - uniform
        relative = _relative(topo, co, uniform + observed.rotation, ratios)
        mass = np.zeros((len(tau), topo.size))
        for s in range(len(topo.stations)):
            if (i := topo.coordinate[topo.group_of(s)]) >= 0:
                mass[:, i] += co.inertia[0, s] * relative[:, s] ** 2
        places = channels_of(topo)
        seen = np.zeros((len(tau), places.count))
        seen[:, places.twist], seen[:, places.torque] = observed.twist, observed.torque
        seen[:, places.deviation] = observed.rotation[:, topo.firsts]
        before = [topo.stations[joint].before for joint in topo.joints]
        # Equations are linear about the own motion: where the load twists a joint's input to on average is no swing.
        swing = observed.rotation - rigid
        seen[:, places.joint_input] = (swing - swing.mean(axis=0))[:, before]
        return OwnBase(
            tau=tau,
            relative=relative,
            ratio=relative[:, [c.near for c in topo.compliances]],
            mass=mass,
            base=BaseOfExcitation(relative[None], observed.rotation[None]),
            wave=stiffness_waves(topo, co, tau),
            seen=seen,
            by_state=np.fft.fft(slopes[:, topo.size :], axis=0) / len(tau),
            by_drive=np.fft.fft(drive[:, topo.size :], axis=0) / len(tau),
            coefficients=co,
            phase=self.phase,
            rate=2 * np.pi * speed / self.period,
            count=motion.h,
        )


def _relative(topo: Topology, co: LineCoefficients, angle: Array, ratios: Array) -> Array:
    """r (time, station) of every station from its group's first, where stations stand at ``angle`` (time, station)."""
    r, laws = np.ones_like(angle), list(co.joints)
    for s, station in enumerate(topo.stations):
        b = station.before
        if station.link is Link.JOINT:
            _, eta, _, _ = laws.pop(0).at(angle[None, :, b] + co.shift[:, s, None])
            r[:, s] = eta[0] * r[:, b]
        elif station.link not in (Link.ROOT, Link.SHAFT):
            r[:, s] = r[:, b] / ratios[s]
    return r


def about(own: OwnBase, carrier: float, h: Integers, right: Complex) -> Complex:
    """X (h, n) [rad] at harmonics ``h`` under accelerations ``right`` (h, n).

    ``carrier`` [rad/s] is κΩ, or a frequency fixed in time.
    """
    n, times = own.mass.shape[1], len(own.tau)
    s = 1j * (carrier + own.rate * h)
    apart = h[:, None] - h[None, :]
    known = (np.abs(apart) < times // 2)[..., None, None]
    slopes = np.where(known, own.by_state[apart % times], 0.0)
    blocks = -slopes[..., :n] - slopes[..., n:] * s[None, :, None, None]
    every = np.arange(len(h))
    blocks[every, every] += (s**2)[:, None, None] * np.eye(n)
    size = len(h) * n
    matrix = np.zeros((size + 1, size + 1), dtype=complex)
    matrix[:size, :size] = blocks.transpose(0, 2, 1, 3).reshape(size, size)
    unit = float(np.abs(matrix[:size, :size]).max())
    matrix[size, size] = unit
    if carrier == 0 and h[0] <= 0 <= h[-1]:
        column = own.by_drive[h % times].reshape(-1)
        at = int(-h[0]) * n
        matrix[:size, size] = -column * (unit / np.abs(column).max())
        matrix[size, at : at + n], matrix[size, size] = unit * own.phase, 0.0
    found = np.linalg.solve(matrix, np.append(right.reshape(-1), 0.0))[:size].reshape(len(h), n)
    return np.asarray(found, dtype=complex)


def seen_about(own: OwnBase, topo: Topology, h: Integers, x: Complex) -> Complex:
    """Channels (1, h, channel) without torque of X (h, n)."""
    times = 1 << int(np.ceil(np.log2(len(h) + len(own.tau))))
    ratio, relative = _finer(own.ratio, times)[None], _finer(own.relative, times)[None]
    return channels_of_harmonics(topo, x[None], h, times, ratio, relative)


def _finer(values: Array, times: int) -> Array:
    """Periodic values (time, …) at ``times`` samples instead."""
    return np.asarray(np.fft.irfft(np.fft.rfft(values, axis=0), times, axis=0) * (times / len(values)))


Add = Callable[[Fraction, float, Complex], None]


def add_own(own: OwnBase, cycles: Fraction, add: Add) -> None:
    """The own motion's harmonics, ``add``ed by order."""
    spectrum = np.fft.fft(own.seen, axis=0) / len(own.tau)
    for h in range(-own.count, own.count + 1):
        add(h * cycles, 0.0, spectrum[None, h % len(own.tau)])
