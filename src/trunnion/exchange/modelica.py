"""A line as a model of Modelica.Mechanics.Rotational, each element with its name as its comment.

Gears count both shafts in one sense (φ_a = ratio φ_b). Where the input speed is stated the drive turns with it and
loads act; where it is not the drive stands (``Fixed``), about which a straight line vibrates alike.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator

import numpy as np

from trunnion.exchange.network import (
    FlangeDrive,
    FlangeGear,
    FlangeInertia,
    FlangeSpring,
    Item,
    Network,
    refuse_viscous_at_no_speed,
)

ROTATIONAL = "Modelica.Mechanics.Rotational"
KEYWORDS = frozenset(
    "algorithm and annotation assert block break class connect connector constant constrainedby der discrete "
    "each else elseif elsewhen encapsulated end enumeration equation expandable extends external false final "
    "flow for function if import impure in initial inner input loop model not operator or outer output package "
    "parameter partial protected public pure record redeclare replaceable return stream then true type when "
    "while within".split()
)
"""Words of the language (Modelica 3.6, section 2.3.3), which name nothing."""
TAKEN = frozenset({"Modelica", "Real", "Integer", "Boolean", "String", "time"})
"""Names that a component would hide."""


def model_of(network: Network) -> str:
    """The text of the model.

    Raises
    ------
    InputError : a viscous load on a line whose speed is not stated.
    """
    refuse_viscous_at_no_speed(network)
    names = _Identifiers()
    title = names.new(network.name or "Line")
    declared: list[str] = []
    ports: dict[int, list[str]] = {}
    for one in network.items:
        for text, ends in _declarations(one, network, names):
            declared.append(f"  {ROTATIONAL}.{text};")
            for flange, port in ends:
                ports.setdefault(flange, []).append(port)
    joined = [f"  connect({first}, {other});" for first, *others in ports.values() for other in others]
    comment = f" {_text(network.name)}" if network.name else ""
    return "\n".join([f"model {title}{comment}", *declared, "equation", *joined, f"end {title};", ""])


Declared = tuple[str, list[tuple[int, str]]]


def _declarations(one: Item, network: Network, names: _Identifiers) -> Iterator[Declared]:
    """What declares an item, and which of its ports stand at which flange."""
    key, comment = names.new(one.name), _text(one.name)
    match one:
        case FlangeDrive(_, at, None):
            yield f"Components.Fixed {key} {comment}", [(at, f"{key}.flange")]
        case FlangeDrive(_, at, turns):
            yield f"Sources.ConstantSpeed {key}(w_fixed={turns!r}) {comment}", [(at, f"{key}.flange")]
        case FlangeSpring(_, near, far, stiffness, damping):
            ends = [(near, f"{key}.flange_a"), (far, f"{key}.flange_b")]
            yield f"Components.SpringDamper {key}(c={stiffness!r}, d={damping!r}) {comment}", ends
        case FlangeGear(_, near, far, ratio):
            yield (
                f"Components.IdealGear {key}(ratio={ratio}) {comment}",
                [
                    (near, f"{key}.flange_a"),
                    (far, f"{key}.flange_b"),
                ],
            )
        case FlangeInertia(name, at, inertia, load, viscous):
            start = "" if network.speed is None else f", w(start={network.speed * network.turning[at]!r})"
            yield f"Components.Inertia {key}(J={inertia!r}{start}) {comment}", [(at, f"{key}.flange_a")]
            if load:
                torque = float(-np.sign(network.turning[at]) * load)
                source = names.new(f"load of {name}")
                yield f"Sources.ConstantTorque {source}(tau_constant={torque!r})", [(at, f"{source}.flange")]
            if viscous:
                drag, ground = names.new(f"drag of {name}"), names.new(f"ground of {name}")
                own = -2 - len(names.taken)  # a flange of its own, which is none of the line
                yield f"Components.Damper {drag}(d={viscous!r})", [(at, f"{drag}.flange_a"), (own, f"{drag}.flange_b")]
                yield f"Components.Fixed {ground}", [(own, f"{ground}.flange")]


class _Identifiers:
    """Names that the language takes: ASCII letters, digits and underscores, each once."""

    def __init__(self) -> None:
        self.taken: set[str] = set()

    def new(self, name: str) -> str:
        plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
        plain = re.sub(r"[^A-Za-z0-9]+", "_", plain).strip("_") or "part"
        if plain[0].isdigit() or plain in KEYWORDS | TAKEN:
            plain = f"part_{plain}"
        found, number = plain, 1
        while found in self.taken:
            number += 1
            found = f"{plain}_{number}"
        self.taken.add(found)
        return found


def _text(name: str) -> str:
    """A text of the language, in quotes."""
    escaped = name.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
