"""What the views show of a result, as plain arrays and texts; runs in the worker that holds the result."""

from __future__ import annotations

import math
import tempfile
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from trunnion.driveline.quantities import eye_unit
from trunnion.results.speeds import order_name
from trunnion.results.units import amplification_words
from trunnion.results.written import write_numbers

Plain = dict[str, Any]
MOST_ORDERS = 8
MOST_SAMPLES = 3000
ROUNDING = 1e-12
"""Share of the largest number beside it below which a value is rounding."""


def nothing(result: Any) -> None:
    """Nothing: the computation itself was wanted."""


def text(result: Any) -> str:
    """The result as it prints."""
    return str(result)


def sketch(result: Any) -> str:
    """The driveline as SVG."""
    from trunnion.plots.driveline_sketch import draw

    return drawn(draw(result))


def assessment(result: Any) -> Plain:
    """Verdict, checks and findings."""
    bind = result.binding
    return {
        "verdict": str(result.verdict),
        "sentence": result.sentence,
        "unit": result.unit,
        "element": bind.element if bind else "",
        "limit": bind.limit if bind else math.nan,
        "quantity": bind.unit if bind else "",
        "course": _course(bind.course) if bind and bind.course else {},
        "rows": result.table(),
        "rules": [_rule(c) for c in result.checks],
        "rests_on": result.rests_on,
        "switched_off": [str(one) for one in result.switched_off],
        "margin": [c.margin for c in result.checks],
        "findings": [str(f) for f in result.findings],
    }


def _course(course: Any) -> Plain:
    """What a check compares over speed: limits, the value, and its largest orders, in a unit for the eye."""
    symbol, size = eye_unit(max(float(one.max()) for one in course.limits.values()), course.kind)
    strongest = np.sort(np.argsort(-np.nan_to_num(course.by_order).max(axis=0, initial=0.0))[:3])
    orders = {order_name(course.order[k], course.frequency[k]): course.by_order[:, k] for k in strongest}
    curves = {f"all together ({course.says})": course.value, **orders, **course.limits}
    return {
        "quantity": course.quantity,
        "unit": symbol.replace("*", "·").replace("^2", "²"),
        "speed": course.speed,
        "names": list(curves),
        "values": [values / size for values in curves.values()],
        "limits": len(course.limits),
    }


def _rule(check: Any) -> str:
    """Name, formula, source and inputs of a check, those that it has."""
    parts = [check.rule.name, check.rule.formula, f"{check.rule.source} ({check.rule.certainty})", check.inputs]
    return "; ".join(part for part in parts if part)


def file(result: Any, ending: str, method: str, options: Plain, columns: tuple[str, ...]) -> bytes:
    """A picture (png, svg) or the data (csv, nc) of a result."""
    if ending in ("png", "svg"):
        return _picture(getattr(result, method)(**options), ending)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"data.{ending}"
        write_numbers(result, path, result.data[list(columns)] if columns else None)
        return path.read_bytes()


def report(result: Any) -> bytes:
    """The HTML report."""
    return str(result.html).encode()


def _picture(figure: Any, ending: str) -> bytes:
    figure = getattr(figure, "figure", figure)
    stream = BytesIO()
    figure.savefig(stream, format=ending, dpi=150)
    return stream.getvalue()


def torque_limits(result: Any) -> Plain:
    """Vibratory and largest torque over speed, by shaft."""
    return {
        "speed": result.speed,
        "springs": list(result.springs),
        "vibratory": result.vibratory_torque,
        "peak": result.peak_torque,
    }


def orders(result: Any, spring: str) -> Plain:
    """Torque of one shaft over speed: by order, the largest first, and over the cycle."""
    at = result.springs.index(spring)
    size = np.abs(result.torque[:, :, at])
    most = np.nan_to_num(size).max(axis=0)
    top = [int(k) for k in np.argsort(-most)[:MOST_ORDERS] if most[k] > 0]
    return {
        "speed": result.speed,
        "spring": spring,
        "names": [order_name(float(result.order[k]), float(result.frequency[k])) for k in top],
        "sizes": [size[:, k] for k in top],
        "vibratory": result.vibratory_torque[:, at],
        "peak": result.peak_torque[:, at],
        "bound": result.sum_is_bound,
    }


