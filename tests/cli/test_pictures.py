"""Charts as pictures: resonance names apart and inside, every verdict in the legend, no global state."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Annotation, Text

import trunnion as tn
from trunnion.pictures.draw_matplotlib import draw
from trunnion.pictures.picture import edges, spread
from trunnion.pictures.stability_chart import stability_chart
from trunnion.results.verdict import Verdict


@pytest.fixture(scope="module")
def chart():
    line = tn.catalogue("three-shaft-cardan")
    return tn.stability_chart(line, ("speed", 0.25, 2.2, 30), ("HookeJoint *.angle", 0, 0.8, 12))


@pytest.mark.parametrize("seed", range(20))
def test_spread_keeps_distance_order_and_limits(seed):
    rng = np.random.default_rng(seed)
    wanted = np.sort(rng.random(rng.integers(1, 20)) ** 2)
    placed = spread(wanted, 0.05)
    assert len(placed) == len(wanted)
    assert np.all(np.diff(placed) >= 0.05 - 1e-9)
    assert placed[0] >= 0 and placed[-1] <= 1 + 1e-9
    apart = np.diff(wanted, prepend=-1, append=2)
    free = (apart[:-1] > 1) & (apart[1:] > 1)
    assert np.allclose(placed[free], wanted[free])


@pytest.mark.parametrize("size", [(6.3, 4.9), (3.5, 3.5)])
@pytest.mark.parametrize("turned", [False, True], ids=["speed along x", "speed along y"])
def test_resonance_names_neither_overlap_nor_clip(chart, size, turned):
    if turned:
        chart = tn.stability_chart(chart.line, ("HookeJoint *.angle", 0, 0.8, 12), ("speed", 0.25, 2.2, 30))
    figure = Figure(figsize=size, layout="constrained")
    axes = draw(stability_chart(chart, resonances=tn.resonance_speeds(chart.line, 6)), figure.subplots())
    figure.draw_without_rendering()
    names = [t for t in axes.texts if isinstance(t, Annotation)]
    boxes = [Text.get_window_extent(t) for t in names]
    assert len(names) > 5
    for box in boxes:
        assert figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1
        assert figure.bbox.y0 <= box.y0 and box.y1 <= figure.bbox.y1
        assert not any(box.overlaps(other) for other in boxes if other is not box)
        assert not box.overlaps(axes.title.get_window_extent())


def test_every_verdict_has_its_entry(chart):
    verdict = chart.verdict.copy()
    for row, code in enumerate(Verdict):
        verdict[row] = code
    axes = draw(stability_chart(replace(chart, verdict=verdict)))
    words = [text.get_text() for text in axes.get_legend().get_texts()]
    for word in ("stable", "unstable", "marginal", "undecided", "not computed"):
        assert any(entry.startswith(word) for entry in words)


def test_units_and_operating_point(chart):
    operating = tn.Operation(speed=1.0, speed_range=[0.5, 2.0], angle_range=[0.0, 0.3])
    axes = draw(stability_chart(chart, unit="Hz", operating=operating))
    assert axes.get_xlabel() == "input speed [Hz]" and axes.get_ylabel() == "angle of all Hooke's joints [°]"
    point = next(line for line in axes.lines if line.get_label() == "operating point")
    assert point.get_xydata()[0] == pytest.approx([1 / (2 * np.pi), np.rad2deg(0.2)])


NO_WINDOWS = """
import sys
import trunnion as tn
chart = tn.stability_chart(tn.catalogue("two-shaft-cardan"), ("speed", 0.5, 2, 4), ("HookeJoint 1.angle", 0, 0.3, 3))
chart.plot().figure.savefig("chart.png")
print("matplotlib.pyplot" in sys.modules)
"""


def test_drawing_opens_no_windows(start):
    process = start("-c", NO_WINDOWS, program=())
    said = process.communicate(timeout=300)
    assert process.returncode == 0 and said[0].strip() == "False", said[1]


def test_edges_of_cells():
    assert edges(np.array([1.0, 2.0, 4.0])) == pytest.approx([0.5, 1.5, 3.0, 5.0])
    assert edges(np.array([2.0])) == pytest.approx([1.98, 2.02])
