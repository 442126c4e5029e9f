"""Curves of torque over speed against finite differences, scipy's own evaluation and values by hand."""

from __future__ import annotations

import numpy as np
import pytest

from trunnion.laws.torque_curve import ClippedLine, KlossCurve, PowerCurve, TableCurve, TorqueCurve

CURVES: dict[str, TorqueCurve] = {
    "powers": PowerCurve(12.0, -0.3, 0.02),
    "Kloss": KlossCurve(820.0, 0.16, 157.08),
    "table": TableCurve((0.0, 40.0, 90.0, 130.0, 200.0), (310.0, 290.0, 335.0, 335.0, 20.0)),
    "controller": ClippedLine(11.0, 140.0, 260.0),
}
SPEEDS = np.random.default_rng(3).uniform(1.0, 199.0, 400)


@pytest.mark.parametrize("name", CURVES)
def test_slope_is_the_difference_quotient(name: str) -> None:
    curve, step = CURVES[name], 1e-4
    away = np.all([np.abs(SPEEDS - knot) > 2 * step for knot in curve.knots] or [SPEEDS > 0], axis=0)
    found = (curve.value(SPEEDS + step) - curve.value(SPEEDS - step)) / (2 * step)
    np.testing.assert_allclose(curve.slope(SPEEDS)[away], found[away], rtol=2e-6, atol=2e-6)


def test_kloss_is_a_quotient_of_polynomials() -> None:
    curve = KlossCurve(820.0, 0.16, 157.08)
    over, under = curve.ratio(0.0)
    assert (under(SPEEDS) > 0).all()
    np.testing.assert_allclose(over(SPEEDS) / under(SPEEDS), curve.value(SPEEDS), rtol=1e-9, atol=1e-8)


def test_kloss_by_hand() -> None:
    """Largest torque at the breakdown slip, twice the slip's share of it near no slip, odd about synchronism."""
    curve = KlossCurve(np.array([[100.0], [300.0]]), np.array([[0.1], [0.25]]), 157.0)
    slip = np.array([0.1, 0.25])[:, None]
    np.testing.assert_allclose(curve.value(157.0 * (1 - slip)), [[100.0], [300.0]], rtol=1e-12)
    np.testing.assert_allclose(curve.slope(157.0 * (1 - slip)), 0.0, atol=1e-12)
    np.testing.assert_allclose(curve.value(157.0 * 1.07), -curve.value(157.0 * 0.93), rtol=1e-12)
    assert KlossCurve(100.0, 0.1, 157.0).value(0.0) == pytest.approx(2 * 100.0 * 0.1 / 1.01, rel=1e-12)


def test_a_table_says_nothing_beyond_its_ends() -> None:
    curve = CURVES["table"]
    assert np.isnan(curve.value([-1.0, 201.0])).all() and np.isnan(curve.slope([-1.0, 201.0])).all()
    np.testing.assert_allclose(curve.value(curve.knots), (310.0, 290.0, 335.0, 335.0, 20.0))
    between = curve.value(np.linspace(90.0, 130.0, 30))
    assert np.ptp(between) == 0, "no overshoot between equal points"
