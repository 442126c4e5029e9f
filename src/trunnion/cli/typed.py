"""A command from a function: its options follow from the function's typed parameters.

The annotation of a parameter says what the function takes, and how the terminal states it:

- a type alone is read by Typer, in bounds where ``NumberBounds`` stands beside it;
- with ``OptionReader`` the text is read here, for the line and in the unit of speeds that are asked about;
- ``CommandSubject`` reads what the command is about, and brings options of its own, ``--unit`` say;
- ``InputAttribute`` is a part of that, the unit, and no option.

What ``--help`` says of an option is a line of the docstring, as it is written in a terminal and two blanks before the
words: ``--orders K,K,…  Cycles per turn of the input``; options that several commands share bring theirs along. A
parameter ``progress`` gets the callback. ``Command`` says how the answer is handed over, whence ``--output`` and
``--within``; every command has ``--json``.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args

import typer

from trunnion.cli import output
from trunnion.cli.command_input import (
    REQUIRED,
    CommandInput,
    CommandSubject,
    InputAttribute,
    NumberBounds,
    OptionReader,
    Texts,
)
from trunnion.cli.files import check_not_read
from trunnion.cli.places import PAGES, PICTURES_AND_DATA, TABLES, CommandOutput, answer, check_places
from trunnion.cli.readers import read_time

F = TypeVar("F", bound=Callable[..., Any])
Json = Annotated[bool, typer.Option("--json", help="Print JSON on stdout and nothing else.")]
Within = Annotated[
    str | None,
    typer.Option("--within", metavar="TIME", help='End within this time, "30 s" say, with what is known by then.'),
]
OUTPUT_HELP = {
    TABLES: "File ending in .png, .pdf, .svg, .nc or .csv; repeat it for more.",
    PAGES: "File ending in .html, .gif or .json; repeat it for more.",
    PICTURES_AND_DATA: "File ending in .png, .pdf, .svg or .nc; repeat it for more.",
}
OPTION = re.compile(r"^(--[\w-]+(?:/--[\w-]+)?)(?:, (-\w))?(?: (\S+))?  (.*(?:\n {4}.*)*)\n?", re.MULTILINE)
"""A line of a docstring about an option, and those indented below it: names, what stands for its value, words."""


@dataclass(frozen=True)
class Command:
    """How a command computes and hands over what its function finds, a ``CommandOutput``.

    doing : what it says it is at; "" where it is quick. writes : endings of its files. unasked : whether it writes some
    where none is asked for. part : what they are called beside the file asked about; by default as the command.
    within : whether it may be given a time limit.
    """

    doing: str = ""
    writes: tuple[str, ...] = TABLES
    unasked: bool = True
    part: str = ""
    within: bool = False

    def __call__(self, function: F) -> F:
        """Say so of a function."""
        function.command = self  # type: ignore[attr-defined]
        return function

    def options(self) -> Iterator[tuple[str, Any, Any]]:
        """Names, annotations and defaults of the options that follow."""
        if self.writes:
            shown = typer.Option("--output", "-o", metavar="PATH", help=OUTPUT_HELP[self.writes])
            yield "outputs", Annotated[list[Path] | None, shown], None
        if self.within:
            yield "within", Within, None
        yield "as_json", Json, False


@dataclass(frozen=True)
class _TypedParameter:
    """A parameter that the terminal states."""

    parameter: inspect.Parameter
    info: Any

    @property
    def of_typer(self) -> tuple[str, Any, Any]:
        """Name, annotation and default, for Typer."""
        name, default, kind = self.parameter.name, self.parameter.default, self.parameter.annotation
        if _mark(self.parameter, CommandSubject):
            return name, Annotated[str, self.info], REQUIRED
        if read := _mark(self.parameter, OptionReader):
            return name, Annotated[read.text, self.info], read.default
        return name, Annotated[get_args(kind)[0] if _marks(self.parameter) else kind, self.info], default

    def value(self, asked: CommandInput, texts: Texts) -> Any:
        """What the function takes."""
        if _mark(self.parameter, CommandSubject):
            return asked.subject
        text, read = texts[self.parameter.name], _mark(self.parameter, OptionReader)
        # Typer has the first name of an option where others have its default.
        return read.value(asked, text, str(self.info.default)) if read else text


def callback(name: str, sentence: str, function: Callable[..., CommandOutput]) -> Callable[..., None]:
    """What Typer calls for the command ``name``: reads the options, calls ``function``, writes and says the answer.

    Raises
    ------
    TypeError : the function and its docstring do not tell of the same options.
    """
    made: Command = getattr(function, "command", Command())
    parameters = inspect.signature(function, eval_str=True).parameters
    described, words = _options_in(inspect.getdoc(function) or "")
    stated, given = [], {}
    for key, parameter in parameters.items():
        info = described.pop(key.rstrip("_"), None) or _mark(parameter, typer.models.ParameterInfo)
        if info:
            stated.append(_TypedParameter(parameter, _bounded(info, _mark(parameter, NumberBounds))))
        elif mark := _mark(parameter, InputAttribute):
            given[key] = mark.attribute
        elif key != "progress":
            raise TypeError(f"{name}: its docstring has no line --{key}")
    if described:
        raise TypeError(f"{name}: takes nothing that is called {', '.join(described)}")
    file, subject = next((key, s) for key, p in parameters.items() if (s := _mark(p, CommandSubject)))

    def run(**texts: Any) -> None:
        asked = subject.read(texts[file], texts)
        values = {one.parameter.name: one.value(asked, texts) for one in stated}
        values |= {key: getattr(asked, attribute) for key, attribute in given.items()}
        outputs, writes = texts.get("outputs"), made.writes and (made.unasked or texts.get("outputs"))
        if writes:
            check_places(outputs, made.writes)
            check_not_read(outputs or (), texts.values())
        within = None if texts.get("within") is None else read_time(texts["within"], "--within")
        with output.progress(made.doing, within) if made.doing else nullcontext() as advance:
            shown = function(**values, **({"progress": advance} if "progress" in parameters else {}))
        written = shown.write(outputs, f"{Path(asked.file).stem}-{made.part or name}", asked.unit) if writes else []
        answer(name, [*written, *shown.written] if made.writes else None, texts["as_json"], shown, asked.unit)

    options = [(key, hint, None) for key, hint in subject.options.items()]
    whole = [*(one.of_typer for one in stated), *options, *made.options()]
    run.__name__, run.__doc__ = name.replace("-", "_"), f"{sentence}\n\n{words}".strip()
    run.__annotations__ = {key: hint for key, hint, _ in whole}
    run.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [inspect.Parameter(k, inspect.Parameter.KEYWORD_ONLY, annotation=h, default=d) for k, h, d in whole]
    )
    return run


def _marks(parameter: inspect.Parameter) -> tuple[Any, ...]:
    """What its annotation says beside the type."""
    return getattr(parameter.annotation, "__metadata__", ())


def _mark(parameter: inspect.Parameter, kind: type) -> Any:
    return next((mark for mark in _marks(parameter) if isinstance(mark, kind)), None)


def _options_in(docstring: str) -> tuple[dict[str, Any], str]:
    """The options that a docstring describes, by parameter, and the rest of its words."""
    found = {}
    for names, short, shown, words in OPTION.findall(docstring):
        declared = (names, short) if short else (names,)
        info = typer.Option(*declared, metavar=shown or None, help=" ".join(words.split()))
        found[names.split("/")[0].lstrip("-").replace("-", "_")] = info
    return found, OPTION.sub("", docstring).strip()


def _bounded(info: Any, bounds: NumberBounds | None) -> Any:
    if bounds is not None:
        info.min, info.max = bounds.least, bounds.most
    return info
