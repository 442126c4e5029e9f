"""``trunnion reproduce``: refusals before the work."""

from __future__ import annotations

from pathlib import Path

import pytest


def test_unknown_name(run, here: Path) -> None:  # type: ignore[no-untyped-def]
    result = run("reproduce", "bicardan")
    assert result.exit_code == 2
    assert "two-shaft-cardan" in result.stderr and len(result.stderr.strip().splitlines()) == 1
    assert not (here / "trunnion-out").exists()


def test_folder_that_is_a_file(run, here: Path) -> None:  # type: ignore[no-untyped-def]
    (here / "taken").write_text("x")
    assert run("reproduce", "two-shaft-cardan", "--output", "taken").exit_code == 2


@pytest.mark.slow
def test_writes_page_and_pictures(run, here: Path) -> None:  # type: ignore[no-untyped-def]
    result = run("reproduce", "two-shaft-cardan", "--output", "s1")
    assert result.exit_code == 0, result.stderr
    assert {"two-shaft-cardan.html", "figure-2a.png", "figure-7.png"} <= {p.name for p in (here / "s1").iterdir()}
    assert "published" in result.stdout and "Errata" in result.stdout
