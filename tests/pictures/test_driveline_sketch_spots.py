"""Where the elements of a sketch are, against the ink of the sketch itself."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.pictures.driveline_sketch import draw, spots


@pytest.mark.parametrize("name", ["pto-shaft", "truck"])
def test_every_element_is_drawn_within_its_box(name: str) -> None:
    line = tn.load(f"examples/{name}.toml")
    figure = draw(line, 6.5)
    figure.canvas.draw()
    ink = np.asarray(figure.canvas.buffer_rgba())[..., :3].min(axis=-1) < 200
    tall, wide = ink.shape
    found = spots(line, 6.5)
    assert [one.name for one in found] == list(line.as_stated.names)
    for one in found:
        left, top, width, height = one.box
        assert 0 <= left < left + width <= 1
        assert 0 <= top < top + height <= 1
        part = ink[int(top * tall) : int((top + height) * tall), int(left * wide) : int((left + width) * wide) + 1]
        assert part.any(axis=0).mean() > 0.7, one.name  # its axle or body, from end to end
        if one.parent >= 0:
            assert one.begins == pytest.approx(found[one.parent].ends)  # no branch here


@pytest.mark.parametrize("named", [True, False])
@pytest.mark.parametrize("ratio", [-3, 0.4, 1])
def test_a_ratio_stands_clear_of_what_is_drawn_beside_it(ratio: float, named: bool) -> None:
    """Also between the largest disks of a line, within the page, and over nothing that hides it."""
    disks = [tn.Disk(inertia=one) for one in (0.01, 9.0, 9.0, 0.01)]
    shaft = tn.Shaft(stiffness=1e4)
    figure = draw(
        tn.Driveline([disks[0], shaft, disks[1], tn.Ratio(ratio=ratio), disks[2], shaft, disks[3]]), named=named
    )
    figure.canvas.draw()
    (axes,) = figure.axes
    (text,) = (one for one in axes.texts if one.get_text().startswith("i "))
    box = text.get_window_extent()
    assert axes.bbox.x0 <= box.x0 and box.x1 <= axes.bbox.x1 and box.y1 <= axes.bbox.y1
    assert not any(patch.get_window_extent().overlaps(box) for patch in axes.patches)
