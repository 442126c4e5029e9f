"""Fork offsets that make the output run as evenly as the joints allow.

For small angles joint i turns the output by a phasor β_i² e^{2jχ_i}, and the line is as uneven as one joint of
β_eq = |Σ β_i² e^{2jχ_i}|^½: phase the forks so that the phasors close. That rule picks the starts; the exact
irregularity of the rigid line then decides, because at large angles closed phasors leave a fourth-power rest.
Offsets repeat after half a turn.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.kinetostatics.chain import Chain, Link, chain
from trunnion.analyses.kinetostatics.measures import equivalent_angle, extremes, phasor_angle
from trunnion.analyses.kinetostatics.motion import QUARTER_TURN, drive_jet, walk
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.quantities import ANGLE, DEGREE, parse
from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError

Array = NDArray[np.float64]
HALF_TURN = np.pi
COARSE = 8000
"""Offset combinations tried by the phasor rule."""
STARTS = 12
MOST_COMBINATIONS = 200_000
POINTS = 96


@dataclass(frozen=True, eq=False)
class Phasing:
    """The best fork offsets found for a line.

    ``offsets`` [rad] by shaft in (−90°, 90°]; ``irregularity`` and ``equivalent_angle`` [1, rad] of the line so
    phased, ``before`` the irregularity as it was; ``phasor_angle`` [rad] what the small-angle rule says of the
    result; ``line`` the driveline with these offsets; ``pitch`` [rad] of the splines they were rounded to.
    """

    offsets: dict[str, float]
    irregularity: float
    before: float
    phasor_angle: float
    pitch: float | None
    line: Driveline

    @property
    def equivalent_angle(self) -> float:
        """Angle [rad] of the single Hooke's joint as uneven as this line."""
        return float(equivalent_angle(self.irregularity))

    def __str__(self) -> str:
        steps = f", splines of {self.pitch / DEGREE:.4g} deg" if self.pitch else ""
        rows = [
            f"fork phasing of {len(self.offsets)} shafts{steps}: irregularity {self.irregularity:.4g} (before "
            f"{self.before:.4g}), as one Hooke's joint of {self.equivalent_angle / DEGREE:.4g} deg"
        ]
        rows += [f"  {name}: fork offset {x / DEGREE:.4f} deg" for name, x in self.offsets.items()]
        return "\n".join(rows)

    __repr__ = __str__


def phase_forks(line: Driveline, pitch: float | str | Mapping[str, float | str] | None = None) -> Phasing:
    """Choose the fork offsets of the shafts between joints for the least irregular output.

    Parameters
    ----------
    line : with two Hooke's joints or more; its own offsets are where it starts from and what it falls back on.
    pitch : spline pitch [rad], for all shafts or by shaft name: offsets are then whole multiples of it.

    Raises
    ------
    InputError : no shaft between two joints, a pitch that is not positive, or too many spline positions.
    """
    train = chain(line)
    free = phased_shafts(train)
    if not free:
        raise InputError(
            "has no Shaft between two Hooke's joints whose forks could be turned",
            element="driveline",
            remedy="put a Shaft between the joints",
        )
    pitches = _pitches(train, free, pitch)
    own = np.array([train.steps[i].fork_offset for i in free])
    before = float(irregularity_of(train, free, own[None])[0])
    best, least = own, before
    if any(np.isfinite(p) for p in pitches):
        candidates = _spline_positions(pitches, _continuous(train, free, own))
        values = irregularity_of(train, free, candidates)
        best, least = candidates[int(values.argmin())], float(values.min())
    else:
        found = _continuous(train, free, own)
        value = float(irregularity_of(train, free, found[None])[0])
        if value < least:
            best, least = found, value
    best = -((-best + HALF_TURN / 2) % HALF_TURN - HALF_TURN / 2)
    offsets = {train.steps[i].name: float(x) for i, x in zip(free, best, strict=True)}
    phased = line
    for name, x in offsets.items():
        phased = phased.replace(name, fork_offset=x)
    common = pitches[0] if np.isfinite(pitches[0]) and len(set(pitches)) == 1 else None
    return Phasing(offsets, least, before, float(_phasors(train, free, best[None])[0]), common, phased)


def phased_shafts(train: Chain) -> tuple[int, ...]:
    """The first Shaft step between each two neighbouring joints that are not ideal."""
    found = []
    for j in train.of(Link.HOOKE, Link.TRIPOD):
        shaft, i = None, train.steps[j].parent
        while i > 0 and train.steps[i].link not in (Link.HOOKE, Link.TRIPOD):
            if train.steps[i].link is Link.SHAFT:
                shaft = i
            i = train.steps[i].parent
        if i > 0 and shaft is not None and shaft not in found:
            found.append(shaft)
    return tuple(found)


