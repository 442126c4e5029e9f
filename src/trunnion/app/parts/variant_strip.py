"""The kept variants of a page: a name each, their verdicts side by side, which of them are shown, and which is used."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import panel as pn

from trunnion.app.parts.widgets import Html, HtmlPane, column, heading, markup, wrapped

MOST_KEPT = 6
"""Variants that are kept at most: an address holds all of them."""
MOST_SHOWN = 3
"""Variants that are computed and shown beside the present line."""
WRAPPED = ".bk-btn { white-space: normal; overflow-wrap: anywhere; text-align: left; }"
"""Of a button that has a name in its words, however long."""
BESIDE, UPON = "beside each other", "on the same axes"


@dataclass
class KeptVariant:
    """A line that was kept: its name, what is computed, the file with its comments, and what is known of it.

    key : of its place on the page, while others come and go; is_shown : beside the present line.
    """

    key: str
    name: str
    toml: str
    file: str
    is_shown: bool = True
    verdict: Html | str = field(default="", compare=False)


class Actions(Protocol):
    """What the strip asks of the page."""

    def keep(self, name: str) -> None:
        """Keep the present line under a name."""

    def show_variant(self, key: str, is_shown: bool) -> None:
        """Show a variant beside the present line, or no more."""

    def swap(self, key: str) -> None:
        """Make a variant the present line, and keep that in its place."""

    def drop(self, key: str) -> None:
        """Keep a variant no more."""

    def compare_all_no_more(self) -> None:
        """Show none of them."""

    def arrange_variants(self, how: str) -> None:
        """Beside each other, or on the same axes."""


class VariantStrip:
    """The strip: a row for each variant and one for the present line."""

    def __init__(self, actions: Actions) -> None:
        self.actions = actions
        self.name = pn.widgets.TextInput(label="Name of the variant", placeholder="variant 1", width=150)
        keep = pn.widgets.Button(label="Keep this variant to compare", width=230, align="end")
        keep.on_click(lambda event: self._keep())
        self.how = pn.widgets.RadioButtonGroup(label="Variants", options=[BESIDE, UPON], value=BESIDE, margin=(4, 5))
        self.how.param.watch(lambda event: actions.arrange_variants(event.new), "value")
        self.none = pn.widgets.Button(label="Compare no more", width=140, disabled=True)
        self.none.on_click(lambda event: actions.compare_all_no_more())
        self.now = HtmlPane("", margin=(0, 5), sizing_mode="stretch_width")
        self.rows = column()
        self.panel = column(self.name, keep, self.rows, self.now, self.how, self.none)
        self._shape: tuple[Any, ...] = ()
        self._said: dict[str, Any] = {}

    def _keep(self) -> None:
        name, self.name.value = self.name.value, ""
        self.actions.keep(name.strip())

    def show(self, variants: Sequence[KeptVariant], now: Html | str) -> None:
        """The variants as they stand, and the verdict on the present line."""
        shape = tuple((one.key, one.name, one.is_shown) for one in variants)
        if shape != self._shape:
            self._shape = shape
            self._said = {one.key: HtmlPane("", margin=(0, 5), sizing_mode="stretch_width") for one in variants}
            self.rows.objects = [self._row(one) for one in variants]
        for one in variants:
            self._said[one.key].object = one.verdict
        self.now.object = markup("<div><b>now</b> {}</div>", now) if variants else ""
        self.name.placeholder = free_name(variants)
        self.none.disabled = not any(one.is_shown for one in variants)
        self.how.visible = bool(variants)

    def _row(self, one: KeptVariant) -> Any:
        def button(text: str, about: str, act: Callable[[], None]) -> Any:
            made = pn.widgets.Button(label=text, description=about, margin=(2, 3), stylesheets=[WRAPPED])
            made.on_click(lambda event: act())
            return made

        is_shown, word = one.is_shown, "Hide" if one.is_shown else "Show"
        acts = [
            button(
                f"{word} {one.name}",
                "beside the line now, or no more",
                lambda: self.actions.show_variant(one.key, not is_shown),
            ),
            button(
                f"Swap {one.name}", "make it the present line, and keep that one", lambda: self.actions.swap(one.key)
            ),
            button(f"Drop {one.name}", "keep it no more", lambda: self.actions.drop(one.key)),
        ]
        return column(heading(one.name), self._said[one.key], wrapped(*acts))


def free_name(variants: Sequence[KeptVariant]) -> str:
    """The first of "variant 1", "variant 2" that none has."""
    taken = {one.name for one in variants}
    return next(name for k in range(1, len(variants) + 2) if (name := f"variant {k}") not in taken)
