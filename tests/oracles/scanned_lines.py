"""Random lines for the dense scan of ``assess``: plain numbers, and the description that a user would write of them.

A line is a tree of masses. Each mass but a free root hangs on an earlier one (−1: the input, which turns as prescribed)
by a link: a Hooke's joint, then a ratio, then a spring; or a mesh of gears.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

import trunnion as tn

Array = NDArray[np.float64]
SMALL = 1e-6
"""Limits so small that every one is exceeded: the worst of several load cases is then the largest value."""


@dataclass(frozen=True)
class Shake:
    """A torque A cos(order · own rotation + phase), or of a ``frequency`` [rad/s]; ``over`` "speed" or "torque": a
    table of ``points`` and ``amplitudes`` for A, "square": A over the square of the mass's speed."""

    order: Fraction
    amplitude: float
    phase: float
    frequency: float = 0.0
    over: str = ""
    points: tuple[float, ...] = ()
    amplitudes: tuple[float, ...] = ()

    @property
    def described(self) -> dict[str, Any]:
        """As ``tn.Disk`` takes it."""
        found: dict[str, Any] = {"phase": self.phase}
        found |= {"frequency": self.frequency} if self.frequency else {"order": float(self.order)}
        if self.over in ("speed", "torque"):
            return found | {f"{self.over}s": list(self.points), "amplitudes": list(self.amplitudes)}
        return found | {"quadratic_amplitude" if self.over == "square" else "amplitude": self.amplitude}


@dataclass(frozen=True)
class Mass:
    """Inertia [kg m²]; torque that resists: ``load`` + ``viscous`` v + ``quadratic`` v|v|; what shakes it."""

    inertia: float
    load: float = 0.0
    viscous: float = 0.0
    quadratic: float = 0.0
    shakes: tuple[Shake, ...] = ()


@dataclass(frozen=True)
class Link:
    """What a mass hangs on.

    near: the earlier mass, −1 the input; angle, plane [rad]: of the joint (0: none), ``scheduled``: speeds [rad/s] and
    angles between which it is straight; ratio: input over output speed behind the joint; kind: "shaft", "coupling",
    "tube" or "mesh"; stiffness, damping, loss: of the spring, a mesh's by the line of action; fork [rad]; tube: outer
    and inner diameter, length [m]; teeth, module: of a mesh, waves (share, order, phase) of its stiffness, errors
    (amplitude, order, phase) of its teeth.
    """

    near: int
    stiffness: float
    damping: float
    kind: str = "shaft"
    angle: float = 0.0
    plane: float = 0.0
    scheduled: tuple[tuple[float, ...], tuple[float, ...]] | None = None
    ratio: Fraction = Fraction(1)
    loss: float = 0.0
    fork: float = 0.0
    tube: tuple[float, float, float] = (0.0, 0.0, 0.0)
    teeth: tuple[int, int] = (1, 1)
    module: float = 0.0
    waves: tuple[tuple[float, int, float], ...] = ()
    errors: tuple[tuple[float, int, float], ...] = ()

    @property
    def radius(self) -> float:
        """Base radius [m] of a mesh's driven gear."""
        return self.module * self.teeth[1] * np.cos(np.deg2rad(20.0)) / 2


@dataclass(frozen=True)
class ScannedLine:
    """A line, and the speeds [rad/s] that it is judged over; ``cases``: load torques by mass, of each load case."""

    kind: str
    masses: tuple[Mass, ...]
    links: tuple[Link | None, ...]
    low: float
    high: float
    cases: tuple[dict[int, float], ...] = ()
    schedule: tuple[float, float] | None = None

    @property
    def free(self) -> bool:
        """Whether it is free–free; its first mass drives it then."""
        return self.links[0] is None

    def loaded(self, case: dict[int, float]) -> ScannedLine:
        """Under a load case."""
        masses = tuple(replace(m, load=case.get(i, m.load)) for i, m in enumerate(self.masses))
        return replace(self, masses=masses, cases=())

    def unscheduled(self) -> ScannedLine:
        """As stated, its joints at their own angles."""
        links = tuple(None if one is None else replace(one, scheduled=None) for one in self.links)
        return replace(self, links=links, schedule=None)

    @property
    def driveline(self) -> tn.Driveline:
        """The same as a description, everything limited."""
        elements: list[Any] = [] if self.free else [tn.ConstantSpeed(name="input")]
        limits: list[tn.Limit] = []
        for i, (mass, link) in enumerate(zip(self.masses, self.links, strict=True)):
            if link is not None:
                elements += _described(link, i)
                limits += _of_spring(link, f"s{i}")
            elements.append(
                tn.Disk(
                    name=f"m{i}", inertia=mass.inertia, load_torque=mass.load, viscous_load=mass.viscous,
                    quadratic_load=mass.quadratic, drive_share=1.0 if link is None else 0.0,
                    excitation=[one.described for one in mass.shakes],
                )
            )  # fmt: skip
            limits.append(tn.Limit(of=f"m{i}", max_speed_fluctuation=SMALL, max_acceleration=SMALL))
        cases = [
            tn.LoadCase(name=f"case {k}", loads={f"m{i}": load for i, load in case.items()})
            for k, case in enumerate(self.cases)
        ]
        operation = tn.Operation(
            speed_range=(self.low, self.high), speed_unit="rad/s", load_cases=cases, schedules=self._schedules
        )
        return tn.Driveline(elements, limits=limits, operation=operation)

    @property
    def _schedules(self) -> list[tn.Schedule]:
        bent = {i: one.scheduled for i, one in enumerate(self.links) if one is not None and one.scheduled}
        if not bent:
            return []
        points = next(iter(bent.values()))[0]
        return [tn.Schedule(name="bend", speed=list(points), angles={f"j{i}": list(a) for i, (_, a) in bent.items()})]


