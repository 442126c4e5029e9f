"""What ranges of speed are searched with: exponents, meetings, bounds, pieces and tops, each against another method."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.floquet.ranges.exponents import ExponentOrders, colliding_exponents, floquet_exponents
from trunnion.floquet.ranges.resonances import Modes, orders_acting, resonances
from trunnion.floquet.ranges.slow_speeds import slow_enough
from trunnion.floquet.ranges.span import Span
from trunnion.floquet.ranges.unstable import UnstableRanges, unstable_ranges
from trunnion.floquet.stability.stability_over_speed import stability_along
from trunnion.modes.loaded_modes import loaded_modes
from trunnion.response.orders import response
from trunnion.response.orders.response import response_about
from trunnion.response.ranges.largest import SearchedQuantity, first_speeds, search, sharpened
from trunnion.response.speed_sweep import response_over
from trunnion.steady.orders.amplitudes import joined
from trunnion.steady.orders.spectrum import order_spectrum


def bent(angle: float, damping: float = 1e-3, second: float | None = None, inertia: float = 1.0) -> tn.Driveline:
    """Unit shafts and disks, one joint or two."""
    parts = [
        tn.ConstantSpeed(),
        tn.Shaft(stiffness=1.0, damping=damping),
        tn.Disk(inertia=1.0),
        tn.HookeJoint(angle=angle),
        tn.Shaft(stiffness=1.0, damping=damping),
        tn.Disk(inertia=inertia),
    ]
    if second is not None:
        parts += [
            tn.HookeJoint(angle=second, plane=0.4),
            tn.Shaft(stiffness=3.0, damping=damping),
            tn.Disk(inertia=0.4),
        ]
    return tn.Driveline(parts)


def ranges_of(line: tn.Driveline, low: float, high: float) -> UnstableRanges:
    span = Span(assemble(line), low, high)
    return unstable_ranges(span, lambda speeds: stability_along(span.assembly, speeds, table=span.table(speeds)))


@pytest.mark.parametrize("line", [bent(0.3), bent(0.5, 1e-2), bent(0.3, second=0.4)], ids=["one", "damped", "two"])
@pytest.mark.parametrize("speed", [0.11, 0.45, 1.3, 2.9])
def test_exponents_are_those_of_the_multipliers(line: tn.Driveline, speed: float) -> None:
    """By Hill's blocks and by integration over a period: two ways to the same numbers."""
    assembly = assemble(line)
    sides = ExponentOrders.of(assembly, reach=6)
    table = assembly.table(1, speed)
    values, shapes = loaded_modes(assembly, np.array([speed]))
    multipliers = tn.stability(line, speed).multipliers
    period = 2 * np.pi * float(sides.turns) / speed
    for mode in range(values.shape[1]):
        found = floquet_exponents(assembly, sides, table, values[:, mode], shapes[..., mode])
        assert np.abs(np.exp(found[0] * period) - multipliers).min() < 1e-6


def test_two_exponents_that_have_met_grow_as_integration_says() -> None:
    """On the sum resonance of unit shafts, about 1.118, the modulus of two multipliers has parted."""
    line = bent(0.3)
    assembly, speed = assemble(line), np.array([1.118])
    span = Span(assembly, 0.5, 2.0)
    modes, sides = Modes.of(span), ExponentOrders.of(assembly, reach=6)
    one, two = (modes.at(speed, np.array([mode])) for mode in (0, 1))
    found, moved = colliding_exponents(
        assembly, sides, span.table(speed), 2 * sides.turns**0, (one[0], two[0]), (one[1], two[1])
    )  # fmt: skip
    assert found.real.max() == pytest.approx(tn.stability(line, 1.118).growth_rate, rel=1e-3)
    assert found.real.max() > 0 > found.real.min() and moved.max() < 1e-7


def test_unstable_ranges_are_the_known_ones() -> None:
    """Edges of S1's equal shafts and disks, ζ = 0.001, 0.3 rad, computed twice elsewhere to six figures."""
    found = ranges_of(bent(0.3, 0.002), 0.55, 1.7)
    known = [(0.61204, 0.62460), (1.11078, 1.12580), (1.601913, 1.634565)]
    assert [pytest.approx(ends, abs=6e-6) for ends in known] == list(found.ranges)


def test_an_unstable_range_is_as_narrow_as_it_is() -> None:
    """Ends by bisection of the radius at single speeds: 3.5e-4 wide, between speeds 2e-2 apart of any even grid."""
    found = ranges_of(bent(0.05, 1e-5), 0.58, 0.66)
    ((low, high),) = found.ranges
    assert (low, high) == (pytest.approx(0.617861, abs=1e-6), pytest.approx(0.618207, abs=1e-6))
    for inside, outside in ((low * (1 + 1e-6), low * (1 - 1e-6)), (high * (1 - 1e-6), high * (1 + 1e-6))):
        assert (
            tn.stability(bent(0.05, 1e-5), inside).spectral_radius
            > 1
            > tn.stability(bent(0.05, 1e-5), outside).spectral_radius
        )


