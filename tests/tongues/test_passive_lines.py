"""Lines of which nothing varies with the angle: nothing grows unless something feeds energy in, against eigenvalues of
matrices written down here."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn

INERTIA, STIFFNESS, DAMPING = [0.5, 0.1, 0.1, 0.3, 2.0, 0.2], [8e4, 9e4, 9e4, 2e4, 5e4], [3.0, 1.0, 0.5, 20.0, 2.0]
SPEEDS = (40.0, 120.0)


def parts(*, held: bool = True, angle: float | None = None, **of_last: object) -> list[tn.Element]:
    """Six disks, held at the input or free, a joint before the last shaft where there is an ``angle``."""
    found: list[tn.Element] = [tn.ConstantSpeed(), tn.Shaft(name="root", stiffness=3e4, damping=1.0)] if held else []
    for k, inertia in enumerate(INERTIA):
        share = {"drive_share": 1.0} if not held and k == 0 else {}
        last = of_last if k == len(INERTIA) - 1 else {}
        found.append(tn.Disk(name=f"disk {k}", inertia=inertia, **share, **last))
        if k == 4 and angle is not None:
            found.append(tn.HookeJoint(name="joint", angle=angle))
        if k < len(STIFFNESS):
            found.append(tn.Shaft(name=f"shaft {k}", stiffness=STIFFNESS[k], damping=DAMPING[k]))
    return found


def largest_decay(inertia: float, slope: float) -> float:
    """Largest real part [1/s] of eigenvalues of the held line with a first disk of ``inertia`` and a load at the last
    that rises by ``slope`` [N m s/rad] with its speed."""
    n = len(INERTIA)
    mass = np.diag([inertia, *INERTIA[1:]])
    k, c = np.zeros((n, n)), np.zeros((n, n))
    k[0, 0], c[0, 0], c[-1, -1] = 3e4, 1.0, slope
    for i, (stiffness, damping) in enumerate(zip(STIFFNESS, DAMPING, strict=True)):
        for matrix, value in ((k, stiffness), (c, damping)):
            matrix[i : i + 2, i : i + 2] += value * np.array([[1.0, -1.0], [-1.0, 1.0]])
    a = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(mass, k), -np.linalg.solve(mass, c)]])
    return float(np.linalg.eigvals(a).real.max())


@pytest.mark.parametrize("held", [True, False])
def test_nothing_grows_of_long_lines_that_nothing_feeds(held: bool) -> None:
    line = tn.Driveline(parts(held=held, quadratic_load=0.02))
    box = ("disk 0.inertia", 0.2, 1.0)
    for found in (
        tn.tongues(line, ("speed", *SPEEDS), box),
        tn.tongues(line, box, ("shaft 3.stiffness", 1e4, 1e5), speed=80.0),
    ):
        assert len(found.tongues) == 0 and found.complete and not found.unknown
        assert "nothing feeds energy into it" in found.search
        assert len(found.find(found.y_range[0])) == 0
    windows = tn.stable_windows(line, *box, SPEEDS)
    assert windows.windows.tolist() == [[0.2, 1.0]] and windows.complete
    assert windows.sentence.endswith("as nothing can grow.")
    limit = tn.stable_limit(line, "disk 0.inertia", [50.0, 100.0], low=0.2, high=1.0)
    assert limit.complete and "nothing feeds energy into it" in limit.search
    assert limit.limit.tolist() == [1.0, 1.0] and not any(len(one) for one in limit.unstable)
    for inertia in (0.2, 0.55, 1.0):
        assert largest_decay(inertia, 2 * 0.02 * 40.0) < 0
        at = tn.stability(line.replace("disk 0", inertia=inertia), 77.0)
        assert at.verdict.name == "STABLE"


@pytest.mark.parametrize(("slope", "grows"), [(-6.0, True), (6.0, False)])
def test_a_load_that_falls_with_the_speed_is_searched(slope: float, grows: bool) -> None:
    assert (largest_decay(INERTIA[0], slope) > 0) == grows
    curve = [{"speed": 0.0, "torque": 900.0}, {"speed": 150.0, "torque": 900.0 + 150.0 * slope}]
    line = tn.Driveline([*parts()[:-1], tn.Fan(name="fan", inertia=INERTIA[-1], curve=curve)])
    found = tn.tongues(line, ("speed", 60.0, 100.0), ("shaft 3.stiffness", 1.9e4, 2.1e4), rows=3)
    assert ("nothing feeds energy into it" in found.search) != grows
    # No region of resonance: the whole box grows, as its eigenvalues do.
    assert [one.tolist() for one in found.find(2e4)] == ([[60.0, 100.0]] if grows else [])


def test_an_angle_that_only_the_box_has_is_searched() -> None:
    line = tn.Driveline(parts(angle=0.0))
    straight = tn.tongues(line, ("speed", *SPEEDS), ("disk 0.inertia", 0.2, 1.0), rows=3)
    assert "nothing feeds energy into it" in straight.search
    bent = tn.tongues(line, ("speed", 95.0, 115.0), ("joint.angle", 0.0, 0.6), rows=3)
    assert "nothing feeds energy into it" not in bent.search
