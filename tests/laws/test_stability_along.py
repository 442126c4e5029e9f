"""Stability at many speeds at once against one speed at a time, which integrates otherwise."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.floquet.stability.stability_over_speed import SpeedBySpeedError, stability_along, straight_decay
from trunnion.numerics.chain.exponential_monodromy import exponential, exponential_monodromies
from trunnion.results.verdict import Verdict
from trunnion.steady.free.free_balance import FreeBalance
from trunnion.steady.free.periodic_steady_states import SteadyStatesBySpeed


def test_the_exponential_is_that_of_scipy():
    rng = np.random.default_rng(3)
    matrices = rng.normal(size=(20, 5, 5)) * np.logspace(-3, 1, 20)[:, None, None]
    for one, computed in zip(matrices, exponential(matrices), strict=True):
        assert np.allclose(computed, expm(one), rtol=1e-12, atol=1e-12 * np.abs(expm(one)).max())


def test_mathieu_monodromy_and_the_error_said_of_it():
    a, q = np.array([0.5, 1.0, 2.3]), np.array([0.3, 0.4, 0.1])

    def rates(which, tau):
        out = np.zeros((len(which), len(tau), 2, 2))
        out[..., 0, 1] = 1.0
        out[..., 1, 0] = -(a[which, None] - 2 * q[which, None] * np.cos(2 * tau))
        out[..., 1, 1] = -0.02
        return out

    found = exponential_monodromies(rates, 3, 2, np.pi, tolerance=1e-9)
    for i in range(3):
        run = [
            solve_ivp(lambda t, x, i=i: rates(np.array([i]), np.array([t]))[0, 0] @ x, (0, np.pi), e,
                      rtol=1e-12, atol=1e-13).y[:, -1]
            for e in np.eye(2)
        ]  # fmt: skip
        truth = np.abs(np.linalg.eigvals(np.array(run).T)).max()
        assert abs(found.radius[i] - truth) <= found.error[i] + 1e-10
    assert found.radius[1] > 1 + found.error[1]  # in the first tongue


def _agrees(line, speeds):
    along = stability_along(assemble(line), speeds)
    for i, speed in enumerate(speeds):
        alone = tn.stability(line, float(speed))
        if alone.speed_sentence:
            assert "nan" not in alone.speed_sentence
        assert along.radius[i] == pytest.approx(alone.spectral_radius, abs=along.error[i] + alone.error_estimate)
        assert Verdict(int(along.verdict[i])) is alone.verdict
        assert along.error[i] < 1e-6 + 2e-3 * abs(1 - along.radius[i])
    return along


def shaft(stiffness, damping, **more):
    return tn.Shaft(stiffness=stiffness, damping=damping, **more)


def disk(inertia, **more):
    return tn.Disk(inertia=inertia, **more)


def joint(angle):
    return tn.HookeJoint(angle=angle)


def _joints(angle, damping=1.0, **load):
    return tn.Driveline([
        tn.ConstantSpeed(), shaft(1e4, damping), disk(1.0), joint(np.deg2rad(angle)),
        shaft(2e4, damping, fork_offset=np.pi / 2), disk(0.5), joint(np.deg2rad(angle)),
        shaft(2e6, damping), disk(0.3, **load),
    ])  # fmt: skip


def test_driven_lines_stable_unstable_undamped_and_loaded():
    speeds = np.array([60.0, 91.3, 139.7, 164.2, 201.0])
    assert Verdict.UNSTABLE in _agrees(_joints(30, 0.3), np.array([60.0, 101.0, 139.7, 146.0, 201.0])).verdict
    _agrees(_joints(12), speeds)
    _agrees(_joints(12, load_torque=300.0, quadratic_load=0.01), speeds)
    along = stability_along(assemble(_joints(5, 0.0)), speeds)
    assert set(along.verdict) <= {int(Verdict.MARGINAL), int(Verdict.UNSTABLE)}


def test_varying_meshes_of_driven_and_free_lines():
    mesh = tn.GearPair(
        teeth_in=25, teeth_out=40, module=0.003, mesh_stiffness=1e8, mesh_damping=500.0,
        stiffness_variation=[{"share": 0.2}],
    )  # fmt: skip
    driven = [tn.ConstantSpeed(), shaft(1e5, 1.0), disk(0.01), mesh, disk(0.02, load_torque=100.0), shaft(2e4, 1.0)]
    found = _agrees(tn.Driveline([*driven, disk(0.05)]), np.array([200.0, 466.3]))
    assert found.verdict[1] == Verdict.UNSTABLE
    free = [disk(0.1), shaft(1e5, 1.0), disk(0.01), mesh, disk(0.02), shaft(2e4, 1.0), disk(0.05)]
    _agrees(tn.Driveline(free), np.array([210.0, 330.0]))


@pytest.mark.parametrize("load", [{"load_torque": 50.0}, {"quadratic_load": 0.01, "viscous_load": 0.1}])
def test_free_bent_lines_about_their_own_motions(load):
    line = tn.Driveline([
        disk(0.4, drive_share=1), shaft(8e3, 4.0), disk(0.05), joint(np.deg2rad(14)),
        shaft(5e3, 2.0), disk(0.1), joint(np.deg2rad(9)), shaft(6e4, 4.0), disk(0.3, **load),
    ])  # fmt: skip
    _agrees(line, np.array([60.0, 87.0, 150.0]))


def test_motions_that_are_known_give_the_same_whatever_was_asked_before():
    """Multipliers about motions solved for other speeds first, with more harmonics, are those solved anew."""
    line = tn.Driveline([
        disk(0.4, drive_share=1), shaft(8e3, 4.0), disk(0.05), joint(0.3), shaft(5e3, 2.0), disk(0.1), joint(0.2),
        shaft(6e4, 4.0), disk(0.3, load_torque=50.0),
    ])  # fmt: skip
    assembly, speeds = assemble(line), np.array([60.0, 87.0, 150.0])
    solved = SteadyStatesBySpeed(line)
    for speed in (150.0, 3.0, 61.0):
        solved.at_all(np.array([speed]))
    together = solved.at_all(np.array([3.0, 61.0, 150.0]))
    assert len({one.rows.shape for one in solved.known.values()}) > 1
    known, anew = stability_along(assembly, speeds, motions=solved), stability_along(assembly, speeds)
    assert set(solved.known) == {3.0, 60.0, 61.0, 87.0, 150.0} and together.found.all() and together.resolved.all()
    assert known.critical == pytest.approx(anew.critical, rel=1e-7)
    assert known.verdict.tolist() == anew.verdict.tolist()


def test_an_assessment_solves_every_own_motion_once(monkeypatch):
    asked = []
    solve = FreeBalance.solve

    def counted(balance, speed, h, guess=None):
        asked.extend((one, h) for one in speed.tolist())
        return solve(balance, speed, h, guess)

    monkeypatch.setattr(FreeBalance, "solve", counted)
    line = tn.Driveline([
        disk(0.4, drive_share=1, excitation=[{"order": 2, "amplitude": 5.0}]), shaft(8e3, 4.0), disk(0.05), joint(0.1),
        shaft(5e3, 2.0), disk(0.3, load_torque=50.0),
    ])  # fmt: skip
    check = tn.assess(line, (80.0, 80.0)).check("parametric stability")
    assert str(check.status) == "satisfied"
    assert len(asked) == len(set(asked)) > 0


def test_free_lines_with_play_have_no_shared_motion():
    play = tn.GearPair(teeth_in=20, teeth_out=31, module=0.003, mesh_stiffness=1e7, backlash=1e-4)
    line = tn.Driveline([
        disk(0.4, drive_share=1), shaft(8e3, 4.0), disk(0.05), joint(0.2), shaft(5e3, 2.0),
        disk(0.1), play, disk(0.3, load_torque=20.0),
    ])  # fmt: skip
    with pytest.raises(SpeedBySpeedError, match="stages or play"):
        stability_along(assemble(line), [100.0])


def test_the_slowest_decay_of_the_straight_line_counts_what_does_not_oscillate():
    """J₁ v₁′ = −c (v₁ − v₂), J₂ v₂′ = c (v₁ − v₂) − 2 q v₂ about Ω: overdamped and the speed itself."""
    j1, j2, q, speed = 0.5, 2.0, 0.02, 100.0
    line = tn.Driveline([disk(j1, drive_share=1), shaft(1.0, 50.0), disk(j2, quadratic_load=q)])
    rigid = 2 * q * speed / (j1 + j2)
    slow = 1.0 / 50.0  # k/c, the creep of the damper
    assert straight_decay(assemble(line), speed) == pytest.approx(min(rigid, slow), rel=0.2)
