"""A command's options follow from the typed parameters of its function, its help from the docstring."""

from __future__ import annotations

import json
from typing import Annotated, Any

import pytest
import typer
from typer.testing import CliRunner

from trunnion.cli.command_input import (
    REQUIRED,
    CommandInput,
    CommandSubject,
    InputAttribute,
    NumberBounds,
    OptionReader,
)
from trunnion.cli.options import Line, Progress, Speed, SpeedUnit
from trunnion.cli.places import NOTHING, CommandOutput
from trunnion.cli.program import OneLineGroup
from trunnion.cli.typed import Command, callback


class Found:
    """What was taken, as it is."""

    def __init__(self, **taken: Any) -> None:
        self.taken = taken

    def to_dict(self) -> dict[str, Any]:
        return self.taken

    def __str__(self) -> str:
        return "found"


def pair(asked: CommandInput, text: str, key: str) -> list[Any]:
    return [key, text, asked.unit]


@Command("something", writes=NOTHING, within=True)
def invented(
    line: Line,
    *,
    speed: Speed,
    many: Annotated[list[Any], OptionReader(pair, REQUIRED, several=True)],
    one: Annotated[Any, OptionReader(pair, "as by default")],
    none: Annotated[Any, OptionReader(pair, missing=lambda asked: f"of {asked.file}")],
    count: Annotated[int, NumberBounds(1, 3)] = 2,
    flag: bool = False,
    both: bool = True,
    from_: str = "here",
    unit: SpeedUnit,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion invented a.toml

    --many, -m KEY=VALUE  Several, [N m], and words
        that go on below.
    --one  One.
    --none  One more.
    --count  How many.
    --flag  Without a second name.
    --both/--not-both  With one.
    --from  A word that Python has taken.
    """
    progress(1.0)
    names = [element.kind for element in line.elements]
    return CommandOutput(
        Found(
            kinds=names, speed=speed, many=many, one=one, none=none, count=count, flag=flag, both=both, start=from_,
            unit=unit,
        )
    )  # fmt: skip


def program(function: Any) -> typer.Typer:
    app = typer.Typer(cls=OneLineGroup, add_completion=False)
    app.command("invented")(callback("invented", "What it answers.", function))
    app.command("other")(lambda: None)
    return app


@pytest.fixture
def ask(here):
    return lambda *words: CliRunner().invoke(program(invented), ["invented", "line.toml", *words])


def test_what_is_written_is_what_the_function_takes(ask) -> None:
    told = ask("-m", "a=1", "--many", "b", "--speed", "25 Hz", "--unit", "Hz", "--one", "x", "--none", "y",
               "--count", "3", "--flag", "--not-both", "--from", "there", "--json")  # fmt: skip
    assert told.exit_code == 0, told.output
    found = json.loads(told.stdout)
    assert found["kinds"] == ["ConstantSpeed", "Shaft", "Disk", "HookeJoint", "Shaft", "Disk"]
    assert found["speed"] == pytest.approx(157.07963267948966)
    assert found["many"] == [["--many", "a=1", "Hz"], ["--many", "b", "Hz"]]
    assert (found["one"], found["none"]) == (["--one", "x", "Hz"], ["--none", "y", "Hz"])
    assert (found["count"], found["flag"], found["both"], found["start"]) == (3, True, False, "there")
    assert found["unit"] == "Hz" and found["command"] == "invented" and "written" not in found


def test_what_is_not_written_has_its_default(ask) -> None:
    found = json.loads(ask("-m", "a", "--json").stdout)
    assert (found["one"], found["none"]) == (["--one", "as by default", "rpm"], "of line.toml")
    assert (found["speed"], found["count"], found["flag"], found["both"]) == (None, 2, False, True)
    assert ask("-m", "a").stdout == "found\n"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((), "Missing option '--many'"),
        (("-m", "a", "--count", "4"), "Invalid value for '--count'"),
        (("-m", "a", "--speed", "fast"), "--speed = 'fast': does not start with a number"),
        (("-m", "a", "--unit", "mph"), "mph"),
        (("-m", "a", "--load-case", "tow"), "tow"),
        (("-m", "a", "--within", "soon"), "--within = 'soon'"),
        (("-m", "a", "-o", "a.png"), "No such option"),
    ],
)
def test_what_is_wrong_is_refused(ask, words, said) -> None:
    told = ask(*words)
    assert told.exit_code == 2 and said in told.stderr and len(told.stderr.splitlines()) == 1, told.stderr


def test_help_has_the_sentence_the_docstring_and_the_words_of_every_option(ask, monkeypatch) -> None:
    monkeypatch.setenv("TERMINAL_WIDTH", "200")
    lines = ask("--help").stdout.splitlines()
    told = " ".join(" ".join(line.strip("│ ") for line in lines).split())
    for words in (
        "What it answers.", "Example: trunnion invented a.toml", "-m KEY=VALUE Several, [N m], and words that go on",
        "--both --not-both", "Without a second name.", "--load-case", "--within", "[default: as by default]",
    ):  # fmt: skip
        assert words in told, (words, told)


def test_a_function_and_its_docstring_tell_of_the_same_options() -> None:
    def forgotten(line: Line, *, count: int = 2) -> CommandOutput:
        """Nothing is said of it."""

    def invented_option(line: Line) -> CommandOutput:
        """--count  Of what?"""

    with pytest.raises(TypeError, match="--count"):
        callback("forgotten", "", forgotten)
    with pytest.raises(TypeError, match="called count"):
        callback("invented", "", invented_option)


def test_what_a_command_is_about_may_be_anything(here) -> None:
    argument = typer.Argument(metavar="NUMBER", help="Any.")
    about = CommandSubject(lambda text, texts: CommandInput(float(text), "number", "Hz", texts), {})

    def doubled(
        number: Annotated[float, argument, about], *, asked: Annotated[CommandInput, InputAttribute("itself")]
    ) -> CommandOutput:
        """Twice as much."""
        return CommandOutput(Found(twice=2 * number, unit=asked.unit))

    doubled.__annotations__ = {
        "number": Annotated[float, argument, about],
        "asked": Annotated[CommandInput, InputAttribute("itself")], "return": CommandOutput,
    }  # fmt: skip
    form = Command(writes=NOTHING)(doubled)
    told = CliRunner().invoke(program(form), ["invented", "21", "--json"])
    assert json.loads(told.stdout)["twice"] == 42.0 and json.loads(told.stdout)["unit"] == "Hz"
