"""The equations of motion of a line over the angle φ its input has turned by, along a motion given as waves.

States are the twists q of the springs beyond those that mean loads make, and the speeds w of the unknowns. With w₀ the
speed of the input, prescribed or the first of them, and r the ratio in front of each spring,

    w₀ q′ = w_far − r w_near,
    w₀ M_i w_i′ = −½ M_i′ w_i² − Σ r_s T_s(r_s w_i) − f_own + Σ r_e f_e,     f = T̄ + k q + c (w_far − r w_near).

The torque T̄ of the mean loads goes with the torque that drives and not with a stiffness, which so moves q little: it is
no more than what twists count from, and any function of the parameters would do. Angles follow from φ and the
twists, so the equations have the period of the joints in φ, whatever the speed does. A free–free line loses its shift
of phase with them: of two motions that differ by that, both are the same function of φ. Under a torque that drives,
constant and free, its periodic motion is one of 2n − 1 equations, and its multipliers are all of the line's but the 1
of the shift. A line at a prescribed speed has w₀ = Ω and all 2n states.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.equations.coefficients import Assembly
from trunnion.floquet.certificate.box_coefficients import BoxCoefficients, twist_in_stage
from trunnion.floquet.certificate.box_equations import BoxLine, Walk, period_rate, speed_modulus
from trunnion.floquet.certificate.own_stages import OwnStage
from trunnion.floquet.certificate.waves import Terms, Wave, terms_of

Entries = dict[tuple[int, int], Wave]
"""A matrix of waves; what is missing is zero."""


@dataclass(frozen=True)
class MotionWaves:
    """States as functions of φ: ``twist`` beyond that of the mean loads (spring,) and ``speed`` (unknown,), and the
    torque at the input [N m] by which a free–free line is driven beyond the balance of its loads."""

    twist: tuple[Wave, ...]
    speed: tuple[Wave, ...]
    drive: Wave

    @property
    def states(self) -> tuple[Wave, ...]:
        """Twists, then speeds."""
        return (*self.twist, *self.speed)

    def widened(self, radii: Array) -> MotionWaves:
        """All motions near it: each state within its radius."""
        states = [Wave(one.parts, one.rest + float(r), one.terms) for one, r in zip(self.states, radii, strict=True)]
        many = len(self.twist)
        return MotionWaves(tuple(states[:many]), tuple(states[many:]), self.drive)

    def cut(self, terms: Terms) -> MotionWaves:
        """With those alone; what others bring goes to the rests."""
        return self.each(lambda one: one.cut(terms))

    def each(self, made: Callable[[Wave], Wave]) -> MotionWaves:
        """With what is made of every wave."""
        twist, speed = (tuple(made(one) for one in states) for states in (self.twist, self.speed))
        return MotionWaves(twist, speed, made(self.drive))


@dataclass(frozen=True)
class Rates:
    """x′ (state,) along a motion, its derivatives by the states, and by the torque that drives (state,)."""

    rates: list[Wave]
    slopes: Entries
    by_drive: list[Wave]


@dataclass(frozen=True)
class MotionEquations:
    """Of one box. ``ladder`` : products of parameters that are followed, see ``waves``: to first order, to second, up
    to all; ``drive`` (station,): torque [N m] in the mean sense there of one at the input that drives; ``stages`` of
    springs that have some."""

    assembly: Assembly
    co: BoxCoefficients
    ladder: tuple[Terms, ...]
    last: int
    drive: Array
    stages: tuple[OwnStage, ...] = ()

    @property
    def terms(self) -> Terms:
        """All that are followed."""
        return self.ladder[-1]

    @property
    def rows(self) -> int:
        """Of every wave."""
        return len(self.terms)

    @property
    def parameters(self) -> int:
        """The torque or the speed, and tolerances."""
        return len(self.terms.exponents[0])

    def cut(self, terms: Terms) -> MotionEquations:
        """With those alone; what others bring goes to the rests."""
        return replace(self, co=self.co.each(lambda one: one.cut(terms)), ladder=(terms,))

    @property
    def middle(self) -> MotionEquations:
        """Of the middle alone, without what is left out."""
        return replace(self, co=self.co.each(lambda one: one.middle), ladder=(terms_of(0, 0),))

    @property
    def rate(self) -> float:
        """Cycles per turn of the input of the first harmonic."""
        return period_rate(self.assembly)

    @property
    def twisted(self) -> Array:
        """Twist of every spring under the mean loads, in the middle (spring,) [rad]."""
        found = np.array([t.mean.real / k.mean.real for t, k in zip(self.co.torque, self.co.stiffness, strict=True)])
        for one in self.stages:
            found[one.spring] = self.loaded[one.spring].mean.real
        return found

    @cached_property
    def loaded(self) -> dict[int, Wave]:
        """Twist θ̄ of every spring with stages under the mean loads of each line, by its stage."""
        co = self.co
        return {
            one.spring: twist_in_stage(co.middle, one.spring, co.stiffness[one.spring], co.torque[one.spring])
            for one in self.stages
        }

    def beyond(self, motion: MotionWaves) -> tuple[Wave, ...]:
        """By how much each spring with stages twists more than its stage's θ̄ of the middle."""
        return tuple(self.loaded[one.spring] - one.twist + motion.twist[one.spring] for one in self.stages)

    @property
    def size(self) -> int:
        """States."""
        return len(self.assembly.topology.compliances) + self.assembly.topology.size

    def number(self, value: float) -> Wave:
        """A constant."""
        return BoxLine(self.assembly, self.co, self.rows - 1, self.last).number(value)

    def input_speed(self, motion: MotionWaves) -> Wave:
        """w₀."""
        topo = self.assembly.topology
        return motion.speed[topo.coordinate[topo.group_of(0)]] if topo.free else self.co.speed

    def rates(self, motion: MotionWaves, *, slopes: bool = True) -> Rates:
        """Along ``motion``, and everywhere within the rests of its waves.

        slopes : without, x′ alone.
        """
        return _Evaluation(self, motion, self._walk(motion), slopes).rates()

    def _walk(self, motion: MotionWaves) -> Walk:
        topo, shift = self.assembly.topology, list(self.co.shift)
        for e, compliance in enumerate(topo.compliances):
            s = topo.behind[compliance.shafts[-1], compliance.number]
            shift[s] = shift[s] + motion.twist[e]
        return BoxLine(self.assembly, replace(self.co, shift=shift), self.rows - 1, self.last).walk()


