"""Index of error messages: every refusal that the tests trigger, triggered here, sorted by what is wrong."""

from __future__ import annotations

import contextlib
import os
import re
import tempfile
import warnings
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import trunnion as tn
from generate.markdown import table, write

NUMBER = re.compile(r"(?<![\w.])[+-]?\d[\d.,]*(e[+-]?\d+)?")
QUOTED = re.compile(r"'[^']*'|\"[^\"]*\"")
LONGEST = 160


def _refused(action: Callable[[], Any]) -> tn.InputError | None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            action()
        except tn.InputError as problem:
            return problem
        except Exception:  # a table may hold other endings too; the tests judge those
            return None
    return None


def refusals() -> Iterator[tn.InputError]:
    """Every complaint of the tables in ``tests/contract/test_bad_input.py``."""
    import contract.test_bad_input as bad

    for action, *_ in bad.PYTHON:
        if found := _refused(action):
            yield from found.problems
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        for content, *_ in bad.FILES:
            Path("my-line.toml").write_bytes(content if isinstance(content, bytes) else content.encode())
            if found := _refused(lambda: tn.load("my-line.toml")):
                yield from found.problems
    assert os.path.isdir(Path.cwd())


def _wrong(problem: str) -> str:
    """What is wrong, without the numbers and names of one case."""
    text = QUOTED.sub("…", problem.split(";")[0].split(":")[0])
    return NUMBER.sub("…", text).strip()


def write_page(path: Path) -> None:
    """Sorted by the sentence, with one whole message of each and what to do."""
    groups: dict[str, list[tn.InputError]] = defaultdict(list)
    for one in refusals():
        if one.problem:
            groups[_wrong(one.problem)].append(one)
    rows = []
    for wrong, found in sorted(groups.items(), key=lambda item: item[0].lower()):
        shortest = min(found, key=lambda one: len(str(one)))
        message = str(shortest).replace("`", "'")
        message = message if len(message) <= LONGEST else message[: LONGEST - 1] + "…"
        keys = sorted({one.key.split(" ")[0].split(".")[0] for one in found if one.key})
        named = ", ".join(f"`{key}`" for key in keys[:6]) + (f" and {len(keys) - 6} more" if len(keys) > 6 else "")
        rows.append((wrong, named, f"`` {message} ``"))
    write(
        path,
        "\n\n".join(
            [
                "# Index of error messages",
                "A message is one line: element, key, value, what is wrong; then what to write instead. Look for the words "
                "behind the colon. The tests trigger every refusal in this table, and this page was made by triggering them "
                f"again: {sum(map(len, groups.values()))} refusals of {len(groups)} kinds. Exit code of a command: 2.",
                table(("what is wrong", "of", "as an example"), rows),
            ]
        ),
    )
