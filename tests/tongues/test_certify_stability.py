"""Certificates: what encloses contains, what is proved decays as it is said to, counterexamples are ones."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

import trunnion as tn
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.linear import line_matrices
from trunnion.floquet.certificate.box_coefficients import NumberRange
from trunnion.floquet.certificate.box_equations import BoxMatrix, box_matrix
from trunnion.floquet.certificate.certify import proved_over
from trunnion.floquet.certificate.judge import judge
from trunnion.floquet.certificate.requirements import require_linear
from trunnion.floquet.certificate.waves import Wave, affine, ahead
from trunnion.floquet.tolerance.spread import read_tolerances
from trunnion.results.verdict import Verdict

EXAMPLES = Path(__file__).parents[2] / "examples"
LINE = tn.catalogue("two-shaft-cardan", angle=0.2, damping_ratio=0.02)
Shares = Mapping[str, float]


def example(name: str) -> tn.Driveline:
    return tn.load(EXAMPLES / f"{name}.toml")


# Waves


def random_wave(rng: np.random.Generator, size: float, last: int = 6) -> Wave:
    parts = rng.normal(size=(3, 2 * last + 1)) + 1j * rng.normal(size=(3, 2 * last + 1))
    parts *= np.exp(-0.8 * np.abs(np.arange(-last, last + 1))) * np.array([[1.0], [0.05], [0.05]])
    return Wave(parts * size / np.abs(parts).sum(), 0.0)


def value(wave: Wave, tau: float, p: np.ndarray) -> complex:
    """Of its known part, in extended precision."""
    order = np.arange(-wave.last, wave.last + 1).astype(np.longdouble)
    turns = np.cos(order * np.longdouble(tau)) + 1j * np.sin(order * np.longdouble(tau))
    return (np.concatenate([[1.0], p]) @ wave.parts).astype(np.clongdouble) @ turns


OPERATIONS = {
    "sum": (lambda a, b: a + b, lambda a, b: a + b),
    "product": (lambda a, b: a * b, lambda a, b: a * b),
    "inverse": (lambda a, b: (a + 2.0).inverse(), lambda a, b: 1 / (a + 2)),
    "exponential": (lambda a, b: (a * 3.0 + 0.2j).exp(), lambda a, b: np.exp(3 * a + 0.2j)),
    "conjugate": (lambda a, b: (a * b).conjugate(), lambda a, b: np.conj(a * b)),
    "ahead": (lambda a, b: ahead(a), lambda a, b: -np.imag(np.log(1 - a))),
}


@pytest.mark.parametrize("name", OPERATIONS)
def test_what_waves_leave_out_is_bounded(name: str) -> None:
    """Within the rest, and not far within where parameters make most of it."""
    ours, theirs = OPERATIONS[name]
    rng, closest = np.random.default_rng(1), 0.0
    for _ in range(20):
        a, b = random_wave(rng, 0.6), random_wave(rng, 0.9)
        made = ours(a, b)
        for _ in range(20):
            tau, p = rng.uniform(0, 7), rng.choice([-1.0, 1.0], 2)
            left = abs(value(made, tau, p) - theirs(value(a, tau, p), value(b, tau, p)))
            assert left <= made.rest
            closest = max(closest, left / made.rest)
    assert closest > (1e-6 if name == "sum" else 0.02)


def test_a_wave_that_may_vanish_has_no_inverse() -> None:
    with pytest.raises(ZeroDivisionError):
        (affine(1.0, {1: 1.0}, 1, 2)).inverse()


# The equations


def ranges_of(assembly: Assembly, shares: Shares) -> list[NumberRange]:
    return [
        NumberRange(s.label, s.columns, s.low, s.high) for s in (read_tolerances(assembly, shares) if shares else ())
    ]


def enclosed(line: tn.Driveline, speeds: tuple[float, float], shares: Shares, seed: int = 0) -> BoxMatrix:
    """The package's own matrices at corners of a box lie within what is left out, and not far within."""
    rng, assembly = np.random.default_rng(seed), assemble(line)
    ranges = ranges_of(assembly, shares)
    require_linear(assembly, speeds, ranges)
    box, n = box_matrix(assembly, speeds, ranges), assembly.topology.size
    tau = 2 * np.pi / box.rate * (np.arange(9) / 9 + rng.random())
    order, step = np.arange(-box.last, box.last + 1), 1e-4
    waves = np.exp(1j * box.rate * np.outer(tau, order))
    for _ in range(12):
        p = rng.choice([-1.0, 1.0], 1 + len(ranges))
        row = assembly.table(1, box.speed[0] + box.speed[1] * p[0])
        for sign, one in zip(p[1:], ranges, strict=True):
            one.columns.put(row, np.array([one.high if sign > 0 else one.low]))
        co = assembly.coefficients(row)
        m = line_matrices(assembly.topology, co, tau)
        near = [line_matrices(assembly.topology, co, tau + k * step).mass[0] for k in (-2, -1, 1, 2)]
        slope = (near[0] - 8 * near[1] + 8 * near[2] - near[3]) / (12 * step) * row[0, 0]
        over = np.linalg.inv(m.mass[0])
        a = np.zeros((len(tau), 2 * n, 2 * n))
        a[:, :n, n:], a[:, n:, :n] = over, -m.stiffness[0]
        a[:, n:, n:] = -(m.damping[0] - slope) @ over
        mine = np.einsum("tm,v,vmij->tij", waves, np.concatenate([[1.0], p]), box.parts)
        known = 1e-9 * np.abs(a).max(axis=0) + 1e-9 * np.abs(slope @ over).max()
        assert np.all(np.abs(a - mine) <= box.rest + known)
    return box


