"""The 0–1 test for chaos: an indicator that knows no equations and no tangents, only a series.

A series φ_j drives a point in the plane, p_c(n) = Σ φ_j cos jc, q_c(n) = Σ φ_j sin jc. Of regular motion the
point stays bounded; of chaotic motion it diffuses, and its mean square displacement grows with n:

    M_c(n) = ⟨(p_c(j+n) − p_c(j))² + (q_c(j+n) − q_c(j))²⟩,   D_c(n) = M_c(n) − ⟨φ⟩² (1 − cos nc)/(1 − cos c),

K_c is the correlation of D_c(n) with n, and K the median over random c: near 0 regular, near 1 chaotic
(Gottwald and Melbourne, SIAM J. Appl. Dyn. Syst. 8, 2009, 129–145, sections 3.1–3.3).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.errors import InputError

FREQUENCIES = 100
FEWEST = 200
"""Points below which the test says little."""
STILL = 1e-7
"""Spread over size below which a series counts as constant."""
LIMIT = "alone it proves no chaos: a strange attractor without chaos gives K near 1 too, see the exponents"
REGULAR, CHAOTIC = 0.3, 0.7
"""K below which the test says regular, and above which it says chaotic."""


@dataclass(frozen=True)
class ZeroOne:
    """k: the indicator; by_frequency (100,): K_c at the frequencies tried."""

    k: float
    by_frequency: Array
    points: int

    @property
    def says(self) -> str:
        """regular, chaotic or undecided."""
        return "regular" if self.k < REGULAR else "chaotic" if self.k > CHAOTIC else "undecided"

    def __str__(self) -> str:
        words = f"0–1 test on {self.points} points: K = {self.k:.3f} ({self.says})"
        return f"{words}; {LIMIT}" if self.says == "chaotic" else words


def zero_one_test(series: ArrayLike, *, scale: float = 0.0) -> ZeroOne:
    """The 0–1 test for chaos on a series sampled once per period, or once per crossing of a section.

    K is near 0 for a regular series and near 1 for a chaotic one. A series sampled too finely looks regular whatever it
    is. A strange attractor without chaos (two incommensurate forcings of a strongly damped system, say) diffuses as
    well, K near 1, while its exponents are not positive: only the exponents tell, and ``certify_chaos`` asks both.

    Parameters
    ----------
    series : (points,) in any unit, 200 or more.
    scale : size of the quantity, in its unit; a spread below 1e-7 of it counts as none. By default 0: any spread
        counts.

    Returns
    -------
    ZeroOne: ``k`` [-], and what it ``says``: regular, chaotic or undecided.

    Raises
    ------
    InputError : fewer than 200 points, or not finite.

    Examples
    --------
    >>> import numpy as np, trunnion as tn
    >>> logistic = [0.3]
    >>> for _ in range(999):
    ...     logistic.append(4 * logistic[-1] * (1 - logistic[-1]))
    >>> tn.zero_one_test(logistic).says, tn.zero_one_test(np.sin(np.arange(1000.0))).says
    ('chaotic', 'regular')
    """
    phi = np.asarray(series, dtype=float)
    if phi.ndim != 1 or len(phi) < FEWEST or not np.all(np.isfinite(phi)):
        raise InputError(f"must be {FEWEST} finite numbers or more", key="series", value=phi.shape)
    size = max(scale, float(np.abs(phi).max()))
    if np.ptp(phi) <= STILL * size:
        return ZeroOne(0.0, np.zeros(FREQUENCIES), len(phi))
    c = np.random.default_rng(0).uniform(np.pi / 5, 4 * np.pi / 5, FREQUENCIES)
    j = np.arange(1, len(phi) + 1)
    walk = np.cumsum(phi * np.exp(1j * np.outer(c, j)), axis=1)
    most = len(phi) // 10
    n = np.arange(1, most + 1)
    base = walk[:, : len(phi) - most]
    square = np.stack([np.mean(np.abs(walk[:, k : k + base.shape[1]] - base) ** 2, axis=1) for k in n], axis=1)
    swing = phi.mean() ** 2 * (1 - np.cos(np.outer(c, n))) / (1 - np.cos(c))[:, None]
    found = np.array([_correlation(n.astype(float), row) for row in square - swing])
    return ZeroOne(float(np.median(found)), found, len(phi))


def _correlation(a: Array, b: Array) -> float:
    a, b = a - a.mean(), b - b.mean()
    size = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / size if size > 0 else 0.0
