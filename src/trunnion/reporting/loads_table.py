"""What drives and what resists in the report that is handed in: the law of every torque over speed, its mean, and the
slope with which it damps what swings about that."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.elements import Rotor
from trunnion.driveline.machines import Consumer, ElectricMachine, Generator, Motor, Propeller
from trunnion.driveline.quantities import DAMPING, POWER, QUADRATIC, SPEED, TORQUE, QuantityKind, shown
from trunnion.equations.loads import own_loads
from trunnion.errors import InputError
from trunnion.reporting.submission_contents import SubmissionContents
from trunnion.reporting.tables import Table, four
from trunnion.results.words import HERTZ, Words

STATED = (
    ("load_torque", TORQUE, ""),
    ("viscous_load", DAMPING, " by the speed"),
    ("quadratic_load", QUADRATIC, " by its square"),
)
"""Keys of powers of the speed, and how the sheet says them."""


def loads(contents: SubmissionContents) -> Table:
    """Every disk and machine whose torque is not nothing, at the operating speed, or at the highest one."""
    seen, assembly = contents.seen, contents.seen.assembly
    speed, words = seen.speed or seen.speed_range[1], Words(seen.unit)
    topo, column, table = assembly.topology, assembly.packed.column, assembly.table(1, speed)
    try:
        means = own_loads(topo, column, table)[0]
    except InputError:  # beyond a curve
        return Table((), ())
    rows: list[dict[str, str]] = []
    names: list[list[str]] = []
    for (station, place), (name, rotor), torque in zip(topo.disks, topo.rotors, means, strict=True):
        turning = speed * abs(float(topo.mean_speeds[station]))

        def number(key: str, place: int = place) -> Array:
            return np.asarray(table[:, column(place, key)])

        slope = float(np.asarray(rotor.load_of(number).slope(np.array([turning])))[0])
        if isinstance(rotor, Motor) and rotor.set:
            slope = float(np.asarray(rotor.set_slope(number, np.array([-torque])))[0])
        law = "; ".join(_law(rotor))
        if not (law or torque or slope):
            continue
        lag = rotor.lag_frequency if isinstance(rotor, ElectricMachine) else None
        row = {
            "torque over speed": law,
            f"at {words.speed(speed)} [N m]": four(float(torque)),
            "slope [N m s/rad]": four(slope),
            "lags above": "–" if lag is None else f"{four(lag * HERTZ.factor)} Hz",
        }
        if rows and row == rows[-1]:  # the throws of an engine
            names[-1].append(name)
        else:
            rows.append(row)
            names.append([name])
    kept = [key for key in (rows[0] if rows else ()) if key != "lags above" or any(row[key] != "–" for row in rows)]
    called = [one[0] if len(one) == 1 else f"{one[0]} and {len(one) - 1} alike" for one in names]
    return Table.of(
        {"element": name, **{key: row[key] for key in kept}} for name, row in zip(called, rows, strict=True)
    )


def _law(rotor: Rotor) -> Iterator[str]:
    """How its torque is stated."""

    def of(key: str, kind: QuantityKind) -> str:
        return shown(float(getattr(rotor, key)), kind, digits=4)

    if isinstance(rotor, ElectricMachine) and rotor.breakdown_torque is not None:
        slip, synchronous = four(float(rotor.breakdown_slip or 0.0)), of("synchronous_speed", SPEED)
        yield f"Kloss, {of('breakdown_torque', TORQUE)} at the slip {slip}, {synchronous} without slip"
    if isinstance(rotor, ElectricMachine) and rotor.gain is not None:
        limit = "" if rotor.torque_limit is None else f", at most {of('torque_limit', TORQUE)}"
        yield f"controller of {of('gain', DAMPING)}{limit}"
    if isinstance(rotor, Generator) and rotor.power is not None:
        yield f"{of('power', POWER)} at any speed"
    if points := getattr(rotor, "curve", ()):
        yield f"curve of {len(points)} points"
    if isinstance(rotor, Consumer) and rotor.rated_power is not None:
        yield f"{of('rated_power', POWER)} at {of('rated_speed', SPEED)}, by the square of the speed"
    for key, kind, by in STATED:
        if getattr(rotor, key, 0.0):
            yield f"{of(key, kind)}{by}"
    if isinstance(rotor, Propeller) and rotor.damping_factor is not None:
        yield f"its slope {four(float(rotor.damping_factor))} times torque over speed"
    if share := getattr(rotor, "drive_share", 0.0):
        yield f"drives by the share {four(float(share))}"
