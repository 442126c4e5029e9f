"""What errors of assembly do to the evenness of the output: each alone, and all at their worst together."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.arguments import quantity
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.quantities import ANGLE, DEGREE
from trunnion.errors import InputError
from trunnion.response.kinetostatics.chain import KinematicChain, chain
from trunnion.response.kinetostatics.measures import equivalent_angle
from trunnion.response.kinetostatics.phasing import irregularity_of, phased_shafts

MOST_TOGETHER = 12
"""Errors up to which every combination of signs is tried; beyond, 4096 random ones."""


@dataclass(frozen=True, eq=False)
class AssemblySensitivity:
    """Irregularity with each angle off by ± ``error``.

    ``names`` are parameters as "HookeJoint 1.angle"; ``below`` and ``above`` (name,) the irregularities
    with the error taken off and added; ``nominal`` without errors; ``worst`` with all of them, signs at
    their worst.
    """

    error: float
    names: tuple[str, ...]
    below: Array
    above: Array
    nominal: float
    worst: float

    @property
    def effect(self) -> Array:
        """Largest change of the irregularity by each error alone [-]."""
        return np.maximum(np.abs(self.below - self.nominal), np.abs(self.above - self.nominal))

    def __str__(self) -> str:
        rows = [
            f"assembly errors of ± {self.error / DEGREE:.4g} deg: irregularity {self.nominal:.4g} without, "
            f"up to {self.worst:.4g} with all together (as one Hooke's joint of "
            f"{equivalent_angle(self.worst) / DEGREE:.3g} deg)"
        ]
        rows += [
            f"  {self.names[k]}: {self.below[k]:.4g} with − error, {self.above[k]:.4g} with + error"
            for k in np.argsort(-self.effect, kind="stable")
        ]
        return "\n".join(rows)

    __repr__ = __str__


def assembly_sensitivity(
    line: Driveline, error: float | str = DEGREE, *, branch: str | None = None
) -> AssemblySensitivity:
    """Irregularity of the output under errors of joint angles, planes and fork offsets.

    The first joint's plane and the offset in front of it only turn the origin and are left out.

    Parameters
    ----------
    line : with joints.
    error : size of every error [rad].
    branch : name of an element on the branch whose output is asked about; default the one that ends the line.

    Examples
    --------
    >>> import trunnion as tn
    >>> line = tn.cardan_line(["10 deg", "10 deg"], nu=["90 deg"], beta=["0 deg"])
    >>> tn.assembly_sensitivity(line, "0.5 deg")
    assembly errors of ± 0.5 deg: irregularity 0.06124 without, up to 0.06756 with all together (as one Hooke's
      joint of 14.8 deg)
      HookeJoint 1.angle: 0.05824 with − error, 0.0644 with + error
      HookeJoint 2.angle: 0.05824 with − error, 0.0644 with + error
      HookeJoint 2.plane: 0.06124 with − error, 0.06124 with + error
      intermediate shaft 1.fork_offset: 0.06124 with − error, 0.06124 with + error
    """
    size = quantity(error, ANGLE, "error")
    if not size > 0:
        raise InputError("must be positive", key="error", value=error, remedy='write "1 deg", say')
    train = chain(line, branch=branch)
    hooke, shafts = tuple(i for i in train.way if train.steps[i].cross), phased_shafts(train)
    if not hooke:
        raise InputError("has no Hooke's joint", element="driveline", remedy="its output is as even as its input")
    _refuse_reaching_90(train, hooke, size, error)
    places = [("angle", i) for i in hooke] + [("plane", i) for i in hooke[1:]] + [("fork_offset", i) for i in shafts]

    def spread(signs: Array) -> Array:
        """U for each row of signs (case, place)."""
        change: dict[str, dict[int, Array]] = {"angle": {}, "plane": {}, "fork_offset": {}}
        for k, (key, i) in enumerate(places):
            change[key][i] = getattr(train.steps[i], key) + size * signs[:, k]
        offsets = np.stack([change["fork_offset"][i] for i in shafts], axis=1) if shafts else np.empty((len(signs), 0))
        return irregularity_of(train, shafts, offsets, angle=change["angle"], plane=change["plane"])

    single = np.eye(len(places))
    if len(places) <= MOST_TOGETHER:
        together = np.array(list(product((-1.0, 1.0), repeat=len(places))))
    else:
        together = np.random.default_rng(0).choice((-1.0, 1.0), (2**MOST_TOGETHER, len(places)))
    return AssemblySensitivity(
        error=size,
        names=tuple(f"{train.steps[i].name}.{key}" for key, i in places),
        below=spread(-single),
        above=spread(single),
        nominal=float(spread(np.zeros((1, len(places))))[0]),
        worst=float(max(spread(together).max(), spread(single).max(), spread(-single).max())),
    )


def _refuse_reaching_90(train: KinematicChain, hooke: tuple[int, ...], size: float, error: float | str) -> None:
    """An error that bends a joint by 90° or more describes no joint."""
    i = max(hooke, key=lambda j: abs(train.steps[j].angle))
    bent = abs(train.steps[i].angle)
    if bent + size >= np.pi / 2 - 1e-9:
        raise InputError(
            f"carries {train.steps[i].name} ({bent / DEGREE:.4g} deg) to 90 deg or beyond",
            key="error",
            value=error,
            remedy='numbers are radians: write "1 deg", say',
        )
