"""``trunnion reproduce``: a paper's figures, tables and conclusions computed anew."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.places import DEFAULT_FOLDER, CommandOutput, answer
from trunnion.cli.typed import Json


def reproduce(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME",
            help="two-shaft-cardan, bicardan-elastic, three-shaft-cardan, double-tripod or gear-rattle; or all.",
        ),
    ],
    folder: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="PATH", help="Folder for pictures and page; default: NAME."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Compute a published study anew: figures, tables published | computed | remark, errata, conclusions.

    With "all" every study goes into one page with an index.
    """
    from trunnion.cli.files import check_folder
    from trunnion.papers.shared.result import Reproductions

    target = folder or DEFAULT_FOLDER / name
    check_folder(target)
    with output.progress(f"reproducing {name}") as advance:
        found = tn.reproduce(name, progress=advance)
    if isinstance(found, Reproductions):
        content: dict[str, object] = {"studies": [_plain(study) for study in found.studies]}
    else:
        content = _plain(found)
    answer("reproduce", found.save(target), as_json, CommandOutput(found, content=lambda: content))


def _plain(found: Any) -> dict[str, object]:
    """A study as JSON."""
    return {
        "name": found.name,
        "title": found.title,
        "source": found.source,
        "tables": [_table(comparison) for comparison in found.tables],
        "errata": _table(found.errata),
        "argument": list(found.argument.steps) if found.argument else [],
        "conclusions": [asdict(c) for c in found.conclusions],
    }


def _table(comparison: Any) -> dict[str, object]:
    return {"title": comparison.title, "note": comparison.note, "rows": [asdict(row) for row in comparison.rows]}
