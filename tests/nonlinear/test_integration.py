"""The integrator: errors follow the tolerance, events are exact, tangents are derivatives, failures speak."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from known_motions import (
    BACKLASH,
    DEAD_ZONE_INNER,
    DEAD_ZONE_MULTIPLIER,
    DEAD_ZONE_OUTER,
    DEAD_ZONE_PEAK_TO_PEAK,
    TAYLOR_RUNS,
)
from oracles.sampling import quick_only
from oracles.taylor import end_state

import trunnion as tn
from trunnion.numerics.integration.integration import IntegrationEnd, integrate


@pytest.mark.slow
@pytest.mark.parametrize("name", TAYLOR_RUNS)
def test_ends_are_those_of_the_taylor_series(name: str) -> None:
    duration, start, end = TAYLOR_RUNS[name]
    exact = end_state(name, tn.reference_system(name).parameters, start, duration)
    np.testing.assert_allclose(exact, end, rtol=1e-13)


@pytest.mark.parametrize("name", TAYLOR_RUNS)
def test_error_follows_the_tolerance(name: str) -> None:
    """Against a Taylor integrator: a thousand times the tolerance at most, and three decades per three."""
    duration, start, exact = TAYLOR_RUNS[name]
    system = tn.reference_system(name)
    errors = [
        float(np.abs(tn.simulate(system, duration, start=start, tolerance=tol).final - exact).max())
        for tol in (1e-6, 1e-9, 1e-12)
    ]
    assert errors[0] < 1e-3 and errors[1] < 1e-6 and errors[2] < 2e-9
    assert errors[1] < errors[0] / 30 and errors[2] < errors[1] / 30


def test_dense_output_is_as_good_as_the_steps() -> None:
    system, start = tn.reference_system("linear-oscillator", damping=0.0, force=0.0), [1.0, 0.0]
    run = tn.simulate(system, 30.0, start=start, tolerance=1e-11)
    times = np.linspace(0, 30, 1001)
    assert np.abs(run.at(times)[:, 0] - np.cos(times)).max() < 1e-8
    assert np.abs(run.final[0] - np.cos(30.0)) < 1e-9
    assert np.isnan(run.at(31.0)).all()


@pytest.mark.parametrize("name", ["duffing", "lorenz", "dead-zone-oscillator"])
def test_tangents_are_derivatives_of_the_flow(name: str) -> None:
    """Across regimes too, and their determinant is exp ∫ tr ∂f/∂x dt."""
    system = tn.reference_system(name)
    start = np.array([0.4, 0.2, 20.0])[: system.size]
    duration = 3.0 if name == "lorenz" else 12.0
    block = np.vstack([start, np.eye(system.size)])
    run = integrate(system.equations, 0.0, duration, block, regime=system.regime_at(0, start), tolerance=1e-12)
    step = 1e-4

    def end(x: np.ndarray) -> np.ndarray:
        return integrate(system.equations, 0.0, duration, x, regime=system.regime_at(0, x), tolerance=1e-13).final[0]

    for v, image in zip(np.eye(system.size), run.final[1:], strict=True):
        parts = [end(start + m * step * v) for m in (-2, -1, 1, 2)]
        slope = (parts[0] - 8 * parts[1] + 8 * parts[2] - parts[3]) / (12 * step)
        np.testing.assert_allclose(image, slope, atol=2e-7 * np.abs(run.final[1:]).max())
    expected = np.exp(system.divergence(system.parameters) * duration)
    assert np.linalg.det(run.final[1:]) == pytest.approx(expected, rel=1e-9)
    if name == "dead-zone-oscillator":
        assert len(run.event_time) >= 2


def test_coexisting_orbits_of_the_dead_zone_oscillator() -> None:
    """At ω = 0.6 one orbit stays in contact and one crosses the gap; the second's multipliers are known."""
    system = tn.reference_system("dead-zone-oscillator")
    strobe = tn.StroboscopicMap(system, tolerance=1e-12)
    for start, peak in zip((DEAD_ZONE_OUTER, DEAD_ZONE_INNER), DEAD_ZONE_PEAK_TO_PEAK, strict=True):
        image = strobe.apply(start, np.eye(2), dense=True)
        np.testing.assert_allclose(image.state, start, atol=2e-10)
        orbit = image.trajectory.at(np.linspace(0, strobe.duration, 4001))[:, 0]
        assert np.ptp(orbit) == pytest.approx(peak, abs=2e-6)
    values = np.linalg.eigvals(strobe.jacobian(DEAD_ZONE_INNER))
    assert values[np.argmax(values.imag)] == pytest.approx(DEAD_ZONE_MULTIPLIER, abs=5e-6)


