"""The table of elements in the browser: native fields with labels, so that keys and screen readers work."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import param
from panel.custom import JSComponent

from trunnion.app.parts.form import Field, FieldGroup
from trunnion.driveline.component_files import components
from trunnion.driveline.kinds import KINDS
from trunnion.errors import InputError

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

const broken = (name) => name.split(/(?<=[a-z])(?=[A-Z])/).flatMap(part => [part, element("wbr")])
const idOf = (f) => "field-" + f.path.join("-").replace(/\\s/g, "_")

export function render({ model }) {
  const table = element("div", { class: "groups" })
  const inputs = new Map(), notes = new Map()
  let shape = ""
  const say = (data) => model.send_msg(data)

  function field(group, f) {
    const id = idOf(f)
    const note = element("span", { class: "note", id: id + "-note", role: "alert" })
    const about = f.label + (group.title ? " of " + group.title : "")
    let input
    const set = () => say({ do: "set", path: f.path, key: group.key, text: input.value })
    if (f.choices.length) {
      input = element("select", { id, "aria-label": about, onchange: set })
      for (const c of f.choices) input.append(element("option", { value: c }, c || "not stated"))
    } else {
      const size = Math.min(48, Math.max(9, f.text.length + 1, f.hint.length))
      input = element("input", { id, type: "text", size, placeholder: f.hint, "aria-label": about,
        "aria-describedby": id + "-note", spellcheck: "false", autocomplete: "off", onchange: set })
    }
    inputs.set(id, input)
    notes.set(id, note)
    return element("div", { class: "field" }, element("label", { for: id }, f.label), input, note)
  }

  function adder(group) {
    if (!group.addable.length) return ""
    const pick = element("select", { class: "add", "aria-label": "add a field to " + (group.title || "the line"),
      onchange: () => { if (pick.value) { open(group, pick.value); pick.value = "" } } })
    pick.append(element("option", { value: "" }, "+ field"))
    for (const key of group.addable) pick.append(element("option", { value: key }, key.replaceAll("_", " ")))
    return pick
  }

  function open(group, key) {
    const f = { path: [...group.path, key], label: key.replaceAll("_", " "), text: "", hint: "", message: "",
      choices: [] }
    const row = table.querySelector(`[data-group="${group.path.join("-")}"] .fields`)
    row.append(field(group, f))
    inputs.get(idOf(f)).focus()
  }

  function tools(group) {
    const listed = ["load case", "schedule", "switched off"].includes(group.kind)
    if (!listed && !["element", "limit"].includes(group.path[0])) return ""
    const button = (text, about, data, off = false) => element("button",
      { type: "button", title: about, "aria-label": about, disabled: off, onclick: (event) => {
        // the second click of a double one meets what has moved there since
        if (data.do !== "remove" || event.detail < 2) say({ ...data, path: group.path, key: group.key })
      } }, text)
    const name = group.title
    const row = element("span", { class: "tools" })
    if (group.path[0] === "element") {
      row.append(button("\\u2191", "move " + name + " toward the drive", { do: "move", by: -1 }))
      row.append(button("\\u2193", "move " + name + " toward the load", { do: "move", by: 1 }))
    }
    row.append(button("\\u00d7", "remove " + name, { do: "remove" }))
    return row
  }

  // An element is dragged by its head to before or behind another one; the arrows beside it do the same.
  let dragged = null
  function take(event, group) {
    dragged = group
    event.dataTransfer.effectAllowed = "move"
    event.dataTransfer.setData("text/plain", group.title)
  }
  function drop() {
    dragged = null
    for (const row of table.querySelectorAll(".before, .behind")) row.classList.remove("before", "behind")
  }
  const isBefore = (event, row) => {
    const box = row.getBoundingClientRect()
    return event.clientY < box.top + box.height / 2
  }
  function over(event, row, group) {
    if (!dragged || dragged.key === group.key) return
    event.preventDefault()
    const before = isBefore(event, row)
    row.classList.toggle("before", before)
    row.classList.toggle("behind", !before)
  }
  function put(event, row, group) {
    if (!dragged) return
    event.preventDefault()
    const from = dragged.path[1], place = group.path[1] + (isBefore(event, row) ? 0 : 1)
    const by = place - from - (place > from ? 1 : 0)
    if (by) say({ do: "put", path: dragged.path, key: dragged.key, target: group.path, target_key: group.key,
      front: isBefore(event, row) })
    drop()
  }

  function build() {
    inputs.clear(); notes.clear(); table.replaceChildren()
    for (const group of model.groups) {
      const number = group.path[0] === "element" ? group.path[1] + 1 + "" : ""
      const listed = group.path[0] === "element" && !model.alone
      const head = element("div", { class: "head", draggable: listed ? "true" : null,
        ondragstart: event => { if (listed) take(event, group) }, ondragend: drop },
        element("span", { class: "number" }, number),
        element("span", { class: "kind" }, ...broken(group.kind || group.title)), tools(group))
      const fields = element("div", { class: "fields" })
      for (const f of group.fields) fields.append(field(group, f))
      const body = element("div", { class: "body" }, fields, adder(group),
        element("div", { class: "note group-note", role: "alert" }))
      const row = element("div", { class: "group", role: "group", "aria-label": group.title,
        "data-group": group.path.join("-"), ondragover: event => { if (listed) over(event, row, group) },
        ondragleave: () => row.classList.remove("before", "behind"),
        ondrop: event => { if (listed) put(event, row, group) } }, head, body)
      table.append(row)
    }
    const kind = element("select", { "aria-label": "kind of the new element", id: "new-kind" })
    for (const k of model.kinds) kind.append(element("option", { value: k }, k))
    if (model.alone) {
      const [group] = model.groups
      if (!group) return
      const act = (text, data, made = false) => element("button", { type: "button",
        onclick: () => say({ ...data, path: group.path, key: group.key, ...(made && { kind: kind.value }) }) }, text)
      const insert = (text, by) => element("button", { type: "button",
        onclick: () => say({ do: "insert", by, kind: kind.value, path: group.path, key: group.key }) }, text)
      table.className = "groups alone"
      table.append(element("div", { class: "group new" }, element("label", { for: "new-kind" }, "insert"), kind,
        insert("In front", 0), insert("Behind", 1),
        act("On a branch", { do: "branch" }, true)),
        element("div", { class: "group new" }, act("Add limit", { do: "limit", of: group.title }),
        act("Undo", { do: "undo" }), act("Redo", { do: "redo" })))
      return
    }
    const place = element("input", { type: "number", min: 1, id: "new-place", "aria-label": "place of the new element",
      value: model.groups.filter(g => g.path[0] === "element").length + 1 })
    table.append(element("div", { class: "group new" }, element("label", { for: "new-kind" }, "add"), kind,
      element("label", { for: "new-place" }, "as number"), place,
      element("button", { type: "button", onclick: () =>
        say({ do: "add", kind: kind.value, place: +place.value - 1 }) }, "Add element"),
      element("button", { type: "button", onclick: () => say({ do: "limit" }) }, "Add limit"),
      element("button", { type: "button", onclick: () => say({ do: "load_case" }) }, "Add load case"),
      element("button", { type: "button", onclick: () => say({ do: "schedule" }) }, "Add schedule"),
      element("button", { type: "button", onclick: () => say({ do: "switch_off" }) }, "Switch a rule off")))
  }

  function fill() {
    const now = JSON.stringify(model.groups.map(g => [g.path, g.key, g.title, g.kind, g.addable,
      g.fields.map(f => [f.path, f.label])]))
    if (now !== shape) { keepFocus(build); shape = now }
    for (const group of model.groups) {
      const row = table.querySelector(`[data-group="${group.path.join("-")}"] .group-note`)
      if (row) row.textContent = group.message
      for (const f of group.fields) {
        const id = idOf(f)
        const input = inputs.get(id)
        if (input.value !== f.text && !(input.matches(":focus") && input.dataset.sent === "no")) input.value = f.text
        notes.get(id).textContent = f.message
        input.setAttribute("aria-invalid", f.message ? "true" : "false")
      }
    }
  }

  function keepFocus(change) {
    const root = table.getRootNode()
    const id = root.activeElement ? root.activeElement.id : ""
    change()
    if (id && inputs.get(id)) inputs.get(id).focus()
  }

  model.on("groups", fill)
  fill()
  return table
}
"""

