"""Fork offsets that make the output run as evenly as the joints allow.

For small angles joint i turns the output by a phasor β_i² e^{2jχ_i}, and the line is as uneven as one joint
of β_eq = |Σ β_i² e^{2jχ_i}|^½: phase the forks so that the phasors close. The exact rule (``equivalent``)
replaces β² by the rapidity ln sec β and closes them on a hyperbolic plane, so three joints or more can be
phased to run exactly evenly unless one of them outweighs all others. Offsets repeat after half a turn.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.arguments import quantity
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.quantities import ANGLE, DEGREE
from trunnion.driveline.refusals import nearest
from trunnion.equations.topology import LinkKind
from trunnion.errors import InputError
from trunnion.response.kinetostatics import equivalent
from trunnion.response.kinetostatics.chain import KinematicChain, chain
from trunnion.response.kinetostatics.measures import equivalent_angle, extremes, phasor_angle
from trunnion.response.kinetostatics.motion import drive_jet, walk

HALF_TURN = np.pi
STARTS, POLISHED = 4000, 6
MOST_POSITIONS = 200_000
SAME = 1e-13
"""Difference of irregularities that counts as none."""
POINTS = 96
"""Angles per turn where the output has to be sampled."""
WHOLE = 0.01
"""How far from whole a turn over a pitch may be: 7.826 deg is 46 splines, as drawings round it."""


@dataclass(frozen=True, eq=False)
class Phasing:
    """The best fork offsets found for a line.

    Attributes
    ----------
    offsets : fork offset [rad] of each shaft between two joints, in (−90°, 90°] (with splines, (−180°,
        180°]).
    irregularity, before : of the output with these offsets, and with the line's own [-].
    bound : what no phasing of these joints can go below [-]; None where other joints or ratios leave it unknown.
    phasor_angle : equivalent angle [rad] that the small-angle rule gives for these offsets.
    pitch : of the splines [rad] the offsets are multiples of, if one was given for all shafts.
    line : the driveline with these offsets.
    """

    offsets: dict[str, float]
    irregularity: float
    before: float
    bound: float | None
    phasor_angle: float
    pitch: float | None
    line: Driveline

    @property
    def equivalent_angle(self) -> float:
        """Angle [rad] of the single Hooke's joint as uneven as this line."""
        return float(equivalent_angle(self.irregularity))

    def __str__(self) -> str:
        steps = f" on splines of {self.pitch / DEGREE:.4g} deg" if self.pitch else ""
        rows = [
            f"fork phasing of {len(self.offsets)} shaft{'s' * (len(self.offsets) > 1)}{steps}: irregularity "
            f"{self.irregularity:.4g} (before {self.before:.4g}), as one Hooke's joint of "
            f"{self.equivalent_angle / DEGREE:.4g} deg"
        ]
        if self.bound is not None:
            rows[0] += f"; these joints cannot do better than {self.bound:.4g}"
        rows += [f"  {name}: fork offset {x / DEGREE:.4f} deg" for name, x in self.offsets.items()]
        return "\n".join(rows)

    __repr__ = __str__


