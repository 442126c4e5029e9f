"""Vold–Kalman against dense equations and known envelopes; averages and maps over the rotation."""

from __future__ import annotations

import numpy as np
import pytest
from measured.test_tracked_orders import FIRST, LAST, ORDERS, RISE, pulses, rotation, swing

import trunnion as tn
from trunnion.measured.tracking.vold_kalman import envelopes_of


def test_the_band_matrix_is_that_of_the_least_squares() -> None:
    """The same minimum from a dense matrix with real unknowns: cosine and sine of every envelope at every sample."""
    rng = np.random.default_rng(0)
    samples, width = 60, 0.05
    phase = np.cumsum(rng.uniform(0.3, 0.5, (samples, 2)), axis=0) * [1.0, 2.0]
    values = rng.standard_normal(samples)
    found, _ = envelopes_of(values, phase, width)
    weight = np.sqrt((np.sqrt(2) - 1) / (2 - 2 * np.cos(np.pi * width)) ** 2)
    second = np.diff(np.eye(samples), 2, axis=0)
    zero = np.zeros_like(second)
    # y = Σ x e^{iΘ} with complex x whose half belongs to the real signal.
    waves = [np.diag(np.exp(1j * phase[:, k])) for k in range(2)]
    rows = np.concatenate(
        [np.concatenate(waves, axis=1), weight * np.concatenate([second, zero], axis=1),
         weight * np.concatenate([zero, second], axis=1)]
    )  # fmt: skip
    right = np.concatenate([2 * values.astype(complex), np.zeros(2 * (samples - 2), dtype=complex)])
    dense = np.linalg.lstsq(rows, right, rcond=None)[0].reshape(2, samples).T
    assert np.abs(found - dense).max() < 1e-9 * np.abs(dense).max()


def test_a_single_order_is_passed_as_the_bandwidth_says() -> None:
    """An envelope that swings at half the bandwidth keeps 1/√2 of its size."""
    width, samples = 0.004, 40_000
    time = np.arange(samples)
    envelope = np.cos(np.pi * width * time)
    phase = (2 * np.pi * 0.1 * time)[:, None]
    found, _ = envelopes_of(envelope * np.cos(phase[:, 0]), phase, width)
    middle = slice(5000, -5000)
    assert np.abs(found[middle, 0].real).max() == pytest.approx(1 / np.sqrt(2), rel=2e-3)


def test_orders_that_beat_and_cross() -> None:
    """Orders 1, 2 and 3 of a run-up with a resonance each, from a torque at 4 kHz."""
    time = np.arange(int(LAST * 4000)) / 4000.0
    torque = {k: (lambda speed, y=y: 1e4 * y(speed)) for k, y in ORDERS.items()}
    gauge = tn.SampledSignal(100.0 + swing(time, torque), 4000.0, name="tube", kind="torque")
    rotated = tn.track_orders(tn.Measurement([pulses(60, {}, name="in")]), [1]).rotation
    found = tn.vold_kalman(gauge, rotated, [1, 2, 3], bandwidth=8.0)
    inside = (found.time > 1.5) & (found.time < LAST - 1.5)
    for k, y in torque.items():
        true = y(FIRST + RISE * found.time)[inside]
        got = found.amplitude[inside, list(found.order).index(k)]
        assert np.abs(got - true).max() < 0.02 * np.abs(true).max(), k
        assert np.abs(got - true).max() < found.change[list(found.order).index(k)], k  # what is smoothed is said
    assert found.condition < 1e12


def test_what_double_precision_cannot_hold_is_refused() -> None:
    phase = np.arange(1000.0)[:, None]
    with pytest.raises(tn.InputError, match="too narrow"):
        envelopes_of(np.zeros(1000), phase, 1.0 / 200_000)
    time = np.arange(2_000_000) / 200_000.0
    gauge = tn.SampledSignal(np.cos(2 * np.pi * 20 * time), 200_000.0, name="gauge")
    wheel = tn.PulseTrain(np.arange(12_000) / 1200.0, 60, name="wheel")
    rotated = tn.track_orders(tn.Measurement([wheel]), [1]).rotation
    found = tn.vold_kalman(gauge, rotated, [1], bandwidth=1.0)  # at 200 kHz: taken down first
    assert found.rate < 1000 and found.condition < 1e12
    middle = (found.time > 3) & (found.time < 7)  # an end is felt for some times 1/bandwidth
    assert np.abs(np.abs(found.amplitude[middle]) - 1).max() < 5e-5


def test_a_synchronous_average_leaves_what_repeats() -> None:
    time = np.arange(int(LAST * 8000)) / 8000.0
    phi = rotation(time)
    noise = np.random.default_rng(1).standard_normal(len(time))
    gauge = tn.SampledSignal(np.cos(phi) + 0.5 * np.sin(2 * phi) + 0.3 * np.cos(0.5 * phi) + noise, 8000.0, name="g")
    rotated = tn.track_orders(tn.Measurement([pulses(60, {}, name="in")]), [1]).rotation
    found = tn.synchronous_average(gauge, rotated, turns=2, per_turn=128)
    wanted = np.cos(found.angle) + 0.5 * np.sin(2 * found.angle) + 0.3 * np.cos(0.5 * found.angle)
    off = (found.average - wanted) / found.deviation
    assert np.abs(found.average - wanted).max() < 0.25 and 0.7 < off.std() < 1.3
    assert len(found.angle) == 256 and found.averaged > 200


def test_an_order_map_shows_lines() -> None:
    rotated = tn.track_orders(tn.Measurement([pulses(60, {}, name="in")]), [1]).rotation
    wheel = pulses(60, {2.0: lambda speed: 1e-3 + 0j * speed, 4.5: lambda speed: 4e-4 + 0j * speed}, name="out")
    found = tn.measured_order_map(wheel, rotated, highest=8.0)
    strongest = found.order[1:][found.amplitude[:, 1:].argmax(axis=1)]
    assert np.all(strongest == 2.0)
    assert found.amplitude[:, list(found.order).index(2.0)] == pytest.approx(1e-3, rel=0.02)
    assert found.amplitude[:, list(found.order).index(4.5)] == pytest.approx(4e-4, rel=0.04)
    assert np.abs(found.speed - (FIRST + RISE * found.time)).max() < 0.01
