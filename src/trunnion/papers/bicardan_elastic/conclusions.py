"""S2's conclusions, each against a computed figure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from trunnion.papers.shared.result import Conclusion, Reading, rounded, sign
from trunnion.response.kinetostatics.measures import extremes, largest
from trunnion.response.kinetostatics.result import Kinetostatics

GUIDELINE = 0.0027
"""Irregularity that makers' guidelines allow a line: one joint of 2.98°."""
REDUCED = 0.1
"""Variation over its mean below which a twist counts as nearly constant; the paper has no number."""
LOAD, BORNE = 150.0, 1e5
"""Load of the example and the largest one that counts as a case of such a shaft [N m]."""
QUANTITIES = {"speed": "output_speed", "acceleration": "output_acceleration", "torque": "drive_torque"}


def change(one: Kinetostatics, rigid: Kinetostatics, what: str) -> tuple[float, float]:
    """Largest difference over a turn, and the same over half the peak to peak of the rigid line's own fluctuation."""
    a, b = (np.asarray(getattr(k, QUANTITIES[what])) for k in (one, rigid))
    most = float(largest(a - b))
    low, high = extremes(b)
    return most, most / (float(high - low) / 2)


@dataclass(frozen=True)
class Turns:
    """A turn with elastic and with rigid shaft at the printed phases and at those that cancel (even)."""

    elastic: Kinetostatics
    rigid: Kinetostatics
    even: Kinetostatics
    even_rigid: Kinetostatics


def conclusions(units: Mapping[str, Turns]) -> tuple[Conclusion, ...]:
    """From turns with c₁₂ in each unit that the paper's number may have."""
    return (_kinematics(units), _torques(units), _deviation(units), _significance(units), _constant(units))


def _kinematics(units: Mapping[str, Turns]) -> Conclusion:
    readings = []
    for unit, turns in units.items():
        by_swing = {what: change(turns.elastic, turns.rigid, what) for what in QUANTITIES}
        more = min(by_swing["speed"][1], by_swing["acceleration"][1]) > by_swing["torque"][1]
        shown = ", ".join(f"{value[1]:.1e} of that of the {what}" for what, value in by_swing.items())
        readings.append(Reading(f"elastic − rigid over the fluctuation of the rigid line, {unit}", shown, sign(more)))
        mean = [by_swing[what][0] / _mean(turns.rigid, what) for what in ("speed", "torque")]
        readings.append(
            Reading(
                f"over the mean, {unit}",
                f"{mean[0]:.1e} of the speed, {mean[1]:.1e} of the torque",
                sign(mean[0] > mean[1]),
            )
        )
    return Conclusion(
        "The elasticity of the shaft influences mainly the kinematics of the transmission.",
        tuple(readings),
        "All of it is nothing beside what the printed phases do.",
    )


def _mean(turn: Kinetostatics, what: str) -> float:
    return float(np.abs(np.mean(getattr(turn, QUANTITIES[what]))))


def _torques(units: Mapping[str, Turns]) -> Conclusion:
    readings = []
    for unit, turns in units.items():
        largest = change(turns.elastic, turns.rigid, "torque")[0]
        share = largest / _mean(turns.rigid, "torque")
        readings.append(
            Reading(
                f"torque of the drive, {unit}",
                f"changes by {largest:.1e} N m, {share:.0e} of its mean",
                sign(share < 0.01),
            )
        )
    return Conclusion(
        "It has a reduced influence on the torques; what was found for rigid shafts stays valid.", tuple(readings)
    )


def _deviation(units: Mapping[str, Turns]) -> Conclusion:
    readings = []
    for unit, turns in units.items():
        elastic, rigid = turns.even.irregularity, turns.even_rigid.irregularity
        shown = f"irregularity {elastic:.1e} elastic, {rounded(rigid)} (below 1e-10) rigid"
        readings.append(Reading(f"phases that cancel (β₁₂ = ν₁₂), {unit}", shown, sign(elastic > 100 * rigid)))
    return Conclusion("It makes the transmission deviate from homokinetic.", tuple(readings))


def _significance(units: Mapping[str, Turns]) -> Conclusion:
    readings = []
    for unit, turns in units.items():
        shown = abs(turns.elastic.irregularity - turns.rigid.irregularity)
        allowed = LOAD * GUIDELINE / turns.even.irregularity
        readings.append(
            Reading(
                f"in the example, {unit}",
                f"irregularity {turns.rigid.irregularity:.4f} from the phases, changed by {shown:.0e}, and "
                f"{turns.even.irregularity:.1e} with phases that cancel, where a guideline is {GUIDELINE:g}",
                sign(max(shown, turns.even.irregularity) >= GUIDELINE),
            )
        )
        readings.append(
            Reading(
                f"in other cases, {unit}",
                f"it reaches {GUIDELINE:g} at about {allowed / 1000:.0f} kN m",
                sign(allowed < BORNE),
            )
        )
    return Conclusion(
        "The deviation can become significant in some cases (Figure 3 b).",
        tuple(readings),
        f"Cases count up to {BORNE / 1000:g} kN m, {BORNE / LOAD:.0f} times the example's torque, or a shaft so much "
        "softer under that torque. The unit of c₁₂ is inferred.",
    )


def _constant(units: Mapping[str, Turns]) -> Conclusion:
    readings = []
    for unit, turns in units.items():
        constant = turns.elastic.constant_twist
        assert constant is not None
        swing = float(constant.variation[1])
        readings += [
            Reading(
                f"varies little, by less than {100 * REDUCED:g} %, {unit}",
                f"± {100 * swing:.1f} % of its mean",
                sign(swing < REDUCED),
            ),
            Reading(
                f"is justified, {unit}",
                f"taken as constant it misses {constant.speed:.0e} of the speed",
                sign(constant.speed < 1e-3),
            ),
        ]
    return Conclusion(
        "The twist ξ varies little about its mean, so that ξ ≈ constant is justified.",
        tuple(readings),
        "It follows the torque in the shaft.",
    )
