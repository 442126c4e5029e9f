"""Turns pydantic's report of several lines into one sentence of ours."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Any

from pydantic import BaseModel, ValidationError

from trunnion.errors import InputError


def nearest(word: str, known: Iterable[str]) -> str:
    """Remedy for a word that is not known: the one it probably means, or all there are."""
    words = list(known)
    by_lower = {candidate.lower(): candidate for candidate in words}
    near = difflib.get_close_matches(word.lower(), by_lower, n=1, cutoff=0.5)
    if near:
        return f'did you mean "{by_lower[near[0]]}"?'
    return f"known: {', '.join(words)}" if words else "there are none"


def about(error: InputError, element: str) -> InputError:
    """The same complaint about an element by a better name."""
    return InputError(error.problem, element=element, key=error.key, value=error.value, remedy=error.remedy)


def refuse(
    error: ValidationError, model: type[BaseModel], given: dict[str, Any], *, element: str, example: str = ""
) -> InputError:
    """Pick the one complaint worth reading from pydantic's list.

    A misspelt key usually shows twice, as an unknown key and as a missing one, so unknown keys come first;
    missing keys come last because another complaint often explains them.

    Parameters
    ----------
    error : what pydantic raised.
    model : the class it was building.
    given : the keyword arguments it was given.
    element : how to name the thing in the message.
    example : a correct call or table, offered when a key is missing.
    """
    complaints = sorted(error.errors(include_url=False), key=lambda c: _RANK.get(c["type"], 1))
    first = complaints[0]
    key = str(first["loc"][0]) if first["loc"] else ""
    if first["type"] == "extra_forbidden":
        return InputError(
            "unknown key", element=element, key=key, value=given[key], remedy=nearest(key, model.model_fields)
        )
    if first["type"] == "missing":
        return InputError("is missing", element=element, key=key, remedy=f"write {example}" if example else "")
    cause = first.get("ctx", {}).get("error")
    if isinstance(cause, InputError):
        key = cause.key or key
        value = given.get(key)  # as it was written, "95 deg" rather than 1.658
        return InputError(
            cause.problem,
            element=cause.element or element,
            key=key,
            value=cause.value if value is None else value,
            remedy=cause.remedy,
        )
    return InputError(first["msg"][:1].lower() + first["msg"][1:], element=element, key=key, value=given.get(key))


_RANK = {"extra_forbidden": 0, "missing": 2}
