"""Angled joints beside a differential and in a loop: linearised equations against Lagrange's with multipliers, and the
steady response against their motion in time."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.equations.linear import line_matrices

K, C = np.array([1e4, 9e3, 2e4, 1.4e4]), np.array([20.0, 30.0, 60.0, 40.0])
J = np.array([0.1, 0.05, 0.1, 0.05, 0.05, 0.06, 0.05, 0.4])  # input side, fork, pinion, case, left, right, fork, load
RATIO, LOAD, SPEED = 2.0, 60.0, 60.0
A, B, P, CASE, L, R, F, V = range(8)


def line(first: float, second: float) -> tn.Driveline:
    """A joint in front of a differential, one behind its left leg, and both legs on one load."""
    left_in, left_out, right_in, load = (tn.Shaft(stiffness=k, damping=c) for k, c in zip(K, C, strict=True))
    return tn.Driveline(
        [
            tn.ConstantSpeed(), left_in, tn.Disk(inertia=J[A]), tn.HookeJoint(angle=first, name="front"),
            tn.Disk(inertia=J[B]), left_out, tn.Disk(inertia=J[P]),
            tn.Differential(ratio=RATIO, inertia=J[CASE], name="drive"), tn.Disk(inertia=J[L]),
            tn.HookeJoint(angle=second, name="leg"), tn.Disk(inertia=J[F]), right_in.but(name="left"),
            tn.Disk(inertia=J[V], load_torque=LOAD, name="load"),
            tn.Disk(inertia=J[R], after="drive.right"), load.but(to="load", name="right"),
        ]
    )  # fmt: skip


def law(chi: float, angle: float) -> tuple[float, float, float]:
    """tan ψ = tan χ / cos β: ψ, ψ′ and ψ″."""
    cosine, square = np.cos(angle), np.sin(angle) ** 2
    below = 1 - square * np.cos(chi) ** 2
    psi = chi + np.arctan2((1 / cosine - 1) * np.sin(chi) * np.cos(chi), np.cos(chi) ** 2 + np.sin(chi) ** 2 / cosine)
    return psi, cosine / below, -cosine * square * np.sin(2 * chi) / below**2


class Lagrange:
    """The line with a rotation for every part, joints, gears and differential as constraints."""

    def __init__(self, first: float, second: float) -> None:
        self.first, self.second = first, second
        # By hand: the legs carry half of the load each, the input what the ratio leaves.
        torque = np.array([-LOAD / RATIO, -LOAD / RATIO, -LOAD / 2, -LOAD / 2])
        self.twist = torque / K
        turns = np.arange(0, 2 * np.pi, 2 * np.pi / 512)  # the period of both joints
        self.offset = float(np.mean([one[V] - one[R] for one, _, _ in map(self.base, turns)])) - self.twist[3]

    def base(self, tau: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Rotations, speeds and accelerations of rigid shafts by the input angle."""
        a = np.zeros((3, 8))
        a[:, A] = tau + self.twist[0], 1.0, 0.0
        psi, one, two = law(a[0, A], self.first)
        a[:, B] = psi, one, two
        a[:, P] = psi + self.twist[1], one, two
        a[:, CASE] = a[:, L] = a[:, R] = a[:, P] / RATIO
        psi, slope, bend = law(a[0, L] + np.pi / 2 / RATIO, self.second)
        a[:, F] = psi - np.pi / 2 / RATIO, slope * a[1, L], bend * a[1, L] ** 2 + slope * a[2, L]
        a[:, V] = a[0, F] + self.twist[2], a[1, F], a[2, F]
        return a[0], a[1], a[2]

    def accelerations(self, time: float, state: np.ndarray, held: np.ndarray | float = 0.0) -> np.ndarray:
        """Rates of the deviations of input side, pinion, right leg and load from rigid shafts, and of their speeds;
        ``held`` : torques on these from outside."""
        x, rate = state[:4], state[4:]
        at, speed, acceleration = self.base(SPEED * time)
        base_speed, base_acceleration = SPEED * speed, SPEED**2 * acceleration
        phi, w = at.copy(), base_speed.copy()
        own = [A, P, R, V]
        phi[own] += x
        w[own] += rate
        psi, one, bend_one = law(phi[A], self.first)
        phi[B], w[B] = psi, one * w[A]
        phi[CASE], w[CASE] = phi[P] / RATIO, w[P] / RATIO
        phi[L], w[L] = 2 * phi[CASE] - phi[R], 2 * w[CASE] - w[R]
        psi, two, bend_two = law(phi[L] + np.pi / 2 / RATIO, self.second)
        phi[F], w[F] = psi - np.pi / 2 / RATIO, two * w[L]
        # Rows of G φ″ = γ: both joints, the final drive, the differential.
        g, gamma = np.zeros((4, 8)), np.zeros(4)
        g[0, [B, A]], gamma[0] = (1.0, -one), bend_one * w[A] ** 2
        g[1, [P, CASE]] = 1.0, -RATIO
        g[2, [CASE, L, R]] = 2.0, -1.0, -1.0
        g[3, [F, L]], gamma[3] = (1.0, -two), bend_two * w[L] ** 2
        q = np.array([phi[A] - SPEED * time, phi[P] - phi[B], phi[V] - phi[F], phi[V] - phi[R] - self.offset])
        slip = np.array([w[A] - SPEED, w[P] - w[B], w[V] - w[F], w[V] - w[R]])
        torque, force = K * q + C * slip, np.zeros(8)
        force[A] -= torque[0]
        force[B] += torque[1]
        force[P] -= torque[1]
        force[F] += torque[2]
        force[R] += torque[3]
        force[V] -= torque[2] + torque[3] + LOAD
        force[own] += held
        whole = np.block([[np.diag(J), g.T], [g, np.zeros((4, 4))]])
        found = np.linalg.solve(whole, np.concatenate([force, gamma]))[:8]
        return np.concatenate([rate, (found - base_acceleration)[own]])

    def torque(self, time: float, state: np.ndarray) -> np.ndarray:
        """Torques of the four springs."""
        x, rate = state[:4], state[4:]
        at, speed, _ = self.base(SPEED * time)
        a, ap = at[A] + x[0], SPEED * speed[A] + rate[0]
        b, one, _ = law(a, self.first)
        p, r, v = at[P] + x[1], at[R] + x[2], at[V] + x[3]
        pp, rp, vp = SPEED * speed[P] + rate[1], SPEED * speed[R] + rate[2], SPEED * speed[V] + rate[3]
        left, lp = 2 * p / RATIO - r, 2 * pp / RATIO - rp
        f, two, _ = law(left + np.pi / 2 / RATIO, self.second)
        q = np.array([a - SPEED * time, p - b, v - f + np.pi / 2 / RATIO, v - r - self.offset])
        return K * q + C * np.array([ap - SPEED, pp - one * ap, vp - two * lp, vp - rp])


