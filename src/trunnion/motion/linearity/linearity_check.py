"""``linearity_check``: the linear steady response beside the nonlinear periodic motion, order by order.

``order_response`` is linear in the excitations; ``periodic_response`` is the motion itself. With phases both are
amplitudes of the same orders, so that their difference tells how far linear theory holds at a speed. It falls with the
square where excitations and joint angles shrink together; where play opens, stages change or clutches slip it does not.

Linear equations have no dry friction. A clutch is there the Shaft that ``Clutch.linear`` makes of it at the amplitude,
the leading frequency and the mean torque of the nonlinear motion: the best that a linear line can do,
knowing the answer.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Complex
from trunnion.driveline.arguments import one_number
from trunnion.driveline.clutches import Clutch
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import operating_speed
from trunnion.errors import InputError
from trunnion.motion.linearity.linearity_result import LinearityCheck, LinearShaft, Passage
from trunnion.motion.orbits.periodic_response import ORDERS, PeriodicResponse, periodic_response
from trunnion.motion.passing.run_up import run_up
from trunnion.numerics.curves import extremes, fourier
from trunnion.response.orders.response import order_response
from trunnion.response.orders.result import WORTH_SHOWING, OrderResponse
from trunnion.response.speed_sweep import sweep_speeds
from trunnion.steady.shooting.periodic_orbit import TOLERANCE

WIDTH = 0.2
"""A passage runs from this share of the speed below it to as much above."""
PASSED = 161
"""Speeds of the linear response over a passage, and those about the peaks besides."""
STUCK = 1e-9
"""Twist [rad] that a clutch which does not move is linearised at: its sliders stick."""


def linearity_check(
    line: Driveline,
    speed: float | str | None = None,
    load_case: str | None = None,
    *,
    allowed: float = 0.05,
    acceleration: float | None = None,
    start: ArrayLike | None = None,
    tolerance: float = TOLERANCE,
) -> LinearityCheck:
    """How far the linear response by order holds at a speed, and what misleads it.

    Parameters
    ----------
    line : the driveline.
    speed : input speed [rad/s]; default the operating speed of the file.
    load_case : name of one of the line's load cases.
    allowed : difference, relative to the largest order, up to which linear theory is said to hold.
    acceleration : [rad/s²]; the line is also run through the speed, from 20 % below to 20 % above, and what it
        reaches in passing stands beside the largest linear response in that range.
    start : a state (2n,) near the motion, where a line has several; by default as in ``periodic_response``.
    tolerance : error allowed per step of the nonlinear motion.

    Raises
    ------
    InputError : a line that one of the two analyses refuses; ``allowed`` not between 0 and 1.

    Examples
    --------
    >>> import trunnion as tn
    >>> engine = tn.Disk(inertia=0.2, excitation=[{"order": 2, "amplitude": 100.0}])
    >>> shaft = tn.Shaft(name="shaft", stiffness=1e4, damping=2.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=0.1), tn.Shaft(stiffness=2e4), engine, shaft,
    ...     tn.Disk(inertia=0.8)])
    >>> check = tn.linearity_check(line, 60.0)
    >>> check.holds, bool(check.departure < 1e-3)
    (True, True)
    """
    if not 0 < one_number(allowed, "allowed", "0.05 is 5 %") < 1:
        raise InputError("must be between 0 and 1", key="allowed", value=float(allowed), remedy="0.05 is 5 %")
    loaded = line if load_case is None else line.with_load(load_case)
    clutches = [name for name, one in loaded.parts if isinstance(one, Clutch) and one.friction]
    if not clutches:  # what linear equations refuse is refused before the motion is looked for
        order_response(loaded, [operating_speed(loaded, speed)])
    true = periodic_response(loaded, speed, start=start, tolerance=tolerance, compare=False)
    assert isinstance(true, PeriodicResponse)
    stand_ins = tuple(_linear_shaft(true, loaded, name) for name in clutches) if true.outcome.ok else ()
    linear_line = _without_friction(loaded, stand_ins) if true.outcome.ok else loaded
    linear = order_response(linear_line, [true.speed]) if true.outcome.ok or not clutches else None
    order, found, actual = _by_order(linear, true)
    return LinearityCheck(
        linear=linear,
        nonlinear=true,
        order=order,
        linear_torque=found,
        nonlinear_torque=actual,
        stand_ins=stand_ins,
        allowed=float(allowed),
        passage=None if acceleration is None else _passed(loaded, linear_line, true.speed, acceleration),
    )


def _by_order(linear: OrderResponse | None, true: PeriodicResponse) -> tuple[Array, Complex, Complex]:
    """Orders (order,) and torques (order, spring) [N m] of both; those that either shows."""
    springs = len(true.shafts)
    highest = float(ORDERS)
    if linear is not None and len(linear.order):
        highest = max(highest, float(np.abs(linear.order + linear.frequency / true.speed).max()))
    orders, actual = true.order_torque(highest)
    found = np.zeros((len(orders), springs), dtype=complex)
    if linear is None:
        found[:] = np.nan
    else:
        spectrum = linear.spectrum
        for k, frequency in enumerate(spectrum.angular_frequency[0]):
            place = round(abs(frequency) * true.period / (2 * np.pi))
            if place < len(orders):
                torque = spectrum.amplitude[0, k, spectrum.channels.torque]
                found[place] += torque if frequency >= 0 else np.conj(torque)
    size = np.fmax(np.abs(found), np.abs(actual))[1:]
    largest = np.nanmax(size, initial=0.0) if np.isfinite(size).any() else 0.0
    with np.errstate(invalid="ignore"):
        shown = 1 + np.flatnonzero(np.any(size > WORTH_SHOWING * largest, axis=1))
    return orders[shown], found[shown], actual[shown]


def _linear_shaft(true: PeriodicResponse, line: Driveline, name: str) -> LinearShaft:
    """What stands for a clutch: its mean stiffness and loss at the swing and leading frequency that it has."""
    clutch = line.elements[line.index(name)]
    assert isinstance(clutch, Clutch)
    place = next(e for e, c in enumerate(true.line.assembly.topology.compliances) if line.index(name) in c.shafts)
    run = true.orbit.trajectory

    def twist(times: Array) -> Array:
        return true.line.observe(true.orbit.system, times, run.at(times)).twist[:, place : place + 1]

    swing = float(extremes(twist, run.time_of_state).span[0]) / 2
    cycles = np.abs(fourier(twist, run.time_of_state, max(int(ORDERS * true.turns), 1))[1:, 0])
    frequency = 2 * np.pi * (1 + int(np.argmax(cycles))) / true.period
    torque = float(true.torque_mean[place])
    stiffness, damping, _ = clutch.mean(max(swing, STUCK), frequency, torque)
    slips = tuple(s.torque for s in clutch.friction if swing > s.torque / s.stiffness)
    return LinearShaft(name, swing, frequency, torque, float(stiffness), float(damping), len(slips))


def _without_friction(line: Driveline, stand_ins: tuple[LinearShaft, ...]) -> Driveline:
    """The line with a Shaft in the place of every clutch."""
    elements = list(line.elements)
    for one in stand_ins:
        clutch = line.elements[line.index(one.clutch)]
        assert isinstance(clutch, Clutch)
        stand_in = clutch.linear(max(one.swing, STUCK), one.frequency, one.torque)
        elements[line.index(one.clutch)] = stand_in.model_copy(update={"name": one.clutch})
    return line.model_copy(update={"elements": tuple(elements)})


def _passed(line: Driveline, linear_line: Driveline, speed: float, acceleration: float) -> Passage:
    """A run through the speed, and the largest linear response on its way."""
    low, high = speed * (1 - WIDTH), speed * (1 + WIDTH)
    run = run_up(line, low, high, acceleration=acceleration, steady=0)
    run.outcome.require()
    speeds = sweep_speeds(linear_line, low, high, PASSED)
    steady = order_response(linear_line, speeds).vibratory_torque
    return Passage(
        run.shafts, low, high, run.acceleration, run.peak_vibration, run.vibration_speed,
        np.nanmax(steady, axis=0), speeds[np.nanargmax(steady, axis=0)], run.ending,
    )  # fmt: skip
