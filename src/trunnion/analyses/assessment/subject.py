"""What the checks look at: the line under each of its load cases, over the speeds that it runs at."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from trunnion.analyses.assessment.cause import Cause
from trunnion.analyses.charts.axes import lowest_speed
from trunnion.analyses.linear.along import StabilityAlong, stability_along
from trunnion.analyses.linear.loaded_modes import loaded_modes
from trunnion.analyses.linear.resonance_speeds import resonance_speeds
from trunnion.analyses.linear.speed_sweep import sweep_speeds
from trunnion.analyses.orders.response import order_response, own_motions_of, response_about
from trunnion.analyses.orders.result import OrderResponse
from trunnion.arrays import Array, Codes, Complex
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.steady_base import bent, moves_by_itself
from trunnion.errors import ComputationError, InputError
from trunnion.results.speeds import show_speed, speed_factor
from trunnion.results.verdict import Verdict

if TYPE_CHECKING:
    from trunnion.analyses.linear.own_motions import MotionsBySpeed

POINTS = 201
"""Speeds of the even part of the grid; the peaks of the modes get more."""
NEARLY_LARGEST = 0.9
"""Share of the largest torque at the speeds of the grid from which a peak between them may be larger."""
PARTS = 64
"""Steps of which a peak is located, from one speed of the grid to the next but one."""
NO_RESPONSE = "no linear response: "
"""How checks that need the response begin to say why there is none."""


@dataclass(frozen=True)
class Subject:
    """The line, its running range [rad/s], its operating speed [rad/s] or None, the unit of speeds, its cases.

    naming: whether what grows is named, which takes far longer than to find that it grows.
    """

    line: Driveline
    low: float
    high: float
    speed: float | None
    unit: str
    cases: tuple[Case, ...]
    naming: bool = True

    def shown(self, speed: float) -> str:
        """A speed in the unit of the description."""
        return show_speed(float(f"{speed * speed_factor(self.unit):.5g}") / speed_factor(self.unit), self.unit)

    def required(self, element: str) -> float:
        """Largest margin that the description requires of an element."""
        return max((one.margin for one in self.line.limits_by_element if one.element == element), default=0.0)


@dataclass(frozen=True)
class Case:
    """The line under one load case ("" as stated), and the speeds that it is judged at; ``known``: its response there,
    where that is known already; ``rough``: to look around, see ``response_about``."""

    name: str
    assembly: Assembly
    low: float
    high: float
    points: int = POINTS
    given: tuple[float, ...] = ()
    known: OrderResponse | None = None
    rough: bool = False

    @cached_property
    def speeds(self) -> Array:
        """Speeds [rad/s] from the lowest to the highest, closer about the peaks; those ``given`` instead, if any."""
        if self.given:
            return np.array(self.given)
        if self.low == self.high:
            return np.array([self.low])
        low = max(self.low, lowest_speed(self.assembly), 1e-3 * self.high)
        if low >= self.high:
            return np.array([self.high])
        grid = sweep_speeds(self.assembly, low, self.high, self.points)
        return grid if self.points < POINTS else np.union1d(grid, self._peaks(grid))

    def _peaks(self, grid: Array) -> Array:
        """Speeds between those of ``grid`` at which a torque may be largest, by parabolas through three of them."""
        try:
            seen = response_about(self.assembly, grid, rough=True)
        except (InputError, ComputationError):  # said where it is asked for
            return np.zeros(0)
        found = np.concatenate([seen.vibratory_torque, seen.peak_torque, seen.heat], axis=1)
        left, middle, right = found[:-2], found[1:-1], found[2:]
        with np.errstate(invalid="ignore"):
            high = (
                (middle > left) & (middle >= right) & (middle > NEARLY_LARGEST * np.nanmax(found, axis=0, initial=0.0))
            )
        at, which = np.nonzero(high)
        back, on = grid[at] - grid[at + 1], grid[at + 2] - grid[at + 1]
        fall, rise = (left - middle)[at, which], (right - middle)[at, which]
        step = (on - back) / PARTS  # so that what peaks at one speed adds one speed
        vertex = (fall * on**2 - rise * back**2) / (2 * (fall * on - rise * back))
        return grid[at + 1] + step * np.round(vertex / step)

    @cached_property
    def answer(self) -> OrderResponse | str:
        """The linear response by order, or why there is none."""
        if self.known is not None:
            return self.known
        try:
            if self.rough:
                return response_about(self.assembly, self.speeds, rough=True)
            if not self.parametric:
                return order_response(self.assembly, self.speeds)
            found = response_about(self.assembly, self.speeds, self.motions)
        except (InputError, ComputationError) as error:
            return str(error).splitlines()[0]
        return replace(found, judged=self._judged)

    def respond(self) -> None:
        """Compute the response, so that cases can do it side by side."""
        _ = self.answer

    def prepare(self) -> None:
        """Compute what the checks look at, so that cases can do it side by side."""
        _ = self.answer, self.modes
        with suppress(InputError, ComputationError):  # said where it is looked at
            _ = self.along if self.parametric else None

    @property
    def costly(self) -> bool:
        """Whether every speed takes a motion of its own."""
        return moves_by_itself(self.assembly)

    @property
    def parametric(self) -> bool:
        """Whether a joint or a mesh makes the line's coefficients vary."""
        return bent(self.assembly) or any(mesh.stiffness_rates for mesh in self.assembly.topology.meshes)

    @cached_property
    def motions(self) -> MotionsBySpeed | None:
        """The own motions that response and stability are taken about, of a bent line that starts free."""
        return own_motions_of(self.assembly)

    @cached_property
    def along(self) -> StabilityAlong:
        """Stability at ``speeds`` and at the resonance speeds of the joints between them, which may be narrow."""
        low, high = float(self.speeds[0]), float(self.speeds[-1])
        named = [r.speed for r in resonance_speeds(self.assembly).within(low, high) if r.opens] if low < high else []
        return stability_along(self.assembly, np.union1d(self.speeds, named), motions=self.motions)

    def _judged(self) -> Codes:
        if lossy(self.assembly):
            return np.full(len(self.speeds), Verdict.FAILED, dtype=np.int8)  # no equations in time
        return self.along.verdict[np.searchsorted(self.along.speed, self.speeds)]

    @property
    def response(self) -> OrderResponse | None:
        """The linear response by order; None where there is none."""
        return self.answer if isinstance(self.answer, OrderResponse) else None

    @property
    def answered(self) -> OrderResponse:
        """The linear response by order, where one knows that there is one."""
        assert isinstance(self.answer, OrderResponse)
        return self.answer

    @cached_property
    def modes(self) -> Complex:
        """Eigenvalues (speed, mode) [1/s] of the loaded line, joints straight, at ``speeds``."""
        return loaded_modes(self.assembly, self.speeds)[0]

    @property
    def first(self) -> int:
        """Number of the first elastic mode: 2 where the line can turn as a whole."""
        return 2 if self.assembly.topology.free else 1

    @property
    def suffix(self) -> str:
        """How sentences name the case."""
        return f", load case {self.name}" if self.name else ""


