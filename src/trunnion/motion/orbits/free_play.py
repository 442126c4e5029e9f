"""What must hold before a frequency response of a gap is looked for: something moves, and may touch."""

from __future__ import annotations

import numpy as np

from trunnion.errors import InputError
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator


def require_forced(o: PiecewiseOscillator) -> None:
    """Refuse an oscillator that nothing moves.

    Raises
    ------
    InputError : neither a force nor harmonics of it.
    """
    if not _forces(o):
        raise InputError("is zero: nothing moves", element=o.name, key="force", value=0.0, remedy="give an amplitude")


def require_contact(o: PiecewiseOscillator, lowest: float) -> None:
    """Refuse a free gap that the motion cannot cross at ``lowest`` rad/s or above: it may float anywhere in it.

    Without a mean force the swing in free play is Σ F_k/(k ω √((k m ω)² + c²)) at most, less at higher frequencies.

    Raises
    ------
    InputError : no contact is possible; says which force would reach it.
    """
    place = int(np.searchsorted(o.breakpoints, 0.0))
    if o.mean_force or not 0 < place < len(o.breakpoints) or o.slopes[place] != 0:
        return
    damping = o.damping if o.damping_law == "always" else 0.0
    reach = sum(f / (k * lowest * np.hypot(k * o.inertia * lowest, damping)) for k, f in _forces(o))
    gap = o.breakpoints[place] - o.breakpoints[place - 1]
    if 2 * reach < gap:
        raise InputError(
            f"moves less than its free play of {gap:.6g}: no contact is possible, and it may float anywhere there",
            element=o.name, key="force", value=o.force,
            remedy=f"give a mean_force, or a force {gap / (2 * reach):.3g} times larger",
        )  # fmt: skip


def _forces(o: PiecewiseOscillator) -> list[tuple[int, float]]:
    """(order, amplitude) of all that shakes it."""
    found = [(1, abs(o.force)), *((k, float(np.hypot(p, q))) for k, p, q in o.harmonics)]
    return [(k, f) for k, f in found if f > 0]
