"""Orders of pulse trains and signals whose rotation is written down, not computed by the package."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import trunnion as tn

Amplitude = Callable[[np.ndarray], np.ndarray]
FIRST, RISE, LAST = 60.0, 12.0, 20.0
"""Speed [rad/s] at the beginning, acceleration [rad/s²], end [s]."""


def resonance(at: float, damping: float, size: float, phase: float = 0.3) -> Amplitude:
    """A response curve over the speed."""
    return lambda speed: size * np.exp(1j * phase) / (1 - (speed / at) ** 2 + 2j * damping * speed / at)


def rotation(time: np.ndarray) -> np.ndarray:
    return FIRST * time + RISE * time**2 / 2


def swing(time: np.ndarray, orders: dict[float, Amplitude]) -> np.ndarray:
    phi, speed = rotation(time), FIRST + RISE * time
    return sum(((y(speed) * np.exp(1j * k * phi)).real for k, y in orders.items()), np.zeros(len(time)))


def pulses(
    teeth: int, orders: dict[float, Amplitude], ratio: float = 1.0, *, jitter: float = 0.0,
    pattern: np.ndarray | None = None, seed: int = 0, begin: float = -1.0, **more: object,
) -> tn.PulseTrain:  # fmt: skip
    """Edges of a wheel that turns by ratio·φ(t) + Σ Re Y e^{ikφ}, by bisection."""
    pattern = np.zeros(teeth) if pattern is None else pattern
    number = np.arange(int(ratio * rotation(np.array([LAST]))[0] / (2 * np.pi) * teeth))
    target = 2 * np.pi * number / teeth + pattern[number % teeth]
    low, high = np.full(len(target), -0.1), np.full(len(target), LAST + 0.1)
    for _ in range(60):
        time = (low + high) / 2
        beyond = ratio * rotation(time) + swing(time, orders) > target
        low, high = np.where(beyond, low, time), np.where(beyond, time, high)
    times = (low + high) / 2 + jitter * np.random.default_rng(seed).standard_normal(len(target))
    return tn.PulseTrain(np.sort(times[times >= begin]), teeth, **more)


ORDERS = {1.0: resonance(150.0, 0.03, 2e-4), 2.0: resonance(150.0, 0.05, 1.5e-3), 3.0: resonance(90.0, 0.08, 3e-4)}


def errors(found: tn.PulseTrain, channel: str, orders: dict[float, Amplitude]) -> dict[float, np.ndarray]:
    """By order (window,): complex error over the standard deviation of either part."""
    c = found.column(channel)
    return {
        k: (found.amplitude[:, found.row(k), c] - y(found.speed)) / found.deviation[:, found.row(k), c]
        for k, y in orders.items()
    }


def test_a_run_up_without_noise() -> None:
    even = pulses(60, {}, name="in")
    found = tn.track_orders(tn.Measurement([even, pulses(60, ORDERS, name="out")]), [1, 2, 3])
    assert found.speed[0] < 70 and found.speed[-1] > 290 and np.all(np.diff(found.speed) > 0)
    assert np.abs(found.speed - (FIRST + RISE * found.time)).max() < 1e-6
    for k, y in ORDERS.items():
        true, got = y(found.speed), found.amplitude[:, found.row(k), found.column("out")]
        assert np.abs(got - true).max() < 4e-3 * np.abs(true).max()
        # What a quadratic over a window misses is stated.
        assert np.all(np.abs(got - true) <= 3 * found.deviation[:, found.row(k), found.column("out")] + 1e-9)


def test_the_reference_may_swing_itself() -> None:
    found = tn.track_orders(tn.Measurement([pulses(60, ORDERS, name="hub")]), [1, 2, 3])
    for k, y in ORDERS.items():
        true, got = y(found.speed), found.amplitude[:, found.row(k), 0]
        # Its first edge is that of tooth 0, whose rotation is the input's but for the swing there.
        assert np.abs(np.abs(got) - np.abs(true)).max() < 5e-3 * np.abs(true).max()


@pytest.mark.parametrize("jitter", [2e-7, pytest.param(2e-6, marks=pytest.mark.slow)])
def test_intervals_hold_what_they_say(jitter: float) -> None:
    """With a reference run, 2 % of pitch error and noise of the edges: strong orders to half a percent, all inside."""
    rng = np.random.default_rng(11)
    wheels = {name: 0.02 * 2 * np.pi / 60 * rng.standard_normal(60) for name in ("in", "out")}
    wheels = {name: one - one.mean() for name, one in wheels.items()}
    straight = [pulses(60, {}, name=n, pattern=p, jitter=jitter, seed=5, begin=0.31) for n, p in wheels.items()]
    run = [
        pulses(60, ORDERS if n == "out" else {}, name=n, pattern=p, jitter=jitter, seed=6) for n, p in wheels.items()
    ]
    calibration = tn.pitch_errors(tn.Measurement(straight))
    found = tn.track_orders(tn.Measurement(run), [1, 2, 3], calibration=calibration)
    inside = []
    for k, y in ORDERS.items():
        c, row = found.column("out"), found.row(k)
        got, true = found.amplitude[:, row, c], y(found.speed)
        strong = np.abs(true) >= np.abs(ORDERS[2.0](found.speed)).max() / 10
        if jitter < 1e-6:
            assert np.all(np.abs(np.abs(got) - np.abs(true))[strong] < 5e-3 * np.abs(true)[strong])
        inside.append(np.abs(np.abs(got) - np.abs(true)) <= found.half_width[:, row, c])
    share = np.mean(inside)
    assert 0.92 <= share <= 1.0, share
    assert not found.hidden.any() and found.calibrated


def test_without_a_reference_run_the_wheel_is_named() -> None:
    """2 % of 60 teeth leave 541 µrad rms at whole orders: a joint of 1° makes 76 at order 2."""
    rng = np.random.default_rng(2)
    pattern = 0.02 * 2 * np.pi / 60 * rng.standard_normal(60)
    joint = {2.0: lambda speed: 7.6e-5 + 0j * speed}
    run = tn.Measurement([pulses(60, {}, name="in"), pulses(60, joint, name="out", pattern=pattern - pattern.mean())])
    found = tn.track_orders(run, [0.5, 2])
    out, row = found.column("out"), found.row(2)
    assert bool(found.hidden[row, out]) and not found.hidden[found.row(0.5), out]
    assert found.floor[row, out] == pytest.approx(0.02 * 2 * np.pi / 60 * 2 / np.sqrt(60))
    said = [str(one) for one in found.findings if "may be the wheel's" in str(one)]
    assert len(said) == 2 and "out: order 2" in said[1] and "541 µrad" in said[1]
    assert np.all(found.half_width[:, row, out] > 5e-4)
    # Averaging does not help: what stays is the wheel's own order, not the joint's.
    own = 2 * np.abs(np.sum(pattern * np.exp(-2j * 2 * np.pi * np.arange(60) / 60))) / 60
    assert np.abs(found.amplitude[:, row, out]).mean() == pytest.approx(own, abs=1.2e-4)


def test_a_geared_shaft_and_a_reversed_wheel() -> None:
    beside = {1.55: lambda speed: 4e-4 * np.exp(0.5j) + 0j * speed}
    run = tn.Measurement(
        [pulses(60, {}, name="in"), pulses(31, beside, 31 / 20, name="pinion"),
         pulses(48, ORDERS, name="back", reversed=True)]
    )  # fmt: skip
    found = tn.track_orders(run, [1, 1.55, 2, 3])
    pinion = found.column("pinion")
    assert found.ratios[pinion] == pytest.approx(1.55, rel=1e-12)
    got = found.amplitude[:, found.row(1.55), pinion]
    assert np.abs(got - 4e-4 * np.exp(0.5j)).max() < 1e-6
    assert bool(found.hidden[found.row(1.55), pinion]) and not found.hidden[found.row(2), pinion]
    back = found.amplitude[:, found.row(2), found.column("back")]
    assert np.abs(back + ORDERS[2.0](found.speed)).max() < 5e-3 * np.abs(back).max()
    twist, spread = found.twist("in", "back")
    assert np.allclose(twist[:, found.row(2)], back - found.amplitude[:, found.row(2), 0]) and np.all(spread > 0)


def test_a_torque_beside_the_pulses() -> None:
    time = np.arange(int(LAST * 20_000)) / 20_000.0
    torque = {k: (lambda speed, y=y: 1e5 * y(speed)) for k, y in ORDERS.items()}
    noise = 0.5 * np.random.default_rng(4).standard_normal(len(time))
    gauge = tn.SampledSignal(250.0 + 2 * time + swing(time, torque) + noise, 20_000.0, name="tube", kind="torque")
    found = tn.track_orders(tn.Measurement([pulses(60, {}, name="in"), gauge]), [1, 2, 3])
    for k, off in errors(found, "tube", torque).items():
        assert 0.8 < np.sqrt(np.mean(np.abs(off) ** 2) / 2) < 1.35, k


def test_orders_are_found_by_themselves() -> None:
    found = tn.track_orders(
        tn.Measurement([pulses(60, {}, name="in", pitch_error=0.0), pulses(60, ORDERS, name="out", pitch_error=0.0)])
    )
    assert found.order.tolist() == [1, 2, 3]


def test_a_reference_run_tells_which_orders_are_the_shafts() -> None:
    """A joint of 2° makes 305 µrad at order 2, pitch errors of 2 % 541 at every whole one: the run finds it."""
    rng = np.random.default_rng(8)
    wheels = {name: 0.02 * 2 * np.pi / 60 * rng.standard_normal(60) for name in ("in", "out")}
    joint = {2.0: lambda speed: 3.05e-4 + 0j * speed, 1.5: lambda speed: 4e-5 + 0j * speed}

    def run(orders: dict[float, Amplitude], seed: int, begin: float) -> tn.Measurement:
        made = {"in": {}, "out": orders}
        noise = {"jitter": 2e-7, "seed": seed, "begin": begin}
        return tn.Measurement([pulses(60, made[n], name=n, pattern=p, **noise) for n, p in wheels.items()])

    calibration = tn.pitch_errors(run({}, 1, 0.31))
    assert tn.track_orders(run(joint, 2, -1.0), calibration=calibration).order.tolist() == [1.5, 2]
    assert tn.track_orders(run(joint, 2, -1.0)).order.tolist() == [1.5]
    with pytest.raises(tn.InputError) as caught:
        tn.track_orders(run({2.0: joint[2.0]}, 3, -1.0))
    assert "above its noise and the pitch errors of its wheels, as stated; name the orders, or take a refer" in str(
        caught.value
    )
    with pytest.raises(tn.InputError, match="shows no order above its noise; name the orders, or record longer"):
        tn.track_orders(run({}, 4, 0.4), calibration=calibration)


def test_a_run_up_is_found_between_dwells() -> None:
    """40 rad/s for 4 s, up to 200 in 10 s, 6 s there, down to 100 in 5 s."""
    corners, speeds = np.array([0.0, 4.0, 14.0, 20.0, 25.0]), np.array([40.0, 40.0, 200.0, 200.0, 100.0])
    time = np.linspace(0.0, 25.0, 250_001)
    speed = np.interp(time, corners, speeds)
    turned = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2 * np.diff(time))])
    wheel = tn.PulseTrain(np.interp(2 * np.pi * np.arange(int(turned[-1] / 2 / np.pi * 30)) / 30, turned, time), 30)
    up, down = tn.run_ups(wheel)
    assert up.first_time == pytest.approx(4.0, abs=0.5) and up.last_time == pytest.approx(14.0, abs=0.5)
    assert down.first_time == pytest.approx(20.0, abs=0.5) and down.last_speed == pytest.approx(100.0, rel=0.05)
    found = tn.track_orders(tn.Measurement([wheel]), [1])
    assert found.time[0] > 3.5 and found.time[-1] < 14.5
    whole = tn.track_orders(tn.Measurement([wheel]), [1], between=(0.1, 3.9))
    assert np.ptp(whole.speed) < 0.01


def test_a_run_whose_shaft_vibrates_is_no_reference() -> None:
    vibrates = tn.Measurement([pulses(60, ORDERS, name="out", jitter=1e-7)])
    found = tn.pitch_errors(vibrates)
    assert "vibrated at orders of the wheel" in str(found.findings[0])
    quiet = tn.pitch_errors(tn.Measurement([pulses(60, {}, name="out", jitter=1e-7)]))
    assert not quiet.findings and np.abs(quiet.error).max() < 6 * quiet.deviation[0]


def test_windows_without_pulses_leave_the_others_known() -> None:
    """A pickup that begins later: windows beside those it misses keep their intervals, and these hold."""
    late = pulses(60, ORDERS, jitter=1e-6, seed=1, begin=4.0, name="hub")
    whole = pulses(60, {}, jitter=1e-6, seed=2, name="input")
    found = tn.track_orders(tn.Measurement([whole, late]), list(ORDERS), reference="input")
    c = found.column("hub")
    there = np.isfinite(found.amplitude[:, :, c])
    assert np.array_equal(there, np.isfinite(found.deviation[:, :, c])) and 0 < (~there).sum() < there.size / 2
    with np.errstate(invalid="ignore"):
        worst = max(float(np.nanmax(np.abs(one))) for one in errors(found, "hub", ORDERS).values())
    assert worst < 6.0 and "nan" not in str(found)
