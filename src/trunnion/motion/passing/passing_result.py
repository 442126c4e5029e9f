"""What became of a line on its way from one speed to another."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.motion.simulation.strongest_order import StrongestOrder
from trunnion.motion.transients.result import Transient
from trunnion.results.counts import few
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import coordinate, internal, labelled, variable
from trunnion.results.finding import Finding
from trunnion.results.outcome import Outcome
from trunnion.results.result import Result
from trunnion.results.speeds import about_speed, frequency_unit, rounded_speed
from trunnion.results.units import order_words
from trunnion.results.variables import Attribute, Variable


@dataclass(frozen=True)
class PassingEnd:
    """How it ended: ``kind``; time [s] of that, and ``rigid`` [s], which the rigid line takes; first and last speed
    asked for and the mean ``speed`` in the stretch [s] where it hung or vibrated most [rad/s]; the strongest order
    there; ``ways``: the kinds at two tolerances, where they differ."""

    kind: str
    time: float
    rigid: float
    first: float
    last: float
    speed: float
    stretch: tuple[float, float]
    strongest: StrongestOrder | None
    ways: tuple[str, str] | None


@labelled
class Passing(Result):
    """Whether a line came from one speed to another under its torques, and at which resonance it hung or vibrated."""

    shafts: tuple[str, ...] = coordinate("shaft")
    peak_torque: Array = variable("shaft", "N*m", "largest size on the way")
    peak_time: Array = variable("shaft", "s", "when that was")
    ending: PassingEnd = internal("how it ended")
    run: Transient = internal("the motion")
    phase: float = internal("of the input when it began", "rad")
    unit: str = internal("that speeds are printed in")

    @property
    def outcome(self) -> Outcome:
        """Its kind, "passed", "dwelt", "captured", "short of torque" or "undecided", and a sentence."""
        return Outcome(True, self.ending.kind, self._sentence())

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What the motion leaves out, and which limits of torque it exceeds."""
        return self.run.findings

    @property
    def passes(self) -> bool:
        """Whether it came to the last speed."""
        return self.ending.kind in ("passed", "dwelt")

    def _sentence(self) -> str:
        end, unit = self.ending, self.unit
        asked, at = rounded_speed(end.last, unit), about_speed(end.speed, unit)
        rigid = f"{end.rigid:.4g} s of the rigid line" if np.isfinite(end.rigid) else "which the rigid line never does"
        match end.kind:
            case "passed":
                return f"passed: has {asked} at t = {end.time:.4g} s ({rigid}); vibrates most at {at}{self._shaken()}"
            case "dwelt":
                ratio = end.time / end.rigid
                return (
                    f"dwelt: has {asked} at t = {end.time:.4g} s only, {ratio:.3g} times the {rigid}; vibrates most "
                    f"at {at}{self._shaken()}; give more torque, or damp more"
                )
            case "captured":
                return (
                    f"captured at {at}, short of {asked}{self._shaken()}; the rigid line would be there after "
                    f"{end.rigid:.4g} s; give more torque, damp more, or lower what excites"
                )
            case "short of torque":
                return f"short of torque: stays at {at}, and the rigid line does not come to {asked} either; give more"
        if end.ways:
            return (
                f"not decided whether it comes to {asked}: {end.ways[0]} at one tolerance, {end.ways[1]} at another, "
                "so that it stands on the edge; change the torque or the phase a little"
            )
        return f"not decided whether it comes to {asked} within {end.time:.4g} s; it turned at {at} last"

    def _shaken(self) -> str:
        """The order, what excites it, and the mode that it meets."""
        one = self.ending.strongest
        if one is None:
            return ""
        sources = f" of {few(one.sources)}" if one.sources else ""
        shown = frequency_unit(self.unit)
        mode = f" shakes mode {one.mode} ({rounded_speed(one.mode_frequency, shown)})" if one.mode else ""
        return f", where {order_words(one.order)}{sources}{mode or f' shakes {one.spring}'}"

    def declared(self) -> Iterator[Variable | Attribute]:
        """Peaks, and how it ended."""
        yield from super().declared()
        end = self.ending
        for name, value in (
            ("outcome", end.kind), ("says", self._sentence()), ("time", end.time),
            ("rigid_time", end.rigid if np.isfinite(end.rigid) else None), ("first", end.first), ("last", end.last),
            ("speed", end.speed), ("phase", self.phase),
            ("order", end.strongest.order if end.strongest else None),
            ("mode", end.strongest.mode or None if end.strongest else None),
        ):  # fmt: skip
            yield Attribute(name, value)

    def _lines(self) -> Iterator[str]:
        yield f"{self.run.line.system.name} {self._sentence()}"
        for name, peak, at in zip(self.shafts, self.peak_torque, self.peak_time, strict=True):
            yield f"  {name}: largest torque {peak:.6g} N m at t = {at:.4g} s"

    def plot(self, axes: Axes | None = None, *, shaft: str = "", unit: str = "") -> Axes:
        """Torque over the mean speed; see ``pictures.transients``."""
        return drawing(self, "plot")(self, axes, shaft=shaft, unit=unit)
