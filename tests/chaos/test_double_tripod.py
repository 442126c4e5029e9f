"""S4: frequencies, coefficients, exponents by two ways, verdicts, what the paper's estimator does, bad input."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.papers.double_tripod.computed import exponent_from, floquet_exponents, opening_depth, sweep_of
from trunnion.papers.double_tripod.contraction import contraction, smallest_damping
from trunnion.papers.double_tripod.estimator import printed_estimator
from trunnion.papers.double_tripod.figures import beats, motion_of
from trunnion.papers.double_tripod.published import INPUT, OUTPUT, WORST_ANGLE, DoubleTripod, OuterElement
from trunnion.systems.reference import linear_oscillator

NINE = WORST_ANGLE


def test_frequencies() -> None:
    shaft = tn.catalogue("double-tripod")
    assert isinstance(shaft, DoubleTripod)
    assert shaft.element("input").natural_frequency(NINE) == pytest.approx(9633.7, abs=0.05)
    assert shaft.element("output").natural_frequency(NINE) == pytest.approx(8771.0, abs=0.05)
    assert shaft.element("input").natural_frequency(0.0) == pytest.approx(9636.8, abs=0.05)
    assert shaft.element("output").natural_frequency(0.0) == pytest.approx(8773.6, abs=0.05)
    assert shaft.midshaft_frequencies() == pytest.approx(1669.16 * np.arange(1, 6), abs=0.02)
    assert shaft.element("input").joint_amplitude(NINE) == pytest.approx(3.653e-5, abs=5e-9)


def test_steiner_terms_with_their_sine() -> None:
    mended = DoubleTripod(steiner="mended")
    assert mended.element("input").natural_frequency(NINE) == pytest.approx(6595, abs=0.6)
    assert mended.element("output").natural_frequency(NINE) == pytest.approx(5960, abs=0.6)


@pytest.mark.parametrize("element", [INPUT, OUTPUT], ids=["input", "output"])
@pytest.mark.parametrize("angle", [0.02, 0.1, NINE])
def test_g_is_stiffness_over_inertia(element: OuterElement, angle: float) -> None:
    """k(φ)/I(φ) = Ω² g(φ) with Ī at the angle and χ_n with χ_nB."""
    shaft = DoubleTripod(angle=angle, nonuniformity="derived")
    which = "output" if element.mill else "input"
    phi = np.linspace(0, np.pi, 50)
    c1, c2 = shaft.coefficients(which)
    c, chi = np.cos(2 * phi), shaft.chi(which)
    g = (1 + c1 * c) / ((1 + c2 * c) * (1 + chi * c))
    ratio = np.asarray(element.stiffness(angle, phi)) / np.asarray(element.inertia(angle, phi))
    assert ratio == pytest.approx(element.natural_frequency(angle) ** 2 * g, rel=1e-14)


def test_nonuniformities() -> None:
    assert INPUT.nonuniformity(NINE) == pytest.approx(3.86e-4, rel=0.003)
    assert OUTPUT.nonuniformity(NINE) == pytest.approx(4.23e-4, rel=0.003)
    assert DoubleTripod().depth("input") == pytest.approx(9.5e-4, rel=0.01)
    assert DoubleTripod(nonuniformity="derived").depth("input") == pytest.approx(1.4e-4, rel=0.02)


@pytest.mark.parametrize("which", ["input", "output"])
@pytest.mark.parametrize("phase", ["given", "own"])
def test_jacobian_is_the_slope_of_the_rate(which: str, phase: str) -> None:
    system = DoubleTripod(nonuniformity=0.3).system(which, phase=phase)
    x = np.array([0.4, 0.7, 900.0]) if phase == "given" else np.array([0.4, 900.0])
    steps = np.array([1e-6, 1e-6, 1e-2]) if phase == "given" else np.array([1e-6, 1e-2])
    slopes = np.stack(
        [(system.rate_at(1e-4, x + d) - system.rate_at(1e-4, x - d)) / (2 * d.max()) for d in np.diag(steps)], axis=1
    )
    found = system.jacobian(1e-4, x)
    assert found == pytest.approx(slopes, rel=1e-6, abs=1e-9 * np.abs(found).max())


@pytest.mark.parametrize("which", ["input", "output"])
def test_right_side_as_printed(which: str) -> None:
    """(29), (30) written down once more, term by term."""
    shaft = DoubleTripod(nonuniformity=0.1, damping_ratio=0.02, mean_inertia="straight")
    part, system = shaft.element(which), shaft.system(which)
    t, phi, theta, v = 3.3e-4, 0.2, 0.7, 150.0
    a = 7850 * part.L_A * part.axle(0.0) / float(part.inertia(0.0))
    ratio = (part.L_A / part.L_B) ** 2
    c1, c2 = 0.1 / (1 - a), ratio * (0.1 / a) / (1 + ratio * (1 / a - 1))
    omega = part.natural_frequency(NINE)
    g = (1 + c1 * np.cos(theta)) / ((1 + c2 * np.cos(theta)) * (1 + 0.1 * np.cos(theta)))
    if which == "input":
        swing = sum(np.cos(2**i * 600 * np.pi * t) / 2 ** (i + 1) for i in range(6))
        torque = 2550 * (1 + 0.05 * swing)
    else:
        torque = -2100 * (1 + 0.15 * sum(np.cos(2 ** (j - 1) * phi) / 2**j for j in range(1, 8)))
    joint = 1 - 3 * part.joint_amplitude(NINE) * np.sin(3 * phi)
    push = torque / float(part.inertia(0.0)) / (1 + 0.1 * np.cos(2 * phi)) * joint
    rate = push - 2 * 0.02 * omega * np.sqrt(g) * v - omega**2 * g * phi
    assert system.rate_at(t, [phi, theta, v]) == pytest.approx([v, 2 * omega, rate], rel=1e-13)


EXPONENTS = {
    ("input", "straight"): (0.0, -13.133, -17.695),
    ("output", "straight"): (0.0, -11.986, -16.081),
    ("input", "bent"): (0.0, -13.109, -17.719),
    ("output", "bent"): (0.0, -11.963, -16.104),
}


SLOW = pytest.mark.slow


@pytest.mark.parametrize(
    "case", [pytest.param(c, marks=SLOW if c != ("output", "straight") else ()) for c in EXPONENTS]
)
@pytest.mark.slow
def test_exponents_at_resonance(case: tuple[str, str]) -> None:
    which, inertia = case
    system = DoubleTripod(mean_inertia=inertia).system(which)
    found = tn.lyapunov_spectrum(system, starts=1)
    assert found.exponents == pytest.approx(EXPONENTS[case], abs=1.1e-3)
    assert found.exponents[1:] == pytest.approx(floquet_exponents(system), abs=1e-3)
    assert found.sum_error < 1e-8 * abs(found.sum)


def test_undamped_and_detuned() -> None:
    undamped = DoubleTripod(damping_ratio=0.0)
    assert floquet_exponents(undamped.system("input")) == pytest.approx([2.305, -2.305], abs=6e-4)
    assert floquet_exponents(undamped.system("output")) == pytest.approx([2.070, -2.070], abs=6e-4)
    system = DoubleTripod().system("input")
    detuned = system.but(excitation=1.0005 * system.parameters["excitation"])
    assert floquet_exponents(detuned) == pytest.approx([-15.414, -15.414], abs=6e-4)


@pytest.mark.parametrize("which", ["input", "output"])
def test_depth_that_opens_the_resonance(which: str) -> None:
    """ε = 4ζ to first order."""
    chi, depth = opening_depth(which)
    assert depth == pytest.approx(4 * 0.0016, rel=3e-3)
    for factor, grows in ((0.97, False), (1.03, True)):
        system = DoubleTripod(nonuniformity=chi * factor).system(which)
        assert (floquet_exponents(system)[0] > 0) == grows


@pytest.mark.parametrize(("which", "phase", "kind"), [
    ("input", "given", "quasi-periodic"), ("input", "own", "periodic"),
    ("output", "given", "periodic"), ("output", "own", "at rest"),
])  # fmt: skip
def test_verdicts(which: str, phase: str, kind: str) -> None:
    length = {"periods": 500} if which == "input" else {"duration": 1.5}
    system = DoubleTripod().system(which, phase=phase)
    transient = 250 if which == "input" else 3000
    found = tn.certify_chaos(system, **length, starts=1, transient=transient, sweep=False)  # type: ignore[arg-type]
    assert (found.verdict, found.kind) == ("regular", kind), str(found)
    assert not any(c.discriminates for c in found.criteria[1:]) or kind == "at rest"


@pytest.mark.slow
def test_no_exponent_of_the_range_is_positive() -> None:
    sweep = sweep_of(DoubleTripod(), "output", 12)
    assert sweep.exponents[:, 0] == pytest.approx(0.0, abs=1e-3)
    assert np.all(sweep.exponents[:, 1] < -11.9)


def test_the_printed_estimator_is_no_exponent() -> None:
    """Positive for a plain decaying oscillator, and twice as large with twice as many intervals; negative for (29)."""
    system = linear_oscillator(force=0.0)
    found = [printed_estimator(system, [1.0, 0.0], 40.0 / n, n) for n in (100, 200, 400)]
    assert np.all(found[0] > 0)
    assert found[1] == pytest.approx(2 * found[0], rel=0.2) and found[2] == pytest.approx(2 * found[1], rel=0.2)
    assert tn.lyapunov_spectrum(system, start=[1.0, 0.0], periods=400).largest < 0
    driveshaft = DoubleTripod().system("input")
    assert np.all(printed_estimator(driveshaft, [9e-5, 1.0, 0.1], 2e-4, 100, tolerance=1e-9) < 0)


BAD = {
    "angle": ({"angle": 2.0}, "90"),
    "damping": ({"damping_ratio": -1.0}, "damping_ratio"),
    "option": ({"nonuniformity": "drawn"}, "printed"),
    "number": ({"nonuniformity": 2.0}, "nonuniformity"),
    "inertia": ({"mean_inertia": "curved"}, "bent"),
    "motor": ({"motor_frequency": 0.0}, "motor_frequency"),
    "keyword": ({"colour": 1}, "colour"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input(case: str) -> None:
    changes, word = BAD[case]
    with pytest.raises(tn.InputError, match=word):
        tn.catalogue("double-tripod", **changes)


def test_bad_element_and_phase() -> None:
    with pytest.raises(tn.InputError, match="input"):
        DoubleTripod().system("middle")
    with pytest.raises(tn.InputError, match="own"):
        DoubleTripod().system("input", phase="none")


@pytest.mark.parametrize("which", ["input", "output"])
@pytest.mark.parametrize("phase", ["given", "own"])
def test_every_two_motions_approach(which: str, phase: str) -> None:
    """The bound in closed form against the Jacobian itself at random states: above it nowhere, near it somewhere."""
    own = phase == "own"
    system = DoubleTripod().system(which, phase=phase)
    bound = contraction(system, own=own)
    zeta, omega = system.parameters["damping_ratio"], system.parameters["natural_frequency"]
    to_w = np.array([[1.0, 0.0], [zeta, 1 / omega]])  # (φ, φ̇) to (φ, w)
    random = np.random.default_rng(5)
    worst = -np.inf
    for _ in range(1500):
        phi, w = random.uniform(-1, 1, 2) * (bound.ball / np.sqrt(2) if own else 50.0)
        v = omega * (w - zeta * phi)
        x = [phi, v] if own else [phi, random.uniform(0, 7), v]
        jacobian = np.asarray(system.jacobian(random.uniform(0, 0.01), np.array(x)))
        part = jacobian if own else jacobian[np.ix_([0, 2], [0, 2])]
        seen = to_w @ part @ np.linalg.inv(to_w)
        worst = max(worst, float(np.linalg.eigvalsh((seen + seen.T) / 2)[-1]))
    assert worst <= -bound.rate
    assert worst == pytest.approx(-bound.rate, rel=0.1)
    assert bound.rate > 9


def test_bound_lies_above_the_exponents() -> None:
    for which in ("input", "output"):
        system = DoubleTripod().system(which)
        assert floquet_exponents(system)[0] < -contraction(system, own=False).rate < 0
        assert 4 < smallest_damping(which) / 1.2e-4 < 5


@pytest.mark.slow
def test_motions_from_far_away_and_other_motor_speeds() -> None:
    """From 1 rad, 10⁴ times the settled rotation; and Ω_AEM = 9600π rad/s."""
    output = DoubleTripod().system("output", phase="own")
    assert exponent_from("output", "own", 6, 1.0) < -contraction(output, own=True).rate
    assert exponent_from("input", "given", 96, 0.0) < -contraction(DoubleTripod().system("input"), own=False).rate


@pytest.mark.parametrize(("which", "expected"), [("input", True), ("output", False)])
def test_beats(which: str, expected: bool) -> None:
    """(26) without torque in time decays; (25) beats with the motor's harmonics."""
    assert (beats(motion_of(which, 0.0129)) > 0) == expected
