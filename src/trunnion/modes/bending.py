"""Bending critical speed of tube shafts, as a caution: the model itself is torsional only.

A uniform tube between two joints, taken as simply supported at their centres (both give way in bending),
whirls at its first bending frequency

    ω = (π/L)² √(EI/(ρA)),    I/A = (D² + d²)/16

(Euler–Bernoulli; shear, rotary inertia and the mass of the forks lower it, by some per cent for usual tubes).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.shafts import Shaft
from trunnion.equations.coefficients import Assembly, assemble

SAFE_SHARE = 0.75
"""Highest operating speed over critical speed that propeller-shaft practice allows."""
YOUNG_OVER_SHEAR = 2.6
"""E/G where only G is stated: 2(1 + ν) with Poisson's ratio 0.3."""


@dataclass(frozen=True)
class BendingSpeed:
    """First bending critical speed of one tube.

    critical_speed: of the tube itself [rad/s]; input_speed: that of the line's input then [rad/s];
    young_modulus [Pa], and whether it was taken from the shear modulus.
    """

    shaft: str
    critical_speed: float
    input_speed: float
    young_modulus: float
    assumed_modulus: bool


def tube_critical_speed(outer: float, inner: float, length: float, young_modulus: float, density: float) -> float:
    """First bending critical speed [rad/s] of a simply supported tube; diameters and length [m], E [Pa], ρ [kg/m³]."""
    return (pi / length) ** 2 * sqrt(young_modulus * (outer**2 + inner**2) / (16 * density))


def bending_speeds(line: Driveline | Assembly) -> tuple[BendingSpeed, ...]:
    """Critical speed of every shaft of ``line`` described as a tube with a density, in order.

    Parameters
    ----------
    line : a ``Driveline`` or its ``Assembly``.

    Examples
    --------
    >>> import trunnion as tn
    >>> tube = tn.Shaft(outer_diameter="90 mm", inner_diameter="84 mm", length="1.5 m", material="steel")
    >>> line = tn.Driveline([tn.ConstantSpeed(), tube, tn.Disk(inertia=0.8)])
    >>> round(tn.bending_speeds(line)[0].critical_speed, 2)
    691.59
    """
    assembly = assemble(line)
    assembly.require_one_speed(np.full(1, np.nan))
    described, topo = assembly.line, assembly.topology
    ratio = {e: abs(float(topo.speed_ratio[c.near])) for c in topo.compliances for e in c.shafts}
    found = []
    for place, (name, shaft) in enumerate(zip(described.names, described.elements, strict=True)):
        if not isinstance(shaft, Shaft) or not shaft.outer_diameter or not shaft.density:
            continue
        assert shaft.length and shaft.shear_modulus and shaft.inner_diameter is not None
        modulus = shaft.young_modulus or YOUNG_OVER_SHEAR * shaft.shear_modulus
        critical = tube_critical_speed(shaft.outer_diameter, shaft.inner_diameter, shaft.length, modulus, shaft.density)
        at_input = critical / ratio.get(place, 1.0)
        found.append(BendingSpeed(name, critical, at_input, modulus, shaft.young_modulus is None))
    return tuple(found)
