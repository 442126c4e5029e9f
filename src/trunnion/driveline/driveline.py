"""The driveline: elements in order, each hanging on the one before it or on the one it names."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from typing import Any, ClassVar, Self

from pydantic import field_validator, model_validator

from trunnion.driveline.addressed import wrong_addresses
from trunnion.driveline.chain import ElementChain, checked, wrong_places
from trunnion.driveline.composite import Composite
from trunnion.driveline.elements import ConstantSpeed, Element, Loaded
from trunnion.driveline.gears import GearPair
from trunnion.driveline.joints import HookeJoint
from trunnion.driveline.limits import Limit, Limits, OneLimit, limits_of
from trunnion.driveline.machines import Machine, Motor, Propeller
from trunnion.driveline.operation import LoadCase, Operation
from trunnion.driveline.refusals import about, nearest
from trunnion.driveline.remarks import remarks, rigid_groups
from trunnion.driveline.scenarios import Scenario, Scenarios, wrong_scenarios
from trunnion.driveline.shafts import SpringElement
from trunnion.driveline.silent_cylinders import Cylinder, silent_cases
from trunnion.driveline.sn_curves import SNCurve, SNCurves, curves_of
from trunnion.driveline.stages import PiecewiseShaft
from trunnion.driveline.summary import summary
from trunnion.driveline.title_block import TitleBlock
from trunnion.driveline.tolerances import Tolerance, Tolerances, tolerances_of
from trunnion.driveline.vehicle import Tyre, Vehicle
from trunnion.errors import InputError, InputRemark
from trunnion.live import in_notebook


class Driveline(ElementChain):
    """A chain of elements from the drive to the load, with branches where an element says ``after``.

    Parameters
    ----------
    elements : from the input to the output. An ``Engine`` becomes its throws, "engine.throw 1" and so on, which
        analyses, parameters and limits name; ``as_stated`` has it as it was given, ``within`` its throws alone.
    name, description : for titles and reports.
    damping_ratio : one damping ratio for the whole line instead of damping in the shafts.
    damping_ratio_frequency : frequency at which that ratio holds [rad/s]; by default the lowest elastic mode.
    operation : where it runs.
    limits : what its parts may bear, for ``assess``.
    sn_curves : how many cycles they bear, for ``fatigue`` and ``assess``.
    tolerances : how far its numbers scatter, for ``tolerance_study`` and ``certify_stability``.
    scenarios : what happens to it when, for ``transient``.
    document : title block of the report that is handed in.

    Raises
    ------
    InputError : a name given twice, a branch from nowhere, a drive in the middle of a line, damping stated twice,
        limits or tolerances of elements that cannot have them.

    >>> import trunnion as tn
    >>> line = Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness="10 kN*m/rad"), tn.Disk(inertia=0.8)])
    >>> line.names
    ('ConstantSpeed 1', 'Shaft 1', 'Disk 1')
    """

    what: ClassVar[str] = "driveline"

    operation: Operation | None = None
    limits: Limits = ()
    sn_curves: SNCurves = ()
    tolerances: Tolerances = ()
    scenarios: Scenarios = ()
    document: TitleBlock | None = None

    def __init__(
        self,
        elements: Iterable[Element],
        *,
        name: str | None = None,
        description: str | None = None,
        damping_ratio: float | str | None = None,
        damping_ratio_frequency: float | str | None = None,
        operation: Operation | None = None,
        limits: Iterable[Limit] = (),
        tolerances: Iterable[Tolerance] = (),
        sn_curves: Iterable[SNCurve] = (),
        scenarios: Iterable[Scenario] = (),
        document: TitleBlock | None = None,
    ) -> None:
        data: dict[str, Any] = {
            "elements": checked(elements),
            "name": name,
            "description": description,
            "damping_ratio": damping_ratio,
            "damping_ratio_frequency": damping_ratio_frequency,
            "operation": operation,
            "limits": limits,
            "tolerances": tolerances,
            "sn_curves": sn_curves,
            "scenarios": scenarios,
            "document": document,
        }
        super().__init__(**data)
        if self.damping_ratio is not None and self.damping_ratio < 0:
            remark = "is negative and feeds energy into the line; write it positive unless that is meant"
            warnings.warn(InputRemark(f"driveline.damping_ratio = {self.damping_ratio:g}: {remark}"), stacklevel=2)
        for _, sentence in self.own_remarks:
            warnings.warn(InputRemark(sentence), stacklevel=2)

    @field_validator("operation", mode="before")
    @classmethod
    def _is_operation(cls, value: object) -> object:
        if value is not None and not isinstance(value, Operation):
            raise InputError("is not an Operation", remedy='write tn.Operation(speed="1500 rpm"), say')
        return value

    @field_validator("document", mode="before")
    @classmethod
    def _is_document(cls, value: object) -> object:
        if value is not None and not isinstance(value, TitleBlock):
            raise InputError("is not a TitleBlock", remedy='write tn.TitleBlock(number="TV-2031", revision="B"), say')
        return value

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        places = [*wrong_places(self)]
        wrong = [*places, *_wrong_damping(self), *_wrong_loads(self), *_wrong_schedules(self)]
        wrong += [*_wrong_wheels(self), *(() if places else _wrong_propellers(self))]
        wrong += [*_wrong_drives(self), *wrong_addresses((*self.limits, *self.sn_curves, *self.tolerances), self.parts)]
        wrong += wrong_scenarios(self.scenarios, self.parts)
        if wrong:
            raise InputError.together(wrong)
        return self

    @cached_property
    def own_remarks(self) -> tuple[tuple[str, str], ...]:
        """What of it does nothing, or holds in part only: each the feature and a sentence."""
        return tuple(remarks(self))

    @cached_property
    def limits_by_element(self) -> tuple[OneLimit, ...]:
        """Every limit that holds; that of a named element overrides its kind's."""
        return limits_of(self.limits, self.parts)

    @cached_property
    def sn_curves_by_element(self) -> dict[str, SNCurve]:
        """The S–N curve of every element that has one; that of a named element stands instead of its kind's."""
        return curves_of(self.sn_curves, self.parts)

    @cached_property
    def tolerances_by_path(self) -> dict[str, tuple[object, ...]]:
        """Tolerances by path ("Shaft 1.stiffness"), each as ``tolerance_study`` takes it."""
        return tolerances_of(self.tolerances, self.parts)

    def scenario(self, name: str) -> Scenario:
        """The scenario called ``name``; InputError with the nearest name where there is none."""
        for one in self.scenarios:
            if one.name == name:
                return one
        known = [one.name for one in self.scenarios]
        remedy = nearest(name, known) if known else "write [[scenario]] in its file"
        raise InputError("is not a scenario of this driveline", key="scenario", value=name, remedy=remedy)

    def with_load(self, case: str) -> Driveline:
        """The same line under the torques of one of its load cases; disks and machines not named there keep theirs.

        Or with one cylinder out of work: "engine cylinder 3 misfiring", "engine cylinder 3 cut out", also after the
        name of a load case and a comma.
        """
        loads, silent = self.loads_of(case), self._silent_in(case)
        factors = self.factors_of(case)
        line = self.replace(silent[0].owner, **{silent[1]: silent[0].number}) if silent else self
        elements = [e.but(load_torque=loads[n]) if n in loads else e for n, e in line.parts]
        return line.but(elements=elements).with_factors(factors)

    def with_factors(self, factors: Mapping[str, float]) -> Driveline:
        """The same line with the torques of machines, by name, times a factor at every speed."""
        if not factors:
            return self
        return self.but(
            elements=[
                e.with_torque_times(factors[n]) if n in factors and isinstance(e, Machine) else e for n, e in self.parts
            ]
        )

    def loads_of(self, case: str) -> dict[str, float]:
        """Load torques [N m] by disk of one of its load cases; none of one that only puts a cylinder out of work."""
        found = self._load_case_in(case)
        return {name: float(torque) for name, torque in found.loads.items()} if found else {}  # type: ignore[arg-type]

    def factors_of(self, case: str) -> dict[str, float]:
        """Factors on the torques of machines, by name, likewise."""
        found = self._load_case_in(case)
        return {name: float(factor) for name, factor in found.factors.items()} if found else {}  # type: ignore[arg-type]

    def _load_case_in(self, case: str) -> LoadCase | None:
        known, operation = self._silent, self.operation or Operation()
        if case in known and case not in [one.name for one in operation.load_cases]:
            return None
        base = next((case.removesuffix(f", {one}") for one in known if case.endswith(f", {one}")), case)
        return operation.load_case(base)

    @property
    def cases(self) -> tuple[str, ...]:
        """What ``assess`` judges beside the line as stated: its load cases, and where the description asks for it every
        cylinder out of work in turn, without and under each of them."""
        operation = self.operation or Operation()
        named = tuple(one.name for one in operation.load_cases)
        asked = [name for name, (_, key) in self._silent.items() if getattr(operation, key)]
        return (*named, *(f"{base}, {one}" if base else one for base in ("", *named) for one in asked))

    @cached_property
    def _silent(self) -> dict[str, tuple[Cylinder, str]]:
        return silent_cases(self.as_stated.parts)

    def _silent_in(self, case: str) -> tuple[Cylinder, str] | None:
        if case in [one.name for one in (self.operation or Operation()).load_cases]:
            return None
        return next((one for name, one in self._silent.items() if case == name or case.endswith(f", {name}")), None)

    def at_schedule(self, name: str, value: float) -> Driveline:
        """The same line with what one of its schedules has at a travel [m] or a speed [rad/s], in place of it."""
        operation = self.operation or Operation()
        schedule = operation.schedule(name)
        there = self.replace_all(schedule.changes_at(value)).with_factors(schedule.factors_at(value))
        return there.but(operation=operation.but(schedules=[one for one in operation.schedules if one.name != name]))

    def replace(self, name: str, **changes: Any) -> Driveline:
        """The same line with fields of the element called `name` changed; None takes a field away.

        ``line.replace("HookeJoint 1", angle="15 deg")``
        """
        return self.replace_all({name: changes})

    def replace_all(self, changes: Mapping[str, Mapping[str, Any]], **own: Any) -> Driveline:
        """The same line with fields of several elements, by name, and fields of its ``own`` changed together.

        Nothing is checked until all are changed.
        """
        composites = {name: one for name, one in self.as_stated.parts if isinstance(one, Composite)}
        if own_changes := {name: fields for name, fields in changes.items() if name in composites}:
            whole = [_changed(one, name, own_changes.get(name, {})) for name, one in self.as_stated.parts]
            rest = {name: fields for name, fields in changes.items() if name not in composites}
            changed = self.but(elements=whole, **({} if rest else own))
            return changed.replace_all(rest, **own) if rest else changed
        elements = list(self.elements)
        for name, fields in changes.items():
            place = self.index(name)
            elements[place] = _changed(elements[place], name, fields)
        return self.but(elements=elements, **own)

    def within(self, name: str) -> Driveline:
        """What the engine called ``name`` is made of, as a line by itself: its throws and the shafts between them.

        ``natural_frequencies(line.within("engine"))``
        """
        found = [one for one in self.elements if one.part_of is not None and one.part_of[0] == name]
        if not found:
            known = [n for n, one in self.as_stated.parts if isinstance(one, Composite)]
            remedy = nearest(name, known) if known else "only an Engine is made of several elements"
            raise InputError("is made of no other elements", key=str(name), remedy=remedy)
        alone = [type(one)(**{**one.stated, "after": None}) for one in found[:1]]
        return Driveline([*alone, *(type(one)(**one.stated) for one in found[1:])], name=name)

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> dict[str, Any]:
        return in_notebook(self)

    def __repr__(self) -> str:
        return summary(self)

    __str__ = __repr__