@pytest.mark.slow
def test_backlash_that_never_pulls() -> None:
    """Damping acts in contact only and cannot pull: hard and soft contact, parting, gap, on both sides."""
    half, stiffness, damper = np.pi / 8, 20e3, 50.0

    def rate(t, x, p, regime):
        angle, speed = x
        side = 1.0 if regime <= 3 else -1.0
        spring = stiffness * (side * angle - half)
        torque = 0.0
        if regime == 1 or regime == 4:
            torque = 2 * spring
        elif regime == 2 or regime == 5:
            torque = spring + damper * side * speed
        return speed, -side * torque / 5.0

    def guard(t, x, p, regime):
        upper, lower = stiffness * (x[0] - half), stiffness * (-x[0] - half)
        push = damper * x[1]
        return upper, push - upper, push + upper, lower, -push - lower, -push + lower

    switches = []
    for side, contact, soft, pull in (("upper", "u", "us", "up"), ("lower", "l", "ls", "lp")):
        switches += [
            tn.Switch("gap", contact, +1, f"{side} hard"),
            tn.Switch(f"{side} hard", soft, -1, f"{side} soft"),
            tn.Switch(f"{side} soft", soft, +1, f"{side} hard"),
            tn.Switch(f"{side} soft", pull, -1, f"{side} parting"),
            tn.Switch(f"{side} parting", pull, +1, f"{side} soft"),
            tn.Switch(f"{side} parting", contact, -1, "gap"),
        ]
    names = ("gap", "upper hard", "upper soft", "upper parting", "lower hard", "lower soft", "lower parting")
    regimes = tn.Regimes(names, ("u", "us", "up", "l", "ls", "lp"), guard, switches, lambda t, x, p: 2)
    system = tn.System.from_function(rate, ["angle", "speed"], regimes=regimes, name="backlash")
    times = [t for t, _ in BACKLASH]
    run = tn.simulate(system, 0.15, start=[np.pi / 2, 0.0], tolerance=1e-12)
    np.testing.assert_allclose(run.at(times)[:, 0], [angle for _, angle in BACKLASH], atol=6e-8)
    assert set(run.event_name) == {"u", "us", "up", "l", "ls", "lp"}


@pytest.mark.parametrize("compiled", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_bouncing_ball(compiled: bool) -> None:
    """Impacts with a jump, in closed form up to where they accumulate, which is said."""
    flight = tn.Regimes(
        ("flight",),
        ("ground",),
        lambda t, x, p: (x[0],),
        (tn.Switch("flight", "ground", -1, "flight"),),
        lambda t, x, p: 0,
        jump=lambda t, x, p, guard: (0.0, -0.5 * x[1]),
    )
    system = tn.System.from_function(
        lambda t, x, p: (x[1], -9.81), ["height", "speed"], regimes=flight, compiled=compiled
    )
    first = np.sqrt(2 / 9.81)
    run = tn.simulate(system, 1.0, start=[1.0, 0.0])
    flights = first * (1 + 2 * (0.5 - 0.5 ** np.arange(1, 12)) / 0.5)
    expected = first + np.concatenate([[0.0], np.cumsum(2 * first * 0.5 ** np.arange(1, 11))])
    before = expected[expected < 1.0]
    np.testing.assert_allclose(run.event_time[: len(before)], before, atol=1e-14)
    assert flights[0] == first
    ended = tn.simulate(system, 5.0, start=[1.0, 0.0])
    assert ended.outcome.kind == "chatter" and "ground chatters" in ended.outcome.sentence
    assert ended.end == pytest.approx(3 * first, abs=1e-12)
    # A neighbour's arrival, speed and height: the jump's tangent with saltation against differences.
    block = np.vstack([[1.0, 0.0], np.eye(2)])
    image = integrate(system.equations, 0.0, 0.8, block)
    moved = [integrate(system.equations, 0.0, 0.8, np.array([1.0 + h, 0.0])).final[0] for h in (-1e-5, 1e-5)]
    np.testing.assert_allclose(image.final[1], (moved[1] - moved[0]) / 2e-5, atol=1e-8)


def test_events_are_found_to_rounding_with_their_direction() -> None:
    system = tn.reference_system("linear-oscillator", damping=0.0, force=0.0)
    for direction, times in ((1, [3 * np.pi / 2]), (-1, [np.pi / 2, 5 * np.pi / 2]), (0, np.pi * (np.arange(3) + 0.5))):
        run = tn.simulate(system, 9.0, start=[1.0, 0.0], events=[tn.Event("x", 0.0, direction)], tolerance=1e-13)
        np.testing.assert_allclose(run.event_time, times, atol=3e-12)
        assert np.abs(run.event_before[:, 0]).max() < 1e-15


@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9])
def test_a_crossing_and_the_way_back_within_one_step(depth: float) -> None:
    """x = cos t dips below −1 + depth for an instant, which no sample of the step may meet."""
    system = tn.reference_system("linear-oscillator", damping=0.0, force=0.0)
    run = tn.simulate(system, 5.0, start=[1.0, 0.0], events=[tn.Event("x", depth - 1, 0)], tolerance=1e-13)
    half = np.arccos(1 - depth)
    np.testing.assert_allclose(run.event_time, [np.pi - half, np.pi + half], atol=1e-12 / half)


