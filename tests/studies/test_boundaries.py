"""Points go where the answer changes: the boundary is the one known in closed form, within its error, and nothing that
a grid as fine everywhere would show is missed or added."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from studies.asked import data_of
from studies.asked import line as two_shafts
from studies.test_store import FailingDisk, Killed, computed, quick

import trunnion as tn
from trunnion.pictures.boundaries import boundary as picture
from trunnion.pictures.draw_matplotlib import draw
from trunnion.pictures.picture import Cells, Level, Line
from trunnion.studies.design import StudyAxis, StudyDesign
from trunnion.studies.exports import export
from trunnion.studies.points import FAILED, StudyQuestion
from trunnion.studies.refinement import ABOVE, BELOW, KnownSides, Lattice, next_points
from trunnion.studies.store import Store

STIFFNESS, INERTIA = "Shaft 1.stiffness", "Disk 1.inertia"
LEVEL = 1.07
"""Natural frequency [rad/s] of the boundary k = LEVEL² J."""


def line() -> tn.Driveline:
    """One shaft with one disk: ω² = k/J."""
    return tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1.0), tn.Disk(inertia=1.0)])


def grid(path: str, points: int, low: float = 0.5, high: float = 2.0, **more: Any) -> dict[str, Any]:
    return {"path": path, "low": low, "high": high, "points": points, **more}


def asked(store: Path, halvings: int = 5, **more: Any) -> dict[str, Any]:
    """Stiffness and inertia at which the natural frequency is ``LEVEL``."""
    study = {
        "line": "", "analysis": "natural_frequencies", "quantities": ["frequency[0]"], "store": str(store),
        "parameter": [grid(STIFFNESS, 7), grid(INERTIA, 9)], "block": 64,
        "boundary": {"quantity": "frequency[0]", "level": LEVEL, "halvings": halvings},
    }  # fmt: skip
    return {**study, **more}


@pytest.fixture(scope="module")
def known(tmp_path_factory: pytest.TempPathFactory) -> Any:
    store = tmp_path_factory.mktemp("boundary") / "a.zarr"
    return tn.study(asked(store), line=line(), workers=0)


def test_the_boundary_is_the_one_in_closed_form(known) -> None:
    """Along both parameters, at values of the grid and between them, and its share of the grid."""
    found = tn.study_boundary(known)
    assert found.whole and found.error == pytest.approx([1.5 / 6 / 32 / 2, 1.5 / 8 / 32 / 2])
    for inertia in (0.5, 0.6125, 0.77, 1.0, 1.2345, 1.7):
        [[estimate, low, high]] = found.crossings(STIFFNESS, {INERTIA: inertia})
        right = LEVEL**2 * inertia
        assert low <= right <= high and high - low < 2.5 * 2 * found.error[0]
        assert estimate == pytest.approx(right, abs=2e-5), (
            "straight between points, of which the frequency bends little"
        )
        if inertia == 0.5:
            continue  # at the end of the grid a line may just miss it
        [[estimate, low, high]] = found.crossings(INERTIA, {STIFFNESS: f"{right} N*m/rad"})
        assert low <= inertia <= high and estimate == pytest.approx(inertia, abs=2e-5)
    low, high = found.share
    ends = np.linspace(0.5, 2.0, 200_001)
    right = np.mean(np.clip(2.0 - np.maximum(LEVEL**2 * ends, 0.5), 0, None)) / 1.5
    assert low < right < high < low + 0.01
    assert found.dimension == pytest.approx(1.0, abs=0.05)
    assert found.points == known.done < found.everywhere / 25
    assert found.is_on_side({STIFFNESS: 1.9, INERTIA: 0.6}) is True
    assert found.is_on_side({STIFFNESS: 0.6, INERTIA: 1.9}) is False
    assert found.is_on_side({STIFFNESS: LEVEL**2, INERTIA: 1.0}) is None


def test_every_crossing_is_between_the_ends_of_its_edge(known) -> None:
    found = tn.study_boundary(known)
    stiffness, inertia = found.point.T
    along = found.along == 0
    for mine, other, which in ((LEVEL**2 * inertia, stiffness, along), (stiffness / LEVEL**2, inertia, ~along)):
        assert (
            which.sum() > 100 and np.all(found.low[which] <= mine[which]) and np.all(mine[which] <= found.high[which])
        )
        assert np.abs(mine - other)[which].max() < 2e-5
    data = found.data
    assert data["point"].dims == ("crossing", "parameter") and data.attrs["side"] == "frequency[0] > 1.07 rad/s"


def followed(inside: Any, points: int, depth: int, parameters: int = 2) -> tuple[Lattice, KnownSides, Any, int]:
    """A boundary of a shape between −1 and 1, followed to its end; and the rounds that it took."""
    axes = [StudyAxis.of_grid(f"p{k}", "1", 0.0, -1.0, 1.0, points, False) for k in range(parameters)]
    lattice = Lattice(StudyDesign(tuple(axes)), depth)
    whole, known, rounds = lattice.design(depth), KnownSides(np.zeros(0, np.int64), np.zeros(0, np.uint8)), 0
    while True:
        found, design = next_points(lattice, known)
        if design is None:
            return lattice, known, found, rounds
        rounds += 1
        numbers = whole.places(design, np.arange(design.size))
        assert not np.isin(numbers, known.numbers).any(), "no point twice"
        sides = np.where(inside(design.values(np.arange(design.size))), ABOVE, BELOW).astype(np.uint8)
        order = np.argsort(np.append(known.numbers, numbers))
        known = KnownSides(np.append(known.numbers, numbers)[order], np.append(known.sides, sides)[order])


SHAPES = {
    "circle": lambda v: (v**2).sum(axis=1) < 0.49,
    "ring of half a cell": lambda v: np.abs((v**2).sum(axis=1) - 0.49) < 0.05,
    "wedge that is narrower than a cell": lambda v: np.abs(v[:, 0] - 0.031) < 0.02 * (v[:, 1] + 1.0),
    "waves that swing across the cells": lambda v: v[:, 1] > 0.3 * np.sin(9.7 * v[:, 0]),
    "two corners that touch": lambda v: (v[:, 0] - 0.1003) * (v[:, 1] + 0.2001) > 0,
    "everything": lambda v: np.ones(len(v), dtype=bool),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_as_a_grid_that_is_as_fine_everywhere(shape) -> None:
    """The cells with both sides are all of those that the whole fine grid has next to any that were found."""
    inside = SHAPES[shape]
    lattice, known, found, rounds = followed(inside, 9, 5)
    fine = lattice.design(5)
    sides = inside(fine.values(np.arange(fine.size))).reshape(fine.shape)
    at_corners = np.stack(
        [sides[a or None : -1 + a or None, b or None : -1 + b or None] for a in (0, 1) for b in (0, 1)]
    )
    both = at_corners.any(axis=0) & ~at_corners.all(axis=0)
    assert set(map(tuple, found.crossed)) == set(map(tuple, np.argwhere(both)))
    assert len(known.numbers) < fine.size / 5 and rounds < 40


def test_over_three_parameters() -> None:
    """Of a ball: no cell of its surface is missed, and its volume lies between the ends."""
    inside = SHAPES["circle"]
    lattice, known, found, _ = followed(inside, 5, 3, 3)
    fine = lattice.design(3)
    sides = inside(fine.values(np.arange(fine.size))).reshape(fine.shape)
    corners = [sides[tuple(slice(c, c - 1 or None) for c in corner)] for corner in np.ndindex(2, 2, 2)]
    assert len(found.crossed) == np.count_nonzero(np.any(corners, axis=0) & ~np.all(corners, axis=0)) > 1000
    cells = 4.0**3 * 8.0 ** np.arange(4)
    above = sum(n / size for size, (_, n, _) in zip(cells, found.leaves, strict=True))
    below = sum((n - m) / size for size, (n, m, _) in zip(cells, found.leaves, strict=True))
    assert 8 * above < 4 / 3 * np.pi * 0.343 < 8 * (1 - below)
    assert len(known.numbers) < fine.size / 2


def test_a_single_parameter_is_halved(tmp_path) -> None:
    """Once a halving, on a logarithmic grid; and the picture has it where it is."""
    study = asked(tmp_path / "a.zarr", 10, parameter=[grid(STIFFNESS, 4, log=True)])
    found = tn.study(study, line=line(), workers=0)
    edge = tn.study_boundary(found)
    [[estimate, low, high]] = edge.crossings(STIFFNESS)
    assert low <= LEVEL**2 <= high < low * 1.001 and estimate == pytest.approx(LEVEL**2, rel=1e-6)
    assert found.points == 4 + 10
    levels = [item.value for item in picture(edge).panel.items if isinstance(item, Level) and item.on == "x"]
    assert levels == pytest.approx([LEVEL**2], rel=1e-6)


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    store = tmp_path_factory.mktemp("whole") / "whole.zarr"
    assert tn.study(asked(store, 2), line=line(), workers=0).outcome.ok
    return data_of(store)


@pytest.mark.parametrize("at", quick({60, 140}, list(range(1, 200, 7))))
def test_interrupted_at_any_write(at, tmp_path, undisturbed) -> None:
    """From the store alone or by the study, the points and answers are those of an undisturbed search."""
    store = tmp_path / "a.zarr"
    with pytest.MonkeyPatch.context() as patch:
        FailingDisk(patch, at, Killed() if at % 2 else OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)))
        try:
            tn.study(asked(store, 2), line=line(), workers=0)
        except (Killed, tn.ComputationError):
            pass
    from trunnion.studies.study import resumed

    if (store / "study.json").is_file():
        assert resumed(store, workers=0).outcome.ok
    assert tn.study(asked(store, 2), line=line(), workers=0).outcome.ok
    assert data_of(store) == undisturbed


def test_two_clients(tmp_path, undisturbed, monkeypatch) -> None:
    """One begins a round while the other is at it: both go on with the same parts."""
    store = tmp_path / "a.zarr"
    once: list[int] = []
    put = Store.put

    def put_after_another(self, part, block, *rest):
        if part.number == 1 and not once:
            once.append(block)
            assert tn.study(asked(store, 2), line=line(), workers=0).outcome.ok
        put(self, part, block, *rest)

    monkeypatch.setattr(Store, "put", put_after_another)
    assert tn.study(asked(store, 2), line=line(), workers=0).outcome.ok and once
    assert data_of(store) == undisturbed


@pytest.mark.slow
def test_further_halvings_keep_what_is_there(tmp_path, undisturbed, monkeypatch) -> None:
    store = tmp_path / "a.zarr"
    counts = computed(monkeypatch)
    first = tn.study(asked(store, 2), line=line(), workers=0)
    assert sum(counts) == first.points and data_of(store) == undisturbed
    more = tn.study(asked(store, 5), line=line(), workers=0)
    assert sum(counts) == more.points > first.points
    whole = tn.study(asked(tmp_path / "b.zarr", 5), line=line(), workers=0)
    assert np.array_equal(more.design.chosen, whole.design.chosen)
    assert more.quantity("frequency[0]").tobytes() == whole.quantity("frequency[0]").tobytes()
    moved = asked(store, 5, boundary={"quantity": "frequency[0]", "level": LEVEL + 0.01, "halvings": 5})
    beside = tn.study_boundary(tn.study(moved, line=line(), workers=0))
    assert sum(counts) - more.points - whole.points < whole.points / 2, "most of what another level asks for is there"
    assert beside.crossings(STIFFNESS, {INERTIA: 1.0})[0, 0] == pytest.approx((LEVEL + 0.01) ** 2, abs=2e-5)


def test_on_workers(tmp_path, undisturbed) -> None:
    import distributed

    store = tmp_path / "a.zarr"
    with distributed.Client(
        processes=False, n_workers=2, threads_per_worker=1, dashboard_address=None, set_as_default=False
    ) as client:
        assert tn.study(asked(store, 2), line=line(), client=client).outcome.ok
    assert data_of(store) == undisturbed


def test_a_search_that_needs_too_many_points_says_so(tmp_path) -> None:
    """It has what it came to, to be shown and gone on with."""
    store = tmp_path / "a.zarr"
    study = asked(store, 4)
    study["boundary"] |= {"most": 150}
    found = tn.study(study, line=line(), workers=0)
    assert not found.outcome.ok and "needs" in str(found.outcome) and "and 150 are the most" in str(found.outcome)
    edge = tn.study_boundary(found)
    assert 0 < edge.halvings < 4 and not edge.whole and f"{edge.halvings} of 4 halvings so far" in str(edge)
    [[_, low, high]] = edge.crossings(STIFFNESS, {INERTIA: 1.0})
    assert low <= LEVEL**2 <= high
    assert tn.study(asked(store, 4), line=line(), workers=0).outcome.ok


def stability(store: Path, value: str = "unstable", **more: Any) -> dict[str, Any]:
    speed = grid("speed", 33, 1.2, 2.0)
    study = {
        "line": "", "analysis": "stability", "quantities": ["growth_rate", "verdict"], "store": str(store),
        "parameter": [grid("HookeJoint 1.angle", 9, 0.0, 0.7), speed],
        "boundary": {"quantity": "verdict", "value": value, "halvings": 4},
    }  # fmt: skip
    return {**study, **more}


def test_a_tongue(tmp_path) -> None:
    """Where the verdict changes, the growth rate that ``stability`` finds by itself changes its sign."""
    found = tn.study_boundary(tn.study(stability(tmp_path / "a.zarr"), line=two_shafts(), workers=0))
    crossed = found.crossings("speed", {"HookeJoint 1.angle": "35 deg"})
    assert len(crossed) == 2 and not np.isnan(crossed).any()
    bent = two_shafts().replace_all({"HookeJoint 1": {"angle": "35 deg"}})
    for (_, low, high), signs in zip(crossed, ((-1, 1), (1, -1)), strict=True):
        assert high - low < 0.005
        assert tuple(np.sign([tn.stability(bent, speed).growth_rate for speed in (low, high)])) == signs
    shown = picture(found, x="speed", y="HookeJoint 1.angle").panel
    names = {one.name for one in shown.items if isinstance(one, Cells)}
    assert {"another verdict", "verdict = unstable"} <= names
    [edge] = [one for one in shown.items if isinstance(one, Line)]
    at = np.abs(edge.y - 35.0) < 0.3
    assert edge.x[at].min() == pytest.approx(crossed[0, 0], abs=0.01)
    assert edge.x[at].max() == pytest.approx(crossed[1, 0], abs=0.01)
    draw(picture(found))


def test_points_that_fail_are_on_no_side(tmp_path, monkeypatch) -> None:
    """They are no boundary, nor do they end the search; where they stand nothing is said."""
    old = StudyQuestion.evaluated

    def failing(self: StudyQuestion, paths: Any, values: Any) -> Any:
        found = old(self, paths, values)
        bad = values[:, paths.index(INERTIA)] > 1.5
        found.status[bad] = FAILED
        found.sentences.update({int(k): "is too heavy" for k in np.flatnonzero(bad)})
        for column in found.values.values():
            column[bad] = np.nan
        return found

    monkeypatch.setattr(StudyQuestion, "evaluated", failing)
    study = tn.study(asked(tmp_path / "a.zarr"), line=line(), workers=0)
    found = tn.study_boundary(study)
    assert study.outcome.ok and study.failed > 0 and study.reasons[0][0] == "is too heavy"
    assert found.crossings(STIFFNESS, {INERTIA: 1.2})[0, 0] == pytest.approx(LEVEL**2 * 1.2, abs=2e-5)
    assert len(found.crossings(STIFFNESS, {INERTIA: 1.9})) == 0
    assert found.is_on_side({STIFFNESS: 0.6, INERTIA: 1.9}) is None
    assert study.failed < study.points / 4, "nothing is looked for among them"


def test_stated_values_and_sampled_rows_have_their_own(tmp_path) -> None:
    two = tn.Driveline([*line().elements, tn.Shaft(stiffness=5.0), tn.Disk(inertia=0.1)])
    rest = {"path": "Disk 2.inertia", "values": [0.1, 0.3]}
    study = asked(tmp_path / "a.zarr", 3, parameter=[grid(STIFFNESS, 7), rest])
    found = tn.study_boundary(tn.study(study, line=two, workers=0))
    near = [found.crossings(STIFFNESS, {"Disk 2.inertia": inertia})[0] for inertia in (0.1, 0.3)]
    for (_, low, high), inertia in zip(near, (0.1, 0.3), strict=True):
        masses, stiffness = np.diag([1.0, inertia]), lambda k: np.array([[k + 5.0, -5.0], [-5.0, 5.0]])
        lowest = [np.sqrt(np.linalg.eigvals(np.linalg.solve(masses, stiffness(k))).min()) for k in (low, high)]
        assert lowest[0] <= LEVEL <= lowest[1]
    with pytest.raises(tn.InputError, match="is not one of the values that were stated"):
        found.crossings(STIFFNESS, {"Disk 2.inertia": 0.2})
    study = asked(
        tmp_path / "b.zarr", 3, sampling={"points": 8, "seed": 1},
        parameter=[grid(STIFFNESS, 7), {"path": INERTIA, "low": 0.8, "high": 1.2}],
    )  # fmt: skip
    cloud = tn.study(study, line=line(), workers=0)
    found = tn.study_boundary(cloud)
    inertias = np.unique(cloud.parameter(INERTIA))
    assert len(inertias) == 8
    seen = sorted(found.crossings(STIFFNESS, row=row)[0, 0] for row in range(8))
    assert np.array(seen) / LEVEL**2 == pytest.approx(inertias, rel=1e-3)
    with pytest.raises(tn.InputError, match="must be a whole number from 0 to 7"):
        found.crossings(STIFFNESS, row=8)


def test_rounding_about_the_level_is_no_boundary(tmp_path) -> None:
    """Without damping growth rates of stable lines are rounding, all of it above 0: taken at face value every line
    would be unstable. By default the boundary is that of the verdict, which knows its error."""
    bare = two_shafts().replace_all({"Shaft 1": {"damping": 0.0}, "Shaft 2": {"damping": 0.0}})
    growth = {"quantity": "growth_rate", "level": 0.0, "halvings": 3}
    found = [
        tn.study_boundary(tn.study(stability(tmp_path / "a.zarr", boundary=one), line=bare, workers=0))
        for one in (growth, {**growth, "noise": 0.0}, {"quantity": "verdict", "value": "unstable", "halvings": 3})
    ]
    at = {"HookeJoint 1.angle": "35 deg"}
    usual, literal, verdict = found
    assert literal.share[0] > 0.9 and 0.01 < usual.share[0] <= usual.share[1] < 0.2
    assert usual.crossings("speed", at)[:, 0] == pytest.approx(verdict.crossings("speed", at)[:, 0], abs=0.005)


def test_answers_without_a_boundary_are_told_by_its_dimension(tmp_path, monkeypatch) -> None:
    def drawn(self: StudyQuestion, paths: Any, values: Any) -> Any:
        room = self._room(len(values))
        room.status[:] = 1
        room.values["frequency[0]"][:] = np.sin(1e6 * values[:, 0] + 1e5 * values[:, 1]) + LEVEL
        return room

    monkeypatch.setattr(StudyQuestion, "evaluated", drawn)
    found = tn.study_boundary(tn.study(asked(tmp_path / "a.zarr", 3), line=line(), workers=0))
    assert found.dimension > 1.7 and "noise about the level, or a fractal" in str(found)


def test_what_the_points_are_not_for_is_refused(known, tmp_path) -> None:
    for ask, message in (
        (lambda: known.grid("frequency[0]"), "stands about a boundary, on no grid"),
        (lambda: known.plot(kind="histogram"), "would show where points are many"),
        (lambda: known.plot(quantity="frequency[1]"), "is not what changes at the boundary"),
        (lambda: tn.study_boundary(tn.study({**asked(tmp_path / "a.zarr"), "boundary": None}, line=line(), workers=0)),
         "looked for no boundary"),
        (lambda: tn.study_boundary(known).crossings("Shaft 1.stifness"), 'did you mean "Shaft 1.stiffness"?'),
        (lambda: tn.study_boundary(known).crossings(STIFFNESS), "is missing: where does it stand"),
        (lambda: tn.study_boundary(known).crossings(STIFFNESS, {INERTIA: 3.0}), "lies outside its values"),
        (lambda: tn.study_boundary(known).crossings(STIFFNESS, {INERTIA: "3 mm"}), "at = "),
        (lambda: tn.study_boundary(known).crossings(STIFFNESS, {STIFFNESS: 1.0}), "is not a parameter that stands"),
        (lambda: picture(tn.study_boundary(known), x=STIFFNESS, y=STIFFNESS), "stands on both axes"),
        (lambda: picture(tn.study_boundary(known), x="speed"), "is not a parameter that the boundary was"),
    ):  # fmt: skip
        with pytest.raises(tn.InputError) as refused:
            ask()
        assert message in str(refused.value) and "\n" not in str(refused.value)


def test_exports_have_every_point(known, tmp_path) -> None:
    import csv

    path = export(known.store, tmp_path / "all.csv")
    with path.open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == known.points
    for row in rows[:: len(rows) // 50]:
        stiffness, inertia, frequency = (float(value) for value in list(row.values())[:3])
        assert frequency == pytest.approx(np.sqrt(stiffness / inertia), rel=1e-9)
