"""Dry friction in the bearings of a cross.

Each fork carries its half of the cross on two pins a distance R from the centre. The pins pass the part of
the moment m that is square to them as a couple of forces |m⊥|/(2R), and friction of coefficient μ at the pin
radius r brakes the swing of the cross in that fork with 2·μ·r·|m⊥|/(2R) = κ|m⊥|, κ = μr/R. With n the normal
of the cross and a, b its two pin axes, m = λn + Aa + Bb, so |A| = κ√(λ² + B²) and |B| = κ√(λ² + A²), which
gives both the same size: |A| = |B| = κ′|λ| with κ′ = κ/√(1 − κ²), whatever the angle.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

from trunnion.driveline.quantities import LENGTH, RATIO, parse
from trunnion.errors import InputError


@dataclass(frozen=True)
class CrossFriction:
    """Bearing friction of every cross of a line.

    Parameters
    ----------
    coefficient : μ of the pin bearings [-]; a few thousandths for needle bearings.
    pin_radius : r, where the bearing slides or rolls on the pin [m].
    arm : R, distance of the bearings' middle from the centre of the cross [m].

    >>> friction = CrossFriction(coefficient=0.005, pin_radius="12 mm", arm="40 mm")
    >>> round(friction.pin_moment, 6)
    0.0015
    """

    coefficient: float
    pin_radius: float
    arm: float

    def __post_init__(self) -> None:
        for key, kind in (("coefficient", RATIO), ("pin_radius", LENGTH), ("arm", LENGTH)):
            try:
                value = parse(getattr(self, key), kind)
            except InputError as error:
                raise error.but(element="friction", key=key) from None
            object.__setattr__(self, key, value)
        for key, least, example in (("coefficient", 0.0, "0.005"), ("pin_radius", 0.0, '"12 mm"')):
            if getattr(self, key) < least:
                raise InputError(
                    "must not be negative",
                    element="friction",
                    key=key,
                    value=getattr(self, key),
                    remedy=f"write for example {example}",
                )
        if not self.arm > self.pin_radius:
            raise InputError(
                f"must be larger than pin_radius = {self.pin_radius:g} m",
                element="friction",
                key="arm",
                value=self.arm,
                remedy="check the units, or swap the two",
            )
        if not self.coefficient * self.pin_radius < self.arm:
            raise InputError(
                "locks the cross",
                element="friction",
                key="coefficient",
                value=self.coefficient,
                remedy="write 0.005, say, for needle bearings",
            )

    @property
    def pin_moment(self) -> float:
        """κ′ [-]: friction moment about either pin axis over the moment along the cross's normal."""
        ratio = self.coefficient * self.pin_radius / self.arm
        return ratio / sqrt(1 - ratio**2)
