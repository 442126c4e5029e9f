"""What a command is about, and how a parameter of its function says what the terminal states."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import trunnion as tn

REQUIRED: Any = inspect.Parameter.empty
"""The default of what must be stated."""
Texts = Mapping[str, Any]
"""What was written at each option, by the name of its parameter."""


@dataclass(frozen=True)
class CommandInput:
    """What a command is about: the line or system, what it was called, the unit of speeds, and all that was written."""

    subject: Any
    file: str
    unit: str
    texts: Texts

    @property
    def itself(self) -> CommandInput:
        """All of it."""
        return self

    @property
    def line(self) -> tn.Driveline:
        """Where it is about a line."""
        line: tn.Driveline = self.subject
        return line


@dataclass(frozen=True)
class OptionReader:
    """How the text of an option becomes what the function takes.

    by : reads a text, given what is asked about and the option as it is written. default : the text where none is
    written. several : the option may be repeated, each text is read. missing : what is taken where there is no text;
    None by default.
    """

    by: Callable[[CommandInput, str, str], Any]
    default: Any = None
    several: bool = False
    missing: Callable[[CommandInput], Any] | None = None

    @property
    def text(self) -> Any:
        """What Typer is to read."""
        one: Any = list[str] if self.several else str
        return one | None if self.default is None else one

    def value(self, asked: CommandInput, text: Any, key: str) -> Any:
        """What the function takes."""
        if text is None or text == []:
            return None if self.missing is None else self.missing(asked)
        return [self.by(asked, one, key) for one in text] if self.several else self.by(asked, text, key)


@dataclass(frozen=True)
class CommandSubject:
    """How what a command is about is read, from its argument and all texts, and the options that belong to it."""

    read: Callable[[str, Texts], CommandInput]
    options: Mapping[str, Any]


@dataclass(frozen=True)
class InputAttribute:
    """An attribute of what is asked about; no option."""

    attribute: str


@dataclass(frozen=True)
class NumberBounds:
    """Between what a number must be."""

    least: float
    most: float | None = None
