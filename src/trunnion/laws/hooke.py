"""Hooke's (Cardan, universal) joint: output angle, speed ratio and their derivatives.

χ is the input angle measured from the joint plane (the plane of the two shaft axes): χ = 0 when the
input fork lies in that plane. With bend angle β and t = tan²(β/2)

    ψ = atan(tan χ / cos β)  (unwrapped)  =  χ + atan[t sin 2χ / (1 − t cos 2χ)]
    η = dψ/dχ = cos β / (1 − sin²β cos²χ) = (1 − t²)/E,   E = 1 − 2t cos 2χ + t²

so η runs from 1/cos β (χ = 0) to cos β (χ = 90°). Papers that start with the fork square to the plane
write sin²χ instead of cos²χ: the same joint 90° later. The second forms need no unwrapping and lose no figures
at small angles. The output fork stands 90° from the input fork; that quarter turn is added by the assembly of a line,
not here. All functions broadcast over numpy arrays; angles in rad.

Every joint with tan ψ = tan χ / c has this law, with t = (1 − c)/(1 + c): two crosses on one yoke for example.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.laws.joint import TransmittedRotation

QUARTER_TURN = np.pi / 2


@dataclass(frozen=True)
class CrossLaw:
    """tan ψ = tan χ (1 + t)/(1 − t), |t| < 1; ``turned`` [rad] from the input arm to the output arm."""

    t: Array
    turned: float = QUARTER_TURN

    @property
    def cosine(self) -> Array:
        """c = (1 − t)/(1 + t), of one cross cos β."""
        return np.asarray((1 - self.t) / (1 + self.t))

    @property
    def numbers(self) -> tuple[Array, ...]:
        """t."""
        return (self.t,)

    @property
    def nonuniform(self) -> bool:
        """See ``JointLaw``."""
        return bool(np.any(self.t))

    @property
    def spread(self) -> float:
        """See ``JointLaw``: harmonics fall off as t^h."""
        return float(np.max(np.abs(self.t)))

    def at(self, chi: Array) -> TransmittedRotation:
        """See ``JointLaw``."""
        t, chi = self.t, np.asarray(chi, dtype=float)
        cosine, sine = np.cos(2 * chi), np.sin(2 * chi)
        over = 1 / (1 - 2 * t * cosine + t**2)
        ratio = (1 - t**2) * over
        slope = -4 * t * sine * ratio * over
        curvature = -8 * t * ratio * over * (cosine - 4 * t * sine**2 * over)
        return TransmittedRotation(chi + np.arctan2(t * sine, 1 - t * cosine), ratio, slope, curvature)

    def third(self, chi: Array) -> Array:
        """See ``JointLaw``."""
        t, cosine, sine = self.t, np.cos(2 * chi), np.sin(2 * chi)
        over = 1 / (1 - 2 * t * cosine + t**2)
        bend = 4 * t * sine * over
        return np.asarray(4 * bend * (1 - t**2) * over * (1 + 1.5 * (8 * t * cosine * over - bend**2)))

    def straight(self) -> CrossLaw:
        """See ``JointLaw``."""
        return CrossLaw(np.zeros_like(self.t), self.turned)


def law(angle: ArrayLike, turned: float = QUARTER_TURN) -> CrossLaw:
    """One cross bent by ``angle`` β [rad], its output arm ``turned`` [rad] from the input arm."""
    return CrossLaw(np.tan(np.asarray(angle, dtype=float) / 2) ** 2, turned)
