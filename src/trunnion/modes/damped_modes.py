"""Complex modes of an aligned line, and which of them belongs to which undamped mode.

    (λ²M + λC + K + iH) v = 0        λ = −ζ|λ| + iω_d

H, the damping that all frequencies share alike, acts with the sign of the frequency: on motion that does not oscillate
it does not act at all. All matrices here are those of unit masses, M^(−½) C M^(−½) and so on. Modes belong together by
the modal assurance criterion MAC(u, v) = |u*v|²/((u*u)(v*v)), which weighs rotations with the inertias.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex, Places

RIGID = 1e-6
"""Share of the highest frequency below which a mode counts as rigid rotation, or an eigenvalue as real."""
UNTOUCHED = 1e-12
"""Share of the damping below which it does not brake the rotation of the whole line."""


@dataclass(frozen=True)
class LineModes:
    """Both eigenvalues (mode, 2) [1/s] of every undamped mode and the complex shapes (n, mode) of those that oscillate.

    Modes stand in the order of ``undamped`` (mode,) [rad/s], what no spring resists first: the rotation of a free line
    as a whole, other rigid motions, then what oil alone drags along. A mode that oscillates has λ and its conjugate, an
    overdamped one two real eigenvalues, the slower first. Shapes, in coordinates scaled with √M, are NaN where a mode
    does not oscillate.
    """

    undamped: Array
    eigenvalue: Complex
    shape: Complex


def line_modes(damping: Array, stiffness: Array, loss: Array, loose: Array, rigid: int) -> LineModes:
    """Modes of a line of unit masses.

    ``loose`` (n, k): rotations that no spring resists; the first ``rigid`` of them twist nothing, that of the whole
    line first.
    """
    still = loose.shape[1]
    if not still:
        squares, basis = np.linalg.eigh(stiffness)
    else:  # taken out of the matrices, whose double eigenvalue 0 rounding would part
        first, rest = np.split(np.linalg.qr(loose, mode="complete")[0], [still], axis=1)
        squares, own = np.linalg.eigh(rest.T @ stiffness @ rest)
        squares, basis = np.append(np.zeros(still), squares), np.column_stack([first, rest @ own])
    undamped = np.sqrt(np.maximum(squares, 0.0))
    pairs = 1j * undamped[:, None] * np.array([1.0, -1.0])
    shapes = basis.astype(complex)
    if damping.any() or loss.any():
        start = 0
        while start < rigid and not _brakes(damping, basis[:, start]):
            start += 1
        kept = basis[:, start:]
        pairs[start:], own = _pairs(
            kept.T @ damping @ kept, np.diag(squares[start:]), kept.T @ loss @ kept, RIGID * float(undamped.max()),
            np.delete(np.arange(len(squares) - start), np.arange(rigid, still) - start),
        )  # fmt: skip
        shapes[:, start:] = kept @ own
    pairs[:still, 0] = 0.0  # where it stands matters to nothing
    shapes[:, pairs[:, 0].imag == 0] = np.nan
    return LineModes(undamped, pairs, shapes)


def _brakes(damping: Array, rotation: Array) -> bool:
    """Whether the rotation of the whole line dies out, for it is braked against the ground."""
    return bool(np.abs(damping @ rotation).max() > UNTOUCHED * np.abs(damping).max())


def _pairs(damping: Array, stiffness: Array, loss: Array, least: float, able: Places) -> tuple[Complex, Complex]:
    """Eigenvalues (mode, 2) and shapes (n, mode) in coordinates of the undamped modes, ``able`` to oscillate."""
    n = len(damping)
    pairs, shapes = np.full((n, 2), complex(np.nan)), np.full((n, n), complex(np.nan))
    values, vectors = damped_modes(damping, stiffness + 1j * loss if loss.any() else stiffness, least)
    here, there = matched(np.eye(n, dtype=complex)[:, able], vectors)
    here = able[here]
    pairs[here, 0], pairs[here, 1] = values[there], values[there].conj()
    shapes[:, here] = vectors[:, there]
    still = np.setdiff1d(np.arange(n), here)
    if len(still):
        values, vectors = _eigenvalues(damping, stiffness)
        real = np.flatnonzero(np.abs(values.imag) <= least)
        twice = np.repeat(still, 2)
        rows, columns = _by_largest_sum(_shared(np.eye(n, dtype=complex)[:, twice], vectors[:, real]))
        pairs[twice[rows], rows % 2] = values[real[columns]].real
        pairs[still] = np.take_along_axis(pairs[still], np.abs(pairs[still]).argsort(axis=1), axis=1)
    return pairs, shapes


@dataclass(frozen=True)
class Lagging:
    """Parts of the damping that lag: at λ each is slope/(1 + λ/corner) on the speed of its station.

    turning (part, n) as of the matrices that it belongs to, slope (part,) [N m s/rad] and corner (part,) [rad/s].
    """

    turning: Array
    slope: Array
    corner: Array


def damped_modes(
    damping: Array, stiffness: Array | Complex, least: float, lagging: Lagging | None = None
) -> tuple[Complex, Complex]:
    """Eigenvalues of λ² + λC + K with an imaginary part above ``least`` [rad/s], by modulus; their shapes (n, values).

    C and K stand for unit masses; C has the slopes of what is ``lagging``, as if it did not. The pair at 0 of a line
    that turns freely, which rounding parts by the root of its own size, is not an oscillation: ``least`` keeps it out.
    """
    values, vectors = _eigenvalues(damping, stiffness, lagging)
    above = np.flatnonzero(values.imag > least)
    above = above[np.argsort(np.abs(values[above]))]
    return values[above], vectors[:, above]


def with_lags(damping: Array, stiffness: Array | Complex, lagging: Lagging | None) -> Array | Complex:
    """A of x′ = A x with the states y, dy/dt and the torque T of each lagging part, dT/dt = corner (slope u·dy/dt − T).

    C, K and u of unit masses.
    """
    n = len(damping)
    if lagging is None:
        return np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness, -damping]])
    turning, at_once = lagging.turning, (lagging.turning.T * lagging.slope) @ lagging.turning
    follows = (lagging.corner * lagging.slope)[:, None] * turning
    none = np.zeros((n, len(turning)))
    return np.block(
        [
            [np.zeros((n, n)), np.eye(n), none],
            [-stiffness, at_once - damping, -turning.T],
            [none.T, follows, -np.diag(lagging.corner)],
        ]
    )


def _eigenvalues(damping: Array, stiffness: Array | Complex, lagging: Lagging | None = None) -> tuple[Complex, Complex]:
    values, vectors = np.linalg.eig(with_lags(damping, stiffness, lagging))
    return values.astype(complex), vectors[: len(damping)].astype(complex)


def matched(before: Complex, after: Complex) -> tuple[Places, Places]:
    """Which columns belong together, by the largest sum of MAC; vectors in coordinates scaled with √M."""
    share = _shared(before, after)
    if not share.size:  # nothing oscillates
        return np.arange(0), np.arange(0)
    best = share.argmax(axis=1)
    if share.shape[0] <= share.shape[1] and len(set(best.tolist())) == len(best):
        return np.arange(len(best)), best  # each its own: no sum is larger
    return _by_largest_sum(share)


def _shared(before: Complex, after: Complex) -> Array:
    """MAC of every column with every other."""
    share = np.abs(before.conj().T @ after) ** 2
    norms = (np.abs(before) ** 2).sum(axis=0)[:, None] * (np.abs(after) ** 2).sum(axis=0)
    return np.asarray(share / np.maximum(norms, 1e-300))


def _by_largest_sum(share: Array) -> tuple[Places, Places]:
    from scipy.optimize import linear_sum_assignment

    return linear_sum_assignment(-share)  # type: ignore[no-any-return]
