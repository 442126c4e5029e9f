"""A study that is read: quantities of the points of one design, wherever in the store they lie."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.quantities import RATIO, kind_of, parse
from trunnion.errors import InputError
from trunnion.results.counts import counted
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, internal, labelled
from trunnion.results.outcome import Outcome
from trunnion.results.quantity_axes import QuantityAxis
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Coordinate, Variable
from trunnion.studies.design import StudyAxis, StudyDesign, in_axes
from trunnion.studies.points import DONE, FAILED, MISSING
from trunnion.studies.quantities import StudyQuantity
from trunnion.studies.refinement import Refinement
from trunnion.studies.rounds import BoundarySearch, asked_of, known_points
from trunnion.studies.shards import array_names
from trunnion.studies.store import Store

MOST_REASONS = 8
"""Groups of failed points that are listed."""


@labelled
class Study(Result):
    """Points of a study along one axis, in the order of its design: the sampling plan slowest, the last parameter
    fastest. Points that are missing or failed are NaN, and ``status`` tells them."""

    analysis: str = attribute("that was asked at each point")
    store: str = attribute("folder that keeps it")
    points: int = attribute("in all")
    done: int = attribute("that are computed")
    failed: int = attribute("that could not be computed")
    version: str = attribute("of the package that computed it")
    design: StudyDesign = internal("the points")
    quantities: tuple[StudyQuantity, ...] = internal("that are kept")
    status: Any = internal("0 missing, 1 done, 2 failed", axes="point")
    values: Mapping[str, Any] = internal("quantities by path, as kept", axes="point")
    reasons: tuple[tuple[str, int], ...] = internal("why points failed, and how many")
    ended: str = internal("what ended the run before all was done, as a clause", default="")
    failures: Mapping[int, str] = internal("why points failed, by their number", default_factory=dict)
    unit: str = internal("of speeds in print", default="rad/s")
    refinement: Refinement | None = internal("the boundary that was looked for", default=None)
    first: StudyDesign | None = internal("its first grid", default=None)

    def plot(
        self, axes: Axes | None = None, *, kind: str = "", quantity: str = "", x: str = "", y: str = "",
        at: Mapping[str, float] | None = None,
    ) -> Axes:  # fmt: skip
        """A chart, slices, a histogram or parallel coordinates of a quantity; see ``pictures.studies.study``."""
        return drawing(self, "plot")(self, axes, kind=kind, quantity=quantity, x=x, y=y, at=at)

    @property
    def missing(self) -> int:
        """Points that are not computed."""
        return self.points - self.done - self.failed

    @property
    def outcome(self) -> Outcome:
        """Whether all points are done, or what ended it before."""
        if not self.missing and self.ended:
            return Outcome(False, "ended early", self.ended)
        if not self.missing:
            return Outcome(True, "whole", "every point was computed")
        why = f"{self.ended}: " if self.ended else ""
        return Outcome(False, "ended early", f"{why}{self.missing} of {self.points} points are missing")

    def parameter(self, path: str) -> Array:
        """Values (points,) of a parameter, SI units.

        Raises
        ------
        InputError : it was not varied.
        """
        return self._columns[:, self.design.paths.index(self._known(path, self.design.paths, "parameter"))]

    def quantity(self, path: str) -> Any:
        """Values (points,) of a quantity: numbers, codes of verdicts, or words.

        Raises
        ------
        InputError : it was not kept.
        """
        one = self._quantity(path)
        return one.shown(self.values[path]) if one.kind == "word" else self.values[path]

    def grid(self, path: str) -> Any:
        """The same in the shape of the design: (rows of the sampling plan,) parameters in order.

        Raises
        ------
        InputError : the points stand about a boundary, not on a grid.
        """
        if self.refinement is not None:
            raise InputError("stands about a boundary, on no grid", key=path, remedy="take study_boundary(study)")
        return np.asarray(self.quantity(path)).reshape(self.design.shape)

    def axis(self, path: str) -> StudyAxis:
        """A parameter with a grid or stated values.

        Raises
        ------
        InputError : there is none of that name.
        """
        self._known(path, [one.path for one in self.design.axes], "parameter with a grid")
        return next(one for one in self.design.axes if one.path == path)

    def values_at(self, stated: Mapping[str, float | str]) -> dict[str, float]:
        """Values of parameters that are stated as numbers in SI units or as texts, in SI units.

        Raises
        ------
        InputError : an unknown parameter, or a value that is none of its kind.
        """
        units = dict(zip(self.design.paths, self.design.units, strict=True))
        found = {}
        for path, value in stated.items():
            self._known(path, self.design.paths, "parameter")
            try:
                found[path] = parse(value, kind_of(units[path]) or RATIO)
            except InputError as error:
                raise error.but(element=path, key="at", value=value) from None
        return found

    def _known(self, path: str, known: Any, what: str) -> str:
        from trunnion.driveline.refusals import nearest

        if path not in known:
            raise InputError(f"is not a {what} of the study", key=path, remedy=nearest(path, known))
        return path

    def _quantity(self, path: str) -> StudyQuantity:
        self._known(path, [one.path for one in self.quantities], "quantity")
        return next(one for one in self.quantities if one.path == path)

    @property
    def _columns(self) -> Array:
        found = vars(self).get("_values_of_points")
        if found is None:
            found = vars(self)["_values_of_points"] = self.design.values(np.arange(self.points))
        return np.asarray(found)

    def declared(self) -> Iterator[Variable | Attribute]:
        """Parameters and quantities along the points, and the status."""
        names = array_names([*self.design.paths, *(one.path for one in self.quantities)])
        for k, (name, unit) in enumerate(zip(names, self.design.units, strict=False)):
            yield Coordinate(name, self._columns[:, k], "point", unit, self.design.paths[k])
        for name, one in zip(names[len(self.design.paths) :], self.quantities, strict=True):
            more: dict[str, Any] = {}
            if one.codes:
                meanings = " ".join(meaning.replace(" ", "_") for meaning in one.meanings)
                more = {"flag_values": np.array(one.codes, dtype=float), "flag_meanings": meanings}
            yield Variable(name, self.quantity(one.path), "point", one.unit, one.path, more)
        codes = np.array([MISSING, DONE, FAILED], dtype=np.uint8)
        yield Variable(
            "status", self.status, "point", "", "", {"flag_values": codes, "flag_meanings": "missing done failed"}
        )
        yield from super().declared()

    def quantity_axis(self, one: StudyQuantity) -> QuantityAxis:
        """How a quantity reads, on axes and in sentences: speeds in the line's unit, frequencies in Hz beside rpm."""
        named = one.path.rpartition(".")[2]
        words = self.words.of_frequencies if "frequency" in named else self.words
        return words.parameter(one.path, one.unit or "1")

    def _lines(self) -> Iterator[str]:
        shape = self.first.shape if self.first else self.design.shape
        about = " and about a boundary" if self.refinement else ""
        where = f"{counted(self.points, 'point')}{in_axes(shape)}{about}"
        yield f"{self.analysis} at {where}: {self.done} done, {self.failed} failed"
        if self.missing or self.ended:
            yield f"  {self.outcome}"
        for path, unit, low, high in self._ranges():
            words = self.words.parameter(path, unit)
            yield f"  over {path} from {words.number(low, 4)} to {words.number(high, 4)}"
        for one in self.quantities:
            yield f"  {one.path}: {self._summary(one)}"
        for sentence, count in self.reasons[:MOST_REASONS]:
            yield f"  failed at {count}: {sentence}"
        if len(self.reasons) > MOST_REASONS:
            yield f"  and for {len(self.reasons) - MOST_REASONS} other reasons"

    def _ranges(self) -> Iterator[tuple[str, str, float, float]]:
        if self.design.sampling:
            for scattering in self.design.sampling.scattering:
                yield scattering.path, scattering.unit, scattering.low, scattering.high
        for axis in self.design.axes:
            yield axis.path, axis.unit, float(axis.values.min()), float(axis.values.max())

    def _summary(self, one: StudyQuantity) -> str:
        done = self.status == DONE
        if not done.any():
            return "nothing known"
        values = self.values[one.path][done]
        if one.kind == "number":
            known = values[np.isfinite(values)]
            if not len(known):
                return "not finite anywhere"
            low, middle, high = np.quantile(known, [0.0, 0.5, 1.0])
            axis = self.quantity_axis(one)
            least, half, most = (axis.number(value, 4) for value in (low, middle, high))
            return f"{least} at all of them" if least == most else f"{least} to {most}, half of them below {half}"
        words, counts = np.unique(one.shown(values), return_counts=True)
        order = np.argsort(-counts, kind="stable")
        said = [f"{words[k] or 'none'} at {counts[k]}" for k in order[:6]]
        return ", ".join([*said, *(["…"] if len(order) > 6 else [])])


