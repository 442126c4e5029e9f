"""Flesch's reading ease of sentences, with the syllables that ``pyphen`` finds (its patterns come with the package).

python tests/documentation/readability.py [NUMBER]     # ease of each page; the hardest sentences, docstrings' too
"""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pyphen

ROOT = Path(__file__).parents[2]
WORDS = pyphen.Pyphen(lang="en_GB")
PAGES = ("README.md", "CONTRIBUTING.md", *sorted(str(p.relative_to(ROOT)) for p in (ROOT / "docs").glob("*.md")))


@cache
def syllables(word: str) -> int:
    """Places where a word may be broken, and one."""
    return len(WORDS.positions(word.lower())) + 1


def prose(text: str) -> list[str]:
    """Paragraphs and items without code, tables, headings, pictures and links' targets."""
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r"^(```|::::|:::).*?^\1", "", text, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"^(\||#|!\[|    |\().*$", "", text, flags=re.MULTILINE)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"(?<=[.!?]\s)`+[^`]*`+", "Code", text)
    text = re.sub(r"`+[^`]*`+", "code", text)
    return [
        " ".join(part.split()) for part in re.split(r"\n\s*\n|^\s*[-*\d.]+ ", text, flags=re.MULTILINE) if part.strip()
    ]


def sentences(text: str) -> list[str]:
    """Those of six words and more; a semicolon or a colon does not end one."""
    found = [one for part in prose(text) for one in re.split(r"(?<=[.!?])\s+(?=[A-Z`*(\"])", part)]
    return [one for one in found if len(words(one)) >= 6]


def words(sentence: str) -> list[str]:
    """Of letters."""
    return re.findall(r"[A-Za-z][A-Za-z'’-]*", sentence)


def ease(sentence: str) -> float:
    """206.835 − 1.015 words a sentence − 84.6 syllables a word: 60 and more is plain English, below 0 is very hard."""
    found = words(sentence)
    return 206.835 - 1.015 * len(found) - 84.6 * sum(map(syllables, found)) / len(found)


def ease_of(text: str) -> float:
    """Of a whole page: means over its sentences."""
    found = [words(one) for one in sentences(text)]
    count = sum(map(len, found))
    return 206.835 - 1.015 * count / len(found) - 84.6 * sum(syllables(w) for one in found for w in one) / count


def longest(text: str) -> int:
    """Words of the longest sentence."""
    return max(len(words(one)) for one in sentences(text))


def prose_of_docstring(docstring: str) -> str:
    """Its sentences and what it says of every parameter, without names, headings and examples."""
    text = re.sub(r"^>>>.*?(?=\n\n|\Z)", "", docstring, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"^(Parameters|Returns|Raises|Examples)\n-+$", "", text, flags=re.MULTILINE)
    return re.sub(r"^[\w, *`]+ : ", "\n\n", text, flags=re.MULTILINE).replace("\n    ", " ")


def docstrings() -> Iterator[tuple[str, str]]:
    """Those of every public function and class."""
    import trunnion as tn

    for name in tn.__all__:
        if callable(found := getattr(tn, name)):
            yield name, inspect.cleandoc(found.__doc__ or "")


if __name__ == "__main__":
    ranked = []
    for name in PAGES:
        page = (ROOT / name).read_text(encoding="utf-8")
        if sentences(page):
            print(
                f"{ease_of(page):5.1f}  {len(sentences(page)):4d} sentences, the longest {longest(page)} words  {name}"
            )
            ranked += [(ease(one), name, one) for one in sentences(page)]
    for name, docstring in docstrings():
        ranked += [(ease(one), name, one) for one in sentences(prose_of_docstring(docstring))]
    for mark, name, sentence in sorted(ranked)[: int(sys.argv[1]) if sys.argv[1:] else 0]:
        print(f"{mark:7.1f} {name}: {sentence}")
