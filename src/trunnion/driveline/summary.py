"""How a driveline introduces itself: one short line per element, in engineering units."""

from __future__ import annotations

from trunnion.driveline.chain import ElementChain
from trunnion.driveline.elements import Disk, Element, Loaded
from trunnion.driveline.engine import Engine
from trunnion.driveline.quantities import INERTIA, LENGTH, STIFFNESS, shown
from trunnion.driveline.shafts import Shaft


def summary(line: ElementChain) -> str:
    """Title line, then name and numbers of each element."""
    chain = line.as_stated
    width = max(len(name) for name in chain.names)
    title = f"Driveline{f' {line.name!r}' if line.name else ''} of {len(chain.elements)} elements"
    if line.damping_ratio is not None:
        title += f", damping ratio {line.damping_ratio:g}"
    rows = []
    for i, (name, element) in enumerate(chain.parts):
        parts = [] if name.startswith(element.kind) else [element.kind]
        if chain.parents[i] != (i - 1 if i else None):
            parts.append(f"after {element.after}")
        rows.append(f"  {name:<{width}}  {', '.join([*parts, *_numbers(element)])}".rstrip())
    return "\n".join([title, *rows])


def _numbers(element: Element) -> list[str]:
    """The stated numbers, a geometry drawn together with what follows from it."""
    parts: list[str] = []
    drawn: tuple[str, ...] = ()
    if isinstance(element, Shaft) and element.stiffness is None:
        drawn = ("outer_diameter", "inner_diameter", "length", "shear_modulus", "density", "young_modulus")
        parts += [_size("tube", element, "length"), shown(element.torsional_stiffness, STIFFNESS, digits=4)]
        if element.density:
            parts.append(shown(element.moment_of_inertia, INERTIA, digits=4))
    if isinstance(element, Loaded) and getattr(element, "mass", None) is not None:
        parts.append(shown(element.moment_of_inertia, INERTIA, digits=4))
    elif isinstance(element, Disk) and element.inertia is None:
        drawn = ("outer_diameter", "inner_diameter", "thickness", "density")
        parts += [_size("disk", element, "thickness"), shown(element.moment_of_inertia, INERTIA, digits=4)]
    if isinstance(element, Engine):
        drawn = ("firing_order",)
        parts.append(firing(element))
    for key, value in element.stated.items():
        kind = element.quantity_of(key)
        if key in drawn or key in ("name", "after"):
            continue
        if key == "sheet":
            parts.append(f"from {value.component}")
            continue
        if key in _LISTS:
            count = len(value) if len(value) > 1 or key != "excitation" else "one"
            parts.append(f"{key.replace('_', ' ')} of {count} {_LISTS[key]}{'s' if len(value) > 1 else ''}")
            continue
        if key == "curve":
            parts.append(f"curve of {len(value)} points")
            continue
        if isinstance(value, tuple):
            parts.append(f"{key.replace('_', ' ')} {', '.join(shown(v, kind) if kind else str(v) for v in value)}")
            continue
        number = shown(value, kind) if kind else value
        if key == "loss_factor_frequency" and "loss_factor" in element.stated:
            parts[-1] += f" at {number}"
        else:
            parts.append(f"{key.replace('_', ' ')} {number}")
    return parts


_LISTS = {
    **dict.fromkeys(("excitation", "transmission_error", "stiffness_variation", "ripple", "gas_torque"), "harmonic"),
    "friction": "slider",
    **dict.fromkeys(("pressure", "compression"), "curve"),
    **dict.fromkeys(("oil", "curves"), "point"),
}
"""Lists of tables, and what one of them is."""


def firing(engine: Engine) -> str:
    """How many cylinders there are and how they fire: "6 cylinders, firing 1-5-3-6-2-4"."""
    order = engine.firing_order
    count = f"{len(order)} cylinders" if len(order) > 1 else "one cylinder"
    return f"{count}, firing {'-'.join(map(str, order))}" if len(order) > 1 else count


def _size(what: str, element: Element, along: str) -> str:
    keys = ("outer_diameter", "inner_diameter", along)
    outer, inner, length = (shown(getattr(element, key), LENGTH) for key in keys)
    bore = f" with bore {inner}" if element.stated["inner_diameter"] else ""
    return f"{what} {outer}{bore}, {length} long"
