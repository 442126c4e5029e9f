"""Differentials, free planetary sets and loops, against equations with a multiplier for every contact."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.tied_lines import FREQUENCY, TORQUE, Drawn

import trunnion as tn

J_FLANGE, J_WHEEL, K_AXLE, J_CASE, RATIO = 0.01, 1.2, 9e3, 0.05, 4.1


def car(right_load: float = 50.0, stiffness: float = K_AXLE, **case: float) -> tn.Driveline:
    """Pinion shaft, differential and two axles with wheels."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1e4, damping=1.0, name="pinion shaft"),
            tn.Disk(inertia=0.02, name="pinion"),
            tn.Differential(teeth_in=10, teeth_out=41, inertia=J_CASE, name="axle drive"),
            tn.Disk(inertia=J_FLANGE, name="left flange"),
            tn.Shaft(stiffness=K_AXLE, damping=2.0, name="left axle"),
            tn.Disk(inertia=J_WHEEL, load_torque=50.0, name="left wheel"),
            tn.Disk(inertia=J_FLANGE, name="right flange", after="axle drive.right"),
            tn.Shaft(stiffness=stiffness, damping=2.0, name="right axle"),
            tn.Disk(inertia=J_WHEEL, load_torque=right_load, name="right wheel"),
        ]
    )


def test_modes_of_a_differential_in_closed_form() -> None:
    """With equal legs they turn against each other, or alike behind the case."""
    found = tn.natural_frequencies(car())
    against = np.sqrt(K_AXLE * (1 / J_FLANGE + 1 / J_WHEEL))
    # Alike: case, flanges and pinion are one inertia at the case, both axles one spring to both wheels.
    body, k_in = J_CASE + 2 * J_FLANGE + 0.02 * RATIO**2, 1e4 * RATIO**2
    wheels, k = 2 * J_WHEEL, 2 * K_AXLE
    trace, product = (k_in + k) / body + k / wheels, k_in * k / (body * wheels)
    alike = np.sqrt((trace + np.array([-1, 1]) * np.sqrt(trace**2 - 4 * product)) / 2)
    np.testing.assert_allclose(found.undamped_frequency, [0.0, *sorted([*alike, against])], rtol=1e-12, atol=0)
    assert found.rigid_motions == 1 and not found.rigid_body
    assert "shafts turn against each other" in str(found)


def test_torque_is_shared_equally_whatever_the_legs() -> None:
    found = tn.order_response(car(stiffness=3e3), [60.0])
    np.testing.assert_allclose(found.mean_torque[0], [-100.0 / RATIO, -50.0, -50.0], rtol=1e-12)


def test_unlike_loads_are_refused() -> None:
    for ask in (lambda one: tn.order_response(one, [60.0]), lambda one: tn.stability(one, 60.0)):
        with pytest.raises(tn.InputError, match=r"axle drive\.load_torque: drives legs whose loads differ"):
            ask(car(right_load=40.0))


@pytest.mark.parametrize("leg", ["left", "right"])
def test_a_leg_without_inertia_is_refused(leg: str) -> None:
    parts = [tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.1), tn.Differential(name="drive")]
    if leg == "right":
        line = tn.Driveline([*parts, tn.Disk(inertia=0.1)])
    else:
        line = tn.Driveline([*parts, tn.Disk(inertia=0.1, after="drive.right")])
    with pytest.raises(tn.InputError, match=rf'^drive: has no inertia on its {leg} shaft.*after = "drive\.{leg}"$'):
        tn.natural_frequencies(line)


def test_a_port_that_is_none_is_refused() -> None:
    for after, remedy in (("drive.rihgt", "drive.right"), ("hub.right", "write hub alone")):
        elements = [tn.Disk(inertia=1.0, name="hub"), tn.Differential(name="drive"), tn.Disk(inertia=1.0, after=after)]
        with pytest.raises(tn.InputError, match=f"after = '{after}': names no shaft.*{remedy}"):
            tn.Driveline(elements)


