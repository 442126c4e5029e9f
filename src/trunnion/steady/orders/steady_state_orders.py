"""Orders of a free–free line with joint angles, about its own periodic motion.

    ẍ = a(t, x, ẋ) + M⁻¹ g,     δẍ = a_x(t) δx + a_ẋ(t) δẋ + M⁻¹ g

about the motion that joints force by themselves, found by harmonic balance at every speed; a_x and a_ẋ are the slopes
of the compiled nonlinear equations along it. A disturbance at order K = κ + mb has the harmonics κ + hb, b cycles per
turn. At κ = 0 a shift of the phase solves the equations without forcing: the torque of the drives is one more unknown
there, and the mean deviation of the input is none.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex, Integers
from trunnion.equations.coefficients import Assembly
from trunnion.equations.harmonics import BaseOfExcitation
from trunnion.equations.kinematics import base_motion
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.linear import stiffness_waves
from trunnion.equations.steady_base import refuse_periodic_base
from trunnion.equations.topology import Topology
from trunnion.errors import ComputationError
from trunnion.steady.free.periodic_steady_states import SteadyStatesBySpeed
from trunnion.steady.orders.channels import channels_of, channels_of_harmonics
from trunnion.steady.orders.steady_state_slopes import StateSlopes, TreeSlopes


@dataclass(frozen=True)
class SteadyStateBase:
    """The periodic steady states at some speeds, over the period, and the equations linearised about them.

    ratio (case, time, spring): r of the near ends; mass (case, time, n): by what torques are divided for the equations,
    1 where they are not; base: what excitations need; seen (case, time, channel): the motion itself; equations: what
    solves them; rate (case,) b Ω [rad/s]; count: harmonics kept on each side.
    """

    ratio: Array
    mass: Array | float
    base: BaseOfExcitation
    wave: Array
    seen: Array
    equations: StateSlopes | TreeSlopes
    coefficients: LineCoefficients
    rate: Array
    count: int


class SteadyStateOrders:
    """Periodic steady states of one line at any speeds."""

    def __init__(self, assembly: Assembly, solved: SteadyStatesBySpeed | None = None) -> None:
        self.solved = solved or SteadyStatesBySpeed(assembly.line)
        if self.solved.obstacle:
            refuse_periodic_base(assembly, f"{self.solved.obstacle}: use tn.periodic_response")
        self.unexcited, self.balance = self.solved.unexcited, self.solved.balance
        self.topo = self.unexcited.topology

    def at(self, speeds: Array) -> SteadyStateBase:
        """The motions at mean input ``speeds`` (case,) [rad/s].

        Raises
        ------
        ComputationError : no motion found.
        """
        motions = self.solved.at_all(speeds)
        if not motions.found.all():
            lost = speeds[~motions.found][0] * 30 / np.pi
            raise ComputationError(f"no periodic steady state of the free line was found at {lost:.5g} rpm")
        topo, co = self.topo, motions.coefficients
        tau = motions.tau
        observed = motions.observed()
        uniform = base_motion(topo, co.straight, tau).angle
        rigid = base_motion(topo, co, tau).angle - uniform
        relative = base_motion(topo, co, tau, stood=uniform + observed.rotation).relative
        places = channels_of(topo)
        seen = np.zeros((len(speeds), len(tau), places.count))
        seen[..., places.twist], seen[..., places.torque] = observed.twist, observed.torque
        seen[..., places.deviation] = observed.rotation[..., topo.firsts]
        seen[..., places.point] = observed.rotation[..., [station for station, _ in topo.points]]
        before = [topo.stations[joint].before for joint in topo.joints]
        # Equations are linear about the periodic steady state: where the load twists a joint's input to on average is
        # no swing.
        swing = observed.rotation - rigid
        seen[..., places.joint_input] = (swing - swing.mean(axis=1, keepdims=True))[..., before]
        return SteadyStateBase(
            ratio=relative[..., [c.near for c in topo.compliances]],
            mass=1.0 if self.balance.along_tree else topo.on_unknowns(co.inertia[:, None], relative),
            equations=TreeSlopes.of(motions) if self.balance.along_tree else StateSlopes.of(motions),
            base=BaseOfExcitation(relative, observed.rotation),
            wave=stiffness_waves(topo, co, tau),
            seen=seen,
            coefficients=co,
            rate=motions.rate,
            count=motions.h,
        )


def seen_about(own: SteadyStateBase, topo: Topology, h: Integers, x: Complex) -> Complex:
    """Channels (case, h, channel) without torque of X (case, h, n)."""
    times = 1 << int(np.ceil(np.log2(len(h) + own.ratio.shape[1])))
    return channels_of_harmonics(topo, x, h, times, _finer(own.ratio, times), _finer(own.base.relative, times))


def _finer(values: Array, times: int) -> Array:
    """Periodic values (case, time, …) at ``times`` samples instead."""
    return np.asarray(np.fft.irfft(np.fft.rfft(values, axis=1), times, axis=1) * (times / values.shape[1]))
