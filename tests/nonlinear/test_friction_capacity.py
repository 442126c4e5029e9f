"""Clutches about what their friction holds: motions beyond it are none, and sliders that stick make a continuum.

Against even steps of the equations written out (``oracles.rubbing_disks``), closed forms, and balances of torque.
"""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from oracles.friction_disks import RubbingDisks

import trunnion as tn

INERTIA, SPRING, DAMPING, HOLDS, SERIES, LOAD, FORCE = 0.1, 800.0, 0.5, 40.0, 3000.0, 30.0, 9.0
OMEGA = 2 * np.pi * 10
SPEED = 50.0


def loaded(
    *,
    spring: float = SPRING,
    damping: float = DAMPING,
    holds: float = HOLDS,
    series: float = SERIES,
    load: float = LOAD,
    force: float = FORCE,
    omega: float = OMEGA,
) -> tn.Driveline:
    """A disk with a load on a clutch that a drive holds, shaken in time."""
    shaken = [{"frequency": omega, "amplitude": force}] if force else []
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Clutch(
                stiffnesses=[spring], damping=damping, friction=[{"torque": holds, "stiffness": series}], name="clutch"
            ),
            tn.Disk(inertia=INERTIA, load_torque=load, excitation=shaken),
        ]
    )


BEYOND = (
    r"clutch\.friction: carries a load of 5 N m, more than the 3 N m that its friction holds.*"
    r"raise its friction torque above 5 N m, lower the load"
)


@pytest.mark.parametrize("force", [0.0, 1.0])
def test_a_load_beyond_the_friction_is_refused_with_its_name(force: float) -> None:
    line = loaded(spring=0.0, holds=3.0, series=4e3, load=5.0, force=force, damping=0.0)
    with pytest.raises(tn.InputError, match=BEYOND) as refusal:
        tn.periodic_response(line, SPEED)
    assert "\n" not in str(refusal.value)
    if force:
        for analysis in (tn.piecewise_orbit, lambda line: tn.sweep(line, [50.0, 60.0])):
            with pytest.raises(tn.InputError, match=BEYOND):
                analysis(line)


