"""How long a line takes from one speed to another if its shafts are rigid and its joints straight."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.integrate import solve_ivp

from trunnion.equations.applied_torques import PlacedTorque, placed_frictions, placed_torques, time_knots
from trunnion.equations.line_system import LineSystem
from trunnion.errors import InputError
from trunnion.motion.transients.prepare import Actions

LONGEST = 1e4
"""Times the inertia over the largest torque at the first speed, after which it is not waited for any longer."""


def _finite(torque: PlacedTorque, time: float, speed: float, angle: float) -> float:
    """Its value [N m]; without one the integrator below would not end."""
    value = torque.value(time, speed, angle)
    if not np.isfinite(value):
        where = f"at t = {time:.4g} s, a speed of {speed:.4g} rad/s and an angle of {angle:.4g} rad"
        problem = f"its formula or function gives no finite number {where}"
        remedy = "look for roots, logarithms and quotients there"
        raise InputError(problem, element=str(torque.stated.on), key="torque", value=value, remedy=remedy)
    return value


def rigid_time(line: LineSystem, asked: Actions, first: float, last: float) -> float:
    """Time [s] from ``first`` to ``last`` [rad/s] of the input under the torques ``asked``, the line being rigid and
    without angled joints; infinite where it never comes there.

    Raises
    ------
    InputError : a formula or function that gives no finite number on the way.
    """
    assembly, topo = line.assembly, line.assembly.topology
    co = line.untwisted(assembly.table(1, line.speed))
    ratio, inertia = np.abs(topo.mean_speeds), float(co.inertia[0] @ topo.mean_speeds**2)
    constant, viscous, quadratic = (
        float(part[0] @ ratio**power) for part, power in ((co.load, 1), (co.viscous, 2), (co.quadratic, 3))
    )
    torques = [(float(ratio[one.station]), one) for one in placed_torques(assembly, asked[0])]
    frictions = [(float(ratio[one.station]), one) for one in placed_frictions(assembly, asked[1])]

    def gained(t: float, state: Sequence[float]) -> list[float]:
        angle, speed, *lagging = state
        total, follows = -constant - (viscous + quadratic * abs(speed)) * speed, list[float]()
        for size, one in torques:
            torque = _finite(one, t, size * speed, size * angle)
            if (corner := one.stated.corner_frequency) is not None:
                follows.append(corner * (torque - lagging[one.lagged]))
                torque = lagging[one.lagged]
            total += size * torque
        for size, rubs in frictions:
            total -= size * rubs.stated.torque * rubs.share(t)[0] * (-1.0 if speed < 0 else 1.0)
        return [speed, total / inertia, *follows]

    def reached(t: float, state: Sequence[float]) -> float:
        return state[1] - last

    def hangs(t: float, state: Sequence[float]) -> float:
        return gained(t, state)[1] * np.sign(last - first) - least

    reached.terminal = hangs.terminal = True  # type: ignore[attr-defined]
    hangs.direction = -1  # type: ignore[attr-defined]
    lagging = [(size, one) for size, one in torques if one.lags]
    steady = [_finite(one, 0.0, size * first, 0.0) for size, one in lagging]
    begin = abs(gained(0.0, (0.0, first, *steady))[1])
    knots = time_knots([one for _, one in torques], [one for _, one in frictions])
    after = float(knots[-1]) if len(knots) else 0.0
    most = max(begin, max((abs(gained(t, (0.0, first, *steady))[1]) for t in knots), default=0.0))
    if most == 0.0:
        return np.inf
    least = 1e-9 * most
    limit = after + LONGEST * abs(last - first) / most
    ends = [float(k) for k in knots if k > 0] + [limit]
    begun = [one.begun(0.0, size * first, 0.0) for size, one in lagging]
    t, state = 0.0, np.array([0.0, first, *begun])
    for end in ends:
        watched = (reached, hangs) if end == limit else (reached,)
        run = solve_ivp(gained, (t, end), state, "LSODA", rtol=1e-8, atol=1e-10 * max(abs(last), 1.0), events=watched)
        if len(run.t_events[0]):
            return float(run.t_events[0][0])
        if run.status == 1:
            return float(np.inf)
        t, state = end, run.y[:, -1]
    return float(np.inf)
