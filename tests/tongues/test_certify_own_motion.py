"""Certificates about the periodic motion that a free–free line with joint angles makes."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from oracles.attacked_own_boxes import attack_own, counted, value
from oracles.bent_pair import PERIOD, BentPair
from oracles.swung_trees import SwungTree

import trunnion as tn
from trunnion.floquet.certificate import own_judge, proof
from trunnion.floquet.certificate.box_coefficients import NumberRange, box_coefficients
from trunnion.floquet.certificate.box_space import BoxSpace
from trunnion.floquet.certificate.own_equations import MotionEquations, MotionWaves
from trunnion.floquet.certificate.own_judge import OwnMotionLine, judged_motion
from trunnion.floquet.certificate.own_stages import OwnStage
from trunnion.floquet.certificate.periodic_lyapunov import lyapunov_series, modal_box
from trunnion.floquet.certificate.waves import Terms, Wave, terms_of
from trunnion.floquet.tolerance.spread import Tolerances, read_tolerances
from trunnion.results.verdict import Verdict

TUG = tn.load(Path(__file__).parents[2] / "examples" / "harbour-tug.toml")
PAIR = BentPair(95.0)
SHARES = {"shaft.stiffness": 0.001, "load.inertia": 0.001, "joint.angle": 0.002, "load.load_torque": 0.005}
NAMES = {"stiffness": "stiffness", "inertia": "inertia", "angle": "angle", "load_torque": "load_torque"}


def ranges_of(own: OwnMotionLine, shares: Tolerances) -> list[NumberRange]:
    return [NumberRange(s.label, s.columns, s.low, s.high) for s in read_tolerances(own.assembly, shares)]


def box(
    shares: Tolerances = SHARES, width: float = 2e-4, pair: BentPair = PAIR
) -> tuple[MotionEquations, MotionWaves, list[NumberRange], tuple[float, float]]:
    """Equations of a box, nearly its motions, its tolerances and speeds."""
    own = OwnMotionLine(pair.line)
    ranges = ranges_of(own, shares) if shares else []
    speeds = pair.middle * (1 - width), pair.middle * (1 + width)
    found = own.begun(speeds, ranges)
    assert found is not None
    return *found, ranges, speeds


def corner(ranges: list[NumberRange], signs: np.ndarray) -> BentPair:
    numbers = {
        NAMES[one.label.split(".")[1]]: one.high if s > 0 else one.low for one, s in zip(ranges, signs, strict=True)
    }
    return PAIR.at(**numbers)


# What encloses contains


def test_rates_and_slopes_contain_the_equations() -> None:
    """At corners of the box, anywhere in a tube around the motion."""
    own, motion, ranges, _ = box()
    rng, radii = np.random.default_rng(1), np.array([1e-4, 0.02, 0.03])
    near = motion.widened(radii)
    found = own.rates(near)
    for _ in range(12):
        signs, drive, phi = rng.choice([-1.0, 1.0], len(ranges)), rng.uniform(-1, 1), rng.uniform(0, PERIOD)
        p = np.concatenate([[drive], signs])
        pair = corner(ranges, signs).at(extra=value(motion.drive, phi, p))
        x = np.array([value(one, phi, p) for one in motion.states]) + rng.uniform(-1, 1, 3) * radii
        x += counted(own, pair, p)
        rates, slopes = pair.rates(phi, x), pair.slopes(phi, x)
        for i in range(3):
            assert abs(rates[i] - value(found.rates[i], phi, p)) <= found.rates[i].rest * (1 + 1e-9) + 1e-11
            for j in range(3):
                known = found.slopes.get((i, j))
                assert abs(slopes[i, j] - (value(known, phi, p) if known else 0.0)) <= (known.rest if known else 0)


@pytest.mark.parametrize(("shares", "width"), [({}, 2e-4), (SHARES, 2e-4), ({}, 0.02)])
def test_the_tube_holds_the_motion_which_decays_as_proved(shares: Tolerances, width: float) -> None:
    """At corners, under torques from one end to the other; the mean speed passes through the box."""
    line = OwnMotionLine(PAIR.line)
    speeds = PAIR.middle * (1 - width), PAIR.middle * (1 + width)
    ranges = ranges_of(line, shares) if shares else []
    begins = line.begun(speeds, ranges, 3e-6 if shares else 0.0)  # what tolerances move of the speed
    assert begins is not None
    found = judged_motion(*begins, speeds)
    assert found is not None and found.verdict.proved and found.tube is not None
    own, motion = begins[0], found.tube
    rng, nearest, slowness = np.random.default_rng(2), np.inf, []
    for drive in (-1.0, -0.35, 0.6, 1.0):
        signs = rng.choice([-1.0, 1.0], len(ranges))
        p = np.concatenate([[drive], signs])
        pair = corner(ranges, signs).at(extra=value(motion.drive, 0.0, p))
        beside = counted(own, pair, p)
        path, multipliers = pair.periodic(np.array([value(one, 0.0, p) for one in motion.states]) + beside)
        path = path - beside
        for k, phi in enumerate(np.linspace(0, PERIOD, 33)):
            for state, one in zip(path[k], found.tube.states, strict=True):
                assert abs(state - value(one, phi, p)) <= one.rest + 1e-9 * abs(state)
        rate = -np.log(np.abs(multipliers).max()) * speeds[0] / PERIOD
        assert rate >= found.verdict.decay * (1 - 1e-6)
        nearest = min(nearest, rate / found.verdict.decay)
        slowness.append(np.mean(1 / path[:-1, 1]))
    assert nearest < 1.2
    assert 1 / slowness[0] < speeds[0] and 1 / slowness[-1] > speeds[1]


def some_waves(terms: Terms, rng: np.random.Generator, size: float) -> list[Wave]:
    """Two real ones of some harmonics in every row, about 2 and 0.3, each row smaller by ``size`` for each degree."""
    found = []
    for mean in (2.0, 0.3):
        parts = np.zeros((len(terms), 25), dtype=complex)
        for row, one in zip(parts, terms.exponents, strict=True):
            some = rng.normal(size=3) * size ** sum(one)
            row[10:15] = [some[2], some[0] * 1j, some[1], some[0] * -1j, some[2]]
        parts[0, 12] += mean * 5
        found.append(Wave(parts / 5, 0.0, terms))
    return found


@pytest.mark.parametrize("parameters", [1, 2, 4])
@pytest.mark.parametrize("degrees", [(1, 0), (1, 3), (2, 0), (2, 3), (3, 3), (4, 0)])
def test_products_of_parameters_are_followed(parameters: int, degrees: tuple[int, int]) -> None:
    """Products, inverses, exponentials and cuts at parameters and angles anywhere; the higher the degree the less is
    left out, by an order each."""
    rng, terms = np.random.default_rng(7), terms_of(parameters, *degrees)
    f, g = some_waves(terms, rng, 0.03)
    lower = terms_of(parameters, 1, degrees[1])
    made = {
        "product": f * g, "inverse": f.inverse(), "exponential": (f * g).exp(), "cut": f.cut(lower),
        "quotient": (f * g + 1.0 - g) * f.inverse(),
    }  # fmt: skip
    nearest = dict.fromkeys(made, 0.0)
    for _ in range(400):
        phi, p = rng.uniform(0, 6), rng.choice([-1, 1, *rng.uniform(-1, 1, 2)], parameters)
        a, b = value(f, phi, p), value(g, phi, p)
        expected = {"product": a * b, "inverse": 1 / a, "exponential": np.exp(a * b), "cut": a,
                    "quotient": (a * b + 1 - b) / a}  # fmt: skip
        for name, true in expected.items():
            off = abs(value(made[name], phi, p) - true)
            assert off <= made[name].rest * (1 + 1e-9) + 1e-14
            nearest[name] = max(nearest[name], off / max(made[name].rest, 1e-13))
    assert nearest["product"] > 0.01 and nearest["exponential"] > 0.01
    below = {name: one.rest for name, one in made.items()}
    smaller = [Wave(one.parts * (0.1 ** np.array(terms.exponents).sum(axis=1))[:, None], 0.0, terms) for one in (f, g)]
    order = degrees[0] + 1 if parameters > 1 else max(degrees) + 1
    tight = {"product": smaller[0] * smaller[1], "inverse": smaller[0].inverse()}
    for name, one in tight.items():
        assert one.rest < below[name] * 0.1 ** (order - 0.5) + 1e-10  # harmonics beyond the last


def test_a_product_of_chebyshev_polynomials_is_exact() -> None:
    """T₂(p₁)T₁(p₂) · T₁(p₁)T₁(p₂), where all of it is kept."""
    terms = terms_of(2, 5)
    one, two = (np.zeros((len(terms), 3), dtype=complex) for _ in range(2))
    one[terms.row[2, 1], 1], two[terms.row[1, 1], 1] = 3.0, 1.0
    made = Wave(one, 0.0, terms) * Wave(two, 0.0, terms)
    expected = {(3, 2): 0.75, (1, 2): 0.75, (3, 0): 0.75, (1, 0): 0.75}
    assert {terms.exponents[k]: made.parts[k, 1] for k in np.flatnonzero(made.parts[:, 1])} == expected
    assert made.rest < 1e-12


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_the_angle_of_a_joint_that_scatters_is_enclosed(degree: int) -> None:
    """tan²(β/2) at angles from one end to the other, also through zero."""
    own = OwnMotionLine(PAIR.line)
    for ends in ((0.2, 0.3), (-0.05, 0.1), (0.5, 0.9)):
        spread = ranges_of(own, {"joint.angle": ("range", *ends)})
        one = replace(spread[0], columns=own.assembly.packed.resolve(spread[0].label))
        terms = terms_of(2, degree)
        (wave,) = box_coefficients(own.assembly, (95.0, 95.0), [one], 2, terms).tangents.values()
        off = [
            abs(value(wave, 0.0, np.array([0.3, p])) - np.tan((sum(ends) + p * (ends[1] - ends[0])) / 4) ** 2)
            for p in np.linspace(-1, 1, 41)
        ]
        assert 0.1 * wave.rest < max(off) <= wave.rest
        assert wave.rest < 0.3 * ((ends[1] - ends[0]) / 2) ** min(degree + 1, 3) * (1 if degree > 1 else 2)


@pytest.mark.parametrize(("shares", "width"), [({}, 0.02), (SHARES, 2e-3)])
def test_the_bound_holds_of_all_angles_and_parameters(shares: Tolerances, width: float) -> None:
    """x*Nx ≤ |x|ᵀC|x| in modal coordinates, N = P′ + A*P + PA by the series at single angles and parameters."""
    own, motion, ranges, _ = box(shares, width)
    matrix = own_judge._matrix(own.cut(terms_of(1 + len(ranges), 1, 3)), motion)
    modal = modal_box(matrix)
    assert modal is not None
    found = lyapunov_series(matrix, modal)
    bound = proof._Bound.of(matrix, modal, found)
    rng, nearest = np.random.default_rng(5), 0.0
    orders = [np.arange(-(len(one) // 2), len(one) // 2 + 1) for one in (matrix.parts[0], found.parts[0])]
    for _ in range(400):
        phi, p = rng.uniform(0, PERIOD), rng.choice([-1.0, 1.0, *rng.uniform(-1, 1, 2)], 1 + len(ranges))
        rows = np.concatenate([[1.0], p, np.cos(np.arange(2, 2 + matrix.powers) * np.arccos(p[0]))])
        a, h = (np.exp(1j * matrix.rate * phi * one) for one in orders)
        slope = modal.to_modes @ np.einsum("v,m,vmij->ij", rows, a, matrix.parts) @ modal.modes
        energy = np.einsum("v,m,vmij->ij", rows, h, found.parts)
        turned = np.einsum("v,m,vmij->ij", rows, 1j * matrix.rate * orders[1] * h, found.parts)
        n = turned + energy @ slope + slope.conj().T @ energy.conj().T
        for x in [*np.eye(len(n)), *(rng.normal(size=(4, len(n))) + 1j * rng.normal(size=(4, len(n))))]:
            true, most = float((x.conj() @ n @ x).real), float(np.abs(x) @ bound.whole @ np.abs(x))
            assert true <= most + 1e-12 * abs(true)
            nearest = max(nearest, most / true if true < 0 else 0.0)
    assert nearest > 0.5


@pytest.mark.parametrize(
    ("number", "widest"),
    [pytest.param(6, -2.5, id="6"), pytest.param(20, -2.5, id="20"), pytest.param(200_009, -1.2, id="wide tolerances")],
)
def test_what_is_proved_near_the_boundary_holds_at_corners_and_inside(number: int, widest: float) -> None:
    assert 2 <= attack_own(np.random.default_rng(300_000 + number), 6, 4, str(number), widest) < 6


# What is not to be proved is not


def test_a_tube_that_is_too_small_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    own, motion, _, speeds = box()
    monkeypatch.setattr(own_judge, "WIDER", 0.9)
    found = judged_motion(own, motion, speeds)
    assert found is not None and not found.verdict.proved and found.tube is None


@pytest.mark.parametrize("off", [1e-9, 1e-7, 1e-5, 1e-4])
def test_a_tube_about_a_wrong_motion_holds_the_right_one_or_is_refused(off: float) -> None:
    """The twist is off by waves of the joint's order."""
    own, motion, _, speeds = box({}, 1e-3)
    parts = motion.twist[0].parts.copy()
    parts[0, [own.last - 1, own.last + 1]] += off / 2
    wrong = replace(motion, twist=(replace(motion.twist[0], parts=parts),))
    found = judged_motion(own, wrong, speeds)
    assert found is not None and found.verdict.proved == (off < 1e-6)
    if found.tube is not None:
        assert found.tube.twist[0].rest > off


