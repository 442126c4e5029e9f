"""What ``sensitivity`` gives: derivatives of quantities by parameters, and what matters most."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil, log10, nan

import numpy as np

from trunnion.arrays import Array
from trunnion.design.sensitivity.variables import STEPS, Scale, scale_of
from trunnion.driveline.quantities import signs
from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, computed, coordinate, internal, labelled, members, variable
from trunnion.results.finding import Finding
from trunnion.results.result import Result
from trunnion.results.units import with_unit
from trunnion.results.words import HERTZ

STRONGEST = 3
"""Parameters printed of each quantity."""
PRINTED = 6
"""Quantities printed of each kind."""
NEGLIGIBLE = 1e-12
"""Share of a quantity below which a change is rounding."""
EXACT, DIFFERENCES, IMPLICIT = "exact", "differences", "implicit"
KINDS_OF_QUANTITY = ("check", "margin", "growth rate", "spectral radius", "torque", "tip", "frequency", "damping ratio")
FLAT = "follows none of these parameters"
PER = "unit of the quantity per unit of the parameter"
CROSSES_ZERO = ("growth rate", "spectral radius")
"""Kinds whose changes are printed as they are: a share of what may be zero tells nothing."""


@labelled
class SensitivityQuantity:
    """What follows the parameters."""

    name: str = internal()
    kind: str = variable(words="one of KINDS_OF_QUANTITY")
    value: float = variable(words="in the unit of the quantity")
    unit: str = variable(name="quantity_unit")
    method: str = variable(words='"exact", "differences" or "implicit"')
    speed: float = variable("", "rad/s", "input speed where it was taken", default=nan)
    refused: str = variable(words="why it has no derivatives, if it has none", default="")


@dataclass(frozen=True)
class SensitivityRows:
    """Quantities, their derivatives and errors (quantity, direction)."""

    quantities: Sequence[SensitivityQuantity]
    slope: Array
    error: Array


@dataclass(frozen=True)
class Effect:
    """What a parameter does to one quantity: ``derivative`` [unit of the quantity per unit of the parameter], the
    logarithmic one d ln q/d ln p (NaN where one of them is zero), and the ``change`` that a usual step of it makes,
    ``step`` in its own unit, ``step_words`` as "+1 %"."""

    parameter: str
    derivative: float
    error: float
    logarithmic: float
    change: float
    step: float
    step_words: str


@labelled
class Sensitivities(Result):
    """Derivatives of quantities by the parameters of a description, in SI units, NaN where there is none.

    At a kink the derivative alone is NaN and the error half of what the slopes on its two sides differ by.
    """

    quantities: tuple[SensitivityQuantity, ...] = members(
        SensitivityQuantity, "quantity", "what follows", name="name", only="value unit kind method refused speed"
    )
    parameters: tuple[str, ...] = coordinate("parameter")
    parameter_value: Array = variable("parameter", words="in the unit of the parameter")
    parameter_unit: tuple[str, ...] = variable("parameter")
    derivative: Array = variable("quantity parameter", words=PER)
    error: Array = variable("quantity parameter", words=PER, name="derivative_error")
    unit: str = internal("of speeds in print")
    findings: tuple[Finding, ...] = attribute("what was left out", default=())

    @property
    def value(self) -> Array:
        """Values of the quantities (quantity,)."""
        return np.array([q.value for q in self.quantities])

    @property
    @computed(variable("quantity parameter", "1", "d ln(quantity)/d ln(parameter)"))
    def logarithmic(self) -> Array:
        """d ln q/d ln p (quantity, parameter) [-]; NaN where a quantity or a parameter is zero."""
        with np.errstate(divide="ignore", invalid="ignore"):
            found = self.derivative * self.parameter_value / self.value[:, None]
        usable = (self.value[:, None] != 0) & (self.parameter_value != 0)
        return np.where(usable, found, np.nan)

    @property
    @computed(variable("parameter", words="usual step, in the unit of the parameter"), after="parameter_unit")
    def step(self) -> Array:
        """Usual steps (parameter,) in the units of the parameters: 1 %, 1 deg of a joint, 10 deg of a phase; NaN where
        1 % is nothing."""
        return np.array([_step(p, v)[0] for p, v in zip(self.parameters, self.parameter_value, strict=True)])

    @property
    @computed(variable("quantity parameter", words="by the usual step, in the unit of the quantity"))
    def change(self) -> Array:
        """Change of every quantity (quantity, parameter), in its unit, that the usual step of a parameter makes."""
        return self.derivative * self.step

    def quantity(self, name: str) -> SensitivityQuantity:
        """The quantity called ``name``; InputError with the nearest name where there is none."""
        return self.quantities[self._place(name)]

    def ranked(self, name: str, most: int | None = None) -> tuple[Effect, ...]:
        """What the quantity called ``name`` follows, the largest change by a usual step first."""
        q = self._place(name)
        change, logarithmic, step = self.change[q], self.logarithmic[q], self.step
        largest = max(abs(self.value[q]), float(np.abs(np.nan_to_num(change)).max(initial=0.0)))
        order = np.argsort(-np.abs(np.nan_to_num(change)), kind="stable")
        felt = [
            p for p in order
            if np.abs(change[p]) > NEGLIGIBLE * largest and np.abs(self.derivative[q, p]) > self.error[q, p]
        ]  # fmt: skip
        return tuple(
            Effect(
                self.parameters[p],
                float(self.derivative[q, p]),
                float(self.error[q, p]),
                float(logarithmic[p]),
                float(change[p]),
                float(step[p]),
                _step(self.parameters[p], float(self.parameter_value[p]))[1],
            )
            for p in felt[:most]
        )

    def derivatives(self, name: str) -> dict[str, float]:
        """Derivatives of the quantity called ``name`` by parameter."""
        return dict(zip(self.parameters, self.derivative[self._place(name)].tolist(), strict=True))

    def kinks(self, name: str) -> tuple[str, ...]:
        """Parameters at which the quantity called ``name`` has a kink: its slopes on the two sides differ."""
        q = self._place(name)
        found = np.isnan(self.derivative[q]) & np.isfinite(self.error[q])
        return tuple(np.array(self.parameters)[found].tolist())

    def table(self, name: str) -> list[dict[str, object]]:
        """One row a parameter that the quantity called ``name`` follows, strongest first."""
        quantity = self.quantity(name)
        return [
            {
                "parameter": one.parameter,
                "effect": effect_words(quantity, one).removesuffix(f" of {one.parameter}"),
                f"derivative [{signs(quantity.unit)} per unit]": one.derivative,
                "logarithmic": one.logarithmic,
            }
            for one in self.ranked(name)
        ]

    def sentence(self, quantity: SensitivityQuantity, most: int = STRONGEST) -> str:
        """What a quantity follows most, in one sentence."""
        head = f"{quantity.name} ({self.shown(quantity)})"
        if quantity.refused:
            return f"{head}: no derivative, {quantity.refused}"
        parts = [effect_words(quantity, one) for one in self.ranked(quantity.name, most)]
        kinks = self.kinks(quantity.name)
        if kinks:
            parts.append(f"no derivative by {', '.join(kinks)}, where it has a kink")
        return f"{head}: {', '.join(parts) if parts else FLAT}"

    def plot(self, quantity: str | None = None, axes: Axes | None = None, *, most: int = 10) -> Axes:
        """Bars of what one quantity follows most, by default the first check, torque or growth rate there is; see
        ``pictures.design.sensitivities``."""
        return drawing(self, "plot")(self, axes, quantity=quantity, most=most)

    def _lines(self) -> Iterator[str]:
        many = "quantity" if len(self.quantities) == 1 else "quantities"
        yield f"sensitivity of {len(self.quantities)} {many} to {len(self.parameters)} parameters"
        for kind in KINDS_OF_QUANTITY:
            if kind == "spectral radius":  # the growth rate in other words
                continue
            own = [q for q in self.quantities if q.kind == kind]
            if kind == "margin":  # where it moves though the value does not
                flat = {q.name for q in self.quantities if q.kind == "check" and not self.ranked(q.name)}
                own = [q for q in own if q.name.removeprefix("margin of ") in flat and self.ranked(q.name)]
            yield from (f"  {self.sentence(q)}" for q in own[:PRINTED])
            if len(own) > PRINTED:
                yield f"  … and {len(own) - PRINTED} more of this kind: .ranked(name)"

    def shown(self, quantity: SensitivityQuantity) -> str:
        """The value of a quantity in an engineer's unit."""
        if quantity.unit == "rad/s":
            if quantity.kind == "frequency":
                return HERTZ.speed(quantity.value)
            return self.words.speed(float(f"{quantity.value:.6g}"))
        if quantity.kind == "margin":
            return f"{100 * quantity.value:.3g} %"
        if quantity.kind in CROSSES_ZERO:
            return with_unit(f"{quantity.value:.4g}", quantity.unit)
        return self.words.value(quantity.value, quantity.unit)

    def _place(self, name: str) -> int:
        names = [q.name for q in self.quantities]
        if name not in names:
            raise InputError("is not a quantity of this result", key="name", value=name, remedy=nearest(name, names))
        return names.index(name)


