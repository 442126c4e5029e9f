"""What a description says that a line does: its duty at steady speeds, its passages, and scenarios that come again."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from trunnion.design.fatigue.load_history import TorqueHistory, of_response, of_run
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.duty import Duty, SpeedPassage
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.operation import Operation
from trunnion.driveline.refusals import about
from trunnion.driveline.scenarios import Scenario
from trunnion.errors import ComputationError, InputError
from trunnion.motion.passing.run_up import run_up
from trunnion.motion.transients.transient import transient
from trunnion.response.orders.response import order_response
from trunnion.results.words import Words


def report(progress: Callable[[float], None] | None, share: float) -> None:
    """Say that a share of the histories is done."""
    if progress is not None:
        progress(share)


def duty_histories(
    line: Driveline, operation: Operation, progress: Callable[[float], None] | None = None
) -> list[TorqueHistory]:
    """Every duty at the steady motion of its speed, then every passage as a run and every scenario so many an hour.

    Raises
    ------
    InputError : none is stated; a line without a steady motion to ask for, a passage that is refused.
    """
    scenarios = recurring(line)
    if not operation.duty and not operation.passages and not scenarios:
        raise InputError(
            "is missing", element="operation", key="duty",
            remedy=f"write [[operation.duty]] with {Duty.example}, [[operation.passage]] or per_hour of a scenario",
        )  # fmt: skip
    count = len(operation.duty) + len(operation.passages) + len(scenarios)
    found = _of_duty(line, operation)
    report(progress, len(found) / count)
    runs = [partial(_of_passage, line, one) for one in operation.passages]
    for run in [*runs, *(partial(_of_scenario, line, one) for one in scenarios)]:
        found.append(run())
        report(progress, len(found) / count)
    return found


def recurring(line: Driveline) -> list[Scenario]:
    """The scenarios that come again."""
    return [one for one in line.scenarios if one.per_hour is not None]


def _of_scenario(line: Driveline, scenario: Scenario) -> TorqueHistory:
    try:
        run = transient(line, scenario)
    except InputError as error:
        raise about(error, f"scenario {scenario.name}") from None
    if not run.outcome.ok:
        return TorqueHistory(scenario.name, without=str(run.outcome))
    return of_run(run, scenario.name, per_hour=scenario.per_hour)


def _of_duty(line: Driveline, operation: Operation) -> list[TorqueHistory]:
    """In the order of the description; all speeds of a load case are solved together."""
    found: dict[int, TorqueHistory] = {}
    words = Words(speed_unit(line))
    for case in dict.fromkeys(one.load_case for one in operation.duty):
        mine = [place for place, one in enumerate(operation.duty) if one.load_case == case]
        speeds = np.unique([operation.duty[place].speed for place in mine])
        suffix = f", {case}" if case else ""
        names = [f"{words.speed(operation.duty[place].speed)}{suffix}" for place in mine]
        try:
            response = order_response(line, speeds, load_case=case)
        except ComputationError as error:
            why = str(error).splitlines()[0]
            found |= {place: TorqueHistory(name, without=why) for place, name in zip(mine, names, strict=True)}
            continue
        for place, name in zip(mine, names, strict=True):
            one = operation.duty[place]
            at = int(np.searchsorted(speeds, one.speed))
            found[place] = of_response(response, at, name, share=one.share)
    return [found[place] for place in sorted(found)]


def _of_passage(line: Driveline, passage: SpeedPassage) -> TorqueHistory:
    loaded = line.with_load(passage.load_case) if passage.load_case else line
    try:
        run = run_up(loaded, passage.first, passage.last, acceleration=passage.acceleration, steady=0)
    except InputError as error:
        raise about(error, f"passage {passage.name}") from None
    if not run.outcome.ok:
        return TorqueHistory(passage.name, without=run.ended or str(run.outcome))
    return of_run(run.simulation, passage.name, per_hour=passage.per_hour)