def test_an_unstable_motion_is_never_proved_and_is_the_counterexample() -> None:
    """Where the joint's order meets the mode, by equations written out."""
    pair = BentPair(137.0, angle=0.6, damping=0.4, load_torque=5.0, viscous=0.02, quadratic=0.0)
    _, motion, _, speeds = box({}, 1e-7, pair)
    start = np.array([value(one, 0.0, np.zeros(1)) for one in motion.states])
    _, multipliers = pair.at(extra=value(motion.drive, 0.0, np.zeros(1))).periodic(start)
    assert np.abs(multipliers).max() > 1.001
    for width in (1e-9, 1e-5):
        ends = pair.middle * (1 - width), pair.middle * (1 + width)
        assert not OwnMotionLine(pair.line).judged(ends, []).proved
    found = tn.certify_stability(pair.line, {}, speeds)
    assert found.verdict == "counterexample" and found.counterexample is not None
    assert tn.stability(pair.line, found.counterexample["speed"]).verdict is Verdict.UNSTABLE
    assert str(found).endswith("about the line's own periodic motion")


# Rounding


def exact(wave: Wave) -> list[list[tuple[Fraction, Fraction]]]:
    return [[(Fraction(one.real), Fraction(one.imag)) for one in row] for row in wave.parts.tolist()]


