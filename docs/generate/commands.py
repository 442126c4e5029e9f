"""A page with the help of every command."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from typer.main import get_command

from generate.markdown import table, write


def _option(parameter: Any) -> tuple[str, str]:
    names = ", ".join(f"`{one}`" for one in (*parameter.opts, *parameter.secondary_opts))
    return (
        names if parameter.param_type_name == "option" else f"`{(parameter.metavar or parameter.name).upper()}`"
    ), typed(parameter.help or "")


def typed(text: str) -> str:
    """Options in a text as they are typed, in which nothing is set as a dash."""
    return re.sub(r"(?<![\w`-])--[a-z][a-z-]*", lambda option: f"`{option[0]}`", text)


def about(text: str) -> str:
    """The help of a command, its examples as lines to copy."""
    said, found, examples = text.replace("\b", "").partition("Example")
    if not found:
        return typed(said)
    lines = examples.lstrip("s").removeprefix(":").replace("\n", " ").split("trunnion ")
    calls = [re.sub(r",? then$", "", f"trunnion {' '.join(one.split())}".rstrip(" ,")) for one in lines[1:]]
    return "\n".join([typed(said), "```sh", *calls, "```"])


def write_page(path: Path) -> None:
    """Every command with what it does and takes."""
    from trunnion.cli import app

    group: Any = get_command(app)
    parts = [
        "# Commands",
        "`trunnion COMMAND FILE`: FILE is a driveline file or a name of the catalogue. This page holds what `--help` prints.",
    ]
    for name, command in group.commands.items():
        rows = [_option(one) for one in command.params if one.name != "help"]
        parts += [
            f"(command-{name})=\n## {name}",
            about(command.help or ""),
            table(("option", "says"), rows),
        ]
    write(path, "\n\n".join(parts))
