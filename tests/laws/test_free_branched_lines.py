"""Random branched free–free lines, with angled joints, against their return map written anew.

Nodes j with inertia J_j hang on parents: f_j = k_j(φ_j − ψ_j) + c_j(φ̇_j − ψ̇_j) with ψ_j the rotation that the joint
and ratio between make of the parent's. J_jφ̈_j = −f_j − M_j(φ̇_j) + Σ_children (∂ψ/∂φ) f. The rotation of the root is
the independent variable, so that the return map needs no event; the drive torque is the unknown that keeps the speed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.comparisons import set_distance
from scipy.integrate import solve_ivp

import trunnion as tn

Array = NDArray[np.float64]
SPEED = 60.0


@dataclass
class Node:
    """An inertia behind a joint (angle, plane; None for none), a ratio and a shaft.

    ``shift``: rotation of the forks behind from where the plane of the last joint counts from; an output fork
    stands a quarter turn from the input fork, and a plane is given from that of the joint before.
    """

    parent: int
    inertia: float
    stiffness: float = 0.0
    damping: float = 0.0
    joint: tuple[float, float] | None = None
    ratio: float = 1.0
    shift: float = 0.0
    loads: tuple[float, float, float] = (0.0, 0.0, 0.0)


def random_nodes(rng: np.random.Generator) -> list[Node]:
    def between(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    nodes = [Node(-1, between(0.1, 1.0))]
    for k in range(1, int(rng.integers(3, 5))):
        bent = k == 1 or rng.random() < 0.6
        angle = float(rng.choice([0.1, 0.3, 0.6]) * rng.uniform(0.8, 1.2))
        plane = 0.0 if k == 1 else float(rng.choice([0.0, np.pi / 4, rng.uniform(0, np.pi)]))
        nodes.append(
            Node(
                int(rng.integers(0, k)) if k < 3 else 1,
                between(0.1, 1.0),
                between(3e3, 3e4),
                between(1.0, 10.0),
                (angle, plane) if bent else None,
                float(rng.choice([1.0, -1.0, 2.0])),
                0.0,
                (between(1, 30), *([between(0.01, 0.2), between(1e-4, 3e-3)] if k == 2 else [0.0, 0.0])),
            )
        )
        node, before = nodes[-1], nodes[nodes[-1].parent].shift
        node.shift = (before - plane + np.pi / 2 if bent else before) / node.ratio
    return nodes


def line_of(nodes: list[Node]) -> tn.Driveline:
    elements: list[object] = [tn.Disk(inertia=nodes[0].inertia, drive_share=1.0, name="n0")]
    before = 0
    for k, node in enumerate(nodes[1:], start=1):
        chain: list[tuple[type, dict[str, object]]] = []
        if node.joint is not None:
            chain.append((tn.HookeJoint, {"angle": node.joint[0], "plane": node.joint[1]}))
        if node.ratio != 1:
            chain.append((tn.Ratio, {"ratio": node.ratio}))
        chain.append((tn.Shaft, {"stiffness": node.stiffness, "damping": node.damping}))
        kind, first = chain[0]
        if node.parent != before:
            first = first | {"after": f"n{node.parent}"}
        constant, viscous, quadratic = node.loads
        disk = tn.Disk(
            inertia=node.inertia, load_torque=constant, viscous_load=viscous, quadratic_load=quadratic, name=f"n{k}"
        )
        elements += [kind(**first), *(other(**keys) for other, keys in chain[1:]), disk]
        before = k
    return tn.Driveline(elements)


def transmitted(nodes: list[Node], k: int, angle: Array) -> tuple[Array, Array]:
    """Rotation behind joint and ratio of node ``k`` at its parent's ``angle``, and its slope: tan ψ = tan χ/cos β."""
    node = nodes[k]
    ahead, gain = np.zeros_like(angle), np.ones_like(angle)
    if node.joint is not None:
        beta, plane = node.joint
        chi = angle + nodes[node.parent].shift - plane
        swing, cosine = np.sin(chi) * np.cos(chi), np.cos(beta)
        ahead = np.arctan2((1 - cosine) * swing, cosine * np.cos(chi) ** 2 + np.sin(chi) ** 2)
        gain = cosine / (1 - np.sin(beta) ** 2 * np.cos(chi) ** 2)
    return (angle + ahead) / node.ratio, gain / node.ratio


