"""Stability of long free lines with joint angles, about their own periodic motion by steps along the tree."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from oracles.free_bent_chain import FreeBentChain
from oracles.long_trees import random_tree
from oracles.multipliers import matched

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.errors import ComputationError, InputError
from trunnion.floquet.propagation.periodic_motion_modes import periodic_motion_modes
from trunnion.floquet.stability import stability as judged
from trunnion.floquet.stability.stability_over_speed import stability_along
from trunnion.results.verdict import Verdict
from trunnion.steady.free import free_balance, long_steady_state

SPEED = 150.0
RANDOM, QUICK = 40, 9


def free_tree(seed: int) -> tn.Driveline:
    """8 to 20 inertias with gears and branches, without drive; no mesh varies."""
    elements: list[Any] = []
    for element in random_tree(seed, 8, 20, driven=True).elements[2:]:
        even = isinstance(element, tn.GearPair)
        elements.append(element.model_copy(update={"stiffness_variation": ()}) if even else element)
    return tn.Driveline(elements)


def by_shooting(line: tn.Driveline, speed: float) -> Any:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(judged, "LONG", 10**6)
        return tn.stability(line, speed)


def seeds() -> list[Any]:
    """One quick, every tenth slow, the others a study."""
    slow = pytest.mark.slow
    marks = [slow if s % 10 == 0 else (slow, pytest.mark.study) for s in range(RANDOM)]
    return [s if s == QUICK else pytest.param(s, marks=marks[s]) for s in range(RANDOM)]


@pytest.mark.parametrize("seed", seeds())
def test_random_free_lines_against_shooting(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """All multipliers of the matrix of the period within both errors, the torque, the verdict and its words."""
    monkeypatch.setattr(judged, "LONG", 2)
    line = free_tree(seed)
    found, other = tn.stability(line, SPEED), by_shooting(line, SPEED)
    assert found.error_estimate != other.error_estimate  # another way
    matched(other.multipliers, other.multiplier_error, found.multipliers, found.multiplier_error)
    assert abs(found.spectral_radius - other.spectral_radius) <= found.error_estimate + other.error_estimate
    assert found.verdict == other.verdict and str(found.resonance) == str(other.resonance)
    assert found.extra_torque == pytest.approx(other.extra_torque, rel=1e-5, abs=1e-8)
    assert found.set_aside == other.set_aside == 1 and bool(found.speed_sentence) == bool(other.speed_sentence)
    assert found.error_estimate < 1e-7 and found.liouville_defect < 1e-8


def chain(count: int, load: float = 0.0, *, damping: float = 1e-4, angle: float = 0.3, stiff: float = 1e5) -> Any:
    """Unlike parts, a joint at a third and one at two thirds; ``load`` [N m s/rad] on the last disk."""
    elements: list[Any] = []
    for i in range(count):
        if i:
            k = stiff * (2 + np.sin(1.3 * i * i))
            elements.append(tn.Shaft(stiffness=k, damping=damping * k))
        loads: dict[str, Any] = {0: {"drive_share": 1}, count - 1: {"viscous_load": load}}.get(i, {}) if load else {}
        elements.append(tn.Disk(inertia=0.1 * (1.5 + np.cos(i * i)), **loads))
        if i in (count // 3, 2 * count // 3):
            elements.append(tn.HookeJoint(angle=angle, plane=0.2 * i))
    return tn.Driveline(elements)


SOFT, STIFF = (16, 0.0, 0.3, 5e3), (24, 0.5, 0.5, 1e5)


@pytest.mark.parametrize("count, load, angle, stiff", [SOFT, pytest.param(*STIFF, marks=pytest.mark.slow)])
def test_against_own_equations(count: int, load: float, angle: float, stiff: float) -> None:
    """Written in the test and integrated by SciPy to 1e-11: the torque and every multiplier."""
    line = chain(count, load, angle=angle, stiff=stiff)
    found, own = tn.stability(line, SPEED), FreeBentChain(line)
    closed = own.closed(SPEED, load * SPEED)
    assert found.extra_torque == pytest.approx(closed.torque - load * SPEED, rel=1e-6)
    value, right = np.linalg.eig(closed.matrix)
    condition = np.linalg.norm(right, axis=0) * np.linalg.norm(np.linalg.inv(right), axis=1)
    # Two at 1, or nearly, are known to the square root.
    bound = 1e-9 * condition
    matched(value, np.where(bound < 1e-6, bound, np.sqrt(1e-9)), found.multipliers, found.multiplier_error)
    assert found.error_estimate < 1e-8 and found.set_aside == 1


def motion(line: tn.Driveline, own: FreeBentChain) -> tuple[Any, Any, Any]:
    """The motion found, angles and speeds (n, time) over its period."""
    found = long_steady_state.long_steady_state(line, SPEED, 2)
    assert found is not None
    tau = np.pi * np.arange(256) / 256
    x, rate, _ = (part[0].T for part in found.given.at(tau))
    return found, tau + own.fork[:, None] + x, SPEED * (1 + rate)


@pytest.mark.parametrize("count", [40, pytest.param(200, marks=pytest.mark.slow)])
@pytest.mark.parametrize("load", [0.0, 0.4])
def test_the_drive_gives_what_dampers_take(count: int, load: float) -> None:
    """On average over the period, beyond the balance of the loads at even speed."""
    line = chain(count, load)
    found, a, v = motion(line, own := FreeBentChain(line))
    given = ((load * SPEED + found.torque) * v[0]).mean()
    assert found.torque > 0 and given == pytest.approx(own.lost(a, v).mean(), rel=1e-9)
    assert v.mean(axis=1) == pytest.approx(np.full(count, SPEED), rel=1e-12)


def test_an_undamped_free_line_keeps_its_energy() -> None:
    """And takes no torque, though joints make kinetic and elastic energy swing."""
    line = chain(20, damping=0.0)
    found, a, v = motion(line, own := FreeBentChain(line))
    energy, kinetic = own.energy(a, v), (own.j[:, None] * v**2).sum(axis=0) / 2
    assert np.ptp(energy) < 1e-11 * energy.mean() and np.ptp(kinetic) > 1e-4 * energy.mean()
    assert abs(found.torque) < 1e-9
    result = tn.stability(line, SPEED)
    assert result.verdict in (Verdict.MARGINAL, Verdict.UNSTABLE) and result.liouville_defect < 1e-8


def test_what_harmonics_of_the_motion_leave_out_is_in_the_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """With a few of them, wrong by more than rounding and known to be."""
    line = chain(16, 0.5, angle=0.5)
    right = tn.stability(line, SPEED)
    monkeypatch.setattr(free_balance, "FEWEST", 2)
    monkeypatch.setattr(free_balance, "NEGLIGIBLE", 1e-2)
    monkeypatch.setattr(long_steady_state, "MOST_STEPS", 1)
    monkeypatch.setattr(long_steady_state, "AGREES", 1.0)
    rough = long_steady_state.long_steady_state(line, SPEED, 2)
    assert rough is not None
    found = periodic_motion_modes(rough, 1.0)
    assert found is not None
    off = np.abs(found.modes.multiplier[:, None] - right.multipliers).min(axis=1)
    assert off.max() > 1e-10 and (off <= found.modes.error + right.multiplier_error.max()).all()


def test_equations_that_the_tree_does_not_have_go_the_other_way(monkeypatch: pytest.MonkeyPatch) -> None:
    """A motion that the compiled equations do not balance is none."""
    line = chain(16, 0.5)
    right = long_steady_state.long_steady_state(line, SPEED, 2)
    assert right is not None
    own = free_balance.FreeBalance.newton

    def without_damper(self: Any, table: Any) -> Any:
        problem = own(self, table)
        damping = problem.co.damping.copy()
        damping[:, 3] = 0.0
        return replace(problem, co=replace(problem.co, damping=damping))

    monkeypatch.setattr(free_balance.FreeBalance, "newton", without_damper)
    assert long_steady_state.long_steady_state(line, SPEED, 2) is None


def test_a_driven_line_about_its_own_motion(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where it is asked for: nothing is set aside, and no torque is unknown."""
    line = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=2e5, damping=5.0), *chain(16).elements])
    line = line.replace("Disk 16", viscous_load=0.5)
    found = tn.stability(line, SPEED, about_steady_state=True)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(judged, "LONG", 10**6)
        other = tn.stability(line, SPEED, about_steady_state=True)
    matched(other.multipliers, other.multiplier_error, found.multipliers, found.multiplier_error)
    assert found.set_aside == 0 and found.extra_torque is None and found.error_estimate < other.error_estimate


