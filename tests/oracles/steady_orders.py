"""The linear steady response of a ``ScannedLine`` by order: Hill's series of the equations of ``line_equations``.

Everything is a series e^{i(K + h)Ωt}, h in the lattice of the joints' and teeth's rates, K the order that shakes.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from oracles.line_equations import Steady, size_of

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Order = tuple[Fraction, float]
"""Cycles per turn of the input, and a frequency [rad/s] beside them."""


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


def response(line: Steady, speed: Array, budget: float, most: int) -> Response:
    """At ``speed`` (speed,) [rad/s]; ``budget`` and ``most`` as of ``Steady.lattice``."""
    return Solved(line, speed, line.lattice(budget, most)).response()


class Solved:
    """A line at some speeds, its equations as series over ``orders``."""

    def __init__(self, steady: Steady, speed: Array, orders: list[Fraction], *, rigid: bool = False) -> None:
        self.steady, self.speed, self.orders = steady, speed, orders
        self.n, self.springs = steady.n, steady.springs()
        base = self.base = steady.base(speed, rigid=rigid)
        self.lost = np.isnan(base.angle).any(axis=(1, 2))
        """Speeds at which a line that moves by itself has no motion that is found."""
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
            return self._solved(more, force)[:, :size].reshape(-1, count, n)
        return self._solved(matrix, force).reshape(-1, count, n)

    def _solved(self, matrix: Complex, force: Complex) -> Complex:
        """Where there is no motion to linearise about, nothing: NaN."""
        found = np.full(force.shape, np.nan, dtype=complex)
        there = ~self.lost
        found[there] = np.linalg.solve(matrix[there], force[there][..., None])[..., 0]
        return found

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
            from oracles.free_orbits import twists

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
