"""What a box must hold for its numbers to be enclosed: one formula at all its speeds, straight lines along tolerances,
springs that stay in one stage.

Curves of machines are taken by their tangents. Slopes alike at all ``curve_speeds`` are alike at all speeds.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.joints import HookeJoint
from trunnion.driveline.pendulums import CentrifugalPendulum
from trunnion.driveline.slip_clutches import SlipClutch
from trunnion.equations.coefficients import Assembly
from trunnion.equations.curve_speeds import curve_speeds
from trunnion.errors import InputError
from trunnion.floquet.certificate.box_coefficients import ANGLE, STATED, STEEPEST, NumberRange, staged
from trunnion.floquet.certificate.working_stages import follows_otherwise, require_stages_held

AFFINE = (
    "stiffness", "damping", "mesh_stiffness", "mesh_damping", "loss_factor", "inertia", "fork_offset", "plane",
    "load_torque", "viscous_load", "quadratic_load",
)  # fmt: skip
"""Numbers that the equations' own are linear in, one at a time."""


def require_linear(
    assembly: Assembly, speeds: tuple[float, float], ranges: Sequence[NumberRange], *, own: bool = False
) -> None:
    """Refuse tolerances in which the equations are not linear, and what changes its kind with the speed.

    own : about the line's own motion.

    Raises
    ------
    InputError : names the parameter or the element, and the value.
    """
    line, topo, place = assembly.line, assembly.topology, list(assembly.packed.place)
    looked_at = curve_speeds(assembly, *speeds)
    torque, varies = _carried(assembly, looked_at, ranges)  # about its own motion no such spring is enclosed
    for one in ranges:
        for k, column in enumerate(one.columns.index.tolist()):
            element, key = place[column]
            owner = line.elements[element] if element >= 0 else None
            hooke = key == ANGLE and isinstance(owner, HookeJoint)
            if (key not in AFFINE and not hooke) or owner is None:
                raise InputError(
                    "cannot scatter in a certificate", key=one.label,
                    remedy="stiffness, damping, inertia, fork_offset, plane, loads, and the angle of a HookeJoint can; "
                    "tolerance_study takes every number",
                )  # fmt: skip
            ends = [float(one.columns.offset[k] + one.columns.slope[k] * v) for v in (one.low, one.high)]
            if hooke and max(abs(end) for end in ends) >= STEEPEST:
                worst = max(ends, key=abs)
                raise InputError("may reach 60° at most in a certificate", key=one.label, value=worst)
            if hooke and topo.free and not own:
                raise InputError(
                    "would bend a free–free line, which then moves in its own periodic motion", key=one.label,
                    remedy="put a ConstantSpeed in front",
                )  # fmt: skip
            _require_single(assembly, one, element, key, under_load=bool(torque.any() or varies.any()))
            if key in ("damping", "mesh_damping") and ends[0] * ends[1] <= 0:
                raise InputError(
                    f"would go from {one.low:.6g} to {one.high:.6g}, and damping that reaches zero cannot be certified",
                    key=one.label, remedy="keep it on one side of zero",
                )  # fmt: skip
    require_stages_held(assembly, looked_at, ranges)
    _require_even(assembly, looked_at)
    loaded = any(place[c][1] in AFFINE[-3:] for one in ranges for c in one.columns.index.tolist())
    for e, compliance in enumerate(topo.compliances):
        if follows_otherwise(assembly, e) and (varies[e] or (torque[e] and loaded)):
            raise InputError(
                "takes stiffness or damping from its load, which varies within the box, and is not followed there",
                element=line.names[compliance.shafts[0]], value=float(torque[e]),
                remedy="write a Shaft of its stiffness under load, or give one speed and no tolerance of loads",
            )  # fmt: skip
    for name, element in line.parts:
        if isinstance(element, SlipClutch) and (varies.any() or (loaded and torque.any())):
            raise InputError(
                "may slip where the load varies within the box, which a certificate does not follow", element=name,
                key="torque", value=element.torque, remedy="write a Ratio of 1 in its place",
            )  # fmt: skip
    _require_straight(assembly, float(np.mean(speeds)), ranges)


def _carried(assembly: Assembly, speeds: Array, ranges: Sequence[NumberRange]) -> tuple[Array, Array]:
    """Torque of every compliance (compliance,) at the highest speed [N m], and whether it varies within the box: a sum
    over loads, so that one load at a time tells."""
    rows = [assembly.table(len(speeds), speeds)]
    for one in ranges:
        for end in (one.low, one.high):
            rows.append(rows[0].copy())
            one.columns.put(rows[-1], end)
    torque = assembly.static_torque(np.concatenate(rows))
    return torque[len(speeds) - 1], np.ptp(torque, axis=0) > 1e-12 * np.abs(torque).max(axis=0)


