"""Results as tables of text, in units an engineer reads."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trunnion.analyses.assessment.check import Status, percent
from trunnion.analyses.assessment.result import Assessment
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Disk, Element
from trunnion.driveline.quantities import DAMPING, DEGREE, INERTIA, PRESSURE, STIFFNESS, Kind, shown
from trunnion.driveline.shafts import Shaft
from trunnion.reporting.contents import Contents
from trunnion.results.speeds import speed_factor

MOST_RESONANCES = 30
MOST_CROSSINGS = 30
REASONS = 5
"""Satisfied checks printed with their reasons."""
TIED = "\u00a0"
"""A space at which no line breaks."""


@dataclass(frozen=True)
class Table:
    """Column heads and rows of text; ``numeric`` columns are aligned right."""

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    @property
    def numeric(self) -> tuple[bool, ...]:
        """Whether a column holds numbers alone."""
        return tuple(all(_is_number(row[i]) for row in self.rows) for i in range(len(self.heads)))


def _is_number(text: str) -> bool:
    try:
        float(text.replace("−", "-").replace("–", "0") or "0")
    except ValueError:
        return False
    return True


def four(value: float) -> str:
    """Four figures with a true minus sign."""
    return f"{float(f'{value:.4g}'):.10g}".replace("-", "−") if np.isfinite(value) else "–"


def elements(line: Driveline) -> Table:
    """Every element with what it is and its numbers."""
    rows = []
    for i, (name, element) in enumerate(zip(line.names, line.elements, strict=True), start=1):
        after = f"after {element.after}; " if element.after else ""
        rows.append((str(i), name, element.kind, after + "; ".join(_numbers(element))))
    return Table(("no.", "name", "element", "numbers"), tuple(rows))


def _numbers(element: Element) -> list[str]:
    """Stated numbers with units, and what follows from a geometry."""
    parts = []
    for key, value in element.stated.items():
        if key in ("name", "after"):
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
    if isinstance(element, Disk) and element.inertia is None:
        parts.append("hence " + _signs(shown(element.moment_of_inertia, INERTIA, digits=4)))
    return parts


def _listed(values: tuple[object, ...], kind: Kind | None) -> str:
    """Quantities one after the other, or how many harmonics there are."""
    if not all(isinstance(value, float) for value in values):
        return f"of {len(values)} harmonic{'s' if len(values) > 1 else ''}"
    return ", ".join(_signs(shown(value, kind)) if kind else str(value) for value in values if isinstance(value, float))


def with_signs(sentence: str) -> str:
    """A sentence with the signs of units, "N·m", "kg·m²" and "5°"; stars in names stay."""
    squared = re.sub(r"(?<=[ms])\^2\b", "²", re.sub(r"(?<=[Ngtm])\*(?=[ms](?:\b|\^))", "·", sentence))
    return re.sub(r"(?<=[0-9]) deg\b", "°", squared)


def _signs(text: str) -> str:
    return text.replace("*", "·").replace("^2", "²").replace("^3", "³").replace(" deg", "°")


def modes(contents: Contents, unit: str) -> Table:
    """Natural frequencies and damping ratios."""
    rows = []
    for row in contents.overview.natural_frequencies.table(unit):
        frequency, damping = (four(float(str(row[key]))) for key in (f"frequency [{unit}]", "damping ratio"))
        rows.append((str(row["mode"]), frequency, damping, str(row["moves most"])))
    return Table(("mode", f"frequency [{unit}]", "damping ratio", "moves most"), tuple(rows))


def joints(line: Driveline) -> Table:
    """What each joint alone makes of a constant speed: U = tan β sin β."""
    rows = []
    for name, element in zip(line.names, line.elements, strict=True):
        if not hasattr(element, "angle"):
            continue
        beta = abs(float(element.angle))
        alone = 100 * np.tan(beta) * np.sin(beta) if element.kind == "HookeJoint" else float("nan")
        lead = np.rad2deg(np.arcsin(np.tan(beta / 2) ** 2)) if element.kind == "HookeJoint" else float("nan")
        rows.append((name, element.kind, four(beta / DEGREE), four(alone), four(lead)))
    return Table(("joint", "kind", "angle [°]", "irregularity alone [%]", "lead and lag alone [°]"), tuple(rows))


def irregularity(contents: Contents) -> Table | None:
    """What each shaft does in the assembly, and the output."""
    turn = contents.turn
    if turn is None:
        return None
    from trunnion.analyses.kinetostatics.measures import equivalent_angle
    from trunnion.analyses.kinetostatics.measures import irregularity as uneven

    rows = []
    for name, speed, ratio in zip(turn.shafts, turn.speed, turn.shaft_ratio, strict=True):
        u = uneven(speed, turn.input_speed * float(ratio))
        rows.append((name, four(100 * u), four(float(np.rad2deg(equivalent_angle(u))))))
    rows.append(("output of the line", four(100 * turn.irregularity), four(float(np.rad2deg(turn.equivalent_angle)))))
    return Table(("shaft, as assembled", "irregularity [%]", "as one joint of [°]"), tuple(rows))


def crossings(contents: Contents, speed_unit: str, frequency_unit: str) -> Table:
    """Where excitations meet the modes of the loaded line in the speed range."""
    found = contents.campbell.crossings if contents.campbell else ()
    rows = [
        (
            four(c.speed * speed_factor(speed_unit)),
            c.line.name,
            ", ".join(c.line.causes),
            f"{c.mode}",
            four(c.frequency * speed_factor(frequency_unit)),
            four(c.amplification),
        )
        for c in found
    ]
    heads = (
        f"input speed [{speed_unit}]", "excitation", "by", "mode", f"frequency [{frequency_unit}]", "amplification",
    )  # fmt: skip
    return Table(heads, tuple(rows[:MOST_CROSSINGS]))


def checks(judged: Assessment) -> Table:
    """Every check that applies, the binding one first; reasons with ample margin are left to ``assess``."""
    rows: list[tuple[str, ...]] = []
    for row, check in zip(judged.table(), judged.checks, strict=True):
        if check.status is Status.NOT_APPLICABLE:
            continue
        margin = str(row["margin"]).replace(" ", TIED)
        shown = percent(check.margin)
        because = check.because.replace(f", {shown}", "") if shown else check.because
        if check.status is Status.NOT_JUDGED:
            because = because.split(";")[0]  # the findings say what to do
        elif check.status is Status.SATISFIED and len(rows) >= REASONS:
            because = ""
        rows.append((str(row["status"]), check.name, margin, str(row[f"speed [{judged.unit}]"]), _signs(because)))
    return Table(("", "check", "margin", f"at [{judged.unit}]", "because"), tuple(rows))


def not_applicable(judged: Assessment) -> tuple[str, ...]:
    """What was not judged because it does not apply, with the reason."""
    return tuple(f"{c.name}: {c.because}" for c in judged.checks if c.status is Status.NOT_APPLICABLE)


def resonances(contents: Contents, unit: str) -> Table:
    """Parametric resonance speeds in the range that can open."""
    rows = [
        (four(r.speed * speed_factor(unit)), r.kind, r.label) for r in contents.overview.resonance_speeds if r.opens
    ]
    return Table((f"input speed [{unit}]", "kind", "formula"), tuple(rows[:MOST_RESONANCES]))


def torques(contents: Contents, unit: str) -> Table | None:
    """At the operating speed, and the largest in the range where the linear response can be trusted."""
    sweep = contents.sweep
    if sweep is None:
        return None
    here = contents.overview.stability
    trusted = np.where(sweep.linear[:, None], sweep.torque_amplitude, np.nan)
    rows = []
    for j, name in enumerate(sweep.shafts):
        now: Sequence[str] = ("–", "–")
        if here is not None and here.response is not None:
            mean = float(here.response.torque_mean[j])
            amplitude = float(here.response.torque_amplitude[j])
            # a mean far below the amplitude is its second-order part or rounding, not a load
            now = (four(mean if abs(mean) > 1e-4 * max(amplitude, 1e-9) else 0.0), four(amplitude))
        top = ("–", "–")
        if np.any(sweep.linear):
            i = int(np.nanargmax(trusted[:, j]))
            top = (four(float(trusted[i, j])), four(float(sweep.speed[i]) * speed_factor(unit)))
        rows.append((name, *now, *top))
    heads = (
        "shaft", "mean, operating [N·m]", "amplitude, operating [N·m]", "largest amplitude [N·m]", f"at [{unit}]",
    )  # fmt: skip
    return Table(heads, tuple(rows))


def under_load(contents: Contents) -> Table | None:
    """Every case: stability of the true motion and of the two linearisations, and the shaft that swings most."""
    if not contents.loaded:
        return None
    rows = []
    for motion in contents.loaded:
        response, linear = motion.response, motion.response.comparison
        worst = int(response.torque_peak_to_peak.argmax())
        rates = (four(linear.zero_twist.growth_rate), four(linear.static_twist.growth_rate)) if linear else ("–", "–")
        rows.append(
            (
                motion.case,
                str(response.verdict),
                four(response.growth_rate),
                *rates,
                response.shafts[worst],
                four(float(response.torque_mean[worst])),
                four(float(response.torque_peak_to_peak[worst])),
                four(float(linear.linear_torque_peak_to_peak[worst])) if linear else "–",
            )
        )
    heads = (
        "case", "true motion", "growth rate [1/s]", "about zero twist [1/s]", "about static twist [1/s]",
        "most loaded shaft", "mean torque [N·m]", "peak to peak [N·m]", "by linear theory [N·m]",
    )  # fmt: skip
    return Table(heads, tuple(rows))


def contacts(contents: Contents) -> Table | None:
    """Every case and every mesh or shaft with stages: sides touched, time between them, impacts."""
    rows = [
        (
            motion.case, c.spring, c.contact, four(100 * c.play_share), str(c.impacts),
            four(float(c.approach_speeds.max())) if c.rattles else "–", four(c.impact_energy) if c.rattles else "–",
        )
        for motion in contents.loaded
        for c in motion.response.contacts
    ]  # fmt: skip
    heads = (
        "case", "spring", "contact", "in the softest stage [%]", "impacts per period", "fastest approach [rad/s]",
        "impact energy per period [J]",
    )  # fmt: skip
    return Table(heads, tuple(rows)) if rows else None


def bending(contents: Contents, unit: str) -> Table:
    """Bending critical speeds of tubes against the highest speed of the range."""
    high = contents.overview.speed_range[1]
    rows = [
        (
            b.shaft,
            four(b.critical_speed * speed_factor(unit)),
            four(b.input_speed * speed_factor(unit)),
            four(100 * high / b.input_speed),
            shown(b.young_modulus, PRESSURE, digits=4) + (" (from the shear modulus)" if b.assumed_modulus else ""),
        )
        for b in contents.bending
    ]
    heads = (
        "tube", f"critical speed of the tube [{unit}]", f"of the input [{unit}]", "top of the range over it [%]", "E",
    )  # fmt: skip
    return Table(heads, tuple(rows))


def operation(contents: Contents, unit: str) -> Table:
    """Where the line runs."""
    seen, factor = contents.overview, speed_factor(unit)
    low, high = seen.speed_range
    rows = [("speed range", f"{four(low * factor)} to {four(high * factor)} {unit}")]
    if seen.operation.speed:
        rows.insert(0, ("operating speed", f"{four(seen.operation.speed * factor)} {unit}"))
    if seen.chart is not None:
        first, last = (np.rad2deg(a) for a in seen.angle_range)
        rows.append(("joint angles examined", f"{four(first)} to {four(last)}°"))
    for name, element in zip(seen.line.names, seen.line.elements, strict=True):
        if isinstance(element, Disk) and element.load_torque:
            rows.append((f"load torque on {name}", f"{four(element.load_torque)} N·m"))
    return Table(("", ""), tuple(rows))
