"""One box of speeds and tolerances of a line about the periodic motion that it makes: that it exists, and attracts.

Let x̃(φ, p) be nearly a periodic solution of x′ = F(φ, x, p), with R = F(x̃) − x̃′ left over, and P(φ, p) > 0 Hermitian
and periodic. In the tube V = (x − x̃)*P(x − x̃) ≤ ρ² let every matrix A between the slopes of F have

    N = P′ + A*P + PA ≤ −2μP.

Then V′ ≤ −2μV + 2√V √(R*PR), and where √(R*PR) < μρ no motion leaves the tube; two within it come together as e^(−μφ)
(A being the mean slope between them). The map over a period so contracts the tube's section: it holds one periodic
motion, and all multipliers of that are e^(−μ·period) at most (Demidovich's and Lohmiller and Slotine's contraction).
N is checked as in ``proof``, with the tube in the rests of the waves.

A free–free line has all its multipliers but the 1 of its phase in x, which is taken over the angle of its input, and
the first parameter is the constant torque that drives it. Motions depend on that continuously, and so do their mean
speeds: where it takes the mean speed from below the box to above it, every speed between is one of a motion that is
proved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.harmonics import unexcited
from trunnion.equations.loads import drive_places, drive_torques
from trunnion.equations.topology import require_period
from trunnion.floquet.certificate.box_coefficients import NumberRange, box_coefficients
from trunnion.floquet.certificate.box_equations import BoxMatrix, harmonics_needed
from trunnion.floquet.certificate.judge import JudgedBox
from trunnion.floquet.certificate.own_equations import MotionEquations, MotionWaves, Rates, residuals
from trunnion.floquet.certificate.own_start import Slowness, begun, solved
from trunnion.floquet.certificate.periodic_lyapunov import LyapunovSeries, lyapunov_series, modal_box
from trunnion.floquet.certificate.proof import check_tube
from trunnion.floquet.certificate.waves import OUTWARD, UNIT
from trunnion.steady.free.free_balance import FreeBalance, SteadyStates
from trunnion.steady.free.periodic_steady_states import SteadyStateCurve

BEYOND = 1e-6, 0.1
"""By what share of the speed, and of a box's width, the torque takes the speed beyond it."""
WIDER = (1.6, 3.0)
"""Heights V of tubes that are tried, over the least that the box needs without a tube."""
NARROW = 0.004
"""Width in ln(speed) of the first box that is tried."""
PER_HARMONIC = 24
"""Angles per harmonic at which P is looked at."""


@dataclass(frozen=True)
class OwnMotionLine:
    """A line about its own motion, box by box."""

    line: Driveline
    narrow = NARROW

    @cached_property
    def assembly(self) -> Assembly:
        """Without excitations."""
        return assemble(unexcited(self.line))

    @cached_property
    def balance(self) -> FreeBalance:
        """Of its harmonics."""
        turns = require_period(self.assembly.line, self.assembly.topology)
        return FreeBalance(self.assembly, 2 * np.pi * float(turns))

    def judged(self, speeds: tuple[float, float], given: Sequence[NumberRange]) -> JudgedBox:
        """The verdict on one box."""
        nothing = JudgedBox(False, np.inf, np.ones(1 + len(given)), doubtful=True)
        packed = self.assembly.packed
        ranges = [replace(one, columns=packed.resolve(one.label)) for one in given]
        with np.errstate(all="ignore"):
            try:
                begins = self._begun(speeds, ranges)
                if begins is None:
                    return nothing
                return _judged(*begins, speeds) or nothing
            except (ZeroDivisionError, np.linalg.LinAlgError):
                return nothing

    def _begun(
        self, speeds: tuple[float, float], ranges: Sequence[NumberRange]
    ) -> tuple[MotionEquations, MotionWaves, Rates] | None:
        middle = sum(speeds) / 2
        row = self.assembly.table(1, middle)
        for one in ranges:
            one.columns.put(row, np.array([(one.low + one.high) / 2]))
        motions = SteadyStateCurve(self.balance.along(lambda value: _rows(row, value)), speeds).at_all(
            np.array([middle])
        )
        if not (motions.found[0] and motions.resolved[0]):
            return None
        own = self._equations(speeds, ranges, motions)
        return None if (found := solved(own, begun(own, motions), _asked(own, speeds))) is None else (own, *found)

    def _equations(
        self, speeds: tuple[float, float], ranges: Sequence[NumberRange], motions: SteadyStates
    ) -> MotionEquations:
        assembly, topo = self.assembly, self.assembly.topology
        middle = sum(speeds) / 2
        last = max(harmonics_needed(assembly, ranges, speeds), motions.h)
        # The first parameter of a free–free line is a torque, not the speed.
        co = box_coefficients(assembly, (middle, middle) if topo.free else speeds, ranges, last)
        drive = np.zeros(len(topo.stations))
        if topo.free:
            row = assembly.table(1, middle)
            drive = -drive_torques(topo, drive_places(topo, assembly.packed.column, row), np.ones(1))[0]
        return MotionEquations(assembly, co, 1 + len(ranges), last, drive, np.zeros(len(topo.compliances)))


