"""Places of a line that pickups stand at, and how fast they turn."""

from __future__ import annotations

from trunnion.equations.coefficients import Assembly

INPUT = "input"
"""The input of a line: of one that is driven at its own speed it turns evenly."""


def speed_ratios(assembly: Assembly) -> dict[str, float]:
    """Turns for one of the input, signed, of every disk and every point that moves, and of the ``INPUT``."""
    topo, names = assembly.topology, assembly.line.names
    found = {INPUT: 1.0}
    found |= {names[element]: float(topo.speed_ratio[station]) for station, element in topo.disks}
    return found | {name: float(topo.speed_ratio[station]) for station, name in topo.points}


def even_places(assembly: Assembly) -> tuple[str, ...]:
    """Those that turn evenly: what is held at the driven end."""
    if assembly.topology.free:
        return ()
    moves = {name for _, name in assembly.topology.points}
    return tuple(name for name in speed_ratios(assembly) if name not in moves)