_STYLE = """
:host { width: 100%; }
.group { display: flex; border-top: 1px solid var(--line); padding: 4px 0; gap: 8px; }
.head { flex: 0 0 210px; display: flex; align-items: center; gap: 6px; font-weight: 600; align-self: flex-start; }
.head[draggable] { cursor: grab; }
.group.before { box-shadow: 0 -3px 0 var(--focus); } .group.behind { box-shadow: 0 3px 0 var(--focus); }
.number { color: var(--faint); min-width: 1.5em; text-align: right; font-weight: 400; }
.kind { flex: 1; overflow-wrap: anywhere; }
.body { flex: 1; min-width: 0; }
.fields { display: flex; flex-wrap: wrap; gap: 4px 12px; }
.field { display: flex; flex-direction: column; }
label { font-size: 12px; color: var(--faint); }
input, select, button { font: inherit; padding: 2px 4px; border: 1px solid var(--edge); border-radius: 3px;
  background: var(--field); color: var(--ink); }
input:focus-visible, select:focus-visible, button:focus-visible { outline: 3px solid var(--focus);
  outline-offset: 1px; }
input[aria-invalid="true"] { border: 2px solid var(--bad); background: var(--bad-ground); }
input::placeholder { color: var(--faint); opacity: 1; }
input[type="number"] { width: 5em; }
button { cursor: pointer; background: var(--button); min-width: 24px; min-height: 24px; }
.tools { white-space: nowrap; }
.note { color: var(--bad); font-size: 13px; max-width: 34em; white-space: pre-line; }
.alone .group { flex-direction: column; } .alone .new { flex-direction: row; } .alone .head { flex-basis: auto; }
.add { font-size: 12px; margin-top: 3px; color: var(--faint); }
.new { align-items: center; flex-wrap: wrap; }
@media (max-width: 700px) { .group { flex-direction: column; } .head { flex-basis: auto; }
  .new { flex-direction: row; } }
"""


