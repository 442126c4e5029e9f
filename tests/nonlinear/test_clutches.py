"""Dry friction in clutches: energy, matching equations solved apart, Den Hartog's limit, and what never slips."""

from __future__ import annotations

import numpy as np
import pytest
from line_energy import energy
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import fsolve

import trunnion as tn
from trunnion.laws import friction

INERTIA, SPRING, SERIES, TORQUE, FORCE, OMEGA, DAMPING = 0.1, 800.0, 4000.0, 6.0, 9.0, 60.0, 0.4


def clutch_line(
    *,
    force: float = FORCE,
    torque: float = TORQUE,
    series: float = SERIES,
    spring: float = SPRING,
    damping: float = DAMPING,
    omega: float = OMEGA,
    sliders: int = 1,
) -> tn.Driveline:
    """A disk on a clutch that a drive holds, shaken in time; sliders with equal shares of the torque."""
    parts = [{"torque": torque / sliders, "stiffness": series / sliders} for _ in range(sliders)]
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Clutch(stiffnesses=[spring], damping=damping, friction=parts, name="clutch"),
            tn.Disk(inertia=INERTIA, excitation=[{"frequency": omega, "amplitude": force}]),
        ]
    )


def matched(
    *, force: float, torque: float, series: float, spring: float, damping: float, omega: float, guess: np.ndarray
) -> np.ndarray:
    """Masri's matching equations of the bilinear hysteretic oscillator, symmetric, two pieces a half period.

    From a turning point, where all sticks again: q″ J + c q′ + k₁ q + k (q − q₀) ± T … with exact matrix exponentials.
    Unknown are the amplitude, the phase of the force at the turning point and the time until it slips; solved are:
    it slips when it has moved by 2T/k, and half a period later it stands at the opposite turning point.
    """

    def piece(stiffness: float, constant: float, start: np.ndarray, phase: float, time: float) -> np.ndarray:
        # (q, q′, cos, sin, 1), all linear
        a = np.zeros((5, 5))
        a[0, 1] = 1.0
        a[1] = [-stiffness / INERTIA, -damping / INERTIA, force / INERTIA, 0.0, constant / INERTIA]
        a[2, 3], a[3, 2] = -omega, omega
        return (expm(a * time) @ np.array([*start, np.cos(phase), np.sin(phase), 1.0]))[:2]

    def left(x: np.ndarray) -> np.ndarray:
        top, phase, sticks = x
        # from q = top, q′ = 0 with the slider at + T: f = T + k (q − top)
        slips = piece(spring + series, series * top - torque, np.array([top, 0.0]), phase, sticks)
        end = piece(spring, torque, slips, phase + omega * sticks, np.pi / omega - sticks)
        return np.array([slips[0] - top + 2 * torque / series, end[0] + top, end[1] / omega])

    found, _, ended, words = fsolve(left, guess, xtol=1e-14, full_output=True)
    assert ended == 1 or np.abs(left(found)).max() < 1e-13, words
    return found


def test_the_steady_motion_is_that_of_the_matching_equations() -> None:
    orbit = tn.piecewise_orbit(clutch_line())
    assert orbit.outcome.ok and orbit.verdict.name == "STABLE" and orbit.stuck == ()
    turn = orbit.events.time[orbit.events.side == 0]
    numbers = {"force": FORCE, "torque": TORQUE, "series": SERIES, "spring": SPRING, "damping": DAMPING, "omega": OMEGA}
    slip = orbit.events.time[orbit.events.side == -1]
    guess = np.array([orbit.twist_high[0], OMEGA * turn[0], np.min((slip - turn[0]) % (2 * np.pi / OMEGA))])
    # the event may be either turning point
    if np.abs(guess[0]) and orbit.line.flow() and _twist_at(orbit, turn[0]) < 0:
        guess[1] += np.pi
        up = orbit.events.time[orbit.events.side == 1]
        guess[2] = np.min((up - turn[0]) % (2 * np.pi / OMEGA))
    top, _, _ = matched(**numbers, guess=guess)
    assert abs(orbit.twist_high[0] - top) < 1e-12 and abs(orbit.twist_low[0] + top) < 1e-12


def _twist_at(orbit: object, time: float) -> float:
    times, states, _ = orbit.motion(4096)  # type: ignore[attr-defined]
    return float(np.interp(time, times, states[:, 0]))


def test_energy_per_cycle_is_that_of_the_loop() -> None:
    """Work of the torque over a period: 4T(A − T/k) and that of the damper, π c ω A² of a harmonic one."""
    orbit = tn.piecewise_orbit(clutch_line(damping=0.0))
    times, states, torque = orbit.motion(20_000)
    work = float(np.sum(torque[:, 0] * states[:, orbit.line.size]) * (times[1] - times[0]))
    amplitude = float(orbit.twist_high[0])
    assert work == pytest.approx(float(friction.lost_per_cycle(TORQUE, SERIES, amplitude)), rel=1e-6)
    # what the excitation does is what friction takes
    drive = FORCE * np.cos(OMEGA * times)
    assert float(np.sum(drive * states[:, orbit.line.size]) * (times[1] - times[0])) == pytest.approx(work, rel=1e-6)


