"""Slip clutches in series: by hand, against own integrations that locate stick and slip, and in linear theory."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.equations.line_system import line_system
from trunnion.motion.passing.run_up import _let_slip
from trunnion.motion.simulation.held_clutches import held_torques
from trunnion.response.orders.clutch_torque import clutch_torque

OMEGA = 40.0


def rigid(**clutch: object) -> tn.Driveline:
    """The same with one disk alone behind the clutch; a shaft beside it, which lines need, hangs on a heavy drive."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(name="drive"),
            tn.SlipClutch(name="clutch", **clutch),
            tn.Disk(inertia=0.4, name="disk"),
            tn.Shaft(name="aside", stiffness=1e3, after="drive"),
            tn.Disk(inertia=1.0, name="heavy"),
        ]
    )


def at_rest(line: tn.Driveline) -> np.ndarray:
    """A start in which what lies behind the clutch stands still while the drive turns at OMEGA."""
    names = tn.simulate(line, 1e-6, speed=OMEGA).line.names
    return np.array([0.0] * len(names) + [0.0 if name == "heavy" else -OMEGA for name in names])


def test_engagement_by_hand() -> None:
    """A constant torque T spins J up in JΩ/T, with ½JΩ² of heat; then it sticks and carries nothing."""
    line = rigid(torque=10.0)
    run = tn.simulate(line, 3.0, speed=OMEGA, start=at_rest(line))
    heat, angle = run.slip_heat[:, 0]
    assert run.event_time == pytest.approx([0.4 * OMEGA / 10.0], rel=1e-9)
    assert heat == pytest.approx(0.5 * 0.4 * OMEGA**2, rel=1e-9)
    assert angle == pytest.approx(0.5 * OMEGA * 1.6, rel=1e-9)
    assert run.torque_at([1.0, 2.5])[:, 0] == pytest.approx([-10.0, 0.0], abs=1e-9)
    assert run.slip_at([1.0, 2.5])[0][:, 0] == pytest.approx([-OMEGA + 25.0, 0.0], abs=1e-9)
    assert "clutch: slips by 1833 deg, 320 J of heat" in str(run)


def test_engagement_with_a_rising_clamping_force() -> None:
    """Clamped over t₁ = 2 s with T = T₀t/t₁: JΩ = T₀t²/2t₁; the heat is the same at any course of the torque."""
    line = rigid(torque=16.0, clamping_times=[0.0, 2.0], clamping_shares=[0.0, 1.0])
    run = tn.simulate(line, 3.0, speed=OMEGA, start=at_rest(line))
    assert run.event_time == pytest.approx([np.sqrt(2 * 2.0 * 0.4 * OMEGA / 16.0)], rel=1e-7)
    assert np.ptp(run.slip_heat[0]) == 0 and run.slip_heat[0, 0] < 0.5 * 0.4 * OMEGA**2 * (1 + 1e-7)
    assert run.slip_heat[0, 0] == pytest.approx(0.5 * 0.4 * OMEGA**2, rel=1e-7)


def own_stick_slip(
    mass: float, spring: float, drag: float, holds: float, slides: float, over: float, force: float, omega: float,
    end: float,
) -> tuple[list[float], float, np.ndarray]:  # fmt: skip
    """Disk J behind a clutch that a drive turns, tied by a spring and a damper to a far inertia that is prescribed too
    (2000 times as heavy): in the frame that turns with the drive J v̇ = −T(v) − k q − c v + F cos ωt.

    Stick and slip are located by roots; times of all changes, the heat, and the state at the end.
    """

    def other(t: float, q: float, v: float) -> float:
        return force * np.cos(omega * t) - spring * q - drag * v

    def rub(v: float, sense: int) -> float:
        return sense * (slides + (holds - slides) * np.exp(-abs(v) / over))

    t, y, sense, changes = 0.0, np.array([0.0, 0.0, 0.0]), 0, []
    if abs(other(0.0, 0.0, 0.0)) > holds:
        sense = int(np.sign(other(0.0, 0.0, 0.0)))
    settings = {"rtol": 1e-11, "atol": 1e-13, "method": "DOP853"}
    while t < end:
        if sense == 0:
            q = y[0]

            def over_capacity(t: float, q: float = q) -> float:
                return abs(other(t, q, 0.0)) - holds

            fine = np.linspace(t, end, 200_001)
            above = np.flatnonzero(np.abs(force * np.cos(omega * fine) - spring * q) - holds > 1e-12)
            if not len(above):
                break
            low, high = fine[max(above[0] - 1, 0)], fine[above[0]]
            for _ in range(100):
                middle = (low + high) / 2
                low, high = (low, middle) if over_capacity(middle) > 0 else (middle, high)
            t, sense = high, int(np.sign(other(high, q, 0.0)))
            changes.append(t)
            continue

        def rate(t: float, y: np.ndarray, sense: int = sense) -> list[float]:
            torque = rub(y[1], sense)
            return [y[1], (other(t, y[0], y[1]) - torque) / mass, abs(torque * y[1])]

        def stops(t: float, y: np.ndarray, sense: int = sense, begun: float = t + 1e-9) -> float:
            return float(y[1]) if t > begun else float(sense)

        stops.terminal, stops.direction = True, -sense
        run = solve_ivp(rate, (t, end), y, events=stops, max_step=0.01, **settings)
        t, y = float(run.t[-1]), run.y[:, -1]
        if run.status == 0:
            break
        y[1] = 0.0
        changes.append(t)
        pull = other(t, y[0], 0.0)
        sense = 0 if abs(pull) <= holds else int(np.sign(pull))
    return changes, float(y[2]), y[:2]