def rich(**changes: object) -> list[tn.Element]:
    """Joints, forks, loads and inertia behind a joint."""
    return [
        tn.ConstantSpeed(),
        tn.Shaft(stiffness=9e3, damping=9.0, fork_offset=0.4),
        tn.Disk(inertia=0.3, load_torque=20.0),
        tn.HookeJoint(angle=0.3, plane=0.2),
        tn.Disk(inertia=0.1, viscous_load=0.02),
        tn.Shaft(stiffness=5e3, damping=4.0, fork_offset=1.0),
        tn.Disk(inertia=0.5, load_torque=60.0, quadratic_load=1e-3),
    ]


def with_ratio() -> tn.Driveline:
    ratio = tn.Ratio(teeth_in=20, teeth_out=30)
    return tn.Driveline(
        [*rich(), ratio, tn.HookeJoint(angle=0.2), tn.Shaft(stiffness=4e3, damping=3.0), tn.Disk(inertia=1.0)]
    )


def with_tripod() -> tn.Driveline:
    tripod = tn.TripodJoint(angle=0.3, radius=0.05, length=0.3)
    return tn.Driveline([*rich(), tripod, tn.Shaft(stiffness=4e3, damping=3.0), tn.Disk(inertia=1.0)])


def with_ball_joint() -> tn.Driveline:
    ball = tn.RzeppaJoint(angle=0.3, ripple=[{"order": 6, "amplitude": 1e-3, "phase": 0.3}])
    return tn.Driveline([*rich(), ball, tn.Shaft(stiffness=4e3, damping=3.0), tn.Disk(inertia=1.0)])


def with_double_joint() -> tn.Driveline:
    double = tn.DoubleCardanJoint(angle=0.5, yoke_length=0.05, distance_ratio=1.2)
    return tn.Driveline([*rich(), double, tn.Shaft(stiffness=4e3, damping=3.0), tn.Disk(inertia=1.0)])


def with_teeth() -> tn.Driveline:
    gears = tn.GearPair(
        teeth_in=4, teeth_out=6, mesh_stiffness=2e7, mesh_damping=300.0, module=0.01,
        stiffness_variation=[{"share": 0.2, "phase": 0.4}],
    )  # fmt: skip
    return tn.Driveline([*rich(), gears, tn.Disk(inertia=0.4)])


