"""What shakes a line and what is asked of it, over a box of speeds and tolerances.

With the states of ``floquet.certificate.box_equations``, rotations δ (a free–free line: twists q) and momenta π,

    ż = A(τ, p) z + Σ_k Re[g_k(τ, p) e^{i(K_k τ + ν_k t)}],     y = base(τ, p) + C(τ, p) z + Re[…],

where forces act on the momenta alone: what joints force (−Jẇ, torques of the static twist behind rotating joints),
harmonic torques of disks at the angle of their base motion, and transmission errors of meshes. A momentum of a
free–free line as a whole is set aside in A by a decay of its own; here that is given back, for it follows from the
torques: d(ρᵀπ)/dt = ρᵀg.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.equations.coefficients import Assembly
from trunnion.equations.harmonics import DiskTorque, LineHarmonic, MeshError, line_harmonics
from trunnion.equations.topology import LinkKind, require_period
from trunnion.errors import InputError
from trunnion.floquet.certificate.box_coefficients import STATED, NumberRange, staged, twist_in_stage
from trunnion.floquet.certificate.box_equations import (
    BoxEntries,
    BoxLine,
    BoxMatrix,
    NotEnclosed,
    Walk,
    box_line,
)
from trunnion.floquet.certificate.waves import OUTWARD, Wave, affine, turning
from trunnion.response.peaks.amplitude_chords import amplitude_chord, follows

UNEVEN_BY_SPEED = 1e-9
"""Share by which an amplitude may go with the speed otherwise than its law says."""


@dataclass(frozen=True)
class BoxForce:
    """Re[g e^{i(order τ + frequency t)}] on the states: g (1 + parameters, 2K + 1, D), and a bound of what that leaves
    out (D,); ``direct`` (1 + parameters, 2K + 1, Q) and its rest (Q,): what it adds to the quantities asked for."""

    order: Fraction
    frequency: float
    parts: Complex
    rest: Array
    direct: Complex
    direct_rest: Array


@dataclass(frozen=True)
class ForcedBox:
    """``matrix`` A, whose first harmonic has ``rate`` cycles per turn of the input; ``forces``, the first that of the
    joints; ``outputs`` C (1 + parameters, 2K + 1, Q, D) with its rest (Q, D): of every spring its torque [N m], its
    twist [rad] and the rate of it [rad/s], then of every point of ``Topology.points`` its speed [rad/s] and
    acceleration [rad/s²]; ``base`` (1 + parameters, 2K + 1, Q) and its rest (Q,); ``damping`` (S,) of springs in the
    middle and at most [N m s/rad]."""

    matrix: BoxMatrix
    rate: Fraction
    forces: tuple[BoxForce, ...]
    outputs: Complex
    outputs_rest: Array
    base: Complex
    base_rest: Array
    damping: tuple[Array, Array]


def forced_box(assembly: Assembly, speeds: tuple[float, float], ranges: Sequence[NumberRange]) -> ForcedBox:
    """Of the box of all ``speeds`` [rad/s] and all values of ``ranges``.

    Raises
    ------
    NotEnclosed : a number of the equations may be infinite within the box.
    """
    with np.errstate(all="ignore"):
        try:
            return _ForcedLine(box_line(assembly, speeds, ranges), tuple(ranges)).box()
        except ZeroDivisionError as error:
            raise NotEnclosed from error


def require_forcing(assembly: Assembly, speeds: tuple[float, float], ranges: Sequence[NumberRange] = ()) -> None:
    """Refuse excitations whose amplitude goes with the speed along a curve, or with a tolerance.

    Raises
    ------
    InputError : names the disk and the excitation; a table that does not cover the speeds.
    """
    table = assembly.table(1 + 2 * len(ranges), sum(speeds) / 2)
    for k, own in enumerate(ranges):
        for row, end in ((1 + 2 * k, own.low), (2 + 2 * k, own.high)):
            changed = table[row : row + 1]  # a view: the table itself is written
            own.columns.put(changed, end)
    for one in line_harmonics(assembly):
        if not (one.acts and isinstance(one, DiskTorque) and follows(one)):
            continue
        size = one.size(assembly, table)
        moved = np.flatnonzero(np.abs(size - size[0]) > UNEVEN_BY_SPEED * np.abs(size).max())
        if len(moved):
            raise InputError(
                "goes with the mean torque, which scatters, and is not enclosed then",
                element=one.name, key=f"excitation {one.number}", value=ranges[(int(moved[0]) - 1) // 2].label,
                remedy="leave that tolerance out, or state an amplitude, its largest",
            )  # fmt: skip
        if amplitude_chord(one, assembly, speeds) is None:
            raise InputError(
                "goes with a mean torque that goes with the speed along a curve, which is not enclosed",
                element=one.name, key=f"excitation {one.number}", value=float(np.abs(size).max()),
                remedy="state an amplitude, its largest, a quadratic_amplitude, or amplitudes at speeds",
            )  # fmt: skip
    co = assembly.coefficients(assembly.table(1, speeds[0]))
    for oil in co.oils:
        if oil.damper.oil_frequency is not None:
            raise InputError(
                "has oil that goes with the frequency along a curve, which is not enclosed",
                element=assembly.line.names[assembly.topology.compliances[oil.compliance].shafts[0]], key="oil",
                remedy="state its stiffness and damping at the frequency that matters",
            )  # fmt: skip
    if co.lags:
        raise InputError(
            "has torques that lag behind the speed, which are not enclosed", element=assembly.line.names[0],
            remedy="leave out their corner frequencies; order_response counts them",
        )  # fmt: skip


@dataclass(frozen=True)
class _ForcedLine:
    line: BoxLine
    ranges: tuple[NumberRange, ...]

    def box(self) -> ForcedBox:
        line, motion = self.line, self.line.walk()
        found = line.equations(motion)
        outputs, base = self._outputs(motion, found)
        moved = self._accelerations(motion, found, outputs, base)
        uniform, acting = self._uniform(), [one for one in line_harmonics(line.assembly) if one.acts]
        raw: list[tuple[Fraction, float, dict[int, Wave], dict[int, Wave]]]
        raw = [(Fraction(0), 0.0, self._own(motion), {})]
        raw += [(Fraction(one.order), one.frequency, *self._of(one, motion, uniform)) for one in acting]
        stack = _Stack(line.parameters, line.last)
        matrix, rest = found.arrays(line.parameters, line.last)
        given = [(order, nu, self._on_states(g, found, order, nu), direct) for order, nu, g, direct in raw]
        for _, _, g, direct in given:
            direct |= {at: row * g[i] for at, (i, row) in moved.items() if i in g}
        waves = [
            *(w for _, _, g, direct in given for w in (*g.values(), *direct.values())),
            *outputs.values(),
            *base.values(),
        ]
        stride = _stride([matrix, *(w.parts for w in waves)], line.last)
        topo = line.assembly.topology
        size, count = len(found.energy), 3 * len(topo.compliances) + 2 * len(topo.points)
        kept = slice(line.last % stride, None, stride)
        speed = line.co.speed
        rate = Fraction(stride) / require_period(line.assembly.line, line.assembly.topology)
        box = BoxMatrix(
            matrix[:, kept], rest * OUTWARD, float(rate),
            (speed.mean.real, float(speed.parts[1, line.last].real)), found.energy,
        )  # fmt: skip
        forces = tuple(
            BoxForce(order, nu, *stack.vector(g, size, kept), *stack.vector(direct, count, kept))
            for order, nu, g, direct in given
        )
        rows, rows_rest = stack.rows(outputs, count, size, kept)
        damping = np.array([c.mean.real for c in line.co.damping]), np.array([c.size for c in line.co.damping])
        return ForcedBox(box, rate, forces, rows, rows_rest, *stack.vector(base, count, kept), damping)

    def _uniform(self) -> list[Wave]:
        """Angle of every station beyond its mean rotation where nothing is bent or twisted."""
        topo, co, found = self.line.assembly.topology, self.line.co, list[Wave]()
        laws = dict(zip(topo.joints, co.middle.joints, strict=True))
        for s, station in enumerate(topo.stations):
            b = station.before
            if station.link is LinkKind.ROOT:
                found.append(self.line.number(0.0))
            elif station.link is LinkKind.SHAFT:
                found.append(found[b] + co.untwisted_shift[s])
            elif station.link is LinkKind.JOINT:
                found.append(found[b] + co.untwisted_shift[s] + float(laws[s].turned))
            else:
                found.append(found[b] * (1 / float(topo.ratio_values[s])))
        return found

    def _own(self, motion: Walk) -> dict[int, Wave]:
        """What the base motion itself asks of every unknown, by unknown."""
        topo, co, found = self.line.assembly.topology, self.line.co, dict[int, Wave]()

        def put(i: int, wave: Wave) -> None:
            if i >= 0 and wave.size:
                found[i] = found[i] + wave if i in found else wave

        if topo.free:  # its joints are straight, and its torques balance
            return found
        for s in range(len(topo.stations)):
            group = topo.group_of(s)
            i, ref = topo.coordinate[group], topo.reference[group]
            inertia, loaded = co.inertia[s], any(part.size for part in (co.constant[s], co.viscous[s], co.quadratic[s]))
            if i < 0 or not (inertia.size or loaded):
                continue
            w, w1 = motion.speed[ref] * co.speed, motion.acceleration[ref] * (co.speed * co.speed)
            r, r1 = motion.relative[s], motion.relative_slope[s]
            if s == ref:
                put(i, -((co.over_mass[i].inverse() if i in co.over_mass else inertia) * w1))
            else:
                put(i, -(inertia * (r * r) * w1 + inertia * (r * r1) * (w * w)))
            if loaded:
                sense, v = float(np.sign(float(topo.speed_ratio[s]))), r * w
                load = co.constant[s] * sense + co.viscous[s] * v
                if co.quadratic[s].size:
                    turns = float(np.sign(v.mean.real))
                    if not (v - v.mean).size < abs(v.mean):
                        raise ZeroDivisionError
                    load = load + co.quadratic[s] * (v * v) * turns
                put(i, -(r * load))
        waves = self.line.mesh_waves()
        for e, (compliance, (far, near)) in enumerate(zip(topo.compliances, topo.ends, strict=True)):
            torque = co.torque[e] * waves[e] if e in waves else co.torque[e]
            put(far, -torque)
            put(near, motion.relative[compliance.near] * torque)
        return found

    def _of(self, one: LineHarmonic, motion: Walk, uniform: list[Wave]) -> tuple[dict[int, Wave], dict[int, Wave]]:
        """g of a harmonic by unknown, and what it adds to the quantities."""
        topo, co = self.line.assembly.topology, self.line.co
        size = self._size(one)
        if isinstance(one, DiskTorque):
            s = one.station
            sense = float(np.sign(float(topo.speed_ratio[s])))
            if one.law.stated_as == "quadratic_amplitude":
                size = size * (co.speed * co.speed)
            turned = turning(one.own_order * sense, motion.lead[s] - uniform[s], self.line.number(0.0), 0)
            return {int(topo.unknown_of[s]): motion.relative[s] * size * turned * sense}, {}
        assert isinstance(one, MeshError)
        e, waves = one.mesh.compliance, self.line.mesh_waves()
        (far, near), station = topo.ends[e], topo.compliances[e].near
        rate = co.speed * (1j * float(one.order)) + 1j * one.frequency
        k = co.stiffness[e] * waves[e] if e in waves else co.stiffness[e]
        torque = (k + co.damping[e] * rate) * size
        g = {far: -torque} if far >= 0 else {}
        if near >= 0:
            g[near] = motion.relative[station] * torque
        springs = len(topo.compliances)
        return g, {e: torque, springs + e: size, 2 * springs + e: size * rate}

    def _size(self, one: LineHarmonic) -> Wave:
        """A e^{i phase}, over Ω² where it goes by that."""
        if isinstance(one, DiskTorque) and follows(one):
            return self._following(one)
        assembly, ranges, co = self.line.assembly, self.ranges, self.line.co
        table = assembly.table(1 + 2 * len(ranges), co.speed.mean.real)
        for k, own in enumerate(ranges):
            values = np.full(len(table), (own.low + own.high) / 2)
            values[1 + 2 * k], values[2 + 2 * k] = own.low, own.high
            own.columns.put(table, values)
        size = one.size(assembly, table)
        if isinstance(one, DiskTorque) and one.law.stated_as == "quadratic_amplitude":
            size = size / table[:, 0] ** 2
        slopes = {2 + j: complex(size[2 + 2 * j] - size[1 + 2 * j]) / 2 for j in range(len(ranges))}
        kept = {v: slope for v, slope in slopes.items() if slope}
        rest = (STATED + UNEVEN_BY_SPEED) * float(np.abs(size).max())
        return affine(complex(size[0]), kept, self.line.parameters, self.line.last, rest)  # type: ignore[arg-type]

    def _following(self, one: DiskTorque) -> Wave:
        """A e^{i phase} of one that follows from the speed."""
        speed, last = self.line.co.speed, self.line.last
        middle, half = speed.mean.real, float(speed.parts[1, last].real)
        found = amplitude_chord(one, self.line.assembly, (middle - half, middle + half))
        if found is None:
            raise ZeroDivisionError
        slopes = {1: found.slope} if half else {}
        rest = found.apart * OUTWARD + 8 * STATED * found.largest
        return affine(found.centre, slopes, self.line.parameters, last, rest)  # type: ignore[arg-type]

    def _on_states(self, g: dict[int, Wave], found: BoxEntries, order: Fraction, frequency: float) -> dict[int, Wave]:
        """Of torques on the unknowns, those on the states."""
        topo = self.line.assembly.topology
        first = len(found.energy) - topo.size
        states = {first + i: wave for i, wave in g.items()}
        if not (topo.free and found.aside.any() and g):
            return states
        turn = topo.rigid[:, 0]
        whole = self.line.number(0.0)
        for i, wave in g.items():
            whole = whole + wave * float(turn[i])
        rate = self.line.co.speed * float(order) + frequency
        whole = whole * rate.inverse() * (-1j)
        for i in np.flatnonzero(found.aside).tolist():
            given = whole * float(found.aside[i])
            states[first + i] = states[first + i] + given if first + i in states else given
        return states

    def _outputs(self, motion: Walk, found: BoxEntries) -> tuple[dict[tuple[int, int], Wave], dict[int, Wave]]:
        """Rows of C by quantity and state, and what is there without vibration."""
        topo, co, rows = self.line.assembly.topology, self.line.co, dict[tuple[int, int], Wave]()
        waves, springs, n = self.line.mesh_waves(), len(topo.compliances), topo.size
        base = {}

        def put(row: int, column: int, wave: Wave) -> None:
            if wave.size:
                rows[row, column] = rows[row, column] + wave if (row, column) in rows else wave

        for e, (compliance, (far, near)) in enumerate(zip(topo.compliances, topo.ends, strict=True)):
            k, c, torque = co.stiffness[e], co.damping[e], co.torque[e]
            if e in waves:
                k, torque = k * waves[e], torque * waves[e]
            base[e], base[springs + e] = torque, self._static_twist(e)
            if topo.free:
                put(e, e, k)
                put(springs + e, e, self.line.number(1.0))
                for i in np.flatnonzero(topo.elongations[e]).tolist():
                    rate = found.light[i] * float(topo.elongations[e, i])
                    put(e, springs + i, c * rate)
                    put(2 * springs + e, springs + i, rate)
                continue
            ref = topo.reference[topo.group_of(compliance.near)]
            r = motion.relative[compliance.near]
            r_dot = motion.relative_slope[compliance.near] * motion.speed[ref] * co.speed
            if far >= 0:
                put(e, far, k)
                put(e, n + far, c * found.light[far])
                put(springs + e, far, self.line.number(1.0))
                put(2 * springs + e, n + far, found.light[far])
            if near >= 0:
                put(e, near, -(k * r + c * r_dot))
                put(e, n + near, -(c * r * found.light[near]))
                put(springs + e, near, -r)
                put(2 * springs + e, near, -r_dot)
                put(2 * springs + e, n + near, -(r * found.light[near]))
        for at, (s, _) in enumerate(topo.points, start=3 * springs):
            group = topo.group_of(s)
            i, ref, r = topo.coordinate[group], topo.reference[group], motion.relative[s]
            base[at] = motion.speed[s] * co.speed
            if i < 0:
                continue
            put(at, (springs if topo.free else n) + i, r * found.light[i])
            if not topo.free:
                put(at, i, motion.relative_slope[s] * motion.speed[ref] * co.speed)
        return rows, base

    def _static_twist(self, e: int) -> Wave:
        """Of a compliance: torque over stiffness, or in its stage."""
        co, compliance = self.line.co, self.line.assembly.topology.compliances[e]
        if not staged(self.line.assembly.line.elements[compliance.shafts[0]]):
            return co.torque[e] * co.stiffness[e].inverse() if co.torque[e].size else self.line.number(0.0)
        return twist_in_stage(co.middle, e, co.stiffness[e], co.torque[e])

    def _accelerations(
        self, motion: Walk, found: BoxEntries, rows: dict[tuple[int, int], Wave], base: dict[int, Wave]
    ) -> dict[int, tuple[int, Wave]]:
        """Put the rows of points' accelerations; by row the state on which torques act, and by how much.

        φ̈ = r δ̈ + 2r′ω δ̇ + (r′ω̇ + r″ω²) δ beyond that of the base motion, δ̇ = π/M, δ̈ = π̇/M − Ṁπ/M².
        """
        topo, co = self.line.assembly.topology, self.line.co
        first, square, moved = len(found.energy) - topo.size, co.speed * co.speed, dict[int, tuple[int, Wave]]()
        growth = {} if topo.free else self._mass_rates(motion)
        for at, (s, _) in enumerate(topo.points, start=3 * len(topo.compliances) + len(topo.points)):
            group = topo.group_of(s)
            i, ref, r = topo.coordinate[group], topo.reference[group], motion.relative[s]
            base[at] = motion.acceleration[s] * square
            if i < 0:
                continue
            own, light = first + i, found.light[i]
            push = r * light
            moved[at] = own, push
            row = {j: push * entry for (k, j), entry in found.entries.items() if k == own}
            if not topo.free:
                w, w1 = motion.speed[ref] * co.speed, motion.acceleration[ref] * square
                r1, r2 = motion.relative_slope[s], motion.relative_curvature[s]
                turning_on = (r1 * w * 2.0) * light
                if i in growth:
                    turning_on = turning_on - push * light * growth[i]
                for j, more in ((own, turning_on), (i, r1 * w1 + r2 * (w * w))):
                    if more.size:
                        row[j] = row[j] + more if j in row else more
            rows |= {(at, j): wave for j, wave in row.items() if wave.size}
        return moved

    def _mass_rates(self, motion: Walk) -> dict[int, Wave]:
        """Ṁ = Σ 2J r r′ω by unknown, where joints within a group move it."""
        topo, co, found = self.line.assembly.topology, self.line.co, dict[int, Wave]()
        for s in range(len(topo.stations)):
            group = topo.group_of(s)
            i, ref = topo.coordinate[group], topo.reference[group]
            if i < 0 or not (co.inertia[s].size and motion.relative_slope[s].size):
                continue
            w = motion.speed[ref] * co.speed
            rate = co.inertia[s] * (motion.relative[s] * motion.relative_slope[s]) * w * 2.0
            found[i] = found[i] + rate if i in found else rate
        return found


@dataclass(frozen=True)
class _Stack:
    """Waves as arrays."""

    parameters: int
    last: int

    def vector(self, waves: dict[int, Wave], size: int, kept: slice) -> tuple[Complex, Array]:
        parts = np.zeros((1 + self.parameters, 2 * self.last + 1, size), dtype=complex)
        rest = np.zeros(size)
        for i, wave in waves.items():
            parts[:, :, i], rest[i] = wave.parts, wave.rest
        return parts[:, kept], rest * OUTWARD

    def rows(self, waves: dict[tuple[int, int], Wave], count: int, size: int, kept: slice) -> tuple[Complex, Array]:
        parts = np.zeros((1 + self.parameters, 2 * self.last + 1, count, size), dtype=complex)
        rest = np.zeros((count, size))
        for (row, column), wave in waves.items():
            parts[:, :, row, column], rest[row, column] = wave.parts, wave.rest
        return parts[:, kept], rest * OUTWARD


def _stride(parts: Sequence[Complex], last: int) -> int:
    """Every how many harmonics there is one: straight joints count in the period and move nothing."""
    there = np.zeros(2 * last + 1, dtype=bool)
    for one in parts:
        there |= np.any(one != 0, axis=tuple(k for k in range(one.ndim) if k != 1))
    return int(np.gcd.reduce(np.abs(np.flatnonzero(there) - last))) or last + 1
