"""A driveline file with other content, its comments, order and formatting kept where nothing changed.

The text is cut into blocks, one for each header, with the comments directly above the header. A block moves, goes or
stays as one; within a block tomlkit changes the keys that differ. What was written is read again: a block that does
not say what it should is written plainly, and so is the whole file where no block can be told from another.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from typing import Any

import tomli_w
import tomlkit
from tomlkit.exceptions import TOMLKitError

from trunnion.driveline.inline_lists import relisted

_HEADER = re.compile(r"\s*\[")
Table = dict[str, Any]
Same = Mapping[tuple[str | int, ...], Sequence[int | None]]


@dataclass(frozen=True)
class Rewritten:
    """The text of a file, and in words what of its comments could not be kept; empty: all that concern what is left."""

    text: str
    lost: str = ""


@dataclass
class _Block:
    """A table of the file: the ``key`` it has in its parent, its texts, and the tables below it in the file's order.

    ``between`` is what stands apart above it and stays at its place, ``lead`` the comments right above its header.
    A table without a header of its own is only there for those below it.
    """

    key: str
    listed: bool = False
    between: str = ""
    lead: str = ""
    header: str = ""
    body: str = ""
    below: list[_Block] = field(default_factory=list)

    @property
    def text(self) -> str:
        return self.between + self.lead + self.header + self.body + "".join(one.text for one in self.below)


def rewritten(
    text: str, data: Table, same: Same | None = None, expand: Callable[[Table], Table] | None = None
) -> Rewritten:
    """The file ``text`` with the content ``data``.

    Parameters
    ----------
    text : a TOML file; empty for none.
    data : what the file shall hold.
    same : for lists of tables by their path, which table of ``text`` each of ``data`` was, None for a new one;
        without it tables are matched by what they hold.
    expand : what a table of ``text`` stands for, where it names a component.

    Returns
    -------
    Rewritten : with a text that reads as ``data``, but for tables that still stand for the same by ``expand``.
    """
    change = _Change(same or {}, expand or (lambda table: table))
    try:
        if _expanded(tomllib.loads(text), change.expand) == data:
            return Rewritten(text)
        text += "" if text.endswith("\n") or not text else "\n"
        root, end = _cut(text)
        if root.text + end != text:
            return _plain(data, "its tables stand in an order that cannot be followed")
        change.table([root], tomllib.loads(text), data, ())
        made = root.text + end
        if _expanded(tomllib.loads(made), change.expand) != data:
            return _plain(data, "what changed could not be mapped to its tables")
    except (tomllib.TOMLDecodeError, TOMLKitError, RecursionError) as error:
        return _plain(data, f"it could not be followed: {str(error).splitlines()[0][:120]}")
    lost = ", ".join(dict.fromkeys(change.lost))
    return Rewritten(made, f"comments between the keys of {lost} could not be kept" if lost else "")


def _plain(data: Table, why: str) -> Rewritten:
    lost = f"comments and layout of the file before could not be kept, {why}"
    root = _Block("")
    root.body = _keys({key: value for key, value in data.items() if not _is_block(value)})
    root.below = [one for key, value in data.items() if _is_block(value) for one in _new(key, value, ())]
    return Rewritten(f"# {lost}\n{root.text.lstrip()}", lost)


def _expanded(data: Table, expand: Callable[[Table], Table]) -> Table:
    return data | {"element": [expand(one) for one in data["element"]]} if "element" in data else data


# -- cutting -------------------------------------------------------------------------------------------------------


def _cut(text: str) -> tuple[_Block, str]:
    """The file as blocks below a root, and the comments that end it."""
    root = _Block("")
    pieces = list(_pieces(text))
    between_above = lead_above = ""
    open_blocks: list[tuple[tuple[str, ...], _Block]] = [((), root)]
    for place, piece in enumerate(pieces):
        kept, between, lead = _ends(piece, last=place == len(pieces) - 1)
        if place == 0:
            root.body = kept
        else:
            path, listed = _path(piece)
            while open_blocks[-1][0] != path[: len(open_blocks[-1][0])] or len(open_blocks[-1][0]) >= len(path):
                open_blocks.pop()
            outer, parent = open_blocks[-1]
            for depth in range(len(outer), len(path)):
                block = _Block(path[depth], listed=listed and depth == len(path) - 1)
                parent.below.append(block)
                open_blocks.append((path[: depth + 1], block))
                parent = block
            parent.between, parent.lead = between_above, lead_above
            newline = kept.find("\n") + 1 or len(kept)
            parent.header, parent.body = kept[:newline], kept[newline:]
        between_above, lead_above = between, lead
    return root, between_above + lead_above


def _pieces(text: str) -> Iterator[str]:
    """What stands before the first header, then each header with what follows it."""
    piece: list[str] = []
    for line in text.split("\n"):
        if _HEADER.match(line) and _is_whole("\n".join(piece)):
            yield "".join(one + "\n" for one in piece)
            piece = []
        piece.append(line)
    yield "\n".join(piece)


def _is_whole(piece: str) -> bool:
    """Whether no value is still open, so that a bracket begins a header."""
    try:
        tomllib.loads(piece)
    except tomllib.TOMLDecodeError:
        return False
    return True


def _ends(piece: str, last: bool) -> tuple[str, str, str]:
    """A piece without the comments at its end, those apart from what follows, and those right above it."""
    lines = piece.splitlines(keepends=True)
    at = len(lines)
    while at and (not lines[at - 1].strip() or lines[at - 1].lstrip().startswith("#")):
        at -= 1
    tail = lines[at:]
    lead = len(tail)
    while lead and tail[lead - 1].strip():
        lead -= 1
    if last:
        lead = len(tail)
    attached = 0
    while at and attached < lead and tail[attached].strip():
        attached += 1  # a comment right below a key belongs to it
    return "".join(lines[:at] + tail[:attached]), "".join(tail[attached:lead]), "".join(tail[lead:])


def _path(piece: str) -> tuple[tuple[str, ...], bool]:
    """The path that a header names, and whether it is one of a list."""
    header = piece.split("\n", 1)[0].strip()
    value: Any = tomllib.loads(header)
    path: list[str] = []
    while value:
        key, value = next(iter(value.items()))
        path.append(key)
        if isinstance(value, list):
            return tuple(path), True
    return tuple(path), False


# -- changing ------------------------------------------------------------------------------------------------------


@dataclass
class _Change:
    same: Same
    expand: Callable[[Table], Table]
    lost: list[str] = field(default_factory=list)

    def table(self, blocks: list[_Block], old: Table, new: Table, path: tuple[str, ...]) -> None:
        """Make the blocks of one table, which may be dispersed, hold ``new``."""
        names = list(dict.fromkeys(one.key for block in blocks for one in block.below))
        own = {key: value for key, value in old.items() if key not in names}
        wanted: Table = {}
        for key, value in new.items():
            there = [one for block in blocks for one in block.below if one.key == key]
            if there and there[0].listed and _is_tables(value):
                self.tables(blocks, key, old[key], value, (*path, key))
            elif there and not there[0].listed and isinstance(value, dict):
                self.table(there, old[key], value, (*path, key))
            elif there:
                _drop(blocks, key)
                wanted[key] = value
            elif key not in old and _is_block(value) and (blocks[0].header or not path):
                blocks[-1].below += _new(key, value, path)
            else:
                wanted[key] = value
        for key in names:
            if key not in new:
                _drop(blocks, key)
        if own != wanted:
            holder = next((one for one in blocks if one.header or not path), blocks[0])
            if path and not holder.header:
                holder.header, holder.between = f"[{_dotted(path)}]\n", holder.between or "\n"
            self._keys(holder, own, wanted, path)

    def _keys(self, block: _Block, old: Table, new: Table, path: tuple[str, ...]) -> None:
        """The keys of one block."""
        try:
            old, new = self._inline_lists(block, old, new, path)
            document = tomlkit.parse(block.body)
            _merge(document, old, new)
            body = tomlkit.dumps(document)
            if body and not body.endswith("\n"):
                body += "\n"
            if tomllib.loads(body) == new:
                block.body = body
                return
        except (TOMLKitError, tomllib.TOMLDecodeError, KeyError, TypeError, ValueError, IndexError):
            pass
        if "#" in block.body:
            self.lost.append(f"[{_dotted(path)}]" if path else "the beginning")
        block.body = _keys(new)

    def _inline_lists(self, block: _Block, old: Table, new: Table, path: tuple[str, ...]) -> tuple[Table, Table]:
        """Write lists of inline tables with other tables into ``block``; what it holds then, and what it shall hold,
        ``old`` and ``new`` having been."""
        held, wanted = dict(old), dict(new)
        for key, value in new.items():
            before: Any = old.get(key)
            if not (_is_tables(value) and _is_tables(before)):
                continue
            places = self._places((*path, key), before, value)
            wanted[key] = [
                table if place is None else self._kept((*path, key), before[place], table)
                for place, table in zip(places, value, strict=True)
            ]
            if places == list(range(len(before))):
                continue
            source = tomlkit.parse(block.body)[key].as_string()
            made = relisted(source, places, wanted[key], changed=_item_changed, written=_item_written)
            if made is not None and block.body.count(source) == 1:
                block.body, held[key] = block.body.replace(source, made), wanted[key]
            elif "#" in source:
                self.lost.append(_dotted((*path, key)))
        return held, wanted

    def _kept(self, path: tuple[str, ...], old: Table, new: Table) -> Table:
        """``old`` where it stands for ``new``: an element that names its component."""
        return old if path == ("element",) and self.expand(old) == new else new

    def _places(self, path: tuple[str, ...], old: list[Table], new: list[Table]) -> list[int | None]:
        """Which of the old tables of a list each of the new ones was."""
        given = self.same.get(path)
        if given is None or len(given) != len(new):
            return _matched(old, new)
        return [None if place is None or place >= len(old) else place for place in given]

    def tables(self, blocks: list[_Block], key: str, old: list[Table], new: list[Table], path: tuple[str, ...]) -> None:
        """A list of tables: those that were there move with their comments, the others are new."""
        listed = [one for block in blocks for one in block.below if one.key == key]
        made: list[_Block] = []
        for place, table in zip(self._places(path, old, new), new, strict=True):
            if place is None:
                made += _new(key, [table], path[:-1])
                continue
            block = listed[place]
            self.table([block], old[place], self._kept(path, old[place], table), path)
            made.append(block)
        _settle(blocks, listed, made)


def _settle(blocks: list[_Block], before: list[_Block], after: list[_Block]) -> None:
    """Put the blocks of a list in their new order; what stands apart above them stays at its place."""
    stay = [one for one in before if any(one is other for other in after)]
    kept = [one for one in after if any(one is other for other in before)]
    gaps, left = [], ""
    for one in before:
        if any(one is other for other in after):
            gaps.append(_joined(left, one.between))
            left = ""
        elif one.between.strip():
            left = _joined(left, one.between)
    for one, gap in zip(kept, gaps, strict=True):
        one.between = gap
    if kept and after[0] is not kept[0]:
        after[0].between, kept[0].between = kept[0].between, "\n"
    # Kept ones take the places of kept ones; a new one stands right after the one before it.
    places = iter(stay)
    at: dict[int, list[_Block]] = {}
    ahead: list[_Block] = []
    slot: _Block | None = None
    for one in after:
        if any(one is other for other in kept):
            slot = next(places)
            at[id(slot)] = [*ahead, one]
            ahead = []
        elif slot is None:
            ahead.append(one)
        else:
            at[id(slot)].append(one)
    if not stay:
        at[id(before[0])] = after
    for block in blocks:
        below: list[_Block] = []
        for one in block.below:
            mine = any(one is other for other in before)
            below += at.get(id(one), []) if mine else [one]
        block.below = below
    if left and after:
        after[-1].below.append(_Block("", between=left))


def _joined(first: str, second: str) -> str:
    return first + second if first.strip() and second.strip() else first if first.strip() else second


def _drop(blocks: list[_Block], key: str) -> None:
    for block in blocks:
        block.below = [one for one in block.below if one.key != key]


def _matched(old: list[Table], new: list[Table]) -> list[int | None]:
    """Which of the old tables each of the new ones was: the equal ones, and between them those in the same order."""
    found: list[int | None] = [None] * len(new)
    if len(old) == len(new):
        return list(range(len(new)))
    same = SequenceMatcher(None, [repr(one) for one in old], [repr(one) for one in new], autojunk=False)
    for _, a, a_end, b, b_end in same.get_opcodes():
        for i, j in zip(range(a, a_end), range(b, b_end), strict=False):
            found[j] = i
    return found


def _merge(owner: Any, old: Table, new: Table) -> None:
    """Change a table of tomlkit from ``old`` to ``new``, key by key."""
    for key in old:
        if key not in new:
            del owner[key]
    for key, value in new.items():
        if key not in old:
            owner[key] = _inline(value)
        elif not _alike(old[key], value):
            if isinstance(value, dict) and isinstance(old[key], dict):
                _merge(owner[key], old[key], value)
            elif isinstance(value, list) and isinstance(old[key], list) and len(value) == len(old[key]):
                _merge_list(owner[key], old[key], value)
            else:
                owner[key] = _inline(value)


def _merge_list(owner: Any, old: list[Any], new: list[Any]) -> None:
    for place, (before, value) in enumerate(zip(old, new, strict=True)):
        if _alike(before, value):
            continue
        if isinstance(before, dict) and isinstance(value, dict):
            _merge(owner[place], before, value)
        else:
            owner[place] = _inline(value)


def _item_changed(item: str, table: Table) -> str:
    """The text of an inline table that shall hold ``table``."""
    before = tomllib.loads(f"x = {item}")["x"]
    if before == table:
        return item
    document = tomlkit.parse(f"x = {item}")
    _merge(document["x"], before, table)
    return document["x"].as_string()  # type: ignore[no-any-return]


def _item_written(table: Table) -> str:
    """The text of a new inline table."""
    return f"{{ {_inline(table).as_string()[1:-1]} }}"


def _alike(one: Any, other: Any) -> bool:
    return type(one) is type(other) and bool(one == other)


# -- new blocks ----------------------------------------------------------------------------------------------------


def _is_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(one, dict) for one in value)


def _is_block(value: Any) -> bool:
    return isinstance(value, dict) or _is_tables(value)


def _new(key: str, value: Any, outer: tuple[str, ...]) -> list[_Block]:
    """A table or a list of tables, each with a header."""
    tables, listed, path = (value, True, (*outer, key)) if isinstance(value, list) else ([value], False, (*outer, key))
    made = []
    for table in tables:
        header = f"[[{_dotted(path)}]]\n" if listed else f"[{_dotted(path)}]\n"
        block = _Block(key, listed, "\n", "", header, _keys({k: v for k, v in table.items() if not _is_block(v)}))
        block.below = [one for k, v in table.items() if _is_block(v) for one in _new(k, v, path)]
        made.append(block)
    return made


def _keys(table: Table) -> str:
    """Keys without a header, tables among them inline."""
    whole = tomlkit.document()
    for key, value in table.items():
        whole[key] = _inline(value)
    return tomlkit.dumps(whole) if any(_is_block(v) for v in table.values()) else tomli_w.dumps(table)


def _inline(value: Any) -> Any:
    if isinstance(value, dict):
        made = tomlkit.inline_table()
        made.update({key: _inline(one) for key, one in value.items()})
        return made
    if isinstance(value, list):
        listed = tomlkit.array()
        listed.extend(_inline(one) for one in value)
        return listed
    return value


def _dotted(path: tuple[str, ...]) -> str:
    return ".".join(key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else tomlkit.string(key).as_string() for key in path)
