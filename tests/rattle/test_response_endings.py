"""How frequency responses end and what they say: stalls, no damping, no contact, series too short, curves by name."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from gears import HALF_GAP, dead_zone, gear_pair

import trunnion as tn
from trunnion.errors import InputError
from trunnion.motion.orbits import harmonic_balance as balance_module
from trunnion.motion.orbits.exact_orbit import piecewise_orbit
from trunnion.motion.orbits.frequency_response import compare_responses, frequency_response, methods_of
from trunnion.motion.orbits.harmonic_balance import harmonic_balance
from trunnion.motion.orbits.harmonic_balance_springs import balance_springs
from trunnion.motion.orbits.periodic_branch import piecewise_branch
from trunnion.numerics import harmonics as fourier
from trunnion.numerics.integration.integration import IntegrationEnd
from trunnion.pictures.draw_matplotlib import draw
from trunnion.pictures.frequency_response import sweeps
from trunnion.systems import maps as map_module
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator
from trunnion.systems.second_order import SecondOrder

WALL = 1.2


def walled() -> tn.System:
    """An oscillator whose equation is a number only below a frequency of 1.2 rad/s."""

    def rate(t: float, x: Any, p: Any) -> Any:
        with np.errstate(invalid="ignore"):
            stiffness = 1.0 + 0.1 * np.sqrt(WALL - p.frequency)
        return x[1], -0.3 * x[1] - stiffness * x[0] + 0.2 * np.cos(p.frequency * t)

    return tn.System.from_function(
        rate, ["x", "v"], parameters={"frequency": 0.9}, period=lambda p: 2 * np.pi / p["frequency"], compiled=False
    )


@pytest.mark.parametrize(
    ("method", "options"),
    [pytest.param("shooting", {}, marks=pytest.mark.slow), ("harmonic balance", {"harmonics": 3})],
    ids=["shooting", "series"],
)
@pytest.mark.slow
def test_a_continuation_that_stalls_keeps_its_last_point(method: str, options: dict[str, Any]) -> None:
    found = frequency_response(walled(), 1.1, 1.5, method=method, start=[0.0, 0.0], longest_step=0.05, **options)
    assert not found.outcome.ok and found.outcome.kind == "lost"
    last = found.frequency[-1]
    assert len(found.frequency) > 3 and WALL - 0.01 < last < WALL
    assert found.half_peak_to_peak[-1] == pytest.approx(0.2 / abs(1 - last**2 + 0.3j * last), rel=0.05)
    for words in (f"frequency = {last:.6g}", f"after {len(found.frequency)} points", "longest_step", "raise harmonics"):
        assert words in found.outcome.sentence
    assert found.outcome.sentence in str(found)


@pytest.mark.parametrize("method", ["exact", pytest.param("harmonic balance", marks=pytest.mark.slow)])
def test_undamped_growth_is_said_and_nothing_is_made_of_rounding(method: str) -> None:
    """Linear, undamped, towards its resonance: unbounded; multipliers on the circle all along are not tori."""
    undamped = PiecewiseOscillator((), (1.0,), 0.0, 0.0, 0.1)
    found = frequency_response(undamped, 0.6, 1.5, method=method, most_points=1500)
    assert found.outcome.kind == "unbounded" and "grows without bound" in found.outcome.sentence
    assert "give damping" in found.outcome.sentence and found.marks == ()
    assert 0.99 < found.frequency[-1] < 1.0 and "nan" not in str(found)


@pytest.mark.parametrize("method", ["exact", "harmonic balance"])
def test_no_contact_possible_is_refused(method: str) -> None:
    """In free play without mean force the swing is F/(ω√(ω² + c²)): short of the gap a mass may float anywhere."""
    quiet = PiecewiseOscillator.gap(HALF_GAP, damping=0.05, force=1e-4)
    with pytest.raises(InputError, match="no contact is possible") as caught:
        frequency_response(quiet, 0.3, 1.3, method=method)
    factor = HALF_GAP * 0.3 * np.hypot(0.3, 0.05) / 1e-4
    assert f"{factor:.3g} times" in str(caught.value) and "\n" not in str(caught.value)
    assert len(frequency_response(quiet.but(force=3e-4 * factor), 0.3, 0.31, method=method).frequency)


def test_nothing_that_moves_is_refused() -> None:
    for method in methods_of(gear_pair()):
        with pytest.raises(InputError, match="nothing moves"):
            frequency_response(gear_pair().but(force=0.0), 0.3, 1.3, method=method)


def test_a_point_that_cannot_be_seen_is_no_number(monkeypatch: pytest.MonkeyPatch) -> None:
    """A motion may chatter on a surface it touches: then another tolerance, else NaN; nothing from beyond its end."""
    system, integrate, refused = tn.reference_system("dead-zone-oscillator"), map_module.integrate, []

    def chattering(*given: Any, **options: Any) -> Any:
        run = integrate(*given, **options)
        if not options["dense"] or options["tolerance"] > limit:
            return run
        refused.append(options["tolerance"])
        return map_module.Trajectory(**{**run.__dict__, "end": IntegrationEnd.CHATTER})

    monkeypatch.setattr(map_module, "integrate", chattering)
    limit = 2e-11
    loosened = tn.periodic_branch(system, "frequency", 1.25, 1.26, longest_step=1.0)
    assert refused and np.isfinite(loosened.peak_to_peak).all()
    limit = 1.0
    unseen = frequency_response(system, 1.25, 1.26, method="shooting", longest_step=1.0)
    assert len(unseen.frequency) and np.isnan(unseen.half_peak_to_peak).all() and np.isnan(unseen.peak[1])


def test_a_kinked_motion_gets_the_harmonics_its_tail_asks_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """1e-4 by default; and where the most harmonics allowed are too few the outcome says which knob to turn."""
    start = piecewise_orbit(dead_zone(), [0.4, 0.2]).start

    def at(**options: Any) -> Any:
        return harmonic_balance(
            tn.reference_system("dead-zone-oscillator"), "frequency", 0.6, 0.601, start=start, longest_step=1.0,
            **options,
        )  # fmt: skip

    usual = at()
    assert usual.outcome.ok and usual.tail.max() < 1e-4 and usual.harmonics == 32
    monkeypatch.setattr(balance_module, "MOST", 32)
    short = at(tail=1e-9)
    assert short.harmonics == 32 and short.outcome.kind == "tail" and len(short.rows) == len(usual.rows)
    assert "raise tail above 1e-09, or give harmonics" in short.outcome.sentence


@pytest.mark.slow
def test_superharmonic_peak_and_doublings_by_series_too() -> None:
    """The small peak below 0.4 and the pair of period doublings, against the exact branch."""
    exact = piecewise_branch(gear_pair(), 0.3, 0.5)
    series = frequency_response(gear_pair(), 0.3, 0.5, method="harmonic balance", harmonics=40)
    flips = [p.parameter for p in exact.special if p.kind == "period doubling"]
    assert [f for kind, f, _ in series.marks if kind == "period doubling"] == pytest.approx(flips, abs=3e-6)
    peak = float(exact.peak_to_peak[exact.parameter < 0.4, 0].max()) / 2
    assert series.half_peak_to_peak[series.frequency < 0.4].max() == pytest.approx(peak, rel=5e-3) and peak > 0.19


def test_subharmonic_loop_by_series_too() -> None:
    """The isolated loop of motions of twice the period, from a start on it."""
    o = gear_pair(0.05, 0.43)
    double = piecewise_orbit(o, periods=2)
    rows = fourier.rows_of(double.motion(1024)[1][:, 0][None, :], 80)
    found = balance_springs(
        SecondOrder.of_piecewise(o), 0.425, 0.435, begin=0.43, start=rows, periods=2, harmonics=80, longest_step=0.2
    )
    assert found.outcome.ok
    for i in (0, len(found.rows) - 1):
        orbit = piecewise_orbit(o.but(frequency=float(found.branch.parameter[i])), found.branch.start[i], periods=2)
        assert found.branch.peak_to_peak[i, 0] == pytest.approx(orbit.peak_to_peak, abs=2e-5)
        assert found.branch.multipliers[i] == pytest.approx(orbit.multipliers, abs=1e-3)


def test_curves_by_name_and_units_in_words() -> None:
    duffing = tn.reference_system("duffing")
    x, v = (frequency_response(duffing, 0.8, 0.9, curve=name) for name in ("x", "v"))
    assert v.curve == "v" and v.half_peak_to_peak[0] == pytest.approx(0.8 * x.half_peak_to_peak[0], rel=0.05)
    assert "of v" in str(v) and "rpm" in v.describe("rpm") and v.plot().get_ylabel() == "half peak-to-peak of v"
    for system in (duffing, gear_pair()):
        with pytest.raises(InputError, match=r"is not a curve of this"):
            frequency_response(system, 0.8, 0.9, curve="torque")


def test_the_exact_branch_has_the_curves_it_knows() -> None:
    """Of one equation the swing of x; another name is refused in a line that says which there are."""
    branch = piecewise_branch(gear_pair(), 0.8, 1.0)
    assert branch.curves == ("x",) and branch.peak_to_peak.shape == branch.largest.shape == (len(branch.parameter), 1)
    assert np.isfinite(branch.peak_to_peak).all() and np.isfinite(branch.largest).all()
    assert all(np.isfinite(point.peak_to_peak).all() for point in branch.special)
    with pytest.raises(InputError, match=r"^curve = 'v': is not a curve of this branch; known: x$"):
        branch.plot(curve="v")


@pytest.mark.slow
def test_the_usual_method_of_a_line_is_one_that_bears_its_contacts() -> None:
    shaft, disk = tn.Shaft(stiffness=1e3, damping=1.0), tn.Disk(inertia=0.1, load_torque=5.0)
    clutch = tn.PiecewiseShaft(breakpoints=[0.01], stiffnesses=[1e3, 2e3], damping=1.0)
    joint = tn.HookeJoint(angle=0.2)
    smooth = tn.Driveline([tn.ConstantSpeed(), shaft, disk, joint, shaft, disk])
    staged = tn.Driveline([tn.ConstantSpeed(), shaft, disk, joint, shaft, disk, clutch, disk])
    assert methods_of(smooth)[0] == "harmonic balance" and methods_of(staged)[0] == "shooting"
    found = frequency_response(staged, 20.0, 22.0, curve="PiecewiseShaft 1", longest_step=0.5)
    assert found.method == "shooting" and found.curve == "PiecewiseShaft 1" and found.outcome.ok
    axes = found.plot(unit="rpm")
    assert axes.get_xlabel() == "input speed [rpm]" and axes.lines[0].get_xdata()[0] == pytest.approx(20 * 30 / np.pi)
    assert axes.get_ylabel() == "half peak-to-peak of the torque of PiecewiseShaft 1 [N m]"
    with pytest.raises(InputError, match='did you mean "PiecewiseShaft 1"'):
        frequency_response(staged, 20.0, 22.0, curve="PieceShaft 1")


def test_a_picture_of_all_methods_hides_none() -> None:
    """Marks of a long sweep are thinned, jumps and unstable have their entries, dashes are unstable, black is exact."""
    options = {f"sweep {d}": {"points": 201} for d in ("up", "down")}
    methods = ("exact", "describing function", "sweep up", "sweep down")
    found = compare_responses(gear_pair(), 0.6, 1.0, methods=methods, options=options)
    axes = found.plot(length="rad", unit="")
    assert axes.get_xlabel() == "frequency ω"
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels[:4] == list(methods) and {"unstable", "fold", "grazing", "jump of a slow sweep"} < set(labels)
    for name in ("sweep up", "sweep down"):
        (line,) = (line for line in axes.lines if line.get_label() == name)
        assert 20 < len(line.get_xdata()) < 50
    up, down = (found[f"sweep {d}"].detail for d in ("up", "down"))
    swept = draw(sweeps([up, down], length="rad"))
    labels = [text.get_text() for text in swept.get_legend().get_texts()]
    assert "jump of a slow sweep" in labels and "two-sided, up" in labels and "one-sided, down" in labels
    assert len(swept.texts) == len(up.jumps) + len(down.jumps) == 2 and swept.get_ylabel().endswith("[rad]")
