"""The search for unstable ranges: its meetings, its ends, and that scans which know no meeting find nothing more."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from oracles.own_monodromy import Chains, Part

import trunnion as tn
from trunnion.arrays import Array
from trunnion.equations.coefficients import assemble
from trunnion.floquet.ranges import growing_pairs
from trunnion.floquet.ranges.collisions import Collisions, exponent_collisions
from trunnion.floquet.ranges.span import Span
from trunnion.floquet.ranges.unstable import UnstableRanges, _astray, between_tops, closed_in, unstable_ranges
from trunnion.floquet.stability.stability_over_speed import StabilityOverSpeed, stability_along
from trunnion.results.verdict import Verdict, verdicts


def judged(excess: Callable[[Array], Array], error: float) -> Callable[[Array], StabilityOverSpeed]:
    """A judge of radii 1 + ``excess``, known to ``error``."""

    def judge(speed: Array) -> StabilityOverSpeed:
        radius, off = 1 + excess(speed), np.full(len(speed), error)
        return StabilityOverSpeed(speed, radius, off, radius.astype(complex), verdicts(radius, off), radius - 1, 1.0)

    return judge


@pytest.mark.parametrize(
    ("excess", "dearest"),
    [
        pytest.param(lambda x: -1e-3 * (x - 3.3) * (x - 7.1), 14, id="smooth"),
        pytest.param(lambda x: 1e-2 * np.sqrt(np.maximum(-(x - 3.3) * (x - 7.1), 0.0)), 60, id="undamped"),
        pytest.param(lambda x: np.sqrt(np.maximum(9 - (x - 5.2) ** 2, 0)) - np.sqrt(9 - 1.9**2), 20, id="damped"),
        pytest.param(lambda x: np.where((x >= 3.3) & (x <= 7.1), 1e-3, -0.5), 60, id="jump"),
        pytest.param(lambda x: np.where((x >= 3.3) & (x <= 7.1), 0.1, np.nan), 60, id="nothing known beside"),
    ],
)
def test_ends_of_a_range_are_closed_in_on(excess: Callable[[Array], Array], dearest: int) -> None:
    """Unstable from 3.3 to 7.1 by its formula; each end in half the looks of halving where it is smooth."""
    judge = judged(excess, 1e-12)
    along, ((low, high),) = closed_in(judge(np.linspace(1.0, 9.0, 12)), judge)
    assert 3.3 - 1e-12 <= low <= 3.3 * (1 + 1.1e-7) and 7.1 * (1 - 1.1e-7) <= high <= 7.1 + 1e-12
    inner = (along.speed >= low) & (along.speed <= high)
    assert np.array_equal(along.verdict == Verdict.UNSTABLE, inner)
    assert len(along.speed) - 12 <= dearest


def test_what_ends_with_the_range_has_no_end_within() -> None:
    judge = judged(lambda x: 5.0 - x, 1e-9)
    (ends,) = closed_in(judge(np.linspace(4.0, 6.0, 5)), judge)[1]
    assert ends == (4.0, pytest.approx(5.0, rel=1e-7))


@pytest.mark.parametrize("wide", [0.3, 0.05, 0.01])
@pytest.mark.parametrize("shift", [0.0, 0.13, 0.37])
def test_two_ranges_with_little_between_them_are_two(wide: float, shift: float) -> None:
    """Each grows as a root does beside its end; looks 0.4 apart step over what lies between."""
    middle = 5.0 + 0.4 * shift

    def excess(x: Array) -> Array:
        low, high = middle - wide / 2, middle + wide / 2
        below, above = (x - 3.1) * (low - x), (x - high) * (7.3 - x)
        return np.where(below > 0, np.sqrt(np.abs(below)), np.where(above > 0, np.sqrt(np.abs(above)), -0.2)) * 0.1

    judge = judged(excess, 1e-12)
    _, found = closed_in(between_tops(judge(np.arange(2.0, 9.0, 0.4)), judge), judge)
    assert np.ravel(found) == pytest.approx([3.1, middle - wide / 2, middle + wide / 2, 7.3], rel=2e-7)


def chain(seed: int, inertias: int, *, steepest: float = 25.0) -> tuple[list[Part], float]:
    """Disks and shafts of scattered size, up to three joints, one damping ratio from 0.1 % to 5 %; and the first
    natural frequency [rad/s]."""
    rng = np.random.default_rng(seed)
    ratio = 10 ** float(rng.uniform(-3, np.log10(0.05) if seed % 2 else -2.3))
    bends = rng.choice(np.arange(1, inertias - 1), size=int(rng.integers(1, 4)), replace=False)
    parts = []
    for i in range(inertias):
        k = 2e5 * 10 ** float(rng.uniform(-0.5, 0.5))
        parts += [
            Part("shaft", {"stiffness": k, "damping": 2 * ratio * np.sqrt(0.1 * k)}),
            Part("disk", {"inertia": 0.1 * 10 ** float(rng.uniform(-0.4, 0.4))}),
        ]
        if i in bends:
            parts.append(Part("hooke", {"angle": np.deg2rad(rng.uniform(5, steepest)), "plane": rng.uniform(-3, 3)}))
    return parts, float(tn.natural_frequencies(line_of(parts)).undamped_frequency[0])


def line_of(parts: list[Part]) -> tn.Driveline:
    elements: list[Any] = [tn.ConstantSpeed(), *(part.element(0) for part in parts)]
    return tn.Driveline(elements)


def searched(line: tn.Driveline, low: float, high: float) -> tuple[UnstableRanges, int]:
    """Its ranges, and how many speeds were judged."""
    assembly, count = assemble(line), 0

    def judge(speeds: Array) -> StabilityOverSpeed:
        nonlocal count
        count += len(speeds)
        return stability_along(assembly, speeds)

    return unstable_ranges(Span(assembly, low, high), judge), count


def within(speed: Array, found: UnstableRanges, wider: float) -> Any:
    """Which speeds lie in a range that is ``wider`` at either end, as a share."""
    ends = np.array(found.ranges).reshape(-1, 2)
    return ((speed[:, None] >= ends[:, 0] * (1 - wider)) & (speed[:, None] <= ends[:, 1] * (1 + wider))).any(axis=1)


@pytest.mark.parametrize("seed", [0, 2])
def test_no_range_of_a_chain_is_lost_by_equations_of_its_own(seed: int) -> None:
    """Radii by Runge and Kutta at speeds by chance; what lies within 1e-5 of 1 is left to them."""
    parts, first = chain(seed, 4)
    speed = first * np.random.default_rng(seed + 100).uniform(0.9, 2.6, 240)
    found, _ = searched(line_of(parts), 0.9 * first, 2.6 * first)
    radius = Chains(parts, speed).radii(20)
    assert found.ranges and (radius > 1 + 1e-5).any()
    assert not np.any((radius > 1 + 1e-5) & ~within(speed, found, 0.0))
    assert not np.any((radius < 1 - 1e-5) & within(speed, found, 0.0))


@pytest.mark.slow
@pytest.mark.parametrize("long", [growing_pairs.LONG, 8], ids=["all looked at", "pairs followed"])
@pytest.mark.parametrize("seed", range(45))
def test_no_range_of_a_random_chain_is_lost(seed: int, long: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """8 to 30 inertias: matrices of the period at 1 000 speeds by chance, closer where growth has a top; also as longer
    lines are searched."""
    monkeypatch.setattr(growing_pairs, "LONG", long)
    rng = np.random.default_rng(seed + 1000)
    parts, first = chain(seed, int(rng.integers(8, 31)))
    line, speed = line_of(parts), np.sort(first * 0.5 * 8 ** rng.random(1000))
    found, _ = searched(line, 0.5 * first, 4.0 * first)
    growth = stability_along(assemble(line), speed).growth_rate
    top = np.flatnonzero((growth[1:-1] >= growth[:-2]) & (growth[1:-1] >= growth[2:])) + 1
    top = top[np.argsort(-growth[top])][:30]
    close = np.concatenate([np.linspace(speed[i - 1], speed[i + 1], 15)[1:-1] for i in top])
    along = stability_along(assemble(line), np.concatenate([speed, close]))
    assert not np.any((along.verdict == Verdict.UNSTABLE) & ~within(along.speed, found, 2e-7))
    assert not np.any((along.verdict == Verdict.STABLE) & within(along.speed, found, -2e-7))
    assert np.nanmax(found.along.growth_rate) > np.nanmax(along.growth_rate) - 0.01 * abs(np.nanmax(along.growth_rate))


@pytest.mark.parametrize("seed", [5, 8])
def test_ends_of_pairs_followed_by_themselves_are_those_of_the_line(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """As every speed looked at tells, with fewer looks; just within and beyond every end by matrices of the period."""
    parts, first = chain(seed, 12)
    line, low, high = line_of(parts), 0.5 * first, 2.5 * first
    plain, looks = searched(line, low, high)
    monkeypatch.setattr(growing_pairs, "LONG", 8)
    found, fewer = searched(line, low, high)
    assert len(found.ranges) >= len(plain.ranges) > 0 and fewer < looks
    starts, ends = np.array(found.ranges).T
    starts, ends = starts[starts > low], ends[ends < high]
    along = stability_along(assemble(line), np.concatenate([starts * (1 - 2e-7), ends * (1 + 2e-7)]))
    assert np.all(along.verdict != Verdict.UNSTABLE)
    along = stability_along(assemble(line), np.concatenate([starts * (1 + 2e-7), ends * (1 - 2e-7)]))
    assert np.all(along.verdict == Verdict.UNSTABLE)


def test_growth_where_exponents_meet_is_that_of_the_multipliers() -> None:
    """Where two modes grow together they are the fastest; and what is damped too much is known to be so."""
    parts, first = chain(2, 6)
    line = line_of(parts)
    met = exponent_collisions(Span(assemble(line), 0.5 * first, 3.0 * first), 0.5 * first, 3.0 * first)
    grows = np.flatnonzero(met.growth > 0)
    assert len(grows) >= 2 and (~met.matters).any()
    for i in grows:
        true = tn.stability(line, float(met.speed[i])).growth_rate
        assert true == pytest.approx(met.growth[i], rel=0.02)
    along = stability_along(assemble(line), met.speed[~met.matters])
    assert np.all(along.verdict == Verdict.STABLE)


def test_one_looks_beside_a_meeting_as_closely_as_it_is_narrow() -> None:
    """Eight places about a narrow one; of a broad one as few as lie within a third of its breadth."""
    at, nothing = np.full(3, 100.0), np.zeros(3)
    breadth = np.array([0.1, 1.0, 10.0])
    modes = [np.zeros(3, dtype=np.int64)] * 3
    met = Collisions(at, nothing, nothing, np.full(3, np.nan), nothing, nothing, breadth, *modes)
    places = [_astray(met.of(np.arange(3) == k)) - 100.0 for k in range(3)]
    assert [len(one) for one in places] == [8, 4, 2]
    for one, wide in zip(places[1:], breadth[1:], strict=True):
        assert np.diff(np.sort([*one, 0.0])).max() <= wide / 3 and np.abs(one).max() == pytest.approx(0.6)
