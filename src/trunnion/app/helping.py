"""What would help: asks for remedies, lists them, and tries one at a click."""

from __future__ import annotations

import html
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import panel as pn

from trunnion.analyses.assessment.own_limits import unlimited
from trunnion.app.calls import LINE, Call
from trunnion.app.variants import with_number
from trunnion.equations.coefficients import assemble

if TYPE_CHECKING:
    from trunnion.app.session import Session

MOST = 2
"""Changes that are looked for at each check."""


def remedies_call(keywords: Mapping[str, Any]) -> Call:
    """The search for changes."""
    return Call("tn.remedies", (LINE,), {**keywords, "most": MOST})


class Help:
    """A button that searches, and a button beside each change that makes it."""

    def __init__(self, session: Session) -> None:
        self.session = session
        self.keywords: Mapping[str, Any] = {}
        self.toml = ""
        self.search = pn.widgets.Button(label="What would help?", button_type="primary", width=180)
        self.search.on_click(lambda event: self.session.beside(self._search()))
        self.limits = pn.widgets.Button(label="State limits", width=140)
        self.limits.on_click(lambda event: self.session.state_limits())
        self.list = pn.Column(sizing_mode="stretch_width", margin=0)
        row = pn.Row(self.search, self.limits, margin=0)
        self.panel = pn.Column(row, self.list, sizing_mode="stretch_width", margin=0)

    def clear(self, needed: bool, keywords: Mapping[str, Any]) -> None:
        """A new verdict makes old remedies void."""
        self.keywords = keywords
        self.search.visible = needed
        self.limits.visible = needed and bool(unlimited(assemble(self.session.document.line)))
        if self.session.document.toml != self.toml:
            self.list.objects = []

    async def _search(self) -> None:
        self.toml = self.session.document.toml
        found = await self.session.ask(remedies_call(self.keywords), "remedies", "now")
        self.session.locked(lambda: self._show(found))

    def _show(self, found: list[dict[str, Any]]) -> None:
        rows = []
        for remedy in found:
            button = pn.widgets.Button(label="Try it", width=80, align="center")
            button.on_click(lambda event, remedy=remedy: self._try(remedy))
            text = pn.pane.HTML(f"<span>{html.escape(remedy['sentence'])}</span>", sizing_mode="stretch_width")
            rows.append(pn.Row(button, text, sizing_mode="stretch_width", margin=0))
        none = "<p>No single change of stiffness, inertia, damping, angle or phase was found that helps.</p>"
        self.list.objects = rows or [pn.pane.HTML(none)]

    def _try(self, remedy: dict[str, Any]) -> None:
        line = with_number(self.session.document.line, remedy["variable"], remedy["after"])
        self.session.edit(lambda document: document.set_numbers(line))