@pytest.mark.slow
def test_joints_of_different_speeds_make_sums_of_their_orders() -> None:
    """Behind a ratio of 1.5 a joint excites with 4/3 a turn; with the first joint's 2 it makes 10/3."""
    parts = [
        tn.ConstantSpeed(),
        tn.Shaft(stiffness=1.0, damping=1e-4),
        tn.Disk(inertia=1.0),
        tn.HookeJoint(angle=0.6),
        tn.Shaft(stiffness=4.0, damping=1e-4),
        tn.Disk(inertia=0.5),
        tn.Ratio(ratio=1.5),
        tn.HookeJoint(angle=0.5),
        tn.Shaft(stiffness=2.0, damping=1e-4),
        tn.Disk(inertia=0.7),
    ]
    line = tn.Driveline(parts)
    first = tn.natural_frequencies(line).frequency[0]
    found = ranges_of(line, 0.58 * first, 0.62 * first)
    speeds = np.linspace(0.58 * first, 0.62 * first, 1500)
    grows = stability_along(assemble(line), speeds).verdict == 1
    assert grows.any()
    inside = np.any([(speeds >= a) & (speeds <= b) for a, b in found.ranges], axis=0)
    assert not np.any(grows & ~inside) and not np.any(~grows & inside)


@pytest.mark.parametrize("line", [bent(0.3, 0.05), bent(0.6, 0.3), bent(0.3, 0.1, second=0.5)])
def test_below_the_bound_nothing_grows(line: tn.Driveline) -> None:
    bound = slow_enough(assemble(line))
    assert bound > 0
    along = stability_along(assemble(line), bound * np.linspace(0.3, 1.0, 8))
    assert np.all(along.verdict == 0)


def test_an_undamped_line_and_a_free_one_have_no_bound() -> None:
    free = [tn.Disk(inertia=1.0, drive_share=1), tn.Shaft(stiffness=1.0, damping=0.1), tn.Disk(inertia=1.0)]
    assert slow_enough(assemble(bent(0.3, 0.0))) == 0.0
    assert slow_enough(assemble(tn.Driveline(free))) == 0.0


def test_a_range_is_cut_where_a_spring_enters_another_stage() -> None:
    """A load 0.02 ω² reaches the knots at 10 and 40 N m where ω = √(T/0.02)."""
    parts = [
        tn.ConstantSpeed(),
        tn.PiecewiseShaft(
            breakpoints=[-0.4, -0.1, 0.1, 0.4], stiffnesses=[200.0, 100.0, 100.0, 100.0, 200.0], damping=0.1
        ),
        tn.Disk(inertia=0.1, quadratic_load=0.02),
    ]
    pieces = Span(assemble(tn.Driveline(parts)), 5.0, 80.0).pieces
    assert pieces[0].low == 5.0 and pieces[-1].high == 80.0
    assert [piece.high for piece in pieces[:-1]] == [pytest.approx(np.sqrt(torque / 0.02)) for torque in (10.0, 40.0)]


def test_what_no_table_covers_is_a_gap() -> None:
    shaken = [{"order": 2, "speeds": [20.0, 30.0, 60.0], "amplitudes": [5.0, 9.0, 4.0]}]
    parts = [
        tn.ConstantSpeed(),
        tn.Shaft(stiffness=1e3, damping=1.0),
        tn.Disk(name="fan", inertia=1.0, excitation=shaken),
    ]
    span = Span(assemble(tn.Driveline(parts)), 10.0, 70.0)
    assert [(gap.low, gap.high) for gap in span.gaps] == [pytest.approx((10.0, 20.0)), pytest.approx((60.0, 70.0))]
    assert span.gaps[0].why.endswith("covers 190.986 rpm to 572.958 rpm; extend it")
    assert [(piece.low, piece.high) for piece in span.pieces] == [
        pytest.approx((20.0, 30.0)),
        pytest.approx((30.0, 60.0)),
    ]


def test_a_table_behind_a_gear_is_said_to_go_over_its_own_speed() -> None:
    """3 : 1 and a fan known from 20 to 60 rad/s of its own: the input turns from 60 to 180 rad/s."""
    shaken = [{"order": 4, "speeds": [20.0, 60.0], "amplitudes": [5.0, 4.0]}]
    parts = [
        tn.ConstantSpeed(),
        tn.Shaft(stiffness=1e3, damping=1.0),
        tn.Disk(name="wheel", inertia=1.0),
        tn.Ratio(ratio=3.0),
        tn.Disk(name="fan", inertia=1.0, excitation=shaken),
    ]
    (gap,) = Span(assemble(tn.Driveline(parts)), 30.0, 180.0).gaps
    assert (gap.low, gap.high) == pytest.approx((30.0, 60.0))
    assert gap.why.endswith("covers 190.986 rpm to 572.958 rpm at its own speed; extend it")


def shaken(damping: float) -> tn.Driveline:
    engine = tn.Disk(
        inertia=0.2, excitation=[{"order": 2, "amplitude": 100.0}, {"order": 3, "amplitude": 40.0, "phase": 1.0}]
    )
    return tn.Driveline([engine, tn.Shaft(stiffness=1e4, damping=damping), tn.Disk(inertia=0.8)])


