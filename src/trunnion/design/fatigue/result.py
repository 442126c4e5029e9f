"""What ``fatigue`` gives: damage by element and history, life, and the cycles that it is made of."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.driveline.quantities import TORQUE, eye_unit
from trunnion.driveline.refusals import nearest
from trunnion.driveline.sn_curves import SNCurve
from trunnion.errors import InputError
from trunnion.results.counts import counted
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, computed, coordinate, internal, labelled, variable
from trunnion.results.finding import Finding
from trunnion.results.result import Result
from trunnion.results.units import figures, with_unit

HOUR = 3600.0


@dataclass(frozen=True)
class CycleSpectrum:
    """The cycles of one element, in SI of its curve.

    amplitude, mean (cycles,); reversed (cycles,): the amplitude about zero that does the same; rate (cycles,): how$
    often each comes [1/s]; history (cycles,): the number of its history; damage (cycles,) [1/s].
    """

    amplitude: Array
    mean: Array
    reversed: Array
    rate: Array
    history: Integers
    damage: Array
    curve: SNCurve

    def axis(self, value: float) -> tuple[str, float]:
        """The unit that a value [Pa or N m] reads in, and its size in SI: MPa of stresses."""
        return ("MPa", 1e6) if self.curve.of_stress else eye_unit(value, TORQUE)

    def shown(self, value: float) -> str:
        """ "124.4 MPa", of a value in SI."""
        unit, size = self.axis(value)
        return with_unit(figures(value / size), unit)


@labelled
class FatigueLife(Result):
    """Damage by Miner's rule, and how long each element with an S–N curve lasts."""

    elements: tuple[str, ...] = coordinate("element", words="with an S–N curve")
    histories: tuple[str, ...] = coordinate("history")
    damage_rate: Array = variable("element history", "1/s", "Miner's sum over the operating time; NaN: not counted")
    error_rate: Array = variable("element", "1/s", "what the damage may be low by, of counting")
    allowed: Array = variable("element", "1", "Miner's sum that is allowed")
    peak: Array = variable("element history", "", "largest stress [Pa] or torque [N m], as of the curve")
    operating_life: float | None = attribute("operating time asked for", "s")
    spectra: tuple[CycleSpectrum, ...] = internal("cycles of each element")
    uncounted: tuple[str, ...] = internal("histories that could not be counted, with their reason")
    findings: tuple[Finding, ...] = internal("what to read first")
    unit: str = internal("that speeds are printed in")

    @property
    @computed(variable("element", "s", "operating time until the allowed sum is reached; infinite without damage"))
    def life(self) -> Array:
        """Operating time [s] that each element (element,) lasts."""
        with np.errstate(divide="ignore"):
            return np.asarray(self.allowed / self.damage_rate.sum(axis=1))

    @property
    @computed(variable("element", "1", "Miner's sum after the operating time asked for"))
    def damage(self) -> Array:
        """Miner's sum (element,) after the operating life; NaN without one."""
        return np.asarray(self.damage_rate.sum(axis=1) * self._wanted)

    @property
    @computed(variable("element", "1", "what it may be low by, of counting"))
    def damage_error(self) -> Array:
        """What ``damage`` (element,) may be low by."""
        return np.asarray(self.error_rate * self._wanted)

    @property
    def _wanted(self) -> float:
        return np.nan if self.operating_life is None else self.operating_life

    def spectrum(self, element: str = "") -> CycleSpectrum:
        """The cycles of an element, by default of the one that lasts shortest.

        Raises
        ------
        InputError : no such element.
        """
        if element and element not in self.elements:
            remedy = nearest(element, self.elements)
            raise InputError("has no S–N curve", key="element", value=element, remedy=remedy)
        return self.spectra[self.elements.index(element or self.weakest)]

    @property
    def weakest(self) -> str:
        """The element that lasts shortest of those that are known."""
        life = self.life
        return self.elements[int(np.nanargmin(life)) if np.any(np.isfinite(life)) else 0]

    def plot(self, axes: Axes | None = None, *, element: str = "") -> Axes:
        """Cycle spectrum and S–N curve of one element; see ``pictures.fatigue.fatigue``."""
        return drawing(self, "plot")(self, axes, element=element)

    def plot_damage(self, axes: Axes | None = None) -> Axes:
        """Damage of every element by history; see ``pictures.fatigue.damage``."""
        return drawing(self, "plot_damage")(self, axes)

    def table(self) -> list[dict[str, object]]:
        """One row an element: damage, life, what does most."""
        rows: list[dict[str, object]] = []
        for i, element in enumerate(self.elements):
            peak = np.nanmax(self.peak[i]) if np.any(np.isfinite(self.peak[i])) else np.nan
            row: dict[str, object] = {"element": element, "largest": self.spectra[i].shown(float(peak))}
            if self.operating_life is not None:
                row[f"sum after {hours(self.operating_life)}"] = float(self.damage[i])
            row |= {"allowed": float(self.allowed[i]), "lasts": hours(float(self.life[i])), "most by": self.leading(i)}
            rows.append(row)
        return rows

    def leading(self, place: int) -> str:
        """ "start (62 %)": the history that damages an element most; "" where none does."""
        rate = np.nan_to_num(self.damage_rate[place], posinf=np.inf)
        if not rate.sum() > 0:
            return ""
        at = int(rate.argmax())
        share = 1.0 if np.isinf(rate[at]) else rate[at] / rate.sum()
        return f"{self.histories[at]} ({100 * share:.3g} %)"

    @property
    def headline(self) -> str:
        """What was computed."""
        count = len(self.histories)
        over = f"{count} {'history' if count == 1 else 'histories'} of load"
        return f"fatigue of {counted(len(self.elements), 'element')} over {over}: rainflow cycles and Miner's sum"

    def _lines(self) -> Iterator[str]:
        yield self.headline
        for i, element in enumerate(self.elements):
            yield f"  {element}: {self.sentence(i)}"
        yield from (f"  not counted: {one}" for one in self.uncounted)

    def sentence(self, place: int) -> str:
        """ "Miner's sum 0.43 of 1 after 20000 h, lasts 46500 h, most by start (62 %)" of one element."""
        led, lasts, allowed = self.leading(place), float(self.life[place]), float(self.allowed[place])
        most = f", most by {led}" if led else ""
        if np.isnan(lasts):
            return f"not known, a history could not be counted{most}"
        after = ""
        if self.operating_life is not None:
            done, after_all = figures(float(self.damage[place]), 3), hours(self.operating_life)
            after = f"Miner's sum {done} of {allowed:g} after {after_all}, "
        if np.isinf(lasts):
            return f"{after}no damage, lasts without end"
        return f"{after}lasts {hours(lasts)}{most}"


def hours(seconds: float) -> str:
    """ "20000 h" to three figures."""
    if np.isinf(seconds):
        return "without end"
    return f"{figures(seconds / HOUR, 3)} h" if np.isfinite(seconds) else "not known"
