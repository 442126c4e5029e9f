"""The periodic solution of a forced line in a box, enclosed: what it is to first order, and how far off it may be.

In modal coordinates of the mean line w, with A = H(τ, p) there, amplitudes w_m at the frequencies ν_m of one carrier
solve L(p)w = f(p), (Lw)_m = iν_m w_m − Σ_k H_{m−k}w_k. Within a window of harmonics X inverts L at the middle of the
box, outside of it T = 1/(iν_m − H_0,ii) its diagonal does. With w̃ = w₀ + Σ p_v w_v, w₀ = Xf₀ and w_v = X(f_v − L_v w₀),
the error e = w − w̃ solves

    e = T(f − L w̃) + (1 − T L) e.

In norms by component ‖e_i‖ = Σ_m |e_m,i| this is ‖e‖ ≤ a + G‖e‖ with a matrix G ≥ 0 of bounds. If G contracts, L is
injective, and so, being of index 0, invertible: there is one periodic solution for every p, and ‖e‖ ≤ (1 − G)⁻¹a
(Krawczyk's test in the algebra of absolutely convergent Fourier series). Where it does not, ``energy_bound``
bounds e. f − L w̃ has no term of order 0 or 1 in p but rounding and what the window cuts off.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.floquet.certificate.periodic_lyapunov import ModalBox
from trunnion.floquet.certificate.waves import OUTWARD, UNIT
from trunnion.response.peaks.energy_bound import EnergyBound
from trunnion.response.peaks.forced_box import BoxForce, ForcedBox

CUT, FINE = 1e-5, 1e-10
"""Size of a harmonic of the equations, relative to the largest, up to which a window reaches; and where a Lyapunov
function bounds its error."""
WIDEST = 500
"""Unknowns of a window at most."""


@dataclass(frozen=True)
class ModalForced:
    """H (1 + parameters, 2K + 1, D, D) and a bound of what it leaves out (D, D); C the same with rows (Q, D);
    ``to_modes``, and by how much what it makes may be off (D, D)."""

    h: Complex
    left_out: Array
    outputs: Complex
    outputs_rest: Array
    to_modes: Complex
    off: Array
    speed: tuple[float, float]
    rate: Fraction

    @property
    def last(self) -> int:
        """K."""
        return self.h.shape[1] // 2


@dataclass(frozen=True)
class Carrier:
    """Frequencies (order + h·rate)Ω + frequency, h whole, and the forces there, each with its h."""

    order: Fraction
    frequency: float
    members: tuple[tuple[BoxForce, int], ...]


@dataclass(frozen=True)
class CarrierResponse:
    """What one carrier makes of the quantities: parts (1 + parameters, harmonics, Q) from harmonic ``first`` on, a
    bound of what they leave out (Q,), and what of that each parameter brings (parameters, Q)."""

    first: int
    parts: Complex
    rest: Array
    blame: Array


@dataclass(frozen=True)
class NotContracting:
    """Nothing is enclosed; ``blame`` (parameters,): what each parameter brings against it."""

    blame: Array


def modal_forced(box: ForcedBox, modal: ModalBox) -> ModalForced | None:
    """In modal coordinates of the middle; None where they are too skewed."""
    size = len(modal.decay)
    error = 8 * (size + 4) * UNIT
    to, fro = np.abs(modal.to_modes), np.abs(modal.modes)
    own = np.abs(box.matrix.parts).sum(axis=1)
    h = modal.to_modes @ box.matrix.parts @ modal.modes
    left_out = to @ (2 * error * own.sum(axis=0) + box.matrix.rest) @ fro
    # W U = 1 + e: U⁻¹ = (1 + e)⁻¹ W.
    e = np.abs(modal.to_modes @ modal.modes - np.eye(size)) + error * (to @ fro)
    most = float(e.sum(axis=1).max())
    if not most < 0.1:
        return None
    off = (e + most**2 / (1 - most)) * OUTWARD
    left_out = (left_out + off @ (np.abs(h).sum(axis=(0, 1)) + left_out)) * OUTWARD
    outputs = box.outputs @ modal.modes
    rows = np.abs(box.outputs).sum(axis=(0, 1))
    outputs_rest = ((box.outputs_rest + error * rows) @ fro) * OUTWARD
    return ModalForced(h, left_out, outputs, outputs_rest, modal.to_modes, off, box.matrix.speed, box.rate)


def carriers_of(box: ForcedBox) -> list[Carrier]:
    """The forces, sorted by what the equations couple; orders of a line that couples none each by itself."""
    coupled = box.matrix.parts.shape[1] > 1
    found: dict[tuple[Fraction, float], list[tuple[BoxForce, int]]] = {}
    for force in box.forces:
        if not (force.parts.any() or force.rest.any() or force.direct.any()):
            continue
        h = force.order // box.rate if coupled else 0
        found.setdefault((force.order - h * box.rate, force.frequency), []).append((force, int(h)))
    return [Carrier(order, frequency, tuple(members)) for (order, frequency), members in found.items()]


def response_of(
    line: ModalForced, carrier: Carrier, energy: Callable[[], EnergyBound | None]
) -> CarrierResponse | NotContracting:
    """The enclosure of what one carrier makes; by ``energy`` where harmonics do not contract."""
    found = _Window.of(line, carrier, CUT).response(carrier.members)
    if not isinstance(found, NotContracting):
        return found
    known = energy()
    return found if known is None else _Window.of(line, carrier, FINE).by_energy(carrier.members, known) or found


@dataclass(frozen=True)
class _Window:
    """Harmonics ``h`` (M,) of one carrier: their ``order`` and iν at the middle."""

    line: ModalForced
    h: Array
    order: Array
    turn: Complex
    frequency: float

    @classmethod
    def of(cls, line: ModalForced, carrier: Carrier, cut: float) -> _Window:
        size = np.abs(line.h[0]).sum(axis=(1, 2))
        size[line.last] = 0.0
        strong = np.flatnonzero(size > cut * size.max(initial=0.0)) if size.any() else np.array([line.last])
        margin = int(np.abs(strong - line.last).max()) + (1 if line.last else 0)
        low, high = _reached(line, carrier, cut)
        most = max(WIDEST // line.h.shape[2], 1)
        margin = max(min(margin, (most - (high - low + 1)) // 2), 0)
        h = np.arange(low - margin, high + margin + 1)
        order = float(carrier.order) + h * float(line.rate)
        turn: Complex = np.asarray(1j * (order * line.speed[0] + carrier.frequency), dtype=complex)
        return cls(line, h, order, turn, carrier.frequency)

    def response(self, members: Sequence[tuple[BoxForce, int]]) -> CarrierResponse | NotContracting:
        """The enclosure of what the forces make."""
        line, count, size = self.line, len(self.h), self.line.h.shape[2]
        many, unknowns = len(line.h) - 1, count * size
        matrix = self._matrix()
        with np.errstate(all="ignore"):
            try:
                inverse: Complex = np.asarray(np.linalg.inv(matrix), dtype=complex)
            except np.linalg.LinAlgError:
                return NotContracting(np.ones(many))
            if not np.isfinite(inverse).all():
                return NotContracting(np.ones(many))
            left = np.abs(inverse @ matrix - np.eye(unknowns))
            left += 8 * (unknowns + 4) * UNIT * (np.abs(inverse) @ np.abs(matrix))
            norms = _Norms.of(self, np.abs(inverse).reshape(count, size, count, size))
            gain = _blocks(left.reshape(count, size, count, size)) + norms.edge(self, inverse)
            each = norms.by_parameter(self)
            gain = (gain + np.sum(each, axis=0) + norms.through @ line.left_out + norms.outside(self)) * OUTWARD
            grown = _grown(gain)
            if grown is None:
                return NotContracting(np.array([one.sum() for one in each]))
            return self._enclosed(members, inverse, norms, gain, grown)

    def _matrix(self) -> Complex:
        """L of the middle within the window (M D, M D)."""
        line, count = self.line, len(self.h)
        size, last = line.h.shape[2], line.last
        found = np.zeros((count, size, count, size), dtype=complex)
        for k in range(-last, last + 1):
            for at in range(max(0, k), min(count, count + k)):
                found[at, :, at - k, :] = -line.h[0, k + last]
        whole: Complex = found.reshape(count * size, count * size)
        whole[np.diag_indices(count * size)] += np.repeat(self.turn, size)
        return whole

    def _times(self, v: int, x: Complex) -> Complex:
        """L_v x (M + 2K, D), of x (M, D): in and beside the window."""
        line, count, last = self.line, len(x), self.line.last
        found = np.zeros((count + 2 * last, x.shape[1]), dtype=complex)
        for k in range(2 * last + 1):
            if line.h[v, k].any():
                found[k : k + count] -= x @ line.h[v, k].T
        if v == 0:
            found[last : last + count] += self.turn[:, None] * x
        elif v == 1:
            found[last : last + count] += 1j * (self.order * line.speed[1])[:, None] * x
        return found

    def _forces(self, members: Sequence[tuple[BoxForce, int]]) -> tuple[Complex, Array]:
        """f (1 + parameters, M + 2K, D), and what that leaves out by component (D,)."""
        line, count, last = self.line, len(self.h), self.line.last
        size = line.h.shape[2]
        found = np.zeros((len(line.h), count + 2 * last, size), dtype=complex)
        rest = np.zeros(size)
        to, error = np.abs(line.to_modes), 8 * (size + 4) * UNIT
        for force, at in members:
            own = force.parts @ line.to_modes.T
            sizes = np.abs(force.parts).sum(axis=(0, 1))
            rest += to @ (force.rest + error * sizes)
            rest += line.off @ (np.abs(own).sum(axis=(0, 1)) + to @ force.rest)
            start = at - int(self.h[0])
            found[:, start : start + 2 * last + 1] += own
        return found, rest * OUTWARD

    def _enclosed(
        self,
        members: Sequence[tuple[BoxForce, int]],
        inverse: Complex,
        norms: _Norms,
        gain: Array,
        grown: Array,
    ) -> CarrierResponse:
        last, count = self.line.last, len(self.h)

        def through(left: Complex) -> Array:
            """‖T r‖ by component."""
            found = np.abs(self._solved(inverse, left)).sum(axis=0)
            outer = np.concatenate([left[:last], left[last + count :]])
            return np.asarray(found + (np.abs(outer) * norms.outer).sum(axis=0))

        w, a, each, loose = self._residual(members, inverse, through)
        a = a + norms.through @ loose
        error = np.maximum(grown @ (a + each.sum(axis=0)), 0.0) * (1 + 1e-9)
        if not np.all(error - gain @ error >= (a + each.sum(axis=0))):  # what solves it but for rounding
            error = error * (1 + 1e-6) + 1e-12 * error.max()
            if not np.all(error - gain @ error >= (a + each.sum(axis=0))):
                error = np.full_like(error, np.inf)
        return self._seen(members, w, error, np.abs(grown) @ each.T)

    def by_energy(self, members: Sequence[tuple[BoxForce, int]], energy: EnergyBound) -> CarrierResponse | None:
        """The same, its error by a Lyapunov function; None where the middle has no solution."""
        try:
            inverse: Complex = np.asarray(np.linalg.inv(self._matrix()), dtype=complex)
        except np.linalg.LinAlgError:
            return None
        if not np.isfinite(inverse).all():
            return None
        w, a, each, loose = self._residual(members, inverse, lambda left: np.abs(left).sum(axis=0))
        error = energy.error(a + each.sum(axis=0) + loose)
        brought = np.array([energy.error(one) for one in each]).T
        return self._seen(members, w, error, brought)

    def _solved(self, inverse: Complex, right: Complex) -> Complex:
        count, last = len(self.h), self.line.last
        return np.asarray((inverse @ right[last : last + count].ravel()).reshape(count, -1))

    def _residual(
        self, members: Sequence[tuple[BoxForce, int]], inverse: Complex, norm: Callable[[Complex], Array]
    ) -> tuple[Complex, Array, Array, Array]:
        """w (1 + parameters, M, D), and what f − L w̃ comes to by component: at the middle, by parameter, and what
        rounding, the equations and the forces leave out at harmonics that are not known."""
        line, count = self.line, len(self.h)
        many, size = len(line.h) - 1, line.h.shape[2]
        force, force_rest = self._forces(members)
        w = np.zeros((1 + many, count, size), dtype=complex)
        w[0] = self._solved(inverse, force[0])
        moved = [self._times(v, w[0]) for v in range(1 + many)]
        for v in range(1, 1 + many):
            w[v] = self._solved(inverse, force[v] - moved[v])
        whole = np.abs(w).sum(axis=(0, 1))
        a = norm(force[0] - moved[0])
        each = np.zeros((many, size))
        for v in range(1, 1 + many):
            a = a + norm(force[v] - moved[v] - self._times(0, w[v]))
            each[v - 1] += norm(self._times(v, w[v]))
            for u in range(v + 1, 1 + many):
                both = norm(self._times(v, w[u]) + self._times(u, w[v])) / 2
                each[v - 1] += both
                each[u - 1] += both
        sizes = np.abs(line.h).sum(axis=(0, 1)) * OUTWARD
        scale = np.abs(force).sum(axis=(0, 1)) + sizes @ whole + np.abs(self.turn).max() * whole * 2
        rounding = 8 * (2 * line.last + size + count + 2 * many + 16) * UNIT
        return w, a, each, force_rest + line.left_out @ whole + rounding * scale

    def _seen(
        self, members: Sequence[tuple[BoxForce, int]], w: Complex, error: Array, brought: Array
    ) -> CarrierResponse:
        """The quantities."""
        sizes = np.abs(w).sum(axis=1)
        line, count, last = self.line, len(self.h), self.line.last
        many, rows = len(line.h) - 1, line.outputs.shape[2]
        parts = np.zeros((1 + many, count + 2 * last, rows), dtype=complex)
        for k in range(2 * last + 1):
            for v in range(1 + many):
                if line.outputs[v, k].any():
                    parts[v, k : k + count] += w[0] @ line.outputs[v, k].T
                    if not v:
                        parts[1:, k : k + count] += w[1:] @ line.outputs[0, k].T
        seen = np.abs(line.outputs).sum(axis=1)
        all_seen, whole = seen.sum(axis=0), sizes.sum(axis=0)
        rest = all_seen @ error + line.outputs_rest @ (whole + error)
        rest = rest + seen[1:].sum(axis=0) @ sizes[1:].sum(axis=0)
        rest = rest + 8 * (2 * last + len(whole) + 16) * UNIT * (all_seen @ whole)
        blame = (all_seen @ brought).T + np.abs(parts[1:]).sum(axis=1)
        for force, at in members:
            start = at - int(self.h[0])
            parts[:, start : start + 2 * last + 1] += force.direct
            rest = rest + force.direct_rest
        return CarrierResponse(int(self.h[0]) - last, parts, rest * OUTWARD, np.asarray(blame))


def _reached(line: ModalForced, carrier: Carrier, cut: float) -> tuple[int, int]:
    """First and last harmonic that forces act at, but for what is small; as many as there may be unknowns."""
    places = [at for _, at in carrier.members]
    sizes = [np.abs(force.parts[0]).sum(axis=1) for force, _ in carrier.members]
    least = cut * max(size.max() for size in sizes)
    strong = [at - line.last + np.flatnonzero(size > least) for size, at in zip(sizes, places, strict=True)]
    every = np.concatenate([places, *strong])
    room = max((WIDEST // line.h.shape[2] - (max(places) - min(places) + 1)) // 2, 0)
    return max(int(every.min()), min(places) - room), min(int(every.max()), max(places) + room)


@dataclass(frozen=True)
class _Norms:
    """Of T: ``through`` (D, D), by how much a component's norm feeds another's at most; ``turned`` the same with
    every harmonic times the half width of its frequency; ``tail`` (D,) of all harmonics outside the window;
    ``outer`` (2K, D) of those beside it."""

    through: Array
    turned: Array
    tail: Array
    outer: Array

    @classmethod
    def of(cls, window: _Window, size: Array) -> _Norms:
        line, last = window.line, window.line.last
        own = np.diagonal(line.h[0, last])
        summed = size.sum(axis=0)  # (D, M, D)
        step = float(line.rate) * line.speed[0]
        near = np.arange(1, last + 1)
        below, above = window.turn[0] - 1j * step * near[::-1], window.turn[-1] + 1j * step * near
        beside = np.concatenate([below, above])
        outer = 1 / np.abs(beside[:, None] - own[None, :]) * (1 + 1e-13)
        tail = np.zeros(len(own))
        if last:
            low, high = window.turn[0].imag - step, window.turn[-1].imag + step
            within = np.maximum(np.minimum(high - own.imag, own.imag - low), 0.0)
            tail = 1 / np.hypot(own.real, within) * (1 + 1e-13)
        scale = np.abs(window.order) * line.speed[1]
        through = summed.max(axis=1) + np.diag(tail)
        turned = (summed * scale[None, :, None]).max(axis=1)
        return cls(through * OUTWARD, turned * OUTWARD, tail, outer)

    def by_parameter(self, window: _Window) -> list[Array]:
        """What each parameter brings of G within the window, and of the diagonal outside."""
        line = window.line
        found = [self.through @ np.abs(line.h[v]).sum(axis=0) for v in range(1, len(line.h))]
        own = np.abs(np.diagonal(line.h[0, line.last]))
        slack = line.speed[1] / line.speed[0] * (1 + (own + abs(window.frequency)) * self.tail)
        found[0] = found[0] + self.turned + np.diag(slack if line.last else np.zeros(len(own)))
        return found

    def outside(self, window: _Window) -> Array:
        """What the coupling of the middle brings outside the window."""
        line = window.line
        off = np.abs(line.h[0]).copy()
        off[line.last][np.diag_indices(off.shape[1])] = 0.0
        return np.asarray(self.tail[:, None] * off.sum(axis=0))

    def edge(self, window: _Window, inverse: Complex) -> Array:
        """What harmonics beside the window bring within it."""
        line, count = window.line, len(window.h)
        size, last = line.h.shape[2], line.last
        if not last:
            return np.zeros((size, size))
        beside = [*range(-last, 0), *range(count, count + last)]
        columns = np.zeros((count, size, len(beside), size), dtype=complex)
        for j, at in enumerate(beside):
            for m in range(max(0, at - last), min(count, at + last + 1)):
                columns[m, :, j, :] = line.h[0, m - at + last]
        flat = columns.reshape(count * size, -1)
        used = np.flatnonzero(flat.any(axis=1))
        made = inverse[:, used] @ flat[used]
        bound = np.abs(made) + 8 * (len(used) + 4) * UNIT * (np.abs(inverse[:, used]) @ np.abs(flat[used]))
        return _blocks(bound.reshape(count, size, len(beside), size))


def _blocks(size: Array) -> Array:
    """Of moduli (M, D, M, D) the norm of each block (D, D)."""
    return np.asarray(size.sum(axis=0).max(axis=1))


def _grown(gain: Array) -> Array | None:
    """(1 − G)⁻¹, where G ≥ 0 is sure to contract."""
    if not np.isfinite(gain).all():
        return None
    size = len(gain)
    try:
        found: Array = np.asarray(np.linalg.inv(np.eye(size) - gain), dtype=float)
    except np.linalg.LinAlgError:
        return None
    weight = found.sum(axis=1)
    if not np.all(weight > 0):
        return None
    holds = gain @ weight * (1 + 4 * size * UNIT) * OUTWARD < weight * (1 - 4 * UNIT)
    return found if holds.all() else None
