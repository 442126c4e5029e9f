"""A periodic Lyapunov function of a line in a box, found in floating point: P(τ, p) = P₀(τ) + Σ p_v P_v(τ).

In modal coordinates of the mean line, y with A = H(τ) there and H₀'s diagonal λ, P₀ solves

    Ω P′ + H*P + PH = −Q,     Q = diag(−2 Re λ),

whose solution is the energy of the modes where nothing varies, whatever the resonances, and grows beyond all bounds
where the line comes to its limit. The derivatives by the parameters solve the same with what they move on the right,
but for its mean on the diagonal, the change of the decay rates. The energy itself changes with the frequencies, by
δω/ω of each mode, which is put in. With powers of the first parameter P has them too, each of what the lower ones
leave. By harmonics these are linear equations that GMRES solves, divided by
imsΩ + λ̄_i + λ_j: few of them, those near a resonance, are not near to one. What is found proves nothing by itself:
``proof`` checks it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from trunnion.arrays import Array, Complex
from trunnion.floquet.certificate.box_equations import BoxMatrix
from trunnion.floquet.certificate.waves import chebyshev_rows

ENOUGH = 1e-5
"""What may be left of the equations, relative to their right side."""
MOST_STEPS = 80
"""Steps of GMRES."""
LOOKED = 3
"""Steps between looks at what is left."""
SKEWED = 1e3
"""Condition of the modes beyond which the undamped ones are taken in their place."""
SWEEPS = 2
"""Over the powers of the first parameter."""
SIDES = (4, 8, 16, 32, 64, 128)
"""Harmonics of P beyond its mean, tried in turn."""
UNSOLVED = 2
"""Numbers of harmonics with which the equations were not solved, after which no more are tried."""
MATTERS = 1e-3
"""Size of a harmonic of the equations, relative to the largest, from which on P has it too."""
FADED = 1e-5
"""Size of the last harmonics, relative to all, with which they are enough."""


@dataclass(frozen=True)
class ModalBox:
    """The equations in modal coordinates: H (1 + parameters, 2K + 1, D, D), floating point; modes (D, D) as columns and
    what takes states to them, its inverse but for rounding; decay (D,) > 0, what Q asks."""

    h: Complex
    modes: Complex
    to_modes: Complex
    decay: Array


@dataclass(frozen=True)
class LyapunovSeries:
    """P (1 + parameters, 2K + 1, D, D); whether the equations were solved."""

    parts: Complex
    solved: bool


def modal_box(box: BoxMatrix) -> ModalBox | None:
    """Of a box, about the mean of its middle; None where that has no modes that decay."""
    mean = box.parts[0, box.last].real
    energy = box.energy
    root = np.sqrt(np.abs(np.diagonal(energy)))
    if not (np.isfinite(mean).all() and root.min() > 0):
        return None
    scaled = mean * root[:, None] / root[None, :]
    made = energy / root[:, None] / root[None, :]
    values, modes = np.linalg.eig(scaled)
    order = np.lexsort((values.imag, np.abs(values)))
    values, modes = values[order].astype(complex), modes[:, order].astype(complex)
    if not np.all(values.real < 0):
        return None
    size = np.einsum("ai,ab,bi->i", modes.conj(), made, modes).real
    modes = modes / np.sqrt(np.where(size > 0, size, 1.0))
    decay = -values.real
    if not np.linalg.cond(modes) < SKEWED:
        undamped = _energy_modes(scaled, made)
        if undamped is None:
            return None
        modes, decay = undamped
    stated: Complex = np.asarray(modes / root[:, None], dtype=complex)
    to_modes: Complex = np.asarray(np.linalg.inv(stated), dtype=complex)
    return ModalBox(to_modes @ box.parts @ stated, stated, to_modes, decay)


def _energy_modes(scaled: Array, energy: Array) -> tuple[Complex, Array] | None:
    """Modes of the undamped line, which are orthogonal, with decay rates that their own damping gives them."""
    n = len(scaled) // 2
    if len(scaled) != 2 * n:
        return None
    try:
        square, shapes = scipy.linalg.eigh(energy[:n, :n], np.linalg.inv(energy[n:, n:]))
    except np.linalg.LinAlgError:
        return None
    if not square[0] > 0:
        return None
    frequency = np.sqrt(square)
    swing, moves = shapes / frequency, np.linalg.solve(energy[n:, n:], shapes)
    modes = np.concatenate(
        [np.concatenate([swing, moves * 1j]), np.concatenate([swing, -moves * 1j])], axis=1
    ) / np.sqrt(2)  # fmt: skip
    own = np.diagonal(np.linalg.inv(modes) @ scaled @ modes)
    decay = np.minimum(-own.real, np.tile(square, 2) / np.maximum(-2 * own.real, 1e-300))
    return (modes, decay) if np.all(decay > 0) else None


def lyapunov_series(box: BoxMatrix, modal: ModalBox, sides: int | None = None) -> LyapunovSeries:
    """P of a box; with ``sides`` harmonics of it, or as many as it needs."""
    unsolved, least = 0, _least_sides(modal.h[0])
    enough = tuple(one for one in SIDES if one >= least) or (least,)
    for count in (sides,) if sides is not None else enough:
        found = _Solver.of(box, modal, count).series()
        unsolved += not found.solved
        # Where more harmonics do not help the line is near to its limit, and a smaller box has to decide.
        if sides is not None or (found.solved and _faded(found.parts)) or unsolved >= UNSOLVED:
            break
    return found


def _least_sides(h: Complex) -> int:
    """The last harmonic of the equations that P has to follow."""
    last = len(h) // 2
    size = np.abs(h).sum(axis=(1, 2))
    size[last] = 0.0
    strong = np.flatnonzero(size[last:] > MATTERS * size.max(initial=0.0))
    return int(strong.max(initial=0))


def _faded(parts: Complex) -> bool:
    last = parts.shape[1] // 2
    edge = max(1, last // 4)
    size = np.abs(parts).sum(axis=(2, 3))
    outer = size[:, :edge].sum(axis=1) + size[:, -edge:].sum(axis=1)
    return bool(np.all(outer <= FADED * size[0].sum()))


@dataclass(frozen=True)
class _Solver:
    """``grid`` H of the middle at even angles, ``order`` isΩm of the harmonics (2K + 1, 1, 1), ``over`` the inverse
    diagonal."""

    h: Complex
    grid: Complex
    order: Complex
    over: Complex
    decay: Array
    speed: tuple[float, float]
    sides: int
    times: int
    powers: int

    @classmethod
    def of(cls, box: BoxMatrix, modal: ModalBox, sides: int) -> _Solver:
        last = box.last
        # Half as many again as P alone: what a product folds back over its ends is small.
        times = _smooth(2 * sides + 2 * min(last, sides + 8) + 1)
        own = np.einsum("mii->mi", modal.h[0])[last]
        order: Complex = np.asarray(1j * np.arange(-sides, sides + 1)[:, None, None] * box.rate * box.speed[0])
        over = order + (own.conj()[:, None] + own[None, :])
        return cls(
            modal.h, _values(modal.h[0], times), order, np.asarray(1 / over), modal.decay,
            speed=box.speed, sides=sides, times=times, powers=box.powers,
        )  # fmt: skip

    def series(self) -> LyapunovSeries:
        size = len(self.decay)
        asked = np.zeros((2 * self.sides + 1, size, size), dtype=complex)
        asked[self.sides] = np.diag(-2 * self.decay)
        first, solved = self.solve(asked)
        parts = np.zeros((len(self.h), *asked.shape), dtype=complex)
        parts[0] = first
        if not solved:
            return LyapunovSeries(parts, False)
        rows = chebyshev_rows(len(self.h), self.powers) if self.powers else []
        for v in range(1, len(self.h)):
            if v not in rows and (self.h[v].any() or (v == 1 and self.speed[1])):
                parts[v], done = self._beside(v, self._moved(v, first), first)
                solved = solved and done
        for _ in range(SWEEPS if rows else 0):
            for d, v in enumerate(rows):
                right = self._left_at(d, parts[rows])
                found, done = self._beside(v, right, first) if d else self._without_decay(right)
                parts[v], solved = found + (first if not d else 0.0), solved and done
        return LyapunovSeries(parts, solved)

    def _moved(self, v: int, p: Complex) -> Complex:
        """H_v*P + PH_v, with what the speed moves of the derivative by the angle."""
        turned = _values(p, self.times) @ _values(self.h[v], self.times)
        right = self._harmonics(turned + turned.conj().swapaxes(1, 2))
        return right + self.order * p * (self.speed[1] / self.speed[0]) if v == 1 else right

    def _left_at(self, degree: int, p: Complex) -> Complex:
        """What the Chebyshev series ``p`` (degree, …) leaves at one degree, by all of H but its mean."""
        found, rows = np.zeros_like(p[0]), chebyshev_rows(len(self.h), self.powers)
        for a, b in np.ndindex(len(rows), len(rows)):
            share = ((a + b == degree) + (abs(a - b) == degree)) / 2
            if a and share and p[b].any():
                found = found + share * self._moved(rows[a], p[b])
        return found

    def _beside(self, v: int, right: Complex, first: Complex) -> tuple[Complex, bool]:
        """P_v by what is on its ``right``: the energy's own change, and the rest."""
        own = np.einsum("ii->i", self.h[0, self.h.shape[1] // 2])
        energy = np.zeros_like(right)
        energy[self.sides] = np.diag(
            _weights(own, np.einsum("ii->i", self.h[v, self.h.shape[1] // 2]), first[self.sides])
        )
        found, done = self._without_decay(right + self.apply(energy))
        return energy + found, done

    def _without_decay(self, right: Complex) -> tuple[Complex, bool]:
        """P by all on its right but its mean on the diagonal, the change of the decay rates."""
        kept = np.einsum("ii->i", right[self.sides])
        right = right.copy()
        right[self.sides] -= np.diag(kept)
        return self.solve(-right)

    def apply(self, p: Complex) -> Complex:
        """ΩP′ + H*P + PH, of Hermitian P."""
        turned = _values(p, self.times) @ self.grid
        return np.asarray(self.order * p + self._harmonics(turned + turned.conj().swapaxes(1, 2)))

    def _harmonics(self, values: Complex) -> Complex:
        found = np.fft.fft(values, axis=0) / self.times
        return np.concatenate([found[self.times - self.sides :], found[: self.sides + 1]])

    def solve(self, right: Complex) -> tuple[Complex, bool]:
        """GMRES over Hermitian series: coefficients of the Krylov vectors are real."""
        start = self.over * right
        norm = float(np.linalg.norm(start))
        if not (0 < norm < np.inf):
            return np.zeros_like(right), norm == 0
        basis, columns, steps = [start / norm], np.zeros((MOST_STEPS + 1, MOST_STEPS)), 0
        answer: Array = np.zeros(0)
        solved = False
        for steps in range(1, MOST_STEPS + 1):
            following = self.over * self.apply(basis[-1])
            for _ in range(2):
                flat = np.array([one.ravel() for one in basis])
                share = (flat.conj() @ following.ravel()).real
                columns[:steps, steps - 1] += share
                following = following - (share @ flat).reshape(following.shape)
            length = float(np.linalg.norm(following))
            columns[steps, steps - 1] = length
            last = length <= 1e-14 * norm or steps == MOST_STEPS
            if last or steps % LOOKED == 0:
                target = np.zeros(steps + 1)
                target[0] = norm
                answer = np.asarray(np.linalg.lstsq(columns[: steps + 1, :steps], target, rcond=None)[0])
                left = float(np.linalg.norm(columns[: steps + 1, :steps] @ answer - target))
                solved = left <= ENOUGH * norm
                if solved or last:
                    break
            basis.append(following / length)
        found = np.asarray(np.tensordot(answer, np.array(basis[:steps]), 1), dtype=complex)
        return (found + found[::-1].conj().swapaxes(1, 2)) / 2, solved


def _weights(own: Complex, moved: Complex, p: Complex) -> Array:
    """By how much more each mode's energy weighs as its frequency rises, where it swings."""
    swings = np.abs(own.imag) > 0.1 * np.abs(own)
    share = np.where(swings, moved.imag / np.where(swings, own.imag, 1.0), 0.0)
    return np.asarray(share * np.diagonal(p).real)


def _values(parts: Complex, times: int) -> Complex:
    """A series (2K + 1, D, D) at even angles."""
    last = parts.shape[0] // 2
    spread = np.zeros((times, *parts.shape[1:]), dtype=complex)
    for m in range(-last, last + 1):
        if parts[m + last].any():
            spread[m % times] += parts[m + last]
    return np.asarray(np.fft.ifft(spread, axis=0) * times)


def _smooth(least: int) -> int:
    """An even number of that size which transforms fast."""
    import scipy.fft

    return int(scipy.fft.next_fast_len(least))
