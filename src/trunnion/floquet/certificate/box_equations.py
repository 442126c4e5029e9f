"""The linearised equations of a line as ż = A(τ, p) z, enclosed over a box of speeds and tolerances.

The states are the rotations δ of the unknowns and their momenta π = M(τ) δ̇. With the equations of ``equations.linear``,
in which C holds Ṁ,

    δ̇ = M⁻¹ π,     π̇ = −K δ − (C − Ṁ) M⁻¹ π.

A is linear in every stiffness and every inverse inertia, and so is the energy ½ πᵀM⁻¹π + ½ δᵀKδ, whose rate has no term
of second order in either: what makes large tolerances provable. Every entry is a ``Wave``: stations are walked from the
input as ``equations.kinematics`` does, laws of joints being algebra in e^{imχ}.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import gcd

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.equations.coefficients import Assembly
from trunnion.equations.topology import LinkKind, require_period
from trunnion.floquet.certificate.box_coefficients import BoxCoefficients, NumberRange, box_coefficients
from trunnion.floquet.certificate.waves import OUTWARD, Wave, affine, ahead, turning
from trunnion.floquet.certificate.working_stages import stages_held
from trunnion.laws.fourier import FourierLaw
from trunnion.laws.hooke import CrossLaw
from trunnion.laws.joint import JointLaw

NEGLIGIBLE = 1e-12
"""Harmonics of a joint below this are left to the rest."""
ROUNDED = 1e-14
"""What is added to a free–free line's entries, relative."""
MOST_HARMONICS = 400
"""Harmonics of the period's rate that are kept at most."""


class NotEnclosed(ArithmeticError):
    """A number of the equations may be infinite within a box, or a speed may vanish: a smaller one may do."""


@dataclass(frozen=True)
class BoxMatrix:
    """A(τ, p) (2n, 2n): ``parts`` (1 + parameters, 2K + 1, 2n, 2n), and a bound of what they leave out (2n, 2n).

    ``rate`` s: cycles of the first harmonic per turn of the input; ``speed``: middle and half width of Ω [rad/s];
    ``energy`` (2n, 2n): of the middle, twice it, floating point. A free–free line has one state less. ``powers`` : of
    the first parameter among the parameters, see ``waves``.
    """

    parts: Complex
    rest: Array
    rate: float
    speed: tuple[float, float]
    energy: Array
    powers: int = 0

    @property
    def last(self) -> int:
        """K."""
        return self.parts.shape[1] // 2


def box_matrix(assembly: Assembly, speeds: tuple[float, float], ranges: Sequence[NumberRange]) -> BoxMatrix:
    """Of the box of all ``speeds`` and all values of ``ranges``.

    Raises
    ------
    NotEnclosed : so.
    """
    with np.errstate(all="ignore"):
        try:
            return box_line(assembly, speeds, ranges).matrix()
        except ZeroDivisionError as error:
            raise NotEnclosed from error


def box_line(assembly: Assembly, speeds: tuple[float, float], ranges: Sequence[NumberRange]) -> BoxLine:
    """The numbers of the box of all ``speeds`` and all values of ``ranges``.

    Raises
    ------
    NotEnclosed : a load may take a spring out of the stage in which it works in the middle.
    """
    last = harmonics_needed(assembly, ranges, speeds)
    if not stages_held(assembly, speeds, ranges):
        raise NotEnclosed
    return BoxLine(assembly, box_coefficients(assembly, speeds, ranges, last), 1 + len(ranges), last)


def period_rate(assembly: Assembly) -> float:
    """Cycles per turn of the input of the first harmonic."""
    return 1 / float(require_period(assembly.line, assembly.topology))


