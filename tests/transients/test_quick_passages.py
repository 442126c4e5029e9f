"""Passages in compiled stretches end as those that keep the whole motion do."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from tests.transients.test_passing import comes_there, line, weak
from trunnion.motion.passing import passing as judged
from trunnion.motion.passing.quick_passage import QuickPassage, is_quick
from trunnion.motion.passing.rigid import rigid_time
from trunnion.motion.passing.start import begun_line, lasting
from trunnion.motion.transients.prepare import stepper_of


def random_passage(rng: np.random.Generator) -> tuple[tn.Driveline, list[tn.AppliedTorque], float, float]:
    """A line of three inertias and a joint with a motor's points, Kloss's formula or a torque over time."""
    one, middle, other = rng.uniform(0.3, 1.5), rng.uniform(0.1, 1), rng.uniform(1, 6)
    natural = rng.uniform(30, 80)
    stiffness = natural**2 / (1 / one + 1 / (middle + other))
    damping, last = 2 * rng.uniform(0.003, 0.03) * stiffness / natural, 0.8 * natural
    torque = (one + middle + other) * natural * rng.uniform(0.01, 0.2)
    motor: tn.Disk | tn.Motor = tn.Disk(name="motor", inertia=one)
    acting: list[tn.AppliedTorque] = []
    match int(rng.integers(3)):
        case 0:
            share = ((0.0, rng.uniform(0.8, 1.5)), (0.4, rng.uniform(0.8, 1.2)), (0.9, 1.0), (1.6, -1.0))
            curve = [{"speed": at * last, "torque": torque * size} for at, size in share]
            motor = tn.Motor(name="motor", inertia=one, curve=curve)
        case 1:
            kloss = {"breakdown_torque": 2 * torque, "breakdown_slip": 0.3, "synchronous_speed": 1.2 * last}
            acting = [tn.AppliedTorque(on="motor", **kloss)]
        case 2:
            acting = [tn.AppliedTorque(on="motor", time=[0, 1.0, 2.0], torque=[0, torque, 0.9 * torque])]
    elements = [
        motor,
        tn.HookeJoint(angle=float(rng.uniform(0.05, 0.45))),
        tn.Shaft(stiffness=stiffness, damping=damping),
        tn.Disk(name="middle", inertia=middle),
        tn.Shaft(stiffness=3 * stiffness, damping=damping),
        tn.Fan(name="fan", inertia=other, quadratic_load=float(rng.uniform(0, 0.2) * torque / last**2)),
    ]
    return tn.Driveline(elements), acting, float(rng.choice([0.0, 0.3 * natural])), last


def compared(seed: int, count: int) -> list[str]:
    rng, kinds = np.random.default_rng(seed), list[str]()
    for _ in range(count):
        made, torque, first, last = random_passage(rng)
        phase, tolerance = float(rng.uniform(0, 3)), float(rng.choice([1e-9, 1e-6]))
        prepared, acting = begun_line(made, lasting(made, torque, ()), first)
        rigid = rigid_time(prepared, acting, first, last)
        whole = judged._Follower(prepared, acting, first, last, phase, rigid)
        run, kind = whole.ending(tolerance)
        stepper = stepper_of(prepared, acting, tolerance)
        assert is_quick(stepper)
        quick = QuickPassage(stepper, whole.start(), phase, first, last, tolerance)
        assert whole._judged(quick) == kind
        if kind in ("passed", "dwelt"):
            assert quick.time == pytest.approx(run.end, rel=1e-3)
        kinds.append(kind)
    return kinds


def test_a_few_end_alike() -> None:
    compared(3, 5)


@pytest.mark.slow
def test_many_end_alike() -> None:
    kinds = compared(5, 100)
    assert kinds.count("captured") > 5 and kinds.count("passed") > 30


@pytest.mark.slow
def test_maps_judge_right_at_their_tolerance() -> None:
    """200 random lines at the tolerance of a map, against a reader's own equations at two steps."""
    rng, wrong, undecided, open_cases, plain = np.random.default_rng(11), 0, 0, 0, 0
    for _ in range(200):
        one, other = rng.uniform(0.5, 2), rng.uniform(0.5, 5)
        natural = rng.uniform(30, 80)
        stiffness = one * other / (one + other) * natural**2
        damping = 2 * stiffness / natural * rng.uniform(0.004, 0.03)
        angle, phase, rigid = rng.uniform(0.05, 0.5), rng.uniform(0, np.pi), rng.uniform(6, 25)
        first, last = 0.35 * natural, 0.75 * natural
        torque = (one + other) * (last - first) / rigid
        known = [
            np.isfinite(comes_there(one, other, angle, stiffness, damping, torque, first, last, phase, 10 * rigid, h))
            for h in (0.05 / natural, 0.025 / natural)
        ]
        made = line(one, other, angle, stiffness, damping)
        prepared, acting = begun_line(made, lasting(made, weak(torque), ()), first)
        follower = judged._Follower(prepared, acting, first, last, phase, rigid)
        found, plainly = follower.kind(1e-6)
        if plainly:  # as a second run would say
            plain += 1
            assert follower.other_kind(found, 1e-6) in ("passed", "dwelt")
        (kind,) = judged.passing_kinds(prepared, acting, first, last, np.array([phase]), rigid, 1e-6)
        open_cases += known[0] != known[1]
        undecided += kind == "undecided"
        wrong += known[0] == known[1] and kind != "undecided" and (kind in ("passed", "dwelt")) != known[1]
    assert plain > 10 and wrong == 0 and open_cases <= 6 and undecided <= 4 + open_cases


def test_what_switches_otherwise_keeps_the_whole_motion() -> None:
    made = line(1.0, 4.0, 0.1, 2e3, 1.0)
    for torque in (
        tn.AppliedTorque(on="motor", formula="abs(speed)"),
        tn.AppliedTorque(on="motor", angle=[0.0, 1.0], torque=[1.0, 2.0]),
        tn.TorqueFunction(on="motor", function=lambda t, speed, angle: 1.0, until=5.0),
    ):
        prepared, acting = begun_line(made, lasting(made, [torque], ()), 5.0)
        assert not is_quick(stepper_of(prepared, acting, 1e-9))
    prepared, acting = begun_line(made, lasting(made, weak(1.0), [tn.FrictionTorque(on="load", torque=0.1)]), 5.0)
    assert not is_quick(stepper_of(prepared, acting, 1e-9))
    plain = tn.AppliedTorque(on="motor", formula="2 + 0.01*speed")
    prepared, acting = begun_line(made, lasting(made, [plain], ()), 5.0)
    assert is_quick(stepper_of(prepared, acting, 1e-9))
