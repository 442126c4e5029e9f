"""The commands about nonlinear motion: simulate, periodic-response, run-up."""

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
    is_number,
    read_line,
    read_set,
    read_speed,
    read_time,
    read_unit,
    reference_systems,
)
from trunnion.cli.places import answer, check_places, print_result, write_results
from trunnion.errors import InputError

if TYPE_CHECKING:
    from trunnion.analyses.motion.run_up import RunUp
    from trunnion.analyses.orbits.orbit_result import PeriodicOrbit
    from trunnion.analyses.orbits.periodic_response import PeriodicResponse
    from trunnion.driveline.driveline import Driveline
    from trunnion.systems.system import System

Tolerance = Annotated[float, typer.Option("--tolerance", help="Error allowed per step.", min=1e-15, max=0.1)]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="Parameter of a reference system; repeat it for more."),
]
START = Annotated[str | None, typer.Option("--start", metavar="X,Y,…", help="State to start from.")]


def simulate(
    file: Annotated[
        str, typer.Argument(metavar="FILE", help="Driveline file, a name of the catalogue, or a reference system.")
    ],
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
    from trunnion.analyses.motion.simulate import simulate as compute

    with output.compile_notice():
        system = _system(file, parameters)
        if system is not None:
            _only_for_lines(("--speed", speed), ("--to-speed", to_speed), ("--load-case", load_case))
            _only_for_lines(("--turns", turns), remedy="use --duration, in seconds")
            check_places(to)
            seconds = 100.0 if duration is None else duration
            result: Any = compute(system, seconds, start=_state(start), tolerance=tolerance)
            written = write_results(to, file_stem(file), "motion", result.data, lambda: result.plot())
        else:
            line = read_line(file, load_case, reference_systems())
            unit = read_unit(line, unit)
            check_places(to)
            profile = _course(line, read_speed(speed, unit), read_speed(to_speed, unit, "--to-speed"), duration)
            length = None if duration is not None else 20.0 if turns is None else turns
            result = compute(line, duration, speed=profile, turns=length, start=_state(start), tolerance=tolerance)
            written = write_results(to, file_stem(file), "motion", result.data, lambda: result.plot(unit=unit))
    answer("simulate", lambda: _simulation_json(result), result.__str__, written, as_json)
    output.finish(result.outcome, written)


def periodic_response(
    file: Annotated[
        str, typer.Argument(metavar="FILE", help="Driveline file, a name of the catalogue, or a reference system.")
    ],
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
    from trunnion.analyses.orbits.periodic_response import PeriodicResponse
    from trunnion.analyses.orbits.periodic_response import periodic_response as compute

    with output.compile_notice():
        system = _system(file, parameters)
        if system is not None:
            _only_for_lines(("--speed", speed), ("--load-case", load_case))
            guess = read_time(period, "--period")
            check_places(to)
            result = compute(system, start=_state(start), period=guess, periods=periods)
        else:
            line = read_line(file, load_case, reference_systems())
            unit = read_unit(line, unit)
            if period is not None:
                remedy = "leave it out; the speed of a driveline gives it"
                raise InputError("belongs to reference systems", key="--period", value=period, remedy=remedy)
            check_places(to)
            result = compute(line, read_speed(speed, unit), start=_state(start), periods=periods)
    result.outcome.require()
    shown = unit or "rad/s"
    written = write_results(
        to, file_stem(file), "periodic-response", result.data,
        lambda: result.plot(unit=shown) if isinstance(result, PeriodicResponse) else result.plot(),
    )  # fmt: skip
    if as_json:
        output.write_json("periodic-response", _response_json(result, written))
        return
    if isinstance(result, PeriodicResponse):
        _print_response(result, shown, written)
    else:
        print_result(str(result), written)


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
    line = read_line(file, load_case)
    unit = read_unit(line, unit)
    low, high = _range(line, read_speed(first, unit, "--from"), read_speed(last, unit, "--to"))
    rate = read_speed(acceleration, unit, "--acceleration")
    assert rate is not None
    from trunnion.analyses.motion.run_up import run_up as compute
    from trunnion.analyses.motion.safe_accelerations import safe_accelerations

    torque = None if limit is None else _torque(limit)
    check_places(to)
    with output.compile_notice():
        result = compute(line, low, high, acceleration=rate, ramp=ramp)
        safe = None
        if torque is not None:
            tried = (rate / 4, rate * 4)
            safe = safe_accelerations(line, low, high, limit=torque, accelerations=tried, points=9, ramp=ramp)
    written = write_results(to, file_stem(file), "run-up", result.data, lambda: result.plot(unit=unit))
    content = _run_up_json(result)
    if safe is not None:
        content["safe_accelerations"] = {"slowest": safe.slowest, "fastest": safe.fastest, "says": str(safe)}
    said = result.describe(unit) + (f"\n  {safe}" if safe is not None else "")
    answer("run-up", lambda: content, lambda: said, written, as_json)


def _system(name: str, parameters: list[str] | None) -> System | None:
    """The reference system of that name, with ``--set`` applied; None for a driveline."""
    from trunnion.systems.reference import SYSTEMS, reference_system

    if name not in SYSTEMS:
        if parameters:
            remedy = f"edit the file instead; reference systems are: {', '.join(SYSTEMS)}"
            raise InputError("belongs to reference systems", key="--set", value=parameters[0], remedy=remedy)
        return None
    return reference_system(name, **read_set(parameters))


def _only_for_lines(*given: tuple[str, object], remedy: str = "use --set for a reference system") -> None:
    for key, value in given:
        if value is not None:
            raise InputError("belongs to drivelines", key=key, value=value, remedy=remedy)


def _state(text: str | None) -> list[float] | None:
    if text is None:
        return None
    parts = text.split(",")
    if not all(is_number(part) for part in parts):
        raise InputError("is not a list of numbers", key="--start", value=text, remedy='write "0.1,0"')
    return [float(part) for part in parts]


def _course(line: Driveline, first: float | None, last: float | None, duration: float | None) -> Any:
    """The speed, or a profile to the speed at the end."""
    from trunnion.driveline.operating_speed import operating_speed
    from trunnion.equations.speed_profile import SpeedProfile

    if last is None:
        return first
    if duration is None:
        raise InputError("is missing beside --to-speed", key="--duration", remedy="write --duration 10, in seconds")
    return SpeedProfile([0.0, duration], [operating_speed(line, first), last])


def _torque(text: str) -> float:
    """A positive torque [N m] written at ``--limit``, refused before anything is computed."""
    from trunnion.driveline.quantities import TORQUE, parse

    try:
        torque = parse(float(text) if is_number(text) else text, TORQUE)
    except InputError as error:
        raise InputError(error.problem, key="--limit", value=text, remedy=error.remedy) from None
    if not torque > 0:
        raise InputError("must be a positive torque", key="--limit", value=text)
    return torque


def _range(line: Driveline, first: float | None, last: float | None) -> tuple[float, float]:
    from trunnion.equations.coefficients import assemble
    from trunnion.reporting.ranges import speed_range

    if first is not None and last is not None:
        return first, last
    low, high = speed_range(assemble(line))
    return first or low, last or high


def _print_response(result: PeriodicResponse, unit: str, written: list[Path]) -> None:
    from trunnion.cli.report import print_written

    out = output.console()
    out.print(result.describe(unit), soft_wrap=True)
    orders, amplitude = result.order_spectrum()
    rows = [
        {"order": float(order), **{f"{s} [N m]": float(a) for s, a in zip(result.shafts, row, strict=True)}}
        for order, row in zip(orders, amplitude, strict=True)
        if row.max() > 1e-3 * amplitude[1:].max(initial=0.0)
    ]
    output.heading(out, "Orders: torque amplitude by cycles per turn of the input (0 is the mean)")
    output.table(out, rows)
    output.heading(out, "Findings")
    output.findings(out, result.findings_in(unit))
    print_written(out, written)


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


def _response_json(result: PeriodicResponse | PeriodicOrbit, written: list[Path]) -> dict[str, Any]:
    from trunnion.analyses.orbits.periodic_response import PeriodicResponse

    content: dict[str, Any] = {
        "verdict": str(result.verdict),
        "period": result.period,
        "spectral_radius": result.spectral_radius,
        "error_estimate": result.error_estimate,
        "growth_rate": result.growth_rate,
        "multipliers": list(map(complex, result.multipliers)),
        "says": str(result.outcome),
        "written": [str(path) for path in written],
    }
    if isinstance(result, PeriodicResponse):
        orders, amplitude = result.order_spectrum()
        content |= {
            "speed": result.speed,
            "turns": result.turns,
            "shafts": [
                {"name": name, "mean_torque": mean, "torque_peak_to_peak": peak}
                for name, mean, peak in zip(result.shafts, result.torque_mean, result.torque_peak_to_peak, strict=True)
            ],
            "orders": orders,
            "order_amplitude": amplitude,
            "linear_theory": str(result.comparison or result.no_comparison),
            "findings": [{"gravity": str(f.gravity), "sentence": f.sentence} for f in result.findings],
        }
    return content


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
