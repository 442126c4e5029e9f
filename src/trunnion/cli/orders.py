"""The commands over speed: order-response, speed-sweep, stable-limit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.options import (
    File,
    Json,
    LoadCase,
    Output,
    Unit,
    Within,
    is_number,
    read_case,
    read_even_axis,
    read_stated_speed,
)
from trunnion.cli.places import check_places, deliver
from trunnion.errors import InputError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from trunnion.design.limits.result import StableLimit
    from trunnion.response.orders.result import OrderResponse
    from trunnion.response.speed_sweep import SpeedSweep
    from trunnion.results.finding import Finding
    from trunnion.results.words import Words

    Array = NDArray[np.float64]

Speeds = Annotated[
    str | None,
    typer.Option(
        "--speed",
        "-s",
        metavar="LOW:HIGH[:POINTS]",
        help='Input speeds: "300rpm:2400rpm", "300:2400:201" in --unit, or one speed; default: the file\'s range.',
    ),
]
SPEED_EXAMPLE = 'write "300rpm:2400rpm" or "300rpm:2400rpm:201"'
FEW = 61
"""Speeds of a stable limit, each of which is a scan."""


def order_response(
    file: File,
    speeds: Speeds = None,
    orders: Annotated[
        str | None,
        typer.Option("--orders", metavar="K,K,…", help="Cycles per turn of the input to list: 0.5,1,2; default: all."),
    ] = None,
    spring: Annotated[
        str | None, typer.Option("--spring", help="Shaft or mesh to draw; default: the one that swings most.")
    ] = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    to: Output = None,
    as_json: Json = False,
) -> None:
    """Vibratory torque of every shaft and mesh over speed, order by order, with stress, heat and speed fluctuation.

    Example: trunnion order-response truck.toml --load-case climb --speed 300rpm:2400rpm -o truck.png -o truck.csv
    """
    line, unit = read_case(file, unit, load_case)
    at, wanted = _speeds(line, speeds, unit), _orders(orders)
    _known(line, spring)
    check_places(to)
    with output.progress("order response") as advance:
        result = tn.order_response(line, at, wanted, progress=advance).in_unit(unit)
        findings = result.findings

    def more() -> None:
        output.table(result.table())
        output.findings(findings)

    deliver(
        "order-response", file, result, to, as_json,
        draw=lambda: result.plot(spring=spring, unit=unit, operating=line.operation), table=_by_order(result),
        content=lambda: _response_json(result, findings), text=lambda: result.headline, more=more,
    )  # fmt: skip


def speed_sweep(
    file: File,
    speeds: Speeds = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    to: Output = None,
    as_json: Json = False,
) -> None:
    """Torque and twist amplitude of every shaft over speed, all orders together; takes bent lines that start free.

    Example: trunnion speed-sweep truck.toml --speed 300rpm:2400rpm -o truck.png
    """
    line, unit = read_case(file, unit, load_case)
    at = _speeds(line, speeds, unit)
    check_places(to)
    with output.progress("torque over speed") as advance:
        result = tn.speed_sweep(line, at, progress=advance).in_unit(unit)
    deliver(
        "speed-sweep", file, result, to, as_json,
        draw=lambda: result.plot(unit=unit, operating=line.operation), table=_in_unit(result),
        content=lambda: _sweep_json(result),
    )  # fmt: skip


def stable_limit(
    file: File,
    parameter: Annotated[
        str,
        typer.Option(
            "--parameter",
            "-p",
            metavar="PARAMETER:LOW:HIGH[:STEPS]",
            help="What is raised until the line is unstable, or PARAMETER alone for angles: 0 to the file's range. "
            "STEPS are those at which the file's limits are compared.",
        ),
    ] = "HookeJoint *.angle",
    speeds: Speeds = None,
    margin: Annotated[
        float, typer.Option("--margin", help="Share by which the speeds between are widened, 0.1 for 10 %.")
    ] = 0.0,
    between: Annotated[
        bool, typer.Option("--between/--listed", help="Every speed between too, or those listed alone.")
    ] = True,
    unit: Unit = None,
    load_case: LoadCase = None,
    to: Output = None,
    within: Within = None,
    as_json: Json = False,
) -> None:
    """The largest value of a parameter up to which the line is stable, over speed, and which limit binds before.

    Example: trunnion stable-limit truck.toml --parameter "joint 2.angle:0deg:40deg:120" --speed 300rpm:2400rpm:50
    """  # fmt: skip
    from trunnion.design.limits.other_limits import SCAN

    line, unit = read_case(file, unit, load_case)
    label, low, high, points = read_even_axis(parameter, line, unit, SCAN + 1, "--parameter")
    at = _speeds(line, speeds, unit, points=FEW, even=True)
    check_places(to)
    with output.progress("stable limit", within) as advance:
        result = tn.stable_limit(
            line, label, at, low=low, high=high, margin=margin, between=between, scan=points - 1, progress=advance
        ).in_unit(unit)
    deliver(
        "stable-limit", file, result, to, as_json,
        draw=lambda: result.plot(unit=unit, operating=line.operation), table=_in_unit(result),
        content=lambda: _limit_json(result),
    )  # fmt: skip


def _speeds(line: tn.Driveline, text: str | None, unit: str, *, points: int = 241, even: bool = False) -> Array:
    """Speeds asked for [rad/s]; without a number of them closer together about the resonances, unless ``even``."""
    import numpy as np

    from trunnion.reporting.ranges import speed_range

    if text is None:
        low, high = speed_range(line)
    else:
        ends, counted = text.split(":"), None
        if len(ends) > 3:
            raise InputError("is no range", key="--speed", value=text, remedy=SPEED_EXAMPLE)
        if len(ends) == 3:
            counted = ends.pop()
        read = [read_stated_speed(end.strip(), unit) for end in ends]
        if len(read) == 1 and not even:
            return np.array(read)
        if len(read) == 1 or not read[0] < read[1]:
            raise InputError("is no rising range", key="--speed", value=text, remedy=SPEED_EXAMPLE)
        low, high = read
        if counted is not None:
            if not counted.isdecimal() or not 2 <= int(counted) <= 100_000:
                problem = "must end in a whole number of speeds, 2 to 100 000"
                raise InputError(problem, key="--speed", value=text, remedy=SPEED_EXAMPLE)
            return np.linspace(low, high, int(counted))
    return np.linspace(low, high, points) if even else tn.sweep_speeds(line, low, high, points)


def _orders(text: str | None) -> list[float] | None:
    if text is None:
        return None
    parts = text.split(",")
    if not all(is_number(part) and 0 < float(part) < float("inf") for part in parts):
        raise InputError("is no list of orders", key="--orders", value=text, remedy='write "0.5,1,2"')
    return [float(part) for part in parts]


def _known(line: tn.Driveline, spring: str | None) -> None:
    from trunnion.driveline.refusals import nearest
    from trunnion.equations.coefficients import assemble
    from trunnion.steady.orders.forced_response import shaft_names

    names = shaft_names(assemble(line))
    if spring is not None and spring not in names:
        remedy = nearest(spring, list(names))
        raise InputError("is no shaft or mesh of the line", key="--spring", value=spring, remedy=remedy)


def _in_unit(result: OrderResponse | SpeedSweep | StableLimit) -> Any:
    """Its dataset, the speeds in its unit."""
    words = result.words
    return result.data.assign_coords(speed=("speed", result.speed * words.factor, {"units": words.unit}))


def _by_order(result: OrderResponse) -> Any:
    """What a table shows: sums over the cycle, then amplitude and phase of every order."""
    import numpy as np

    from trunnion.response.orders.result import order_name

    data = _in_unit(result)
    kept = data[["mean_torque", "peak_torque", "vibratory_torque", "rated_torque", "vibratory_stress", "heat"]]
    labels = [order_name(o, f) for o, f in zip(result.order, result.frequency, strict=True)]
    axes = ("speed", "order_number", "spring")
    parts = {
        "torque_amplitude": (axes, np.abs(result.torque), {"units": "N*m"}),
        "torque_phase": (axes, np.angle(result.torque), {"units": "rad"}),
    }
    moving = data[["rotation_amplitude", "speed_fluctuation", "acceleration"]]
    return kept.assign(parts).assign(moving.data_vars).assign_coords(order_number=labels)


def _response_json(result: OrderResponse, findings: Sequence[Finding]) -> dict[str, Any]:
    """The largest of every spring; the numbers by speed and order are in the files written."""
    return {
        **_span(result.words, result.speed),
        "orders": [
            {"order": o, "frequency": f} for o, f in zip(result.order.tolist(), result.frequency.tolist(), strict=True)
        ],
        "sum_is_bound": result.sum_is_bound,
        "springs": [_spring_json(result, spring) for spring in range(len(result.springs))],
        "findings": output.findings_json(findings),
    }


def _spring_json(result: OrderResponse, spring: int) -> dict[str, Any]:
    """Largest torques [N m] of a spring, each with its speed; a rated torque of couplings with a rating alone."""
    from trunnion.response.orders.result import order_name

    factor, columns = (
        result.words.factor,
        {"peak_torque": result.peak_torque, "vibratory_torque": result.vibratory_torque},
    )
    if result.rated[spring]:
        columns["rated_torque"] = result.rated_torque
    found: dict[str, Any] = {"spring": result.springs[spring]}
    for name, values in columns.items():
        value, speed = result.largest(values[:, spring])
        found |= {name: value, "speed" if name == "peak_torque" else f"{name}_speed": speed * factor}
    order, speed, size = result.leading_order(result.springs[spring])
    if not size > 0:
        return found | {"order": "none", "order_amplitude": None, "order_speed": None}
    name = order_name(order, float(result.frequency[result.order == order].max(initial=0.0)))
    return found | {"order": name, "order_amplitude": size, "order_speed": speed * factor}


def _span(words: Words, speed: Array) -> dict[str, Any]:
    return {
        "speed_unit": words.unit,
        "speeds": {"low": speed.min() * words.factor, "high": speed.max() * words.factor, "points": len(speed)},
    }


def _sweep_json(result: SpeedSweep) -> dict[str, Any]:
    peaks = {shaft: result.peak(shaft) for shaft in result.shafts}
    return {
        **_span(result.words, result.speed),
        "shafts": [
            {"shaft": shaft, "torque_amplitude": torque, "speed": at * result.words.factor}
            for shaft, (torque, at) in peaks.items()
        ],
        "linear": bool(result.linear.all()),
        "findings": output.findings_json(result.findings),
    }


def _limit_json(result: StableLimit) -> dict[str, Any]:
    from trunnion.design.limits.result import LimitKind

    at, words = result.critical_speed, result.words
    return {
        **_span(words, result.speed),
        **output.record(result, "sentence parameter unit smallest speed limit intervals usable binding", words),
        "critical_speed": None if at is None else at * words.factor,
        "kind": [LimitKind(int(kind)).name.lower() for kind in result.kind],
        "unstable": [ranges.tolist() for ranges in result.unstable],
        "others": [output.record(one, "name allowed unit reached") for one in result.others],
        "whole": None if result.whole is None else result.whole.in_unit(words.unit).to_dict(),
        "search": {"low": result.low, "high": result.high, "complete": result.complete, "words": result.search},
        "findings": output.findings_json(result.findings),
    }