@pytest.mark.parametrize("bend", [{}, {"viscous_load": 0.06}, {"quadratic_load": 1e-3}])
def test_what_loads_by_speed_and_bent_joints_add_is_refused_as_well(bend: dict[str, float]) -> None:
    """Behind an angled joint the mean torque is not that of the loads exactly: there it is said once nothing was
    found."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.HookeJoint(angle="8 deg"),
            tn.Clutch(stiffnesses=[0.0], friction=[{"torque": 3.0, "stiffness": 4e3}], name="clutch"),
            tn.Disk(inertia=INERTIA, load_torque=2.0 if bend else 5.0, **bend),
        ]
    )
    with pytest.raises(tn.InputError, match=r"clutch\.friction: carries a load of .* N m, more than the 3 N m"):
        tn.periodic_response(line, SPEED)


def test_a_spring_that_ends_holds_what_it_ends_at() -> None:
    """800 N m/rad to 5 mrad carry 4 N m, with 3 N m of friction 7 N m."""

    def line(load: float) -> tn.Driveline:
        clutch = tn.Clutch(
            breakpoints=[-0.005, 0.005], stiffnesses=[0.0, 800.0, 0.0], damping=0.5, name="clutch",
            friction=[{"torque": 3.0, "stiffness": 4e3}],
        )  # fmt: skip
        return tn.Driveline(
            [
                tn.ConstantSpeed(),
                clutch,
                tn.Disk(inertia=INERTIA, load_torque=load, excitation=[{"frequency": OMEGA, "amplitude": 0.2}]),
            ]
        )

    # Within the ends of the spring the slider stands at its lower end at most, beyond them the twist has no end.
    (one,) = tn.piecewise_orbit(line(6.5)).continuum
    swing = 0.2 / abs(4800.0 - INERTIA * OMEGA**2 + 0.5j * OMEGA)
    assert one.twist_low == -np.inf and one.twist_high == pytest.approx(-(3.5 + 4e3 * swing) / 800.0, rel=1e-5)
    with pytest.raises(tn.InputError, match="more than the 7 N m that its friction and its spring hold.*above 3.5 N"):
        tn.piecewise_orbit(line(7.5))


def test_a_start_beyond_the_friction_is_refused() -> None:
    line = loaded(spring=0.0, holds=3.0, series=4e3, load=5.0)
    words = r"loads clutch slider 1 with 4000 N m, beyond the 3 N m at which it slips; start its deflection between"
    for analysis in (
        lambda: tn.simulate(line, 0.1, speed=SPEED, start=[0.0, 0.0, 1.0]),
        lambda: tn.exact_motion(line, 0.1, start=[0.0, 1.0, 0.0, 0.0]),
        lambda: tn.periodic_response(loaded(), SPEED, start=[0.0, 0.0, 4000.0 / SERIES]).outcome,
        lambda: tn.piecewise_orbit(loaded(), [0.0, 4000.0 / SERIES, 0.0, 0.0]).outcome,
    ):
        with pytest.raises(tn.InputError, match=words.replace("the 3 N m", "the (3|40) N m")) as refusal:
            analysis()
        assert "\n" not in str(refusal.value)


def test_branches_and_series_do_not_take_the_system_of_a_line_that_rubs() -> None:
    system = tn.periodic_response(loaded(), SPEED, compare=False).orbit.system
    for analysis in (tn.periodic_branch, tn.harmonic_balance):
        with pytest.raises(tn.InputError, match="clutch slider 1: has dry friction, whose sliders change"):
            analysis(system, "Disk 1.excitation 1 frequency", 55.0, 70.0)


def test_a_line_beyond_its_friction_slips_away_in_time() -> None:
    """From rest J q″ = −(M − T) once the slider has reached where it slips: no torque is beyond T."""
    line = loaded(spring=0.0, damping=0.0, holds=3.0, series=4e3, load=5.0, force=0.0)
    run, exact = tn.simulate(line, 0.5, speed=SPEED), tn.exact_motion(line, 0.5)
    late, falls = run.at([0.3, 0.4, 0.5])[:, 0], -(5.0 - 3.0) / INERTIA
    assert np.diff(late, 2)[0] == pytest.approx(falls * 0.1**2, rel=1e-6)
    assert run.final[0] == pytest.approx(exact.final[0], rel=1e-8)
    for low, high in ((run.torque_extremes.low, run.torque_extremes.high), (exact.torque_low, exact.torque_high)):
        assert low[0] == pytest.approx(-3.0, rel=1e-9) and high[0] < 1e-9


def test_a_clutch_that_the_excitation_lets_slip_on_is_said_to() -> None:
    """The load alone would be held. The drift per period is that of the even steps."""
    line = loaded(spring=0.0, holds=3.0, series=4e3, load=2.0, force=2.5)
    q, v, x = (disks := _disks([line])).rest()
    for _ in range(40):
        before = q
        q, v, x, *_ = disks.period(q, v, x, 800)
    for found in (tn.periodic_response(line, SPEED), tn.piecewise_orbit(line)):
        words = found.outcome.sentence
        drift = re.search(r"clutch slips on by (\S+) rad in every period", words)
        assert not found.outcome.ok and drift is not None and "start closer" not in words
        assert float(drift[1]) == pytest.approx(abs(float((q - before)[0])), rel=1e-3)
        assert "its load of 2 N m and the excitation together; raise its friction torque" in words


def _amplitude(stiffness: float, damping: float = DAMPING) -> float:
    """Of the twist about its mean, where nothing slips."""
    return FORCE / abs(stiffness - INERTIA * OMEGA**2 + 1j * OMEGA * damping)


def test_stuck_sliders_are_judged_without_the_direction_that_nothing_drives() -> None:
    """Both springs act: |σ| = exp(−c T/2J) = exp(−0.25). The mean twist lies between those at which the slider comes to
    slip at one end of its swing."""
    swing, reach = _amplitude(SPRING + SERIES), HOLDS / SERIES
    ends = (-LOAD - SERIES * np.array([1, -1]) * (reach - swing)) / SPRING
    responses = tn.periodic_response(loaded(), SPEED, compare=False), tn.piecewise_orbit(loaded())
    for found in responses:
        assert found.outcome.ok and found.verdict.name == "STABLE" and found.stuck == ("clutch slider 1",)
        assert np.abs(found.multipliers) == pytest.approx(np.exp(-0.25), rel=1e-8)
        (one,) = found.continuum
        np.testing.assert_allclose([one.twist_low, one.twist_high], ends, rtol=1e-6)
        assert one.twist_low <= one.twist_mean * (1 + 1e-9) <= one.twist_high + 1e-9
        assert "one of a continuum: by where it came to stick the mean twist of clutch lies between" in str(found)
    assert responses[0].spectral_radius == pytest.approx(np.exp(-0.25), abs=responses[0].error_estimate)
    assert responses[0].error_estimate < 1e-6


@pytest.mark.parametrize("beyond", [0.98, 1.02])
def test_the_continuum_ends_where_a_slider_comes_to_slip(beyond: float) -> None:
    """The motion found, its slider shifted to either end of the range and a little within or beyond, in even steps: it
    repeats within, and settles elsewhere beyond."""
    line = loaded()
    orbit = tn.piecewise_orbit(line)
    (one,) = orbit.continuum
    disks, tried = _disks([line]), 0
    middle = (one.twist_low + one.twist_high) / 2
    for end in (one.twist_low, one.twist_high):
        shift = middle + beyond * (end - middle) - one.twist_mean
        q, v = np.array([orbit.start[0] + shift]), orbit.start[2:3]
        x = np.array([[orbit.start[1] - SPRING / SERIES * shift]])
        if beyond > 1 and abs(x[0, 0]) > HOLDS / SERIES:
            continue  # no start there at all
        tried += 1
        after = disks.period(q, v, x, 4000)
        offset = (after[2][0, 0] - after[0][0]) - (x[0, 0] - q[0])
        if beyond < 1:
            assert abs(offset) < 1e-12 and abs(after[0][0] - q[0]) < 1e-8
        else:
            assert abs(offset) > 1e-5
    assert tried


def test_the_continuum_of_a_clutch_with_stages_ends_in_another_stage() -> None:
    """One end lies in the middle stage, 800 N m/rad, the other all in the outer one, 2000 N m/rad beyond 30 mrad."""
    clutch = tn.Clutch(
        breakpoints=[-0.03, 0.03], stiffnesses=[2000.0, SPRING, 2000.0], damping=DAMPING, name="clutch",
        friction=[{"torque": HOLDS, "stiffness": SERIES}],
    )  # fmt: skip
    line = tn.Driveline([tn.ConstantSpeed(), clutch, loaded().elements[2]])
    outer = 0.03 + (LOAD + HOLDS - SERIES * _amplitude(2000.0 + SERIES) - 0.03 * SPRING) / 2000.0
    inner = (HOLDS - SERIES * _amplitude(SPRING + SERIES) - LOAD) / SPRING
    for found in (tn.piecewise_orbit(line), tn.periodic_response(line, SPEED, compare=False)):
        (one,) = found.continuum
        np.testing.assert_allclose([one.twist_low, one.twist_high], [-outer, inner], rtol=1e-5)


@pytest.mark.parametrize("angle", ["0 deg", "8 deg"])
def test_motions_from_other_starts_lie_within_the_continuum_and_reach_its_ends(angle: str) -> None:
    """Bent joints and a torque by order make the motions of the continuum differ. A slider that starts at its end under
    the torque that it then leaves to the spring slips until it just sticks: at the end of the continuum."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.HookeJoint(angle=angle),
            *loaded().elements[1:2],
            tn.Disk(inertia=INERTIA, load_torque=LOAD, excitation=[{"order": 1, "amplitude": FORCE}]),
        ]
    )
    means = []
    for share in (-1.0, -0.5, 0.0, 0.5, 1.0):
        start = [-(LOAD + share * HOLDS) / SPRING, 0.0, share * HOLDS / SERIES]
        found = tn.periodic_response(line, OMEGA, compare=False, start=start)
        (one,) = found.continuum
        assert found.verdict.name == "STABLE"
        means.append((one.twist_low, one.twist_mean, one.twist_high))
    low, mean, high = np.array(means).T
    assert np.ptp(low) < 1e-7 and np.ptp(high) < 1e-7
    assert mean.min() == pytest.approx(low[0], abs=1e-7) and mean.max() == pytest.approx(high[0], abs=1e-7)
    assert len(np.unique(np.round(mean, 5))) >= 3


