"""Where the temperature of elastic couplings settles: heat makes rubber softer and damp less, which changes the heat.

At a temperature T the vibration of the line leaves the heat P(T) in a coupling, which settles where
T = T_ambient + R P(T), R its thermal resistance. There may be one such temperature, several, or none: then it heats on
beyond what its table knows. Of one coupling the whole table is searched; several are followed together from cold and
from hot.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Flags, Integers
from trunnion.driveline.arguments import speeds_of
from trunnion.driveline.couplings import HOTTEST, Coupling
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import settled_speeds, speed_unit
from trunnion.driveline.operation import Operation
from trunnion.driveline.quantities import TEMPERATURE, shown
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.steady_base import refuse_periodic_base
from trunnion.errors import InputError
from trunnion.features import left_out
from trunnion.response.orders.response import response_of_table
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, coordinate, internal, labelled, variable
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.results.result import Result
from trunnion.waiting import keep_time

NODES = 65
"""Temperatures at which one coupling is looked at between cold and the end of its table."""
CLOSER = 16
"""The same between two of them where a pair of settled temperatures may hide."""
EXACT = 1e-8
"""Temperature [K] to which it is found."""
MOST_STEPS = 300
ROWS = 4096
"""Cases that are solved together."""


@labelled
class CouplingTemperatures(Result):
    """Temperature, heat and what else could be, of every coupling that states a thermal resistance."""

    speed: Array = coordinate("speed", "rad/s")
    couplings: tuple[str, ...] = coordinate("coupling")
    temperature: Array = variable(
        "speed coupling", "K", "at which it settles from cold; NaN where it does not within its table"
    )
    heat: Array = variable("speed coupling", "W", "of its damping there")
    settled: Integers = variable("speed", "1", "temperatures found at which all stay")
    hottest: Array = variable("speed coupling", "K", "highest of them; NaN without any")
    runaway: Array = variable("speed", "K", "of one coupling: above it, it heats on; NaN where it does not")
    searched: str = attribute("how it was searched")
    ends: Array = internal("highest temperature that each table knows", "K", "coupling")
    ratings: Array = internal("highest temperature that each may have; NaN for none", "K", "coupling")
    line: Driveline = internal("that was asked about")
    remarks: tuple[Finding, ...] = internal("what was left out")
    unit: str = internal("of speeds in print")

    def line_at(self, speed: float) -> Driveline:
        """The line with every coupling at its temperature at the speed of the result nearest to ``speed`` [rad/s].

        Raises
        ------
        InputError : it settles nowhere there.
        """
        at = int(np.abs(self.speed - speed).argmin())
        found = self.temperature[at]
        if np.isnan(found).any():
            name = self.couplings[int(np.isnan(found).argmax())]
            remedy = "ask at another speed, or lower what excites it"
            raise InputError(
                f"settles at no temperature at {self.words.speed(self.speed[at])}", element=name, remedy=remedy
            )
        return self.line.replace_all(
            {name: {"temperature": float(one)} for name, one in zip(self.couplings, found, strict=True)}
        )

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What to read first."""
        return by_gravity([*_findings(self), *self.remarks])

    def plot(self, axes: Axes | None = None, *, unit: str = "", operating: Operation | None = None) -> Axes:
        """Temperatures over speed; see ``pictures.coupling_temperatures``."""
        return drawing(self, "plot")(self, axes, unit=unit, operating=operating)

    def table(self) -> list[dict[str, object]]:
        """One row a coupling: its highest temperature, and the heat there."""
        rows: list[dict[str, object]] = []
        for c, name in enumerate(self.couplings):
            known = self.temperature[:, c]
            at = int(np.nan_to_num(known, nan=-1.0).argmax())
            lost = bool(np.isnan(known).any())
            rows.append(
                {
                    "coupling": name,
                    "highest temperature": "none settled"
                    if np.isnan(known).all()
                    else shown(known[at], TEMPERATURE, digits=4),
                    f"at [{self.words.unit}]": float(self.speed[at]) * self.words.factor,
                    "heat [W]": float(self.heat[at, c]),
                    "heats on": "at some speeds" if lost else "nowhere",
                }
            )
        return rows

    @property
    def headline(self) -> str:
        """What was computed."""
        return f"settled temperatures of {', '.join(self.couplings)} at {len(self.speed)} speeds"

    def _lines(self) -> Iterator[str]:
        yield self.headline
        for row in self.table():
            head = next(key for key in row if key.startswith("at ["))
            yield (
                f"  {row['coupling']}: up to {row['highest temperature']} at {row[head]:.5g} {self.words.unit}, "
                f"{row['heat [W]']:.4g} W; heats on {row['heats on']}"
            )


