"""A reciprocating engine: throws of a crank, cylinders on them that fire in order, gas and inertia torques."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import pairwise
from math import isclose, pi
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

from pydantic import BeforeValidator, Field, model_validator

from trunnion.driveline.composite import Composite
from trunnion.driveline.crank_throw import FORMULAS, CrankThrow, throw_stiffness
from trunnion.driveline.cylinder_torque import compression, cycles, for_several, gas, masses
from trunnion.driveline.elements import Disk, Doubt, Element, not_negative, positive
from trunnion.driveline.engine_doubts import doubts_of
from trunnion.driveline.excitation import Excitation, harmonics
from trunnion.driveline.pressure import PressureCurve, curves
from trunnion.driveline.quantities import (
    DEGREE,
    INERTIA,
    LENGTH,
    STIFFNESS,
    Angle,
    Damping,
    Dimensionless,
    Frequency,
    Inertia,
    Length,
    Mass,
    Maybe,
    OneOrSeveral,
    Pressure,
    QuadraticLoad,
    Stiffness,
    TableList,
    Torque,
    optional,
    shown,
)
from trunnion.driveline.record import WholeNumber, as_tuple, one_of
from trunnion.driveline.shafts import Shaft
from trunnion.errors import InputError

if TYPE_CHECKING:
    from trunnion.driveline.quantities import Stated

MOST_CYLINDERS = 48
HIGHEST_ORDER = 24
SAME_ANGLE = 0.01 * DEGREE
"""To which firing angles and ends of a curve have to agree."""
CLOSED = 0.02
"""Share of its highest pressure by which the two ends of a curve may differ."""
LOWEST_PEAK, HIGHEST_PEAK = 1e5, 1e8
"""Pressures [Pa] between which that of a running cylinder reaches; beyond them its unit is wrong."""
HIGHEST_RATIO, HIGHEST_EXPONENT = 200.0, 3.0
"""Of volumes, and of p Vⁿ = const; a gas that neither takes nor gives heat has 1.67 at most."""
DAMPING_RULES = {"mendes": 0.035}
"""Loss factor of a crank by who used it: Mendes, Meirelles and Zampieri (2008) for one six-cylinder diesel of 105 mm
bore, as openTorsion's example of that article has it; the article itself was not read."""
LOADS = {
    "throw_load_torque": "load_torque",
    "throw_viscous_load": "viscous_load",
    "throw_quadratic_load": "quadratic_load",
}
"""What auxiliaries take from a throw, and the key of its Disk."""
GAS = ("gas_torque", "pressure", "mean_indicated_pressure")
"""What gas torques are stated by, one of these."""
CRANK = ("journal_diameter", "journal_length", "pin_diameter", "pin_length", "web_thickness", "web_width")
"""Dimensions that the stiffness of a throw follows from, besides the stroke."""
BORES = ("journal_bore", "pin_bore")
_ORDER = 'write firing_order = "1-5-3-6-2-4", say'


def _one_or_each(example: str) -> Callable[[object], object]:
    several = as_tuple("quantities", f'write "{example}" for all, or a list with one for each')

    def read(value: object) -> object:
        return (value,) if isinstance(value, str | int | float) and not isinstance(value, bool) else several(value)

    return read


def _firing_order(value: object) -> object:
    if isinstance(value, str):
        value = re.split(r"[-–,\s]+", value.strip())
    if not isinstance(value, Iterable) or isinstance(value, dict):
        raise InputError("is not an order of cylinders", value=value, remedy=_ORDER)
    try:
        numbers = tuple(value)
        if any(isinstance(one, bool | float) for one in numbers):
            raise ValueError
        return tuple(int(one) for one in numbers)
    except (ValueError, TypeError):
        raise InputError("is not an order of cylinders", value=value, remedy=_ORDER) from None


def _also_one(schema: dict[str, Any]) -> None:
    """A list in the schema of a file, or one for all."""
    member = schema.pop("items")
    several = {"type": schema.pop("type"), "items": {key: one for key, one in member.items() if key != "unit"}}
    schema.update({"anyOf": [*member["anyOf"], several], "unit": member["unit"]})


def _also_text(schema: dict[str, Any]) -> None:
    schema.update({"anyOf": [{"type": schema.pop("type"), "items": schema.pop("items")}, {"type": "string"}]})


if TYPE_CHECKING:
    FiringOrder = Stated[tuple[int, ...], str | Iterable[int]]
else:
    FiringOrder = Annotated[tuple[int, ...], BeforeValidator(_firing_order)]


