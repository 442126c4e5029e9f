"""The command ``kinetostatics``: one turn of a transmission as table, pictures and data."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from trunnion.cli import output
from trunnion.cli.options import (
    File,
    Json,
    LoadCase,
    Output,
    Speed,
    Unit,
    file_stem,
    read_line,
    read_speed,
    read_unit,
)
from trunnion.cli.study import DEFAULT_FOLDER
from trunnion.errors import InputError

if TYPE_CHECKING:
    from trunnion.analyses.kinetostatics import Kinetostatics, Phasing
    from trunnion.analyses.kinetostatics.friction import CrossFriction
    from trunnion.driveline.quantities import Kind
    from trunnion.results.finding import Finding

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
    line = read_line(file, load_case)
    unit = read_unit(line, unit)
    at = read_speed(speed, unit)
    from trunnion.analyses.kinetostatics import check_limits, phase_forks
    from trunnion.analyses.kinetostatics import kinetostatics as compute
    from trunnion.cli.files import check_folder, check_outputs
    from trunnion.driveline.quantities import LENGTH, TORQUE

    if to:
        check_outputs(to)
    else:
        check_folder(DEFAULT_FOLDER)
    result = compute(
        line,
        at,
        branch=branch,
        rigid=not elastic,
        inertia=inertia,
        output_torque=_quantity(torque, TORQUE, "--output-torque"),
        friction=_friction(friction),
        supports=[_support(text) for text in support] if support else None,
        lengths={name: _quantity(x, LENGTH, "--length") for name, x in map(_named, length or [])},
        turns=turns,
        points=points,
    )
    limits = check_limits(result, irregularity=irregularity)
    phasing = phase_forks(line, pitch, branch=branch) if phase or pitch else None
    written = [_write(result, path, unit) for path in to] if to else _files(result, file_stem(file), unit)
    if as_json:
        content = kinetostatics_json(result) | {
            "phasing": None if phasing is None else _phasing_json(phasing),
            "limits": [_finding(f) for f in limits],
            "written": [str(path) for path in written],
        }
        output.write_json("kinetostatics", content)
        return
    _print(result, limits, phasing, written, unit)


def _print(
    result: Kinetostatics,
    limits: tuple[Finding, ...],
    phasing: Phasing | None,
    written: list[Path],
    unit: str,
) -> None:
    from trunnion.cli.report import print_written

    out = output.console()
    out.print(result.describe(unit), soft_wrap=True)
    if result.shafts:
        output.heading(out, "Shafts")
        output.table(out, result.table(unit))
    if phasing is not None:
        output.heading(out, "Fork phasing")
        out.print(str(phasing), soft_wrap=True)
    output.heading(out, "Limits and findings")
    output.findings(out, (*limits, *result.findings))
    print_written(out, written)


def kinetostatics_json(result: Kinetostatics) -> dict[str, Any]:
    """The numbers of a turn in SI units; the curves themselves are in the files written."""
    slow, fast = result.speed_ratio
    return {
        "driveline": result.line.name,
        "speed": result.input_speed,
        "rigid": result.rigid,
        "inertia": result.inertia,
        "turns": result.turns,
        "points": len(result.input_angle),
        "speed_ratio": {"smallest": slow, "largest": fast},
        "irregularity": result.irregularity,
        "equivalent_angle": result.equivalent_angle,
        "homokinetic_deviation": result.homokinetic_deviation,
        "peak_acceleration": result.peak_acceleration,
        "branches": list(result.branches),
        "output": result.branch,
        "drive_torque": {"smallest": result.drive_torque.min(), "largest": result.drive_torque.max()},
        "efficiency": result.efficiency,
        "shafts": result.table("rad/s"),
        "secondary_couples": [{"fork": f, **_parts(result.couple_parts(f))} for f in result.forks],
        "supports": [
            {"bearing": b, **_parts(result.support_parts(b))}
            for b in (result.supports.names if result.supports else ())
        ],
        "findings": [_finding(f) for f in result.findings],
    }  # fmt: skip


def _phasing_json(phasing: Phasing) -> dict[str, Any]:
    return {
        "fork_offsets": phasing.offsets,
        "irregularity": phasing.irregularity,
        "before": phasing.before,
        "bound": phasing.bound,
    }


def _parts(part: Any) -> dict[str, Any]:
    return {
        "largest": part.largest,
        "steady": list(part.steady),
        "two_per_turn": part.two_per_turn,
        "twice_forward": part.twice,
        "twice_backward": part.twice_back,
        "rotating": part.once,
    }


def _finding(finding: Finding) -> dict[str, str]:
    return {"gravity": str(finding.gravity), "sentence": finding.sentence}


def _files(result: Kinetostatics, stem: str, unit: str) -> list[Path]:
    """Curves, polar curves and data in the default folder, and a sketch where there is a joint to draw."""
    from trunnion.plots.kinetostatics import draw_polar
    from trunnion.plots.layout import sketch
    from trunnion.plots.style import save
    from trunnion.writing import folder_written_whole

    with folder_written_whole(DEFAULT_FOLDER) as temporary:
        base = temporary / f"{stem}-kinetostatics"
        written = [_write(result, base.with_suffix(ending), unit) for ending in (".png", ".csv")]
        save(draw_polar(result, unit=unit), polar := base.with_name(f"{base.name}-polar.png"))
        written.append(polar)
        if result.joints:
            try:
                drawing = sketch(result.line)
            except InputError as error:  # the turn itself is known, whatever cannot be drawn
                output.note(f"no sketch: {error}")
            else:
                save(drawing, drawn := base.with_name(f"{base.name}-sketch.png"))
                written.append(drawn)
    return [DEFAULT_FOLDER / path.name for path in written]


def _write(result: Kinetostatics, path: Path, unit: str) -> Path:
    ending = path.suffix.removeprefix(".").lower()
    if ending == "csv":
        result.to_csv(path)
    elif ending == "nc":
        from trunnion.results.files import save_dataset

        save_dataset(result.data, path)
    else:
        from trunnion.plots.style import save

        save(result.plot(unit=unit), path)
    return path


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
    return name, *(_quantity(place, LENGTH, "--support", SUPPORT_EXAMPLE) for place in places)


def _reads(text: str) -> bool:
    """Whether a piece of text begins like a number."""
    return text.strip()[:1] in tuple("+-.0123456789")


def _friction(text: str | None) -> CrossFriction | None:
    if text is None:
        return None
    from trunnion.analyses.kinetostatics import CrossFriction
    from trunnion.driveline.quantities import LENGTH, RATIO

    parts = text.split(":")
    if len(parts) != 3:
        raise InputError("is not a friction", key="--friction", value=text, remedy="write 0.005:12mm:40mm")
    kinds = (RATIO, LENGTH, LENGTH)
    return CrossFriction(*(_quantity(p, k, "--friction") for p, k in zip(parts, kinds, strict=True)))


def _quantity(text: str, kind: Kind, key: str, remedy: str = "") -> float:
    """A number with a unit, or a bare one in SI units."""
    from trunnion.driveline.quantities import parse

    try:
        value: object = float(text)
    except ValueError:
        value = text
    try:
        return parse(value, kind)
    except InputError as error:
        raise InputError(error.problem, key=key, value=text, remedy=remedy or error.remedy) from None