class _Evaluation:
    """Of one motion."""

    def __init__(self, own: MotionEquations, motion: MotionWaves, walk: Walk, slopes: bool) -> None:
        self.own, self.motion, self.walk, self.slopes = own, motion, walk, slopes
        self.topo = own.assembly.topology
        self.springs = len(self.topo.compliances)
        self.zero = own.number(0.0)
        self.w0 = own.input_speed(motion)
        self.over = self.w0.inverse()
        self.first = self.springs + self.topo.coordinate[self.topo.group_of(0)] if self.topo.free else -1
        self.turned = self._turned()

    def rates(self) -> Rates:
        """Everything."""
        own, topo = self.own, self.topo
        rates: list[Wave] = [self.zero] * own.size
        slopes: Entries = {}
        forces, moved = [], []
        for e in range(self.springs):
            relative, by = self._relative(e)
            rates[e] = relative * self.over
            for j, one in by.items():
                slopes[e, j] = one * self.over
            torque = own.co.torque[e] + own.co.stiffness[e] * self.motion.twist[e] + own.co.damping[e] * relative
            if self.slopes:
                by = {j: own.co.damping[e] * one for j, one in by.items()}
                by[e] = by[e] + own.co.stiffness[e] if e in by else own.co.stiffness[e]
            forces.append(torque)
            moved.append(by)
        by_drive = [self.zero] * own.size
        for i in range(topo.size):
            row, (mass, slope), (torque, by) = self.springs + i, self._mass(i), self._stations(i)
            for e, (far, near) in enumerate(topo.ends):
                if far == i:
                    torque = torque - forces[e]
                    _add(by, moved[e], -1.0)
                if near == i:
                    s = topo.compliances[e].near
                    r, r1 = self.walk.relative[s], self.walk.relative_slope[s]
                    torque = torque + r * forces[e]
                    _add(by, moved[e], r)
                    if self.slopes and r1.size:
                        _add(by, self.turned[i], r1 * forces[e])
            light = (own.co.over_mass[i] if i in own.co.over_mass else mass.inverse()) * self.over
            rates[row] = torque * light
            if self.slopes and slope.size:  # of 1/M
                _add(by, self.turned[i], slope * rates[row] * self.w0 * -1.0)
            for j, one in by.items():
                slopes[row, j] = one * light
            by_drive[row] = self._driven(i) * light
        if self.slopes and self.first >= 0:  # of 1/w₀
            for j in range(own.size):
                if rates[j].size:
                    less = rates[j] * self.over * -1.0
                    slopes[j, self.first] = slopes[j, self.first] + less if (j, self.first) in slopes else less
        return Rates(rates, slopes, by_drive)

    def _turned(self) -> list[dict[int, Wave]]:
        """By how much every unknown turns, by the twists, at the same φ."""
        found: list[dict[int, Wave]] = [{} for _ in range(self.topo.size)]
        if not self.slopes:
            return found
        for e, (far, near) in enumerate(self.topo.ends):
            r = self.walk.relative[self.topo.compliances[e].near]
            found[far] = {j: r * one for j, one in found[near].items()} if near >= 0 else {}
            found[far][e] = self.own.number(1.0)
        return found

    def _relative(self, e: int) -> tuple[Wave, dict[int, Wave]]:
        """w_far − r w_near of a spring, and its derivatives."""
        (far, near), s = self.topo.ends[e], self.topo.compliances[e].near
        r, r1 = self.walk.relative[s], self.walk.relative_slope[s]
        w = self.motion.speed[near] if near >= 0 else self.w0
        relative = self.motion.speed[far] - r * w
        if not self.slopes:
            return relative, {}
        by = {self.springs + far: self.own.number(1.0)}
        if near >= 0:
            by[self.springs + near] = -r
            if r1.size:
                _add(by, self.turned[near], r1 * w * -1.0)
        return relative, by

    def _of(self, i: int) -> list[int]:
        return [s for s in range(len(self.topo.stations)) if self.topo.unknown_of[s] == i]

    def _mass(self, i: int) -> tuple[Wave, Wave]:
        """M of an unknown, and its slope by its rotation."""
        mass, slope = self.zero, self.zero
        for s in self._of(i):
            inertia = self.own.co.inertia[s]
            if inertia.size:
                r, r1 = self.walk.relative[s], self.walk.relative_slope[s]
                mass = mass + inertia * (r * r)
                if self.slopes and r1.size:
                    slope = slope + inertia * (r * r1) * 2.0
        return mass, slope

    def _stations(self, i: int) -> tuple[Wave, dict[int, Wave]]:
        """Torque on an unknown by its own inertias and loads, and its derivatives."""
        co, w, row = self.own.co, self.motion.speed[i], self.springs + i
        torque, by_speed, by_angle = self.zero, self.zero, self.zero
        for s in self._of(i):
            r, r1, r2 = self.walk.relative[s], self.walk.relative_slope[s], self.walk.relative_curvature[s]
            inertia = co.inertia[s]
            if inertia.size and r1.size:
                torque = torque - inertia * (r * r1) * (w * w)
                if self.slopes:
                    by_speed = by_speed - inertia * (r * r1) * w * 2.0
                    by_angle = by_angle - inertia * (r1 * r1 + r * r2) * (w * w)
            sense = float(np.sign(self.topo.mean_speeds[s]))
            load = co.constant[s] * sense - self.motion.drive * (sense * float(self.own.drive[s]))
            if not (load.size or co.viscous[s].size or co.quadratic[s].size):
                continue
            v = r * w
            modulus = speed_modulus(v) if co.quadratic[s].size else v
            resists = load + (co.viscous[s] + co.quadratic[s] * modulus) * v
            torque = torque - r * resists
            if not self.slopes:
                continue
            growth = co.viscous[s] + co.quadratic[s] * modulus * 2.0
            by_speed = by_speed - r * r * growth
            if r1.size:
                by_angle = by_angle - r1 * resists - r * growth * (r1 * w)
        by = {row: by_speed} if by_speed.size else {}
        if by_angle.size:
            _add(by, self.turned[i], by_angle)
        return torque, by

    def _driven(self, i: int) -> Wave:
        found = self.zero
        for s in self._of(i):
            if self.own.drive[s]:
                sense = float(np.sign(self.topo.mean_speeds[s]))
                found = found + self.walk.relative[s] * (sense * float(self.own.drive[s]))
        return found


