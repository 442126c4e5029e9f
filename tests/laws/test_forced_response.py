"""The linear forced response against the nonlinear equations, by an independent integration."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.chains import Chain
from oracles.nonlinear import NonlinearChain
from scipy.integrate import solve_ivp

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.equations.linear import periodic_linear_system
from trunnion.motion.orbits.periodic_response import PeriodicResponse
from trunnion.numerics.chain.dense_monodromy import Propagation, propagate
from trunnion.steady.orders.forced_response import LinearResponse
from trunnion.systems.periodic_linear import from_matrices


def periodic_states(run: Propagation) -> np.ndarray:
    """States (time, 2n) of the periodic solution; least-norm where a multiplier is 1 (a free line)."""
    z = run.monodromy * run.scale[None, :] / run.scale[:, None]
    start = np.linalg.lstsq(np.eye(len(z)) - z, run.particular / run.scale, rcond=1e-13)[0] * run.scale
    return run.states(start, 1)


def two_shafts(beta: float, load: float = 0.0) -> Chain:
    """A well damped two-shaft line between resonances."""
    return Chain(
        speed=0.8,
        stiffness=[1.0, 0.7],
        damping=[0.15, 0.2],
        inertia=[1.0, 0.6],
        angle=[beta],
        fork_offset=[0.4, 0.0],
        plane=[0.0],
        load=[0.0, load],
    )


def steady_state(case: Chain, tau: np.ndarray) -> np.ndarray:
    """Deviations (time, 2) over one period of the nonlinear motion, by Newton's method on the state after a period."""
    model, start, step = NonlinearChain(case), np.zeros(4), 1e-4

    def after(state: np.ndarray) -> np.ndarray:
        run = solve_ivp(model.slopes, (0, case.period), state, method="DOP853", rtol=1e-10, atol=1e-13)
        return np.asarray(run.y[:, -1])

    slopes = np.array([(after(d) - after(-d)) / (2 * step) for d in step * np.eye(4)]).T
    for _ in range(6):  # the slopes at rest suffice: they change with the motion, which is small
        start = start + np.linalg.solve(np.eye(4) - slopes, after(start) - start)
    last = solve_ivp(model.slopes, (0, tau[-1]), start, method="DOP853", rtol=1e-12, atol=1e-15, t_eval=tau)
    assert np.abs(last.y[:, -1] - last.y[:, 0]).max() < 1e-10
    return np.asarray(last.y[:2].T)


def both(beta: float, load: float = 0.0) -> tuple[LinearResponse, np.ndarray]:
    """The package's linear response, and the nonlinear deviations at its times."""
    case = two_shafts(beta, load)
    response = tn.stability(case.line(), case.speed, tolerance=1e-12).response
    assert response is not None
    return response, steady_state(case, response.tau)


def departure(beta: float) -> float:
    """Largest difference of linear and nonlinear deviations over the largest deviation."""
    response, exact = both(beta)
    return float(np.abs(response.rotation - exact).max() / np.abs(exact).max())


def test_linear_response_is_the_limit_of_small_angles() -> None:
    """Relative difference falls with β⁴: second-order terms of the twist, itself of order β²."""
    far = [departure(beta) for beta in (0.3, 0.15, 0.075)]
    assert far[0] < 1e-3
    assert far[0] / far[1] == pytest.approx(16, rel=0.2)
    assert far[1] / far[2] == pytest.approx(16, rel=0.2)


def test_zero_load_amplitudes_follow_the_nonlinear_motion() -> None:
    response, exact = both(0.2)
    assert response.linear
    assert np.ptp(response.rotation, axis=0) == pytest.approx(np.ptp(exact, axis=0), rel=5e-4)


def test_loaded_mean_twist() -> None:
    """Under load the nonlinear mean twist of shaft 1 is −M/k₁ times the mean of the ratio, 1 for small β."""
    response, exact = both(0.1, load=0.05)
    assert response.twist[:-1, 0].mean() == pytest.approx(exact[:-1, 0].mean(), rel=1e-3)
    assert np.ptp(response.twist[:, 0]) == pytest.approx(np.ptp(exact[:, 0]), rel=0.02)


def test_mean_torque_without_load_is_of_second_order() -> None:
    """Mean power covers the dampers' losses, which are quadratic in the response."""
    case = two_shafts(0.02)
    response = tn.stability(case.line(), case.speed, tolerance=1e-12).response
    assert response is not None
    assert response.torque_mean == pytest.approx([0.0, 0.0], abs=1e-3 * response.torque_amplitude.max())


