"""Pages run as a reader would: files are written, commands typed, Python entered, and what is printed must match.

A block of toml whose first line is a comment with a file name (``# pump-drive.toml``) is that file. A block of console
has commands behind ``$`` and below each what it prints; ``...`` stands for lines left out. A block of text right behind
one of Python is what it prints. ``<!-- not run: why -->`` in front of a block leaves it out.
"""

from __future__ import annotations

import contextlib
import doctest
import io
import os
import re
import shlex
import shutil
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

BLOCK = re.compile(r"(<!-- (not run: [^>]*) -->\n+)?^```(\w+)\n(.*?)^```", flags=re.DOTALL | re.MULTILINE)
FILE = re.compile(r"# ([\w-]+\.(?:toml|csv|py))\n")
ROOT = Path(__file__).parents[2]
CHECKER = doctest.OutputChecker()
LOOSE = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


@dataclass(frozen=True)
class Block:
    """A fenced block, its language, and why it is left out, if it is."""

    language: str
    text: str
    skipped: str


def blocks_of(text: str) -> Iterator[Block]:
    """In order."""
    for found in BLOCK.finditer(text):
        yield Block(found[3], found[4], found[2] or "")


def same(wanted: str, got: str) -> bool:
    """Whether what is printed is what stands there, white space and what ``...`` stands for aside."""
    return CHECKER.check_output(wanted, got, LOOSE)


def commands(text: str) -> Iterator[tuple[str, str]]:
    """Each command of a console and what stands below it."""
    parts = re.split(r"^\$ ", text, flags=re.MULTILINE)
    assert not parts[0].strip(), "a console begins with a command"
    for part in parts[1:]:
        command, _, printed = part.partition("\n")
        yield command, printed


def typed(command: str, endings: tuple[int | None, ...] = (0, None, 1, 2)) -> str:
    """What ``trunnion`` prints; comments behind it are for the reader. Ends as one of ``endings``."""
    from trunnion.cli import main

    words = shlex.split(command, comments=True)
    assert words[0] == "trunnion", command
    printed = io.StringIO()
    given = sys.argv
    sys.argv = words
    try:
        with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(io.StringIO()):
            ending = main()
    except SystemExit as left:
        ending = left.code
    finally:
        sys.argv = given
    assert ending in endings, f"{command}: ended with {ending}"
    return printed.getvalue()


def run(path: Path, folder: Path) -> list[str]:
    """What in the page differs, run in ``folder``."""
    blocks = [*blocks_of(path.read_text(encoding="utf-8"))]
    names: dict[str, Any] = {}
    last = ""
    wrong = []
    before = Path.cwd()
    shutil.copytree(ROOT / "examples", folder / "examples")
    shutil.copy(ROOT / "examples/truck.toml", folder)  # guides speak of it as the reader's own
    os.chdir(folder)
    try:
        for block in blocks:
            if block.skipped:
                continue
            if (name := FILE.match(block.text)) and block.language in ("toml", "csv", "python"):
                Path(name[1]).write_text(block.text, encoding="utf-8")
            if block.language == "python":
                printed = io.StringIO()
                with contextlib.redirect_stdout(printed):
                    exec(compile(block.text, path.name, "exec"), names)
                last = printed.getvalue()
            elif block.language == "text" and last:
                if not same(block.text, last):
                    wrong.append(f"printed:\n{last}\nstands there:\n{block.text}")
                last = ""
            elif block.language == "console":
                for command, wanted in commands(block.text):
                    got = typed(command)
                    if wanted.strip() and not same(wanted, got):
                        wrong.append(f"{command} printed:\n{got}\nstands there:\n{wanted}")
    finally:
        os.chdir(before)
    return wrong
