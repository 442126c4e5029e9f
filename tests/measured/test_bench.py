"""The synthetic bench: its pulses come where the written-out motion of the line passes its teeth."""

from __future__ import annotations

import re

import numpy as np
import pytest
from oracles.passing_order import states_on_run
from scipy.integrate import solve_ivp

import trunnion as tn

WEAK = tn.Driveline(
    [
        tn.ConstantSpeed(),
        tn.HookeJoint(angle="12 deg", name="joint"),
        tn.Shaft(stiffness=2e4, damping=25, name="tube"),
        tn.Disk(inertia=0.5, name="hub", excitation=[{"order": 1, "amplitude": 30.0, "phase": 0.4}]),
        tn.Ratio(ratio=2.0),
        tn.Shaft(stiffness=3e4, damping=10, name="rear"),
        tn.Disk(inertia=0.05, name="out"),
    ]
)


def written_out(speed: float) -> dict[str, dict[int, complex]]:
    """Orders 1 to 5 of the two disks: a joint, two springs and a ratio, solved as a 2 × 2 system.

    The joint's rotation is tan ψ = tan χ / cos β, its harmonics taken numerically; the torque by order acts at the
    angle behind it.
    """
    beta = np.deg2rad(12.0)
    chi = 2 * np.pi * np.arange(4096) / 4096
    lead = np.unwrap(np.arctan2(np.sin(chi), np.cos(beta) * np.cos(chi))) - chi
    ahead = 2 * np.fft.fft(lead) / 4096
    torque = 2 * np.fft.fft(30.0 * np.cos(chi + lead + 0.4)) / 4096
    found: dict[str, dict[int, complex]] = {"hub": {}, "out": {}}
    for k in range(1, 6):
        w = k * speed
        front, rear = 2e4 + 25j * w, 3e4 + 10j * w
        # out turns in its own shaft, at half the hub's speed: hub/2 is what the rear shaft sees in front.
        dynamic = np.array([[front + rear / 4 - 0.5 * w**2, -rear / 2], [-rear / 2, rear - 0.05 * w**2]])
        found["hub"][k], found["out"][k] = np.linalg.solve(dynamic, [front * ahead[k] + torque[k], 0.0])
    return found


def test_teeth_pass_where_the_motion_is() -> None:
    speed = 170.0
    run = tn.measure(WEAK, speed, 3.0, {"input": 50, "hub": 60, "out": 45}, start_angle=0.7)
    truth = written_out(speed)
    for train in run.pulses:
        ratio = 0.5 if train.name == "out" else 1.0
        phi = speed * train.times
        orders = truth.get(train.name, {})
        swing = sum((y * np.exp(1j * k * (phi + 0.7))).real for k, y in orders.items())
        teeth = (ratio * phi + swing) * train.pulses_per_turn / (2 * np.pi)
        assert np.abs(teeth - np.rint(teeth)).max() < 2e-5
        assert np.all(np.diff(np.rint(teeth)) == 1)
        assert np.abs(swing).max() > 1e-3 or train.name == "input"


def on_run(speed: np.ndarray, rate: float) -> dict[str, dict[int, np.ndarray]]:
    """The same while the speed changes, by the modes of both disks in closed form; "twist torque" of the rear shaft."""
    beta, count = np.deg2rad(12.0), 4096
    chi = 2 * np.pi * np.arange(count) / count
    lead = np.unwrap(np.arctan2(np.sin(chi), np.cos(beta) * np.cos(chi))) - chi
    ahead, shaken = 2 * np.fft.fft(lead) / count, 2 * np.fft.fft(30.0 * np.cos(chi + lead + 0.4)) / count
    stiff, loss = (
        np.array([[front + rear / 4, -rear / 2], [-rear / 2, rear]]) for front, rear in ((2e4, 3e4), (25.0, 10.0))
    )
    per_inertia = np.diag([1 / 0.5, 1 / 0.05])
    matrix = np.block([[np.zeros((2, 2)), np.eye(2)], [-per_inertia @ stiff, -per_inertia @ loss]])
    found: dict[str, dict[int, np.ndarray]] = {"hub": {}, "out": {}}
    for k in (1, 2, 4):
        drive = np.array([0.0, 0.0, (2e4 * ahead[k] + shaken[k]) / 0.5, 0.0])
        states = states_on_run(matrix, drive, np.array([0.0, 0.0, 25.0 * ahead[k] / 0.5, 0.0]), k, speed, rate)
        found["hub"][k], found["out"][k] = states[:, 0], states[:, 1]
    return found