def with_branch() -> tn.Driveline:
    own = rich()
    own[2] = tn.Disk(inertia=0.3, load_torque=20.0, name="fork in the road")
    branch = [tn.Shaft(stiffness=2e3, damping=2.0, after="fork in the road"), tn.Disk(inertia=0.2)]
    return tn.Driveline([*own, *branch])


RICH = {
    "ratio": (with_ratio, {"Shaft 2.stiffness": 0.05, "Disk 2.inertia": 0.03, "HookeJoint 2.angle": 0.05}),
    "tripod": (with_tripod, {"Shaft 2.stiffness": 0.05, "Disk 3.load_torque": 0.1, "HookeJoint 1.plane": 0.1}),
    "ball joint": (with_ball_joint, {"Shaft 1.fork_offset": 0.1, "Disk 4.inertia": 0.05}),
    "double joint": (with_double_joint, {"Shaft 3.stiffness": 0.05, "Shaft 3.damping": 0.05}),
    "teeth": (with_teeth, {"Shaft 1.stiffness": 0.05, "Disk 2.viscous_load": 0.2}),
    "branch": (with_branch, {"Shaft 3.stiffness": 0.05, "Disk 1.inertia": 0.05}),
}


@pytest.mark.parametrize("what", RICH)
def test_boxes_contain_the_equations(what: str) -> None:
    make, shares = RICH[what]
    line = make()
    rates = assemble(line).topology.rates
    assert rates
    for speeds in ((100.0, 100.0001), (90.0, 110.0)):
        enclosed(line, speeds, {})
        enclosed(line, speeds, shares)


@pytest.mark.parametrize("name", ["truck", "rolling-mill-spindle", "steering-column"])
def test_boxes_contain_the_examples(name: str) -> None:
    line = example(name)
    for case in line.operation.load_cases:
        loaded = line.with_load(case.name)
        box = enclosed(loaded, line.operation.speed_range, {})
        enclosed(loaded, (line.operation.speed, line.operation.speed * 1.01), shares_of(loaded, 0.05))
        assert np.abs(box.rest).max() < 1e-3 * np.abs(box.parts).max()


# What is proved


def shares_of(line: tn.Driveline, share: float, most: int | None = None) -> dict[str, float]:
    """All stiffnesses, dampings, inertias and angles that a line states, alike."""
    keys = ("stiffness", "damping", "inertia", "angle", "loss_factor")
    found = {f"{n}.{key}": share for n, e in line.parts for key in keys if getattr(e, key, None)}
    return dict(list(found.items())[:most])


def test_disturbances_die_out_at_the_rate_that_is_proved() -> None:
    """At random lines and corners of proved boxes, and hardly faster where a box is narrow."""
    rng, closest = np.random.default_rng(2), np.inf
    for line, speeds, shares in (
        (LINE, (1.28, 1.32), {"Shaft 1.stiffness": 0.02, "Disk 2.inertia": 0.02}),
        (LINE, (1.6, 1.6001), {"Shaft 1.stiffness": 1e-5}),
        (with_branch(), (90.0, 110.0), {"Shaft 3.stiffness": 0.02}),
        (with_ratio(), (99.0, 101.0), {"HookeJoint 2.angle": 0.05}),
    ):
        found = tn.certify_stability(line, shares, speeds)
        assert found.verdict == "proved stable"
        assembly = assemble(line)
        for _ in range(6):
            row = assembly.table(1, rng.uniform(*speeds))
            for one in ranges_of(assembly, shares):
                one.columns.put(row, np.array([rng.choice([one.low, one.high, rng.uniform(one.low, one.high)])]))
            own = tn.stability(assembly.packed.line_at(row[0]), float(row[0, 0]))
            rate = -np.log(np.abs(own.multipliers).max()) * row[0, 0] / own.period
            assert rate >= found.decay * (1 - 1e-6)
            closest = min(closest, rate / found.decay)
    assert closest < 1.1


