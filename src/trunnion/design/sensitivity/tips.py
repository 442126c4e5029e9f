"""How the tip of a tongue follows parameters, by implicit differentiation.

Over x and y a tongue closes where its ridge touches the level of stability. With L = ln ρ

    L(x, y, p) = 0,   L_x(x, y, p) = 0    ⟹    y′ = −L_p/L_y,   x′ = −(L_xp + L_xy y′)/L_xx.

First derivatives are exact (``growth``), those along x once more differences of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from trunnion.arrays import Array
from trunnion.design.sensitivity.differences import CENTRAL, central
from trunnion.design.sensitivity.directions import Direction, Neighbourhood, direction
from trunnion.design.sensitivity.growth import RadiusSlope, radius_slope
from trunnion.design.sensitivity.result import IMPLICIT, SensitivityQuantity, SensitivityRows
from trunnion.driveline.parameters import SPEED, Columns
from trunnion.errors import ComputationError, InputError
from trunnion.floquet.tongues.result import Tongues

Place = tuple[float, float]
STEP = 1e-5
"""Share of x between the places where the gradient is compared."""
ROUNDS = 6
CLOSED = 1e-11
"""|ln ρ| at which a tip is found."""


def tip_slopes(near: Neighbourhood, tongues: Tongues, directions: Sequence[Direction]) -> Iterator[SensitivityRows]:
    """Where every tongue that has a tip closes.

    Raises
    ------
    InputError : tongues of another line, or without the speed along an axis.
    """
    if tongues.line is None or tongues.line.names != near.assembly.line.names:
        remedy = 'tips=tn.tongues(line, ("speed", 10, 200), ("HookeJoint 1.angle", 0, 0.5)) of the same line'
        raise InputError("are not of this line", key="tips", remedy=remedy)
    if SPEED not in (tongues.x_label, tongues.y_label):
        raise InputError("must have the speed along one axis", key="tips", remedy='tn.tongues(line, ("speed", …), …)')
    columns = [near.assembly.packed.resolve(label) for label in (tongues.x_label, tongues.y_label)]
    taken = {int(i) for one in columns for i in one.index}
    own = [one.but(taken) for one in directions]
    labels, units = (tongues.x_label, tongues.y_label), (tongues.x_unit, tongues.y_unit)
    for tongue in tongues:
        if tongue.tip is None:
            continue
        name = f"the tip of tongue {tongue.number}, {tongue.name}"
        place, slope, error, refused = _tip(near, tongue.tip, columns, own)
        both = [
            SensitivityQuantity(f"{label} at {name}", "tip", value, unit, IMPLICIT, place[labels.index(SPEED)], refused)
            for label, value, unit in zip(labels, place, units, strict=True)
        ]
        yield SensitivityRows(both, slope, error)


def _tip(
    near: Neighbourhood, tip: Place, columns: list[Columns], own: Sequence[Direction]
) -> tuple[Place, Array, Array, str]:
    """The tip made exact, its slopes and errors (2, direction), x first, and why there are none."""
    (x, y), nothing = tip, np.full((2, len(own)), np.nan)
    try:
        for _ in range(ROUNDS):
            here, second = _gradients(near, (x, y), columns, own)
            if here.refused:
                return tip, nothing, nothing, here.refused
            level = float(np.log(here.radius))
            slope_x, slope_y = here.slope[-2:]
            jacobian = np.array([[slope_x, slope_y], [second[-2], second[-1]]])
            if abs(level) < CLOSED and abs(slope_x) < 1e-6 * abs(second[-2]) * x:
                break
            step = np.linalg.solve(jacobian, [level, slope_x])
            x, y = x - float(step[0]), y - float(step[1])
        else:
            return tip, nothing, nothing, "its tip was not found again"
    except (InputError, ComputationError, np.linalg.LinAlgError) as error:
        return tip, nothing, nothing, str(error).splitlines()[0]
    by = here.slope[:-2]
    up = -by / slope_y
    across = -(second[:-2] + second[-1] * up) / second[-2]
    share = here.error[:-2] / abs(slope_y)
    return (x, y), np.stack([across, up]), np.stack([np.abs(across) * 1e-6 + share, share]), ""


def _gradients(
    near: Neighbourhood, place: Place, columns: list[Columns], own: Sequence[Direction]
) -> tuple[RadiusSlope, Array]:
    """The gradient of ln ρ along ``own``, x and y; and its derivative by x."""
    axes = [direction(near.assembly, one, value) for one, value in zip(columns, place, strict=True)]
    reach = STEP * axes[0].size

    def at(shift: float) -> RadiusSlope:
        row = near.row()
        columns[1].put(row, place[1])
        columns[0].put(row, place[0] + shift)
        return radius_slope(near, row, own, axes)

    here = at(0.0)
    if here.refused:
        return here, here.slope
    beside = [at(float(k) * reach) for k in CENTRAL]
    return here, central(np.array([one.slope for one in beside]), reach)
