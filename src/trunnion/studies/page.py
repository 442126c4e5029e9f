"""A reproduction as one page: figures, tables, errata and conclusions, nothing fetched."""

from __future__ import annotations

from collections.abc import Sequence

from trunnion._version import __version__
from trunnion.reporting.pictures import Picture, address
from trunnion.studies.result import LABELS, PaperFigure, Reproduction


def page(studies: Sequence[tuple[Reproduction, Sequence[bytes]]]) -> str:
    """HTML of one study or several, with an index on top; each with the PNGs of its figures and then its evidence."""
    from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined, select_autoescape

    templates = [PackageLoader(f"trunnion.{part}", "templates") for part in ("studies", "reporting")]
    environment = Environment(
        loader=ChoiceLoader(templates),
        autoescape=select_autoescape(default=True),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    shown = [
        (found, *_split(found, [Picture(address("image/png", png), f.caption, "") for f, png in _named(found, drawn)]))
        for found, drawn in studies
    ]
    return environment.get_template("reproduction.html.j2").render(studies=shown, labels=LABELS, version=__version__)


def _named(found: Reproduction, drawn: Sequence[bytes]) -> list[tuple[PaperFigure, bytes]]:
    return list(zip((*found.figures, *found.evidence), drawn, strict=True))


def _split(found: Reproduction, pictures: list[Picture]) -> tuple[list[tuple[PaperFigure, Picture]], ...]:
    count = len(found.figures)
    return (
        list(zip(found.figures, pictures[:count], strict=True)),
        list(zip(found.evidence, pictures[count:], strict=True)),
    )
