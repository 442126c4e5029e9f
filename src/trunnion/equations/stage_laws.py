"""Springs that are linear stage by stage, gear meshes and shafts with stages, as laws of torque over twist.

A mesh of stiffness k and base radii r₁, r₂ acts like a shaft behind the rigid pair, from where a rigid mesh would hold
the output gear to where it is: u = −r₂q, so its stiffness is k r₂², its damping c r₂² and its play ± backlash/2r₂.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Element
from trunnion.driveline.gears import GearPair
from trunnion.driveline.stages import PiecewiseShaft
from trunnion.errors import InputError
from trunnion.laws.spring import StageSpring

Column = Callable[[int, str], int]


@dataclass(frozen=True)
class StageLaw(StageSpring):
    """The spring of one element, per case: knots (case, n) twists [rad], slopes (case, n + 1) [N m/rad].

    ``softest_damped`` is False where the softest stage does not damp.
    """

    name: str
    softest_damped: bool

    def under(self, torque: Array, *, free: bool = False) -> tuple[Array, Array, Array]:
        """Twist, slope and whether there is damping (1 or 0) under a steady ``torque`` [N m], (case,) each.

        ``free`` leaves a spring in its free play with slope 0 and no twist.

        Raises
        ------
        InputError : no stage carries the torque, or the spring is free there.
        """
        # Without torque: the stage that twist 0 is in, even where its slope is 0.
        stage = np.where(torque == 0, self.stage(np.zeros(len(torque))), self.stage_under(torque))
        slope, offset = self.of(self.slopes, stage), self.of(self.offsets, stage)
        if np.any(slope == 0) and not free:
            raise self._in_play(float(torque[slope == 0][0]))
        damped = np.ones(len(stage)) if self.softest_damped else (stage != np.argmin(self.slopes, axis=1)).astype(float)
        return np.where(slope > 0, torque - offset, 0.0) / np.where(slope > 0, slope, 1.0), slope, damped

    def depth(self, twist: Array) -> Array:
        """How far a twist (case,) lies beyond a mesh's backlash [rad]."""
        return np.asarray(np.maximum(0.0, np.abs(twist) - self.knots[:, -1]))

    @property
    def first(self) -> StageSpring:
        """The spring of the first case alone."""
        return StageSpring(self.knots[0], self.slopes[0])

    def _in_play(self, torque: float) -> InputError:
        if torque == 0:
            return InputError(
                "turns freely within its play without load, so linear equations have no stiffness for it",
                element=self.name,
                remedy="give the disks load_torque, or a slope inside the play; tn.periodic_response and tn.simulate "
                "take it as it is",
            )
        return InputError(
            f"has no stage that carries its load of {torque:g} N m: it slips", element=self.name, remedy=SLIPS
        )


SLIPS = "raise the torque at which it slips, lower the load, or write a SlipClutch where no spring stands beside it"
"""What to do about a spring whose outermost stages bear no more torque, such as a slip clutch in series."""


def has_stages(element: Element) -> bool:
    """Whether the element's spring follows a law of stages."""
    return isinstance(element, PiecewiseShaft | GearPair)


def stage_law(line: Driveline, place: int, column: Column, table: Array) -> StageLaw:
    """The law of the element at ``place`` for every row of ``table`` (case, columns).

    Raises
    ------
    InputError : breakpoints that do not rise, a slope or a backlash out of range, where parameters were varied.
    """
    element, name = line.elements[place], line.names[place]
    if isinstance(element, PiecewiseShaft):
        knots = table[:, [column(place, f"breakpoint {j + 1}") for j in range(len(element.breakpoints))]]
        slopes = table[:, [column(place, f"stiffness {j + 1}") for j in range(len(element.stiffnesses))]]
        if np.any(np.diff(knots, axis=1) <= 0):
            raise InputError("must rise", element=name, key="breakpoints", value=knots[0].tolist())
        if np.any(slopes < 0):
            raise InputError("must not be negative", element=name, key="stiffnesses", value=float(slopes.min()))
        return StageLaw(knots, slopes, name, element.damping_law == "always")
    assert isinstance(element, GearPair)
    out = element.radii[1]
    k = table[:, column(place, "mesh_stiffness")] * out**2
    if not element.total_backlash:
        return StageLaw(np.zeros((len(table), 0)), k[:, None], name, True)
    if element.backlash:
        half = table[:, column(place, "backlash")] / (2 * out)
    else:
        half = table[:, column(place, "angular_backlash")] / 2
    inside = table[:, column(place, "stiffness_ratio")]
    if np.any(half <= 0):
        remedy = "leave it out for none"
        raise InputError("must be positive", element=name, key="backlash", value=float(2 * half.min()), remedy=remedy)
    if np.any((inside < 0) | (inside > 1)):
        raise InputError("must lie between 0 and 1", element=name, key="stiffness_ratio", value=float(inside[0]))
    knots, slopes = np.stack([-half, half], axis=1), np.stack([k, inside * k, k], axis=1)
    return StageLaw(knots, slopes, name, element.damping_law == "always")


def spring_damping(element: Element, place: int, column: Column, table: Array) -> Array:
    """Damping [N m s/rad] of a shaft or a mesh, as a law of twist rate."""
    if isinstance(element, GearPair):
        return np.asarray(table[:, column(place, "mesh_damping")] * element.radii[1] ** 2)
    return np.asarray(table[:, column(place, "damping")])


def impact_damping(element: Element, place: int, column: Column, table: Array) -> Array:
    """Damping over depth of contact [N m s/rad²] of a mesh, as a law of twist rate and twist; zeros elsewhere."""
    if isinstance(element, GearPair) and element.impact_damping:
        return np.asarray(table[:, column(place, "impact_damping")] * element.radii[1] ** 3)
    return np.zeros(len(table))