def test_a_line_that_starts_free_sticks_alike() -> None:
    """Integrated, torques by order act where the twist has turned them, and a drive keeps the speed."""
    line = tn.Driveline(
        [
            tn.Disk(inertia=0.3, drive_share=1, name="motor"),
            *loaded().elements[1:2],
            tn.Disk(inertia=INERTIA, load_torque=LOAD, excitation=[{"order": 1, "amplitude": FORCE}]),
        ]
    )
    swing = FORCE / INERTIA / abs((SPRING + SERIES + 1j * OMEGA * DAMPING) * (1 / 0.3 + 1 / INERTIA) - OMEGA**2)
    ends = (-LOAD - SERIES * np.array([1, -1]) * (HOLDS / SERIES - swing)) / SPRING
    for found in (tn.periodic_response(line, OMEGA, compare=False), tn.piecewise_orbit(line, speed=OMEGA)):
        (one,) = found.continuum
        assert found.verdict.name == "STABLE"
        np.testing.assert_allclose([one.twist_low, one.twist_high], ends, rtol=1e-3)


def test_without_a_spring_a_stuck_clutch_stands_anywhere() -> None:
    for found in (
        tn.periodic_response(loaded(spring=0.0, load=10.0), SPEED, compare=False),
        tn.piecewise_orbit(loaded(spring=0.0, load=10.0)),
    ):
        assert found.verdict.name == "STABLE" and "clutch may stand at any mean twist" in str(found)
        assert found.continuum[0].twist_low == -np.inf and found.continuum[0].twist_high == np.inf


