"""Separation of natural frequencies from the orders that excite the line.

    |kΩ/ω − 1| ≥ 10 %   for every order k that shakes the line and every mode ω, over the running range

(API 617/684, typical); of a frequency ν in time, or beside an order, |kΩ + ν| stands for kΩ. A mode that an order
comes nearer to is not a fault by itself: the standard then asks that it be moved, or for a check of torque or stress
there, which limits of the description give; who takes that for an answer switches the rule off with this reason. Orders
below 1 % of the largest torque by one order are left out. ω is the damped frequency of the loaded line, all joints
straight.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from trunnion.arrays import Array
from trunnion.design.assessment.assessment_input import AssessmentInput, LoadCaseResponse
from trunnion.design.assessment.check import Check, Rule, Status, above
from trunnion.design.assessment.compared import unanswered
from trunnion.design.assessment.stated_limits import unlimited
from trunnion.laws.harmonic import turning
from trunnion.response.campbell_diagram import ExcitationLine, closed_in
from trunnion.results.counts import counted, few
from trunnion.results.speeds import order_name
from trunnion.results.units import amplification_words

REQUIRED = 0.10
WORTH = 0.01
"""Share of a spring's largest torque by one order from which an order counts."""
RULE = Rule("|kΩ/ω − 1| ≥ 0.10", "API 617/684", "typical", "separation")
ALL, ONE = "separation of modes", "separation of mode "
NEEDS = "; a resonance "
"""Between where a mode meets an order and what judges it, or would."""
LIMITED = "is judged by the limits of torque or stress that are stated"
STEEP = 0.01
"""Share by which a mode may change between two speeds and still be taken as met where an order changes its side."""


def separation(subject: AssessmentInput, case: LoadCaseResponse) -> Iterator[Check]:
    """One check a mode that an order meets, one for all the others together."""
    if case.response is None or case.ended_by:
        yield unanswered(subject, case, ALL, RULE)
        return
    orders = shaking_orders(case)
    if not len(orders):
        yield Check(ALL, Status.NOT_APPLICABLE, RULE, "nothing excites the line by orders")
        return
    clear: list[tuple[float, str, float]] = []
    without: str | None = None
    frequency = case.modes.imag
    for m in range(frequency.shape[1]):
        near, order, at, met = _nearest(case, frequency[:, m], orders)
        if not np.isfinite(near):
            continue
        hertz = f"mode {m + case.first} ({frequency[at, m] / (2 * np.pi):.4g} Hz)"
        shown = f"at {subject.shown(case.speeds[at])}"
        if near >= REQUIRED:
            said = f"{order_name(*order)} comes no nearer than {100 * near:.3g} % to {hertz}, {shown}"
            clear.append((near, said, float(case.speeds[at])))
            continue
        what = "meets" if met else f"comes within {100 * near:.2g} % of"
        here = case.modes[at, m]
        gain = abs(here) / max(-2 * here.real, 1e-300)
        if without is None:
            without = few(unlimited(case.assembly))
        needs = f"needs limits of torque or stress: state them for {without}" if without else LIMITED
        said = f"{order_name(*order)} {what} {hertz} {shown}, amplification {amplification_words(gain)}{NEEDS}{needs}"
        beside = "met in the range" if met else f"{100 * near:.2g} % apart"
        found = _near(case, f"{ONE}{m + case.first}", Status.EXCEEDED, said, near, float(case.speeds[at]))
        yield replace(found, margin_said=beside)
    if clear:
        nearest, said, speed = min(clear)
        yield _near(case, ALL, Status.SATISFIED, said, nearest, speed, counted(len(orders), "order"))


def _near(
    case: LoadCaseResponse, name: str, status: Status, said: str, near: float, speed: float, inputs: str = ""
) -> Check:
    return Check(
        name, status, RULE, said + case.suffix, margin=above(near, REQUIRED), value=near, limit=REQUIRED, unit="1",
        speed=speed, inputs=inputs, load_case=case.name,
    )  # fmt: skip


def shaking_orders(case: LoadCaseResponse) -> Array:
    """Orders and frequencies beside them [rad/s], (order, 2), that make up 1 % of any spring's torque at least."""
    response = case.answered
    if not len(response.order):
        return np.zeros((0, 2))
    size = np.nan_to_num(np.abs(response.torque)).max(axis=0)
    worth = np.any(size >= WORTH * np.maximum(size.max(axis=0), 1e-300), axis=1)
    return np.unique(np.stack([response.order[worth], response.frequency[worth]], axis=1), axis=0)


def _nearest(case: LoadCaseResponse, frequency: Array, orders: Array) -> tuple[float, tuple[float, float], int, bool]:
    """Smallest |kΩ/ω − 1| over orders and speeds, with the order and the speed's number; 0 where they meet between."""
    off = np.abs(turning(orders[:, :1], orders[:, 1:], case.speeds)) / frequency - 1
    if not np.any(np.isfinite(off)):
        return np.inf, (0.0, 0.0), 0, False
    size = np.where(np.isfinite(off), np.abs(off), np.inf)
    met = off[:, 1:] * off[:, :-1] <= 0
    for k, i in np.argwhere(met & (np.abs(np.diff(frequency)) > STEEP * frequency[:-1])):
        met[k, i], beside = _meets(case, float(frequency[i]), orders[k], int(i))
        size[k, i] = min(size[k, i], beside)
    crossed = np.any(met, axis=1)
    size[crossed] = np.where(size[crossed] == size[crossed].min(axis=1, keepdims=True), 0.0, size[crossed])
    k, at = np.unravel_index(int(size.argmin()), size.shape)
    return float(size[k, at]), (float(orders[k, 0]), float(orders[k, 1])), int(at), bool(crossed[k])


def _meets(case: LoadCaseResponse, first: float, order: Array, i: int) -> tuple[bool, float]:
    """Whether a mode that changes much between two speeds is met there, or jumps over an order as a spring changes its
    stage; then how near it stands just behind the jump."""
    ends = float(case.speeds[i]), float(case.speeds[i + 1])
    k, frequency = float(order[0]), float(order[1])
    forward = 1.0 if k * ends[0] + frequency >= 0 else -1.0
    at, mode, ratio = closed_in(case.assembly, ends, first, ExcitationLine(forward * k, forward * frequency, ()))
    return ratio is not None, abs(abs(k * at + frequency) / mode - 1) if ratio is None else np.inf
