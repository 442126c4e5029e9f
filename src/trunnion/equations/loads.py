"""Outer torques of a line, and how drives balance them where no speed is prescribed.

A station of speed ratio R carries the torque M(ω) = M₀ + c₁ω + c₂ω|ω| against its mean sense of rotation. Of a
machine whose torque is another curve this is the tangent at its mean speed |R|Ω. At the mean input speed Ω of a
free–free line the powers M_s(|R_s|Ω)|R_s|Ω must add up to nothing; where disks have a ``drive_share``, each carries its
share of what is left as a constant torque, a motor with the slope that it has where it carries it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.elements import Disk, Loaded, Rotor
from trunnion.driveline.machines import ElectricMachine, Motor
from trunnion.driveline.parts import Numbers
from trunnion.driveline.quantities import SPEED, TORQUE, shown
from trunnion.equations.gear_losses import LostTorques, lost_torques
from trunnion.equations.line_coefficients import TorqueLag
from trunnion.equations.topology import Topology
from trunnion.errors import InputError
from trunnion.laws.torque_curve import PowerCurve

Column = Callable[[int, str], int]
STATED = ("load_torque", "viscous_load", "quadratic_load")
"""What a disk states of its load: constant, by the speed and by its square."""


@dataclass(frozen=True)
class StationLoads:
    """Per case and station: constant [N m], viscous [N m s/rad] and quadratic [N m s²/rad²] torque that resists.

    ``constant`` includes what the drives carry; ``lags``: parts of ``viscous`` that lag.
    """

    constant: Array
    viscous: Array
    quadratic: Array
    lags: list[TorqueLag] = field(default_factory=list)


def station_loads(topo: Topology, column: Column, table: Array) -> StationLoads:
    """The loads at every row of packed numbers (cases, columns), drives balanced at the speed in column 0.

    Raises
    ------
    InputError : a speed beyond the curve of a machine; a motor that would have to carry more than it can.
    """
    loads = _resisting(topo, column, table)
    if topo.free and (share := given_shares(topo, column, table)).any():
        torque = _carried_by(topo, share, loads, table[:, 0])
        loads = replace(loads, constant=loads.constant + torque)
        _put_slopes(topo, column, table, loads, torque / np.where(share > 0, share, 1.0))
    return loads


def gear_losses(topo: Topology, column: Column, table: Array) -> LostTorques:
    """What gears lose at every row of packed numbers (cases, columns), drives balanced."""
    return _lost(topo, column, table, _described(topo, column, table))


def _resisting(topo: Topology, column: Column, table: Array) -> StationLoads:
    """As described, and what gears lose."""
    loads = _described(topo, column, table)
    if not (topo.rubs or topo.drags):
        return loads
    return replace(loads, constant=loads.constant + _lost(topo, column, table, loads).resists)


def _lost(topo: Topology, column: Column, table: Array, loads: StationLoads) -> LostTorques:
    share = given_shares(topo, column, table) if topo.free else np.zeros(0)

    def carried(lost: Array) -> Array:
        resisting = replace(loads, constant=loads.constant + lost)
        felt = mean_load(topo, resisting, table[:, 0])
        return felt + _carried_by(topo, share, resisting, table[:, 0]) if share.any() else felt

    return lost_torques(topo, column, table, carried)


def _carried_by(topo: Topology, share: Array, loads: StationLoads, speed: Array) -> Array:
    """Loads (case, station) [N m], negative, of drives that carry all others by their ``share`` (case, station)."""
    if topo.rigid_count > 1:
        return _balancing(topo, share, loads, speed)
    return drive_torques(topo, share, mean_load(topo, loads, speed) @ np.abs(topo.mean_speeds))


def _described(topo: Topology, column: Column, table: Array) -> StationLoads:
    loads = StationLoads(*np.zeros((3, len(table), len(topo.stations))))
    for station, lost in topo.lost:
        loads.constant[:, station] += lost
    plain = _plain(topo, column)
    if plain:
        stations, columns = zip(*plain.values(), strict=True)
        for into, of_all in zip(
            (loads.constant, loads.viscous, loads.quadratic), zip(*columns, strict=True), strict=True
        ):
            _add_up(into, stations, table[:, of_all])
    for k, ((station, place), (name, rotor)) in enumerate(zip(topo.disks, topo.rotors, strict=True)):
        if k in plain:
            continue
        load = rotor.load_of(_numbers(column, table, place))
        turning = table[:, 0] * abs(topo.mean_speeds[station])
        if not isinstance(load, PowerCurve):
            known = np.isfinite(turning)
            value, slope = load.value(turning), np.where(known, load.slope(turning), 0.0)
            if np.isnan(value[known]).any():
                raise _beyond(name, load.range, turning[known & np.isnan(value)])
            load = PowerCurve(value - slope * np.where(known, turning, 0.0), slope)
            _note_lag(loads, station, rotor, _numbers(column, table, place), slope)
        loads.constant[:, station] += load.constant
        loads.viscous[:, station] += load.viscous
        loads.quadratic[:, station] += load.quadratic
    return loads


def _add_up(into: Array, stations: Sequence[int], values: Array) -> None:
    """Add ``values`` (case, rotor) to those (case, station) of their ``stations``, several of which may be one."""
    if len(set(stations)) == len(stations):
        into[:, stations] += values
    else:
        np.add.at(into.T, np.array(stations), values.T)


def _plain(topo: Topology, column: Column) -> dict[int, tuple[int, tuple[int, ...]]]:
    """Of rotors that resist by what they state and no more: station, and columns of the three; they are read at once,
    as most of a long line are such."""
    return {
        k: (station, tuple(column(place, key) for key in STATED))
        for k, ((station, place), (_, rotor)) in enumerate(zip(topo.disks, topo.rotors, strict=True))
        if isinstance(rotor, Loaded)
        and type(rotor).load_of is Loaded.load_of
        and type(rotor).resistance is Loaded.resistance
    }


def _note_lag(loads: StationLoads, station: int, rotor: Rotor, number: Numbers, slope: Array) -> None:
    if isinstance(rotor, ElectricMachine) and (corner := rotor.corner(number)) is not None:
        loads.lags.append(TorqueLag(station, slope, np.broadcast_to(corner, slope.shape)))


def _numbers(column: Column, table: Array, place: int) -> Numbers:
    """The numbers of an element at every row (case,)."""
    return lambda key: table[:, column(place, key)]


def _beyond(name: str, reach: tuple[float, float], speeds: Array) -> InputError:
    asked = shown(float(speeds[0]), SPEED, "rpm", 5)
    covers = " to ".join(shown(end, SPEED, "rpm", 5) for end in reach)
    return InputError(
        f"is a curve from {covers}, which does not cover {asked} of its shaft", element=name, key="curve",
        remedy="add points, or narrow the range of speeds",
    )  # fmt: skip


def curve_ends(topo: Topology, column: Column, table: Array) -> Iterator[tuple[str, float, float]]:
    """Of every machine with a curve of torque over speed its name, and the input speeds [rad/s] where that begins and
    ends, in the first row of ``table``."""
    for (station, place), (name, rotor) in zip(topo.disks, topo.rotors, strict=True):
        load, ratio = rotor.load_of(_numbers(column, table[:1], place)), abs(float(topo.mean_speeds[station]))
        if ratio and not isinstance(load, PowerCurve):
            yield name, load.range[0] / ratio, load.range[1] / ratio


def _put_slopes(topo: Topology, column: Column, table: Array, loads: StationLoads, by_share: Array) -> None:
    """Add the slopes of motors that carry their share, ``by_share`` times it (case, station) [N m]; their torque at the
    mean speed stays."""
    for (station, place), (name, motor) in zip(topo.disks, topo.rotors, strict=True):
        if not isinstance(motor, Motor) or not motor.set:
            continue
        number, known = _numbers(column, table, place), np.isfinite(table[:, 0])
        torque = np.where(known, -by_share[:, station] * number("drive_share"), 0.0)
        slope = np.asarray(motor.set_slope(number, torque))
        if np.isnan(slope).any():
            raise _too_much(name, motor, torque[np.isnan(slope)], table[np.isnan(slope), 0])
        slope = np.where(known, slope, 0.0)
        _note_lag(loads, station, motor, number, slope)
        loads.viscous[:, station] += slope
        loads.constant[:, station] -= slope * np.where(known, table[:, 0] * abs(topo.mean_speeds[station]), 0.0)


def _too_much(name: str, motor: Motor, torque: Array, speed: Array) -> InputError:
    worst = int(np.abs(torque).argmax())
    key, most = motor.most or ("", 0.0)
    at = shown(float(speed[worst]), SPEED, "rpm", 5)
    return InputError(
        f"would have to drive with {shown(float(torque[worst]), TORQUE, digits=5)} at {at} of the input, more than its "
        f"{key.replace('_', ' ')}", element=name, key=key, value=most,
        remedy="raise it, lower the load, or narrow the range of speeds",
    )  # fmt: skip


def refuse_curves(topo: Topology, remedy: str) -> None:
    """Refuse machines whose torque is taken by its tangent, where the speed changes.

    Raises
    ------
    InputError : so.
    """
    for name, rotor in topo.rotors:
        if rotor.tangent:
            raise InputError(
                "has a torque over speed that equations of motion take by its tangent at one speed, and the speed "
                "changes here", element=name, key="curve", remedy=remedy,
            )  # fmt: skip


def _of_disks(topo: Topology, column: Column, table: Array, key: str) -> Array:
    """One number of those disks and machines that state it, added up by station (case, station)."""
    found = np.zeros((len(table), len(topo.stations)))
    stating = [(station, at) for station, place in topo.disks if (at := column(place, key)) >= 0]
    if stating:
        _add_up(found, [station for station, _ in stating], table[:, [at for _, at in stating]])
    return found


def accelerating_loads(
    topo: Topology, column: Column, row: Array, inertia: Array, acceleration: float
) -> tuple[Array, Array, Array]:
    """Loads (station,) that do not go with a station's own speed, while drives with a share keep a free line at a
    prescribed input speed Ω and ``acceleration`` [rad/s²]: constant [N m], and what the drives add by Ω and by Ω².

    The drives carry the loads at their mean speeds and what accelerates the ``inertia`` (station,), were it rigid.
    """
    table, turning = row[None], np.abs(topo.mean_speeds)
    loads, share = _described(topo, column, table), given_shares(topo, column, table)
    needed = (
        loads.constant @ turning + acceleration * (inertia @ turning**2),
        loads.viscous @ turning**2,
        loads.quadratic @ turning**3,
    )
    constant, by_speed, by_square = (drive_torques(topo, share, torque)[0] for torque in needed)
    return loads.constant[0] + constant, by_speed, by_square


def load_at_input(topo: Topology, column: Column, table: Array) -> Array:
    """Torque [N m] at the input (case,) that the loads ask for at the speed in column 0, and that drives with a share
    carry between them."""
    return np.asarray(mean_load(topo, _resisting(topo, column, table), table[:, 0]) @ np.abs(topo.mean_speeds))


def mean_load(topo: Topology, loads: StationLoads, speed: Array) -> Array:
    """Torque [N m] of every station (case, station) where it turns at its mean speed |R|Ω.

    A load that does not depend on the speed is known without one (``speed`` NaN).
    """
    turning = np.abs(topo.mean_speeds) * np.asarray(speed)[:, None]
    by_speed = (loads.viscous + loads.quadratic * turning) * turning
    return np.asarray(loads.constant + np.where((loads.viscous != 0) | (loads.quadratic != 0), by_speed, 0.0))


def own_loads(topo: Topology, column: Column, table: Array) -> Array:
    """Mean torques (case, rotor) [N m] that disks and machines resist with, their shares of the drive in them."""
    found = np.zeros((len(table), len(topo.disks)))
    plain = {} if topo.free and given_shares(topo, column, table).any() else _plain(topo, column)
    for k, (_, place) in enumerate(topo.disks):
        if k not in plain:
            found[:, k] = own_load(topo, column, table, place)
    if plain:
        places, (stations, columns) = list(plain), zip(*plain.values(), strict=True)
        constant, viscous, quadratic = (table[:, of_all] for of_all in zip(*columns, strict=True))
        turning = table[:, :1] * np.abs(topo.mean_speeds[list(stations)])
        by_speed = (viscous + quadratic * np.abs(turning)) * turning
        found[:, places] = constant + np.where((viscous != 0) | (quadratic != 0), by_speed, 0.0)
    return found


def own_load(topo: Topology, column: Column, table: Array, place: int) -> Array:
    """Mean torque (case,) [N m] that the element at a place of the line resists with, its share of the drive in it."""
    own, driven = _own_and_driven(topo, column, table, place)
    return np.asarray(own + driven)


def exciting_load(topo: Topology, column: Column, table: Array, place: int, asked: Callable[[], Array]) -> Array:
    """The same, as tables and shares of its excitation go by it; ``asked()``: ``load_at_input`` of the table.

    Cylinders that drive by a share do so whatever else hangs on their throw: of these it is that share alone.
    """
    rotor = next(rotor for (_, i), (_, rotor) in zip(topo.disks, topo.rotors, strict=True) if i == place)
    own, driven = _own_and_driven(topo, column, table, place, asked)
    if not (isinstance(rotor, Disk) and (rotor.firing_angles or rotor.part_of is not None)):
        return np.asarray(own + driven)
    return np.asarray(np.where(table[:, column(place, "drive_share")] > 0, driven, own + driven))


def _own_and_driven(
    topo: Topology, column: Column, table: Array, place: int, asked: Callable[[], Array] | None = None
) -> tuple[Array, Array]:
    """What an element resists with by itself, and minus what it drives with by its share (case,) [N m]."""
    station, rotor = next((s, rotor) for (s, i), (_, rotor) in zip(topo.disks, topo.rotors, strict=True) if i == place)
    turning = table[:, 0] * abs(topo.mean_speeds[station])
    found = rotor.load_of(_numbers(column, table, place))
    by_speed = not isinstance(found, PowerCurve) or np.any(found.viscous) or np.any(found.quadratic)
    own = np.broadcast_to(found.value(turning if by_speed else np.zeros_like(turning)), turning.shape)
    if topo.free and (at := column(place, "drive_share")) >= 0 and table[:, at].any():
        share = given_shares(topo, column, table)
        load = load_at_input(topo, column, table) if asked is None else asked()
        torque = drive_torques(topo, share, load)[:, station]
        return np.asarray(own), torque * table[:, at] / np.where(share[:, station] > 0, share[:, station], 1.0)
    return np.asarray(own), np.zeros_like(turning)


def mean_loads(topo: Topology, column: Column, table: Array) -> Array:
    """The same of every row of packed numbers (cases, columns), drives balanced."""
    return mean_load(topo, station_loads(topo, column, table), table[:, 0])


def load_slope(topo: Topology, viscous: Array, quadratic: Array, speed: Array) -> Array:
    """Slope c₁ + 2c₂|ω| of every station's load by its speed [N m s/rad], (case, station), at its mean speed."""
    turning = np.abs(topo.mean_speeds) * np.asarray(speed)[:, None]
    return np.asarray(viscous + np.where(quadratic != 0, 2 * quadratic * turning, 0.0))


