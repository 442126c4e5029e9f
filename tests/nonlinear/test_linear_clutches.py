"""Clutches that state the motion at which linear analyses take them, and periodic motion of free lines that rub."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import trunnion as tn
from trunnion.laws import friction
from trunnion.laws.spring import StageSpring

STAGES = {"breakpoints": [-0.05, 0.04], "stiffnesses": [3000.0, 900.0, 2500.0]}
RUBS = {"friction": [{"torque": 12.0, "stiffness": 8000.0}]}
MOTION = {"linear_amplitude": 0.03, "linear_frequency": 300.0}


def force(q: float) -> float:
    return 900.0 * q + 1600.0 * max(q - 0.04, 0.0) - 2100.0 * max(-0.05 - q, 0.0)


def staged_clutch(**more: object) -> tn.Clutch:
    return tn.Clutch(**STAGES, **RUBS, **MOTION, damping=0.4, name="clutch", **more)  # type: ignore[arg-type]


def driven(clutch: object, *, load: float = 45.0, angle: float = 0.3) -> tn.Driveline:
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.HookeJoint(angle=angle, name="joint"),
            tn.Shaft(stiffness=2e4, damping=2.0, name="front"),
            # In front of the clutch: the fork offset of a stand-in does not turn the disks behind it as its twist does.
            tn.Disk(inertia=0.08, name="hub", excitation=[{"order": 2, "amplitude": 6.0}]),
            clutch,
            tn.Disk(inertia=0.05, name="gearbox"),
            tn.HookeJoint(angle=0.2, plane=0.4, name="second joint"),
            tn.Shaft(stiffness=9e3, damping=2.0, name="rear"),
            tn.Disk(inertia=0.3, load_torque=load, name="load"),
        ]
    )


def car(clutch: object, *, torque: float = 150.0) -> tn.Driveline:
    """Free: engine, clutch, gearbox, propeller shaft between angled joints, axle."""
    return tn.Driveline(
        [
            tn.Disk(inertia=0.25, drive_share=1, excitation=[{"order": 2, "amplitude": torque}], name="engine"),
            clutch,
            tn.Disk(inertia=0.03, name="gearbox"),
            tn.HookeJoint(angle=0.1, name="front joint"),
            tn.Shaft(stiffness=1.5e4, damping=2.0, name="propeller shaft"),
            tn.HookeJoint(angle=0.15, name="rear joint"),
            tn.Disk(inertia=0.02, name="axle"),
            tn.Shaft(stiffness=6e3, damping=3.0, name="half shafts"),
            tn.Disk(inertia=3.0, load_torque=120.0, name="car"),
        ]
    )


@pytest.mark.parametrize("torque", [0.0, 30.0, -60.0, 200.0])
@pytest.mark.parametrize("size", [0.01, 0.03, 0.3])
def test_the_mean_over_a_swing_is_that_of_quadrature(torque: float, size: float) -> None:
    """Middle, stiffness and share of damping, by scipy over the cycle."""
    spring = StageSpring(np.array(STAGES["breakpoints"]), np.array(STAGES["stiffnesses"]))

    def over(middle: float, weight) -> float:  # type: ignore[no-untyped-def]
        bends = [np.arccos((k - middle) / size) for k in STAGES["breakpoints"] if abs(k - middle) < size]
        value = quad(lambda t: weight(middle + size * np.cos(t), t), 0, np.pi, points=bends or None, epsabs=1e-10)[0]
        return value / np.pi

    middle = brentq(lambda m: over(m, lambda q, _: force(q)) - torque, -1.0, 1.0, xtol=1e-14)
    slope = 2 / size * over(middle, lambda q, t: force(q) * np.cos(t))
    found = float(friction.middle_under(spring, torque, size))
    assert found == pytest.approx(middle, abs=1e-10)
    assert float(friction.over_a_cycle(spring, found, size)[1]) == pytest.approx(slope, rel=1e-9)
    outer = 2 * over(middle, lambda q, t: (not -0.05 < q < 0.04) * np.sin(t) ** 2)
    acts = np.array([True, False, True])
    assert friction.damped_share(spring, acts, np.array(found), np.array(size)) == pytest.approx(outer, abs=1e-8)


def test_free_play_without_load_has_its_middle_at_no_twist() -> None:
    spring = StageSpring(np.array([-0.1, 0.05]), np.array([1e3, 0.0, 1e3]))
    assert friction.middle_under(spring, 0.0, 0.01) == 0.0
    assert friction.over_a_cycle(spring, 0.0, 0.01)[1] == 0.0


def test_several_cases_at_once_are_each_alone() -> None:
    knots, slopes = np.array([[-0.05, 0.04], [-0.01, 0.02]]), np.array([[3e3, 9e2, 2.5e3], [5e2, 4e2, 9e2]])
    torque, size = np.array([30.0, -8.0]), np.array([0.02, 0.07])
    both = friction.middle_under(StageSpring(knots, slopes), torque, size)
    alone = [float(friction.middle_under(StageSpring(knots[i], slopes[i]), torque[i], size[i])) for i in range(2)]
    assert both == pytest.approx(alone, abs=1e-15)


@pytest.mark.parametrize("law", ["always", "in contact"])
def test_linear_analyses_are_those_of_the_shaft_it_stands_for(law: str) -> None:
    """Multipliers, frequencies and orders of the line with ``Clutch.linear`` at the torque that it carries."""
    clutch = staged_clutch(damping_law=law)
    # The load is carried over straight joints' mean ratio 1, so the clutch has it on average.
    shaft = clutch.linear(torque=-45.0)
    rubbing, plain = driven(clutch), driven(shaft)
    a, b = tn.stability(rubbing, 140.0), tn.stability(plain, 140.0)
    assert a.multipliers == pytest.approx(b.multipliers, rel=1e-9)
    modes = [tn.natural_frequencies(line).frequency for line in (rubbing, plain)]
    assert modes[0] == pytest.approx(modes[1], rel=1e-12)
    one, other = (tn.order_response(line, [140.0, 200.0]).torque for line in (rubbing, plain))
    assert np.abs(one - other).max() < 1e-9 * np.abs(other).max()


def test_free_bent_lines_are_judged_about_the_motion_of_the_line_with_the_shaft() -> None:
    clutch = staged_clutch()
    rubbing, plain = car(clutch), car(clutch.linear(torque=-120.0))
    a, b = tn.stability(rubbing, 150.0), tn.stability(plain, 150.0)
    assert np.sort(np.abs(a.multipliers)) == pytest.approx(np.sort(np.abs(b.multipliers)), abs=1e-8)
    one, other = (tn.order_response(line, [150.0]).torque for line in (rubbing, plain))
    assert np.abs(one - other).max() < 1e-7 * np.abs(other).max()


def test_results_say_what_a_clutch_stands_for_and_when_it_swings_otherwise() -> None:
    line = driven(staged_clutch().model_copy(update={"linear_amplitude": 0.002}))
    assert "clutch rubs and stands for a shaft of" in str(tn.stability(line, 140.0))
    said = [str(f) for f in tn.order_response(line, [140.0]).findings]
    assert any("but counts by its mean over ± 0.115 deg: give linear_amplitude = " in s for s in said)


def test_a_loaded_clutch_is_compared_about_its_mean_torque() -> None:
    """Beyond its soft middle stage it swings on the stiff one alone, rubbing little: linear theory holds."""
    stages = {"breakpoints": [-0.01, 0.01], "stiffnesses": [6000.0, 1500.0, 6000.0], "damping": 1.0}
    clutch = tn.Clutch(**stages, friction=[{"torque": 0.5, "stiffness": 2000.0}], name="clutch")  # type: ignore[arg-type]
    check = tn.linearity_check(driven(clutch, load=120.0, angle=0.1), 140.0)
    (shaft,) = check.stand_ins
    assert abs(shaft.torque) == pytest.approx(120.0, rel=0.01)
    assert 5950 < shaft.stiffness < 8000
    assert np.all(check.difference.max(axis=0) < 0.02 * check.largest)


def test_the_exact_line_ignores_the_stated_motion() -> None:
    """Nonlinear motion has the friction itself."""
    bare = tn.Clutch(**STAGES, **RUBS, damping=0.4, name="clutch")  # type: ignore[arg-type]
    one, other = (tn.simulate(driven(c), 0.05, speed=140.0).torque[-1] for c in (staged_clutch(), bare))
    assert one == pytest.approx(other, rel=1e-12)


@pytest.mark.parametrize(("torque", "slips"), [(150.0, False), (1500.0, True)])
def test_periodic_motion_of_a_free_line_that_rubs(torque: float, slips: bool) -> None:
    """Against the motion that a simulation from its start still has ten periods later."""
    line = car(tn.Clutch(stiffnesses=[1200.0], damping=0.5, name="clutch", **RUBS), torque=torque)  # type: ignore[arg-type]
    found = tn.periodic_response(line, 150.0)
    assert found.outcome.ok and str(found.verdict) == "stable"
    swing = float(np.ptp(found.twist[:, 0])) / 2
    assert (swing > 12.0 / 8000.0) is slips
    run = tn.simulate(line, 10 * found.period, speed=150.0, start=found.orbit.start)
    last = run.time > run.time[-1] - found.period
    assert float(np.ptp(run.torque[last, 0])) == pytest.approx(float(found.torque_peak_to_peak[0]), rel=2e-2)


def test_run_up_follows_the_friction_and_says_that_no_branch_does() -> None:
    run = tn.run_up(driven(staged_clutch()), 120.0, 140.0, acceleration=200.0)
    assert run.outcome.ok and run.steady is None
    assert "no steady response beside it: clutches rub" in str(run)


def test_a_common_damping_ratio_leaves_no_room_for_its_loss_in_own_motions() -> None:
    clutch = tn.Clutch(stiffnesses=[1200.0], name="clutch", **RUBS, **MOTION)  # type: ignore[arg-type]
    elements = [type(e)(**{k: v for k, v in e.stated.items() if k != "damping"}) for e in car(clutch).elements]
    with pytest.raises(tn.InputError, match=r"clutch\.friction: has a loss of its own beside the line's damping_ratio"):
        tn.stability(tn.Driveline(elements, damping_ratio=0.02), 150.0)


def test_the_stated_motion_is_written_and_read(tmp_path: Path) -> None:
    line = driven(staged_clutch())
    assert tn.loads(tn.dumps(line)).elements[4] == line.elements[4]
