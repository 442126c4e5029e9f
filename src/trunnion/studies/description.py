"""What a study file states: a line, an analysis, quantities of its result, parameters, and where they are kept.

::

    line = "truck.toml"               # or a name of the catalogue
    analysis = "stability"
    quantities = ["growth_rate", "verdict"]
    store = "truck.zarr"

    [arguments]                       # of the analysis
    speed = "1500 rpm"

    [[parameter]]                     # a grid
    path = "joint 1.angle"
    low = "0 deg"
    high = "15 deg"
    points = 50                       # log = true: even in the logarithm

    [[parameter]]                     # stated values
    path = "Shaft 1.stiffness"
    values = ["10 kN*m/rad", "12 kN*m/rad"]

    [[parameter]]                     # sampled: between two ends, or by a tolerance
    path = "Shaft 2.stiffness"
    tolerance = "5 %"

    [sampling]
    method = "sobol"                  # or "latin"; "saltelli" for Sobol indices
    points = 1024

    [boundary]                        # further points only where the answer changes
    quantity = "verdict"
    value = "unstable"                # of a number instead: level = 0.0
    halvings = 4                      # of the cells of the grids that the boundary passes

``tolerances = true`` samples every number that the line's own [[tolerance]] tables let scatter.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from pydantic import model_validator

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.files import load
from trunnion.driveline.parameters import SPEED
from trunnion.driveline.quantities import RATIO, kind_of, parse
from trunnion.driveline.record import Record, listed
from trunnion.driveline.refusals import nearest
from trunnion.driveline.tolerances import Tolerance
from trunnion.driveline.toml_file import read_text, toml_of
from trunnion.equations.coefficients import assemble
from trunnion.errors import InputError
from trunnion.floquet.tolerance.spread import read_tolerances
from trunnion.studies.design import LARGEST, METHODS, MOST_LATIN, Sampling, Scattering, StudyAxis, StudyDesign
from trunnion.studies.points import StudyQuestion, question_of, require_analysis
from trunnion.studies.quantities import StudyQuantity
from trunnion.studies.refinement import Lattice, Refinement

MOST_HALVINGS = 20
OF_RADIUS = 1e-8
"""What the error of a spectral radius may be that the batch computes, and of a growth rate over the speed."""
MOST_REFINED = 6
"""Grids that a boundary is followed over."""
MOST_ALONG = 1 << 20
"""Points of the finest grid along an axis."""
MOST_NUMBERED = 1 << 62
"""Points of the finest grid, of which few are computed."""
MOST_VALUES = 1 << 24
"""Values of one parameter."""
MOST_POINTS = 1 << 40
"""Points of a study."""
BLOCKS = {"stability": 1024, "natural_frequencies": 1024, "resonance_speeds": 256, "kinetostatics": 256}
"""Points of a block, by what is called for each; of those not named ``BLOCK``."""
BLOCK, BATCH = 16, 1 << 14
"""Points of a block that are called one by one, and of one that the compiled batch does at once."""


class StudyParameter(Record):
    """One parameter of a study: a grid, stated values, or sampled.

    Parameters
    ----------
    path : of a number of the line, as in charts ("HookeJoint 1.angle", "factor of Shaft *.stiffness"), or "speed".
    low, high : ends, numbers in SI units or texts with a unit.
    points : of a grid between them; sampled without it.
    log : whether the grid is even in the logarithm.
    values : instead, all values that it takes.
    tolerance : instead, how it scatters: as in a [[tolerance]] of the line, "5 %" say.
    """

    what: ClassVar[str] = "parameter"
    example: ClassVar[str] = 'path = "HookeJoint 1.angle", low = "0 deg", high = "15 deg" and points = 50'

    path: str
    low: Any = None
    high: Any = None
    points: Any = None
    log: bool = False
    values: Any = None
    tolerance: Any = None

    @model_validator(mode="after")
    def _one_way(self) -> StudyParameter:
        ways = [self.values is not None, self.tolerance is not None, self.low is not None or self.high is not None]
        if sum(ways) != 1:
            raise InputError("needs low and high, or values, or a tolerance", element=self.what, key=self.path,
                             remedy=f"write {self.example}")  # fmt: skip
        if (self.low is None) != (self.high is None):
            key = "low" if self.low is None else "high"
            raise InputError("is missing", element=f"parameter {self.path}", key=key, remedy=f"write {self.example}")
        if self.points is not None and self.low is None:
            raise InputError("belong to a grid", element=f"parameter {self.path}", key="points", value=self.points,
                             remedy="give low and high")  # fmt: skip
        return self

    @property
    def sampled(self) -> bool:
        """Whether a sampling plan says its values."""
        return self.tolerance is not None or (self.low is not None and self.points is None)


class StudySampling(Record):
    """How parameters without a grid are sampled.

    Parameters
    ----------
    method : "sobol" (scrambled, continues when more points are asked for), "latin" (a Latin hypercube, which does not),
        "saltelli" (for Sobol indices; points × (parameters + 2) lines).
    points : of the sequence.
    seed : of the random numbers.
    """

    what: ClassVar[str] = "sampling"
    example: ClassVar[str] = 'method = "sobol" and points = 1024'

    method: str = "sobol"
    points: Any
    seed: Any = 0

    @model_validator(mode="after")
    def _known(self) -> StudySampling:
        if self.method not in METHODS:
            raise InputError("is not a sampling", element=self.what, key="method", value=self.method,
                             remedy=nearest(self.method, METHODS))  # fmt: skip
        _whole(self.points, "points", 1, MOST_LATIN if self.method == "latin" else LARGEST, self.what)
        _whole(self.seed, "seed", 0, 1 << 32, self.what)
        if self.method == "saltelli" and self.points & (self.points - 1):
            remedy = f"write {1 << self.points.bit_length()}"
            raise InputError("must be a power of two for Sobol indices", element=self.what, key="points",
                             value=self.points, remedy=remedy)  # fmt: skip
        return self


class StudyBoundarySearch(Record):
    """Where the points go beyond the first grid: to the boundary at which an answer changes.

    Parameters
    ----------
    quantity : one of the study's, a number, a word or a verdict.
    level : of a number: the boundary is where it rises above this; 0 by default.
    noise : of a number: by how much it has to rise above the level, so that rounding about it is no boundary; by
        default 1e-8 for the spectral radius of ``stability``, as much of the speed for its growth rate, else nothing.
    value : of a word or verdict: the boundary is between the points that have it and those that do not.
    halvings : of each cell of the grids that the boundary passes.
    most : points in all; the search ends before a halving that would need more.
    """

    what: ClassVar[str] = "boundary"
    example: ClassVar[str] = 'quantity = "verdict", value = "unstable" and halvings = 4'

    quantity: str
    level: Any = None
    noise: Any = None
    value: Any = None
    halvings: Any = 4
    most: Any = 1_000_000

    @model_validator(mode="after")
    def _whole(self) -> StudyBoundarySearch:
        _whole(self.halvings, "halvings", 1, MOST_HALVINGS, self.what)
        _whole(self.most, "most", 1, LARGEST, self.what)
        return self


class StudyDescription(Record):
    """A study as its file states it; see the module."""

    what: ClassVar[str] = "study"
    example: ClassVar[str] = (
        'line = "truck.toml", analysis = "stability", quantities = ["growth_rate"] and store = "truck.zarr"'
    )

    line: str
    analysis: str
    quantities: tuple[str, ...]
    store: str
    arguments: dict[str, Any] = {}
    parameter: tuple[StudyParameter, ...] = ()
    sampling: StudySampling | None = None
    tolerances: bool = False
    block: Any = None
    boundary: StudyBoundarySearch | None = None

    def __init__(self, **data: Any) -> None:
        if isinstance(data.get("quantities"), str):
            data["quantities"] = [data["quantities"]]
        if "parameter" in data:
            data["parameter"] = listed(StudyParameter, "parameter")(data["parameter"])
        if isinstance(data.get("sampling"), dict):
            data["sampling"] = StudySampling(**data["sampling"])
        if isinstance(data.get("boundary"), dict):
            data["boundary"] = StudyBoundarySearch(**data["boundary"])
        super().__init__(**data)


@dataclass(frozen=True)
class StudyPlan:
    """A study that is read against its line: what is asked, at which points, in blocks of how many, and where kept;
    and the boundary that further points look for."""

    question: StudyQuestion
    design: StudyDesign
    block: int
    store: Path
    source: str
    refinement: Refinement | None = None


def read_description(path: str | os.PathLike[str]) -> tuple[StudyDescription, Path]:
    """The description in a file, and the folder that its paths start from.

    Raises
    ------
    InputError : the file cannot be read, or describes no study.
    """
    text = read_text(Path(path), "see docs/studies.md for one to start from")
    try:
        return StudyDescription(**toml_of(text)), Path(path).parent
    except InputError as error:
        raise error.each(lambda one: one.but(element=f"{Path(path).name}: {one.element or 'study'}")) from None


def plan_of(
    stated: StudyDescription, folder: Path, line: Driveline | None = None, source: str = "", *,
    tables_anywhere: bool = False,
) -> StudyPlan:  # fmt: skip
    """Read a study against its line, which a few points are computed of.

    Raises
    ------
    InputError : an unknown parameter, analysis, argument or quantity; nothing to vary; what no line can have.
    """
    line = line or _line(stated.line, folder, tables_anywhere)
    speed_varies = any(one.path == SPEED for one in stated.parameter)
    require_analysis(stated.analysis, stated.arguments, speed_varies)
    if not stated.quantities:
        raise InputError("are missing", element="study", key="quantities", remedy='write quantities = ["verdict"]')
    if len(set(stated.quantities)) < len(stated.quantities):
        raise InputError("names one twice", element="study", key="quantities", value=list(stated.quantities),
                         remedy="leave one out")  # fmt: skip
    bare = StudyQuestion("", stated.analysis, stated.arguments, ())
    vars(bare)["line"] = line
    design = _design(stated, line, bare)
    question = question_of(line, stated.analysis, stated.arguments, stated.quantities, design.paths, _tried(design))
    _require_possible(question, design)
    refinement = _refinement(stated.boundary, question, design) if stated.boundary else None
    return StudyPlan(question, design, _block(stated, question), folder / stated.store, source, refinement)


def _line(stated: str, folder: Path, tables_anywhere: bool) -> Driveline:
    """The line of a file, or of the catalogue where no such file exists."""
    path = folder / stated
    if path.exists() or Path(stated).suffix or len(Path(stated).parts) != 1:
        return load(path, tables_anywhere=tables_anywhere)
    import trunnion  # whose catalogue stands above

    try:
        line = trunnion.catalogue(stated)
    except InputError as error:
        raise InputError("is neither a file nor a name of the catalogue", element="study", key="line", value=stated,
                         remedy=error.remedy) from None  # fmt: skip
    if not isinstance(line, Driveline):
        raise InputError("is not a driveline but equations of motion", element="study", key="line", value=stated,
                         remedy="name a driveline: two-shaft-cardan, say")  # fmt: skip
    return line


def _design(stated: StudyDescription, line: Driveline, question: StudyQuestion) -> StudyDesign:
    axes, spreads, taken = [], dict[str, object](), dict[str, str]()
    if stated.tolerances:
        if not line.tolerances_by_path:
            raise InputError("asks for tolerances, and the line states none", element="study", key="tolerances",
                             value=True, remedy="write [[tolerance]] in the line")  # fmt: skip
        spreads |= line.tolerances_by_path
    assembly = assemble(line)
    for one in stated.parameter:
        columns = assembly.packed.resolve_axis(one.path)
        for label in (assembly.packed.labels[c] for c in columns.index.tolist()):
            if label in taken or (label in spreads and stated.tolerances):
                raise InputError(f"varies {label}, as {taken.get(label, 'its tolerance')} does", element="parameter",
                                 key="path", value=one.path, remedy="vary it once")  # fmt: skip
            taken[label] = one.path
        nominal = question.speed if one.path == SPEED else assembly.packed.value(one.path)
        if one.sampled:
            if one.path == SPEED:
                raise InputError("is not a number of the line that scatters", element="parameter", key="path",
                                 value=SPEED, remedy="give points or values")  # fmt: skip
            spreads[one.path] = _scatter(one, columns.unit)
        elif one.values is not None:
            axes.append(StudyAxis(one.path, columns.unit, nominal, _values(one, columns.unit)))
        else:
            axes.append(_grid(one, columns.unit, nominal))
    if spreads and stated.sampling is None:
        raise InputError("is missing", element="study", key="sampling",
                         remedy='write [sampling] with points = 1024, or give a grid points')  # fmt: skip
    if stated.sampling and not spreads:
        raise InputError("has no parameter to sample", element="study", key="sampling",
                         remedy="leave it out, or leave out the points of a parameter")  # fmt: skip
    plan = None
    if stated.sampling:
        scattering = tuple(
            Scattering(s.label, s.unit, s.nominal, s.low, s.high, s.deviation)
            for s in read_tolerances(assembly, spreads)
        )
        sampling = stated.sampling
        plan = Sampling(sampling.method, sampling.points, sampling.seed, scattering)
    made = StudyDesign(tuple(axes), plan)
    if not made.paths or made.size == 0:
        raise InputError(
            "is empty", element="study", key="parameter", remedy=f"write [[parameter]] with {StudyParameter.example}"
        )
    if made.size > MOST_POINTS:
        raise InputError(f"asks for {made.size:.3g} points, more than {MOST_POINTS:.3g}", element="study",
                         key="parameter", remedy="take fewer points, or sample")  # fmt: skip
    return made


def _scatter(one: StudyParameter, unit: str) -> object:
    if one.tolerance is None:
        low, high = _number(one, "low", one.low, unit), _number(one, "high", one.high, unit)
        _require_rise(one, low, high)
        return ("range", low, high)
    owner, _, key = one.path.rpartition(".")
    try:
        scatter = Tolerance(of=owner.removeprefix("factor of "), **{key: one.tolerance}).scatters[0]
    except InputError as error:
        raise error.but(element=f"parameter {one.path}", key="tolerance") from None
    if scatter.form == "within":
        raise InputError("must be a share, a range or a deviation here", element=f"parameter {one.path}",
                         key="tolerance", value=one.tolerance, remedy='write "5 %", or low and high')  # fmt: skip
    return scatter.given(0.0)


def _grid(one: StudyParameter, unit: str, nominal: float) -> StudyAxis:
    where = f"parameter {one.path}"
    points = _whole(one.points, "points", 1, MOST_VALUES, where)
    low, high = _number(one, "low", one.low, unit), _number(one, "high", one.high, unit)
    if points > 1:
        _require_rise(one, low, high)
    if one.log and low <= 0:
        raise InputError("must be positive on a logarithmic grid", element=where, key="low", value=one.low,
                         remedy="leave out log")  # fmt: skip
    return StudyAxis.of_grid(one.path, unit, nominal, low, high, points, one.log)


def _require_rise(one: StudyParameter, low: float, high: float) -> None:
    if not low < high:
        raise InputError("must be above low", element=f"parameter {one.path}", key="high", value=one.high,
                         remedy="exchange the two")  # fmt: skip


def _values(one: StudyParameter, unit: str) -> Array:
    stated = one.values
    if not isinstance(stated, list | tuple | np.ndarray):
        raise InputError("is not a list", element=f"parameter {one.path}", key="values", value=stated,
                         remedy="write values = [1.0, 2.0], say")  # fmt: skip
    if not len(stated):
        raise InputError("is empty", element=f"parameter {one.path}", key="values", remedy="give one value or more")
    values = np.array([_number(one, "values", value, unit) for value in stated])
    if len(np.unique(values)) < len(values):
        raise InputError("names one value twice", element=f"parameter {one.path}", key="values",
                         remedy="leave one out")  # fmt: skip
    return values


def _number(one: StudyParameter, key: str, value: object, unit: str) -> float:
    try:
        return parse(value, kind_of(unit) or RATIO)
    except InputError as error:
        raise error.but(element=f"parameter {one.path}", key=key, value=value) from None


def _whole(value: object, key: str, least: int, most: int, element: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise InputError(f"must be a whole number from {least} to {most}", element=element, key=key, value=value,
                         remedy=f"write {key} = {max(least, 50)}")  # fmt: skip
    return value


def _tried(design: StudyDesign) -> Array:
    """A few points, at which it is seen what the quantities are: the middle one, the ends, and between."""
    size = design.size
    numbers = np.unique(np.array([size // 2, 0, size - 1, size // 4, 3 * size // 4, size // 3]))
    values = {int(k): design.values(np.array([k]))[0] for k in numbers}
    return np.array([values[size // 2], *(value for k, value in values.items() if k != size // 2)])


def _require_possible(question: StudyQuestion, design: StudyDesign) -> None:
    """Refuse ends that the line cannot have where the batch would never ask it."""
    if not question.batched:
        return
    packed = question.assembly.packed
    for axis in design.axes:
        columns = packed.resolve_axis(axis.path)
        if axis.path == SPEED:
            if axis.values.min() <= 0:
                raise InputError("must be positive", element="parameter", key=SPEED, value=float(axis.values.min()),
                                 remedy='low = "300 rpm", say')  # fmt: skip
            continue
        for end in (float(axis.values.min()), float(axis.values.max())):
            table = packed.table(1)
            columns.put(table, end)
            try:
                packed.line_at(table[0])
            except InputError as error:
                problem = f"would reach {end:.6g}, which no line can have ({error.problems[0].problem})"
                raise InputError(problem, element="parameter", key=axis.path, remedy="narrow its range") from None


def _refinement(asked: StudyBoundarySearch, question: StudyQuestion, design: StudyDesign) -> Refinement:
    """The boundary that is looked for."""
    element, known = "boundary", [one.path for one in question.quantities]
    if asked.quantity not in known:
        raise InputError("is not a quantity of the study", element=element, key="quantity", value=asked.quantity,
                         remedy=nearest(asked.quantity, known))  # fmt: skip
    one = question.quantities[known.index(asked.quantity)]
    _require_grids(asked, design)
    if one.kind == "number":
        return _of_number(asked, one, _rounding(one, question, design))
    for key in ("level", "noise"):
        if getattr(asked, key) is not None:
            raise InputError(f"belongs to a number, and {one.path} is not one", element=element, key=key,
                             value=getattr(asked, key), remedy='write value = "unstable", say')  # fmt: skip
    words = [word for word in one.meanings if word]
    value = asked.value if asked.value is not None else "yes" if words == ["no", "yes"] else None
    if not isinstance(value, str):
        remedy = f'write value = "{"unstable" if "unstable" in words or not words else words[-1]}"'
        raise InputError("is missing" if value is None else "is not a word", element=element, key="value", value=value,
                         remedy=remedy)  # fmt: skip
    if words and value not in words:
        raise InputError(f"is nothing that {one.path} can be", element=element, key="value", value=value,
                         remedy=nearest(value, words))  # fmt: skip
    return Refinement(one.path, asked.halvings, asked.most, value=value)


def _rounding(one: StudyQuantity, question: StudyQuestion, design: StudyDesign) -> float:
    """By how much a number may be over its level by rounding alone, where that is known: the growth of lines without
    damping is 0, and comes out as some 1e-12 of the speed."""
    if question.analysis != "stability" or one.path not in ("growth_rate", "spectral_radius"):
        return 0.0
    if one.path == "spectral_radius":
        return OF_RADIUS
    speeds = [float(axis.values.max()) for axis in design.axes if axis.path == SPEED] or [question.speed]
    return OF_RADIUS * speeds[0] if np.isfinite(speeds[0]) else 0.0


def _of_number(asked: StudyBoundarySearch, one: StudyQuantity, rounding: float) -> Refinement:
    if asked.value is not None:
        raise InputError(f"belongs to words and verdicts, and {one.path} is a number", element="boundary", key="value",
                         value=asked.value, remedy="write level = 0.0, say")  # fmt: skip
    found = []
    for key in ("level", "noise"):
        stated = getattr(asked, key)
        try:
            usual = {"level": 0.0, "noise": rounding}[key]
            found.append(usual if stated is None else parse(stated, kind_of(one.unit) or RATIO))
        except InputError as error:
            raise error.but(element="boundary", key=key, value=stated) from None
    level, noise = found
    if noise < 0:
        raise InputError("must not be negative", element="boundary", key="noise", value=asked.noise,
                         remedy="leave it out")  # fmt: skip
    return Refinement(one.path, asked.halvings, asked.most, level, noise)


def _require_grids(asked: StudyBoundarySearch, design: StudyDesign) -> None:
    """Refuse what has no cells to halve, or too many."""
    lattice = Lattice(design, asked.halvings)
    refined = int(lattice.refined.sum())
    if not refined:
        raise InputError("has no grid to refine", element="boundary", key="quantity", value=asked.quantity,
                         remedy="give a parameter low, high and 2 points or more")  # fmt: skip
    if refined > MOST_REFINED:
        raise InputError(f"goes through {refined} grids, more than {MOST_REFINED}", element="boundary", key="quantity",
                         value=asked.quantity, remedy="give values or 1 point of some")  # fmt: skip
    counts = [int(count) for count in lattice.counts(asked.halvings)]
    if max(counts) > MOST_ALONG or int(np.prod(counts, dtype=object)) > MOST_NUMBERED:
        raise InputError("make a grid too fine to count its points", element="boundary", key="halvings",
                         value=asked.halvings, remedy="take fewer")  # fmt: skip


def _block(stated: StudyDescription, question: StudyQuestion) -> int:
    if stated.block is not None:
        return _whole(stated.block, "block", 1, 1 << 20, "study")
    return BATCH if question.batched else BLOCKS.get(question.analysis, BLOCK)


def as_description(stated: Mapping[str, Any]) -> StudyDescription:
    """A description from a table, as of a file."""
    return StudyDescription(**stated)
