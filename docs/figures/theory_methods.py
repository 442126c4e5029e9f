"""Draws the pictures of docs/theory that show methods: charts, continuation, chaos, perturbation.

PYTHONPATH=src python docs/figures/theory_methods.py [charts] [continuation] [chaos] [perturbation]
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from numpy.polynomial import chebyshev

import trunnion as tn
from trunnion.pictures.looks import COLOURS, FAINT, INK

IMAGES = Path(__file__).parents[1] / "images"
UNSTABLE = "#b3332e"


def multipliers(speeds: np.ndarray, angle: float = 0.6) -> np.ndarray:
    """Multipliers (speed, 4) of the two-shaft line by itself, speed for speed."""
    line = tn.catalogue("two-shaft-cardan", angle=angle)
    return np.array([tn.stability(line, float(speed)).multipliers for speed in speeds])


def charts() -> None:
    """Left: moduli over the speed. Middle: e₁ over the speed. Right: how the coefficients of both series fall."""
    figure, (moduli, smooth, series) = plt.subplots(1, 3, figsize=(11, 3.4), layout="constrained")
    low, high = 0.9, 1.35
    speeds = np.linspace(low, high, 400)
    found = multipliers(speeds)
    moduli.plot(speeds, np.sort(np.abs(found), axis=1), ".", ms=2.5, color=COLOURS[0])
    moduli.axhline(1, color=INK, lw=0.8, ls=(0, (5, 3)))
    moduli.set(xlabel="speed Ω", ylabel="moduli |σ| of the multipliers", title="they meet and part: kinks")
    smooth.plot(speeds, found.sum(axis=1).real, color=COLOURS[1])
    smooth.set(xlabel="speed Ω", ylabel="e₁ = σ₁ + σ₂ + σ₃ + σ₄", title="their sum is smooth")
    degree = 47
    node = np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    middle, half = (1 / low + 1 / high) / 2, (1 / low - 1 / high) / 2
    at_nodes = multipliers(1 / (middle + half * node))
    for values, colour, marker, name in (
        (at_nodes.sum(axis=1).real, COLOURS[1], "o", "e₁"),
        (np.abs(at_nodes).max(axis=1), COLOURS[0], "s", "ρ = max |σ|"),
    ):
        size = np.abs(chebyshev.chebfit(node, values, degree))
        series.semilogy(size / size.max(), marker, ms=3.5, color=colour, label=name)
    series.set(xlabel="degree in 1/Ω", ylabel="coefficient over the largest", title="Chebyshev coefficients")
    series.legend(fontsize=9)
    figure.savefig(IMAGES / "theory-charts.png", dpi=110)


def continuation() -> None:
    """Left: a step along the tangent and back onto the curve. Then Duffing's branch, its folds and multipliers."""
    figure, (step, curve, circle) = plt.subplots(
        1, 3, figsize=(11, 3.7), layout="constrained", gridspec_kw={"width_ratios": (1.1, 1.2, 1)}
    )
    x = np.linspace(-1.25, 1.25, 300)
    parameter = -(x**3) + 0.9 * x
    step.plot(parameter, x, color=COLOURS[0], lw=2)
    x0, length = 0.28, 0.62
    z0 = np.array([-(x0**3) + 0.9 * x0, x0])
    tangent = np.array([-3 * x0**2 + 0.9, 1.0])
    tangent /= np.linalg.norm(tangent)
    predicted = z0 + length * tangent
    at = np.linspace(x0, 1.2, 20000)
    on = np.stack([-(at**3) + 0.9 * at, at], axis=1)
    corrected = on[np.abs((on - predicted) @ tangent).argmin()]
    across = np.array([-tangent[1], tangent[0]])
    step.annotate("", predicted, z0, arrowprops={"arrowstyle": "->", "color": COLOURS[1], "lw": 1.8})
    step.plot(*np.stack([predicted - 0.12 * across, predicted + 0.35 * across]).T, color=FAINT, lw=1, ls=(0, (5, 3)))
    step.annotate("", corrected, predicted, arrowprops={"arrowstyle": "->", "color": UNSTABLE, "lw": 1.8})
    step.plot(*np.stack([z0, corrected]).T, "o", ls="", color=INK, ms=6)
    step.text(*(z0 + [-0.04, 0.05]), "z", ha="right", fontsize=11, color=INK)
    step.text(
        *((z0 + predicted) / 2 + [0.05, -0.08]),
        "predicted:\nalong the tangent τ",
        fontsize=8.5,
        color=COLOURS[1],
        va="top",
    )
    step.text(*(corrected + [-0.1, -0.1]), "corrected:\nacross it", ha="right", va="top", fontsize=8.5, color=UNSTABLE)
    for sign in (1, -1):
        fold = sign * np.sqrt(0.3)
        step.plot([-(fold**3) + 0.9 * fold], [fold], "D", ms=6, mfc="white", mec=INK)
    step.text(-0.4, -0.55, "fold", ha="right", fontsize=9, color=INK)
    step.set(xlabel="parameter λ", ylabel="state x", xlim=(-0.85, 1.35), ylim=(-1.25, 1.25))
    branch = tn.periodic_branch(tn.reference_system("duffing"), "frequency", 0.8, 1.6, longest_step=0.004)
    size = branch.amplitude[:, 0]
    stable = np.asarray(branch.stable)
    curve.plot(branch.parameter, np.where(stable, size, np.nan), color=COLOURS[0], lw=2, label="stable")
    curve.plot(branch.parameter, np.where(stable, np.nan, size), color=UNSTABLE, lw=2, ls=(0, (3, 2)), label="unstable")
    for point in branch.folds:
        curve.plot([point.parameter], [point.amplitude[0]], "D", ms=6, mfc="white", mec=INK)
        curve.text(
            point.parameter + 0.012,
            point.amplitude[0],
            f"fold\n{point.parameter:.4f}",
            fontsize=8.5,
            color=INK,
            va="center",
        )
    curve.set(
        xlabel="frequency ω of the force",
        ylabel="amplitude of x",
        xlim=(0.8, 1.6),
        ylim=(0, 3.2),
        title="Duffing's oscillator",
    )
    curve.legend(fontsize=8.5, loc="upper left")
    turn = np.linspace(0, 2 * np.pi, 200)
    circle.plot(np.cos(turn), np.sin(turn), color=FAINT)
    for which, colour, marker in ((stable, COLOURS[0], "o"), (~stable, UNSTABLE, "X")):
        sigma = branch.multipliers[which].ravel()
        circle.plot(sigma.real, sigma.imag, marker, ms=3.5, ls="", color=colour)
    circle.set(xlabel="Re σ", ylabel="Im σ", aspect="equal", title="its multipliers")
    figure.savefig(IMAGES / "theory-continuation.png", dpi=110)


