"""Commands of blocks of ``sh``: every one is understood, and every one is run, here or where ``ELSEWHERE`` says."""

from __future__ import annotations

import re
import shlex
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
import typer.main
from as_printed import FILE, ROOT, blocks_of, commands, typed

from trunnion.cli import app

PAGES = ("README.md", *sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / "docs").glob("*.md")))
ELSEWHERE = {
    "make ": "Makefile, which runs the tests",
    "python": "Makefile and .ci",
    ".venv/bin/": "Makefile and .ci",
    "TRUNNION_WHEEL_KERNELS": ".ci/wheel-with-kernels",
    "trunnion app": "tests/app, in a browser",
    "trunnion reproduce": "tests/reproduction",
}
"""How a line begins that is not typed in here, and where it is run."""
FILES = {"my-line.toml": "pto-shaft", "truck.toml": "truck", "ship.toml": "two-stroke-ship"}
"""Files that pages speak of as the reader's own, and the examples that stand for them."""


def lines(name: str) -> Iterator[str]:
    """Lines of the page's blocks of ``sh`` without their comments."""
    for block in blocks_of((ROOT / name).read_text(encoding="utf-8")):
        if block.language == "sh" and not block.skipped:
            yield from (line for line in block.text.splitlines() if shlex.split(line, comments=True))


def of_consoles(name: str) -> Iterator[str]:
    """Commands of the page's consoles."""
    for block in blocks_of((ROOT / name).read_text(encoding="utf-8")):
        if block.language == "console":
            yield from (command for command, _ in commands(block.text))


def in_sentences(name: str) -> Iterator[str]:
    """Whole commands within the page's sentences and tables; dots and capitals stand for the reader's own there."""
    for command in re.findall(r"`(trunnion [^`\n]+)`", (ROOT / name).read_text(encoding="utf-8")):
        if len(command.split()) > 2 and not re.search(r"…|\.\.\.|\b[A-Z]{3,}\b", command):
            yield command


WITH_LINES = tuple(name for name in PAGES if any(lines(name)))


@pytest.mark.parametrize("name", PAGES)
def test_commands_are_understood(name: str) -> None:
    group = typer.main.get_command(app)
    for line in (*lines(name), *of_consoles(name), *in_sentences(name)):
        words = shlex.split(line, comments=True)
        if words[0] == "trunnion":
            with group.make_context("trunnion", words[1:]) as context:
                _, command, rest = group.resolve_command(context, [*context._protected_args, *context.args])
                while hasattr(command, "commands"):  # a command of commands
                    _, command, rest = command.resolve_command(context, rest)
                command.make_context(command.name, rest, parent=context).close()


def test_what_is_not_understood_is_seen() -> None:
    command = typer.main.get_command(app).commands["analyze"]  # type: ignore[attr-defined]
    with pytest.raises(Exception, match="no-such"):
        command.make_context("analyze", ["truck.toml", "--no-such-option"])


@pytest.mark.filterwarnings("ignore::trunnion.InputRemark")
@pytest.mark.slow
@pytest.mark.parametrize("name", WITH_LINES)
def test_commands_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    for own, example in FILES.items():
        shutil.copy(ROOT / "examples" / f"{example}.toml", tmp_path / own)
    for block in blocks_of((ROOT / name).read_text(encoding="utf-8")):
        if found := FILE.match(block.text):
            (tmp_path / found[1]).write_text(block.text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    for line in lines(name):
        if not line.startswith(tuple(ELSEWHERE)):
            typed(line, endings=(0, None))
            written = re.search(r"-o (\S+)", line)
            assert not written or (tmp_path / written[1]).stat().st_size, line


def test_what_is_not_run_here_is_on_a_page() -> None:
    every = [line for name in (*PAGES, "CONTRIBUTING.md") for line in lines(name)]
    assert [start for start in ELSEWHERE if not any(line.startswith(start) for line in every)] == []
