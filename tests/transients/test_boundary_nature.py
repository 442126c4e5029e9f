"""The nature of a boundary of passing: of outcomes that are known, of a Cantor set, and of lines."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from tests.transients.test_capture_maps import ENDS, bent, by_hand
from trunnion.motion.passing.boundary_nature import boundary_nature, uncertainty_exponent


def test_one_edge() -> None:
    values = np.geomspace(1.0, 2.0, 65)
    passed = np.array([values > 1.3, values > 1.5], dtype=float).T
    found = boundary_nature(values, passed, values)
    assert found.kind == "one edge" and found.changes.tolist() == [1, 1]
    assert found.edges[0, 0] <= 1.3 < found.edges[0, 1] and found.edges[1, 0] <= 1.5 < found.edges[1, 1]
    assert found.apart == pytest.approx(2 ** (1 / 64) - 1)
    assert "one edge at every starting phase, from 1.3" in " ".join(found.sentences("factors"))


def test_a_sliver_and_its_width() -> None:
    values = np.geomspace(1.0, 2.0, 201)
    passed = ((values > 1.3) & ~((values > 1.5) & (values < 1.52))).astype(float)
    found = boundary_nature(values, passed[:, None], values)
    assert found.kind == "slivers" and found.changes.tolist() == [3]
    assert 0.02 / 1.5 < found.narrowest < 0.02 / 1.5 + 4 * found.apart
    assert "changes up to 3 times" in " ".join(found.sentences("factors"))


def test_what_is_undecided_is_no_change() -> None:
    values, passed = np.array([1.0, 1.1, 1.2, 1.3]), np.array([[0.0], [np.nan], [1.0], [1.0]])
    found = boundary_nature(values, passed, values)
    assert found.kind == "one edge" and found.edges.tolist() == [[1.0, 1.2]]


def test_the_exponent_of_a_smooth_boundary_is_one() -> None:
    passed = (np.arange(400)[:, None] > np.linspace(150, 250, 16)).astype(float)
    exponent, error = uncertainty_exponent(passed)
    assert exponent == pytest.approx(1.0, abs=0.01) and error < 0.01


def test_the_exponent_of_a_cantor_set_is_one_less_its_dimension() -> None:
    """Gaps of the middle-thirds set, each of an outcome drawn at random: D = log 2/log 3."""
    x = np.linspace(0, 1, 3**9 + 1)[:-1] + 0.5 / 3**9
    gap, part, path = np.zeros(3**9, dtype=np.int64), x.copy(), np.ones(3**9, dtype=np.int64)
    for _ in range(9):
        part *= 3
        digit = np.floor(part).astype(np.int64)
        gap = np.where((gap == 0) & (digit == 1), path, gap)  # the gap that it falls into, by the way to it
        path, part = 3 * path + digit, part - digit
    outcomes = np.random.default_rng(0).integers(0, 2, (int(gap.max()) + 1, 24))
    exponent, error = uncertainty_exponent(outcomes[gap].astype(float))
    assert exponent == pytest.approx(1 - np.log(2) / np.log(3), abs=0.05) and error < 0.05


def test_too_few_changes_give_no_exponent() -> None:
    assert np.isnan(uncertainty_exponent((np.arange(100)[:, None] > 40).astype(float))[0])


def test_the_least_acceleration_against_a_readers_own_equations() -> None:
    """The torque that accelerates the rigid line so is constant without loads: 5 kg m² times the acceleration."""
    found = tn.least_acceleration(
        bent(0.16), ENDS, (0.5, 3.0), drive="motor", points=2, accuracy=0.4, around=3, phases=[0.5]
    )
    assert found.outcome.kind == "found" and 1 < found.least / found.below <= 1.4 and len(found.band) == 3
    for one in found.trials:
        assert one.share == float(not by_hand(0.16, 5 * one.acceleration / 2.5, 0.5)), one.acceleration
    assert found.nature is not None and found.nature.kind == "one edge"
    assert "rad/s²" in str(found) and "looked for slivers at accelerations" in str(found)
    assert found.data.attrs["boundary"] == "one edge"


def test_the_drive_balances_loads_and_curves_at_the_speed_it_has() -> None:
    """The rigid line takes the range over the acceleration, whatever loads it."""
    from trunnion.motion.passing.even_acceleration import accelerating
    from trunnion.motion.passing.rigid import rigid_time
    from trunnion.motion.passing.start import begun_line, lasting

    curve = [{"speed": at, "torque": torque} for at, torque in ((0, 0), (30, 4), (90, 30))]
    pump = tn.Pump(name="pump", inertia=1.0, curve=curve)
    elements = [
        tn.Disk(name="motor", inertia=1.0),
        tn.Shaft(stiffness=2e3, damping=1.0),
        tn.Disk(name="load", inertia=4.0, load_torque=3.0, viscous_load=0.05, quadratic_load=1e-3),
        tn.Shaft(stiffness=3e3, damping=1.0),
        pump,
    ]
    for line in (tn.Driveline(elements[:3]), tn.Driveline(elements)):
        still = tn.AppliedTorque(on="motor", time=[0], torque=[0.0], between="steps")
        prepared, acting = begun_line(line, lasting(line, [still], ()), 5.0)
        others = tuple(one for one in acting[0] if one.on != "motor")
        even = accelerating(prepared, (others, *acting[1:]), "motor", 0.7, 5.0, 60.0)
        assert rigid_time(prepared, ((*others, even), *acting[1:]), 5.0, 60.0) == pytest.approx(55 / 0.7, rel=1e-3)
