"""S4's claims against computed figures: the ranges of chaos, what refutes them, and its conclusions one by one."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from trunnion.papers.double_tripod.computed import ORDERS_OF_MOTOR, RANGES, ElementCase, exponent_from
from trunnion.papers.double_tripod.contraction import contraction
from trunnion.papers.double_tripod.published import WORST_ANGLE, DoubleTripod
from trunnion.papers.shared.result import (
    AGAINST,
    FOR,
    NEITHER,
    ComparisonTable,
    Conclusion,
    Reading,
    TableRow,
    agreed,
    sign,
)

PARTS = {"input": "DIE1", "output": "DOE3"}
EQUATIONS = {
    ("input", "given"): "(29)", ("input", "own"): "(25)", ("output", "given"): "(30)", ("output", "own"): "(26)"
}  # fmt: skip
START = 1.0
"""A start far beyond any twist of the shaft [rad]."""
WIDTH = 250.0 / 3066.5
"""Range of frequencies over which the paper draws its exponents of DIE1, over 2Ω/2π."""
NOTICED = 0.01
"""Part of itself by which 2Ω must shift over the joint angles to count as varying; the paper has no number."""


def dampings(found: list[ElementCase]) -> ComparisonTable:
    """Every damping ratio of the paper: exponents over its range of frequencies, and the bound of every motion."""
    rows = []
    for case in found:
        low, high = RANGES[case.element]
        verdicts = "; ".join(
            f"{EQUATIONS[case.element, phase]} at 2Ω: {c.verdict}{f', {c.kind}' if c.kind else ''}"
            for phase, c in case.verdicts.items()
        )
        rows.append(
            TableRow(
                f"{PARTS[case.element]}, {low:g}–{high:g} Hz, ζ = {case.damping_ratio:g}",
                case.claimed,
                "no chaos" if case.positive == 0 and case.bound.rate > 0 else f"{case.positive} positive exponents",
                f"largest exponent besides the phase's 0: {case.largest:.4g} 1/s, bound of every motion "
                f"{-case.bound.rate:.4g} 1/s{'; ' + verdicts if verdicts else ''}",
            )
        )
    return ComparisonTable(
        "Ranges of damping for which the paper concludes chaos", tuple(rows),
        "Half of the frequencies even over the range, half within 0.2 % of 2Ω, by the standard definition.",
    )  # fmt: skip


def refuted() -> ComparisonTable:
    """Exponents at 2Ω, ζ = 0.0016: other speeds of the motor, and starts of 1 rad."""
    rows = []
    for order in ORDERS_OF_MOTOR:
        found = {phase: exponent_from("input", phase, order, 0.0) for phase in ("given", "own")}
        said = ", ".join(f"{EQUATIONS['input', phase]} {value:.1f}" for phase, value in found.items())
        rows.append(TableRow(f"DIE1, Ω_AEM = {100 * order}π rad/s", "chaos", f"{said} 1/s", "from rest"))
    for (element, phase), equation in EQUATIONS.items():
        value = exponent_from(element, phase, 6, START)
        remark = f"largest exponent over 1.5 s from φ = {START:g} rad"
        rows.append(TableRow(f"{PARTS[element]} {equation} from {START:g} rad", "chaos", f"{value:.1f} 1/s", remark))
    return ComparisonTable(
        "The same at every speed of the motor, and from far away", tuple(rows),
        "η = 2Ω, ζ = 0.0016; largest exponent besides the phase's 0, over 1.5 s, in which two that lie "
        "close together have not quite sorted. That no case was missed the bound says.",
    )  # fmt: skip


def conclusions(
    found: list[ElementCase],
    opened: Mapping[str, tuple[float, float]],
    beats: Mapping[str, tuple[str, float, int]],
    turning: Mapping[str, Mapping[float, int]],
) -> tuple[Conclusion, ...]:
    """The paper's conclusions; ``beats`` has element, damping ratio and number of beats of each time history, and
    ``turning`` those of an element by frequency [Hz] where the rotation in every cosine turns with half the phase."""
    return (
        _chaos(found),
        _ergodic(found),
        _transition(found),
        _criteria(found),
        *(_beating(element, beats, turning[element]) for element in PARTS),
        _decay(found),
        _range(),
        _literature(),
        _pitting(found),
        _resonance(opened),
    )


def _refutes(case: ElementCase) -> int:
    """Against chaos where no exponent is positive and every two motions approach each other."""
    return AGAINST if case.positive == 0 and case.bound.rate > 0 else NEITHER


def _chaos(found: list[ElementCase]) -> Conclusion:
    readings = [
        Reading(
            f"{PARTS[c.element]}, ζ = {c.damping_ratio:g}, printed χ_n",
            f"largest exponent besides the phase's 0 {c.largest:.3g} 1/s, every two motions approach at "
            f"{c.bound.rate:.3g} 1/s or faster",
            _refutes(c),
        )
        for c in found
        if c.claimed == "chaos"
    ]
    others = {
        "χ_n of its own Appendix B": DoubleTripod(nonuniformity="derived"),
        "Ī of the straight shaft, as it takes it": DoubleTripod(mean_inertia="straight"),
    }
    for words, shaft in others.items():
        rates = [contraction(shaft.system(e), own=False).rate for e in PARTS]
        readings.append(_bounded(f"ζ = 0.0016, {words}", rates))
    own = [contraction(DoubleTripod().system(e, phase="own"), own=True).rate for e in PARTS]
    readings.append(_bounded("ζ = 0.0016, cos 2φ instead of cos Θ, (25) and (26)", own))
    return Conclusion(
        "The motion is chaotic for ζ = 0.0016–0.011 (DIE1, 2950–3200 Hz) and 0.0016–0.0104 (DOE3, 2650–2950 Hz).",
        tuple(readings),
        "By the standard definition no exponent is positive anywhere in these ranges, and by a bound in closed form "
        "none can be.",
    )


def _bounded(name: str, rates: list[float]) -> Reading:
    shown = f"every two motions approach at {rates[0]:.3g} 1/s (DIE1) and {rates[1]:.3g} 1/s (DOE3) or faster"
    return Reading(name, shown, AGAINST if min(rates) > 0 else NEITHER)


def _ergodic(found: list[ElementCase]) -> Conclusion:
    readings = []
    for case in found:
        for phase, certificate in case.verdicts.items():
            regular = certificate.verdict == "regular"
            own = certificate.spectrum.exponents[1 if phase == "given" else 0]
            readings.append(
                Reading(
                    f"{EQUATIONS[case.element, phase]}, ζ = {case.damping_ratio:g}",
                    f"{certificate.kind or certificate.verdict}, largest exponent {own:.3g} 1/s",
                    FOR if regular else NEITHER,
                )
            )
    return Conclusion(
        "For larger damping the motion is “ergodic”.",
        tuple(readings),
        "As every periodic or quasi-periodic motion is, on its own curve or torus. The same holds for the damping "
        "ratios called chaotic; it tells nothing apart.",
    )


def _transition(found: list[ElementCase]) -> Conclusion:
    weak = {e: next(c for c in found if c.element == e) for e in PARTS}
    return Conclusion(
        "It is then in transition to chaos.",
        tuple(
            Reading(
                PARTS[e],
                f"the largest exponent rises with less damping to {c.largest:.3g} 1/s at ζ = {c.damping_ratio:g}",
                _refutes(c),
            )
            for e, c in weak.items()
        ),
        "There is no chaos to go to.",
    )


def _criteria(found: list[ElementCase]) -> Conclusion:
    """(38) and (39) on motions known to be regular: met there, they certify nothing."""
    regular = [c for case in found for c in case.verdicts.values() if c.verdict == "regular" and c.kind != "at rest"]
    readings = []
    for place, name in ((1, "(38), an exponent near 0"), (2, "(39), a negative sum")):
        idle = sum(not c.criteria[place].discriminates for c in regular)
        readings.append(
            Reading(
                name, f"could not have failed on {idle} of {len(regular)} regular motions", -sign(idle == len(regular))
            )
        )
    positive = sum(certificate.criteria[0].holds for certificate in regular)
    return Conclusion(
        "Criteria (38) and (39), added to (37), certify chaos.",
        tuple(readings),
        "A forced system has an exponent 0, a damped one a negative sum. Only (37) tells motions apart; by exponents "
        f"of the standard definition it holds for {positive} of {len(regular)}.",
    )


def _beating(element: str, beats: Mapping[str, tuple[str, float, int]], turning: Mapping[float, int]) -> Conclusion:
    counts = {number: count for number, (which, _, count) in beats.items() if which == element}
    shown = ", ".join(f"{count} in Figure {number}" for number, count in counts.items())
    turned = ", ".join(f"{count} at {hertz:g}" for hertz, count in turning.items())
    equation = EQUATIONS[element, "own"]
    cause = {
        "input": "They are between the natural frequency and the harmonics of the motor's torque.",
        "output": "(26) has no torque in time: read as printed, the mill's harmonics turn with a rotation of 1e-4 rad.",
    }[element]
    return Conclusion(
        f"{PARTS[element]} beats while its start dies out (Figures {min(counts)}–{max(counts)}).",
        (
            Reading(
                f"the rotation itself in every cosine, as {equation} is printed", shown, _all_or_none(counts.values())
            ),
            Reading(
                "a rotation in them that turns with Θ/2, as (27) and (28) have it, at η/2π [Hz], ζ = 0.0016",
                turned,
                _all_or_none(turning.values()),
            ),
        ),
        f"Counted are times that the swing per natural period rises again by more than 2 % of the first. {cause}",
    )


def _all_or_none(counts: Iterable[int]) -> int:
    return agreed([sign(count > 0) for count in counts])


def _decay(found: list[ElementCase]) -> Conclusion:
    readings = []
    for element, name in PARTS.items():
        rates = [(c.damping_ratio, -c.largest) for c in found if c.element == element]
        rising = all(b[1] > a[1] for a, b in zip(rates[:-1], rates[1:], strict=True))
        shown = ", ".join(f"{rate:.3g} at ζ = {ratio:g}" for ratio, rate in rates)
        readings.append(Reading(f"{name}, slowest decay over the range [1/s]", shown, sign(rising)))
    return Conclusion("More damping makes the start die out faster (Figures 11–16).", tuple(readings))


def _range() -> Conclusion:
    """What (22) and (23) vary by over the angles of Figures 9 and 10."""
    readings = []
    for element, name in PARTS.items():
        for steiner, words in (("printed", "printed geometry"), ("mended", "Steiner terms times sin²β")):
            part = DoubleTripod(steiner=steiner).element(element)
            straight, bent = (part.natural_frequency(angle) / np.pi for angle in (0.0, WORST_ANGLE))
            part_of = abs(bent / straight - 1)
            readings.append(
                Reading(
                    f"{name}, {words}",
                    f"2Ω/2π from {straight:.1f} to {bent:.1f} Hz, {100 * part_of:.3g} %",
                    sign(part_of > NOTICED),
                )
            )
    return Conclusion(
        "The range of the principal parametric resonance varies with the joint angle (Figures 9 and 10, 0 to 9°).",
        tuple(readings),
        f"A shift counts from {100 * NOTICED:g} % on: the figures cover {100 * WIDTH:.0f} % about it. The paper draws "
        "the printed geometry, whose Steiner terms miss a factor sin²β.",
    )


def _literature() -> Conclusion:
    readings = []
    for steiner, words in (("printed", "printed geometry"), ("mended", "Steiner terms times sin²β")):
        shaft = DoubleTripod(steiner=steiner)
        values = [shaft.element(e).natural_frequency(WORST_ANGLE) / np.pi for e in PARTS]
        readings.append(Reading(words, f"2Ω/2π = {values[0]:.0f} Hz (DIE1) and {values[1]:.0f} Hz (DOE3)", NEITHER))
    return Conclusion(
        "The natural frequencies agree with those that Steinwede mentions (his pp. 119–139).",
        tuple(readings),
        "The paper prints none of his values; his thesis is on a joint of axial piston motors.",
    )


def _pitting(found: list[ElementCase]) -> Conclusion:
    refuted = sum(_refutes(c) == AGAINST for c in found)
    return Conclusion(
        "Chaos explains the pitting, and the ergodic motion the cracks, found on such joints.",
        (Reading("its premise", f"no chaos in {refuted} of {len(found)} cases", NEITHER),),
        "These equations have no contact, no stress and no number of cycles to judge wear by: what pits the bells they "
        "cannot say.",
    )


def _resonance(opened: Mapping[str, tuple[float, float]]) -> Conclusion:
    readings = []
    for chi, words in (("printed", "printed χ_n"), ("derived", "χ_n of Appendix B")):
        shaft = DoubleTripod(nonuniformity=chi)
        depths = [shaft.depth(e) for e in PARTS]
        readings.append(
            Reading(
                words,
                f"depth {depths[0]:.3g} (DIE1) and {depths[1]:.3g} (DOE3): it opens below ζ = {depths[0] / 4:.2g} and "
                f"{depths[1] / 4:.2g}",
                NEITHER,
            )
        )
    return Conclusion(
        "Beside the paper: the principal parametric resonance does not open at the paper's damping.",
        tuple(readings),
        f"At ζ = 0.0016, the smallest, it would take a depth of {opened['input'][1]:.3g}.",
        in_paper=False,
    )