def test_simulation_integrates_the_exact_motion() -> None:
    line = clutch_line(sliders=2)
    exact = tn.exact_motion(line, 0.6)
    run = tn.simulate(line, 0.6, speed=100.0, tolerance=1e-11)
    final = run.pieces[-1].final
    assert np.abs(final[:2] - exact.final[[0, exact.line.size]]).max() < 1e-8
    slips = exact.events.time[exact.events.side != 0]
    assert len(run.event_time) > 4 and np.abs(np.sort(run.event_time)[0] - slips[0]) < 1e-9
    assert energy(run.line, run.pieces[0].system, [0.6], [final])[1][0] == pytest.approx(
        SPRING * final[0] ** 2 / 2 + SERIES / 2 * (final[2:] ** 2).sum() / 2, rel=1e-12
    )


def test_both_engines_close_the_same_orbit() -> None:
    exact, integrated = tn.piecewise_orbit(clutch_line()), tn.periodic_response(clutch_line(), 100.0)
    assert integrated.outcome.ok
    assert float(integrated.torque_peak_to_peak[0]) == pytest.approx(float(exact.torque_peak_to_peak[0]), rel=1e-7)
    mine, other = (np.sort(np.abs(m))[::-1][:2] for m in (exact.multipliers, integrated.multipliers))
    np.testing.assert_allclose(mine, other, atol=1e-6)


def test_a_slider_that_never_slips_is_set_aside() -> None:
    """Then the clutch is a spring of both stiffnesses: the other multipliers are its own, and 1 is not among them."""
    line = clutch_line(force=1.0)
    orbit = tn.piecewise_orbit(line)
    assert orbit.outcome.ok and orbit.stuck == ("clutch slider 1",) and orbit.verdict.name == "STABLE"
    plain = tn.Driveline([line.elements[0], tn.Shaft(stiffness=SPRING + SERIES, damping=DAMPING), line.elements[2]])
    expected = tn.piecewise_orbit(plain)
    np.testing.assert_allclose(np.sort(np.abs(orbit.multipliers)), np.sort(np.abs(expected.multipliers)), atol=1e-12)
    assert abs(orbit.twist_high[0] - expected.twist_high[0]) < 1e-12
    integrated = tn.periodic_response(line, 100.0)
    assert integrated.outcome.ok and integrated.verdict.name == "STABLE"


def test_stiff_sliders_approach_den_hartogs_dry_friction() -> None:
    """Coulomb friction T beside a spring, driven at ratio r: his closed form of the amplitude, without stops.

    A/(F/k) = √(V² − (T/F)² U²), V = 1/(1 − r²), U = sin(π/r)/(r (1 + cos(π/r))) (Den Hartog, Trans. ASME 53, 1931).
    """
    omega = 60.0
    r = omega / np.sqrt(SPRING / INERTIA)
    v, u = 1 / (1 - r**2), np.sin(np.pi / r) / (r * (1 + np.cos(np.pi / r)))
    expected = FORCE / SPRING * np.sqrt(v**2 - (2.0 / FORCE) ** 2 * u**2)
    errors = []
    for series in (2e5, 8e5, 3.2e6):
        line = clutch_line(torque=2.0, series=series, damping=0.0)
        errors.append(float(tn.piecewise_orbit(line).twist_high[0]) / expected - 1)
    # The time in which it sticks falls with √k, and so does what it does.
    assert abs(errors[2]) < 2e-3 and errors[2] / errors[1] == pytest.approx(0.5, abs=0.05)
    assert abs(2 * errors[2] - errors[1]) < 1e-4


def test_a_sweep_passes_from_stick_to_slip() -> None:
    found = tn.sweep(clutch_line(damping=2.0), np.linspace(40.0, 120.0, 9))
    assert found.outcome.ok and found.settled.all()
    for i in (0, 4):
        single = tn.piecewise_orbit(clutch_line(damping=2.0, omega=float(found.value[i])))
        assert float(found.torque_peak_to_peak[i, 0]) == pytest.approx(float(single.torque_peak_to_peak[0]), rel=1e-6)


