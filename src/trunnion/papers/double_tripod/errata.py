"""S4's errata: what is printed, what is so, and how much it matters."""

from __future__ import annotations

import numpy as np

from trunnion.papers.double_tripod.contraction import torque_that_breaks_it
from trunnion.papers.double_tripod.midshaft import midshaft_frequencies, ratio_that_meets
from trunnion.papers.double_tripod.published import WORST_ANGLE, DoubleTripod
from trunnion.papers.shared.result import ComparisonTable, TableRow

TABLE_RIGIDITY = 1.11e4
"""Torsional rigidity [N m/rad] of Tables 1 and 2."""


def errata() -> ComparisonTable:
    """Every difference found between the paper's formulas and its numbers, or mechanics."""
    shaft, mended = DoubleTripod(), DoubleTripod(steiner="mended")
    one, three = shaft.element("input"), shaft.element("output")
    omega = three.natural_frequency(WORST_ANGLE)
    polar = np.pi * one.d_A**4 / 32
    lowered = [mended.element(e).natural_frequency(WORST_ANGLE) for e in ("input", "output")]
    own = "Appendix B by its own data"
    stiff = [part.stiffness(WORST_ANGLE) for part in (one, three)]
    first, second = shaft.midshaft_frequencies(2)
    turning = one.natural_frequency(WORST_ANGLE) / (2 * np.pi)
    near = 100 * (first / turning - 1), 100 * (second / (2 * turning) - 1)
    room = torque_that_breaks_it("input")
    meets = [ratio_that_meets(2, float(part.natural_frequency(WORST_ANGLE)) / np.pi) for part in (one, three)]
    heavy = midshaft_frequencies((1.0, 1.0), 2)
    dropped = TABLE_RIGIDITY * one.joint_amplitude(WORST_ANGLE) / float(stiff[0])
    return ComparisonTable(
        "Errata",
        (
            TableRow("χ_n of section 6, DIE1", "0.0026", f"{one.nonuniformity(WORST_ANGLE):.3g}", own),
            TableRow("χ_n of section 6, DOE3", "0.0027", f"{three.nonuniformity(WORST_ANGLE):.3g}", own),
            TableRow("(A14), (A15)", "½(J₁+J₂) ρL_B sin²β/Ī", "times χ_nB", "else I = Ī(1 + χ_n cos 2φ) is not (A2)"),
            TableRow("(A2), (A4) Steiner terms", "S_B d_C²", "times sin²β",
                f"at β = 0 J_A is {one.axle(0.0) / polar:.0f} times the polar moment of the axle; with sin²β "
                f"Ω₁ = {lowered[0]:.0f} and Ω₃ = {lowered[1]:.0f} rad/s at 9°"),
            TableRow("Ω₃(9°)", "8767 rad/s, 2792 Hz", f"{omega:.1f} rad/s, {omega / np.pi:.1f} Hz", "the two differ"),
            TableRow("(4), (A13)", "πd⁴/32 and πd⁴/64", "πd⁴/32", "polar moment of the midshaft"),
            TableRow("(A9)", "sin²β₁", "sin²β₂", "element 3 stands at β₂"),
            TableRow("(19), (21)", "(−1)^k, + GJ sin", "(−1)^k, − GJ sin", "from (17) at x = L"),
            TableRow("(30)", "cos Θ₁ in one factor", "cos Θ₃", ""),
            TableRow("Tables 1, 2: torsional rigidity", "1.11·10⁴ N m/rad", f"{stiff[0]:.3g}, {stiff[1]:.3g} N m/rad",
                "the k_t of (1), (5) that gives the printed frequencies; whose rigidity the table has it does not say"),
            TableRow("(31)–(36)", "log₁₀, restarted perturbations", "natural log, variational equations",
                "not Lyapunov exponents as the text reads; what the authors computed in fact is not known"),
            TableRow("(38), (39)", "criteria of chaos", "hold of themselves",
                "a forced system has an exponent 0, a damped one a negative sum: they cannot discriminate"),
            TableRow("(17): midshaft", "fixed ends, ν_k = k c/2L", "(r₁ + r₂)x cos x = (r₁r₂x² − 1) sin x, x = ωL/c",
                "by (15), (16), r = I_TJ/(ρJL), of which we have no number; the printed ν_k are of r = 0, free ends. "
                f"Tripods of r = {meets[0]:.3g} bring ν₂ to 2Ω₁/2π, of r = {meets[1]:.3g} to 2Ω₃/2π, of r = 1 to "
                f"{heavy[1]:.0f} Hz and ν₁ to {heavy[0]:.0f} Hz"),
            TableRow("(20), (21): midshaft terms", "dropped in (25), (26), as ν_k is not near",
                f"ν₁, ν₂ {near[0]:.0f} % and {near[1]:.0f} % away for r = 0",
                "ν₁ from Ω₁/2π, ν₂ from 2Ω₁/2π. By (15) these terms are the joint's own torque k_tTJ A φ cos 3φ of the "
                "next row, which has no φ₂: no resonance of the midshaft enlarges it. Taken as free torques in time "
                f"they would have to be {room:.2g} times the motor's mean before the bound below fails"),
            TableRow("(10), (12): tripod terms", "k_tTJ A cos 3φ, dropped in (25)", f"{dropped:.0e} of k_t",
                "with the table's 1.11·10⁴ N m/rad as the joint's k_tTJ; A = 3.65e-5 makes them nothing"),
        ),
    )  # fmt: skip
