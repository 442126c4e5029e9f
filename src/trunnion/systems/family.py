"""A family of periodic linear systems over named parameters: what a stability chart of your own needs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from trunnion.arrays import Array
from trunnion.errors import InputError
from trunnion.portable import Portable
from trunnion.systems.periodic_linear import Matrices, PeriodicLinearSystem


@dataclass(frozen=True)
class PeriodicLinearFamily(Portable):
    """M x″ + C x′ + K x = 0 with periodic coefficients that depend on parameters.

    Parameters
    ----------
    period : the common period in τ.
    coefficients : callable(τ, **parameters) → (M, C, K). τ has shape (1, time) and each parameter (case, 1),
        so that plain arithmetic broadcasts; each matrix is (n, n), or (case or 1, time or 1, n, n).
    size : number of coordinates n.
    parameters : default value of each parameter.
    units : unit of each parameter, where it has one.

    >>> import numpy as np
    >>> def mathieu(tau, a, q):
    ...     return np.eye(1), np.zeros((1, 1)), (a - 2 * q * np.cos(2 * tau))[..., None, None]
    >>> family = PeriodicLinearFamily(np.pi, mathieu, 1, {"a": 1.0, "q": 0.5})
    >>> family.matrices(np.zeros(3), {"a": np.array([1.0, 2.0])})[2].shape
    (2, 3, 1, 1)
    """

    period: float
    coefficients: Callable[..., tuple[Array, Array, Array]]
    size: int
    parameters: Mapping[str, float]
    units: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not (np.isfinite(self.period) and self.period > 0):
            raise InputError("must be a positive number", element="family", key="period", value=self.period)
        if self.size < 1:
            raise InputError("must be at least 1", element="family", key="size", value=self.size)

    def matrices(self, tau: Array, values: Mapping[str, Array]) -> tuple[Array, Array, Array]:
        """M, C, K of shape (case, time, n, n) at times (time,) for parameter values (case,)."""
        cases = max((np.size(v) for v in values.values()), default=1)
        given: dict[str, Array] = {k: np.asarray(v, dtype=float) for k, v in self.parameters.items()} | dict(values)
        full = {k: np.broadcast_to(v, (cases,))[:, None] for k, v in given.items()}
        try:
            parts = self.coefficients(np.asarray(tau)[None, :], **full)
        except TypeError as failure:
            if "argument" not in str(failure):
                raise
            remedy = f"it is called as coefficients(tau, {', '.join(full)})"
            raise InputError(f"failed: {failure}", element="family", key="coefficients", remedy=remedy) from None
        shape = (cases, np.size(tau), self.size, self.size)
        try:
            m, c, k = (np.broadcast_to(np.asarray(p, dtype=float), shape) for p in parts)
        except ValueError:
            seen = ", ".join(str(np.shape(p)) for p in parts)
            raise InputError(
                f"returned arrays of shape {seen} that do not broadcast to (case, time, {self.size}, {self.size})",
                element="family",
                key="coefficients",
                remedy="end each with the two matrix axes, e.g. (a - 2*q*cos(2*tau))[..., None, None]",
            ) from None
        return m, c, k

    def require_period(self, values: Mapping[str, float]) -> None:
        """Refuse a member whose coefficients do not repeat after ``period``."""
        given = {k: np.array([float(v)]) for k, v in {**self.parameters, **values}.items()}
        tau = self.period * np.mod(0.123 + np.sqrt(2) * np.arange(7), 1.0)
        for name, now, later in zip(
            "MCK", self.matrices(tau, given), self.matrices(tau + self.period, given), strict=True
        ):
            finite = np.isfinite(now) & np.isfinite(later)
            off = np.abs(np.where(finite, later - now, 0.0))
            if off.max() > 1e-6 * (1e-300 + np.abs(np.where(finite, now, 0.0)).max()):
                raise InputError(
                    f"is not a period of {name}, which differs by {off.max():.3g} one period later",
                    element="family", key="period", value=self.period, remedy="give the common period in τ",
                )  # fmt: skip

    def system(self, **values: float) -> PeriodicLinearSystem:
        """One member as a ``PeriodicLinearSystem``, for ``stability``."""
        self.require_period(values)
        given = {k: np.array([float(v)]) for k, v in {**self.parameters, **values}.items()}

        def at(tau: Array) -> Matrices:
            m, c, k = (part[0] for part in self.matrices(tau, given))
            return Matrices(m, c, k, np.zeros((len(tau), self.size)))

        mean = at(self.period * (np.arange(64) + 0.5) / 64)
        squares = np.linalg.eigvals(np.linalg.solve(mean.mass.mean(0), mean.stiffness.mean(0)))
        found = tuple(map(float, np.sqrt(np.sort(np.maximum(squares.real, 0.0)))))
        return PeriodicLinearSystem(self.period, at, self.size, frequencies=found)
