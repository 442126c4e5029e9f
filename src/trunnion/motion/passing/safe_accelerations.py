"""``safe_accelerations``: how fast and how slowly a line may be run up for a torque that must not be exceeded.

Safe is an acceleration at which the run reaches its last speed and keeps every limit. Whether a free–free line
passes a resonance need not be monotone in the acceleration, so that what is said holds for the accelerations that were
run, and names them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from trunnion.arrays import Array, Flags
from trunnion.driveline.arguments import one_number, one_speed
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_system import line_system
from trunnion.equations.prepared_line import in_series
from trunnion.equations.released import refuse_pendulums
from trunnion.errors import InputError
from trunnion.motion.passing.run_up import run_up
from trunnion.results.fields import attribute, computed, coordinate, internal, labelled, members, variable
from trunnion.results.result import Result
from trunnion.results.speeds import about_span, acceleration_span, show_acceleration

REACHED = "reached"
EDGE = 0.01
"""Distance of the last safe acceleration from the next one that is not, relative."""


@labelled
class TrialRunUp:
    """A run at one acceleration."""

    acceleration: float = variable("", "rad/s^2")
    kind: str = variable("", "", "of ending", name="outcome")
    speed: float = variable("", "rad/s", "at which it ended or hung", name="end_speed")
    share: float = variable("", "1", "largest torque over its limit")

    @property
    def safe(self) -> bool:
        """Whether it reached the last speed and kept every limit."""
        return self.kind == REACHED and self.share <= 1


@labelled
class SafeAccelerations(Result):
    """How fast and how slowly a line may pass a speed range."""

    trials: tuple[TrialRunUp, ...] = members(
        TrialRunUp, "acceleration", "every run that was made, by rising acceleration", only="share kind speed"
    )
    last: float = internal("speed to be reached", "rad/s")
    unit: str = internal("of speeds in print")

    @property
    @computed(coordinate("acceleration", "rad/s^2"))
    def acceleration(self) -> Array:
        """What was tried (trial,) [rad/s²]."""
        return np.array([one.acceleration for one in self.trials])

    @property
    def share(self) -> Array:
        """Largest torque over its limit (trial,)."""
        return np.array([one.share for one in self.trials])

    @property
    def outcome(self) -> tuple[str, ...]:
        """Kind of ending of every run (trial,): "reached", "captured" and so on, as of ``run_up``."""
        return tuple(one.kind for one in self.trials)

    @property
    def safe(self) -> Flags:
        """Whether every run reached the last speed and kept every limit (trial,)."""
        return np.array([one.safe for one in self.trials])

    @property
    def stretch(self) -> tuple[TrialRunUp, ...]:
        """The safe run with the least torque and its neighbours, up to one on each side that is not safe; or empty."""
        safe = [i for i, one in enumerate(self.trials) if one.safe]
        if not safe:
            return ()
        low = high = min(safe, key=lambda i: self.trials[i].share)
        while low > 0 and self.trials[low - 1].safe:
            low -= 1
        while high + 1 < len(self.trials) and self.trials[high + 1].safe:
            high += 1
        return self.trials[low : high + 1]

    @property
    @computed(variable("", "rad/s^2"))
    def slowest(self) -> float:
        """The slowest of the stretch [rad/s²]; NaN where nothing tried is safe."""
        return self.stretch[0].acceleration if self.stretch else np.nan

    @property
    @computed(variable("", "rad/s^2"))
    def fastest(self) -> float:
        """The fastest of the stretch [rad/s²]; NaN where nothing tried is safe."""
        return self.stretch[-1].acceleration if self.stretch else np.nan

    @property
    @computed(attribute(name="says"))
    def sentence(self) -> str:
        """What may be done."""
        return str(self)

    def __str__(self) -> str:
        unit, stretch, last = self.unit, self.stretch, self.words.rounded(self.last)
        if stretch:
            return "; ".join([self._safe(last, unit), *self._beside(unit), *self._ended(unit)])
        span = acceleration_span(self.trials[0].acceleration, self.trials[-1].acceleration, unit)
        words = [f"none of the {len(self.trials)} accelerations tried from {span} is safe"]
        reaching = [one for one in self.trials if one.kind == REACHED]
        if reaching:
            best = min(reaching, key=lambda one: one.share)
            at = show_acceleration(best.acceleration, unit)
            words.append(f"the best that reaches {last}, {at}, comes to {best.share:.3g} of the limit")
        return "; ".join([*words, *self._ended(unit)])

    def _safe(self, last: str, unit: str) -> str:
        """Where it is safe, and how far it stays below the limit."""
        stretch = self.stretch
        best, most = min(stretch, key=lambda one: one.share), max(one.share for one in stretch)
        span = acceleration_span(stretch[0].acceleration, stretch[-1].acceleration, unit)
        if len(stretch) == 1:
            return f"safe at {span}: it reaches {last} with {most:.3g} of the limit"
        return (
            f"safe at each of the {len(stretch)} accelerations tried from {span}: it reaches {last} with at most "
            f"{most:.3g} of the limit, {best.share:.3g} at {show_acceleration(best.acceleration, unit)}"
        )

    def _beside(self, unit: str) -> Iterator[str]:
        """What stands on both sides of the stretch, and what was not looked at."""
        stretch = self.stretch
        low, high = self.trials.index(stretch[0]), self.trials.index(stretch[-1])
        for place, side in ((low - 1, "slower"), (high + 1, "faster")):
            if not 0 <= place < len(self.trials):
                yield f"nothing {side} was tried"
                continue
            one = self.trials[place]
            what = f"comes to {one.share:.3g} of the limit" if one.kind == REACHED else f"is {one.kind}"
            yield f"at {show_acceleration(one.acceleration, unit)} it {what}"
        if len(stretch) > 1:
            apart = max(b.acceleration / a.acceleration for a, b in zip(stretch, stretch[1:], strict=False))
            far = f"{100 * (apart - 1):.2g} %" if apart < 2 else f"{apart:.2g} times"
            yield f"neighbours are up to {far} apart, and nothing between them was run"

    def _ended(self, unit: str) -> Iterator[str]:
        """How the runs ended that did not reach the last speed."""
        for kind in dict.fromkeys(one.kind for one in self.trials if one.kind != REACHED):
            runs = [one for one in self.trials if one.kind == kind]
            rates = acceleration_span(runs[0].acceleration, runs[-1].acceleration, unit)
            speeds = about_span(min(one.speed for one in runs), max(one.speed for one in runs), unit)
            yield f"{kind} at {'' if len(runs) == 1 else f'{len(runs)} from '}{rates}, turning at {speeds}"


def safe_accelerations(
    line: Driveline | Assembly,
    first: float | str,
    last: float | str,
    *,
    limit: float | Mapping[str, float],
    accelerations: tuple[float, float],
    points: int = 13,
    ramp: float | None = None,
    tolerance: float = 1e-7,
) -> SafeAccelerations:
    """Slowest and fastest acceleration whose passage reaches ``last`` and keeps |torque| below ``limit``.

    A free–free line may be captured by a resonance (``run_up``): such an acceleration is not safe, however small
    its torque.

    Parameters
    ----------
    line : a ``Driveline`` or its ``Assembly``.
    first, last : input speeds [rad/s], numbers or texts with a unit; a lower ``last`` runs down.
    limit : [N m] for every shaft, or by the name of the shaft.
    accelerations : smallest and largest to try [rad/s²].
    points : how many of them to try, evenly in the logarithm; then the edges of the safe stretch with the least torque
        are found by bisection to 1 %.
    ramp : time [s] over which the acceleration sets in, as in ``run_up``.
    tolerance : error allowed per step.

    Returns
    -------
    SafeAccelerations: ``slowest`` and ``fastest`` [rad/s²], None where none is safe, and every trial.

    Raises
    ------
    InputError : no positive limit, a shaft that is not there, a range that is not one, less than two points.

    Examples
    --------
    >>> import trunnion as tn
    >>> shaft = tn.Shaft(stiffness=1e3, damping=2.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=0.2), shaft, tn.Disk(inertia=0.4)])
    >>> found = tn.safe_accelerations(line, 15.0, 35.0, limit=80.0, accelerations=(5.0, 80.0), points=4)
    >>> round(found.slowest, 1), round(found.fastest, 1)
    (15.6, 80.0)
    """
    first, last = one_speed(first, "first"), one_speed(last, "last")
    refuse_pendulums(line.line if isinstance(line, Assembly) else line)
    prepared = line_system(in_series(line), first)
    limits = _limits(limit, line_system(prepared.assembly, first, slips=True).shafts)
    low, high = accelerations
    if not (0 < low < high and np.isfinite(high)):
        raise InputError("must be a rising pair", key="accelerations", value=list(accelerations))
    if isinstance(points, bool) or one_number(points, "points", "13, say") != int(points) or points < 2:
        raise InputError("must be a whole number from 2", key="points", value=points, remedy="13, say")

    def tried(rate: float) -> TrialRunUp:
        run = run_up(prepared.assembly, first, last, acceleration=rate, ramp=ramp, steady=0, tolerance=tolerance)
        speed = (
            last if run.ending is None else run.ending.hung_speed if run.outcome.kind != REACHED else run.ending.speed
        )
        return TrialRunUp(rate, run.outcome.kind, float(speed), float(np.max(run.peak_torque / limits)))

    found = SafeAccelerations(
        tuple(tried(float(a)) for a in np.geomspace(low, high, int(points))),
        float(last), speed_unit(prepared.assembly.line),
    )  # fmt: skip
    for side in (0, -1):
        while (rate := _nearer(found, side)) is not None:
            trials = sorted([*found.trials, tried(rate)], key=lambda one: one.acceleration)
            found = SafeAccelerations(tuple(trials), found.last, found.unit)
    return found


def _nearer(found: SafeAccelerations, side: int) -> float | None:
    """The acceleration between one end of the safe stretch (0: its slowest) and what is not safe beside it; None where
    these are near enough, or there is neither."""
    if not found.stretch:
        return None
    end = found.stretch[side]
    place = found.trials.index(end) + (1 if side else -1)
    if not 0 <= place < len(found.trials):
        return None
    other = found.trials[place].acceleration
    return float(np.sqrt(end.acceleration * other)) if abs(np.log(other / end.acceleration)) > EDGE else None


def _limits(limit: float | Mapping[str, float], shafts: tuple[str, ...]) -> Array:
    if not isinstance(limit, Mapping):
        limit = dict.fromkeys(shafts, limit)
    for name, value in limit.items():
        if name not in shafts:
            raise InputError("is not a shaft", key="limit", value=name, remedy=f"shafts are: {', '.join(shafts)}")
        if not (np.isfinite(value) and value > 0):
            raise InputError("must be a positive torque", element=name, key="limit", value=value)
    return np.array([limit.get(name, np.inf) for name in shafts])
