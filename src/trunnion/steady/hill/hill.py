"""Steady response of a line with periodic equations by Hill's blocks.

Re[e^{iω₀t} Σ_h X_h e^{ihbΩt}] under Re[e^{iω₀t} Σ_h G_h e^{ihbΩt}], with b = 2π/period of the equations in the input
angle, ν_h = ω₀ + hbΩ, and M_k … the Fourier coefficients of the matrices:

    Σ_l [−ν_l² M_{h−l} + iν_l C_{h−l} + K_{h−l}] X_l + Σ_e R_e* (i loss_e sgn ν) R_e X = G_h.

Damping whatever the frequency acts on each spring's own harmonics (R_e turns X into the twist of spring e): negative
sidebands turn its sign, which equations in time cannot do.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from trunnion.arrays import Array, Complex, Flags, Integers
from trunnion.equations.aligned import rigid_rotation
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.linear import LineMatrices
from trunnion.equations.topology import Topology
from trunnion.numerics import harmonics as fourier
from trunnion.numerics.sparse_matrices import Part, Pattern, SparseMatrices
from trunnion.steady.hill.straight import SINGULAR

NARROW = 1e-2
"""Share of the speed below which a range is too narrow to be interpolated from its ends."""
RESIDUAL = 1e-15
"""Share of what a solution takes to hold below which a change of it is rounding."""
ROUNDING = 2e-16
"""Fourier coefficients below this share of the largest are left out."""
MOST_WRITTEN = 4_000_000
"""Complex numbers of matrices that are kept written out for other carriers, beside the latest."""


def interpolation_nodes(speed: Array, co: LineCoefficients) -> Array | None:
    """Three speeds (3,) that suffice where the coefficients ``co`` of ``speed`` (case,) are the same everywhere;
    None where each case has to stand for itself. Excitations are taken to be of second degree in the speed as well."""
    laws = [np.broadcast_to(n, (len(speed), 1)) for law in co.joints for n in law.numbers]
    parts = (co.stiffness, co.damping, co.torque, co.twist, co.inertia, co.load, *laws, co.shift, co.loss)
    constant = all(np.array_equal(part, np.broadcast_to(part[:1], part.shape)) for part in parts)
    low, high = speed.min(), speed.max()
    if not constant or len(speed) <= 3 or high - low < NARROW * high or np.any(co.viscous) or np.any(co.quadratic):
        return None
    return np.array([low, (low + high) / 2, high])


def weights_at(few: Array | None, speed: Array) -> Array | None:
    """What carries the equations at ``few`` speeds to those of ``speed`` (case,): weights (case, node); None where each
    case stands for itself."""
    if few is None:
        return None
    a, b, c = (speed[:, None] - few).T / (few[-1] - few[0])
    return np.stack([2 * b * c, -4 * a * c, 2 * a * b], axis=1)


def interpolated(weights: Array | None, values: NDArray[Any]) -> NDArray[Any]:
    """Values (node, …) of second degree in the speed, at every case (case, …)."""
    if weights is None:
        return values
    flat = np.ascontiguousarray(values).reshape(len(values), -1)
    if np.iscomplexobj(flat):  # weights are real: half the multiplications
        found = (weights @ flat.view(float)).view(complex)
    else:
        found = weights @ flat
    return np.asarray(found.reshape(-1, *values.shape[1:]))


class HillBlocks:
    """Fourier coefficients of a batch of lines over one period; solves any carrier and any span of harmonics.

    Where nothing but the speed varies from case to case, every matrix is a polynomial of second degree in it: three
    lines, at ``nodes`` of the speed, then stand for all cases.
    """

    def __init__(
        self,
        topo: Topology,
        matrices: LineMatrices,
        loss: Array,
        step: Array,
        *,
        linearised: bool = False,
    ) -> None:
        """``step`` (node,) is bΩ [rad/s]; loss (node, compliance) [N m/rad]; ``matrices`` at the nodes; with
        ``linearised`` every case is a node, and solved to first order about the first."""
        self.topo, self.loss, self.step, self.linearised = topo, loss, step, linearised
        self.times = matrices.mass.shape[1]
        self.mass, self.damping, self.stiffness, self.ratio = (
            _coefficients(part) for part in (matrices.mass, matrices.damping, matrices.stiffness, matrices.ratio)
        )
        self.elongations = None if matrices.elongations is None else _coefficients(matrices.elongations)
        parts = [np.abs(part).max(axis=(0, 2, 3)) for part in (self.mass, self.damping, self.stiffness)]
        self.kept = np.any([part > ROUNDING * part.max() for part in parts], axis=0)
        self._written: dict[bytes, _WrittenOut] = {}

    def solve(self, weights: Array | None, carrier: Array, harmonics: Integers, rim: Flags, right: Complex) -> Complex:
        """X (case, h, n) at ``harmonics`` (h,) of G (node, h, n), of the cases that ``weights`` carry to; ``carrier``
        (node,) is ω₀ [rad/s].

        Harmonics on the ``rim`` (h,) are found from the others, by their own diagonal blocks: their size tells what
        leaving out the rest costs. NaN where the motion needs no force: resonance without damping.
        """
        s = np.asarray(1j * (carrier[:, None] + harmonics * self.step[:, None]))
        at_rest = harmonics == 0 if self.topo.still and not carrier.any() else np.zeros(len(harmonics), dtype=bool)
        matrix = self.matrices(s, harmonics, np.flatnonzero(at_rest))
        if not self.linearised:
            return _with_rim(matrix, rim, interpolated(weights, right), weights)
        alone = replace(matrix, values=matrix.values[:1])
        first = _with_rim(alone, rim, right[:1])
        rest = right - _times(matrix, rim, first)
        size = np.abs(right).max() + np.abs(alone.values).max() * np.abs(first).max()
        rest[np.abs(rest).max(axis=(1, 2)) <= RESIDUAL * size] = 0.0
        return np.asarray(first + _with_rim(alone, rim, rest, bounded=False))

    def matrices(self, s: Complex, harmonics: Integers, at_rest: Iterable[int] = ()) -> SparseMatrices:
        """The matrices (node, h·n, h·n) at s (node, h) [1/s] of the ``harmonics`` (h,); what a free line turns as a
        whole in those ``at_rest``, or oil alone drags along, which nothing resists at rest, is taken to be zero."""
        written = self._written_out(harmonics, np.sign(s.imag))
        found = SparseMatrices(written.pattern, written.at(s))
        if not (held := [self._rigid_motion_condition(h) for h in at_rest]):
            return found
        return SparseMatrices.added(found.size, [(found.row, found.column, found.values), *held])

    def _written_out(self, harmonics: Integers, sign: Array) -> _WrittenOut:
        """The matrices of ``harmonics`` (h,) whose frequencies have a ``sign`` (node, h): alike for all carriers."""
        key = (harmonics - harmonics[0]).tobytes() + sign.tobytes() * bool(self.loss.any())
        if (known := self._written.pop(key, None)) is None:
            known = self._put_together(harmonics, sign)
        held = [*self._written.values(), known]
        while len(held) > 1 and sum(one.numbers.size for one in held) > MOST_WRITTEN:
            del self._written[next(iter(self._written))], held[0]
        self._written[key] = known  # the latest comes last
        return known

    def _put_together(self, harmonics: Integers, sign: Array) -> _WrittenOut:
        apart = (harmonics[:, None] - harmonics[None, :]) % self.times
        loss = self._of_loss(apart, sign) if self.loss.any() else []
        size, nodes = len(harmonics) * self.topo.size, len(self.step)
        parts = fourier.hill_blocks(harmonics, (self.stiffness, self.damping, self.mass), np.flatnonzero(self.kept))
        row, column = (np.concatenate([part[k].ravel() for part in [*parts, *loss]]) for k in range(2))
        place, of = np.unique(row * size + column, return_inverse=True)
        numbers = np.zeros((3, nodes, len(place)), dtype=complex)
        done = 0
        for part in parts:
            entries = of[done : done + part[0].size]
            numbers[..., entries] += part[2].reshape(3, nodes, -1)
            done += len(entries)
        for rows, _, values in loss:
            entries = of[done : done + rows.size]
            numbers[0][:, entries] += values.reshape(nodes, -1)  # no part names a place twice
            done += len(entries)
        return _WrittenOut(Pattern(size, place // size, place % size), place % size // self.topo.size, numbers)

    def _rigid_motion_condition(self, h: int) -> Part:
        n, joined = self.topo.size, self.topo.elongations[list(self.topo.dragged)]
        whole = joined.T @ joined
        if self.topo.graph:
            basis = np.linalg.qr(self.topo.loose)[0]
            whole = basis @ basis.T
        elif self.topo.free:
            turn = rigid_rotation(self.topo)
            whole = whole + np.outer(turn, turn) / (turn @ turn)
        weight = np.abs(self.stiffness[:, 0]).max(axis=(1, 2))[:, None, None]
        row, column = np.indices((n, n))
        return h * n + row, h * n + column, weight * whole

    def _of_loss(self, place: Integers, sign: Array) -> list[Part]:
        n, every, found = self.topo.size, np.arange(sign.shape[1]), []

        def put(far: int, near: int, row: Integers, column: Integers, values: Any) -> None:
            found.append((row * n + far, column * n + near, values))

        def put_all(values: dict[tuple[int, int], Any]) -> None:
            for (one, other), part in values.items():
                row, column = np.nonzero(np.abs(part).max(axis=0) > ROUNDING * np.abs(part).max())
                put(one, other, row, column, part[:, row, column])

        for e, (far, near) in enumerate(self.topo.ends):
            if not self.loss[:, e].any():
                continue
            loss = 1j * self.loss[:, e, None] * sign
            if self.elongations is not None:
                twist = self.elongations[:, :, e]
                twisted = np.flatnonzero(np.abs(twist).max(axis=(0, 1)) > 0)
                turns = {i: twist[:, place, i] for i in twisted.tolist()}
                put_all({(i, j): turns[i] @ (loss[:, :, None] * turns[j]) for i in turns for j in turns})
                continue
            if far >= 0:
                put(far, far, every, every, loss)
            if near < 0:
                continue
            ratio = self.ratio[:, place, e]
            parts = {(near, near): ratio @ (loss[:, :, None] * ratio)}
            if far >= 0:
                parts |= {(far, near): -loss[:, :, None] * ratio, (near, far): -ratio * loss[:, None, :]}
            put_all(parts)
        return found


@dataclass(frozen=True, eq=False)
class _WrittenOut:
    """Matrices of a ``pattern`` as functions of s: ``numbers`` (power, node, entry), each multiplied by the s of the
    harmonic (entry,) in its column."""

    pattern: Pattern
    harmonic: Integers
    numbers: Complex

    def at(self, s: Complex) -> Complex:
        """Their entries (node, entry) at s (node, h) [1/s]."""
        own = s[:, self.harmonic]
        stiffness, damping, mass = self.numbers
        return np.asarray(stiffness + own * (damping + own * mass))


def _coefficients(values: Array) -> Complex:
    """Fourier coefficients (case, h, …) of values (case, time, …) over a period, zero where those are."""
    some = values.any(axis=(0, 1))
    found = np.zeros(values.shape, dtype=complex)
    found[:, :, some] = np.fft.fft(values[:, :, some], axis=1) / values.shape[1]
    return found


def _with_rim(
    matrix: SparseMatrices, rim: Flags, right: Complex, weights: Array | None = None, *, bounded: bool = True
) -> Complex:
    """X (case, h, n) of matrices at the nodes, which are those of the cases without ``weights``; harmonics on the rim
    by their own diagonal blocks; ``bounded`` as of ``_solve``."""
    cases, count, n = right.shape
    x = np.zeros((cases, count, n), dtype=complex)
    inside = matrix.among(np.repeat(~rim, n)) if rim.any() else matrix
    inside = replace(inside, values=interpolated(weights, inside.values))
    x[:, ~rim] = _solve(inside, right[:, ~rim].reshape(cases, -1), bounded=bounded).reshape(cases, -1, n)
    for end in np.flatnonzero(rim):
        row = interpolated(weights, matrix.rows(np.repeat(np.arange(count) == end, n)))
        known = (row @ x.reshape(cases, count * n, 1))[..., 0]
        x[:, end] = fourier.solved(row[:, :, end * n : (end + 1) * n], right[:, end] - known)
    return x


def _times(matrix: SparseMatrices, rim: Flags, x: Complex) -> Complex:
    """What ``_with_rim`` solves, times x (1, h, n): (case, h, n)."""
    count, n = x.shape[1:]
    row, column = matrix.row // n, matrix.column // n
    # One harmonic on the rim is found before the next: each sees the inner ones and those found before it.
    seen = ~rim[column] | (rim[row] & (column <= row))
    return matrix.only(seen).times(x.reshape(1, -1)).reshape(-1, count, n)


def _solve(matrix: SparseMatrices, right: Complex, *, bounded: bool = True) -> Complex:
    """Solutions (case, m); NaN where a matrix is singular, with ``bounded`` to rounding."""
    x = matrix.solved(right)
    if bounded:
        with np.errstate(invalid="ignore"):
            weight = np.abs(matrix.values).max(axis=1) * np.abs(x).max(axis=1)
            x[np.abs(right).max(axis=1) < SINGULAR * weight] = np.nan
    x[~right.any(axis=1)] = 0.0
    return np.asarray(x)