@pytest.mark.slow
def test_events_may_stop_and_mix() -> None:
    system = tn.reference_system("lorenz")
    both = [tn.Event(lambda t, x, p: x[2] - (p.rho - 1), direction=-1, stop=True, name="plane"), tn.Event("x", 0.0)]
    run = tn.simulate(system, 50.0, start=[1.0, 1.0, 20.0], events=both)
    assert run.outcome.kind == "stopped" and "plane" in run.outcome.sentence
    assert run.final[2] == pytest.approx(27.0, abs=1e-13)


class Table:
    level = 27.0


@pytest.mark.parametrize("events", [1, 3])
def test_an_event_that_no_compiler_takes_is_called_back(events: int) -> None:
    """Alone, and beside a state and a function that could be compiled."""
    others = [tn.Event("x", 0.0), tn.Event(lambda t, x, p: x[1])][: events - 1]
    plane = tn.Event(lambda t, x, p: x[2] - Table.level, direction=-1, stop=True, name="plane")
    system, start = tn.reference_system("lorenz"), [1.0, 1.0, 20.0]
    run = tn.simulate(system, 50.0, start=start, events=[plane, *others])
    named = tn.simulate(system, 50.0, start=start, events=[tn.Event("z", 27.0, -1, stop=True)])
    assert run.outcome.kind == "stopped" and run.end == pytest.approx(named.end, abs=1e-12)


def test_section_map_and_its_derivative() -> None:
    """DP v for v within the section, against differences; the rest of DP is the projection along the flow."""
    section = tn.SectionMap(tn.reference_system("lorenz"), tn.Event("z", 27.0, -1), tolerance=1e-12)
    x = section([1.0, 1.0, 20.0])
    slopes = section.jacobian(x)
    for j in (0, 1):
        v = np.eye(3)[j]
        difference = (section(x + 1e-5 * v) - section(x - 1e-5 * v)) / 2e-5
        np.testing.assert_allclose(slopes[:, j], difference, atol=1e-7)
    flow = section.system.rate_at(0.0, x)
    np.testing.assert_allclose(slopes @ flow, 0, atol=1e-9 * np.abs(flow).max() * np.abs(slopes).max())
    never = tn.SectionMap(section.system, tn.Event("z", 270.0, -1), longest=5.0).apply(x)
    assert never.end is IntegrationEnd.REACHED and np.isnan(never.state).all()


def grows(t, x, p):
    return (x[0] ** 2,)


def too_many(t, x, p):
    return (x[0], x[0])


def root(t, x, p):
    with np.errstate(invalid="ignore"):
        return [-np.sqrt(x[0] - 0.5)]


def nan_later(t, x, p):
    return (np.nan if t > 1 else 1.0,)


def nan_at_once(t, x, p):
    return (np.nan,)


def raises(t, x, p):
    if t > 1:
        raise ValueError("beyond the table")
    return (-x[0],)


