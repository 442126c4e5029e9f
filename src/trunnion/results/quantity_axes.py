"""How a parameter reads, on axes and in sentences: quantity, unit for the eye, and the factor from SI to it."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING

from trunnion.arrays import Array
from trunnion.driveline.quantities import signs
from trunnion.results.speeds import frequency_unit, speed_factor

if TYPE_CHECKING:  # which loads the compiler
    from trunnion.systems.system import System


@dataclass(frozen=True)
class QuantityAxis:
    """What is varied, the unit it is read in ("" for none), and the factor from SI to that unit."""

    quantity: str
    unit: str
    factor: float

    @property
    def label(self) -> str:
        """``input speed [rpm]``."""
        return f"{self.quantity} [{self.unit}]" if self.unit else self.quantity

    def value(self, number: float) -> str:
        """``input speed 1500 rpm``, from SI."""
        return f"{self.quantity} {self.number(number)}"

    def said(self, values: Array) -> str:
        """``input speed from 300 rpm to 2400 rpm``, from SI."""
        return f"{self.quantity} from {self.number(float(values[0]))} to {self.number(float(values[-1]))}"

    def number(self, number: float, figures: int = 6) -> str:
        """``1500 rpm``, from SI."""
        gap = "" if self.unit in ("", "°") else " "
        return f"{number * self.factor:.{figures}g}{gap}{self.unit}"


def quantity_axis(label: str, unit: str, speed_unit: str) -> QuantityAxis:
    """Axis of a chart parameter: degrees for angles, ``speed_unit`` for the speed, SI signs otherwise."""
    if label == "speed":
        return QuantityAxis("input speed", speed_unit, speed_factor(speed_unit))
    shown, factor = signs(unit), 1.0
    if unit == "rad":
        shown, factor = "°", 180 / pi
    elif unit == "rad/s":
        shown = frequency_unit(speed_unit)
        factor = speed_factor(shown)
    return QuantityAxis(_words(label), "" if unit == "1" else shown, factor)


def parameter_axis(label: str, unit: str, speed_unit: str | None) -> QuantityAxis:
    """``quantity_axis`` for a parameter of a line; of equations of one's own (``speed_unit`` None) as they name it."""
    if speed_unit is not None:
        return quantity_axis(label, unit, speed_unit)
    return QuantityAxis(label, "" if unit == "1" else unit, 1.0)


def axis_of_parameter(system: System, name: str) -> QuantityAxis:
    """How a parameter of a system reads."""
    return parameter_axis(name, system.parameter_units.get(name, "1"), system.speed_unit)


def state_axes(system: System) -> list[QuantityAxis]:
    """How the states of a system read: rates of a line in its speed unit, all else as their units say."""
    rate = system.speed_unit
    return [
        QuantityAxis(name, rate, speed_factor(rate))
        if rate is not None and unit == "rad/s"
        else QuantityAxis(name, "" if unit == "1" else unit, 1.0)
        for name, unit in zip(system.states, system.units, strict=True)
    ]


def _words(label: str) -> str:
    """``HookeJoint *.angle`` → ``angle of all Hooke's joints``; labels that are not paths stay as they are."""
    factor = label.startswith("factor of ")
    owner, dot, key = label.removeprefix("factor of ").rpartition(".")
    if not dot:
        return label.replace("_", " ")
    key = key.replace("_", " ")
    if owner.endswith(" *") and owner[:-2] in _PLURAL:
        owner = f"all {_PLURAL[owner[:-2]]}"
    return f"{'factor of the ' if factor else ''}{key} of {owner}"


_PLURAL = {"HookeJoint": "Hooke's joints", "Shaft": "shafts", "Disk": "disks", "IdealJoint": "ideal joints"}