def coupling_temperatures(
    line: Driveline | Assembly, speeds: ArrayLike, load_case: str | None = None
) -> CouplingTemperatures:
    """Where the couplings that state a ``thermal_resistance`` settle, by the heat of the linear steady response.

    Parameters
    ----------
    line : with one such coupling or more.
    speeds : (speed,) input speeds [rad/s].
    load_case : name of one of the line's load cases.

    Raises
    ------
    InputError : no such coupling; surroundings colder than its table; as of ``order_response``.

    Examples
    --------
    >>> import trunnion as tn
    >>> engine = tn.Disk(inertia=2.0, drive_share=1, excitation=[{"order": 2, "amplitude": 100.0}])
    >>> rubber = tn.Coupling(
    ...     stiffness=2e4, relative_damping=1.0, temperature="40 degC", temperatures=["20 degC", "100 degC"],
    ...     stiffness_factors=[1.1, 0.7], thermal_resistance=0.3, ambient_temperature="30 degC", name="rubber",
    ... )
    >>> found = tn.coupling_temperatures(tn.Driveline([engine, rubber, tn.Disk(inertia=3.0)]), [40.0, 60.0])
    >>> found.settled.tolist(), [round(one - 273.15, 1) for one in found.temperature[:, 0].tolist()]
    ([1, 1], [30.8, 42.9])
    """
    assembly = assemble(line, load_case)
    couplings = _asked(assembly)
    refuse_periodic_base(assembly, "put a ConstantSpeed in front, or take the joints straight")
    speed = settled_speeds(assembly.line, speeds_of(speeds, "np.linspace(tn.rpm(300), tn.rpm(3000), 61)"))
    problem = _ThermalBalance(assembly, couplings)
    found = problem.alone(speed) if len(couplings) == 1 else [problem.together(one) for one in speed]
    temperature = np.array([one.cold for one in found])
    named = tuple(assembly.line.names[place] for place in couplings)
    return CouplingTemperatures(
        speed=speed, couplings=named, temperature=temperature, heat=problem.heat(speed, temperature),
        settled=np.array([one.count for one in found]), hottest=np.array([one.hottest for one in found]),
        runaway=np.array([one.runaway for one in found]), searched=problem.searched,
        ends=problem.high, ratings=problem.ratings, line=assembly.line,
        remarks=left_out("coupling_temperatures", assembly.line), unit=speed_unit(assembly.line),
    )  # fmt: skip


def _asked(assembly: Assembly) -> list[int]:
    """Places of the couplings whose temperature follows from their heat."""
    elements = list(enumerate(assembly.line.elements))
    found = [i for i, one in elements if isinstance(one, Coupling) and one.thermal_resistance is not None]
    if not found:
        named = [assembly.line.names[i] for i, one in elements if isinstance(one, Coupling)]
        where = named[0] if named else "a Coupling"
        raise InputError(
            "has no coupling whose temperature follows from its heat", element="driveline", key="thermal_resistance",
            remedy=f"write thermal_resistance, ambient_temperature and temperature in {where}",
        )  # fmt: skip
    return found


@dataclass(frozen=True)
class _SettledAt:
    """At one speed: temperatures of all couplings from cold, the highest found, their number, and of one coupling the
    one above which it heats on."""

    cold: Array
    hottest: Array
    count: int
    runaway: float = float("nan")


def _of_roots(roots: Array, falling: Flags) -> _SettledAt:
    """Of one coupling from its rising ``roots`` [K], at which the excess is ``falling`` (it stays) or not."""
    stays = roots[falling]
    lost = float(roots[-1]) if len(roots) and not falling[-1] else float("nan")
    nothing = np.array([np.nan])
    return _SettledAt(stays[:1], stays[-1:], len(stays), lost) if len(stays) else _SettledAt(nothing, nothing, 0, lost)


