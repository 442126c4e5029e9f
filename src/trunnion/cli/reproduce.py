"""``trunnion reproduce``: a paper's figures, tables and conclusions computed anew."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from trunnion.cli import output
from trunnion.cli.options import Json


def reproduce(
    name: Annotated[
        str,
        typer.Argument(metavar="NAME", help="two-shaft-cardan, three-shaft-cardan, double-tripod or gear-rattle."),
    ],
    folder: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="DIR", help="Folder for pictures and page; default: NAME."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Compute a published study anew: figures, tables published | computed | remark, errata, conclusions."""
    from trunnion.cli.files import check_folder
    from trunnion.cli.report import print_written
    from trunnion.studies.reproduce import reproduce as compute
    from trunnion.studies.result import Comparison

    target = folder or Path("trunnion-out") / name
    check_folder(target)
    with output.progress(f"reproducing {name}") as advance:
        found = compute(name, progress=advance)
    written = found.save(target)

    def plain(table: Comparison) -> dict[str, object]:
        return {"title": table.title, "note": table.note, "rows": [vars(row) for row in table.rows]}

    if as_json:
        content = {
            "name": found.name,
            "title": found.title,
            "source": found.source,
            "tables": [plain(table) for table in found.tables],
            "errata": plain(found.errata),
            "conclusions": [vars(c) for c in found.conclusions],
            "written": [str(path) for path in written],
        }
        output.write_json("reproduce", content)
        return
    out = output.console()
    out.print(str(found), soft_wrap=True)
    print_written(out, written)
