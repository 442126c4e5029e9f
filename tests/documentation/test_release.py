"""The recipe of a release: its number and date, and what is handed out. ``.ci/release --trial`` runs all of it."""

from __future__ import annotations

import io
import re
import runpy
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest
from as_printed import ROOT

FILES = ("pyproject.toml", "CITATION.cff", "CHANGELOG.md")
NUMBER, CHECK = ROOT / ".ci/number", ROOT / ".ci/check-release"
VERSION = re.search(r'^version = "(.*)"$', (ROOT / "pyproject.toml").read_text(encoding="utf-8"), flags=re.MULTILINE)[1]  # type: ignore[index]


def ran(*words: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *map(str, words)], capture_output=True, text=True)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in FILES:
        shutil.copy(ROOT / name, tmp_path)
    changelog = tmp_path / "CHANGELOG.md"
    changelog.write_text(
        "# Changelog\n\n## [Unreleased]\n\n## [9.8.7] - unreleased\n\n- New.\n\n## [9.8.6] - 2026-01-02\n\n- Old.\n",
        encoding="utf-8",
    )
    return tmp_path


def test_a_release_is_numbered_and_dated(folder: Path) -> None:
    found = ran(NUMBER, "9.8.7", "2026-12-01", folder)
    assert found.returncode == 0, found.stderr
    assert re.findall(r'^version = "9.8.7"$', (folder / "pyproject.toml").read_text(), flags=re.MULTILINE)
    citation = (folder / "CITATION.cff").read_text()
    assert "\nversion: 9.8.7\n" in citation and citation.count("date-released: 2026-12-01\n") == 1
    changelog = (folder / "CHANGELOG.md").read_text()
    assert "## [9.8.7] - 2026-12-01\n" in changelog and "## [9.8.6] - 2026-01-02\n" in changelog
    before = {name: (folder / name).read_text() for name in FILES}
    assert ran(NUMBER, "9.8.7", "2026-12-01", folder).returncode == 0  # once more is the same
    assert before == {name: (folder / name).read_text() for name in FILES}


@pytest.mark.parametrize(
    ("version", "date", "words"),
    [
        ("9.8", "2026-12-01", "three numbers with dots"),
        ("9.8.7", "1 December", "year, month and day"),
        ("9.9.0", "2026-12-01", "has no section"),
        ("9.8.6", "2026-12-01", "was released on 2026-01-02"),
    ],
)
def test_what_cannot_be_a_release_is_said(folder: Path, version: str, date: str, words: str) -> None:
    before = {name: (folder / name).read_text() for name in FILES}
    found = ran(NUMBER, version, date, folder)
    assert found.returncode == 1 and words in found.stderr and len(found.stderr.splitlines()) == 1
    assert before == {name: (folder / name).read_text() for name in FILES}


def test_entries_without_a_version_are_said(folder: Path) -> None:
    changelog = folder / "CHANGELOG.md"
    changelog.write_text(changelog.read_text().replace("[Unreleased]\n", "[Unreleased]\n\n- Forgotten.\n"))
    assert "entries under Unreleased" in ran(NUMBER, "9.8.7", "2026-12-01", folder).stderr


def test_this_version_can_be_released(tmp_path: Path) -> None:
    """The changelog has its section, dated or not, and citation and project name one version."""
    for name in FILES:
        shutil.copy(ROOT / name, tmp_path)
    text = (tmp_path / "CHANGELOG.md").read_text(encoding="utf-8")
    head = re.search(rf"^## \[{re.escape(VERSION)}\] - (\S+)$", text, flags=re.MULTILINE)
    assert head, f"CHANGELOG.md has no section [{VERSION}]"
    assert f"\nversion: {VERSION}\n" in (tmp_path / "CITATION.cff").read_text(encoding="utf-8")
    if head[1] == "unreleased":
        found = ran(NUMBER, VERSION, "2030-01-01", tmp_path)
        assert found.returncode == 0, found.stderr


def archives(folder: Path, page: str = '<a href="search.html">search</a>') -> None:
    """Three archives with no more than what is looked for."""
    names = runpy.run_path(str(CHECK), run_name="check_release")
    with zipfile.ZipFile(folder / "trunnion-1.2.3-py3-none-any.whl", "w") as wheel:
        wheel.writestr("trunnion-1.2.3.dist-info/METADATA", "Name: trunnion\nVersion: 1.2.3\n")
        for name in names["WHEEL"]:
            wheel.writestr(name, "")
    for archive, top, kind in (("trunnion-1.2.3", "", "SOURCE"), ("trunnion-1.2.3-site", "-site", "SITE")):
        with tarfile.open(folder / f"{archive}.tar.gz", "w:gz") as tar:
            for name in names[kind]:
                data = page.encode() if name == "index.html" else b""
                member = tarfile.TarInfo(f"trunnion-1.2.3{top}/{name}")
                member.size = len(data)
                tar.addfile(member, io.BytesIO(data))


def test_what_is_whole_passes(tmp_path: Path) -> None:
    archives(tmp_path)
    found = ran(CHECK, tmp_path, "1.2.3")
    assert found.returncode == 0, found.stderr


def test_what_is_missing_is_named(tmp_path: Path) -> None:
    archives(tmp_path, '<img src="_images/lost.png"><a href="https://example.org/">out</a><a href="#top">up</a>')
    found = ran(CHECK, tmp_path, "1.2.3")
    assert found.returncode == 1
    assert found.stderr.splitlines() == ["trunnion-1.2.3-site/index.html leads to _images/lost.png, which is not there"]
    (tmp_path / "trunnion-1.2.3-site.tar.gz").unlink()
    assert "lacks trunnion-1.2.3-site.tar.gz" in ran(CHECK, tmp_path, "1.2.3").stderr
    assert "holds 0 wheels of 1.2.4" in ran(CHECK, tmp_path, "1.2.4").stderr
    with zipfile.ZipFile(tmp_path / "trunnion-1.2.3-py3-none-any.whl", "a") as wheel:
        wheel.writestr("tests/conftest.py", "")
    archives_again = tmp_path / "trunnion-1.2.3-site.tar.gz"
    shutil.copy(tmp_path / "trunnion-1.2.3.tar.gz", archives_again)
    assert "holds tests/conftest.py" in ran(CHECK, tmp_path, "1.2.3").stderr
