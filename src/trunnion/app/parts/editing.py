"""What the user does with fields and parts, as a change of the document."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from trunnion.app.parts.document import Document


def change_of(data: Mapping[str, Any]) -> Callable[[Document], None]:
    """The change that a message of an editor asks for: what it is about goes by its key, wherever it stands now."""

    def change(document: Document) -> None:
        found = document.place(tuple(data.get("path", ())), data.get("key", 0))
        if found is None:
            return  # taken away since: by the click before, say
        match data:
            case {"do": "set", "text": str(text)} if found:
                document.set_text(found, text)
            case {"do": "insert", "kind": str(kind), "by": int(by)} if found:
                document.insert(int(found[1]), kind, by == 0)
            case {"do": "branch", "kind": str(kind)} if found:
                document.branch(int(found[1]), kind)
            case {"do": "put", "target": list(target), "target_key": int(key), "front": bool(front)} if found:
                if (there := document.place(tuple(target), key)) is not None:
                    document.put(int(found[1]), int(there[1]), front)
            case {"do": "add", "kind": str(kind), "place": int(place)}:
                document.add_element(place, kind)
            case {"do": "remove"} if found:
                document.remove(found)
            case {"do": "move", "by": int(by)} if found:
                document.move(int(found[1]), by)
            case {"do": "limit"}:
                document.add_limit(str(data.get("of", "Shaft *")))
            case {"do": "load_case"}:
                document.add_load_case()
            case {"do": "schedule"}:
                document.add_schedule()
            case {"do": "switch_off"}:
                document.switch_off()
            case {"do": "undo"}:
                document.undo()
            case {"do": "redo"}:
                document.redo()

    return change
