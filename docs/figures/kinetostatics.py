"""Draws the pictures of docs/kinetostatics.md.

PYTHONPATH=src python docs/figures/kinetostatics.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Arc

import trunnion as tn
from trunnion.pictures.draw_matplotlib import SMALL, TEXT, TITLE, draw, save
from trunnion.pictures.kinetostatics import paper
from trunnion.pictures.looks import COLOURS, FAINT, INK

IMAGES = Path(__file__).parents[1] / "images"
FRONT, REAR, PLANE = COLOURS[0], COLOURS[1], FAINT


def conventions() -> Figure:
    """Left: a joint from the side. Right: the shaft between two joints, seen along it from the drive."""
    figure = Figure(figsize=(10.5, 4.3), layout="constrained")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2, width_ratios=[1, 1.25])
    side_view(left)
    end_view(right)
    for axes in (left, right):
        axes.set_aspect("equal")
        axes.set_axis_off()
    return figure


def side_view(axes) -> None:
    beta = np.radians(32)
    e, u = np.array([1.0, 0.0]), np.array([0.0, -1.0])
    e2, u2 = np.cos(beta) * e + np.sin(beta) * u, -np.sin(beta) * e + np.cos(beta) * u
    axes.plot(*np.stack([-1.5 * e, 0 * e], axis=1), color=FRONT, linewidth=5, solid_capstyle="butt")
    axes.plot(*np.stack([0 * e, 1.55 * e2], axis=1), color=REAR, linewidth=5, solid_capstyle="butt")
    axes.plot([0, 1.45], [0, 0], color=PLANE, linewidth=1, linestyle=(0, (5, 3)))
    axes.add_patch(Arc((0, 0), 2.1, 2.1, theta1=-32, theta2=0, color=INK, linewidth=1.2))
    axes.text(1.18, -0.3, "β", fontsize=TITLE, color=INK, ha="center", va="center")
    vector(axes, -1.15 * e, 0.55 * u, "u", FRONT, (0.12, 0))
    vector(axes, -1.15 * e, 0.55 * e, "e", FRONT, (0, 0.13))
    vector(axes, 1.0 * e2, 0.55 * u2, "u′", REAR, (0.0, -0.12))
    vector(axes, 1.0 * e2, 0.5 * e2, "e′", REAR, (0.02, 0.14))
    axes.plot([-1.15], [0], marker="o", markersize=11, markerfacecolor="white", markeredgecolor=INK)
    axes.plot([-1.15], [0], marker="x", markersize=6, color=INK)
    axes.text(-1.15, 0.2, "v = e × u, away from you", fontsize=SMALL, color=INK, ha="center", va="bottom")
    axes.plot([0], [0], marker="o", markersize=8, color=INK)
    axes.text(-1.5, -0.2, "drive →", fontsize=SMALL, color=FAINT, ha="center")
    axes.text(1.45, -1.12, "→  load", fontsize=SMALL, color=FAINT, ha="center")
    axes.set_xlim(-1.8, 1.75)
    axes.set_ylim(-1.25, 0.6)
    axes.set_title("joint plane in the paper", fontsize=TEXT, color=INK)


def end_view(axes) -> None:
    """Looking from the drive, a shaft that turns right-handed about its direction turns clockwise."""
    start = 90.0

    def ray(degrees, length):
        a = np.radians(start - degrees)
        return length * np.array([np.cos(a), np.sin(a)])

    circle = np.stack([ray(x, 0.62) for x in np.linspace(0, 360, 200)])
    axes.plot(*circle.T, color=INK, linewidth=1.2)
    for degrees, name in ((0, "plane of joint 1"), (40, "plane of joint 2")):
        axes.plot(*np.stack([ray(degrees, -1.15), ray(degrees, 1.15)], axis=1), color=PLANE, linestyle=(0, (5, 3)))
        axes.text(*ray(degrees, 1.3), name, fontsize=SMALL, color=PLANE, ha="center", va="center")
    psi, nu = 20.0, 100.0
    fork(axes, ray, psi + 90, FRONT)
    fork(axes, ray, psi + 90 + nu, REAR)
    axes.text(0.95, -0.26, "fork of joint 1\n(its output fork)", fontsize=SMALL, color=FRONT, va="center")
    axes.text(-0.72, -0.98, "fork of joint 2\n(its input fork)", fontsize=SMALL, color=REAR, ha="right", va="center")
    span(axes, ray, 0, psi + 90, 0.34, "ψ₁ + 90°", 62)
    span(axes, ray, psi + 90, psi + 90 + nu, 0.42, "ν", 165)
    span(axes, ray, 0, 40, 1.0, "ϑ", 20)
    span(axes, ray, 40, psi + 90 + nu, 0.82, "χ₂", 150)
    axes.set_xlim(-1.6, 2.1)
    axes.set_ylim(-1.3, 1.45)
    axes.set_title("shaft between two joints, seen from the drive: turns clockwise", fontsize=TEXT, color=INK)


def vector(axes, start, along, name, colour, shift) -> None:
    axes.annotate(
        "",
        start + along,
        start,
        arrowprops={"arrowstyle": "-|>", "color": INK, "linewidth": 1.4, "shrinkA": 0, "shrinkB": 0},
    )
    axes.text(*(start + along + shift), name, fontsize=TEXT, color=colour, ha="center", va="center")


def fork(axes, ray, degrees, colour) -> None:
    axes.plot(*np.stack([ray(degrees, -0.62), ray(degrees, 0.62)], axis=1), color=colour, linewidth=3)
    axes.plot(*ray(degrees, 0.62), marker="o", markersize=7, color=colour)


def span(axes, ray, low, high, radius, name, at) -> None:
    arc = np.stack([ray(x, radius) for x in np.linspace(low, high, 60)])
    axes.plot(*arc.T, color=INK, linewidth=1.1)
    axes.annotate(
        "",
        arc[-1],
        arc[-4],
        arrowprops={"arrowstyle": "-|>", "color": INK, "linewidth": 1.1, "shrinkA": 0, "shrinkB": 0},
    )
    background = {"facecolor": "#ffffff", "edgecolor": "none", "pad": 1.0}
    axes.text(*ray(at, radius), name, fontsize=TEXT, color=INK, ha="center", va="center", bbox=background)


if __name__ == "__main__":
    save(conventions(), IMAGES / "kinetostatics-conventions.png")
    line = tn.catalogue("bicardan-elastic")
    save(draw(paper(tn.kinetostatics(line, rigid=False))).figure.figure, IMAGES / "bicardan-elastic-figure-3.png")
    save(draw(paper(tn.kinetostatics(line))).figure.figure, IMAGES / "bicardan-elastic-figure-4.png")
