"""Commands about descriptions: the catalogue, components, starter files, the schema of the format."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

import trunnion as tn
from trunnion.cli.files import check_not_read
from trunnion.cli.output import table, write_json
from trunnion.cli.readers import read_line
from trunnion.cli.typed import Json
from trunnion.errors import InputError

Output = Annotated[
    Path | None, typer.Option("--output", "-o", metavar="PATH", help="Driveline file to write; default: print it.")
]


def catalogue(
    name: Annotated[str | None, typer.Argument(metavar="[NAME]", help="Print this driveline as TOML.")] = None,
    output: Output = None,
    as_json: Json = False,
) -> None:
    """List the published drivelines, or print or write one as a file to start from."""
    from trunnion.papers.entries import entries

    if name is None:
        if output is not None:
            raise InputError("belongs to one driveline", key="--output", value=str(output), remedy="name it before")
        rows = [{"name": e.name, "title": e.title, "source": e.source} for e in entries()]
        if as_json:
            write_json("catalogue", {"entries": rows})
        else:
            table(rows)
        return
    found = tn.catalogue(name)
    if output is not None and not isinstance(found, tn.Driveline):
        raise InputError("is not a driveline", key="catalogue", value=name, remedy="leave --output out; it is printed")
    text = tn.dumps(found) if isinstance(found, tn.Driveline) else f"{found}\n"
    entry = next(e for e in entries() if e.name == name)
    content = {"name": name, "title": entry.title, "source": entry.source, "toml": text}
    _give("catalogue", f"# {entry.title}\n# {entry.source}\n\n{text}", content, output, as_json)


def components(
    name: Annotated[
        str | None, typer.Argument(metavar="[MAKER/TYPE]", help="Print this component as an element.")
    ] = None,
    as_json: Json = False,
) -> None:
    """List the components whose sheets are typed in, or print one as an element of a file."""
    from trunnion.driveline.component_files import FOLDER, find, user_folder
    from trunnion.driveline.component_files import components as every
    from trunnion.driveline.files import element_text

    if name is None:
        rows = [
            {
                "component": one.sheet.component,
                "version": one.sheet.version,
                "type": one.kind,
                "source": f"{one.sheet.source}, {one.sheet.date}",
                "kept": one.place,
            }
            for one in every()
        ]
        if as_json:
            write_json("components", {"components": rows})
            return
        table(rows)
        typer.echo(f"Your own files lie in {user_folder()}, or in {FOLDER} beside a line.")
        return
    found = find(name)
    text = element_text(found.element())
    if as_json:
        sheet = found.sheet.stated
        write_json("components", {"name": found.sheet.component, "type": found.kind, "sheet": sheet, "toml": text})
        return
    typer.echo(f'# component = "{found.sheet.component}" writes this in one line\n{text}', nl=False)


def new(
    starter: Annotated[
        str | None, typer.Argument(metavar="[STARTER]", help="Starter to write; without one, list them.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="PATH", help="File to write; default: STARTER.toml here.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
    as_json: Json = False,
) -> None:
    """Write a commented driveline file to start from."""
    from trunnion.driveline.starter import STARTERS
    from trunnion.driveline.starter import starter as starter_text

    if starter is None:
        if output is not None:
            remedy = f"write: trunnion new two-shaft --output {output}, say"
            raise InputError("no starter is named", key="--output", value=str(output), remedy=remedy)
        rows = [{"starter": name, "what it is": about} for name, about in STARTERS.items()]
        if as_json:
            write_json("new", {"starters": rows})
        else:
            table(rows)
        return
    text = starter_text(starter)
    target = output or Path(f"{starter}.toml")
    if target.exists() and not target.is_dir() and not force:
        remedy = "choose another name, or replace it with --force"
        raise InputError("exists already", key="--output", value=str(target), remedy=remedy)
    _write(target, text)
    if as_json:
        write_json("new", {"written": str(target)})
    else:
        typer.echo(f"wrote {target}; look at it with: trunnion analyze {target}")


def _write(target: Path, text: str) -> None:
    from trunnion.writing import written_whole

    with written_whole(target) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")


def export(
    file: Annotated[str, typer.Argument(metavar="FILE", help="Driveline file, or a name of the catalogue.")],
    to: Annotated[str, typer.Option("--to", metavar="TARGET", help="csv, matlab, opentorsion, modelica, c or fmu.")],
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="PATH", help=".csv, .mat, .py, .mo, .c or .fmu file to write.")
    ],
    fmi: Annotated[
        int | None, typer.Option("--fmi", metavar="2|3", help="Version of FMI of an FMU; 2 by default.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Write a line for other programs: a table, a state space, openTorsion, Modelica, C, or an FMU."""
    check_not_read([output], [file])
    besides = tn.export_line(read_line(file), output, to, fmi=fmi)
    if as_json:
        write_json("export", {"written": str(output), "not_written": list(besides)})
        return
    typer.echo(f"wrote {output}")
    if besides:
        typer.echo(f"Not in it: {', '.join(besides)}.")


def import_(
    file: Annotated[str, typer.Argument(metavar="FILE", help="File that trunnion export wrote: .csv, .py or .mo.")],
    output: Output = None,
    as_json: Json = False,
) -> None:
    """Read a line from a table, a script for openTorsion or a Modelica model, as a driveline file."""
    text = tn.dumps(tn.import_line(file))
    _give("import", text, {"toml": text}, output, as_json)


def _give(command: str, text: str, content: dict[str, Any], output: Path | None, as_json: bool) -> None:
    """A driveline file in ``output``, printed where none is asked for."""
    if output is not None:
        if output.suffix != ".toml":
            raise InputError("does not end in .toml", key="--output", value=str(output), remedy="a driveline file does")
        _write(output, text)
    if as_json:
        write_json(command, content if output is None else {"written": str(output), **content})
    elif output is None:
        typer.echo(text, nl=False)
    else:
        typer.echo(f"wrote {output}; look at it with: trunnion analyze {output}")


def schema(as_json: Json = False) -> None:
    """Print the JSON Schema of driveline files, with the SI unit of every quantity."""
    from trunnion.driveline.schema import json_schema

    typer.echo(json.dumps(json_schema(), indent=2))
