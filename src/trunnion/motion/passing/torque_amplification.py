"""``torque_amplification``: how far a transient goes beyond the nominal torque, and how often flanks part and land."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.refusals import nearest
from trunnion.equations.coefficients import assemble
from trunnion.equations.line_regimes import staged_springs
from trunnion.errors import InputError
from trunnion.motion.passing.run_up import RunUp
from trunnion.motion.simulation.simulation import LineSimulation
from trunnion.motion.transients.result import Transient
from trunnion.numerics.turning_points import turning_points
from trunnion.results.counts import counted
from trunnion.results.fields import computed, coordinate, internal, labelled, variable
from trunnion.results.result import Result

NOTHING = 1e-9
"""Share of its peak below which a shaft has no nominal torque: what losses and rounding leave."""


@labelled
class TorqueAmplification(Result):
    """Peak over nominal torque of every shaft and mesh in a motion, and its separations."""

    shafts: tuple[str, ...] = coordinate("shaft")
    peak: Array = variable("shaft", "N*m", "largest torque, of either sign")
    peak_time: Array = variable("shaft", "s", "when")
    nominal: Array = variable("shaft", "N*m", "torque that the factor refers to")
    separations: Integers = variable("shaft", "1", "times that it leaves contact and lands again; −1 without play")
    impact_torque: Array = variable("shaft", "N*m", "largest torque at a landing; NaN without one")
    duration: float = internal("of the motion", "s")
    unit: str = internal("that speeds are printed in")

    @property
    @computed(variable("shaft", "1", "torque amplification factor; NaN without a nominal torque"))
    def factor(self) -> Array:
        """|peak|/|nominal| (shaft,); NaN where there is no nominal torque."""
        known = np.abs(self.nominal) > NOTHING * np.abs(self.peak)
        return np.where(known, np.abs(self.peak) / np.where(known, np.abs(self.nominal), 1.0), np.nan)

    def table(self) -> list[dict[str, object]]:
        """One row a shaft."""
        return [
            {
                "shaft": name,
                "peak [N m]": float(self.peak[i]),
                "at [s]": float(self.peak_time[i]),
                "nominal [N m]": float(self.nominal[i]),
                "factor": float(self.factor[i]),
                "separations": int(self.separations[i]) if self.separations[i] >= 0 else None,
                "impact [N m]": float(self.impact_torque[i]),
            }
            for i, name in enumerate(self.shafts)
        ]

    def _lines(self) -> Iterator[str]:
        yield f"torque amplification of {counted(len(self.shafts), 'shaft')} over {self.duration:.4g} s"
        for i, name in enumerate(self.shafts):
            said = f"  {name}: {self.peak[i]:.5g} N m at {self.peak_time[i]:.4g} s"
            if np.isfinite(self.factor[i]):
                said += f", {self.factor[i]:.3g} times the nominal {self.nominal[i]:.5g} N m"
            else:
                said += ", no nominal torque"
            if self.separations[i] > 0:
                times = counted(int(self.separations[i]), "time")
                said += f"; leaves contact and lands {times}, at up to {abs(self.impact_torque[i]):.5g} N m"
            elif self.separations[i] == 0:
                said += "; stays in contact"
            yield said


def torque_amplification(
    run: LineSimulation | RunUp | Transient, nominal: Mapping[str, float] | None = None
) -> TorqueAmplification:
    """Torque amplification factor of every shaft and mesh, and what its play does.

    A mesh or a shaft with stages separates where it comes into its softest stage and lands where it leaves that again;
    the impact torque is the first extremum of its torque behind the landing.

    Parameters
    ----------
    run : what ``simulate``, ``run_up`` or ``transient`` gives for a line.
    nominal : torque [N m] by the name of the shaft that the factor refers to; of those not named, what the loads of the
        description ask for at the speed of the last turn.

    Raises
    ------
    InputError : no such shaft, a nominal torque that is not a number, a run without dense output.

    Examples
    --------
    >>> import trunnion as tn
    >>> shaft = tn.Shaft(stiffness=1e3, damping=2.0, name="shaft")
    >>> line = tn.Driveline([tn.ConstantSpeed(), shaft, tn.Disk(inertia=0.4, load_torque=100.0)])
    >>> print(round(float(tn.torque_amplification(tn.simulate(line, speed=20.0, turns=3)).factor[0]), 3))
    1.859
    """
    motion = run.simulation if isinstance(run, RunUp) else run
    if not isinstance(motion, LineSimulation | Transient):
        remedy = "give what simulate, run_up or transient returns for a driveline"
        raise InputError(f"is a {type(run).__name__}, not a motion of a line", key="run", remedy=remedy)
    shafts = motion.shafts
    given = _given(nominal or {}, shafts)
    asked = _of_loads(motion)
    extremes = motion.torque_extremes
    high = np.abs(extremes.high) >= np.abs(extremes.low)
    separations, impact = _landings(motion)
    return TorqueAmplification(
        shafts=shafts, peak=np.where(high, extremes.high, extremes.low),
        peak_time=np.where(high, extremes.high_at, extremes.low_at),
        nominal=np.array([given.get(name, asked[i]) for i, name in enumerate(shafts)]), separations=separations,
        impact_torque=impact, duration=motion.end - float(motion.cuts[0]), unit=speed_unit(motion.line.assembly.line),
    )  # fmt: skip


def _given(nominal: Mapping[str, float], shafts: tuple[str, ...]) -> Mapping[str, float]:
    for name, value in nominal.items():
        if name not in shafts:
            raise InputError("is not a shaft of this motion", key="nominal", value=name, remedy=nearest(name, shafts))
        if not np.isfinite(value):
            raise InputError("must be finite", key=f"nominal {name}", value=value, remedy="give N m")
    return nominal


def _of_loads(motion: LineSimulation | Transient) -> Array:
    """Static torque (shaft,) [N m] at the speed of the last turn, or of the end where it made none; of a transient by
    the loads of its description, machines by their curves, and none where it stands still at the end."""
    speed = motion.whole.last_turn()[1]
    if isinstance(motion, Transient):
        if not (np.isfinite(speed) and speed > 0):
            return np.full(len(motion.shafts), np.nan)
        assembly = assemble(motion.description)
    else:
        assembly = motion.line.assembly
        speed = speed if np.isfinite(speed) and speed else float(motion.profile.at(motion.end))
    return np.asarray(assembly.coefficients(assembly.table(1, speed), free_play=True).torque[0])


def _landings(motion: LineSimulation | Transient) -> tuple[Integers, Array]:
    """Landings (shaft,) of every spring with play, −1 of the others, and the largest torque at one [N m]."""
    line = motion.line
    runs = [one.trajectory for one in motion.pieces] if isinstance(motion, Transient) else [motion.trajectory]
    start, regime = (np.concatenate([getattr(one, key) for one in runs]) for key in ("start", "regime"))
    count, impact = np.full(len(motion.shafts), -1, dtype=np.int64), np.full(len(motion.shafts), np.nan)
    row = line.assembly.table(1, line.speed if isinstance(motion, Transient) else motion.profile.speed[0])[0]
    springs = {e: spring for e, spring in staged_springs(line.assembly, row).items() if spring.stages > 1}
    if not springs:
        return count, impact
    points = turning_points(motion.torque_at, motion.cuts)
    for e, spring in springs.items():
        side = spring.side[regime // spring.stride % spring.stages]
        landed = start[1:][(side[1:] != 0) & (side[:-1] == 0)]
        count[e] = len(landed)
        if len(landed):
            behind = np.searchsorted(points[e].time, landed).clip(0, len(points[e].time) - 1)
            tops = points[e].value[behind]
            impact[e] = tops[np.abs(tops).argmax()]
    return count, impact
