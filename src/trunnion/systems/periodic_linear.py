"""A linear system with periodic coefficients, the common currency of all stability analyses.

    M(τ) x″ + C(τ) x′ + K(τ) x = F(τ),   ′ = d/dτ,

periodic in τ with ``period``. For a driveline τ is the input angle and speed enters as C/Ω, K/Ω², F/Ω²;
a Mathieu oscillator or anybody's own matrices enter the same analyses.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.errors import InputError
from trunnion.portable import Portable


@dataclass(frozen=True)
class Matrices:
    """M, C, K of shape (time, n, n) and forcing of shape (time, n), at the times asked for."""

    mass: Array
    damping: Array
    stiffness: Array
    forcing: Array


@dataclass(frozen=True)
class PeriodicLinearSystem(Portable):
    """A periodic linear system and the names of its coordinates.

    Parameters
    ----------
    period : period of the coefficients in τ.
    coefficients : callable, τ of shape (m,) → ``Matrices`` at those times.
    size : number of coordinates n.
    rate : dτ/dt [1/s]; turns a growth per unit τ into one per second (the input speed, for a driveline).
    names : a name per coordinate.
    frequencies : natural frequencies of the averaged system in units of τ, where known; resonances are
        named after them.
    fastest : the highest frequency of the coefficients in radians per unit τ, where known: no step of an integration
        is longer than a quarter of its cycle.

    >>> from trunnion.systems.periodic_linear import from_matrices
    >>> system = from_matrices([[1.0]], [[0.0]], lambda t: (1.2 - 0.4 * np.cos(2 * t))[:, None, None], period=np.pi)
    >>> system.coefficients(np.zeros(1)).stiffness
    array([[[0.8]]])
    """

    period: float
    coefficients: Callable[[Array], Matrices]
    size: int
    rate: float = 1.0
    names: tuple[str, ...] = ()
    frequencies: tuple[float, ...] = ()
    fastest: float = 0.0

    def __post_init__(self) -> None:
        if not (np.isfinite(self.period) and self.period > 0):
            raise InputError("must be a positive number", key="period", value=self.period)
        if not (np.isfinite(self.rate) and self.rate > 0):
            raise InputError("must be a positive number", key="rate", value=self.rate)


def from_matrices(
    mass: Callable[[Array], Array] | Array,
    damping: Callable[[Array], Array] | Array,
    stiffness: Callable[[Array], Array] | Array,
    *,
    period: float,
    forcing: Callable[[Array], Array] | Array | None = None,
    rate: float = 1.0,
    names: tuple[str, ...] = (),
) -> PeriodicLinearSystem:
    """A system from your own matrices: each a constant (n, n) array or a function of τ (m,) → (m, n, n).

    >>> import numpy as np
    >>> mathieu = from_matrices(
    ...     np.eye(1), np.zeros((1, 1)), lambda t: (1.2 - 0.4 * np.cos(2 * t))[:, None, None], period=np.pi
    ... )
    >>> mathieu.size
    1
    """
    size = np.shape(mass(np.zeros(1))[0] if callable(mass) else mass)[0]
    zero = np.zeros(size)

    def at(part: Callable[[Array], Array] | Array | None, tau: Array, shape: tuple[int, ...]) -> Array:
        value = zero if part is None else part(tau) if callable(part) else part
        try:
            return np.broadcast_to(np.asarray(value, dtype=float), (len(tau), *shape))
        except ValueError:
            raise InputError(
                f"a coefficient has shape {np.shape(value)} where (time, {', '.join(map(str, shape))}) is needed",
                element="PeriodicLinearSystem",
                remedy="return one matrix per time",
            ) from None

    def coefficients(tau: Array) -> Matrices:
        square = (size, size)
        return Matrices(
            at(mass, tau, square),
            at(damping, tau, square),
            at(stiffness, tau, square),
            at(forcing, tau, (size,)),
        )

    mean = coefficients(period * (np.arange(64) + 0.5) / 64)
    squares = np.linalg.eigvals(np.linalg.solve(mean.mass.mean(0), mean.stiffness.mean(0)))
    found = np.sqrt(np.sort(np.maximum(squares.real, 0.0)))
    return PeriodicLinearSystem(period, coefficients, size, rate, names, tuple(map(float, found)))