def test_what_rounding_makes_of_sums_and_products_lies_within_the_rest() -> None:
    """In exact fractions: harmonics so few that nothing else is left out."""
    rng = np.random.default_rng(3)
    for _ in range(10):
        parts = rng.normal(size=(2, 1, 9)) + 1j * rng.normal(size=(2, 1, 9))
        parts[:, :, [0, 1, 7, 8]] = 0
        a, b = Wave(parts[0], 0.0), Wave(parts[1], 0.0)
        (x,), (y,) = exact(a), exact(b)
        (plus,), (times,) = exact(a + b), exact(a * b)
        off = [(u[0] + v[0] - s[0], u[1] + v[1] - s[1]) for u, v, s in zip(x, y, plus, strict=True)]
        assert sum(abs(re) + abs(im) for re, im in off) <= Fraction((a + b).rest)
        lost = Fraction(0)
        for m in range(9):
            pairs = [(x[k], y[m + 4 - k]) for k in range(9) if 0 <= m + 4 - k < 9]
            re = sum((u[0] * v[0] - u[1] * v[1] for u, v in pairs), Fraction(0)) - times[m][0]
            im = sum((u[0] * v[1] + u[1] * v[0] for u, v in pairs), Fraction(0)) - times[m][1]
            lost += abs(re) + abs(im)
        assert 0 < lost <= Fraction((a * b).rest)


