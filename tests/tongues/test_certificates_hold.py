"""What is proved of random boxes against radii integrated without the package, at corners, inside and beside the
boundary: nothing is proved that is not so."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from oracles.own_monodromy import Chains, Part

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.floquet.certificate.box_coefficients import NumberRange
from trunnion.floquet.certificate.judge import judge

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


def check(seed: int, boxes: int, size: int, simple: bool, points: int = 24) -> tuple[int, int]:
    """How many boxes of one shape were proved, and how many of all hold an unstable line; fails at one that is both.

    All stand near the boundary: the damping of their middle is that at which it becomes unstable, times 1.001 to 4.
    """
    rng = np.random.default_rng(seed)
    shape = random_shape(rng, size, simple)
    with np.errstate(all="ignore"):
        low, high = np.full(boxes, -4.0), np.full(boxes, 1.0)
        one = assemble(driveline(shape.parts, 0))
        modes = tn.natural_frequencies(one).undamped_frequency
        pairs = [(a + b) / 2 for a in modes for b in modes]
        orders = [p / k for p in pairs for k in (1, 1, 2)]
        speed = rng.choice(orders, boxes) * (1 + rng.choice([-1, 1], boxes) * 10 ** rng.uniform(-5, -1.5, boxes))
        for _ in range(12):
            middle = (low + high) / 2
            grows = Chains(shape.at({}, 10**middle), speed).radii() > 1
            low, high = np.where(grows, middle, low), np.where(grows, high, middle)
        damping = 10**high * (1 + 10 ** rng.uniform(-3, 0.5, boxes))
    count = len(shape.scattering)
    wide = 10 ** rng.uniform(-6, -1.4, (boxes, 1 + count)) * (rng.random((boxes, 1 + count)) < 0.6)
    shares = rng.uniform(-1, 1, (boxes, points, 1 + count))
    shares[:, ::2] = np.sign(shares[:, ::2])
    factor = 1 + shares * wide[:, None]
    all_speeds = (speed[:, None] * factor[..., 0]).ravel()
    factors = {name: factor[..., 1 + k].ravel() for k, name in enumerate(shape.scattering)}
    unstable = (Chains(shape.at(factors, np.repeat(damping, points)), all_speeds).radii() > 1 + RADIUS).reshape(
        boxes, points
    )
    proved = np.zeros(boxes, dtype=bool)
    for b in range(boxes):
        line = driveline(shape.at({}, np.full(1, damping[b])), 0)
        assembly = assemble(line)
        ranges = []
        for k, (i, key) in enumerate(shape.scattering):
            half = wide[b, 1 + k]
            if half:
                columns = assembly.packed.resolve(f"{line.names[1 + i]}.{key}")
                value = assembly.packed.value(columns.label)
                ranges.append(NumberRange(columns.label, columns, value * (1 - half), value * (1 + half)))
        ends = speed[b] * (1 - wide[b, 0]), speed[b] * (1 + wide[b, 0])
        proved[b] = judge(assembly, ends, ranges).proved or judge(assembly, ends, ranges, by_energy=True).proved
        assert not (proved[b] and unstable[b].any()), (seed, b)
    return int(proved.sum()), int(unstable.any(axis=1).sum())


def driveline(parts: list[Part], line: int) -> tn.Driveline:
    """The package's own description of one of the lines."""
    return tn.Driveline([tn.ConstantSpeed(), *(part.element(line) for part in parts)])


def totals(seeds: range, boxes: int, size: int, simple: bool) -> None:
    found = np.array([check(seed, boxes, size, simple) for seed in seeds]).sum(axis=0)
    # Neither all nor nothing: boxes stand at the boundary.
    many = boxes * len(seeds)
    assert found[0] > 0.05 * many and found[1] > 0.05 * many, found


def test_boxes_at_the_boundary() -> None:
    totals(range(1, 2), 20, 2, simple=True)


@pytest.mark.slow
@pytest.mark.parametrize("simple", [True, False])
def test_hundreds_of_boxes_at_the_boundary(simple: bool) -> None:
    totals(range(2, 12), 30, 2, simple)


@pytest.mark.parametrize("seed", range(2))
def test_the_judge_agrees_with_the_package(seed: int) -> None:
    """Radii of the oracle are those of ``stability``."""
    rng = np.random.default_rng(seed)
    shape = random_shape(rng, 2, simple=False)
    speed = 10 ** rng.uniform(-0.3, 0.5, 6)
    mine = Chains(shape.at({}, np.full(6, 0.3)), speed).radii()
    line = driveline(shape.at({}, np.full(1, 0.3)), 0)
    for one, own in zip(speed, mine, strict=True):
        found = tn.stability(line, float(one))
        theirs = np.abs(found.multipliers).max() ** (2 * np.pi / found.period)
        assert own == pytest.approx(theirs, rel=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_thousands_of_small_boxes(seed: int) -> None:
    totals(range(100 + 10 * seed, 110 + 10 * seed), 50, 2, simple=seed % 2 == 0)


@pytest.mark.study
@pytest.mark.parametrize("seed", range(50))
def test_a_hundred_thousand_small_boxes(seed: int) -> None:
    """2000 boxes each of one to three inertias."""
    for part in range(10):
        check(1000 + 10 * seed + part, 200, 1 + part % 3, simple=part % 2 == 0)


@pytest.mark.study
@pytest.mark.parametrize("seed", range(20))
def test_a_thousand_boxes_of_longer_lines(seed: int) -> None:
    """50 boxes each of five to seven inertias."""
    check(5000 + seed, 50, 5 + seed % 3, simple=False)
