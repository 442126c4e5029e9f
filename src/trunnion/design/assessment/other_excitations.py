"""A load case with other excitations, a cylinder out of work: what stays as it is is not looked for again.

Stability, the motion that a free–free line with joint angles is taken about, and the speeds between which a response is
smooth follow from the line without its excitations, from their orders, and from where their tables have points.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from trunnion.design.assessment.assessment_input import LoadCaseResponse
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Element
from trunnion.equations.coefficients import Assembly
from trunnion.equations.harmonics import disk_torques, unexcited
from trunnion.floquet.ranges.resonances import orders_acting

LOOKS = 5
"""Speeds at which one looks whether tables are read at the same places."""


def with_other_excitations(case: LoadCaseResponse, assembly: Assembly) -> LoadCaseResponse:
    """``case`` of the line ``assembly``, which takes from it all that does not depend on excitations, where these are
    all that differs and neither their orders nor the points of their tables do."""
    same = (
        _still(case.assembly) == _still(assembly)
        and all(map(np.array_equal, orders_acting(case.assembly), orders_acting(assembly)))
        and _read(case, case.assembly) == _read(case, assembly)
    )
    return replace(case, assembly=assembly, alike=case if same else None)


def _still(assembly: Assembly) -> tuple[tuple[Element, ...], Driveline | None]:
    """The elements without what excites them, and the line as it is stated where it runs otherwise."""
    return assembly.derived(_unexcited)


def _unexcited(assembly: Assembly) -> tuple[tuple[Element, ...], Driveline | None]:
    return tuple(unexcited(assembly.line).elements), None if assembly.stated is None else unexcited(assembly.stated)


def _read(case: LoadCaseResponse, assembly: Assembly) -> set[tuple[tuple[float, ...], bytes]]:
    """The points of tables of excitations that act, and where these are read."""
    speeds = np.linspace(max(case.low, case.high / 200), case.high, LOOKS)
    table = assembly.table(len(speeds), speeds)
    torques = {(one.element, one.law.axes): one for one in disk_torques(assembly) if one.law.axes and one.acts}
    return {(points, place.tobytes()) for one in torques.values() for points, place in one.places(assembly, table)}
