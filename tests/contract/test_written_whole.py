"""Files and folders are written whole or not at all."""

from __future__ import annotations

import pytest

from trunnion.errors import InputError
from trunnion.results.files import folder_written_whole, written_whole


def everything(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


def test_folder_appears_with_all_its_files(tmp_path):
    with folder_written_whole(tmp_path / "a" / "b") as temporary:
        (temporary / "one.txt").write_text("1")
        (temporary / "two.txt").write_text("2")
        assert not (tmp_path / "a").exists()
    assert everything(tmp_path) == ["a", "a/b", "a/b/one.txt", "a/b/two.txt"]


def test_files_already_there_are_kept_or_replaced(tmp_path):
    (tmp_path / "kept.txt").write_text("old")
    (tmp_path / "replaced.txt").write_text("old")
    with folder_written_whole(tmp_path) as temporary:
        (temporary / "replaced.txt").write_text("new")
    assert (tmp_path / "kept.txt").read_text() == "old"
    assert (tmp_path / "replaced.txt").read_text() == "new"
    assert everything(tmp_path) == ["kept.txt", "replaced.txt"]


@pytest.mark.parametrize("failure", [KeyboardInterrupt, RuntimeError])
def test_failure_leaves_nothing(tmp_path, failure):
    with pytest.raises(failure), folder_written_whole(tmp_path / "new") as temporary:
        (temporary / "one.txt").write_text("1")
        raise failure
    with pytest.raises(failure), written_whole(tmp_path / "one.txt") as temporary:
        temporary.write_text("1")
        raise failure
    assert everything(tmp_path) == []


def test_folder_that_is_a_file(tmp_path):
    (tmp_path / "there").write_text("a file")
    with pytest.raises(InputError, match="cannot be made"), folder_written_whole(tmp_path / "there"):
        pass
    assert everything(tmp_path) == ["there"]