def _changed(element: Element, name: str, fields: Mapping[str, Any]) -> Element:
    """An element with ``fields`` changed; complaints say its ``name``."""
    try:
        return element.but(**fields) if fields else element
    except InputError as error:
        raise about(error, name) from None


_SPRINGS = (SpringElement, PiecewiseShaft, GearPair)


def _wrong_damping(line: Driveline) -> Iterator[InputError]:
    if line.damping_ratio is None:
        if line.damping_ratio_frequency is not None:
            remedy = "write damping_ratio = 0.02, say, or leave it out"
            yield InputError("is given without damping_ratio", key="damping_ratio_frequency", remedy=remedy)
        return
    if line.damping_ratio_frequency is not None and not line.damping_ratio_frequency > 0:
        yield InputError("must be positive", key="damping_ratio_frequency", remedy='write "50 Hz", say')
    for name, element in line.parts:
        keys = ("damping", "loss_factor", "mesh_damping") if isinstance(element, _SPRINGS) else ()
        key = next((k for k in keys if getattr(element, k, None)), None)
        if key is None and isinstance(element, SpringElement) and element.loss is not None:
            key = "loss_factor" if element.loss_factor is not None else "relative_damping"
        if key is not None:
            remedy = "leave out one of the two"
            yield InputError(
                "conflicts with the line's damping_ratio",
                element=name,
                key=key,
                value=getattr(element, key),
                remedy=remedy,
            )


