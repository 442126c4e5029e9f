"""What is bounded of a line: measures of every spring and of every inertia, in the order that arrays have them."""

from __future__ import annotations

import numpy as np

from trunnion.equations.coefficients import Assembly
from trunnion.results.units import figures
from trunnion.steady.orders.forced_response import shaft_names

SWING, LARGEST, TWIST, FURTHEST = "vibratory torque", "largest torque", "vibratory twist", "largest twist"
RATED, HEAT = "rated torque", "heat"
SPEED, ACCELERATION = "speed fluctuation", "acceleration"
UNITS = {
    SWING: "N m", LARGEST: "N m", TWIST: "rad", FURTHEST: "rad", RATED: "N m", HEAT: "W", SPEED: "rad/s",
    ACCELERATION: "rad/s²",
}  # fmt: skip
OF_SPRINGS, OF_INERTIAS = (SWING, LARGEST, TWIST, FURTHEST, RATED, HEAT), (SPEED, ACCELERATION)
ALWAYS = (SWING, LARGEST, TWIST, SPEED)
"""Measures whose bounds are brought close to what was computed; others only where a limit is stated."""
RATED_UP_TO = 1000.0
"""Frequency [Hz] up to which orders are sure to count in a rated torque."""


def in_unit(measure: str, value: float, digits: int = 4) -> str:
    """A value with its unit; twists in degrees."""
    if UNITS[measure] == "rad":
        return f"{figures(float(np.degrees(value)), digits)} deg"
    return f"{figures(value, digits)} {UNITS[measure]}"


def quantities_of(assembly: Assembly) -> list[tuple[str, str]]:
    """Measure and name of the spring or inertia of every quantity."""
    springs, inertias = shaft_names(assembly), [name for _, name in assembly.topology.points]
    found = [(measure, name) for measure in OF_SPRINGS for name in springs]
    return found + [(measure, name) for measure in OF_INERTIAS for name in inertias]


def place_of(assembly: Assembly, measure: str, number: int) -> int:
    """Where the quantity ``measure`` of spring or inertia ``number`` stands."""
    springs, inertias = len(assembly.topology.compliances), len(assembly.topology.points)
    if measure in OF_SPRINGS:
        return OF_SPRINGS.index(measure) * springs + number
    return len(OF_SPRINGS) * springs + OF_INERTIAS.index(measure) * inertias + number
