"""Harmonic balance of M ẍ + C ẋ + K x + Σ d f(dᵀx) = F(t), followed over the frequency, with stability.

With x = a₀ + Σ a_k cos kωt + b_k sin kωt the balance of every harmonic is linear but for the springs. A smooth force is
sampled over the period and transformed (Cameron and Griffin, J. Appl. Mech. 56, 1989). A force with kinks is linear
between the phases at which the series crosses them, so its coefficients are in closed form and nothing folds back from
harmonics that are not there. The Jacobian by the series and by ω is exact. Against ``harmonic_balance``, which takes
any first-order system, this has half the unknowns, and everything but the springs is in closed form.

Stability is that of the variational equation M ÿ + C ẏ + (K + Σ d f′(dᵀx) dᵀ) y = 0 along the series: between the
crossings of kinks, which are found on the series, fourth-order Magnus steps, exact where the slope is constant.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Complex
from trunnion.errors import InputError
from trunnion.motion.orbits.branch import STEP
from trunnion.motion.orbits.harmonic_balance import HarmonicSeries, SeriesBranch, balanced
from trunnion.motion.orbits.periodic_branch import begun_within
from trunnion.numerics import harmonics as fourier
from trunnion.numerics.chain.exponential_monodromy import exponential
from trunnion.numerics.continuation.arclength import CurvePoint, Ending, follow, once
from trunnion.numerics.continuation.newton import Root, solve
from trunnion.numerics.curves import extremes
from trunnion.results.fields import labelled
from trunnion.results.parameter_names import Names
from trunnion.steady.shooting.shooting_problem import by_modulus
from trunnion.systems.second_order import SecondOrder, Spring

FEWEST, MOST = 10, 160
"""Harmonics to begin with, and the most that a tail is answered with."""
PER_HARMONIC, FEWEST_SAMPLES = 8, 256
"""Samples per harmonic, for smooth forces and to find the crossings of kinks."""
MAGNUS = 64
"""Steps of the variational equation per period, besides the crossings, at least."""
ADDED = 10.0
"""Damping added on the way to a first motion, over ω times the mass."""
NEWTON, SETTLED = 3, 1e-8
"""Corrections of a crossing found between two samples, at most; and the last one [rad], whose square is rounding."""
NEAR, FAR = 1e-3, 100.0
"""Distance of a spectral radius from 1 at which its error does not matter: at least, and over the series' tail in units
of the motion's width."""
ROUNDING = 1e-12
"""Of a spectral radius."""
GAUSS = np.sqrt(3.0) / 6


@labelled
class SpringBalance(SeriesBranch):
    """A branch of the unknowns of a ``SecondOrder`` system as Fourier series; see ``SeriesBranch``."""

    def motion(self, point: int, count: int = 512) -> Array:
        """The unknowns (n, count) at equidistant times of the period of one point."""
        return fourier.samples(self.rows[point], count)


def balance_springs(
    system: SecondOrder,
    low: float,
    high: float,
    *,
    harmonics: int | None = None,
    begin: float | None = None,
    start: ArrayLike | None = None,
    periods: int = 1,
    tail: float = 1e-4,
    longest_step: float = 0.01,
    most_points: int = 4000,
) -> SpringBalance:
    """The frequency response of masses on nonlinear springs by harmonic balance.

    Parameters
    ----------
    system : a ``SecondOrder`` system of n unknowns.
    low, high : ends of the range of forcing frequencies ω [rad/s].
    harmonics : H; by default doubled from 10 · ``periods`` until the last two are below ``tail`` of the largest on the
        whole branch, at most 160.
    begin : frequency [rad/s] to begin at, by default ``low``; the branch is followed both ways from it.
    start : series (n, 2H₀ + 1) near the first motion, by default the linear response; so isolated and subharmonic
        branches are reached.
    periods : forcing periods in one of the motion.
    tail : the last two harmonics over the largest.
    longest_step : largest step of the frequency, as a share of its range.
    most_points : points after which the branch ends.

    Returns
    -------
    SpringBalance, a branch of the unknowns; its ``outcome`` says where it ended.

    Raises
    ------
    InputError : a range that does not rise, fewer harmonics than the force has, a start of another shape.

    Examples
    --------
    >>> import numpy as np, trunnion as tn
    >>> one, force = np.eye(1), np.array([0.2])
    >>> spring = tn.cubic_spring([1.0], cubic=0.1)
    >>> system = tn.SecondOrder(one, 0.1 * one, one, (spring,), np.zeros(1), ((1, force, 0 * force),))
    >>> branch = tn.balance_springs(system, 0.8, 1.3, harmonics=5)
    >>> round(float(branch.peak_to_peak.max()), 3)
    3.618
    """
    first = begun_within(low, high, begin)
    needed = periods * max(k for k, _, _ in system.harmonics)
    if harmonics is not None and harmonics < needed:
        raise InputError(f"must be {needed} or more, those of the force", key="harmonics", value=harmonics)
    rows = None if start is None else np.atleast_2d(np.asarray(start, dtype=float))
    if rows is not None and (rows.shape[0] != system.size or rows.shape[1] % 2 == 0):
        raise InputError(f"must be series of {system.size} unknowns", key="start", value=rows.shape)
    width = (high - low) * longest_step / STEP
    return balanced(
        SpringBalance, lambda h: _SpringSystemBalance(system, h, periods, width, first, rows), harmonics,
        max(FEWEST * periods, needed), MOST, tail, first, low, high, most_points,
    )  # fmt: skip


