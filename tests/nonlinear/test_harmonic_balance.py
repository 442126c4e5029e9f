"""Harmonic balance against known values, shooting, and the rates at which its series must converge."""

from __future__ import annotations

import numpy as np
import pytest
from jointed_lines import two_shafts
from known_motions import (
    DEAD_ZONE_INNER,
    DEAD_ZONE_OUTER,
    DEAD_ZONE_PEAK_TO_PEAK,
    DUFFING_FOLDS,
    DUFFING_LOWER,
    DUFFING_UPPER,
    DUFFING_UPPER_LARGEST,
)

import trunnion as tn
from trunnion.errors import InputError
from trunnion.numerics import harmonics as fourier
from trunnion.numerics.sparse_matrices import SparseMatrices
from trunnion.results.verdict import Verdict


def rattle(mean_force: float) -> tn.System:
    """The gear pair of Rezaee and Farshidianfar as one equation: I = k = 1, α = 0.25, c = 0.05, b = 10°, B₁ = 0.03."""
    return tn.reference_system(
        "dead-zone-oscillator", damping=0.05, inside=0.25, half_gap=tn.deg(10), mean_force=mean_force, force=0.03
    )


@pytest.mark.parametrize("h", [1, 3, 8])
def test_fourier_rows(h: int) -> None:
    rng = np.random.default_rng(h)
    rows, g = rng.normal(size=(3, 2 * h + 1)), rng.normal(size=64)
    values = fourier.samples(rows, 64)
    angle = 2 * np.pi * np.arange(64) / 64
    k = np.arange(1, h + 1)[:, None] * angle
    assert values == pytest.approx(rows[:, :1] + rows[:, 1 : h + 1] @ np.cos(k) + rows[:, h + 1 :] @ np.sin(k))
    assert fourier.rows_of(values, h) == pytest.approx(rows)
    product = rows @ fourier.product_matrix(g, h).T
    assert product == pytest.approx(fourier.rows_of(g * values, h))
    slope = fourier.samples(fourier.rate(rows, 2.0), 64)
    assert slope == pytest.approx(
        2 * (-rows[:, 1 : h + 1] * np.arange(1, h + 1)) @ np.sin(k)
        + 2 * (rows[:, h + 1 :] * np.arange(1, h + 1)) @ np.cos(k)
    )


def test_products_with_matrices() -> None:
    h, rng = 3, np.random.default_rng(5)
    rows, g = rng.normal(size=(2, 2 * h + 1)), rng.normal(size=(4, 64, 3, 2))
    g[..., 1, 0] = 0.0
    made = np.einsum("ctij,jt->cit", g, fourier.samples(rows, 64))
    found = np.einsum("ciajb,jb->cia", fourier.product_blocks(g, h), rows)
    assert found == pytest.approx(fourier.rows_of(made, h))
    # Mẍ + Cẋ + Kx of a series with three harmonics on a carrier of its own, of samples of the period.
    parts, omega, carrier = rng.normal(size=(3, 1, 64, 2, 2)), 0.7, 0.3
    harmonics, x = np.arange(-1, 2), rng.normal(size=(3, 2)) + 1j * rng.normal(size=(3, 2))
    s = 1j * (carrier + omega * harmonics)
    t = 2 * np.pi / omega * np.arange(64) / 64
    wave = np.exp(np.outer(t, s))
    force = sum(np.einsum("tij,tj->ti", part[0], wave @ (s[:, None] ** p * x)) for p, part in enumerate(parts))
    found = fourier.hill_matrices(s[None], harmonics, [np.fft.fft(part, axis=1) / 64 for part in parts])
    blocks = SparseMatrices.added(6, found)
    assert (blocks.dense()[0] @ x.ravel()).reshape(3, 2) == pytest.approx(wave.conj().T @ force / 64)


def test_one_singular_matrix_among_others_has_no_solution() -> None:
    matrix = np.array([np.eye(2), np.ones((2, 2)), np.full((2, 2), np.nan), 2 * np.eye(2)])
    found = fourier.solved(matrix, np.ones((4, 2)))
    assert np.isnan(found[1:3]).all() and (found[[0, 3]] == [[1, 1], [0.5, 0.5]]).all()


def test_duffing() -> None:
    found = tn.harmonic_balance(tn.reference_system("duffing"), "frequency", 0.8, 1.6)
    assert found.outcome.ok and found.tail.max() < 1e-6 and found.defect.max() < 1e-8
    for fold, (frequency, amplitude) in zip(found.branch.folds, DUFFING_FOLDS, strict=True):
        assert fold.parameter == pytest.approx(frequency, abs=6e-8)
        assert fold.amplitude[0] == pytest.approx(amplitude, abs=2e-7)
    for start, amplitude in (([0.4, 0.0], DUFFING_LOWER), ([2.5, 0.0], DUFFING_UPPER)):
        point = tn.harmonic_balance(
            tn.reference_system("duffing"), "frequency", 1.2, 1.21, start=start, harmonics=20, longest_step=1.0
        )
        assert point.branch.amplitude[0, 0] == pytest.approx(amplitude, abs=6e-8)
    assert point.branch.largest[0, 0] == pytest.approx(DUFFING_UPPER_LARGEST, abs=1e-5)  # of 1024 samples


def test_dead_zone() -> None:
    """Both attractors at ω = 0.6, one of them a circle in the contact, the other across the gap."""
    for start, peak, exact in zip(
        (DEAD_ZONE_OUTER, DEAD_ZONE_INNER), DEAD_ZONE_PEAK_TO_PEAK, (True, False), strict=True
    ):
        found = tn.harmonic_balance(
            tn.reference_system("dead-zone-oscillator"), "frequency", 0.6, 0.601, start=start, harmonics=60,
            longest_step=1.0,
        )  # fmt: skip
        assert found.branch.peak_to_peak[0, 0] == pytest.approx(peak, abs=1e-8 if exact else 2e-6)
        assert found.branch.start[0] == pytest.approx(start, abs=1e-8 if exact else 1e-5)
        assert found.branch.verdict[0] == Verdict.STABLE


