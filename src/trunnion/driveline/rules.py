"""Rules of ``assess`` by name, and what each counts for in which application.

::

    [operation]
    application = "road"

    [[operation.switched_off]]
    rule = "bending"
    reason = "critical speed measured on the vehicle at 4100 rpm"

A guideline that was written for one kind of machine does not condemn another: it decides where it was made for, is
shown elsewhere, and does not apply where joints are built for other angles. Limits of the file, ratings and physical
checks always decide.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, Field

from trunnion.driveline.quantities import TableList
from trunnion.driveline.record import Record, listed, one_of
from trunnion.errors import InputError

APPLICATIONS = {
    "road": "propeller shafts of road vehicles",
    "steering": "steering columns",
    "pto": "power take-off shafts of tractors and implements",
    "mill": "spindles of rolling mills",
    "ship": "ship propulsion",
    "industrial": "motors, compressors, pumps, fans, generators",
}
"""What a line may be, and what belongs to it."""
LONGEST_REASON = 300


class Weight(Enum):
    """What a rule counts for."""

    DECIDES = "decides"
    SHOWN = "shown"
    FOREIGN = "does not apply"

    def __str__(self) -> str:
        return self.value


@dataclass(frozen=True)
class NamedRule:
    """One rule that a file can name.

    name; about: what it asks; source; decides: applications in which it decides, None where it decides in all and
    without one; foreign: those it was not made for; kept: why it cannot be switched off, "" where it can.
    """

    name: str
    about: str
    source: str
    decides: tuple[str, ...] | None = None
    foreign: tuple[str, ...] = ()
    kept: str = ""

    @property
    def guideline(self) -> bool:
        """Whether it is a rule of practice, not a limit, a rating or a physical check."""
        return self.decides is not None

    def weight(self, application: str | None) -> Weight:
        """What it counts for in an application; None where the file states none."""
        if self.decides is None or application in self.decides:
            return Weight.DECIDES
        return Weight.FOREIGN if application in self.foreign else Weight.SHOWN


SPICER = "Spicer's driveline operating-angle calculator"
_STEEP = ("steering", "pto")
_NOT_VEHICLES = (*_STEEP, "mill")
RULES = {
    one.name: one
    for one in (
        NamedRule(
            "own-limits",
            "what `[[limit]]` states, and that every spring has a limit",
            "the file",
            kept="the limits are yours: change or remove the [[limit]]",
        ),
        NamedRule(
            "stability",
            "no disturbance grows",
            "Floquet",
            kept="a motion that grows breaks the line whatever a guideline allows: change the line or its speed_range",
        ),
        NamedRule(
            "fatigue",
            "Miner's sum of every element with a `[[sn_curve]]`, over life, duty and passages",
            "the file; ASTM E1049-85, Palmgren and Miner",
            kept="the curves are yours: change or remove the [[sn_curve]]",
        ),
        NamedRule("gear-hammer", "the teeth of a mesh stay in contact", "mechanics"),
        NamedRule("din-740", "ratings that a `Coupling` states", "DIN 740-2 in form"),
        NamedRule(
            "coupling-temperature", "a coupling settles below the temperature that it states", "the maker's sheet"
        ),
        NamedRule("brake-heat", "the friction power that a brake states as its rating", "the maker's sheet"),
        NamedRule("converter-heat", "the heat that a torque converter states as its rating", "the maker's sheet"),
        NamedRule("gear-heat", "the lost power that gears or a belt state as their rating", "the maker's sheet"),
        NamedRule("damper-heat", "the heat that a damper states as its rating", "the maker's sheet"),
        NamedRule("pendulum-travel", "the travel that a centrifugal pendulum states as its stop", "the file"),
        NamedRule("slip-clutch", "a slip clutch sticks: its torque stays below its capacity", "mechanics"),
        NamedRule("m68", "shafts with `ship_shaft`; in a ship one at least", "IACS UR M68 in form"),
        NamedRule(
            "spicer-angles",
            "smallest and largest angle of every Hooke's joint",
            f"{SPICER}; up to 3000 rpm as Parker Chelsea HY25-1890-M1/US prints it",
            ("road",),
            _NOT_VEHICLES,
        ),
        NamedRule("equal-angles", "two joints at equal angles", SPICER, ("road",), _NOT_VEHICLES),
        NamedRule(
            "acceptance-accelerations",
            "angular acceleration behind and between joints",
            "usual acceptance of propeller shafts",
            ("road",),
            _NOT_VEHICLES,
        ),
        NamedRule("elbe-uniformity", "evenness of the output", "Elbe, Cardan shafts", ("road",), _STEEP),
        NamedRule("bending", "tubes below their bending critical speed", "practice of propeller shafts", ("road",)),
        NamedRule("separation", "modes 10 % apart from the orders", "API 617/684", ("industrial",)),
    )
}
"""Every rule of ``assess`` by its name."""


def _reason(value: object) -> object:
    if not isinstance(value, str) or not value.strip():
        raise InputError("gives no reason", value=value, remedy="write in a sentence why the rule does not fit")
    if len(value) > LONGEST_REASON or not value.strip().isprintable():
        remedy = f"write one line of at most {LONGEST_REASON} characters"
        raise InputError("is not one line of text", value=value, remedy=remedy)
    return value.strip()


def _switchable(value: Any) -> Any:
    found = _KNOWN(value)
    if RULES[value].kept:
        raise InputError("cannot be switched off", value=value, remedy=RULES[value].kept)
    return found


_KNOWN = one_of(RULES, "is not a rule of assess", f"known: {', '.join(RULES)}", near=True)


class SwitchedOff(Record):
    """A rule that is not to judge this line, and why.

    Parameters
    ----------
    rule : its name, as "spicer-angles"; limits of the file and stability cannot be switched off.
    reason : one sentence, which every verdict and report prints.

    >>> SwitchedOff(rule="spicer-angles", reason="the frame leaves no other angles").rule
    'spicer-angles'
    """

    what: ClassVar[str] = "switched-off rule"
    example: ClassVar[str] = 'rule = "bending" and reason = "measured on the vehicle"'

    rule: Annotated[str, BeforeValidator(_switchable)] = Field(
        json_schema_extra={"enum": [name for name, rule in RULES.items() if not rule.kept]},
        description="name of the rule that is not to judge this line",
    )
    reason: Annotated[str, BeforeValidator(_reason)] = Field(
        min_length=1, max_length=LONGEST_REASON, description="why, in one sentence that the report prints"
    )

    @classmethod
    def called(cls, data: dict[str, Any]) -> str:
        """What it is, and of which rule."""
        return f"{cls.what} {data['rule']}" if isinstance(data.get("rule"), str) else cls.what

    def __str__(self) -> str:
        return f"{self.rule}: {self.reason}"


SwitchedOffRules = Annotated[
    TableList[SwitchedOff], BeforeValidator(listed(SwitchedOff, SwitchedOff.what, owner="rule", key="switched_off"))
]
Application = Annotated[
    str, BeforeValidator(one_of(APPLICATIONS, "is not an application", f"known: {', '.join(APPLICATIONS)}"))
]


def markdown() -> str:
    """The table as ``docs/assess.md`` prints it."""
    applications = [f"`{name}`" for name in APPLICATIONS]
    head = ["rule", "what it asks", "source", *applications, "none stated", "can be switched off"]
    return "\n".join(["| " + " | ".join(head) + " |", "|" + "---|" * len(head), *_rows()])


def _rows() -> Iterator[str]:
    for rule in RULES.values():
        weights = [str(rule.weight(application)) for application in (*APPLICATIONS, None)]
        cells = [f"`{rule.name}`", rule.about, rule.source, *weights, "no" if rule.kept else "yes"]
        yield "| " + " | ".join(cells) + " |"


if __name__ == "__main__":
    print(markdown())
