"""The command ``kinetostatics``: one turn of a transmission as table, pictures and data."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.options import (
    File,
    Json,
    LoadCase,
    Output,
    Speed,
    Unit,
    file_stem,
    read_case,
    read_quantity,
    read_speed,
)
from trunnion.cli.places import DEFAULT_FOLDER, answer, check_places, write_result
from trunnion.errors import InputError

if TYPE_CHECKING:
    from trunnion.response.kinetostatics import Kinetostatics

SUPPORT_EXAMPLE = 'write "Shaft 1:-300mm:-100mm", positions from the joint in front (first shaft: behind)'


def kinetostatics(
    file: File,
    speed: Speed = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    elastic: Annotated[bool, typer.Option("--elastic", help="Let the shafts twist under their torque.")] = False,
    inertia: Annotated[bool, typer.Option("--inertia", help="Count the inertia torques of the rigid line.")] = False,
    torque: Annotated[
        str, typer.Option("--output-torque", help='At the end of the line or branch, beside its loads: "150 N*m".')
    ] = "0",
    branch: Annotated[
        str | None,
        typer.Option("--branch", metavar="ELEMENT", help="The output is the end of the branch with this element."),
    ] = None,
    friction: Annotated[
        str | None,
        typer.Option("--friction", metavar="MU:PIN:ARM", help="Of the crosses: 0.005:12mm:40mm (pin and arm radius)."),
    ] = None,
    support: Annotated[
        list[str] | None,
        typer.Option("--support", metavar="SHAFT:AT[:AT]", help="Bearings: 'Shaft 1:-300mm:-100mm'; repeat it."),
    ] = None,
    length: Annotated[
        list[str] | None,
        typer.Option("--length", metavar="SHAFT:LENGTH", help="Joint to joint, where it is no tube: 'Shaft 2:0.8m'."),
    ] = None,
    irregularity: Annotated[
        float, typer.Option("--limit", help="Irregularity of the output to be kept.", min=0.0)
    ] = 0.0027,
    phase: Annotated[bool, typer.Option("--phase", help="Also find the best fork offsets.")] = False,
    pitch: Annotated[str | None, typer.Option("--pitch", help='Spline pitch for --phase, such as "10 deg".')] = None,
    turns: Annotated[int, typer.Option("--turns", help="Turns of the input.", min=1)] = 1,
    points: Annotated[int, typer.Option("--points", help="Points per turn.", min=8)] = 720,
    to: Output = None,
    as_json: Json = False,
) -> None:
    """Motion, torques, secondary couples and support forces over a turn; fork phasing.

    Example: trunnion kinetostatics truck.toml --support "front tube:1.2m" --elastic -o truck.csv
    """  # fmt: skip
    from trunnion.driveline.quantities import LENGTH, TORQUE

    line, unit = read_case(file, unit, load_case)
    at = read_speed(speed, unit)
    check_places(to)
    result = tn.kinetostatics(
        line,
        at,
        branch=branch,
        rigid=not elastic,
        inertia=inertia,
        output_torque=read_quantity(torque, TORQUE, "--output-torque"),
        friction=_friction(friction),
        supports=[_support(text) for text in support] if support else None,
        lengths={name: read_quantity(x, LENGTH, "--length") for name, x in map(_named, length or [])},
        turns=turns,
        points=points,
    ).in_unit(unit)
    limits = tn.check_limits(result, irregularity=irregularity)
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

    def draw() -> Any:
        return result.plot(unit=unit)

    written = [write_result(path, result, draw) for path in to] if to else _files(result, file_stem(file), unit, draw)
    answer("kinetostatics", written, as_json, content, result.__str__, more)


def kinetostatics_json(result: Kinetostatics) -> dict[str, Any]:
    """The numbers of a turn in SI units; the curves themselves are in the files written."""
    slow, fast = result.speed_ratio
    return {
        **output.record(result, "rigid inertia turns"),
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


def _files(result: Kinetostatics, stem: str, unit: str, draw: Callable[[], Any]) -> list[Path]:
    """Curves, polar curves and data in the default folder, and a sketch where there is a joint to draw."""
    from trunnion.plots.kinetostatics import draw_polar
    from trunnion.plots.style import save
    from trunnion.writing import folder_written_whole

    with folder_written_whole(DEFAULT_FOLDER) as temporary:
        base = temporary / f"{stem}-kinetostatics"
        written = [
            write_result(base.with_suffix(ending), result, lambda: result.plot(unit=unit))
            for ending in (".png", ".csv")
        ]
        pictures = {"polar": draw_polar(result, unit=unit)}
        if result.joints:
            try:
                pictures["sketch"] = tn.sketch(result.line)
            except InputError as error:  # the turn itself is known, whatever cannot be drawn
                output.note(f"no sketch: {error}")
        for name, picture in pictures.items():
            path = base.with_name(f"{base.name}-{name}.png")
            save(picture, path)
            written.append(path)
    return [DEFAULT_FOLDER / path.name for path in written]


def _named(text: str) -> tuple[str, str]:
    name, colon, value = text.rpartition(":")
    if not colon:
        raise InputError("names no length", key="--length", value=text, remedy='write "Shaft 2:0.8m"')
    return name, value


def _support(text: str) -> tuple[object, ...]:
    """``SHAFT:AT`` or ``SHAFT:AT:AT``, read from the right because names may have colons."""
    from trunnion.driveline.quantities import LENGTH

    name, *places = text.rsplit(":", 2)
    if len(places) == 2 and not _reads(places[0]):
        name, places = f"{name}:{places[0]}", places[1:]
    if not places:
        raise InputError("names no position", key="--support", value=text, remedy=SUPPORT_EXAMPLE)
    return name, *(read_quantity(place, LENGTH, "--support", SUPPORT_EXAMPLE) for place in places)


def _reads(text: str) -> bool:
    """Whether a piece of text begins like a number."""
    return text.strip()[:1] in tuple("+-.0123456789")


def _friction(text: str | None) -> tn.CrossFriction | None:
    if text is None:
        return None
    from trunnion.driveline.quantities import LENGTH, RATIO

    parts = text.split(":")
    if len(parts) != 3:
        raise InputError("is not a friction", key="--friction", value=text, remedy="write 0.005:12mm:40mm")
    kinds = (RATIO, LENGTH, LENGTH)
    return tn.CrossFriction(*(read_quantity(p, k, "--friction") for p, k in zip(parts, kinds, strict=True)))
