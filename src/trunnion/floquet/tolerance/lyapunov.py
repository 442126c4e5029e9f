"""Boxes of lines proved stable by a Lyapunov function that turns with the joints and follows the parameters.

At the middle of a box let W(τ) = e^{Λτ} V⁻¹ Φ(τ)⁻¹ from an ordinary integration, turned into a trigonometric
polynomial (``floquet_form``); from here on W is that polynomial, exact by definition, and how it was found does not
matter. Lines of the box stand p away from its middle: logarithms of stiffness, damping, inverse inertia and speed, and
the joint angle.
A(τ, p) = A + Σ_v p_v A_v + ½ Σ_vw p_v p_w A_vw + … (``box_terms``). With B_v = W A_v W⁻¹, S_v(τ) a trigonometric
polynomial that solves S_v′ + S_vΛ − ΛS_v + B_v = D_v as well as can be, D_v constant and of the blocks of Λ, and

    T(τ, p) = I + Σ_v p_v S_v(τ),    U = TW,    |U(τ, p) x|² as Lyapunov function of the line p,

a line is asymptotically stable if the Hermitian part of H = (U′ + UA)U⁻¹ is negative definite at all τ. Exactly,

    H = Λ + [Σ p_v F_v + PB + (I + P)(RW⁻¹ + ρ)] T⁻¹,    P = Σ p_v S_v,  B = Σ p_v B_v,

with W′ + WA = ΛW + R, F_v = D_v + N_v, N_v what S_v leaves of its equation, and ρ = W (A(p) − A − Σ p_v A_v) W⁻¹. To
second order this is Λ + Σ p_v D_v + Σ_vw p_v p_w (S_v B_w + ½ W A_vw W⁻¹ − D_v S_w). Frequencies that move stand in
imaginary parts of D_v and drop out of the Hermitian part, and so do modes that merely turn towards each other: what is
left at first order is how decay rates move, a share of the damping. So boxes may be as wide as the root of the damping
allows, and parameters add up instead of multiplying boxes.

**Bounds.** R and N_v W times the joints' denominators are trigonometric polynomials of known degree, so samples bound
them (Ehlich and Zeller 1964: by 1/cos(πm/N) for degree m and N samples). On the piece of the turn about each sample
τ_j, with Q the computed W(τ_j)⁻¹, W(τ)Q = I + E and |E| ≤ ε by Taylor's theorem from W′(τ_j)Q, so W⁻¹ = Q(I + E)⁻¹: a
W A_v Q of the sample differs from B_v on the piece by at most d + (|B_v| + d) ε/(1 − ε), with d from bounds on the
derivatives of W and A_v. Sizes of what is beyond second order, and of whatever combines the angle with other
parameters, are products of norms.

**Rounding.** With u = 1.1e-16, a fast transform of N values errs in each by less than 5 u log₂N times the sum of their
absolute values (Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., section 24.1), so W by 5e-15 and W′ by
5e-15 of the sums over their harmonics that bound them everywhere; the joints' laws, and so A, by some 10 u of each
entry; products of matrices of 2n ≤ 6 by 2n u of the product of norms. All of these are less than 1e-13 of
‖W′‖ + ‖W‖(‖A‖ + |Λ|), bounded everywhere (``carried_size``), and likewise with S_v; ``SLACK`` adds a thousand times as
much, before samples are turned into bounds. Q is what was computed, and its defect WQ − I counts. Tests compare with
80-bit arithmetic.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex, Flags
from trunnion.equations.coefficients import Assembly
from trunnion.floquet.tolerance.bounds import Coefficients, Ratios, over_boxes, ratios
from trunnion.floquet.tolerance.box_terms import BoxTerms
from trunnion.floquet.tolerance.floquet_form import (
    HALF_TURN,
    HARMONICS,
    ORDERS,
    STEPS,
    FloquetForm,
    floquet_form,
    sampled,
)

SLACK = 1e-10
"""Share of ``carried_size`` added for rounding: a thousand times what it can be."""
EVERY = 2
"""Every how many of the samples the second order is taken."""


@dataclass(frozen=True)
class BoxProof:
    """For each box: proved stable, the largest multiplier at its middle, and the bound on the largest eigenvalue of the
    Hermitian part of H [per radian], each (boxes,); how much of what stands against a proof each variable brings
    (boxes, variables): ln k, ln c, ln 1/J, ln s, and the angle of a line's only joint."""

    proved: Flags
    radius: Array
    largest: Array
    blame: Array


