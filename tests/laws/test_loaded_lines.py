"""What a transmitted torque does: the linearisation about the statically twisted line against true orbits.

A transmitted torque enters twice: the term η′T̄ and the static twist that shifts the phases of later joints.
Both are of order β²T. Inside a combination tongue multipliers move in first order of the excitation and the
linearisation about the static state tends to the truth as β falls; elsewhere they move with β⁴T, to which
the forced motion contributes too, and the static state is right in order of magnitude only.
"""

from __future__ import annotations

import numpy as np
import pytest
from oracles.chains import Chain, twist_monodromy
from oracles.comparisons import set_distance
from oracles.nonlinear import NonlinearChain
from oracles.package_kernels import chain_radius

import trunnion as tn


def chain(load: float, beta: float, speed: float, damping: float = 1.0) -> Chain:
    """Three shafts, two joints in no particular phase, load on the last disk."""
    return Chain(
        speed=speed,
        stiffness=[1.0, 1.3, 0.8],
        damping=[0.006 * damping, 0.005 * damping, 0.004 * damping],
        inertia=[1.0, 0.7, 1.5],
        angle=[beta, 0.8 * beta],
        fork_offset=[0.3, 0.9, 0.0],
        plane=[0.0, 0.2],
        load=[0.0, 0.0, load],
    )


def radius(matrix: np.ndarray) -> float:
    """Largest multiplier modulus."""
    return float(np.abs(np.linalg.eigvals(matrix)).max())


def true_change(load: float, beta: float, speed: float, damping: float = 1.0) -> float:
    """How a load moves the spectral radius of the true periodic orbit."""
    start, bare = NonlinearChain(chain(0.0, beta, speed, damping)).periodic_orbit()
    _, loaded = NonlinearChain(chain(load, beta, speed, damping)).periodic_orbit(start)
    return radius(loaded) - radius(bare)


def linear_change(load: float, beta: float, speed: float, damping: float = 1.0) -> float:
    """The same by the package, about the statically twisted line."""
    bare = tn.stability(chain(0.0, beta, speed, damping).line(), speed).spectral_radius
    return tn.stability(chain(load, beta, speed, damping).line(), speed).spectral_radius - bare


FREQUENCIES = tn.natural_frequencies(chain(0.0, 0.1, 1.0).line()).undamped_frequency


@pytest.mark.parametrize("modes", [(0, 1), pytest.param((1, 2), marks=pytest.mark.slow)])
@pytest.mark.slow
def test_agreement_inside_a_combination_tongue(modes: tuple[int, int]) -> None:
    """Relative error of the load's effect: per cent at β = 0.4, below 2e-4 at β = 0.2."""
    speed = float(FREQUENCIES[list(modes)].sum() / 2)
    wrong = []
    for beta in (0.4, 0.2):
        truth = true_change(0.05, beta, speed)
        assert abs(truth) > 1e-4
        wrong.append(abs(linear_change(0.05, beta, speed) / truth - 1))
    assert wrong[0] < 0.03 and wrong[1] < 2e-4


def test_either_effect_alone_is_wrong() -> None:
    """η′T̄ alone overshoots by 40 %, the phase shift alone has the wrong sign; their sum is right."""
    speed, beta, load = float(FREQUENCIES[:2].sum() / 2), 0.2, 0.05
    truth = true_change(load, beta, speed)
    bare = radius(twist_monodromy(chain(0.0, beta, speed)))
    term_only = radius(twist_monodromy(chain(load, beta, speed), phase_shift=False)) - bare
    shift_only = radius(twist_monodromy(chain(load, beta, speed), torque_term=False)) - bare
    assert term_only / truth == pytest.approx(1.40, abs=0.02)
    assert shift_only / truth == pytest.approx(-0.36, abs=0.02)
    assert linear_change(load, beta, speed) / truth == pytest.approx(1, abs=2e-4)


@pytest.mark.parametrize("speed", [pytest.param(0.45, marks=pytest.mark.slow), 0.9])
def test_order_of_magnitude_between_resonances(speed: float) -> None:
    """Away from tongues the two effects are of one order and partly cancel; the static state gives the sign
    and the size of the true change, never better than some ten per cent however small the angle."""
    load, damping = 0.2, 10.0
    for beta in (0.4, 0.2):
        truth = true_change(load, beta, speed, damping)
        found = linear_change(load, beta, speed, damping)
        bare = radius(twist_monodromy(chain(0.0, beta, speed, damping)))
        term_only = radius(twist_monodromy(chain(load, beta, speed, damping), phase_shift=False)) - bare
        assert 0.5 < found / truth < 2
        assert abs(found - truth) < abs(term_only - truth)
        assert abs(found / truth - 1) > 0.1


