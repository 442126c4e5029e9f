"""S2 computed anew: Figures 3 and 4, errata, conclusions.

Săulescu, Bercan and Hudan, Dynamic modeling of cardan transmissions in modular variant, part III, 2007.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.papers.bicardan_elastic.conclusions import Turns, change, conclusions
from trunnion.papers.bicardan_elastic.errata import errata
from trunnion.papers.bicardan_elastic.published import bicardan_elastic as published
from trunnion.papers.shared.result import ComparisonTable, PaperFigure, Reproduction, TableRow
from trunnion.pictures.kinetostatics import paper
from trunnion.response.kinetostatics.measures import extremes, largest
from trunnion.response.kinetostatics.result import Kinetostatics
from trunnion.response.kinetostatics.turn import kinetostatics

NAME = "bicardan-elastic"
SOURCE = "Săulescu, Bercan and Hudan, Dynamic modeling of cardan transmissions in modular variant, part III, 2007"


def bicardan_elastic(points: int, report_progress: Callable[[float], None]) -> Reproduction:
    """Reproduce S2 on ``points`` angles a turn."""

    def turn(rigid: bool = False, **changes: Any) -> Kinetostatics:
        line: Driveline = published(**changes)
        return kinetostatics(line, points=max(points, 360), rigid=rigid)

    elastic, rigid = turn(), turn(rigid=True)
    stiff = turn(printed_stiffness=True)
    even, even_rigid = turn(homokinetic=True), turn(rigid=True, homokinetic=True)
    units = {
        "c₁₂ in N mm/rad": Turns(elastic, rigid, even, even_rigid),
        "c₁₂ in N m/rad": Turns(stiff, rigid, turn(homokinetic=True, printed_stiffness=True), even_rigid),
    }
    worst = turn(rigid=True, plane_angle=1.5 * np.pi)
    report_progress(0.8)
    shown = "1 rad/s, 150 N m, ν₁₂ = 180°, β₁₂ = 266.4°. "
    figures = (
        PaperFigure("3", "Angles, speeds, accelerations and torques, intermediate shaft elastic",
                    shown + "Stiffness in N mm/rad.", partial(paper, elastic)),
        PaperFigure("4", "Angles, speeds, accelerations and torques, intermediate shaft rigid",
                    shown + "Alike to the width of a line: what differs stands in the table.",
                    partial(paper, rigid)),
    )  # fmt: skip
    return Reproduction(
        name=NAME, title="Two Hooke's joints and an elastic shaft between them (S2)",
        source=SOURCE,
        figures=figures, tables=(_numbers(rigid), _differences(elastic, rigid, stiff)),
        errata=errata(elastic, rigid, worst, even_rigid), evidence=(), conclusions=conclusions(units),
        figures_note="Torques are those passed on to the load. The paper draws its curves without numbers.",
        assumed=_assumed(elastic, stiff),
    )  # fmt: skip


def _assumed(elastic: Kinetostatics, stiff: Kinetostatics) -> ComparisonTable:
    """What the text leaves open, and what another value changes."""
    twists = [float(largest(k.twist[1])) for k in (elastic, stiff)]
    return ComparisonTable(
        "What is assumed",
        (
            TableRow("unit of c₁₂", "N m/rad", "N mm/rad",
                f"no diameters to check it by; the largest twist is {twists[0]:.4g} rad, in the printed unit "
                f"{twists[1]:.4g} rad; every conclusion is judged in both"),
            TableRow("sense of ν₁₂, β₁₂", "(2)", "both against the rotation",
                "the other sense mirrors the curves: the extremes of 0.7801 and 1.2819 stay"),
            TableRow("J₁, J₁₂, J₃", "0", "0", "as stated: inertia torques of 0"),
        ),
    )  # fmt: skip


def _numbers(rigid: Kinetostatics) -> ComparisonTable:
    def row(words: str, values: Array, unit: str) -> TableRow:
        low, high = extremes(values)
        return TableRow(words, "Figure 4", f"{low:.5g} … {high:.5g} {unit}")

    return ComparisonTable(
        "Extremes over a turn, rigid",
        (
            row("angle, output − input", np.degrees(rigid.output_angle - rigid.mean_ratio * rigid.input_angle), "°"),
            row("speed of the intermediate shaft", rigid.speed[1], "rad/s"),
            row("speed of the output", rigid.output_speed, "rad/s"),
            row("acceleration of the output", rigid.output_acceleration, "rad/s²"),
            row("torque of the drive", rigid.drive_torque, "N m"),
            *(
                TableRow(f"tilt θ of the cross in fork {fork}", "(4), not drawn", f"{low:.5g} … {high:.5g} °")
                for fork, low, high in zip(rigid.forks, *extremes(np.degrees(rigid.cross_tilt)), strict=True)
            ),
        ),
    )


def _differences(elastic: Kinetostatics, rigid: Kinetostatics, stiff: Kinetostatics) -> ComparisonTable:
    """What the elasticity changes, absolutely and relative to the fluctuation over a turn."""
    rows = []
    for words, unit in (("speed", "rad/s"), ("acceleration", "rad/s²"), ("torque", "N m")):
        mended, printed = (change(one, rigid, words) for one in (elastic, stiff))
        rows.append(
            TableRow(
                f"{words}, elastic − rigid", "Figure 3 against 4", f"{mended[0]:.2g} {unit}",
                f"{mended[1]:.1e} of its fluctuation over a turn; with c₁₂ in the printed unit {printed[0]:.1g} {unit}",
            )
        )  # fmt: skip
    return ComparisonTable("What the elasticity of the shaft changes", tuple(rows))
