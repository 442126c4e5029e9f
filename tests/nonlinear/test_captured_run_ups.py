"""Run-ups of free–free lines: reached or captured, as an independent stiff integrator finds.

The chains' equations are written anew in absolute angles (``oracles.driven_chains``) and integrated by ODEPACK's LSODA
or scipy's Radau. Only the start and what the drive gives beyond loads and inertia are taken from the run: it may begin
where it likes. A chain whose own answer changes with its tolerance, or with how long it waits, stands on the edge and
is counted.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from oracles.driven_chains import Chain, keeps, mean_speed, random_chain, reaches, run

import trunnion as tn
from trunnion.motion.passing.run_up import RunUp

LOOSE, TIGHT = 1e-8, 1e-10
MOST_EDGES = 0.05
"""Share of the chains that may stand on the edge."""


@dataclass(frozen=True)
class Case:
    """A chain, what the package says of it, and what its run begins with."""

    chain: Chain
    result: RunUp
    start: np.ndarray
    extra: float

    def turned(self, until: float, method: str = "LSODA", tolerance: float = TIGHT) -> tuple[np.ndarray, np.ndarray]:
        """The oracle's rotation."""
        return run(self.chain, self.start, self.extra, until, method=method, tolerance=tolerance)

    def reaches(self, tolerance: float) -> set[bool]:
        """Whether the oracle reaches the last speed, waiting as long as the package did and longer."""
        end = self.result.simulation.end
        slow = min(self.chain.first, self.chain.last)
        longer = max(2.5 * self.chain.duration + 60 * np.pi / slow, 1.2 * end)
        time, turned = self.turned(longer, tolerance=tolerance)
        seen = time <= end + 2 * np.pi / slow
        return {reaches(self.chain, time[seen], turned[seen]), reaches(self.chain, time, turned)}


def case(chain: Chain) -> Case:
    found = tn.run_up(chain.line, chain.first, chain.last, acceleration=chain.rate, ramp=chain.ramp, steady=0)
    assert found.outcome.ok and found.ending is not None
    state, n = found.simulation.at(np.zeros(1))[0], len(chain.inertia)
    load = float(np.polynomial.Polynomial(chain.load)(chain.last))
    extra = found.ending.drive - load - chain.sense * chain.inertia.sum() * chain.rate
    return Case(chain, found, np.concatenate([state[:n], chain.first + state[n:]]), extra)


def disagreement(one: Case) -> str:
    """ "" where both agree, "edge" where the oracle does not agree with itself, else what each says."""
    kind = one.result.outcome.kind
    found = one.reaches(LOOSE) | one.reaches(TIGHT)
    if len(found) > 1 or kind == "undecided":
        return "edge"
    if found != {kind == "reached"}:
        return f"{one.result.outcome}, and the oracle {'reaches' if True in found else 'does not reach'} it"
    if kind in ("captured", "short of torque"):
        ways = {keeps(one.chain, one.extra, one.result.ending.speed, tolerance=t) for t in (LOOSE, TIGHT)}
        if len(ways) > 1:
            return "edge"
        return "" if ways == {kind == "captured"} else f"{one.result.outcome}, and the oracle says not so"
    return "" if kind == "reached" else f"{one.result.outcome}"


def check(seeds: range) -> None:
    said = {seed: disagreement(case(random_chain(seed))) for seed in seeds}
    edges = [seed for seed, words in said.items() if words == "edge"]
    wrong = {seed: words for seed, words in said.items() if words not in ("", "edge")}
    print(f"{len(said)} chains, on the edge: {edges}")
    assert not wrong
    assert len(edges) <= max(MOST_EDGES * len(said), 1)


@pytest.mark.parametrize("seed", [48, 49, 33, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (44, 45, 87))])
def test_ends_as_an_independent_integrator_finds(seed: int) -> None:
    """Captured at once or later, reached on time or late, run down."""
    check(range(seed, seed + 1))


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 300, 20))
def test_three_hundred_end_as_an_independent_integrator_finds(first: int) -> None:
    check(range(first, first + 20))


