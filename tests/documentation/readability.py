"""Flesch's reading ease of sentences, with the syllables that ``pyphen`` finds (its patterns come with the package).

python tests/documentation/readability.py [NUMBER]     # prints the hardest sentences of the pages and each page's ease
"""

from __future__ import annotations

import re
import sys
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
    found = [one for part in prose(text) for one in re.split(r"(?<=[.!?])\s+(?=[A-Z`*(])", part)]
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


if __name__ == "__main__":
    ranked = []
    for name in PAGES:
        page = (ROOT / name).read_text(encoding="utf-8")
        if sentences(page):
            print(
                f"{ease_of(page):5.1f}  {len(sentences(page)):4d} sentences, the longest {longest(page)} words  {name}"
            )
            ranked += [(ease(one), name, one) for one in sentences(page)]
    for mark, name, sentence in sorted(ranked)[: int(sys.argv[1]) if sys.argv[1:] else 0]:
        print(f"{mark:7.1f} {name}: {sentence}")
