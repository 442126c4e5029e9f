"""One box of speeds and tolerances: proved stable, or open with what stands against it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.coefficients import Assembly
from trunnion.floquet.certificate.box_coefficients import NumberRange
from trunnion.floquet.certificate.box_equations import NotEnclosed, box_matrix
from trunnion.floquet.certificate.periodic_lyapunov import lyapunov_series, modal_box
from trunnion.floquet.certificate.proof import check


@dataclass(frozen=True)
class JudgedBox:
    """``proved``; ``excess``: below 1 proved; ``blame`` (1 + ranges,): what speed and each range bring of it;
    ``decay``: rate [1/s] at which disturbances die out at least, where proved; ``doubtful``: whether not even the
    middle was found to be stable."""

    proved: bool
    excess: float
    blame: Array
    decay: float = 0.0
    doubtful: bool = False


def judge(
    assembly: Assembly, speeds: tuple[float, float], ranges: Sequence[NumberRange], *, by_energy: bool = False
) -> JudgedBox:
    """Of all lines with numbers within ``ranges`` at all ``speeds`` [rad/s].

    ``by_energy`` : with the energy of the mean line alone, the same at all angles: cheap, and as good for wide ranges
    of speeds as for narrow ones.
    """
    nothing = JudgedBox(False, np.inf, np.ones(1 + len(ranges)), doubtful=True)
    try:
        box = box_matrix(assembly, speeds, ranges)
    except NotEnclosed:
        return nothing
    modal = modal_box(box)
    if modal is None:
        return nothing
    series = lyapunov_series(box, modal, 0 if by_energy else None)
    found = check(box, modal, series)
    if found.proved:
        return JudgedBox(True, found.excess, found.blame, found.decay)
    at = series.parts[0].sum(axis=0)
    doubtful = not series.solved or not np.linalg.eigvalsh((at + at.conj().T) / 2)[0] > 0
    return JudgedBox(False, found.excess, found.blame, doubtful=doubtful)
