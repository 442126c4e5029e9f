"""Turns pydantic's report into sentences of ours, one a line."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Any

from pydantic import BaseModel, ValidationError

from trunnion.errors import InputError, short

MOST_WORDS = 16
"""Most known words that a remedy lists."""


def nearest(word: object, known: Iterable[str]) -> str:
    """Remedy for a word that is not known: the one it probably means, or all there are."""
    words, word = list(known), str(word)
    by_lower = {candidate.lower(): candidate for candidate in words}
    near = difflib.get_close_matches(short(word).lower(), by_lower, n=1, cutoff=0.5)
    if near:
        return f'did you mean "{short(by_lower[near[0]])}"?'
    more = f" and {len(words) - MOST_WORDS} more" if len(words) > MOST_WORDS else ""
    return f"known: {', '.join(short(w) for w in words[:MOST_WORDS])}{more}" if words else "there are none"


def about(error: InputError, element: str) -> InputError:
    """The same complaints about an element by a better name."""
    return error.each(lambda one: one.but(element=element))


def numbered(error: InputError, what: str, place: int) -> InputError:
    """The same complaints about the entry at ``place`` of a list of ``what``."""
    return error.each(lambda one: one.but(element="", key=f"{what} {place} {one.key}".strip()))


def refuse(
    error: ValidationError, model: type[BaseModel], given: dict[str, Any], *, element: str, example: str = ""
) -> InputError:
    """pydantic's list as complaints of ours, at most one about a key.

    A misspelt key shows twice, as an unknown key and as a missing one: where there are unknown keys, missing
    ones wait.

    Parameters
    ----------
    error : what pydantic raised.
    model : the class it was building.
    given : the keyword arguments it was given.
    element : how to name the thing in the message.
    example : a correct call or table, offered when a key is missing.
    """
    complaints = sorted(error.errors(include_url=False), key=lambda c: _RANK.get(c["type"], 1))
    if complaints[0]["type"] == "extra_forbidden":
        complaints = [c for c in complaints if c["type"] != "missing"]
    by_key: dict[str, Any] = {}
    for complaint in complaints:
        by_key.setdefault(str(complaint["loc"][0]) if complaint["loc"] else "", complaint)
    return InputError.together([_complaint(one, key, model, given, element, example) for key, one in by_key.items()])


def _complaint(
    found: Any, key: str, model: type[BaseModel], given: dict[str, Any], element: str, example: str
) -> InputError:
    if found["type"] == "extra_forbidden":
        return InputError(
            "unknown key", element=element, key=key, value=given[key], remedy=nearest(key, model.model_fields)
        )
    if found["type"] == "missing":
        return InputError("is missing", element=element, key=key, remedy=f"write {example}" if example else "")
    cause = found.get("ctx", {}).get("error")
    if isinstance(cause, InputError):
        return cause.each(lambda one: _placed(one, key, given, element))
    problem, remedy = next(
        (words for kind, words in _PLAIN.items() if found["type"].startswith(kind)),
        (found["msg"][:1].lower() + found["msg"][1:], ""),
    )
    return InputError(problem, element=element, key=key, value=given.get(key), remedy=remedy)


def _placed(cause: InputError, key: str, given: dict[str, Any], element: str) -> InputError:
    key = cause.key or key
    value = None if cause.element else given.get(key)  # as it was written, "95 deg" rather than 1.658
    return cause.but(element=cause.element or element, key=key, value=cause.value if value is None else value)


_RANK = {"extra_forbidden": 0, "missing": 2}
_PLAIN = {
    "bool_": ("is neither true nor false", "write true or false, without quotes"),
    "int_": ("must be a whole number", "write 3, say, without quotes"),
    "string_type": ("must be text", "write it in quotes"),
    "tuple_type": ("must be a list", "write it in square brackets"),
    "model_": ("is not a table", "write a table of its keys"),
    "callable_type": ("must be a function", "write function=lambda time, speed, angle: 20.0, say"),
}
"""Problem and remedy by how the name of pydantic's complaint begins."""