@pytest.mark.parametrize("name", ["truck", "rolling-mill-spindle", "steering-column"])
def test_examples_are_proved_over_their_whole_range(name: str) -> None:
    """As described and under every load case, there with three tolerances of ±5 % too."""
    line = example(name)
    for case in ("", *(one.name for one in line.operation.load_cases)):
        loaded = line.with_load(case) if case else line
        for shares in ({}, shares_of(line, 0.05, 3)) if case else ({},):
            found = tn.certify_stability(loaded, shares)
            assert found.verdict == "proved stable" and found.undecided_share == 0 and found.boxes < 20
            assert found.speeds == line.operation.speed_range and found.decay > 0


@pytest.mark.parametrize("name", ["truck", "rolling-mill-spindle"])
def test_eight_tolerances_of_examples(name: str) -> None:
    line = example(name)
    found = tn.certify_stability(line, shares_of(line, 0.05, 8))
    assert found.verdict == "proved stable" and len(found.parameters) == 8


def test_without_stated_tolerances_the_line_itself_is_meant() -> None:
    found = tn.certify_stability(LINE, speeds=(0.3, 2.5))
    assert str(found).startswith("proved stable: the line at every speed from 0.3 rad/s to 2.5 rad/s")
    stated = tn.Driveline(LINE.elements, tolerances=[tn.Tolerance("Shaft 1", stiffness="1 %")])
    assert tn.certify_stability(stated, speeds=(0.3, 2.5)).parameters == ("Shaft 1.stiffness",)
    assert tn.certify_stability(stated, {}, (0.3, 2.5)).parameters == ()


def test_eight_tolerances_through_a_resonance() -> None:
    shares = {**shares_of(LINE, 0.02), "Shaft 1.stiffness": 0.02, "Shaft 2.stiffness": 0.02}
    found = tn.certify_stability(LINE, shares, (1.55, 1.65))
    assert found.verdict == "proved stable" and found.boxes < 40


@pytest.mark.slow
def test_single_lines_are_proved_wherever_they_are_stable() -> None:
    """At resonances too, up to the edges of unstable ranges."""
    line = tn.catalogue("two-shaft-cardan", angle=0.6, damping_ratio=0.01)
    speeds = np.linspace(0.9, 1.9, 60)
    assembly = assemble(line)
    open_at = []
    for speed in speeds.tolist():
        stable = tn.stability(line, speed).verdict is Verdict.STABLE
        proved = judge(assembly, (speed, speed * (1 + 1e-9)), []).proved
        assert stable or not proved
        open_at += [speed] * (stable and not proved)
    assert len(open_at) <= 1


def test_a_counterexample_is_one() -> None:
    line = tn.catalogue("two-shaft-cardan", angle=0.6, damping_ratio=0.002)
    found = tn.certify_stability(line, {"Shaft 1.stiffness": 0.01}, (1.55, 1.65), most_boxes=2000)
    assert found.verdict == "counterexample"
    example = dict(found.counterexample)
    speed = example.pop("speed")
    worse = line.replace("Shaft 1", stiffness=example["Shaft 1.stiffness"])
    assert tn.stability(worse, speed).verdict is Verdict.UNSTABLE
    again = tn.loads(tn.dumps(found.unstable_line))
    assert tn.stability(again, speed).verdict is Verdict.UNSTABLE
    assert "is unstable" in str(found)


@pytest.mark.parametrize(("damping", "verdict"), [(-0.01, "proved stable"), (-0.1, "counterexample")])
def test_a_shaft_that_feeds_energy_is_not_taken_for_an_undamped_one(damping: float, verdict: str) -> None:
    with pytest.warns(tn.InputRemark, match="feeds energy"):
        line = LINE.replace_all({"Shaft 1": {"damping": 0.12}, "Shaft 2": {"damping": damping}})
        found = tn.certify_stability(line, {"Shaft 2.damping": 0.01}, (1.2, 1.22))
        judged = [tn.stability(line, float(speed)).verdict for speed in np.linspace(1.2, 1.22, 5)]
    assert found.verdict == verdict
    assert judged == [Verdict.STABLE if verdict == "proved stable" else Verdict.UNSTABLE] * 5


