"""Elements put in, taken out and moved along lines with branches: every one keeps what it hangs on.

What hangs on what is read by the reader of files itself, by names given once; the expectation is kept as a plain tree
beside it.
"""

from __future__ import annotations

from random import Random

import pytest

pytest.importorskip("panel")

from trunnion.app.parts.document import Document
from trunnion.app.parts.editing import change_of
from trunnion.errors import InputError

BRANCHED = """
format = 1
[[element]]
type = "Disk"
name = "a"
inertia = "1 kg*m^2"
[[element]]
type = "Shaft"
name = "ab"
stiffness = "1 kN*m/rad"
[[element]]
type = "Disk"
name = "b"
inertia = "1 kg*m^2"
[[element]]
type = "Shaft"
name = "bc"
stiffness = "2 kN*m/rad"
[[element]]
type = "Disk"
name = "c"
inertia = "1 kg*m^2"
[[element]]
type = "Shaft"
name = "bd"
after = "b"
stiffness = "3 kN*m/rad"
[[element]]
type = "Disk"
name = "d"
inertia = "1 kg*m^2"
[[element]]
type = "Shaft"
name = "de"
stiffness = "4 kN*m/rad"
[[element]]
type = "Disk"
name = "e"
inertia = "1 kg*m^2"
[[element]]
type = "Disk"
name = "f"
after = "b"
inertia = "1 kg*m^2"
"""


def labels(document: Document) -> list[str]:
    """Given names; of what came later, whose usual names change, the keys."""
    tables, keys = document.data["element"], document.element_keys
    given = set(BRANCHED.split('"')[1::2])
    return [one["name"] if one.get("name") in given else f"new {key}" for one, key in zip(tables, keys, strict=True)]


def tree(document: Document) -> dict[str, str]:
    """What each element hangs on, as the reader of files has it."""
    assert document.problems == (), document.problems
    called = labels(document)
    parents = document.line.as_stated.parents
    return {name: "" if p is None else called[p] for name, p in zip(called, parents, strict=True)}


def place(document: Document, name: str) -> int:
    return labels(document).index(name)


def test_what_is_put_in_front_takes_the_place_in_the_branch() -> None:
    document = Document(BRANCHED)
    before = tree(document)
    document.insert(place(document, "bd"), "Disk", True)
    (first,) = set(tree(document)) - set(before)
    assert tree(document) == before | {first: "b", "bd": first}
    document.insert(place(document, "b"), "Disk", False)  # both branches stay with b
    now = tree(document)
    (new,) = set(now) - set(before) - {first}
    assert now == before | {first: "b", "bd": first, new: "b", "bc": new}
    document.branch(place(document, "c"), "Disk")
    (last,) = set(tree(document)) - set(now)
    assert tree(document) == now | {last: "c"}
    for _ in range(3):
        document.undo()
    assert tree(document) == before


def test_what_is_taken_out_joins_no_other_chain() -> None:
    document = Document(BRANCHED)
    before = tree(document)
    document.remove(("element", place(document, "bd")))
    assert tree(document) == {k: v for k, v in before.items() if k != "bd"} | {"d": "b"}
    document.undo()
    document.remove(("element", place(document, "a")))
    assert tree(document) == {k: v for k, v in before.items() if k != "a"} | {"ab": ""}
    document.remove(("element", place(document, "ab")))
    document.remove(("element", place(document, "b")))  # three hung on it: the first is the beginning
    assert document.data["element"][0]["name"] == "bc"
    assert [one.get("after") for one in document.data["element"]].count("bc") == 2


def test_a_branch_goes_with_what_it_leaves_from() -> None:
    document = Document(BRANCHED)
    before = tree(document)
    document.put(place(document, "b"), place(document, "c"), False)
    assert tree(document) == before | {"bc": "ab", "b": "c"}
    document.undo()
    with pytest.raises(InputError, match="e: stands on a branch that leaves from b"):
        document.put(place(document, "b"), place(document, "e"), True)
    assert tree(document) == before
    document.put(place(document, "f"), place(document, "e"), False)
    assert tree(document) == before | {"f": "e"}


