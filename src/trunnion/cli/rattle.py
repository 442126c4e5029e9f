"""The commands about backlash: frequency-response, sweep."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.command_input import CommandInput, CommandSubject, InputAttribute, NumberBounds, OptionReader, Texts
from trunnion.cli.options import Progress, SpeedUnit
from trunnion.cli.places import PICTURES_AND_DATA, CommandOutput
from trunnion.cli.readers import range_of, read_line, read_set, read_speed
from trunnion.cli.typed import Command
from trunnion.errors import InputError

if TYPE_CHECKING:
    Oscillating = tn.PiecewiseOscillator | tn.System | tn.Driveline

GEARS: Final = "gear-rattle"
DEAD_ZONE = "dead-zone-oscillator"


@dataclass(frozen=True)
class AskedSwing(CommandInput):
    """Also the unit of what swings, "" where it has none."""

    length: str


def _swinging(name: str, texts: Texts) -> AskedSwing:
    """What NAME means, with ``--set`` applied."""
    from trunnion.driveline.operating_speed import speed_unit
    from trunnion.results.words import Words

    subject, length = _meant(name, read_set(texts["parameters"]), texts["parameters"])
    unit = "rad/s"
    if isinstance(subject, tn.Driveline):
        unit = speed_unit(subject)
    elif isinstance(subject, tn.PiecewiseOscillator):
        unit = Words(subject.speed_unit).of_frequencies.of_speeds
    return AskedSwing(subject, name, unit, texts, length)


def _meant(name: str, values: dict[str, float], texts: list[str] | None) -> tuple[Oscillating, str]:
    """What is meant, and the unit of its x if it has one."""
    from trunnion.driveline.refusals import nearest
    from trunnion.papers.entries import entries
    from trunnion.systems.reference import SYSTEMS

    if name == GEARS:
        return tn.catalogue(GEARS, **values), "rad"
    if name in SYSTEMS:
        system = SYSTEMS[name]().with_parameters(values)
        return tn.PiecewiseOscillator.gap(name=name, **system.parameters) if name == DEAD_ZONE else system, ""
    lines = [entry.name for entry in entries()]
    if not Path(name).suffix and not Path(name).exists() and name not in lines:
        remedy = nearest(name, [GEARS, *SYSTEMS, *lines])
        raise InputError("is not an oscillator known here", key="NAME", value=name, remedy=remedy)
    if values:
        remedy = "edit the file instead"
        raise InputError("belongs to reference systems", key="--set", value=texts, remedy=remedy)
    return _of_line(read_line(name))


def _of_line(line: tn.Driveline) -> tuple[tn.PiecewiseOscillator | tn.Driveline, str]:
    """One equation where the line is that, and nothing in it grows with the speed; and the unit of its x."""
    spring = line.elements[1] if len(line.elements) == 3 else None
    phased = isinstance(spring, tn.GearPair) and bool(spring.transmission_error)
    if not isinstance(spring, tn.GearPair | tn.PiecewiseShaft) or phased:
        return line, ""
    return tn.exact_oscillator(line), "m" if isinstance(spring, tn.GearPair) else "rad"


def _usual(asked: CommandInput) -> tuple[float, float]:
    """A line's range of speeds, or frequencies about that of the excitation."""
    if isinstance(asked.subject, tn.Driveline):
        return range_of(asked)
    frequency = asked.subject.frequency if isinstance(asked.subject, tn.PiecewiseOscillator) else 1.0
    return (0.3, 1.3) if 0.3 < frequency < 1.3 else (0.5 * frequency, 1.5 * frequency)


SET = typer.Option("--set", metavar="NAME=VALUE", help="A number of the system; repeat it for more.")
Subjects = Annotated[
    "Oscillating",
    typer.Argument(
        metavar="NAME", help="gear-rattle, dead-zone-oscillator, another reference system, or a driveline file."
    ),
    CommandSubject(_swinging, {"parameters": Annotated[list[str] | None, SET]}),
]
LOW = typer.Option(
    "--from", help='Lowest frequency, "40 Hz", or speed, "300 rpm"; a number is in the unit that is printed.'
)
HIGH = typer.Option("--to", help="Highest frequency or speed.")
From = Annotated[float, LOW, OptionReader(read_speed, missing=lambda asked: _usual(asked)[0])]
To = Annotated[float, HIGH, OptionReader(read_speed, missing=lambda asked: _usual(asked)[1])]
XUnit = Annotated[str, InputAttribute("length")]


