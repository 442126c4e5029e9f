"""A store loses nothing and mixes nothing: interrupted at any write, on a full disk, damaged, shared, extended."""

from __future__ import annotations

import errno
import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from studies.asked import BATCH, CALLS, data_of, grid, line, stated

import trunnion as tn
import trunnion.writing as writing
from trunnion.studies import store as store_module
from trunnion.studies.points import StudyQuestion
from trunnion.studies.result import read
from trunnion.studies.store import Store, _sealed


class Killed(BaseException):
    """The process ends here."""


class FailingDisk:
    """Counts what is asked of the disk, and fails at one of these calls."""

    def __init__(self, patch: pytest.MonkeyPatch, at: int, error: BaseException) -> None:
        self.left, self.error = at, error
        for where, name in ((os, "fsync"), (os, "replace"), (os, "rename"), (Path, "write_bytes"), (Path, "mkdir")):
            patch.setattr(where, name, self._failing(getattr(where, name)))

    def _failing(self, function: Any) -> Any:
        def call(*args: Any, **kwargs: Any) -> Any:
            self.left -= 1
            if self.left == 0:
                raise self.error
            return function(*args, **kwargs)

        return call


def small(store: Path, **more: Any) -> dict[str, Any]:
    return stated(store, block=8, **more)


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    store = tmp_path_factory.mktemp("whole") / "whole.zarr"
    assert tn.study(small(store), line=line(), workers=0).outcome.ok
    return data_of(store)


def quick(some: set[Any], every: list[Any]) -> list[Any]:
    """All of these as parameters of a test, those that are not among ``some`` marked slow."""
    return [one if one in some else pytest.param(one, marks=pytest.mark.slow) for one in every]


@pytest.mark.parametrize("at", quick({17, 36, 47}, list(range(1, 75))))
def test_interrupted_at_any_write(at, tmp_path, undisturbed) -> None:
    store = tmp_path / "a.zarr"
    with pytest.MonkeyPatch.context() as patch:
        FailingDisk(patch, at, Killed())
        try:
            tn.study(small(store), line=line(), workers=0)
        except Killed:
            pass
    found = tn.study(small(store), line=line(), workers=0)
    assert found.outcome.ok and data_of(store) == undisturbed
    assert not list(tmp_path.rglob(f"{writing.PREFIX}*")), "what was left is swept"


DISKS = [(number, at) for number in (errno.ENOSPC, errno.EROFS) for at in (2, 33, 40, 47, 58)]


@pytest.mark.parametrize("disk", quick({(errno.ENOSPC, 33), (errno.EROFS, 47)}, DISKS))
def test_full_disk(disk, tmp_path, undisturbed) -> None:
    number, at = disk
    store = tmp_path / "a.zarr"
    with pytest.MonkeyPatch.context() as patch:
        FailingDisk(patch, at, OSError(number, os.strerror(number)))
        try:
            tn.study(small(store), line=line(), workers=0)
        except tn.ComputationError as error:
            assert os.strerror(number) in str(error) and "\n" not in str(error)
        else:
            pytest.fail("the disk did not fail: choose another call")
    assert tn.study(small(store), line=line(), workers=0).outcome.ok
    assert data_of(store) == undisturbed


def computed(patch: pytest.MonkeyPatch) -> list[int]:
    """How many points every block has that is computed from now on."""
    counts: list[int] = []
    old = StudyQuestion.evaluated

    def evaluated(self: StudyQuestion, paths: Any, values: Any) -> Any:
        counts.append(len(values))
        return old(self, paths, values)

    patch.setattr(StudyQuestion, "evaluated", evaluated)
    return counts


def test_what_is_there_is_not_computed_again(tmp_path, monkeypatch) -> None:
    store = tmp_path / "a.zarr"
    counts = computed(monkeypatch)
    tn.study(small(store), line=line(), workers=0)
    assert sum(counts) == 40
    tn.study(small(store), line=line(), workers=0)
    assert sum(counts) == 40