def read_study(store: str | os.PathLike[str]) -> Study:
    """Read what a study has kept: the points that were asked for last, also while the store grows.

    Parameters
    ----------
    store : the folder that ``study`` wrote ("truck.zarr").

    Returns
    -------
    Study: the points with their quantities; ``missing`` counts those that are not there yet.

    Raises
    ------
    InputError : there is no store.
    ComputationError : a file of it is damaged.

    Examples
    --------
    >>> import trunnion as tn
    >>> from pathlib import Path
    >>> from tempfile import mkdtemp
    >>> store = str(Path(mkdtemp()) / "angles.zarr")
    >>> angle = {"path": "HookeJoint 1.angle", "low": "0 deg", "high": "30 deg", "points": 4}
    >>> asked = {"line": "two-shaft-cardan", "analysis": "stability", "quantities": "verdict", "store": store}
    >>> found = tn.study({**asked, "arguments": {"speed": 1.6}, "parameter": [angle]}, workers=0)
    >>> tn.read_study(store)
    <Study: stability at 4 points: 4 done, 0 failed>
    """
    return read(store)


def read(
    store: str | os.PathLike[str] | Store, design: StudyDesign | None = None, ended: str = "",
    search: BoundarySearch | None = None,
) -> Study:  # fmt: skip
    """Read the points of a design, or of a ``search`` for a boundary; by default what the store was asked for last.

    Raises
    ------
    InputError : there is no store.
    ComputationError : a file of it is damaged.
    """
    opened = store if isinstance(store, Store) else Store.open(Path(store))
    refinement, grid = (search.refinement, search.first) if search else (None, None)
    if search:
        asked = known_points(opened, search.lattice)
    elif design is not None:
        asked = design
    else:
        asked, refinement, grid = asked_of(opened)
    quantities = opened.question.quantities
    status = np.zeros(asked.size, dtype=np.uint8)
    values = {one.path: one.empty(asked.size) for one in quantities}
    failures: dict[int, str] = {}
    for part in opened.parts:
        same = part.design.key == asked.key
        for first, last, found in opened.stretches(part):
            if found is None:
                continue
            numbers = part.numbers(first, last)
            places = numbers if same else asked.places(part.design, numbers)
            here = places >= 0
            status[places[here]] = found.status[here]
            for path, column in found.values.items():
                values[path][places[here]] = column[here]
            for row, sentence in found.sentences.items():
                if places[row] >= 0:
                    failures[int(places[row])] = sentence
    counts: dict[str, int] = {}
    for sentence in failures.values():
        counts[sentence] = counts.get(sentence, 0) + 1
    return Study(
        analysis=opened.question.analysis, store=str(opened.path), points=asked.size,
        done=int((status == DONE).sum()), failed=int((status == FAILED).sum()),
        version=str(opened.about["computed_by"]["trunnion"]), design=asked, quantities=quantities, status=status,
        values=values, reasons=tuple(sorted(counts.items(), key=lambda one: -one[1])), ended=ended,
        failures=dict(sorted(failures.items())), unit=speed_unit(opened.question.line), refinement=refinement,
        first=grid if refinement else None,
    )  # fmt: skip
