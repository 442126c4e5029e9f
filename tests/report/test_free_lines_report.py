"""Lines as engineers first wrote them: a 4x4 and a ship's shaft that are free–free, an engine held by its drive."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.modes.resonance_speeds import resonance_speeds
from trunnion.reporting.contents import gather
from trunnion.reporting.overview import at_speed, charted
from trunnion.reporting.overview_assessment import answer, asked, judged
from trunnion.reporting.overview_findings import remark_findings, response_findings
from trunnion.results.finding import Gravity
from trunnion.results.words import Words

LINES = Path(__file__).parents[1] / "data" / "lines"


def test_a_4x4_under_load_has_a_verdict() -> None:
    """1000 N m on two axles behind 41/10: the engine carries 10/41 of it, and every axle its own share."""
    line = tn.load(LINES / "4x4-free.toml").with_load("hill")
    found = tn.stability(line)
    assert found.verdict.name == "STABLE" and found.speed_sentence and found.response is not None
    assert found.response.torque_mean[0] == pytest.approx(-1000 * 10 / 41, rel=1e-4)
    motion = tn.periodic_response(line)
    assert motion.outcome.ok and motion.verdict.name == "STABLE"
    assert motion.torque_mean[0] == pytest.approx(-1000 * 10 / 41, rel=1e-3)
    with pytest.raises(tn.InputError, match=r"rear vehicle 146.34, front vehicle 97.561\) and nothing drives"):
        tn.periodic_response(line.replace("engine", drive_share=None))


def test_a_ship_line_has_a_verdict() -> None:
    """The propeller takes 4.31 (Ω/3.5)² on average, and a little more for its fluctuation; nothing drifts."""
    line = tn.load(LINES / "marine.toml")
    found = tn.stability(line)
    assert found.verdict.name == "STABLE" and not found.speed_sentence and found.response is not None
    assert found.response.torque_mean[-1] == pytest.approx(-4.31 * (tn.rpm(1800) / 3.5) ** 2, rel=1e-4)
    with pytest.raises(tn.InputError, match=r"3571.7 N m.*the drives to 3571 N m \(flywheel 3571\).*drive_share = 1"):
        tn.stability(line.replace("flywheel", drive_share=None, load_torque="-3571 N*m"))


def test_an_excitation_that_does_nothing_is_said() -> None:
    line = tn.load(LINES / "engine-held.toml")
    (finding,) = remark_findings(line)
    assert finding.gravity is Gravity.CAUTION
    assert finding.sentence.startswith("engine.excitation: does nothing, a ConstantSpeed holds its rotation; leave out")
    assert finding in tn.stability(line).findings and finding in tn.order_response(line, [100.0]).findings
    louder = line.replace("engine", excitation=[{"order": 2, "amplitude": 2000.0}])
    both = [tn.periodic_response(each, compare=False).torque_peak_to_peak for each in (line, louder)]
    np.testing.assert_allclose(*both, rtol=1e-9)
    assert not list(remark_findings(line.replace("engine", excitation=None)))


def test_a_resonance_beyond_the_range_is_named_where_it_raises_torques_inside() -> None:
    """The truck's joints force ω₃ at twice the speed above its range: the flank reaches in, and is named."""
    line = tn.load(Path(tn.__file__).parent / "driveline" / "starters" / "truck.toml")
    assembly = assemble(line)
    (finding,) = response_findings(assembly, resonance_speeds(assembly), line.operation.speed_range, Words("rpm"))
    third = tn.natural_frequencies(line).undamped_frequency[2] / 2 / tn.rpm(1)
    assert (
        "ω₃/2" in finding.sentence and f"{third:.4g} rpm" in finding.sentence and "above the range" in finding.sentence
    )
    narrow = (tn.rpm(600), tn.rpm(800))
    assert not any(
        "ω₃" in f.sentence for f in response_findings(assembly, resonance_speeds(assembly), narrow, Words("rpm"))
    )


@pytest.mark.slow
def test_the_report_of_a_bent_line_that_starts_free_says_what_would_help() -> None:
    """The clutch is tight at one speed: the report names a change, as of any other line."""
    shaken = [{"order": 2, "amplitude": 30.0}]
    line = tn.Driveline(
        [
            tn.Disk(inertia=0.35, name="engine", drive_share=1, excitation=shaken),
            tn.Shaft(stiffness=6e3, damping=6.0, name="clutch"),
            tn.HookeJoint(angle=0.05, name="joint"),
            tn.Disk(inertia=1.3, name="wheel", load_torque=40.0),
        ],
        limits=[tn.Limit(of="clutch", max_torque=150.0)],
        operation=tn.Operation(speed_range=(70.0, 75.0)),
    )  # fmt: skip
    contents = gather(at_speed(answer(judged(asked(line)))))
    assert contents.helped is not None and contents.helped.remedies
    assert any(s.startswith("max torque of clutch: ") for s in contents.helped.sentences)
    assert not any("What would help" in words for words in contents.left_out)


