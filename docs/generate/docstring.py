"""Docstrings as Markdown: what stands before the first heading, parameters as a list, examples as code."""

from __future__ import annotations

import re
from inspect import cleandoc

HEADING = re.compile(r"^(Parameters|Returns|Raises|Attributes|Notes|Examples|Yields|References)\n-{3,}\n", re.M)


def sections(text: str) -> list[tuple[str, str]]:
    """Headings with what stands under each; the first heading is empty."""
    found = HEADING.split(cleandoc(text or ""))
    return [("", found[0].strip()), *zip(found[1::2], (one.strip() for one in found[2::2]), strict=True)]


def with_code(text: str) -> str:
    """Lines of a Python prompt, and what they print, as blocks of code."""
    blocks, code = [], False
    for line in text.splitlines():
        if line.startswith(">>>") and not code:
            code = True
            blocks += ["", "```pycon"]
        elif code and not line.strip():
            code = False
            blocks += ["```"]
        blocks.append(line)
    return "\n".join([*blocks, "```"] if code else blocks).strip()


def plain(text: str) -> str:
    """Roles of other markup as code, and indented blocks as code."""
    text = re.sub(r":\w+:`~?([\w.]+)`", lambda found: f"`{found[1].rsplit('.', 1)[-1]}`", text)
    text = re.sub(r"^(\s*)\* ", r"\1- ", text, flags=re.M)
    return with_code(text.replace("::\n", ":\n"))


def entries(text: str) -> list[tuple[str, str]]:
    """``name, other : what it is`` with the lines that go on below it."""
    found: list[list[str]] = []
    for line in text.splitlines():
        if head := re.match(r"^(\*{0,2}\w[\w.,* ]*?) : (.*)", line):
            found.append([head[1], head[2]])
        elif found and (line.startswith(" ") or not line.strip()):
            found[-1][1] += " " + line.strip()
        else:
            found.append(["", line])
    return [(name, what.strip()) for name, what in found]


def as_list(text: str) -> str:
    """Parameters as items, each name as code."""
    lines = []
    for name, what in entries(text):
        names = ", ".join(f"`{one.strip()}`" for one in name.split(",")) if name else ""
        lines.append(f"- {names}: {plain(what)}" if names else plain(what))
    return "\n".join(lines)


def body(text: str) -> str:
    """A whole docstring."""
    parts = []
    for heading, what in sections(text):
        if heading in ("Parameters", "Raises", "Attributes"):
            parts.append(f"**{heading}**\n\n{as_list(what)}")
        elif heading and heading != "Examples":
            parts.append(f"**{heading}**\n\n{plain(what)}")
        else:
            parts.append(plain(what))
    return "\n\n".join(part for part in parts if part)
