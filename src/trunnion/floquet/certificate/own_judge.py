"""One box of speeds and tolerances of a line about the periodic motion that it makes: that it exists, and attracts.

Let x̃(φ, p) be nearly a periodic solution of x′ = F(φ, x, p), with R = F(x̃) − x̃′ left over, and P(φ, p) > 0 Hermitian
and periodic. In the tube V = (x − x̃)*P(x − x̃) ≤ ρ² let every matrix A between the slopes of F have

    N = P′ + A*P + PA ≤ −2μP.

Then V′ ≤ −2μV + 2√V √(R*PR), and where √(R*PR) < μρ no motion leaves the tube; two within it come together as e^(−μφ)
(A being the mean slope between them). The map over a period so contracts the tube's section: it holds one periodic
motion, and all multipliers of that are e^(−μ·period) at most (Demidovich's and Lohmiller and Slotine's contraction).
N is checked as in ``proof``, with the tube in the rests of the waves.

A driven line has all its multipliers in x: its angle is φ = Ωt, and the first parameter is the speed Ω itself, so that
a box holds every speed from end to end.

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
from trunnion.floquet.certificate.own_equations import MotionEquations, MotionWaves, residuals
from trunnion.floquet.certificate.own_speeds import chebyshev_points, motions_over_speeds
from trunnion.floquet.certificate.own_stages import own_stages, require_stages_kept
from trunnion.floquet.certificate.own_start import Slowness, begun, solved
from trunnion.floquet.certificate.periodic_lyapunov import LyapunovSeries, ModalBox, lyapunov_series, modal_box
from trunnion.floquet.certificate.proof import check_tube
from trunnion.floquet.certificate.waves import OUTWARD, UNIT, Terms, affine, terms_of
from trunnion.steady.free.free_balance import FreeBalance, SteadyStates
from trunnion.steady.free.periodic_steady_states import SteadyStateCurve

BEYOND = 1e-6, 0.1
"""By what share of the speed, and of a box's width, the torque takes the speed beyond it at first."""
WIDER = 1.5
"""Height V of the next tube that is tried, over what the last one needed."""
TUBES = 4
"""Heights that are tried."""
FURTHER = 1.5
"""How far the torque takes the speed the second time, over what the first left uncovered."""
NARROW = 0.05
"""Width in ln(speed) of the first box that is tried."""
FIRST = 3
"""Power of the torque up to which matrices follow it: boxes become twenty times as wide than with the first alone."""
DEGREE = 4
"""Of products of torque and tolerances up to which motions follow them, where there are few enough."""
DRIVEN_NARROW, DRIVEN_FIRST = 0.2, 4
"""Width and power of a driven line, whose first parameter is the speed: motions follow it to the same, no less than
``DEGREE``."""
MOST_NUMBERS = 2500
"""Harmonics of all products that a wave may have, beyond those of first order."""
PER_HARMONIC = 24
"""Angles per harmonic at which P is looked at."""


