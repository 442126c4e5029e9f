"""The driveline: elements in order, each hanging on the one before it or on the one it names."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from typing import Any, Self

from pydantic import BaseModel, ConfigDict, SerializeAsAny, ValidationError, field_validator, model_validator

from trunnion.driveline.elements import ConstantSpeed, Disk, Element, Name, Ratio
from trunnion.driveline.gears import GearPair
from trunnion.driveline.joints import HookeJoint
from trunnion.driveline.limits import Limit, Limits, OneLimit, limits_of, wrong_limits
from trunnion.driveline.operation import Operation
from trunnion.driveline.quantities import Dimensionless, Frequency
from trunnion.driveline.refusals import about, nearest, refuse
from trunnion.driveline.remarks import remarks
from trunnion.driveline.shafts import Spring
from trunnion.driveline.stages import PiecewiseShaft
from trunnion.driveline.summary import summary
from trunnion.driveline.tolerances import Tolerance, Tolerances, tolerances_of, wrong_tolerances
from trunnion.errors import InputError, InputRemark

MOST_ELEMENTS = 2000
"""Ten times the longest line of practice; its matrices fit into a gigabyte."""


class Driveline(BaseModel):
    """A chain of elements from the drive to the load, with branches where an element says ``after``.

    Parameters
    ----------
    elements : from the input to the output.
    name, description : for titles and reports.
    damping_ratio : one damping ratio for the whole line instead of damping in the shafts.
    damping_ratio_frequency : frequency at which that ratio holds [rad/s]; by default the lowest elastic mode.
    operation : where it runs.
    limits : what its parts may bear, for ``assess``.
    tolerances : how far its numbers scatter, for ``tolerance_study`` and ``certify_stability``.

    Raises
    ------
    InputError : names twice, a branch from nowhere, a drive in mid-line, damping stated twice, limits or tolerances of
        elements that cannot have them.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    elements: tuple[SerializeAsAny[Element], ...]
    name: Name | None = None
    description: str | None = None
    damping_ratio: Dimensionless | None = None
    damping_ratio_frequency: Frequency | None = None
    operation: Operation | None = None
    limits: Limits = ()
    tolerances: Tolerances = ()

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
    ) -> None:
        data: dict[str, Any] = {
            "elements": _checked(elements),
            "name": name,
            "description": description,
            "damping_ratio": damping_ratio,
            "damping_ratio_frequency": damping_ratio_frequency,
            "operation": operation,
            "limits": limits,
            "tolerances": tolerances,
        }
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise refuse(error, type(self), data, element="driveline") from None
        if self.damping_ratio is not None and self.damping_ratio < 0:
            remark = "is negative and feeds energy into the line; write it positive unless that is meant"
            warnings.warn(InputRemark(f"driveline.damping_ratio = {self.damping_ratio:g}: {remark}"), stacklevel=2)
        for _, sentence in remarks(self):
            warnings.warn(InputRemark(sentence), stacklevel=2)

    @field_validator("operation", mode="before")
    @classmethod
    def _is_operation(cls, value: object) -> object:
        if value is not None and not isinstance(value, Operation):
            raise InputError("is not an Operation", remedy='write tn.Operation(speed="1500 rpm"), say')
        return value

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        wrong = [*_wrong_names(self.names), *_wrong_parents(self)]
        if not wrong:
            wrong += _wrong_ends(self, self.parents)
        wrong += [*_wrong_damping(self), *_wrong_loads(self), *_wrong_schedules(self)]
        wrong += _wrong_drives(self)
        wrong += wrong_limits(self.limits, self.names, self.elements)
        wrong += wrong_tolerances(self.tolerances, self.names, self.elements)
        if wrong:
            raise InputError.together(wrong)
        return self

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Name of every element: as given, or its kind and its ordinal among all of that kind ("Shaft 2")."""
        seen: Counter[str] = Counter()
        names = []
        for element in self.elements:
            seen[element.kind] += 1
            names.append(element.name or f"{element.kind} {seen[element.kind]}")
        return tuple(names)

    @cached_property
    def parents(self) -> tuple[int | None, ...]:
        """Index of the element each one follows: the one named in ``after``, or the previous; first None."""
        return tuple(_parent(self, i) for i in range(len(self.elements)))

    def index(self, name: str) -> int:
        """Place of the element called `name`; InputError with the nearest name where there is none."""
        try:
            return self.names.index(name)
        except ValueError:
            raise InputError(
                "is not an element of this driveline", key=str(name), remedy=nearest(str(name), self.names)
            ) from None

    @cached_property
    def limits_by_element(self) -> tuple[OneLimit, ...]:
        """Every limit that holds; one stated for an element goes before that of its kind."""
        return limits_of(self.limits, self.names, self.elements)

    @cached_property
    def tolerances_by_path(self) -> dict[str, tuple[object, ...]]:
        """Tolerances by path ("Shaft 1.stiffness"), each as ``tolerance_study`` takes it."""
        return tolerances_of(self.tolerances, self.names, self.elements)

    def with_load(self, case: str) -> Driveline:
        """The same line under the torques of one of its load cases; disks not named there keep theirs."""
        loads = (self.operation or Operation()).load_case(case).loads
        changed = [
            type(e)(**{**e.stated, "load_torque": loads[n]}) if n in loads else e
            for e, n in zip(self.elements, self.names, strict=True)
        ]
        return self._but(elements=changed)

    def at_schedule(self, name: str, value: float) -> Driveline:
        """The same line with the angles and loads of one of its schedules at a travel [m] or a speed [rad/s]."""
        return self.replace_all((self.operation or Operation()).schedule(name).changes_at(value))

    def replace(self, name: str, **changes: Any) -> Driveline:
        """The same line with fields of the element called `name` changed; None takes a field away.

        ``line.replace("HookeJoint 1", angle="15 deg")``
        """
        return self.replace_all({name: changes})

    def replace_all(self, changes: Mapping[str, Mapping[str, Any]], **own: Any) -> Driveline:
        """The same line with fields of several elements, by name, and fields of its ``own`` changed together.

        Nothing is checked until all are changed.
        """
        elements = list(self.elements)
        for name, fields in changes.items():
            place = self.index(name)
            old = elements[place]
            stated = {key: value for key, value in {**old.stated, **fields}.items() if value is not None}
            try:
                elements[place] = type(old)(**stated)
            except InputError as error:
                raise about(error, name) from None
        return self._but(elements=elements, **own)

    def _but(self, **changes: Any) -> Driveline:
        return Driveline(**{**{key: getattr(self, key) for key in type(self).model_fields}, **changes})

    def __repr__(self) -> str:
        return summary(self)

    __str__ = __repr__


def refuse_too_many(elements: int) -> None:
    """Refuse what would fill the memory and the day before it is looked at.

    Raises
    ------
    InputError : more than ``MOST_ELEMENTS``.
    """
    if elements > MOST_ELEMENTS:
        # Of a chain of disks and shafts, with about twenty matrices of its states at a time.
        memory = 20 * 8 * elements**2 / 1e9
        raise InputError(
            f"has {elements} elements, at most {MOST_ELEMENTS} are taken; stability would need {memory:.3g} GB",
            element="driveline",
            remedy="join neighbouring parts",
        )


def _checked(elements: Iterable[Element]) -> tuple[Element, ...]:
    remedy = "write tn.Driveline([tn.ConstantSpeed(), tn.Shaft(...), tn.Disk(...)])"
    if isinstance(elements, Element) or not isinstance(elements, Iterable):
        raise InputError(f"must be a list, not a {type(elements).__name__}", key="elements", remedy=remedy)
    checked = tuple(elements)
    if not checked:
        raise InputError("has no elements", element="driveline", remedy=remedy)
    refuse_too_many(len(checked))
    wrong = [
        InputError("is not an element", element=f"element {i}", value=element, remedy=remedy)
        for i, element in enumerate(checked, start=1)
        if not isinstance(element, Element)
    ]
    if wrong:
        raise InputError.together(wrong)
    return checked


def _wrong_names(names: tuple[str, ...]) -> Iterator[InputError]:
    for name, count in Counter(names).items():
        if count > 1:
            places = [str(i) for i, n in enumerate(names, start=1) if n == name]
            some = f"{', '.join(places[:3])} and {count - 3} more" if count > 4 else " and ".join(places)
            yield InputError(f"names elements {some}", element=name, key="name", remedy="rename one of them")


def _wrong_parents(line: Driveline) -> Iterator[InputError]:
    for place in range(len(line.elements)):
        try:
            _parent(line, place)
        except InputError as error:
            yield error


def _parent(line: Driveline, place: int) -> int | None:
    after, name = line.elements[place].after, line.names[place]
    if after is None:
        return place - 1 if place else None
    where: dict[str, Any] = {"element": name, "key": "after", "value": after}
    if after not in line.names[:place]:
        if after in line.names:
            raise InputError("does not come earlier", **where, remedy=f"move {name} behind {after}")
        raise InputError("is not an earlier element", **where, remedy=nearest(after, line.names[:place]))
    parent = line.names.index(after)
    if not isinstance(line.elements[parent], Disk | ConstantSpeed | Ratio):
        remedy = "branches leave from a Disk, a ConstantSpeed or a Ratio; put a Disk there"
        raise InputError(f"is a {line.elements[parent].kind}", **where, remedy=remedy)
    return parent


def _wrong_ends(line: Driveline, parents: tuple[int | None, ...]) -> Iterator[InputError]:
    """A prescribed rotation in mid-line would cut it into two independent ones."""
    for i, element in enumerate(line.elements):
        if isinstance(element, ConstantSpeed) and i > 0 and i in parents:
            follower = line.names[parents.index(i)]
            remedy = f"make it the first or the last of its branch, or hang {follower} elsewhere with after"
            yield InputError("stands in the middle of the line", element=line.names[i], remedy=remedy)


_SPRINGS = (Spring, PiecewiseShaft, GearPair)


def _wrong_damping(line: Driveline) -> Iterator[InputError]:
    if line.damping_ratio is None:
        if line.damping_ratio_frequency is not None:
            remedy = "write damping_ratio = 0.02, say, or leave it out"
            yield InputError("stands without damping_ratio", key="damping_ratio_frequency", remedy=remedy)
        return
    if line.damping_ratio_frequency is not None and not line.damping_ratio_frequency > 0:
        yield InputError("must be positive", key="damping_ratio_frequency", remedy='write "50 Hz", say')
    for element, name in zip(line.elements, line.names, strict=True):
        keys = ("damping", "loss_factor", "mesh_damping") if isinstance(element, _SPRINGS) else ()
        key = next((k for k in keys if getattr(element, k, None)), None)
        if key is None and isinstance(element, Spring) and element.loss is not None:
            key = "loss_factor" if element.loss_factor is not None else "relative_damping"
        if key is not None:
            remedy = "leave out one of the two"
            yield InputError(
                "stands beside the line's damping_ratio",
                element=name,
                key=key,
                value=getattr(element, key),
                remedy=remedy,
            )


def _wrong_loads(line: Driveline) -> Iterator[InputError]:
    disks = [n for n, e in zip(line.names, line.elements, strict=True) if isinstance(e, Disk)]
    for case in line.operation.load_cases if line.operation else ():
        for name, torque in case.loads.items():
            if name not in disks:
                problem = "is not a Disk of this driveline"
                if name in line.names:
                    problem = f"acts on a {line.elements[line.index(name)].kind}, not on a Disk"
                where = f"load case {case.name}"
                yield InputError(problem, element=where, key=name, value=torque, remedy=nearest(name, disks))


def _wrong_schedules(line: Driveline) -> Iterator[InputError]:
    having = {"angle": "no joint with an angle", "load_torque": "not a Disk"}
    for schedule in line.operation.schedules if line.operation else ():
        for name, key in schedule.elements:
            known = [n for n, e in zip(line.names, line.elements, strict=True) if key in type(e).model_fields]
            if name not in known:
                problem = f"is {having[key]} of this driveline"
                yield InputError(problem, element=f"schedule {schedule.name}", key=name, remedy=nearest(name, known))
                continue
            for point in schedule.points:
                try:
                    old = line.elements[line.index(name)]
                    type(old)(**{**old.stated, **schedule.changes_at(point)[name]})
                except InputError as error:
                    yield about(error, f"schedule {schedule.name}, {name}")
                    break


def _wrong_drives(line: Driveline) -> Iterator[InputError]:
    """A ConstantSpeed carries whatever torque is left, so nothing is left to share beside it."""
    if not any(isinstance(element, ConstantSpeed) for element in line.elements):
        return
    for element, name in zip(line.elements, line.names, strict=True):
        if isinstance(element, Disk) and element.drive_share:
            yield InputError(
                "shares the drive of a line that a ConstantSpeed drives",
                element=name,
                key="drive_share",
                value=element.drive_share,
                remedy="leave out the ConstantSpeed, or write what this disk drives with as a negative load_torque",
            )


def hooke_joints(line: Driveline) -> list[tuple[str, float]]:
    """Name and angle [rad] of every Hooke's joint."""
    return [(n, e.angle) for n, e in zip(line.names, line.elements, strict=True) if isinstance(e, HookeJoint)]
