"""Links of the project's pages lead to files and headings that are there; those that lead out are listed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from as_printed import ROOT

TOP = ["README.md", "CONTRIBUTING.md", "CODE_OF_CONDUCT.md", "SECURITY.md", "CHANGELOG.md", "benchmarks/README.md"]
PAGES = [*TOP, *sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / "docs").glob("*.md"))]
PAGES += sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / "docs/theory").glob("*.md"))
LINK = re.compile(r"\]\(([^)\s]+)\)")
FENCE = re.compile(r"^(```|:::).*?^\1", flags=re.DOTALL | re.MULTILINE)


def anchors(path: Path) -> set[str]:
    """Those of its headings, as pages are shown on the web, and its own labels."""
    text = FENCE.sub("", path.read_text(encoding="utf-8"))
    found = set(re.findall(r"^\(([\w-]+)\)=", text, flags=re.MULTILINE))
    for head in re.findall(r"^#+ (.*)", text, flags=re.MULTILINE):
        plain = re.sub(r"[`*]|\]\([^)]*\)|\[", "", head).strip().lower()
        found.add(re.sub(r"[^\w\- ]", "", plain).replace(" ", "-"))
    return found


@pytest.mark.parametrize("name", PAGES)
def test_links_lead_somewhere(name: str) -> None:
    page = ROOT / name
    lost = []
    for target in LINK.findall(page.read_text(encoding="utf-8")):
        if re.match(r"https?:|mailto:", target):
            continue
        path, _, anchor = target.partition("#")
        wanted = (page.parent / path).resolve() if path else page
        if (ROOT / "docs/generated") in wanted.parents:
            continue  # the site makes them, and judges them
        if not wanted.exists() or (anchor and wanted.suffix == ".md" and anchor not in anchors(wanted)):
            lost.append(target)
    assert lost == []
