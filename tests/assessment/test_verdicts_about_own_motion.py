"""The verdict of stability over a range, of random lines close to its border, against a dense scan of motions and
multipliers by equations and an integration of the tests' own.

All shafts are damped by the factor at which the scan's fastest growth in the range is nought, times 0.95 to 1.05: where
a narrow range is missed, or one is invented, the verdict is wrong.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from oracles.random_swung_lines import damped, random_swung_line
from oracles.swung_trees import SwungTree

import trunnion as tn

Array = np.ndarray
COARSE, CLOSE, ROUNDS = 81, 9, 3
"""Even speeds of a scan, and those about each of its tops and ends, so many times."""
TOPS = 6
HALVINGS = 9
EDGE = 1e-4
"""Share of a speed within which an end is one."""
SURELY = 1e-7
"""Growth [1/s] that is one."""


def scanned(line: tn.Driveline, low: float, high: float, points: int = COARSE) -> tuple[Array, Array]:
    """Speeds [rad/s] and growth rates [1/s], NaN where no motion is found."""
    tree = SwungTree(line)

    def growth(speed: Array) -> Array:
        return np.array([np.log(tree.radius(one)) * one / np.pi for one in speed])

    x = np.linspace(low, high, points)
    v = growth(x)
    for _ in range(ROUNDS):
        known = np.where(np.isnan(v), -np.inf, v)
        tops = [k for k in range(1, len(x) - 1) if known[k] >= max(known[k - 1], known[k + 1])]
        places = [(k - 1, k + 1) for k in sorted(tops, key=lambda k: -known[k])[:TOPS]]
        places += [(k, k + 1) for k in range(len(x) - 1) if (v[k] > 0) != (v[k + 1] > 0)]
        new = [np.linspace(x[a], x[b], CLOSE) for a, b in places]
        more = np.setdiff1d(np.concatenate(new), x) if new else np.zeros(0)
        x, v = np.append(x, more), np.append(v, growth(more))
        order = np.argsort(x)
        x, v = x[order], v[order]
    return x, v


def on_the_border(line: tn.Driveline, low: float, high: float) -> float:
    """The factor of the shafts' damping at which the fastest growth in the range is nought."""
    less, more = 0.05, 20.0
    for _ in range(HALVINGS):
        middle = float(np.sqrt(less * more))
        grows = np.nanmax(scanned(damped(line, middle), low, high)[1]) > 0
        less, more = (middle, more) if grows else (less, middle)
    return float(np.sqrt(less * more))


def bordering(seed: int, *, driven: bool = False) -> tuple[tn.Driveline, float, float]:
    """A random line and a range about a resonance of two of its modes."""
    line, rng = random_swung_line(seed, driven=driven)
    modes = SwungTree(line).modes()
    i, j = rng.integers(len(modes), size=2)
    middle = (modes[i] + modes[j]) / 2 * (1 if rng.random() < 0.8 else 0.5)
    wide = rng.uniform(0.03, 0.2)
    low, high = float(middle * (1 - wide)), float(middle * (1 + wide))
    factor = on_the_border(line, low, high) * (1 + rng.choice([-0.05, -0.02, 0.02, 0.05]))
    return damped(line, float(factor)), low, high


def staged(line: tn.Driveline) -> tn.Driveline:
    """Its last shaft three times as stiff from a twist on that it does not reach: every motion is the same, and each
    speed takes its own."""
    name, last = [one for one in line.parts if one[1].kind == "Shaft"][-1]
    after = {} if last.after is None else {"after": last.after}
    stages = [(last.stiffness, 1.2), (3 * last.stiffness, None)]
    shaft = tn.PiecewiseShaft.symmetric(
        stages, name=name, damping=last.damping_coefficient, fork_offset=last.fork_offset, **after
    )
    return tn.Driveline([shaft if one == name else part for one, part in line.parts])


def same(line: tn.Driveline) -> tn.Driveline:
    return line


DRIVEN = (5401, 5402, 5403, 5404, 5405, 5406, 5407, 5408)
FREE = [(seed, same) for seed in (5102, 5103, 5105, 5107, 5109, 5114, 5120, 5126, 5129)]
STAGED = [(seed, staged) for seed in (5300, 5301, 5302, 5306, 5310, 5312)]


@pytest.mark.parametrize(
    ("seed", "changed"),
    [
        pytest.param(seed, how, id=f"{seed}-{how.__name__}", marks=() if seed in (5103, 5301) else pytest.mark.slow)
        for seed, how in (*FREE, *STAGED)
    ],
)
def test_verdicts_of_random_free_lines(seed: int, changed: Callable[[tn.Driveline], tn.Driveline]) -> None:
    """Ends too, and how fast the fastest disturbance grows; with stages each speed is judged by itself."""
    verdict_is_right(*bordering(seed), changed)


@pytest.mark.parametrize(
    "seed", [pytest.param(seed, marks=() if seed == DRIVEN[0] else pytest.mark.slow) for seed in DRIVEN]
)
def test_verdicts_of_random_driven_lines(seed: int) -> None:
    """About the motion that joints and loads make them swing in, and not their static twist."""
    verdict_is_right(*bordering(seed, driven=True), same)


def verdict_is_right(
    line: tn.Driveline, low: float, high: float, changed: Callable[[tn.Driveline], tn.Driveline]
) -> None:
    """Of the line as ``changed``, which makes the same motions."""
    (check,) = [one for one in tn.assess(changed(line), (low, high)).checks if one.name == "parametric stability"]
    speed, growth = scanned(line, low, high, 3 * COARSE)
    covered, unstable, end = (np.zeros(len(speed), dtype=bool) for _ in range(3))
    for a, b in check.covered or ((low, high),):
        covered |= (speed >= a) & (speed <= b)
    for a, b in check.barred:
        unstable |= (speed >= a) & (speed <= b)
        end |= (np.abs(speed - a) < EDGE * a) | (np.abs(speed - b) < EDGE * b)
    inside = covered & ~end & np.isfinite(growth)
    assert not np.any(inside & ~unstable & (growth > SURELY)), (check.because, speed[inside & (growth > 0)])
    assert not np.any(inside & unstable & (growth < -SURELY)), check.because
    assert str(check.status) == ("exceeded" if np.nanmax(growth[covered]) > 0 else "satisfied")
    assert check.value == pytest.approx(np.nanmax(growth[covered]), rel=2e-3, abs=1e-5)
