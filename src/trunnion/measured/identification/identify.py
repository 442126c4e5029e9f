"""Numbers of a line from measured orders: which angles, stiffness, damping, inertia or excitation explain them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import chi2

from trunnion.arrays import Array, Places
from trunnion.design.limits.result import StableLimit
from trunnion.design.limits.stable_limit import stable_limit
from trunnion.design.optimisation.space import Space
from trunnion.driveline.arguments import speeds_of, whole_number
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.parameters import pack
from trunnion.driveline.quantities import KINDS, eye_unit, parse
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.steady_base import has_periodic_base
from trunnion.errors import InputError
from trunnion.features import left_out
from trunnion.floquet.tolerance.parameter_intervals import ParameterInterval, table_at
from trunnion.measured.identification.fitting import FitPoint, descend, search, shares_of, twins_of, values_at
from trunnion.measured.identification.knowable import knowable
from trunnion.measured.identification.misfit import MOST_NODES, Misfit, misfit_of
from trunnion.measured.identification.profile import (
    BetterFit,
    ProfileInterval,
    covariance_of,
    profile_interval,
)
from trunnion.measured.identification.result import Identification, TongueDistance
from trunnion.measured.identification.sampling import LikelihoodDraws, gaussian_of, likelihood_draws
from trunnion.measured.overlay import compare_measured
from trunnion.measured.predicted import period, turned
from trunnion.measured.tracking.result import MeasuredOrders
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.results.units import figures

MOST_WINDOWS = 120
"""Windows that are fitted; of more, as many spread evenly."""
FEWER_WINDOWS = 16
"""The same of a free–free line with joint angles, whose own motion is found for each."""
PASSES, NEARBY, LAG_SETTLED = 8, 1e3, 0.02
"""Rounds in which the lag in the run is found anew at the best, how much worse (χ², times its scale squared) others may
fit without it to be followed, and standard deviations by which the lag may change in the last round."""
ANEW = 6
"""Times that a better fit found on the way may begin anew."""
UNLIKELY = 1e-3
"""Probability below which noise does not explain the misfit."""
FEW_DRAWS = 100.0
"""Independent draws below which the ends of 95 % are rough."""
ANGLES = "factor of *.angle"
HIGHEST_FACTOR = 4.0
DISTANCE_STEP = 0.5
"""Standard deviations by which a parameter is moved for the interval of the distance."""


def identify(
    line: Driveline | Assembly,
    data: MeasuredOrders,
    free: Mapping[str, Sequence[object]],
    *,
    begin: float | None = None,
    held_out: MeasuredOrders | None = None,
    tongue_at: Sequence[float | str] = (),
    draws: int = 0,
    seed: int = 0,
    progress: Callable[[float], None] | None = None,
) -> Identification:
    """Numbers of a line that explain measured orders, with intervals by profile likelihood.

    Parameters
    ----------
    line : the driveline, as it is thought to be.
    data : of ``track_orders``; its channels name places of the line.
    free : what may differ: parameters by path, each with a low and a high bound (SI units or texts with a unit).
    begin : rotation of the input [rad] at the first pulse of the reference; None where nothing says it: it is free.
    held_out : another run, not fitted, on which the line found is tried.
    tongue_at : input speeds [rad/s] at which the distance from the nearest region of instability is told; none by
        default.
    draws : where a profile is not a parabola, or other values fit as well, so many steps of an ensemble that draws from
        the likelihood, 400 say; 0 for none: then those parameters are named.
    seed : of the look around within the bounds, and of the draws.
    progress : called as progress(share done).

    Raises
    ------
    InputError : a parameter or bound that cannot be; places that the line does not have.

    Examples
    --------
    >>> import trunnion as tn
    >>> joint, hub = tn.HookeJoint(angle="12 deg", name="joint"), tn.Disk(inertia=0.5, name="hub")
    >>> line = tn.Driveline([tn.ConstantSpeed(), joint, tn.Shaft(stiffness=2e4, damping=25, name="tube"), hub])
    >>> run = tn.measure(line, (60.0, 200.0), 8.0, {"input": 30, "hub": 30}, jitter=1e-6)
    >>> data = tn.track_orders(run, [2, 4], line=line)
    >>> wrong = line.replace("tube", stiffness=1.6e4)
    >>> found = tn.identify(wrong, data, {"tube.stiffness": (1e4, 4e4), "joint.angle": ("3 deg", "25 deg")})
    >>> bool(found.low[0] < 2e4 < found.high[0]), round(float(np.rad2deg(found.value[1])))
    (True, 12)
    """
    assembly = assemble(line)
    whole_number(seed, "seed", 0)
    whole_number(draws, "draws", 0)
    advance = progress or (lambda share: None)
    space = Space(assembly, free)
    most = FEWER_WINDOWS if has_periodic_base(assembly) else MOST_WINDOWS
    misfit = misfit_of(assembly, data, space.free, begin, _windows(data, most))
    freedom = misfit.count - len(space.free) - (begin is None)
    if freedom < 1:
        raise InputError(
            f"has {misfit.count} numbers for {len(space.free)} parameters", key="data", remedy="track more orders"
        )
    before = knowable(misfit, around=False)
    advance(0.1)
    start = shares_of(misfit, np.array([one.nominal for one in space.free]))
    misfit, minima = _resolved(misfit, search(misfit, start, seed))
    misfit, minima, settled = _passing(misfit, minima, freedom)
    advance(0.4)
    misfit, minima, intervals, scale = _profiled(misfit, minima, freedom, lambda share: advance(0.4 + 0.4 * share))
    best = minima[0]
    twins = twins_of(misfit, minima, np.array([not (one.low_open and one.high_open) for one in intervals]))
    values = values_at(misfit, best.share)
    residual, slope = misfit.linear(values, best.angle)
    covariance = covariance_of(slope)[: len(values), : len(values)] * scale
    width = np.array([one.high - one.low for one in space.free])
    spread = np.sqrt(np.diag(covariance))
    known = zip(values, np.minimum(spread, 1.0) * width, space.free, strict=True)
    stated = np.array([_rounded(float(value), float(own), one) for value, own, one in known])
    found = assembly.packed.line_at(table_at(assembly, space.free, stated[None])[0])
    advance(0.85)
    distance = _distance(found, misfit, values, covariance, tongue_at) if len(tongue_at) else None
    tried = None if held_out is None else _held_out(assembly, held_out, misfit, best)
    predicted = turned(misfit.predicted(values[None])[0], data.order, best.angle)
    advance(0.9)
    gaussian = gaussian_of(misfit, values, intervals, spread * width)
    sampled, drawn = LikelihoodDraws(np.zeros((0, 0)), 0.0, 0.0), np.full((1, len(values)), np.nan)
    if draws and (twins or not gaussian.all()):
        every = [best, *twins]
        about = misfit.passing([values_at(misfit, one.share) for one in every]) if misfit.passed else None
        sampled, drawn = likelihood_draws(about or misfit, every, spread, scale, draws, seed)
    ends = np.quantile(drawn, (0.025, 0.975), axis=0)
    advance(1.0)
    made = Identification(
        parameters=tuple(one.label for one in space.free),
        units=tuple(one.unit for one in space.free),
        before=np.array([one.nominal for one in space.free]),
        value=values,
        low=np.array([one.low for one in intervals]),
        high=np.array([one.high for one in intervals]),
        low_open=np.array([one.low_open for one in intervals]),
        high_open=np.array([one.high_open for one in intervals]),
        deviation=spread * width,
        gaussian=gaussian,
        drawn_low=ends[0],
        drawn_high=ends[1],
        correlation=covariance / np.outer(spread, spread),
        chi_square=best.chi_square,
        freedom=freedom,
        scale=scale,
        probability=float(chi2.sf(best.chi_square, freedom)),
        held_out=tried,
        begin=float(best.angle % period(data.order)),
        residual=_by_channel(misfit, residual),
        channels=tuple(data.channels[c] for c in misfit.channels.columns),
        order=data.order,
        independent=sampled.effective,
        draws=drawn,
        twins=tuple(
            dict(zip([one.label for one in space.free], values_at(misfit, twin.share).tolist(), strict=True))
            for twin in twins
        ),
        line=found,
        original=assembly.line,
        knowable=before,
        distance=distance,
        measured=data,
        predicted=predicted,
        windows=misfit.rows,
        findings=(),
        unit=speed_unit(assembly.line),
    )
    return replace(made, findings=by_gravity(_findings(made, misfit, settled)))


def _resolved(misfit: Misfit, minima: list[FitPoint]) -> tuple[Misfit, list[FitPoint]]:
    """The misfit at as many speeds a window as the best needs, and its minima by these.

    Raises
    ------
    InputError : windows are too long for that.
    """
    free = np.zeros(len(misfit.free), dtype=bool)
    while (finer := misfit.finer(values_at(misfit, minima[0].share))) is not None:
        if finer.nodes > MOST_NODES:
            raise InputError(
                "is too long for resonances as sharp as this line's", key="window", value=misfit.data.window,
                remedy=f"track the orders in windows of {max(1, misfit.data.window // 4)} turns",
            )  # fmt: skip
        misfit = finer
        minima = sorted((descend(misfit, one.share, one.angle, free) for one in minima), key=lambda one: one.chi_square)
    return misfit, minima


def _scale(best: FitPoint, freedom: int) -> float:
    """By which χ² counts where noise does not explain the misfit."""
    return max(1.0, best.chi_square / freedom) if chi2.sf(best.chi_square, freedom) < UNLIKELY else 1.0


def _passing(misfit: Misfit, minima: list[FitPoint], freedom: int) -> tuple[Misfit, list[FitPoint], bool]:
    """The misfit with the lag that the line has in a run, its minima, and whether the lag at the best has settled.

    Where the lag is not known, or the speed stays, the steady response is compared, as it was.
    """
    free = np.zeros(len(misfit.free), dtype=bool)
    scale = _scale(minima[0], freedom)
    near = [one for one in minima if one.chi_square < minima[0].chi_square + NEARBY * scale**2]
    for _ in range(PASSES):
        # The best comes first: what is not known of its lag counts as noise.
        found = misfit.passing([values_at(misfit, one.share) for one in near])
        if found is None:
            return replace(misfit, passed=()), minima, not misfit.passed
        apart = found.apart(misfit, values_at(misfit, near[0].share))
        misfit = found
        near = sorted((descend(misfit, one.share, one.angle, free) for one in near), key=lambda one: one.chi_square)
        misfit, near = _resolved(misfit, near)
        if apart < LAG_SETTLED * np.sqrt(_scale(near[0], freedom)):
            return misfit, near, True
    return misfit, near, False


def _windows(data: MeasuredOrders, most: int) -> Places:
    count = len(data.speed)
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(np.intp))


def _profiled(
    misfit: Misfit, minima: list[FitPoint], freedom: int, advance: Callable[[float], None]
) -> tuple[Misfit, list[FitPoint], list[ProfileInterval], float]:
    """The misfit, its minima, intervals of all parameters, and the scale of χ²; begun anew where a profile finds a
    better fit, with the lag that the line has there."""
    for _ in range(ANEW):
        best = minima[0]
        scale = _scale(best, freedom)
        slope = misfit.linear(values_at(misfit, best.share), best.angle)[1]
        found = []
        try:
            for k in range(len(misfit.free)):
                found.append(profile_interval(misfit, best, slope, k, scale))
                advance((k + 1) / len(misfit.free))
        except BetterFit as better:
            minima = [better.point, *minima]
            if misfit.passed:
                misfit, minima, _ = _passing(misfit, minima, freedom)
            continue
        return misfit, minima, found, scale
    raise InputError(
        "have a likelihood with too many minima", key="free", remedy="narrow their bounds, or let fewer be free"
    )


def _rounded(value: float, deviation: float, one: ParameterInterval) -> float:
    """A value without digits that nobody knows: to a hundredth of its standard deviation, in the unit that a file
    states it in; as it is where that would leave its bounds."""
    kind = next((kind for kind in KINDS if kind.unit == one.unit), None)
    if kind is None or not (np.isfinite(deviation) and deviation > 0):
        return value
    symbol, size = eye_unit(value, kind)
    digits = round(value / size, int(2 - np.floor(np.log10(deviation / size))))
    rounded = digits if size == 1.0 else parse(f"{digits:.15g} {symbol}", kind)
    return rounded if one.low <= rounded <= one.high else value


def _by_channel(misfit: Misfit, residual: Array) -> Array:
    """Rms (channel, order) of the residuals of amplitudes; NaN where nothing is known."""
    shape = misfit.deviation.shape
    count = int(np.prod(shape))
    both = residual[:count] ** 2 + residual[count : 2 * count] ** 2
    known = np.isfinite(misfit.deviation).sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.sqrt(both.reshape(shape).sum(axis=0) / (2 * known)).T)


def _held_out(assembly: Assembly, data: MeasuredOrders, fitted: Misfit, best: FitPoint) -> float:
    """χ² over its number of a run that was not fitted, which begins at an angle of its own."""
    other = misfit_of(assembly, data, fitted.free, fitted.begin, _windows(data, max(len(fitted.rows), 1)))
    values = values_at(fitted, best.share)
    other = other.passing([values]) or other
    predicted = other.predicted(values[None])[0]
    return other.chi_square(predicted) / max(other.count - (fitted.begin is None), 1)


def _distance(
    line: Driveline, misfit: Misfit, values: Array, covariance: Array, speeds: Sequence[float | str]
) -> TongueDistance | None:
    """The factor of all joint angles at which instability begins, its interval to first order in the parameters."""
    at = speeds_of(list(speeds), key="tongue_at")
    packed = pack(line)
    angles = [value for label, value in zip(packed.labels, packed.values, strict=True) if label.endswith(".angle")]
    if not any(angles):
        return None

    def limit(of: Driveline) -> tuple[float, StableLimit]:
        found = stable_limit(of, ANGLES, at, low=1.0, high=HIGHEST_FACTOR, between=False)
        return float(np.nanmin(np.where(np.isnan(found.limit), np.inf, found.limit))), found

    nominal, found = limit(line)
    if not np.isfinite(nominal) or nominal >= HIGHEST_FACTOR:
        return TongueDistance("joint angles", np.inf, np.inf, np.inf, found)
    width = np.array([one.high - one.low for one in misfit.free])
    slopes = np.zeros(len(values))
    for k, one in enumerate(misfit.free):
        step = DISTANCE_STEP * float(np.sqrt(covariance[k, k])) * width[k]
        ends = []
        for sign in (-1.0, 1.0):
            point = values.copy()
            point[k] = np.clip(values[k] + sign * step, one.low, one.high)
            there = misfit.channels.assembly.packed.line_at(
                table_at(misfit.channels.assembly, misfit.free, point[None])[0]
            )
            ends.append((point[k], min(limit(there)[0], HIGHEST_FACTOR)))
        (a, first), (b, second) = ends
        slopes[k] = (second - first) / (b - a) * width[k] if b > a else 0.0
    half = 1.96 * float(np.sqrt(slopes @ covariance @ slopes))
    return TongueDistance("joint angles", nominal, max(nominal - half, 1.0), nominal + half, found)


def _findings(found: Identification, misfit: Misfit, settled: bool) -> Iterator[Finding]:
    yield from found.knowable.findings
    if not settled:
        yield Finding(
            Gravity.CAUTION,
            "How the line lags in this run did not settle with its numbers: run up more slowly, or narrow the bounds.",
        )
    if found.probability < UNLIKELY:
        worst = np.unravel_index(int(np.nanargmax(found.residual)), found.residual.shape)
        yield Finding(
            Gravity.CAUTION,
            f"The line does not explain the data to their noise: residuals are {figures(found.scale**0.5, 3)} times "
            f"what noise leaves, most of order {found.order[worst[1]]:g} of {found.channels[worst[0]]}; intervals are "
            "widened by that, and hold only if what is missing scatters as noise does.",
        )
    for k, name in enumerate(found.parameters):
        if found.unknown[k]:
            yield Finding(Gravity.CAUTION, f"{name} is not known: every value within its bounds fits as well.")
        elif found.low_open[k] or found.high_open[k]:
            side = "low" if found.low_open[k] else "high"
            yield Finding(Gravity.NOTE, f"The interval of {name} is open at its {side} bound; widen it to see its end.")
    bent = [name for k, name in enumerate(found.parameters) if not (found.gaussian[k] or found.unknown[k])]
    if bent and not found.independent:
        yield Finding(
            Gravity.NOTE,
            f"The likelihood of {', '.join(bent)} is not Gaussian within its interval: standard deviations and "
            "correlations do not describe it; draws = 400 draws from it.",
        )
    if 0 < found.independent < FEW_DRAWS:
        yield Finding(
            Gravity.CAUTION,
            f"The draws are worth {figures(found.independent, 2)} independent ones: ends of 95 % are rough; ask for "
            "more draws.",
        )
    if found.twins:
        yield Finding(
            Gravity.CAUTION,
            f"{len(found.twins)} other set{'s' if len(found.twins) > 1 else ''} of values fit as well as the best, by "
            "sign, symmetry or chance: the data do not tell them apart.",
        )
    yield from (one for one in found.measured.findings if one.gravity <= Gravity.CAUTION)
    yield from compare_measured(found.line, found.measured).doubts
    yield from left_out("identify", found.line)