def findings(result: Any) -> list[str]:
    """What is to be read before the numbers."""
    return [str(f) for f in result.findings]


def wave(result: Any, spring: str) -> Plain:
    """Torque of one shaft over a period, at the one speed of the result."""
    form = result.wave()
    return {"time": form.time, "torque": form.torque[:, result.springs.index(spring)], "spring": spring}


def campbell(result: Any) -> Plain:
    """Modes, excitations and crossings."""
    return {
        "speed": result.speed,
        "mode": list(result.mode),
        "frequency": result.frequency,
        "lines": [(one.name, one.at(result.speed)) for one in result.lines],
        "crossing_speed": np.array([c.speed for c in result.crossings]),
        "crossing_frequency": np.array([c.frequency for c in result.crossings]),
        "crossing": [
            f"{c.line.name} ({', '.join(c.line.causes)}) on mode {c.mode}, "
            f"amplification {amplification_words(c.amplification)}"
            for c in result.crossings
        ],
    }


def modes(result: Any) -> Plain:
    """Frequencies, damping and shapes."""
    return {
        "frequency": result.frequency,
        "damping": result.damping_ratio,
        "shape": result.shape,
        "names": list(result.names),
    }


def remedies(result: Any) -> list[Plain]:
    """Changes that help, as sentences and numbers."""
    return [{"sentence": f"{r.check}: {r.sentence}", "variable": r.variable, "after": r.after} for r in result.remedies]


def chart(result: Any, zoom: Any = None) -> Plain:
    """Growth per turn of the input over the box, or over a part of it with points of its own."""
    if zoom is not None:
        result = result.zoom(*zoom)
    with np.errstate(divide="ignore"):
        growth = np.expm1(np.log(result.spectral_radius) * 2 * np.pi / result.period)
    return {"x": result.x, "y": result.y, "growth": growth, "text": str(result)}


def point(result: Any) -> Plain:
    """Multipliers, verdict and the fastest disturbance."""
    names = [str(n) for n in result.names]
    z = np.asarray(result.multipliers)
    column = int(np.abs(np.abs(z) - result.spectral_radius).argmin())  # those set aside may be the largest
    mode = result.floquet_modes[: len(names), column]
    largest = mode[np.argmax(np.abs(mode))] if len(mode) else 1.0
    turns = result.period / (2 * np.pi)
    return {
        "speed": result.speed,
        "multipliers": z,
        "radius": result.spectral_radius,
        "error": result.error_estimate,
        "verdict": str(result.verdict),
        "growth": result.growth_rate,
        "per_turn": math.expm1(math.log(result.spectral_radius) / turns) if result.spectral_radius > 0 else -1.0,
        "resonance": str(result.resonance or ""),
        "mode": mode / largest if largest else mode,
        "names": names,
    }


