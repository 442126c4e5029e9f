"""Mutated driveline files: each is read or refused, its frequencies found or refused; nothing else may happen."""

from __future__ import annotations

import random
import warnings
from pathlib import Path

import pytest

from trunnion.analyses.linear.natural_frequencies import natural_frequencies
from trunnion.driveline.files import loads
from trunnion.driveline.starter import STARTERS, starter
from trunnion.errors import InputRemark, TrunnionError

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.toml"))
TEXTS = [*map(starter, STARTERS), *(path.read_text(encoding="utf-8") for path in EXAMPLES)]
VALUES = [
    "0",
    "-1",
    "1e30",
    "1e-30",
    "1e300",
    "nan",
    "inf",
    "true",
    '""',
    '"1 rpm"',
    "[]",
    "{}",
    '"$a_$"',
    "9" * 400,
    "0.5",
]


def mutated(seed: int) -> str:
    """One of the files with one to four lines or characters changed."""
    rng = random.Random(seed)
    lines = rng.choice(TEXTS).splitlines()
    for _ in range(rng.randint(1, 4)):
        place = rng.randrange(len(lines))
        key, equals, _ = lines[place].partition("=")
        match rng.randrange(6):
            case 0 if equals:
                lines[place] = f"{key}= {rng.choice(VALUES)}"
            case 1:
                lines.insert(place, rng.choice(lines))
            case 2:
                lines[place] = ""
            case 3 if lines[place]:
                at = rng.randrange(len(lines[place]))
                lines[place] = lines[place][:at] + chr(rng.randrange(32, 0x2100)) + lines[place][at + 1 :]
            case 4:
                other = rng.randrange(len(lines))
                lines[place], lines[other] = lines[other], lines[place]
            case 5 if equals:
                lines[place] = f"{key}= {rng.uniform(-1, 1) * 10 ** rng.uniform(-30, 30)!r}"
    return "\n".join(lines)


def judged(seed: int) -> str:
    """What became of one file."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", InputRemark)
        try:
            natural_frequencies(loads(mutated(seed), source="mutated.toml"))
        except TrunnionError as error:
            assert all(len(line) < 600 for line in str(error).splitlines())
            return "refused"
    return "computed"


HUNDREDS = [*range(2), *(pytest.param(k, marks=pytest.mark.slow) for k in range(2, 200))]


@pytest.mark.parametrize("hundred", HUNDREDS)
def test_a_hundred_mutated_files(hundred):
    found = set()
    for seed in range(100 * hundred, 100 * hundred + 100):
        try:
            found.add(judged(seed))
        except (Exception, Warning) as error:
            raise AssertionError(f"seed {seed}") from error
    assert found == {"refused", "computed"}