def chaos() -> None:
    """Left: two neighbours part. Middle: the mean growth over the length. Right: walks of the 0–1 test."""
    figure, (part, settle, walk) = plt.subplots(1, 3, figsize=(11, 3.5), layout="constrained")
    ueda, duffing = tn.reference_system("ueda"), tn.reference_system("duffing")
    start = tn.poincare_map(ueda, 200).points[-1]
    for system, state, colour, name in (
        (ueda, start, UNSTABLE, "Ueda (chaotic)"),
        (duffing, tn.poincare_map(duffing, 200).points[-1], COLOURS[0], "Duffing (periodic)"),
    ):
        one, other = (tn.simulate(system, periods=40, start=state + [d, 0.0], tolerance=1e-12) for d in (0.0, 1e-8))
        time = np.linspace(0, 40 * system.forcing_period, 900)
        apart = np.linalg.norm(one.at(time) - other.at(time), axis=-1)
        part.semilogy(time / system.forcing_period, apart, color=colour, lw=1.2, label=name)
    line = np.array([0.0, 24.0])
    part.semilogy(
        line, 3e-8 * np.exp(0.103 * 2 * np.pi * line), color=INK, lw=1, ls=(0, (5, 3)), label="slope 0.103 1/s"
    )
    part.set(xlabel="forcing periods", ylabel="distance of two motions", ylim=(1e-12, 1e5))
    part.legend(fontsize=8, loc="upper left")
    spectrum = tn.lyapunov_spectrum(ueda, periods=8000, starts=1)
    growth = spectrum.runs[0].growth
    count = np.arange(1, len(growth) + 1)[:, None] * spectrum.interval
    mean = np.cumsum(growth, axis=0) / count
    for k, colour in ((0, UNSTABLE), (1, COLOURS[0])):
        settle.semilogx(np.arange(1, len(growth) + 1), mean[:, k], color=colour, lw=1.2, label=f"L{'₁₂'[k]}")
        settle.axhspan(
            spectrum.exponents[k] - spectrum.half_width[k], spectrum.exponents[k] + spectrum.half_width[k],
            color=colour, alpha=0.25,
        )  # fmt: skip
    settle.axhline(0, color=INK, lw=0.7)
    settle.set(
        xlabel="forcing periods", ylabel="mean growth [1/s]", title="Ueda: exponents, with intervals", ylim=(-0.4, 0.4)
    )
    settle.legend(fontsize=9)
    c, points = 1.1, 2000
    for series, colour, name in (
        (tn.poincare_map(ueda, points).points[:, 0], UNSTABLE, "Ueda: it wanders off"),
        (np.sin(np.arange(points) * 1.0), COLOURS[0], "quasi-periodic: it stays"),
    ):
        place = np.cumsum(series * np.exp(1j * c * np.arange(1, points + 1)))
        walk.plot(place.real, place.imag, color=colour, lw=0.8, label=name, zorder=3 if "stays" in name else 2)
    walk.set(xlabel="p", ylabel="q", title="0–1 test, one frequency c", aspect="equal")
    walk.set_xlim(-22, 22)
    walk.legend(fontsize=8, loc="upper left", bbox_to_anchor=(0.0, 1.0))
    walk.set_ylim(-11, 40)
    figure.savefig(IMAGES / "theory-chaos.png", dpi=110)


