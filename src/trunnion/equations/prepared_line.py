"""A line as its nonlinear equations take it: what has none is refused, what they change is said."""

from __future__ import annotations

import warnings

from trunnion.driveline import quantities
from trunnion.driveline.dampers import ViscousDamper
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.released import released
from trunnion.equations.sliders import sliders
from trunnion.equations.slip_clutches import placed_clutches
from trunnion.equations.stage_laws import has_stages, stage_law
from trunnion.equations.steady_base import require_tree
from trunnion.errors import InputError, InputRemark

ANGLE_SCALE = 0.01
"""The deviation [rad] that counts as one in error control."""


def prepared(
    line: Driveline | Assembly,
    speed: float,
    *,
    leaves: bool = False,
    slips: bool = False,
    swing: bool = False,
    linearised: bool = False,
) -> Assembly:
    """``line`` at input ``speed`` [rad/s] (of a free line: the mean speed it is observed from, and which it may
    leave; oil over frequency is then a Maxwell element). Its slip clutches stick, or slip beyond their capacity where
    ``slips``; its centrifugal pendulums are rings on springs, or swing along their paths where they ``swing``. Unless
    it is only to be ``linearised`` about its motion, torques that act by their tangents are said.

    Raises
    ------
    InputError : a second prescribed speed; no spring; what ``assemble`` refuses.
    """
    assembly = released(assemble(in_series(line) if leaves else line).at(speed), slips=slips, swing=swing)
    refuse_second_speed(assembly)
    if assembly.topology.knotted:
        require_tree(assembly, "nonlinear equations do")
    if not assembly.topology.compliances:
        raise InputError("has no spring, so that nothing twists", element="driveline", remedy="add a Shaft")
    held = {name: "torque over speed by the tangent" for name, rotor in assembly.topology.rotors if rotor.tangent}
    held |= {rub.name: "losses by the mean torque" for rub in assembly.topology.rubs}
    for name, what in held.items() if not linearised else ():
        at = quantities.shown(float(speed), quantities.SPEED, speed_unit(assembly.line), 5)
        warnings.warn(InputRemark(f"{name}: equations of motion have its {what} at {at} of the input"), stacklevel=2)
    return assembly


def in_series(line: Driveline | Assembly) -> Driveline | Assembly:
    """The line with the oil of its dampers as Maxwell elements; itself without any."""
    described = line if isinstance(line, Driveline) else line.stated or line.line
    oils = {i: one for i, one in enumerate(described.elements) if isinstance(one, ViscousDamper) and one.oil}
    if not oils:
        return line
    elements = tuple(oils[i].maxwell if i in oils else one for i, one in enumerate(described.elements))
    return described.model_copy(update={"elements": elements})


def refuse_second_speed(assembly: Assembly) -> None:
    """Refuse a line whose two ends are both prescribed.

    Raises
    ------
    InputError : so.
    """
    if sum(assembly.topology.prescribed) > 1:
        raise InputError(
            "a second prescribed speed has no place in the nonlinear equations",
            element="driveline",
            key="ConstantSpeed",
            remedy="end the line with a Disk",
        )


def with_stages(assembly: Assembly) -> bool:
    """Whether the equations of a line are smooth piece by piece alone: stages, play or dry friction that may slip."""
    row = assembly.table(1)
    if sliders(assembly.packed, assembly.topology, row[0]) or placed_clutches(assembly, row[0]):
        return True
    line, column = assembly.line, assembly.packed.column
    places = [one.shafts[0] for one in assembly.topology.compliances]
    staged = [place for place in places if has_stages(line.elements[place])]
    return any(stage_law(line, place, column, row).knots.size for place in staged)
