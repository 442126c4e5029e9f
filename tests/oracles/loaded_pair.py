"""A drive, two joints and two disks, the second loaded, with the equations written out: shooting and the variational
equations, integrated by SciPy.

A drive turns by Ωt; behind a joint, shaft 1 and disk 1 that turns by x, behind another, shaft 2 and disk 2 that turns
by y under a load. Behind a joint at angle β what turns by a before it turns by g(a) = a + arg(cos a + i sin a / cos β)
− a + π/2, so that g′ = cos β/(1 − sin²β cos²a).

    F₁ = k₁(x − g₁(Ωt)) + c₁(ẋ − g₁′Ω),   F₂ = k₂(y − g₂(x)) + c₂(ẏ − g₂′ẋ)
    J₁ẍ = −F₁ + g₂′F₂,   J₂ÿ = −F₂ − T

Where shaft 2 has stages it is three times as stiff beyond a twist.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import trunnion as tn

Array = NDArray[np.float64]
TURN = np.pi
"""Period in the angle of the drive."""
PATHS = {
    "HookeJoint 1.angle": "angle_1", "HookeJoint 2.angle": "angle_2", "Shaft 1.stiffness": "k_1",
    "Shaft 2.stiffness": "k_2", "Shaft 2.damping": "c_2", "Disk 1.inertia": "j_1", "Disk 2.inertia": "j_2",
    "Disk 2.load_torque": "load",
}  # fmt: skip


@dataclass(frozen=True)
class Pair:
    """The numbers of the line."""

    angle_1: float = 0.5
    angle_2: float = 0.42
    k_1: float = 4000.0
    k_2: float = 3000.0
    c_1: float = 0.35
    c_2: float = 0.25
    j_1: float = 0.6
    j_2: float = 0.9
    load: float = 1700.0
    stage: float = np.inf

    @property
    def line(self) -> tn.Driveline:
        """As the package knows it."""
        return tn.Driveline(
            [
                tn.ConstantSpeed(),
                tn.HookeJoint(angle=self.angle_1),
                tn.Shaft(stiffness=self.k_1, damping=self.c_1),
                tn.Disk(inertia=self.j_1),
                tn.HookeJoint(angle=self.angle_2),
                self.shaft_2,
                tn.Disk(inertia=self.j_2, load_torque=self.load),
            ]
        )

    @property
    def shaft_2(self) -> tn.Shaft | tn.PiecewiseShaft:
        """With stages or without."""
        if np.isinf(self.stage):
            return tn.Shaft(stiffness=self.k_2, damping=self.c_2)
        return tn.PiecewiseShaft.symmetric([(self.k_2, self.stage), (3 * self.k_2, None)], damping=self.c_2)

    def at(self, values: dict[str, float]) -> Pair:
        """With other numbers, by the package's paths."""
        return replace(self, **{PATHS[path]: value for path, value in values.items()})

    def _rates(self, t: float, state: Array, speed: float) -> Array:
        whole = state.reshape(4, 5)
        (x, y, v, w), by = whole[:, 0], whole[:, 1:]
        n_1, d_1, _ = behind(speed * t, self.angle_1)
        n_2, d_2, dd_2 = behind(x, self.angle_2)
        first = self.k_1 * (x - n_1) + self.c_1 * (v - d_1 * speed)
        twist, beyond = y - n_2, max(abs(y - n_2) - self.stage, 0.0)
        second = self.k_2 * (twist + 2 * beyond * np.sign(twist)) + self.c_2 * (w - d_2 * v)
        k_2 = self.k_2 * (3 if beyond else 1)
        own = [v, w, (-first + d_2 * second) / self.j_1, (-second - self.load) / self.j_2]
        d_second = k_2 * (by[1] - d_2 * by[0]) + self.c_2 * (by[3] - d_2 * by[2] - dd_2 * v * by[0])
        d_first = self.k_1 * by[0] + self.c_1 * by[2]
        changes = [by[2], by[3], (-d_first + dd_2 * second * by[0] + d_2 * d_second) / self.j_1, -d_second / self.j_2]
        return np.column_stack([own, changes]).ravel()

    def rates(self, phi: float, state: Array, speed: float) -> Array:
        """Of twists of both shafts and speeds of both disks over the angle that the drive has turned by."""
        whole = np.column_stack([self.rotations(phi, state), np.zeros((4, 4))])
        x, y, v, _ = whole[:, 0]
        change = self._rates(phi / speed, whole.ravel(), speed).reshape(4, 5)[:, 0] / speed
        first = change[0] - behind(phi, self.angle_1)[1]
        second = change[1] - behind(x, self.angle_2)[1] * v / speed
        return np.array([first, second, change[2], change[3]])

    def rotations(self, phi: float, state: Array) -> Array:
        """Rotations and speeds of both disks, by twists and speeds."""
        x = behind(phi, self.angle_1)[0] + state[0]
        return np.array([x, behind(x, self.angle_2)[0] + state[1], state[2], state[3]])

    def twists(self, phi: float, state: Array) -> Array:
        """The other way round."""
        first, second = behind(phi, self.angle_1)[0], behind(state[0], self.angle_2)[0]
        return np.array([state[0] - first, state[1] - second, state[2], state[3]])

    def motion(self, speed: float, start: Array | None = None, points: int = 2) -> tuple[Array, Array]:
        """The periodic motion that Newton's steps from the twisted line close, or from a state of rotations and speeds:
        at so many ``points`` of a period (point, 4), and the multipliers."""
        if start is None:
            x = behind(0.0, self.angle_1)[0] - self.load / self.k_1
            y = behind(x, self.angle_2)[0] - self.load / self.k_2
            start = np.array([x, y, speed, speed])
        at = np.linspace(0, TURN, points) / speed
        for _ in range(30):
            begin = np.column_stack([start, np.eye(4)]).ravel()
            path = solve_ivp(
                self._rates, (0, TURN / speed), begin, "DOP853", at, args=(speed,), rtol=1e-11, atol=1e-11
            ).y.T.reshape(-1, 4, 5)  # fmt: skip
            matrix = path[-1][:, 1:]
            change = np.linalg.solve(matrix - np.eye(4), start + [TURN, TURN, 0, 0] - path[-1][:, 0])
            start = start + change
            if np.abs(change[:2]).max() < 1e-10:
                return path[:, :, 0], np.linalg.eigvals(matrix)
        raise AssertionError("no periodic motion was found")

    def growth(self, speed: float) -> float:
        """Of the fastest disturbance of that motion [1/s]."""
        return float(np.log(np.abs(self.motion(speed)[1]).max()) * speed / TURN)


def behind(a: float, angle: float) -> tuple[float, float, float]:
    """Rotation behind a joint and its first two derivatives by that before it."""
    c, s_2 = np.cos(angle), np.sin(angle) ** 2
    below = 1 - s_2 * np.cos(a) ** 2
    ahead = np.arctan2(np.sin(a) * np.cos(a) * (1 - c), c * np.cos(a) ** 2 + np.sin(a) ** 2)
    return a + ahead + np.pi / 2, c / below, -c * 2 * s_2 * np.sin(a) * np.cos(a) / below**2
