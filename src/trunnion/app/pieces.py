"""Panes, columns and pieces of HTML in the one look of the page."""

from __future__ import annotations

import base64
import html
from collections.abc import Iterable, Mapping
from typing import Any

import panel as pn


class Quiet:
    """While it is on, widgets change because the program says so, and nobody need hear of it: ``with quiet: …``."""

    def __init__(self) -> None:
        self.on = False

    def __bool__(self) -> bool:
        return self.on

    def __enter__(self) -> None:
        self.on = True

    def __exit__(self, *failure: object) -> None:
        self.on = False


def pane(text: str = "", **more: Any) -> Any:
    """A place for HTML."""
    return pn.pane.HTML(text, sizing_mode="stretch_width", **more)


def column(*parts: Any, **more: Any) -> Any:
    """Parts one below the other."""
    return pn.Column(*parts, sizing_mode="stretch_width", margin=0, **more)


def heading(text: str) -> Any:
    """A line that opens a part of the page."""
    return pn.pane.HTML(f"<h2 style='font-size:16px;margin:8px 0 0'>{plain(text)}</h2>", margin=(0, 5))


def plain(words: object) -> str:
    """Words as they are, in HTML."""
    return html.escape(str(words))


def pre(words: object) -> str:
    """Words whose lines stay as they are."""
    return f"<pre>{plain(words)}</pre>"


def small(inner: str, marks: str = "") -> str:
    """HTML beside a picture; ``marks`` are attributes of its element."""
    return f"<div style='font-size:13px' {marks}>{inner}</div>"


def items(words: Iterable[object]) -> str:
    """A list of sentences."""
    return f"<ul>{''.join(f'<li>{plain(one)}</li>' for one in words)}</ul>"


def facts(rows: Mapping[str, object]) -> str:
    """A table of two columns: what, and its value, which tests find by that name."""
    cells = (f"<tr><th>{name}</th><td data-value='{name}'>{plain(value)}</td></tr>" for name, value in rows.items())
    return f"<table class='plain'>{''.join(cells)}</table>"


def picture(svg: str, about: str, width: int) -> str:
    """A picture, ``width`` pixels at most."""
    content = base64.b64encode(svg.encode()).decode()
    return (
        f"<img alt='{plain(about)}' style='width:100%;max-width:{width}px' src='data:image/svg+xml;base64,{content}'>"
    )