@dataclass
class _SpringSystemBalance(HarmonicSeries):
    """The balance as equations of a curve z = (series, ω), from a frequency and a series, if one is given."""

    system: SecondOrder
    h: int
    periods: int
    range: float
    begin: float
    given: Array | None

    @cached_property
    def starts(self) -> list[Array]:
        """Series to begin with."""
        return self.guesses(self.begin) if self.given is None else [fourier.resized(self.given, self.h)]

    @cached_property
    def width(self) -> float:
        """Size of the motion that counts as one: the nearest kink, or the first guess."""
        kinks = [abs(b) for spring in self.system.springs for b in spring.kinks if b != 0]
        return min(kinks) if kinks else max(float(np.abs(self.starts[0]).max()), 1e-12)

    @property
    def n(self) -> int:
        return self.system.size

    @property
    def size(self) -> int:
        return 2 * self.n

    @property
    def over(self) -> Names:
        return Names("frequency", "rad/s", tuple(self.system.names))

    @property
    def scale(self) -> Array:
        return np.append(np.full(self.n * (2 * self.h + 1), self.width), self.range)

    @cached_property
    def count(self) -> int:
        """Samples of a period."""
        return max(FEWEST_SAMPLES, 1 << int(np.ceil(np.log2(PER_HARMONIC * self.h))))

    @cached_property
    def force(self) -> Array:
        """Series (n, 2h + 1) of the forces from outside."""
        out = np.zeros((self.n, 2 * self.h + 1))
        out[:, 0] = self.system.mean
        for k, p, q in self.system.harmonics:
            out[:, k * self.periods] += p
            out[:, self.h + k * self.periods] += q
        return out

    @cached_property
    def parts(self) -> tuple[Array, Array, Array]:
        """Stiffness, damping and mass acting on a series at ω = 1, each (n, 2h + 1, n, 2h + 1)."""
        s, h, wide = self.system, self.h, 2 * self.h + 1
        k = np.concatenate([np.arange(h + 1), np.arange(1, h + 1)]) / self.periods
        turn = fourier.rate_matrix(h, 1.0 / self.periods)
        stiffness = np.einsum("ij,ab->iajb", s.stiffness, np.eye(wide))
        return stiffness, np.einsum("ij,ab->iajb", s.damping, turn), np.einsum("ij,ab->iajb", s.mass, np.diag(k**2))

    def operator(self, omega: float) -> tuple[Array, Array]:
        """The linear part (n, 2h + 1, n, 2h + 1) and its derivative by ω."""
        stiffness, damping, mass = self.parts
        return stiffness + omega * damping - omega**2 * mass, damping - 2 * omega * mass

    def guesses(self, omega: float) -> list[Array]:
        """Linear responses with the springs at their slopes at rest, halfway, and beyond their kinks; with the mean
        taken from the outer slopes and offsets, since without stiffness at rest it would run away."""
        found = []
        for share in (0.0, 0.5, 1.0):
            for side in (1.0, -1.0):
                matrix, _ = self.operator(omega)
                force = self.force.copy()
                for spring in self.system.springs:
                    d = np.array(spring.direction)
                    beyond = side * 2 * max(map(abs, spring.kinks), default=0.0)
                    inner, outer = (float(spring.slope(np.array(u))) for u in (0.0, beyond))
                    slopes = np.full(2 * self.h + 1, inner + share * (outer - inner))
                    slopes[0] = outer
                    matrix += np.einsum("i,j,ab->iajb", d, d, np.diag(slopes))
                    force[:, 0] -= d * (float(spring.force(np.array(beyond))) - outer * beyond)
                flat = matrix.reshape(self.n * (2 * self.h + 1), -1)
                found.append(np.asarray(np.linalg.lstsq(flat, force.ravel(), rcond=None)[0].reshape(self.n, -1)))
        return found

    def first(self) -> Array:
        """Where damped Newton's method arrives from one of the starts; else the motion with much damping added,
        followed while that is taken away. The first start itself where all fail."""
        omega, guesses = self.begin, self.starts
        for guess in guesses:
            root = self.root(omega, guess)
            if root.converged:
                return root.x.reshape(self.n, -1)
        size = guesses[0].size
        turn = fourier.rate_matrix(self.h, 1.0 / self.periods)
        added = omega**2 * np.einsum("ij,ab->iajb", self.system.mass, turn).reshape(size, size)

        def damped(z: Array) -> tuple[Array, Array]:
            left, slope = self.equations(np.append(z[:-1], omega))
            more = added @ z[:-1]
            return left + z[-1] * more, np.hstack([slope[:, :-1] + z[-1] * added, more[:, None]])

        first = np.append(np.linalg.lstsq(added * ADDED, self.force.ravel(), rcond=None)[0], ADDED)
        first[:size] += guesses[0].ravel() * (np.arange(size) % (2 * self.h + 1) == 0)
        curve = follow(
            damped, first, scale=np.append(np.full(size, self.width), 1.0), bounds=(0.0, 2 * ADDED), direction=-1.0,
            largest_step=0.5, tolerance=1e-9,
        )  # fmt: skip
        arrived = curve.ending is Ending.BOUND and curve.points[-1].parameter == 0
        return curve.points[-1].z[:-1].reshape(self.n, -1) if arrived else guesses[0]

    def root(self, omega: float, guess: Array) -> Root:
        """The balance at a fixed frequency by damped Newton's method."""

        def residual(x: Array) -> tuple[Array, Array]:
            left, slope = self.equations(np.append(x, omega))
            return left, slope[:, :-1]

        return solve(residual, guess.ravel(), np.full(guess.size, self.width), tolerance=1e-9, most=40)

    def equations(self, z: Array) -> tuple[Array, Array]:
        size, omega = self.n * (2 * self.h + 1), float(z[-1])
        if not (np.isfinite(z).all() and omega > 0):
            return np.full(size, np.nan), np.full((size, size + 1), np.nan)
        rows = z[:-1].reshape(self.n, -1)
        matrix, by_omega = self.operator(omega)
        flat = matrix.reshape(size, size)
        left = flat @ z[:-1] - self.force.ravel()
        for spring in self.system.springs:
            d = np.array(spring.direction)
            force, slope = self.spring(spring, d @ rows)
            left += np.outer(d, force).ravel()
            # ``flat`` is a view of ``matrix``.
            matrix += np.einsum("i,j,ab->iajb", d, d, slope)
        change = by_omega.reshape(size, size) @ z[:-1]
        return left, np.hstack([flat, change[:, None]])

    def spring(self, spring: Spring, row: Array) -> tuple[Array, Array]:
        """The force's row (2h + 1,) at an elongation's, and its derivative (2h + 1, 2h + 1)."""
        if not spring.kinks:
            u = fourier.samples(row, self.count)
            return fourier.rows_of(spring.force(u), self.h), fourier.product_matrix(spring.slope(u), self.h)
        # Linear between the kinks, f = s u + d: both coefficients are known in closed form from the crossings.
        at = self.kink_phases(spring, row[None, :])
        ends = np.append(at, at[0] + 2 * np.pi) if len(at) else np.array([0.0, 2 * np.pi])
        u = fourier.at(row[None, :], 0.5 * (ends[:-1] + ends[1:]))[0]
        s = np.asarray(spring.slope(u))
        spectra = fourier.spectrum_of_steps(ends, np.stack([s, spring.force(u) - s * u]), 2 * self.h)
        slope = fourier.product_matrix_of(spectra[0], self.h)
        rest = spectra[1, : self.h + 1]
        return slope @ row + np.concatenate([rest[:1].real, 2 * rest[1:].real, -2 * rest[1:].imag]), slope

    def start(self, point: CurvePoint) -> Array:
        rows, omega = self.rows(point), point.parameter / self.periods
        v = fourier.rate(rows, omega)
        return np.concatenate([r[:, : self.h + 1].sum(axis=1) for r in (rows, v)])

    @once
    def crossings(self, point: CurvePoint) -> Array:
        """Phases at which a spring passes a kink."""
        rows, springs = self.rows(point), self.system.springs
        found = [self.kink_phases(spring, (np.array(spring.direction) @ rows)[None, :]) for spring in springs]
        return np.sort(np.concatenate(found)) if found else np.zeros(0)

    def kink_phases(self, spring: Spring, u: Array) -> Array:
        """Phases at which one spring of elongation u (1, 2h + 1) passes a kink, rising."""
        step = 2 * np.pi / self.count
        values = fourier.samples(u, self.count)[0]
        side = np.append(values, values[0]) - np.array(spring.kinks)[:, None]
        which, i = np.nonzero((side[:, :-1] < 0) != (side[:, 1:] < 0))
        if not len(i):
            return np.zeros(0)
        here, there = side[which, i], side[which, i + 1]
        phase = step * (i + here / (here - there))
        both = np.concatenate([u, fourier.rate(u, 1.0)])
        for _ in range(NEWTON):
            value, slope = fourier.at(both, phase)
            change = (value - np.array(spring.kinks)[which]) / np.where(slope == 0, 1.0, slope)
            phase = np.clip(phase - change, step * i, step * (i + 1))
            if np.abs(change).max() < SETTLED:
                break
        return np.sort(phase)

    @once
    def multipliers(self, point: CurvePoint) -> Complex:
        """By falling modulus."""
        return by_modulus(self._monodromy(self.rows(point), point.parameter / self.periods, self.crossings(point)))

    def _monodromy(self, rows: Array, omega: float, crossings: Array) -> Array:
        n = self.n
        # Between kinks a piecewise linear spring is a constant one, and any step is exact.
        smooth = any(not spring.kinks for spring in self.system.springs)
        steps = max(MAGNUS, 8 * self.h) if smooth else 4
        ends = np.unique(np.concatenate([2 * np.pi * np.arange(steps + 1) / steps, crossings]))
        h = np.diff(ends)
        middle = 0.5 * (ends[:-1] + ends[1:])
        one, two = (self._tangent_matrix(rows, middle + side * GAUSS * h) for side in (-1, 1))
        dt = (h / omega)[:, None, None]
        generator = 0.5 * dt * (one + two) + (np.sqrt(3.0) / 12) * dt**2 * (two @ one - one @ two)
        passed = exponential(generator)
        while len(passed) > 1:
            if len(passed) % 2:
                passed = np.concatenate([passed, np.eye(2 * n)[None]])
            passed = passed[1::2] @ passed[::2]
        return np.asarray(passed[0])

    def _tangent_matrix(self, rows: Array, phases: Array) -> Array:
        s, n = self.system, self.n
        stiffness = np.broadcast_to(s.stiffness, (len(phases), n, n)).copy()
        for spring in s.springs:
            d = np.array(spring.direction)
            slope = spring.slope(fourier.at((d @ rows)[None, :], phases)[0])
            stiffness += slope[:, None, None] * np.outer(d, d)
        out = np.zeros((len(phases), 2 * n, 2 * n))
        out[:, :n, n:] = np.eye(n)
        inverse = np.linalg.inv(s.mass)
        out[:, n:, :n] = -inverse @ stiffness
        out[:, n:, n:] = -inverse @ s.damping
        return out

    @cached_property
    def finer(self) -> _SpringSystemBalance:
        """Of twice the harmonics."""
        return replace(self, h=2 * self.h)

    def undamped(self, point: CurvePoint) -> bool:
        """Whether no part has damping."""
        return not self.system.damping.any()

    def radius_error(self, point: CurvePoint, radius: float) -> float:
        """Against the radius of the series of twice the harmonics, by twice the steps.

        Where the radius is far from 1, the distance from there on which only the side of 1 matters.
        """
        rows, h, omega = self.rows(point), self.h, point.parameter
        tail = np.hypot(rows[:, h - 1 : h + 1], rows[:, 2 * h - 1 :]).max()
        far = max(NEAR, FAR * float(tail) / self.width)
        if abs(radius - 1) > far:
            return far
        root = self.finer.root(omega, fourier.resized(rows, self.finer.h))
        if not root.converged:  # a fold
            return far
        found = self.finer.multipliers(replace(point, z=np.append(root.x, omega)))
        # The finer one is off by less than the difference, even of a kinked force, whose coefficients fall as k⁻³.
        return float(2 * abs(np.abs(found).max() - radius) + ROUNDING)

    def changes(self, point: CurvePoint) -> int:
        return len(self.crossings(point))

    def observed(self, point: CurvePoint) -> tuple[Array, Array, Array, float]:
        rows, omega = self.rows(point), point.parameter
        seen = extremes(lambda phases: fourier.at(rows, phases).T, fourier.cuts(self.h))
        k = self.periods
        size = np.hypot(rows[:, k], rows[:, self.h + k])
        amplitude = np.concatenate([size, omega * size])
        return seen.span, seen.largest, amplitude, self.periods * 2 * np.pi / omega
