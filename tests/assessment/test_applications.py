"""Which rules decide in which application, and that those switched off stay aside, with their reasons."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import trunnion as tn
from trunnion.cli import app
from trunnion.design.assessment.check import Status, percent
from trunnion.design.assessment.joint_angles import TABLE_ANGLE, TABLE_SPEED
from trunnion.driveline.rules import APPLICATIONS, RULES, Weight, markdown
from trunnion.errors import InputRemark
from trunnion.reporting.overview_assessment import answer, asked, judged

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.toml"))
LINES = Path(__file__).parents[1] / "data" / "lines"
NONE = "none"
ALL = (NONE, "road", "steering", "pto", "mill", "ship", "industrial")
ALWAYS = dict.fromkeys(ALL, "decides")
VEHICLES = {
    NONE: "shown", "road": "decides", "steering": "does not apply", "pto": "does not apply", "mill": "does not apply",
    "ship": "shown", "industrial": "shown",
}  # fmt: skip
EXPECTED = {
    "own-limits": ALWAYS,
    "stability": ALWAYS,
    "fatigue": ALWAYS,
    "gear-hammer": ALWAYS,
    "din-740": ALWAYS,
    "coupling-temperature": ALWAYS,
    "brake-heat": ALWAYS,
    "converter-heat": ALWAYS,
    "gear-heat": ALWAYS,
    "damper-heat": ALWAYS,
    "pendulum-travel": ALWAYS,
    "slip-clutch": ALWAYS,
    "m68": ALWAYS,
    "spicer-angles": VEHICLES,
    "equal-angles": VEHICLES,
    "acceptance-accelerations": VEHICLES,
    "elbe-uniformity": VEHICLES | {"mill": "shown"},
    "bending": dict.fromkeys(ALL, "shown") | {"road": "decides"},
    "separation": dict.fromkeys(ALL, "shown") | {"industrial": "decides"},
}
GUIDELINES = [name for name, weights in EXPECTED.items() if weights is not ALWAYS]


def stated(application: str) -> str | None:
    return None if application == NONE else application


def test_the_table() -> None:
    """Rule by rule and application by application, as the page prints it."""
    assert tuple(RULES) == tuple(EXPECTED) and (NONE, *APPLICATIONS) == ALL
    for name, rule in RULES.items():
        assert {a: str(rule.weight(stated(a))) for a in ALL} == EXPECTED[name], name
        assert rule.guideline is (name in GUIDELINES)
        assert bool(rule.kept) is (name in ("own-limits", "stability", "fatigue"))
    assert markdown() in (ROOT / "docs" / "assess.md").read_text(encoding="utf-8")


def beyond_all(application: str, *off: str) -> tn.Driveline:
    """A line within its own limits and beyond every guideline; those in ``off`` are switched off, and that a ship has
    to name a shaft."""
    off = (*off, "m68") if application == "ship" else off
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(name="input", stiffness=5e4, damping=8.0),
            tn.Disk(inertia=0.05),
            tn.HookeJoint(name="front", angle="8 deg"),
            tn.Shaft(name="tube", outer_diameter="60 mm", length="2.4 m", material="steel", damping=8.0),
            tn.Disk(inertia=0.02),
            tn.HookeJoint(name="rear", angle="3 deg"),
            tn.Shaft(name="output", stiffness=3e4, damping=8.0),
            tn.Disk(inertia=0.5, load_torque=100.0),
        ],
        limits=[tn.Limit(of="Shaft *", max_torque="9 kN*m")],
        operation=tn.Operation(
            speed_range=["800 rpm", "3000 rpm"],
            application=stated(application),
            switched_off=[{"rule": name, "reason": f"{name} does not fit here"} for name in off],
        ),
    )


@pytest.fixture(scope="module")
def beyond() -> dict[str, tn.design.assessment.result.Assessment]:
    return {application: tn.assess(beyond_all(application)) for application in ALL}


@pytest.mark.parametrize("application", ALL)
def test_guidelines_decide_where_they_were_made_for(beyond, application) -> None:
    """The line is beyond every one of them; the verdict is that of those that decide."""
    found = beyond[application]
    by_rule: dict[str, set[tuple[Status, bool]]] = {}
    for check in found.checks:
        by_rule.setdefault(check.rule.name, set()).add((check.status, check.decides))
    for name in GUIDELINES:
        weight = EXPECTED[name][application]
        if weight == "does not apply":
            assert by_rule[name] == {(Status.NOT_APPLICABLE, True)}, name
            assert f"not made for {APPLICATIONS[application]}" in found.check(name).because
        else:
            assert (Status.EXCEEDED, weight == "decides") in by_rule[name], name
    deciding = [name for name in GUIDELINES if EXPECTED[name][application] == "decides"]
    assert found.verdict is (Status.EXCEEDED if deciding else Status.SATISFIED)
    assert found.binding.decides and (found.binding.rule.name in deciding) is bool(deciding)
    assert [c.decides for c in found.checks if c.judged] == sorted(c.decides for c in found.checks if c.judged)[::-1]


@pytest.mark.parametrize("alone", GUIDELINES)
def test_each_guideline_decides_alone(beyond, alone) -> None:
    """With all the others switched off, in every application where it decides and in none where it does not."""
    others = [name for name in GUIDELINES if name != alone]
    for application in (NONE, *(a for a, weight in EXPECTED[alone].items() if weight == "decides")):
        found = tn.assess(beyond_all(application, *others))
        decides = EXPECTED[alone][application] == "decides"
        assert found.verdict is (Status.EXCEEDED if decides else Status.SATISFIED), application
        assert (found.binding.rule.name == alone) is decides
        assert {c.rule.name for c in found.checks if c.because.startswith("switched off: ")} == set(others)


def test_what_does_not_decide_does_not_read_as_if_it_did(beyond) -> None:
    """No word of the verdict, a table, a margin or a finding says "exceeded" of a guideline that is shown only."""
    line, found = beyond_all(NONE), beyond[NONE]
    assert found.sentence.startswith("satisfied: ")
    assert (
        "; beyond guidelines that are shown only (" in found.sentence
        and "state application in [opera" in found.sentence
    )
    shown = [row for row, check in zip(found.table(), found.checks, strict=True) if not check.decides]
    assert {row["status"] for row in shown} == {"beyond guideline", "within guideline"}
    assert not any("exceeded" in f"{row['status']} {row['margin']} {row['because']}" for row in shown)
    said = [str(finding) for finding in answer(judged(asked(line))).findings]
    assert not any("exceeded" in sentence or sentence.startswith("danger") for sentence in said)
    assert any(sentence.startswith("caution: Beyond guidelines that are shown only: ") for sentence in said)
    road = beyond["road"]
    assert "guidelines that are shown only" not in road.sentence and " (a guideline), " in road.sentence
    assert found.rests_on.startswith("No application is stated: guidelines are shown and do not decide; state app")
    assert "(propeller shafts of road vehicles): the guidelines spicer-angles, equal-angles" in road.rests_on
    assert "no guideline decides" in beyond["mill"].rests_on


def test_pictures_and_envelopes_keep_guidelines_apart(beyond) -> None:
    """Margins of what decides stand first, of what is shown with a word; an envelope says the same as ``assess``."""
    line = beyond_all(NONE)
    other = line.replace("front", angle="7 deg")
    picture = tn.compare(line, other, (tn.rpm(800), tn.rpm(1000))).plot()
    names = [" ".join(label.get_text().split()) for label in picture.get_yticklabels()]
    shown = [name.endswith(" (guideline, shown)") for name in names]
    assert "angle of front (guideline, shown)" in names and "max torque of tube" in names and shown == sorted(shown)
    whole = tn.envelope(line)
    assert whole.verdict is Status.SATISFIED and whole.sentence.startswith("satisfied over 1 places: max torque of")
    assert "  beyond guideline: uniformity: " in str(whole) and "exceeded" not in str(whole)


def condemned_by(application: str, rule: str, line: tn.Driveline) -> None:
    where = tn.Operation(speed="900 rpm", speed_range=["600 rpm", "1000 rpm"], application=stated(application))
    found = tn.assess(line.but(operation=where))
    assert found.binding.rule.name == rule and found.verdict is Status.EXCEEDED


def test_limits_ratings_and_physics_decide() -> None:
    """Each exceeded alone, in an application; the table has the same weight in all."""
    for (rule, line), application in zip(exceeded_alone().items(), itertools.cycle(ALL), strict=False):
        condemned_by(application, rule, line)


@pytest.mark.slow
@pytest.mark.parametrize("application", ALL)
def test_limits_ratings_and_physics_decide_in_every_application(application: str) -> None:
    for rule, line in exceeded_alone().items():
        condemned_by(application, rule, line)


def exceeded_alone() -> dict[str, tn.Driveline]:
    """By rule a line that it alone condemns."""
    engine = tn.Disk(inertia=1.2, drive_share=1, excitation=[{"order": 3, "amplitude": 400.0}])
    load = tn.Disk(inertia=2.0, load_torque=200.0)
    wide = [tn.Limit(of="shaft", max_torque=1e6)]
    shaft = tn.Shaft(name="shaft", stiffness=4e4, damping=20.0)
    soft = tn.Coupling(name="shaft", stiffness=4e4, damping=20.0, vibratory_torque=20.0)
    drags = tn.Brake(name="drags", inertia=0.1, torque=1.0, heat_rating=1.0)
    points = ((0, 2, 0.08), (0.8, 1.1, 0.06), (1, 1, 0))
    oil = tn.TorqueConverter(
        curves=[{"speed_ratio": v, "torque_ratio": m, "capacity": k} for v, m, k in points],
        inertia_in=0.2, heat_rating=1.0, name="oil",
    )  # fmt: skip
    warm = tn.Coupling(
        name="shaft", stiffness=4e4, damping=20.0, temperature=300.0, thermal_resistance=1e4, ambient_temperature=300.0,
        highest_temperature=300.01,
    )  # fmt: skip
    hot = tn.ViscousDamper(name="hot", ring_inertia=0.2, damping=20.0, heat_rating=0.1)
    swings = tn.CentrifugalPendulum(name="swings", mass=1.0, radius=0.1, order=3.1, largest_travel=1e-4, damping=0.1)
    tube = tn.Shaft(
        name="shaft", outer_diameter="60 mm", length="1 m", material="steel", tensile_strength="600 MPa", damping=20.0
    )
    teeth = tn.GearPair(name="gears", teeth_in=20, teeth_out=20, module="3 mm", mesh_stiffness=2e8, mesh_damping=500.0)
    idle = tn.Disk(inertia=2.0, load_torque=1.0)
    tight = [tn.Limit(of="shaft", max_torque=100.0)]
    with pytest.warns(InputRemark, match="feeds energy"):
        fed = [tn.ConstantSpeed(), tn.Shaft(name="shaft", stiffness=4e4, damping=-1.0), tn.Disk(inertia=1.0)]
    return {
        "own-limits": tn.Driveline([engine, shaft, load], limits=tight),
        "din-740": tn.Driveline([engine, soft, load], limits=wide),
        "coupling-temperature": tn.Driveline([engine, warm, load], limits=wide),
        "brake-heat": tn.Driveline([engine, shaft, load, drags], limits=wide),
        "converter-heat": tn.Driveline([engine, shaft, oil, load], limits=[*wide, tn.Limit(of="oil", max_torque=1e6)]),
        "gear-heat": tn.Driveline(
            [engine, shaft, tn.Disk(inertia=0.1), tn.Ratio(ratio=2, efficiency=0.9, heat_rating=1.0), load], limits=wide
        ),
        "damper-heat": tn.Driveline([engine, hot, shaft, load], limits=[*wide, tn.Limit(of="hot", max_torque=1e6)]),
        "m68": tn.Driveline([engine, tube, load], limits=[tn.Limit(of="shaft", ship_shaft="slot", max_torque=1e6)]),
        "gear-hammer": tn.Driveline(
            [engine, shaft, tn.Disk(inertia=0.1), teeth, idle], limits=[*wide, tn.Limit(of="gears", max_torque=1e6)]
        ),
        "pendulum-travel": tn.Driveline(
            [engine, swings, shaft, load], limits=[*wide, tn.Limit(of="swings", max_torque=1e6)]
        ),
        "slip-clutch": tn.Driveline(
            [engine, shaft, tn.Disk(inertia=0.1), tn.SlipClutch(name="clutch", torque=205.0), load], limits=wide
        ),
        "stability": tn.Driveline(fed, limits=wide),
    }


def test_a_ship_that_names_no_shaft_is_not_judged() -> None:
    line = exceeded_alone()["din-740"].replace("shaft", vibratory_torque=1e5)
    ship = line.but(operation=tn.Operation(speed=90.0, application="ship"))
    found = tn.assess(ship)
    assert found.verdict is Status.NOT_JUDGED and 'ship_shaft = "flange"' in found.check("IACS UR M68").because
    off = ship.operation.but(switched_off=[tn.SwitchedOff(rule="m68", reason="a pump aboard, no propulsion")])
    assert tn.assess(ship.but(operation=off)).verdict is Status.SATISFIED
    assert tn.assess(line.but(operation=tn.Operation(speed=90.0))).verdict is Status.SATISFIED


def test_reasons_are_printed_wherever_a_verdict_is(tmp_path: Path) -> None:
    reason = "measured <b>on the vehicle</b>"
    line = beyond_all("road")
    off = [tn.SwitchedOff(rule="bending", reason=reason), tn.SwitchedOff(rule="gear-hammer", reason="no teeth")]
    line = line.but(operation=line.operation.but(switched_off=off, speed="1000 rpm"))
    found = tn.assess(line)
    assert f"  switched off: bending: {reason}" in str(found).splitlines()
    assert found.data.attrs["application"] == "road"
    assert list(np.atleast_1d(found.data.attrs["switched_off"])) == [f"bending: {reason}", "gear-hammer: no teeth"]
    check = found.check("bending")
    assert (
        check.status is Status.NOT_APPLICABLE and check.because == f"switched off: {reason}" and np.isnan(check.value)
    )
    assert "bending critical speed of tube" not in [c.name for c in found.checks]
    calm = one_joint(1.0, 1000.0)
    calm = calm.but(operation=calm.operation.but(switched_off=off))
    file, report = tmp_path / "line.toml", tmp_path / "page.html"
    tn.dump(calm, file)
    said = CliRunner().invoke(app, ["analyze", str(file), "--points", "4x3", "-o", str(report)]).stdout
    assert f"switched off: bending: {reason}" in said
    page = report.read_text(encoding="utf-8")
    assert "measured &lt;b&gt;on the vehicle&lt;/b&gt;" in page and reason not in page
    tn.dump(line, file)
    text = CliRunner().invoke(app, ["assess", str(file)]).stdout
    assert f"bending: {reason}" in text and "Application road (propeller shafts of road vehicles)" in text
    content = json.loads(CliRunner().invoke(app, ["assess", str(file), "--json"]).stdout)
    assert content["application"] == "road"
    assert content["switched_off"][0] == {"rule": "bending", "reason": reason}
    by_name = {one["name"]: one for one in content["checks"]}
    assert (by_name["uniformity"]["rule"], by_name["uniformity"]["decides"]) == ("elbe-uniformity", True)
    assert by_name["separation of modes"]["decides"] is False


def test_rules_switched_off_are_not_searched_for_remedies() -> None:
    """A remedy is for what decides; what is shown can be asked for by its name."""
    line = tn.Driveline(
        [
            tn.Disk(name="motor", inertia=0.2, drive_share=1, excitation=[{"order": 2, "amplitude": 20.0}]),
            tn.Shaft(name="shaft", stiffness=1e4, damping=5.0),
            tn.Disk(name="pump", inertia=0.8, load_torque=200.0),
        ],
        limits=[tn.Limit(of="shaft", max_torque=1e4)],
    )
    speeds = (115.0, 120.0)  # order 2 at 4 to 8 % below the mode of 250 rad/s
    assert tn.remedies(line, speeds).checks == ()
    name = "separation of mode 2"
    asked = tn.remedies(line, speeds, checks=[name], most=1)
    assert asked.checks == (name,) and len(asked.remedies) == 1
    industrial = line.but(operation=tn.Operation(application="industrial"))
    helped = tn.remedies(industrial, speeds, most=1)
    assert helped.checks == (name,) and helped.assessment.verdict is Status.EXCEEDED
    (one,) = helped.remedies
    owner, _, key = one.variable.rpartition(".")
    assert tn.assess(industrial.replace(owner, **{key: one.after}), speeds).verdict is Status.SATISFIED is one.verdict


# ---- Spicer's angles -------------------------------------------------------------------------------------------------


def one_joint(degrees: float, rpm: float) -> tn.Driveline:
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1e5, damping=20.0),
            tn.Disk(inertia=0.02),
            tn.HookeJoint(angle=f"{degrees} deg", name="joint"),
            tn.Shaft(stiffness=1e5, damping=20.0),
            tn.Disk(inertia=0.1),
        ],
        operation=tn.Operation(speed=f"{rpm} rpm", application="road"),
    )


@pytest.mark.parametrize(
    ("degrees", "margin"),
    # 2400 rpm lies a fifth of the way from 2500 (7 deg) to 2000 rpm (8 deg 40'): 7 + 0.2 * 1.6667 = 7.3333 deg
    [(3.0, 0.5909), (3.5, 0.5227), (7.3, 0.00455), (7.4, -0.00909), (12.0, -0.6364)],
)
def test_angles_at_2400_rpm(degrees: float, margin: float) -> None:
    check = tn.assess(one_joint(degrees, 2400.0)).check("angle of joint")
    assert check.margin == pytest.approx(margin, abs=1e-4)
    assert check.status is (Status.SATISFIED if margin > 0 else Status.EXCEEDED)


def test_the_table_of_angles_holds_one_acceleration() -> None:
    """The rows of two sources are one table: β²ω² is 1000 rad/s² from 1500 to 3500 rpm, and less at either end."""
    acceleration = dict(zip(np.round(TABLE_SPEED * 30 / np.pi).tolist(), TABLE_ANGLE**2 * TABLE_SPEED**2, strict=True))
    for rpm in (1500.0, 2000.0, 2500.0, 3000.0, 3500.0):
        assert acceleration[rpm] == pytest.approx(1000.0, rel=0.03), rpm
    assert all(acceleration[rpm] < 1000.0 for rpm in (500.0, 1000.0, 4000.0, 4500.0, 5000.0))


# Below the table, at its first row, between two rows and above it.
@pytest.mark.parametrize(
    "rpm",
    [120.0, 499.0, 500.0, 3501.0, 5001.0]
    + [pytest.param(rpm, marks=pytest.mark.slow) for rpm in (1750.0, 2400.0, 3499.0, 5000.0, 8000.0)],  # type: ignore[list-item]
)
def test_a_steeper_joint_is_never_judged_more_kindly(rpm: float) -> None:
    """From angle to angle: within, then beyond; below the table's first row, then not judged."""
    found = [tn.assess(one_joint(d, rpm)).check("angle of joint").status for d in np.arange(0.5, 14.0, 0.75)]
    turns = [status for k, status in enumerate(found) if not k or status is not found[k - 1]]
    last = Status.NOT_APPLICABLE if rpm < 500.0 else Status.EXCEEDED
    assert turns == [Status.SATISFIED, last]