def harmonics_needed(assembly: Assembly, ranges: Sequence[NumberRange], speeds: tuple[float, float]) -> int:
    """So many that the harmonics of every joint fall below ``NEGLIGIBLE``, and products of two joints'."""
    topo, rate = assembly.topology, period_rate(assembly)
    table = assembly.table(2, speeds[0])
    for one in ranges:
        one.columns.put(table, np.array([one.low, one.high]))
    needed = [0]
    for s, law in zip(topo.joints, assembly.coefficients(table, statically_twisted=False).joints, strict=True):
        if not law.nonuniform:
            continue
        each = max(map(float, topo.joint_rates(s))) / rate
        fall = max(1, int(np.ceil(np.log(NEGLIGIBLE) / np.log(max(law.spread, 1e-9)))))
        needed.append(round(each) * (fall if isinstance(law, CrossLaw) else min(fall, 4)))
    needed += [round(3 * float(r) / rate) for mesh in topo.meshes for r in mesh.stiffness_rates]
    needed.sort()
    return min(MOST_HARMONICS, needed[-1] + sum(needed[-2:-1]) // 2 + 2)


@dataclass(frozen=True)
class BoxEntries:
    """A by row and column, twice the energy of the middle, 1/M by unknown, and the decay (n,) [1/s] by which a
    turn of a free–free line is set aside: every momentum loses ``aside`` times that of the whole, ρᵀπ."""

    entries: dict[tuple[int, int], Wave]
    energy: Array
    light: list[Wave]
    aside: Array

    def arrays(self, parameters: int, last: int) -> tuple[Complex, Array]:
        """A (1 + parameters, 2K + 1, D, D) and what that leaves out (D, D)."""
        size = len(self.energy)
        parts = np.zeros((1 + parameters, 2 * last + 1, size, size), dtype=complex)
        rest = np.zeros((size, size))
        for (i, j), wave in self.entries.items():
            parts[:, :, i, j], rest[i, j] = wave.parts, wave.rest
        return parts, rest


@dataclass
class Walk:
    """By station: angle beyond its mean rotation, speed over the input's and its slope, and the same over its group's
    first station with two slopes."""

    lead: list[Wave] = field(default_factory=list)
    speed: list[Wave] = field(default_factory=list)
    acceleration: list[Wave] = field(default_factory=list)
    relative: list[Wave] = field(default_factory=list)
    relative_slope: list[Wave] = field(default_factory=list)
    relative_curvature: list[Wave] = field(default_factory=list)


@dataclass(frozen=True)
class BoxLine:
    """Waves of the equations of one box."""

    assembly: Assembly
    co: BoxCoefficients
    parameters: int
    last: int

    def number(self, value: float) -> Wave:
        """A constant."""
        return affine(value, {}, self.parameters, self.last)

    def walk(self) -> Walk:
        """The motion without vibration."""
        topo, co, found = self.assembly.topology, self.co, Walk()
        laws = dict(zip(topo.joints, co.middle.joints, strict=True))
        zero, one = self.number(0.0), self.number(1.0)
        for s, station in enumerate(topo.stations):
            b = station.before
            state: tuple[Wave, ...]
            if station.link is LinkKind.ROOT:
                state = zero, one, zero, one, zero, zero
            elif station.link is LinkKind.SHAFT:
                lead = found.lead[b] + co.shift[s]
                state = lead, found.speed[b], found.acceleration[b], one, zero, zero
            elif station.link is LinkKind.JOINT:
                state = self._behind_joint(found, s, b, laws[s])
            else:
                over = 1 / float(topo.ratio_values[s])
                state = tuple(
                    part[b] * over
                    for part in (
                        found.lead, found.speed, found.acceleration, found.relative, found.relative_slope,
                        found.relative_curvature,
                    )
                )  # fmt: skip
            for part, value in zip(vars(found).values(), state, strict=True):
                part.append(value)
        return found

    def _behind_joint(self, found: Walk, s: int, b: int, law: JointLaw) -> tuple[Wave, ...]:
        lead = found.lead[b] + self.co.shift[s]
        ratio_to_input = self.assembly.topology.speed_ratio[b]
        rate = period_rate(self.assembly)

        def circle(order: int) -> Wave:
            return turning(order, lead, self.number(0.0), round(float(order * ratio_to_input) / rate))

        if not law.nonuniform and s not in self.co.tangents:
            forward, eta, slope, curvature = self.number(0.0), self.number(1.0), self.number(0.0), self.number(0.0)
        elif isinstance(law, CrossLaw):
            t = self.co.tangents.get(s)
            if t is None:
                value = float(np.ravel(law.t)[0])
                t = affine(value, {}, self.parameters, self.last, 1e-13 * abs(value))
            forward, eta, slope, curvature = _cross(t, circle(2))
        else:
            assert isinstance(law, FourierLaw)
            forward, eta, slope, curvature = self.number(0.0), self.number(1.0), self.number(0.0), self.number(0.0)
            for m, amplitude, phase in zip(law.orders, law.amplitude, law.phase, strict=True):
                a, at = float(np.ravel(amplitude)[0]), float(np.ravel(phase)[0])
                z = circle(m) * complex(np.exp(1j * at))
                z = Wave(z.parts, z.rest + 1e-13 * z.size, z.terms)
                sine, cosine = (z - z.conjugate()) * (-0.5j * a), (z + z.conjugate()) * (0.5 * a)
                forward, eta = forward + sine, eta + cosine * m
                slope, curvature = slope - sine * m**2, curvature - cosine * m**3
        w, w1 = found.speed[b], found.acceleration[b]
        r, r1, r2 = found.relative[b], found.relative_slope[b], found.relative_curvature[b]
        square = r * r
        return (
            lead + forward + float(law.turned),
            eta * w,
            slope * (w * w) + eta * w1,
            eta * r,
            eta * r1 + slope * square,
            eta * r2 + 3.0 * (slope * (r * r1)) + curvature * (square * r),
        )

    def matrix(self) -> BoxMatrix:
        """A of the line."""
        return self._made(self.equations(self.walk()))

    def equations(self, motion: Walk) -> BoxEntries:
        """A of the line about its ``motion``."""
        co, n = self.co, self.assembly.topology.size
        zero = self.number(0.0)
        mass = [zero] * n
        damping = [[zero] * n for _ in range(n)]
        stiffness = [[zero] * n for _ in range(n)]
        self._put_stations(motion, mass, damping, stiffness)
        light = [co.over_mass[i] if i in co.over_mass else mass[i].inverse() for i in range(n)]
        if self.assembly.topology.free:
            return self._free(damping, light)
        self._put_compliances(motion, damping, stiffness)
        entries = {(i, n + i): light[i] for i in range(n)}
        for i in range(n):
            entries |= {(n + i, j): -stiffness[i][j] for j in range(n) if stiffness[i][j].size}
            entries |= {(n + i, n + j): -(damping[i][j] * light[j]) for j in range(n) if damping[i][j].size}
        energy = np.zeros((2 * n, 2 * n))
        means = np.array([[one.mean.real for one in row] for row in stiffness])
        energy[:n, :n] = (means + means.T) / 2
        energy[n:, n:] = np.diag([one.mean.real for one in light])
        return BoxEntries(entries, energy, light, np.zeros(n))

    def _free(self, loads: list[list[Wave]], light: list[Wave]) -> BoxEntries:
        """Of a straight line without a prescribed speed: twists q = Eδ of the springs and momenta,

            q̇ = E M⁻¹π,   π̇ = −Eᵀk q − (EᵀcE + loads) M⁻¹π  [− ν M₀ρ (ρᵀπ)/(ρᵀM₀ρ)].

        A turn ρ of the whole twists nothing, Eρ = 0, and is not a state. Where no load goes with the speed, neither
        does its momentum ρᵀπ change: the last term gives it a decay of its own, and leaves every motion without it
        as it is.
        """
        topo, co, n = self.assembly.topology, self.co, self.assembly.topology.size
        waves, twists = self.mesh_waves(), topo.elongations
        springs = len(twists)
        entries: dict[tuple[int, int], Wave] = {}
        whole = [[loads[i][j] for j in range(n)] for i in range(n)]
        for e, own in enumerate(twists):
            k = co.stiffness[e] * waves[e] if e in waves else co.stiffness[e]
            for i in np.flatnonzero(own).tolist():
                entries[e, springs + i] = light[i] * float(own[i])
                entries[springs + i, e] = k * -float(own[i])
                for j in np.flatnonzero(own).tolist():
                    whole[i][j] = whole[i][j] + co.damping[e] * float(own[i] * own[j])
        energy = np.diag([*(k.mean.real for k in co.stiffness), *(one.mean.real for one in light)])
        by_speed = any(part.size for row in loads for part in row)
        turn, heavy = topo.rigid[:, 0], np.array([1 / one.mean.real for one in light])
        fast = float(np.sqrt(max((np.abs(twists) ** 2 * np.diagonal(energy)[:springs, None]).sum(axis=0) / heavy)))
        aside = np.zeros(n) if by_speed else fast * heavy * turn / (turn @ (heavy * turn))
        for i in range(n):
            for j in range(n):
                entry = -(whole[i][j] * light[j])
                if not by_speed:
                    entry = entry - float(aside[i] * turn[j])
                if entry.size:
                    entries[springs + i, springs + j] = entry
        # Ratios are exact fractions, of which E and ρ are the nearest numbers.
        entries = {place: Wave(one.parts, one.rest + ROUNDED * one.size, one.terms) for place, one in entries.items()}
        return BoxEntries(entries, energy, light, aside)

    def _made(self, found: BoxEntries) -> BoxMatrix:
        speed, energy, (parts, rest) = self.co.speed, found.energy, found.arrays(self.parameters, self.last)
        half = float(speed.parts[1, speed.last].real)
        # Straight joints count in the period and move nothing: every how many harmonics there is one.
        stride = gcd(*np.abs(np.flatnonzero(parts.any(axis=(0, 2, 3))) - self.last).tolist()) or self.last + 1
        parts = parts[:, self.last % stride :: stride]
        return BoxMatrix(parts, rest * OUTWARD, stride * period_rate(self.assembly), (speed.mean.real, half), energy)

    def _put_stations(
        self, motion: Walk, mass: list[Wave], damping: list[list[Wave]], stiffness: list[list[Wave]]
    ) -> None:
        topo, co = self.assembly.topology, self.co
        for s in range(len(topo.stations)):
            loads = co.constant[s], co.viscous[s], co.quadratic[s]
            inertia, loaded = co.inertia[s], any(load.size for load in loads)
            group = topo.group_of(s)
            i, ref = topo.coordinate[group], topo.reference[group]
            if i < 0 or not (inertia.size or loaded):
                continue
            if s == ref and not loaded:
                mass[i] = mass[i] + inertia
                continue
            r, r1, r2 = motion.relative[s], motion.relative_slope[s], motion.relative_curvature[s]
            w, w1 = motion.speed[ref] * co.speed, motion.acceleration[ref] * (co.speed * co.speed)
            mass[i] = mass[i] + inertia * (r * r)
            # K of the inertia; J′w of C is Ṁ, which the momenta take up.
            bent = (r * r1) * w1 * 2.0 + (r1 * r1 + r * r2) * (w * w)
            stiffness[i][i] = stiffness[i][i] + inertia * bent
            if loaded:
                sense = float(np.sign(float(topo.speed_ratio[s])))
                v = r * w
                speed = speed_modulus(v) if co.quadratic[s].size else v
                growth = co.viscous[s] + co.quadratic[s] * speed * 2.0
                carried = co.constant[s] * sense + (co.viscous[s] + co.quadratic[s] * speed) * v
                damping[i][i] = damping[i][i] + (r * r) * growth
                stiffness[i][i] = stiffness[i][i] + r1 * carried + r * growth * (r1 * w)

    def _put_compliances(self, motion: Walk, damping: list[list[Wave]], stiffness: list[list[Wave]]) -> None:
        topo, co = self.assembly.topology, self.co
        waves = self.mesh_waves()
        for e, (compliance, (far, near)) in enumerate(zip(topo.compliances, topo.ends, strict=True)):
            ref = topo.reference[topo.group_of(compliance.near)]
            k, c, torque = co.stiffness[e], co.damping[e], co.torque[e]
            if e in waves:
                k, torque = k * waves[e], torque * waves[e]
            r, r1 = motion.relative[compliance.near], motion.relative_slope[compliance.near]
            r_dot = r1 * motion.speed[ref] * co.speed
            if far >= 0:
                damping[far][far] = damping[far][far] + c
                stiffness[far][far] = stiffness[far][far] + k
            if near >= 0:
                damping[near][near] = damping[near][near] + c * (r * r)
                stiffness[near][near] = stiffness[near][near] + k * (r * r) + c * (r * r_dot) - r1 * torque
            if far >= 0 and near >= 0:
                damping[far][near] = damping[far][near] - c * r
                damping[near][far] = damping[near][far] - c * r
                stiffness[far][near] = stiffness[far][near] - k * r - c * r_dot
                stiffness[near][far] = stiffness[near][far] - k * r

    def mesh_waves(self) -> dict[int, Wave]:
        """Stiffness over its mean of every mesh whose stiffness varies, by compliance."""
        found, rate = dict[int, Wave](), period_rate(self.assembly)
        for mesh in self.co.middle.waves:
            wave = self.number(1.0)
            for one in mesh.harmonics:
                at = complex(one.complex_amplitude[0]) / 2
                up = affine(1.0, {}, self.parameters, self.last).shifted(round(float(one.order) / rate)) * at
                wave = wave + up + up.conjugate()
            found[mesh.compliance] = Wave(wave.parts, wave.rest + 1e-13 * wave.size, wave.terms)
        return found


def speed_modulus(v: Wave) -> Wave:
    """|v| of a speed that keeps its sense."""
    sense = float(np.sign(v.mean.real))
    if not (v - v.mean).size < abs(v.mean):
        raise ZeroDivisionError
    return v * sense


def _cross(t: Wave, z: Wave) -> tuple[Wave, Wave, Wave, Wave]:
    """How far the output of a cross runs ahead of χ, η, dη/dχ and d²η/dχ², with z = e^{2iχ}; see ``laws.hooke``."""
    other = z.conjugate()
    cosine, sine = (z + other) * 0.5, (z - other) * (-0.5j)
    square = t * t
    over = (1.0 - 2.0 * (t * cosine) + square).inverse()
    eta = (1.0 - square) * over
    bent = t * eta * over
    slope = bent * sine * (-4.0)
    curvature = (bent * (cosine - 4.0 * (t * (sine * sine) * over))) * (-8.0)
    return ahead(t * z), eta, slope, curvature
