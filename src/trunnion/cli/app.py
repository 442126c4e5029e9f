"""The command ``app``: the driveline in the browser."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

import trunnion as tn
from trunnion.cli.readers import read_line
from trunnion.errors import InputError

STARTER = "two-shaft"


def app(
    file: Annotated[
        str | None,
        typer.Argument(metavar="[FILE]", help="Driveline file (TOML) or a name of the catalogue; default: a starter."),
    ] = None,
    port: Annotated[int | None, typer.Option("--port", help="Port to listen on; default: a free one.")] = None,
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Print the address, open nothing.")] = False,
    threads: Annotated[
        int | None, typer.Option("--threads", help="Threads of each computing process; default: one per core.")
    ] = None,
) -> None:
    """Show the driveline in the browser, on this machine only, until Ctrl-C."""
    cores = os.cpu_count() or 1
    if threads is not None and not 1 <= threads <= 4 * cores:
        remedy = f"give 1 to {4 * cores}"
        raise InputError("is not a number of threads for this machine", key="--threads", value=threads, remedy=remedy)
    from trunnion.app.serve import serve

    serve(_text(file), port=port, browser=not no_browser, threads=threads or cores, say=typer.echo)


def _text(file: str | None) -> str:
    """The driveline file to begin with, checked, with the tables that it names."""
    from trunnion.driveline.files import dumps_alone
    from trunnion.driveline.starter import starter

    if file is None:
        return starter(STARTER)
    line = read_line(file)
    return dumps_alone(line, Path(file)) if Path(file).is_file() else tn.dumps(line)
