"""Order map of a motion: how strong each order of the input's rotation is, as the speed changes.

The torque is read at equal steps of the input's angle, so that an order is a line whatever the speed does, and
transformed over windows of a few turns (Hann, overlapping by half). A pure order shows its amplitude. The angle is the
one that the input turned: of a free–free line the line's own, whatever speed it was begun at or asked for, and
the mean rotation of the whole line, which the vibration of a light input does not modulate.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.equations.speed_profile import SpeedProfile
from trunnion.errors import InputError
from trunnion.motion.simulation.input_rotation import TURN, InputRotation

FEWEST_PER_TURN, PER_STEP = 64, 4
"""Samples: what swings faster than two of them would fold back on the orders shown. An integrator takes several steps
to a swing, so four times as many samples miss none; what folds back of the bends at changes of stage stays below 1e-4
of them."""
WINDOW = 8


@dataclass(frozen=True)
class OrderMap:
    """amplitude (window, order, shaft) [N m] at speed (window,) [rad/s], that of the input in the middle of the window
    or, where the line is free–free, its mean over the window, and time (window,) [s] over order (order,) in cycles per
    turn of the input; unit: what speeds read in."""

    time: Array
    speed: Array
    order: Array
    amplitude: Array
    shafts: tuple[str, ...]
    unit: str = "rad/s"


class TurningRun(Protocol):
    """What an order map reads of a run: ``LineSimulation`` or ``Transient``."""

    @property
    def whole(self) -> InputRotation:
        """How the whole line turned."""
        ...

    @property
    def cuts(self) -> Array:
        """Times between which the motion is smooth."""
        ...

    @property
    def starts_free(self) -> bool:
        """Whether nothing prescribes how the line turns."""
        ...

    @property
    def profile(self) -> SpeedProfile:
        """The speed prescribed, where one is."""
        ...

    @property
    def shafts(self) -> tuple[str, ...]:
        """Names of the springs."""
        ...

    @property
    def unit(self) -> str:
        """Unit that speeds are printed in."""
        ...

    def torque_at(self, time: ArrayLike) -> Array:
        """Torque (m, spring) [N m] at times (m,)."""
        ...


def order_map(run: TurningRun, *, window: int = WINDOW, highest: float = 12.0) -> OrderMap:
    """Torque amplitudes of a simulated run by order and time: a run-up shows its orders as lines of constant height.

    Each window of ``window`` turns is weighted by a Hann window and transformed over the rotation; windows overlap by
    half.

    Parameters
    ----------
    run : a ``LineSimulation``, from ``simulate``, or a ``Transient``.
    window : turns of one window, a whole number from 1; orders are resolved to 1/``window``.
    highest : highest order shown, in cycles per turn of the input.

    Returns
    -------
    OrderMap: ``amplitude`` (window, order, shaft) [N m] over ``time`` (window,) [s] and ``order`` (order,).

    Raises
    ------
    InputError : fewer turns than two windows; a free–free line that turns back, where orders mean nothing.

    Examples
    --------
    >>> import trunnion as tn
    >>> shaft = tn.Shaft(stiffness=1e3, damping=2.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=0.2), shaft, tn.Disk(inertia=0.4)])
    >>> found = tn.order_map(tn.simulate(line, speed=20.0, turns=40), highest=3.0)
    >>> strongest = found.amplitude[-1, 1:, 0].argmax() + 1
    >>> float(found.order[strongest])
    2.0
    """
    turns = len(run.whole.turns[1])
    if isinstance(window, bool) or window != int(window) or window < 1 or turns < 2 * window:
        raise InputError(
            f"needs a run of at least two windows, this one has {turns} turns",
            element="order map", key="window", value=window, remedy="take a longer run or a shorter window",
        )  # fmt: skip
    back = run.whole.turned_back
    if back is not None:
        raise InputError(
            f"has no orders: the line turns back at t = {back:.4g} s", element="order map", key="run",
            remedy="let the drive give more torque, or start at a higher speed",
        )  # fmt: skip
    per_turn = _per_turn(run, highest)
    count = window * per_turn
    shape = np.hanning(count + 1)[:-1]
    starts = np.arange(0, turns * per_turn - count + 1, count // 2)
    times = run.whole.times_at(TURN * np.arange(turns * per_turn + 1) / per_turn)
    torque = run.torque_at(times)
    kept = int(np.floor(highest * window + 1e-9)) + 1
    amplitude = np.empty((len(starts), kept, torque.shape[1]))
    for row, at in zip(amplitude, starts, strict=True):
        part = torque[at : at + count]
        # Without its mean, which the window would smear into the lowest orders.
        row[:] = 2 * np.abs(np.fft.rfft((part - part.mean(axis=0)) * shape[:, None], axis=0))[:kept] / shape.sum()
        row[0] = np.abs(part.mean(axis=0))
    middle = times[starts + count // 2]
    mean = TURN * window / (times[starts + count] - times[starts])
    speed = mean if run.starts_free else run.profile.at(middle)
    return OrderMap(middle, speed, np.arange(kept) / window, amplitude, run.shafts, run.unit)


def _per_turn(run: TurningRun, highest: float) -> int:
    """Samples a turn that show all that the motion holds in its busiest turn."""
    edges = run.whole.turns[0]
    steps = int(np.diff(np.searchsorted(run.cuts, edges)).max())
    return 1 << int(np.ceil(np.log2(max(FEWEST_PER_TURN, PER_STEP * steps, 4 * highest))))