def hanging_line(angle: float = 0.35, damping: float = 1.5, order: float = 40.0, **operation: object) -> tn.Driveline:
    """Two resonances of order 2: of its drive and of its joint."""
    return tn.Driveline(
        [
            tn.Disk(inertia=0.4, drive_share=1.0, excitation=[{"order": 2, "amplitude": order}]),
            tn.Shaft(stiffness=6e3, damping=damping),
            tn.Disk(inertia=0.2),
            tn.HookeJoint(angle=angle),
            tn.Shaft(stiffness=4e3, damping=1.0),
            tn.Disk(inertia=1.5, quadratic_load=0.003),
        ],
        **operation,
    )


@pytest.fixture(scope="module")
def captured() -> RunUp:
    return tn.run_up(hanging_line(), 20.0, 100.0, acceleration=2.0, steady=0)


def test_a_capture_tells_where_why_and_what_to_change(captured: RunUp) -> None:
    """The line hangs at 41 rad/s, half of its first mode: by the oracle too, at the torque of the schedule's end."""
    one, ending = captured, captured.ending
    assert one.outcome.kind == "captured" and one.outcome.ok and ending.kind == "captured"
    chain = Chain(
        np.array([0.4, 0.2, 1.5]), np.array([[40.0, 2.0, 0.0], [0, 0, 0], [0, 0, 0]]), np.array([6e3, 4e3]),
        np.array([1.5, 1.0]), np.array([0.0, 0.35]), np.array([0.0, 0.0, 0.003]), 20.0, 100.0, 2.0, one.ramp,
    )  # fmt: skip
    state = one.simulation.at(np.zeros(1))[0]
    extra = ending.drive - 30.0 - 2.1 * 2.0
    time, turned = run(
        chain, np.concatenate([state[:3], 20 + state[3:]]), extra, one.simulation.end, method="LSODA", tolerance=TIGHT
    )
    at, mean = mean_speed(time, turned)
    assert not reaches(chain, time, turned)
    assert ending.hung_speed == pytest.approx(mean[at > chain.duration].mean(), rel=2e-3)
    assert ending.speed == pytest.approx(mean[-1], rel=1e-3) and 40.5 < ending.hung_speed < 41.5
    assert one.simulation.turns == pytest.approx(turned[-1] / (2 * np.pi), abs=0.05)
    # From its approach to the resonance on.
    assert 4 < ending.hanging.since < 10 and ending.hanging.until == one.simulation.end > chain.duration + 5
    strongest, modes = ending.strongest, tn.natural_frequencies(hanging_line()).frequency
    assert strongest.order == 2.0 and strongest.sources == ("HookeJoint 1", "Disk 1") and strongest.spring == "Shaft 2"
    assert strongest.mode == 2 and strongest.mode_frequency == pytest.approx(modes[1])
    assert strongest.frequency == pytest.approx(2 * ending.hung_speed, rel=5e-3)
    # The loads take 0.003 w² of what drives.
    assert ending.load == pytest.approx(0.003 * ending.hung_speed**2) and 34 < ending.drive < 35
    words = str(one.outcome)
    assert words.startswith(
        "captured at 41.1 rad/s, short of 100 rad/s: order 2 of HookeJoint 1 and Disk 1 shakes mode 2"
    )
    assert "accelerate faster, damp Shaft 2 more, or lower what excites order 2" in words
    # Turns of its own, each with its own speed: no turn of the 100 rad/s asked for.
    assert one.speed[-1] == pytest.approx(ending.speed, rel=2e-3) and one.speed.max() < 43 and one.lag.max() > 58
    assert len(one.speed) == int(one.simulation.turns)
    assert one.data.attrs["outcome"] == "captured" and one.data.attrs["hung_speed"] == ending.hung_speed
    axes = one.plot()
    assert "captured at 41.1 rad/s" in axes.get_title() + axes.get_title(loc="left")


