"""The best stiffness and damping of a damper for one mode of a line."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from trunnion.driveline.dampers import Damper, ViscousDamper
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.quantities import DAMPING, INERTIA, STIFFNESS, shown
from trunnion.driveline.refusals import nearest
from trunnion.equations.aligned import UnitMasses, aligned_matrices
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.errors import InputError
from trunnion.laws.dampers import tuned_optimum, viscous_optimum
from trunnion.results.fields import attribute, internal, labelled, variable
from trunnion.results.result import Result

STANDS = 1e-9
"""Share of the largest rotation of a mode below which the damper stands in a node."""


@labelled
class DamperOptimum(Result):
    """What a damper needs for one mode, as if the others were far away."""

    damper: str = attribute()
    mode: int = attribute("number of the mode, the damper's ring left out of the line")
    frequency: float = variable("", "rad/s", "of that mode, undamped")
    effective_inertia: float = variable("", "kg*m^2", "of that mode at the damper")
    inertia_ratio: float = variable("", "1", "of the ring over it")
    stiffness: float = variable("", "N*m/rad", "of the link between housing and ring; 0: none")
    damping: float = variable("", "N*m*s/rad", "of that link")
    damping_ratio: float = variable("", "1", "over twice ring inertia times frequency")
    amplification: float = variable("", "1", "at the fixed points, over the static twist of the mode")
    unit: str = internal("of frequencies in print")

    def _lines(self) -> Iterator[str]:
        spring = f"stiffness {shown(self.stiffness, STIFFNESS, digits=5)} and " if self.stiffness else ""
        words = self.words
        yield (
            f"{self.damper} for mode {self.mode} at {words.speed(self.frequency)}: {spring}damping "
            f"{shown(self.damping, DAMPING, digits=5)} (damping ratio {self.damping_ratio:.4f})"
        )
        yield (
            f"  ring over effective inertia {shown(self.effective_inertia, INERTIA, digits=5)}: "
            f"{self.inertia_ratio:.4g}; amplification {self.amplification:.4g}"
        )


def damper_optimum(line: Driveline | Assembly, damper: str, mode: int = 1) -> DamperOptimum:
    """Stiffness and damping of a ViscousDamper or TunedDamper that are best for one mode of ``line``.

    The mode, with joints straight, without damping and without the damper's ring, turns the damper's housing by 1: it
    has the effective inertia φᵀMφ there, and the ring μ times as much. Closed forms follow by fixed points
    (``trunnion.laws.dampers``); they hold for a mode whose neighbours are far away and which is damped by little else.

    Parameters
    ----------
    line : a ``Driveline`` or its ``Assembly``.
    damper : its name.
    mode : number among the elastic modes of the line without its ring, from 1.

    Raises
    ------
    InputError : no damper of that name; no such mode; a mode that has a node where the damper stands.

    Examples
    --------
    >>> import trunnion as tn
    >>> damper = tn.ViscousDamper(name="damper", inertia=0.01, ring_inertia=0.05, damping=1.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.5), damper])
    >>> round(tn.damper_optimum(line, "damper").damping, 4)
    6.5236
    """
    assembly = assemble(line)
    described, topo = assembly.line, assembly.topology
    place = described.names.index(damper) if damper in described.names else -1
    element = described.elements[place] if place >= 0 else None
    if not isinstance(element, Damper):
        dampers = [name for name, one in described.parts if isinstance(one, Damper)]
        raise InputError(
            "is not a damper of this driveline", key="damper", value=damper, remedy=nearest(damper, dampers)
        )
    compliance = next(e for e, one in enumerate(topo.compliances) if place in one.shafts)
    ring, near = topo.ends[compliance][0], topo.compliances[compliance].near
    co = assembly.coefficients(assembly.table(1), any_frequency=True)
    stiffness = co.stiffness.copy()
    stiffness[:, compliance] = 0.0
    matrices = aligned_matrices(topo, replace(co, stiffness=stiffness))
    kept = np.delete(np.arange(topo.size), ring)
    masses = UnitMasses(matrices.inertia[0][np.ix_(kept, kept)])
    squares, shapes = np.linalg.eigh(masses.of_matrix(matrices.stiffness[0][np.ix_(kept, kept)]))
    rigid = topo.still - (compliance in topo.dragged)
    elastic = len(kept) - rigid
    if isinstance(mode, bool) or not isinstance(mode, int | np.integer) or not 1 <= mode <= elastic:
        raise InputError("is not an elastic mode", key="mode", value=mode, remedy=f"write a number from 1 to {elastic}")
    frequency = float(np.sqrt(squares[rigid + mode - 1]))
    shape = masses.rotations(shapes[:, [rigid + mode - 1]])[:, 0]
    turned = float(topo.turning[near, kept] @ shape)
    if abs(turned) < STANDS * np.abs(shape).max():
        remedy = "put the damper where the mode moves, at a free end of the line"
        raise InputError(f"stands in a node of mode {mode}, which moves nothing there", element=damper, remedy=remedy)
    effective = 1 / turned**2  # of a shape of unit modal mass
    inertia = element.ring_inertia
    ratio, spring = inertia / effective, 0.0
    if isinstance(element, ViscousDamper):
        damped, amplification = viscous_optimum(ratio)
    else:
        tuning, damped, amplification = tuned_optimum(ratio)
        spring = inertia * (tuning * frequency) ** 2
    return DamperOptimum(
        damper=damper, mode=mode, frequency=frequency, effective_inertia=effective, inertia_ratio=ratio,
        stiffness=spring, damping=2 * inertia * frequency * damped, damping_ratio=damped, amplification=amplification,
        unit=speed_unit(described),
    )  # fmt: skip
