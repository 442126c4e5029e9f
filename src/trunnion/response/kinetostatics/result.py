"""What ``kinetostatics`` gives back: arrays over the input angle, and the numbers read off them."""

from __future__ import annotations

import csv
import os
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from trunnion._version import __version__
from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.files import dumps
from trunnion.driveline.quantities import DEGREE
from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError
from trunnion.response.kinetostatics.measures import (
    ROUNDING,
    Parts,
    equivalent_angle,
    extremes,
    irregularity,
    largest,
    parts,
)
from trunnion.response.kinetostatics.supports import Supports
from trunnion.results.drawing import Figure, drawing
from trunnion.results.fields import attribute, computed, coordinate, declared, internal, labelled, variable
from trunnion.results.finding import Finding, by_gravity
from trunnion.results.result import Result
from trunnion.results.units import range_words
from trunnion.results.variables import Attribute, Coordinate, Variable, attributes
from trunnion.writing import written_whole

ANGLES = (
    ("angle", "rad", "rotation"),
    ("speed", "rad/s", "speed"),
    ("acceleration", "rad/s^2", "angular acceleration"),
)
TILT = "tilt of the other fork's pins out of the plane square to the shaft"


@dataclass(frozen=True)
class ConstantTwist:
    """How good S2's ξ ≈ constant is: this result against one with every twist at its mean.

    ``variation`` [-] is (largest − smallest twist)/(2 |mean|) by shaft (NaN without twist); ``angle`` [rad],
    ``speed`` [rad/s] and ``acceleration`` [rad/s²] are the largest errors of the output.
    """

    variation: Array
    angle: float
    speed: float
    acceleration: float