def _add(to: dict[int, Wave], what: dict[int, Wave], by: Wave | float) -> None:
    for j, one in what.items():
        to[j] = to[j] + one * by if j in to else one * by


def derivative(wave: Wave, rate: float) -> Wave:
    """By φ, of a wave without rest."""
    order = 1j * rate * np.arange(-wave.last, wave.last + 1)
    return Wave(wave.parts * order, 1e-15 * float(np.abs(wave.parts * order).sum()), wave.terms)


def residuals(own: MotionEquations, motion: MotionWaves, found: Rates) -> list[Wave]:
    """x′ of the equations less that of the motion itself."""
    return [rate + -derivative(one, own.rate) for rate, one in zip(found.rates, motion.states, strict=True)]


def motion_of(own: MotionEquations, parts: Sequence[Complex], drive: Array) -> MotionWaves:
    """States by their parts (rows, 2K + 1) and the torque's (rows,)."""
    many, last = len(own.assembly.topology.compliances), own.last
    states = [Wave(np.asarray(one, dtype=complex), 0.0, own.terms) for one in parts]
    torque = np.zeros((own.rows, 2 * last + 1), dtype=complex)
    torque[:, last] = drive
    return MotionWaves(tuple(states[:many]), tuple(states[many:]), Wave(torque, 0.0, own.terms))
