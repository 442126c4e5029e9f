"""An independent model of a line of Hooke's joints: rigid bodies in space, one angle at a time, no joint
formulas.

Nothing here is taken from the package. Forks and crosses are bodies with pin axes as vectors. Where the
output fork stands follows from its pins being square to those of the input fork; speeds and accelerations
from the closure of angular velocities ω₁e₁ + ω_a a = ω₂e₂ + ω_b b and its derivative; torques, couples, pin
and bearing forces from six equations of equilibrium for every shaft and every cross.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import root
from scipy.spatial.transform import Rotation

START = np.array([0.0, 0.0, -1.0])
"""Where the first fork points at input angle 0 and fork offset 0; the first shaft runs along x."""


def turned(vector, axis, angle):
    return Rotation.from_rotvec(angle * np.asarray(axis)).apply(vector)


def skew(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


@dataclass
class Line:
    """Joint angles, planes, fork offsets [rad]; lengths between joints, bearing positions by shaft [m]."""

    angles: list
    planes: list
    fork_offsets: list
    lengths: list = field(default_factory=list)
    bearings: dict = field(default_factory=dict)
    inertias: list = field(default_factory=list)
    stiffness: list = field(default_factory=list)
    load: float = 0.0
    speed: float = 1.0
    acceleration: float = 0.0
    pin_friction: float = 0.0

    def __post_init__(self):
        n = len(self.angles)
        e, normal = np.array([1.0, 0, 0]), np.array([0, 1.0, 0])
        self.axes, self.normals = [e], []
        for beta, plane in zip(self.angles, self.planes, strict=True):
            normal = turned(normal, e, plane)
            self.normals.append(normal)
            e = turned(e, normal, beta)
            self.axes.append(e)
        self.inertias = self.inertias or [0.0] * (n + 1)


@dataclass
class State:
    """One instant: pin axes, speeds and accelerations of the shafts, swing of each cross in its forks."""

    a: list
    b: list
    speed: list
    acceleration: list
    swing: list


def motion(line, phi, twists=None):
    """The state at input angle ``phi``; ``twists`` [rad] of the shafts turn the forks at their far ends."""
    n = len(line.angles)
    twists = twists if twists is not None else [0.0] * (n + 1)
    state = State([], [], [line.speed], [line.acceleration], [])
    a = turned(START, line.axes[0], phi + line.fork_offsets[0] + twists[0])
    for j in range(n):
        e1, e2 = line.axes[j], line.axes[j + 1]
        b = square_pin(a, e2, guess=turned(a, e1, np.pi / 2))
        w1, eps1 = state.speed[-1], state.acceleration[-1]
        closure = np.stack([e2, -a, b], axis=1)
        w2, swing_a, swing_b = np.linalg.solve(closure, w1 * e1)
        rates = swing_a * w1 * np.cross(e1, a) - swing_b * w2 * np.cross(e2, b)
        eps2, _, _ = np.linalg.solve(closure, eps1 * e1 + rates)
        state.a.append(a)
        state.b.append(b)
        state.speed.append(w2)
        state.acceleration.append(eps2)
        state.swing.append((swing_a, swing_b))
        if j + 1 < n:
            a = turned(b, e2, line.fork_offsets[j + 1] + twists[j + 1])
    return state


def square_pin(a, axis, guess):
    """The unit vector square to ``axis`` and to ``a``, by Newton's method on the rotation about ``axis``."""
    start = guess - (guess @ axis) * axis
    start /= np.linalg.norm(start)
    side = np.cross(axis, start)
    angle = 0.0
    for _ in range(50):
        b = np.cos(angle) * start + np.sin(angle) * side
        slope = a @ (-np.sin(angle) * start + np.cos(angle) * side)
        step = (a @ b) / slope
        angle -= step
        if abs(step) < 1e-16:
            break
    return np.cos(angle) * start + np.sin(angle) * side


def forces(line, state):
    """Solve the equilibrium of all bodies; returns a dictionary of vectors and torques."""
    n = len(line.angles)
    friction = np.zeros((n, 2))
    for _ in range(1 if line.pin_friction == 0 else 60):
        found = equilibrium(line, state, friction)
        if line.pin_friction == 0:
            break
        new = np.zeros_like(friction)
        for j in range(n):
            for side, pin in enumerate((state.a[j], state.b[j])):
                moment = found["pin_moment"][j, side]
                load = np.linalg.norm(moment - (moment @ pin) * pin)
                # what the fork does to the cross about their pin opposes the cross's swing in that fork
                new[j, side] = -line.pin_friction * load * np.sign(state.swing[j][side])
        if np.max(np.abs(new - friction)) < 1e-14 * max(1.0, abs(line.load)):
            break
        friction = new
    return found


