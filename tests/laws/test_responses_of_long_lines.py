"""Responses of long lines, eliminated along their tree, against the matrices of the period and against other routes."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from oracles.long_trees import ORDER, forced_motion, random_tree
from oracles.sampling import quick_only

import trunnion as tn
from trunnion.equations import linear
from trunnion.equations.coefficients import assemble
from trunnion.equations.topology import require_period
from trunnion.steady.orders import spectrum as responses
from trunnion.steady.orders.spectrum import order_spectrum, search_cost
from trunnion.steady.orders.unbalanced import balanced, unbalanced

SPEED = 150.0
SHORT = 60
"""Unknowns up to which whole matrices are solved."""


def spectrum(line: tn.Driveline, speeds: Any, **asked: Any) -> Any:
    return order_spectrum(assemble(line), np.asarray(speeds, dtype=float), **asked)


@pytest.mark.parametrize("seed", quick_only((9, 108), range(200)))
def test_random_trees_against_the_matrices_of_the_period(seed: int) -> None:
    """Deviations of all inertias over the period; of free ones, damped by loss factors that equations in time do not
    know, torques by whole matrices. All torques balance in time."""
    line = random_tree(seed)
    assembly = assemble(line)
    found = spectrum(line, [SPEED])
    at_first = np.zeros(1, dtype=np.intp)
    assert unbalanced(assembly, found, assembly.table(1, SPEED), at_first) < 1e-9
    if assembly.topology.free:
        if assembly.topology.size <= SHORT:
            assert apart(found, by_whole_matrices(line, [SPEED])) < 1e-9
        return
    force = np.zeros(assembly.topology.size, dtype=complex)
    shaken = next(i for i, e in enumerate(line.elements) if e.kind == "Disk" and e.excitation)
    station = next(s for s, e in assembly.topology.disks if e == shaken)
    ratio = Fraction(assembly.topology.speed_ratio[station])
    rate = ORDER * abs(ratio)  # a disk's order counts its own turns
    turns = require_period(line, assembly.topology)
    turns = turns * (rate * turns).denominator
    force[assembly.topology.unknown_of[station]] = np.sign(float(ratio)) * 40.0 * np.exp(0.3j)
    x, tau, off = forced_motion(assembly, SPEED, float(turns), float(rate), force)
    ours = found.wave(0, found.amplitude[0], found.mean[0], tau / SPEED)[:, found.channels.deviation]
    assert np.abs(ours - x).max() < (1e-9 + 100 * off) * np.abs(x).max()


def chain(inertias: int, angle: float = 0.3) -> tn.Driveline:
    """A chain with two joints, shaken behind both."""
    elements: list[Any] = [tn.ConstantSpeed()]
    for i in range(inertias):
        elements += [tn.Shaft(stiffness=1e5 * (1 + i % 5), damping=5.0), tn.Disk(inertia=0.1 * (1 + i % 3))]
        if i in (1, inertias // 2):
            elements.append(tn.HookeJoint(angle=angle))
    elements[-1] = tn.Disk(inertia=0.2, excitation=[{"order": 1.5, "amplitude": 30.0}])
    return tn.Driveline(elements)


def by_whole_matrices(line: tn.Driveline, speeds: Any) -> Any:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(responses, "tree_pays", lambda *asked: False)
        return spectrum(line, speeds)


def apart(one: Any, other: Any) -> float:
    """The largest difference of torques, of orders that one has alone their size, over the largest torque."""
    places = one.channels.torque
    ours, theirs = (dict(zip(each.keys, each.amplitude.swapaxes(0, 1), strict=True)) for each in (one, other))
    largest = max(np.abs(part[..., places]).max() for part in theirs.values())
    nothing = np.zeros_like(next(iter(theirs.values())))
    differences = [ours.get(key, nothing) - theirs.get(key, nothing) for key in {*ours, *theirs}]
    return float(max(np.abs(part[..., places]).max() for part in differences) / largest)


@pytest.mark.parametrize("angle", [0.02, 0.3, 0.9])
def test_both_ways_agree_over_a_range(angle: float) -> None:
    """Resonances within it."""
    speeds = np.linspace(40.0, 400.0, 7)
    assert apart(spectrum(chain(9, angle), speeds), by_whole_matrices(chain(9, angle), speeds)) < 1e-10


def test_a_joint_at_80_degrees_takes_as_many_side_orders_as_it_needs() -> None:
    """Shares fall as tan²40° = 0.70 there."""
    line = chain(24, np.deg2rad(80.0))
    found = spectrum(line, [70.0])
    assert max(found.order) > 50 and found.cut_off[0] < 1e-11
    assembly = assemble(line)
    assert unbalanced(assembly, found, assembly.table(1, 70.0), np.zeros(1, dtype=np.intp)) < 1e-9
    response = tn.order_response(line, [70.0])
    needed = int(14 / -np.log10(np.tan(np.deg2rad(40.0)) ** 2)) + 1  # shares down to 1e-14, and one beyond
    assert response.side_orders == found.side_orders >= needed == 92
    assert any(f"{response.side_orders} side orders on either side" in str(one) for one in response.remarks)
    assert not any("side orders" in str(one) for one in tn.order_response(chain(24, 0.3), [70.0]).remarks)


def test_what_a_range_costs_is_reckoned_with_the_side_orders_that_its_slowest_speed_takes() -> None:
    line, ends = chain(17, np.deg2rad(80.0)), np.array([40.0, 300.0])
    slow, fast = (tn.order_response(line, [speed]).side_orders for speed in ends)
    cost, one = (search_cost(assemble(line), at, 100) for at in (ends, ends[1:]))
    assert cost.side_orders >= slow > fast == one.side_orders
    assert cost.seconds > one.seconds and cost.memory > one.memory
    straight = search_cost(assemble(chain(17, 0.0)), ends, 100)
    assert straight.seconds == straight.memory == straight.side_orders == 0


@pytest.mark.parametrize("degrees", [5.0, 15.0, 30.0, 45.0])
@pytest.mark.parametrize("inertias", [10, 20, 50, 100])
def test_what_a_search_costs_is_reckoned_with_the_harmonics_that_are_solved(
    inertias: int, degrees: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those of every pass at each of these speeds, counted where they are solved, and all amplitudes that come out."""
    line, speeds, solved = chain(inertias, np.deg2rad(degrees)), np.linspace(60.0, 300.0, 24), list[list[int]]()
    own = responses.TreeHill.solve

    def counted(blocks: Any, weights: Any, carrier: Any, h: Any, *more: Any) -> Any:
        solved.append([len(h)] * len(speeds))
        return own(blocks, weights, carrier, h, *more)

    monkeypatch.setattr(responses.TreeHill, "solve", counted)
    found = spectrum(line, speeds)
    every = sorted(h for group in solved for h in group)
    asked, looked = list[tuple[int, int]](), list[int]()
    plain, through = responses.along_tree, responses.looking_through

    def along(topo: Any, harmonics: Any, cases: int) -> float:
        asked.extend((h, cases) for h in harmonics)
        return plain(topo, harmonics, cases)

    def look(amplitudes: int) -> float:
        looked.append(amplitudes)
        return through(amplitudes)

    monkeypatch.setattr(responses, "along_tree", along)
    monkeypatch.setattr(responses, "looking_through", look)
    cost = search_cost(assemble(line), speeds, len(speeds))
    assert sorted(h for h, cases in asked for _ in range(cases)) == every
    assert looked == [found.amplitude.size]
    assert cost.side_orders == found.side_orders


