"""What a point is: numbers of a line, one analysis with its arguments, and the quantities that are kept of its result.

Of many points at once growth rate and verdict come from the compiled batch of ``tolerance_study``; everything else is
one call a point. Which of the two follows from what is asked, never from how long it takes.
"""

from __future__ import annotations

import hashlib
import inspect
import json
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.files import dumps, loads
from trunnion.driveline.operating_speed import known_speed
from trunnion.driveline.parameters import SPEED, Columns
from trunnion.driveline.refusals import nearest
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.errors import ComputationError, InputError, TrunnionError, short
from trunnion.floquet.tolerance.many_lines import UNKNOWN, ManyLines
from trunnion.numerics.versions import computed_by
from trunnion.registry import ANALYSES
from trunnion.results.verdict import Verdict
from trunnion.studies.quantities import StudyQuantity, followed

MISSING, DONE, FAILED = 0, 1, 2
"""What is known of a point."""
BATCHED = {"growth_rate", "verdict", "spectral_radius", "error_estimate"}
"""Quantities of ``stability`` that the compiled batch gives."""
BATCH_TOLERANCE = 1e-8
"""Error that the batch asks of its matrices."""
LONGEST_SENTENCE = 300


@dataclass(frozen=True)
class Evaluated:
    """What came of some points: status (points,), values by quantity, and sentences of those that failed."""

    status: Any
    values: dict[str, Any]
    sentences: dict[int, str]