class Engine(Composite):
    """A reciprocating engine or compressor: becomes the throws of its crank, Disks "engine.throw 1" and so on from its
    front, and the Shafts between them, "engine.crank 1-2"; or one Disk, "engine.crankshaft".

    Shafts at its front and to its flywheel are elements of their own. Zero rotation is the top dead centre of the
    cylinder that fires first. Cylinder c, which fires at the crank angle α_c, turns order k of its torque by −k α_c.

    Parameters
    ----------
    firing_order : numbers of the cylinders in the order in which they fire, "1-5-3-6-2-4"; throw 1 is in front.
    firing_intervals : crank angle from each firing to the next [rad], as many as cylinders; even by default.
    strokes : 4 or 2.
    bank_angle : of a V engine [rad]: throw j bears cylinder j and, of n, cylinder j + n/2.
    throw_inertia : of a throw with the rotating part of its rods [kg m²], one for all or one for each; without
        reciprocating masses, whose mean is added where they are stated.
    throw_stiffness : of the crank from one throw to the next [N m/rad], one for all or one for each.
    journal_diameter, journal_bore, journal_length, pin_diameter, pin_bore, pin_length, web_thickness, web_width : or
        else dimensions of a throw [m], bores 0 by default, with its stroke and
    shear_modulus : G [Pa].
    stiffness_formula : "carter" or "ker wilson", see ``trunnion.driveline.crank_throw``; check your edition.
    damping, loss_factor, loss_factor_frequency : of these shafts, as of a ``Shaft``; or else
    damping_rule : "mendes", the loss factor 0.035 of one published model of a six-cylinder diesel of 105 mm bore.
    rigid : all throws as one inertia.
    bore, stroke, rod_length : of a cylinder, and of its rod between the centres [m].
    reciprocating_mass : of a cylinder: piston, pin and the oscillating part of the rod [kg].
    gas_torque : harmonics of one cylinder's gas torque on the crank, as the excitation of a Disk; tables over torque,
        or over speed and torque, are by the mean torque of one cylinder. In a file also the name of a CSV table.
    pressure : or else its absolute pressure over the crank angle, a ``PressureCurve`` for each load, see
        ``read_pressure``. Mean torque and harmonics follow from the exact slider crank; between the loads harmonics are
        linear in the mean torque that a cylinder drives with, and refused beyond them. One curve holds at all loads.
    mean_indicated_pressure : or else p_mi [Pa], rising with the load: gas torques of the ideal cycle with that work
        (``trunnion.laws.indicated_cycle``; no table of others is used), one for all loads, or several, linear between
        them. It needs compression_ratio, charge_pressure, polytropic_exponent and
    peak_pressure : highest absolute pressure [Pa], one for all or one for each.
    expansion_exponent : m of p Vᵐ = const after combustion; by default the polytropic_exponent.
    crankcase_pressure : behind the piston [Pa].
    orders : highest order of gas torques from curves, and of inertia torques.
    drive_share : of the engine, as of a Disk; its throws share it evenly.
    throw_load_torque : what a pump or another auxiliary takes from a throw [N m], positive where it resists; one for
        all or one for each. Cylinders drive it besides: gas torques stay those of the drive share.
    throw_viscous_load, throw_quadratic_load : likewise by the speed [N m s/rad] and its square [N m s²/rad²].
    misfiring : number of a cylinder that does not fire, and whose gas is compressed and expands again.
    cut_out : number of a cylinder without any gas torque.
    compression : pressure in a cylinder that does not fire; or else
    compression_ratio, charge_pressure, polytropic_exponent : ε, absolute pressure [Pa] at the bottom dead centre and n
        of p Vⁿ = const from there on; one charge for all or one for each mean indicated pressure. Without either, a
        misfire leaves no gas torque at all.

    A misfire or cut-out leaves the mean torque as it is, and what the other cylinders do.

    >>> engine = Engine(
    ...     firing_order="1-3-4-2", throw_inertia="0.02 kg*m^2", throw_stiffness="0.6 MN*m/rad",
    ...     gas_torque=[{"order": 2, "amplitude": "90 N*m"}],
    ... )
    >>> [round(angle / DEGREE) for angle in engine.firing_angles]
    [0, 540, 180, 360]
    """

    example: ClassVar[str] = (
        'firing_order = "1-3-4-2", throw_inertia = "0.02 kg*m^2" and throw_stiffness = "0.6 MN*m/rad"'
    )

    firing_order: FiringOrder = Field(
        description="numbers of the cylinders as they fire, 1-5-3-6-2-4", json_schema_extra=_also_text
    )
    firing_intervals: Annotated[OneOrSeveral[Angle], BeforeValidator(_one_or_each("120 deg"))] = optional(
        default=(), description="crank angle from each firing to the next; even by default", json_schema_extra=_also_one
    )
    strokes: Annotated[int, BeforeValidator(one_of((2, 4), "is neither 2 nor 4", "write strokes = 4"))] = Field(
        default=4, json_schema_extra={"enum": [2, 4]}, description="per cycle: 4 or 2"
    )
    bank_angle: Maybe[Angle] = optional(default=None, description="of a V engine, two cylinders on a throw")
    throw_inertia: Annotated[OneOrSeveral[Inertia], BeforeValidator(_one_or_each("0.02 kg*m^2"))] = optional(
        default=(), description="of a throw without reciprocating masses; one for all, or one for each",
        json_schema_extra=_also_one,
    )  # fmt: skip
    throw_stiffness: Annotated[OneOrSeveral[Stiffness], BeforeValidator(_one_or_each("0.6 MN*m/rad"))] = optional(
        default=(), description="from one throw to the next; one for all, or one for each", json_schema_extra=_also_one
    )
    journal_diameter: Maybe[Length] = optional(default=None, description="of the crank; or give throw_stiffness")
    journal_bore: Length = optional(default=0.0, description="of a journal; 0 is solid")
    journal_length: Maybe[Length] = optional(default=None, description="of a journal between two webs")
    pin_diameter: Maybe[Length] = optional(default=None, description="of a crank pin")
    pin_bore: Length = optional(default=0.0, description="of a crank pin; 0 is solid")
    pin_length: Maybe[Length] = optional(default=None, description="of a crank pin between two webs")
    web_thickness: Maybe[Length] = optional(default=None, description="of a web, along the crank")
    web_width: Maybe[Length] = optional(default=None, description="of a web")
    shear_modulus: Maybe[Pressure] = optional(default=None, description="of the crank, where its dimensions are given")
    stiffness_formula: Annotated[
        str, BeforeValidator(one_of(tuple(FORMULAS), "is not a formula", 'write "carter" or "ker wilson"'))
    ] = Field(
        default="carter",
        json_schema_extra={"enum": list(FORMULAS)},
        description="of a throw's stiffness by its dimensions",
    )
    damping: Damping = optional(default=0.0, description="of the crank between two throws")
    loss_factor: Maybe[Dimensionless] = optional(default=None, description="of the crank, instead of damping")
    loss_factor_frequency: Maybe[Frequency] = optional(
        default=None, description="at which the loss factor holds; by default at all"
    )
    damping_rule: Annotated[
        str | None, BeforeValidator(one_of(tuple(DAMPING_RULES), "is not a rule", 'write "mendes"'))
    ] = Field(default=None, description="a published loss factor of a crank, instead of loss_factor")
    rigid: bool = Field(default=False, description="all throws as one inertia")
    bore: Maybe[Length] = optional(default=None, description="of a cylinder")
    stroke: Maybe[Length] = optional(default=None, description="of its piston, twice the crank radius")
    rod_length: Maybe[Length] = optional(default=None, description="of its rod, between the centres")
    reciprocating_mass: Maybe[Mass] = optional(default=None, description="of piston, pin and part of the rod")
    gas_torque: Annotated[TableList[Excitation], BeforeValidator(harmonics("gas_torque", none=False))] = optional(
        default=(), description="harmonics of the gas torque of one cylinder"
    )
    pressure: Annotated[TableList[PressureCurve], BeforeValidator(curves("pressure"))] = optional(
        default=(), description="of one cylinder, a curve for each load"
    )
    mean_indicated_pressure: Annotated[OneOrSeveral[Pressure], BeforeValidator(_one_or_each("18 bar"))] = optional(
        default=(), description="of a cylinder, one for all loads or several that rise", json_schema_extra=_also_one
    )
    peak_pressure: Annotated[OneOrSeveral[Pressure], BeforeValidator(_one_or_each("150 bar"))] = optional(
        default=(), description="highest absolute pressure; one for all, or one for each", json_schema_extra=_also_one
    )
    expansion_exponent: Maybe[Dimensionless] = optional(
        default=None, description="after combustion; default: polytropic_exponent"
    )
    crankcase_pressure: Pressure = optional(default=101325.0, description="absolute, behind the piston")
    orders: Dimensionless = optional(default=12.0, description="highest order of gas torques and inertia torques")
    drive_share: Dimensionless = optional(
        default=0.0, description="share of the power that balances the loads, in a line without a ConstantSpeed"
    )
    throw_load_torque: Annotated[OneOrSeveral[Torque], BeforeValidator(_one_or_each("40 N*m"))] = optional(
        default=(), description="what auxiliaries take from a throw; one for all, or one for each",
        json_schema_extra=_also_one,
    )  # fmt: skip
    throw_viscous_load: Annotated[OneOrSeveral[Damping], BeforeValidator(_one_or_each("2 N*m*s/rad"))] = optional(
        default=(), description="the same over the speed", json_schema_extra=_also_one
    )
    throw_quadratic_load: Annotated[
        OneOrSeveral[QuadraticLoad], BeforeValidator(_one_or_each("0.02 N*m*s^2/rad^2"))
    ] = optional(default=(), description="the same over the square of the speed", json_schema_extra=_also_one)
    misfiring: WholeNumber = Field(default=None, description="number of the cylinder that does not fire")
    cut_out: WholeNumber = Field(default=None, description="number of the cylinder without gas torque")
    compression: Annotated[TableList[PressureCurve], BeforeValidator(curves("compression"))] = optional(
        default=(), description="pressure in a cylinder that does not fire"
    )
    compression_ratio: Maybe[Dimensionless] = optional(default=None, description="instead, of its volumes")
    charge_pressure: Annotated[OneOrSeveral[Pressure], BeforeValidator(_one_or_each("3 bar"))] = optional(
        default=(), description="absolute, where compression begins; one for all, or one for each mean pressure",
        json_schema_extra=_also_one,
    )  # fmt: skip
    polytropic_exponent: Maybe[Dimensionless] = optional(default=None, description="of compression and expansion")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        self._check_order()
        self._check_crank()
        self._check_cylinder()
        self._check_not_firing()
        # Also the parts say what is wrong with what they are given: phases in time, damping stated twice.
        gas(self)
        return self

    def _check_order(self) -> None:
        order, count = self.firing_order, len(self.firing_order)
        if not 1 <= count <= MOST_CYLINDERS:
            raise InputError(
                f"must have 1 to {MOST_CYLINDERS} cylinders", key="firing_order", value=list(order), remedy=_ORDER
            )
        if sorted(order) != list(range(1, count + 1)):
            missing = sorted(set(range(1, count + 1)) - set(order))
            problem = f"must have every cylinder from 1 to {count} once, and has no {missing[0]}"
            raise InputError(problem, key="firing_order", value="-".join(map(str, order)), remedy=_ORDER)
        if self.bank_angle is not None and count % 2:
            problem = f"has two cylinders on every throw, and firing_order {count}"
            remedy = "leave it out, or check the order"
            raise InputError(problem, key="bank_angle", value=self.bank_angle, remedy=remedy)
        intervals = self.firing_intervals
        if not intervals:
            return
        if len(intervals) == 1 < count:
            intervals *= count
        if len(intervals) != count:
            problem = f"must be {count} angles, one after each firing, the last back to the first"
            raise InputError(problem, key="firing_intervals", value=len(intervals), remedy="leave them out where even")
        if min(intervals) < 0:
            stated = f"{min(intervals) / DEGREE:.6g} deg"
            remedy = "write the crank angle from each firing to the next; 0 where two fire together"
            raise InputError("must not be negative", key="firing_intervals", value=stated, remedy=remedy)
        if abs(sum(intervals) - self.cycle) > SAME_ANGLE * count:
            problem = f"make {sum(intervals) / DEGREE:.6g} deg together, and a cycle has {self.cycle / DEGREE:g}"
            remedy = "check them, and strokes"
            raise InputError(problem, key="firing_intervals", value=len(intervals), remedy=remedy)

    def _check_crank(self) -> None:
        if not self.throw_inertia:
            raise InputError("is missing", key="throw_inertia", remedy='write throw_inertia = "0.02 kg*m^2", say')
        drawn = [key for key in (*CRANK, "shear_modulus") if getattr(self, key) is not None]
        drawn += [key for key in BORES if getattr(self, key)]
        if drawn and self.throw_stiffness:
            value, remedy = getattr(self, drawn[0]), "leave one of the two out"
            raise InputError("conflicts with throw_stiffness", key=drawn[0], value=value, remedy=remedy)
        if drawn:
            self._check_drawing(drawn[0])
        elif not self.throw_stiffness and not self.rigid and self.throws > 1:
            remedy = f'write throw_stiffness = "0.6 MN*m/rad", say, rigid = true, or {", ".join(CRANK)}'
            raise InputError("is missing", key="throw_stiffness", remedy=remedy)
        for key, kind, count in (
            ("throw_inertia", INERTIA, self.throws), ("throw_stiffness", STIFFNESS, self.throws - 1)
        ):  # fmt: skip
            values = getattr(self, key)
            if any(not one > 0 for one in values):
                raise InputError("must be positive", key=key, value=min(values), remedy=f'write "{kind.example}", say')
            if len(values) > 1 and len(values) != count:
                what = "throw" if key == "throw_inertia" else "shaft between two throws"
                problem = f"must be one for all or {count}, one for each {what}"
                raise InputError(problem, key=key, value=list(values), remedy=f'write {key} = "{kind.example}", say')
        for key in LOADS:
            values = getattr(self, key)
            if len(values) > 1 and len(values) != self.throws:
                problem = f"must be one for all or {self.throws}, one for each throw"
                raise InputError(problem, key=key, value=list(values), remedy="write 0 for a throw that drives nothing")
        positive(self, "loss_factor_frequency")
        not_negative(self, "damping", "loss_factor", "drive_share")
        for key in ("loss_factor", "damping"):
            if self.damping_rule is not None and getattr(self, key):
                value, remedy = self.damping_rule, "leave one of the two out"
                raise InputError(f"conflicts with {key}", key="damping_rule", value=value, remedy=remedy)
        if self.loss_factor is not None and self.damping:
            raise InputError(
                "conflicts with loss_factor", key="damping", value=self.damping, remedy="leave one of the two out"
            )
        if self.crank_loss_factor is None and self.loss_factor_frequency is not None:
            raise InputError("is needed with loss_factor_frequency", key="loss_factor", remedy="write 0.02, say")

    def _check_drawing(self, given: str) -> None:
        self._needs(given, *CRANK, "shear_modulus", "stroke")
        positive(self, *CRANK, "shear_modulus", "stroke")
        for part in ("journal", "pin"):
            bore, outer = getattr(self, f"{part}_bore"), getattr(self, f"{part}_diameter")
            if not 0 <= bore < outer:
                problem = f"must be smaller than {part}_diameter = {outer:g} m, and not negative"
                raise InputError(problem, key=f"{part}_bore", value=bore, remedy="check the units")
        if not FORMULAS[self.stiffness_formula](self._drawn) > 0:
            remedy = 'check them, or write stiffness_formula = "carter"'
            raise InputError("leaves a throw without stiffness", key="stiffness_formula", remedy=remedy)

    @property
    def _drawn(self) -> CrankThrow:
        numbers = {key: float(getattr(self, key)) for key in (*CRANK, *BORES)}
        return CrankThrow(radius=float(self.stroke or 0.0) / 2, **numbers)

    @property
    def stiffness_of_throw(self) -> float | None:
        """Stiffness [N m/rad] from one throw to the next that follows from dimensions; None without them."""
        if self.shear_modulus is None:
            return None
        return throw_stiffness(self._drawn, self.shear_modulus, self.stiffness_formula)

    @property
    def stiffnesses(self) -> tuple[float, ...]:
        """Stiffness [N m/rad] of every shaft between two throws, as stated or as it follows."""
        drawn = self.stiffness_of_throw
        return self._each(self.throw_stiffness if drawn is None else (drawn,), self.throws - 1)

    def _check_cylinder(self) -> None:
        positive(self, "bore", "stroke", "rod_length", "reciprocating_mass", "crankcase_pressure")
        if self.stroke is not None and self.rod_length is not None and not self.rod_length > self.stroke / 2:
            remedy = f"longer than half the stroke, {shown(self.stroke / 2, LENGTH)}; check the units"
            raise InputError("must be longer than the crank", key="rod_length", value=self.rod_length, remedy=remedy)
        self._needs("reciprocating_mass", "stroke", "rod_length")
        self._needs("pressure", "bore", "stroke", "rod_length")
        if not 1 <= self.orders <= HIGHEST_ORDER:
            raise InputError(f"must be from 1 to {HIGHEST_ORDER}", key="orders", value=self.orders, remedy="12, say")
        stated = [key for key in GAS if getattr(self, key)]
        if len(stated) > 1:
            remedy = "leave one of the two out"
            raise InputError(f"conflicts with {stated[0]}", key=stated[1], remedy=remedy)
        if any(one.frequency is not None for one in self.gas_torque):
            raise InputError("repeats orders, not a frequency", key="gas_torque", remedy="write orders")
        for key in ("pressure", "compression"):
            for curve in getattr(self, key):
                self._check_curve(key, curve)

    def _check_curve(self, key: str, curve: PressureCurve) -> None:
        at = "" if curve.load is None else f" at load {curve.load:g}"
        peak = max(curve.pressures)
        if peak < LOWEST_PEAK:
            problem = f"reaches {peak:.4g} Pa{at}, less than the pressure of the air"
            raise InputError(problem, key=key, remedy="check its unit: bar read as Pa, say")
        if peak > HIGHEST_PEAK:
            problem = f"reaches {peak / 1e5:.4g} bar{at}, more than any engine"
            raise InputError(problem, key=key, remedy="check its unit: Pa read as bar, say")
        angles, pressures = curve.angles, curve.pressures
        span, step = angles[-1] - angles[0], max(b - a for a, b in pairwise(angles))
        cycle = f"{self.cycle / DEGREE:g} deg"
        if not _covers(self.cycle, span, step):
            problem = f"covers {span / DEGREE:.6g} deg{at}, and a cycle of {self.strokes} strokes has {cycle}"
            raise InputError(problem, key=key, remedy=self._whole_cycle(span, step))
        gap = abs(pressures[-1] - pressures[0])
        if self.closes(curve) and gap > CLOSED * max(pressures):
            ends = f"{pressures[0] / 1e5:.4g} bar at its beginning and {pressures[-1] / 1e5:.4g} bar a cycle later"
            problem = f"does not close{at}: {ends}"
            raise InputError(problem, key=key, remedy="give one cycle of steady running")

    def _whole_cycle(self, span: float, step: float) -> str:
        """What to do about a curve over another ``span`` than the cycle, a ``step`` between its points [rad]."""
        other = 6 - self.strokes
        if _covers(other * pi, span, step):
            return f"write strokes = {other}, or give one whole cycle"
        for factor, words in ((DEGREE, "deg read as rad"), (1 / DEGREE, "rad read as deg")):
            if _covers(self.cycle, factor * span, factor * step):
                return f"check the unit of its angles: {words}, say"
        return "give one whole cycle"

    def closes(self, curve: PressureCurve) -> bool:
        """Whether the last point of a curve is the first one again."""
        return abs(curve.angles[-1] - curve.angles[0] - self.cycle) <= SAME_ANGLE

    def _check_not_firing(self) -> None:
        for key in ("misfiring", "cut_out"):
            value = getattr(self, key)
            if value is not None and value not in self.firing_order:
                remedy = f"write a number from 1 to {len(self.firing_order)}"
                raise InputError("is not the number of a cylinder", key=key, value=value, remedy=remedy)
        if self.misfiring is not None and self.misfiring == self.cut_out:
            raise InputError(
                "names a cylinder that is cut out",
                key="misfiring",
                value=self.misfiring,
                remedy="leave one of the two out",
            )
        if len(self.compression) > 1:
            remedy = "give the curve of a cylinder that does not fire"
            raise InputError("must be one curve", key="compression", value=len(self.compression), remedy=remedy)
        numbers = ("compression_ratio", "charge_pressure", "polytropic_exponent")
        given = [key for key in numbers if getattr(self, key) not in (None, ())]
        if given and self.compression:
            remedy = "leave one of the two out"
            raise InputError("conflicts with compression", key=given[0], value=getattr(self, given[0]), remedy=remedy)
        if given and len(given) < 3:
            missing = next(key for key in numbers if key not in given)
            raise InputError(f"is needed with {given[0]}", key=missing, remedy=f"write {', '.join(numbers)}")
        self._needs("compression_ratio", "bore", "stroke", "rod_length")
        self._check_gas()
        self._check_cycles()
        self._needs("compression", "bore", "stroke", "rod_length")

    def _check_gas(self) -> None:
        """Refuse a ratio of volumes and exponents that no gas has, before anything is computed with them."""
        ratio = self.compression_ratio
        if ratio is not None and not ratio > 1:
            problem = "leaves no clearance volume, which is that of the stroke over compression_ratio - 1"
            raise InputError(problem, key="compression_ratio", value=ratio, remedy="write compression_ratio = 14, say")
        if ratio is not None and ratio > HIGHEST_RATIO:
            problem = f"is more than {HIGHEST_RATIO:g}, which no cylinder has"
            remedy = "write the largest volume over the smallest, 14 say"
            raise InputError(problem, key="compression_ratio", value=ratio, remedy=remedy)
        for key in ("polytropic_exponent", "expansion_exponent"):
            exponent = getattr(self, key)
            if exponent is not None and not 0 < exponent <= HIGHEST_EXPONENT:
                problem = f"must be positive, and at most {HIGHEST_EXPONENT:g}"
                raise InputError(problem, key=key, value=exponent, remedy="write 1.35, say: n of p V^n = const")

    def _check_cycles(self) -> None:
        """Refuse mean indicated pressures that no cycle has."""
        means = self.mean_indicated_pressure
        for key in ("mean_indicated_pressure", "peak_pressure", "charge_pressure"):
            values = getattr(self, key)
            if any(not one > 0 for one in values):
                remedy = f'write {key} = "{150 if key == "peak_pressure" else 15} bar", say'
                raise InputError("must be positive", key=key, value=min(values), remedy=remedy)
            if len(values) > 1 and len(values) != len(means):
                problem = f"must be one for all or {len(means)}, one for each mean_indicated_pressure"
                raise InputError(problem, key=key, value=list(values), remedy="add those that are missing")
        if not means:
            for key in ("peak_pressure", "expansion_exponent"):
                self._needs(key, "mean_indicated_pressure")
            return
        self._needs("mean_indicated_pressure", "bore", "stroke", "rod_length")
        self._needs(
            "mean_indicated_pressure", "peak_pressure", "compression_ratio", "charge_pressure", "polytropic_exponent"
        )
        if any(b <= a for a, b in pairwise(means)):
            remedy = "sort them; each once"
            raise InputError("must rise", key="mean_indicated_pressure", value=list(means), remedy=remedy)
        for mean, cycle in cycles(self):
            if not cycle.peak >= cycle.compressed:
                problem = f"has {_bar(cycle.peak)}, below the {_bar(cycle.compressed)} of compression alone"
                remedy = "check compression_ratio, charge_pressure and polytropic_exponent"
                raise InputError(problem, key="peak_pressure", value=_bar(cycle.peak), remedy=remedy)
            if not cycle.least <= mean <= cycle.most:
                end, what = ("least", "less") if mean < cycle.least else ("most", "more")
                problem = f"has {_bar(mean)}, {what} than the {_bar(getattr(cycle, end))} that a peak of"
                problem += f" {_bar(cycle.peak)} gives at {end}"
                remedy = "give the peak_pressure and charge_pressure of that load"
                raise InputError(problem, key="mean_indicated_pressure", value=_bar(mean), remedy=remedy)

    def _needs(self, key: str, *needed: str) -> None:
        """Refuse what is stated without what it needs."""
        missing = next((one for one in needed if getattr(self, one) in (None, ())), None)
        if getattr(self, key) not in (None, ()) and missing is not None:
            raise InputError(f"is needed with {key}", key=missing, remedy=f"write {', '.join(needed)}")

    def doubts(self) -> Iterator[Doubt]:
        yield from doubts_of(self)

    @property
    def cycle(self) -> float:
        """Crank angle [rad] after which all repeats."""
        return self.strokes * pi

    @property
    def firing_angles(self) -> tuple[float, ...]:
        """Crank angle [rad] at which every cylinder fires, by number; the first in the order at 0."""
        count = len(self.firing_order)
        intervals = self.firing_intervals or (self.cycle / count,)
        if len(intervals) == 1:
            intervals *= count
        at = {cylinder: sum(intervals[:place]) for place, cylinder in enumerate(self.firing_order)}
        return tuple(at[number] for number in range(1, count + 1))

    @property
    def crank_loss_factor(self) -> float | None:
        """Of the crank between two throws, as stated or by the rule."""
        return self.loss_factor if self.damping_rule is None else DAMPING_RULES[self.damping_rule]

    @property
    def throws(self) -> int:
        """How many the crank has."""
        return len(self.firing_order) if self.bank_angle is None else len(self.firing_order) // 2

    @property
    def on_throws(self) -> tuple[tuple[int, ...], ...]:
        """Numbers of the cylinders on every throw."""
        banks = 1 if self.bank_angle is None else 2
        return tuple(tuple(j + 1 + bank * self.throws for bank in range(banks)) for j in range(self.throws))

    @property
    def of_one_cylinder(self) -> tuple[Excitation, ...]:
        """Gas and inertia torques of one cylinder that fires, phases from its own top dead centre."""
        return (*gas(self), *masses(self)[0])

    @property
    def compresses(self) -> bool:
        """Whether a cylinder that misfires keeps a gas torque, that of its compression."""
        return bool(compression(self))

    def throw_of(self, cylinder: int) -> int:
        """Number of the throw, or 1 of a rigid engine, that bears a cylinder."""
        return 1 if self.rigid else next(j for j, there in enumerate(self.on_throws, start=1) if cylinder in there)

    def made_of(self, name: str) -> tuple[Element, ...]:
        """Disks and the Shafts between them."""
        inertias = self._each(self.throw_inertia, self.throws)
        loads = {own: self._each(getattr(self, key) or (0.0,), self.throws) for key, own in LOADS.items()}
        if self.rigid:
            every = tuple(range(1, len(self.firing_order) + 1))
            taken = {own: sum(one) for own, one in loads.items()}
            crank = self._throw(f"{name}.crankshaft", sum(inertias), every, self.drive_share, taken, self.after)
            return (crank,)
        found: list[Element] = []
        share, stiffnesses = self.drive_share / self.throws, self.stiffnesses if self.throws > 1 else ()
        for j, (inertia, cylinders) in enumerate(zip(inertias, self.on_throws, strict=True), start=1):
            if j > 1:
                found.append(
                    Shaft(
                        stiffness=stiffnesses[j - 2], damping=self.damping, loss_factor=self.crank_loss_factor,
                        loss_factor_frequency=self.loss_factor_frequency, name=f"{name}.crank {j - 1}-{j}",
                    )
                )  # fmt: skip
            after = self.after if j == 1 else None
            taken = {own: one[j - 1] for own, one in loads.items()}
            found.append(self._throw(f"{name}.throw {j}", inertia, cylinders, share, taken, after))
        return tuple(found)

    def refitted(self, name: str, elements: Sequence[Element]) -> Self | None:
        """With the inertias and stiffnesses of the elements, where nothing else of them has changed."""
        inertias = self._each(self.throw_inertia, self.throws)
        own = [one for one in self.made_of(name) if isinstance(one, Disk)]
        disks = [one for one in elements if isinstance(one, Disk)]
        if any(one.inertia is None for one in disks):
            return None
        changes: dict[str, Any] = {}
        if self.rigid:
            for key, one in LOADS.items():
                taken = float(getattr(disks[0], one))
                changes[key] = (taken, *[0.0] * (self.throws - 1)) if taken else ()
        else:
            moved = [
                was if new.inertia == old.inertia else was + float(new.inertia or 0) - float(old.inertia or 0)
                for was, new, old in zip(inertias, disks, own, strict=True)
            ]
            changes["throw_inertia"] = _short(moved)
            for key, one in LOADS.items():
                loads = [float(getattr(disk, one)) for disk in disks]
                if loads != [float(getattr(disk, one)) for disk in own]:
                    changes[key] = _short(loads) if any(loads) else ()
        stiffnesses = [float(one.stiffness or 0) for one in elements if isinstance(one, Shaft)]
        if stiffnesses and tuple(stiffnesses) != self.stiffnesses:
            changes |= dict.fromkeys((*CRANK, *BORES, "shear_modulus", "stiffness_formula"))
            changes["throw_stiffness"] = _short(stiffnesses)
        try:
            found = self.but(**changes)
        except InputError:
            return None
        alike = zip(elements, found.made_of(name), strict=True)
        return found if all(_but_rounding(new, made) for new, made in alike) else None

    def _each(self, values: Sequence[float], count: int) -> tuple[float, ...]:
        return tuple(values) * count if len(values) == 1 else tuple(values)

    def _throw(
        self,
        name: str,
        inertia: float,
        cylinders: Sequence[int],
        share: float,
        taken: dict[str, float],
        after: str | None,
    ) -> Disk:
        inertial, mean = masses(self)
        silent = {self.misfiring, self.cut_out} & set(cylinders)
        angles = [self.firing_angles[c - 1] for c in cylinders]
        many = len(cylinders)
        firing = tuple(for_several(one, many) for one in gas(self))
        every = (*firing, *inertial)
        shakes: dict[str, Any] = {"excitation": every, "firing_angles": angles} if every else {}
        if silent:
            found: list[Excitation] = []
            for cylinder, angle in zip(cylinders, angles, strict=True):
                own = every
                if cylinder == self.misfiring:
                    own = (*(for_several(one, many) for one in compression(self)), *inertial)
                elif cylinder == self.cut_out:
                    own = inertial
                found += [one.but(phase=one.phase - float(one.order or 0) * angle) for one in own]
            shakes = {"excitation": tuple(found)}
        return Disk(
            name=name, after=after, inertia=inertia + many * mean, drive_share=share,
            **{key: value for key, value in {**taken, **shakes}.items() if value},
        )  # fmt: skip


def _covers(cycle: float, span: float, step: float) -> bool:
    """Whether a curve over ``span`` is a whole ``cycle``, of which the last ``step`` may be left out [rad]."""
    return cycle - 1.5 * step <= span <= cycle + SAME_ANGLE


def _bar(pressure: float) -> str:
    return f"{pressure / 1e5:.4g} bar"


def _short(values: Sequence[float]) -> Sequence[float]:
    """One for all where they are alike."""
    return values[:1] if len(set(values)) == 1 else values


def _but_rounding(new: Element, made: Element) -> bool:
    """Whether two elements state the same, but for the rounding of an inertia."""
    if not isinstance(new, Disk) or not isinstance(made, Disk):
        return new.stated == made.stated
    alike = isclose(float(new.inertia or 0), float(made.inertia or 0), rel_tol=1e-12)
    return alike and {**new.stated, "inertia": made.inertia} == made.stated
