"""Nothing is silently left out: every cell of ``trunnion.features`` is seen to be true."""

from __future__ import annotations

import dataclasses
import inspect
import warnings
from functools import cache
from pathlib import Path

import feature_lines
import numpy as np
import pytest
from questions import ASK_CELL, COSTLY, QUESTIONS

import trunnion as tn
from trunnion.driveline.elements import Element
from trunnion.driveline.excitation import Excitation
from trunnion.driveline.features import FEATURES, NOT_FEATURES
from trunnion.driveline.kinds import KINDS
from trunnion.driveline.operation import LoadCase, Operation
from trunnion.features import NOT_ANALYSES, TABLE, Treatment, left_out, markdown


def cells():
    for analysis, row in TABLE.items():
        for key in row:
            slow = key not in (QUESTIONS[analysis].quick or (key,)) or (analysis, key) in COSTLY
            yield pytest.param(analysis, key, marks=[pytest.mark.slow] if slow else [], id=f"{analysis}-{key}")


@dataclasses.dataclass
class Answer:
    refusal: str
    text: str
    numbers: dict[str, np.ndarray]


@cache
def answer(analysis: str, written: str, key: str = "") -> Answer:
    run = ASK_CELL.get((analysis, key), QUESTIONS[analysis].ask)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        line = tn.loads(written)
        try:
            result = run(line)
        except tn.InputError as error:
            return Answer(str(error), "", {})
    said = [str(result), *map(str, getattr(result, "findings", ())), *(str(w.message) for w in caught)]
    return Answer("", "\n".join(said), numbers(result))


SETTINGS = ("error", "defect", "residual", "seconds", "steps", "evaluations", "offsets", "line")


def numbers(result: object, depth: int = 0) -> dict[str, np.ndarray]:
    """The numbers of a result by name: of its dataset, or of its fields."""
    data = getattr(result, "data", None)
    if hasattr(data, "data_vars"):
        named = {k: np.asarray(v.values) for k, v in {**data.data_vars, **data.coords}.items()}
        return {k: v for k, v in named.items() if v.dtype.kind in "fcib" and not any(s in k for s in SETTINGS)}
    if isinstance(result, int | float | complex | np.ndarray):
        return {"": np.asarray(result)}
    parts: dict[str, object] = {}
    if isinstance(result, tuple | list):
        parts = {str(i): part for i, part in enumerate(result)}
    elif dataclasses.is_dataclass(result) and depth < 3:
        parts = {f.name: getattr(result, f.name) for f in dataclasses.fields(result)}
    return {
        f"{k}.{name}": value
        for k, part in parts.items()
        if not any(s in k for s in SETTINGS)
        for name, value in numbers(part, depth + 1).items()
        if value.dtype.kind in "fcib"
    }


def differ(one: dict[str, np.ndarray], other: dict[str, np.ndarray], tolerance: float) -> list[str]:
    """Names of the numbers that differ by more than ``tolerance`` of their size."""
    if one.keys() != other.keys():
        return sorted(one.keys() ^ other.keys())
    found = []
    for name, a in one.items():
        b = other[name]
        if a.shape != b.shape:
            found.append(name)
            continue
        finite = np.isfinite(a) & np.isfinite(b)
        size = max(np.abs(a[finite]).max(initial=0.0), np.abs(b[finite]).max(initial=0.0))
        near = np.isclose(a, b, rtol=0, atol=tolerance * size, equal_nan=True)
        if not near.all():
            found.append(name)
    return found


@pytest.mark.parametrize(("analysis", "key"), list(cells()))
def test_cell(analysis: str, key: str) -> None:
    cell = TABLE[analysis][key]
    line = QUESTIONS[analysis].line()
    changes = feature_lines.OTHERS.get((analysis, key), feature_lines.CHANGES[key])
    without, with_it = (tn.dumps(change(line)) for change in changes)
    own = key if (analysis, key) in ASK_CELL else ""
    after = answer(analysis, with_it, own)
    if cell.treatment is Treatment.REFUSED:
        assert "; " in after.refusal and "\n" not in after.refusal, f"not refused with a remedy: {after.refusal!r}"
        return
    assert not after.refusal, after.refusal
    before = answer(analysis, without, own)
    assert before.numbers, "nothing to compare"
    if cell.treatment is Treatment.COUNTED:
        assert differ(before.numbers, after.numbers, 1e-7), "nothing changes: count it, or write why it cannot matter"
        return
    if cell.treatment is Treatment.NOT_JUDGED:
        words = cell.quote or "not judged: max torque of front: no linear response"
        assert words in after.text, "it is judged: count it"
        return
    changed = differ(before.numbers, after.numbers, 1e-6)
    assert not changed, f"changes {changed}: it is counted"
    if cell.treatment is Treatment.SAID:
        said = [str(f) for f in left_out(analysis, tn.loads(with_it))]
        words = [cell.quote] if cell.quote else [s for s in said if cell.reason in s]
        assert words and words[0] in after.text, f"not said: {words}"


ROOMS = (
    "equations",
    "modes",
    "steady",
    "floquet",
    "response",
    "motion",
    "design",
    "reporting",
    "pictures",
    "studies",
    "measured",
)
"""Where what takes a driveline to answer something stands."""


def test_every_analysis_has_a_row() -> None:
    """Every public function that takes a driveline is in the table, or has a reason not to be."""
    public = {name: getattr(tn, name) for name in tn.__all__ if name != "__version__"}
    taking = {
        name
        for name, one in public.items()
        if inspect.isfunction(one)
        and one.__module__.startswith(tuple(f"trunnion.{room}." for room in ROOMS))
        and any("Driveline" in str(p.annotation) for p in inspect.signature(one).parameters.values())
    }
    assert taking == set(TABLE) | set(NOT_ANALYSES)
    assert set(TABLE) == set(QUESTIONS)


def test_every_field_belongs_to_a_feature() -> None:
    models = [*KINDS.values(), Element, Excitation, tn.TransmissionError, tn.StiffnessVariation, tn.Ripple, tn.Slider]
    models += [tn.PressureCurve, tn.TorquePoint, tn.ConverterPoint, tn.OilPoint, tn.Sheet]
    models += [tn.Driveline, tn.Limit, Operation, LoadCase, tn.Schedule, tn.SwitchedOff, tn.TitleBlock]
    models += [tn.SNCurve, tn.Duty, tn.SpeedPassage]
    common = set(Element.model_fields)
    fields = {
        f"{model.__name__}.{key}"
        for model in models
        for key in model.model_fields
        if model is Element or not (issubclass(model, Element) and key in common)
    }
    known = [field for one in FEATURES for field in one.fields]
    assert len(known) == len(set(known))
    assert fields == set(known) | set(NOT_FEATURES)
    assert {one.key for one in FEATURES} == set(feature_lines.CHANGES)


@pytest.mark.parametrize("one", FEATURES, ids=lambda one: one.key)
def test_places(one) -> None:
    """A feature is found where it is, and named."""
    with_it = feature_lines.CHANGES[one.key][1](feature_lines.bent())
    places = one.places(with_it)
    assert places
    assert all(place.rpartition(".")[0] in (*with_it.names, "driveline", "") for place in places)


def test_the_page_prints_the_table() -> None:
    """``python -m trunnion.features`` prints what belongs below the page's first lines."""
    page = (Path(__file__).parents[2] / "docs" / "features.md").read_text(encoding="utf-8")
    assert page.endswith(f"\n{markdown()}\n")