@labelled
class Kinetostatics(Result):
    """Motion, torques, couples and support forces of a line over the input angle; SI units.

    The end of a turn is left out. Angles count from the unloaded line at input angle 0. A double-Cardan joint counts as
    two; its cross tilts positive away from the drive, NaN where a joint has none. Torque is positive with the twist,
    hence *negative* where power flows from the drive to the load; ``transmitted`` is the same with the other sign.
    Secondary couples act on the shaft: in the standing frame along u (in the joint plane, toward the side the line
    bends to) and v (normal to it, axis × u), in the rotating one along the fork's arm and across it (axis × arm).
    """

    line: Driveline = internal("whose turn it is")
    input_angle: Array = coordinate("input_angle", "rad", "input angle")
    shafts: tuple[str, ...] = coordinate("shaft")
    branches: tuple[str, ...] = coordinate("branch", words="elements that end them")
    joints: tuple[str, ...] = coordinate("joint")
    forks: tuple[str, ...] = coordinate("fork", words="input and output fork of each joint in turn")
    angle: Array = variable("shaft input_angle", "rad", "rotation of the far end")
    speed: Array = variable("shaft input_angle", "rad/s", "speed of the far end")
    acceleration: Array = variable("shaft input_angle", "rad/s^2", "angular acceleration of the far end")
    twist: Array = variable("shaft input_angle", "rad", "twist, far end minus near end")
    torque: Array = variable("shaft input_angle", "N*m", "torque, positive with the twist")
    end_angle: Array = variable("branch input_angle", "rad", "rotation of the branch's end")
    end_speed: Array = variable("branch input_angle", "rad/s", "speed of the branch's end")
    end_acceleration: Array = variable("branch input_angle", "rad/s^2", "angular acceleration of the branch's end")
    drive_torque: Array = variable("input_angle", "N*m", "torque the drive supplies")
    power_loss: Array = variable("input_angle", "W", "power lost in joint friction")
    joint_angle: Array = variable("joint input_angle", "rad", "input angle from the joint's own plane")
    joint_torque_in: Array = variable("joint input_angle", "N*m", "torque transmitted into the joint")
    joint_torque_out: Array = variable("joint input_angle", "N*m", "torque transmitted out of the joint")
    cross_tilt: Array = variable("fork input_angle", "rad", TILT)
    secondary_couple: Array = variable("fork standing input_angle", "N*m", "couple on the fork, standing frame")
    secondary_couple_rotating: Array = variable(
        "fork rotating input_angle", "N*m", "couple on the fork, rotating frame"
    )
    input_speed: float = attribute("mean", "rad/s")
    input_acceleration: float = attribute("of the drive", "rad/s^2")
    branch: str = attribute("whose end is the output", name="output")
    turns: int = attribute("computed")
    repeats_after: int = attribute("turns of the input after which the motion repeats")
    rigid: bool = attribute("whether shafts are")
    inertia: bool = attribute("whether inertia torques are included")
    end_ratio: Array = internal("mean speed over the input's", "1", "branch")
    end_torque: Array = internal("asked for at each end, beside the disks' own loads", "N m", "branch")
    shaft_elements: tuple[str, ...] = internal("element that each shaft is of", axes="shaft")
    shaft_ratio: Array = internal("mean speed over the input's", "1", "shaft")
    fork_ratio: Array = internal("mean speed over the input's", "1", "fork")
    supports: Supports | None = internal("forces on bearings and joint centres, where bearings were given")
    constant_twists: tuple[ConstantTwist, ...] | None = internal("how good a constant twist would be, by branch")
    findings: tuple[Finding, ...] = internal("what a colleague would remark")
    power_residual: float = internal("largest imbalance of power over the largest power: rounding", "1")
    unit: str = internal("of speeds in print")

    __eq__, __hash__ = object.__eq__, object.__hash__

    @property
    def _end(self) -> int:
        return self.branches.index(self.branch)

    @property
    def mean_ratio(self) -> float:
        """Mean speed of the output over the input's."""
        return float(self.end_ratio[self._end])

    @property
    @computed(variable("input_angle", "rad", "rotation of the output"), after="torque")
    def output_angle(self) -> Array:
        """Rotation of the output [rad] (point,)."""
        return np.asarray(self.end_angle[self._end])

    @property
    @computed(variable("input_angle", "rad/s", "speed of the output"), after="torque")
    def output_speed(self) -> Array:
        """Speed of the output [rad/s] (point,)."""
        return np.asarray(self.end_speed[self._end])

    @property
    @computed(variable("input_angle", "rad/s^2", "angular acceleration of the output"), after="torque")
    def output_acceleration(self) -> Array:
        """Angular acceleration of the output [rad/s²] (point,)."""
        return np.asarray(self.end_acceleration[self._end])

    @property
    @computed(attribute())
    def output_torque(self) -> float:
        """Torque asked for at the output [N m]."""
        return float(self.end_torque[self._end])

    @property
    def constant_twist(self) -> ConstantTwist | None:
        """How good a constant twist would be for the output, for elastic shafts."""
        return self.constant_twists[self._end] if self.constant_twists else None

    def on_branch(self, name: str) -> Kinetostatics:
        """The same turn, its output the end of the branch that ``branches`` calls ``name``."""
        return replace(self, branch=self.branches[_place(name, self.branches, "branch")])

    @property
    def transmitted(self) -> Array:
        """Torque of each shaft [N m], positive from the drive to the load (shaft, point)."""
        return -self.torque

    @cached_property
    @computed(attribute())
    def irregularity(self) -> float:
        """U = (largest − smallest output speed)/mean [-], over the turns computed."""
        return irregularity(self.output_speed, self.input_speed * self.mean_ratio)

    @property
    @computed(attribute())
    def equivalent_angle(self) -> float:
        """Angle [rad] of the single Hooke's joint with this irregularity."""
        return float(equivalent_angle(self.irregularity))

    @property
    @computed(attribute())
    def peak_acceleration(self) -> float:
        """Largest angular acceleration of the output [rad/s²]; 0 where it is only rounding."""
        peak = float(largest(self.output_acceleration))
        return peak if peak > ROUNDING * self.input_speed**2 * abs(self.mean_ratio) else 0.0

    @property
    def deviation(self) -> Array:
        """Output angle minus mean ratio times input angle [rad], about its middle (point,)."""
        lead = self.output_angle - self.mean_ratio * self.input_angle
        low, high = extremes(lead)
        return np.asarray(lead - (low + high) / 2)

    @property
    @computed(attribute())
    def homokinetic_deviation(self) -> float:
        """Largest lead or lag of the output [rad]: half its swing about uniform rotation."""
        low, high = extremes(self.output_angle - self.mean_ratio * self.input_angle)
        return float(high - low) / 2

    @property
    def speed_ratio(self) -> tuple[float, float]:
        """Smallest and largest output speed over input speed."""
        low, high = extremes(self.output_speed / self.input_speed)
        return float(low), float(high)

    @property
    def efficiency(self) -> float:
        """Mean of the power that arrives over mean of the power supplied [-], joints alone; 1 without friction."""
        supplied = float(np.mean(self.drive_torque * self.input_speed))
        return 1 - float(np.mean(self.power_loss)) / supplied if supplied else 1.0

    def couple_parts(self, fork: str) -> Parts:
        """Steady and turning parts of the secondary couple on a fork [N m]."""
        f = _place(fork, self.forks, "fork")
        return parts(self.secondary_couple[f], self.fork_ratio[f] * self.input_angle)

    def support_parts(self, bearing: str) -> Parts:
        """Steady and turning parts of the force on a bearing [N], by its name in ``supports.names``."""
        names = self.supports.names if self.supports else ()
        b = _place(bearing, names, "bearing")
        assert self.supports is not None
        return parts(self.supports.force[b], self.supports.ratio[b] * self.input_angle)

    def declared(self) -> Iterator[Variable | Attribute]:
        """Everything over the input angle, by the named shafts, branches, joints, forks and bearings; the settings."""
        yield from super().declared()
        yield Coordinate("standing", ["u", "v"], "standing")
        yield Coordinate("rotating", ["arm", "across"], "rotating")
        yield from attributes(version=__version__, driveline=dumps(self.line))
        if self.supports is not None:
            yield Coordinate("axis", ["e", "u", "v"], "axis")
            yield from declared(self.supports)

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """One line per input angle, one column per quantity and shaft, units in the heading."""
        columns = dict(_columns(self))
        with written_whole(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream)
            writer.writerow(columns)
            writer.writerows([repr(float(x)) for x in row] for row in zip(*columns.values(), strict=True))

    def table(self, unit: str | None = None) -> list[dict[str, Any]]:
        """One row per shaft: speed range in ``unit`` (default the description's), acceleration, torque range, twist."""
        words, rows = self.in_unit(unit).words, []
        for s, name in enumerate(self.shafts):
            slow, fast = extremes(self.speed[s])
            weak, strong = extremes(self.transmitted[s])
            rows.append(
                {
                    "shaft": name,
                    f"slowest [{words.unit}]": float(slow) * words.factor,
                    f"fastest [{words.unit}]": float(fast) * words.factor,
                    "largest acceleration [rad/s²]": float(largest(self.acceleration[s])),
                    "least torque [N m]": float(weak) + 0.0,  # not -0
                    "largest torque [N m]": float(strong) + 0.0,
                    "largest twist [rad]": float(largest(self.twist[s])),
                }
            )
        return rows

    def plot(self, *, unit: str | None = None) -> Figure:
        """Speeds, accelerations, torques and couples over the turn; see ``pictures.kinetostatics``."""
        return drawing(self, "plot")(self, unit=unit).figure

    @property
    def _printed(self) -> tuple[Finding, ...]:
        return by_gravity(self.findings)

    def _lines(self) -> Iterator[str]:
        yield _title(self)
        for name in self.branches:
            yield from _output(self.on_branch(name))
        for part in (_torques, _couples, _supports, _twists):
            yield from part(self)


