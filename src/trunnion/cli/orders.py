"""The commands over speed: order-response, speed-sweep, stable-limit."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.command_input import CommandInput, OptionReader
from trunnion.cli.options import AboutSteadyState, Line, Progress, SpeedUnit
from trunnion.cli.places import CommandOutput
from trunnion.cli.readers import is_number, range_of, read_even_axis, read_speed
from trunnion.cli.typed import Command
from trunnion.errors import InputError
from trunnion.results.speeds import order_name

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from trunnion.design.limits.result import StableLimit
    from trunnion.driveline.driveline import Driveline
    from trunnion.response.misfire import Misfire
    from trunnion.response.orders.result import OrderResponse
    from trunnion.response.speed_sweep import SpeedSweep
    from trunnion.results.finding import Finding
    from trunnion.results.words import Words

    Array = NDArray[np.float64]

SPEED_EXAMPLE = 'write "300rpm:2400rpm" or "300rpm:2400rpm:201"'
SPEEDS = typer.Option(
    "--speed",
    "-s",
    metavar="LOW:HIGH[:POINTS]",
    help='Input speeds: "300rpm:2400rpm", "300:2400:201" in --unit, or one speed; default: the file\'s range.',
)
POINTS, FEW = 241, 61
"""Speeds where their number is not stated; of a stable limit, each of which is a scan."""


def _close_speeds(asked: CommandInput, text: str = "", key: str = "") -> Array:
    """Speeds asked for [rad/s], one or many; without a number of them closer together about the resonances."""
    import numpy as np

    (low, *rest), counted = _stated_speeds(asked, text, key)
    if not rest:
        return np.array([low])
    return np.linspace(low, rest[0], counted) if counted else tn.sweep_speeds(asked.line, low, rest[0], POINTS)


def _searched_speeds(asked: CommandInput, text: str = "", key: str = "") -> Array | tuple[float, float]:
    """The same, but the two ends of a range where no number of speeds is stated."""
    import numpy as np

    (low, *rest), counted = _stated_speeds(asked, text, key)
    if not rest:
        return np.array([low])
    return np.linspace(low, rest[0], counted) if counted else (low, rest[0])


def _response(
    line: Driveline, speeds: Array | tuple[float, float], orders: list[float] | None = None, **more: Any
) -> OrderResponse:
    """At the speeds, or over the range between two ends."""
    from trunnion.response.speed_sweep import response_over

    if isinstance(speeds, tuple):
        return response_over(line, *speeds, orders, points=POINTS, **more)
    return tn.order_response(line, speeds, orders, **more)


def _even_speeds(asked: CommandInput, text: str = "", key: str = "") -> Array:
    """The same, a range at even steps."""
    import numpy as np

    (low, *rest), counted = _stated_speeds(asked, text, key)
    return np.linspace(low, rest[0], counted or FEW) if rest else np.array([low])


def _stated_speeds(asked: CommandInput, text: str, key: str) -> tuple[tuple[float, ...], int]:
    """One speed or both ends of a range [rad/s], by default that of the file, and how many are stated, 0 for none."""
    if not text:
        return range_of(asked), 0
    ends = text.split(":")
    if len(ends) > 3:
        raise InputError("is not a range", key=key, value=text, remedy=SPEED_EXAMPLE)
    counted = ends.pop() if len(ends) == 3 else None
    read = tuple(read_speed(asked, end.strip(), key) for end in ends)
    if len(read) == 2 and not read[0] < read[1]:
        raise InputError("is not a rising range", key=key, value=text, remedy=SPEED_EXAMPLE)
    if counted is not None and not (counted.isdecimal() and 2 <= int(counted) <= 100_000):
        problem = "must end in a whole number of speeds, 2 to 100 000"
        raise InputError(problem, key=key, value=text, remedy=SPEED_EXAMPLE)
    return read, int(counted or 0)


def _orders(asked: CommandInput, text: str, key: str) -> list[float]:
    parts = text.split(",")
    if not all(is_number(part) and 0 < float(part) < float("inf") for part in parts):
        raise InputError("is not a list of orders", key=key, value=text, remedy='write "0.5,1,2"')
    return [float(part) for part in parts]


def _known_spring(asked: CommandInput, text: str, key: str) -> str:
    from trunnion.driveline.refusals import nearest
    from trunnion.equations.coefficients import assemble
    from trunnion.steady.orders.forced_response import shaft_names

    names = shaft_names(assemble(asked.line))
    if text not in names:
        remedy = nearest(text, list(names))
        raise InputError("is not a shaft or mesh of the line", key=key, value=text, remedy=remedy)
    return text


def _raised(asked: CommandInput, text: str, key: str) -> tuple[str, float, float, int]:
    """A parameter that is raised, and the number of points at which limits are compared."""
    from trunnion.design.limits.other_limits import SCAN

    return read_even_axis(asked, text, key, SCAN + 1)


SearchedSpeeds = Annotated[
    "Array | tuple[float, float]", SPEEDS, OptionReader(_searched_speeds, missing=_searched_speeds)
]
CloseSpeeds = Annotated["Array", SPEEDS, OptionReader(_close_speeds, missing=_close_speeds)]
EvenSpeeds = Annotated["Array", SPEEDS, OptionReader(_even_speeds, missing=_even_speeds)]


@Command("order response")
def order_response(
    line: Line,
    *,
    speeds: SearchedSpeeds,
    orders: Annotated[list[float] | None, OptionReader(_orders)],
    spring: Annotated[str | None, OptionReader(_known_spring)],
    unit: SpeedUnit,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion order-response truck.toml --load-case climb --speed 300rpm:2400rpm -o truck.png -o truck.csv

    --orders K,K,…  Cycles per turn of the input to list: 0.5,1,2; default: all.
    --spring  Shaft or mesh to draw; default: the one that swings most.
    """
    result = _response(line, speeds, orders, progress=progress).in_unit(unit)
    findings = result.findings

    def more() -> None:
        output.table(result.table())
        output.findings(findings)

    return CommandOutput(
        result, draw=partial(result.plot, spring=spring, operating=line.operation), table=_by_order(result),
        content=lambda: _response_json(result, findings), text=lambda: result.headline, more=more,
    )  # fmt: skip


