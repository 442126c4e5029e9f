"""Results as tables of text, in units an engineer reads."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from trunnion.design.assessment.check import Status, percent
from trunnion.design.assessment.result import Assessment
from trunnion.driveline.curve_points import TorquePoint
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Element, Loaded
from trunnion.driveline.engine import Engine
from trunnion.driveline.operating_speed import known_speed
from trunnion.driveline.pressure import PressureCurve
from trunnion.driveline.quantities import DAMPING, DEGREE, INERTIA, PRESSURE, STIFFNESS, QuantityKind, shown, signs
from trunnion.driveline.shafts import Shaft
from trunnion.driveline.sheet import Sheet
from trunnion.driveline.summary import firing
from trunnion.reporting.contents import Contents
from trunnion.reporting.under_load import LoadedMotion
from trunnion.response.campbell_diagram import Crossing
from trunnion.results.units import figures, range_words
from trunnion.results.words import Words

MOST_RESONANCES = 30
MOST_CROSSINGS = 30
REASONS = 5
"""Satisfied checks printed with their reasons."""
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
POWER_OF_TEN = re.compile("·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+$")
TIED = "\u00a0"
"""A space at which no line breaks."""


@dataclass(frozen=True)
class Table:
    """Column heads and rows of text; ``numeric`` columns are aligned right."""

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    @classmethod
    def of(cls, rows: Iterable[Mapping[str, object]]) -> Table:
        """Values by head, numbers to four figures; what is not known is NaN."""
        listed = list(rows)
        shown = [tuple(four(v) if isinstance(v, float) else str(v) for v in row.values()) for row in listed]
        return cls(tuple(listed[0]) if listed else (), tuple(shown))

    @property
    def numeric(self) -> tuple[bool, ...]:
        """Whether a column holds numbers alone."""
        columns = [[row[i] for row in self.rows] for i in range(len(self.heads))]
        return tuple(any(column) and all(map(_is_number, column)) for column in columns)


def measured(contents: Contents) -> Table | None:
    """How far measured orders are from predicted ones; None where nothing was measured."""
    found = contents.measured
    if found is None:
        return None
    moves = {name for name, peak in zip(found.channels, found.peak.max(axis=0), strict=True) if peak > 0}
    return Table.of(row for row in found.table() if row["channel"] in moves)


def measured_sentences(contents: Contents) -> list[str]:
    """What differs, one sentence an order of a channel, and what to read first."""
    found = contents.measured
    if found is None:
        return []
    places = [(k, c) for c in range(len(found.channels)) for k in range(len(found.order)) if found.peak[k, c] > 0]
    said = [f"{found.sentence(k, c)}." for k, c in places]
    return [*(one.sentence for one in found.findings), *(one[0].upper() + one[1:] for one in said)]


def _is_number(text: str) -> bool:
    try:
        float(POWER_OF_TEN.sub("", text).replace("−", "-").replace("–", "0") or "0")
    except ValueError:
        return False
    return True


def four(value: float) -> str:
    """Four figures with a true minus sign: "−0.1286", "2.4·10⁻⁵"."""
    if not np.isfinite(value):
        return "–"
    digits, _, power = figures(value).replace("-", "−").partition("e")
    return f"{digits}·10{str(int(power.replace('−', '-'))).translate(RAISED)}" if power else digits


def elements(line: Driveline) -> Table:
    """Every element with what it is and its numbers."""
    rows = []
    for i, (name, element) in enumerate(line.as_stated.parts, start=1):
        after = f"after {element.after}; " if element.after else ""
        rows.append({"no.": i, "name": name, "element": element.kind, "numbers": after + "; ".join(_numbers(element))})
    return Table.of(rows)


def _numbers(element: Element) -> list[str]:
    """Stated numbers with units, and what follows from a geometry."""
    parts = [firing(element)] if isinstance(element, Engine) else []
    for key, value in element.stated.items():
        if key in ("name", "after", "firing_order"):
            continue
        if isinstance(value, Sheet):
            departures = ", ".join(f"{k.replace('_', ' ')} ({one} there)" for k, one in element.departures.items())
            parts.append(f"from the sheet {value.words}" + (f", but for {departures}" if departures else ""))
            continue
        kind = element.quantity_of(key)
        if isinstance(value, tuple):
            parts.append(f"{key.replace('_', ' ')} {_listed(value, kind)}")
            continue
        text = shown(value, kind) if kind else str(value)
        parts.append(f"{key.replace('_', ' ')} {_signs(text)}")
    if isinstance(element, Shaft) and element.stiffness is None:
        tube = [shown(element.torsional_stiffness, STIFFNESS, digits=4)]
        if element.moment_of_inertia:
            tube.append(shown(element.moment_of_inertia, INERTIA, digits=4))
        parts.append("hence " + ", ".join(_signs(t) for t in tube))
    if isinstance(element, Shaft) and element.loss_factor_frequency is not None:
        parts.append("hence " + _signs(shown(element.damping_coefficient, DAMPING, digits=4)))
    if isinstance(element, Loaded) and getattr(element, "inertia", None) is None:
        parts.append("hence " + _signs(shown(element.moment_of_inertia, INERTIA, digits=4)))
    return parts


def _listed(values: tuple[object, ...], kind: QuantityKind | None) -> str:
    """Quantities one after the other, or how many harmonics, curves or points there are."""
    if isinstance(values[0], PressureCurve):
        return f"of {len(values)} curve{'s' if len(values) > 1 else ''}"
    if isinstance(values[0], TorquePoint):
        return f"of {len(values)} points"
    if not all(isinstance(value, float) for value in values):
        return f"of {len(values)} harmonic{'s' if len(values) > 1 else ''}"
    return ", ".join(_signs(shown(value, kind)) if kind else str(value) for value in values if isinstance(value, float))


def with_signs(sentence: str) -> str:
    """A sentence with the signs of units, "N m", "kg m²" and "5°"; stars in names stay."""
    squared = re.sub(r"(?<=[ms])\^2\b", "²", re.sub(r"(?<=[Ngtm])[*·](?=[ms](?:\b|[\^²]))", " ", sentence))
    return re.sub(r"(?<=[0-9]) deg\b", "°", squared)


def _signs(text: str) -> str:
    return signs(text).replace(" deg", "°")


def joints(line: Driveline) -> Table:
    """What each joint alone makes of a constant speed: U = tan β sin β."""
    rows = []
    for name, element in zip(line.names, line.elements, strict=True):
        if not hasattr(element, "angle"):
            continue
        beta = abs(float(element.angle)) if element.kind == "HookeJoint" else np.nan
        row = {
            "joint": name,
            "kind": element.kind,
            "angle [°]": abs(float(element.angle)) / DEGREE,
            "irregularity alone [%]": 100 * np.tan(beta) * np.sin(beta),
            "lead and lag alone [°]": np.rad2deg(np.arcsin(np.tan(beta / 2) ** 2)),
        }
        rows.append(row)
    return Table.of(rows)


def fatigue(contents: Contents) -> Table | None:
    """Damage and life of every element with an S–N curve."""
    if contents.life is None:
        return None
    return Table.of(
        {key: _signs(v) if isinstance(v, str) else v for key, v in row.items()} for row in contents.life.table()
    )


def irregularity(contents: Contents) -> Table | None:
    """What each shaft does in the assembly, and the output."""
    turn = contents.turn
    if turn is None:
        return None
    from trunnion.response.kinetostatics.measures import equivalent_angle
    from trunnion.response.kinetostatics.measures import irregularity as nonuniform

    of_shafts = zip(turn.shafts, turn.speed, turn.shaft_ratio, strict=True)
    found = {name: nonuniform(speed, turn.input_speed * float(ratio)) for name, speed, ratio in of_shafts}
    found["output of the line"] = turn.irregularity
    return Table.of(
        {
            "shaft, as assembled": name,
            "irregularity [%]": 100 * u,
            "as one joint of [°]": np.rad2deg(equivalent_angle(u)),
        }
        for name, u in found.items()
    )


def crossings(contents: Contents, speed_unit: str, frequency_unit: str) -> Table:
    """Where excitations meet the modes of the loaded line in the speed range, by speed."""
    found, _ = _met(contents)
    return Table.of(
        {
            f"input speed [{speed_unit}]": c.speed * Words(speed_unit).factor,
            "excitation": c.line.name,
            "by": ", ".join(c.line.owners),
            "mode": c.mode,
            f"frequency [{frequency_unit}]": c.frequency * Words(frequency_unit).factor,
            "amplification": c.amplification,
        }
        for c in found
    )


def crossings_shown(contents: Contents) -> str:
    """Which of the crossings are in the table, where they are not all of them."""
    found, every = _met(contents)
    if len(found) == every:
        return ""
    return f"; the {len(found)} nearest to the operating speed of {every}, and trunnion campbell-diagram has all"


def _met(contents: Contents) -> tuple[list[Crossing], int]:
    """Crossings for the table, those nearest to the operating speed (or to the end of the range), and how many there
    are."""
    found = list(contents.campbell.crossings if contents.campbell else ())
    at = known_speed(contents.overview.line) or contents.overview.speed_range[1]
    near = sorted(found, key=lambda one: abs(one.speed - at))[:MOST_CROSSINGS]
    return sorted(near, key=lambda one: one.speed), len(found)


def checks(judged: Assessment) -> Table:
    """Every check that applies, the binding one first, what decides before what is shown only; reasons with ample
    margin are left to ``assess``."""
    rows: list[tuple[str, ...]] = []
    for row, check in zip(judged.table(), judged.checks, strict=True):
        if check.status is Status.NOT_APPLICABLE:
            continue
        margin = str(row["margin"]).replace(" ", TIED)
        because = check.because
        for words in (percent(check.margin), percent(check.margin, binding=False)):
            because = because.replace(f", {words}", "") if words else because
        if check.status is Status.NOT_JUDGED:
            because = because.split(";")[0]  # the findings say what to do
        elif check.status is Status.SATISFIED and len(rows) >= REASONS:
            because = ""
        rows.append((str(row["status"]), check.name, margin, str(row[f"speed [{judged.unit}]"]), _signs(because)))
    return Table(("", "check", "margin", f"at [{judged.unit}]", "because"), tuple(rows))


def not_applicable(judged: Assessment) -> tuple[str, ...]:
    """What was not judged because it does not apply, with the reason; what is switched off stands by itself."""
    off = {one.rule for one in judged.switched_off}
    aside = [c for c in judged.checks if c.status is Status.NOT_APPLICABLE and c.rule.name not in off]
    return tuple(f"{c.name}: {c.because}" for c in aside)


def resonances(contents: Contents, unit: str) -> Table:
    """Parametric resonance speeds in the range at which instability can begin."""
    able = [r for r in contents.overview.resonance_speeds if r.opens]
    return Table.of(
        {f"input speed [{unit}]": r.speed * Words(unit).factor, "kind": r.kind, "formula": r.label}
        for r in able[:MOST_RESONANCES]
    )


def torques(contents: Contents, unit: str) -> Table | None:
    """At the operating speed, and the largest in the range where the linear response can be trusted."""
    sweep = contents.sweep
    if sweep is None:
        return None
    here = contents.overview.stability.response if contents.overview.stability else None
    trusted = np.where(sweep.linear[:, None], sweep.torque_amplitude, -1.0)
    rows = []
    for j, name in enumerate(sweep.shafts):
        mean = amplitude = np.nan
        if here is not None:
            mean, amplitude = here.torque_mean[j], here.torque_amplitude[j]
            if not abs(mean) > 1e-4 * max(amplitude, 1e-9):  # its second-order part or rounding, not a load
                mean = 0.0
        most = int(np.nanargmax(trusted[:, j]))
        known = bool(np.any(sweep.linear))
        row = {
            "shaft": name,
            "mean, operating [N m]": mean,
            "amplitude, operating [N m]": amplitude,
            "largest amplitude [N m]": trusted[most, j] if known else np.nan,
            f"at [{unit}]": sweep.speed[most] * Words(unit).factor if known else np.nan,
        }
        rows.append(row)
    return Table.of(rows)


def under_load(contents: Contents) -> Table | None:
    """Every case: stability of the true motion and of the two linearisations, and the shaft that swings most."""
    return Table.of(_of_motion(motion) for motion in contents.loaded) if contents.loaded else None


def _of_motion(motion: LoadedMotion) -> dict[str, object]:
    response, linear = motion.response, motion.response.comparison
    worst = int(response.torque_peak_to_peak.argmax())
    return {
        "case": motion.case,
        "true motion": response.verdict,
        "growth rate [1/s]": response.growth_rate,
        "about zero twist [1/s]": linear.zero_twist.growth_rate if linear else np.nan,
        "about static twist [1/s]": linear.static_twist.growth_rate if linear else np.nan,
        "most loaded shaft": response.shafts[worst],
        "mean torque [N m]": response.torque_mean[worst],
        "peak to peak [N m]": response.torque_peak_to_peak[worst],
        "by linear theory [N m]": linear.linear_torque_peak_to_peak[worst] if linear else np.nan,
    }


def contacts(contents: Contents) -> Table | None:
    """Every case and every mesh or shaft with stages: sides touched, time between them, impacts."""
    found = [(motion.case, contact) for motion in contents.loaded for contact in motion.response.contacts]
    rows = [
        {
            "case": case,
            "spring": c.spring,
            "contact": c.contact,
            "in the softest stage [%]": 100 * c.play_share,
            "impacts per period": c.impacts,
            "fastest approach [rad/s]": c.approach_speeds.max() if c.rattles else np.nan,
            "impact energy per period [J]": c.impact_energy if c.rattles else np.nan,
        }
        for case, c in found
    ]
    return Table.of(rows) if rows else None


def bending(contents: Contents, unit: str) -> Table:
    """Bending critical speeds of tubes against the highest speed of the range."""
    high = contents.overview.speed_range[1]
    return Table.of(
        {
            "tube": b.shaft,
            f"critical speed of the tube [{unit}]": b.critical_speed * Words(unit).factor,
            f"of the input [{unit}]": b.input_speed * Words(unit).factor,
            "top of the range over it [%]": 100 * high / b.input_speed,
            "E": shown(b.young_modulus, PRESSURE, digits=4)
            + (" (from the shear modulus)" if b.assumed_modulus else ""),
        }
        for b in contents.bending
    )


def operation(contents: Contents, unit: str) -> Table:
    """Where the line runs."""
    seen, factor = contents.overview, Words(unit).factor
    low, high = seen.speed_range
    rows = [("speed range", f"{range_words(four(low * factor), four(high * factor))} {unit}")]
    if seen.operation.speed:
        rows.insert(0, ("operating speed", f"{four(seen.operation.speed * factor)} {unit}"))
    if seen.chart is not None:
        first, last = (np.rad2deg(a) for a in seen.angle_range)
        rows.append(("joint angles examined", f"{four(first)} to {four(last)}°"))
    for name, element in zip(seen.line.names, seen.line.elements, strict=True):
        if torque := getattr(element, "load_torque", 0.0):
            rows.append((f"load torque on {name}", f"{four(torque)} N m"))
    return Table(("", ""), tuple(rows))