def test_the_torque_of_a_captured_line_would_keep_the_last_speed(captured: RunUp) -> None:
    """By another method: the periodic motion at 100 rad/s asks for less than the drive gives, that at 41 rad/s for
    all."""
    from trunnion.equations.line_system import line_system
    from trunnion.steady.shooting.free_orbit import kept_speed_orbit

    losses = {w: kept_speed_orbit(line_system(hanging_line(), w)).values[-1] for w in (captured.ending.speed, 100.0)}
    needed = {w: 0.003 * w**2 + torque for w, torque in losses.items()}
    assert needed[100.0] < captured.ending.drive
    assert needed[captured.ending.speed] == pytest.approx(captured.ending.drive, rel=0.1)


def test_a_captured_line_is_told_in_the_unit_of_its_description() -> None:
    line = hanging_line(operation=tn.Operation(speed="400 rpm", speed_unit="rpm"))
    words = tn.run_up(line, tn.rpm(200), tn.rpm(950), acceleration=tn.rpm(60), steady=0)
    assert (
        "captured at 39" in str(words) and "rpm, short of 950 rpm" in str(words) and "mode 2 (13.23 Hz)" in str(words)
    )
    assert "at 60 rpm/s" in str(words) and "rad/s" not in str(words)
    assert "rad/s²" in words.describe("rad/s") and "rpm" not in words.describe("rad/s")


def test_no_capture_is_a_safe_acceleration() -> None:
    """Its torque stays below the limit at 2 and 4 rad/s², where the line never passes."""
    found = tn.safe_accelerations(hanging_line(), 20.0, 100.0, limit=2200.0, accelerations=(2.0, 8.0), points=3)
    assert found.outcome == ("captured",) * 3 and (found.share[:2] < 1).all() and not found.safe.any()
    assert np.isnan(found.slowest) and np.isnan(found.fastest) and found.stretch == ()
    words = (
        "none of the 3 accelerations tried from 2 to 8 rad/s² is safe; captured at 3 from 2 to 8 rad/s², turning at 41"
    )
    assert str(found).startswith(words)
    assert list(found.data.outcome.values) == list(found.outcome)


@pytest.mark.slow
def test_the_edge_of_capture_is_closed_in_on() -> None:
    """Between 10 and 80 rad/s² the line comes free: told for what was run, with the edge to 1 %."""
    found = tn.safe_accelerations(hanging_line(), 20.0, 100.0, limit=1e4, accelerations=(10.0, 80.0), points=3)
    low = found.outcome.index("reached")
    assert found.outcome[low - 1] == "captured" and found.slowest == found.acceleration[low]
    assert found.acceleration[low] / found.acceleration[low - 1] < 1.011 and found.fastest == 80.0
    assert set(found.outcome[low:]) == {"reached"} and len(found.stretch) == len(found.trials) - low
    words = str(found)
    assert f"safe at each of the {len(found.stretch)} accelerations tried from" in words
    assert "it is captured" in words and "nothing faster was tried" in words and "nothing between them was run" in words
    faster = tn.run_up(hanging_line(), 20.0, 100.0, acceleration=found.slowest, steady=0)
    slower = tn.run_up(hanging_line(), 20.0, 100.0, acceleration=found.acceleration[low - 1], steady=0)
    assert faster.outcome.kind == "reached" and slower.outcome.kind == "captured"


