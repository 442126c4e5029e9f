"""200 random chains of 2 to 8 disks against an independent high-precision integration in twist coordinates.

References: heyoka's Taylor integrator in 80-bit arithmetic, eigenvalues with 30 digits, stored in
tests/data/random_chains.json with the chains (tests/regenerate_references.py recomputes them). A third of
the chains carry loads, a seventh have a gear.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.chains import Chain, log_det_expected, random_chain, twist_monodromy
from oracles.comparisons import set_distance
from oracles.package_kernels import chain_kernel
from oracles.sampling import quick_every

import trunnion as tn
from trunnion.numerics.spectrum import multipliers, spectral_radius

ENTRIES: list[dict[str, Any]] = json.loads(
    (Path(__file__).parents[1] / "data" / "random_chains.json").read_text(encoding="utf-8")
)["entries"]
NUMBERS = quick_every(7, range(len(ENTRIES)))  # loads stand in every third, gears in every seventh: no factor of 7


def test_the_sample_is_wide() -> None:
    chains = [Chain(**e["chain"]) for e in ENTRIES]
    radii = np.array([e["spectral_radius"] for e in ENTRIES])
    assert len(chains) == 200 and {c.size for c in chains} == set(range(2, 9))
    assert sum(any(c.load) for c in chains) >= 50 and sum(c.gears != [1] * (c.size - 1) for c in chains) >= 20
    assert np.sum(radii > 1.001) >= 20 and np.sum(radii < 0.999) >= 20


@pytest.mark.parametrize("number", NUMBERS)
def test_dense_integrator(number: int) -> None:
    entry = ENTRIES[number]
    chain = Chain(**entry["chain"])
    found = tn.stability(chain.line(), chain.speed)
    assert found.period == pytest.approx(entry["half_turns"] * np.pi, rel=1e-14)
    wrong = abs(found.spectral_radius - entry["spectral_radius"])
    assert wrong < 1e-8 and wrong <= found.error_estimate
    assert found.error_estimate < 1e-7
    exact = np.array([complex(*v) for v in entry["multipliers"]])
    assert set_distance(found.multipliers, exact) < 1e-9
    assert found.liouville_defect < 1e-9
    own = np.log(np.abs(found.multipliers)).sum()
    assert own == pytest.approx(log_det_expected(chain), abs=1e-9)


@pytest.mark.parametrize("number", NUMBERS)
def test_chain_kernel(number: int) -> None:
    entry = ENTRIES[number]
    chain = Chain(**entry["chain"])
    matrix, error, trace = chain_kernel(chain.line(), chain.speed)
    radius, bound = spectral_radius(*multipliers(matrix, error))
    wrong = abs(radius[0] - entry["spectral_radius"])
    assert wrong < 1e-8 and wrong <= bound[0]
    assert bound[0] < 1e-6
    exact = np.array([complex(*v) for v in entry["multipliers"]])
    assert set_distance(np.linalg.eigvals(matrix[0]), exact) < 1e-8
    log_det = np.linalg.slogdet(matrix[0])[1]
    assert log_det == pytest.approx(-trace[0], abs=1e-9)
    assert log_det == pytest.approx(log_det_expected(chain), abs=1e-9)


@pytest.mark.parametrize("number", quick_every(4, range(0, 200, 10)))
def test_chain_kernel_runs_many_speeds_as_one(number: int) -> None:
    """A lane's result does not depend on its neighbours beyond the tolerance."""
    chain = Chain(**ENTRIES[number]["chain"])
    speeds = chain.speed * np.linspace(0.7, 1.5, 21)
    together, error, _ = chain_kernel(chain.line(), speeds)
    for i in (0, 7, 15, 16, 20):
        alone, own_error, _ = chain_kernel(chain.line(), speeds[i])
        assert np.abs(together[i] - alone[0]).max() <= error[i] + own_error[0]
        dense = tn.stability(chain.line(), float(speeds[i]))
        assert np.abs(np.linalg.eigvals(together[i])).max() == pytest.approx(dense.spectral_radius, abs=1e-8)


@pytest.mark.parametrize("name", ["two-shaft-cardan", "three-shaft-cardan"])
def test_half_a_period_suffices_where_joints_are_even(name: str) -> None:
    """With damping too: the half-period composition against the full period."""
    line = tn.catalogue(name, damping_ratio=0.02)
    speeds = np.linspace(0.2, 2.5, 40)
    half, half_error, half_trace = chain_kernel(line, speeds)
    full, full_error, full_trace = chain_kernel(line, speeds, halved=False)
    assert half_trace == pytest.approx(full_trace, rel=1e-9)
    for i in range(len(speeds)):
        apart = set_distance(np.linalg.eigvals(half[i]), np.linalg.eigvals(full[i]))
        assert apart < 1e-8 + 100 * (half_error[i] + full_error[i])


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8, 1e-11])
@pytest.mark.parametrize("number", quick_every(8, range(0, 200, 5)))
def test_estimates_hold_at_other_tolerances(number: int, tolerance: float) -> None:
    entry = ENTRIES[number]
    chain = Chain(**entry["chain"])
    radius, bound = spectral_radius(*multipliers(*chain_kernel(chain.line(), chain.speed, tolerance)[:2]))
    assert abs(radius[0] - entry["spectral_radius"]) <= bound[0]
    found = tn.stability(chain.line(), chain.speed, tolerance=tolerance)
    assert abs(found.spectral_radius - entry["spectral_radius"]) <= found.error_estimate


@pytest.mark.parametrize("seed", quick_every(4, range(12)))
def test_fresh_chains_against_scipy(seed: int) -> None:
    """Chains nobody has seen, integrated here by DOP853 at rtol = 1e-13."""
    chain = random_chain(np.random.default_rng(seed + 7_000))
    matrix = twist_monodromy(chain)
    found = tn.stability(chain.line(), chain.speed)
    assert set_distance(found.multipliers, np.linalg.eigvals(matrix)) < 1e-9
    assert found.liouville_defect < 1e-9
