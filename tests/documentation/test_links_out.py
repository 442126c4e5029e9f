"""The list of links that lead out is complete: no address stands on a page without standing in it."""

from __future__ import annotations

from pathlib import Path

import pytest
from as_printed import ROOT
from generate import links


def test_addresses_are_found_with_their_files(tmp_path: Path) -> None:
    found = links.outward()
    assert "CHANGELOG.md" in found["https://semver.org"]
    links.write_page(tmp_path / "links.md")
    page = (tmp_path / "links.md").read_text(encoding="utf-8")
    assert all(f"<{address}>" in page for address in found)


def test_none_is_left_out() -> None:
    """Counted in another way: word by word over every page and module."""
    pages = [ROOT / "README.md", *(ROOT / "docs").glob("*.md"), *(ROOT / "src/trunnion").rglob("*.py")]
    listed = links.outward()
    for path in pages:
        for word in path.read_text(encoding="utf-8").split():
            start = word.find("https://")
            if start >= 0:
                assert any(word[start:].startswith(address) for address in listed), (path.name, word)


@pytest.mark.parametrize("word", ["localhost", "127.0.0.1", "workspace", "/tmp/"])
def test_no_address_of_a_machine(word: str) -> None:
    assert not [address for address in links.outward() if word in address]


def test_addresses_are_encrypted() -> None:
    assert [address for address in links.outward() if address.startswith("http://")] == []