def phase_forks(
    line: Driveline,
    pitch: float | str | Mapping[str, float | str] | None = None,
    *,
    branch: str | None = None,
) -> Phasing:
    """Choose the fork offsets of the shafts between joints for the least irregular output.

    Parameters
    ----------
    line : with two joints or more that have an irregularity of their own.
    pitch : spline pitch [rad], for all shafts or by shaft name: those offsets are then whole multiples of it.
    branch : name of an element on the branch whose output is to run evenly; default the one that ends the line.

    Raises
    ------
    InputError : no shaft between two such joints, or a pitch that does not divide a turn.

    Examples
    --------
    >>> import trunnion as tn
    >>> joints = tn.HookeJoint(angle="10 deg"), tn.HookeJoint(angle="10 deg", plane="30 deg")
    >>> line = tn.Driveline([tn.ConstantSpeed(), joints[0], tn.Shaft(stiffness=1e4), joints[1], tn.Disk(inertia=1.0)])
    >>> found = tn.phase_forks(line)
    >>> round(found.offsets["Shaft 1"], 4), round(found.before, 5)
    (0.5236, 0.03062)
    """
    train = chain(line, branch=branch)
    free = phased_shafts(train)
    if not free:
        raise InputError(
            "has no Shaft between two joints whose forks could be turned",
            element="driveline",
            remedy="put a Shaft between two Hooke's joints",
        )
    pitches = _pitches(train, free, pitch)
    own = np.array([train.steps[i].fork_offset for i in free])
    best = _continuous(train, free, own)
    # half a turn need not be a whole number of splines: their offsets are kept within a whole turn
    turn = np.where(np.isfinite(pitches), 2 * HALF_TURN, HALF_TURN)
    if np.any(np.isfinite(pitches)):
        positions = turn / 2 - (turn / 2 - _spline_positions(pitches, best)) % turn
        value = irregularity_of(train, free, positions)
        good = positions[value <= value.min() + SAME]
        best = good[int(np.abs(good).max(axis=1).argmin())]
    best = turn / 2 - (turn / 2 - best) % turn
    offsets = {train.steps[i].name: float(x) for i, x in zip(free, best, strict=True)}
    phased = line
    for name, x in offsets.items():
        phased = phased.replace(name, fork_offset=x)
    return Phasing(
        offsets=offsets,
        irregularity=float(irregularity_of(train, free, best[None])[0]),
        before=float(irregularity_of(train, free, own[None])[0]),
        bound=equivalent.least_irregularity(train) if equivalent.is_one_joint(train) else None,
        phasor_angle=float(phasor_angle(*equivalent.phasors(chain(phased, branch=branch)))),
        pitch=float(pitches[0]) if np.isfinite(pitches[0]) and np.ptp(pitches) == 0 else None,
        line=phased,
    )


def phased_shafts(train: KinematicChain) -> tuple[int, ...]:
    """The first Shaft between each two neighbouring joints that are not ideal, on the way to the output."""
    found: list[int] = []
    shaft, seen = None, False
    for i in train.way:
        step = train.steps[i]
        if step.link is LinkKind.SHAFT and seen and shaft is None:
            shaft = i
        elif step.orders:
            found += [shaft] if shaft is not None else []
            shaft, seen = None, True
    return tuple(found)


def irregularity_of(
    train: KinematicChain,
    free: tuple[int, ...],
    offsets: Array,
    *,
    angle: Mapping[int, Array] | None = None,
    plane: Mapping[int, Array] | None = None,
) -> Array:
    """Exact irregularity U of the rigid line for each row of ``offsets`` (case, free shaft).

    ``angle`` and ``plane`` replace those of joint steps, arrays (case,).
    """
    shafts = {i: offsets[:, k] for k, i in enumerate(free)}
    if equivalent.is_one_joint(train):
        lines = equivalent.matrices(train, len(offsets), angle=angle, plane=plane, fork_offset=shafts)
        return equivalent.irregularity(lines)
    points = POINTS * train.fastest
    input_angle: Array = np.arange(train.turns * points, dtype=np.float64) * (2 * np.pi / points)
    drive = drive_jet(input_angle, 1.0, 0.0, 1)[:, None]

    def column(values: Mapping[int, Array] | None) -> dict[int, Array]:
        return {i: x[:, None] for i, x in (values or {}).items()}

    motion = walk(train, drive, angle=column(angle), plane=column(plane), fork_offset=column(shafts))
    speed = np.broadcast_to(motion.angle[train.behind[train.output]][1], (len(offsets), drive.shape[-1]))
    low, high = extremes(speed)
    return np.asarray((high - low) / abs(float(train.steps[train.behind[train.output]].speed)))


