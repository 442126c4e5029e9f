"""Of lines with every feature: accelerations, their slopes and what drives do along motions of a tree, by its matrices
and by the compiled equations; and which lines are smooth."""

from __future__ import annotations

import feature_lines
import numpy as np
import pytest

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.equations.line_regimes import line_regimes
from trunnion.equations.prepared_line import with_stages
from trunnion.steady.free.free_balance import SteadyStates
from trunnion.steady.free.periodic_steady_states import SteadyStatesBySpeed

SPEEDS, HARMONICS = np.array([80.0, 130.0]), 6


def described(key: str) -> list[tn.Driveline]:
    """The lines that have a feature, of those that can have it."""
    found = list[tn.Driveline]()
    for base in (feature_lines.bent(), feature_lines.free(feature_lines.bent()), feature_lines.straight()):
        for change in feature_lines.CHANGES[key]:
            try:
                found.append(change(base))
                assemble(found[-1])
            except (tn.InputError, KeyError):
                continue
    return found


def trees(key: str) -> list[SteadyStatesBySpeed]:
    """The motions of those that are trees."""
    found = list[SteadyStatesBySpeed]()
    for line in described(key):
        motions = SteadyStatesBySpeed(line, compiled=False)
        try:
            if not motions.unexcited.topology.rates:  # nothing moves it
                continue
            if not motions.obstacle and motions.balance.of_tree:
                found.append(motions)
        except tn.InputError:
            continue
    return found


@pytest.mark.parametrize("key", feature_lines.CHANGES)
def test_matrices_of_a_tree_are_slopes_of_the_compiled_equations(key: str) -> None:
    """Along anything that closes: accelerations, and what drives add; slopes along a motion that the line makes."""
    rng = np.random.default_rng(7)
    for curve in trees(key):
        balance, n = curve.balance, len(curve.balance.turn)
        rows = rng.normal(size=(2, n, 2 * HARMONICS + 1)) * 0.02
        motions = SteadyStates(balance, SPEEDS, np.ones(2, dtype=bool), rows, rng.normal(size=2) * 5.0)
        rates, _ = motions._compiled(0.0)
        felt, _ = motions.sampled()
        size = np.abs(felt).max()
        assert np.abs(felt - rates[..., n:]).max() < 1e-11 * size
        driven = (motions._compiled(1.0)[0] - rates)[..., n:]
        assert np.abs(motions.by_drive() - driven).max() < 1e-13 * size  # a difference of rounded accelerations
        made = balance.solve(SPEEDS, 4 * HARMONICS)
        by_state, slopes = made.sampled()[1][made.found], made._compiled(0.0)[1][made.found]
        assert np.abs(by_state - slopes[:, :, n:]).max(initial=0.0) < 1e-8 * np.abs(slopes).max(initial=1.0)


def test_most_features_have_lines_that_are_trees() -> None:
    assert sum(bool(trees(key)) for key in feature_lines.CHANGES) >= 40


@pytest.mark.parametrize("key", feature_lines.CHANGES)
def test_lines_are_smooth_where_they_have_one_regime(key: str) -> None:
    for line in described(key):
        assembly = assemble(line)
        try:
            regimes = line_regimes(assembly)
        except tn.InputError:
            continue
        assert with_stages(assembly) == (regimes is not None)
