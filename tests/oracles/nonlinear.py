"""The nonlinear equations of a chain and its true periodic orbits."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from oracles.chains import Chain, Numpy, joint_law, twist_numbers

Array = NDArray[np.float64]


class NonlinearChain:
    """The chain's nonlinear equations in disk rotations: J_i φ̈_i = −f_i + g_i(φ_i) f_{i+1} − M_i, in τ = Ωt.

    States are x_i = φ_i − base and dx_i/dτ about the zero-twist base, so that linear and nonlinear motions
    compare directly.
    """

    def __init__(self, chain: Chain) -> None:
        self.chain = chain
        self.numbers = twist_numbers(chain, phase_shift=False)
        self.load = np.array(chain.load) / chain.speed**2

    def base(self, tau: float) -> tuple[Array, Array, Array]:
        """Angle, speed and acceleration of each disk at zero twist, forks included."""
        n, numbers = self.chain.size, self.numbers
        angle, speed, acceleration = np.zeros(n), np.ones(n), np.zeros(n)
        angle[0] = tau + numbers["phase"][0]
        for i in range(n - 1):
            psi, eta, slope, _ = joint_law(Numpy, angle[i] - numbers["plane"][i], numbers["cosine"][i])
            over = numbers["over_gear"][i]
            angle[i + 1] = (psi + numbers["quarter"][i]) * over + numbers["phase"][i + 1]
            speed[i + 1] = eta * over * speed[i]
            acceleration[i + 1] = (slope * speed[i] ** 2 + eta * acceleration[i]) * over
        return angle, speed, acceleration

    def slopes(self, tau: float, state: Array) -> Array:
        """Right-hand side for scipy; ``state`` (2n,) or (2n, m)."""
        n, numbers = self.chain.size, self.numbers
        wide = np.atleast_2d(state.T).T
        angle, speed, acceleration = self.base(tau)
        a, v = angle[:, None] + wide[:n], speed[:, None] + wide[n:]
        theta, rate = np.empty_like(a), np.empty_like(a)
        theta[0], rate[0] = a[0] - tau - numbers["phase"][0], v[0] - 1
        gain = np.empty_like(a)
        for i in range(n - 1):
            psi, eta, _, _ = joint_law(Numpy, a[i] - numbers["plane"][i], numbers["cosine"][i])
            over = numbers["over_gear"][i]
            gain[i] = eta * over
            theta[i + 1] = a[i + 1] - (psi + numbers["quarter"][i]) * over - numbers["phase"][i + 1]
            rate[i + 1] = v[i + 1] - gain[i] * v[i]
        torque = np.array(numbers["kappa"])[:, None] * theta + np.array(numbers["loss"])[:, None] * rate
        push = -torque - self.load[:, None]
        push[:-1] += gain[:-1] * torque[1:]
        out = np.concatenate([wide[n:], push * np.array(numbers["over_inertia"])[:, None] - acceleration[:, None]])
        return out.reshape(state.shape)

    def after_period(self, starts: Array, rtol: float = 1e-12) -> Array:
        """States one period later, for starts of shape (2n, m)."""
        shape = starts.shape

        def flat(tau: float, y: Array) -> Array:
            return self.slopes(tau, y.reshape(shape)).ravel()

        run = solve_ivp(flat, (0, self.chain.period), starts.ravel(), method="DOP853", rtol=rtol, atol=1e-14)
        return run.y[:, -1].reshape(shape)

    def periodic_orbit(self, guess: Array | None = None) -> tuple[Array, Array]:
        """Start (2n,) of the periodic orbit by shooting, and its monodromy matrix by central differences."""
        size = 2 * self.chain.size
        start = np.zeros(size) if guess is None else guess.copy()
        step = 3e-5
        for _ in range(20):
            starts = np.concatenate(
                [start[:, None], start[:, None] + step * np.eye(size), start[:, None] - step * np.eye(size)],
                axis=1,
            )
            ends = self.after_period(starts)
            jacobian = (ends[:, 1 : size + 1] - ends[:, size + 1 :]) / (2 * step)
            miss = ends[:, 0] - start
            if np.abs(miss).max() < 1e-11:
                return start, jacobian
            start = start + np.linalg.solve(np.eye(size) - jacobian, miss)
        raise AssertionError(f"shooting did not converge, residual {np.abs(miss).max():.1e}")
