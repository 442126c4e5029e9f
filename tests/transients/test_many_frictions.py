"""Many disks that friction keeps at rest, with clutches between them, all judged at one moment: against accelerations
by Gauss's principle, found torque by torque in turn."""

from __future__ import annotations

import numpy as np

import trunnion as tn

SOON = 0.01


def accelerations(inertia: np.ndarray, pushed: np.ndarray, rubs: np.ndarray, carries: np.ndarray) -> np.ndarray:
    """Of disks in a row (n,): each friction and each clutch in turn takes what brings its own motion to nothing, within
    what it bears, until nothing changes."""
    n = len(inertia)
    between = np.zeros((n - 1, n))
    between[np.arange(n - 1), np.arange(n - 1)], between[np.arange(n - 1), np.arange(1, n)] = -1.0, 1.0
    rows, most = np.vstack([np.eye(n), between]), np.concatenate([rubs, carries])
    torque, felt = np.zeros(len(rows)), (rows**2) @ (1 / inertia)
    for _ in range(100_000):
        before = torque.copy()
        for k, row in enumerate(rows):
            moves = row @ ((pushed - rows.T @ torque) / inertia)
            torque[k] = np.clip(torque[k] + moves / felt[k], -most[k], most[k])
        if np.abs(torque - before).max() < 1e-14:
            break
    return (pushed - rows.T @ torque) / inertia


def row(inertia: np.ndarray, carries: np.ndarray) -> tn.Driveline:
    """Disks with clutches between them; a soft shaft to a last disk, since something has to twist."""
    elements: list[tn.Element] = []
    for i, one in enumerate(inertia):
        elements.append(tn.Disk(name=f"disk {i}", inertia=float(one)))
        if i < len(carries):
            elements.append(tn.SlipClutch(name=f"clutch {i}", torque=float(carries[i])))
    return tn.Driveline([*elements, tn.Shaft(stiffness=1e-4), tn.Disk(name="end", inertia=1.0)])


def test_five_disks_and_four_clutches_at_rest() -> None:
    moved = stood = 0
    for seed in range(8):
        rng = np.random.default_rng(seed)
        inertia, carries = rng.uniform(0.3, 3, 5), rng.uniform(2, 20, 4)
        rubs = rng.uniform(0.5, 12, 5) * (rng.random(5) < 0.9)
        pushed = rng.uniform(-40, 40, 5) * (rng.random(5) < 0.6)
        act = [
            tn.AppliedTorque(on=f"disk {i}", time=[0.0], torque=[t], between="steps") for i, t in enumerate(pushed) if t
        ]
        friction = [tn.FrictionTorque(on=f"disk {i}", torque=t) for i, t in enumerate(rubs) if t]
        run = tn.transient(row(inertia, carries), SOON, torque=act, friction=friction, speed=0.0)
        known = accelerations(inertia, pushed, rubs, carries)
        assert run.outcome.kind == "reached", run.outcome
        np.testing.assert_allclose(run.speed[-1][:5], known * SOON, rtol=1e-6, atol=1e-9)
        moved += int((np.abs(known) > 1e-9).sum())
        stood += int((np.abs(known) < 1e-9).sum())
    assert moved > 8 and stood > 8


def test_a_neighbour_holds_what_its_own_friction_does_not() -> None:
    """15 N m on a disk whose friction bears 12: its clutch takes the rest to the one beside it, which stands; beyond
    both frictions together they set off as one, with less beyond the clutch it goes alone."""
    inertia, two = np.array([1.0, 2.0]), [tn.FrictionTorque(on=f"disk {i}", torque=12.0) for i in (0, 1)]

    def run(carries: float, pushed: float) -> tn.Transient:
        act = [tn.AppliedTorque(on="disk 0", time=[0.0], torque=[pushed], between="steps")]
        return tn.transient(row(inertia, np.array([carries])), 0.5, torque=act, friction=two, speed=0.0)

    assert np.abs(run(20.0, 15.0).speed).max() < 1e-12
    alone = run(2.0, 20.0).speed[-1]
    assert abs(alone[0] - 0.5 * 6.0) < 1e-9
    assert abs(alone[1]) < 1e-12
    assert run(20.0, 30.0).speed[-1][0] > 0.2
