"""``trunnion reproduce``: a paper's figures, tables and conclusions computed anew."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from trunnion.cli import output
from trunnion.cli.options import Json

if TYPE_CHECKING:
    from trunnion.studies.result import Comparison, Reproduction


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
        typer.Option("--output", "-o", metavar="DIR", help="Folder for pictures and page; default: NAME."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Compute a published study anew: figures, tables published | computed | remark, errata, conclusions.

    With "all" every study goes into one page with an index.
    """
    from trunnion.cli.files import check_folder
    from trunnion.cli.report import print_written
    from trunnion.studies.reproduce import reproduce as compute
    from trunnion.studies.result import Reproductions

    target = folder or Path("trunnion-out") / name
    check_folder(target)
    with output.progress(f"reproducing {name}") as advance:
        found = compute(name, progress=advance)
    written = found.save(target)

    if as_json:
        studies = found.studies if isinstance(found, Reproductions) else (found,)
        paths = [str(path) for path in written]
        contents = [_plain(study) for study in studies]
        content = {"studies": contents} if isinstance(found, Reproductions) else contents[0]
        output.write_json("reproduce", {**content, "written": paths})
        return
    out = output.console()
    out.print(str(found), soft_wrap=True)
    print_written(out, written)


def _plain(found: Reproduction) -> dict[str, object]:
    """A study as JSON."""

    def table(comparison: Comparison) -> dict[str, object]:
        rows = [vars(row) for row in comparison.rows]
        return {"title": comparison.title, "note": comparison.note, "rows": rows}

    return {
        "name": found.name,
        "title": found.title,
        "source": found.source,
        "tables": [table(comparison) for comparison in found.tables],
        "errata": table(found.errata),
        "argument": list(found.argument.steps) if found.argument else [],
        "conclusions": [vars(c) for c in found.conclusions],
    }
