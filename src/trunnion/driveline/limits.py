"""What the parts of a line may bear: limits of an element, or of all elements of a kind.

::

    [[limit]]
    of = "front tube"                   # an element, or "Shaft *" for all of a kind
    max_torque = "6 kN*m"
    vibratory_torque = "600 N*m"
    margin = "10 %"

A limit changes no motion; ``assess`` compares with it. A named element's limit overrides its kind's.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Self

from pydantic import BeforeValidator, Field, model_validator

from trunnion.driveline.addressed import Addressed, Elements, Where, in_turn
from trunnion.driveline.belts import Belt
from trunnion.driveline.brakes import Brake
from trunnion.driveline.clutches import Clutch
from trunnion.driveline.couplings import Coupling
from trunnion.driveline.dampers import TunedDamper, ViscousDamper
from trunnion.driveline.elements import Disk, Element
from trunnion.driveline.gears import GearPair
from trunnion.driveline.machines import Fan, Generator, Motor, Propeller, Pump
from trunnion.driveline.pendulums import CentrifugalPendulum
from trunnion.driveline.planetary import Planetary
from trunnion.driveline.quantities import (
    RATIO,
    Acceleration,
    Angle,
    Dimensionless,
    Maybe,
    Pressure,
    Speed,
    Torque,
    optional,
    shown,
)
from trunnion.driveline.record import listed, one_of
from trunnion.driveline.shafts import Shaft
from trunnion.driveline.stages import PiecewiseShaft
from trunnion.driveline.torque_converters import TorqueConverter
from trunnion.driveline.vehicle import Tyre, Vehicle
from trunnion.errors import InputError

SHIP_SHAFTS = {
    "flange": 1.0,
    "shrink fit": 1.0,
    "keyway tapered": 0.60,
    "keyway cylindrical": 0.45,
    "radial hole": 0.50,
    "slot": 0.30,
    "propeller shaft": 0.55,
    "propeller shaft forward": 0.80,
}
"""Design features of ship shafts and their factor C_K (IACS UR M68)."""

SPRING_KINDS: tuple[type[Element], ...] = (
    Shaft, Coupling, PiecewiseShaft, Clutch, ViscousDamper, TunedDamper, CentrifugalPendulum, Belt, Tyre,
    TorqueConverter,
)  # fmt: skip
"""Elements that carry a torque, meshes aside."""
_TURNING: tuple[type[Element], ...] = (Disk, Vehicle, Motor, Generator, Fan, Pump, Propeller, Brake)
_MAY_HAVE: dict[str, tuple[type[Element], ...]] = {
    "max_torque": (*SPRING_KINDS, GearPair, Planetary),
    "vibratory_torque": (*SPRING_KINDS, GearPair, Planetary),
    "transient_vibratory_torque": (*SPRING_KINDS, GearPair, Planetary),
    "max_stress": (Shaft,),
    "max_twist": SPRING_KINDS,
    "max_speed_fluctuation": _TURNING,
    "max_acceleration": _TURNING,
    "temperature_factor": (Coupling,),
    "starting_factor": (Coupling,),
    "ship_shaft": (Shaft,),
}
_TUBE = {"max_stress": ("outer_diameter",), "ship_shaft": ("outer_diameter", "tensile_strength")}
"""What of a shaft a limit needs besides."""


_FEATURES = one_of(SHIP_SHAFTS, "is not a design feature of a ship's shaft", 'write "flange", say', near=True)


class Limit(Addressed):
    """Limits of one element or of all elements of a kind.

    Parameters
    ----------
    of : name of the element, or "Shaft *" for all shafts (any kind of element).
    max_torque : largest |mean + vibratory| torque [N m]; of a mesh, at its driven gear; of a ``Planetary`` with elastic
        teeth, in its meshes with the sun and with the ring, that of all planets together about their axes.
    vibratory_torque : half of peak-to-peak [N m], borne continuously.
    transient_vibratory_torque : the same, borne for passing quickly: where only the continuous limit is exceeded,
        the speed range is barred.
    max_stress : largest shear stress at the outside of a tube [Pa].
    max_twist : largest |mean + vibratory| twist [rad].
    max_speed_fluctuation : half of peak-to-peak of the angular speed [rad/s].
    max_acceleration : half of peak-to-peak of the angular acceleration [rad/s²].
    margin : share of each limit here that must stay free.
    temperature_factor, starting_factor : S_t and S_z of a coupling's ratings; 1 by default.
    ship_shaft : judges the shaft by IACS UR M68, as one with this design feature.

    Raises
    ------
    InputError : nothing limited, or a number that is not positive.

    >>> Limit(of="Shaft *", max_torque="2 kN*m", margin="10 %").max_torque
    2000.0
    """

    what: ClassVar[str] = "limit"
    example: ClassVar[str] = 'of = "Shaft 1"'

    max_torque: Maybe[Torque] = optional(default=None, description="largest torque, mean and vibratory together")
    vibratory_torque: Maybe[Torque] = optional(default=None, description="half of peak-to-peak, continuously")
    transient_vibratory_torque: Maybe[Torque] = optional(
        default=None, description="half of peak-to-peak, where the line passes quickly"
    )
    max_stress: Maybe[Pressure] = optional(default=None, description="largest shear stress at the outside of a tube")
    max_twist: Maybe[Angle] = optional(default=None, description="largest twist, mean and vibratory together")
    max_speed_fluctuation: Maybe[Speed] = optional(default=None, description="of a disk, half of peak-to-peak")
    max_acceleration: Maybe[Acceleration] = optional(default=None, description="of a disk, half of peak-to-peak")
    margin: Dimensionless = optional(default=0.0, description="share of each limit here that must stay free")
    temperature_factor: Dimensionless = optional(default=1.0, description="S_t of a coupling's ratings")
    starting_factor: Dimensionless = optional(default=1.0, description="S_z of a coupling's ratings")
    ship_shaft: Annotated[str, BeforeValidator(_FEATURES)] | None = Field(
        default=None,
        json_schema_extra={"enum": list(SHIP_SHAFTS)},
        description="judge the shaft by IACS UR M68, as one with this design feature",
    )

    @model_validator(mode="after")
    def _sensible(self) -> Self:
        if not self.limited:
            raise InputError("limits nothing", key="of", value=self.of, remedy='write max_torque = "4 kN*m", say')
        for key, value in self.limited.items():
            kind = self.quantity_of(key)
            if kind is not None and not value > 0:
                raise InputError("must be positive", key=key, value=value, remedy=f'write "{kind.example}"')
        if not 0 <= self.margin < 1:
            remedy = 'write "10 %", say: the share that must stay free'
            raise InputError("must be at least 0 and below 1", key="margin", value=self.margin, remedy=remedy)
        if self.transient_vibratory_torque is not None:
            if self.vibratory_torque is None:
                remedy = "write the continuous limit beside it"
                raise InputError("is needed with transient_vibratory_torque", key="vibratory_torque", remedy=remedy)
            if self.transient_vibratory_torque < self.vibratory_torque:
                raise InputError(
                    "is smaller than vibratory_torque, which is borne continuously",
                    key="transient_vibratory_torque",
                    value=self.transient_vibratory_torque,
                    remedy="swap the two",
                )
        return self

    @property
    def limited(self) -> dict[str, Any]:
        """What it limits, by key."""
        return {key: value for key, value in self.stated.items() if key not in ("of", "margin")}

    @property
    def shown(self) -> dict[str, object]:
        """What it limits as an engineer writes it: it is kept in SI, in which nobody would know it again."""
        return {key: _with_unit(key, value) for key, value in self.limited.items()}

    def wrong_for(self, key: str, concerned: Elements, where: Where) -> Iterator[InputError]:
        """That none of the elements ``concerned`` can have a limit."""
        lacking = [_lacks(element, key) for _, element in concerned]
        if all(lacking):
            yield InputError(lacking[0] or "", **where, remedy=_remedy(concerned[0][1], key))


WITHOUT_LIMIT = "torque without limit"
"""Name of the check that lists what could have one and has none."""
LIMIT_KINDS = {key: kind for key in Limit.model_fields if (kind := Limit.quantity_of(key)) is not None}
"""Physical kinds of its quantities."""
Limits = Annotated[
    tuple[Limit, ...],
    BeforeValidator(listed(Limit, "limit", 'write limits=[tn.Limit(of="Shaft 1", max_torque="4 kN*m")]', owner="of")),
]


@dataclass(frozen=True)
class OneLimit:
    """One limit of one element: its name, key and value, and the margin required of it."""

    element: str
    key: str
    value: Any
    margin: float


def limits_of(limits: Sequence[Limit], parts: Elements) -> tuple[OneLimit, ...]:
    """Every limit that holds, by element; that of a named element overrides its kind's."""
    found: dict[tuple[str, str], OneLimit] = {}
    for limit, name, element in in_turn(limits, parts):
        for key, value in limit.limited.items():
            if _lacks(element, key) is None:
                found[name, key] = OneLimit(name, key, value, limit.margin)
    place = {name: i for i, (name, _) in enumerate(parts)}
    return tuple(sorted(found.values(), key=lambda one: place[one.element]))


