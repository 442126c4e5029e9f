"""Best designs against answers that are known: homokinetic joints, closed phasors, Den Hartog's damper."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.optimize import minimize

import trunnion as tn
from trunnion.design.optimisation.aims import Aim, DesignEvaluation, DesignProblem
from trunnion.design.optimisation.search import DesignSearch, first
from trunnion.design.optimisation.space import Space
from trunnion.equations.coefficients import assemble
from trunnion.results.files import read_dataset, save_dataset


def joints(angles, offsets, planes=None):
    parts = [tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=2.0), tn.Disk(inertia=0.1)]
    for angle, offset, plane in zip(angles, offsets, planes or [0.0] * len(angles), strict=True):
        parts.append(tn.HookeJoint(angle=angle, plane=plane))
        parts += [tn.Shaft(stiffness=1e4, damping=2.0, fork_offset=offset), tn.Disk(inertia=0.1)]
    return tn.Driveline(parts)


@pytest.mark.parametrize("plane", [0.0, 0.7])
def test_two_equal_joints_cancel_with_their_forks_phased(plane):
    """Z and W arrangements, and bends in two planes: fork_offset = plane."""
    line = joints([0.35, 0.35], [1.0, 0.0], [0.0, plane])
    best = tn.optimise(line, {"Shaft 2.fork_offset": ("-60 deg", "80 deg")}, "irregularity", designs=60)
    assert best.aim[0] < 1e-9 and best.values["Shaft 2.fork_offset"] == pytest.approx(plane, abs=1e-8)
    assert tn.kinetostatics(best.line, 100.0).irregularity < 1e-8
    assert best.aim_before[0] == pytest.approx(tn.kinetostatics(line, 100.0).irregularity, rel=1e-6)
    assert tn.phase_forks(line).offsets["Shaft 2"] == pytest.approx(best.values["Shaft 2.fork_offset"], abs=1e-6)


def test_angle_and_phase_together():
    line = joints([0.3, 0.2], [1.0, 0.0])
    free = {"Shaft 2.fork_offset": (-1.2, 1.3), "HookeJoint 2.angle": ("5 deg", "40 deg")}
    best = tn.optimise(line, free, "irregularity", designs=150)
    assert best.aim[0] < 1e-9
    assert list(best.values.values()) == pytest.approx([0.0, 0.3], abs=1e-8)


@pytest.mark.parametrize("angles", [(4.0, 4.0, 5.0), (3.0, 3.0, 3.0), (2.0, 3.0, 3.5)])
def test_three_joints_in_space_close_their_phasors(angles):
    """Small angles: Σ β² e^{2jχ} = 0 where the squares satisfy the triangle inequality."""
    small = np.deg2rad(angles)
    line = joints(small, [0.0, 0.0, 0.0], [0.0, 0.3, -0.2])
    free = {"Shaft 2.fork_offset": (-1.57, 1.57), "HookeJoint 3.plane": (-1.57, 1.57)}
    best = tn.optimise(line, free, "irregularity", designs=150)
    assert best.aim[0] < 1e-8
    # Input angles of the joints from their own planes at one instant, by the convention of the forks.
    turned = np.cumsum([0.0, np.pi / 2 + best.values["Shaft 2.fork_offset"] - 0.3,
                        np.pi / 2 + 0.0 - best.values["HookeJoint 3.plane"]])  # fmt: skip
    closed = np.sum(small**2 * np.exp(2j * turned))
    assert abs(closed) < 10 * np.max(small) ** 2 * np.sum(small**2)
    assert abs(np.sum(small**2 * np.exp(2j * (turned + [0.0, 0.0, 0.2])))) > 0.1 * np.min(small) ** 2


def test_one_joint_that_outweighs_the_others_leaves_the_rest():
    angles = np.deg2rad([5.0, 2.0, 2.0])
    free = {"Shaft 2.fork_offset": (-1.57, 1.57), "Shaft 3.fork_offset": (-1.57, 1.57)}
    best = tn.optimise(joints(angles, [0.4, 0.2, 0.0]), free, "irregularity", designs=150)
    left = angles[0] ** 2 - angles[1] ** 2 - angles[2] ** 2
    assert best.aim[0] == pytest.approx(left, rel=0.02)
    assert best.aim[0] == pytest.approx(tn.phase_forks(best.line).irregularity, rel=1e-6)


MU, K, J, T = 0.05, 1e4, 1.0, 10.0
W = np.sqrt(K / J)


def damped():
    parts = [
        tn.ConstantSpeed(), tn.Shaft(stiffness=K, name="spring"),
        tn.Disk(inertia=J, excitation=[{"order": 1, "amplitude": T}], name="main"),
        tn.Shaft(stiffness=0.8 * MU * K, damping=0.1, name="absorber"), tn.Disk(inertia=MU * J, name="mass"),
    ]  # fmt: skip
    return tn.Driveline(parts)


FREE = {"absorber.stiffness": (0.5 * MU * K, 1.5 * MU * K), "absorber.damping": (0.05, 10.0)}


def written_out(stiffness, damping):
    """Largest torque of the main spring by the two equations of the damper."""
    w = np.linspace(0.6, 1.4, 4001) * W
    pull = stiffness + 1j * w * damping
    x = T / (K - J * w**2 - pull * MU * J * w**2 / (pull - MU * J * w**2))
    return float(np.abs(x).max() * K)


@pytest.mark.slow
def test_den_hartogs_damper():
    best = tn.optimise(damped(), FREE, "peak torque of spring", (0.6 * W, 1.4 * W), checks=False, designs=200)
    stiffness, damping = best.values.values()
    tuning, ratio = np.sqrt(stiffness / (MU * J)) / W, damping / (2 * MU * J * W)
    assert tuning == pytest.approx(1 / (1 + MU), rel=1e-3)
    assert ratio == pytest.approx(np.sqrt(3 * MU / (8 * (1 + MU) ** 3)), rel=5e-3)  # his mean of two values
    assert best.aim[0] == pytest.approx(T * np.sqrt(1 + 2 / MU), rel=1e-3)  # the height of the two fixed points
    assert best.aim[0] == pytest.approx(written_out(stiffness, damping), rel=1e-5)
    start = np.log([stiffness * 1.02, damping * 0.95])
    exact = minimize(lambda p: written_out(*np.exp(p)), start, method="Nelder-Mead",
                     options={"xatol": 1e-9, "fatol": 1e-11, "maxfev": 2000})  # fmt: skip
    assert best.aim[0] == pytest.approx(exact.fun, rel=1e-5)


@pytest.mark.slow
def test_a_load_case_that_binds_only_where_the_search_ends_is_taken_in(monkeypatch):
    cases = [tn.LoadCase(name="light", loads={"main": 1.0}), tn.LoadCase(name="heavy", loads={"main": 30.0})]
    line = tn.Driveline(damped().elements, operation=tn.Operation(load_cases=cases))
    free, span = {"absorber.damping": (0.5, 10.0)}, (0.6 * W, 1.4 * W)
    tried = []
    near_cases = DesignProblem.near_cases

    def light_alone(question, line, *few):
        """Where the search begins, on a few points; where it ends, what is true."""
        tried.append(bool(few))
        return frozenset({"light"}) if few else near_cases(question, line)

    monkeypatch.setattr(DesignProblem, "near_cases", light_alone)
    best = tn.optimise(line, free, "peak torque of spring", span, checks=False, designs=20)
    peaks = {name: tn.order_response(best.line.with_load(name), np.linspace(*span, 2001)).peak_torque[:, 0].max()
             for name in ("light", "heavy")}  # fmt: skip
    assert tried[0] and not tried[-1] and peaks["heavy"] > 28.0 + peaks["light"]
    assert best.aim[0] == pytest.approx(peaks["heavy"], rel=1e-4)


@pytest.mark.slow
def test_two_aims_that_conflict_give_a_front():
    aims = ["peak torque of spring", "peak torque of absorber"]
    found = tn.optimise(damped(), FREE, aims, (0.6 * W, 1.4 * W), checks=False, designs=60)
    assert len(found.front) >= 4 and np.all(np.diff(found.front[:, 0]) > 0) and np.all(np.diff(found.front[:, 1]) < 0)
    for values, aim in zip(found.front_value, found.front, strict=True):
        assert aim[0] == pytest.approx(written_out(*values), rel=1e-5)
    assert found.plot().get_xlabel() == "peak torque of spring [N m]"
    assert "the aims conflict" in str(found)


def cost(line):
    return abs(line.elements[line.index("Shaft 2")].fork_offset - 0.5)


@pytest.mark.slow
def test_two_aims_over_phases():
    line = joints([0.35, 0.35], [1.0, 0.0])
    free = {"Shaft 2.fork_offset": (-1.0, 1.4)}
    found = tn.optimise(line, free, ["irregularity", cost], designs=60)
    assert 5 <= len(found.front) <= 21
    assert found.front_value.min() >= -1e-9 and found.front_value.max() <= 0.5 + 1e-9  # between the two best ones
    agreed = tn.optimise(line, free, ["irregularity", lambda one: cost(one.replace("Shaft 2", fork_offset=0.5))])
    assert len(agreed.front) == 1 and "the aims do not conflict" in str(agreed)


def test_what_violates_less_goes_before_what_violates_more():
    """The rule of the search by itself: the aim falls with the offset, of which no more than 0.3 is allowed."""

    class Limited:
        aims = (Aim("offset", "rad", largest=True),)

        def answer(self, line, points=0):
            offset = line.elements[line.index("Shaft 2")].fork_offset
            return DesignEvaluation((offset,), max(0.0, offset - 0.3), ("limit",) if offset > 0.3 else ())

    line = joints([0.3, 0.2], [1.0, 0.0])
    for low, best in ((-1.0, 0.3), (0.5, 0.5)):  # where nothing is allowed, the least of all
        search = DesignSearch(Space(assemble(line), {"Shaft 2.fork_offset": (low, 1.2)}), Limited(), 60, 0, None)
        found = search.best(first)
        assert search.space.values(found.shares)[0] == pytest.approx(best, abs=1e-6)
        assert bool(found.answer.violation) == (low > 0.3)


@pytest.mark.slow
def test_a_limit_bounds_the_design():
    """The smallest damping at which the spring bears its torque, where the equations of the damper say."""
    line = tn.Driveline(damped().elements, limits=[tn.Limit(of="spring", max_torque=100.0)])
    line = line.replace("absorber", stiffness=MU * K / (1 + MU) ** 2)

    def damping(one):
        return one.elements[one.index("absorber")].damping

    best = tn.optimise(line, {"absorber.damping": (0.05, 10.0)}, damping, (0.8 * W, 1.2 * W), designs=20)
    assert not best.broken and 0 <= best.assessment.check("max torque of spring").margin < 1e-4
    assert written_out(MU * K / (1 + MU) ** 2, best.aim[0]) == pytest.approx(100.0, rel=2e-3)
    assert best.aim[0] == best.value[0] > 0.1


@pytest.mark.slow
def test_checks_that_must_hold_bound_the_design():
    """The largest angle of the second joint at which the line still runs evenly enough."""
    line = joints([0.1, 0.08], [0.0, 0.0])

    def smallness(one):
        return -one.elements[one.index("HookeJoint 2")].angle

    free = {"HookeJoint 2.angle": (0.05, 0.3)}
    loose = tn.optimise(line, free, smallness, (20.0, 20.5), checks=(), designs=20)
    assert loose.values["HookeJoint 2.angle"] == pytest.approx(0.3)
    assert any("stands at its largest bound" in f.sentence for f in loose.findings)
    held = tn.optimise(line, free, smallness, (20.0, 20.5), checks=["uniformity"], designs=20)
    margin = held.assessment.check("uniformity").margin
    assert 0 <= margin < 1e-4 and not held.broken and 0.1 < held.value[0] < 0.13
    never = tn.optimise(
        line, {"HookeJoint 2.angle": (0.2, 0.3)}, smallness, (20.0, 20.5), checks="uniformity", designs=20
    )
    assert never.broken == ("uniformity",) and never.value[0] == pytest.approx(0.2, abs=1e-6)
    assert "No design within the bounds was found that satisfies uniformity" in str(never)


@pytest.mark.slow
def test_margins_are_aims():
    line = joints([0.1, 0.08], [0.3, 0.0])
    best = tn.optimise(line, {"Shaft 2.fork_offset": (-0.5, 0.5)}, "margin of uniformity", (20.0, 20.5), designs=20)
    assert best.largest == (True,) and best.aim[0] > best.aim_before[0]
    assert best.values["Shaft 2.fork_offset"] == pytest.approx(0.0, abs=1e-4)
    assert best.aim[0] == best.assessment.check("uniformity").margin


def test_the_same_seed_gives_the_same_design(tmp_path):
    line = joints([0.3, 0.2, 0.25], [1.0, 0.0, 0.0])
    free = {"Shaft 2.fork_offset": (-1.5, 1.5), "Shaft 3.fork_offset": (-1.5, 1.5)}
    one, two, other = (tn.optimise(line, free, "irregularity", designs=40, seed=s) for s in (3, 3, 4))
    assert np.array_equal(one.value, two.value) and one.designs == two.designs
    assert not np.array_equal(one.value, other.value)
    assert "\n" not in repr(one) and str(one).startswith("irregularity ")
    save_dataset(one.data.assign_attrs(format="o"), tmp_path / "o.nc")
    assert read_dataset(tmp_path / "o.nc", "o")["value"].values == pytest.approx(one.value)
    assert json.loads(one.to_json())["seed"] == 3
    assert one.plot().get_title(loc="left").startswith("irregularity: ")
