"""What a colleague would say about the question asked."""

from __future__ import annotations

from fractions import Fraction

from trunnion.analyses.kinetostatics.chain import Chain, Link
from trunnion.analyses.kinetostatics.elastic import Drive
from trunnion.analyses.kinetostatics.supports import Supports
from trunnion.driveline.elements import Ratio
from trunnion.errors import InputError
from trunnion.results.finding import Finding, Gravity

NEAR_RESONANCE = 1 / 3
"""Excitation frequency over the lowest elastic frequency up to which inertia torques count as quasi-static."""


def remarks(
    chain: Chain, drive: Drive, rigid: bool, supports: Supports | None, turns: int
) -> tuple[Finding, ...]:
    """Findings about a result, gravest first where it matters."""
    found = []
    if drive.inertia:
        found += _resonance(chain, drive, rigid)
    found += _repeats(chain, turns)
    if supports is not None:
        found += [
            Finding(
                Gravity.NOTE,
                f"{name} lies between two shafts of two bearings each and is taken to carry no force: what it "
                "carries depends on how well they line up",
            )
            for name in supports.idle
        ]
    return tuple(found)


def _resonance(chain: Chain, drive: Drive, rigid: bool) -> list[Finding]:
    """Whether the fastest excitation stays well below the lowest elastic frequency."""
    from trunnion.analyses.natural_frequencies import natural_frequencies

    orders = {Link.HOOKE: 2, Link.TRIPOD: 3}
    rates = [orders[chain.steps[i].link] * abs(chain.mean_ratio(i)) for i in chain.of(*orders)]
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
    torque = "inertia torques of the rigid line" if rigid else "quasi-static inertia torques"
    if excitation < lowest:
        grave, share = Gravity.CAUTION, (excitation / lowest) ** 2
        effect = f"they are too small by some {100 * share / (1 - share):.0f} % of themselves"
    else:
        grave, effect = Gravity.DANGER, "they have nothing to do with what happens"
    return [
        Finding(
            grave,
            f"{torque} do not hold at this speed: the joints excite at {excitation:.4g} rad/s, the lowest "
            f"elastic natural frequency is {lowest:.4g} rad/s (trusted up to a third of it), so {effect}; ask "
            "stability() for the linear response",
        )
    ]


def _repeats(chain: Chain, turns: int) -> list[Finding]:
    """Whether the turns asked for cover a whole period of a line with ratios."""
    ratio = {i: Fraction(1) for i in range(len(chain.steps))}
    exact = {n: e for n, e in zip(chain.line.names, chain.line.elements, strict=True) if isinstance(e, Ratio)}
    for i, step in enumerate(chain.steps[1:], start=1):
        ratio[i] = ratio[step.parent] / (exact[step.name].fraction if step.link is Link.RATIO else 1)
    after = [i for i in chain.joints if ratio[i] != 1]
    # a joint repeats after half a turn of its own shaft
    period = 1
    for i in after:
        period = _common(period, Fraction(1) / (2 * abs(ratio[i])))
    if turns % period == 0:
        return []
    return [
        Finding(
            Gravity.NOTE,
            f"behind a Ratio the motion repeats after {period} turns of the input, not after {turns}: extremes "
            f"and means are those of the turns shown (turns={period} shows all)",
        )
    ]


def _common(whole: int, turns: Fraction) -> int:
    """Fewest whole input turns that are also a multiple of ``turns``."""
    period = turns.numerator // turns.denominator if turns.denominator == 1 else turns.numerator
    from math import lcm

    return lcm(whole, period)
