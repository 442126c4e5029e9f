"""Free–free lines, and loads that depend on the speed, against closed forms and equations written anew here."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.comparisons import set_distance
from oracles.package_kernels import chain_kernel
from scipy.integrate import solve_ivp

import trunnion as tn


def propeller(stiffness: float, share: float = 1.0, reverse: float = 1.0) -> tn.Driveline:
    return tn.Driveline(
        [
            tn.Disk(inertia=6.0, drive_share=share),
            tn.Ratio(ratio=3.5 * reverse),
            tn.Shaft(stiffness=stiffness, damping=50.0),
            tn.Disk(inertia=35.0, quadratic_load=4.31),
        ]
    )


@pytest.mark.parametrize("reverse", [1.0, -1.0])
def test_speed_of_a_propeller_line_dies_out_as_two_thirds_power(reverse: float) -> None:
    """Changes of speed decay with 2c₂ω/J_total at the propeller as the shaft stiffens: the error falls with 1/k."""
    speed = tn.rpm(1800)
    total = 6.0 * 3.5**2 + 35.0
    wrong = []
    for stiffness in (4e5, 4e6):
        found = tn.stability(propeller(stiffness, reverse=reverse), speed)
        assert found.set_aside == 1 and found.verdict.name == "STABLE"
        wrong.append(found.growth_rate / (-2 * 4.31 * speed / 3.5 / total) - 1)
    assert abs(wrong[0]) < 3e-3 and wrong[1] / wrong[0] == pytest.approx(0.1, rel=0.05)


def test_frequencies_and_damping_in_closed_form() -> None:
    """Two inertias: the pair is set aside exactly, the twist decays with c(1/J₁ + 1/J₂)/2, whatever the share."""
    for share in (0.3, 1.0, 7.0):
        line = tn.Driveline(
            [
                tn.Disk(inertia=1.0, drive_share=share),
                tn.Shaft(stiffness=100.0, damping=0.1),
                tn.Disk(inertia=2.0, load_torque=5.0),
            ]
        )
        found = tn.stability(line, 10.0)
        assert found.set_aside == 2 and found.growth_rate == pytest.approx(-0.1 * 1.5 / 2, rel=1e-10)
        assert found.response is not None and found.response.torque_mean == pytest.approx([-5.0])


def test_shares_divide_the_power() -> None:
    """Two drives on either side of a ratio: each shaft carries what lies behind it."""
    line = tn.Driveline(
        [
            tn.Disk(inertia=1.0, drive_share=1.0),
            tn.Shaft(stiffness=1e3, damping=1.0),
            tn.Disk(inertia=1.0),
            tn.Ratio(ratio=2.0),
            tn.Disk(inertia=1.0, drive_share=3.0),
            tn.Shaft(stiffness=1e3, damping=1.0),
            tn.Disk(inertia=2.0, load_torque=80.0),
        ]
    )
    response = tn.stability(line, 10.0).response
    assert response is not None and response.torque_mean == pytest.approx([-10.0, -80.0])


def bent_pair(beta: float, load: dict[str, float]) -> tn.Driveline:
    return tn.Driveline(
        [
            tn.Disk(inertia=0.4, drive_share=1.0),
            tn.HookeJoint(angle=beta),
            tn.Shaft(stiffness=6e3, damping=4.0),
            tn.Disk(inertia=0.9, **load),
        ]
    )


def return_map(beta: float, speed: float, load: dict[str, float]) -> tuple[np.ndarray, float]:
    """Multipliers of the return map from φ₁ = 0 to φ₁ = π and the drive torque that takes π/Ω for it.

    J₁φ̈₁ = D + η f, J₂φ̈₂ = −f − M(φ̇₂), f = k(φ₂ − ψ) + c(φ̇₂ − ηφ̇₁), tan ψ = tan φ₁/cos β from a fork in the plane.
    """
    cosine = np.cos(beta)
    constant, viscous, quadratic = (load.get(k, 0.0) for k in ("load_torque", "viscous_load", "quadratic_load"))

    def rates(_: float, y: np.ndarray, drive: float) -> list[float]:
        p1, p2, v1, v2 = y
        eta = cosine / (1 - np.sin(beta) ** 2 * np.cos(p1) ** 2)
        psi = p1 + np.arctan2((1 - cosine) * np.sin(p1) * np.cos(p1), cosine * np.cos(p1) ** 2 + np.sin(p1) ** 2)
        f = 6e3 * (p2 - psi) + 4.0 * (v2 - eta * v1)
        return [v1, v2, (drive + eta * f) / 0.4, (-f - constant - (viscous + quadratic * abs(v2)) * v2) / 0.9]

    def arrives(_: float, y: np.ndarray, drive: float) -> float:
        return float(y[0] - np.pi)

    arrives.terminal, arrives.direction = True, 1  # type: ignore[attr-defined]

    def turn(z: np.ndarray, drive: float) -> np.ndarray:
        run = solve_ivp(
            rates, (0, 4 * np.pi / speed), [0.0, *z], "DOP853", args=(drive,), events=arrives, rtol=1e-12, atol=1e-13
        )
        end = run.y_events[0][0]
        return np.array([end[1] - np.pi, end[2], end[3], run.t_events[0][0]])

    mean = constant + (viscous + quadratic * speed) * speed
    unknown = np.array([-mean / 6e3, speed, speed, mean])
    scale = np.array([1e-2, 0.01 * speed, 0.01 * speed, 1.0])
    for _ in range(12):

        def missed(z: np.ndarray) -> np.ndarray:
            return turn(z[:3], z[3]) - np.array([*z[:3], np.pi / speed])

        slope = np.column_stack(
            [(missed(unknown + 1e-4 * e) - missed(unknown - 1e-4 * e)) / 2e-4 for e in np.diag(scale)]
        )
        step = np.linalg.solve(slope, -missed(unknown)) * scale
        unknown = unknown + step
        if np.abs(step / scale).max() < 1e-8:
            break
    section = np.column_stack(
        [
            (turn(unknown[:3] + 1e-3 * e, unknown[3]) - turn(unknown[:3] - 1e-3 * e, unknown[3]))[:3] / 2e-3
            for e in np.diag(scale[:3])
        ]
    )
    return np.linalg.eigvals(section / scale[:3, None]), float(unknown[3] - mean)


@pytest.mark.parametrize("load", [{"load_torque": 30.0}, {"viscous_load": 0.4, "quadratic_load": 0.008}])
@pytest.mark.parametrize("beta", [0.15, 0.5])
def test_a_bent_free_line_about_its_own_motion(beta: float, load: dict[str, float]) -> None:
    """The multipliers beside the phase's 1 are those of the return map; the drive torque keeps the mean speed."""
    speed = 40.0
    line = bent_pair(beta, load)
    found = tn.stability(line, speed)
    truth, extra = return_map(beta, speed, load)
    nearest = int(np.argmin(np.abs(found.multipliers - 1)))
    assert abs(found.multipliers[nearest] - 1) < 1e-7
    assert set_distance(np.delete(found.multipliers, nearest), truth) < 2e-6
    assert found.extra_torque == pytest.approx(extra, rel=1e-5, abs=1e-7)
    assert found.verdict.name == "STABLE" and bool(found.speed_sentence) == ("load_torque" in load)
    motion = tn.periodic_response(line, speed)
    assert set_distance(motion.multipliers, found.multipliers) < 1e-9
    assert found.response.torque_amplitude == pytest.approx(motion.torque_amplitude, rel=1e-7)


