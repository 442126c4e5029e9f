"""The equations of a ``ScannedLine`` about its base motion, written here alone.

Mass i turns by a_i, link e leads from mass n to mass f. What arrives at the spring's near end is n_e(a_n): behind a
Hooke's joint tan ψ = tan χ/cos β, its output fork a quarter turn on, then over the ratio. With r = dn_e/da_n,
r′ = dr/da_n and the elastic twist x_e (the error of the teeth over the driven radius included), Lagrange gives

    J_i ä_i = −M_i + Σ_near r f − Σ_far f + torques,   f = k w x + c ẋ   (w: the uneven stiffness of a mesh)

About a base motion: δ_i, x = δ_f − r δ_n, ẋ = δ̇_f − r δ̇_n − r′ ȧ_n δ_n, and the near end gets r f̃ + r′ f̄ δ_n. The
base of a driven line turns without vibrating, its springs twisted by the mean torque; what it leaves over shakes the
line. A free–free line with joint angles is taken about its periodic motion, found by collocation.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import gcd, lcm

import numpy as np
from numpy.typing import NDArray

from oracles.scanned_lines import Link, ScannedLine, Shake

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
QUARTER = np.pi / 2
PER_CYCLE, OF_ORBITS = 32, 20
"""Samples of the fastest joint's cycle, and where the motion is solved for at each."""
WIDEST = np.log(1e13), 321
"""Budget and most orders of any lattice."""


def common(rates: list[Fraction]) -> Fraction:
    """The largest rate that all ``rates`` are multiples of; 1 without any."""
    if not rates:
        return Fraction(1)
    return Fraction(gcd(*(r.numerator for r in rates)), lcm(*(r.denominator for r in rates)))


def hooke(chi: Array, angle: Array) -> tuple[Array, Array, Array]:
    """Output angle, its slope and the slope of that, by the input angle from the joint's plane."""
    c, s2 = np.cos(angle), np.sin(angle) ** 2
    over = 1 - s2 * np.cos(chi) ** 2
    lead = np.arctan2(np.sin(chi) * np.cos(chi) * (1 - c), c * np.cos(chi) ** 2 + np.sin(chi) ** 2)
    return chi + lead + QUARTER, c / over, -c * s2 * np.sin(2 * chi) / over**2


@dataclass(frozen=True)
class Base:
    """A motion at samples of the joints' period: a, ȧ, ä (speed, time, mass); r, r′ and the torque of every spring
    (speed, time, link) without what uneven teeth add; ``level`` (mass,): a at no rotation, untwisted."""

    angle: Array
    rate: Array
    acceleration: Array
    ratio: Array
    slope: Array
    torque: Array
    level: Array


