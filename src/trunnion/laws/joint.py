"""What every law of a joint tells: how it passes rotation on, and how that changes with its input angle.

χ is the angle of the joint's input arm (a fork, an arm of the tripod, a ball) from its own plane, that of the two shaft
axes, and ψ(χ) the rotation of its output. There are two forms: closed, ``hooke.CrossLaw``, and Fourier series,
``fourier.FourierLaw``. The compiled kernels know both, so a joint that is one of them needs no kernel of its own. All
numbers broadcast against χ.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import reduce
from math import factorial
from operator import add
from typing import NamedTuple, Protocol

from trunnion.arrays import Array


class TransmittedRotation(NamedTuple):
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
    def nonuniform(self) -> bool:
        """Whether the output turns other than the input in any case."""

    @property
    def spread(self) -> float:
        """How fast the harmonics of a response fall off at least: the largest ratio of one to the one before."""

    def at(self, chi: Array) -> TransmittedRotation:
        """Rotation passed on at input angles ``chi`` [rad]."""

    def third(self, chi: Array) -> Array:
        """d³η/dχ³ [1/rad³] there, which few ask for."""

    def straight(self) -> JointLaw:
        """The law of the same joint without bend."""


def through(derivatives: Sequence[Array], inner: Sequence[Array]) -> list[Array]:
    """The jet (see ``numerics.jets``) of f(x), given that of x and f, f′, f″, … at its value.

    Parameters
    ----------
    derivatives : as many as ``inner`` has coefficients, or more.
    """
    found = [derivatives[0], *(derivatives[1] * coefficient for coefficient in inner[1:])]
    power = {m: inner[m] for m in range(1, len(inner))}
    for k in range(2, len(inner)):
        # (x − x₀)^k begins with the coefficient k.
        power = {m: _sum(inner[i] * power[m - i] for i in range(1, m - k + 2)) for m in range(k, len(inner))}
        share = derivatives[k] / factorial(k)
        for m, coefficient in power.items():
            found[m] += share * coefficient
    return found


def _sum(terms: Iterable[Array]) -> Array:
    return reduce(add, terms)
