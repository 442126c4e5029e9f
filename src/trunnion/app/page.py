"""The page around the views: header, choice of view, messages, progress, sliders, the place of the pictures."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import panel as pn

from trunnion.app.parts.widgets import HtmlPane, ProgrammaticChange, column, heading, joined, markup, pane
from trunnion.app.themes import css
from trunnion.app.views.base import View

MOST_OFTEN = 0.1
"""Seconds between two reports of progress."""

_TEMPLATE = """
{% extends base %}
{% block title %}Trunnion{% endblock %}
{% block preamble %}
<meta name="viewport" content="width=device-width, initial-scale=1">
<script>
// The theme that was chosen here before, from the first moment on; none leaves it to the system.
const themes = ["", "light", "dark"], named = { "": "as the system", light: "light", dark: "dark" }
const kept = () => { try { return localStorage.getItem("trunnion-theme") ?? "" } catch { return "" } }
const dress = (theme) => {
  if (theme) document.documentElement.dataset.theme = theme
  else delete document.documentElement.dataset.theme
  const button = document.getElementById("theme")
  if (button) button.textContent = "Theme: " + named[theme]
}
dress(themes.includes(kept()) ? kept() : "")
document.addEventListener("DOMContentLoaded", () => {
  dress(document.documentElement.dataset.theme ?? "")
  document.getElementById("theme").addEventListener("click", () => {
    const now = document.documentElement.dataset.theme ?? ""
    const next = themes[(themes.indexOf(now) + 1) % themes.length]
    dress(next)
    try { localStorage.setItem("trunnion-theme", next) } catch {}
  })
}, { once: true })
// A slider's handle has no name of its own: it gets the words above it, which change with the parameter.
const attached = Element.prototype.attachShadow
Element.prototype.attachShadow = function (...given) {
  const root = attached.apply(this, given)
  const name = () => {
    const words = root.querySelector(".bk-slider-title")?.textContent.replace(/: [^:]*$/, "")
    for (const handle of words ? root.querySelectorAll(".noUi-handle") : [])
      if (handle.getAttribute("aria-label") !== words) handle.setAttribute("aria-label", words)
  }
  new MutationObserver(name).observe(root, { childList: true, subtree: true, characterData: true })
  return root
}
</script>
{% endblock %}
{% block postamble %}
<style>
THEMES
body { margin: 0; font-family: system-ui, "Segoe UI", "DejaVu Sans", sans-serif; color: var(--ink);
  background: var(--ground); font-size: var(--text); }
header { display: flex; align-items: center; gap: var(--near) var(--far); flex-wrap: wrap; background: var(--bar);
  color: var(--on-bar); padding: 6px var(--far); }
header h1 { font-size: var(--title); margin: 0; }
header > div { min-width: 0; max-width: 100%; }
#theme { font: inherit; font-size: var(--small); color: var(--on-bar); background: none; margin-left: auto;
  border: 1px solid var(--bar-edge); border-radius: 4px; padding: 4px 10px; min-height: 28px; cursor: pointer; }
#theme:focus-visible { outline: 3px solid var(--bar-focus); outline-offset: 1px; }
.layout { display: grid; grid-template-columns: minmax(0, 1fr) 330px; gap: 0 18px; padding: 4px var(--far) 24px; }
.side { border-left: 1px solid var(--line); padding-left: 14px; }
h2 { font-size: 16px; margin: 10px 0 2px; }
@media (max-width: 900px) {
  .layout { grid-template-columns: minmax(0, 1fr); padding: 4px var(--apart) 24px; }
  .side { border-left: 0; border-top: 1px solid var(--line); padding-left: 0; }
}
.skip { position: absolute; left: -999px; }
.skip:focus { left: 8px; top: 8px; background: var(--ground); color: var(--ink); padding: 6px; z-index: 20; }
@media (prefers-reduced-motion: reduce) { * { transition: none !important; animation-duration: 0.001s !important; } }
</style>
{% endblock %}
{% block contents %}
<a class="skip" href="#main">to the pictures</a>
<header><h1>Trunnion</h1>{{ embed(roots.navigation) }}<button id="theme" type="button">Theme</button></header>
<div class="layout">
<main id="main" tabindex="-1">{{ embed(roots.status) }}{{ embed(roots.main) }}</main>
<aside class="side" aria-label="sliders and variants">{{ embed(roots.aside) }}</aside>
</div>
{{ embed(roots.location) }}
{% endblock %}
""".replace("THEMES", css())

_STYLE = """
:host { --panel-border-color: var(--edge); --panel-shadow-color: transparent; }
:host(.drawn), img.picture { filter: var(--picture-filter, none); mix-blend-mode: var(--picture-blend, normal); }
select.bk-input { appearance: none; padding-right: 24px; background-repeat: no-repeat !important;
  background-image: linear-gradient(45deg, transparent 50%, var(--ink) 50%),
    linear-gradient(135deg, var(--ink) 50%, transparent 50%) !important;
  background-position: calc(100% - 14px) 55%, calc(100% - 9px) 55% !important; background-size: 5px 5px !important; }
