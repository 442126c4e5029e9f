"""The commands about nonlinear motion: simulate, periodic-response, linearity-check, run-up."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Annotated, Any

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.command_input import CommandInput, CommandSubject, NumberBounds, OptionReader, Texts
from trunnion.cli.options import Line, LoadCase, Set, Speed, SpeedUnit, Start, Unit
from trunnion.cli.places import CommandOutput
from trunnion.cli.readers import (
    loaded_line,
    only_for_lines,
    range_of,
    read_quantity,
    read_set,
    read_speed,
    read_time,
)
from trunnion.cli.typed import Command
from trunnion.errors import InputError

if TYPE_CHECKING:
    from trunnion.motion.orbits.periodic_response import PeriodicResponse
    from trunnion.motion.passing.run_up import RunUp
    from trunnion.motion.passing.safe_accelerations import SafeAccelerations
    from trunnion.steady.shooting.periodic_orbit import PeriodicOrbit


def line_or_system(file: str, texts: Texts) -> CommandInput:
    """The reference system that FILE names, with ``--set`` applied, or a driveline."""
    from trunnion.systems.reference import SYSTEMS

    if file in SYSTEMS:
        system = tn.reference_system(file, **read_set(texts["parameters"]))
        of_lines = {"--speed": texts.get("speed"), "--to-speed": texts.get("to_speed")}
        only_for_lines("use --set for a reference system", {**of_lines, "--load-case": texts["load_case"]})
        return CommandInput(system, file, texts["unit"] or "rad/s", texts)
    if texts["parameters"]:
        remedy = f"edit the file instead; reference systems are: {', '.join(SYSTEMS)}"
        raise InputError("belongs to reference systems", key="--set", value=texts["parameters"][0], remedy=remedy)
    return loaded_line(file, texts, SYSTEMS)


def _period(asked: CommandInput, text: str, key: str) -> float:
    if isinstance(asked.subject, tn.Driveline):
        remedy = "leave it out; the speed of a driveline gives it"
        raise InputError("belongs to reference systems", key=key, value=text, remedy=remedy)
    return read_time(text, key)


def _torque(asked: CommandInput, text: str, key: str) -> float:
    """A positive torque [N m]."""
    from trunnion.driveline.quantities import TORQUE

    torque = read_quantity(text, TORQUE, key)
    if not torque > 0:
        raise InputError("must be a positive torque", key=key, value=text)
    return torque


Subjects = Annotated[
    "tn.System | tn.Driveline",
    typer.Argument(metavar="FILE", help="Driveline file, a name of the catalogue, or a reference system."),
    CommandSubject(line_or_system, {"parameters": Set, "unit": Unit, "load_case": LoadCase}),
]
Tolerance = Annotated[float, typer.Option("--tolerance", help="Error allowed per step.", min=1e-15, max=0.1)]


@Command("motion", part="motion")
def simulate(
    subject: Subjects,
    *,
    speed: Speed,
    to_speed: Annotated[float | None, OptionReader(read_speed)],
    turns: float | None = None,
    duration: float | None = None,
    start: Start,
    tolerance: Tolerance = 1e-10,
) -> CommandOutput:
    """Example: trunnion simulate truck.toml --turns 200 -o truck.png -o truck.nc

    --to-speed  Input speed at the end, reached at a constant acceleration.
    --turns  Turns of the input; default: 20.
    --duration SECONDS  Length of the motion, instead of turns.
    """
    if isinstance(subject, tn.Driveline):
        length = None if duration is not None else 20.0 if turns is None else turns
        course = _course(subject, speed, to_speed, duration)
        found: Any = tn.simulate(subject, duration, speed=course, turns=length, start=start, tolerance=tolerance)
    else:
        only_for_lines("use --duration, in seconds", {"--turns": turns})
        found = tn.simulate(subject, 100.0 if duration is None else duration, start=start, tolerance=tolerance)
    return CommandOutput(found, content=lambda: _simulation_json(found), outcome=found.outcome)


@Command("periodic response")
def periodic_response(
    subject: Subjects,
    *,
    speed: Speed,
    periods: Annotated[int, NumberBounds(1)] = 1,
    period: Annotated[float | None, OptionReader(_period)],
    start: Start,
    unit: SpeedUnit,
) -> CommandOutput:
    """Example: trunnion periodic-response truck.toml --load-case climb --speed "1500 rpm"

    --periods  Periods of the excitation in one period of the motion.
    --period  Guess for a system without excitation: "1.5 s", or a number in s.
    """
    if not isinstance(subject, tn.Driveline):
        orbit: Any = tn.periodic_response(subject, start=start, period=period, periods=periods)
        orbit.outcome.require()
        return CommandOutput(orbit, content=lambda: _orbit_json(orbit))
    found: Any = tn.periodic_response(subject, speed, start=start, periods=periods)
    found.outcome.require()
    return CommandOutput(
        found, content=lambda: _orbit_json(found) | _response_json(found), more=lambda: _print_orders(found, unit)
    )


@Command("linearity check")
def linearity_check(
    line: Line,
    *,
    speed: Speed,
    allowed: float = 0.05,
    acceleration: float | None = None,
    spring: str | None = None,
) -> CommandOutput:
    """Example: trunnion linearity-check truck.toml --load-case climb --speed "1500 rpm" --acceleration 20

    --allowed  Largest difference at which linear theory still holds, relative to the largest order.
    --acceleration  Also run through the speed at this acceleration, in rad/s².
    --spring  Shaft or mesh to draw; default: where the two differ most.
    """
    found = tn.linearity_check(line, speed, allowed=allowed, acceleration=acceleration)
    found.nonlinear.outcome.require()
    return CommandOutput(found, draw=partial(found.plot, spring=spring))


@Command("run-up", within=True)
def run_up(
    line: Line,
    *,
    from_: Annotated[float, OptionReader(read_speed, missing=lambda asked: range_of(asked)[0])],
    to: Annotated[float, OptionReader(read_speed, missing=lambda asked: range_of(asked)[1])],
    acceleration: Annotated[float, OptionReader(read_speed, "100 rpm")],
    ramp: float | None = None,
    limit: Annotated[float | None, OptionReader(_torque)],
    unit: SpeedUnit,
) -> CommandOutput:
    """Example: trunnion run-up truck.toml --from 300rpm --to 2400rpm --acceleration 100rpm --limit "2 kN*m"

    --from  First speed; default: of the file's range.
    --to  Last speed; default: of the file's range.
    --acceleration, -a  Change of the input speed in a second: 100rpm.
    --ramp  Seconds over which it sets in; default: three periods of the slowest mode.
    --limit  Largest torque allowed in every shaft: "2 kN*m".
    """
    found = tn.run_up(line, from_, to, acceleration=acceleration, ramp=ramp)
    content, said = _run_up_json(found, unit), found.describe(unit)
    if limit is not None:
        tried = (acceleration / 4, acceleration * 4)
        safe = tn.safe_accelerations(line, from_, to, limit=limit, accelerations=tried, points=9, ramp=ramp)
        content["safe_accelerations"] = _safe_json(safe, unit)
        said += f"\n  {safe.describe(unit)}"
    return CommandOutput(found, content=lambda: content, text=lambda: said, outcome=found.outcome)


def _course(line: tn.Driveline, first: float | None, last: float | None, duration: float | None) -> Any:
    """The speed, or a profile to the speed at the end."""
    from trunnion.driveline.operating_speed import operating_speed

    if last is None:
        return first
    if duration is None:
        raise InputError("is needed with --to-speed", key="--duration", remedy="write --duration 10, in seconds")
    return tn.SpeedProfile([0.0, duration], [operating_speed(line, first), last])


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
        **output.record(result, "period spectral_radius error_estimate growth_rate"),
        "verdict": str(result.verdict),
        "multipliers": list(map(complex, result.multipliers)),
        "says": str(result.outcome),
        "written": (),  # its place; the answer fills it
    }


def _response_json(result: PeriodicResponse) -> dict[str, Any]:
    orders, amplitude = result.order_spectrum()
    return {
        **output.record(result, "speed turns"),
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
        "hung": output.record(ending.hanging, "speed since until") if ending and ending.hanging else None,
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


def _safe_json(safe: SafeAccelerations, unit: str) -> dict[str, Any]:
    return {
        "slowest": safe.slowest,
        "fastest": safe.fastest,
        "tried": [
            {"acceleration": one.acceleration, "outcome": one.kind, "share_of_limit": one.share, "safe": one.safe}
            for one in safe.trials
        ],
        "says": safe.describe(unit),
    }
