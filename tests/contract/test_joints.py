"""Every kind of joint keeps what its law promises, and every analysis that counts joints takes its law.

A new kind of joint needs a row in ``joints.py`` and nothing else here. ``Wobble``, which the package does not have,
is made as ``CONTRIBUTING.md`` walks through it.
"""

from __future__ import annotations

import sys
import warnings
from math import gcd
from types import ModuleType
from typing import Any

import joints
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from walks import shown

import trunnion as tn
from trunnion.driveline.joints import Joint, Numbers
from trunnion.driveline.kinds import KINDS
from trunnion.laws.joint import through


def made_by_the_walk() -> Any:
    """``Wobble``, a joint that nobody builds, as ``CONTRIBUTING.md`` has it."""
    module = ModuleType("wobble")
    sys.modules["wobble"] = module  # where pydantic looks its annotations up
    exec(shown("src/trunnion/driveline/wobble.py"), vars(module))
    return module.Wobble


Wobble = made_by_the_walk()
JOINTS: dict[str, Joint] = {**joints.JOINTS, "Wobble": Wobble(angle=0.5)}
CHI = np.linspace(-4.0, 9.0, 131)


def numbers_of(joint: Joint, cases: int = 1) -> Numbers:
    """The numbers of one joint, as a line has them."""
    packed = tn.pack(tn.Driveline([tn.ConstantSpeed(), joint, tn.Disk(inertia=1.0)]))
    return lambda key: np.full((cases, 1), packed.values[packed.column(1, key)])


