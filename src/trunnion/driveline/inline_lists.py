"""A list of inline tables, one to a line, with other tables: each line moves, goes or stays with its comments.

element = [
  { type = "Disk", inertia = "2 kg*m^2" },   # of the maker
  # a comment above an item belongs to it
  { type = "Shaft", stiffness = "10 kN*m/rad" },
]
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

Table = dict[str, Any]


@dataclass(frozen=True)
class _Line:
    """An item: the lines of comments above it, its indent, its text, the comment behind it, and how its line ends."""

    lead: str
    indent: str
    item: str
    comment: str
    ending: str

    @property
    def text(self) -> str:
        return f"{self.lead}{self.indent}{self.item},{self.comment}{self.ending}"


def relisted(
    source: str,
    places: Sequence[int | None],
    items: Sequence[Table],
    *,
    changed: Callable[[str, Table], str],
    written: Callable[[Table], str],
) -> str | None:
    """The list ``source``, from its opening bracket to the closing one, with ``items``; None where those that are there
    do not stand one to a line.

    places : which item of ``source`` each of ``items`` was, None for a new one. changed : text of an item and the table
    it shall hold → its text. written : a new item's text.
    """
    lines, end = _lines(source)
    if not lines:
        return None
    made = []
    for place, table in zip(places, items, strict=True):
        if place is None:
            made.append(_Line("", lines[0].indent, written(table), "", lines[0].ending))
            continue
        line = lines[place]
        made.append(replace(line, item=changed(line.item, table)))
    return f"[{lines[0].ending}" + "".join(line.text for line in made) + end


def _lines(source: str) -> tuple[list[_Line], str]:
    """The items and what ends the list; no items where anything else stands in it."""
    first, *rest = source.splitlines(keepends=True)
    if first.strip() != "[" or not rest or rest[-1].strip() != "]":
        return [], ""
    lines, lead = list[_Line](), ""
    for text in rest[:-1]:
        bare = text.lstrip()
        if not bare or bare.startswith("#"):
            lead += text
            continue
        item = _item(bare)
        behind = bare[len(item) :].lstrip()
        comment = behind.removeprefix(",")
        if not item or (comment.strip() and not comment.lstrip().startswith("#")):
            return [], ""
        lines.append(_Line(lead, text[: len(text) - len(bare)], item, comment.rstrip(), text[len(text.rstrip()) :]))
        lead = ""
    return lines, lead + rest[-1]


def _item(text: str) -> str:
    """The inline table that ``text`` begins with; empty where it is none."""
    end = text.find("}") + 1 if text.startswith("{") else 0
    while end:
        try:
            tomllib.loads(f"x = {text[:end]}")
        except tomllib.TOMLDecodeError:  # a bracket in a text, or of a table within
            end = text.find("}", end) + 1
        else:
            return text[:end]
    return ""
