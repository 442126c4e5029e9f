"""How pages are written: templates of this room and of those above, escaped, nothing left undefined."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined, select_autoescape

from trunnion.reporting.tables import TIED, with_signs
from trunnion.writing import written_whole

UNIT = re.compile(r"(?<=[0-9]) ((?:%|rpm|rad/s|1/s|kg m²|[kMG]?(?:N m|N|W|Pa|Hz)|[km]?m|°C)(?!\w))")
"""What stands behind a number and belongs to it."""


@dataclass(frozen=True)
class HtmlPage:
    """A page as text. ``save`` writes it; a notebook shows it."""

    html: str

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the page; an existing file is replaced only when all is written."""
        with written_whole(path) as temporary:
            temporary.write_text(self.html, encoding="utf-8", newline="\n")
        return Path(path)

    def _repr_html_(self) -> str:
        from html import escape

        return f'<iframe srcdoc="{escape(self.html)}" style="width:100%;height:80vh;border:0"></iframe>'


def environment(*parts: str) -> Environment:
    """Templates of ``parts`` of the package, and of reporting."""
    environment = Environment(
        loader=ChoiceLoader([PackageLoader(f"trunnion.{part}", "templates") for part in (*parts, "reporting")]),
        autoescape=select_autoescape(default=True),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["signs"] = with_signs
    environment.filters["tied"] = tied
    environment.filters["with_units"] = with_units
    environment.filters["in_css"] = in_css
    environment.filters["formula"] = formula
    return environment


def tied(head: str) -> str:
    """A column head whose unit in brackets stays on one line."""
    return re.sub(r"\[[^\]]*\]", lambda unit: unit[0].replace(" ", TIED), head)


def with_units(text: str) -> str:
    """Text in which no line ends between a number and its unit."""
    return UNIT.sub(lambda found: TIED + found[1].replace(" ", TIED), str(text))


def formula(text: str) -> str:
    """A formula, escaped before, with its indices set low: σ_B, T_Kmax."""
    return re.sub(r"(?<!\w)(\w)_([A-Za-z]+)", r"\1<sub>\2</sub>", str(text))


def in_css(text: str) -> str:
    """Text as a string of a style sheet holds it: whatever is no letter or digit escaped, so that it ends nothing."""
    return "".join(one if one.isascii() and one.isalnum() else f"\\{ord(one):06x}" for one in text)
