"""10⁵ boxes of small lines, 10³ of real ones and 600 of pairs about their own motion, attacked at corners and inside:
how many were proved, none falsely.

Run from the repository: ``PYTHONPATH=src:tests python tests/attack_certificates.py LOG --seconds 1500``. Parts are
numbered; each draws its line and boxes from its own number, and adds one row to LOG. Run again with the same LOG it
goes on with the parts that are not there. A box that is proved and holds an unstable line ends it with its part.
"""

from __future__ import annotations

import argparse
import json
import time
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from oracles.attacked_boxes import Attack, attack, check, real_shape
from oracles.attacked_own_boxes import attack_own

import trunnion as tn

SMALL, SMALL_BOXES, SMALL_POINTS = 500, 200, 12
REAL, REAL_BOXES = 100, 10
OWN, OWN_BOXES, OWN_POINTS = 100, 6, 6
AS_REAL = Attack(points=12, least=-2.0, widest=-2.5, proved_alone=True)
EXAMPLES = Path(__file__).parents[1] / "examples"
NAMES = ("truck", "rolling-mill-spindle", "steering-column", "pto-shaft")


def parts() -> Iterator[tuple[str, int]]:
    """Kind and number of every part; five small ones between two real ones, and one about its own motion."""
    for k in range(REAL):
        yield "real", k
        yield "own", k
        for small in range(5 * k, 5 * k + 5):
            yield "small", small


def run(kind: str, number: int) -> tuple[int, int, int]:
    """Boxes, how many were proved, and how many hold an unstable line."""
    if kind == "small":
        return SMALL_BOXES, *check(100_000 + number, SMALL_BOXES, 1 + number % 3, number % 2 == 0, SMALL_POINTS)
    if kind == "own":
        return OWN_BOXES, attack_own(np.random.default_rng(300_000 + number), OWN_BOXES, OWN_POINTS, str(number)), 0
    rng = np.random.default_rng(200_000 + number)
    shape = real_shape(rng, tn.load(EXAMPLES / f"{NAMES[number % len(NAMES)]}.toml"))
    return REAL_BOXES, *attack(rng, shape, REAL_BOXES, AS_REAL, f"real {number}")


def totals(rows: list[dict[str, object]]) -> str:
    """What all rows come to."""
    said = []
    for kind, whole in (("small", SMALL * SMALL_BOXES), ("real", REAL * REAL_BOXES), ("own", OWN * OWN_BOXES)):
        own = np.array([row["found"] for row in rows if row["kind"] == kind]).reshape(-1, 3).astype(int).sum(axis=0)
        said.append(
            f"{kind} lines: {own[0]} of {whole} boxes, {own[1]} proved, {own[2]} attacked ones hold an unstable line"
        )
    return "; ".join(said) + "; none proved falsely"


def main() -> None:
    """Go on until all parts are done or the time is up."""
    read = argparse.ArgumentParser()
    read.add_argument("log", type=Path)
    read.add_argument("--seconds", type=float, default=np.inf, help="processor time")
    given = read.parse_args()
    warnings.simplefilter("ignore")
    rows = [json.loads(one) for one in given.log.read_text().splitlines()] if given.log.exists() else []
    done = {(row["kind"], row["number"]) for row in rows}
    for kind, number in parts():
        if (kind, number) in done:
            continue
        if time.process_time() > given.seconds:
            break
        began = time.process_time()
        rows.append({"kind": kind, "number": number, "found": [int(one) for one in run(kind, number)]})
        rows[-1]["seconds"] = round(time.process_time() - began, 1)
        with given.log.open("a") as file:
            file.write(json.dumps(rows[-1]) + "\n")
    print(totals(rows))


if __name__ == "__main__":
    main()
