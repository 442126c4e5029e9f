"""Sobol indices beside Ishigami's function, whose indices are known in closed form."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from studies.asked import stated

import trunnion as tn
from trunnion.studies.design import Sampling, Scattering, StudyDesign
from trunnion.studies.quantities import StudyQuantity
from trunnion.studies.result import Study
from trunnion.studies.sensitivities import study_sensitivities as sensitivities

A, B = 7.0, 0.1
TOTAL = A**2 / 8 + B * np.pi**4 / 5 + B**2 * np.pi**8 / 18 + 0.5
FIRST = np.array([0.5 * (1 + B * np.pi**4 / 5) ** 2, A**2 / 8, 0.0]) / TOTAL
LAST = np.array([FIRST[0] + B**2 * np.pi**8 * (1 / 18 - 1 / 50) / TOTAL, FIRST[1], 0.0])
LAST[2] = B**2 * np.pi**8 * (1 / 18 - 1 / 50) / TOTAL


def ishigami(method: str, points: int) -> Study:
    """A study whose quantity is sin x + a sin² y + b z⁴ sin x, of three numbers from −π to π."""
    scattering = tuple(Scattering(name, "1", 0.0, -np.pi, np.pi) for name in "xyz")
    design = StudyDesign((), Sampling(method, points, 1, scattering))
    x, y, z = design.values(np.arange(design.size)).T
    values = np.sin(x) + A * np.sin(y) ** 2 + B * z**4 * np.sin(x)
    return Study(
        analysis="none", store="none", points=design.size, done=design.size, failed=0, version="", design=design,
        quantities=(StudyQuantity("f"),), status=np.ones(design.size, dtype=np.uint8), values={"f": values}, reasons=(),
    )  # fmt: skip


@pytest.mark.slow
def test_ishigami() -> None:
    found = sensitivities(ishigami("saltelli", 4096), "f")
    np.testing.assert_allclose(found.first, FIRST, atol=0.02)
    np.testing.assert_allclose(found.total, LAST, atol=0.02)
    inside = (found.first_interval[:, 0] - 0.02 <= FIRST) & (FIRST <= found.first_interval[:, 1] + 0.02)
    assert inside.all() and "x: 3" in str(found)
    again = sensitivities(ishigami("saltelli", 4096), "f")
    assert np.array_equal(again.total_interval, found.total_interval), "the bootstrap is repeatable"


@pytest.mark.parametrize("method", ["sobol", "latin"])
def test_shares_by_classes(method) -> None:
    found = sensitivities(ishigami(method, 8192), "f")
    np.testing.assert_allclose(found.first, FIRST, atol=0.02)
    assert np.isnan(found.total).all()


def test_of_a_line(tmp_path: Path) -> None:
    """The undamped frequency of one disk on one spring: half the variance from each, as √(k/J) says to first order."""
    one = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=4.0), tn.Disk(inertia=1.0)])
    parameters = [{"path": path, "tolerance": "2 %"} for path in ("Shaft 1.stiffness", "Disk 1.inertia")]
    asked = stated(
        tmp_path / "a.zarr", ["undamped_frequency[0]"], analysis="natural_frequencies", parameter=parameters,
        sampling={"method": "saltelli", "points": 64},
    )  # fmt: skip
    study = tn.study(asked, line=one, workers=0)
    stiffness, inertia = study.parameter("Shaft 1.stiffness"), study.parameter("Disk 1.inertia")
    np.testing.assert_allclose(study.quantity("undamped_frequency[0]"), np.sqrt(stiffness / inertia), rtol=1e-12)
    np.testing.assert_allclose(sensitivities(study, "undamped_frequency[0]").total, 0.5, atol=0.1)


def test_refusals() -> None:
    with pytest.raises(tn.ComputationError, match="is the same at all points"):
        same = ishigami("saltelli", 64)
        sensitivities(replace(same, values={"f": np.ones(same.points)}), "f")
    with pytest.raises(tn.ComputationError, match="1 of 320 points have no f"):
        lost = ishigami("saltelli", 64)
        lost.status[3] = 2
        sensitivities(lost, "f")
    with pytest.raises(tn.InputError, match="is not a quantity of the study"):
        sensitivities(ishigami("saltelli", 64), "g")