@dataclass(frozen=True)
class StudyQuestion:
    """One analysis of one line, and the quantities of its result; ``paths`` are the parameters, in order."""

    line_text: str
    analysis: str
    arguments: Mapping[str, Any]
    quantities: tuple[StudyQuantity, ...]

    @cached_property
    def line(self) -> Driveline:
        """As stated."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return loads(self.line_text)

    @cached_property
    def assembly(self) -> Assembly:
        """Of the line."""
        return assemble(self.line)

    @cached_property
    def speed(self) -> float:
        """At which points are judged that have no speed of their own [rad/s]; NaN where nothing says it."""
        stated = self.arguments.get("speed")
        if isinstance(stated, str):
            from trunnion.driveline.operating_speed import operating_speed

            return operating_speed(self.line, stated)
        if stated is not None:
            return float(stated)
        found = known_speed(self.line)
        return float("nan") if found is None else found

    @property
    def content(self) -> dict[str, Any]:
        """As JSON keeps it."""
        return {
            "line": self.line_text,
            "analysis": self.analysis,
            "arguments": dict(self.arguments),
            "quantities": [one.content for one in self.quantities],
        }

    @classmethod
    def of_content(cls, content: Mapping[str, Any]) -> StudyQuestion:
        """What ``content`` says."""
        quantities = tuple(map(StudyQuantity.of_content, content["quantities"]))
        return cls(content["line"], content["analysis"], content["arguments"], quantities)

    @cached_property
    def identity(self) -> str:
        """A word for line, analysis, arguments, quantities and version: what one store has one of."""
        whole = json.dumps([self.content, computed_by()], sort_keys=True)
        return hashlib.sha256(whole.encode()).hexdigest()[:32]

    @cached_property
    def batched(self) -> bool:
        """Whether the compiled batch answers for many points at once."""
        if self.analysis != "stability" or not {q.path for q in self.quantities} <= BATCHED:
            return False
        if set(self.arguments) - {"speed", "statically_twisted"}:
            return False
        if not self.speed > 0 and not np.isnan(self.speed):
            return False
        try:
            table = self.assembly.table(1, self.speed if self.speed > 0 else 1.0)
            ManyLines.of(self.assembly, table, self._twisted, 1)
        except TrunnionError:
            return False
        return True

    @property
    def _twisted(self) -> bool:
        return bool(self.arguments.get("statically_twisted", True))

    def columns(self, paths: tuple[str, ...]) -> tuple[Columns, ...]:
        """Where the values of parameters go."""
        return tuple(self.assembly.packed.resolve_axis(path) for path in paths)

    def table(self, paths: tuple[str, ...], values: Array) -> Array:
        """Numbers of lines (points, columns) at values (points, parameters)."""
        table = self.assembly.table(len(values), self.speed)
        for column, value in zip(self.columns(paths), values.T, strict=True):
            column.put(table, value)
        return np.asarray(table)

    def evaluated(self, paths: tuple[str, ...], values: Array) -> Evaluated:
        """What comes of points at values (points, parameters)."""
        if self.batched:
            return self._by_batch(paths, values)
        return self._by_calls(paths, values, np.arange(len(values)), self._room(len(values)))

    def _room(self, points: int) -> Evaluated:
        empty = {one.path: one.empty(points) for one in self.quantities}
        return Evaluated(np.zeros(points, dtype=np.uint8), empty, {})

    def _by_batch(self, paths: tuple[str, ...], values: Array) -> Evaluated:
        """By the batch; what it does not tell is asked one by one."""
        room = self._room(len(values))
        table = self.table(paths, values)
        lines = ManyLines(self.assembly, self._twisted, 1)
        found = lines.judged(table, BATCH_TOLERANCE)
        known = (found.error <= UNKNOWN) & (found.verdict != Verdict.FAILED) & np.isfinite(found.radius)
        with np.errstate(divide="ignore", invalid="ignore"):
            growth = np.log(found.radius) / lines.period * table[:, 0]
        known &= np.isfinite(growth)
        whole = {
            "growth_rate": growth,
            "verdict": found.verdict.astype(float),
            "spectral_radius": found.radius,
            "error_estimate": found.error,
        }
        for one in self.quantities:
            room.values[one.path][known] = whole[one.path][known]
        room.status[known] = DONE
        return self._by_calls(paths, values, np.flatnonzero(~known), room)

    def _by_calls(self, paths: tuple[str, ...], values: Array, places: Any, room: Evaluated) -> Evaluated:
        for place in places.tolist():
            try:
                answers = self.answers(paths, values[place])
            except Exception as error:
                room.status[place] = FAILED
                room.sentences[place] = _sentence(error)
                continue
            for one, answer in zip(self.quantities, answers, strict=True):
                one.put(room.values[one.path], place, answer)
            room.status[place] = DONE
        return room

    def answers(self, paths: tuple[str, ...], value: Array) -> list[float | str]:
        """Quantities at one point.

        Raises
        ------
        TrunnionError : the line refuses a number, or the analysis fails.
        """
        result = self.result(paths, value)
        return [one.read(result) for one in self.quantities]

    def result(self, paths: tuple[str, ...], value: Array) -> object:
        """The result of the analysis at one point."""
        import trunnion

        row = self.table(paths, value[None])[0]
        arguments = dict(self.arguments)
        if SPEED in paths:
            arguments["speed"] = float(row[0])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            line = self.assembly.packed.line_at(row)
            return getattr(trunnion, self.analysis)(line, **arguments)


def _sentence(error: Exception) -> str:
    """What is kept of a failure, on one line."""
    text = str(error).splitlines()[0] if str(error) else type(error).__name__
    if not isinstance(error, TrunnionError):
        text = f"{type(error).__name__}: {text}"
    return short(" ".join(text.split()), LONGEST_SENTENCE)


def require_analysis(name: object, arguments: Mapping[str, Any], speed_varies: bool) -> None:
    """Refuse what is not an analysis of a line, and arguments that it does not take.

    Raises
    ------
    InputError : names the nearest.
    """
    import trunnion

    known = {one.name: getattr(trunnion, one.name) for one in ANALYSES}
    takes = {key: list(inspect.signature(function).parameters) for key, function in known.items()}
    of_lines = [key for key, names in takes.items() if names[0] == "line"]
    if not isinstance(name, str) or name not in known:
        raise InputError("is not an analysis", key="analysis", value=name, remedy=nearest(name, of_lines))
    if name not in of_lines:
        raise InputError(
            "needs more than a driveline",
            key="analysis",
            value=name,
            remedy="take assess, stability or order_response, say",
        )
    rest = [key for key in takes[name][1:] if key not in ("progress", "within", "client", "processes", "threads")]
    for key, value in arguments.items():
        if key not in rest:
            raise InputError(f"is not an argument of {name}", element="arguments", key=key, value=value,
                             remedy=nearest(key, rest))  # fmt: skip
    if speed_varies and "speed" not in rest:
        problem = f"is not a number of the line, and {name} takes no speed"
        raise InputError(problem, element="parameter", key="path", value=SPEED, remedy="vary another parameter")
    if speed_varies and "speed" in arguments:
        problem = "is stated, and varied by a parameter too"
        raise InputError(problem, element="arguments", key=SPEED, value=arguments["speed"], remedy="leave it out")


def _kinds(
    quantities: tuple[str, ...], result: object, before: tuple[StudyQuantity, ...]
) -> tuple[StudyQuantity, ...]:  # fmt: skip
    """Quantities as ``result`` has them; those that are nothing there as results ``before`` had them."""
    known = {one.path: one for one in before}
    return tuple(
        known[path] if path in known and followed(result, path)[0] is None else StudyQuantity.of(path, result)
        for path in quantities
    )


def question_of(
    line: Driveline, analysis: str, arguments: Mapping[str, Any], quantities: tuple[str, ...],
    paths: tuple[str, ...], tried: Array,
) -> StudyQuestion:  # fmt: skip
    """The question of a study; what its quantities are is seen on the first of the ``tried`` points that can be
    computed.

    Raises
    ------
    InputError : an unknown quantity; nothing can be computed at any of these points.
    """
    bare = StudyQuestion(dumps(line), analysis, dict(arguments), ())
    refused: Exception | None = None
    kinds: tuple[StudyQuantity, ...] = ()
    for value in tried:
        try:
            result = bare.result(paths, value)
        except TrunnionError as error:
            refused = refused or error
            continue
        except (TypeError, ValueError) as error:
            raise InputError(f"are not taken by {analysis} ({short(str(error), 120)})", element="study",
                             key="arguments", remedy="see the signature of the analysis") from None  # fmt: skip
        if all(followed(result, path)[0] is not None for path in quantities):
            return StudyQuestion(bare.line_text, analysis, bare.arguments, _kinds(quantities, result, kinds))
        kinds = _kinds(quantities, result, kinds)
    if kinds:  # what is nothing at all of them is a number that is not known
        return StudyQuestion(bare.line_text, analysis, bare.arguments, kinds)
    if isinstance(refused, InputError):
        raise InputError(f"fails at each of {len(tried)} points tried: {refused}", key="analysis", value=analysis,
                         remedy="change arguments or parameters")  # fmt: skip
    raise ComputationError(f"{analysis} fails at each of {len(tried)} points tried: {refused}")
