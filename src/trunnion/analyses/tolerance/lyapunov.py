"""Boxes of lines proved stable by a Lyapunov function that turns with the joints.

At the middle of a box let W(τ) = e^{Λτ} V⁻¹ Φ(τ)⁻¹ from an ordinary integration, turned into a trigonometric
polynomial; from here on W is that polynomial, exact by definition, and how it was found does not matter. With V(x,
τ) = |W(τ)x|²,

    dV/dτ = 2 Re (Wx)ᴴ (W′ + WA) x,

so a line is asymptotically stable if Herm[Wᴴ(W′ + WA)] is negative definite at all τ of the period (V cannot then
vanish for x ≠ 0, or it would turn negative). With W′ + WA(middle) = ΛW + R and y = Wx this is

    −Γ + Herm[Σ_v r_v W ∂_vA W⁻¹ + R W⁻¹ + second orders]  <  0   at all τ,   Γ = −Re Λ > 0.

On the piece of the turn about each sample τ_j, with Q the computed W(τ_j)⁻¹, W(τ)Q = I + E and |E| ≤ ε, so W⁻¹ =
Q(I + E)⁻¹: what stands at the sample, S = Σ r_v W ∂_vA Q, becomes (S + D)(I + E)⁻¹ with |D| bounded by the derivatives
of W and ∂_vA, and so differs from S by at most |D| + (|S| + |D|) ε/(1 − ε). Γ does not change along the piece.

Frequencies that change with stiffness or inertia turn the phase of W x and drop out of the Hermitian part; what is
left are couplings between modes, so boxes may be about as wide as twice the damping ratio. R times the joints'
denominators is a trigonometric polynomial of known degree, so its samples bound it (Ehlich and Zeller 1964: by
1/cos(πm/N) for degree m and N samples); everything else is bounded entry by entry (``bounds``).

Rounding. With u = 1.1e-16, a fast transform of N values errs in each by less than 5 u log₂N times the sum of their
absolute values (Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., section 24.1), so W by 5e-15 and W′ by
5e-15 of the sums over their harmonics that bound them everywhere; the joints' laws, and so A, by some 10 u of each
entry; products of matrices of 2n ≤ 6 by 2n u of the product of norms. All of these are less than 1e-13 of
‖W′‖ + ‖W‖(‖A‖ + |Λ|), bounded everywhere (``_carried``); ``SLACK`` adds a thousand times as much, before samples are
turned into bounds. Q is what was computed, and its defect WQ − I counts. Tests compare with 80-bit arithmetic.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.tolerance.bounds import Coefficients, Ratios, over_boxes, ratios
from trunnion.equations.coefficients import Assembly

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

STEPS = 512
"""Steps of the integration over half a turn, and samples at which the inequality is tested."""
HARMONICS = 128
"""Samples that W is made of: half as many harmonics of 2τ on either side."""
HALF_TURN = np.pi
SLACK = 1e-10
"""Share of ``_carried`` added for rounding: a thousand times what it can be."""


@dataclass(frozen=True)
class Judged:
    """For each box: proved stable, and the largest multiplier at its middle, each (boxes,)."""

    proved: NDArray[np.bool_]
    radius: Array


def judge_boxes(assembly: Assembly, low: Array, high: Array) -> Judged:
    """Boxes between tables of numbers (boxes, columns) at their low and high ends."""
    co = over_boxes(assembly, low, high)
    tau = HALF_TURN * np.arange(2 * STEPS) / (2 * STEPS)
    at = ratios(assembly, (low + high) / 2, co, tau)
    model = _Model.of(assembly, co)
    a = model.matrix(at.b, at.slope)
    with np.errstate(all="ignore"):
        w, w_slope, lam, radius, most_w, most_slope = _floquet(a)
        q = np.linalg.inv(np.where(np.isfinite(w), w, np.eye(w.shape[-1]))).astype(complex)
    sample = a[:, ::2]
    here = Ratios(at.b[:, ::2], at.slope[:, ::2], at.most, at.most_slope, at.most_bend, at.moved, at.slope_moved)
    proved = _holds(model, co, here, sample, w, w_slope, q, lam, most_w, most_slope)
    return Judged(proved & (radius < 1), radius)


def _floquet(a: Array) -> tuple[Complex, Complex, Complex, Array, Array, Array]:
    """W and W′ (boxes, samples, 2n, 2n), Λ (boxes, 2n), radius, and bounds on ‖W‖ and ‖W′‖ everywhere (boxes,)."""
    modes, lam, radius = _modes(a)
    order = np.round(np.fft.fftfreq(HARMONICS) * HARMONICS)
    padded = np.zeros((len(a), STEPS, *modes.shape[2:]), dtype=complex)
    place = order.astype(int) % STEPS
    padded[:, place] = modes
    w = np.fft.ifft(padded, axis=1) * STEPS
    padded[:, place] = modes * (2j * order[:, None, None])
    slope = np.fft.ifft(padded, axis=1) * STEPS
    each = np.linalg.norm(modes, axis=(2, 3))
    return w, slope, lam, radius, each.sum(axis=1), (2 * np.abs(order) * each).sum(axis=1)


def _modes(a: Array) -> tuple[Complex, Complex, Array]:
    """Coefficients of W at e^{2ikτ} (boxes, harmonics, 2n, 2n), which define it; Λ (boxes, 2n), radius (boxes,)."""
    boxes, _, size, _ = a.shape
    h = HALF_TURN / STEPS
    phi = np.broadcast_to(np.eye(size), (boxes, size, size)).copy()
    every = np.empty((boxes, HARMONICS, size, size))
    for step in range(STEPS):
        if step % (STEPS // HARMONICS) == 0:
            every[:, step // (STEPS // HARMONICS)] = phi
        first, middle, last = a[:, 2 * step], a[:, 2 * step + 1], a[:, (2 * step + 2) % (2 * STEPS)]
        k1 = first @ phi
        k2 = middle @ (phi + h / 2 * k1)
        k3 = middle @ (phi + h / 2 * k2)
        k4 = last @ (phi + h * k3)
        phi = phi + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    phi = np.where(np.isfinite(phi), phi, np.eye(size))
    values, vectors = np.linalg.eig(phi)
    lam = np.log(values) / HALF_TURN
    tau = HALF_TURN * np.arange(HARMONICS) / HARMONICS
    q = every @ vectors[:, None] * np.exp(-lam[:, None, None, :] * tau[:, None, None])
    rough = np.linalg.inv(np.where(np.isfinite(q), q, np.eye(size)))
    modes = np.fft.fft(rough, axis=1) / HARMONICS
    modes[:, HARMONICS // 2] = 0.0  # the highest has no sign
    return modes, lam, np.abs(values).max(axis=1)


def _holds(
    model: _Model,
    co: Coefficients,
    at: Ratios,
    a: Array,
    w: Complex,
    w_slope: Complex,
    q: Complex,
    lam: Complex,
    most_w: Array,
    most_slope: Array,
) -> NDArray[np.bool_]:
    """Whether the inequality holds on every piece of the turn, for each box."""
    size, joints = a.shape[-1], co.angle.shape[1]
    half = HALF_TURN / STEPS / 2
    gamma = -lam.real
    q_norm = np.linalg.norm(q, axis=(2, 3))
    defect = np.linalg.norm(w @ q - np.eye(size), axis=(2, 3))
    eps = half * most_slope[:, None] * q_norm + defect
    rest = w_slope + w @ a - lam[:, None, :, None] * w
    degree = HARMONICS // 2 + 3 * joints
    flat = np.prod(np.cos(np.abs(co.angle) + co.turned) ** 2, axis=1) ** (3 * joints)
    carried = _carried(a, lam, most_w, most_slope)
    rest_most = np.sqrt((np.abs(rest).max(axis=1) ** 2).sum(axis=(1, 2))) + SLACK * carried
    rest_most = rest_most / (np.cos(np.pi * degree / STEPS) * flat)
    first = np.zeros(w.shape[:2])
    bound = np.zeros(w.shape)
    change, change_slope = np.zeros(len(a)), np.zeros(len(a))
    for radius, matrix, most, steepest in model.first_order(at, co):
        t = w @ matrix @ q
        bound = bound + radius[:, None, None, None] * np.abs(t + t.conj().swapaxes(2, 3)) / 2
        first = first + radius[:, None] * np.linalg.norm(t, axis=(2, 3))
        change = change + radius * most
        change_slope = change_slope + radius * steepest
    further = half * (most_slope * change + most_w * change_slope)[:, None] * q_norm
    second = most_w[:, None] * model.second_order(at, co)[:, None] * q_norm
    rounding = SLACK * (1 + carried[:, None] * q_norm)
    near = eps < 0.5
    share = np.where(near, eps, 0.5)
    slack = further + (first + further) * share / (1 - share)
    slack = slack + (rest_most[:, None] * q_norm + second + rounding) / (1 - share)
    test = bound.real + slack[..., None, None] * np.eye(size) - gamma[:, None, :, None] * np.eye(size)
    good = np.isfinite(test).all(axis=(1, 2, 3)) & (gamma > 0).all(axis=1)
    top = np.linalg.eigvalsh(np.where(good[:, None, None, None], test, np.eye(size)))[..., -1].max(axis=1)
    return good & near.all(axis=1) & (top < -SLACK * (1 + gamma.max(axis=1)))


def _carried(a: Array, lam: Complex, most_w: Array, most_slope: Array) -> Array:
    """‖W′‖ + ‖W‖(‖A‖ + |Λ|) of each box, bounded everywhere: rounding errors are shares of it."""
    largest = np.linalg.norm(a, axis=(2, 3)).max(axis=1) + np.abs(lam).max(axis=1)
    return np.asarray(most_slope + most_w * largest)


@dataclass(frozen=True)
class _Model:
    """A(τ) of boxes in scaled coordinates (√J δ, √J δ′/ν), term by term."""

    near: tuple[int, ...]
    far: tuple[int, ...]
    k: Array
    c: Array
    scale: Array
    nu: Array

    @classmethod
    def of(cls, assembly: Assembly, co: Coefficients) -> _Model:
        topo = assembly.topology
        near = tuple(topo.coordinate[topo.group_of(e.near)] for e in topo.compliances)
        far = tuple(topo.coordinate[e.far_group] for e in topo.compliances)
        k, c = co.k * co.s[:, None] ** 2, co.c * co.s[:, None]
        nu = np.sqrt((k * co.g[:, list(far)]).sum(axis=1) / topo.size)
        return cls(near, far, k, c, np.sqrt(co.g), nu)

    @property
    def size(self) -> int:
        return self.scale.shape[1]

    def _lower(self, left: Array, right: Array) -> Array:
        """A from its lower blocks −K/ν and −C (…, n, n); the upper right one stands only in ``matrix``."""
        n = self.size
        out = np.zeros((*left.shape[:-2], 2 * n, 2 * n))
        nu = self.nu.reshape(-1, *[1] * (left.ndim - 1))
        out[..., n:, :n], out[..., n:, n:] = -left / nu, -right
        return out

    def terms(self, b: Array, slope: Array) -> list[tuple[Array, Array, Array]]:
        """For each compliance: its k-part of K, its c-part of K and its part of C (boxes, times, n, n), scaled."""
        found = []
        for e, (p, i) in enumerate(zip(self.near, self.far, strict=True)):
            u, v = (np.zeros((*b.shape[:2], self.size)) for _ in range(2))
            u[..., i] = self.scale[:, None, i]
            if p >= 0:
                u[..., p] = -b[..., e] * self.scale[:, None, p]
                v[..., p] = -slope[..., e] * self.scale[:, None, p]
            k, c = self.k[:, None, e, None, None], self.c[:, None, e, None, None]
            straight = u[..., :, None] * u[..., None, :]
            found.append((k * straight, c * u[..., :, None] * v[..., None, :], c * straight))
        return found

    def matrix(self, b: Array, slope: Array) -> Array:
        """A (boxes, times, 2n, 2n)."""
        parts = self.terms(b, slope)
        left = np.sum([k + d for k, d, _ in parts], axis=0)
        out = self._lower(left, np.sum([c for _, _, c in parts], axis=0))
        n = self.size
        out[..., :n, n:] = self.nu[:, None, None, None] * np.eye(n)
        return out

    def first_order(self, at: Ratios, co: Coefficients):  # type: ignore[no-untyped-def]
        """For each variable: relative half-width (boxes,), dA (boxes, times, 2n, 2n) per relative change, and bounds
        (boxes,) on its norm and the norm of its derivative by τ, everywhere."""
        parts, most, steep = self.terms(at.b, at.slope), self._most(at), self._steepest(at)
        zero = np.zeros_like(parts[0][0])
        for e, (k, d, c) in enumerate(parts):
            if co.dk[:, e].any():
                yield co.dk[:, e], self._lower(k, zero), self._norm(most[e][0], 0), self._norm(steep[e][0], 0)
            if co.dc[:, e].any():
                yield co.dc[:, e], self._lower(d, c), *(self._norm(x[e][1], x[e][2]) for x in (most, steep))
        left, right = np.sum([k + d for k, d, _ in parts], axis=0), np.sum([c for _, _, c in parts], axis=0)
        whole = [
            (sum(x[e][0] + x[e][1] for e in range(len(parts))), sum(x[e][2] for e in range(len(parts))))
            for x in (most, steep)
        ]
        for i in range(self.size):
            if co.dg[:, i].any():
                row = np.zeros((self.size, 1))
                row[i] = 1.0
                yield (
                    co.dg[:, i],
                    self._lower(left * row, right * row),
                    *(self._norm(k * row, c * row) for k, c in whole),
                )
        if co.ds.any():
            twice = np.sum([2 * k + d for k, d, _ in parts], axis=0)
            bounds = (
                self._norm(
                    sum(2 * x[e][0] + x[e][1] for e in range(len(parts))), sum(x[e][2] for e in range(len(parts)))
                )
                for x in (most, steep)
            )
            yield co.ds, self._lower(twice, right), *bounds

    def second_order(self, at: Ratios, co: Coefficients) -> Array:
        """Bound (boxes,) on the norm of what first-order terms leave out, angles included."""
        total_k, total_c = (np.zeros((len(co.s), self.size, self.size)) for _ in range(2))
        y, z = co.dg[:, :, None], co.ds[:, None, None]
        turned = self._turned(at)
        for e, ((k, d, c), moved) in enumerate(zip(self._most(at), turned, strict=True)):
            x, w = co.dk[:, e, None, None], co.dc[:, e, None, None]
            square = (1 + x) * (1 + y) * (1 + z) ** 2
            single = (1 + w) * (1 + y) * (1 + z)
            total_k += k * (square - 1 - x - y - 2 * z) + d * (single - 1 - w - y - z) + moved[0] * square
            total_k += moved[1] * single
            total_c += c * (single - 1 - w - y - z) + moved[2] * single
        return self._norm(total_k, total_c) * (1 + 1e-9) + 1e-14

    def _norm(self, left: Array | float, right: Array | float) -> Array:
        """Frobenius norm (boxes,) of lower blocks bounded entry by entry."""
        nu = self.nu[:, None, None]
        zero = np.zeros((len(self.nu), self.size, self.size))
        return np.asarray(np.sqrt((((zero + left) / nu) ** 2 + (zero + right) ** 2).sum(axis=(1, 2))))

    def _entries(self, same: Array, cross: Array, far: float) -> list[Array]:
        """For each compliance (boxes, n, n) with given entries at (p, p), (p, i) and (i, p), and (i, i), scaled."""
        found = []
        for e, (p, i) in enumerate(zip(self.near, self.far, strict=True)):
            out = np.zeros((len(self.nu), self.size, self.size))
            out[:, i, i] = far * self.scale[:, i] ** 2
            if p >= 0:
                out[:, p, p] = same[:, e] * self.scale[:, p] ** 2
                out[:, p, i] = out[:, i, p] = cross[:, e] * self.scale[:, p] * self.scale[:, i]
            found.append(out)
        return found

    def _three(self, straight: list[Array], mixed: list[Array]) -> list[tuple[Array, Array, Array]]:
        k, c = self.k[:, :, None, None], self.c[:, :, None, None]
        return [(k[:, e] * s, c[:, e] * m, c[:, e] * s) for e, (s, m) in enumerate(zip(straight, mixed, strict=True))]

    def _most(self, at: Ratios) -> list[tuple[Array, Array, Array]]:
        """Bounds on ``terms`` everywhere."""
        return self._three(
            self._entries(at.most**2, at.most, 1.0), self._entries(at.most * at.most_slope, at.most_slope, 0.0)
        )

    def _steepest(self, at: Ratios) -> list[tuple[Array, Array, Array]]:
        """Bounds on their derivatives by τ."""
        return self._three(
            self._entries(2 * at.most * at.most_slope, at.most_slope, 0.0),
            self._entries(at.most_slope**2 + at.most * at.most_bend, at.most_bend, 0.0),
        )

    def _turned(self, at: Ratios) -> list[tuple[Array, Array, Array]]:
        """Bounds on how far they move with joint angles."""
        m, m1 = at.moved, at.slope_moved
        return self._three(
            self._entries(2 * at.most * m + m**2, m, 0.0),
            self._entries(at.most * m1 + at.most_slope * m + m * m1, m1, 0.0),
        )
