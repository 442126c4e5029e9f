"""TOML of files that somebody else may have written: read so far and no further, with one line for what is wrong."""

from __future__ import annotations

import errno
import re
import tomllib
from pathlib import Path
from typing import Any

from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError, short

LARGEST_FILE = 4_000_000
"""Bytes of a driveline file; examples have a few thousand."""
DEEPEST_KEY = 60
# No possessive quantifiers: Python before 3.11.4 reads some of them wrongly.
_OPENING = re.compile(r"""#|\"{3}|'{3}|["']""")
_CLOSING = {
    "#": re.compile(r"\n"),
    "'''": re.compile(r"'{3,5}"),
    "'": re.compile(r"['\n]"),
    '"""': re.compile(r'\\.|"{3,5}', re.DOTALL),
    '"': re.compile(r'\\.|["\n]'),
}
"""What ends a comment or a quoted text of TOML; a backslash takes the next character with it."""
_DEEP_KEY = re.compile(rf"(?<![\w-])(?:[\w-]+[ \t]*\.[ \t]*){{{DEEPEST_KEY}}}")


def read_text(path: Path, start: str = 'start one with "trunnion new two-shaft"') -> str:
    """The text of a TOML file, of which so much and no more is read; ``start``: what to do where there is none.

    Raises
    ------
    InputError : it cannot be read, is empty, too large or no text.
    """
    try:
        if path.is_file() and path.stat().st_size > LARGEST_FILE:
            raise _too_large(str(path), path.stat().st_size)
        with path.open("rb") as stream:  # a device has no size to ask for
            raw = stream.read(LARGEST_FILE + 1)
    except FileNotFoundError:
        there = sorted(p.name for p in path.parent.glob("*.toml")) if path.parent.is_dir() else []
        remedy = nearest(path.name, there) if there else f"check the path, or {start}"
        raise InputError("file not found", key=str(path), remedy=remedy) from None
    except IsADirectoryError:
        raise InputError("is a folder", key=str(path), remedy="name the driveline file in it") from None
    except ValueError:  # a null character
        raise InputError("cannot be the name of a file", key=str(path), remedy="check the name") from None
    except OSError as error:
        if error.errno == errno.ENAMETOOLONG:
            raise InputError("is too long for the name of a file", key=str(path), remedy="check the name") from None
        if path.is_dir():  # Windows reports a folder as a denied permission
            raise InputError("is a folder", key=str(path), remedy="name the driveline file in it") from None
        raise InputError(f"cannot be read ({error.strerror})", key=str(path), remedy="check the file") from None
    if len(raw) > LARGEST_FILE:
        raise _too_large(str(path), len(raw))
    if not raw.strip():
        raise InputError("is empty", key=str(path), remedy=start)
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = "\0"
    if "\0" in text:
        remedy = "save it as UTF-8 text, or name the driveline's TOML file"
        raise InputError("is not a text file in UTF-8", key=str(path), remedy=remedy)
    return text


def _too_large(key: str, size: int) -> InputError:
    problem = f"has {size} bytes, and the description of a driveline at most {LARGEST_FILE}"
    return InputError(problem, key=key, remedy="name the driveline's TOML file")


def toml_of(text: str) -> dict[str, Any]:
    """What a text says.

    Raises
    ------
    InputError : it is too long, or no TOML.
    """
    if len(text) > LARGEST_FILE:
        raise _too_large("", len(text))
    remedy = 'write lines as key = value, with text and units in quotes: angle = "12 deg"'
    if _DEEP_KEY.search(_without_texts(text)):
        raise InputError(f"is not valid here: a key of more than {DEEPEST_KEY} parts", remedy="remove the extra dots")
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        if _breaks_braces(text, str(error)):
            remedy = 'write what stands in braces on one line: { type = "Disk", inertia = "2 kg*m^2" }'
        raise InputError(f"is not valid TOML: {_cut(str(error))}", remedy=remedy) from None
    except ValueError:  # Python refuses to read numbers of more than 4300 digits
        raise InputError("is not valid TOML: a number of thousands of digits", remedy="write 1.2e4, say") from None
    except RecursionError:
        raise InputError("is not valid TOML: nested too deeply", remedy="remove the extra brackets") from None


def _without_texts(text: str) -> str:
    """TOML without its comments and with q for each quoted text, whether it ends or not; the text is read once."""
    kept, place = [], 0
    while opening := _OPENING.search(text, place):
        mark = opening.group()
        kept += [text[place : opening.start()], "" if mark == "#" else "q"]
        closing = (found for found in _CLOSING[mark].finditer(text, opening.end()) if found.group()[0] != "\\")
        place = next((found.end() - found.group().count("\n") for found in closing), len(text))
    return "".join([*kept, text[place:]])


def _breaks_braces(text: str, message: str) -> bool:
    """Whether the parser stopped at the end of a line within an inline table, which has to stay on one."""
    if not (place := re.search(r"\(at line (\d+), column (\d+)\)$", message)):
        return False
    lines, number, column = text.splitlines(), int(place[1]), int(place[2])
    if not 1 <= number <= len(lines) or column <= len(lines[number - 1]):
        return False
    marks = _without_texts(lines[number - 1])
    return marks.count("{") > marks.count("}")


def _cut(message: str) -> str:
    """A parser's message, which may quote the file, with its place kept."""
    what, at, place = message.rpartition(" (at ")
    return f"{short(what, 120)}{at}{place}" if at else short(message, 120)
