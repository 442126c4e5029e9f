"""A reproduction as one page: figures, tables, errata and conclusions, nothing fetched."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from trunnion._version import __version__
from trunnion.reporting.pictures import pixels
from trunnion.studies.result import Reproduction

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def page(found: Reproduction, drawn: Sequence[Figure]) -> str:
    """HTML of ``found``; ``drawn`` are its figures followed by its evidence."""
    from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined, select_autoescape

    templates = [PackageLoader(f"trunnion.{part}", "templates") for part in ("studies", "reporting")]
    environment = Environment(
        loader=ChoiceLoader(templates),
        autoescape=select_autoescape(default=True),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    every = (*found.figures, *found.evidence)
    shown = [(f, pixels(picture, f.caption)) for f, picture in zip(every, drawn, strict=True)]
    return environment.get_template("reproduction.html.j2").render(
        found=found,
        figures=shown[: len(found.figures)],
        evidence=shown[len(found.figures) :],
        version=__version__,
    )