def torque(speed: float, order: int, amplitude: float, damping: float) -> complex:
    """Of two disks on a spring: T J₂/(J₁ + J₂) (k + icν)/(k + icν − ν² J₁J₂/(J₁ + J₂))."""
    nu = order * speed
    spring = 1e4 + 1j * damping * nu
    return amplitude * 0.8 * spring / (spring - 0.16 * nu**2)


@pytest.mark.parametrize("damping", [0.02, 0.4, 8.0])
def test_the_largest_torque_is_that_of_the_closed_form(damping: float) -> None:
    line = shaken(damping)
    span = Span(assemble(line), 60.0, 200.0)
    vibratory = SearchedQuantity(lambda r: r.vibratory_torque[:, 0], lambda r: r.torque[:, :, 0])
    angle = 2 * np.pi * np.arange(4096) / 4096

    def swing(speed: float) -> float:
        two, three = torque(speed, 2, 100.0, damping), torque(speed, 3, 40.0, damping) * np.exp(1j)
        wave = (two * np.exp(2j * angle) + three * np.exp(3j * angle)).real
        return -float(np.ptp(wave)) / 2

    found = search(
        span.assembly,
        lambda s: response_about(span.assembly, s),
        first_speeds(span.pieces, resonances(span)),
        [vibratory],
    )
    about = [np.sqrt(1e4 / 0.16) / order for order in (2, 3)]
    truth = min(
        minimize_scalar(swing, bounds=(0.98 * w, 1.02 * w), method="bounded", options={"xatol": 1e-10}).fun
        for w in about
    )
    assert found.value[0] == pytest.approx(-truth, rel=2e-6)
    assert found.error[0] < 1e-3 * found.value[0]


def test_a_top_is_located_closely_enough_to_differentiate_there() -> None:
    line, damping = shaken(0.4), 0.4
    single = SearchedQuantity(lambda r: np.abs(r.torque[:, 0, 0]), lambda r: r.torque[:, :1, 0])
    at = sharpened(lambda s: response_about(assemble(line), s), single, (124.0, 125.0, 127.0))
    truth = minimize_scalar(
        lambda s: -abs(torque(s, 2, 100.0, damping)), bounds=(124, 127), method="bounded", options={"xatol": 1e-12}
    )
    assert at == pytest.approx(truth.x, rel=1e-7)


def test_side_orders_of_joints_and_meshes_act_beside_those_of_disks() -> None:
    parts = list(bent(0.2).elements)
    parts[2] = tn.Disk(inertia=1.0, excitation=[{"order": 3, "amplitude": 1.0}, {"frequency": 7.0, "amplitude": 1.0}])
    order, frequency = orders_acting(assemble(tn.Driveline(parts)))
    turning = set(order[frequency == 0].tolist())
    assert {1.0, 2.0, 3.0, 4.0, 5.0, 7.0} <= turning
    assert {-4.0, -2.0, 2.0, 4.0} <= set(order[frequency == 7.0].tolist())


@pytest.mark.parametrize("line", [shaken(0.4), bent(0.3, 0.05, second=0.4)], ids=["straight", "bent"])
def test_a_response_over_a_range_solves_each_speed_once(line: tn.Driveline, monkeypatch: pytest.MonkeyPatch) -> None:
    """And is that at the same speeds; 2e-9 of what two meshes of interpolation make of a resonance."""
    ends = (60.0, 200.0) if len(line.elements) == 3 else (0.4, 1.05)
    looked: list[float] = []

    def counted(assembly: Any, speed: Any, **more: Any) -> Any:
        looked.extend(speed.tolist())
        return order_spectrum(assembly, speed, **more)

    with monkeypatch.context() as spied:
        spied.setattr(response, "order_spectrum", counted)
        found = response_over(line, *ends, points=31)
    assert sorted(looked) == found.speed.tolist() == tn.sweep_speeds(line, *ends, 31).tolist()
    again = tn.order_response(line, found.speed)
    assert found.order.tolist() == again.order.tolist()
    assert max(found.cut_off.max(), again.cut_off.max()) < 1e-11
    for key in ("torque", "rotation", "mean_torque", "peak_torque"):
        one, other = getattr(found, key), getattr(again, key)
        assert np.abs(one - other).max() <= 2e-9 * np.abs(other).max(initial=0.0) + 1e-12, key
    assert np.array_equal(found.verdict, again.verdict)


def test_spectra_joined_are_those_computed_at_once() -> None:
    assembly = assemble(bent(0.3, 0.05))
    speeds = np.array([0.4, 0.9, 1.3, 2.2, 0.7, 1.7])
    whole = order_spectrum(assembly, np.sort(speeds))
    both, order = joined([order_spectrum(assembly, speeds[:4]), order_spectrum(assembly, speeds[4:])])
    assert speeds[order].tolist() == both.speed.tolist() == np.sort(speeds).tolist()
    for key in both.keys:
        one = whole.keys.index(key) if key in whole.keys else None
        size = np.abs(whole.amplitude).max()
        values = whole.amplitude[:, one] if one is not None else 0.0
        assert np.abs(both.amplitude[:, both.keys.index(key)] - values).max() < 1e-9 * size
