"""Limits and windows about the motion that random lines really make, attacked where two modes of the straight line add
up to twice the speed, by motions and multipliers of equations and an integration of the tests' own."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from oracles.swung_trees import SwungTree

import trunnion as tn

Array = np.ndarray
AROUND, POINTS = 0.04, 24
"""Share of a value to either side of such a place, and points looked at there."""
KNOWN = 1e-7
"""By which ρ must differ from 1 to count."""
BESIDE = 1e-4
"""Share of an edge by which a point lies beside it."""


class Box(NamedTuple):
    line: tn.Driveline
    name: str
    key: str
    low: float
    high: float
    speed: float

    @property
    def parameter(self) -> str:
        return f"{self.name}.{self.key}"

    def at(self, value: float) -> SwungTree:
        return SwungTree(self.line.replace(self.name, **{self.key: float(value)}))

    def radii(self, speed: float, values: Array) -> Array:
        """ρ (value,), each motion from that before; NaN where none is found."""
        found, last = [], None
        for value in values:
            tree = self.at(value)
            last = (last and tree.motion(speed, last.start, last.torque)) or tree.motion(speed)
            found.append(np.nan if last is None else last.radius)
        return np.array(found)


def random_box(seed: int) -> Box:
    """A chain, free or driven and loaded, hardly damped, and a stiffness or an inertia over two octaves each way."""
    rng = np.random.default_rng(seed)
    n, driven = int(rng.integers(2, 4)), rng.random() < 0.5
    inertia, stiffness = 10 ** rng.uniform(-0.3, 0.3, n + 1), 10 ** rng.uniform(3.5, 4.0, n)
    share = 10 ** rng.uniform(-4.5, -3)
    own = {"name": "d0", "inertia": float(inertia[0]), "drive_share": 1.0}
    parts: list = [tn.ConstantSpeed(name="d0") if driven else tn.Disk(**own)]
    for i, (j, k) in enumerate(zip(inertia[1:].tolist(), stiffness.tolist(), strict=True)):
        if rng.random() < 0.8 or i == 0:
            parts.append(tn.HookeJoint(name=f"j{i}", angle=float(rng.uniform(0.1, 0.3))))
        parts.append(tn.Shaft(name=f"s{i}", stiffness=k, damping=float(2 * share * np.sqrt(k * j))))
        load = float(rng.choice([0.0, rng.uniform(-1, 1) * 0.1 * k])) if driven else 0.0
        viscous = 0.0 if driven else float(10 ** rng.uniform(-3, -2))
        parts.append(tn.Disk(name=f"d{i + 1}", inertia=j, load_torque=load, viscous_load=viscous))
    line = tn.Driveline(parts)
    modes = SwungTree(line).modes()
    speed = float(rng.uniform(0.6 * modes[0], 1.2 * modes[-1]))
    moved = [part for part in parts if part.kind in ("Shaft", "Disk") and part.name != "d0"]
    part = moved[rng.integers(len(moved))]
    key = "stiffness" if part.kind == "Shaft" else "inertia"
    middle = getattr(part, key)
    return Box(line, part.name, key, middle / 4, 4 * middle, speed)


def suspects(box: Box, speed: float) -> list[Array]:
    """Values (POINTS,) around each at which two modes of the straight line add up to twice the speed."""
    grid = np.linspace(box.low, box.high, 201)
    modes = np.array([box.at(value).modes() for value in grid])
    found = []
    for i, j in zip(*np.triu_indices(modes.shape[1]), strict=True):
        off = modes[:, i] + modes[:, j] - 2 * speed
        for k in np.flatnonzero(off[:-1] * off[1:] < 0):
            at = grid[k] - off[k] * (grid[k + 1] - grid[k]) / (off[k + 1] - off[k])
            around = np.linspace(1 - AROUND, 1 + AROUND, POINTS) * at
            found.append(around[(around > box.low) & (around < box.high)])
    return found


# In the first box a region of ρ − 1 = 2 % is a fifth as wide as one looks closely at everywhere.
@pytest.mark.parametrize("seed", [0, *(pytest.param(k, marks=pytest.mark.slow) for k in (1, 2, 5, 7))])
def test_limits_of_narrow_regions(seed: int) -> None:
    box = random_box(seed)
    found = tn.stable_limit(
        box.line, box.parameter, [box.speed], low=box.low, high=box.high, between=False, about_steady_state=True
    )
    (ranges,) = found.unstable
    compared = 0
    for values in suspects(box, box.speed):
        radii = box.radii(box.speed, values)
        stated = ((values[:, None] >= ranges[:, 0]) & (values[:, None] <= ranges[:, 1])).any(axis=1)
        told = np.abs(radii - 1) > KNOWN
        compared += int(told.sum())
        wrong = told & ((radii > 1) != stated)
        assert not wrong.any(), (seed, values[wrong], radii[wrong])
    assert compared >= POINTS // 2
    for edge in ranges.ravel():
        if box.low < edge < box.high and not np.isnan(found.limit[0]):
            radii = box.radii(box.speed, edge * np.array([1 - BESIDE, 1 + BESIDE]))
            assert radii.min() < 1 < radii.max(), (seed, edge, radii)


@pytest.mark.slow
def test_windows_of_narrow_ranges_of_speeds() -> None:
    """A region that crosses the speeds between two rows is met by every column."""
    box = random_box(0)
    speeds = 22.61235762014762, 22.92832948123585
    found = tn.stable_windows(box.line, box.parameter, box.low, box.high, speeds, about_steady_state=True)
    assert len(found.windows) == 2
    for speed in speeds:
        for values in suspects(box, speed):
            inside = ((values[:, None] > found.windows[:, 0]) & (values[:, None] < found.windows[:, 1])).any(axis=1)
            assert not (inside & (box.radii(speed, values) > 1 + KNOWN)).any()


def test_a_limit_below_a_fold_is_known() -> None:
    """Where the motion folds back above the first unstable range the limit stands, and what lies in the fold is in no
    window: there two motions are followed to, from below and from above."""
    box = random_box(2)
    found = tn.stable_limit(
        box.line, box.parameter, [box.speed], low=box.low, high=box.high, between=False, about_steady_state=True
    )
    (limit,), (unknown,), (windows,) = found.limit.tolist(), found.unknown, found.windows
    assert len(unknown) and unknown[0, 0] > found.unstable[0][-1, 1] > limit
    radii = box.radii(box.speed, np.linspace(box.low, limit * (1 - BESIDE), 60))
    assert (radii < 1 + KNOWN).all() and box.radii(box.speed, np.array([limit * (1 + BESIDE)]))[0] > 1
    for low, high in unknown:
        assert not ((windows[:, 0] < high) & (windows[:, 1] > low)).any()
    ends = unknown.min() - 0.2, unknown.max() + 0.2
    met = [_followed(box, end, (unknown.min() + unknown.max()) / 2) for end in ends]
    assert met[0] is None or met[1] is None or abs(met[0] - met[1]).max() > 1e-3
    whole = str(found)
    assert whole.startswith(f"Stable at {box.speed:.6g} rad/s up to inertia of d2 {limit:.6g} kg m²")


def _followed(box: Box, begin: float, end: float) -> Array | None:
    """Start of the motion at one value that is followed from another; None where it ends before."""
    last = box.at(begin).motion(box.speed)
    for value in np.linspace(begin, end, 80)[1:]:
        last = last and box.at(value).motion(box.speed, last.start, last.torque)
    return last and last.start
