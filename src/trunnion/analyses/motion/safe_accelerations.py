"""``safe_accelerations``: how fast and how slowly a line may be run up for a torque that must not be exceeded."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from trunnion.analyses.motion.run_up import run_up
from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_system import line_system
from trunnion.errors import InputError
from trunnion.results.declared import Held, Result, axis, fields_over, over


@dataclass(frozen=True, repr=False)
class SafeAccelerations(Result):
    """How fast and how slowly a line may pass a speed range.

    acceleration (points,) [rad/s²] and share (points,): largest torque over its limit; slowest and fastest [rad/s²]
    keep every limit (NaN where none does, 0 or inf where the range tried has no edge).
    """

    acceleration: Array
    share: Array
    slowest: float
    fastest: float
    sentence: str

    def declared(self) -> Iterator[Held]:
        """The share of the limit that each acceleration tried reaches, and the edges of what keeps it."""
        yield axis("acceleration", self.acceleration, "rad/s^2")
        yield over("acceleration", "share", self.share, "1")
        yield from fields_over("", self, slowest="rad/s^2", fastest="rad/s^2")

    def __str__(self) -> str:
        return self.sentence


def safe_accelerations(
    line: Driveline | Assembly,
    first: float,
    last: float,
    *,
    limit: float | Mapping[str, float],
    accelerations: tuple[float, float],
    points: int = 13,
    ramp: float | None = None,
    tolerance: float = 1e-7,
) -> SafeAccelerations:
    """Slowest and fastest acceleration whose passage keeps |torque| below ``limit``.

    Parameters
    ----------
    limit : [N m] for every shaft, or by the name of the shaft.
    accelerations : smallest and largest to try [rad/s²]; ``points`` of them evenly in the logarithm, and then
        the edges of the quietest safe range by bisection to 1 %.
    ramp : as in ``run_up``.

    Raises
    ------
    InputError : no positive limit, a shaft that is not there, a range that is not one.
    """
    prepared = line_system(line, first)
    limits = _limits(limit, prepared.shafts)
    low, high = accelerations
    if not (0 < low < high and np.isfinite(high)):
        raise InputError("must be a rising pair", key="accelerations", value=list(accelerations))

    def share(rate: float) -> float:
        run = run_up(prepared.assembly, first, last, acceleration=rate, ramp=ramp, steady=0, tolerance=tolerance)
        return float(np.max(run.peak_torque / limits)) if run.outcome.ok else np.inf

    tried = np.geomspace(low, high, points)
    found = np.array([share(a) for a in tried])
    best = int(np.argmin(found))
    if found[best] > 1:
        words = (
            f"no acceleration between {low:.4g} and {high:.4g} rad/s² keeps the limit; the quietest, "
            f"{tried[best]:.4g} rad/s², reaches {found[best]:.3g} of it"
        )
        return SafeAccelerations(tried, found, np.nan, np.nan, words)
    slowest = _edge(share, tried, found, best, -1)
    fastest = _edge(share, tried, found, best, +1)
    slow = f"down to {slowest:.4g} rad/s²" if slowest > 0 else f"down to the {low:.4g} rad/s² tried"
    fast = f"up to {fastest:.4g} rad/s²" if np.isfinite(fastest) else f"up to the {high:.4g} rad/s² tried"
    quiet = f"the quietest tried is {tried[best]:.4g} rad/s² ({found[best]:.3g} of it)"
    words = f"the limit is kept {slow} and {fast}; {quiet}"
    return SafeAccelerations(tried, found, slowest, fastest, words)


def _edge(share: Callable[[float], float], tried: Array, found: Array, best: int, direction: int) -> float:
    """Where the share passes 1 on one side of the quietest acceleration."""
    place = best
    while 0 <= place + direction < len(tried) and found[place + direction] <= 1:
        place += direction
    if not 0 <= place + direction < len(tried):
        return 0.0 if direction < 0 else np.inf
    safe, unsafe = float(tried[place]), float(tried[place + direction])
    while abs(np.log(unsafe / safe)) > 0.01:
        middle = float(np.sqrt(safe * unsafe))
        safe, unsafe = (middle, unsafe) if share(middle) <= 1 else (safe, middle)
    return safe


def _limits(limit: float | Mapping[str, float], shafts: tuple[str, ...]) -> Array:
    if not isinstance(limit, Mapping):
        limit = dict.fromkeys(shafts, limit)
    for name, value in limit.items():
        if name not in shafts:
            raise InputError("is not a shaft", key="limit", value=name, remedy=f"shafts are: {', '.join(shafts)}")
        if not (np.isfinite(value) and value > 0):
            raise InputError("must be a positive torque", element=name, key="limit", value=value)
    return np.array([limit.get(name, np.inf) for name in shafts])