def _wrong_wheels(line: Driveline) -> Iterator[InputError]:
    """A tyre leads to a vehicle, and a vehicle stands on something."""
    for i, (name, element) in enumerate(line.parts):
        if isinstance(element, Vehicle) and not i:
            yield InputError("has no wheels", element=name, remedy="put it behind a Tyre, or a Shaft to its wheels")
        if not isinstance(element, Tyre):
            continue
        if element.to is not None:
            if not isinstance(line.elements[line.index(element.to)], Vehicle):
                remedy = "name a Vehicle; what joins two disks is a Shaft"
                yield InputError("is not a Vehicle", element=name, key="to", value=element.to, remedy=remedy)
        elif not any(isinstance(line.elements[k], Vehicle) for k, p in enumerate(line.parents) if p == i):
            vehicles = [n for n, e in line.parts if isinstance(e, Vehicle)]
            remedy = f'write to = "{vehicles[0]}"' if vehicles else "put a Vehicle behind it"
            yield InputError("carries no vehicle", element=name, remedy=remedy)


def _wrong_propellers(line: Driveline) -> Iterator[InputError]:
    """A propeller turns in the water, and what drives it does not: a shaft leads out to it."""
    group = rigid_groups(line)
    drives = {g: name for g, (name, one) in zip(group, line.parts, strict=True) if _drives(one)}
    for g, (name, element) in zip(group, line.parts, strict=True):
        if isinstance(element, Propeller) and (g in drives or len(line.elements) == 1):
            tied = f"is tied rigidly to {drives[g]}" if g in drives else "stands alone"
            problem = f"{tied}: no shaft leads out to it"
            yield InputError(problem, element=name, key="type", value=element.kind, remedy="put a Shaft in front of it")