def raises_interpreted(t, x, p):
    str(t)
    return raises(t, x, p) if isinstance({}, dict) else ()


def jumps(t, x, p):
    return (1.0 if x[0] < 2 else -1.0,)


FAILURES: list[tuple[Any, str, tuple[str, ...], float]] = [
    (grows, "blow-up", ("blows up at t = 1 s", "check"), 1.0),
    (too_many, "refused", ("shape (2,) where (1,)",), 0.0),
    (root, "not finite", ("near t = 1.41421", "roots"), 2**0.5),
    (nan_later, "not finite", ("near t = 1 s",), 1.0),
    (nan_at_once, "not finite", ("near t = 0 s",), 0.0),
    (raises, "refused", ("ValueError: beyond the table",), 1.0),
    (raises_interpreted, "refused", ("ValueError: beyond the table",), 1.0),
    (jumps, "step limit", ("raise most_steps",), 1.0),
]


@pytest.mark.parametrize(
    ("function", "kind", "words", "time"), quick_only([f for f in FAILURES if f[0] is not raises], FAILURES)
)
def test_failures_are_outcomes(function: Any, kind: str, words: tuple[str, ...], time: float) -> None:
    """What was computed is kept, and the sentence says what happened and what to change."""
    compiled = function is raises  # the rest called back, which spares the compiling
    system = tn.System.from_function(function, 1, compiled=compiled)
    run = tn.simulate(system, 5.0, start=[1.0], most_steps=5_000)
    assert not run.outcome.ok and run.outcome.kind == kind
    assert all(word in run.outcome.sentence for word in words), run.outcome.sentence
    assert run.end == pytest.approx(time, abs=0.01)
    assert len(run.time) == run.trajectory.steps + 1 and np.isfinite(run.state).all()
    assert run.outcome.sentence in str(run) and run.data.attrs["outcome"] == kind
    with pytest.raises(tn.ComputationError):
        run.outcome.require()


def test_friction_that_sticks_chatters() -> None:
    """A dry-friction law without a sticking regime: the motion is kept up to where it sticks."""

    def rate(t, x, p, regime):
        return x[1], 0.5 * np.sin(t) - x[0] - (1.0 if regime == 0 else -1.0)

    regimes = tn.Regimes(
        ("forward", "backward"),
        ("at rest",),
        lambda t, x, p: (x[1],),
        (tn.Switch("forward", "at rest", -1, "backward"), tn.Switch("backward", "at rest", +1, "forward")),
        lambda t, x, p: int(x[1] < 0),
    )
    run = tn.simulate(tn.System.from_function(rate, 2, regimes=regimes, compiled=False), 30.0, start=[3.0, 0.1])
    assert run.outcome.kind == "chatter" and "at rest" in run.outcome.sentence and "sticking" in run.outcome.sentence
    assert 2 < run.end < 4 and abs(run.final[1]) < 1e-12


BAD_CALLS: list[tuple[dict[str, Any], str]] = [
    ({}, "duration"),
    ({"duration": 0.0}, "positive time"),
    ({"duration": np.nan}, "positive time"),
    ({"duration": 1.0, "tolerance": 0.0}, "tolerance"),
    ({"times": [1.0, 0.5]}, "rising"),
    ({"times": [-1.0, 0.5]}, "before start_time"),
    ({"duration": 1.0, "start": [1.0]}, "x, v"),
    ({"duration": 1.0, "events": [tn.Event("speed", 0.0)]}, "states are: x, v"),
    ({"times": [0.5], "dense": False}, "dense"),
]


@pytest.mark.parametrize(("given", "words"), BAD_CALLS, ids=[w for _, w in BAD_CALLS])
def test_wrong_questions_are_refused(given: dict[str, Any], words: str) -> None:
    with pytest.raises(tn.InputError, match=words):
        tn.simulate(tn.reference_system("duffing"), **given)


def test_interruption_reaches_the_caller() -> None:
    """Ctrl-C in a function that is called back is not swallowed."""

    def interrupted(t, x, p):
        str(t)
        if t > 0.5:
            raise KeyboardInterrupt
        return (1.0,)

    with pytest.raises(KeyboardInterrupt):
        tn.simulate(tn.System.from_function(interrupted, 1, compiled=False), 1.0, start=[0.0])