def test_a_run_up_follows_the_motion() -> None:
    """Tracked orders of a run-up against the closed form of its motion: phases by the input's pulses."""
    run = tn.measure(
        WEAK, ("900 rpm", "2400 rpm"), 20.0, {"input": 60, "hub": 60, "out": 60}, gauges=["rear"], jitter=1e-7,
        gauge_noise=0.1,
    )  # fmt: skip
    found = tn.track_orders(run, [1, 2, 4], line=WEAK, reference="input", unit="rpm")
    assert found.ratios == (1.0, 1.0, 0.5, 1.0)
    rate = 1500 * 2 * np.pi / 60 / 20.0
    truth = on_run(found.speed, rate)
    assert abs(truth["hub"][2] - [written_out(float(one))["hub"][2] for one in found.speed]).max() > 1e-3
    settled = found.speed > found.speed[0] + 5.0  # how it begins is the bench's own
    for name in ("hub", "out"):
        c = found.column(name)
        for k in (1, 2, 4):
            off = np.abs(found.amplitude[:, found.row(k), c] - truth[name][k])
            limit = 6 * found.deviation[:, found.row(k), c] + 3e-5 * np.abs(truth[name][k]).max()
            assert np.all((off < limit)[settled])
    twist = truth["out"][2] - truth["hub"][2] / 2
    # (k + c d/dt) of a wave whose amplitude changes with the speed.
    torque = (3e4 + 10j * 2 * found.speed) * twist + 10.0 * rate * np.gradient(twist, found.speed)
    off = np.abs(found.amplitude[:, found.row(2), found.column("rear")] - torque)
    limit = 6 * found.deviation[:, found.row(2), found.column("rear")] + 3e-4 * np.abs(torque).max()
    assert np.all((off < limit)[settled])


def test_what_spoils_the_signals_is_as_asked() -> None:
    asked = {"pitch_error": 0.02, "wheels": 3, "missing": 0.01, "double": 0.01}
    run = tn.measure(WEAK, 150.0, 20.0, {"hub": 60}, jitter=1e-6, **asked)
    (wheel,) = run.pulses
    share = np.array([wheel.missing, wheel.double]) / wheel.number[-1]
    assert np.all((share > 0.007) & (share < 0.013))
    again = tn.measure(WEAK, 150.0, 20.0, {"hub": 60}, jitter=1e-6, **asked)
    assert np.array_equal(again.pulses[0].times, wheel.times)
    other = tn.measure(WEAK, 150.0, 20.0, {"hub": 60}, jitter=1e-6, seed=4, **asked)
    first = min(len(other.pulses[0].times), len(wheel.times))
    assert not np.array_equal(other.pulses[0].times[:first], wheel.times[:first])
    drifted = tn.measure(WEAK, 150.0, 5.0, {"hub": 60}, clock_drift={"hub": 1e-4})
    plain = tn.measure(WEAK, 150.0, 5.0, {"hub": 60})
    assert np.allclose(drifted.pulses[0].times, 1.0001 * plain.pulses[0].times, rtol=1e-14)
    assert drifted.pulses[0].clock != plain.pulses[0].clock


def test_a_second_recorder_is_brought_into_time() -> None:
    """200 ppm fast: 0.35 rad of phase at order 2 after 20 s, were it not found."""
    asked = (WEAK, ("900 rpm", "2400 rpm"), 20.0, {"input": 60, "hub": 60})
    plain = tn.track_orders(tn.measure(*asked, jitter=1e-7), [1, 2], line=WEAK)
    run = tn.measure(*asked, jitter=1e-7, clock_drift={"hub": 2e-4})
    late = [run.pulses[0], tn.PulseTrain(run.pulses[1].times + 3e-3, 60, name="hub", at="hub", clock="B")]
    found = tn.track_orders(tn.Measurement(late), [1, 2], line=WEAK)
    c = found.column("hub")
    off = np.abs(found.amplitude[:, :, c] - plain.amplitude[:, :, c]) / np.abs(plain.amplitude[:, :, c])
    assert off.max() < 5e-3
    (said,) = [one for one in found.findings if "Clock B" in str(one)]
    drift, offset = (float(x) for x in re.findall(r"(?:runs|is) ([\d.]+) ±", str(said)))
    assert abs(drift - 200) < 0.5 and abs(offset - 3) < 0.02
    steady = tn.measure(WEAK, 150.0, 10.0, {"input": 60, "hub": 60}, clock_drift={"hub": 2e-4})
    (said,) = [one for one in tn.track_orders(steady, [1, 2], line=WEAK).findings if "Clock" in str(one)]
    assert "its offset is not known" in str(said) and said.gravity.name == "CAUTION"


