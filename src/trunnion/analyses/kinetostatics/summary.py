"""How a kinetostatic result introduces itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trunnion.analyses.kinetostatics.measures import extremes, largest
from trunnion.driveline.quantities import DEGREE
from trunnion.results.finding import by_gravity
from trunnion.results.speeds import show_speed

if TYPE_CHECKING:
    from trunnion.analyses.kinetostatics.result import Kinetostatics


def summary(result: Kinetostatics, unit: str) -> str:
    """Title, output, torques, couples, supports, findings: one line each."""
    return "\n".join(
        [
            _title(result, unit),
            *(line for name in result.branches for line in _output(result.on_branch(name))),
            *_torques(result),
            *_couples(result),
            *_supports(result),
            *_twists(result),
            *(f"  {finding}" for finding in by_gravity(result.findings)),
        ]
    )


def _title(r: Kinetostatics, unit: str) -> str:
    name = f" of {r.line.name!r}" if r.line.name else ""
    turns = "one turn" if r.turns == 1 else f"{r.turns} turns"
    kind = "rigid shafts" if r.rigid else "elastic shafts, their damping left out"
    return (
        f"kinetostatics{name} over {turns} at {show_speed(r.input_speed, unit)}: {kind}, "
        f"inertia torques {'included' if r.inertia else 'left out'}, {len(r.input_angle)} points"
    )


def _output(r: Kinetostatics) -> list[str]:
    low, high = r.speed_ratio
    output = "output" if len(r.branches) == 1 else f"output {r.branch}"
    if not r.irregularity:
        return [f"  {output} turns uniformly at {low:.5f} of the input speed"]
    return [
        f"  {output} speed over input speed {low:.5f} to {high:.5f}: irregularity {r.irregularity:.5g}, as one "
        f"Hooke's joint of {r.equivalent_angle / DEGREE:.4g} deg",
        f"  {output} leads and lags by {r.homokinetic_deviation / DEGREE:.4g} deg; largest angular "
        f"acceleration {r.peak_acceleration:.5g} rad/s^2",
    ]


def _torques(r: Kinetostatics) -> list[str]:
    if not np.any(r.drive_torque):
        return ["  no torque: no Disk has a load and no output_torque is given"]
    low, high = extremes(r.drive_torque)
    line = f"  drive torque {low:.6g} to {high:.6g} N*m"
    if np.any(r.power_loss):
        line += f"; joint friction leaves an efficiency of {r.efficiency:.5f}"
    return [line]


def _couples(r: Kinetostatics) -> list[str]:
    if not len(r.forks):
        return []
    size = largest(np.hypot(r.secondary_couple[:, 0], r.secondary_couple[:, 1]))
    if not np.any(size > 0):
        return []
    f = int(np.argmax(size))
    part = r.couple_parts(r.forks[f])
    return [
        f"  largest secondary couple {size[f]:.5g} N*m, on the fork {r.forks[f]!r}: "
        f"{np.hypot(*part.steady):.5g} steady, {part.two_per_turn:.5g} twice per turn"
    ]


def _supports(r: Kinetostatics) -> list[str]:
    if r.supports is None:
        return []
    lines = []
    for name in r.supports.names:
        part = r.support_parts(name)
        lines.append(
            f"  bearing {name}: up to {part.largest:.5g} N; {np.hypot(*part.steady):.5g} steady, "
            f"{part.two_per_turn:.5g} twice per turn"
        )
    return lines


def _twists(r: Kinetostatics) -> list[str]:
    constant = r.constant_twist
    if constant is None or not np.any(r.twist):
        return []
    s = int(np.argmax(largest(r.twist)))
    return [
        f"  largest twist {largest(r.twist)[s]:.4g} rad in {r.shafts[s]}, varying by ± "
        f"{100 * constant.variation[s]:.3g} % of its mean over the turn; taken as constant, the output speed "
        f"is off by {constant.speed / r.input_speed:.2g} of the input speed"
    ]
