"""S2's conclusions, each against a computed figure."""

from __future__ import annotations

import numpy as np

from trunnion.analyses.kinetostatics.result import Kinetostatics
from trunnion.studies.result import CONFIRMED, CORRECTED, UNDECIDED, Conclusion, rounded

GUIDELINE = 0.0027
"""Irregularity that makers' guidelines allow a line: one joint of 2.98°."""
REDUCED = 0.1
"""Variation over its mean below which a torque counts as nearly constant."""
QUANTITIES = {"speed": "output_speed", "acceleration": "output_acceleration", "torque": "drive_torque"}


def change(one: Kinetostatics, rigid: Kinetostatics, what: str) -> tuple[float, float]:
    """Largest difference over a turn, and the same over half the peak to peak of the rigid line's own fluctuation."""
    a, b = (np.asarray(getattr(k, QUANTITIES[what])) for k in (one, rigid))
    largest = float(np.abs(a - b).max())
    return largest, largest / (float(np.ptp(b)) / 2)


def conclusions(
    elastic: Kinetostatics, rigid: Kinetostatics, even: Kinetostatics, even_rigid: Kinetostatics
) -> tuple[Conclusion, ...]:
    """From the printed phases and from those that cancel, elastic and rigid each."""
    relative = {what: change(elastic, rigid, what)[1] for what in QUANTITIES}
    return (
        _kinematics(relative),
        _torques(elastic, rigid, relative),
        _deviation(even, even_rigid),
        _significance(elastic, rigid, even),
        _constant(elastic),
    )


def _kinematics(relative: dict[str, float]) -> Conclusion:
    more = min(relative["speed"], relative["acceleration"]) > relative["torque"]
    return Conclusion(
        "The elasticity of the shaft influences mainly the kinematics of the transmission.",
        CONFIRMED if more else CORRECTED,
        "In relative terms: elastic minus rigid is "
        + ", ".join(f"{value:.1e} of the fluctuation of the {what}" for what, value in relative.items())
        + ". In absolute terms it is nothing beside what the printed phases do, with c₁₂ in N·mm/rad; in the printed "
        "unit, N·m/rad, it is a thousand times less still.",
    )


def _torques(elastic: Kinetostatics, rigid: Kinetostatics, relative: dict[str, float]) -> Conclusion:
    largest = change(elastic, rigid, "torque")[0]
    share = largest / float(np.abs(rigid.drive_torque).mean())
    return Conclusion(
        "It has a reduced influence on the torques; what was found for rigid shafts stays valid.",
        CONFIRMED if share < 0.01 else CORRECTED,
        f"The torque of the drive changes by {largest:.1e} N·m, {share:.0e} of its mean.",
    )


def _deviation(even: Kinetostatics, even_rigid: Kinetostatics) -> Conclusion:
    return Conclusion(
        "It makes the transmission deviate from homokinetic.",
        CONFIRMED if even.irregularity > 100 * even_rigid.irregularity else CORRECTED,
        f"With phases that cancel (β₁₂ = ν₁₂) the irregularity is {even.irregularity:.1e} elastic and "
        f"{rounded(even_rigid.irregularity)} rigid.",
    )


def _significance(elastic: Kinetostatics, rigid: Kinetostatics, even: Kinetostatics) -> Conclusion:
    shown = abs(elastic.irregularity - rigid.irregularity)
    allowed = 150.0 * GUIDELINE / even.irregularity
    small = max(shown, even.irregularity) < GUIDELINE
    return Conclusion(
        "The deviation can become significant in some cases (Figure 3 b).",
        UNDECIDED if small else CONFIRMED,
        f"Not in the example: elasticity changes its irregularity of {rigid.irregularity:.4f}, which comes from the "
        f"phases, by {shown:.0e}. With phases that cancel it would reach a guideline of {GUIDELINE:g} at about "
        f"{allowed / 1000:.0f} kN·m, or with a shaft so much softer. That hangs on the unit of c₁₂, which is inferred: "
        "in the printed one it would take a thousand times as much.",
    )


def _constant(elastic: Kinetostatics) -> Conclusion:
    assert elastic.constant_twist is not None
    swing = float(elastic.constant_twist.variation[1])
    return Conclusion(
        "The twist ξ varies little about its mean, so that ξ ≈ constant is justified.",
        CORRECTED if swing > REDUCED else CONFIRMED,
        f"It follows the torque in the shaft and swings by ± {100 * swing:.1f} % of its mean. That does no harm: "
        f"taken as constant it misses {elastic.constant_twist.speed:.0e} of the speed.",
    )
