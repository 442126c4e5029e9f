"""A field that files are dropped on, or chosen in by keyboard; a large one is sent in chunks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import param
from panel.custom import JSComponent

from trunnion.app.parts.received import CHUNK, MOST_BYTES, ReceivedFile, plain_name
from trunnion.errors import InputError, TrunnionError
from trunnion.measured.signals.channel_file import LARGEST
from trunnion.measured.signals.sources import OPENED

_SCRIPT = """
export function render({ model }) {
  const zone = document.createElement("div"), label = document.createElement("label")
  const input = document.createElement("input"), note = document.createElement("span")
  const bar = document.createElement("progress"), stop = document.createElement("button")
  zone.className = "zone"
  input.type = "file"; input.id = "measured"; input.multiple = true; input.accept = model.endings
  label.htmlFor = "measured"; label.textContent = model.label
  note.setAttribute("role", "status"); bar.hidden = stop.hidden = true
  bar.setAttribute("aria-label", "share of the file that is sent")
  stop.type = "button"; stop.textContent = "Stop sending"
  let number = 0, sending = null
  const say = (words, alarm = false) => {
    note.textContent = words
    note.setAttribute("role", alarm ? "alert" : "status")
  }
  const rest = () => { sending = null; bar.hidden = stop.hidden = true }
  const next = async () => {
    const { file, place, own } = sending
    const chunk = await file.slice(place, place + model.chunk).arrayBuffer().catch(() => null)
    if (sending?.own !== own) return
    if (chunk === null) {
      rest(); model.send_msg({ what: "stop" }); say(`${file.name} cannot be read by the browser`, true)
      return
    }
    sending.place += chunk.byteLength
    bar.value = place / file.size
    model.send_msg({ what: "chunk", number: own, place, chunk })
  }
  const take = async (files) => {
    const own = ++number, all = [...files]
    rest()
    const texts = all.filter((one) => one.name.toLowerCase().endsWith(".toml"))
    const data = all.filter((one) => !one.name.toLowerCase().endsWith(".toml"))
    if (texts.length > 1 || data.length > 1) {
      say("give one measured file, and with it at most one .toml that describes it", true)
      return
    }
    for (const one of texts) {
      if (one.size > model.most_text) {
        say(`${one.name} has ${one.size} bytes, at most ${model.most_text} are taken`, true)
        return
      }
    }
    const text = texts.length ? { name: texts[0].name, text: await texts[0].text() } : null
    if (own !== number) return
    if (!data.length) {
      if (text) model.send_msg({ what: "description", ...text })
      return
    }
    const file = data[0]
    if (file.size > model.most) {
      say(`${file.name} has ${file.size} bytes, at most ${model.most} are taken`, true)
      return
    }
    sending = { file, own, place: 0 }
    bar.value = 0; bar.hidden = stop.hidden = false
    say(`sending ${file.name}`)
    model.send_msg({ what: "file", number: own, name: file.name, size: file.size, description: text })
  }
  model.on("msg:custom", (event) => {
    const said = event.data ?? event
    if (said.words !== undefined && (said.number === undefined || said.number === number)) {
      rest(); say(said.words, said.alarm)
    } else if (sending && said.number === sending.own) {
      next()
    }
  })
  stop.onclick = () => { rest(); number++; model.send_msg({ what: "stop" }); say("stopped; nothing of it is kept") }
  input.onchange = () => { take(input.files); input.value = "" }
  zone.ondragover = (event) => { event.preventDefault(); zone.classList.add("over") }
  zone.ondragleave = () => zone.classList.remove("over")
  zone.ondrop = (event) => {
    event.preventDefault(); zone.classList.remove("over"); take(event.dataTransfer.files)
  }
  zone.append(label, input, bar, stop, note)
  return zone
}
"""
_STYLE = """
.zone { border: 2px dashed var(--edge); border-radius: 6px; padding: 10px 12px; }
.zone.over { border-color: var(--focus); background: var(--note); }
label { display: block; font-size: 13px; margin-bottom: 4px; } span { display: block; overflow-wrap: anywhere; }
span[role=alert] { color: var(--bad); } input, button { font: inherit; } progress { width: 200px; margin: 0 8px; }
input:focus-visible, button:focus-visible { outline: 3px solid var(--focus); }
[hidden] { display: none; }
"""


class Drop(JSComponent):
    """Where measured files are dropped.

    on_file : gets a file once it is whole, with the name and text of a description that came with it, or None.
    on_description : gets name and text of a description that came alone.
    """

    label = param.String(default="Measured file, with its .channels.toml if there is one: drop here, or choose")
    endings = param.String(default=",".join((*OPENED, ".toml")))
    chunk = param.Integer(default=CHUNK)
    most = param.Integer(default=MOST_BYTES)
    most_text = param.Integer(default=LARGEST)

    _esm = _SCRIPT
    _stylesheets = [_STYLE]

    def __init__(
        self,
        on_file: Callable[[ReceivedFile, tuple[str, str] | None], None],
        on_description: Callable[[str, str], None],
        **params: Any,
    ) -> None:
        super().__init__(**params)
        self._on_file, self._on_description = on_file, on_description
        self._under_way: tuple[int, ReceivedFile, tuple[str, str] | None] | None = None

    def close(self) -> None:
        """Keep nothing of what is under way."""
        if self._under_way is not None:
            self._under_way[1].close()
            self._under_way = None

    def say(self, words: str, *, alarm: bool = False) -> None:
        """Words below the field."""
        self._send_msg({"words": words, "alarm": alarm})

    def _handle_msg(self, data: Any) -> None:
        number = data.get("number") if isinstance(data, dict) else None
        try:
            self._heard(data)
        except TrunnionError as error:
            self.close()
            self._send_msg({"words": str(error), "alarm": True, "number": number})
        except OSError as error:
            self.close()
            words = f"the file cannot be kept ({error.strerror}); make room on the disk of this machine"
            self._send_msg({"words": words, "alarm": True, "number": number})

    def _heard(self, data: Any) -> None:
        match data:
            case {"what": "file", "number": int(number), "name": name, "size": size, "description": stated}:
                self.close()
                self._under_way = number, ReceivedFile(name, size), None if stated is None else _text_of(stated)
                self._send_msg({"number": number})
            case {"what": "chunk", "number": number, "place": place, "chunk": chunk} if self._under_way is not None:
                own, file, stated = self._under_way
                if number != own:
                    return
                file.take(place, chunk)
                if not file.is_whole:
                    self._send_msg({"number": own})
                    return
                self._under_way = None
                self._send_msg({"words": f"{file.name}: {file.size} bytes are there", "number": own})
                self._on_file(file, stated)
            case {"what": "description", **more}:
                self._on_description(*_text_of(more))
            case {"what": "stop"}:
                self.close()


def _text_of(stated: Any) -> tuple[str, str]:
    """Name and text of a description.

    Raises
    ------
    InputError : it is none, or too long.
    """
    match stated:
        case {"name": name, "text": str(text), **_rest} if len(text) <= LARGEST:
            return plain_name(name), text
    raise InputError("is not a description of channels", key="measured file", remedy="give a small .toml")