def _described(link: Link, i: int) -> list[Any]:
    """Elements between a mass and the one before."""
    after = "input" if link.near < 0 else f"m{link.near}"
    found: list[dict[str, Any]] = []
    if link.angle or link.scheduled:
        found.append({"make": tn.HookeJoint, "angle": link.angle, "plane": link.plane, "name": f"j{i}"})
    if link.ratio != 1:
        found.append({"make": tn.Ratio, "ratio": float(link.ratio), "name": f"r{i}"})
    spring: dict[str, Any] = {"name": f"s{i}"}
    if link.kind == "mesh":
        spring |= {
            "make": tn.GearPair, "teeth_in": link.teeth[0], "teeth_out": link.teeth[1], "module": link.module,
            "mesh_stiffness": link.stiffness, "mesh_damping": link.damping,
            "stiffness_variation": [{"share": s, "order": o, "phase": p} for s, o, p in link.waves],
            "transmission_error": [{"amplitude": a, "order": o, "phase": p} for a, o, p in link.errors],
        }  # fmt: skip
    else:
        spring |= {"make": tn.Coupling if link.kind == "coupling" else tn.Shaft, "fork_offset": link.fork}
        spring |= {"loss_factor": link.loss} if link.loss else {"damping": link.damping}
        if link.kind == "tube":
            outer, inner, length = link.tube
            spring |= {"outer_diameter": outer, "inner_diameter": inner, "length": length, "shear_modulus": 79.3e9}
        else:
            spring |= {"stiffness": link.stiffness}
        if link.kind == "coupling":
            ratings = ("nominal_torque", "maximum_torque", "vibratory_torque", "heat_rating")
            spring |= dict.fromkeys(ratings, SMALL)
    found.append(spring)
    found[0]["after"] = after
    return [one.pop("make")(**one) for one in found]


def _of_spring(link: Link, name: str) -> list[tn.Limit]:
    own: dict[str, float] = {"max_torque": SMALL, "vibratory_torque": SMALL}
    if link.kind == "coupling":
        own |= {"temperature_factor": 1.3, "starting_factor": 1.1}
    if link.kind != "mesh":
        own |= {"max_twist": SMALL}
    if link.kind == "tube":
        own |= {"max_stress": SMALL}
    return [tn.Limit(of=name, **own)]