@pytest.mark.parametrize("amplitude", [0.5, 1.2, 4.0])
def test_equivalent_stiffness_and_damping_are_those_of_the_loop(amplitude: float) -> None:
    """The fundamental of the torque over a harmonic twist, by its own integration of slider and stages."""
    size, reach, count = amplitude * TORQUE / SERIES, TORQUE / SERIES, 200_000
    clutch = tn.Clutch(
        breakpoints=[-0.6 * reach, 0.8 * reach], stiffnesses=[500.0, 800.0, 1500.0], damping=0.05,
        friction=[{"torque": TORQUE, "stiffness": SERIES}],
    )  # fmt: skip
    theta = 2 * np.pi * np.arange(2 * count) / count

    def spring(twist: np.ndarray) -> np.ndarray:
        beyond = 700.0 * np.maximum(twist - 0.8 * reach, 0) + (500.0 - 800.0) * np.minimum(twist + 0.6 * reach, 0)
        return 800.0 * twist + beyond

    # About the twist with no torque on average, which stages that are not alike on both sides move.
    middle = fsolve(lambda m: spring(m + size * np.cos(theta)).mean(), 0.0, xtol=1e-14)[0]
    q, x = middle + size * np.cos(theta), 0.0
    deflection = np.empty_like(q)
    for i, step in enumerate(np.diff(q, prepend=q[0])):
        x = min(max(x + step, -reach), reach)
        deflection[i] = x
    f = (spring(q) + SERIES * deflection)[count:]
    fundamental = 2 * np.mean(f * np.exp(-1j * theta[count:]))
    shaft = clutch.linear(size, 50.0)
    assert shaft.stiffness == pytest.approx(fundamental.real / size, rel=1e-4)
    assert shaft.damping == pytest.approx(0.05 + fundamental.imag / size / 50.0, rel=1e-3, abs=1e-4)


def test_linear_analyses_offer_the_equivalent_shaft() -> None:
    with pytest.raises(tn.InputError, match=r"clutch\.friction: has dry friction.*linear_amplitude = \"1 deg\""):
        tn.natural_frequencies(clutch_line())
    line = clutch_line()
    equivalent = line.elements[1].linear("1 deg", OMEGA)
    assert tn.natural_frequencies(tn.Driveline([line.elements[0], equivalent, line.elements[2]])).frequency[0] > 0


def test_the_exact_motion_is_that_of_scipy_between_located_events() -> None:
    """Written out with scipy's events; a clutch behind another disk, of two unequal sliders."""
    parts = [{"torque": 2.0, "stiffness": 3000.0}, {"torque": 4.0, "stiffness": 1000.0}]
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=3000.0, damping=1.0),
            tn.Disk(inertia=0.2),
            tn.Clutch(stiffnesses=[900.0], damping=0.3, friction=parts),
            tn.Disk(inertia=INERTIA, excitation=[{"frequency": OMEGA, "amplitude": 14.0}], load_torque=3.0),
        ]
    )
    torque, series = np.array([2.0, 4.0]), np.array([3000.0, 1000.0])
    reach, time, state, slips = torque / series, 0.0, np.zeros(6), np.zeros(2)
    while time < 0.4:
        moving = slips == 0

        def rate(t: float, y: np.ndarray, moving: np.ndarray = moving) -> np.ndarray:
            q, v = y[1] - y[0], y[3] - y[2]
            f = 900.0 * q + 0.3 * v + series @ y[4:]
            push = 14.0 * np.cos(OMEGA * t) - 3.0
            a = [(f - 3000.0 * y[0] - 1.0 * y[2]) / 0.2, (push - f) / INERTIA]
            return np.array([y[2], y[3], *a, *(v * moving)])

        events = []
        for i in range(2):
            if moving[i]:
                for side in (-1, 1):
                    events.append(lambda t, y, i=i, side=side: side * y[4 + i] - reach[i])
            else:
                events.append(lambda t, y, i=i, side=slips[i]: -side * (y[3] - y[2]))
        for event in events:
            event.terminal, event.direction = True, 1
        run = solve_ivp(rate, (time, 0.4), state, method="DOP853", rtol=1e-12, atol=1e-15, events=events)
        time, state = run.t[-1], run.y[:, -1].copy()
        v = state[3] - state[2]
        for i in range(2):
            if moving[i] and abs(abs(state[4 + i]) - reach[i]) < 1e-13:
                slips[i] = np.sign(state[4 + i])
                state[4 + i] = slips[i] * reach[i]
            elif not moving[i] and slips[i] * v <= 1e-12:
                slips[i] = 0
    found = tn.exact_motion(line, 0.4)
    assert len(found.events) > 12
    expected = [state[0], state[1] - state[0], *state[4:], state[2], v, v, v]
    np.testing.assert_allclose(found.final, expected, atol=2e-10)


REFUSED = [
    ({"friction": []}, "from 1 to 8 sliders"),
    ({"friction": 3}, "not a list of sliders"),
    ({"friction": [3]}, "not a slider"),
    ({"friction": [{"torque": 1.0}]}, "stiffness: is missing"),
    ({"friction": [{"torque": -1.0, "stiffness": 1.0}]}, "must be positive"),
    ({"friction": [{"torque": 1.0, "stiffness": 1.0}], "stiffnesses": [1.0, 2.0]}, "must be 1 quantities"),
]


@pytest.mark.parametrize(("numbers", "words"), REFUSED, ids=[w for _, w in REFUSED])
def test_wrong_clutches_are_refused(numbers: dict[str, object], words: str) -> None:
    with pytest.raises(tn.InputError, match=words) as refusal:
        tn.Clutch(**{"stiffnesses": [800.0], **numbers})
    assert "\n" not in str(refusal.value)
