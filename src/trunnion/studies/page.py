"""A reproduction as one page: figures, tables, errata and conclusions, nothing fetched."""

from __future__ import annotations

from collections.abc import Sequence

from trunnion._version import __version__
from trunnion.reporting.page import environment
from trunnion.reporting.pictures import address
from trunnion.studies.result import LABELS, Reproduction


def page(studies: Sequence[tuple[Reproduction, Sequence[bytes]]]) -> str:
    """HTML of one study or several, with an index on top; each with the PNGs of its figures and then its evidence."""
    shown = []
    for found, drawn in studies:
        addresses = [address("image/png", png) for png in drawn]
        count = len(found.figures)
        figures = list(zip(found.figures, addresses[:count], strict=True))
        shown.append((found, figures, list(zip(found.evidence, addresses[count:], strict=True))))
    template = environment("studies").get_template("reproduction.html.j2")
    return template.render(studies=shown, labels=LABELS, version=__version__)
