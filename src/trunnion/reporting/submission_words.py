"""Sentences of the report that is handed in which depend on what the line has: only what is true of it is said."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.driveline.gears import GearPair
from trunnion.driveline.joints import Joint
from trunnion.driveline.shafts import Shaft
from trunnion.driveline.silent_cylinders import SILENT
from trunnion.modes.mass_elastic import masses, springs
from trunnion.reporting.submission_contents import SubmissionContents
from trunnion.reporting.tables import four
from trunnion.results.words import HERTZ

CERTAINTIES = {
    "yours": "“yours” is the description or a maker's sheet",
    "derived": "“derived” follows from the equations of motion",
    "typical": "“typical” is usual practice",
    "known": "“known” is quoted from practice: check it against your edition of the rule",
}
"""What stands in brackets behind a source, the last being what a reader has to do."""


def assumptions(contents: SubmissionContents) -> list[str]:
    """What the model takes for granted, as far as this line has it."""
    elements = [element for _, element in contents.seen.line.parts]
    heavy = any(isinstance(one, Shaft) and one.moment_of_inertia for one in elements)
    tubes = " (where a density is stated, half of a shaft's inertia at each of its ends)" if heavy else ""
    joints = "; joints without friction and play of their own" if any(isinstance(e, Joint) for e in elements) else ""
    gears = any(isinstance(e, GearPair) for e in elements)
    contact = "; meshes stay in contact where their check says so" if gears else ""
    return [
        f"Torsion only: rigid inertias, elastic shafts without mass{tubes}{joints}.",
        f"Linear vibration about the steady mean motion{contact}.",
        "Torques by order act at the mean angle of their inertia, which has the mean twist of the line in it.",
        f"Damping of shafts, couplings and dampers: {'; '.join(_damping(contents)) or 'none is stated'}.",
        *_certainties(contents),
    ]


def _damping(contents: SubmissionContents) -> Iterator[str]:
    """How the springs are damped."""
    line, rows = contents.seen.line, springs(contents.seen.assembly)
    if line.damping_ratio is not None:
        at = line.damping_ratio_frequency
        where = "at the lowest elastic mode" if at is None else f"at {HERTZ.speed(at)}"
        yield f"the damping ratio of the whole line, {four(line.damping_ratio)}, holds {where}"
    elif any(row.damping and np.isnan(row.loss_frequency) for row in rows):
        yield "viscous as stated"
    if any(np.isfinite(row.loss_frequency) for row in rows):
        yield "a loss factor stated at a frequency as the viscous damping that has it there"
    if any(row.loss for row in rows):
        yield "a loss factor stated without a frequency alike at all frequencies"


def _certainties(contents: SubmissionContents) -> Iterator[str]:
    used = {check.rule.certainty for check in contents.seen.assessment.checks}
    said = [words for certainty, words in CERTAINTIES.items() if certainty in used]
    if said:
        yield f"Of the sources of rules, {'; '.join(said)}."


def malfunction(contents: SubmissionContents) -> str:
    """What a cylinder out of work is taken to do."""
    compressing = any(one.how == SILENT["cut_out"] for one in contents.misfiring)
    left = "misfiring, with the gas torque of compression left; cut out, with none left" if compressing else (
        "misfiring, with no gas torque left"
    )  # fmt: skip
    several = ", under every load case" if len(contents.cases) > 1 else ""
    return (
        f"One cylinder at a time, its masses moving: {left}. Each is searched by itself over the whole range{several}."
    )


def ties(contents: SubmissionContents) -> list[str]:
    """How a mass turns that a differential drives by two others."""
    return [
        f"{row.name} turns by {_sum(row.sum_of)}, so its row is no unknown of its own."
        for row in masses(contents.seen.assembly)
        if row.sum_of
    ]


def _sum(shares: tuple[tuple[str, float], ...]) -> str:
    first, *others = (f"{four(share)} × {name}" for name, share in shares)
    return first + "".join(f" − {one[1:]}" if one.startswith("−") else f" + {one}" for one in others)
