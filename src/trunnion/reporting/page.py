"""How pages are written: templates of this room and of those above, escaped, nothing left undefined."""

from __future__ import annotations

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined, select_autoescape

from trunnion.reporting.tables import with_signs


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
    return environment
