"""S4's claims against computed figures: the ranges of chaos, what refutes them, and its conclusions one by one."""

from __future__ import annotations

from collections.abc import Mapping

from trunnion.studies.double_tripod.computed import ORDERS_OF_MOTOR, RANGES, Case, exponent_from
from trunnion.studies.double_tripod.published import DoubleTripod
from trunnion.studies.result import CONFIRMED, CORRECTED, UNDECIDED, Comparison, Conclusion, Row

PARTS = {"input": "DIE1", "output": "DOE3"}
EQUATIONS = {
    ("input", "given"): "(29)", ("input", "own"): "(25)", ("output", "given"): "(30)", ("output", "own"): "(26)"
}  # fmt: skip
START = 1.0
"""A start far beyond any twist of the shaft [rad]."""


def dampings(found: list[Case]) -> Comparison:
    """Every damping ratio of the paper: exponents over its range of frequencies, and the bound of every motion."""
    rows = []
    for case in found:
        low, high = RANGES[case.element]
        verdicts = "; ".join(
            f"{EQUATIONS[case.element, phase]} at 2Ω: {c.verdict}{f', {c.kind}' if c.kind else ''}"
            for phase, c in case.verdicts.items()
        )
        rows.append(
            Row(
                f"{PARTS[case.element]}, {low:g}–{high:g} Hz, ζ = {case.damping_ratio:g}",
                case.claimed,
                "no chaos" if case.positive == 0 and case.bound.rate > 0 else f"{case.positive} positive exponents",
                f"largest exponent besides the phase's 0: {case.largest:.4g} 1/s, bound of every motion "
                f"{-case.bound.rate:.4g} 1/s{'; ' + verdicts if verdicts else ''}",
            )
        )
    return Comparison(
        "Ranges of damping for which the paper concludes chaos", tuple(rows),
        "Half of the frequencies even over the range, half within 0.2 % of 2Ω, by the standard definition.",
    )  # fmt: skip


def refuted() -> Comparison:
    """Exponents at 2Ω, ζ = 0.0016: other speeds of the motor, and starts of 1 rad."""
    rows = []
    for order in ORDERS_OF_MOTOR:
        found = {phase: exponent_from("input", phase, order, 0.0) for phase in ("given", "own")}
        said = ", ".join(f"{EQUATIONS['input', phase]} {value:.1f}" for phase, value in found.items())
        rows.append(Row(f"DIE1, Ω_AEM = {100 * order}π rad/s", "chaos", f"{said} 1/s", "from rest"))
    for (element, phase), equation in EQUATIONS.items():
        value = exponent_from(element, phase, 6, START)
        remark = f"largest exponent over 1.5 s from φ = {START:g} rad"
        rows.append(Row(f"{PARTS[element]} {equation} from {START:g} rad", "chaos", f"{value:.1f} 1/s", remark))
    return Comparison(
        "The same at every speed of the motor, and from far away", tuple(rows),
        "η = 2Ω, ζ = 0.0016; largest exponent besides the phase's 0, over 1.5 s, in which two that lie "
        "close together have not quite sorted. That no case was missed the bound says.",
    )  # fmt: skip


def conclusions(
    found: list[Case], opened: dict[str, tuple[float, float]], beats: Mapping[str, tuple[str, float, int]]
) -> tuple[Conclusion, ...]:
    """The paper's conclusions; ``beats`` has element, damping ratio and number of beats of each time history."""
    quiet = all(c.positive == 0 and c.bound.rate > 0 for c in found)
    return (
        _chaos(found, quiet),
        _ergodic(found),
        _transition(found, quiet),
        _criteria(found),
        _resonance(opened),
        *(_beating(element, beats) for element in PARTS),
        _decay(found),
        _pitting(quiet),
    )


def _chaos(found: list[Case], quiet: bool) -> Conclusion:
    claimed = [c for c in found if c.claimed == "chaos"]
    shown = "; ".join(f"{PARTS[c.element]} ζ = {c.damping_ratio:g}: {c.largest:.3g} 1/s" for c in claimed)
    return Conclusion(
        "The motion is chaotic for ζ = 0.0016–0.011 (DIE1, 2950–3200 Hz) and 0.0016–0.0104 (DOE3, 2650–2950 Hz).",
        CORRECTED if quiet else UNDECIDED,
        "By the standard definition no exponent is positive anywhere in these ranges. Largest besides the "
        f"0 of the phase: {shown}. It cannot be otherwise: every two motions approach each other at "
        f"{min(c.bound.rate for c in found):.3g} 1/s or faster, by a bound in closed form.",
    )


