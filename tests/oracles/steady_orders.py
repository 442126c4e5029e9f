"""The linear steady response of a ``ScannedLine`` by order, from equations written here alone.

Mass i turns by a_i, link e leads from mass n to mass f. What arrives at the spring's near end is n_e(a_n): behind a
Hooke's joint tan ψ = tan χ/cos β, its output fork a quarter turn on, then over the ratio. With r = dn_e/da_n,
r′ = dr/da_n and the elastic twist x_e (the error of the teeth over the driven radius included), Lagrange gives

    J_i ä_i = −M_i + Σ_near r f − Σ_far f + torques,   f = k w x + c ẋ   (w: the uneven stiffness of a mesh)

About a base motion: δ_i, x = δ_f − r δ_n, ẋ = δ̇_f − r δ̇_n − r′ ȧ_n δ_n, and the near end gets r f̃ + r′ f̄ δ_n. The
base of a driven line turns without vibrating, its springs twisted by the mean torque; what it leaves over shakes the
line. A bent line that starts free is taken about its periodic motion, found by collocation.

Everything is a series e^{i(K + h)Ωt}, h in the lattice of the joints' and teeth's rates, K the order that shakes.
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
Order = tuple[Fraction, float]
"""Cycles per turn of the input, and a frequency [rad/s] beside them."""


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


@dataclass(frozen=True)
class Response:
    """Amplitudes by order (speed, ·) of springs' twist and torque and of masses' rotation; mean twist and torque
    (speed, spring)."""

    speed: Array
    twist: dict[Order, Complex]
    torque: dict[Order, Complex]
    rotation: dict[Order, Complex]
    mean_twist: Array
    mean_torque: Array


class Steady:
    """One line, under one load case."""

    def __init__(self, line: ScannedLine) -> None:
        self.line, self.n = line, len(line.masses)
        self.links = [(i, link) for i, link in enumerate(line.links) if link is not None]
        self.over = [self._over(link) for _, link in self.links]
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
        return (OF_ORBITS if self.moves else PER_CYCLE) * int(fastest) if self.joint_rates else 1

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
            from oracles.own_orbits import orbit

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
        logarithm of what it passes on, up to ``budget``; fewer until no more than ``most``."""
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

    def response(self, speed: Array, budget: float, most: int) -> Response:
        """At ``speed`` (speed,) [rad/s]; ``budget`` and ``most`` as of ``lattice``."""
        return _Solved(self, speed, self.lattice(budget, most)).response()


def size_of(line: Steady, mass: int, shake: Shake, speed: Array) -> Array:
    """A (speed,) [N m]."""
    if shake.over == "speed":
        return np.interp(speed * line.turning[mass], shake.points, shake.amplitudes)
    if shake.over == "torque":
        return np.interp(-line.loads(speed)[:, mass], shake.points, shake.amplitudes)
    by = (speed * line.turning[mass]) ** 2 if shake.over == "square" else 1.0
    return shake.amplitude * by * np.ones(len(speed))


