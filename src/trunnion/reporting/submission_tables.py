"""Tables of the report that is handed in, in the units a reviewer reads."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from trunnion.arrays import Array
from trunnion.design.assessment.check import Check, Status
from trunnion.driveline.elements import Disk
from trunnion.driveline.engine import Engine
from trunnion.driveline.excitation import Excitation
from trunnion.driveline.quantities import (
    ACCELERATION,
    ANGLE,
    POWER,
    PRESSURE,
    RATIO,
    SPEED,
    TORQUE,
    in_one_unit,
    shown,
    signs,
)
from trunnion.driveline.title_block import TitleBlock
from trunnion.equations.harmonics import disk_torques
from trunnion.errors import InputError
from trunnion.modes.mass_elastic import HolzerTable, SpringRow, masses, springs
from trunnion.reporting.submission_contents import ShaftTorque, SubmissionContents
from trunnion.reporting.tables import Table, four
from trunnion.results.counts import counted
from trunnion.results.speeds import order_name
from trunnion.results.units import range_words
from trunnion.results.words import HERTZ, Words

EMPTY = "–"
MILLI = 1e-3
"""Rotation [rad] of the mass that moves most in a Holzer table."""
FEW = 4
"""Checks that the sentence about a cylinder out of work names on the first sheet."""
FIRST_CHECKS = 8
"""Checks on the first page, which is one sheet."""
MOST_EXCITATIONS = 60
PREFIXES = (("M", 1e6, 1e8), ("k", 1e3, 1e4))
"""Prefixes of units, their sizes, and from which value on a column reads in them."""
LAST_FIGURE = 1e-4
"""Share of a value below which an error changes none of the four figures printed."""
ROUNDING = 1e-9
"""Share of the largest below which a number is printed as nothing."""
KIND_OF = {kind.unit: kind for kind in (ANGLE, TORQUE, PRESSURE, POWER, ACCELERATION, RATIO)}
"""Kinds of what checks compare, by the unit that they compare in."""
VIBRATORY, PEAK, HEAT = "vibratory_torque", "max_torque", "heat rating"
JOINTS = {
    "HookeJoint": "Hooke's joint", "IdealJoint": "constant-velocity joint", "RzeppaJoint": "Rzeppa joint",
    "TripodJoint": "tripod joint", "DoubleCardanJoint": "double Cardan joint",
}  # fmt: skip
"""Kinds of joints in words."""
ALIKE = 1e-6
"""Share by which cylinders that do the same may differ: the first of them is named."""
BY_STRESS = ("max_stress", "ship_shaft")
"""Limits of a shaft that are none of torque."""


def title_block(document: TitleBlock | None, made: str) -> Table:
    """What the document is."""
    of = document or TitleBlock()
    rows = [
        ("document", of.number or EMPTY),
        ("revision", of.revision or EMPTY),
        ("date", made),
        ("plant", of.plant or EMPTY),
    ]
    return Table(("", ""), tuple(rows))


def signatures(document: TitleBlock | None) -> Table:
    """Who answers for it, with room to sign."""
    of = document or TitleBlock()
    names = (("computed", of.author), ("checked", of.checked_by), ("approved", of.approved_by))
    return Table(("", "name", "date", "signature"), tuple((word, name or "", "", "") for word, name in names))


def particulars(contents: SubmissionContents) -> Table:
    """The line in a few numbers."""
    seen = contents.seen
    words = Words(seen.unit)
    low, high = seen.speed_range
    rows = [("running range", words.ends(low, high) + _own_speeds(contents))]
    if seen.speed:
        rows.append(("operating speed", words.speed(seen.speed)))
    if contents.powers:
        most = max(contents.powers, key=lambda one: one.power)
        rows.append(("largest mean power", f"{_power(most.power)}, in {most.spring} at {words.speed(most.speed)}"))
    if seen.line.operation and (cases := seen.line.operation.load_cases):
        rows.append(("load cases", ", ".join(["as described", *(case.name for case in cases)])))
    count = len(masses(seen.assembly)), len(springs(seen.assembly))
    rows.append(
        ("model", f"{count[0]} {'mass' if count[0] == 1 else 'masses'}, {counted(count[1], 'spring')}, torsion only")
    )
    elastic = seen.natural_frequencies.elastic
    if len(elastic):
        lowest = ", ".join(four(float(one) * HERTZ.factor) for one in elastic[:3])
        rows.append(("lowest undamped modes", f"{lowest} Hz"))
    if contents.normal is not None:
        rows.append(("all cylinders firing", _firing(contents.normal)))
    if contents.misfiring or contents.unsearched:
        rows.append(("a cylinder out of work", _malfunction(contents)))
    if contents.left_out:
        rows.append(("left out", "not all computed, see section 10"))
    return Table(("", ""), tuple(rows))


def _own_speeds(contents: SubmissionContents) -> str:
    """Between which speeds the load cases of a line run that runs at one speed in each."""
    (low, high), words = contents.seen.speed_range, Words(contents.seen.unit)
    speeds = [one.speed for one in contents.powers if one.case]
    if low != high or not speeds:
        return ""
    return f", load cases {range_words(words.rounded(min(speeds)), words.rounded(max(speeds)))}"


def _firing(checks: tuple[Check, ...]) -> str:
    """How the checks end with all cylinders firing, where the verdict is also about those out of work."""
    exceeded = [check.name for check in checks if check.exceeded]
    if exceeded:
        return f"exceeded: {exceeded[0] if len(exceeded) == 1 else counted(len(exceeded), 'check')}, section 6"
    return "not all judged" if any(check.missing for check in checks) else "checks of torque satisfied"


def _malfunction(contents: SubmissionContents) -> str:
    """How the checks end with a cylinder out of work, in a few words; the sheet names those exceeded at its top."""
    unknown = contents.unsearched or any(one.ended or any(c.missing for c in one.checks) for one in contents.misfiring)
    if exceeded_by_malfunction(contents):
        return "exceeded, see section 6"
    return "not all judged, see section 6" if unknown else "checks of torque satisfied, section 6"


def exceeded_by_malfunction(contents: SubmissionContents) -> tuple[str, ...]:
    """Names of the checks that a cylinder out of work exceeds."""
    return tuple(dict.fromkeys(c.name for one in contents.misfiring for c in one.checks if c.exceeded))


def malfunction_on_first_sheet(contents: SubmissionContents) -> tuple[str, ...]:
    """The same, few of many; section 6 has them all."""
    names = exceeded_by_malfunction(contents)
    return names if len(names) <= FEW else (*names[: FEW - 1], f"{len(names) - FEW + 1} more")


def _power(watts: float) -> str:
    return f"{watts / 1e3:.4g} kW" if watts < 1e6 else f"{watts / 1e6:.4g} MW"


def first_checks(contents: SubmissionContents) -> Table:
    """The checks that decide, the binding one first, eight at most."""
    words = Words(contents.seen.unit)
    judged = [check for check in contents.seen.assessment.checks if check.exceeded or check.satisfied or check.missing]
    rows = [
        (str(c.status), c.name, c.margin_word, _speed(c.speed, words), *_sides(c, words)) for c in judged[:FIRST_CHECKS]
    ]
    heads = ("", "check", "margin", f"at [{contents.seen.unit}]", "value", "limit")
    return Table(heads, tuple(rows))


def more_checks(contents: SubmissionContents, shown: int) -> int:
    """How many checks that decide stand on later sheets only, where ``shown`` stand on the first."""
    checks = contents.seen.assessment.checks
    return sum(c.exceeded or c.satisfied or c.missing for c in checks) - shown


def _quantity(value: float, unit: str, words: Words) -> str:
    """A value of a check in the unit that suits it, speeds in that of the line."""
    if not np.isfinite(value):
        return EMPTY
    if unit == SPEED.unit:
        return f"{four(value * words.factor)} {words.unit}"
    kind = KIND_OF.get(unit)
    return _typeset(shown(value, kind, digits=4)) if kind else f"{four(value)} {signs(unit)}"


def _speed(speed: float, words: Words) -> str:
    return four(speed * words.factor) if np.isfinite(speed) else ""


def mass_table(contents: SubmissionContents) -> Table:
    """Masses of the mass–elastic system."""
    return Table.of(
        {
            "no.": i,
            "mass": row.name,
            "inertia [kg m²]": row.inertia,
            "speed over the input's": row.speed_ratio,
            "referred to the input [kg m²]": row.referred,
        }
        for i, row in enumerate(masses(contents.seen.assembly), start=1)
    )


def spring_table(contents: SubmissionContents) -> Table:
    """Springs of the mass–elastic system, at the speed of the mass behind them."""
    rows, numbers = springs(contents.seen.assembly), _numbers(contents)
    prefix, size = _prefix(row.stiffness for row in rows)
    return Table.of(
        {
            "spring": row.name,
            "masses": _between(row, numbers),
            f"stiffness [{prefix}N m/rad]": row.stiffness / size,
            f"referred to the input [{prefix}N m/rad]": row.referred / size,
            "damping [N m s/rad]": row.damping,
            "loss factor": _loss(row),
            "smallest diameter [mm]": 1e3 * row.diameter,
        }
        for row in rows
    )


def _numbers(contents: SubmissionContents) -> dict[str, int]:
    """Of masses by name, as their table has them."""
    return {row.name: i for i, row in enumerate(masses(contents.seen.assembly), start=1)}


def _between(row: SpringRow, numbers: dict[str, int]) -> str:
    """The two masses by number; what drives the line by name."""
    return " – ".join(str(numbers.get(name, name)) for name in row.between)


def _loss(row: SpringRow) -> str:
    """As stated, with the frequency from which its damping follows; of one that holds at all frequencies alone."""
    if np.isfinite(row.loss_frequency):
        return f"{four(row.stated_loss)} at {HERTZ.speed(row.loss_frequency)}"
    return four(row.loss) if row.loss else EMPTY


def _prefix(values: Iterable[float]) -> tuple[str, float]:
    """Of a column that reads in N m or N m/rad without many noughts: "", "k" or "M", and its size."""
    largest = max((abs(one) for one in values if np.isfinite(one)), default=0.0)
    return next(((name, size) for name, size, least in PREFIXES if largest >= least), ("", 1.0))


def holzer_table(contents: SubmissionContents, mode: HolzerTable) -> tuple[Table, Table]:
    """Masses and springs of one mode, at ±1 mrad of the mass that moves most: inertia, amplitude, torque of inertia;
    then what these add up to in each spring, its stiffness, its twist."""
    amplitudes, inertial, between = (
        _without_rounding(one) for one in (mode.amplitude, mode.inertia_torque, mode.torque)
    )
    listed, held, numbers = masses(contents.seen.assembly), springs(contents.seen.assembly), _numbers(contents)
    prefix, size = _prefix([*(MILLI * inertial), *(MILLI * between)])
    stiff, unit = _prefix(row.stiffness for row in held)
    balance = [
        {
            "no.": numbers[row.name],
            "mass": row.name,
            "J [kg m²]": row.inertia,
            "amplitude": float(amplitude),
            f"J ω² θ [{prefix}N m]": MILLI * float(torque) / size,
        }
        for row, amplitude, torque in zip(listed, amplitudes, inertial, strict=True)
    ]
    at = dict(mode.nodes)
    in_springs = [
        {
            "spring": row.name,
            "masses": _between(row, numbers),
            f"k [{stiff}N m/rad]": row.stiffness / unit,
            f"torque [{prefix}N m]": MILLI * float(torque) / size,
            "twist [mrad]": float(torque) / row.stiffness if row.stiffness else np.nan,
            "node [%]": f"{100 * at[row.name]:.0f}" if row.name in at else "",
        }
        for row, torque in zip(held, between, strict=True)
    ]
    return Table.of(balance), Table.of(in_springs)


def _without_rounding(values: Array) -> Array:
    """Zero where a value is rounding beside the largest."""
    return np.where(np.abs(values) > ROUNDING * np.abs(values).max(initial=0.0), values, 0.0)


def excitations(contents: SubmissionContents) -> Table:
    """Everything that excites: harmonics of disks, joints, meshes; at the operating speed too, where there is one."""
    sizes, speed = _at_speed(contents), contents.seen.speed
    prefix, unit = _prefix(abs(one) for one in sizes.values())
    rows, heads = list(_excitations(contents, sizes, unit)), ["element", "excitation", "amplitude", "phase [°]"]
    if speed:
        there = Words(contents.seen.unit).speed(speed)
        heads += [f"at {there} [{prefix}N m]", f"phase at {there} [°]"]
    if len(rows) > MOST_EXCITATIONS:
        left = len(rows) - MOST_EXCITATIONS
        rows = [*rows[:MOST_EXCITATIONS], ("", f"and {left} more, in the description", "", "", "", "")]
    return Table(tuple(heads), tuple(row[: len(heads)] for row in rows))


def _at_speed(contents: SubmissionContents) -> dict[tuple[str, int], complex]:
    """A e^{iφ} [N m] at the operating speed, by disk and number of the harmonic there; of one cylinder."""
    seen, found = contents.seen, {}
    if not seen.speed:
        return {}
    row = seen.assembly.table(1, seen.speed)
    for one in disk_torques(seen.assembly):
        try:
            found[one.name, one.number] = complex(replace(one, cylinders=1.0).size(seen.assembly, row)[0])
        except InputError:  # a table that does not hold the speed
            continue
    return found


def _excitations(
    contents: SubmissionContents, sizes: dict[tuple[str, int], complex], unit: float
) -> Iterator[tuple[str, str, str, str, str, str]]:
    """Of every element as it is stated: of an engine what one cylinder does, in its own phase. ``sizes`` at the
    operating speed are in ``unit`` N m."""
    for name, element in contents.seen.line.as_stated.parts:
        several = isinstance(element, Engine) and len(element.firing_order) > 1
        called = f"{name}, each cylinder" if several else name
        shakes = element.of_one_cylinder if isinstance(element, Engine) else getattr(element, "excitation", ())
        disk = _firing_throw(name, element) if isinstance(element, Engine) else name
        for i, one in enumerate(shakes, start=1):
            phase = four(float(np.rad2deg(one.phase))) if not one.phases else "table"
            known = sizes.get((disk, i))
            there = ("", "") if known is None else (four(abs(known) / unit), four(float(np.rad2deg(np.angle(known)))))
            yield called, order_name(one.order or 0.0, one.frequency or 0.0), _size(one), phase, *there
        if isinstance(element, Disk) and element.firing_angles:
            angles = ", ".join(four(float(np.rad2deg(angle))) for angle in element.firing_angles)
            yield name, f"{len(element.firing_angles)} cylinders", "each as above", f"firing at {angles}", "", ""
        if hasattr(element, "angle") and element.angle:
            angle = four(float(np.rad2deg(element.angle)))
            orders = getattr(element, "orders", ())
            counted = f"order{'s' if len(orders) > 1 else ''} {' and '.join(map(str, orders))} of its shaft"
            yield (
                name,
                f"{JOINTS.get(element.kind, element.kind)}, {counted if orders else 'even'}",
                f"joint angle {angle}°",
                "",
                "",
                "",
            )


def _firing_throw(name: str, engine: Engine) -> str:
    """The first of its disks all of whose cylinders fire; "" where there is none."""
    silent = {engine.throw_of(one) for one in (engine.misfiring, engine.cut_out) if one is not None}
    made = [one for one in engine.made_of(name) if isinstance(one, Disk)]
    return next((str(one.name) for j, one in enumerate(made, start=1) if j not in silent), "")


def _size(one: Excitation) -> str:
    """The amplitude of an excitation in words."""
    if one.amplitude is not None:
        return _torque(one.amplitude)
    if one.quadratic_amplitude is not None:
        return f"{four(one.quadratic_amplitude)}\N{NO-BREAK SPACE}N\N{NO-BREAK SPACE}m\N{NO-BREAK SPACE}s² times ω²"
    if one.share is not None:
        return f"{four(100 * one.share)} % of the mean torque"
    return f"table of {len(one.amplitudes)}, up to {_torque(one.largest)}"


def _torque(value: float) -> str:
    """In one piece."""
    return signs(shown(value, TORQUE, digits=4)).replace(" ", "\N{NO-BREAK SPACE}")


def engines(contents: SubmissionContents) -> Table | None:
    """Cylinder data of every engine, as stated."""
    found = [(name, one) for name, one in contents.seen.line.as_stated.parts if isinstance(one, Engine)]
    if not found:
        return None
    across = Table.of(_engine(one) for _, one in found)
    rows = ((head, *(row[i] for row in across.rows)) for i, head in enumerate(across.heads))
    return Table(("", *(name for name, _ in found)), tuple(row for row in rows if {*row[1:]} != {EMPTY}))


def _engine(engine: Engine) -> dict[str, object]:
    def millimetres(length: float | None) -> float:
        return np.nan if length is None else 1e3 * length

    mass = engine.reciprocating_mass
    return {
        "strokes": engine.strokes,
        "cylinders": len(engine.firing_order),
        "firing order": "-".join(map(str, engine.firing_order)),
        "firing at [°]": ", ".join(four(float(np.rad2deg(angle))) for angle in engine.firing_angles),
        "bank angle [°]": np.nan if engine.bank_angle is None else float(np.rad2deg(engine.bank_angle)),
        "bore [mm]": millimetres(engine.bore),
        "stroke [mm]": millimetres(engine.stroke),
        "rod [mm]": millimetres(engine.rod_length),
        "reciprocating mass [kg]": np.nan if mass is None else float(mass),
        "gas torque by": _gas(engine),
        "crank stiffness by": _stiffness(engine),
        "crank damping by": _damping(engine),
    }


def _gas(engine: Engine) -> str:
    """What the gas torque follows from."""
    if engine.mean_indicated_pressure:
        means = ", ".join(four(one / 1e5) for one in engine.mean_indicated_pressure)
        return f"the ideal cycle of mean indicated pressure {means} bar; no table"
    if engine.pressure:
        count = len(engine.pressure)
        return f"{count} pressure curves over load" if count > 1 else "a pressure curve, at all loads"
    return "harmonics as stated" if engine.gas_torque else "none"


def _stiffness(engine: Engine) -> str:
    """Whose number the stiffness of the crank between its throws is."""
    if engine.rigid:
        return "none, taken as rigid"
    return "as stated" if engine.stiffness_of_throw is None else engine.stiffness_formula.title()


def _damping(engine: Engine) -> str:
    """What damps the crank between its throws, and whose number it is."""
    if engine.damping_rule is not None:
        return f"loss factor {four(engine.crank_loss_factor or 0.0)} after {engine.damping_rule.title()}"
    stated = engine.damping or engine.loss_factor
    return "as stated" if stated else "none stated"


def powers(contents: SubmissionContents) -> Table:
    """Mean torque and power of the spring that carries most, over the range."""
    words = Words(contents.seen.unit)
    several = len(contents.cases) > 1
    prefix, size = _prefix(one.torque for one in contents.powers)
    return Table.of(
        {
            **({"load case": one.case or "as described"} if several else {}),
            f"input speed [{words.unit}]": one.speed * words.factor,
            "in": one.spring,
            f"mean torque [{prefix}N m]": one.torque / size,
            "power [kW]": one.power / 1e3,
        }
        for one in contents.powers
    )


def shafts(contents: SubmissionContents) -> Table:
    """Largest torques of every spring beside the limits stated for it."""
    words, several = Words(contents.seen.unit), len(contents.cases) > 1
    prefix, size = _prefix(one.peak.value for one in contents.shafts)
    return Table.of(
        {
            "spring": one.spring,
            f"vibratory [{prefix}N m]": one.vibratory.value / size,
            f"at [{words.unit}]": one.vibratory.speed * words.factor,
            "leading order": one.leading,
            f"its limit [{prefix}N m]": _limit(contents, one.spring, VIBRATORY, "vibratory_torque", size),
            "vibratory stress [MPa]": one.stress / 1e6,
            f"peak [{prefix}N m]": one.peak.value / size,
            f"peak at [{words.unit}]": one.peak.speed * words.factor,
            f"limit of peak [{prefix}N m]": _limit(contents, one.spring, PEAK, "maximum_torque", size),
            **({"load case": _cases(one)} if several else {}),
        }
        for one in contents.shafts
    )


def _cases(one: ShaftTorque) -> str:
    """The load case of a spring's largest torques, or of each where they are of two."""
    vibratory, peak = (found.case or "as described" for found in (one.vibratory, one.peak))
    return peak if vibratory == peak else f"{vibratory}; peak: {peak}"


