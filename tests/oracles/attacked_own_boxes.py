"""Boxes of bent pairs near the boundary of stability about their own motion, what is proved of them, and the motions
and multipliers at their corners and inside by the equations and the integration of ``bent_pair``."""

from __future__ import annotations

import numpy as np

from oracles.bent_pair import PERIOD, BentPair
from trunnion.floquet.certificate.box_coefficients import NumberRange
from trunnion.floquet.certificate.own_equations import MotionEquations
from trunnion.floquet.certificate.own_judge import OwnMotionLine, judged_motion
from trunnion.floquet.certificate.waves import Wave
from trunnion.floquet.tolerance.spread import read_tolerances

NUMBERS = {
    "shaft.stiffness": "stiffness",
    "load.inertia": "inertia",
    "joint.angle": "angle",
    "load.load_torque": "load_torque",
}
STEPS = 7
"""In which the damping at the boundary is found."""


def shares(wave: Wave, p: np.ndarray) -> np.ndarray:
    """By which the rows of a wave count: products of Chebyshev polynomials of the parameters."""
    if wave.terms is None:
        return np.concatenate([[1.0], p])[: len(wave.parts)]
    return np.cos(np.array(wave.terms.exponents) * np.arccos(p)).prod(axis=1)


def value(wave: Wave, phi: float, p: np.ndarray) -> float:
    """Of a wave."""
    order = np.arange(-wave.last, wave.last + 1)
    return float((shares(wave, p) @ wave.parts @ np.exp(2j * order * phi)).real)


def counted(own: MotionEquations, pair: BentPair, p: np.ndarray) -> np.ndarray:
    """What is added to the states of the waves for those of the pair: its twists count from a fixed one."""
    return np.array([(value(own.co.torque[0], 0.0, p) + pair.mean) / pair.stiffness, 0.0, 0.0])


def radius(pair: BentPair) -> float:
    """About the motion at its middle speed; infinite where none is found."""
    try:
        begins = OwnMotionLine(pair.line).begun((pair.middle * (1 - 1e-9), pair.middle * (1 + 1e-9)), [])
    except (ZeroDivisionError, np.linalg.LinAlgError):
        return np.inf
    if begins is None:
        return np.inf
    own, motion = begins
    p = np.zeros(1)
    start = np.array([value(one, 0.0, p) for one in motion.states]) + counted(own, pair, p)
    return float(np.abs(pair.at(extra=value(motion.drive, 0.0, p)).periodic(start)[1]).max())


def near_boundary(rng: np.random.Generator) -> BentPair:
    """A pair near a resonance of its joint with its mode, hardly damped enough."""
    engine, inertia, stiffness = 10 ** rng.uniform(-0.3, 0.3, 3) * (1.2, 0.8, 9e3)
    mode = np.sqrt(stiffness * (1 / engine + 1 / inertia))
    middle = mode * rng.choice([1.0, 0.5, 1.0 / 3]) * (1 + rng.choice([-1, 1]) * 10 ** rng.uniform(-4, -1.5))
    pair = BentPair(
        float(middle), engine=float(engine), inertia=float(inertia), stiffness=float(stiffness),
        angle=float(rng.uniform(0.1, 0.7)), load_torque=float(rng.uniform(0, 80)),
        viscous=float(rng.uniform(0.01, 0.4)), quadratic=float(rng.uniform(0, 4e-3)),
    )  # fmt: skip
    low, high = -2.0, 1.5
    for _ in range(STEPS):
        half = (low + high) / 2
        low, high = (half, high) if radius(pair.at(damping=10**half)) > 1 else (low, half)
    return pair.at(damping=float(10**high * (1 + 10 ** rng.uniform(-1.5, 0.7))))


def attack_own(rng: np.random.Generator, boxes: int, points: int, said: str, widest: float = -2.5) -> int:
    """How many ``boxes`` around one pair, with tolerances of 10^``widest`` at most, are proved; fails where a line at
    one of their ``points`` moves outside the tube, or disturbances die out slower than proved."""
    pair, proved = near_boundary(rng), 0
    line = OwnMotionLine(pair.line)
    for box in range(boxes):
        wide = 10 ** rng.uniform(-5, -1.5)
        share = {name: 10 ** rng.uniform(widest - 3.5, widest) for name in NUMBERS if rng.random() < 0.4}
        speeds = pair.middle * (1 - wide / 2), pair.middle * (1 + wide / 2)
        read = read_tolerances(line.assembly, share) if share else ()
        ranges = [NumberRange(s.label, s.columns, s.low, s.high) for s in read]
        try:
            begins = line.begun(speeds, ranges, float(rng.choice([0.01, 1.0])) * wide / pair.middle)
            found = None if begins is None else judged_motion(*begins, speeds)
        except (ZeroDivisionError, np.linalg.LinAlgError):
            continue
        if begins is None or found is None or found.tube is None:
            continue
        proved, (own, _), tube = proved + 1, begins, found.tube
        for k in range(points):
            p = rng.uniform(-1, 1, 1 + len(ranges))
            p = np.sign(p) if k % 2 == 0 else p
            numbers = {
                NUMBERS[one.label]: (one.low + one.high) / 2 + (one.high - one.low) / 2 * float(at)
                for one, at in zip(ranges, p[1:], strict=True)
            }
            other = _inertia_by_inverse(ranges, p, pair.at(**numbers))
            other = other.at(extra=value(tube.drive, 0.0, p))
            beside = counted(own, other, p)
            path, multipliers = other.periodic(np.array([value(one, 0.0, p) for one in tube.states]) + beside)
            for i, phi in enumerate(np.linspace(0, PERIOD, 33)):
                for state, one in zip(path[i] - beside, tube.states, strict=True):
                    assert abs(state - value(one, phi, p)) <= one.rest + 1e-8 * abs(state), (said, box, k)
            rate = -np.log(np.abs(multipliers).max()) * speeds[0] / PERIOD
            assert rate >= found.verdict.decay * (1 - 1e-6) - 1e-7, (said, box, k, rate, found.verdict.decay)
    return proved


def _inertia_by_inverse(ranges: list[NumberRange], p: np.ndarray, pair: BentPair) -> BentPair:
    """The parameter of an inertia goes evenly through its inverse."""
    for one, at in zip(ranges, p[1:], strict=True):
        if one.label == "load.inertia":
            ends = 1 / one.low, 1 / one.high
            return pair.at(inertia=1 / ((ends[0] + ends[1]) / 2 + (ends[1] - ends[0]) / 2 * float(at)))
    return pair
