"""Linear beside nonlinear response: closed forms, and what is said where they part (the law of their difference:
``test_linear_limit.py``)."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn


def shaken(spring, amplitude=20.0, order=2.0, phase=0.7, drive=None):
    """A held drive, a stiff shaft, a disk, the spring, and a disk that is shaken."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            drive or tn.Shaft(name="front", stiffness=4e4, damping=8.0),
            tn.Disk(name="hub", inertia=0.2),
            spring,
            tn.Disk(name="load", inertia=0.5, excitation=[{"order": order, "amplitude": amplitude, "phase": phase}]),
        ]
    )


def test_a_straight_line_is_the_closed_form_in_both_with_phases():
    k1, c1, k2, c2, j1, j2, w, order = 4e4, 8.0, 1e4, 3.0, 0.2, 0.5, 70.0, 2.0
    v = order * w
    z1, z2 = k1 + 1j * v * c1, k2 + 1j * v * c2
    matrix = np.array([[z1 + z2 - v**2 * j1, -z2], [-z2, z2 - v**2 * j2]])
    y = np.linalg.solve(matrix, [0.0, 20.0 * np.exp(0.7j)])
    check = tn.linearity_check(shaken(tn.Shaft(name="spring", stiffness=k2, damping=c2)), w, tolerance=1e-13)
    assert check.order[0] == order and check.springs == ("front", "spring")
    expected = [z1 * y[0], z2 * (y[1] - y[0])]
    assert check.linear_torque[0] == pytest.approx(expected, rel=1e-11)
    # The excitation turns with its disk: ikT y of slope, a few thousandths of its amplitude, mostly at order 4.
    assert not check.linear_torque[1:].any() and check.order[1] == 2 * order
    assert check.nonlinear_torque[0] == pytest.approx(expected, rel=1e-3)
    assert check.peak_torque[0] == pytest.approx(np.abs(expected), rel=1e-9)


def test_an_excitation_fixed_in_time_stands_at_its_frequency_over_the_speed():
    line = shaken(tn.Shaft(name="spring", stiffness=1e4, damping=3.0)).replace(
        "load", excitation=[{"frequency": 210.0, "amplitude": 20.0}]
    )
    check = tn.linearity_check(line, 70.0, tolerance=1e-13)
    assert check.order == pytest.approx([3.0]) and check.departure < 1e-9


def test_sidebands_of_a_fixed_frequency_fold_onto_their_order():
    """Behind a joint 1.5 cycles a turn make sidebands at 0.5 (from −0.5) and 3.5."""
    line = shaken(
        tn.Shaft(name="spring", stiffness=1e4, damping=3.0), drive=tn.Shaft(name="front", stiffness=4e4, damping=8.0)
    ).replace("load", excitation=[{"frequency": 105.0, "amplitude": 20.0}])
    bent = tn.Driveline([*line.elements[:3], tn.HookeJoint(angle=0.1), *line.elements[3:]])
    check = tn.linearity_check(bent, 70.0, tolerance=1e-13)
    assert {0.5, 1.5, 2.0, 3.5} <= set(np.round(check.order, 9))
    at = np.flatnonzero(np.isclose(check.order, 0.5))[0]
    assert check.linear_torque[at] == pytest.approx(check.nonlinear_torque[at], rel=0.05)
    assert check.departure < 2e-3


def test_a_mesh_that_loses_contact_is_named():
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.HookeJoint(angle=0.2),
            tn.Shaft(name="front", stiffness=1e4, damping=5),
            tn.Disk(inertia=0.1),
            tn.GearPair(
                name="mesh", teeth_in=25, teeth_out=40, module="3 mm", mesh_stiffness=1e8, mesh_damping=500.0,
                backlash="0.1 mm",
            ),
            tn.Disk(inertia=0.3, load_torque=20),
        ]
    )  # fmt: skip
    check = tn.linearity_check(line, 100.0)
    assert not check.holds and check.departure > check.allowed
    assert check.because[0].startswith("contact is lost, mesh lands on")
    assert "Linear theory misleads at 100 rad/s: order " in str(check) and "contact is lost, mesh" in str(check)
    pressed = tn.linearity_check(line.replace("HookeJoint 1", angle=0.01), 100.0)
    assert pressed.holds and not pressed.because


def test_stages_without_play_are_not_called_contact():
    spring = tn.PiecewiseShaft.symmetric([(5e3, 0.002), (2e4, None)], damping=3.0, name="spring")
    check = tn.linearity_check(shaken(spring, amplitude=60.0), 60.0)
    assert not check.holds
    assert check.because == ("spring passes through more than one of its stages, of which linear theory has one",)


