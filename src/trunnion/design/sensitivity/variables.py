"""Design variables of a line: every stiffness, inertia, damping, joint angle and phase, one number each.

A change has a *size*, so that changes of different kinds can be compared: |Δ ln p| of a stiffness, inertia or damping;
a joint's angle counts 30° and a phase 257° as one, so that 0.7 is a factor of two, 21° of a joint, half a turn of a
phase.
"""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum
from functools import cached_property
from math import ceil, exp, floor, isfinite, log, log10, pi

from trunnion.driveline.driveline import Driveline, hooke_joints
from trunnion.driveline.elements import Disk
from trunnion.driveline.parameters import PackedLine, pack
from trunnion.driveline.quantities import DEGREE
from trunnion.results.fields import internal, labelled, variable
from trunnion.results.units import in_words

BEND, TURN = 30 * DEGREE, pi / 0.7
"""Angle of a joint, and phase, whose change has the size 1 [rad]."""


class Scale(Enum):
    """How changes of a variable are measured."""

    FACTOR = "factor"
    BEND = "bend"
    PHASE = "phase"


_WORDS = {
    "stiffness": ("softer", "stiffer"),
    "mesh_stiffness": ("softer", "stiffer"),
    "inertia": ("lighter", "heavier"),
    "mass": ("lighter", "heavier"),
    "thickness": ("thinner", "thicker"),
}
_NAMED = ("outer_diameter", "damping", "mesh_damping", "loss_factor", "relative_damping", "damping_ratio")
_PHASES = ("fork_offset", "plane", "phase")


STEPS = {
    Scale.FACTOR: (0.01, "+1 %"),
    Scale.BEND: (DEGREE, "+1 deg"),
    Scale.PHASE: (10 * DEGREE, "+10 deg"),
}
"""Steps in which sensitivities are printed."""


@labelled
class DesignVariable:
    """One number of a line that may be changed."""

    path: str = internal("as ``pack`` names it")
    column: int = internal("of the packed numbers")
    value: float = variable(words="in the unit of the variable", name="present")
    unit: str = variable(words="of the value", name="variable_unit")
    scale: Scale = internal("how changes are measured")

    def at(self, size: float) -> float:
        """The value after a change of signed ``size``."""
        if self.scale is Scale.FACTOR:
            return self.value * exp(size)
        return self.value + size * (BEND if self.scale is Scale.BEND else TURN)

    def size(self, value: float) -> float:
        """Signed size of the change to ``value``."""
        if self.scale is Scale.FACTOR:
            return log(value / self.value)
        return (value - self.value) / (BEND if self.scale is Scale.BEND else TURN)

    def tidy(self, value: float) -> float:
        """``value`` rounded away from the present one: two figures of a percentage, 0.1° of a joint, 1° of a phase."""
        if self.scale is Scale.FACTOR:
            percent = 100 * abs(value / self.value - 1)
            step = 10.0 ** (floor(log10(percent)) - 1) if percent > 0 else 1.0
            percent = step * ceil(percent / step - 1e-9)
            return self.value * (1 + (percent if value > self.value else -percent) / 100)
        step = DEGREE * (0.1 if self.scale is Scale.BEND else 1.0)
        steps = (value - self.value) / step
        return self.value + step * (ceil(steps - 1e-9) if steps > 0 else floor(steps + 1e-9))

    @property
    def element(self) -> str:
        """Name of the element; "" for what belongs to the whole line."""
        return self.path.rpartition(".")[0]

    @property
    def key(self) -> str:
        """What of the element: "stiffness", "excitation 2 phase"."""
        return self.path.rpartition(".")[2]

    def worded(self, value: float) -> str:
        """ "coupling 2 softer by 18 % (32.8 kN m/rad)"."""
        owner = f" of {self.element}" if self.element else ""
        if self.scale is not Scale.FACTOR:
            before, after = f"{self.value / DEGREE:.4g}", f"{value / DEGREE:.4g}"
            what = "angle" if self.scale is Scale.BEND else self.key.replace("_", " ")
            return f"{what}{owner} at {after} deg instead of {before} deg"
        percent = f"by {100 * abs(value / self.value - 1):.3g} %"
        new = self.shown(value)
        for word, (less, more) in _WORDS.items():
            if self.key == word:
                return f"{self.element} {less if value < self.value else more} {percent} ({new})"
        direction = "smaller" if value < self.value else "larger"
        return f"{self.key.replace('_', ' ')}{owner} {direction} {percent} ({new})"

    def shown(self, value: float) -> str:
        """A value with an engineer's unit."""
        return in_words(value, self.unit)


class Design:
    """A line, its packed numbers, and what of it may be changed."""

    def __init__(self, line: Driveline) -> None:
        self.line = line
        self.packed: PackedLine = pack(line)

    @cached_property
    def variables(self) -> tuple[DesignVariable, ...]:
        """Every stiffness, inertia, damping, joint angle and phase that is not zero and can matter.

        Harmonics of one cylinder come from one pressure: their phases are not turned one by one.
        """
        return tuple(self._variables())

    def changed(self, variable: DesignVariable, value: float) -> Driveline | None:
        """The line with one number changed; None where it, or the line with it, is refused, or is no longer a tube."""
        numbers = self.packed.values.copy()
        numbers[variable.column] = value
        if not isfinite(value) or self._worn(variable, value):
            return None
        return self.packed.line_if_possible(numbers)

    def _worn(self, variable: DesignVariable, value: float) -> bool:
        """Whether a smaller outer diameter leaves a bored shaft less than half of its wall."""
        bore = f"{variable.element}.inner_diameter"
        if variable.key != "outer_diameter" or bore not in self.packed.labels:
            return False
        inner = float(self.packed.values[self.packed.labels.index(bore)])
        return inner > 0 and value - inner < (variable.value - inner) / 2

    def _variables(self) -> Iterator[DesignVariable]:
        joints = hooke_joints(self.line)
        bent, angles = any(angle for _, angle in joints), {f"{name}.angle" for name, _ in joints}
        excited = sum(label.endswith((" amplitude", " quadratic_amplitude")) for label in self.packed.labels)
        sources = excited + len(joints)
        cylinders = {
            name
            for name, one in zip(self.line.names, self.line.elements, strict=True)
            if isinstance(one, Disk) and one.firing_angles
        }
        for column, (path, unit) in enumerate(zip(self.packed.labels, self.packed.units, strict=True)):
            value, key = float(self.packed.values[column]), path.rpartition(".")[2]
            scale = scale_of(key)
            if scale is Scale.FACTOR and not value > 0:
                continue
            if scale is Scale.BEND and path not in angles:
                continue
            if scale is Scale.PHASE and not (bent if key in ("fork_offset", "plane") else sources > 1):
                continue
            if scale is Scale.PHASE and path.rpartition(".")[0] in cylinders:
                continue
            if scale is not None:
                yield DesignVariable(path, column, value, unit, scale)


def scale_of(key: str) -> Scale | None:
    """How changes of a number are measured; None for what no designer turns: loads, speeds, amplitudes."""
    if key in (*_WORDS, *_NAMED) or (key.startswith("stiffness ") and key.removeprefix("stiffness ").isdigit()):
        return Scale.FACTOR
    if key == "angle":
        return Scale.BEND
    return Scale.PHASE if key.rpartition(" ")[2] in _PHASES else None
