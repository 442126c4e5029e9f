"""A Floquet form W(τ) of lines at the middle of boxes: W′ + WA ≈ ΛW with a constant Λ of small blocks.

Away from resonances Λ is diagonal. Where multipliers come near to each other the modes turn towards each other and a
diagonal form would be badly scaled: such modes stand together in a block, in a basis that is orthonormal in energy and
then scaled so that the Hermitian part of the block is negative definite wherever the block is stable (Lyapunov's
equation). How W was found does not matter to a proof: it is the trigonometric polynomial that its harmonics define.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_continuous_lyapunov

from trunnion.arrays import Array, Complex, Flags

STEPS = 512
"""Steps of the integration over half a turn, and samples of what is bounded."""
HARMONICS = 128
"""Samples that W is made of: half as many harmonics of 2τ on either side."""
ORDERS = np.round(np.fft.fftfreq(HARMONICS) * HARMONICS).astype(int)
"""k of the e^{2ikτ}, in the order of a transform."""
HALF_TURN = np.pi
NEAR = 0.1
"""Exponents per radian closer than this, but for whole turns, share a block."""


@dataclass(frozen=True)
class FloquetForm:
    """For boxes: W, W′ and the computed inverse Q of W at the samples (boxes, STEPS, 2n, 2n), Λ (boxes, 2n, 2n), its
    exponents (boxes, 2n) in the basis X of its eigenvectors (boxes, 2n, 2n), which of its entries belong to blocks,
    the largest multiplier, and bounds on ‖W‖, ‖W′‖ and ‖W″‖ everywhere."""

    w: Complex
    slope: Complex
    q: Complex
    lam: Complex
    exponents: Complex
    basis: Complex
    blocks: Flags
    radius: Array
    most: Array
    most_slope: Array
    most_bend: Array


def floquet_form(a: Array, energy: Array) -> FloquetForm:
    """From A (boxes, 2 STEPS, 2n, 2n) over half a turn, and the metric (boxes, 2n, 2n) in which bases are scaled."""
    with np.errstate(all="ignore"):
        modes, lam, exponents, basis, blocks, radius = harmonics(a, energy)
        w, slope = sampled(modes)
        q = _inverse(w).astype(complex)
    each = np.linalg.norm(modes, axis=(2, 3))
    most, most_slope, most_bend = (((2 * np.abs(ORDERS)) ** k * each).sum(axis=1) for k in range(3))
    return FloquetForm(
        w=w, slope=slope, q=q, lam=lam, exponents=exponents, basis=basis, blocks=blocks, radius=radius, most=most,
        most_slope=most_slope, most_bend=most_bend,
    )  # fmt: skip


def sampled(harmonic: Complex) -> tuple[Complex, Complex]:
    """Values and derivatives by τ at STEPS samples of Σ c_k e^{2ikτ}, c (boxes, HARMONICS, …) as of a transform."""
    found = []
    for factor in (np.ones(HARMONICS), 2j * ORDERS):
        padded = np.zeros((len(harmonic), STEPS, *harmonic.shape[2:]), dtype=complex)
        padded[:, ORDERS % STEPS] = harmonic * factor.reshape(-1, *[1] * (harmonic.ndim - 2))
        found.append(np.fft.ifft(padded, axis=1) * STEPS)
    return found[0], found[1]


def harmonics(a: Array, energy: Array) -> tuple[Complex, Complex, Complex, Complex, Flags, Array]:
    """Coefficients of W at e^{2ikτ} (boxes, harmonics, 2n, 2n), which define it; Λ, its exponents, its eigenvectors,
    its blocks, and the largest multiplier."""
    boxes, _, size, _ = a.shape
    every, phi = _integrated(a)
    phi = np.where(np.isfinite(phi), phi, np.eye(size))
    values, vectors = (part.astype(complex) for part in np.linalg.eig(phi))
    exponents, back, blocks = _grouped(values, vectors, energy)
    lam = _inverse(back) @ (exponents[..., None] * back)
    tau = HALF_TURN * np.arange(HARMONICS) / HARMONICS
    q = every @ vectors[:, None] * np.exp(-exponents[:, None, None, :] * tau[:, None, None])
    rough = _inverse(back)[:, None] @ _inverse(q)
    modes: Complex = np.fft.fft(rough, axis=1) / HARMONICS
    modes[:, HARMONICS // 2] = 0.0  # the highest has no sign
    return modes, lam, exponents, back, blocks, np.abs(values).max(axis=1)


def _inverse(matrix: NDArray[Any]) -> NDArray[Any]:
    """Inverses (…, m, m); the identity where there is none, as where a stiff line's motion leaves the numbers' range: W
    may be anything, and what it proves is bounded with it."""
    finite = np.isfinite(matrix).all(axis=(-2, -1), keepdims=True)
    tame = np.where(finite, matrix, np.eye(matrix.shape[-1]))
    try:
        return np.asarray(np.linalg.inv(tame))
    except np.linalg.LinAlgError:
        regular = (np.linalg.cond(tame) < 1 / np.finfo(float).eps)[..., None, None]
        return np.asarray(np.linalg.inv(np.where(regular, tame, np.eye(matrix.shape[-1]))))


def _integrated(a: Array) -> tuple[Array, Array]:
    """Φ at HARMONICS places (boxes, places, 2n, 2n), and after half a turn; two steps and a double one extrapolated."""
    boxes, _, size, _ = a.shape
    h = HALF_TURN / STEPS
    phi = np.broadcast_to(np.eye(size), (boxes, size, size)).copy()
    every = np.empty((boxes, HARMONICS, size, size))
    for step in range(0, STEPS, 2):
        if step % (STEPS // HARMONICS) == 0:
            every[:, step // (STEPS // HARMONICS)] = phi
        first, a1, middle, a3, last = (a[:, (2 * step + k) % (2 * STEPS)] for k in range(5))
        fine = _step(middle, a3, last, h, _step(first, a1, middle, h, phi))
        coarse = _step(first, middle, last, 2 * h, phi)
        phi = fine + (fine - coarse) / 15
    return every, phi


def _step(first: Array, middle: Array, last: Array, h: float, phi: Array) -> Array:
    """One step of the classical method of order 4."""
    k1 = first @ phi
    k2 = middle @ (phi + h / 2 * k1)
    k3 = middle @ (phi + h / 2 * k2)
    return np.asarray(phi + h / 6 * (k1 + 2 * k2 + 2 * k3 + last @ (phi + h * k3)))


def _grouped(values: Complex, vectors: Complex, energy: Array) -> tuple[Complex, Complex, Flags]:
    """Exponents (boxes, 2n), of one branch within a block; the matrix X that takes coordinates of the chosen basis to
    those of the eigenvectors; and the entries that belong to blocks."""
    size = values.shape[1]
    exponents: Complex = np.asarray(np.log(values) / HALF_TURN, dtype=np.complex128)
    back: Complex = np.zeros_like(vectors)
    apart = np.log(values[:, None, :] / values[:, :, None]) / HALF_TURN
    blocks = np.abs(apart) < NEAR
    for _ in range(2):  # neighbours of neighbours: up to six multipliers
        blocks = (blocks.astype(int) @ blocks.astype(int)) > 0
    root = np.linalg.cholesky(energy).swapaxes(1, 2)
    length: Array = np.linalg.norm(root @ vectors, axis=1)
    back[:, range(size), range(size)] = 1 / length
    for box in np.flatnonzero(blocks.sum(axis=(1, 2)) > size):
        for first in range(size):
            members = np.flatnonzero(blocks[box, first])
            if len(members) == 1 or members[0] != first:
                continue
            exponents[box, members] = exponents[box, first] + apart[box, first, members]
            at = np.ix_(members, members)
            back[box][at] = _scaled(root[box] @ vectors[box][:, members], exponents[box, members])
    return exponents, back, blocks


def _scaled(vectors: Complex, exponents: Complex) -> Complex:
    """Coordinates of eigenvectors in a basis of their span in which a stable block falls in norm."""
    upper = np.linalg.qr(vectors)[1]
    if not np.isfinite(upper).all() or np.linalg.cond(upper) > 1e7 or exponents.real.max() >= 0:
        return np.diag(1 / np.linalg.norm(vectors, axis=0)).astype(complex)
    block = upper @ np.diag(exponents) @ np.linalg.inv(upper)
    energy = solve_continuous_lyapunov(block.conj().T, -np.eye(len(block)))
    energy = (energy + energy.conj().T) / 2
    energy *= len(block) / np.trace(energy).real
    root = np.linalg.cholesky(energy).conj().T
    return np.asarray(np.linalg.inv(root @ upper))
