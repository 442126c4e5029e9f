"""A button that sets a picture of a shape moving, in the browser alone.

Panel's own callbacks in JavaScript are compiled from text there, which the content policy forbids.
"""

from __future__ import annotations

import param
from panel.custom import JSComponent

_SCRIPT = """
export function render({ model }) {
  const button = document.createElement("button")
  button.type = "button"; button.textContent = model.label
  let moving = false
  const still = {}
  const set = (share) => {
    for (const [kind, key] of [["lines", "xs"], ["marks", "x"]]) {
      const source = Bokeh.documents.map(d => d.get_model_by_name(`${model.picture}-${kind}`)).find(found => found)
      if (!source) continue
      if (still[kind]?.data !== source.data) still[kind] = {data: source.data, values: Array.from(source.data[key])}
      const swung = (value) => value.length === undefined ? value * share : Array.from(value, v => v * share)
      source.data[key] = share === 1 ? still[kind].values : still[kind].values.map(swung)
      source.change.emit()
    }
  }
  const move = () => {
    if (!moving || !button.isConnected) { set(1); return }
    set(Math.cos(performance.now() / 300)); requestAnimationFrame(move)
  }
  button.onclick = () => {
    moving = !moving
    button.setAttribute("aria-pressed", moving)
    move()
  }
  button.setAttribute("aria-pressed", false)
  return button
}
"""
_STYLE = """
button { font: inherit; font-size: 14px; padding: 5px 12px; margin: 5px; border: 1px solid var(--edge); cursor: pointer;
  border-radius: 4px; background: var(--button); color: var(--ink); }
button[aria-pressed="true"] { background: var(--chosen); color: var(--on-chosen); }
button:focus-visible { outline: 3px solid var(--focus); outline-offset: 1px; }
"""


class Mover(JSComponent):
    """Lines and marks of the picture of that name swing across while the button is pressed, from x to −x and back."""

    picture = param.String()
    label = param.String(default="Move the mode")

    _esm = _SCRIPT
    _stylesheets = [_STYLE]
