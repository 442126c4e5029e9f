"""What a colleague would say about the question asked."""

from __future__ import annotations

from collections.abc import Mapping

from trunnion.arrays import Array
from trunnion.driveline.gears import GearPair
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.quantities import DEGREE
from trunnion.errors import InputError
from trunnion.features import left_out
from trunnion.response.kinetostatics.chain import KinematicChain
from trunnion.response.kinetostatics.motion import Drive
from trunnion.response.kinetostatics.supports import Supports
from trunnion.results.finding import Finding, Gravity
from trunnion.results.words import Words

NEAR_RESONANCE = 1 / 3
"""Excitation over lowest elastic frequency up to which inertia torques count as quasi-static."""


def remarks(
    chain: KinematicChain, drive: Drive, rigid: bool, supports: Supports | None, turns: int, twist: Mapping[int, Array]
) -> tuple[Finding, ...]:
    """Findings about a result, gravest first where it matters; ``twist`` as ``elastic.solve`` gives it."""
    found = []
    if drive.inertia:
        found += _resonance(chain, drive, rigid)
    found += _repeats(chain, turns)
    found += left_out("kinetostatics", chain.line)
    found += _meshes(chain)
    found += _stages(chain, twist)
    if supports is not None:
        found += [
            Finding(
                Gravity.NOTE,
                f"{name} lies between two shafts of two bearings each and is taken to carry no force: what "
                "it carries depends on how well they line up",
            )
            for name in supports.idle
        ]
    return tuple(found)


def _resonance(chain: KinematicChain, drive: Drive, rigid: bool) -> list[Finding]:
    """Whether the fastest excitation stays well below the lowest elastic frequency."""
    from trunnion.modes.natural_frequencies import natural_frequencies

    rates = [float(max(step.orders) * abs(step.speed)) for step in chain.steps if step.orders]
    if not rates:
        return []
    try:
        elastic = natural_frequencies(chain.line).elastic
    except InputError as error:
        sentence = f"how near the inertia torques are to a resonance cannot be told: {error}"
        return [Finding(Gravity.NOTE, sentence)]
    if not len(elastic):
        return []
    lowest, excitation = float(elastic[0]), max(rates) * drive.speed
    if excitation <= NEAR_RESONANCE * lowest:
        return []
    show = Words(speed_unit(chain.line)).of_frequencies.rounded
    torque = "inertia torques of the rigid line" if rigid else "quasi-static inertia torques"
    if excitation < lowest:
        grave, share = Gravity.CAUTION, (excitation / lowest) ** 2
        effect = f"they are too small by some {100 * share / (1 - share):.0f} % of themselves"
    else:
        grave, effect = Gravity.DANGER, "they have nothing to do with what happens"
    return [
        Finding(
            grave,
            f"{torque} do not hold at this speed: the joints excite at {show(excitation)}, the lowest "
            f"elastic natural frequency is {show(lowest)} (trusted up to a third of it), so {effect}; "
            "ask stability() for the linear response",
        )
    ]


def _meshes(chain: KinematicChain) -> list[Finding]:
    """Gear pairs, which a turn takes as rigid pairs in contact."""
    words = {
        "mesh_stiffness": "the mesh's yielding",
        "total_backlash": "backlash",
        "impact_damping": "impact damping",
        "transmission_error": "transmission error",
        "stiffness_variation": "stiffness variation",
    }
    return [
        Finding(
            Gravity.NOTE,
            f"{name} is taken as a rigid pair in contact: {', '.join(w for k, w in words.items() if getattr(e, k))} "
            "left out; ask periodic_response() or simulate() for what that does",
        )
        for name, e in zip(chain.line.names, chain.line.elements, strict=True)
        if isinstance(e, GearPair)
    ]


def _stages(chain: KinematicChain, twist: Mapping[int, Array]) -> list[Finding]:
    """Shafts that change their stage within the turn."""
    found = []
    for i, jet in twist.items():
        step = chain.steps[i]
        if step.stages is None:
            continue
        knots, slopes = step.stages.knots[0], step.stages.slopes[0]
        low, high = float(jet[0].min()), float(jet[0].max())
        crossed = [knot for knot in knots if low < knot < high]
        play = any(
            slope == 0 and low <= a and b <= high for slope, a, b in zip(slopes[1:-1], knots, knots[1:], strict=False)
        )
        if play:
            sentence = (
                f"the torque in {step.name} reverses within the turn: it crosses its free play, which takes time that "
                "a quasi-static turn does not have; ask simulate() or periodic_response() for the motion"
            )
            found.append(Finding(Gravity.CAUTION, sentence))
        elif crossed:
            angles = ", ".join(f"{knot / DEGREE:.4g} deg" for knot in crossed)
            sentence = (
                f"{step.name} changes its stage within the turn, at a twist of {angles}: speeds behind it step there, "
                "and the largest acceleration given is that beside the steps"
            )
            found.append(Finding(Gravity.NOTE, sentence))
    return found


def _repeats(chain: KinematicChain, turns: int) -> list[Finding]:
    """Whether the turns asked for cover a whole period of a line with ratios."""
    period = chain.turns
    if turns % period == 0:
        return []
    return [
        Finding(
            Gravity.NOTE,
            f"behind a Ratio the motion repeats after {period} turns of the input, not after {turns}: "
            f"extremes and means are those of the turns shown (turns={period} shows all)",
        )
    ]
