"""S2 computed anew: Figures 3 and 4, errata, conclusions.

Săulescu, Bercan and Hudan, Dynamic modeling of cardan transmissions in modular variant, part III, 2007.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from trunnion.analyses.kinetostatics.result import Kinetostatics
from trunnion.analyses.kinetostatics.turn import kinetostatics
from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.plots.kinetostatics import draw_paper
from trunnion.studies.bicardan_elastic.conclusions import change, conclusions
from trunnion.studies.bicardan_elastic.errata import errata
from trunnion.studies.bicardan_elastic.published import bicardan_elastic as published
from trunnion.studies.result import Comparison, PaperFigure, Reproduction, Row

NAME = "bicardan-elastic"


def bicardan_elastic(points: int, tell: Callable[[float], None]) -> Reproduction:
    """Reproduce S2 on ``points`` angles a turn."""

    def turn(rigid: bool = False, **changes: Any) -> Kinetostatics:
        line: Driveline = published(**changes)
        return kinetostatics(line, points=max(points, 360), rigid=rigid)

    elastic, rigid = turn(), turn(rigid=True)
    stiff = turn(printed_stiffness=True)
    even, even_rigid = turn(homokinetic=True), turn(rigid=True, homokinetic=True)
    worst = turn(rigid=True, plane_angle=1.5 * np.pi)
    tell(0.8)
    shown = "1 rad/s, 150 N·m, ν₁₂ = 180°, β₁₂ = 266.4°. "
    figures = (
        PaperFigure("3", "Angles, speeds, accelerations and torques, intermediate shaft elastic",
                    shown + "Stiffness in N·mm/rad.", partial(draw_paper, elastic)),
        PaperFigure("4", "Angles, speeds, accelerations and torques, intermediate shaft rigid",
                    shown + "Alike to the width of a line: what differs stands in the table.",
                    partial(draw_paper, rigid)),
    )  # fmt: skip
    return Reproduction(
        NAME,
        "Two Hooke's joints and an elastic shaft between them (S2)",
        "Săulescu, Bercan and Hudan, Dynamic modeling of cardan transmissions in modular variant, part III, 2007",
        figures,
        (_numbers(rigid), _differences(elastic, rigid, stiff)),
        errata(elastic, rigid, worst, even_rigid),
        (),
        conclusions(elastic, rigid, even, even_rigid),
        "Torques are those passed on to the load. The paper draws its curves without numbers.",
    )


def _numbers(rigid: Kinetostatics) -> Comparison:
    def row(words: str, values: Array, unit: str) -> Row:
        return Row(words, "Figure 4", f"{values.min():.4g} … {values.max():.4g} {unit}")

    return Comparison(
        "Extremes over a turn, rigid",
        (
            row("angle, output − input", np.degrees(rigid.output_angle - rigid.mean_ratio * rigid.input_angle), "°"),
            row("speed of the intermediate shaft", rigid.speed[1], "rad/s"),
            row("speed of the output", rigid.output_speed, "rad/s"),
            row("acceleration of the output", rigid.output_acceleration, "rad/s²"),
            row("torque of the drive", rigid.drive_torque, "N·m"),
        ),
    )


def _differences(elastic: Kinetostatics, rigid: Kinetostatics, stiff: Kinetostatics) -> Comparison:
    """What the elasticity changes, absolutely and relative to the fluctuation over a turn."""
    rows = []
    for words, unit in (("speed", "rad/s"), ("acceleration", "rad/s²"), ("torque", "N·m")):
        mended, printed = (change(one, rigid, words) for one in (elastic, stiff))
        rows.append(
            Row(
                f"{words}, elastic − rigid", "Figure 3 against 4", f"{mended[0]:.2g} {unit}",
                f"{mended[1]:.1e} of its fluctuation over a turn; with c₁₂ in the printed unit {printed[0]:.1g} {unit}",
            )
        )  # fmt: skip
    return Comparison("What the elasticity of the shaft changes", tuple(rows))
