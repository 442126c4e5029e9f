"""Springs with stages whose swing may take them out of the stage in which their load holds them: linear bounds are of a
line that stays there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.coefficients import Assembly
from trunnion.floquet.certificate.box_coefficients import NumberRange
from trunnion.floquet.certificate.working_stages import torque_ranges, working_stages
from trunnion.response.peaks.quantities import SWING, quantities_of


def stages_left(
    assembly: Assembly, speeds: tuple[float, float], ranges: Sequence[NumberRange], upper: Array
) -> Iterator[str]:
    """A sentence for each such spring, by bounds ``upper`` of all ``quantities_of`` over the whole box.

    Half of peak to peak is bounded, and the mean lies between both.
    """
    middle = assembly.table(1, sum(speeds) / 2)
    for one in ranges:
        one.columns.put(middle, np.array([(one.low + one.high) / 2]))
    low, high = torque_ranges(assembly, speeds, ranges)
    swing = upper[[k for k, (measure, _) in enumerate(quantities_of(assembly)) if measure == SWING]]
    for stage in working_stages(assembly, middle):
        least, most = (float(end[stage.spring]) for end in (low - 2 * swing, high + 2 * swing))
        if not stage.holds(least, most):
            yield f"{stage}, and may swing beyond it: bounds are of a line that does not; ask periodic_response"
