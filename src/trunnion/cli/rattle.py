"""The commands about backlash: frequency-response, sweep."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Final

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.options import Json, OutputNoTable, read_line, read_set, read_speed
from trunnion.cli.places import PICTURES_AND_DATA, check_places, deliver
from trunnion.errors import InputError

GEARS: Final = "gear-rattle"
DEAD_ZONE = "dead-zone-oscillator"
Subject = Annotated[
    str,
    typer.Argument(
        metavar="NAME", help="gear-rattle, dead-zone-oscillator, another reference system, or a driveline file."
    ),
]
From = Annotated[
    str | None,
    typer.Option(
        "--from", help='Lowest frequency, "40 Hz", or speed, "300 rpm"; a number is in the unit that is printed.'
    ),
]
To = Annotated[str | None, typer.Option("--to", help="Highest frequency or speed.")]
Set = Annotated[
    list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="A number of the system; repeat it for more.")
]


def frequency_response(
    name: Subject,
    low: From = None,
    high: To = None,
    method: Annotated[
        list[str] | None,
        typer.Option("--method", help="exact, harmonic balance, averaging, …; repeat it, or write all."),
    ] = None,
    parameters: Set = None,
    fit_range: Annotated[
        float | None, typer.Option("--fit-range", help="Of the cubic fit of averaging and multiple scales [x].")
    ] = None,
    harmonics: Annotated[int | None, typer.Option("--harmonics", help="Of harmonic balance.", min=1)] = None,
    curve: Annotated[
        str, typer.Option("--curve", help="State of a system or shaft of a line to look at; default: the first.")
    ] = "",
    to: OutputNoTable = None,
    as_json: Json = False,
) -> None:
    """Frequency response with folds, jumps and stability, by one method or several.

    Example: trunnion frequency-response gear-rattle --method all -o response.png
    """
    from trunnion.motion.orbits.frequency_response import ResponseComparison, methods_of

    subject, length = _subject(name, parameters)
    unit = _unit(subject)
    first, last = _range(subject, low, high)
    check_places(to, PICTURES_AND_DATA)
    known = methods_of(subject)
    # The exact motion of longer lines is for those without joints: asked for by name.
    every = known if isinstance(subject, tn.PiecewiseOscillator) else known[:2]
    chosen = list(every) if method == ["all"] else (method or [known[0]])
    if "shooting" in chosen and known[0] == "shooting":
        output.note("following the motions through their contacts, which may take minutes; a narrower range is quicker")
    with output.progress("frequency response") as advance:
        shares = _shares(advance, chosen)
        found = ResponseComparison(
            {
                m: tn.frequency_response(
                    subject, first, last, method=m, curve=curve, **_options(m, fit_range, harmonics, shares[m])
                )
                for m in chosen
            }
        )
    for response in found.responses.values():
        if not len(response.frequency):
            response.outcome.require()
    one = found.responses[chosen[0]]
    text = one.describe(unit) if len(chosen) == 1 else f"{found.describe(unit)}\n\n{one.describe(unit)}"
    deliver(
        "frequency-response", name, one, to, as_json,
        draw=lambda: found.plot(length=length, unit=unit), content=lambda: {"methods": _json(found)}, text=lambda: text,
    )  # fmt: skip


def sweep(
    name: Subject,
    low: From = None,
    high: To = None,
    points: Annotated[int, typer.Option("--points", help="Frequencies.", min=2, max=100_000)] = 101,
    direction: Annotated[str, typer.Option("--direction", help="up, down or both.")] = "both",
    curve: Annotated[str, typer.Option("--curve", help="Shaft or mesh of a longer line to draw.")] = "",
    parameters: Set = None,
    to: OutputNoTable = None,
    as_json: Json = False,
) -> None:
    """Settled motion step by step, up and down: swing, contact, impacts and rattle index, with jumps.

    Example: trunnion sweep gear-rattle --set mean_force=0 -o sweep.png
    """
    import numpy as np

    from trunnion.driveline.refusals import nearest
    from trunnion.equations.staged_line import staged_line
    from trunnion.motion.orbits.frequency_response import require_forced
    from trunnion.motion.orbits.periodic_branch import check_range
    from trunnion.plots.frequency_response import draw_line_sweeps, draw_sweeps

    subject, length = _subject(name, parameters)
    if isinstance(subject, tn.System):
        raise InputError(
            "has no gap to be swept over", key="NAME", value=name,
            remedy=f"use {GEARS}, {DEAD_ZONE} or a line with gears; or frequency-response, periodic-response",
        )  # fmt: skip
    first, last = _range(subject, low, high)
    if direction not in ("up", "down", "both"):
        raise InputError("is no direction", key="--direction", value=direction, remedy="write up, down or both")
    check_range(first, last)
    if isinstance(subject, tn.PiecewiseOscillator):
        require_forced(subject)
    elif curve and curve not in (springs := staged_line(subject, first).springs):
        remedy = nearest(curve, list(springs))
        raise InputError("is no shaft or mesh of the line", key="--curve", value=curve, remedy=remedy)
    check_places(to, PICTURES_AND_DATA)
    grid = np.linspace(first, last, points)
    grids = [grid if d == "up" else grid[::-1] for d in ("up", "down") if direction in (d, "both")]
    unit = _unit(subject)
    with output.progress("sweep"):
        found: list[Any] = [tn.sweep(subject, values) for values in grids]
    if isinstance(subject, tn.PiecewiseOscillator):
        deliver(
            "sweep", name, _Sweeps(found), to, as_json,
            draw=lambda: draw_sweeps(found, length=length),
            content=lambda: {"sweeps": [_sweep_json(one, _oscillator_json(one)) for one in found]},
            text=lambda: "\n".join(map(str, found)),
        )  # fmt: skip
    else:
        deliver(
            "sweep", name, _Sweeps(found), to, as_json,
            draw=lambda: draw_line_sweeps(found, spring=curve, unit=unit),
            content=lambda: {"sweeps": [_sweep_json(one, _line_json(one)) for one in found]},
            text=lambda: "\n".join(one.describe(unit) for one in found),
        )  # fmt: skip


def _sweep_json(one: Any, measured: dict[str, Any]) -> dict[str, Any]:
    return {
        "direction": "up" if one.up else "down",
        **measured,
        "settled": [bool(s) for s in one.settled],
        "jumps": [list(jump) for jump in one.jumps],
        "says": str(one.outcome),
    }


def _oscillator_json(one: Any) -> dict[str, Any]:
    return {
        "frequency": one.frequency,
        "half_peak_to_peak": one.peak_to_peak / 2,
        "mean": one.mean,
        "contact": list(one.contact),
        "impacts": one.impacts,
        "impact_energy": one.impact_energy,
    }


def _line_json(one: Any) -> dict[str, Any]:
    """Torques of all springs of a line with several inertias, and contacts of those with stages."""
    staged = [contact.spring for contact in one.contacts[0]]
    return {
        one.line.clock: one.value,
        "torque_peak_to_peak": {s: one.swing_of(s) for s in one.springs},
        "contact": {s: one.contact_of(s) for s in staged},
        "impact_energy": {s: [row[i].impact_energy for row in one.contacts] for i, s in enumerate(staged)},
    }


def _subject(name: str, parameters: list[str] | None) -> tuple[tn.PiecewiseOscillator | tn.System | tn.Driveline, str]:
    """What is meant, and the unit of its x if it has one."""
    from trunnion.driveline.refusals import nearest
    from trunnion.studies.entries import entries
    from trunnion.systems.reference import SYSTEMS

    values = read_set(parameters)
    if name == GEARS:
        return tn.catalogue(GEARS, **values), "rad"
    if name in SYSTEMS:
        system = SYSTEMS[name]().with_parameters(values)
        return tn.PiecewiseOscillator.gap(name=name, **system.parameters) if name == DEAD_ZONE else system, ""
    lines = [entry.name for entry in entries()]
    if not Path(name).suffix and not Path(name).exists() and name not in lines:
        remedy = nearest(name, [GEARS, *SYSTEMS, *lines])
        raise InputError("is no oscillator known here", key="NAME", value=name, remedy=remedy)
    if values:
        remedy = "edit the file instead"
        raise InputError("belongs to reference systems", key="--set", value=parameters, remedy=remedy)
    return _of_line(read_line(name))


def _of_line(line: tn.Driveline) -> tuple[tn.PiecewiseOscillator | tn.Driveline, str]:
    """One equation where the line is that, and nothing in it grows with the speed; and the unit of its x."""
    spring = line.elements[1] if len(line.elements) == 3 else None
    phased = isinstance(spring, tn.GearPair) and bool(spring.transmission_error)
    if not isinstance(spring, tn.GearPair | tn.PiecewiseShaft) or phased:
        return line, ""
    return tn.exact_oscillator(line), "m" if isinstance(spring, tn.GearPair) else "rad"


def _unit(subject: tn.PiecewiseOscillator | tn.System | tn.Driveline) -> str:
    from trunnion.driveline.operating_speed import speed_unit
    from trunnion.results.speeds import frequency_unit

    if isinstance(subject, tn.Driveline):
        return speed_unit(subject)
    return frequency_unit(subject.speed_unit) if isinstance(subject, tn.PiecewiseOscillator) else "rad/s"


def _range(
    subject: tn.PiecewiseOscillator | tn.System | tn.Driveline, low: str | None, high: str | None
) -> tuple[float, float]:
    """As given; else about the frequency of the excitation, or a line's range of speeds."""
    from trunnion.reporting.ranges import speed_range

    unit = _unit(subject)
    first, last = read_speed(low, unit, "--from"), read_speed(high, unit, "--to")
    if first is not None and last is not None:
        return first, last
    usual = 0.3, 1.3
    if isinstance(subject, tn.Driveline):
        usual = speed_range(subject)
    elif isinstance(subject, tn.PiecewiseOscillator) and not usual[0] < subject.frequency < usual[1]:
        usual = 0.5 * subject.frequency, 1.5 * subject.frequency
    return usual[0] if first is None else first, usual[1] if last is None else last


