"""Lines judged and changed: margins of checks, two lines side by side, what a quantity follows, optima, tolerances."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trunnion.arrays import Array
from trunnion.design.assessment.result import Assessment
from trunnion.design.comparison.result import Comparison, Difference
from trunnion.design.envelope import Envelope
from trunnion.design.optimisation.result import Optimum
from trunnion.design.sensitivity.result import Sensitivities, SensitivityQuantity, share_of, smaller, too_large
from trunnion.design.tolerance.tolerance_study import ToleranceStudy
from trunnion.errors import InputError, NothingToDraw
from trunnion.floquet.certificate.certify import StabilityCertificate
from trunnion.pictures.picture import (
    EVEN,
    MARGIN,
    UNBROKEN,
    Axis,
    Bars,
    Item,
    Level,
    Line,
    Panel,
    Picture,
    Points,
    Shapes,
    Texts,
    points_at,
    rows,
    single,
)
from trunnion.pictures.shared import axis_of, histogram, printed
from trunnion.response.peaks.certify_peaks import PeakCertificate
from trunnion.results.speeds import speed_factor
from trunnion.results.units import in_words
from trunnion.results.words import Words

MARGIN_OF = "margin of "
FARTHEST = 1e6
"""Margin [%] at which one without end stands."""
TICKS, BETWEEN = (50.0, 100.0, 1e3, 1e4, 1e5, 1e6), (300.0, 3e3)
"""Numbers to either side of 0 at an axis that is logarithmic beyond ±100 %, and more of them where there are few."""
THICK = 0.62
FIRST = ("check", "torque", "growth rate", "tip", "frequency")
"""Kinds of quantities in the order in which one is chosen to be drawn."""
CHECKS = 6
"""Checks of an envelope at most, the worst ones."""
JUDGED = 14
"""Bars of checks that are judged, and lines of those that are not."""
FAR = 200.0
"""Margin [%] at which a bar of a check ends, either way."""
SHOWN = 8
"""Tolerances shown at most."""
APART = 1.0
"""Widths of a distribution between it and 0 from which on 0 is named: drawn, it would leave a sliver of the rest."""
CROWDED = 0.5
"""Share of lines in one bar above which the few others, those that grow among them, would not be seen beside it."""
BOXES = 400
"""Boxes whose outlines are drawn; more of them would be all lines."""


def comparison(found: Comparison, *, most: int = 12) -> Picture:
    """Margins of checks that differ, before as rings and after as dots; relative changes where nothing was judged."""
    margins = [one for one in found.of_kind("margin") if one.matters]
    if margins:
        margins.sort(key=lambda one: (_shown(found, one), np.nanmin([one.before, one.after])))
        return _margins(found, margins[:most])
    moved = [one for one in found.differences if one.matters and np.isfinite(one.relative)][:most]
    if not moved:
        unjudged = found.changes and None in found.verdicts
        remedy = "name speeds, as speeds=(tn.rpm(300), tn.rpm(2400))" if unjudged else "change a value"
        raise NothingToDraw("has nothing to draw: no result differs", element="comparison", remedy=remedy)
    size = [100 * one.relative for one in moved]
    bars = Bars(range(len(moved)), size, THICK, "bar", found.names[1], lie=True)
    return _in_rows(Axis(f"change from {found.names[0]}", "%"), [one.name for one in moved], [bars])


def _margins(found: Comparison, drawn: list[Difference]) -> Picture:
    before, after = (np.clip(100 * np.array([getattr(d, end) for d in drawn]), -FARTHEST, FARTHEST)
                     for end in ("before", "after"))  # fmt: skip
    items: list[Item] = [
        Line([a, b], [k, k], "worse" if b < a else "better") for k, (a, b) in enumerate(zip(before, after, strict=True))
    ]
    places = range(len(drawn))
    items += [Points(before, places, "before", found.names[0]), Points(after, places, "after", found.names[1])]
    across = Axis("margin", "%")
    if np.nanmax(np.abs([before, after])) > EVEN:
        across = _even_then_logarithmic(np.concatenate([before, after, [0.0]]))
    names = [one.name.removeprefix(MARGIN_OF) + " (guideline, shown)" * _shown(found, one) for one in drawn]
    return _in_rows(across, names, items)


def _even_then_logarithmic(values: Array) -> Axis:
    """Even up to ``EVEN`` and logarithmic beyond, so that no two far margins fall onto one another."""
    low, high = min(1.5 * np.nanmin(values), -0.2 * EVEN), max(1.5 * np.nanmax(values), 0.2 * EVEN)
    every = (0.0, *TICKS, *(BETWEEN if max(-low, high) < TICKS[3] else ()))
    ticks = sorted(tick for t in every for tick in {-t, t} if low <= tick <= high)
    words = [f"{tick + 0.0:,.0f}".replace(",", "\u202f").replace("-", "−") for tick in ticks]
    return Axis("margin [%], logarithmic beyond ±100", "", float(low), float(high), "symlog", ticks, words)


def _shown(found: Comparison, margin: Difference) -> bool:
    """Whether a margin is that of a guideline that decides neither before nor after."""
    name = margin.name.removeprefix(MARGIN_OF)
    every = [check for judged in found.assessments if judged for check in judged.checks if check.name == name]
    return not any(check.decides for check in every)


def _in_rows(across: Axis, names: Sequence[str], items: Sequence[Item], title: str = "") -> Picture:
    """Bars or marks in named rows about a line at 0."""
    height = 1.7 + 0.36 * len(names)
    return single(across, rows(names), [*items, Level(0.0, "base", on="x")], 7.6, height, title, grid="x")


def margins(found: Assessment) -> Picture:
    """Every check that has a margin, and those that could not be judged, with what is to be said of each."""
    table = list(zip(found.table(), found.checks, strict=True))
    judged = [one for one in table if np.isfinite(one[1].margin) and one[1].word in _STATUS][:JUDGED]
    drawn = judged + [one for one in table if one[1].word in ("not judged", "guideline not judged")][:JUDGED]
    items: list[Item] = []
    for status, (role, words) in _STATUS.items():
        at = [k for k, (_, check) in enumerate(drawn) if check.word == status]
        size = [float(np.clip(100 * drawn[k][1].margin, -FAR, FAR)) for k in at]
        says = [f"{drawn[k][0]['check']}: {drawn[k][0]['because']}" for k in at]
        items += [Bars(at, size, THICK, role, words, True, says)] if at else []
    percent = [100 * float(check.margin) if k < len(judged) else 0.0 for k, (_, check) in enumerate(drawn)]
    said = [_said(check.word, check.proof, margin) for (_, check), margin in zip(drawn, percent, strict=True)]
    ends = [max(0.0, min(FAR, margin)) for margin in percent]
    items.append(Texts(ends, range(len(drawn)), said, beside="right"))
    low, high = max(-FAR, min([0.0, *percent])), min(FAR, max([20.0, *percent]))
    longest = max(map(len, said), default=0)
    across = Axis("margin to the limit", "%", low, high + 0.02 * longest * (high - low))
    return _in_rows(across, [f"{k + 1}. {row['check']}" for k, (row, _) in enumerate(drawn)], items)


FAR_LIMIT = 3.0
"""Times the largest bound up to which a limit is drawn."""
_STATUS = {
    "exceeded": ("exceeded", "exceeded"), "satisfied": ("satisfied", "satisfied"),
    "beyond guideline": ("undeciding, bad", "beyond guideline"), "within guideline": ("undeciding", "within guideline"),
}  # fmt: skip
"""Role and words of a status that has a margin."""


def _said(status: str, proof: str, percent: float) -> str:
    """What stands at the end of a bar."""
    far = f"> {FAR:g} %" if percent > FAR else ""
    met = ", ".join(part for part in (far, "proved" if proof == "proved" else "") if part)
    return {"satisfied": met, "within guideline": f"{far} (guideline)".strip()}.get(status, status)


def sensitivities(found: Sensitivities, quantity: str | None = None, *, most: int = 10) -> Picture:
    """A tornado of ``quantity``, by default of the first check, torque or growth rate that follows several parameters.

    Every bar goes to both sides: what the step upwards and the one downwards make of the quantity.
    """
    chosen = found.quantity(quantity) if quantity is not None else _chosen(found)
    effects = found.ranked(chosen.name, most)
    if not effects:
        why = chosen.refused or "follows none of the parameters"
        raise NothingToDraw(f"has nothing to draw: {why}", key="quantity", value=chosen.name, remedy="name another one")
    factor, label = share_of(chosen)
    tenths = too_large(chosen, effects[0].change)
    size, at = np.array([one.change * factor / 10**tenths for one in effects]), range(len(effects))
    steps = [smaller(e.step_words, tenths).replace("+", "±").replace(" ", UNBROKEN) for e in effects]
    names = [f"{e.parameter} ({step})" for e, step in zip(effects, steps, strict=True)]
    items = [
        Bars(at, size, THICK, "upwards", "step upwards", True),
        Bars(at, -size, THICK, "downwards", "step downwards", True),
    ]
    return _in_rows(Axis(f"change{label}"), names, items, f"{chosen.name}: {printed(found.shown(chosen))}")


def _chosen(found: Sensitivities) -> SensitivityQuantity:
    """The first that follows several parameters; an angle, which only follows itself, needs no picture."""
    for several in (2, 1):
        for kind in FIRST:
            for one in found.quantities:
                if one.kind == kind and len(found.ranked(one.name, several)) == several:
                    return one
    if not found.quantities:
        raise NothingToDraw("holds no quantity to draw", element="sensitivity", remedy="ask for frequencies, say")
    return found.quantities[0]


def ranked(names: Sequence[str], values: Sequence[float], words: str, most: int = 16) -> Picture:
    """Bars of signed values, the largest on top."""
    order = np.argsort(-np.abs(np.asarray(values, dtype=float)), kind="stable")[:most]
    bars = Bars(range(len(order)), [float(values[k]) for k in order], THICK, "bar", lie=True)
    return _in_rows(Axis(words), [names[k] for k in order], [bars])


def envelope(found: Envelope, *, schedule: str = "") -> Picture:
    """Margin of the worst checks over travel or speed of one schedule (default: where the binding check is worst)."""
    named = list(dict.fromkeys(p.schedule for p in found.places if p.schedule))
    if not named:
        remedy = "state [[operation.schedule]], or read the words: they say what load cases do"
        raise NothingToDraw("has nothing to draw: no schedule is judged", element="envelope", remedy=remedy)
    if schedule and schedule not in named:
        raise InputError("is not judged", key="schedule", value=schedule, remedy=f"choose {named[0]}, say")
    bound = found.places[found.where[0]].schedule if found.where else ""
    chosen = schedule or bound or named[0]
    here = [k for k, p in enumerate(found.places) if p.schedule == chosen and p.along is None]
    of_speed = found.places[here[0]].over == "speed"
    factor, words = (
        (speed_factor(found.unit), f"input speed [{found.unit}]") if of_speed else (1e3, "travel [mm]")
    )  # fmt: skip
    x, percent = np.array([found.places[k].value for k in here]) * factor, 100 * found.margin[here]
    drawn = [c for c in range(percent.shape[1]) if np.isfinite(percent[:, c]).any()][:CHECKS]
    items: list[Item] = [
        Line(x, np.clip(percent[:, c], -EVEN, EVEN), f"marked {n}", found.checks[c].name) for n, c in enumerate(drawn)
    ]
    far = np.nanmax(np.abs(percent[:, drawn]), initial=0.0) > EVEN
    up = Axis("margin [%]" + "\n(beyond ±100 at the edge)" * bool(far))
    return single(Axis(f"{words}, {chosen}"), up, [*items, Level(0.0, "base")], height=4.0)


def optimum(found: Optimum) -> Picture:
    """Two aims: every design of the front, the line before and the design taken. One: bounds, before and after."""
    return _front(found) if len(found.aims) > 1 else _bounds(found)


def _front(found: Optimum) -> Picture:
    items: list[Item] = [
        Line(found.front[:, 0], found.front[:, 1], "front", "no design beats these"),
        points_at(found.aim, "taken", "taken"),
        points_at(found.aim_before, "begin", "before"),
    ]
    across, up = (
        Axis(f"{name}{f' [{printed(unit)}]' if unit != '1' else ''}{', larger is better' if largest else ''}")
        for name, unit, largest in zip(found.aims, found.aim_units, found.largest, strict=True)
    )
    return single(across, up, items, 6.3, 4.9, grid="")


def _bounds(found: Optimum) -> Picture:
    places = np.arange(len(found.free))
    before, after = ((v - found.low) / (found.high - found.low) for v in (found.before, found.value))
    items: list[Item] = [Line([0, 1], [k, k], "bounds") for k in places]
    items += [Points(np.clip(before, 0, 1), places, "begin", "before"), Points(after, places, "best", "best")]

    def words(values: Array) -> list[str]:
        return [in_words(value, unit, 5) for value, unit in zip(values, found.units, strict=True)]

    items.append(Texts(after, places, words(found.rounded(found.value)), beside="above"))
    for values, where, side in ((found.low, -0.02, "left"), (found.high, 1.02, "right")):
        items.append(Texts(np.full(len(places), where), places, words(values), "faint words", side))
    was, now = (in_words(v[0], found.aim_units[0], 5) for v in (found.aim_before, found.aim))
    across = Axis(low=-0.28, high=1.28, ticks=(0.0, 1.0), names=("", ""))
    title = f"{found.aims[0]}: {now} instead of {was}"
    return single(across, rows(found.free), items, 7.2, 1.8 + 0.5 * len(found.free), title, grid="")


def tolerance(study: ToleranceStudy) -> Picture:
    """Histogram of the growth rate at the speed where it is fastest; below it the tolerances by what they explain."""
    names, shares = zip(*study.ranking[:SHOWN], strict=True)
    fastest = int(np.nanmax(study.growth_rate, axis=1).argmax())
    rates = study.growth_rate[fastest]
    rates = rates[np.isfinite(rates)]
    counts, ends = histogram(rates, 12)
    rate = Axis(f"growth rate at {Words(study.unit).speed(float(study.speeds[fastest]))}", "1/s")
    across, limit = _limit(rate, float(rates.min()), float(rates.max()))
    up = Axis("lines", "", 0.0, (1.15 if across.low is not None else 1 + MARGIN) * float(np.max(counts)))
    if np.max(counts) > CROWDED * len(rates):
        up = Axis("lines, logarithmic").logarithmic(0.5, 3.0 * float(np.max(counts)))
    bars = Bars((ends[1:] + ends[:-1]) / 2, counts, float(ends[1] - ends[0]), "counted")
    low, high = study.interval
    title = f"stable with probability {study.probability:.4g} ({low:.4g} to {high:.4g})"
    ranking = Bars(range(len(names)), [100 * share for share in shares], 0.8, "bar", lie=True)
    panels = [
        Panel(across, up, [bars, *limit], title, key="", grid=""),
        Panel(Axis("explains of the scatter", "%"), rows(names), [ranking], key="", grid=""),
    ]
    depth = 0.3 * len(names)
    return Picture(panels, 7.2, 4.1 + depth, heights=(2.8, depth))


def _limit(across: Axis, slowest: float, fastest: float) -> tuple[Axis, list[Item]]:
    """The limit of stability, growth rate 0; where all lines are far to one side of it, an arrow to it."""
    width = fastest - slowest
    if slowest - APART * width <= 0 <= fastest + APART * width or not width > 0:
        return across, [Level(0.0, "stability ends", on="x")]
    stable = fastest < 0
    away = (-fastest if stable else slowest) / width
    said = f"0, the limit, {away:.2g} widths away"
    words = Texts([0.99 if stable else 0.01], [0.97], [f"{said} →" if stable else f"← {said}"], "stability ends",
                  "below left" if stable else "below right", inside=True)  # fmt: skip
    ends = (slowest - MARGIN * width, fastest + MARGIN * width)
    return Axis(across.words, across.unit, *ends), [words]


def peak_certificate(found: PeakCertificate) -> Picture:
    """Bounds of the vibratory torque of every spring as bars, what was reached and what is allowed as marks; springs
    without a bound have no bar and say so."""
    known = [k for k, torque in enumerate(found.vibratory_torque) if np.isfinite(torque)]
    bound, reached = found.vibratory_torque_bound[known], found.vibratory_torque[known]
    names, places = [found.springs[k] for k in known], np.arange(len(known))
    open_ones = [k for k in places.tolist() if not np.isfinite(bound[k])]
    high = 1.05 * max([*np.where(np.isfinite(bound), bound, reached), *reached, 0.0]) or 1.0
    limits = {one.name: one.limit for one in found.allowed if one.measure == "vibratory torque"}
    allowed = [(limits[name], k) for k, name in enumerate(names) if limits.get(name, np.inf) <= FAR_LIMIT * high]
    high = max([high, *(1.05 * limit for limit, _ in allowed)])
    items: list[Item] = [
        Bars(places, np.where(np.isfinite(bound), bound, 0.0), 0.7, "bar 0", "proved not to be exceeded", lie=True),
        points_at(np.column_stack((reached, places)), "reached peak", "reached"),
    ]
    if allowed:
        items.append(points_at(allowed, "allowed peak", "allowed"))
    if open_ones:
        items.append(Texts(reached[open_ones], open_ones, ["  no bound"] * len(open_ones), beside="right"))
    across = Axis("vibratory torque ±", "N m", 0.0, float(high))
    return single(across, rows(names), items, 7.2, 1.6 + 0.5 * len(names), key="below")


def certificate(found: StabilityCertificate) -> Picture:
    """Boxes over the two directions that were split most; the others lie behind one another, open ones in front."""
    if not found.parameters:
        return _along_speed(found)
    names, units = ("speed", *found.parameters), ("rad/s", *found.units)
    directions = most_split(found)
    quantities = [Words(found.unit).parameter(names[k], units[k]) for k in directions]
    factors = [one.factor for one in quantities]
    items: list[Item] = []
    parts = (
        ("proved", "proved stable", found.proved_low, found.proved_high),
        ("open", "left open", found.undecided_low, found.undecided_high),
    )
    for role, name, low, high in parts:
        if len(low):
            corners = list(_corners(low, high, directions) * factors)
            items.append(Shapes(corners, role if len(low) <= BOXES else f"{role}, many", f"{name} ({len(low)} boxes)"))
    if found.counterexample is not None:
        at = [found.counterexample[names[k]] * factor for k, factor in zip(directions, factors, strict=True)]
        items.append(points_at(at, "counterexample", "unstable line"))
    across, up = (axis_of(one, *(end[k] for end in found.ends)) for one, k in zip(quantities, directions, strict=True))
    return single(across, up, items, 6.3, 4.9, _certified(found), grid="")


def _along_speed(found: StabilityCertificate) -> Picture:
    """Of the line as it is: ranges of speed side by side."""
    speed = Words(found.unit).parameter("speed", "rad/s")
    items: list[Item] = []
    parts = (
        ("proved", "proved stable", found.proved_low, found.proved_high),
        ("open", "left open", found.undecided_low, found.undecided_high),
    )
    for role, name, low, high in parts:
        if len(low):
            a, b = low[:, 0] * speed.factor, high[:, 0] * speed.factor
            none, one = np.zeros_like(a), np.ones_like(a)
            corners = np.stack(
                [np.stack([a, none], 1), np.stack([b, none], 1), np.stack([b, one], 1), np.stack([a, one], 1)], 1
            )
            ranges = f"{len(low)} range{'s' if len(low) > 1 else ''} of speed"
            items.append(Shapes(list(corners), role if len(low) <= BOXES else f"{role}, many", f"{name} ({ranges})"))
    if found.counterexample is not None:
        at = [found.counterexample["speed"] * speed.factor, 0.5]
        items.append(points_at(at, "counterexample", "unstable line"))
    across = axis_of(speed, *(end[0] for end in found.ends))
    return single(across, Axis("the line as it is", "", 0.0, 1.0), items, 6.3, 2.6, _certified(found), grid="")


def most_split(found: StabilityCertificate) -> tuple[int, int]:
    """Speed and parameters as numbers from 0: the two that were halved most often, the lower first."""
    sides = np.concatenate([found.proved_high - found.proved_low, found.undecided_high - found.undecided_low])
    low, high = found.ends
    halved = np.log2((high - low) / np.maximum(sides, 1e-300)).mean(axis=0)
    first, second = np.sort(np.argsort(-halved, kind="stable")[:2]).tolist()
    return first, second


def _corners(low: Array, high: Array, sides: tuple[int, int]) -> Array:
    """Corners (box, corner, 2) of boxes seen along the other directions."""
    a, b = sides
    across, up = np.stack([low[:, a], high[:, a]]), np.stack([low[:, b], high[:, b]])
    return np.stack([across[[0, 1, 1, 0]].T, up[[0, 0, 1, 1]].T], axis=2)


def _certified(found: StabilityCertificate) -> str:
    head = "proved stable" if found.counterexample is None else "not stable: one line is unstable"
    if found.verdict == "undecided":
        head = f"undecided: {100 * found.undecided_share:.3g} % of the volume left open"
    behind = len(found.parameters) - 1
    if behind < 1:
        return head
    others = "1 other direction" if behind == 1 else f"{behind} other directions"
    return f"{head}\nboxes of {others} behind one another"
