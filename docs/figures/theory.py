"""Draws the pictures of docs/theory.

PYTHONPATH=src python docs/figures/theory.py
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Arc, Circle, Rectangle

import trunnion as tn
from trunnion.pictures.looks import COLOURS, FAINT, INK

IMAGES = Path(__file__).parents[1] / "images"


def joint() -> None:
    """Left: χ and ψ seen along each shaft. Right: lead and speed ratio over a turn."""
    figure, (ends, lead, ratio) = plt.subplots(1, 3, figsize=(11, 3.6), layout="constrained")
    beta, chi = np.radians(35), np.radians(40)
    psi = np.arctan2(np.sin(chi), np.cos(chi) * np.cos(beta))
    for x, angle, letter, colour, title in (
        (0.0, chi, "χ", COLOURS[0], "input shaft,\nseen from the drive"),
        (2.9, psi, "ψ", COLOURS[1], "output shaft,\nseen from the drive"),
    ):
        ends.add_patch(Circle((x, 0), 1.0, fill=False, ec=FAINT))
        ends.plot([x, x], [-1.25, 1.25], color=FAINT, ls=(0, (5, 3)))
        tip = np.array([np.sin(angle), np.cos(angle)])
        if letter == "ψ":  # its fork stands a quarter turn from the angle that it counts
            ends.plot([x - tip[1], x + tip[1]], [tip[0], -tip[0]], color=colour, lw=5, solid_capstyle="butt")
            ends.plot([x, x + tip[0]], [0, tip[1]], color=colour, lw=1.2, ls=":")
        else:
            ends.plot([x - tip[0], x + tip[0]], [-tip[1], tip[1]], color=colour, lw=5, solid_capstyle="butt")
        ends.add_patch(Arc((x, 0), 1.3, 1.3, theta1=90 - np.degrees(angle), theta2=90, color=INK, lw=1.3))
        middle = angle / 2
        ends.text(
            x + 0.82 * np.sin(middle), 0.82 * np.cos(middle), letter, color=INK, fontsize=13, ha="center", va="center"
        )
        ends.text(x, -1.42, title, color=INK, fontsize=9, ha="center", va="top")
    ends.text(1.45, 1.32, "dashed: joint plane; thick: fork", color=INK, fontsize=9, ha="center", va="bottom")
    ends.set(xlim=(-1.4, 4.3), ylim=(-2.3, 1.75), aspect="equal")
    ends.set_axis_off()
    turn = np.linspace(0, 2 * np.pi, 721)
    for degrees, colour in ((10, COLOURS[0]), (20, COLOURS[1]), (30, COLOURS[2])):
        b = np.radians(degrees)
        ahead = np.unwrap(np.arctan2(np.sin(turn), np.cos(turn) * np.cos(b))) - turn
        eta = np.cos(b) / (1 - np.sin(b) ** 2 * np.cos(turn) ** 2)
        lead.plot(np.degrees(turn), np.degrees(ahead), color=colour, label=f"β = {degrees}°")
        ratio.plot(np.degrees(turn), eta, color=colour)
    lead.set(xlabel="χ [deg]", ylabel="ψ − χ [deg]", xticks=(0, 90, 180, 270, 360))
    ratio.set(xlabel="χ [deg]", ylabel="speed ratio η", xticks=(0, 90, 180, 270, 360))
    lead.legend(fontsize=8, loc="upper right")
    figure.savefig(IMAGES / "theory-joint.png", dpi=110)


def signs() -> None:
    """A line of two disks and a joint with every rotation, twist and torque."""
    figure, axes = plt.subplots(figsize=(9, 2.9), layout="constrained")
    axes.add_patch(Rectangle((0, -0.5), 0.45, 1.0, fc="white", ec=INK, hatch="////"))
    for x, name in ((3.0, "J₁"), (8.0, "J₂")):
        axes.add_patch(Rectangle((x, -0.8), 0.5, 1.6, fc="#9db7c9", ec=INK))
        axes.text(x + 0.25, 0.95, name, ha="center", fontsize=12, color=INK)
    for first, last in ((0.45, 3.0), (3.5, 4.5), (5.3, 8.0)):
        axes.plot([first, last], [0, 0], color=INK, lw=5, solid_capstyle="butt", zorder=0)
    axes.plot([4.5, 4.9, 5.3], [0, 0, 0], color="#d0602f", lw=3)
    axes.plot([4.9], [0], "P", ms=13, mfc="white", mec="#d0602f", mew=2)
    axes.text(4.9, 0.42, "β", ha="center", fontsize=12, color="#d0602f")
    for x, text in ((0.22, "Ω₀t"), (3.25, "φ₁"), (8.25, "φ₂")):
        axes.annotate(
            "", (x + 0.32, -1.05), (x - 0.32, -1.05), arrowprops={"arrowstyle": "->", "color": COLOURS[0], "lw": 1.6}
        )
        axes.text(x, -1.15, text, ha="center", va="top", fontsize=12, color=COLOURS[0])
    for x, text in ((1.7, "θ₁ = φ₁ − Ω₀t"), (6.65, "θ₂ = φ₂ − ψ(φ₁)")):
        axes.text(x, 0.28, text, ha="center", fontsize=11, color=COLOURS[1])
        axes.text(x, -0.3, "T = kθ + cθ̇", ha="center", va="top", fontsize=10.5, color=INK)
    axes.annotate("", (9.0, 0), (9.7, 0), arrowprops={"arrowstyle": "->", "color": COLOURS[2], "lw": 2})
    axes.text(9.35, 0.2, "load > 0\nresists", ha="center", va="bottom", fontsize=10, color=COLOURS[2])
    axes.text(0.22, 0.7, "drive", ha="center", fontsize=10, color=INK)
    axes.set(xlim=(-0.3, 10.1), ylim=(-1.7, 1.4), aspect="equal")
    axes.set_axis_off()
    figure.savefig(IMAGES / "theory-signs.png", dpi=110)


def multipliers() -> None:
    """Multipliers of the two-shaft line in the plane at four speeds, with the name of what they do."""
    figure, row = plt.subplots(1, 4, figsize=(11, 3.1), layout="constrained")
    cases = ((0.5, "stable"), (0.31, "harmonic: +1"), (1.62, "subharmonic: −1"), (1.12, "sum: complex pair"))
    line = tn.catalogue("two-shaft-cardan", angle=0.9)
    for axes, (speed, title) in zip(row, cases, strict=True):
        found = tn.stability(line, speed)
        turn = np.linspace(0, 2 * np.pi, 200)
        axes.plot(np.cos(turn), np.sin(turn), color=FAINT)
        outside = np.abs(found.multipliers) > 1
        for which, marker, colour in ((~outside, "o", COLOURS[0]), (outside, "X", "#b3332e")):
            axes.plot(found.multipliers.real[which], found.multipliers.imag[which], marker, color=colour, ms=8, ls="")
        axes.set(title=f"Ω = {speed}\n{title}", xlim=(-1.8, 1.8), ylim=(-1.5, 1.5), aspect="equal", xlabel="Re σ")
    row[0].set_ylabel("Im σ")
    figure.savefig(IMAGES / "theory-multipliers.png", dpi=110)


def gap() -> None:
    """Force of a gear mesh with play 2b and stiffness ratio α inside."""
    figure, axes = plt.subplots(figsize=(5.4, 3.4), layout="constrained")
    u, b = np.linspace(-3, 3, 601), 1.0
    for alpha, colour in ((0.0, COLOURS[0]), (0.25, COLOURS[1])):
        force = np.where(u > b, u - (1 - alpha) * b, np.where(u < -b, u + (1 - alpha) * b, alpha * u))
        axes.plot(u, force, color=colour, label=f"α = {alpha:g}")
    axes.axvspan(-b, b, color=FAINT, alpha=0.15)
    axes.annotate("", (b, -1.6), (-b, -1.6), arrowprops={"arrowstyle": "<->", "color": INK})
    axes.text(0, -1.5, "play 2b", ha="center", va="bottom", color=INK)
    axes.set(xlabel="u = r₁φ₁ − r₂φ₂ − e(t), over b", ylabel="mesh force over k b")
    axes.legend()
    figure.savefig(IMAGES / "theory-gap.png", dpi=110)


if __name__ == "__main__":
    for draw in (joint, signs, multipliers, gap):
        draw()
