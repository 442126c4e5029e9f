"""Missing and double pulses against trains whose teeth are known."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.measured.signals.edges import rising_edges


def edges(rng: np.random.Generator, teeth: int, turns: int, swing: tuple[float, int] | None = None) -> np.ndarray:
    """Times of all teeth of a shaft that speeds up and swings, with pitch errors: from its rotation by bisection."""
    first, rise = rng.uniform(20, 200), rng.uniform(-2, 20)
    size, order = swing or (rng.uniform(0, 0.3) / teeth, rng.integers(1, 5))
    pattern = 0.03 * 2 * np.pi / teeth * rng.standard_normal(teeth)
    target = 2 * np.pi * np.arange(teeth * turns) / teeth + np.tile(pattern, turns) + 1.0
    low, high = np.zeros(len(target)), np.full(len(target), 4 * target[-1] / first + 1)
    for _ in range(80):
        time = (low + high) / 2
        turned = first * time + rise * time**2 / 2
        beyond = turned + size * np.sin(order * turned) > target
        low, high = np.where(beyond, low, time), np.where(beyond, time, high)
    return (low + high) / 2


@pytest.mark.parametrize("seed", range(40))
def test_every_tooth_is_found_again(seed: int) -> None:
    rng = np.random.default_rng(seed)
    teeth = int(rng.choice([12, 30, 60, 135]))
    true = edges(rng, teeth, 30)
    number = np.arange(len(true))
    kept = rng.random(len(true)) > 0.01
    kept[:3] = kept[-3:] = True
    gap = np.diff(true, append=true[-1] + 1)
    twice = kept & (rng.random(len(true)) < 0.01)
    twice[-1] = False
    extra = true[twice] + gap[twice] * rng.uniform(0.05, 0.3, int(twice.sum()))
    train = tn.PulseTrain(np.sort(np.concatenate([true[kept], extra])), teeth)
    assert train.missing == int((~kept).sum()) and train.double == int(twice.sum())
    # Of a pair either edge may stay: numbers are those of the teeth all the same.
    assert np.array_equal(train.number, number[kept])
    off = np.abs(train.times - true[kept])
    assert np.all((off == 0) | twice[kept]) and np.all(off < 0.35 * gap[kept])


def test_the_mark_of_a_wheel_is_no_fault_of_the_pickup() -> None:
    true = edges(np.random.default_rng(7), 60, 20)
    marked = np.arange(len(true)) % 60 < 58
    train = tn.PulseTrain(true[marked], 60, name="crank")
    assert train.missing == 2 * 19 and train.double == 0
    assert np.array_equal(train.number, np.flatnonzero(marked))
    (finding,) = tn.Measurement([train]).findings
    assert "a wheel with a mark" in str(finding)


def test_a_train_without_faults_stays_as_it_is() -> None:
    for seed in range(30):
        true = edges(np.random.default_rng(1000 + seed), 24, 25)
        train = tn.PulseTrain(true, 24)
        assert (train.missing, train.double) == (0, 0) and np.array_equal(train.times, true)


def test_pulses_missing_at_the_ends_and_one_after_another() -> None:
    true = edges(np.random.default_rng(3), 60, 10)
    gone = [1, 100, 102, 104, 300, 301, 400, 402, len(true) - 2]
    kept = np.delete(np.arange(len(true)), gone)
    train = tn.PulseTrain(true[kept], 60)
    assert train.missing == len(gone) and np.array_equal(train.number, kept)


@pytest.mark.parametrize("swing", [(0.3, 2), (0.6, 1), (0.1, 3), (0.15, 4), (1.2, 0.5)])
def test_a_shaft_that_swings_far_is_counted_by_its_turns(swing: tuple[float, float]) -> None:
    """Its speed falls to two fifths of the mean, twice a turn say: gaps as long as with a pulse missing."""
    said = 0
    for seed in range(6):
        rng = np.random.default_rng(seed)
        true = edges(rng, 36, 40, swing)
        whole = tn.PulseTrain(true, 36)
        assert (whole.missing, whole.double) == (0, 0) and not whole.doubtful
        there = rng.random(len(true)) > 0.01
        twice = there & (rng.random(len(true)) < 0.003)
        twice[[0, -1]] = False
        extra = true[twice] + np.diff(true, append=np.inf)[twice] * rng.uniform(0.05, 0.3, int(twice.sum()))
        every = np.concatenate([true[there], extra])
        number = np.concatenate([np.flatnonzero(there), np.flatnonzero(twice)])[np.argsort(every)]
        train = tn.PulseTrain(np.sort(every), 36)
        kept = number[np.searchsorted(np.sort(every), train.times)]
        assert np.array_equal(np.diff(train.number), np.diff(kept)) and train.double == int(twice.sum())
        said += len(train.doubtful)
    assert said < 20


@pytest.mark.parametrize("missing", [6, 30, 80])
def test_a_long_gap_of_a_shaft_that_swings_far(missing: int) -> None:
    for seed in range(3):
        rng = np.random.default_rng(10 * missing + seed)
        true = edges(rng, 36, 40, (0.6, 1))
        first = int(rng.integers(400, 900))
        kept = np.delete(np.arange(len(true)), np.arange(first, first + missing))
        train = tn.PulseTrain(true[kept], 36)
        assert train.missing == missing and np.array_equal(train.number, kept)


def test_where_no_turn_is_whole_the_count_is_said_to_be_uncertain() -> None:
    rng = np.random.default_rng(2)
    true = edges(rng, 36, 40, (0.6, 1))
    train = tn.PulseTrain(true[rng.random(len(true)) > 0.12], 36, name="hub")
    assert train.swings and train.within(0.0, float(train.times[-1])).swings
    (said,) = (str(one) for one in tn.Measurement([train]).findings if "swings so far" in str(one))
    assert said.startswith("caution: hub: its speed swings so far within a turn")
    even = edges(rng, 36, 40)
    assert not tn.PulseTrain(even[rng.random(len(even)) > 0.12], 36).swings


@pytest.mark.parametrize("chunk", [1_000_000, 4096, 97])
@pytest.mark.parametrize("falling", [False, True])
def test_edges_of_a_voltage(chunk: int, falling: bool) -> None:
    """Flanks of a known shape with noise, cut into chunks anywhere: all times, once each."""
    rng = np.random.default_rng(3)
    rate, rise = 50_000.0, 8e-5
    up = np.cumsum(rng.uniform(0.8e-3, 1.3e-3, 400))
    down = up + 0.4e-3
    time = np.arange(int(rate * (up[-1] + 2e-3))) / rate
    volt = sum(
        (np.tanh((time[None, :] - at[:, None]) / rise) * sign).sum(axis=0)
        for at, sign in ((up[:200], 1.0), (up[200:], 1.0), (down[:200], -1.0), (down[200:], -1.0))
    )
    wanted = down if falling else up
    noise = 0.02 * rng.standard_normal(len(time))
    # A sample's noise over the slope of 12.5 kV/s is 1.6 µs.
    for more, most in ((0.0 * noise, 1.5e-6), (noise, 9e-6)):
        whole = 2.5 + volt + more
        # The level is taken from the first chunk, which has to show some pulses.
        parts = [whole[:4096], *(whole[at : at + chunk] for at in range(4096, len(whole), chunk))]
        found = rising_edges(parts, rate, None, "ch", falling=falling)
        assert len(found) == len(wanted)
        assert np.abs(found - wanted).max() < most


def test_noise_on_the_level_makes_no_second_edge() -> None:
    rng = np.random.default_rng(5)
    time = np.arange(200_000) / 100_000.0
    volt = np.sin(2 * np.pi * 50 * time) + 0.05 * rng.standard_normal(len(time))
    found = rising_edges([volt], 100_000.0, None, "ch", falling=False)
    assert len(found) in (99, 100) and np.abs(np.diff(found) - 0.02).max() < 5e-4
    plain = np.flatnonzero((volt[1:] > 0) & (volt[:-1] <= 0))
    assert len(plain) > 2 * len(found)  # what a bare comparison would count


@pytest.mark.parametrize("missing", [6, 40, 120, 500])
def test_a_gap_of_many_pulses_is_counted_by_both_sides(missing: int) -> None:
    """The gaps right beside it are off by 3 % of pitch errors: their mean would count 40 by chance."""
    for seed in range(12):
        rng = np.random.default_rng(100 * missing + seed)
        true = edges(rng, 60, 60)
        first = int(rng.integers(400, len(true) - missing - 400))
        kept = np.delete(np.arange(len(true)), np.arange(first, first + missing))
        train = tn.PulseTrain(true[kept], 60)
        assert train.missing == missing and np.array_equal(train.number, kept) and not train.doubtful


def test_a_gap_that_nobody_can_count_is_said() -> None:
    """Another speed behind a gap: how the shaft got there is not known."""
    slow, fast = np.arange(600) / 600.0, 2.5 + np.arange(600) / 1100.0
    train = tn.PulseTrain(np.concatenate([slow, fast]), 60, name="hub")
    assert train.doubtful == (pytest.approx(slow[-1]),)
    assert "hub: how many pulses are missing after 0.9983 s" in " ".join(
        str(one) for one in tn.Measurement([train]).findings
    )