@Command("torque over speed")
def misfire(
    line: Line, *, speeds: SearchedSpeeds, cut_out: bool = False, unit: SpeedUnit, progress: Progress
) -> CommandOutput:
    """Example: trunnion misfire ship.toml --speed 300rpm:800rpm -o misfire.png

    --cut-out/--misfiring  Leave a cylinder no gas torque at all, or that of its compression.
    """
    over: dict[str, Any] = {"speed_range": speeds} if isinstance(speeds, tuple) else {"speeds": speeds}
    result = tn.misfire(line, **over, cut_out=cut_out, progress=progress).in_unit(unit)

    def more() -> None:
        output.table(result.table(), result.looked_at)
        output.table(result.by_cylinder(), "every cylinder out of work in turn")
        output.findings(result.findings)

    return CommandOutput(
        result, draw=partial(result.plot, operating=line.operation), table=result.data,
        content=lambda: _misfire_json(result), text=lambda: result.headline, more=more,
    )  # fmt: skip


@Command("temperatures of couplings")
def coupling_temperatures(line: Line, *, speeds: CloseSpeeds, unit: SpeedUnit) -> CommandOutput:
    """Example: trunnion coupling-temperatures ship.toml --speed 300rpm:800rpm -o temperatures.png"""
    result = tn.coupling_temperatures(line, speeds).in_unit(unit)

    def more() -> None:
        output.table(result.table())
        output.findings(result.findings)

    return CommandOutput(
        result, draw=partial(result.plot, operating=line.operation), table=result.data,
        text=lambda: result.headline, more=more,
    )  # fmt: skip


@Command("torque over speed")
def speed_sweep(line: Line, *, speeds: SearchedSpeeds, unit: SpeedUnit, progress: Progress) -> CommandOutput:
    """Example: trunnion speed-sweep truck.toml --speed 300rpm:2400rpm -o truck.png"""
    from trunnion.response.speed_sweep import sweep_of

    result = sweep_of(_response(line, speeds, progress=progress)).in_unit(unit)
    return CommandOutput(
        result, draw=partial(result.plot, operating=line.operation), table=_in_unit(result),
        content=lambda: _sweep_json(result),
    )  # fmt: skip


@Command("stable limit", within=True)
def stable_limit(
    line: Line,
    *,
    parameter: Annotated[tuple[str, float, float, int], OptionReader(_raised, "HookeJoint *.angle")],
    speeds: EvenSpeeds,
    margin: float = 0.0,
    between: bool = True,
    about_steady_state: AboutSteadyState = False,
    unit: SpeedUnit,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion stable-limit truck.toml --parameter "joint 2.angle:0deg:40deg:120" --speed 300rpm:2400rpm:50

    --parameter, -p PARAMETER:LOW:HIGH[:STEPS]  What is raised until the line is unstable, or PARAMETER alone for
        angles: 0 to the file's range. STEPS are those at which the file's limits are compared.
    --margin  Share by which the range of speeds is widened at either end, 0.1 for 10 %.
    --between/--listed  Judge every speed between too, or only those listed.
    """
    label, low, high, points = parameter
    result = tn.stable_limit(
        line, label, speeds, low=low, high=high, margin=margin, between=between, scan=points - 1,
        about_steady_state=about_steady_state, progress=progress,
    ).in_unit(unit)  # fmt: skip
    return CommandOutput(
        result, draw=partial(result.plot, operating=line.operation), table=_in_unit(result),
        content=lambda: _limit_json(result),
    )  # fmt: skip


def _in_unit(result: OrderResponse | SpeedSweep | StableLimit) -> Any:
    """Its dataset, the speeds in its unit."""
    words = result.words
    return result.data.assign_coords(speed=("speed", result.speed * words.factor, {"units": words.unit}))


def _by_order(result: OrderResponse) -> Any:
    """What a table shows: sums over the cycle, then amplitude and phase of every order."""
    import numpy as np

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
    factor = result.words.factor
    columns = {"peak_torque": result.peak_torque, "vibratory_torque": result.vibratory_torque}
    if result.rated[spring]:
        columns["rated_torque"] = result.rated_torque
    found: dict[str, Any] = {"spring": result.springs[spring]}
    for name, values in columns.items():
        value, speed = result.largest(values[:, spring])
        found |= {name: value, "speed" if name == "peak_torque" else f"{name}_speed": speed * factor}
    name, speed, size = result.leading(result.springs[spring])
    if name == "none":
        return found | {"order": name, "order_amplitude": None, "order_speed": None}
    return found | {"order": name, "order_amplitude": size, "order_speed": speed * factor}


def _span(words: Words, speed: Array) -> dict[str, Any]:
    return {
        "speed_unit": words.unit,
        "speeds": {"low": speed.min() * words.factor, "high": speed.max() * words.factor, "points": len(speed)},
    }


def _misfire_json(result: Misfire) -> dict[str, Any]:
    """The worst cylinder, and the largest vibratory torque [N m] of every spring with it out of work."""
    return {
        **_span(result.words, result.response.speed),
        **output.record(result, "cut_out"),
        "worst": result.names[result.cylinders.index(result.worst)],
        "cylinders": list(result.names),
        "springs": result.table(),
        "by_cylinder": result.by_cylinder(),
        "findings": output.findings_json((*result.findings, *result.response.findings)),
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
