"""Elastic couplings as their makers list them, also over mean torque and temperature."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from math import pi
from typing import Annotated, Any, ClassVar, Self

from pydantic import BeforeValidator, model_validator

from trunnion.driveline.elements import Doubt, not_negative, positive
from trunnion.driveline.parts import Numbers
from trunnion.driveline.quantities import (
    FREEZING,
    TEMPERATURE,
    TORQUE,
    Dimensionless,
    Maybe,
    Power,
    QuantityKind,
    Several,
    Stiffness,
    Temperature,
    ThermalResistance,
    Torque,
    optional,
    shown,
)
from trunnion.driveline.record import as_tuple
from trunnion.driveline.shafts import SpringElement
from trunnion.errors import InputError

COLDEST, HOTTEST = FREEZING - 100, FREEZING + 400
"""Temperatures [K] between which a coupling can be meant."""
_TORQUES = as_tuple(
    "torques", 'write torques = ["2 kN*m", "8 kN*m"], stiffnesses = ["40 kN*m/rad", "70 kN*m/rad"], say'
)
_HEATED = as_tuple("quantities", 'write temperatures = ["30 degC", "90 degC"], stiffness_factors = [1, 0.72], say')


class Coupling(SpringElement):
    """An elastic coupling as its maker lists it: dynamic stiffness, relative damping, ratings; no inertia of its own.

    Parameters
    ----------
    stiffness : dynamic torsional stiffness [N m/rad] at the load it runs at; or else over the mean torque:
    torques, stiffnesses : mean torques [N m], rising from 0 or above, and the dynamic stiffness [N m/rad] at each.
        Linear between them, that of the first below it; a larger mean torque than the last is refused.
    relative_damping : ψ, energy lost per cycle over the elastic energy at its largest twist; η = ψ/2π.
    loss_factor_frequency : at which ψ holds; without it at all frequencies, as rubber's nearly does (see ``Shaft``).
    damping, loss_factor : instead of ψ.
    temperatures, stiffness_factors, damping_factors : temperatures [K], "60 degC" say, and what stiffness and damping
        are multiplied by there (1 by default); linear between them, refused beyond.
    temperature : of the rubber [K], at which it is taken; ``trunnion.coupling_temperatures`` finds where it settles.
    thermal_resistance : how much hotter than its surroundings it settles, over the heat of its damping [K/W].
    ambient_temperature : of the surroundings [K].
    highest_temperature : rating, that the rubber bears continuously [K].
    nominal_torque : T_KN [N m], carried continuously.
    maximum_torque : T_Kmax [N m], carried briefly.
    vibratory_torque : T_KW [N m], amplitude carried continuously at 10 Hz.
    heat_rating : P_KV [W], damping heat carried continuously.
    fork_offset : as of a ``Shaft``.
    to : as of a ``Shaft``.

    The ratings change no motion; checks compare with them.

    >>> coupling = Coupling(stiffness="35 kN*m/rad", relative_damping=1.13, nominal_torque="10 kN*m")
    >>> round(coupling.loss, 4)
    0.1798
    >>> stiffening = Coupling(torques=["2 kN*m", "10 kN*m"], stiffnesses=["30 kN*m/rad", "70 kN*m/rad"])
    >>> float(stiffening.stiffness_under(lambda key: getattr(stiffening, key), 6e3))
    50000.0
    """

    example: ClassVar[str] = 'stiffness = "35 kN*m/rad" and relative_damping = 1.13'
    loss_keys: ClassVar[tuple[str, ...]] = ("loss_factor", "relative_damping")
    ratings: ClassVar[tuple[str, ...]] = ("nominal_torque", "maximum_torque", "vibratory_torque", "heat_rating")
    idle: ClassVar[tuple[str, ...]] = (*ratings, "thermal_resistance", "ambient_temperature", "highest_temperature")

    torques: Annotated[Several[Torque], BeforeValidator(_TORQUES)] = optional(
        default=(), description="mean torques, rising, at which stiffnesses are listed"
    )
    stiffnesses: Annotated[Several[Stiffness], BeforeValidator(_TORQUES)] = optional(
        default=(), description="dynamic stiffness at each of them"
    )
    relative_damping: Maybe[Dimensionless] = optional(default=None, description="loss per cycle over elastic energy")
    temperature: Maybe[Temperature] = optional(default=None, description="of the rubber, at which it is taken")
    temperatures: Annotated[Several[Temperature], BeforeValidator(_HEATED)] = optional(
        default=(), description="rising, at which factors are listed"
    )
    stiffness_factors: Annotated[Several[Dimensionless], BeforeValidator(_HEATED)] = optional(
        default=(), description="of the stiffness at each of them; 1 by default"
    )
    damping_factors: Annotated[Several[Dimensionless], BeforeValidator(_HEATED)] = optional(
        default=(), description="of the damping at each of them; 1 by default"
    )
    thermal_resistance: Maybe[ThermalResistance] = optional(
        default=None, description="temperature above its surroundings over the heat of its damping"
    )
    ambient_temperature: Maybe[Temperature] = optional(default=None, description="of its surroundings")
    highest_temperature: Maybe[Temperature] = optional(default=None, description="rating, borne continuously")
    nominal_torque: Maybe[Torque] = optional(default=None, description="rating, carried continuously (T_KN)")
    maximum_torque: Maybe[Torque] = optional(default=None, description="rating, carried briefly (T_Kmax)")
    vibratory_torque: Maybe[Torque] = optional(
        default=None, description="rating, amplitude carried continuously at 10 Hz (T_KW)"
    )
    heat_rating: Maybe[Power] = optional(default=None, description="rating, damping heat carried continuously (P_KV)")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.stiffness is None and not self.torques and not self.stiffnesses:
            raise InputError("is missing", key="stiffness", remedy=f"write {self.example}")
        not_negative(self, "relative_damping")
        positive(self, *self.ratings, "thermal_resistance")
        if self.relative_damping is not None and self.loss_factor is not None:
            value, remedy = self.relative_damping, "leave one of the two out; the loss factor is ψ/2π"
            raise InputError("conflicts with loss_factor", key="relative_damping", value=value, remedy=remedy)
        self._check_torques()
        self._check_temperatures()
        return self

    def _check_torques(self) -> None:
        if not self.torques and not self.stiffnesses:
            return
        if self.stiffness is not None:
            key = "torques" if self.torques else "stiffnesses"
            value, remedy = list(getattr(self, key)), "leave one of the two out"
            raise InputError("conflicts with stiffness", key=key, value=value, remedy=remedy)
        _table("torques", self.torques, "stiffnesses", self.stiffnesses, TORQUE)
        if self.torques[0] < 0:
            remedy = "begin at 0 or above; the stiffness is the same in both directions"
            raise InputError("must not be negative", key="torques", value=self.torques[0], remedy=remedy)
        if not min(self.stiffnesses) > 0:
            raise InputError("must be positive", key="stiffnesses", remedy="leave out torques without a stiffness")

    def _check_temperatures(self) -> None:
        for key in ("temperature", "ambient_temperature", "highest_temperature", "temperatures"):
            stated = getattr(self, key)
            for value in stated if isinstance(stated, tuple) else (stated,):
                if value is not None and not COLDEST <= value <= HOTTEST:
                    reach = " to ".join(shown(end, TEMPERATURE) for end in (COLDEST, HOTTEST))
                    problem = f"is {shown(value, TEMPERATURE)}, and must lie within {reach}"
                    raise InputError(problem, key=key, remedy='write "60 degC"; a bare number is in kelvin')
        factors = {key: getattr(self, key) for key in ("stiffness_factors", "damping_factors") if getattr(self, key)}
        if not self.temperatures:
            if factors:
                key, remedy = next(iter(factors)), 'write temperatures = ["30 degC", "90 degC"], say'
                raise InputError("has no temperatures", key=key, value=list(factors[key]), remedy=remedy)
        elif not factors:
            remedy = "write stiffness_factors = [1, 0.72], say, or damping_factors"
            raise InputError("have no factors", key="temperatures", remedy=remedy)
        elif self.temperature is None:
            remedy = 'write temperature = "60 degC", say; tn.coupling_temperatures finds where it settles'
            raise InputError("is needed with temperatures", key="temperature", remedy=remedy)
        for key, values in factors.items():
            _table("temperatures", self.temperatures, key, values, TEMPERATURE)
            if not min(values) > 0:
                raise InputError("must be positive", key=key, remedy="write what is left at that temperature, 0.6 say")
        if self.temperature is not None and self.temperatures:
            low, high = self.temperatures[0], self.temperatures[-1]
            if not low <= self.temperature <= high:
                reach = " to ".join(shown(end, TEMPERATURE) for end in (low, high))
                remedy = "add points to the table, or state another one"
                raise InputError(f"lies beyond temperatures, {reach}", key="temperature", remedy=remedy)
        for key, other in (
            ("thermal_resistance", "ambient_temperature"), ("ambient_temperature", "thermal_resistance"),
        ):  # fmt: skip
            if getattr(self, key) is not None and getattr(self, other) is None:
                example = "30 degC" if other == "ambient_temperature" else "0.15 K/W"
                raise InputError(f"is needed with {key}", key=other, remedy=f'write {other} = "{example}", say')
        if self.thermal_resistance is not None and self.temperature is None:
            remedy = "write temperature, at which it is taken where nothing iterates it"
            raise InputError("is needed with thermal_resistance", key="temperature", remedy=remedy)

    def doubts(self) -> Iterator[Doubt]:
        yield from super().doubts()
        if self.highest_temperature is not None and self.temperature is not None:
            if self.temperature > self.highest_temperature:
                said = f"lies above highest_temperature, {shown(self.highest_temperature, TEMPERATURE)}"
                yield "temperature", said, "check both"

    @property
    def loss(self) -> float | None:
        """η = ψ/2π at its temperature, or the loss factor as stated."""
        stated = self.loss_factor if self.relative_damping is None else self.relative_damping / (2 * pi)
        return None if stated is None else stated * self._damping_factor_stated

    @property
    def _damping_factor_stated(self) -> float:
        return float(self.damping_factor(lambda key: getattr(self, key))) if self.damping_factors else 1.0

    def stiffness_of(self, number: Numbers) -> Any:
        """As stated at its temperature; of a table over mean torque that of the first point, which holds without one
        (``stiffness_under``)."""
        return self.stiffness_under(number, 0.0)

    def damping_of(self, number: Numbers) -> Any:
        """As stated, at its temperature."""
        return number("damping") * self.damping_factor(number)

    def stiffness_under(self, number: Numbers, torque: Any) -> Any:
        """Stiffness [N m/rad] under a mean torque [N m] of either sign, for the values of its numbers; NaN beyond its
        tables."""
        factor = self._factor(number, self.stiffness_factors)
        if not self.torques:
            return number("stiffness") * factor
        import numpy as np

        size = np.abs(torque)
        found = self._between(number, np.maximum(size, self.torques[0])) * factor
        return np.where(size > self.torques[-1], np.nan, found)

    def _between(self, number: Numbers, size: Any) -> Any:
        """By its points, each of which may be one number or many."""
        points = [self._listed(number, i) for i in range(len(self.torques))]
        found: Any = 0.0
        for i, (torque, stiffness) in enumerate(zip(self.torques, points, strict=True)):
            found = found + stiffness * _hat(self.torques, i, torque, size)
        return found

    def _listed(self, number: Numbers, i: int) -> Any:
        try:
            return number(f"stiffness {i + 1}")
        except AttributeError:  # asked of the element itself
            return self.stiffnesses[i]

    def damping_factor(self, number: Numbers) -> Any:
        """What its damping is multiplied by at its temperature; NaN beyond the table."""
        return self._factor(number, self.damping_factors)

    def _factor(self, number: Numbers, factors: tuple[float, ...]) -> Any:
        if not factors:
            return 1.0
        import numpy as np

        return np.interp(number("temperature"), self.temperatures, factors, left=np.nan, right=np.nan)


def _hat(points: tuple[float, ...], i: int, at: float, x: Any) -> Any:
    """1 at a point, 0 at the others, linear between."""
    import numpy as np

    near = points[max(i - 1, 0) : i + 2]
    return np.interp(x, near, [1.0 if p == at else 0.0 for p in near])


def _table(over: str, points: tuple[float, ...], key: str, values: tuple[float, ...], kind: QuantityKind) -> None:
    """Refuse tables that do not rise, are too short or unlike in length."""
    if len(points) != len(values):
        problem = f"must have one value for each of {len(points)} {over}, and has {len(values)}"
        raise InputError(problem, key=key, remedy=f"write one for each of {over}")
    if len(points) < 2:
        raise InputError("must be two or more", key=over, remedy="one point is not a table")
    for before, after in pairwise(points):
        if not after > before:
            said = " after ".join(shown(one, kind) for one in (after, before))
            raise InputError(f"must rise: {said}", key=over, remedy="sort them; each once")
