"""What files of other programs cannot hold of a line: refused by name, with what to do instead."""

from __future__ import annotations

from trunnion.driveline.couplings import Coupling
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.features import FEATURES, RATINGS, UNEVEN
from trunnion.driveline.joints import Joint
from trunnion.driveline.operation import Operation
from trunnion.driveline.shafts import SpringElement
from trunnion.errors import InputError

HELD = (
    "inertia", "stiffness", "viscous damper", "tuned damper", "tube inertia", "bending stiffness", "damping",
    "loss factor", "fork offset", "joint plane", "angle of an ideal joint", "double Cardan joint", "ratio", "belt",
    "tyre", "vehicle", "rolling resistance", "planetary set", "closed loop", "gear mesh", "mesh damping",
    "damping in contact only", "load torque", "viscous load", "unlike damping in series", "branch", "free start",
    "prescribed far end",
)  # fmt: skip
"""Features of a line that a table of inertias, springs and gears holds, or that cannot matter there: damping in
contact only goes with backlash and stages."""
_LINEAR = "describe it by a Shaft of one stiffness and damping"
_UNLOADED = "take it away: inertias, springs and gears hold no torque that varies"
REMEDIES = {
    "damping ratio": "write damping at the shafts instead",
    "backlash": "take the backlash away, for the line with its teeth in contact",
    "stages": _LINEAR,
    "dual-mass flywheel": "describe it by two Disks and a Shaft",
    "stiffness over mean torque": "write the one stiffness at its mean torque",
    "temperature of a coupling": "write the stiffness and damping at its temperature",
    "slip clutch": "leave it out, for the line while it sticks",
    "damper without a spring": "write its stiffness, that of the oil at the frequency that matters",
    "slip of a tyre": "leave slip_stiffness, radius, travel_speed and inertia out",
    "drive share": "write the drive's mean torque as a negative load_torque",
    "engine": "describe its throws by Disks and Shafts, without excitation",
    "shafts tied to two others": "describe one way through it by a Ratio",
}
"""What to do about a feature that is refused, where it is not to leave it out."""
_EXCITED = ("excitation", "cylinders")


def _angle(joint: Joint) -> float:
    """Its bend [rad]."""
    return float(getattr(joint, "angle", 0.0))


def refuse_unheld(line: Driveline) -> None:
    """Refuse everything at once that no file of another program holds.

    Raises
    ------
    InputError : names each.
    """
    wrong = [
        InputError(
            "is bent, and such a file holds straight joints only", element=name, key="angle", value=_angle(element),
            remedy="write angle = 0, for the line with straight joints",
        )
        for name, element in line.parts
        if isinstance(element, Joint) and element.orders and _angle(element)
    ]  # fmt: skip
    wrong += [
        InputError(
            "is a loss at every frequency, and such a file holds a damping", element=name,
            key="relative_damping" if element.loss_factor is None else "loss_factor", value=element.loss,
            remedy="write loss_factor_frequency, at which it becomes one",
        )
        for name, element in line.parts
        if isinstance(element, SpringElement) and element.loss is not None and element.loss_factor_frequency is None
    ]  # fmt: skip
    for one in FEATURES:
        if one.key in HELD or one.key in UNEVEN:
            continue
        for place in one.places(line):
            element, _, key = place.rpartition(".")
            usual = _UNLOADED if one.key.startswith(_EXCITED) else "leave it out"
            wrong.append(
                InputError(
                    f"cannot be written to such a file ({one.key})", element=element, key=key,
                    remedy=REMEDIES.get(one.key, usual),
                )
            )  # fmt: skip
    wrong += schedules_refused(line)
    if wrong:
        raise InputError.together(wrong)


def schedules_refused(line: Driveline) -> list[InputError]:
    """A refusal of every schedule: a file holds one line, not a course of its numbers."""
    return [
        InputError(
            "cannot be written to such a file", element="schedule", key=schedule.name,
            remedy=f"write the angles of one travel at the joints and leave the schedule out of the file; in Python "
            f"line.at_schedule({schedule.name!r}, …) is such a line",
        )
        for schedule in (line.operation.schedules if line.operation else ())
    ]  # fmt: skip


def not_written(line: Driveline) -> tuple[str, ...]:
    """What else the description says and the file does not: what judges a line, not what moves it."""
    operation = line.operation or Operation()
    rated = (key.split(".") for key in RATINGS)
    found = {
        "ratings": [key for kind, key in rated for _, one in line.parts if one.kind == kind and getattr(one, key)],
        "limits": line.limits,
        "S–N curves": line.sn_curves,
        "tolerances": line.tolerances,
        "scenarios": line.scenarios,
        "load cases": operation.load_cases,
        "the speed range": operation.speed_range,
        "the angle range": operation.angle_range,
        "the application": operation.application,
        "rules switched off": operation.switched_off,
        "the operating time": operation.life,
        "duty": operation.duty,
        "passages": operation.passages,
        "what couplings are cooled by": [
            name for name, one in line.parts if isinstance(one, Coupling) and one.thermal_resistance
        ],
        "cylinders out of work": operation.misfiring or operation.cut_out,
        "component sheets": [name for name, one in line.parts if one.sheet],
        "the title block": line.document,
    }
    return tuple(key for key, value in found.items() if value)