def line_with(joint: Joint, load: float = 20.0, damping: float = 2.0) -> tn.Driveline:
    """Two shafts, the joint between them."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=9e3, damping=damping, fork_offset=0.3, name="front"),
            tn.Disk(inertia=0.3, name="hub"),
            joint,
            tn.Shaft(stiffness=5e3, damping=damping, name="rear"),
            tn.Disk(inertia=0.6, load_torque=load, name="load"),
        ]
    )


def test_every_uneven_joint_has_a_row() -> None:
    nonuniform = {name for name, kind in KINDS.items() if issubclass(kind, Joint) and kind.law is not Joint.law}
    assert nonuniform == joints.JOINTS.keys()


@pytest.mark.parametrize("joint", JOINTS.values(), ids=JOINTS)
def test_the_derivatives_of_a_law_are_those_of_its_output(joint: Joint) -> None:
    law, h = joint.law(numbers_of(joint)), 1e-3
    passed = (*law.at(CHI), law.third(CHI))
    assert all(part.shape == (1, len(CHI)) for part in passed)
    for k, its_slope in enumerate(passed[1:]):
        at = [law.at(CHI + m * h)[k] for m in (-3, -2, -1, 1, 2, 3)]
        slope = (-at[0] + 9 * at[1] - 45 * at[2] + 45 * at[3] - 9 * at[4] + at[5]) / (60 * h)
        np.testing.assert_allclose(slope, its_slope, atol=1e-9)


@pytest.mark.parametrize("joint", JOINTS.values(), ids=JOINTS)
def test_the_jets_of_a_law_are_its_derivatives(joint: Joint) -> None:
    """ψ, ψ̇ = ηχ̇, ψ̈ = η′χ̇² + ηχ̈ of an input that speeds up."""
    law = joint.law(numbers_of(joint))
    passed = law.at(CHI)
    output = through(passed, [CHI, np.full_like(CHI, 1.3), np.full_like(CHI, -0.2)])
    np.testing.assert_allclose(output[0], passed.output, atol=1e-13)
    np.testing.assert_allclose(output[1], 1.3 * passed.ratio, atol=1e-13)
    np.testing.assert_allclose(2 * output[2], 1.3**2 * passed.slope - 0.4 * passed.ratio, atol=1e-12)


@pytest.mark.parametrize("joint", JOINTS.values(), ids=JOINTS)
def test_a_law_repeats_with_its_orders_and_turns_as_often_as_its_input(joint: Joint) -> None:
    law, period = joint.law(numbers_of(joint)), 2 * np.pi / gcd(*joint.orders)
    one, next_one = law.at(CHI), law.at(CHI + period)
    np.testing.assert_allclose(next_one.output - one.output, period, atol=1e-13)
    np.testing.assert_allclose(next_one.ratio, one.ratio, atol=1e-13)
    assert law.nonuniform and 0 < law.spread < 1


@pytest.mark.parametrize("joint", JOINTS.values(), ids=JOINTS)
def test_a_law_without_bend_passes_rotation_unchanged(joint: Joint) -> None:
    law = joint.law(numbers_of(joint))
    straight = law.straight()
    assert not straight.nonuniform and straight.turned == law.turned
    np.testing.assert_array_equal(straight.at(CHI).output, CHI[None])
    np.testing.assert_array_equal(straight.at(CHI).ratio, np.ones((1, len(CHI))))
    nearly = joint.law(lambda key: numbers_of(joint)(key) * (1e-5 if key == "angle" else 1.0))
    np.testing.assert_allclose(nearly.at(CHI).output, CHI[None], atol=1e-6)


@pytest.mark.parametrize("joint", JOINTS.values(), ids=JOINTS)
def test_kinetostatics_turn_by_the_law(joint: Joint) -> None:
    turn = tn.kinetostatics(line_with(joint), 1.0)
    ratio = joint.law(numbers_of(joint)).at(turn.input_angle + 0.3 - getattr(joint, "plane", 0.0)).ratio[0]
    np.testing.assert_allclose(turn.speed[turn.shafts.index("rear")], ratio, atol=1e-12)


STEPS = np.array([-3, -2, -1, 1, 2, 3])
OFFSETS = STEPS[:, None] + STEPS
WEIGHTS = np.array([-1, 9, -45, 45, -9, 1]) / 60


class Written:
    """The line of ``line_with`` in its own equations, with the law's output and nothing else of it."""

    def __init__(self, joint: Joint, speed: float, load: float, damping: float) -> None:
        law = joint.law(numbers_of(joint))
        self.plane, self.speed, self.load, self.c = getattr(joint, "plane", 0.0), speed, load, damping

        self.law = law

    def eta(self, x: float, h: float = 2e-3) -> tuple[float, float]:
        """dψ/dχ and d²ψ/dχ² by differences of sixth order of ψ alone."""
        at = self.law.at(x + h * OFFSETS.reshape(1, -1)).output.reshape(6, 6)
        return float(WEIGHTS @ self.law.at((x + h * STEPS)[None]).output[0]) / h, float(WEIGHTS @ at @ WEIGHTS) / h**2

    def linear(self, t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """C, K and the forcing about rigid rotation, each shaft twisted by the mean torque it carries."""
        k1, k2, m1, m2, c = 9e3, 5e3, 0.3, 0.6, self.c
        chi = self.speed * t + 0.3 - self.load / k1 - self.plane
        eta, eta1 = self.eta(chi)
        # dη/dt and d²ψ/dt² of an input that turns evenly
        rate, second = eta1 * self.speed, eta1 * self.speed**2
        damping = np.array([[(c + c * eta**2) / m1, -c * eta / m1], [-c * eta / m2, c / m2]])
        stiffness = np.array(
            [
                [(k1 + k2 * eta**2 + c * eta * rate + eta1 * self.load) / m1, -k2 * eta / m1],
                [-(k2 * eta + c * rate) / m2, k2 / m2],
            ]
        )
        forcing = np.array([(self.load - eta * self.load) / m1, -second])
        return damping, stiffness, forcing

    def run(self, period: float) -> tuple[np.ndarray, np.ndarray]:
        """Monodromy matrix of (δ, δ̇), and where rest ends under the forcing."""

        def rate(t: float, y: np.ndarray) -> np.ndarray:
            c, k, f = self.linear(t)
            x = y.reshape(4, 5)
            out = np.concatenate([x[2:], -k @ x[:2] - c @ x[2:]])
            out[2:, 4] += f
            return out.ravel()

        start = np.concatenate([np.eye(4), np.zeros((4, 1))], axis=1)
        end = solve_ivp(rate, (0, period), start.ravel(), method="DOP853", rtol=1e-11, atol=1e-13).y[:, -1]
        return end.reshape(4, 5)[:, :4], end.reshape(4, 5)[:, 4]


@pytest.mark.parametrize("name", JOINTS)
def test_stability_charts_and_forced_response_are_those_of_written_equations(name: str) -> None:
    """Multipliers by stability(), by the kernel of charts and by scipy; the steady response from the same scipy run."""
    joint, speed, load = JOINTS[name], 61.0, 20.0
    period = 2 * np.pi / gcd(*joint.orders) / speed
    written = Written(joint, speed, load, 2.0)
    matrix, particular = written.run(period)
    expected = np.sort(np.abs(np.linalg.eigvals(matrix)))
    line = line_with(joint, load)
    found = tn.stability(line, speed)
    assert found.period == pytest.approx(period * speed, rel=1e-12)
    np.testing.assert_allclose(np.sort(np.abs(found.multipliers)), expected, atol=1e-8)
    assert found.liouville_defect < 1e-9
    chart = tn.stability_chart(line, ("speed", speed, speed, 1), ("hub.inertia", 0.3, 0.3, 1), tolerance=1e-10)
    assert chart.spectral_radius[0, 0] == pytest.approx(expected[-1], abs=1e-8)
    # The response by orders, its waveform at t = 0.
    steady = np.linalg.solve(np.eye(4) - matrix, particular)
    response = found.response
    assert response is not None
    twist = -load / 9e3 + steady[0]
    assert response.twist[0, 0] == pytest.approx(twist, abs=1e-9)


@pytest.mark.parametrize("name", JOINTS)
def test_charts_over_speed_and_angle_hold_their_word(name: str) -> None:
    """The chart checks itself against direct integration; single points agree with stability()."""
    line = line_with(JOINTS[name], load=0.0, damping=0.4)
    at = next(n for n, e in zip(line.names, line.elements, strict=True) if e is line.elements[3])
    chart = tn.stability_chart(line, ("speed", 40.0, 160.0, 12), (f"{at}.angle", 0.05, 0.9, 6))
    for i, j in ((0, 1), (3, 7), (5, 11)):
        bent = line.replace(at, angle=float(chart.y[i]))
        single = tn.stability(bent, float(chart.x[j]))
        assert chart.spectral_radius[i, j] == pytest.approx(single.spectral_radius, abs=3e-8)


def test_a_made_up_joint_reaches_every_analysis() -> None:
    """Simulation, periodic motion, order response, resonances: the joint of the walk in CONTRIBUTING is in all."""
    line = line_with(JOINTS["Wobble"], load=0.0, damping=8.0)
    speed = 47.0
    orders = tn.order_response(line, [speed])
    assert {2.0, 5.0} <= set(orders.order.tolist())
    steady = tn.periodic_response(line, speed)
    assert steady.outcome.ok
    small = line.replace("Wobble 1", angle=0.02)
    linear, full = tn.order_response(small, [speed]), tn.periodic_response(small, speed)
    assert np.ptp(full.torque[:, 0]) / 2 == pytest.approx(float(linear.vibratory_torque[0, 0]), rel=1e-3)
    straight = line.replace("Wobble 1", angle=0.0)
    assert tn.order_response(straight, [speed]).vibratory_torque.max() == 0
    rates = {float(r.rate) for r in tn.resonance_speeds(line)}
    assert rates == {0.5}  # orders 2 and 5 have one cycle a turn in common
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert "Wobble 1.angle" in tn.pack(line).labels