class _Drawn:
    """Random parts of one line."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng = rng
        self.ratio = 10 ** rng.uniform(np.log10(5e-4), np.log10(0.05))
        """Damping ratio of about all modes."""

    def between(self, low: float, high: float) -> float:
        return float(self.rng.uniform(low, high))

    def one_of(self, *choices: Any) -> Any:
        return choices[int(self.rng.integers(len(choices)))]

    def shakes(self, most: int, orders: tuple[Any, ...] = (0.5, 1, 1.5, 2, 3, 4)) -> tuple[Shake, ...]:
        chosen = self.rng.choice(len(orders), int(self.rng.integers(most + 1)), replace=False)
        return tuple(
            Shake(
                Fraction(str(orders[k])), self.between(5, 60), self.between(-3, 3), over=self.one_of("", "", "square")
            )
            if self.rng.random() < 0.3
            else Shake(Fraction(str(orders[k])), self.between(5, 60), self.between(-3, 3))
            for k in chosen
        )

    def mass(self, shakes: tuple[Shake, ...] = (), load: float = 0.0) -> Mass:
        viscous = load / 200 if load and self.rng.random() < 0.25 else 0.0
        quadratic = load / 2e4 if load and self.rng.random() < 0.25 else 0.0
        return Mass(10 ** self.between(-1.3, -0.2), load, viscous, quadratic, shakes)

    def spring(self, near: int, **more: Any) -> Link:
        """Damped so that a mode at 200 rad/s has about the line's damping ratio."""
        kind = self.one_of("shaft", "shaft", "coupling", "tube")
        stiffness, tube = 10 ** self.between(3.5, 4.5), (0.0, 0.0, 0.0)
        if kind == "tube":
            tube = (self.between(0.03, 0.045), self.between(0.0, 0.025), self.between(0.4, 1.2))
            stiffness = float(79.3e9 * np.pi / 32 * (tube[0] ** 4 - tube[1] ** 4) / tube[2])
        damping = 2 * self.ratio * self.between(0.5, 2.0) * stiffness / 200.0
        return Link(near, stiffness, damping, kind, fork=self.between(-3, 3), tube=tube, **more)

    def joint(self, steepest: float = 0.35) -> dict[str, float]:
        return {"angle": self.between(0.05, steepest), "plane": self.between(-3, 3)}

    def mesh(self, near: int) -> Link:
        teeth = self.one_of((12, 24), (18, 18), (20, 10), (16, 24))
        k = 10 ** self.between(7.0, 8.0)
        wave = ((self.between(0.02, 0.25), 1, self.between(-3, 3)),) if self.rng.random() < 0.8 else ()
        error = ((self.between(2e-6, 3e-5), 1, self.between(-3, 3)),)
        if self.rng.random() < 0.3:
            error += ((self.between(1e-6, 1e-5), 2, self.between(-3, 3)),)
        damping = 2 * max(self.ratio, 0.005) * k / 2000.0
        return Link(near, k, damping, "mesh", teeth=teeth, module=0.005, waves=wave, errors=error)


def _chain(d: _Drawn, count: int, free: bool) -> tuple[list[Mass], list[Link | None]]:
    """A straight chain, shaken at its first mass and somewhere else, loaded at its end."""
    masses = [d.mass(d.shakes(3))]
    links: list[Link | None] = [None if free else d.spring(-1)]
    for i in range(1, count):
        last = i == count - 1
        masses.append(d.mass(d.shakes(1), d.between(10, 80) if last else 0.0))
        links.append(d.spring(i - 1))
    if not any(m.shakes for m in masses):
        masses[0] = replace(masses[0], shakes=(Shake(Fraction(2), 30.0, 0.0),))
    return masses, links


def _bend(d: _Drawn, links: list[Link | None], most: int, steepest: float = 0.35) -> None:
    """One to ``most`` of the links behind the first mass get a joint, one in three a ratio as well."""
    places = [i for i, one in enumerate(links) if one is not None and one.near >= 0 and one.kind != "mesh"]
    chosen = d.rng.permutation(places)[: int(d.rng.integers(1, most + 1))]
    for i in chosen:
        one = links[i]
        assert one is not None
        more: dict[str, Any] = d.joint(steepest)
        if d.rng.random() < 0.33:
            more["ratio"] = Fraction(str(d.one_of(-2, 0.5, 2)))
        links[i] = replace(one, **more)


def _range(d: _Drawn, low: float = 20.0) -> tuple[float, float]:
    start = low * 10 ** d.between(0, 0.7)
    return start, start * 10 ** d.between(0.3, 0.8)


def straight(d: _Drawn) -> ScannedLine:
    """Driven or free, some with a torque fixed in time, some with loss at all frequencies."""
    masses, links = _chain(d, int(d.rng.integers(2, 6)), bool(d.rng.random() < 0.5))
    if d.rng.random() < 0.3:
        more = Shake(Fraction(0), d.between(5, 40), d.between(-3, 3), frequency=d.between(50, 400))
        masses[0] = replace(masses[0], shakes=(*masses[0].shakes, more))
    if d.rng.random() < 0.3:
        k = int(d.rng.integers(1, len(links)))
        links[k] = replace(links[k], loss=2 * d.ratio)  # type: ignore[type-var]
    return ScannedLine("straight", tuple(masses), tuple(links), *_range(d))


def bent(d: _Drawn) -> ScannedLine:
    """Driven, one or two joints."""
    masses, links = _chain(d, int(d.rng.integers(2, 5)), False)
    _bend(d, links, 2)
    return ScannedLine("bent", tuple(masses), tuple(links), *_range(d))


def free(d: _Drawn) -> ScannedLine:
    """Starts free and is bent: it moves by itself."""
    masses, links = _chain(d, int(d.rng.integers(3, 5)), True)
    _bend(d, links, 2, 0.25)
    return ScannedLine("free", tuple(masses), tuple(links), *_range(d))


