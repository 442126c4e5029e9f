"""Certificates about the periodic motion that a driven, loaded line with joint angles makes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from oracles.attacked_driven_boxes import attack_boxes, attack_driven
from oracles.attacked_own_boxes import value
from oracles.loaded_pair import PATHS, TURN, Pair
from typer.testing import CliRunner

import trunnion as tn
from trunnion.cli import app
from trunnion.floquet.certificate import own_judge
from trunnion.floquet.certificate.box_coefficients import NumberRange
from trunnion.floquet.certificate.own_equations import MotionEquations, MotionWaves
from trunnion.floquet.certificate.own_judge import OwnMotionLine, judged_motion
from trunnion.floquet.certificate.waves import Wave
from trunnion.floquet.tolerance.spread import read_tolerances
from trunnion.results.verdict import Verdict

Array = np.ndarray
DAMPED = Pair(c_1=8.0, c_2=8.0, load=1000.0)
SHARES = {"Shaft 2.stiffness": 0.01, "HookeJoint 2.angle": 0.01, "Disk 2.load_torque": 0.02}
SPEED = 77.25
BORDER = 2.72367
"""Damping times this is the border of stability of ``Pair()`` about its motion at ``SPEED``."""


def box(
    pair: Pair = DAMPED, shares: dict[str, float] = SHARES, width: float = 0.01, speed: float = SPEED
) -> tuple[MotionEquations, MotionWaves, list[NumberRange], tuple[float, float]]:
    """Equations of a box, nearly its motions, its tolerances and speeds."""
    line = OwnMotionLine(pair.line)
    read = read_tolerances(line.assembly, shares) if shares else ()
    ranges = [NumberRange(s.label, s.columns, s.low, s.high) for s in read]
    speeds = speed * (1 - width), speed * (1 + width)
    found = line.begun(speeds, ranges)
    assert found is not None
    return *found, ranges, speeds


def pair_at(ranges: list[NumberRange], p: Array, pair: Pair = DAMPED) -> Pair:
    """The line at tolerances ``p[1:]``."""
    return pair.at({
        one.label: (one.low + one.high) / 2 + (one.high - one.low) / 2 * float(at)
        for one, at in zip(ranges, p[1:], strict=True)
    })  # fmt: skip


def speed_at(speeds: tuple[float, float], p: Array) -> float:
    return sum(speeds) / 2 + (speeds[1] - speeds[0]) / 2 * float(p[0])


def states(own: MotionEquations, motion: MotionWaves, phi: float, p: Array, pair: Pair) -> Array:
    """Twists and speeds in the middle of a tube: twists count from those of the loads."""
    found = np.array([value(one, phi, p) for one in motion.states])
    found[:2] += [value(t, 0.0, p) / k for t, k in zip(own.co.torque, (pair.k_1, pair.k_2), strict=True)]
    return found


# What encloses contains


def test_rates_and_slopes_contain_the_equations() -> None:
    """At corners and inside of the box, anywhere in a tube around the motion, at speeds from end to end."""
    own, motion, ranges, speeds = box()
    rng, radii = np.random.default_rng(1), np.array([1e-4, 2e-4, 0.02, 0.03])
    found = own.rates(motion.widened(radii))
    for k in range(12):
        p = rng.choice([-1.0, 1.0], 1 + len(ranges)) if k % 2 else rng.uniform(-1, 1, 1 + len(ranges))
        phi, pair, speed = rng.uniform(0, TURN), pair_at(ranges, p), speed_at(speeds, p)
        x = states(own, motion, phi, p, pair) + rng.uniform(-1, 1, 4) * radii
        rates = pair.rates(phi, x, speed)
        steps = [np.eye(4)[j] * (1e-5 if j < 2 else 1e-3) for j in range(4)]
        slopes = [(pair.rates(phi, x + h, speed) - pair.rates(phi, x - h, speed)) / (2 * h.sum()) for h in steps]
        for i in range(4):
            assert abs(rates[i] - value(found.rates[i], phi, p)) <= found.rates[i].rest * (1 + 1e-9) + 1e-10
            for j in range(4):
                known = found.slopes.get((i, j))
                off = abs(slopes[j][i] - (value(known, phi, p) if known else 0.0))
                assert off <= (known.rest if known else 0) + 1e-6 * (1 + abs(slopes[j][i]))


@pytest.mark.parametrize(("shares", "width"), [({}, 0.02), (SHARES, 0.01)])
def test_the_tube_holds_the_motion_which_decays_as_proved(shares: dict[str, float], width: float) -> None:
    """At corners, and at speeds from one end to the other."""
    own, begun, ranges, speeds = box(shares=shares, width=width)
    found = judged_motion(own, begun, speeds)
    assert found is not None and found.verdict.proved and found.tube is not None
    tube, rng, nearest = found.tube, np.random.default_rng(2), np.inf
    for at in (-1.0, -0.35, 0.6, 1.0):
        p = np.concatenate([[at], rng.choice([-1.0, 1.0], len(ranges))])
        pair, speed = pair_at(ranges, p), speed_at(speeds, p)
        path, multipliers = pair.motion(speed, pair.rotations(0.0, states(own, tube, 0.0, p, pair)), 33)
        for phi, state in zip(np.linspace(0, TURN, 33), path, strict=True):
            off = np.abs(pair.twists(phi, state) - states(own, tube, phi, p, pair))
            assert np.all(off <= np.array([one.rest for one in tube.states]) + 1e-9 * np.abs(state))
        rate = -np.log(np.abs(multipliers).max()) * speed / TURN
        assert rate >= found.verdict.decay * (1 - 1e-6)
        nearest = min(nearest, rate / found.verdict.decay)
    assert nearest < 1.5


def test_the_first_parameter_takes_the_speed_from_end_to_end() -> None:
    own, _, _, speeds = box(width=0.1, shares={})
    ends = [value(own.co.speed, 0.0, np.array([at])) for at in (-1.0, 1.0)]
    assert ends[0] <= speeds[0] and ends[1] >= speeds[1]
    found = tn.certify_stability(DAMPED.line, {}, (70.0, 90.0), about_steady_state=True)
    order = np.argsort(found.proved_low[:, 0])
    low, high = found.proved_low[order, 0], found.proved_high[order, 0]
    assert low[0] == 70.0 and high[-1] == 90.0 and np.all(low[1:] <= high[:-1])


# Seeds of lines of which some boxes are proved; of 160 lines more that were attacked so none was false.
@pytest.mark.parametrize("seed", [113, *(pytest.param(k, marks=pytest.mark.slow) for k in (1, 4, 104, 116, 120, 144))])
def test_what_is_proved_near_the_boundary_holds_at_corners_and_inside(seed: int) -> None:
    assert attack_driven(seed, 6, 4).proved >= 2


def test_ratios_branches_and_loads_that_go_with_the_speed_are_followed() -> None:
    """A second joint at half the speed behind gears, whose teeth are springs, a propeller's load, a branch that a load
    drives."""
    gears = tn.GearPair(
        teeth_in=20, teeth_out=40, module=0.01, mesh_stiffness=2e7, mesh_damping=5e3, name="gears", after="d1"
    )
    line = tn.Driveline([
        tn.ConstantSpeed(name="d0"), tn.HookeJoint(angle=0.3, name="j1"),
        tn.Shaft(stiffness=8e3, damping=12.0, fork_offset=0.4, name="s1"), tn.Disk(inertia=0.5, name="d1"),
        gears, tn.Disk(inertia=0.3, name="d2"), tn.HookeJoint(angle=0.25, plane=0.7, name="j2"),
        tn.Shaft(stiffness=2e4, damping=40.0, name="s2"),
        tn.Disk(inertia=1.2, load_torque=80.0, viscous_load=3.0, quadratic_load=0.5, name="d3"),
        tn.HookeJoint(angle=0.2, plane=1.1, after="d1", name="j3"), tn.Shaft(stiffness=6e3, damping=9.0, name="s3"),
        tn.Disk(inertia=0.4, load_torque=-150.0, name="d4"),
    ])  # fmt: skip
    shares = {"s2.stiffness": 0.02, "d3.quadratic_load": 0.05, "j2.plane": 0.01}
    found = attack_boxes(line, [((58.0, 62.0), shares), ((90.0, 95.0), {})], 6, np.random.default_rng(8), 2 * np.pi)
    assert found.proved == 2


# What is not to be proved is not


def test_a_line_that_is_stable_about_its_static_twist_alone_is_the_counterexample() -> None:
    """It decays by 0.003 1/s about the one and grows by 0.16 about the other."""
    pair, ends = Pair(), (SPEED * (1 - 1e-6), SPEED * (1 + 1e-6))
    assert pair.growth(SPEED) == pytest.approx(0.160, abs=1e-3)
    assert tn.certify_stability(pair.line, {}, ends).verdict == "proved stable"
    found = tn.certify_stability(pair.line, {}, ends, about_steady_state=True)
    assert found.verdict == "counterexample" and found.counterexample is not None and found.unstable_line is not None
    at = found.counterexample["speed"]
    assert ends[0] <= at <= ends[1]
    assert tn.stability(found.unstable_line, at, about_steady_state=True).verdict is Verdict.UNSTABLE
    assert tn.stability(found.unstable_line, at).verdict is Verdict.STABLE
    assert str(found).endswith("about the line's own periodic motion")


@pytest.mark.parametrize(("factor", "verdict"), [(0.99, "counterexample"), (1.1, "proved stable")])
def test_on_either_side_of_the_border(factor: float, verdict: str) -> None:
    pair = Pair(c_1=0.35 * BORDER * factor, c_2=0.25 * BORDER * factor)
    assert (pair.growth(SPEED) > 0) == (verdict == "counterexample")
    found = tn.certify_stability(pair.line, {}, (SPEED * (1 - 1e-6), SPEED * (1 + 1e-6)), about_steady_state=True)
    assert found.verdict == verdict
    if verdict == "proved stable":
        assert 0.2 * -pair.growth(SPEED) < found.decay <= -pair.growth(SPEED) * (1 + 1e-4)


def test_a_tolerance_that_reaches_across_the_border_is_not_proved() -> None:
    """The counterexample is within it, by its own equations."""
    pair = Pair(c_1=0.35 * BORDER, c_2=0.25 * BORDER * 1.3)
    given = {"Shaft 2.damping": ("range", 0.25 * BORDER * 0.5, 0.25 * BORDER * 2.0)}
    found = tn.certify_stability(pair.line, given, (SPEED, SPEED * (1 + 1e-7)), about_steady_state=True, most_boxes=40)
    assert found.verdict == "counterexample" and found.counterexample is not None
    values = {path: at for path, at in found.counterexample.items() if path in PATHS}
    assert pair.at(values).growth(found.counterexample["speed"]) > 0


def test_a_tube_that_is_too_small_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    own, motion, _, speeds = box()
    monkeypatch.setattr(own_judge, "WIDER", 0.9)
    found = judged_motion(own, motion, speeds)
    assert found is not None and not found.verdict.proved and found.tube is None


@pytest.mark.parametrize("off", [1e-7, 1e-5, 1e-3])
def test_a_tube_about_a_wrong_motion_holds_the_right_one_or_is_refused(off: float) -> None:
    """A twist is off by waves of the joint's order."""
    own, motion, _, speeds = box(shares={}, width=1e-3)
    parts = motion.twist[1].parts.copy()
    parts[0, [own.last - 1, own.last + 1]] += off / 2
    wrong = MotionWaves((motion.twist[0], Wave(parts, 0.0, own.terms)), motion.speed, motion.drive)
    found = judged_motion(own, wrong, speeds)
    assert found is not None and found.verdict.proved == (off < 1e-4)
    if found.tube is not None:
        assert found.tube.twist[1].rest > off


