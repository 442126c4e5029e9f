"""A copy of the package in which something invented is added as ``CONTRIBUTING.md`` walks through it."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import trunnion

ROOT = Path(__file__).parents[2]
PACKAGE = Path(trunnion.__file__).parent
COPIED = ("tests", "docs", "CONTRIBUTING.md", "CHANGELOG.md", "README.md", "pyproject.toml")
"""Beside the package: what an addition touches, and what its tests need."""


def shown(path: str) -> str:
    """The code that ``CONTRIBUTING.md`` shows for a file below ``src`` or ``tests``, or for a place in one, where it is
    the last one that is named before."""
    named, blocks = "", {}
    for part in (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").split("```"):
        if part.startswith("python\n"):
            blocks[named] = part.removeprefix("python\n")
        else:
            named = (re.findall(r"`((?:src|tests)/[\w/]+\.\w+)`", part) or [""])[-1]
    return blocks[path]


class Walk:
    """A copy of the package, its tests and pages; ``folder`` is empty before."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        ignored = shutil.ignore_patterns("__pycache__", "images", "data")
        shutil.copytree(PACKAGE, folder / "src" / "trunnion", ignore=shutil.ignore_patterns("__pycache__"))
        for name in COPIED:
            source = ROOT / name
            if source.is_dir():
                shutil.copytree(source, folder / name, ignore=ignored)
            else:
                shutil.copy(source, folder / name)
        self.before = {path: path.read_bytes() for path in self._files()}

    def _files(self) -> list[Path]:
        return [path for path in self.folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts]

    def add(self, path: str, text: str) -> None:
        """A new file."""
        place = self.folder / path
        assert not place.exists(), f"{path} is there already"
        place.write_text(text, encoding="utf-8")

    def put(self, path: str, text: str, *, before: str = "", after: str = "") -> None:
        """Text in a file that was there, in front of or behind the one place where other words stand."""
        place, words = self.folder / path, before or after
        content = place.read_text(encoding="utf-8")
        assert content.count(words) == 1, f"{path} has {content.count(words)} times {words!r}"
        whole = text + words if before else words + text
        place.write_text(content.replace(words, whole), encoding="utf-8")

    def print_features(self) -> None:
        """Write into ``docs/features.md`` what ``python -m trunnion.features`` prints."""
        page = self.folder / "docs" / "features.md"
        head = page.read_text(encoding="utf-8").partition("\n1. ")[0]
        page.write_text(f"{head}\n{self.run('-m', 'trunnion.features')}", encoding="utf-8")

    def changed(self) -> list[str]:
        """The files that were there before and are not as they were."""
        return sorted(
            path.relative_to(self.folder).as_posix()
            for path, content in self.before.items()
            if not path.exists() or path.read_bytes() != content
        )

    def run(self, *arguments: str, text: str = "") -> str:
        """What Python prints with the copy in place of the package; ``text`` is its standard input."""
        ours = {"PYTHONPATH": str(self.folder / "src"), "PYTHONIOENCODING": "utf-8", "COLUMNS": "200"}
        ran = subprocess.run(
            [sys.executable, *arguments], cwd=self.folder, env=os.environ | ours, input=text, capture_output=True,
            encoding="utf-8",
        )  # fmt: skip
        assert ran.returncode == 0, ran.stdout[-6000:] + ran.stderr[-6000:]
        return ran.stdout

    def check(self, code: str) -> None:
        """Run code that asserts."""
        self.run("-", text=code)

    def test(self, of: str, *names: str) -> None:
        """Run the tests of ``tests/*/test_NAME.py`` that fit ``of``; some must."""
        paths = [str(next((self.folder / "tests").glob(f"*/test_{name}.py"))) for name in names]
        told = self.run("-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "not slow", "-k", of, *paths)
        assert re.search(r"[1-9]\d* passed", told), told