def test_a_response_that_does_not_balance_is_solved_by_whole_matrices(monkeypatch: pytest.MonkeyPatch) -> None:
    """One share in a million of one order is seen; the answer is then that of the other way."""
    line, speeds = chain(12), np.array([70.0, 90.0, 110.0])
    found, assembly = spectrum(line, speeds), assemble(line)
    numbers = assembly.table(3, speeds)
    assert balanced(assembly, found, numbers, True, first=False)
    wrong = found.amplitude.copy()
    wrong[:, 2] *= 1 + 1e-6
    assert not balanced(assembly, replace(found, amplitude=wrong), numbers, True, first=False)

    class Wrong(responses.TreeHill):
        def solve(self, *asked: Any) -> Any:
            return super().solve(*asked) * (1 + 1e-6)

    monkeypatch.setattr(responses, "TreeHill", Wrong)
    assert apart(spectrum(line, speeds), by_whole_matrices(line, speeds)) == 0.0


def test_memory_grows_with_the_length() -> None:
    """Whole matrices of 400 inertias over a period would take a hundred times as much."""
    import tracemalloc

    line = chain(400)
    tracemalloc.start()
    try:
        found = spectrum(line, [90.0])
        assert tracemalloc.get_traced_memory()[1] < 25e6
    finally:
        tracemalloc.stop()
    assert np.isfinite(found.amplitude).all()


def test_entries_put_at_once_are_those_put_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Straight trees with ratios, forks, branches and loads that go with the speed."""
    line = random_tree(9, driven=True)  # has no mesh, and branches behind ratios
    for name, element in zip(line.names, line.elements, strict=True):
        if element.kind == "HookeJoint":
            line = line.replace(name, angle=0.0)
    last = [name for name, element in zip(line.names, line.elements, strict=True) if element.kind == "Disk"][-1]
    line = line.replace(last, load_torque=3.0, viscous_load=0.2, quadratic_load=1e-3)
    together = tn.order_response(line, [90.0, SPEED])
    monkeypatch.setattr(linear, "AT_ONCE", 0)
    apart = tn.order_response(line, [90.0, SPEED])
    np.testing.assert_allclose(together.torque, apart.torque, atol=1e-12 * np.abs(apart.torque).max())
    np.testing.assert_allclose(together.mean_torque, apart.mean_torque, rtol=1e-12)
    topology = assemble(line).topology
    station = next(station for station, place in topology.disks if line.names[place] == last)
    turning = abs(topology.mean_speeds[station]) * np.array([90.0, SPEED])
    carried = np.abs(together.mean_torque[:, -1])
    np.testing.assert_allclose(carried, 3.0 + 0.2 * turning + 1e-3 * turning**2, rtol=1e-12)
