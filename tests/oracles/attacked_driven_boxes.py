"""Boxes of driven, loaded, swinging lines near the boundary of stability about their own motion, what is proved of
them, and the motions and multipliers at their corners and inside by the equations and the integration of
``swung_trees``."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import trunnion as tn
from oracles.attacked_own_boxes import value
from oracles.random_swung_lines import damped, moved, random_swung_line
from oracles.swung_trees import SwungTree, _passed
from trunnion.floquet.certificate.box_coefficients import NumberRange
from trunnion.floquet.certificate.own_equations import MotionEquations, MotionWaves
from trunnion.floquet.certificate.own_judge import OwnMotionLine, judged_motion
from trunnion.floquet.tolerance.spread import read_tolerances

Array = NDArray[np.float64]
STEPS = 9
"""In which the damping at the boundary is found."""
SCATTERS = {"Shaft": ("stiffness", "damping", "fork_offset"), "HookeJoint": ("angle", "plane"),
            "Disk": ("inertia", "load_torque")}  # fmt: skip
"""Numbers by the kind of their element."""


class Attack(NamedTuple):
    """How many boxes were judged and proved; the least rate over that proved, of all points."""

    judged: int
    proved: int
    points: int
    nearest: float


def near_boundary(seed: int) -> tuple[tn.Driveline, float, np.random.Generator]:
    """A line and a speed near a resonance of two of its modes, hardly damped enough."""
    line, rng = random_swung_line(seed, driven=True)
    modes = SwungTree(line).modes()
    i, j = rng.integers(len(modes), size=2)
    order = rng.choice([1.0, 1.0, 0.5])
    speed = float((modes[i] + modes[j]) / 2 * order * (1 + rng.choice([-1, 1]) * 10 ** rng.uniform(-4, -1.5)))
    low, high = -2.0, 2.0
    for _ in range(STEPS):
        half = (low + high) / 2
        low, high = (low, half) if SwungTree(damped(line, 10**half)).radius(speed) < 1 else (half, high)
    return damped(line, float(10**high * (1 + 10 ** rng.uniform(-2, 0.7)))), speed, rng


def start_of(tree: SwungTree, own: MotionEquations, tube: MotionWaves, p: Array, speed: float) -> tuple[Array, Array]:
    """The state of the ``tree`` (2n,) at zero rotation in the middle of a tube, and how far the tube reaches: twists
    follow the walk from the drive on."""
    a, v = np.zeros(tree.n), np.full(tree.n, speed)
    twist = [
        value(q, 0.0, p) + value(t, 0.0, p) / k
        for q, t, k in zip(tube.twist, own.co.torque, (row[6] for row in tree.springs), strict=True)
    ]
    for e, (near, far, angle, plane, bent, over, _, _, fork) in enumerate(tree.springs):
        n, _, _, _ = _passed(a[int(near)], angle, plane, bent)
        a[int(far)], v[int(far)] = over * n + fork + twist[e], value(tube.speed[int(far) - 1], 0.0, p)
    reach = np.array([one.rest for one in tube.states])
    return np.concatenate([a, v]), reach


def twists_of(tree: SwungTree, state: Array) -> Array:
    """Twists of the springs and speeds of what they drive (2 springs,) of a state."""
    a, v = state[: tree.n], state[tree.n :]
    twist = []
    for near, far, angle, plane, bent, over, _, _, fork in tree.springs:
        n, _, _, _ = _passed(a[int(near)], angle, plane, bent)
        twist.append(a[int(far)] - over * n - fork)
    return np.array([*twist, *v[1:]])


def attack_driven(seed: int, boxes: int, points: int) -> Attack:
    """``boxes`` around one line near its boundary, of any width."""
    line, middle, rng = near_boundary(seed)
    parts, given = dict(line.parts), []
    paths = [f"{name}.{key}" for name, part in line.parts for key in SCATTERS.get(part.kind, ()) if name != "d0"]
    for _ in range(boxes):
        wide = 10 ** rng.uniform(-5, -0.7)
        speeds = middle * (1 - wide * rng.uniform(0, 1)), middle * (1 + wide * rng.uniform(0, 1))
        shares = {path: float(10 ** rng.uniform(-6, -1.5)) for path in paths if rng.random() < 2.5 / len(paths)}
        some = {path: share for path, share in shares.items() if _number(parts, path)}
        given.append((speeds, some))
    return attack_boxes(line, given, points, rng)


def _number(parts: dict[str, Any], path: str) -> float:
    name, _, key = path.rpartition(".")
    return float(getattr(parts[name], key) or 0.0)


def attack_boxes(
    line: tn.Driveline,
    boxes: list[tuple[tuple[float, float], dict[str, float]]],
    points: int,
    rng: np.random.Generator,
    turn: float = np.pi,
) -> Attack:
    """Boxes of speeds and shares of numbers by path, of a line of period ``turn`` [rad]; fails where a line at one of
    ``points`` in a box that is proved has no motion in the tube, or one that decays slower than proved."""
    own_line, parts, proved, looked, nearest = OwnMotionLine(line), dict(line.parts), 0, 0, np.inf
    for box, (speeds, shares) in enumerate(boxes):
        given = {}
        for path, share in shares.items():
            number = _number(parts, path)
            given[path] = ("range", *sorted((number * (1 - share), number * (1 + share))))
        read = read_tolerances(own_line.assembly, given) if given else ()
        ranges = [NumberRange(s.label, s.columns, s.low, s.high) for s in read]
        try:
            begins = own_line.begun(speeds, ranges)
            found = None if begins is None else judged_motion(*begins, speeds)
        except (ArithmeticError, np.linalg.LinAlgError):
            continue
        if begins is None or found is None or found.tube is None:
            assert found is None or not found.verdict.proved
            continue
        if any((one - one.mean).size >= one.mean.real for one in found.tube.speed):
            continue  # what turns back: loads of the trees turn with it, those of the package with the mean
        proved, (own, _), tube = proved + 1, begins, found.tube
        for k in range(points):
            p = rng.uniform(-1, 1, 1 + len(ranges))
            p = np.sign(p) if k % 2 == 0 else p
            speed = (speeds[0] + speeds[1]) / 2 + (speeds[1] - speeds[0]) / 2 * float(p[0])
            tree = SwungTree(moved(line, _numbers(own, ranges, p)), turn)
            start, reach = start_of(tree, own, tube, p, speed)
            motion = tree.motion(speed, start)
            assert motion is not None, (box, k)
            off = np.abs(twists_of(tree, motion.start) - twists_of(tree, start))
            assert np.all(off <= reach + 1e-8 * (1 + np.abs(start).max())), (box, k, off, reach)
            rate = -np.log(motion.radius) * speed / tree.turn
            assert rate >= found.verdict.decay * (1 - 1e-6) - 1e-7, (box, k, rate, found.verdict.decay)
            looked, nearest = looked + 1, min(nearest, rate / found.verdict.decay)
    return Attack(len(boxes), proved, looked, float(nearest))


def _numbers(own: MotionEquations, ranges: list[NumberRange], p: Array) -> dict[str, float]:
    """Numbers by path at parameters ``p``; that of an inertia which stands alone goes evenly through its inverse."""
    found = {}
    for k, (one, at) in enumerate(zip(ranges, p[1:].tolist(), strict=True)):
        by_inverse = any(wave.parts[2 + k].any() for wave in own.co.over_mass.values())
        if by_inverse:
            ends = 1 / one.low, 1 / one.high
            found[one.label] = 1 / ((ends[0] + ends[1]) / 2 + (ends[1] - ends[0]) / 2 * at)
        else:
            found[one.label] = (one.low + one.high) / 2 + (one.high - one.low) / 2 * at
    return found
