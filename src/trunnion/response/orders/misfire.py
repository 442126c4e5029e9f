"""One cylinder that does not fire: which of them loads the line most."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Integers
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.silent_cylinders import cylinders, silent_cases
from trunnion.errors import InputError
from trunnion.response.orders.response import order_response
from trunnion.response.orders.result import OrderResponse
from trunnion.results.fields import attribute, computed, coordinate, internal, labelled, variable
from trunnion.results.finding import Finding, Gravity
from trunnion.results.result import Result


@labelled
class Misfire(Result):
    """Linear response with every cylinder in turn out of work."""

    cylinders: tuple[tuple[str, int], ...] = internal("engine or disk, and number of each")
    springs: tuple[str, ...] = coordinate("spring")
    vibratory_torque: Array = variable("cylinder spring", "N*m", "largest half of peak-to-peak of the speeds asked for")
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
    def findings(self) -> tuple[Finding, ...]:
        """What the largest torques leave out."""
        found = []
        for count, called in [(self.unsettled_as_stated, self.stated), *zip(self.unsettled, self.names, strict=True)]:
            if count:
                what = called if called == self.stated else f"{called} out of work"
                said = f"With {what} no steady state exists at {count} of the speeds, undamped resonances: left out."
                found.append(Finding(Gravity.DANGER, said))
        return tuple(found)

    def _lines(self) -> Iterator[str]:
        row = self.cylinders.index(self.worst)
        yield self.headline
        if (count := len(self.response.speed)) > 1:
            yield f"  the largest of the {count} speeds asked for; between them it may be larger"
        for s, spring in enumerate(self.springs):
            yield (
                f"  {spring}: vibratory torque {self.vibratory_torque[row, s]:.4g} N m at "
                f"{self.words.speed(float(self.speed[row, s]))}, {self.normal[s]:.4g} N m with {self.stated}"
            )
        for one in self.by_cylinder():
            times = one[f"times that of {self.stated}"]
            yield f"  {one['cylinder']}: {times:.4g} times as much in {one['most in']}"


def misfire(line: Driveline, speeds: ArrayLike, load_case: str | None = None, *, cut_out: bool = False) -> Misfire:
    """Put every cylinder of ``line`` out of work in turn and find the worst.

    Cylinders are those of an ``Engine`` and the ``firing_angles`` of disks. The gas in one of an engine that misfires
    is still compressed, see ``Engine``; of one that is ``cut_out``, and of one of a disk, the inertia torque of its
    masses (``quadratic_amplitude``) is all that is left. ``misfire(...).line`` is the line with the worst one, for
    ``assess`` and all else.

    Parameters
    ----------
    line : with cylinders.
    speeds : (speed,) input speeds [rad/s].
    load_case : name of one of the line's load cases; by default the loads of its disks.
    cut_out : nothing is left of the gas torque, instead of what compression does.

    Raises
    ------
    InputError : no engine and no disk has cylinders; as of ``order_response``.

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
    # the cylinder first: a load on a throw dissolves its Engine, whose compression would be lost
    lines = [_loaded(line.replace(one.owner, **{key: one.number}), load_case) for one in found_here]
    before = order_response(_loaded(line, load_case), speeds)
    if not before.springs:
        remedy = "add a Shaft or a Coupling; without one nothing vibrates against anything"
        raise InputError("has no springs, whose torque a misfire could raise", element="driveline", remedy=remedy)
    normal = before.vibratory_torque
    found = [order_response(one, speeds) for one in lines]
    torque = np.stack([one.vibratory_torque for one in found])
    at = np.nan_to_num(torque).argmax(axis=1)
    largest, usual = (_largest(one, axis) for one, axis in ((torque, 1), (normal, 0)))
    lost = np.isnan(torque).any(axis=2).sum(axis=1)
    worst = _worst(largest, usual, lost)
    return Misfire(
        cylinders=tuple((one.owner, one.number) for one in found_here), springs=found[0].springs,
        vibratory_torque=largest, speed=found[0].speed[at], normal=usual, line=lines[worst], response=found[worst],
        unit=found[worst].unit, cut_out=cut_out, unsettled=lost, stated=_stated(line),
        unsettled_as_stated=int(np.isnan(normal).any(axis=1).sum()),
    )  # fmt: skip


def _stated(line: Driveline) -> str:
    """ "all firing", or the cylinders that are out of work already."""
    stated = dict(line.as_stated.parts)
    cases = silent_cases(line.as_stated.parts).items()
    silent = [name for name, (one, key) in cases if getattr(stated[one.owner], key, None) == one.number]
    return " and ".join(silent) or "all firing"


def _largest(torque: Array, axis: int) -> Array:
    """Over the speeds that have a steady state; NaN where none has."""
    known = np.where(np.isnan(torque), -np.inf, torque).max(axis=axis)
    return np.where(np.isfinite(known), known, np.nan)


def _loaded(line: Driveline, load_case: str | None) -> Driveline:
    return line if load_case is None else line.with_load(load_case)


def _times(torque: Array, normal: Array) -> Array:
    """Torques over those as stated, which may be nothing."""
    return np.asarray(torque / np.maximum(np.nan_to_num(normal), 1e-9 * np.nan_to_num(normal).max(initial=1e-300)))


def _worst(torque: Array, normal: Array, lost: Integers) -> int:
    times = np.nan_to_num(_times(torque, normal)).max(axis=1)
    return int(np.where(lost == lost.max(), times, -1.0).argmax())
