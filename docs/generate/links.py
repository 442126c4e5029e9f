"""Every address outside the project that a page or a docstring names, and where."""

from __future__ import annotations

import re
from pathlib import Path

from generate.changelog import PAGES
from generate.markdown import table, write

TOP = Path(__file__).parents[2]
ADDRESS = re.compile(r"https?://[^\s<>\"'`)\]}]+")
OWN = re.compile(r"https?://(localhost|127\.0\.0\.1|0\.0\.0\.0)\b")
ROOMS = (("src/trunnion", "*.py"), ("docs", "*.md"), ("docs/gallery", "*.py"), ("docs/theory", "*.md"))
TOO = ("README.md", "CITATION.cff", *PAGES)


def files() -> list[Path]:
    """What people read: pages at the top and of docs, examples of the gallery, docstrings."""
    found = [TOP / name for name in TOO]
    for room, kind in ROOMS:
        search = (TOP / room).rglob(kind) if room == "src/trunnion" else (TOP / room).glob(kind)
        found += sorted(search)
    return found


def outward() -> dict[str, list[str]]:
    """Address → files that name it, both in order."""
    found: dict[str, set[str]] = {}
    for path in files():
        for address in ADDRESS.findall(path.read_text(encoding="utf-8")):
            if not OWN.match(address) and "{" not in address:  # of a text that is still to be filled in
                found.setdefault(address.rstrip(".,;:"), set()).add(path.relative_to(TOP).as_posix())
    return {address: sorted(found[address]) for address in sorted(found)}


def write_page(path: Path) -> None:
    """The list as a page."""
    rows = [(f"<{address}>", ", ".join(f"`{name}`" for name in names)) for address, names in outward().items()]
    write(
        path,
        "# Links that lead out\n\nAll other links of these pages stay on the site. None of these is opened while the site or the "
        "package is built, read or used. The list is made from the sources when the site is built.\n\n"
        + table(("address", "named in"), rows),
    )
