"""Springs with stages whose swing may take them out of the stage in which their load holds them: linear bounds are of a
line that stays there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.coefficients import Assembly
from trunnion.floquet.certificate.box_coefficients import NumberRange
from trunnion.floquet.certificate.working_stages import rows_of_ranges, torque_ranges, working_stages
from trunnion.response.peaks.quantities import SWING, quantities_of


def stages_left(
    assembly: Assembly, speeds: tuple[float, float], ranges: Sequence[NumberRange], upper: Array
) -> Iterator[str]:
    """A sentence for each such spring, by bounds ``upper`` of all ``quantities_of`` over the whole box.

    Half of peak to peak is bounded, and the mean lies between both.
    """
    rows = rows_of_ranges(assembly, np.array([sum(speeds) / 2]), ranges)
    low, high = torque_ranges(assembly, speeds, ranges)
    swing = upper[[k for k, (measure, _) in enumerate(quantities_of(assembly)) if measure == SWING]]
    said = set[int]()
    # With the stiffness of teeth the torques at the ends of their stages scatter too.
    for stage in working_stages(assembly, rows):
        least, most = (float(end[stage.spring]) for end in (low - 2 * swing, high + 2 * swing))
        if stage.spring not in said and not stage.holds(least, most):
            said.add(stage.spring)
            yield f"{stage}, and may swing beyond it: bounds are of a line that does not; ask periodic_response"