def test_boxes_beside_each_other_leave_no_gap() -> None:
    own = OwnMotionLine(PAIR.line)
    space = BoxSpace(own.assembly, read_tolerances(own.assembly, SHARES), (50.0, 200.0))
    rng = np.random.default_rng(4)
    for _ in range(50):
        low, middle, high = np.sort(rng.uniform(0, 1, (3, space.size)), axis=0)
        left, right = np.array([low, middle]), np.array([middle, high])
        assert space.span(left)[1] > space.span(right)[0]
        for one, two in zip(space.ranges(left), space.ranges(right), strict=True):
            assert one.high > two.low


# Springs with stages


def with_stages(knot: float) -> tuple[BentPair, tn.Driveline]:
    """The pair, and a line that is so stiff beyond ``knot`` [rad] alone, where its load of 134 N m stands."""
    pair = BentPair(95.0, angle=0.05)
    spring = tn.PiecewiseShaft.symmetric([(1e3, knot), (9e3, None)], damping=pair.damping, name="shaft")
    return pair, tn.Driveline([spring if name == "shaft" else one for name, one in pair.line.parts])


def test_a_spring_that_stays_in_its_stage_moves_as_one_that_has_no_other() -> None:
    pair, line = with_stages(0.004)
    speeds = pair.middle * (1 - 1e-4), pair.middle * (1 + 1e-4)
    found, alike = (OwnMotionLine(one).enclosed(speeds, []) for one in (line, pair.line))
    assert found is not None and alike is not None and found.verdict.proved and found.tube is not None
    assert found.verdict.decay == pytest.approx(alike.verdict.decay, rel=1e-6)
    path = held(pair, line, speeds, {})[0]
    # The mean twist is beyond the knot by (134.1 − 4)/9000, and the swing is less.
    twist = -(0.004 + (pair.mean - 4.0) / 9e3) + path[:, 0]
    assert twist.max() < -0.004 - 0.01


