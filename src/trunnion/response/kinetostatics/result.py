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
from trunnion.driveline.operating_speed import speed_unit
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
from trunnion.results.declared import Described, Held, axis, over, remark, remarks
from trunnion.results.drawing import Figure, drawing
from trunnion.results.finding import Finding, by_gravity
from trunnion.results.speeds import show_speed, speed_factor
from trunnion.results.units import angle_words
from trunnion.writing import written_whole

ANGLES = (
    ("angle", "rad", "rotation"),
    ("speed", "rad/s", "speed"),
    ("acceleration", "rad/s^2", "angular acceleration"),
)


@dataclass(frozen=True)
class ConstantTwist:
    """How good S2's ξ ≈ constant is: this result against one with every twist at its mean.

    ``variation`` [1] is (largest − smallest twist)/(2 |mean|) by shaft (NaN without twist); ``angle`` [rad],
    ``speed`` [rad/s] and ``acceleration`` [rad/s²] are the largest errors of the output.
    """

    variation: Array
    angle: float
    speed: float
    acceleration: float


@dataclass(frozen=True, eq=False, repr=False)
class Kinetostatics(Described):
    """Motion, torques, couples and support forces of a line over the input angle; SI units.

    Axes: ``point`` is the input angle, ``shaft`` the line's Shafts, ``joint`` its joints (a double-Cardan
    joint counts as two), ``fork`` the input and output fork of each joint in turn.

    Attributes
    ----------
    input_angle : (point,) rotation of the drive [rad]; ``points`` per turn, the end of a turn left out.
    angle, speed, acceleration : (shaft, point) of the far end of each shaft [rad, rad/s, rad/s²], counted
        from the unloaded line at input angle 0.
    twist : (shaft, point) far end minus near end [rad]; zero where rigid.
    torque : (shaft, point) [N m], positive with the twist, hence *negative* where power flows from the drive
        to the load; ``transmitted`` is the same with the other sign.
    branches : name of the element that ends each branch; a line without branches has one. ``branch`` is the one
        whose end is the output.
    end_angle, end_speed, end_acceleration : (branch, point) there; end_ratio (branch,) mean speed over the input's.
    end_torque : (branch,) [N m] asked for at each end, beside the Disks' own loads.
    output_angle, output_speed, output_acceleration : (point,) at the end of ``branch``.
    drive_torque : (point,) torque the drive must supply [N m].
    output_torque : torque [N m] asked for at the end of ``branch``, beside the Disks' own.
    joint_angle : (joint, point) input angle χ of each joint from its own plane [rad].
    joint_torque_in, joint_torque_out : (joint, point) transmitted into and out of each joint [N m].
    cross_tilt : (fork, point) of the cross in each fork [rad]: of the other fork's pins out of the plane square to the
        shaft, positive away from the drive; NaN where the joint has no cross.
    secondary_couple : (fork, 2, point) on the shaft, standing frame [N m]: along u (in the joint plane,
        toward the side the line bends to) and v (normal to it, axis × u).
    secondary_couple_rotating : (fork, 2, point) the same along the fork's arm and across it (axis × arm).
    supports : forces on bearings and joint centres, where bearings were given.
    constant_twists : how good a constant twist would be, for elastic shafts, by branch.
    power_loss : (point,) heat of the crosses' pins [W].
    power_residual : largest imbalance of power over the largest power [1]: rounding.
    findings : what a colleague would remark.
    """

    line: Driveline
    input_speed: float
    input_acceleration: float
    turns: int
    rigid: bool
    inertia: bool
    branches: tuple[str, ...]
    branch: str
    end_ratio: Array
    end_angle: Array
    end_speed: Array
    end_acceleration: Array
    end_torque: Array
    input_angle: Array
    shafts: tuple[str, ...]
    shaft_ratio: Array
    angle: Array
    speed: Array
    acceleration: Array
    twist: Array
    torque: Array
    drive_torque: Array
    joints: tuple[str, ...]
    joint_angle: Array
    joint_torque_in: Array
    joint_torque_out: Array
    forks: tuple[str, ...]
    fork_ratio: Array
    cross_tilt: Array
    secondary_couple: Array
    secondary_couple_rotating: Array
    supports: Supports | None
    constant_twists: tuple[ConstantTwist, ...] | None
    findings: tuple[Finding, ...]
    power_loss: Array
    power_residual: float

    @property
    def _end(self) -> int:
        return self.branches.index(self.branch)

    @property
    def mean_ratio(self) -> float:
        """Mean speed of the output over the input's."""
        return float(self.end_ratio[self._end])

    @property
    def output_angle(self) -> Array:
        """Rotation of the output [rad] (point,)."""
        return np.asarray(self.end_angle[self._end])

    @property
    def output_speed(self) -> Array:
        """Speed of the output [rad/s] (point,)."""
        return np.asarray(self.end_speed[self._end])

    @property
    def output_acceleration(self) -> Array:
        """Angular acceleration of the output [rad/s²] (point,)."""
        return np.asarray(self.end_acceleration[self._end])

    @property
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
    def irregularity(self) -> float:
        """U = (largest − smallest output speed)/mean [1], over the turns computed."""
        return irregularity(self.output_speed, self.input_speed * self.mean_ratio)

    @property
    def equivalent_angle(self) -> float:
        """Angle [rad] of the single Hooke's joint with this irregularity."""
        return float(equivalent_angle(self.irregularity))

    @property
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
        """Mean of the power that arrives over mean of the power supplied [1]; 1 without friction."""
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

    def declared(self) -> Iterator[Held]:
        """Everything over the input angle, by the named shafts, branches, joints, forks and bearings; the settings."""
        yield axis("input_angle", self.input_angle, "rad", "input angle")
        yield axis("shaft", list(self.shafts))
        yield axis("branch", list(self.branches))
        yield axis("joint", list(self.joints))
        yield axis("fork", list(self.forks))
        yield axis("standing", ["u", "v"])
        yield axis("rotating", ["arm", "across"])
        for name, unit, words in ANGLES:
            yield over("shaft input_angle", name, getattr(self, name), unit, f"{words} of the far end")
        yield over("shaft input_angle", "twist", self.twist, "rad", "twist, far end minus near end")
        yield over("shaft input_angle", "torque", self.torque, "N*m", "torque, positive with the twist")
        for name, unit, words in ANGLES:
            yield over("input_angle", f"output_{name}", getattr(self, f"output_{name}"), unit, f"{words} of the output")
        for name, unit, words in ANGLES:
            values = getattr(self, f"end_{name}")
            yield over("branch input_angle", f"end_{name}", values, unit, f"{words} of the branch's end")
        yield over("input_angle", "drive_torque", self.drive_torque, "N*m", "torque the drive supplies")
        yield over("input_angle", "power_loss", self.power_loss, "W", "power lost in joint friction")
        joint, fork, couple = "joint input_angle", "fork {} input_angle", "couple on the fork, {} frame"
        yield over(joint, "joint_angle", self.joint_angle, "rad", "input angle from the joint's own plane")
        yield over(joint, "joint_torque_in", self.joint_torque_in, "N*m", "torque transmitted into the joint")
        yield over(joint, "joint_torque_out", self.joint_torque_out, "N*m", "torque transmitted out of the joint")
        tilt = "tilt of the other fork's pins out of the plane square to the shaft"
        yield over("fork input_angle", "cross_tilt", self.cross_tilt, "rad", tilt)
        for frame, name in (("standing", "secondary_couple"), ("rotating", "secondary_couple_rotating")):
            yield over(fork.format(frame), name, getattr(self, name), "N*m", couple.format(frame))
        if self.supports is not None:
            yield axis("bearing", list(self.supports.names))
            yield axis("loaded_joint", list(self.supports.joint_names))
            yield axis("axis", ["e", "u", "v"])
            force, between = (
                "force of the shaft on its bearing",
                "force of the shaft in front of the joint on the one behind it",
            )
            yield over("bearing standing input_angle", "support_force", self.supports.force, "N", force)
            yield over("loaded_joint axis input_angle", "joint_force", self.supports.joint_force, "N", between)
        yield from remarks(
            version=__version__,
            driveline=dumps(self.line),
            input_speed=self.input_speed,
            input_acceleration=self.input_acceleration,
            output=self.branch,
            output_torque=self.output_torque,
            turns=self.turns,
            rigid=int(self.rigid),
            inertia=int(self.inertia),
        )
        for name in ("irregularity", "equivalent_angle", "homokinetic_deviation", "peak_acceleration"):
            yield remark(name, getattr(self, name))

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """One line per input angle, one column per quantity and shaft, units in the heading."""
        columns = dict(_columns(self))
        with written_whole(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream)
            writer.writerow(columns)
            writer.writerows([repr(float(x)) for x in row] for row in zip(*columns.values(), strict=True))

    def table(self, unit: str | None = None) -> list[dict[str, Any]]:
        """One row per shaft: speed range in ``unit`` (default the description's), acceleration, torque range, twist."""
        unit = unit or speed_unit(self.line)
        factor, rows = speed_factor(unit), []
        for s, name in enumerate(self.shafts):
            slow, fast = extremes(self.speed[s])
            weak, strong = extremes(self.transmitted[s])
            rows.append(
                {
                    "shaft": name,
                    f"slowest [{unit}]": float(slow) * factor,
                    f"fastest [{unit}]": float(fast) * factor,
                    "largest acceleration [rad/s^2]": float(largest(self.acceleration[s])),
                    "least torque [N*m]": float(weak),
                    "largest torque [N*m]": float(strong),
                    "largest twist [rad]": float(largest(self.twist[s])),
                }
            )
        return rows

    def plot(self, *, unit: str | None = None) -> Figure:
        """Speeds, accelerations, torques and couples over the turn; see ``plots.kinetostatics.draw``."""
        return drawing(self, "plot")(self, unit=unit)

    def describe(self, unit: str | None = None) -> str:
        """The summary that printing gives, the input speed in ``unit``, by default that of the line's description."""
        return "\n".join(
            [
                _title(self, unit or speed_unit(self.line)),
                *(line for name in self.branches for line in _output(self.on_branch(name))),
                *_torques(self),
                *_couples(self),
                *_supports(self),
                *_twists(self),
                *(f"  {finding}" for finding in by_gravity(self.findings)),
            ]
        )


