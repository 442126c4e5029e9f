"""Losses of gears: what a mesh keeps of the power that it passes on, and the drag of oil and seals beside it.

A mesh of efficiency η gives η of the power that enters it, whichever way that flows. Its friction is a torque L that
resists the rotation of one of its gears against what bears it: with N the torque that the teeth put on that gear,

    L = N (1/η − 1) where power enters there,   L = N (1 − η) where it leaves there.

Gears of a planetary set rub in their rotation relative to the carrier, so that there the power is that of this rolling
motion (Müller, *Die Umlaufgetriebe*, 2nd ed., Springer 1998; VDI 2157), and L acts between gear and carrier.

By a mean coefficient of friction μ along the path of contact (Ohlendorf, TH München 1958; in Niemann and Winter,
*Maschinenelemente* 2, and ISO/TR 14179-2) a pair of spur gears loses the share μ H_v of its power,

    H_v = π (1/z₁ + 1/z₂) (1 − ε_α + ε₁² + ε₂²),

ε₁ and ε₂ the parts of the contact ratio ε_α beyond the pitch point; teeth in contact at once share the load alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import acos, cos, pi, tan
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from trunnion.driveline.parts import Numbers

EFFICIENCY = "share of the power that enters the mesh which it passes on"
DRAG = "torque of oil and seals at the input shaft, whatever the load"
RATING = "rating, lost power borne continuously"


@dataclass(frozen=True)
class MeshLoss:
    """One mesh of an element that loses power, by the coordinates of the element's parts.

    Friction acts on coordinate ``at`` against ``against``, None for the housing. The teeth put ``weight`` times as much
    on ``at`` as on coordinate ``driven``, to which the element passes torque. ``key`` is the number that states the
    loss: an efficiency, or with ``over`` a coefficient of friction of which so many times are lost.
    """

    at: int
    against: int | None
    driven: int
    weight: float
    key: str
    over: float | None = None

    def efficiency(self, stated: Any) -> Any:
        """η, by the number that states it."""
        return stated if self.over is None else 1 - self.over * stated


def lost_shares(efficiency: Any) -> tuple[Any, Any]:
    """L/N where power enters, and where it leaves."""
    return 1 / efficiency - 1, 1 - efficiency


def friction_losses(teeth_in: int, teeth_out: int, pressure_angle: float) -> float:
    """H_v of standard spur gears, addendum one module: the share lost over the mean coefficient of friction."""
    beyond = [
        teeth / (2 * pi) * (tan(acos(teeth * cos(pressure_angle) / (teeth + 2))) - tan(pressure_angle))
        for teeth in (teeth_in, teeth_out)
    ]
    return pi * (1 / teeth_in + 1 / teeth_out) * (1 - sum(beyond) + sum(one**2 for one in beyond))


def power_shares(losses: Sequence[MeshLoss], turning: Sequence[float], number: Numbers) -> tuple[float, float]:
    """Power lost in the meshes of an element over what passes to what it drives: where that takes power, and where it
    gives power; ``turning`` are the mean speeds of the element's coordinates.

    The second is the share that is lost of what comes back.
    """
    found = []
    for takes in (1.0, -1.0):
        lost = held = 0.0
        for one in losses:
            own = turning[one.driven]
            sliding = turning[one.at] - (0.0 if one.against is None else turning[one.against])
            entering, leaving = lost_shares(float(one.efficiency(number(one.key))))
            sense = takes * (1.0 if own > 0 else -1.0)
            rub = abs(one.weight) * (leaving if sense * one.weight * sliding > 0 else entering)
            lost += rub * abs(sliding)
            if one.driven in (one.at, one.against):
                held += sense * rub * (1.0 if sliding > 0 else -1.0) * (1.0 if one.driven == one.at else -1.0)
        found.append(lost / (abs(turning[losses[0].driven]) * (1 - held)))
    return found[0], found[1]
