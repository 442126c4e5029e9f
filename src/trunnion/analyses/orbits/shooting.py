"""P(x; λ) = x as equations of a curve in z = (unknowns, λ), by shooting: what a branch of periodic motions is made of.

Of a line that starts free the torque that its drives give beyond the balance of their loads is unknown in place of the
first rotation, which is held where it is (see ``free_orbit``).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.orbits.free_orbit import neutral_motions, torque_scale
from trunnion.analyses.orbits.periodic_orbit import COARSER, beside_neutral, multipliers_of, scaled_matrix
from trunnion.analyses.orbits.systems_over import LINE_SCALE, SystemOver
from trunnion.driveline.parameters import SPEED
from trunnion.errors import InputError
from trunnion.numerics.continuation.arclength import CurvePoint
from trunnion.numerics.curves import extremes, fourier
from trunnion.numerics.integration.integration import End, Trajectory, integrate
from trunnion.numerics.spectrum import spectral_radius
from trunnion.systems.system import System

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
CLEAR = 1e-6
"""Distance of a spectral radius from 1 at which no error of the integration matters."""
MOST_INTEGRATION_STEPS = 200_000


@dataclass
class Shooting:
    """z = (x, λ) of a forced motion; see ``branch.Problem``."""

    over: SystemOver
    periods: int
    tolerance: float
    shots: dict[bytes, Trajectory | None] = field(default_factory=dict)
    by_difference: tuple[int, ...] = ()
    """Places of unknowns that are no states."""

    @property
    def scale(self) -> Array:
        return self.over.scale

    @property
    def size(self) -> int:
        return len(self.over.scale) - 1

    @property
    def state_scale(self) -> Array:
        """Size of each state that counts as one."""
        return self.scale[:-1]

    def system(self, z: Array) -> System:
        """The system at a point of the curve."""
        return self.over.at(float(z[-1]))

    def state(self, z: Array) -> Array:
        """The state at t = 0."""
        return z[:-1]

    def start(self, point: CurvePoint) -> Array:
        return self.state(point.z)

    def shoot(self, z: Array, tangents: bool = True, looser: float = 1.0) -> Trajectory | None:
        """One period from x at λ, with Φ in its tangents; None where there is no such motion."""
        n = len(z) - 1
        try:
            system = self.system(z)
        except InputError:  # a trial value may be no value of this parameter
            return None
        if not np.all(np.isfinite(z)) or system.forcing_period is None:
            return None
        x = self.state(z)
        block = np.vstack([x, np.eye(n)]) if tangents else x[None]
        run = integrate(
            system.equations, 0.0, self.periods * system.forcing_period, block,
            regime=system.regime_at(0.0, x), tolerance=looser * self.tolerance, dense=False,
            most_steps=MOST_INTEGRATION_STEPS,
        )  # fmt: skip
        return run if run.end is End.REACHED else None

    def equations(self, z: Array) -> tuple[Array, Array]:
        """P(x; λ) − x and its derivative by (x, λ), in units of the states' scales; NaN where there is none."""
        n, run = len(z) - 1, self.shoot(z)
        by = {place: self.differenced(z, place) for place in (*self.by_difference, n)} if run is not None else {}
        if run is None or any(column is None for column in by.values()):
            return np.full(n, np.nan), np.full((n, n + 1), np.nan)
        slope = np.hstack([run.final[1:].T - np.eye(n), np.zeros((n, 1))])
        for place, column in by.items():
            slope[:, place] = column
        return (run.final[0] - self.state(z)) / self.state_scale, slope / self.state_scale[:, None]

    def differenced(self, z: Array, place: int) -> Array | None:
        """∂P by one unknown that is no state, by a central difference."""
        h, ends = 1e-4 * self.scale[place], []
        for side in (-1.0, 1.0):
            moved = z.copy()
            moved[place] += side * h
            run = self.shoot(moved, tangents=False)
            if run is None:
                return None
            ends.append(run.final[0])
        return np.asarray((ends[1] - ends[0]) / (2 * h))

    def closed(self, point: CurvePoint) -> Trajectory | None:
        """The motion at a point of the curve, computed once."""
        key = point.z.tobytes()
        if key not in self.shots:
            self.shots[key] = self.shoot(point.z)
        return self.shots[key]

    def multipliers(self, point: CurvePoint) -> Complex:
        """By falling modulus; NaN where the motion cannot be computed."""
        run = self.closed(point)
        if run is None:
            return np.full(len(point.z) - 1, np.nan, dtype=complex)
        values = np.linalg.eigvals(run.final[1:]).astype(complex)
        return np.asarray(values[np.argsort(-np.abs(values))])

    def radius_error(self, point: CurvePoint, radius: float) -> float:
        """Near 1 estimated as that of a single orbit is; farther away it does not matter."""
        run = self.closed(point)
        if abs(radius - 1) > CLEAR or run is None:
            return CLEAR
        coarse = self.shoot(point.z, looser=COARSER)
        if coarse is None:
            return CLEAR
        missed = float(np.abs((run.final[0] - self.state(point.z)) / np.asarray(self.system(point.z).scale)).max())
        values, bound = self.judged(point, run, coarse, missed)
        return float(spectral_radius(values, bound)[1])

    def judged(self, point: CurvePoint, run: Trajectory, coarse: Trajectory, missed: float) -> tuple[Complex, Array]:
        """Multipliers that count, and what each may be off by."""
        return multipliers_of(self.system(point.z), run, coarse, missed)

    def changes(self, point: CurvePoint) -> int:
        """Changes of regime in a period."""
        run = self.closed(point)
        return -1 if run is None else len(run.event_time)

    def observed(self, point: CurvePoint) -> tuple[Array, Array, Array, float]:
        """See ``branch.Problem``; NaN where the motion cannot be computed."""
        system = self.system(point.z)
        assert system.forcing_period is not None
        period = self.periods * system.forcing_period
        run = self._seen(system, self.state(point.z), period)
        if run is None:
            curves = np.full(len(self.over.curves), np.nan)
            return curves, curves, np.full(self.size, np.nan), period
        amplitude = np.abs(fourier(run.at, run.time_of_state, self.periods)[self.periods])
        seen = extremes(lambda times: self.over.observe(system, times, run.at(times)), run.time_of_state)
        return seen.span, seen.largest, amplitude, period

    def _seen(self, system: System, start: Array, period: float) -> Trajectory | None:
        """One period with dense output. A motion that touches a switching surface may chatter there at one tolerance
        and pass at another; both look the same."""
        for looser in (1, 10, 100):
            run = integrate(
                system.equations, 0.0, period, start, regime=system.regime_at(0.0, start),
                tolerance=looser * self.tolerance, most_steps=MOST_INTEGRATION_STEPS,
            )  # fmt: skip
            if run.end is End.REACHED:
                return run
        return None