class Steady:
    """One line, under one load case."""

    def __init__(self, line: ScannedLine, of_orbits: int = OF_ORBITS) -> None:
        self.line, self.n, self.of_orbits = line, len(line.masses), of_orbits
        self.links = [(i, link) for i, link in enumerate(line.links) if link is not None]
        self.over = [self._over(link) for _, link in self.links]
        self.orbits: dict[float, Array] = {}
        """Motions (time, mass) that are known, by speed, of a line that moves by itself."""
        self.anchored = False
        """Whether they were looked for all over the range."""
        self.sense = np.array([1.0 if r > 0 else -1.0 for r in self.mean_ratio])
        self.turning = np.array([abs(float(r)) for r in self.mean_ratio])

    @staticmethod
    def _over(link: Link) -> Fraction:
        return Fraction(link.teeth[0], link.teeth[1]) if link.kind == "mesh" else 1 / link.ratio

    @cached_property
    def mean_ratio(self) -> list[Fraction]:
        """Mean speed of every mass over the input's."""
        found: list[Fraction] = []
        for link in self.line.links:
            if link is None:
                found.append(Fraction(1))
            else:
                found.append((found[link.near] if link.near >= 0 else Fraction(1)) * self._over(link))
        return found

    def _near_ratio(self, link: Link) -> Fraction:
        return self.mean_ratio[link.near] if link.near >= 0 else Fraction(1)

    @cached_property
    def joint_rates(self) -> list[Fraction]:
        """Cycles per turn of the input that every joint makes."""
        return [2 * abs(self._near_ratio(one)) for _, one in self.links if one.angle or one.scheduled]

    @cached_property
    def teeth(self) -> dict[int, Fraction]:
        """Teeth per turn of the input, by link number."""
        return {
            e: abs(self._near_ratio(one)) * one.teeth[0] for e, (_, one) in enumerate(self.links) if one.kind == "mesh"
        }

    @cached_property
    def step(self) -> Fraction:
        """Rate that joints are multiples of."""
        return common(self.joint_rates)

    @cached_property
    def samples(self) -> int:
        """Over the joints' period."""
        fastest = max((r / self.step for r in self.joint_rates), default=Fraction(1))
        return (self.of_orbits if self.moves else PER_CYCLE) * int(fastest) if self.joint_rates else 1

    @property
    def moves(self) -> bool:
        """Whether the line moves by itself: free and bent."""
        return self.line.free and bool(self.joint_rates)

    # Loads and numbers at speeds

    def loads(self, speed: Array) -> Array:
        """Torque (speed, mass) that resists at mean speed; of the first mass of a free line what drives, negative."""
        v = speed[:, None] * self.turning
        found = np.stack(
            [m.load + (m.viscous + m.quadratic * v[:, i]) * v[:, i] for i, m in enumerate(self.line.masses)], 1
        )
        if self.line.free:
            found[:, 0] -= found @ self.turning
        return found

    def carried(self, speed: Array) -> Array:
        """Mean torque (speed, spring), positive with the twist."""
        loads, found = self.loads(speed) * self.turning, np.zeros((len(speed), len(self.links)))
        for e, (far, _) in reversed(list(enumerate(self.links))):
            beyond = [f for f in range(self.n) if self._hangs(f, far)]
            found[:, e] = -loads[:, beyond].sum(axis=1) / float(self.mean_ratio[far])
        return found

    def _hangs(self, mass: int, on: int) -> bool:
        while mass != on:
            link = self.line.links[mass]
            if link is None or link.near < 0:
                return False
            mass = link.near
        return True

    def springs(self) -> tuple[Array, Array, Array]:
        """k [N m/rad], c [N m s/rad], ηk [N m/rad] (spring,)."""
        found = []
        for _, link in self.links:
            square = link.radius**2 if link.kind == "mesh" else 1.0
            lossy = link.loss > 0
            found.append((link.stiffness * square, 0.0 if lossy else link.damping * square, link.loss * link.stiffness))
        k, c, loss = np.array(found).T
        return k, c, loss

    def bends(self, speed: Array) -> Array:
        """Joint angles (speed, link)."""
        found = np.zeros((len(speed), len(self.links)))
        for e, (_, link) in enumerate(self.links):
            found[:, e] = np.interp(speed, *link.scheduled) if link.scheduled else link.angle
        return found

    # The base motion

    def base(self, speed: Array, *, rigid: bool = False) -> Base:
        """What the response is taken about; ``rigid``: of a line that moves by itself too without its vibration."""
        turned = 2 * np.pi / float(self.step) * np.arange(self.samples) / self.samples
        if self.moves and not rigid:
            from oracles.free_orbits import orbit

            return orbit(self, speed, turned)
        return self.rigid(speed, turned)

    def passed(self, link: Link, e: int, angle: Array, bends: Array) -> tuple[Array, Array, Array]:
        """n_e, r, r′ of near angles (speed, time)."""
        over = float(self.over[e])
        if not (link.angle or link.scheduled):
            return angle * over, np.full_like(angle, over), np.zeros_like(angle)
        psi, eta, slope = hooke(angle - link.plane, bends[:, e, None])
        return psi * over, eta * over, slope * over

    def rigid(self, speed: Array, turned: Array) -> Base:
        """Springs twisted by the mean torque; ``turned`` (time,): angle of the input."""
        shape = (len(speed), len(turned))
        carried, bends, (k, _, _) = self.carried(speed), self.bends(speed), self.springs()
        a, v, w = (np.zeros((*shape, self.n)) for _ in range(3))
        ratio, slope = (np.zeros((*shape, len(self.links))) for _ in range(2))
        omega = speed[:, None] + 0 * turned
        root = turned + 0 * omega, omega, 0 * omega
        if self.line.free:
            a[..., 0], v[..., 0], w[..., 0] = root
        for e, (far, link) in enumerate(self.links):
            at, by, of = (a[..., link.near], v[..., link.near], w[..., link.near]) if link.near >= 0 else root
            n, r, r1 = self.passed(link, e, at, bends)
            a[..., far] = n + link.fork + (carried[:, e] / k[e])[:, None]
            v[..., far], w[..., far] = r * by, r * of + r1 * by**2
            ratio[..., e], slope[..., e] = r, r1
        torque = np.broadcast_to(carried[:, None], (*shape, len(self.links)))
        return Base(a, v, w, ratio, slope, torque, self.level)

    @cached_property
    def level(self) -> Array:
        """Angles (mass,) of the straight untwisted line while the input stands at zero."""
        found = np.zeros(self.n)
        for e, (far, link) in enumerate(self.links):
            at = found[link.near] if link.near >= 0 else 0.0
            through = at - link.plane + QUARTER if link.angle or link.scheduled else at
            found[far] = through * float(self.over[e]) + link.fork
        return found

    # Equations

    def equations(self, base: Base) -> tuple[Array, Array, Array]:
        """Damping, stiffness (speed, time, n, n) with even teeth, and what the base leaves over (speed, time, n)."""
        speeds, times, n = base.angle.shape
        k, c, _ = self.springs()
        damping, stiffness = (np.zeros((speeds, times, n, n)) for _ in range(2))
        left = np.zeros((speeds, times, n))
        for i, mass in enumerate(self.line.masses):
            v = base.rate[..., i]
            damping[..., i, i] += mass.viscous + 2 * mass.quadratic * np.abs(v)
            left[..., i] -= mass.inertia * base.acceleration[..., i] + (mass.viscous + mass.quadratic * np.abs(v)) * v
        for e, (f, link) in enumerate(self.links):
            r, r1, torque = base.ratio[..., e], base.slope[..., e], base.torque[..., e]
            damping[..., f, f] += c[e]
            stiffness[..., f, f] += k[e]
            left[..., f] -= torque
            if (m := link.near) >= 0:
                change = r1 * base.rate[..., m]
                damping[..., m, m] += c[e] * r**2
                damping[..., f, m] -= c[e] * r
                damping[..., m, f] -= c[e] * r
                stiffness[..., m, m] += k[e] * r**2 + c[e] * r * change - r1 * torque
                stiffness[..., f, m] -= k[e] * r + c[e] * change
                stiffness[..., m, f] -= k[e] * r
                left[..., m] += r * torque
        return damping, stiffness, left

    def constant_loads(self, speed: Array) -> Array:
        """Loads (speed, mass) that do not follow the speed of their mass, against its mean sense of turning."""
        found = np.broadcast_to(np.array([m.load for m in self.line.masses]), (len(speed), self.n)).copy()
        if self.line.free:
            v = speed * self.turning[0]
            first = self.line.masses[0]
            found[:, 0] = self.loads(speed)[:, 0] - (first.viscous + first.quadratic * v) * v
        return found * self.sense

    def pattern(self, e: int) -> Array:
        """What the torque of spring ``e`` does to the masses, r as on average: (n,)."""
        far, link = self.links[e]
        found = np.zeros(self.n)
        found[far] = 1.0
        if link.near >= 0:
            found[link.near] = -float(self.over[e])
        return found

    # Series

    def lattice(self, budget: float, most: int) -> list[Fraction]:
        """Orders beside the one that shakes: sums of the rates of joints and teeth, each step of which costs the
        logarithm of what it passes on, up to ``budget``; fewer until no more than ``most``. What a shake leaves at no
        rotation at all is a mean torque: the orders down to that belong to it."""
        every = set(self._lattice(budget, most)) | {-order for order in self._to_rest}
        return sorted(every | {-order for order in every})

    @cached_property
    def _to_rest(self) -> set[Fraction]:
        """Steps that a shake takes down to no rotation."""
        shaken = [s.order * abs(self.mean_ratio[i]) for i, m in enumerate(self.line.masses) for s in m.shakes]
        wide = self._lattice(*WIDEST)
        reached = [order for order in shaken if -order in wide]
        return {order for order in wide if 0 < order <= max(reached, default=Fraction(0))}

    def _lattice(self, budget: float, most: int) -> list[Fraction]:
        bends = np.abs(self.bends(np.linspace(self.line.low, self.line.high, 9))).max(axis=0)
        costs: dict[Fraction, float] = {}
        for e, (_, link) in enumerate(self.links):
            if link.angle or link.scheduled:
                rate, share = 2 * abs(self._near_ratio(link)), 4 * np.tan(bends[e] / 2) ** 2
                costs[rate] = min(costs.get(rate, np.inf), -np.log(max(min(share, 0.5), 1e-12)))
            for share, order, _ in link.waves:
                rate = self.teeth[e] * order
                costs[rate] = min(costs.get(rate, np.inf), -np.log(min(2 * share, 0.5)))
        while True:
            found = {Fraction(0): 0.0}
            fresh = dict(found)
            while fresh:
                new: dict[Fraction, float] = {}
                for at, spent in fresh.items():
                    for rate, cost in costs.items():
                        for to in (at + rate, at - rate):
                            if spent + cost <= budget and spent + cost < found.get(to, np.inf) - 1e-9:
                                found[to] = new[to] = spent + cost
                fresh = new
            if len(found) <= max(most, 3):
                return sorted(found)
            budget *= 0.9

    def series(self, values: NDArray[np.generic], orders: list[Fraction]) -> dict[Fraction, Complex]:
        """Fourier coefficients (speed, …) of samples (speed, time, …), at those of ``orders`` that they resolve."""
        found = np.fft.fft(values, axis=1) / values.shape[1]
        kept: dict[Fraction, Complex] = {}
        for order in orders:
            h = order / self.step
            if h.denominator == 1 and 2 * abs(h) < max(values.shape[1], 1):
                part = found[:, int(h) % values.shape[1]]
                if np.nanmax(np.abs(part), initial=0.0) > 1e-17 * np.nanmax(np.abs(found), initial=0.0):
                    kept[order] = part
        return kept


def size_of(line: Steady, mass: int, shake: Shake, speed: Array) -> Array:
    """A (speed,) [N m]."""
    if shake.over == "speed":
        return np.interp(speed * line.turning[mass], shake.points, shake.amplitudes)
    if shake.over == "torque":
        return np.interp(-line.loads(speed)[:, mass], shake.points, shake.amplitudes)
    by = (speed * line.turning[mass]) ** 2 if shake.over == "square" else 1.0
    return shake.amplitude * by * np.ones(len(speed))
