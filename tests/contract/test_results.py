"""What every result promises: one declaration, from which dataset, dictionary and notebook display follow."""

from __future__ import annotations

import json
import pkgutil
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import trunnion as tn
from trunnion.results.declared import Result, axis, over, remark

ROOMS = ("modes", "steady", "floquet", "response", "motion", "design")
for room in ROOMS:
    for found in pkgutil.walk_packages([str(Path(tn.__file__).parent / room)], f"trunnion.{room}."):
        import_module(found.name)


def subclasses(base: type) -> set[type]:
    return {s for c in base.__subclasses__() if c.__module__.startswith("trunnion") for s in (c, *subclasses(c))}


RESULTS = [kind for kind in subclasses(Result) if kind.__module__ != Result.__module__]


@pytest.mark.parametrize("kind", sorted(RESULTS, key=lambda k: k.__name__), ids=lambda k: k.__name__)
def test_every_result_declares_and_introduces_itself(kind: type) -> None:
    assert kind.declared is not Result.declared
    assert kind.__str__ is not object.__str__
    assert kind.__repr__ is Result.__repr__, "write @dataclass(..., repr=False)"


class Small(Result):
    def declared(self):
        yield axis("speed", [1.0, 2.0], "rad/s")
        yield axis("shaft", ("a", "b"))
        yield over("speed shaft", "torque", np.array([[1.0, np.nan], [2.0, 3.0]]), "N*m", "of every shaft")
        yield over("shaft", "gain", np.array([1 + 2j, 3 - 1j]), "1")
        yield over("", "growth", 0.5, "1/s")
        yield remark("method", "none")

    def __str__(self) -> str:
        return "a small result:\n  with <two> lines"


def test_dataset_dictionary_and_display_follow_from_the_declaration() -> None:
    small, data = Small(), Small().data
    assert data.torque.dims == ("speed", "shaft") and data.torque.attrs == {
        "units": "N*m",
        "long_name": "of every shaft",
    }
    assert data.gain.dims == ("shaft", "part") and data.gain.sel(part="imaginary").values.tolist() == [2.0, -1.0]
    assert data.growth.item() == 0.5 and data.attrs == {"method": "none"}
    assert json.loads(small.to_json())["torque"] == [[1.0, None], [2.0, 3.0]]
    assert small.to_dict()["gain"] == [{"real": 1.0, "imag": 2.0}, {"real": 3.0, "imag": -1.0}]
    assert repr(small) == "<Small: a small result>"
    assert "&lt;two&gt;" in small._repr_html_() and "N*m" in small._repr_html_()


def test_a_line_shows_itself_in_one_line_and_in_a_notebook() -> None:
    modes = tn.natural_frequencies(tn.catalogue("two-shaft-cardan"))
    assert "\n" not in repr(modes) and "natural frequencies" in repr(modes)
    assert modes.data.shape.dims == ("rotation", "mode")
    assert "damping_ratio" in modes._repr_html_()
