"""What a kinetostatic result holds, by name, unit and axis."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from trunnion._version import __version__
from trunnion.driveline.files import dumps
from trunnion.results.declared import Held, axis, over, remark

if TYPE_CHECKING:
    from trunnion.analyses.kinetostatics.result import Kinetostatics

ANGLES = (
    ("angle", "rad", "rotation"),
    ("speed", "rad/s", "speed"),
    ("acceleration", "rad/s^2", "angular acceleration"),
)


def contents(r: Kinetostatics) -> Iterator[Held]:
    """Variables over ``input_angle`` and the named shafts, branches, joints, forks and bearings; then the settings."""
    yield axis("input_angle", r.input_angle, "rad", "input angle")
    for name, names in (("shaft", r.shafts), ("branch", r.branches), ("joint", r.joints), ("fork", r.forks)):
        yield axis(name, list(names))
    yield axis("standing", ["u", "v"])
    yield axis("rotating", ["arm", "across"])
    for name, unit, words in ANGLES:
        yield over("shaft input_angle", name, getattr(r, name), unit, f"{words} of the far end")
    yield over("shaft input_angle", "twist", r.twist, "rad", "twist, far end minus near end")
    yield over("shaft input_angle", "torque", r.torque, "N*m", "torque, positive with the twist")
    for name, unit, words in ANGLES:
        yield over("input_angle", f"output_{name}", getattr(r, f"output_{name}"), unit, f"{words} of the output")
    for name, unit, words in ANGLES:
        values = getattr(r, f"end_{name}")
        yield over("branch input_angle", f"end_{name}", values, unit, f"{words} of the branch's end")
    yield over("input_angle", "drive_torque", r.drive_torque, "N*m", "torque the drive supplies")
    yield over("input_angle", "power_loss", r.power_loss, "W", "power lost in joint friction")
    joint, fork, couple = "joint input_angle", "fork {} input_angle", "couple on the fork, {} frame"
    yield over(joint, "joint_angle", r.joint_angle, "rad", "input angle from the joint's own plane")
    yield over(joint, "joint_torque_in", r.joint_torque_in, "N*m", "torque transmitted into the joint")
    yield over(joint, "joint_torque_out", r.joint_torque_out, "N*m", "torque transmitted out of the joint")
    for frame, name in (("standing", "secondary_couple"), ("rotating", "secondary_couple_rotating")):
        yield over(fork.format(frame), name, getattr(r, name), "N*m", couple.format(frame))
    if r.supports is not None:
        yield axis("bearing", list(r.supports.names))
        yield axis("loaded_joint", list(r.supports.joint_names))
        yield axis("axis", ["e", "u", "v"])
        force, between = (
            "force of the shaft on its bearing",
            "force of the shaft in front of the joint on the one behind it",
        )
        yield over("bearing standing input_angle", "support_force", r.supports.force, "N", force)
        yield over("loaded_joint axis input_angle", "joint_force", r.supports.joint_force, "N", between)
    yield remark("version", __version__)
    yield remark("driveline", dumps(r.line))
    yield remark("input_speed", r.input_speed)
    yield remark("input_acceleration", r.input_acceleration)
    yield remark("output", r.branch)
    yield remark("output_torque", r.output_torque)
    yield remark("turns", r.turns)
    yield remark("rigid", int(r.rigid))
    yield remark("inertia", int(r.inertia))
    for name in ("irregularity", "equivalent_angle", "homokinetic_deviation", "peak_acceleration"):
        yield remark(name, getattr(r, name))
