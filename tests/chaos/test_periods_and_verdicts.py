"""After how many periods it repeats, and what a motion is: a hundred systems whose answer is known, none wrong.

What is known comes from theory (linear and undamped systems, clocks, rotations), from literature (Rössler, Lorenz), or
from an integrator of these tests that follows the motion on for 6000 periods from where the package left it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from functools import cache, partial

import numpy as np
import pytest
from oracles.forced_oscillator import oscillator, what_it_is
from scipy.integrate import solve_ivp

import trunnion as tn
from trunnion.motion.chaos.certify_chaos import ChaosCertificate
from trunnion.steady.shooting.repetition import Repetition, repetition
from trunnion.systems.reference import lorenz, mathieu_oscillator, rossler

Known = tuple[str, int]
PERIODIC, QUASI, CHAOTIC, UNBOUNDED, REST = "periodic", "quasi-periodic", "chaotic", "unbounded", "at rest"


def slow(ratio: float, damping: float) -> tn.System:
    """x″ + 2ζn x′ + n² x = cos t: whatever n, what remains has period 1."""
    return oscillator((0.0, 0.0), d=2 * damping * ratio, a=ratio**2, force=1.0)


@pytest.mark.slow
def test_a_motion_that_settles_slowly_is_said_to_settle() -> None:
    """n = 1/4, ζ = 0.004: its fourth returns are near long before the first ones are."""
    system = slow(0.25, 0.004)
    for points in (60, 100, 200, 800):
        found = tn.poincare_map(system, points, transient=1000)
        assert found.repeat == 0 and found.settling and "still settling" in str(found), points
    assert tn.poincare_map(system, 400, transient=4000).repeat == 1


@pytest.mark.slow
def test_a_diagram_counts_what_settles() -> None:
    found = tn.bifurcation_diagram(
        slow(0.25, 0.004), "force", (1.0, 2.0, 3), directions=["up"], points=100, transient=900
    )
    assert not np.any(found.repeat > 1) and found.settling.all() and "3 still settle" in str(found)
    assert found.data["settling"].dims == ("direction", "value")


def test_a_certificate_waits_for_what_settles() -> None:
    found = tn.certify_chaos(slow(0.25, 0.004), 800, sweep=False)
    assert found.verdict == "undecided" and any("still settling" in reason for reason in found.reasons)


@pytest.mark.slow
def test_settling_of_a_limit_cycle_whose_phase_is_a_state() -> None:
    """z′ = 1 has the exponent 0; it makes no torus of an oscillator that settles at 0.0001 1/s."""

    def rate(t, x, p):  # type: ignore[no-untyped-def]
        return x[1], -0.0002 * x[1] - x[0] / 16 + np.cos(x[2]), 1.0

    found = tn.certify_chaos(
        tn.System.from_function(rate, ["x", "v", "z"], start=[0.0, 0.0, 0.0]), duration=3000.0, sweep=False
    )
    assert found.verdict == "undecided" and found.kind == ""


def _spiral(ratio: float, shrinks: float, size: float, count: int) -> np.ndarray:
    k = np.arange(count)
    turn = size * np.exp((2j * np.pi * ratio - shrinks) * k)
    return np.stack([1 + turn.real, 0.3 + turn.imag], axis=1)


def _said(points: np.ndarray) -> Repetition:
    return repetition(points, np.ptp(points, axis=0), np.ones(2), np.zeros((0, 2)))


def test_spirals_into_a_point_never_have_a_longer_period() -> None:
    rng, said = np.random.default_rng(5), Counter[tuple[int, bool]]()
    for _ in range(300):
        ratio = rng.choice([1 / 2, 1 / 3, 1 / 4, 1 / 5, 2 / 5, 1 / 7, rng.uniform()])
        found = _said(_spiral(ratio, 10 ** rng.uniform(-6, 0), 10 ** rng.uniform(-6, 1), int(rng.integers(50, 600))))
        said[found.after, found.settling] += 1
    assert set(said) <= {(1, False), (0, True), (0, False)}
    assert said[1, False] > 30 and said[0, True] > 150 and said[0, False] < 30, said


@pytest.mark.parametrize(("r", "period"), [(2.9, 1), (3.2, 2), (3.5, 4), (3.83, 3), (3.74, 5), (3.99, 0)])
def test_periods_of_the_logistic_map(r: float, period: int) -> None:
    x, points = 0.3, np.empty((1000, 2))
    for i in range(3000):
        x = r * x * (1 - x)
        points[i % 1000] = x, 0.1 * x
    found = _said(points)
    assert (found.after, found.settling) == (period, False)
    assert _said(points[:40]).after in (0, period)


def clock(factor: float) -> tn.System:
    """x″ + 0.1 x′ + x = cos t + cos(factor · z), z′ = 1."""

    def rate(t, x, p):  # type: ignore[no-untyped-def]
        return x[1], -0.1 * x[1] - x[0] + np.cos(t) + np.cos(p.factor * x[2]), 1.0

    return tn.System.from_function(
        rate, ["x", "v", "z"], start=[0.0, 0.0, 0.0], period=2 * np.pi, parameters={"factor": factor}
    )


def rotation(torque: float, per_turn: float) -> tn.System:
    """A pendulum that turns over, its angle counted so that ``per_turn`` of it is once around."""

    def rate(t, x, p):  # type: ignore[no-untyped-def]
        unit = 2 * np.pi / p.turn
        return x[1], p.torque - 0.1 * x[1] - np.sin(unit * x[0]) / unit

    return tn.System.from_function(
        rate, ["angle", "rate"], start=[0.0, 0.5 * per_turn], parameters={"torque": torque, "turn": per_turn}
    )


def free_disks(torque: float) -> tn.System:
    """Two disks and a shaft that nothing holds, under a torque that pulsates; only their twist is felt."""

    def rate(t, x, p):  # type: ignore[no-untyped-def]
        shaft = 2.0 * (x[0] - x[1]) + 0.1 * (x[2] - x[3])
        return x[2], x[3], p.torque * (1 + 0.3 * np.cos(t)) - 0.1 * x[2] - shaft, shaft - 0.1 * x[3]

    return tn.System.from_function(
        rate, ["a", "b", "da", "db"], start=[0.0] * 4, period=2 * np.pi, parameters={"torque": torque}
    )


def geared_pendula() -> tn.System:
    """Two pendula behind each other, the second turns −3/2 times as fast: they repeat after two turns of the first."""

    def rate(t, x, p):  # type: ignore[no-untyped-def]
        mesh = 5.0 * (1.5 * x[0] + x[1]) + 0.5 * (1.5 * x[2] + x[3])
        return x[2], x[3], 2.0 - 0.1 * x[2] - np.sin(x[0] * 3) / 3 - 1.5 * mesh, -0.1 * x[3] - np.sin(x[1] * 3) - mesh

    return tn.System.from_function(rate, ["a", "b", "da", "db"], start=[0.0, 0.0, 8.0, -12.0])


def test_a_clock_of_any_period_is_not_unbounded() -> None:
    found = tn.certify_chaos(clock(np.sqrt(2)), 500, sweep=False)
    assert (found.verdict, found.kind) == ("regular", QUASI), str(found)


@pytest.mark.slow
def test_a_clock_that_closes_with_the_forcing() -> None:
    found = tn.certify_chaos(clock(1 / 3), 500, sweep=False)
    assert (found.verdict, found.kind, found.repeat) == ("regular", PERIODIC, 3), str(found)


@pytest.mark.slow
def test_turns_of_other_lengths_are_found() -> None:
    found = tn.certify_chaos(rotation(30.0, 360.0), duration=2000.0, sweep=False)
    assert (found.verdict, found.kind, found.repeat) == ("regular", PERIODIC, 1), str(found)
    assert np.abs(found.map.turns[0]) == pytest.approx([360.0, 0.0], rel=1e-9)  # type: ignore[union-attr]


@pytest.mark.slow
def test_what_runs_on_without_a_turn_is_undecided() -> None:
    """x′ = 1 + ½ sin²√(1 + |x|) is bounded, x is not; nothing repeats in it."""

    def rate(t, x, p):  # type: ignore[no-untyped-def]
        return 1 + 0.5 * np.sin(np.sqrt(1 + abs(x[0]))) ** 2, -x[1] + np.cos(t)

    found = tn.certify_chaos(
        tn.System.from_function(rate, ["x", "y"], start=[0.0, 0.0], period=2 * np.pi), 500, transient=50, sweep=False
    )
    assert found.verdict == "undecided" and "runs on" in found.reasons[0]


@pytest.mark.slow
def test_what_speeds_up_is_unbounded() -> None:
    def rate(t, x, p):  # type: ignore[no-untyped-def]
        return x[1], 0.001 + 0.01 * np.cos(t)

    found = tn.certify_chaos(
        tn.System.from_function(rate, ["x", "v"], start=[0.0, 0.0], period=2 * np.pi), 500, transient=50
    )
    assert found.verdict == "unbounded"


@cache
def hundred() -> dict[str, tuple[Callable[[], tn.System], Known | None]]:
    """Systems and what is known of them; None: ask the integrator of these tests."""
    rng = np.random.default_rng(20)
    made: dict[str, tuple[Callable[[], tn.System], Known | None]] = {}

    def put(name: str, make: Callable[[], tn.System], known: Known | None) -> None:
        assert name not in made
        made[name] = make, known

    for ratio in (1 / 2, 1 / 3, 1 / 4, 1 / 5, 2 / 3, 0.6180, 1.5):
        for damping in (0.05, 1e-3, 1e-4, 1e-6):
            put(f"linear n={ratio:.4f} ζ={damping:g}", partial(slow, ratio, damping), (PERIODIC, 1))
    for k in (2, 3, 4, 5, 7):
        put(f"undamped n=1/{k}", partial(slow, 1 / k, 0.0), (PERIODIC, k))
    for ratio in (np.sqrt(2), np.sqrt(3) / 4, 0.6180339887):
        put(f"undamped n={ratio:.4f}", partial(slow, ratio, 0.0), (QUASI, 0))
    put("undamped at resonance", lambda: slow(1.0, 0.0), (UNBOUNDED, 0))
    put("in a tongue", mathieu_oscillator, (UNBOUNDED, 0))
    for force in np.sort(rng.uniform(0.5, 13.0, 16)):
        put(f"ueda {force:.3f}", partial(oscillator, d=0.05, b=1.0, force=force), None)
    for force in np.sort(rng.uniform(0.15, 0.5, 10)):
        put(f"double well {force:.4f}", partial(oscillator, (1.0, 0.0), d=0.25, a=-1.0, b=1.0, force=force), None)
    for force in np.sort(rng.uniform(0.9, 1.6, 10)):
        put(f"pendulum {force:.4f}", partial(oscillator, d=0.5, g=1.0, force=force, frequency=2 / 3), None)
    for frequency in np.sort(rng.uniform(0.5, 2.5, 8)):
        put(f"stops {frequency:.4f}", partial(oscillator, d=0.1, a=0.1, s=20.0, force=1.0, frequency=frequency), None)
    for c, repeat in ((2.5, 1), (3.5, 2), (4.0, 4)):
        put(f"rössler {c}", partial(rossler, c=c), (PERIODIC, repeat))
    put("rössler 5.7", rossler, (CHAOTIC, 0))
    put("lorenz", lorenz, (CHAOTIC, 0))
    put("lorenz at rest", lambda: lorenz(rho=10.0), (REST, 0))
    put("lorenz 350", lambda: lorenz(rho=350.0), (PERIODIC, 1))
    for factor, known in (
        (np.sqrt(2), (QUASI, 0)), (np.sqrt(5) / 2, (QUASI, 0)), (1.0, (PERIODIC, 1)), (1 / 2, (PERIODIC, 2)),
        (1 / 5, (PERIODIC, 5)), (2.0, (PERIODIC, 1)), (4 / 3, (PERIODIC, 3)),
    ):  # fmt: skip
        put(f"clock {factor:.4f}", partial(clock, factor), known)
    for turn in (1.0, 2 * np.pi, 3.3, 360.0):
        put(f"rotation, a turn is {turn:.4g}", partial(rotation, 0.5 * turn / 6.0, turn), (PERIODIC, 1))
    put("free disks", lambda: free_disks(1.0), (PERIODIC, 1))
    return made


@cache
def found_of(name: str) -> tuple[Known, tn.System, ChaosCertificate]:
    """What is known of one of the hundred, and its certificate."""
    make, known = hundred()[name]
    system = make()
    effort = {"duration": 3000.0} if system.forcing_period is None else {"periods": 1000}
    found = tn.certify_chaos(system, sweep=False, tolerance=1e-9, **effort)
    return known or what_it_is(system, found.spectrum.runs[0].states[-1]), system, found


def say(name: str) -> str:
    """Whether verdict, kind and count are "right" or left "open"; what is wrong fails."""
    (kind, repeat), system, found = found_of(name)
    if system.forcing_period is not None and kind != UNBOUNDED:
        mapped = tn.poincare_map(system, 300, transient=200, tolerance=1e-9)
        if kind == PERIODIC:
            assert mapped.repeat in (0, repeat), f"{name}: {mapped}"
        else:
            assert mapped.repeat == 0, f"{name}: {mapped}"
    if found.verdict == "undecided":
        return "open"
    said = found.kind or str(found.verdict)
    assert kind != "other" and (said, found.repeat) == (kind, repeat), f"{name}, known {kind} {repeat}: {found}"
    return "right"


FEW = (
    "linear n=0.2500 ζ=0.05", "linear n=0.2500 ζ=0.0001", "linear n=0.6180 ζ=0.001", "undamped n=1/4",
    "undamped n=1.4142", "undamped at resonance", "clock 1.4142", "rössler 4.0", "lorenz", "lorenz at rest",
)  # fmt: skip


@pytest.mark.parametrize("name", FEW)
def test_ten_of_the_hundred(name: str) -> None:
    assert say(name) == ("open" if "ζ=0.0" in name and "0.05" not in name else "right")


@pytest.mark.slow
@pytest.mark.study
def test_a_hundred_systems_none_wrong() -> None:
    """Left open are the 21 linear oscillators that have not settled, and undamped ones whose error damps them."""
    told = {name: say(name) for name in hundred()}
    opened = [name for name, said in told.items() if said == "open"]
    assert len(told) >= 100
    assert all(name.startswith(("linear", "undamped n=1/")) for name in opened), opened
    assert len(opened) <= 26


@pytest.mark.slow
def test_two_angles_that_turn_together() -> None:
    """After its period the motion is ahead by whole turns of both, in the ratio of the gears, by scipy."""
    found = tn.certify_chaos(geared_pendula(), duration=3000.0, sweep=False)
    assert (found.verdict, found.kind) == ("regular", PERIODIC), str(found)

    def rates(t: float, x: np.ndarray) -> list[float]:
        mesh = 5.0 * (1.5 * x[0] + x[1]) + 0.5 * (1.5 * x[2] + x[3])
        first = 2.0 - 0.1 * x[2] - np.sin(x[0] * 3) / 3 - 1.5 * mesh
        return [x[2], x[3], first, -0.1 * x[3] - np.sin(x[1] * 3) - mesh]

    begin = found.map.points[-1]  # type: ignore[union-attr]
    end = solve_ivp(rates, (0, found.period), begin, method="DOP853", rtol=1e-11, atol=1e-11).y[:, -1]
    turns = (end - begin)[:2] / (2 * np.pi / 3)
    assert turns == pytest.approx(np.round(turns), abs=1e-4) and abs(turns[0]) > 0.5
    assert (end - begin)[2:] == pytest.approx(0.0, abs=1e-4)