class _Solved:
    """A line at some speeds, its equations as series over ``orders``."""

    def __init__(self, steady: Steady, speed: Array, orders: list[Fraction], *, rigid: bool = False) -> None:
        self.steady, self.speed, self.orders = steady, speed, orders
        self.n, self.springs = steady.n, steady.springs()
        base = self.base = steady.base(speed, rigid=rigid)
        damping, stiffness, left = steady.equations(base)
        left = left - steady.constant_loads(speed)[:, None]
        steps = sorted({a - b for a in orders for b in orders})
        self.inertia = np.array([m.inertia for m in steady.line.masses])
        self.damping = steady.series(damping, steps)
        self.stiffness = steady.series(stiffness, steps)
        self.ratio = steady.series(base.ratio, steps)
        self.left = steady.series(left, orders)
        carried = steady.carried(speed)
        self.waves: dict[int, dict[Fraction, complex]] = {}
        for e, (_, link) in enumerate(steady.links):
            for share, order, phase in link.waves:
                rate, half = steady.teeth[e] * order, share / 2 * np.exp(1j * phase)
                own = self.waves.setdefault(e, {})
                for sign, part in ((1, half), (-1, np.conj(half))):
                    own[sign * rate] = own.get(sign * rate, 0) + part
            out = steady.pattern(e)
            for rate, part in self.waves.get(e, {}).items():
                k = self.springs[0][e] * part * np.outer(out, out)
                self.stiffness[rate] = self.stiffness.get(rate, np.zeros((len(speed), self.n, self.n), complex)) + k
                force = -carried[:, [e]] * part * out
                self.left[rate] = self.left.get(rate, np.zeros((len(speed), self.n), complex)) + force

    def matrix(self, s: Complex) -> Complex:
        """(speed, h n, h n) at s (speed, h) [1/s]."""
        count, n = len(self.orders), self.n
        found = np.zeros((len(s), count, n, count, n), dtype=complex)
        place = {order: h for h, order in enumerate(self.orders)}
        for step in {*self.damping, *self.stiffness}:
            c, k = self.damping.get(step), self.stiffness.get(step)
            for order, h in place.items():
                if (g := place.get(order - step)) is not None:
                    if c is not None:
                        found[:, h, :, g, :] += s[:, g, None, None] * c
                    if k is not None:
                        found[:, h, :, g, :] += k
        for h in range(count):
            for i in range(n):
                found[:, h, i, h, i] += s[:, h] ** 2 * self.inertia[i]
            for e in np.flatnonzero(self.springs[2]):
                out = self.steady.pattern(e)
                found[:, h, :, h, :] += (
                    1j * self.springs[2][e] * np.sign(s[:, h].imag)[:, None, None] * np.outer(out, out)
                )
        return found.reshape(len(s), count * n, count * n)

    def slope(self, s: Complex) -> Complex:
        """Of the matrix by s, of lines without loss at all frequencies."""
        count, n = len(self.orders), self.n
        found = np.zeros((len(s), count, n, count, n), dtype=complex)
        place = {order: h for h, order in enumerate(self.orders)}
        for step, c in self.damping.items():
            for order, h in place.items():
                if (g := place.get(order - step)) is not None:
                    found[:, h, :, g, :] += c
        for h in range(count):
            for i in range(n):
                found[:, h, i, h, i] += 2 * s[:, h] * self.inertia[i]
        return found.reshape(len(s), count * n, count * n)

    def solve(self, carrier: Fraction, frequency: float, right: dict[int, Complex]) -> Complex:
        """δ (speed, h, n) under forces ``right`` (speed, n) by place among the orders."""
        count, n = len(self.orders), self.n
        turning = np.array([float(carrier + order) for order in self.orders])
        matrix = self.matrix(1j * (self.speed[:, None] * turning + frequency))
        force = np.zeros((len(self.speed), count, n), dtype=complex)
        for h, part in right.items():
            force[:, h] += part
        force = force.reshape(len(self.speed), -1)
        still = np.flatnonzero((turning == 0) & (frequency == 0))
        if self.steady.line.free and len(still):
            # Nothing holds the line as a whole: the drive gives what keeps the mean speed, its mean angle stays.
            first = int(still[0]) * n
            size = matrix.shape[1]
            more = np.zeros((len(matrix), size + 1, size + 1), dtype=complex)
            more[:, :size, :size] = matrix
            scale = np.abs(matrix).max()
            more[:, first, size] = more[:, size, first] = scale
            force = np.concatenate([force, np.zeros((len(force), 1))], axis=1)
            return np.linalg.solve(more, force[..., None])[:, :size, 0].reshape(-1, count, n)
        return np.linalg.solve(matrix, force[..., None])[..., 0].reshape(-1, count, n)

    def response(self) -> Response:
        """Every cause added up by order."""
        steady, springs = self.steady, len(self.steady.links)
        zero = np.zeros((len(self.speed), springs))
        self.twist: dict[Order, Complex] = {}
        self.torque: dict[Order, Complex] = {}
        self.rotation: dict[Order, Complex] = {}
        self.means = [zero.copy(), zero.copy()]
        self._add_base()
        place = {order: h for h, order in enumerate(self.orders)}
        own = {place[o]: part for o, part in self.left.items() if o in place}
        if not steady.moves and (steady.joint_rates or self.waves):
            self._take(Fraction(0), 0.0, self.solve(Fraction(0), 0.0, own), {})
        turned = self.base.angle - steady.level - self._uniform
        for i, mass in enumerate(steady.line.masses):
            for shake in mass.shakes:
                order, sense = shake.order, steady.sense[i]
                size = size_of(steady, i, shake, self.speed) * np.exp(1j * shake.phase) * sense
                follows = np.exp(1j * float(order) * sense * turned[..., i]) if not shake.frequency else np.ones((1, 1))
                right: dict[int, Complex] = {}
                for o, part in steady.series(follows * np.ones(turned.shape[:2]), self.orders).items():
                    right[place[o]] = np.zeros((len(self.speed), self.n), complex)
                    right[place[o]][:, i] = size * part
                carrier = order * abs(steady.mean_ratio[i])
                self._take(carrier, shake.frequency, self.solve(carrier, shake.frequency, right), {})
        for e, (_, link) in enumerate(steady.links):
            for size, order, phase in link.errors:
                self._tooth_error(e, steady.teeth[e] * order, size / link.radius * np.exp(1j * phase))
        return Response(self.speed, self.twist, self.torque, self.rotation, *self.means)

    @property
    def _uniform(self) -> Array:
        times = self.base.angle.shape[1]
        turned = 2 * np.pi / float(self.steady.step) * np.arange(times) / times
        return turned[:, None] * np.array([float(r) for r in self.steady.mean_ratio])

    def _add_base(self) -> None:
        """How the base motion turns, and of a line that moves by itself how its springs twist."""
        steady, k = self.steady, self.springs[0]
        period = [
            m * self.steady.step for m in range(-self.base.angle.shape[1] // 2 + 1, self.base.angle.shape[1] // 2)
        ]
        turned = steady.series(self.base.angle - steady.level - self._uniform, period)
        for order, part in turned.items():
            if order:
                self._put(self.rotation, (order, 0.0), part)
        if steady.moves:
            from oracles.own_orbits import twists

            parts = steady.series(twists(steady, self.base), period), steady.series(self.base.torque, period)
            for mean, found, part in zip(self.means, (self.twist, self.torque), parts, strict=True):
                for order, one in part.items():
                    if order:
                        self._put(found, (order, 0.0), one)
                    else:
                        mean += one.real
        else:
            self.means[0] += steady.carried(self.speed) / k
            self.means[1] += steady.carried(self.speed)

    def _put(self, into: dict[Order, Complex], key: Order, part: Complex) -> None:
        order, frequency = key
        if not frequency and order < 0:
            key, part = (-order, 0.0), part.conj()
        into[key] = into.get(key, 0) + part

    def _tooth_error(self, e: int, carrier: Fraction, error: complex) -> None:
        k, c, _ = self.springs
        out, place = self.steady.pattern(e), {order: h for h, order in enumerate(self.orders)}
        through = k[e] + 1j * float(carrier) * self.speed * c[e]
        right = {place[Fraction(0)]: -through[:, None] * error * out}
        for rate, part in self.waves.get(e, {}).items():
            if rate in place:
                right[place[rate]] = np.ones((len(self.speed), 1)) * (-k[e] * part * error * out)
        self._take(carrier, 0.0, self.solve(carrier, 0.0, right), {e: error})

    def _take(self, carrier: Fraction, frequency: float, x: Complex, errors: dict[int, complex]) -> None:
        """Add up twists and torques of a solution."""
        place = {order: h for h, order in enumerate(self.orders)}
        twist = np.zeros((len(self.speed), len(self.orders), len(self.steady.links)), dtype=complex)
        for e, (far, link) in enumerate(self.steady.links):
            twist[..., e] += x[..., far]
            if link.near >= 0:
                for step, part in self.ratio.items():
                    for order, h in place.items():
                        if (g := place.get(order - step)) is not None:
                            twist[:, h, e] -= part[:, e] * x[:, g, link.near]
        for e, error in errors.items():
            twist[:, place[Fraction(0)], e] += error
        turning = np.array([float(carrier + order) for order in self.orders])
        nu = self.speed[:, None] * turning + frequency
        k, c, loss = self.springs
        torque = (k + 1j * nu[..., None] * c + 1j * np.sign(nu)[..., None] * loss) * twist
        for e, own in self.waves.items():
            for rate, part in own.items():
                for order, h in place.items():
                    if (g := place.get(order - rate)) is not None:
                        torque[:, h, e] += k[e] * part * twist[:, g, e]
                    if carrier == 0 and not frequency and not errors and order == rate:
                        torque[:, h, e] += self.steady.carried(self.speed)[:, e] * part
        for order, h in place.items():
            if carrier + order == 0 and not frequency:
                self.means[0] += twist[:, h].real
                self.means[1] += torque[:, h].real
                continue
            self._put(self.twist, (carrier + order, frequency), twist[:, h])
            self._put(self.torque, (carrier + order, frequency), torque[:, h])
            self._put(self.rotation, (carrier + order, frequency), x[:, h])
