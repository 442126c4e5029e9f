"""One cylinder that does not fire: which of them loads the line most."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Disk
from trunnion.errors import InputError
from trunnion.response.orders.response import order_response
from trunnion.response.orders.result import OrderResponse
from trunnion.results.fields import attribute, computed, coordinate, internal, labelled, variable
from trunnion.results.result import Result


@labelled
class Misfire(Result):
    """Linear response with every cylinder in turn out of work."""

    cylinders: tuple[tuple[str, int], ...] = internal("disk and number of each")
    springs: tuple[str, ...] = coordinate("spring")
    vibratory_torque: Array = variable("cylinder spring", "N*m", "largest half of peak-to-peak over the speeds")
    speed: Array = variable("cylinder spring", "rad/s", "input speed where it is largest")
    normal: Array = variable("spring", "N*m", "vibratory torque with all cylinders firing")
    line: Driveline = internal("with the worst cylinder out of work")
    response: OrderResponse = internal("of that line")
    unit: str = internal("of speeds in print")

    @property
    @computed(coordinate("cylinder"), after="springs")
    def names(self) -> list[str]:
        """Disk and number of every cylinder."""
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

    def _lines(self) -> Iterator[str]:
        name, number = self.worst
        row = self.cylinders.index(self.worst)
        yield f"misfire: {self._called(name, number)} is the worst of {len(self.cylinders)}"
        for s, spring in enumerate(self.springs):
            yield (
                f"  {spring}: vibratory torque up to {self.vibratory_torque[row, s]:.4g} N m at "
                f"{self.words.speed(float(self.speed[row, s]))}, {self.normal[s]:.4g} N m with all cylinders firing"
            )


def misfire(line: Driveline, speeds: ArrayLike, load_case: str | None = None) -> Misfire:
    """Put every cylinder of ``line`` out of work in turn and find the worst.

    Cylinders are the ``firing_angles`` of disks. One that misfires adds only the inertia torque of its masses
    (``quadratic_amplitude``); ``misfire(...).line`` is the line with the worst one, for ``assess`` and all else.

    Parameters
    ----------
    line : with cylinders.
    speeds : (speed,) input speeds [rad/s].
    load_case : name of one of the line's load cases; by default the loads of its disks.

    Raises
    ------
    InputError : no disk has cylinders; as of ``order_response``.

    Examples
    --------
    >>> import trunnion as tn
    >>> torque, angles = tn.Excitation(order=0.5, amplitude=40.0), ["0 deg", "180 deg", "450 deg", "540 deg"]
    >>> engine = tn.Disk(inertia=0.2, excitation=[torque], firing_angles=angles, drive_share=1)
    >>> line = tn.Driveline([engine, tn.Shaft(stiffness=2e4, damping=2.0), tn.Disk(inertia=2.0, load_torque=50.0)])
    >>> tn.misfire(line, [100.0, 150.0])
    <Misfire: misfire: cylinder 2 of Disk 1 is the worst of 4>
    """
    if load_case is not None:
        line = line.with_load(load_case)
    cylinders = tuple(
        (name, number)
        for name, disk in zip(line.names, line.elements, strict=True)
        if isinstance(disk, Disk)
        for number in range(1, len(disk.firing_angles) + 1)
    )
    if not cylinders:
        remedy = 'list the excitation of one cylinder and firing_angles = ["0 deg", "180 deg"], say'
        raise InputError("has no cylinders that could misfire", element="driveline", key="firing_angles", remedy=remedy)
    normal = order_response(line, speeds).vibratory_torque
    lines = [line.replace(name, misfiring=number) for name, number in cylinders]
    found = [order_response(one, speeds) for one in lines]
    torque = np.stack([one.vibratory_torque for one in found])
    at = np.nan_to_num(torque).argmax(axis=1)
    largest, usual = np.nanmax(torque, axis=1), np.nanmax(normal, axis=0)
    worst = _worst(largest, usual)
    return Misfire(
        cylinders=cylinders, springs=found[0].springs, vibratory_torque=largest, speed=found[0].speed[at], normal=usual,
        line=lines[worst], response=found[worst], unit=found[worst].unit,
    )  # fmt: skip


def _worst(torque: Array, normal: Array) -> int:
    return int((torque / np.maximum(normal, 1e-9 * normal.max(initial=1e-300))).max(axis=1).argmax())
