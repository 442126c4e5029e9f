"""Boxes of lines near the boundary of stability, what is proved of them, and radii at their corners and inside by
``own_monodromy``, which shares nothing with the proof."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import trunnion as tn
from oracles.own_monodromy import Chains, Part
from trunnion.equations.coefficients import assemble
from trunnion.equations.topology import LinkKind
from trunnion.floquet.certificate.box_coefficients import NumberRange
from trunnion.floquet.certificate.judge import judge

STEEPEST = 1.2
"""Largest angle of a cross [rad]."""
RADIUS = 1e-9
"""By how much a radius of the integration may stand above 1 and be one within its error."""


@dataclass
class Shape:
    """Kinds and numbers of a random chain, and which of them may scatter, by part and key."""

    parts: list[Part]
    scattering: list[tuple[int, str]]

    def at(self, factor: dict[tuple[int, str], np.ndarray], damping: np.ndarray) -> list[Part]:
        """The parts of many lines: numbers times factors (lines,), all damping times ``damping`` (lines,)."""
        found = []
        for i, part in enumerate(self.parts):
            own = {key: value * factor.get((i, key), 1.0) for key, value in part.numbers.items()}
            if part.kind == "shaft":
                own["damping"] = own["damping"] * damping
            found.append(Part(part.kind, own))
        return found


def random_shape(rng: np.random.Generator, size: int, simple: bool) -> Shape:
    """A chain of ``size`` inertias behind joints; plain shafts, disks and crosses, or all that a certificate covers."""
    parts: list[Part] = []
    for i in range(size):
        if i < 2 or rng.random() < 0.7:
            numbers = {"angle": rng.uniform(0.05, 0.7), "plane": rng.uniform(0, 3) if i else 0.0}
            tripod = not simple and rng.random() < 0.2
            if tripod:
                numbers |= {"radius": rng.uniform(0.02, 0.1), "length": 0.2, "angle": rng.uniform(0.2, 0.7)}
            parts.append(Part("tripod" if tripod else "hooke", numbers))
            if not simple and i and rng.random() < 0.4:
                parts.append(Part("disk", {"inertia": 10 ** rng.uniform(-1.5, -0.5)}))
        if not simple and rng.random() < 0.25:
            parts.append(Part("ratio", {"ratio": float(rng.choice([0.5, 1 / 3]))}))
        share = 10 ** rng.uniform(-2.5, -1.5)
        stiffness = 10 ** rng.uniform(-0.5, 0.5)
        shaft = {"stiffness": stiffness, "damping": share * stiffness}
        if not simple:
            shaft["fork_offset"] = rng.uniform(0, 2)
        parts.append(Part("shaft", shaft))
        disk = {"inertia": 10 ** rng.uniform(-0.5, 0.5)}
        if not simple and rng.random() < 0.4:
            disk |= {"load_torque": rng.uniform(0, 0.08), "viscous_load": 10 ** rng.uniform(-4, -2)}
        parts.append(Part("disk", disk))
    keys = {"shaft": ("stiffness", "damping"), "disk": ("inertia", "load_torque"), "hooke": ("angle",)}
    some = [(i, key) for i, p in enumerate(parts) for key in keys.get(p.kind, ()) if key in p.numbers]
    return Shape(parts, some)


def staged_shape(rng: np.random.Generator, size: int) -> Shape:
    """The same with loads on every disk, and stages of every other spring, whose knots stand close to where the load
    puts it, at all speeds or at one between 0.3 and 3."""
    shape = random_shape(rng, size, simple=False)
    for part in shape.parts:
        if part.kind == "disk":
            part.numbers |= {"load_torque": rng.uniform(0.02, 0.08), "viscous_load": float(rng.choice([0.0, 3e-3]))}
    torques = Chains(shape.parts, 10 ** rng.uniform(-0.5, 0.5, 1)).torques()
    shafts = [part for part in shape.parts if part.kind == "shaft"]
    for part, torque in list(zip(shafts, torques, strict=True))[::2]:
        inner = rng.choice([0.2, 3.0])
        at = abs(float(torque[0])) * (1 + rng.choice([-1, 1]) * 10 ** rng.uniform(-4, -1))
        part.numbers |= {"inner": inner, "knot": at / (inner * part.numbers["stiffness"])}
    keys = {"shaft": ("damping",), "disk": ("inertia", "load_torque", "viscous_load"), "hooke": ("angle",)}
    some = [(i, key) for i, p in enumerate(shape.parts) for key in keys.get(p.kind, ()) if key in p.numbers]
    return Shape(shape.parts, some)


def check_staged(seed: int, boxes: int, size: int, points: int = 24) -> tuple[int, int]:
    """``attack`` on a random chain whose springs have stages."""
    rng = np.random.default_rng(seed)
    return attack(rng, staged_shape(rng, size), boxes, Attack(points), f"staged {seed}")


def check(seed: int, boxes: int, size: int, simple: bool, points: int = 24) -> tuple[int, int]:
    """``attack`` on a random chain."""
    rng = np.random.default_rng(seed)
    return attack(rng, random_shape(rng, size, simple), boxes, Attack(points), str(seed))


def real_shape(rng: np.random.Generator, line: tn.Driveline) -> Shape:
    """A chain of the package's, its numbers from its coefficients, its crosses bent up to three times as far, but no
    farther than ``STEEPEST``."""
    assembly = assemble(line)
    topo, co = assembly.topology, assembly.coefficients(assembly.table(1, 1.0))
    angles, parts, e, bent = iter([one.angle for one in line.elements if one.kind == "HookeJoint"]), [], 0, 0
    for s, station in enumerate(topo.stations):
        if station.link is LinkKind.SHAFT:
            own = {"stiffness": co.stiffness[0, e], "damping": co.damping[0, e], "fork_offset": co.shift[0, s]}
            parts.append(Part("shaft", {key: float(value) for key, value in own.items()}))
            e += 1
        elif station.link is LinkKind.JOINT:
            plane = -float(co.shift[0, s])
            parts.append(Part("hooke", {"angle": min(next(angles) * rng.uniform(1, 3), STEEPEST), "plane": plane}))
            bent = s
        elif station.link is LinkKind.RATIO:
            assert bent == max(topo.joints)
            ratio = float(topo.ratio_values[s])
            parts.append(Part("ratio", {"ratio": ratio}))
        if co.inertia[0, s] and s:
            parts.append(Part("disk", {"inertia": float(co.inertia[0, s])}))
    keys = {"shaft": ("stiffness", "damping"), "disk": ("inertia",), "hooke": ("angle",)}
    return Shape(parts, [(i, key) for i, part in enumerate(parts) for key in keys.get(part.kind, ())])


@dataclass
class Attack:
    """``points`` of every box, corners and inside by turns; ``least`` factor of the damping and ``widest`` share of a
    number, as powers of ten; whether boxes that are not proved are left alone."""

    points: int = 24
    least: float = -4.0
    widest: float = -1.4
    proved_alone: bool = False


def attack(rng: np.random.Generator, shape: Shape, boxes: int, how: Attack, said: str) -> tuple[int, int]:
    """How many boxes of one shape were proved, and how many of those attacked hold an unstable line; fails at one that
    is both.

    All stand near the boundary: the damping of their middle is that at which it becomes unstable, times 1.001 to 4.
    """
    points = how.points
    with np.errstate(all="ignore"):
        low, high = np.full(boxes, how.least), np.full(boxes, 1.0)
        modes = tn.natural_frequencies(assemble(driveline(shape.parts, 0))).undamped_frequency
        pairs = [(a + b) / 2 for a in modes for b in modes]
        orders = [p / k for p in pairs for k in (1, 1, 2)]
        speed = rng.choice(orders, boxes) * (1 + rng.choice([-1, 1], boxes) * 10 ** rng.uniform(-5, -1.5, boxes))
        for _ in range(12):
            middle = (low + high) / 2
            grows = Chains(shape.at({}, 10**middle), speed).radii() > 1
            low, high = np.where(grows, middle, low), np.where(grows, high, middle)
        damping = 10**high * (1 + 10 ** rng.uniform(-3, 0.5, boxes))
    count = len(shape.scattering)
    wide = 10 ** rng.uniform(-6, how.widest, (boxes, 1 + count)) * (rng.random((boxes, 1 + count)) < 0.6)
    proved = np.array([_proved(shape, float(d), float(v), own) for d, v, own in zip(damping, speed, wide, strict=True)])
    attacked = np.flatnonzero(proved) if how.proved_alone else np.arange(boxes)
    shares = rng.uniform(-1, 1, (boxes, points, 1 + count))
    shares[:, ::2] = np.sign(shares[:, ::2])
    factor = (1 + shares * wide[:, None])[attacked]
    unstable = np.zeros(boxes, dtype=bool)
    if len(attacked):
        factors = {name: factor[..., 1 + k].ravel() for k, name in enumerate(shape.scattering)}
        lines = Chains(
            shape.at(factors, np.repeat(damping[attacked], points)), (speed[attacked, None] * factor[..., 0]).ravel()
        )
        unstable[attacked] = (lines.radii() > 1 + RADIUS).reshape(-1, points).any(axis=1)
    assert not (proved & unstable).any(), (said, np.flatnonzero(proved & unstable))
    return int(proved.sum()), int(unstable.sum())


def _proved(shape: Shape, damping: float, speed: float, wide: np.ndarray) -> bool:
    line = driveline(shape.at({}, np.full(1, damping)), 0)
    assembly, ranges = assemble(line), []
    for (i, key), half in zip(shape.scattering, wide[1:].tolist(), strict=True):
        if half:
            columns = assembly.packed.resolve(f"{line.names[1 + i]}.{key}")
            value = assembly.packed.value(columns.label)
            ranges.append(NumberRange(columns.label, columns, value * (1 - half), value * (1 + half)))
    ends = speed * (1 - wide[0]), speed * (1 + wide[0])
    return judge(assembly, ends, ranges).proved or judge(assembly, ends, ranges, by_energy=True).proved


def driveline(parts: list[Part], line: int) -> tn.Driveline:
    """The package's own description of one of the lines."""
    return tn.Driveline([tn.ConstantSpeed(), *(part.element(line) for part in parts)])
