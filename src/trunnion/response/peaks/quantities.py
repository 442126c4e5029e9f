"""What is bounded of a line: measures of every spring and of every inertia, in the order that arrays have them."""

from __future__ import annotations

from trunnion.equations.coefficients import Assembly
from trunnion.steady.orders.forced_response import shaft_names

SWING, LARGEST, TWIST, SPEED = "vibratory torque", "largest torque", "vibratory twist", "speed fluctuation"
UNITS = {SWING: "N m", LARGEST: "N m", TWIST: "rad", SPEED: "rad/s"}
OF_SPRINGS, OF_INERTIAS = (SWING, LARGEST, TWIST), (SPEED,)


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