@dataclass(frozen=True)
class OwnMotionLine:
    """A line about its own motion, box by box."""

    line: Driveline

    @property
    def narrow(self) -> float:
        """Width in ln(speed) of the first box that is tried."""
        return NARROW if self.assembly.topology.free else DRIVEN_NARROW

    @cached_property
    def assembly(self) -> Assembly:
        """Without excitations."""
        return assemble(unexcited(self.line))

    @cached_property
    def balance(self) -> FreeBalance:
        """Of its harmonics."""
        turns = require_period(self.assembly.line, self.assembly.topology)
        return FreeBalance(self.assembly, 2 * np.pi * float(turns), compiled=False)

    def judged(self, speeds: tuple[float, float], ranges: Sequence[NumberRange]) -> JudgedBox:
        """The verdict on one box."""
        with np.errstate(all="ignore"):
            try:
                found = self.enclosed(speeds, ranges)
            except (ArithmeticError, np.linalg.LinAlgError):
                found = None
        return JudgedBox(False, np.inf, np.ones(1 + len(ranges)), doubtful=True) if found is None else found.verdict

    def enclosed(self, speeds: tuple[float, float], ranges: Sequence[NumberRange]) -> JudgedMotion | None:
        """The same with its tube; None where no motion of the middle is found that could attract."""
        packed = self.assembly.packed
        ranges = [replace(one, columns=packed.resolve(one.label)) for one in ranges]
        begins = self.begun(speeds, ranges)
        found = None if begins is None else judged_motion(*begins, speeds)
        if found is not None and found.uncovered > 0:
            begins = self.begun(speeds, ranges, FURTHER * found.uncovered)
            found = None if begins is None else judged_motion(*begins, speeds)
        return found

    def begun(
        self, speeds: tuple[float, float], ranges: Sequence[NumberRange], further: float = 0.0
    ) -> tuple[MotionEquations, MotionWaves] | None:
        """The equations of a box and nearly a motion of each of its lines, in floating point.

        ``further`` : by how much more [s/rad] than a little the torque takes 1/speed beyond the box.
        """
        middle = sum(speeds) / 2
        row = self.assembly.table(1, middle)
        for one in ranges:
            one.columns.put(row, np.array([(one.low + one.high) / 2]))
        free = self.assembly.topology.free
        points = np.zeros(1) if free else chebyshev_points(self.first)
        curve = SteadyStateCurve(self.balance.along(lambda value: _rows(row, value)), speeds)
        motions = curve.at_all(middle + points * (speeds[1] - speeds[0]) / 2)
        if not (motions.found.all() and motions.resolved.all()):
            return None
        own = self._equations(speeds, ranges, motions, further)
        if not free:
            return self._begun_driven(own, motions)
        found = solved(own, begun(own, motions), _slowness(own, speeds, further))
        if found is not None:
            require_stages_kept(self.assembly, own.stages, own.beyond(found), middle)
        return None if found is None else (own, found)

    def _begun_driven(self, own: MotionEquations, motions: SteadyStates) -> tuple[MotionEquations, MotionWaves] | None:
        found = motions_over_speeds(own, motions)
        if found is None:
            return None
        motion, each = found
        for speed, (single, there) in zip(motions.value.tolist(), each, strict=True):
            require_stages_kept(self.assembly, single.stages, single.beyond(there), speed)
        return own, motion

    @property
    def first(self) -> int:
        """Power of the first parameter that is followed."""
        return FIRST if self.assembly.topology.free else DRIVEN_FIRST

    def _equations(
        self,
        speeds: tuple[float, float],
        ranges: Sequence[NumberRange],
        motions: SteadyStates,
        further: float,
    ) -> MotionEquations:
        assembly, topo = self.assembly, self.assembly.topology
        middle = sum(speeds) / 2
        last = max(harmonics_needed(assembly, ranges, speeds), motions.h)
        row = assembly.table(1, middle)
        for one in ranges:
            one.columns.put(row, np.array([(one.low + one.high) / 2]))
        ladder, stages = _ladder(1 + len(ranges), last, self.first), own_stages(assembly, row)
        terms = ladder[-1]
        held, near = speeds, None
        if topo.free:
            # The first parameter is a torque, not the speed. Twists count from those of the mean loads at the speed
            # that it makes.
            held = middle, middle
            mean, half = _asked(speeds, further)
            near = affine(mean, {1: half}, len(terms) - 1, last, terms=terms).inverse()
        co = box_coefficients(assembly, held, ranges, last, terms, near)
        drive = np.zeros(len(topo.stations))
        if topo.free:
            drive = -drive_torques(topo, drive_places(topo, assembly.packed.column, row), np.ones(1))[0]
        return MotionEquations(assembly, co, ladder, last, drive, stages)


def _ladder(parameters: int, last: int, first: int) -> tuple[Terms, ...]:
    """Products of parameters that motions of ``last`` harmonics follow, order by order."""
    found = [terms_of(parameters, degree, first) for degree in range(1, DEGREE + 1)]
    most = MOST_NUMBERS / (2 * last + 1)
    return tuple(one for k, one in enumerate(found) if not k or len(found[k - 1]) < len(one) <= most)


def _rows(row: Array, speeds: Array) -> Array:
    table = np.repeat(row, len(speeds), axis=0)
    table[:, 0] = speeds
    return table


def _asked(speeds: tuple[float, float], further: float) -> tuple[float, float]:
    """Mean of 1/(mean speed) [s/rad] and what the first parameter adds, over a box and a little beyond it."""
    slow, fast = 1 / speeds[0], 1 / speeds[1]
    middle, half = (slow + fast) / 2, (slow - fast) / 2
    return middle, -(half * (1 + BEYOND[1]) + BEYOND[0] * middle + further)


def _slowness(own: MotionEquations, speeds: tuple[float, float], further: float) -> Slowness | None:
    if not own.assembly.topology.free:
        return None
    asked = np.zeros(own.rows)
    asked[:2] = _asked(speeds, further)
    return Slowness(asked)


@dataclass(frozen=True)
class JudgedMotion:
    """The verdict; the ``tube`` that holds the motion, where proved; by how much [s/rad] the torque leaves speeds of a
    box that is proved but for that ``uncovered``."""

    verdict: JudgedBox
    tube: MotionWaves | None = None
    uncovered: float = 0.0