def test_a_kink_is_approached_at_the_rate_of_theory() -> None:
    """The force has kinks, so the motion's coefficients fall like k⁻⁴ and the error of x like H⁻³."""
    system, errors, orders = tn.reference_system("dead-zone-oscillator"), [], (10, 20, 40, 100)
    true = tn.periodic_response(system, start=DEAD_ZONE_INNER, settle=False)
    period = system.forcing_period
    assert period is not None
    times = period * np.arange(1024) / 1024
    for h in orders:
        found = tn.harmonic_balance(
            system, "frequency", 0.6, 0.601, start=DEAD_ZONE_INNER, harmonics=h, longest_step=1.0
        )
        errors.append(float(np.abs(found.motion(0)[:, 0] - true.trajectory.at(times)[:, 0]).max()))
    rate = np.log(errors[0] / errors[-1]) / np.log(orders[-1] / orders[0])
    assert 2.7 < rate < 3.3
    assert errors[-1] < 1e-6


@pytest.mark.parametrize(
    ("mean_force", "half", "resting"),
    [pytest.param(0.0, 0.52172, 0.07652, marks=pytest.mark.slow), (0.05, 0.51880, 0.17464)],
    ids=["no mean", "mean"],
)
@pytest.mark.slow
def test_rattle(mean_force: float, half: float, resting: float) -> None:
    """Half peak-to-peak at ω = 0.8 as two time integrations found it; the upper peak between 0.87 and 0.88."""
    found = tn.harmonic_balance(rattle(mean_force), "frequency", 0.6, 1.3, begin=1.3, harmonics=30)
    branch = found.branch
    at = [
        0.5 * np.interp(0.8, branch.parameter[i : i + 2], branch.peak_to_peak[i : i + 2, 0])
        if branch.parameter[i] < branch.parameter[i + 1]
        else 0.5 * np.interp(0.8, branch.parameter[[i + 1, i]], branch.peak_to_peak[[i + 1, i], 0])
        for i in np.flatnonzero((branch.parameter[:-1] - 0.8) * (branch.parameter[1:] - 0.8) <= 0)
    ]
    assert max(at) == pytest.approx(half, abs=2e-3)
    assert min(at) == pytest.approx(resting, abs=2e-3)
    assert max(p.parameter for p in branch.folds if p.peak_to_peak[0] > 0.8) == pytest.approx(0.875, abs=0.005)


def test_a_driveline_equals_shooting() -> None:
    line = two_shafts(angle=25.0, load=150.0)
    found = tn.harmonic_balance(line, "speed", 60.0, 70.0, longest_step=0.5)
    for i in (0, len(found.rows) - 1):
        speed = float(found.branch.parameter[i])
        true = tn.periodic_response(line, speed=speed)
        assert found.branch.start[i] == pytest.approx(true.orbit.start, rel=1e-6, abs=1e-9)
        assert found.branch.peak_to_peak[i] == pytest.approx(true.torque_peak_to_peak, rel=1e-4)
        assert np.abs(found.branch.multipliers[i]) == pytest.approx(np.abs(true.multipliers), abs=1e-7)
    assert found.branch.curve_unit == "N*m"
    assert found.data.attrs["harmonics"] == found.harmonics


def test_a_subharmonic_motion() -> None:
    """A Duffing oscillator at three times its own frequency answers at a third of the forcing."""
    system = tn.reference_system("duffing", damping=0.01, force=2.0, frequency=3.6)
    settled = tn.periodic_response(system, periods=3, start=[2.5, 0.0], settle=False)
    assert settled.outcome.ok
    found = tn.harmonic_balance(system, "frequency", 3.6, 3.7, start=settled.start, periods=3, longest_step=0.2)
    assert found.outcome.ok
    rows = found.rows[0, 0]
    h = found.harmonics
    assert np.hypot(rows[1], rows[h + 1]) > np.hypot(rows[3], rows[h + 3])
    assert found.branch.period[0] == pytest.approx(3 * 2 * np.pi / 3.6)


def test_what_cannot_be_found_is_said() -> None:
    nothing = tn.harmonic_balance(
        tn.reference_system("duffing", damping=0.0, cubic=0.0, frequency=1.0), "frequency", 1.0, 1.1, start=[0.0, 0.0]
    )
    assert not nothing.outcome.ok
    assert "give a start" in nothing.outcome.sentence
    assert len(nothing.rows) == 0
    assert str(nothing).startswith("no branch over frequency")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"harmonics": 0}, "harmonics = 0: must be a whole number"),
        ({"tail": 0.0}, "tail = 0: must lie between 0 and 1"),
        ({"begin": 3.0}, "begin = 3: lies outside the range"),
        ({"low": 1.5, "high": 1.0}, "must be a rising range"),
        ({"parameter": "stifness"}, "is not a parameter"),
    ],
)
def test_bad_input(change: dict[str, object], message: str) -> None:
    given: dict[str, object] = {"parameter": "frequency", "low": 1.0, "high": 1.5, **change}
    with pytest.raises(InputError, match=message):
        tn.harmonic_balance(tn.reference_system("duffing"), **given)  # type: ignore[arg-type]


def test_an_autonomous_system_is_refused() -> None:
    with pytest.raises(InputError, match="autonomous"):
        tn.harmonic_balance(tn.reference_system("lorenz"), "rho", 20.0, 30.0)
