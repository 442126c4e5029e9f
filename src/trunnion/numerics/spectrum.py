"""Multipliers of a monodromy matrix and how far they may be off.

If Z is known to within ε (2-norm), the characteristic polynomial at a computed multiplier σ_i moves by at
most ε‖adj(σ_i I − Z)‖ = ε κ_i Π_{j≠i}|σ_i − σ_j|, κ_i the condition number of σ_i. A simple multiplier then
moves by ε κ_i, two that nearly collide by the square root of a finite number, and so on; with the other
multipliers sorted by distance d₁ ≤ d₂ ≤ …,

    |δσ_i| ≤ 2 min_k (ε κ_i d₁ d₂ … d_{k−1})^{1/k},

which is exact to a factor 2 for one or two close multipliers and stays finite where they collide.
"""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array, Complex, Flags


def multipliers(matrix: Array, error: Array) -> tuple[Complex, Array]:
    """Eigenvalues of ``matrix`` (…, m, m) and a bound on the error of each (…, m).

    ``error`` (…) bounds the error of the matrix in the 2-norm; the backward error of the eigenvalue solver
    is added. NaN matrices give NaN.
    """
    matrix = np.asarray(matrix, dtype=float)
    failed = np.asarray(~np.isfinite(matrix).all(axis=(-2, -1)))
    if failed.any():
        matrix = np.where(failed[..., None, None], np.eye(matrix.shape[-1]), matrix)
    values, vectors = np.linalg.eig(matrix)
    values, vectors = values.astype(complex), vectors.astype(complex)
    rounding = 1e-15 * np.linalg.norm(matrix, axis=(-2, -1))
    condition = _conditions(vectors)
    bound = bounds_of(values, condition, np.asarray(error) + rounding)
    values[failed], bound[failed] = np.nan, np.nan
    return values, bound


def bounds_of(values: Complex, condition: Array, error: Array | float) -> Array:
    """Bounds (…, m) on how far eigenvalues of condition numbers ``condition`` (…, m) may be off, of matrices that are
    known to ``error`` (…)."""
    uncertain = np.asarray(error)[..., None]
    moved = uncertain * condition
    distance = np.sort(np.abs(values[..., :, None] - values[..., None, :]), axis=-1)[..., 1:]
    # Multipliers closer than the error of Z are not known to be apart.
    distance = np.maximum(distance, uncertain[..., None])
    bound = moved.copy()
    product = moved.copy()
    for k in range(2, values.shape[-1] + 1):
        if not (distance[..., k - 2] < bound).any():  # a mean that grows with every distance from here on
            break
        product = product * distance[..., k - 2]
        bound = np.minimum(bound, product ** (1 / k))
    return np.asarray(2 * bound)


def without(matrix: Array, vectors: Array) -> tuple[Array, Array]:
    """What is left of ``matrix`` (m, m) when an invariant subspace spanned by ``vectors`` (m, k) is set aside.

    The eigenvalues of the first result (m − k, m − k) are the others, each known as well as ``matrix`` is: no choice
    among computed eigenvalues is made, which collide where the subspace's own does. The second (m, m − k) is the
    orthonormal basis in which it stands.
    """
    rest = np.linalg.qr(vectors, mode="complete")[0][:, vectors.shape[1] :]
    return np.asarray(rest.T @ matrix @ rest), np.asarray(rest)


def along(matrix: Array, direction: Array, grows: bool | None = None) -> int:
    """Which eigenvalue of ``matrix``, in the order of ``multipliers``, has the eigenvector nearest to ``direction``.

    The direction is that of a slow change without oscillation: eigenvalues that are real and positive go before others,
    of these those beyond 1 where it is known that the change ``grows``, those within where it does not.
    """
    values, vectors = np.linalg.eig(matrix)
    near = np.abs(direction @ vectors) / np.linalg.norm(vectors, axis=0)
    steady = real_positive(values.astype(complex))
    if grows is not None and (right := steady & ((values.real > 1) == grows)).any():
        steady = right
    return int(np.argmax(np.where(steady | ~steady.any(), near, -1.0)))


def real_positive(values: Complex) -> Flags:
    """Which eigenvalues belong to what neither oscillates nor changes its sign."""
    return np.asarray((np.abs(values.imag) <= 1e-12 * np.abs(values)) & (values.real > 0))


def spectral_radius(values: Complex, bound: Array) -> tuple[Array, Array]:
    """ρ = max |σ| and the bound on its error, from multipliers and their bounds."""
    size = np.abs(values)
    radius = size.max(-1)
    upper = (size + bound).max(-1)
    own = np.take_along_axis(bound, size.argmax(-1)[..., None], -1)[..., 0]
    return radius, np.maximum(upper - radius, own)


def _conditions(vectors: Complex) -> Array:
    """κ_i = ‖right‖‖left‖/|left·right| of each eigenvalue; very large, not infinite, at a collision."""
    try:
        inverse = np.linalg.inv(vectors)
    except np.linalg.LinAlgError:
        inverse = np.linalg.pinv(vectors, rcond=1e-300)
    condition = np.linalg.norm(vectors, axis=-2) * np.linalg.norm(inverse, axis=-1)
    # Rounding alone parts an exact collision by about 1e-8, so no condition number is known beyond 1e10.
    return np.asarray(np.where(np.isfinite(condition), np.clip(condition, 1.0, 1e10), 1e10))