def _limit(contents: SubmissionContents, spring: str, key: str, rating: str, size: float) -> str:
    """The least limit of torque, in ``size`` N m, that the file or a maker states for a spring; what else bounds it."""
    names = spring.split(" and ")
    stated = [(one.key, one.value) for one in contents.seen.line.limits_by_element if one.element in names]
    parts = dict(contents.seen.line.parts)
    rated = [getattr(parts[name], rating, None) for name in names if name in parts]
    known = [value for own, value in stated if own == key] + [float(one) for one in rated if one is not None]
    if known:
        return four(min(known) / size)
    return "by stress" if any(own in BY_STRESS for own, _ in stated) else EMPTY


def misfires(contents: SubmissionContents) -> Table:
    """Every spring with all cylinders firing and with the worst of them out of work."""
    words = Words(contents.seen.unit)
    prefix, size = _prefix(one.value for one in contents.firing)

    def row(s: int, spring: str) -> dict[str, object]:
        found: dict[str, object] = {"spring": spring, f"all firing [{prefix}N m]": contents.firing[s].value / size}
        for how in dict.fromkeys(one.how for one in contents.misfiring):
            of_how = [one for one in contents.misfiring if one.how == how]
            most = max(one.vibratory[s].value for one in of_how)
            worst = next(one for one in of_how if not one.vibratory[s].value < most * (1 - ALIKE))
            top = worst.vibratory[s]
            found[f"one {how} [{prefix}N m]"] = top.value / size
            found[f"{how}, worst"] = worst.cylinder
            found[f"{how}, at [{words.unit}]"] = top.speed * words.factor
        return found

    return Table.of(row(s, shaft.spring) for s, shaft in enumerate(contents.shafts))