def _shares(advance: Callable[[float], None], methods: list[str]) -> dict[str, Callable[[float], None]]:
    """Progress of every method, one after the other."""
    return {m: lambda share, i=i: advance((i + share) / len(methods)) for i, m in enumerate(methods)}  # type: ignore[misc]


def _options(
    method: str, fit_range: float | None, harmonics: int | None, progress: Callable[[float], None]
) -> dict[str, Any]:
    if method in ("exact", "shooting"):
        return {"progress": progress}
    if method in ("averaging", "multiple scales") and fit_range is not None:
        return {"fit_range": fit_range}
    return {"harmonics": harmonics} if method == "harmonic balance" and harmonics is not None else {}


def _json(found: Any) -> list[dict[str, Any]]:
    return [
        {
            "method": r.method,
            "peak": {"frequency": r.peak[0], "half_peak_to_peak": r.peak[1]},
            "frequency": r.frequency,
            "half_peak_to_peak": r.half_peak_to_peak,
            "stable": [bool(s) for s in r.stable],
            "marks": [{"kind": k, "frequency": f, "half_peak_to_peak": a} for k, f, a in r.marks],
            "says": str(r.outcome),
        }
        for r in found.responses.values()
    ]


@dataclass(frozen=True)
class _Sweeps:
    """One sweep, or one up and one down."""

    found: list[Any]

    @property
    def data(self) -> Any:
        """Its dataset, or both along a new axis."""
        import xarray as xr

        if len(self.found) == 1:
            return self.found[0].data
        over = next(str(n) for n in self.found[0].data.dims if n in ("frequency", "speed"))
        parts = [one.data.sortby(over) for one in self.found]
        both = xr.concat(parts, dim="direction", combine_attrs="drop_conflicts")
        return both.assign_coords(direction=["up", "down"])