def test_sliders_that_settle_by_slipping_less_and_less_stick_in_the_end() -> None:
    """Loads that the slider slips under at first: from rest the motion settles at the very end of its continuum."""
    swing = _amplitude(SPRING + SERIES)
    for holds in (24.0, 28.0, 33.0, 36.0):
        line = loaded(holds=holds)
        ends = (-LOAD - SERIES * np.array([1, -1]) * (holds / SERIES - swing)) / SPRING
        for found in (tn.periodic_response(line, SPEED, compare=False), tn.piecewise_orbit(line)):
            assert found.verdict.name == "STABLE" and found.stuck, holds
            assert np.abs(found.multipliers) == pytest.approx(np.exp(-0.25), rel=1e-7)
            (one,) = found.continuum
            np.testing.assert_allclose([one.twist_low, one.twist_high], ends, rtol=1e-5)


def test_a_slider_that_just_touches_its_end_does_not_go_on_slipping() -> None:
    """A motion at the very end of its continuum touches where its slider slips, which rounding lets it pass: the time
    located lies in front of the turn of the twist or behind it. It repeats over a hundred periods all the same."""
    line = loaded()
    (one,) = tn.piecewise_orbit(line).continuum
    orbit = tn.piecewise_orbit(line)
    for end in (one.twist_low, one.twist_high):
        shift = end - one.twist_mean
        start = [orbit.start[0] + shift, orbit.start[2], orbit.start[1] - SPRING / SERIES * shift]
        for tolerance in (1e-9, 1e-11):
            run = tn.simulate(line, 100 * 2 * np.pi / OMEGA, speed=SPEED, start=start, tolerance=tolerance)
            assert np.abs(run.final[0] - start[0]) < 1e-6
            assert run.torque_peak_to_peak[0] == pytest.approx(orbit.torque_peak_to_peak[0], rel=1e-5)


