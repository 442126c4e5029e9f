"""The program around the commands: exit codes, one-line errors, remarks, Ctrl-C.

Exit codes are 0, 1 (computation failed), 2 (bad input, mistyped commands included) and 130 (Ctrl-C).
"""

from __future__ import annotations

import sys
import warnings
from typing import Any, cast

import typer
from typer.core import TyperGroup

from trunnion._version import __version__
from trunnion.cli import describe, study
from trunnion.cli.chaos import certify_chaos, lyapunov_spectrum, poincare_map
from trunnion.cli.kinetostatics import kinetostatics
from trunnion.cli.motion import periodic_response, run_up, simulate
from trunnion.cli.rattle import frequency_response, sweep
from trunnion.cli.reproduce import reproduce
from trunnion.errors import InputRemark, TrunnionError

# Usage errors have no public name in typer; this base has been that of its BadParameter in every version.
_UsageError = cast("type[Exception]", typer.BadParameter.__mro__[1])


class _Interrupted(Exception):
    """Ctrl-C, under a name that typer does not answer itself."""


class OneLineGroup(TyperGroup):
    """Answers every failure with one line on stderr and the exit code of its kind."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            raise _Interrupted from None

    def main(self, args: Any = None, prog_name: str | None = None, **extra: Any) -> Any:  # type: ignore[override]
        for stream in (sys.stdout, sys.stderr):  # an old Windows console has no ω
            if hasattr(stream, "reconfigure"):
                stream.reconfigure(errors="replace")
        extra["standalone_mode"] = False
        with warnings.catch_warnings():
            _print_remarks()
            try:
                code = super().main(args, prog_name or "trunnion", **extra)
            except _Interrupted:
                code = _fail("interrupted; nothing was written", 130)
            except TrunnionError as error:
                code = _fail(str(error), error.exit_code)
            except _UsageError as error:
                code = _fail(_message(error), 2)
            except MemoryError:
                code = _fail("not enough memory; ask for fewer points", 1)
            except OSError as error:
                where = f"{error.filename}: " if error.filename else ""
                code = _fail(f"{where}{error.strerror or error}", 1)
        sys.exit(code if isinstance(code, int) else 0)


def _message(error: Any) -> str:
    text: str = error.format_message()
    return text if "--help" in text else f"{text.rstrip('.')}; try --help"


def _fail(message: str, code: int) -> int:
    print(f"error: {' '.join(message.split())}", file=sys.stderr)
    return code


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
) -> None:
    if version:
        typer.echo(f"trunnion {__version__}")
        raise typer.Exit
    if ctx.invoked_subcommand is None:
        typer.echo(ctx.get_help())


app.command("analyze")(study.analyze)
app.command("stability")(study.stability)
app.command("stability-chart")(study.stability_chart)
app.command("natural-frequencies")(study.natural_frequencies)
app.command("resonance-speeds")(study.resonance_speeds)
app.command("kinetostatics")(kinetostatics)
app.command("simulate")(simulate)
app.command("periodic-response")(periodic_response)
app.command("run-up")(run_up)
app.command("frequency-response")(frequency_response)
app.command("sweep")(sweep)
app.command("lyapunov-spectrum")(lyapunov_spectrum)
app.command("poincare-map")(poincare_map)
app.command("certify-chaos")(certify_chaos)
app.command("reproduce")(reproduce)
app.command("catalogue")(describe.catalogue)
app.command("new")(describe.new)
app.command("schema")(describe.schema)


def main(args: list[str] | None = None) -> None:
    """Entry point of the ``trunnion`` script."""
    app(args)