@pytest.mark.slow
def test_along_a_range_as_at_single_speeds() -> None:
    """Radius and verdict."""
    line = chain(44, 0.5)
    along = stability_along(assemble(line), [100.0, SPEED])
    for radius, error, speed in zip(along.radius, along.error, along.speed, strict=True):
        one = tn.stability(line, speed)
        assert abs(radius - one.spectral_radius) <= error + one.error_estimate and error < 1e-8


def test_responses_along_the_tree_as_by_the_slopes_of_states(monkeypatch: pytest.MonkeyPatch) -> None:
    """Orders that joints make, orders that meet them, one between, and one in time; a load by speed."""
    orders = [{"order": order, "amplitude": 30.0, "phase": 0.4} for order in (2, 1.5, 4)]
    line = chain(9, 0.3).replace("Disk 2", excitation=[*orders, {"frequency": 111.0, "amplitude": 5.0}])
    speeds = np.array([80.0, SPEED, 310.0])
    monkeypatch.setattr(free_balance, "LONG", 10)
    whole = tn.order_response(line, speeds)
    monkeypatch.setattr(free_balance, "LONG", 2)
    found = tn.order_response(line, speeds)
    assert list(found.order) == list(whole.order) and found.cut_off == pytest.approx(whole.cut_off, abs=1e-12)
    for key in ("torque", "twist", "rotation", "joint_rotations"):
        one, other = (np.abs(np.asarray(getattr(each, key))) for each in (found, whole))
        assert other.max() > 0 and one == pytest.approx(other, abs=1e-9 * other.max())


def test_torques_that_do_not_balance_are_refused() -> None:
    """As of short lines."""
    line = chain(20).replace("Disk 20", load_torque=5.0)
    with pytest.raises(InputError, match="its torques do not balance"):
        tn.stability(line, SPEED)


@pytest.mark.slow
def test_200_inertias_are_judged() -> None:
    """More inertias than matrices of the period are kept for."""
    found = tn.stability(chain(200, 0.4), SPEED)
    assert len(found.multipliers) == 400 and found.error_estimate < 1e-8 and found.liouville_defect < 1e-8


def test_a_motion_that_steps_do_not_reach_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """With one step of Newton's it is not found: that is said, with what to do, and no verdict is made of it."""
    line = chain(20, 0.5, angle=0.5)
    monkeypatch.setattr(free_balance, "CORRECTIONS", 1)
    monkeypatch.setattr(free_balance, "MATRICES", 1)
    told = "no periodic motion of the line was found to judge in 6 harmonics; ask for another speed, or give it more"
    with pytest.raises(ComputationError, match=told):
        tn.stability(line, SPEED)
    along = stability_along(assemble(chain(44, 0.5, angle=0.5)), [SPEED])
    assert along.verdict.tolist() == [Verdict.FAILED] and np.isnan(along.radius).all()