def test_a_line_that_hangs_for_a_while_tells_how_long() -> None:
    found = tn.run_up(hanging_line(), 20.0, 100.0, acceleration=20.0, steady=0)
    ending = found.ending
    assert found.outcome.kind == "reached" and 2 < ending.hanging.duration < 5 and 40 < ending.hanging.speed < 43
    assert ending.time == found.simulation.end > ending.scheduled + 1
    assert ending.speed == pytest.approx(100.0, abs=0.02 * 80) and "then passed; reached 100 rad/s" in str(found)
    quick = tn.run_up(hanging_line(), 20.0, 100.0, acceleration=100.0, steady=0)
    assert quick.ending.hanging is None and str(quick.outcome).startswith("reached 100 rad/s at t = ")


@pytest.mark.parametrize(("degrees", "kind"), [(15.0, "captured"), (5.0, "reached")])
def test_a_joint_captures_at_half_of_the_mode(degrees: float, kind: str) -> None:
    """It excites twice a turn: of a mode at 50 rad/s 15° hang just below 25 rad/s, and 5° pass."""
    parts = [tn.Disk(inertia=1.0, drive_share=1.0), tn.HookeJoint(angle=f"{degrees} deg")]
    shaft = tn.Shaft(stiffness=1250.0, damping=0.5)  # 50² · ½ kg m²
    line = tn.Driveline([*parts, shaft, tn.Disk(inertia=1.0, load_torque=5.0)])
    found = tn.run_up(line, 15.0, 40.0, acceleration=0.5, steady=0)
    assert found.outcome.kind == kind
    if kind == "captured":
        assert 24.0 < found.ending.hung_speed < 25.0 and found.ending.strongest.order == 2.0
        assert found.ending.strongest.sources == ("HookeJoint 1",) and found.ending.strongest.mode == 2
        assert "accelerate faster" in str(found)


def test_a_line_whose_losses_take_the_torque_is_not_captured() -> None:
    """Dampers behind an angled joint far below any resonance: the steady motion at the last speed asks for more than
    there is, by another method."""
    from trunnion.equations.line_system import line_system
    from trunnion.steady.shooting.free_orbit import kept_speed_orbit

    line = tn.Driveline(
        [
            tn.Disk(inertia=2.0, drive_share=1.0),
            tn.HookeJoint(angle=0.6),
            tn.Shaft(stiffness=2e4, damping=150.0),
            tn.Disk(inertia=1.5, viscous_load=0.1),
        ]
    )
    found = tn.run_up(line, 10.0, 60.0, acceleration=1.0, steady=0)
    assert found.outcome.kind == "short of torque" and found.outcome.ok
    needed = 0.1 * 60 + kept_speed_orbit(line_system(line, 60.0)).values[-1]
    assert needed > found.ending.drive
    ends = found.ending.speed
    assert 0.1 * ends + kept_speed_orbit(line_system(line, ends)).values[-1] == pytest.approx(
        found.ending.drive, rel=0.02
    )
    assert "losses in joints and dampers take all" in str(found)
    assert tn.run_up(line, 10.0, 60.0, acceleration=100.0, steady=0).outcome.kind == "reached"


def test_a_line_that_stops_is_stalled() -> None:
    """Order 2 of 60 N m holds more than the drive gives and the inertia carries over."""
    line = tn.Driveline(
        [
            tn.Disk(inertia=0.4, drive_share=1.0, excitation=[{"order": 2, "amplitude": 60.0}]),
            tn.Shaft(stiffness=6e3, damping=3.0),
            tn.Disk(inertia=0.5, viscous_load=0.02),
        ]
    )
    found = tn.run_up(line, 5.0, 60.0, acceleration=5.0, steady=0)
    assert found.outcome.kind == "stalled" and "stops turning before 60 rad/s" in str(found)
    assert found.simulation.turns < 2 and found.ending.time < 3 < found.simulation.end


def test_a_line_that_runs_down_may_go_on() -> None:
    """A resonance takes power on the way down too: the line falls below what is asked, and is told to have."""
    line = hanging_line(order=0.0).replace("Disk 3", quadratic_load=None, load_torque=20.0)
    found = tn.run_up(line, 100.0, 20.0, acceleration=3.0, steady=0)
    assert found.outcome.kind == "reached" and found.ending.speed < 18 and "and went on to 1" in str(found)