@Command("frequency response", writes=PICTURES_AND_DATA)
def frequency_response(
    subject: Subjects,
    *,
    low: From,
    high: To,
    method: list[str] | None = None,
    fit_range: float | None = None,
    harmonics: Annotated[int | None, NumberBounds(1)] = None,
    curve: str = "",
    length: XUnit,
    unit: SpeedUnit,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion frequency-response gear-rattle --method all -o response.png

    --method  Method: exact, harmonic balance, averaging, …; repeat it, or write all.
    --fit-range  Largest |x| of the cubic fit of averaging and multiple scales.
    --harmonics  Number of harmonics of harmonic balance.
    --curve  State of a system or shaft of a line to look at; default: the first.
    """
    from trunnion.motion.orbits.frequency_response import ResponseComparison, methods_of

    known = methods_of(subject)
    # The exact motion of longer lines is for those without joints: asked for by name.
    every = known if isinstance(subject, tn.PiecewiseOscillator) else known[:2]
    chosen = list(every) if method == ["all"] else (method or [known[0]])
    if "shooting" in chosen and known[0] == "shooting":
        output.note("following the motions through their contacts, which may take minutes; a narrower range is quicker")
    shares = _shares(progress, chosen)
    found = ResponseComparison(
        {
            m: tn.frequency_response(
                subject, low, high, method=m, curve=curve, **_options(m, fit_range, harmonics, shares[m])
            )
            for m in chosen
        }
    )
    for response in found.responses.values():
        if not len(response.frequency):
            response.outcome.require()
    one = found.responses[chosen[0]]
    text = one.describe(unit) if len(chosen) == 1 else f"{found.describe(unit)}\n\n{one.describe(unit)}"
    return CommandOutput(
        one, draw=partial(found.plot, length=length), content=lambda: {"methods": _json(found)}, text=lambda: text
    )


@Command("sweep", writes=PICTURES_AND_DATA)
def sweep(
    subject: Subjects,
    *,
    low: From,
    high: To,
    points: Annotated[int, NumberBounds(2, 100_000)] = 101,
    direction: str = "both",
    curve: str = "",
    name: Annotated[str, InputAttribute("file")],
    length: XUnit,
    unit: SpeedUnit,
) -> CommandOutput:
    """Example: trunnion sweep gear-rattle --set mean_force=0 -o sweep.png

    --points  Number of frequencies.
    --direction  Direction of the sweep: up, down or both.
    --curve  Shaft or mesh of a longer line to draw.
    """
    import numpy as np

    from trunnion.driveline.refusals import nearest
    from trunnion.equations.staged_line import staged_line
    from trunnion.motion.orbits.frequency_response import require_forced
    from trunnion.motion.orbits.periodic_branch import check_range
    from trunnion.pictures.draw_matplotlib import draw
    from trunnion.pictures.frequency_response import line_sweeps, sweeps

    if isinstance(subject, tn.System):
        raise InputError(
            "has no gap to be swept over", key="NAME", value=name,
            remedy=f"use {GEARS}, {DEAD_ZONE} or a line with gears; or frequency-response, periodic-response",
        )  # fmt: skip
    if direction not in ("up", "down", "both"):
        raise InputError("is not a direction", key="--direction", value=direction, remedy="write up, down or both")
    check_range(low, high)
    if isinstance(subject, tn.PiecewiseOscillator):
        require_forced(subject)
    elif curve and curve not in (springs := staged_line(subject, low).springs):
        remedy = nearest(curve, list(springs))
        raise InputError("is not a shaft or mesh of the line", key="--curve", value=curve, remedy=remedy)
    grid = np.linspace(low, high, points)
    grids = [grid if d == "up" else grid[::-1] for d in ("up", "down") if direction in (d, "both")]
    found: list[Any] = [tn.sweep(subject, values) for values in grids]
    one_equation = isinstance(subject, tn.PiecewiseOscillator)
    measured = _oscillator_json if one_equation else _line_json
    return CommandOutput(
        _Sweeps(found),
        draw=lambda: draw(
            sweeps(found, length=length) if one_equation else line_sweeps(found, spring=curve, unit=unit)
        ),
        content=lambda: {"sweeps": [_sweep_json(one, measured(one)) for one in found]},
        text=lambda: "\n".join(str(one) if one_equation else one.describe(unit) for one in found),
    )


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
        **output.record(one, "frequency mean contact impacts impact_energy"),
        "half_peak_to_peak": one.peak_to_peak / 2,
    }


def _line_json(one: Any) -> dict[str, Any]:
    """Torques of all springs of a line with several inertias, and contacts of those with stages."""
    staged = [contact.spring for contact in one.contacts[0]]
    return {
        one.line.independent_variable: one.value,
        "torque_peak_to_peak": {s: one.swing_of(s) for s in one.springs},
        "contact": {s: one.contact_of(s) for s in staged},
        "impact_energy": {s: [row[i].impact_energy for row in one.contacts] for i, s in enumerate(staged)},
    }


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
            **output.record(r, "method frequency half_peak_to_peak"),
            "peak": {"frequency": r.peak[0], "half_peak_to_peak": r.peak[1]},
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