class FreeShooting(Shooting):
    """z = (torque, x₂ … x_n, λ) of a line that starts free, its first rotation held at ``anchor``."""

    def __init__(self, over: SystemOver, periods: int, tolerance: float, *, anchor: float) -> None:
        super().__init__(over, periods, tolerance, by_difference=(0,))
        assert over.line is not None
        self.anchor = anchor
        self._scale = np.append(LINE_SCALE * torque_scale(over.line), over.scale[1:])

    @property
    def scale(self) -> Array:
        return self._scale

    @property
    def state_scale(self) -> Array:
        return self.over.scale[:-1]

    def system(self, z: Array) -> System:
        return self.over.at(float(z[-1]), float(z[0]))

    def state(self, z: Array) -> Array:
        return np.append(self.anchor, z[1:-1])

    def multipliers(self, point: CurvePoint) -> Complex:
        """Those that count: without what only shifts the phase, or changes a speed that no torque depends on."""
        run = self.closed(point)
        if run is None:
            return np.full(self.size, np.nan, dtype=complex)
        values = self.judged(point, run, run, 0.0)[0]
        return np.asarray(values[np.argsort(-np.abs(values))])

    def judged(self, point: CurvePoint, run: Trajectory, coarse: Trajectory, missed: float) -> tuple[Complex, Array]:
        assert self.over.line is not None
        system = self.system(point.z)
        neutral = neutral_motions(self.over.line, system.parameters[SPEED])(system, self.state(point.z))
        values, bound, _ = beside_neutral(
            *scaled_matrix(system, run, coarse, missed), neutral, np.asarray(system.scale)
        )
        return values, bound