def parallel(ratio: float = 1.0, joint: float = 0.0) -> tn.Driveline:
    """Two shafts side by side between a hub and a load, one behind gears."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1e4, damping=1.0, name="front"),
            tn.Disk(inertia=0.02, name="hub"),
            tn.HookeJoint(angle=joint),
            tn.Shaft(stiffness=9e3, damping=2.0, name="first"),
            tn.Disk(inertia=1.2, load_torque=50.0, name="load", excitation=[{"order": 3, "amplitude": 5.0}]),
            tn.Ratio(ratio=ratio, after="hub", name="gears"),
            tn.Disk(inertia=0.03, name="gear"),
            tn.Shaft(stiffness=7e3, damping=3.0, to="load", name="second"),
        ]
    )


def test_a_loop_shares_torque_by_stiffness() -> None:
    """By hand: both shafts twist alike; and they are one shaft of the sum of their stiffness and damping."""
    line = parallel()
    found = tn.order_response(line, [40.0, 90.0])
    np.testing.assert_allclose(found.mean_torque, 2 * [[-50.0, -50 * 9 / 16, -50 * 7 / 16]], rtol=1e-12)
    one = tn.Driveline(
        [
            *line.elements[:2],
            tn.Disk(inertia=0.05, name="hub"),
            tn.Shaft(stiffness=1.6e4, damping=5.0, name="both"),
            line.elements[5],
        ]
    )
    together = tn.order_response(one, [40.0, 90.0])
    np.testing.assert_allclose(found.torque[..., 1] + found.torque[..., 2], together.torque[..., 1], rtol=1e-10)
    np.testing.assert_allclose(
        tn.stability(line, 60.0).spectral_radius, tn.stability(one, 60.0).spectral_radius, rtol=1e-8
    )
    frequencies = (tn.natural_frequencies(this).frequency for this in (line, one))
    np.testing.assert_allclose(*frequencies, rtol=1e-11)
    high = [tn.assess(this.but(limits=[tn.Limit(of="front", max_torque=70)]), (30.0, 120.0)) for this in (line, one)]
    values = [next(c.value for c in each.checks if c.name == "max torque of front") for each in high]
    np.testing.assert_allclose(*values, rtol=1e-7)
    crossings = [
        [c.speed for c in tn.campbell_diagram(this, np.linspace(20, 400, 40)).crossings] for this in (line, one)
    ]
    np.testing.assert_allclose(*crossings, rtol=1e-9)


def pick_up(front: tuple[int, int], *, rear_slips: bool = True, load: float = 0.0) -> tn.Driveline:
    """Two axles on one road."""
    tyre = {"stiffness": 3e4, "damping": 300.0}
    slip = {"slip_stiffness": SLIP, "radius": RADIUS, "travel_speed": 15.0, "inertia": 1.2}
    return tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=6e4, damping=3.0, name="input"), tn.Disk(inertia=0.03, name="case"),
            tn.Shaft(stiffness=8e4, damping=2.0, name="rear shaft"), tn.Disk(inertia=0.01),
            tn.Ratio(teeth_in=10, teeth_out=41), tn.Disk(inertia=2.6),
            tn.Tyre(name="rear tyres", **tyre, **(slip if rear_slips else {})),
            tn.Vehicle(mass=2200, wheel_radius=RADIUS, name="pick-up", load_torque=load),
            tn.Shaft(stiffness=5e4, damping=2.0, after="case", name="front shaft"), tn.Disk(inertia=0.01),
            tn.Ratio(teeth_in=front[0], teeth_out=front[1]), tn.Disk(inertia=2.6),
            tn.Tyre(name="front tyres", to="pick-up", **tyre, **slip),
        ]
    )  # fmt: skip


SLIP, RADIUS = 6e4, 0.35


def test_the_wind_up_of_unlike_ratios_by_hand() -> None:
    """Axles of 10:41 and 9:37 on one road: each tyre slips by its share, T = C_s r (ω r − v)/(ω r), and both pull alike
    against each other, at any speed. With a tyre in front alone that slips, it takes all."""
    rear, front = 10 / 41, 9 / 37
    road = 2 / (1 / rear + 1 / front)  # C_s r (1 − v/ω_r) + C_s r (1 − v/ω_f) = 0
    pulls = SLIP * RADIUS * (1 - road / rear)
    for speed in (60.0, 140.0):
        found = tn.order_response(pick_up((9, 37)), [speed])
        torque = dict(zip(found.springs, found.mean_torque[0], strict=True))
        assert torque["rear tyres"] == pytest.approx(-pulls, rel=1e-9)
        assert torque["slip of front tyres"] == pytest.approx(pulls, rel=1e-9)
        assert torque["rear shaft"] == pytest.approx(-pulls * rear, rel=1e-9)
        assert torque["input"] == pytest.approx(pulls * (front - rear), rel=1e-9)
    assert f"0.27 % apart: its slip winds the line up by {pulls:.4g} N m" in str(found.findings).replace(
        "0.271", "0.27"
    )
    alone = tn.order_response(pick_up((9, 37), rear_slips=False), [60.0])
    whole = SLIP * RADIUS * (1 - rear / front)
    assert alone.mean_torque[0, alone.springs.index("slip of front tyres")] == pytest.approx(-whole, rel=1e-9)
    # A load is shared by both slips beside.
    loaded = tn.order_response(pick_up((10, 41), load=500.0), [60.0])
    assert loaded.mean_torque[0, loaded.springs.index("slip of front tyres")] == pytest.approx(-250.0, rel=1e-9)
    assert not any("winds" in str(one) for one in loaded.findings)
    stuck = pick_up((9, 37), rear_slips=False)
    nothing = dict.fromkeys(("slip_stiffness", "radius", "travel_speed", "inertia"))
    with pytest.raises(
        tn.InputError, match=r"front tyres\.to = 'pick-up': closes a loop .* give a Tyre its slip_stiffness"
    ):
        tn.natural_frequencies(stuck.replace("front tyres", **nothing))


def two_motors(second: float) -> tn.Driveline:
    """Sun and ring driven, the carrier loaded, the ring at half the sun's speed."""
    return tn.Driveline(
        [
            tn.Disk(inertia=0.1, drive_share=1.0), tn.Shaft(stiffness=1e4, damping=1.0, name="of sun"),
            tn.Disk(inertia=0.01),
            tn.Planetary(teeth_sun=30, teeth_ring=72, input="sun", output="carrier", free_speed=0.5, name="gears"),
            tn.Disk(inertia=0.05), tn.Shaft(stiffness=2e4, damping=1.0, name="of carrier"),
            tn.Disk(inertia=0.4, load_torque=102.0), tn.Disk(inertia=0.02, after="gears.ring"),
            tn.Shaft(stiffness=3e4, damping=1.0, name="of ring"), tn.Disk(inertia=0.3, drive_share=second),
        ]
    )  # fmt: skip


