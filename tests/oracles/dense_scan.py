"""The largest values of a ``ScannedLine`` over its speeds, by looking closely everywhere.

Poles come from the line's own matrices: those of their mean, then by inverse iteration of Hill's. Wherever a pole meets
an order that acts, 40 speeds lie within its half-power width; a plain grid covers the rest. A scan with few harmonics
finds the places, the values there are computed with many.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import log

import numpy as np
from numpy.typing import NDArray

from oracles.line_equations import WIDEST, Steady, common
from oracles.scanned_lines import ScannedLine
from oracles.steady_orders import Order, Response, Solved, response

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
PER_WIDTH = 40
BESIDE = 0.6
"""Half-power widths on each side of a meeting."""
PLAIN = 300
WORTH = 0.6
"""Share of the largest value above which a meeting is looked at closely: at the meeting itself it is near its top."""
FEW, MANY = (log(1e4), 15), WIDEST
"""Budgets and most orders of the lattice, of the scan and of the values."""
FINE = 64
"""Samples of a joint's cycle of the motion of a line that moves by itself, of the values."""
ROUNDS, HIGHEST, CLOSER = 4, 4, 4
"""Of lines that joints or meshes vary: how often one looks closer, at how many high places, at how many speeds between
neighbours."""
BATCH = 2_000_000
FREE_FREQUENCY = 20 * np.pi
"""10 Hz, up to which S_f is 1."""


@dataclass(frozen=True)
class Sum:
    """Mean (speed,) and amplitudes by order (speed,) of one quantity, all of it scaled."""

    mean: Array
    parts: dict[Order, Complex]

    @property
    def bound(self) -> Array:
        """What amplitudes add up to."""
        return sum((np.abs(part) for part in self.parts.values()), np.zeros(len(self.mean)))

    def at(self, which: NDArray[np.intp]) -> Sum:
        """At some of the speeds."""
        return Sum(self.mean[which], {order: part[which] for order, part in self.parts.items()})

    def extremes(self) -> tuple[Array, Array]:
        """Lowest and highest (speed,) over the cycle; what is fixed in time has no phase to the turns: a bound."""
        turning = {order: part for (order, frequency), part in self.parts.items() if not frequency}
        beside = sum((np.abs(part) for (_, f), part in self.parts.items() if f), np.zeros(len(self.mean)))
        if not turning:
            return self.mean - beside, self.mean + beside
        step = common(list(turning))
        index = np.array([int(order / step) for order in turning])
        rows = np.stack(list(turning.values()), axis=1)
        return self.mean - _highest(index, -rows) - beside, self.mean + _highest(index, rows) + beside


