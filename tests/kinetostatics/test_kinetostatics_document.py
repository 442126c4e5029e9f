"""The examples of docs/kinetostatics.md run, and its numbers are those of the package."""

import numpy as np
import pytest
from pages import ROOT, run_page

import trunnion as tn


def test_examples_run_in_order(monkeypatch):
    monkeypatch.chdir(ROOT)
    text, names = run_page("kinetostatics")
    assert "irregularity" in text


def test_errata_of_s2():
    rigid = tn.kinetostatics(tn.catalogue("bicardan-elastic"))
    elastic = tn.kinetostatics(tn.catalogue("bicardan-elastic"), rigid=False)
    assert rigid.irregularity == pytest.approx(0.5017, abs=5e-5)
    worst = tn.catalogue("bicardan-elastic", plane_angle=1.5 * np.pi)
    assert tn.kinetostatics(worst).irregularity == pytest.approx(0.5027, abs=5e-5)
    assert -1e6 * elastic.twist[1].max() == pytest.approx(13.9, abs=0.05)
    assert -1e6 * elastic.twist[1].min() == pytest.approx(17.8, abs=0.05)
    assert np.abs(elastic.output_speed - rigid.output_speed).max() == pytest.approx(8.8e-6, rel=0.02)
    assert np.abs(elastic.output_acceleration - rigid.output_acceleration).max() == pytest.approx(2.93e-5, rel=0.02)
    assert np.abs(elastic.drive_torque - rigid.drive_torque).max() == pytest.approx(6.6e-4, rel=0.02)
    homokinetic = tn.kinetostatics(tn.catalogue("bicardan-elastic", homokinetic=True), rigid=False)
    assert homokinetic.irregularity == pytest.approx(1.6e-5, rel=0.01)
    assert elastic.constant_twist.speed == pytest.approx(4.6e-6, rel=0.02)
