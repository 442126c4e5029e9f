"""What a curve over a parameter is labelled with."""

from __future__ import annotations

from dataclasses import dataclass

from trunnion.results.quantity_axes import QuantityAxis, parameter_axis


@dataclass(frozen=True)
class Names:
    """Name and unit of the parameter, and of the curves that are observed; ``speed_unit`` of a driveline is what its
    description prints speeds in."""

    label: str = ""
    unit: str = "1"
    curves: tuple[str, ...] = ()
    curve_unit: str = "1"
    speed_unit: str | None = None

    @property
    def axis(self) -> QuantityAxis:
        """How the parameter reads."""
        return parameter_axis(self.label, self.unit, self.speed_unit)

    def said(self, value: float) -> str:
        """``speed = 1500 rpm``, from SI."""
        return f"{self.label} = {self.axis.number(value)}"