def test_grids_refine(tmp_path, monkeypatch) -> None:
    """From n to 2n − 1 values along both axes: what was there stays, and all is what one study would have found."""
    store, other = tmp_path / "a.zarr", tmp_path / "b.zarr"
    counts = computed(monkeypatch)
    coarse = tn.study(small(store), line=line(), workers=0)
    fine = tn.study(small(store, parameter=grid(9, 15)), line=line(), workers=0)
    assert sum(counts) == 9 * 15
    assert np.array_equal(fine.grid("growth_rate")[::2, ::2], coarse.grid("growth_rate"))
    anew = tn.study(small(other, parameter=grid(9, 15)), line=line(), workers=0)
    np.testing.assert_allclose(fine.quantity("growth_rate"), anew.quantity("growth_rate"), atol=1e-8)
    assert np.array_equal(fine.parameter("speed"), anew.parameter("speed"))


def test_a_new_parameter_keeps_what_is_there(tmp_path, monkeypatch) -> None:
    store = tmp_path / "a.zarr"
    counts = computed(monkeypatch)
    first = tn.study(small(store), line=line(), workers=0)
    third = {"path": "Disk 2.inertia", "values": [0.5, 1.0, 2.0]}
    found = tn.study(small(store, parameter=[*grid(), third]), line=line(), workers=0)
    assert sum(counts) == 40 * 3, "those at the inertia that the line states are there"
    assert np.array_equal(found.grid("growth_rate")[:, :, 1], first.grid("growth_rate"))
    again = tn.study(small(store), line=line(), workers=0)
    assert sum(counts) == 40 * 3 and np.array_equal(again.grid("growth_rate"), first.grid("growth_rate"))


def sampled(method: str, count: int) -> dict[str, Any]:
    names = ("Shaft 1.stiffness", "Disk 2.inertia")
    return {
        "parameter": [{"path": name, "tolerance": "5 %"} for name in names],
        "sampling": {"method": method, "points": count},
        "arguments": {"speed": 1.0},
    }


@pytest.mark.parametrize("method", ["sobol", "saltelli"])
def test_sequences_continue(method, tmp_path, monkeypatch) -> None:
    store = tmp_path / "a.zarr"
    counts = computed(monkeypatch)
    first = tn.study(small(store, **sampled(method, 16)), line=line(), workers=0)
    more = tn.study(small(store, **sampled(method, 64)), line=line(), workers=0)
    assert more.points == 4 * first.points == sum(counts)
    assert np.array_equal(more.quantity("growth_rate")[: first.points], first.quantity("growth_rate"))
    assert np.array_equal(more.parameter("Disk 2.inertia")[: first.points], first.parameter("Disk 2.inertia"))


def test_latin_hypercubes_refuse(tmp_path) -> None:
    store = tmp_path / "a.zarr"
    tn.study(small(store, **sampled("latin", 16)), line=line(), workers=0)
    with pytest.raises(tn.InputError, match='cannot become 32 .* take method = "sobol"'):
        tn.study(small(store, **sampled("latin", 32)), line=line(), workers=0)


def test_two_clients(tmp_path, undisturbed) -> None:
    """The second computes all while the first is at its first block, which then computes the rest once more."""
    store, once = tmp_path / "a.zarr", []

    def meanwhile(state: object) -> None:
        if not once:
            once.append(state)
            assert tn.study(small(store), line=line(), workers=0).outcome.ok

    assert tn.study(small(store), line=line(), workers=0, progress=meanwhile).outcome.ok
    assert data_of(store) == undisturbed
    assert list((store / "part-0" / "blocks").iterdir()) == []


def test_another_study_is_refused(tmp_path) -> None:
    store = tmp_path / "a.zarr"
    tn.study(small(store), line=line(), workers=0)
    with pytest.raises(tn.InputError, match="holds another study: it differs in its line;"):
        tn.study(small(store), line=line(name="other"), workers=0)
    with pytest.raises(tn.InputError, match="holds another study: it differs in its quantities;"):
        tn.study(small(store, quantities=CALLS), line=line(), workers=0)
    (tmp_path / "b.zarr").mkdir()
    (tmp_path / "b.zarr" / "mine.txt").write_text("mine")
    with pytest.raises(tn.InputError, match="not a store of a study"):
        tn.study(small(tmp_path / "b.zarr"), line=line(), workers=0)


