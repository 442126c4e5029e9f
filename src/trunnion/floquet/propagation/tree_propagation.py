"""Some states of a long line carried over a period in time, by power series along the tree.

With z = h² x″, y = h x′ and h the step, the coefficients of the series of M x″ + C x′ + K x = 0 follow one another,

    M₀ Z_m = −Σ_j (h C_j Y_{m−j} + h² K_j X_{m−j}) − Σ_{j>0} M_j Z_{m−j},    (m + 1)(X, Y)_{m+1} = (Y, Z)_m.

Entries that joints and meshes do not touch have j = 0 alone and are one sparse product; those that vary are few. Masses
are diagonal but at the legs of differentials.
"""

from __future__ import annotations

from collections.abc import Callable
from math import factorial

import numpy as np
from scipy import sparse

from trunnion.arrays import Array, Complex, Places
from trunnion.steady.hill.tree_hill import TreeHill
from trunnion.waiting import keep_time

ORDER, REACH = 32, 4.0
"""Terms of a series, and radians of the fastest mode that a step takes: the next term is 4³³/33! = 1e-17 of the first,
and cancellation costs a factor e⁴."""
SHORTER = 1.25
"""Steps of the second run, whose difference tells the error, over those of the first."""
CONVERGED = 1e-16
"""Share of an entry below which the last term of its own series lies."""


def rounding(steps: int) -> float:
    """Share of the states that so many steps lose by rounding."""
    return 1e-15 * float(np.sqrt(steps))


class TreePropagation:
    """Equations of one case of ``hill``, over one period."""

    def __init__(self, hill: TreeHill) -> None:
        self.rate, n = float(hill.step[0]), hill.own[0].shape[0]
        self.n, self.hill = n, hill
        place, tied = np.arange(n), np.flatnonzero(hill.parent >= 0)
        front = hill.parent[tied]
        rows, columns = (np.concatenate(each) for each in ((place, tied, front), (place, front, tied)))

        def whole(own: Array, coupling: Array) -> sparse.csr_array:
            values = np.concatenate([own[:, 0], coupling[tied, 0], coupling[tied, 0]])
            return sparse.csr_array((values, (rows, columns)), shape=(n, n))

        self.stiffness, self.damping = (whole(hill.own[k], hill.coupling[k]) for k in (0, 1))
        self.mass = whole(hill.own[2], hill.coupling[2])
        self.rows, self._row = np.unique([e.row for e in hill.varying], return_inverse=True)
        self.columns, self._column = np.unique([e.column for e in hill.varying], return_inverse=True)
        self.rows, self.columns = self.rows.astype(np.intp), self.columns.astype(np.intp)
        self._joined = self._joined_by_mass()

    def _joined_by_mass(self) -> Places:
        """Unknowns whose masses are joined to others (m,)."""
        joined = np.zeros(self.n, dtype=bool)
        beside = sparse.coo_array(self.mass)
        off = (beside.coords[0] != beside.coords[1]) & (beside.data != 0)
        joined[beside.coords[0][off]] = True
        for entry in self.hill.varying:
            if entry.row != entry.column and entry.parts[2].any():
                joined[[entry.row, entry.column]] = True
        return np.flatnonzero(joined)

    def _over_mass(self, varying: Array) -> Callable[[Array], Array]:
        """What divides torques (n, state) by the masses, ``varying`` (row, column) among them."""
        place = self._joined
        own, block = self.mass.diagonal(), self.mass[place][:, place].toarray() if len(place) else np.zeros((0, 0))
        for row, i in enumerate(self.rows.tolist()):
            for column, j in enumerate(self.columns.tolist()):
                if i == j:
                    own[i] += varying[row, column]
                if i in place and j in place:
                    block[np.searchsorted(place, i), np.searchsorted(place, j)] += varying[row, column]
        over, inverse = 1 / own[:, None], np.linalg.inv(block)

        def divided(torque: Array) -> Array:
            found = torque * over
            if len(place):
                found[place] = inverse @ torque[place]
            return found

        return divided

    def _series(self, begin: Array, h: float) -> Array:
        """Coefficients of the varying entries of h²K, hC and M (step, row, ORDER, 3, column) from times ``begin``."""
        found = np.zeros((len(begin), len(self.rows), ORDER, 3, len(self.columns)))
        power = np.arange(ORDER)
        over = np.array([1 / factorial(k) for k in range(ORDER)])
        for entry, row, column in zip(self.hill.varying, self._row, self._column, strict=True):
            turn = 1j * entry.apart * self.rate
            terms = (turn[:, None] * h) ** power * over  # (apart, order)
            wave = np.exp(np.outer(begin, turn))
            for k, scale in enumerate((h * h, h, 1.0)):
                found[:, row, :, k, column] += scale * ((wave * entry.parts[k][0]) @ terms).real
        return found

    def steps(self, fastest: float) -> int:
        """Steps over a period that take a mode of the exponent ``fastest`` [1/s], and what varies, to rounding."""
        period = 2 * np.pi / self.rate
        steps = max(8, int(np.ceil(fastest * period / REACH)))
        while any(not _converges(part[0], entry.apart * self.rate * period / steps)
                  for entry in self.hill.varying for part in entry.parts):  # fmt: skip
            steps = int(np.ceil(1.2 * steps))
        return steps

    def carried(self, x: Array, rate: Array, steps: int) -> tuple[Array, Array]:
        """Rotations and rates (n, state) after one period that begin with ``x`` and ``rate`` [1/s]."""
        n, r, c, states = self.n, len(self.rows), len(self.columns), x.shape[1]
        period = 2 * np.pi / self.rate
        h = period / steps
        constant = sparse.csr_array(sparse.hstack([h * h * self.stiffness, h * self.damping]))
        series = np.zeros((ORDER + 1, 2, n, states))  # X and Y
        past = np.zeros((ORDER, 3, c, states))
        batch = max(1, 4_000_000 // max(1, r * ORDER * 3 * c))
        y = h * rate
        for begin in range(0, steps, batch):
            keep_time()
            every = self._series(np.asarray(h * np.arange(begin, min(begin + batch, steps))), h)
            for one in every:
                divided = self._over_mass(one[:, 0, 2])
                one[:, 0, 2] = 0.0  # M₀ stands on the left
                turned = one[:, ::-1].reshape(r, ORDER * 3 * c)
                series[0, 0], series[0, 1] = x, y
                for m in range(ORDER):
                    right = constant @ series[m].reshape(2 * n, states)
                    if r:
                        past[m, :2] = series[m][:, self.columns]
                        past[m, 2] = 0.0
                        short = turned[:, (ORDER - 1 - m) * 3 * c :]
                        right[self.rows] += short @ past[: m + 1].reshape(-1, states)
                    z = -divided(right)
                    if r:
                        past[m, 2] = z[self.columns]
                    series[m + 1, 0] = series[m, 1] / (m + 1)
                    series[m + 1, 1] = z / (m + 1)
                x, y = series[::-1].sum(axis=0)
        return x, y / h


def _converges(share: Complex, turned: Array) -> bool:
    """Whether Σ c e^{ix} is known from ``ORDER`` terms up to |x| = ``turned``."""
    last = np.abs(turned).astype(float) ** (ORDER - 1) / factorial(ORDER - 1)
    return bool((np.abs(share) * last).sum() <= CONVERGED * np.abs(share).sum())
