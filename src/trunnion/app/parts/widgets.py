"""Panes, columns and pieces of HTML in the one look of the page.

Names and sentences reach the page through files and addresses that anybody may have written. What is HTML is therefore
of a type of its own, ``Html``, which ``markup`` alone makes from a template in this program; every value put into the
template is escaped. A pane shows ``Html`` as it is and any other text as text.
"""

from __future__ import annotations

import base64
from collections.abc import Iterable, Mapping
from html import escape
from string import Formatter
from typing import Any

import panel as pn

FAINT = {"opacity": "0.35", "transition": "opacity 0.15s 0.25s"}
FULL = {"opacity": "1", "transition": "none"}
"""How a part is shown that belongs to another line, or to other settings, than the page; and how one is that does not.

Panel leaves a style of a picture as it was that is not named any more."""


class Html(str):
    """Text that is HTML; made by ``markup`` and ``joined`` only."""

    __slots__ = ()


class _Escaping(Formatter):
    """Formats values into a template of HTML, escaping all that is not HTML itself."""

    def format_field(self, value: Any, format_spec: str) -> str:
        return str(value) if isinstance(value, Html) else escape(format(value, format_spec))

    def convert_field(self, value: Any, conversion: Any) -> Any:
        if conversion:
            raise ValueError("no conversions: they would make text of what is HTML")
        return value


def markup(template: str, *values: object, **named: object) -> Html:
    """HTML from a template with places as in ``str.format``; whatever is put there is shown as the text that it is."""
    return Html(_Escaping().vformat(template, values, named))


def joined(parts: Iterable[object]) -> Html:
    """Pieces of HTML one after the other."""
    return Html("".join(markup("{}", part) for part in parts))


class ProgrammaticChange:
    """While it is on, widgets change because the program says so, and nobody need hear of it: ``with programmatic:
    …``."""

    def __init__(self) -> None:
        self.on = False

    def __bool__(self) -> bool:
        return self.on

    def __enter__(self) -> None:
        self.on = True

    def __exit__(self, *failure: object) -> None:
        self.on = False


class HtmlPane(pn.pane.HTML):
    """A place for HTML. Text that is not marked as HTML is shown as it is."""

    def _transform_object(self, obj: Any) -> dict[str, Any]:
        shown: dict[str, Any] = super()._transform_object(str.__str__(markup("{}", obj or "")))
        return shown


def pane(content: str = "", **more: Any) -> Any:
    """A place for HTML, as wide as there is place."""
    return HtmlPane(content, sizing_mode="stretch_width", **more)


def column(*parts: Any, **more: Any) -> Any:
    """Parts one below the other."""
    return pn.Column(*parts, sizing_mode="stretch_width", margin=0, **more)


def wrapped(*parts: Any, **more: Any) -> Any:
    """Parts beside each other, as far as there is place.

    Panel's FlexBox compiles text to JavaScript in the browser, and its Row is never narrower than all of its parts."""
    styles = {"flex-direction": "row", "flex-wrap": "wrap", **more.pop("styles", {})}
    return pn.Column(*parts, sizing_mode="stretch_width", margin=0, styles=styles, **more)


def faint(panel: Any, is_faint: bool) -> None:
    """Show a part faintly, or as it is; what lasts shorter than the eye minds changes nothing."""
    now = FAINT if is_faint else FULL
    if any(panel.styles.get(key, FULL[key]) != value for key, value in now.items()):
        panel.styles = {**panel.styles, **now}


def heading(text: str) -> Any:
    """A line that opens a part of the page."""
    return HtmlPane(markup("<h2 style='font-size:16px;margin:8px 0 0'>{}</h2>", text), margin=(0, 5))


def pre(words: object) -> Html:
    """Words whose lines stay as they are."""
    return markup("<pre>{}</pre>", words)


def lines(words: object) -> Html:
    """The same in the letters of the page."""
    return joined(markup("<div>{}</div>", one) for one in str(words).split("\n"))


def small(inner: object, **marks: object) -> Html:
    """Words beside a picture; ``marks`` are attributes of its element, those that begin with data_ with a hyphen."""
    named = [markup(" {}='{}'", name.rstrip("_").replace("_", "-"), value) for name, value in marks.items()]
    return markup("<div style='font-size:13px'{}>{}</div>", joined(named), inner)


def items(words: Iterable[object]) -> Html:
    """A list of sentences."""
    return markup("<ul>{}</ul>", joined(markup("<li>{}</li>", one) for one in words))


def facts(rows: Mapping[str, object]) -> Html:
    """A table of two columns: what, and its value, which tests find by that name."""
    cells = (markup("<tr><th>{0}</th><td data-value='{0}'>{1}</td></tr>", *row) for row in rows.items())
    return markup("<table class='plain'>{}</table>", joined(cells))


def picture(svg: str, about: str, width: int) -> Html:
    """A picture, ``width`` pixels at most. As an image it runs no script, whatever stands in it."""
    content = base64.b64encode(svg.encode()).decode()
    template = "<img class='picture' alt='{}' style='width:100%;max-width:{}px' src='data:image/svg+xml;base64,{}'>"
    return markup(template, about, width, content)
