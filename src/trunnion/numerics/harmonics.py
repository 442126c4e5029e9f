"""Fourier series of a period in real form: rows of mean, cosines 1…H, sines 1…H.

    x(t) = a₀ + Σ_k (a_k cos kωt + b_k sin kωt)

A *row* has 2H + 1 numbers in that order; a motion of n states is an array (n, 2H + 1).
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from trunnion.arrays import Array, Complex, Integers


def order(row: Array) -> int:
    """H of a row or of an array of rows."""
    return (row.shape[-1] - 1) // 2


def samples(rows: Array, count: int) -> Array:
    """Values at ``count`` equidistant times of the period, from t = 0; shape (…, count), count > 2H."""
    h = order(rows)
    spectrum = np.zeros((*rows.shape[:-1], count // 2 + 1), dtype=complex)
    spectrum[..., 0] = rows[..., 0] * count
    spectrum[..., 1 : h + 1] = (rows[..., 1 : h + 1] - 1j * rows[..., h + 1 :]) * (count / 2)
    return np.asarray(np.fft.irfft(spectrum, count))


def at(rows: Array, phases: Array) -> Array:
    """Values (…, phases) at any phases ωt [rad]."""
    h = order(rows)
    # Powers of e^{iφ} by multiplication cost a quarter of sines and cosines; their rounding grows as h only.
    turns = np.multiply.accumulate(np.exp(1j * phases)[None].repeat(h, axis=0))
    waves = (rows[..., 1 : h + 1] - 1j * rows[..., h + 1 :]) @ turns
    return np.asarray(rows[..., :1] + waves.real)


def cuts(h: int) -> Array:
    """Phases of a period [rad] between which a series of h harmonics makes no more than half a swing."""
    return 2 * np.pi * np.arange(max(2 * h, 16) + 1) / max(2 * h, 16)


def rows_of(values: Array, h: int) -> Array:
    """The first ``h`` harmonics of equidistant samples (…, count)."""
    count = values.shape[-1]
    spectrum = np.fft.rfft(values)[..., : h + 1] / count
    return np.concatenate([spectrum[..., :1].real, 2 * spectrum[..., 1:].real, -2 * spectrum[..., 1:].imag], axis=-1)


def resized(rows: Array, h: int) -> Array:
    """The same motion with ``h`` harmonics: the rest dropped, or zeros behind."""
    old = order(rows)
    kept = min(old, h)
    out = np.zeros((*rows.shape[:-1], 2 * h + 1))
    out[..., : kept + 1] = rows[..., : kept + 1]
    out[..., h + 1 : h + 1 + kept] = rows[..., old + 1 : old + 1 + kept]
    return out


def rate(rows: Array, omega: float) -> Array:
    """Rows of dx/dt."""
    h = order(rows)
    k = omega * np.arange(1, h + 1)
    return np.concatenate([np.zeros_like(rows[..., :1]), k * rows[..., h + 1 :], -k * rows[..., 1 : h + 1]], axis=-1)


def add_rate(to: Array, rows: Array) -> None:
    """Add to ``to`` the products of matrices ``rows`` (…, 2h + 1) with ``rate_matrix`` from the right, which is minus
    its transpose."""
    h = order(rows)
    k = np.arange(1.0, h + 1)
    to[..., 1 : h + 1] += k * rows[..., h + 1 :]
    to[..., h + 1 :] -= k * rows[..., 1 : h + 1]


def rate_matrix(h: int, omega: float) -> Array:
    """The matrix that does the same to one row."""
    return np.ascontiguousarray(rate(np.eye(2 * h + 1), omega).T)


def product_matrix(values: Array, h: int) -> Array:
    """The matrix (…, 2h + 1, 2h + 1) that multiplies a row by g(t), given by samples (…, count ≥ 4h + 1).

    With ĝ_m the complex coefficients of g, the product's are Σ_l ĝ_{k−l} x_l: a Toeplitz matrix of ĝ_{k−l} and,
    since the coefficients at −l are conjugates, a Hankel one of ĝ_{k+l}.
    """
    return product_matrix_of(np.fft.rfft(values)[..., : 2 * h + 1] / values.shape[-1], h)


def product_matrix_of(spectrum: Complex, h: int) -> Array:
    """The same from ĝ_m, m = 0 … 2h, shape (…, 2h + 1)."""
    # ĝ_m, m = −h … 2h: views of it with steps of one number are both matrices, and nothing is gathered.
    wide = np.concatenate([spectrum[..., h:0:-1].conj(), spectrum], axis=-1)
    real, imag = (np.ascontiguousarray(part) for part in (wide.real, wide.imag))
    out = np.empty((*spectrum.shape[:-1], 2 * h + 1, 2 * h + 1))
    toeplitz, hankel = _windows(real, h)
    np.add(toeplitz, hankel, out=out[..., : h + 1, : h + 1])
    np.subtract(toeplitz[..., 1:, 1:], hankel[..., 1:, 1:], out=out[..., h + 1 :, h + 1 :])
    toeplitz, hankel = _windows(imag, h)
    np.subtract(toeplitz[..., :, 1:], hankel[..., :, 1:], out=out[..., : h + 1, h + 1 :])
    np.add(toeplitz[..., 1:, :], hankel[..., 1:, :], out=out[..., h + 1 :, : h + 1])
    np.negative(out[..., h + 1 :, : h + 1], out=out[..., h + 1 :, : h + 1])
    out[..., 0, :] /= 2  # a mean is its coefficient, an amplitude twice that
    return out


def _windows(wide: Array, h: int) -> tuple[Array, Array]:
    """Of numbers of m = −h … 2h (…, 3h + 1) those of k − l and of k + l, for k, l = 0 … h."""
    windows = np.lib.stride_tricks.sliding_window_view(wide, h + 1, axis=-1)
    return windows[..., : h + 1, ::-1], windows[..., h:, :]


def product_blocks(values: Array, h: int) -> Array:
    """The matrix (…, n, 2h + 1, m, 2h + 1) that multiplies m rows by a matrix of functions G(t), given by samples
    (…, count, n, m); 0 where G is."""
    *many, count, n, m = values.shape
    out = np.zeros((*many, n, 2 * h + 1, m, 2 * h + 1))
    of, by = np.nonzero(values.reshape(-1, n, m).any(axis=0))
    waves = np.ascontiguousarray(np.moveaxis(values[..., of, by], -1, 0))
    out[..., of, :, by, :] = product_matrix(waves, h)
    return out


def hill_blocks(
    harmonics: Integers, parts: Sequence[Complex], places: Integers | None = None
) -> list[tuple[Integers, Integers, Complex]]:
    """Parts of the matrices of each P in P₀ x + P₁ ẋ + P₂ ẍ … for x = Σ X_h exp(s_h t): blocks P_p,h−l.

    Each (row, column, values), X in the order (h, n), values (p, case, …) of the places (…,). ``parts`` (case, count,
    n, n): Fourier coefficients of each P, as an FFT orders them. ``places`` (…,) of that order that are not 0; by
    default all.
    """
    count, n = parts[0].shape[1:3]
    apart = harmonics[:, None] - harmonics[None, :]
    # What is further apart than half the samples is not known from them.
    place = np.where(2 * np.abs(apart) < count, apart % count, -1)
    own = np.arange(n)
    found = []
    for d in np.intersect1d(place[place >= 0], np.arange(count) if places is None else places):
        rows, columns = np.nonzero(place == d)
        # Where no P has a number none is kept.
        far, near = np.nonzero(np.any([part[:, d].any(axis=0) for part in parts], axis=0))
        row, column = rows[:, None] * n + own[far], columns[:, None] * n + own[near]
        values = np.stack([part[:, d, far, near] for part in parts])[:, :, None]
        found.append((row, column, np.broadcast_to(values, (*values.shape[:2], *row.shape))))
    return found


def hill_matrices(s: Any, harmonics: Integers, parts: Sequence[Complex]) -> list[tuple[Integers, Integers, Complex]]:
    """Parts of the matrices of P₀ x + P₁ ẋ + P₂ ẍ …, as ``hill_blocks`` has them: Σ_p s_l^p P_p,h−l, as
    ``SparseMatrices.added`` takes them; s (case, h) [1/s] of the ``harmonics`` (h,)."""
    n = parts[0].shape[2]
    return [
        (row, column, np.asarray(sum(s[:, column // n] ** p * one for p, one in enumerate(values))))
        for row, column, values in hill_blocks(harmonics, parts)
    ]


def solved(matrix: Any, right: Any) -> Any:
    """Solutions (case, m) or (case, m, k) of matrices (case, m, m), real or complex; NaN where one is singular or not
    finite."""
    columns = right.reshape(*matrix.shape[:2], -1)
    finite = np.isfinite(matrix).all(axis=(1, 2)) & np.isfinite(columns).all(axis=(1, 2))
    out = np.full(columns.shape, np.nan, dtype=right.dtype)
    some: Any = slice(None) if finite.all() else finite
    try:
        out[some] = np.linalg.solve(matrix[some], columns[some])
    except np.linalg.LinAlgError:
        for i in np.flatnonzero(finite):
            with suppress(np.linalg.LinAlgError):
                out[i] = np.linalg.solve(matrix[i], columns[i])
    return out.reshape(right.shape)


def spectrum_of_steps(ends: Array, values: Array, highest: int) -> Complex:
    """Complex coefficients 0 … ``highest`` of a function of phase that is constant between ``ends``.

    ends (pieces + 1,): rising phases [rad], the last 2π after the first; values (…, pieces).
    """
    m = np.arange(1, highest + 1)[:, None]
    turns = np.exp(-1j * m * ends)
    parts = np.concatenate([np.diff(ends)[None], (turns[:, :-1] - turns[:, 1:]) / (1j * m)]) / (2 * np.pi)
    return np.asarray(values @ parts.T)


def doubled(fewest: int, most: int) -> list[int]:
    """Numbers of harmonics to try one after the other: doubled from ``fewest``, ``most`` the last."""
    found = [fewest]
    while found[-1] < most:
        found.append(min(2 * found[-1], most))
    return found
