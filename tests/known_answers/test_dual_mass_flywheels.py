"""Dual-mass flywheels against closed forms, and against the same masses and springs as separate elements."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn

PRIMARY, SECONDARY = 0.14, 0.06
SLOPE = 15.0 * 180 / np.pi
STAGES = {"breakpoints": [-0.2, 0.2], "stiffnesses": [1400.0, 700.0, 1400.0], "damping": 1.2}
FRICTION = {"friction": [{"torque": 6.0, "stiffness": 3000.0}]}


def flywheel(**springs: object) -> tn.DualMassFlywheel:
    return tn.DualMassFlywheel(primary_inertia=PRIMARY, secondary_inertia=SECONDARY, name="springs", **springs)


def behind(load: float, **more: object) -> list[object]:
    """What both lines have behind the flywheel."""
    wheel = tn.Disk(inertia=1.5, load_torque=load, name="wheel", **more)
    return [tn.Shaft(stiffness=2e4, damping=3.0, name="shaft"), wheel]


def in_front() -> list[object]:
    return [tn.ConstantSpeed(), tn.Shaft(stiffness=5e4, damping=2.0, name="crank")]


def both(spring: object, load: float, **springs: object) -> tuple[tn.Driveline, tn.Driveline]:
    """One element, and a disk, a spring and a disk."""
    more = {"excitation": [{"order": 2, "amplitude": 30.0}]}
    apart = [tn.Disk(inertia=PRIMARY, name="primary"), spring, tn.Disk(inertia=SECONDARY, name="secondary")]
    one = tn.Driveline([*in_front(), flywheel(**springs), *behind(load, **more)])
    return one, tn.Driveline([*in_front(), *apart, *behind(load, **more)])


def test_two_free_masses() -> None:
    """ω = √(k (1/J₁ + 1/J₂))."""
    found = tn.natural_frequencies(tn.Driveline([flywheel(stiffnesses=["15 N*m/deg"])]))
    assert found.names == ("primary of springs", "secondary of springs") and found.rigid_body
    assert found.undamped_frequency[1] == pytest.approx(np.sqrt(SLOPE * (1 / PRIMARY + 1 / SECONDARY)), rel=1e-9)


@pytest.mark.parametrize(("load", "slope"), [(20.0, 700.0), (400.0, 1400.0)])
def test_the_load_chooses_the_stage(load: float, slope: float) -> None:
    """Within 0.2 rad · 700 N m/rad = 140 N m the soft stage acts, beyond it the stiff one."""
    found = tn.natural_frequencies(tn.Driveline([*in_front(), flywheel(**STAGES), *behind(load)]))
    k = np.array([[5e4 + slope, -slope, 0], [-slope, slope + 2e4, -2e4], [0, -2e4, 2e4]])
    squares = np.linalg.eigvals(np.diag(1 / np.array([PRIMARY, SECONDARY, 1.5])) @ k).real
    assert found.undamped_frequency == pytest.approx(np.sqrt(np.sort(squares)), rel=1e-9)


def test_torques_are_those_of_separate_elements() -> None:
    """In linear orders, in the periodic motion over stages, and in time with friction."""
    one, apart = both(tn.PiecewiseShaft(name="springs", **STAGES), 139.9, **STAGES)
    speeds = np.array([60.0, 110.0, 180.0])
    orders = [tn.order_response(line, speeds) for line in (one, apart)]
    assert orders[0].torque == pytest.approx(orders[1].torque, rel=1e-12)
    periodic = [tn.periodic_response(line, 110.0) for line in (one, apart)]
    assert periodic[0].outcome.ok and periodic[0].torque == pytest.approx(periodic[1].torque, rel=1e-9, abs=1e-9)
    twist = periodic[0].twist[:, 1]
    assert twist.min() < -0.2 < twist.max(), "it swings over the end of the soft stage"
    rubbing = both(tn.Clutch(name="springs", **STAGES, **FRICTION), 60.0, **STAGES, **FRICTION)
    runs = [tn.simulate(line, 0.5, speed=110.0) for line in rubbing]
    assert runs[0].final == pytest.approx(runs[1].final, rel=1e-9, abs=1e-10)
    with pytest.raises(tn.InputError, match="has dry friction"):
        tn.order_response(rubbing[0], speeds)
    stated = {"linear_amplitude": 0.02, "linear_frequency": 220.0}
    linear = [tn.order_response(line.replace("springs", **stated), speeds) for line in rubbing]
    assert linear[0].torque == pytest.approx(linear[1].torque, rel=1e-12)
    assert "stands for a shaft of" in str(linear[0])


def test_its_mean_is_a_flywheel_again() -> None:
    """Stiffness and loss over one swing as of a clutch, between the same masses."""
    rubbing = flywheel(**STAGES, **FRICTION)
    mean, shaft = (
        one.linear("1 deg", "30 Hz", 50.0) for one in (rubbing, tn.Clutch(name="springs", **STAGES, **FRICTION))
    )
    assert isinstance(mean, tn.DualMassFlywheel) and mean.inertia_values == (PRIMARY, SECONDARY)
    assert (*mean.stiffnesses, mean.damping) == pytest.approx((shaft.stiffness, shaft.damping), rel=1e-12)


def test_of_a_car() -> None:
    """Engine to pinion of a car in second gear: one element for three, the same frequencies."""
    rear = [
        tn.Ratio(name="2nd gear", teeth_in=19, teeth_out=40),
        tn.Shaft(name="gearbox output shaft", stiffness="25 kN*m/rad"),
        tn.Disk(name="gearbox flange", inertia="0.004 kg*m^2"),
        tn.HookeJoint(name="joint 1", angle="1.5 deg"),
        tn.Shaft(name="front tube", outer_diameter="65 mm", inner_diameter="61 mm", length="0.75 m", material="steel"),
        tn.Disk(name="pinion and all behind", inertia="0.4 kg*m^2"),
    ]
    apart = [
        tn.Disk(name="engine and primary flywheel", inertia="0.14 kg*m^2", drive_share=1),
        tn.Shaft(name="DMF springs", stiffness="15 N*m/deg", damping="2 N*m*s/rad"),
        tn.Disk(name="secondary flywheel, clutch, gearbox input", inertia="0.06 kg*m^2"),
    ]
    engine = tn.Disk(name="engine", inertia="0.1 kg*m^2", drive_share=1)
    one = tn.DualMassFlywheel(
        name="flywheel", primary_inertia="0.04 kg*m^2", secondary_inertia="0.06 kg*m^2",
        stiffnesses=["15 N*m/deg"], damping="2 N*m*s/rad",
    )  # fmt: skip
    before, after = (tn.natural_frequencies(tn.Driveline([*front, *rear])) for front in (apart, [engine, one]))
    assert after.eigenvalue == pytest.approx(before.eigenvalue, rel=1e-9, abs=1e-9)


def test_one_equation_refuses_it() -> None:
    """Its masses are not those of the disks beside it."""
    line = tn.Driveline([tn.ConstantSpeed(), flywheel(**STAGES), tn.Disk(inertia=1.0, load_torque=20.0)])
    with pytest.raises(tn.InputError, match="is not one spring with stages between two inertias"):
        tn.exact_oscillator(line, 100.0)