class _ThermalBalance:
    """The heat of couplings by their temperatures."""

    def __init__(self, assembly: Assembly, places: list[int]) -> None:
        self.assembly, self.places = assembly, places
        packed, topo = assembly.packed, assembly.topology
        self.columns = [packed.column(i, "temperature") for i in places]
        self.springs = [next(e for e, c in enumerate(topo.compliances) if i in c.shafts) for i in places]
        couplings = [assembly.line.elements[i] for i in places]
        one = [c for c in couplings if isinstance(c, Coupling)]
        for place, spring in zip(places, self.springs, strict=True):
            self._require_alone(place, spring)
        self.resistance = np.array([c.thermal_resistance for c in one], dtype=float)
        self.ambient = np.array([c.ambient_temperature for c in one], dtype=float)
        self.high = np.array([c.temperatures[-1] if c.temperatures else HOTTEST for c in one])
        self.ratings = np.array([np.nan if c.highest_temperature is None else c.highest_temperature for c in one])
        for i, c, ambient in zip(places, one, self.ambient, strict=True):
            if c.temperatures and not c.temperatures[0] <= ambient < c.temperatures[-1]:
                raise InputError(
                    f"lies outside temperatures, which begin at {shown(c.temperatures[0], TEMPERATURE)}",
                    element=assembly.line.names[i], key="ambient_temperature", value=shown(float(ambient), TEMPERATURE),
                    remedy="add the temperature of the surroundings to the table",
                )  # fmt: skip

    @property
    def searched(self) -> str:
        """In words."""
        if len(self.places) == 1:
            return f"{NODES} temperatures from cold to the end of the table, closer where two may lie side by side"
        return "followed from cold and from the ends of the tables; others may exist between"

    def _require_alone(self, place: int, spring: int) -> None:
        if len(self.assembly.topology.compliances[spring].shafts) > 1:
            raise InputError(
                "stands in series with another spring and no inertia between, so that its heat is not told apart",
                element=self.assembly.line.names[place], key="thermal_resistance",
                remedy="put a Disk between them: flanges have one",
            )  # fmt: skip

    def heat(self, speed: Array, temperature: Array) -> Array:
        """P [W] (case, coupling) at speeds (case,) and temperatures (case, coupling); NaN where one is."""
        found = np.full(temperature.shape, np.nan)
        known = np.flatnonzero(~np.isnan(temperature).any(axis=1))
        for begin in range(0, len(known), ROWS):
            keep_time()
            rows = known[begin : begin + ROWS]
            table = self.assembly.table(len(rows), speed[rows])
            for k, column in enumerate(self.columns):
                table[:, column] = temperature[rows, k]
            found[rows] = response_of_table(self.assembly, table).heat[:, self.springs]
        return found

    def excess(self, speed: float, temperature: Array) -> Array:
        """T_ambient + R P(T) − T [K] (case, coupling)."""
        heat = self.heat(np.full(len(temperature), speed), temperature)
        return np.asarray(self.ambient + self.resistance * heat - temperature)

    def alone(self, speeds: Array) -> list[_SettledAt]:
        """Of one coupling: every change of sign between cold and the end of its table, at all speeds together."""
        nodes = np.linspace(self.ambient[0], self.high[0], NODES)
        values = self._excess(np.repeat(speeds, NODES), np.tile(nodes, len(speeds))).reshape(len(speeds), NODES)
        where, low, high = [], [], []
        for k, (at, off) in enumerate(self._closer(speeds, nodes, values)):
            for i in np.flatnonzero((off[:-1] > 0) != (off[1:] > 0)):
                where.append(k)
                low.append((at[i], off[i]))
                high.append((at[i + 1], off[i + 1]))
        ends = np.array(low).reshape(-1, 2), np.array(high).reshape(-1, 2)
        places = np.array(where, dtype=int)
        roots, falling = self._roots(speeds[places], *ends), ends[0][:, 1] > 0
        return [_of_roots(roots[places == k], falling[places == k]) for k in range(len(speeds))]

    def _excess(self, speeds: Array, temperature: Array) -> Array:
        """The same of one coupling, at speeds (case,) and temperatures (case,)."""
        heat = self.heat(speeds, temperature[:, None])[:, 0]
        return np.asarray(self.ambient[0] + self.resistance[0] * heat - temperature)

    def _closer(self, speeds: Array, nodes: Array, values: Array) -> list[tuple[Array, Array]]:
        """Nodes and values of every speed, more of them where the excess turns round towards 0 without crossing it."""
        size = np.abs(values)
        turns = np.argwhere((size[:, 1:-1] < size[:, :-2]) & (size[:, 1:-1] < size[:, 2:])) + (0, 1)
        between = [np.linspace(nodes[i - 1], nodes[i + 1], 2 * CLOSER + 1)[1:-1] for _, i in turns]
        found = [(nodes, one) for one in values]
        if between:
            more = self._excess(np.repeat(speeds[turns[:, 0]], 2 * CLOSER - 1), np.concatenate(between))
            for (k, _), at, off in zip(turns, between, more.reshape(len(turns), -1), strict=True):
                every, first = np.unique(np.concatenate([found[k][0], at]), return_index=True)
                found[k] = every, np.concatenate([found[k][1], off])[first]
        return found

    def _roots(self, speeds: Array, low: Array, high: Array) -> Array:
        """Between temperatures with values of either sign (bracket, 2), all brackets together: by the secant, and by
        halves where that is slow."""
        (a, fa), (b, fb) = low.copy().T, high.copy().T
        for step in range(MOST_STEPS):
            if not len(a) or (b - a).max() <= EXACT:
                break
            middle = (a + b) / 2
            with np.errstate(divide="ignore", invalid="ignore"):
                secant = a - fa * (b - a) / (fb - fa)
            # a little beyond the secant's point, so that both ends move
            ahead = secant + np.sign(middle - secant) * np.minimum(EXACT / 3, np.abs(middle - secant))
            new = np.where(np.isfinite(ahead) & (ahead > a) & (ahead < b) & (step % 3 != 2), ahead, middle)
            value = self._excess(speeds, new)
            left = (value > 0) == (fa > 0)
            a, fa = np.where(left, new, a), np.where(left, value, fa)
            b, fb = np.where(left, b, new), np.where(left, fb, value)
        return (a + b) / 2

    def together(self, speed: float) -> _SettledAt:
        """Of several: relaxed towards balance from cold and from hot."""
        ends = [self._relaxed(speed, start) for start in (self.ambient, self.high)]
        known = [one for one in ends if not np.isnan(one).any()]
        nothing = np.full(len(self.places), np.nan)
        if not known:
            return _SettledAt(nothing, nothing, 0)
        apart = len(known) == 2 and np.abs(known[0] - known[1]).max() > 1e3 * EXACT
        return _SettledAt(ends[0], known[-1] if apart else known[0], len(known) if apart else 1)

    def _relaxed(self, speed: float, start: Array) -> Array:
        """Temperatures at which all stay; NaN where they leave their tables or do not settle."""
        at, share = start.copy(), 1.0
        before = np.inf
        for _ in range(MOST_STEPS):
            off = self.excess(speed, at[None])[0]
            if np.isnan(off).any():
                break
            worst = float(np.abs(off).max())
            if worst < 10 * EXACT:
                return at
            share = max(share / 2, 1 / 64) if worst > 0.9 * before else min(share * 1.1, 1.0)
            before = worst
            at = at + share * off
            if (at > self.high).any():
                if (start == self.high).all() and (at <= self.high + EXACT).all():
                    at = np.minimum(at, self.high)
                    continue
                break
            at = np.maximum(at, self.ambient)
        return np.full(len(at), np.nan)


