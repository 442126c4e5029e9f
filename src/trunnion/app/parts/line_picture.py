"""The sketch of a line that is its editor: a part is picked, dragged to another place or taken away, a new one is put
between two. What is dragged can be done by buttons too; the fields of the part that is picked stand beside it.

The sketch is an image, which runs no script; what lies upon it are buttons whose names are text.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import param
from panel.custom import JSComponent

from trunnion.app.parts.editor import kinds_to_add

USUAL = (
    "Shaft", "Disk", "HookeJoint", "Coupling", "Clutch", "PiecewiseShaft", "Ratio", "Engine", "Vehicle",
)  # fmt: skip
"""What lies on the palette; everything else is in the list beside it."""

_SCRIPT = """
function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag)
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value)
    else if (value !== null && value !== false) node.setAttribute(key, value === true ? "" : value)
  }
  node.append(...children)
  return node
}

export function render({ model }) {
  const say = (data) => model.send_msg(data)
  const stage = element("div", { class: "stage" }), scroll = element("div", { class: "scroll" }, stage)
  const kind = element("select", { "aria-label": "kind of the part to insert", onchange: () => choose(kind.value) })
  const chips = element("span", { class: "chips", role: "group", "aria-label": "parts" })
  const palette = element("div", { class: "palette" }, element("span", {}, "Insert"), chips, kind,
    element("span", { class: "hint" }, "drag one to a +, or press the +; drag a part to a + to move it"))
  let dragged = null, waits = false, chosen = model.kinds.includes("Disk") ? "Disk" : model.kinds[0]

  function choose(name) {
    chosen = name
    kind.value = name
    for (const chip of chips.children) chip.setAttribute("aria-pressed", String(chip.dataset.kind === name))
    for (const gap of stage.querySelectorAll(".gap"))
      gap.setAttribute("aria-label", `insert ${name} ${gap.dataset.where}`)
  }

  function begin(event, what) {
    dragged = what
    event.dataTransfer.effectAllowed = "copyMove"
    event.dataTransfer.setData("text/plain", what.kind ?? what.spot.name)
    stage.classList.add("dragging")
  }
  function end() {
    dragged = null
    stage.classList.remove("dragging")
    if (waits) build()
  }

  const to = (spot, front) => ({ path: spot.path, key: spot.key, front })
  function insert(spot, front, name) {
    say({ do: "insert", kind: name, by: front ? 0 : 1, path: spot.path, key: spot.key })
  }
  function drop(event, spot, front) {
    event.preventDefault()
    const what = dragged
    end()
    if (what?.kind) insert(spot, front, what.kind)
    else if (what && what.spot.key !== spot.key)
      say({ do: "put", path: what.spot.path, key: what.spot.key, target: spot.path, target_key: spot.key, front })
  }

  const percent = (x) => (100 * x).toFixed(3) + "%"
  function part(spot) {
    const press = () => say({ do: "pick", name: spot.name })
    return element("div", { class: "part", role: "button", tabindex: 0, draggable: "true", title: spot.name,
      "aria-label": `${spot.name}, ${spot.kind}`, "aria-pressed": String(spot.name === model.picked),
      "data-id": "part " + spot.key,
      style: ["left", "top", "width", "height"].map((side, i) => `${side}:${percent(spot.box[i])}`).join(";"),
      ondragstart: event => begin(event, { spot }), ondragend: end, onclick: press,
      onkeydown: event => {
        if (event.key === "Enter" || event.key === " ") { event.preventDefault(); press() }
        if (event.key === "Delete") { event.preventDefault(); say({ do: "remove", path: spot.path, key: spot.key }) }
        if (event.altKey && (event.key === "ArrowLeft" || event.key === "ArrowRight")) {
          event.preventDefault()
          say({ do: "move", by: event.key === "ArrowLeft" ? -1 : 1, path: spot.path, key: spot.key })
        }
      } })
  }

  function gap(spot, front, where) {
    const [x, y] = front ? spot.begins : spot.ends
    const last = !front // beside the part, which is narrower than its + would leave of it
    const made = element("button", { class: last ? "gap end" : "gap", type: "button", "data-where": where,
      "data-id": `gap ${spot.key} ${front}`, "aria-label": `insert ${chosen} ${where}`, title: where,
      style: `left:${last ? `min(${percent(x)}, calc(100% - 26px))` : percent(x)};top:${percent(y)}`,
      onclick: () => insert(spot, front, chosen),
      ondragover: event => { if (dragged) { event.preventDefault(); made.classList.add("over") } },
      ondragleave: () => made.classList.remove("over"),
      ondrop: event => { made.classList.remove("over"); drop(event, spot, front) } }, "+")
    return made
  }

  function build() {
    waits = dragged !== null // a sketch drawn anew would take what is dragged, and where it goes, out of the hand
    if (waits) return
    const root = stage.getRootNode(), focused = root.activeElement?.dataset?.id
    stage.replaceChildren()
    if (!model.svg) return
    const bytes = new TextEncoder().encode(model.svg)
    const text = btoa(Array.from(bytes, b => String.fromCharCode(b)).join(""))
    stage.append(element("img", { class: "picture", draggable: "false", src: "data:image/svg+xml;base64," + text,
      alt: "sketch of the driveline, elements numbered as in the table" }))
    stage.style.minWidth = `${Math.min(46 * model.spots.length, 4000)}px`
    const spots = model.spots, parents = new Set(spots.map(s => s.parent))
    for (const spot of spots) stage.append(part(spot))
    spots.forEach((spot, i) => {
      const before = spots[spot.parent]
      if (before || spot.kind !== "ConstantSpeed")
        stage.append(gap(spot, true, before ? `between ${before.name} and ${spot.name}` : `in front of ${spot.name}`))
      if (!parents.has(i)) stage.append(gap(spot, false, `behind ${spot.name}`))
    })
    if (focused) stage.querySelector(`[data-id="${CSS.escape(focused)}"]`)?.focus()
  }

  function pressed() {
    model.spots.forEach((spot, i) =>
      stage.querySelectorAll(".part")[i]?.setAttribute("aria-pressed", String(spot.name === model.picked)))
  }

  for (const name of model.usual)
    chips.append(element("button", { type: "button", class: "chip", draggable: "true", "data-kind": name,
      onclick: () => choose(name), ondragend: end,
      ondragstart: event => { choose(name); begin(event, { kind: name }) } }, name))
  for (const name of model.kinds) kind.append(element("option", { value: name }, name))
  model.on("spots", build)
  model.on("picked", pressed)
  build()
  choose(chosen)
  return element("div", { class: "editor" }, palette, scroll)
}
"""

_STYLE = """
:host { display: block; width: 100%; }
.palette { display: flex; flex-wrap: wrap; gap: 4px 8px; align-items: center; padding: 2px 0 6px; }
.chips { display: inline-flex; flex-wrap: wrap; gap: 4px; }
.hint { color: var(--faint); font-size: 13px; }
.chip, select { font: inherit; font-size: 14px; color: var(--ink); background: var(--button); cursor: pointer;
  border: 1px solid var(--edge); border-radius: 4px; padding: 2px 8px; min-height: 26px; }
