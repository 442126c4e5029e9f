"""Springs with stages or play about a line's own motion: in which stage each works, and whether the tube stays there.

Within its stage a spring is linear, f = T̄ + k (θ − θ̄), with the twist θ̄ at which it carries the mean load T̄. Whether
the motion meets another stage is not asked of the motion alone, but of the whole tube that is proved to hold it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.gears import GearPair
from trunnion.driveline.stages import PiecewiseShaft
from trunnion.equations.coefficients import Assembly
from trunnion.equations.stage_laws import stage_law
from trunnion.errors import InputError
from trunnion.floquet.certificate.box_coefficients import staged
from trunnion.floquet.certificate.waves import OUTWARD, Wave


@dataclass(frozen=True)
class OwnStage:
    """Of one spring: the twist θ̄ of a mean load, and from where to where its stage reaches [rad]."""

    spring: int
    twist: float
    low: float
    high: float

    def holds(self, beyond: Wave) -> bool:
        """Whether all twists θ̄ + ``beyond`` lie within the stage."""
        middle = self.twist + beyond.mean.real
        swing = (beyond - beyond.mean).size * OUTWARD + 1e-12 * (abs(self.twist) + beyond.size)
        return bool(self.low < middle - swing and middle + swing < self.high)


def own_stages(assembly: Assembly, row: Array) -> tuple[OwnStage, ...]:
    """Of every spring with stages, under the mean loads of ``row`` (1, columns)."""
    line, found = assembly.line, []
    twist = assembly.coefficients(row).twist[0]
    for e, compliance in enumerate(assembly.topology.compliances):
        place = compliance.shafts[0]
        if not staged(line.elements[place]):
            continue
        law = stage_law(line, place, assembly.packed.column, row).first
        at = int(law.stage(twist[e]))
        ends = [-np.inf, *law.knots.tolist(), np.inf]
        found.append(OwnStage(e, float(twist[e]), ends[at], ends[at + 1]))
    return tuple(found)


def stage_obstacle(element: PiecewiseShaft | GearPair) -> str:
    """Why a spring with stages is not linear within one; empty where it is."""
    if isinstance(element, GearPair) and element.impact_damping:
        return "damping that goes with the depth of contact is not enclosed"
    if element.damping_law == "never pulling":
        return "teeth that never pull are not enclosed"
    return "" if type(element) in (PiecewiseShaft, GearPair) else f"the stages of a {element.kind} are not enclosed"


def require_stages_kept(
    assembly: Assembly, stages: tuple[OwnStage, ...], beyond: tuple[Wave, ...], speed: float
) -> None:
    """Refuse a motion that leaves the stage of a spring, by its twists ``beyond`` that of each of the ``stages``: no
    smaller box would help.

    Raises
    ------
    InputError : names the spring, its twists and its stage.
    """
    for one, twist in zip(stages, beyond, strict=True):
        order = np.arange(-twist.last, twist.last + 1)
        angles = 2 * np.pi * np.arange(4 * len(order)) / (4 * len(order))
        at = one.twist + (np.exp(1j * np.outer(angles, order)) @ twist.parts[0]).real
        if not (one.low < at.min() and at.max() < one.high):
            ends = [np.degrees(value) for value in (at.min(), at.max(), one.low, one.high)]
            raise InputError(
                f"leaves its stage at {speed:.6g} rad/s: its twist goes from {ends[0]:.4g} to {ends[1]:.4g} deg, the "
                f"stage from {ends[2]:.4g} to {ends[3]:.4g} deg, and a certificate is of one stage",
                element=assembly.line.names[assembly.topology.compliances[one.spring].shafts[0]],
                remedy="leave out speeds at which it does; stability() takes the stages that the motion meets",
            )  # fmt: skip