def given_shares(topo: Topology, column: Column, table: Array) -> Array:
    """The shares as described, (case, station)."""
    return _of_disks(topo, column, table, "drive_share")


def drive_torques(topo: Topology, share: Array, torque: Array) -> Array:
    """Loads (case, station) [N m], negative, of drives that together put ``torque`` (case,) on the input.

    ``share`` (case, station) is relative: each takes its part of the power.
    """
    total = share.sum(axis=1, keepdims=True)
    part = share / np.where(total > 0, total, np.nan)
    return np.asarray(-part * np.asarray(torque)[:, None] / np.abs(topo.mean_speeds))


def _balancing(topo: Topology, share: Array, loads: StationLoads, speed: Array) -> Array:
    """The same where shafts can turn against each other, as those of a planetary set of which none is held: torques of
    the drives that balance the loads in all rigid motions, their powers as near to the shares as that leaves.

    Σ P²/share is least, which for one rigid motion gives each drive its share.
    """
    felt = mean_load(topo, loads, speed)
    turning, found = np.abs(topo.mean_speeds), np.zeros_like(share)
    moved = topo.turning @ topo.rigid * np.sign(topo.mean_speeds)[:, None]
    for case, weight in enumerate(share):
        drives = np.flatnonzero((weight > 0) & (turning > 0))
        by_power = moved[drives] / turning[drives, None]
        root = np.sqrt(weight[drives])
        power = root * np.linalg.lstsq((by_power * root[:, None]).T, -(felt[case] @ moved), rcond=None)[0]
        found[case, drives] = power / turning[drives]
    return found


