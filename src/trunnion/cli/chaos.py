"""The commands about long motions: lyapunov-spectrum, poincare-map, certify-chaos."""

from __future__ import annotations

from typing import Annotated, Final

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.motion import START, Set, Tolerance
from trunnion.cli.options import (
    Json,
    LoadCase,
    OutputNoTable,
    Speed,
    Unit,
    Within,
    only_for_lines,
    read_case,
    read_set,
    read_speed,
    read_state,
)
from trunnion.cli.places import PICTURES_AND_DATA, answer, check_places, deliver, write_results
from trunnion.errors import InputError

Subject = Annotated[
    str,
    typer.Argument(
        metavar="FILE",
        help="Driveline file, name of the catalogue, reference system (ueda, …), or double-tripod[:output].",
    ),
]
Periods = Annotated[int | None, typer.Option("--periods", help="Forcing periods to average over.", min=1)]
Duration = Annotated[float | None, typer.Option("--duration", help="Instead of periods [s].")]
Starts = Annotated[int, typer.Option("--starts", help="Motions to follow and compare.", min=1)]
Transient = Annotated[int | None, typer.Option("--transient", help="Periods to let pass before; default 500.", min=0)]
Section = Annotated[
    str | None,
    typer.Option("--section", metavar="STATE=LEVEL[:-]", help='Crossings upwards, or downwards with ":-".'),
]
TRIPOD: Final = "double-tripod"


def lyapunov_spectrum(
    file: Subject,
    periods: Periods = None,
    duration: Duration = None,
    speed: Speed = None,
    start: START = None,
    starts: Starts = 2,
    transient: Transient = None,
    parameters: Set = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    tolerance: Tolerance = 1e-10,
    to: OutputNoTable = None,
    as_json: Json = False,
) -> None:
    """Lyapunov exponents with intervals of confidence, and the sum rule.

    Example: trunnion lyapunov-spectrum ueda --set force=7.5
    """
    system = _subject(file, parameters, speed, unit, load_case)
    check_places(to, PICTURES_AND_DATA)
    with output.progress("exponents") as advance:
        result = tn.lyapunov_spectrum(
            system, periods, duration=duration, start=read_state(start), starts=starts, transient=transient,
            tolerance=tolerance, progress=advance,
        )  # fmt: skip
    content = {
        "system": system.name,
        "exponents": result.exponents,
        "half_width": result.half_width,
        "sum": result.sum,
        "divergence": result.divergence,
        "dimension": result.dimension,
        "samples": result.samples,
        "interval": result.interval,
        "by_start": result.by_start,
        "outcome": result.outcome.kind,
        "says": str(result.outcome),
    }
    written = deliver("lyapunov-spectrum", _stem(file), result, to, as_json, what="exponents", content=lambda: content)
    output.finish(result.outcome, written)


def poincare_map(
    file: Subject,
    points: Annotated[int, typer.Option("--points", help="Points of the map.", min=1)] = 2000,
    section: Section = None,
    every: Annotated[float | None, typer.Option("--every", help="Time between points [s].")] = None,
    speed: Speed = None,
    start: START = None,
    transient: Transient = None,
    parameters: Set = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    tolerance: Tolerance = 1e-10,
    to: OutputNoTable = None,
    as_json: Json = False,
) -> None:
    """Points of a settled motion, once per forcing period or on a section.

    Example: trunnion poincare-map rossler --section y=0 -o map.png
    """
    system = _subject(file, parameters, speed, unit, load_case)
    check_places(to, PICTURES_AND_DATA)
    with output.progress("Poincaré map"):
        result = tn.poincare_map(
            system, points, section=_section(section), every=every, start=read_state(start),
            transient=500 if transient is None else transient, tolerance=tolerance,
        )  # fmt: skip
    written = write_results(to, _stem(file), "map", result, result.plot)
    if not as_json:
        output.finish(result.outcome, written)
    content = {
        "system": system.name,
        "section": result.section,
        "points": len(result.points),
        "repeat": result.repeat,
        "settling": result.settling,
        "states": dict(zip(system.states, result.points.T, strict=True)),
        "outcome": result.outcome.kind,
        "says": str(result.outcome),
    }
    answer("poincare-map", written, as_json, lambda: content, result.__str__)
    output.finish(result.outcome, written)