def test_what_is_left_open_is_said() -> None:
    found = tn.certify_stability(LINE, {"Shaft 1.stiffness": 0.4}, (0.5, 2.0), most_boxes=1)
    assert found.verdict == "undecided" and 0 < found.undecided_share <= 1
    assert found.data.sizes["open_box"] == len(found.undecided_low) > 0


def test_an_undamped_line_is_never_proved() -> None:
    line = tn.catalogue("two-shaft-cardan", angle=0.2, damping_ratio=0.0)
    found = tn.certify_stability(line, {}, (1.2, 1.22), most_boxes=12)
    assert found.verdict == "undecided" and found.undecided_share == 1


@pytest.mark.slow
def test_a_line_too_stiff_stays_undecided_or_is_proved_rightly() -> None:
    """Its fastest mode makes 8000 cycles a turn."""
    line = tn.Driveline([*LINE.elements, tn.Shaft(stiffness=1e6, damping=1.0), tn.Disk(inertia=1e-2)])
    found = tn.certify_stability(line, {"Shaft 1.stiffness": 0.01}, (2.04, 2.08), most_boxes=20)
    assert found.verdict in ("undecided", "proved stable")


SERIES = [tn.Shaft(stiffness=2.0, damping=0.2), tn.Shaft(stiffness=1.0, damping=0.1)]
LOOSE = tn.Driveline([tn.ConstantSpeed(), *SERIES, tn.Disk(inertia=1.0)])
BAD = [
    (lambda: tn.certify_stability(LINE, {"Shaft 1.stiffness": 0.01}, (2.0, 1.0)), "speeds = (2.0, 1.0): must be two"),
    (lambda: tn.certify_stability(free(0.2), {}, (1.0, 2.0)), "driveline: is free–free, has joint angles, and no"),
    (
        lambda: tn.certify_stability(free(0.0), {"HookeJoint 1.angle": ("range", 0.0, 0.1)}, (1.0, 2.0)),
        "driveline: is free–free, has joint angles, and no torque depends on its speed",
    ),
    (
        lambda: tn.certify_stability(
            driven_twice(), {"Disk 1.load_torque": ("range", -60.0, -50.0)}, (100.0, 100.1)
        ),
        "Disk 1.load_torque: moves how those that drive share the torque that holds the speed",
    ),
    (
        lambda: tn.certify_stability(with_ratio(), {"Ratio 1.ratio": 0.1}, (1.0, 2.0)),
        "Ratio 1.ratio: sets the period of the line's equations and does not vary within one study; "
        'line.replace("Ratio 1", ratio=...) makes a line of each of its values',
    ),
    (lambda: tn.certify_stability(LINE, {"HookeJoint 1.angle": ("range", 0, 1.2)}, (1.0, 2.0)), "HookeJoint 1.angle"),
    (
        lambda: tn.certify_stability(LOOSE, {"Shaft 1.stiffness": 0.1}, (1.0, 2.0)),
        "Shaft 1.stiffness: belongs to one of several springs in series",
    ),
    (
        lambda: tn.certify_stability(rich_line(), {"Shaft 1.damping": ("range", -0.1, 0.1)}, (1.0, 2.0)),
        "Shaft 1.damping: would go from -0.1 to 0.1, and damping that reaches zero cannot be certified",
    ),
    (
        lambda: tn.certify_stability(staged(), {"Disk 1.load_torque": 0.95}, (90.0, 100.0)),
        "PiecewiseShaft 1 = -2.5: is the torque at 95 rad/s in the box, whose middle works in stage 1 of 3",
    ),
    (lambda: tn.certify_stability(LINE, {"Shaft 1.stiffness": 0.1}, (1.0, 2.0), most_boxes=0), "most_boxes = 0: must"),
    (lambda: tn.certify_stability(LINE, {"Shaft 1.stiffness": 0.1}, (1.0, 2.0), within=0), "within = 0: must"),
]  # fmt: skip


