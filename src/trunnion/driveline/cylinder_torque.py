"""Torques of one cylinder of an engine by order: of the gas while it fires and while it does not, and of its masses."""

from __future__ import annotations

from cmath import phase
from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import pairwise
from math import pi
from typing import TYPE_CHECKING, Protocol

from trunnion.driveline.cylinders import MOST_ORDERS, reciprocating_mass
from trunnion.driveline.excitation import Excitation
from trunnion.errors import InputError

if TYPE_CHECKING:
    from trunnion.driveline.pressure import PressureCurve
    from trunnion.laws.indicated_cycle import IndicatedCycle

ROUNDING = 1e-12
"""Share of the largest below which a harmonic is rounding."""
DISTINCT = 1e-6
"""Share of the largest mean torque by which those of two curves have to differ."""
_Torque = tuple[float, tuple[complex, ...]]
"""Mean torque [N m] of one cylinder, and its harmonics."""


class Cylinders(Protocol):
    """What of an ``Engine`` its cylinders are known by; units as there."""

    @property
    def strokes(self) -> int: ...
    @property
    def cycle(self) -> float: ...
    @property
    def orders(self) -> float: ...
    @property
    def bore(self) -> float | None: ...
    @property
    def stroke(self) -> float | None: ...
    @property
    def rod_length(self) -> float | None: ...
    @property
    def reciprocating_mass(self) -> float | None: ...
    @property
    def gas_torque(self) -> tuple[Excitation, ...]: ...
    @property
    def pressure(self) -> tuple[PressureCurve, ...]: ...
    @property
    def compression(self) -> tuple[PressureCurve, ...]: ...
    @property
    def mean_indicated_pressure(self) -> tuple[float, ...]: ...
    @property
    def peak_pressure(self) -> tuple[float, ...]: ...
    @property
    def charge_pressure(self) -> tuple[float, ...]: ...
    @property
    def compression_ratio(self) -> float | None: ...
    @property
    def polytropic_exponent(self) -> float | None: ...
    @property
    def expansion_exponent(self) -> float | None: ...
    @property
    def crankcase_pressure(self) -> float: ...
    def closes(self, curve: PressureCurve, /) -> bool: ...


def for_several(law: Excitation, cylinders: int) -> Excitation:
    """The harmonic of one cylinder on a disk that bears several, by the mean torque of that disk."""
    if law.share is not None:
        return law.but(share=law.share / cylinders)
    return law.but(torques=tuple(cylinders * one for one in law.torques)) if law.torques else law


@lru_cache(maxsize=64)
def masses(engine: Cylinders) -> tuple[tuple[Excitation, ...], float]:
    """Inertia torques of one cylinder, and the mean inertia of its masses."""
    if engine.reciprocating_mass is None or engine.stroke is None or engine.rod_length is None:
        return (), 0.0
    orders = min(int(engine.orders), MOST_ORDERS)
    found, mean = reciprocating_mass(engine.reciprocating_mass, engine.stroke / 2, engine.rod_length, orders)
    largest = max(one.largest for one in found)
    return tuple(one for one in found if abs(one.largest) > ROUNDING * largest), mean


@lru_cache(maxsize=64)
def gas(engine: Cylinders) -> tuple[Excitation, ...]:
    """Gas torques of one cylinder by its own mean torque."""
    if engine.mean_indicated_pressure:
        return _over_load(engine, _indicated(engine))
    if not engine.pressure:
        return engine.gas_torque
    found = sorted((_torque(engine, one) for one in engine.pressure), key=lambda one: one[0])
    means = [mean for mean, _ in found]
    if any(b - a <= DISTINCT * max(map(abs, means)) for a, b in pairwise(means)):
        remedy = "leave one of them out; what tells loads apart is their mean torque"
        raise InputError("has two curves of the same mean torque", key="pressure", remedy=remedy)
    return _over_load(engine, found)


def mean_torque(engine: Cylinders, curve: PressureCurve) -> float:
    """Mean torque [N m] of a cylinder under a pressure curve, positive where it drives."""
    return _torque(engine, curve)[0]


