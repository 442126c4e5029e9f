"""Torsional vibration dampers: a ring on a housing, which oil drags along or springs and rubber hold."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Self

from pydantic import Field, PrivateAttr, model_validator

from trunnion.driveline.elements import not_negative, positive
from trunnion.driveline.oil import POINTS, UNSTATED, Oil, oil_stiffness
from trunnion.driveline.parts import Dragged, Heavy, Numbers, Part, Sprung
from trunnion.driveline.quantities import (
    FREQUENCY,
    TEMPERATURE,
    Damping,
    Frequency,
    Inertia,
    Maybe,
    Power,
    Stiffness,
    Temperature,
    optional,
    shown,
)
from trunnion.driveline.shafts import Elastic
from trunnion.errors import InputError

if TYPE_CHECKING:
    from trunnion.laws.oil import OilStiffness


class Damper(Elastic):
    """A branch by itself: its housing on the shaft in front, its ring on the housing; what follows hangs on that shaft.

    Parameters
    ----------
    inertia : of the housing [kg m²]; without it the Disk that it is bolted to has it.
    ring_inertia : of the ring [kg m²].
    heat_rating : damping heat that it bears continuously [W], which checks compare with.
    """

    ratings: ClassVar[tuple[str, ...]] = ("heat_rating",)
    idle: ClassVar[tuple[str, ...]] = ratings
    onward: ClassVar[int] = 0

    inertia: Maybe[Inertia] = optional(default=None, description="of the housing, where no Disk has it already")
    ring_inertia: Inertia = Field(description="of the ring")
    heat_rating: Maybe[Power] = optional(default=None, description="rating, damping heat borne continuously")

    @model_validator(mode="after")
    def _heavy(self) -> Self:
        positive(self, "inertia", "ring_inertia", "heat_rating")
        return self

    @property
    def dragged(self) -> bool:
        """Whether no spring holds the ring."""
        return False

    def parts(self) -> tuple[Part, ...]:
        """A housing where it has an inertia of its own, the link, the ring."""
        link = Dragged() if self.dragged else Sprung()
        return (*((Heavy(of="housing of"),) if self.inertia is not None else ()), link, Heavy(1, of="ring of"))

    def inertias(self, number: Numbers) -> tuple[Any, ...]:
        """Of the housing and of the ring."""
        return (*((number("inertia"),) if self.inertia is not None else ()), number("ring_inertia"))


class ViscousDamper(Damper):
    """A ring in silicone oil in a closed housing (Houdaille's damper).

    The oil carries c (ω_housing − ω_ring) and no spring holds the ring: its position matters to nothing, so that one
    multiplier of the line is exactly 1 (one eigenvalue 0), which stability, modes and charts set aside. Silicone is a
    little elastic too: at one frequency ν its complex stiffness k′ + iνc′ is a ``stiffness`` k′ and a ``damping`` c′.

    As a maker's sheet has it over frequency and temperature it is ``oil``: forced responses of straight lines have it
    at the frequency of each order, ``natural_frequencies`` at that of each mode. ``simulate`` and ``transient`` have a
    Maxwell element, spring and damper in series; all else a spring and a damper side by side. Both are the oil at
    ``oil_frequency``, and a remark says how far they part from it beside that.

    Parameters
    ----------
    inertia, ring_inertia, heat_rating : as of a ``Damper``.
    damping : c of the oil [N m s/rad]; ``trunnion.damper_optimum`` finds the best for one mode.
    stiffness : k′ of the oil [N m/rad] at the frequency that matters; none by default.
    oil : instead of both its complex stiffness, see ``OilPoint``; a CSV file in a description, or ``read_oil(path)``.
    oil_frequency : at which equations in time take the oil [rad/s].
    oil_temperature : of the oil [K], where its points state some.

    >>> ViscousDamper(ring_inertia=0.12, damping="45 N*m*s/rad").dragged
    True
    """

    example: ClassVar[str] = 'ring_inertia = "0.12 kg*m^2" and damping = "45 N*m*s/rad"'

    damping: Maybe[Damping] = optional(default=None, description="of the oil")
    stiffness: Maybe[Stiffness] = optional(
        default=None, description="of the oil at the frequency that matters; none by default"
    )
    oil: Oil = optional(default=(), description="its complex stiffness over frequency, or a CSV file, instead")
    oil_frequency: Maybe[Frequency] = optional(default=None, description="at which equations in time take the oil")
    oil_temperature: Maybe[Temperature] = optional(default=None, description="of the oil")
    _law: Any = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if not self.oil:
            for key in ("oil_frequency", "oil_temperature"):
                if getattr(self, key) is not None:
                    remedy = f"write {POINTS}, or leave it out"
                    raise InputError("belongs to oil", key=key, value=getattr(self, key), remedy=remedy)
            if self.damping is None:
                raise InputError("is missing", key="damping", remedy=f"write {self.example}")
            positive(self, "damping", "stiffness")
            return self
        for key in ("damping", "stiffness"):
            if getattr(self, key) is not None:
                remedy = "leave one of the two out"
                raise InputError("conflicts with oil", key=key, value=getattr(self, key), remedy=remedy)
        if self.oil_frequency is None:
            remedy = 'write the frequency that matters, oil_frequency = "60 Hz", say'
            raise InputError("is needed with oil", key="oil_frequency", remedy=remedy)
        heated = self.oil[0].temperature is not None
        if heated != (self.oil_temperature is not None):
            problem = "is needed with temperatures of oil" if heated else "has no temperatures of oil beside it"
            remedy = 'write oil_temperature = "70 degC", say' if heated else "leave it out, or give each point one"
            raise InputError(problem, key="oil_temperature", value=self.oil_temperature, remedy=remedy)
        self.complex_stiffness(self.oil_frequency, self.oil_temperature)
        return self

    @property
    def law(self) -> OilStiffness:
        """Its complex stiffness."""
        if self._law is None:
            self._law = oil_stiffness(self.oil)
        found: OilStiffness = self._law
        return found

    def complex_stiffness(self, frequency: Any, temperature: Any) -> Any:
        """K′ + iK″ [N m/rad] of the oil at frequencies [rad/s] and temperatures [K] that broadcast.

        Raises
        ------
        InputError : a frequency or a temperature beyond its points.
        """
        at = UNSTATED if temperature is None else temperature
        found = self.law.at(frequency, at)
        beyond = self.law.beyond(frequency, at)
        if beyond is not None:
            raise self._beyond(*beyond)
        return found

    def _beyond(self, frequency: float, temperature: float) -> InputError:
        known = [one.temperature for one in self.law.isotherms]
        if not known[0] <= temperature <= known[-1]:
            reach = " to ".join(shown(one, TEMPERATURE) for one in (known[0], known[-1]))
            return InputError(
                f"lies beyond the temperatures of its oil, {reach}", key="oil_temperature",
                value=shown(float(temperature), TEMPERATURE), remedy="add points to the table",
            )  # fmt: skip
        reach = " to ".join(shown(one, FREQUENCY, digits=4) for one in self.law.reach(float(temperature)))
        return InputError(
            f"is known from {reach}, and {shown(float(abs(frequency)), FREQUENCY, digits=4)} is asked of", key="oil",
            element=self.name or self.kind, remedy="add points to the table, or narrow the range of speeds",
        )  # fmt: skip

    @property
    def dragged(self) -> bool:
        """Whether no spring holds the ring."""
        return self.stiffness is None and not self.oil

    def _oil_of(self, number: Numbers) -> Any:
        temperature = None if self.oil_temperature is None else number("oil_temperature")
        return self.complex_stiffness(number("oil_frequency"), temperature)

    def stiffness_of(self, number: Numbers) -> Any:
        """As stated, or of the oil at its frequency, or none."""
        if self.oil:
            return self._oil_of(number).real
        return 0.0 if self.stiffness is None else number("stiffness")

    def damping_of(self, number: Numbers) -> Any:
        """As stated, or of the oil at its frequency."""
        return self._oil_of(number).imag / number("oil_frequency") if self.oil else number("damping")

    @property
    def apart(self) -> tuple[float, float]:
        """Largest errors over the size of the complex stiffness of a spring and a damper that stand for the oil, side
        by side and as a Maxwell element, within a factor of √2 of their frequency, or of its points."""
        assert self.oil_frequency is not None
        temperature, series = UNSTATED if self.oil_temperature is None else self.oil_temperature, self.maxwell
        return self.law.apart(
            self.oil_frequency, temperature, (self.torsional_stiffness, self.damping_coefficient),
            (series.stiffness, series.damping, series.oil_inertia),
        )  # fmt: skip

    @property
    def maxwell(self) -> MaxwellDamper:
        """The damper with its oil as a Maxwell element, which at ``oil_frequency`` has its complex stiffness: with
        x = K′/K″ a spring k = K′(1 + x²)/x² and a damper c = kx/ω in series."""
        assert self.oil_frequency is not None
        k, w = complex(self.complex_stiffness(self.oil_frequency, self.oil_temperature)), self.oil_frequency
        x = k.real / k.imag
        spring = k.real * (1 + x * x) / (x * x)
        between = min(spring / (FAST * w) ** 2, LIGHT * self.ring_inertia)
        return MaxwellDamper(
            inertia=self.inertia, ring_inertia=self.ring_inertia, stiffness=spring, damping=spring * x / w,
            oil_inertia=between, name=self.name, after=self.after,
        )  # fmt: skip


FAST, LIGHT = 20.0, 1e-3
"""Frequency of the oil between spring and damper on its spring, over that at which it is taken, at least; its largest
inertia over that of the ring."""


class MaxwellDamper(Damper):
    """A viscous damper as motions in time have it: spring and damper in series, the oil between them light."""

    springs: ClassVar[tuple[str, ...]] = ("oil of", "")

    stiffness: Stiffness = Field(description="of the spring")
    damping: Damping = Field(description="of the damper behind it")
    oil_inertia: Inertia = Field(description="between them")

    @property
    def kind(self) -> str:
        """As it was described."""
        return ViscousDamper.__name__

    @property
    def dragged(self) -> bool:
        """No spring holds the ring."""
        return True

    def parts(self) -> tuple[Part, ...]:
        """A housing where it has an inertia of its own, the spring, the oil behind it, the damper, the ring."""
        housing = (Heavy(of="housing of"),) if self.inertia is not None else ()
        return (*housing, Sprung(), Heavy(1, of="oil of"), Dragged(1), Heavy(2, of="ring of"))

    def inertias(self, number: Numbers) -> tuple[Any, ...]:
        """Of the housing, the oil and the ring."""
        return (
            *((number("inertia"),) if self.inertia is not None else ()), self.oil_inertia, number("ring_inertia")
        )  # fmt: skip

    def links(self, number: Numbers) -> tuple[tuple[Any, Any], ...]:
        """The spring, and the damper."""
        return (number("stiffness"), 0.0), (0.0, number("damping"))


class TunedDamper(Damper):
    """A ring on a spring and a damper between it and its housing: rubber, steel springs in oil.

    Parameters
    ----------
    inertia, ring_inertia, heat_rating : as of a ``Damper``.
    stiffness : between housing and ring [N m/rad].
    damping : [N m s/rad]; ``trunnion.damper_optimum`` finds both for one mode.

    >>> TunedDamper(ring_inertia=0.02, stiffness="1.5 kN*m/rad", damping=2.0).torsional_stiffness
    1500.0
    """

    example: ClassVar[str] = 'ring_inertia = "0.02 kg*m^2", stiffness = "1.5 kN*m/rad" and damping = "2 N*m*s/rad"'

    stiffness: Stiffness = Field(description="between housing and ring")
    damping: Damping = optional(default=0.0, description="between housing and ring")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        positive(self, "stiffness")
        not_negative(self, "damping")
        return self

    def stiffness_of(self, number: Numbers) -> Any:
        """As stated."""
        return number("stiffness")