def certify_chaos(
    file: Subject,
    periods: Periods = None,
    duration: Duration = None,
    section: Section = None,
    speed: Speed = None,
    start: START = None,
    starts: Starts = 2,
    transient: Transient = None,
    parameters: Set = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    sweep: Annotated[
        str | None, typer.Option("--sweep", metavar="NAME:LOW:HIGH:N", help="Exponents over this in the figure.")
    ] = None,
    tolerance: Tolerance = 1e-10,
    to: OutputNoTable = None,
    within: Within = None,
    as_json: Json = False,
) -> None:
    """Regular, chaotic, unbounded or undecided, with reasons and one figure.

    Example: trunnion certify-chaos driven-pendulum --set force=2.5 -o pendulum.png
    """
    system = _subject(file, parameters, speed, unit, load_case)
    check_places(to, PICTURES_AND_DATA)
    with output.progress("exponents, map and sweep", within) as advance:
        result = tn.certify_chaos(
            system, periods, duration=duration, section=_section(section), start=read_state(start), starts=starts,
            transient=transient, sweep=_sweep(sweep), tolerance=tolerance, progress=advance,
        )  # fmt: skip
    content = {
        "system": system.name,
        "verdict": str(result.verdict),
        "kind": result.kind,
        "repeat": result.repeat,
        "period": result.period,
        "reasons": list(result.reasons),
        "criteria": [vars(c) for c in result.criteria],
        "exponents": result.spectrum.exponents,
        "half_width": result.spectrum.half_width,
        "zero_one_test": None if result.zero_one is None else result.zero_one.k,
    }
    deliver("certify-chaos", _stem(file), result, to, as_json, what="certificate", content=lambda: content)


def _subject(
    file: str, parameters: list[str] | None, speed: str | None, unit: str | None, load_case: str | None
) -> tn.System:
    """The system that FILE names, with parameters set."""
    from trunnion.motion.chaos.chaos_subject import as_system
    from trunnion.systems.reference import SYSTEMS

    name, _, part = file.partition(":")
    if name == TRIPOD or file in SYSTEMS:
        only_for_lines("use --set for a system", {"--speed": speed, "--load-case": load_case})
        system = tn.catalogue(TRIPOD).system(part or "input") if name == TRIPOD else SYSTEMS[file]()
    else:
        line, unit = read_case(file, unit, load_case, (*SYSTEMS, TRIPOD))
        system = as_system(line, read_speed(speed, unit))
    return system.with_parameters(read_set(parameters))


def _section(text: str | None) -> tn.Event | None:
    if text is None:
        return None
    state, _, rest = text.partition("=")
    level, _, sign = rest.partition(":")
    try:
        if sign not in ("", "+", "-"):
            raise ValueError
        return tn.Event(state.strip(), float(level), direction=-1 if sign == "-" else 1)
    except ValueError:
        raise InputError("is not STATE=LEVEL", key="--section", value=text, remedy='write "z=27" or "z=27:-"') from None


def _sweep(text: str | None) -> tuple[str, float, float, int] | bool:
    if text is None:
        return True
    parts = text.rsplit(":", 3)
    try:
        return parts[0], float(parts[1]), float(parts[2]), int(parts[3])
    except (ValueError, IndexError):
        raise InputError(
            "is not NAME:LOW:HIGH:N", key="--sweep", value=text, remedy='write "frequency:0.9:1.1:25"'
        ) from None


def _stem(file: str) -> str:
    """``double-tripod:output`` in the names of files."""
    return file.replace(":", "-")
