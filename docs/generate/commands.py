"""A page with the help of every command."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from typer.main import get_command

from generate.markdown import table, write


def _option(parameter: Any) -> tuple[str, str]:
    names = ", ".join(f"`{one}`" for one in (*parameter.opts, *parameter.secondary_opts))
    return (
        names if parameter.param_type_name == "option" else f"`{(parameter.metavar or parameter.name).upper()}`"
    ), parameter.help or ""


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
            (command.help or "").replace("\b", ""),
            table(("option", "says"), rows),
        ]
    write(path, "\n\n".join(parts))