def coupled(*ends: tn.Disk | tn.ConstantSpeed) -> tn.Driveline:
    """A coupling that damps all frequencies alike, before an angled joint: no equations in time."""
    rubber = tn.Coupling(name="coupling", stiffness="8 kN*m/rad", relative_damping=0.8)
    return tn.Driveline(
        [
            *ends,
            rubber,
            tn.Disk(name="flange", inertia=0.4),
            tn.HookeJoint(name="joint", angle="8 deg"),
            tn.Shaft(name="tube", stiffness="20 kN*m/rad", damping=5.0),
            tn.Disk(name="pump", inertia=0.6, load_torque=50.0),
        ],
        limits=[tn.Limit(of="tube", max_torque="2 kN*m")],
        operation=tn.Operation(speed=tn.rpm(900), speed_range=[tn.rpm(600), tn.rpm(1500)], speed_unit="rpm"),
    )


@pytest.mark.parametrize("ends", [(tn.ConstantSpeed(),), (tn.Disk(inertia=1.0, drive_share=1.0),)])
def test_lines_that_damp_all_frequencies_alike_have_a_first_page(ends: tuple[tn.Disk | tn.ConstantSpeed, ...]) -> None:
    """Torques are judged, stability is not, and what has no equations in time is left out."""
    seen = at_speed(answer(judged(asked(coupled(*ends)))))
    assert seen.assessment.check("max torque of tube").status.value in ("satisfied", "exceeded")
    assert seen.stability is None and not seen.chartable and charted(seen).chart is None
    (said,) = [f.sentence for f in seen.findings if f.sentence.startswith("Parametric stability is not judged")]
    assert "coupling.relative_damping = 0.8" in said and "loss_factor_frequency" in said


def test_modes_that_need_the_same_check_are_said_together() -> None:
    """One caution for all modes that orders meet, however many they are."""
    line = tn.load(LINES / "4x4-free.toml")
    cautions = [f.sentence for f in answer(judged(asked(line))).findings if f.sentence.startswith("Separation of mode")]
    assert len(cautions) == 1 and cautions[0].startswith("Separation of modes 6, 7 and 8 is below 10 %: order 2 meets")
    assert cautions[0].count("a resonance needs limits of torque or stress: state them for") == 1


def test_lines_without_a_linear_response_are_reported_without_its_findings() -> None:
    """A free–free line with joint angles and has play: joints' resonances are left to its own motion, and nothing
    fails."""
    line = tn.Driveline(
        [
            tn.Disk(inertia=0.3, name="engine", drive_share=1),
            tn.Shaft(stiffness=6e3, damping=6.0, name="clutch"),
            tn.Disk(inertia=0.05, name="flange"),
            tn.HookeJoint(angle=0.1),
            tn.Shaft(stiffness=2e4, damping=4.0, name="tube"),
            tn.Disk(inertia=0.04, name="pinion"),
            tn.GearPair(teeth_in=11, teeth_out=41, module=5e-3, mesh_stiffness=3e8, mesh_damping=2e3, backlash=1e-4),
            tn.Disk(inertia=1.3, name="wheel", load_torque=140.0),
        ]
    )
    with pytest.raises(tn.InputError, match="stages or play"):
        tn.speed_sweep(line, [150.0])
    assembly = assemble(line)
    assert list(response_findings(assembly, resonance_speeds(assembly), (10.0, 2000.0), Words("rpm"))) == []


def test_a_ring_without_a_spring_leaves_open_what_it_leaves_open() -> None:
    """No periodic motion of a free–free line with joint angles is the only one: it is not judged, and nothing fails."""
    line = tn.Driveline(
        [
            tn.Disk(inertia=3.0, name="engine", drive_share=1, excitation=[{"order": 3, "amplitude": 100.0}]),
            tn.ViscousDamper(ring_inertia=0.4, damping=20.0, name="damper"),
            tn.Shaft(stiffness=2e4, damping=5.0, after="engine"),
            tn.Disk(inertia=0.5),
            tn.HookeJoint(angle="8 deg"),
            tn.Shaft(stiffness=4e4, damping=5.0, name="tube"),
            tn.Disk(inertia=2.0, viscous_load=1.0),
        ],
        limits=[tn.Limit(of="tube", vibratory_torque=400.0)],
        operation=tn.Operation(speed="900 rpm", speed_range=("600 rpm", "1200 rpm")),
    )
    found = tn.assess(line)
    for name in ("vibratory torque of tube", "parametric stability"):
        assert str(found.check(name).status) == "not judged" and "damper.stiffness" in found.check(name).because
    assert "Stability at the operating speed is not judged: damper.stiffness" in tn.report(line).html