def _title(r: Kinetostatics) -> str:
    name = f" of {r.line.name!r}" if r.line.name else ""
    turns = "one turn" if r.turns == 1 else f"{r.turns} turns"
    kind = "rigid shafts" if r.rigid else "elastic shafts, their damping left out"
    return (
        f"kinetostatics{name} over {turns} at {r.words.speed(r.input_speed)}: {kind}, "
        f"inertia torques {'included' if r.inertia else 'left out'}, {len(r.input_angle)} points"
    )


def _output(r: Kinetostatics) -> list[str]:
    low, high = r.speed_ratio
    output = "output" if len(r.branches) == 1 else f"output {r.branch}"
    if not r.irregularity:
        return [f"  {output} turns uniformly at {low:.5f} of the input speed"]
    turned = range_words(f"{low:.5f}", f"{high:.5f}")
    return [
        f"  {output} speed over input speed {turned}: irregularity {r.irregularity:.5g}, as one "
        f"Hooke's joint of {r.equivalent_angle / DEGREE:.4g} deg",
        f"  {output} leads and lags by {r.homokinetic_deviation / DEGREE:.4g} deg; largest angular "
        f"acceleration {r.peak_acceleration:.5g} rad/s²",
    ]


def _torques(r: Kinetostatics) -> list[str]:
    if not np.any(r.drive_torque):
        return ["  no torque: no Disk has a load and no output_torque is given"]
    low, high = extremes(r.drive_torque)
    line = f"  drive torque {range_words(f'{low:.6g}', f'{high:.6g}')} N m"
    if np.any(r.power_loss):
        line += f"; joint friction leaves an efficiency of {r.efficiency:.5f}"
    return [line]