def share_of(quantity: SensitivityQuantity) -> tuple[float, str]:
    """What a change is multiplied with to be printed, and " [%]", its unit: of margins in points, of what may be zero
    as it is, of all others as a share of the value."""
    if quantity.kind == "margin":
        return 100.0, " [points]"
    if quantity.kind in CROSSES_ZERO or not quantity.value:
        return 1.0, f" [{signs(quantity.unit)}]"
    return 100 / abs(quantity.value), " [%]"


def effect_words(quantity: SensitivityQuantity, one: Effect) -> str:
    """ "+1.3 % for +1 deg of joint 1.angle"; a step that would more than double the value is taken smaller."""
    factor, unit = share_of(quantity)
    tenths = too_large(quantity, one.change)
    change = with_unit(f"{one.change * factor / 10**tenths:+.3g}", unit.strip(" []"))
    return f"{change} for {smaller(one.step_words, tenths)} of {one.parameter}"


def too_large(quantity: SensitivityQuantity, change: float) -> int:
    """By how many powers of ten a step is to be taken smaller, whose ``change`` would more than double the value: a
    derivative tells nothing so far away."""
    factor, unit = share_of(quantity)
    return max(0, ceil(log10(abs(change) * factor / 100))) if unit == " [%]" and change else 0


def smaller(words: str, tenths: int) -> str:
    """ "+1 deg" → "+0.01 deg"."""
    number, _, unit = words.partition(" ")
    return f"{float(number) / 10**tenths:+g} {unit}"


def _step(path: str, value: float) -> tuple[float, str]:
    """The usual step of a parameter in its own unit, and in words."""
    key = path.rpartition(".")[2]
    scale = Scale.BEND if key == "reference_angle" else scale_of(key) or Scale.FACTOR
    size, words = STEPS[scale]
    if scale is not Scale.FACTOR:
        return size, words
    return (size * abs(value) if value else nan), words
