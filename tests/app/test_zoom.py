"""Zooming into a chart shows more points of what is known: no chart is computed again.

That points between patches integrate nothing is shown in tests/charts/test_every_pixel.py.
"""

from __future__ import annotations

from io import BytesIO
from typing import Any

import numpy as np
import pytest

pytest.importorskip("panel")

from test_exported_code import view_of

import trunnion as tn
from trunnion.app.parts.jobs import Job
from trunnion.app.worker import WorkerLoop
from trunnion.driveline.starter import starter
from trunnion.pictures.picture import ColouredGrid

BOX = ((tn.rpm(650), tn.rpm(800), 5), (tn.deg(10), tn.deg(19), 4))


def test_a_zoom_after_many_clicks_asks_for_no_chart(monkeypatch: pytest.MonkeyPatch) -> None:
    """The worker has the chart still, whatever points were looked at since; and what it shows is what is true there."""
    calls: list[str] = []
    charted = tn.stability_chart
    monkeypatch.setattr(tn, "stability_chart", lambda *a, **k: (calls.append("chart"), charted(*a, **k))[1])
    worker, toml = WorkerLoop(BytesIO(), BytesIO(), 1), starter("two-shaft")

    def look(at_x: float) -> Any:
        settings = {"across": "12", "up": "10", "at_x": f"{at_x}", "at_y": "15", "look": "True"}
        view = view_of(toml, "stability", settings)
        return {step.name: step for step in view.steps(view.session.document.line)}

    def compute(job: Job) -> Any:
        return worker.compute(job, lambda share: None)

    steps = look(700.0)
    whole = compute(steps["chart"].job(toml))
    assert calls == ["chart"]
    for at_x in (710.0, 900.0, 1300.0, 1500.0, 2000.0):
        for name in ("point", "undisturbed", "motion"):
            compute(look(at_x)[name].job(toml))
    chart = steps["chart"]
    zoomed = mesh(compute(Job(toml, chart.call, chart.show, {**chart.options, "zoom": BOX})))
    assert calls == ["chart"]
    assert zoomed.says.shape == (4, 5) and mesh(whole).says.shape == (10, 12)
    for j, k in ((0, 0), (3, 2), (1, 4)):
        line = tn.loads(toml).replace("HookeJoint 1", angle=tn.deg(zoomed.y[j]))
        there = tn.stability(line, speed=tn.rpm(zoomed.x[k]))
        per_turn = np.expm1(np.log(there.spectral_radius) * 2 * np.pi / there.period)
        assert zoomed.says[j, k] == pytest.approx(100 * per_turn, abs=1e-4)


def mesh(data: dict[str, Any]) -> ColouredGrid:
    """What of a chart is coloured, and what the pointer is told of each point."""
    return next(item for item in data["picture"].panel.items if isinstance(item, ColouredGrid))
