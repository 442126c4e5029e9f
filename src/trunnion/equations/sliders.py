"""Sliders of clutches: where dry friction acts in a line, and when each sticks and slips.

The deflection x of a slider's spring follows the twist of its clutch while it sticks and stands at ± T/k while it
slips; its torque is kx throughout. It sticks while |x| < T/k, and slips until the twist rate turns its sign.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from trunnion.arrays import Array
from trunnion.driveline.clutches import Clutch
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Element
from trunnion.driveline.parameters import PackedLine
from trunnion.equations.topology import Topology
from trunnion.errors import InputError
from trunnion.laws.stages import Stages, slider_stages


@dataclass(frozen=True)
class PlacedSlider:
    """One slider: the compliance it is part of, its torque [N m] and the stiffness [N m/rad] of its spring."""

    name: str
    compliance: int
    torque: float
    stiffness: float

    @property
    def reach(self) -> float:
        """Deflection [rad] at which it slips."""
        return self.torque / self.stiffness

    @property
    def stages(self) -> Stages:
        """Slips back, sticks, slips on."""
        return slider_stages(self.stiffness, self.reach)


def sliders(packed: PackedLine, topo: Topology, row: Array) -> tuple[PlacedSlider, ...]:
    """All sliders of a line at one row of packed numbers.

    Raises
    ------
    InputError : a torque or stiffness that is not positive, where parameters were varied.
    """
    found, column = [], packed.column
    for e, compliance in enumerate(topo.compliances):
        place = compliance.shafts[0]
        element, name = packed.line.elements[place], packed.line.names[place]
        for i in range(1, len(element.friction) + 1 if isinstance(element, Clutch) else 1):
            torque, stiffness = (float(row[column(place, f"friction {i} {k}")]) for k in ("torque", "stiffness"))
            for key, value in (("torque", torque), ("stiffness", stiffness)):
                if not value > 0:
                    raise InputError("must be positive", element=name, key=f"friction {i} {key}", value=value)
            found.append(PlacedSlider(f"{name} slider {i}", e, torque, stiffness))
    return tuple(found)


def beyond_capacity(name: str, torque: float, most: float, reach: float) -> tuple[str, str]:
    """What is wrong with a slider that starts with a ``torque`` [N m] beyond the ``most`` that it holds, where its
    spring is deflected by ``reach`` [rad]; and the remedy."""
    words = f"loads {name} with {torque:.6g} N m, beyond the {most:.6g} N m at which it slips"
    return words, f"start its deflection between {-reach:.6g} and {reach:.6g} rad"


LINEAR = "whose torque depends on how far it moves: linear equations have none"
NOT_FOLLOWED = "whose sliders change between sticking and slipping, which this analysis does not follow"
_MOTION = 'linear_amplitude = "1 deg" and linear_frequency = "30 Hz"'
STATE_A_MOTION = f"write {_MOTION}, the motion at which linear analyses take its mean stiffness and loss"
STAND_IN = (
    'put clutch.linear(amplitude="1 deg", frequency="30 Hz") in its place, a Shaft with its mean stiffness and loss'
)
"""What a linear analysis can do, and one that could follow all but the friction."""


def refuse_friction(
    line: Driveline,
    why: str = LINEAR,
    remedy: str = STATE_A_MOTION,
    *,
    but: Callable[[Element], bool] = lambda _: False,
) -> None:
    """Refuse a line with dry friction, for equations that are linear or another reason ``why``.

    ``but`` : clutches that are taken all the same.

    Raises
    ------
    InputError : names the clutch, and offers what stands for it at one amplitude.
    """
    for element, name in zip(line.elements, line.names, strict=True):
        if isinstance(element, Clutch) and element.friction and not but(element):
            raise InputError(f"has dry friction, {why}", element=name, key="friction", remedy=remedy)
