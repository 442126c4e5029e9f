"""A kinetostatic result as a labelled dataset."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from trunnion._version import __version__
from trunnion.driveline.files import dumps

if TYPE_CHECKING:
    import xarray as xr

    from trunnion.analyses.kinetostatics.result import Kinetostatics


def dataset(r: Kinetostatics) -> xr.Dataset:
    """Variables over ``input_angle`` and the named shafts, joints, forks and bearings."""
    import xarray as xr

    def per(axis: str, values: Any, units: str, name: str) -> tuple[tuple[str, ...], Any, dict[str, str]]:
        return (axis, "input_angle"), values, {"units": units, "long_name": name}

    def alone(values: Any, units: str, name: str) -> tuple[str, Any, dict[str, str]]:
        return "input_angle", values, {"units": units, "long_name": name}

    def vector(axis: str, parts: str, values: Any, units: str, name: str) -> tuple[Any, Any, dict[str, str]]:
        return (axis, parts, "input_angle"), values, {"units": units, "long_name": name}

    variables: dict[str, Any] = {
        "angle": per("shaft", r.angle, "rad", "rotation of the far end"),
        "speed": per("shaft", r.speed, "rad/s", "speed of the far end"),
        "acceleration": per("shaft", r.acceleration, "rad/s^2", "angular acceleration of the far end"),
        "twist": per("shaft", r.twist, "rad", "twist, far end minus near end"),
        "torque": per("shaft", r.torque, "N*m", "torque, positive with the twist"),
        "output_angle": alone(r.output_angle, "rad", "rotation of the output"),
        "output_speed": alone(r.output_speed, "rad/s", "speed of the output"),
        "output_acceleration": alone(r.output_acceleration, "rad/s^2", "angular acceleration of the output"),
        "end_angle": per("branch", r.end_angle, "rad", "rotation of the branch's end"),
        "end_speed": per("branch", r.end_speed, "rad/s", "speed of the branch's end"),
        "end_acceleration": per("branch", r.end_acceleration, "rad/s^2", "angular acceleration of the branch's end"),
        "drive_torque": alone(r.drive_torque, "N*m", "torque the drive supplies"),
        "power_loss": alone(r.power_loss, "W", "power lost in joint friction"),
        "joint_angle": per("joint", r.joint_angle, "rad", "input angle from the joint's own plane"),
        "joint_torque_in": per("joint", r.joint_torque_in, "N*m", "torque transmitted into the joint"),
        "joint_torque_out": per("joint", r.joint_torque_out, "N*m", "torque transmitted out of the joint"),
        "secondary_couple": vector("fork", "standing", r.secondary_couple, "N*m", "couple on the fork, standing frame"),
        "secondary_couple_rotating": vector(
            "fork", "rotating", r.secondary_couple_rotating, "N*m", "couple on the fork, rotating frame"
        ),
    }
    coordinates: dict[str, Any] = {
        "input_angle": ("input_angle", r.input_angle, {"units": "rad", "long_name": "input angle"}),
        "shaft": list(r.shafts),
        "branch": list(r.branches),
        "joint": list(r.joints),
        "fork": list(r.forks),
        "standing": ["u", "v"],
        "rotating": ["arm", "across"],
    }
    if r.supports is not None:
        variables["support_force"] = vector(
            "bearing", "standing", r.supports.force, "N", "force of the shaft on its bearing"
        )
        variables["joint_force"] = (
            ("loaded_joint", "axis", "input_angle"),
            r.supports.joint_force,
            {"units": "N", "long_name": "force of the shaft in front of the joint on the one behind it"},
        )
        coordinates |= {
            "bearing": list(r.supports.names),
            "loaded_joint": list(r.supports.joint_names),
            "axis": ["e", "u", "v"],
        }
    settings = {
        "version": __version__,
        "driveline": dumps(r.line),
        "input_speed": r.input_speed,
        "input_acceleration": r.input_acceleration,
        "output": r.branch,
        "output_torque": r.output_torque,
        "turns": r.turns,
        "rigid": int(r.rigid),
        "inertia": int(r.inertia),
        "irregularity": r.irregularity,
        "equivalent_angle": r.equivalent_angle,
        "homokinetic_deviation": r.homokinetic_deviation,
        "peak_acceleration": r.peak_acceleration,
    }
    return xr.Dataset(variables, coords=coordinates, attrs=settings)