def judged_motion(own: MotionEquations, motion: MotionWaves, speeds: tuple[float, float]) -> JudgedMotion | None:
    """Whether a motion near ``motion`` exists at every one of ``speeds``, and attracts; None where the mean of the
    middle has no modes that decay."""
    left = residuals(own, motion, own.rates(motion, slopes=False))
    linear = own.cut(own.ladder[0])
    box = _matrix(linear, motion)
    modal = modal_box(box)
    if modal is None:
        return None
    series = lyapunov_series(box, modal)
    pushed = np.abs(modal.to_modes) @ np.array([one.size for one in left]) * OUTWARD
    first, least = check_tube(box, modal, series, pushed)
    if not first.proved:
        at = series.parts[0].sum(axis=0)
        doubtful = not series.solved or not np.linalg.eigvalsh((at + at.conj().T) / 2)[0] > 0
        return JudgedMotion(JudgedBox(False, first.excess, first.blame, doubtful=doubtful))

    def missed(excess: float = np.inf) -> JudgedBox:
        return JudgedBox(False, excess, _left_by_each(own.terms, motion, modal))

    stiff = _least_eigenvalue(series)
    off = np.abs(modal.to_modes @ modal.modes - np.eye(own.size)).sum(axis=1).max()
    if not (stiff > 0 and off < 0.01 and np.isfinite(least)):
        return JudgedMotion(missed())
    reach = np.linalg.norm(modal.modes, axis=1) / np.sqrt(stiff) * 1.02
    needed = least
    for _ in range(TUBES):
        height = WIDER * needed
        if not np.isfinite(height):
            break
        near = motion.widened(np.sqrt(height) * reach)
        known, needed = check_tube(_matrix(linear, near), modal, series, pushed)
        if not known.proved:
            return JudgedMotion(missed(known.excess))
        if needed < height:
            if not all(one.holds(at) for one, at in zip(own.stages, own.beyond(near), strict=True)):
                return JudgedMotion(missed())
            uncovered = _uncovered(own, near, speeds)
            if uncovered > 0:
                return JudgedMotion(missed(), uncovered=uncovered)
            decay = known.decay * speeds[0] * (1 - 1e-12)
            return JudgedMotion(JudgedBox(True, known.excess, known.blame, decay), near)
    return JudgedMotion(missed())


def _left_by_each(terms: Terms, motion: MotionWaves, modal: ModalBox) -> Array:
    """What halving each parameter would take from the products of the highest order that motions follow
    (parameters,), the next of which are left over: it says where to halve."""
    exponents = np.array(terms.exponents)
    order, alone = exponents.sum(axis=1), ~exponents[:, 1:].any(axis=1)
    most = order[~alone].max(initial=0) or order.max()
    # Powers of the first alone may go further, and leave less.
    highest = (order == most) & ~(alone & (most < order.max()))
    sizes = np.abs(modal.to_modes) @ np.array([one.sizes for one in motion.states])
    size = (sizes / modal.decay[:, None]).max(axis=0)
    return np.asarray(size[highest] @ (1 - 0.5 ** exponents[highest]))


def _uncovered(own: MotionEquations, motion: MotionWaves, speeds: tuple[float, float]) -> float:
    """By how much [s/rad] the torque fails to take 1/(mean speed) beyond all ``speeds``, whatever the tolerances; 0
    where it does."""
    if not own.assembly.topology.free:
        return 0.0
    slowness = own.input_speed(motion).inverse()
    parts = slowness.parts[:, own.last].real
    aside = (float(np.abs(parts[2:]).sum()) + slowness.rest) * OUTWARD
    slow, fast = (1 / speeds[0]) * OUTWARD, 1 / speeds[1]
    below, above = parts[0] - parts[1] - aside, (parts[0] + parts[1] + aside) * OUTWARD
    if below > slow and above < fast:
        return 0.0
    missing = float(max(slow - below, above - fast, 1e-12 * slow))
    return missing if np.isfinite(missing) else 0.0


def _matrix(own: MotionEquations, motion: MotionWaves) -> BoxMatrix:
    """A = dF/dx over φ along a motion. What products of its parameters bring that the equations do not follow is little
    in matrices: it stands in their rests."""
    found = own.rates(motion.cut(own.terms))
    size, springs = own.size, len(own.assembly.topology.compliances)
    parts = np.zeros((own.rows, 2 * own.last + 1, size, size), dtype=complex)
    rest = np.zeros((size, size))
    for (i, j), wave in found.slopes.items():
        parts[:, :, i, j], rest[i, j] = wave.parts, wave.rest
    stiffness = [one.mean.real for one in own.co.stiffness]
    mass = own.assembly.topology.on_unknowns(np.array([[one.mean.real for one in own.co.inertia]]))[0]
    energy = np.diag([*stiffness, *mass[: size - springs]])
    return BoxMatrix(parts, rest * OUTWARD, own.rate, (1.0, 0.0), energy, own.rows - 1 - own.parameters)


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
