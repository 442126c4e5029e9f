"""One mass on a restoring force that is linear piece by piece: backlash, clutch dampers, stops."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Complex, Integers
from trunnion.errors import InputError
from trunnion.laws.spring import StageSpring
from trunnion.laws.stages import softest, stages_of
from trunnion.systems.reference import dead_zone_oscillator
from trunnion.systems.system import System

Damping = Literal["always", "in contact", "never pulling"]
LAWS = ("always", "in contact", "never pulling")


@dataclass(frozen=True)
class OscillatorRegimes:
    """What the exact motion is computed from, all divided by the mass; see ``numerics/piecewise_kernel``.

    pieces (regimes, 3): damping, slope and offset; guards (regimes, most, 3): a, e, h of what falls through zero at the
    end of a regime; then (regimes, most): the next regime; side (regimes,): +1 or −1 in contact above or below the gap,
    0 in it.
    """

    pieces: Array
    guards: Array
    then: Integers
    side: Integers


@dataclass(frozen=True)
class PiecewiseOscillator:
    """m x″ + c x′ + g(x) = B₀ + Σ_k (p_k cos kωt + q_k sin kωt), g continuous and linear between breakpoints, g(0) = 0.

    Parameters
    ----------
    breakpoints : rising places where the slope changes, (n,).
    slopes : of g below, between and above them, (n + 1,), none negative.
    damping, damping_law : c, and when it acts: "always", "in contact" (outside the softest piece only) or "never
        pulling". The last acts in contact too, and so that a surface never pulls nor more than doubles its push: with
        the elastic push τ and d = c x′ the force is τ + min(τ, d), and 0 where τ + d ≤ 0, mirrored below. It is the
        law of Modelica.Mechanics.Rotational.Components.ElastoBacklash.
    mean_force : B₀.
    force : p₁, the amplitude at the frequency itself.
    harmonics : further harmonics (k, p_k, q_k).
    frequency : ω [rad/s].
    inertia : m.
    name : for titles and messages.
    speed_unit : of one made from a driveline, what its description prints speeds in.

    Units are the caller's: metre, kilogram, newton, or radian, kg m², N m.

    >>> PiecewiseOscillator.gap(half_gap=0.1, damping=0.05).restoring([0.05, 0.3])
    array([0. , 0.2])

    Raises
    ------
    InputError : breakpoints that do not rise, a negative slope, damping or inertia, an unknown law.
    """

    breakpoints: tuple[float, ...]
    slopes: tuple[float, ...]
    damping: float = 0.0
    mean_force: float = 0.0
    force: float = 0.0
    frequency: float = 1.0
    inertia: float = field(default=1.0, kw_only=True)
    damping_law: Damping = field(default="always", kw_only=True)
    harmonics: tuple[tuple[int, float, float], ...] = field(default=(), kw_only=True)
    name: str = field(default="piecewise oscillator", kw_only=True)
    speed_unit: str | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        for key in ("breakpoints", "slopes"):
            object.__setattr__(self, key, tuple(float(v) for v in getattr(self, key)))
        object.__setattr__(self, "harmonics", tuple((int(k), float(p), float(q)) for k, p, q in self.harmonics))
        self._check()

    def _check(self) -> None:
        def refuse(problem: str, key: str, value: object, remedy: str = "") -> None:
            raise InputError(problem, element=self.name, key=key, value=value, remedy=remedy)

        for key in ("damping", "mean_force", "force", "frequency", "inertia"):
            if not np.isfinite(getattr(self, key)):
                refuse("must be a finite number", key, getattr(self, key))
        if len(self.slopes) != len(self.breakpoints) + 1:
            refuse(f"must be {len(self.breakpoints) + 1} numbers, one more than breakpoints", "slopes", self.slopes)
        if not np.all(np.isfinite([*self.breakpoints, *self.slopes])):
            refuse("must be finite numbers", "breakpoints, slopes", [*self.breakpoints, *self.slopes])
        if any(b <= a for a, b in zip(self.breakpoints, self.breakpoints[1:], strict=False)):
            refuse("must rise", "breakpoints", self.breakpoints)
        if min(self.slopes) < 0:
            refuse("must not be negative", "slopes", min(self.slopes), "a spring that pushes away is not modelled")
        if self.damping < 0:
            refuse("must not be negative", "damping", self.damping, "write 0 for none")
        for key in ("frequency", "inertia"):
            if getattr(self, key) <= 0:
                refuse("must be positive", key, getattr(self, key))
        if self.damping_law not in LAWS:
            refuse("is unknown", "damping_law", self.damping_law, f"write one of {', '.join(LAWS)}")
        if self.damping_law == "never pulling" and not (len(self.breakpoints) == 2 and self.slopes[1] == 0):
            refuse(
                "needs a free gap between two contacts",
                "damping_law", self.damping_law, 'with a force in the gap write "in contact" or "always"',
            )  # fmt: skip
        if any(k < 1 for k, _, _ in self.harmonics):
            refuse("must be orders from 1", "harmonics", [k for k, _, _ in self.harmonics])

    @classmethod
    def gap(
        cls,
        half_gap: float,
        stiffness: float = 1.0,
        inside: float = 0.0,
        damping: float = 0.0,
        mean_force: float = 0.0,
        force: float = 0.0,
        frequency: float = 1.0,
        **more: Any,
    ) -> PiecewiseOscillator:
        """A backlash: slope ``inside`` · ``stiffness`` within ± ``half_gap``, ``stiffness`` outside.

        Raises
        ------
        InputError : a negative backlash, a stiffness ratio ``inside`` outside [0, 1].
        """
        name = more.get("name", "backlash")
        if not (np.isfinite(half_gap) and half_gap >= 0):
            raise InputError(
                "must not be negative", element=name, key="half_gap", value=half_gap, remedy="write 0 for no backlash"
            )
        if not 0 <= inside <= 1:
            raise InputError(
                "must lie between 0 and 1", element=name, key="inside", value=inside,
                remedy="0 is free play, 1 no gap at all",
            )  # fmt: skip
        k = float(stiffness)
        ends, slopes = ((-half_gap, half_gap), (k, inside * k, k)) if half_gap > 0 and inside < 1 else ((), (k,))
        return cls(ends, slopes, damping, mean_force, force, frequency, **{**more, "name": name})

    def but(self, **changes: Any) -> PiecewiseOscillator:
        """The same oscillator with some of its numbers changed.

        Raises
        ------
        InputError : not one of its fields, or a value out of range.
        """
        for key in changes:
            if key not in self.__dataclass_fields__:
                known = ", ".join(self.__dataclass_fields__)
                raise InputError("is not a field", element=self.name, key=key, remedy=f"fields are: {known}")
        return replace(self, **changes)

    @property
    def period(self) -> float:
        """2π/ω [s]."""
        return 2 * np.pi / self.frequency

    @property
    def softest(self) -> int:
        """Number of the piece with the smallest slope, the gap of a backlash (the one nearest to 0 of several)."""
        return softest(self.spring)

    @cached_property
    def spring(self) -> StageSpring:
        """The restoring force as a law."""
        return StageSpring(np.array(self.breakpoints), np.array(self.slopes))

    @property
    def offsets(self) -> tuple[float, ...]:
        """d of g = s x + d on every piece."""
        return tuple(map(float, self.spring.offsets))

    @cached_property
    def coefficients(self) -> Complex:
        """B₀ and p_k − i q_k, all over the mass; the constant first."""
        highest = max([1, *(k for k, _, _ in self.harmonics)])
        out: Complex = np.zeros(highest + 1, dtype=np.complex128)
        out[0], out[1] = self.mean_force, self.force
        for k, p, q in self.harmonics:
            out[k] += complex(p, -q)
        return out / self.inertia

    def restoring(self, x: ArrayLike) -> Array:
        """g(x), any shape."""
        return self.spring.force(x)

    def slope(self, x: ArrayLike) -> Array:
        """dg/dx, any shape; at a breakpoint that of the piece below."""
        return self.spring.slope(x)

    def equilibrium(self) -> float:
        """Where g(x) = B₀.

        Raises
        ------
        InputError : no spring carries the mean force.
        """
        i = int(self.spring.stage_under(self.mean_force))
        if self.slopes[i] > 0:
            return float((self.mean_force - self.offsets[i]) / self.slopes[i])
        knots = self.breakpoints or (0.0,)
        if i < len(knots) and self.restoring(knots)[i] == self.mean_force:
            return float(np.clip(0.0, knots[max(i - 1, 0)], knots[-1]))
        raise InputError(
            "is carried by no spring", element=self.name, key="mean_force", value=self.mean_force,
            remedy="raise the outermost slope on its side",
        )  # fmt: skip

    def as_system(self) -> System:
        """The same backlash as a ``System``, to be simulated or balanced: x and v, parameter ``frequency``.

        Raises
        ------
        InputError : not a symmetric gap with damping that always acts and one harmonic of force.
        """
        symmetric = len(self.breakpoints) == 2 and self.breakpoints[0] == -self.breakpoints[1]
        if not symmetric or self.slopes[0] != self.slopes[2] or self.damping_law != "always" or self.harmonics:
            raise InputError(
                "is not a symmetric gap with damping always on and one harmonic of force", element=self.name,
                key="as_system", remedy="its exact motion is there for every other piecewise oscillator",
            )  # fmt: skip
        m, k = self.inertia, self.slopes[0]
        return dead_zone_oscillator(
            damping=self.damping / m, stiffness=k / m, inside=self.slopes[1] / k if k else 0.0,
            half_gap=self.breakpoints[1], mean_force=self.mean_force / m, force=self.force / m,
            frequency=self.frequency,
        )  # fmt: skip

    @cached_property
    def regimes(self) -> OscillatorRegimes:
        """The linear regimes and what leads from one to another."""
        found = stages_of(self.spring, self.damping, self.damping_law)
        used = (found.then >= 0).any(axis=0)
        falling = np.ascontiguousarray((-found.guards[..., 3:] * found.guards[..., :3])[:, used])
        return OscillatorRegimes(
            found.pieces / self.inertia, falling, np.ascontiguousarray(found.then[:, used]), found.side
        )