def held(pair: BentPair, line: tn.Driveline, speeds: tuple[float, float], shares: Tolerances) -> list[np.ndarray]:
    """States of the motions of pairs like ``line`` in the middle and at corners of a box, all in the tube, the twist
    from that of their own loads; none decays slower than proved, nor leaves the stage beyond 4 N m."""
    own, rng, paths = OwnMotionLine(line), np.random.default_rng(3), []
    ranges = ranges_of(own, shares) if shares else []
    begins = own.begun(speeds, ranges)
    assert begins is not None
    found = judged_motion(*begins, speeds)
    assert found is not None and found.tube is not None
    tube = found.tube
    for k in range(9 if shares else 1):
        p = np.sign(rng.uniform(-1, 1, 1 + len(ranges))) * (k > 0)
        other = pair.at(extra=value(tube.drive, 0.0, p))
        for one in ranges:
            other = other.at(load_torque=(one.low + one.high) / 2 + float(p[1]) * (one.high - one.low) / 2)
        beside = counted(begins[0], other, p)
        path, multipliers = other.periodic(np.array([value(one, 0.0, p) for one in tube.states]) + beside)
        for i, phi in enumerate(np.linspace(0, PERIOD, 33)):
            for state, one in zip(path[i] - beside, tube.states, strict=True):
                assert abs(state - value(one, phi, p)) <= one.rest + 1e-8 * abs(state)
        assert -np.log(np.abs(multipliers).max()) * speeds[0] / PERIOD >= found.verdict.decay * (1 - 1e-6)
        assert (other.mean - other.stiffness * path[:, 0]).min() > 4.0
        paths.append(path)
    return paths


@pytest.mark.parametrize("width", [2e-4, 0.02])
def test_loads_and_speeds_move_the_twist_within_its_stage(width: float) -> None:
    """Twists count from those of the loads of each line, in a stage as without one."""
    pair, line = with_stages(0.004)
    speeds, shares = (pair.middle * (1 - width), pair.middle * (1 + width)), {"load.load_torque": 0.02}
    held(pair, line, speeds, shares)
    certificate = tn.certify_stability(line, shares, speeds)
    assert certificate.verdict == "proved stable"
    assert certificate.stages == ("shaft works in its stage 1 of 3, up to -4 N m",)


def test_a_motion_that_leaves_the_stage_is_refused_by_name() -> None:
    """At the knot the spring carries 130 N m, of which the swing takes more than 4 away."""
    _, line = with_stages(0.13)
    with pytest.raises(tn.InputError, match="shaft: leaves its stage at 95 rad/s: its twist goes from"):
        tn.certify_stability(line, {}, (94.99, 95.01))


