"""Numbers as a page prints them: engineers' units, no rounding noise, no more figures than are known."""

from __future__ import annotations

import re
from fractions import Fraction

import numpy as np
import pytest

import trunnion as tn
from trunnion.modes.resonance_speeds import Resonance
from trunnion.results.units import amplification_words, angle_words, figures, order_words, with_error

# value, error, beside → words
WITH_ERROR = [
    (0.001524425498, 1.1e-11, 0.0, "0.00152443 (error 1e-11)"),
    (1.008484123, 1.2e-12, 1.0, "1.00848 (error 1e-12)"),
    (1.0000000312, 1.1e-11, 1.0, "1.000000031 (error 1e-11)"),
    (0.996676, 3e-6, 1.0, "0.996676 ± 3e-06"),
    (0.5, 0.02, 1.0, "0.50 ± 0.02"),
    (1234.5678, 20.0, 0.0, "1235 ± 20"),
]


@pytest.mark.parametrize(("value", "error", "beside", "words"), WITH_ERROR)
def test_no_more_figures_than_are_known(value: float, error: float, beside: float, words: str) -> None:
    said = with_error(value, error, beside=beside)
    shown = re.match(r"[\d.]+", said)
    assert shown and abs(float(shown[0]) - value) <= max(error, 5e-6 * abs(value))
    assert said == words


def test_no_powers_of_ten_and_no_rounding_noise() -> None:
    assert amplification_words(1890.3) == "1890" and amplification_words(1 / (2 * 1e-17)) == "without bound"
    assert order_words(float(Fraction(18, 19))) == "order 0.9474" and order_words(2.0) == "order 2"
    assert figures(123456.0) == "123500" and angle_words(np.deg2rad(5.0)) == "5°"


def test_formulas_behind_gears_are_read_at_a_glance() -> None:
    """A joint at 19/40 of the input: ω₄/0.475, not 40ω₄/19; small numbers stay a fraction."""
    behind = Resonance(100.0, "subharmonic", (4,), 1, Fraction(19, 40))
    assert behind.formula == "ω₄/0.475"
    assert Resonance(100.0, "subharmonic", (1,), 1, Fraction(3, 2)).formula == "2ω₁/3"
    assert Resonance(100.0, "sum", (1, 2), 1, Fraction(9, 37)).formula == "(ω₁+ω₂)/0.4865"


def shaken(**changes: object) -> tn.Driveline:
    shaft = tn.Shaft(name="shaft", stiffness="8 kN*m/rad", damping="4 N*m*s/rad")
    parts = [
        tn.Disk(name="engine", inertia=0.4, excitation=[{"order": 2, "amplitude": "150 N*m"}], load_torque="-80 N*m"),
        shaft.but(**changes),
        tn.Disk(name="load", inertia=1.1, load_torque="80 N*m"),
    ]
    operation = tn.Operation(speed_range=("700 rpm", "900 rpm"))
    return tn.Driveline(parts, operation=operation, limits=[tn.Limit(of="shaft", max_twist="3 deg")])


def test_a_remedy_speaks_in_the_units_of_the_check() -> None:
    """A twist goes from degrees to degrees."""
    found = tn.remedies(shaken())
    assert found.remedies
    for one in found.remedies:
        assert " rad " not in one.sentence and " rad:" not in one.sentence
    brought = [one.sentence for one in found.remedies if "brings it from" in one.sentence]
    assert all(re.search(r"brings it from [\d.]+ deg to [\d.]+ deg", sentence) for sentence in brought)


def test_a_disk_with_one_cylinder_is_that_cylinder() -> None:
    gas = [{"order": 0.5 * k, "amplitude": 100.0} for k in (1, 2, 3)]
    throws = [
        tn.Disk(name=f"cylinder {n}", inertia=0.1, excitation=gas, firing_angles=[f"{360 * n} deg"]) for n in (1, 2)
    ]
    line = tn.Driveline(
        [
            throws[0],
            tn.Shaft(stiffness=1e5, damping=5.0),
            throws[1],
            tn.Shaft(stiffness=2e4, damping=5.0),
            tn.Disk(inertia=1),
        ]
    )
    said = str(tn.misfire(line, [100.0, 150.0]))
    assert re.match(r"misfire: cylinder [12] is the worst of 2\n", said)


def test_a_slip_clutch_is_told_to_slip_later() -> None:
    """Its outermost stage is what makes it slip: nobody would make that stiffer."""
    slip = tn.PiecewiseShaft(name="slip clutch", breakpoints=[-0.01, 0.01], stiffnesses=[0.0, 1e4, 0.0], damping=5.0)
    line = tn.Driveline([tn.ConstantSpeed(), slip, tn.Disk(inertia=1.0, load_torque=150.0)])
    with pytest.raises(tn.InputError) as refused:
        tn.stability(line, 100.0)
    said = str(refused.value)
    assert "150 N m: it slips" in said and "raise the torque at which it slips" in said and "outermost" not in said


def test_a_mean_that_is_rounding_is_printed_as_nothing() -> None:
    """As that of a shaft that drives nothing, whose torque swings about 0."""
    from trunnion.results.units import mean_and_swing

    assert mean_and_swing(-1.56e-12, 420.0, "N m") == "0 N m, 420 N m peak to peak"
    assert mean_and_swing(-4.5e-7, 420.0, "N m") == "-4.5e-07 N m, 420 N m peak to peak"
    assert mean_and_swing(12.5, 0.0, "N m") == "12.5 N m, 0 N m peak to peak"