.bk-input { border-color: var(--edge) !important; }
.bk-btn.bk-btn-primary { color: var(--on-accent) !important; }
select { text-overflow: ellipsis; }
.bk-input::placeholder { color: var(--faint); opacity: 1; }
.noUi-target { background: var(--button); border: 1px solid var(--edge); } .noUi-connect { background: var(--edge); }
.noUi-handle { background: var(--ground); border: 1px solid var(--edge); box-shadow: none; }
table.plain { border-collapse: collapse; font-size: 14px; }
table.plain th, table.plain td { text-align: left; padding: 3px 10px 3px 0; border-bottom: 1px solid var(--line);
  vertical-align: top; overflow-wrap: break-word; }
pre { white-space: pre-wrap; overflow-wrap: anywhere; font-size: 13px; }
.held { container-type: inline-size; }
@container (max-width: 560px) {
  table.checks tr { display: block; padding: 6px 0; border-bottom: 1px solid var(--line); }
  table.checks th, table.checks td:empty { display: none; }
  table.checks td { display: block; border: 0 !important; padding: 0 !important; }
  table.checks td:first-child { font-weight: 600; }
}
.stamp { position: absolute; right: 0; z-index: 9; max-width: 34em; padding: 3px 10px; font-size: 14px;
  color: var(--ink); background: var(--note); border: 1px solid var(--note-edge); animation: late 0.3s step-end; }
