"""One cylinder that does not fire: which of them loads the line most."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.silent_cylinders import cylinders
from trunnion.errors import InputError
from trunnion.response.orders.response import order_response
from trunnion.response.orders.result import OrderResponse
from trunnion.results.fields import attribute, computed, coordinate, internal, labelled, variable
from trunnion.results.result import Result


@labelled
class Misfire(Result):
    """Linear response with every cylinder in turn out of work."""

    cylinders: tuple[tuple[str, int], ...] = internal("engine or disk, and number of each")
    springs: tuple[str, ...] = coordinate("spring")
    vibratory_torque: Array = variable("cylinder spring", "N*m", "largest half of peak-to-peak over the speeds")
    speed: Array = variable("cylinder spring", "rad/s", "input speed where it is largest")
    normal: Array = variable("spring", "N*m", "vibratory torque with all cylinders firing")
    line: Driveline = internal("with the worst cylinder out of work")
    response: OrderResponse = internal("of that line")
    unit: str = internal("of speeds in print")
    cut_out: bool = attribute("whether nothing is left of its gas torque", default=False)

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
        """The cylinder whose misfire raises the torque of any spring most, relative to normal running."""
        return self.cylinders[_worst(self.vibratory_torque, self.normal)]

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
        """Largest vibratory torque [N m] of every spring with the worst cylinder out of work, and with all firing."""
        row = self.cylinders.index(self.worst)
        return [
            {
                "spring": spring, "vibratory torque [N m]": float(self.vibratory_torque[row, s]),
                f"at [{self.words.unit}]": float(self.speed[row, s]) * self.words.factor,
                "all firing [N m]": float(self.normal[s]),
            }
            for s, spring in enumerate(self.springs)
        ]  # fmt: skip

    def _lines(self) -> Iterator[str]:
        row = self.cylinders.index(self.worst)
        yield self.headline
        for s, spring in enumerate(self.springs):
            yield (
                f"  {spring}: vibratory torque up to {self.vibratory_torque[row, s]:.4g} N m at "
                f"{self.words.speed(float(self.speed[row, s]))}, {self.normal[s]:.4g} N m with all cylinders firing"
            )


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
    largest, usual = np.nanmax(torque, axis=1), np.nanmax(normal, axis=0)
    worst = _worst(largest, usual)
    return Misfire(
        cylinders=tuple((one.owner, one.number) for one in found_here), springs=found[0].springs,
        vibratory_torque=largest, speed=found[0].speed[at], normal=usual, line=lines[worst], response=found[worst],
        unit=found[worst].unit, cut_out=cut_out,
    )  # fmt: skip


def _loaded(line: Driveline, load_case: str | None) -> Driveline:
    return line if load_case is None else line.with_load(load_case)


def _worst(torque: Array, normal: Array) -> int:
    return int((torque / np.maximum(normal, 1e-9 * normal.max(initial=1e-300))).max(axis=1).argmax())
