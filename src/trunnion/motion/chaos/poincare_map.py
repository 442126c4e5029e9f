"""Poincaré maps: the points in which a motion meets a section, once it has settled.

Stroboscopic: x(t₀ + kT), one point per forcing period (or per any other time). Section: the states at which a
function of the state crosses zero in one direction. A periodic motion gives as many points as it takes forcing
periods to close, a quasi-periodic one closed curves, a chaotic one a cloud with structure at every scale.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.errors import InputError
from trunnion.motion.chaos.chaos_subject import (
    as_system,
    failure,
    first_starts,
    motion_size,
    turns,
    usual_time,
    whole_number,
)
from trunnion.numerics.integration.integration import IntegrationEnd
from trunnion.numerics.memory import require_memory
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, computed, internal, labelled, variable
from trunnion.results.of_systems import about, states
from trunnion.results.outcome import Outcome
from trunnion.results.quantity_axes import state_axes
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Variable
from trunnion.steady.shooting.integration_outcomes import outcome_of
from trunnion.steady.shooting.repetition import Repetition, modulo, repetition
from trunnion.systems.events import Event
from trunnion.systems.maps import SectionMap, TimedMap
from trunnion.systems.system import System

MOST_STEPS = 10_000_000
"""Of the integrator between two looks at a section."""


@labelled
class PoincareMap(Result):
    """Points of a motion on a section."""

    system: System = internal("that was followed")
    points: Array = internal("after the transient", axes="point state")
    time: Array = variable("point", "s", "after the transient")
    size: Array = internal("how far each state moves between the points; returns are measured against it", axes="state")
    turns: Array = internal(
        "what may be added to a state without changing any rate, 2π of an angle, say: points count modulo these",
        axes="turn state",
    )
    section: str = attribute("what the points have in common")
    transient: int = attribute("periods or returns left out before")
    tolerance: float = attribute("error allowed per step")
    outcome: Outcome = internal("how it ended")

    @cached_property
    def repetition(self) -> Repetition:
        """After how many points the map repeats, and whether it still settles."""
        return repetition(self.points, self.size, np.asarray(self.system.scale), self.turns)

    @property
    @computed(attribute())
    def repeat(self) -> int:
        """After how many points the map repeats; 0 if it does not, or not within 64 points, or still settles."""
        return self.repetition.after

    @property
    @computed(attribute())
    def settling(self) -> bool:
        """Whether the map does not repeat but comes closer to it: give a longer ``transient``."""
        return self.repetition.settling

    @property
    def wrapped(self) -> Array:
        """The points modulo their turns; angles lie between −π and π."""
        return modulo(self.points, self.turns, np.asarray(self.system.scale))

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, every state by its name, and the system."""
        yield from states(self.system, "point", self.points)
        yield from super().declared()
        yield from about(self.system, self.outcome)

    def plot(self, axes: Axes | None = None, *, x: str = "", y: str = "", points: int | None = None) -> Axes:
        """One state over another; see ``pictures.chaos.poincare_map``."""
        return drawing(self, "plot")(self, axes, x=x, y=y, points=points)

    def __str__(self) -> str:
        count = f"{len(self.points)} point{'s' * (len(self.points) != 1)}"
        head = f"Poincaré map of {self.system.name}: {count}, {self.section}"
        axes = state_axes(self.system)
        rows = [
            f"  {name}: {column.min() * axis.factor:.6g} … {axis.number(float(column.max()))}"
            for name, axis, column in zip(self.system.states, axes, self.wrapped.T, strict=True)
            if len(column)
        ]
        if self.outcome.ok or self.repeat:
            rows.append(f"  {self.repetition}")
        return "\n".join([head, *rows, f"  {self.outcome}"])