def along_a_curve() -> tn.Driveline:
    """A fan whose torque is flat at 20, 30 and 40 rad/s and falls between, at 25 by 1.5 N m s/rad and more."""
    points = ((5, 10), (24, 10), (26, 7), (28, 10), (32, 10), (34, 7), (36, 10), (75, 10))
    curve = [{"speed": float(speed), "torque": float(torque)} for speed, torque in points]
    return tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e3, damping=0.2), tn.Fan(inertia=1.0, curve=curve)])


def through_the_limit() -> tn.Driveline:
    """A motor whose controller acts from 24.8 to 25.2 rad/s alone."""
    motor = tn.Motor(inertia=1.0, gain=5.0, set_speed=25.0, torque_limit=1.0)
    return tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e3, damping=0.2), motor])


def with_set_motor(torque: float) -> tn.Driveline:
    """A motor whose slope falls with what it carries, either way, and a load that drives what swings."""
    motor = tn.Motor(
        inertia=0.4, breakdown_torque=100.0, breakdown_slip=0.2, synchronous_speed=150.0, drive_share=1.0
    )  # fmt: skip
    load = tn.Disk(inertia=1.0, load_torque=torque, viscous_load=-5.0)
    return tn.Driveline([motor, tn.Shaft(stiffness=1e3, damping=2.0), load])


def stages_without_load(torque: float = 0.0) -> tn.Driveline:
    """A spring nine times as stiff beyond 10 N m, with which the joint's tongue lies at 95 rad/s."""
    spring = tn.PiecewiseShaft.symmetric([(1e3, 0.01), (9e3, None)], damping=1.0)
    load = tn.Disk(inertia=1.0, load_torque=torque)
    return tn.Driveline([tn.ConstantSpeed(), spring, tn.HookeJoint(angle=0.5), load])


def balanced_at_one_speed() -> tn.Driveline:
    shaft = tn.Shaft(stiffness=1e3, damping=2.0)
    return tn.Driveline([tn.Disk(inertia=1.0, load_torque=-100.0), shaft, tn.Disk(inertia=1.0, viscous_load=1.0)])