def _title(r: Kinetostatics, unit: str) -> str:
    name = f" of {r.line.name!r}" if r.line.name else ""
    turns = "one turn" if r.turns == 1 else f"{r.turns} turns"
    kind = "rigid shafts" if r.rigid else "elastic shafts, their damping left out"
    return (
        f"kinetostatics{name} over {turns} at {show_speed(r.input_speed, unit)}: {kind}, "
        f"inertia torques {'included' if r.inertia else 'left out'}, {len(r.input_angle)} points"
    )


def _output(r: Kinetostatics) -> list[str]:
    low, high = r.speed_ratio
    output = "output" if len(r.branches) == 1 else f"output {r.branch}"
    if not r.irregularity:
        return [f"  {output} turns uniformly at {low:.5f} of the input speed"]
    return [
        f"  {output} speed over input speed {low:.5f} to {high:.5f}: irregularity {r.irregularity:.5g}, as one "
        f"Hooke's joint of {r.equivalent_angle / DEGREE:.4g} deg",
        f"  {output} leads and lags by {r.homokinetic_deviation / DEGREE:.4g} deg; largest angular "
        f"acceleration {r.peak_acceleration:.5g} rad/s^2",
    ]


def _torques(r: Kinetostatics) -> list[str]:
    if not np.any(r.drive_torque):
        return ["  no torque: no Disk has a load and no output_torque is given"]
    low, high = extremes(r.drive_torque)
    line = f"  drive torque {low:.6g} to {high:.6g} N*m"
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
        f"  largest secondary couple {size[f]:.5g} N*m, on the fork {r.forks[f]!r}: "
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
        f"  largest twist {angle_words(largest(r.twist)[s], 4)} in {r.shafts[s]}, varying by ± "
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