def drive_places(topo: Topology, column: Column, table: Array) -> Array:
    """Shares (case, station) of whatever else a drive must give to keep the speed.

    The given shares; without any, motors, and disks that drive (a negative load_torque) by their power; without any,
    the first disk.
    """
    share = given_shares(topo, column, table)
    driving = np.zeros_like(share)
    for (station, place), (_, rotor) in zip(topo.disks, topo.rotors, strict=True):
        driving[:, station] += _drives(rotor, _numbers(column, table, place))
    driving *= np.abs(topo.mean_speeds)
    first = np.zeros_like(share)
    first[:, topo.disks[0][0] if topo.disks else 0] = 1.0
    share = np.where(share.any(axis=1, keepdims=True), share, driving)
    return np.where(share.any(axis=1, keepdims=True), share, first)


def _drives(rotor: Rotor, number: Numbers) -> Array | float:
    """A measure [N m] of what drives with a torque of its own."""
    if isinstance(rotor, Motor):
        return 1.0
    return np.maximum(-number("load_torque"), 0.0) if isinstance(rotor, Loaded) else 0.0


def static_torque(
    topo: Topology,
    load: Array,
    stiffness: Array | None = None,
    damping: Array | None = None,
    speed: Array | None = None,
) -> Array:
    """Torque in each compliance under the loads [N m], positive with the twist; shape (case, compliance).

    Mean balance of power: a load M at a station of speed ratio R asks for M |R| behind the input, and a
    shaft of speed ratio R_g carries −Σ M |R| / R_g (Hooke's joints pass torque on average unchanged). Round loops
    springs share it by their ``stiffness`` (case, compliance), and what drags by its ``damping``; where their ratios do
    not come out it slips for ever, by the ``speed`` (case,) of the input.
    """
    torque = np.zeros((len(load), len(topo.compliances)))
    if not (load.any() or (topo.graph and topo.apart.any())):
        return torque
    if topo.graph:
        assert stiffness is not None and damping is not None and speed is not None
        return _shared_torque(topo, load, stiffness, damping, speed)
    for e, behind in enumerate(topo.stations_behind):
        own = topo.mean_speeds[topo.reference[topo.compliances[e].far_group]]
        torque[:, e] = load[:, behind] @ (-np.abs(topo.mean_speeds[behind]) / own)
    return torque


