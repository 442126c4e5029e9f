"""What a driveline is made of.

Every element is a frozen value that checks itself when it is made: unknown, missing, wrongly dimensioned and
non-physical numbers are refused with an :class:`~trunnion.errors.InputError` of one line. Numbers are in SI
units; strings with units ("12 deg") are taken everywhere. What the user states stays as stated; what follows
from it (a tube's stiffness, a tooth ratio) is a property.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

from pydantic import BeforeValidator, Field, PrivateAttr, model_validator

from trunnion.driveline.excitation import Excitations
from trunnion.driveline.gear_losses import DRAG, EFFICIENCY, RATING, MeshLoss
from trunnion.driveline.geometry import disk_inertia
from trunnion.driveline.materials import MATERIALS, of_material, without_material
from trunnion.driveline.parts import Geared, Heavy, Numbers, Part, Prescribed
from trunnion.driveline.quantities import (
    RATIO,
    Angle,
    Damping,
    Density,
    Dimensionless,
    Inertia,
    Length,
    Mass,
    Maybe,
    Power,
    QuadraticLoad,
    Several,
    Torque,
    optional,
)
from trunnion.driveline.record import Name, Record, WholeNumber, as_tuple, is_name
from trunnion.driveline.sheet import Sheet
from trunnion.errors import InputError, InputRemark

if TYPE_CHECKING:
    from trunnion.laws.torque_curve import PowerCurve, TorqueCurve

Doubt = tuple[str, str, str]
"""(key, what is odd, what to do about it)."""


def _sheet(value: object) -> object:
    if value is None or isinstance(value, Sheet):
        return value
    if not isinstance(value, dict):
        raise InputError("is not a sheet", value=value, remedy='write component = "maker/type", or tn.component(...)')
    try:
        return Sheet(**value)
    except InputError as error:
        raise error.each(lambda one: one.but(element="", key=f"sheet.{one.key}")) from None


def plain(value: object) -> object:
    """A value as a remark shows it: None of tables, which no line holds."""
    listed = isinstance(value, list | tuple) and any(isinstance(one, dict | Record) for one in value)
    return None if listed or isinstance(value, dict) else value


class Element(Record):
    """Base of all elements.

    Parameters
    ----------
    name : how messages, parameters and plots call it; by default its kind and ordinal, as "Shaft 2".
    after : name of the earlier element it hangs on, where a branch leaves the chain; by default the previous
        element.
    sheet : the maker's sheet that its numbers come from, see ``Sheet``; ``trunnion.component`` writes it.
    """

    _part_of: tuple[str, Element] | None = PrivateAttr(default=None)

    name: Name | None = Field(default=None, description="how messages, parameters and plots call the element")
    after: Name | None = Field(default=None, description="earlier element it hangs on; default: the previous one")
    sheet: Annotated[Sheet | None, BeforeValidator(_sheet)] = Field(
        default=None, description="maker's sheet that its numbers come from"
    )

    def __init__(self, **data: Any) -> None:
        super().__init__(**data)
        for key, problem, remedy in self.doubts():
            label = self.name or self.kind
            remark = InputError(problem, element=label, key=key, value=plain(getattr(self, key)), remedy=remedy)
            warnings.warn(InputRemark(str(remark)), stacklevel=2)

    @property
    def part_of(self) -> Any:
        """Name and composite that it is part of (``trunnion.driveline.composite``); None of what stands alone."""
        return self._part_of

    def as_part_of(self, name: str, composite: Element) -> Self:
        """The same as a part of a composite of that name."""
        made = type(self)(**self.stated)
        made._part_of = (name, composite)
        return made

    def but(self, **changes: Any) -> Self:
        """The same with fields changed; None takes a field away. It stays part of what it is part of."""
        made = super().but(**changes)
        made._part_of = self._part_of
        return made

    @classmethod
    def called(cls, data: dict[str, Any]) -> str:
        """Its name where it has one, else its kind."""
        return data["name"] if is_name(data.get("name")) else cls.__name__

    @property
    def idle(self) -> tuple[str, ...]:
        """Numbers that do nothing here and are not parameters."""
        return ()

    @property
    def ports(self) -> dict[str, int]:
        """Coordinates among its ``parts`` on which elements may hang, by name: ``after = "differential.right"``."""
        return {}

    @property
    def kind(self) -> str:
        """The class name: what ``type`` says in a file."""
        return type(self).__name__

    @property
    def losses(self) -> tuple[MeshLoss, ...]:
        """Its meshes that lose power."""
        return ()

    springs: ClassVar[tuple[str, ...]] = ("",)
    """What stands before its name in those of the springs and dampers among its parts, in order."""
    ratings: ClassVar[tuple[str, ...]] = ()
    """Numbers of its maker that move nothing and that checks compare with."""
    onward: ClassVar[int] = -1
    """The coordinate that whatever follows hangs on: the last, or 0 of what is a branch by itself."""

    def parts(self) -> tuple[Part, ...]:
        """What it is made of, see ``trunnion.driveline.parts``."""
        raise InputError("is not an element of a driveline", element=self.name or self.kind)

    @property
    def passes_on(self) -> tuple[Part, ...]:
        """Those of its parts that lie between what is in front of it and what follows."""
        return self.parts() if self.onward else ()

    def inertias(self, number: Numbers) -> tuple[Any, ...]:
        """Moment of inertia [kg m²] of every ``Heavy`` among its parts, for the values of its numbers, one or many."""
        return ()

    @property
    def inertia_values(self) -> tuple[float, ...]:
        """The same as described."""
        return tuple(float(one) for one in self.inertias(lambda key: getattr(self, key)))

    def doubts(self) -> Iterator[Doubt]:
        """What is accepted with a remark."""
        yield from ()

    def file_doubts(self) -> Iterator[Doubt]:
        """What earns a remark when it comes from a file, where nobody explores on purpose."""
        if self.sheet is None:
            return
        try:
            departures = self.departures
        except InputError as error:
            yield "sheet", f"holds numbers that make no {self.kind} ({error})", "read it anew by component"
            return
        for key, typed in departures.items():
            remedy = "leave it out to have the sheet's, or sheet where the part is another one"
            yield key, f"differs from {typed} of {self.sheet.component}", remedy

    @property
    def departures(self) -> dict[str, Any]:
        """What was typed from its sheet, by key, where the element states something else now.

        Raises
        ------
        InputError : what was typed makes no such element.
        """
        if self.sheet is None or not self.sheet.numbers:
            return {}
        typed = type(self)(**self.sheet.numbers)
        return {key: one for key, one in self.sheet.numbers.items() if getattr(typed, key) != getattr(self, key)}


class ConstantSpeed(Element):
    """A prescribed rotation: the drive, and at the far end of a line a clamp that turns with it.

    The speed itself belongs to the analysis (or to the file's ``[operation]``), not to the driveline.

    >>> ConstantSpeed(name="engine").kind
    'ConstantSpeed'
    """

    def parts(self) -> tuple[Part, ...]:
        """A rotation that is given."""
        return (Prescribed(),)


class Rotor(Element):
    """What is heavy, and turned or resisted from outside: a disk, a machine.

    Its outer torque at a speed is its ``load_of``; ``excitation`` are harmonic torques besides.
    """

    if TYPE_CHECKING:
        excitation: Excitations

    def parts(self) -> tuple[Part, ...]:
        """An inertia on which outer torques act."""
        return (Heavy(loaded=True),)

    def doubts(self) -> Iterator[Doubt]:
        """A harmonic torque above the mean one, as a share of which it is stated."""
        yield from super().doubts()
        for one in self.excitation:
            if one.share is not None and one.share > 1:
                problem = f"has a share of {one.share:g}, that many times the mean torque"
                yield "excitation", problem, "check it: 9 % of the mean torque is a share of 0.09"
                return

    def load_of(self, number: Numbers) -> TorqueCurve:
        """Outer torque over its own speed, positive where it resists, for the values of its numbers, one or many."""
        raise NotImplementedError

    @property
    def load(self) -> TorqueCurve:
        """The same as described."""
        return self.load_of(lambda key: getattr(self, key))

    @property
    def tangent(self) -> bool:
        """Whether equations of motion have its load by the tangent at the mean speed: any that is not a polynomial."""
        from trunnion.laws.torque_curve import PowerCurve  # a description alone loads without numpy

        return not isinstance(self.load, PowerCurve)

    @property
    def loaded_by_speed(self) -> bool:
        """Whether its load depends on the speed."""
        return self.tangent or self.loaded_by_square or bool(getattr(self.load, "viscous", 0.0))

    @property
    def loaded_by_square(self) -> bool:
        """Whether a part of its load goes with the square of the speed, as equations of motion have it."""
        return not self.tangent and bool(getattr(self.load, "quadratic", 0.0))

    @property
    def moment_of_inertia(self) -> float:
        """Polar moment [kg m²], all that turns rigidly with it."""
        return self.inertia_values[0]


class Loaded(Rotor):
    """What is heavy and carries outer torques: a disk, a vehicle.

    Parameters
    ----------
    load_torque : outer torque [N m]; positive resists rotation.
    viscous_load, quadratic_load : outer torques proportional to the speed [N m s/rad] and to its square
        [N m s²/rad²]; positive resists rotation.
    drive_share : in a free–free line (no ConstantSpeed), its share of the power that balances the loads at the mean
        speed asked for; shares count relative to each other, so one drive has any positive one.
    excitation : harmonic torques on it, see ``Excitation``; in a file also the name of a CSV table beside it.
    """

    load_torque: Torque = optional(default=0.0, description="outer torque; positive resists rotation")
    viscous_load: Damping = optional(default=0.0, description="outer torque per speed; positive resists rotation")
    quadratic_load: QuadraticLoad = optional(
        default=0.0, description="outer torque per square of the speed; positive resists rotation"
    )
    drive_share: Dimensionless = optional(
        default=0.0, description="share of the power that balances the loads, in a line without a ConstantSpeed"
    )
    excitation: Excitations = optional(default=(), description="harmonic torques, in time or in the disk's rotation")

    def load_of(self, number: Numbers) -> PowerCurve:
        """Constant, viscous and quadratic."""
        from trunnion.laws.torque_curve import PowerCurve

        constant, quadratic = self.resistance(number)
        return PowerCurve(
            number("load_torque") + constant, number("viscous_load"), number("quadratic_load") + quadratic
        )

    def resistance(self, number: Numbers) -> tuple[Any, Any]:
        """What resists beside the loads that are stated, for the values of its numbers, one or many: a torque [N m],
        and one per square of the speed [N m s²/rad²]."""
        return 0.0, 0.0


_ANGLES = as_tuple("angles", 'write firing_angles = ["0 deg", "180 deg", "540 deg", "360 deg"], say')


class DiskInertia(Element):
    """What a disk weighs: its fields stand before those of what acts on it."""

    inertia: Maybe[Inertia] = optional(default=None, description="polar moment of inertia; or give the geometry")
    outer_diameter: Maybe[Length] = optional(default=None, description="of the disk")
    inner_diameter: Maybe[Length] = optional(default=None, description="of its bore; 0 by default")
    thickness: Maybe[Length] = optional(default=None, description="of the disk")
    material: str | None = Field(
        default=None, json_schema_extra={"enum": list(MATERIALS)}, description='"steel", say, instead of the density'
    )
    density: Maybe[Density] = optional(default=None, description="of its material; steel 7850 kg/m^3")
    mass: Maybe[Mass] = optional(default=None, description="of a vehicle on wheels, instead of an inertia")
    radius: Maybe[Length] = optional(default=None, description="rolling radius of the wheels that move the mass")


class Disk(Loaded, DiskInertia):
    """A rigid inertia: flywheel, flange, gear, roll, wheel.

    Parameters
    ----------
    inertia : polar moment of inertia [kg m²]; or else the geometry.
    outer_diameter, inner_diameter, thickness : [m]; inner_diameter = 0 has no bore.
    material, density : its material by name, or ρ [kg/m³].
    mass, radius : or else a mass [kg] that a wheel of that rolling radius [m] moves, a vehicle: J = m r².
    load_torque, viscous_load, quadratic_load, drive_share, excitation : what acts on it, see ``Loaded``.
    firing_angles : where the disk carries cylinders: ``excitation`` is that of one of them, and each adds it at its
        own angle [rad], over 720° for four strokes; order k has the phase −k α_c.
    misfiring : number of one of these cylinders, from 1, that does not fire: it adds only what grows with the square
        of the speed, the inertia torque of its masses.

    >>> disk = Disk(outer_diameter="300 mm", thickness="30 mm", material="steel")
    >>> round(disk.inertia_values[0], 4)
    0.1873
    """

    example: ClassVar[str] = 'inertia = "0.4 kg*m^2"'

    firing_angles: Annotated[Several[Angle], BeforeValidator(_ANGLES)] = optional(
        default=(), description="of the cylinders that each add the excitation listed, over 720 deg for four strokes"
    )
    misfiring: WholeNumber = Field(default=None, description="number of the cylinder that does not fire, from 1")

    @model_validator(mode="before")
    @classmethod
    def _bore_default(cls, data: Any) -> Any:
        return with_defaults(of_material(data, ("density",)), "outer_diameter", inner_diameter=0.0)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        solid, rolling = ("outer_diameter", "thickness", "density"), ("mass", "radius")
        if self.mass is not None or self.radius is not None:
            one_way(self, "inertia", rolling, rolling)
            _alone(self, "mass" if self.mass is not None else "radius", ("material", "inner_diameter", *solid))
        else:
            one_way(self, "inertia", ("material", "inner_diameter", *solid), solid)
        positive(self, "inertia", *solid, *rolling)
        not_negative(self, "inner_diameter", "drive_share")
        bore(self)
        self._check_cylinders()
        return self

    @property
    def stated(self) -> dict[str, Any]:
        """The fields that differ from their defaults and do not follow from the material."""
        return without_material(super().stated)

    def _check_cylinders(self) -> None:
        count, value = len(self.firing_angles), self.misfiring
        if value is not None and not 1 <= value <= count:
            remedy = f"write a number from 1 to {count}" if count else "write firing_angles beside it"
            raise InputError("is not the number of a cylinder", key="misfiring", value=value, remedy=remedy)
        if not self.firing_angles:
            return
        if not self.excitation:
            remedy = "write the excitation of one cylinder"
            raise InputError("have no excitation to repeat", key="firing_angles", remedy=remedy)
        if any(one.frequency is not None for one in self.excitation):
            remedy = "write orders; a torque fixed in time has no cylinders"
            raise InputError("repeat orders, not a frequency", key="firing_angles", remedy=remedy)

    def inertias(self, number: Numbers) -> tuple[Any, ...]:
        """As stated, or from the mass or the geometry."""
        if self.inertia is not None:
            return (number("inertia"),)
        if self.mass is not None:
            return (number("mass") * number("radius") ** 2,)
        return (disk_inertia(*map(number, ("outer_diameter", "inner_diameter", "thickness", "density"))),)


MOST_TEETH = 100_000


def _tooth_number(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        quoted = isinstance(value, str) and value.strip().isdecimal()
        remedy = f"write {value} without quotes" if quoted else "write a positive integer"
        raise InputError("must be a whole number of teeth", value=value, remedy=remedy)
    if value > MOST_TEETH:
        raise InputError(f"must be at most {MOST_TEETH} teeth", value=value, remedy="check the number")
    return value


Teeth = Annotated[int, BeforeValidator(_tooth_number)]


class Ratio(Element):
    """A gear or final drive: rigid, without inertia, and without loss where none is stated.

    Parameters
    ----------
    ratio : input speed over output speed; negative reverses.
    teeth_in, teeth_out : tooth numbers instead; the ratio is teeth_out/teeth_in, exactly, and both shafts
        count their rotation positive in their own sense of turning.
    efficiency : power that leaves over power that enters, whichever way it flows; without it nothing is lost.
    drag_torque : of oil and seals at the input shaft, whatever the load [N m].
    heat_rating : power lost borne continuously [W], which checks compare with.

    >>> Ratio(teeth_in=11, teeth_out=43).speed_ratio
    3.909090909090909
    """

    example: ClassVar[str] = "teeth_in = 10 and teeth_out = 41, or ratio = 4.1"

    ratio: Maybe[Dimensionless] = optional(default=None, description="input speed over output speed; negative reverses")
    teeth_in: Teeth | None = Field(default=None, description="teeth of the driving gear")
    teeth_out: Teeth | None = Field(default=None, description="teeth of the driven gear")
    efficiency: Maybe[Dimensionless] = optional(default=None, description=EFFICIENCY)
    drag_torque: Maybe[Torque] = optional(default=None, description=DRAG)
    heat_rating: Maybe[Power] = optional(default=None, description=RATING)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        can_lose(self, "efficiency")
        one_way(self, "ratio", ("teeth_in", "teeth_out"), ("teeth_in", "teeth_out"))
        if self.ratio == 0:
            raise InputError("must not be zero", key="ratio", value=0.0, remedy="write input speed over output speed")
        return self

    def parts(self) -> tuple[Part, ...]:
        """Gears alone."""
        return (Geared(self.fraction),)

    @property
    def fraction(self) -> Fraction:
        """The speed ratio exactly: from the tooth numbers, or the decimal as it was written."""
        if self.teeth_in is not None and self.teeth_out is not None:
            return Fraction(self.teeth_out, self.teeth_in)
        return Fraction(str(self.ratio))

    @property
    def speed_ratio(self) -> float:
        """Input speed over output speed."""
        return float(self.fraction)

    @property
    def losses(self) -> tuple[MeshLoss, ...]:
        """Of its gears."""
        return one_mesh(self, self.fraction)


def with_defaults(data: Any, given: str, **defaults: float) -> Any:
    """Defaults that hold only where `given` is: elsewhere the keys stay unset and are not parameters."""
    if isinstance(data, dict) and data.get(given) is not None:
        return data | {k: v for k, v in defaults.items() if data.get(k) is None}
    return data


def one_way(element: Element, direct: str, other: tuple[str, ...], needed: tuple[str, ...]) -> None:
    """Refuse unless exactly one of two descriptions is given, and the second in full."""
    stated = [key for key in other if getattr(element, key) is not None]
    if getattr(element, direct) is not None:
        if stated:
            remedy = f"leave out either {direct} or {', '.join(stated)}"
            raise InputError(
                f"conflicts with {direct}", key=stated[0], value=getattr(element, stated[0]), remedy=remedy
            )
        return
    missing = [key for key in needed if getattr(element, key) is None]
    if stated and missing:
        remedy = f"needed are {', '.join(needed)}"
        if missing == ["shear_modulus"] and "material" in type(element).model_fields:
            remedy = 'write material = "steel", say, or shear_modulus'
        raise InputError(f"is needed with {stated[0]}", key=missing[0], remedy=remedy)
    if missing:
        remedy = f"write {element.example}, or {', '.join(needed)}" if direct != "ratio" else f"write {element.example}"
        raise InputError("is missing", key=direct, remedy=remedy)


def _alone(element: Element, given: str, others: tuple[str, ...]) -> None:
    for key in others:
        value = getattr(element, key)
        if value is not None:
            raise InputError(f"conflicts with {given}", key=key, value=value, remedy=f"leave out {key} or {given}")


def positive(element: Element, *keys: str) -> None:
    for key in keys:
        value = getattr(element, key)
        if value is not None and not value > 0:
            raise InputError("must be positive", key=key, value=value, remedy=_advice(element, key))


def not_negative(element: Element, *keys: str, remedy: str = "") -> None:
    for key in keys:
        value = getattr(element, key)
        if value is not None and value < 0:
            raise InputError("must not be negative", key=key, value=value, remedy=remedy or _advice(element, key))


def can_lose(element: Element, *efficiencies: str) -> None:
    """Refuse efficiencies, drag and rating of gears that cannot be.

    Raises
    ------
    InputError : names the key.
    """
    for key in efficiencies:
        stated = getattr(element, key)
        if stated is not None and not 0 < stated <= 1:
            remedy = f"write {key} = 0.98, say; 1 loses nothing"
            raise InputError("must be above 0, and at most 1", key=key, value=stated, remedy=remedy)
    not_negative(element, "drag_torque", remedy="write how much it resists; it does so in either direction")
    positive(element, "heat_rating")


def one_mesh(element: Element, ratio: Fraction, front: int = 0, driven: int = 1) -> tuple[MeshLoss, ...]:
    """The loss of a pair of gears by its ``efficiency``: friction of the one in front against the housing."""
    if getattr(element, "efficiency", None) is None:
        return ()
    return (MeshLoss(front, None, driven, -1 / float(ratio), "efficiency"),)


def _advice(element: Element, key: str) -> str:
    kind = element.quantity_of(key) or RATIO
    return f'write for example "{kind.example}"' if kind is not RATIO else f"write for example {kind.example}"


def bore(element: Any) -> None:
    outer, inner = element.outer_diameter, element.inner_diameter
    if outer is not None and inner is not None and inner >= outer:
        problem = f"must be smaller than outer_diameter = {outer:g} m"
        raise InputError(problem, key="inner_diameter", value=inner, remedy="check the units, or swap the two")
