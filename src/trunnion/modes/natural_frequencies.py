"""Natural frequencies, damping and mode shapes of the aligned line (all joint angles zero)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from trunnion.arrays import Array, Complex, Flags, Integers
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.vehicle import Tyre
from trunnion.equations.aligned import UnitMasses, frequencies, loaded_matrices
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.features import as_it_operates, left_out
from trunnion.modes.damped_modes import LineModes, line_modes
from trunnion.modes.own_frequencies import OwnModes, own_modes
from trunnion.results.drawing import Figure, drawing
from trunnion.results.fields import computed, coordinate, internal, labelled, variable
from trunnion.results.finding import Finding
from trunnion.results.result import Result
from trunnion.results.words import HERTZ, Words

ALIKE = 5e-4
"""Share by which damped and undamped frequencies may differ before a sentence gives both."""


@labelled
class NaturalFrequencies(Result):
    """Modes of the aligned line as it is damped, beside the undamped ones, by whose frequency they are numbered.

    What is not a field follows when it is asked for. Eigenvalues hold to rounding, 1e-12 of the highest frequency or
    damping rate.
    """

    names: tuple[str, ...] = coordinate("rotation")
    undamped_frequency: Array = variable("mode", "rad/s", "undamped, ascending, 0 of the rigid body")
    rigid_motions: int = internal("how many modes twist nothing; the free rotation of the whole line is the first")
    assembly: Assembly = internal("of the line")
    unit: str = internal("that frequencies are printed in, beside Hz")
    own: OwnModes | None = internal("where the oil of a damper is taken at each mode's own frequency", default=None)

    @property
    def rigid_body(self) -> bool:
        """Whether mode 1 is the free rotation of the whole line."""
        return self.assembly.topology.free

    @property
    def still(self) -> int:
        """How many modes no spring resists: those of rigid motions, and of what a damper alone drags along."""
        return self.assembly.topology.still

    @property
    @computed(coordinate("mode"), after="names")
    def mode(self) -> Integers:
        """Numbers of the modes (mode,), 1 first."""
        return np.arange(1, len(self.undamped_frequency) + 1)

    @cached_property
    def eigenvalue(self) -> Complex:
        """Both eigenvalues λ (mode, root) [1/s]: −ζ|λ| ± iω_d, or two real ones of an overdamped mode."""
        return self.modes.eigenvalue

    @property
    @computed(variable("mode", "rad/s", "damped"), after="names")
    def frequency(self) -> Array:
        """Damped frequency ω_d = Im λ of each mode (mode,) [rad/s]; NaN of an overdamped mode, 0 of the rigid body."""
        return np.where(self.overdamped, np.nan, self.eigenvalue[:, 0].imag)

    @property
    @computed(variable("mode", "1"))
    def damping_ratio(self) -> Array:
        """ζ = −Re λ/|λ| of each mode (mode,) [-]; NaN of an overdamped mode, 0 of the rigid body."""
        first, size = self.eigenvalue[:, 0], np.abs(self.eigenvalue[:, 0])
        ratio = np.divide(-first.real, size, out=np.zeros(len(size)), where=first.imag > 0)
        return np.where(self.overdamped, np.nan, ratio + 0.0)

    @property
    @computed(variable("mode root", "1/s", "of both eigenvalues"))
    def decay_rate(self) -> Array:
        """−Re λ (mode, root) [1/s]: motion dies out with e^(−rate · t); twice the same for a mode that oscillates."""
        return np.asarray(0.0 - self.eigenvalue.real)

    @property
    def overdamped(self) -> Flags:
        """Which modes do not oscillate (mode,), the rigid body aside."""
        still = self.eigenvalue[:, 0].imag == 0
        still[: self.still] = False
        return np.asarray(still)

    @cached_property
    def modes(self) -> LineModes:
        """Eigenvalues and complex shapes, in coordinates scaled with the roots of the inertias."""
        if self.own is not None:
            return self.own.modes
        return line_modes(*_matrices(self.assembly), _loose(self.assembly), self.rigid_motions)

    @cached_property
    @computed(variable("rotation mode", "1", "undamped mode shape"))
    def shape(self) -> Array:
        """Rotation of each inertia (rotation, mode) in the undamped modes, the largest entry 1."""
        unit = UnitMasses(self.assembly.aligned.inertia[0])
        if self.own is not None:
            return self.own.shape
        shape = unit.rotations(np.linalg.eigh(unit.of_matrix(self.assembly.aligned.stiffness[0]))[1])
        if self.still > 1:
            shape[:, : self.still] = self.assembly.topology.loose
        return np.asarray(shape / shape[np.abs(shape).argmax(0), np.arange(len(shape))])

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """What of the line is left out."""
        own = () if self.own is None else self.own.findings
        return left_out("natural_frequencies", self.assembly.line) + as_it_operates(self.assembly.line) + own

    @property
    def hertz(self) -> Array:
        """Damped frequencies in Hz."""
        return self.frequency / (2 * np.pi)

    @property
    def elastic(self) -> Array:
        """Undamped frequencies without the modes that do not vibrate [rad/s]."""
        return self.undamped_frequency[self.still :]

    def table(self, unit: str = "Hz") -> list[dict[str, object]]:
        """One row per mode, frequencies in ``unit``; what dies out without oscillating and what moves most named."""
        factor = Words(unit).factor
        still = any(self.overdamped)
        return [
            {
                "mode": i + 1,
                f"frequency [{unit}]": float(self.frequency[i] * factor),
                "damping ratio": float(self.damping_ratio[i]),
                f"undamped [{unit}]": float(self.undamped_frequency[i] * factor),
                **({"overdamped": self._decay(i)} if still else {}),
                "moves most": self._moves_most(i),
            }
            for i in range(len(self.undamped_frequency))
        ]

    def _moves_most(self, mode: int) -> str:
        if mode < self.rigid_motions:
            return "whole line" if self.rigid_body and mode == 0 else "shafts against each other"
        return self.names[np.argmax(np.abs(self.shape[:, mode]))]

    def _decay(self, mode: int) -> str:
        """How an overdamped mode dies out; "" of others."""
        if not self.overdamped[mode]:
            return ""
        slow, fast = (self.words.number(rate) for rate in self.decay_rate[mode])
        return f"decays at {slow} and {fast} 1/s"

    def plot(self, *, unit: str = "Hz", drive: str | None = None) -> Figure:
        """Mode shapes side by side; see ``pictures.modes.mode_shapes``."""
        return drawing(self, "plot")(self, unit=unit, drive=drive).figure

    def _lines(self) -> Iterator[str]:
        many = len(self.undamped_frequency)
        yield f"{many} natural frequencies of the aligned line (joint angles zero)"
        yield from (f"  mode {i + 1}: {self._said(i)}" for i in range(many))

    def _said(self, mode: int) -> str:
        if mode < self.rigid_motions:
            how = "the line turns as a whole" if self.rigid_body and mode == 0 else "shafts turn against each other"
            return f"0, rigid body ({how})"
        if mode < self.still:
            ring, slip = self._moves_most(mode), self.words.number(self.decay_rate[mode][1])
            return f"0, {ring} ({self._drag} alone drags it along; slip decays at {slip} 1/s)"
        undamped = self._shown(self.undamped_frequency[mode])
        if self.overdamped[mode]:
            return f"overdamped, {self._decay(mode)}; undamped {undamped}"
        ratio, frequency = self.damping_ratio[mode], self.frequency[mode]
        apart = abs(frequency - self.undamped_frequency[mode]) > ALIKE * frequency
        return f"{self._shown(frequency)}, damping ratio {ratio:.3g}{f'; undamped {undamped}' if apart else ''}"

    @property
    def _drag(self) -> str:
        """What joins it to the line."""
        topo, elements = self.assembly.topology, self.assembly.line.elements
        tyres = {isinstance(elements[topo.compliances[e].shafts[0]], Tyre) for e in topo.dragged}
        return "oil" if tyres == {False} else "slip" if tyres == {True} else "damping"

    def _shown(self, frequency: float) -> str:
        words = self.words
        return f"{'' if words.unit == 'Hz' else f'{words.speed(frequency)} = '}{HERTZ.speed(frequency)}"


def natural_frequencies(line: Driveline | Assembly) -> NaturalFrequencies:
    """Natural frequencies and damping of ``line`` as it stands, with all joint angles zero.

    M q̈ + C q̇ + (K + iH) q = 0 in absolute rotations; C holds viscous loads too, H loss factors that hold at all
    frequencies: a mode whose energy is all in such springs has the damping ratio sin(½ arctan η), nearly η/2. The
    frequencies are those of the damped line, from the complex eigenvalues λ: ω_d = Im λ = √(1 − ζ²)|λ|. Undamped ones,
    with C and H left out, stand beside them; resonance speeds are named after those. Ratios turn at their constant
    speed ratio; a ConstantSpeed end does not vibrate. Joint angles change these frequencies only at second order.

    Parameters
    ----------
    line : a ``Driveline`` or its ``Assembly``.

    Examples
    --------
    >>> import trunnion as tn
    >>> shaft = tn.Shaft(stiffness=1e4, damping=2.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=0.1), shaft, tn.Disk(inertia=0.8)])
    >>> print(tn.natural_frequencies(line))
    1 natural frequencies of the aligned line (joint angles zero)
      mode 1: 111.796 rad/s = 17.793 Hz, damping ratio 0.0112
    """
    assembly = assemble(line)
    topo = assembly.topology
    own = own_modes(assembly)
    found = frequencies(assembly.aligned, still=topo.still)[0] if own is None else own.modes.undamped
    return NaturalFrequencies(topo.names, found, topo.rigid_count, assembly, speed_unit(assembly.line), own)


def _matrices(assembly: Assembly) -> tuple[Array, Array, Array]:
    """Damping, stiffness and loss of unit masses, viscous loads among the damping."""
    coefficients = assembly.coefficients(assembly.table(1), any_frequency=True)
    matrices = loaded_matrices(assembly.topology, coefficients, np.zeros(1))
    unit = UnitMasses(matrices.inertia[0])
    return unit.of_matrix(matrices.damping[0]), unit.of_matrix(matrices.stiffness[0]), unit.of_matrix(matrices.loss[0])


def _loose(assembly: Assembly) -> Array:
    """Rotations that no spring resists (n, k), in coordinates scaled with the roots of the inertias."""
    return UnitMasses(assembly.aligned.inertia[0]).of_rotations(assembly.topology.loose)