def _random(seed: int) -> tn.Driveline:
    """A clutch of one or two sliders whose load is from a fifth to one and a half of what its friction holds; every
    second has a spring beside it."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 3))
    parts = [
        {"torque": float(rng.uniform(1, 6)), "stiffness": float(np.exp(rng.uniform(np.log(800), np.log(8000))))}
        for _ in range(count)
    ]
    holds = sum(part["torque"] for part in parts)
    spring = 0.0 if seed % 2 else float(np.exp(rng.uniform(np.log(100), np.log(2000))))
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Clutch(stiffnesses=[spring], damping=float(rng.uniform(0.1, 1.5)), friction=parts, name="clutch"),
            tn.Disk(
                inertia=float(rng.uniform(0.03, 0.3)),
                load_torque=holds * float(rng.uniform(0.2, 1.5)),
                excitation=[
                    {"frequency": float(rng.uniform(20, 150)), "amplitude": holds * float(rng.uniform(0.02, 0.8))}
                ],
            ),
        ]
    )


def _disks(lines: list[tn.Driveline]) -> RubbingDisks:
    clutches, disks = [line.elements[1] for line in lines], [line.elements[2] for line in lines]
    holds, series = np.zeros((2, len(lines), 2))
    series += 1.0
    for i, clutch in enumerate(clutches):
        for j, slider in enumerate(clutch.friction):  # type: ignore[union-attr]
            holds[i, j], series[i, j] = slider.torque, slider.stiffness
    return RubbingDisks(
        inertia=np.array([disk.inertia for disk in disks]),  # type: ignore[union-attr]
        spring=np.array([clutch.stiffnesses[0] for clutch in clutches]),  # type: ignore[union-attr]
        damping=np.array([clutch.damping for clutch in clutches]),  # type: ignore[union-attr]
        load=np.array([disk.load_torque for disk in disks]),  # type: ignore[union-attr]
        force=np.array([disk.excitation[0].amplitude for disk in disks]),  # type: ignore[union-attr]
        omega=np.array([disk.excitation[0].frequency for disk in disks]),  # type: ignore[union-attr]
        holds=holds,
        series=series,
    )


def _false(lines: list[tn.Driveline], settling: int) -> tuple[list[str], dict[str, int]]:
    """What is false of the answers to these lines, and how many lines had each kind of answer.

    A motion found must come back after a period of even steps, at the same torques; one that is refused must slip away
    there, from rest and after ``settling`` periods.
    """
    disks = _disks(lines)
    state = disks.rest()
    for _ in range(settling):
        before = state[0]
        *state, _, _, _ = disks.period(*state, 600)
    slips = np.abs(state[0] - before) / disks.reach[:, 0]
    found: list[str] = []
    kinds: dict[str, int] = {}
    for name, analysis in (
        ("periodic_response", lambda line: tn.periodic_response(line, SPEED, compare=False)),
        ("piecewise_orbit", tn.piecewise_orbit),
    ):
        starts, swings, places = [], [], []
        for i, line in enumerate(lines):
            try:
                orbit = analysis(line)
            except tn.InputError as error:
                kind = "refused" if "more than the" in str(error) else str(error)
            else:
                kind = "found" if orbit.outcome.ok else orbit.outcome.kind
            kinds[f"{name}: {kind}"] = kinds.get(f"{name}: {kind}", 0) + 1
            if kind != "found":
                if slips[i] < 1e-3:
                    found.append(f"{name} of line {i}: {kind}, but it slips by {slips[i]:.2g} a period")
                continue
            x = orbit.orbit.start if name == "periodic_response" else orbit.start
            count = len(line.elements[1].friction)  # type: ignore[union-attr]
            q, v, own = (x[0], x[1], x[2:]) if name == "periodic_response" else (x[0], x[1 + count], x[1 : 1 + count])
            starts.append([q, v, *own, *[0.0] * (2 - count)])
            swings.append([float(orbit.torque_mean[0]), float(orbit.torque_peak_to_peak[0])])
            places.append(i)
            if orbit.verdict.name != "STABLE":
                found.append(f"{name} of line {i}: {orbit.verdict.name}")
        here = replace(disks, **{key: value[places] for key, value in vars(disks).items()})
        start, swing = np.array(starts), np.array(swings)
        q, v, x, low, high, mean = here.period(start[:, 0], start[:, 1], start[:, 2:], 8000)
        missed = np.abs(np.stack([q - start[:, 0], (v - start[:, 1]) / here.omega], axis=1)).max(axis=1)
        missed = np.maximum(missed, np.abs(x - start[:, 2:]).max(axis=1)) / here.reach[:, 0]
        off = np.abs(np.stack([mean, high - low], axis=1) - swing).max(axis=1) / (here.holds.sum(axis=1))
        over = (np.abs(start[:, 2:]) > here.reach * (1 + 1e-9)).any(axis=1)
        found += [
            f"{name} of line {i}: misses by {missed[j]:.2g}, torques off by {off[j]:.2g}, beyond: {over[j]}"
            for j, i in enumerate(places)
            if missed[j] > 1e-4 or off[j] > 1e-4 or over[j]
        ]
    return found, kinds


@pytest.mark.slow
def test_a_few_clutches_about_what_they_hold() -> None:
    found, kinds = _false([_random(seed) for seed in range(10)], 60)
    assert not found, "\n".join(found)
    assert {"piecewise_orbit: found", "piecewise_orbit: refused", "periodic_response: slips on"} <= set(kinds), kinds


@pytest.mark.slow
@pytest.mark.study
def test_five_hundred_clutches_about_what_they_hold() -> None:
    found, kinds = _false([_random(seed) for seed in range(500)], 300)
    print(kinds)
    assert not found, "\n".join(found)
