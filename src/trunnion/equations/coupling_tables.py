"""Stiffness of couplings over the mean torque they carry and over their temperature."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.couplings import Coupling
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.loss_curves import loses
from trunnion.driveline.parts import Numbers
from trunnion.driveline.quantities import TEMPERATURE, TORQUE, shown
from trunnion.errors import InputError


def table_stiffness(coupling: Coupling, name: str, number: Numbers, torque: Array) -> Array:
    """Stiffness (case,) [N m/rad] under a mean ``torque`` (case,) [N m], at the values of its numbers.

    Raises
    ------
    InputError : a torque or a temperature beyond its tables; a torque that no speed tells.
    """
    refuse_beyond(coupling, name, number)
    found = np.broadcast_to(coupling.stiffness_under(number, torque), torque.shape)
    if not np.isnan(found).any():
        return found
    if np.isnan(torque).any():
        raise InputError(
            "follows the mean torque, which loads over speed leave open where no speed is asked of or stated",
            element=name, key="stiffnesses", remedy='write [operation] speed = "1500 rpm", say',
        )  # fmt: skip
    most = shown(float(np.abs(torque).max()), TORQUE, digits=5)
    raise InputError(
        f"end at {shown(coupling.torques[-1], TORQUE)}, and it carries a mean torque of {most}",
        element=name, key="torques", remedy="add points to the table, lower the load, or narrow the range of speeds",
    )  # fmt: skip


def refuse_beyond(coupling: Coupling, name: str, number: Numbers) -> None:
    """Refuse a temperature beyond the table of factors.

    Raises
    ------
    InputError : so.
    """
    if not coupling.temperatures:
        return
    at = np.atleast_1d(number("temperature"))
    low, high = coupling.temperatures[0], coupling.temperatures[-1]
    out = ~((at >= low) & (at <= high))
    if out.any():
        reach = " to ".join(shown(end, TEMPERATURE) for end in (low, high))
        raise InputError(
            f"lies beyond its temperatures, {reach}", element=name, key="temperature",
            value=shown(float(at[out][0]), TEMPERATURE), remedy="add points to the table",
        )  # fmt: skip


CHANGES = "the torque changes here"


def refuse_torque_tables(line: Driveline, remedy: str, why: str = CHANGES) -> None:
    """Refuse couplings whose stiffness follows the mean torque, and gears that lose a share of it, where that changes.

    Raises
    ------
    InputError : so.
    """
    for name, element in line.parts:
        if isinstance(element, Coupling) and element.torques:
            raise InputError(
                f"follow the mean torque, by which the stiffness holds for small motions about it, and {why}",
                element=name, key="stiffnesses", remedy=remedy,
            )  # fmt: skip
        if loses(element):
            key = element.losses[0].key if element.losses else "drag_torque"
            raise InputError(
                f"holds by the torque of steady running, and {why if why is CHANGES else 'that is not enclosed'}",
                element=name, key=key, value=getattr(element, key),
                remedy="leave it out, or write what it takes as the load_torque of a Disk",
            )  # fmt: skip
