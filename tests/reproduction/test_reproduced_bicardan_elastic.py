"""S2 computed anew."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.papers.bicardan_elastic.conclusions import GUIDELINE


def test_conclusions(study) -> None:  # type: ignore[no-untyped-def]
    found = study("bicardan-elastic")
    assert [c.holds for c in found.conclusions] == ["confirmed", "confirmed", "confirmed", "not decided", "not decided"]
    assert [f.number for f in found.figures] == ["3", "4"]
    assert "0.5017" in str(found) and "12.6 %" in str(found) and "1.574e-05" in str(found)


def test_both_units_are_stated(study) -> None:  # type: ignore[no-untyped-def]
    said = study("bicardan-elastic").conclusions[3].evidence
    assert "inferred" in said and "25 kN m" in said and "25392 kN m" in said


def test_torque_at_which_the_deviation_is_significant() -> None:
    """The evidence scales the irregularity with the torque; here it is computed there."""
    line = tn.catalogue("bicardan-elastic", homokinetic=True, load_torque=25_000.0)
    assert tn.kinetostatics(line, rigid=False).irregularity == pytest.approx(GUIDELINE, rel=0.05)


def test_relative_changes_by_other_means() -> None:
    """Elastic minus rigid to first order: the output lags by the twist, its speed changes by the twist's rate."""
    elastic, rigid = (tn.kinetostatics(tn.catalogue("bicardan-elastic"), rigid=r, points=720) for r in (False, True))
    chi = rigid.angle[1]  # at the end of the intermediate shaft
    ratio = np.gradient(rigid.output_angle, chi)  # dψ₂/dχ₂, by differences
    shift = elastic.output_angle - rigid.output_angle
    assert shift[5:-5] == pytest.approx((ratio * elastic.twist[1])[5:-5], rel=0.02, abs=2e-8)


def test_extremes_stand_between_the_samples(study) -> None:  # type: ignore[no-untyped-def]
    """Largest acceleration of the output from the paper's own (2) to (6), on a million angles."""
    alpha, phase = np.deg2rad(27.99), np.deg2rad(266.4 - 180.0)
    phi = np.linspace(0, np.pi, 1_000_001)

    def joint(angle):  # type: ignore[no-untyped-def]
        below = 1 - np.sin(alpha) ** 2 * np.cos(angle) ** 2
        turned = np.arctan2(np.sin(angle), np.cos(angle) * np.cos(alpha))
        slope = np.cos(alpha) / below
        return turned, slope, -slope * np.sin(alpha) ** 2 * np.sin(2 * angle) / below

    first, w1, e1 = joint(phi)
    _, w2, e2 = joint(first + np.pi / 2 - phase)
    most = np.abs(e2 * w1**2 + w2 * e1).max()
    row = next(r for r in study("bicardan-elastic").tables[0].rows if r.place == "acceleration of the output")
    assert row.computed == f"{-most:.5f} … {most:.5f} rad/s²"
    assert most == pytest.approx(0.531614, abs=1e-6)