def test_a_drive_beside_its_excitation_keeps_the_speed() -> None:
    """An excited line with joint angles has a periodic motion at the mean speed asked for."""
    line = bent_pair(0.3, {"quadratic_load": 0.02})
    line = line.replace("Disk 1", excitation=[{"order": 2, "amplitude": 40.0}])
    motion = tn.periodic_response(line, 40.0)
    assert motion.outcome.ok and motion.orbit.residual < 1e-9
    assert motion.orbit.state[-1] == pytest.approx(motion.orbit.state[0], abs=1e-9)


def test_amplitudes_of_a_bent_free_line_hold_what_excites_it_too() -> None:
    """Sweep and stability give one response: the own motion by itself, and what an excitation adds to it."""
    line = bent_pair(0.3, {"load_torque": 30.0})
    quiet = tn.periodic_response(line, 40.0, compare=False).torque_amplitude
    shaken = line.replace("Disk 1", excitation=[{"order": 3, "amplitude": 4.0}])
    true = tn.periodic_response(shaken, 40.0)
    for one, exact, near in ((line, quiet, 1e-7), (shaken, true.torque_amplitude, 5e-3)):
        swept, response = tn.speed_sweep(one, [40.0]), tn.stability(one, 40.0).response
        assert response is not None
        assert swept.torque_amplitude[0] == pytest.approx(exact, rel=near)
        assert response.torque_amplitude == pytest.approx(swept.torque_amplitude[0], rel=1e-9)
    assert true.torque_amplitude[0] > 1.05 * quiet[0]


