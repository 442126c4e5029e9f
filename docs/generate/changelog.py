"""Files at the top of the project as pages: their links lead to pages of the site."""

from __future__ import annotations

import re
from pathlib import Path

from generate.markdown import write

TOP = Path(__file__).parents[2]
PAGES = {
    "README.md": "readme.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "benchmarks/README.md": "benchmarks.md",
    "CODE_OF_CONDUCT.md": "code-of-conduct.md",
    "SECURITY.md": "security.md",
}
LINK = re.compile(r"\[([^\]]*)\]\((?!https?:|#)([^)]*)\)")
"""Words and target."""


def link(target: str, home: Path) -> str:
    """Where a link of a file in folder ``home`` leads from ``docs``; empty where that is not a page of the site."""
    path, _, anchor = target.partition("#")
    wanted = (home / path).resolve()
    if not wanted.is_relative_to(TOP):
        return ""
    name = wanted.relative_to(TOP).as_posix()
    page = (
        f"generated/{PAGES[name]}" if name in PAGES else name.removeprefix("docs/") if name.startswith("docs/") else ""
    )
    return page + (f"#{anchor}" if page and anchor else "")


def turned(text: str, home: Path, up: str = "") -> str:
    """Links of a text written in folder ``home``, for a page ``up`` from ``docs``; what is not a page is named by its path."""

    def one(found: re.Match[str]) -> str:
        page = link(found[2], home)
        return f"[{found[1]}]({up}{page})" if page else f"{found[1]} (`{found[2]}`)"

    return LINK.sub(one, text)


def leaving(text: str, home: Path, up: str = "") -> str:
    """Of a page below ``docs``, only the links to files that are pages of the site though they stand elsewhere."""

    def one(found: re.Match[str]) -> str:
        path, _, anchor = found[2].partition("#")
        wanted = (home / path).resolve()
        name = wanted.relative_to(TOP).as_posix() if wanted.is_relative_to(TOP) else ""
        if name not in PAGES:
            if wanted.is_relative_to(TOP / "docs") or not path:
                return found[0]
            return f"{found[1]} (`{path.removeprefix('../')}`)"
        return f"[{found[1]}]({up}generated/{PAGES[name]}" + (f"#{anchor}" if anchor else "") + ")"

    return LINK.sub(one, text)


def write_pages(folder: Path) -> None:
    """Copy them with their links turned round."""
    for name, page in PAGES.items():
        source = TOP / name
        write(folder / page, turned(source.read_text(encoding="utf-8"), source.parent, "../"))