def _drives(element: Element) -> bool:
    return isinstance(element, ConstantSpeed | Motor) or bool(getattr(element, "drive_share", 0.0))


def _wrong_loads(line: Driveline) -> Iterator[InputError]:
    disks = [n for n, e in line.parts if isinstance(e, Loaded)]
    machines = [n for n, e in line.parts if isinstance(e, Machine) and e.torque_keys]
    for case in line.operation.load_cases if line.operation else ():
        where = f"load case {case.name}"
        for name, torque in case.loads.items():
            if name not in disks:
                problem, remedy = "is not a Disk of this driveline", nearest(name, disks)
                if name in line.names:
                    problem = f"acts on a {line.elements[line.index(name)].kind}, not on a Disk"
                if name in machines:
                    remedy = f'write factors = {{ "{name}" = 1.2 }}, say: times its torque over speed'
                yield InputError(problem, element=where, key=name, value=torque, remedy=remedy)
        yield from _wrong_factors(where, case.factors, machines, disks)
    for schedule in line.operation.schedules if line.operation else ():
        yield from _wrong_factors(f"schedule {schedule.name}", schedule.factors, machines, disks)


def _wrong_factors(
    where: str, factors: Mapping[str, object], machines: list[str], disks: list[str]
) -> Iterator[InputError]:
    for name, factor in factors.items():
        if name not in machines:
            problem = "is not a Fan, Pump, Propeller or Generator of this driveline"
            remedy = nearest(name, machines) if machines else "leave factors out"
            if name in disks:
                problem = "is a factor on a Disk, whose torque is stated by itself"
                remedy = f'write loads = {{ "{name}" = "250 N*m" }}, say'
            yield InputError(problem, element=where, key=name, value=factor, remedy=remedy)


def _wrong_schedules(line: Driveline) -> Iterator[InputError]:
    having = {"angle": "not a joint with an angle", "load_torque": "not a Disk"}
    for schedule in line.operation.schedules if line.operation else ():
        for name, key in schedule.elements:
            known = [n for n, e in line.parts if key in type(e).model_fields]
            if name not in known:
                problem = f"is {having[key]} of this driveline"
                yield InputError(problem, element=f"schedule {schedule.name}", key=name, remedy=nearest(name, known))
                continue
            for point in schedule.points:
                try:
                    line.elements[line.index(name)].but(**schedule.changes_at(point)[name])
                except InputError as error:
                    yield about(error, f"schedule {schedule.name}, {name}")
                    break


def _wrong_drives(line: Driveline) -> Iterator[InputError]:
    """A ConstantSpeed carries whatever torque is left, so nothing is left to share beside it."""
    if not any(isinstance(element, ConstantSpeed) for element in line.elements):
        return
    for name, element in line.parts:
        if getattr(element, "drive_share", 0.0):
            yield InputError(
                "shares the drive of a line that a ConstantSpeed drives",
                element=name,
                key="drive_share",
                value=getattr(element, "drive_share", None),
                remedy="leave out the ConstantSpeed, or write what this disk drives with as a negative load_torque"
                if isinstance(element, Loaded)
                else "leave out the ConstantSpeed, or drive_share",
            )


def hooke_joints(line: Driveline) -> list[tuple[str, float]]:
    """Name and angle [rad] of every Hooke's joint."""
    return [(n, e.angle) for n, e in line.parts if isinstance(e, HookeJoint)]
