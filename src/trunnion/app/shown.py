"""What the views show of a result, as pictures, plain arrays and texts; runs in the worker that holds the result."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Sequence
from contextlib import closing, suppress
from dataclasses import asdict, replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from trunnion.driveline.quantities import QuantityKind, shown, signs
from trunnion.errors import ComputationError
from trunnion.measured.signals.sources import opened
from trunnion.pictures import design, kinetostatics, orders
from trunnion.pictures.frequency_response import method_curve
from trunnion.pictures.modes import growing, mode_shape, multipliers
from trunnion.pictures.picture import Item, Key, Picture, Points
from trunnion.pictures.shared import stands
from trunnion.pictures.stability_chart import stability_chart
from trunnion.pictures.tongues import edges_of
from trunnion.reporting import tables
from trunnion.results.counts import counted
from trunnion.results.drawing import described
from trunnion.results.speeds import speed_factor
from trunnion.results.words import Words
from trunnion.results.written import write_numbers
from trunnion.studies.boundary import study_boundary

Plain = dict[str, Any]
MOST_SAMPLES = 3000
LEAST = 6.5
"""Width of the page of a sketch, in its units: a short line fills it."""
HELPFUL = 16
"""Numbers named that a check follows most."""


def nothing(result: Any) -> None:
    """Nothing: the computation itself was wanted."""


def text(result: Any) -> str:
    """The result as it prints."""
    return str(result)


def sketch(result: Any) -> str:
    """The driveline as SVG."""
    from trunnion.pictures.driveline_sketch import draw

    return drawn(draw(result))


def plotted(result: Any, **options: Any) -> Plain:
    """The picture of a result, and how it prints."""
    return {"picture": described(result, "plot")(result, **options), "text": str(result)}


def touchable(result: Any) -> Plain:
    """The driveline as SVG, and where its elements are on it."""
    from trunnion.pictures.driveline_sketch import draw, spots

    return {"svg": drawn(draw(result, LEAST)), "spots": [asdict(one) for one in spots(result, LEAST)]}


def study(result: Any, **options: Any) -> Plain:
    """How far a study is, its picture as soon as a point is there, and what else may be shown."""
    some, said = result.done > 0, str(result)
    if some and result.refinement is not None:
        with suppress(ComputationError):  # its first grid is not whole yet
            said += f"\n{study_boundary(result)}"
    try:
        picture = described(result, "plot")(result, **options) if some else None
    except ComputationError:
        picture = None
    return {
        "picture": picture, "text": said, "points": result.points, "done": result.done, "failed": result.failed,
        "quantities": [one.path for one in result.quantities],
        "grids": [axis.path for axis in result.design.axes if len(axis.values) > 1],
    }  # fmt: skip


campbell = tolerances = run_up = plotted
modes, wave = mode_shape, orders.wave


def limit(result: Any, unit: str, now: float) -> Plain:
    """The largest stable value over speed, or stable windows, and where the line stands ``now``."""
    found = plotted(result, unit=unit)
    panel = found["picture"].panel.with_items(stands(result.parameter, result.unit, now, "the line now"))
    return found | {"picture": replace(found["picture"], panels=(panel,))}


windows = limit


def assessment(result: Any) -> Plain:
    """Verdict, checks and findings; the margins, and what binds over speed."""
    bind = result.binding
    return {
        "verdict": str(result.verdict),
        "sentence": result.sentence,
        "unit": result.unit,
        "margins": design.margins(result),
        "course": orders.course(bind.course, unit=result.unit) if bind and bind.course else None,
        "rows": result.table(),
        "rules": [_rule(c) for c in result.checks],
        "rests_on": result.rests_on,
        "switched_off": [str(one) for one in result.switched_off],
        "findings": [str(f) for f in result.findings],
    }


def parts(result: Any) -> Plain:
    """What every part of a line is made of, and of those with a maker's sheet what it prints, what was typed of it and
    what the line has."""
    named = result.as_stated.parts
    return {"rows": list(tables.elements(result).rows), "sheets": [_sheet(*one) for one in named if one[1].sheet]}


def _sheet(name: str, element: Any) -> Plain:
    """The sheet of a part; numbers as they were typed beside those of the line, which is said where they differ."""
    sheet, departures = element.sheet, element.departures
    stated = element.stated
    made = [
        (
            key.replace("_", " "),
            _typed(typed, element.quantity_of(key)),
            _now(element, key, stated),
            "differs" if key in departures else "",
        )
        for key, typed in sheet.numbers.items()
    ]
    title, note = f"{name}: {sheet.component}", sheet.note or ""
    return {"title": title, "source": sheet.words, "note": note, "printed": dict(sheet.printed), "made": made}


def _typed(value: object, kind: QuantityKind | None) -> str:
    text = ", ".join(map(str, value)) if isinstance(value, list | tuple) else str(value)
    return signs(text) if kind else text


def _now(element: Any, key: str, stated: Plain) -> str:
    """A number of an element for the eye."""
    value, kind = stated.get(key), element.quantity_of(key)
    if value is None:
        return "left out"
    every = value if isinstance(value, tuple) else (value,)
    return ", ".join(shown(one, kind) if kind else str(one) for one in every)


def loads(result: Any) -> Plain:
    """What is judged of single parts, the one that binds first: their ratings, limits and guidelines against loads."""
    of_parts = tuple(c for c in result.checks if c.element)
    rows = [
        (c.element, row["check"], row["status"], row["margin"], row[f"speed [{result.unit}]"], row["because"])
        for c, row in zip(result.checks, result.table(), strict=True)
        if c.element
    ]
    picture = design.margins(replace(result, checks=of_parts)) if any(map(_has_margin, of_parts)) else None
    return {"sentence": result.sentence, "unit": result.unit, "rows": rows, "picture": picture}


def _has_margin(check: Any) -> bool:
    return bool(np.isfinite(check.margin))


def verdict_in_short(result: Any) -> Plain:
    """Verdict and what binds."""
    return {"verdict": str(result.verdict), "said": result.sentence}


def _rule(check: Any) -> str:
    """Name, formula, source and inputs of a check, those that it has."""
    parts = [check.rule.name, check.rule.formula, f"{check.rule.source} ({check.rule.certainty})", check.inputs]
    return "; ".join(part for part in parts if part)


def columns(result: Any, path: str) -> Plain:
    """Columns of a file of signals and how often the first of them was sampled [Hz], 0 where it does not say."""
    with closing(opened(Path(path))) as source:
        names = list(source.columns)
        return {"columns": names, "rate": source.rate(names[0]) or 0.0}


def measured(result: Any, channel: str = "") -> Plain:
    """Measured orders over predicted ones, a sentence on each, and the channels that there are."""
    every = [(k, c) for c in range(len(result.channels)) for k in range(len(result.order))]
    of_kind = {
        kind: [name for name, own in zip(result.channels, result.kinds, strict=True) if own == kind]
        for kind in ("rotation", "torque")
    }
    return {
        "picture": described(result, "plot")(result, channel=channel),
        "said": [result.sentence(k, c) for k, c in every],
        "findings": [str(f) for f in result.findings],
        "channels": list(result.channels),
        "references": of_kind["rotation"],
        "torques": of_kind["torque"],
    }


def measured_campbell(result: Any, channel: str = "") -> Picture:
    """Measured orders on the Campbell diagram of the line."""
    return described(result, "plot_campbell")(result, channel=channel)


def measured_run_up(result: Any, channel: str = "") -> Picture:
    """Largest measured torques on the run-up of the line."""
    return described(result, "plot_run_up")(result, channel=channel)


def file(result: Any, ending: str, method: str, options: Plain, columns: tuple[str, ...]) -> bytes:
    """A picture (png, svg) or the data (csv, nc) of a result, or what moves (html, gif, json)."""
    if ending in ("png", "svg"):
        return _picture(getattr(result, method)(**options), ending)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"data.{ending}"
        if ending in ("html", "gif", "json"):
            result.save(path)
        else:
            write_numbers(result, path, result.data[list(columns)] if columns else None)
        return path.read_bytes()


def scene(result: Any) -> str:
    """A motion as the player reads it."""
    return str(result.json)


def report(result: Any) -> bytes:
    """The HTML report."""
    return str(result.html).encode()


def _picture(figure: Any, ending: str) -> bytes:
    figure = getattr(figure, "figure", figure)
    stream = BytesIO()
    figure.savefig(stream, format=ending, dpi=150)
    return stream.getvalue()


def torque(result: Any, **options: Any) -> Picture:
    """Torque of a shaft over speed, by order: of the one loaded most, or of that in ``options``; see ``findings``."""
    return orders.torque_by_order(result, **options)


def findings(result: Any, **options: Any) -> Plain:
    """What is to be read before the numbers, and ``torque`` with the speeds marked at which the line is unstable.

    Takes longer: every speed is judged."""
    return {"said": [str(f) for f in result.findings], "picture": orders.order_response(result, **options)}


def remedies(result: Any) -> list[Plain]:
    """Changes that help, as sentences and numbers."""
    return [{"sentence": f"{r.check}: {r.sentence}", "variable": r.variable, "after": r.after} for r in result.remedies]


def chart(result: Any, unit: str, zoom: Any = None) -> Plain:
    """The chart, or of a part of it one with points of its own."""
    if zoom is not None:
        result = result.zoom(*zoom)
    return {"picture": stability_chart(result, unit=unit), "text": str(result)}


def tongues(result: Any, unit: str, pixel: float) -> Plain:
    """Edges of the regions of instability, where each begins, and what the search says; ``pixel`` as of the picture."""
    return {
        "edges": edges_of(result, unit, pixel),
        "begins": [(str(t.resonance or t.kind), *_lowest(t)) for t in result],
        "search": result.search,
    }


def _lowest(tongue: Any) -> tuple[float, float]:
    """The lowest place of a region's edges (x, y), in SI units."""
    k = int(np.argmin(tongue.y))
    return float(tongue.low[k]), float(tongue.y[k])


