"""Extremes of sums of harmonics against a fine grid and against Newton's own limit."""

from __future__ import annotations

import numpy as np
import pytest

from trunnion.numerics.cycle_extremes import cycle_extremes


def test_extremes_of_random_sums() -> None:
    rng = np.random.default_rng(1)
    index = np.array([0, 1, 2, 5, 7, 16, 31])
    size = 10.0 ** rng.integers(-6, 1, size=(60, 7))
    amplitude = (rng.normal(size=(60, 7)) + 1j * rng.normal(size=(60, 7))) * size
    low, high = cycle_extremes(index, amplitude)
    x = np.linspace(0, 2 * np.pi, 200_001)
    f = (amplitude @ np.exp(1j * np.outer(index, x))).real
    span = np.ptp(f, axis=1)
    # The grid lies at most ½ k² (δ/2)² = 1.2e-7 of an amplitude below the true peak, and never above it.
    assert np.all(f.max(axis=1) <= high + 1e-13 * span) and np.all(high <= f.max(axis=1) + 2e-7 * span)
    assert np.all(f.min(axis=1) >= low - 1e-13 * span) and np.all(low >= f.min(axis=1) - 2e-7 * span)


def test_two_harmonics_in_closed_form() -> None:
    """cos x + cos 2x lies between −9/8 and 2."""
    low, high = cycle_extremes(np.array([1, 2]), np.array([[1.0 + 0j, 1.0]]))
    assert (low[0], high[0]) == pytest.approx((-9 / 8, 2.0), abs=1e-14)


def test_a_narrow_peak_is_found() -> None:
    """Of 68 cosines in phase but shifted, all peaks fall together between samples."""
    index = np.arange(1, 69)
    low, high = cycle_extremes(index, np.exp(-1j * index * 0.7771)[None])
    assert high[0] == pytest.approx(68.0, abs=1e-9)
    assert low[0] > -20


def test_constants_and_failures_keep_their_place() -> None:
    amplitude = np.array([[3.0 + 0j, 0.0], [np.nan, 1.0], [0.0, 0.0]])
    low, high = cycle_extremes(np.array([0, 4]), amplitude)
    assert low[0] == high[0] == 3.0
    assert np.isnan(low[1]) and np.isnan(high[1])
    assert low[2] == high[2] == 0.0


def test_of_many_peaks_that_are_all_but_equal_the_highest_is_found() -> None:
    """A high order with a little of low ones beside it: which of its peaks is the highest, they decide."""
    index, rng = np.array([1, 2, 48]), np.random.default_rng(3)
    for size in (1e-3, 1e-5, 1e-7):
        amplitude = np.array([size, size, 1.0]) * np.exp(1j * rng.uniform(0, 2 * np.pi, (20, 3)))
        low, high = cycle_extremes(index, amplitude)
        # Peaks of the high order stand where its phase is a multiple of 2π, moved by the low ones by their own size.
        x = (2 * np.pi * np.arange(48) - np.angle(amplitude[:, 2])[:, None]) / 48
        slow = (amplitude[:, None, :2] * np.exp(1j * index[:2] * x[..., None])).real.sum(axis=2)
        assert high == pytest.approx(1 + slow.max(axis=1), abs=size**2)
        x = x + np.pi / 48
        slow = (amplitude[:, None, :2] * np.exp(1j * index[:2] * x[..., None])).real.sum(axis=2)
        assert low == pytest.approx(-1 + slow.min(axis=1), abs=size**2)


def test_flat_tops_are_climbed_to_the_end() -> None:
    """cos x − a cos 2x, whose top is all but flat near a = 1/4, reaches a + 1/(8a) from there on."""
    flat = 0.25 * (1 + 10.0 ** -np.arange(0, 12, 0.25))
    turned = np.exp(1j * np.outer(np.linspace(0, 1, len(flat)), [1, 2]))
    high = cycle_extremes(np.array([1, 2]), np.stack([np.ones_like(flat), -flat], axis=1) * turned)[1]
    assert high == pytest.approx(flat + 1 / (8 * flat), abs=1e-12)