def perturbation() -> None:
    """Left: amplitude A, mean and phase β. Middle: the force and cubics fitted to it. Right: the responses."""
    figure, (letters, force, response) = plt.subplots(1, 3, figsize=(11, 3.5), layout="constrained")
    paper = tn.catalogue("gear-rattle")
    turn = np.linspace(0, 4 * np.pi, 400)
    amplitude, beta, mean = 1.0, 0.9, 0.35
    letters.plot(turn, np.cos(turn), color=FAINT, lw=1.5, ls=(0, (5, 3)), label="force: cos ωt")
    letters.plot(turn, mean + amplitude * np.cos(turn - beta), color=COLOURS[0], lw=2, label="u = ū + A cos(ωt − β)")
    letters.axhline(mean, color=FAINT, lw=0.8)
    letters.annotate(
        "",
        (2 * np.pi + beta, mean + amplitude),
        (2 * np.pi + beta, mean),
        arrowprops={"arrowstyle": "<->", "color": INK},
    )
    letters.text(2 * np.pi + beta + 0.15, mean + 0.4, "A", color=INK, fontsize=11)
    letters.annotate(
        "",
        (2 * np.pi + beta, -1.2),
        (2 * np.pi, -1.2),
        arrowprops={"arrowstyle": "<->", "color": INK, "shrinkA": 0, "shrinkB": 0},
    )
    letters.plot([2 * np.pi] * 2, [-1.3, 1.0], color=FAINT, lw=0.7)
    letters.plot([2 * np.pi + beta] * 2, [-1.3, mean], color=FAINT, lw=0.7)
    letters.text(2 * np.pi + beta / 2, -1.28, "β", color=INK, fontsize=11, ha="center", va="top")
    letters.text(0.1, mean + 0.05, "ū", color=INK, fontsize=11)
    letters.set(xlabel="ωt", xticks=(0, 2 * np.pi, 4 * np.pi), xticklabels=("0", "2π", "4π"), ylim=(-1.75, 2.3))
    letters.legend(fontsize=8.5, loc="upper right")
    gap = tn.deg(10)
    u = np.linspace(-6 * gap, 6 * gap, 601)
    force.plot(u / gap, paper.restoring(u) / gap, color=INK, lw=2, label="piecewise force")
    dashes = ((0, (1, 1)), (0, (4, 2)), (0, (6, 2, 1, 2)))
    for reach, colour, dash in zip((3, 5, 8), COLOURS, dashes, strict=False):
        flow = tn.multiple_scales(paper, fit_range=reach * gap)
        force.plot(
            u / gap,
            (flow.fit.linear * u + flow.fit.cubic * u**3) / gap,
            color=colour,
            ls=dash,
            label=f"cubic over ±{reach} b",
        )
        found = flow.response(0.3, 1.3)
        response.plot(found.frequency, found.amplitude, color=colour, ls=dash, label=f"cubic over ±{reach} b")
    force.set(xlabel="u / b", ylabel="force / (k b)", ylim=(-7, 7))
    force.legend(fontsize=8)
    exact = tn.frequency_response(paper, 0.3, 1.3)
    response.plot(exact.frequency, exact.half_peak_to_peak, color=INK, lw=2, label="exact", zorder=1)
    best = tn.DescribingFunction(paper).response(0.3, 1.3)
    response.plot(best.frequency, best.amplitude, color="#d0602f", lw=1.3, label="describing function")
    response.set(xlabel="frequency ω", ylabel="half peak to peak of u [rad]", ylim=(0, 1.0))
    response.legend(fontsize=7.5, loc="upper left")
    figure.savefig(IMAGES / "theory-perturbation.png", dpi=110)


if __name__ == "__main__":
    for name in sys.argv[1:] or ("charts", "continuation", "chaos", "perturbation"):
        {"charts": charts, "continuation": continuation, "chaos": chaos, "perturbation": perturbation}[name]()