def equilibrium(line, state, friction):
    n = len(line.angles)
    held = line.bearings
    bearings = [(m, x) for m in range(n + 1) for x in held.get(m, ())]
    thrusts = [m for m in range(n + 1) if len(held.get(m, ())) == 2]
    unknowns = 10 * n + 1 + 2 * len(bearings) + len(thrusts)
    rows, right = [], []

    def pair(axis):
        first = np.cross(axis, [0.3, 0.5, 0.81])
        first /= np.linalg.norm(first)
        return first, np.cross(axis, first)

    def pin(j, side):
        """Force (3) and moment (3) of the fork on the cross, linear in the unknowns, and the known moment."""
        axis = (state.a, state.b)[side][j]
        at = 10 * j + 5 * side
        force, moment = np.zeros((3, unknowns)), np.zeros((3, unknowns))
        force[:, at : at + 3] = np.eye(3)
        moment[:, at + 3 : at + 5] = np.stack(pair(axis), axis=1)
        return force, moment, friction[j, side] * axis

    for m in range(n + 1):
        e = line.axes[m]
        force, moment, known = np.zeros((3, unknowns)), np.zeros((3, unknowns)), np.zeros(3)
        if m > 0:  # its near fork holds the cross of joint m − 1, at the shaft's origin
            f, t, k = pin(m - 1, 1)
            force, moment, known = force - f, moment - t, known - k
        if m < n:
            f, t, k = pin(m, 0)
            arm = (line.lengths[m - 1] if m > 0 else 0.0) * e
            force, moment, known = force - f, moment - t - skew(arm) @ f, known - k
        if m == 0:
            moment[:, 10 * n] += e
        if m == n:
            known -= line.load * e
        known -= line.inertias[m] * state.acceleration[m] * e
        for b, (owner, x) in enumerate(bearings):
            if owner == m:
                at = 10 * n + 1 + 2 * b
                directions = np.stack(pair(e), axis=1)
                force[:, at : at + 2] += directions
                moment[:, at : at + 2] += skew(x * e) @ directions
        if m in thrusts:
            force[:, unknowns - len(thrusts) + thrusts.index(m)] += e
        rows += [*force, *moment]
        right += [0.0, 0.0, 0.0, *(-known)]
        if m > 0 and m not in held:  # sliding spline: no thrust
            rows.append(e @ pin(m - 1, 1)[0])
            right.append(0.0)
    for j in range(n):
        (fa, ta, ka), (fb, tb, kb) = pin(j, 0), pin(j, 1)
        rows += [*(fa + fb), *(ta + tb)]
        right += [0.0, 0.0, 0.0, *(-(ka + kb))]
        if j in thrusts and j + 1 in thrusts:
            rows += [*fa]
            right += [0.0, 0.0, 0.0]
    if not held:  # only moments are asked for: all forces are set to zero
        for j in range(n):
            rows += [*pin(j, 0)[0]]
            right += [0.0, 0.0, 0.0]
    matrix, right = np.array(rows), np.array(right)
    if not held:
        matrix, right = moments_only(matrix, right, line)
    x, _, rank, _ = np.linalg.lstsq(matrix, right, rcond=1e-12)
    assert rank == unknowns, (rank, unknowns)
    assert np.max(np.abs(matrix @ x - right)) < 1e-8 * max(1.0, abs(line.load))
    moments = np.zeros((n, 2, 3))
    pins = np.zeros((n, 2, 3))
    for j in range(n):
        for side in (0, 1):
            f, t, k = pin(j, side)
            pins[j, side], moments[j, side] = f @ x, t @ x + k
    radial = np.zeros((len(bearings), 3))
    for b, (m, _) in enumerate(bearings):
        at = 10 * n + 1 + 2 * b
        radial[b] = np.stack(pair(line.axes[m]), axis=1) @ x[at : at + 2]
    return {
        "drive_torque": x[10 * n],
        "pin_moment": moments,  # of the forks on the cross
        "pin_force": pins,
        "bearing_force": radial,  # of the bearings on the shafts
    }


def moments_only(matrix, right, line):
    """Without bearings nothing holds the shafts against bending: keep the torsional balance of each."""
    n = len(line.angles)
    rows, values, at = [], [], 0
    for m in range(n + 1):
        rows.append(line.axes[m] @ matrix[at + 3 : at + 6])
        values.append(line.axes[m] @ right[at + 3 : at + 6])
        at += 7 if m > 0 else 6
    return np.vstack([rows, matrix[at:]]), np.concatenate([values, right[at:]])


def shaft_torques(line, state, found):
    """Torque at the near end of each shaft [N m]: from the drive, or from the cross in front of it."""
    passed = [found["drive_torque"]]
    for j in range(len(line.angles)):
        passed.append(-found["pin_moment"][j, 1] @ line.axes[j + 1])
    return passed


def elastic(line, phi, start=None, yields=None):
    """State, forces and twists with every shaft but the last yielding by torque/stiffness, or as ``yields`` says."""
    n = len(line.angles)
    yields = yields or (lambda torque: torque / line.stiffness[:n])

    def residual(twists):
        state = motion(line, phi, np.append(twists, 0.0))
        passed = shaft_torques(line, state, forces(line, state))
        return twists + yields(np.array(passed[:n]))

    solution = root(residual, np.zeros(n) if start is None else start, tol=1e-14, method="hybr")
    twists = solution.x
    state = motion(line, phi, np.append(twists, 0.0))
    return state, forces(line, state), twists