def test_a_run_up_follows_the_motion_however_fast() -> None:
    """A quarter of a second through a resonance: pulses of the hub against the integrated motion of both disks."""
    beta, ratio = np.deg2rad(12.0), 2.0
    first, last, duration = 100.0, 160.0, 0.6
    rate = (last - first) / duration

    def joint(phi: np.ndarray, speed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        psi = phi + np.arctan2(
            (1 / np.cos(beta) - 1) * np.sin(phi) * np.cos(phi), 1 + (1 / np.cos(beta) - 1) * np.sin(phi) ** 2
        )
        return psi, speed * np.cos(beta) / (1 - (np.sin(beta) * np.cos(phi)) ** 2)

    def motion(t: np.ndarray, y: np.ndarray) -> list[np.ndarray]:
        hub, out, hub_speed, out_speed = y
        phi, speed = first * t + rate * t**2 / 2, first + rate * t
        psi, turns = joint(phi, speed)
        tube = 2e4 * (hub - psi) + 25.0 * (hub_speed - turns)
        rear = 3e4 * (out - hub / ratio) + 10.0 * (out_speed - hub_speed / ratio)
        shaken = 30.0 * np.cos(psi + 0.4)
        return [hub_speed, out_speed, (shaken - tube + rear / ratio) / 0.5, -rear / 0.05]

    run = tn.measure(WEAK, (first, last), duration, {"input": 60, "hub": 60})
    (wheel,) = [one for one in run.pulses if one.name == "hub"]
    found = solve_ivp(
        motion,
        (0, duration),
        [0.0, 0.0, first, first / ratio],
        method="DOP853",
        rtol=1e-10,
        atol=1e-11,
        dense_output=True,
    )
    settled = wheel.times[wheel.times > 0.3]
    teeth = found.sol(settled)[0] * 60 / (2 * np.pi)
    # The shaft is twisted by what accelerates the disks, which pulses do not show.
    off = (teeth - np.rint(teeth)) * 2 * np.pi / 60
    swing = found.sol(settled)[0] - (first * settled + rate * settled**2 / 2)
    assert np.abs(off - off.mean()).max() < 0.01 * np.abs(swing - swing.mean()).max()


REFUSED = (
    (lambda: tn.measure(WEAK, 150.0, 1.0, {"hubb": 60}), "pickups = 'hubb': is not a disk of the line; did you mean"),
    (lambda: tn.measure(WEAK, 150.0, 1.0, {"hub": 60}, gauges=["hub"]), "gauges = 'hub': is not a spring of the line"),
    (lambda: tn.measure(WEAK, 150.0, 1.0, {"hub": 1}), "pickups.hub = 1: must be a whole number, 2 or more"),
    (lambda: tn.measure(WEAK, 150.0, -1.0, {"hub": 60}), "duration = -1: must be positive"),
    (lambda: tn.measure(WEAK, -3.0, 1.0, {"hub": 60}), "speeds = -3: must be positive"),
    (lambda: tn.measure(WEAK, 150.0, 1.0, {"hub": 60}, jitter=-1e-6), "jitter = -1e-06: must not be negative"),
    (lambda: tn.measure(WEAK, 150.0, 1.0, {"hub": 60}, missing=0.5), "missing = 0.5: must be a share below 0.2"),
    (lambda: tn.measure(WEAK, 150.0, 0.01, {"hub": 60}), "hub.times = 15: holds less than two turns"),
)


@pytest.mark.parametrize(("ask", "said"), REFUSED)
def test_what_the_bench_refuses(ask, said) -> None:
    with pytest.raises(tn.InputError) as caught:
        ask()
    assert str(caught.value).startswith(said), str(caught.value)


def test_a_wheel_that_turns_otherwise_than_its_place_is_refused() -> None:
    """Wrong pulses per turn, and pickups of two shafts swapped."""
    run = tn.measure(WEAK, 150.0, 4.0, {"input": 60, "out": 60})
    swapped = tn.Measurement([run.pulses[0], tn.PulseTrain(run.pulses[1].times, 60, name="out", at="hub")])
    with pytest.raises(tn.InputError, match="turns 0.5 times a turn of the input, where hub turns 1 times; 30 pulses"):
        tn.track_orders(swapped, [1], line=WEAK, reference="input")
    wrong = tn.Measurement([run.pulses[0], tn.PulseTrain(run.pulses[1].times, 48, name="out", at="out")])
    with pytest.raises(tn.InputError, match="where out turns 0.5 times; 60 pulses a turn would fit"):
        tn.track_orders(wrong, [1], line=WEAK, reference="input")
