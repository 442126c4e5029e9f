"""One cylinder that does not fire: which of them loads the line most."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Integers
from trunnion.driveline.arguments import running_range
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operation import Operation
from trunnion.driveline.silent_cylinders import cylinders, silent_cases
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.errors import InputError
from trunnion.floquet.ranges.span import Span
from trunnion.response.orders.response import order_response
from trunnion.response.orders.result import OrderResponse
from trunnion.response.ranges.largest_torques import largest_torques
from trunnion.response.speed_sweep import response_over
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, computed, coordinate, internal, labelled, variable
from trunnion.results.finding import Finding, Gravity
from trunnion.results.result import Result

ALIKE = 1e-6
"""Share by which cylinders that do the same may differ: the first of them is named."""


@labelled
class Misfire(Result):
    """Linear response with every cylinder in turn out of work."""

    cylinders: tuple[tuple[str, int], ...] = internal("engine or disk, and number of each")
    springs: tuple[str, ...] = coordinate("spring")
    vibratory_torque: Array = variable(
        "cylinder spring", "N*m", "largest half of peak-to-peak over the range, or of the speeds asked for"
    )
    speed: Array = variable("cylinder spring", "rad/s", "input speed where it is largest")
    normal: Array = variable("spring", "N*m", "vibratory torque of the line as stated, mostly with all firing")
    unsettled: Integers = variable(
        "cylinder", "1", "speeds without a steady state, undamped resonances, left out above"
    )
    line: Driveline = internal("with the worst cylinder out of work")
    response: OrderResponse = internal("of that line")
    unit: str = internal("of speeds in print")
    cut_out: bool = attribute("whether nothing is left of its gas torque", default=False)
    stated: str = attribute("cylinders that are out of work already in the line as stated", default="all firing")
    unsettled_as_stated: int = attribute("speeds without a steady state of the line as stated", default=0)
    missing: float = attribute(
        "share of a torque by which it may be larger between the speeds looked at; NaN where they were asked for",
        default=float("nan"),
    )

    @property
    @computed(coordinate("cylinder"), after="springs")
    def names(self) -> list[str]:
        """Engine or disk and number of every cylinder."""
        return [f"{name} {number}" for name, number in self.cylinders]

    @property
    @computed(attribute(name="worst"))
    def _worst_name(self) -> str:
        return self.names[self.cylinders.index(self.worst)]

    @property
    def worst(self) -> tuple[str, int]:
        """The cylinder whose misfire raises the torque of any spring most, relative to the line as stated; before
        all others one that meets undamped resonances."""
        return self.cylinders[_worst(self.vibratory_torque, self.normal, self.unsettled)]

    @property
    def worst_in_words(self) -> str:
        """ "cylinder 3 of engine misfiring"."""
        return f"{self._called(*self.worst)} {'cut out' if self.cut_out else 'misfiring'}"

    def _called(self, name: str, number: int) -> str:
        """A disk that carries one cylinder is that cylinder."""
        several = sum(one == name for one, _ in self.cylinders) > 1
        return f"cylinder {number} of {name}" if several else name

    @property
    def _done(self) -> str:
        return "cut-out" if self.cut_out else "misfire"

    @property
    def headline(self) -> str:
        """The worst cylinder in one line."""
        return f"{self._done}: {self._called(*self.worst)} is the worst of {len(self.cylinders)}"

    def table(self) -> list[dict[str, object]]:
        """Largest vibratory torque [N m] of every spring with the worst cylinder out of work, and as stated."""
        row = self.cylinders.index(self.worst)
        return [
            {
                "spring": spring, "vibratory torque [N m]": float(self.vibratory_torque[row, s]),
                f"at [{self.words.unit}]": float(self.speed[row, s]) * self.words.factor,
                f"{self.stated} [N m]": float(self.normal[s]),
            }
            for s, spring in enumerate(self.springs)
        ]  # fmt: skip

    def by_cylinder(self) -> list[dict[str, object]]:
        """What each cylinder out of work does most: the spring, its vibratory torque [N m], over that as stated."""
        rows: list[dict[str, object]] = []
        for row, called in enumerate(self.cylinders):
            times = _times(self.vibratory_torque[row], self.normal)
            s = int(np.nan_to_num(times).argmax())
            rows.append(
                {
                    "cylinder": self._called(*called), "most in": self.springs[s],
                    "vibratory torque [N m]": float(self.vibratory_torque[row, s]),
                    f"at [{self.words.unit}]": float(self.speed[row, s]) * self.words.factor,
                    f"times that of {self.stated}": float(times[s]),
                    "undamped resonances": int(self.unsettled[row]) or None,
                }
            )  # fmt: skip
        return rows

    @property
    def looked_at(self) -> str:
        """What the largest values are the largest of; empty of one speed."""
        if not np.isnan(self.missing):
            over = self.words.ranges([(float(self.response.speed.min()), float(self.response.speed.max()))])
            if np.isinf(self.missing):
                return f"the largest found over {over}; the search ended early, and they may be larger"
            short = "less than 0.01 %" if self.missing < 1e-4 else f"{100 * self.missing:.2g} % at most"
            return f"the largest over {over}, searched: short by {short}"
        if (count := len(self.response.speed)) > 1:
            return f"the largest of the {count} speeds asked for; between them it may be larger"
        return ""

    @property
    def raised(self) -> str:
        """The spring whose torque the worst cylinder raises most, relative to the line as stated."""
        row = self.cylinders.index(self.worst)
        return self.springs[int(np.nan_to_num(_times(self.vibratory_torque[row], self.normal)).argmax())]

    def plot(self, axes: Axes | None = None, *, unit: str | None = None, operating: Operation | None = None) -> Axes:
        """Torque of the spring that is raised most, by order over speed; see ``pictures.orders.misfire``."""
        return drawing(self, "plot")(self, axes, unit=unit, operating=operating)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What the largest torques leave out."""
        found = []
        for count, called in [(self.unsettled_as_stated, self.stated), *zip(self.unsettled, self.names, strict=True)]:
            if count:
                what = called if called == self.stated else f"{called} out of work"
                said = f"With {what} no steady state exists at {count} of the speeds, undamped resonances: left out."
                if not np.isnan(self.missing):
                    said = f"With {what} undamped resonances have no steady state: torques there are without bound."
                found.append(Finding(Gravity.DANGER, said))
        return tuple(found)

    def _lines(self) -> Iterator[str]:
        row = self.cylinders.index(self.worst)
        yield self.headline
        if self.looked_at:
            yield f"  {self.looked_at}"
        for s, spring in enumerate(self.springs):
            yield (
                f"  {spring}: vibratory torque {_newton_metres(self.vibratory_torque[row, s])} at "
                f"{self.words.speed(float(self.speed[row, s]))}, {_newton_metres(self.normal[s])} with {self.stated}"
            )
        for one in self.by_cylinder():
            times = float(str(one[f"times that of {self.stated}"]))
            more = "without bound" if np.isinf(times) else f"{times:.4g} times as much"
            yield f"  {one['cylinder']}: {more} in {one['most in']}"


