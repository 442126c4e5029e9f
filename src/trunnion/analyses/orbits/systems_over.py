"""A system as one of its parameters varies, be it a driveline's or a user's, and what is looked at on the way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from trunnion.analyses.orbits.branch import Names
from trunnion.analyses.orbits.free_orbit import require_kept_speed
from trunnion.analyses.orbits.periodic_response import require_forced
from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import operating_speed, speed_unit
from trunnion.driveline.parameters import Parameter
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_system import LineSystem, line_system
from trunnion.equations.sliders import NOT_FOLLOWED, STAND_IN, refuse_friction
from trunnion.errors import InputError
from trunnion.systems.maps import IntegratedMap
from trunnion.systems.system import System

LINE_SCALE = 30
"""A branch of a line is measured in 0.3 rad, thirty times what its integration is."""
STEP = 1e-4
"""Of differences by a parameter, over its scale."""
MOST_STEPS = 200_000
"""Of the integration over one period."""


@dataclass(frozen=True)
class SystemOver(Names):
    """Systems by the value of a parameter.

    at : value → system, and of a line that starts free (value, torque [N m] beyond the balance of its loads) → system;
    scale (n + 1,) : size of each state and of the parameter that counts as one; begin : the value to begin with; curves
    : the states of a system, the shafts of a line, of which the torques [N m] are looked at.
    """

    at: Callable[..., System] = field(kw_only=True)
    scale: Array = field(kw_only=True)
    begin: float = field(kw_only=True)
    line: LineSystem | None = field(default=None, kw_only=True)

    @property
    def free(self) -> bool:
        """Whether it is a line that starts free."""
        return self.line is not None and self.line.assembly.topology.free

    def map(self, periods: int, tolerance: float, torque: float = 0.0) -> IntegratedMap:
        """The map over ``periods`` of the forcing, its value the parameter; of a line that starts free its values are
        the torque beyond the balance, in steps of a size of ``torque``, and the parameter."""
        step, look = STEP * float(self.scale[-1]), self.observe
        if not self.free:
            return IntegratedMap(self.at, (self.begin,), (step,), 0.0, periods, tolerance, MOST_STEPS, look)

        def driven(drive: float, value: float) -> System:
            return self.at(value, drive)

        steps = STEP * torque, step
        return IntegratedMap(driven, (0.0, self.begin), steps, 0.0, periods, tolerance, MOST_STEPS, look)

    def observe(self, system: System, times: Array, states: Array) -> Array:
        """The curves (times, curves) along states (times, n)."""
        return states if self.line is None else self.line.observe(system, times, states).torque


def system_over(
    line: Driveline | Assembly | System,
    parameter: str | Parameter,
    low: float,
    high: float,
    begin: float | None,
    speed: float | None,
    width: float,
    *,
    free: bool = False,
) -> SystemOver:
    """The systems of ``line`` over a parameter, whose range times ``width`` is its scale.

    ``free`` : whether lines that start free are taken, at the mean speed that their drives keep.

    Raises
    ------
    InputError : an unknown parameter, a reversed range, an autonomous system, a free line not asked for.
    """
    if not (np.isfinite(low) and np.isfinite(high) and low < high):
        raise InputError("must be a rising range", key="low, high", value=[float(low), float(high)])
    first = float(low if begin is None else begin)
    if not low <= first <= high:
        raise InputError(
            "lies outside the range", key="begin", value=first, remedy=f"choose between {low:g} and {high:g}"
        )
    if isinstance(line, System):
        return _of_system(line, str(parameter), first, (high - low) * width)
    description = line.line if isinstance(line, Assembly) else line
    refuse_friction(description, NOT_FOLLOWED, STAND_IN)
    over_speed = parameter == "speed"
    prepared = line_system(line, first if over_speed and first > 0 else operating_speed(description, speed))
    if not prepared.assembly.topology.free:
        require_forced(prepared)
    elif free:
        require_kept_speed(prepared)
    else:
        raise InputError(
            "starts free, which a series of harmonics at a given speed does not take", element="driveline",
            remedy='use periodic_branch or method = "shooting", or put a ConstantSpeed in front',
        )  # fmt: skip
    columns = prepared.assembly.packed.resolve(parameter)
    scale = np.append(LINE_SCALE * np.asarray(prepared.system.scale), (high - low) * width)
    return SystemOver(
        columns.label, columns.unit, prepared.shafts, "N*m", speed_unit(description),
        at=prepared.varied(parameter), scale=scale, begin=first, line=prepared,
    )  # fmt: skip


def _of_system(system: System, name: str, first: float, width: float) -> SystemOver:
    if system.with_parameters({name: first}).forcing_period is None:
        raise InputError(
            "is autonomous; only motions of a forced period are followed", element=system.name, key="period",
            remedy="give the system its forcing period, or find single motions with periodic_response",
        )  # fmt: skip
    scale = np.append(np.asarray(system.scale), width)
    unit = system.parameter_units.get(name, "1")
    return SystemOver(
        name, unit, system.states, at=lambda value: system.with_parameters({name: value}), scale=scale, begin=first
    )
