"""Free–free lines, run up by their drives and followed over speed, against closed forms and balances."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

import trunnion as tn


def pair(angle: float = 0.0, damping: float = 4.0, **load: object) -> tn.Driveline:
    return tn.Driveline(
        [
            tn.Disk(inertia=0.4, drive_share=1.0),
            tn.HookeJoint(angle=angle),
            tn.Shaft(stiffness=6e3, damping=damping),
            tn.Disk(inertia=0.9, **load),
        ]
    )


@pytest.mark.parametrize(
    ("load", "torque"),
    [
        ({"load_torque": 5.0}, lambda w: 5.0),
        ({"viscous_load": 0.2, "quadratic_load": 0.004}, lambda w: 0.2 * w + 0.004 * w**2),
    ],
)
def test_the_shaft_carries_what_accelerates_the_inertia_behind_it_and_the_load(load, torque) -> None:
    """J₂ a + M(ω) at constant acceleration, up and down; a load that grows with speed lags by c ȧ/k, nearly nothing."""
    for first, last in ((20.0, 60.0), (60.0, 20.0)):
        run = tn.run_up(pair(**load), first, last, acceleration=10.0, steady=0)
        end = run.simulation.end
        rise = 0.9 * np.sign(last - first) * 10.0
        found = run.simulation.motion_at(np.array([0.9 * end])).torque[0, 0]
        wanted = -rise - torque(float(run.simulation.profile.at(0.9 * end)))
        assert found == pytest.approx(wanted, abs=1e-4)
        assert run.inertia_torque == pytest.approx([9.0]) and np.abs(run.lag).max() < 0.05
        # Once the ramp is over nothing vibrates about the quasi-static torque.
        assert run.vibration[-3:].max() < 2e-3 * abs(wanted)
    assert "the drives carry the loads" in str(run)


def test_shares_and_ratios_divide_what_accelerates() -> None:
    """Two drives 1 : 3 in power about a ratio of 2: each shaft carries what lies behind it, less the drives there."""
    line = tn.Driveline(
        [
            tn.Disk(inertia=1.0, drive_share=1.0),
            tn.Shaft(stiffness=1e4, damping=20.0),
            tn.Disk(inertia=1.0),
            tn.Ratio(ratio=-2.0),
            tn.Disk(inertia=1.0, drive_share=3.0),
            tn.Shaft(stiffness=1e4, damping=20.0),
            tn.Disk(inertia=2.0),
        ]
    )
    run = tn.run_up(line, 30.0, 50.0, acceleration=8.0, steady=0)
    total = 1.0 + 1.0 + (1.0 + 2.0) / 4
    first = (total - 1.0) * 8.0 - 0.75 * total * 8.0
    second = 2.0 * 8.0 / 2
    np.testing.assert_allclose(run.inertia_torque, np.abs([first, second]), rtol=1e-12)
    found = run.simulation.motion_at(np.array([0.95 * run.simulation.end])).torque[0]
    np.testing.assert_allclose(np.abs(found), np.abs([first, second]), rtol=1e-4)


def test_energy_of_a_bent_line_comes_from_its_drive() -> None:
    """Undamped: the energy gained is the drive's power less the load's, their torques written anew."""
    line = pair(0.4, damping=0.0, load_torque=7.0, viscous_load=0.3)
    rise, first = 12.0, 30.0
    run = tn.simulate(line, 1.5, speed=tn.SpeedProfile([0.0, 2.0], [first, first + 2.0 * rise]), tolerance=1e-11)
    piece, n = run.pieces[0], 2
    assert run.line.names == ("Disk 1", "Disk 2")

    def power(t: float) -> float:
        omega = first + rise * t
        v = omega + piece.at(np.array([t]))[0, n:]
        drive = (0.4 + 0.9) * rise + 7.0 + 0.3 * omega
        return float(drive * v[0] - (7.0 + 0.3 * v[1]) * v[1])

    ends = np.array([0.0, run.end])
    # The frame turns ever faster: kinetic energy by the true speeds, written here.
    speeds = first + rise * ends[:, None] + piece.at(ends)[:, n:]
    kinetic = 0.5 * (np.array([0.4, 0.9]) * speeds**2).sum(axis=1)
    twist = run.motion_at(ends).twist[:, 0]
    gained = float(np.diff(kinetic + 0.5 * 6e3 * twist**2)[0])
    edges = np.linspace(0.0, run.end, 60)
    given = sum(quad(power, a, b, epsabs=1e-9, epsrel=1e-9)[0] for a, b in zip(edges[:-1], edges[1:], strict=True))
    assert gained == pytest.approx(given, rel=1e-7) and gained > 500


def test_momentum_of_a_straight_line_follows_the_profile() -> None:
    """The drives' torque less the loads is J a at every instant, whatever the shafts do."""
    run = tn.run_up(pair(damping=0.0, load_torque=5.0), 20.0, 40.0, acceleration=30.0, ramp=0.0, steady=0)
    rates = run.simulation.at(np.linspace(0, run.simulation.end, 50))[:, 2:]
    assert np.abs(rates @ [0.4, 0.9]).max() < 1e-7 and np.ptp(rates[:, 0]) > 0.1