def motion(result: Any, speed: float) -> Plain:
    """Twist of every shaft over the turns of the input, at a constant speed [rad/s]."""
    turns = np.asarray(result.time) * speed / (2 * np.pi)
    keep = slice(None, None, max(1, len(turns) // MOST_SAMPLES))
    return {"turns": turns[keep], "names": list(result.shafts), "twist": [v[keep] for v in np.asarray(result.twist).T]}


def resonances(result: Any) -> Plain:
    """Speeds and names of parametric resonances that can open."""
    rows = [r for r in result.resonances if r.opens]
    return {"speed": [r.speed for r in rows], "name": [f"{r.kind} {r.formula}" for r in rows]}


def turn(result: Any) -> Plain:
    """Shafts and joints over the input angle."""
    mean = result.speed.mean(axis=1, keepdims=True)
    couple = np.linalg.norm(result.secondary_couple, axis=1)
    return {
        "input_angle": result.input_angle,
        "shafts": list(result.shafts),
        "deviation": _without_noise(result.speed / mean - 1, 1.0),
        "torque": result.transmitted,
        "joints": list(result.joints),
        "joint_angle": result.joint_angle,
        "forks": list(result.forks),
        "couple": _without_noise(couple, float(np.abs(result.transmitted).max(initial=0.0))),
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


def _without_noise(values: Any, size: float) -> Any:
    """Values whose rounding, beside numbers of this size, is zero: a picture would be scaled to it."""
    return np.where(np.abs(values) > ROUNDING * size, values, 0.0)


def phasing(result: Any) -> Plain:
    """Fork offsets that make the output uniform."""
    return {"offsets": dict(result.offsets), "text": str(result)}


def drawn(result: Any) -> str:
    """A figure as SVG."""
    return _picture(result, "svg").decode("utf-8")


def limit(result: Any) -> Plain:
    """Largest stable value at some speeds, and what is unstable between them."""
    others = [(o.name, np.where(o.reached <= result.high, o.reached, np.nan)) for o in result.others]
    return windows(result.whole) | {
        "speed": result.speed, "limit": result.limit, "high": result.high, "others": others, "text": str(result)
    }  # fmt: skip


def windows(result: Any) -> Plain:
    """Outlines of the regions behind stable windows, and the ends of the windows inside the range searched."""
    ends = sorted({float(v) for v in result.windows.ravel() if result.low < v < result.high})
    return {"speeds": result.speeds, "regions": outlines(result.tongues), "ends": ends, "text": str(result)}


def tongues(result: Any) -> Plain:
    """Outlines of the regions of instability, and what the search says."""
    return {"regions": outlines(result), "search": result.search}


def outlines(found: Any) -> list[tuple[str, Any, Any]]:
    """Name and closed outline (x, y) of every region."""
    return [
        (
            str(t.resonance or t.kind),
            np.concatenate([t.low, t.high[::-1], t.low[:1]]),
            np.concatenate([t.y, t.y[::-1], t.y[:1]]),
        )
        for t in found
    ]


def tolerances(result: Any) -> Plain:
    """What each tolerance explains of the scatter, and the probability in words."""
    return {
        "name": [name for name, _ in result.ranking],
        "value": [100 * share for _, share in result.ranking],
        "label": "explains of the scatter of the growth rate [%]",
        "text": str(result),
    }


def ranked(result: Any) -> Plain:
    """What the first of the checks follows most, and the smallest changes."""
    if not result.checks:
        return {"name": [], "value": [], "label": "", "text": "no check is exceeded or has little to spare"}
    check = result.checks[0]
    rows = result.strongest(check, 16)
    return {
        "name": [variable.path for variable, _ in rows],
        "value": [100 * change for _, change in rows],
        "label": f"change of {check} [%] for +1 % (an angle: +1 deg, a phase: +10 deg)",
        "text": str(result),
    }


def assembly(result: Any) -> Plain:
    """Irregularity by each error of assembly alone."""
    return {"name": list(result.names), "value": result.effect, "label": "change of irregularity", "text": str(result)}


def periodic(result: Any) -> Plain:
    """Torque of every shaft over a period of the true motion."""
    return {"time": result.time, "names": list(result.shafts), "torque": list(result.torque.T), "text": str(result)}


def waves(result: Any) -> Plain:
    """Torque of every spring over a period by linear theory."""
    form = result.wave()
    return {"time": form.time, "names": list(result.springs), "torque": list(form.torque.T)}


def run_up(result: Any) -> Plain:
    """Largest torque turn by turn, and in the steady motion; how the run ended."""
    steady = result.steady
    return {
        "speed": result.speed,
        "names": list(result.shafts),
        "largest": list(result.largest.T),
        "steady_speed": steady.speed if steady else np.zeros(0),
        "steady": list(steady.largest.T) if steady else [np.zeros(0)] * len(result.shafts),
        "ending": result.outcome.kind,
        "text": str(result),
    }


def best(result: Any, path: str) -> Plain:
    """The best value of a parameter, in SI units, and what it reaches."""
    return {"value": result.values[path], "text": str(result)}


def swept(result: Any, spring: str) -> Plain:
    """Half peak-to-peak torque of one spring at every step of a sweep."""
    return {"speed": result.value, "half": result.swing_of(spring) / 2, "text": str(result)}


def followed(result: Any, unit: str) -> Plain:
    """Half peak-to-peak torque along a followed response, and where it is stable; nothing where none was found."""
    size = {"speed": result.frequency, "half": result.half_peak_to_peak, "stable": result.stable}
    return {**(size if len(result.frequency) else {}), "text": result.describe(unit)}


def plotted(result: Any) -> Plain:
    """The picture that a result draws of itself, and how it prints."""
    return {"svg": drawn(result.plot()), "text": str(result)}