def test_other_versions_are_refused(tmp_path, monkeypatch) -> None:
    store = tmp_path / "a.zarr"
    tn.study(small(store), line=line(), workers=0)
    about = json.loads((store / "study.json").read_text())["content"]
    about["computed_by"]["numpy"] = "1.0"
    (store / "study.json").write_text(_sealed(about))
    with pytest.raises(tn.InputError, match=r"numpy 1\.0, here .*never mixed"):
        tn.study(small(store), line=line(), workers=0)
    assert read(store).done == 40, "it can be read all the same"


def damaged(path: Path, at: int) -> None:
    content = bytearray(path.read_bytes())
    content[at] ^= 1
    path.write_bytes(content)


@pytest.mark.slow
def test_damage_is_found_and_mended(tmp_path, undisturbed) -> None:
    store = tmp_path / "a.zarr"
    tn.study(small(store), line=line(), workers=0)
    shard = store / "part-0" / "growth_rate" / "c" / "0"
    size = shard.stat().st_size
    for at in range(0, size, max(1, size // 6)):
        damaged(shard, at)
        with pytest.raises(tn.ComputationError, match="--verify"):
            read(store)
        assert tn.study(small(store), line=line(), workers=0, verify=True).outcome.ok
        assert data_of(store) == undisturbed
    shard.unlink()
    with pytest.raises(tn.ComputationError, match="--verify"):
        read(store)
    with pytest.raises(tn.InputError, match="checksum"):
        damaged(store / "study.json", 200)
        read(store)


def test_a_damaged_block_is_computed_again(tmp_path, undisturbed, monkeypatch) -> None:
    store = tmp_path / "a.zarr"
    stop = RuntimeError()

    def enough(state: Any) -> None:
        if state.done >= 24:
            raise stop

    with pytest.raises(RuntimeError):
        tn.study(small(store), line=line(), workers=0, progress=enough)
    blocks = sorted((store / "part-0" / "blocks").glob("*.npz"))
    assert len(blocks) == 3 and read(store).done == 24
    damaged(blocks[0], 200)
    blocks[1].write_bytes(blocks[1].read_bytes()[:-30])
    blocks[2].write_bytes(b"")
    assert tn.study(small(store), line=line(), workers=0).outcome.ok
    assert data_of(store) == undisturbed


def test_failed_points_are_results(tmp_path) -> None:
    """Numbers that no line can have are points like others, with their sentence."""
    store = tmp_path / "a.zarr"
    inertias = {"path": "Disk 2.inertia", "values": [1.0, -1.0, 2.0]}
    found = tn.study(small(store, quantities=CALLS, parameter=[*grid(2, 2), inertias]), line=line(), workers=0)
    assert (found.done, found.failed, found.missing) == (8, 4, 0)
    assert found.reasons[0][1] == 4 and "must" in found.reasons[0][0] and "Disk 2" in found.reasons[0][0]
    assert sorted(found.failures) == [1, 4, 7, 10] and np.isnan(found.quantity("growth_rate")[1])
    assert str(Store.open(store).counts().reasons[0][0]) == found.reasons[0][0]
    assert "failed at 4: " in str(found)


@pytest.mark.parametrize("quantities", [BATCH, CALLS])
def test_values_are_those_of_the_analysis(quantities, tmp_path) -> None:
    """Each point beside a line built by hand and judged by itself; unstable ones are among them."""
    found = tn.study(small(tmp_path / "a.zarr", quantities=quantities), line=line(), workers=0)
    growth, verdict = found.quantity("growth_rate"), found.quantity("verdict")
    assert set(verdict) == {0.0, 1.0}
    for k, (angle, speed) in enumerate(zip(*map(found.parameter, ("HookeJoint 1.angle", "speed")), strict=True)):
        own = tn.stability(line().replace("HookeJoint 1", angle=float(angle)), float(speed))
        assert growth[k] == pytest.approx(own.growth_rate, abs=2e-8)
        assert verdict[k] == own.verdict


@pytest.mark.slow
def test_words_and_paths_into_results(tmp_path) -> None:
    """A name, one of several by its place and by its name, the largest of an array, and what may be None."""
    ranged = tn.Driveline([*line().elements], limits=[tn.Limit(of="Shaft 2", max_torque=5.0)])
    paths = ["verdict", "binding.name", "checks[0].margin", "checks[max torque of Shaft 2].spare", "low"]
    found = tn.study(
        stated(tmp_path / "a.zarr", paths, analysis="assess", arguments={"speeds": [0.5, 0.6]}, parameter=grid(2)[:1]),
        line=ranged, workers=0,
    )  # fmt: skip
    for k, angle in enumerate(found.parameter("HookeJoint 1.angle")):
        own = tn.assess(ranged.replace("HookeJoint 1", angle=float(angle)), (0.5, 0.6))
        assert found.quantities[0].shown(found.values["verdict"])[k] == str(own.verdict)
        assert found.quantity("binding.name")[k] == own.binding.name
        assert found.quantity("checks[0].margin")[k] == pytest.approx(own.checks[0].margin, nan_ok=True)
        assert found.quantity("low")[k] == 0.5


def test_nothing_known_at_any_point_of_a_shard(tmp_path: Path) -> None:
    """Points that all failed, and a word that is nothing at all of them, are kept as such: read back and resumed."""
    parameters = [{"path": "Disk 2.inertia", "values": [-1.0, -2.0, 1.0]}]
    asked = stated(tmp_path / "a.zarr", ["frequency[0]"], analysis="natural_frequencies", parameter=parameters, block=1)
    asked["parameter"].append({"path": "Shaft 1.stiffness", "values": [1.0, 2.0]})
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(store_module, "SHARD", 2)
        found = tn.study(asked, line=line(), workers=0)
        assert found.failed == 4 and found.done == 2 and len(list((tmp_path / "a.zarr/part-0/shards").iterdir())) == 3
        again = tn.study(asked, line=line(), workers=0, verify=True)
    assert np.array_equal(found.quantity("frequency[0]"), again.quantity("frequency[0]"), equal_nan=True)
    assert again.failures == found.failures and np.isnan(again.quantity("frequency[0]")[:4]).all()


def test_what_is_nothing_at_some_points_is_told_by_the_others(tmp_path: Path) -> None:
    """Stable points have no resonance: what names one is a word all the same."""
    parameters = [grid(3)[0], {"path": "speed", "values": [0.9, 1.0, 1.62]}]
    asked = stated(tmp_path / "a.zarr", ["resonance.name"], parameter=parameters)
    found = tn.study(asked, line=line(), workers=0)
    names = found.quantity("resonance.name").tolist()
    assert found.failed == 0 and len(set(names)) > 1, found.failures
    for angle, speed, name in zip(found.parameter("HookeJoint 1.angle"), found.parameter("speed"), names, strict=True):
        known = tn.stability(line().replace("HookeJoint 1", angle=float(angle)), float(speed)).resonance
        assert name == ("" if known is None else known.name)


def test_what_a_thread_writes_after_the_failure_is_swept(tmp_path) -> None:
    """Zarr writes in threads: one may still write when another has failed and all was removed."""
    with pytest.raises(RuntimeError), writing.folder_made_durably(tmp_path / "a") as first:
        raise RuntimeError
    first.mkdir()
    (first / "late").write_bytes(b"1")
    with writing.folder_made_durably(tmp_path / "a") as second:
        (second / "whole").write_bytes(b"1")
        writing.sweep(tmp_path)
        assert [one.name for one in tmp_path.iterdir()] == [second.name], "what is being written stays"
    assert [one.name for one in tmp_path.iterdir()] == ["a"]
