"""The command ``kinetostatics``: one turn of a transmission as table, pictures and data."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.command_input import CommandInput, NumberBounds, OptionReader
from trunnion.cli.options import Line, Speed, SpeedUnit
from trunnion.cli.places import CommandOutput, write_result
from trunnion.cli.readers import read_quantity
from trunnion.cli.typed import Command
from trunnion.errors import InputError

if TYPE_CHECKING:
    from trunnion.response.kinetostatics import Kinetostatics

SUPPORT_EXAMPLE = 'write "Shaft 1:-300mm:-100mm", positions from the joint in front (first shaft: behind)'


def _torque(asked: CommandInput, text: str, key: str) -> float:
    from trunnion.driveline.quantities import TORQUE

    return read_quantity(text, TORQUE, key)


def _length(asked: CommandInput, text: str, key: str) -> tuple[str, float]:
    """``SHAFT:LENGTH``."""
    from trunnion.driveline.quantities import LENGTH

    name, colon, value = text.rpartition(":")
    if not colon:
        raise InputError("names no length", key=key, value=text, remedy='write "Shaft 2:0.8m"')
    return name, read_quantity(value, LENGTH, key)


def _support(asked: CommandInput, text: str, key: str) -> tuple[object, ...]:
    """``SHAFT:AT`` or ``SHAFT:AT:AT``, read from the right because names may have colons."""
    from trunnion.driveline.quantities import LENGTH

    name, *places = text.rsplit(":", 2)
    if len(places) == 2 and places[0].strip()[:1] not in tuple("+-.0123456789"):
        name, places = f"{name}:{places[0]}", places[1:]
    if not places:
        raise InputError("names no position", key=key, value=text, remedy=SUPPORT_EXAMPLE)
    return name, *(read_quantity(place, LENGTH, key, SUPPORT_EXAMPLE) for place in places)


def _friction(asked: CommandInput, text: str, key: str) -> tn.CrossFriction:
    from trunnion.driveline.quantities import LENGTH, RATIO

    parts = text.split(":")
    if len(parts) != 3:
        raise InputError("is not a friction", key=key, value=text, remedy="write 0.005:12mm:40mm")
    kinds = (RATIO, LENGTH, LENGTH)
    return tn.CrossFriction(*(read_quantity(p, k, key) for p, k in zip(parts, kinds, strict=True)))


Torque = Annotated[float, OptionReader(_torque, "0")]
Friction = Annotated["tn.CrossFriction | None", OptionReader(_friction)]
Supports = Annotated[list[Any] | None, OptionReader(_support, several=True)]
Lengths = Annotated[list[tuple[str, float]] | None, OptionReader(_length, several=True)]


@Command()
def kinetostatics(
    line: Line,
    *,
    speed: Speed,
    elastic: bool = False,
    inertia: bool = False,
    output_torque: Torque,
    branch: str | None = None,
    friction: Friction,
    support: Supports,
    length: Lengths,
    limit: Annotated[float, NumberBounds(0.0)] = 0.0027,
    phase: bool = False,
    pitch: str | None = None,
    turns: Annotated[int | None, NumberBounds(1)] = None,
    points: Annotated[int, NumberBounds(8)] = 720,
    unit: SpeedUnit,
) -> CommandOutput:
    """Example: trunnion kinetostatics truck.toml --support "front tube:1.2m" --elastic -o truck.csv

    --elastic  Let the shafts twist under their torque.
    --inertia  Count the inertia torques of the rigid line.
    --output-torque  Torque at the end of the line or branch, beside its loads: "150 N*m".
    --branch ELEMENT  The output is the end of the branch with this element.
    --friction MU:PIN:ARM  Bearing friction of the crosses, with pin and arm radius: 0.005:12mm:40mm.
    --support SHAFT:AT[:AT]  Bearings: 'Shaft 1:-300mm:-100mm'; repeat it.
    --length SHAFT:LENGTH  Length from joint to joint of a shaft that is not a tube: 'Shaft 2:0.8m'.
    --limit  Largest irregularity of the output that is allowed.
    --phase  Also find the best fork offsets.
    --pitch  Spline pitch for --phase, such as "10 deg".
    --turns  Turns of the input; default: until the motion repeats, at most about 100.
    --points  Points per turn, of the input or of a faster joint.
    """
    result = tn.kinetostatics(
        line, speed, branch=branch, rigid=not elastic, inertia=inertia, output_torque=output_torque, friction=friction,
        supports=support, lengths=dict(length or ()), turns=turns, points=points,
    ).in_unit(unit)  # fmt: skip
    limits = tn.check_limits(result, irregularity=limit)
    phasing = tn.phase_forks(line, pitch, branch=branch) if phase or pitch else None

    def content() -> dict[str, Any]:
        return kinetostatics_json(result) | {
            "phasing": None if phasing is None else _phasing_json(phasing),
            "limits": output.findings_json(limits),
        }

    def more() -> None:
        output.table(result.table(), "Shafts")
        if phasing is not None:
            output.heading("Fork phasing")
            output.say(str(phasing))
        output.findings((*limits, *result.findings), "Limits and findings")

    return CommandOutput(result, files=lambda base: _files(result, base, unit), content=content, more=more)


def kinetostatics_json(result: Kinetostatics) -> dict[str, Any]:
    """The numbers of a turn in SI units; the curves themselves are in the files written."""
    slow, fast = result.speed_ratio
    return {
        **output.record(result, "rigid inertia turns repeats_after"),
        "driveline": result.line.name,
        "speed": result.input_speed,
        "points": len(result.input_angle),
        "speed_ratio": {"smallest": slow, "largest": fast},
        **output.record(result, "irregularity equivalent_angle homokinetic_deviation peak_acceleration efficiency"),
        "branches": list(result.branches),
        "output": result.branch,
        "drive_torque": {"smallest": result.drive_torque.min(), "largest": result.drive_torque.max()},
        "shafts": result.table("rad/s"),
        "secondary_couples": [{"fork": f, **_parts(result.couple_parts(f))} for f in result.forks],
        "supports": [
            {"bearing": b, **_parts(result.support_parts(b))}
            for b in (result.supports.names if result.supports else ())
        ],
        "findings": output.findings_json(result.findings),
    }  # fmt: skip


def _phasing_json(phasing: Any) -> dict[str, Any]:
    return {"fork_offsets": phasing.offsets, **output.record(phasing, "irregularity before bound")}


def _parts(part: Any) -> dict[str, Any]:
    return {
        **output.record(part, "largest steady two_per_turn"),
        "twice_forward": part.twice,
        "twice_backward": part.twice_back,
        "rotating": part.once,
    }


def _files(result: Kinetostatics, base: Path, unit: str) -> list[Path]:
    """Curves, polar curves and data, called ``base``, and a sketch where there is a joint to draw."""
    from trunnion.pictures.draw_matplotlib import draw, save
    from trunnion.pictures.kinetostatics import polar

    endings = (".png", ".csv")
    written = [write_result(base.with_suffix(e), result, lambda: result.plot(unit=unit)) for e in endings]
    pictures = {"polar": draw(polar(result, unit=unit)).figure.figure}
    if result.joints:
        try:
            pictures["sketch"] = tn.sketch(result.line)
        except InputError as error:  # the turn itself is known, whatever cannot be drawn
            output.note(f"no sketch: {error}")
    for name, picture in pictures.items():
        written.append(base.with_name(f"{base.name}-{name}.png"))
        save(picture, written[-1])
    return written