def firing_checks(contents: SubmissionContents) -> Table:
    """Every check of the response with all cylinders firing, where section 9 has the worst with one out of work."""
    words = Words(contents.seen.unit)
    judged = [one for one in contents.normal or () if one.exceeded or one.satisfied or one.missing]
    ordered = sorted(judged, key=_severity)
    rows = [(str(c.status), c.name, c.margin_word, _speed(c.speed, words), *_sides(c, words)) for c in ordered]
    return Table(("", "check", "margin", f"at [{words.unit}]", "value", "limit"), tuple(rows))


def misfire_checks(contents: SubmissionContents) -> Table:
    """Every check of the response that decides, with the cylinder out of work that comes nearest to its limit."""
    words = Words(contents.seen.unit)
    found: dict[str, tuple[Check, str]] = {}
    for one in contents.misfiring:
        for check in one.checks:
            known = found.get(check.name)
            if known is None or _severity(check) < _severity(known[0], ALIKE):
                found[check.name] = check, str(one)
    ordered = sorted(found.values(), key=lambda one: _severity(one[0]))
    rows = [
        (str(c.status), c.name, c.margin_word, _speed(c.speed, words), *_sides(c, words), cylinder)
        for c, cylinder in ordered
    ]
    heads = ("", "check", "margin", f"at [{words.unit}]", "value", "limit", "out of work")
    return Table(heads, tuple(rows))


