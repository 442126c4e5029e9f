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
