"""Modes in reports: of the line alone, and as critical speeds and checks take them at the operating speed."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.errors import InputError
from trunnion.modes.loaded_modes import loaded_modes
from trunnion.reporting.overview_assessment import OverviewAssessment
from trunnion.reporting.tables import Table, four
from trunnion.results.speeds import frequency_unit
from trunnion.results.words import Words


def modes(seen: OverviewAssessment) -> Table:
    """One row per mode; with the slopes of drives and loads at the operating speed, or the highest, a frequency more
    where these move one."""
    unit = frequency_unit(seen.unit)
    rows = seen.natural_frequencies.table(unit)
    loaded = _under_load(seen, len(rows)) * Words(unit).factor
    alone = np.array([row[f"frequency [{unit}]"] for row in rows], dtype=float)
    known = np.isfinite(loaded)
    if any(four(a) != four(b) for a, b in zip(alone[known].tolist(), loaded[known].tolist(), strict=True)):
        at = Words(seen.unit).speed(_speed(seen))
        for row, value in zip(rows, loaded.tolist(), strict=True):
            last = row.pop("moves most")
            row |= {f"under load at {at} [{unit}]": value, "moves most": last}
    return Table.of(rows)


def _speed(seen: OverviewAssessment) -> float:
    return seen.speed or seen.speed_range[1]


def _under_load(seen: OverviewAssessment, count: int) -> Array:
    """Frequencies (mode,) [rad/s] as checks take them; NaN where there is none."""
    found = np.full(count, np.nan)
    case = seen.subject.cases[0]
    at = np.array([_speed(seen)])
    try:
        values = loaded_modes(case.assembly, at, case.span.table(at))[0][0].imag
    except InputError:  # beyond a curve
        return found
    found[case.first - 1 :][: len(values)] = values
    return found