def test_equations_are_lagranges_to_first_order() -> None:
    """−M⁻¹K, −M⁻¹C and M⁻¹f at several angles of the input against differences of the accelerations."""
    first, second = 0.3, 0.25
    assembly, exact = assemble(line(first, second)), Lagrange(first, second)
    coefficients = assembly.coefficients(assembly.table(1, SPEED))
    np.testing.assert_allclose(coefficients.torque[0], K * exact.twist, rtol=1e-12)
    tau = np.array([0.0, 0.7, 2.1, 4.4])
    m = line_matrices(assembly.topology, coefficients, tau)
    step = 1e-5
    for i, angle in enumerate(tau):
        over = np.linalg.inv(m.mass[0, i])
        scale = np.abs(over @ m.stiffness[0, i]).max()
        pushed = exact.accelerations(angle / SPEED, np.zeros(8))[4:]
        np.testing.assert_allclose(pushed, over @ m.forcing[0, i], rtol=1e-8, atol=1e-12 * scale)
        # About the base motion, which takes the opposite torques: no acceleration is multiplied by a change of inertia.
        at = partial(exact.accelerations, angle / SPEED, held=-m.forcing[0, i])
        found = np.stack([(at(s)[4:] - at(-s)[4:]) / (2 * step) for s in step * np.eye(8)], axis=1)
        expected = -np.hstack([over @ m.stiffness[0, i], over @ m.damping[0, i]])
        np.testing.assert_allclose(found[:, :4], expected[:, :4], rtol=1e-6, atol=1e-9 * scale)
        np.testing.assert_allclose(found[:, 4:], expected[:, 4:], rtol=1e-6, atol=1e-6 * np.abs(expected[:, 4:]).max())


