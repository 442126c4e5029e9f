"""The Python that every view hands out gives the numbers that the view shows, whatever it is set to."""

from __future__ import annotations

from dataclasses import is_dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("panel")

from test_views import rattling

from trunnion.app import shown
from trunnion.app.parts.calls import script
from trunnion.app.parts.document import Document
from trunnion.app.views import VIEWS
from trunnion.app.views.base import View
from trunnion.driveline.files import dumps, loads
from trunnion.driveline.starter import starter
from trunnion.errors import TrunnionError

GEARS = dumps(rattling())
"""A gear pair that crosses its backlash."""
TIMED = ("followed",)
"""What says how long it took."""

SETTINGS = [
    ("dashboard", {}),
    ("driveline", {}),
    ("live", {"speed": "900"}),
    ("live", {"what": "mode", "mode": "2"}),
    ("live", {"what": "response"}),
    ("live", {"what": "disturbance"}),
    pytest.param("live", {"what": "run-up", "rate": "400"}, marks=pytest.mark.slow),
    ("parts", {}),
    ("verdict", {}),
    ("orders", {"speed": "1234.5", "spring": "Shaft 2"}),
    ("stability", {"across": "8", "up": "6", "at_x": "707", "at_y": "19.5", "look": "True"}),
    ("stability", {"x": "Shaft 1.stiffness", "y": "Shaft 2.damping", "x_low": "6", "across": "6", "up": "6"}),
    ("joints", {"torque": "250", "turn": "40"}),
    ("limits", {"speeds": "2", "high": "20"}),
    pytest.param("limits", {"what": "stable windows of a parameter", "high": "20"}, marks=pytest.mark.slow),
    ("limits", {"what": "tolerances"}),
    pytest.param("limits", {"what": "what the checks follow most"}, marks=pytest.mark.slow),
    ("limits", {"what": "errors of assembly", "error": "2"}),
    ("limits", {"what": "best value of a parameter", "aim": "irregularity"}),
    ("motion", {"speed": "900"}),
    pytest.param("motion", {"what": "run-up", "rate": "400"}, marks=pytest.mark.slow),
    ("motion", {"what": "section", "returns": "20"}),
    ("motion", {"what": "section", "returns": "20", "of": "double-tripod"}),
    pytest.param("motion", {"what": "section", "returns": "20", "of": "double-tripod-output"}, marks=pytest.mark.slow),
    pytest.param("motion", {"what": "exponents"}, marks=pytest.mark.slow),
    pytest.param("motion", {"what": "chaos"}, marks=pytest.mark.slow),
    pytest.param("motion", {"what": "chaos", "of": "gear-rattle"}, marks=pytest.mark.slow),
]


def view_of(text: str, name: str, settings: dict[str, str]) -> View:
    """The view as a session would hold it."""
    document = Document(text)
    session = SimpleNamespace(document=document, line=lambda side: document.line)
    view = next(kind for kind in VIEWS if kind.name == name)(session)  # type: ignore[arg-type]
    view.read(settings)
    view.adapt(document.line)
    for key, value in settings.items():
        assert str(view.settings[key]) in (value, f"{value}.0"), f"{key} was not taken"
    return view


def alike(a: Any, b: Any, path: str = "") -> None:
    """Equal numbers, texts and places."""
    if isinstance(a, dict):
        assert a.keys() == b.keys(), path
        for key in a:
            alike(a[key], b[key], f"{path}.{key}")
    elif is_dataclass(a):
        assert type(a) is type(b), path
        alike(vars(a), vars(b), path)
    elif isinstance(a, list | tuple):
        assert len(a) == len(b), path
        for k, (one, other) in enumerate(zip(a, b, strict=True)):
            alike(one, other, f"{path}[{k}]")
    elif isinstance(a, np.ndarray) and a.dtype.kind in "fc":
        np.testing.assert_allclose(b, a, rtol=1e-9, atol=1e-12 * float(np.nanmax(np.abs(a), initial=1.0)), err_msg=path)
    elif isinstance(a, float):
        assert a == pytest.approx(b, rel=1e-9, nan_ok=True), path
    elif isinstance(a, str) and a.startswith("<?xml"):
        assert b.startswith("<?xml"), path
    else:
        assert np.array_equal(a, b), path


def check(text: str, name: str, settings: dict[str, str]) -> None:
    """What a worker would answer to each step, against what the program computes."""
    view = view_of(text, name, settings)
    document = view.session.document
    steps = view.steps(document.line)
    there: dict[str, Any] = {}
    calls = {s.name: (s.call, s.toml(document.toml)) for s in steps}
    exec(script(document.toml, calls, name, {s.name for s in steps if s.soft}), there)
    for step in steps:
        assert hasattr(view.side, f"show_{step.show}"), f"nothing draws what {step.name} gives"
        if step.call.function == "line":
            continue
        given = {"progress": lambda share: None, "threads": 1}
        try:
            result = step.call.evaluate(loads(step.toml(document.toml)), given)
        except TrunnionError:
            assert step.soft and step.name not in there
            continue
        answer, again = (getattr(shown, step.show)(r, **step.options) for r in (result, there[step.name]))
        if step.show in TIMED:
            answer.pop("text"), again.pop("text")
        alike(answer, again, step.name)


@pytest.mark.parametrize(("name", "settings"), SETTINGS)
def test_every_view(name: str, settings: dict[str, str]) -> None:
    check(starter("two-shaft"), name, settings)


@pytest.mark.slow
def test_every_method_for_a_gear_pair_that_rattles() -> None:
    """Sweeps and followed responses, where none refuses what the worker gives beside the exported arguments."""
    view = view_of(GEARS, "motion", {"what": "rattle", "points": "3"})
    assert [s.name for s in view.steps(view.session.document.line)] == [
        "sweep_up", "sweep_down", "exact", "shooting", "harmonic_balance",
    ]  # fmt: skip
    check(GEARS, "motion", {"what": "rattle", "points": "3"})


def test_an_empty_field_says_what_stands_for_it() -> None:
    """And both ends of an axis are free on their own."""
    view = view_of(starter("two-shaft"), "stability", {"x_high": "2000"})
    line = view.session.document.line
    assert view.widgets["x_low"].value is None
    assert view.widgets["x_low"].placeholder == "auto: 300"
    assert view.widgets["x_low"].name == "x from [rpm]"
    x, _ = view.axes(line)  # type: ignore[attr-defined]
    assert (x.low / x.size, x.high / x.size) == pytest.approx((300, 2000))
    orders = view_of(starter("two-shaft"), "orders", {})
    assert orders.widgets["speed"].placeholder == "operating: 1500"


def test_ends_that_do_not_rise_are_refused() -> None:
    for name, settings in (("stability", {"x_low": "5000"}), ("limits", {"low": "60"})):
        view = view_of(starter("two-shaft"), name, settings)
        with pytest.raises(TrunnionError, match="leave the fields empty"):
            view.steps(view.session.document.line)


@pytest.mark.parametrize("text", ["nan", "inf", "-inf", "x", ""])
def test_an_address_gives_numbers_or_nothing(text: str) -> None:
    view = view_of(starter("two-shaft"), "stability", {})
    view.read({"x_low": text, "at_x": text})
    assert view.settings["x_low"] is None
