"""Help says what the source says: no unit in brackets is lost, in no command and on no terminal."""

from __future__ import annotations

import re

import pytest
import typer
from typer.testing import CliRunner

from trunnion.cli import app

COMMANDS = sorted(typer.main.get_command(app).commands)


def squeezed(text: str) -> str:
    return re.sub(r"[\s│╭╮╰╯─|]", "", text)


@pytest.mark.parametrize("name", COMMANDS)
@pytest.mark.parametrize("width", ["78", "240"])
def test_every_help_text_is_shown_whole(name, width, monkeypatch):
    monkeypatch.setenv("COLUMNS", width)
    monkeypatch.setenv("TERMINAL_WIDTH", width)
    shown = squeezed(CliRunner().invoke(app, [name, "--help"]).output)
    assert "<bool>" not in shown and "BOOLEAN" not in shown  # flags take no value
    written = app.registered_commands[[c.name for c in app.registered_commands].index(name)].callback
    texts = [
        part.help
        for hint in written.__annotations__.values()
        for part in getattr(eval_hint(hint, written), "__metadata__", ())
        if part.help
    ]
    assert squeezed((written.__doc__ or "").splitlines()[0]) in shown
    for text in texts:
        words = [squeezed(word) for word in text.split()]
        missing = [word for word in words if word not in shown]
        assert not missing, (text, shown)


def eval_hint(hint, function):
    return eval(hint, function.__globals__) if isinstance(hint, str) else hint


def test_some_help_has_brackets():
    assert "[s]" in CliRunner().invoke(app, ["lyapunov-spectrum", "--help"]).output
