"""``run_up``: passage through resonance at constant acceleration, against the steady response.

A line that passes a resonance quickly never reaches its steady amplitude; one that passes slowly does, and one
that starts too briskly is twisted by its own inertia. ``safe_accelerations`` finds how fast and how slowly a line
may be run up for a torque that must not be exceeded.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.motion.order_map import times_at_angles
from trunnion.analyses.motion.simulate import LineSimulation, simulate
from trunnion.analyses.orbits.periodic_branch import periodic_branch
from trunnion.analyses.orbits.periodic_orbit import periodic_orbit
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_system import line_system
from trunnion.equations.loads import static_torque
from trunnion.equations.speed_profile import SpeedProfile
from trunnion.errors import InputError
from trunnion.numerics.curves import extremes_in
from trunnion.results.drawing import drawing
from trunnion.results.outcome import Outcome
from trunnion.results.speeds import show_speed

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

Array = NDArray[np.float64]
STEADY_SPEEDS = 81
MOST_TURNS = 20_000
"""Turns of one run, about a minute of computing."""


@dataclass(frozen=True)
class SteadyResponse:
    """Steady torque over speed: speed (points,) [rad/s]; largest (points, shaft), the largest |torque| [N m] of the
    periodic motion; verdict (points,) codes. In order along the branch, which may fold back."""

    speed: Array
    largest: Array
    verdict: NDArray[np.int8]


@dataclass(frozen=True)
class RunUp:
    """A passage at constant acceleration.

    speed (turns,) [rad/s] in the middle of each turn, or of the little more that leaves none over; upper and lower
    (turns, shaft): the largest and smallest torque [N m] within it, found on the dense output; steady: the steady
    response in the same range (None if not asked for).
    """

    simulation: LineSimulation
    acceleration: float
    speed: Array
    upper: Array
    lower: Array
    steady: SteadyResponse | None

    @property
    def outcome(self) -> Outcome:
        """How the run ended."""
        return self.simulation.outcome

    @property
    def shafts(self) -> tuple[str, ...]:
        """Names of the shafts."""
        return self.simulation.shafts

    @property
    def largest(self) -> Array:
        """Largest |torque| in each turn (turns, shaft) [N m]."""
        return np.maximum(np.abs(self.upper), np.abs(self.lower))

    @property
    def peak_torque(self) -> Array:
        """Largest |torque| of every shaft over the whole passage [N m]."""
        return np.asarray(self.largest.max(axis=0))

    @property
    def peak_speed(self) -> Array:
        """Input speed [rad/s] at which each shaft has it."""
        return self.speed[self.largest.argmax(axis=0)]

    @cached_property
    def steady_peak(self) -> Array:
        """Largest |torque| of every shaft among the steady motions found [N m]; NaN without them."""
        if self.steady is None or not np.isfinite(self.steady.largest).any():
            return np.full(len(self.shafts), np.nan)
        return np.asarray(np.nanmax(self.steady.largest, axis=0))

    @cached_property
    def inertia_torque(self) -> Array:
        """What accelerates the inertia behind each shaft (shaft,) [N m], were it rigid and its joints straight."""
        line = self.simulation.line
        topo = line.assembly.topology
        coefficients = line.assembly.coefficients(line.assembly.table(1, line.speed), statically_twisted=False)
        ratios = np.abs(np.array([float(q) for q in topo.speed_ratio]))
        return np.abs(static_torque(topo, coefficients.inertia * ratios * self.acceleration)[0])

    @property
    def data(self) -> xr.Dataset:
        """Labelled dataset with units."""
        import xarray as xr

        parts: dict[str, Any] = {
            "torque_upper": (("turn", "shaft"), self.upper, {"units": "N*m"}),
            "torque_lower": (("turn", "shaft"), self.lower, {"units": "N*m"}),
            "speed": ("turn", self.speed, {"units": "rad/s"}),
            "peak_torque": ("shaft", self.peak_torque, {"units": "N*m"}),
            "peak_speed": ("shaft", self.peak_speed, {"units": "rad/s"}),
            "inertia_torque": ("shaft", self.inertia_torque, {"units": "N*m"}),
        }
        coords: dict[str, Any] = {"shaft": list(self.shafts)}
        if self.steady is not None:
            parts["steady_torque"] = (("steady_speed", "shaft"), self.steady.largest, {"units": "N*m"})
            parts["steady_verdict"] = ("steady_speed", self.steady.verdict)
            coords["steady_speed"] = ("steady_speed", self.steady.speed, {"units": "rad/s"})
        attrs = {
            "acceleration": self.acceleration,
            "outcome": self.outcome.kind,
            "outcome_sentence": self.outcome.sentence,
        }
        return xr.Dataset(parts, coords=coords, attrs=attrs)

    def plot(self, axes: Axes | None = None, **options: Any) -> Axes:
        """Envelope against the steady response; see ``trunnion.plots.run_up``."""
        return drawing(self, "plot")(self, axes, **options)

    def describe(self, unit: str = "rad/s") -> str:
        """The result in a few lines, speeds in ``unit``."""
        low, high = self.simulation.profile.speed
        rows = []
        for i, name in enumerate(self.shafts):
            against = ""
            if np.isfinite(self.steady_peak[i]):
                share = self.peak_torque[i] / self.steady_peak[i]
                against = f"; {share:.3g} times the largest steady torque found, {self.steady_peak[i]:.5g} N m"
            rows.append(
                f"  {name}: at most {self.peak_torque[i]:.5g} N m, at {show_speed(self.peak_speed[i], unit)}{against}; "
                f"{self.inertia_torque[i]:.5g} N m accelerate what is behind it"
            )
        head = (
            f"run from {show_speed(low, unit)} to {show_speed(high, unit)} at "
            f"{show_speed(self.acceleration, unit)}/s: {len(self.speed)} turns in {self.simulation.end:.5g} s"
        )
        return "\n".join([head, *rows, f"  {self.outcome}"])

    def __str__(self) -> str:
        return self.describe()

    __repr__ = __str__


def run_up(
    line: Driveline | Assembly,
    first: float,
    last: float,
    *,
    acceleration: float,
    steady: int = STEADY_SPEEDS,
    tolerance: float = 1e-9,
) -> RunUp:
    """Run a line from speed ``first`` to ``last`` at constant acceleration.

    Parameters
    ----------
    first, last : input speeds [rad/s]; a lower ``last`` runs down.
    acceleration : its magnitude [rad/s²].
    steady : number of speeds, at least, at which the steady periodic motion is computed for comparison; 0 leaves
        it out.

    The run begins on the periodic motion at ``first`` where there is one, otherwise without twist.

    Raises
    ------
    InputError : speeds or acceleration not positive; a free line; more than 20 000 turns.
    """
    profile = _profile(first, last, acceleration)
    prepared = line_system(line, first)
    if prepared.assembly.topology.free:
        raise InputError(
            "starts free, so its speed cannot be prescribed", element="driveline",
            remedy="put a ConstantSpeed in front",
        )  # fmt: skip
    begun = prepared.rest()
    if prepared.system.forcing_period is not None:
        orbit = periodic_orbit(prepared.system, start=begun, settle=False)
        begun = orbit.start if orbit.outcome.ok else begun
    run = simulate(prepared.assembly, profile.time[-1], speed=profile, start=begun, tolerance=tolerance)
    # Windows of equal angle, a turn or a little more, so that none is left over.
    angle = float(profile.angle(run.end))
    windows = max(int(angle / (2 * np.pi)), 1)
    edges = np.append(times_at_angles(run, angle * np.arange(windows) / windows), run.end)
    seen = extremes_in(lambda times: run.motion_at(times).torque, run.cuts, edges)
    return RunUp(
        simulation=run,
        acceleration=float(acceleration),
        speed=profile.at(times_at_angles(run, angle * (np.arange(windows) + 0.5) / windows)),
        upper=seen.high,
        lower=seen.low,
        steady=_steady(prepared.assembly, first, last, steady) if steady else None,
    )


@dataclass(frozen=True)
class SafeAccelerations:
    """How fast and how slowly a line may pass a speed range.

    acceleration (points,) [rad/s²] and share (points,): largest torque over its limit; slowest and fastest [rad/s²]
    keep every limit (NaN where none does, 0 or inf where the range tried has no edge).
    """

    acceleration: Array
    share: Array
    slowest: float
    fastest: float
    sentence: str

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
    tolerance: float = 1e-7,
) -> SafeAccelerations:
    """Slowest and fastest acceleration whose passage keeps |torque| below ``limit``.

    Parameters
    ----------
    limit : [N m] for every shaft, or by the name of the shaft.
    accelerations : smallest and largest to try [rad/s²]; ``points`` of them evenly in the logarithm, and then
        the edges of the quietest safe range by bisection to 1 %.

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
        run = run_up(prepared.assembly, first, last, acceleration=rate, steady=0, tolerance=tolerance)
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