def _kinds(found: list[Case]) -> dict[str, set[str]]:
    kinds: dict[str, set[str]] = {}
    for case in found:
        for phase, certificate in case.verdicts.items():
            kinds.setdefault(EQUATIONS[case.element, phase], set()).add(str(certificate.kind or certificate.verdict))
    return kinds


def _ergodic(found: list[Case]) -> Conclusion:
    kinds = _kinds(found)
    regular = all(c.verdict == "regular" for case in found for c in case.verdicts.values())
    shown = ", ".join(f"{equation} {' or '.join(sorted(kind))}" for equation, kind in kinds.items())
    return Conclusion(
        "For larger damping the motion is “ergodic”.",
        CONFIRMED if regular else UNDECIDED,
        f"As every periodic or quasi-periodic motion is, on its own curve or torus: {shown}. The same holds for the "
        "damping ratios called chaotic; it tells nothing apart.",
    )


def _transition(found: list[Case], quiet: bool) -> Conclusion:
    weak = {e: next(c for c in found if c.element == e) for e in PARTS}
    shown = " and ".join(f"{weak[e].largest:.3g} 1/s ({PARTS[e]})" for e in PARTS)
    return Conclusion(
        "It is then in transition to chaos.",
        CORRECTED if quiet else UNDECIDED,
        "There is no chaos to go to: the largest exponent only rises with less damping, to "
        f"{shown} at the paper's smallest.",
    )


def _criteria(found: list[Case]) -> Conclusion:
    """(38) and (39) on motions known to be regular: met there, they certify nothing."""
    regular = [c for case in found for c in case.verdicts.values() if c.verdict == "regular" and c.kind != "at rest"]
    idle = sum(not any(c.discriminates for c in certificate.criteria[1:]) for certificate in regular)
    positive = sum(certificate.criteria[0].holds for certificate in regular)
    return Conclusion(
        "Criteria (37)–(39) and the map certify chaos.",
        CORRECTED if regular and idle == len(regular) and positive == 0 else UNDECIDED,
        f"On {idle} of {len(regular)} regular motions of these equations (38) and (39) could not have failed: a forced "
        f"system has an exponent 0, a damped one a negative sum. Only (37) discriminates; it holds for {positive}.",
    )


def _resonance(opened: dict[str, tuple[float, float]]) -> Conclusion:
    depths = {e: DoubleTripod().depth(e) for e in PARTS}
    shut = all(depth < opened[e][1] for e, depth in depths.items())
    return Conclusion(
        "The principal parametric resonance decides the motion near η = 2Ω.",
        CORRECTED if shut else CONFIRMED,
        f"With the printed χ_n the depth is {depths['input']:.3g} and {depths['output']:.3g}: the resonance opens "
        f"below ζ = {depths['input'] / 4:.2g}, under the paper's smallest. At ζ = 0.0016 it would take a depth of "
        f"{opened['input'][1]:.3g}.",
    )


def _beating(element: str, beats: Mapping[str, tuple[str, float, int]]) -> Conclusion:
    counts = {number: count for number, (which, _, count) in beats.items() if which == element}
    signs = [count > 0 for count in counts.values()]
    shown = ", ".join(f"{count} in Figure {number}" for number, count in counts.items())
    cause = {
        "input": "They are between the natural frequency and the harmonics of the motor's torque.",
        "output": "(26) has no torque in time, and the mill's harmonics turn with a rotation of 1e-4 rad.",
    }[element]
    return Conclusion(
        f"{PARTS[element]} beats while its start dies out (Figures {min(counts)}–{max(counts)}).",
        CONFIRMED if all(signs) else CORRECTED if not any(signs) else UNDECIDED,
        f"Times that the swing per natural period rises again by more than 2 % of the first: {shown}. {cause}",
    )


def _decay(found: list[Case]) -> Conclusion:
    falling = True
    shown = []
    for element, name in PARTS.items():
        rates = [(c.damping_ratio, -c.largest) for c in found if c.element == element]
        falling = falling and all(b[1] > a[1] for a, b in zip(rates[:-1], rates[1:], strict=True))
        shown.append(f"{name} {rates[0][1]:.3g} 1/s at ζ = {rates[0][0]:g}, {rates[-1][1]:.3g} at {rates[-1][0]:g}")
    return Conclusion(
        "More damping makes the start die out faster (Figures 11–16).",
        CONFIRMED if falling else CORRECTED,
        f"Slowest decay over the range, rising throughout: {'; '.join(shown)}.",
    )


def _pitting(quiet: bool) -> Conclusion:
    return Conclusion(
        "Chaos explains the pitting, and the ergodic motion the cracks, found on such joints.",
        UNDECIDED,
        ("Its premise fails, for there is no chaos. " if quiet else "")
        + "Nor do these equations have a contact, a stress or a number of cycles to judge wear by: what pits the bells "
        "they cannot say.",
    )