def _require_straight(assembly: Assembly, speed: float, ranges: Sequence[NumberRange]) -> None:
    """Refuse a tolerance that moves a number of the equations along a curve, as loads move the slope of a motor that is
    set to carry them."""
    table = assembly.table(1 + 5 * len(ranges), speed)
    for one in ranges:
        one.columns.put(table, (one.low + one.high) / 2)
    for k, one in enumerate(ranges):
        own = table[1 + 5 * k : 6 + 5 * k]
        one.columns.put(own, np.linspace(one.low, one.high, 5))
    co = assembly.coefficients(table, statically_twisted=False)
    for k, one in enumerate(ranges):
        for part in (co.stiffness, co.damping, co.inertia, co.load, co.viscous, co.quadratic, co.shift):
            own = part[1 + 5 * k : 6 + 5 * k]
            bent = np.abs(own[1:-1] - (own[:1] + (own[-1:] - own[:1]) * np.array([[0.25], [0.5], [0.75]])))
            # Of loads the parts cancel: a constant is what a tangent leaves of the torque.
            size = np.abs(own).max(axis=0)
            if part is co.load:
                size = size + np.abs(co.viscous[1 + 5 * k : 6 + 5 * k]).max(axis=0) * _speed_of(assembly, speed)
            if (bent > 10 * STATED * size).any():
                raise InputError(
                    "moves other numbers of the equations along a curve, where a certificate follows straight lines",
                    key=one.label, remedy="tolerance_study() says how probable stability is",
                )  # fmt: skip


def _speed_of(assembly: Assembly, speed: float) -> Array:
    return np.abs(assembly.topology.mean_speeds) * speed


def _require_single(assembly: Assembly, one: NumberRange, element: int, key: str, *, under_load: bool) -> None:
    """Refuse what scatters in springs in series, of which only the whole enters the equations, or in those with stages
    ``under_load``, be it in a part of the box: their stages would end at other torques."""
    for compliance in assembly.topology.compliances:
        if element not in compliance.shafts or key in ("fork_offset", "plane", "inertia"):
            continue
        if len(compliance.shafts) > 1 and key in ("stiffness", "damping", "loss_factor"):
            raise InputError(
                "belongs to one of several springs in series, and what scatters in a certificate must be a spring of "
                "its own", key=one.label, remedy="write them as one Shaft, or put a Disk between",
            )  # fmt: skip
        in_stage = staged(assembly.line.elements[element]) and key != "mesh_damping"
        if in_stage and (key != "mesh_stiffness" or under_load):
            raise InputError(
                "belongs to a spring with stages, and cannot scatter in a certificate under load", key=one.label,
                remedy="write a Shaft of its stiffness under load",
            )  # fmt: skip


def _require_even(assembly: Assembly, speeds: Array) -> None:
    """Refuse what takes another stiffness, damping or load with every speed: curves of machines, pendulums."""
    co = assembly.coefficients(assembly.table(len(speeds), speeds), statically_twisted=False)
    checks: list[tuple[Array, Array, Callable[[int], int]]] = [
        (co.stiffness, np.abs(co.stiffness), lambda e: assembly.topology.compliances[e].shafts[0]),
        (co.damping, np.abs(co.damping), lambda e: assembly.topology.compliances[e].shafts[0]),
        *((part, np.abs(part), _rotor_at(assembly)) for part in (co.viscous, co.quadratic)),
    ]
    if not assembly.topology.free:  # there a constant load moves nothing, as its joints are straight
        size = np.abs(co.load) + np.abs(co.viscous) * _speed_of(assembly, speeds[-1])
        checks.append((co.load, size, _rotor_at(assembly)))
    for part, size, element in checks:
        beyond = np.ptp(part, axis=0) - 10 * STATED * size.max(axis=0)
        worst = int(beyond.argmax()) if beyond.size else 0
        if beyond.size and beyond[worst] > 0:
            at = element(worst)
            pendulum = isinstance(assembly.line.elements[at], CentrifugalPendulum)
            remedy = "leave it out" if pendulum else "state its tangent, a viscous_load or quadratic_load"
            raise InputError(
                "goes with the speed along a curve of its own, which a certificate over a range of speeds does not "
                "enclose", element=assembly.line.names[at], value=float(part[0, worst]),
                remedy=f"{remedy}, or ask stability() at single speeds",
            )  # fmt: skip


def _rotor_at(assembly: Assembly) -> Callable[[int], int]:
    at = dict(assembly.topology.disks)
    return lambda station: at.get(station, assembly.topology.stations[station].element)