def lossy(assembly: Assembly) -> bool:
    """Whether anything damps all frequencies alike, which has no equations in time."""
    return bool(assembly.coefficients(assembly.table(1), any_frequency=True).loss.any())


def cases_of(line: Driveline, low: float, high: float, points: int = POINTS) -> tuple[Case, ...]:
    """The line as stated and under each of its load cases."""
    named = [case.name for case in line.operation.load_cases] if line.operation else []
    return tuple(
        Case(name, assemble(line.with_load(name) if name else line), low, high, points) for name in ("", *named)
    )


def cause(case: Case, at: int, size: Array) -> Cause | None:
    """Which order leads at speed number ``at``, of amplitudes ``size`` (order,), and the mode that it is nearest to; no
    such question where one only looks around."""
    response = case.response
    if case.rough or response is None or not len(size) or not np.nanmax(size, initial=0.0) > 0:
        return None
    k = int(np.nanargmax(size))
    order, extra = float(response.order[k]), float(response.frequency[k])
    frequency = order * case.speeds[at] + extra
    modes = np.abs(case.modes[at])
    if not np.any(np.isfinite(modes)):
        return Cause(order, extra)
    m = int(np.nanargmin(np.abs(np.log(modes / frequency))))
    return Cause(order, extra, m + case.first, float(modes[m]), float(frequency / modes[m] - 1))
