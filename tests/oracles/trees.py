"""Any line of the package by virtual work, with exact derivatives.

For any virtual rotation of one unknown, Σ J_s α_s ∂a_s + Σ f_e ∂q_e + Σ M_s sgn ∂a_s = 0 over all points s of
the line and shafts e. The functions take complex numbers, so that derivatives are exact by the complex step, and many
states at once, (unknown, many).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import trunnion as tn
from oracles.chains import QUARTER, Numpy, joint_law

Array = NDArray[np.float64]


def _hooke(joint: Any, chi: Any) -> tuple[Any, Any, Any]:
    psi, eta, slope, _ = joint_law(Numpy, chi, np.cos(joint.angle))
    return psi + QUARTER, eta, slope


def _two_crosses(joint: Any, chi: Any) -> tuple[Any, Any, Any]:
    """One cross after the other; the centres' distances from the point where the axes meet give their angles."""
    first = np.arctan(np.sin(joint.angle) / (joint.distance_ratio + np.cos(joint.angle)))
    psi, eta, slope, _ = joint_law(Numpy, chi, np.cos(first))
    last, ratio, more, _ = joint_law(Numpy, psi + QUARTER, np.cos(joint.angle - first))
    return last + QUARTER - np.pi, ratio * eta, more * eta**2 + ratio * slope


def _tripod(joint: Any, chi: Any) -> tuple[Any, Any, Any]:
    """The output runs ahead by A sin 3χ, A = R/2L tan β tan²(β/2); a driving spider by as much behind."""
    a = joint.radius / (2 * joint.length) * np.tan(joint.angle) * (1 - np.cos(joint.angle)) / (1 + np.cos(joint.angle))
    a = -a if joint.spider == "input" else a
    return chi + a * np.sin(3 * chi), 1 + 3 * a * np.cos(3 * chi), -9 * a * np.sin(3 * chi)


def _rzeppa(joint: Any, chi: Any) -> tuple[Any, Any, Any]:
    psi, eta, slope = chi, 1.0, 0.0
    for h in joint.ripple:
        a, m = h.amplitude, h.order
        if joint.reference_angle is not None:
            a = a * (np.tan(joint.angle) / np.tan(joint.reference_angle)) ** h.growth
        psi = psi + a * np.sin(m * chi + h.phase)
        eta, slope = eta + m * a * np.cos(m * chi + h.phase), slope - m * m * a * np.sin(m * chi + h.phase)
    return psi, eta, slope


LAWS = {
    "HookeJoint": _hooke, "TripodJoint": _tripod, "RzeppaJoint": _rzeppa, "DoubleCardanJoint": _two_crosses,
}  # fmt: skip


@dataclass
class _Point:
    """A point: owner unknown (−1: prescribed), angle a, r = ∂a/∂owner, ∂r/∂owner, mean speed ratio."""

    owner: int
    angle: Any
    r: Any
    r1: Any
    mean: float