# Springs with stages


def test_a_spring_that_stays_in_its_stage_moves_as_one_that_has_no_other() -> None:
    """Under 1000 N m of load in a stage that begins at 90 N m; one that the swing leaves is refused by name."""
    small = {"angle_1": 0.05, "angle_2": 0.05, "c_1": 8.0, "c_2": 8.0, "load": 1000.0}
    line, name, speeds = Pair(**small).line, "Shaft 2", (76.0, 77.0)

    def staged(knot: float) -> tn.Driveline:
        spring = tn.PiecewiseShaft.symmetric([(3000.0, knot), (9000.0, None)], damping=8.0, name=name)
        return tn.Driveline([spring if k == 5 else one for k, one in enumerate(line.elements)])

    found = tn.certify_stability(staged(0.03), {}, speeds, about_steady_state=True)
    same = tn.certify_stability(Pair(k_2=9000.0, **small).line, {}, speeds, about_steady_state=True)
    assert found.verdict == same.verdict == "proved stable"
    assert found.decay == pytest.approx(same.decay, rel=0.02)
    assert found.stages == (f"{name} works in its stage 1 of 3, up to -90 N m",)
    with pytest.raises(tn.InputError, match=f"{name}: leaves its stage at .* rad/s: its twist goes from"):
        tn.certify_stability(staged(0.3333), {}, speeds, about_steady_state=True)


