"""Every view against the rules of WCAG 2.2 AA that axe-core can judge.

It is installed from its npm package for the test, and is not part of this project."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest
from served import Look

from trunnion import registry

AXE = "axe-core@4.10.3"
RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]
LEAST_JUDGED = 20
"""Rules that find something to judge on every view; fewer, and the page was not looked at."""


@pytest.fixture(scope="module")
def axe(tmp_path_factory: pytest.TempPathFactory) -> str:
    npm = shutil.which("npm")
    if npm is None:
        pytest.skip("no npm found, with which axe-core is installed: install Debian's package npm")
    folder = tmp_path_factory.mktemp("axe")
    command = [npm, "install", AXE, "--no-audit", "--no-fund", "--ignore-scripts", "--prefix", str(folder)]
    subprocess.run(command, check=True, capture_output=True, timeout=300)
    return Path(folder, "node_modules", "axe-core", "axe.min.js").read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("view", registry.VIEWS)
def test_nothing_that_axe_judges_is_violated(look: Look, axe: str, view: str) -> None:
    """In both themes, with a variant kept."""
    look.page.set_viewport_size({"width": 1440, "height": 900})
    look.at(f"?view={view}&stability.across=8&stability.up=6")
    look.page.get_by_role("button", name="Keep this variant to compare").click()
    look.page.get_by_role("button", name="Drop variant 1").wait_for()
    look.settled_anew()
    look.page.evaluate(axe)
    broken = []
    for theme in ("light", "dark"):
        look.page.emulate_media(color_scheme=theme)
        look.page.wait_for_timeout(300)
        found = look.page.evaluate(f"axe.run(document, {{ runOnly: {RULES} }})")
        assert len(found["passes"]) > LEAST_JUDGED
        broken += [
            (theme, one["id"], node["html"][:200], node["failureSummary"])
            for one in found["violations"]
            for node in one["nodes"]
        ]
    assert broken == []