def point(result: Any) -> Plain:
    """Multipliers, verdict and the fastest disturbance."""
    turns = result.period / (2 * np.pi)
    return {
        "multipliers": np.asarray(result.multipliers),
        "circle": multipliers(result),
        "growing": growing(result),
        "speed": result.speed,
        "radius": result.spectral_radius,
        "error": result.error_estimate,
        "verdict": str(result.verdict),
        "growth": result.growth_rate,
        "per_turn": math.expm1(math.log(result.spectral_radius) / turns) if result.spectral_radius > 0 else -1.0,
        "resonance": str(result.resonance or ""),
    }


def growth(result: Any, unit: str) -> Plain:
    """Verdict and growth at one speed."""
    said = Words(unit).speed(result.speed)
    return {"verdict": str(result.verdict), "growth": float(result.growth_rate), "speed": said}


def worst(result: Any, unit: str) -> Plain:
    """Torque by order of the spring that is loaded most, by its limit where it has one, at the speeds looked at."""
    peak = np.nan_to_num(result.peak_torque)
    most, limits = peak.max(axis=0), [result.limits[name].get("max torque", np.nan) for name in result.springs]
    share = most / np.array(limits)
    k = int(np.nanargmax(share)) if np.isfinite(share).any() else int(most.argmax())
    name, at = result.springs[k], Words(unit).speed(float(result.speed[int(peak[:, k].argmax())]))
    of = f" of {limits[k]:.5g} N m allowed ({share[k]:.0%})" if np.isfinite(share[k]) else ""
    looked_at = counted(len(result.speed), "speed")
    said = f"{name}: {most[k]:.5g} N m, its mean included,{of} at {at}, of {looked_at} looked at, the line as stated"
    return {"picture": orders.torque_by_order(result, spring=name, unit=unit), "said": said}