def poincare_map(
    subject: System | Driveline,
    points: int = 2000,
    *,
    speed: float | str | None = None,
    section: Event | None = None,
    every: float | None = None,
    phase: float = 0.0,
    start: ArrayLike | None = None,
    transient: int = 500,
    longest: float | None = None,
    tolerance: float = 1e-10,
) -> PoincareMap:
    """Points of a settled motion, once per forcing period or at every crossing of a section.

    Parameters
    ----------
    subject : a ``System``, or a ``Driveline`` at ``speed``.
    points : how many.
    speed : input speed of a driveline [rad/s], by default its operating speed.
    section : crossings of an ``Event`` with a direction; by default stroboscopic, once per forcing period.
    every : time [s] between stroboscopic points instead of the forcing period.
    phase : time [s] within the forcing period at which stroboscopic points are taken.
    start : state (n,); by default the system's own.
    transient : points left out at the beginning.
    longest : time [s] after which a section counts as not met any more; by default 1000 forcing periods, or as many
        times what the motion needs to get about once around.
    tolerance : error allowed per step.

    Returns
    -------
    PoincareMap; its ``outcome`` says if the motion blew up or the section was not met, and what there was is kept.

    Raises
    ------
    InputError : neither a forcing period nor a section nor ``every``; a section without a direction.

    Examples
    --------
    >>> import trunnion as tn
    >>> duffing = tn.reference_system("duffing")
    >>> found = tn.poincare_map(duffing, 20)
    >>> found.points.shape, [round(float(x), 4) for x in found.points[-1]]
    ((20, 2), [-0.4136, 0.07])
    """
    system = as_system(subject, speed)
    whole_number("points", points, 1)
    needed = 16.0 * (points + transient) * (system.size + 1)
    require_memory(needed, key="points", value=points, remedy="ask for fewer points")
    whole_number("transient", transient, 0)
    state = first_starts(system, start, 1)[0]
    if section is not None:
        if every is not None:
            raise InputError("and section are two ways to say one thing", key="every", remedy="leave one out")
        return _sectioned(system, section, state, points, transient, longest, tolerance)
    interval = every if every is not None else system.forcing_period
    if interval is None:
        raise InputError(
            "is autonomous: it has no period for a stroboscopic map", element=system.name, key="period",
            remedy=f'give a section, tn.Event("{system.states[0]}", 0.0, direction=1), or every=, a time',
        )  # fmt: skip
    if not (np.isfinite(interval) and interval > 0):
        raise InputError("must be a positive time", key="every", value=interval)
    over_interval = TimedMap.over(system, interval, phase=phase, tolerance=tolerance)
    motion = over_interval.motion(state, np.empty((0, system.size)))
    early = motion.run(transient)
    found = motion.run(points) if early.end is IntegrationEnd.REACHED else early
    settled = found.states if early.end is IntegrationEnd.REACHED else found.states[:0]
    words = f"every {interval:.6g} s" if every is not None else f"every forcing period of {interval:.6g} s"
    outcome = Outcome(True, "reached", f"{len(settled)} points after {transient} left out")
    if found.end is not IntegrationEnd.REACHED:
        outcome = failure(
            system, motion, 2 * interval, f"after {early.finished + len(settled)} points, time counted from there: "
        )
    times = np.asarray(interval * np.arange(len(settled)), dtype=float)
    return _result(system, settled, times, words, transient, tolerance, outcome, interval)


def _sectioned(
    system: System, section: Event, state: Array, points: int, transient: int, longest: float | None, tolerance: float
) -> PoincareMap:
    if longest is None and system.forcing_period is None:
        longest = 1000 * usual_time(system, state, tolerance)
    cut = SectionMap(system, section, longest, tolerance, MOST_STEPS)
    met = cut.crossings(state, points + transient)
    found, at, have = met.points[transient:], met.time[transient:], len(met.points)
    outcome = Outcome(True, "reached", f"{points} points after {transient} left out")
    if met.run.end is not IntegrationEnd.REACHED:
        guards = (*(system.regimes.guards if system.regimes else ()), section.label)
        outcome = outcome_of(system, met.run, tolerance, guards)
    elif have < points + transient:
        outcome = Outcome(
            False, "never crossed",
            f"{section.label} was crossed {have} times and then not within {cut.limit:.6g} s; choose a level the "
            "motion passes, the other direction, or raise longest",
        )  # fmt: skip
    length = float(np.mean(np.diff(at))) if len(at) > 1 else cut.limit / 100
    at = at - (at[0] if len(at) else 0.0)
    arrow = "rising" if section.direction > 0 else "falling"
    return _result(system, found, at, f"{section.label} {arrow}", transient, tolerance, outcome, length)


def _result(
    system: System, points: Array, time: Array, words: str, transient: int, tolerance: float, outcome: Outcome,
    interval: float,
) -> PoincareMap:  # fmt: skip
    turning = turns(system, points) if len(points) else np.zeros((0, system.size))
    size = motion_size(system, points[-1], interval, tolerance) if len(points) else np.zeros(system.size)
    return PoincareMap(system, points, time, size, turning, words, transient, tolerance, outcome)
