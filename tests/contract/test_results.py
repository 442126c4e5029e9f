"""What every result promises: labelled fields, from which dataset, dictionary, docstring and display follow."""

from __future__ import annotations

import dataclasses
import json
import pkgutil
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import trunnion as tn
from trunnion.results.fields import (
    LABEL,
    attribute,
    computed,
    coordinate,
    internal,
    labelled,
    labels,
    members,
    variable,
)
from trunnion.results.finding import Finding, Gravity
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Coordinate, Variable, attributes

ROOMS = ("modes", "steady", "floquet", "response", "motion", "design")
for room in ROOMS:
    for found in pkgutil.walk_packages([str(Path(tn.__file__).parent / room)], f"trunnion.{room}."):
        import_module(found.name)


def subclasses(base: type) -> set[type]:
    return {s for c in base.__subclasses__() if c.__module__.startswith("trunnion") for s in (c, *subclasses(c))}


RESULTS = sorted(
    (kind for kind in subclasses(Result) if not kind.__module__.startswith("trunnion.results.described")),
    key=lambda kind: kind.__name__,
)
MEMBERS = {label.members for kind in RESULTS for label in labels(kind).values() if label.members}


@pytest.mark.parametrize("kind", RESULTS, ids=lambda k: k.__name__)
def test_every_result_declares_and_introduces_itself(kind: type[Result]) -> None:
    assert labels(kind)
    assert kind._lines is not Result._lines or kind.__str__ is not Result.__str__
    assert kind.__repr__ is Result.__repr__, "write @labelled"


@pytest.mark.parametrize(
    "kind", sorted({*RESULTS, *MEMBERS}, key=lambda k: k.__qualname__), ids=lambda kind: kind.__name__
)
def test_every_field_is_declared_or_internal(kind: type) -> None:
    """No field is forgotten: each says what it is, and the docstring lists it."""
    for one in dataclasses.fields(kind):
        assert LABEL in one.metadata, f"label {kind.__name__}.{one.name}: variable, coordinate, attribute or internal"
        label = one.metadata[LABEL]
        assert label.shown == "" or f"    {one.name} : {label.shown}" in (kind.__doc__ or "")
        assert label.words == "" or not label.words.endswith(".") and label.words == label.words.strip()
    names = [label.name or name for name, label in labels(kind).items() if label.kind and not label.members]
    assert len(names) == len(set(names)), "two values of one name"


@labelled
class Peak:
    """A made-up member."""

    speed: float = variable("", "rad/s", "where it stands", name="peak_speed")
    height: float = variable("", "{self.height_unit}")
    sharp: bool = variable()
    note: str = internal("that nobody reads", default="")

    @property
    @computed(variable("", "", "in words"))
    def size(self) -> str:
        """How large it is."""
        return "large" if self.height > 1 else "small"

    @property
    def name(self) -> str:
        return f"at {self.speed:g}"


@labelled
class Small(Result):
    """A small result."""

    speed: np.ndarray = coordinate("speed", "rad/s")
    shafts: tuple[str, ...] = coordinate("shaft", "", "names")
    speed_in_hertz: np.ndarray = coordinate("speed", "Hz", name="speed_in_hertz")
    torque: np.ndarray = variable("speed shaft", "N*m", "of every shaft")
    gain: np.ndarray = variable("shaft", "1")
    known: tuple[bool, ...] = variable("shaft")
    peaks: tuple[Peak, ...] = members(Peak, "peak", name="name")
    growth: float = variable("", "1/s", "of {self.method}")
    height_unit: str = internal()
    method: str = attribute("how it was found")
    complete: bool = attribute()
    gravity: Gravity = attribute()
    span: tuple[float, float] = attribute(name="range")
    findings: tuple[Finding, ...] = attribute(default=())
    unit: str = internal("of speeds in print", default="rad/s")

    @property
    @computed(variable("speed", "1"), after="torque")
    def trusted(self) -> np.ndarray:
        """Where it holds."""
        return self.speed < 1.5

    def declared(self) -> Iterator[Variable | Attribute]:
        """One more of each."""
        yield from super().declared()
        yield Coordinate("end", ["low", "high"], "end")
        yield Variable("limit", [1.0, 2.0], "end", "N*m", "of <all>", {"flag": 1})
        yield from attributes(said=None, also=Gravity.NOTE)

    def _lines(self) -> Iterator[str]:
        yield "a small result:"
        yield f"  with <two> lines, up to {self.words.speed(float(self.speed[-1]))}"


