"""Integration of a compiled right-hand side: state, tangent vectors, dense output, events, regimes.

The compiled core works in chunks of some thousand steps, between which the interpreter looks up: Ctrl-C
works, and what was computed before a failure is kept.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Integers
from trunnion.numerics.compiled import kernel_file
from trunnion.waiting import keep_time, time_is_up

CHUNK = 4096
MOST_STEPS = 1_000_000
TOLERANCE = 1e-10


class IntegrationEnd(IntEnum):
    """How an integration ended; the codes of the compiled core."""

    REACHED = 0
    FULL = 1
    """The room for its steps is; between two calls of the core only."""
    STOPPED = 2
    STEP_LIMIT = 3
    NOT_FINITE = 4
    TOO_SMALL = 5
    REFUSED = 6
    CHATTER = 7
    BEYOND = 8
    OUT_OF_TIME = 9
    """The time limit around it is over; only of an integration that keeps what it has."""


_ALONG = (
    "start", "length", "regime", "state", "coefficients", "event_time", "event_which", "event_before", "event_after",
)  # fmt: skip
"""What a trajectory holds of every step or event, in the order in which the compiled core takes room for it."""


@cache
def kernel() -> ModuleType:
    """The compiled core; the first use on a machine compiles it."""
    return kernel_file(str(Path(__file__).with_name("integration_kernel.py")))


@dataclass(frozen=True)
class Equations:
    """What the integrator needs of a system: addresses of C functions, and numbers.

    rate, guard, jump : see ``integration_kernel``; 0 where there is none.
    size : number of states n; numbers (p,): the array every function receives; weight (n,): the size of each
        state that counts as one, in which errors are measured.
    transitions, directions (regimes, guards): the regime a guard leads to from each regime, −1 where it is
        not watched; and the crossings it watches: 1 upwards, −1 downwards, 2 both.
    """

    rate: int
    size: int
    numbers: Array
    weight: Array
    guard: int = 0
    jump: int = 0
    transitions: Integers = field(default_factory=lambda: np.zeros((1, 0), dtype=np.int64))
    directions: Integers = field(default_factory=lambda: np.zeros((1, 0), dtype=np.int64))


@dataclass(frozen=True)
class Watch:
    """Functions of the state whose zeros are to be found: the address of a guard, the numbers it reads,
    the directions it watches, and whether a zero stops the integration."""

    address: int = 0
    numbers: Array = field(default_factory=lambda: np.zeros(0))
    directions: Integers = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    stops: Integers = field(default_factory=lambda: np.zeros(0, dtype=np.int64))


@dataclass(frozen=True)
class Trajectory:
    """What an integration computed.

    start (steps,), length (steps,): of every step; state (steps + 1, n): at both ends of them;
    coefficients (steps, 8, n) of the dense output (empty if not asked for); regime (steps,).
    event_time, event_which (events,); event_before, event_after (events, n). Own guards are counted first,
    the caller's functions behind them. final (1 + k, n): state and tangent vectors at ``time``.
    """

    start: Array
    length: Array
    state: Array
    coefficients: Array
    regime: Integers
    event_time: Array
    event_which: Integers
    event_before: Array
    event_after: Array
    final: Array
    time: float
    final_regime: int
    end: IntegrationEnd
    rejected: int
    next_step: float

    @property
    def steps(self) -> int:
        """Number of accepted steps."""
        return len(self.start)

    @property
    def time_of_state(self) -> Array:
        """Times (steps + 1,) of ``state``; a motion is smooth between neighbours."""
        return np.append(self.start, self.time)

    def at(self, time: ArrayLike) -> Array:
        """States at times within the trajectory, shape (..., n), to the order of the dense output."""
        times = np.asarray(time, dtype=float)
        flat = np.ascontiguousarray(times.ravel())
        out = np.empty((flat.size, self.state.shape[1]))
        if not self.steps:
            out[:] = self.final[0]
        else:
            kernel().evaluate(self.start, self.length, self.coefficients, flat, out)
        return out.reshape(*times.shape, self.state.shape[1])


def integrate(
    equations: Equations,
    start: float,
    end: float,
    state: ArrayLike,
    *,
    regime: int = 0,
    tolerance: float = TOLERANCE,
    most_steps: int = MOST_STEPS,
    watch: Watch | None = None,
    dense: bool = True,
    first_step: float = 0.0,
    longest_step: float = np.inf,
    partly: bool = False,
) -> Trajectory:
    """Carry ``state`` from time ``start`` to ``end`` (later than ``start``).

    Parameters
    ----------
    state : (n,), or (1 + k, n) with tangent vectors in rows 1…k: they are then carried along by the exact
        variational equations, under the same error control and with saltation at switching surfaces.
    tolerance : error allowed per step, relative to weight + |x|; for a tangent, relative to its own length.
    most_steps : after which the integration ends with ``IntegrationEnd.STEP_LIMIT``.
    watch : functions whose zeros are located (and may stop the integration).
    dense : keep the coefficients for ``Trajectory.at`` (8n numbers a step).
    first_step : a first guess of the step; 0 finds one.
    partly : keep what was computed where a time limit ends it, with ``IntegrationEnd.OUT_OF_TIME``.

    Raises
    ------
    OutOfTime : the time limit around it is over, unless ``partly``.
    """
    core, watch = kernel(), watch or Watch()
    n = equations.size
    y = np.array(state, dtype=float).reshape(-1)
    count = y.size // n - 1
    own = equations.transitions.shape[1]
    functions = np.array([equations.rate, equations.guard, equations.jump, watch.address], dtype=np.int64)
    clock = np.array([start, first_step, -np.inf, 0.0])
    whole = np.array([regime, 0, 0, 0, 0, 0, 1], dtype=np.int64)
    numbers = equations.numbers.copy()  # a right-hand side may work in them
    sides = np.zeros(own + len(watch.directions))
    watched = watch.directions if len(sides) else None
    first = y[:n].reshape(1, n).copy()
    parts: list[Trajectory] = []
    size = 256
    if not partly:
        keep_time()
    while True:
        room, events = size if dense else 0, size + 128 if len(sides) else 64
        kept = (
            np.empty(size), np.empty(size), np.empty(size, dtype=np.int64), np.empty((size, n)), np.empty((room, 8, n)),
            np.empty(events), np.empty(events, dtype=np.int64), np.empty((events, n)), np.empty((events, n)),
        )  # fmt: skip
        code = core.advance(
            functions, numbers, watch.numbers, y, n, count, equations.transitions, equations.directions,
            watched, watch.stops, clock, whole, sides, float(end), float(tolerance), equations.weight,
            float(longest_step), most_steps, dense, *kept,
        )  # fmt: skip
        found: dict[str, Any] = {
            name: part[: whole[4] if name.startswith("event") else whole[5]]
            for name, part in zip(_ALONG, kept, strict=True)
        }
        found["state"] = np.concatenate([parts[-1].state[-1:] if parts else first, found["state"]])
        found["final_regime"], found["rejected"], found["next_step"] = int(whole[0]), int(whole[3]), float(clock[1])
        reached = float(end) if code == IntegrationEnd.REACHED else float(clock[0])
        parts.append(Trajectory(**found, final=y.reshape(1 + count, n), time=reached, end=IntegrationEnd(code)))
        if code != IntegrationEnd.FULL:
            return joined(parts)
        if not partly:
            keep_time()
        elif time_is_up():
            return replace(joined(parts), end=IntegrationEnd.OUT_OF_TIME)
        size = CHUNK


def joined(parts: Sequence[Trajectory]) -> Trajectory:
    """Stretches of one motion, each beginning where the one before ended, as one."""
    along: dict[str, Any] = {name: np.concatenate([getattr(part, name) for part in parts]) for name in _ALONG}
    along["state"] = np.concatenate([parts[0].state, *(part.state[1:] for part in parts[1:])])
    return replace(parts[-1], **along)
