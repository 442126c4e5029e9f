"""Regions reached from resonances, of lines of more than three unknowns: against averaging, rows and ``stability``."""

from __future__ import annotations

import numpy as np
import pytest
from long_lines import Small, long_line

import trunnion as tn
from trunnion.floquet.tongues.from_resonances import TrackedResonances, followed
from trunnion.floquet.tongues.naming import eigenvalues
from trunnion.floquet.tongues.region import patched, unpatched
from trunnion.floquet.tongues.rows import BY_RESONANCES, BY_ROWS, TongueRow, looked_at, unstable_intervals
from trunnion.floquet.tongues.tongues import PATCH_TOLERANCE, task_of


def paths(
    line: tn.Driveline, low: float, high: float, angles: tuple[float, float], *, patch: bool = False
) -> TrackedResonances:
    """All resonances of a line followed over angles of all joints."""
    task = task_of(line, ("speed", low, high), ("HookeJoint *.angle", *angles), None, True, "tongues")
    box = task.family, task.x.values, task.y.values
    region = patched(*box, PATCH_TOLERANCE, 2, lambda share: None) if patch else unpatched(*box, 2)
    found = followed(region)
    assert found is not None
    return found


def alone(found: TrackedResonances, angle: float) -> tuple[np.ndarray, TongueRow]:
    """What resonances alone lead to at an angle: intervals of speed, and the row."""
    v = float(found.region.family.to_patch(np.array([angle]), False)[0])
    none = np.zeros(0)
    empty = TongueRow(
        v, none, none, none, none.astype(np.int8), np.zeros((0, 2), bool), np.zeros((0, 2)), none.astype(np.int8), ()
    )
    _, ends, opened = found.stretches(v)
    (row,) = looked_at(found.region, [empty], [ends[opened]])
    return found.region.in_x(row.low, row.high), row


def bent(line: tn.Driveline, angle: float) -> tn.Driveline:
    return line.replace_all({f"HookeJoint {k}": {"angle": angle} for k in (1, 2)})


@pytest.mark.parametrize(
    ("seed", "shafts"),
    [
        (1, 5),
        pytest.param(1, 7, marks=pytest.mark.slow),
        pytest.param(4, 8, marks=pytest.mark.slow),
        pytest.param(2, 8, marks=pytest.mark.slow),
    ],
)
def test_every_pair_of_modes_opens_its_region(seed: int, shafts: int) -> None:
    """Undamped: at (ωᵢ + ωⱼ)/2, as wide as averaging says, widths as β²; unstable inside, stable beside."""
    line, theory = long_line(seed, shafts, 0.0), Small(seed, shafts)
    low, high = 0.9 * theory.omega[0], 0.8 * theory.omega[-1]
    found = paths(line, low, high, (0.015, 0.05))
    assert found.lost == 0
    widths = []
    for angle in (0.02, 0.04):
        intervals, _ = alone(found, angle)
        own = []
        for i in range(shafts):
            for j in range(i, shafts):
                x = (theory.omega[i] + theory.omega[j]) / 2
                if low * 1.001 < x < high * 0.999:
                    near = np.abs(intervals - x).max(axis=1).argmin()
                    assert np.abs(intervals[near] - x).max() < angle**2 * x, (i, j)
                    own.append((np.ptp(intervals[near]), theory.width(i, j, angle)))
        widths.append(own)
        middle, reach = intervals.mean(axis=1), np.ptp(intervals, axis=1)
        for k in np.linspace(0, len(intervals) - 1, 6).astype(int):
            changed = bent(line, angle)
            assert tn.stability(changed, float(middle[k]), tolerance=1e-13).spectral_radius > 1 + 1e-9
            for x in (middle[k] - 0.51 * reach[k], middle[k] + 0.51 * reach[k]):
                clear = (np.abs(middle - x) > 0.5 * reach).all()
                assert not clear or tn.stability(changed, float(x), tolerance=1e-13).spectral_radius < 1 + 1e-9
    first, second = np.array(widths[0]), np.array(widths[1])
    assert len(first) >= 2 * shafts
    assert first[:, 0] == pytest.approx(first[:, 1], rel=0.02) and second[:, 0] / first[:, 0] == pytest.approx(
        4, rel=5e-3
    )


