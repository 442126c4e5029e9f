"""The commands about long motions: lyapunov-spectrum, poincare-map, certify-chaos."""

from __future__ import annotations

from typing import Annotated, Any, Final

import typer

import trunnion as tn
from trunnion.cli.command_input import CommandInput, CommandSubject, NumberBounds, OptionReader, Texts
from trunnion.cli.motion import Tolerance
from trunnion.cli.options import SPEED, LoadCase, Progress, Set, Start, Unit
from trunnion.cli.places import PICTURES_AND_DATA, CommandOutput
from trunnion.cli.readers import loaded_line, only_for_lines, read_set, read_speed
from trunnion.cli.typed import Command
from trunnion.errors import InputError

TRIPOD: Final = "double-tripod"


def _system(file: str, texts: Texts) -> CommandInput:
    """The system that FILE names, with parameters set."""
    from trunnion.motion.chaos.chaos_subject import as_system
    from trunnion.systems.reference import SYSTEMS

    name, _, part = file.partition(":")
    speed, called = texts["speed"], file.replace(":", "-")
    if name == TRIPOD or file in SYSTEMS:
        only_for_lines("use --set for a system", {"--speed": speed, "--load-case": texts["load_case"]})
        system: tn.System = tn.catalogue(TRIPOD).system(part or "input") if name == TRIPOD else SYSTEMS[file]()
    else:
        asked = loaded_line(file, texts, (*SYSTEMS, TRIPOD))
        system = as_system(asked.line, None if speed is None else read_speed(asked, speed, "--speed"))
    return CommandInput(system.with_parameters(read_set(texts["parameters"])), called, "", texts)


def _section(asked: CommandInput, text: str, key: str) -> tn.Event:
    state, _, rest = text.partition("=")
    level, _, sign = rest.partition(":")
    try:
        if sign not in ("", "+", "-"):
            raise ValueError
        return tn.Event(state.strip(), float(level), direction=-1 if sign == "-" else 1)
    except ValueError:
        raise InputError("is not STATE=LEVEL", key=key, value=text, remedy='write "z=27" or "z=27:-"') from None


def _swept(asked: CommandInput, text: str, key: str) -> tuple[str, float, float, int]:
    parts = text.rsplit(":", 3)
    try:
        return parts[0], float(parts[1]), float(parts[2]), int(parts[3])
    except (ValueError, IndexError):
        remedy = 'write "frequency:0.9:1.1:25"'
        raise InputError("is not NAME:LOW:HIGH:N", key=key, value=text, remedy=remedy) from None


System = Annotated[
    "tn.System",
    typer.Argument(
        metavar="FILE",
        help="Driveline file, name of the catalogue, reference system (ueda, …), or double-tripod[:output].",
    ),
    CommandSubject(
        _system,
        {"speed": Annotated[str | None, SPEED], "parameters": Set, "unit": Unit, "load_case": LoadCase},
    ),
]
Periods = Annotated[int | None, typer.Option("--periods", help="Forcing periods to average over.", min=1)]
Duration = Annotated[float | None, typer.Option("--duration", help="Time to average over, instead of periods [s].")]
Starts = Annotated[int, typer.Option("--starts", help="Motions to follow and compare.", min=1)]
Transient = Annotated[int | None, typer.Option("--transient", help="Periods to let pass before; default: 500.", min=0)]
Section = Annotated[
    "tn.Event | None",
    typer.Option("--section", metavar="STATE=LEVEL[:-]", help='Crossings upwards, or downwards with ":-".'),
    OptionReader(_section),
]


@Command("exponents", writes=PICTURES_AND_DATA, part="exponents")
def lyapunov_spectrum(
    system: System,
    *,
    periods: Periods = None,
    duration: Duration = None,
    start: Start,
    starts: Starts = 2,
    transient: Transient = None,
    tolerance: Tolerance = 1e-10,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion lyapunov-spectrum ueda --set force=7.5"""
    result = tn.lyapunov_spectrum(
        system, periods, duration=duration, start=start, starts=starts, transient=transient, tolerance=tolerance,
        progress=progress,
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
        **_ending(result),
    }
    return CommandOutput(result, content=lambda: content, outcome=result.outcome)


@Command("Poincaré map", writes=PICTURES_AND_DATA, part="map")
def poincare_map(
    system: System,
    *,
    points: Annotated[int, NumberBounds(1)] = 2000,
    section: Section,
    every: float | None = None,
    start: Start,
    transient: Transient = None,
    tolerance: Tolerance = 1e-10,
) -> CommandOutput:
    """Example: trunnion poincare-map rossler --section y=0 -o map.png

    --points  Points of the map.
    --every  Time between points [s].
    """
    result = tn.poincare_map(
        system, points, section=section, every=every, start=start, transient=500 if transient is None else transient,
        tolerance=tolerance,
    )  # fmt: skip
    content = {
        "system": system.name,
        "section": result.section,
        "points": len(result.points),
        "repeat": result.repeat,
        "settling": result.settling,
        "states": dict(zip(system.states, result.points.T, strict=True)),
        **_ending(result),
    }
    return CommandOutput(result, content=lambda: content, outcome=result.outcome, alone=True)


@Command("exponents, map and sweep", writes=PICTURES_AND_DATA, part="certificate", within=True)
def certify_chaos(
    system: System,
    *,
    periods: Periods = None,
    duration: Duration = None,
    section: Section,
    start: Start,
    starts: Starts = 2,
    transient: Transient = None,
    sweep: Annotated[tuple[str, float, float, int] | bool, OptionReader(_swept, missing=lambda asked: True)],
    tolerance: Tolerance = 1e-10,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion certify-chaos driven-pendulum --set force=2.5 -o pendulum.png

    --sweep NAME:LOW:HIGH:N  Parameter over which the figure shows the exponents.
    """
    result = tn.certify_chaos(
        system, periods, duration=duration, section=section, start=start, starts=starts, transient=transient,
        sweep=sweep, tolerance=tolerance, progress=progress,
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
    return CommandOutput(result, content=lambda: content)


def _ending(result: Any) -> dict[str, Any]:
    return {"outcome": result.outcome.kind, "says": str(result.outcome)}