def _couples(r: Kinetostatics) -> list[str]:
    if not len(r.forks):
        return []
    size = largest(np.hypot(r.secondary_couple[:, 0], r.secondary_couple[:, 1]))
    if not np.any(size > 0):
        return []
    f = int(np.argmax(size))
    part = r.couple_parts(r.forks[f])
    return [
        f"  largest secondary couple {size[f]:.5g} N m, on the fork {r.forks[f]!r}: "
        f"{np.hypot(*part.steady):.5g} steady, {part.two_per_turn:.5g} twice per turn"
    ]


def _supports(r: Kinetostatics) -> list[str]:
    if r.supports is None:
        return []
    lines = []
    for name in r.supports.names:
        part = r.support_parts(name)
        lines.append(
            f"  bearing {name}: up to {part.largest:.5g} N; {np.hypot(*part.steady):.5g} steady, "
            f"{part.two_per_turn:.5g} twice per turn"
        )
    return lines


def _twists(r: Kinetostatics) -> list[str]:
    constant = r.constant_twist
    if constant is None or not np.any(r.twist):
        return []
    s = int(np.argmax(largest(r.twist)))
    return [
        f"  largest twist {r.words.angle(largest(r.twist)[s], 4)} in {r.shafts[s]}, varying by ± "
        f"{100 * constant.variation[s]:.3g} % of its mean over the turn; taken as constant, the output speed "
        f"is off by {constant.speed / r.input_speed:.2g} of the input speed"
    ]


def _place(name: str, names: tuple[str, ...], what: str) -> int:
    if name not in names:
        raise InputError(f"is not a {what} of this result", key=name, remedy=nearest(name, names))
    return names.index(name)


def _columns(result: Kinetostatics) -> Iterator[tuple[str, Array]]:
    yield "input angle [rad]", result.input_angle
    of_shafts = (*((what, unit) for what, unit, _ in ANGLES), ("twist", "rad"), ("torque", "N*m"))
    for s, name in enumerate(result.shafts):
        for what, unit in of_shafts:
            yield f"{name} {what} [{unit}]", getattr(result, what)[s]
    for k, name in enumerate(result.branches):
        output = "output" if len(result.branches) == 1 else f"output {name}"
        for what, unit, _ in ANGLES:
            yield f"{output} {what} [{unit}]", getattr(result, f"end_{what}")[k]
    yield "drive torque [N*m]", result.drive_torque
    for name, (u, v) in zip(result.forks, result.secondary_couple, strict=True):
        yield f"{name} couple u [N*m]", u
        yield f"{name} couple v [N*m]", v
    for name, tilt in zip(result.forks, result.cross_tilt, strict=True):
        if not np.any(np.isnan(tilt)):
            yield f"{name} tilt of the cross [rad]", tilt
    if result.supports:
        for name, (u, v) in zip(result.supports.names, result.supports.force, strict=True):
            yield f"{name} force u [N]", u
            yield f"{name} force v [N]", v