def misfire(
    line: Driveline,
    speeds: ArrayLike | None = None,
    load_case: str | None = None,
    *,
    cut_out: bool = False,
    speed_range: tuple[float | str, float | str] | None = None,
    progress: Callable[[float], None] | None = None,
) -> Misfire:
    """Put every cylinder of ``line`` out of work in turn and find the worst.

    Cylinders are those of an ``Engine`` and the ``firing_angles`` of disks. The gas in one of an engine that misfires
    is still compressed, see ``Engine``; of one that is ``cut_out``, and of one of a disk, the inertia torque of its
    masses (``quadratic_amplitude``) is all that is left. ``misfire(...).line`` is the line with the worst one, for
    ``assess`` and all else.

    Parameters
    ----------
    line : with cylinders.
    speeds : (speed,) input speeds [rad/s] to look at, instead of a range.
    load_case : name of one of the line's load cases; by default the loads of its disks.
    cut_out : nothing is left of the gas torque, instead of what compression does.
    speed_range : lowest and highest input speed [rad/s], by default those of ``operation``: the largest torque of every
        spring between them is searched for with each cylinder out of work, as ``assess`` searches it.
    progress : called as progress(share done).

    Raises
    ------
    InputError : no engine and no disk has cylinders; no speeds and no range; as of ``order_response``.

    Examples
    --------
    >>> import trunnion as tn
    >>> torque, angles = tn.Excitation(order=0.5, amplitude=40.0), ["0 deg", "180 deg", "450 deg", "540 deg"]
    >>> engine = tn.Disk(inertia=0.2, excitation=[torque], firing_angles=angles, drive_share=1)
    >>> line = tn.Driveline([engine, tn.Shaft(stiffness=2e4, damping=2.0), tn.Disk(inertia=2.0, load_torque=50.0)])
    >>> tn.misfire(line, [100.0, 150.0])
    <Misfire: misfire: cylinder 2 of Disk 1 is the worst of 4>
    """
    key = "cut_out" if cut_out else "misfiring"
    found_here = tuple(cylinders(line.as_stated.parts, key))
    if not found_here:
        remedy = 'add an Engine, or list the excitation of one cylinder and firing_angles = ["0 deg", "180 deg"], say'
        where = {"element": "driveline", "key": "firing_angles"}
        raise InputError("has no cylinders that could misfire", **where, remedy=remedy)
    if speeds is not None and speed_range is not None:
        remedy = "leave one of them out"
        raise InputError("is a range beside speeds", key="speed_range", value=speed_range, remedy=remedy)
    over = (0.0, 0.0) if speeds is not None else _range(line, speed_range)
    if speeds is None and over[0] == over[1]:
        speeds = over[:1]
    # the cylinder first: a load on a throw dissolves its Engine, whose compression would be lost
    lines = [line, *(line.replace(one.owner, **{key: one.number}) for one in found_here)]
    assemblies = [assemble(_loaded(one, load_case)) for one in lines]
    if not assemblies[0].topology.compliances:
        remedy = "add a Shaft or a Coupling; without one nothing vibrates against anything"
        raise InputError("has no springs, whose torque a misfire could raise", element="driveline", remedy=remedy)
    looks = []
    for k, one in enumerate(assemblies):
        looks.append(_Look.at(one, speeds) if speeds is not None else _Look.over(one, *over))
        if progress:
            progress((k + 1) / (len(assemblies) + 1))
    stated, *silent = looks
    largest = np.stack([one.torque for one in silent])
    lost = np.array([one.lost for one in silent])
    worst = _worst(largest, stated.torque, lost)
    response = silent[worst].drawn()
    return Misfire(
        cylinders=tuple((one.owner, one.number) for one in found_here), springs=response.springs,
        vibratory_torque=largest, speed=np.stack([one.speed for one in silent]), normal=stated.torque,
        line=assemblies[1 + worst].line, response=response, unit=response.unit, cut_out=cut_out, unsettled=lost,
        stated=_stated(line), unsettled_as_stated=stated.lost, missing=float(np.max([one.missing for one in looks])),
    )  # fmt: skip


