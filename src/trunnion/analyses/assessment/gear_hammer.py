"""Gear hammer: a mesh separates where its vibratory torque is larger than its mean torque.

    half of peak-to-peak of the torque ≤ |mean torque|   (known)

A rigid Ratio has no mesh to separate. Backlash and what follows after separation belong to the nonlinear analyses.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.analyses.assessment.check import Check, Rule, Status, below, judged, percent
from trunnion.analyses.assessment.own_limits import bands, spring_of
from trunnion.analyses.assessment.subject import NO_RESPONSE, Case, Subject, cause
from trunnion.driveline.gears import GearPair

RULE = Rule("half of peak-to-peak ≤ |mean torque|", "loss of contact", "known")
NOTHING = 1e-9
"""Share of the vibratory torque below which a mean torque counts as none."""


def gear_hammer(subject: Subject, case: Case) -> Iterator[Check]:
    """Every mesh of the line."""
    pairs = [n for n, e in zip(subject.line.names, subject.line.elements, strict=True) if isinstance(e, GearPair)]
    if not pairs:
        yield Check("gear hammer", Status.NOT_APPLICABLE, RULE, "the line has no GearPair")
    for name in pairs:
        title = f"gear hammer in {name}"
        if isinstance(case.answer, str):
            yield Check(title, Status.NOT_JUDGED, RULE, f"{NO_RESPONSE}{case.answer}")
            continue
        c = spring_of(case.assembly, name)
        swing, mean = case.answer.vibratory_torque[:, c], np.abs(case.answer.mean_torque[:, c])
        swing = np.where(np.isfinite(swing), swing, np.inf)
        if np.all(mean <= NOTHING * swing):
            because = "the mesh carries no mean torque: state a load_torque" + case.suffix
            yield Check(title, Status.NOT_JUDGED, RULE, because, load_case=case.name)
            continue
        with np.errstate(divide="ignore", invalid="ignore"):
            at = int(np.argmax(np.where(mean > 0, swing / mean, np.inf)))
        margin, required = below(float(swing[at]), float(mean[at])), subject.required(name)
        said = cause(case, at, np.abs(case.answer.torque[at, :, c]))
        because = f"±{swing[at]:.4g} N*m about a mean of {mean[at]:.4g} N*m at {subject.shown(case.speeds[at])}, "
        because += percent(margin) + (f", {said}" if said else "") + case.suffix
        yield Check(
            title, judged(margin, required), RULE, because, margin, required, float(swing[at]), float(mean[at]), "N*m",
            float(case.speeds[at]), "", case.name, bands(case.speeds, swing, mean * (1 - required)), element=name,
            cause=said,
        )  # fmt: skip
