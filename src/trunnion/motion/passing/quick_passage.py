"""Passages of lines without switches, followed in compiled stretches for their kind alone: what maps are made of.

``transient`` keeps the whole motion with dense output and locates every switch; here only where the line stands is
kept, at the same error control.
"""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.applied_torque import TorqueFunction
from trunnion.equations.applied_torques import PlacedTorque
from trunnion.equations.line_regimes import line_kernel, passage_kernel
from trunnion.motion.transients.stepping import FURTHEST, Stepper
from trunnion.numerics.integration import integration
from trunnion.waiting import time_is_up

CHUNK = 20_000
"""Steps of a call, about a tenth of a second."""
LOOKS = 32
"""Mean speeds in a stretch."""


def is_quick(stepper: Stepper) -> bool:
    """Whether a line and what acts on it has no switch but knots of torques over time or over speed."""
    switches = stepper.line.system.regimes is not None or stepper.groups or stepper.crossings
    return bool(stepper.free and not switches and all(_plain(one) for one in stepper.torques))


def _plain(one: PlacedTorque) -> bool:
    if isinstance(one.stated, TorqueFunction) or (one.formula is not None and one.formula.kinks):
        return False
    return len(one.axes) <= 1 and all(axis.variable in ("time", "speed") for axis in one.axes)


class QuickPassage:
    """A line on its way to a mean speed, from a state (2n + lagging,) on at an angle [rad] and a speed [rad/s]."""

    def __init__(
        self, stepper: Stepper, state: Array, angle: float, speed: float, last: float, tolerance: float
    ) -> None:
        self.stepper, self.last, self.tolerance = stepper, last, tolerance
        core, kernel = line_kernel(), passage_kernel()
        self.numbers, self.state = stepper.numbers.copy(), np.array(state, dtype=float)
        self.numbers[[core.THETA, core.OMEGA, core.ALPHA, core.SINCE]] = angle, speed, 0.0, 0.0
        self.clock = np.zeros(10)
        self.clock[[kernel.BEFORE, kernel.GAINED]] = np.nan, np.inf
        codes = {"time": kernel.BY_TIME, "speed": kernel.BY_SPEED}
        torque, knots, rows, known = [], list[float](), list[Array](), list[bool]()
        for one, program in zip(stepper.torques, stepper.programs, strict=True):
            axis = one.axes[0] if one.axes else None
            own = axis.knots if axis is not None else np.zeros(0)
            variable = codes[axis.variable] if axis is not None else kernel.NONE
            torque.append([variable, one.station, int(one.sense), len(own), len(knots), len(rows), 0])
            for piece in range(-1, max(len(own), 0)):
                pieces = [piece] if axis is not None else []
                rows.append(one.row(pieces, program))
                known.append(axis is None or axis.variable == "time" or not axis.beyond(piece))
            knots += own.tolist()
        self.torque = np.array(torque, dtype=np.int64).reshape(-1, 7)
        self.knots, self.known = np.array(knots, dtype=float), np.array(known, dtype=bool)
        self.rows = np.array(rows).reshape(-1, core.PER_APPLIED)
        at, per = int(self.numbers[core.APPLIED_AT]), core.PER_APPLIED
        for first in self.torque[:, kernel.FIRST_ROW]:  # any piece of each, so that speeds can be asked for
            self.numbers[at : at + per] = self.rows[first]
            at += per
        self.fits = all(self._begin(k, one, speed) for k, one in enumerate(stepper.torques))

    def _begin(self, k: int, one: PlacedTorque, speed: float) -> bool:
        """Take the piece of a torque that the line begins in; whether there is one."""
        value = 0.0
        if one.axes and one.axes[0].variable == "speed":
            core, topo = line_kernel(), self.stepper.topo
            out = np.empty(len(self.state))
            integration.kernel().call_rate(self.stepper.equations.rate, 0.0, self.state, self.numbers, 0, 0, out)
            first = int(core.places(self.numbers)[3]) + len(topo.stations)
            value = one.sense * float(self.numbers[first + one.station])
        return bool(passage_kernel().into_piece(self.numbers, k, self.torque, self.knots, self.rows, self.known, value))

    @property
    def gained(self) -> float:
        """The least that its mean speed gained from one look to the next, per time [rad/s²]."""
        return float(self.clock[passage_kernel().GAINED])

    @property
    def time(self) -> float:
        """Where it stands [s]."""
        return float(self.clock[0])

    def on(self, length: float) -> tuple[str, float, float]:
        """Go on for ``length`` [s]: "reached", "crossed" where the line has the last speed, "out of time", or "other"
        for what this cannot follow; mean speed and highest mean speed of a look [rad/s]."""
        core, stepper, clock = passage_kernel(), self.stepper, self.clock
        n, since = stepper.topo.size, self.time
        begun = core.mean_angle(since, self.state, self.numbers, n, stepper.share)
        apart = length / LOOKS
        clock[2:7] = since, begun, since + apart, apart, -np.inf
        while True:
            code = core.stretch(
                stepper.equations.rate, self.numbers, self.state, n, stepper.share, stepper.turning,
                stepper.equations.weight, self.tolerance, since + length, self.last, FURTHEST, CHUNK, self.torque,
                self.knots, self.rows, self.known, clock,
            )  # fmt: skip
            if code != core.FULL:
                break
            if time_is_up():
                return "out of time", np.nan, np.nan
        if code == core.CROSSED:
            return "crossed", np.nan, np.nan
        if code != core.REACHED:
            return "other", np.nan, np.nan
        turned = core.mean_angle(self.time, self.state, self.numbers, n, stepper.share) - begun
        mean = turned / (self.time - since)
        return "reached", float(mean), float(max(clock[6], mean))
