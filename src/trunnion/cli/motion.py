"""The commands about nonlinear motion: simulate, periodic-response, linearity-check, run-up."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
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
    Within,
    only_for_lines,
    read_case,
    read_quantity,
    read_set,
    read_speed,
    read_state,
    read_stated_speed,
    read_time,
)
from trunnion.cli.places import check_places, deliver
from trunnion.errors import InputError

if TYPE_CHECKING:
    from trunnion.motion.orbits.periodic_response import PeriodicResponse
    from trunnion.motion.passing.run_up import RunUp
    from trunnion.steady.shooting.periodic_orbit import PeriodicOrbit

Subject = Annotated[
    str, typer.Argument(metavar="FILE", help="Driveline file, a name of the catalogue, or a reference system.")
]
Tolerance = Annotated[float, typer.Option("--tolerance", help="Error allowed per step.", min=1e-15, max=0.1)]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="Parameter of a reference system; repeat it for more."),
]
START = Annotated[str | None, typer.Option("--start", metavar="X,Y,…", help="State to start from.")]


def simulate(
    file: Subject,
    speed: Speed = None,
    to_speed: Annotated[str | None, typer.Option("--to-speed", help="Speed at the end, reached evenly.")] = None,
    turns: Annotated[float | None, typer.Option("--turns", help="Turns of the input; default 20.")] = None,
    duration: Annotated[float | None, typer.Option("--duration", metavar="SECONDS", help="Instead of turns.")] = None,
    start: START = None,
    parameters: Set = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    tolerance: Tolerance = 1e-10,
    to: Output = None,
    as_json: Json = False,
) -> None:
    """A motion in time, of a driveline or of a reference system (duffing, lorenz, …).

    Example: trunnion simulate truck.toml --turns 200 -o truck.png -o truck.nc
    """
    with output.progress("motion"):
        subject, unit = _subject(file, parameters, unit, load_case, {"--speed": speed, "--to-speed": to_speed})
        if isinstance(subject, tn.Driveline):
            check_places(to)
            profile = _course(subject, read_speed(speed, unit), read_speed(to_speed, unit, "--to-speed"), duration)
            length = None if duration is not None else 20.0 if turns is None else turns
            begin = read_state(start)
            result: Any = tn.simulate(subject, duration, speed=profile, turns=length, start=begin, tolerance=tolerance)
        else:
            only_for_lines("use --duration, in seconds", {"--turns": turns})
            check_places(to)
            seconds = 100.0 if duration is None else duration
            result = tn.simulate(subject, seconds, start=read_state(start), tolerance=tolerance)
    text = partial(result.describe, unit) if isinstance(subject, tn.Driveline) else None
    written = deliver(
        "simulate", file, result, to, as_json, what="motion", draw=_draw(subject, result, unit), text=text,
        content=lambda: _simulation_json(result),
    )  # fmt: skip
    output.finish(result.outcome, written)


def periodic_response(
    file: Subject,
    speed: Speed = None,
    periods: Annotated[int, typer.Option("--periods", help="Of the excitation in one of the motion.", min=1)] = 1,
    period: Annotated[
        str | None, typer.Option("--period", help='Guess for a system without excitation: "1.5 s", or a number in s.')
    ] = None,
    start: START = None,
    parameters: Set = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    to: Output = None,
    as_json: Json = False,
) -> None:
    """The true periodic motion, its torques, orders and stability, beside what linear theory says.

    Example: trunnion periodic-response truck.toml --load-case climb --speed "1500 rpm"
    """
    with output.progress("periodic response"):
        subject, unit = _subject(file, parameters, unit, load_case, {"--speed": speed})
        if isinstance(subject, tn.Driveline):
            if period is not None:
                remedy = "leave it out; the speed of a driveline gives it"
                raise InputError("belongs to reference systems", key="--period", value=period, remedy=remedy)
            check_places(to)
            at = read_speed(speed, unit)
            result: Any = tn.periodic_response(subject, at, start=read_state(start), periods=periods)
        else:
            guess = read_time(period, "--period")
            check_places(to)
            result = tn.periodic_response(subject, start=read_state(start), period=guess, periods=periods)
    result.outcome.require()
    if isinstance(subject, tn.Driveline):
        shown: dict[str, Any] = {
            "content": lambda: _orbit_json(result) | _response_json(result),
            "text": lambda: result.describe(unit),
            "more": lambda: _print_orders(result, unit),
        }
    else:
        shown = {"content": lambda: _orbit_json(result)}
    deliver("periodic-response", file, result, to, as_json, draw=_draw(subject, result, unit), **shown)


def linearity_check(
    file: File,
    speed: Speed = None,
    allowed: Annotated[
        float, typer.Option("--allowed", help="Difference up to which linear theory holds, of the largest order.")
    ] = 0.05,
    acceleration: Annotated[
        float | None, typer.Option("--acceleration", help="Also run through the speed, in rad/s².")
    ] = None,
    spring: Annotated[
        str | None, typer.Option("--spring", help="Shaft or mesh to draw; default: where the two differ most.")
    ] = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    to: Output = None,
    as_json: Json = False,
) -> None:
    """How far linear theory holds at a speed: order-response beside periodic-response, and what misleads it.

    Example: trunnion linearity-check truck.toml --load-case climb --speed "1500 rpm" --acceleration 20
    """
    line, unit = read_case(file, unit, load_case)
    check_places(to)
    with output.progress("linearity check"):
        found = tn.linearity_check(line, read_speed(speed, unit), allowed=allowed, acceleration=acceleration)
    found.nonlinear.outcome.require()
    deliver(
        "linearity-check", file, found, to, as_json,
        draw=lambda: found.plot(spring=spring, unit=unit), text=lambda: found.describe(unit),
    )  # fmt: skip


def run_up(
    file: File,
    first: Annotated[str | None, typer.Option("--from", help="First speed; default: of the file's range.")] = None,
    last: Annotated[str | None, typer.Option("--to", help="Last speed; default: of the file's range.")] = None,
    acceleration: Annotated[
        str, typer.Option("--acceleration", "-a", help="Per second, as a speed: 100rpm.")
    ] = "100 rpm",
    ramp: Annotated[
        float | None,
        typer.Option("--ramp", help="Seconds over which it sets in; default: three periods of the slowest mode."),
    ] = None,
    limit: Annotated[str | None, typer.Option("--limit", help='Torque to be kept by every shaft: "2 kN*m".')] = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    to: Output = None,
    within: Within = None,
    as_json: Json = False,
) -> None:
    """Passage through resonance at an acceleration that sets in smoothly, against the steady response.

    Example: trunnion run-up truck.toml --from 300rpm --to 2400rpm --acceleration 100rpm --limit "2 kN*m"
    """
    line, unit = read_case(file, unit, load_case)
    low, high = _range(line, read_speed(first, unit, "--from"), read_speed(last, unit, "--to"))
    rate = read_stated_speed(acceleration, unit, "--acceleration")
    torque = None if limit is None else _torque(limit)
    check_places(to)
    safe = None
    with output.progress("run-up", within):
        result = tn.run_up(line, low, high, acceleration=rate, ramp=ramp)
        if torque is not None:
            tried = (rate / 4, rate * 4)
            safe = tn.safe_accelerations(line, low, high, limit=torque, accelerations=tried, points=9, ramp=ramp)
    content, said = _run_up_json(result, unit), result.describe(unit)
    if safe is not None:
        content["safe_accelerations"] = {
            "slowest": safe.slowest,
            "fastest": safe.fastest,
            "tried": [
                {"acceleration": one.acceleration, "outcome": one.kind, "share_of_limit": one.share, "safe": one.safe}
                for one in safe.trials
            ],
            "says": safe.describe(unit),
        }
        said += f"\n  {safe.describe(unit)}"
    written = deliver(
        "run-up", file, result, to, as_json,
        draw=lambda: result.plot(unit=unit), content=lambda: content, text=lambda: said,
    )  # fmt: skip
    output.finish(result.outcome, written)


def _subject(
    file: str, parameters: list[str] | None, unit: str | None, load_case: str | None, of_lines: dict[str, str | None]
) -> tuple[tn.System | tn.Driveline, str]:
    """The reference system that FILE names, with ``--set`` applied, or a driveline; and the unit of its speeds."""
    from trunnion.systems.reference import SYSTEMS

    if file in SYSTEMS:
        system = tn.reference_system(file, **read_set(parameters))
        only_for_lines("use --set for a reference system", {**of_lines, "--load-case": load_case})
        return system, unit or "rad/s"
    if parameters:
        remedy = f"edit the file instead; reference systems are: {', '.join(SYSTEMS)}"
        raise InputError("belongs to reference systems", key="--set", value=parameters[0], remedy=remedy)
    return read_case(file, unit, load_case, SYSTEMS)


def _draw(subject: object, result: Any, unit: str) -> Callable[[], Any]:
    """How a motion is drawn: of a driveline in the unit of its speeds."""
    return partial(result.plot, unit=unit) if isinstance(subject, tn.Driveline) else result.plot


def _course(line: tn.Driveline, first: float | None, last: float | None, duration: float | None) -> Any:
    """The speed, or a profile to the speed at the end."""
    from trunnion.driveline.operating_speed import operating_speed

    if last is None:
        return first
    if duration is None:
        raise InputError("is missing beside --to-speed", key="--duration", remedy="write --duration 10, in seconds")
    return tn.SpeedProfile([0.0, duration], [operating_speed(line, first), last])


def _torque(text: str) -> float:
    """A positive torque [N m] written at ``--limit``, refused before anything is computed."""
    from trunnion.driveline.quantities import TORQUE

    torque = read_quantity(text, TORQUE, "--limit")
    if not torque > 0:
        raise InputError("must be a positive torque", key="--limit", value=text)
    return torque


def _range(line: tn.Driveline, first: float | None, last: float | None) -> tuple[float, float]:
    from trunnion.reporting.ranges import speed_range

    if first is not None and last is not None:
        return first, last
    low, high = speed_range(line)
    return first or low, last or high


def _print_orders(result: PeriodicResponse, unit: str) -> None:
    orders, amplitude = result.order_spectrum()
    rows = [
        {"order": float(order), **{f"{s} [N m]": float(a) for s, a in zip(result.shafts, row, strict=True)}}
        for order, row in zip(orders, amplitude, strict=True)
        if row.max() > 1e-3 * amplitude[1:].max(initial=0.0)
    ]
    output.table(rows, "Orders: torque amplitude by cycles per turn of the input (0 is the mean)")
    output.findings(result.findings_in(unit))


def _simulation_json(result: Any) -> dict[str, Any]:
    from trunnion.motion.simulation.simulation import LineSimulation

    content = {
        "outcome": result.outcome.kind,
        "says": str(result.outcome),
        "end": result.end,
        "final_state": result.final,
    }
    if isinstance(result, LineSimulation):
        extremes = result.torque_extremes
        content |= {"turns": result.turns, "first_speed": result.input_speed[0], "last_speed": result.input_speed[-1]}
        if result.starts_free and len(result.whole.turns[1]):
            content |= {"first_speed": result.whole.turns[1][0], "last_speed": result.whole.last_turn()[1]}
        content["shafts"] = [
            {"name": name, "smallest_torque": low, "largest_torque": high}
            for name, low, high in zip(result.shafts, extremes.low, extremes.high, strict=True)
        ]
    return content


def _orbit_json(result: PeriodicResponse | PeriodicOrbit) -> dict[str, Any]:
    return {
        "verdict": str(result.verdict),
        "period": result.period,
        "spectral_radius": result.spectral_radius,
        "error_estimate": result.error_estimate,
        "growth_rate": result.growth_rate,
        "multipliers": list(map(complex, result.multipliers)),
        "says": str(result.outcome),
        "written": (),  # its place; the answer fills it
    }


def _response_json(result: PeriodicResponse) -> dict[str, Any]:
    orders, amplitude = result.order_spectrum()
    return {
        "speed": result.speed,
        "turns": result.turns,
        "shafts": [
            {"name": name, "mean_torque": mean, "torque_peak_to_peak": peak}
            for name, mean, peak in zip(result.shafts, result.torque_mean, result.torque_peak_to_peak, strict=True)
        ],
        "orders": orders,
        "order_amplitude": amplitude,
        "linear_theory": str(result.comparison or result.no_comparison),
        "findings": output.findings_json(result.findings),
    }


def _run_up_json(result: RunUp, unit: str) -> dict[str, Any]:
    ending = result.ending
    return {
        "outcome": result.outcome.kind,
        "says": str(result.outcome_in(unit)),
        "acceleration": result.acceleration,
        "ramp": result.ramp,
        "end": result.simulation.end,
        "end_speed": ending.speed if ending else result.schedule.last,
        "hung": {"speed": ending.hanging.speed, "since": ending.hanging.since, "until": ending.hanging.until}
        if ending and ending.hanging
        else None,
        "shafts": [
            {
                "name": name,
                "peak_torque": result.peak_torque[i],
                "peak_speed": result.peak_speed[i],
                "inertia_torque": result.inertia_torque[i],
                "peak_vibration": result.peak_vibration[i],
                "vibration_speed": result.vibration_speed[i],
                "largest_steady_torque": result.steady_peak[i],
                "largest_steady_vibration": result.steady_vibration[i],
            }
            for i, name in enumerate(result.shafts)
        ],
    }
