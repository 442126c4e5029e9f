"""A kinetostatic result against limits: one pass-or-fail sentence each."""

from __future__ import annotations

import numpy as np

from trunnion.driveline.quantities import ANGLE, DEGREE, TORQUE, QuantityKind, parse
from trunnion.errors import InputError
from trunnion.response.kinetostatics.measures import largest
from trunnion.response.kinetostatics.result import Kinetostatics
from trunnion.results.finding import Finding, Gravity

EVEN_RUNNING = 0.0027
"""Irregularity that makers of cardan shafts allow for quiet running: one Hooke's joint of 2.98°."""


def check_limits(
    result: Kinetostatics,
    *,
    irregularity: float | None = EVEN_RUNNING,
    output_acceleration: float | None = None,
    shaft_acceleration: float | None = None,
    deviation: float | str | None = None,
    secondary_couple: float | str | None = None,
    support_force: float | None = None,
) -> tuple[Finding, ...]:
    """Whether ``result`` keeps each limit that is given, at the end of every branch; failures first.

    Parameters
    ----------
    result : of ``kinetostatics``.
    irregularity : of the output [-]; the default is the guideline of cardan-shaft makers, None leaves it out.
    output_acceleration, shaft_acceleration : largest angular acceleration [rad/s²] of the output (which
        shakes what it drives) and of any shaft in between (whose inertia shakes its neighbours). Makers'
        catalogues give values for their class of vehicle.
    deviation : largest lead or lag of the output [rad].
    secondary_couple : on any fork [N m].
    support_force : on any bearing [N].

    Examples
    --------
    >>> import trunnion as tn
    >>> shaft = tn.Shaft(stiffness=1e4, damping=2.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=0.05), shaft, tn.Disk(inertia=0.8)])
    >>> for finding in tn.check_limits(tn.kinetostatics(line, speed=100.0), output_acceleration=50.0):
    ...     print(finding)
    note: pass: irregularity of the output 0.002501 keeps the limit of 0.0027
    note: pass: angular acceleration of the output 25.01 rad/s² keeps the limit of 50 rad/s²
    """
    even, jerk = _limit("irregularity", irregularity), _limit("output_acceleration", output_acceleration)
    lag = _limit("deviation", deviation, ANGLE)
    checks: list[tuple[str, float, float | None, str]] = []
    for name in result.branches:
        end = result.on_branch(name)
        output = "the output" if len(result.branches) == 1 else f"the output {name}"
        checks += [
            (f"irregularity of {output}", end.irregularity, even, ""),
            (f"angular acceleration of {output}", end.peak_acceleration, jerk, " rad/s²"),
        ]
        if lag is not None:
            behind = end.homokinetic_deviation / DEGREE
            checks.append((f"lead and lag of {output}", behind, lag / DEGREE, " deg"))
    if shaft_acceleration is not None:
        limit = _limit("shaft_acceleration", shaft_acceleration)
        checks += [
            (
                f"angular acceleration of {result.shafts[s]}",
                float(largest(result.acceleration[s])),
                limit,
                " rad/s²",
            )
            for s in range(len(result.shafts))
            if np.any(result.acceleration[s] != result.output_acceleration) and np.any(result.acceleration[s])
        ]
    if secondary_couple is not None:
        sizes = largest(np.hypot(result.secondary_couple[:, 0], result.secondary_couple[:, 1]))
        limit = _limit("secondary_couple", secondary_couple, TORQUE)
        checks += [
            (f"secondary couple on {fork}", float(size), limit, " N m")
            for fork, size in zip(result.forks, sizes, strict=True)
        ]
    if support_force is not None:
        if result.supports is None:
            raise InputError(
                "cannot be checked: the result has no supports",
                key="support_force",
                remedy='ask kinetostatics(..., supports=[("Shaft 1", -0.3, -0.1)])',
            )
        limit = _limit("support_force", support_force)
        checks += [
            (f"force on bearing {name}", result.support_parts(name).largest, limit, " N")
            for name in result.supports.names
        ]
    found = [_sentence(*check) for check in checks if check[2] is not None]
    return tuple(sorted(found, key=lambda finding: finding.gravity))


def _sentence(what: str, value: float, limit: float | None, unit: str) -> Finding:
    assert limit is not None
    if value <= limit:
        return Finding(Gravity.NOTE, f"pass: {what} {value:.4g}{unit} keeps the limit of {limit:.4g}{unit}")
    times = value / limit if limit else np.inf
    return Finding(
        Gravity.CAUTION, f"fail: {what} {value:.4g}{unit} is {times:.3g} times the limit of {limit:.4g}{unit}"
    )


def _limit(key: str, value: float | str | None, kind: QuantityKind | None = None) -> float | None:
    if value is None:
        return None
    try:
        number = parse(value, kind) if kind else float(value)
    except InputError as error:
        raise error.but(key=key, value=value) from None
    except (TypeError, ValueError):
        raise InputError("is not a number", key=key, value=value, remedy="write it in SI units") from None
    if not (np.isfinite(number) and number >= 0):
        raise InputError("must not be negative", key=key, value=value, remedy="write a limit such as 0.0027")
    return number