@pytest.mark.parametrize("damping", [0.0, 1e-6])
def test_rows_and_resonances_agree(damping: float) -> None:
    """Regions of one are those of the other, edge for edge; stable between and beside them."""
    found = paths(long_line(0, 4, damping), 220.0, 300.0, (0.1, 0.2), patch=True)
    by_resonances, _ = alone(found, 0.17)
    v = found.region.family.to_patch(np.array([0.17]), False)
    (row,) = unstable_intervals(found.region, v)
    (both,) = found.rows(v)
    assert len(row) >= 2 and np.all(both.by == BY_ROWS | BY_RESONANCES)
    assert by_resonances == pytest.approx(found.region.in_x(row.low, row.high), rel=1e-9)


def test_what_rows_miss_is_added(monkeypatch: pytest.MonkeyPatch) -> None:
    from dataclasses import replace

    from trunnion.floquet.tongues import from_resonances

    def one_missed(region, v):  # type: ignore[no-untyped-def]
        rows = unstable_intervals(region, v)
        keep = [{k: getattr(r, k)[1:] for k in ("low", "high", "inside", "kind", "clipped", "by", "of")} for r in rows]
        return [replace(r, **part) for r, part in zip(rows, keep, strict=True)]

    found = paths(long_line(0, 4, 0.0), 220.0, 300.0, (0.1, 0.2), patch=True)
    v = found.region.family.to_patch(np.array([0.12, 0.17]), False)
    whole = found.rows(v)
    monkeypatch.setattr(from_resonances, "unstable_intervals", one_missed)
    for row, full in zip(found.rows(v), whole, strict=True):
        assert row.by[0] == BY_RESONANCES and len(row) == len(full)
        assert row.low == pytest.approx(full.low, rel=1e-9) and row.high == pytest.approx(full.high, rel=1e-9)


def test_intervals_of_one_resonance_are_one_tongue() -> None:
    """Undamped regions are far narrower than they move from row to row: no row is put between, and each has a name."""
    line = long_line(0, 4, 0.0)
    found = tn.tongues(line, ("speed", 200.0, 320.0), ("HookeJoint *.angle", 0.05, 0.25), rows=4)
    assert found.rows == 4
    named = [t.name for t in found if len(t.y) == 4]
    assert len(named) == len(set(named)) >= 6 and None not in named
    assert len(named) >= len(found) - 2
    assert "followed up the box" in found.search and "from the resonances alone" in found.search


def test_what_was_not_followed_is_said() -> None:
    line = long_line(0, 4, 0.0)
    found = tn.tongues(
        line, ("factor of Shaft *.stiffness", 0.99, 1.01), ("HookeJoint *.angle", 0.05, 0.1), speed=250.0, rows=3
    )
    assert "resonances were not followed, as x is not a speed" in found.search and not found.complete


@pytest.mark.slow
def test_families_of_ones_own_have_no_resonances_to_follow() -> None:
    def coupled(tau, a, q):  # type: ignore[no-untyped-def]
        own = np.asarray(a)[..., None, None] * np.diag([1.0, 0.0, 0.0, 0.0]) + np.diag([0.0, 2.3, 3.1, 4.7])
        return np.eye(4), 1e-3 * np.eye(4), own + (q * np.cos(2 * tau))[..., None, None] * np.ones((4, 4))

    family = tn.PeriodicLinearFamily(np.pi, coupled, 4, {"a": 1.0, "q": 0.2})
    own = tn.tongues(family, ("a", 0.8, 1.2), ("q", 0.1, 0.2), rows=3)
    assert "a family of your own has no straight line" in own.search


def test_matrices_that_cannot_be_computed_stop_nothing() -> None:
    """As of very heavy damping: the modes of such a point are lost, those of its neighbours are not."""
    good = np.diag([2.0, 0.5])
    assert eigenvalues(np.stack([good, np.full((2, 2), np.nan)])) == pytest.approx(np.array([[2.0, 0.5], [1.0, 1.0]]))


@pytest.mark.slow
def test_damping_up_to_where_nothing_can_be_integrated() -> None:
    line = bent(long_line(0, 4, 1e-5), 0.5)
    damping = tn.minimum_damping(line, speeds=(200.0, 220.0), maximum=2000.0, rows=3)
    assert damping.windows[-1][1] == 2000.0