@dataclass(frozen=True)
class _Look:
    """What a look at one line shows: largest vibratory torque (spring,) [N m], ``speed`` [rad/s] where, at how many
    speeds there is no steady state, by what share torques may be larger, and the response to draw."""

    torque: Array
    speed: Array
    lost: int
    missing: float
    drawn: Callable[[], OrderResponse]

    @classmethod
    def at(cls, assembly: Assembly, speeds: ArrayLike) -> _Look:
        """At stated speeds."""
        return cls._of(order_response(assembly, speeds), np.nan, None)

    @classmethod
    def over(cls, assembly: Assembly, low: float, high: float) -> _Look:
        """Searched between two speeds."""
        low = Span(assembly, low, high).start
        found = largest_torques(assembly, low, high)
        largest = found.largest
        bounded = np.isfinite(largest.value) & (largest.value > 0)
        share = np.divide(largest.error, largest.value, out=np.zeros_like(largest.error), where=bounded)
        draw = partial(response_over, assembly, low, high, known=largest.response, around=found.around)
        look = cls._of(largest.response, float(share.max(initial=0.0)), draw)
        torque = np.where(np.isinf(largest.value), np.inf, look.torque)
        return replace(look, torque=torque, speed=largest.response.speed[largest.at])

    @classmethod
    def _of(cls, found: OrderResponse, missing: float, draw: Callable[[], OrderResponse] | None) -> _Look:
        torque = found.vibratory_torque
        lost = int(np.isnan(torque).any(axis=1).sum())
        at = np.nan_to_num(torque).argmax(axis=0)
        return cls(_largest(torque), found.speed[at], lost, missing, draw or (lambda: found))


def _range(line: Driveline, stated: tuple[float | str, float | str] | None) -> tuple[float, float]:
    """The range of speeds [rad/s] to search."""
    own = None if line.operation is None else line.operation.speed_range
    found = own if stated is None else stated
    if found is None:
        remedy = 'state speed_range = ["600 rpm", "2000 rpm"] in [operation], say, or pass speeds'
        raise InputError("has no range of speeds to search", element="operation", key="speed_range", remedy=remedy)
    try:
        return running_range(found)
    except InputError as error:
        raise error.but(key="speed_range") from None


def _stated(line: Driveline) -> str:
    """ "all firing", or the cylinders that are out of work already."""
    stated = dict(line.as_stated.parts)
    cases = silent_cases(line.as_stated.parts).items()
    silent = [name for name, (one, key) in cases if getattr(stated[one.owner], key, None) == one.number]
    return " and ".join(silent) or "all firing"


def _largest(torque: Array) -> Array:
    """Over the speeds that have a steady state (spring,); NaN where none has."""
    known = np.where(np.isnan(torque), -np.inf, torque).max(axis=0)
    return np.where(np.isfinite(known), known, np.nan)


def _newton_metres(torque: float) -> str:
    return "without bound" if np.isinf(torque) else f"{torque:.4g} N m"


def _loaded(line: Driveline, load_case: str | None) -> Driveline:
    return line if load_case is None else line.with_load(load_case)


def _times(torque: Array, normal: Array) -> Array:
    """Torques over those as stated, which may be nothing."""
    return np.asarray(torque / np.maximum(np.nan_to_num(normal), 1e-9 * np.nan_to_num(normal).max(initial=1e-300)))


def _worst(torque: Array, normal: Array, lost: Integers) -> int:
    times = np.where(lost == lost.max(), np.nan_to_num(_times(torque, normal)).max(axis=1), -1.0)
    return int(np.argmax(times >= times.max() * (1 - ALIKE)))