class Tree:
    """Any line of the package; unknowns are the inertia-carrying points behind shafts, in order.

    Shafts that end where there is no inertia are joined in series (stiffness exactly; such shafts must be
    undamped or equally damped in proportion).
    """

    def __init__(self, line: tn.Driveline, speed: float) -> None:
        self.line, self.speed = line, speed
        self.unknowns, self.massless = self._sort()

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.unknowns)

    def _sort(self) -> tuple[list[int], set[int]]:
        """Elements (shafts) that begin an unknown, and shafts that end without inertia."""
        elements, parents = self.line.elements, self.line.parents
        leader: list[int] = []  # the shaft (or root) that begins the rigid group each element ends in
        heavy: set[int] = set()
        for i, element in enumerate(elements):
            parent = parents[i]
            leader.append(i if parent is None or element.kind in ("Shaft", "GearPair") else leader[parent])
            if element.kind == "Disk":
                heavy.add(leader[i])
            if element.kind == "Shaft" and element.density:
                heavy |= {i, leader[parent] if parent is not None else i}
        fixed = {leader[i] for i, e in enumerate(elements) if e.kind == "ConstantSpeed"}
        shafts = {i for i, e in enumerate(elements) if e.kind == "Shaft"}
        return sorted(heavy - fixed), shafts - heavy

    def _points(self, time: float, angle: Any) -> tuple[list[_Point], list[tuple[_Point, _Point, Any, Any, Any]]]:
        """A point per element (its far end), and per compliance: near, far, elongation, k, c."""
        points: list[_Point] = []
        springs: list[tuple[_Point, _Point, Any, Any, Any]] = []
        waiting: dict[int, tuple[_Point, float, float, float]] = {}  # series shafts: near point, offset, 1/k, c/k²
        root = 0 in self.unknowns
        for i, element in enumerate(self.line.elements):
            parent = self.line.parents[i]
            if parent is None:
                a = angle[0] if root else self.speed * time
                points.append(_Point(0 if root else -1, a, 1.0, 0.0, 1.0))
                if element.kind != "Shaft":
                    continue
            before = points[parent] if parent is not None else points[0]
            if element.kind == "Shaft":
                k, c = element.torsional_stiffness, element.damping_coefficient
                near, offset, soft, lossy = waiting.get(parent if parent is not None else -1, (before, 0.0, 0.0, 0.0))
                offset, soft, lossy = offset + element.fork_offset, soft + 1 / k, lossy + c / k**2
                if i in self.massless:
                    waiting[i] = (near, offset, soft, lossy)
                    points.append(before)
                    continue
                own = self.unknowns.index(i)
                far = _Point(own, angle[own], 1.0, 0.0, before.mean)
                springs.append((near, far, far.angle - near.angle - offset, 1 / soft, lossy / soft**2))
                points.append(far)
            elif element.kind in LAWS:
                psi, eta, slope = LAWS[element.kind](element, before.angle - element.plane)
                r1 = eta * before.r1 + slope * before.r**2
                points.append(_Point(before.owner, psi, eta * before.r, r1, before.mean))
            elif element.kind == "Ratio":
                over = 1 / element.speed_ratio
                mean = before.mean * over
                points.append(_Point(before.owner, before.angle * over, before.r * over, before.r1 * over, mean))
            elif element.kind == "GearPair":
                # A ratio, and behind it a shaft whose stiffness varies with the teeth that have gone by.
                over, out = 1 / element.speed_ratio, element.radii[1]
                mean, own = before.mean * over, self.unknowns.index(i)
                near = _Point(before.owner, before.angle * over, before.r * over, before.r1 * over, mean)
                teeth = abs(mean) * element.teeth_out * self.speed * time
                wave = 1 + sum(h.share * np.cos(h.order * teeth + h.phase) for h in element.stiffness_variation)
                points.append(_Point(own, angle[own], 1.0, 0.0, mean))
                k, c = element.mesh_stiffness * out**2 * wave, element.mesh_damping * out**2
                springs.append((near, points[-1], points[-1].angle - near.angle, k, c))
            elif parent is not None:
                points.append(before)
                if parent in waiting:
                    waiting[i] = waiting[parent]
        return points, springs

    def _weights(self, points: list[_Point]) -> list[tuple[_Point, float, tuple[float, float, float]]]:
        """Point, inertia, and load torque: constant, by the speed and by its square."""
        out, none = [], (0.0, 0.0, 0.0)
        for i, element in enumerate(self.line.elements):
            parent = self.line.parents[i]
            if element.kind == "Disk":
                load = element.load_torque, element.viscous_load, element.quadratic_load
                out.append((points[i], element.moment_of_inertia, load))
            elif element.kind == "Shaft" and element.density:
                half = element.moment_of_inertia / 2
                out += [(points[i], half, none), (points[parent if parent is not None else 0], half, none)]
        return out

    def mass(self, time: float, angle: Any) -> Any:
        """Inertia of each unknown at these angles."""
        out = np.zeros(np.shape(angle), dtype=np.asarray(angle).dtype)
        for point, inertia, _ in self._weights(self._points(time, angle)[0]):
            if point.owner >= 0:
                out[point.owner] += inertia * point.r**2
        return out

    def residual(self, time: float, angle: Any, rate: Any, acceleration: Any) -> Any:
        """Virtual work of all forces, inertia included, per unknown [N m]; zero on a motion."""
        points, springs = self._points(time, angle)
        out = np.zeros(np.shape(angle), dtype=np.result_type(angle, rate, acceleration))

        def speed_of(point: _Point) -> Any:
            return point.r * rate[point.owner] if point.owner >= 0 else point.r * self.speed

        for point, inertia, (constant, viscous, quadratic) in self._weights(points):
            i = point.owner
            if i >= 0:
                alpha = point.r * acceleration[i] + point.r1 * rate[i] ** 2
                speed = speed_of(point)
                torque = (constant + quadratic * speed**2) * np.sign(point.mean) + viscous * speed
                out[i] -= (inertia * alpha + torque) * point.r
        for near, far, elongation, k, c in springs:
            torque = k * elongation + c * (speed_of(far) - speed_of(near))
            out[far.owner] -= torque
            if near.owner >= 0:
                out[near.owner] += torque * near.r
        return out

    def derivatives(self, time: float, angle: Array, rate: Array, acceleration: Array) -> tuple[Array, Array, Array]:
        """−∂residual/∂(acceleration, rate, angle): exact M, C, K about a state, by the complex step."""
        n, step, found = self.size, 1e-30, []
        for which in (2, 1, 0):
            matrix = np.empty((n, n))
            for j in range(n):
                state = [np.asarray(part, dtype=complex).copy() for part in (angle, rate, acceleration)]
                state[which][j] += 1j * step
                matrix[:, j] = -self.residual(time, *state).imag / step
            found.append(matrix)
        return found[0], found[1], found[2]