@pytest.mark.slow
def test_torque_over_a_turn_is_that_of_the_motion_in_time() -> None:
    """The difference falls with the square of what joints force: with the fourth power of their angles."""
    apart = []
    for scale in (1.0, 0.5):
        first, second = 0.28 * scale, 0.24 * scale
        exact, response = Lagrange(first, second), tn.order_response(line(first, second), [SPEED])
        period = 2 * np.pi / SPEED  # one turn holds both joints' orders, 2 and 1
        run = solve_ivp(exact.accelerations, (0, 9 * period), np.zeros(8), rtol=1e-8, atol=1e-10, dense_output=True)
        times = 8 * period + period * np.arange(800) / 800
        torque = np.array([exact.torque(t, run.sol(t)) for t in times])
        half = (torque.max(axis=0) - torque.min(axis=0)) / 2
        found = response.vibratory_torque[0][
            [response.springs.index(n) for n in ("Shaft 1", "Shaft 2", "left", "right")]
        ]
        apart.append(np.abs(found - half).max() / half.max())
        np.testing.assert_allclose(torque.mean(axis=0), K * exact.twist, atol=0.02 * half.max())
    assert apart[0] < 2e-3 and apart[1] < apart[0] / 3


def test_a_differential_in_front_of_which_joints_are_angled() -> None:
    """With equal legs and straight joints behind, the differential is one shaft: the same line without it."""
    front = [
        tn.ConstantSpeed(), tn.HookeJoint(angle=0.35), tn.Shaft(stiffness=1e4, damping=3.0), tn.Disk(inertia=0.1),
        tn.HookeJoint(angle=0.3, plane=0.4), tn.Shaft(stiffness=8e3, damping=4.0), tn.Disk(inertia=0.05),
    ]  # fmt: skip
    leg = [tn.Disk(inertia=0.02), tn.Shaft(stiffness=6e3, damping=5.0), tn.Disk(inertia=0.5, load_torque=20.0)]
    case = tn.Differential(ratio=2.5, inertia=0.03, name="d")
    tied = tn.Driveline([*front, case, *leg, leg[0].but(after="d.right"), *leg[1:]])
    both = [tn.Disk(inertia=0.07), tn.Shaft(stiffness=1.2e4, damping=10.0), tn.Disk(inertia=1.0, load_torque=40.0)]
    one = tn.Driveline([*front, tn.Ratio(ratio=2.5), *both])
    found, expected = (_torques(this) for this in (tied, one))
    np.testing.assert_allclose(found[..., :2], expected[..., :2], rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(2 * found[..., 2], expected[..., 2], rtol=1e-8, atol=1e-8)
    own, plain = (np.sort_complex(tn.stability(this, 90.0).multipliers) for this in (tied, one))
    assert all(np.abs(own - one).min() < 1e-8 for one in plain)
    lossy = [this.replace("Shaft 2", damping=0.0, loss_factor=0.05) for this in (tied, one)]
    np.testing.assert_allclose(*(_torques(this)[..., :2] for this in lossy), rtol=1e-8, atol=1e-8)


def _torques(line: tn.Driveline) -> np.ndarray:
    """Amplitudes of orders 2, 4 and 6 of every spring at two speeds."""
    found = tn.order_response(line, [40.0, 90.0])
    return found.torque[:, np.isin(found.order, [2, 4, 6])]


def test_legs_that_roll_freely_have_no_phase() -> None:
    """A joint behind such a leg may stand anywhere."""
    parts = line(0.1, 0.1).elements
    free = tn.Driveline([*parts[:-1], tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.2, load_torque=LOAD)])
    with pytest.raises(tn.InputError, match="^leg: is angled behind legs .* in front of the differential"):
        tn.order_response(free, [SPEED])
    tn.order_response(free.replace("leg", angle=0.0), [SPEED])