@lru_cache(maxsize=64)
def compression(engine: Cylinders) -> tuple[Excitation, ...]:
    """Gas torques of a cylinder that does not fire."""
    if engine.compression:
        return _over_load(engine, [_torque(engine, engine.compression[0])])
    ratio, exponent, charges = engine.compression_ratio, engine.polytropic_exponent, engine.charge_pressure
    if ratio is None or exponent is None or not charges:
        return ()
    from trunnion.laws.indicated_cycle import without_fire

    found = [_of_cycle(engine, without_fire(ratio, charge, exponent), 1.0) for charge in charges]
    if len(found) > 1:  # each stands for the load at which the others fire
        found = [(mean, harmonics) for (mean, _), (_, harmonics) in zip(_indicated(engine), found, strict=True)]
    return _over_load(engine, found)


def cycles(engine: Cylinders) -> Iterator[tuple[float, IndicatedCycle]]:
    """Every mean indicated pressure [Pa] with its cycle; nothing is left out."""
    from trunnion.laws.indicated_cycle import IndicatedCycle

    ratio, exponent = engine.compression_ratio, engine.polytropic_exponent
    assert ratio is not None and exponent is not None
    means = engine.mean_indicated_pressure
    peaks, charges = (
        one * len(means) if len(one) == 1 else one for one in (engine.peak_pressure, engine.charge_pressure)
    )
    expansion = engine.expansion_exponent or exponent
    for mean, peak, charge in zip(means, peaks, charges, strict=True):
        yield mean, IndicatedCycle(ratio, charge, exponent, expansion, peak)


def _indicated(engine: Cylinders) -> list[_Torque]:
    return [_of_cycle(engine, cycle, cycle.cut_off(mean)) for mean, cycle in cycles(engine)]


def _of_cycle(engine: Cylinders, cycle: IndicatedCycle, cut_off: float) -> _Torque:
    import numpy as np

    share, lever = _crank(engine)
    orders = np.array(_orders(engine))
    mean, found = cycle.harmonics(cut_off, share, engine.cycle, engine.crankcase_pressure, orders)
    return lever * mean, tuple(complex(lever * c) for c in found)


def _crank(engine: Cylinders) -> tuple[float, float]:
    """λ = r/l, and what a pressure is multiplied by to be a torque, A r [m³]."""
    assert engine.bore is not None and engine.stroke is not None and engine.rod_length is not None
    return engine.stroke / 2 / engine.rod_length, pi / 4 * engine.bore**2 * engine.stroke / 2


def _orders(engine: Cylinders) -> tuple[float, ...]:
    """Orders per turn of what repeats with the cycle."""
    step = 2 / engine.strokes
    return tuple(step * n for n in range(1, int(engine.orders / step + 1e-9) + 1))


def _over_load(engine: Cylinders, found: Sequence[_Torque]) -> tuple[Excitation, ...]:
    """Harmonics of every order, over the mean torque where there are several."""
    orders = _orders(engine)
    if len(found) == 1:
        pairs = zip(orders, found[0][1], strict=True)
        return tuple(Excitation(order=k, amplitude=abs(c), phase=phase(c)) for k, c in pairs)
    means = [mean for mean, _ in found]
    table = [[harmonics[i] for _, harmonics in found] for i in range(len(orders))]
    return tuple(
        Excitation(order=k, torques=means, amplitudes=[abs(c) for c in row], phases=[phase(c) for c in row])
        for k, row in zip(orders, table, strict=True)
    )


def _torque(engine: Cylinders, curve: PressureCurve) -> _Torque:
    """Under a curve."""
    import numpy as np

    from trunnion.laws.gas_torque import gas_harmonics

    angles, pressures = np.array(curve.angles), np.array(curve.pressures) - engine.crankcase_pressure
    if engine.closes(curve):
        angles[-1], pressures[[0, -1]] = angles[0] + engine.cycle, (pressures[0] + pressures[-1]) / 2
    else:
        angles, pressures = np.append(angles, angles[0] + engine.cycle), np.append(pressures, pressures[0])
    share, lever = _crank(engine)
    mean, harmonics = gas_harmonics(angles, pressures, share, np.array(_orders(engine)))
    return lever * mean, tuple(complex(lever * c) for c in harmonics)
