"""Mutated driveline files: each is read or refused, its frequencies found or refused; nothing else may happen."""

from __future__ import annotations

import random
import warnings

import pytest
from hurry import hurried
from seed_files import texts

from trunnion.driveline.files import loads
from trunnion.driveline.kinds import KINDS
from trunnion.driveline.starter import starter
from trunnion.errors import ComputationError, InputRemark, TrunnionError
from trunnion.floquet.stability.stability import stability
from trunnion.modes.natural_frequencies import natural_frequencies

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
    lines = rng.choice(texts()).splitlines()
    for _ in range(rng.choice((1, 1, 1, 2, 4))):
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
    """What became of one file: refused by all, or computed by one analysis or two."""
    done = "refused"
    with warnings.catch_warnings(), hurried():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", InputRemark)
        try:
            line = loads(mutated(seed), source="mutated.toml")
            assert str(natural_frequencies(line))
            done = "frequencies"
            if seed % 4 == 0:
                stability(line, speed=None if line.operation and line.operation.speed else 150.0)
                done = "stability"
        except TrunnionError as error:
            assert all(len(row) < 600 for row in str(error).splitlines())
    return done


def test_every_kind_of_element_is_mutated():
    whole = "".join(texts())
    assert [name for name in KINDS if f'type = "{name}"' not in whole] == []


def test_a_period_that_holds_too_much_is_refused_before_it_is_stepped_through():
    line = loads(starter("two-shaft")).replace("Shaft 1", stiffness=1e30)
    with pytest.raises(ComputationError, match="the fastest motion needs .* steps a period"):
        stability(line)


def test_a_response_that_holds_too_much_takes_no_verdict_away():
    line = loads(starter("two-shaft")).replace("load", excitation=[{"frequency": 1e18, "amplitude": 1.0}])
    found = stability(line)
    assert str(found.verdict) == "stable" and found.response is None
    assert "without the forced response: the forced response needs" in str(found)
    assert any("Without the forced response" in finding.sentence for finding in found.findings)


HUNDREDS = [*range(2), *(pytest.param(k, marks=pytest.mark.slow) for k in range(2, 200))]


@pytest.mark.parametrize("hundred", HUNDREDS)
def test_a_hundred_mutated_files(hundred):
    found = set()
    for seed in range(100 * hundred, 100 * hundred + 100):
        try:
            found.add(judged(seed))
        except (Exception, Warning) as error:
            raise AssertionError(f"seed {seed}") from error
    assert found == {"refused", "frequencies", "stability"}
