"""Up to which speed a line turns so slowly that nothing can grow in it: no resonance has to be looked for below.

About each angle φ of the input the line at rest, x′ = A₀(φ)x, has the Lyapunov function xᵀP(φ)x with
A₀ᵀP + PA₀ = −1. Turning at Ω, with A = A₀ + ΩA₁ + Ω²A₂,

    d/dt xᵀPx = xᵀ(−1 + ΩB₁ + Ω²B₂)x,   B₁ = P′ + A₁ᵀP + PA₁,   B₂ = A₂ᵀP + PA₂,

which is negative wherever Ω λ_max(B₁) + Ω² λ_max(B₂) < 1 at every φ. Undamped lines have no such speed.
"""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.coefficients import Assembly
from trunnion.equations.linear import line_matrices, over_mass
from trunnion.equations.topology import require_period
from trunnion.errors import InputError

SAMPLES = 64
PER_CYCLE = 16
NEARLY = 0.9
"""Share of the bound that is stated: the angles between the samples are not looked at."""


def slow_enough(assembly: Assembly) -> float:
    """Speed [rad/s] up to which no disturbance grows; 0 where no such bound is known."""
    topo = assembly.topology
    if topo.free or topo.size == 0:
        return 0.0
    try:
        turns = require_period(assembly.line, topo)
        cycles = float(max(topo.rates, default=1) * turns)
        tau = 2 * np.pi * float(turns) * np.arange(n := max(SAMPLES, PER_CYCLE * int(np.ceil(cycles)))) / n
        unit = float(np.median(np.abs(np.linalg.eigvals(_rates(assembly, 0.0, tau)[0]))))
        at_rest, once, twice = (_rates(assembly, share * unit, tau) for share in (0.0, 1.0, 2.0))
    except InputError:
        return 0.0
    first, second = (4 * once - 3 * at_rest - twice) / (2 * unit), (at_rest - 2 * once + twice) / (2 * unit**2)
    form = _lyapunov(at_rest)
    if form is None:
        return 0.0
    slope = np.fft.irfft(
        np.fft.rfft(form, axis=0) * (1j * np.arange(n // 2 + 1) / float(turns))[:, None, None], n, axis=0
    )
    one, two = (float(_largest(_both(part, form) + more)) for part, more in ((first, slope), (second, 0.0)))
    if two <= 0:
        return NEARLY / one if one > 0 else np.inf
    return NEARLY * 2 / (one + np.sqrt(one**2 + 4 * two))


def _rates(assembly: Assembly, speed: float, tau: Array) -> Array:
    """A (time, 2n, 2n) of x′ = Ax in time, x = (rotations √J ω, their rates √J), ω a typical frequency."""
    table = assembly.table(1, max(speed, 1e-300))
    m = line_matrices(assembly.topology, assembly.coefficients(table, statically_twisted=True), tau)
    mass, stiffness = m.mass[0], m.stiffness[0]
    root = np.sqrt(np.einsum("tii->ti", mass).mean(axis=0))
    ratio = root[:, None] / root
    n = len(root)
    typical = float(np.sqrt(np.abs(np.einsum("tii->ti", stiffness) / root**2).mean()))
    a = np.zeros((len(tau), 2 * n, 2 * n))
    a[:, :n, n:] = typical * np.eye(n)
    a[:, n:, :n] = -over_mass(m, m.stiffness)[0] * ratio / typical
    a[:, n:, n:] = -over_mass(m, m.damping)[0] * ratio
    return a


def _both(a: Array, p: Array) -> Array:
    """AᵀP + PA."""
    half = p @ a
    return half + half.transpose(0, 2, 1)


def _largest(symmetric: Array) -> float:
    return float(np.linalg.eigvalsh((symmetric + symmetric.transpose(0, 2, 1)) / 2)[:, -1].max())


def _lyapunov(a: Array) -> Array | None:
    """P (time, m, m) with AᵀP + PA = −1; None where one of A has an eigenvalue that does not decay."""
    values, vectors = np.linalg.eig(a)
    if not np.all(values.real < 0):
        return None
    m = a.shape[1]
    one = np.eye(m)
    # (Aᵀ ⊗ 1 + 1 ⊗ Aᵀ) vec P = −vec 1, by the eigenvectors of A.
    v = vectors
    inner = v.conj().transpose(0, 2, 1) @ v / (values.conj()[:, :, None] + values[:, None, :])
    back = np.linalg.inv(v)
    p = -(back.conj().transpose(0, 2, 1) @ inner @ back).real
    off = np.abs(_both(a, p) + one).max()
    return p if off < 1e-6 else None