def _with_unit(key: str, value: object) -> object:
    return shown(value, LIMIT_KINDS[key]) if isinstance(value, float) and LIMIT_KINDS[key] is not RATIO else value


def _lacks(element: Element, key: str) -> str | None:
    """Why an element cannot have a limit; None where it can."""
    if not isinstance(element, _MAY_HAVE[key]):
        return f"does not belong to a {element.kind}"
    if isinstance(element, Planetary) and not element.elastic:
        return "needs the elastic teeth of a Planetary"
    for needed in _TUBE.get(key, ()):
        if getattr(element, needed, None) is None:
            return f"needs the {needed} of the Shaft"
    return None


def _remedy(element: Element, key: str) -> str:
    if not isinstance(element, _MAY_HAVE[key]):
        kinds = ", ".join(kind.__name__ for kind in _MAY_HAVE[key])
        own = [k for k, kinds_ in _MAY_HAVE.items() if isinstance(element, kinds_)]
        return f"it limits {kinds}" + (f"; a {element.kind} may have {', '.join(own)}" if own else "")
    if isinstance(element, Planetary):
        return "write its sun_mesh_stiffness and ring_mesh_stiffness, or limit the shafts on it"
    needed = next(n for n in _TUBE[key] if getattr(element, n, None) is None)
    return {
        "outer_diameter": "describe it by outer_diameter, length and material, or limit its torque",
        "tensile_strength": 'write tensile_strength = "600 MPa", or name a material with one',
    }[needed]