def test_steps_go_along_the_chain_and_end_with_it() -> None:
    document = Document(BRANCHED)
    before = tree(document)
    document.move(place(document, "de"), -1)
    assert tree(document) == before | {"de": "bd", "d": "de", "e": "d"}
    document.move(place(document, "de"), 1)
    assert tree(document) == before
    document.move(place(document, "c"), 1)
    assert tree(document) == before


@pytest.mark.parametrize("seed", range(25))
def test_random_changes_leave_the_tree_that_they_say(seed: int) -> None:
    """A plain tree is changed beside: put between, taken out, moved by taking out and putting in."""
    random, document = Random(seed), Document(BRANCHED)
    expected, made = tree(document), 0

    def through(of: str) -> str:
        own = [n for n, p in expected.items() if p == of]
        plain = [n for n in own if "after" not in document.data["element"][place(document, n)]]
        return plain[0] if plain else own[0] if len(own) == 1 else ""

    for _ in range(12):
        names = list(expected)
        name, act = random.choice(names), random.choice(("in front", "behind", "branch", "remove", "put"))
        kept = dict(expected)
        if act == "remove":
            if not expected[name] or sum(p == "" for p in expected.values()) == len(expected):
                continue
            document.remove(("element", place(document, name)))
            up = expected.pop(name)
            expected.update({n: up for n, p in kept.items() if p == name})
        elif act == "put":
            other, front = random.choice(names), random.random() < 0.5
            up, on = other, through(name)
            while up and up != name:
                below, up = up, expected[up]
            if not expected[name] or other == name or (up == name and below != on):
                continue
            if front and not expected[other]:
                continue
            follower = through(other)
            if on:
                expected[on] = expected[name]
                follower = on if follower == name else follower
            elif follower == name:
                follower = ""
            document.put(place(document, name), place(document, other), front)
            if front:
                expected[name], expected[other] = expected[other], name
            else:
                expected[name] = other
                if follower:
                    expected[follower] = name
        else:
            if act == "in front" and not expected[name]:
                continue
            follower = through(name)
            at = place(document, name)
            document.branch(at, "Disk") if act == "branch" else document.insert(at, "Disk", act == "in front")
            made += 1
            if document.problems:
                document.undo()
                continue
            (new,) = set(labels(document)) - set(expected)
            expected[new] = expected[name] if act == "in front" else name
            if act == "in front":
                expected[name] = new
            elif act == "behind" and follower:
                expected[follower] = new
        if document.problems:  # a branch from a shaft: refused, and said so
            document.undo()
            expected = kept
            continue
        assert tree(document) == expected, (act, name)


def test_messages_of_the_picture_go_by_keys() -> None:
    document = Document(BRANCHED)
    keys, names = document.element_keys, labels(document)
    before = tree(document)

    def said(name: str) -> dict[str, object]:
        return {"path": ["element", names.index(name)], "key": keys[names.index(name)]}

    document.insert(0, "Disk", True)  # all of them have moved since the picture was drawn
    now = tree(document)
    target = said("e")
    move = {"do": "put", **said("de"), "target": target["path"], "target_key": target["key"], "front": False}
    change_of(move)(document)
    assert tree(document) == now | {"e": "d", "de": "e"}
    change_of({"do": "branch", "kind": "Disk", **said("c")})(document)
    assert sum(parent == "c" for parent in tree(document).values()) == 1 + sum(p == "c" for p in before.values())


def test_beside_a_part_stands_what_is_said_of_it() -> None:
    document = Document(BRANCHED)
    document.add_limit("bc")
    document.add_limit("Shaft *")
    document.add_limit("d*")
    document.add_load_case()
    groups = document.about("bc")
    assert [one.title for one in groups] == ["bc", "limit of bc", "limit of Shaft *"]
    last = document.about(document.line.as_stated.names[-1])
    assert [one.kind for one in last] == ["Disk", "in load case load 1"]
    assert [f.label for f in last[1].fields] == [f"torque at {last[0].title}"]
    assert [one.title for one in document.about("de")] == ["de", "limit of Shaft *", "limit of d*"]
    assert document.about("nobody") == ()
