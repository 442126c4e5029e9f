"""``assess`` says *proved* beside *satisfied* where a bound of a few boxes lies below the limit at every speed."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import trunnion as tn
from trunnion.design.assessment import bounds
from trunnion.response.peaks import peaks_below

SPEEDS = (60.0, 300.0)
K, C, J1, J2, AMPLITUDE = 1e4, 40.0, 0.2, 0.8, 100.0


def two_disks(limit: float, **more: object) -> tn.Driveline:
    engine = tn.Disk(name="engine", inertia=J1, excitation=[{"order": 2, "amplitude": AMPLITUDE}])
    shaft = tn.Shaft(name="shaft", stiffness=K, damping=C)
    limits = [tn.Limit(of="shaft", max_torque=limit, **more)]
    return tn.Driveline([engine, shaft, tn.Disk(name="load", inertia=J2)], limits=limits)


def peak() -> float:
    """Of the shaft: q̈ (1/(1/J₁ + 1/J₂)) + c q̇ + k q = −A J₂/(J₁ + J₂) e^{2iΩt}."""
    s, reduced = 2j * np.linspace(*SPEEDS, 40_001), J1 * J2 / (J1 + J2)
    return float(np.abs((K + C * s) * AMPLITUDE * J2 / (J1 + J2) / (K + C * s + reduced * s**2)).max())


@pytest.mark.parametrize(("share", "margin"), [(1.5, 0.0), (2.0, 0.2)])
def test_a_bound_below_the_limit_is_a_proof(share: float, margin: float) -> None:
    limit = share * peak()
    found = tn.assess(two_disks(limit, margin=margin), SPEEDS).check("max torque of shaft")
    assert found.words == "satisfied, proved" and found.proof == "proved"
    assert peak() * (1 - 1e-9) <= found.bound <= limit * (1 - margin)
    assert "proved: at most" in found.because and "at every speed, " in found.because
    assert tn.assess(two_disks(limit), SPEEDS).data["bound"].sel(check=found.name) > peak() * (1 - 1e-9)


def test_what_few_boxes_leave_open_is_searched() -> None:
    """A limit that the margin, or a hair, leaves above the peak: satisfied, and no proof is claimed."""
    for line in (two_disks(1.00005 * peak()), two_disks(1.3 * peak(), margin=0.23073)):
        judged = tn.assess(line, SPEEDS)
        found = judged.check("max torque of shaft")
        assert found.status is found.status.SATISFIED and found.words == "satisfied"
        assert found.proof == "searched, not proved" and "ranges of speed bound it by" in found.because
        assert found.bound > found.limit * (1 - found.required_margin)
        assert any("certify-peaks" in str(finding) for finding in judged.findings)


def test_nothing_is_proved_of_what_is_exceeded_or_stands_at_one_speed() -> None:
    exceeded = tn.assess(two_disks(0.9 * peak()), SPEEDS).check("max torque of shaft")
    assert exceeded.status is exceeded.status.EXCEEDED and not exceeded.proof and np.isnan(exceeded.bound)
    alone = tn.assess(two_disks(2 * peak()), (100.0, 100.0)).check("max torque of shaft")
    assert alone.words == "satisfied" and not alone.proof


def test_lines_that_are_not_enclosed_say_why() -> None:
    judged = tn.assess(two_disks(1e4).replace("shaft", damping=0.0, loss_factor=0.1), SPEEDS)
    assert judged.check("max torque of shaft").proof == "searched, not proved"
    said = [str(finding) for finding in judged.findings if "not proved" in str(finding)]
    assert len(said) == 1 and "shaft.loss_factor holds at all frequencies" in said[0]


def test_the_bound_holds_of_every_load_case() -> None:
    """The braked line carries its load besides; one bound stands for both."""
    shaft = tn.Shaft(name="shaft", stiffness=K, damping=C)
    parts = [tn.ConstantSpeed(), tn.Shaft(name="first", stiffness=2 * K, damping=C), tn.Disk(name="wheel", inertia=J1),
             shaft, tn.Disk(name="load", inertia=J2, excitation=[{"order": 2, "amplitude": 30.0}])]  # fmt: skip
    case = tn.LoadCase(name="braked", loads={"load": 50.0})
    line = tn.Driveline(
        parts, limits=[tn.Limit(of="shaft", max_torque=400.0)], operation=tn.Operation(load_cases=[case])
    )
    found = tn.assess(line, (40.0, 120.0)).check("max torque of shaft")
    worst = tn.assess(line, (40.0, 120.0), load_case="braked").check("max torque of shaft")
    assert found.proof == "proved" and "at every speed of every load case" in found.because
    assert found.load_case == "braked" and found.bound >= worst.value * (1 - 1e-9) and worst.proof == "proved"


def test_a_bound_below_what_was_found_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    true = peaks_below.box_peaks

    def low(*given: object) -> object:
        found = true(*given)  # type: ignore[arg-type]
        return replace(found, upper=1e-3 * found.upper)

    monkeypatch.setattr(peaks_below, "box_peaks", low)
    found = tn.assess(two_disks(3 * peak()), SPEEDS).check("max torque of shaft")
    assert found.proof == "searched, not proved" and "one of both is wrong" in found.because


def test_no_boxes_no_proof(monkeypatch: pytest.MonkeyPatch) -> None:
    """One box of a whole range, resonance included, bounds nothing."""
    monkeypatch.setattr(bounds, "BOXES", 1)
    monkeypatch.setattr(bounds, "LEAST", 1)
    found = tn.assess(two_disks(3 * peak()), SPEEDS).check("max torque of shaft")
    assert found.proof == "searched, not proved" and "one range of speed do" not in found.because


def test_json_and_words(tmp_path: Path) -> None:
    from trunnion.cli import app

    line = two_disks(2 * peak())
    tn.dump(line.model_copy(update={"operation": tn.Operation(speed_range=SPEEDS)}), tmp_path / "line.toml")
    answer = json.loads(CliRunner().invoke(app, ["assess", str(tmp_path / "line.toml"), "--json"]).stdout)
    check = next(one for one in answer["checks"] if one["name"] == "max torque of shaft")
    assert check["proof"] == "proved" and check["value"] <= check["bound"] <= check["limit"]
    said = CliRunner().invoke(app, ["assess", str(tmp_path / "line.toml")]).output
    assert "satisfied, proved" in said and "steady motion" in said