def judge_boxes(assembly: Assembly, low: Array, high: Array) -> BoxProof:
    """Boxes between tables of numbers (boxes, columns) at their low and high ends."""
    co = over_boxes(assembly, low, high)
    tau = HALF_TURN * np.arange(2 * STEPS) / (2 * STEPS)
    at = ratios(assembly, (low + high) / 2, co, tau)
    terms = BoxTerms.of(assembly, co)
    a = terms.matrix(at.b, at.slope)
    form = floquet_form(a, terms.energy())
    here = at.every_other()
    with np.errstate(all="ignore"):
        first = first_order(terms, co, here, form)
        largest, blame = _largest(terms, co, a[:, ::2], form, first)
    return BoxProof((largest < 0) & (form.radius < 1), form.radius, largest, blame)


@dataclass(frozen=True)
class FirstOrder:
    """What the box does to first order, variable by variable, and what bounds the rest.

    width (boxes, variables): half-widths; b, s (boxes, STEPS, variables, 2n, 2n): B_v and S_v at the samples; s_most,
    s_slope (boxes, variables): bounds on ‖S_v‖ and ‖S_v′‖ everywhere; d (boxes, variables, 2n, 2n): D_v; rest (boxes,
    variables): bounds on ‖N_v W‖; most, steepest (boxes, variables) and most_terms, steepest_terms (boxes, terms):
    bounds on ‖A_v‖, ‖A_v′‖ and those of the terms; b_terms (boxes, STEPS, terms, 2n, 2n): W A_t Q; power (terms,
    variables): see ``BoxTerms``; crude (boxes,): a bound on what neither first nor second order counts of A.
    """

    width: Array
    b: Complex
    s: Complex
    s_most: Array
    s_slope: Array
    d: Complex
    rest: Array
    most: Array
    steepest: Array
    most_terms: Array
    steepest_terms: Array
    b_terms: Complex
    power: Array
    crude: Array


def first_order(terms: BoxTerms, co: Coefficients, at: Ratios, form: FloquetForm) -> FirstOrder:
    width = np.concatenate([co.dk, co.dc, co.dg, co.ds[:, None]], axis=1)
    parts = terms.parts(at.b, at.slope)
    power = terms.power
    a = np.einsum("tv,bntij->bnvij", power, parts)
    most_t, steepest_t, moved_t = terms.most(at), terms.steepest(at), terms.moved(at)
    most, steepest = most_t @ np.abs(power), steepest_t @ np.abs(power)
    reach = width @ np.abs(power).T
    tail = np.exp(reach) - 1 - reach - reach**2 / 2
    crude = (tail * most_t + np.expm1(reach) * moved_t + np.exp(reach) * terms.moved_twice(at)).sum(axis=1)
    if co.angle.shape[1] == 1:
        turned = co.turned[:, 0]
        width = np.concatenate([width, turned[:, None]], axis=1)
        a = np.concatenate([a, terms.moved_parts(at).sum(axis=2)[:, :, None]], axis=2)
        safe = np.where(turned > 0, turned, 1.0)
        most, steepest = (
            np.concatenate([x, (y.sum(axis=1) / safe)[:, None]], axis=1)
            for x, y in ((most, moved_t), (steepest, terms.moved_steepest(at)))
        )
        power = np.concatenate([power, np.zeros((len(power), 1))], axis=1)
    w, q = form.w[:, :, None], form.q[:, :, None]
    b = w @ a @ q
    s, s_slope_values, d, s_most, s_slope = _turned(b, form)
    lam = form.lam[:, None, None]
    rest = (s_slope_values + s @ lam - lam @ s - d[:, None]) @ w + w @ a
    most_w = form.most[:, None]
    carried = (s_slope + 2 * s_most * _size(form.lam)[:, None] + most + _size(d)) * most_w
    joints = co.angle.shape[1]
    rest_most = _bounded(rest, SLACK * carried, HARMONICS + 4 * joints, co, 4 * joints)
    return FirstOrder(
        width=width, b=b, s=s, s_most=s_most, s_slope=s_slope, d=d, rest=rest_most, most=most, steepest=steepest,
        most_terms=most_t, steepest_terms=steepest_t, b_terms=w @ parts @ q, power=power, crude=crude,
    )  # fmt: skip