def test_a_clutch_that_sticks_is_a_spring_and_one_that_slips_is_said_to():
    """Stuck, spring and sliders stand in parallel; slipping, the area of the loop gives the loss (Masing's rule):
    a slider of T and k at the swing A takes 4T(A − T/k) a cycle."""
    clutch = tn.Clutch(name="clutch", stiffnesses=[6e3], damping=3.0, friction=[{"torque": 30.0, "stiffness": 5e3}])
    stuck = tn.linearity_check(shaken(clutch, amplitude=1.0), 60.0, tolerance=1e-13)
    (one,) = stuck.stand_ins
    assert one.slipping == 0 and one.stiffness == pytest.approx(1.1e4) and one.damping == pytest.approx(3.0)
    assert stuck.departure < 1e-3 and not stuck.because
    slips = tn.linearity_check(shaken(clutch, amplitude=120.0), 60.0)
    (one,) = slips.stand_ins
    reach = 30.0 / 5e3
    assert one.slipping == 1 and one.swing > reach
    lost = 4 * 30.0 * (one.swing - reach)
    assert one.damping == pytest.approx(3.0 + lost / (np.pi * one.swing**2 * one.frequency))
    assert one.frequency == pytest.approx(2 * 60.0, rel=1e-6)
    assert slips.because[0].startswith("clutch slips: ")
    at = slips.order.tolist().index(2.0)
    # Harmonic linearisation at the true swing: its own order within some per cent, the third harmonic not at all.
    assert slips.linear_torque[at, 1] == pytest.approx(slips.nonlinear_torque[at, 1], rel=0.1)
    third = slips.order.tolist().index(6.0)
    assert abs(slips.linear_torque[third, 1]) == 0 < abs(slips.nonlinear_torque[third, 1])


def test_an_unstable_motion_never_holds():
    line = tn.catalogue("two-shaft-cardan").replace("HookeJoint 1", angle=0.3)
    rates = [(tn.stability(line, w).growth_rate, w) for w in np.linspace(0.5, 2.5, 81)]
    worst, speed = max(rates)
    assert worst > 0
    check = tn.linearity_check(line, speed)
    assert not check.holds and "is unstable: a disturbance grows" in str(check)


def test_a_free_line_is_compared_at_the_speed_that_its_drives_keep():
    """Straight, in closed form: the twist of two masses between which order 2 acts."""
    j1, j2, k, c, w = 0.4, 0.6, 8e3, 4.0, 100.0
    line = tn.Driveline(
        [
            tn.Disk(name="motor", inertia=j1, drive_share=1, excitation=[{"order": 2, "amplitude": 0.5}]),
            tn.Shaft(name="shaft", stiffness=k, damping=c),
            tn.Disk(name="fan", inertia=j2, load_torque=50.0),
        ]
    )
    check = tn.linearity_check(line, w, tolerance=1e-13)
    v, m = 2 * w, j1 * j2 / (j1 + j2)
    z = k + 1j * v * c
    expected = -z * 0.5 * (m / j1) / (z - v**2 * m)
    assert check.linear_torque[0, 0] == pytest.approx(expected, rel=1e-10)
    # The reference of phases is the input without its vibration: the load's twist does not turn them.
    assert check.nonlinear_torque[0, 0] == pytest.approx(expected, rel=1e-4)


def test_a_slow_passage_reaches_the_linear_response_and_a_brisk_one_does_not():
    line = shaken(tn.Shaft(name="spring", stiffness=1e4, damping=6.0), amplitude=5.0, order=1.0)
    modes = tn.natural_frequencies(line)
    slow, brisk = (tn.linearity_check(line, modes.frequency[0], acceleration=a) for a in (3.0, 100.0))
    peak = np.abs(tn.order_response(line, modes.frequency[0] * np.linspace(0.9, 1.1, 401)).torque[:, 0]).max(axis=0)
    assert slow.passage.linear == pytest.approx(peak, rel=5e-3)
    assert slow.passage.vibration == pytest.approx(slow.passage.linear, rel=0.02)
    assert np.all(brisk.passage.vibration < 0.8 * brisk.passage.linear)
    assert "Passed at 3 rad/s² from " in str(slow)


def test_nothing_to_compare_is_said():
    line = shaken(tn.Shaft(name="spring", stiffness=1e4, damping=6.0), amplitude=0.0).replace("load", excitation=[])
    check = tn.linearity_check(line, 50.0)
    assert check.departure == 0.0 and "there is nothing to compare" in str(check)


def test_it_is_drawn_and_declared():
    check = tn.linearity_check(shaken(tn.Shaft(name="spring", stiffness=1e4, damping=3.0)), 70.0)
    axes = check.plot(spring="spring", unit="rpm")
    bars = axes.containers
    assert bars[0][0].get_height() == pytest.approx(abs(check.linear_torque[0, 1]))
    assert bars[1][0].get_height() == pytest.approx(abs(check.nonlinear_torque[0, 1]))
    assert "668.451 rpm: linear theory holds" in axes.get_title(loc="left")
    assert check.data.linear_torque.dims == ("order", "spring", "part")
    assert check.to_dict()["holds"] == 1
    with pytest.raises(tn.InputError, match=r"spring = .rear.: is not a spring of this line; it has: front, spring"):
        check.plot(spring="rear")
