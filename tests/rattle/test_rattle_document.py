"""The examples of docs/rattle.md run in order, and say what the page says they do."""

from __future__ import annotations

from typing import Any

import pytest
from pages import blocks, run_page


@pytest.mark.slow
def test_examples_run_in_order() -> None:
    text, names = run_page("rattle")
    assert "fold at 0.874372" in text and "2 attractors" in text
    assert abs(names["both"]["describing function"].peak[1] / names["both"]["exact"].peak[1] - 1) < 0.01
    assert (0.87, 0.88) in names["up"].jumps and (0.76, 0.75) in names["down"].jumps
    assert names["double"].outcome.ok and len(names["branch"].parameter) > 10
    assert abs(names["amplitude"][-1] - names["large"].amplitude) < 1e-3
    assert names["small"].stable and not names["saddle"].stable
    assert tn_orbit(names).outcome.ok
    assert names["motion"].outcome.ok and [c.spring for c in names["motion"].contacts] == [
        "GearPair 1",
        "PiecewiseShaft 1",
    ]
    assert names["exact"].outcome.ok and len(names["exact"].events) > 20 and names["orbit"].contacts[1].rattles
    assert [p.kind for p in names["over_speed"].special] == ["grazing"] and names["over_speed"].outcome.ok
    # The line's pair of gears is the pair at the top of the page, but for the transmission error.
    same = names["pair"].but(harmonics=(), name=names["one"].name)
    assert names["one"].inertia == pytest.approx(same.inertia) and names["one"].slopes == pytest.approx(same.slopes)
    assert names["one"].mean_force == pytest.approx(same.mean_force) and names["one"].force == pytest.approx(same.force)
    tables = "\n".join(blocks("rattle", "toml"))
    disk = '[[element]]\ntype = "Disk"\ninertia = 0.1\n'
    assert names["tn"].loads(f"format = 1\n{disk}{tables}{disk}").elements[1].backlash == 1e-4


def tn_orbit(names: dict[str, Any]) -> Any:
    """The clutch damper moves too."""
    return names["tn"].piecewise_orbit(names["clutch"])