def _severity(check: Check, less: float = 0.0) -> tuple[bool, float]:
    """Exceeded first, then by margin, of which so much is taken; what could not be judged before what is
    satisfied."""
    return check.satisfied, check.margin - less if np.isfinite(check.margin) else -np.inf


def _sides(check: Check, words: Words) -> tuple[str, str]:
    """Value and limit, in one unit."""
    kind = KIND_OF.get(check.unit)
    if kind and np.isfinite(check.value) and np.isfinite(check.limit):
        value, limit = in_one_unit(check.value, check.limit, kind)
        return _typeset(value), _typeset(limit)
    return _quantity(check.value, check.unit, words), _quantity(check.limit, check.unit, words)


def _typeset(quantity: str) -> str:
    return signs(quantity).replace(" deg", "°")


def crossings(contents: SubmissionContents) -> Table:
    """Critical speeds: where excitations meet modes in the range."""
    words = Words(contents.seen.unit)
    found = contents.campbell.crossings if contents.campbell else ()
    return Table.of(
        {
            f"critical speed [{words.unit}]": one.speed * words.factor,
            "mode": one.mode,
            "frequency [Hz]": one.frequency * HERTZ.factor,
            "excitation": one.line.name,
            "by": ", ".join(one.line.owners),
            "amplification": one.amplification,
        }
        for one in found
    )


