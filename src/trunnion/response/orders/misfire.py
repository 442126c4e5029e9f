"""One cylinder that does not fire: which of them loads the line most."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Disk
from trunnion.errors import InputError
from trunnion.response.orders.response import order_response
from trunnion.response.orders.result import OrderResponse
from trunnion.results.declared import Held, Result, axis, over, remark
from trunnion.results.speeds import show_speed


@dataclass(frozen=True, repr=False)
class Misfire(Result):
    """Linear response with every cylinder in turn out of work.

    cylinders: disk and number of each; vibratory_torque (cylinder, spring) and normal (spring,) [N m]: largest half of
    peak-to-peak over the speeds; speed (cylinder, spring) [rad/s]: where; line: with the worst cylinder out of work,
    response: of that line.
    """

    cylinders: tuple[tuple[str, int], ...]
    springs: tuple[str, ...]
    vibratory_torque: Array
    normal: Array
    speed: Array
    line: Driveline
    response: OrderResponse

    @property
    def worst(self) -> tuple[str, int]:
        """The cylinder whose misfire raises the torque of any spring most, relative to normal running."""
        return self.cylinders[_worst(self.vibratory_torque, self.normal)]

    def declared(self) -> Iterator[Held]:
        """Torque over (cylinder, spring)."""
        yield axis("cylinder", [f"{name} {number}" for name, number in self.cylinders])
        yield axis("spring", list(self.springs))
        yield over("cylinder spring", "vibratory_torque", self.vibratory_torque, "N*m")
        yield over("cylinder spring", "speed", self.speed, "rad/s", "input speed where it is largest")
        yield over("spring", "normal", self.normal, "N*m", "vibratory torque with all cylinders firing")
        yield remark("worst", f"{self.worst[0]} {self.worst[1]}")

    def _called(self, name: str, number: int) -> str:
        """A disk that carries one cylinder is that cylinder."""
        several = sum(one == name for one, _ in self.cylinders) > 1
        return f"cylinder {number} of {name}" if several else name

    def __str__(self) -> str:
        name, number = self.worst
        row = self.cylinders.index(self.worst)
        rows = [f"misfire: {self._called(name, number)} is the worst of {len(self.cylinders)}"]
        for s, spring in enumerate(self.springs):
            at = show_speed(float(self.speed[row, s]), self.response.unit)
            rows.append(
                f"  {spring}: vibratory torque up to {self.vibratory_torque[row, s]:.4g} N m at {at}, "
                f"{self.normal[s]:.4g} N m with all cylinders firing"
            )
        return "\n".join(rows)


def misfire(line: Driveline, speeds: ArrayLike, load_case: str | None = None) -> Misfire:
    """Put every cylinder of ``line`` out of work in turn and find the worst.

    Cylinders are the ``firing_angles`` of disks. One that misfires adds only the inertia torque of its masses
    (``quadratic_amplitude``); ``misfire(...).line`` is the line with the worst one, for ``assess`` and all else.

    Raises
    ------
    InputError : no disk has cylinders; as of ``order_response``.
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
        cylinders, found[0].springs, largest, usual, found[0].speed[at], lines[worst], found[worst]
    )  # fmt: skip


def _worst(torque: Array, normal: Array) -> int:
    return int((torque / np.maximum(normal, 1e-9 * normal.max(initial=1e-300))).max(axis=1).argmax())