BETWEEN = [
    (along_a_curve, {}, (20.0, 40.0), along_a_curve, 25.0, "Fan 1 = "),
    (
        lambda: with_set_motor(750.0), {"Disk 1.load_torque": ("range", 655.0, 845.0)}, (150.0, 150 * (1 + 1e-15)),
        lambda: with_set_motor(655.0), 150.0, "Disk 1.load_torque: moves other numbers",
    ),
    (
        stages_without_load, {"Disk 1.load_torque": ("range", -50.0, 50.0)}, (94.0, 94.1),
        lambda: stages_without_load(50.0), 94.05,
        "PiecewiseShaft 1 = .*50: is the torque at 94.05 rad/s in the box",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("line", "shares", "speeds", "inside", "speed", "message"), BETWEEN)
def test_what_turns_between_the_ends_of_a_box_is_not_proved(line, shares, speeds, inside, speed, message) -> None:
    """Lines alike at the ends and in the middle of a box, and unstable between."""
    assert tn.stability(inside(), speed).verdict is Verdict.UNSTABLE
    with pytest.raises(tn.InputError, match=message):
        tn.certify_stability(line(), shares, speeds)
    assert shares or not proved_over(assemble(line()), speeds, 6)


def test_a_controller_at_its_limit_is_not_taken_for_one_that_acts() -> None:
    with pytest.raises(tn.InputError, match="Motor 1 = "):
        tn.certify_stability(through_the_limit(), {}, (20.0, 40.0))
    assert tn.certify_stability(through_the_limit(), {}, (24.9, 25.1)).verdict == "proved stable"


def test_a_line_that_turns_steadily_at_one_speed_alone_has_no_range() -> None:
    with pytest.raises(tn.InputError, match="torques do not balance"):
        tn.certify_stability(balanced_at_one_speed(), {}, (100.0, 200.0))


@pytest.mark.parametrize("share", [0.0, 0.25, 0.5, 0.75, 1.0])
@pytest.mark.parametrize("beside", [0.0, 9.0])
def test_inertias_that_one_factor_moves_are_in_its_box_together(share: float, beside: float) -> None:
    """There is one value of the parameter at which all entries are those of a line between the ends, by hand."""
    fan = [tn.Fan(inertia=beside, quadratic_load=1e-4)] if beside else []
    spring = tn.Shaft(stiffness=1.0, damping=0.01)
    line = tn.Driveline([tn.ConstantSpeed(), spring, tn.Disk(inertia=1.0), *fan, spring, tn.Disk(inertia=1.0)])
    assembly, factor = assemble(line), 0.5 + share
    own = NumberRange("factor", assembly.packed.resolve("factor of Disk *.inertia"), 0.5, 1.5)
    box, mine = box_matrix(assembly, (1.0, 1.0), [own]), 1 / np.array([factor + beside, factor])
    p = np.linspace(-1, 1, 4001)[:, None]
    there, rest = box.parts[:, box.last].real, box.rest[[0, 1], [2, 3]]
    made = there[0, [0, 1], [2, 3]] + p * there[2, [0, 1], [2, 3]]
    assert (np.abs(made - mine) <= rest + 3e-4).all(axis=1).any()
    # Alike in proportion they go with one parameter, and nothing is left out.
    assert (rest.max() < 1e-12) == (not beside)


def rich_line() -> tn.Driveline:
    return tn.Driveline(rich())


def free(angle: float = 0.0, slope: float = 0.0, varies: float = 0.0) -> tn.Driveline:
    """Without a prescribed speed: a ratio, a joint and teeth."""
    share = {"drive_share": 1.0} if slope else {}
    gears = tn.GearPair(
        teeth_in=10, teeth_out=21, mesh_stiffness=1e7, mesh_damping=100.0, module=0.01,
        stiffness_variation=[{"share": varies}] if varies else [],
    )  # fmt: skip
    return tn.Driveline(
        [
            tn.Disk(inertia=1.0, name="engine", **share),
            tn.Shaft(stiffness=1e3, damping=2.0),
            tn.Disk(inertia=0.1),
            gears,
            tn.Disk(inertia=2.0, viscous_load=slope),
            tn.HookeJoint(angle=angle),
            tn.Shaft(stiffness=4e3, damping=3.0),
            tn.Disk(inertia=3.0),
        ]
    )


def driven_twice() -> tn.Driveline:
    """Bent and free, by two disks as their own torques are, which balance the load at every speed."""
    shaft = tn.Shaft(stiffness=4e3, damping=3.0)
    first = tn.Disk(inertia=1.0, load_torque=-50.0, viscous_load=-1.0)
    second, load = tn.Disk(inertia=1.0, load_torque=-60.0), tn.Disk(inertia=3.0, load_torque=110.0, viscous_load=1.0)
    return tn.Driveline([first, shaft, second, tn.HookeJoint(angle=0.2), shaft, load])


@pytest.mark.parametrize(("slope", "varies"), [(0.0, 0.0), (0.5, 0.0), (0.0, 0.1), (0.5, 0.1)])
def test_free_lines_decay_but_for_what_is_set_aside(slope: float, varies: float) -> None:
    """One multiplier at 1 stands for a turn of the whole line, another for its speed where no load goes with it."""
    line = free(slope=slope, varies=varies)
    found = tn.certify_stability(line, {}, (40.0, 40.4))
    own = tn.stability(line, 40.2)
    rates = np.sort(-np.log(np.abs(own.multipliers)) * 40.2 / own.period)
    aside = 1 if slope else 2
    assert found.verdict == "proved stable" and np.abs(rates[:aside]).max() < 1e-6
    assert 0.7 * rates[aside] < found.decay <= rates[aside] * (1 + 1e-6)
    wide = tn.certify_stability(line, {"Shaft 1.stiffness": 0.05, "engine.inertia": 0.05}, (40.0, 40.4))
    assert wide.verdict == "proved stable" and wide.decay < found.decay


def staged() -> tn.Driveline:
    stages = tn.PiecewiseShaft.symmetric([(5e3, 0.001), (1e4, None)], damping=5)
    return tn.Driveline([tn.ConstantSpeed(), stages, tn.Disk(inertia=1.0, load_torque=50.0)])


@pytest.mark.parametrize(("run", "message"), BAD)
def test_refusals(run, message: str) -> None:
    with pytest.raises(tn.InputError) as caught:
        run()
    assert str(caught.value).startswith(message) and "\n" not in str(caught.value)


def test_drawn_over_the_directions_split_most() -> None:
    """Boxes, proved and open, fill the volume once; the picture has both, and marks the line that is unstable."""
    from trunnion.pictures.design import most_split

    found = tn.certify_stability(LINE, {"Shaft 1.stiffness": 0.9, "Disk 1.inertia": 0.01}, (1.2, 2.25), most_boxes=30)
    assert found.verdict == "undecided" and len(found.proved_low) and most_split(found) == (0, 1)
    low, high = found.ends
    every = [
        (np.log(h[0] / b[0]), h[1:] - b[1:])
        for b, h in zip(
            np.vstack([found.proved_low, found.undecided_low]),
            np.vstack([found.proved_high, found.undecided_high]),
            strict=True,
        )
    ]
    volume = sum(speed * sides.prod() for speed, sides in every)
    assert volume == pytest.approx(np.log(high[0] / low[0]) * (high - low)[1:].prod(), rel=1e-9)
    axes = found.plot()
    words = [text.get_text() for text in axes.get_legend().get_texts()]
    assert words == [f"proved stable ({len(found.proved_low)} boxes)", f"left open ({len(found.undecided_low)} boxes)"]
    assert axes.get_xlabel() == "input speed [rad/s]" and axes.get_ylabel() == "stiffness of Shaft 1 [N m/rad]"
    assert "1 other direction" in axes.get_title(loc="left")
    line = tn.catalogue("two-shaft-cardan", angle=0.6, damping_ratio=0.002)
    unstable = tn.certify_stability(line, {"Shaft 1.stiffness": 0.01}, (1.5, 1.7))
    words = [text.get_text() for text in unstable.plot().get_legend().get_texts()]
    assert unstable.verdict == "counterexample" and words[-1] == "unstable line"


def test_drawn_along_the_speed_without_tolerances() -> None:
    line = tn.catalogue("two-shaft-cardan", angle=0.6, damping_ratio=0.01)
    found = tn.certify_stability(line, {}, (1.2, 1.4))
    axes = found.plot()
    words = [text.get_text() for text in axes.get_legend().get_texts()]
    assert found.verdict == "proved stable" and words[0].startswith("proved stable (")


def test_stages_of_teeth_whose_stiffness_scatters_are_not_held_by_any_load() -> None:
    """With a fifth less stiffness the play ends at 40 N m, and a load of 45 N m works beyond it: no theorem of one
    stage holds, though the middle carries nothing."""
    teeth = tn.GearPair(
        base_radius_in=0.05,
        base_radius_out=0.1,
        mesh_stiffness=1e7,
        mesh_damping=100.0,
        backlash=2e-4,
        stiffness_ratio=0.5,
    )
    shaft = tn.Shaft(stiffness=2e4, damping=2.0)
    line = tn.Driveline([tn.ConstantSpeed(), shaft, tn.Disk(inertia=0.5), teeth, tn.Disk(inertia=1.0)])
    assert (
        tn.certify_stability(line, {"GearPair 1.mesh_stiffness": 0.2}, speeds=(90.0, 100.0)).verdict == "proved stable"
    )
    loads = {"Disk 2.load_torque": ("range", -45.0, 45.0)}
    (clause,) = tn.certify_stability(line, loads, speeds=(90.0, 100.0)).stages
    assert clause == "GearPair 1 works in its stage 2 of 3, from -50 to 50 N m"
    with pytest.raises(tn.InputError, match=r"GearPair 1.mesh_stiffness: belongs to a spring with stages"):
        tn.certify_stability(line, {"GearPair 1.mesh_stiffness": 0.2, **loads}, speeds=(90.0, 100.0))
