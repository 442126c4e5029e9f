"""Which lines turn steadily enough to be linearised, and what the others lack."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.converter_balance import refuse_converters
from trunnion.driveline.engine import Engine
from trunnion.driveline.machines import lagging
from trunnion.driveline.mean_balance import balances_in_words
from trunnion.driveline.operating_speed import runs_by_itself
from trunnion.driveline.vehicle import Tyre
from trunnion.equations.coefficients import Assembly, joint_laws
from trunnion.equations.gear_losses import sliding
from trunnion.equations.graph_matrices import require_fixed_speeds
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.loads import drive_places, gear_losses, given_shares, loads_on_unknowns, mean_loads, own_loads
from trunnion.errors import InputError

BALANCED = 1e-9
"""Torque left over, relative to the torques of all disks and machines together, that counts as none."""


def require_steady_base(assembly: Assembly, table: Array) -> None:
    """Refuse lines that do not turn steadily at the rows of packed numbers ``table`` (cases, columns).

    A free line whose torques do not balance speeds up or slows down.
    """
    require_turning(assembly, table)
    require_balance(assembly, table)


def require_turning(assembly: Assembly, table: Array) -> None:
    """Refuse lines that cannot turn steadily whatever their torques, at the rows of packed numbers ``table`` (cases,
    columns): a far end held at constant speed fights the joints in front of it."""
    topo = assembly.topology
    if sum(topo.prescribed) > 1:
        end = [g for g, fixed in enumerate(topo.prescribed) if fixed][-1]
        element = assembly.line.names[topo.stations[topo.reference[end]].element]
        raise InputError(
            "a second prescribed speed leads nowhere in a stability analysis",
            element=f"ConstantSpeed behind {element}",
            remedy="end the line with a Disk; natural frequencies are available as it is",
        )
    if topo.graph and has_joint_angles(assembly, table):
        require_fixed_speeds(topo, joint_laws(assembly, table), assembly.line.names)


def refuse_periodic_base(assembly: Assembly, remedy: str, *, bends: bool = False) -> None:
    """Refuse a free line with angled joints (or one that an axis ``bends``) linearised about the motion of rigid
    shafts.

    About that motion its rigid-body pair grows, which its periodic steady state does not.
    """
    if assembly.topology.free and (has_joint_angles(assembly) or bends):
        raise InputError(
            "is free–free and has joint angles: it is judged about its own periodic motion, "
            "which is found speed by speed",
            element="driveline",
            remedy=remedy,
        )


def require_own_motion(assembly: Assembly, table: Array) -> None:
    """Refuse lines that turn evenly at all rows of ``table`` to who asks for the periodic motion they make.

    Raises
    ------
    InputError : so.
    """
    if not has_joint_angles(assembly, table):
        raise InputError(
            "has straight joints, and turns with its shafts twisted by its loads alone", element="driveline",
            key="about_steady_state", value=True, remedy="leave it out",
        )  # fmt: skip


def require_no_steady_state(about_steady_state: bool) -> None:
    """Refuse the motion of a driveline to equations of one's own.

    Raises
    ------
    InputError : so.
    """
    if about_steady_state:
        raise InputError("belongs to drivelines", key="about_steady_state", value=True, remedy="leave it out")


def refuse_dragged(assembly: Assembly) -> None:
    """Refuse a line whose motion does not repeat in one way alone, as what a damper alone drags may stand anywhere.

    Raises
    ------
    InputError : so.
    """
    topo = assembly.topology
    for e in topo.dragged:
        place = topo.compliances[e].shafts[0]
        tyre = isinstance(assembly.line.elements[place], Tyre)
        instead = (
            "leave it out, and what belongs to it"
            if tyre
            else 'write stiffness = "1 kN*m/rad", say, that of the oil at the frequency that matters'
        )
        raise InputError(
            f"has no spring, so that its {'vehicle' if tyre else 'ring'} may stand anywhere and no periodic motion is "
            "the only one",
            element=assembly.line.names[place], key="slip_stiffness" if tyre else "stiffness",
            remedy=f"{instead}; tn.simulate and linear analyses take it {'as it is' if tyre else 'without'}",
        )  # fmt: skip


def has_joint_angles(assembly: Assembly, table: Array | None = None) -> bool:
    """Whether any joint is bent, so that the line turns unevenly: as described, or at any row of ``table``."""
    return any(law.nonuniform for law in joint_laws(assembly, assembly.table(1) if table is None else table))


def has_periodic_base(assembly: Assembly, table: Array | None = None) -> bool:
    """Whether the line is free–free and has joint angles, so that it has a periodic motion of its own: as described, or
    at any row of ``table``."""
    return assembly.topology.free and has_joint_angles(assembly, table)


def loaded_by_speed(assembly: Assembly) -> bool:
    """Whether any load of the line depends on the speed."""
    return any(rotor.loaded_by_speed for _, rotor in assembly.topology.rotors)


def require_balance(assembly: Assembly, table: Array) -> None:
    """Refuse a free line whose torques do not add up to nothing at the rows of ``table``, and name them; and legs of a
    differential that the loads would turn against each other."""
    _require_equal_legs(assembly, table)
    left = imbalance(assembly, table)
    worst = int(np.argmax(np.abs(left)))
    if left[worst]:
        raise InputError(
            f"is free–free and its torques do not balance: {torques_in_words(assembly, table[worst])}",
            element="driveline",
            key="load_torque",
            remedy=_remedy(assembly, table[worst], float(left[worst])),
        )


def _require_equal_legs(assembly: Assembly, table: Array) -> None:
    topo = assembly.topology
    if not topo.graph:
        return
    load = mean_loads(topo, assembly.packed.column, table)
    felt, legs = loads_on_unknowns(topo, load), topo.rigid[:, int(topo.free) :]
    left = np.abs(felt @ legs).max(initial=0.0)
    own = own_loads(topo, assembly.packed.column, table)
    if left > BALANCED * np.abs(own).max(initial=0.0) * np.abs(legs).max(initial=0.0):
        raise InputError(
            "drives legs whose loads differ, so that they turn faster and faster against each other",
            element=assembly.line.names[topo.knot], key="load_torque",
            remedy="give both legs the same load behind their own ratios, or one more shaft that drives a drive_share",
        )  # fmt: skip


def require_tree(assembly: Assembly, what: str) -> None:
    """Refuse a line with a differential or a loop, which ``what`` does not follow.

    Raises
    ------
    InputError : so.
    """
    topo = assembly.topology
    refuse_converters(assembly.line, what)
    if topo.graph:
        problem, both = ("ties one shaft to two others", "legs") if topo.sums else ("closes a loop", "ways round")
        own = has_periodic_base(assembly)
        driven = "put a ConstantSpeed in front, take the joints straight, or " if own else ""
        why = ", as a free–free line with joint angles needs them" if own else ""
        raise InputError(
            f"{problem}, which {what} not follow{why}", element=assembly.line.names[topo.knot],
            remedy=f"{driven}take both {both} as one shaft; natural frequencies and order response are available",
        )  # fmt: skip


LONGEST_TIED = 24
"""Unknowns of a line with a differential or a loop up to which its matrices are multiplied by the thousand."""


def refuse_lags(assembly: Assembly, coefficients: LineCoefficients, *, growing: bool) -> None:
    """Refuse a straight line with a torque that lags, which charts and searches for regions would take to follow at
    once, so that the stability of single speeds says something else: how much it decays, and where the torque has to
    make up for what feeds energy in whether it grows. ``growing``: only the second matters.

    Raises
    ------
    InputError : so.
    """
    if not coefficients.lags or (growing and not coefficients.fed):
        return
    has_to = " and has to make up for what feeds energy in" if coefficients.fed else ""
    raise InputError(
        f"has a torque that lags behind the speed{has_to}: charts would take it to follow at once",
        element=lagging(assembly.line.parts)[0],
        key="corner_frequency",
        remedy="ask stability() at single speeds, or assess() over all of them",
    )


def require_short_ties(assembly: Assembly) -> None:
    """Refuse a line with a differential or a loop that is too long for charts and studies of many lines.

    Raises
    ------
    InputError : so.
    """
    topo = assembly.topology
    if topo.graph and topo.size > LONGEST_TIED:
        problem = "ties one shaft to two others" if topo.sums else "closes a loop"
        raise InputError(
            f"{problem} in a line of {topo.size} unknowns, of which charts and studies take {LONGEST_TIED}",
            element=assembly.line.names[topo.knot],
            remedy="join neighbouring parts, or ask stability() at single speeds",
        )


def require_share(assembly: Assembly) -> None:
    """Refuse a free line of which no disk says that it drives: nothing tells what torque accelerates it."""
    topo, table = assembly.topology, assembly.table(1)
    if topo.free and not given_shares(topo, assembly.packed.column, table).any():
        _, element = _driving(assembly, table)
        raise InputError(
            "is free–free, and no disk has a share in what accelerates it",
            element="driveline",
            key="drive_share",
            remedy=f'give the driving disk, "{assembly.line.names[element]}" say, drive_share = 1, in place of '
            "a driving load_torque",
        )


def imbalance(assembly: Assembly, table: Array) -> Array:
    """Torque at the input [N m] (cases,) that a free line lacks to keep its speed; 0 where its torques balance."""
    topo, column = assembly.topology, assembly.packed.column
    if not topo.free or given_shares(topo, column, table).any():
        return np.zeros(len(table))
    torques = _at_input(assembly, table)
    left = torques.sum(axis=1)
    return np.where(np.abs(left) > BALANCED * np.abs(torques).sum(axis=1), left, 0.0)


def torques_in_words(assembly: Assembly, row: Array) -> str:
    """What resists and what drives a free line at one row of packed numbers, without a full stop."""
    torques = _at_input(assembly, row[None])[0]
    names = assembly.line.names
    topo = assembly.topology
    lossy = [topo.compliances[e].shafts[0] for e in topo.converting]
    places = [*(i for _, i in topo.disks), *lossy[: len(topo.lost)], *(rub.element for rub in topo.rubs)]
    places += [i for _, i in topo.drags]
    named = [(names[i], float(torque)) for i, torque in zip(places, torques, strict=True) if torque]
    resist = ", ".join(f"{name} {torque:.5g}" for name, torque in named if torque > 0)
    drive = ", ".join(f"{name} {-torque:.5g}" for name, torque in named if torque < 0)
    at = f" at {row[0] * 30 / np.pi:.5g} rpm" if np.isfinite(row[0]) else ""
    loads = f"the loads add up to {torques[torques > 0].sum():.5g} N m at the input{at}" + (resist and f" ({resist})")
    drives = f"the drives to {-torques[torques < 0].sum():.5g} N m ({drive})"
    return f"{loads} and nothing drives" if not drive else f"{loads}, {drives}"


def carried_at_input(assembly: Assembly, row: Array) -> float:
    """Sum of the mean torques of all disks and machines taken to the input [N m], whatever their sign, at one row."""
    return float(np.abs(_at_input(assembly, row[None])).sum())


def _at_input(assembly: Assembly, table: Array) -> Array:
    """Mean torques of disks and machines taken to the input (cases, rotor) [N m]; behind them what converters lose, and
    what gears do."""
    topo, gears = assembly.topology, np.zeros((len(table), 0))
    if topo.rubs or topo.drags:
        found = gear_losses(topo, assembly.packed.column, table)
        rubs = found.friction * np.abs([sliding(topo, rub) for rub in topo.rubs])
        gears = np.hstack([rubs, found.drag * np.abs(topo.mean_speeds[[station for station, _ in topo.drags]])])
    turning = np.abs(topo.mean_speeds[[station for station, _ in topo.disks]])
    rotors = own_loads(topo, assembly.packed.column, table) * turning
    lost = [torque * abs(topo.mean_speeds[station]) for station, torque in topo.lost]
    return np.hstack([rotors, np.broadcast_to(lost, (len(table), len(lost))), gears])


def _driving(assembly: Assembly, table: Array) -> tuple[int, int]:
    """Station and element of the disk that drives most at the first row of ``table``, or could."""
    place = drive_places(assembly.topology, assembly.packed.column, table)[0]
    return max(assembly.topology.disks, key=lambda pair: float(place[pair[0]]))


def _remedy(assembly: Assembly, row: Array, left: float) -> str:
    topo = assembly.topology
    if runs_by_itself(assembly.line) and (balances := balances_in_words(assembly.line)):
        return f"leave the speed out, so that it runs where they do, at {balances}; or give the motor drive_share = 1"
    engine = next((name for name, one in assembly.line.as_stated.parts if isinstance(one, Engine)), None)
    if engine is not None and not (_at_input(assembly, row[None]) < 0).any():
        return f'give the engine, "{engine}" say, drive_share = 1'
    station, element = _driving(assembly, row[None])
    name = assembly.line.names[element]
    remedy = f'give the driving disk, "{name}" say, drive_share = 1'
    if loaded_by_speed(assembly):
        return remedy  # no constant torque balances at more than one speed
    needed = float(row[assembly.packed.column(element, "load_torque")]) - left / abs(float(topo.speed_ratio[station]))
    return f'{remedy}, or load_torque = "{needed:.10g} N*m"'
