"""The program around the commands: what they are, remarks, and one line for whatever fails, see ``failures``."""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Callable
from typing import Any

import typer
from rich.markup import escape
from typer.core import TyperGroup

from trunnion._version import __version__
from trunnion.cli import describe, orders, output
from trunnion.cli.animate import animate
from trunnion.cli.app import app as serve_app
from trunnion.cli.ending import EndedBy
from trunnion.cli.failures import Interrupted, answer
from trunnion.cli.readers import TABLES_ANYWHERE
from trunnion.cli.reproduce import reproduce
from trunnion.cli.stability import analyze
from trunnion.cli.study import study
from trunnion.cli.typed import callback
from trunnion.cli.warm_up import warm_up
from trunnion.errors import InputRemark
from trunnion.registry import ANALYSES, found_at

INTERRUPTED = 130
"""What typer answers a Ctrl-C with, in silence."""


class OneLineGroup(TyperGroup):
    """Answers every failure with a line on stderr and the exit code of its kind."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        for command in (self, *self.commands.values()):
            _keep_brackets(command)
            _flags_without_a_value(command)

    def invoke(self, ctx: Any) -> Any:
        try:
            result = super().invoke(ctx)
        except KeyboardInterrupt as interrupt:
            raise Interrupted(*interrupt.args) from None
        if output.stopped():
            raise Interrupted("this is what was known by then")
        if EndedBy.asked:  # by a signal that came too late, or whose interruption something swallowed
            raise Interrupted("the result was complete and is written")
        return result

    def main(self, args: Any = None, prog_name: str | None = None, **extra: Any) -> Any:  # type: ignore[override]
        _open_streams()
        arguments = sys.argv[1:] if args is None else list(args)
        extra["standalone_mode"] = False
        with warnings.catch_warnings():
            _print_remarks()
            try:
                code = super().main(arguments, prog_name or "trunnion", **extra)
                if code == INTERRUPTED:  # typer's own answer, before and after a command runs, is silent
                    raise Interrupted
                sys.stdout.flush()
            except Exception as error:
                code = answer(error, arguments)
        sys.exit(code if isinstance(code, int) else 0)


def _keep_brackets(command: Any) -> None:
    """Help texts may hold units in brackets, which rich would take for its own marks."""
    for part in (command, *command.params):
        for text in ("help", "epilog"):
            if written := getattr(part, text, None):
                setattr(part, text, escape(written))


def _flags_without_a_value(command: Any) -> None:
    """A flag takes no value: help says no type behind it, nor behind --help, which is made when it is asked for."""
    for part in command.params:
        if getattr(part, "is_flag", False):
            part.metavar = ""
    made = command.get_help_option

    def help_option(ctx: Any) -> Any:
        option = made(ctx)
        if option is not None:
            option.metavar = ""
        return option

    command.get_help_option = help_option


def _open_streams() -> None:
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:  # closed by the caller
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))
        elif hasattr(stream, "reconfigure"):  # an old Windows console has no ω
            stream.reconfigure(errors="replace")


def _print_remarks() -> None:
    """Remarks as one line each, once; other warnings as Python prints them."""
    said: set[str] = set()
    usual = warnings.showwarning

    def show(message: Warning | str, category: type[Warning], *place: Any, **rest: Any) -> None:
        if not issubclass(category, InputRemark):
            usual(message, category, *place, **rest)
        elif str(message) not in said:
            said.add(str(message))
            print(f"remark: {' '.join(str(message).split())}", file=sys.stderr)

    warnings.simplefilter("always", InputRemark)
    warnings.showwarning = show  # type: ignore[assignment]


app = typer.Typer(
    cls=OneLineGroup,
    help="Torsional vibration and stability of drivelines with Hooke's joints.",
    epilog="FILE is a driveline as TOML (start one with: trunnion new two-shaft) or a name of the catalogue.",
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


@app.callback(invoke_without_command=True)
def _root(
    ctx: typer.Context,
    version: bool = typer.Option(False, "--version", help="Print the version and leave.", is_eager=True),
    tables_anywhere: bool = typer.Option(
        False, "--tables-anywhere", help="Read tables that FILE names wherever they lie, not only beside it."
    ),
) -> None:
    TABLES_ANYWHERE.set(tables_anywhere)
    if version:
        typer.echo(f"trunnion {__version__}")
        raise typer.Exit
    if ctx.invoked_subcommand is None:
        typer.echo(ctx.get_help())


COMMANDS: tuple[Callable[..., Any], ...] = (
    analyze,
    *(callback(one.name.replace("_", "-"), one.sentence, found_at(one.command)) for one in ANALYSES if one.command),
    callback("misfire", "Every cylinder out of work in turn: the worst, and the torques with it.", orders.misfire),
    study,
    callback(
        "animate", "The line in motion, in space: a page that plays it without a network, a GIF, or JSON.", animate
    ),
    reproduce,
    serve_app,
    warm_up,
    describe.catalogue,
    describe.components,
    describe.new,
    describe.export,
    describe.import_,
    describe.schema,
)
"""In the order of the help; each goes by the name of its function."""
for command in COMMANDS:
    app.command(command.__name__.rstrip("_").replace("_", "-"))(command)


def main(args: list[str] | None = None) -> None:
    """Entry point of the ``trunnion`` script."""
    EndedBy.hear()
    try:
        app(args)
    except KeyboardInterrupt:  # before a command was reached, or after it
        sys.exit(answer(Interrupted(), sys.argv[1:] if args is None else args))
    finally:
        try:  # nothing is called before it, or one could fall between
            EndedBy.ignore()
        except KeyboardInterrupt:
            pass  # it comes too late: the exit code stands