def test_equal_within_one_degree_up_to_rounding() -> None:
    """5° and 4° differ by 1 + 2e-16 degrees or 1 − 2e-16, which is neither beyond nor "2.22e-14 % free"."""
    for first, second in ((5.0, 4.0), (4.1, 3.1), (3.3, 2.3), (8.2, 7.2), (2.7, 1.7)):
        line = beyond_all(NONE).replace_all({"front": {"angle": f"{first} deg"}, "rear": {"angle": f"{second} deg"}})
        check = tn.assess(line, (100.0, 100.0)).check("equal joint angles")
        assert check.status is Status.SATISFIED and check.because.endswith("deg, 0 % free"), (first, second)
    assert (percent(2e-16), percent(-2e-16), percent(0.5, binding=False)) == ("0 % free", "0 % free", "50 % free")


# ---- What is shipped -------------------------------------------------------------------------------------------------


QUICK = ("gear-stage", "pto-shaft", "six-cylinder-ship", "steering-column")
"""One of each kind: gears, joints in a row, an engine with its damper, joints in space."""


@pytest.mark.parametrize(
    "path",
    [pytest.param(path, id=path.stem, marks=[] if path.stem in QUICK else [pytest.mark.slow]) for path in EXAMPLES],
)
def test_an_example_has_a_whole_verdict(path: Path) -> None:
    """It states application and limits; nothing that decides is left open, and every margin is more than a hair."""
    line = tn.load(path)
    assert line.operation and line.operation.application and line.limits
    found = tn.assess(line)
    assert not [check.name for check in found.checks if check.missing]
    assert found.verdict is (Status.EXCEEDED if path.stem == "gear-stage" else Status.SATISFIED), found.sentence
    assert all(abs(check.spare) > 0.05 for check in found.checks if check.decides and check.judged)


