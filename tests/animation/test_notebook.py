"""A line and results in a notebook: a kernel runs the cells, and what it hands to the notebook plays in a browser that
reaches no network."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import trunnion as tn
from trunnion.live import in_notebook

WIDGET = "application/vnd.jupyter.widget-view+json"
LINE = """
import trunnion as tn
shaft = tn.Shaft(stiffness=1e4, damping=2.0)
operation = tn.Operation(speed="600 rpm")
parts = [tn.ConstantSpeed(), tn.HookeJoint(angle=0.3), shaft, tn.Disk(inertia=0.8)]
line = tn.Driveline(parts, operation=operation, name="<img src=x onerror=hacked=1>")
"""
CELLS = ("line", "tn.natural_frequencies(line)", "tn.periodic_response(line)", "tn.stability(line)")


@pytest.fixture(scope="module")
def notebook() -> Any:
    pytest.importorskip("anywidget")
    nbclient, nbformat = pytest.importorskip("nbclient"), pytest.importorskip("nbformat")
    pytest.importorskip("ipykernel")
    made = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in (LINE, *CELLS)])
    nbclient.NotebookClient(made, timeout=600, kernel_name="python3", store_widget_state=True).execute()
    return made


def states(notebook: Any) -> list[dict[str, Any] | None]:
    """Of the widget below each cell."""
    known = notebook.metadata.widgets["application/vnd.jupyter.widget-state+json"]["state"]
    found: list[dict[str, Any] | None] = []
    for cell in notebook.cells[1:]:
        (output,) = cell.outputs
        assert "text/plain" in output.data
        view = output.data.get(WIDGET)
        found.append(known[view["model_id"]]["state"] if view else None)
    return found


def test_a_line_and_results_show_their_motion_beside_their_words(notebook: Any) -> None:
    line, modes, motion, verdict = states(notebook)
    assert line and modes and motion
    assert verdict is None  # words alone
    titles = [json.loads(one["scene"])["choices"][0]["title"] for one in (line, modes, motion)]
    assert titles == ["turning", "mode 1", "motion"]
    names: dict[str, Any] = {}
    exec(LINE, names)  # the same line here
    assert json.loads(line["scene"]) == json.loads(tn.animate(names["line"], "turning").json)
    assert "Stability" not in json.dumps(notebook.cells[-1].outputs[0].data.get("application/json", ""))


def test_what_cannot_be_shown_in_motion_is_shown_in_words() -> None:
    free = tn.Driveline([tn.Disk(inertia=1.0), tn.HookeJoint(angle=0.3), tn.Disk(inertia=1.0)])
    assert in_notebook(object()) == {}
    found = free._repr_mimebundle_()
    assert found == {} or WIDGET in found
    assert repr(free)


def test_the_widget_plays_in_a_browser_without_a_network(notebook: Any, browser: Any) -> None:
    state = states(notebook)[0]
    assert state is not None
    context = browser.new_context(offline=True, viewport={"width": 1000, "height": 700})
    page = context.new_page()
    page.set_default_timeout(120_000)
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.set_content("<div id='cell'></div>")
    page.evaluate(
        """async ({ esm, state }) => {
          const module = await import(URL.createObjectURL(new Blob([esm], { type: "text/javascript" })))
          const heard = {}
          window.model = { get: key => state[key], set: (key, value) => { state[key] = value }, save_changes: () => {},
            on: (event, act) => { heard[event] = act }, heard, state }
          const el = document.getElementById("cell")
          window.cleanup = (module.default.render ?? module.render)({ model: window.model, el })
          window.player = el.firstChild.player
        }""",
        {"esm": state["_esm"], "state": {k: v for k, v in state.items() if k != "_esm"}},
    )
    page.wait_for_function("() => window.player?.wide > 0")
    scene = json.loads(state["scene"])["choices"][0]
    page.evaluate("() => { player.pause(); player.seek(0.3 * player.whole) }")
    seen = {one["name"]: one["angles"] for one in page.evaluate("player.read()")}
    frame = 0.3 * (scene["movements"][0]["frames"] - 1)
    rigid = scene["movements"][0]["rigid"]
    disk = next(part for part in scene["parts"] if part["shape"] == "disk")
    series = np.array(rigid[disk["stations"][0]])
    angle = np.interp(frame, np.arange(len(series)), series) - disk["turned"][0]
    assert np.angle(np.exp(1j * (seen[disk["name"]][0] - angle))) == pytest.approx(0.0, abs=1e-3)
    page.evaluate(f"() => {{ player.pick; model.state.picked = '{disk['name']}'; model.heard['change:picked']() }}")
    assert page.evaluate("player.picked.name") == disk["name"]
    page.evaluate("() => { model.state.theme = 'dark'; model.heard['change:theme']() }")
    page.wait_for_function("() => player.drawn_theme === 'dark'")
    assert [url for url in asked if not url.startswith(("blob:", "about:", "data:"))] == []
    assert page.evaluate("window.hacked") is None
    context.close()
