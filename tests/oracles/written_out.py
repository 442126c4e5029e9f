"""The nonlinear equations of a line written out slowly, for any twist.

The unknowns are the angles a_g of the first station of each group that carries inertia (fork phases
included, so that a_g is what a joint in the group sees). From Lagrange, with the elongation
q_e = a_far − a_near − (fork offset) of each compliance and its torque f_e = k q_e + c q̇_e,

    J(a) ä + ½ J′(a) ȧ² = −Σ_e (∂q_e/∂a) f_e − Σ_s r_s M_s.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.topology import LinkKind, Topology

Array = NDArray[np.float64]


@dataclass(frozen=True)
class NonlinearLine:
    """Right-hand side of one line at one set of numbers, input at constant speed."""

    topology: Topology
    coefficients: LineCoefficients
    ratios: Array
    offset: Array

    def base_angles(self, tau: float) -> Array:
        """Angles a_g of the unknowns at zero twist when the input stands at ``tau`` [rad]."""
        topo, angles = self.topology, np.zeros(len(self.topology.stations))
        for s, station in enumerate(topo.stations):
            if station.link is LinkKind.ROOT:
                angles[s] = tau
            elif station.link is LinkKind.SHAFT:
                angles[s] = angles[station.before] + self.coefficients.shift[0, s]
            else:
                angles[s] = self._behind(s, angles[station.before])[0]
        return np.array([angles[topo.reference[g]] for g, c in enumerate(topo.coordinate) if c >= 0])

    def acceleration(self, time: float, angle: Array, rate: Array) -> Array:
        """ä [rad/s²] at ``time`` [s], from the angles [rad] and rates [rad/s] of the unknowns, shape (n,)."""
        topo, co = self.topology, self.coefficients
        a, v = np.zeros(len(topo.stations)), np.zeros(len(topo.stations))
        r, r1 = np.zeros_like(a), np.zeros_like(a)
        for s, station in enumerate(topo.stations):
            i, b = topo.coordinate[station.group], station.before
            if station.link in (LinkKind.ROOT, LinkKind.SHAFT):
                speed = float(co.speed[0])
                a[s], v[s] = (angle[i], rate[i]) if i >= 0 else (speed * time, speed)
                r[s] = 1.0
            else:
                a[s], eta, slope = self._behind(s, a[b])
                v[s] = eta * v[b]
                r[s], r1[s] = eta * r[b], eta * r1[b] + slope * r[b] ** 2
        inertia, inertia_slope, torque = (np.zeros(topo.size) for _ in range(3))
        for s in range(len(topo.stations)):
            i = topo.coordinate[topo.group_of(s)]
            if i >= 0:
                inertia[i] += co.inertia[0, s] * r[s] ** 2
                inertia_slope[i] += 2 * co.inertia[0, s] * r[s] * r1[s]
                torque[i] -= r[s] * co.load[0, s] * np.sign(float(topo.speed_ratio[s]))
        for e, compliance in enumerate(topo.compliances):
            ref, near = topo.reference[compliance.far_group], compliance.near
            f = co.stiffness[0, e] * (a[ref] - a[near] - self.offset[e]) + co.damping[0, e] * (v[ref] - v[near])
            far_i, near_i = topo.coordinate[compliance.far_group], topo.coordinate[topo.group_of(near)]
            if far_i >= 0:
                torque[far_i] -= f
            if near_i >= 0:
                torque[near_i] += r[near] * f
        return np.asarray((torque - inertia_slope * rate**2 / 2) / inertia)

    def _behind(self, s: int, before: float) -> tuple[float, float, float]:
        """Angle behind a joint or ratio, its speed ratio and the slope of that ratio."""
        if self.topology.stations[s].link is LinkKind.RATIO:
            return before / self.ratios[s], 1 / self.ratios[s], 0.0
        law = self.coefficients.joints[self.topology.joints.index(s)]
        passed = law.at(np.array([[before + self.coefficients.shift[0, s]]]))
        return passed.output.item() + law.turned, passed.ratio.item(), passed.slope.item()


def nonlinear_line(assembly: Assembly, table: Array) -> NonlinearLine:
    """The nonlinear equations at one row of packed numbers."""
    topo = assembly.topology
    coefficients = assembly.coefficients(table, statically_twisted=False)
    entered = {station.element: s for s, station in enumerate(topo.stations) if station.link is LinkKind.SHAFT}
    offset = np.array([sum(coefficients.shift[0, entered[i]] for i in c.shafts) for c in topo.compliances])
    return NonlinearLine(topo, coefficients, topo.ratio_values, offset)
