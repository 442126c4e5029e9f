"""What would help: asks for remedies, lists them, and tries one at a click."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from typing import Any

import panel as pn

from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.variants import with_number
from trunnion.app.parts.widgets import column, markup, pane
from trunnion.app.views.base import Host
from trunnion.errors import TrunnionError

MOST = 2
"""Changes that are looked for at each check."""


class RemedyButtons:
    """A button that searches, and a button beside each change that makes it."""

    def __init__(self, session: Host) -> None:
        self.session = session
        self.keywords: Mapping[str, Any] = {}
        self.question: tuple[str, Mapping[str, Any]] = ("", {})
        self.search = pn.widgets.Button(label="What would help?", button_type="primary", width=180)
        self.search.on_click(lambda event: session.beside(self._search()))
        self.limits = pn.widgets.Button(label="State limits", width=140)
        self.limits.on_click(lambda event: session.state_limits())
        self.list = column()
        self.panel = column(pn.Row(self.search, self.limits, margin=0), self.list)

    def clear(self, needed: bool, keywords: Mapping[str, Any]) -> None:
        """A verdict on another line, or under another load, makes old remedies void."""
        self.keywords = keywords
        self.search.visible = needed
        self.limits.visible = needed and self._lacks_limits()
        if self._asked_now() != self.question:
            self.list.objects = []

    def _lacks_limits(self) -> bool:
        from trunnion.design.assessment.stated_limits import unlimited  # no first page needs them
        from trunnion.equations.coefficients import assemble

        return bool(unlimited(assemble(self.session.document.line)))

    def _asked_now(self) -> tuple[str, Mapping[str, Any]]:
        """The line and the load that remedies would be looked for."""
        return self.session.document.toml, self.keywords

    async def _search(self) -> None:
        self.question = self._asked_now()
        call = Call("tn.remedies", (LINE,), {**self.keywords, "most": MOST})
        self.session.locked(lambda: self._say("Looking for the smallest changes that help …"))
        try:
            found = await self.session.ask(call, "remedies", "now", says=True)
        except asyncio.CancelledError:
            self.session.locked(lambda: self._say("The search was ended before its answer."))
            raise
        except TrunnionError:
            self.session.locked(lambda: self._say("The search gave no answer."))
            raise
        self.session.locked(lambda: self._show(found))

    def _say(self, words: str) -> None:
        """A sentence in place of the list; while something is looked for it is not looked for again."""
        self.search.disabled = words.endswith("…")
        self.list.objects = [pane(words)]

    def _show(self, found: list[dict[str, Any]]) -> None:
        self.search.disabled = False
        rows = []
        for remedy in found:
            button = pn.widgets.Button(label="Try it", width=80, align="center")
            button.on_click(lambda event, remedy=remedy: self._try(remedy))
            text = pane(remedy["sentence"])
            rows.append(pn.Row(button, text, sizing_mode="stretch_width", margin=0))
        none = markup("<p>No single change of stiffness, inertia, damping, angle or phase was found that helps.</p>")
        self.list.objects = rows or [pane(none)]

    def _try(self, remedy: dict[str, Any]) -> None:
        if self._asked_now() != self.question:
            return  # it is a change of another line, and on its way off the page
        line = with_number(self.session.document.line, remedy["variable"], remedy["after"])
        self.session.edit(lambda document: document.set_numbers(line))