def test_a_prescribed_speed_cannot_be_captured() -> None:
    line = tn.Driveline([tn.ConstantSpeed(), *hanging_line().elements[1:]])
    found = tn.run_up(line, 20.0, 100.0, acceleration=2.0, steady=0)
    assert found.ending is None and found.outcome.kind == "reached" and not found.lag.any()
    assert found.simulation.end == found.simulation.profile.time[-1]
    assert "hung_speed" not in found.data.attrs


@pytest.mark.parametrize("free", [True, False])
def test_a_clutch_that_lets_go_is_no_run_up(free: bool) -> None:
    """8 N m of friction for 10: the ends part until the damper carries 2 N m, at 4 rad/s."""
    clutch = tn.Clutch(stiffnesses=[0.0], damping=0.5, friction=[{"torque": 8.0, "stiffness": 4e3}])
    drive = tn.Disk(inertia=0.4, drive_share=1.0) if free else tn.ConstantSpeed()
    line = tn.Driveline([drive, clutch, tn.Disk(inertia=0.5, load_torque=5.0)])
    found = tn.run_up(line, 20.0, 60.0, acceleration=10.0, ramp=0.2, steady=0)
    assert found.outcome.kind == "slipped" and found.outcome.ok and found.data.attrs["outcome"] == "slipped"
    slip = found.ending.slip
    # Momentum: 0.9 kg m² turn as asked, or the drive does.
    behind = 4.0 * 0.4 / 0.9 if free else 4.0
    half = 10 * 2 * np.pi / 60 / 2  # that a mean over the last turn is behind the end of it
    assert slip.lost == pytest.approx(behind, rel=0.03)
    assert slip.speed == pytest.approx(60 - half - slip.lost, abs=0.02)
    assert 1.5 < slip.turns < 2.7
    assert "Clutch 1 slipped by" in str(found) and "raise its friction torque" in str(found)
    held = tn.Clutch(stiffnesses=[0.0], damping=0.5, friction=[{"torque": 12.0, "stiffness": 4e3}])
    kept = tn.run_up(line.replace("Clutch 1", friction=held.friction), 20, 60, acceleration=10, ramp=0.2, steady=0)
    assert kept.outcome.kind == "reached"


def test_an_ending_that_hangs_on_the_tolerance_is_not_decided(monkeypatch: pytest.MonkeyPatch) -> None:
    from dataclasses import replace

    from trunnion.motion.passing import run_up as module

    whole, seen = module._run, []

    def otherwise(*given):
        simulation, ending = whole(*given)
        seen.append(given[-1])
        return simulation, ending if len(seen) == 1 else replace(ending, kind="reached")

    monkeypatch.setattr(module, "_run", otherwise)
    found = tn.run_up(hanging_line(), 20.0, 60.0, acceleration=10.0, steady=0)
    assert seen == [1e-9, pytest.approx(1e-7)] and found.outcome.kind == "undecided" and found.outcome.ok
    assert "not decided whether it reaches 60 rad/s: it is captured at 4" in str(found) and "it does, so that" in str(
        found
    )


@pytest.mark.slow
def test_a_linearity_check_says_that_a_line_does_not_pass() -> None:
    found = tn.linearity_check(hanging_line(), 40.0, acceleration=4.0)
    assert found.passage.kind == "captured" and found.data.attrs["passing_outcome"] == "captured"
    assert "does not pass (captured at" in str(found) and "Passed at" not in str(found)


@pytest.mark.slow
def test_radau_finds_the_same() -> None:
    for seed in (48, 52):  # one captured early, one by three orders
        one = case(random_chain(seed))
        until = one.result.simulation.end
        assert one.result.outcome.kind == "captured"
        assert not reaches(one.chain, *one.turned(until, "Radau", 1e-7))
