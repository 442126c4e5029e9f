"""The commands about nonlinear motion: simulate, periodic-response, run-up."""

from __future__ import annotations

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
    from trunnion.analyses.motion.run_up import RunUp
    from trunnion.analyses.orbits.orbit_result import PeriodicOrbit
    from trunnion.analyses.orbits.periodic_response import PeriodicResponse

Subject = Annotated[
    str, typer.Argument(metavar="FILE", help="Driveline file, a name of the catalogue, or a reference system.")
]
Tolerance = Annotated[float, typer.Option("--tolerance", help="Error allowed per step.", min=1e-15, max=0.1)]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="Parameter of a reference system; repeat it for more."),
]
OF_SYSTEM = "use --set for a reference system"
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
    with output.compile_notice():
        system = _system(file, parameters)
        if system is not None:
            only_for_lines(OF_SYSTEM, {"--speed": speed, "--to-speed": to_speed, "--load-case": load_case})
            only_for_lines("use --duration, in seconds", {"--turns": turns})
            check_places(to)
            seconds = 100.0 if duration is None else duration
            result: Any = tn.simulate(system, seconds, start=read_state(start), tolerance=tolerance)
        else:
            line, unit = read_case(file, unit, load_case, _reference_systems())
            check_places(to)
            profile = _course(line, read_speed(speed, unit), read_speed(to_speed, unit, "--to-speed"), duration)
            length = None if duration is not None else 20.0 if turns is None else turns
            result = tn.simulate(
                line, duration, speed=profile, turns=length, start=read_state(start), tolerance=tolerance
            )
    written = deliver(
        "simulate", file, result, to, as_json, what="motion",
        draw=result.plot if system is not None else lambda: result.plot(unit=unit),
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
    with output.compile_notice():
        system = _system(file, parameters)
        if system is not None:
            only_for_lines(OF_SYSTEM, {"--speed": speed, "--load-case": load_case})
            guess = read_time(period, "--period")
            check_places(to)
            result: Any = tn.periodic_response(system, start=read_state(start), period=guess, periods=periods)
        else:
            line, unit = read_case(file, unit, load_case, _reference_systems())
            if period is not None:
                remedy = "leave it out; the speed of a driveline gives it"
                raise InputError("belongs to reference systems", key="--period", value=period, remedy=remedy)
            check_places(to)
            result = tn.periodic_response(line, read_speed(speed, unit), start=read_state(start), periods=periods)
    result.outcome.require()
    if system is not None:
        deliver("periodic-response", file, result, to, as_json, content=lambda: _orbit_json(result))
    else:
        shown = unit or "rad/s"
        deliver(
            "periodic-response", file, result, to, as_json, draw=lambda: result.plot(unit=shown),
            content=lambda: _orbit_json(result) | _response_json(result),
            text=lambda: result.describe(shown), more=lambda: _print_orders(result, shown),
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
    with output.compile_notice():
        result = tn.run_up(line, low, high, acceleration=rate, ramp=ramp)
        if torque is not None:
            tried = (rate / 4, rate * 4)
            safe = tn.safe_accelerations(line, low, high, limit=torque, accelerations=tried, points=9, ramp=ramp)
    content, said = _run_up_json(result), result.describe(unit)
    if safe is not None:
        content["safe_accelerations"] = {"slowest": safe.slowest, "fastest": safe.fastest, "says": str(safe)}
        said += f"\n  {safe}"
    deliver(
        "run-up", file, result, to, as_json,
        draw=lambda: result.plot(unit=unit), content=lambda: content, text=lambda: said,
    )  # fmt: skip


def _reference_systems() -> tuple[str, ...]:
    """Names that stand for equations of motion, not for drivelines."""
    from trunnion.systems.reference import SYSTEMS

    return tuple(SYSTEMS)


def _system(name: str, parameters: list[str] | None) -> tn.System | None:
    """The reference system of that name, with ``--set`` applied; None for a driveline."""
    names = _reference_systems()
    if name in names:
        return tn.reference_system(name, **read_set(parameters))
    if parameters:
        remedy = f"edit the file instead; reference systems are: {', '.join(names)}"
        raise InputError("belongs to reference systems", key="--set", value=parameters[0], remedy=remedy)
    return None


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
    from trunnion.analyses.motion.simulate import LineSimulation

    content = {
        "outcome": result.outcome.kind,
        "says": str(result.outcome),
        "end": result.end,
        "final_state": result.final,
    }
    if isinstance(result, LineSimulation):
        content["shafts"] = [
            {"name": name, "smallest_torque": low, "largest_torque": high}
            for name, low, high in zip(result.shafts, result.torque.min(axis=0), result.torque.max(axis=0), strict=True)
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


def _run_up_json(result: RunUp) -> dict[str, Any]:
    return {
        "outcome": result.outcome.kind,
        "says": str(result.outcome),
        "acceleration": result.acceleration,
        "ramp": result.ramp,
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
