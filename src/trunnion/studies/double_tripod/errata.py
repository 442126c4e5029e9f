"""S4's errata: what is printed, what is so, and how much it matters."""

from __future__ import annotations

import numpy as np

from trunnion.studies.double_tripod.published import WORST_ANGLE, DoubleTripod
from trunnion.studies.result import Comparison, Row


def errata() -> Comparison:
    """Every difference found between the paper's formulas and its numbers, or mechanics."""
    shaft, mended = DoubleTripod(), DoubleTripod(steiner="mended")
    one, three = shaft.element("input"), shaft.element("output")
    omega = three.natural_frequency(WORST_ANGLE)
    polar = np.pi * one.d_A**4 / 32
    lowered = [mended.element(e).natural_frequency(WORST_ANGLE) for e in ("input", "output")]
    own = "Appendix B by its own data"
    return Comparison(
        "Errata",
        (
            Row("χ_n of section 6, DIE1", "0.0026", f"{one.nonuniformity(WORST_ANGLE):.3g}", own),
            Row("χ_n of section 6, DOE3", "0.0027", f"{three.nonuniformity(WORST_ANGLE):.3g}", own),
            Row("(A14), (A15)", "½(J₁+J₂) ρL_B sin²β/Ī", "times χ_nB", "else I = Ī(1 + χ_n cos 2φ) is not (A2)"),
            Row("(A2), (A4) Steiner terms", "S_B d_C²", "times sin²β",
                f"at β = 0 J_A is {one.axle(0.0) / polar:.0f} times the polar moment of the axle; with sin²β "
                f"Ω₁ = {lowered[0]:.0f} and Ω₃ = {lowered[1]:.0f} rad/s at 9°"),
            Row("Ω₃(9°)", "8767 rad/s, 2792 Hz", f"{omega:.1f} rad/s, {omega / np.pi:.1f} Hz", "the two differ"),
            Row("(4), (A13)", "πd⁴/32 and πd⁴/64", "πd⁴/32", "polar moment of the midshaft"),
            Row("(A9)", "sin²β₁", "sin²β₂", "element 3 stands at β₂"),
            Row("(19), (21)", "(−1)^k, + GJ sin", "(−1)^k, − GJ sin", "from (17) at x = L"),
            Row("(30)", "cos Θ₁ in one factor", "cos Θ₃", ""),
            Row("(31)–(36)", "log₁₀, restarted perturbations", "natural log, variational equations",
                "not Lyapunov exponents: positive for a decaying oscillator, and growing with N"),
            Row("(38), (39)", "criteria of chaos", "hold of themselves",
                "a forced system has an exponent 0, a damped one a negative sum: they cannot discriminate"),
        ),
    )  # fmt: skip