@pytest.mark.filterwarnings("ignore:disk.excitation. does nothing while clutch sticks")
@pytest.mark.parametrize(
    ("holds", "slides", "over", "force", "omega"),
    [(6.0, 6.0, 1.0, 9.0, 20.0), (6.0, 3.0, 0.2, 7.0, 11.0), (4.0, 7.0, 0.5, 9.0, 33.0), (3.0, 1.0, 0.1, 30.0, 25.0)],
    ids=["constant", "falling", "rising", "through"],
)
def test_stick_and_slip_against_an_own_integration(
    holds: float, slides: float, over: float, force: float, omega: float
) -> None:
    """Every change of an excited disk, to 1e-7 s, and the heat; the far inertia turns with the drive."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(name="drive"),
            tn.SlipClutch(name="clutch", torque=holds, sliding_torque=slides, stribeck_speed=over),
            tn.Disk(inertia=0.05, name="disk", excitation=[{"frequency": omega, "amplitude": force}]),
            tn.Shaft(stiffness=60.0, damping=0.02),
            tn.Disk(inertia=1e12, name="far"),
        ]
    )
    run = tn.simulate(line, 2.0, speed=OMEGA, tolerance=1e-11)
    changes, heat, state = own_stick_slip(0.05, 60.0, 0.02, holds, slides, over, force, omega, 2.0)
    assert len(changes) >= 8
    assert len(run.event_time) == len(changes)
    assert np.abs(run.event_time - changes).max() < 1e-7
    assert run.slip_heat[0, 0] == pytest.approx(heat, rel=1e-8)
    place = run.line.names.index("disk")
    assert run.final[[place, 2 + place]] == pytest.approx(state, abs=1e-7)
    # Never beyond its capacity, and what it carries is what the disk needs, also where it sticks.
    low, high = run.torque_extremes.low[0], run.torque_extremes.high[0]
    assert max(abs(low), abs(high)) <= max(holds, slides) * (1 + 1e-9)


def jointed(capacity: float, bend: float = 0.5) -> tn.Driveline:
    """A Hooke's joint and two clutches in a row, the second on a disk that hangs between them."""
    return tn.Driveline(
        [
            tn.Disk(inertia=0.8, name="engine", excitation=[{"frequency": 31.0, "amplitude": 40.0}]),
            tn.HookeJoint(angle=bend, name="joint"),
            tn.SlipClutch(name="first", torque=capacity, sliding_torque=0.7 * capacity, stribeck_speed=0.5),
            tn.Disk(inertia=0.1, name="between"),
            tn.SlipClutch(name="second", torque=0.6 * capacity),
            tn.Disk(inertia=0.2, name="out", viscous_load=0.0),
            tn.Shaft(stiffness=300.0, name="shaft"),
            tn.Disk(inertia=0.4, name="end"),
        ]
    )


def test_energy_of_two_clutches_behind_an_angled_joint() -> None:
    """Work of the excitation = kinetic and elastic energy + heat of both clutches, over many changes of regime."""
    line = jointed(18.0)
    run = tn.simulate(line, 1.5, speed=OMEGA, tolerance=1e-12)
    assert len(run.event_time) > 12 and (run.slip_heat[0] > 0).all()
    names = run.line.names
    n = len(names)
    inertia = np.array([{"engine": 0.8, "between": 0.1, "out": 0.2, "end": 0.4}[name] for name in names])
    engine = names.index("engine")

    def energy(time: float) -> float:
        state = run.at(time)
        twist = run.motion_at([time]).twist[0, run.shafts.index("shaft")]
        return float(0.5 * inertia @ (OMEGA + state[n : 2 * n]) ** 2 + 0.5 * 300.0 * twist**2)

    nodes, weights = np.polynomial.legendre.leggauss(10)
    length = np.diff(run.cuts)[:, None]
    times = (run.cuts[:-1, None] + length * (1 + nodes) / 2).ravel()
    power = 40.0 * np.cos(31.0 * times) * (OMEGA + run.at(times)[:, n + engine])
    work = (length * weights / 2).ravel() @ power
    left = work - (energy(run.end) - energy(0.0)) - run.slip_heat[0].sum()
    assert abs(left) < 1e-7 * run.slip_heat[0].sum()
    assert run.slip_heat[0].min() > 0.1