def test_a_load_that_scatters_beyond_a_stage_is_refused() -> None:
    """At 64 rad/s it is nothing, and 30 N m either way within the tolerance: the inner stage bears 20 N m."""
    _, line = with_stages(0.02)
    line = line.replace("load", load_torque=-32.0, viscous_load=0.5, quadratic_load=0.0)
    with pytest.raises(tn.InputError, match="shaft = .*: is the torque at 63.99.* stage 2 of 3, from -20 to 20 N m"):
        tn.certify_stability(line, {"load.load_torque": ("range", -62.0, -2.0)}, (63.99, 64.0))


@pytest.mark.parametrize(("rest", "held"), [(0.0, True), (0.003, True), (0.006, False)])
def test_the_whole_tube_has_to_stay_in_the_stage(rest: float, held: bool) -> None:
    """The motion comes within 0.005 of the knot at 0.02."""
    parts = np.array([[0.0025, 0.0, 0.0025], [0.0, 0.0, 0.0]], dtype=complex)
    stage = OwnStage(0, 0.01, -0.02, 0.02)
    assert stage.holds(Wave(parts, rest)) == held
    assert not OwnStage(0, 0.01, 0.0055, 0.02).holds(Wave(parts, rest))


def test_stages_that_are_not_linear_within_are_refused_by_name() -> None:
    pair, _ = with_stages(0.004)
    teeth = {"teeth_in": 20, "teeth_out": 40, "module": 0.005, "mesh_stiffness": 1e8, "backlash": 1e-4, "name": "gears"}
    friction = [{"torque": 6.0, "stiffness": 4e3}]
    clutch = tn.Clutch(breakpoints=[0.004], stiffnesses=[1e3, 9e3], friction=friction, name="clutch")
    for beside, message in (
        (clutch, "clutch: about the line's own motion the stages of a Clutch are not enclosed"),
        (
            tn.GearPair(impact_damping=1e7, **teeth),
            "gears: about the line's own motion damping that goes with the depth",
        ),
        (tn.GearPair(damping_law="never pulling", **teeth), "gears: about the line's own motion teeth that never pull"),
    ):
        engine, joint, shaft, load = pair.line.elements
        with pytest.raises(tn.InputError, match=message):
            tn.certify_stability(
                tn.Driveline([engine, joint, shaft, tn.Disk(inertia=0.1), beside, load]), {}, (94.99, 95.01)
            )


