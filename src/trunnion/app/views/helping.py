"""What would help: asks for remedies, lists them, and tries one at a click."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import panel as pn

from trunnion.analyses.assessment.own_limits import unlimited
from trunnion.app.calls import LINE, Call
from trunnion.app.pieces import column, markup, pane
from trunnion.app.variants import with_number
from trunnion.app.views.base import Host
from trunnion.equations.coefficients import assemble

MOST = 2
"""Changes that are looked for at each check."""


class Help:
    """A button that searches, and a button beside each change that makes it."""

    def __init__(self, session: Host) -> None:
        self.session = session
        self.keywords: Mapping[str, Any] = {}
        self.toml = ""
        self.search = pn.widgets.Button(label="What would help?", button_type="primary", width=180)
        self.search.on_click(lambda event: session.beside(self._search()))
        self.limits = pn.widgets.Button(label="State limits", width=140)
        self.limits.on_click(lambda event: session.state_limits())
        self.list = column()
        self.panel = column(pn.Row(self.search, self.limits, margin=0), self.list)

    def clear(self, needed: bool, keywords: Mapping[str, Any]) -> None:
        """A new verdict makes old remedies void."""
        self.keywords = keywords
        self.search.visible = needed
        self.limits.visible = needed and bool(unlimited(assemble(self.session.document.line)))
        if self.session.document.toml != self.toml:
            self.list.objects = []

    async def _search(self) -> None:
        self.toml = self.session.document.toml
        call = Call("tn.remedies", (LINE,), {**self.keywords, "most": MOST})
        found = await self.session.ask(call, "remedies", "now")
        self.session.locked(lambda: self._show(found))

    def _show(self, found: list[dict[str, Any]]) -> None:
        rows = []
        for remedy in found:
            button = pn.widgets.Button(label="Try it", width=80, align="center")
            button.on_click(lambda event, remedy=remedy: self._try(remedy))
            text = pane(remedy["sentence"])
            rows.append(pn.Row(button, text, sizing_mode="stretch_width", margin=0))
        none = markup("<p>No single change of stiffness, inertia, damping, angle or phase was found that helps.</p>")
        self.list.objects = rows or [pane(none)]

    def _try(self, remedy: dict[str, Any]) -> None:
        line = with_number(self.session.document.line, remedy["variable"], remedy["after"])
        self.session.edit(lambda document: document.set_numbers(line))
