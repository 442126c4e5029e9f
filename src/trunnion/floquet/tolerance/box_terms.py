"""A(τ) of boxes of lines, term by term, each with how it follows the logarithms of stiffness, damping, inertia, speed.

In coordinates (√J δ, √J δ′/ν), scaled by the middle of the box, A = [[0, νI], [−K/ν, −C]], and K and C are sums over
compliances e and rows i of terms that are all proportional to k_e s²/J_i or to c_e s/J_i (``bounds``), s = 1/Ω. So a
line of the box has Σ_t e^{θ_t} A_t(τ), θ_t = x_e + y_i + 2z or w_e + y_i + z, where x, w, y and z are how far the
logarithms of k_e, c_e, 1/J_i and s stand from the middle. A joint angle moves A_t itself.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.equations.coefficients import Assembly
from trunnion.floquet.tolerance.bounds import Coefficients, Ratios


@dataclass(frozen=True)
class BoxTerms:
    """Ends of compliances, scaled numbers of boxes, and which terms there are.

    power (terms, variables): how θ_t follows the variables; which (terms, 3): compliance, row, and 1 for a damping.
    """

    near: tuple[int, ...]
    far: tuple[int, ...]
    k: Array
    c: Array
    scale: Array
    nu: Array
    which: Integers
    power: Array

    @classmethod
    def of(cls, assembly: Assembly, co: Coefficients) -> BoxTerms:
        topo = assembly.topology
        near = tuple(topo.coordinate[topo.group_of(e.near)] for e in topo.compliances)
        far = tuple(topo.coordinate[e.far_group] for e in topo.compliances)
        k, c = co.k * co.s[:, None] ** 2, co.c * co.s[:, None]
        nu = np.sqrt((k * co.g[:, list(far)]).sum(axis=1) / topo.size)
        m, n = len(far), topo.size
        which = [(e, i, d) for e in range(m) for i in (near[e], far[e]) if i >= 0 for d in (0, 1)]
        power = np.zeros((len(which), 2 * m + n + 1))
        for t, (e, i, damping) in enumerate(which):
            power[t, damping * m + e] = power[t, 2 * m + i] = 1.0
            power[t, -1] = 1.0 if damping else 2.0
        return cls(near, far, k, c, np.sqrt(co.g), nu, np.array(which), power)

    @property
    def size(self) -> int:
        return self.scale.shape[1]

    def parts(self, b: Array, slope: Array) -> Array:
        """A_t (boxes, times, terms, 2n, 2n) at ratios b and db/dτ (boxes, times, compliances)."""
        ends = [self._ends(e, b[..., e], slope[..., e]) for e in range(len(self.far))]
        return self._rows(*(np.stack(p, axis=2) for p in zip(*ends, strict=True)))

    def moved_parts(self, at: Ratios) -> Array:
        """∂A_t/∂β of the line's only joint (boxes, times, terms, 2n, 2n)."""
        found = []
        for e in range(len(self.far)):
            b, slope, db, dslope = (p[..., e] for p in (at.b, at.slope, at.by_angle, at.slope_by_angle))
            u, v = self._vectors(e, b, slope)
            du, dv = self._vectors(e, db, dslope, 0.0)
            straight = _outer(du, u) + _outer(u, du)
            found.append((straight, _outer(du, v) + _outer(u, dv), straight))
        return self._rows(*(np.stack(p, axis=2) for p in zip(*found, strict=True)))

    def matrix(self, b: Array, slope: Array) -> Array:
        """A (boxes, times, 2n, 2n)."""
        out = self.parts(b, slope).sum(axis=2)
        n = self.size
        out[..., :n, n:] = self.nu[:, None, None, None] * np.eye(n)
        return np.asarray(out)

    def energy(self) -> Array:
        """The metric of the aligned line's energy (boxes, 2n, 2n)."""
        n = self.size
        straight = self.parts(*(np.full((len(self.nu), 1, len(self.far)), x) for x in (1.0, 0.0)))
        stiff = -straight[:, 0].sum(axis=1)[:, n:, :n] / self.nu[:, None, None]
        out = np.zeros((len(self.nu), 2 * n, 2 * n))
        out[:, :n, :n], out[:, n:, n:] = (stiff + stiff.swapaxes(1, 2)) / 2, np.eye(n)
        return out

    def _vectors(self, e: int, b: Array, slope: Array, far: float = 1.0) -> tuple[Array, Array]:
        """(−b, 1) and (−b′, 0) of a compliance in scaled coordinates (boxes, times, n)."""
        p, i = self.near[e], self.far[e]
        u, v = (np.zeros((*b.shape, self.size)) for _ in range(2))
        u[..., i] = far * self.scale[:, None, i]
        if p >= 0:
            u[..., p] = -b * self.scale[:, None, p]
            v[..., p] = -slope * self.scale[:, None, p]
        return u, v

    def _ends(self, e: int, b: Array, slope: Array) -> tuple[Array, Array, Array]:
        u, v = self._vectors(e, b, slope)
        straight = _outer(u, u)
        return straight, _outer(u, v), straight

    def _rows(self, k_part: Array, d_part: Array, c_part: Array) -> Array:
        """Terms from the parts of compliances (boxes, times, compliances, n, n) that k, c in K and c in C multiply."""
        n, nu = self.size, self.nu[:, None, None]
        out = np.zeros((*k_part.shape[:2], len(self.which), 2 * n, 2 * n))
        for t, (e, i, damping) in enumerate(self.which):
            c, k = self.c[:, e, None, None], self.k[:, e, None, None]
            if damping:
                out[:, :, t, n + i, :n] = -c / nu * d_part[:, :, e, i]
                out[:, :, t, n + i, n:] = -c * c_part[:, :, e, i]
            else:
                out[:, :, t, n + i, :n] = -k / nu * k_part[:, :, e, i]
        return out

    def most(self, at: Ratios) -> Array:
        """Bounds on ‖A_t‖ everywhere (boxes, terms)."""
        return self._norms(at.most**2, at.most, 1.0, at.most * at.most_slope, at.most_slope)

    def steepest(self, at: Ratios) -> Array:
        """Bounds on ‖dA_t/dτ‖ everywhere (boxes, terms)."""
        m, m1, m2 = at.most, at.most_slope, at.most_bend
        return self._norms(2 * m * m1, m1, 0.0, m1**2 + m * m2, m2)

    def moved(self, at: Ratios) -> Array:
        """Bounds on how far A_t moves with the joint angle (boxes, terms)."""
        m, m1, d, d1 = at.most, at.most_slope, at.moved, at.slope_moved
        return self._norms(2 * m * d + d**2, d, 0.0, m * d1 + m1 * d + d * d1, d1)

    def moved_steepest(self, at: Ratios) -> Array:
        """Bounds on ‖d²A_t/dβdτ‖ times the half-width of the angle (boxes, terms)."""
        m, m1, m2, d, d1, d2 = at.most, at.most_slope, at.most_bend, at.moved, at.slope_moved, at.bend_moved
        return self._norms(2 * (m * d1 + m1 * d), d1, 0.0, 2 * m1 * d1 + m * d2 + m2 * d, d2)

    def moved_twice(self, at: Ratios) -> Array:
        """Bounds on what the first order in the angle leaves out (boxes, terms)."""
        m, m1, d, d1, h, h1 = at.most, at.most_slope, at.moved, at.slope_moved, at.moved_twice, at.slope_moved_twice
        return self._norms(2 * m * h + d**2 + 2 * d * h + h**2, h, 0.0, m * h1 + m1 * h + (d + h) * (d1 + h1), h1)

    def _norms(self, same: Array, cross: Array, far: float, mixed: Array, mixed_cross: Array) -> Array:
        """Frobenius norms of terms whose entries are bounded by ``same`` at (p, p), ``cross`` at (p, i) and (i, p) and
        ``far`` at (i, i) of u uᵀ, and by ``mixed`` and ``mixed_cross`` at (p, p) and (i, p) of u u̇ᵀ."""
        n = self.size
        straight, turning = (np.zeros((len(self.nu), 1, len(self.far), n, n)) for _ in range(2))
        for e, (p, i) in enumerate(zip(self.near, self.far, strict=True)):
            straight[:, 0, e, i, i] = far * self.scale[:, i] ** 2
            if p >= 0:
                both = self.scale[:, p] * self.scale[:, i]
                straight[:, 0, e, p, p] = same[:, e] * self.scale[:, p] ** 2
                straight[:, 0, e, p, i] = straight[:, 0, e, i, p] = cross[:, e] * both
                turning[:, 0, e, p, p] = mixed[:, e] * self.scale[:, p] ** 2
                turning[:, 0, e, i, p] = mixed_cross[:, e] * both
        return np.asarray(np.linalg.norm(self._rows(straight, turning, straight)[:, 0], axis=(2, 3)))


def _outer(left: Array, right: Array) -> Array:
    return np.asarray(left[..., :, None] * right[..., None, :])