def test_forced_oscillator_of_your_own() -> None:
    """x″ + 2ζx′ + x = cos ντ has the amplitude every textbook prints."""
    nu, zeta = 1.4, 0.05
    system = from_matrices(
        np.eye(1),
        np.array([[2 * zeta]]),
        np.eye(1),
        period=2 * np.pi / nu,
        forcing=lambda tau: np.cos(nu * tau)[:, None],
    )

    def arrays(tau: np.ndarray) -> tuple[np.ndarray, ...]:
        m = system.coefficients(tau)
        return m.mass, m.damping, m.stiffness, m.forcing

    states = periodic_states(propagate(arrays, system.period, 1, 1e-12, 64))  # type: ignore[arg-type]
    amplitude = 1 / np.hypot(1 - nu**2, 2 * zeta * nu)
    assert np.ptp(states[:, 0]) / 2 == pytest.approx(amplitude, rel=1e-3)
    assert states[0, 0] == pytest.approx(amplitude**2 * (1 - nu**2), rel=1e-9)
    assert states[0, 1] == pytest.approx(amplitude**2 * 2 * zeta * nu**2, rel=1e-9)


def excited_beside_a_joint() -> tn.Driveline:
    engine = [{"order": 2, "amplitude": 20.0, "phase": 0.4}]
    return tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=2e4, damping=4.0), tn.Disk(inertia=0.5, excitation=engine),
            tn.HookeJoint(angle=0.01), tn.Shaft(stiffness=1e4, damping=2.0), tn.Disk(inertia=0.3, load_torque=40.0),
        ]
    )  # fmt: skip


def test_everything_that_excites_is_in_the_response() -> None:
    """Excitation of a disk beside an angled joint, against the nonlinear periodic motion; in the sweep as well."""
    line, speed = excited_beside_a_joint(), 40.0
    response = tn.stability(line, speed).response
    assert response is not None
    true = tn.periodic_response(line, speed)
    assert isinstance(true, PeriodicResponse) and true.comparison is not None
    assert response.torque_amplitude == pytest.approx(true.torque_peak_to_peak / 2, rel=2e-3)
    assert response.torque_amplitude.min() > 3
    assert true.comparison.linear_torque_peak_to_peak == pytest.approx(2 * response.torque_amplitude)
    assert tn.speed_sweep(line, [speed]).torque_amplitude[0] == pytest.approx(response.torque_amplitude, rel=1e-9)


def test_wave_of_a_line_without_excitation_is_that_of_the_propagator() -> None:
    """What joints alone force, by the motion from rest and the monodromy matrix: x₀ = (I − Z)⁻¹ x_p(T)."""
    case = two_shafts(0.3, load=0.05)
    response = tn.stability(case.line(), case.speed).response
    assert response is not None
    assembly = assemble(case.line())
    system = periodic_linear_system(assembly, assembly.table(1, case.speed))

    def arrays(tau: np.ndarray) -> tuple[np.ndarray, ...]:
        m = system.coefficients(tau)
        return m.mass, m.damping, m.stiffness, m.forcing

    run = propagate(arrays, system.period, 2, 1e-13, len(response.tau) - 1)  # type: ignore[arg-type]
    x = periodic_states(run)[:: run.steps // (len(response.tau) - 1), :2]
    assert np.abs(response.rotation - x).max() < 1e-9 * np.abs(x).max()


def test_speeds_without_a_steady_state_are_named() -> None:
    """An undamped line at half its natural frequency, where order 2 of its joint meets it: said, and where; beside it
    the amplitude falls as the inverse of the distance."""
    half = float(np.sqrt(1e4 / 0.8)) / 2
    elements = [tn.ConstantSpeed(), tn.HookeJoint(angle=0.05), tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.8)]
    line, away = tn.Driveline(elements), np.array([-2e-4, -1e-4, 1e-4, 2e-4])
    found = tn.speed_sweep(line, [half, *half * (1 + away)], statically_twisted=False)
    torque = found.torque_amplitude[:, 0]
    assert np.isnan(torque[0]) and torque[2] / torque[1] == pytest.approx(2.0, rel=0.05)
    said = [str(one) for one in found.findings if one.sentence.startswith("No steady state exists")]
    assert said == [line for line in map(str.strip, str(found).splitlines()) if "No steady state" in line]
    assert len(said) == 1 and f"at {half:.6g} rad/s:" in said[0]
    assert "No steady state" not in str(tn.speed_sweep(line, half * (1 + away)))
