"""The package's absolute coordinates and the papers' twist coordinates describe the same motion."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.chains import Chain, twist_monodromy
from oracles.comparisons import floquet, set_distance
from oracles.printed_matrices import three_shafts, two_shafts

import trunnion as tn


@pytest.mark.parametrize(
    ("speed", "beta", "zeta", "gamma", "alpha", "mu"),
    [
        (1.41, 0.5, 0.001, 100.0, 1.0, 1.0),
        (0.37, 0.9, 0.001, 100.0, 1.0, 1.0),
        (0.8, 1.2, 0.03, 0.4, 2.0, 0.5),
        (2.2, 0.7, 0.0, 3.0, 1.0, 4.0),
    ],
)
def test_two_shafts(speed: float, beta: float, zeta: float, gamma: float, alpha: float, mu: float) -> None:
    line = tn.catalogue(
        "two-shaft-cardan",
        angle=beta,
        damping_ratio=zeta,
        inertia_of_disk_2=gamma,
        damping_of_shaft_2=alpha,
        stiffness_of_shaft_2=mu,
    )

    def at(tau: float) -> tuple[np.ndarray, np.ndarray]:
        e, p = two_shafts(np.array([tau]), speed, beta, zeta, gamma, alpha=alpha, mu=mu)
        return e[0], p[0]

    assert set_distance(tn.stability(line, speed).multipliers, floquet(at, 2, np.pi, rtol=1e-13)) < 1e-10


@pytest.mark.parametrize(
    ("speed", "betas", "zeta", "gammas", "alphas", "mus"),
    [
        (0.91, (0.5, 0.8), 0.02, (1.5, 10.0), (1.2, 0.7), (0.6, 1.7)),
        (1.7, (0.2, 0.2), 0.001, (1.0, 10.0), (1.0, 1.0), (1.0, 1.0)),
        (0.5, (1.1, 0.3), 0.005, (0.3, 2.0), (0.5, 3.0), (2.0, 0.4)),
    ],
)
def test_three_shafts(
    speed: float,
    betas: tuple[float, float],
    zeta: float,
    gammas: tuple[float, float],
    alphas: tuple[float, float],
    mus: tuple[float, float],
) -> None:
    line = tn.catalogue(
        "three-shaft-cardan",
        angle_1=betas[0],
        angle_2=betas[1],
        damping_ratio=zeta,
        inertia_of_disk_2=gammas[0],
        inertia_of_disk_3=gammas[1],
        damping_of_shaft_2=alphas[0],
        damping_of_shaft_3=alphas[1],
        stiffness_of_shaft_2=mus[0],
        stiffness_of_shaft_3=mus[1],
    )

    def at(tau: float) -> tuple[np.ndarray, np.ndarray]:
        e, p = three_shafts(np.array([tau]), speed, betas, zeta, gammas, alphas=alphas, mus=mus)
        return e[0], p[0]

    assert set_distance(tn.stability(line, speed).multipliers, floquet(at, 3, np.pi, rtol=1e-13)) < 1e-10


def test_recursion_of_the_oracle_is_the_papers_matrix() -> None:
    """The n-shaft recursion of ``oracles.chains`` reduces to S3's mended matrices."""
    betas, zeta = (0.5, 0.8), 0.02
    chain = Chain(
        speed=0.91,
        stiffness=[1.0, 0.6, 1.7],
        damping=[2 * zeta, 2 * zeta * 1.2, 2 * zeta * 0.7],
        inertia=[1.0, 1.5, 10.0],
        angle=list(betas),
        fork_offset=[np.pi / 2, np.pi / 2, 0.0],
        plane=[0.0, 0.0],
    )

    def at(tau: float) -> tuple[np.ndarray, np.ndarray]:
        e, p = three_shafts(np.array([tau]), 0.91, betas, zeta, (1.5, 10.0), alphas=(1.2, 0.7), mus=(0.6, 1.7))
        return e[0], p[0]

    assert set_distance(np.linalg.eigvals(twist_monodromy(chain)), floquet(at, 3, np.pi, rtol=1e-13)) < 1e-11