def _rows(row: Array, speeds: Array) -> Array:
    table = np.repeat(row, len(speeds), axis=0)
    table[:, 0] = speeds
    return table


def _asked(own: MotionEquations, speeds: tuple[float, float]) -> Slowness | None:
    if not own.assembly.topology.free:
        return None
    slow, fast = 1 / speeds[0], 1 / speeds[1]
    asked = np.zeros(1 + own.parameters)
    middle, half = (slow + fast) / 2, (slow - fast) / 2
    asked[:2] = middle, -(half * (1 + BEYOND[1]) + BEYOND[0] * middle)
    return Slowness(asked)


def _judged(own: MotionEquations, motion: MotionWaves, found: Rates, speeds: tuple[float, float]) -> JudgedBox | None:
    box = _matrix(own, found)
    modal = modal_box(box)
    if modal is None:
        return None
    series = lyapunov_series(box, modal)
    left = np.abs(modal.to_modes) @ np.array([one.size for one in residuals(own, motion, found)]) * OUTWARD
    first, least = check_tube(box, modal, series, left)
    if not first.proved:
        at = series.parts[0].sum(axis=0)
        doubtful = not series.solved or not np.linalg.eigvalsh((at + at.conj().T) / 2)[0] > 0
        return JudgedBox(False, first.excess, first.blame, doubtful=doubtful)
    missed = JudgedBox(False, np.inf, first.blame)
    stiff = _least_eigenvalue(series)
    off = np.abs(modal.to_modes @ modal.modes - np.eye(own.size)).sum(axis=1).max()
    if not (stiff > 0 and off < 0.01 and np.isfinite(least)):
        return missed
    reach = np.linalg.norm(modal.modes, axis=1) / np.sqrt(stiff) * 1.02
    for wider in WIDER:
        height = wider * least
        near = motion.widened(np.sqrt(height) * reach)
        known, needed = check_tube(_matrix(own, own.rates(near)), modal, series, left)
        if not known.proved:
            return replace(missed, excess=known.excess)
        if needed < height and _covers(own, near, speeds):
            return JudgedBox(True, known.excess, known.blame, known.decay * speeds[0] * (1 - 1e-12))
    return missed


def _covers(own: MotionEquations, motion: MotionWaves, speeds: tuple[float, float]) -> bool:
    """Whether the torque takes the mean speed from below to above all ``speeds``, whatever the tolerances."""
    if not own.assembly.topology.free:
        return True
    slowness = own.input_speed(motion).inverse()
    parts = slowness.parts[:, own.last].real
    aside = (float(np.abs(parts[2:]).sum()) + slowness.rest) * OUTWARD
    return bool(
        parts[0] - parts[1] - aside > (1 / speeds[0]) * OUTWARD
        and (parts[0] + parts[1] + aside) * OUTWARD < 1 / speeds[1]
    )


def _matrix(own: MotionEquations, found: Rates) -> BoxMatrix:
    """A = dF/dx over φ."""
    size, springs = own.size, len(own.assembly.topology.compliances)
    parts = np.zeros((1 + own.parameters, 2 * own.last + 1, size, size), dtype=complex)
    rest = np.zeros((size, size))
    for (i, j), wave in found.slopes.items():
        parts[:, :, i, j], rest[i, j] = wave.parts, wave.rest
    stiffness = [one.mean.real for one in own.co.stiffness]
    mass = own.assembly.topology.on_unknowns(np.array([[one.mean.real for one in own.co.inertia]]))[0]
    energy = np.diag([*stiffness, *mass[: size - springs]])
    return BoxMatrix(parts, rest * OUTWARD, own.rate, (1.0, 0.0), energy)


def _least_eigenvalue(series: LyapunovSeries) -> float:
    """A bound of that of P at all angles and parameters from below."""
    parts = series.parts
    sides, size = parts.shape[1] // 2, parts.shape[2]
    order = np.arange(-sides, sides + 1)
    most = float(np.abs(parts).sum(axis=(0, 1)).sum(axis=1).max())
    times = max(1, PER_HARMONIC * sides)
    angle = 2 * np.pi * np.arange(times) / times
    there = np.einsum("tm,mij->tij", np.exp(1j * np.outer(angle, order)), parts[0])
    least = float(np.linalg.eigvalsh((there + there.conj().swapaxes(1, 2)) / 2).min())
    # Between two angles P₀ changes by half a step times the bound of its slope; by parameters as their parts.
    turned = (np.abs(parts[0]) * np.abs(order)[:, None, None]).sum(axis=0).sum(axis=1).max() * np.pi / times
    moved = sum(float(np.abs(one).sum(axis=0).sum(axis=1).max()) for one in parts[1:])
    return float(least - (turned + moved + 64 * (size + 2 * sides + 8) * UNIT * most) * OUTWARD)