.chip { cursor: grab; }
.chip[aria-pressed="true"] { background: var(--chosen); color: var(--on-chosen); }
.scroll { overflow-x: auto; }
.stage { position: relative; max-width: 1100px; }
img.picture { display: block; width: 100%; filter: var(--picture-filter, none);
  mix-blend-mode: var(--picture-blend, normal); }
.part { position: absolute; cursor: grab; border-radius: 4px; box-sizing: border-box; min-width: 18px; }
.part:hover { outline: 2px solid var(--edge); }
.part[aria-pressed="true"] { outline: 3px solid var(--accent); outline-offset: 1px; }
.gap { position: absolute; transform: translate(-50%, -50%); width: 24px; height: 24px; border-radius: 12px; padding: 0;
  font: 600 15px/20px system-ui, sans-serif; color: var(--ink); background: var(--button);
  border: 1px solid var(--edge); opacity: 0.55; cursor: pointer; z-index: 2; }
.gap:hover, .gap:focus-visible, .gap.over, .dragging .gap { opacity: 1; }
.gap.over { background: var(--chosen); color: var(--on-chosen); transform: translate(-50%, -50%) scale(1.4); }
.gap.end { transform: translate(2px, -50%); }
.part:focus-visible, .gap:focus-visible, .chip:focus-visible, select:focus-visible {
  outline: 3px solid var(--focus); outline-offset: 1px; z-index: 3; }
"""


class LinePicture(JSComponent):
    """A sketch with its parts; ``on_edit`` hears what is done to them, as from the fields of an editor, and "pick"."""

    svg = param.String(default="")
    spots = param.List(default=[])
    kinds = param.List(default=[])
    usual = param.List(default=list(USUAL))
    picked = param.String(default="")

    _esm = _SCRIPT
    _stylesheets = [_STYLE]

    def __init__(self, on_edit: Callable[[dict[str, Any]], None], **params: Any) -> None:
        super().__init__(kinds=kinds_to_add(), **params)
        self._on_edit = on_edit

    def show(self, svg: str, spots: Sequence[dict[str, Any]], keys: Sequence[int]) -> None:
        """A sketch; ``keys`` are those of the elements, by which a click finds them wherever they stand then."""
        pairs = enumerate(zip(spots, keys, strict=True))
        placed = [dict(spot, path=["element", i], key=key) for i, (spot, key) in pairs]
        self.param.update(svg=svg, spots=placed)

    def _handle_msg(self, data: Any) -> None:
        self._on_edit(data)
