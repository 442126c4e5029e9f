"""A call of a public function as data: what a worker evaluates is what the exported Python says, word for word."""

from __future__ import annotations

import inspect
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import trunnion

LIBRARIES = {"tn": trunnion, "np": np}
GIVEN_BY_WORKER = ("progress", "threads")
"""Arguments that change no number: the worker adds them, the exported Python leaves them out."""


@dataclass(frozen=True)
class SentFile:
    """A file that the browser sent, as an argument: read where it is kept, named in Python as the user knows it."""

    name: str
    path: str


@dataclass(frozen=True)
class Call:
    """``function(*arguments, **keywords)``, the function as "tn.order_response" or "np.linspace".

    Arguments are numbers, texts, tuples of them, ``LINE``, files, or further calls. ``of``: the call whose result the
    function is a method of, then named without a library.
    """

    function: str
    arguments: tuple[Any, ...] = ()
    keywords: Mapping[str, Any] = field(default_factory=dict)
    of: Call | None = None

    def evaluate(self, line: Any, given: Mapping[str, Any] | None = None) -> Any:
        """What the call gives for ``line``; ``given`` adds those of its arguments that the outermost function takes."""
        if self == LINE:
            return line
        library, _, name = self.function.rpartition(".")
        if name.startswith("_") or (self.of is None and library not in LIBRARIES):
            raise ValueError(f"no call of {self.function}")
        if not given and self._reads_file:
            return self._read(getattr(LIBRARIES[library], name))
        owner = LIBRARIES[library] if self.of is None else self.of.evaluate(line)
        function = getattr(owner, name)
        arguments = [_value(a, line) for a in self.arguments]
        keywords = {key: _value(value, line) for key, value in self.keywords.items()}
        if given:
            taken = inspect.signature(function).parameters
            keywords |= {key: value for key, value in given.items() if key in taken and key in GIVEN_BY_WORKER}
        return function(*arguments, **keywords)

    @property
    def _reads_file(self) -> bool:
        return bool(self.arguments) and isinstance(self.arguments[0], SentFile)

    def _read(self, function: Any) -> Any:
        """What a call reads of a file; the last ones are kept, whatever becomes of the line."""
        if repr(self) not in _READ:
            while len(_READ) >= KEPT_FILES:
                del _READ[next(iter(_READ))]
            FOLDERS.update(Path(one.path).parent for one in self.arguments if isinstance(one, SentFile))
            made = function(*(_value(a, None) for a in self.arguments), **self.keywords)
            _READ[repr(self)] = made
        return _READ[repr(self)]

    def text(self) -> str:
        """The call as Python."""
        if self == LINE:
            return self.function
        parts = [_text(a) for a in self.arguments] + [f"{k}={_text(v)}" for k, v in self.keywords.items()]
        owner = "" if self.of is None else f"{self.of.text()}."
        return f"{owner}{self.function}({', '.join(parts)})"


_READ: dict[str, Any] = {}
"""What was read of files last, by its call: a recording takes seconds, which a line that is edited need not wait."""
KEPT_FILES = 2
"""A run and its reference."""

FOLDERS: set[Path] = set()
"""Where files were that the browser sent: whoever is left of a server that was killed deletes them."""

LINE = Call("line")
"""Stands for the driveline: an argument of calls, and a call where it is shown as it is."""


def script(toml: str, results: Mapping[str, tuple[Call, str]], title: str, soft: Collection[str] = ()) -> str:
    """Python that computes ``results`` for the driveline ``toml``: by name, each call with the file of its line.

    What is ``soft`` may be refused: the program says so and goes on.
    """
    body, now = [], toml
    asked_for: list[tuple[str, Call, str]] = []
    for name, (call, of) in results.items():
        if call == LINE:
            continue
        again = next((n for n, *what in asked_for if what == [call, of]), "")
        if again:
            body.append(f"{name} = {again}")
            continue
        if name not in soft:
            asked_for.append((name, call, of))
        change = f"line = tn.loads({_block(of)})\n" if of != now else ""
        asked = f"{name} = {call.text()}\nprint({name})"
        if name in soft:
            tried = asked.replace("\n", "\n    ")
            asked = f"try:\n    {tried}\nexcept tn.errors.TrunnionError as refusal:\n    print(refusal)"
        body.append(change + asked)
        now = of
    return "\n".join(
        [
            _docstring(f"{title}: what the application showed."),
            "",
            *(["import numpy as np"] if any("np." in part for part in body) else []),
            "import trunnion as tn",
            "",
            f"line = tn.loads({_block(toml)})",
            "",
            *body,
            "",
        ]
    )


def _docstring(text: str) -> str:
    """A text as what a program begins with; one that would end the usual quotes, or hold more than a line, escaped."""
    plain = text.isprintable() and '"' not in text and "\\" not in text
    return f'"""{text}"""' if plain else repr(text)


def _block(text: str) -> str:
    """A text of many lines as Python, readable where it may be."""
    plain = text.isprintable() or all(c.isprintable() or c == "\n" for c in text)
    if not plain or "'''" in text or "\\" in text or text.endswith("'"):
        return repr(text)
    return f"'''\n{text}'''"


def _value(argument: Any, line: Any) -> Any:
    match argument:
        case Call():
            return argument.evaluate(line)
        case SentFile():
            return argument.path
        case tuple():
            return tuple(_value(part, line) for part in argument)
        case Mapping():
            return {key: _value(part, line) for key, part in argument.items()}
    return argument


def _text(argument: Any) -> str:
    match argument:
        case Call():
            return argument.text()
        case SentFile():
            return repr(argument.name)
        case tuple():
            inside = ", ".join(_text(part) for part in argument)
            return f"({inside},)" if len(argument) == 1 else f"({inside})"
        case Mapping():
            return "{" + ", ".join(f"{key!r}: {_text(part)}" for key, part in argument.items()) + "}"
        case np.generic():
            return repr(argument.item())
    return repr(argument)