def rates(theta: float, flat: Array, nodes: list[Node]) -> Array:
    """d/dθ of rotations of all nodes but the root, speeds of all, time and (held) drive torque; (2n + 1, columns)."""
    n = len(nodes)
    z = flat.reshape(2 * n + 1, -1)
    phi = np.concatenate([np.full((1, z.shape[1]), theta), z[: n - 1]])
    v, drive = z[n - 1 : 2 * n - 1], z[2 * n]
    push = np.zeros_like(v)
    push[0] += drive
    for k, node in enumerate(nodes[1:], start=1):
        psi, gain = transmitted(nodes, k, phi[node.parent])
        torque = node.stiffness * (phi[k] - psi) + node.damping * (v[k] - gain * v[node.parent])
        constant, viscous, quadratic = node.loads
        sense = np.sign(means(nodes)[k])  # a load torque opposes the mean rotation
        push[k] -= torque + constant * sense + viscous * v[k] + quadratic * v[k] * np.abs(v[k])
        push[node.parent] += gain * torque
    a = push / np.array([node.inertia for node in nodes])[:, None]
    out = np.concatenate([v[1:], a, np.ones((1, z.shape[1])), np.zeros((1, z.shape[1]))]) / v[0]
    return out.reshape(flat.shape)


def means(nodes: list[Node]) -> list[float]:
    """Mean speeds over that of the root."""
    through = [1.0]
    for node in nodes[1:]:
        through.append(through[node.parent] / node.ratio)
    return through


def return_map(nodes: list[Node], turn: float) -> tuple[Array, float]:
    """Multipliers of the return map over ``turn`` [rad] of the root, and the drive torque that keeps the mean speed."""
    n = len(nodes)
    through = means(nodes)
    held = zip(through, (node.loads for node in nodes), strict=True)
    loads = [a + (b + c * SPEED * abs(g)) * SPEED * abs(g) for g, (a, b, c) in held]
    drive = sum(abs(g) * load for g, load in zip(through, loads, strict=True))
    z = np.array([*np.zeros(n - 1), *(SPEED * g for g in through), 0.0, drive])
    # Rotations at the start, down the tree, at zero twist.
    for k in range(1, n):
        up = z[nodes[k].parent - 1] if nodes[k].parent else 0.0
        z[k - 1] = transmitted(nodes, k, np.array([up]))[0][0]
    free = [*range(2 * n - 1), 2 * n]
    scale = np.array([1e-3] * (n - 1) + [1e-2 * SPEED] * n + [0.0] + [1.0])
    goal = np.array([*(turn * g for g in through[1:]), *np.zeros(n), turn / SPEED])
    slope = np.zeros((2 * n, 2 * n))
    for _ in range(15):
        steps = np.diag(scale)[:, free] * 1e-3
        columns = np.concatenate([z[:, None], z[:, None] + steps, z[:, None] - steps], axis=1)
        run = solve_ivp(rates, (0, turn), columns.ravel(), "DOP853", args=(nodes,), rtol=1e-12, atol=1e-13)
        moved = (run.y[:, -1].reshape(columns.shape) - columns)[: 2 * n]
        count = len(free)
        slope = (moved[:, 1 : count + 1] - moved[:, count + 1 :]) / 2e-3
        step = np.linalg.solve(slope, goal - moved[:, 0])
        z[free] += step * scale[free]
        if np.abs(step).max() < 1e-7:
            break
    inner = 2 * n - 1
    section = slope[:inner, :inner] / scale[:inner] + np.eye(inner)
    return np.linalg.eigvals(section), float(z[2 * n] - drive)


@pytest.mark.parametrize("seed", [*range(3), *(pytest.param(s, marks=pytest.mark.slow) for s in range(3, 40))])
def test_random_free_branched_lines(seed: int) -> None:
    """Multipliers beside the phase's 1 are those of the return map; the extra torque keeps the speed."""
    nodes = random_nodes(np.random.default_rng(seed))
    line = line_of(nodes)
    found = tn.stability(line, SPEED)
    turn = found.period
    truth, extra = return_map(nodes, turn)
    nearest = int(np.argmin(np.abs(found.multipliers - 1)))
    assert abs(found.multipliers[nearest] - 1) < 1e-6
    assert set_distance(np.delete(found.multipliers, nearest), truth) < 1e-5
    assert found.extra_torque == pytest.approx(extra, rel=1e-5, abs=1e-6)
