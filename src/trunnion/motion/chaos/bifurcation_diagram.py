"""Bifurcation diagrams: the points of the Poincaré map as one parameter moves up, and down again.

At each value the motion begins where it ended at the one before, so it stays on its attractor for as long as
that exists; where up and down differ, there are several.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Flags, Integers
from trunnion.driveline.driveline import Driveline
from trunnion.errors import InputError
from trunnion.motion.chaos.chaos_subject import as_system, first_starts, values_of, whole_number
from trunnion.motion.chaos.poincare_map import PoincareMap, poincare_map
from trunnion.numerics.memory import require_memory
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, coordinate, internal, labelled, variable
from trunnion.results.of_systems import about, states
from trunnion.results.outcome import Outcome
from trunnion.results.quantity_axes import axis_of_parameter
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Variable
from trunnion.systems.events import Event
from trunnion.systems.system import System

DIRECTIONS = ("up", "down")


@labelled
class BifurcationDiagram(Result):
    """Points of the map over a parameter."""

    system: System = internal("that was followed")
    parameter: str = internal("that was moved")
    values: Array = coordinate("value", "{self.parameter_unit}", "{self.parameter}")
    directions: tuple[str, ...] = coordinate("direction")
    points: Array = internal("NaN where the motion failed", axes="direction value point state")
    repeat: Integers = variable(
        "direction value", "", "points after which the map repeats, 0 if it does not, -1 where the motion failed"
    )
    settling: Flags = internal(
        "where it does not repeat and comes closer to it, so that a longer transient would tell", axes="direction value"
    )
    section: str = attribute("what the points have in common")
    transient: int = attribute("periods or returns left out before")
    tolerance: float = attribute("error allowed per step")
    outcome: Outcome = internal("how it ended")

    @property
    def parameter_unit(self) -> str:
        """SI unit of the parameter."""
        return self.system.parameter_units.get(self.parameter, "1")

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, every state by its name, and the system."""
        yield from states(self.system, "direction value point", self.points)
        yield from super().declared()
        yield Variable("settling", self.settling, "direction value")
        yield from about(self.system, self.outcome)

    def plot(self, axes: Axes | None = None, *, state: str = "") -> Axes:
        """One state over the parameter; see ``pictures.chaos.bifurcations``."""
        return drawing(self, "plot")(self, axes, state=state)

    def __str__(self) -> str:
        along = axis_of_parameter(self.system, self.parameter)
        low, high = self.values[0] * along.factor, along.number(float(self.values[-1]))
        rows = [
            f"bifurcation diagram of {self.system.name} over {self.parameter} = {low:.6g} … {high}, "
            f"{len(self.values)} values, {self.points.shape[2]} points each, {self.section}"
        ]
        for direction, repeat, settling in zip(self.directions, self.repeat, self.settling, strict=True):
            counts = {int(k): int(np.sum(repeat == k)) for k in np.unique(repeat[repeat > 0])}
            known = ", ".join(f"{count} repeat after {k}" for k, count in counts.items())
            known = f"{known or 'none repeats'}; {int(np.sum((repeat == 0) & ~settling))} do not repeat"
            late = f"; {int(np.sum(settling))} still settle: raise transient" if settling.any() else ""
            rows.append(f"  {direction}: {known}{late}")
        return "\n".join([*rows, f"  {self.outcome}"])


def bifurcation_diagram(
    subject: System | Driveline,
    parameter: str,
    values: ArrayLike | tuple[float, float, int],
    *,
    directions: Sequence[str] = DIRECTIONS,
    points: int = 60,
    transient: int = 300,
    speed: float | str | None = None,
    section: Event | None = None,
    start: ArrayLike | None = None,
    tolerance: float = 1e-9,
    progress: Callable[[float], None] | None = None,
) -> BifurcationDiagram:
    """Points of the Poincaré map over one parameter: where a motion doubles its period or becomes chaotic.

    Each value begins with the motion in which its neighbour ended, so that up and down may follow different motions.

    Parameters
    ----------
    subject : a ``System``, or a ``Driveline``.
    parameter : a name among the system's parameters; of a driveline "speed" or "HookeJoint 1.angle", say.
    values : (first, last, how many), or rising values (values,), in SI units.
    directions : "up", "down", or both.
    points : points of the map kept at each value.
    transient : points left out at each value.
    speed : input speed of a driveline [rad/s], where it is not the parameter.
    section : of an autonomous system, as for ``poincare_map``.
    start : state (n,) at the first value; by default the system's own.
    tolerance : error allowed per step.
    progress : called as progress(share done).

    Returns
    -------
    BifurcationDiagram: the points at every value and in each direction.

    Raises
    ------
    InputError : no such parameter or direction; what ``poincare_map`` refuses.

    Examples
    --------
    >>> import trunnion as tn
    >>> duffing = tn.reference_system("duffing")
    >>> found = tn.bifurcation_diagram(duffing, "force", (0.1, 0.3, 3), points=8, transient=200)
    >>> print(found)
    bifurcation diagram of duffing over force = 0.1 … 0.3, 3 values, 8 points each, every forcing period
      up: 3 repeat after 1; 0 do not repeat
      down: 3 repeat after 1; 0 do not repeat
      every value was reached
    """
    system = as_system(subject, speed)
    chosen = values_of(system, parameter, values)
    whole_number("points", points, 8)
    if not directions or any(d not in DIRECTIONS for d in directions):
        raise InputError("is not a direction", key="directions", value=list(directions), remedy='write "up" or "down"')
    needed = 8.0 * len(directions) * len(chosen) * points * system.size
    require_memory(needed, key="points", value=points, remedy="ask for fewer values, or fewer points of each")
    first = first_starts(system, start, 1)[0]
    report_progress = progress or (lambda share: None)
    found = np.full((len(directions), len(chosen), points, system.size), np.nan)
    repeat = np.full((len(directions), len(chosen)), -1, dtype=np.int64)
    settling = np.zeros(repeat.shape, dtype=bool)
    failed: list[str] = []
    shown: PoincareMap | None = None
    for d, direction in enumerate(directions):
        state = first
        order = range(len(chosen)) if direction == "up" else range(len(chosen) - 1, -1, -1)
        for done, i in enumerate(order):
            here = system.with_parameters({parameter: float(chosen[i])})
            mapped = poincare_map(here, points, section=section, start=state, transient=transient, tolerance=tolerance)
            report_progress((d + (done + 1) / len(chosen)) / len(directions))
            if not mapped.outcome.ok:
                failed.append(f"{direction} at {parameter} = {chosen[i]:.6g}: {mapped.outcome}")
                state = first
                continue
            shown = mapped
            found[d, i], repeat[d, i], settling[d, i] = mapped.wrapped, mapped.repeat, mapped.settling
            state = mapped.points[-1]
    outcome = Outcome(True, "reached", "every value was reached")
    if failed:
        sentence = f"{len(failed)} of {repeat.size} values failed, the first {failed[0]}"
        outcome = Outcome(False, "failed in part", sentence)
    words = shown.section if shown else ""
    return BifurcationDiagram(
        system,
        parameter,
        chosen,
        tuple(directions),
        found,
        repeat,
        settling,
        words.split(" of ")[0],
        transient,
        tolerance,
        outcome,
    )
