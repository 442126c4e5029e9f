"""What the clutches of a line do in a periodic motion that is integrated, and where one slips on and none is found."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.driveline.clutches import Clutch
from trunnion.equations.line_system import LineSystem
from trunnion.equations.steady_base import bent
from trunnion.motion.orbits.stuck_clutches import StuckClutch, slips_on, stuck_clutches
from trunnion.numerics.curves import extremes, fourier
from trunnion.numerics.integration.integration import Trajectory
from trunnion.results.outcome import Outcome
from trunnion.steady.shooting.periodic_orbit import TOLERANCE, PeriodicOrbit, closing_of
from trunnion.systems.maps import SETTLED, IntegratedMap
from trunnion.systems.sticking import holding
from trunnion.systems.system import System

HALVINGS = 6
"""Of one step, where the motion beyond it does not close."""
TRIES = 20
"""Steps in which an end of the continuum is looked for."""
REACHED = 1e-7
"""Room that a slider may have left there, over the deflection at which it slips."""
UNDRIVEN = 1e-7
"""Singular value of the closing condition, over its largest, that counts as none."""
WAITED = 100
"""Periods after which a clutch shows whether it slips on."""


def continuum_of(line: LineSystem, orbit: PeriodicOrbit) -> tuple[StuckClutch, ...]:
    """The clutches with sliders that never slip in a motion of the line."""
    if not orbit.stuck:
        return ()
    stuck = [orbit.system.sliders.index(name) for name in orbit.stuck]
    here = _Sticking.of(line, orbit.system, orbit.start, orbit.period, np.array(stuck))
    low, high = here.deflections
    ends = None if _shifts_alike(line, stuck) else here.ends
    return stuck_clutches(line.assembly, line.sliders, stuck, low, high, here.mean_twist, ends)


def _shifts_alike(line: LineSystem, stuck: list[int]) -> bool:
    """Whether the motion only shifts with the mean twist of the clutches that these sliders are of: the joints are
    straight, the springs have one stage, and no torque by order acts where their twist has turned it. Without a spring
    the clutch may be turned as a whole, as its start is anyway."""
    topo, elements = line.assembly.topology, line.assembly.line.elements
    clutches = [elements[topo.compliances[line.sliders[i].compliance].shafts[0]] for i in stuck]
    springs = [clutch.stiffnesses for clutch in clutches if isinstance(clutch, Clutch)]
    by_order = any(one.order for one in line.torques)
    if bent(line.assembly) or any(len(stiffnesses) > 1 for stiffnesses in springs):
        return False
    return not by_order or not any(map(any, springs))


@dataclass(frozen=True)
class _Sticking:
    """A periodic motion of a line in which sliders stick: its start (n,) and one period of it, under a system in which
    those sliders cannot slip."""

    line: LineSystem
    place: IntegratedMap
    stuck: Integers
    start: Array
    run: Trajectory

    @classmethod
    def of(cls, line: LineSystem, system: System, start: Array, period: float, stuck: Integers) -> Self:
        """The motion from ``start``."""
        assert system.forcing_period is not None
        periods = round(period / system.forcing_period)
        place = IntegratedMap.of(holding(system, stuck), periods=periods, tolerance=TOLERANCE)
        return cls(line, place, stuck, start, place(start, dense=True).run)

    @cached_property
    def deflections(self) -> tuple[Array, Array]:
        """Least and greatest deflection of every slider [rad]."""
        seen = extremes(lambda times: self.run.at(times)[:, -len(self.line.sliders) :], self.run.time_of_state)
        return seen.low, seen.high

    @cached_property
    def mean_twist(self) -> Array:
        """Of every compliance [rad]."""
        system, run = self.place.system, self.run
        twist = fourier(lambda times: self.line.observe(system, times, run.at(times)).twist, run.time_of_state, 0)
        return np.asarray(twist[0].real)

    def ends(self, own: list[int]) -> tuple[float, float]:
        """Least and greatest mean twist [rad] of the clutch that the sliders ``own`` are of, NaN where none was found.

        The further up the sliders of a clutch stand, the less its spring carries, and the lower is its twist.
        """
        compliance = self.line.sliders[own[0]].compliance
        low, high = (self._end(own, side) for side in (1, -1))
        return tuple(float(one.mean_twist[compliance]) if one else np.nan for one in (low, high))  # type: ignore[return-value]

    def _end(self, own: list[int], side: int) -> _Sticking | None:
        """The motion of the continuum in which the sliders ``own`` all just reach where they slip, on one side."""
        reach = np.array([slider.reach for slider in self.line.sliders])
        now = self
        for _ in range(TRIES):
            low, high = now.deflections
            room = np.zeros(len(reach))
            room[own] = ((reach - high) if side > 0 else -(reach + low))[own]
            if np.abs(room / reach).max() <= REACHED:
                return now
            shares = 0.5 ** np.arange(HALVINGS)
            moved = next((one for share in shares if (one := now._moved(share * room)) is not None), None)
            if moved is None:
                return None
            now = moved
        return None

    def _moved(self, room: Array) -> _Sticking | None:
        """The motion of the continuum whose stuck sliders stand higher by ``room`` (slider,) [rad], to first order."""
        scale = np.asarray(self.place.system.scale)
        closes = self.run.final[1:].T * scale / scale[:, None] - np.eye(len(scale))
        # Directions that nothing drives: of a line that starts free its rotation is one as well.
        _, sizes, directions = np.linalg.svd(closes)
        count = max(len(self.stuck), int(np.sum(sizes <= UNDRIVEN * sizes[0])))
        alike = scale[:, None] * directions[-count:].T
        shown = alike[len(scale) - len(room) + self.stuck]
        step = alike @ np.linalg.lstsq(shown, room[self.stuck], rcond=None)[0]
        root = closing_of(self.place).solve(self.start + step)
        if not root.converged:
            return None
        return replace(self, start=root.x, run=self.place(root.x, dense=True).run)


def slipping_on(line: LineSystem, periods: int) -> Outcome | None:
    """What to say of a line where no motion was found because a clutch slips on with every period; None elsewhere."""
    place, states = IntegratedMap.of(line.system, periods=periods, tolerance=SETTLED), [line.rest()]
    for wait in (WAITED, 1, 1):
        settled = place.settle(states[-1], wait)
        if settled is None:
            return None
        states.append(settled)
    twists = line.observe(line.system, np.zeros(3), np.array(states[1:])).twist
    return slips_on(line.assembly, line.speed, line.sliders, twists)