@pytest.mark.slow
def test_a_branch_over_speed_passes_through_the_motions_at_single_speeds() -> None:
    line = pair(0.3, load_torque=50.0).replace("Disk 1", excitation=[{"order": 1, "amplitude": 20.0}])
    branch = tn.periodic_branch(line, "speed", 70.0, 100.0, longest_step=0.1)
    assert branch.outcome.ok and branch.stable.all()
    for speed in (74.0, 93.0):
        alone = tn.periodic_response(line, speed)
        ((swing, verdict),) = branch.swings_at(speed)
        np.testing.assert_allclose(swing, alone.torque_peak_to_peak, rtol=1e-8)
        assert verdict is alone.verdict
    # Two multipliers are set aside: of the phase, and of the speed that no torque depends on.
    counted = branch.multipliers[np.isfinite(branch.multipliers)].reshape(len(branch.parameter), -1)
    assert counted.shape[1] == 2 and np.abs(counted).max() < 0.9
    response = tn.frequency_response(line, 70.0, 100.0, longest_step=0.1)
    assert response.method == "shooting"
    np.testing.assert_allclose(response.half_peak_to_peak, branch.peak_to_peak[:, 0] / 2)


def test_a_run_up_of_a_bent_line_reaches_the_steady_torque_or_is_held_back() -> None:
    """A weak resonance is passed as slowly as asked; one that takes more holds the line back (Sommerfeld)."""
    weak = tn.run_up(pair(0.1, load_torque=50.0), 60.0, 90.0, acceleration=4.0, steady=11)
    assert weak.steady is not None and weak.outcome.ok and weak.lag.max() < 1.0
    np.testing.assert_allclose(weak.peak_vibration, weak.steady_vibration, rtol=0.1)
    strong = tn.run_up(pair(0.3, load_torque=50.0), 60.0, 90.0, acceleration=4.0, steady=0)
    assert strong.lag.max() > 5.0 and "slower than asked" in str(strong)


def test_what_leaves_the_drive_open_is_refused() -> None:
    line = tn.Driveline([tn.Disk(inertia=0.4, load_torque=-50.0), *pair(0.3, load_torque=50.0).elements[1:]])
    for ask in (
        lambda: tn.run_up(line, 60.0, 100.0, acceleration=8.0),
        lambda: tn.safe_accelerations(line, 60.0, 100.0, limit=100.0, accelerations=(1.0, 10.0), points=2),
        lambda: tn.simulate(line, 0.1, speed=tn.SpeedProfile([0.0, 1.0], [60.0, 70.0])),
    ):
        with pytest.raises(tn.InputError, match=r"drive_share: is free–free, and no disk has a share.*\"Disk 1\" say"):
            ask()
    with pytest.raises(tn.InputError, match=r"nothing drives"):
        tn.periodic_branch(line.replace("Disk 1", load_torque=0.0), "speed", 60.0, 70.0)
    with pytest.raises(tn.InputError, match=r"series of harmonics.*shooting"):
        tn.harmonic_balance(pair(0.3), "speed", 60.0, 70.0)
    with pytest.raises(tn.InputError, match=r"periods"):
        tn.periodic_branch(pair(0.3), "speed", 60.0, 70.0, periods=2)


def test_sweeps_behind_a_reduction_are_the_periodic_motions_there() -> None:
    """The joint turns 3.5 times slower than the input: a sweep by harmonics against motions found by integration."""
    parts = [tn.Disk(inertia=2.0, drive_share=1.0), tn.Ratio(ratio=3.5), *pair(0.2, load_torque=50.0).elements]
    line = tn.Driveline(parts).replace("Disk 2", drive_share=None)
    speeds = [150.0, 300.0]
    swept = tn.speed_sweep(line, speeds)
    motions = [tn.periodic_response(line, speed=speed) for speed in speeds]
    np.testing.assert_allclose(swept.torque_amplitude, [motion.torque_amplitude for motion in motions], rtol=1e-9)
    np.testing.assert_allclose(swept.torque_mean, [motion.torque_mean for motion in motions], rtol=1e-9)
