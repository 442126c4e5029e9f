"""What an FMU says of itself: the variables of a line and modelDescription.xml of FMI 2.0 and 3.0."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np

from trunnion._version import __version__
from trunnion.equations.line_regimes import staged_springs
from trunnion.equations.line_system import LineSystem
from trunnion.laws.stages import GUARDS

UNITS = {
    "s": {"s": "1"},
    "rad": {"rad": "1"},
    "rad/s": {"s": "-1", "rad": "1"},
    "rad/s2": {"s": "-2", "rad": "1"},
    "N.m": {"kg": "1", "m": "2", "s": "-2"},
}
"""Of the variables, by the base units of SI."""
TURNS = 20
"""Of the input, that an experiment lasts where nobody says how long."""
_POINTS_A_TURN = 50
_LONGEST_NAME = 60


@dataclass(frozen=True)
class FmuVariable:
    """One of them: ``place`` is the station or spring it belongs to, ``kind`` what an output tells."""

    name: str
    reference: int
    unit: str
    description: str
    start: float | None = None
    place: int = -1
    kind: str = ""


@dataclass(frozen=True)
class FmuDescription:
    """All of them, by what they are; ``duration`` and ``step`` [s] of an experiment."""

    name: str
    identifier: str
    states: tuple[FmuVariable, ...]
    derivatives: tuple[FmuVariable, ...]
    inputs: tuple[FmuVariable, ...]
    outputs: tuple[FmuVariable, ...]
    indicators: tuple[FmuVariable, ...]
    duration: float
    step: float

    @property
    def calculated(self) -> tuple[FmuVariable, ...]:
        """What an importer may ask for before a simulation begins."""
        return (*self.derivatives, *self.outputs)


def description_of(made: LineSystem) -> FmuDescription:
    """The variables of a line: states are deviations from uniform rotation; torques act on whatever has an inertia."""
    system, topology = made.system, made.assembly.topology
    line = made.assembly.line
    taken: set[str] = set()
    count = 0

    def add(name: str, unit: str, description: str, **more: object) -> FmuVariable:
        nonlocal count
        count += 1
        return FmuVariable(_free(name, taken), count, unit, description, **more)  # type: ignore[arg-type]

    size = topology.size
    start = made.rest()
    about = ["deviation from uniform rotation"] * size + ["how fast the deviation grows"] * size
    states = tuple(
        add(name, unit, what, start=float(x))
        for name, unit, what, x in zip(system.states, system.units, about, start, strict=True)
    )
    derivatives = tuple(
        add(f"der({one.name})", "rad/s" if k < size else "rad/s2", "derivative") for k, one in enumerate(states)
    )
    moved = [(s, name) for s, name in topology.points if topology.coordinate[topology.stations[s].group] >= 0]
    inputs = tuple(
        add(f"torque on {name}", "N.m", "from outside, in the sense of its excitations", start=0.0, place=s)
        for s, name in moved
    )
    outputs = tuple(
        add(f"{word} of {name}", unit, what, place=s, kind=kind)
        for s, name in topology.points
        for word, unit, what, kind in (
            ("deviation", "rad", "of its rotation from a uniform one", "ROTATION"),
            ("speed", "rad/s", "of its rotation", "TURNING"),
        )
    ) + tuple(
        add(f"{word} of {name}", unit, what, place=e, kind=kind)
        for e, name in enumerate(made.shafts)
        for word, unit, what, kind in (
            ("twist", "rad", "far end before near end", "TWIST"),
            ("torque", "N.m", "that it carries, positive with the twist", "CARRIED"),
        )
    )
    contacts = [one for one in staged_springs(made.assembly, made.assembly.table(1)[0]).values() if one.stages > 1]
    indicators = tuple(
        add(f"end {g + 1} of the stage of {one.name}", "rad", "event indicator, positive while the stage lasts")
        for one in contacts
        for g in range(GUARDS)
    )
    turn = 2 * np.pi / abs(made.speed)
    name = _plain(line.name or "driveline")
    return FmuDescription(
        name=name, identifier=_identifier(name), states=states, derivatives=derivatives, inputs=inputs,
        outputs=outputs, indicators=indicators, duration=TURNS * turn, step=turn / _POINTS_A_TURN,
    )  # fmt: skip


def _plain(text: str) -> str:
    """A text as XML holds it in one line."""
    return "".join(c if c.isprintable() else "?" for c in text)


def _free(name: str, taken: set[str]) -> str:
    """A name that no other variable has."""
    plain = _plain(name)
    own, k = plain, 2
    while own in taken:
        own, k = f"{plain} {k}", k + 1
    taken.add(own)
    return own


def _identifier(name: str) -> str:
    """A name of C and of files."""
    found = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")[:_LONGEST_NAME]
    return f"line_{found}" if not found or found[0].isdigit() else found


def model_description(described: FmuDescription, fmi: int, token: str, sources: Sequence[str]) -> str:
    """The text of modelDescription.xml."""
    root = Element("fmiModelDescription", fmiVersion=f"{fmi}.0", modelName=described.name)
    root.set("guid" if fmi == 2 else "instantiationToken", token)
    root.set("description", "Torsional vibration of a driveline: joints, loads, contacts")
    root.set("generationTool", f"Trunnion {__version__}")
    root.set("variableNamingConvention", "flat")
    if fmi == 2:
        root.set("numberOfEventIndicators", str(len(described.indicators)))
    for kind in ("ModelExchange", "CoSimulation"):
        one = SubElement(root, kind, modelIdentifier=described.identifier)
        if kind == "CoSimulation":
            one.set("canHandleVariableCommunicationStepSize", "true")
        state = "FMUstate" if fmi == 2 else "FMUState"
        one.set(f"canGetAndSet{state}", "true")
        one.set(f"canSerialize{state}", "true")
        if fmi == 2:
            held = SubElement(one, "SourceFiles")
            for name in sources:
                SubElement(held, "File", name=name)
    units = SubElement(root, "UnitDefinitions")
    for name, base in UNITS.items():
        SubElement(SubElement(units, "Unit", name=name), "BaseUnit", base)
    log = SubElement(root, "LogCategories")
    SubElement(log, "Category", name="logStatusError")
    SubElement(
        root, "DefaultExperiment", startTime="0", stopTime=repr(described.duration), tolerance="1e-6",
        stepSize=repr(described.step),
    )  # fmt: skip
    (_variables_of_2 if fmi == 2 else _variables_of_3)(root, described)
    return _text(root)


def _rows(described: FmuDescription) -> Iterable[tuple[str, FmuVariable]]:
    """Every variable and its causality, in the order of their references."""
    for one in (*described.states, *described.derivatives):
        yield "local", one
    for one in described.inputs:
        yield "input", one
    for one in described.outputs:
        yield "output", one
    for one in described.indicators:
        yield "local", one


def _variables_of_2(root: Element, described: FmuDescription) -> None:
    """Reference k is number k: there is no variable before it but the time, which FMI 2.0 does not want."""
    held = SubElement(root, "ModelVariables")
    for causality, one in _rows(described):
        if one in described.indicators:
            continue  # FMI 2.0 has no variables for them
        row = SubElement(held, "ScalarVariable", name=one.name, valueReference=str(one.reference))
        row.set("description", one.description)
        row.set("causality", causality)
        row.set("variability", "continuous")
        if causality != "input":
            row.set("initial", "calculated" if one.start is None else "exact")
        real = SubElement(row, "Real", unit=one.unit)
        if one.start is not None:
            real.set("start", repr(one.start))
        if one in described.derivatives:
            real.set("derivative", str(described.states[described.derivatives.index(one)].reference))
    structure = SubElement(root, "ModelStructure")
    for part, variables in (
        ("Outputs", described.outputs),
        ("Derivatives", described.derivatives),
        ("InitialUnknowns", described.calculated),
    ):
        group = SubElement(structure, part)
        for one in variables:
            SubElement(group, "Unknown", index=str(one.reference))


def _variables_of_3(root: Element, described: FmuDescription) -> None:
    held = SubElement(root, "ModelVariables")
    SubElement(
        held, "Float64", name="time", valueReference="0", causality="independent", variability="continuous", unit="s"
    )
    for causality, one in _rows(described):
        row = SubElement(held, "Float64", name=one.name, valueReference=str(one.reference))
        row.set("description", one.description)
        row.set("causality", causality)
        row.set("variability", "continuous")
        if causality != "input":
            row.set("initial", "calculated" if one.start is None else "exact")
        row.set("unit", one.unit)
        if one.start is not None:
            row.set("start", repr(one.start))
        if one in described.derivatives:
            row.set("derivative", str(described.states[described.derivatives.index(one)].reference))
    structure = SubElement(root, "ModelStructure")
    for part, variables in (
        ("Output", described.outputs),
        ("ContinuousStateDerivative", described.derivatives),
        ("InitialUnknown", described.calculated),
        ("EventIndicator", described.indicators),
    ):
        for one in variables:
            SubElement(structure, part, valueReference=str(one.reference))


def build_description(described: FmuDescription, source: str, language: str) -> str:
    """The text of sources/buildDescription.xml of FMI 3.0."""
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    build = SubElement(root, "BuildConfiguration", modelIdentifier=described.identifier)
    group = SubElement(build, "SourceFileSet", language=language)
    SubElement(group, "SourceFile", name=source)
    return _text(root)


def _text(root: Element) -> str:
    indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="unicode") + "\n"