def test_the_gear_stage_is_satisfied_with_what_its_file_names() -> None:
    line = tn.load(ROOT / "examples" / "gear-stage.toml")
    assert tn.assess(line.replace("joint", angle="1.5 deg")).verdict is Status.SATISFIED


@pytest.mark.slow
def test_the_search_finds_what_helps_the_gear_stage() -> None:
    line = tn.load(ROOT / "examples" / "gear-stage.toml")
    helped = tn.remedies(line, checks=["gear hammer in gears"], most=1)
    assert helped.sentences[0].startswith(
        "gear hammer in gears: angle of joint at 1.5 deg instead of 8 deg brings it from"
    )
    assert helped.remedies[0].verdict is Status.SATISFIED


@pytest.mark.slow
def test_the_take_off_grows_unstable_where_it_is_raised() -> None:
    found = tn.envelope(tn.load(ROOT / "examples" / "pto-shaft.toml"), points=2)
    assert found.verdict is Status.EXCEEDED
    assert found.sentence.startswith("exceeded over 4 places: parametric stability binds at hitch 500 mm")


SLOW = ("4x4-free", "car", "marine", "tractor")
"""Free–free lines with joint angles, every speed of which takes a motion of its own, and a long one."""


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, id=path.stem, marks=[pytest.mark.slow] if path.stem in SLOW else [])
        for path in sorted(LINES.glob("*.toml"))
    ],
)
@pytest.mark.filterwarnings("ignore::trunnion.errors.InputRemark")
def test_lines_of_first_users_say_what_is_missing(path: Path) -> None:
    """One key an element is all that is asked for; with it every check that decides is judged."""
    line = tn.load(path)
    found = tn.assess(line)
    missing = {check.name: check.because for check in found.checks if check.missing}
    assert set(missing) <= {"torque without limit"} and all("; " in because for because in missing.values())
    low, high = line.operation.speed_range or 2 * (line.operation.speed,)
    covered = [check.covered for check in found.checks if check.covered]
    assert all(one[0][0] <= low * (1 + 1e-9) and one[-1][1] >= high * (1 - 1e-9) for one in covered)
    named = missing["torque without limit"].partition(": ")[0].split(", ") if missing else []
    whole = line.but(limits=[*line.limits, *(tn.Limit(of=name, max_torque=1e7) for name in named)])
    judged = tn.assess(whole)
    assert not [check.name for check in judged.checks if check.missing]
    assert judged.verdict in (Status.SATISFIED, Status.EXCEEDED)


def test_weights_are_words() -> None:
    assert [str(weight) for weight in Weight] == ["decides", "shown", "does not apply"]