def geared(d: _Drawn) -> ScannedLine:
    """A mesh with uneven stiffness and teeth that are not perfect; driven or, without a joint, free."""
    loose = bool(d.rng.random() < 0.3)
    masses, links = _chain(d, int(d.rng.integers(2, 4)), loose)
    masses.append(d.mass(d.shakes(1)))
    links.append(d.mesh(len(masses) - 2))
    masses.append(d.mass((), d.between(30, 120)))
    links.append(d.spring(len(masses) - 2))
    if not loose and d.rng.random() < 0.5:
        links[-1] = replace(links[-1], **d.joint(0.2))  # type: ignore[type-var]
    return ScannedLine("geared", tuple(masses), tuple(links), *_range(d, 5.0))


def branched(d: _Drawn) -> ScannedLine:
    """Two branches behind one of the masses, joints and ratios in either."""
    masses, links = _chain(d, 3, bool(d.rng.random() < 0.3))
    fork = int(d.rng.integers(0, 2))
    masses.append(d.mass(d.shakes(1), d.between(5, 40)))
    links.append(d.spring(fork))
    if d.rng.random() < 0.5:
        masses.append(d.mass((), d.between(5, 40)))
        links.append(d.spring(3))
    if links[0] is not None and d.rng.random() < 0.7:
        _bend(d, links, 2)
    return ScannedLine("branched", tuple(masses), tuple(links), *_range(d))


def slow(d: _Drawn) -> ScannedLine:
    """From a crawl: resonances of high orders only."""
    masses, links = _chain(d, int(d.rng.integers(2, 5)), bool(d.rng.random() < 0.3))
    high = (6, 8, 12, 16, 24)
    masses[0] = replace(masses[0], shakes=(*d.shakes(2, high), Shake(Fraction(d.one_of(*high)), d.between(5, 60), 0.3)))
    orders = [one.order for one in masses[0].shakes]
    if len(set(orders)) < len(orders):
        masses[0] = replace(masses[0], shakes=masses[0].shakes[-1:])
    if links[0] is not None and d.rng.random() < 0.6:
        _bend(d, links, 1)
    start = 10 ** d.between(-0.5, 0.7)
    return ScannedLine("low speed", tuple(masses), tuple(links), start, start * 10 ** d.between(0.3, 1.2))


def scheduled(d: _Drawn) -> ScannedLine:
    """Bent, its joints' angles over speed."""
    masses, links = _chain(d, int(d.rng.integers(2, 5)), False)
    _bend(d, links, 2)
    low, high = _range(d)
    points = (low * d.between(0.7, 1.2), (low + high) / 2 * d.between(0.9, 1.1), high * d.between(0.85, 1.2))
    for i, one in enumerate(links):
        if one is not None and one.angle:
            angles = tuple(d.between(0.02, 0.35) for _ in points)
            links[i] = replace(one, scheduled=(points, angles))
    inside = max(low, points[0]), min(high, points[-1])
    return ScannedLine("schedule", tuple(masses), tuple(links), low, high, schedule=inside)


def load_cases(d: _Drawn) -> ScannedLine:
    """Straight or bent, two load cases, a table over the speed or over the torque that drives."""
    loose = bool(d.rng.random() < 0.5)
    masses, links = _chain(d, int(d.rng.integers(2, 5)), loose)
    low, high = _range(d)
    end, last = len(masses) - 1, masses[-1]
    masses[-1] = replace(last, viscous=0.0, quadratic=0.0)
    points = tuple(np.linspace(0.8 * low, 1.2 * high, 4).tolist())
    table = Shake(
        Fraction(d.one_of(1, 2, 3)), 0.0, d.between(-3, 3), over="speed", points=points,
        amplitudes=tuple(d.between(5, 60) for _ in points),
    )  # fmt: skip
    if loose and d.rng.random() < 0.6:
        points = (0.0, 60.0, 120.0, 400.0)
        table = replace(table, over="torque", points=points, amplitudes=tuple(d.between(5, 60) for _ in points))
    masses[0] = replace(masses[0], shakes=(table,))
    if not loose:
        _bend(d, links, 2)
    cases = ({end: d.between(60, 150)}, {end: d.between(5, 50)})
    return ScannedLine("load cases", tuple(masses), tuple(links), low, high, cases)


CLASSES: dict[str, Callable[[_Drawn], ScannedLine]] = {
    "straight": straight, "bent": bent, "free": free, "geared": geared, "branched": branched, "low speed": slow,
    "schedule": scheduled, "load cases": load_cases,
}  # fmt: skip


def scanned_line(kind: str, seed: int) -> ScannedLine:
    """The line of a class and a seed."""
    return CLASSES[kind](_Drawn(np.random.default_rng([list(CLASSES).index(kind), seed])))
