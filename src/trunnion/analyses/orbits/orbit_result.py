"""A periodic motion of a system and its stability, as a result."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.numerics.curves import extremes, fourier
from trunnion.numerics.integration.integration import Trajectory
from trunnion.results.declared import Held, Result, axis, ending, fields_over, over, parameters_of, remark
from trunnion.results.drawing import Axes, drawing
from trunnion.results.outcome import Outcome
from trunnion.results.quantity_axes import state_axis
from trunnion.results.verdict import MEANING, Verdict
from trunnion.systems.system import System


@dataclass(frozen=True, repr=False)
class PeriodicOrbit(Result):
    """A periodic motion and its stability.

    start (n,); period [s]; time (points,) and state (points, n) over one period, ends included; multipliers
    (n,) by falling modulus with multiplier_error (n,); spectral_radius and error_estimate leave out the
    trivial multiplier of an autonomous system that moves (one at rest has none: outcome "at rest"), and the
    ``speed_multiplier`` of a free line none of whose torques depends on the speed (NaN elsewhere); monodromy (n, n);
    liouville_defect: |ln det Φ − ∫tr ∂f/∂x dt|, NaN where a jump takes part; residual: of the period, in units of the
    states' scale; regime_changes: how often the motion changes its regime in a period.
    """

    system: System
    start: Array
    period: float
    time: Array
    state: Array
    multipliers: Complex
    multiplier_error: Array
    monodromy: Array
    spectral_radius: float
    error_estimate: float
    verdict: Verdict
    liouville_defect: float
    residual: float
    iterations: int
    outcome: Outcome
    trajectory: Trajectory
    speed_multiplier: float = float("nan")

    @property
    def growth_rate(self) -> float:
        """Growth of the fastest disturbance [1/s]; negative when it decays."""
        return float(np.log(self.spectral_radius) / self.period) if self.spectral_radius > 0 else -np.inf

    @property
    def _growth(self) -> str:
        if self.spectral_radius > self.error_estimate:
            return f"{self.growth_rate:+.6g} 1/s"
        most = np.log(self.spectral_radius + self.error_estimate) / self.period
        return f"below {most:+.3g} 1/s"

    @property
    def regime_changes(self) -> int:
        """How often the motion changes its regime in a period."""
        return len(self.trajectory.event_time)

    @property
    def mean(self) -> Array:
        """Mean of every state (n,) over a period, integrated on the dense output."""
        return self.harmonics(0)[0].real

    def harmonics(self, highest: int) -> Complex:
        """Fourier coefficients (highest + 1, n): x = Re Σ c_k e^{2πikt/T}; |c_k| is the amplitude.

        Integrals over the dense output: nothing above the highest order folds back on them.
        """
        return fourier(self.trajectory.at, self.trajectory.time_of_state, highest)

    @cached_property
    def peak_to_peak(self) -> Array:
        """Largest minus smallest value of every state (n,), found on the dense output."""
        return extremes(self.trajectory.at, self.trajectory.time_of_state).span

    def declared(self) -> Iterator[Held]:
        """Every state over one period, and the multipliers."""
        yield axis("time", self.time, "s")
        for i, (name, unit) in enumerate(zip(self.system.states, self.system.units, strict=True)):
            yield over("time", name, self.state[:, i], unit)
        yield over("multiplier_number", "multiplier", self.multipliers, "1")
        yield over("multiplier_number", "multiplier_error", self.multiplier_error, "1")
        yield from fields_over("", self, spectral_radius="1", error_estimate="1", growth_rate="1/s", period="s")
        yield remark("system", self.system.name)
        yield remark("verdict", str(self.verdict))
        yield from ending(self.outcome)
        yield remark("residual", self.residual)
        yield remark("liouville_defect", self.liouville_defect)
        yield remark("tangents", "exact" if self.system.exact_tangents else "differenced")
        yield from parameters_of(self.system)

    def plot(self, axes: Axes | None = None, *, x: str = "", y: str = "") -> Axes:
        """Portrait of the orbit; see ``trunnion.plots.motion``."""
        return drawing(self, "plot")(self, axes, x=x, y=y)

    def __str__(self) -> str:
        if not self.outcome.ok:
            return f"no periodic motion of {self.system.name}: {self.outcome}"
        changes = f", {self.regime_changes} changes of regime" if self.system.regimes else ""
        tangents = "" if self.system.exact_tangents else "; tangents differenced"
        what = "equilibrium" if self.outcome.kind == "at rest" else "periodic motion"
        states = zip(self.system.states, self.system.units, strict=True)
        axes = [state_axis(name, unit, self.system.speed_unit) for name, unit in states]
        rows = [
            f"  {name}: {mean * axis.factor:.6g} ± {axis.number(float(peak) / 2)}"
            for name, mean, peak, axis in zip(self.system.states, self.mean, self.peak_to_peak, axes, strict=True)
        ]
        return "\n".join(
            [
                f"{self.verdict} {what} of {self.system.name}, period {self.period:.8g} s{changes}: "
                f"{MEANING[self.verdict]}",
                f"  spectral radius {self.spectral_radius:.10g} ± {self.error_estimate:.1e}, growth rate "
                f"{self._growth}{tangents}",
                *rows,
                f"  {self.outcome}",
            ]
        )


def speed_in_words(orbit: PeriodicOrbit) -> str:
    """What becomes of a change of the mean speed of a free line none of whose torques depends on the speed."""
    rate = float(np.log(orbit.speed_multiplier) / orbit.period) if orbit.speed_multiplier > 0 else np.nan
    return (
        f"no torque depends on the speed: a change of the mean speed goes at {rate:+.3g} 1/s (multiplier "
        f"{orbit.speed_multiplier:.10g}), which the verdict leaves out"
    )
