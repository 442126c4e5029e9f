"""What README and docs show is what happens."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
import tomllib
from pathlib import Path

import pytest

import trunnion as tn

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
ORDERS = (ROOT / "docs" / "orders.md").read_text(encoding="utf-8")
FIRST = (ROOT / "docs" / "first-driveline.md").read_text(encoding="utf-8")


def blocks(text: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)


def test_the_python_example_prints_what_stands_below_it():
    (code,), (shown,) = blocks(README, "python"), blocks(README, "text")
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(code, {})
    assert printed.getvalue() == shown


@pytest.mark.parametrize("command", [c[2:] for c in blocks(README, "console")[0].splitlines()])
def test_the_commands_run(run, command):
    words = [w.replace("examples", str(ROOT / "examples")) for w in shlex.split(command)]
    assert words.pop(0) == "trunnion"
    if words[0] == "stability-chart":
        words = [w.replace(":150:", ":4:") for w in words] + ["--points", "4x3"]
    result = run(*words)
    assert result.exit_code == 0, result.stderr


def test_the_examples_of_orders_run():
    names = {}
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        for code in blocks(ORDERS, "python"):
            exec(code, names)
    assert "coupling: torque up to" in printed.getvalue() and "rpm" in printed.getvalue()


@pytest.mark.parametrize("command", [c[2:] for c in blocks(ORDERS, "console")[0].splitlines()])
def test_the_commands_of_orders_run(run, command):
    words = [w.replace("examples", str(ROOT / "examples")) for w in shlex.split(command)]
    assert words.pop(0) == "trunnion"
    result = run(*words)
    assert result.exit_code == 0, result.stderr


def test_the_first_driveline_is_the_starter(run):
    run("new", "two-shaft", "-o", "my-line.toml")
    (shown,) = blocks(FIRST, "toml")
    assert tomllib.loads(shown)["format"] == 1
    assert tn.loads(shown) == tn.load("my-line.toml")


@pytest.mark.slow
def test_the_findings_shown_are_those_of_the_starter(run, monkeypatch):
    monkeypatch.setenv("COLUMNS", "110")
    run("new", "two-shaft", "-o", "my-line.toml")
    printed = run("analyze", "my-line.toml").stdout
    (shown,) = blocks(FIRST, "text")
    assert [line.rstrip() for line in shown.splitlines()] == [
        line.rstrip() for line in printed.partition("Findings\n")[2].partition("\ntrunnion assess")[0].splitlines()
    ]
