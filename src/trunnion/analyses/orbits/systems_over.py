"""A system as one of its parameters varies, be it a driveline's or a user's, and what is looked at on the way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.orbits.free_orbit import require_kept_speed
from trunnion.analyses.orbits.periodic_response import require_forced
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import operating_speed
from trunnion.driveline.parameters import Parameter
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_system import LineSystem, line_system
from trunnion.errors import InputError
from trunnion.systems.system import System

Array = NDArray[np.float64]
LINE_SCALE = 30
"""A branch of a line is measured in 0.3 rad, thirty times what its integration is."""


@dataclass(frozen=True)
class SystemOver:
    """Systems by the value of a parameter.

    at : value → system, and of a line that starts free (value, torque [N m] beyond the balance of its loads) → system;
    scale (n + 1,) : size of each state and of the parameter that counts as one; label, unit : of the parameter; begin :
    the value to begin with; curves : the states of a system, the shafts of a line, of which the torques [N m] are
    looked at.
    """

    at: Callable[..., System]
    scale: Array
    label: str
    unit: str
    begin: float
    line: LineSystem | None
    curves: tuple[str, ...]

    @property
    def free(self) -> bool:
        """Whether it is a line that starts free."""
        return self.line is not None and self.line.assembly.topology.free

    @property
    def curve_unit(self) -> str:
        """Unit of what is looked at."""
        return "1" if self.line is None else "N*m"

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
    return SystemOver(prepared.varied(parameter), scale, columns.label, columns.unit, first, prepared, prepared.shafts)


def _of_system(system: System, name: str, first: float, width: float) -> SystemOver:
    if system.with_parameters({name: first}).forcing_period is None:
        raise InputError(
            "is autonomous; only motions of a forced period are followed", element=system.name, key="period",
            remedy="give the system its forcing period, or find single motions with periodic_response",
        )  # fmt: skip
    scale = np.append(np.asarray(system.scale), width)
    unit = system.parameter_units.get(name, "1")
    return SystemOver(
        lambda value: system.with_parameters({name: value}), scale, name, unit, first, None, system.states
    )
