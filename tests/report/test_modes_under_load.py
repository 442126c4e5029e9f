"""Modes in reports beside those that checks take, against eigenvalues of matrices written down here."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.reporting.modes_table import modes
from trunnion.reporting.overview_assessment import answer, asked, judged

FIRST, LAST, STIFFNESS, DAMPING = 1.0, 2.0, 9e3, 3.0


def line(load: float, **of_last: object) -> tn.Driveline:
    """Two disks; the last takes ``load`` [N m s²/rad²] times the square of its speed."""
    parts = [
        tn.Disk(name="engine", inertia=FIRST, drive_share=1.0),
        tn.Shaft(name="shaft", stiffness=STIFFNESS, damping=DAMPING),
        tn.Disk(name="propeller", inertia=LAST, quadratic_load=load, **of_last),
    ]
    running = tn.Operation(speed="900 rpm", speed_range=("600 rpm", "1200 rpm"))
    return tn.Driveline(parts, operation=running)


def rows(of: tn.Driveline) -> list[dict[str, str]]:
    table = modes(answer(judged(asked(of))))
    return [dict(zip(table.heads, row, strict=True)) for row in table.rows]


def hertz(slope: float) -> float:
    """Of the elastic mode with a load of ``slope`` [N m s/rad] at the last disk."""
    k = STIFFNESS * np.array([[1.0, -1.0], [-1.0, 1.0]])
    c = DAMPING * np.array([[1.0, -1.0], [-1.0, 1.0]]) + np.diag([0.0, slope])
    over = np.array([[FIRST], [LAST]])
    a = np.block([[np.zeros((2, 2)), np.eye(2)], [-k / over, -c / over]])
    return float(np.linalg.eigvals(a).imag.max() / (2 * np.pi))


@pytest.mark.parametrize("load", [0.05, 0.8])
def test_a_load_that_moves_a_mode_has_its_own_column(load: float) -> None:
    speed = 900 * np.pi / 30
    found = rows(line(load))
    alone, loaded = hertz(0.0), hertz(2 * load * speed)
    assert float(found[1]["frequency [Hz]"]) == pytest.approx(alone, rel=5e-4)
    assert float(found[1]["under load at 900 rpm [Hz]"]) == pytest.approx(loaded, rel=5e-4)
    assert found[0]["under load at 900 rpm [Hz]"] == "–"
    diagram = tn.campbell_diagram(line(load), np.array([speed, 1.1 * speed]))
    assert diagram.frequency[0, -1] / (2 * np.pi) == pytest.approx(loaded, rel=1e-9)


def test_without_loads_there_is_no_such_column() -> None:
    assert not any("under load" in head for head in rows(line(0.0))[0])
