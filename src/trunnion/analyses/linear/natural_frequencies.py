"""Natural frequencies, mode shapes and damping ratios of the aligned line (all joint angles zero)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from trunnion.analyses.features import left_out
from trunnion.arrays import Array, Complex
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.aligned import AlignedMatrices, frequencies
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.results.declared import Held, Result, axis, fields_over, over
from trunnion.results.drawing import Figure, drawing
from trunnion.results.finding import Finding
from trunnion.results.speeds import show_speed, speed_factor

NO_OSCILLATION = 1e-3
"""Share of the lowest elastic frequency below which an eigenvalue does not oscillate."""


@dataclass(frozen=True, repr=False)
class NaturalFrequencies(Result):
    """Modes of the aligned line, by ascending frequency.

    frequency (mode,) undamped [rad/s]; damping_ratio (mode,) [1], from the damped eigenvalues where the mode
    oscillates; shape (rotation, mode): rotation of each inertia, largest entry 1; names (rotation,).
    ``rigid_body`` tells that mode 1 is the free rotation of the whole line. ``findings`` say what of the line is
    left out. Damping ratios, shapes and findings are computed when they are asked for.
    """

    frequency: Array
    names: tuple[str, ...]
    rigid_body: bool
    assembly: Assembly

    @cached_property
    def shape(self) -> Array:
        """Rotation of each inertia (rotation, mode), the largest entry 1."""
        shape = self._vectors / np.sqrt(self.assembly.aligned.mass[0])[:, None]
        return np.asarray(shape / shape[np.abs(shape).argmax(0), np.arange(len(shape))])

    @cached_property
    def damping_ratio(self) -> Array:
        """Damping ratio of each mode (mode,)."""
        matrices = self.assembly.aligned
        damping, stiffness, loss = (
            _over_masses(part[0], matrices) for part in (matrices.damping, matrices.stiffness, matrices.loss)
        )
        return _damping_ratios(damping, stiffness, loss, self._vectors, self.frequency)

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """What of the line is left out."""
        return left_out("natural_frequencies", self.assembly.line)

    @cached_property
    def _vectors(self) -> Array:
        matrices = self.assembly.aligned
        return np.linalg.eigh(_over_masses(matrices.stiffness[0], matrices))[1]

    @property
    def hertz(self) -> Array:
        """Frequencies in Hz."""
        return self.frequency / (2 * np.pi)

    @property
    def elastic(self) -> Array:
        """Frequencies without the rigid-body mode [rad/s]."""
        return self.frequency[1:] if self.rigid_body else self.frequency

    def declared(self) -> Iterator[Held]:
        """Frequency and damping ratio over the modes, mode shapes over (rotation, mode)."""
        yield axis("mode", np.arange(1, len(self.frequency) + 1))
        yield axis("rotation", self.names)
        yield from fields_over("mode", self, frequency="rad/s", damping_ratio="1")
        yield over("rotation mode", "shape", self.shape, "1", "mode shape")

    def table(self, unit: str = "Hz") -> list[dict[str, object]]:
        """One row per mode, frequencies in ``unit``; the mode's largest motion named."""
        factor = speed_factor(unit)
        return [
            {
                "mode": i + 1,
                f"frequency [{unit}]": float(w * factor),
                "damping ratio": float(z),
                "moves most": "whole line" if self.rigid_body and i == 0 else self.names[np.argmax(np.abs(v))],
            }
            for i, (w, z, v) in enumerate(zip(self.frequency, self.damping_ratio, self.shape.T, strict=True))
        ]

    def plot(self, *, unit: str = "Hz", drive: str | None = None) -> Figure:
        """Mode shapes side by side; see ``plots.mode_shapes.draw``."""
        return drawing(self, "plot")(self, unit=unit, drive=drive)

    def __str__(self) -> str:
        unit = speed_unit(self.assembly.line)
        lines = [f"{len(self.frequency)} natural frequencies of the aligned line (joint angles zero)"]
        for i, (w, z) in enumerate(zip(self.frequency, self.damping_ratio, strict=True), start=1):
            if self.rigid_body and i == 1:
                lines.append(f"  mode {i}: 0, rigid body (the line turns as a whole)")
            else:
                first = "" if unit == "Hz" else f"{show_speed(w, unit)} = "
                lines.append(f"  mode {i}: {first}{show_speed(w, 'Hz')}, damping ratio {z:.3g}")
        return "\n".join([*lines, *(f"  {finding}" for finding in self.findings)])


def natural_frequencies(line: Driveline | Assembly) -> NaturalFrequencies:
    """Natural frequencies of ``line`` with all joint angles zero.

    M q̈ + C q̇ + (K + iH) q = 0 in absolute rotations, H from loss factors that hold at all frequencies: a mode whose
    energy is all in such springs has the damping ratio sin(½ arctan η), nearly η/2. Ratios turn at their constant speed
    ratio; a ConstantSpeed end does not vibrate. Joint angles change these frequencies only at second order; resonance
    speeds are named after them.
    """
    assembly = assemble(line)
    topo = assembly.topology
    found = frequencies(assembly.aligned, free=topo.free)[0]
    return NaturalFrequencies(found, topo.names, topo.free, assembly)


def _over_masses(part: Array, matrices: AlignedMatrices) -> Array:
    root = np.sqrt(matrices.mass[0])
    return np.asarray(part / np.outer(root, root))


def _damping_ratios(damping: Array, stiffness: Array, loss: Array, vectors: Array, frequency: Array) -> Array:
    """−Re λ/|λ| of the damped modes; by modal projection where a mode does not oscillate."""
    n = len(frequency)
    if not damping.any() and not loss.any():
        return np.zeros(n)
    modal, lost = (np.einsum("im,ij,jm->m", vectors, part, vectors) for part in (damping, loss))
    ratio = np.divide(modal * frequency + lost, 2 * frequency**2, out=np.zeros(n), where=frequency > 0)
    if np.any(np.abs(ratio) >= 0.9):
        return ratio
    whole = stiffness + 1j * loss if loss.any() else stiffness
    oscillating = frequency > 0
    values, _ = damped_modes(damping, whole, NO_OSCILLATION * float(frequency[oscillating].min(initial=np.inf)))
    if len(values) == oscillating.sum():
        ratio[oscillating] = -values.real / np.abs(values)
    return ratio


def damped_modes(damping: Array, stiffness: Array | Complex, least: float) -> tuple[Complex, Complex]:
    """Eigenvalues of λ² + λC + K with an imaginary part above ``least`` [rad/s], by modulus; their shapes (n, values).

    C and K stand for unit masses. The pair at 0 of a line that turns freely, which rounding parts by the root of its
    own size, is no oscillation: ``least`` keeps it out.
    """
    n = len(damping)
    values, vectors = np.linalg.eig(np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness, -damping]]))
    above = np.flatnonzero(values.imag > least)
    above = above[np.argsort(np.abs(values[above]))]
    return values[above], vectors[:n, above]