def _continuous(train: KinematicChain, free: tuple[int, ...], own: Array) -> Array:
    """Offsets of least irregularity; of several equally good ones the nearest to the line's own."""
    n = len(free)
    per_shaft = int(STARTS ** (1 / n))
    if per_shaft >= 8:
        grid = np.stack(np.meshgrid(*[np.arange(per_shaft) * HALF_TURN / per_shaft] * n), -1).reshape(-1, n)
    else:
        grid = np.random.default_rng(0).uniform(0, HALF_TURN, (STARTS, n))
    candidates = np.vstack([own, grid])
    value = irregularity_of(train, free, candidates)
    starts = candidates[np.argsort(value, kind="stable")[:POLISHED]]
    ends = np.array([_polish(train, free, start) for start in starts] + [own])
    value = irregularity_of(train, free, ends)
    good = ends[value <= value.min() + SAME]
    away = np.abs((good - own + HALF_TURN / 2) % HALF_TURN - HALF_TURN / 2)
    return np.asarray(good[int(away.max(axis=1).argmin())])


def _polish(train: KinematicChain, free: tuple[int, ...], start: Array) -> Array:
    from scipy.optimize import least_squares, minimize

    if equivalent.is_one_joint(train):

        def rest(x: Array) -> Array:
            shafts = {i: x[None, k] for k, i in enumerate(free)}
            return equivalent.departure(equivalent.matrices(train, 1, fork_offset=shafts))[0]

        return np.asarray(least_squares(rest, start, xtol=1e-15, ftol=1e-15, gtol=1e-15).x)
    options = {"xatol": 1e-10, "fatol": 1e-14, "maxiter": 400 * len(free)}
    return np.asarray(
        minimize(
            lambda x: float(irregularity_of(train, free, x[None])[0]),
            start,
            method="Nelder-Mead",
            options=options,
        ).x
    )


def _spline_positions(pitches: Array, near: Array) -> Array:
    """All spline positions in half a turn, or those around the continuous optimum where they are too many."""

    def positions(pitch: float, x: float, around: bool) -> Array:
        if not np.isfinite(pitch):
            return np.array([x])
        if around:
            return pitch * (np.round(x / pitch) + np.arange(-2, 3))
        # a whole turn, because half a turn need not be a whole number of splines
        return np.arange(0, 2 * np.pi - 1e-9, pitch)

    each = [positions(p, x, False) for p, x in zip(pitches, near, strict=True)]
    if float(np.prod([float(len(e)) for e in each])) > MOST_POSITIONS:
        each = [positions(p, x, True) for p, x in zip(pitches, near, strict=True)]
    return np.array(list(product(*each)))


def _pitches(
    train: KinematicChain, free: tuple[int, ...], pitch: float | str | Mapping[str, float | str] | None
) -> Array:
    names = [train.steps[i].name for i in free]
    given = dict(pitch) if isinstance(pitch, Mapping) else {n: pitch for n in names if pitch is not None}
    pitches = dict.fromkeys(names, np.inf)
    for name, value in given.items():
        if name not in names:
            raise InputError("is not a Shaft between two joints", key="pitch", value=name, remedy=nearest(name, names))
        pitches[name] = quantity(value, ANGLE, "pitch")
        if not pitches[name] > 0:
            raise InputError("must be positive", key="pitch", value=value, remedy='write "10 deg" for 36 splines')
        pitches[name] = _whole_splines(pitches[name], value)
    return np.array([pitches[n] for n in names])


def _whole_splines(pitch: float, given: object) -> float:
    """The pitch of the whole number of splines that is meant, free of its rounding."""
    count = 2 * np.pi / pitch
    whole = round(count)
    if whole and abs(count - whole) <= WHOLE:
        return 2 * np.pi / whole
    fewer = max(int(count), 1)
    nearest_first = sorted((fewer, fewer + 1), key=lambda n: abs(360 / n - pitch / DEGREE))
    near = [f'"{360 / n:.8g} deg" ({n} spline{"s" * (n > 1)})' for n in nearest_first]
    raise InputError(
        f"does not divide a turn: {count:.6g} splines", key="pitch", value=given, remedy=f"write {' or '.join(near)}"
    )