def test_what_sticks_moves_as_one() -> None:
    """Above any torque asked of them, clutches are rigid: as the line with the inertias put together."""
    stuck = tn.simulate(jointed(1e6), 0.5, speed=OMEGA)
    assert len(stuck.event_time) == 0 and "first: sticks" in str(stuck)
    elements = [one for one in jointed(1e6).elements if one.name not in ("first", "second", "between")]
    merged = tn.simulate(tn.Driveline(elements).replace("out", inertia=0.3), 0.5, speed=OMEGA)
    times = np.linspace(0.0, 0.5, 50)
    torque = [run.torque_at(times)[:, run.shafts.index("shaft")] for run in (stuck, merged)]
    assert np.abs(torque[0] - torque[1]).max() < 1e-6 * np.abs(torque[1]).max()


def loaded(load: float, **clutch: object) -> tn.Driveline:
    """A line with a joint, an excitation and a load behind a ratio, its clutch in the middle."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=2e3, damping=1.0, name="shaft"),
            tn.Disk(inertia=0.1, name="yoke", excitation=[{"order": 2, "amplitude": 5.0}]),
            *([tn.SlipClutch(name="clutch", **clutch)] if clutch else []),
            tn.Disk(inertia=0.2, name="hub"),
            tn.HookeJoint(angle=0.2, name="joint"),
            tn.Shaft(stiffness=3e3, damping=1.0, name="rear"),
            tn.Ratio(ratio=3, name="gears"),
            tn.Disk(inertia=4.0, name="rotor", load_torque=load),
        ]
    )


def test_linear_analyses_take_it_as_a_rigid_link() -> None:
    """Modes, response and stability are those without it; a load beyond its capacity is refused, by its own torque."""
    clutch, plain = loaded(150.0, torque=51.0), loaded(150.0)
    assert tn.natural_frequencies(clutch).elastic == pytest.approx(tn.natural_frequencies(plain).elastic, rel=1e-12)
    speeds = [20.0, 45.0]
    first, second = tn.order_response(clutch, speeds), tn.order_response(plain, speeds)
    assert first.vibratory_torque == pytest.approx(second.vibratory_torque, rel=1e-10)
    assert tn.stability(clutch, 45.0).spectral_radius == pytest.approx(
        tn.stability(plain, 45.0).spectral_radius, rel=1e-10
    )
    # behind a ratio of 3 the load of 150 N m is 50 N m at the clutch
    for run in (tn.natural_frequencies, lambda line: tn.order_response(line, speeds)):
        with pytest.raises(tn.InputError, match=r"clutch.torque: carries a load of 50 N m, beyond its capacity of 49"):
            run(loaded(150.0, torque=49.0))
    with pytest.raises(tn.InputError, match=r"a load of 50 N m, beyond its capacity of 49\.99999 N m"):
        tn.natural_frequencies(loaded(150.0, torque=49.99999))
    with pytest.raises(tn.InputError, match=r"a load of 50 N m, beyond its capacity of 49\.9999999 N m"):
        tn.natural_frequencies(loaded(150.0, torque=49.9999999))
    opened = loaded(150.0, torque=100.0, clamping_times=[0.0, 1.0], clamping_shares=[1.0, 0.4])
    with pytest.raises(tn.InputError, match="beyond its capacity of 40 N m"):
        tn.natural_frequencies(opened)


def test_what_is_not_followed_is_refused_by_name() -> None:
    line = loaded(20.0, torque=51.0)
    for run in (
        lambda: tn.periodic_branch(line, "speed", 20.0, 30.0),
        lambda: tn.exact_motion(line, 0.1, speed=20.0),
        lambda: tn.poincare_map(line, 5, speed=20.0),
    ):
        with pytest.raises(tn.InputError, match=r"clutch.torque = 51\S*: sticks and slips, which this analysis"):
            run()
    bare = [tn.ConstantSpeed(), tn.Disk(inertia=1.0), tn.SlipClutch(name="clutch", torque=5.0)]
    with pytest.raises(tn.InputError, match=r"clutch: has no inertia behind it; put a Disk behind clutch"):
        tn.simulate(tn.Driveline([*bare, tn.Shaft(stiffness=1e3), tn.Disk(inertia=1.0)]), 0.1, speed=9)


@pytest.mark.parametrize("shaken", ["yoke", "hub"])
def test_the_torque_in_a_response_is_that_of_the_simulation(shaken: str) -> None:
    """From behind the clutch, or from in front where the excitation acts behind; straight, so that both are exact."""
    line = loaded(60.0, torque=1e6).replace("joint", angle=0.0).replace("yoke", excitation=[])
    line = line.replace(
        shaken, excitation=[{"frequency": 95.0, "amplitude": 8.0}, {"frequency": 190.0, "amplitude": 6.0}]
    )
    told = clutch_torque(assemble(line), "clutch")
    assert told is not None and told.sense == (1 if shaken == "yoke" else -1)
    run = tn.simulate(line, 60.0, speed=OMEGA, tolerance=1e-10)
    times = np.linspace(60.0 - 2 * np.pi / 95.0, 60.0, 4001)
    torque = run.torque_at(times)[:, run.shafts.index("clutch")]
    assert told.peak(tn.order_response(line, [OMEGA]))[0] == pytest.approx(np.abs(torque).max(), rel=1e-6)


def shaken(torque: float, clutch: object = None) -> tn.Driveline:
    """An angled joint, excitation and loads on both sides of a clutch."""
    between = tn.SlipClutch(name="clutch", torque=torque) if clutch is None else clutch
    return tn.Driveline(
        [
            tn.ConstantSpeed(), tn.HookeJoint(angle=0.2), tn.Shaft(stiffness=5e3, damping=3.0, name="front"),
            tn.Disk(inertia=0.2, name="hub", viscous_load=0.1), between,
            tn.Disk(inertia=0.3, name="plate", viscous_load=0.05, excitation=[{"order": 2, "amplitude": 30.0}]),
            tn.Shaft(stiffness=8e3, damping=3.0, name="rear"), tn.Disk(inertia=0.4, name="load", load_torque=20.0),
        ]
    )  # fmt: skip


def test_a_periodic_motion_has_the_clutch_stick_and_says_where_it_would_not() -> None:
    """The torque that it holds, against that of the line in which it may slip, followed from the same state."""
    found = tn.periodic_response(shaken(500.0), 60.0)
    rigid = tn.periodic_response(shaken(0.0, tn.Ratio(ratio=1.0)), 60.0)
    np.testing.assert_allclose(found.torque_peak_to_peak, rigid.torque_peak_to_peak, rtol=1e-9)
    times = np.linspace(0.0, found.period, 301)
    held = held_torques(found.line, found.system, times, found.trajectory.at(times))[:, 0]
    free = line_system(shaken(500.0), 60.0, leaves=True, slips=True)
    start = _let_slip(found.line, found.start)
    run = tn.simulate(shaken(500.0), found.period, speed=60.0, start=start, tolerance=1e-12)
    slips = run.torque_at(times)[:, free.shafts.index("clutch")]
    # Its torque is positive with a twist, the other where it drives what lies beyond.
    np.testing.assert_allclose(held, -slips, atol=2e-6 * np.abs(slips).max())
    most = float(np.abs(held).max())
    assert tn.periodic_response(shaken(1.001 * most), 60.0).outcome.ok
    with pytest.raises(tn.InputError, match=r"clutch\.torque: would have to hold .* beyond its capacity of .*it slips"):
        tn.periodic_response(shaken(0.999 * most), 60.0)


def test_a_run_up_lets_the_clutch_slip() -> None:
    """Sticking it is a rigid link; slipping its plate is accelerated by its torque alone, which tells slip and heat."""
    stuck, rigid = (tn.run_up(line, 40.0, 80.0, acceleration=40.0, steady=0) for line in
                    (shaken(900.0), shaken(0.0, tn.Ratio(ratio=1.0))))  # fmt: skip
    np.testing.assert_allclose(stuck.peak_torque[[0, 2]], rigid.peak_torque, rtol=1e-7)
    assert stuck.simulation.slip_heat[0, 0] == 0.0
    line = tn.Driveline(
        [tn.ConstantSpeed(), tn.Shaft(stiffness=1e6, damping=200.0), tn.Disk(inertia=0.05),
         tn.SlipClutch(name="clutch", torque=12.0), tn.Disk(inertia=0.5)]
    )  # fmt: skip
    run = tn.run_up(line, 50.0, 90.0, acceleration=40.0, ramp=0.0, steady=0)
    lasts, gains = 1.0, 40.0 - 12.0 / 0.5  # s; rad/s², by which the plate falls behind
    heat, angle = run.simulation.slip_heat[:, 0]
    np.testing.assert_allclose(angle, gains * lasts**2 / 2, rtol=2e-3)
    np.testing.assert_allclose(heat, 12.0 * angle, rtol=1e-6)
    np.testing.assert_allclose(run.peak_torque[run.shafts.index("clutch")], 12.0, rtol=1e-9)