def _findings(found: CouplingTemperatures) -> Iterator[Finding]:
    words = found.words
    for c, name in enumerate(found.couplings):
        lost = np.isnan(found.temperature[:, c])
        if lost.any():
            at = found.speed[lost]
            first = words.speed(float(at[0]))
            where = first if len(at) == 1 else f"{len(at)} speeds, the first {first}"
            end = shown(float(found.ends[c]), TEMPERATURE)
            yield Finding(
                Gravity.DANGER,
                f"{name} settles at no temperature up to {end} at {where}: it heats on, its table ends too early, or a "
                "resonance has no damping.",
            )
        hot = found.temperature[:, c] > found.ratings[c]
        if hot.any():
            most = float(np.nanmax(found.temperature[:, c]))
            yield Finding(
                Gravity.DANGER,
                f"{name} settles at up to {shown(most, TEMPERATURE, digits=4)}, above its highest temperature of "
                f"{shown(float(found.ratings[c]), TEMPERATURE, digits=4)}.",
            )
    several = found.settled > 1
    if several.any():
        where = words.speed(float(found.speed[several][0]))
        yield Finding(
            Gravity.CAUTION,
            f"Several settled temperatures exist, at {where} say: from cold it stays at the lowest, after a hot "
            "spell it may stay at a higher one.",
        )
    warm = np.isfinite(found.runaway) & ~np.isnan(found.temperature[:, 0])
    if warm.any():
        worst = float(np.nanmin(found.runaway[warm]))
        yield Finding(
            Gravity.CAUTION,
            f"Once hotter than {shown(worst, TEMPERATURE, digits=4)} it heats on: it settles from cold only.",
        )