def loads_on_unknowns(topo: Topology, load: Array) -> Array:
    """What loads (case, station) put on the unknowns of a straight line [N m] (case, n), against their rotation."""
    return np.asarray((load * np.sign(topo.mean_speeds)) @ topo.turning)


def _shared_torque(topo: Topology, load: Array, stiffness: Array, damping: Array, speed: Array) -> Array:
    """The same where springs or the legs of a differential share the torque of a shaft: in balance for every unknown,
    and round every loop by the stiffness of its springs. What drags carries what no spring does, by steady slip:
    T = c (Δ + E v) of the mismatch Δ and of speeds v at which no spring twists."""
    felt, found, dragged = loads_on_unknowns(topo, load), np.zeros_like(stiffness), list(topo.dragged)
    slips = topo.elongations[dragged] @ topo.loose
    apart = (topo.apart + topo.elongations @ topo.creep)[dragged]
    for case in np.flatnonzero(load.any(axis=1) | topo.apart.any()):
        if dragged:
            c = damping[case, dragged]
            forced = c * apart * (speed[case] if np.isfinite(speed[case]) else 0.0)
            back = -topo.loose.T @ felt[case] - slips.T @ forced
            found[case, dragged] = forced + np.sqrt(c) * np.linalg.lstsq(slips.T * np.sqrt(c), back, rcond=None)[0]
        root = np.sqrt(stiffness[case])
        left = felt[case] + topo.elongations.T @ found[case]
        found[case] += root * np.linalg.lstsq(topo.elongations.T * root, -left, rcond=None)[0]
    return found
