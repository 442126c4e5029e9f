"""Draws from likelihoods whose answer is known: a Gaussian, a banana, two hills, a bound."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import norm

from trunnion.measured.identification.sampling import draws


def begun(count: int, low: float, high: float, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).uniform(low, high, (30, count))


def test_a_gaussian_in_any_units() -> None:
    """Correlated, one unit a million times the other: means, deviations and correlation."""
    covariance = np.array([[4.0, 1.8e6], [1.8e6, 1e12]])
    inverse = np.linalg.inv(covariance)
    start = begun(2, -1.0, 1.0, 1) * np.sqrt(np.diag(covariance))
    found = draws(lambda x: -0.5 * np.einsum("ni,ij,nj->n", x, inverse, x), start, 900, 2)
    assert found.effective > 400 and 0.2 < found.accepted < 0.8
    spread = np.sqrt(np.diag(covariance))
    error = 4 / np.sqrt(found.effective)
    assert np.all(np.abs(found.points.mean(axis=0) / spread) < error)
    assert np.all(np.abs(found.points.std(axis=0) / spread - 1) < error)
    assert np.corrcoef(found.points.T)[0, 1] == pytest.approx(0.9, abs=0.05)


def test_a_banana() -> None:
    """y = x² + noise, x normal: y is as χ² with one degree of freedom and some noise, far from Gaussian."""
    found = draws(
        lambda p: -0.5 * p[:, 0] ** 2 - 0.5 * ((p[:, 1] - p[:, 0] ** 2) / 0.5) ** 2, begun(2, -1.0, 1.0, 3), 3000, 4
    )
    assert found.effective > 200
    x, y = found.points.T
    normal, noise = np.random.default_rng(5).standard_normal((2, 400_000))
    for share in (0.025, 0.25, 0.5, 0.75, 0.975):
        assert norm.cdf(np.quantile(x, share)) == pytest.approx(share, abs=0.05)
        true = np.quantile(normal**2 + 0.5 * noise, share)
        assert (y < true).mean() == pytest.approx(share, abs=0.05)


def test_two_hills_have_their_shares() -> None:
    """Three quarters of the mass on one of two hills that stand twenty deviations apart: leaps weigh them."""

    def log_density(p: np.ndarray) -> np.ndarray:
        a = np.log(0.75) - 0.5 * ((p - 5.0) ** 2).sum(axis=1) / 0.25
        b = np.log(0.25) - 0.5 * ((p + 5.0) ** 2).sum(axis=1) / 0.25
        return np.logaddexp(a, b)

    rng = np.random.default_rng(6)
    start = np.where(np.arange(30)[:, None] % 2, 5.0, -5.0) + 0.5 * rng.standard_normal((30, 2))
    found = draws(log_density, start, 3000, 7)
    right = found.points[:, 0] > 0
    assert right.mean() == pytest.approx(0.75, abs=0.05)
    assert found.points[right, 0].std() == pytest.approx(0.5, abs=0.05)
    low, high = np.quantile(found.points[:, 0], (0.025, 0.975))
    assert low == pytest.approx(-5.0 + 0.5 * norm.ppf(0.1), abs=0.12) and high == pytest.approx(
        5.0 + 0.5 * norm.ppf(1 - 0.025 / 0.75), abs=0.12
    )


def test_nothing_beyond_a_bound() -> None:
    found = draws(lambda p: np.where(p[:, 0] >= 0, -p[:, 0], -np.inf), begun(1, 0.0, 1.0, 8), 2000, 9)
    assert found.points.min() >= 0
    for share in (0.1, 0.5, 0.9):
        assert (found.points[:, 0] < -np.log(1 - share)).mean() == pytest.approx(share, abs=0.04)