def loaded(beta: float) -> tn.Driveline:
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=9e3, damping=3.0),
            tn.Disk(inertia=0.5, viscous_load=0.2),
            tn.HookeJoint(angle=beta),
            tn.Disk(inertia=0.1, quadratic_load=0.01),
            tn.Shaft(stiffness=7e3, damping=2.0, fork_offset=0.4),
            tn.Disk(inertia=0.3, viscous_load=0.3, quadratic_load=0.02),
            tn.HookeJoint(angle=0.8 * beta, plane=0.2),
            tn.Disk(inertia=0.2, quadratic_load=0.015),
            tn.Shaft(stiffness=5e3, damping=1.0),
            tn.Disk(inertia=0.4, viscous_load=0.5),
        ]
    )


def test_slopes_of_loads_against_the_true_motion() -> None:
    """A driven line with loads by speed in front of and behind joints: the linear multipliers tend to those of the
    periodic motion as the joints straighten, at least with the square of the angle."""
    wrong = []
    for beta in (0.2, 0.1, 0.05):
        line = loaded(beta)
        exact = tn.periodic_response(line, 60.0, compare=False)
        wrong.append(set_distance(tn.stability(line, 60.0).multipliers, exact.multipliers))
    assert wrong[0] < 5e-3 and wrong[0] / wrong[1] > 3.5 and wrong[1] / wrong[2] > 3.5


def test_dense_and_compiled_equations_have_the_same_loads() -> None:
    line = loaded(0.5)
    matrix, error, _ = chain_kernel(line, np.array([35.0, 60.0]))
    for z, bound, speed in zip(matrix, error, (35.0, 60.0), strict=True):
        assert set_distance(np.linalg.eigvals(z), tn.stability(line, speed).multipliers) < 1e-8 + 100 * bound


REFUSED = [
    (
        lambda: tn.stability(propeller(1e5, share=0.0), tn.rpm(1500)),
        r"the loads add up to .* N m at the input at 1500 rpm \(Disk 2 .*\) and nothing drives; give the driving "
        r'disk, "Disk 1" say, drive_share = 1$',
    ),
    (
        lambda: tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1.0), tn.Disk(inertia=1.0, drive_share=1.0)]),
        r"Disk 1.drive_share = 1: shares the drive of a line that a ConstantSpeed drives; leave out the ConstantSpeed",
    ),
    (
        lambda: tn.periodic_response(bent_pair(0.2, {"load_torque": 9.0}).replace("Disk 1", drive_share=None), 40.0),
        "the loads add up to 9 N m at the input at 381.97 rpm .Disk 2 9. and nothing drives",
    ),
    (lambda: tn.Disk(inertia=1.0, drive_share=-1.0), "Disk.drive_share = -1: must not be negative"),
]


@pytest.mark.parametrize(("call", "words"), REFUSED, ids=range(len(REFUSED)))
def test_what_is_left_open_is_refused(call, words: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(tn.InputError, match=words) as refusal:
        call()
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(("angle", "told"), [(1e-4, False), (0.3, True)])
def test_no_rounding_noise_is_told_as_a_torque(angle: float, told: bool) -> None:
    """What the drives give beyond the balance grows with the square of the angle: next to none is not told."""
    line = tn.Driveline([
        tn.Disk(inertia=1.3, drive_share=1.0), tn.HookeJoint(angle=angle), tn.Shaft(stiffness=9e3, damping=3.0),
        tn.Disk(inertia=0.7, load_torque=30.0, viscous_load=0.1),
    ])  # fmt: skip
    text = str(tn.stability(line, 60.0))
    assert "judged about the line's own periodic motion" in text
    assert ("beyond the balance" in text) is told