@keyframes late { from { visibility: hidden; } }
.refusal, .refusal * { color: var(--bad); overflow-wrap: anywhere; }
h2, p, li, td, th { overflow-wrap: anywhere; }
.verdict { font-size: 17px; font-weight: 600; border-left: 8px solid var(--undecided); padding: 4px 10px; }
.verdict { margin: 4px 0; overflow-wrap: anywhere; } .figure { font-size: 15px; font-weight: 600; margin: 4px 0; }
.sketch img { max-height: 150px; width: auto !important; max-width: 100% !important; display: block; margin: 0 auto; }
.verdict.satisfied { border-color: var(--satisfied); } .verdict.exceeded { border-color: var(--exceeded); }
a { color: var(--accent); }
.bk-spin-btn { display: none !important; }
:focus-visible { outline: 3px solid var(--focus); outline-offset: 1px; }
"""


class Page:
    """Panel objects of the page; the session says what stands in them."""

    def __init__(
        self, views: Mapping[str, str], first: str, choose: Callable[[str], None], cancel: Callable[[], None]
    ) -> None:
        """``views``: names of the views by their titles; ``first``: the one to begin with, chosen from the start, so
        that what is pressed while the page loads is never taken back."""
        pn.config.raw_css = [_STYLE]
        self.programmatic = ProgrammaticChange()
        self.navigation = pn.widgets.RadioButtonGroup(
            label="View",
            options=dict(views),
            value=first,
            button_type="default",
            margin=(4, 0),
            stylesheets=[_NAVIGATION],
        )
        self.navigation.param.watch(lambda event: choose(event.new) if not self.programmatic else None, "value")
        self.said = pane(margin=(4, 0), css_classes=["refusal"])
        self.bar = pn.indicators.Progress(
            name="progress", value=0, max=100, width=220, active=False, visible=False, margin=(8, 0)
        )
        self.state = HtmlPane("", margin=(4, 10))
        self.cancel_button = pn.widgets.Button(label="Cancel", width=80, disabled=True, margin=(2, 8))
        self.cancel_button.on_click(lambda event: cancel())
        self.mark = HtmlPane("", width=0, height=0, margin=0)
        progress = pn.Row(self.bar, self.cancel_button, self.state, self.mark, margin=0)
        self.status = column(self.said, progress)
        self.main, self.aside = column(), column()
        self._shown: tuple[Any, ...] = ()
        self._last_shown = 0.0
        self._done = 0
        self._marks = 0
        self.template = pn.Template(_TEMPLATE, location=True)
        for name in ("navigation", "status", "main", "aside"):
            self.template.add_panel(name, getattr(self, name))

    def fill(self, sliders: Any, strip: Any, difference: Any) -> None:
        """What stands beside the pictures."""
        self.aside.extend([heading("Move a number"), sliders, heading("Variants"), strip, difference])

    def show(self, view: View, names: Mapping[str, str], is_upon: bool) -> None:
        """Put a view on the page, with a picture for each variant, by its ``names``, or the pictures on the same axes
        where the view has any that can be."""
        is_upon = is_upon and len(names) > 1 and view.lay_upon(names)
        if not is_upon:
            view.lay_upon({})
        variants = ["now"] if is_upon else list(names)
        key = (view.name, is_upon, *names.items())
        if key == self._shown:
            return
        self._shown = key
        with self.programmatic:
            self.navigation.value = view.name
        one = len(variants) == 1
        pictures = []
        for variant in variants:
            side = view.of(variant)
            side.narrow(not one)
            above = [side.stamp] if one else [heading(names[variant]), side.stamp]
            pictures.append(column(*above, side.panel, min_width=300 if one else 240))  # two fit beside the sliders
        whole = pictures[0] if one else pn.Row(*pictures, sizing_mode="stretch_width", margin=0)
        about = [pane(markup("<p style='margin:0'>{}</p>", view.about))] if view.about else []
        said = [view.upon] if is_upon else []
        self.main.objects = [*about, view.controls, *said, whole, view.downloads]

    def message(self, text: str) -> None:
        """Say what went wrong, or nothing more."""
        body = joined(markup("<div>{}</div>", line) for line in text.splitlines() if line)
        self.said.object = markup("<div role='alert'>{}</div>", body) if body else ""

    def busy(self, share: float) -> None:
        """A computation is under way."""
        now = time.monotonic()
        if self.cancel_button.disabled:
            self.cancel_button.disabled = False
            self.bar.visible = True
        elif now - self._last_shown < MOST_OFTEN:
            return
        self._last_shown = now
        self.bar.value = int(100 * min(1.0, max(0.0, share)))
        self.state.object = markup("<span role='status' data-state='busy'>computing …</span>")

    def send_rest(self) -> None:
        """Change what nobody sees, so that changes which still wait to be sent go with it."""
        self._marks += 1
        self.mark.object = markup("<span hidden data-mark='{}'></span>", self._marks)

    def idle(self, text: str = "", remarks: Sequence[str] = ()) -> None:
        """Nothing is under way."""
        self.bar.value, self.bar.visible = 0, False
        self.cancel_button.disabled = True
        extra = joined(markup("<div>remark: {}</div>", r) for r in remarks)
        self._done += 1
        idle = "<span role='status' data-state='idle' data-done='{}'>{}</span>{}"
        self.state.object = markup(idle, self._done, text or "ready", extra)

    def failed(self, text: str) -> None:
        """A computation was refused or failed."""
        self.idle("not computed")
        self.message(text)


_NAVIGATION = """
:host { max-width: 100%; } .bk-btn-group { flex-wrap: wrap; }
.bk-btn { background: var(--bar) !important; color: var(--on-bar) !important; font-size: 15px;
  border: 1px solid var(--bar-edge) !important; }
.bk-btn.bk-active { background: var(--on-bar) !important; color: var(--bar) !important; font-weight: 600; }
.bk-btn:focus-visible { outline: 3px solid var(--bar-focus); outline-offset: 1px; z-index: 2; }
"""
