"""All pages that the package writes itself."""

from __future__ import annotations

from pathlib import Path

from generate import api, changelog, commands, elements, links, messages, validation


def write(folder: Path) -> None:
    """Write them below ``folder``."""
    elements.write_pages(folder / "elements")
    api.write_pages(folder / "api")
    commands.write_page(folder / "commands.md")
    messages.write_page(folder / "messages.md")
    validation.write_page(folder / "validation.md")
    changelog.write_pages(folder)
    links.write_page(folder / "links.md")