RING = {"ring_inertia": 0.05, "stiffness": 500.0, "damping": 3.0}
SPRUNG = [tn.Shaft(stiffness=500.0, damping=3.0), tn.Disk(inertia=0.05)]
ALIKE = [  # what stands between a disk and the load, and what it is in shafts, disks and ratios
    pytest.param([], [tn.TunedDamper(**RING)], [], SPRUNG, id="tuned damper"),
    pytest.param([], [tn.ViscousDamper(**RING)], [], SPRUNG, id="viscous damper"),
    pytest.param(
        [tn.Belt(radius_in=0.06, radius_out=0.15, span_stiffness=4e5, damping=3.0)], [],
        [tn.Shaft(stiffness=2 * 4e5 * 0.06**2, damping=3.0), tn.Ratio(ratio=2.5)], [], id="belt",
    ),
    pytest.param(
        [], [tn.Tyre(stiffness=4e3, damping=9.0), tn.Vehicle(mass=200.0, wheel_radius=0.05)],
        [], [tn.Shaft(stiffness=4e3, damping=9.0), tn.Disk(inertia=200 * 0.05**2)], id="tyre",
    ),
    pytest.param(
        [tn.Shaft(stiffness=4e3, damping=9.0), tn.Planetary(teeth_sun=20, teeth_ring=60, input="sun", held="ring")], [],
        [tn.Shaft(stiffness=4e3, damping=9.0), tn.Ratio(ratio=4.0)], [], id="planetary set",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("before", "behind", "written_before", "written_behind"), ALIKE)
def test_compound_elements_are_proved_as_what_they_are_made_of(before, behind, written_before, written_behind) -> None:
    """To the rate that the multipliers of shooting have."""
    engine, joint, shaft, load = BentPair(95.0, angle=0.1).line.elements
    first, speeds = [engine, joint, shaft, tn.Disk(inertia=0.3)], (94.999, 95.001)
    line, written = (
        tn.Driveline([*first, *one, load, *other])
        for one, other in ((before, behind), (written_before, written_behind))
    )
    found, alike = tn.certify_stability(line, {}, speeds), tn.certify_stability(written, {}, speeds)
    assert found.verdict == alike.verdict == "proved stable"
    assert found.decay == pytest.approx(alike.decay, rel=1e-7)
    own = tn.stability(written, 95.0)
    rates = np.sort(-np.log(np.abs(own.multipliers)) * 95.0 / own.period)
    assert abs(rates[0]) < 1e-6 and 0.5 * rates[1] < found.decay <= rates[1] * (1 + 1e-4)


def test_an_oil_over_the_frequency_is_refused_by_name() -> None:
    points = ((10.0, 300.0, 200.0), (90.0, 900.0, 700.0))
    oil = [{"frequency": f, "stiffness": k, "loss_stiffness": d} for f, k, d in points]
    damper = tn.ViscousDamper(ring_inertia=0.05, oil=oil, oil_frequency=40.0, name="damper")
    line = tn.Driveline([*BentPair(95.0).line.elements, damper])
    with pytest.raises(tn.InputError, match="damper: about the line's own motion an oil whose stiffness goes with"):
        tn.certify_stability(line, {}, (94.99, 95.01))


# From a user's side


def test_tolerances_about_the_motion_are_proved() -> None:
    found = tn.certify_stability(PAIR.line, SHARES, (94.99, 95.01))
    assert found.verdict == "proved stable" and found.about_own_motion and found.boxes < 40
    assert "every line within 4 tolerances" in str(found)


@pytest.mark.slow
def test_what_is_proved_is_the_decay_about_the_motion_itself() -> None:
    speed = 94.0
    found = tn.certify_stability(TUG, {}, (speed, speed * (1 + 1e-9)))
    own = tn.stability(TUG, speed)
    rate = -np.log(own.spectral_radius) * speed / own.period
    assert found.verdict == "proved stable" and found.about_own_motion
    assert 0.9 * rate < found.decay <= rate * (1 + 1e-4)


@pytest.mark.slow
def test_the_whole_range_of_the_tug_is_proved() -> None:
    found = tn.certify_stability(TUG, {})
    assert found.verdict == "proved stable" and found.undecided_share == 0
    assert "about the line's own periodic motion, proved to exist" in str(found)


@pytest.mark.parametrize(
    ("speeds", "width"), [((60.0, 60.6), 0.05), ((100.0, 100.4), 0.0125)], ids=["slow", "near a resonance"]
)
def test_three_tolerances_of_the_tug_hold_at_corners_and_inside(speeds: tuple[float, float], width: float) -> None:
    """By an integration of the equations of the whole line that the tests have."""
    names = "elastic coupling.stiffness", "joint 1.angle", "propeller.inertia"
    found, rng = tn.certify_stability(TUG, dict.fromkeys(names, width), speeds), np.random.default_rng(9)
    assert found.verdict == "proved stable" and found.boxes < 10
    spreads = read_tolerances(OwnMotionLine(TUG).assembly, dict.fromkeys(names, width))
    nearest = np.inf
    for k in range(16):
        p = np.array([[k >> 2 & 1, k >> 1 & 1, k & 1]]) * 2.0 - 1 if k < 8 else rng.uniform(-1, 1, (1, 3))
        middle = {s.label: ((s.low + s.high) / 2, (s.high - s.low) / 2) for s in spreads}
        values = {name: mean + half * float(at) for (name, (mean, half)), at in zip(middle.items(), p[0], strict=True)}
        line, speed = TUG, speeds[k % 2] if k < 8 else float(rng.uniform(*speeds))
        for label, number in values.items():
            element, key = label.split(".")
            line = line.replace(element, **{key: number})
        own = SwungTree(line, turn=3 * np.pi).motion(speed)
        assert own is not None
        rate = -np.log(own.radius) * speed / (3 * np.pi)
        assert rate >= found.decay * (1 - 1e-6)
        nearest = min(nearest, rate / found.decay)
    assert nearest < 1.5