def _turned(b: Complex, form: FloquetForm) -> tuple[Complex, Complex, Complex, Array, Array]:
    """S_v and S_v′ at the samples (boxes, STEPS, variables, 2n, 2n), D_v, and bounds on ‖S_v‖ and ‖S_v′‖ everywhere."""
    harmonic, d = solved(b, form)
    size = np.linalg.norm(harmonic, axis=(3, 4))
    values, slopes = sampled(harmonic)
    steep = 2 * np.abs(ORDERS)[None, :, None] * size
    return values, slopes, d, size.sum(axis=1), steep.sum(axis=1)


def solved(b: Complex, form: FloquetForm) -> tuple[Complex, Complex]:
    """Coefficients at e^{2ikτ} of the S_v (boxes, harmonics, variables, 2n, 2n), which define them, and D_v."""
    b = np.where(np.isfinite(b), b, 0.0)
    c = (np.fft.fft(b, axis=1) / STEPS)[:, ORDERS % STEPS]
    d = np.where(form.blocks[:, None], c[:, 0], 0.0)
    x, back = form.basis[:, None, None], np.linalg.inv(form.basis)[:, None, None]
    gap = form.exponents[:, None, :] - form.exponents[:, :, None]
    denominator = 2j * ORDERS[None, :, None, None] + gap[:, None]
    kept = np.ones(denominator.shape, dtype=bool)
    kept[:, 0] = ~form.blocks
    kept[:, HARMONICS // 2] = False  # the highest has no sign
    divided = -(x @ c @ back) / np.where(kept, denominator, 1.0)[:, :, None]
    return back @ np.where(kept[:, :, None], divided, 0.0) @ x, d


def _bounded(samples: Complex, rounding: Array, degree: int, co: Coefficients, power: int) -> Array:
    """A bound everywhere on the norm of (boxes, STEPS, …, 2n, 2n) whose product with the joints' denominators to a
    power is a trigonometric polynomial of 2τ of a degree."""
    flat = np.prod(np.cos(np.abs(co.angle) + co.turned) ** 2, axis=1) ** power
    largest = np.sqrt((np.abs(samples).max(axis=1) ** 2).sum(axis=(-2, -1))) + rounding
    return np.asarray(largest / (np.cos(np.pi * degree / STEPS) * flat.reshape(-1, *[1] * (largest.ndim - 1))))


def _size(matrices: Complex) -> Array:
    return np.asarray(np.linalg.norm(matrices, axis=(-2, -1)))


def _largest(terms: BoxTerms, co: Coefficients, a: Array, form: FloquetForm, first: FirstOrder) -> tuple[Array, Array]:
    """A bound all over the turn and the box on the largest eigenvalue of the Hermitian part of H, for each box: below
    zero it proves; and what stands against that by variable."""
    size, joints = a.shape[-1], co.angle.shape[1]
    half = HALF_TURN / STEPS / 2 * EVERY
    q_most = _size(form.q).max(axis=1)
    eps = half * _size(form.slope @ form.q).max(axis=1) + half**2 / 2 * form.most_bend * q_most
    eps = eps + _size(form.w @ form.q - np.eye(size)).max(axis=1)
    near = eps < 0.5
    eps = np.where(near, eps, 0.5)
    inverse = q_most / (1 - eps)
    carried = carried_size(a, form.lam, form.most, form.most_slope)
    rest = form.slope + form.w @ a - form.lam[:, None] @ form.w
    left = _bounded(rest, SLACK * carried, HARMONICS // 2 + 3 * joints, co, 3 * joints) * inverse
    r = first.width
    here = _size(first.b[:, ::EVERY]).max(axis=1)
    away = _away(here, first.most, first.steepest, form, half, q_most, eps)
    p = (r * first.s_most).sum(axis=1)
    b = (r * (here + away)).sum(axis=1)
    missed = (r * first.rest).sum(axis=1) * inverse
    d = (r * _size(first.d)).sum(axis=1) + missed
    reach = r @ first.power.T
    here_t = _size(first.b_terms[:, ::EVERY]).max(axis=1)
    away_t = _away(here_t, first.most_terms, first.steepest_terms, form, half, q_most, eps)
    crude = form.most * first.crude * inverse
    rho = (reach**2 / 2 * (here_t + away_t)).sum(axis=1) + crude
    # What the second order at the samples leaves out: what S, B and A do between samples, N beside D, ...
    steps = half * (r * first.s_slope).sum(axis=1)
    between = steps * (b + d) + p * (r * away).sum(axis=1) + missed * p + (reach**2 / 2 * away_t).sum(axis=1)
    # ... and every product of more than two.
    near = near & (p < 0.5)
    safe = np.where(near, p, 0.5)
    third = ((p * b + rho) * p + d * p**2 + p * rho) / (1 - safe)
    slack = missed + between + third + crude + left * (1 + p) / (1 - safe)
    slack = slack + SLACK * (1 + carried * q_most)
    own = r[:, :, None, None] * _herm(first.d) + _pairs(first)
    hermitian = (form.lam + form.lam.conj().swapaxes(1, 2)) / 2
    middle = np.where(np.eye(size, dtype=bool), hermitian.real, np.abs(hermitian))
    test = middle + own.sum(axis=1) + slack[:, None, None] * np.eye(size)
    good = np.isfinite(test).all(axis=(1, 2)) & near
    top = np.linalg.eigvalsh(np.where(good[:, None, None], test, np.eye(size)))[:, -1]
    blame = own.sum(axis=(2, 3)) + (between + third + crude)[:, None] * r * first.s_most
    margin = np.where(good, top, np.inf) + SLACK * (1 + _size(form.lam))
    return margin, np.where(np.isfinite(blame), blame, 1.0)


def _away(here: Array, most: Array, steepest: Array, form: FloquetForm, half: float, q: Array, eps: Array) -> Array:
    """How far W A_v W⁻¹ may stand, on pieces of ± half, from W A_v Q at the sample (boxes, variables)."""
    w, w1, q, eps = (x[:, None] for x in (form.most, form.most_slope, q, eps))
    moved = half * (w1 * most + w * steepest) * q
    return np.asarray(moved + (here + moved) * eps / (1 - eps))


def _herm(matrices: Complex) -> Array:
    """Absolute values of the entries of Hermitian parts."""
    return np.asarray(np.abs(matrices + matrices.conj().swapaxes(-1, -2)) / 2)


def _pairs(first: FirstOrder) -> Array:
    """Second order at the samples, entries of Hermitian parts at their largest over the turn, gathered by variable
    (boxes, variables, 2n, 2n)."""
    r, count = first.width, first.width.shape[1]
    s, b, bt = first.s[:, ::EVERY], first.b[:, ::EVERY], first.b_terms[:, ::EVERY]
    d = first.d[:, None]
    gathered = np.zeros((len(r), count, *s.shape[-2:]))
    for v in range(count):
        for w in range(v, count):
            weight = r[:, v] * r[:, w]
            if not weight.any():
                continue
            c = s[:, :, v] @ b[:, :, w] - d[:, :, v] @ s[:, :, w]
            c = c + np.einsum("t,bntij->bnij", first.power[:, v] * first.power[:, w] / 2, bt)
            both = _herm(c if v == w else c + _mirrored(first, s, b, bt, v, w)).max(axis=1)
            gathered[:, v] += weight[:, None, None] * both / 2
            gathered[:, w] += weight[:, None, None] * both / 2
    return gathered


def _mirrored(first: FirstOrder, s: Complex, b: Complex, bt: Complex, v: int, w: int) -> Complex:
    bent = np.einsum("t,bntij->bnij", first.power[:, v] * first.power[:, w] / 2, bt)
    return np.asarray(s[:, :, w] @ b[:, :, v] - first.d[:, None, w] @ s[:, :, v] + bent)


def carried_size(a: Array, lam: Complex, most_w: Array, most_slope: Array) -> Array:
    """‖W′‖ + ‖W‖(‖A‖ + |Λ|) of each box, bounded everywhere: rounding errors are shares of it."""
    largest = np.linalg.norm(a, axis=(2, 3)).max(axis=1) + _size(lam)
    return np.asarray(most_slope + most_w * largest)
