"""A file from the browser: read there, measured before it is sent, checked again here."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import param
from panel.custom import JSComponent

_SCRIPT = """
export function render({ model }) {
  const box = document.createElement("div"), label = document.createElement("label")
  const input = document.createElement("input"), note = document.createElement("span")
  input.type = "file"; input.id = "upload"; input.accept = ".toml,text/plain"
  label.htmlFor = "upload"; label.textContent = model.label
  note.setAttribute("role", "alert")
  input.onchange = async () => {
    const file = input.files[0]
    note.textContent = ""
    if (!file) return
    if (file.size > model.most) {
      note.textContent = `${file.name} has ${file.size} bytes, at most ${model.most} are taken; give a driveline file`
    } else {
      model.send_msg(await file.text())
    }
    input.value = ""
  }
  box.append(label, input, note)
  return box
}
"""
_STYLE = """
label { display: block; font-size: 13px; } span { color: var(--bad); display: block; max-width: 30em; }
input { font: inherit; } input:focus-visible { outline: 3px solid var(--focus); }
"""


class Upload(JSComponent):
    """A field for a file; ``on_text`` gets its text."""

    label = param.String(default="Open a file")
    most = param.Integer(default=1_000_000)

    _esm = _SCRIPT
    _stylesheets = [_STYLE]

    def __init__(self, on_text: Callable[[str], None], most: int, **params: Any) -> None:
        super().__init__(most=most, **params)
        self._on_text = on_text

    def _handle_msg(self, data: Any) -> None:
        if isinstance(data, str):
            self._on_text(data)
