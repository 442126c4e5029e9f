"""Elements put in, taken out and moved along a line with branches, as the tables of its file.

A table hangs on the one before it, or on the one that it names under ``after``. While elements come and go each keeps
what it hangs on: what stood between two is taken out of their chain and no other chain is joined by it. A branch goes
with the element that it leaves from.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count
from typing import Any

from trunnion.app.parts.form import names_of
from trunnion.errors import InputError

Table = dict[str, Any]


@dataclass(eq=False)
class _Node:
    """A table, its key, what it hangs on, by which shaft of that one, and what it was called.

    wrong : what it names under ``after`` is no earlier element; it keeps that, and is told so by its field.
    """

    table: Table
    key: int
    parent: _Node | None
    port: str
    name: str
    wrong: bool = False


class ChainEdit:
    """The tables of a line while they are changed."""

    def __init__(self, tables: list[Table], keys: list[int]) -> None:
        self.nodes: list[_Node] = []
        for table, key, name in zip(tables, keys, names_of(tables), strict=True):
            parent, port, wrong = self._hangs_on(table)
            self.nodes.append(_Node(table, key, parent, port, name, wrong))

    def _hangs_on(self, table: Table) -> tuple[_Node | None, str, bool]:
        before, after = self.nodes[-1] if self.nodes else None, table.get("after")
        if after is None:
            return before, "", False
        known = {one.name: one for one in self.nodes}
        if after in known:
            return known[after], "", False
        owner, _, port = str(after).rpartition(".")
        return (known[owner], port, False) if owner in known else (before, "", True)

    # -- changes --------------------------------------------------------------------------------------------------

    def begin(self, table: Table, key: int) -> None:
        """The first element of an empty line."""
        self.nodes.append(_Node(table, key, None, "", ""))

    def put_in_front(self, place: int, table: Table, key: int) -> None:
        """A new element between that at ``place`` and what it hangs on."""
        self._put_in_front(self.nodes[place], _Node(table, key, None, "", ""))

    def put_behind(self, place: int, table: Table, key: int) -> None:
        """A new element behind that at ``place``; what followed it follows the new one."""
        self._put_behind(self.nodes[place], _Node(table, key, None, "", ""))

    def branch(self, place: int, table: Table, key: int) -> None:
        """A new element on a branch of its own, from that at ``place``."""
        self.nodes.append(_Node(table, key, self.nodes[place], "", ""))

    def remove(self, place: int) -> None:
        """Take an element out; what hung on it hangs on what it hung on."""
        gone = self.nodes.pop(place)
        for one in self._on(gone):
            one.parent, one.port = gone.parent, gone.port
        root = next((one for one in self.nodes if one.parent is None), None)
        for one in self.nodes:
            if one.parent is None and one is not root:
                one.parent = root

    def move(self, place: int, target: int, front: bool) -> None:
        """Put an element in front of, or behind, another one; branches that leave from it come along.

        Raises
        ------
        InputError : the other one stands on such a branch.
        """
        moved, at = self.nodes[place], self.nodes[target]
        if moved is at:
            return
        through = self._follower(moved)
        above: _Node | None = at
        while above is not None and above is not moved:
            if above.parent is moved and above is not through:
                raise InputError(
                    f"stands on a branch that leaves from {moved.name}",
                    element=at.name,
                    remedy=f"move {at.name}, or hang it elsewhere with after",
                )
            above = above.parent
        if through is not None:
            through.parent, through.port = moved.parent, moved.port
        self.nodes.remove(moved)
        (self._put_in_front if front else self._put_behind)(at, moved)

    def step(self, place: int, by: int) -> None:
        """Move an element so many others toward the drive (−) or the load (+) along its own chain."""
        moved = at = self.nodes[place]
        for _ in range(abs(by)):
            further = at.parent if by < 0 else self._follower(at)
            if further is None:
                break
            at = further
        if at is not moved:
            self.move(place, self.nodes.index(at), by < 0)

    # -- the same of nodes ----------------------------------------------------------------------------------------

    def _on(self, node: _Node) -> list[_Node]:
        return [one for one in self.nodes if one.parent is node]

    def _follower(self, node: _Node) -> _Node | None:
        """What goes on behind it in the file without naming it, if anything; a lone branch counts as that."""
        mine = self._on(node)
        plain = [one for one in mine if "after" not in one.table]
        return plain[0] if plain else mine[0] if len(mine) == 1 and not mine[0].port else None

    def _put_in_front(self, at: _Node, new: _Node) -> None:
        new.parent, new.port = at.parent, at.port
        at.parent, at.port = new, ""
        self.nodes.insert(self.nodes.index(at), new)

    def _put_behind(self, at: _Node, new: _Node) -> None:
        follower = self._follower(at)
        new.parent, new.port = at, ""
        if follower is not None:
            new.port, follower.parent, follower.port = follower.port, new, ""
        self.nodes.insert(self.nodes.index(at) + 1, new)

    # -- back to tables -------------------------------------------------------------------------------------------

    def written(self) -> tuple[list[Table], list[int]]:
        """The tables in an order in which each stands behind what it hangs on, and their keys."""
        self._sort()
        before: _Node | None = None
        for node in self.nodes:
            if not node.wrong:
                self._say(node, before)
            before = node
        return [one.table for one in self.nodes], [one.key for one in self.nodes]

    def _sort(self) -> None:
        left, placed = list(self.nodes), list[_Node]()
        while left:
            first = next(one for one in left if one.parent is None or one.parent in placed)
            placed.append(first)
            left.remove(first)
        self.nodes = placed

    def _say(self, node: _Node, before: _Node | None) -> None:
        """Under ``after`` what the node hangs on, where that is not the one before it or is said anyway."""
        parent = node.parent
        if parent is None:
            node.table.pop("after", None)
            return
        if parent is before and not node.port and node.table.get("after") != parent.name:
            node.table.pop("after", None)
            return
        if not parent.name:
            parent.name = parent.table["name"] = self._free(str(parent.table.get("type", "element")))
        node.table["after"] = f"{parent.name}.{node.port}" if node.port else parent.name

    def _free(self, kind: str) -> str:
        taken = {one.name for one in self.nodes} | {str(one.table.get("name", "")) for one in self.nodes}
        return next(name for k in count(1) if (name := f"{kind} {k}") not in taken)


@contextmanager
def chain_of(tables: list[Table], keys: list[int]) -> Iterator[ChainEdit]:
    """Tables and keys to change; both lists have what came of it at the end."""
    edit = ChainEdit(tables, keys)
    yield edit
    tables[:], keys[:] = edit.written()
