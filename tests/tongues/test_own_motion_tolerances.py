"""Least damping, tolerances and slopes about the motion that random lines really make, against motions and multipliers
of equations and an integration of the tests' own."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.random_swung_lines import damped, moved, random_swung_line
from oracles.swung_trees import SwungTree
from scipy.optimize import differential_evolution

import trunnion as tn

Array = np.ndarray
SPEEDS, CLOSER = 201, 25
"""Speeds looked at of a range, and about each of the largest radii there."""
KNOWN = 1e-8
BESIDE = 1e-3
"""Share of an edge by which a point lies beside it."""


def largest_radius(line: tn.Driveline, low: float, high: float) -> float:
    """Of any speed of a range; NaN where the motion of one is not found."""
    tree = SwungTree(line)
    speed = np.linspace(low, high, SPEEDS)
    for _ in range(3):
        radius = np.array([tree.radius(one) for one in speed])
        k = int(radius.argmax())
        speed = np.linspace(speed[max(k - 1, 0)], speed[min(k + 1, len(speed) - 1)], CLOSER)
    return float(radius.max())


# Of 21 lines more that were looked at so none was false.
@pytest.mark.parametrize("seed", [6, *(pytest.param(k, marks=pytest.mark.slow) for k in (1, 3, 8, 14, 15))])
def test_least_damping_of_random_lines(seed: int) -> None:
    line, rng = random_swung_line(seed)
    tree = SwungTree(line)
    modes = tree.modes()
    i, j = rng.integers(len(modes), size=2)
    middle = (modes[i] + modes[j]) / 2 * (1 if rng.random() < 0.8 else 0.5)
    wide = rng.uniform(0.02, 0.08)
    low, high = float(middle * (1 - wide)), float(middle * (1 + wide))
    found = tn.minimum_damping(line, (low, high), maximum=8.0, rows=7, about_steady_state=tree.driven)
    assert found.smallest is not None and found.smallest > found.low
    for factor in (found.smallest * (1 + BESIDE), 2 * found.smallest, 8.0):
        assert largest_radius(damped(line, factor), low, high) < 1 + KNOWN, (seed, factor)
    for factor in (found.smallest * (1 - BESIDE), found.smallest / 2):
        assert largest_radius(damped(line, factor), low, high) > 1, (seed, factor)


def _tolerances(line: tn.Driveline, rng: np.random.Generator) -> dict[str, tuple[str, float, float]]:
    """Ranges of some of the numbers of a line."""
    keys, found = {"Shaft": "stiffness", "HookeJoint": "angle", "Disk": "inertia"}, {}
    for name, part in line.parts:
        if part.kind in keys and name != "d0" and rng.random() < 0.6:
            value = getattr(part, keys[part.kind])
            share = 0.2 if part.kind == "HookeJoint" else rng.uniform(0.01, 0.1)
            found[f"{name}.{keys[part.kind]}"] = ("range", float(value * (1 - share)), float(value * (1 + share)))
    return found


TOLERATED = [(k, False) for k in (1008, 1000, 1003, 1004, 1006)] + [(k, True) for k in (3002, 3004, 3006, 3008, 3010)]
"""Seeds, and whether a drive turns the line."""
QUICK = (1008, 3008)


@pytest.mark.parametrize(
    ("seed", "driven"),
    [pytest.param(*one, marks=() if one[0] in QUICK else pytest.mark.slow) for one in TOLERATED],
)
def test_tolerances_of_random_lines(seed: int, driven: bool) -> None:
    """The share of stable lines is that of as many lines drawn and integrated by themselves, none of which grows faster
    than the worst line found does."""
    line, rng = random_swung_line(seed, driven)
    modes = SwungTree(line).modes()
    i, j = rng.integers(len(modes), size=2)
    speed = float((modes[i] + modes[j]) / 2 * (1 + rng.uniform(-0.01, 0.01)))
    given = _tolerances(line, rng)
    study = tn.tolerance_study(line, given, [speed], samples=512, about_steady_state=driven)
    draws = [{path: rng.uniform(low, high) for path, (_, low, high) in given.items()} for _ in range(100)]
    radius = np.array([SwungTree(moved(line, one)).radius(speed) for one in draws])
    share, scatter = float((radius < 1).mean()), 4 * np.sqrt(0.25 / len(draws))
    assert study.interval[0] - scatter < share < study.interval[1] + scatter
    worst = SwungTree(moved(line, study.worst.values)).radius(speed)
    assert np.log(worst) * speed / np.pi == pytest.approx(study.worst.growth_rate, rel=1e-3, abs=1e-6)
    assert np.nanmax(np.log(radius)) * speed / np.pi < study.worst.growth_rate + 0.02 * abs(study.worst.growth_rate)


@pytest.mark.parametrize("seed", [pytest.param(k, marks=pytest.mark.slow) for k in (7001, 7003)])
def test_no_line_is_faster_than_the_worst_by_much(seed: int) -> None:
    """Another search, by differential evolution over equations integrated here, finds none within the tolerances that
    grows faster by more than a thousandth; from one sample alone it was 0.3 and 3 % short of that."""
    line, rng = random_swung_line(seed, driven=True)
    modes = SwungTree(line).modes()
    i, j = rng.integers(len(modes), size=2)
    speed = float((modes[i] + modes[j]) / 2 * (1 + rng.uniform(-0.02, 0.02)))
    given = _tolerances(line, rng)

    def decay(shares: Array) -> float:
        ends = zip(shares, given.items(), strict=True)
        radius = SwungTree(moved(line, {p: low + s * (high - low) for s, (p, (_, low, high)) in ends})).radius(speed)
        return float(-np.log(radius) * speed / np.pi)

    study = tn.tolerance_study(line, given, [speed], samples=512, about_steady_state=True)
    other = differential_evolution(decay, [(0, 1)] * len(given), seed=1, popsize=8, maxiter=25, polish=False)
    assert study.worst.growth_rate > -other.fun * (1 - 1e-3)
    assert study.worst.starts > 1 and f"over {study.worst.looked} lines more" in str(study)


def test_the_worst_line_where_motions_swing_too_far_to_be_found_alone() -> None:
    """Every shaft twists by up to 70°: from rigid shafts no motion of a single line is found. What is stated of the
    worst one is so."""
    line, rng = random_swung_line(1002, driven=False)
    modes = SwungTree(line).modes()
    i, j = rng.integers(len(modes), size=2)
    speed = float((modes[i] + modes[j]) / 2 * (1 + rng.uniform(-0.01, 0.01)))
    far = {"s0.stiffness": 7237.0, "d1.inertia": 1.25, "s1.stiffness": 5667.0, "s2.stiffness": 16757.0}
    line = moved(line, far)
    given = {"s2.stiffness": ("range", 16000.0, 16757.0), "d3.inertia": ("range", 0.5487, 0.62)}
    study = tn.tolerance_study(line, given, [speed], samples=256)
    worst = SwungTree(moved(line, study.worst.values)).radius(speed)
    assert worst > 1 and str(study.worst.verdict) == "unstable"
    assert np.log(worst) * speed / np.pi == pytest.approx(study.worst.growth_rate, rel=1e-4)


SLOPES = [(k, False) for k in (2010, 2003, 2004, 2009)] + [(k, True) for k in (4000, 4001, 4003, 4004, 4005)]


@pytest.mark.parametrize(
    ("seed", "driven"),
    [pytest.param(*one, marks=() if one[0] in (2010, 4000) else pytest.mark.slow) for one in SLOPES],
)
def test_slopes_of_random_lines(seed: int, driven: bool) -> None:
    """Growth rates and their derivatives lie within the errors stated: radii of which differences are taken are known
    as closely as these need."""
    line, rng = random_swung_line(seed, driven)
    tree = SwungTree(line)
    modes = tree.modes()
    i, j = rng.integers(len(modes), size=2)
    speed = float((modes[i] + modes[j]) / 2 * (1 + rng.uniform(-0.03, 0.03)))
    paths = ["j0.angle", "s0.stiffness", "s1.damping", "d1.inertia", "d2.inertia", "s1.fork_offset"]
    found = tn.sensitivity(line, [speed], paths, of=["growth"], about_steady_state=driven)
    (row,) = [k for k, one in enumerate(found.quantities) if one.kind == "growth rate"]
    start = tree.motion(speed)
    assert start is not None

    def growth(path: str, value: float) -> float:
        motion = SwungTree(moved(line, {path: value})).motion(speed, start.start, start.torque)
        assert motion is not None
        return float(np.log(motion.radius) * speed / np.pi)

    assert found.quantities[row].value == pytest.approx(np.log(start.radius) * speed / np.pi, rel=1e-8, abs=1e-9)
    for k, path in enumerate(found.parameters):
        value = float(found.parameter_value[k])
        size = value if found.parameter_unit[k] != "rad" else 1.0
        step = 1e-3 * size
        near, far = ((growth(path, value + s * step) - growth(path, value - s * step)) / (2 * s * step) for s in (1, 2))
        mine, off = (4 * near - far) / 3, abs(far - near) / 3
        stated = float(found.error[row, k])
        assert abs(found.derivative[row, k] - mine) < 2 * stated + off + 1e-6 / abs(size), (seed, path, mine)