def _highest(index: NDArray[np.intp], rows: Complex) -> Array:
    """Largest value of Σ Re[row_k e^{i index_k x}]: samples, then Newton's steps from every peak that may be it."""
    count = 1 << int(np.ceil(np.log2(24 * index.max())))
    spectrum = np.zeros((len(rows), count // 2 + 1), dtype=complex)
    spectrum[:, index] = rows / 2
    samples = np.fft.irfft(spectrum, count, norm="forward")
    peak = np.empty(samples.shape, dtype=bool)
    peak[:, 1:-1] = (samples[:, 1:-1] >= samples[:, :-2]) & (samples[:, 1:-1] >= samples[:, 2:])
    peak[:, [0, -1]] = True
    tops = np.where(peak, samples, -np.inf)
    best = samples.max(axis=1)
    every = np.arange(len(rows))
    below = (np.pi / count) ** 2 / 2 * (index**2 * np.abs(rows)).sum(axis=1)  # a sample, of the peak beside it
    while (tops.max(axis=1) >= best - below).any():
        place = tops.argmax(axis=1)
        tops[every, place] = -np.inf
        x = place * (2 * np.pi / count)
        for _ in range(5):
            wave = rows * np.exp(1j * index * x[:, None])
            rate, bend = -(index * wave.imag).sum(axis=1), -(index**2 * wave.real).sum(axis=1)
            x = x + np.clip(
                np.where(bend < 0, -rate / np.where(bend < 0, bend, 1.0), 0.0), -0.2 / index.max(), 0.2 / index.max()
            )
        best = np.maximum(best, (rows * np.exp(1j * index * x[:, None])).real.sum(axis=1))
    return best


@dataclass(frozen=True)
class Quantity:
    """Something of which ``assess`` looks for the largest value: the name of its check, and how it is read from a
    response: ``sums`` gives what varies; ``of``: "peak", "swing", "swing over mean" or "number"."""

    name: str
    of: str
    sums: Callable[[Response], Sum]

    def bound(self, response: Response) -> Array:
        """No less than its values (speed,)."""
        found = self.sums(response)
        if self.of == "peak":
            return np.abs(found.mean) + found.bound
        return np.abs(found.mean) if self.of == "number" else found.bound / self._over(found)

    def values(self, response: Response, which: NDArray[np.intp] | None = None) -> Array:
        """At some of the speeds, all by default."""
        found = self.sums(response)
        found = found if which is None else found.at(which)
        if self.of == "number":
            return np.abs(found.mean)
        low, high = found.extremes()
        if self.of == "peak":
            return np.maximum(np.abs(low), np.abs(high))
        return (high - low) / 2 / self._over(found)

    def _over(self, found: Sum) -> Array:
        return np.abs(found.mean) if self.of == "swing over mean" else np.ones(len(found.mean))


def quantities(line: ScannedLine) -> Iterator[Quantity]:
    """Everything that the description limits."""
    k, c, loss = Steady(line).springs()
    place = 0
    for i, link in enumerate(line.links):
        if link is None:
            continue
        e, name, place = place, f"s{i}", place + 1
        if link.kind == "mesh":
            yield Quantity(f"gear hammer in {name}", "swing over mean", _torque(e))
        yield Quantity(f"max torque of {name}", "peak", _torque(e))
        yield Quantity(f"vibratory torque of {name}", "swing", _torque(e))
        if link.kind != "mesh":
            yield Quantity(f"max twist of {name}", "peak", _twist(e))
        if link.kind == "tube":
            outer, inner, _ = link.tube
            yield Quantity(f"max stress of {name}", "peak", _torque(e, 16 * outer / np.pi / (outer**4 - inner**4)))
        if link.kind == "coupling":
            yield Quantity(f"nominal torque rating of {name}", "number", _mean(e, 1.3))
            yield Quantity(f"maximum torque rating of {name}", "peak", _torque(e, 1.3 * 1.1))
            yield Quantity(f"rated torque of {name}", "number", _rated(e))
            yield Quantity(f"heat rating of {name}", "number", _heat(e, 1.3, c[e], loss[e]))
    for i in range(len(line.masses)):
        yield Quantity(f"max speed fluctuation of m{i}", "swing", _motion(i, 1))
        yield Quantity(f"max acceleration of m{i}", "swing", _motion(i, 2))


def _nu(response: Response, order: Order) -> Array:
    return float(order[0]) * response.speed + order[1]


def _torque(e: int, scale: float = 1.0) -> Callable[[Response], Sum]:
    return lambda r: Sum(scale * r.mean_torque[:, e], {o: scale * part[:, e] for o, part in r.torque.items()})


def _twist(e: int) -> Callable[[Response], Sum]:
    return lambda r: Sum(r.mean_twist[:, e], {o: part[:, e] for o, part in r.twist.items()})


def _motion(i: int, rates: int) -> Callable[[Response], Sum]:
    return lambda r: Sum(
        np.zeros(len(r.speed)), {o: (1j * _nu(r, o)) ** rates * part[:, i] for o, part in r.rotation.items()}
    )


def _mean(e: int, scale: float) -> Callable[[Response], Sum]:
    return lambda r: Sum(scale * np.abs(r.mean_torque[:, e]), {})


def _rated(e: int) -> Callable[[Response], Sum]:
    def number(r: Response) -> Sum:
        sizes = [
            np.sqrt(np.maximum(np.abs(_nu(r, o)), FREE_FREQUENCY) / FREE_FREQUENCY) * np.abs(part[:, e])
            for o, part in r.torque.items()
        ]
        return Sum(sum(sizes, np.zeros(len(r.speed))), {})

    return number


def _heat(e: int, scale: float, damping: float, loss: float) -> Callable[[Response], Sum]:
    def number(r: Response) -> Sum:
        powers = [
            (damping * _nu(r, o) ** 2 + loss * np.abs(_nu(r, o))) / 2 * np.abs(part[:, e]) ** 2
            for o, part in r.twist.items()
        ]
        return Sum(scale * sum(powers, np.zeros(len(r.speed))), {})

    return number


@dataclass(frozen=True)
class Meetings:
    """Speeds (meeting,) [rad/s] at which a pole meets an order that acts, and half-power widths (meeting,) there."""

    speed: Array
    width: Array


class Scan:
    """One line under one load case, over a range of speeds less what is ``left_out``."""

    def __init__(self, line: ScannedLine, low: float, high: float, left_out: tuple[tuple[float, float], ...]) -> None:
        self.line, self.low, self.high, self.left_out = line, low, high, left_out
        self.steady, self.fine = Steady(line), Steady(line, FINE)
        self.quantities = list(quantities(line))
        self.lost = np.zeros(0)
        """Speeds [rad/s] of the last scan at which a line that moves by itself has no motion that is found."""

    def respond(self, speed: Array, effort: tuple[float, int] = FEW) -> Response:
        """In parts that fit the memory."""
        steady = self.steady if effort is FEW else self.fine
        size = (len(steady.lattice(*effort)) * steady.n) ** 2 + steady.samples * steady.n**2
        size += (steady.samples * steady.n) ** 2 * 3 if steady.moves else 0
        many = max(1, BATCH // size)
        parts = [response(steady, speed[i : i + many], *effort) for i in range(0, len(speed), many)]
        return _joined(parts)

    def kept(self, speed: Array) -> Array:
        """Those within the range that are not left out."""
        out = np.zeros(len(speed), dtype=bool)
        for a, b in self.left_out:
            out |= (speed > a * (1 + 1e-7)) & (speed < b * (1 - 1e-7))
        return speed[~out & (speed >= self.low) & (speed <= self.high)]

    @property
    def plain(self) -> Array:
        """Even speeds, ends, edges of what is left out and kinks of tables included."""
        kinks = [p / t for m, t in zip(self.line.masses, self.steady.turning, strict=True) for s in m.shakes
                 if s.over == "speed" for p in s.points]  # fmt: skip
        kinks += [p for one in self.line.links if one is not None and one.scheduled for p in one.scheduled[0]]
        edges = [one for a, b in self.left_out for one in (a * (1 - 1e-7), b * (1 + 1e-7))]
        even = [np.linspace(self.low, self.high, PLAIN), np.geomspace(self.low, self.high, PLAIN // 3)]
        return self.kept(np.unique(np.concatenate([*even, kinks, edges])))

    def acting(self) -> set[Fraction]:
        """Orders at which anything shakes the line, those that joints and teeth make of it included."""
        beside = self.steady.lattice(*FEW)
        orders = set(beside) if self.steady.joint_rates or any(one.waves for _, one in self.steady.links) else set()
        for i, mass in enumerate(self.line.masses):
            for shake in mass.shakes:
                orders |= {shake.order * abs(self.steady.mean_ratio[i]) + o for o in beside}
        for e, (_, link) in enumerate(self.steady.links):
            orders |= {self.steady.teeth[e] * order + o for _, order, _ in link.errors for o in beside}
        return {abs(order) for order in orders} - {Fraction(0)}

    def poles(self, speed: Array) -> tuple[Complex, Complex]:
        """Of the mean matrices, those that swing: (speed, pole) [1/s] by frequency, and shapes (speed, n, pole)."""
        solved, n = Solved(self.steady, speed, [Fraction(0)], rigid=True), self.steady.n
        a = np.zeros((len(speed), 2 * n, 2 * n), dtype=complex)
        zero = np.zeros((len(speed), n, n))
        stiffness = solved.stiffness[Fraction(0)] + sum(
            (1j * solved.springs[2][e] * np.outer(p, p) for e in range(len(solved.springs[2]))
             for p in [self.steady.pattern(e)]), zero)  # fmt: skip
        a[:, :n, n:] = np.eye(n)
        a[:, n:, :n] = -stiffness / solved.inertia[:, None]
        a[:, n:, n:] = -solved.damping.get(Fraction(0), zero) / solved.inertia[:, None]
        values, vectors = np.linalg.eig(a)
        order = np.argsort(-values.imag, axis=1)[:, : n - (1 if self.line.free else 0)][:, ::-1]
        return np.take_along_axis(values, order, 1), np.take_along_axis(vectors[:, :n], order[:, None], 2)

    def meetings(self) -> Meetings:
        """Of every pole with every order that acts, first of the mean matrices, then of Hill's."""
        grid = np.linspace(self.low, self.high, 60)
        poles, shapes = self.poles(grid)
        found = []
        for order in self.acting():
            off = poles.imag - float(order) * grid[:, None]
            place, mode = np.nonzero((off[1:] > 0) != (off[:-1] > 0))
            share = off[place, mode] / (off[place, mode] - off[place + 1, mode])
            speed = grid[place] + share * (grid[1] - grid[0])
            found += [
                (float(order), s, poles[p, m], shapes[p, :, m]) for s, p, m in zip(speed, place, mode, strict=True)
            ]
        if not found:
            return Meetings(np.zeros(0), np.zeros(0))
        order, speed = np.array([one[0] for one in found]), np.array([one[1] for one in found])
        value, shape = np.array([one[2] for one in found]), np.array([one[3] for one in found])
        first, width = speed.copy(), -2 * value.real / order
        if len(self.steady.lattice(*FEW)) > 1:
            for _ in range(3):
                value = self._followed(speed, value, shape)
                new = value.imag / order
                speed = np.where(np.isfinite(new) & (np.abs(new / first - 1) < 0.1), new, speed)
            width = np.maximum(-2 * value.real / order, width / 4)
        both = np.concatenate([first, speed]), np.concatenate([width, width])
        inside = (both[0] > self.low - both[1]) & (both[0] < self.high + both[1]) & np.isfinite(both[1])
        return Meetings(both[0][inside], both[1][inside])

    def _followed(self, speed: Array, value: Complex, shape: Complex) -> Complex:
        """Poles of Hill's matrix (pole,) near ``value``, each at its own speed, by inverse iteration."""
        orders, n = self.steady.lattice(*FEW), self.steady.n
        found = value.copy()
        for begin in range(0, len(speed), 40):
            part = slice(begin, begin + 40)
            solved = Solved(self.steady, speed[part], orders)
            turning = np.array([float(order) for order in orders]) * speed[part, None]
            s = value[part].copy()
            u = np.zeros((len(s), len(orders), n), dtype=complex)
            u[:, orders.index(Fraction(0))] = shape[part]
            u = u.reshape(len(s), -1)
            for _ in range(4):
                at = s[:, None] + 1j * turning
                matrix, slope = solved.matrix(at), solved.slope(at)
                new = np.full(u.shape, np.nan, dtype=complex)
                known = ~solved.lost
                new[known] = np.linalg.solve(matrix[known], slope[known] @ u[known][..., None])[..., 0]
                with np.errstate(invalid="ignore", divide="ignore"):  # where no motion was found
                    s = s - (u.conj() * u).sum(axis=1) / (u.conj() * new).sum(axis=1)
                    u = new / np.linalg.norm(new, axis=1)[:, None]
            found[part] = s
        return found

    def largest(self) -> dict[str, tuple[float, float]]:
        """Largest value by name, and its speed [rad/s]."""
        met = self.meetings()
        three = (met.speed[:, None] + met.width[:, None] * np.array([-0.4, 0.0, 0.4])).ravel()
        rough = np.unique(np.concatenate([self.plain, self.kept(three)]))
        seen = self.respond(rough)
        close = met.speed[self._worth(seen, met)]
        width = met.width[self._worth(seen, met)]
        steps = np.arange(-round(PER_WIDTH * BESIDE), round(PER_WIDTH * BESIDE) + 1) / PER_WIDTH
        more = np.setdiff1d(self.kept((close[:, None] + width[:, None] * steps).ravel()), rough)
        seen = _joined([seen, self.respond(more)]) if len(more) else seen
        if self.steady.moves or len(self.steady.lattice(*FEW)) > 1:
            seen = self._closer(seen)
        self.lost = np.sort(seen.speed[np.isnan(seen.mean_torque).any(axis=1)])
        tops = {one.name: self._tops(one, seen) for one in self.quantities}
        wanted = np.unique(np.concatenate(list(tops.values())))
        exact = self.respond(seen.speed[wanted], MANY)
        found = {}
        for one in self.quantities:
            which = np.searchsorted(wanted, tops[one.name])
            values = one.values(exact, which)
            best = int(np.argmax(np.where(np.isfinite(values), values, -np.inf)))
            found[one.name] = float(values[best]), float(exact.speed[which[best]])
        return found

    def _closer(self, seen: Response) -> Response:
        """With more speeds about every high place: what varies a line shifts poles farther than they are followed."""
        for _ in range(ROUNDS):
            order = np.argsort(seen.speed)
            x, between = seen.speed[order], set()
            for one in self.quantities:
                v = np.nan_to_num(one.bound(seen)[order], nan=-np.inf)
                around = np.pad(v, 1, constant_values=-np.inf)
                high = np.flatnonzero((v >= around[:-2]) & (v >= around[2:]) & (v >= v.max() / 10))
                between |= {*high[np.argsort(-v[high])[:HIGHEST]].tolist()}
            last = len(x) - 1
            more = [np.linspace(x[max(i - 1, 0)], x[min(i + 1, last)], 2 * CLOSER + 1) for i in sorted(between)]
            fresh = np.setdiff1d(self.kept(np.concatenate([np.zeros(0), *more])), x)
            fresh = fresh[np.diff(fresh, prepend=0.0) > 1e-9 * fresh]
            if not len(fresh):
                break
            seen = _joined([seen, self.respond(fresh)])
        return seen

    def _worth(self, seen: Response, met: Meetings) -> NDArray[np.bool_]:
        """Meetings at which anything comes near its largest value."""
        found = np.zeros(len(met.speed), dtype=bool)
        order = np.argsort(seen.speed)
        near = [np.clip(np.searchsorted(seen.speed[order], met.speed + s * met.width), 0, len(order) - 1)
                for s in (-0.4, 0.0, 0.4)]  # fmt: skip
        for one in self.quantities:
            bound = one.bound(seen)[order]
            there = np.max([bound[place] for place in near], axis=0)
            found |= there >= WORTH * np.nanmax(bound)
        return found

    def _tops(self, one: Quantity, seen: Response) -> NDArray[np.intp]:
        """Places of the highest values: the largest, and up to three others as high within the scan's own error."""
        bound = one.bound(seen)
        order = np.argsort(-np.where(np.isfinite(bound), bound, -np.inf))
        value = np.full(len(bound), -np.inf)
        best = -np.inf
        for start in range(0, len(order), 64):
            part = order[start : start + 64]
            if bound[part[0]] < best or not np.isfinite(bound[part[0]]):
                break
            value[part] = one.values(seen, part)
            best = max(best, float(np.nanmax(value[part])))
        by_speed = np.argsort(seen.speed)
        v = value[by_speed]
        beside = np.maximum(np.concatenate([[-np.inf], v[:-1]]), np.concatenate([v[1:], [-np.inf]]))
        peaks = by_speed[(v >= beside) & (v >= best * (1 - 2e-3))]
        return peaks[np.argsort(-value[peaks])[:4]]

    def at(self, speed: float) -> dict[str, float]:
        """All values at one speed [rad/s], with many harmonics."""
        seen = self.respond(np.array([speed]), MANY)
        return {one.name: float(one.values(seen)[0]) for one in self.quantities}


def _joined(parts: list[Response]) -> Response:
    def together(name: str) -> dict[Order, Complex]:
        keys = {key for part in parts for key in getattr(part, name)}
        width = next((v.shape[1] for part in parts for v in getattr(part, name).values()), 0)
        return {
            key: np.concatenate(
                [
                    np.broadcast_to(getattr(p, name).get(key, np.zeros((1, width), complex)), (len(p.speed), width))
                    for p in parts
                ]
            )
            for key in keys
        }

    return Response(
        np.concatenate([part.speed for part in parts]), together("twist"), together("torque"), together("rotation"),
        np.concatenate([part.mean_twist for part in parts]), np.concatenate([part.mean_torque for part in parts]),
    )  # fmt: skip
