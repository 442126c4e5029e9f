"""What every law of a joint tells: how it passes rotation on, and how that changes with its input angle.

χ is the angle of the joint's input arm (a fork, an arm of the tripod, a ball) from its own plane, that of the two shaft
axes, and ψ(χ) the rotation of its output. There are two forms: closed, ``hooke.CrossLaw``, and Fourier series,
``fourier.FourierLaw``. The compiled kernels know both, so a joint that is one of them needs no kernel of its own. All
numbers broadcast against χ.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Passed(NamedTuple):
    """ψ [rad], η = dψ/dχ, dη/dχ [1/rad] and d²η/dχ² [1/rad²] at some χ."""

    output: Array
    ratio: Array
    slope: Array
    curvature: Array


class JointLaw(Protocol):
    """The law of one joint, for one or many sets of its numbers."""

    @property
    def turned(self) -> float:
        """Angle [rad] from the input arm to the output arm of the straight joint, beside ψ."""

    @property
    def numbers(self) -> tuple[Array, ...]:
        """All numbers that the law depends on."""

    @property
    def uneven(self) -> bool:
        """Whether the output turns other than the input in any case."""

    @property
    def spread(self) -> float:
        """How fast the harmonics of a response fall off at least: the largest ratio of one to the one before."""

    def at(self, chi: Array) -> Passed:
        """Rotation passed on at input angles ``chi`` [rad]."""

    def output_jet(self, chi: Array) -> Array:
        """The jet (see ``numerics.jets``) of ψ where that of χ is ``chi``."""

    def ratio_jet(self, chi: Array) -> Array:
        """The jet of η."""

    def straight(self) -> JointLaw:
        """The law of the same joint without bend."""
