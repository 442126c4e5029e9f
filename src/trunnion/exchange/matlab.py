"""A line as a state space in a MAT file: A, B, C, D with the names and units of what they join."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from trunnion.errors import InputError
from trunnion.exchange.matrices import matrices_of
from trunnion.exchange.network import Network, bare_flange, refuse_viscous_at_no_speed


def state_space(network: Network) -> dict[str, Any]:
    """x = (q, q′) of the rotations, u torques on the inertias, y their rotations and the torques of the springs.

    Rotations are the deviation from the turning with the input. ``u0`` are the mean torques of the loads.

    Raises
    ------
    InputError : a viscous load on a driven line whose speed is not stated; a spring or gear that ends where nothing is
        heavy, gears that close a loop, nothing that vibrates.
    """
    if (name := bare_flange(network)) is not None:
        remedy = "put a Disk there, or join springs in series into one"
        raise InputError("ends where nothing is heavy, which a state space does not hold", element=name, remedy=remedy)
    refuse_viscous_at_no_speed(network)
    m = matrices_of(network)
    n, inputs = len(m.rotations), len(m.inertias)
    over = np.linalg.inv(m.mass)
    a = np.block([[np.zeros((n, n)), np.eye(n)], [-over @ m.stiffness, -over @ m.damping]])
    b = np.vstack([np.zeros((n, inputs)), over @ m.input])
    torque = np.hstack([m.stiffness_of[:, None] * m.twist, m.damping_of[:, None] * m.twist])
    c = np.vstack([np.hstack([m.input.T, np.zeros((inputs, n))]), torque])
    states = [f"rotation of {one} [rad]" for one in m.rotations] + [f"speed of {one} [rad/s]" for one in m.rotations]
    outputs = [f"rotation of {one} [rad]" for one in m.inertias] + [f"torque of {one} [N m]" for one in m.springs]
    return {
        "A": a, "B": b, "C": c, "D": np.zeros((len(outputs), inputs)),
        "M": m.mass, "damping": m.damping, "stiffness": m.stiffness, "u0": m.load[:, None],
        "states": _cells(states), "inputs": _cells([f"torque on {one} [N m]" for one in m.inertias]),
        "outputs": _cells(outputs), "name": network.name,
    }  # fmt: skip


def _cells(texts: list[str]) -> Any:
    """A cell array of MATLAB, one text a row."""
    found = np.empty((len(texts), 1), dtype=object)
    found[:, 0] = texts
    return found


def write_state_space(network: Network, path: Path) -> None:
    """Write it as MAT 5."""
    from scipy.io import savemat

    with path.open("wb") as stream:
        savemat(stream, state_space(network), oned_as="column")