def irregularity_of(
    train: Chain,
    free: tuple[int, ...],
    offsets: Array,
    *,
    points: int = POINTS,
    turns: int = 1,
    **changed: Mapping[int, Array],
) -> Array:
    """Exact irregularity U of the rigid line for each row of ``offsets`` (case, free shaft).

    ``changed`` replaces ``angle`` or ``plane`` of joint steps, arrays (case,). Extremes are refined from
    ``points`` per turn.
    """
    drive = drive_jet(np.arange(turns * points) * (2 * np.pi / points), 1.0, 0.0, 1)[:, None]
    shafts = {i: offsets[:, k, None] for k, i in enumerate(free)}
    others = {key: {i: x[:, None] for i, x in steps.items()} for key, steps in changed.items()}
    speed = walk(train, drive, fork_offset=shafts, **others).angle[-1][1]
    low, high = extremes(np.broadcast_to(speed, (len(offsets), speed.shape[-1])))
    return np.asarray((high - low) / abs(train.mean_ratio(len(train.steps) - 1)))


def _phasors(train: Chain, free: tuple[int, ...], offsets: Array) -> Array:
    """β_eq [rad] of the small-angle rule for each row of ``offsets``."""
    a = [np.zeros(len(offsets))]
    angles, phases = [], []
    for i, step in enumerate(train.steps[1:], start=1):
        here = a[step.parent]
        if step.link is Link.SHAFT:
            here = here + (offsets[:, free.index(i)] if i in free else step.fork_offset)
        elif step.link is Link.HOOKE:
            angles.append(step.angle)
            phases.append(here - step.plane)
            here = phases[-1] + QUARTER_TURN + step.fork_offset
        elif step.link in (Link.IDEAL, Link.TRIPOD):
            here = here - step.plane
        elif step.link is Link.RATIO:
            here = here / step.ratio
        a.append(here)
    return phasor_angle(np.array(angles), np.stack(phases, axis=-1))


def _continuous(train: Chain, free: tuple[int, ...], own: Array) -> Array:
    """Offsets of the least irregularity: best phasors first, exact kinematics after."""
    from scipy.optimize import minimize

    n = len(free)
    rng = np.random.default_rng(0)
    per_shaft = max(int(COARSE ** (1 / n)), 2)
    if per_shaft >= 12:
        grid = np.stack(np.meshgrid(*[np.arange(per_shaft) * HALF_TURN / per_shaft] * n), -1).reshape(-1, n)
    else:
        grid = rng.uniform(0, HALF_TURN, (COARSE, n))
    candidates = np.vstack([own, grid])
    rule = _phasors(train, free, candidates)
    starts = candidates[np.argsort(rule, kind="stable")[: 25 * STARTS]]
    exact = irregularity_of(train, free, starts)
    best, least = own, float(irregularity_of(train, free, own[None])[0])
    for start in starts[np.argsort(exact, kind="stable")[:STARTS]]:
        # the rule's optimum near this start, then the exact one from there
        closed = minimize(lambda x: float(_phasors(train, free, x[None])[0]) ** 4, start, method="BFGS", tol=1e-16).x
        for begin in (start, closed):
            polished = minimize(
                lambda x: float(irregularity_of(train, free, x[None])[0]),
                begin,
                method="Nelder-Mead",
                options={"xatol": 1e-11, "fatol": 1e-15, "maxiter": 400 * n, "initial_simplex": _simplex(begin)},
            )
            if polished.fun < least:
                best, least = polished.x, float(polished.fun)
        if least < 1e-14:
            break
    return best


def _simplex(centre: Array) -> Array:
    return np.vstack([centre, centre + 0.02 * np.eye(len(centre))])


def _spline_positions(pitches: list[float], near: Array) -> Array:
    """All spline positions in half a turn, or those around the continuous optimum where they are too many."""
    whole = [
        np.arange(0, HALF_TURN - 1e-9, p) if np.isfinite(p) else np.array([x])
        for p, x in zip(pitches, near, strict=True)
    ]
    count = int(np.prod([float(len(w)) for w in whole]))
    if count > MOST_COMBINATIONS:
        whole = [
            p * (np.round(x / p) + np.arange(-2, 3)) if np.isfinite(p) else np.array([x])
            for p, x in zip(pitches, near, strict=True)
        ]
    return np.array(list(product(*whole)))


def _pitches(
    train: Chain, free: tuple[int, ...], pitch: float | str | Mapping[str, float | str] | None
) -> list[float]:
    names = [train.steps[i].name for i in free]
    given = dict(pitch) if isinstance(pitch, Mapping) else {n: pitch for n in names if pitch is not None}
    pitches = dict.fromkeys(names, np.inf)
    for name, value in given.items():
        if name not in names:
            raise InputError(
                "is not a Shaft between two Hooke's joints", key="pitch", value=name, remedy=nearest(name, names)
            )
        try:
            pitches[name] = parse(value, ANGLE)
        except InputError as error:
            raise InputError(error.problem, key="pitch", value=value, remedy=error.remedy) from None
        if not pitches[name] > 0:
            raise InputError("must be positive", key="pitch", value=value, remedy='write "10 deg": 36 splines')
    return [pitches[n] for n in names]
