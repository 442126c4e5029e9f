"""The resonance of a tongue: which modes, and how many cycles of the excitation.

With all joints straight a line has multipliers e^{±iω_jT}. As the joint angles are raised in steps, they move along the
circle, and each keeps the mode it came from until two of them meet. So the phase θ_j of every mode is followed from
ω_jT on, as the angles of joints and the shares of mesh-stiffness variations grow from nothing to what they are where
the tongue begins. There θ_i + θ_j is a whole number of turns, 2πN, and N cycles in the period name the resonance,
whatever steep angles have made of the frequencies on the way: for one mode i = j, and 2θ_i = 2πN.

The content of the growing mode by frequency (``linear.mode_content``) says the same at small angles and gets blurred at
large ones, where a mode is spread over many harmonics.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.equations.aligned import aligned_matrices, frequencies
from trunnion.equations.coefficients import Assembly
from trunnion.equations.topology import require_period
from trunnion.floquet.charts.chart_families import LineFamily
from trunnion.floquet.tongues.rows import InstabilityKind
from trunnion.modes.mode_content import excited
from trunnion.modes.resonance_speeds import Resonance, sources

STEPS = 160
"""Points of the way from straight joints to bent ones."""
TOLERANCE = 1e-7
FITS = 0.3
"""How far [rad] a followed phase may end from the multiplier that it should be."""
NUDGE = 1e-3
"""A phase that waits on the real axis leaves it in the direction in which it came, by no less than this to begin
with."""


def resonances(family: LineFamily, x: Array, y: Array, kinds: Array, threads: int) -> list[Resonance | None]:
    """Names of tongues that begin at points (x, y) with these kinds of multipliers; None where a phase was lost."""
    share = np.linspace(0.0, 1.0, STEPS) ** 0.5  # angles act by their squares
    across, up, bends = np.repeat(x, STEPS), np.repeat(y, STEPS), np.tile(share, len(x))
    every = partly_bent(family, across, up, bends, threads).reshape(len(x), STEPS, 2 * family.size)
    modes, speed = straight_frequencies(family, x, y)
    return [_named(family, float(speed[k]), modes[k], every[k], int(kinds[k])) for k in range(len(x))]


def partly_bent(family: LineFamily, x: Array, y: Array, share: Array, threads: int) -> Complex:
    """Multipliers (points, 2n) at points (x, y) of the line bent by a share of its angles and mesh variations."""
    assembly, table = family.assembly, family.table(x, y)
    bent = [c for c, label in enumerate(assembly.packed.labels) if _bends(assembly, label)]
    table[:, bent] *= share[:, None]
    return eigenvalues(family.matrices_of(table, TOLERANCE, threads))


def eigenvalues(matrix: Array) -> Complex:
    """Eigenvalues (points, m) of matrices (points, m, m); all 1, where no mode stays, of those that failed."""
    failed = np.asarray(~np.isfinite(matrix).all(axis=(1, 2)))
    return np.asarray(
        np.linalg.eigvals(np.where(failed[:, None, None], np.eye(matrix.shape[1]), matrix)), dtype=complex
    )


def straight_frequencies(family: LineFamily, x: Array, y: Array) -> tuple[Array, Array]:
    """Natural frequencies [rad/s] (points, n) of the straight line at points (x, y), and the speeds there."""
    assembly, table = family.assembly, family.table(x, y)
    matrices = aligned_matrices(assembly.topology, assembly.coefficients(table))
    return frequencies(matrices, still=assembly.topology.still), table[:, 0]


def _bends(assembly: Assembly, label: str) -> bool:
    owner, _, key = label.rpartition(".")
    if key == "angle":
        joints = {assembly.topology.stations[j].element for j in assembly.topology.joints}
        return owner in assembly.line.names and assembly.line.names.index(owner) in joints
    return key.startswith(("stiffness_variation", "ripple")) and key.endswith(("share", "amplitude"))


def _named(family: LineFamily, speed: float, modes: Array, every: Complex, kind: int) -> Resonance | None:
    elastic = np.flatnonzero(modes > 0)
    turns = require_period(family.assembly.line, family.assembly.topology)
    phases = _followed(modes[elastic] * (family.period / speed), every)
    last = every[-1][np.abs(every[-1]).argmax()]
    meeting = _collision(phases, last, kind)
    if meeting is None:
        return None
    i, j, cycles = meeting
    multiple, source = excited(Fraction(cycles) / turns, sources(family.assembly))
    if source is None:
        return None
    first, second = sorted((int(elastic[i]), int(elastic[j])))
    at = float(modes[first] + modes[second]) / float(Fraction(cycles) / turns)
    if first != second:
        return Resonance(at, "sum", (first + 1, second + 1), multiple, source.rate, source.mesh)
    named = "subharmonic" if multiple % 2 else "harmonic"
    return Resonance(at, named, (first + 1,), (multiple + 1) // 2, source.rate, source.mesh)


def _followed(start: Array, every: Complex) -> Array:
    """Phases (modes,) at the end of the way, from ``start``; ``every`` (steps, 2n) are the multipliers on it."""
    phase, pace = start.copy(), np.zeros(len(start))
    for step, values in enumerate(every):
        ahead = phase + pace + np.where(pace < 0, -NUDGE, NUDGE) * (step > 0)
        moved = nearest_phases(ahead, values)
        if step:
            still = np.abs(moved - phase) < 1e-12
            pace = np.where(still, 0.5 * pace, moved - phase)
        phase = moved
    return phase


def nearest_phases(ahead: Array, values: Complex) -> Array:
    """Phases of the multipliers ``values`` (2n,) that suit the expected ones (modes,) best, one pair each.

    Multipliers come in pairs of one |phase|: conjugates, or two on the real axis. No two modes share a pair, or a mode
    would meet its own conjugate in the name of another.
    """
    from scipy.optimize import linear_sum_assignment  # here, as it loads much that a report does without

    turned = np.abs(np.angle(values))
    order = np.argsort(turned)[::2]
    # Each may be the phase or its negative, whole turns aside: which lies nearer to what is expected.
    signed = np.stack([turned[order], -turned[order]])
    off = (signed[:, None, :] - ahead[:, None] + np.pi) % (2 * np.pi) - np.pi
    off = np.where(np.abs(off[0]) <= np.abs(off[1]), off[0], off[1])
    # Multipliers that have all but vanished have no phase worth following.
    mode, place = linear_sum_assignment(np.abs(off) + 10.0 * (np.abs(values[order]) < 1e-9))
    phase = ahead.copy()
    phase[mode] += off[mode, place]
    return phase


def _collision(phases: Array, multiplier: complex, kind: int) -> tuple[int, int, int] | None:
    """The two modes that meet at ``multiplier``, and the cycles N in the period with θ_i + θ_j = 2πN."""

    def off(phase: float) -> float:
        return float(abs(np.angle(multiplier * np.exp(-1j * phase))))

    pairs = [
        (i, j) for i in range(len(phases)) for j in range(len(phases)) if (i == j) == (kind != InstabilityKind.COMPLEX)
    ]
    if not pairs:
        return None
    i, j = min(pairs, key=lambda p: off(phases[p[0]]) + off(-phases[p[1]]))
    if off(phases[i]) + off(-phases[j]) > FITS:
        return None
    cycles = round(float(phases[i] + phases[j]) / (2 * np.pi))
    return (i, j, cycles) if cycles > 0 else None
