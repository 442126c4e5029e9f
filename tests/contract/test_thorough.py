"""The list of tests that ``make test`` leaves out names tests that there are."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from thorough import LIST

ROOT = Path(__file__).parents[2]


def test_the_list_is_in_order_and_names_each_once() -> None:
    lines = LIST.read_text(encoding="utf-8").splitlines()
    assert lines == sorted(set(lines))
    assert all(line.startswith("tests/") and "::test_" in line for line in lines)


def test_every_name_is_a_test() -> None:
    """Collected anew: the one run here may be of some files only. Where an extra is missing, so are its tests."""
    listed = LIST.read_text(encoding="utf-8").splitlines()
    collect = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "--collect-only", "-q", "tests"]
    listing = subprocess.run(collect, cwd=ROOT, capture_output=True, text=True, check=False)
    found = [line for line in listing.stdout.splitlines() if "::" in line]
    gone = sorted(set(listed) - set(found))
    assert not gone, f"tests/thorough.txt names tests that are not there; take them out, or give the new names: {gone}"