def crossings(result: Any, unit: str) -> Plain:
    """The Campbell diagram, and where what excites the line meets a mode, the sharpest first."""
    words = Words(unit)
    sharp = sorted(result.crossings, key=lambda one: -one.amplification)
    rows = [(f"{one.speed * words.factor:.4g}", one.mode, one.line.name) for one in sharp]
    return {"picture": described(result, "plot")(result, unit=unit), "rows": rows, "unit": unit}


def near(result: Any, unit: str, speed: float) -> list[str]:
    """The speeds on either side at which a region of instability can begin, and how far they are."""
    able = [one for one in result if one.opens and np.isfinite(one.speed)]
    below, above = ([one for one in able if (one.speed - speed) * way > 0] for way in (-1, 1))
    nearest = [max(below, key=lambda one: one.speed)] if below else []
    nearest += [min(above, key=lambda one: one.speed)] if above else []
    words = Words(unit)
    said = [
        f"Instability can begin at {one.speed * words.factor:.4g} {unit}, {100 * abs(one.speed / speed - 1):.2g} % "
        f"{'below' if one.speed < speed else 'above'}: {one.name}"
        for one in nearest
    ]
    return said or ["No region of instability can begin: the line has no angled joint or varying mesh."]


def motion(result: Any, speed: float) -> Plain:
    """Twist of every shaft over the turns of the input, at a constant speed [rad/s]."""
    turns = np.asarray(result.time) * speed / (2 * np.pi)
    keep = slice(None, None, max(1, len(turns) // MOST_SAMPLES))
    return {"turns": turns[keep], "names": list(result.shafts), "twist": [v[keep] for v in np.asarray(result.twist).T]}


def turn(result: Any, unit: str, at: float) -> Plain:
    """Shafts and joints over the input angle, and the forks at one of them [deg]."""
    return {
        "picture": kinetostatics.kinetostatics(result, unit=unit),
        "forks": kinetostatics.forks(result, turn=at),
        "outputs": [_output(result.on_branch(name), len(result.branches) > 1) for name in result.branches],
        "findings": [str(f) for f in result.findings],
    }


def _output(result: Any, is_named: bool) -> Plain:
    """How evenly the output of ``result`` turns; its name where there are others."""
    return {
        "name": result.branch if is_named else "",
        "ratio": abs(result.mean_ratio),
        "irregularity": result.irregularity,
        "equivalent": result.equivalent_angle,
        "acceleration": result.peak_acceleration,
    }


def phasing(result: Any) -> Plain:
    """Fork offsets that make the output uniform."""
    return {"offsets": dict(result.offsets), "text": str(result)}


def drawn(result: Any) -> str:
    """A figure as SVG."""
    return _picture(result, "svg").decode("utf-8")


def ranked(result: Any) -> Plain:
    """What the first of the checks follows most, and the smallest changes."""
    if not result.checks:
        return {"picture": None, "text": "no check is exceeded or has little to spare"}
    check = result.checks[0]
    rows = result.strongest(check, HELPFUL)
    words = f"change of {check} [%] for +1 % (an angle: +1 deg, a phase: +10 deg)"
    return _bars([variable.path for variable, _ in rows], [100 * change for _, change in rows], words, str(result))


def assembly(result: Any) -> Plain:
    """Irregularity by each error of assembly alone."""
    return _bars(result.names, result.effect, "change of irregularity", str(result))


def _bars(names: Sequence[str], values: Sequence[float], words: str, said: str) -> Plain:
    return {"picture": design.ranked(names, values, words), "text": said}


def best(result: Any, path: str) -> Plain:
    """The best value of a parameter, in SI units, and what it reaches."""
    return {"value": result.values[path], "text": str(result)}


def swept(result: Any, spring: str, name: str, unit: str) -> Plain:
    """Half peak-to-peak torque of one spring at every step of a sweep, in the marks of its ``name``."""
    half: list[Item] = [Points(result.value * speed_factor(unit), result.swing_of(spring) / 2, name, name)]
    return {"items": half, "text": str(result)}


def followed(result: Any, name: str, unit: str) -> Plain:
    """Half peak-to-peak torque along a response followed by a method; nothing where none was found."""
    items = method_curve(name, result, speed_factor(unit)) if len(result.frequency) else []
    if len(result.frequency) and not result.stable.all():
        items.append(Key("unstable motions", "unstable"))
    return {"items": items, "text": result.describe(unit)}
