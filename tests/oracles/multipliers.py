"""Multipliers of a propagator that a test has carried itself, and whether those found are all of them."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from oracles.long_tree_equations import Motion


def multipliers(motion: Motion) -> tuple[Any, Any]:
    """All of them, and to which the propagator's error lets them be known."""
    value, right = np.linalg.eig(motion.propagator)
    condition = np.linalg.norm(right, axis=0) * np.linalg.norm(np.linalg.inv(right), axis=1)
    rounding = 1e-14 * float(np.linalg.norm(motion.propagator, 2))
    bound = 2 * condition * (motion.error + rounding)
    return value, np.where(bound < 1e-3, bound, np.sqrt(bound))


def matched(true: Any, error: Any, found: Any, bound: Any) -> None:
    """Every one is the partner of one, nearest first."""
    assert len(true) == len(found)
    apart = np.abs(true[:, None] - found) / (error[:, None] + bound)
    rows, columns = linear_sum_assignment(np.minimum(apart, 1e6))
    assert apart[rows, columns].max() <= 1
