"""Which lines are proved about their own periodic motion, which may be, and what the others lack.

A free–free line with joint angles has no other steady motion; a driven one is proved about it where that is asked for.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trunnion.driveline.belts import Belt
from trunnion.driveline.couplings import Coupling
from trunnion.driveline.dampers import TunedDamper, ViscousDamper
from trunnion.driveline.elements import ConstantSpeed, Element, Ratio, Rotor
from trunnion.driveline.gears import GearPair
from trunnion.driveline.joints import Joint
from trunnion.driveline.planetary import Planetary
from trunnion.driveline.shafts import Shaft
from trunnion.driveline.stages import PiecewiseShaft
from trunnion.driveline.vehicle import Tyre
from trunnion.equations.coefficients import Assembly
from trunnion.equations.loads import drive_places
from trunnion.equations.steady_base import has_joint_angles, require_own_motion
from trunnion.errors import InputError
from trunnion.floquet.certificate.box_coefficients import ANGLE, NumberRange, staged
from trunnion.floquet.certificate.own_stages import stage_obstacle
from trunnion.floquet.tolerance.spread import Spread

ENCLOSED = (
    Belt, ConstantSpeed, Coupling, GearPair, Joint, PiecewiseShaft, Planetary, Ratio, Rotor, Shaft, TunedDamper, Tyre,
    ViscousDamper,
)  # fmt: skip
"""Elements whose equations of motion are written out."""
SAME_SHARE = 1e-12
"""By how much shares of the torque that drives may differ."""
REMEDY = "stability() and tolerance_study() take it"


def about_own_motion(assembly: Assembly, spreads: Sequence[Spread], *, asked: bool) -> bool:
    """Whether a line is proved about its own periodic motion: where that is ``asked`` for, and of a free–free line that
    has joint angles, its own or within their tolerances.

    Raises
    ------
    InputError : asked for of straight joints.
    """
    place = list(assembly.packed.place)
    bends = any(place[column][1] == ANGLE for one in spreads for column in one.columns.index.tolist())
    if asked and not bends:
        require_own_motion(assembly, assembly.table(1))
    return asked or (assembly.topology.free and (bends or has_joint_angles(assembly)))


def require_enclosed(assembly: Assembly, ranges: Sequence[NumberRange], speed: float) -> None:
    """Refuse lines whose equations of motion are not enclosed.

    Raises
    ------
    InputError : names the element, and why.
    """
    line, topo = assembly.line, assembly.topology
    for i, element in enumerate(line.elements):
        why = "" if isinstance(element, ENCLOSED) else f"a {element.kind} is not enclosed"
        if why := why or _obstacle(element):
            raise InputError(f"about the line's own motion {why}", element=line.names[i], remedy=REMEDY)
    if topo.meshes and any(mesh.stiffness for mesh in topo.meshes):
        mesh = next(mesh for mesh in topo.meshes if mesh.stiffness)
        raise InputError(
            "about the line's own motion teeth whose stiffness varies are not enclosed: they go with time, not with "
            "the angle of the input", element=line.names[mesh.element], key="stiffness_variation", remedy=REMEDY,
        )  # fmt: skip
    for compliance in topo.compliances:
        if len(compliance.shafts) > 1:
            raise InputError(
                "is one of several springs in series, which are not enclosed about the line's own motion",
                element=line.names[compliance.shafts[1]], remedy="write them as one Shaft, or put a Disk between",
            )  # fmt: skip
    if topo.free:
        _require_speed_held(assembly, speed)
        _require_drive_kept(assembly, ranges, speed)


def _obstacle(element: Element) -> str:
    if isinstance(element, PiecewiseShaft | GearPair) and staged(element):
        return stage_obstacle(element)
    if isinstance(element, Rotor) and element.tangent:
        return "a torque along a curve is not enclosed; state its tangent, a viscous_load or quadratic_load"
    if isinstance(element, Coupling) and element.torques:
        return "a stiffness over the torque is not enclosed"
    if isinstance(element, ViscousDamper) and element.oil:
        return "an oil whose stiffness goes with the frequency is not enclosed"
    return ""


def _require_speed_held(assembly: Assembly, speed: float) -> None:
    """Refuse free–free lines whose mean speed no torque holds."""
    table = assembly.table(1, speed)
    co = assembly.coefficients(table, statically_twisted=False)
    if not (co.viscous.any() or co.quadratic.any()):
        raise InputError(
            "is free–free, has joint angles, and no torque depends on its speed, which nothing holds then: the "
            "multiplier of the speed is no exact 1 that could be set aside in a proof", element="driveline",
            remedy="give what resists a viscous_load or quadratic_load, or put a ConstantSpeed in front",
        )  # fmt: skip


def _require_drive_kept(assembly: Assembly, ranges: Sequence[NumberRange], speed: float) -> None:
    """Refuse tolerances that move how several disks share the torque that holds the speed."""
    table = assembly.table(1 + 2 * len(ranges), speed)
    for k, one in enumerate(ranges):
        for row, end in ((1 + 2 * k, one.low), (2 + 2 * k, one.high)):
            changed = table[row : row + 1]  # a view: the table itself is written
            one.columns.put(changed, np.array([end]))
    places = drive_places(assembly.topology, assembly.packed.column, table)
    share = places / places.sum(axis=1, keepdims=True)
    moved = np.flatnonzero(np.abs(share - share[0]).max(axis=1) > SAME_SHARE)
    if len(moved):
        raise InputError(
            "moves how those that drive share the torque that holds the speed, which is not enclosed",
            key=ranges[(int(moved[0]) - 1) // 2].label, remedy="give those that drive a drive_share",
        )  # fmt: skip