# From a user's side


def test_tolerances_of_five_percent_are_proved_over_the_running_range() -> None:
    pair = Pair(c_1=8.0, c_2=8.0, load=150.0, angle_1=0.2, angle_2=0.2)
    given = {"Shaft 2.stiffness": 0.05, "Disk 2.load_torque": 0.05}
    found = tn.certify_stability(pair.line, given, (70.0, 100.0), about_steady_state=True)
    assert found.verdict == "proved stable" and found.data.attrs["about_own_motion"] and found.boxes < 20
    assert "every line within 2 tolerances" in str(found)
    assert "about the line's own periodic motion, proved to exist" in str(found)


STRAIGHT = Pair(angle_1=0.0, angle_2=0.0).line
BENT = DAMPED.line
REFUSED = [
    pytest.param(STRAIGHT, {}, (20.0, 30.0), "has straight joints, and turns with its shafts twisted", id="straight"),
    pytest.param(
        tn.Driveline([
            tn.Disk(inertia=1.0, load_torque=-5.0), tn.Shaft(stiffness=1e4), tn.Disk(inertia=1.0, load_torque=5.0),
        ]),
        {}, (20.0, 30.0), "has straight joints", id="free and straight",
    ),
    pytest.param(BENT, {}, (0.0, 30.0), "must", id="speed 0"),
    pytest.param(BENT, {"HookeJoint 1.friction": 0.1}, (20.0, 30.0), "friction", id="no such number"),
    pytest.param(
        tn.Driveline([*BENT.elements, tn.CentrifugalPendulum(
            mass=1.0, radius=0.2, order=2.0, name="pendulum")]),
        {}, (20.0, 30.0), "pendulum.*is not enclosed", id="pendulum",
    ),
    pytest.param(
        tn.Driveline([*BENT.elements, tn.GearPair(
            teeth_in=20, teeth_out=30, module=0.01, mesh_stiffness=1e8, name="gears",
            stiffness_variation=[{"share": 0.1}]), tn.Disk(inertia=0.1)]),
        {}, (20.0, 30.0), "gears.*teeth whose stiffness varies are not enclosed", id="teeth",
    ),
    pytest.param(
        tn.Driveline([*BENT.elements[:3], tn.Shaft(stiffness=1e4, name="second"), *BENT.elements[3:]]),
        {}, (20.0, 30.0), "second.*several springs in series.*write them as one Shaft", id="series",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("line", "given", "speeds", "message"), REFUSED)
def test_what_is_refused(line: tn.Driveline, given: dict, speeds: tuple[float, float], message: str) -> None:
    with pytest.raises(tn.InputError, match=message):
        tn.certify_stability(line, given, speeds, about_steady_state=True)


def test_an_angle_that_scatters_about_straight_bends_the_line() -> None:
    """Its middle is straight, and neither refused nor without a motion."""
    line = Pair(c_1=8.0, c_2=8.0, angle_1=0.0, angle_2=0.0, load=100.0).line
    given = {"HookeJoint 1.angle": ("range", 0.0, 0.05)}
    found = tn.certify_stability(line, given, (60.0, 61.0), about_steady_state=True)
    assert found.verdict == "proved stable" and found.about_own_motion


def test_the_command_takes_the_option(tmp_path: Path) -> None:
    file = tmp_path / "line.toml"
    tn.dump(DAMPED.line, file)
    asked = ["certify-stability", str(file), "--speed", "76rad/s:78rad/s", "--about-steady-state"]
    done = CliRunner().invoke(app, asked)
    assert done.exit_code == 0, done.output
    assert "proved stable" in done.output and "about the line's own periodic motion, proved to exist" in done.output
    tn.dump(STRAIGHT, file)
    refused = CliRunner().invoke(app, asked)
    assert refused.exit_code == 2 and "has straight joints" in refused.output
