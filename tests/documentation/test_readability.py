"""Pages are plain English: short sentences of the field's words."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from readability import PAGES, ROOT, docstrings, ease, ease_of, longest, prose_of_docstring, sentences, syllables

LISTS = ("docs/features.md", "docs/glossary.md")
"""Their sentences are lists of features, or begin with the word that they define."""
EASE = 68.0
EASE_OF_NOTES = 60.0
"""Docstrings have more names of programs and methods."""
WORDS = 70
RETIRED = (
    "by and by up to the lowest row", "passes in no way is refused", "Orders act at the nominal angle",
    "keeps half of its wall",
    "leaves out in silence", "times its usual one", "carry what keeps it there", "wait for no compiler",
    "goes before its kind's", "three speeds stand for all", "rises beyond linear theory",
)  # fmt: skip
"""Sentences that only their author understood."""


def page(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


@pytest.mark.parametrize("name", [name for name in PAGES if len(sentences(page(name))) > 5])
def test_a_page_is_plain(name: str) -> None:
    assert ease_of(page(name)) > EASE
    assert name in LISTS or longest(page(name)) <= WORDS, max(sentences(page(name)), key=len)


@pytest.mark.parametrize(("name", "docstring"), [*docstrings()])
def test_a_docstring_is_plain(name: str, docstring: str) -> None:
    prose = prose_of_docstring(docstring)
    if len(sentences(prose)) > 5:
        assert ease_of(prose) > EASE_OF_NOTES
        assert longest(prose) <= WORDS, max(sentences(prose), key=len)


def test_what_a_docstring_shows_is_not_read_as_prose() -> None:
    parameters = "Parameters\n----------\nspeed, mode : of the input that turns the whole line\n    [rad/s]."
    text = f"It turns.\n\n{parameters}\n\n>>> f(1)\n2"
    assert sentences(prose_of_docstring(text)) == ["of the input that turns the whole line [rad/s]."]


def test_what_is_retired_stays_away() -> None:
    files = [*(ROOT / "src").rglob("*.py"), *(ROOT / "docs").glob("*.md"), ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
    text = {path: re.sub(r"\s+", " ", Path(path).read_text(encoding="utf-8")) for path in files}
    assert [(path.name, old) for path, whole in text.items() for old in RETIRED if old in whole] == []


def test_the_measure_tells_plain_from_hard() -> None:
    plain = "The shaft turns at a fixed speed and the disk hangs on it."
    hard = "Characteristic coefficients necessitate differentiability of interpolated monodromy representations."
    assert ease(plain) > 90 and ease(hard) < 10
    assert [syllables(word) for word in ("shaft", "torsion", "vibration")] == [1, 2, 3]


def test_code_tables_and_headings_do_not_count() -> None:
    code = "```sh\none two three four five six seven\n```"
    text = f"# A heading of seven words stands here\n\n{code}\n\n| a | b |\n\nOne sentence of just six words.\n"
    assert sentences(text) == ["One sentence of just six words."]