def test_a_second_drive() -> None:
    """Torques of a set go with teeth, 30 : 72 : 102, whatever the shares: each motor gives its own."""
    for share in (1.0, 0.2):
        found = tn.order_response(two_motors(share), [60.0])
        np.testing.assert_allclose(found.mean_torque[0], [-30.0, -102.0, 72.0], rtol=1e-9)
    assert found.springs == ("of sun", "of carrier", "of ring")
    with pytest.raises(tn.InputError, match="one more shaft that drives a drive_share"):
        tn.order_response(two_motors(0.0), [60.0])


def test_a_loop_that_does_not_close_is_refused() -> None:
    said = r"^second\.to = 'load': closes a loop whose ratios do not: .* 0\.4 % apart.* 1\.43 deg with every turn"
    with pytest.raises(tn.InputError, match=said):
        tn.natural_frequencies(parallel(ratio=1.004))
    with pytest.raises(tn.InputError, match="second.to = 'laod': is not an earlier element; did you mean .load."):
        parallel().replace("second", to="laod")


@pytest.mark.parametrize("seed", [*range(20), *(pytest.param(n, marks=pytest.mark.slow) for n in range(20, 200))])
def test_random_lines(seed: int) -> None:
    rng = np.random.default_rng(seed)
    drawn = Drawn(rng, int(rng.integers(2, 9)), bool(rng.integers(2)))
    line, model = drawn.line, drawn.model
    found, expected = tn.natural_frequencies(line).undamped_frequency, model.frequencies()
    highest = expected.max()
    # Squares are right to rounding of the largest.
    np.testing.assert_allclose(found**2, expected**2, rtol=1e-9, atol=1e-12 * highest**2)
    if not model.springs:
        return
    response = tn.order_response(line, [50.0])
    twists = model.twists(drawn.shaken[1], TORQUE, FREQUENCY)
    found = np.abs(response.twist[0]).max(axis=0, initial=0.0)  # none where the drive holds what is shaken
    largest = [found[response.springs.index(name)] for name in drawn.springs]
    np.testing.assert_allclose(largest, twists, rtol=1e-9, atol=1e-9 * twists.max() + 1e-14)


def test_random_lines_hold_loops() -> None:
    drawn = (
        Drawn(rng, int(rng.integers(2, 9)), bool(rng.integers(2))) for rng in map(np.random.default_rng, range(200))
    )
    assert sum(one.loops > 0 for one in drawn) > 40


@pytest.mark.parametrize("seed", range(0, 40, 5))
def test_multipliers_of_random_lines(seed: int) -> None:
    """exp(λ · period) of the straight line's eigenvalues; those of rigid motions stand at 1."""
    rng = np.random.default_rng(seed)
    drawn = Drawn(rng, 4, free=False)
    found, speed = tn.stability(drawn.line, 120.0), 120.0
    expected = np.exp(drawn.model.eigenvalues() * found.period / speed)
    whole = np.concatenate([found.multipliers, np.ones(len(expected) - len(found.multipliers))])
    np.testing.assert_allclose(np.sort(np.abs(whole)), np.sort(np.abs(expected)), rtol=1e-6, atol=1e-7)