class Editor(JSComponent):
    """Table of elements; ``on_edit`` hears what the user does, as a dictionary with the key "do"."""

    groups = param.List(default=[])
    kinds = param.List(default=[])
    alone = param.Boolean(default=False, doc="one part by itself, with what may be inserted beside it")

    _esm = _SCRIPT
    _stylesheets = [_STYLE]

    def __init__(self, on_edit: Callable[[dict[str, Any]], None], **params: Any) -> None:
        super().__init__(kinds=kinds_to_add(), **params)
        self._on_edit = on_edit

    def show(self, groups: tuple[FieldGroup, ...]) -> None:
        """Fields as they stand now."""
        self.groups = [asdict(g) | {"path": list(g.path), "fields": [_field(f) for f in g.fields]} for g in groups]

    def _handle_msg(self, data: Any) -> None:
        self._on_edit(data)


def kinds_to_add() -> list[str]:
    """Of elements that can be added: kinds, then components as "maker/type"."""
    return [*KINDS, *_components()]


def _components() -> list[str]:
    """Names of the components that can be added; none where a user's file of them is damaged."""
    try:
        return list(dict.fromkeys(one.sheet.component for one in components()))
    except InputError:
        return []


def _field(field: Field) -> dict[str, Any]:
    return asdict(field) | {"path": list(field.path), "choices": list(field.choices)}