def _edge(share: Any, tried: Array, found: Array, best: int, direction: int) -> float:
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


def _profile(first: float, last: float, acceleration: float) -> SpeedProfile:
    for key, value in (("first", first), ("last", last), ("acceleration", acceleration)):
        if not (np.isfinite(value) and value > 0):
            raise InputError(
                "must be positive", element="run_up", key=key, value=float(value), remedy="tn.rpm(500), say"
            )
    if first == last:
        raise InputError("is also the last speed", element="run_up", key="first", value=float(first))
    duration = abs(last - first) / acceleration
    if (first + last) / 2 * duration > 2 * np.pi * MOST_TURNS:
        raise InputError(
            f"makes a run of more than {MOST_TURNS} turns",
            element="run_up", key="acceleration", value=float(acceleration),
            remedy="accelerate faster, or ask periodic_response for the steady motion",
        )  # fmt: skip
    return SpeedProfile([0.0, duration], [first, last])


def _steady(assembly: Assembly, first: float, last: float, points: int) -> SteadyResponse | None:
    """The branch of steady motions over the range, folds and all; what was found of it."""
    if line_system(assembly, first).system.forcing_period is None:
        return None
    branch = periodic_branch(
        assembly, "speed", min(first, last), max(first, last), longest_step=1 / points, tolerance=1e-10
    )
    return SteadyResponse(branch.parameter, branch.largest, branch.verdict)
