"""What is odd about the numbers of an engine, though nothing forbids it: units, angles, pressure curves with gaps."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from math import pi
from typing import Protocol

from trunnion.driveline.cylinder_torque import Cylinders, mean_torque
from trunnion.driveline.elements import Doubt
from trunnion.driveline.quantities import DEGREE

LOWEST_MEAN, HIGHEST_MEAN = 2e4, 8e6
"""Mean indicated pressures [Pa] beyond which the unit is doubted."""
LARGEST = {"bore": 1.5, "stroke": 5.0}
"""Lengths [m] above which the unit is doubted: the largest two-strokes have 0.98 m and 3.5 m."""
LIGHTEST, HEAVIEST = 1e2, 1e5
"""Reciprocating mass over the cube of the bore [kg/m³] beyond which the unit is doubted: small pistons have some 1000,
those of slow two-strokes with crosshead up to some 30 000."""
SPARSE = 60 * DEGREE
"""Crank angle without a point of a pressure curve above which that is said."""
SAME_ANGLE = 0.01 * DEGREE


class Banks(Cylinders, Protocol):
    """What of an ``Engine`` is looked at besides its cylinders; units as there."""

    @property
    def drive_share(self) -> float: ...
    @property
    def bank_angle(self) -> float | None: ...
    @property
    def on_throws(self) -> tuple[tuple[int, ...], ...]: ...
    @property
    def firing_angles(self) -> tuple[float, ...]: ...


def doubts_of(engine: Banks) -> Iterator[Doubt]:
    """What is odd, and what to do about it."""
    yield from _units(engine)
    yield from _curves(engine)
    yield from _banks(engine)


def _units(engine: Banks) -> Iterator[Doubt]:
    means = engine.mean_indicated_pressure
    if means and not LOWEST_MEAN <= min(means) <= max(means) <= HIGHEST_MEAN:
        odd = min(means) if min(means) < LOWEST_MEAN else max(means)
        yield "mean_indicated_pressure", f"is {odd / 1e5:.4g} bar", "check its unit: Pa read as bar, or bar as Pa, say"
    for key, most in LARGEST.items():
        length = getattr(engine, key)
        if length is not None and length > most:
            yield key, f"is {length:g} m, more than any engine has", 'check its unit: write "230 mm", say'
    if engine.bore is not None and engine.reciprocating_mass is not None:
        filled = engine.reciprocating_mass / engine.bore**3
        if not LIGHTEST <= filled <= HEAVIEST:
            weight = "light" if filled < LIGHTEST else "heavy"
            problem = f"is {engine.reciprocating_mass:.4g} kg, too {weight} for a bore of {1e3 * engine.bore:.4g} mm"
            yield "reciprocating_mass", problem, "check the units of both: g read as kg, or kg as g, say"


def _curves(engine: Banks) -> Iterator[Doubt]:
    """Of pressure curves: long stretches without a point, and a cylinder that fires and brakes."""
    for curve in engine.pressure:
        at = "" if curve.load is None else f" at load {curve.load:g}"
        before, behind = max(pairwise(curve.angles), key=lambda ends: ends[1] - ends[0])
        if behind - before > SPARSE:
            problem = f"has no point from {before / DEGREE:.6g} deg to {behind / DEGREE:.6g} deg{at}"
            yield "pressure", problem, "it is taken as linear there; give a point every 2 deg, say"
        if engine.drive_share and (mean := mean_torque(engine, curve)) < 0:
            problem = f"brakes{at}: its mean torque over the cycle is {mean:.4g} N m"
            yield "pressure", problem, "check its angles: 0 is the top dead centre at which it fires"


def _banks(engine: Banks) -> Iterator[Doubt]:
    """Cylinders of one throw that fire otherwise than their banks stand."""
    if engine.bank_angle is None:
        return
    for a, b in engine.on_throws:
        apart = engine.firing_angles[b - 1] - engine.firing_angles[a - 1]
        off = min(abs((apart - side * engine.bank_angle + pi) % (2 * pi) - pi) for side in (1, -1))
        if off > SAME_ANGLE:
            problem = f"does not fit the firing order: cylinders {a} and {b} share a throw and fire"
            problem += f" {apart % (2 * pi) / DEGREE:.6g} deg apart"
            yield "bank_angle", problem, "check the order, unless their pins are split"
            return
