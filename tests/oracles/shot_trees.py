"""The periodic motion of a loaded tree, and its multipliers, by shooting the equations of ``trees`` with steps of
Dormand and Prince: no harmonics, nothing linearised, nothing of the package but what it computes of single elements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from oracles.trees import Tree

Array = NDArray[np.float64]
STEP = 1e-5
"""Of central differences [rad], of speeds times that of the input, of torques times 1e7 [N m]."""
ROUNDS = 12


@dataclass
class ShotTree:
    """``turn`` [rad of the input]: period. Where the first disk is an unknown, so is the torque that drives it."""

    tree: Tree
    turn: float

    def __post_init__(self) -> None:
        self.free = 0 in self.tree.unknowns
        self.mean = np.ones(self.tree.size)
        for _, far, *_ in self.tree._points(0.0, np.zeros(self.tree.size))[1]:
            self.mean[far.owner] = far.mean

    def rates(self, time: float, state: Array, torque: Array | float) -> Array:
        """Of angles and speeds (2n, many)."""
        angle, speed = np.split(state, 2)
        force = self.tree.residual(time, angle, speed, np.zeros_like(speed))
        if self.free:
            force[0] += torque
        return np.concatenate([speed, force / self.tree.mass(time, angle)])

    def missing(self, state: Array, torque: Array | float) -> Array:
        """What states (2n, many) a period later are beyond the mean turn from those now."""
        run = solve_ivp(
            lambda t, x: self.rates(t, x.reshape(state.shape), torque).ravel(), (0.0, self.turn / self.tree.speed),
            state.ravel(), method="DOP853", rtol=1e-11, atol=1e-11,
        )  # fmt: skip
        turned = np.concatenate([self.turn * self.mean, 0.0 * self.mean])
        return run.y[:, -1].reshape(state.shape) - turned[:, None] - state

    def start(self) -> tuple[Array, float]:
        """Rigid shafts at no rotation of the input, twisted by their mean loads; and the torque that balances those."""
        tree, angle = self.tree, np.zeros(self.tree.size)
        points, springs = tree._points(0.0, angle)
        load, twist = np.zeros(tree.size), {}
        for point, _, (constant, viscous, quadratic) in tree._weights(points):
            if point.owner >= 0:
                speed = point.mean * tree.speed
                torque = (constant + quadratic * speed**2) * np.sign(point.mean) + viscous * speed
                load[point.owner] += torque * point.mean / self.mean[point.owner]
        for near, far, _, k, _ in reversed(springs):
            twist[far.owner] = -load[far.owner] / k
            if near.owner >= 0:
                load[near.owner] += load[far.owner] * self.mean[far.owner] / self.mean[near.owner]
        for e in range(len(springs)):  # each stands behind those before it
            _, far, beyond, *_ = tree._points(0.0, angle)[1][e]
            angle[far.owner] += twist[far.owner] - beyond
        return np.concatenate([angle, tree.speed * self.mean]), float(load[0])

    def radius(self) -> float:
        """Largest multiplier but that of a shift in time of a free line."""
        n, (state, torque) = self.tree.size, self.start()
        size = np.repeat([1.0, self.tree.speed], n)
        own = np.arange(2 * n)[1 if self.free else 0 :]  # the first angle of a free line is held
        for _ in range(ROUNDS):
            columns = np.eye(2 * n) * STEP * size
            moved = state[:, None] + np.hstack([columns, -columns, np.zeros((2 * n, 3))])
            torques = torque + np.append(np.zeros(4 * n), 1e7 * STEP * np.array([1.0, -1.0, 0.0]))
            end = self.missing(moved, torques)
            slope = (end[:, : 2 * n] - end[:, 2 * n : 4 * n]) / (2 * STEP * size)
            whole = slope[:, own]
            if self.free:
                whole = np.column_stack([whole, (end[:, -3] - end[:, -2]) / (2e7 * STEP)])
            change = np.linalg.solve(whole, -end[:, -1])
            state[own] += change[: len(own)]
            torque += float(change[-1]) if self.free else 0.0
            if np.abs(change[: len(own)] / size[own]).max() < 1e-9:
                values = np.linalg.eigvals(slope + np.eye(2 * n))
                return float(np.abs(np.delete(values, np.abs(values - 1).argmin()) if self.free else values).max())
        raise AssertionError("no motion")
