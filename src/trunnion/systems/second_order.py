"""Vibrating systems whose nonlinearity sits in springs: M ẍ + C ẋ + K x + Σ d f(dᵀx) = F(t), of any size."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.errors import InputError
from trunnion.portable import Portable
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator


@dataclass(frozen=True)
class Spring(Portable):
    """A nonlinear spring along d: force(u) and slope(u) at elongations u = dᵀx of any shape; kinks: where the slope
    jumps.

    Parameters
    ----------
    direction : d (n,), what each unknown adds to the elongation u = dᵀx.
    force : u of any shape → force of the same shape.
    slope : its derivative by u, likewise.
    kinks : elongations at which the slope jumps.

    >>> spring = Spring((1.0, -1.0), lambda u: 2 * u**3, lambda u: 6 * u**2)
    >>> spring.force(np.array([0.5, 1.0]))
    array([0.25, 2.  ])
    """

    direction: tuple[float, ...]
    force: Callable[[Array], Array]
    slope: Callable[[Array], Array]
    kinks: tuple[float, ...] = ()


def cubic_spring(direction: ArrayLike, cubic: float) -> Spring:
    """A spring whose force grows with the cube of its elongation: f = k₃u³, u = dᵀx.

    Parameters
    ----------
    direction : d (n,), what each unknown of the system adds to the elongation.
    cubic : k₃ [N/m³] or [N m/rad³], in the units of the system.

    Returns
    -------
    Spring, for ``SecondOrder``.

    Examples
    --------
    >>> import numpy as np, trunnion as tn
    >>> spring = tn.cubic_spring([1.0, -1.0], cubic=2.0)
    >>> spring.force(np.array([0.5, 1.0])), spring.slope(np.array([1.0]))
    (array([0.25, 2.  ]), array([6.]))
    """
    return Spring(_tuple(direction), lambda u: cubic * u**3, lambda u: 3 * cubic * u**2)


def backlash_spring(direction: ArrayLike, half_gap: float, stiffness: float, inside: float = 0.0) -> Spring:
    """A spring with a gap, between two unknowns say: the force of ``PiecewiseOscillator.gap``.

    Parameters
    ----------
    direction : d (n,), what each unknown of the system adds to the elongation u = dᵀx.
    half_gap : |u| from which the spring is in contact, in units of u.
    stiffness : of the contact [N/m] or [N m/rad].
    inside : stiffness within the gap over ``stiffness`` [-], from 0 to 1.

    Returns
    -------
    Spring, for ``SecondOrder``.

    Raises
    ------
    InputError : what ``PiecewiseOscillator.gap`` refuses.

    Examples
    --------
    >>> import numpy as np, trunnion as tn
    >>> spring = tn.backlash_spring([1.0, -1.0], half_gap=0.5, stiffness=4.0)
    >>> spring.force(np.array([-1.0, 0.2, 1.0])), spring.kinks
    (array([-2.,  0.,  2.]), (-0.5, 0.5))
    """
    return _piecewise(direction, PiecewiseOscillator.gap(half_gap, stiffness, inside))


@dataclass(frozen=True)
class SecondOrder:
    """M ẍ + C ẋ + K x + Σ d f(dᵀx) = F₀ + Σ_k (p_k cos kωt + q_k sin kωt).

    Parameters
    ----------
    mass, damping, stiffness : (n, n).
    springs : nonlinear ones.
    mean : F₀ (n,).
    harmonics : (k, p_k (n,), q_k (n,)).
    names : of the unknowns.
    name : for titles and messages.

    Raises
    ------
    InputError : shapes that do not fit, a singular mass matrix, no harmonic of force.

    >>> spring = cubic_spring([1.0], cubic=2.0)
    >>> system = SecondOrder([[1.0]], [[0.1]], [[1.0]], (spring,), [0.0], [(1, [0.3], [0.0])])
    >>> system.size, system.names
    (1, ('x',))
    """

    mass: Array
    damping: Array
    stiffness: Array
    springs: tuple[Spring, ...]
    mean: Array
    harmonics: tuple[tuple[int, Array, Array], ...]
    names: tuple[str, ...] = field(default=(), kw_only=True)
    name: str = field(default="second-order system", kw_only=True)

    def __post_init__(self) -> None:
        n = len(np.atleast_1d(np.asarray(self.mean, dtype=float)))
        for key in ("mass", "damping", "stiffness"):
            matrix = np.atleast_2d(np.asarray(getattr(self, key), dtype=float))
            if matrix.shape != (n, n) or not np.isfinite(matrix).all():
                raise InputError(f"must be {n} × {n} finite numbers", element=self.name, key=key, value=matrix.tolist())
            object.__setattr__(self, key, matrix)
        object.__setattr__(self, "mean", np.atleast_1d(np.asarray(self.mean, dtype=float)))
        if abs(np.linalg.det(self.mass)) == 0:
            raise InputError("is singular", element=self.name, key="mass", remedy="give every unknown an inertia")

        def vector(force: ArrayLike) -> Array:
            return np.broadcast_to(np.asarray(force, dtype=float), (n,))

        forces = [(int(k), vector(p), vector(q)) for k, p, q in self.harmonics]
        if not forces or min(force[0] for force in forces) < 1:
            raise InputError(
                "must name a harmonic from 1 of the force", element=self.name, key="harmonics", value=self.harmonics
            )
        object.__setattr__(self, "harmonics", tuple(forces))
        for spring in self.springs:
            if len(spring.direction) != n:
                raise InputError(f"must be {n} numbers", element=self.name, key="direction", value=spring.direction)
        if not self.names:
            object.__setattr__(self, "names", tuple(f"x{i + 1}" for i in range(n)) if n > 1 else ("x",))

    @property
    def size(self) -> int:
        """n."""
        return len(self.mean)

    @classmethod
    def of_piecewise(cls, oscillator: PiecewiseOscillator) -> SecondOrder:
        """A piecewise oscillator with damping that always acts.

        Raises
        ------
        InputError : another damping law, whose force jumps or depends on the rate.
        """
        if oscillator.damping_law != "always":
            raise InputError(
                "is neither a spring nor a constant damper", element=oscillator.name, key="damping_law",
                value=oscillator.damping_law, remedy='use the method "exact"',
            )  # fmt: skip
        force = oscillator.coefficients * oscillator.inertia
        harmonics = tuple((k, np.array([force[k].real]), np.array([-force[k].imag])) for k in range(1, len(force)))
        return cls(
            np.array([[oscillator.inertia]]), np.array([[oscillator.damping]]), np.zeros((1, 1)),
            (_piecewise([1.0], oscillator),), np.array([force[0].real]), harmonics, name=oscillator.name,
        )  # fmt: skip


def _piecewise(direction: ArrayLike, oscillator: PiecewiseOscillator) -> Spring:
    return Spring(_tuple(direction), oscillator.restoring, oscillator.slope, oscillator.breakpoints)


def _tuple(direction: ArrayLike) -> tuple[float, ...]:
    return tuple(float(d) for d in np.atleast_1d(np.asarray(direction, dtype=float)))
