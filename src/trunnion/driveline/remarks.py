"""What of a line does nothing, or holds in part only, by where its elements stand: said whenever a line is made.

Analyses say it as well (``trunnion.features``).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from math import inf, isfinite

from trunnion.driveline.chain import ElementChain
from trunnion.driveline.dampers import ViscousDamper
from trunnion.driveline.elements import ConstantSpeed, Rotor
from trunnion.driveline.machines import ElectricMachine
from trunnion.driveline.parts import Dragged, Sprung
from trunnion.driveline.quantities import FREQUENCY, LENGTH, shown
from trunnion.driveline.shafts import Shaft, SpringElement
from trunnion.driveline.slip_clutches import SlipClutch
from trunnion.driveline.vehicle import Tyre, Vehicle

HELD, SERIES = "excitation of a prescribed disk", "unlike damping in series"
DRAGGED, LAG = "damper without a spring", "lag of a motor"
OIL = "oil over frequency"
ALIKE = 1e-9
"""Relative difference of two c/k that counts as none."""


def prescribed_excitations(line: ElementChain) -> tuple[str, ...]:
    """Disks with an excitation whose rotation a ConstantSpeed holds: no shaft stands between."""
    group = rigid_groups(line)
    fixed = {g for g, element in zip(group, line.elements, strict=True) if isinstance(element, ConstantSpeed)}
    return tuple(
        name
        for name, element, g in zip(line.names, line.elements, group, strict=True)
        if isinstance(element, Rotor) and g in fixed and any(one.largest for one in element.excitation)
    )


def unlike_in_series(line: ElementChain) -> tuple[tuple[tuple[str, ...], float], ...]:
    """Springs in series without inertia between them whose c/k or loss factors differ.

    Names, and the lowest k/c [rad/s] (infinite without c) of each row.

    They count as one spring and damper, which holds at frequencies well below k/c.
    """
    if line.damping_ratio is not None:
        return ()
    group = rigid_groups(line)
    springs = [i for i, element in enumerate(line.elements) if isinstance(element, SpringElement)]
    heavy = {g for g, element in zip(group, line.elements, strict=True) if not isinstance(element, SpringElement)}
    for i in springs:
        element = line.elements[i]
        if isinstance(element, Shaft) and element.density:
            heavy |= {group[i], _near(line, group, i)}
    onward = Counter(_near(line, group, i) for i in springs)
    rows: dict[int, list[int]] = {}  # by the group at the far end of the last one
    for i in springs:
        near = _near(line, group, i)
        joined = near not in heavy and onward[near] == 1
        rows[group[i]] = [*(rows.pop(near, []) if joined else []), i]
    found = []
    for row in rows.values():
        times, losses = zip(*(_damping(line, i) for i in row), strict=True)
        if _unlike(times) or _unlike(losses):
            slowest = max(map(abs, times))
            found.append((tuple(line.names[i] for i in row), 1 / slowest if slowest else inf))
    return tuple(found)


def remarks(line: ElementChain) -> Iterator[tuple[str, str]]:
    """The feature (see ``trunnion.driveline.features``) and one sentence with its remedy."""
    for name in prescribed_excitations(line):
        clutch = _slip_clutch_before(line, name)
        does = f"does nothing while {clutch} sticks" if clutch else "does nothing"
        yield (
            HELD,
            f"{name}.excitation: {does}, a ConstantSpeed holds its rotation; leave out the ConstantSpeed and "
            f"give {name} drive_share = 1, or put a Shaft between",
        )
    for names, limit in unlike_in_series(line):
        holds = f"well below k/c = {limit:.3g} rad/s" if isfinite(limit) else "for small loss factors"
        yield (
            SERIES,
            f"{' and '.join(names)}: in series, with no inertia between and damping over stiffness different, they "
            f"count as one shaft, which holds {holds}; put a Disk between",
        )
    for name, element in zip(line.names, line.elements, strict=True):
        if isinstance(element, ElectricMachine) and element.lag_frequency is not None:
            corner = shown(element.lag_frequency, FREQUENCY, digits=4)
            yield (
                LAG,
                f"{name}: its torque lags above {corner}, as forced responses, modes and stability of straight lines "
                "and transients have it; elsewhere its slope is taken as quasi-static, which holds well below that",
            )

    for name, element in zip(line.names, line.elements, strict=True):
        if isinstance(element, ViscousDamper) and element.oil_frequency is not None:
            at, apart = shown(element.oil_frequency, FREQUENCY, digits=4), element.apart
            yield (
                OIL,
                f"{name}: forced responses of straight lines and natural_frequencies have its oil at their own "
                f"frequencies; all else as it is at {at}, simulate and transient a spring and a damper in series, up "
                f"to {100 * apart[1]:.2g} % off within a factor of 1.4 of that, the rest side by side, "
                f"{100 * apart[0]:.2g} % off",
            )

    for name, tyre, vehicle in _rolling(line):
        if tyre.radius is not None and abs(tyre.radius - vehicle.wheel_radius) > ALIKE * vehicle.wheel_radius:
            ratio = vehicle.wheel_radius / tyre.radius
            own, other = shown(tyre.radius, LENGTH), shown(vehicle.wheel_radius, LENGTH)
            yield (
                DRAGGED,
                f"{name}.radius: is {own} beside a wheel_radius of {other}; it turns as fast as all others, with no "
                f"wind-up; for a wheel of another size write {other} and Ratio(ratio={ratio:.6g}) in front of the tyre",
            )


def _rolling(line: ElementChain) -> Iterator[tuple[str, Tyre, Vehicle]]:
    """Every tyre and the vehicle that it carries."""
    for i, (name, tyre) in enumerate(zip(line.names, line.elements, strict=True)):
        if isinstance(tyre, Tyre):
            behind = [k for k, parent in enumerate(line.parents) if parent == i]
            places = [line.names.index(tyre.to)] if tyre.to in line.names else behind
            for k in places:
                vehicle = line.elements[k]
                if isinstance(vehicle, Vehicle):
                    yield name, tyre, vehicle


def _slip_clutch_before(line: ElementChain, name: str) -> str:
    """The last slip clutch on the way to the element of that name; "" for none."""
    place: int | None = line.names.index(name)
    while place is not None:
        if isinstance(line.elements[place], SlipClutch):
            return line.names[place]
        place = line.parents[place]
    return ""


def rigid_groups(line: ElementChain) -> list[int]:
    """Per element the rigid group that it belongs to, a spring or a mesh to the group at its far end."""
    group: list[int] = []
    for i, (element, parent) in enumerate(zip(line.elements, line.parents, strict=True)):
        elastic = any(isinstance(part, Sprung | Dragged) for part in element.passes_on)
        group.append(i if parent is None or elastic else group[parent])
    return group


def _near(line: ElementChain, group: list[int], spring: int) -> int:
    """The group in front of a spring; -1, which holds nothing, where the line begins with the spring."""
    parent = line.parents[spring]
    return -1 if parent is None else group[parent]


def _damping(line: ElementChain, spring: int) -> tuple[float, float]:
    """c/k [s], and the loss factor that holds at all frequencies; one of them is 0."""
    element = line.elements[spring]
    assert isinstance(element, SpringElement)
    if element.loss is not None and element.loss_factor_frequency is None:
        return 0.0, element.loss
    return element.damping_coefficient / element.torsional_stiffness, 0.0


def _unlike(values: tuple[float, ...]) -> bool:
    return max(values) - min(values) > ALIKE * max(map(abs, values))
