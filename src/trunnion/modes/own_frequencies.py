"""Modes of a line with oil that goes with the frequency: each is found where the oil is as at its own frequency.

Mode j is that of equations with a spring and a damper which are the oil at ω. Its damped frequency ω_j(ω), of an
overdamped mode the undamped one, is ω itself: a fixed point, found by steps of the secant rule.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.dampers import ViscousDamper
from trunnion.driveline.oil import UNSTATED
from trunnion.driveline.quantities import FREQUENCY, shown
from trunnion.equations.aligned import UnitMasses, aligned_matrices, loaded_matrices
from trunnion.equations.coefficients import Assembly
from trunnion.modes.damped_modes import LineModes, line_modes
from trunnion.results.finding import Finding, Gravity

MOST, SAME = 60, 1e-13
"""Steps, and the relative change of a frequency within which it stays."""


@dataclass(frozen=True)
class OwnModes:
    """Modes, undamped shapes (rotation, mode), the largest entry 1, and what is said of those that the oil's points do
    not reach."""

    modes: LineModes
    shape: Array
    findings: tuple[Finding, ...]


def own_modes(assembly: Assembly) -> OwnModes | None:
    """The modes of a line; None where no oil goes with the frequency."""
    oils = {i: one for i, one in enumerate(assembly.line.elements) if isinstance(one, ViscousDamper) and one.oil}
    if not oils:
        return None
    return _Search(assembly, oils).found()


class _Search:
    def __init__(self, assembly: Assembly, oils: dict[int, ViscousDamper]) -> None:
        self.assembly, self.oils = assembly, oils
        reach = [
            one.law.reach(UNSTATED if one.oil_temperature is None else one.oil_temperature) for one in oils.values()
        ]
        self.low, self.high = max(low for low, _ in reach), min(high for _, high in reach)

    def at(self, frequency: float) -> tuple[LineModes, Array]:
        """Modes and undamped shapes with the oil as at a frequency [rad/s]."""
        table = self.assembly.table(1)
        for place in self.oils:
            table[0, self.assembly.packed.column(place, "oil_frequency")] = np.clip(frequency, self.low, self.high)
        co, topo = self.assembly.coefficients(table, any_frequency=True), self.assembly.topology
        matrices = loaded_matrices(topo, co, np.zeros(1))
        unit = UnitMasses(matrices.inertia[0])
        damping, stiffness, loss = (
            unit.of_matrix(part[0]) for part in (matrices.damping, matrices.stiffness, matrices.loss)
        )
        found = line_modes(damping, stiffness, loss, unit.of_rotations(topo.loose), topo.rigid_count)
        aligned = aligned_matrices(topo, co)
        shape = unit.rotations(np.linalg.eigh(UnitMasses(aligned.inertia[0]).of_matrix(aligned.stiffness[0]))[1])
        if topo.still > 1:
            shape[:, : topo.still] = topo.loose
        return found, np.asarray(shape / shape[np.abs(shape).argmax(0), np.arange(len(shape))])

    def found(self) -> OwnModes:
        first, shapes = self.at(next(float(one.oil_frequency or 0.0) for one in self.oils.values()))
        undamped, eigenvalue = first.undamped.copy(), first.eigenvalue.copy()
        shape, complex_shape = shapes.copy(), first.shape.copy()
        beyond = []
        for j in range(self.assembly.topology.still, len(undamped)):
            frequency, settled = self._own(j, self._of(first, j))
            modes, every = self.at(frequency)
            undamped[j], eigenvalue[j] = modes.undamped[j], modes.eigenvalue[j]
            shape[:, j], complex_shape[:, j] = every[:, j], modes.shape[:, j]
            if not settled or not self.low <= frequency <= self.high:
                beyond.append((j + 1, frequency, settled))
        return OwnModes(LineModes(undamped, eigenvalue, complex_shape), shape, tuple(map(self._said, beyond)))

    def _said(self, mode: tuple[int, float, bool]) -> Finding:
        number, frequency, settled = mode
        at = shown(frequency, FREQUENCY, digits=4)
        if not settled:
            return Finding(Gravity.CAUTION, f"mode {number} settles at no frequency of the oil; it is as at {at}")
        end = shown(float(np.clip(frequency, self.low, self.high)), FREQUENCY, digits=4)
        return Finding(Gravity.CAUTION, f"mode {number} at {at} lies beyond the points of the oil, taken as at {end}")

    @staticmethod
    def _of(modes: LineModes, j: int) -> float:
        damped = float(modes.eigenvalue[j, 0].imag)
        return damped if damped > 0 else float(modes.undamped[j])

    def _own(self, j: int, start: float) -> tuple[float, bool]:
        """The frequency [rad/s] at which mode j has the oil of that frequency, and whether it settled."""
        at, before = start, None
        for _ in range(MOST):
            left = self._of(self.at(at)[0], j) - at
            if abs(left) <= SAME * at:
                return at, True
            onward = at + left
            if before is not None and left != before[1]:
                slope = (left - before[1]) / (at - before[0])
                secant = at - left / slope if slope else onward
                onward = secant if 0.5 * at < secant < 2 * at else onward
            before, at = (at, left), onward
            if at == before[0]:
                return at, True
        return at, False