def test_the_choice_is_the_users() -> None:
    """``statically_twisted=False`` is the unloaded line; a constant load then changes nothing."""
    loaded, bare = chain(0.1, 0.4, 0.9).line(), chain(0.0, 0.4, 0.9).line()
    untwisted = tn.stability(loaded, 0.9, statically_twisted=False)
    twisted, unloaded = tn.stability(loaded, 0.9), tn.stability(bare, 0.9)
    assert abs(twisted.spectral_radius - unloaded.spectral_radius) > 1e-6
    assert set_distance(untwisted.multipliers, unloaded.multipliers) < 1e-12


def behind_a_joint(**loads: float) -> tn.Driveline:
    """A loaded disk rigidly behind a joint of its own group, on a shaft that turns backwards."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=900.0, damping=0.4),
            tn.Disk(inertia=0.5),
            tn.Ratio(ratio=-1.5),
            tn.HookeJoint(angle=0.6),
            tn.Disk(inertia=0.3, name="pump", **loads),
            tn.HookeJoint(angle=0.4, plane=0.7),
            tn.Shaft(stiffness=700.0, damping=0.3, fork_offset=0.5),
            tn.Disk(inertia=0.4),
        ]
    )


def test_untwisted_no_torque_acts_behind_a_joint_either() -> None:
    """Not in ``stability``, nor in charts: what a load adds by its slope along the angle goes with its torque."""
    found = {}
    for load in (0.0, 40.0):
        line = behind_a_joint(load_torque=load)
        chart = tn.stability_chart(
            line, ("speed", 30, 31, 2), ("HookeJoint 1.angle", 0.6, 0.7, 2), statically_twisted=False
        )
        dense = tn.stability(line, 30.0, statically_twisted=False)
        assert chart.spectral_radius[0, 0] == pytest.approx(dense.spectral_radius, abs=1e-9)
        found[load] = dense.multipliers, chart.spectral_radius
    assert set_distance(found[0.0][0], found[40.0][0]) < 1e-12
    assert np.array_equal(found[0.0][1], found[40.0][1])
    twisted = tn.stability(behind_a_joint(load_torque=40.0), 30.0)
    assert set_distance(twisted.multipliers, found[0.0][0]) > 1e-4


def test_untwisted_a_load_by_speed_counts_about_its_mean() -> None:
    """A viscous load c v is then c (v − v̄): the line twisted less what its mean as a constant load does untwisted."""
    line = behind_a_joint(viscous_load=1.5)
    mean = 1.5 * 30.0 / 1.5
    balanced = behind_a_joint(viscous_load=1.5, load_torque=-mean)  # nothing is carried on average, so nothing twists
    untwisted = tn.stability(line, 30.0, statically_twisted=False)
    assert set_distance(untwisted.multipliers, tn.stability(balanced, 30.0).multipliers) < 1e-12
    chart = tn.stability_chart(
        line, ("speed", 30, 31, 2), ("HookeJoint 1.angle", 0.6, 0.7, 2), statically_twisted=False
    )
    assert chart.spectral_radius[0, 0] == pytest.approx(untwisted.spectral_radius, abs=1e-9)


@pytest.mark.parametrize("load", [-0.1, 0.2])
def test_package_and_oracle_agree_on_the_static_state(load: float) -> None:
    """Same base, same equations: dense, compiled kernel and twist coordinates to rounding."""
    for speed in (0.45, 0.782, 1.9):
        case = chain(load, 0.5, speed)
        exact = np.linalg.eigvals(twist_monodromy(case))
        assert set_distance(tn.stability(case.line(), speed).multipliers, exact) < 1e-10
        found, error = chain_radius(case.line(), speed)
        assert abs(found[0] - np.abs(exact).max()) < error[0] + 1e-12


def test_static_torque_is_positive_with_the_twist() -> None:
    """A load M resists, so every shaft carries −M and winds back by M/k."""
    result = tn.stability(chain(0.1, 0.3, 0.9).line(), 0.9)
    assert result.response is not None
    assert result.response.torque_mean == pytest.approx([-0.1, -0.1, -0.1], rel=0.06)


def test_unloaded_true_orbit_differs_in_higher_order() -> None:
    """Without load the static state is zero twist; the true orbit's ρ departs from it with β⁴."""
    departures = []
    for beta in (0.4, 0.2, 0.1):
        case = chain(0.0, beta, 0.9, damping=10.0)
        _, matrix = NonlinearChain(case).periodic_orbit()
        departures.append(radius(matrix) - tn.stability(case.line(), 0.9).spectral_radius)
    assert departures[1] / departures[2] == pytest.approx(16, rel=0.05)
    assert departures[0] / departures[1] == pytest.approx(16, rel=0.5)