def heats(contents: SubmissionContents) -> Table:
    """Springs that become warm, with the heat that they are rated for."""
    words = Words(contents.seen.unit)
    rated = {c.element: c.limit for c in contents.seen.assessment.checks if HEAT in c.name}

    def rating(spring: str) -> float:
        return min((rated[name] for name in spring.split(" and ") if name in rated), default=np.nan)

    return Table.of(
        {
            "spring": one.spring,
            "heat [W]": one.heat.value,
            f"at [{words.unit}]": one.heat.speed * words.factor,
            "rating [W]": rating(one.spring),
        }
        for one in contents.shafts
        if one.heat.value > 0
    )


def rules(contents: SubmissionContents) -> Table:
    """Every check with the rule it stands on, where it was searched and what its value may be low by."""
    seen = contents.seen
    words = Words(seen.unit)
    return Table.of(
        _rule(check, words) for check in seen.assessment.checks if check.status is not Status.NOT_APPLICABLE
    )


def _rule(check: Check, words: Words) -> dict[str, object]:
    searched: Iterable[tuple[float, float]] = check.covered
    value, limit = _sides(check, words)
    return {
        "check": check.name,
        "result": _result(check),
        "rule": check.rule.formula,
        "source": f"{check.rule.source} ({check.rule.certainty})",
        "value": value,
        "limit": limit,
        f"searched [{words.unit}]": " and ".join(words.ends(*ends) for ends in searched) or EMPTY,
        "may be low by": _error(check, words),
    }


def _result(check: Check) -> str:
    """ "satisfied, 31 % free", "exceeded by 54 %"."""
    if check.margin_word.startswith(check.words):
        return check.margin_word
    return f"{check.words}{f', {check.margin_word}' if check.margin_word else ''}"


def _error(check: Check, words: Words) -> str:
    """By one figure where four of the value could change."""
    if np.isfinite(check.error) and check.error < LAST_FIGURE * abs(check.value):
        return f"< {100 * LAST_FIGURE:g} %"
    return _quantity(float(f"{check.error:.1g}"), check.unit, words)