def small(**changes: object) -> Small:
    given = Small(
        speed=np.array([1.0, 2.0]), shafts=("a", "b"), speed_in_hertz=np.array([0.1, 0.2]),
        torque=np.array([[1.0, np.nan], [2.0, 3.0]]), gain=np.array([1 + 2j, 3 - 1j]), known=(True, False),
        peaks=(Peak(1.0, 2.0, True), Peak(2.0, 0.5, False)), growth=0.5, height_unit="rad", method="none",
        complete=True, gravity=Gravity.CAUTION, span=(1.0, 2.0), findings=(Finding(Gravity.NOTE, "It is small."),),
    )  # fmt: skip
    return dataclasses.replace(given, **changes)


def test_the_dataset_follows_from_the_fields() -> None:
    data = small().data
    assert data.torque.dims == ("speed", "shaft")
    assert data.torque.attrs == {"units": "N*m", "long_name": "of every shaft"}
    assert data.gain.dims == ("shaft", "part") and data.gain.sel(part="imaginary").values.tolist() == [2.0, -1.0]
    assert data.growth.item() == 0.5 and data.growth.attrs == {"units": "1/s", "long_name": "of none"}
    assert data.known.dtype == np.int8 and data.known.values.tolist() == [1, 0]
    assert data.trusted.dtype == np.int8 and data.trusted.values.tolist() == [1, 0]
    assert set(data.coords) == {"speed", "shaft", "speed_in_hertz", "peak", "end", "part"}
    assert data.speed.attrs == {"units": "rad/s"} and data.speed_in_hertz.dims == ("speed",)
    assert data.limit.attrs == {"units": "N*m", "long_name": "of <all>", "flag": 1}
    found = {"method": "none", "complete": 1, "gravity": "caution", "range": [1.0, 2.0], "also": "note"}
    assert data.attrs == found | {"findings": ["note: It is small."]}
    assert list(data.data_vars) == [
        "torque", "trusted", "gain", "known", "peak_speed", "height", "sharp", "size", "growth", "limit"
    ]  # fmt: skip


def test_members_are_variables_over_their_axis() -> None:
    data = small().data
    assert data.peak.values.tolist() == ["at 1", "at 2"]
    assert data.peak_speed.dims == ("peak",) and data.peak_speed.attrs["long_name"] == "where it stands"
    assert data.height.attrs == {"units": "rad"}  # of the result that has them
    assert data["size"].values.tolist() == ["large", "small"] and data.sharp.dtype == np.int8
    assert "note" not in data
    none = small(peaks=()).data
    assert none.peak_speed.shape == (0,) and none.peak_speed.attrs["units"] == "rad/s"


def test_dictionary_and_display_follow_too() -> None:
    result = small()
    assert json.loads(result.to_json())["torque"] == [[1.0, None], [2.0, 3.0]]
    assert result.to_dict()["gain"] == [{"real": 1.0, "imag": 2.0}, {"real": 3.0, "imag": -1.0}]
    assert result.to_dict()["said"] is None and result.to_dict()["complete"] == 1
    assert repr(result) == "<Small: a small result>"
    assert str(result).splitlines()[1:] == ["  with <two> lines, up to 2 rad/s", "  note: It is small."]
    assert "&lt;two&gt;" in result._repr_html_() and "N*m" in result._repr_html_()
    assert repr(result.peaks[0]).startswith("Peak(speed=1.0")  # members show themselves as dataclasses do


def test_the_docstring_lists_the_fields() -> None:
    assert (Small.__doc__ or "").startswith("A small result.\n")
    for said in (
        "speed : (speed,) [rad/s]", "shafts : (shaft,) names", "torque : (speed, shaft) [N*m] of every shaft",
        "growth : [1/s] of {self.method}", "method : how it was found", "trusted : (speed,) [1]",
    ):  # fmt: skip
        assert f"    {said}\n" in f"{Small.__doc__}\n"


def test_another_unit_is_one_word_away() -> None:
    """``in_unit`` changes what is said, not what is held, nor the result that was asked."""
    result = small()
    turned = result.in_unit("rpm")
    assert "up to 19.0986 rpm" in str(turned) and str(turned) == result.describe("rpm")
    assert "up to 2 rad/s" in str(result) and str(result) == result.describe()
    assert turned.to_dict() == result.to_dict() and result.in_unit("rad/s") is result
    assert result.findings_in("rpm") == result.findings
    with pytest.raises(tn.InputError, match="unit = 'mph': is not a unit of speed"):
        result.in_unit("mph")


def test_a_line_shows_itself_in_one_line_and_in_a_notebook() -> None:
    modes = tn.natural_frequencies(tn.catalogue("two-shaft-cardan"))
    assert "\n" not in repr(modes) and "natural frequencies" in repr(modes)
    assert modes.data.shape.dims == ("rotation", "mode")
    assert "damping_ratio" in modes._repr_html_()
